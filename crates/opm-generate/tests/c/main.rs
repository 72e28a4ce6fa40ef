//! Generated C, compiled and compared with `opm-core`.

mod compiled;
mod drawn;

use compiled::{Answer, Program, Question, Real, compiled_by, linuxcnc, programs_of};
use drawn::{Drawn, random_mechanisms, shipped};
use fastrand::Rng;
use opm_core::manipulator::{ActuatedJoints, Solution};
use opm_core::nalgebra::Isometry3;
use opm_core::velocity::Jacobians;
use opm_core::{Manipulator, Mode, Quantity};
use std::f64::consts::{PI, TAU};

/// How far a joint may be off, radians or metres over one or the joint's value, where the joints move no more than
/// [`GAIN`] times faster than the pose. Nearer to a singularity it is in proportion.
const ROUNDING: f64 = 1e-12;
const GAIN: f64 = 1e3;

/// A parallel measure of singularity above this is far from a singularity.
const REGULAR: f64 = 0.01;

/// How far the legs may be from the platform in `float`, radians or shares of the size: some ten operations' rounding.
const FLOAT: f64 = 1e-5;

/// Poses of each shipped mechanism, and of each random one: 10⁵ in all.
const POSES: [usize; 2] = [3_000, 200];

/// What is compared at every pose, and what was compared.
struct Comparison<'a> {
    manipulator: &'a Manipulator,
    at: Solution,
    near: Solution,
    actuated: ActuatedJoints,
    jacobians: Jacobians,
    reached: usize,
    missed: usize,
    /// Poses with rates; poses found by forward kinematics among those asked for.
    regular: usize,
    found: [usize; 2],
}

impl<'a> Comparison<'a> {
    fn new(manipulator: &'a Manipulator) -> Self {
        let [at, near] = [(), ()].map(|()| manipulator.solution());
        let actuated = manipulator.actuated_joints();
        let jacobians = manipulator.jacobians();
        let (reached, missed, regular, found) = (0, 0, 0, [0; 2]);
        Self { manipulator, at, near, actuated, jacobians, reached, missed, regular, found }
    }

    fn compare(&mut self, question: &Question, answer: &Answer) {
        let m = self.manipulator;
        let name = &m.mechanism().name;
        let reached = m.inverse(&question.pose, question.mode, &mut self.at).unwrap().is_some();
        let first = self.at.unreachable().first();
        let status = first.map_or(0.0, |missed| missed.leg as f64 + 1.0);
        let place = format!("{name} at {:?} in {}", question.pose, m.format_mode(question.mode));
        assert_eq!(answer.status, status, "{place}");
        assert_eq!(answer.actuated_status, status, "{place}");
        assert_eq!(answer.deficits_status, status, "{place}");
        self.compare_deficits(answer, &place);
        self.compare_transform(question, answer, &place);
        if !reached {
            self.missed += 1;
            let written = answer.joints.iter().chain(&answer.imaginary).chain(&answer.actuated);
            let written = written.chain(&answer.jacobian);
            assert!(written.copied().all(|value| value == -77.0), "{place}: {answer:?}");
            assert_eq!((answer.jacobian_status, answer.rates_status), (status, status), "{place}");
            return;
        }
        self.reached += 1;
        let (gain, differences) = self.differences(question);
        let tolerance = ROUNDING * (gain / GAIN).max(1.0);
        let expected = (self.at.joints(), self.at.imaginary());
        let off = off(m, (&answer.joints, &answer.imaginary), expected);
        assert!(off <= tolerance, "{place}: {off:e} {:?} {:?}", answer.joints, self.at.joints());
        // To the bit: the same displacements.
        for (value, &number) in answer.actuated.iter().zip(m.actuated()) {
            assert_eq!(*value, answer.joints[number], "{place}");
        }
        let found = m.inverse_actuated(&question.pose, question.mode, &mut self.actuated).unwrap();
        assert!(found.is_some(), "{place}");
        assert_eq!(answer.limits == 0.0, self.at.within_limits(), "{place}: {:?}", answer.joints);
        self.compare_nearest(question, answer, &place);
        self.compare_rates(question, answer, (gain, &differences), &place);
        self.compare_forward(question, answer, gain, &place);
    }

