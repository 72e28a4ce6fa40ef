//! Chains on an axis, and chains of sliders.

use super::*;
use crate::trace::closed_forms::{Displaced, write};
use opm_core::chain::cylindrical::{CoaxialJoint, CylindricalChain};
use opm_core::chain::partial::two_in_space;
use opm_core::group::CylindricalDisplacement;
use opm_core::numbers::Plane;

functions! {
    /// Two joints on one axis: two linear equations.
    fn solve_cylindrical_two(c: In<CylindricalTwo>, g: Cylindrical, q1: Out<Real>, q2: Out<Real>) {
        let joints = [c.j1, c.j2].map(|Coaxial { rotation, advance, .. }| CoaxialJoint { rotation, advance });
        let Cylindrical { angle, advance, .. } = g;
        let target = CylindricalDisplacement { angle, advance };
        let found = CylindricalChain::of(joints).coordinates(&target);
        write([q1.into(), q2.into()], found.map(Displaced::Value));
    }

    /// A joint on an axis, at a displacement that the constraint of the leg allows.
    fn solve_cylindrical_one(c: In<CylindricalOne>, g: Cylindrical, q1: Out<Real>) {
        q1.set(c.j1.rotation.is(0.0).choose(g.advance / c.j1.advance, g.angle * c.j1.rotation));
    }

    /// Two sliders in a plane.
    fn solve_translational_pp(c: In<TranslationalPp>, t: Complex, q1: Out<Real>, q2: Out<Real>) {
        write([q1.into(), q2.into()], Plane::along(t, c.d1, c.d2).map(Displaced::Value));
    }

    /// A slider in a plane, at a displacement that the constraint of the leg allows.
    fn solve_translational_p(c: In<TranslationalP>, t: Complex, q1: Out<Real>) {
        q1.set(inner(c.d1, t));
    }

    /// Three sliders in space. Each is computed from the rounded ones after it, so that their sum is the target.
    fn solve_spatial_ppp(
        c: In<SpatialPpp>,
        t: Vector,
        q1: Out<Real>,
        q2: Out<Real>,
        q3: Out<Real>,
    ) {
        name!(normal = cross(c.d1, c.d2), across = cross(normal, c.d1));
        let rest = Vector::empty("rest");
        q3.set(dot(normal, t) / dot(normal, c.d3));
        rest.set(add(t, -q3, c.d3));
        q2.set(dot(across, rest) / dot(across, c.d2));
        q1.set(dot(c.d1, add(rest, -q2, c.d2)));
    }

    /// Two sliders in space, at a displacement that the constraint of the leg allows.
    fn solve_spatial_pp(c: In<SpatialPp>, t: Vector, q1: Out<Real>, q2: Out<Real>) {
        write([q1.into(), q2.into()], two_in_space::<Real, Real>([c.d1, c.d2], t));
    }

    /// A slider in space, at a displacement that the constraints of the leg allow.
    fn solve_spatial_p(c: In<SpatialP>, t: Vector, q1: Out<Real>) {
        q1.set(dot(c.d1, t));
    }
}
