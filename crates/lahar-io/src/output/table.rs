//! A csv file of a run (`diagnostics.csv` or `probes/NAME.csv`), read back.

use std::fs;
use std::path::Path;

use crate::files::OutputError;

/// A table of named columns of numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    names: Vec<String>,
    /// One column per name, all of one length.
    columns: Vec<Vec<f64>>,
}

impl Table {
    /// Reads the file `path`: a line of names, then lines with one value per name. A value that is not a number (such as
    /// the word in `dt_limit`) is read as NaN. A last line without line end, as a killed run may leave, is left out.
    ///
    /// # Errors
    /// If the file cannot be read, or a line does not have one value per name.
    pub fn read(path: &Path) -> Result<Self, OutputError> {
        let text = fs::read_to_string(path)
            .map_err(|error| OutputError::usage(path, format!("cannot read: {error}")))?;
        Self::parse(&text).map_err(|what| OutputError::usage(path, what))
    }

    /// Reads the words of one column of the file `path`.
    ///
    /// # Errors
    /// As [`Self::read`], or if there is no such column.
    pub fn words(path: &Path, column: &str) -> Result<Vec<String>, OutputError> {
        let names = Self::read(path)?.names;
        let index = (names.iter().position(|name| name == column))
            .ok_or_else(|| OutputError::usage(path, format!("there is no column \"{column}\"")))?;
        let text = fs::read_to_string(path)
            .map_err(|error| OutputError::usage(path, format!("cannot read: {error}")))?;
        let whole = text.rfind('\n').map_or("", |end| &text[..end]);
        let word = |line: &str| line.split(',').nth(index).map(str::to_owned);
        Ok(whole.lines().skip(1).filter_map(word).collect())
    }

    fn parse(text: &str) -> Result<Self, String> {
        let whole = text.rfind('\n').map_or("", |end| &text[..end]);
        let mut lines = whole.lines();
        let names: Vec<String> = match lines.next() {
            Some(line) if !line.is_empty() => line.split(',').map(str::to_owned).collect(),
            _ => return Err("the line of names is missing".to_owned()),
        };
        let mut columns = vec![Vec::new(); names.len()];
        for (number, line) in lines.enumerate() {
            let values: Vec<&str> = line.split(',').collect();
            if values.len() != names.len() {
                return Err(format!(
                    "line {} has {} values for {} names",
                    number + 2,
                    values.len(),
                    names.len()
                ));
            }
            for (column, value) in columns.iter_mut().zip(values) {
                column.push(value.parse().unwrap_or(f64::NAN));
            }
        }
        Ok(Self { names, columns })
    }

    /// Returns the column with this name.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        let index = self.names.iter().position(|n| n == name)?;
        Some(&self.columns[index])
    }

    /// Returns all names, in the order of the file.
    pub fn names(&self) -> &[String] {
        &self.names
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_by_name() {
        let table = Table::parse("time,dt_limit,volume\n0,none,1.5\n0.5,sound,1e-3\n").unwrap();
        assert_eq!(table.column("time"), Some(&[0.0, 0.5][..]));
        assert_eq!(table.column("volume"), Some(&[1.5, 1e-3][..]));
        assert!(table.column("dt_limit").unwrap()[0].is_nan());
        assert_eq!(table.column("mass"), None);
    }

    #[test]
    fn a_cut_line_is_left_out_and_a_wrong_one_is_an_error() {
        let table = Table::parse("time,volume\n0,1\n0.5,1.2").unwrap();
        assert_eq!(table.column("time"), Some(&[0.0][..]));
        let error = Table::parse("time,volume\n0,1\n0.5\n1,1\n").unwrap_err();
        assert!(error.contains("line 3 has 1 values for 2 names"), "{error}");
        assert!(Table::parse("").is_err());
    }
}
