//! Reads the probes that are due.

use super::Substep;
use crate::error::Failure;
use crate::instance::Instance;
use crate::state::probes;

pub(super) fn run<T: Instance<D>, const D: usize>(
    substep: &mut Substep<'_, T, D>,
) -> Result<(), Failure> {
    let Substep {
        scene,
        state,
        workspace,
        start,
        ..
    } = substep;
    probes::read(scene, state, workspace, Some(*start));
    Ok(())
}