    /// The Jacobian is opm's, and that of differences; the rates are its product with those of the pose.
    fn compare_rates(
        &mut self,
        question: &Question,
        answer: &Answer,
        (gain, differences): (f64, &[f64]),
        place: &str,
    ) {
        let m = self.manipulator;
        let legs = m.mechanism().legs.len() as f64;
        assert_eq!(answer.jacobian_status, answer.rates_status, "{place}");
        if answer.jacobian_status != 0.0 {
            // At a singularity of the Euler angles, coordinates may follow that have no rates.
            m.differentiate(&self.at, &mut self.jacobians).unwrap();
            let undetermined = self.jacobians.joints_by_pose().iter().any(|rate| rate.is_nan());
            let coordinates = answer.jacobian_status == 2.0 * legs + 1.0;
            let singular = gain > GAIN || (coordinates && undetermined);
            assert!(answer.jacobian_status > legs && singular, "{place}: {gain:e} {answer:?}");
            return;
        }
        if !m.differentiate(&self.at, &mut self.jacobians).unwrap() || gain > 1e3 * GAIN {
            return;
        }
        self.regular += 1;
        let expected = self.jacobians.joints_by_pose();
        let columns = m.task_coordinates().len();
        for (i, c) in m.coordinates().iter().enumerate() {
            let mut rate = 0.0;
            let mut size = 0.0;
            for (j, of_pose) in m.task_coordinates().iter().enumerate() {
                let found = answer.jacobian[i * columns + j];
                let unit = unit(m, c.quantity) / unit(m, of_pose.quantity);
                let off = (found - expected[(i, j)]).abs() / unit;
                assert!(off <= ROUNDING * gain * gain, "{place}: {i} {j} {off:e} {gain:e}");
                let off = (found - differences[i * columns + j]).abs() / unit;
                assert!(off <= 1e-5 * gain.powi(3), "{place}: {i} {j} {off:e} {gain:e}");
                rate += found * question.next[j];
                size += (found * question.next[j]).abs();
            }
            assert!((answer.rates[i] - rate).abs() <= ROUNDING * size, "{place}");
        }
    }

    /// The actuated joints are those at the pose that was found, and from nearby the pose is found.
    fn compare_forward(&mut self, question: &Question, answer: &Answer, gain: f64, place: &str) {
        let m = self.manipulator;
        let Some(forward) = &answer.forward else { return };
        let numbers = m.task_coordinates().len() + m.actuated().len();
        assert_eq!(forward.refused, -(numbers as f64), "{place}");
        // Random mechanisms may have actuated joints that do not determine the pose, and the start may be out of reach.
        let mut measured = m.singularities();
        m.measure_singularities(&self.jacobians, &mut measured);
        let parallel = measured.whole.parallel.map_or(0.0, f64::abs);
        let starts = m.inverse(&question.next, question.mode, &mut self.near).unwrap().is_some();
        let asked = usize::from(gain < 10.0 && parallel > REGULAR && starts);
        self.found[1] += asked;
        if forward.status != 0.0 {
            return;
        }
        assert!(forward.residual <= 1e-10, "{place}: {forward:?}");
        let at = m.inverse(&forward.pose, question.mode, &mut self.near).unwrap();
        let at = at.unwrap_or_else(|| panic!("{place}: {forward:?}"));
        for &joint in m.actuated() {
            let c = &m.coordinates()[joint];
            let off = apart(c.quantity, at.joints()[joint], answer.joints[joint]);
            assert!(off / unit(m, c.quantity) <= 1e-8, "{place}: {off:e} {forward:?}");
        }
        self.found[0] += asked;
    }

