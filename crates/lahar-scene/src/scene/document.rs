//! A scene as a tree of TOML values. Each value carries its place, so that later errors can point at it.
//! `--set` changes values of the tree.

use crate::error::{SceneError, nearest};
use crate::text::shorten;
use toml::de::{DeTable, DeValue};

/// The texts that values come from: the scene first, then the overrides.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sources(Vec<Source>);

#[derive(Clone, Debug)]
struct Source {
    name: String,
    text: String,
}

/// A range of bytes of one of the [`Sources`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Span {
    source: usize,
    start: usize,
    end: usize,
}

impl Sources {
    /// Makes an error that points at `span`.
    pub(crate) fn error(&self, span: Span, message: impl Into<String>) -> SceneError {
        match self.0.get(span.source) {
            Some(source) => {
                SceneError::at(&*source.name, &source.text, span.start, span.end, message)
            }
            None => SceneError::of_file("", message),
        }
    }

    /// Returns true if `span` is in an override, not in the scene.
    pub(crate) fn is_override(&self, span: Span) -> bool {
        span.source > 0
    }

    /// Returns the span of the bytes `part` of `text`, a value at `span`. Where the value is spelled with escapes, it
    /// returns all of `span`.
    pub(crate) fn within(&self, span: Span, text: &str, part: core::ops::Range<usize>) -> Span {
        let spelled = self
            .0
            .get(span.source)
            .and_then(|source| source.text.get(span.start..span.end));
        match spelled.and_then(|spelled| spelled.find(text)) {
            Some(at) if !text.is_empty() => Span {
                source: span.source,
                start: span.start + at + part.start,
                end: span.start + at + part.end,
            },
            _ => span,
        }
    }

    fn add(&mut self, name: String, text: String) -> usize {
        self.0.push(Source { name, text });
        self.0.len() - 1
    }
}

/// A value with its place.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub(crate) value: Value,
    pub(crate) span: Span,
}

#[derive(Clone, Debug)]
pub(crate) enum Value {
    Text(String),
    Number(f64),
    /// A whole number. Numbers that do not fit are [`Value::Number`].
    Integer(i64),
    Flag(bool),
    List(Vec<Node>),
    Table(Table),
    /// A date or a time, which no key takes.
    Date,
}

impl Value {
    /// Describes the value for messages.
    pub(crate) fn describe(&self) -> String {
        match self {
            Self::Text(text) => format!("the text \"{}\"", shorten(text)),
            Self::Number(number) => format!("the number {number}"),
            Self::Integer(number) => format!("the number {number}"),
            Self::Flag(flag) => format!("{flag}"),
            Self::List(list) => match list.len() {
                1 => "a list of 1".to_owned(),
                n => format!("a list of {n}"),
            },
            Self::Table(_) => "a table".to_owned(),
            Self::Date => "a date".to_owned(),
        }
    }

    pub(crate) fn as_number(&self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(*number),
            Self::Integer(number) => Some(*number as f64),
            _ => None,
        }
    }
}

/// A table: keys and values in the order of the file.
#[derive(Clone, Debug, Default)]
pub(crate) struct Table {
    pub(crate) entries: Vec<Entry>,
}

#[derive(Clone, Debug)]
pub(crate) struct Entry {
    pub(crate) key: String,
    /// The place of the key.
    pub(crate) key_span: Span,
    pub(crate) node: Node,
}

impl Table {
    pub(crate) fn entry(&self, key: &str) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.key == key)
    }

    pub(crate) fn get(&self, key: &str) -> Option<&Node> {
        self.entry(key).map(|entry| &entry.node)
    }

    fn get_mut(&mut self, key: &str) -> Option<&mut Node> {
        self.entries
            .iter_mut()
            .find(|entry| entry.key == key)
            .map(|entry| &mut entry.node)
    }

    /// Adds a key that is not there yet, with `span` as the place of key and value.
    pub(crate) fn add(&mut self, key: &str, value: Value, span: Span) {
        self.entries.push(Entry {
            key: key.to_owned(),
            key_span: span,
            node: Node { value, span },
        });
    }
}

/// Keys of a body that place the particles of its shape.
const OF_SHAPES: [&str; 5] = [
    "shape",
    "sampling",
    "particles_per_cell",
    "spacing",
    "count",
];

