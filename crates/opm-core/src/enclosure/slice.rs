//! Boxes with a range of places in the plane: the area that the legs reach there, for all that the other coordinates of
//! the box may be.
//!
//! In a plane, the translations that a leg reaches are a region between lines and circles, which the leg's displacement
//! along the intersection motion moves ([`Shape`]). What the legs have in common is integrated over the plane
//! exactly, and over the other coordinates with the error of its motions (`area.rs`).

use super::area::{Area, Motion, Reach, Regions, Set};
use super::boundary::{Curve, dot};
use super::{BoxQuery, LegConditions, Side, Upper, within};
use crate::boxes::Share;
use crate::boxes::{Affine, Plane};
use crate::boxes::{Enclosed, Target};
use crate::chain::planar::{PlanarJoint, Prp};
use crate::chain::region::{Band, Convex, Region};
use crate::chain::shape::{Shape, ShapeMotion};
use crate::chain::{DEGENERATE, REACH_TOLERANCE};
use crate::manipulator::{Choices, Manipulator, Mode};
use crate::mechanism::leg::Section;
use crate::task::{CoordinateKind, TaskCoordinate};
use nalgebra::Complex;

/// The ranges of `x` and `y` of a box: their middles, and half their widths.
#[derive(Clone, Copy, Debug)]
pub struct Rectangle {
    pub middle: Complex<f64>,
    pub half: [f64; 2],
    /// The largest number that it was computed from.
    pub size: f64,
}

impl Manipulator {
    /// The numbers of the coordinates of a place in the plane, where boxes can be integrated over them: both have a width,
    /// and the places that each leg reaches are regions of the plane.
    pub(super) fn plane(
        &self,
        query: BoxQuery,
        mode: Option<Mode>,
        sides: &[Side],
    ) -> Option<[usize; 2]> {
        if query == BoxQuery::Upper || self.dependent.is_some() || self.is_whole() {
            return None;
        }
        let coordinates = &self.task().coordinates[..self.task().lower_count];
        let number = |kind: CoordinateKind| {
            let place = coordinates.iter().position(|c: &TaskCoordinate| c.kind() == kind)?;
            (sides[place].half > 0.0).then_some(place)
        };
        let plane = [number(CoordinateKind::X)?, number(CoordinateKind::Y)?];
        let regions = (0..self.legs.len()).all(|leg| self.has_regions(leg, query, mode));
        regions.then_some(plane)
    }

    /// The rectangle of the places of a box, measured from home.
    pub(super) fn rectangle(&self, plane: [usize; 2], sides: &[Side]) -> Rectangle {
        let home = |number: usize| self.task().coordinates[number].home;
        let [x, y] = plane.map(|number| sides[number].middle - home(number));
        let sizes = plane.map(|number| sides[number].middle.abs() + home(number).abs());
        let half = plane.map(|number| sides[number].half);
        Rectangle { middle: Complex::new(x, y), half, size: sizes[0] + sizes[1] }
    }

    /// Whether the places that a leg reaches are regions of the plane.
    fn has_regions(&self, leg: usize, query: BoxQuery, mode: Option<Mode>) -> bool {
        let compiled = &self.legs[leg];
        let leans = compiled.lean.as_ref().is_some_and(|lean| lean.section == Section::Lower);
        let by_upper = compiled.split_section == Section::Lower
            && compiled.upper_constrains
            && query == BoxQuery::Whole;
        let (choices, rise) =
            (mode.map_or_else(Choices::default, Choices::of), Affine::constant(0.0));
        let conditions = LegConditions::<1> { manipulator: self, choices, rise };
        let mut branches = conditions.branches(leg, Section::Lower);
        let regions =
            branches.all(|branch| compiled.shape(branch).is_some_and(|shape| !shape.limits_link()));
        !leans && !by_upper && compiled.lower.offset.is_none() && regions
    }
}

/// What the legs reach in a rectangle of the plane, over a box of the other coordinates.
pub struct Slice<'a, 'b, const N: usize> {
    conditions: &'a LegConditions<'b, N>,
    rectangle: Rectangle,
    regions: Regions<N>,
    /// Conditions on the other coordinates that are not met all over the box, and whether nothing is reached without them.
    partial: Vec<(Share<N>, bool)>,
    /// What keeps a region from being known.
    unknown: Option<Affine<N>>,
}

