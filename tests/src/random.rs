//! Random mechanisms of every pair of subspaces, with the decomposition from which they were built.

use crate::height::{is_lift, lean, straighten};
use fastrand::Rng;
use nalgebra::{Isometry3, Matrix3, Point3, Translation3, Unit, UnitQuaternion, Vector3};
use opm_core::decomposition::mobility::mobility;
use opm_core::decomposition::{Decomposition, Freedom, LegSplit};
use opm_core::group::subspace::SubspaceClass;
use opm_core::mechanism::joint::{Joint, JointKind};
use opm_core::mechanism::leg::Leg;
use opm_core::mechanism::{Mechanism, TaskHints};
use std::f64::consts::{PI, TAU};

/// Every pair of subspaces (lower, upper) that has closed-form chains and shares at most a one-parameter
/// motion, and every subspace alone.
pub const PAIRS: [[RandomSubspace; 2]; 41] = {
    use Meet::{Nothing, Rotation, Translation};
    use RandomSubspace::{
        Cylindrical, Identity, Inclined, Planar, Schoenflies, Spherical, TranslationalPlane,
        TranslationalSpace,
    };
    [
        [Planar(Rotation), Spherical],
        [Spherical, Planar(Rotation)],
        [Spherical, Spherical],
        [Planar(Rotation), Cylindrical(Rotation)],
        [Cylindrical(Rotation), Planar(Rotation)],
        [Spherical, Cylindrical(Rotation)],
        [Cylindrical(Rotation), Spherical],
        [Planar(Translation), Planar(Translation)],
        [Planar(Translation), Cylindrical(Translation)],
        [Cylindrical(Translation), Planar(Translation)],
        [Planar(Translation), TranslationalPlane],
        [TranslationalPlane, Planar(Translation)],
        [Cylindrical(Translation), Cylindrical(Translation)],
        [Cylindrical(Translation), TranslationalPlane],
        [TranslationalPlane, Cylindrical(Translation)],
        [TranslationalPlane, TranslationalPlane],
        [Planar(Nothing), Identity],
        [Spherical, Identity],
        [Cylindrical(Nothing), Identity],
        [TranslationalPlane, Identity],
        [TranslationalPlane, Spherical],
        [Spherical, TranslationalPlane],
        [Cylindrical(Nothing), Spherical],
        [Spherical, Cylindrical(Nothing)],
        [Planar(Nothing), Cylindrical(Nothing)],
        [Cylindrical(Nothing), Planar(Nothing)],
        [Cylindrical(Nothing), Cylindrical(Nothing)],
        [TranslationalPlane, Cylindrical(Nothing)],
        [Cylindrical(Nothing), TranslationalPlane],
        [Schoenflies(Rotation), Spherical],
        [Spherical, Schoenflies(Rotation)],
        [Schoenflies(Translation), Cylindrical(Translation)],
        [Cylindrical(Translation), Schoenflies(Translation)],
        [Schoenflies(Nothing), Identity],
        [TranslationalSpace(Nothing), Identity],
        [TranslationalSpace(Nothing), Spherical],
        [Spherical, TranslationalSpace(Nothing)],
        [TranslationalSpace(Translation), Cylindrical(Translation)],
        [Cylindrical(Translation), TranslationalSpace(Translation)],
        [Inclined, Cylindrical(Translation)],
        [Cylindrical(Translation), Inclined],
    ]
};

/// The pairs of which a section can be examined alone, and bounded: those without an inclined shared translation.
pub const LEVEL: &[[RandomSubspace; 2]] = PAIRS.split_at(39).0;

/// What the subspaces of a pair share, before it is displaced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meet {
    /// A rotation about z.
    Rotation,
    /// A translation along z.
    Translation,
    /// The identity alone.
    Nothing,
}

/// A kind of subspace, placed relative to the intersection motion along or about z, or so that it shares
/// nothing with the other one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RandomSubspace {
    /// No motion.
    Identity,
    /// A plane with its normal along z, or a plane that contains z.
    Planar(Meet),
    /// A sphere with its centre on z.
    Spherical,
    /// A cylinder with its axis along z, parallel to it, or skew to it.
    Cylindrical(Meet),
    /// A translational plane that contains z.
    TranslationalPlane,
    /// All translations. It contains that along z in any case.
    TranslationalSpace(Meet),
    /// A Schoenflies group with its direction along z, or perpendicular to it.
    Schoenflies(Meet),
    /// A Schoenflies group with its direction inclined to z, neither along it nor perpendicular to it.
    Inclined,
}

