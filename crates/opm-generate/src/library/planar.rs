//! Chains of a plane.

use super::*;

functions! {
    /// Two links and a wrist (RRR), by the law of cosines. The sign is + where the second link is counter-clockwise from
    /// the first. Angles are given as directions here and below.
    #[inline(always)]
    fn solve_planar_rrr(
        c: In<PlanarRrr>,
        g: Planar,
        sign: Real,
        q1: Out<Complex>,
        q2: Out<Complex>,
        q3: Out<Complex>,
    ) -> Real {
        name!(first = c.p2.at - c.p1.at, second = c.p3.at - c.p2.at);
        name!(aa = inner(first, first), bb = inner(second, second), ab = sqrt(aa * bb));
        name!(reach = apply(g, c.p3.at) - c.p1.at);
        name!(square = inner(reach, reach), cosine = (square - aa - bb) / (2.0 * ab));
        when(!abs(cosine).le(1.0 + REACH) | ab.le(DEGENERATE * max(aa, bb)), || {
            name!(a = sqrt(aa), b = sqrt(bb), distance = sqrt(square));
            give(missed(max(distance - (a + b), abs(a - b) - distance)));
        });
        name!(bend = clamp(cosine, -1.0, 1.0));
        name!(
            elbow = complex_of(bend, sign * sqrt(1.0 - bend * bend)),
            straighten = first * conjugate(second) * (1.0 / ab),
            r2 = elbow * straighten,
            bent = first + r2 * second,
            r1 = direction(reach * conjugate(bent), (aa + bb) / 2.0),
            r3 = g.rotation * conjugate(r1 * r2)
        );
        q1.set(turn(r1, c.p1.sense));
        q2.set(turn(r2, c.p2.sense));
        q3.set(turn(r3, c.p3.sense));
        0.0
    }

    /// A slider and a link (PRR). The sign is + where the slider is ahead of the link's outer pivot.
    #[inline(always)]
    fn solve_planar_prr(
        c: In<PlanarPrr>,
        g: Planar,
        sign: Real,
        q1: Out<Real>,
        q2: Out<Complex>,
        q3: Out<Complex>,
    ) -> Real {
        name!(
            link = c.p3.at - c.p2.at,
            outer = apply(g, c.p3.at),
            local = (outer - c.p2.at) * conjugate(c.d1)
        );
        name!(bb = inner(link, link), square = bb - local.im * local.im);
        when(!square.ge(-2.0 * REACH * bb) | bb.le(0.0), || {
            give(missed(abs(local.im) - sqrt(bb)));
        });
        name!(slider = local.re + sign * sqrt(max(square, 0.0)));
        name!(moved = outer - c.p2.at - c.d1 * slider, r2 = moved * conjugate(link));
        q1.set(slider);
        q2.set(turn(r2, c.p2.sense));
        q3.set(turn(g.rotation * conjugate(r2), c.p3.sense));
        0.0
    }

    /// A link whose outer pivot carries a slider (RRP): a PRR in reverse order.
    fn solve_planar_rrp(
        c: In<PlanarRrp>,
        g: Planar,
        sign: Real,
        q1: Out<Complex>,
        q2: Out<Complex>,
        q3: Out<Real>,
    ) -> Real {
        name!(r1 = Complex::made(1.0, 0.0), r2 = Complex::made(1.0, 0.0));
        name!(slider = 0.0);
        let missed = Real::empty("missed");
        name!(reverse = PlanarPrr::made(c.d3, c.p2, c.p1));
        missed.set(solve_planar_prr(reverse, planar_inverse(g), sign, slider, r2, r1));
        when(missed.gt(0.0), || {
            give(missed);
        });
        q1.set(conjugate(r1));
        q2.set(conjugate(r2));
        q3.set(-slider);
        0.0
    }

    /// A telescopic link between two pivots (RPR). The sign is + where the outer pivot is ahead of the foot of the
    /// perpendicular from the inner pivot to the slider.
    #[inline(always)]
    fn solve_planar_rpr(
        c: In<PlanarRpr>,
        g: Planar,
        sign: Real,
        q1: Out<Complex>,
        q2: Out<Real>,
        q3: Out<Complex>,
    ) -> Real {
        name!(offset = (c.p3.at - c.p1.at) * conjugate(c.d2), reach = apply(g, c.p3.at) - c.p1.at);
        name!(aside = offset.im * offset.im, square = inner(reach, reach) - aside);
        when(!square.ge(-2.0 * REACH * aside), || {
            give(missed(abs(offset.im) - sqrt(inner(reach, reach))));
        });
        name!(ahead = sign * sqrt(max(square, 0.0)));
        name!(
            telescope = complex_of(ahead, offset.im) * c.d2,
            turned = reach * conjugate(telescope),
            r1 = direction(turned, inner(offset, offset))
        );
        q1.set(turn(r1, c.p1.sense));
        q2.set(ahead - offset.re);
        q3.set(turn(g.rotation * conjugate(r1), c.p3.sense));
        0.0
    }

    /// A pivot that carries two sliders (RPP). The pivot's rotation is that of the target.
    fn solve_planar_rpp(
        c: In<PlanarRpp>,
        g: Planar,
        q1: Out<Complex>,
        q2: Out<Real>,
        q3: Out<Real>,
    ) -> Real {
        name!(moved = apply(g, c.p1.at) - c.p1.at);
        when(!abs(across(c.d2, c.d3)).gt(DEGENERATE), || {
            give(Real::infinity());
        });
        along(c.d2, c.d3, moved * conjugate(g.rotation), q2, q3);
        q1.set(turn(g.rotation, c.p1.sense));
        0.0
    }

    /// Two sliders that carry a pivot (PPR): an RPP in reverse order.
    fn solve_planar_ppr(
        c: In<PlanarPpr>,
        g: Planar,
        q1: Out<Real>,
        q2: Out<Real>,
        q3: Out<Complex>,
    ) -> Real {
        name!(r3 = Complex::made(1.0, 0.0));
        name!(s1 = 0.0, s2 = 0.0);
        let missed = Real::empty("missed");
        name!(reverse = PlanarRpp::made(c.p3, c.d2, c.d1));
        missed.set(solve_planar_rpp(reverse, planar_inverse(g), r3, s2, s1));
        when(missed.gt(0.0), || {
            give(missed);
        });
        q1.set(-s1);
        q2.set(-s2);
        q3.set(conjugate(r3));
        0.0
    }

    /// A pivot between two sliders (PRP). Where these become parallel, only targets on one line are in reach, and the
    /// first slider is given all of the displacement.
    fn solve_planar_prp(
        c: In<PlanarPrp>,
        g: Planar,
        q1: Out<Real>,
        q2: Out<Complex>,
        q3: Out<Real>,
    ) -> Real {
        name!(moved = apply(g, c.p2.at) - c.p2.at, turned = g.rotation * c.d3);
        when(abs(across(c.d1, turned)).gt(REACH), || {
            along(c.d1, turned, moved, q1, q3);
        })
        .otherwise(|| {
            name!(aside = abs(across(c.d1, moved)));
            when(!aside.le(REACH * sqrt(inner(moved, moved))), || {
                give(missed(aside));
            });
            q1.set(inner(moved, c.d1));
            q3.set(0.0);
        });
        q2.set(turn(g.rotation, c.p2.sense));
        0.0
    }

    /// Two pivots, at a displacement that the constraint of the leg allows. The first one moves the second one's axis.
    fn solve_planar_rr(c: In<PlanarRr>, g: Planar, q1: Out<Complex>, q2: Out<Complex>) {
        name!(
            link = c.p2.at - c.p1.at,
            moved = apply(g, c.p2.at) - c.p1.at,
            r1 = moved * conjugate(link)
        );
        q1.set(turn(r1, c.p1.sense));
        q2.set(turn(g.rotation * conjugate(r1), c.p2.sense));
    }

    /// A slider and a pivot, at a displacement that the constraint of the leg allows.
    fn solve_planar_pr(c: In<PlanarPr>, g: Planar, q1: Out<Real>, q2: Out<Complex>) {
        q1.set(inner(c.d1, apply(g, c.p2.at) - c.p2.at));
        q2.set(turn(g.rotation, c.p2.sense));
    }

    /// A pivot and a slider, at a displacement that the constraint of the leg allows.
    fn solve_planar_rp(c: In<PlanarRp>, g: Planar, q1: Out<Complex>, q2: Out<Real>) {
        name!(moved = apply(g, c.p1.at) - c.p1.at);
        q1.set(turn(g.rotation, c.p1.sense));
        q2.set(inner(c.d2, conjugate(g.rotation) * moved));
    }

    /// Two sliders, at a displacement that the constraint of the leg allows.
    fn solve_planar_pp(c: In<PlanarPp>, g: Planar, q1: Out<Real>, q2: Out<Real>) {
        name!(area = across(c.d1, c.d2));
        q1.set(across(g.translation, c.d2) / area);
        q2.set(across(c.d1, g.translation) / area);
    }

    /// A pivot, at a displacement that the constraints of the leg allow.
    fn solve_planar_r(c: In<PlanarR>, g: Planar, q1: Out<Complex>) {
        q1.set(turn(g.rotation, c.p1.sense));
    }

    /// A slider, at a displacement that the constraints of the leg allow.
    fn solve_planar_p(c: In<PlanarP>, g: Planar, q1: Out<Real>) {
        q1.set(inner(c.d1, g.translation));
    }
}
