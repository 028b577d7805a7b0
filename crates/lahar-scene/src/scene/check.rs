//! Checks a document against the table of keys: unknown and missing keys and values of the wrong kind are errors.
//! Absent keys get their defaults.

use super::document::{Entry, Node, Sources, Span, Table, Value, literal, literal_table};
use super::formula::Variables;
use super::formula::read_formula;
use super::key::{Key, Kind, Section, WhenAbsent, color};
use super::keys::{SCENE, sections};
use super::material::{PRESET_NAMES, Preset, SceneModel, moduli};
use crate::error::{SceneError, nearest};

/// Checks the scene `root` and fills in its defaults. Returns its dimension.
pub(crate) fn check(sources: &Sources, root: &mut Table) -> Result<usize, SceneError> {
    if root.entries.is_empty() {
        let error = sources.error(Span::default(), "the scene is empty");
        return Err(error.hint(
            "a scene needs at least dx, a material and a body; `lahar show dam-break --toml` prints one",
        ));
    }
    let dimension = match root.get("dimension") {
        None => 2,
        Some(node) => match node.value {
            Value::Integer(2) => 2,
            Value::Integer(3) => 3,
            _ => {
                return Err(sources.error(
                    node.span,
                    format!(
                        "\"dimension\" must be 2 or 3, found {}",
                        node.value.describe()
                    ),
                ));
            }
        },
    };
    let check = Check { sources, dimension };
    check.section(root, &SCENE, Span::default())?;
    Ok(dimension)
}

/// Returns the model that a material names, itself or by its preset.
pub(crate) fn model_of(material: &Table) -> Option<&'static SceneModel> {
    let text = |key: &str| match &material.get(key)?.value {
        Value::Text(text) => Some(text.as_str()),
        _ => None,
    };
    match text("model") {
        Some(model) => SceneModel::find(model),
        None => Preset::find(text("preset")?).map(|(_, model)| model),
    }
}

/// Returns advice for an expression where there must be numbers.
fn no_formulas(kind: Kind, dimension: usize) -> &'static str {
    match (kind, dimension) {
        (Kind::Rotation | Kind::Matrix, 2) => {
            "it takes numbers only; write such a motion as velocity: velocity = [\"-2*(y - 0.5)\", \"2*(x - 0.5)\"] turns about (0.5, 0.5)"
        }
        (Kind::Rotation | Kind::Matrix, _) => {
            "it takes numbers only; write such a motion as velocity: velocity = [\"-2*(y - 0.5)\", \"2*(x - 0.5)\", \"0\"] turns about the \
             axis along z through (0.5, 0.5)"
        }
        _ => "it takes numbers only; gravity, velocity and forces take expressions",
    }
}

struct Check<'a> {
    sources: &'a Sources,
    dimension: usize,
}

