//! Mechanisms for tests, which are built joint by joint from their geometry. Lengths are in metres.

use crate::group::screw::Screw;
use crate::mechanism::joint::{Joint, JointKind};
use crate::mechanism::leg::Leg;
use crate::mechanism::{Mechanism, TaskHints};
use nalgebra::{Isometry3, Point3, Unit, UnitQuaternion, Vector3};
use std::f64::consts::FRAC_PI_2;

/// The unit vector along `(x, y, z)`.
pub(crate) fn unit(x: f64, y: f64, z: f64) -> Unit<Vector3<f64>> {
    Unit::new_normalize(Vector3::new(x, y, z))
}

/// A revolute joint about a line.
pub(crate) fn revolute(axis: Unit<Vector3<f64>>, point: Point3<f64>) -> Joint {
    Joint::new("", JointKind::Revolute, axis, point)
}

/// A prismatic joint along a direction.
pub(crate) fn prismatic(axis: Unit<Vector3<f64>>) -> Joint {
    Joint::new("", JointKind::Prismatic, axis, Point3::origin())
}

/// A helical joint about a line, with a pitch in metres per radian.
pub(crate) fn helical(axis: Unit<Vector3<f64>>, point: Point3<f64>, pitch: f64) -> Joint {
    Joint::new("", JointKind::Helical { pitch }, axis, point)
}

/// A spherical joint about a point.
pub(crate) fn spherical(point: Point3<f64>) -> Joint {
    Joint::new("", JointKind::Spherical, Vector3::z_axis(), point)
}

/// A mechanism with these legs. Joints are named by leg and position: `leg2.1` is the first of
/// `leg2`.
pub(crate) fn mechanism(name: &str, legs: Vec<Vec<Joint>>) -> Mechanism {
    let leg = |(i, joints): (usize, Vec<Joint>)| {
        let name = format!("leg{}", i + 1);
        let named =
            |(j, joint): (usize, Joint)| Joint { name: format!("{name}.{}", j + 1), ..joint };
        let joints = joints.into_iter().enumerate().map(named).collect();
        Leg::new(name.clone(), joints)
    };
    Mechanism {
        name: name.to_owned(),
        legs: legs.into_iter().enumerate().map(leg).collect(),
        platform: Point3::origin(),
        differences: Vec::new(),
        task: TaskHints::default(),
        bodies: Default::default(),
        shapes: Default::default(),
        units: Default::default(),
    }
}

/// The horizontal unit vector at an angle from x.
fn direction(angle: f64) -> Unit<Vector3<f64>> {
    unit(angle.cos(), angle.sin(), 0.0)
}

/// The geometry of manipulator 1 of the paper, 3-PRR(RR) + RRS, at x = y = 0 and without rotation.
#[derive(Clone, Debug)]
pub(crate) struct PlanoSpherical {
    pub alpha: [f64; 3],
    pub h: f64,
    pub a1: f64,
    pub a2: f64,
    pub arcs: [f64; 2],
    pub eta: [f64; 3],
    pub beta: f64,
    pub base: [f64; 2],
    pub arm: [f64; 2],
}

impl Default for PlanoSpherical {
    fn default() -> Self {
        Self {
            alpha: [30.0, 150.0, 270.0].map(f64::to_radians),
            h: 0.12,
            a1: 0.2,
            a2: 0.06,
            arcs: [75.0, 75.0].map(f64::to_radians),
            eta: [0.0, 120.0, 240.0].map(f64::to_radians),
            beta: 60.0_f64.to_radians(),
            base: [0.0, 0.075],
            arm: [0.1, 0.1],
        }
    }
}

