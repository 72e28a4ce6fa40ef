//! The function of the inverse dynamics.
//!
//! The virtual power of `opm-analysis`, with the motions of the platform as virtual ones: the rates of a leg's joints follow from
//! the platform's twist by the leg's screws, `S q' = V`, and their accelerations from `S q'' + [V_before, s] q' = A`. What the
//! bodies of a leg resist is summed from the platform to the base, so that each joint has one force along its screw; what these do
//! for a unit of each motion is balanced by the actuators.
//!
//! Motions are the coordinates of a pose. In the place of Euler angles, which have singular poses, are the rotations about the
//! directions of the section's frame ([`Columns::Motions`]). Where coordinates follow, the legs have equations that are left over:
//! they give the motions that follow, and their accelerations. Where some of the angles follow and others do not, the angles are motions.

mod forces;
mod motion;
mod tables;

use super::interface::{Needs, Start};
use super::rates::Columns;
use super::rates::follow::numbers as listed;
use super::*;
use crate::library::*;
use crate::trace::*;
use opm_core::mechanism::OrientationCoordinates;
use std::ops::Range;
use tables::Tables;

pub use tables::refused;

/// The equations of a leg: the rows of a twist.
const ROWS: i32 = 6;

/// The rates of coordinates, or their accelerations, and what they are of all motions.
#[derive(Clone, Copy)]
struct Given {
    of_pose: Array<Real>,
    of_motions: Array<Real>,
}

/// What is computed for a motion at a pose, about the reference point.
#[derive(Clone, Copy)]
struct Moving {
    g: Any,
    point: Vector,
    gravity: Vector,
    /// Of each joint coordinate: its screw, and the displacement of what is behind it.
    screws: Array<Screw>,
    after: Array<Body>,
    /// Of what is behind it: the twist, and its rate.
    twists: Array<Screw>,
    changes: Array<Screw>,
    /// Of each joint coordinate: its rate and its acceleration, and its rates by the motions.
    rates: Array<Real>,
    accelerations: Array<Real>,
    by_motions: Array<Real>,
    /// The screws of the motions.
    motions: Array<Screw>,
    /// The equations of a leg, and what solves them.
    equations: Array<Real>,
    solved: Array<Real>,
}

/// What there is besides where coordinates follow.
#[derive(Clone, Copy)]
struct Follow {
    /// What the equations of all legs leave over for each motion, and for the accelerations.
    left: Array<Real>,
    missing: Array<Real>,
    /// The rates of the motions that follow by those that are given.
    rates: Array<Real>,
}

fn still() -> Screw {
    screw_of(vector_of(0.0, 0.0, 0.0), vector_of(0.0, 0.0, 0.0))
}

