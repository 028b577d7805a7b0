//! The transfer scheme: what the loops between particles and nodes need to know of a setup.

use super::{ForceForm, Kernel, Transfer};

/// What the loops need to know of scheme, kernel and step; all lengths in cells.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scheme {
    pub(crate) kernel: Kernel,
    pub(crate) force: ForceForm,
    pub(crate) transfer: Transfer,
    pub(crate) dx: f64,
}

impl Scheme {
    /// Nodes that the kernel touches on an axis.
    pub(crate) fn kernel_nodes(self) -> usize {
        self.kernel.nodes()
    }

    /// The kernel's [`BSpline::INVERSE_INERTIA`](crate::kernel::BSpline::INVERSE_INERTIA).
    pub(crate) fn inverse_inertia(self) -> f64 {
        self.kernel.inverse_inertia()
    }

    /// Quads per node: two where particles ask for the change of velocity, else one.
    pub(crate) fn layers(self) -> usize {
        if matches!(self.transfer, Transfer::Flip { .. }) {
            2
        } else {
            1
        }
    }
}
