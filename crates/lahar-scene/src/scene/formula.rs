//! Vectors of a scene that are numbers or formulas: gravity, forces, velocities at the start.

use super::document::{Node, Sources, Value};
use crate::error::SceneError;
use crate::expression::{BLOCK, Expression};
use lahar::AccelerationField;

/// Variables of formulas, by their numbers: place, time, place at the start.
const X: usize = 0;
const T: usize = 3;
const START: usize = 4;

/// A formula may not depend on everything.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Of {
    /// x, y, z.
    Place,
    /// x, y, z, t, and X, Y, Z where a particle started.
    PlaceAndTime,
}

impl Of {
    /// Names of the variables, in the order of their numbers.
    fn variables(self, dimension: usize) -> Vec<&'static str> {
        match (self, dimension) {
            (Self::Place, 2) => vec!["x", "y"],
            (Self::Place, _) => vec!["x", "y", "z"],
            // No formula can contain a name of two words, so that the numbers stay the same.
            (Self::PlaceAndTime, 2) => vec!["x", "y", "(z)", "t", "X", "Y"],
            (Self::PlaceAndTime, _) => vec!["x", "y", "z", "t", "X", "Y", "Z"],
        }
    }

    /// Reads one component.
    pub(crate) fn parse(
        self,
        text: &str,
        dimension: usize,
    ) -> Result<Expression, crate::expression::ExpressionError> {
        Expression::parse(text, &self.variables(dimension))
    }
}

/// D components, each a formula; numbers are formulas too.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Formulas<const D: usize>(pub(crate) [Expression; D]);

impl<const D: usize> Formulas<D> {
    /// The components that are numbers; 0 where they are not.
    pub(crate) fn constants(&self) -> [f64; D] {
        core::array::from_fn(|i| self.0[i].constant().unwrap_or(0.0))
    }

    /// Whether all are numbers.
    pub(crate) fn is_constant(&self) -> bool {
        self.0.iter().all(|formula| formula.constant().is_some())
    }

    /// The rest when [`Self::constants`] are taken away.
    pub(crate) fn without_constants(mut self) -> Self {
        for formula in &mut self.0 {
            if formula.constant().is_some() {
                *formula = Expression::number(0.0);
            }
        }
        self
    }

    /// The values at `positions` at the start.
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
            // What is the same everywhere is computed once.
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
    of: Of,
    dimension: usize,
) -> Result<Expression, SceneError> {
    let text = match &node.value {
        Value::Text(text) => text,
        other => {
            let number = other.as_number().unwrap_or(f64::NAN);
            return Ok(Expression::number(number));
        }
    };
    of.parse(text, dimension).map_err(|error| {
        let span = sources.within(node.span, text, error.place);
        let found = sources.error(span, error.message);
        match error.hint {
            Some(hint) => found.hint(hint),
            None => found,
        }
    })
}
