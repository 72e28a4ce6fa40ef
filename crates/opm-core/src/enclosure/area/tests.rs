//! Areas compared with closed forms, and with points that are drawn at random.

use super::*;
use fastrand::Rng;
use std::f64::consts::PI;

/// A convex set, by its own definition.
#[derive(Clone, Copy, Debug)]
enum Form {
    Disc(Complex<f64>, f64),
    /// The points at most so far from a line, with its direction.
    Band(Complex<f64>, Complex<f64>, f64),
    /// The points at most so far from a ray.
    Capsule(Complex<f64>, Complex<f64>, f64),
}

impl Form {
    fn contains(&self, z: Complex<f64>) -> bool {
        match *self {
            Self::Disc(centre, radius) => (z - centre).norm() <= radius,
            Self::Band(point, along, half) => ((z - point) * along.conj()).im.abs() <= half,
            Self::Capsule(tip, along, radius) => {
                let local = (z - tip) * along.conj();
                let ahead = local.re.max(0.0);
                (local - ahead).norm() <= radius
            }
        }
    }

    fn set(&self, regions: &mut Regions<2>, motion: usize) -> Set {
        // The points at most so far beyond a point along a normal.
        let mut line = |normal: Complex<f64>, at: Complex<f64>, off: f64| {
            let offset = normal.re * at.re + normal.im * at.im + off;
            regions.side(Curve::Line { normal, offset }, motion)
        };
        match *self {
            Self::Disc(centre, radius) => {
                let side = regions.side(Curve::Circle { centre, radius }, motion);
                Set { all: vec![side], or: None }
            }
            Self::Band(point, along, half) => {
                let across = along * Complex::I;
                let all = vec![line(across, point, half), line(-across, point, half)];
                Set { all, or: None }
            }
            Self::Capsule(tip, along, radius) => {
                let across = along * Complex::I;
                // As in the regions of chains, the band is a little wider.
                let wide = radius * (1.0 + 1e-12);
                let all =
                    vec![line(across, tip, wide), line(-across, tip, wide), line(-along, tip, 0.0)];
                let or = regions.side(Curve::Circle { centre: tip, radius }, motion);
                Set { all, or: Some(or) }
            }
        }
    }

    fn random(rng: &mut Rng) -> Self {
        let mut number = |low: f64, high: f64| low + rng.f64() * (high - low);
        let (at, along) = (
            Complex::new(number(-1.2, 1.2), number(-1.2, 1.2)),
            Complex::from_polar(1.0, number(-PI, PI)),
        );
        let size = number(0.2, 1.5);
        // Every other direction is along a side of the rectangle.
        let along = if size < 0.85 { Complex::I } else { along };
        match rng.u8(..3) {
            0 => Self::Disc(at, size),
            1 => Self::Band(at, along, 0.5 * size),
            _ => Self::Capsule(at, along, 0.6 * size),
        }
    }
}

/// A moving region: a form with a hole, the slopes of its turn and its shift by two coordinates.
#[derive(Clone, Debug)]
struct Moving {
    whole: Form,
    hole: Option<Form>,
    turn: [f64; 2],
    shift: [[f64; 2]; 2],
}

impl Moving {
    fn random(rng: &mut Rng, size: f64) -> Self {
        let mut slopes = || [0, 1].map(|_| size * (2.0 * rng.f64() - 1.0));
        let shift = [slopes(), slopes()];
        let turn = if shift[0][0] > 0.0 { slopes() } else { [0.0; 2] };
        let hole = rng.bool().then(|| Form::random(rng));
        Self { whole: Form::random(rng), hole, turn, shift }
    }

    fn contains(&self, z: Complex<f64>, at: [f64; 2]) -> bool {
        let linear = |slope: [f64; 2]| slope[0] * at[0] + slope[1] * at[1];
        let shift = Complex::new(linear(self.shift[0]), linear(self.shift[1]));
        let back = (z - shift) * Complex::from_polar(1.0, -linear(self.turn));
        self.whole.contains(back) && !self.hole.is_some_and(|hole| hole.contains(back))
    }

