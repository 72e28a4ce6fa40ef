//! Chains about a point.

use super::*;
use crate::trace::closed_forms::write;
use opm_core::chain::partial::{one_about_point, two_about_point};

functions! {
    /// By how much the third axis, at w, is too near to the first one or too far from it.
    fn missed_spherical(c: In<SphericalRrr>, w: Vector) -> Real {
        name!(
            a12 = acos(clamp(dot(c.a1, c.a2), -1.0, 1.0)),
            a23 = acos(clamp(dot(c.a2, c.a3), -1.0, 1.0)),
            arc = acos(clamp(dot(c.a1, w), -1.0, 1.0)),
            farthest = min(a12 + a23, TAU - a12 - a23)
        );
        missed(max(abs(a12 - a23) - arc, arc - farthest))
    }

    /// The other two angles of three revolutes about one point from the first one, a unit vector: where w = R a3 is near
    /// the first axis, q1 and q3 turn about nearly the same one, and q3 must follow from q1. On it q1 is free.
    fn spherical_rest(
        c: In<SphericalRrr>,
        r: Rotation,
        q1: Complex,
        q2: Out<Complex>,
        q3: Out<Complex>,
    ) {
        name!(
            n23 = cross(c.a2, c.a3),
            w = rotated(r, c.a3),
            w1 = rotated_about(c.a1, conjugate(q1), w),
            across = add(c.a3, -dot(c.a2, c.a3), c.a2)
        );
        name!(q = normal(complex_of(dot(across, w1), dot(n23, w1))));
        note("A direction across the third axis, as the first two joints leave it.");
        name!(
            beside = rotated_about(c.a1, conjugate(q1), rotated(r, n23)),
            left = rotated_about(c.a2, conjugate(q), beside)
        );
        q2.set(q);
        q3.set(complex_of(dot(n23, left), dot(cross(c.a3, n23), left)));
    }

    /// Three revolutes about one point: a2 . exp(-a1 q1) w = a2 . a3 with w = R a3, that is A cos q1 + B sin q1 = D. The
    /// sign is that of the triple product T of the displaced axes, with which q2 turns the plane of a2 and a3; q3 is q1
    /// of the reverse chain, whose w is p = R^-1 a1.
    #[inline(always)]
    fn solve_spherical_rrr(
        c: In<SphericalRrr>,
        r: Rotation,
        sign: Real,
        q1: Out<Complex>,
        q2: Out<Complex>,
        q3: Out<Complex>,
    ) -> Real {
        name!(c12 = dot(c.a1, c.a2), c23 = dot(c.a2, c.a3));
        name!(n12 = cross(c.a1, c.a2), n23 = cross(c.a2, c.a3), w = rotated(r, c.a3));
        name!(
            along = dot(c.a1, w),
            A = dot(c.a2, w) - c12 * along,
            B = dot(n12, w),
            D = c23 - c12 * along,
            square = A * A + B * B,
            rest = square - D * D,
            T = sign * sqrt(max(rest, 0.0))
        );
        when(rest.le(0.0) & !abs(D).le(sqrt(square) + REACH), || {
            give(missed_spherical(c, w));
        });
        q1.set(complex_of(A * D + B * T, B * D - A * T));
        when((along * along).lt(BESIDE), || {
            name!(p = vector_of(dot(r.x, c.a1), dot(r.y, c.a1), dot(r.z, c.a1)));
            name!(
                cosine = -dot(n12, n23),
                sine = dot(c.a1, n23),
                E = along - c12 * c23,
                F = dot(c.a2, p) - c23 * along,
                G = dot(n23, p),
                H = c12 - c23 * along
            );
            q2.set(complex_of(cosine * E + sine * T, sine * E - cosine * T));
            q3.set(complex_of(F * H + G * T, G * H - F * T));
        })
        .otherwise(|| {
            q1.set(square.gt(REACH * REACH).choose(normal(q1), complex_of(1.0, 0.0)));
            spherical_rest(c, r, q1, q2, q3);
        });
        0.0
    }

    /// Two revolutes about one point, at a rotation that the constraint of the leg allows.
    fn solve_spherical_rr(c: In<SphericalRr>, r: Rotation, q1: Out<Complex>, q2: Out<Complex>) {
        write([q1.into(), q2.into()], two_about_point::<Real, Real>([c.a1, c.a2], r));
    }

    /// A revolute, at a rotation that the constraints of the leg allow: the trace is 1 + 2 cos q, the axial vector a sin
    /// q.
    fn solve_spherical_r(c: In<SphericalR>, r: Rotation, q1: Out<Complex>) {
        write([q1.into()], [one_about_point::<Real, Real>(c.a1, r)]);
    }

    /// What a rotation vector is of its axis, which has the sine of half the angle as its length.
    #[inline]
    fn turned(half: Real, sine: Real) -> Real {
        2.0 * half / sine.gt(0.0).choose(sine, 1.0)
    }

    /// The rotation vector of a spherical joint, from the axis and half the angle that its closed form gives.
    #[inline]
    fn rotation_vector(axis: Vector, half: Complex) -> Vector {
        add(vector_of(0.0, 0.0, 0.0), turned(angle(half), half.im), axis)
    }

    /// A spherical joint: the axis of the rotation, in base coordinates, and half its angle, of at most a right angle, as
    /// a direction that has the length of the axis as its sine. The entries of R give four multiples of its quaternion,
    /// of which the longest is used.
    #[inline(always)]
    fn solve_spherical_s(
        c: In<SphericalS>,
        r: Rotation,
        q1: Out<Real>,
        q2: Out<Real>,
        q3: Out<Real>,
        half: Out<Complex>,
    ) {
        name!(
            wx = r.y.z - r.z.y,
            wy = r.z.x - r.x.z,
            wz = r.x.y - r.y.x,
            xy = r.y.x + r.x.y,
            xz = r.z.x + r.x.z,
            yz = r.z.y + r.y.z,
            ww = 1.0 + (r.x.x + r.y.y + r.z.z),
            xx = 1.0 + (r.x.x - r.y.y - r.z.z),
            yy = 1.0 + (r.y.y - r.x.x - r.z.z),
            zz = 1.0 + (r.z.z - r.x.x - r.y.y)
        );
        name!(axis = vector_of(wx, wy, wz));
        name!(w = ww, longest = ww);
        let sense = Real::empty("sense");
        when(xx.gt(longest), || {
            longest.set(xx);
            w.set(wx);
            axis.set(vector_of(xx, xy, xz));
        });
        when(yy.gt(longest), || {
            longest.set(yy);
            w.set(wy);
            axis.set(vector_of(xy, yy, yz));
        });
        when(zz.gt(longest), || {
            w.set(wz);
            axis.set(vector_of(xz, yz, zz));
        });
        half.set(complex_of(abs(w), sqrt(dot(axis, axis))));
        sense.set(w.lt(0.0).choose(-1.0, 1.0));
        axis.set(rotated(c.axes, axis));
        q1.set(axis.x * sense);
        q2.set(axis.y * sense);
        q3.set(axis.z * sense);
    }
}
