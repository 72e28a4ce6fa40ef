//! Families of assemblies: motions of the platform, or of a leg, with the actuated joints held.
//!
//! At an assembly where derivatives of the closure equations have a kernel, it is tried to move along it: a step in a direction of the
//! kernel, then Newton's method in all directions across. On a family it leads back to exact closure, at every step; where assemblies
//! only meet, closure stays wrong by the square of the step. At a place in general position on a family, its dimension is that of
//! the kernel there (Sommese and Wampler, "The Numerical Solution of Systems of Polynomials", 2005, chapter 13).

mod spot;

use super::{Assemblies, Assembly, Certificate, Completeness};
use crate::decomposition::whole::end;
use crate::manipulator::Manipulator;
use crate::numeric::svd::Svd;
use fastrand::Rng;
use nalgebra::{DMatrix, DVector, Isometry3};
use spot::{Spot, damped};

/// Below this share of the largest singular value a direction is in the kernel: where assemblies meet, they are known to half of their
/// digits.
const KERNEL: f64 = 1e-6;
/// The length of a step, radians and sizes.
const STEP: f64 = 0.04;
/// Legs close to within this. Where they do not, a step leaves them open by its square, or by its fourth power, 2.6e-6.
const CLOSED: f64 = 1e-9;
/// Corrections of a step, and those of a start that is farther away.
const CORRECTIONS: usize = 8;
const SEARCH: usize = 60;
/// A family is followed over so many steps, to know that it goes on.
const STAYS: usize = 6;
/// Places beside one on a family are along it, up to its bend over a step.
const BENT: f64 = 0.2;
/// A curve is followed over so many steps of this length either way.
const TRACED: usize = 400;
const LONG: f64 = 0.1;
/// Steps towards a place on a family of several dimensions.
const DOWNHILL: usize = 200;
/// Two places of the platform are one.
const SAME: f64 = 1e-4;
/// Starts near home, and how far from it.
const STARTS: usize = 4;
const NEAR_HOME: f64 = 0.3;

/// Assemblies that are joined by a motion with the actuated joints held.
#[derive(Clone, Debug, PartialEq)]
pub struct Family {
    /// Its dimension: how many freedoms the joints have with the actuated ones held, without those of idle joints.
    pub dimension: usize,
    /// The freedoms of the platform among these. Zero where only a leg moves.
    pub platform: usize,
    /// Whether it counts several times, as where legs stay parallel: then all such families of these dimensions are told as one.
    pub multiple: bool,
    /// For a curve, whether it comes back to where it began; `None` where it was not followed all along.
    pub closed: Option<bool>,
    /// The values of all joint coordinates in one of its assemblies, radians and metres.
    pub joints: Vec<f64>,
    /// The independent task coordinates there, metres and radians.
    pub pose: Vec<f64>,
    /// The platform's displacement from home there.
    pub place: Isometry3<f64>,
    /// The numbers of the assemblies in the list that belong to it.
    pub members: Vec<usize>,
}

/// Moves along families.
struct Mover<'a> {
    manipulator: &'a Manipulator,
    idle: Vec<usize>,
}

impl Manipulator {
    /// The families of assemblies that there are with these values of the actuated joints, as far as they are met: those through assemblies
    /// of which nothing is proven, through home, and through places near home.
    ///
    /// `found` is what [`Manipulator::forward`] gives, and `certificates` what [`Manipulator::certify`] says of it.
    ///
    /// ```
    /// use opm_core::Manipulator;
    ///
    /// let manipulator = Manipulator::example("delta")?;
    /// let found = manipulator.forward(&[0.1, -0.05, 0.2])?;
    /// let certificates = manipulator.certify(&found.list);
    /// assert!(manipulator.families(&[0.1, -0.05, 0.2], &found, &certificates).is_empty());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn families(
        &self,
        actuated: &[f64],
        found: &Assemblies,
        certificates: &[Certificate],
    ) -> Vec<Family> {
        let suspected: Vec<usize> = (certificates.iter().enumerate())
            .filter(|(_, certificate)| **certificate == Certificate::DoubleSuspected)
            .map(|(number, _)| number)
            .collect();
        let missing = match found.completeness {
            Completeness::ClosedForm => !found.loose.is_empty(),
            Completeness::Continuation { found, of } => found < of,
        };
        if actuated.len() != self.actuated().len() || (suspected.is_empty() && !missing) {
            return Vec::new();
        }
        let mover = Mover { manipulator: self, idle: self.idle() };
        let mut families: Vec<Family> = Vec::new();
        for number in suspected {
            let Assembly { joints, .. } = &found.list[number];
            if let Some(family) = mover.family_at(joints, &mut families) {
                families[family].members.push(number);
            }
        }
        if missing {
            for start in mover.starts(actuated) {
                mover.family_at(&start, &mut families);
            }
        }
        families
    }
}

