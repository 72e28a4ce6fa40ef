//! The angles of one pose. The chains find directions. Their angles are computed many at a time, in a loop that is
//! vectorised.

use crate::numeric::angle::atan2_of_each;
use nalgebra::Complex;

/// The number of angles that are computed together: those of a few of the processor's vectors.
const TOGETHER: usize = 8;

/// The number of vectors of directions that there is room for.
const VECTORS: usize = 4;

/// The most directions that one leg has: those of two chains, and that of the imaginary joint.
const OF_LEG: usize = 7;

/// Directions whose angles are asked for, each with what it is the angle of.
pub(super) struct Angles<T> {
    y: [[f64; TOGETHER]; VECTORS],
    x: [[f64; TOGETHER]; VECTORS],
    of: [T; VECTORS * TOGETHER],
    count: usize,
}

impl<T: Copy> Angles<T> {
    /// No directions. `any` only fills the room.
    #[inline(always)]
    pub fn new(any: T) -> Self {
        let zeros = [[0.0; TOGETHER]; VECTORS];
        Self { y: zeros, x: zeros, of: [any; VECTORS * TOGETHER], count: 0 }
    }

    /// Asks for the angle of a direction. There must be room for it: see [`Angles::make_room`].
    #[inline(always)]
    pub fn ask(&mut self, of: T, direction: Complex<f64>) {
        let place = self.count % (VECTORS * TOGETHER);
        self.y.as_flattened_mut()[place] = direction.im;
        self.x.as_flattened_mut()[place] = direction.re;
        self.of[place] = of;
        self.count += 1;
    }

    /// Makes room for the directions of one leg more, by answering where it is short.
    #[inline(always)]
    pub fn make_room(&mut self, answer: impl FnMut(T, f64)) {
        if self.count + OF_LEG > VECTORS * TOGETHER {
            self.answer(answer);
        }
    }

    /// Calls `answer` with everything that was asked for, and forgets it.
    #[inline(always)]
    pub fn answer(&mut self, mut answer: impl FnMut(T, f64)) {
        let vectors = self.y.iter().zip(&self.x).zip(self.of.as_chunks::<TOGETHER>().0);
        let mut left = self.count;
        for ((y, x), of) in vectors {
            if left == 0 {
                break;
            }
            let angles = atan2_of_each(y, x);
            let known = left.min(TOGETHER);
            for (of, angle) in of.iter().zip(angles).take(known) {
                answer(*of, angle);
            }
            left -= known;
        }
        self.count = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Legs with no to seven directions, many more than there is room for.
    #[test]
    fn every_angle_is_told_once_and_in_order() {
        let angle = |i: usize| (i as f64 * 0.37) % 6.0 - 3.0;
        let (mut angles, mut asked, mut told) = (Angles::new(0), 0, Vec::new());
        for leg in 0..80 {
            angles.make_room(|of, angle| told.push((of, angle)));
            for _ in 0..leg % (OF_LEG + 1) {
                angles.ask(asked, Complex::from_polar(1.0 + asked as f64, angle(asked)));
                asked += 1;
            }
        }
        angles.answer(|of, angle| told.push((of, angle)));
        // Nothing is left to tell.
        angles.answer(|of, angle| told.push((of, angle)));
        assert_eq!(told.len(), asked);
        for (number, (of, found)) in told.into_iter().enumerate() {
            assert_eq!(of, number);
            // The rounding of the direction.
            assert!((found - angle(of)).abs() < 1e-14, "{of}: {found}");
        }
    }
}