impl RandomSubspace {
    /// Its number of degrees of freedom.
    pub fn dimension(self) -> usize {
        match self {
            Self::Identity => 0,
            Self::Planar(_) | Self::Spherical | Self::TranslationalSpace(_) => 3,
            Self::Cylindrical(_) | Self::TranslationalPlane => 2,
            Self::Schoenflies(_) | Self::Inclined => 4,
        }
    }

    /// The motion along or about z that it contains.
    fn meet(self) -> Meet {
        match self {
            Self::Identity => Meet::Nothing,
            Self::Planar(meet)
            | Self::Cylindrical(meet)
            | Self::TranslationalSpace(meet)
            | Self::Schoenflies(meet) => meet,
            Self::Spherical => Meet::Rotation,
            Self::TranslationalPlane | Self::Inclined => Meet::Translation,
        }
    }
}

/// A subspace with random geometry.
struct PlacedSubspace {
    kind: RandomSubspace,
    /// Normal of a plane, or axis of a cylinder.
    normal: Vector3<f64>,
    point: Point3<f64>,
}

/// Options for drawing a mechanism.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// The probability with which each coordinate gets limits.
    pub limited: f64,
    /// Whether spherical, universal and cylindrical joints replace revolutes and sliders where they
    /// fit.
    pub balls: bool,
}

/// The kinds of joints in a section of a leg, from base to platform: `RPR`, `UR`, `S`, ...
pub fn order(leg: &Leg, section: &[Freedom]) -> String {
    let mut joints: Vec<usize> = section.iter().map(|freedom| freedom.joint).collect();
    joints.dedup();
    let letter = |&joint: &usize| match leg.joints[joint].kind {
        JointKind::Revolute => 'R',
        JointKind::Prismatic => 'P',
        JointKind::Helical { .. } => 'H',
        JointKind::Cylindrical => 'C',
        JointKind::Universal { .. } => 'U',
        JointKind::Spherical => 'S',
    };
    joints.iter().map(letter).collect()
}

/// Every order of kinds that a section can have, if it has as many freedoms as its subspace, or one
/// less if the imaginary joint takes one.
pub fn orders(kind: RandomSubspace, cut: Option<Meet>) -> &'static [&'static str] {
    use Meet::{Rotation, Translation};
    match (kind, cut) {
        (_, Some(Meet::Nothing)) => &[],
        (RandomSubspace::Identity, _) => &[""],
        (RandomSubspace::Planar(_), None) => &["RRR", "PRR", "RPR", "RRP", "RPP", "PRP", "PPR"],
        (RandomSubspace::Planar(_), Some(Rotation)) => &["RR", "RP", "PR", "PP"],
        (RandomSubspace::Planar(_), Some(Translation)) => &["RR", "RP", "PR"],
        (RandomSubspace::Spherical, None) => &["RRR", "UR", "RU", "S"],
        (RandomSubspace::Spherical, Some(_)) => &["RR", "U"],
        (RandomSubspace::Cylindrical(_), None) => &["RP", "PR", "RH", "HR", "PH", "HP", "HH", "C"],
        (RandomSubspace::Cylindrical(_), Some(Rotation)) => &["P", "H"],
        (RandomSubspace::Cylindrical(_), Some(Translation)) => &["R", "H"],
        (RandomSubspace::TranslationalPlane, None) => &["PP"],
        (RandomSubspace::TranslationalPlane, Some(_)) => &["P"],
        (RandomSubspace::TranslationalSpace(_), None) => &["PPP"],
        (RandomSubspace::TranslationalSpace(_), Some(_)) => &["PP"],
        // A slider more, anywhere; a screw may take its place.
        (RandomSubspace::Schoenflies(_) | RandomSubspace::Inclined, None) => &[
            "PRRR", "RPRR", "RRPR", "RRRP", "PPRR", "PRPR", "PRRP", "RPPR", "RPRP", "RRPP", "PRPP",
            "RPPP", "PPRP", "PPPR",
        ],
        (RandomSubspace::Schoenflies(_), Some(Rotation)) => {
            &["PRR", "RPR", "RRP", "PRP", "RPP", "PPR", "PPP"]
        }
        (RandomSubspace::Inclined, Some(Rotation)) => &[],
        (RandomSubspace::Schoenflies(_) | RandomSubspace::Inclined, Some(Translation)) => {
            &["PRR", "RPR", "RRP", "PRP", "RPP", "PPR"]
        }
    }
}

