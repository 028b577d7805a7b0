//! Particle lists, from which bodies start: comma-separated text, or NumPy's `.npz`. (PLY is in [`crate::ply`].)

#[cfg(feature = "npz")]
mod arrays;

#[cfg(feature = "npz")]
pub(crate) use arrays::{from_arrays, read_npz};

use crate::error::{SceneError, nearest};
use crate::text::{AXES, Lines, shorten};
use lahar::material::Variable;
use lahar::math::Shape;
use lahar::particles::FIELDS;
use lahar::{Field, StartingValues};

/// A list of particles: columns with one entry per particle. Columns that the file does not have are empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParticleList<const D: usize> {
    /// Positions of the particles \[m\].
    pub position: Vec<[f64; D]>,
    /// Velocities of the particles \[m/s\].
    pub velocity: Vec<[f64; D]>,
    /// Rest volumes \[m³; m² in 2D\].
    pub volume: Vec<f64>,
    /// Masses of the particles \[kg\].
    pub mass: Vec<f64>,
    /// The Jacobians J = V/V⁰.
    pub jacobian: Vec<f64>,
    /// The deformation gradients F, row by row.
    pub deformation_gradient: Vec<[[f64; D]; D]>,
    /// The affine velocity matrices C \[1/s\], row by row.
    pub affine: Vec<[[f64; D]; D]>,
    /// Other internal variables of models, such as J_P.
    pub variables: Vec<StartingValues>,
    /// Warnings about the file.
    pub warnings: Vec<String>,
}

/// The quantity of a column of a text file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Column {
    Position(usize),
    Velocity(usize),
    Volume,
    Mass,
    Jacobian,
    Gradient(usize, usize),
    Affine(usize, usize),
    /// An internal variable, and the entry of it.
    Variable(&'static Variable, usize),
}

impl Column {
    /// Returns true if the quantity must be above 0.
    fn is_positive(self) -> bool {
        match self {
            Self::Volume | Self::Mass | Self::Jacobian => true,
            Self::Variable(variable, _) => variable.is_positive(),
            Self::Position(_) | Self::Velocity(_) | Self::Gradient(..) | Self::Affine(..) => false,
        }
    }
}

/// Returns the internal variables of models that a list may have besides J and F.
pub(crate) fn known_variables() -> impl Iterator<Item = &'static Variable> {
    FIELDS.iter().filter_map(|info| match info.field {
        Field::Variable(variable) => Some(variable),
        Field::Id
        | Field::Body
        | Field::Material
        | Field::Position
        | Field::Velocity
        | Field::Affine
        | Field::Jacobian
        | Field::DeformationGradient
        | Field::Pressure
        | Field::Mass
        | Field::Volume0 => None,
    })
}

/// Returns every column that a file may have, with its name.
pub(crate) fn known_columns<const D: usize>() -> Vec<(String, Column)> {
    let mut known = Vec::new();
    known.extend((0..D).map(|i| (AXES[i].to_owned(), Column::Position(i))));
    known.extend((0..D).map(|i| (format!("v{}", AXES[i]), Column::Velocity(i))));
    known.extend([
        ("volume".to_owned(), Column::Volume),
        ("mass".to_owned(), Column::Mass),
        ("J".to_owned(), Column::Jacobian),
    ]);
    for i in 0..D {
        for j in 0..D {
            known.push((format!("F{}{}", i + 1, j + 1), Column::Gradient(i, j)));
            known.push((format!("C{}{}", i + 1, j + 1), Column::Affine(i, j)));
        }
    }
    for variable in known_variables() {
        for entry in 0..variable.shape.len(D) {
            let name = match variable.shape {
                Shape::Scalar => variable.name.to_owned(),
                Shape::Vector => format!("{}_{}", variable.name, AXES[entry]),
                Shape::Matrix => format!("{}_{}{}", variable.name, entry / D + 1, entry % D + 1),
            };
            known.push((name, Column::Variable(variable, entry)));
        }
    }
    known
}

