//! The scheme: kernel, form of the force and transfer, for the loops between particles and nodes.

use super::{ForceForm, Kernel, Transfer};

/// The part of a setup that the loops between particles and nodes depend on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scheme {
    pub(crate) kernel: Kernel,
    pub(crate) force: ForceForm,
    pub(crate) transfer: Transfer,
    /// Distance between nodes \[m\].
    pub(crate) dx: f64,
}

impl Scheme {
    /// Nodes that the kernel touches on an axis.
    pub(crate) fn kernel_nodes(self) -> usize {
        self.kernel.nodes()
    }

    /// The kernel's [`BSpline::OFFSET`](crate::kernel::BSpline::OFFSET) \[cells\].
    pub(crate) fn offset(self) -> f64 {
        self.kernel.offset()
    }

    /// The kernel's [`BSpline::INVERSE_INERTIA`](crate::kernel::BSpline::INVERSE_INERTIA).
    pub(crate) fn inverse_inertia(self) -> f64 {
        self.kernel.inverse_inertia()
    }

    /// Number of quads per node: two where particles need the velocity before forces, else one.
    pub(crate) fn planes(self) -> usize {
        if matches!(self.transfer, Transfer::Flip { .. }) {
            2
        } else {
            1
        }
    }
}
