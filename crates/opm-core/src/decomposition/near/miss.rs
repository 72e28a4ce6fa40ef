//! How far a joint is from the subspace of its section, in words.

use crate::decomposition::Freedom;
use crate::decomposition::element::{Element, Offset};
use crate::group::subspace::SubspaceClass;
use crate::mechanism::file::FileUnits;
use crate::mechanism::joint::Joint;
use crate::mechanism::leg::{Leg, Section};
use crate::numeric::Quantity;
use std::fmt;

/// An angle (radians) or a distance (metres) too small to be worth a word beside the other one.
const UNTOLD_ANGLE: f64 = 1e-6;
const UNTOLD_DISTANCE: f64 = 1e-8;

/// A joint that misses the subspace in which the other joints of its section move.
#[derive(Clone, Debug, PartialEq)]
pub struct JointMiss {
    /// The name of the joint's leg.
    pub leg: String,
    /// The name of the joint.
    pub joint: String,
    /// The joint's section.
    pub section: Section,
    /// The group in which the other joints of the section move.
    pub subspace: SubspaceClass,
    /// The angle by which the joint's direction is off, radians; infinite if the group has no motion of
    /// this kind.
    pub angle: f64,
    /// The distance of the joint's axis from the point or line that it should pass through, metres.
    pub distance: f64,
    /// The units of the mechanism's file, which [`reason`](Self::reason) is given in.
    pub units: FileUnits,
    element: Option<Element>,
}

impl JointMiss {
    /// How far a joint with some of its freedoms in a section is from the section's group.
    pub(in crate::decomposition) fn new(
        leg: &str,
        joint: &Joint,
        indices: &[usize],
        section: Section,
        subspace: SubspaceClass,
    ) -> Self {
        let none = Offset { angle: f64::INFINITY, distance: 0.0 };
        let offsets = indices.iter().filter_map(|&index| {
            let element = Element::of(joint, index)?;
            Some((element, element.offset(&subspace).unwrap_or(none)))
        });
        let offsets: Vec<_> = offsets.collect();
        let largest =
            |of: fn(&Offset) -> f64| offsets.iter().map(|(_, o)| of(o)).fold(0.0, f64::max);
        let worst =
            offsets.iter().max_by(|(_, a), (_, b)| a.relative(1.0).total_cmp(&b.relative(1.0)));
        Self {
            leg: leg.to_owned(),
            joint: joint.name.clone(),
            section,
            subspace,
            angle: largest(|o| o.angle),
            distance: largest(|o| o.distance),
            units: FileUnits::SI,
            element: worst.map(|(element, _)| *element),
        }
    }

    /// The same, with messages in the units of the mechanism's file.
    pub(in crate::decomposition) fn in_units(self, units: FileUnits) -> Self {
        Self { units, ..self }
    }

    /// The larger one of angle and distance, in radians and characteristic lengths.
    pub(in crate::decomposition) fn relative(&self, length: f64) -> f64 {
        Offset { angle: self.angle, distance: self.distance }.relative(length)
    }

