//! A number per particle, stored once where all particles of a group share it.

use super::chunk::{CHUNK, Rows, pad};

/// A number that is the same for the whole group, or one per particle.
#[derive(Debug, PartialEq)]
pub(crate) enum PerParticle<T> {
    Uniform(T),
    Each(Vec<T>),
}

impl<T: Copy + PartialEq> PerParticle<T> {
    /// Returns the number of particle `index`.
    pub(crate) fn get(&self, index: usize) -> T {
        match self {
            Self::Uniform(value) => *value,
            Self::Each(values) => values[index],
        }
    }

    /// Returns the numbers of rows `start .. start + count`, of which there is at least one. They are in `buffer` unless a
    /// full chunk of them is stored.
    #[inline(always)]
    pub(crate) fn rows<'a>(
        &'a self,
        start: usize,
        count: usize,
        buffer: &'a mut Rows<T>,
    ) -> &'a Rows<T> {
        match self {
            Self::Uniform(value) => buffer.fill(*value),
            Self::Each(values) if count == CHUNK => {
                return values[start..].first_chunk().expect("a full chunk");
            }
            Self::Each(values) => pad(buffer, &values[start..start + count]),
        }
        buffer
    }

    /// Returns the numbers if there is one per particle, else none.
    pub(crate) fn each_row(&self) -> &[T] {
        match self {
            Self::Uniform(_) => &[],
            Self::Each(values) => values,
        }
    }

    /// Returns how many numbers fit into the present memory.
    pub(crate) fn capacity(&self) -> usize {
        match self {
            Self::Uniform(_) => 0,
            Self::Each(values) => values.capacity(),
        }
    }

    /// Frees the memory of spare capacity.
    pub(super) fn shrink(&mut self) {
        if let Self::Each(values) = self {
            values.shrink_to_fit();
        }
    }

    /// Appends `more` to the numbers of `count` particles.
    pub(crate) fn extend(&mut self, count: usize, more: impl Iterator<Item = T> + Clone) {
        if let Self::Uniform(value) = self {
            if count == 0
                && let Some(first) = more.clone().next()
            {
                *value = first;
            }
            let value = *value;
            if more.clone().all(|x| x == value) {
                return;
            }
            *self = Self::Each(vec![value; count]);
        }
        if let Self::Each(values) = self {
            values.extend(more);
        }
    }
}

impl<T: Copy> Clone for PerParticle<T> {
    fn clone(&self) -> Self {
        match self {
            Self::Uniform(value) => Self::Uniform(*value),
            Self::Each(values) => Self::Each(values.clone()),
        }
    }

    /// Copies `from` into the memory of this one.
    fn clone_from(&mut self, from: &Self) {
        match (self, from) {
            (Self::Each(values), Self::Each(from)) => values.clone_from(from),
            (to, from) => *to = from.clone(),
        }
    }
}
