//! Tables of reference numbers.

use lahar::math::Matrix;

/// A table of numbers, read from text with comments after `#` and a first line of column names.
#[derive(Clone, Debug)]
pub struct Table<'a> {
    /// Names of the columns.
    pub names: Vec<&'a str>,
    /// Rows of numbers; a word that is not a number is NaN.
    pub rows: Vec<Vec<f64>>,
}

impl<'a> Table<'a> {
    /// Parses a table.
    pub fn parse(text: &'a str) -> Self {
        let mut lines = text.lines().filter(|line| !line.starts_with('#'));
        let names = lines.next().unwrap_or_default().split(',').collect();
        let number = |word: &str| word.parse().unwrap_or(f64::NAN);
        let row = |line: &str| line.split(',').map(number).collect();
        Self {
            names,
            rows: lines.map(row).collect(),
        }
    }

    /// Returns the number of a row in the column `name`; NaN if there is no such column.
    pub fn get(&self, row: &[f64], name: &str) -> f64 {
        let column = self.names.iter().position(|known| *known == name);
        column.map_or(f64::NAN, |column| row[column])
    }

    /// Returns the matrix in the columns NAME11, NAME12, ... of a row.
    pub fn matrix<const D: usize>(&self, row: &[f64], name: &str) -> Matrix<f64, D> {
        Matrix::from_fn(|i, j| self.get(row, &format!("{name}{}{}", i + 1, j + 1)))
    }

    /// Returns the symmetric matrix in the columns NAME11, NAME12, ... of a row, which has no entries below the diagonal.
    pub fn symmetric<const D: usize>(&self, row: &[f64], name: &str) -> Matrix<f64, D> {
        Matrix::from_fn(|i, j| {
            let (i, j) = (i.min(j) + 1, i.max(j) + 1);
            self.get(row, &format!("{name}{i}{j}"))
        })
    }
}
