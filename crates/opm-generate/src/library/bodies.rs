//! Displacements of bodies in base coordinates.

use super::*;

structs! {
    /// A displacement of a body: a rotation about the origin, then a translation.
    Body { rotation: Rotation, translation: Vector }
}

functions! {
    /// A displacement of a section in base coordinates, from its rotation and its translation in the section's frame.
    #[inline]
    fn body_of(f: In<Frame>, rotation: Rotation, translation: Vector) -> Body {
        let g = Body::empty("g");
        name!(moved = add(f.origin, 1.0, rotated(f.axes, translation)));
        g.rotation.set(product(product(f.axes, rotation), transposed(f.axes)));
        g.translation.set(add(moved, -1.0, rotated(g.rotation, f.origin)));
        g
    }

    /// g h
    #[inline]
    fn body_product(g: Body, h: Body) -> Body {
        Body::made(
            product(g.rotation, h.rotation),
            add(g.translation, 1.0, rotated(g.rotation, h.translation)),
        )
    }

    /// The velocity of a point that a twist of a section moves: w and v in the section's frame, the rest in base
    /// coordinates.
    #[inline]
    fn velocity_at(f: In<Frame>, w: Vector, v: Vector, point: Vector) -> Vector {
        name!(arm = add(point, -1.0, f.origin));
        add(rotated(f.axes, v), 1.0, cross(rotated(f.axes, w), arm))
    }

    /// The rotation about the third direction by a direction.
    #[inline]
    fn about_third(e: Complex) -> Rotation {
        Rotation::made(
            vector_of(e.re, e.im, 0.0),
            vector_of(-e.im, e.re, 0.0),
            vector_of(0.0, 0.0, 1.0),
        )
    }

    /// 0, or what is returned for a pose that has a coordinate that is no number.
    fn check(pose: In<[Real]>) -> Int {
        count("i", 0, COORDINATES, |i| {
            note("Not true of a number that is none.");
            when(!abs(pose.at(i)).le(LARGEST), || {
                give(-(i + 1));
            });
        });
        0
    }
}