/// What the two subspaces of a pair share.
pub fn meet([lower, upper]: [RandomSubspace; 2]) -> Meet {
    if lower.meet() == upper.meet() { lower.meet() } else { Meet::Nothing }
}

/// A random mechanism of a pair of subspaces, with its decomposition.
pub fn mechanism(
    rng: &mut Rng,
    pair: [RandomSubspace; 2],
    options: Options,
) -> (Mechanism, Decomposition) {
    let meet = meet(pair);
    let azimuth = rng.f64() * PI;
    let apart = azimuth + 0.5 + rng.f64() * (PI - 1.0);
    let places = [place(rng, pair[0], azimuth), place(rng, pair[1], apart)];
    let displacement = displacement(rng);
    let shared = usize::from(meet != Meet::Nothing);
    let mut legs = Vec::new();
    let mut splits = Vec::new();
    for number in 1..=2 + rng.usize(..3) {
        let cut_above = rng.bool();
        let counts = [
            places[0].kind.dimension() - if cut_above { 0 } else { shared },
            places[1].kind.dimension() - if cut_above { shared } else { 0 },
        ];
        let mut joints = Vec::new();
        let mut split = [Vec::new(), Vec::new()];
        for (section, place) in places.iter().enumerate() {
            let cut = (counts[section] < place.kind.dimension()).then_some(meet);
            for joint in section_joints(rng, place, cut, section == 1, options) {
                for index in 0..joint.freedoms() {
                    split[section].push(Freedom { joint: joints.len(), index });
                }
                let name = format!("{}{number}", (b'a' + joints.len() as u8) as char);
                joints.push(displaced(rng, &joint, name, &displacement, options));
            }
        }
        for joint in &mut joints {
            joint.actuated = rng.f64() < 0.3;
        }
        joints[0].actuated = true;
        let [lower, upper] = split;
        splits.push(LegSplit { lower, upper, imaginary: cut_above && shared == 1, whole: None });
        legs.push(Leg::new(format!("leg{number}"), joints));
    }
    let axis = displacement * Vector3::z_axis();
    let origin = displacement * Point3::origin();
    let [lower, upper] = places.map(|place| place.class(&displacement));
    let intersection = match meet {
        Meet::Rotation => SubspaceClass::Rotation { axis, point: origin },
        Meet::Translation => SubspaceClass::Translation { axis },
        Meet::Nothing => SubspaceClass::Identity,
    };
    let imaginary_joints = splits.iter().filter(|split| split.imaginary).count();
    let decomposition = Decomposition {
        lambda: pair[0].dimension() + pair[1].dimension() - shared,
        mobility: pair[0].dimension() + pair[1].dimension() - shared,
        lower,
        upper,
        intersection,
        legs: splits,
        imaginary_joints,
        first_section_motions: 0,
        upper_mobility: 0,
        constrained: None,
        redundancy: 0,
        deviation: 0.0,
    };
    let mut mechanism = Mechanism {
        name: format!("{pair:?}"),
        legs,
        platform: displacement * Point3::from(vector(rng)),
        differences: Vec::new(),
        task: TaskHints::default(),
        bodies: Default::default(),
        shapes: Default::default(),
        units: Default::default(),
    };
    let classes = [&decomposition.lower, &decomposition.upper];
    let has_height = |class: &&SubspaceClass| matches!(class, SubspaceClass::Schoenflies { .. });
    if classes.iter().any(has_height) && rng.bool() {
        lean(rng, &mut mechanism, &decomposition);
    }
    (mechanism, decomposition)
}

/// How many joints a constraining leg lacks in its lower and in its upper section.
pub const LACKS: [[usize; 2]; 5] = [[1, 0], [0, 1], [2, 0], [0, 2], [1, 1]];

