//! Condition numbers of many poses at once, compared with those of each pose by itself, which `velocity.rs` compares
//! with singular values of another program: equal to the bit, in one mode and in all.

use fastrand::Rng;
use opm_core::manipulator::{Manipulator, Mode, Solution};
use opm_core::mechanism::examples::EXAMPLES;
use opm_core::reach::AT_ONCE;
use opm_core::velocity::ConditionQuery;
use opm_tests::random::{LACKS, Options, PAIRS, constrained, mechanism};
use opm_workspace::{Conditioned, Modes, PoseLimit};

/// What is found of one pose: the condition number in the first admitted mode, and the ranges of the imaginary joints over
/// all admitted modes.
type ConditionFound = (Option<f64>, Vec<[f64; 2]>);

const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

/// One mode after the other, each by the functions for one pose.
fn by_modes(
    manipulator: &Manipulator,
    pose: &[f64],
    mode: Option<Mode>,
    limit: &PoseLimit,
) -> ConditionFound {
    let mut jacobians = manipulator.jacobians();
    let mut at: Solution = manipulator.solution();
    let (mut first, mut ranges) = (None, vec![NOTHING; manipulator.imaginary().len()]);
    let modes: Vec<Mode> = mode.map_or_else(|| manipulator.modes().collect(), |mode| vec![mode]);
    for mode in modes {
        let Some(solution) = manipulator.inverse(pose, mode, &mut at).unwrap() else { continue };
        if !solution.within_limits() {
            continue;
        }
        manipulator.differentiate(solution, &mut jacobians).unwrap();
        let condition = manipulator.conditioning(&jacobians, limit.length()).condition;
        if condition > limit.most {
            continue;
        }
        first.get_or_insert(condition);
        for (range, &value) in ranges.iter_mut().zip(solution.imaginary()) {
            *range = [range[0].min(value), range[1].max(value)];
        }
    }
    (first, ranges)
}

/// How many poses were compared.
#[derive(Default)]
struct Compared {
    poses: usize,
    admitted: usize,
    refused: usize,
    together: usize,
    singular: usize,
}

impl Compared {
    /// Whether there were at least so many of each kind: admitted, refused and singular.
    fn assert_many(&self, least: [usize; 3]) {
        let Self { poses, admitted, refused, together, singular } = *self;
        let found = [admitted, refused, singular];
        println!("{poses} poses, {together} together; admitted, refused, singular: {found:?}");
        assert!(found.iter().zip(&least).all(|(found, least)| found >= least), "{found:?}");
    }
}

/// Compares all poses, row after row, decided together, with each by itself.
fn compare(
    manipulator: &Manipulator,
    poses: &[f64],
    mode: Option<Mode>,
    limit: PoseLimit,
    compared: &mut Compared,
) {
    let width = manipulator.task_coordinates().len();
    let mut batch = manipulator.condition_batch();
    for every in [false, true] {
        let query = ConditionQuery { mode, length: limit.length(), most: limit.most, every };
        for block in poses.chunks(AT_ONCE * width) {
            let count = block.len() / width;
            let mut conditions = vec![0.0; count];
            let mut ranges = vec![NOTHING; manipulator.imaginary().len()];
            let mut used = |number: usize, [low, high]: [f64; 2]| {
                ranges[number] = [ranges[number][0].min(low), ranges[number][1].max(high)];
            };
            let open =
                manipulator.condition_many(block, &query, &mut batch, &mut conditions, &mut used);
            let mut expected_ranges = vec![NOTHING; ranges.len()];
            for (i, pose) in block.chunks(width).enumerate() {
                if open >> i & 1 == 1 {
                    continue;
                }
                let (first, of_pose) = by_modes(manipulator, pose, mode, &limit);
                let found = Some(conditions[i]).filter(|condition| !condition.is_nan());
                assert_eq!(found, first, "{pose:?} {mode:?} {limit:?}");
                for (range, [low, high]) in expected_ranges.iter_mut().zip(of_pose) {
                    *range = [range[0].min(low), range[1].max(high)];
                }
                compared.together += 1;
                compared.admitted += usize::from(first.is_some());
                compared.refused += usize::from(first.is_none());
                compared.singular += usize::from(first.is_some_and(f64::is_infinite));
            }
            let expected = if every { expected_ranges } else { vec![NOTHING; ranges.len()] };
            for (range, expected) in ranges.iter().zip(&expected) {
                // Their values in a block differ by the rounding of an arc tangent.
                let near = |a: f64, b: f64| a == b || (a - b).abs() < 1e-14;
                assert!(near(range[0], expected[0]) && near(range[1], expected[1]));
            }
        }
    }
    // The same by the function that decides the other ones by themselves.
    let mut conditioned = Conditioned::new(manipulator, limit);
    let modes = mode.map_or(Modes::Any, Modes::One);
    let mut indices = vec![0.0; poses.len() / width];
    conditioned.local_indices(poses, modes, &mut indices);
    for (pose, &index) in poses.chunks(width).zip(&indices) {
        let alone = conditioned.local_index(pose, modes);
        assert_eq!(Some(index).filter(|index| !index.is_nan()), alone, "{pose:?}");
    }
    compared.poses += indices.len();
}

/// Poses about home: some in reach, some beyond it, some at home, some on the axes, and some far away.
fn poses(rng: &mut Rng, manipulator: &Manipulator, count: usize) -> Vec<f64> {
    let size = manipulator.characteristic_length();
    let mut poses = Vec::new();
    for _ in 0..count {
        let reach = [0.0, 0.1, 0.4, 1.0, 100.0][rng.usize(..5)];
        for coordinate in manipulator.task_coordinates() {
            let angle = coordinate.quantity == opm_core::Quantity::Angle;
            let unit = if angle { 1.0 } else { size };
            let step = match rng.u8(..4) {
                0 => 0.0,
                1 if angle => std::f64::consts::FRAC_PI_2,
                _ => reach * (2.0 * rng.f64() - 1.0),
            };
            poses.push(coordinate.home + unit * step);
        }
    }
    poses
}

