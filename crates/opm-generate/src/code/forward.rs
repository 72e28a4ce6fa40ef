//! The function of the forward kinematics.
//!
//! Its steps are motions of the platform rather than changes of the coordinates: Euler angles are singular at the home pose of
//! many mechanisms. Without them, the two are the same. Where coordinates follow from those of a pose, and there are Euler
//! angles, the steps are in all coordinates, and joints that legs lack stand still.

use super::rates::follow::numbers;
use super::*;
use crate::library::{
    REACH, apart, eliminate, euler_in, euler_near, near, numbers as check_numbers, product,
    roll_in, roll_near, rotation_by, torsion_in, torsion_near, vector_of,
};
use crate::trace::*;
use opm_core::mechanism::OrientationCoordinates;
use opm_core::mechanism::joint::JointKind;
use opm_core::numeric::Quantity;

impl Writer<'_> {
    /// Whether the actuated joints can determine the pose.
    pub fn has_forward(&self) -> bool {
        let coordinates = self.manipulator.task_coordinates().len();
        coordinates > 0 && self.manipulator.actuated().len() >= coordinates
    }

    /// Whether steps are in all coordinates, also those that follow.
    pub fn steps_in_all(&self) -> bool {
        self.turns() && self.dependent()
    }

    /// The numbers of the rows and of the unknowns of the equations of a step.
    pub fn equations(&self) -> [usize; 2] {
        let m = self.manipulator;
        match self.steps_in_all() {
            true => [m.actuated().len() + self.lacking(), self.task.coordinates.len()],
            false => [m.actuated().len(), m.task_coordinates().len()],
        }
    }

    /// The function, and those that it calls, if the actuated joints can determine the pose.
    pub fn forward(&self) {
        if !self.has_forward() {
            return;
        }
        self.off();
        self.linearise();
        match (self.turns(), self.dependent()) {
            (true, true) => self.stepped_in_all(),
            (true, false) => self.stepped(),
            (false, _) => {}
        }
        let function = Traced::new(
            "forward",
            "The pose at which the actuated joints have given values, by Newton's method from a pose nearby, which it replaces; in \
             the working mode of that. The residual is how far the actuated joints are off in the end, radians or sizes of the \
             mechanism. Angles are those nearest to the start's; a tilt is not negative. It returns 0; what NAME_jacobian \
             returns, where it cannot go on; 2 * NAME_LEGS + 1 where the actuated joints do not determine the pose; \
             2 * NAME_LEGS + 2 where it does not converge; or -NAME_COORDINATES - i where actuated joint i, from 1, is no \
             number. Unless it returns 0, pose is the last one.",
        );
        self.add(function.public().body(|p| {
            let (g, actuated) = (geometry(p), p.add::<In<[Real]>>("actuated"));
            let (mode, pose) = (p.add::<Bits>("mode"), p.add::<Out<[Real]>>("pose"));
            self.forward_body(g, actuated, mode, pose, p.add::<Out<Real>>("residual"))
        }));
    }

    fn forward_body(
        &self,
        g: Any,
        actuated: Array<Real>,
        mode: Bits,
        pose: Array<Real>,
        residual: Real,
    ) -> Int {
        let (turns, all) = (self.turns(), self.steps_in_all());
        let [rows, unknowns] = self.equations();
        let m = self.manipulator;
        let (motors, coordinates) = (m.actuated().len(), m.task_coordinates().len());
        let [values, off, next, a, step] = [
            ("values", motors),
            ("off", motors),
            ("next", coordinates),
            ("a", rows * (unknowns + 1)),
            ("step", unknowns),
        ]
        .map(|(name, length)| Array::<Real>::empty(name, length));
        let start = turns.then(|| Array::<Real>::empty("start", unknowns));
        let q = all.then(|| Array::<Real>::empty("q", unknowns));
        let unmet = all.then(|| Array::<Real>::named("unmet", [0.0; 2]));
        let units = (!turns).then(|| self.units(g));
        name!(closer = Int::from(1), status = check_numbers(actuated, ACTUATED));
        residual.set(Real::infinity());
        return_status(status);
        let values_at = |pose| self.call("actuated", &given![g, pose, mode, values]).is::<Int>();
        let how_far = || self.call("off", &given![g, actuated, values, off]).is::<Real>();
        status.set(values_at(pose));
        return_status(status);
        if let (Some(start), Some(unmet)) = (start, unmet) {
            let call = self.call("complete", &given![g, pose, mode, start, unmet]);
            status.set(call.is::<Int>());
            return_status(status);
        } else if let Some(start) = start {
            count("j", 0, COORDINATES, |j| start.at(j).set(pose.at(j)));
        }
        residual.set(how_far());
        let goes_on = closer.is_set() & residual.gt(REACH);
        count_while("iteration", 0, 50, goes_on, |_| {
            name!(longest = 0.0);
            let share = Real::empty("share");
            let linearised = [("g", g), ("pose", pose.into()), ("mode", mode.into())];
            let rest = [("right", Any::from(off)), ("a", a.into())];
            let of_q = q.map(|q| ("q", q.into()));
            let known: Vec<(&str, Any)> = linearised.into_iter().chain(rest).chain(of_q).collect();
            status.set(self.call_with("linearise", &known).is::<Int>());
            return_status(status);
            let unknowns = number(unknowns);
            let singular = eliminate(a, number(rows), unknowns, 1, step);
            when(singular.is_set(), || give(2 * LEGS + 1));
            count("j", 0, unknowns, |j| longest.set(max(longest, abs(step.at(j)))));
            note("Half of the step, until it leads closer. A long one leads astray.");
            share.set(0.5 / max(longest, 0.5));
            closer.set(0);
            count_while("halvings", 0, 30, !closer.is_set(), |_| {
                let mut reached = None;
                match (start, q, units) {
                    (Some(start), Some(q), _) => {
                        let given = given![g, q, start, step, share, mode, next];
                        reached = Some(self.call("stepped", &given).is::<Int>().is(0));
                    }
                    (Some(start), None, _) => {
                        self.call("stepped", &given![g, pose, start, step, share, next]);
                    }
                    (None, _, Some(unit)) => count("j", 0, COORDINATES, |j| {
                        next.at(j).set(pose.at(j) + share * unit.at(j) * step.at(j));
                    }),
                    (None, _, None) => {}
                }
                let in_reach = values_at(next).is(0);
                when(reached.map_or(in_reach, |reached| reached & in_reach), || {
                    name!(distance = how_far());
                    when(distance.lt(residual), || {
                        closer.set(1);
                        residual.set(distance);
                        count("j", 0, COORDINATES, |j| pose.at(j).set(next.at(j)));
                    });
                });
                share.divide(2.0);
            });
        });
        note("Rounding of the joints may be more than that of a chain's reach.");
        residual.le(100.0 * REACH).choose(0, 2 * LEGS + 2)
    }

    /// Whether full revolutions do not change what a joint coordinate does.
    pub fn is_modulo(&self, coordinate: usize) -> bool {
        let joints = self.manipulator.mechanism().joints();
        let mut kinds = joints.flat_map(|joint| joint.coordinates.iter().map(|_| joint.kind));
        let turns = kinds.nth(coordinate).is_some_and(|kind| match kind {
            JointKind::Revolute | JointKind::Universal { .. } | JointKind::Cylindrical => true,
            JointKind::Prismatic | JointKind::Helical { .. } | JointKind::Spherical => false,
        });
        turns && self.manipulator.coordinates()[coordinate].quantity == Quantity::Angle
    }

    /// Declares the numbers of the actuated joints.
    fn driven(&self) -> Array<Int> {
        numbers("driven", self.manipulator.actuated())
    }

    /// Declares the units of the unknowns of a step.
    fn units(&self, g: Any) -> Array<Real> {
        let units: Vec<Real> = match self.steps_in_all() {
            true => self.task.coordinates.iter().map(|c| self.unit(g, c.quantity)).collect(),
            false => {
                let coordinates = self.manipulator.task_coordinates().iter();
                coordinates.map(|c| self.unit(g, c.quantity)).collect()
            }
        };
        Array::named("unit", units)
    }

    /// How far the actuated joints are off.
    fn off(&self) {
        let function = Traced::new(
            "off",
            "How far the actuated joints are from other values: the differences, and the largest one.",
        );
        self.add(function.body(|p| {
            let (g, actuated) = (geometry(p), p.add::<In<[Real]>>("actuated"));
            let (values, off) = (p.add::<In<[Real]>>("values"), p.add::<Out<[Real]>>("off"));
            name!(most = 0.0);
            for (place, &coordinate) in self.manipulator.actuated().iter().enumerate() {
                let place = number(place);
                let difference = actuated.at(place) - values.at(place);
                off.at(place).set(match self.is_modulo(coordinate) {
                    true => near(difference, 0.0),
                    false => difference,
                });
            }
            count("i", 0, ACTUATED, |i| {
                let driven = self.driven();
                let joint: library::Joint = g.list("joint", self.fields.len()).at(driven.at(i));
                most.set(max(most, abs(off.at(i)) / joint.size));
            });
            most
        }));
    }

    /// The equations of a step.
    fn linearise(&self) {
        let all = self.steps_in_all();
        let (lacking, [_, unknowns]) = (self.lacking(), self.equations());
        let function = Traced::new(
            "linearise",
            "The equations of a step: the rates of the actuated joints by what moves the platform, a row for each, and right \
             sides behind them. Lengths are over the size. It returns what NAME_jacobian returns.",
        );
        self.add(function.body(|p| {
            let (g, pose, mode) = of_pose(p);
            let right = p.add::<In<[Real]>>("right");
            let q = all.then(|| p.add::<Out<[Real]>>("q"));
            let a = p.add::<Out<[Real]>>("a");
            let (driven, unit) = (self.driven(), self.units(g));
            let rates = Array::<Real>::empty("rates", self.fields.len() * unknowns);
            let locked = all.then(|| Array::<Real>::empty("locked", lacking * unknowns));
            let name = if self.turns() { "motions" } else { "jacobian" };
            let mut given = given![g, pose, mode].to_vec();
            given.extend(q.map(Any::from));
            given.push(rates.into());
            given.extend(locked.map(Any::from));
            name!(status = self.call(name, &given).is::<Int>());
            return_status(status);
            let (width, unknowns) = (number(unknowns + 1), number(unknowns));
            count("i", 0, ACTUATED, |i| {
                let joint: library::Joint = g.list("joint", self.fields.len()).at(driven.at(i));
                name!(size = joint.size);
                count("j", 0, unknowns, |j| {
                    let rate = rates.at(driven.at(i) * unknowns + j) * unit.at(j) / size;
                    a.at(i * width + j).set(rate);
                });
                a.at(i * width + unknowns).set(right.at(i) / size);
            });
            if let Some(locked) = locked {
                count("i", 0, number(lacking), |i| {
                    let row = (ACTUATED + i) * width;
                    count("j", 0, unknowns, |j| {
                        a.at(row + j).set(locked.at(i * unknowns + j) * unit.at(j));
                    });
                    a.at(row + unknowns).set(0.0);
                });
            }
            done()
        }));
    }

    /// The numbers of the three angles of the orientation among all coordinates.
    fn angles(&self) -> [Int; 3] {
        let first = self.first_angle();
        [0, 1, 2].map(|i| number(first + i))
    }

    /// The orientation of coordinates.
    fn orientation(&self, q: Array<Real>) -> library::Rotation {
        self.orientation_with(self.angles().map(|i| q.at(i)))
    }

    /// The function of the pose after a step, where the orientation is rotated.
    fn stepped(&self) {
        let function = Traced::new(
            "stepped",
            "The pose that a share of a step leads to: the orientation is rotated, and its angles are those nearest to the \
             start's.",
        );
        self.add(function.body(|p| {
            let g = geometry(p);
            let [pose, start, step] =
                ["pose", "start", "step"].map(|name| p.add::<In<[Real]>>(name));
            let (share, next) = (p.add::<Real>("share"), p.add::<Out<[Real]>>("next"));
            let unit = self.units(g);
            count("j", 0, number(self.equations()[1]), |j| {
                next.at(j).set(pose.at(j) + share * unit.at(j) * step.at(j));
            });
            let [x, y, z] = self.angles().map(|i| share * step.at(i));
            name!(turned = rotation_by(vector_of(x, y, z)));
            name!(moved = product(turned, self.orientation(pose)));
            let [x, y, z] = self.angles().map(|i| start.at(i));
            let start = vector_of(x, y, z);
            name!(
                angles = match self.angles_of_pose() {
                    OrientationCoordinates::EulerAngles => euler_near(moved, start),
                    OrientationCoordinates::TiltTorsion => torsion_near(moved, start),
                    OrientationCoordinates::RollPitchYaw => roll_near(moved, start),
                }
            );
            for (place, part) in self.angles().into_iter().zip([angles.x, angles.y, angles.z]) {
                next.at(place).set(part);
            }
        }));
    }

    /// The same where coordinates follow.
    fn stepped_in_all(&self) {
        let [_, unknowns] = self.equations();
        let coordinates = self.manipulator.task_coordinates().len();
        let function = Traced::new(
            "stepped",
            "The pose that a share of a step leads to: the orientation is rotated. Of its two triples of angles, it is that with \
             which the coordinates that follow lead to this orientation. It returns 1 where none does.",
        );
        self.add(function.body(|p| {
            let g = geometry(p);
            let [q, start, step] = ["q", "start", "step"].map(|name| p.add::<In<[Real]>>(name));
            let (share, mode) = (p.add::<Real>("share"), p.add::<Bits>("mode"));
            let next = p.add::<Out<[Real]>>("next");
            let given_of = numbers("given", &self.forms.independent);
            let unit = self.units(g);
            let [moved, completed] =
                ["moved", "completed"].map(|name| Array::<Real>::empty(name, unknowns));
            let tried = Array::<Real>::empty("tried", coordinates);
            let unmet = Array::<Real>::named("unmet", [0.0; 2]);
            name!(least = Real::infinity());
            let [x, y, z] = self.angles().map(|i| share * step.at(i));
            name!(turned = rotation_by(vector_of(x, y, z)));
            name!(rotation = product(turned, self.orientation(q)));
            count("j", 0, number(unknowns), |j| {
                moved.at(j).set(q.at(j) + share * unit.at(j) * step.at(j));
            });
            count("chart", 0, 2, |chart| {
                let [x, y, z] = self.angles().map(|i| start.at(i));
                let start = vector_of(x, y, z);
                name!(
                    angles = match self.angles_of_pose() {
                        OrientationCoordinates::EulerAngles => euler_in(rotation, start, chart),
                        OrientationCoordinates::TiltTorsion => torsion_in(rotation, start, chart),
                        OrientationCoordinates::RollPitchYaw => roll_in(rotation, start, chart),
                    }
                );
                let parts = [angles.x, angles.y, angles.z];
                for (place, part) in self.angles().into_iter().zip(parts) {
                    moved.at(place).set(part);
                }
                count("j", 0, COORDINATES, |j| tried.at(j).set(moved.at(given_of.at(j))));
                let call = self.call("complete", &given![g, tried, mode, completed, unmet]);
                when(call.is::<Int>().is(0), || {
                    name!(off = apart(rotation, self.orientation(completed)));
                    when(off.lt(least), || {
                        least.set(off);
                        count("j", 0, COORDINATES, |j| next.at(j).set(tried.at(j)));
                    });
                });
            });
            (!least.lt(Real::infinity())).int()
        }));
    }
}
