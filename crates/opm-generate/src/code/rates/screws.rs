//! The screws of coordinates, of the joints of a section at a pose, and of the intersection motion, and their reciprocal
//! screws.

use super::Columns;
use crate::code::displacement::Tau;
use crate::code::geometry::{chain, free};

use crate::code::*;
use crate::library::*;
use crate::trace::*;
use opm_core::chain::planar::PlanarJoint;
use opm_core::group::{
    CylindricalMotion, IntersectionMotion, MotionType, PlanarMotion, SubspaceKind,
};
use opm_core::manipulator::form::SectionForm;
use opm_core::mechanism::OrientationCoordinates;

fn zero() -> Vector {
    vector_of(0.0, 0.0, 0.0)
}

/// The unit vector of a direction.
fn axis(place: usize) -> Vector {
    let [x, y, z] = [0, 1, 2].map(|i| if i == place { 1.0 } else { 0.0 });
    vector_of(x, y, z)
}

/// The reciprocal screws of a section, and its free joints in their order.
pub struct SectionRows {
    screws: Option<Screws>,
    pub free: Vec<usize>,
    lacking: Vec<usize>,
    /// The displaced screw of a lift that leans.
    pub leaning: Option<Vector>,
}

impl SectionRows {
    /// Whether there are rates that they give.
    pub fn has_any(&self) -> bool {
        !self.free.is_empty() || !self.lacking.is_empty()
    }

    /// All rows.
    pub fn rows(&self) -> impl Iterator<Item = Vector> {
        self.screws.into_iter().flat_map(|screws| [screws.s1, screws.s2, screws.s3])
    }

    /// The rows of joints that the section lacks.
    pub fn lacking(&self) -> impl Iterator<Item = Vector> {
        let rows: Vec<Vector> = self.rows().collect();
        self.lacking.iter().map(move |&row| rows[row])
    }
}

