//! How many square roots a second the machine takes, with the vectors that a sweep uses.

use pulp::{Arch, Simd, WithSimd};
use std::hint::black_box;

/// Numbers that are held together, as many as a sweep cuts rows together.
const TOGETHER: usize = 64;

const PASSES: usize = 50_000;

/// Roots that one call of [`take`] takes.
pub const EACH: u64 = (TOGETHER * PASSES) as u64;

/// Takes [`EACH`] square roots, and does nothing else.
pub fn take() {
    let numbers = std::array::from_fn(|i| 1.0 + 0.618 * i as f64);
    let roots = Arch::new().dispatch(Roots { numbers: &numbers });
    black_box(roots);
}

/// The instructions that the sweep and this are compiled for here, as pulp calls them: `V3` are those of
/// x86-64-v3, `V4` of x86-64-v4.
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
