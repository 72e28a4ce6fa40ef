//! Inverse kinematics of many poses at once, compared with one pose at a time: the results are
//! bitwise equal.

use fastrand::Rng;
use opm_core::manipulator::{BatchError, BatchOutput, Manipulator, Mode, PoseError};
use opm_core::mechanism::{examples, file};
use opm_tests::random::{LACKS, Options, PAIRS, constrained, mechanism};

const OPTIONS: Options = Options { limited: 0.3, balls: true };

/// The results of one pose at a time, and how many poses were solved, out of reach, and outside
/// limits.
#[derive(Default)]
struct Tally {
    reached: usize,
    beyond: usize,
    outside: usize,
}

/// Compares both ways on these poses in one mode.
fn check(manipulator: &Manipulator, poses: &[Vec<f64>], mode: Mode, tally: &mut Tally) {
    check_modes(manipulator, poses, &vec![mode; poses.len()], tally);
}

/// Compares both ways on these poses, each in a mode of its own, or in one.
fn check_modes(manipulator: &Manipulator, poses: &[Vec<f64>], modes: &[Mode], tally: &mut Tally) {
    let widths = [manipulator.coordinates().len(), manipulator.imaginary().len()];
    // Values that are not written must not pass for results.
    let mut joints = vec![1e99; poses.len() * widths[0]];
    let mut imaginary = vec![1e99; poses.len() * widths[1]];
    let (mut reachable, mut within) = (vec![false; poses.len()], vec![true; poses.len()]);
    let mut out = BatchOutput {
        joints: &mut joints,
        imaginary: &mut imaginary,
        reachable: &mut reachable,
        within_limits: &mut within,
    };
    let (batch, poses_in_rows) = (&mut manipulator.batch(), poses.concat());
    if modes.iter().all(|mode| *mode == modes[0]) {
        manipulator.inverse_many(&poses_in_rows, modes[0], batch, &mut out).unwrap();
    } else {
        manipulator.inverse_each(&poses_in_rows, modes, batch, &mut out).unwrap();
    }
    let mut solution = manipulator.solution();
    for (row, (pose, mode)) in poses.iter().zip(modes).enumerate() {
        let reached = manipulator.inverse(pose, *mode, &mut solution).unwrap().is_some();
        let name = &manipulator.mechanism().name;
        assert_eq!(reachable[row], reached, "{name}: {pose:?}");
        assert_eq!(within[row], reached && solution.within_limits(), "{name}: {pose:?}");
        let joints = &joints[row * widths[0]..][..widths[0]];
        let imaginary = &imaginary[row * widths[1]..][..widths[1]];
        if reached {
            // There is no tolerance: it is the same arithmetic.
            let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(joints), bits(solution.joints()), "{name}: {pose:?}");
            assert_eq!(bits(imaginary), bits(solution.imaginary()), "{name}: {pose:?}");
        } else {
            assert!(joints.iter().chain(imaginary).all(|v| v.is_nan()), "{name}: {pose:?}");
        }
        tally.reached += usize::from(reached);
        tally.beyond += usize::from(!reached);
        tally.outside += usize::from(reached && !solution.within_limits());
    }
}

/// Poses near home and far from it, on the axes of the sections' chains, and on the grid of quarter
/// revolutions, where sliders are parallel and arms are straight; a few count a million
/// revolutions.
fn poses(rng: &mut Rng, manipulator: &Manipulator, count: usize) -> Vec<Vec<f64>> {
    let home = manipulator.home_pose();
    (0..count)
        .map(|_| {
            let kind = rng.u32(..20);
            let reach = 2.5 * rng.f64() * rng.f64();
            let mut number = |home: f64| match kind {
                0 => home,
                1 => home + f64::from(rng.i32(-4..=4)) * std::f64::consts::FRAC_PI_2,
                2 => f64::from(rng.i32(-2..=2)),
                3 => 1e9 * (rng.f64() - 0.5),
                4 => home + 100.0 * (rng.f64() - 0.5),
                _ => home + reach * (rng.f64() * 2.0 - 1.0),
            };
            home.iter().map(|&home| number(home)).collect()
        })
        .collect()
}

