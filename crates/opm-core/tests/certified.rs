//! Certificates of assemblies: exact ones are within their radii, two are told apart, and where assemblies meet nothing is proven.

use fastrand::Rng;
use opm_core::Manipulator;
use opm_core::forward::{Assembly, Certificate, Proof};
use opm_core::mechanism::examples::EXAMPLES;

/// The actuated joints at random poses near home.
fn joints_near_home(m: &Manipulator, share: f64, rng: &mut Rng) -> Option<Vec<f64>> {
    let size = m.characteristic_length();
    let of = |c: &opm_core::task::TaskCoordinate| {
        let unit = if c.quantity == opm_core::Quantity::Length { size } else { 1.0 };
        c.home + share * unit * (2.0 * rng.f64() - 1.0)
    };
    let pose: Vec<f64> = m.task_coordinates().iter().map(of).collect();
    let mut solution = m.solution();
    let solution = m.inverse(&pose, m.home_mode(), &mut solution).unwrap()?;
    Some(m.actuated().iter().map(|&c| solution.joints()[c]).collect())
}

fn proofs(m: &Manipulator, list: &[Assembly]) -> Vec<Proof> {
    let of = |certificate: &Certificate| *certificate.proof().expect("a regular assembly");
    m.certify(list).iter().map(of).collect()
}

/// Away from singularities every assembly of every shipped mechanism is proven, none twice.
#[test]
fn assemblies_of_all_mechanisms_are_proven() {
    let mut rng = Rng::with_seed(72);
    let (mut mechanisms, mut implied, mut square) = (0, 0, 0);
    for example in EXAMPLES {
        // Loops have no forward kinematics.
        let Ok(m) = Manipulator::example(example.name) else { continue };
        let Some(actuated) = joints_near_home(&m, 0.05, &mut rng) else { continue };
        let Ok(found) = m.forward(&actuated) else { continue };
        for proof in proofs(&m, &found.list) {
            assert!(proof.radius < 1e-7 && proof.distinct, "{} {proof:?}", example.name);
            implied += usize::from(proof.implied > 0);
            square += usize::from(proof.implied == 0);
        }
        mechanisms += usize::from(!found.list.is_empty());
    }
    assert!(mechanisms > 25 && implied > 50 && square > 20, "{mechanisms} {implied} {square}");
}

/// Where a pose is wrong, the radius is by how much: the exact platform is inside, and hardly farther away than it has to be.
#[test]
fn the_radius_holds_the_exact_assembly() {
    let mut rng = Rng::with_seed(73);
    for name in ["delta", "stewart", "tripteron", "planar-3rrr", "plano-spherical-5dof"] {
        let m = Manipulator::example(name).unwrap();
        let actuated = joints_near_home(&m, 0.05, &mut rng).unwrap();
        let right = m.forward(&actuated).unwrap().list.swap_remove(0);
        let own = proofs(&m, std::slice::from_ref(&right))[0].radius;
        assert!(own < 2e-8, "{name} {own}");
        for off in [1e-8, 1e-5] {
            let mut wrong = right.clone();
            for value in &mut wrong.pose {
                *value += off * (2.0 * rng.f64() - 1.0);
            }
            let places = [&right, &wrong].map(|a| m.platform_at(&m.displacement_of(a)));
            let distance = m.platform_distance(&places[0], &places[1]);
            let proof = proofs(&m, &[wrong])[0];
            // The right one is itself so far from the exact one at most.
            assert!(proof.radius >= distance - own, "{name} {proof:?} {distance} {own}");
            assert!(proof.radius <= distance + 3.0 * own, "{name} {proof:?} {distance} {own}");
        }
        // Wrong joints lead to the exact ones, as long as Newton's method does.
        let mut wrong = right.clone();
        for (c, value) in wrong.joints.iter_mut().enumerate() {
            if !m.actuated().contains(&c) {
                *value += 1e-6 * (2.0 * rng.f64() - 1.0);
            }
        }
        assert!(proofs(&m, &[wrong])[0].radius < 3.0 * own, "{name}");
    }
}

/// An assembly that comes twice is told.
#[test]
fn the_same_assembly_is_not_distinct() {
    let m = Manipulator::example("delta").unwrap();
    let list = m.forward(&[0.1, -0.05, 0.2]).unwrap().list;
    let twice = [list[0].clone(), list[1].clone(), list[0].clone()];
    let distinct: Vec<bool> = proofs(&m, &twice).iter().map(|proof| proof.distinct).collect();
    assert_eq!(distinct, [true, true, false]);
}

/// Rods meet in two places, until a motor is so far out that these are one. There nothing is proven; before, the radii keep the two
/// apart.
#[test]
fn where_assemblies_meet_a_double_is_suspected() {
    for name in ["linear-delta", "orthoglide", "planar-3rpr"] {
        let m = Manipulator::example(name).unwrap();
        let home = m.home_pose();
        let mut solution = m.solution();
        let solution = m.inverse(&home, m.home_mode(), &mut solution).unwrap().unwrap();
        let start: Vec<f64> = m.actuated().iter().map(|&c| solution.joints()[c]).collect();
        // One joint slides as far as there are assemblies.
        let size = m.characteristic_length();
        let at = |way: f64| {
            let mut joints = start.clone();
            joints[0] += way * size;
            m.forward(&joints).unwrap().list
        };
        let step = (1..=80).map(|i| 0.05 * f64::from(i)).find(|&way| at(way).is_empty());
        let (mut low, mut high) = (0.0, step.expect("rods do not reach everywhere"));
        let mut proven = 0;
        while high - low > 1e-15 {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            let list = at(middle);
            match list.is_empty() {
                true => high = middle,
                false => low = middle,
            }
            let certificates = m.certify(&list);
            if let [Some(one), Some(other)] =
                [0, 1].map(|i| certificates.get(i).and_then(Certificate::proof))
            {
                let places = [0, 1].map(|i| m.platform_at(&m.displacement_of(&list[i])));
                let apart = m.platform_distance(&places[0], &places[1]);
                assert!(other.distinct && one.radius + other.radius < apart, "{name} {apart}");
                proven += 1;
            }
        }
        assert!(proven > 3, "{name} {proven}");
        let last = at(low);
        assert!(!last.is_empty());
        let certificates = m.certify(&last);
        assert!(
            certificates.iter().all(|certificate| *certificate == Certificate::DoubleSuspected),
            "{name} {certificates:?}"
        );
    }
}
