//! Instructions on vectors of four numbers.

use pulp::WithSimd;
#[cfg(target_arch = "x86_64")]
use pulp::{Scalar, Simd, x86::V3};

/// The instructions of the processor at hand on vectors of at most four numbers: AVX2 where there is AVX-512, too.
///
/// Work on one pose has three or four numbers of a kind. Compiled for AVX-512, the joints of a pose took up to 1.1 times
/// as long on a processor that has it (Sapphire Rapids), and the actuated ones 1.3 times. Many poses at once took 0.7
/// times as long; so work on blocks of them uses [`pulp::Arch`], but for rows that become columns, four at a time.
#[derive(Clone, Copy, Debug)]
pub struct FourWide {
    #[cfg(target_arch = "x86_64")]
    avx2: Option<V3>,
    #[cfg(not(target_arch = "x86_64"))]
    any: pulp::Arch,
}

impl FourWide {
    /// Asks the processor what it has.
    #[cfg(target_arch = "x86_64")]
    #[expect(clippy::new_without_default, reason = "it depends on the processor")]
    #[inline]
    pub fn new() -> Self {
        Self { avx2: V3::try_new() }
    }

    /// Asks the processor what it has.
    #[cfg(not(target_arch = "x86_64"))]
    #[expect(clippy::new_without_default, reason = "it depends on the processor")]
    #[inline]
    pub fn new() -> Self {
        Self { any: pulp::Arch::new() }
    }

    /// Does some work, compiled for these instructions.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub fn dispatch<W: WithSimd>(self, work: W) -> W::Output {
        match self.avx2 {
            Some(simd) => Simd::vectorize(simd, work),
            None => Scalar.vectorize(work),
        }
    }

    /// Does some work, compiled for these instructions.
    #[cfg(not(target_arch = "x86_64"))]
    #[inline(always)]
    pub fn dispatch<W: WithSimd>(self, work: W) -> W::Output {
        self.any.dispatch(work)
    }
}
