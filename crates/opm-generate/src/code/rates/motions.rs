//! Rates by the platform's motions, for the steps of forward kinematics: they are those by the coordinates, but for the Euler
//! angles, which are singular where the second one is zero. In the place of these are the rotations about the directions of
//! the section's frame. The rates by the angles follow.

use crate::code::interface::SECTIONS;
use crate::code::*;
use crate::library::*;
use crate::trace::*;
use opm_core::group::{MotionType, SubspaceKind};

impl Writer<'_> {
    /// The section that has the Euler angles of a pose.
    pub fn oriented(&self) -> Option<Section> {
        SECTIONS.into_iter().find(|&section| {
            let tilts = section == Section::Lower && self.shared() == Some(MotionType::Rotation);
            self.kind(section) == SubspaceKind::Spherical && !tilts
        })
    }

    /// Whether forward kinematics take steps that are no changes of the coordinates.
    pub fn turns(&self) -> bool {
        let tied = self.is_whole() && self.dependent();
        self.has_forward() && self.oriented().is_some() && !tied
    }

    /// The number of the first Euler angle among all coordinates.
    pub fn first_angle(&self) -> usize {
        self.oriented().map_or(0, |section| self.numbers(section)[0])
    }

    /// The function of the rates by the motions.
    pub fn motions(&self) {
        let also = match self.dependent() {
            true => ", of joints that legs lack, too, and the coordinates q",
            false => "",
        };
        let comment = format!(
            "The rates of all joints{also}, by the motions of the platform: those of the coordinates, but for the Euler angles, \
             in whose places are rotations about the directions of the section's frame. They have no singular pose. It returns \
             what NAME_jacobian returns."
        );
        self.add(Traced::new("motions", &comment).body(|p| {
            let of_pose = of_pose(p);
            let q = self.dependent().then(|| p.add::<Out<[Real]>>("q"));
            let all = p.add::<Out<[Real]>>("all");
            let locked = self.dependent().then(|| p.add::<Out<[Real]>>("locked"));
            self.rates_body(of_pose, q, all, locked);
            done()
        }));
    }

    /// The Jacobian where no coordinates follow.
    pub fn by_coordinates(&self, (g, pose, mode): (Any, Array<Real>, Bits), jacobian: Array<Real>) {
        name!(status = self.call("motions", &given![g, pose, mode, jacobian]).is::<Int>());
        return_status(status);
        block(|| self.replace_by_angles(pose, &[(jacobian, JOINTS)]));
    }

    /// The rates by all coordinates where some follow, and the rates of those.
    pub fn by_all_coordinates(
        &self,
        (g, pose, mode): (Any, Array<Real>, Bits),
        lacking: usize,
        all: Array<Real>,
        follow: Array<Real>,
    ) {
        let count_of = self.task.coordinates.len();
        let q = Array::<Real>::empty("q", count_of);
        let locked = Array::<Real>::empty("locked", (lacking * count_of).max(1));
        name!(status = self.call("motions", &given![g, pose, mode, q, all, locked]).is::<Int>());
        return_status(status);
        block(|| self.replace_by_angles(q, &[(all, JOINTS), (locked, number(lacking))]));
        self.eliminated(g, lacking, locked, follow);
    }

    /// Replaces the columns of the rotations by those of the angles, in rates with so many rows.
    fn replace_by_angles(&self, q: Array<Real>, rates: &[(Array<Real>, Int)]) {
        let (count_of, first) = (self.task.coordinates.len(), self.first_angle());
        let Some(section) = self.oriented() else { return };
        let [s1, s2, s3] = self.angle_screws(section, q);
        for &(rates, rows) in rates {
            by_angles(rates, rows, number(count_of), number(first), s1, s2, s3);
        }
    }

    /// How many rows there are of joints that legs lack.
    pub fn lacking(&self) -> usize {
        if self.is_whole() {
            let forms = self.forms.legs.iter().filter_map(|leg| leg.whole.as_ref());
            return forms.map(|form| self.lacking_of(form)).sum();
        }
        let legs = 0..self.forms.legs.len();
        let rows = |leg| SECTIONS.map(|section| self.lacking_in(leg, section).len());
        legs.flat_map(rows).sum()
    }
}
