//! Natural frequencies: those of decoupled sliders by hand, and those of the equations of motion with springs at the actuators.

use nalgebra::{Complex, DMatrix, DVector, Matrix6, Vector3};
use opm_analysis::{Compliant, Damping, Dynamics, Gravity, Index, Indices, Setup, Springs};
use opm_core::manipulator::{Manipulator, Solution};
use opm_core::mechanism::examples::{EXAMPLES, TEMPLATES};
use opm_core::mechanism::joint::Drive;
use opm_core::skeleton::Density;
use opm_tests::structured;
use std::f64::consts::TAU;

/// How stiff links are; frequencies are extrapolated from these to rigid ones.
const STIFF: [f64; 2] = [1e9, 1e10];

const CLOSE: f64 = 1e-4;

fn weightless(density: Option<f64>) -> Gravity {
    Gravity { acceleration: Vector3::zeros(), density: Density::new(density).unwrap() }
}

/// The frequencies with rigid links: what links give way is in proportion to one over their stiffness.
fn rigid(m: &Manipulator, at: &Solution, actuators: &[f64], gravity: &Gravity) -> Option<[f64; 6]> {
    let found = STIFF.map(|stiff| {
        let springs =
            Springs { actuators: actuators.to_vec(), translation: stiff, rotation: stiff };
        let mut compliant = Compliant::new(m, springs).unwrap().with_gravity(gravity);
        let stiffness = compliant.stiffness(at)?;
        Some(compliant.vibrations(&stiffness)?.map(|found| found.frequency))
    });
    let [soft, stiff] = [found[0]?, found[1]?];
    let ratio = STIFF[1] / STIFF[0];
    Some(std::array::from_fn(|i| (ratio * stiff[i] - soft[i]) / (ratio - 1.0)))
}

/// Each slider of a Tripteron moves the platform along its own axis.
#[test]
fn sliders_swing_by_themselves() {
    let text = EXAMPLES.iter().find(|example| example.name == "tripteron").unwrap().text;
    let m = Manipulator::read(&format!("{text}\n[bodies]\nmasses = {{ platform = 5 }}\n"))
        .unwrap_or_else(|error| panic!("{error}"));
    let actuators = vec![1e4, 4e4, 9e4];
    // Links almost without masses.
    let light = weightless(Some(1e-3));
    let found = rigid(&m, &m.solution(), &actuators, &light).unwrap();
    for (frequency, k) in found.iter().zip(&actuators) {
        let expected = (k / 5.0).sqrt() / TAU;
        assert!((frequency - expected).abs() < CLOSE * expected, "{frequency} {expected}");
    }
    let springs = Springs { actuators, translation: STIFF[1], rotation: STIFF[1] };
    let mut compliant = Compliant::new(&m, springs).unwrap().with_gravity(&light);
    let stiffness = compliant.stiffness(&m.solution()).unwrap();
    for vibration in &compliant.vibrations(&stiffness).unwrap()[..3] {
        // It moves along one axis, and does not turn.
        let shape = vibration.shape / vibration.shape.norm();
        assert!((shape.amax() - 1.0).abs() < CLOSE && shape.fixed_rows::<3>(3).norm() < CLOSE);
    }
}

