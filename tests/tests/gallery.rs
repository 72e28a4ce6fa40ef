//! Every shipped mechanism decomposes as its page in docs/gallery says, and its closed forms and
//! its sweep agree with its undecomposed legs.

use fastrand::Rng;
use opm_core::decomposition::mobility::mobility;
use opm_core::decomposition::{DecomposeError, Decomposition, decompose};
use opm_core::group::subspace::SubspaceClass;
use opm_core::manipulator::{Manipulator, Solution};
use opm_core::mechanism::examples::{EXAMPLES, SPLIT, find};
use opm_core::mechanism::joint::Joint;
use opm_core::mechanism::leg::Leg;
use opm_core::mechanism::{Mechanism, file};
use opm_tests::by_inverse::by_inverse;
use opm_workspace::{Axis, Grid, Modes, Progress, Sweep, default_grid};

/// The bound on closure, as a share of a metre: the mechanisms are smaller.
const CLOSURE: f64 = 1e-10;

/// Home is well inside reach, so no digits are lost on the way there and back: tolerance for 12
/// decimals of millimetres and degrees, and for what a family computes from its parameters.
const HOME: f64 = 1e-12;

/// The number of poses that must be closed in each mechanism.
const REACHED: usize = 1_000;

/// These are moved by one joint; they have no platform to position.
const LINKAGES: [&str; 3] = ["bennett-double-spherical-6r", "bennett-plano-spherical-6r", "sarrus"];

/// All arcs of its legs are right angles, so that it reaches every orientation.
const EVERYWHERE: &str = "agile-eye";