impl Check<'_> {
    /// Checks `table`, which is at `span`, and fills in the defaults.
    fn section(
        &self,
        table: &mut Table,
        section: &'static Section,
        span: Span,
    ) -> Result<(), SceneError> {
        for entry in &mut table.entries {
            let key = self.known(entry, section)?;
            if key.only_3d && self.dimension == 2 {
                let error = self
                    .sources
                    .error(entry.key_span, format!("\"{}\" is for 3D only", entry.key));
                return Err(error.hint("this scene has dimension = 2"));
            }
            self.kind(&mut entry.node, entry.key_span, key.name, key.kind)?;
        }
        for key in section.keys() {
            if table.get(key.name).is_some() || (key.only_3d && self.dimension == 2) {
                continue;
            }
            let text = match key.default {
                WhenAbsent::Required => return Err(self.missing(key, section, span)),
                WhenAbsent::Value(text) => text,
                WhenAbsent::ByDimension(two, three) => {
                    if self.dimension == 2 {
                        two
                    } else {
                        three
                    }
                }
                WhenAbsent::Words(_) => continue,
            };
            if let Some(mut node) = literal(text, span) {
                self.kind(&mut node, span, key.name, key.kind)?;
                table.add(key.name, node.value, span);
            }
        }
        Ok(())
    }

    fn missing(&self, key: &Key, section: &Section, span: Span) -> SceneError {
        let place = if section.name == SCENE.name {
            "the scene".to_owned()
        } else {
            format!("this {}", section.name)
        };
        let error = self
            .sources
            .error(span, format!("{place} has no \"{}\"", key.name));
        match key.kind {
            Kind::Materials => {
                error.hint("add one, like: [materials.water] with preset = \"water\"")
            }
            Kind::Tables(_) => error.hint("add one: [[bodies]] with a material and a shape"),
            kind => error.hint(format!(
                "\"{}\" is {}{}: {}",
                key.name,
                kind.words(self.dimension),
                unit(key),
                key.about
            )),
        }
    }

    /// Returns the key of an entry; an error if there is no such key.
    fn known(&self, entry: &Entry, section: &'static Section) -> Result<&'static Key, SceneError> {
        if let Some(key) = section.key(&entry.key) {
            if matches!(key.kind, Kind::Later) {
                let error = self.sources.error(
                    entry.key_span,
                    format!(
                        "\"{}\" is not available yet in this version of lahar",
                        entry.key
                    ),
                );
                return Err(error.hint("remove it; the name is reserved"));
            }
            return Ok(key);
        }
        let error = self.sources.error(
            entry.key_span,
            format!("unknown key \"{}\"", crate::text::shorten(&entry.key)),
        );
        let available = || {
            section.keys().filter(|key| {
                !(matches!(key.kind, Kind::Later) || key.only_3d && self.dimension == 2)
            })
        };
        if let Some(places) = places(&entry.key, section) {
            return Err(error.hint(format!("\"{}\" belongs {places}", entry.key)));
        }
        if let Some(near) = nearest(&entry.key, available().map(|key| key.name)) {
            return Err(error.hint(format!("did you mean \"{near}\"?")));
        }
        let names: Vec<&str> = available().map(|key| key.name).collect();
        Err(error.hint(format!("known here: {}", names.join(", "))))
    }

    /// Checks the value of the key `name`, which is at `key_span`.
    fn kind(
        &self,
        node: &mut Node,
        key_span: Span,
        name: &str,
        kind: Kind,
    ) -> Result<(), SceneError> {
        match kind {
            Kind::OneOf(kinds) => self.one_of(node, key_span, name, kinds),
            Kind::Table(_) | Kind::Tables(_) | Kind::Materials => {
                self.tables(node, key_span, name, kind)
            }
            Kind::Rotation if self.dimension == 2 => self.scalar(node, name, kind),
            Kind::Vector
            | Kind::Formulas(_)
            | Kind::Rotation
            | Kind::Matrix
            | Kind::Points
            | Kind::Interval
            | Kind::Size
            | Kind::Words(_)
            | Kind::Fields => self.list(node, name, kind),
            Kind::Text
            | Kind::Color
            | Kind::Number(_)
            | Kind::Flag
            | Kind::Integer(..)
            | Kind::Word(_)
            | Kind::Later => self.scalar(node, name, kind),
        }
    }

    /// Makes the error of a value that is not of its kind.
    fn wrong(&self, found: &Value, span: Span, name: &str, kind: Kind) -> SceneError {
        let message = format!(
            "\"{name}\" must be {}, found {}",
            kind.words(self.dimension),
            found.describe()
        );
        let error = self.sources.error(span, message);
        let Value::Text(text) = found else {
            return error;
        };
        match kind {
            Kind::Number(_) | Kind::Integer(..) if text.trim().parse::<f64>().is_ok() => {
                error.hint("write it without quotes")
            }
            Kind::Vector | Kind::Rotation | Kind::Matrix => {
                error.hint(no_formulas(kind, self.dimension))
            }
            Kind::Formulas(_) => error.hint("write an expression for each component, in brackets"),
            _ => error,
        }
    }

    /// Checks a value that is no list and no table. A number of a whole kind becomes a whole number.
    fn scalar(&self, node: &mut Node, name: &str, kind: Kind) -> Result<(), SceneError> {
        let is_good = match (kind, &node.value) {
            (Kind::Text, Value::Text(_)) | (Kind::Flag, Value::Flag(_)) => true,
            (Kind::Color, Value::Text(text)) => color(text).is_some(),
            (Kind::Word(words), Value::Text(text)) => {
                return self.word(text, words, node.span, name);
            }
            (Kind::Number(bound), value) => value.as_number().is_some_and(|n| bound.allows(n)),
            (Kind::Rotation, value) => value.as_number().is_some_and(f64::is_finite),
            (Kind::Integer(low, high), Value::Integer(number)) => (low..=high).contains(number),
            (Kind::Integer(low, high), &Value::Number(number))
                if number.fract() == 0.0 && (low as f64..=high as f64).contains(&number) =>
            {
                node.value = Value::Integer(number as i64);
                true
            }
            _ => false,
        };
        if is_good {
            Ok(())
        } else {
            Err(self.wrong(&node.value, node.span, name, kind))
        }
    }

    /// Checks a list of numbers or words.
    fn list(&self, node: &Node, name: &str, kind: Kind) -> Result<(), SceneError> {
        let span = node.span;
        let wrong = || self.wrong(&node.value, span, name, kind);
        let Value::List(list) = &node.value else {
            return Err(wrong());
        };
        match kind {
            Kind::Vector => self.numbers(list, span, name, kind, self.dimension, true),
            Kind::Formulas(variables) => self.formulas(list, span, name, variables),
            Kind::Rotation => self.numbers(list, span, name, kind, 3, true),
            Kind::Matrix if list.len() == self.dimension => self.rows(list, name, kind),
            Kind::Points => self.rows(list, name, kind),
            Kind::Interval => {
                self.numbers(list, span, name, kind, 2, false)?;
                match (list[0].value.as_number(), list[1].value.as_number()) {
                    (Some(low), Some(high)) if low <= high && low >= 0.0 => Ok(()),
                    _ => Err(self.sources.error(
                        span,
                        format!("\"{name}\" must be two numbers, 0 or above, the lower first"),
                    )),
                }
            }
            Kind::Size => {
                let fits = |node: &Node| matches!(node.value, Value::Integer(1..=16384));
                let is_good = list.len() == 2 && list.iter().all(fits);
                if is_good { Ok(()) } else { Err(wrong()) }
            }
            Kind::Words(words) => self.words(list, name, kind, words),
            Kind::Fields => {
                let fields = lahar::particles::FIELDS.iter();
                let names: Vec<&str> = fields.map(|field| field.name).collect();
                self.words(list, name, kind, &names)
            }
            _ => Err(wrong()),
        }
    }

    /// Checks a list of words.
    fn words(
        &self,
        list: &[Node],
        name: &str,
        kind: Kind,
        words: &[&str],
    ) -> Result<(), SceneError> {
        list.iter().try_for_each(|item| match &item.value {
            Value::Text(text) => self.word(text, words, item.span, name),
            other => Err(self.wrong(other, item.span, name, kind)),
        })
    }

    /// Checks a table, or tables.
    fn tables(
        &self,
        node: &mut Node,
        key_span: Span,
        name: &str,
        kind: Kind,
    ) -> Result<(), SceneError> {
        let span = node.span;
        match (kind, &mut node.value) {
            (Kind::Table(section), Value::Table(table)) => self.section(table, section, key_span),
            (Kind::Tables(_), Value::List(list)) if list.is_empty() => {
                Err(self.sources.error(span, format!("\"{name}\" is empty")))
            }
            (Kind::Tables(section), Value::List(list)) => list
                .iter_mut()
                .try_for_each(|item| self.kind(item, item.span, name, Kind::Table(section))),
            (Kind::Tables(_), Value::Table(_)) => Err(self
                .sources
                .error(key_span, format!("\"{name}\" must be a list of tables"))
                .hint(format!("write [[{name}]] with two brackets"))),
            (Kind::Materials, Value::Table(table)) => self.materials(table, span),
            (_, value) => Err(self.wrong(value, span, name, kind)),
        }
    }

    /// Checks a value of one of several kinds: the first one with its TOML type.
    fn one_of(
        &self,
        node: &mut Node,
        key_span: Span,
        name: &str,
        kinds: &'static [Kind],
    ) -> Result<(), SceneError> {
        let all = Kind::OneOf(kinds);
        let Some(one) = kinds.iter().find(|kind| accepts(**kind, &node.value)) else {
            return Err(self.wrong(&node.value, node.span, name, all));
        };
        let checked = self.kind(node, key_span, name, *one);
        checked.map_err(|error| match one {
            Kind::Table(_) => error,
            _ => SceneError {
                message: self.wrong(&node.value, node.span, name, all).message,
                ..error
            },
        })
    }

    /// Checks numbers or expressions, one per dimension.
    fn formulas(
        &self,
        list: &[Node],
        span: Span,
        name: &str,
        variables: Variables,
    ) -> Result<(), SceneError> {
        let is_text = |node: &&Node| matches!(node.value, Value::Text(_));
        let numbers: Vec<Node> = list
            .iter()
            .map(|node| {
                let mut number = node.clone();
                if is_text(&node) {
                    number.value = Value::Number(0.0);
                }
                number
            })
            .collect();
        let kind = Kind::Formulas(variables);
        self.numbers(&numbers, span, name, kind, self.dimension, true)?;
        for node in list.iter().filter(is_text) {
            read_formula(self.sources, node, variables, self.dimension)?;
        }
        Ok(())
    }

    /// Checks `count` numbers.
    fn numbers(
        &self,
        list: &[Node],
        span: Span,
        name: &str,
        kind: Kind,
        count: usize,
        finite: bool,
    ) -> Result<(), SceneError> {
        for item in list {
            let bad = |found: String| {
                self.sources.error(
                    item.span,
                    format!(
                        "\"{name}\" must be {}, found {found}",
                        kind.words(self.dimension)
                    ),
                )
            };
            match (&item.value, item.value.as_number()) {
                (_, Some(number)) if number.is_nan() || (finite && !number.is_finite()) => {
                    return Err(bad(format!("the number {number}")));
                }
                (_, Some(_)) => {}
                (Value::Text(_), _) => {
                    return Err(bad(item.value.describe()).hint(no_formulas(kind, self.dimension)));
                }
                _ => return Err(bad(item.value.describe())),
            }
        }
        if list.len() == count {
            return Ok(());
        }
        let found = Value::List(list.to_vec()).describe();
        let error = self.sources.error(
            span,
            format!(
                "\"{name}\" must be {}, found {found}",
                kind.words(self.dimension)
            ),
        );
        Err(
            if (list.len() == 2 || list.len() == 3)
                && count == self.dimension
                && !matches!(kind, Kind::Interval)
            {
                error.hint(format!("this scene has dimension = {}", self.dimension))
            } else {
                error
            },
        )
    }

    fn rows(&self, rows: &[Node], name: &str, kind: Kind) -> Result<(), SceneError> {
        rows.iter().try_for_each(|row| match &row.value {
            Value::List(list) => self.numbers(list, row.span, name, kind, self.dimension, true),
            other => Err(self.sources.error(
                row.span,
                format!(
                    "\"{name}\" must be {}, found {}",
                    kind.words(self.dimension),
                    other.describe()
                ),
            )),
        })
    }

    fn word(&self, text: &str, words: &[&str], span: Span, name: &str) -> Result<(), SceneError> {
        if words.contains(&text) {
            return Ok(());
        }
        let error = self.sources.error(
            span,
            format!(
                "\"{}\" is no value of \"{name}\"",
                crate::text::shorten(text)
            ),
        );
        Err(match nearest(text, words.iter().copied()) {
            Some(near) => error.hint(format!("did you mean \"{near}\"?")),
            None => error.hint(format!("choose from: {}", words.join(", "))),
        })
    }

    fn materials(&self, materials: &mut Table, span: Span) -> Result<(), SceneError> {
        if materials.entries.is_empty() {
            return Err(self
                .sources
                .error(span, "there is no material")
                .hint("add one, like: [materials.water] with preset = \"water\""));
        }
        for entry in &mut materials.entries {
            let found = entry.node.value.describe();
            let Value::Table(material) = &mut entry.node.value else {
                let error = self.sources.error(
                    entry.node.span,
                    format!("a material must be a table, found {found}"),
                );
                return Err(error.hint("materials have names, like: [materials.water]"));
            };
            self.material(material, entry.key_span)?;
        }
        Ok(())
    }

    /// Fills the material in from its preset, and checks it by the keys of its model.
    fn material(&self, material: &mut Table, span: Span) -> Result<(), SceneError> {
        for (name, words) in [("model", lahar::Model::NAMES), ("preset", PRESET_NAMES)] {
            if let Some(node) = material.get(name) {
                match &node.value {
                    Value::Text(text) => self.word(text, words, node.span, name)?,
                    other => {
                        return Err(self.sources.error(
                            node.span,
                            format!(
                                "\"{name}\" must be text in quotes, found {}",
                                other.describe()
                            ),
                        ));
                    }
                }
            }
        }
        if let Some(Node {
            value: Value::Text(text),
            span: preset_span,
        }) = material.get("preset").cloned()
        {
            let base = Preset::find(&text)
                .and_then(|(preset, _)| literal_table(preset.keys, preset_span))
                .unwrap_or_default();
            let same = |key: &str| match (
                material.get(key).map(|node| &node.value),
                base.get(key).map(|node| &node.value),
            ) {
                (Some(Value::Text(a)), Some(Value::Text(b))) => a == b,
                (given, _) => given.is_none(),
            };
            if !same("model") {
                return Err(self
                    .sources
                    .error(
                        preset_span,
                        format!("the preset \"{text}\" has another model than this material"),
                    )
                    .hint("remove model, or choose another preset"));
            }
            let replaced = replaced_moduli(material, &base);
            for entry in base.entries {
                if material.get(&entry.key).is_none() && !replaced.contains(&entry.key.as_str()) {
                    material.entries.push(entry);
                }
            }
        }
        match model_of(material) {
            Some(model) => self.section(material, model.section, span),
            None => Err(self
                .sources
                .error(span, "this material has no \"model\"")
                .hint(format!(
                    "choose from: {}; or give a preset: {}",
                    lahar::Model::NAMES.join(", "),
                    PRESET_NAMES.join(", ")
                ))),
        }
    }
}