impl Mover<'_> {
    /// Home and places near it, with the actuated joints as given, where the legs close.
    fn starts(&self, actuated: &[f64]) -> Vec<Vec<f64>> {
        let m = self.manipulator;
        let mut rng = Rng::with_seed(75);
        let mut found = Vec::new();
        for number in 0..=STARTS {
            let off = if number == 0 { 0.0 } else { NEAR_HOME };
            let mut joints = m.joints_near_home(off, &mut rng);
            for (&c, &value) in m.actuated().iter().zip(actuated) {
                joints[c] = value;
            }
            found.extend(self.closed(&joints));
        }
        found
    }

    /// The family through an assembly: its number among those that are known, to which a new one is added.
    fn family_at(&self, joints: &[f64], families: &mut Vec<Family>) -> Option<usize> {
        let (spot, dimension) = self.general(joints)?;
        let place = self.place(joints);
        let platform = spot.platform();
        let near = |family: &Family| {
            (family.dimension, family.platform, family.multiple)
                == (dimension, platform, spot.multiple)
                && (family.multiple || self.joins(family, &place))
        };
        if let Some(known) = families.iter().position(near) {
            return Some(known);
        }
        let place = self.place(&spot.joints);
        let closed = (dimension == 1 && !spot.multiple).then(|| self.comes_back(&spot)).flatten();
        let pose = self.manipulator.pose_at(&place);
        let Spot { joints, multiple, .. } = spot;
        let members = Vec::new();
        families.push(Family {
            dimension,
            platform,
            multiple,
            closed,
            joints,
            pose,
            place,
            members,
        });
        Some(families.len() - 1)
    }

    /// A place in general position on the family through an assembly, and its dimension.
    fn general(&self, joints: &[f64]) -> Option<(Spot, usize)> {
        let spot = self.spot(joints)?;
        let ways = spot.ways(STEP);
        let first = ways.iter().find_map(|way| self.stepped(&spot, way));
        // Where branches meet, a direction of the kernel is seldom one of a branch.
        let fallen = || ways.iter().find_map(|way| Some(self.fallen(&spot, way)?.0));
        let first = first.or_else(fallen)?;
        self.regular(&first).or_else(|| self.multiple(&first))
    }

    /// Whether the whole kernel is along the family at a place and at others that follow.
    fn regular(&self, first: &[f64]) -> Option<(Spot, usize)> {
        let mut rng = Rng::with_seed(76);
        let mut spot = self.spot(first)?;
        let dimension = spot.along.ncols();
        let mut last: Option<DVector<f64>> = None;
        for _ in 0..STAYS {
            if spot.along.ncols() == 0 || spot.along.ncols() != dimension {
                return None;
            }
            // On along the last direction, and a little beside it.
            let beside = DVector::from_fn(dimension, |_, _| 2.0 * rng.f64() - 1.0);
            let way = match &last {
                Some(last) if dimension == 1 => spot.along.tr_mul(last),
                Some(last) => spot.along.tr_mul(last) + beside * 0.5,
                None => beside,
            };
            let way = way.normalize();
            let next = self.stepped(&spot, &(&way * STEP));
            let next = next.or_else(|| self.stepped(&spot, &(&way * -STEP)))?;
            last = Some(&spot.along * way);
            spot = self.spot(&next)?;
        }
        let units = DMatrix::<f64>::identity(dimension, dimension) * STEP;
        let all = spot.along.ncols() == dimension
            && units.column_iter().all(|way| self.stepped(&spot, &way.into_owned()).is_some());
        all.then_some((spot, dimension))
    }

    /// The same where a family counts several times, so that directions across it are in the kernel, too: its own directions are those
    /// that places beside it fall back to.
    fn multiple(&self, first: &[f64]) -> Option<(Spot, usize)> {
        let (one, next) = self.beside(first)?;
        let (other, _) = self.beside(&next)?;
        let [most, least] = [&one, &other].map(|spot| spot.along.ncols());
        match most < least {
            true => Some((one, most)),
            false => Some((other, least)),
        }
    }

    /// A place with the directions in which places beside it fall back to the family, and one of these places.
    fn beside(&self, joints: &[f64]) -> Option<(Spot, Vec<f64>)> {
        let mut spot = self.spot(joints)?;
        let ways = spot.ways(STEP);
        let mut fallen: Vec<(Vec<f64>, DVector<f64>)> =
            ways.iter().filter_map(|way| self.fallen(&spot, way)).collect();
        let moved: Vec<DVector<f64>> = fallen.iter().map(|(_, moved)| moved.normalize()).collect();
        if moved.is_empty() {
            return None;
        }
        let svd = Svd::new(DMatrix::from_columns(&moved).transpose());
        spot.along = svd.right.columns(0, svd.rank(BENT)).into_owned();
        spot.multiple = true;
        Some((spot, fallen.swap_remove(0).0))
    }

    /// Whether a family comes to a place of the platform.
    fn joins(&self, family: &Family, place: &Isometry3<f64>) -> bool {
        let off = |joints: &[f64]| self.manipulator.apart(&self.place(joints), place);
        let Some(mut spot) = self.spot(&family.joints) else { return false };
        if off(&spot.joints) < SAME {
            return true;
        }
        if family.dimension == 1 && spot.along.ncols() == 1 {
            return [1.0, -1.0].into_iter().any(|sign| {
                let mut met = false;
                self.trace(&spot, sign, |spot| {
                    met = off(&spot.joints) < 2.0 * LONG && self.nearest(spot, place) < SAME;
                    met
                });
                met
            });
        }
        if spot.along.ncols() != family.dimension {
            return false;
        }
        // Downhill; steps become shorter where none leads down.
        let mut step = STEP;
        for _ in 0..DOWNHILL {
            if step < 0.1 * SAME {
                return false;
            }
            let here = off(&spot.joints);
            let ways = (0..spot.along.ncols()).flat_map(|i| [(i, step), (i, -step)]);
            let next = ways.filter_map(|(i, step)| {
                let way =
                    DVector::from_fn(spot.along.ncols(), |k, _| if k == i { step } else { 0.0 });
                self.stepped(&spot, &way)
            });
            let best = next.min_by(|a, b| off(a).total_cmp(&off(b)));
            match best.filter(|best| off(best) < here).and_then(|best| self.spot(&best)) {
                Some(next) => spot = next,
                None => step *= 0.5,
            }
            if off(&spot.joints) < SAME {
                return true;
            }
        }
        false
    }

    /// How near the family comes to a place within a step, along a curve.
    fn nearest(&self, spot: &Spot, place: &Isometry3<f64>) -> f64 {
        let off = |step: f64| {
            let joints = self.stepped(spot, &DVector::from_element(1, step));
            joints
                .map_or(f64::INFINITY, |joints| self.manipulator.apart(&self.place(&joints), place))
        };
        let (mut middle, mut half) = (0.0, LONG);
        while half > 0.01 * SAME {
            let tried = [middle - half, middle, middle + half];
            let best = tried.into_iter().min_by(|a, b| off(*a).total_cmp(&off(*b)));
            middle = best.unwrap_or(middle);
            half *= 0.6;
        }
        off(middle)
    }

    /// Whether a curve comes back to where it begins; `None` if it ends before, or does not within the steps.
    fn comes_back(&self, spot: &Spot) -> Option<bool> {
        let start = self.place(&spot.joints);
        let (mut steps, mut back) = (0, false);
        let mut nearest = |next: &Spot| {
            steps += 1;
            let off = self.manipulator.apart(&self.place(&next.joints), &start);
            back = steps > 4 && off < 2.0 * LONG && self.nearest(next, &start) < SAME;
            back
        };
        self.trace(spot, 1.0, &mut nearest);
        back.then_some(true)
    }

    /// Follows a curve until `done`.
    fn trace(&self, start: &Spot, sign: f64, mut done: impl FnMut(&Spot) -> bool) {
        let mut way = DVector::from_element(1, sign);
        let mut spot: Option<Spot> = None;
        for _ in 0..TRACED {
            let here = spot.as_ref().unwrap_or(start);
            let Some(next) = self.stepped(here, &(&way * LONG)) else { return };
            let Some(next) = self.spot(&next).filter(|next| next.along.ncols() == 1) else {
                return;
            };
            // The free joints are the same ones unless some are idle: then the direction is that of the platform.
            let turn = match next.free == here.free {
                true => (&here.along * &way).dot(&next.along.column(0)),
                false => here.twist(&way).dot(&next.twist(&DVector::from_element(1, 1.0))),
            };
            way = DVector::from_element(1, turn.signum());
            if done(&next) {
                return;
            }
            spot = Some(next);
        }
    }

    /// Joints from which the legs can move, with the directions.
    fn spot(&self, joints: &[f64]) -> Option<Spot> {
        Spot::new((self.manipulator, &self.idle), joints, &self.place(joints))
    }

    /// The displacement of the platform that the first leg tells.
    fn place(&self, joints: &[f64]) -> Isometry3<f64> {
        let m = self.manipulator;
        let leg = &m.mechanism().legs[0];
        let count: usize = leg.joints.iter().map(|joint| joint.coordinates.len()).sum();
        let home = m.coordinates().iter().map(|c| c.home);
        let values: Vec<f64> = joints.iter().zip(home).take(count).map(|(q, h)| q - h).collect();
        end(leg, &values)
    }

    /// The joints after a step along a family, where the legs close again.
    fn stepped(&self, spot: &Spot, way: &DVector<f64>) -> Option<Vec<f64>> {
        let mut moved = &spot.along * way;
        for _ in 0..CORRECTIONS {
            let (values, jacobian) = spot.at(&moved);
            if values.amax() < 0.01 * CLOSED {
                break;
            }
            let reduced = jacobian * &spot.across;
            let normal = reduced.tr_mul(&reduced).cholesky()?;
            moved -= &spot.across * normal.solve(&reduced.tr_mul(&values));
        }
        let closes = spot.at(&moved).0.amax() < CLOSED && moved.norm() < 4.0 * way.norm();
        closes.then(|| spot.moved(self.manipulator, &moved))
    }

    /// The joints that close beside a place, in all directions, unless they are those of the place again; and how they moved.
    fn fallen(&self, spot: &Spot, way: &DVector<f64>) -> Option<(Vec<f64>, DVector<f64>)> {
        let mut moved = &spot.along * way;
        for _ in 0..SEARCH {
            let (values, jacobian) = spot.at(&moved);
            if values.amax() < 1e-4 * CLOSED {
                break;
            }
            moved += damped(&jacobian, &values)?;
        }
        let closes = spot.at(&moved).0.amax() < 0.01 * CLOSED;
        let length = moved.norm();
        (closes && (0.25 * STEP..4.0 * STEP).contains(&length))
            .then(|| (spot.moved(self.manipulator, &moved), moved))
    }

    /// The joints near others with which the legs close; the actuated ones stay.
    fn closed(&self, joints: &[f64]) -> Option<Vec<f64>> {
        let mut joints = joints.to_vec();
        for _ in 0..SEARCH {
            let spot = self.spot(&joints)?;
            let still = DVector::zeros(spot.free.len());
            let (values, jacobian) = spot.at(&still);
            if values.amax() < 0.01 * CLOSED {
                return Some(joints);
            }
            let step = damped(&jacobian, &values)?;
            let shorter = f64::min(1.0, 0.3 / step.norm());
            joints = spot.moved(self.manipulator, &(step * shorter));
        }
        None
    }
}
