//! The functions of the interface.

use super::displacement::displacement_type;
use super::leg::{Given, ball};
use super::*;
use crate::library::*;
use crate::trace::*;
use opm_core::group::SubspaceKind;

/// Both sections.
pub const SECTIONS: [Section; 2] = [Section::Lower, Section::Upper];

/// Which of the displacements and of the height a function needs.
#[derive(Clone, Copy, Default)]
pub struct Needs {
    pub moved: [bool; 2],
    pub rise: bool,
    /// The displacement of the platform.
    pub body: bool,
}

/// What most functions of a pose begin with.
pub struct Start {
    /// The coordinates, with those that follow.
    pub q: Array<Real>,
    pub status: Int,
    /// What the functions of a leg may need, by name.
    pub known: Vec<(&'static str, Any)>,
}

impl Start {
    /// What has a name.
    pub fn get(&self, name: &str) -> Option<Any> {
        self.known.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
    }
}

/// A joint whose value is asked for: where it is written, and its number.
type Target = (Real, usize);

impl Writer<'_> {
    /// The functions of the interface, and what they share.
    pub fn interface(&self) {
        self.close();
        self.inverse();
        self.actuated();
        self.nearest();
        self.deficits();
        limits(self);
        self.transform();
        self.rates();
        self.twist();
        self.forward();
    }

    /// Whether coordinates follow from those of a pose.
    pub fn dependent(&self) -> bool {
        !self.forms.steps.is_empty() || self.forms.whole.is_some()
    }

    /// The height above home at the coordinates `q`.
    pub fn rise(&self, g: Any, q: Array<Real>) -> Real {
        let height = self.forms.height;
        height.map_or_else(|| Real::from(0.0), |height| self.off_home(g, q, height.coordinate))
    }

    /// Declares, and then gives, what is needed of a pose after its check. Where coordinates follow, `complete` gets the
    /// status, the call that completes the pose, and the deficits of a leg whose constraint is not satisfied; they are
    /// written to `q`, or to a variable.
    pub fn start(
        &self,
        (g, pose, mode): (Any, Array<Real>, Bits),
        needs: Needs,
        q: Option<Array<Real>>,
        complete: impl FnOnce(Int, Int, Array<Real>),
    ) -> Start {
        let completed = self.dependent().then(|| {
            let unmet = Array::named("unmet", [0.0; 2]);
            let q = q.unwrap_or_else(|| Array::empty("q", self.task.coordinates.len()));
            (q, unmet)
        });
        let mut known = vec![("g", g), ("mode", mode.into())];
        let mut moved = Vec::new();
        for section in SECTIONS {
            if let (true, Some(kind)) =
                (needs.moved[section as usize], displacement_type(self.kind(section)))
            {
                let of_section = Any::variable(symbol(section), &kind, None);
                moved.push((section, of_section));
                known.push((symbol(section), of_section));
            }
        }
        let rise = needs.rise.then(|| Real::empty("rise"));
        known.extend(rise.map(|rise| ("rise", rise.into())));
        let body = needs.body.then(|| Body::empty("body"));
        known.extend(body.map(|body| ("body", body.into())));
        name!(status = check(pose));
        return_status(status);
        let mut q = pose;
        if let Some((all, unmet)) = completed {
            q = all;
            complete(status, self.call("complete", &given![g, pose, mode, q, unmet]).is(), unmet);
        }
        for (section, of_section) in moved {
            of_section.set(self.displaced(section, g, q));
        }
        if let Some(rise) = rise {
            rise.set(self.rise(g, q));
        }
        let start = Start { q, status, known };
        if let Some(body) = body {
            self.give_body(g, &start, body);
        }
        start
    }

    /// The same where what cannot be completed is returned.
    pub fn start_or_return(
        &self,
        of_pose: (Any, Array<Real>, Bits),
        needs: Needs,
        q: Option<Array<Real>>,
    ) -> Start {
        self.start(of_pose, needs, q, |status, call, _| {
            status.set(call);
            return_status(status);
        })
    }

    /// Whether a function of a leg has a parameter.
    pub fn leg_takes(&self, leg: usize, parameter: &str) -> bool {
        let takes = |(name, _): &(String, bool)| self.find(name, |one| one.takes(parameter));
        self.leg_functions(leg).iter().any(|function| takes(function) == Some(true))
    }