    /// By how much faster than the pose the joints move, in radians or sizes of the mechanism; and their differences, a row
    /// for each joint.
    fn differences(&mut self, question: &Question) -> (f64, Vec<f64>) {
        const STEP: f64 = 1e-7;
        let m = self.manipulator;
        let mut pose = question.pose.clone();
        let mut most: f64 = 1.0;
        let columns = pose.len();
        let mut differences = vec![0.0; columns * m.coordinates().len()];
        for (i, c) in m.task_coordinates().iter().enumerate() {
            pose[i] += STEP * unit(m, c.quantity);
            if m.inverse(&pose, question.mode, &mut self.near).unwrap().is_none() {
                return (f64::INFINITY, differences);
            }
            let joints = self.at.joints().iter().zip(self.near.joints()).zip(m.coordinates());
            for (row, ((a, b), of_joint)) in joints.enumerate() {
                let off = apart(of_joint.quantity, *a, *b);
                most = most.max(off / unit(m, of_joint.quantity) / STEP);
                // Half a revolution from home, the sense of the difference is that of its remainder.
                let sign = if ((b - a).abs() > PI) == (b < a) { 1.0 } else { -1.0 };
                differences[row * columns + i] = sign * off / (STEP * unit(m, c.quantity));
            }
            pose[i] = question.pose[i];
        }
        (most, differences)
    }

    /// Every deficit is opm's.
    fn compare_deficits(&self, answer: &Answer, place: &str) {
        let mut expected = vec![0.0; answer.deficits.len()];
        for missed in self.at.unreachable() {
            expected[2 * missed.leg + missed.section as usize] = missed.deficit.excess;
        }
        for (found, expected) in answer.deficits.iter().zip(expected) {
            // Where an arc is a pole of its cosine, it has half the digits.
            let close = *found == expected || (found - expected).abs() <= 1e-7 * expected.max(1.0);
            assert!(close && (*found > 0.0) == (expected > 0.0), "{place}: {found} {expected}");
        }
    }

    fn compare_transform(&self, question: &Question, answer: &Answer, place: &str) {
        let m = self.manipulator;
        let Ok(displacement) = m.displacement_in(&question.pose, question.mode) else {
            assert!(answer.transform_status > 0.0, "{place}");
            return;
        };
        assert_eq!(answer.transform_status, 0.0, "{place}");
        let platform = m.platform_at(&displacement);
        let matrix = platform.rotation.to_rotation_matrix();
        let far = 1.0 + platform.translation.vector.norm();
        for row in 0..3 {
            let off = (answer.position[row] - platform.translation.vector[row]).abs();
            assert!(off <= 1e-9 * far, "{place}: position {:?} {platform}", answer.position);
            for column in 0..3 {
                let off = (answer.rotation[3 * row + column] - matrix[(row, column)]).abs();
                assert!(off <= 1e-9, "{place}: rotation {:?} {matrix}", answer.rotation);
            }
        }
    }

    /// No other mode is nearer, and the joints are those of the mode with the revolutions of those before.
    fn compare_nearest(&mut self, question: &Question, answer: &Answer, place: &str) {
        let m = self.manipulator;
        // All modes would take too long.
        if m.choices() > 6 || self.reached > 200 {
            return;
        }
        let mut least = f64::INFINITY;
        let mut of_answer = f64::INFINITY;
        for mode in m.modes() {
            self.near.clone_from(&self.at);
            if m.inverse_near(&question.next, mode, &mut self.near).unwrap().is_none() {
                continue;
            }
            let moved = moved(m, self.near.joints(), &answer.joints);
            least = least.min(moved);
            if mode.bits() as f64 == answer.nearest_mode {
                of_answer = moved;
                let joints = answer.nearest_joints.iter().zip(self.near.joints());
                let imaginary = answer.nearest_imaginary.iter().zip(self.near.imaginary());
                let joints = joints.map(|(a, b)| (a - b).abs());
                let imaginary =
                    imaginary.zip(m.imaginary()).map(|((a, b), j)| apart(j.quantity, *a, *b));
                let off = joints.chain(imaginary).fold(0.0, f64::max);
                assert!(
                    answer.nearest_status != 0.0 || off < 1e-6,
                    "{place} to {:?}: {:?} {:?}",
                    question.next,
                    answer.nearest_joints,
                    self.near.joints()
                );
            }
        }
        assert_eq!(
            answer.nearest_status == 0.0,
            least.is_finite(),
            "{place} to {:?}",
            question.next
        );
        if least.is_finite() {
            assert!(of_answer <= least + 1e-9, "{place}: {of_answer:e} and not {least:e}");
        }
    }
}

