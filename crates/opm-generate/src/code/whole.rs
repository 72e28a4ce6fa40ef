//! Legs that are solved whole: the joints at a pose, and their rates.

use super::interface::Start;
use super::leg::Given;
use super::*;
use crate::library::*;
use crate::trace::closed_forms::Displaced;
use crate::trace::whole::RootsOfCode;
use crate::trace::*;
use crate::tree::{Expr, visit};
use opm_core::chain::whole::{LegJoint, WholeLeg, WholeRun};
use opm_core::manipulator::form::WholeForm;
use opm_core::nalgebra::Vector3;
use opm_core::numbers::{Plane as _, Real as _, Space as _};

/// The unit direction of an axis.
fn axis(place: usize) -> Vector {
    constant(&Vector3::ith(place, 1.0))
}

fn identity() -> Rotation {
    Rotation::made(axis(0), axis(1), axis(2))
}

fn name_of(leg: usize) -> String {
    format!("leg{}_whole", leg + 1)
}

/// The freedoms of a joint, and the form in which each is given.
fn freedoms(joint: &LegJoint) -> (usize, Given) {
    match joint {
        LegJoint::Screw { pitch, .. } if *pitch == 0.0 => (1, Given::Direction),
        LegJoint::Screw { .. } | LegJoint::Slide { .. } => (1, Given::Value),
        LegJoint::Ball { .. } => (3, Given::Value),
        LegJoint::Parallelogram { .. } => (2, Given::Direction),
    }
}

/// Returns a status where a loop is not closed.
pub fn closed_or_return(run: &WholeRun<'_, Real>, missed: Real, status: i32) {
    let open = run.open().named("open");
    when(!open.le(CLOSED * CLOSED), || {
        missed.set(Real::infinity());
        give(status);
    });
}

/// The rotations of the spherical joints of a leg, with the first freedom of each.
pub fn balls(
    run: &WholeRun<'_, Real>,
    joints: &[(usize, LegJoint)],
    body: Body,
) -> Vec<(usize, Rotation)> {
    let is_ball = |&number: &usize| matches!(joints[number].1, LegJoint::Ball { .. });
    let all: Vec<usize> = (0..joints.len()).filter(is_ball).collect();
    let (Some(&one), Some(&last)) = (all.first(), all.last()) else { return Vec::new() };
    let back = |number: usize| match joints[number].1 {
        LegJoint::Screw { axis, .. } => {
            let turn = conjugate(run.turn(number).named("turn"));
            Some(rotation_about(constant(&axis), turn))
        }
        LegJoint::Slide { .. } | LegJoint::Ball { .. } | LegJoint::Parallelogram { .. } => None,
    };
    note("What is left of the rotation for spherical joints.");
    let rest = Rotation::empty("rest");
    rest.set(body.rotation);
    for before in (0..one).filter_map(back) {
        rest.set(product(before, rest));
    }
    for behind in (last + 1..joints.len()).rev().filter_map(back) {
        rest.set(product(rest, behind));
    }
    let mut found = Vec::new();
    if let Some([from, to]) = run.swing() {
        let swung = swing(from.named("from"), to.named("to"));
        let swung = crate::trace::named(&fresh("swung"), swung);
        found.push((joints[one].0, swung));
        rest.set(product(transposed(swung), rest));
        for between in (one + 1..last).filter_map(back) {
            rest.set(product(between, rest));
        }
    }
    found.push((joints[last].0, rest));
    found
}

/// The joints of a leg with the number of the first freedom of each that is not given.
pub fn numbered(leg: &WholeLeg) -> Vec<(usize, LegJoint)> {
    let mut next = 0;
    let joints = leg.joints().into_iter().map(|joint| {
        let first = next;
        next += freedoms(&joint).0;
        (first, joint)
    });
    joints.collect()
}

