//! The pieces of lines and circles that bound what the legs have in common.

use super::known::{reaches, undecided};
use super::{Boundary, Drift, Motion, ROUNDING, Reach, Regions, SIDES};
use crate::enclosure::boundary::{Curve, Passages, Truth};
use nalgebra::Complex;

/// The distance, as a fraction of the largest number of a curve, at which a pose is certainly on one side of it: ten times
/// the tolerance of joint limits and of the boundary of reach.
const MARGIN: f64 = 1e-11;

/// By how much curves are widened at most, as a part of the margin, so that those of different motions are apart where they
/// coincide: by the number of their motion among all.
const WIDENED: f64 = 0.25;

/// A curve that is in the rectangle, where it matters.
#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    /// The number of its boundary.
    pub number: usize,
    /// The number of its leg; `None` for a side of the rectangle.
    leg: Option<usize>,
    pub curve: Curve,
    pub rounding: f64,
    pub margin: f64,
    /// How far it moves.
    pub drift: Drift,
}

/// The pieces of one curve after the other.
pub struct Tracer<'a, const N: usize> {
    pub regions: &'a Regions<N>,
    sure: bool,
    /// Whether all legs reach every point of the rectangle, all over the box; no if one of them reaches none.
    pub reached: Truth,
    /// The distance from the origin that points of the rectangle have at most, wherever they are moved to.
    pub far: f64,
    /// The curves that cross the rectangle. The first ones are its sides.
    pub crossing: Vec<Crossing>,
    /// The sides of the boundaries that do not.
    known: Vec<Truth>,
    /// For each crossing curve, the distance from it at which it is unknown on which side of it a point is.
    pub reaches: Vec<f64>,
    /// Working memory.
    passages: Vec<(f64, usize, Truth)>,
    runs: Vec<Run>,
    point: Point,
}

/// The places on a curve at which it is unknown on which side of another curve it is.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    from: f64,
    pub length: f64,
    /// The side before.
    before: Truth,
    /// The length for which the side matters.
    pub counts: f64,
    /// The place of the other curve among those that cross.
    pub other: usize,
    /// Whether the curve passes to the other side.
    pub through: bool,
}

/// What the pieces of a curve that are on the boundary of the area sum up to.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pieces {
    /// Their parts of the area.
    pub swept: f64,
    /// The sum of their chords.
    pub chord: Complex<f64>,
    /// The sum of the differences of their ends' squared distances from the origin.
    pub squares: f64,
    /// Their length.
    pub length: f64,
    /// The length of those that are perhaps on the boundary.
    pub unsure: f64,
}

/// Whether a piece of a curve is on the boundary of the area.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum On {
    /// The area is on the inner side of the curve.
    Inner,
    /// It is on the outer side.
    Outer,
    Neither,
    Perhaps,
}

impl<'a, const N: usize> Tracer<'a, N> {
    /// Decides which boundaries matter.
    pub fn new(regions: &'a Regions<N>, sure: bool) -> Self {
        let Regions { motions, boundaries, legs, .. } = regions;
        let far = regions.far() + motions.iter().map(Motion::reach).fold(0.0, f64::max);
        let sizes = boundaries.iter().map(|boundary| boundary.curve.size());
        let size = far + sizes.fold(regions.size, f64::max);
        // Curves with one motion have one tolerance, so that those that touch still do.
        let mut margins = vec![0.0_f64; motions.len()];
        for Boundary { curve, motion, .. } in &boundaries[SIDES..] {
            margins[*motion] = margins[*motion].max(curve.uncertainty(size, MARGIN));
        }
        let placed = |(number, &Boundary { curve, motion, leg }): (usize, &Boundary)| {
            // The rectangle has no tolerance.
            let margin = if number < SIDES { 0.0 } else { margins[motion] };
            let apart = WIDENED * margin * motion as f64 / motions.len() as f64;
            let rounding = curve.uncertainty(size, ROUNDING);
            let drift = motions[motion].drift(&motions[0], &curve, far);
            Crossing { number, leg, curve: curve.widened(apart), rounding, margin, drift }
        };
        let mut crossing: Vec<Crossing> = boundaries.iter().enumerate().map(placed).collect();
        let known: Vec<Truth> = (crossing.iter())
            .map(|of| match of.leg {
                None => Truth::Maybe,
                Some(_) => {
                    of.curve.side_of_rectangle(regions.half, of.drift.most + 2.0 * of.margin)
                }
            })
            .collect();
        let reached = legs.iter().map(|leg| reaches(leg, &known, sure));
        let reached = reached.min().unwrap_or(Truth::Yes);
        let mut matters = vec![false; known.len()];
        matters[..SIDES].fill(true);
        for leg in legs {
            undecided(leg, &known, sure, |number| matters[number] = true);
        }
        crossing.retain(|of| matters[of.number]);
        let (reaches, passages, runs) = Default::default();
        let point = Point { legs: vec![None; legs.len()], ..Point::default() };
        Self { regions, sure, reached, far, crossing, known, reaches, passages, runs, point }
    }
}