impl<'a, 'b, const N: usize> Slice<'a, 'b, N> {
    pub fn new(conditions: &'a LegConditions<'b, N>, rectangle: Rectangle) -> Self {
        let regions = Regions::new(rectangle.half);
        Self { conditions, rectangle, regions, partial: Vec::new(), unknown: None }
    }

    /// Adds a condition that everything depends on. Returns whether it can be met.
    pub fn require(&mut self, share: Share<N>) -> bool {
        if !share.is_all() {
            self.partial.push((share, true));
        }
        !share.is_none()
    }

    /// Adds what a leg reaches at `v`, which is placed at the origin of the plane, with `b` or (`tau`) the displacement along
    /// the intersection motion. Returns whether it reaches anything.
    pub fn leg(
        &mut self,
        leg: usize,
        v: &Target<N>,
        b: Option<&Upper<N>>,
        tau: Option<Affine<N>>,
    ) -> bool {
        let compiled = &self.conditions.manipulator.legs[leg];
        let still = Enclosed::Value(Affine::constant(0.0));
        let mut ways = Vec::with_capacity(4);
        match (compiled.split_section, b) {
            (Section::Upper, Some(b)) => {
                let upper = self.conditions.chain(leg, Section::Upper, b.of_chain(compiled));
                if !self.require(upper.closes()) {
                    return false;
                }
                for branch in self.conditions.branches(leg, Section::Upper) {
                    let displacements = upper.displacements(branch);
                    let within = self.conditions.admits(&compiled.upper, &displacements);
                    ways.push((within, b.step(compiled, &displacements)));
                }
            }
            (Section::Upper, None) => {
                ways.push((Share::ALL, tau.map_or(still, Enclosed::Value)));
            }
            (Section::Lower, _) => ways.push((Share::ALL, still)),
        }
        let mut reaches = Vec::with_capacity(4);
        for (share, tau) in ways {
            if share.is_none() {
                continue;
            }
            let motion = self.conditions.manipulator.task().lower_intersection;
            let (rotation, translation) = match motion.after(v, tau) {
                Target::Planar(g) => (g.rotation, g.translation),
                Target::Translational(t) => (Plane::constant(Complex::ONE), t),
                Target::Identity(_)
                | Target::Spherical(_)
                | Target::Cylindrical(..)
                | Target::Spatial(_) => unreachable!("the lower section moves in a plane"),
            };
            let mut known: Option<&Shape> = None;
            for branch in self.conditions.branches(leg, Section::Lower) {
                let Some(shape) = compiled.shape(branch) else { continue };
                // The branches of two links reach the same.
                if known.replace(shape) == Some(shape) {
                    continue;
                }
                let share = match shape.rotation_limits() {
                    None => share,
                    Some((reversed, limits)) => {
                        let turned = if reversed { rotation.conj() } else { rotation };
                        share.and(within(limits, &Enclosed::UnitDirection(turned)))
                    }
                };
                if share.is_none() {
                    continue;
                }
                let sure = share.is_all();
                if !sure {
                    self.partial.push((share, false));
                }
                reaches.extend(self.placed(shape, rotation, translation, sure));
            }
        }
        let any = !reaches.is_empty() || self.unknown.is_some();
        self.regions.legs.push(reaches);
        any
    }

