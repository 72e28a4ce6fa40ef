//! The displacements `v` and `b` of the two sections from the coordinates of a pose.

use super::{Writer, geometry, given, symbol, word};
use crate::library::*;
use crate::trace::{Any, Array, Handle, In, Real, Traced};
use crate::tree::Type;
use opm_core::group::{
    CylindricalMotion, IntersectionMotion, MotionType, PlanarMotion, SubspaceKind,
};
use opm_core::manipulator::Section;
use opm_core::mechanism::OrientationCoordinates;
use opm_core::task::IntersectionAxis;

/// A displacement along the intersection motion.
#[derive(Clone, Copy)]
pub enum Tau {
    Direction(Complex),
    Value(Real),
}

impl Tau {
    pub fn opposite(self) -> Self {
        match self {
            Self::Direction(z) => Self::Direction(conjugate(z)),
            Self::Value(value) => Self::Value(-value),
        }
    }

    pub fn turn(self) -> Complex {
        match self {
            Self::Direction(z) => z,
            Self::Value(value) => unit(value),
        }
    }

    pub fn value(self) -> Real {
        match self {
            Self::Direction(z) => angle(z),
            Self::Value(value) => value,
        }
    }

    /// The displacement of the upper section follows `exp(-I tau)`, that of the lower one `exp(I tau)`.
    pub fn of(self, section: Section) -> Self {
        match section {
            Section::Lower => self,
            Section::Upper => self.opposite(),
        }
    }
}

/// The type of displacements of a kind; `None` for the identity.
pub fn displacement_type(kind: SubspaceKind) -> Option<Type> {
    Some(match kind {
        SubspaceKind::Identity => return None,
        SubspaceKind::Planar => Planar::kind(),
        SubspaceKind::Spherical => Rotation::kind(),
        SubspaceKind::Cylindrical => Cylindrical::kind(),
        SubspaceKind::TranslationalPlane => Complex::kind(),
        SubspaceKind::TranslationalSpace => Vector::kind(),
    })
}

