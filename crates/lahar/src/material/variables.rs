//! The internal variables of constitutive models, each declared once in a table.
//!
//! A model declares what it remembers of a particle with [`variables!`](crate::variables):
//!
//! ```text
//!   variables! {                                            columns of storage (2D)
//!       pub struct PlasticGradient<R, const D: usize> {
//!           h: Matrix<R, D> = DEFORMATION_GRADIENT,           H₀₀ H₁₀ H₀₁ H₁₁
//!           plastic_jacobian_minus_one: R = PLASTIC_JACOBIAN,                 J_P−1
//!       }
//!   }
//! ```
//!
//! The table gives the columns of storage and of checkpoints. Each variable that is not hidden is
//! also a field of snapshots ([`Field::Variable`](crate::Field::Variable)), hence of all exports, and
//! a column that lists of starting particles may have.
//!
//! Storage holds the difference from the value at rest, J − 1 and H = F − I: in `f32`, J itself
//! drifts (.04 % of a tank's height in 5·10⁴ substeps), and small strains drown in the rounding of
//! the 1.

use crate::math::{Matrix, Real, Shape};

/// An internal variable of a constitutive model: one number or matrix per particle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Variable {
    /// Its name in snapshots, particle lists, exports and checkpoints.
    pub name: &'static str,
    /// Its unit; "1" for a ratio.
    pub unit: &'static str,
    /// The shape of its value.
    pub shape: Shape,
    /// Its value at rest.
    pub rest: Rest,
    /// True for a variable that only the law itself reads: it is in checkpoints, but neither in
    /// snapshots nor in particle lists.
    pub is_hidden: bool,
}

/// The value of a variable in a particle that has never been deformed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Rest {
    /// The value 0.
    Zero,
    /// 1, or the identity matrix. The variable is a ratio of volumes or lengths, and stored as its
    /// difference from 1; a scalar of this kind is positive.
    One,
}

impl Variable {
    /// Declares a scalar.
    pub const fn scalar(name: &'static str, unit: &'static str, rest: Rest) -> Self {
        Self {
            name,
            unit,
            shape: Shape::Scalar,
            rest,
            is_hidden: false,
        }
    }

    /// The same variable, hidden from snapshots and particle lists.
    pub const fn hidden(self) -> Self {
        Self {
            is_hidden: true,
            ..self
        }
    }

    /// Returns true for a scalar that must be above 0.
    ///
    /// ```
    /// use lahar::material::{DEFORMATION_GRADIENT, JACOBIAN};
    ///
    /// assert!(JACOBIAN.is_positive() && !DEFORMATION_GRADIENT.is_positive());
    /// ```
    pub fn is_positive(&self) -> bool {
        self.rest == Rest::One && self.shape == Shape::Scalar
    }

    /// Returns true if all `values` are those at rest, the entries of one particle after the other.
    pub fn is_at_rest(&self, values: &[f64], dimension: usize) -> bool {
        let width = self.shape.len(dimension);
        (values.iter().enumerate()).all(|(i, value)| *value == self.rest_of(i % width, dimension))
    }

    /// The value at rest of entry `entry`, the entries of a matrix being counted row by row.
    pub(crate) fn rest_of(&self, entry: usize, dimension: usize) -> f64 {
        match (self.rest, self.shape) {
            (Rest::Zero, _) => 0.0,
            (Rest::One, Shape::Scalar | Shape::Vector) => 1.0,
            (Rest::One, Shape::Matrix) if entry / dimension == entry % dimension => 1.0,
            (Rest::One, Shape::Matrix) => 0.0,
        }
    }

    /// The column of entry `entry` among the columns of this variable. Matrices are stored column by
    /// column, and shown row by row.
    pub(crate) fn column_of(&self, entry: usize, dimension: usize) -> usize {
        match self.shape {
            Shape::Scalar | Shape::Vector => entry,
            Shape::Matrix => entry % dimension * dimension + entry / dimension,
        }
    }