fn limits(rng: &mut Rng, manipulator: &Manipulator) -> PoseLimit {
    let length = manipulator.characteristic_length() * (0.3 + rng.f64());
    let most = [f64::INFINITY, 1e9, 1e3, 30.0, 8.0, 3.0][rng.usize(..6)];
    PoseLimit::none(length).with_condition(most)
}

#[test]
fn random_mechanisms() {
    let mut rng = Rng::with_seed(31);
    let mut compared = Compared::default();
    for round in 0..24 {
        for pair in PAIRS {
            let limited = if round % 2 == 0 { 0.0 } else { 0.2 };
            let options = Options { limited, balls: round % 3 != 0 };
            let (mut mechanism, decomposition) = mechanism(&mut rng, pair, options);
            // As many actuators as they have, more than freedoms, and at random.
            for joint in mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints) {
                joint.actuated |= match round % 4 {
                    0 => false,
                    1 => true,
                    _ => rng.bool(),
                };
            }
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            let count = [1, 15, 64, 70][rng.usize(..4)];
            let poses = poses(&mut rng, &manipulator, count);
            let limit = limits(&mut rng, &manipulator);
            let mode = match rng.u8(..3) {
                0 if manipulator.choices() <= 7 => None,
                1 => Some(Mode::default()),
                _ => Some(manipulator.home_mode()),
            };
            compare(&manipulator, &poses, mode, limit, &mut compared);
        }
    }
    compared.assert_many([3_000, 3_000, 100]);
}

/// Where coordinates depend on others, all poses are decided together in one mode; in any, those that are out of reach.
#[test]
fn constrained_mechanisms() {
    let mut rng = Rng::with_seed(33);
    let mut compared = Compared::default();
    for (round, lacks) in (0..20).zip(LACKS.into_iter().cycle()) {
        for pair in PAIRS {
            let options = Options { limited: 0.2, balls: round % 3 != 0 };
            let drawn = constrained(&mut rng, pair, lacks, round % 4 == 3, options);
            let Some((mechanism, decomposition)) = drawn else { continue };
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            let poses = poses(&mut rng, &manipulator, 70);
            let limit = limits(&mut rng, &manipulator);
            for mode in [None, Some(manipulator.home_mode())] {
                if mode.is_some() || manipulator.choices() <= 5 {
                    compare(&manipulator, &poses, mode, limit.clone(), &mut compared);
                }
            }
        }
    }
    compared.assert_many([1_000, 3_000, 100]);
}

#[test]
fn shipped_mechanisms() {
    let mut rng = Rng::with_seed(32);
    let mut compared = Compared::default();
    for example in EXAMPLES {
        let Ok(manipulator) = Manipulator::example(example.name) else { continue };
        for mode in [None, Some(Mode::default()), Some(manipulator.home_mode())] {
            if mode.is_none() && manipulator.choices() > 7 {
                continue;
            }
            let poses = poses(&mut rng, &manipulator, 40);
            let limit = limits(&mut rng, &manipulator);
            compare(&manipulator, &poses, mode, limit, &mut compared);
        }
    }
    compared.assert_many([500, 500, 0]);
}

/// Poses on the way to a parallel singularity of the first manipulator, nearer and nearer, and beyond it.
#[test]
fn near_singularities() {
    let manipulator = Manipulator::example("plano-spherical-5dof").unwrap();
    let (mode, length) = (manipulator.home_mode(), manipulator.characteristic_length());
    let mut jacobians = manipulator.jacobians();
    let (mut at, mut measured) = (manipulator.solution(), manipulator.singularities());
    let mut rng = Rng::with_seed(33);
    let mut compared = Compared::default();
    let mut crossed = 0;
    for _ in 0..400 {
        let ends: [Vec<f64>; 2] = std::array::from_fn(|_| poses(&mut rng, &manipulator, 1));
        let between = |t: f64| -> Vec<f64> {
            ends[0].iter().zip(&ends[1]).map(|(a, b)| a + t * (b - a)).collect()
        };
        let mut measure = |t: f64| {
            manipulator.inverse(&between(t), mode, &mut at).unwrap()?;
            manipulator.differentiate(&at, &mut jacobians).unwrap();
            manipulator.measure_singularities(&jacobians, &mut measured);
            measured.whole.parallel
        };
        let (mut low, mut high) = (0.0, 1.0);
        let (Some(a), Some(b)) = (measure(low), measure(high)) else { continue };
        if a * b >= 0.0 {
            continue;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            match measure(middle) {
                Some(value) if value * a > 0.0 => low = middle,
                Some(_) => high = middle,
                None => break,
            }
        }
        crossed += 1;
        let near = (0..32).map(|i| low + 10_f64.powf(-0.5 * f64::from(i)));
        let far = (0..32).map(|i| low - 10_f64.powf(-0.5 * f64::from(i)));
        let poses: Vec<f64> = near.chain(far).chain([low, high]).flat_map(between).collect();
        for most in [1e3, 1e6, 1e9, 1e12, f64::INFINITY] {
            let limit = PoseLimit::none(length).with_condition(most);
            compare(&manipulator, &poses, Some(mode), limit, &mut compared);
        }
    }
    println!("{crossed} singularities, {} admitted", compared.admitted);
    assert!(crossed > 10 && compared.admitted > 1_000, "{crossed} {}", compared.admitted);
}