impl Writer<'_> {
    /// The kind of a section's subspace.
    pub fn kind(&self, section: Section) -> SubspaceKind {
        match section {
            Section::Lower => self.task.lower.kind,
            Section::Upper => self.task.upper.kind,
        }
    }

    /// The intersection motion in the frame of a section.
    pub fn intersection(&self, section: Section) -> &IntersectionMotion {
        match section {
            Section::Lower => &self.task.lower_intersection,
            Section::Upper => &self.task.upper_intersection,
        }
    }

    /// What the two subspaces share.
    pub fn shared(&self) -> Option<MotionType> {
        self.task.intersection.as_ref().map(IntersectionAxis::motion_type)
    }

    /// The angles that the orientation of the pose is written with.
    pub fn angles_of_pose(&self) -> OrientationCoordinates {
        self.task.orientation_coordinates()
    }

    /// The numbers of a section's coordinates, without that of a height.
    pub fn numbers(&self, section: Section) -> Vec<usize> {
        let range = match section {
            Section::Lower => 0..self.task.lower_count,
            Section::Upper => self.task.lower_count..self.task.coordinates.len(),
        };
        range.filter(|&i| self.forms.height.is_none_or(|height| height.coordinate != i)).collect()
    }

    /// The orientation with three angles of a pose.
    pub fn orientation_with(&self, angles: [Real; 3]) -> Rotation {
        let [first, second, last] = self.angles_of_pose().to_factors(angles);
        match self.angles_of_pose() {
            OrientationCoordinates::EulerAngles | OrientationCoordinates::TiltTorsion => {
                euler(first, second, last)
            }
            OrientationCoordinates::RollPitchYaw => yaw_pitch_roll(first, second, last),
        }
    }

    /// A coordinate of a section from home.
    pub fn off_home(&self, g: Any, q: Array<Real>, coordinate: usize) -> Real {
        q.at(super::number(coordinate)) - self.home(g, coordinate)
    }

    /// The function that gives the displacement of a section at a pose.
    pub fn displacement(&self, section: Section) {
        let Some(of_type) = displacement_type(self.kind(section)) else { return };
        let numbers = self.numbers(section);
        let names: Vec<&str> = numbers.iter().map(|&i| self.task.coordinates[i].name).collect();
        let (symbol, word, names) = (symbol(section), word(section), names.join(", "));
        let comment = format!("The displacement {symbol} of the {word} sections, for {names}.");
        let function = Traced::new(&format!("{word}_displacement"), &comment);
        let function = function.giving(of_type, |p| {
            let (g, q) = (geometry(p), p.add::<In<[Real]>>("q"));
            self.displacement_value(section, &numbers, g, q)
        });
        self.add(function.without_unused(&["g"]));
    }

    fn displacement_value(
        &self,
        section: Section,
        numbers: &[usize],
        g: Any,
        pose: Array<Real>,
    ) -> Any {
        let q = |i: usize| self.off_home(g, pose, numbers[i]);
        let shared = self.shared();
        let rotates = section == Section::Lower && shared == Some(MotionType::Rotation);
        let upper = section == Section::Upper;
        let translates = upper && shared == Some(MotionType::Translation);
        let turn = |i: usize| unit(q(i));
        match self.kind(section) {
            SubspaceKind::Identity => Any::from(Real::from(0.0)),
            SubspaceKind::Planar if rotates => {
                planar_of(complex_of(1.0, 0.0), complex_of(q(0), q(1))).into()
            }
            SubspaceKind::Planar if translates => planar_of(turn(1), complex_of(0.0, q(0))).into(),
            SubspaceKind::Planar => planar_of(turn(2), complex_of(q(0), q(1))).into(),
            SubspaceKind::Spherical if rotates => tilt(q(0), q(1)).into(),
            SubspaceKind::Spherical => {
                let angles = [0, 1, 2].map(|i| pose.at(super::number(numbers[i])));
                let turned = self.orientation_with(angles);
                match self.forms.home_orientation_inverse {
                    Some(_) => {
                        product(turned, g.member::<Rotation>("home_orientation_inverse")).into()
                    }
                    None => turned.into(),
                }
            }
            SubspaceKind::Cylindrical if rotates => cylindrical_of(0.0, q(0)).into(),
            SubspaceKind::Cylindrical if translates => cylindrical_of(q(0), 0.0).into(),
            SubspaceKind::Cylindrical => cylindrical_of(q(0), q(1)).into(),
            SubspaceKind::TranslationalPlane if upper && shared.is_some() => {
                complex_of(0.0, q(0)).into()
            }
            SubspaceKind::TranslationalPlane => complex_of(q(0), q(1)).into(),
            SubspaceKind::TranslationalSpace if upper && shared.is_some() => {
                vector_of(q(0), q(1), 0.0).into()
            }
            SubspaceKind::TranslationalSpace => vector_of(q(0), q(1), q(2)).into(),
        }
    }

    /// The displacement of a section for the coordinates `q`.
    pub fn displaced(&self, section: Section, g: Any, q: Array<Real>) -> Any {
        self.call_with(&format!("{}_displacement", word(section)), &[("g", g), ("q", q.into())])
    }

    /// The product of a displacement with `exp(I τ)`: on its right for the lower section, on its left for the upper one.
    pub fn shifted(&self, section: Section, g: Any, moved: Any, tau: Tau) -> Any {
        let along = || g.member::<Complex>(&format!("{}_along", word(section)));
        let side = match section {
            Section::Lower => "after",
            Section::Upper => "before",
        };
        let by_turn = |name: &str, rest: &[Any]| {
            self.call(&format!("{name}_{side}"), &[&[moved], rest].concat())
        };
        let cylindrical = || moved.is::<Cylindrical>();
        match self.intersection(section) {
            IntersectionMotion::None(_) => moved,
            IntersectionMotion::Planar(PlanarMotion::Rotation) => {
                by_turn("planar", &given![tau.turn()])
            }
            IntersectionMotion::Planar(PlanarMotion::Translation(_)) => {
                let name = format!("planar_{side}_slide");
                self.call(&name, &given![moved, along(), tau.value()])
            }
            IntersectionMotion::Spherical(_) => by_turn("spherical", &given![tau.turn()]),
            IntersectionMotion::Cylindrical(CylindricalMotion::Rotation) => {
                cylindrical_of(cylindrical().angle + tau.value(), cylindrical().advance).into()
            }
            IntersectionMotion::Cylindrical(CylindricalMotion::Translation) => {
                cylindrical_of(cylindrical().angle, cylindrical().advance + tau.value()).into()
            }
            IntersectionMotion::Translational(_) => {
                (moved.is::<Complex>() + along() * tau.value()).into()
            }
            IntersectionMotion::Spatial(_) => {
                add(moved.is::<Vector>(), tau.value(), vector_of(0.0, 0.0, 1.0)).into()
            }
        }
    }
}