    fn reach(&self, regions: &mut Regions<2>, sure: bool) -> Reach {
        let linear = |slope| Affine { slope, ..Affine::constant(0.0) };
        let shift = Plane { re: linear(self.shift[0]), im: linear(self.shift[1]) };
        let motion = regions.motion(Motion { turn: linear(self.turn), shift });
        let whole = self.whole.set(regions, motion);
        let hole = self.hole.map(|hole| hole.set(regions, motion));
        Reach { whole, hole, sure }
    }
}

const HALF: [f64; 2] = [1.0, 0.7];

fn area(legs: &[Vec<Moving>]) -> Area<2> {
    area_in(HALF, legs)
}

fn area_in(half: [f64; 2], legs: &[Vec<Moving>]) -> Area<2> {
    let mut regions = Regions::new(half);
    for leg in legs {
        let reaches = leg.iter().map(|moving| moving.reach(&mut regions, true)).collect();
        regions.legs.push(reaches);
    }
    regions.area(false)
}

fn still(whole: Form, hole: Option<Form>) -> Vec<Moving> {
    vec![Moving { whole, hole, turn: [0.0; 2], shift: [[0.0; 2]; 2] }]
}

/// Bounds without motions are exact to rounding.
fn is(found: &Area<2>, expected: f64) {
    is_within(found, expected, 1e-8);
}

fn is_within(found: &Area<2>, expected: f64, gap: f64) {
    let [low, high] = found.range;
    assert!(low <= expected && expected <= high, "{expected} {found:?}");
    assert!(high - low < gap, "{found:?}");
}

#[test]
fn areas_at_rest_have_closed_forms() {
    let at = Complex::new;
    let disc = |x: f64, y: f64, r: f64| Form::Disc(at(x, y), r);
    is(&area(&[]), 2.8);
    is(&area(&[still(disc(0.1, 0.1, 0.5), None)]), PI * 0.25);
    is(&area(&[still(disc(0.0, 0.0, 0.6), Some(disc(0.0, 0.0, 0.2)))]), PI * 0.32);
    // A lens of two circles.
    let (r, d) = (0.5_f64, 0.4_f64);
    let lens = 2.0 * r * r * (d / (2.0 * r)).acos() - 0.5 * d * (4.0 * r * r - d * d).sqrt();
    is(&area(&[still(disc(0.0, 0.0, r), None), still(disc(d, 0.0, r), None)]), lens);
    // What half a circle sweeps: a strip.
    let capsule = |x: f64| Form::Capsule(at(x, 0.1), at(1.0, 0.0), 0.3);
    is(&area(&[still(capsule(-0.3), Some(capsule(0.4)))]), 0.7 * 0.6);
    // A corner of the rectangle, and a circle that touches its sides.
    is(&area(&[still(disc(1.0, 0.7, 0.5), None)]), PI * 0.25 / 4.0);
    // Where it touches is known to the root of the rounding.
    is_within(&area(&[still(disc(0.0, 0.0, 0.7), None)]), PI * 0.49, 1e-6);
    // Bands along each other and along the rectangle.
    let band = |y: f64, half: f64| Form::Band(at(0.0, y), at(1.0, 0.0), half);
    is(&area(&[still(band(0.0, 0.7), None), still(band(0.2, 0.5), None)]), 2.0);
    // A leg that reaches two regions.
    let [one, other] = [disc(-0.5, 0.0, 0.3), disc(0.5, 0.0, 0.4)].map(|form| still(form, None));
    is(&area(&[[one, other].concat()]), PI * 0.25);
    is(&area(&[still(disc(3.0, 0.0, 0.5), None)]), 0.0);
    is(&area(&[still(disc(0.0, 0.0, 9.0), Some(disc(0.0, 0.0, 8.0)))]), 0.0);
}

/// Whatever has the same boundary in several legs, has it with all of them.
#[test]
fn boundaries_may_coincide() {
    for (x, r) in [(0.1, 0.5), (0.9, 0.3), (0.0, 0.05)] {
        let disc = |r: f64| Form::Disc(Complex::new(x, 0.1), r);
        let one = area(&[still(disc(r), None)]).mean;
        let [low, high] =
            area(&[still(disc(r), None), still(disc(r), None), still(disc(r), None)]).mean;
        assert!((low - one[0]).abs() < 1e-8 && (high - one[1]).abs() < 1e-8);
        is(&area(&[still(disc(r), None), still(disc(3.0), Some(disc(r)))]), 0.0);
        let two = [still(disc(r), None), still(disc(3.0), Some(disc(r)))].concat();
        is(&area(&[two]), 2.8);
    }
}

