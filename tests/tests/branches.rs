//! The number of branches of a leg: the closed forms are compared with what a numeric solver finds
//! from many random starts, for every pair of subspaces and every order of joints in both sections.

use fastrand::Rng;
use nalgebra::{DVector, Isometry3};
use opm_core::decomposition::{Decomposition, LegSplit};
use opm_core::group::MotionType;
use opm_core::group::subspace::SubspaceClass;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::Mechanism;
use opm_core::mechanism::joint::{Joint, JointKind};
use opm_core::mechanism::leg::Leg;
use opm_tests::height::straight;
use opm_tests::newton::{Closure, displacement};
use opm_tests::random::{Kind, Meet, Options, PAIRS, mechanism, meet, order, orders};
use std::collections::BTreeSet;
use std::f64::consts::PI;

/// Random starts per leg. A leg has at most four solutions, and these starts find all of them
/// except for one leg in thousands.
const STARTS: usize = 80;
/// Random starts if fewer solutions are found than there are branches.
const MORE: usize = 5_000;
/// The number of poses compared, for each pair and each section that the imaginary joint can be in.
const POSES: usize = 150;
/// Two solutions are the same if their joints' displacements, as matrices, differ by less.
const SAME: f64 = 1e-5;
/// If the smallest singular value of the leg's Jacobian is below this, two solutions nearly meet (a
/// fold), and neither solver can be expected to find the right number. Radians and metres, for legs
/// of unit size.
const FOLD: f64 = 2e-2;

/// A single leg.
struct Alone {
    manipulator: Manipulator,
    cylindrical: [bool; 2],
    split: LegSplit,
}

impl Alone {
    fn new(mechanism: &Mechanism, decomposition: &Decomposition, number: usize) -> Self {
        let split = decomposition.legs[number].clone();
        let alone = Mechanism { legs: vec![mechanism.legs[number].clone()], ..mechanism.clone() };
        let decomposition = Decomposition { legs: vec![split.clone()], ..decomposition.clone() };
        let cylinder = |class: &SubspaceClass| matches!(class, SubspaceClass::Cylindrical { .. });
        let cylindrical = [cylinder(&decomposition.lower), cylinder(&decomposition.upper)];
        let manipulator = Manipulator::with_decomposition(alone, decomposition).unwrap();
        Self { manipulator, cylindrical, split }
    }

    fn leg(&self) -> &Leg {
        &self.manipulator.mechanism().legs[0]
    }

    /// The displacement of each joint, modulo 2π. Joints on one axis, such as a screw and a slider,
    /// can give the same displacement a revolution apart, so they are compared together.
    fn parts(&self, q: &DVector<f64>) -> Vec<Isometry3<f64>> {
        let mut rest = q.as_slice();
        let each: Vec<_> = self.leg().joints.iter().map(|joint| take(joint, &mut rest)).collect();
        let border = self.split.lower.last().expect("a lower section").joint + 1;
        let (lower, upper) = each.split_at(border);
        let section = |(part, together): (&[Isometry3<f64>], bool)| {
            let product = || part.iter().fold(Isometry3::identity(), |g, joint| g * joint);
            if together { vec![product()] } else { part.to_vec() }
        };
        [(lower, self.cylindrical[0]), (upper, self.cylindrical[1])]
            .into_iter()
            .flat_map(section)
            .collect()
    }

    /// A screw that is alone on a cylinder's axis follows the pose's angle, including full
    /// revolutions. The platform's displacement does not contain these, so a solution with another
    /// revolution belongs to another pose.
    fn of_this_turn(&self, q: &DVector<f64>) -> bool {
        let mut rest = q.as_slice();
        let sections = [&self.split.lower, &self.split.upper];
        self.leg().joints.iter().enumerate().all(|(number, joint)| {
            let (own, after) = rest.split_at(joint.freedoms());
            rest = after;
            let alone = sections.iter().zip(self.cylindrical).any(|(section, cylindrical)| {
                cylindrical && section.len() == 1 && section[0].joint == number
            });
            let translation = self.manipulator.task().shared() == Some(MotionType::Translation);
            let screw = matches!(joint.kind, JointKind::Helical { .. });
            !(alone && translation && screw) || own[0].abs() < PI
        })
    }

    fn add(&self, different: &mut Vec<Vec<Isometry3<f64>>>, q: &DVector<f64>) {
        let parts = self.parts(q);
        let off = |known: &Vec<Isometry3<f64>>| {
            known
                .iter()
                .zip(&parts)
                .map(|(a, b)| (a.to_homogeneous() - b.to_homogeneous()).amax())
                .fold(0.0, f64::max)
        };
        if different.iter().all(|known| off(known) > SAME) {
            different.push(parts);
        }
    }

    /// The solutions of every branch, as displacements from home.
    fn closed_form(&self, pose: &[f64]) -> Vec<DVector<f64>> {
        let mut all = self.manipulator.all_modes();
        let mut solution = self.manipulator.solution();
        self.manipulator.inverse_all(pose, &mut all).unwrap();
        let modes: Vec<_> = all.modes(&self.manipulator).collect();
        let mut found = Vec::new();
        for mode in modes {
            assert!(self.manipulator.solution_in_mode(&all, mode, &mut solution).is_some());
            let coordinates = self.manipulator.coordinates();
            let q = solution.joints().iter().zip(coordinates).map(|(q, c)| q - c.home);
            found.push(DVector::from_iterator(coordinates.len(), q));
        }
        found
    }
}