/// A random mechanism of a pair of subspaces whose first leg lacks so many further joints in its lower and in its
/// upper section. With `repeated`, a second leg has the same joints. `None` if the leg that was drawn has too few
/// joints, or some with several freedoms. A joint that carries a height is kept, as a slider along its direction.
pub fn constrained(
    rng: &mut Rng,
    pair: [RandomSubspace; 2],
    lacks: [usize; 2],
    repeated: bool,
    options: Options,
) -> Option<(Mechanism, Decomposition)> {
    let (mut mechanism, mut decomposition) = mechanism(rng, pair, options);
    straighten(&mut mechanism.legs[0], &decomposition.legs[0], &decomposition);
    let (leg, split) = (&mut mechanism.legs[0], &mut decomposition.legs[0]);
    if leg.joints.iter().any(|joint| joint.freedoms() > 1) {
        return None;
    }
    let classes = [&decomposition.lower, &decomposition.upper];
    let sections = [&mut split.lower, &mut split.upper].into_iter().zip(classes);
    for ((section, class), count) in sections.zip(lacks) {
        for _ in 0..count {
            let removable = |i: &usize| !is_lift(leg, section[*i], class);
            let removable: Vec<usize> = (0..section.len()).filter(removable).collect();
            if removable.is_empty() {
                return None;
            }
            section.remove(removable[rng.usize(..removable.len())]);
        }
    }
    if split.lower.len() + split.upper.len() == 0 {
        return None;
    }
    let kept: Vec<usize> = split.lower.iter().chain(&split.upper).map(|f| f.joint).collect();
    leg.joints = kept.iter().map(|&joint| leg.joints[joint].clone()).collect();
    for (number, freedom) in split.lower.iter_mut().chain(&mut split.upper).enumerate() {
        freedom.joint = number;
    }
    if repeated {
        let (mut again, split) = (leg.clone(), split.clone());
        again.name = "again".into();
        for joint in &mut again.joints {
            joint.name = format!("{} again", joint.name);
        }
        mechanism.legs.push(again);
        decomposition.legs.push(split);
    }
    decomposition.mobility = mobility(&mechanism).expect("legs with joints").mobility;
    Some((mechanism, decomposition))
}

/// A random rigid displacement.
pub fn displacement(rng: &mut Rng) -> Isometry3<f64> {
    Isometry3::from_parts(
        Translation3::from(vector(rng) * 2.0),
        UnitQuaternion::from_axis_angle(&direction(rng), rng.f64() * PI),
    )
}

fn place(rng: &mut Rng, kind: RandomSubspace, azimuth: f64) -> PlacedSubspace {
    let side = Vector3::new(azimuth.cos(), azimuth.sin(), 0.0);
    let (normal, point) = match kind {
        RandomSubspace::Identity
        | RandomSubspace::Planar(Meet::Rotation | Meet::Nothing)
        | RandomSubspace::Schoenflies(Meet::Rotation | Meet::Nothing)
        | RandomSubspace::TranslationalSpace(_)
        | RandomSubspace::Cylindrical(Meet::Rotation) => (Vector3::z(), Point3::origin()),
        // Its axis passes z at a distance of one, and is not parallel to any of the planes.
        RandomSubspace::Cylindrical(Meet::Nothing) => {
            (side.cross(&Vector3::z()) * 0.8 + Vector3::z() * 0.6, Point3::from(side))
        }
        RandomSubspace::Planar(Meet::Translation)
        | RandomSubspace::Schoenflies(Meet::Translation)
        | RandomSubspace::TranslationalPlane => (side, Point3::origin()),
        RandomSubspace::Inclined => {
            // 20 to 70 degrees from z, upwards or downwards.
            let angle = (20.0 + 50.0 * rng.f64()).to_radians();
            let up = if rng.bool() { angle.cos() } else { -angle.cos() };
            (side * angle.sin() + Vector3::z() * up, Point3::origin())
        }
        RandomSubspace::Cylindrical(Meet::Translation) => (Vector3::z(), Point3::from(side)),
        RandomSubspace::Spherical => {
            (Vector3::z(), Point3::new(0.0, 0.0, rng.f64() * 2.0 - 1.0 + 3.0 * azimuth))
        }
    };
    PlacedSubspace { kind, normal, point }
}

