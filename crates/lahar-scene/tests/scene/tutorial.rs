//! docs/tutorial.md: its scenes run, and its error messages and figures are those of the program.

use lahar::Isa;
use lahar_scene::scene::Scene;

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/tutorial.md");

fn page() -> String {
    std::fs::read_to_string(PAGE).expect("docs/tutorial.md")
}

/// Returns the blocks of TOML on a page.
fn scenes(page: &str) -> Vec<&str> {
    page.split("```toml\n")
        .skip(1)
        .filter_map(|rest| rest.split("```").next())
        .collect()
}

#[test]
fn scenes_run_without_warnings() {
    let page = page();
    assert_eq!(scenes(&page).len(), 5);
    for text in scenes(&page) {
        let scene = Scene::parse(text, "my.toml", &[]);
        let scene = scene.unwrap_or_else(|error| panic!("{error}\n\n{text}"));
        let mut built = scene
            .build(Isa::Portable)
            .unwrap_or_else(|error| panic!("{error}\n\n{text}"));
        assert_eq!(built.warnings, [] as [&str; 0], "{text}");
        let end = 2.0 / scene.frame_rate;
        let done = built.simulation.advance_to(end).expect("it runs");
        assert!(done.substeps > 0);
    }
}

#[test]
fn the_error_message_is_the_one_shown() {
    let page = page();
    let text = scenes(&page)[0].replace("shape =", "shpe =");
    let error = Scene::parse(&text, "my.toml", &[]).unwrap_err();
    for line in error.render(false).lines() {
        assert!(page.contains(&format!("    {line}\n")), "{error}");
    }
}

#[test]
fn the_first_scene_has_the_number_of_particles_shown() {
    let page = page();
    let scene = Scene::parse(scenes(&page)[0], "my.toml", &[]).expect("a good scene");
    let built = scene.build(Isa::Portable).expect("it builds");
    let count = built.simulation.particle_count();
    assert!(
        page.contains(&format!("It has {count} particles")),
        "{count}"
    );
}
