//! A planar arm by its chain, and by kernels in space, of which it is an order: the distance gives its second joint, the first
//! and the third follow. Decision 0046 has what this says of the grain of a step.

use nalgebra::{Complex, Vector3};
use opm_benches::{Contender, compare};
use opm_core::chain::ClosedForm;
use opm_core::chain::kernel::Axis;
use opm_core::chain::planar::{PlanarChain, PlanarJoint};
use opm_core::group::PlanarDisplacement;
use std::hint::black_box;

const LANES: usize = 64;

#[inline(always)]
fn by_chain(chain: &PlanarChain, targets: &[[f64; 4]; LANES], out: &mut [[f64; 6]; LANES]) {
    let PlanarChain::Rrr(chain) = chain else { return };
    for (target, out) in targets.iter().zip(out) {
        let [a, b, x, y] = *target;
        let g =
            PlanarDisplacement { rotation: Complex::new(a, b), translation: Complex::new(x, y) };
        let found =
            ClosedForm::<f64>::attempt(chain, &g, 1.0).displacements.map(|joint| match joint {
                opm_core::group::JointDisplacement::Direction(z) => z,
                opm_core::group::JointDisplacement::Value(value) => Complex::new(value, 0.0),
            });
        *out = [found[0].re, found[0].im, found[1].re, found[1].im, found[2].re, found[2].im];
    }
}

#[inline(always)]
fn by_kernels(axes: &[Axis<f64>; 3], targets: &[[f64; 4]; LANES], out: &mut [[f64; 6]; LANES]) {
    let [first, second, third] = axes;
    for (target, out) in targets.iter().zip(out) {
        let [a, b, x, y] = *target;
        let turned = |v: Vector3<f64>| Vector3::new(a * v.x - b * v.y, b * v.x + a * v.y, v.z);
        let wrist = turned(third.point) + Vector3::new(x, y, 0.0);
        // The second joint moves the wrist to its distance from the first axis.
        let reach = wrist - first.point;
        let q2 = second.distance(third.point, first.point, reach.dot(&reach)).root(1.0);
        let bent = second.moved(third.point, q2);
        // The first joint moves it to its place: two heights.
        let one = first.height(bent, Vector3::x(), wrist.x);
        let q1 = one.common(&first.height(bent, Vector3::y(), wrist.y));
        // The third joint turns a direction to where the platform has it.
        let back = q1 * q2;
        let ahead = Vector3::new(a * back.re + b * back.im, b * back.re - a * back.im, 0.0);
        let one = third.angle(Vector3::x(), Vector3::x(), ahead.x);
        let q3 = one.common(&third.angle(Vector3::x(), Vector3::y(), ahead.y));
        *out = [q1.re, q1.im, q2.re, q2.im, q3.re, q3.im];
    }
}

fn main() {
    let places = [[0.0, 0.0], [0.3, 0.1], [0.5, -0.1]];
    let joints =
        places.map(|[x, y]| PlanarJoint::Revolute { at: Complex::new(x, y), reversed: false });
    let chain = PlanarChain::new(joints).expect("an arm of two links");
    let axes =
        places.map(|[x, y]| Axis { point: Vector3::new(x, y, 0.0), direction: Vector3::z() });
    let mut rng = fastrand::Rng::with_seed(1);
    let targets = [(); LANES].map(|()| {
        let angle = 0.6 * (rng.f64() - 0.5);
        [angle.cos(), angle.sin(), 0.05 * (rng.f64() - 0.5), 0.05 * (rng.f64() - 0.5)]
    });
    let [mut one, mut other] = [[[0.0; 6]; LANES]; 2];
    by_chain(&chain, &targets, &mut one);
    by_kernels(&axes, &targets, &mut other);
    for (one, other) in one.iter().zip(&other) {
        for pair in 0..3 {
            let [one, other] = [one, other].map(|q| Complex::new(q[2 * pair], q[2 * pair + 1]));
            assert!((one / one.norm() - other / other.norm()).norm() < 1e-12);
        }
    }
    let arch = pulp::Arch::new();
    let timings = compare(vec![
        Contender::new("chain", LANES as u64, || {
            arch.dispatch(|| by_chain(black_box(&chain), black_box(&targets), &mut one));
        }),
        Contender::new("kernels", LANES as u64, || {
            arch.dispatch(|| by_kernels(black_box(&axes), black_box(&targets), &mut other));
        }),
    ]);
    for timing in timings {
        println!("{:10} {:6.1} ns  {:5.2}", timing.name, 1e9 * timing.seconds, timing.ratio);
    }
}
