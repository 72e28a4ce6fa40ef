//! The number of square roots per second that the machine computes, with the vectors that a sweep
//! uses.

use pulp::{Arch, Simd, WithSimd};
use std::hint::black_box;

/// The number of values that are computed together: as many as the rows that a sweep clips
/// together.
const TOGETHER: usize = 64;

const PASSES: usize = 50_000;

/// The number of roots that one call of [`take`] computes.
pub const EACH: u64 = (TOGETHER * PASSES) as u64;

/// Computes [`EACH`] square roots, and nothing else.
pub fn take() {
    let numbers = std::array::from_fn(|i| 1.0 + 0.618 * i as f64);
    let roots = Arch::new().dispatch(Roots { numbers: &numbers });
    black_box(roots);
}

/// The instruction set for which the sweep and this function are compiled here, in pulp's names:
/// `V3` is x86-64-v3, `V4` is x86-64-v4.
pub fn instructions() -> String {
    let name = format!("{:?}", Arch::new());
    name.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default().to_owned()
}

struct Roots<'a> {
    numbers: &'a [f64; TOGETHER],
}

impl WithSimd for Roots<'_> {
    type Output = [f64; TOGETHER];

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let mut roots = [0.0; TOGETHER];
        for _ in 0..PASSES {
            for (root, number) in roots.iter_mut().zip(black_box(self.numbers)) {
                *root = number.sqrt();
            }
            black_box(&mut roots);
        }
        roots
    }
}