/// The frequencies of `x'' = A x` by differences of forward dynamics with springs at the actuators, by rising frequency.
fn linearised(m: &Manipulator, actuators: &[f64], x: &[f64]) -> Option<Vec<f64>> {
    const STEP: f64 = 1e-4;
    let setup = Setup { gravity: Some(weightless(None)), ..Setup::new(m.characteristic_length()) };
    let mut dynamics = Dynamics::new(m, &setup);
    let mut at = m.solution();
    let n = x.len();
    m.inverse(x, m.home_mode(), &mut at).ok()??;
    let rest: Vec<f64> = m.actuated().iter().map(|&i| at.joints()[i]).collect();
    let mut pulled = |x: &[f64]| {
        m.inverse(x, m.home_mode(), &mut at).ok()??;
        let each = m.actuated().iter().zip(&rest).zip(actuators);
        let efforts = each.map(|((&i, rest), k)| -k * (at.joints()[i] - rest));
        let efforts = DVector::from_iterator(actuators.len(), efforts);
        dynamics.update(&at).ok()?.then(|| dynamics.forward(&DVector::zeros(n), &efforts))?
    };
    let mut a = DMatrix::zeros(n, n);
    for j in 0..n {
        let mut at = |steps: f64| {
            let mut moved = x.to_vec();
            moved[j] += steps * STEP;
            pulled(&moved)
        };
        let (one, two) = (at(1.0)? - at(-1.0)?, at(2.0)? - at(-2.0)?);
        a.set_column(j, &((one * 8.0 - two) / (12.0 * STEP)));
    }
    let mut found: Vec<f64> =
        a.complex_eigenvalues().iter().map(|value| (-value.re).sqrt() / TAU).collect();
    found.sort_by(f64::total_cmp);
    Some(found)
}

#[test]
fn frequencies_are_those_of_the_equations_of_motion() {
    let mut compared = 0;
    let mut left_out = Vec::new();
    for example in EXAMPLES.iter().chain(TEMPLATES) {
        let Ok(m) = Manipulator::example(example.name) else { continue };
        let mut mechanism = m.mechanism().clone();
        for joint in mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints) {
            for (c, _) in joint.coordinates.iter_mut().zip(0..).filter(|_| joint.actuated) {
                c.drive = Drive { rotor_inertia: 2e-5, gear: 20.0, ..Drive::default() };
            }
        }
        let m = Manipulator::new(mechanism).unwrap();
        let actuators: Vec<f64> = (0..m.actuated().len()).map(|i| 1e3 * (1 + i) as f64).collect();
        let x: Vec<f64> =
            m.home_pose().iter().zip(0..).map(|(h, i)| h + 0.03 + 0.003 * f64::from(i)).collect();
        let mut at = m.solution();
        let Ok(Some(_)) = m.inverse(&x, m.home_mode(), &mut at) else {
            left_out.push(example.name);
            continue;
        };
        let found = rigid(&m, &at, &actuators, &weightless(None));
        let (Some(found), Some(expected)) = (found, linearised(&m, &actuators, &x)) else {
            left_out.push(example.name);
            continue;
        };
        for (found, expected) in found.iter().zip(&expected) {
            let off = (found - expected).abs() / expected;
            assert!(off < CLOSE, "{}: {found} {expected}", example.name);
        }
        compared += 1;
    }
    assert!(compared >= 20, "{compared}, not {left_out:?}");
}

/// Each slider of a Tripteron answers as a mass on a spring does.
#[test]
fn sliders_answer_by_themselves() {
    let text = EXAMPLES.iter().find(|example| example.name == "tripteron").unwrap().text;
    let m = Manipulator::read(&format!("{text}\n[bodies]\nmasses = {{ platform = 5 }}\n")).unwrap();
    let actuators = vec![1e4, 4e4, 9e4];
    let springs =
        Springs { actuators: actuators.clone(), translation: STIFF[1], rotation: STIFF[1] };
    let mut compliant = Compliant::new(&m, springs).unwrap().with_gravity(&weightless(Some(1e-3)));
    let stiffness = compliant.stiffness(&m.solution()).unwrap();
    let response = compliant.response(&stiffness).unwrap();
    let still = response.compliance(0.0, Damping::default());
    let inverse = stiffness.platform.try_inverse().unwrap();
    assert!((still.map(|x| x.re) - inverse).amax() < 1e-9 * inverse.amax());
    assert!(still.iter().all(|x| x.im == 0.0));
    for damping in [
        Damping { loss_factor: 0.07, ratio: 0.0 },
        Damping { loss_factor: 0.0, ratio: 0.04 },
        Damping { loss_factor: 0.03, ratio: 0.02 },
    ] {
        for frequency in [3.0, 7.0, 12.0, 40.0] {
            let omega = TAU * frequency;
            let found = response.compliance(frequency, damping);
            let mut sizes: Vec<[f64; 2]> =
                (0..3).map(|i| [found[(i, i)].re, found[(i, i)].im]).collect();
            let mut expected: Vec<[f64; 2]> = actuators
                .iter()
                .map(|k| {
                    let viscous = 2.0 * damping.ratio * (k * 5.0).sqrt() * omega;
                    // One over k (1 + i η) - ω² m + i ω d.
                    let [a, b] = [k - omega * omega * 5.0, k * damping.loss_factor + viscous];
                    [a / (a * a + b * b), -b / (a * a + b * b)]
                })
                .collect();
            for all in [&mut sizes, &mut expected] {
                all.sort_by(|a, b| a[1].total_cmp(&b[1]));
            }
            for (found, expected) in sizes.iter().zip(&expected) {
                let size = expected[0].hypot(expected[1]);
                for (a, b) in found.iter().zip(expected) {
                    assert!((a - b).abs() < 1e-3 * size, "{frequency}: {found:?} {expected:?}");
                }
            }
        }
    }
}