/// What an angle or a length is compared with.
fn unit(m: &Manipulator, quantity: Quantity) -> f64 {
    match quantity {
        Quantity::Angle => 1.0,
        Quantity::Length => m.characteristic_length(),
    }
}

/// The difference of two values; full revolutions are none.
fn apart(quantity: Quantity, a: f64, b: f64) -> f64 {
    let off = (a - b).abs();
    if quantity == Quantity::Angle && off > PI {
        (off - TAU * (off / TAU).round()).abs()
    } else {
        off
    }
}

/// The sum of the squares of the motions from other joint values.
fn moved(m: &Manipulator, joints: &[f64], from: &[f64]) -> f64 {
    let each = joints.iter().zip(from).zip(m.coordinates());
    each.map(|((a, b), c)| ((a - b) / unit(m, c.quantity)).powi(2)).sum()
}

/// The largest difference of joints and of imaginary joints, over one or their values. Where half a revolution from home
/// decides on the sense of an angle, both are right.
fn off(m: &Manipulator, found: (&[f64], &[f64]), expected: (&[f64], &[f64])) -> f64 {
    let mut most: f64 = 0.0;
    for ((&a, &b), c) in found.0.iter().zip(expected.0).zip(m.coordinates()) {
        let whole = (a - b).abs() > PI && c.quantity == Quantity::Angle;
        assert!(!whole || ((a - c.home).abs() - PI).abs() < 1e-6 || c.limits.is_some(), "{a} {b}");
        most = most.max(apart(c.quantity, a, b) / b.abs().max(1.0));
    }
    for ((&a, &b), joint) in found.1.iter().zip(expected.1).zip(m.imaginary()) {
        most = most.max(apart(joint.quantity, a, b) / b.abs().max(1.0));
    }
    if found.0.iter().chain(found.1).any(|value| !value.is_finite()) { f64::INFINITY } else { most }
}

fn compare_all(manipulators: &[Manipulator], flags: &[&str], poses: usize, seed: u64) {
    let list: Vec<&Manipulator> = manipulators.iter().collect();
    let Some(program) = Program::new(&list, Real::Double, flags) else { return };
    let mut rng = Rng::with_seed(seed);
    let (mut reached, mut missed, mut regular, mut found) = (0, 0, 0, [0; 2]);
    for (number, m) in manipulators.iter().enumerate() {
        let questions = Drawn { rng: &mut rng, manipulator: m }.questions(poses);
        let answers = program.ask(number, &questions);
        let mut comparison = Comparison::new(m);
        for (question, answer) in questions.iter().zip(&answers) {
            comparison.compare(question, answer);
        }
        reached += comparison.reached;
        missed += comparison.missed;
        regular += comparison.regular;
        (0..2).for_each(|i| found[i] += comparison.found[i]);
    }
    println!(
        "{} mechanisms: {reached} poses in reach, {missed} out of it, {regular} regular, {found:?} found by forward kinematics",
        manipulators.len()
    );
    assert!(reached > missed / 4 && missed > 0, "{reached} {missed}");
    assert!(regular > reached / 2 && found[0] > found[1] / 10 * 9, "{regular} {found:?}");
}

#[test]
fn shipped_mechanisms_are_solved_as_by_opm() {
    compare_all(&shipped(), &["-O2"], POSES[0], 1);
}

/// Of every pair of subspaces, with limits, spherical and universal joints, leaning lifts, and legs that constrain.
#[test]
fn random_mechanisms_are_solved_as_by_opm() {
    compare_all(&random_mechanisms(2), &["-O0"], POSES[1], 3);
}

