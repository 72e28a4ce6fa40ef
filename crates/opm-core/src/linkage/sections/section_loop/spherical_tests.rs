//! The spherical four-bar, compared with the input-output equation of the textbook (J. M. McCarthy and
//! G. S. Soh, *Geometric Design of Linkages*, on spherical linkages), in coordinates of its own.

use super::*;
use crate::group::SubspaceKind;
use crate::numeric::angle::unit;
use nalgebra::{Complex, Point3, Rotation3, Unit, UnitQuaternion, Vector3};
use proptest::prelude::*;
use std::f64::consts::PI;

/// Tolerance: the rounding of a few dozen operations on numbers up to one.
const ROUNDING: f64 = 1e-12;

/// Four revolutes through the origin, in the order of the loop.
fn four_bar(axes: [Unit<Vector3<f64>>; 4]) -> Result<SectionLoop, ChainError> {
    let centre = Subspace {
        kind: SubspaceKind::Spherical,
        origin: Point3::origin(),
        axes: Matrix3::identity(),
        measured_from: Point3::origin(),
    };
    let point = Point3::origin();
    SectionLoop::new(&centre, &axes.map(|axis| ChainJoint::Screw { axis, point, pitch: 0.0 }))
}

fn at(angle: f64) -> JointDisplacement {
    JointDisplacement::Direction(unit(angle))
}

fn direction(point: &DeadPoint) -> Complex<f64> {
    match point.at {
        JointDisplacement::Direction(e) => e,
        JointDisplacement::Value(_) => panic!("{point:?}"),
    }
}

/// Arcs of the input crank, the coupler, the output crank and the base, as in McCarthy and Soh.
#[derive(Clone, Copy, Debug)]
struct Arcs {
    crank: f64,
    coupler: f64,
    output: f64,
    base: f64,
}

impl Arcs {
    /// The axes for these angles of the cranks from the base: the input axis along z, the output
    /// axis at the arc `base` from it towards x. They are in the order of the loop: input, coupler
    /// at the input crank, coupler at the output crank, output.
    fn axes(&self, input: f64, output: f64) -> [Unit<Vector3<f64>>; 4] {
        let tilt = |arc: f64| Rotation3::from_axis_angle(&Vector3::y_axis(), arc);
        let turn = |angle: f64| Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
        let z = Vector3::z_axis();
        [
            z,
            turn(input) * tilt(self.crank) * z,
            tilt(self.base) * turn(output) * tilt(self.output) * z,
            tilt(self.base) * z,
        ]
    }

    /// The coefficients of `A cos ψ + B sin ψ = C` for the output crank's angle ψ at an input
    /// angle.
    fn equation(&self, input: f64) -> [f64; 3] {
        let (sa, ca) = self.crank.sin_cos();
        let (sb, cb) = self.output.sin_cos();
        let (sg, cg) = self.base.sin_cos();
        let (s, c) = input.sin_cos();
        [
            sa * sb * cg * c - ca * sb * sg,
            sa * sb * s,
            self.coupler.cos() - ca * cb * cg - sa * cb * sg * c,
        ]
    }

    /// The two roots of the equation.
    fn outputs(&self, input: f64) -> Option<[f64; 2]> {
        let [a, b, c] = self.equation(input);
        let spread = (c / a.hypot(b)).acos();
        spread.is_finite().then(|| [b.atan2(a) + spread, b.atan2(a) - spread])
    }

    /// Whether the input is a crank, by the textbook's signs of sums of arcs.
    fn is_crank(&self) -> bool {
        let Self { crank: a, coupler: n, output: b, base: g } = *self;
        let t1 = g - a + n - b;
        let t2 = g - a - n + b;
        let t3 = n + b - g - a;
        let t4 = std::f64::consts::TAU - n - b - g - a;
        t1 * t2 > 0.0 && t3 * t4 > 0.0
    }

    /// The distance of these sums from changing their sign.
    fn margin(&self) -> f64 {
        let Self { crank: a, coupler: n, output: b, base: g } = *self;
        let t =
            [g - a + n - b, g - a - n + b, n + b - g - a, std::f64::consts::TAU - n - b - g - a];
        t.iter().fold(f64::INFINITY, |m, t| m.min(t.abs()))
    }
}

