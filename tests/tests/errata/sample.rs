//! Random plano-spherical manipulators, solved by the crate.

use super::{e, n, wrapped};
use fastrand::Rng;
use nalgebra::{Matrix3, Vector2, Vector3};
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::family::plano_spherical;
use opm_tests::paper::{self, Joints, PlanoSpherical, Signs};
use std::f64::consts::PI;
use std::sync::LazyLock;

/// A random plano-spherical manipulator at a random pose.
pub struct Sample {
    pub paper: PlanoSpherical,
    manipulator: Manipulator,
    pub signs: Signs,
    pub pose: [f64; 5],
    /// The solution that the crate finds.
    pub joints: Joints,
}

/// Rates along a motion, by differences of the crate's inverse kinematics.
pub struct Rates {
    pub p: [f64; 2],
    pub rho: Matrix3<f64>,
    pub theta: [f64; 3],
    pub slider: [f64; 3],
    pub arm: [f64; 2],
}

impl Sample {
    fn draw(rng: &mut Rng) -> Option<Self> {
        let paper = PlanoSpherical::random(rng);
        let signs = Signs::random(rng);
        let mut near = |by: f64| by * (2.0 * rng.f64() - 1.0);
        let [x, y, zeta, xi, psi] = [near(0.05), near(0.05), near(PI), near(0.5), near(PI)];
        let pose =
            [x + near(0.02), y + near(0.02), zeta + near(0.2), xi + near(0.2), psi + near(0.2)];
        let home = plano_spherical::Home { x, y, zeta, xi, psi };
        // The cheapest rejections come first.
        regular(&paper, &pose, &paper.inverse(&pose, &signs)?).then_some(())?;
        let mechanism = paper.family(home, &signs).assemble().ok()?;
        let manipulator = Manipulator::new(mechanism).ok()?;
        let joints = inverse(&manipulator, &signs, &pose)?;
        Some(Self { paper, manipulator, signs, pose, joints })
    }

    pub fn rho(&self) -> [[f64; 3]; 3] {
        paper::rotation(self.pose[2], self.pose[3], self.pose[4])
    }

    pub fn p(&self) -> [f64; 2] {
        [self.pose[0], self.pose[1]]
    }

    /// The joint between a leg's two planar links, from the platform: `P + a2 e(theta)`.
    pub fn c(&self, leg: usize) -> Vector2<f64> {
        Vector2::from(self.p()) + self.paper.legs[leg].a2 * e(self.joints.theta[leg])
    }

    /// A leg's slider, seen from the base.
    pub fn a(&self, leg: usize, slider: f64) -> Vector2<f64> {
        let leg = &self.paper.legs[leg];
        leg.h * e(leg.alpha) + slider * n(leg.alpha)
    }

    /// The rates of all joints for given rates of the pose.
    fn rates(&self, direction: &[f64; 5]) -> Rates {
        let step = 1e-3;
        let at = |steps: f64| {
            let pose = [0, 1, 2, 3, 4].map(|i| self.pose[i] + steps * step * direction[i]);
            let joints = inverse(&self.manipulator, &self.signs, &pose).expect("in reach nearby");
            let rho = paper::rotation(pose[2], pose[3], pose[4]);
            (joints, Matrix3::from_fn(|i, j| rho[i][j]))
        };
        let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(at);
        let difference = |of: &dyn Fn(&Joints) -> f64| {
            let near = |side: &Joints, other: &Joints| wrapped(of(side) - of(other));
            (8.0 * near(&c.0, &b.0) - near(&d.0, &a.0)) / (12.0 * step)
        };
        Rates {
            p: [direction[0], direction[1]],
            rho: ((c.1 - b.1) * 8.0 - (d.1 - a.1)) / (12.0 * step),
            theta: [0, 1, 2].map(|i| difference(&|joints| joints.theta[i])),
            slider: [0, 1, 2].map(|i| difference(&|joints| joints.slider[i])),
            arm: [0, 1].map(|i| difference(&|joints| joints.arm[i])),
        }
    }

    /// Rates along one motion, the same in every call.
    pub fn some_rates(&self) -> Rates {
        self.rates(&[0.03, -0.04, 0.2, 0.3, -0.25])
    }
}

/// Whether the pose is away from every leg's singularities, where rounding and rates grow without
/// bound.
fn regular(paper: &PlanoSpherical, pose: &[f64; 5], joints: &Joints) -> bool {
    let [x, y, zeta, xi, psi] = *pose;
    let rho = paper::rotation(zeta, xi, psi);
    let legs = paper.legs.iter().enumerate().all(|(i, leg)| {
        let (theta, s) = (joints.theta[i], joints.slider[i]);
        // The component of the link along the slider is this last coefficient.
        let along = leg.rate_coefficients([x, y], theta, s)[3];
        let v = Vector3::from(leg.proximal_axis(theta));
        let cross = v.cross(&Vector3::from(leg.platform_axis(&rho)));
        along.abs() > 0.3 * leg.a1 && cross.z.abs() > 0.3
    });
    legs && joints.arm[1].sin().abs() > 0.3
}

fn inverse(manipulator: &Manipulator, signs: &Signs, pose: &[f64; 5]) -> Option<Joints> {
    let mut drives = manipulator.actuated_joints();
    let mode = manipulator.parse_mode(&signs.written()).unwrap();
    manipulator.inverse_actuated(pose, mode, &mut drives).unwrap().is_some().then(|| Joints {
        theta: drives.imaginary()[..].try_into().unwrap(),
        slider: drives.actuated()[..3].try_into().unwrap(),
        arm: drives.actuated()[3..].try_into().unwrap(),
    })
}

pub fn samples() -> &'static [Sample] {
    static SAMPLES: LazyLock<Vec<Sample>> = LazyLock::new(|| {
        let mut rng = Rng::with_seed(30);
        std::iter::from_fn(|| Some(Sample::draw(&mut rng))).flatten().take(600).collect()
    });
    &SAMPLES
}
