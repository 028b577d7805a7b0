//! Runs of rows: a group is sorted, so the rows of a block follow one another.

/// The particles of one block in a group: a range of rows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Run<const D: usize> {
    pub(crate) block: [i32; D],
    pub(crate) start: u32,
    pub(crate) end: u32,
    /// The block's tile in the grid; set by the grid for each new set of blocks.
    pub(crate) tile: u32,
    /// True if this group is the first to scatter to that tile; set with it.
    pub(crate) first: bool,
}

impl<const D: usize> Run<D> {
    pub(crate) fn rows(&self) -> core::ops::Range<usize> {
        self.start as usize..self.end as usize
    }
}

/// Cuts a list of runs into halves with about as many particles. Returns the index of the first run of the second half
/// and its first row, or `None` if there are at most `grain` particles or a single run.
pub(crate) fn split_runs<const D: usize>(runs: &[Run<D>], grain: usize) -> Option<(usize, usize)> {
    let (first, last) = (runs.first()?, runs.last()?);
    let rows = (last.end - first.start) as usize;
    if rows <= grain || runs.len() < 2 {
        return None;
    }
    let half = first.start + (rows / 2) as u32;
    let middle = runs
        .partition_point(|run| run.start < half)
        .clamp(1, runs.len() - 1);
    Some((middle, runs[middle].start as usize))
}

impl<const D: usize> PartialEq for Run<D> {
    /// Compares blocks and rows. Tiles follow from the blocks of all groups.
    fn eq(&self, other: &Self) -> bool {
        (self.block, self.start, self.end) == (other.block, other.start, other.end)
    }
}
