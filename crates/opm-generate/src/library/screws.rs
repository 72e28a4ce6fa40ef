//! Twists, screws, and the reciprocal screws of a section.

use super::*;

structs! {
    /// Three screws of a section, in its frame: rotation and velocity of the origin in a plane, on an axis; three
    /// rotations about a point; two or three velocities.
    Screws { s1: Vector, s2: Vector, s3: Vector }

    /// The twists of the two sections, in their frames, and the rate of the height.
    Twists { lower: Vector, upper: Vector, rise: Real }

    /// A twist of the platform, base coordinates: its angular velocity, and the velocity of the reference point.
    Motion { turn: Vector, velocity: Vector }
}

functions! {
    #[inline]
    fn twists_of(lower: Vector, upper: Vector, rise: Real) -> Twists {
        Twists::made(lower, upper, rise)
    }

    #[inline]
    fn motion_of(turn: Vector, velocity: Vector) -> Motion {
        Motion::made(turn, velocity)
    }

    /// Ad(g) s
    #[inline]
    fn planar_adjoint(g: Planar, s: Vector) -> Vector {
        name!(moved = g.rotation * complex_of(s.y, s.z));
        vector_of(s.x, moved.re + s.x * g.translation.im, moved.im - s.x * g.translation.re)
    }

    /// The screw of a pivot.
    #[inline]
    fn pivot_screw(p: Pivot) -> Vector {
        vector_of(p.sense, p.sense * p.at.im, -p.sense * p.at.re)
    }

    /// The screw of a slider.
    #[inline]
    fn slider_screw(d: Complex) -> Vector {
        vector_of(0.0, d.re, d.im)
    }

    /// What a pivot does at an angle, which is given as a direction.
    #[inline]
    fn pivot_motion(p: Pivot, q: Complex) -> Planar {
        name!(turn = turn(normal(q), p.sense));
        planar_of(turn, p.at - turn * p.at)
    }

    /// What a slider does.
    #[inline]
    fn slider_motion(d: Complex, q: Real) -> Planar {
        planar_of(complex_of(1.0, 0.0), d * q)
    }

    /// A screw with its second and third component over a unit.
    #[inline]
    fn per_unit(s: Vector, unit: Real) -> Vector {
        vector_of(s.x, s.y / unit, s.z / unit)
    }

    /// A vector perpendicular to another one.
    #[inline]
    fn perpendicular(s: Vector) -> Vector {
        name!(x = abs(s.x), y = abs(s.y), z = abs(s.z));
        when(x.le(y) & x.le(z), || {
            give(vector_of(0.0, s.z, -s.y));
        });
        y.le(z).choose(vector_of(-s.z, 0.0, s.x), vector_of(s.y, -s.x, 0.0))
    }

    #[inline]
    fn normal_vector(s: Vector) -> Vector {
        name!(length = sqrt(dot(s, s)));
        add(vector_of(0.0, 0.0, 0.0), length.gt(0.0).choose(1.0 / length, 0.0), s)
    }

    /// Replaces screws by their reciprocal ones: the dot product of two is 1 if they belong together, and 0 otherwise. Of
    /// the three screws, count are given; perpendicular ones complete them, which joints would have that the section
    /// lacks. Rotations are compared with velocities over the unit. It returns 1 where the screws are dependent.
    fn reciprocal(s: Out<Screws>, count: Int, unit: Real) -> Int {
        name!(
            third = vector_of(0.0, 0.0, 1.0),
            s1 = per_unit(s.s1, unit),
            s2 = per_unit(s.s2, unit),
            s3 = per_unit(s.s3, unit)
        );
        let r1 = Vector::empty("r1");
        let r2 = Vector::empty("r2");
        let r3 = Vector::empty("r3");
        let determinant = Real::empty("determinant");
        let product = Real::empty("product");
        when(count.lt(1), || {
            s1.set(third);
        });
        when(count.lt(2), || {
            s2.set(normal_vector(perpendicular(s1)));
        });
        when(count.lt(3), || {
            s3.set(normal_vector(cross(s1, s2)));
        });
        r1.set(cross(s2, s3));
        r2.set(cross(s3, s1));
        r3.set(cross(s1, s2));
        determinant.set(dot(s1, r1));
        product.set(sqrt(dot(s1, s1) * dot(s2, s2) * dot(s3, s3)));
        when(!abs(determinant).gt(SINGULAR * product), || {
            give(1);
        });
        s.s1.set(per_unit(add(vector_of(0.0, 0.0, 0.0), 1.0 / determinant, r1), unit));
        s.s2.set(per_unit(add(vector_of(0.0, 0.0, 0.0), 1.0 / determinant, r2), unit));
        s.s3.set(per_unit(add(vector_of(0.0, 0.0, 0.0), 1.0 / determinant, r3), unit));
        0
    }

    /// The rows that give the rates of a rotation vector r, in base coordinates, from the angular velocity w, in the
    /// section's: w - r x w / 2 + c r x (r x w), c = (1 - (q / 2) cot (q / 2)) / q^2 with q = |r|.
    fn rotation_vector_rates(axes: Rotation, r: Vector, rows: Out<Screws>) {
        name!(back = transposed(axes));
        name!(square = dot(r, r), half = sqrt(square) / 2.0);
        note("The series, where the closed form would cancel.");
        name!(
            series = Real::from(1.0) / 12.0
                + square
                    * (Real::from(1.0) / 720.0
                        + square
                            * (Real::from(1.0) / 30240.0
                                + square
                                    * (Real::from(1.0) / 1209600.0
                                        + square
                                            * (Real::from(1.0) / 47900160.0
                                                + square
                                                    * (Real::from(691.0) / 1307674368000.0))))),
            c = half.lt(0.2).choose(series, (1.0 - half * cos(half) / sin(half)) / square),
            across = 1.0 - c * square
        );
        name!(
            x = vector_of(
                across + c * r.x * r.x,
                c * r.x * r.y + r.z / 2.0,
                c * r.x * r.z - r.y / 2.0
            ),
            y = vector_of(
                c * r.y * r.x - r.z / 2.0,
                across + c * r.y * r.y,
                c * r.y * r.z + r.x / 2.0
            ),
            z = vector_of(
                c * r.z * r.x + r.y / 2.0,
                c * r.z * r.y - r.x / 2.0,
                across + c * r.z * r.z
            )
        );
        rows.s1.set(rotated(back, x));
        rows.s2.set(rotated(back, y));
        rows.s3.set(rotated(back, z));
    }

    /// The screws of the Euler angles.
    #[inline]
    fn euler_screws(zeta: Real, xi: Real) -> Screws {
        name!(z = unit(zeta), x = unit(xi));
        Screws::made(
            vector_of(0.0, 0.0, 1.0),
            vector_of(-z.im, z.re, 0.0),
            vector_of(z.re * x.im, z.im * x.im, x.re),
        )
    }

    /// The screws of yaw, pitch and roll.
    #[inline]
    fn yaw_pitch_roll_screws(yaw: Real, pitch: Real) -> Screws {
        name!(y = unit(yaw), p = unit(pitch));
        Screws::made(
            vector_of(0.0, 0.0, 1.0),
            vector_of(-y.im, y.re, 0.0),
            vector_of(y.re * p.re, y.im * p.re, -p.im),
        )
    }
}