/// Random modes.
fn some_modes(rng: &mut Rng, manipulator: &Manipulator, count: usize) -> Vec<Mode> {
    let sign = |rng: &mut Rng| if rng.bool() { '+' } else { '-' };
    (0..count)
        .map(|_| {
            let signs: String = (0..manipulator.choices()).map(|_| sign(rng)).collect();
            manipulator.parse_mode(&signs).unwrap()
        })
        .collect()
}

#[test]
fn many_poses_are_solved_as_one_is() {
    let mut rng = Rng::with_seed(3);
    for pair in PAIRS {
        let mut tally = Tally::default();
        for _ in 0..60 {
            let (mechanism, decomposition) = mechanism(&mut rng, pair, OPTIONS);
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            // Numbers of poses that fill whole blocks, and numbers with a remainder.
            let count = [1, 3, 9, 63, 64, 65, 150][rng.usize(..7)];
            let poses = poses(&mut rng, &manipulator, count);
            let some = some_modes(&mut rng, &manipulator, count);
            for mode in [manipulator.home_mode(), some[0]] {
                check(&manipulator, &poses, mode, &mut tally);
            }
            check_modes(&manipulator, &poses, &some, &mut tally);
        }
        let Tally { reached, beyond, outside } = tally;
        println!("{pair:?}: {reached} in reach, {outside} of them beyond limits, {beyond} not");
        assert!(reached > 500 && outside > 50, "{pair:?}: {reached} in reach, {outside} outside");
    }
}

/// Some mode, and two poses that are next to each other as numbers, of which that mode reaches one.
fn edge(rng: &mut Rng, manipulator: &Manipulator, mode: Mode) -> Option<[Vec<f64>; 2]> {
    let mut buffer = manipulator.solution();
    let mut reached =
        |pose: &[f64]| manipulator.inverse(pose, mode, &mut buffer).unwrap().is_some();
    let home = manipulator.home_pose();
    let beyond: Vec<f64> = home.iter().map(|home| home + 4.0 * (rng.f64() - 0.5)).collect();
    let at = |share: f64| -> Vec<f64> {
        home.iter().zip(&beyond).map(|(home, beyond)| home + share * (beyond - home)).collect()
    };
    let (mut inner, mut outer) = (0.0, 1.0);
    if !reached(&at(inner)) || reached(&at(outer)) {
        return None;
    }
    loop {
        let middle = 0.5 * (inner + outer);
        if middle <= inner || middle >= outer {
            return Some([at(inner), at(outer)]);
        }
        if reached(&at(middle)) { inner = middle } else { outer = middle }
    }
}

/// Legs with few freedoms tie coordinates together; further ones repeat their constraints, or have them met at home alone.
/// Some poses are on the edge of reach, where two solutions for the dependent coordinates meet.
#[test]
fn poses_with_dependent_coordinates_are_solved_as_one_is() {
    let mut rng = Rng::with_seed(5);
    let mut edges = 0;
    for pair in PAIRS {
        let mut tally = Tally::default();
        for (round, lacks) in (0..60).zip(LACKS.into_iter().cycle()) {
            let repeated = round % 4 == 3;
            let drawn = constrained(&mut rng, pair, lacks, repeated, OPTIONS);
            let Some((mechanism, decomposition)) = drawn else { continue };
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            let count = [1, 3, 9, 63, 64, 65, 150][rng.usize(..7)];
            let mut poses = poses(&mut rng, &manipulator, count);
            let some = some_modes(&mut rng, &manipulator, count);
            check_modes(&manipulator, &poses, &some, &mut tally);
            for mode in [manipulator.home_mode(), some[0]] {
                for _ in 0..5 {
                    let found = edge(&mut rng, &manipulator, mode);
                    edges += usize::from(found.is_some());
                    poses.extend(found.into_iter().flatten());
                }
                check(&manipulator, &poses, mode, &mut tally);
            }
        }
        let Tally { reached, beyond, outside } = tally;
        println!("{pair:?}: {reached} in reach, {outside} of them beyond limits, {beyond} not");
        assert!(reached + beyond == 0 || reached > 100, "{pair:?}: {reached} in reach");
    }
    assert!(edges > 500, "{edges}");
}