    /// What is wrong with the joint, without its name.
    pub fn reason(&self) -> String {
        use SubspaceClass as Class;
        let angle = || shown(self.angle, Quantity::Angle, self.units);
        let distance = || shown(self.distance, Quantity::Length, self.units);
        let other =
            || format!("it does not move in the {} subspace of the others", self.subspace.name());
        if !self.angle.is_finite() {
            return other();
        }
        if let Some(reason) = self.pitch_reason() {
            return reason;
        }
        match (self.element, &self.subspace) {
            (Some(Element::Ball { .. }), _) => {
                format!("its centre is {} from the centre of the others", distance())
            }
            (_, Class::Spherical { .. }) => {
                format!("its axis passes the centre of the others at {}", distance())
            }
            (
                Some(Element::Slide { .. }),
                Class::Cylindrical { .. } | Class::Translation { .. },
            ) => {
                format!("its direction is {} off the axis of the others", angle())
            }
            (Some(Element::Slide { .. }), _) => {
                format!("its direction is {} off the plane of the others", angle())
            }
            (_, Class::Planar { .. } | Class::PlanarHelical { .. }) => {
                format!("its axis is {} off the normal of the plane of the others", angle())
            }
            (_, Class::Schoenflies { .. }) => {
                format!("its axis is {} off the direction of the others", angle())
            }
            (_, Class::Rotation { .. } | Class::Helical { .. } | Class::Cylindrical { .. }) => {
                let tilted = || format!("its axis is {} off the axis of the others", angle());
                match (self.angle > UNTOLD_ANGLE, self.distance > UNTOLD_DISTANCE) {
                    (true, true) => format!("{} and passes it at {}", tilted(), distance()),
                    (true, false) => tilted(),
                    (false, _) => {
                        format!("its axis passes the axis of the others at {}", distance())
                    }
                }
            }
            (
                _,
                Class::Identity
                | Class::Translation { .. }
                | Class::TranslationalPlane { .. }
                | Class::TranslationalSpace
                | Class::Full,
            ) => other(),
        }
    }
}

impl JointMiss {
    /// What is wrong with a helical joint, if it is the pitch more than the place of its axis.
    fn pitch_reason(&self) -> Option<String> {
        use SubspaceClass as Class;
        let Some(Element::Helix { pitch, .. }) = self.element else { return None };
        let (Class::Helical { pitch: common, .. } | Class::PlanarHelical { pitch: common, .. }) =
            self.subspace
        else {
            return None;
        };
        let off = (pitch - common).abs();
        (off > UNTOLD_DISTANCE && off >= self.distance).then(|| {
            let tilted = match self.angle > UNTOLD_ANGLE {
                true => format!(
                    ", and its axis is {} off",
                    shown(self.angle, Quantity::Angle, self.units)
                ),
                false => String::new(),
            };
            let off = shown(off, Quantity::Length, self.units);
            format!("its pitch differs from that of the others by {off}/rad{tilted}")
        })
    }
}

impl fmt::Display for JointMiss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "joint {} of leg {}: {}", self.joint, self.leg, self.reason())
    }
}

/// A positive number of an SI unit in that of a file: with two decimals and at least two significant digits; with an
/// exponent if it is very small.
pub(in crate::decomposition) fn shown(value: f64, quantity: Quantity, units: FileUnits) -> String {
    /// From here on down, zeros are hard to count.
    const SMALL: f64 = 1e-4;
    let (value, unit) = (value / units.factor(quantity), units.symbol(quantity));
    if value == 0.0 || value >= 1.0 {
        return format!("{value:.2} {unit}");
    }
    let two_digits = format!("{value:.1e}");
    match two_digits.split_once('e').and_then(|(_, exponent)| exponent.parse::<i32>().ok()) {
        Some(exponent) if value >= SMALL => {
            let decimals = usize::try_from(1 - exponent).unwrap_or(2);
            format!("{value:.decimals$} {unit}")
        }
        _ => format!("{two_digits} {unit}"),
    }
}

/// The misses of the joints of a leg that have freedoms in a section.
pub(in crate::decomposition) fn misses_of(
    leg: &Leg,
    freedoms: &[Freedom],
    section: Section,
    subspace: SubspaceClass,
) -> Vec<(usize, JointMiss)> {
    let mut joints: Vec<usize> = freedoms.iter().map(|f| f.joint).collect();
    joints.sort_unstable();
    joints.dedup();
    let miss = |joint: usize| {
        let own = freedoms.iter().filter(|f| f.joint == joint).map(|f| f.index);
        let indices: Vec<usize> = own.collect();
        (joint, JointMiss::new(&leg.name, &leg.joints[joint], &indices, section, subspace))
    };
    joints.into_iter().map(miss).collect()
}
