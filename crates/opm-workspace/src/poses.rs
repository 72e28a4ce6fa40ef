//! Where the reachable poses of a grid come from: a sweep, or wherever sweeps of its shards left them.

use crate::grid::Grid;
use crate::progress::{Cancelled, Progress};
use crate::set::SetError;
use crate::sweep::{Hits, Sweep};

/// Gives the reachable poses of a grid as often as asked for. What is made of them does not depend on
/// where they come from.
pub trait Poses {
    /// What goes wrong with it.
    type Error: From<SetError> + From<Cancelled> + Send;

    /// Whose poses they are.
    fn grid(&self) -> &Grid;

    /// Gives every pose, as [`Sweep::points`] does.
    ///
    /// # Errors
    /// The first one that `visit` gives, or when told to stop, or where there are no more to be had.
    fn points<T: Send>(
        &self,
        progress: &Progress,
        make: impl Fn(&Hits<'_>, &mut T) + Sync,
        empty: impl Fn() -> T + Sync,
        visit: impl FnMut(T) -> Result<(), Self::Error> + Send,
    ) -> Result<(), Self::Error>;
}

impl Poses for Sweep<'_> {
    type Error = SetError;

    fn grid(&self) -> &Grid {
        Sweep::grid(self)
    }

    fn points<T: Send>(
        &self,
        progress: &Progress,
        make: impl Fn(&Hits<'_>, &mut T) + Sync,
        empty: impl Fn() -> T + Sync,
        visit: impl FnMut(T) -> Result<(), SetError> + Send,
    ) -> Result<(), SetError> {
        Sweep::points(self, progress, make, empty, visit)
    }
}