/// Joints in `float` close every leg. Poses that may be on either side of the boundary of reach are left out.
#[test]
fn joints_in_float_close_every_leg() {
    let manipulators = shipped();
    let list: Vec<&Manipulator> = manipulators.iter().collect();
    let Some(program) = Program::new(&list, Real::Float, &["-O2"]) else { return };
    let mut rng = Rng::with_seed(5);
    for (number, m) in manipulators.iter().enumerate() {
        let mut questions = Drawn { rng: &mut rng, manipulator: m }.questions(2_000);
        for question in &mut questions {
            question.pose.iter_mut().for_each(|value| *value = f64::from(*value as f32));
        }
        let answers = program.ask(number, &questions);
        let mut at = m.solution();
        let (mut compared, mut worst) = (0, 0.0_f64);
        for (question, answer) in questions.iter().zip(&answers) {
            let Some(status) = surely(m, question, &mut at) else { continue };
            assert_eq!(answer.status, status, "{} at {:?}", m.mechanism().name, question.pose);
            if status == 0.0 {
                compared += 1;
                let g = m.displacement_in(&question.pose, question.mode).unwrap();
                worst = worst.max(open(m, &answer.joints, &g));
            }
        }
        println!("{}: {compared} poses, open by {worst:e}", m.mechanism().name);
        assert!(compared > 10 && worst < FLOAT, "{}: {worst:e}", m.mechanism().name);
    }
}

/// What `NAME_inverse` returns for a pose, if it does so at all poses nearby, too.
fn surely(m: &Manipulator, question: &Question, at: &mut Solution) -> Option<f64> {
    const NEARBY: f64 = 1e-3;
    let mut status = |pose: &[f64]| {
        m.inverse(pose, question.mode, at).unwrap();
        at.unreachable().first().map_or(0.0, |missed| missed.leg as f64 + 1.0)
    };
    let here = status(&question.pose);
    let mut pose = question.pose.clone();
    for (i, c) in m.task_coordinates().iter().enumerate() {
        for step in [NEARBY, -NEARBY] {
            pose[i] = question.pose[i] + step * unit(m, c.quantity);
            if status(&pose) != here {
                return None;
            }
        }
        pose[i] = question.pose[i];
    }
    Some(here)
}

/// How far the ends of the legs are from the platform, radians or sizes of the mechanism.
fn open(m: &Manipulator, joints: &[f64], g: &Isometry3<f64>) -> f64 {
    let mut first = 0;
    let mut most: f64 = 0.0;
    for leg in &m.mechanism().legs {
        let count = leg.coordinates().count();
        let end = leg.displacement(&joints[first..first + count]).unwrap();
        let [a, b] = [&end, g].map(|g| g * m.mechanism().platform);
        most = most
            .max((a - b).norm() / m.characteristic_length())
            .max(end.rotation.angle_to(&g.rotation));
        first += count;
    }
    most
}

