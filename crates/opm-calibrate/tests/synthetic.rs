//! Machines that are made off their drawings, and measured with noise: what is found is what they are.
//!
//! The machine is a mechanism of its own, and its closed forms give what is measured.

use fastrand::Rng;
use opm_calibrate::{
    CalibrateError, Calibration, Column, Measurements, Options, Sigma, calibrate, parameters_of,
    with_changes,
};
use opm_core::Quantity;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::examples::{SPLIT, find};
use opm_core::mechanism::file::{self, MechanismFile};

const SIGMA: Sigma = Sigma { length: 20e-6, angle: 20e-6 };

fn read(name: &str) -> MechanismFile {
    file::read(find(name).unwrap().text).unwrap()
}

/// A normal number (G. Box, M. Muller, 1958).
fn normal(rng: &mut Rng) -> f64 {
    (-2.0 * (1.0 - rng.f64()).ln()).sqrt() * (std::f64::consts::TAU * rng.f64()).cos()
}

struct Machine {
    drawing: MechanismFile,
    /// How far it is off.
    off: Vec<f64>,
    real: Manipulator,
}

impl Machine {
    /// A machine whose parameters are off by up to 0.2 mm and 0.2 mrad.
    fn new(drawing: MechanismFile, rng: &mut Rng) -> Self {
        let parameters = parameters_of(&drawing).unwrap();
        let off: Vec<f64> = parameters.iter().map(|_| 2e-4 * (2.0 * rng.f64() - 1.0)).collect();
        let made = with_changes(&drawing, &parameters, &off).unwrap();
        let real = Manipulator::new(made.mechanism).unwrap();
        Self { drawing, off, real }
    }

    /// Poses in reach, and within limits where there are any.
    fn poses(&self, count: usize, rng: &mut Rng) -> Vec<Vec<f64>> {
        let (mut poses, mut at) = (Vec::new(), self.real.solution());
        let length = self.real.characteristic_length();
        let mut jacobians = self.real.jacobians();
        for _ in 0..200_000 {
            let mut pose = self.real.home_pose();
            for (value, c) in pose.iter_mut().zip(self.real.task_coordinates()) {
                let unit = if c.quantity == Quantity::Angle { 0.5 } else { 0.7 * length };
                *value += (2.0 * rng.f64() - 1.0) * unit;
            }
            let found = self.real.inverse(&pose, self.real.home_mode(), &mut at).unwrap();
            // Far enough from singular that noise stays small.
            let fits = found.is_some_and(|found| {
                self.real.differentiate(found, &mut jacobians).unwrap()
                    && self.real.conditioning(&jacobians, length).condition < 30.0
            });
            if fits {
                poses.push(pose);
            }
            if poses.len() == count {
                return poses;
            }
        }
        panic!("{}: {} poses", self.real.mechanism().name, poses.len());
    }

    /// The values of all columns at some poses, with noise.
    fn measured(
        &self,
        columns: &[&str],
        poses: &[Vec<f64>],
        noise: f64,
        rng: &mut Rng,
    ) -> Measurements {
        let columns: Vec<Column> =
            columns.iter().map(|name| Column::named(name, &self.real, &[]).unwrap()).collect();
        let mut at = self.real.solution();
        let row = |pose: &Vec<f64>| {
            let found = self.real.inverse(pose, self.real.home_mode(), &mut at).unwrap();
            let joints = found.expect("a pose in reach").joints().to_vec();
            let platform = self.real.platform_pose(pose).unwrap();
            let value = |column: &Column| {
                let named =
                    |name: &str| self.real.coordinates().iter().position(|c| c.name == name);
                let coordinates = self.real.task_coordinates();
                let exact = match coordinates.iter().position(|c| c.name == column.name) {
                    Some(number) => pose[number],
                    None => match (named(&column.name), column.name.split_once('.')) {
                        (Some(number), _) => joints[number],
                        (None, Some(("point", "x"))) => platform.translation.x,
                        (None, Some(("point", "y"))) => platform.translation.y,
                        (None, Some(("point", "z"))) => platform.translation.z,
                        (None, Some(("incline", axis))) => {
                            let axis = if axis == "x" {
                                nalgebra::Vector3::x()
                            } else {
                                nalgebra::Vector3::y()
                            };
                            (platform.rotation * axis).z.asin()
                        }
                        other => panic!("{other:?}"),
                    },
                };
                let sigma = match column.quantity {
                    Quantity::Length => SIGMA.length,
                    Quantity::Angle => SIGMA.angle,
                };
                Some(exact + noise * sigma * normal(rng))
            };
            columns.iter().map(value).collect()
        };
        let rows = poses.iter().map(row).collect();
        Measurements { columns: columns.clone(), rows }
    }

