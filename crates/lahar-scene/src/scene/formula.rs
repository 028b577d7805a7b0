//! Vectors of numbers or formulas: gravity, forces, velocities at the start.

use super::document::{Node, Sources, Value};
use crate::error::SceneError;
use crate::expression::{BLOCK, Expression};
use lahar::AccelerationField;

/// Number of the variable x; y and z follow.
const X: usize = 0;
/// Number of the variable t.
const T: usize = 3;
/// Number of the variable X; Y and Z follow.
const START: usize = 4;

/// The variables that a formula may depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Variables {
    /// The position x, y, z.
    Place,
    /// The position x, y, z, the time t, and the position X, Y, Z at which a particle started.
    PlaceAndTime,
}

impl Variables {
    /// Returns the names of the variables, in the order of their numbers.
    fn variables(self, dimension: usize) -> Vec<&'static str> {
        match (self, dimension) {
            (Self::Place, 2) => vec!["x", "y"],
            (Self::Place, _) => vec!["x", "y", "z"],
            // "(z)" keeps the numbers the same as in 3D. No formula can contain such a name.
            (Self::PlaceAndTime, 2) => vec!["x", "y", "(z)", "t", "X", "Y"],
            (Self::PlaceAndTime, _) => vec!["x", "y", "z", "t", "X", "Y", "Z"],
        }
    }

    /// Reads one component of a vector.
    pub(crate) fn parse(
        self,
        text: &str,
        dimension: usize,
    ) -> Result<Expression, crate::expression::ExpressionError> {
        Expression::parse(text, &self.variables(dimension))
    }
}

/// A vector of D formulas. A number is a formula too.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Formulas<const D: usize>(pub(crate) [Expression; D]);

impl<const D: usize> Formulas<D> {
    /// Returns the components that are numbers, and 0 for the others.
    pub(crate) fn constants(&self) -> [f64; D] {
        core::array::from_fn(|i| self.0[i].constant().unwrap_or(0.0))
    }

    /// Returns true if all components are numbers.
    pub(crate) fn is_constant(&self) -> bool {
        self.0.iter().all(|formula| formula.constant().is_some())
    }

    /// Returns the formulas minus [`Self::constants`].
    pub(crate) fn without_constants(mut self) -> Self {
        for formula in &mut self.0 {
            if formula.constant().is_some() {
                *formula = Expression::number(0.0);
            }
        }
        self
    }

    /// Returns the values at `positions` \[m\] at time 0.
    pub(crate) fn at(&self, positions: &[[f64; D]]) -> Vec<[f64; D]> {
        let mut out = vec![[0.0; D]; positions.len()];
        self.accelerations(0.0, positions, positions, &mut out);
        out
    }
}

impl<const D: usize> AccelerationField<D> for Formulas<D> {
    fn accelerations(
        &self,
        time: f64,
        positions: &[[f64; D]],
        starts: &[[f64; D]],
        out: &mut [[f64; D]],
    ) {
        for (axis, formula) in self.0.iter().enumerate() {
            // A component without variables is computed once.
            let same = (0..D).all(|i| !formula.uses(X + i) && !formula.uses(START + i));
            if same {
                let mut value = [0.0];
                formula.evaluate(&mut value, |_, _, column| column.fill(time));
                out.iter_mut().for_each(|a| a[axis] = value[0]);
                continue;
            }
            let mut column = [0.0; BLOCK];
            for (block, out) in out.chunks_mut(BLOCK).enumerate() {
                let values = &mut column[..out.len()];
                formula.evaluate(values, |variable, first, column| {
                    let (points, i) = match variable {
                        T => return column.fill(time),
                        START.. => (starts, variable - START),
                        _ => (positions, variable - X),
                    };
                    for (value, point) in column.iter_mut().zip(&points[block * BLOCK + first..]) {
                        *value = point[i];
                    }
                });
                for (a, value) in out.iter_mut().zip(&*values) {
                    a[axis] = *value;
                }
            }
        }
    }

    fn depends_on_start(&self) -> bool {
        self.0
            .iter()
            .any(|formula| (0..D).any(|i| formula.uses(START + i)))
    }
}

/// An expression of a scene; what is wrong with it is pointed at.
pub(crate) fn read_formula(
    sources: &Sources,
    node: &Node,
    variables: Variables,
    dimension: usize,
) -> Result<Expression, SceneError> {
    let text = match &node.value {
        Value::Text(text) => text,
        other => {
            let number = other.as_number().unwrap_or(f64::NAN);
            return Ok(Expression::number(number));
        }
    };
    variables.parse(text, dimension).map_err(|error| {
        let span = sources.within(node.span, text, error.place);
        let found = sources.error(span, error.message);
        match error.hint {
            Some(hint) => found.hint(hint),
            None => found,
        }
    })
}