/// A loop that is assembled at these angles of its two cranks.
#[derive(Clone, Debug)]
struct Assembled {
    arcs: Arcs,
    input: f64,
    output: f64,
    axes: [Unit<Vector3<f64>>; 4],
    four_bar: SectionLoop,
}

impl Assembled {
    fn new(arcs: Arcs, input: f64, output: f64) -> Self {
        let axes = arcs.axes(input, output);
        Self { arcs, input, output, axes, four_bar: four_bar(axes).unwrap() }
    }
}

/// Any arcs from 0.1 to pi - 0.1, assembled at any angles: the coupler's arc is the one that fits.
fn assembled() -> impl Strategy<Value = Assembled> {
    let arc = || 0.1..PI - 0.1;
    ([arc(), arc(), arc()], [-PI..PI, -PI..PI]).prop_filter_map(
        "a coupler of no length",
        move |([crank, output, base], [at_input, at_output])| {
            let mut arcs = Arcs { crank, coupler: 0.0, output, base };
            let [_, from, to, _] = arcs.axes(at_input, at_output);
            arcs.coupler = from.angle(&to);
            arc().contains(&arcs.coupler).then(|| Assembled::new(arcs, at_input, at_output))
        },
    )
}

fn off(a: f64, b: f64) -> f64 {
    (unit(a) - unit(b)).norm()
}

/// The distance of the loop's product of exponentials from the identity.
fn closure(axes: &[Unit<Vector3<f64>>; 4], q: [f64; 4]) -> f64 {
    let product = axes
        .iter()
        .zip(q)
        .fold(Rotation3::identity(), |r, (axis, q)| r * Rotation3::from_axis_angle(axis, q));
    (product.into_inner() - Matrix3::identity()).norm()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    /// For a given input, the output's angles are the two roots of the textbook's equation. In the
    /// loop, the output joint rotates the base relative to the crank, so its angle has the opposite
    /// sign.
    #[test]
    fn the_output_is_the_textbook_s(assembled in assembled(), input in -PI..PI) {
        let Assembled { arcs, input: home, output, four_bar, .. } = assembled;
        let driven = four_bar.driven_by(0);
        let [a, b, c] = arcs.equation(input);
        let clearly = (a.hypot(b) - c.abs()).abs() > 1e-6;
        prop_assume!(clearly);
        let expected = arcs.outputs(input);
        prop_assert_eq!(driven.closes(at(input - home)), expected.is_some());
        let Some(expected) = expected else { return Ok(()) };
        let found = Branch::BOTH.map(|branch| {
            let displacements = driven.solve(at(input - home), branch).unwrap();
            // Seen from the base, which rotates about the output's axis as the loop's last joint.
            output - displacements[2].value()
        });
        for (psi, other) in [(found[0], found[1]), (found[1], found[0])] {
            prop_assert!((a * psi.cos() + b * psi.sin() - c).abs() < 1e-9, "{arcs:?}");
            prop_assert!(expected.iter().any(|e| off(*e, psi) < 1e-5), "{expected:?} {psi}");
            prop_assert!(off(expected[0], expected[1]) < 1e-4 || off(psi, other) > 1e-5);
        }
    }

    /// Whichever joint drives it, both branches close the loop and have the sign of their names.
    #[test]
    fn both_branches_close_the_loop(assembled in assembled(), driver in 0..4_usize, input in -PI..PI,
    ) {
        let Assembled { axes, four_bar, .. } = assembled;
        for branch in Branch::BOTH {
            let Ok(displacements) = four_bar.driven_by(driver).solve(at(input), branch) else { continue };
            let mut q = [0.0; 4];
            q[driver] = input;
            for (i, displacement) in displacements.iter().enumerate() {
                q[(driver + 1 + i) % 4] = displacement.value();
            }
            prop_assert!(closure(&axes, q) < 1e-9, "{}", closure(&axes, q));
            let [a1, a2, a3] = [1, 2, 3].map(|i| axes[(driver + i) % 4]);
            let r1 = UnitQuaternion::from_axis_angle(&a1, displacements[0].value());
            let r2 = r1 * UnitQuaternion::from_axis_angle(&a2, displacements[1].value());
            let triple = a1.dot(&(r1 * a2).cross(&(r2 * a3)));
            prop_assert!(triple * branch.sign() > -1e-6, "{triple}");
        }
    }

    /// Home is a solution, in the branch given by `home`.
    #[test]
    fn home_is_reproduced(assembled in assembled(), driver in 0..4_usize) {
        let Assembled { axes, four_bar, .. } = assembled;
        let driven = four_bar.driven_by(driver);
        let [a1, a2, a3] = [1, 2, 3].map(|i| axes[(driver + i) % 4]);
        // A folded home loses half of the digits.
        prop_assume!(a1.dot(&a2.cross(&a3)).abs() > 1e-3);
        for displacement in driven.solve(at(0.0), driven.home()).unwrap() {
            prop_assert!(displacement.value().abs() < 1e-9, "{displacement:?}");
        }
    }

    /// A crank by the textbook's signs never folds. Any other input folds, and the loop closes on
    /// only one side of each dead point.
    #[test]
    fn cranks_turn_all_the_way_round(assembled in assembled()) {
        let Assembled { arcs, four_bar, .. } = assembled;
        prop_assume!(arcs.margin() > 1e-4);
        let driven = four_bar.driven_by(0);
        let dead: Vec<_> = driven.dead_points().iter().map(direction).collect();
        prop_assert_eq!(arcs.is_crank(), dead.is_empty(), "{:?}", arcs);
        for point in dead {
            prop_assert!((point.norm() - 1.0).abs() < ROUNDING);
            let sides = [-1e-6, 1e-6].map(|step| {
                driven.closes(JointDisplacement::Direction(point * unit(step)))
            });
            prop_assert!(sides[0] != sides[1], "{arcs:?} {point} {sides:?}");
        }
    }
}

