//! The compiled loops of the method, behind a trait.
//!
//! [`Simulation`](crate::Simulation) is generic, and generic code is compiled again in every crate and test program that
//! uses it: with all instruction sets, minutes each. The loops are therefore reached through [`Instance`], whose four
//! implementations are concrete and so belong to this crate alone.

use crate::array::Element;
use crate::boundary::colliders::placed::Moving;
use crate::boundary::constraint::Boundaries;
use crate::boundary::impulse::Impulse;
use crate::boundary::walls::Walls;
use crate::boundary::walls::faces::WallFaces;
use crate::force::nodes::{self, NodeForces, NodeImpulses};
use crate::grid::operations::NodeVector;
use crate::grid::{Blocks, Filling, Grid, Momentum, NodeField, Tiles, Velocity, Volume};
use crate::material::{IsaToken, Law, Model, VolumeCorrection};
use crate::math::Lanes;
use crate::particles::{Group, Lattice};
use crate::setup::Scheme;
use crate::transfer::g2p::{self, Found, Surroundings};
use crate::transfer::p2g;
use crate::volume::{filling, readout};

/// Numbers that the engine is compiled for in `D` dimensions: `f32` and `f64`, in 2D and 3D.
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

    /// P2G of mass, momentum and the impulse of stress: (1)–(4).
    #[doc(hidden)]
    fn add_momentum(
        group: &Group<Self, D>,
        scheme: Scheme,
        isa: IsaToken,
        dt: f64,
        tiles: Tiles<'_, Self, D>,
    );

    /// P2G of volumes, for gauges and (7g) to (7i).
    #[doc(hidden)]
    fn add_volumes(
        group: &Group<Self, D>,
        scheme: Scheme,
        isa: IsaToken,
        corrected: bool,
        tiles: Tiles<'_, Self, D>,
    );

    /// The sums of mass and momentum over tiles.
    #[doc(hidden)]
    fn sum_momentum(
        grid: &Grid<Self, D>,
        isa: IsaToken,
        storage: Vec<Self>,
    ) -> NodeField<Momentum, Self>;

    /// The sums of volumes over tiles.
    #[doc(hidden)]
    fn sum_volumes(
        grid: &Grid<Self, D>,
        isa: IsaToken,
        storage: Vec<Self>,
    ) -> NodeField<Volume, Self>;

    /// Forces on nodes: momentum to velocity.
    #[doc(hidden)]
    fn apply_forces(
        blocks: &Blocks<D>,
        isa: IsaToken,
        momentum: NodeField<Momentum, Self>,
        forces: &NodeForces<Self, D>,
        impulses: Option<&NodeImpulses<Self, D>>,
    ) -> NodeField<Velocity, Self>;

    /// Walls and colliders on nodes.
    #[doc(hidden)]
    fn constrain(
        boundaries: &mut Boundaries<D>,
        blocks: &Blocks<D>,
        isa: IsaToken,
        velocities: &mut NodeField<Velocity, Self>,
        walls: &Walls<D>,
        colliders_and_dx: (&[Moving<D>], f64),
    );

    /// G2P, with particles inside colliders projected out: (5)–(8).
    #[doc(hidden)]
    fn gather(
        group: &mut Group<Self, D>,
        grid_and_velocities: (&Grid<Self, D>, &NodeField<Velocity, Self>),
        surroundings: Surroundings<'_, D>,
        scheme_and_lattice: (Scheme, &Lattice<D>),
        isa: IsaToken,
        dt: f64,
        impulses: &mut Vec<Impulse<D>>,
    ) -> Found;

    /// The gathered J − 1: (7g).
    #[doc(hidden)]
    fn expansion(
        group: &Group<Self, D>,
        grid_and_volumes: (&Grid<Self, D>, &NodeField<Volume, Self>),
        scheme: Scheme,
        isa: IsaToken,
        out: &mut [Self],
    );

    /// The filling of the grid from the volumes on it.
    #[doc(hidden)]
    fn measure_filling(
        grid: &Grid<Self, D>,
        isa: IsaToken,
        volumes: NodeField<Volume, Self>,
        walls_and_faces: (&Walls<D>, &WallFaces<D>),
        dx: f64,
        excess: &mut NodeVector<Self, 1>,
    ) -> NodeField<Filling, Self>;

    /// The correction of J − 1 by the filling: (7h), (7i).
    #[doc(hidden)]
    fn correct_volume(
        group: &Group<Self, D>,
        grid_and_filling: (&Grid<Self, D>, &NodeField<Filling, Self>),
        scheme: Scheme,
        isa: IsaToken,
        shares: VolumeCorrection,
        jacobian_minus_one: &mut [Self],
    );
}

