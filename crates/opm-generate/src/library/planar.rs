//! Chains of a plane, as the core has them.

use super::*;
use crate::trace::closed_forms::{Displaced, displacement, solve, write};
use opm_core::chain::partial::{one_in_plane, two_in_plane};
use opm_core::chain::planar::{PlanarChain, PlanarJoint};

fn pivot(p: Pivot) -> PlanarJoint<Complex> {
    PlanarJoint::Revolute { at: p.at, reversed: p.sense }
}

fn slider(along: Complex) -> PlanarJoint<Complex> {
    PlanarJoint::Prismatic { along }
}

/// The closed form of a chain, which writes its joints to these places.
fn chain<S: Into<Real>>(
    joints: [PlanarJoint<Complex>; 3],
    g: Planar,
    sign: S,
    places: [impl Into<Displaced>; 3],
) -> Real {
    let chain = PlanarChain::of(joints);
    solve(&chain, &chain.regular(), &displacement(g), sign.into(), places.map(Into::into))
}

/// Two joints at a displacement that the constraint of the leg allows.
fn two(joints: [PlanarJoint<Complex>; 2], g: Planar, places: [Displaced; 2]) {
    write(places, two_in_plane::<Real, _>(joints, &displacement(g)));
}

/// A joint at a displacement that the constraints of the leg allow.
fn one(joint: PlanarJoint<Complex>, g: Planar, place: Displaced) {
    write([place], [one_in_plane::<Real, _>(joint, &displacement(g))]);
}

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
        chain([pivot(c.p1), pivot(c.p2), pivot(c.p3)], g, sign, [q1, q2, q3])
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
        chain([slider(c.d1), pivot(c.p2), pivot(c.p3)], g, sign, [q1.into(), Displaced::from(q2), q3.into()])
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
        chain([pivot(c.p1), pivot(c.p2), slider(c.d3)], g, sign, [q1.into(), Displaced::from(q2), q3.into()])
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
        chain([pivot(c.p1), slider(c.d2), pivot(c.p3)], g, sign, [q1.into(), Displaced::from(q2), q3.into()])
    }

    /// A pivot that carries two sliders (RPP). The pivot's rotation is that of the target.
    fn solve_planar_rpp(
        c: In<PlanarRpp>,
        g: Planar,
        q1: Out<Complex>,
        q2: Out<Real>,
        q3: Out<Real>,
    ) -> Real {
        chain([pivot(c.p1), slider(c.d2), slider(c.d3)], g, 1.0, [q1.into(), Displaced::from(q2), q3.into()])
    }

    /// Two sliders that carry a pivot (PPR): an RPP in reverse order.
    fn solve_planar_ppr(
        c: In<PlanarPpr>,
        g: Planar,
        q1: Out<Real>,
        q2: Out<Real>,
        q3: Out<Complex>,
    ) -> Real {
        chain([slider(c.d1), slider(c.d2), pivot(c.p3)], g, 1.0, [q1.into(), Displaced::from(q2), q3.into()])
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
        chain([slider(c.d1), pivot(c.p2), slider(c.d3)], g, 1.0, [q1.into(), Displaced::from(q2), q3.into()])
    }

    /// Two pivots, at a displacement that the constraint of the leg allows. The first one moves the second one's axis.
    fn solve_planar_rr(c: In<PlanarRr>, g: Planar, q1: Out<Complex>, q2: Out<Complex>) {
        two([pivot(c.p1), pivot(c.p2)], g, [q1.into(), q2.into()]);
    }

    /// A slider and a pivot, at a displacement that the constraint of the leg allows.
    fn solve_planar_pr(c: In<PlanarPr>, g: Planar, q1: Out<Real>, q2: Out<Complex>) {
        two([slider(c.d1), pivot(c.p2)], g, [q1.into(), q2.into()]);
    }

    /// A pivot and a slider, at a displacement that the constraint of the leg allows.
    fn solve_planar_rp(c: In<PlanarRp>, g: Planar, q1: Out<Complex>, q2: Out<Real>) {
        two([pivot(c.p1), slider(c.d2)], g, [q1.into(), q2.into()]);
    }

    /// Two sliders, at a displacement that the constraint of the leg allows.
    fn solve_planar_pp(c: In<PlanarPp>, g: Planar, q1: Out<Real>, q2: Out<Real>) {
        two([slider(c.d1), slider(c.d2)], g, [q1.into(), q2.into()]);
    }

    /// A pivot, at a displacement that the constraints of the leg allow.
    fn solve_planar_r(c: In<PlanarR>, g: Planar, q1: Out<Complex>) {
        one(pivot(c.p1), g, q1.into());
    }

    /// A slider, at a displacement that the constraints of the leg allow.
    fn solve_planar_p(c: In<PlanarP>, g: Planar, q1: Out<Real>) {
        one(slider(c.d1), g, q1.into());
    }
}