impl Table {
    /// Removes the shape of a body that is given a particle list, and the other way round.
    fn make_way_for(&mut self, key: &str) {
        self.entries.retain(|entry| match key {
            "particles" => !OF_SHAPES.contains(&entry.key.as_str()),
            "shape" => entry.key != "particles",
            _ => true,
        });
    }
}

/// A parsed scene, with overrides applied.
#[derive(Clone, Debug)]
pub(crate) struct Document {
    pub(crate) sources: Sources,
    pub(crate) root: Table,
}

impl Document {
    /// Parses `text` and applies the overrides.
    pub(crate) fn parse(
        text: &str,
        name: &str,
        overrides: &[(String, String)],
    ) -> Result<Self, SceneError> {
        let mut sources = Sources::default();
        sources.add(name.to_owned(), text.to_owned());
        let table = DeTable::parse(text).map_err(|error| syntax(&sources, 0, 0, &error))?;
        let mut document = Self {
            root: convert_table(table.get_ref(), 0, 0),
            sources,
        };
        for (key, value) in overrides {
            document.set(key, value)?;
        }
        Ok(document)
    }

    /// Applies one `--set key=value`.
    fn set(&mut self, key: &str, value: &str) -> Result<(), SceneError> {
        let source = self
            .sources
            .add("--set".to_owned(), format!("{key}={value}"));
        let path = self.parse_path(key, source)?;
        let offset = key.len() + 1;
        let node = match DeValue::parse(value) {
            Ok(parsed) => convert(&parsed, source, offset),
            Err(_) if is_bare_word(value) => Node {
                value: Value::Text(value.trim().to_owned()),
                span: Span {
                    source,
                    start: offset,
                    end: offset + value.len(),
                },
            },
            Err(error) => return Err(syntax(&self.sources, source, offset, &error)),
        };
        if let [(list, _), (body, _), (key, _)] = &path[..]
            && list == "bodies"
            && let Some(Value::List(bodies)) = self.root.get_mut(list).map(|node| &mut node.value)
            && let Some(at) = element_index(bodies, body)
            && let Value::Table(body) = &mut bodies[at].value
        {
            body.make_way_for(key);
        }
        let sources = &self.sources;
        set_in_table(sources, &mut self.root, &path, node)
    }

    fn parse_path(&self, key: &str, source: usize) -> Result<Vec<(String, Span)>, SceneError> {
        let whole = Span {
            source,
            start: 0,
            end: key.len(),
        };
        let bad = || {
            self.sources
                .error(whole, format!("\"{}\" is not a key", shorten(key)))
                .hint("write keys as in --set dx=0.01 or --set 'bodies.column.velocity=[1,0]'")
        };
        if key.contains(['\n', '=', '#']) {
            return Err(bad());
        }
        let line = format!("{key}=0");
        let parsed = DeTable::parse(&line).map_err(|_| bad())?;
        let mut table = convert_table(parsed.get_ref(), source, 0);
        let mut path = Vec::new();
        while let Some(entry) = table.entries.pop() {
            path.push((entry.key, entry.key_span));
            match entry.node.value {
                Value::Table(inner) => table = inner,
                _ => return Ok(path),
            }
        }
        Err(bad())
    }

    /// Returns the place of a dotted key ("materials.water.density"), or of the longest part of it that the scene
    /// has.
    pub(crate) fn locate(&self, key: &str) -> Option<Span> {
        let mut span = None;
        let mut table = &self.root;
        let mut parts = key.split('.').peekable();
        while let Some(part) = parts.next() {
            let Some(entry) = table.entry(part) else {
                break;
            };
            span = Some(if parts.peek().is_none() {
                entry.node.span
            } else {
                entry.key_span
            });
            let inner = match &entry.node.value {
                Value::Table(inner) => Some(inner),
                Value::List(list) => {
                    let Some(name) = parts.next() else { break };
                    element_index(list, name).and_then(|at| match &list[at].value {
                        Value::Table(inner) => {
                            span = Some(list[at].span);
                            Some(inner)
                        }
                        _ => None,
                    })
                }
                _ => None,
            };
            let Some(inner) = inner else { break };
            table = inner;
        }
        span
    }
}

