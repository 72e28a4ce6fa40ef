//! Displacements of the subspaces.

use super::*;

structs! {
    /// A displacement of a plane: z goes to rotation z + translation.
    Planar { rotation: Complex, translation: Complex }

    /// A displacement about and along an axis; the angle counts full revolutions.
    Cylindrical { angle: Real, advance: Real }
}

functions! {
    #[inline]
    fn planar_of(rotation: Complex, translation: Complex) -> Planar {
        Planar::made(rotation, translation)
    }

    #[inline]
    fn cylindrical_of(angle: Real, advance: Real) -> Cylindrical {
        Cylindrical::made(angle, advance)
    }

    /// g z
    #[inline]
    fn apply(g: Planar, z: Complex) -> Complex {
        g.rotation * z + g.translation
    }

    /// g h
    #[inline]
    fn planar_product(g: Planar, h: Planar) -> Planar {
        planar_of(g.rotation * h.rotation, apply(g, h.translation))
    }

    #[inline]
    fn planar_inverse(g: Planar) -> Planar {
        name!(back = conjugate(g.rotation));
        planar_of(back, back * g.translation * -1.0)
    }

    /// v exp(I tau), I a rotation about the origin
    #[inline]
    fn planar_after(v: Planar, tau: Complex) -> Planar {
        planar_of(v.rotation * normal(tau), v.translation)
    }

    /// exp(I tau) b, I a rotation about the origin
    #[inline]
    fn planar_before(b: Planar, tau: Complex) -> Planar {
        name!(e = normal(tau));
        planar_of(e * b.rotation, e * b.translation)
    }

    /// v exp(I tau), I a translation
    #[inline]
    fn planar_after_slide(v: Planar, along: Complex, tau: Real) -> Planar {
        name!(moved = v.rotation * along * tau);
        planar_of(v.rotation, v.translation + moved)
    }

    /// exp(I tau) b, I a translation
    #[inline]
    fn planar_before_slide(b: Planar, along: Complex, tau: Real) -> Planar {
        planar_of(b.rotation, b.translation + along * tau)
    }

    /// sin x / x
    #[inline]
    fn sinc(x: Real) -> Real {
        x.is(0.0).choose(1.0, sin(x) / x)
    }

    /// What a joint that carries the height does in the plane: the exponential of its screw.
    #[inline]
    fn leaned(lift: In<LeaningLift>, rise: Real) -> Planar {
        name!(angle = lift.rotation * rise, half = sinc(angle / 2.0));
        name!(
            factor = complex_of(sinc(angle), angle / 2.0 * half * half),
            moved = lift.velocity * rise
        );
        planar_of(unit(angle), factor * moved)
    }

    /// A pivot, displaced.
    #[inline]
    fn carried_pivot(g: Planar, p: Pivot) -> Pivot {
        p.at.set(apply(g, p.at));
        p
    }
}