    const fn is(&self, other: &Self) -> bool {
        let (a, b) = (self.name.as_bytes(), other.name.as_bytes());
        let mut i = 0;
        while i < a.len() && i < b.len() && a[i] == b[i] {
            i += 1;
        }
        i == a.len() && i == b.len()
    }
}

/// J = V/V⁰, the ratio of volume to rest volume; for plastic models, of the elastic part.
pub const JACOBIAN: Variable = Variable::scalar("J", "1", Rest::One);

/// The deformation gradient F; for plastic models, of the elastic part.
pub const DEFORMATION_GRADIENT: Variable = Variable {
    name: "deformation_gradient",
    unit: "1",
    shape: Shape::Matrix,
    rest: Rest::One,
    is_hidden: false,
};

/// The internal variables of one particle, or of a register `R` of particles, in `D` dimensions.
/// Implemented by [`variables!`](crate::variables).
pub trait Variables<R: Real, const D: usize>: Copy {
    /// The variables, in the order of storage.
    const TABLE: &'static [Variable];
    /// The number of columns of storage.
    const COLUMNS: usize = columns(Self::TABLE, D);
    /// Returns the variables of particles that have never been deformed, in the lanes of `like`.
    fn rest(like: R) -> Self;
    /// Reads the variables from their columns.
    fn read(column: impl FnMut(usize) -> R) -> Self;
    /// Writes the variables to their columns.
    fn write(&self, column: impl FnMut(usize, R));
}

/// The number of columns of the variables in `table`.
pub(crate) const fn columns(table: &[Variable], dimension: usize) -> usize {
    let (mut columns, mut i) = (0, 0);
    while i < table.len() {
        columns += table[i].shape.len(dimension);
        i += 1;
    }
    columns
}

/// The first column of the variable called `name`, and the variable; `None` if `table` has none.
pub(crate) fn find(
    table: &'static [Variable],
    name: &str,
    dimension: usize,
) -> Option<(usize, &'static Variable)> {
    let index = table.iter().position(|variable| variable.name == name)?;
    Some((columns(&table[..index], dimension), &table[index]))
}

/// Returns the values of `variable` in a particle of a model with the variables `table`, entry by entry,
/// from the columns that it stores; at rest if the model does not have the variable.
pub(crate) fn values(
    variable: &Variable,
    table: &'static [Variable],
    stored: &[f64],
    dimension: usize,
) -> impl Iterator<Item = f64> {
    let first = find(table, variable.name, dimension).map(|(first, _)| first);
    (0..variable.shape.len(dimension)).map(move |entry| {
        let change = first.map(|first| stored[first + variable.column_of(entry, dimension)]);
        variable.rest_of(entry, dimension) + change.unwrap_or(0.0)
    })
}

/// The variables of all `tables` that snapshots show besides J and F, each once; the second number is
/// their count.
pub(super) const fn shown<const MOST: usize>(tables: &[&[Variable]]) -> ([Variable; MOST], usize) {
    let (mut found, mut count) = ([JACOBIAN; MOST], 0);
    let mut table = 0;
    while table < tables.len() {
        let mut i = 0;
        while i < tables[table].len() {
            let variable = tables[table][i];
            let mut known =
                variable.is_hidden || variable.is(&JACOBIAN) || variable.is(&DEFORMATION_GRADIENT);
            let mut k = 0;
            while k < count {
                known = known || variable.is(&found[k]);
                k += 1;
            }
            if !known {
                found[count] = variable;
                count += 1;
            }
            i += 1;
        }
        table += 1;
    }
    (found, count)
}

/// A kind of variable as [`variables!`](crate::variables) reads and writes it.
#[doc(hidden)]
pub trait Entries<R: Real>: Copy {
    const SHAPE: Shape;
    fn zero(like: R) -> Self;
    fn read(column: &mut impl FnMut(usize) -> R, at: &mut usize) -> Self;
    fn write(&self, column: &mut impl FnMut(usize, R), at: &mut usize);
}