/// Puts `node` at `path`, and makes the tables on the way.
fn set_in_table(
    sources: &Sources,
    table: &mut Table,
    path: &[(String, Span)],
    node: Node,
) -> Result<(), SceneError> {
    let Some(((key, key_span), rest)) = path.split_first() else {
        return Ok(());
    };
    if rest.is_empty() {
        match table.entries.iter_mut().find(|entry| &entry.key == key) {
            Some(entry) => {
                entry.key_span = *key_span;
                entry.node = node;
            }
            None => table.entries.push(Entry {
                key: key.clone(),
                key_span: *key_span,
                node,
            }),
        }
        return Ok(());
    }
    if table.get(key).is_none() {
        table.add(key, Value::Table(Table::default()), *key_span);
    }
    match table.get_mut(key).map(|node| &mut node.value) {
        Some(Value::Table(inner)) => set_in_table(sources, inner, rest, node),
        Some(Value::List(list)) => {
            let (name, name_span) = &rest[0];
            match element_index(list, name) {
                Some(at) if rest.len() == 1 => {
                    list[at] = node;
                    Ok(())
                }
                Some(at) => match &mut list[at].value {
                    Value::Table(inner) => set_in_table(sources, inner, &rest[1..], node),
                    other => Err(sources.error(
                        *name_span,
                        format!("{key}.{name} is {}, and has no keys", other.describe()),
                    )),
                },
                None => {
                    let names: Vec<&str> = list.iter().filter_map(element_name).collect();
                    let error =
                        sources.error(*name_span, format!("there is no \"{name}\" in {key}"));
                    Err(match nearest(name, names.iter().copied()) {
                        Some(near) => error.hint(format!("did you mean \"{near}\"?")),
                        None if names.is_empty() => error.hint(format!(
                            "give its number, from 0 to {}",
                            list.len().saturating_sub(1)
                        )),
                        None => error.hint(format!("there are: {}", names.join(", "))),
                    })
                }
            }
        }
        Some(other) => {
            let found = other.describe();
            Err(sources.error(
                *key_span,
                format!("\"{key}\" is {found} in the scene, and has no keys"),
            ))
        }
        None => Ok(()),
    }
}

/// Returns the index of an element of a list of tables, which is given by its name or number.
fn element_index(list: &[Node], name: &str) -> Option<usize> {
    list.iter()
        .position(|node| element_name(node) == Some(name))
        .or_else(|| name.parse().ok().filter(|&at: &usize| at < list.len()))
}

fn element_name(node: &Node) -> Option<&str> {
    match &node.value {
        Value::Table(table) => match &table.get("name")?.value {
            Value::Text(name) => Some(name),
            _ => None,
        },
        _ => None,
    }
}

/// Returns true if a value of `--set` needs no quotes: a word, a path.
fn is_bare_word(value: &str) -> bool {
    let value = value.trim();
    value.starts_with(|c: char| c.is_alphabetic() || c == '/' || c == '.')
        && value
            .chars()
            .all(|c| c.is_alphanumeric() || " _-./".contains(c))
}

/// Parses a value that this crate writes in TOML: defaults and presets. Returns `None` if it is not TOML.
pub(crate) fn literal(text: &str, span: Span) -> Option<Node> {
    let mut node = convert(&DeValue::parse(text).ok()?, 0, 0);
    place(&mut node, span);
    Some(node)
}

/// Parses a table that this crate writes in TOML, with `span` as the place of all of it.
pub(crate) fn literal_table(text: &str, span: Span) -> Option<Table> {
    let mut table = convert_table(DeTable::parse(text).ok()?.get_ref(), 0, 0);
    for entry in &mut table.entries {
        entry.key_span = span;
        place(&mut entry.node, span);
    }
    Some(table)
}

fn place(node: &mut Node, span: Span) {
    node.span = span;
    match &mut node.value {
        Value::List(list) => list.iter_mut().for_each(|node| place(node, span)),
        Value::Table(table) => {
            for entry in &mut table.entries {
                entry.key_span = span;
                place(&mut entry.node, span);
            }
        }
        _ => {}
    }
}