impl PlanoSpherical {
    /// The axis `w_i` and the imaginary angle `theta_1i` of the first branch (NOTES, Eqs. 2 and 3);
    /// `None` if the leg cannot be assembled.
    pub fn upper(&self, i: usize) -> Option<(Vector3<f64>, f64)> {
        let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.eta[i])
            * UnitQuaternion::from_axis_angle(&Vector3::y_axis(), self.beta);
        let w = rotation * Vector3::z();
        let [a1, a2] = self.arcs;
        let k = (a2.cos() - a1.cos() * w.z) / (a1.sin() * w.x.hypot(w.y));
        (k.abs() < 1.0).then(|| (w, w.y.atan2(w.x) + k.asin()))
    }

    /// The mechanism with this geometry; `None` if a leg cannot be assembled.
    pub fn try_mechanism(&self) -> Option<Mechanism> {
        let mut legs = vec![];
        for i in 0..3 {
            let (w, theta) = self.upper(i)?;
            let (e, n) = (direction(self.alpha[i]), direction(self.alpha[i] + FRAC_PI_2));
            let elbow = direction(theta).into_inner() * self.a2;
            let q = elbow - e.into_inner() * self.h;
            let root = self.a1.powi(2) - q.dot(&e).powi(2);
            let slide = (root >= 0.0).then(|| q.dot(&n) + root.sqrt())?;
            let pin = e.into_inner() * self.h + n.into_inner() * slide;
            let a1 = self.arcs[0];
            let v = unit(a1.sin() * theta.sin(), -a1.sin() * theta.cos(), a1.cos());
            legs.push(vec![
                prismatic(n).actuated(),
                revolute(Vector3::z_axis(), pin.into()),
                revolute(Vector3::z_axis(), elbow.into()),
                revolute(v, Point3::origin()),
                revolute(Unit::new_normalize(w), Point3::origin()),
            ]);
        }
        let ([b1, b2], base) = (self.arm, Vector3::new(self.base[0], self.base[1], 0.0));
        let reach = base.norm();
        let cosine = (b1 * b1 + reach * reach - b2 * b2) / (2.0 * b1 * reach);
        let towards = (-base.y).atan2(-base.x);
        let elbow = (cosine.abs() <= 1.0)
            .then(|| base + direction(towards - cosine.acos()).into_inner() * b1)?;
        legs.push(vec![
            revolute(Vector3::z_axis(), base.into()).actuated(),
            revolute(Vector3::z_axis(), elbow.into()).actuated(),
            spherical(Point3::origin()),
        ]);
        Some(mechanism("plano-spherical", legs))
    }

    /// The mechanism with this geometry, which must assemble.
    pub fn mechanism(&self) -> Mechanism {
        self.try_mechanism().expect("assembles at home")
    }
}

/// Manipulator 2 of the paper, 2-PPR + PPH, with the printed parameters. Its axis is at 255 degrees.
pub(crate) fn translational_helical() -> Mechanism {
    let axis = direction(255.0_f64.to_radians());
    let legs = [(210.0_f64, true), (330.0, false), (90.0, false)];
    let leg = |(alpha, is_helical): (f64, bool)| {
        let alpha = alpha.to_radians();
        let upper = if is_helical {
            helical(axis, Point3::origin(), 0.02)
        } else {
            revolute(axis, Point3::origin())
        };
        vec![prismatic(direction(alpha + FRAC_PI_2)).actuated(), prismatic(direction(alpha)), upper]
    };
    mechanism("translational-helical", legs.map(leg).to_vec())
}

/// Bennett's double spherical 6R linkage: `a1 | b3` in one leg, `a2 a3 | b1 b2` in the other.
pub(crate) fn bennett() -> Mechanism {
    let (a, b) = (Point3::origin(), Point3::new(0.3, 0.05, 0.1));
    let lower = |x, y, z| revolute(unit(x, y, z), a);
    let upper = |x, y, z| revolute(unit(x, y, z), b);
    mechanism(
        "bennett",
        vec![
            vec![lower(0.2, -0.4, 1.0).actuated(), upper(-0.5, -0.3, 1.0)],
            vec![
                lower(1.0, 0.5, 0.6),
                lower(0.4, 1.0, -0.2),
                upper(-0.3, 0.8, 0.7),
                upper(-1.0, 0.4, -0.1),
            ],
        ],
    )
}

