//! The number of branches of a leg: the closed forms are compared with what a numeric solver finds
//! from many random starts, for every pair of subspaces and every order of joints in both sections.

use fastrand::Rng;
use opm_check::branches::{Alone, Branches};
use opm_tests::height::straight;
use opm_tests::random::{Meet, Options, PAIRS, RandomSubspace, mechanism, meet, order, orders};
use std::collections::BTreeSet;

/// The number of poses compared, for each pair and each section that the imaginary joint can be in.
const POSES: usize = 150;
/// The counts for a pair, with the imaginary joint in one section.
#[derive(Default)]
struct Tally {
    compared: usize,
    folds: usize,
    branches: [usize; 5],
    orders: [BTreeSet<String>; 2],
}

fn compare(pair: [RandomSubspace; 2], above: bool, rng: &mut Rng) -> Tally {
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
            let alone = Alone::new(&mechanism, &decomposition, number, 1.0).unwrap();
            let pose: Vec<f64> = (alone.manipulator().home_pose().iter())
                .map(|home| home + 1.2 * (rng.f64() - 0.5))
                .collect();
            let count = match alone.compare(&pose, rng).unwrap() {
                Branches::Same(count) => count,
                Branches::Fold => {
                    tally.folds += 1;
                    continue;
                }
                different => panic!("{pair:?}, {found:?} at {pose:?}: {different:?}"),
            };
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
fn expected(pair: [RandomSubspace; 2], above: bool) -> [BTreeSet<String>; 2] {
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
