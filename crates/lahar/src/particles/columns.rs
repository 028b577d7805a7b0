//! Columns of storage as slices, which threads divide among themselves by rows.

/// The most columns that a group has: position, velocity, affine, and a plastic strain in 3D, with some to spare.
pub(crate) const MOST_COLUMNS: usize = 32;

/// Returns the columns as slices, with empty ones behind them.
pub(crate) fn slices<T>(columns: &[Vec<T>]) -> [&[T]; MOST_COLUMNS] {
    let mut columns = columns.iter();
    core::array::from_fn(|_| columns.next().map_or(&[][..], |column| column))
}

/// Columns of storage, each a slice, that can be cut in two at a row.
pub(crate) struct ColumnsMut<'a, T> {
    pub(crate) slices: [&'a mut [T]; MOST_COLUMNS],
}

impl<'a, T> ColumnsMut<'a, T> {
    pub(crate) fn new(columns: &'a mut [Vec<T>]) -> Self {
        let mut columns = columns.iter_mut();
        Self {
            slices: core::array::from_fn(|_| columns.next().map_or(&mut [][..], |c| &mut c[..])),
        }
    }

    pub(crate) fn split_at(self, row: usize) -> (Self, Self) {
        let mut low: [&mut [T]; MOST_COLUMNS] = core::array::from_fn(|_| &mut [][..]);
        let mut high: [&mut [T]; MOST_COLUMNS] = core::array::from_fn(|_| &mut [][..]);
        for (column, slice) in self.slices.into_iter().enumerate() {
            let cut = row.min(slice.len());
            (low[column], high[column]) = slice.split_at_mut(cut);
        }
        (Self { slices: low }, Self { slices: high })
    }
}