    /// The region of a shape; `None` if it is empty.
    fn placed(
        &mut self,
        shape: &Shape,
        rotation: Plane<N>,
        translation: Plane<N>,
        sure: bool,
    ) -> Option<Reach> {
        // A translation `t` of the box takes the target to `t + translation`, and its middle is the origin.
        let shift = Plane::constant(-self.rectangle.middle) - translation;
        let finite = |range: &[f64; 2]| {
            range
                .iter()
                .filter(|end| end.is_finite())
                .fold(0.0, |most: f64, end| most.max(end.abs()))
        };
        let of_shape = match shape.motion() {
            ShapeMotion::Carried(region, pivot) | ShapeMotion::Turned(region, pivot) => {
                region.size() + pivot.norm()
            }
            ShapeMotion::Sheared(_, ranges) => ranges.iter().map(finite).sum(),
        };
        let size = of_shape + self.rectangle.size + middle(shift).norm();
        self.regions.size = self.regions.size.max(size);
        match shape.motion() {
            ShapeMotion::Carried(region, pivot) => {
                let shift = shift - rotation * *pivot;
                let place = middle(shift);
                let motion = self.regions.motion(Motion::shift(shift - place));
                self.moved(&region.placed(place, 1.0), motion, sure)
            }
            ShapeMotion::Turned(region, pivot) => {
                let shift = shift + *pivot;
                let (turned, place) = (direction(rotation), middle(shift));
                let motion = self.about(shift, rotation * turned.conj(), place);
                self.moved(&region.turned(turned).placed(place, 1.0), motion, sure)
            }
            ShapeMotion::Sheared(chain, ranges) => {
                self.parallelogram(chain, *ranges, [rotation, shift], sure)
            }
        }
    }

    /// The number of a new motion that rotates about a point, which is at `place` in the middle of the box.
    fn about(&mut self, point: Plane<N>, rotation: Plane<N>, place: Complex<f64>) -> usize {
        let (turn, shift) = (rotation.argument(), point - rotation * place);
        self.regions.motion(Motion { turn, shift })
    }

    /// A region that moves as a whole; `None` if it is empty.
    fn moved(&mut self, region: &Region, motion: usize, sure: bool) -> Option<Reach> {
        let whole = self.set(&region.whole, motion)?;
        let hole = region.hole.as_ref().and_then(|hole| self.set(hole, motion));
        Some(Reach { whole, hole, sure })
    }

    /// A convex set; `None` if it is empty.
    fn set(&mut self, set: &Convex, motion: usize) -> Option<Set> {
        let mut found = Set::default();
        match set {
            Convex::Bands(bands) => {
                for band in bands {
                    self.band(band, motion, &mut found)?;
                }
            }
            Convex::Disc(disc) => {
                let (centre, radius) = (disc.centre(), disc.radius()?);
                if radius.is_finite() {
                    let curve = Curve::Circle { centre, radius };
                    found.all.push(self.regions.side(curve, motion));
                }
            }
            Convex::Capsule(capsule) => {
                let (bands, disc) = capsule.parts();
                for band in &bands {
                    self.band(band, motion, &mut found)?;
                }
                let curve = Curve::Circle { centre: disc.centre(), radius: disc.radius()? };
                found.or = Some(self.regions.side(curve, motion));
            }
        }
        Some(found)
    }

    /// Adds the sides of a band; `None` if it is empty.
    fn band(&mut self, band: &Band, motion: usize, found: &mut Set) -> Option<()> {
        let (normal, [low, high]) = (band.across(), band.range());
        if low > high {
            return None;
        }
        for (normal, offset) in [(normal, high), (-normal, -low)] {
            if offset.is_finite() {
                let side = self.regions.side(Curve::Line { normal, offset }, motion);
                if !found.all.contains(&side) {
                    found.all.push(side);
                }
            }
        }
        Some(())
    }

