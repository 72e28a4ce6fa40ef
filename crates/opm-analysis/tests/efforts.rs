//! Efforts of shipped and of random mechanisms do no work together with the load, in the motions that inverse kinematics
//! give.

use fastrand::Rng;
use nalgebra::{DMatrix, Vector3};
use opm_analysis::{Balance, Gravity, Load, Loads, Setup, Statics, Wrench};
use opm_core::Manipulator;
use opm_core::manipulator::{Mode, Solution};
use opm_core::mechanism::Mechanism;
use opm_core::mechanism::examples::EXAMPLES;
use opm_core::skeleton::{Configuration, Density, Skeleton};
use opm_tests::differences::derivatives;
use opm_tests::random::{Options, PAIRS, constrained, mechanism};

/// Tolerance of a sum of work, relative to the sum of what is added.
const WORK: f64 = 1e-7;
/// A singular value relative to the largest, below which a random matrix is not taken for regular.
const REGULAR: f64 = 1e-4;

/// Derivatives by each task coordinate: of the actuated and of the imaginary joints, and of the displacements of the
/// platform and of the lower section, as a rotation and a translation.
struct Motions {
    actuated: DMatrix<f64>,
    imaginary: DMatrix<f64>,
    platform: DMatrix<f64>,
    lower: DMatrix<f64>,
    /// Of the sum of all masses times their places.
    moment: DMatrix<f64>,
}

/// `None` where a difference is not sure.
fn motions(manipulator: &Manipulator, at: &Solution, mode: Mode) -> Option<Motions> {
    let pose = at.pose().to_vec();
    let places = |at: &Solution| {
        let platform = manipulator.platform_at(&at.displacement(manipulator));
        [platform, at.lower_displacement(manipulator)]
    };
    let home = places(at);
    let skeleton = Skeleton::new(manipulator.mechanism(), None);
    let masses = skeleton.masses(manipulator.mechanism(), Density::default());
    let moment = |at: &Solution| {
        let platform = at.displacement(manipulator);
        let of = Configuration { joints: at.joints(), imaginary: &[], platform };
        let placed = skeleton.place_in_base(&of).unwrap();
        let each = placed.iter().zip(&masses).map(|(at, own)| (at * own.centre).coords * own.mass);
        each.sum::<Vector3<f64>>()
    };
    let count = [manipulator.actuated().len(), manipulator.imaginary().len(), 6, 6, 3];
    let mut tables = count.map(|rows| DMatrix::zeros(rows, pose.len()));
    for column in 0..pose.len() {
        let through = |t: f64| {
            let (mut moved, mut pose) = (at.clone(), pose.clone());
            pose[column] += t;
            manipulator.inverse_near(&pose, mode, &mut moved).unwrap()?;
            let joints = moved.joints();
            let mut values: Vec<f64> = manipulator.actuated().iter().map(|&i| joints[i]).collect();
            values.extend(moved.imaginary());
            for (now, then) in places(&moved).iter().zip(&home) {
                values.extend((now.rotation * then.rotation.inverse()).scaled_axis().iter());
                values.extend(now.translation.vector.iter());
            }
            values.extend(moment(&moved).iter());
            Some(values)
        };
        let found = derivatives(1e-3, through)?;
        if found.iter().any(|[first, _]| first.error > 1e-9 * (1.0 + first.value.abs())) {
            return None;
        }
        let mut rows = found.iter().map(|[first, _]| first.value);
        for table in &mut tables {
            for row in 0..table.nrows() {
                table[(row, column)] = rows.next().unwrap();
            }
        }
    }
    let [actuated, imaginary, platform, lower, moment] = tables;
    Some(Motions { actuated, imaginary, platform, lower, moment })
}

fn wrench(rng: &mut Rng) -> Wrench {
    Wrench::from_components(std::array::from_fn(|_| 20.0 * (rng.f64() - 0.5)))
}

/// The number of singular values above a share of the largest; `None` where that is not clear.
fn rank(matrix: &DMatrix<f64>) -> Option<usize> {
    let values = matrix.clone().svd(false, false).singular_values;
    let largest = values.max();
    let unclear = values.iter().any(|v| (1e-9 * largest..REGULAR * largest).contains(v));
    (!unclear).then(|| values.iter().filter(|v| **v > REGULAR * largest).count())
}

/// Whether each joint coordinate is in the lower section of its leg.
fn in_lower(manipulator: &Manipulator) -> Vec<bool> {
    let legs = manipulator.mechanism().legs.iter().zip(&manipulator.decomposition().legs);
    legs.flat_map(|(leg, split)| (0..leg.coordinates().count()).map(|i| i < split.lower.len()))
        .collect()
}

