//! Fields on the nodes, typed by the quantity that their numbers are.
//!
//! ```text
//! tiles ──sum──▶ NodeField<Momentum> ──forces──▶ NodeField<Velocity> ──boundaries──▶ NodeField<Velocity>
//!       ──sum──▶ NodeField<Volume>  ──filling──▶ NodeField<Filling>
//! ```
//!
//! A field of another quantity is made of the same storage: nothing is copied, and no number is read as the quantity
//! that it was before.

use super::{BLOCK_NODES, QUAD};
use crate::math::Scalar;
use crate::parallel;
use core::marker::PhantomData;

/// What particles have brought: `[p_x, p_y, p_z, m]`, momentum \[kg m/s\] and mass \[kg\]; p_z is 0 in 2D. The second
/// layer, where the scheme keeps it apart, is the impulse of stress \[kg m/s\].
#[derive(Debug)]
pub(crate) enum Momentum {}

/// What particles read: `[v_x, v_y, v_z, m]`, velocity \[m/s\] and mass \[kg\]. The second layer is the change of velocity
/// by stress, forces and boundaries \[m/s\].
#[derive(Debug)]
pub(crate) enum Velocity {}

/// Rest volumes around a node: `[Σ w V⁰, Σ w V⁰ (J − 1)]` of all particles, then of the fluid that is corrected
/// \[m³; m² in 2D\].
#[derive(Debug)]
pub(crate) enum Volume {}

/// What corrects a fluid's volume: `[mean J − 1 of the fluid, excess of volume in cells, 0, 0]`, (7h) and (7i).
#[derive(Debug)]
pub(crate) enum Filling {}

/// A quantity that particles bring to tiles and that is summed over tiles.
pub(crate) trait Summed {
    /// Layers of its field, if those of the tiles are `layers`.
    fn layers(layers: usize) -> usize;
}

impl Summed for Momentum {
    fn layers(layers: usize) -> usize {
        layers
    }
}

impl Summed for Volume {
    fn layers(_: usize) -> usize {
        1
    }
}

/// One quad of `Q` per node and layer, block after block; within a block layer after layer.
#[derive(Clone, Debug)]
pub(crate) struct NodeField<Q, T> {
    numbers: Vec<T>,
    layers: usize,
    quantity: PhantomData<Q>,
}

impl<Q, T> Default for NodeField<Q, T> {
    /// A field without nodes.
    fn default() -> Self {
        Self {
            numbers: Vec::new(),
            layers: 1,
            quantity: PhantomData,
        }
    }
}

impl<Q, T: Scalar> NodeField<Q, T> {
    /// Takes `numbers` for a field of `Q`.
    pub(crate) fn of(numbers: Vec<T>, layers: usize) -> Self {
        Self {
            numbers,
            layers,
            quantity: PhantomData,
        }
    }

    /// Gives the storage back, to make another field of.
    pub(crate) fn into_storage(self) -> Vec<T> {
        self.numbers
    }

    /// Returns the number of quads per node.
    pub(crate) fn layers(&self) -> usize {
        self.layers
    }

    /// Returns the number of numbers per block.
    pub(crate) fn block_len(&self) -> usize {
        BLOCK_NODES * QUAD * self.layers
    }

    /// Returns all numbers of the field.
    pub(crate) fn numbers(&self) -> &[T] {
        &self.numbers
    }

    /// Returns all numbers, to change without changing the quantity that they are.
    pub(crate) fn numbers_mut(&mut self) -> &mut [T] {
        &mut self.numbers
    }

    /// The quads of the first layer, node after node.
    pub(crate) fn quads(&self) -> impl Iterator<Item = &[T]> {
        let blocks = self.numbers.chunks_exact(self.block_len());
        blocks.flat_map(|block| block[..BLOCK_NODES * QUAD].chunks_exact(QUAD))
    }

    /// Makes a field of `R` of this one: calls `rewrite(first block, numbers of some blocks)` for pieces of at least
    /// `smallest` blocks, which replaces the quads of `Q` by quads of `R`.
    pub(crate) fn rewritten<R>(
        mut self,
        smallest: usize,
        rewrite: &(impl Fn(usize, &mut [T]) + Sync),
    ) -> NodeField<R, T> {
        let block_len = self.block_len();
        let grain = parallel::grain(self.numbers.len() / block_len, smallest);
        parallel::for_chunks(&mut self.numbers, block_len, 0, grain, &|first, piece| {
            let _flush = crate::float_mode::FlushToZero::enter();
            rewrite(first, piece);
        });
        NodeField::of(self.numbers, self.layers)
    }
}