/// On lines from a pose in reach to one out of it, the code and opm turn at the same place.
#[test]
fn reach_ends_where_it_does_for_opm() {
    /// Rounding of the boundary's place, as a share of the line: a pose nearer to it may be on either side.
    const BOUNDARY: f64 = 1e-9;
    let manipulators = shipped();
    let list: Vec<&Manipulator> = manipulators.iter().collect();
    let Some(program) = Program::new(&list, Real::Double, &["-O2"]) else { return };
    let mut rng = Rng::with_seed(7);
    let mut lines = 0;
    for (number, m) in manipulators.iter().enumerate() {
        let mut at = m.solution();
        let drawn = Drawn { rng: &mut rng, manipulator: m }.questions(60);
        let mut questions = Vec::new();
        for pair in drawn.windows(2) {
            let mode = pair[0].mode;
            let mut reached = |pose: &[f64]| m.inverse(pose, mode, &mut at).unwrap().is_some();
            if !reached(&pair[0].pose) || reached(&pair[1].pose) {
                continue;
            }
            let along = |t: f64| -> Vec<f64> {
                let ends = pair[0].pose.iter().zip(&pair[1].pose);
                ends.map(|(a, b)| a + t * (b - a)).collect()
            };
            let (mut inside, mut outside) = (0.0, 1.0);
            while outside - inside > BOUNDARY / 100.0 {
                let middle = 0.5 * (inside + outside);
                let end = if reached(&along(middle)) { &mut inside } else { &mut outside };
                *end = middle;
            }
            let next = pair[0].pose.clone();
            for t in [inside - BOUNDARY, outside + BOUNDARY] {
                questions.push(Question { mode, pose: along(t), next: next.clone() });
            }
            lines += 1;
        }
        for (question, answer) in questions.iter().zip(program.ask(number, &questions)) {
            let reached = m.inverse(&question.pose, question.mode, &mut at).unwrap().is_some();
            assert_eq!(answer.status == 0.0, reached, "{} {question:?}", m.mechanism().name);
        }
    }
    assert!(lines > 100, "{lines}");
}

/// Numbers that are none are told; nothing is undefined then, or anywhere else.
#[test]
fn nothing_is_undefined() {
    let names = [
        "plano-spherical-5dof",
        "five-bar",
        "translational-helical-3dof",
        "schoenflies-column-4dof",
    ];
    let manipulators = names.map(|name| Manipulator::example(name).unwrap());
    let list: Vec<&Manipulator> = manipulators.iter().collect();
    for real in [Real::Double, Real::Float] {
        let flags = ["-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"];
        let Some(program) = Program::new(&list, real, &flags) else { return };
        let mut rng = Rng::with_seed(11);
        for (number, m) in manipulators.iter().enumerate() {
            let mut questions = Drawn { rng: &mut rng, manipulator: m }.questions(300);
            let count = m.task_coordinates().len();
            let wrong = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e80, -1e80];
            for (i, question) in questions.iter_mut().enumerate().take(100).skip(50) {
                question.next[i % count] = wrong[i % 3];
            }
            for (i, question) in questions.iter_mut().enumerate().skip(100) {
                if real == Real::Double || !wrong[i % 5].is_finite() || i % 5 < 3 {
                    question.pose[i % count] = wrong[i % 5];
                    question.next[(i + 1) % count] = wrong[(i + 2) % 3];
                }
            }
            for (i, answer) in program.ask(number, &questions).iter().enumerate().skip(50) {
                if i < 100 {
                    let refused = -((count + i % count) as f64 + 1.0);
                    assert!(answer.status != 0.0 || answer.rates_status == refused, "{answer:?}");
                    continue;
                }
                if real == Real::Double || i % 5 < 3 {
                    assert_eq!(
                        answer.status,
                        -((i % count) as f64 + 1.0),
                        "{}",
                        m.mechanism().name
                    );
                    assert!(answer.nearest_status < 0.0);
                }
            }
        }
    }
}

/// The test program that is written beside the code accepts it, and a changed geometry it does not.
#[test]
fn the_test_beside_the_code_finds_errors() {
    for m in shipped() {
        let code = opm_generate::c(&m).unwrap();
        let wrong = code.source.replacen(".home + at.q_", ".home + R(0.01) + at.q_", 1);
        let told = programs_of(&code, &[&code.source, &wrong]);
        let Some([right, wrong]) = told.as_deref() else { return };
        assert!(right.0, "{}", right.1);
        if code.source.contains(".home + at.q_") {
            assert!(!wrong.0, "{}: {}", code.name, wrong.1);
        }
    }
}

/// The bits of a mode are its signs, the first one lowest.
#[test]
fn bits_are_signs() {
    let m = Manipulator::example("plano-spherical-5dof").unwrap();
    for (number, mode) in m.modes().enumerate() {
        let signs: String = m.format_mode(mode).chars().filter(|c| *c != ' ').collect();
        let bits = signs.chars().rev().fold(0, |bits, sign| 2 * bits + u64::from(sign == '-'));
        assert_eq!((mode.bits(), bits), (number as u64, number as u64));
        assert_eq!(mode, Mode::clone(&m.parse_mode(&signs).unwrap()));
    }
}