    /// The parallelogram of a pivot between two sliders: the points `z` with `z + offset = m u + n v`, where the second
    /// slider's direction `v` turns. `None` if it is empty.
    fn parallelogram(
        &mut self,
        chain: &Prp,
        ranges: [[f64; 2]; 2],
        [rotation, shift]: [Plane<N>; 2],
        sure: bool,
    ) -> Option<Reach> {
        let [
            PlanarJoint::Prismatic { along: u },
            PlanarJoint::Revolute { at: pivot, .. },
            PlanarJoint::Prismatic { along },
        ] = chain.joints()
        else {
            unreachable!("a pivot between two sliders")
        };
        let v = rotation * along;
        let crossing = Plane::constant(u).cross(v);
        let least = DEGENERATE.max(REACH_TOLERANCE);
        if crossing.low() <= least && crossing.high() >= -least {
            self.unknown = Some(crossing);
            return None;
        }
        let sense = crossing.centre.signum();
        let base = shift - (rotation * pivot - Plane::constant(pivot));
        let turned = direction(rotation);
        // The components along one slider are kept by lines along the other one.
        let across = [turned * along, u].map(|side| side * Complex::I);
        let across = [-across[0] * sense, across[1] * sense];
        let mut found = Set::default();
        for (slider, range) in ranges.into_iter().enumerate() {
            for (end, sign) in range.into_iter().zip([-1.0, 1.0]) {
                if !end.is_finite() {
                    continue;
                }
                let point = base
                    + if slider == 0 { Plane::constant(u * end) } else { v * Complex::from(end) };
                let place = middle(point);
                let motion = if slider == 0 {
                    self.about(point, rotation * turned.conj(), place)
                } else {
                    self.regions.motion(Motion::shift(point - place))
                };
                let normal = across[slider] * sign;
                let curve = Curve::Line { normal, offset: dot(normal, place) };
                found.all.push(self.regions.side(curve, motion));
            }
        }
        let empty = ranges.iter().any(|[low, high]| low > high);
        (!empty).then_some(Reach { whole: found, hole: None, sure })
    }

    /// Bounds of the share of the box that is reached.
    pub fn share(&self) -> Bounded<N> {
        let [x, y] = self.rectangle.half;
        let whole = 4.0 * x * y;
        if let Some(unknown) = &self.unknown {
            return Bounded { lower: 0.0, upper: 1.0, contributions: unknown.spread() };
        }
        let all = self.regions.area(false);
        if self.partial.is_empty() {
            let [lower, upper] = all.mean.map(|area| area / whole);
            return Bounded { lower, upper, contributions: all.errors };
        }
        // The least and the most that is reached where some of the conditions are not met.
        let stops = self.partial.iter().any(|(_, all)| *all);
        let sure = if stops { Area::constant(0.0) } else { self.regions.area(true) };
        let least = all.range[0].max(sure.range[0]);
        let most = sure.range[1].min(all.range[1]);
        // The least shares where all conditions are met, and where none is.
        let shares = || self.partial.iter().map(|(share, _)| share);
        let met = 1.0 - shares().map(|share| 1.0 - share.lower).sum::<f64>();
        let unmet = 1.0 - shares().map(|share| share.upper).sum::<f64>();
        let between = |share: f64, a: f64, b: f64| (b + share.max(0.0) * (a - b)) / whole;
        let mut contributions = all.spread;
        for (share, _) in &self.partial {
            for (sum, part) in contributions.iter_mut().zip(share.contributions()) {
                *sum += part * all.range[1];
            }
        }
        // Or else what all conditions together leave, less what is lost where some of them are not met.
        let lost = [(all.range[0] - most).max(0.0), (all.range[1] - sure.range[0]).max(0.0)];
        let less = (all.mean[0] - (1.0 - met.clamp(0.0, 1.0)) * lost[1]) / whole;
        let more = (all.mean[1] - unmet.max(0.0) * lost[0]) / whole;
        Bounded {
            lower: between(met, least, sure.range[0]).max(less),
            upper: between(unmet, most, all.range[1]).min(more),
            contributions,
        }
    }
}

/// Bounds of the share of a box that is reached.
#[derive(Clone, Copy, Debug)]
pub struct Bounded<const N: usize> {
    pub lower: f64,
    pub upper: f64,
    /// What each coordinate contributes to their difference.
    pub contributions: [f64; N],
}

impl<const N: usize> Bounded<N> {
    /// Nothing is reached.
    pub const NONE: Self = Self { lower: 0.0, upper: 0.0, contributions: [0.0; N] };
}

/// The point in the middle of a box.
fn middle<const N: usize>(point: Plane<N>) -> Complex<f64> {
    Complex::new(point.re.centre, point.im.centre)
}

/// The direction in the middle of a box, a unit vector.
fn direction<const N: usize>(rotation: Plane<N>) -> Complex<f64> {
    let middle = middle(rotation);
    let length = middle.norm();
    if length > 0.0 { middle / length } else { Complex::ONE }
}