/// Reads comma-separated text with a header line. Empty lines and lines that begin with `#` are skipped.
/// `name` is the file's, for messages.
///
/// ```
/// let text = "x,y,volume\n0.1,0.2,1e-4\n0.3,0.2,1e-4\n";
/// let list = lahar_scene::particle_list::parse_csv::<2>(text, "two.csv")?;
/// assert_eq!(list.position, [[0.1, 0.2], [0.3, 0.2]]);
/// # Ok::<(), lahar_scene::error::SceneError>(())
/// ```
///
/// # Errors
/// The first line that disagrees with the header, or a value that particles cannot have.
pub fn parse_csv<const D: usize>(text: &str, name: &str) -> Result<ParticleList<D>, SceneError> {
    let mut lines =
        Lines { text, at: 0 }.filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
    let Some((start, header)) = lines.next() else {
        return Err(
            SceneError::of_file(name, "the particle list is empty").hint(format!(
                "its first line names the columns: {}, ..",
                AXES[..D].join(",")
            )),
        );
    };
    let columns = parse_header::<D>(text, name, start, header)?;
    let mut list = ParticleList::default();
    let mut values = Vec::with_capacity(columns.len());
    for (start, line) in lines {
        values.clear();
        for (field_start, field) in fields(start, line) {
            let Some(&column) = columns.get(values.len()) else {
                break;
            };
            let end = field_start + field.len();
            let number = parse_number(field, column)
                .map_err(|message| SceneError::at(name, text, field_start, end, message))?;
            values.push(number);
        }
        let found = line.split(',').count();
        if found != columns.len() {
            let error = SceneError::at(
                name,
                text,
                start,
                start + line.len(),
                format!(
                    "this line has {found} values, the header names {}",
                    columns.len()
                ),
            );
            let last = text[start..].trim_end().lines().count() <= 1;
            return Err(if last {
                error.hint("it is the last line: was the file cut short?")
            } else {
                error
            });
        }
        list.add(&columns, &values);
    }
    if !text.ends_with('\n') {
        list.warnings.push(format!(
            "{name}: the last line has no line end; was the file cut short?"
        ));
    }
    Ok(list)
}

fn parse_header<const D: usize>(
    text: &str,
    name: &str,
    start: usize,
    header: &str,
) -> Result<Vec<Column>, SceneError> {
    let known = known_columns::<D>();
    let mut columns = Vec::new();
    for (at, field) in fields(start, header) {
        let error = |message: String| SceneError::at(name, text, at, at + field.len(), message);
        let Some((_, column)) = known.iter().find(|(known, _)| known == field) else {
            let error = error(format!("unknown column \"{}\"", shorten(field)));
            if field.parse::<f64>().is_ok() {
                return Err(error.hint(format!(
                    "the first line must name the columns: {}, ..",
                    AXES[..D].join(",")
                )));
            }
            if field.contains(';') {
                return Err(error.hint("columns are parted by commas, decimals by points"));
            }
            if D == 2 && ["z", "vz"].contains(&field) {
                return Err(error.hint("this scene has dimension = 2"));
            }
            return Err(
                match nearest(field, known.iter().map(|(name, _)| name.as_str())) {
                    Some(near) => error.hint(format!("did you mean \"{near}\"?")),
                    None => {
                        let variables: Vec<&str> = known_variables().map(|v| v.name).collect();
                        error.hint(format!(
                            "known: x, y, z, vx, vy, vz, volume, mass, J, F11, F12, .., C11, C12, .., {}",
                            variables.join(", ")
                        ))
                    }
                },
            );
        };
        if columns.contains(column) {
            return Err(error(format!("the column \"{field}\" is there twice")));
        }
        columns.push(*column);
    }
    if let Err(message) = check_columns::<D>(&columns) {
        let end = start + header.len();
        return Err(SceneError::at(name, text, start, end, message));
    }
    Ok(columns)
}

/// Reads a number that a particle can have in `column`.
pub(crate) fn parse_number(field: &str, column: Column) -> Result<f64, String> {
    match field.parse::<f64>() {
        Ok(number) => check_number(number, column),
        Err(_) => Err(format!("\"{}\" is not a number", shorten(field))),
    }
}

/// Returns the number, if a particle can have it in `column`.
pub(crate) fn check_number(number: f64, column: Column) -> Result<f64, String> {
    if !number.is_finite() {
        return Err(format!("{number} is no value for a particle"));
    }
    if column.is_positive() && number <= 0.0 {
        return Err(format!("{number} must be above 0"));
    }
    Ok(number)
}

impl<const D: usize> ParticleList<D> {
    /// Adds a particle with one value per column.
    pub(crate) fn add(&mut self, columns: &[Column], values: &[f64]) {
        let mut position = [0.0; D];
        let mut velocity = None;
        let mut gradient = None;
        let mut affine = None;
        for (column, &value) in columns.iter().zip(values) {
            match *column {
                Column::Position(i) => position[i] = value,
                Column::Velocity(i) => velocity.get_or_insert([0.0; D])[i] = value,
                Column::Volume => self.volume.push(value),
                Column::Mass => self.mass.push(value),
                Column::Jacobian => self.jacobian.push(value),
                Column::Gradient(i, j) => gradient.get_or_insert([[0.0; D]; D])[i][j] = value,
                Column::Affine(i, j) => affine.get_or_insert([[0.0; D]; D])[i][j] = value,
                Column::Variable(variable, entry) => self.set_variable(variable, entry, value),
            }
        }
        self.position.push(position);
        self.velocity.extend(velocity);
        self.deformation_gradient.extend(gradient);
        self.affine.extend(affine);
    }

    /// Sets an entry of a variable of the particle that is being added.
    fn set_variable(&mut self, variable: &Variable, entry: usize, value: f64) {
        let (row, width) = (self.position.len(), variable.shape.len(D));
        let known = (self.variables.iter()).position(|given| given.name == variable.name);
        let index = known.unwrap_or_else(|| {
            self.variables.push(StartingValues {
                name: variable.name.to_owned(),
                values: Vec::new(),
            });
            self.variables.len() - 1
        });
        let values = &mut self.variables[index].values;
        values.resize((row + 1) * width, 0.0);
        values[row * width + entry] = value;
    }
}

