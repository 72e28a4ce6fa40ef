//! Parallel work on many items, whose results come in order and in bounded memory.

use crate::progress::Cancelled;
use rayon::prelude::*;
use std::mem;
use std::sync::{Mutex, PoisonError};

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
pub fn in_order<I: Send, S: Send, T: Send, E: From<Cancelled> + Send>(
    items: impl Iterator<Item = Result<I, E>> + Send,
    scratch: impl Fn() -> S + Sync + Send,
    make: impl Fn(&mut S, I) -> Result<T, Cancelled> + Sync + Send,
    mut visit: impl FnMut(T) -> Result<(), E> + Send,
) -> Result<(), E> {
    let threads = rayon::current_num_threads();
    let ahead = (BATCH * threads).min(MOST).max(threads);
    let mut items = items;
    let idle = Mutex::new(Vec::new());
    let mut batch = || -> Result<Vec<T>, E> {
        let mut places = Vec::new();
        for item in items.by_ref().take(ahead) {
            places.push(Mutex::new(Slot::Item(item?)));
        }
        share(places.len(), &|number| {
            let Slot::Item(item) = take(&places[number]) else { return };
            let mut own = locked(&idle, Vec::pop).unwrap_or_else(&scratch);
            let made = make(&mut own, item);
            locked(&idle, |idle| idle.push(own));
            locked(&places[number], |place| *place = Slot::Made(made));
        });
        let made = places.iter().filter_map(|place| match take(place) {
            Slot::Made(made) => Some(made),
            Slot::Item(_) | Slot::Empty => None,
        });
        Ok(made.collect::<Result<_, _>>()?)
    };
    let mut next = batch()?;
    while !next.is_empty() {
        let (mut visited, mut following) = (Ok(()), Ok(Vec::new()));
        let present = mem::take(&mut next);
        let mut present = present.into_iter();
        both(&mut || visited = present.try_for_each(&mut visit), &mut || following = batch());
        visited?;
        next = following?;
    }
    Ok(())
}

/// Where an item is, and then what was made of it.
#[derive(Default)]
enum Slot<I, T> {
    Item(I),
    Made(Result<T, Cancelled>),
    #[default]
    Empty,
}

fn take<I, T>(place: &Mutex<Slot<I, T>>) -> Slot<I, T> {
    locked(place, mem::take)
}

fn locked<T, R>(mutex: &Mutex<T>, then: impl FnOnce(&mut T) -> R) -> R {
    then(&mut mutex.lock().unwrap_or_else(PoisonError::into_inner))
}

/// Does a piece of work for each number below `count`, on all threads. What rayon makes of it is much code, which is compiled
/// once for all kinds of work.
fn share(count: usize, work: &(dyn Fn(usize) + Sync)) {
    (0..count).into_par_iter().for_each(work);
}

/// Does two pieces of work at the same time; compiled once, as [`share`].
fn both(one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send)) {
    rayon::join(one, other);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// There is a scratch for each thread at most: it is kept.
    #[test]
    fn results_come_in_the_order_of_the_items() {
        for threads in [1, 2, 5] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let (mut seen, made) = (Vec::new(), Mutex::new(0));
            let done: Result<(), Cancelled> = pool.install(|| {
                in_order(
                    (0..1000).map(Ok),
                    || locked(&made, |made| *made += 1),
                    |(), item| Ok(item * item),
                    |result| {
                        seen.push(result);
                        Ok(())
                    },
                )
            });
            assert!(done.is_ok());
            assert!(seen.iter().copied().eq((0..1000).map(|item| item * item)), "{threads}");
            let made = made.into_inner().unwrap();
            assert!((1..=threads).contains(&made), "{made} for {threads} threads");
        }
    }

    #[test]
    fn the_first_error_ends_the_work() {
        #[derive(Debug, PartialEq)]
        enum FirstError {
            Cancelled,
            Item(u32),
            Visit(u32),
        }
        impl From<Cancelled> for FirstError {
            fn from(_: Cancelled) -> Self {
                Self::Cancelled
            }
        }
        let run = |items: &[Result<u32, u32>], cancel: u32, stop: u32| {
            let mut seen = Vec::new();
            let items = items.iter().map(|item| item.map_err(FirstError::Item));
            let make = |_: &mut (), item| if item == cancel { Err(Cancelled) } else { Ok(item) };
            let done = in_order(
                items,
                || (),
                make,
                |item| {
                    seen.push(item);
                    if item == stop { Err(FirstError::Visit(item)) } else { Ok(()) }
                },
            );
            (done, seen)
        };
        let whole: Vec<_> = (1..=40).map(Ok).collect();
        assert_eq!(run(&whole, 0, 0), (Ok(()), (1..=40).collect()));
        assert_eq!(run(&whole, 0, 30), (Err(FirstError::Visit(30)), (1..=30).collect()));
        assert_eq!(run(&whole, 40, 0).0, Err(FirstError::Cancelled));
        let mut broken = whole;
        broken[39] = Err(7);
        assert_eq!(run(&broken, 0, 0).0, Err(FirstError::Item(7)));
    }
}
