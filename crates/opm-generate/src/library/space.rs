//! Points, directions and rotations of space.

use super::*;

functions! {
    #[inline]
    fn vector_of(x: Real, y: Real, z: Real) -> Vector {
        Vector::made(x, y, z)
    }

    #[inline]
    fn dot(a: Vector, b: Vector) -> Real {
        a.x * b.x + a.y * b.y + a.z * b.z
    }

    #[inline]
    fn cross(a: Vector, b: Vector) -> Vector {
        vector_of(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
    }

    /// a + s b
    #[inline]
    fn add(a: Vector, s: Real, b: Vector) -> Vector {
        vector_of(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z)
    }

    /// R v
    #[inline]
    fn rotated(r: Rotation, v: Vector) -> Vector {
        vector_of(
            r.x.x * v.x + r.y.x * v.y + r.z.x * v.z,
            r.x.y * v.x + r.y.y * v.y + r.z.y * v.z,
            r.x.z * v.x + r.y.z * v.y + r.z.z * v.z,
        )
    }

    /// R S
    #[inline]
    fn product(r: Rotation, s: Rotation) -> Rotation {
        Rotation::made(rotated(r, s.x), rotated(r, s.y), rotated(r, s.z))
    }

    #[inline]
    fn transposed(r: Rotation) -> Rotation {
        Rotation::made(
            vector_of(r.x.x, r.y.x, r.z.x),
            vector_of(r.x.y, r.y.y, r.z.y),
            vector_of(r.x.z, r.y.z, r.z.z),
        )
    }

    /// exp(a q) v, with the angle q as a unit vector
    #[inline]
    fn rotated_about(a: Vector, q: Complex, v: Vector) -> Vector {
        name!(across = cross(a, v));
        name!(along = dot(a, v) * (1.0 - q.re));
        vector_of(
            v.x * q.re + across.x * q.im + a.x * along,
            v.y * q.re + across.y * q.im + a.y * along,
            v.z * q.re + across.z * q.im + a.z * along,
        )
    }

    /// The rotation exp(a q), with the angle q as a unit vector.
    #[inline]
    fn rotation_about(a: Vector, q: Complex) -> Rotation {
        Rotation::made(
            rotated_about(a, q, vector_of(1.0, 0.0, 0.0)),
            rotated_about(a, q, vector_of(0.0, 1.0, 0.0)),
            rotated_about(a, q, vector_of(0.0, 0.0, 1.0)),
        )
    }

    /// Rz(zeta) Ry(xi) Rz(psi)
    #[inline]
    fn euler(zeta: Real, xi: Real, psi: Real) -> Rotation {
        name!(z = unit(zeta), x = unit(xi), p = unit(psi));
        Rotation::made(
            vector_of(
                z.re * x.re * p.re - z.im * p.im,
                z.im * x.re * p.re + z.re * p.im,
                -x.im * p.re,
            ),
            vector_of(
                -z.re * x.re * p.im - z.im * p.re,
                -z.im * x.re * p.im + z.re * p.re,
                x.im * p.im,
            ),
            vector_of(z.re * x.im, z.im * x.im, x.re),
        )
    }

    /// Rz(yaw) Ry(pitch) Rx(roll)
    #[inline]
    fn yaw_pitch_roll(yaw: Real, pitch: Real, roll: Real) -> Rotation {
        name!(y = unit(yaw), p = unit(pitch), r = unit(roll));
        Rotation::made(
            vector_of(y.re * p.re, y.im * p.re, -p.im),
            vector_of(
                y.re * p.im * r.im - y.im * r.re,
                y.im * p.im * r.im + y.re * r.re,
                p.re * r.im,
            ),
            vector_of(
                y.re * p.im * r.re + y.im * r.im,
                y.im * p.im * r.re - y.re * r.im,
                p.re * r.re,
            ),
        )
    }

    /// R Ry(pi / 2)
    #[inline]
    fn quarter_turned(r: Rotation) -> Rotation {
        Rotation::made(vector_of(-r.z.x, -r.z.y, -r.z.z), r.y, r.x)
    }

    /// Rx(mu) Ry(nu)
    #[inline]
    fn tilt(mu: Real, nu: Real) -> Rotation {
        name!(m = unit(mu), n = unit(nu));
        Rotation::made(
            vector_of(n.re, m.im * n.im, -m.re * n.im),
            vector_of(0.0, m.re, m.im),
            vector_of(n.im, -m.im * n.re, m.re * n.re),
        )
    }

    /// R exp(I tau), I a rotation about the third direction: the first two columns rotate.
    #[inline]
    fn spherical_after(r: Rotation, tau: Complex) -> Rotation {
        name!(e = normal(tau));
        Rotation::made(
            vector_of(
                r.x.x * e.re + r.y.x * e.im,
                r.x.y * e.re + r.y.y * e.im,
                r.x.z * e.re + r.y.z * e.im,
            ),
            vector_of(
                r.y.x * e.re - r.x.x * e.im,
                r.y.y * e.re - r.x.y * e.im,
                r.y.z * e.re - r.x.z * e.im,
            ),
            r.z,
        )
    }

    /// exp(I tau) R, I a rotation about the third direction: the first two rows rotate.
    #[inline]
    fn spherical_before(r: Rotation, tau: Complex) -> Rotation {
        name!(e = normal(tau));
        Rotation::made(
            vector_of(r.x.x * e.re - r.x.y * e.im, r.x.x * e.im + r.x.y * e.re, r.x.z),
            vector_of(r.y.x * e.re - r.y.y * e.im, r.y.x * e.im + r.y.y * e.re, r.y.z),
            vector_of(r.z.x * e.re - r.z.y * e.im, r.z.x * e.im + r.z.y * e.re, r.z.z),
        )
    }
}