    fn legs_take(&self, parameter: &str) -> bool {
        (0..self.forms.legs.len()).any(|leg| self.leg_takes(leg, parameter))
    }

    /// What the functions of all legs need.
    pub fn needs_of_legs(&self) -> Needs {
        if self.legs_take("body") {
            return Needs { body: true, ..self.needs_of_platform() };
        }
        let moved = ["v", "b"].map(|name| self.legs_take(name));
        Needs { moved, rise: self.legs_take("rise"), body: false }
    }

    /// The calls of the functions of a leg.
    pub fn leg_calls(&self, leg: usize, known: &[(&str, Any)]) -> Vec<Any> {
        self.leg_functions(leg).iter().map(|(name, _)| self.call_with(name, known)).collect()
    }

    /// The function that solves all legs.
    fn close(&self) {
        let function = Traced::new(
            "close",
            "The displacements of all joints at a pose in a mode, and what NAME_inverse returns.",
        );
        self.add(function.body(|p| {
            let of_pose = of_pose(p);
            let at = p.of_kind("at", Type::Struct(DISPLACEMENTS.to_owned()), Pass::Write);
            let mut own = vec![("at", at)];
            if self.legs_take("missed") {
                own.push(("missed", named("missed", 0.0).into()));
            }
            if self.legs_take("near") {
                own.push(("near", named("near", 0.0).into()));
            }
            let start = self.start_or_return(of_pose, self.needs_of_legs(), None);
            let known = [start.known, own].concat();
            for leg in 0..self.forms.legs.len() {
                if let Some(fails) = any_fails(&self.leg_calls(leg, &known)) {
                    when(fails, || give(number(leg + 1)));
                }
            }
            start.status
        }));
    }

    /// Writes the values of joints from the displacements at a pose, and those of the imaginary joints. All angles are
    /// computed in one loop, which compilers turn into vectors.
    fn values(
        &self,
        (g, pose, mode): (Any, Array<Real>, Bits),
        joints: &[Target],
        imaginary: Option<Array<Real>>,
    ) -> Int {
        let at = displacements("at");
        // The directions whose angles are needed.
        let mut directions = Vec::new();
        for &(_, coordinate) in joints {
            directions.extend(match (self.given(coordinate), self.ball_of(coordinate)) {
                (_, Some(half)) => Some(half),
                (Given::Value, _) => None,
                (Given::Direction | Given::Turns, _) => Some(self.fields[coordinate].clone()),
            });
        }
        for (number, leg) in self.forms.legs.iter().enumerate() {
            let reported = imaginary.is_some() && leg.imaginary.is_some();
            if reported && self.tau(leg) == Some(Given::Direction) {
                directions.push(format!("tau_{}", number + 1));
            }
        }
        let mut unique: Vec<String> = Vec::new();
        directions.retain(|field| {
            let new = !unique.contains(field);
            unique.extend(new.then(|| field.clone()));
            new
        });
        // Whole vectors of the shortest kind: no angle is left over.
        let count_of = directions.len().next_multiple_of(2);
        let arrays = (count_of > 0)
            .then(|| ["re", "im", "angle"].map(|name| Array::<Real>::empty(name, count_of)));
        name!(status = self.call("close", &given![g, pose, mode, at]).is::<Int>());
        return_status(status);
        if let Some([re, im, angle]) = arrays {
            for place in 0..count_of {
                let field = directions.get(place).map(|field| at.member::<Complex>(field));
                let [x, y] = field.map_or([1.0.into(), 0.0.into()], |z| [z.re, z.im]);
                re.at(number(place)).set(x);
                im.at(number(place)).set(y);
            }
            count("i", 0, number(count_of), |i| angle.at(i).set(atan2(im.at(i), re.at(i))));
        }
        let angle = |field: &str| {
            let place = directions.iter().position(|known| known == field).unwrap_or_default();
            arrays.map_or(Real::from(0.0), |[.., angle]| angle.at(number(place)))
        };
        for &(target, coordinate) in joints {
            let (joint, field) = (self.joint(g, coordinate), &self.fields[coordinate]);
            target.set(match (self.given(coordinate), self.ball_of(coordinate)) {
                (_, Some(half)) => {
                    let sine = at.member::<Complex>(&half).im;
                    joint.home + at.member::<Real>(field) * turned(angle(&half), sine)
                }
                (Given::Value, _) => joint.home + at.member::<Real>(field),
                (Given::Direction | Given::Turns, _) => reported(joint, angle(field)),
            });
        }
        for leg in (0..self.forms.legs.len()).filter(|_| imaginary.is_some()) {
            if let (Some((place, value)), Some(imaginary)) =
                (self.imaginary_value(leg, g, at, angle), imaginary)
            {
                imaginary.at(number(place)).set(value);
            }
        }
        done()
    }