/// Pseudo-random numbers in (-1, 1), which are the same in every run.
pub(crate) struct Numbers(u64);

impl Numbers {
    /// The sequence of numbers that starts from a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next number, by the generator SplitMix64.
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// A vector with components in (-1, 1).
    pub fn vector(&mut self) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.next())
    }

    /// A unit vector, uniformly distributed on the sphere.
    pub fn direction(&mut self) -> Unit<Vector3<f64>> {
        loop {
            let v = self.vector();
            if (0.1..1.0).contains(&v.norm()) {
                return Unit::new_normalize(v);
            }
        }
    }

    /// A rotation by up to 3 radians, and a translation with components of at most `size`.
    pub fn displacement(&mut self, size: f64) -> Isometry3<f64> {
        let rotation = UnitQuaternion::from_axis_angle(&self.direction(), 3.0 * self.next());
        Isometry3::from_parts((self.vector() * size).into(), rotation)
    }
}

/// The common geometry of the revolute joints of one section.
#[derive(Clone, Copy, Debug)]
pub(crate) enum CommonGeometry {
    /// All axes meet in this point.
    Spherical(Point3<f64>),
    /// All axes have this direction.
    Planar(Unit<Vector3<f64>>),
}

/// A mechanism of legs with revolute joints, with given numbers of joints in each of two sections.
/// The first joint of every leg is actuated, then second ones, up to `actuators` in all.
pub(crate) fn two_sections(
    sections: [CommonGeometry; 2],
    pattern: &[[usize; 2]],
    actuators: usize,
    numbers: &mut Numbers,
) -> Mechanism {
    let mut legs: Vec<Vec<Joint>> = vec![];
    for counts in pattern {
        let mut joints = vec![];
        for (section, count) in sections.iter().zip(counts) {
            for _ in 0..*count {
                joints.push(match section {
                    CommonGeometry::Spherical(centre) => revolute(numbers.direction(), *centre),
                    CommonGeometry::Planar(normal) => {
                        revolute(*normal, Point3::from(numbers.vector() * 0.3))
                    }
                });
            }
        }
        legs.push(joints);
    }
    for i in 0..actuators {
        let (leg, joint) = (i % pattern.len(), i / pattern.len());
        legs[leg][joint].actuated = true;
    }
    mechanism("two sections", legs)
}

/// A mechanism of two spherical subspaces, with three (3,2) legs and a (2,3) leg.
pub(crate) fn two_spherical(numbers: &mut Numbers) -> Mechanism {
    let centres = [Point3::new(0.1, 0.0, 0.05), Point3::new(-0.1, 0.2, 0.3)];
    let pattern = [[3, 2], [3, 2], [3, 2], [2, 3]];
    two_sections(centres.map(CommonGeometry::Spherical), &pattern, 5, numbers)
}

/// A mechanism of two planar subspaces, with three (3,2) legs and a (2,3) leg.
pub(crate) fn two_planar(numbers: &mut Numbers) -> Mechanism {
    let normals = [unit(0.1, 0.2, 1.0), unit(1.0, -0.4, 0.5)];
    let pattern = [[3, 2], [3, 2], [3, 2], [2, 3]];
    two_sections(normals.map(CommonGeometry::Planar), &pattern, 5, numbers)
}