    /// The pose on the way from home through a pose at which reach ends, but for a share of the way; `None` if it does not end.
    fn near_boundary(&self, pose: &[f64], near: f64) -> Option<Vec<f64>> {
        let home = self.real.home_pose();
        let on_way = |share: f64| -> Vec<f64> {
            home.iter().zip(pose).map(|(home, pose)| home + share * (pose - home)).collect()
        };
        let mut at = self.real.solution();
        let mut reached = |share: f64| {
            self.real.inverse(&on_way(share), self.real.home_mode(), &mut at).unwrap().is_some()
        };
        let (mut within, mut beyond) = (1.0, 20.0);
        if reached(beyond) {
            return None;
        }
        for _ in 0..60 {
            let middle = 0.5 * (within + beyond);
            *(if reached(middle) { &mut within } else { &mut beyond }) = middle;
        }
        Some(on_way(within * (1.0 - near)))
    }

    fn all_columns(&self) -> Vec<String> {
        Column::all(&self.real).into_iter().map(|column| column.name).collect()
    }

    /// The deviation of each determined parameter from the truth, in standard errors.
    fn scores(&self, found: &Calibration) -> Vec<(String, f64)> {
        let each = found.parameters.iter().zip(&self.off);
        each.filter_map(|(estimate, off)| {
            let error = estimate.after - estimate.before - off;
            Some((estimate.name.clone(), error / estimate.standard_error?))
        })
        .collect()
    }
}

fn options() -> Options {
    Options { sigma: Some(SIGMA), ..Options::default() }
}

fn solve(machine: &Machine, measured: &Measurements, options: &Options) -> Calibration {
    calibrate(&machine.drawing, measured, options, &mut |_| true).unwrap()
}

/// Mechanisms of both forms: planar, spherical and spatial ones.
const TEN: [&str; 10] = [
    "plano-spherical-5dof",
    "plano-spherical-5dof-joints",
    "planar-planar-5dof",
    "translational-helical-3dof-joints",
    "double-spherical-5dof",
    "plano-cylindrical-4dof",
    "planar-3rrr",
    "agile-eye",
    "five-bar",
    "schoenflies-lift-4dof",
];

fn whole(name: &str, seed: u64) -> (Machine, Measurements) {
    let mut rng = Rng::with_seed(seed);
    let machine = Machine::new(read(name), &mut rng);
    let names = machine.all_columns();
    let columns: Vec<&str> = names.iter().map(String::as_str).collect();
    let poses = machine.poses(40, &mut rng);
    let measured = machine.measured(&columns, &poses, 1.0, &mut rng);
    (machine, measured)
}

/// Of normal errors, one in 370 is beyond three standard errors: with other seeds one of these three hundred may be. The next
/// test looks at many seeds.
#[test]
fn what_can_be_told_of_ten_mechanisms_is_within_three_standard_errors() {
    let mut told = 0;
    for name in TEN {
        let (machine, measured) = whole(name, 1);
        let found = solve(&machine, &measured, &options());
        let scores = machine.scores(&found);
        let worst = scores.iter().map(|s| s.1.abs()).fold(0.0, f64::max);
        let deviation = found.deviation.unwrap();
        println!(
            "{name:34} {:2} parameters, {:2} told, worst {worst:.2} standard errors, deviation {:.1} -> {deviation:.3}",
            found.parameters.len(),
            scores.len(),
            found.deviation_before.unwrap(),
        );
        assert!(found.unused.is_empty());
        assert!(worst < 3.0, "{name}: {scores:?}");
        // Its own standard deviation is 1 / sqrt(2 surplus), at most 0.12 here.
        assert!((0.7..1.3).contains(&deviation), "{name}: {deviation}");
        assert_eq!(found.play.combinations, 0, "{name}");
        told += scores.len();
    }
    assert!(told > 230, "{told}");
}

