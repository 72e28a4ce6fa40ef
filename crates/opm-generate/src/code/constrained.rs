//! Coordinates that follow where legs that are solved whole constrain the platform: from a stem, or from the constraints of several
//! legs.

use super::complete::Completed;
use super::interface::SECTIONS;
use super::whole::{balls, closed_or_return, numbered};
use super::*;
use crate::library::*;
use crate::trace::closed_forms::Displaced;
use crate::trace::whole::RootsOfCode;
use crate::trace::*;
use opm_core::manipulator::form::{MirrorForm, RowForm, RowsForm, StemForm, StemPart, UPRIGHT};
use opm_core::mechanism::OrientationCoordinates;
use opm_core::nalgebra::Vector3;
use opm_core::numbers::Plane as _;
use std::f64::consts::FRAC_PI_2;

/// What is returned for a leg.
fn status(leg: usize) -> i32 {
    i32::try_from(leg + 1).unwrap_or(i32::MAX)
}

impl Writer<'_> {
    /// The displacement of the platform at coordinates, in base coordinates.
    fn body_at(&self, g: Any, q: Array<Real>) -> Body {
        let body = Body::empty("body");
        let moved = SECTIONS.map(|section| {
            let kind = super::displacement::displacement_type(self.kind(section))?;
            let moved = self.displaced(section, g, q).expr();
            Some(Any::variable(symbol(section), &kind, Some(moved)))
        });
        self.give_product(g, moved, body);
        body
    }

    /// The angles of the rotations of coordinates, of which so many are angles from the first one on.
    fn factors_of<T: Copy + std::ops::Sub<Output = T>>(
        &self,
        [first, count]: [usize; 2],
        zero: T,
        at: impl Fn(usize) -> T,
    ) -> [T; 3] {
        match count {
            3 => self.angles_of_pose().to_factors([0, 1, 2].map(|i| at(first + i))),
            _ => std::array::from_fn(|i| if i < count { at(first + i) } else { zero }),
        }
    }

    /// The dependent coordinates from the loop of a stem.
    pub fn stem_step(&self, form: &StemForm, all: Completed) {
        let Completed { g, mode, q, missed, .. } = all;
        let [first, angles] = form.angles;
        let homes = self.task.home();
        let at = |i: usize| q.at(number(i));
        let zero = Real::from(0.0);
        let mut factors = self.factors_of(form.angles, zero, at);
        let home_factors = self.factors_of(form.angles, 0.0, |i| homes[i]);
        let coordinates = self.task.coordinates.len();
        let known = match form.turned {
            true => q,
            false => {
                note("What is known of the rotation is in the loop, not in the target.");
                let known = Array::<Real>::empty("known", coordinates);
                for i in 0..coordinates {
                    let turns = (first..first + angles).contains(&i);
                    let value = if turns { self.home(g, i) } else { at(i) };
                    known.at(number(i)).set(value);
                }
                known
            }
        };
        let body = self.body_at(g, known);
        let given: Vec<Real> = form
            .given
            .iter()
            .map(|&factor| {
                let off = factors[factor] - home_factors[factor];
                crate::trace::named(&fresh("given"), off)
            })
            .collect();
        let signs = form.bits.map(|bit| match bit {
            Some(bit) => crate::trace::named(&fresh("sign"), sign(mode, bit)),
            None => Real::from(1.0),
        });
        let (missed, status) = (missed.at(0), status(form.leg));
        let mut roots = RootsOfCode { missed, status, size: form.closure.size() };
        let target = (body.rotation, body.translation);
        let run = form.closure.run_given::<Real>(target, &given, signs, &mut roots);
        closed_or_return(&run, missed, status);
        let joints = numbered(&form.closure);
        let value = |place: usize| match run.displacement(place) {
            Displaced::Value(value) => value,
            Displaced::Direction(z) => angle(z.named("turn")),
        };
        let mut turned = None;
        for &(part, place) in &form.found {
            match part {
                StemPart::Length(i) => at(i).set(self.home(g, i) + value(place)),
                StemPart::Factor(factor) => {
                    let found = value(place) + home_factors[factor];
                    factors[factor] = crate::trace::named(&fresh("factor"), found);
                }
                StemPart::Orientation => {
                    let found = balls(&run, &joints, body);
                    let ball = found.into_iter().find(|(first, _)| *first == place);
                    turned = ball.map(|(_, rotation)| rotation);
                }
            }
        }
        let found: [Real; 3] = match turned {
            None if angles == 3 => self.angles_of_pose().of_factors(factors),
            None => factors,
            Some(back) => self.angles_near_home(back, g, first),
        };
        for (i, value) in (first..first + angles).zip(found) {
            if form.coordinates.contains(&i) {
                at(i).set(near(value, self.home(g, i)));
            }
        }
    }

    /// The angles nearest to home of the orientation that a rotation, in base coordinates, leads back to home.
    fn angles_near_home(&self, back: Rotation, g: Any, first: usize) -> [Real; 3] {
        let Some(section) = self.oriented() else { return [Real::from(0.0); 3] };
        let frame = self.frame(section, g);
        let axes = frame.axes;
        name!(local = product(product(transposed(axes), transposed(back)), axes));
        if self.forms.home_orientation_inverse.is_some() {
            let inverse = g.member::<Rotation>("home_orientation_inverse");
            local.set(product(local, transposed(inverse)));
        }
        let [x, y, z] = [0, 1, 2].map(|i| self.home(g, first + i));
        let home = vector_of(x, y, z);
        name!(
            angles = match self.angles_of_pose() {
                OrientationCoordinates::EulerAngles => euler_near(local, home),
                OrientationCoordinates::TiltTorsion => torsion_near(local, home),
                OrientationCoordinates::RollPitchYaw => roll_near(local, home),
            }
        );
        [angles.x, angles.y, angles.z]
    }

    /// What a row is without the dependent positions, and its factors of these.
    fn row_parts(
        &self,
        (form, row): (&RowsForm, &RowForm),
        r: Rotation,
        q: Array<Real>,
        g: Any,
    ) -> (Vec<Real>, Real) {
        let column = |j: usize| constant(&row.turn.column(j).into_owned());
        let mut rest = Real::from(row.constant);
        for (j, of) in [r.x, r.y, r.z].into_iter().enumerate() {
            if row.turn.column(j).iter().any(|part| *part != 0.0) {
                rest = rest + dot(column(j), of);
            }
        }
        if row.direction == Vector3::zeros() {
            return (vec![Real::from(0.0); form.lengths.len()], rest);
        }
        let c = match row.carried {
            true => rotated(r, constant(&row.direction)),
            false => constant(&row.direction),
        };
        let c = row.across.map_or(c, |base| cross(constant(&base), c));
        let c = crate::trace::named(&fresh("along"), c);
        let axes = self.task.lower.axes;
        let along = |i: usize| dot(c, constant(&axes.column(i).into_owned()));
        for i in (0..3).filter(|i| !form.lengths.contains(i)) {
            rest = rest + along(i) * (q.at(number(i)) - self.home(g, i)) * (1.0 / form.size);
        }
        (form.lengths.iter().map(|&i| along(i)).collect(), rest)
    }

    /// The orientation of coordinates in base coordinates, from home.
    fn rotation_at(&self, g: Any, angles: [Real; 3]) -> Rotation {
        let turned = self.orientation_with(angles);
        let local = match self.forms.home_orientation_inverse {
            Some(_) => product(turned, g.member::<Rotation>("home_orientation_inverse")),
            None => turned,
        };
        let section = self.oriented().unwrap_or(Section::Upper);
        let axes = self.frame(section, g).axes;
        crate::trace::named("r", product(product(axes, local), transposed(axes)))
    }

    /// The function of one factor of the orientation that is zero where there are positions that satisfy all rows.
    pub fn rows_left(&self, form: &RowsForm) {
        let Some((factor, ..)) = form.turn else { return };
        let comment = "What is left of the legs' constraints for an angle: zero where there are positions that satisfy them.";
        self.add(Traced::new("constraints_left", comment).body(|p| {
            let (g, q) = (geometry(p), p.add::<In<[Real]>>("q"));
            let turn = p.add::<Real>("turn");
            let mut factors =
                self.factors_of([form.first_angle, 3], Real::from(0.0), |i| q.at(number(i)));
            factors[factor] = turn;
            let r = self.rotation_at(g, self.angles_of_pose().of_factors(factors));
            if form.couples == 1 {
                return self.row_parts((form, &form.rows[0]), r, q, g).1;
            }
            let used = form.rows.len();
            let b = Array::<Real>::empty("b", used * used);
            for (i, row) in form.rows.iter().enumerate() {
                let (by, rest) = self.row_parts((form, row), r, q, g);
                for (j, part) in by.into_iter().chain([rest]).enumerate() {
                    b.at(number(i * used + j)).set(part);
                }
            }
            if used == 1 { b.at(0) } else { determinant(b, number(used)) }
        }));
    }

    /// The dependent coordinates from the constraints of several legs.
    pub fn rows_step(&self, form: &RowsForm, all: Completed) {
        let Completed { g, mode, q, missed, .. } = all;
        let (missed, status) = (missed.at(0), status(form.leg));
        let at = |i: usize| q.at(number(i));
        if let Some((factor, angle, home, unit)) = form.turn {
            let (value, c) = (Array::<Real>::empty("value", 3), Array::<Real>::empty("c", 3));
            count("i", 0, 3, |i| {
                let place = home + i.real() * FRAC_PI_2;
                value.at(i).set(self.call("constraints_left", &given![g, q, place]).is::<Real>());
            });
            c.at(0).set((value.at(0) + value.at(2)) / 2.0);
            c.at(1).set((value.at(0) - value.at(2)) / 2.0);
            c.at(2).set(value.at(1) - c.at(0));
            let mut factors = self.factors_of([form.first_angle, 3], Real::from(0.0), at);
            name!(held = factors[factor]);
            name!(u = held - home);
            let sign_of = form.bit.map_or(Real::from(1.0), |bit| sign(mode, bit));
            when(zero_harmonic(c, sign_of, unit, u, missed).is_set(), || {
                missed.set(abs(missed / unit));
                give(status);
            });
            factors[factor] = crate::trace::named("factor", near(home + u, held));
            let found = self.angles_of_pose().of_factors(factors)[angle - form.first_angle];
            at(angle).set(found);
        }
        let angles = [0, 1, 2].map(|i| at(form.first_angle + i));
        let r = self.rotation_at(g, angles);
        let (used, unknowns) = (form.rows.len() - form.couples, form.lengths.len());
        if unknowns == 0 {
            return;
        }
        let a = Array::<Real>::empty("a", used * (unknowns + 1));
        let x = Array::<Real>::empty("x", unknowns);
        for (i, row) in form.rows.iter().skip(form.couples).enumerate() {
            let (by, rest) = self.row_parts((form, row), r, q, g);
            for (j, part) in by.into_iter().chain([-rest]).enumerate() {
                a.at(number(i * (unknowns + 1) + j)).set(part);
            }
        }
        let singular = eliminate(a, number(used), number(unknowns), 1, x);
        when(singular.is_set(), || {
            missed.set(FRAC_PI_2);
            give(status);
        });
        for (place, &i) in form.lengths.iter().enumerate() {
            at(i).set(self.home(g, i) + x.at(number(place)) * form.size);
        }
    }

    /// The dependent coordinates of a platform that is the image of its base.
    pub fn mirror_step(&self, form: &MirrorForm, all: Completed) {
        let Completed { g, q, missed, .. } = all;
        let at = |i: usize| q.at(number(i));
        let [roll, pitch, yaw] = [0, 1, 2].map(|i| at(form.first_angle + i));
        let found = form.follow::<Real>([roll, pitch], at(2) - self.home(g, 2));
        when(found.upright.lt(UPRIGHT), || {
            missed.at(0).set(FRAC_PI_2);
            give(status(form.leg));
        });
        yaw.set(near(angle(found.yaw.named("turn")), yaw));
        let kept = if form.sphere.is_some() { 3 } else { 2 };
        for i in 0..kept {
            at(i).set(self.home(g, i) + found.moved[i]);
        }
    }
}
