//! Documentation made from the table of keys: a JSON schema for editors, and the tables of docs/scene-format.md.

use super::document::{Span, json as json_of, literal};
use super::key::{Bound, Key, Kind, Section, WhenAbsent};
use super::keys::sections;
use super::material::{ELASTIC, MATERIAL, MODELS, Preset, SceneModel};
use serde_json::{Map, Value, json};

/// Returns the scene format as a JSON schema (draft 2020-12).
///
/// ```
/// let schema = lahar_scene::scene::schema();
/// assert_eq!(schema["properties"]["dx"]["exclusiveMinimum"], 0);
/// ```
pub fn schema() -> Value {
    let mut schema = object(&super::keys::SCENE);
    if let Some(map) = schema.as_object_mut() {
        let shape = object(&super::keys::SHAPE);
        map.insert("$defs".to_owned(), json!({ "shape": shape }));
        map.insert(
            "$schema".to_owned(),
            json!("https://json-schema.org/draft/2020-12/schema"),
        );
        map.insert("title".to_owned(), json!("lahar scene"));
    }
    schema
}

fn object(section: &Section) -> Value {
    let mut properties = Map::new();
    let mut required = Vec::new();
    for key in section.keys() {
        if matches!(key.kind, Kind::Later) {
            continue;
        }
        let mut value = value_of(key.kind);
        if let Some(map) = value.as_object_mut() {
            map.insert("description".to_owned(), json!(description(key)));
            if let WhenAbsent::Value(text) | WhenAbsent::ByDimension(text, _) = key.default
                && let Some(node) = literal(text, Span::default())
            {
                map.insert("default".to_owned(), json_of(&node));
            }
        }
        properties.insert(key.name.to_owned(), value);
        if matches!(key.default, WhenAbsent::Required) {
            required.push(key.name);
        }
    }
    json!({ "type": "object", "properties": properties, "required": required, "additionalProperties": false })
}

/// Returns the schema of a table. Shapes contain shapes, so they are a definition of their own.
fn table_of(section: &Section) -> Value {
    if section.name == super::keys::SHAPE.name {
        json!({ "$ref": "#/$defs/shape" })
    } else {
        object(section)
    }
}

/// Returns the text that editors show: the sentence, the unit and the default.
fn description(key: &Key) -> String {
    let unit = if key.unit.is_empty() {
        String::new()
    } else {
        format!(" [{}]", key.unit)
    };
    let dimension = if key.only_3d { " 3D only." } else { "" };
    format!(
        "{}{unit}{dimension} Default: {}.",
        key.about,
        default_words(key)
    )
}

fn value_of(kind: Kind) -> Value {
    let number = |bound: Bound| match bound {
        Bound::Any => json!({ "type": "number" }),
        Bound::Positive => json!({ "type": "number", "exclusiveMinimum": 0 }),
        Bound::NotNegative => json!({ "type": "number", "minimum": 0 }),
        Bound::Part => json!({ "type": "number", "minimum": 0, "maximum": 1 }),
        Bound::Poisson => {
            json!({ "type": "number", "exclusiveMinimum": -1, "exclusiveMaximum": 0.5 })
        }
    };
    let vector =
        json!({ "type": "array", "items": { "type": "number" }, "minItems": 2, "maxItems": 3 });
    match kind {
        Kind::Text => json!({ "type": "string" }),
        Kind::Color => json!({ "type": "string", "pattern": "^#[0-9a-fA-F]{6}$" }),
        Kind::Number(bound) => number(bound),
        Kind::Flag => json!({ "type": "boolean" }),
        Kind::Integer(low, i64::MAX) => json!({ "type": "integer", "minimum": low }),
        Kind::Integer(low, high) => json!({ "type": "integer", "minimum": low, "maximum": high }),
        Kind::Vector => vector,
        Kind::Formulas(_) => {
            json!({ "type": "array", "items": { "type": ["number", "string"] }, "minItems": 2, "maxItems": 3 })
        }
        Kind::Rotation => {
            json!({ "anyOf": [{ "type": "number" }, { "type": "array", "items": { "type": "number" }, "minItems": 3, "maxItems": 3 }] })
        }
        Kind::Matrix => json!({ "type": "array", "items": vector, "minItems": 2, "maxItems": 3 }),
        Kind::Points => json!({ "type": "array", "items": vector, "minItems": 3 }),
        Kind::Interval => {
            json!({ "type": "array", "items": { "type": "number", "minimum": 0 }, "minItems": 2, "maxItems": 2 })
        }
        Kind::Size => {
            json!({ "type": "array", "items": { "type": "integer", "minimum": 1, "maximum": 16384 }, "minItems": 2, "maxItems": 2 })
        }
        Kind::Word(words) => json!({ "enum": words }),
        Kind::Words(words) => json!({ "type": "array", "items": { "enum": words } }),
        Kind::Fields => {
            let names: Vec<&str> = lahar::particles::FIELDS
                .iter()
                .map(|field| field.name)
                .collect();
            json!({ "type": "array", "items": { "enum": names } })
        }
        Kind::OneOf(kinds) => {
            json!({ "anyOf": kinds.iter().map(|kind| value_of(*kind)).collect::<Vec<_>>() })
        }
        Kind::Table(section) => table_of(section),
        Kind::Tables(section) => {
            json!({ "type": "array", "items": table_of(section), "minItems": 1 })
        }
        Kind::Materials => {
            json!({ "type": "object", "minProperties": 1, "additionalProperties": material() })
        }
        Kind::Later => json!(false),
    }
}