/// How often something was compared.
#[derive(Debug, Default)]
struct Counts {
    balanced: usize,
    driven: usize,
    undetermined: usize,
    imaginary: usize,
    singular: usize,
    stuck: usize,
}

fn check(manipulator: &Manipulator, at: &Solution, mode: Mode, rng: &mut Rng, counts: &mut Counts) {
    let length = manipulator.characteristic_length();
    let mut statics = Statics::new(manipulator, length);
    let load = wrench(rng);
    if !statics.update(at).unwrap() {
        counts.singular += 1;
        assert_eq!(statics.efforts(&load).balance, Balance::Singular);
        return;
    }
    let Some(motions) = motions(manipulator, at, mode) else { return };
    let efforts = statics.efforts(&load);
    let components = load.components();
    let [fx, fy, fz, mx, my, mz] = components;
    let load = DMatrix::from_row_slice(1, 6, &[mx, my, mz, fx, fy, fz]);
    let (Some(freedoms), Some(held)) = (rank(&motions.platform), rank(&motions.actuated)) else {
        return;
    };
    if freedoms < manipulator.task_coordinates().len() {
        // The coordinates are singular.
        return;
    }
    if motions.actuated.row_iter().any(|row| row.norm() < 1e-9) {
        // An actuated joint that cannot move (a revolute one where the platform never rotates) is no actuator: such a
        // mechanism is refused unless it is compiled by a decomposition, as here.
        counts.stuck += 1;
        return;
    }
    assert_eq!(statics.loose(), freedoms - held);
    assert_eq!(statics.internal(), manipulator.actuated().len() - held);
    if held < freedoms {
        // A random load moves it.
        assert_eq!(efforts.balance, Balance::Driven);
        assert!(efforts.actuated.iter().chain(&efforts.imaginary).all(Option::is_none));
        counts.driven += 1;
        return;
    }
    assert_eq!(efforts.balance, Balance::Balanced);
    // An effort is determined if no internal effort has a part in it.
    let square = &motions.actuated * motions.actuated.transpose();
    let kernel = square.svd(true, false).u.unwrap();
    for (row, effort) in efforts.actuated.iter().enumerate() {
        let part = kernel.row(row).columns(held, kernel.ncols() - held).norm();
        assert_eq!(effort.is_some(), part < 1e-5, "{part}");
    }
    // Rows for unit loads are the same efforts.
    for (row, effort) in efforts.actuated.iter().enumerate() {
        assert_eq!(statics.per_wrench(row).is_some(), effort.is_some());
        let (Some(each), Some(effort)) = (statics.per_wrench(row), effort) else { continue };
        let sum: f64 = each.iter().zip(components).map(|(a, b)| a * b).sum();
        let size: f64 = each.iter().zip(components).map(|(a, b)| (a * b).abs()).sum();
        assert!((sum - effort).abs() <= 1e-11 * size);
        let worst = statics.worst(row).unwrap();
        let along = Vector3::new(each[0], each[1], each[2]).dot(&worst.force);
        assert!((along - worst.per_force).abs() < 1e-12 * (1.0 + along));
    }
    let Some(known) = efforts.actuated.iter().copied().collect::<Option<Vec<_>>>() else {
        counts.undetermined += 1;
        return;
    };
    let work = &load * &motions.platform;
    for column in 0..motions.platform.ncols() {
        let rates = motions.actuated.column(column);
        let parts: Vec<f64> = rates.iter().zip(&known).map(|(r, e)| r * e).collect();
        let size = parts.iter().map(|part| part.abs()).sum::<f64>()
            + motions.platform.column(column).norm() * load.norm();
        let own: f64 = parts.iter().sum();
        assert!((own + work[column]).abs() < WORK * size, "{own} {} {size}", work[column]);
    }
    counts.balanced += 1;
    // The weight of all bodies on top of the load.
    let acceleration = Vector3::new(1.0, -4.0, -9.0);
    let gravity = Some(Gravity { acceleration, density: Density::default() });
    let wrench = Wrench::from_components(components);
    let load = Some(Load { wrench, ..Load::default() });
    let setup = Setup { load, gravity, ..Setup::new(length) };
    let mut loads = Loads::new(manipulator, &setup).unwrap();
    let weighed = loads.efforts(&statics, at).actuated;
    for column in 0..motions.platform.ncols() {
        let rates = motions.actuated.column(column);
        let parts = rates.iter().zip(&weighed).map(|(rate, effort)| rate * effort.unwrap());
        let parts: Vec<f64> = parts.collect();
        let weight = motions.moment.column(column).dot(&acceleration);
        let size = parts.iter().map(|part| part.abs()).sum::<f64>()
            + motions.moment.column(column).norm() * acceleration.norm()
            + motions.platform.column(column).norm() * wrench.force.norm();
        let own: f64 = parts.iter().sum();
        assert!((own + work[column] + weight).abs() < WORK * size, "{own} {weight} {size}");
    }
    // Where the lower section stands still, what its actuators do is what the imaginary joints do.
    let (lower, in_lower) = (manipulator.lower_coordinates(), in_lower(manipulator));
    let Some(imaginary) = efforts.imaginary.iter().copied().collect::<Option<Vec<_>>>() else {
        return;
    };
    for column in lower..motions.platform.ncols() {
        if imaginary.is_empty() || motions.lower.column(column).norm() > 1e-9 {
            continue;
        }
        let below = (manipulator.actuated().iter().enumerate())
            .filter(|(_, coordinate)| in_lower[**coordinate])
            .map(|(row, _)| known[row] * motions.actuated[(row, column)]);
        let between =
            imaginary.iter().enumerate().map(|(row, e)| e * motions.imaginary[(row, column)]);
        let (below, between): (Vec<f64>, Vec<f64>) = (below.collect(), between.collect());
        let size: f64 = below.iter().chain(&between).map(|part| part.abs()).sum();
        let apart = below.iter().sum::<f64>() - between.iter().sum::<f64>();
        assert!(apart.abs() < WORK * (size + 1e-3), "{below:?} {between:?}");
        counts.imaginary += usize::from(size > 1e-3);
    }
}