#[test]
fn errors_are_as_large_as_standard_errors_say() {
    let (mut mechanisms, mut all) = (0, Vec::new());
    for example in SPLIT {
        let Ok(drawing) = file::read(example.text) else { continue };
        if Manipulator::new(drawing.mechanism).is_err() {
            continue;
        }
        mechanisms += 1;
        for seed in 10..16 {
            let (machine, measured) = whole(example.name, seed);
            all.extend(
                machine.scores(&solve(&machine, &measured, &options())).into_iter().map(|s| s.1),
            );
        }
    }
    let n = all.len() as f64;
    let square = all.iter().map(|s| s * s).sum::<f64>() / n;
    let beyond = all.iter().filter(|s| s.abs() > 3.0).count() as f64 / n;
    println!(
        "{mechanisms} mechanisms, {n} errors, mean square {square:.4}, beyond three: {beyond:.5}"
    );
    assert!(mechanisms >= 19 && n > 2000.0);
    // Errors of one machine are correlated: some 19 · 6 · 10 of them count by themselves.
    assert!((square - 1.0).abs() < 0.1, "{square}");
    assert!(beyond < 0.0027 * 2.5, "{beyond}");
}

/// Without noise the truth is found, and the file that is written has it, in its class.
#[test]
fn exact_measurements_give_the_machine() {
    for name in TEN {
        let mut rng = Rng::with_seed(3);
        let machine = Machine::new(read(name), &mut rng);
        let names = machine.all_columns();
        let columns: Vec<&str> = names.iter().map(String::as_str).collect();
        let poses = machine.poses(40, &mut rng);
        let measured = machine.measured(&columns, &poses, 0.0, &mut rng);
        let found = solve(&machine, &measured, &options());
        for (estimate, off) in found.parameters.iter().zip(&machine.off) {
            let error = (estimate.after - estimate.before - off).abs();
            // What is not told moves what is, to second order: 0.2 mm squared, over the size.
            let most = if found.held.is_empty() { 1e-9 } else { 1e-6 };
            assert!(!estimate.identifiable || error < most, "{name} {}: {error}", estimate.name);
        }
        let again = file::read(&found.text()).unwrap();
        let calibrated = Manipulator::new(again.mechanism).unwrap();
        let (a, b) = (calibrated.decomposition(), machine.real.decomposition());
        assert_eq!((a.lower.name(), a.upper.name()), (b.lower.name(), b.upper.name()), "{name}");
        let drawn = Manipulator::new(machine.drawing.mechanism.clone()).unwrap();
        let before = drawn.decomposition().deviation;
        assert!(a.deviation < before + 1e-9, "{name}: {} was {before}", a.deviation);
        // It shows what the machine shows at other poses.
        let [mut at, mut real] = [calibrated.solution(), machine.real.solution()];
        for pose in machine.poses(5, &mut rng) {
            let mode = machine.real.home_mode();
            let found = calibrated.inverse(&pose, mode, &mut at).unwrap().unwrap();
            let real = machine.real.inverse(&pose, mode, &mut real).unwrap().unwrap();
            for &joint in calibrated.actuated() {
                let off = (found.joints()[joint] - real.joints()[joint]).abs();
                assert!(off < 1e-6, "{name}: {off}");
            }
        }
    }
}