/// A rectangle that is far smaller than a circle whose edge it is at: the part of it inside, row by row.
#[test]
fn rectangles_may_be_small() {
    const ROWS: u32 = 4000;
    let mut rng = Rng::with_seed(72);
    for round in 0..400 {
        let size = 10.0_f64.powi(-(round % 10));
        let half = HALF.map(|half| half * size * (0.1 + rng.f64()));
        let radius = 0.5 + 2.0 * rng.f64();
        let out = half[0] * (2.0 * rng.f64() - 1.0);
        let towards = Complex::from_polar(1.0, PI * (2.0 * rng.f64() - 1.0));
        let centre = towards * (radius + out);
        let found = area_in(half, &[still(Form::Disc(centre, radius), None)]);
        // Inside is where |z|² - 2 z · centre + out (2 radius + out) is negative.
        let row = |k: u32| {
            let y = half[1] * ((2.0 * f64::from(k) + 1.0) / f64::from(ROWS) - 1.0);
            let rest = y * y - 2.0 * y * centre.im + out * (2.0 * radius + out);
            let root = centre.re * centre.re - rest;
            if root < 0.0 {
                return 0.0;
            }
            let far = centre.re + centre.re.signum() * root.sqrt();
            let (a, b) = (far, rest / far);
            (a.max(b).min(half[0]) - a.min(b).max(-half[0])).max(0.0)
        };
        let expected = (0..ROWS).map(row).sum::<f64>() * 2.0 * half[1] / f64::from(ROWS);
        let whole = 4.0 * half[0] * half[1];
        let [low, high] = found.mean;
        // Two rows may end within their height.
        let off = 2.0 * whole / f64::from(ROWS);
        assert!(low - off <= expected && expected <= high + off, "{expected} {found:?} {half:?}");
        // The tolerance, for the sizes in this test, along the sides and the arc.
        assert!(high - low < 4e-9 * (half[0] + half[1]), "{found:?} {half:?}");
    }
}

impl Form {
    fn moved(self, turn: Complex<f64>, shift: Complex<f64>) -> Self {
        let to = |z: Complex<f64>| turn * z + shift;
        match self {
            Self::Disc(centre, radius) => Self::Disc(to(centre), radius),
            Self::Band(point, along, half) => Self::Band(to(point), turn * along, half),
            Self::Capsule(tip, along, radius) => Self::Capsule(to(tip), turn * along, radius),
        }
    }
}

impl Moving {
    /// The region where it is at a place of the box, at rest.
    fn rests(&self, at: [f64; 2]) -> Self {
        let linear = |slope: [f64; 2]| slope[0] * at[0] + slope[1] * at[1];
        let turn = Complex::from_polar(1.0, linear(self.turn));
        let shift = Complex::new(linear(self.shift[0]), linear(self.shift[1]));
        let moved = |form: Form| form.moved(turn, shift);
        let (turn, shift) = ([0.0; 2], [[0.0; 2]; 2]);
        Self { whole: moved(self.whole), hole: self.hole.map(moved), turn, shift }
    }
}

