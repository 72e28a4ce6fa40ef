//! What a leg demands that constrains the platform, and the coordinates that follow from it.

use super::*;
use crate::trace::closed_forms::displacement;
use opm_core::chain::condition::Condition;
use opm_core::group::Displacement;

/// The value of a condition on a displacement of a plane.
fn in_plane(condition: &Condition<Real>, g: Planar) -> Real {
    condition.value(&Displacement::Planar(displacement(g)))
}

functions! {
    /// The difference of the squared distances.
    #[inline]
    fn value_circle(c: In<Circle>, g: Planar) -> Real {
        let Circle { point, centre, radius, .. } = c;
        in_plane(&Condition::Circle { point, centre, radius }, g)
    }

    #[inline]
    fn value_line(c: In<Line>, g: Planar) -> Real {
        let Line { point, normal, offset, .. } = c;
        in_plane(&Condition::Line { point, normal, offset }, g)
    }

    #[inline]
    fn value_carried_line(c: In<CarriedLine>, g: Planar) -> Real {
        let CarriedLine { point, normal, offset, .. } = c;
        in_plane(&Condition::CarriedLine { point, normal, offset }, g)
    }

    /// The sine of the angle between the rotations.
    #[inline]
    fn value_heading(c: In<Heading>, g: Planar) -> Real {
        in_plane(&Condition::Heading { rotation: c.rotation }, g)
    }

    #[inline]
    fn value_cone(c: In<Cone>, r: Rotation) -> Real {
        let Cone { fixed, carried, cosine, .. } = c;
        Condition::Cone { fixed, carried, cosine }.value::<Real>(&Displacement::Spherical(r))
    }

    #[inline]
    fn value_flat(c: In<Flat>, sum: Vector) -> Real {
        let Flat { normal, value, .. } = c;
        Condition::Flat { normal, value }.value::<Real>(&Displacement::Spatial(sum))
    }

    /// How far a condition is missed that has a value.
    fn missed_circle(c: In<Circle>, value: Real) -> Real {
        missed(abs(sqrt(max(c.radius * c.radius + value, 0.0)) - c.radius))
    }

    fn missed_line(c: In<Line>, value: Real) -> Real {
        missed(abs(value))
    }

    fn missed_carried_line(c: In<CarriedLine>, value: Real) -> Real {
        missed(abs(value))
    }

    fn missed_heading(c: In<Heading>, value: Real) -> Real {
        missed(abs(asin(clamp(value, -1.0, 1.0))))
    }

    fn missed_cone(c: In<Cone>, value: Real) -> Real {
        name!(other = acos(clamp(c.cosine + value, -1.0, 1.0)));
        missed(abs(other - acos(clamp(c.cosine, -1.0, 1.0))))
    }

    fn missed_flat(c: In<Flat>, value: Real) -> Real {
        missed(abs(value))
    }

    /// The zero u of c0 + c1 cos u + c2 sin u at which it rises (sign +) or falls. Where it is zero everywhere, u is not
    /// changed. Values count as zero below the rounding of unit. Without a zero, missed is the value nearest to it, and 1
    /// is returned.
    fn zero_harmonic(
        c: In<[Real]>,
        sign: Real,
        unit: Real,
        u: Out<Real>,
        missed: Out<Real>,
    ) -> Int {
        name!(amplitude = sqrt(c.at(1) * c.at(1) + c.at(2) * c.at(2)));
        when(amplitude.le(VERGE * unit), || {
            missed.set(c.at(0));
            give((!abs(c.at(0)).le(REACH * unit)).int());
        });
        when(!abs(c.at(0)).le(amplitude + REACH * unit), || {
            missed.set(c.at(0) - c.at(0).lt(0.0).choose(-amplitude, amplitude));
            give(1);
        });
        u.set(
            atan2(c.at(2), c.at(1))
                - sign
                    * atan2(
                        sqrt(max((amplitude - c.at(0)) * (amplitude + c.at(0)), 0.0)),
                        -c.at(0),
                    ),
        );
        0
    }

    /// The same for c0 + c1 u + c2 u^2.
    fn zero_polynomial(
        c: In<[Real]>,
        sign: Real,
        unit: Real,
        u: Out<Real>,
        missed: Out<Real>,
    ) -> Int {
        when(abs(c.at(2)).le(VERGE * max(abs(c.at(1)), unit)), || {
            when(abs(c.at(1)).le(VERGE * unit), || {
                missed.set(c.at(0));
                give((!abs(c.at(0)).le(REACH * unit)).int());
            });
            u.set(-c.at(0) / c.at(1));
            give(0);
        });
        name!(square = c.at(1) * c.at(1) - 4.0 * c.at(2) * c.at(0));
        when(!square.ge(-REACH * unit * unit), || {
            missed.set(c.at(0) - c.at(1) * c.at(1) / (4.0 * c.at(2)));
            give(1);
        });
        u.set((sign * sqrt(max(square, 0.0)) - c.at(1)) / (2.0 * c.at(2)));
        0
    }

    /// The Euler angles of the rotation about s from the identity whose second angle is xi. Half angles keep their
    /// directions through xi = 0.
    fn axis_from_identity(
        s: Vector,
        xi: Real,
        sign: Real,
        zeta: Out<Real>,
        psi: Out<Real>,
    ) -> Real {
        name!(
            rho = sqrt(s.x * s.x + s.y * s.y),
            reduced = near(xi, 0.0),
            half = sin(reduced / 2.0) / rho
        );
        when(!abs(half).le(1.0 + REACH), || {
            give(missed(abs(reduced) - 2.0 * asin(min(rho, 1.0))));
        });
        name!(
            clamped = clamp(half, -1.0, 1.0),
            sine = sign * clamped,
            cosine = max(sqrt((1.0 - clamped) * (1.0 + clamped)), 1e-30)
        );
        let column = Array::<Real>::named(
            "column",
            [s.x * s.z * sine + s.y * cosine, s.y * s.z * sine - s.x * cosine],
        );
        let row = Array::<Real>::named(
            "row",
            [s.x * s.z * sine - s.y * cosine, s.y * s.z * sine + s.x * cosine],
        );
        zeta.set(atan2(sign * column.at(1), sign * column.at(0)));
        psi.set(atan2(sign * row.at(1), -sign * row.at(0)));
        0.0
    }

    /// The same for the rotation about s of an orientation at home: cos xi = c0 + c1 cos q + c2 sin q.
    fn axis_from_home(
        s: Vector,
        home: Rotation,
        xi: Real,
        sign: Real,
        zeta: Out<Real>,
        psi: Out<Real>,
    ) -> Real {
        name!(third = home.z);
        name!(c0 = s.z * dot(s, third));
        name!(z = complex_of(third.z - c0, s.x * third.y - s.y * third.x));
        name!(amplitude = sqrt(inner(z, z)), part = cos(xi) - c0, reduced = near(xi, 0.0));
        when(!abs(part).le(amplitude + REACH), || {
            name!(
                nearest = acos(clamp(c0 + part.lt(0.0).choose(-amplitude, amplitude), -1.0, 1.0))
            );
            give(missed(abs(abs(reduced) - nearest)));
        });
        name!(
            upper = reduced.lt(0.0).choose(-1.0, 1.0),
            height = sqrt(max((amplitude - part) * (amplitude + part), 0.0))
        );
        name!(turn = normal(z * complex_of(part, sign * upper * height)));
        name!(r = product(rotation_about(s, turn), home));
        zeta.set(atan2(upper * r.z.y, upper * r.z.x));
        psi.set(atan2(upper * r.y.z, -upper * r.x.z));
        0.0
    }
}