fn syntax(sources: &Sources, source: usize, offset: usize, error: &toml::de::Error) -> SceneError {
    let range = error.span().unwrap_or(0..0);
    let span = Span {
        source,
        start: range.start + offset,
        end: range.end + offset,
    };
    let message = error.message().lines().collect::<Vec<_>>().join("; ");
    // If a line ends after "=", the message of the parser is about quotes.
    let error = sources.error(span, "");
    let before = error.text.chars().take(error.column.saturating_sub(1));
    let rest = error.text.chars().skip(error.column.saturating_sub(1));
    let is_cut = before.collect::<String>().trim_end().ends_with('=')
        && rest.collect::<String>().trim().is_empty();
    SceneError {
        message: if is_cut {
            "there is no value after \"=\"".to_owned()
        } else {
            match message.contains("recurse") {
                true => "tables and lists are nested too deep here".to_owned(),
                false => format!("not TOML: {message}"),
            }
        },
        ..error
    }
}

fn convert(node: &toml::Spanned<DeValue<'_>>, source: usize, offset: usize) -> Node {
    let range = node.span();
    let value = match node.get_ref() {
        DeValue::String(text) => Value::Text(text.to_string()),
        DeValue::Integer(number) => match i64::from_str_radix(number.as_str(), number.radix()) {
            Ok(number) => Value::Integer(number),
            Err(_) => Value::Number(number.as_str().parse().unwrap_or(f64::INFINITY)),
        },
        DeValue::Float(number) => Value::Number(number.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(flag) => Value::Flag(*flag),
        DeValue::Datetime(_) => Value::Date,
        DeValue::Array(list) => Value::List(
            list.iter()
                .map(|node| convert(node, source, offset))
                .collect(),
        ),
        DeValue::Table(table) => Value::Table(convert_table(table, source, offset)),
    };
    Node {
        value,
        span: Span {
            source,
            start: range.start + offset,
            end: range.end + offset,
        },
    }
}

fn convert_table(table: &DeTable<'_>, source: usize, offset: usize) -> Table {
    let mut entries: Vec<Entry> = table
        .iter()
        .map(|(key, node)| Entry {
            key: key.get_ref().to_string(),
            key_span: Span {
                source,
                start: key.span().start + offset,
                end: key.span().end + offset,
            },
            node: convert(node, source, offset),
        })
        .collect();
    entries.sort_by_key(|entry| entry.key_span);
    Table { entries }
}

/// Returns the tree as JSON. Numbers that JSON does not have (infinite ones) become words.
pub(crate) fn json(node: &Node) -> serde_json::Value {
    match &node.value {
        Value::Text(text) => text.clone().into(),
        Value::Number(number) if number.is_finite() => (*number).into(),
        Value::Number(number) => number.to_string().into(),
        Value::Integer(number) => (*number).into(),
        Value::Flag(flag) => (*flag).into(),
        Value::List(list) => list.iter().map(json).collect(),
        Value::Table(table) => json_table(table),
        Value::Date => serde_json::Value::Null,
    }
}

pub(crate) fn json_table(table: &Table) -> serde_json::Value {
    table
        .entries
        .iter()
        .map(|entry| (entry.key.clone(), json(&entry.node)))
        .collect()
}

/// Returns a tree from the JSON that [`json`] has made, without places; `None` for values that no scene has.
pub(crate) fn from_json(value: &serde_json::Value) -> Option<Node> {
    let span = Span::default();
    let value = match value {
        serde_json::Value::Null => return None,
        serde_json::Value::Bool(flag) => Value::Flag(*flag),
        serde_json::Value::Number(number) => match number.as_i64() {
            Some(whole) => Value::Integer(whole),
            None => Value::Number(number.as_f64()?),
        },
        serde_json::Value::String(text) => Value::Text(text.clone()),
        serde_json::Value::Array(list) => Value::List(list.iter().filter_map(from_json).collect()),
        serde_json::Value::Object(table) => {
            let entry = |(key, value): (&String, &serde_json::Value)| {
                Some(Entry {
                    key: key.clone(),
                    key_span: span,
                    node: from_json(value)?,
                })
            };
            Value::Table(Table {
                entries: table.iter().filter_map(entry).collect(),
            })
        }
    };
    Some(Node { value, span })
}