/// The content of a mechanism's page: lambda, N, J, M, the subspaces, the motion they share, and
/// each leg's freedoms in the lower and in the upper section, with `*` if it has an imaginary
/// joint.
struct Page {
    name: &'static str,
    numbers: [usize; 4],
    subspaces: [&'static str; 2],
    shared: &'static str,
    legs: &'static str,
    redundant: usize,
    /// Mobility of the upper section without the imaginary joints.
    active: usize,
    coordinates: &'static str,
}

const PAGES: &[Page] = &[
    PLANO_SPHERICAL,
    TRANSLATIONAL_HELICAL,
    Page { name: "plano-spherical-5dof-joints", ..PLANO_SPHERICAL },
    Page { name: "translational-helical-3dof-joints", ..TRANSLATIONAL_HELICAL },
    Page {
        name: "bennett-double-spherical-6r",
        numbers: [5, 1, 1, 0],
        subspaces: ["spherical", "spherical"],
        shared: "rotation",
        legs: "1|1* 2|2",
        redundant: 0,
        active: 0,
        coordinates: "",
    },
    Page {
        name: "bennett-plano-spherical-6r",
        numbers: [5, 1, 1, 0],
        subspaces: ["planar", "spherical"],
        shared: "rotation",
        legs: "1|1* 2|2",
        redundant: 0,
        active: 0,
        coordinates: "",
    },
    Page {
        name: "sarrus",
        numbers: [5, 1, 1, 0],
        subspaces: ["planar", "planar"],
        shared: "translation",
        legs: "3|0* 0|3",
        redundant: 0,
        active: 0,
        coordinates: "",
    },
    PLANAR_PLANAR,
    Page { name: "planar-planar-5dof-joints", ..PLANAR_PLANAR },
    Page {
        name: "double-spherical-5dof",
        numbers: [5, 5, 3, 2],
        subspaces: ["spherical", "spherical"],
        shared: "rotation",
        legs: "3|2* 3|2* 3|2* 2|3",
        redundant: 0,
        active: 0,
        coordinates: "mu nu zeta xi psi",
    },
    Page {
        name: "plano-cylindrical-4dof",
        numbers: [4, 4, 1, 3],
        subspaces: ["planar", "cylindrical"],
        shared: "translation",
        legs: "3|1 3|1 3|1 3|1*",
        redundant: 0,
        active: 0,
        coordinates: "x y theta phi",
    },
    Page {
        name: "schoenflies-4dof",
        numbers: [4, 4, 2, 2],
        subspaces: ["planar", "cylindrical"],
        shared: "rotation",
        legs: "3|1* 3|1*",
        redundant: 0,
        active: 0,
        coordinates: "x y phi z",
    },
    Page {
        name: "schoenflies-lift-4dof",
        numbers: [4, 4, 2, 2],
        subspaces: ["planar", "cylindrical"],
        shared: "rotation",
        legs: "3|1* 2|2",
        redundant: 0,
        active: 1,
        coordinates: "x y phi z",
    },
    Page {
        name: "translational-planar-4dof",
        numbers: [4, 4, 3, 1],
        subspaces: ["translational plane", "planar"],
        shared: "translation",
        legs: "2|2* 2|2* 2|2* 2|2*",
        redundant: 1,
        active: 0,
        coordinates: "x y w phi",
    },
    PLANAR,
    Page { name: "planar-3rpr", ..PLANAR },
    SPHERICAL,
    Page { name: "orbita", ..SPHERICAL },
    Page { name: "five-bar", numbers: [3, 2, 0, 2], legs: "3|0 2|0", coordinates: "x y", ..PLANAR },
    Page {
        name: "schoenflies-column-4dof",
        numbers: [4, 4, 0, 4],
        subspaces: ["schoenflies", "identity"],
        legs: "4|0 4|0 4|0",
        coordinates: "x y z theta",
        ..PLANAR
    },
    Page {
        name: "cartesian-wrist-6dof",
        numbers: [6, 6, 0, 3],
        subspaces: ["translational space", "spherical"],
        legs: "3|3 3|3 3|3",
        active: 3,
        coordinates: "x y z zeta xi psi",
        ..PLANAR
    },
];

/// Three legs of three joints in one plane: nothing to split.
const PLANAR: Page = Page {
    name: "planar-3rrr",
    numbers: [3, 3, 0, 3],
    subspaces: ["planar", "identity"],
    shared: "identity",
    legs: "3|0 3|0 3|0",
    redundant: 0,
    active: 0,
    coordinates: "x y theta",
};

/// Three legs of three axes through one point.
const SPHERICAL: Page = Page {
    name: "agile-eye",
    subspaces: ["spherical", "identity"],
    coordinates: "zeta xi psi",
    ..PLANAR
};

const PLANO_SPHERICAL: Page = Page {
    name: "plano-spherical-5dof",
    numbers: [5, 5, 3, 2],
    subspaces: ["planar", "spherical"],
    shared: "rotation",
    legs: "3|2* 3|2* 3|2* 2|3",
    redundant: 0,
    active: 0,
    coordinates: "x y zeta xi psi",
};

const TRANSLATIONAL_HELICAL: Page = Page {
    name: "translational-helical-3dof",
    numbers: [3, 3, 1, 2],
    subspaces: ["translational plane", "cylindrical"],
    shared: "translation",
    legs: "2|1* 2|1 2|1",
    redundant: 0,
    active: 0,
    coordinates: "x y phi",
};

const PLANAR_PLANAR: Page = Page {
    name: "planar-planar-5dof",
    numbers: [5, 5, 3, 2],
    subspaces: ["planar", "planar"],
    shared: "translation",
    legs: "3|2* 3|2* 3|2* 2|3",
    redundant: 0,
    active: 0,
    coordinates: "x y theta w phi",
};

fn mechanism(text: &str) -> Mechanism {
    file::read(text).unwrap_or_else(|errors| panic!("{errors}")).mechanism
}

/// Every shipped mechanism that has a platform to position.
fn manipulators() -> impl Iterator<Item = Manipulator> {
    let shipped = EXAMPLES.iter().filter(|example| !LINKAGES.contains(&example.name));
    shipped.map(|example| Manipulator::new(mechanism(example.text)).unwrap())
}

fn legs(decomposition: &Decomposition) -> String {
    let leg = decomposition.legs.iter().map(|split| {
        let mark = if split.imaginary { "*" } else { "" };
        format!("{}|{}{mark}", split.lower.len(), split.upper.len())
    });
    leg.collect::<Vec<_>>().join(" ")
}

#[test]
fn every_mechanism_decomposes_as_its_page_says() {
    let names: Vec<_> = SPLIT.iter().map(|example| example.name).collect();
    assert_eq!(names, PAGES.iter().map(|page| page.name).collect::<Vec<_>>());
    for (page, example) in PAGES.iter().zip(SPLIT) {
        let mechanism = mechanism(example.text);
        let d = &decompose(&mechanism).unwrap()[0];
        let numbers = [d.lambda, d.mobility, d.imaginary_joints, d.first_section_motions];
        assert_eq!(numbers, page.numbers, "{}", page.name);
        assert_eq!([d.lower.name(), d.upper.name()], page.subspaces, "{}", page.name);
        assert_eq!(d.intersection.name(), page.shared, "{}", page.name);
        assert_eq!(legs(d), page.legs, "{}", page.name);
        assert_eq!(
            (d.redundancy, d.upper_mobility),
            (page.redundant, page.active),
            "{}",
            page.name
        );
        if !LINKAGES.contains(&page.name) {
            let manipulator = Manipulator::new(mechanism).unwrap();
            assert_eq!(manipulator.decomposition(), d, "{}", page.name);
            let names: Vec<_> = manipulator.task_coordinates().iter().map(|c| c.name).collect();
            assert_eq!(names.join(" "), page.coordinates);
        }
    }
}

/// The same of mechanisms whose legs are solved whole: N, what the platform does, its coordinates, the number of choices.
const WHOLE: [(&str, usize, &str, &str, usize); 10] = [
    ("delta", 3, "translations of space", "x y z", 6),
    ("linear-delta", 3, "translations of space", "x y z", 6),
    ("orthoglide", 3, "translations of space", "x y z", 6),
    ("tripteron", 3, "translations of space", "x y z", 3),
    ("3-upu", 3, "translations of space", "x y z", 6),
    (
        "quadrupteron",
        4,
        "translations of space and rotations about one direction",
        "x y z theta",
        4,
    ),
    ("stewart", 6, "translations and rotations of space", "x y z roll pitch yaw", 12),
    ("hexa", 6, "translations and rotations of space", "x y z roll pitch yaw", 12),
    ("tricept", 3, "what one leg allows, with fewer freedoms than space", "x y z", 8),
    ("ankle", 4, "rotations about a centre that one leg allows", "roll pitch", 3),
];

#[test]
fn mechanisms_with_whole_legs_are_as_their_pages_say() {
    assert_eq!(EXAMPLES.len(), SPLIT.len() + WHOLE.len());
    let shipped = EXAMPLES.iter().skip(SPLIT.len());
    for ((name, mobility, motion, coordinates, choices), example) in WHOLE.iter().zip(shipped) {
        assert_eq!(*name, example.name);
        let manipulator = Manipulator::new(mechanism(example.text)).unwrap();
        let d = manipulator.decomposition();
        assert_eq!((d.mobility, &*d.motion()), (*mobility, *motion), "{name}");
        let names: Vec<_> = manipulator.task_coordinates().iter().map(|c| c.name).collect();
        assert_eq!(names.join(" "), *coordinates);
        let signs = manipulator.format_mode(manipulator.home_mode());
        assert_eq!(signs.chars().filter(|sign| "+-".contains(*sign)).count(), *choices, "{name}");
    }
}

/// There are as many actuators as freedoms that move the platform, so no leg works against another.
#[test]
fn every_mechanism_has_as_many_actuators_as_freedoms() {
    for example in EXAMPLES {
        let mechanism = mechanism(example.text);
        let actuated: usize =
            mechanism.joints().filter(|joint| joint.actuated).map(Joint::freedoms).sum();
        let found = mobility(&mechanism).unwrap();
        assert_eq!(actuated, found.mobility - found.idle, "{}", example.name);
    }
}

/// The actuator of the upper section is needed: without it the height is free, and nothing else.
#[test]
fn what_is_driven_above_cannot_be_driven_below() {
    let mut lift = mechanism(find("schoenflies-lift-4dof").unwrap().text);
    let split = &decompose(&lift).unwrap()[0].legs[0];
    let last = lift.legs[0].joints.len() - 1;
    assert!(lift.legs[0].joints[last].actuated && split.upper[0].joint == last);
    lift.legs[0].joints[last].actuated = false;
    let Err(DecomposeError::Loose { free, .. }) = decompose(&lift) else { panic!() };
    let [SubspaceClass::Translation { axis }] = &*free else { panic!("{free:?}") };
    assert!((axis.z - 1.0).abs() < HOME);
}

#[test]
fn home_s_mode_gives_home_s_values_at_home() {
    for manipulator in manipulators() {
        let name = &manipulator.mechanism().name;
        let mut solution = manipulator.solution();
        let home = manipulator.home_pose();
        assert!(
            manipulator.inverse(&home, manipulator.home_mode(), &mut solution).unwrap().is_some()
        );
        assert!(solution.within_limits(), "{name}");
        for (coordinate, q) in manipulator.coordinates().iter().zip(solution.joints()) {
            let off = (coordinate.home - q).abs();
            assert!(off < HOME, "{name} {}: off by {off:e}", coordinate.name);
        }
    }
}

#[test]
fn a_family_s_working_mode_is_that_of_its_joints() {
    let mut families = 0;
    for manipulator in manipulators() {
        let name = &manipulator.mechanism().name;
        let text = find(name).unwrap().text;
        if let Some(mode) = file::read(text).unwrap().mode {
            assert_eq!(mode, manipulator.format_mode(manipulator.home_mode()), "{name}");
            families += 1;
        }
    }
    assert_eq!(families, 3);
}

/// The largest distance of a leg's end, by its product of exponentials, from the platform.
fn gap(manipulator: &Manipulator, solution: &Solution) -> f64 {
    let target = solution.displacement(manipulator).to_homogeneous();
    let mut joints = solution.joints();
    let off = |leg: &Leg| {
        let (own, rest) = joints.split_at(leg.coordinates().count());
        joints = rest;
        (leg.displacement(own).unwrap().to_homogeneous() - target).norm()
    };
    manipulator.mechanism().legs.iter().map(off).fold(0.0, f64::max)
}

#[test]
fn every_working_mode_closes_every_leg() {
    let mut rng = Rng::with_seed(20);
    for manipulator in manipulators() {
        let name = &manipulator.mechanism().name;
        let (grid, _) = default_grid(&manipulator, Modes::Any, &Progress::default()).unwrap();
        let mut all = manipulator.all_modes();
        let mut solution = manipulator.solution();
        // A hexapod has thousands of modes at each pose.
        let wanted = if manipulator.modes().nth(300).is_some() { REACHED / 20 } else { REACHED };
        let (mut tried, mut reached, mut worst) = (0, 0, 0.0_f64);
        while reached < wanted {
            tried += 1;
            assert!(tried < 1_000 * REACHED, "{name}: {reached} of {tried} poses in reach");
            let within = |axis: &Axis| axis.min + (axis.max - axis.min) * rng.f64();
            let pose: Vec<f64> = grid.axes().iter().map(within).collect();
            if manipulator.inverse_all(&pose, &mut all).unwrap().is_none() {
                continue;
            }
            reached += 1;
            for mode in all.modes(&manipulator) {
                assert!(manipulator.solution_in_mode(&all, mode, &mut solution).is_some());
                let off = gap(&manipulator, &solution);
                worst = worst.max(off);
                assert!(off < CLOSURE, "{name} at {pose:?}: off by {off:e}");
            }
        }
        println!("{name}: {reached} of {tried} poses, worst {worst:.1e}");
    }
}

/// In home's mode and in any mode, over the workspace's whole extent: some poses are reachable, but
/// not all, unless the mechanism reaches every orientation.
#[test]
fn a_sweep_counts_what_inverse_kinematics_finds() {
    for manipulator in manipulators() {
        let name = &manipulator.mechanism().name;
        let modes = [Modes::One(manipulator.home_mode()), Modes::Any];
        // Hexapods have too many modes to list at every pose.
        let listed = manipulator.modes().take(300).count() < 300;
        for modes in modes.into_iter().filter(|modes| listed || *modes != Modes::Any) {
            let (grid, _) = default_grid(&manipulator, modes, &Progress::default()).unwrap();
            // An even number of values, so that the grid does not contain only the symmetric poses.
            let values = match grid.axes().len() {
                0..3 => 20,
                6 if manipulator.is_whole() => 4,
                _ => 6,
            };
            let axes = grid.axes().iter().map(|a| Axis::new(a.name.clone(), a.min, a.max, values));
            let grid = Grid::new(&manipulator, axes.collect()).unwrap();
            let (reached, expected) = by_inverse(&manipulator, &grid, modes);
            let count = Sweep::new(&manipulator, &grid, modes).count(&Progress::default()).unwrap();
            println!("{name} {modes:?}: {} of {}", count.reachable, count.poses);
            assert_eq!(count, expected, "{name}");
            let all = count.reachable == count.poses;
            assert!(reached.len() > 10 && all == (name == EVERYWHERE), "{name}: {count:?}");
        }
    }
}