impl Writer<'_> {
    /// The functions of the inverse dynamics.
    pub fn dynamics(&self) {
        let tables = Tables::of(self);
        self.displaced_joints(&tables);
        self.leg_equations(&tables);
        let function = Traced::new(
            "inverse_dynamics",
            "The efforts of the actuated joints, N m and N, for given rates and accelerations of the coordinates of the pose: what \
             moves the bodies of the geometry against their inertia and weight, the rotors, and friction. An effort is positive \
             where the actuator pushes its joint towards larger values; a joint at rest has no friction. It returns what \
             NAME_jacobian returns; 2 * NAME_LEGS + 1 also where the actuators do not hold the platform; -NAME_COORDINATES - i where \
             rate i, from 1, is no number; or -2 * NAME_COORDINATES - i where acceleration i is none.",
        );
        self.add(function.public().body(|p| self.inverse_dynamics(p, &tables)));
    }

    fn inverse_dynamics(&self, p: &mut Parameters, tables: &Tables) -> Int {
        let (g, pose, mode) = of_pose(p);
        let [first, second] = ["rates", "accelerations"].map(|name| p.add::<In<[Real]>>(name));
        let efforts = p.add::<Out<[Real]>>("efforts");
        let (joints, motions) = (self.fields.len(), self.task.coordinates.len());
        let real = |name: &str, length: usize| Array::<Real>::empty(name, length);
        let screws = |name: &str, length: usize| Array::<Screw>::empty(name, length);
        let values = real("values", joints);
        let imaginary = real("imaginary", self.manipulator.imaginary().len().max(1));
        let t = Array::<Twists>::empty("t", motions);
        let motion_screws = screws("motions", motions);
        let needs = Needs { body: true, ..self.needs_of_platform() };
        let start = self.start_or_return((g, pose, mode), needs, None);
        let status = start.status;
        for (given, before) in [(first, Int::from(0)), (second, COORDINATES)] {
            status.set(numbers(given, COORDINATES));
            when(status.is_set(), || give(status - before));
        }
        status.set(self.call("inverse", &given![g, pose, mode, values, imaginary]).is::<Int>());
        return_status(status);
        self.columns(self.motion_columns(), g, start.q, t);
        let point = self.moved_by(g, &start, t, |i, w, velocity| {
            motion_screws.at(i).set(screw_of(w, velocity));
        });
        let moving = Moving {
            g,
            point,
            gravity: g.member("gravity"),
            screws: screws("screws", joints),
            after: Array::empty("after", joints),
            twists: screws("twists", joints),
            changes: screws("changes", joints),
            rates: real("joint_rates", joints),
            accelerations: real("joint_accelerations", joints),
            by_motions: real("by_motions", joints * motions),
            motions: motion_screws,
            equations: real("equations", 6 * (tables.most() + motions)),
            solved: real("solved", tables.most() * motions),
        };
        self.call("displaced_joints", &given![g, values, point, moving.screws, moving.after]);
        let given = [("motion_rates", first), ("motion_accelerations", second)]
            .map(|(name, of)| Given { of_pose: of, of_motions: real(name, motions) });
        self.motions_given(start.q, given);
        let follow = self.dependent().then(|| Follow {
            left: real("left_over", 6 * tables.legs() * motions),
            missing: real("missing", 6 * tables.legs()),
            rates: real("follow", self.follow_rates()),
        });
        self.rates_by_motions(&moving, tables, follow);
        if let Some(follow) = follow {
            self.eliminated(g, 6 * tables.legs(), follow.left, follow.rates);
            self.follow_given(given, follow);
        }
        let of_motions = given.map(|one| one.of_motions);
        let (twist, change) = self.platform_moves(&moving, of_motions);
        self.joints_accelerate(&moving, tables, change, of_motions, follow);
        let works = real("works", motions);
        self.platform_resists(&moving, &start, (twist, change), works);
        self.legs_resist(&moving, tables, works);
        self.balanced(&moving, works, follow, efforts);
        done()
    }

    /// The function of the screws of all joints, and of what they displace.
    fn displaced_joints(&self, tables: &Tables) {
        let comment = "The screws of all joints at their values, about a point, and the displacements of what is behind each: \
                       a leg's joints displace each other from the base on.";
        self.add(Traced::new("displaced_joints", comment).body(|p| {
            let (g, values) = (geometry(p), p.add::<In<[Real]>>("values"));
            let point = p.add::<Vector>("point");
            let (screws, after) = (p.add::<Out<[Screw]>>("screws"), p.add::<Out<[Body]>>("after"));
            let home = g.list::<Screw>("screw", self.fields.len());
            let off =
                |i: Int| values.at(i) - g.list::<Joint>("joint", self.fields.len()).at(i).home;
            let first = tables.first();
            let balls = tables.balls();
            count("leg", 0, LEGS, |leg| {
                let none = || vector_of(0.0, 0.0, 0.0);
                name!(moved = Body::made(about_third(complex_of(1.0, 0.0)), none()));
                count("i", first.at(leg), first.at(leg + 1), |i| {
                    screws.at(i).set(displaced_screw(moved, home.at(i), point));
                    let alone = || {
                        moved.set(body_product(moved, screw_motion(home.at(i), off(i))));
                    };
                    match balls {
                        None => alone(),
                        Some(balls) => {
                            when(balls.at(i).is(0), alone);
                            note("The three values of a ball are one rotation vector.");
                            when(balls.at(i).is(3), || {
                                name!(
                                    turned = rotation_by(vector_of(off(i - 2), off(i - 1), off(i)))
                                );
                                let (x, y) = (home.at(i - 2).linear, home.at(i - 1).linear);
                                name!(centre = vector_of(y.z, -x.z, x.y));
                                name!(fixed = add(centre, -1.0, rotated(turned, centre)));
                                name!(ball = Body::made(turned, fixed));
                                moved.set(body_product(moved, ball));
                            });
                        }
                    }
                    after.at(i).set(moved);
                });
            });
        }));
    }

    /// The function of the equations of a leg, whose right sides are zero.
    fn leg_equations(&self, tables: &Tables) {
        let comment = "The equations of a leg: its screws, in columns. Lengths are over the size of the mechanism.";
        self.add(Traced::new("leg_equations", comment).body(|p| {
            let (g, screws) = (geometry(p), p.add::<In<[Screw]>>("screws"));
            let (leg, width) = (p.add::<Int>("leg"), p.add::<Int>("width"));
            let equations = p.add::<Out<[Real]>>("equations");
            let first = tables.first();
            let columns = tables.columns();
            count("i", 0, ROWS * width, |i| equations.at(i).set(0.0));
            count("i", first.at(leg), first.at(leg + 1), |i| {
                let column = columns.map_or(i - first.at(leg), |columns| columns.at(i));
                let scale = self.scale(g, tables, i);
                add_column(equations, column, width, screws.at(i), scale, g.member::<Real>("size"));
            });
        }));
    }

    /// What a joint coordinate is counted in, against its sense where it turns back.
    fn scale(&self, g: Any, tables: &Tables, i: Int) -> Real {
        let size = g.list::<Joint>("joint", self.fields.len()).at(i).size;
        tables.senses().map_or(size, |senses| size * senses.at(i))
    }

    /// The rates and the accelerations of the motions that are given; zero for those that follow.
    fn motions_given(&self, q: Array<Real>, given: [Given; 2]) {
        let own = &self.forms.independent;
        let angles = self.three_angles();
        for k in 0..self.task.coordinates.len() {
            let place = own.iter().position(|&own| own == k);
            let turns = angles.as_ref().is_some_and(|angles| angles.contains(&k));
            for one in given {
                match place {
                    Some(place) if !turns => {
                        one.of_motions.at(number(k)).set(one.of_pose.at(number(place)));
                    }
                    Some(_) => {}
                    None => one.of_motions.at(number(k)).set(0.0),
                }
            }
        }
        let (Some(angles), Some(section)) = (angles, self.oriented()) else { return };
        let Some(place) = own.iter().position(|&own| own == angles.start) else { return };
        let screws = self.angle_screws(section, q);
        let factors = self.factors();
        let rates_of = |one: Given| {
            factors.map(|(_, signs)| factor_rate(signs, |i| one.of_pose.at(number(place + i))))
        };
        let [x, y, z] = factors.map(|(columns, _)| {
            let all = columns.iter().map(|&i| screws[i]);
            all.reduce(|sum, column| add(sum, 1.0, column)).unwrap_or(screws[0])
        });
        name!(axis = x);
        let sum =
            |[a, b, c]: [Real; 3]| add(add(add(vector_of(0.0, 0.0, 0.0), a, axis), b, y), c, z);
        let [rates, accelerations] = given.map(rates_of);
        name!(turn = sum(rates), turning = sum(accelerations));
        note("Each axis moves with the angles before its own.");
        let [a, b, c] = rates;
        turning.set(add(turning, a * b, cross(axis, y)));
        turning.set(add(turning, a * c, cross(axis, z)));
        turning.set(add(turning, b * c, cross(y, z)));
        for (one, vector) in given.into_iter().zip([turn, turning]) {
            for (i, part) in [vector.x, vector.y, vector.z].into_iter().enumerate() {
                one.of_motions.at(number(angles.start + i)).set(part);
            }
        }
    }

    /// The numbers of the three angles of an orientation, in whose places are rotations: `None` where some of them are given and others
    /// follow. Then they are motions themselves, and have singular poses.
    fn three_angles(&self) -> Option<Range<usize>> {
        let angles = self.all_angles()?;
        let own = self.forms.independent.iter().filter(|k| angles.contains(k)).count();
        [0, 3].contains(&own).then_some(angles)
    }

    fn all_angles(&self) -> Option<Range<usize>> {
        let first = self.numbers(self.oriented()?)[0];
        Some(first..first + 3)
    }

    /// What the motions are.
    fn motion_columns(&self) -> Columns {
        match (self.all_angles(), self.three_angles()) {
            (Some(_), None) => Columns::Coordinates,
            _ => Columns::Motions,
        }
    }

    /// The numbers of the three angles in the order of the factors of a rotation, for each factor with the rates that make up its own:
    /// their signs.
    fn factors(&self) -> [(&'static [usize], [f64; 3]); 3] {
        match self.angles_of_pose() {
            OrientationCoordinates::EulerAngles => {
                [(&[0], [1.0, 0.0, 0.0]), (&[1], [0.0, 1.0, 0.0]), (&[2], [0.0, 0.0, 1.0])]
            }
            // The third Euler angle is the torsion minus the azimuth.
            OrientationCoordinates::TiltTorsion => {
                [(&[0, 2], [1.0, 0.0, 0.0]), (&[1], [0.0, 1.0, 0.0]), (&[2], [-1.0, 0.0, 1.0])]
            }
            OrientationCoordinates::RollPitchYaw => {
                [(&[2], [0.0, 0.0, 1.0]), (&[1], [0.0, 1.0, 0.0]), (&[0], [1.0, 0.0, 0.0])]
            }
        }
    }
}

/// The sum of the rates of three angles with signs.
fn factor_rate(signs: [f64; 3], rate: impl Fn(usize) -> Real) -> Real {
    let parts = (0..3).filter(|&i| signs[i] != 0.0);
    let sum = parts.fold(None, |sum: Option<Real>, i| {
        Some(match sum {
            None if signs[i] < 0.0 => -rate(i),
            None => rate(i),
            Some(sum) if signs[i] < 0.0 => sum - rate(i),
            Some(sum) => sum + rate(i),
        })
    });
    sum.unwrap_or_else(|| Real::from(0.0))
}