/// Checks the columns of a file: positions must be there, and vectors and matrices must be complete.
pub(crate) fn check_columns<const D: usize>(columns: &[Column]) -> Result<(), String> {
    let group = |column: &Column| match column {
        Column::Position(_) => 1,
        Column::Velocity(_) => 2,
        Column::Gradient(..) => 3,
        Column::Affine(..) => 4,
        Column::Volume | Column::Mass | Column::Jacobian | Column::Variable(..) => 0,
    };
    let of_variable = |column: &Column, other: &Column| match (column, other) {
        (Column::Variable(a, _), Column::Variable(b, _)) => a == b,
        _ => false,
    };
    for (column_name, column) in &known_columns::<D>() {
        let of_group = group(column);
        let wanted = of_group == 1
            || (of_group > 1 && columns.iter().any(|other| group(other) == of_group))
            || columns.iter().any(|other| of_variable(column, other));
        if wanted && !columns.contains(column) {
            return Err(format!("there is no column \"{column_name}\""));
        }
    }
    if columns.contains(&Column::Jacobian) && columns.contains(&Column::Gradient(0, 0)) {
        return Err("columns J and F11, F12, .. say the same; give one".to_owned());
    }
    Ok(())
}

/// Returns the fields of a line, trimmed, each with the byte at which it starts.
fn fields(start: usize, line: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut at = start;
    line.split(',').map(move |field| {
        let begin = at + (field.len() - field.trim_start().len());
        at += field.len() + 1;
        (begin, field.trim())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn reads_columns_in_any_order() {
        let text = "# start\nvolume, y,x ,vx,vy\n1e-3,2,1,3,4\r\n\n2e-3,-2,-1,0,0\n";
        let list = parse_csv::<2>(text, "a.csv").unwrap();
        assert_eq!(list.position, [[1.0, 2.0], [-1.0, -2.0]]);
        assert_eq!(list.velocity, [[3.0, 4.0], [0.0, 0.0]]);
        assert_eq!(list.volume, [1e-3, 2e-3]);
        assert!(list.mass.is_empty() && list.warnings.is_empty());
        let list = parse_csv::<2>("x,y,F11,F12,F21,F22\n0,0,1,2,3,4", "a.csv").unwrap();
        assert_eq!(list.deformation_gradient, [[[1.0, 2.0], [3.0, 4.0]]]);
        assert_eq!(list.warnings.len(), 1);
        let list = parse_csv::<2>("x,plastic_J,y\n0,0.8,0\n1,1,1\n", "a.csv").unwrap();
        let plastic = StartingValues {
            name: "plastic_J".to_owned(),
            values: vec![0.8, 1.0],
        };
        assert_eq!(list.variables, [plastic]);
    }

    #[test]
    fn points_at_what_is_wrong() {
        let error = |text: &str| {
            let error = parse_csv::<2>(text, "a.csv").unwrap_err();
            (error.line, error.column, error.message)
        };
        assert_eq!(
            error("x,y\n1,2\n3,4x\n"),
            (3, 3, "\"4x\" is not a number".to_owned())
        );
        assert_eq!(
            error("x,y\n1,nan\n"),
            (2, 3, "NaN is no value for a particle".to_owned())
        );
        assert_eq!(
            error("x,y,mass\n1,2,-3\n"),
            (2, 5, "-3 must be above 0".to_owned())
        );
        assert_eq!(
            error("x,y\n1,2\n3\n").2,
            "this line has 1 values, the header names 2"
        );
        assert_eq!(
            error("x,y\n1,2,3\n").2,
            "this line has 3 values, the header names 2"
        );
        assert_eq!(error("x,y,vx\n").2, "there is no column \"vy\"");
        assert_eq!(error("x,vy\n").2, "there is no column \"y\"");
        assert_eq!(error("").0, 0);
    }

    proptest! {
        #[test]
        fn altered_text_never_panics(cuts in proptest::collection::vec((0_usize..200, 0_usize..9, "[-0-9a-zéJF,. \n\r#e+]{0,6}"), 1..4)) {
            let mut text = "# start\nx,y,vx,vy,volume,F11,F12,F21,F22\n1,2,3,4,1e-3,1,0,0,1\n2,2,3,4,1e-3,1,0,0,1\n".to_owned();
            for (at, length, piece) in cuts {
                let mut start = at % text.len();
                while !text.is_char_boundary(start) { start -= 1; }
                let mut end = (start + length).min(text.len());
                while !text.is_char_boundary(end) { end += 1; }
                text.replace_range(start..end, &piece);
                text.push('.');
            }
            for error in [parse_csv::<2>(&text, "a.csv").err(), parse_csv::<3>(&text, "a.csv").err()].into_iter().flatten() {
                error.render(true);
            }
        }
    }
}
