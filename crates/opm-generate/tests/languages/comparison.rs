//! The comparison of generated code with `opm-core`.

use crate::drawn::Drawn;
use crate::program::{Answer, Program, Question};
use fastrand::Rng;
use opm_analysis::{Dynamics, Setup};
use opm_core::manipulator::{ActuatedJoints, Solution};
use opm_core::nalgebra::{DVector, Isometry3};
use opm_core::velocity::Jacobians;
use opm_core::{Manipulator, Quantity};
use std::f64::consts::{PI, TAU};

/// How far a joint may be off, radians or metres over one or the joint's value, where the joints move no more than
/// [`GAIN`] times faster than the pose. Nearer to a singularity it is in proportion.
const ROUNDING: f64 = 1e-12;
const GAIN: f64 = 1e3;

/// A parallel measure of singularity above this is far from a singularity.
const REGULAR: f64 = 0.01;

/// How far efforts may be off, of the largest one, where the joints move as fast as the pose, and not too near to a parallel
/// singularity ([`REGULAR`]).
const EFFORTS: f64 = 1e-10;

/// How far the legs may be from the platform in `float`, radians or shares of the size: some ten operations' rounding.
const FLOAT: f64 = 1e-5;

/// What is compared at every pose, and what was compared.
struct Comparison<'a> {
    manipulator: &'a Manipulator,
    at: Solution,
    near: Solution,
    actuated: ActuatedJoints,
    jacobians: Jacobians,
    dynamics: Dynamics<'a>,
    reached: usize,
    missed: usize,
    /// Poses with rates; poses found by forward kinematics among those asked for.
    regular: usize,
    found: [usize; 2],
    /// Poses with efforts, and whether there are any to compare.
    driven: usize,
    has_dynamics: bool,
}

impl<'a> Comparison<'a> {
    fn new(manipulator: &'a Manipulator) -> Self {
        let [at, near] = [(), ()].map(|()| manipulator.solution());
        let actuated = manipulator.actuated_joints();
        let jacobians = manipulator.jacobians();
        let dynamics = Dynamics::new(manipulator, &Setup::new(manipulator.characteristic_length()));
        let (reached, missed, regular, found) = (0, 0, 0, [0; 2]);
        Self {
            manipulator,
            at,
            near,
            actuated,
            jacobians,
            dynamics,
            reached,
            missed,
            regular,
            found,
            driven: 0,
            has_dynamics: false,
        }
    }

    /// Whether a pose is reached in the mode at home, far from singularities.
    fn is_regular(&mut self, pose: &[f64]) -> bool {
        let m = self.manipulator;
        let question = Question { mode: m.home_mode(), pose: pose.to_vec(), next: pose.to_vec() };
        if m.inverse(pose, question.mode, &mut self.at).unwrap().is_none()
            || m.actuated().is_empty()
        {
            return false;
        }
        let (gain, _) = self.differences(&question);
        if gain > 30.0 || !m.differentiate(&self.at, &mut self.jacobians).unwrap() {
            return false;
        }
        let mut measured = m.singularities();
        m.measure_singularities(&self.jacobians, &mut measured);
        measured.whole.parallel.is_some_and(|parallel| parallel.abs() > REGULAR)
    }

    /// Whether Euler angles are singular at a pose.
    fn has_singular_angles(&self, pose: &[f64]) -> bool {
        let mut angles = self.manipulator.task_coordinates().iter().zip(pose);
        angles.any(|(c, value)| ["xi", "tilt"].contains(&c.name) && value.sin().abs() < 1e-9)
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
            if let Some((found, efforts)) = &answer.dynamics {
                assert!(
                    *found == status && efforts.iter().all(|&e| e == -77.0),
                    "{place}: {answer:?}"
                );
            }
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
        self.compare_dynamics(question, answer, gain, &place);
        self.compare_forward(question, answer, gain, &place);
    }

