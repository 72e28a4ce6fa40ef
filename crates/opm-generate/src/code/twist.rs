//! The function of the platform's twist.

use super::interface::Start;
use super::rates::Columns;
use super::*;
use crate::library::*;
use crate::trace::*;
use opm_core::group::SubspaceKind;

impl Writer<'_> {
    /// The function of the platform's twist for unit rates of the coordinates: with `g = v b`, what moves `v` moves the
    /// platform where it is, and what moves `b` moves it before `v` does.
    pub fn twist(&self) {
        let function = Traced::new(
            "twist",
            "The platform's twist for unit rates of the coordinates of the pose: the rows of the angular velocity x, y, z and of \
             the velocity of the reference point x, y, z, base coordinates. It returns what NAME_transform returns; what \
             NAME_jacobian returns, where coordinates follow from those of the pose.",
        );
        let independent = self.manipulator.task_coordinates().len();
        self.add(function.public().body(|p| {
            let of_pose = of_pose(p);
            let twist = written(p, "twist", 6 * independent);
            self.twist_body(of_pose, twist)
        }));
    }

    fn twist_body(&self, of_pose: (Any, Array<Real>, Bits), twist: Array<Real>) -> Int {
        let (g, pose, mode) = of_pose;
        let count_of = self.task.coordinates.len();
        let needs = self.needs_of_platform();
        let t = Array::<Twists>::empty("t", count_of);
        let sums = self.dependent().then(|| {
            let joints = self.fields.len() * count_of;
            [("all", 6 * count_of), ("joints", joints), ("follow", self.follow_rates())]
                .map(|(name, length)| Array::<Real>::empty(name, length))
        });
        let start = self.start_or_return(of_pose, needs, None);
        if let Some([_, joints, follow]) = sums {
            let call = self.call("differentiate", &given![g, pose, mode, joints, follow]);
            start.status.set(call.is::<Int>());
            return_status(start.status);
        }
        self.columns(Columns::Coordinates, g, start.q, t);
        let output = sums.map_or(twist, |[all, ..]| all);
        self.moved_by(g, &start, t, |i, w, velocity| {
            let parts = [w.x, w.y, w.z, velocity.x, velocity.y, velocity.z];
            for (place, part) in parts.into_iter().enumerate() {
                output.at(number(place * count_of) + i).set(part);
            }
        });
        if let Some([all, _, follow]) = sums {
            self.call("by_pose", &given![all, Int::from(6), follow, twist]);
        }
        done()
    }

    /// Gives the angular velocity of the platform, and the velocity of its reference point, for a unit of each column; and where
    /// that point is.
    pub fn moved_by(
        &self,
        g: Any,
        start: &Start,
        t: Array<Twists>,
        give: impl FnOnce(Int, Vector, Vector),
    ) -> Vector {
        let count_of = self.task.coordinates.len();
        let lower = Body::empty("lower");
        let upper = start.get("b").map(|_| Body::empty("upper"));
        let (before, point) = (Vector::empty("before"), Vector::empty("point"));
        if let Some(v) = start.get("v") {
            lower.set(self.body_of(Section::Lower, g, v));
        }
        let platform: Vector = g.member("platform");
        if let (Some(upper), Some(b)) = (upper, start.get("b")) {
            upper.set(self.body_of(Section::Upper, g, b));
            before.set(add(upper.translation, 1.0, rotated(upper.rotation, platform)));
        } else {
            before.set(platform);
        }
        point.set(add(lower.translation, 1.0, rotated(lower.rotation, before)));
        let up = self.forms.height.map(|height| {
            let up = self.frame(height.section, g).axes.z;
            match height.section {
                Section::Lower => up,
                Section::Upper => rotated(lower.rotation, up),
            }
        });
        if let (Some(up), Some(rise)) = (up, start.get("rise")) {
            point.set(add(point, rise.is::<Real>(), up));
        }
        count("i", 0, number(count_of), |i| {
            let of_column = t.at(i);
            let (frame, [of_w, of_v]) =
                (self.frame(Section::Lower, g), self.embedded(Section::Lower, of_column.lower));
            name!(w = rotated(frame.axes, of_w), velocity = velocity_at(frame, of_w, of_v, point));
            if upper.is_some() {
                let (frame, [of_w, of_v]) =
                    (self.frame(Section::Upper, g), self.embedded(Section::Upper, of_column.upper));
                w.set(add(w, 1.0, rotated(lower.rotation, rotated(frame.axes, of_w))));
                let moved = velocity_at(frame, of_w, of_v, before);
                velocity.set(add(velocity, 1.0, rotated(lower.rotation, moved)));
            }
            if let Some(up) = up {
                velocity.set(add(velocity, of_column.rise, up));
            }
            give(i, w, velocity);
        });
        point
    }

    /// The angular velocity and the velocity of a section's origin, in its frame, of a twist.
    fn embedded(&self, section: Section, t: Vector) -> [Vector; 2] {
        let zero = || vector_of(0.0, 0.0, 0.0);
        match self.kind(section) {
            SubspaceKind::Identity => [zero(), zero()],
            SubspaceKind::Planar => [vector_of(0.0, 0.0, t.x), vector_of(t.y, t.z, 0.0)],
            SubspaceKind::Spherical => [t, zero()],
            SubspaceKind::Cylindrical => [vector_of(0.0, 0.0, t.x), vector_of(0.0, 0.0, t.y)],
            SubspaceKind::TranslationalPlane => [zero(), vector_of(t.x, t.y, 0.0)],
            SubspaceKind::TranslationalSpace => [zero(), t],
        }
    }
}