#[test]
fn parts_of_poses_tell_less_and_not_wrongly() {
    let mut rng = Rng::with_seed(5);
    let machine = Machine::new(read("plano-spherical-5dof"), &mut rng);
    let names: Vec<String> = machine.all_columns();
    let joints: Vec<&str> = names
        .iter()
        .map(String::as_str)
        .filter(|n| n.starts_with('S') || n.starts_with("phi"))
        .collect();
    let poses = machine.poses(60, &mut rng);
    let columns: Vec<&str> =
        joints.iter().copied().chain(["point.x", "point.y", "incline.x", "incline.y"]).collect();
    let mut measured = machine.measured(&columns, &poses, 1.0, &mut rng);
    // Some cells are empty, and one row altogether.
    measured.rows[3][1] = None;
    measured.rows[4].fill(None);
    let part = solve(&machine, &measured, &options());
    assert_eq!(part.unused, [4]);
    let scores = machine.scores(&part);
    // All of them, but for what a heading would tell.
    println!("{} of {} told", scores.len(), part.parameters.len());
    assert!(scores.len() > 15 && scores.iter().all(|s| s.1.abs() < 4.0), "{scores:?}");
    // All values tell at least as much.
    let all: Vec<&str> = names.iter().map(String::as_str).collect();
    let measured = machine.measured(&all, &poses, 1.0, &mut rng);
    let whole = solve(&machine, &measured, &options());
    for (a, b) in part.parameters.iter().zip(&whole.parameters) {
        if let (Some(a), Some(b)) = (a.standard_error, b.standard_error) {
            assert!(a > 0.9 * b, "{a} {b}");
        }
    }
    // As many values as coordinates say nothing.
    let five = machine.measured(&joints, &poses, 1.0, &mut rng);
    let error = calibrate(&machine.drawing, &five, &options(), &mut |_| true).unwrap_err();
    assert!(error.to_string().contains("say nothing of the parameters"), "{error}");
}

/// A slider's pitch and its encoder: what acts alike is named together.
#[test]
fn what_acts_alike_is_named_together() {
    let (machine, measured) = whole("translational-helical-3dof", 2);
    let found = solve(&machine, &measured, &options());
    // S = n·P + sin(beta) k: k and the offset act alike, with beta = 45 degrees in leg 1.
    let of_leg = |leg: &str| {
        let mut held = found.held.iter();
        held.find(|held| held.terms[0].0.starts_with(leg)).unwrap().terms.clone()
    };
    let terms = of_leg("leg1");
    assert_eq!((&*terms[0].0, &*terms[1].0), ("leg1.k", "leg1.offset.S"));
    assert!((terms[1].1 + std::f64::consts::FRAC_1_SQRT_2).abs() < 1e-6, "{terms:?}");
    let k = found.parameters.iter().find(|p| p.name == "leg1.k").unwrap();
    assert!(!k.identifiable && k.standard_error.is_none());
    // Each alone is told.
    let alone = Options { hold: vec!["offset".into()], ..options() };
    let found = solve(&machine, &measured, &alone);
    assert!(found.held.is_empty() && found.parameters.iter().all(|p| p.identifiable));
}

#[test]
fn outliers_are_found_and_left_out() {
    let (machine, mut measured) = whole("plano-spherical-5dof", 6);
    let s1 = measured.columns.iter().position(|column| column.name == "S1").unwrap();
    *measured.rows[11][s1].as_mut().unwrap() += 1e-3;
    *measured.rows[30][0].as_mut().unwrap() -= 0.5e-3;
    let found = solve(&machine, &measured, &options());
    assert!(found.cells.iter().any(|cell| cell.outlier && (cell.row, cell.column) == (11, s1)));
    for options in [options(), Options::default()] {
        let options = Options { reject_outliers: true, ..options };
        let found = solve(&machine, &measured, &options);
        let rejected: Vec<_> = found.cells.iter().filter(|cell| cell.rejected).collect();
        let places: Vec<_> = rejected.iter().map(|cell| (cell.row, cell.column)).collect();
        assert_eq!(places, [(11, s1), (30, 0)]);
        assert!((rejected[0].residual - 1e-3).abs() < 2e-4, "{rejected:?}");
        let scores = machine.scores(&found);
        assert!(scores.iter().all(|s| s.1.abs() < 3.5), "{scores:?}");
    }
}