/// Returns the schema of a material, by its model or its preset.
fn material() -> Value {
    let variants = MODELS.iter().map(|model| {
        let mut variant = object(model.section);
        let presets: Vec<&str> = model.presets.iter().map(|preset| preset.name).collect();
        variant["properties"]["model"]["const"] = json!(model.name);
        variant["properties"]["preset"]["enum"] = json!(presets);
        variant["anyOf"] =
            json!([{ "required": ["model", "density"] }, { "required": ["preset"] }]);
        variant
    });
    json!({ "anyOf": variants.collect::<Vec<_>>() })
}

/// A table of keys in the documentation.
struct DocTable {
    name: &'static str,
    header: String,
    keys: &'static [Key],
}

/// Returns true for two lists of the same keys.
fn same(a: &[Key], b: &[Key]) -> bool {
    let name = |key: &Key| (key.name, key.about);
    a.iter().map(name).eq(b.iter().map(name))
}

/// Returns the tables. Keys that several models share are listed once.
fn tables() -> Vec<DocTable> {
    let mut tables: Vec<DocTable> = Vec::new();
    for section in sections() {
        for keys in section.keys {
            if tables.iter().any(|table| same(table.keys, keys)) {
                continue;
            }
            let (name, header) = if same(keys, MATERIAL) {
                ("material", "[materials.NAME], every model".to_owned())
            } else if same(keys, ELASTIC) {
                let elastic = |model: &&SceneModel| {
                    (model.section.keys.iter()).any(|keys| same(keys, ELASTIC))
                };
                let names: Vec<String> = (MODELS.iter().filter(elastic))
                    .map(|model| format!("`{}`", model.name))
                    .collect();
                let header = format!("[materials.NAME], models {}", names.join(", "));
                ("elastic", header)
            } else {
                (section.name, section.header.to_owned())
            };
            tables.push(DocTable { name, header, keys });
        }
    }
    tables
}

/// Returns the reference of the format as Markdown: for each table of a scene its keys with type, unit and default,
/// and the presets.
pub fn docs() -> String {
    let names = tables().into_iter().map(|table| table.name);
    names
        .chain(["presets"])
        .filter_map(|name| Some(format!("### {name}\n\n{}", docs_of(name)?)))
        .collect::<Vec<_>>()
        .join("\n")
}

/// Returns one table of [`docs`], by its name.
pub fn docs_of(name: &str) -> Option<String> {
    if name == "presets" {
        return Some(presets());
    }
    let table = tables().into_iter().find(|table| table.name == name)?;
    let mut out = format!(
        "Keys of {}:\n\n| key | value | unit | default | |\n|---|---|---|---|---|\n",
        table.header.trim_start_matches("at ")
    );
    for key in table
        .keys
        .iter()
        .filter(|key| !matches!(key.kind, Kind::Later))
    {
        out += &format!(
            "| `{}` | {} | {} | {} | {}{} |\n",
            key.name,
            kind_words(key.kind).replace('|', "\\|"),
            key.unit,
            default_words(key),
            key.about,
            if key.only_3d { " 3D only." } else { "" },
        );
    }
    let reserved: Vec<String> = table
        .keys
        .iter()
        .filter(|key| matches!(key.kind, Kind::Later))
        .map(|key| format!("`{}`", key.name))
        .collect();
    if !reserved.is_empty() {
        out += &format!("\nReserved for later versions: {}.\n", reserved.join(", "));
    }
    Some(out)
}

fn presets() -> String {
    let mut out = "| preset | keys | | source |\n|---|---|---|---|\n".to_owned();
    for preset in Preset::all() {
        let keys: Vec<String> = preset
            .keys
            .lines()
            .map(|line| format!("`{line}`"))
            .collect();
        out += &format!(
            "| `{}` | {} | {} | {} |\n",
            preset.name,
            keys.join(", "),
            preset.about,
            preset.source
        );
    }
    out
}

fn default_words(key: &Key) -> String {
    match key.default {
        WhenAbsent::Required => "required".to_owned(),
        WhenAbsent::Value(text) => format!("`{text}`"),
        WhenAbsent::ByDimension(two, three) => format!("`{two}`; in 3D `{three}`"),
        WhenAbsent::Words(words) => words.to_owned(),
    }
}

fn kind_words(kind: Kind) -> String {
    match kind {
        Kind::Text => "text".to_owned(),
        Kind::Color => "\"#rrggbb\"".to_owned(),
        Kind::Vector => "D numbers".to_owned(),
        Kind::Formulas(_) => "D numbers or expressions".to_owned(),
        Kind::Rotation => "a number; in 3D 3 numbers".to_owned(),
        Kind::Matrix => "D rows of D numbers".to_owned(),
        Kind::Points => "a list of points of D numbers".to_owned(),
        Kind::Fields => "a list of field names".to_owned(),
        Kind::OneOf(kinds) => kinds
            .iter()
            .map(|kind| kind_words(*kind))
            .collect::<Vec<_>>()
            .join(", or "),
        Kind::Tables(_) => "tables".to_owned(),
        Kind::Materials => "tables by name".to_owned(),
        kind => kind.words(2),
    }
}
