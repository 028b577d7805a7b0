//! Typed access to a checked table. `check` has checked the kinds and filled in the defaults: a key that is
//! absent here has no default.

use super::document::{Node, Sources, Span, Table, Value};
use super::formula::{Formulas, Variables, read_formula};
use super::key::color;
use crate::error::SceneError;

/// A table of the scene with its place.
#[derive(Clone, Copy)]
pub(crate) struct Reader<'a> {
    sources: &'a Sources,
    table: &'a Table,
    span: Span,
}

impl<'a> Reader<'a> {
    pub(crate) fn new(sources: &'a Sources, table: &'a Table, span: Span) -> Self {
        Self {
            sources,
            table,
            span,
        }
    }

    /// Makes an error that points at the table itself.
    pub(crate) fn error(&self, message: impl Into<String>) -> SceneError {
        self.sources.error(self.span, message)
    }

    /// Makes an error that points at the value of `key`, or at the table if the key is absent.
    pub(crate) fn error_at(&self, key: &str, message: impl Into<String>) -> SceneError {
        self.sources.error(
            self.table.get(key).map_or(self.span, |node| node.span),
            message,
        )
    }

    /// Makes an error that points at `key` itself, or at the table if the key is absent.
    pub(crate) fn error_at_key(&self, key: &str, message: impl Into<String>) -> SceneError {
        self.sources.error(
            self.table
                .entry(key)
                .map_or(self.span, |entry| entry.key_span),
            message,
        )
    }

    /// Returns true if the value of `key` comes from `--set`.
    pub(crate) fn is_override(&self, key: &str) -> bool {
        self.table
            .get(key)
            .is_some_and(|node| self.sources.is_override(node.span))
    }

    pub(crate) fn has(&self, key: &str) -> bool {
        self.table.get(key).is_some()
    }

    fn required<T>(&self, key: &str, value: Option<T>) -> Result<T, SceneError> {
        value.ok_or_else(|| self.error(format!("there is no usable \"{key}\"")))
    }

    pub(crate) fn opt_text(&self, key: &str) -> Option<&'a str> {
        match &self.table.get(key)?.value {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    pub(crate) fn text(&self, key: &str) -> Result<&'a str, SceneError> {
        self.required(key, self.opt_text(key))
    }

    /// Returns the meaning of the word of `key`; an error if it is none of `words`.
    pub(crate) fn choice<T: Copy>(&self, key: &str, words: &[(&str, T)]) -> Result<T, SceneError> {
        let given = self.text(key)?;
        match words.iter().find(|(word, _)| *word == given) {
            Some((_, meaning)) => Ok(*meaning),
            None => Err(self.error_at(key, format!("\"{given}\" is no value of \"{key}\""))),
        }
    }

    pub(crate) fn opt_number(&self, key: &str) -> Option<f64> {
        self.table.get(key)?.value.as_number()
    }

    pub(crate) fn number(&self, key: &str) -> Result<f64, SceneError> {
        self.required(key, self.opt_number(key))
    }

    pub(crate) fn opt_flag(&self, key: &str) -> Option<bool> {
        match self.table.get(key)?.value {
            Value::Flag(flag) => Some(flag),
            _ => None,
        }
    }

    pub(crate) fn opt_integer(&self, key: &str) -> Option<u64> {
        match self.table.get(key)?.value {
            Value::Integer(number) => u64::try_from(number).ok(),
            _ => None,
        }
    }

    pub(crate) fn integer(&self, key: &str) -> Result<u64, SceneError> {
        self.required(key, self.opt_integer(key))
    }

    pub(crate) fn opt_vector<const D: usize>(&self, key: &str) -> Option<[f64; D]> {
        vector(self.table.get(key)?)
    }

    pub(crate) fn vector<const D: usize>(&self, key: &str) -> Result<[f64; D], SceneError> {
        self.required(key, self.opt_vector(key))
    }

    /// Returns D numbers or expressions.
    pub(crate) fn formulas<const D: usize>(
        &self,
        key: &str,
        variables: Variables,
    ) -> Result<Formulas<D>, SceneError> {
        let list = match self.table.get(key).map(|node| &node.value) {
            Some(Value::List(list)) => list.as_slice(),
            _ => &[],
        };
        let formulas = list
            .iter()
            .map(|node| read_formula(self.sources, node, variables, D))
            .collect::<Result<Vec<_>, _>>()?;
        self.required(key, formulas.try_into().ok().map(Formulas))
    }

    /// Returns rows of D numbers.
    pub(crate) fn opt_rows<const D: usize>(&self, key: &str) -> Option<Vec<[f64; D]>> {
        match &self.table.get(key)?.value {
            Value::List(rows) => rows.iter().map(vector).collect(),
            _ => None,
        }
    }

    pub(crate) fn opt_words(&self, key: &str) -> Option<Vec<String>> {
        match &self.table.get(key)?.value {
            Value::List(list) => list
                .iter()
                .map(|node| match &node.value {
                    Value::Text(text) => Some(text.clone()),
                    _ => None,
                })
                .collect(),
            _ => None,
        }
    }

    pub(crate) fn opt_color(&self, key: &str) -> Option<[u8; 3]> {
        color(self.opt_text(key)?)
    }

    pub(crate) fn opt_table(&self, key: &str) -> Option<Reader<'a>> {
        let entry = self.table.entry(key)?;
        match &entry.node.value {
            Value::Table(table) => Some(Reader::new(self.sources, table, entry.key_span)),
            _ => None,
        }
    }

    /// Returns the elements of a list, with `None` for each that is not a number.
    pub(crate) fn opt_components(&self, key: &str) -> Option<Vec<Option<f64>>> {
        match &self.table.get(key)?.value {
            Value::List(list) => Some(list.iter().map(|node| node.value.as_number()).collect()),
            _ => None,
        }
    }

    /// Returns the keys of this table that have numbers for values, with these numbers, in order.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = (&'a str, f64)> {
        (self.table.entries.iter())
            .filter_map(|entry| Some((entry.key.as_str(), entry.node.value.as_number()?)))
    }

    /// Returns the tables in a table or list, with their keys. Elements of a list have an empty key.
    pub(crate) fn tables(&self, key: &str) -> Vec<(&'a str, Reader<'a>)> {
        match self.table.get(key).map(|node| &node.value) {
            Some(Value::Table(table)) => table
                .entries
                .iter()
                .filter_map(|entry| match &entry.node.value {
                    Value::Table(table) => Some((
                        entry.key.as_str(),
                        Reader::new(self.sources, table, entry.key_span),
                    )),
                    _ => None,
                })
                .collect(),
            Some(Value::List(list)) => list
                .iter()
                .filter_map(|node| match &node.value {
                    Value::Table(table) => Some(("", Reader::new(self.sources, table, node.span))),
                    _ => None,
                })
                .collect(),
            _ => Vec::new(),
        }
    }
}

fn vector<const D: usize>(node: &Node) -> Option<[f64; D]> {
    let Value::List(list) = &node.value else {
        return None;
    };
    let numbers: Option<Vec<f64>> = list.iter().map(|node| node.value.as_number()).collect();
    numbers?.try_into().ok()
}