/// Every working mode of the shipped mechanisms.
#[test]
fn shipped_mechanisms_are_solved_as_one_is() {
    let mut rng = Rng::with_seed(4);
    for example in examples::EXAMPLES {
        let Ok(manipulator) = Manipulator::new(file::read(example.text).unwrap().mechanism) else {
            continue;
        };
        let mut tally = Tally::default();
        let home = manipulator.home_pose();
        let close: Vec<Vec<f64>> =
            (0..130).map(|_| home.iter().map(|h| h + 0.3 * (rng.f64() - 0.5)).collect()).collect();
        for number in 0..1_u32 << manipulator.choices() {
            let sign = |bit| if number >> bit & 1 == 0 { '+' } else { '-' };
            let signs: String = (0..manipulator.choices()).map(sign).collect();
            check(&manipulator, &close, manipulator.parse_mode(&signs).unwrap(), &mut tally);
        }
        // Poses that share all coordinates of the upper section do not share its choices.
        let mut row = vec![home.clone(); 70];
        row.iter_mut().for_each(|pose| pose[0] += 0.3 * (rng.f64() - 0.5));
        for poses in [&close, &row] {
            let some = some_modes(&mut rng, &manipulator, poses.len());
            check_modes(&manipulator, poses, &some, &mut tally);
        }
        assert!(tally.reached > 20, "{}: hardly any pose was in reach", example.name);
    }
}

/// The first invalid pose is reported by its index.
#[test]
fn an_invalid_pose_is_reported() {
    let manipulator = Manipulator::example("plano-spherical-5dof").unwrap();
    let mut poses = vec![manipulator.home_pose(); 100];
    poses[99][0] = f64::INFINITY;
    poses[77][3] = f64::NAN;
    let (mut joints, mut imaginary) = (vec![0.0; 2000], vec![0.0; 300]);
    let (mut reachable, mut within_limits) = ([false; 100], [false; 100]);
    let mut out = BatchOutput {
        joints: &mut joints,
        imaginary: &mut imaginary,
        reachable: &mut reachable,
        within_limits: &mut within_limits,
    };
    let mode = manipulator.home_mode();
    let error = manipulator.inverse_many(&poses.concat(), mode, &mut manipulator.batch(), &mut out);
    let error = error.unwrap_err();
    let expected = PoseError::NotFinite { name: "xi", value: f64::NAN };
    // NaN is not itself, so that messages are compared.
    assert_eq!(error.to_string(), format!("pose 77: {expected}"));
}

/// Slices of a wrong length are refused, and said by name; nothing is written.
#[test]
fn slices_of_a_wrong_length_are_refused() {
    let manipulator = Manipulator::example("plano-spherical-5dof").unwrap();
    let (joints, imaginary) = (manipulator.coordinates().len(), manipulator.imaginary().len());
    let lengths = [2 * joints, 2 * imaginary, 2, 2];
    let poses = [manipulator.home_pose(), manipulator.home_pose()].concat();
    for (number, slice) in
        ["joints", "imaginary", "reachable", "within_limits"].into_iter().enumerate()
    {
        for off in [-1_isize, 1] {
            let mut given = lengths;
            given[number] = given[number].strict_add_signed(off);
            let (mut values, mut cuts) = (vec![0.0; given[0]], vec![0.0; given[1]]);
            let (mut reachable, mut within_limits) = (vec![false; given[2]], vec![false; given[3]]);
            let mut out = BatchOutput {
                joints: &mut values,
                imaginary: &mut cuts,
                reachable: &mut reachable,
                within_limits: &mut within_limits,
            };
            let mode = manipulator.home_mode();
            let error = manipulator.inverse_many(&poses, mode, &mut manipulator.batch(), &mut out);
            let expected =
                BatchError::Output { slice, given: given[number], expected: lengths[number] };
            assert_eq!(error, Err(expected));
            assert!(!reachable.contains(&true));
        }
    }
    let mut out = BatchOutput {
        joints: &mut [],
        imaginary: &mut [],
        reachable: &mut [],
        within_limits: &mut [],
    };
    let mode = manipulator.home_mode();
    let error = manipulator.inverse_many(&poses[1..], mode, &mut manipulator.batch(), &mut out);
    assert_eq!(error, Err(BatchError::Poses { given: poses.len() - 1, width: 5 }));
    let error = manipulator.inverse_each(&poses, &[mode], &mut manipulator.batch(), &mut out);
    assert_eq!(error, Err(BatchError::Modes { given: 1, expected: 2 }));
}
