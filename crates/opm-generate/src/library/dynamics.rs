//! Bodies that move: their screws, and what resists their acceleration.

use super::*;

structs! {
    /// A screw, a twist, or the rate of one: rotation, and the velocity of the point that it is about. Of forces: their
    /// moment about that point, and their sum.
    Screw { angular: Vector, linear: Vector }
    /// A tensor of inertia: its entries.
    Inertia { xx: Real, yy: Real, zz: Real, xy: Real, xz: Real, yz: Real }
    /// A body at home, base coordinates: its mass, kg, its centre of mass, and its inertia about that, kg m^2.
    Mass { mass: Real, centre: Vector, inertia: Inertia }
    /// What drives a joint: the inertia of the rotor, kg m^2, how much faster than the joint it turns, and friction in proportion
    /// to the rate, and whatever the rate is.
    Drive { rotor_inertia: Real, gear: Real, viscous: Real, coulomb: Real }
}

functions! {
    #[inline]
    fn screw_of(angular: Vector, linear: Vector) -> Screw {
        Screw::made(angular, linear)
    }

    /// a + s b
    #[inline]
    fn add_screw(a: Screw, s: Real, b: Screw) -> Screw {
        screw_of(add(a.angular, s, b.angular), add(a.linear, s, b.linear))
    }

    /// The rate of the screw b that moves with the twist a.
    #[inline]
    fn bracket(a: Screw, b: Screw) -> Screw {
        screw_of(
            cross(a.angular, b.angular),
            add(cross(a.angular, b.linear), 1.0, cross(a.linear, b.angular)),
        )
    }

    /// The work of a force for a twist.
    #[inline]
    fn work_of(force: Screw, twist: Screw) -> Real {
        dot(force.angular, twist.angular) + dot(force.linear, twist.linear)
    }

    /// A screw about the origin after a displacement, about a point.
    fn displaced_screw(g: Body, s: Screw, point: Vector) -> Screw {
        name!(turn = rotated(g.rotation, s.angular));
        name!(arm = add(point, -1.0, g.translation));
        screw_of(turn, add(rotated(g.rotation, s.linear), 1.0, cross(turn, arm)))
    }

    /// The displacement exp(q s) of a screw about the origin: of a unit rotation with an advance, or of a unit translation.
    fn screw_motion(s: In<Screw>, q: Real) -> Body {
        name!(turns = dot(s.angular, s.angular).gt(0.5).choose(1.0, 0.0));
        name!(rotation = rotation_about(s.angular, unit(turns * q)));
        name!(centre = cross(s.angular, s.linear), pitch = dot(s.angular, s.linear));
        name!(fixed = add(centre, -1.0, rotated(rotation, centre)));
        name!(advance = add(add(fixed, pitch * q, s.angular), (1.0 - turns) * q, s.linear));
        Body::made(rotation, advance)
    }

    /// Adds a screw to a column of a matrix, lengths over a unit.
    fn add_column(a: Out<[Real]>, place: Int, width: Int, s: Screw, by: Real, length: Real) {
        name!(share = by / length);
        a.at(place).increase(by * s.angular.x);
        a.at(place + width).increase(by * s.angular.y);
        a.at(place + 2 * width).increase(by * s.angular.z);
        a.at(place + 3 * width).increase(share * s.linear.x);
        a.at(place + 4 * width).increase(share * s.linear.y);
        a.at(place + 5 * width).increase(share * s.linear.z);
    }

    /// I w
    #[inline]
    fn inertia_times(i: Inertia, w: Vector) -> Vector {
        vector_of(
            i.xx * w.x + i.xy * w.y + i.xz * w.z,
            i.xy * w.x + i.yy * w.y + i.yz * w.z,
            i.xz * w.x + i.yz * w.y + i.zz * w.z,
        )
    }

    /// The weight of a body, and what resists its acceleration, about a point: `m (gravity - a)` and `-I alpha - w x I w`.
    fn resistance(m: In<Mass>, g: Body, twist: Screw, rate: Screw, gravity: Vector, point: Vector) -> Screw {
        name!(back = transposed(g.rotation), w = rotated(back, twist.angular));
        name!(turning = inertia_times(m.inertia, rotated(back, rate.angular)));
        name!(gyroscopic = cross(w, inertia_times(m.inertia, w)));
        name!(arm = add(add(g.translation, 1.0, rotated(g.rotation, m.centre)), -1.0, point));
        name!(velocity = add(twist.linear, 1.0, cross(twist.angular, arm)));
        name!(acceleration = add(rate.linear, 1.0, cross(rate.angular, arm)));
        acceleration.set(add(acceleration, 1.0, cross(twist.angular, velocity)));
        name!(force = add(vector_of(0.0, 0.0, 0.0), m.mass, add(gravity, -1.0, acceleration)));
        name!(moment = rotated(g.rotation, add(turning, 1.0, gyroscopic)));
        screw_of(add(cross(arm, force), -1.0, moment), force)
    }

    /// What a drive needs by itself.
    fn drive_effort(d: In<Drive>, rate: Real, acceleration: Real) -> Real {
        name!(dry = rate.gt(0.0).choose(d.coulomb, rate.lt(0.0).choose(-d.coulomb, 0.0)));
        d.rotor_inertia * d.gear * d.gear * acceleration + d.viscous * rate + dry
    }
}