impl PlacedSubspace {
    fn class(&self, g: &Isometry3<f64>) -> SubspaceClass {
        let normal = Unit::new_normalize(g * self.normal);
        let point = g * self.point;
        match self.kind {
            RandomSubspace::Identity => SubspaceClass::Identity,
            RandomSubspace::Planar(_) => SubspaceClass::Planar { normal },
            RandomSubspace::Spherical => SubspaceClass::Spherical { centre: point },
            RandomSubspace::Cylindrical(_) => SubspaceClass::Cylindrical { axis: normal, point },
            RandomSubspace::TranslationalPlane => SubspaceClass::TranslationalPlane { normal },
            RandomSubspace::TranslationalSpace(_) => SubspaceClass::TranslationalSpace,
            RandomSubspace::Schoenflies(_) | RandomSubspace::Inclined => {
                SubspaceClass::Schoenflies { axis: normal }
            }
        }
    }
}

/// Joints that form a full chain with the imaginary joint, which is last in a lower section and
/// first in an upper one.
fn section_joints(
    rng: &mut Rng,
    place: &PlacedSubspace,
    cut: Option<Meet>,
    upper: bool,
    options: Options,
) -> Vec<Joint> {
    let count = place.kind.dimension() - usize::from(cut.is_some());
    let joint =
        |kind, axis: Vector3<f64>, point| Joint::new("", kind, Unit::new_normalize(axis), point);
    let (revolute, prismatic) = (JointKind::Revolute, JointKind::Prismatic);
    let sign = |rng: &mut Rng| if rng.bool() { 1.0 } else { -1.0 };
    match place.kind {
        RandomSubspace::Identity => vec![],
        RandomSubspace::Spherical if cut.is_none() && options.balls && rng.bool() => {
            vec![joint(JointKind::Spherical, Vector3::z(), place.point)]
        }
        RandomSubspace::Spherical => {
            let mut joints: Vec<Joint> = Vec::new();
            while joints.len() < count {
                let axis = direction(rng).into_inner();
                let before = match joints.last() {
                    Some(last) => last.axis.into_inner(),
                    None if cut.is_some() && upper => Vector3::z(),
                    None => Vector3::zeros(),
                };
                let after = if cut.is_some() && !upper && joints.len() + 1 == count {
                    Vector3::z()
                } else {
                    Vector3::zeros()
                };
                // Neighbouring axes are at least 20 degrees from parallel.
                if before.dot(&axis).abs().max(after.dot(&axis).abs()) < 0.94 {
                    joints.push(joint(revolute, axis, place.point + axis * rng.f64()));
                }
            }
            if options.balls && rng.bool() {
                let first = rng.usize(..count - 1);
                let second = joints.remove(first + 1).axis;
                joints[first] = joint(
                    JointKind::Universal { second },
                    joints[first].axis.into_inner(),
                    place.point,
                );
            }
            joints
        }
        RandomSubspace::Planar(meet) => {
            let (u, v) = beside(&place.normal);
            let mut sliders = usize::from(cut.is_some() && meet == Meet::Translation);
            let mut angles: Vec<f64> = Vec::new();
            if sliders == 1 {
                angles.push(Vector3::z().dot(&v).atan2(Vector3::z().dot(&u)));
            }
            let mut joints = Vec::new();
            while joints.len() < count {
                if sliders < 2 && rng.f64() < 0.4 {
                    let angle = rng.f64() * TAU;
                    if angles.iter().all(|other| (angle - other).sin().abs() > 0.3) {
                        sliders += 1;
                        angles.push(angle);
                        joints.push(joint(
                            prismatic,
                            u * angle.cos() + v * angle.sin(),
                            Point3::origin(),
                        ));
                    }
                } else {
                    let at = u * (rng.f64() * 2.0 - 1.0) + v * (rng.f64() * 2.0 - 1.0);
                    let off = place.normal * rng.f64();
                    joints.push(joint(revolute, place.normal * sign(rng), place.point + at + off));
                }
            }
            joints
        }
        RandomSubspace::Schoenflies(_) | RandomSubspace::Inclined => {
            let plane =
                PlacedSubspace { kind: RandomSubspace::Planar(place.kind.meet()), ..*place };
            let mut joints = section_joints(rng, &plane, cut, upper, options);
            let lift = joint(prismatic, place.normal * sign(rng), Point3::from(vector(rng)));
            joints.insert(rng.usize(..=joints.len()), lift);
            joints
        }
        RandomSubspace::Cylindrical(meet) => {
            // With a revolute imaginary joint the other joint must advance; with a prismatic one it
            // must rotate.
            let kinds: &[JointKind] = match (cut, meet) {
                (Some(_), Meet::Nothing) => {
                    unreachable!("no imaginary joint without a shared motion")
                }
                (Some(_), Meet::Rotation) => &[prismatic, JointKind::Helical { pitch: 0.2 }],
                (Some(_), Meet::Translation) => &[revolute, JointKind::Helical { pitch: 0.2 }],
                (None, _) => &[
                    revolute,
                    prismatic,
                    JointKind::Helical { pitch: -0.3 },
                    JointKind::Helical { pitch: 0.25 },
                ],
            };
            let first = rng.usize(..kinds.len());
            let mut picks = vec![kinds[first]];
            if count == 2 {
                if options.balls && rng.bool() {
                    return vec![joint(
                        JointKind::Cylindrical,
                        place.normal * sign(rng),
                        place.point,
                    )];
                }
                picks.push(kinds[(first + 1 + rng.usize(..kinds.len() - 1)) % kinds.len()]);
            }
            picks
                .into_iter()
                .map(|kind| {
                    let along = place.normal * rng.f64();
                    joint(kind, place.normal * sign(rng), place.point + along)
                })
                .collect()
        }
        RandomSubspace::TranslationalPlane => {
            let other = place.normal.cross(&Vector3::z());
            let first = 0.3 + rng.f64() * 0.9;
            let angles = [first, -0.3 - rng.f64() * 0.9];
            angles[..count]
                .iter()
                .map(|a| {
                    let axis = (other * a.sin() + Vector3::z() * a.cos()) * sign(rng);
                    joint(prismatic, axis, Point3::origin())
                })
                .collect()
        }
        RandomSubspace::TranslationalSpace(_) => loop {
            let mut slides = [Vector3::z(); 3];
            slides[..count].fill_with(|| direction(rng).into_inner());
            // The sliders, and the imaginary one, are well apart from one plane.
            if Matrix3::from_columns(&slides).determinant().abs() > 0.3 {
                let slider = |axis: &Vector3<f64>| joint(prismatic, *axis, Point3::origin());
                break slides[..count].iter().map(slider).collect();
            }
        },
    }
}