impl<const N: usize> Tracer<'_, N> {
    /// The pieces of a curve on the boundary of the area. It is unknown on which side of another curve a point is that is
    /// nearer to it than its number in `reaches`. Calls `found` with the runs that matter.
    pub fn pieces(&mut self, at: usize, mut found: impl FnMut(&Run)) -> Pieces {
        let mut pieces = Pieces::default();
        let Some([mut from, to]) = self.start(at) else { return pieces };
        let Self { regions, sure, crossing, passages, runs, point, .. } = self;
        let curve = crossing[at].curve;
        for &(end, place, beyond) in passages.iter().chain([&(to, at, Truth::Yes)]) {
            if end > from {
                let on = point.on(&regions.legs, *sure);
                if on == On::Perhaps {
                    let sole = point.sole(&regions.legs, *sure, crossing);
                    // Where one of the curves decides alone, the others do not count.
                    for (place, run) in runs.iter_mut().enumerate() {
                        let unknown = point.sides[crossing[place].number] == Truth::Maybe;
                        if unknown && sole.is_none_or(|sole| sole == place) {
                            run.counts += curve.rate() * (end - from);
                        }
                    }
                }
                pieces.add(&curve, [from, end], on);
                from = end;
            }
            let run = &mut runs[place];
            let before = point.pass(&crossing[place], beyond);
            if before == Truth::Maybe {
                run.end(&curve, end, beyond, &mut found);
            } else {
                run.before = before;
            }
            (run.from, run.counts) = (end, 0.0);
        }
        for (run, other) in runs.iter_mut().zip(crossing) {
            if point.sides[other.number] == Truth::Maybe {
                run.end(&curve, to, Truth::Maybe, &mut found);
            }
        }
        pieces
    }

    /// Finds where a curve passes the others, and what is known at the beginning of those of its places that are perhaps in
    /// the rectangle. Returns the range of these places; `None` if there are none.
    fn start(&mut self, at: usize) -> Option<[f64; 2]> {
        let Self { crossing, known, reaches, passages, runs, point, .. } = self;
        let Crossing { number, leg, curve, .. } = crossing[at];
        let passing = |place: usize| match place == at {
            true => Passages::constant(Truth::Yes),
            false => curve.passages(&crossing[place].curve, reaches[place]),
        };
        let rectangle: [Passages; SIDES] = std::array::from_fn(passing);
        let range = inside(&rectangle, curve.places(self.far))?;
        passages.clear();
        runs.clear();
        point.start(number, leg, known);
        for (place, other) in crossing.iter().enumerate() {
            let all = if place < SIDES { rectangle[place] } else { passing(place) };
            let before = all.within(range, |at, beyond| passages.push((at, place, beyond)));
            point.sides[other.number] = before;
            let from = range[0];
            runs.push(Run { from, length: 0.0, before, counts: 0.0, other: place, through: false });
        }
        // Passages at one place keep their order.
        passages.sort_by(|a, b| a.0.total_cmp(&b.0));
        Some(range)
    }
}

/// The range of the places on a curve that are perhaps on the inner side of all others, within a range.
fn inside(others: &[Passages; SIDES], range: [f64; 2]) -> Option<[f64; 2]> {
    let mut beyond = 0;
    let mut changes: Vec<(f64, i32)> = Vec::with_capacity(4 * SIDES);
    for passages in others {
        let first = passages.within(range, |_, _| {});
        let mut before = i32::from(first == Truth::No);
        beyond += before;
        passages.within(range, |place, side| {
            let after = i32::from(side == Truth::No);
            if after != before {
                changes.push((place, after - before));
            }
            before = after;
        });
    }
    changes.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let mut from = range[0];
    let mut found: Option<[f64; 2]> = None;
    for (to, change) in changes.into_iter().chain([(range[1], 0)]) {
        if beyond == 0 {
            found = Some([found.map_or(from, |found| found[0]), to]);
        }
        from = to;
        beyond += change;
    }
    found
}

/// A point that goes along a curve.
#[derive(Clone, Debug, Default)]
struct Point {
    /// The boundary that it is on, and the leg of that.
    number: usize,
    own: Option<usize>,
    /// On which sides of the boundaries it is.
    sides: Vec<Truth>,
    /// Whether other legs reach it, if that is known for these sides.
    legs: Vec<Option<Truth>>,
    /// Whether its own leg reaches it on the outer and on the inner side of the curve.
    own_reaches: Option<[Truth; 2]>,
}

impl Point {
    /// Begins with a curve, with the sides of the boundaries that do not cross the rectangle.
    fn start(&mut self, number: usize, own: Option<usize>, known: &[Truth]) {
        (self.number, self.own) = (number, own);
        self.sides.clear();
        self.sides.extend_from_slice(known);
        self.legs.fill(None);
        self.own_reaches = None;
    }

