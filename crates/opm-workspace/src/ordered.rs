//! Parallel work on many items, whose results come in order and in bounded memory.

use crate::progress::Cancelled;
use rayon::prelude::*;

/// The number of items for each thread that are worked on together between two visits: few, so that what one thread
/// makes is still in its cache when it visits it.
const BATCH: usize = 4;

/// The number of such items on all threads, if there are not more threads. It bounds the memory of the results that
/// wait.
const MOST: usize = 16;

/// Makes something of every item, on any thread with a `scratch` of its own, and gives it to `visit`
/// in the order of the items, while the next ones are worked on.
///
/// # Errors
/// The first error among the items or of `visit`, or `Cancelled` from `make`.
pub fn in_order<I: Send, S, T: Send, E: From<Cancelled> + Send>(
    items: impl Iterator<Item = Result<I, E>> + Send,
    scratch: impl Fn() -> S + Sync + Send,
    make: impl Fn(&mut S, I) -> Result<T, Cancelled> + Sync + Send,
    mut visit: impl FnMut(T) -> Result<(), E> + Send,
) -> Result<(), E> {
    let threads = rayon::current_num_threads();
    let ahead = (BATCH * threads).min(MOST).max(threads);
    let mut items = items;
    let mut batch = || -> Result<Vec<T>, E> {
        let items: Vec<I> = items.by_ref().take(ahead).collect::<Result<_, E>>()?;
        let made: Result<Vec<T>, Cancelled> =
            items.into_par_iter().map_init(&scratch, &make).collect();
        Ok(made?)
    };
    let mut next = batch()?;
    while !next.is_empty() {
        let (visited, following) =
            rayon::join(|| next.into_iter().try_for_each(&mut visit), &mut batch);
        visited?;
        next = following?;
    }
    Ok(())
}
