//! The function that completes a pose by the coordinates that constraining legs determine.

use super::displacement::{Tau, displacement_type};
use super::leg::other;
use super::*;
use crate::library::*;
use crate::trace::*;
use crate::tree::visit;
use opm_core::chain::condition::Condition;
use opm_core::group::{MotionType, SubspaceKind};
use opm_core::manipulator::form::{SectionMotion, StepForm, StepKind, WholeStep};
use opm_core::mechanism::OrientationCoordinates;
use opm_core::numeric::Quantity;

/// The parameters of the function, and the displacements that other sections write.
#[derive(Clone, Copy)]
pub struct Completed {
    pub g: Any,
    pub mode: Bits,
    pub q: Array<Real>,
    pub missed: Array<Real>,
    scratch: Option<Any>,
}

impl Completed {
    /// The deficit of a section.
    fn missed(self, section: Section) -> Real {
        self.missed.at(number(section as usize))
    }
}

impl Writer<'_> {
    /// Traces the function, unless all coordinates are independent.
    pub fn complete(&self) {
        if !self.dependent() {
            return;
        }
        let function = Traced::new(
            "complete",
            "Completes a pose by the coordinates that follow. It returns 0, or the number of the leg whose constraint no value of \
             them satisfies, with the deficits of its lower and its upper section.",
        );
        if let Some(WholeStep::Rows(rows)) = &self.forms.whole {
            self.rows_left(rows);
        }
        self.add(function.body(|p| {
            let (g, pose, mode) = of_pose(p);
            let (q, missed) = (p.add::<Out<[Real]>>("q"), written(p, "missed", 2));
            let steps = self.forms.steps.iter().map(|step| (step.leg, step.section, &step.kind));
            let of_steps = steps.filter(|(.., kind)| !matches!(kind, StepKind::Constant));
            let checks = self.forms.checks.iter().map(|check| (check.leg, check.section));
            let mut sections = of_steps.map(|(leg, section, _)| (leg, section)).chain(checks);
            let needs_scratch = sections.any(|(leg, section)| self.follows(leg, section));
            let scratch = needs_scratch.then(|| displacements("scratch"));
            let all = Completed { g, mode, q, missed, scratch };
            for coordinate in 0..self.task.coordinates.len() {
                let independent = self.forms.independent.iter().position(|&i| i == coordinate);
                q.at(number(coordinate)).set(match independent {
                    Some(place) => pose.at(number(place)),
                    None => self.home(g, coordinate),
                });
            }
            let leg_name =
                |leg: usize| crate::names::comment(&self.manipulator.mechanism().legs[leg].name);
            for (place, step) in (1..).zip(&self.forms.steps) {
                let names: Vec<&str> =
                    step.coordinates.iter().map(|&i| self.task.coordinates[i].name).collect();
                let (names, leg) = (names.join(", "), leg_name(step.leg));
                note(&match step.kind {
                    StepKind::Constant => format!("{names}: constant, because of leg {leg}"),
                    _ => format!("{names}: from the constraint of leg {leg}"),
                });
                block(|| self.step(place, step, all));
            }
            match &self.forms.whole {
                Some(WholeStep::Stem(stem)) => {
                    let mut body = statements(|| self.stem_step(stem, all));
                    visit::drop_unread(&mut body);
                    body.into_iter().for_each(emit);
                }
                Some(WholeStep::Rows(rows)) => self.rows_step(rows, all),
                Some(WholeStep::Mirror(mirror)) => self.mirror_step(mirror, all),
                None => {}
            }
            for (place, check) in (1..).zip(&self.forms.checks) {
                let leg = leg_name(check.leg);
                note(&format!("The constraint of leg {leg} is obeyed already."));
                block(|| self.check(place, check.leg, check.section, &check.condition, all));
            }
            done()
        }));
    }

    fn step(&self, place: usize, step: &StepForm, all: Completed) {
        match &step.kind {
            StepKind::Constant => {
                for &i in &step.coordinates {
                    all.q.at(number(i)).set(self.home(all.g, i));
                }
            }
            StepKind::Condition { condition, harmonic, .. } => {
                self.condition_step(place, step, condition, *harmonic, all);
            }
            StepKind::Joint { motion, all: coordinates } => {
                self.joint_step(place, step, *motion, coordinates, all);
            }
        }
    }

    /// Whether the displacement of a leg along the intersection motion, which its other section tells, matters to a section.
    fn follows(&self, leg: usize, section: Section) -> bool {
        let form = &self.forms.legs[leg];
        // The section whose dependent coordinates are found first is the one that is taken modulo the intersection motion.
        let first_done = match self.shared() {
            Some(MotionType::Rotation) | None => Section::Lower,
            Some(MotionType::Translation) => Section::Upper,
        };
        let other = form.first;
        form.bridged
            && other != section
            && first_done != section
            && displacement_type(self.kind(other)).is_some()
    }

    /// Solves the other section of a leg where its displacement along the intersection motion matters, which it gives.
    fn tau_before(&self, leg: usize, section: Section, all: Completed) -> Option<Tau> {
        let scratch = all.scratch.filter(|_| self.follows(leg, section))?;
        let from = self.forms.legs[leg].first;
        let name = format!("leg{}_first", leg + 1);
        let takes = |parameter: &str| self.find(&name, |one| one.takes(parameter)) == Some(true);
        let mut known = vec![("g", all.g), ("mode", all.mode.into()), ("at", scratch)];
        known.push(("missed", all.missed(from).into()));
        if takes(symbol(from)) {
            let kind = displacement_type(self.kind(from))?;
            let moved = self.displaced(from, all.g, all.q).expr();
            known.push((symbol(from), Any::variable(symbol(from), &kind, Some(moved))));
        }
        if takes("rise") {
            known.push(("rise", named("rise", self.rise(all.g, all.q)).into()));
        }
        if takes("near") {
            known.push(("near", named("near", 0.0).into()));
        }
        let fails = self.call_with(&name, &known).is::<Int>().is_set();
        when(fails, || give(number(leg + 1)));
        self.tau_at(scratch, leg)
    }

    /// What a section's chain has to reach at the coordinates, as a variable.
    fn target(&self, section: Section) -> Any {
        let kind = displacement_type(self.kind(section)).unwrap_or(Type::Int);
        Any::variable("target", &kind, None)
    }

    fn write_target(&self, target: Any, section: Section, tau: Option<Tau>, all: Completed) {
        target.set(self.displaced(section, all.g, all.q));
        if let Some(tau) = tau {
            target.set(self.shifted(section, all.g, target, tau.of(section)));
        }
    }

    /// The value of a condition at a displacement; of a linear one, at the coordinates of its logarithm.
    fn value_of(&self, condition: &Condition, section: Section, own: Any, target: Any) -> Real {
        let of = match (condition, self.kind(section)) {
            (Condition::Flat { .. }, SubspaceKind::Cylindrical) => {
                let Cylindrical { angle, advance, .. } = target.is();
                vector_of(angle, advance, 0.0).into()
            }
            (Condition::Flat { .. }, SubspaceKind::TranslationalPlane) => {
                let Complex { re, im, .. } = target.is();
                vector_of(re, im, 0.0).into()
            }
            _ => target,
        };
        let word = super::geometry::condition(condition).0;
        self.call(&format!("value_{word}"), &given![own, of]).is()
    }

    /// How far a condition is missed that has a value.
    fn missed_by(&self, condition: &Condition, own: Any, value: Real) -> Real {
        let word = super::geometry::condition(condition).0;
        self.call(&format!("missed_{word}"), &given![own, value]).is()
    }

    fn condition_step(
        &self,
        place: usize,
        step: &StepForm,
        condition: &Condition,
        harmonic: bool,
        all: Completed,
    ) {
        let ([coordinate], Completed { g, mode, q, .. }) = (&step.coordinates[..], all) else {
            return;
        };
        let (coordinate, word) = (*coordinate, super::geometry::condition(condition).0);
        let own = g.part(&format!("condition{place}"), Type::Struct(word.to_owned()));
        let tau = self.tau_before(step.leg, step.section, all);
        let length = self.task.coordinates[coordinate].quantity == Quantity::Length;
        let size: Real = g.member("size");
        let unit = match condition {
            Condition::Circle { .. } => size * size,
            Condition::Line { .. } | Condition::CarriedLine { .. } | Condition::Flat { .. } => size,
            Condition::Heading { .. } | Condition::Cone { .. } => Real::from(1.0),
        };
        let sign_of = step.bit.map_or(Real::from(1.0), |bit| sign(mode, bit));
        let place = number(coordinate);
        name!(held = q.at(place), home = self.home(g, coordinate));
        let (value, c) = (Array::<Real>::empty("value", 3), Array::<Real>::empty("c", 3));
        let start = held - home;
        name!(u = if length && !harmonic { start / size } else { start });
        let step_size = if length { size } else { Real::from(1.0) };
        count("i", 0, 3, |i| {
            let target = self.target(step.section);
            q.at(place).set(match harmonic {
                true => home + i.real() * (PI / 2.0),
                false => home + (i - 1).real() * step_size,
            });
            self.write_target(target, step.section, tau, all);
            value.at(i).set(self.value_of(condition, step.section, own, target));
        });
        if harmonic {
            c.at(0).set((value.at(0) + value.at(2)) / 2.0);
            c.at(1).set((value.at(0) - value.at(2)) / 2.0);
            c.at(2).set(value.at(1) - c.at(0));
        } else {
            c.at(0).set(value.at(1));
            c.at(1).set((value.at(2) - value.at(0)) / 2.0);
            c.at(2).set((value.at(2) + value.at(0)) / 2.0 - value.at(1));
        }
        let missed = all.missed(step.section);
        let without = match harmonic {
            true => zero_harmonic(c, sign_of, unit, u, missed),
            false => zero_polynomial(c, sign_of, unit, u, missed),
        };
        when(without.is_set(), || {
            missed.set(self.missed_by(condition, own, missed));
            give(number(step.leg + 1));
        });
        q.at(place).set(match harmonic {
            true => near(home + u, held),
            false => home + step_size * u,
        });
    }

    fn check(
        &self,
        place: usize,
        leg: usize,
        section: Section,
        condition: &Condition,
        all: Completed,
    ) {
        let word = super::geometry::condition(condition).0;
        let own = all.g.part(&format!("check{place}"), Type::Struct(word.to_owned()));
        let tau = self.tau_before(leg, section, all);
        let target = self.target(section);
        self.write_target(target, section, tau, all);
        let value = self.value_of(condition, section, own, target);
        name!(off = self.missed_by(condition, own, value));
        let most = match condition {
            Condition::Heading { .. } | Condition::Cone { .. } => OBEYED,
            _ => OBEYED * all.g.member::<Real>("size"),
        };
        when(!off.le(most), || {
            all.missed(section).set(off);
            give(number(leg + 1));
        });
    }

    /// The angles of the factors of an orientation, for its coordinates in their order.
    fn to_factors(&self, [a, b, c]: [Real; 3]) -> [Real; 3] {
        match self.angles_of_pose() {
            OrientationCoordinates::EulerAngles | OrientationCoordinates::RollPitchYaw => [a, b, c],
            OrientationCoordinates::TiltTorsion => [a, b, c - a],
        }
    }

    /// The coordinates of an orientation, in the order of its factors, for their angles.
    fn of_factors(&self, [a, b, c]: [Real; 3]) -> [Real; 3] {
        match self.angles_of_pose() {
            OrientationCoordinates::EulerAngles | OrientationCoordinates::RollPitchYaw => [a, b, c],
            OrientationCoordinates::TiltTorsion => [a, b, a + c],
        }
    }

    fn joint_step(
        &self,
        place: usize,
        step: &StepForm,
        motion: SectionMotion,
        coordinates: &[usize],
        all: Completed,
    ) {
        let Completed { g, mode, q, .. } = all;
        let section = step.section;
        let kind = self.kind(section);
        let tau = self.tau_before(step.leg, section, all);
        let of_type = displacement_type(kind).unwrap_or(Type::Int);
        let at = |i: usize| q.at(number(coordinates[i]));
        let home = |i: usize| coordinates.get(i).map_or(Real::from(0.0), |&i| self.home(g, i));
        // g = exp(I τ) · exp(s q) for b, and exp(s q) · exp(-I τ) for v.
        let shift = |moved: Any| match tau {
            None => moved,
            Some(tau) => self.shifted(section, g, moved, tau.of(other(section))),
        };
        let shift_variable = |moved: Any| {
            if tau.is_some() {
                moved.set(shift(moved));
            }
        };
        // The rotation about the third direction in the rest.
        let still = || {
            let still = Any::variable("still", &of_type, Some(identity(kind).expr()));
            shift_variable(still);
            still
        };
        let joint = format!("joint{place}");
        let third_of = |still: Rotation| atan2(still.x.y, still.x.x);
        let found: [Real; 3] = match motion {
            SectionMotion::None => {
                let still = still();
                match kind {
                    SubspaceKind::Spherical => {
                        let [first, second, last] = self.to_factors([0, 1, 2].map(home));
                        self.of_factors([first + third_of(still.is()), second, last])
                    }
                    _ => coordinates_of(kind, still, home),
                }
            }
            SectionMotion::Turn(_) => {
                let still = still().is::<Planar>();
                name!(turn = unit(at(2) - home(2)) * conjugate(still.rotation));
                name!(about = g.member::<Complex>(&joint));
                name!(moved = planar_of(turn, about - turn * about));
                shift_variable(moved.into());
                coordinates_of(kind, moved.into(), home)
            }
            SectionMotion::Slide(_, given) => {
                let along = |s: Real| match kind {
                    SubspaceKind::Planar => {
                        let slide = g.member::<Complex>(&joint);
                        Any::from(planar_of(complex_of(1.0, 0.0), slide * s))
                    }
                    _ => add(vector_of(0.0, 0.0, 0.0), s, g.member::<Vector>(&joint)).into(),
                };
                let [from, to] = [("start", 0.0), ("end", 1.0)].map(|(name, s)| {
                    let at = Any::variable(name, &of_type, Some(along(s.into()).expr()));
                    shift_variable(at);
                    coordinates_of(kind, at, |_| Real::from(0.0))[given]
                });
                name!(past = at(given) - home(given) - from, rate = to - from);
                let moved = Any::variable("moved", &of_type, None);
                when(!abs(rate).ge(DEGENERATE), || {
                    all.missed(section).set(missed(abs(past)));
                    give(number(step.leg + 1));
                });
                moved.set(along(past / rate));
                shift_variable(moved);
                coordinates_of(kind, moved, home)
            }
            SectionMotion::Third => {
                let [_, second, last] = self.to_factors([0, 1, 2].map(home));
                let angles = self.of_factors([at(0), second, last]);
                for (&coordinate, angle) in coordinates.iter().zip(angles).skip(1) {
                    q.at(number(coordinate)).set(angle);
                }
                return;
            }
            SectionMotion::Axis(_) | SectionMotion::LastAngle(_) => {
                let still = tau.is_some().then(|| still().is::<Rotation>());
                let sign_of = step.bit.map_or(Real::from(1.0), |bit| sign(mode, bit));
                let axis = g.member::<Vector>(&joint);
                name!(zeta = 0.0, psi = 0.0);
                let missed = all.missed(section);
                let home = self
                    .forms
                    .home_orientation_inverse
                    .map(|_| transposed(g.member::<Rotation>("home_orientation_inverse")));
                missed.set(match (self.angles_of_pose(), home) {
                    (
                        OrientationCoordinates::EulerAngles | OrientationCoordinates::TiltTorsion,
                        None,
                    ) => axis_from_identity(axis, at(1), sign_of, zeta, psi),
                    (
                        OrientationCoordinates::EulerAngles | OrientationCoordinates::TiltTorsion,
                        Some(home),
                    ) => axis_from_home(axis, home, at(1), sign_of, zeta, psi),
                    (OrientationCoordinates::RollPitchYaw, home) => {
                        let home = home.unwrap_or_else(|| identity(kind).is());
                        let xi = at(1) + PI / 2.0;
                        axis_from_home(axis, quarter_turned(home), xi, sign_of, zeta, psi)
                    }
                });
                when(missed.gt(0.0), || give(number(step.leg + 1)));
                let zeta = match (motion, still) {
                    (SectionMotion::LastAngle(_), _) => at(0),
                    (_, Some(still)) => zeta + third_of(still),
                    (_, None) => zeta,
                };
                self.of_factors([zeta, at(1), psi])
            }
        };
        for (&coordinate, value) in coordinates.iter().zip(found) {
            if !step.coordinates.contains(&coordinate) {
                continue;
            }
            let angle = self.task.coordinates[coordinate].quantity == Quantity::Angle;
            let place = q.at(number(coordinate));
            place.set(match angle && kind != SubspaceKind::Cylindrical {
                true => near(value, place),
                false => value,
            });
        }
    }
}

