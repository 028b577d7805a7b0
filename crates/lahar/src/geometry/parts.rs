//! Shapes as the simulator's colliders have them.

use super::{Motion, Shape, Solid};

impl<const D: usize> Shape<D> {
    /// The simple solids that it is made of; all that is in any of them is in the shape.
    ///
    /// # Errors
    /// What of it is no such solid.
    pub fn solids(&self) -> Result<Vec<Solid<D>>, &'static str> {
        let one = |solid| Ok(vec![solid]);
        match self {
            Self::Box { min, max } => one(Solid::Box {
                center: core::array::from_fn(|i| 0.5 * (min[i] + max[i])),
                half: core::array::from_fn(|i| 0.5 * (max[i] - min[i])),
                axes: core::array::from_fn(|i| core::array::from_fn(|j| f64::from(i == j))),
            }),
            Self::Ball { center, radius } => one(Solid::Ball {
                center: *center,
                radius: *radius,
            }),
            Self::HalfSpace { point, normal } => one(Solid::HalfSpace {
                point: *point,
                normal: *normal,
            }),
            Self::Rod {
                from,
                to,
                radius,
                round,
            } => one(Solid::Rod {
                from: *from,
                to: *to,
                radius: *radius,
                round: *round,
            }),
            Self::Union(shapes) => {
                let mut all = Vec::new();
                for shape in shapes {
                    all.extend(shape.solids()?);
                }
                Ok(all)
            }
            Self::Moved { shape, motion, .. } => {
                let solids = shape.solids()?;
                solids.iter().map(|solid| moved(solid, motion)).collect()
            }
            Self::Polygon { points } => one(Solid::Polygon {
                points: points.clone(),
            }),
            Self::Mesh(_) => Err("mesh"),
            Self::Intersection(_) => Err("intersection"),
            Self::Difference(_) => Err("difference"),
        }
    }
}

fn moved<const D: usize>(solid: &Solid<D>, motion: &Motion<D>) -> Result<Solid<D>, &'static str> {
    let (place, turned) = (|x| motion.forth(&x), |v| motion.turned(&v));
    match (motion.factor(), solid) {
        (Some(factor), _) => Ok(solid.mapped(place, turned, factor)),
        (None, Solid::Polygon { .. }) => Ok(solid.mapped(place, turned, 1.0)),
        (None, Solid::Box { half, axes, .. })
            if (0..D).all(|i| (0..D).all(|j| i == j || axes[i][j] == 0.0)) =>
        {
            let mut stretched = solid.mapped(place, turned, 1.0);
            let factors = motion.factors();
            if let Solid::Box { half: new, .. } = &mut stretched {
                *new = core::array::from_fn(|i| half[i] * factors[i]);
            }
            Ok(stretched)
        }
        (None, _) => Err("shape scaled by different factors"),
    }
}