    /// The value of an imaginary joint from the displacement of its leg along the intersection motion.
    pub fn imaginary_value(
        &self,
        leg: usize,
        g: Any,
        at: Any,
        angle: impl Fn(&str) -> Real,
    ) -> Option<(usize, Real)> {
        let form = &self.forms.legs[leg];
        let (imaginary, tau) = (form.imaginary?, self.tau(form)?);
        let all = self.manipulator.imaginary();
        let joint = &all[imaginary];
        let field = format!("tau_{}", leg + 1);
        let value = if tau == Given::Direction { angle(&field) } else { at.member(&field) };
        let home: Real = g.list("imaginary", all.len()).at(number(imaginary));
        let along = joint.displacement(joint.home + 1.0) > 0.0;
        Some((imaginary, if along { home + value } else { home - value }))
    }

    fn inverse(&self) {
        let m = self.manipulator;
        let signs = m.format_mode(m.home_mode());
        let signs = match signs.is_empty() {
            true => "There is one mode, 0.".to_owned(),
            false => format!("At home it is {}: {signs}.", m.home_mode().bits()),
        };
        let function = Traced::new(
            "inverse",
            &format!(
                "Every joint at a pose in a working mode. Bit i of the mode, the lowest first, is set where sign i of opm's \
                 text is a minus. {signs} Angles are within half a revolution of home, or within their limits where full \
                 revolutions bring them there; limits are not tested. It returns 0; or the number of the first leg, from 1, \
                 that the pose is out of reach of; or -i where coordinate i of the pose, from 1, is no number or far too \
                 large. Unless it returns 0, nothing is written."
            ),
        );
        self.add(function.public().body(|p| {
            let of_pose = of_pose(p);
            let joints = p.add::<Out<[Real]>>("joints");
            let imaginary = p.add::<Out<[Real]>>("imaginary");
            let all: Vec<Target> =
                (0..self.fields.len()).map(|i| (joints.at(number(i)), i)).collect();
            self.values(of_pose, &all, Some(imaginary))
        }));
    }

    fn actuated(&self) {
        let function = Traced::new("actuated", "The actuated joints alone, in the same way.");
        self.add(function.public().body(|p| {
            let of_pose = of_pose(p);
            let actuated = p.add::<Out<[Real]>>("actuated");
            let own = self.manipulator.actuated().iter().enumerate();
            let all: Vec<Target> = own.map(|(place, &i)| (actuated.at(number(place)), i)).collect();
            self.values(of_pose, &all, None)
        }));
    }

    /// The function of the reach deficits.
    fn deficits(&self) {
        let function = Traced::new(
            "deficits",
            "By how much the pose is out of reach: of leg i, from 0, deficits[2 * i] of the lower section and \
             deficits[2 * i + 1] of the upper one, in metres, or radians where the section is spherical; zero where it closes, \
             infinite where it is not known. A section that follows another one out of reach counts as closed. It returns what \
             NAME_inverse returns.",
        );
        self.add(function.public().body(|p| {
            let of_pose = of_pose(p);
            let deficits = written(p, "deficits", 2 * self.forms.legs.len());
            let at = displacements("at");
            let mut own = vec![("at", at)];
            if self.legs_take("near") {
                own.push(("near", named("near", 0.0).into()));
            }
            let clear = || count("i", 0, 2 * LEGS, |i| deficits.at(i).set(0.0));
            let start = self.start(of_pose, self.needs_of_legs(), None, |status, call, unmet| {
                clear();
                status.set(call);
                when(status.gt(0), || {
                    let place = 2 * (status - 1);
                    deficits.at(place).set(unmet.at(0));
                    deficits.at(place + 1).set(unmet.at(1));
                });
                return_status(status);
            });
            if !self.dependent() {
                clear();
            }
            let status = start.status;
            for leg in 0..self.forms.legs.len() {
                let first = self.forms.legs[leg].first;
                let call = |(name, is_first): &(String, bool)| {
                    let section = if *is_first { first } else { super::leg::other(first) };
                    let missed = deficits.at(number(2 * leg + section as usize));
                    let missed = [("missed", Any::from(missed))];
                    self.call_with(name, &[&start.known, &own[..], &missed].concat())
                };
                let calls: Vec<Any> = self.leg_functions(leg).iter().map(call).collect();
                if let Some(fails) = any_fails(&calls) {
                    when(fails & status.is(0), || status.set(number(leg + 1)));
                }
            }
            status
        }));
    }

