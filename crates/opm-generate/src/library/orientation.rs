//! Angles of an orientation, for steps that rotate the platform.

use super::*;

functions! {
    /// The rotation of a rotation vector.
    #[inline]
    fn rotation_by(w: Vector) -> Rotation {
        rotation_about(normal_vector(w), unit(sqrt(dot(w, w))))
    }

    /// The rotation by the smallest angle that takes the direction of a vector to that of another one.
    fn swing(from: Vector, to: Vector) -> Rotation {
        name!(a = normal_vector(from), b = normal_vector(to));
        name!(cosine = dot(a, b));
        let (axis, scale) = (Vector::empty("axis"), Real::empty("scale"));
        axis.set(cross(a, b));
        scale.set(1.0 / (1.0 + cosine));
        note("Nearly opposite vectors take the digits of both.");
        when(cosine.lt(0.0), || {
            axis.set(add(axis, -dot(a, axis), a));
            name!(square = dot(axis, axis));
            when(square.lt(REACH * REACH), || {
                give(rotation_about(normal_vector(perpendicular(a)), complex_of(-1.0, 0.0)));
            });
            scale.set((1.0 - cosine) / square);
        });
        name!(c = add(vector_of(0.0, 0.0, 0.0), scale, axis));
        Rotation::made(
            vector_of(cosine + axis.x * c.x, axis.z + axis.y * c.x, axis.z * c.x - axis.y),
            vector_of(axis.x * c.y - axis.z, cosine + axis.y * c.y, axis.x + axis.z * c.y),
            vector_of(axis.y + axis.x * c.z, axis.y * c.z - axis.x, cosine + axis.z * c.z),
        )
    }

    /// Replaces three columns of rates, from the first on, which belong to rotations about the directions of a frame, by
    /// those of three angles with these screws.
    fn by_angles(
        rates: Out<[Real]>,
        rows: Int,
        columns: Int,
        first: Int,
        s1: Vector,
        s2: Vector,
        s3: Vector,
    ) {
        count("i", 0, rows, |i| {
            name!(at = i * columns + first);
            name!(rate = vector_of(rates.at(at), rates.at(at + 1), rates.at(at + 2)));
            rates.at(at).set(dot(s1, rate));
            rates.at(at + 1).set(dot(s2, rate));
            rates.at(at + 2).set(dot(s3, rate));
        });
    }

    /// The Euler angles of a rotation of which the second one is not negative. Where it is zero or half a revolution, to
    /// within rounding, the first one is free, and given.
    fn euler_angles(r: Rotation, first: Real) -> Vector {
        name!(sine = sqrt(r.z.x * r.z.x + r.z.y * r.z.y));
        name!(z = sine.lt(4.0 * REACH).choose(unit(first), normal(complex_of(r.z.x, r.z.y))));
        note("The third one is what the first one leaves.");
        name!(rest = complex_of(z.re * r.y.y - z.im * r.y.x, z.re * r.x.y - z.im * r.x.x));
        vector_of(angle(z), atan2(sine, r.z.z), angle(rest))
    }

    /// One of the two triples of Euler angles of a rotation, 0 or 1, with the revolutions nearest to others.
    fn euler_in(r: Rotation, near: Vector, chart: Int) -> Vector {
        name!(
            a = euler_angles(r, chart.gt(0).choose(near.x + PI, near.x)),
            b = chart.gt(0).choose(vector_of(a.x + PI, -a.y, a.z + PI), a)
        );
        vector_of(super::near(b.x, near.x), super::near(b.y, near.y), super::near(b.z, near.z))
    }

    /// The Euler angles of a rotation nearest to others.
    fn euler_near(r: Rotation, near: Vector) -> Vector {
        name!(
            a = euler_in(r, near, 0),
            b = euler_in(r, near, 1),
            of_a = add(a, -1.0, near),
            of_b = add(b, -1.0, near)
        );
        dot(of_b, of_b).lt(dot(of_a, of_a)).choose(b, a)
    }

    /// The same for azimuth, tilt and torsion, which is the sum of the first and the third Euler angle.
    fn torsion_in(r: Rotation, near: Vector, chart: Int) -> Vector {
        name!(a = euler_in(r, vector_of(near.x, near.y, near.z - near.x), chart));
        vector_of(a.x, a.y, super::near(a.x + a.z, near.z))
    }

    /// The azimuth, the tilt, which is not negative, and the torsion of a rotation, nearest to others.
    fn torsion_near(r: Rotation, near: Vector) -> Vector {
        name!(a = euler_angles(r, near.x));
        vector_of(super::near(a.x, near.x), a.y, super::near(a.x + a.z, near.z))
    }

    /// The same for roll, pitch and yaw: with Rx(roll) Ry(pi / 2) = Ry(pi / 2) Rz(roll), the Euler angles yaw, pitch + pi / 2
    /// and roll are those of the rotation after a quarter turn.
    fn roll_in(r: Rotation, near: Vector, chart: Int) -> Vector {
        name!(a = euler_in(quarter_turned(r), vector_of(near.z, near.y + PI / 2.0, near.x), chart));
        vector_of(a.z, a.y - PI / 2.0, a.x)
    }

    /// The roll, the pitch and the yaw of a rotation nearest to others.
    fn roll_near(r: Rotation, near: Vector) -> Vector {
        name!(a = euler_near(quarter_turned(r), vector_of(near.z, near.y + PI / 2.0, near.x)));
        vector_of(a.z, a.y - PI / 2.0, a.x)
    }

    /// How far two rotations are apart: four times the square of the sine of half the angle between them.
    fn apart(r: Rotation, s: Rotation) -> Real {
        3.0 - dot(r.x, s.x) - dot(r.y, s.y) - dot(r.z, s.z)
    }
}