/// A mechanism of a planar and a cylindrical subspace: three RRR|R legs whose last axes are on one line in
/// the plane, and an RRP|H leg whose screw is on that line.
pub(crate) fn planar_cylindrical() -> Mechanism {
    let axis = Vector3::x_axis();
    let z = |x, y| revolute(Vector3::z_axis(), Point3::new(x, y, 0.0));
    let arm = |[base, elbow, wrist]: [[f64; 2]; 3]| {
        vec![
            z(base[0], base[1]).actuated(),
            z(elbow[0], elbow[1]),
            z(wrist[0], wrist[1]),
            revolute(axis, Point3::new(wrist[0], 0.0, 0.0)),
        ]
    };
    mechanism(
        "planar-cylindrical",
        vec![
            arm([[0.4, 0.3], [0.35, 0.1], [0.12, 0.08]]),
            arm([[-0.5, 0.25], [-0.25, 0.3], [-0.13, 0.05]]),
            arm([[0.1, -0.45], [-0.1, -0.3], [0.02, -0.14]]),
            vec![
                z(-0.3, -0.4).actuated(),
                z(-0.25, -0.2),
                prismatic(unit(0.3, 1.0, 0.0)),
                helical(axis, Point3::origin(), 0.03),
            ],
        ],
    )
}

/// A Gough platform, 6-UPS, which is irregular enough not to be singular.
pub(crate) fn gough(numbers: &mut Numbers) -> Mechanism {
    let leg = |i: usize| {
        let at_degrees = |x: f64| direction(x.to_radians()).into_inner();
        let (pair, side) = ((i / 2) as f64 * 120.0, if i.is_multiple_of(2) { -1.0 } else { 1.0 });
        let foot = at_degrees(pair + 15.0 * side) * 0.5 + numbers.vector() * 0.02;
        let top =
            at_degrees(pair + 45.0 * side) * 0.25 + Vector3::z() * 0.6 + numbers.vector() * 0.02;
        let strut = top - foot;
        let first = Unit::new_normalize(strut.cross(&numbers.vector()));
        let second = Unit::new_normalize(strut.cross(&first));
        let universal = JointKind::Universal { second };
        vec![
            Joint::new("", universal, first, foot.into()),
            prismatic(Unit::new_normalize(strut)).actuated(),
            spherical(top.into()),
        ]
    };
    mechanism("gough", (0..6).map(leg).collect())
}

/// A mechanism displaced as a rigid body.
pub(crate) fn displaced(mechanism: &Mechanism, g: &Isometry3<f64>) -> Mechanism {
    edited(mechanism, |joint| {
        let rotated =
            |axis: Unit<Vector3<f64>>| Unit::new_normalize(g.rotation * axis.into_inner());
        joint.axis = rotated(joint.axis);
        joint.point = g * joint.point;
        if let JointKind::Universal { second } = &mut joint.kind {
            *second = rotated(*second);
        }
    })
}

/// A mechanism with all lengths multiplied by a factor.
pub(crate) fn scaled(mechanism: &Mechanism, factor: f64) -> Mechanism {
    edited(mechanism, |joint| {
        joint.point *= factor;
        if let JointKind::Helical { pitch } = &mut joint.kind {
            *pitch *= factor;
        }
    })
}

/// A mechanism with all numbers rounded to six significant digits.
pub(crate) fn rounded(mechanism: &Mechanism) -> Mechanism {
    let digits = |x: f64| format!("{x:.5e}").parse::<f64>().expect("a number");
    let direction = |axis: Unit<Vector3<f64>>| Unit::new_normalize(axis.map(digits));
    edited(mechanism, |joint| {
        joint.axis = direction(joint.axis);
        joint.point = joint.point.map(digits);
        match &mut joint.kind {
            JointKind::Universal { second } => *second = direction(*second),
            JointKind::Helical { pitch } => *pitch = digits(*pitch),
            _ => {}
        }
    })
}

/// A copy of a mechanism, with an edit applied to every joint.
fn edited(mechanism: &Mechanism, mut edit: impl FnMut(&mut Joint)) -> Mechanism {
    let mut edited = mechanism.clone();
    edited.legs.iter_mut().flat_map(|leg| &mut leg.joints).for_each(&mut edit);
    edited
}

/// The sine of the angle between two screws, as six-vectors: zero if they are on one line.
pub(crate) fn same_line(a: &Screw, b: &Screw) -> f64 {
    let (a, b) = (a.to_vector().normalize(), b.to_vector().normalize());
    (a - b * a.dot(&b)).norm()
}