    /// The displacement of a section in base coordinates.
    pub fn body_of(&self, section: Section, g: Any, moved: Any) -> Body {
        let zero = || vector_of(0.0, 0.0, 0.0);
        let identity = || about_third(complex_of(1.0, 0.0));
        let (rotation, translation) = match self.kind(section) {
            SubspaceKind::Identity => (identity(), zero()),
            SubspaceKind::Planar => {
                let Planar { rotation, translation, .. } = moved.is();
                (about_third(rotation), vector_of(translation.re, translation.im, 0.0))
            }
            SubspaceKind::Spherical => (moved.is(), zero()),
            SubspaceKind::Cylindrical => {
                let Cylindrical { angle, advance, .. } = moved.is();
                (about_third(unit(angle)), vector_of(0.0, 0.0, advance))
            }
            SubspaceKind::TranslationalPlane => {
                let Complex { re, im, .. } = moved.is();
                (identity(), vector_of(re, im, 0.0))
            }
            SubspaceKind::TranslationalSpace => (identity(), moved.is()),
        };
        body_of(self.frame(section, g), rotation, translation)
    }

    /// The frame of a section.
    pub fn frame(&self, section: Section, g: Any) -> Frame {
        g.member(&format!("{}_frame", word(section)))
    }

    /// What a function of the platform's place needs.
    pub fn needs_of_platform(&self) -> Needs {
        let upper = self.kind(Section::Upper) != SubspaceKind::Identity;
        Needs { moved: [true, upper], rise: self.forms.height.is_some(), body: false }
    }

    /// Gives the displacement of the platform.
    fn give_body(&self, g: Any, start: &Start, body: Body) {
        self.give_product(g, [start.get("v"), start.get("b")], body);
        if let (Some(height), Some(rise)) = (self.forms.height, start.get("rise")) {
            let up = self.frame(height.section, g).axes.z;
            let up = match height.section {
                Section::Lower => up,
                Section::Upper => rotated(body.rotation, up),
            };
            body.translation.set(add(body.translation, rise.is::<Real>(), up));
        }
    }

    /// Gives the product of the displacements of the two sections, in base coordinates.
    pub fn give_product(&self, g: Any, [v, b]: [Option<Any>; 2], body: Body) {
        if let Some(v) = v {
            body.set(self.body_of(Section::Lower, g, v));
        }
        if let Some(b) = b {
            body.set(body_product(body, self.body_of(Section::Upper, g, b)));
        }
    }

    /// The function of the platform's pose.
    fn transform(&self) {
        let function = Traced::new(
            "transform",
            "The position of the platform's reference point and the platform's orientation in base coordinates: a rotation \
             matrix, row by row. They depend on the mode only where coordinates follow from those of the pose. It returns what \
             NAME_inverse returns, but tests no leg.",
        );
        self.add(function.public().body(|p| {
            let of_pose = of_pose(p);
            let g = of_pose.0;
            let [position, rotation] =
                [("position", 3), ("rotation", 9)].map(|(name, count)| written(p, name, count));
            let body = Body::empty("body");
            let (r, at) = (Rotation::empty("r"), Vector::empty("p"));
            let start = self.start_or_return(of_pose, self.needs_of_platform(), None);
            self.give_body(g, &start, body);
            let platform: Vector = g.member("platform");
            at.set(add(body.translation, 1.0, rotated(body.rotation, platform)));
            r.set(match self.forms.home_orientation_inverse {
                Some(_) => product(body.rotation, g.member::<Rotation>("orientation")),
                None => body.rotation,
            });
            let rows = [at.x, at.y, at.z].into_iter().zip([0, 1, 2]);
            for (part, place) in rows {
                position.at(place).set(part);
                for (column, of_column) in [r.x, r.y, r.z].into_iter().enumerate() {
                    let row = [of_column.x, of_column.y, of_column.z];
                    let entry = 3 * place + i32::try_from(column).unwrap_or_default();
                    rotation.at(entry).set(row[usize::try_from(place).unwrap_or_default()]);
                }
            }
            done()
        }));
    }