fn displaced(
    rng: &mut Rng,
    joint: &Joint,
    name: String,
    g: &Isometry3<f64>,
    options: Options,
) -> Joint {
    let kind = match joint.kind {
        JointKind::Universal { second } => JointKind::Universal { second: g * second },
        kind => kind,
    };
    let mut displaced = Joint::new(name, kind, g * joint.axis, g * joint.point);
    for coordinate in &mut displaced.coordinates {
        coordinate.home = rng.f64() * 2.0 - 1.0;
        if rng.f64() < options.limited {
            let (below, above) = (rng.f64() * 1.5, rng.f64() * 1.5);
            coordinate.limits = Some([coordinate.home - below, coordinate.home + above]);
        }
    }
    displaced
}

/// Two directions that form a right-handed triad with a third one.
pub(crate) fn beside(normal: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
    let base = if normal.x.abs() > 0.9 { Vector3::y() } else { Vector3::x() };
    let u = (base - normal * normal.dot(&base)).normalize();
    (u, normal.cross(&u))
}

/// A direction with uniform distribution on the sphere.
pub fn direction(rng: &mut Rng) -> Unit<Vector3<f64>> {
    loop {
        let v = vector(rng);
        if (0.01..1.0).contains(&v.norm_squared()) {
            return Unit::new_normalize(v);
        }
    }
}

/// A vector with uniform distribution in a cube of side two about the origin.
pub fn vector(rng: &mut Rng) -> Vector3<f64> {
    Vector3::from_fn(|_, _| rng.f64() * 2.0 - 1.0)
}
