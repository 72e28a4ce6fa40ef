//! The area and its errors, summed up over its boundary.

use super::tracer::{Crossing, Tracer};
use super::{Area, Drift, Motion};
use nalgebra::Complex;

/// What all boundaries sum up to.
pub struct Sum<const N: usize> {
    area: f64,
    /// An error by rounding and by tolerances.
    error: f64,
    /// The chords and the squares of the pieces by their motion.
    pieces: Vec<(Complex<f64>, f64)>,
    /// The error by pieces that are not sure, of the mean and of all values.
    unsure: [f64; 2],
    errors: [f64; N],
}

impl<const N: usize> Sum<N> {
    pub fn new(motions: usize) -> Self {
        Self {
            area: 0.0,
            error: 0.0,
            pieces: vec![(Complex::ZERO, 0.0); motions],
            unsure: [0.0; 2],
            errors: [0.0; N],
        }
    }

    /// Adds what the curve at a place among those that cross contributes.
    pub fn add(&mut self, tracer: &mut Tracer<'_, N>, at: usize) {
        let length = self.add_middle(tracer, at);
        let Crossing { curve, margin, drift, .. } = tracer.crossing[at];
        if drift.most > 0.0 {
            self.add_motion(tracer, at, length);
        } else {
            // What is of a disc in a rectangle has no longer boundary than the rectangle.
            let [from, to] = curve.places(tracer.far);
            let [x, y] = tracer.regions.half;
            self.error += margin * (curve.rate() * (to - from)).min(4.0 * (x + y));
        }
    }

    /// Adds the curve's part of the area in the middle of the box. Returns how much of the curve is on the boundary, at most.
    fn add_middle(&mut self, tracer: &mut Tracer<'_, N>, at: usize) -> f64 {
        let (far, rounding) = (tracer.far, tracer.crossing[at].rounding);
        tracer.reaches.clear();
        tracer.reaches.extend(tracer.crossing.iter().map(|other| rounding + other.rounding));
        let pieces = tracer.pieces(at, |_| {});
        self.area += pieces.swept;
        self.error += 0.5 * far * pieces.unsure + rounding * far * f64::from(pieces.length > 0.0);
        pieces.length + pieces.unsure
    }

    /// Adds what changes by the motion of the curve, of which this length is on the boundary in the middle of the box.
    fn add_motion(&mut self, tracer: &mut Tracer<'_, N>, at: usize, length: f64) {
        let Crossing { number, margin, drift: own, .. } = tracer.crossing[at];
        let regions = tracer.regions;
        let of = |number: usize| regions.boundaries[number].motion;
        let motion = &regions.motions[of(number)];
        // How far other curves move, relative to this one.
        let drifts: Vec<(Drift, f64)> = (tracer.crossing.iter())
            .map(|other| {
                let drift = if of(other.number) == of(number) {
                    Drift::default()
                } else {
                    regions.motions[of(other.number)].drift(motion, &other.curve, tracer.far)
                };
                (drift, margin + other.margin)
            })
            .collect();
        tracer.reaches.clear();
        tracer.reaches.extend(drifts.iter().map(|(drift, margin)| drift.most + margin));
        // The lengths that are not on the boundary as in the middle, on the mean, and those that perhaps are not.
        let mut unsure = [0.0; 2];
        let pieces = tracer.pieces(at, |run| {
            let (Drift { mean, most, off }, margin) = drifts[run.other];
            let through = if run.through {
                // The length that is nearer to the other curve than a distance is a convex function of the distance, for lines
                // and circles, so it is at most in proportion. At opposite points of the box, the curves pass each other in
                // opposite directions, up to `off`: half of that length is the mean. On the way to there from the middle of
                // the box, half of the distance is.
                run.length * (0.25 * mean + 0.5 * off + margin) / (most + margin)
            } else {
                run.counts
            };
            unsure = [unsure[0] + run.counts.min(through), unsure[1] + run.counts];
        });
        let unsure = unsure.map(|length| length.min(pieces.unsure));
        let (chord, squares) = &mut self.pieces[of(number)];
        *chord += pieces.chord;
        *squares += pieces.squares;
        self.error += margin * (pieces.length + pieces.unsure);
        // What is on the boundary in the middle changes the mean only as far as the motion is not linear.
        let middle = (length - pieces.length).clamp(0.0, pieces.unsure);
        let off = unsure[0] * own.mean + middle * own.off;
        self.unsure = [self.unsure[0] + off, self.unsure[1] + unsure[1] * own.most];
        let spread = motion.spread(tracer.far);
        let total: f64 = spread.iter().sum();
        for (error, part) in self.errors.iter_mut().zip(spread) {
            *error += if total > 0.0 { off * part / total } else { 0.0 };
        }
    }

    /// Bounds of the area, which is at most that of the whole rectangle.
    pub fn finish(mut self, motions: &[Motion<N>], whole: f64) -> Area<N> {
        let mut slope = [0.0_f64; N];
        for (motion, (chord, squares)) in motions.iter().zip(&self.pieces) {
            let Motion { turn, shift } = motion;
            // The outer normals of the pieces times their lengths.
            let normal = Complex::new(chord.im, -chord.re);
            let parts = [(&shift.re, normal.re), (&shift.im, normal.im), (turn, -0.5 * squares)];
            for (change, by) in parts {
                self.area += by * change.centre;
                self.error += by.abs() * change.total_error();
                for (i, slope) in slope.iter_mut().enumerate() {
                    *slope += by * change.slope[i];
                    self.errors[i] += by.abs() * change.error[i];
                }
            }
            // The pieces turn while they move.
            self.error += turn.furthest() * motion.reach() * chord.norm();
        }
        let within = |off: f64| match [self.area - off, self.area + off] {
            [low, high] if low.is_finite() && high.is_finite() => {
                [low.clamp(0.0, whole), high.clamp(0.0, whole)]
            }
            _ => [0.0, whole],
        };
        let change: f64 = slope.iter().map(|s| s.abs()).sum();
        Area {
            mean: within(self.error + self.unsure[0]),
            range: within(self.error + self.unsure[1] + change),
            errors: self.errors,
            spread: std::array::from_fn(|i| self.errors[i] + slope[i].abs()),
        }
    }
}