fn take(joint: &Joint, rest: &mut &[f64]) -> Isometry3<f64> {
    let (own, after) = rest.split_at(joint.freedoms());
    *rest = after;
    displacement(joint, own)
}

/// The counts for a pair, with the imaginary joint in one section.
#[derive(Default)]
struct Tally {
    compared: usize,
    folds: usize,
    branches: [usize; 5],
    orders: [BTreeSet<String>; 2],
}

fn compare(pair: [Kind; 2], above: bool, rng: &mut Rng) -> Tally {
    let mut tally = Tally::default();
    let expected = expected(pair, above);
    let complete = |tally: &Tally| {
        tally.compared >= POSES && tally.orders.iter().zip(&expected).all(|(a, b)| a == b)
    };
    while !complete(&tally) {
        assert!(tally.compared < 40 * POSES, "{pair:?} {above}: {:?}, {expected:?}", tally.orders);
        let (mechanism, decomposition) =
            mechanism(rng, pair, Options { limited: 0.0, balls: true });
        let listed = straight(mechanism.clone(), &decomposition);
        for (number, split) in decomposition.legs.iter().enumerate() {
            let found =
                [&split.lower, &split.upper].map(|section| order(&listed.legs[number], section));
            let new = found.iter().zip(&tally.orders).any(|(order, seen)| !seen.contains(order));
            if split.imaginary != above || (tally.compared >= POSES && !new) {
                continue;
            }
            let alone = Alone::new(&mechanism, &decomposition, number);
            let pose: Vec<f64> = (alone.manipulator.home_pose().iter())
                .map(|home| home + 1.2 * (rng.f64() - 0.5))
                .collect();
            let closure = Closure {
                leg: alone.leg(),
                point: mechanism.platform,
                target: alone.manipulator.task().displacement(&pose),
            };
            let closed = alone.closed_form(&pose);
            let mut numeric = closure.solutions(STARTS, rng);
            let fold = |q: &DVector<f64>| closure.sharpness(q) < FOLD;
            if closed.iter().chain(&numeric).any(fold) {
                tally.folds += 1;
                continue;
            }
            let (mut branches, mut solutions) = (Vec::new(), Vec::new());
            closed.iter().for_each(|q| alone.add(&mut branches, q));
            assert_eq!(branches.len(), closed.len(), "{pair:?} {found:?}: branches that are one");
            for starts in [MORE, 0] {
                for q in numeric.iter().filter(|q| alone.of_this_turn(q)) {
                    alone.add(&mut solutions, q);
                }
                if solutions.len() < branches.len() {
                    numeric = closure.solutions(starts, rng);
                }
            }
            assert_eq!(branches.len(), solutions.len(), "{pair:?}, {found:?} at {pose:?}");
            let count = solutions.len();
            // The numeric solver finds no other solution.
            for q in &closed {
                alone.add(&mut solutions, q);
            }
            assert_eq!(solutions.len(), count, "{pair:?}, {found:?}: different solutions");
            tally.compared += 1;
            tally.branches[count] += 1;
            if count > 0 {
                tally.orders.iter_mut().zip(found).for_each(|(seen, order)| {
                    seen.insert(order);
                });
            }
        }
    }
    tally
}

/// The orders of joints in both sections, with the imaginary joint in the upper or in the lower
/// one.
fn expected(pair: [Kind; 2], above: bool) -> [BTreeSet<String>; 2] {
    let cut = Some(meet(pair)).filter(|meet| *meet != Meet::Nothing);
    let cuts = if above { [None, cut] } else { [cut, None] };
    [0, 1].map(|i| orders(pair[i], cuts[i]).iter().map(|&order| order.to_owned()).collect())
}

#[test]
fn there_are_as_many_branches_as_a_numeric_solver_finds() {
    let mut rng = Rng::with_seed(60);
    let mut total = [0; 5];
    for pair in PAIRS {
        // Without a shared motion there is no imaginary joint, in neither section.
        let bridged = meet(pair) != Meet::Nothing;
        for above in [true, false].into_iter().filter(|above| bridged || !above) {
            let tally = compare(pair, above, &mut rng);
            println!(
                "{pair:?}, cut {}: {} poses, branches {:?}, {} near a fold",
                if above { "above" } else { "below" },
                tally.compared,
                tally.branches,
                tally.folds
            );
            assert!(tally.folds < tally.compared, "{pair:?}: hardly a pose away from folds");
            for (sum, branches) in total.iter_mut().zip(tally.branches) {
                *sum += branches;
            }
        }
    }
    println!("branches {total:?}");
    // There are no, one, two or four solutions; three only where two would meet.
    assert!([0, 1, 2, 4].iter().all(|&count| total[count] > 20) && total[3] == 0, "{total:?}");
}
