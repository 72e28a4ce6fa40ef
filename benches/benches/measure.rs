//! Measures with guaranteed bounds of the paper's 5-DoF manipulator: how the error falls with the number of boxes, and what
//! a box costs in poses that a sweep could decide instead.

use opm_benches::{Contender, compare, example, sweep_grid};
use opm_core::manipulator::Manipulator;
use opm_workspace::measure::{CoordinateRange, Domain, Evaluator, Goal, Search, measure};
use opm_workspace::{Modes, Progress, Sections, Sweep};
use std::f64::consts::PI;

/// The numbers of boxes in the table, four times as many in every row.
const BOXES: [u64; 4] = [4_000, 16_000, 64_000, 256_000];

/// The number of boxes that are timed.
const TIMED: u64 = 16_000;

fn main() {
    let manipulator = example("plano-spherical-5dof");
    let near = [("x", 0.2), ("y", 0.2), ("zeta", 0.35), ("xi", 0.35), ("psi", 0.35)];
    let near = near.map(|(name, half)| CoordinateRange::new(name, -half, half));
    let all = [
        CoordinateRange::new("x", -0.23, 0.23),
        CoordinateRange::new("y", -0.13, 0.15),
        CoordinateRange::new("zeta", -PI, PI),
        CoordinateRange::new("xi", 0.0, PI),
        CoordinateRange::new("psi", -PI, PI),
    ];
    let names = ["within 200 mm and 20° of home", "all orientations"];
    let domains = [&near, &all].map(|over| {
        Domain::new(&manipulator, Sections::Whole, over).expect("ranges of the task coordinates")
    });
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread pool");
    pool.install(|| {
        let errors = domains.each_ref().map(|domain| errors(&manipulator, domain));
        println!("Measures of all five coordinates are certain to within:");
        println!("| boxes, at most | {} | {} |\n|---:|---:|---:|", names[0], names[1]);
        for (row, boxes) in BOXES.into_iter().enumerate() {
            let [near, all] = errors.each_ref().map(|errors| 100.0 * errors[row]);
            println!("| {boxes} | {near:.2} % | {all:.2} % |");
        }
        println!("\nThe time of a box, one thread, in poses of a sweep of 64 · 64 · 13³ poses:");
        println!("| what is measured | poses |\n|---|---:|");
        for (name, domain) in names.into_iter().zip(&domains) {
            println!("| {name} | {:.0} |", poses_a_box(&manipulator, domain));
        }
    });
}

/// The uncertainty for each number of boxes.
fn errors(manipulator: &Manipulator, domain: &Domain) -> [f64; BOXES.len()] {
    let evaluator = Evaluator::new(manipulator, domain, Modes::One(manipulator.home_mode()));
    let goal = Goal { tolerance: 0.0, budget: BOXES[BOXES.len() - 1] };
    let mut search = Search::new(domain, goal);
    let mut errors = [1.0; BOXES.len()];
    while let Some(cells) = search.round() {
        let bounds = evaluator.evaluate(cells, &Progress::default()).expect("not cancelled");
        search.answer(bounds).expect("the bounds of every cell");
        let found = search.found();
        for (error, boxes) in errors.iter_mut().zip(BOXES) {
            if found.boxes <= boxes {
                *error = found.uncertainty();
            }
        }
    }
    errors
}

fn poses_a_box(manipulator: &Manipulator, domain: &Domain) -> f64 {
    let modes = Modes::One(manipulator.home_mode());
    let goal = Goal { tolerance: 0.0, budget: TIMED };
    let run = || measure(manipulator, domain, modes, &goal, &Progress::default());
    let boxes = run().boxes;
    let grid = sweep_grid(manipulator, [64, 64, 13]);
    let sweep = Sweep::new(manipulator, &grid, modes);
    let timings = compare(vec![
        Contender::new("poses", grid.poses(), || {
            sweep.count(&Progress::default()).expect("not cancelled");
        }),
        Contender::new("boxes", boxes, || {
            run();
        }),
    ]);
    timings[1].ratio
}