/// Every closed form and every condition of the library is in the code of a mechanism that is compared.
#[test]
fn every_closed_form_is_compared() {
    let library = include_str!("../../src/c/library.c");
    let all: Vec<Manipulator> = shipped().into_iter().chain(random_mechanisms(2)).collect();
    let codes: Vec<_> = all.iter().map(|m| opm_generate::c(m).unwrap()).collect();
    let forms = library.split("NAME_").filter_map(|rest| rest.split_once('('));
    let forms = forms.map(|(name, _)| name).filter(|name| {
        ["solve_", "value_", "axis_", "zero_"].iter().any(|begin| name.starts_with(begin))
    });
    for form in forms {
        let used = codes.iter().filter(|code| code.source.contains(&format!("_{form}("))).count();
        assert!(used > 0, "no mechanism has {form}");
    }
}

/// clang accepts the code, and so do C++ compilers, as C++17.
#[test]
fn every_compiler_accepts_the_code() {
    let manipulators = shipped().into_iter().chain(random_mechanisms(2).into_iter().step_by(16));
    let codes: Vec<_> = manipulators.map(|m| opm_generate::c(&m).unwrap()).collect();
    let cpp = ["-x", "c++", "-std=c++17"];
    for (compiler, flags) in
        [("clang", &["-std=c99"][..]), ("c++", &cpp[..]), ("clang++", &cpp[..])]
    {
        if let Some(told) = compiled_by(compiler, flags, &codes) {
            assert_eq!(told, "", "{compiler}");
        }
    }
}

/// The module for LinuxCNC gives opm's actuated joints, in millimetres and degrees, and finds the pose again.
#[test]
fn linuxcnc_moves_as_opm_does() {
    let mut modules = 0;
    for m in shipped() {
        let code = opm_generate::c(&m).unwrap();
        if code.linuxcnc.is_none() {
            continue;
        }
        modules += 1;
        let mut pose = m.home_pose();
        let mut axes = [0.0; 9];
        let (mut angles, mut lengths) = (3..6, 6..9);
        for (value, c) in pose.iter_mut().zip(m.task_coordinates()) {
            *value += 0.02 * unit(&m, c.quantity);
            let axis = match (c.quantity, ["x", "y", "z"].iter().position(|name| *name == c.name)) {
                (Quantity::Length, Some(axis)) => axis,
                (Quantity::Length, None) => lengths.next().unwrap(),
                (Quantity::Angle, _) => angles.next().unwrap(),
            };
            axes[axis] = match c.quantity {
                Quantity::Length => *value * 1e3,
                Quantity::Angle => value.to_degrees(),
            };
        }
        let name = &m.mechanism().name;
        let Some(answer) = linuxcnc(&code, axes) else { return };
        let mut at = m.solution();
        let at = m.inverse(&pose, m.home_mode(), &mut at).unwrap();
        let at = at.unwrap_or_else(|| panic!("{name} does not reach a pose near home"));
        assert_eq!(answer[0], 0.0, "{name}");
        for (place, &joint) in m.actuated().iter().enumerate() {
            let expected = match m.coordinates()[joint].quantity {
                Quantity::Length => at.joints()[joint] * 1e3,
                Quantity::Angle => at.joints()[joint].to_degrees(),
            };
            assert!((answer[1 + place] - expected).abs() < 1e-8, "{name}: {answer:?}");
        }
        assert_eq!(answer[17], 0.0, "{name}: {answer:?}");
        for (axis, expected) in axes.iter().enumerate().filter(|(_, value)| **value != 0.0) {
            assert!((answer[18 + axis] - expected).abs() < 1e-6, "{name}: {answer:?} {axes:?}");
        }
    }
    assert!(modules > 8, "{modules}");
}