    /// The member that has half the angle of a spherical joint, and its axis.
    pub fn ball_at(&self, at: Any, leg: usize, section: Section) -> (Vector, Complex) {
        let coordinates = self.forms.legs[leg].section(section).coordinates;
        let parts = coordinates.map(|coordinate| {
            at.member::<Real>(coordinate.map_or("", |coordinate| &self.fields[coordinate]))
        });
        (vector_of(parts[0], parts[1], parts[2]), at.member(&ball(leg, section)))
    }
}

impl Writer<'_> {
    /// Returns where a joint leaves its cone: the cosine of its tilt is too small.
    fn cones(&self, g: Any, joints: Array<Real>) {
        let mut next = 0;
        for leg in &self.manipulator.mechanism().legs {
            let firsts: Vec<usize> = leg
                .joints
                .iter()
                .map(|joint| {
                    let first = next;
                    next += joint.coordinates.len();
                    first
                })
                .collect();
            for cone in leg.cones() {
                let first = firsts[cone.joint];
                let off = |i: usize| joints.at(number(first + i)) - self.joint(g, first + i).home;
                block(|| {
                    name!(rod = constant(&cone.behind()));
                    match cone.axes() {
                        Some([one, two]) => {
                            rod.set(rotated_about(constant(&two), unit(off(1)), rod));
                            rod.set(rotated_about(constant(&one), unit(off(0)), rod));
                        }
                        None => {
                            name!(vector = vector_of(off(0), off(1), off(2)));
                            rod.set(rotated(rotation_by(vector), rod));
                        }
                    }
                    name!(cosine = dot(constant(&cone.before()), rod));
                    name!(aside = cross(constant(&cone.before()), rod));
                    name!(tilt = atan2(sqrt(dot(aside, aside)), cosine));
                    when(!tilt.le(cone.half_angle + REACH), || give(number(first + 1)));
                });
            }
        }
    }
}

impl Writer<'_> {
    /// Returns where the difference of two joints is beyond its limits.
    fn differences(&self, joints: Array<Real>) {
        for difference in self.manipulator.differences() {
            let [one, other] = difference.coordinates;
            let ([low, high], slack) = (difference.limits, difference.slack());
            let mut apart = joints.at(number(one)) - joints.at(number(other));
            if difference.turns {
                apart = near(apart, Real::from(0.5 * (low + high)));
            }
            let apart = named("apart", apart);
            let inside = apart.ge(low - slack) & apart.le(high + slack);
            block(|| {
                when(!inside, || give(number(one + 1)));
            });
        }
    }
}

/// The function of the limits.
fn limits(writer: &Writer<'_>) {
    let function = Traced::new(
        "limits",
        if !writer.manipulator.differences().is_empty() {
            "0 where all joints are within their limits and their cones, and differences within theirs; otherwise the number of the \
             first coordinate, from 1, that is not, of a joint that leaves its cone, or of the first joint of a difference."
        } else if writer.manipulator.has_cones() {
            "0 where all joints are within their limits and their cones; otherwise the number of the first coordinate, from 1, \
             that is not, or of a joint that leaves its cone."
        } else {
            "0 where all joints are within their limits; otherwise the number of the first one, from 1, that is not."
        },
    );
    writer.add(function.public().body(|p| {
        let (g, joints) = (geometry(p), p.add::<In<[Real]>>("joints"));
        count("i", 0, JOINTS, |i| {
            name!(joint = g.list::<Joint>("joint", writer.fields.len()).at(i));
            let slack = named("slack", slack(joint));
            let value = joints.at(i);
            when(!(value.ge(joint.low - slack) & value.le(joint.high + slack)), || give(i + 1));
        });
        writer.cones(g, joints);
        writer.differences(joints);
        done()
    }));
}
