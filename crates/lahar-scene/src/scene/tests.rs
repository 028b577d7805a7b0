//! The documentation against the table of keys, and the table against itself.

use super::check::{accepts, model_of};
use super::document::{Document, Node, Table, Value};
use super::key::{Kind, Section};
use super::keys::{SCENE, sections};
use super::{Scene, docs, docs_of, schema};
use lahar::Isa;

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/scene-format.md");

/// Code blocks of a page, by their language.
fn blocks<'a>(page: &'a str, language: &str) -> Vec<&'a str> {
    let fence = format!("```{language}\n");
    page.split(&fence)
        .skip(1)
        .filter_map(|rest| rest.split("```").next())
        .collect()
}

/// An example with what it leaves out, as the page says.
fn completed(block: &str) -> String {
    let mut text = String::new();
    let whole = block.contains("dimension = 3");
    if !block.lines().any(|line| line.starts_with("dx =")) {
        text += "dx = 0.02\n";
    }
    text += block;
    if !block.contains("[domain]") && !whole {
        text += "\n[domain]\nmin = [0.0, 0.0]\nmax = [2.0, 1.0]\n";
    }
    if !block.contains("[materials.") {
        text += "\n[materials.water]\npreset = \"water\"\n";
    }
    if !block.contains("[[bodies]]") {
        let after = block
            .split("[materials.")
            .nth(1)
            .and_then(|rest| rest.split(']').next());
        let material = after.unwrap_or("water");
        text += &format!(
            "\n[[bodies]]\nmaterial = \"{material}\"\nshape = {{ box = {{ min = [0.0, 0.0], max = [0.5, 0.5] }} }}\n"
        );
    }
    text
}

/// A folder with the files that the page's examples name.
fn folder(page: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (file, language) in [
        ("start.csv", "csv"),
        ("more.ply", "ply"),
        ("gem.obj", "obj"),
    ] {
        std::fs::write(folder.path().join(file), blocks(page, language)[0]).unwrap();
    }
    folder
}

/// The keys that `root` gives, as (section, key).
fn used_keys(root: &Table) -> Vec<(&'static str, String)> {
    fn visit(table: &Table, section: &'static Section, used: &mut Vec<(&'static str, String)>) {
        for entry in &table.entries {
            used.push((section.name, entry.key.clone()));
            if let Some(key) = section.key(&entry.key) {
                visit_kind(&entry.node, key.kind, used);
            }
        }
    }
    fn visit_kind(node: &Node, kind: Kind, used: &mut Vec<(&'static str, String)>) {
        match (kind, &node.value) {
            (Kind::Table(section), Value::Table(table)) => visit(table, section, used),
            (Kind::Tables(section), Value::List(list)) => {
                for node in list {
                    visit_kind(node, Kind::Table(section), used);
                }
            }
            (Kind::Materials, Value::Table(table)) => {
                for entry in &table.entries {
                    let Value::Table(material) = &entry.node.value else {
                        continue;
                    };
                    if let Some(section) = model_of(material).map(|model| model.section) {
                        visit(material, section, used);
                    }
                }
            }
            (Kind::OneOf(kinds), _) => {
                if let Some(kind) = kinds.iter().find(|kind| accepts(**kind, &node.value)) {
                    visit_kind(node, *kind, used);
                }
            }
            _ => {}
        }
    }
    let mut used = Vec::new();
    visit(root, &SCENE, &mut used);
    used
}

#[test]
fn examples_of_the_page_are_scenes() {
    let page = std::fs::read_to_string(PAGE).unwrap();
    let folder = folder(&page);
    let name = folder.path().join("scene.toml").display().to_string();
    for block in blocks(&page, "toml") {
        let scene = Scene::parse(&completed(block), &name, &[])
            .unwrap_or_else(|error| panic!("{error}\n\n{block}"));
        scene
            .build(Isa::Portable)
            .unwrap_or_else(|error| panic!("{error}\n\n{block}"));
    }
}

#[test]
fn every_key_has_an_example_on_the_page() {
    let page = std::fs::read_to_string(PAGE).unwrap();
    let used: Vec<(&str, String)> = blocks(&page, "toml")
        .into_iter()
        .flat_map(|block| used_keys(&Document::parse(block, "", &[]).unwrap().root))
        .collect();
    let mut without = Vec::new();
    for section in sections() {
        for key in section
            .keys()
            .filter(|key| !matches!(key.kind, Kind::Later))
        {
            // Keys that models share need one example.
            let shown = used.iter().any(|(name, used)| {
                used == key.name
                    && (*name == section.name
                        || (name.starts_with("material") && section.name.starts_with("material")))
            });
            if !shown {
                without.push((section.name, key.name));
            }
        }
    }
    assert_eq!(without, []);
}

/// With `LAHAR_UPDATE=1` in the environment the page is brought up to date.
#[test]
fn tables_of_the_page_are_up_to_date() {
    let page = std::fs::read_to_string(PAGE).unwrap();
    let mut fresh = String::new();
    let mut named = Vec::new();
    let mut rest = page.as_str();
    while let Some((before, after)) = rest.split_once("<!-- keys: ") {
        let (name, after) = after.split_once(" -->\n").unwrap();
        let (_, after) = after.split_once("<!-- end -->").unwrap();
        let table = docs_of(name).unwrap_or_else(|| panic!("there is no table \"{name}\""));
        fresh += &format!("{before}<!-- keys: {name} -->\n{table}<!-- end -->");
        named.push(name);
        rest = after;
    }
    fresh += rest;
    if std::env::var_os("LAHAR_UPDATE").is_some() {
        std::fs::write(PAGE, &fresh).unwrap();
    } else {
        assert!(
            page == fresh,
            "docs/scene-format.md is not up to date: run this test with LAHAR_UPDATE=1"
        );
    }
    for line in docs().lines() {
        if let Some(name) = line.strip_prefix("### ") {
            assert!(named.contains(&name), "the page lacks the table \"{name}\"");
        }
    }
}

#[test]
fn defaults_of_the_table_are_valid() {
    // A scene and a 3D scene that give nothing that has a default.
    for dimension in [2, 3] {
        let vector = |x: f64| format!("{:?}", vec![x; dimension]);
        let text = format!(
            "dimension = {dimension}\ndx = 0.1\n[domain]\nmin = {}\nmax = {}\n[materials.s]\npreset = \"snow\"\n[materials.w]\npreset = \"water\"\n\
             [[bodies]]\nmaterial = \"s\"\nshape = {{ ball = {{ center = {}, radius = 0.3 }} }}\n",
            vector(0.0),
            vector(1.0),
            vector(0.5)
        );
        let scene = Scene::parse(&text, "a", &[]).unwrap_or_else(|error| panic!("{error}"));
        let resolved = scene.resolved();
        assert_eq!(resolved["kernel"], "quadratic");
        assert_eq!(resolved["bodies"][0]["sampling"], "jittered");
        assert_eq!(resolved["materials"]["s"]["hardening_range"][1], "inf");
        assert_eq!(
            resolved["gravity"].as_array().map(Vec::len),
            Some(dimension)
        );
    }
}

#[test]
fn the_schema_names_every_key() {
    let schema = schema().to_string();
    for section in sections() {
        for key in section.keys() {
            let there = schema.contains(&format!("\"{}\":", key.name));
            assert!(there || matches!(key.kind, Kind::Later), "{}", key.name);
        }
    }
    assert!(!schema.contains("\"emitters\""));
}