#[test]
fn shipped_mechanisms_are_in_balance() {
    let mut rng = Rng::with_seed(80);
    let mut counts = Counts::default();
    let mut seen = 0;
    for example in EXAMPLES {
        let Ok(manipulator) = Manipulator::read(example.text) else { continue };
        seen += 1;
        let (mut all, mut at) = (manipulator.all_modes(), manipulator.solution());
        for _ in 0..3 {
            let home = manipulator.home_pose();
            let pose: Vec<f64> = home.iter().map(|h| h + 0.05 * (rng.f64() - 0.5)).collect();
            if manipulator.inverse_all(&pose, &mut all).unwrap().is_none() {
                continue;
            }
            let modes: Vec<_> = all.modes(&manipulator).collect();
            for &mode in modes.iter().take(4) {
                manipulator.solution_in_mode(&all, mode, &mut at).unwrap();
                check(&manipulator, &at, mode, &mut rng, &mut counts);
            }
        }
    }
    assert!(seen > 15 && counts.balanced > 60, "{seen} {counts:?}");
    assert!(counts.imaginary > 10, "{counts:?}");
}

/// Takes the motors from joints that are drawn, until there are no more motors than freedoms.
fn drive(rng: &mut Rng, mechanism: &mut Mechanism, freedoms: usize) {
    let mut joints: Vec<_> = mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints).collect();
    rng.shuffle(&mut joints);
    let mut motors: usize = joints.iter().filter(|j| j.actuated).map(|j| j.freedoms()).sum();
    for joint in joints.into_iter().filter(|joint| joint.actuated) {
        if motors >= freedoms + joint.freedoms() {
            joint.actuated = false;
            motors -= joint.freedoms();
        }
    }
}

#[test]
fn random_mechanisms_are_in_balance() {
    let mut rng = Rng::with_seed(81);
    let mut counts = Counts::default();
    for pair in PAIRS {
        for round in 0..9 {
            let options = Options { limited: 0.0, balls: round % 2 == 0 };
            let drawn = match round {
                0..6 => Some(mechanism(&mut rng, pair, options)),
                _ => constrained(&mut rng, pair, [1, 0], false, options),
            };
            let Some((mut mechanism, decomposition)) = drawn else { continue };
            if round % 2 == 1 {
                drive(&mut rng, &mut mechanism, decomposition.mobility);
            }
            let Ok(manipulator) = Manipulator::with_decomposition(mechanism, decomposition) else {
                assert!(round >= 6);
                continue;
            };
            let (mut all, mut at) = (manipulator.all_modes(), manipulator.solution());
            let home = manipulator.home_pose();
            let pose: Vec<f64> = home.iter().map(|h| h + rng.f64() - 0.5).collect();
            if manipulator.inverse_all(&pose, &mut all).unwrap().is_none() {
                continue;
            }
            let modes: Vec<_> = all.modes(&manipulator).collect();
            for &mode in modes.iter().take(2) {
                manipulator.solution_in_mode(&all, mode, &mut at).unwrap();
                check(&manipulator, &at, mode, &mut rng, &mut counts);
            }
        }
    }
    assert!(counts.balanced > 60 && counts.driven > 60, "{counts:?}");
    assert!(counts.undetermined > 60 && counts.imaginary > 30, "{counts:?}");
}