/// Chosen poses tell more than as many that are drawn.
#[test]
fn a_plan_tells_more_than_chance() {
    let drawing = read("plano-spherical-5dof");
    let manipulator = Manipulator::new(drawing.mechanism.clone()).unwrap();
    let progress = opm_workspace::Progress::default();
    let drawn = opm_calibrate::candidates(&manipulator, manipulator.home_mode(), 200, 3, &progress);
    let drawn = drawn.unwrap();
    let columns = Column::all(&manipulator);
    let of = |poses: &[Vec<f64>]| {
        opm_calibrate::plan(&drawing, &columns, poses, 20, &options(), &progress).unwrap()
    };
    let chosen = of(&drawn);
    assert_eq!((chosen.chosen.len(), chosen.rank, chosen.rank_of_all), (20, 33, 33));
    assert!(chosen.log_determinant[1] >= chosen.log_determinant[0]);
    // All of twenty drawn ones.
    let chance = of(&drawn[..20]);
    assert!(chosen.log_determinant[1] > chance.log_determinant[1] + 10.0);
    let errors = |plan: &opm_calibrate::Plan| -> Vec<f64> {
        plan.parameters.iter().map(|p| p.2.unwrap()).collect()
    };
    let better = errors(&chosen).iter().zip(errors(&chance)).filter(|(a, b)| *a < b).count();
    assert!(better > 28, "{better}");
    // The same standard errors as a calibration at these poses finds.
    let mut rng = Rng::with_seed(8);
    let mut machine = Machine::new(drawing.clone(), &mut rng);
    machine.real = manipulator;
    let poses: Vec<Vec<f64>> = chosen.chosen.iter().map(|&k| drawn[k].clone()).collect();
    let names: Vec<&str> = columns.iter().map(|column| &*column.name).collect();
    let measured = machine.measured(&names, &poses, 0.0, &mut rng);
    let found = solve(&machine, &measured, &options());
    for (planned, found) in chosen.parameters.iter().zip(&found.parameters) {
        let (planned, found) = (planned.2.unwrap(), found.standard_error.unwrap());
        assert!((planned / found - 1.0).abs() < 1e-3, "{planned} {found}");
    }
}

/// Axes off in any direction leave the class. First order says what the platform and the joints do then; the part that the
/// class can explain is calibrated, and the rest shows as play.
#[test]
fn errors_that_leave_the_class_show_as_play() {
    let drawing = read("plano-spherical-5dof-joints");
    let manipulator = Manipulator::new(drawing.mechanism.clone()).unwrap();
    let model = opm_accuracy::Model::new(&manipulator, None, opm_accuracy::ErrorModel::Axes);
    let mut rng = Rng::with_seed(9);
    let errors: Vec<f64> = model
        .sources()
        .iter()
        .map(|source| {
            let size = match source.quantity {
                Quantity::Length => 0.05e-3,
                Quantity::Angle => 0.02_f64.to_radians(),
            };
            if source.is_actuator() { 0.0 } else { size * (2.0 * rng.f64() - 1.0) }
        })
        .collect();
    let errors = nalgebra::DVector::from_vec(errors);
    let mut machine = Machine::new(drawing.clone(), &mut rng);
    machine.real = manipulator.clone();
    let poses = machine.poses(40, &mut rng);
    let names = machine.all_columns();
    let columns: Vec<&str> = names.iter().map(String::as_str).collect();
    // A finer instrument: play is small.
    let mut measured = machine.measured(&columns, &poses, 0.05, &mut rng);
    let sigma = Sigma { length: 1e-6, angle: 1e-6 };
    let (mut at, mut played) = (manipulator.solution(), 0.0_f64);
    for (pose, row) in poses.iter().zip(&mut measured.rows) {
        let at = manipulator.inverse(pose, manipulator.home_mode(), &mut at).unwrap().unwrap();
        let response = model.at(at).unwrap();
        let moved = &response.coordinates * &errors;
        row.iter_mut().zip(moved.iter()).for_each(|(cell, moved)| *cell.as_mut().unwrap() += moved);
        for plays in &response.plays {
            played = played.max((plays * &errors).fixed_rows::<3>(3).norm());
        }
    }
    let found = solve(&machine, &measured, &Options { sigma: Some(sigma), ..options() });
    let largest = found.play.joints.iter().map(|joint| joint.length).fold(0.0, f64::max);
    println!(
        "deviation {:.2} -> {:.2}, {} combinations, play {:.1} um of {:.1} um",
        found.deviation_before.unwrap(),
        found.deviation.unwrap(),
        found.play.combinations,
        1e6 * largest,
        1e6 * played
    );
    assert!(found.deviation.unwrap() < 0.5 * found.deviation_before.unwrap());
    // The smallest errors that explain the residuals need no more play than those that were made, or little more.
    assert!(found.play.combinations > 0);
    assert!(largest > 0.1 * played && largest < 1.5 * played, "{largest} {played}");
}