/// The identity of a kind.
fn identity(kind: SubspaceKind) -> Any {
    match kind {
        SubspaceKind::Identity => Int::from(0).into(),
        SubspaceKind::Planar => planar_of(complex_of(1.0, 0.0), complex_of(0.0, 0.0)).into(),
        SubspaceKind::Spherical => {
            rotation_about(vector_of(0.0, 0.0, 1.0), complex_of(1.0, 0.0)).into()
        }
        SubspaceKind::Cylindrical => cylindrical_of(0.0, 0.0).into(),
        SubspaceKind::TranslationalPlane => complex_of(0.0, 0.0).into(),
        SubspaceKind::TranslationalSpace => vector_of(0.0, 0.0, 0.0).into(),
    }
}

/// The coordinates of a displacement of a section that has all coordinates of its subspace.
fn coordinates_of(kind: SubspaceKind, g: Any, home: impl Fn(usize) -> Real) -> [Real; 3] {
    let parts = match kind {
        SubspaceKind::Identity => [None; 3],
        SubspaceKind::Planar => {
            let Planar { rotation, translation, .. } = g.is();
            [translation.re, translation.im, angle(rotation)].map(Some)
        }
        SubspaceKind::Spherical => {
            let first = g.is::<Rotation>().x;
            [Some(atan2(first.y, first.x)), None, None]
        }
        SubspaceKind::Cylindrical => {
            let Cylindrical { angle, advance, .. } = g.is();
            [Some(angle), Some(advance), None]
        }
        SubspaceKind::TranslationalPlane => {
            let Complex { re, im, .. } = g.is();
            [Some(re), Some(im), None]
        }
        SubspaceKind::TranslationalSpace => {
            let Vector { x, y, z, .. } = g.is();
            [x, y, z].map(Some)
        }
    };
    let mut place = 0;
    parts.map(|part| {
        let home = home(place);
        place += 1;
        part.map_or(home, |part| home + part)
    })
}
