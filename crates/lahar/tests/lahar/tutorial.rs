//! docs/tutorial.md and examples/custom_material.rs, the law that it explains, agree.

#[test]
fn the_law_of_the_tutorial_is_that_of_the_example() {
    let page = include_str!("../../docs/tutorial.md");
    let example = include_str!("../../examples/custom_material.rs");
    assert!(example.contains("let rate = gradient + gradient.transpose();\n"));
    assert!(example.contains("struct KelvinVoigt"));
    for name in [
        "kirchhoff_stress",
        "advance",
        "energy_density",
        "wave_modulus",
        "viscosity",
    ] {
        assert!(example.contains(&format!("fn {name}")), "{name}");
        assert!(page.contains(&format!("| `{name}` |")), "{name}");
    }
}