/// Poses that the machine just reaches are lost as soon as the parameters change. They are found again: no step is refused for
/// them, and the fit takes no more steps than others do.
#[test]
fn poses_near_the_boundary_of_reach_are_fitted() {
    let mut moved = 0;
    for name in ["plano-spherical-5dof", "plano-spherical-5dof-joints", "planar-3rrr"] {
        for (seed, near) in [(0, 1e-3), (1, 1e-3), (2, 1e-4), (3, 1e-4)] {
            let mut rng = Rng::with_seed(seed);
            let machine = Machine::new(read(name), &mut rng);
            let mut poses = machine.poses(60, &mut rng);
            for pose in poses.iter_mut().take(12) {
                if let Some(at_boundary) = machine.near_boundary(pose, near) {
                    *pose = at_boundary;
                    moved += 1;
                }
            }
            let names = machine.all_columns();
            let columns: Vec<&str> = names.iter().map(String::as_str).collect();
            let measured = machine.measured(&columns, &poses, 1.0, &mut rng);
            let mut evaluations = 0;
            let found = calibrate(&machine.drawing, &measured, &options(), &mut |_| {
                evaluations += 1;
                true
            });
            let found = found.unwrap();
            let scores = machine.scores(&found);
            let worst = scores.iter().map(|s| s.1.abs()).fold(0.0, f64::max);
            let deviation = found.deviation.unwrap();
            println!("{name} {near}: {evaluations}, {worst:.2} standard errors, {deviation:.3}");
            assert!(evaluations < 20, "{name} {near}: {evaluations}");
            assert!(
                worst < 4.0 && (0.8..1.2).contains(&deviation),
                "{name} {near}: {worst} {deviation}"
            );
        }
    }
    assert!(moved > 80, "{moved}");
}

/// Tables of the drawing itself, exact or nearly so: with home, with rows twice, and rounded to some digits. Every one ends, and
/// finds the drawing as well as its digits tell.
#[test]
fn exact_tables_of_every_mechanism_end() {
    let mut atlas: Vec<(String, MechanismFile)> =
        SPLIT.iter().map(|example| (example.name.to_owned(), read(example.name))).collect();
    // A spherical five-bar in its symmetric pose.
    atlas.push(("five-bar of right angles".to_owned(), file::read(RIGHT_ANGLES).unwrap()));
    let mut solved = 0;
    for (name, drawing) in atlas {
        // Single loops are no manipulators.
        let Ok(real) = Manipulator::new(drawing.mechanism.clone()) else { continue };
        let off = vec![0.0; parameters_of(&drawing).unwrap().len()];
        let machine = Machine { drawing, off, real };
        let names = machine.all_columns();
        let columns: Vec<&str> = names.iter().map(String::as_str).collect();
        for seed in 0..12 {
            let mut rng = Rng::with_seed(seed);
            let mut poses = machine.poses(3 + seed as usize, &mut rng);
            match seed % 3 {
                0 => {}
                1 => poses.push(machine.real.home_pose()),
                _ => poses.extend([poses[0].clone(), machine.real.home_pose()]),
            }
            let mut measured = machine.measured(&columns, &poses, 0.0, &mut rng);
            let digits = [None, Some(1e-13), Some(1e-10), Some(1e-8)][seed as usize / 3];
            if let Some(digit) = digits {
                for cell in measured.rows.iter_mut().flatten().flatten() {
                    *cell = (*cell / digit).round() * digit;
                }
            }
            let options = Options { sigma: (seed % 2 == 0).then_some(SIGMA), ..Options::default() };
            match calibrate(&machine.drawing, &measured, &options, &mut |_| true) {
                Ok(found) => {
                    let left = found.cells.iter().map(|cell| cell.residual.abs());
                    let left = left.fold(0.0, f64::max);
                    // The sum of squares is at most that of the drawing, half a digit in each cell. Without standard
                    // deviations, lengths weigh one over the characteristic length.
                    let length = machine.real.characteristic_length();
                    let cells = found.cells.len() as f64;
                    let share = 0.5 * cells.sqrt() * length.max(length.recip());
                    let most = share * digits.unwrap_or(0.0) + 1e-11;
                    assert!(left <= most, "{name}, seed {seed}: {left}");
                    solved += 1;
                }
                // Home may be at a singularity of the mechanism; that is another answer.
                Err(CalibrateError::NotConverged("a measured pose is singular"))
                    if seed % 3 > 0 => {}
                Err(error) => panic!("{name}, seed {seed}: {error}"),
            }
        }
    }
    assert!(solved > 200, "{solved}");
}