/// The mean over a box is that of areas at rest, at the places of a fine grid.
#[test]
fn means_are_those_of_areas_at_rest() {
    const STEPS: u32 = 24;
    let mut rng = Rng::with_seed(73);
    let (mut narrow, mut across) = (0, 0);
    for _ in 0..300 {
        let size = 10.0_f64.powf(-1.0 - 2.0 * rng.f64());
        let legs: Vec<Vec<Moving>> = (0..rng.usize(1..4))
            .map(|_| (0..rng.usize(1..3)).map(|_| Moving::random(&mut rng, size)).collect())
            .collect();
        let found = area(&legs);
        let along = |k: u32| (2.0 * f64::from(k) + 1.0) / f64::from(STEPS) - 1.0;
        let mut mean = 0.0;
        for k in 0..STEPS * STEPS {
            let at = [along(k % STEPS), along(k / STEPS)];
            let rest = |leg: &Vec<Moving>| leg.iter().map(|moving| moving.rests(at)).collect();
            let rest = area(&legs.iter().map(rest).collect::<Vec<Vec<Moving>>>());
            let [low, high] = found.range;
            assert!(low <= rest.mean[1] && rest.mean[0] <= high, "{rest:?} {found:?} {legs:?}");
            mean += 0.5 * (rest.mean[0] + rest.mean[1]) / f64::from(STEPS * STEPS);
        }
        // A grid leaves the second derivative times the square of its step, over 24. Where boundaries touch there is none,
        // but the area grows with the motion to the power of 3/2.
        let step = 2.0 * size / f64::from(STEPS);
        let off = step * step + 1e-7;
        let [low, high] = found.mean;
        assert!(low - off <= mean && mean <= high + off, "{mean} {found:?} {legs:?}");
        narrow += u32::from(high - low < 0.5 * size);
        across += u32::from(0.0 < low && high < 2.8);
    }
    assert!(across > 100 && narrow > 100, "{narrow} {across}");
}

/// How far a share of draws is from its bounds, in standard deviations.
fn deviations(hits: u32, draws: u32, [low, high]: [f64; 2]) -> f64 {
    let share = f64::from(hits) / f64::from(draws);
    let nearest = share.clamp(low, high);
    let deviation = (nearest * (1.0 - nearest) / f64::from(draws)).sqrt();
    if share == nearest { 0.0 } else { (share - nearest).abs() / deviation.max(1e-9) }
}

#[test]
fn bounds_hold_for_random_regions() {
    const DRAWS: u32 = 2000;
    let mut rng = Rng::with_seed(71);
    let whole = 4.0 * HALF[0] * HALF[1];
    let (mut narrow, mut far) = (0, 0);
    for _ in 0..3000 {
        let size = 10.0_f64.powf(-3.0 * rng.f64());
        let legs: Vec<Vec<Moving>> = (0..rng.usize(1..4))
            .map(|_| (0..rng.usize(1..3)).map(|_| Moving::random(&mut rng, size)).collect())
            .collect();
        let found = area(&legs);
        let share = |bounds: [f64; 2]| bounds.map(|area| area / whole);
        let mut place = || 2.0 * rng.f64() - 1.0;
        let corner = [place().signum(), place().signum()];
        let mut hits = [0; 2];
        for _ in 0..DRAWS {
            let z = Complex::new(HALF[0] * place(), HALF[1] * place());
            for (hits, at) in hits.iter_mut().zip([[place(), place()], corner]) {
                let of = |leg: &Vec<Moving>| leg.iter().any(|moving| moving.contains(z, at));
                *hits += u32::from(legs.iter().all(of));
            }
        }
        narrow += u32::from(found.mean[1] - found.mean[0] < 0.05 * whole);
        for (hits, bounds) in hits.into_iter().zip([found.mean, found.range]) {
            let off = deviations(hits, DRAWS, share(bounds));
            far += u32::from(off > 3.0);
            assert!(off < 6.0, "{off} {hits} {found:?} {legs:?}");
        }
    }
    // Of estimates exactly at a bound, 0.27 % are that far off: 16 of 6000. More than 40 are no chance.
    assert!(far <= 40, "{far}");
    assert!(narrow > 1000, "{narrow}");
}

/// Where boundaries cross each other, half the motion leaves a quarter of the difference.
#[test]
fn errors_are_quadratic() {
    let at = Complex::new;
    let gap = |size: f64| {
        let mut legs = [
            still(Form::Disc(at(0.0, 0.0), 0.5), None),
            still(
                Form::Disc(at(0.4, 0.1), 0.45),
                Some(Form::Band(at(0.3, 0.3), at(0.6, 0.8), 0.05)),
            ),
        ];
        legs[0][0].shift = [[size, 0.3 * size], [-0.4 * size, size]];
        legs[1][0].shift = [[-size, 0.0], [0.2 * size, -0.7 * size]];
        legs[1][0].turn = [0.5 * size, -size];
        let found = area(&legs);
        found.mean[1] - found.mean[0]
    };
    for size in [0.02, 0.01, 0.005] {
        let ratio = gap(size / 2.0) / gap(size);
        assert!((0.15..0.35).contains(&ratio), "{ratio}");
    }
}