impl<R: Real> Entries<R> for R {
    const SHAPE: Shape = Shape::Scalar;
    #[inline(always)]
    fn zero(like: R) -> Self {
        Real::zero(like)
    }
    #[inline(always)]
    fn read(column: &mut impl FnMut(usize) -> R, at: &mut usize) -> Self {
        *at += 1;
        column(*at - 1)
    }
    #[inline(always)]
    fn write(&self, column: &mut impl FnMut(usize, R), at: &mut usize) {
        column(*at, *self);
        *at += 1;
    }
}

impl<R: Real, const D: usize> Entries<R> for Matrix<R, D> {
    const SHAPE: Shape = Shape::Matrix;
    #[inline(always)]
    fn zero(like: R) -> Self {
        Self::scaled_identity(like.zero())
    }
    #[inline(always)]
    fn read(column: &mut impl FnMut(usize) -> R, at: &mut usize) -> Self {
        let first = *at;
        *at += D * D;
        Self::from_fn(|i, j| column(first + j * D + i))
    }
    #[inline(always)]
    fn write(&self, column: &mut impl FnMut(usize, R), at: &mut usize) {
        for j in 0..D {
            for i in 0..D {
                column(*at + j * D + i, self[(i, j)]);
            }
        }
        *at += D * D;
    }
}

/// Declares the internal variables of a constitutive model as a struct, and implements
/// [`Variables`](crate::material::Variables) for it.
///
/// Each field is a number `R` or a `Matrix<R, D>`, and names the
/// [`Variable`](crate::material::Variable) whose difference from rest it stores. A model without
/// matrices writes `<R>` in place of `<R, const D: usize>`.
///
/// ```
/// use lahar::material::{DEFORMATION_GRADIENT, Rest, Variable, Variables};
/// use lahar::math::Matrix;
///
/// /// The part of the material that is broken, from 0 to 1.
/// const DAMAGE: Variable = Variable::scalar("damage", "1", Rest::Zero);
///
/// lahar::variables! {
///     /// The deformation and the damage of a brittle solid.
///     pub struct Brittle<R, const D: usize> {
///         /// H = F − I.
///         h: Matrix<R, D> = DEFORMATION_GRADIENT,
///         /// The damage.
///         damage: R = DAMAGE,
///     }
/// }
///
/// assert_eq!(<Brittle<f32, 3> as Variables<f32, 3>>::COLUMNS, 10);
/// ```
#[macro_export]
macro_rules! variables {
    (
        $(#[$doc:meta])*
        pub struct $name:ident<R $(, const $dimension:ident: usize)?> {
            $($(#[$field_doc:meta])* $field:ident: $type:ty = $variable:expr,)+
        }
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub struct $name<R $(, const $dimension: usize)?> {
            $($(#[$field_doc])* pub $field: $type,)+
        }

        impl<R: $crate::math::Real, const D: usize> $crate::material::Variables<R, D>
            for $name<R $(, $dimension)?>
        {
            const TABLE: &'static [$crate::material::Variable] = &[$({
                let variable: $crate::material::Variable = $variable;
                let shape = <$type as $crate::material::Entries<R>>::SHAPE;
                assert!(variable.shape as u8 == shape as u8, "the field has another shape");
                variable
            }),+];
            #[inline(always)]
            fn rest(like: R) -> Self {
                Self { $($field: $crate::material::Entries::zero(like),)+ }
            }
            #[inline(always)]
            fn read(mut column: impl FnMut(usize) -> R) -> Self {
                let mut at = 0;
                Self { $($field: $crate::material::Entries::read(&mut column, &mut at),)+ }
            }
            #[inline(always)]
            fn write(&self, mut column: impl FnMut(usize, R)) {
                let mut at = 0;
                $($crate::material::Entries::write(&self.$field, &mut column, &mut at);)+
            }
        }
    };
}
