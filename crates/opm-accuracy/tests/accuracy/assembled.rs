//! A mechanism made with errors, and assembled numerically: of all small plays with which its legs close, the smallest.
//!
//! Nothing here uses screws at the pose: derivatives are differences of products of displacements.

use nalgebra::{
    DMatrix, DVector, Isometry3, Matrix6, Translation3, UnitQuaternion, Vector3, Vector6,
};
use opm_accuracy::{ErrorModel, Model, Source};
use opm_core::Quantity;
use opm_core::mechanism::Mechanism;
use opm_core::mechanism::joint::{Joint, JointKind};

pub struct Assembly<'a> {
    pub model: &'a Model<'a>,
    pub errors: ErrorModel,
    /// The joint values at the pose.
    pub joints: &'a [f64],
}

/// What the Jacobian of the closure says.
pub struct Ranks {
    pub held: bool,
    pub overconstraints: usize,
}

/// A displacement by a rotation vector about a point, then a translation.
fn displaced(rotation: Vector3<f64>, about: Vector3<f64>, way: Vector3<f64>) -> Isometry3<f64> {
    let rotation = UnitQuaternion::from_scaled_axis(rotation);
    Isometry3::from_parts(Translation3::from(about - rotation * about + way), rotation)
}

/// The rotation vector and the translation of a point.
fn difference(g: &Isometry3<f64>, point: &Vector3<f64>) -> Vector6<f64> {
    let (w, v) = (g.rotation.scaled_axis(), g * nalgebra::Point3::from(*point) - point);
    let v = v.coords;
    Vector6::new(w.x, w.y, w.z, v.x, v.y, v.z)
}