impl Writer<'_> {
    /// The screws of a section's coordinates.
    pub fn coordinate_screws(
        &self,
        section: Section,
        columns: Columns,
        g: Any,
        pose: Array<Real>,
    ) -> Vec<Vector> {
        let numbers = self.numbers(section);
        let q = |i: usize| self.off_home(g, pose, numbers[i]);
        let axes = |places: &[usize]| places.iter().map(|&place| axis(place)).collect();
        let (shared, upper) = (self.shared(), section == Section::Upper);
        let rotates = !upper && shared == Some(MotionType::Rotation);
        let translates = upper && shared == Some(MotionType::Translation);
        match self.kind(section) {
            SubspaceKind::Identity => Vec::new(),
            SubspaceKind::Planar if rotates => axes(&[1, 2]),
            SubspaceKind::Planar if translates => vec![axis(2), vector_of(1.0, q(0), 0.0)],
            SubspaceKind::Planar => vec![axis(1), axis(2), vector_of(1.0, q(1), -q(0))],
            SubspaceKind::Spherical if rotates => {
                name!(tilted = unit(q(0)));
                vec![axis(0), vector_of(0.0, tilted.re, tilted.im)]
            }
            SubspaceKind::Spherical => match columns {
                Columns::Motions => axes(&[0, 1, 2]),
                Columns::Coordinates => self.angle_screws(section, pose).into(),
            },
            SubspaceKind::Cylindrical if rotates => axes(&[1]),
            SubspaceKind::Cylindrical if translates => axes(&[0]),
            SubspaceKind::Cylindrical => axes(&[0, 1]),
            SubspaceKind::TranslationalPlane if shared.is_some() && upper => axes(&[1]),
            SubspaceKind::TranslationalPlane => axes(&[0, 1]),
            SubspaceKind::TranslationalSpace if shared.is_some() && upper => axes(&[0, 1]),
            SubspaceKind::TranslationalSpace => axes(&[0, 1, 2]),
        }
    }

    /// The screws of the three angles of a section's orientation.
    pub fn angle_screws(&self, section: Section, q: Array<Real>) -> [Vector; 3] {
        let numbers = self.numbers(section);
        let q = |i: usize| q.at(number(numbers[i]));
        let name = format!("{}_angles", word(section));
        match self.angles_of_pose() {
            OrientationCoordinates::EulerAngles => {
                let Screws { s1, s2, s3, .. } = named(&name, euler_screws(q(0), q(1)));
                [s1, s2, s3]
            }
            // The third Euler angle is the torsion minus the azimuth.
            OrientationCoordinates::TiltTorsion => {
                let Screws { s1, s2, s3, .. } = named(&name, euler_screws(q(0), q(1)));
                [add(s1, -1.0, s3), s2, s3]
            }
            OrientationCoordinates::RollPitchYaw => {
                let Screws { s1, s2, s3, .. } = named(&name, yaw_pitch_roll_screws(q(2), q(1)));
                [s3, s2, s1]
            }
        }
    }

    /// The unit twist of the intersection motion in the frame of a section.
    fn along(&self, section: Section, g: Any) -> Vector {
        let along = || g.member::<Complex>(&format!("{}_along", word(section)));
        match self.intersection(section) {
            IntersectionMotion::None(_) => zero(),
            IntersectionMotion::Planar(PlanarMotion::Rotation)
            | IntersectionMotion::Cylindrical(CylindricalMotion::Rotation) => axis(0),
            IntersectionMotion::Cylindrical(CylindricalMotion::Translation) => axis(1),
            IntersectionMotion::Planar(PlanarMotion::Translation(_)) => slider_screw(along()),
            IntersectionMotion::Translational(_) => vector_of(along().re, along().im, 0.0),
            IntersectionMotion::Spherical(_) | IntersectionMotion::Spatial(_) => axis(2),
        }
    }

    /// The displacement along the intersection motion of a leg: a direction of length one, or a number.
    fn tau_value(&self, leg: usize, at: Any) -> Tau {
        match self.tau_at(at, leg) {
            Some(Tau::Direction(z)) => Tau::Direction(normal(z)),
            Some(tau) => tau,
            None => Tau::Value(Real::from(0.0)),
        }
    }

    /// The displacement of a revolute joint before others of its chain, from home.
    fn turned_by(&self, leg: usize, form: &SectionForm, joint: usize, at: Any) -> Complex {
        match form.coordinates[joint] {
            Some(coordinate) => at.member(&self.fields[coordinate]),
            None => self.tau_value(leg, at).turn(),
        }
    }

    /// The displacement of a slider before others of its chain, from home.
    fn slid_by(&self, leg: usize, form: &SectionForm, joint: usize, g: Any, at: Any) -> Real {
        let Some(coordinate) = form.coordinates[joint] else {
            let value = self.tau_value(leg, at).value();
            let part = form.slider.is_some_and(|(slider, _)| slider == joint);
            let rate = || g.member::<Part>(&format!("leg{}_part", leg + 1)).rate;
            return if part { value * rate() } else { value };
        };
        at.member(&self.fields[coordinate])
    }

    /// The numbers of the rows of joints that a section of a leg lacks.
    pub fn lacking_in(&self, leg: usize, section: Section) -> Vec<usize> {
        let form = self.forms.legs[leg].section(section);
        let own = match (self.kind(section), &form.chain) {
            (SubspaceKind::Identity, _) | (_, Chain::Ball(_)) => 3,
            // The third dimension of two is none that could be lacking.
            (SubspaceKind::Cylindrical | SubspaceKind::TranslationalPlane, _) => {
                free(form).len() + 1
            }
            _ => free(form).len(),
        };
        (own..3).collect()
    }

    /// The reciprocal screws of a section of a leg.
    pub fn section_rows(&self, leg: usize, section: Section, g: Any, at: Any) -> SectionRows {
        let form = self.forms.legs[leg].section(section);
        let kind = self.kind(section);
        let lacking = self.lacking_in(leg, section);
        let mut rows = SectionRows { screws: None, free: free(form), lacking, leaning: None };
        if kind == SubspaceKind::Identity {
            return rows;
        }
        let own = chain(form).map(|(kind, _)| {
            g.part(&format!("leg{}_{}", leg + 1, word(section)), Type::Struct(kind))
        });
        if let (Chain::Ball(_), Some(own)) = (&form.chain, own) {
            let screws = Screws::empty(word(section));
            rows.screws = Some(screws);
            let (axis, half) = self.ball_at(at, leg, section);
            let axes = own.is::<SphericalS>().axes;
            rotation_vector_rates(axes, rotation_vector(axis, half), screws);
            return rows;
        }
        let known = 3 - rows.lacking.len();
        let rest = |row: usize| if row < known { axis(2) } else { zero() };
        let mut own_screws = Vec::new();
        match (&form.chain, own) {
            (Chain::Planar(chain), _) => {
                let items = self.planar_items(leg, section, &chain.joints(), (g, own, at));
                if items.len() > 1 {
                    self.planar_screws(section, items, &mut rows);
                } else {
                    for (is_lift, screw, _) in items {
                        match is_lift {
                            true => rows.leaning = Some(named("leaning", screw)),
                            false => own_screws.push(screw),
                        }
                    }
                }
            }
            (_, Some(own)) => own_screws = self.other_screws(leg, section, own, at),
            (_, None) => {}
        }
        let screws = match rows.screws {
            Some(screws) => {
                for (row, target) in rows.rows().enumerate().skip(rows.free.len()) {
                    target.set(rest(row));
                }
                screws
            }
            None => {
                own_screws.extend((own_screws.len()..3).map(rest));
                let made = Screws::made(own_screws[0], own_screws[1], own_screws[2]);
                *rows.screws.insert(named(word(section), made))
            }
        };
        let unit = match kind {
            SubspaceKind::Planar | SubspaceKind::Cylindrical => g.member("size"),
            _ => Real::from(1.0),
        };
        when(reciprocal(screws, number(known), unit).is_set(), || give(1));
        rows
    }

    /// The joints of a planar chain: whether each is a lift that leans, its screw at home, and its motion.
    fn planar_items(
        &self,
        leg: usize,
        section: Section,
        joints: &[PlanarJoint; 3],
        (g, chain, at): (Any, Option<Any>, Any),
    ) -> Vec<(bool, Vector, Planar)> {
        let (form, of_leg) = (self.forms.legs[leg].section(section), &self.forms.legs[leg]);
        let free = free(form);
        let item = |(place, &joint): (usize, &usize)| {
            let chain = chain?;
            let (screw, motion) = match joints[joint] {
                PlanarJoint::Revolute { .. } => {
                    let pivot: Pivot = chain.member(&format!("p{place}"));
                    let q = self.turned_by(leg, form, joint, at);
                    (pivot_screw(pivot), pivot_motion(pivot, q))
                }
                PlanarJoint::Prismatic { .. } => {
                    let slider: Complex = chain.member(&format!("d{place}"));
                    let q = self.slid_by(leg, form, joint, g, at);
                    (slider_screw(slider), slider_motion(slider, q))
                }
            };
            Some((false, screw, motion))
        };
        let mut items: Vec<_> = (1..).zip(&free).filter_map(item).collect();
        let lift = of_leg.lift.as_ref().and_then(|lift| Some((lift.coordinate, lift.lean?)));
        if let Some((coordinate, lean)) = lift.filter(|(_, lean)| lean.section == section) {
            let lift: LeaningLift = g.member(&format!("leg{}_lift", leg + 1));
            let before = free.iter().filter(|&&joint| joint < lean.before).count();
            let screw = vector_of(lift.rotation, lift.velocity.re, lift.velocity.im);
            let rise = at.member::<Real>(&self.fields[coordinate]) / lift.rate;
            items.insert(before, (true, screw, leaned(lift, rise)));
        }
        items
    }

    /// The displaced screws of a planar chain: what is before a joint displaces its screw.
    fn planar_screws(
        &self,
        section: Section,
        items: Vec<(bool, Vector, Planar)>,
        rows: &mut SectionRows,
    ) {
        rows.screws = Some(Screws::empty(word(section)));
        let all: Vec<Vector> = rows.rows().collect();
        let (mut targets, mut moved) = (all.into_iter(), None);
        let last = items.len() - 1;
        for (place, (is_lift, screw, motion)) in items.into_iter().enumerate() {
            let screw = moved.map_or(screw, |moved: Planar| planar_adjoint(moved, screw));
            if is_lift {
                rows.leaning = Some(named("leaning", screw));
            } else if let Some(target) = targets.next() {
                target.set(screw);
            }
            match moved {
                _ if place == last => {}
                None => moved = Some(named(&format!("{}_moved", word(section)), motion)),
                Some(moved) => moved.set(planar_product(moved, motion)),
            }
        }
    }

    /// The displaced screws of the other chains.
    fn other_screws(&self, leg: usize, section: Section, chain: Any, at: Any) -> Vec<Vector> {
        let form = self.forms.legs[leg].section(section);
        let free = free(form);
        let turn = |place: usize| {
            let joint = free[place - 1];
            let q = self.turned_by(leg, form, joint, at);
            if form.coordinates[joint].is_some() { normal(q) } else { q }
        };
        let screw = |place: usize| match &form.chain {
            Chain::Spherical(_) => {
                let axis = |place: usize| chain.member::<Vector>(&format!("a{place}"));
                let about = |screw, before| rotated_about(axis(before), turn(before), screw);
                (1..place).rev().fold(axis(place), about)
            }
            Chain::Cylindrical(_) => {
                let joint: Coaxial = chain.member(&format!("j{place}"));
                vector_of(joint.rotation, joint.advance, 0.0)
            }
            Chain::Translational(_) => {
                let slider: Complex = chain.member(&format!("d{place}"));
                vector_of(slider.re, slider.im, 0.0)
            }
            Chain::Spatial(_) => chain.member(&format!("d{place}")),
            Chain::Rigid | Chain::Part(_) | Chain::Ball(_) | Chain::Planar(_) => zero(),
        };
        (1..=free.len()).map(screw).collect()
    }

    /// The intersection motion as a twist of the second section.
    pub fn along_moved(&self, section: Section, g: Any, v: Any) -> Vector {
        let along = self.along(section, g);
        match (section, self.kind(section)) {
            (Section::Lower, SubspaceKind::Planar) => planar_adjoint(v.is::<Planar>(), along),
            (Section::Lower, SubspaceKind::Spherical) => rotated(v.is::<Rotation>(), along),
            _ => along,
        }
    }

    /// A twist of the upper section after the displacement `exp(-I tau)`.
    pub fn shifted_back(&self, leg: usize, g: Any, at: Any, twist: Vector) -> Vector {
        let back = || conjugate(self.tau_value(leg, at).turn());
        match self.intersection(Section::Upper) {
            IntersectionMotion::Planar(PlanarMotion::Rotation) => {
                planar_adjoint(planar_of(back(), complex_of(0.0, 0.0)), twist)
            }
            IntersectionMotion::Planar(PlanarMotion::Translation(_)) => {
                let along: Complex = g.member("upper_along");
                planar_adjoint(slider_motion(along, -self.tau_value(leg, at).value()), twist)
            }
            IntersectionMotion::Spherical(_) => rotated_about(axis(2), back(), twist),
            IntersectionMotion::None(_)
            | IntersectionMotion::Cylindrical(_)
            | IntersectionMotion::Translational(_)
            | IntersectionMotion::Spatial(_) => twist,
        }
    }
}