/// It solves `(K (1 + i η) - ω² M) X = 1`, with the mass matrix that the natural vibrations have.
#[test]
fn the_response_solves_the_equations_of_forced_vibrations() {
    let m = Manipulator::example("stewart").unwrap();
    let springs = Springs { actuators: vec![2e5; 6], translation: 1e7, rotation: 1e5 };
    let mut compliant = Compliant::new(&m, springs).unwrap().with_gravity(&weightless(None));
    let stiffness = compliant.stiffness(&m.solution()).unwrap();
    let response = compliant.response(&stiffness).unwrap();
    let k = stiffness.platform;
    let masses: Matrix6<f64> = compliant
        .vibrations(&stiffness)
        .unwrap()
        .iter()
        .map(|found| {
            let pushed = k * found.shape;
            let energy = found.shape.dot(&pushed);
            pushed * pushed.transpose() / (energy * (TAU * found.frequency).powi(2))
        })
        .sum();
    let damping = Damping { loss_factor: 0.05, ratio: 0.0 };
    for frequency in [1.0, 20.0, 90.0, 400.0] {
        let square = (TAU * frequency).powi(2);
        let forced = (k - masses * square).map(|x| Complex::new(x, 0.0))
            + k.map(|x| Complex::new(0.0, x * damping.loss_factor));
        let whole = forced * response.compliance(frequency, damping);
        let off = (whole - Matrix6::identity()).map(Complex::norm);
        // Forces and moments have different units.
        assert!(off.max() < 1e-6, "{frequency}: {off}");
    }
}

/// Frequencies do not depend on where a mechanism stands, and the index is the lowest.
#[test]
fn frequencies_are_those_of_a_mechanism_that_stands_elsewhere() {
    let m = Manipulator::example("delta").unwrap();
    let springs = Springs { actuators: vec![2e3; 3], translation: 1e6, rotation: 1e3 };
    let frequencies = |m: &Manipulator| {
        let compliant = Compliant::new(m, springs.clone()).unwrap();
        let mut compliant = compliant.with_gravity(&weightless(None));
        let stiffness = compliant.stiffness(&m.solution()).unwrap();
        compliant.vibrations(&stiffness).unwrap().map(|found| found.frequency)
    };
    let expected = frequencies(&m);
    for (_, placed) in structured::placed(m.mechanism()) {
        let found = frequencies(&Manipulator::new(placed).unwrap());
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-9 * expected, "{found} {expected}");
        }
    }
    let setup = Setup { springs: Some(springs.clone()), ..Setup::new(1.0) };
    let mut indices = Indices::new(&m, &setup, [Index::NaturalFrequency]).unwrap();
    assert_eq!(indices.evaluate(&m.solution()), &expected[..1]);
    let rigid = Indices::new(&m, &Setup::new(1.0), [Index::NaturalFrequency]).unwrap_err();
    assert!(rigid.to_string().contains("natural_frequency: nothing gives way"), "{rigid}");
}