impl Assembly<'_> {
    fn mechanism(&self) -> &Mechanism {
        self.model.manipulator().mechanism()
    }

    fn length(&self) -> f64 {
        self.model.manipulator().characteristic_length()
    }

    /// The displacement of each leg's end, with errors and joint values.
    fn ends(&self, errors: &DVector<f64>, joints: &DVector<f64>) -> Vec<Isometry3<f64>> {
        let mut values = joints.clone();
        for (&number, error) in self.model.manipulator().actuated().iter().zip(errors.iter()) {
            values[number] += error;
        }
        let mut number = 0;
        let legs = self.mechanism().legs.iter().map(|leg| {
            let mut end = Isometry3::identity();
            for joint in &leg.joints {
                let own = &values.as_slice()[number..number + joint.freedoms()];
                number += joint.freedoms();
                end *= match self.errors {
                    ErrorModel::Axes => self.with_axis(joint, errors).displacement(own).unwrap(),
                    ErrorModel::Links => self.in_link(joint, errors, own),
                };
            }
            if self.errors == ErrorModel::Links {
                let last = leg.joints.last().unwrap();
                let prefix = format!("{}.platform.", leg.name);
                end *= self.errors_of(&prefix, errors, last.point.coords, |_| true);
            }
            end
        });
        legs.collect()
    }

    fn own<'s>(
        &'s self,
        prefix: &'s str,
        errors: &'s DVector<f64>,
    ) -> impl Iterator<Item = (&'s str, Vector3<f64>, f64)> {
        let named = self.model.sources().iter().zip(errors.iter());
        named.filter_map(move |(source, error)| {
            let rest = source.name.strip_prefix(prefix)?;
            Some((rest, source.direction?, *error))
        })
    }

    fn prefix(&self, joint: &Joint) -> String {
        let of =
            |leg: &&opm_core::mechanism::leg::Leg| leg.joints.iter().any(|j| j.name == joint.name);
        let leg = self.mechanism().legs.iter().find(of).unwrap();
        format!("{}.{}.", leg.name, joint.name)
    }

    /// The joint with another axis, as if a mechanism file had other numbers.
    fn with_axis(&self, joint: &Joint, errors: &DVector<f64>) -> Joint {
        let mut changed = joint.clone();
        for (what, direction, error) in self.own(&self.prefix(joint), errors) {
            let rotation = UnitQuaternion::from_scaled_axis(direction * error);
            match (what, &mut changed.kind) {
                ("angle.3" | "angle.4", JointKind::Universal { second }) => {
                    *second = rotation * *second;
                }
                ("angle.1" | "angle.2", _) => changed.axis = rotation * changed.axis,
                ("pitch", JointKind::Helical { pitch }) => *pitch += error,
                _ => {
                    assert!(what.starts_with("offset."), "{what}");
                    changed.point += direction * error;
                }
            }
        }
        changed
    }

    fn errors_of(
        &self,
        prefix: &str,
        errors: &DVector<f64>,
        point: Vector3<f64>,
        wanted: impl Fn(&str) -> bool,
    ) -> Isometry3<f64> {
        let (mut rotation, mut way) = (Vector3::zeros(), Vector3::zeros());
        for (what, direction, error) in self.own(prefix, errors).filter(|own| wanted(own.0)) {
            match what.split('.').next() {
                Some("angle") => rotation += direction * error,
                _ => way += direction * error,
            }
        }
        displaced(rotation, point, way)
    }

    /// A joint in a link that carries it, and all behind it, at a wrong place.
    fn in_link(&self, joint: &Joint, errors: &DVector<f64>, values: &[f64]) -> Isometry3<f64> {
        let (prefix, point) = (self.prefix(joint), joint.point.coords);
        let second = |what: &str| matches!(what, "angle.3" | "angle.4");
        let first = |what: &str| !second(what) && what != "pitch";
        let placed = self.errors_of(&prefix, errors, point, first);
        let mut joint = joint.clone();
        if let JointKind::Helical { pitch } = &mut joint.kind {
            *pitch += self.own(&prefix, errors).find(|own| own.0 == "pitch").unwrap().2;
        }
        if let JointKind::Universal { second: axis } = joint.kind {
            let [a, b] = [0, 1].map(|i| values[i] - joint.coordinates[i].home);
            let cross = self.errors_of(&prefix, errors, point, second);
            let about =
                |axis: Vector3<f64>, angle: f64| displaced(axis * angle, point, Vector3::zeros());
            return placed * about(*joint.axis, a) * cross * about(*axis, b);
        }
        placed * joint.displacement(values).unwrap()
    }

    /// Where each joint's point is at the pose, and the twists that the joint allows, by differences.
    fn placed(&self) -> Vec<(usize, Vector3<f64>, Vec<Vector6<f64>>)> {
        let (mut number, mut placed) = (0, Vec::new());
        for (leg, each) in self.mechanism().legs.iter().enumerate() {
            let mut at = Isometry3::identity();
            for joint in &each.joints {
                let own = &self.joints[number..number + joint.freedoms()];
                number += joint.freedoms();
                let point = (at * joint.point).coords;
                let now = joint.displacement(own).unwrap();
                let allowed = (0..own.len()).map(|i| {
                    let [more, less] = [1e-5, -1e-5].map(|step| {
                        let mut values = own.to_vec();
                        values[i] += step;
                        at * joint.displacement(&values).unwrap() * now.inverse() * at.inverse()
                    });
                    (difference(&more, &point) - difference(&less, &point)) / 2e-5
                });
                placed.push((leg, point, allowed.collect()));
                at *= now;
            }
        }
        placed
    }

    fn reference(&self) -> Vector3<f64> {
        let nominal = self.ends(&self.none(), &DVector::from_column_slice(self.joints));
        (nominal[0] * self.mechanism().platform).coords
    }

    fn none(&self) -> DVector<f64> {
        DVector::zeros(self.model.sources().len())
    }

    fn passive(&self) -> Vec<usize> {
        let actuated = self.model.manipulator().actuated();
        (0..self.joints.len()).filter(|number| !actuated.contains(number)).collect()
    }

    /// Closure residuals of all legs for the platform's displacement, passive joints and plays; lengths over the
    /// characteristic length.
    fn residual(&self, errors: &DVector<f64>, z: &DVector<f64>, plays: &Plays) -> DVector<f64> {
        let (length, reference, passive) = (self.length(), plays.reference, self.passive());
        let coordinates = self.model.manipulator().coordinates();
        let mut joints = DVector::from_column_slice(self.joints);
        for (&number, value) in passive.iter().zip(z.iter().skip(6)) {
            joints[number] += value
                * match coordinates[number].quantity {
                    Quantity::Angle => 1.0,
                    Quantity::Length => length,
                };
        }
        let w = z.fixed_rows::<3>(0).into_owned();
        let moved = displaced(w, reference, z.fixed_rows::<3>(3) * length) * plays.nominal;
        let mut residual = DVector::zeros(6 * self.mechanism().legs.len());
        for (leg, mut end) in self.ends(errors, &joints).into_iter().enumerate() {
            // From the platform to the base: a play displaces all that its joint carries.
            let mut column = z.len();
            for (of, point, across) in plays.joints.iter().rev() {
                column -= across.ncols();
                if *of == leg {
                    let y = across * z.rows(column, across.ncols());
                    let way = y.fixed_rows::<3>(3) * length;
                    end = displaced(y.fixed_rows::<3>(0).into_owned(), *point, way) * end;
                }
            }
            let mut off = difference(&(end * moved.inverse()), &reference);
            off.fixed_rows_mut::<3>(3).unscale_mut(length);
            residual.fixed_rows_mut::<6>(6 * leg).copy_from(&off);
        }
        residual
    }

    fn plays(&self) -> Plays {
        let length = self.length();
        let joints = self.placed().into_iter().map(|(leg, point, allowed)| {
            let mut basis: Vec<Vector6<f64>> = Vec::new();
            let mut add = |mut twist: Vector6<f64>| {
                let norm = twist.norm();
                for _ in 0..2 {
                    for known in &basis {
                        twist -= known * known.dot(&twist);
                    }
                }
                if twist.norm() > 1e-6 * norm {
                    basis.push(twist.normalize());
                }
            };
            for mut twist in allowed {
                twist.fixed_rows_mut::<3>(3).unscale_mut(length);
                add(twist);
            }
            let own = basis.len();
            // A fixed generic matrix, so that no direction is nearly one of those before.
            let mut rng = fastrand::Rng::with_seed(3);
            while basis.len() < 6 {
                let mut add = |mut twist: Vector6<f64>| {
                    for _ in 0..2 {
                        for known in &basis {
                            twist -= known * known.dot(&twist);
                        }
                    }
                    basis.push(twist.normalize());
                };
                add(Matrix6::from_fn(|_, _| rng.f64() - 0.5).column(0).into_owned());
            }
            (leg, point, DMatrix::from_fn(6, 6 - own, |i, j| basis[own + j][i]))
        });
        let nominal = self.ends(&self.none(), &DVector::from_column_slice(self.joints))[0];
        Plays { nominal, reference: self.reference(), joints: joints.collect() }
    }

    fn jacobian(&self, errors: &DVector<f64>, z: &DVector<f64>, plays: &Plays) -> DMatrix<f64> {
        let mut jacobian = DMatrix::zeros(6 * self.mechanism().legs.len(), z.len());
        for column in 0..z.len() {
            let [more, less] = [1e-5, -1e-5].map(|step| {
                let mut z = z.clone();
                z[column] += step;
                self.residual(errors, &z, plays)
            });
            jacobian.set_column(column, &((more - less) / 2e-5));
        }
        jacobian
    }

    /// Whether the platform is held and how many closure conditions depend on others; `None` where that is not clear.
    pub fn ranks(&self) -> Option<Ranks> {
        let plays = self.plays();
        let count = 6 + self.passive().len();
        let all = count + plays.joints.iter().map(|joint| joint.2.ncols()).sum::<usize>();
        let jacobian = self.jacobian(&self.none(), &DVector::zeros(all), &plays);
        let rank = |matrix: DMatrix<f64>| {
            if matrix.is_empty() {
                return Some(0);
            }
            let values = matrix.svd(false, false).singular_values;
            let largest = values.max();
            let unclear = values.iter().any(|v| (1e-8 * largest..1e-2 * largest).contains(v));
            (!unclear).then(|| values.iter().filter(|v| **v > 1e-4 * largest).count())
        };
        let rank_of_all = rank(jacobian.columns(0, count).into_owned())?;
        let of_joints = rank(jacobian.columns(6, count - 6).into_owned())?;
        let held = rank_of_all == of_joints + 6;
        Some(Ranks { held, overconstraints: jacobian.nrows() - rank_of_all })
    }

    /// The platform's displacement, then the play of each joint: rotations, and displacements of the reference point or of the
    /// joint's point, metres.
    pub fn assemble(&self, errors: &DVector<f64>) -> Option<Vec<Vector6<f64>>> {
        /// Motions cost next to nothing; it only decides those of joints that move nothing else.
        const FREE: f64 = 1e-10;
        let plays = self.plays();
        let count = 6 + self.passive().len();
        let all = count + plays.joints.iter().map(|joint| joint.2.ncols()).sum::<usize>();
        let mut z = DVector::zeros(all);
        let rows = 6 * self.mechanism().legs.len();
        for _ in 0..20 {
            let residual = self.residual(errors, &z, &plays);
            let jacobian = self.jacobian(errors, &z, &plays);
            let mut system = DMatrix::zeros(all + rows, all + rows);
            for i in 0..all {
                system[(i, i)] = if i < count { FREE } else { 1.0 };
            }
            system.view_mut((0, all), (all, rows)).copy_from(&jacobian.transpose());
            system.view_mut((all, 0), (rows, all)).copy_from(&jacobian);
            let mut right = DVector::zeros(all + rows);
            right.rows_mut(0, all).copy_from(&DVector::from_fn(all, |i, _| -system[(i, i)] * z[i]));
            right.rows_mut(all, rows).copy_from(&-residual);
            let step = system.lu().solve(&right)?.rows(0, all).into_owned();
            z += &step;
            if step.amax() < 1e-12 {
                let length = self.length();
                let scaled = |mut twist: Vector6<f64>| {
                    twist.fixed_rows_mut::<3>(3).scale_mut(length);
                    twist
                };
                let mut found = vec![scaled(z.fixed_rows::<6>(0).into_owned())];
                let mut column = count;
                for (_, _, across) in &plays.joints {
                    let y = across * z.rows(column, across.ncols());
                    found.push(scaled(y.fixed_rows::<6>(0).into_owned()));
                    column += across.ncols();
                }
                return Some(found);
            }
        }
        None
    }
}

/// The plays of all joints around a pose.
struct Plays {
    /// The platform's displacement there.
    nominal: Isometry3<f64>,
    reference: Vector3<f64>,
    /// The leg, the point, and the twists that a joint does not allow, lengths over the characteristic length.
    joints: Vec<(usize, Vector3<f64>, DMatrix<f64>)>,
}

/// Every source but actuators and parameters has a direction, on which this test relies.
pub fn has_direction(source: &Source) -> bool {
    source.direction.is_some() || source.is_actuator() || source.is_parameter()
}