macro_rules! instance {
    ($($scalar:ty, $d:literal;)*) => {$(
        impl Instance<$d> for $scalar {}

        #[expect(private_interfaces, reason = "sealed: outside of this crate it is only a bound")]
        impl Kernels<$d> for $scalar {
            fn built_in(
                model: &Model,
            ) -> Box<dyn Law<Self, $d>> {
                crate::material::built_in(model)
            }
            fn add_momentum(
                group: &Group<Self, $d>,
                scheme: Scheme,
                isa: IsaToken,
                dt: f64,
                tiles: Tiles<'_, Self, $d>,
            ) {
                p2g::add_momentum(group, scheme, isa, dt, tiles);
            }
            fn add_volumes(
                group: &Group<Self, $d>,
                scheme: Scheme,
                isa: IsaToken,
                corrected: bool,
                tiles: Tiles<'_, Self, $d>,
            ) {
                p2g::add_volumes(group, scheme, isa, corrected, tiles);
            }
            fn sum_momentum(
                grid: &Grid<Self, $d>,
                isa: IsaToken,
                storage: Vec<Self>,
            ) -> NodeField<Momentum, Self> {
                grid.sum(isa, storage)
            }
            fn sum_volumes(
                grid: &Grid<Self, $d>,
                isa: IsaToken,
                storage: Vec<Self>,
            ) -> NodeField<Volume, Self> {
                grid.sum(isa, storage)
            }
            fn apply_forces(
                blocks: &Blocks<$d>,
                isa: IsaToken,
                momentum: NodeField<Momentum, Self>,
                forces: &NodeForces<Self, $d>,
                impulses: Option<&NodeImpulses<Self, $d>>,
            ) -> NodeField<Velocity, Self> {
                nodes::apply(blocks, isa, momentum, forces, impulses)
            }
            fn constrain(
                boundaries: &mut Boundaries<$d>,
                blocks: &Blocks<$d>,
                isa: IsaToken,
                velocities: &mut NodeField<Velocity, Self>,
                walls: &Walls<$d>,
                colliders_and_dx: (&[Moving<$d>], f64),
            ) {
                boundaries.constrain(blocks, isa, velocities, walls, colliders_and_dx);
            }
            fn gather(
                group: &mut Group<Self, $d>,
                grid_and_velocities: (&Grid<Self, $d>, &NodeField<Velocity, Self>),
                surroundings: Surroundings<'_, $d>,
                scheme_and_lattice: (Scheme, &Lattice<$d>),
                isa: IsaToken,
                dt: f64,
                impulses: &mut Vec<Impulse<$d>>,
            ) -> Found {
                g2p::gather(group, grid_and_velocities, surroundings, scheme_and_lattice, isa, dt, impulses)
            }
            fn expansion(
                group: &Group<Self, $d>,
                grid_and_volumes: (&Grid<Self, $d>, &NodeField<Volume, Self>),
                scheme: Scheme,
                isa: IsaToken,
                out: &mut [Self],
            ) {
                readout::expansion(group, grid_and_volumes, scheme, isa, out);
            }
            fn measure_filling(
                grid: &Grid<Self, $d>,
                isa: IsaToken,
                volumes: NodeField<Volume, Self>,
                walls_and_faces: (&Walls<$d>, &WallFaces<$d>),
                dx: f64,
                excess: &mut NodeVector<Self, 1>,
            ) -> NodeField<Filling, Self> {
                filling::measure(grid, isa, volumes, walls_and_faces, dx, excess)
            }
            fn correct_volume(
                group: &Group<Self, $d>,
                grid_and_filling: (&Grid<Self, $d>, &NodeField<Filling, Self>),
                scheme: Scheme,
                isa: IsaToken,
                shares: VolumeCorrection,
                jacobian_minus_one: &mut [Self],
            ) {
                readout::correct(group, grid_and_filling, scheme, isa, shares, jacobian_minus_one);
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
