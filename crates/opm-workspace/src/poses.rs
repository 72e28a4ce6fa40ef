//! Where the reachable poses of a grid come from: a sweep, or files in which sweeps of its shards were stored.

use crate::grid::Grid;
use crate::progress::{Cancelled, Progress};
use crate::set::SetError;
use crate::sweep::{Hits, Sweep};

/// A source that gives the reachable poses of a grid, as often as it is asked to. [`Sweep`] is one;
/// [`replay`](crate::replay) helps to make another of stored poses. Sets ([`GridSet`](crate::GridSet)) and
/// visits ([`Visits`](crate::Visits)) can be made of any source.
pub trait Poses {
    /// Why poses cannot be had.
    type Error: From<SetError> + From<Cancelled> + Send;

    /// The grid that the poses are of.
    fn grid(&self) -> &Grid;

    /// Gives every pose, as [`Sweep::points`] does.
    ///
    /// # Errors
    /// The first error of `visit`, [`Cancelled`] if [`Progress::cancel`] was called, or the reason why the
    /// source cannot give its poses.
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