/// With equal opposite arcs, the input passes both configurations that fold into a plane without
/// leaving its range.
#[test]
fn change_points_are_inside() {
    let arcs = Arcs { crank: 0.6, coupler: 1.1, output: 0.6, base: 1.1 };
    let output = arcs.outputs(0.7).unwrap()[0];
    let Assembled { four_bar, axes, .. } = Assembled::new(arcs, 0.7, output);
    let driven = four_bar.driven_by(0);
    for i in 0..=720 {
        assert!(driven.closes(at(f64::from(i) * PI / 360.0)), "{i}");
    }
    for folded in [0.0, PI] {
        for branch in Branch::BOTH {
            let displacements = driven.solve(at(folded - 0.7), branch).unwrap();
            let q = [
                folded - 0.7,
                displacements[0].value(),
                displacements[1].value(),
                displacements[2].value(),
            ];
            assert!(closure(&axes, q) < 1e-9, "{folded}");
        }
    }
}

/// A kite folds its coupler's end onto the base: the output is then arbitrary, and stays at home.
#[test]
fn a_free_angle_is_home() {
    let arcs = Arcs { crank: 0.9, coupler: 0.5, output: 0.5, base: 0.9 };
    let output = arcs.outputs(1.0).unwrap()[1];
    let Assembled { four_bar, axes, .. } = Assembled::new(arcs, 1.0, output);
    for branch in Branch::BOTH {
        let displacements = four_bar.driven_by(0).solve(at(-1.0), branch).unwrap();
        let q =
            [-1.0, displacements[0].value(), displacements[1].value(), displacements[2].value()];
        assert_eq!(displacements[0].value(), 0.0);
        assert!(closure(&axes, q) < 1e-9);
    }
}

#[test]
fn parallel_neighbours_are_refused() {
    let [x, y, z] = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
    assert!(four_bar([x, y, z, y]).is_ok());
    for axes in [[x, x, y, z], [y, x, -x, z], [x, y, z, z], [-z, x, y, z]] {
        assert!(matches!(four_bar(axes), Err(ChainError::Dependent(_))), "{axes:?}");
    }
}

/// The loop does not close for NaN and infinity.
#[test]
fn no_number_no_position() {
    let [x, y, z] = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
    let four_bar = four_bar([x, y, z, y]).unwrap();
    for input in [f64::NAN, f64::INFINITY] {
        assert!(!four_bar.driven_by(0).closes(at(input)));
        assert!(four_bar.driven_by(1).solve(at(input), Branch::Plus).is_err());
    }
}