/// Returns the moduli of a preset that the material gives by another pair.
fn replaced_moduli(material: &Table, base: &Table) -> Vec<&'static str> {
    let given = |key: &&str| material.get(key).is_some() && base.get(key).is_none();
    if moduli().any(|key| given(&key)) {
        moduli().collect()
    } else {
        Vec::new()
    }
}

/// Returns true if a value has the TOML type of a kind.
pub(crate) fn accepts(kind: Kind, value: &Value) -> bool {
    match kind {
        Kind::Text | Kind::Color | Kind::Word(_) => matches!(value, Value::Text(_)),
        Kind::Number(_) => matches!(value, Value::Number(_) | Value::Integer(_)),
        Kind::Flag => matches!(value, Value::Flag(_)),
        Kind::Integer(..) => matches!(value, Value::Integer(_)),
        Kind::Table(_) | Kind::Materials => matches!(value, Value::Table(_)),
        Kind::Vector
        | Kind::Formulas(_)
        | Kind::Rotation
        | Kind::Matrix
        | Kind::Points
        | Kind::Interval
        | Kind::Size
        | Kind::Words(_)
        | Kind::Fields
        | Kind::OneOf(_)
        | Kind::Tables(_)
        | Kind::Later => matches!(value, Value::List(_)),
    }
}

fn unit(key: &Key) -> String {
    if key.unit.is_empty() {
        String::new()
    } else {
        format!(" [{}]", key.unit)
    }
}

/// Returns the place of a key that is not known in `here`.
fn places(name: &str, here: &Section) -> Option<String> {
    let knows = |section: &&Section| {
        section
            .key(name)
            .is_some_and(|key| !matches!(key.kind, Kind::Later))
    };
    // For a material, other models are more likely than other tables.
    let kin = |section: &&Section| {
        section.name.starts_with("material: ") && here.name.starts_with("material: ")
    };
    let models: Vec<&str> = sections()
        .filter(kin)
        .filter(knows)
        .filter_map(|section| section.name.strip_prefix("material: "))
        .collect();
    if !models.is_empty() {
        return Some(format!("to model {}", models.join(", ")));
    }
    let other = sections().find(knows)?;
    Some(if other.name == SCENE.name {
        other.header.to_owned()
    } else {
        format!("in {}", other.header)
    })
}
