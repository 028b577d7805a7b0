//! The heavy code, compiled once.
//!
//! [`Simulation`](crate::Simulation) is generic, and generic code is compiled again in every crate
//! and test program that uses it: with all instruction sets, minutes each. The loops are therefore
//! reached through [`Instance`], whose four implementations are concrete and so belong to this
//! crate alone.

use crate::array::Element;
use crate::boundary::collider::Moving;
use crate::boundary::impulse::Taken;
use crate::boundary::walls::Walls;
use crate::grid::{Grid, NodeForces, Tiles};
use crate::material::{IsaToken, Law, Model, VolumeCorrection};
use crate::math::Lanes;
use crate::particles::Group;
use crate::setup::Scheme;
use crate::transfer::gather::{Around, Bounds};
use crate::transfer::scatter::What;
use crate::transfer::{gather, scatter, volume};

/// Numbers that there is an engine for in `D` dimensions: `f32` and `f64` in 2D and 3D.
pub trait Instance<const D: usize>: Kernels<D> {}

/// The loops of the method, and the laws.
#[expect(
    private_interfaces,
    reason = "sealed: outside of this crate it is only a bound"
)]
pub trait Kernels<const D: usize>: Lanes + Element {
    /// The law of a built-in model.
    #[doc(hidden)]
    fn built_in(model: &Model) -> Box<dyn Law<Self, D>>;
    /// P2G.
    #[doc(hidden)]
    fn scatter(
        group: &Group<Self, D>,
        scheme: Scheme,
        isa: IsaToken,
        dt: f64,
        what: What,
        tiles: Tiles<'_, Self, D>,
    );
    /// The tiles' sums to the nodes, for gauges and for (7g).
    #[doc(hidden)]
    fn sum_tiles(grid: &mut Grid<Self, D>, isa: IsaToken);
    /// The gathered J − 1.
    #[doc(hidden)]
    fn expansion(
        group: &Group<Self, D>,
        grid: &Grid<Self, D>,
        scheme: Scheme,
        isa: IsaToken,
        out: &mut [Self],
    );
    /// The tiles' sums of volumes to the nodes, and what the nodes answer.
    #[doc(hidden)]
    fn measure_filling(grid: &mut Grid<Self, D>, isa: IsaToken, walls: &Walls<D>, dx: f64);
    /// J − 1 set right by the nodes' answers.
    #[doc(hidden)]
    fn correct_volume(
        group: &Group<Self, D>,
        grid: &Grid<Self, D>,
        scheme: Scheme,
        isa: IsaToken,
        shares: VolumeCorrection,
        jacobian_minus_one: &mut [Self],
    );
    /// The grid update.
    #[doc(hidden)]
    fn update(
        grid: &mut Grid<Self, D>,
        isa: IsaToken,
        forces: &NodeForces<Self, D>,
        walls: &Walls<D>,
        colliders: &[Moving<D>],
    );
    /// G2P, and particles put out of colliders; what the colliders take by that comes to `taken`, lengths in
    /// cells from node 0.
    #[doc(hidden)]
    fn gather(
        group: &mut Group<Self, D>,
        grid: &Grid<Self, D>,
        around: Around<'_, D>,
        scheme: Scheme,
        isa: IsaToken,
        dt: f64,
        taken: &mut Vec<Taken<D>>,
    ) -> Bounds;
}

macro_rules! instance {
    ($($scalar:ty, $d:literal;)*) => {$(
        impl Instance<$d> for $scalar {}

        #[expect(private_interfaces, reason = "sealed: outside of this crate it is only a bound")]
        impl Kernels<$d> for $scalar {
            fn built_in(model: &Model) -> Box<dyn Law<Self, $d>> {
                crate::material::built_in(model)
            }
            fn scatter(
                group: &Group<Self, $d>,
                scheme: Scheme,
                isa: IsaToken,
                dt: f64,
                what: What,
                tiles: Tiles<'_, Self, $d>,
            ) {
                scatter::scatter(group, scheme, isa, dt, what, tiles);
            }
            fn sum_tiles(grid: &mut Grid<Self, $d>, isa: IsaToken) {
                grid.sum_tiles(isa);
            }
            fn expansion(
                group: &Group<Self, $d>,
                grid: &Grid<Self, $d>,
                scheme: Scheme,
                isa: IsaToken,
                out: &mut [Self],
            ) {
                volume::expansion(group, grid, scheme, isa, out);
            }
            fn measure_filling(
                grid: &mut Grid<Self, $d>,
                isa: IsaToken,
                walls: &Walls<$d>,
                dx: f64,
            ) {
                grid.measure_filling(isa, walls, dx);
            }
            fn correct_volume(
                group: &Group<Self, $d>,
                grid: &Grid<Self, $d>,
                scheme: Scheme,
                isa: IsaToken,
                shares: VolumeCorrection,
                jacobian_minus_one: &mut [Self],
            ) {
                volume::correct(group, grid, scheme, isa, shares, jacobian_minus_one);
            }
            fn update(
                grid: &mut Grid<Self, $d>,
                isa: IsaToken,
                forces: &NodeForces<Self, $d>,
                walls: &Walls<$d>,
                colliders: &[Moving<$d>],
            ) {
                grid.update(isa, forces, walls, colliders);
            }
            fn gather(
                group: &mut Group<Self, $d>,
                grid: &Grid<Self, $d>,
                around: Around<'_, $d>,
                scheme: Scheme,
                isa: IsaToken,
                dt: f64,
                taken: &mut Vec<Taken<$d>>,
            ) -> Bounds {
                gather::gather(group, grid, around, scheme, isa, dt, taken)
            }
        }
    )*};
}

instance! {
    f32, 2;
    f64, 2;
    f32, 3;
    f64, 3;
}