const RIGHT_ANGLES: &str = r#"
format = 1
name = "right-angles"
units = { length = "mm", angle = "deg" }
[platform]
point = [0, 0, 100]
[[leg]]
name = "leg1"
joints = [
  { name = "r1a", type = "revolute", axis = [1, 0, 0], point = [0, 0, 0], actuated = true },
  { name = "r1b", type = "revolute", axis = [0, 1, 0], point = [0, 0, 0] },
]
[[leg]]
name = "leg2"
joints = [
  { name = "r2a", type = "revolute", axis = [0, 1, 0], point = [0, 0, 0], actuated = true },
  { name = "r2b", type = "revolute", axis = [1, 0, 0], point = [0, 0, 0] },
  { name = "r2c", type = "revolute", axis = [0.707106781187, 0, 0.707106781187], point = [0, 0, 0] },
]
"#;

/// A Delta is calibrated by the dimensions that its file names. Of `rb` and `rp` the difference alone matters.
#[test]
fn a_delta_is_calibrated_by_its_dimensions() {
    let mut rng = Rng::with_seed(12);
    let machine = Machine::new(read("delta"), &mut rng);
    let poses = machine.poses(40, &mut rng);
    let measured = machine.measured(&["x", "y", "z", "A1", "A2", "A3"], &poses, 0.0, &mut rng);
    let found = solve(&machine, &measured, &options());
    let of = |name: &str| {
        let place = |p: &opm_calibrate::Estimate| p.name == name;
        let k = found.parameters.iter().position(place).unwrap();
        let estimate = &found.parameters[k];
        (estimate.identifiable, estimate.after - estimate.before, machine.off[k])
    };
    for name in ["crank", "rod", "start", "A1.home", "A2.home", "A3.home"] {
        let (told, after, off) = of(name);
        assert!(told && (after - off).abs() < 1e-9, "{name}: {after} {off}");
    }
    let [(rb_told, rb, rb_off), (rp_told, rp, rp_off)] = ["rb", "rp"].map(of);
    assert!(!rb_told && !rp_told && found.held.len() == 1);
    assert!((rb - rp - (rb_off - rp_off)).abs() < 1e-9, "{rb} {rp}");
    // What is written has the rods and the offsets of the machine.
    let written = Manipulator::new(file::read(&found.text()).unwrap().mechanism).unwrap();
    let joints = |m: &Manipulator| {
        let mut at = m.solution();
        let found = m.inverse(&[0.1, -0.2, -1.0], m.home_mode(), &mut at).unwrap();
        found.unwrap().joints().to_vec()
    };
    let (written, real) = (joints(&written), joints(&machine.real));
    for &k in machine.real.actuated() {
        assert!((written[k] - real[k]).abs() < 1e-9, "{} {}", written[k], real[k]);
    }
}

/// A platform that legs hold in a subgroup only with the joints of the file has no parameters, but for dimensions that the file
/// names; a hexapod's legs have them.
#[test]
fn parameters_of_legs_that_are_solved_whole() {
    let named = file::read(find("delta").unwrap().text).unwrap();
    let names: Vec<String> = parameters_of(&named).unwrap().into_iter().map(|p| p.name).collect();
    assert_eq!(names, ["rb", "rp", "crank", "rod", "start", "A1.home", "A2.home", "A3.home"]);
    let text = file::write(&named.mechanism, named.units, file::Digits::All);
    let delta = file::read(&text).unwrap();
    let refused = parameters_of(&delta).unwrap_err().to_string();
    assert!(refused.contains("each solved by itself"), "{refused}");
    let stewart = file::read(find("stewart").unwrap().text).unwrap();
    assert!(parameters_of(&stewart).unwrap().len() > 6);
}