    /// The efforts are opm's.
    fn compare_dynamics(&mut self, question: &Question, answer: &Answer, gain: f64, place: &str) {
        let Some((status, efforts)) = &answer.dynamics else { return };
        self.has_dynamics = true;
        let m = self.manipulator;
        if gain > GAIN.sqrt() || !m.differentiate(&self.at, &mut self.jacobians).unwrap() {
            return;
        }
        let mut measured = m.singularities();
        m.measure_singularities(&self.jacobians, &mut measured);
        if measured.whole.parallel.is_none_or(|parallel| parallel.abs() < REGULAR) {
            return;
        }
        let of = |values: &[f64]| DVector::from_column_slice(values);
        if !self.dynamics.update(&self.at).unwrap() {
            return;
        }
        let expected = self.dynamics.inverse(&of(&question.next), &of(&question.pose));
        let Some(expected) = expected else { return };
        assert_eq!(*status, 0.0, "{place}: {gain:e} {answer:?}");
        let most = expected.iter().fold(1.0, |most: f64, effort| most.max(effort.abs()));
        for (found, expected) in efforts.iter().zip(&expected) {
            let off = (found - expected).abs() / most;
            assert!(
                off <= EFFORTS * gain * gain,
                "{place}: {off:e} {gain:e} {efforts:?} {expected}"
            );
        }
        self.driven += 1;
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
        self.compare_twist(answer, place);
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

    /// The platform's twist is opm's, for every coordinate.
    fn compare_twist(&self, answer: &Answer, place: &str) {
        let m = self.manipulator;
        if answer.twist_status != 0.0 {
            // Only where coordinates follow, and have no rates.
            assert_eq!(answer.twist_status, answer.jacobian_status, "{place}");
            return;
        }
        let expected = m.twist_by_pose(&self.jacobians);
        let columns = m.task_coordinates().len();
        for i in 0..6 {
            for (j, of_pose) in m.task_coordinates().iter().enumerate() {
                let unit = if i < 3 { 1.0 } else { m.characteristic_length() };
                let unit = unit / self::unit(m, of_pose.quantity);
                let far = 1.0 + expected[(i, j)].abs() / unit;
                let off = (answer.twist[i * columns + j] - expected[(i, j)]).abs() / unit;
                assert!(off <= 1e-9 * far * far, "{place}: {i} {j} {off:e} {:?}", answer.twist);
            }
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

    /// By how much faster than a pose that is reached the joints move.
    fn gain(&mut self, question: &Question) -> f64 {
        self.manipulator.inverse(&question.pose, question.mode, &mut self.at).unwrap();
        self.differences(question).0
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
            let section = missed.section.map_or(0, |section| section as usize);
            expected[2 * missed.leg + section] = missed.deficit.excess;
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
pub fn unit(m: &Manipulator, quantity: Quantity) -> f64 {
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

/// How exactly code is compared: in how many poses of each mechanism, drawn from a seed.
pub fn compare_all(program: &impl Program, manipulators: &[Manipulator], poses: usize, seed: u64) {
    let mut rng = Rng::with_seed(seed);
    let (mut reached, mut missed, mut regular, mut found) = (0, 0, 0, [0; 2]);
    let (mut driven, mut with_dynamics) = (0, 0);
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
        driven += comparison.driven;
        with_dynamics += usize::from(comparison.has_dynamics);
        assert_eq!(
            comparison.has_dynamics,
            opm_generate::check_dynamics(m).is_ok() && comparison.reached > 0
        );
        (0..2).for_each(|i| found[i] += comparison.found[i]);
    }
    println!(
        "{} mechanisms: {reached} poses in reach, {missed} out of it, {regular} regular, {found:?} found by forward kinematics, {driven} \
         with efforts of {with_dynamics} mechanisms",
        manipulators.len()
    );
    assert!(reached > missed / 4 && missed > 0, "{reached} {missed}");
    // A few random mechanisms may have them at few poses.
    assert!(with_dynamics < 20 || driven > 10 * with_dynamics, "{driven} {with_dynamics}");
    assert!(regular > reached / 2 && found[0] > found[1] / 10 * 9, "{regular} {found:?}");
}

/// From the home pose, forward kinematics find home itself, and poses about it: the platform is where the actuated joints were
/// computed from, and its angles are near home's. In many mechanisms the Euler angles are singular at home.
pub fn forward_leads_from_home(
    program: &impl Program,
    manipulators: &[Manipulator],
    poses: usize,
    seed: u64,
) {
    let mut rng = Rng::with_seed(seed);
    let (mut mechanisms, mut singular) = (0, 0);
    let (mut asked, mut same) = (0, 0);
    for (number, m) in manipulators.iter().enumerate() {
        let (home, mode, name) = (m.home_pose(), m.home_mode(), &m.mechanism().name);
        let mut comparison = Comparison::new(m);
        if !comparison.is_regular(&home) {
            continue;
        }
        let mut questions = Vec::new();
        for i in 0..=poses {
            let far = if i == 0 { 0.0 } else { 0.05 };
            let pose: Vec<f64> = (m.task_coordinates().iter().zip(&home))
                .map(|(c, home)| home + far * unit(m, c.quantity) * (2.0 * rng.f64() - 1.0))
                .collect();
            if comparison.is_regular(&pose) {
                questions.push(Question { mode, pose, next: home.clone() });
            }
        }
        let answers = program.ask(number, &questions);
        let (mut of_one, mut found) = (0, 0);
        for (question, answer) in questions.iter().zip(&answers) {
            let Some(forward) = &answer.forward else { continue };
            of_one += 1;
            if forward.status != 0.0 {
                continue;
            }
            let [to, wanted] = [&forward.pose, &question.pose]
                .map(|pose| m.platform_at(&m.displacement_in(pose, mode).unwrap()));
            let near = (m.task_coordinates().iter().zip(&forward.pose).zip(&home)).all(
                |((c, q), home)| c.quantity == Quantity::Length || (q - home).abs() < PI + 1e-9,
            );
            assert!(near, "{name}: {:?} from {home:?}", forward.pose);
            found += usize::from(m.platform_distance(&to, &wanted) < 1e-7);
        }
        if of_one > 0 {
            mechanisms += 1;
            singular += usize::from(comparison.has_singular_angles(&home));
            asked += of_one;
            same += found;
            let first = answers[0].forward.as_ref().map(|forward| forward.status);
            assert_eq!(first, Some(0.0), "{name}: home from home");
            assert!(10 * found >= 8 * of_one, "{name}: {found} of {of_one}");
        }
    }
    println!(
        "{mechanisms} mechanisms, {singular} with singular angles at home: {same} of {asked} poses found from there"
    );
    assert!(singular > 0 && 100 * same > 98 * asked, "{singular} {same} {asked}");
}

/// Joints in `float` close every leg. Poses that may be on either side of the boundary of reach are left out.
pub fn float_closes_every_leg(program: &impl Program, manipulators: &[Manipulator], poses: usize) {
    let mut rng = Rng::with_seed(5);
    for (number, m) in manipulators.iter().enumerate() {
        let mut questions = Drawn { rng: &mut rng, manipulator: m }.questions(poses);
        for question in &mut questions {
            question.pose.iter_mut().for_each(|value| *value = f64::from(*value as f32));
        }
        let answers = program.ask(number, &questions);
        let (mut at, mut comparison) = (m.solution(), Comparison::new(m));
        let (mut compared, mut worst) = (0, 0.0_f64);
        for (question, answer) in questions.iter().zip(&answers) {
            let Some(status) = surely(m, question, &mut at) else { continue };
            assert_eq!(answer.status, status, "{} at {:?}", m.mechanism().name, question.pose);
            if status == 0.0 {
                compared += 1;
                let g = m.displacement_in(&question.pose, question.mode).unwrap();
                // Where two branches of a coordinate that follows meet, it is as uncertain as it is fast.
                let gain = match m.dependent_coordinates().is_empty() {
                    true => 1.0,
                    false => comparison.gain(question),
                };
                worst = worst.max(open(m, &answer.joints, &g) / gain);
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
pub fn reach_ends_where_it_does_for_opm(
    program: &impl Program,
    manipulators: &[Manipulator],
    poses: usize,
) {
    /// Rounding of the boundary's place, as a share of the line: a pose nearer to it may be on either side.
    const BOUNDARY: f64 = 1e-9;
    let mut rng = Rng::with_seed(7);
    let mut lines = 0;
    for (number, m) in manipulators.iter().enumerate() {
        let mut at = m.solution();
        let drawn = Drawn { rng: &mut rng, manipulator: m }.questions(poses);
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
    assert!(lines > manipulators.len(), "{lines}");
}