    /// Goes to another side of a curve. Returns the side before.
    fn pass(&mut self, other: &Crossing, beyond: Truth) -> Truth {
        match other.leg {
            Some(_) if self.own == other.leg => self.own_reaches = None,
            Some(leg) => self.legs[leg] = None,
            None => {}
        }
        std::mem::replace(&mut self.sides[other.number], beyond)
    }

    /// Whether the point is on the boundary of the area.
    fn on(&mut self, legs: &[Vec<Reach>], sure: bool) -> On {
        let mut others = self.rectangle();
        if others == Truth::No {
            return On::Neither;
        }
        let own = self.own_reaches(legs, sure);
        if own[0] == own[1] && own[0] != Truth::Maybe {
            return On::Neither;
        }
        for (number, leg) in legs.iter().enumerate() {
            if self.own != Some(number) {
                let known = &mut self.legs[number];
                others = others.min(*known.get_or_insert_with(|| reaches(leg, &self.sides, sure)));
                if others == Truth::No {
                    return On::Neither;
                }
            }
        }
        match own {
            [Truth::No, Truth::Yes] if others == Truth::Yes => On::Inner,
            [Truth::Yes, Truth::No] if others == Truth::Yes => On::Outer,
            _ => On::Perhaps,
        }
    }

    /// Whether it is in the rectangle.
    fn rectangle(&self) -> Truth {
        let [a, b, c, d] = [0, 1, 2, 3].map(|side| self.sides[side]);
        a.min(b).min(c.min(d))
    }

    /// Whether its own leg reaches it on the outer and on the inner side of the curve.
    fn own_reaches(&mut self, legs: &[Vec<Reach>], sure: bool) -> [Truth; 2] {
        let Self { number, sides, .. } = self;
        *self.own_reaches.get_or_insert_with(|| {
            [Truth::No, Truth::Yes].map(|side| {
                sides[*number] = side;
                self.own.map_or(side, |own| reaches(&legs[own], sides, sure))
            })
        })
    }

    /// The place of the crossing curve whose unknown side alone decides whether the point is on the boundary of the area, which
    /// is perhaps; `None` if there is no such curve.
    fn sole(&mut self, legs: &[Vec<Reach>], sure: bool, crossing: &[Crossing]) -> Option<usize> {
        let own = self.own_reaches(legs, sure).contains(&Truth::Maybe);
        let open = |leg: &usize| match self.own {
            Some(of) if of == *leg => own,
            _ => self.legs[*leg] == Some(Truth::Maybe),
        };
        let mut open = (0..legs.len()).filter(open);
        let mut sides = (0..SIDES).filter(|&side| self.sides[side] == Truth::Maybe);
        match [sides.next(), open.next(), sides.next(), open.next()] {
            [Some(side), None, None, None] => Some(side),
            [None, Some(leg), None, None] => {
                let mut of_leg = crossing.iter().enumerate().filter(|(_, of)| of.leg == Some(leg));
                of_leg.find(|(_, of)| self.decides(&legs[leg], sure, of)).map(|(place, _)| place)
            }
            _ => None,
        }
    }

    /// Whether it is known that a leg reaches the point, or not, once the unknown side of a curve of the leg is.
    fn decides(&mut self, leg: &[Reach], sure: bool, curve: &Crossing) -> bool {
        if self.sides[curve.number] != Truth::Maybe {
            return false;
        }
        let of_own = self.own == curve.leg;
        let known = [Truth::No, Truth::Yes].into_iter().all(|side| {
            self.sides[curve.number] = side;
            // The side of its own curve is not unknown, but either.
            let own = if of_own { &[Truth::No, Truth::Yes][..] } else { &[Truth::Yes] };
            own.iter().all(|own| {
                self.sides[self.number] = *own;
                reaches(leg, &self.sides, sure) != Truth::Maybe
            })
        });
        self.sides[curve.number] = Truth::Maybe;
        known
    }
}

impl Run {
    /// Ends the run; `found` gets it if it matters.
    fn end(&mut self, curve: &Curve, to: f64, beyond: Truth, found: &mut impl FnMut(&Self)) {
        self.length = curve.rate() * (to - self.from);
        self.through =
            matches!((self.before, beyond), (Truth::Yes, Truth::No) | (Truth::No, Truth::Yes));
        if self.counts > 0.0 {
            found(self);
        }
    }
}

impl Pieces {
    /// Adds a piece.
    fn add(&mut self, curve: &Curve, [from, to]: [f64; 2], on: On) {
        let length = curve.rate() * (to - from);
        let sign = match on {
            On::Inner => 1.0,
            On::Outer => -1.0,
            On::Neither => return,
            On::Perhaps => {
                self.unsure += length;
                return;
            }
        };
        let (p, q) = (curve.point(from), curve.point(to));
        self.swept += sign * curve.swept([from, to], [p, q]);
        self.chord += (q - p) * sign;
        self.squares += sign * (q.norm_sqr() - p.norm_sqr());
        self.length += length;
    }
}