impl Writer<'_> {
    /// The form in which the displacement of a joint coordinate of a whole leg is given.
    pub fn given_of_whole(&self, coordinate: usize) -> Option<Given> {
        self.forms.legs.iter().filter_map(|leg| leg.whole.as_ref()).find_map(|form| {
            let freedom = coordinate.checked_sub(form.first)?;
            let joints = numbered(&form.leg);
            let (_, joint) = joints
                .iter()
                .find(|(first, joint)| (*first..first + freedoms(joint).0).contains(&freedom))?;
            Some(freedoms(joint).1)
        })
    }

    /// The function of a leg that is solved whole.
    pub fn whole_leg(&self, leg: usize, form: &WholeForm) {
        let name = crate::names::comment(&self.manipulator.mechanism().legs[leg].name);
        let comment = format!(
            "Leg {}, {name}: all its joints, for the displacement of the platform.",
            leg + 1
        );
        let function = Traced::new(&name_of(leg), &comment).body(|p| {
            let body = p.add::<Body>("body");
            let mode = p.add::<Bits>("mode");
            let at = p.of_kind("at", Type::Struct(DISPLACEMENTS.to_owned()), Pass::Write);
            let missed = p.add::<Out<Real>>("missed");
            let mut body = statements(|| self.whole_body(leg, form, (body, mode, at, missed)));
            visit::drop_unread(&mut body);
            body.into_iter().for_each(emit);
            done()
        });
        self.add(function.without_unused(&["body", "mode", "at", "missed"]));
    }

    fn whole_body(
        &self,
        leg: usize,
        form: &WholeForm,
        (body, mode, at, missed): (Body, Bits, Any, Real),
    ) {
        let of_leg = &self.forms.legs[leg];
        let choice = |section: Section| match of_leg.section(section).bit {
            Some(bit) => sign(mode, bit).named("sign"),
            None => Real::from(1.0),
        };
        let signs = [choice(Section::Lower), choice(Section::Upper)];
        let mut roots = RootsOfCode { missed, status: 1, size: form.leg.size() };
        let target = (body.rotation, body.translation);
        let run = form.leg.run::<Real>(target, signs, &mut roots);
        closed_or_return(&run, missed, 1);
        let field = |freedom: usize| &*self.fields[form.first + freedom];
        let joints = numbered(&form.leg);
        for (first, joint) in &joints {
            let count = if matches!(joint, LegJoint::Ball { .. }) { 0 } else { freedoms(joint).0 };
            for freedom in *first..first + count {
                match run.displacement(freedom) {
                    Displaced::Direction(z) => at.member::<Complex>(field(freedom)).set(z),
                    Displaced::Value(value) => at.member::<Real>(field(freedom)).set(value),
                }
            }
        }
        for (first, rotation) in balls(&run, &joints, body) {
            let [x, y, z] = [0, 1, 2].map(|i| at.member::<Real>(field(first + i)));
            let half = self.ball_of(form.first + first).unwrap_or_default();
            let own = crate::trace::named(&fresh("ball"), SphericalS::made(identity()));
            solve_spherical_s(own, rotation, x, y, z, at.member::<Complex>(&half));
        }
    }

    /// Whether legs are solved whole.
    pub fn is_whole(&self) -> bool {
        self.manipulator.is_whole()
    }

    /// Declares and gives the twists of the platform for a unit of each column, and its reference point.
    pub fn platform_motions(&self, g: Any, start: &Start, t: Array<Twists>) -> [Any; 2] {
        let motions = Array::<Motion>::empty("motions", self.task.coordinates.len());
        let point = self.moved_by(g, start, t, |place, turn, velocity| {
            motions.at(place).set(motion_of(turn, velocity));
        });
        [motions.into(), point.into()]
    }

    /// The function of the rates of a leg that is solved whole: linear equations in the rates, which make the platform's twist
    /// about its reference point.
    pub fn whole_rates(&self, leg: usize, form: &WholeForm, first_lacking: usize) -> usize {
        let name = crate::names::comment(&self.manipulator.mechanism().legs[leg].name);
        let comment = format!(
            "Leg {}, {name}: the rates of its joints for motions of the platform, whose reference point is given. It returns 1 \
             where it is singular.",
            leg + 1
        );
        let function = Traced::new(&format!("leg{}_rates", leg + 1), &comment).body(|p| {
            let at = p.of_kind("at", Type::Struct(DISPLACEMENTS.to_owned()), Pass::Read);
            let motions = p.add::<In<[Motion]>>("motions");
            let point = p.add::<Vector>("point");
            let all = p.add::<Out<[Real]>>("all");
            let locked = p.add::<Out<[Real]>>("locked");
            let mut body = statements(|| {
                self.whole_rates_body(form, (at, motions, point, all));
                if self.dependent() {
                    self.locked_rows(form, first_lacking, locked);
                }
            });
            visit::drop_unread(&mut body);
            body.into_iter().for_each(emit);
            done()
        });
        self.add(function.without_unused(&["at", "motions", "point", "all", "locked"]));
        self.lacking_of(form)
    }

    /// How many freedoms a leg lacks.
    pub fn lacking_of(&self, form: &WholeForm) -> usize {
        if self.dependent() { 6_usize.saturating_sub(form.leg.freedoms()) } else { 0 }
    }

    /// Writes what elimination leaves of the equations of a leg that lacks freedoms: it is zero where the platform moves as the leg
    /// lets it.
    fn locked_rows(&self, form: &WholeForm, first: usize, locked: Array<Real>) {
        let (unknowns, sides) = (form.leg.freedoms(), self.task.coordinates.len());
        let kind = Type::Array(Box::new(Type::Real), 0);
        let a = Any::from_expr(Expr::variable("a", kind)).array::<Real>();
        for row in 0..self.lacking_of(form) {
            count("i", 0, number(sides), |i| {
                let left = a.at(number((unknowns + row) * (unknowns + sides) + unknowns) + i);
                locked.at(number((first + row) * sides) + i).set(left);
            });
        }
    }

    fn whole_rates_body(
        &self,
        form: &WholeForm,
        (at, motions, point, all): (Any, Array<Motion>, Vector, Array<Real>),
    ) {
        let (joints, size) = (numbered(&form.leg), form.leg.size());
        let unknowns = form.leg.freedoms();
        let sides = self.task.coordinates.len();
        let idle = form.leg.idle();
        let hinges: Vec<usize> = (joints.iter())
            .filter(|(_, joint)| matches!(joint, LegJoint::Parallelogram { .. }))
            .map(|(first, _)| *first)
            .collect();
        let relations = usize::from(idle.is_some()) + hinges.len();
        let (rows, width) = (6 + relations, unknowns + sides);
        let a = Array::<Real>::empty("a", rows * width);
        let x = Array::<Real>::empty("x", unknowns * sides);
        name!(turned = identity(), moved = vector_of(0.0, 0.0, 0.0));
        let column = |column: usize, turn: Vector, velocity: Vector| {
            let parts = [turn.x, turn.y, turn.z, velocity.x, velocity.y, velocity.z];
            for (row, part) in parts.into_iter().enumerate() {
                a.at(number(row * width + column)).set(part);
            }
        };
        let zero = || vector_of(0.0, 0.0, 0.0);
        let rotates = |first: usize, axis: Vector, at_point: &Vector3<f64>, pitch: f64| {
            block(|| {
                name!(axis = rotated(turned, axis));
                name!(
                    arm = add(add(point, -1.0, moved), -1.0, rotated(turned, constant(at_point)))
                );
                name!(velocity = add(cross(axis, arm), pitch, axis));
                name!(share = add(zero(), 1.0 / size, velocity));
                column(first, axis, share);
            });
        };
        // A rotation about a point of the leg at home, behind what is known; where it matters for places, too.
        let follows = |rotation: Rotation, about: &Vector3<f64>, places: bool| {
            if places {
                let about = constant(about);
                moved.set(add(
                    moved,
                    1.0,
                    rotated(turned, add(about, -1.0, rotated(rotation, about))),
                ));
            }
            turned.set(product(turned, rotation));
        };
        let field = |freedom: usize| &*self.fields[form.first + freedom];
        let mut ball_rows: Vec<(usize, Screws)> = Vec::new();
        for (place, (first, joint)) in joints.iter().enumerate() {
            let is_last = place + 1 == joints.len();
            // Sliders have no place.
            let places = joints[place + 1..]
                .iter()
                .any(|(_, joint)| !matches!(joint, LegJoint::Slide { .. }));
            match joint {
                LegJoint::Slide { axis } => {
                    let slid = crate::trace::named(&fresh("slid"), rotated(turned, constant(axis)));
                    column(*first, zero().named("still"), slid);
                    if places {
                        moved.set(add(moved, at.member::<Real>(field(*first)), slid));
                    }
                }
                LegJoint::Screw { axis, point: about, pitch } => {
                    rotates(*first, constant(axis), &about.coords, *pitch);
                    let turn = match *pitch == 0.0 {
                        true => normal(at.member::<Complex>(field(*first))),
                        false => unit(at.member::<Real>(field(*first))),
                    };
                    if !is_last {
                        let by =
                            crate::trace::named(&fresh("by"), rotation_about(constant(axis), turn));
                        if *pitch != 0.0 && places {
                            let advance = at.member::<Real>(field(*first)) * *pitch;
                            moved.set(add(moved, advance, rotated(turned, constant(axis))));
                        }
                        follows(by, &about.coords, places);
                    }
                }
                // Between its hinges, the bar turns.
                LegJoint::Parallelogram { axis, point: about, arm } => {
                    rotates(*first, constant(axis), &about.coords, 0.0);
                    let turn = normal(at.member::<Complex>(field(*first)));
                    let by =
                        crate::trace::named(&fresh("by"), rotation_about(constant(axis), turn));
                    let bar = constant(arm);
                    let swung = crate::trace::named(
                        &fresh("swung"),
                        rotated(turned, add(rotated(by, bar), -1.0, bar)),
                    );
                    moved.set(add(moved, 1.0, swung));
                    rotates(first + 1, constant(axis), &(about.coords + arm), 0.0);
                }
                LegJoint::Ball { point: centre } => {
                    for i in 0..3 {
                        rotates(first + i, axis(i), &centre.coords, 0.0);
                    }
                    let parts = [0, 1, 2].map(|i| at.member::<Real>(field(first + i)));
                    let half = self.ball_of(form.first + first).unwrap_or_default();
                    let along = vector_of(parts[0], parts[1], parts[2]);
                    let vector = rotation_vector(along, at.member::<Complex>(&half));
                    let vector = crate::trace::named(&fresh("vector"), vector);
                    let screws = Screws::empty(&fresh("ball"));
                    let axes = crate::trace::named(&fresh("axes"), identity());
                    rotation_vector_rates(axes, vector, screws);
                    ball_rows.push((*first, screws));
                    if !is_last {
                        let by = crate::trace::named(&fresh("by"), rotation_by(vector));
                        follows(by, &centre.coords, places);
                    }
                }
            }
        }
        if let (Some((first, along)), Some((_, screws))) = (idle, ball_rows.first()) {
            note("The first spherical joint does not spin.");
            for column in 0..width {
                a.at(number(6 * width + column)).set(0.0);
            }
            let [x, y, z] = [screws.s1, screws.s2, screws.s3];
            let spin = add(add(add(zero(), along.x, x), along.y, y), along.z, z);
            let spin = spin.named("spin");
            for (i, part) in [spin.x, spin.y, spin.z].into_iter().enumerate() {
                a.at(number(6 * width + first + i)).set(part);
            }
        }
        for (row, first) in (6 + usize::from(idle.is_some())..).zip(&hinges) {
            note("The second hinge of a parallelogram turns back.");
            for column in 0..width {
                a.at(number(row * width + column)).set(0.0);
            }
            for hinge in [*first, first + 1] {
                a.at(number(row * width + hinge)).set(1.0);
            }
        }
        count("i", 0, number(sides), |i| {
            let Motion { turn, velocity, .. } = motions.at(i);
            let parts = [turn.x, turn.y, turn.z];
            for (row, part) in parts.into_iter().enumerate() {
                a.at(number(row * width + unknowns) + i).set(part);
            }
            for (row, part) in (3..).zip([velocity.x, velocity.y, velocity.z]) {
                a.at(number(row * width + unknowns) + i).set(part / size);
            }
        });
        let [rows, of_unknowns, of_sides] = [rows, unknowns, sides].map(number);
        when(eliminate(a, rows, of_unknowns, of_sides, x).is_set(), || give(1));
        count("i", 0, of_sides, |i| {
            for (first, joint) in &joints {
                let rate = |freedom: usize| x.at(number(freedom * sides) + i);
                let write = |freedom: usize, rate: Real| {
                    all.at(number((form.first + freedom) * sides) + i).set(rate);
                };
                match joint {
                    LegJoint::Slide { .. } => write(*first, rate(*first) * size),
                    LegJoint::Screw { .. } => write(*first, rate(*first)),
                    LegJoint::Parallelogram { .. } => {
                        for hinge in [*first, first + 1] {
                            write(hinge, rate(hinge));
                        }
                    }
                    LegJoint::Ball { .. } => {
                        let Some((_, rows)) = ball_rows.iter().find(|(of, _)| of == first) else {
                            continue;
                        };
                        block(|| {
                            name!(w = vector_of(rate(*first), rate(first + 1), rate(first + 2)));
                            for (k, row) in [rows.s1, rows.s2, rows.s3].into_iter().enumerate() {
                                write(first + k, dot(row, w));
                            }
                        });
                    }
                }
            }
        });
    }
}
