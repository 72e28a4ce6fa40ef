//! Stiffness and reactions against the least energy of all springs, and against efforts by virtual work.

use fastrand::Rng;
use nalgebra::{DMatrix, DVector, Vector3, Vector6};
use opm_analysis::{Balance, Compliant, Gravity, Load, Loads, Setup, Springs, Statics, Wrench};
use opm_core::Manipulator;
use opm_core::manipulator::Solution;
use opm_core::mechanism::examples::EXAMPLES;
use opm_core::skeleton::{Configuration, Density, Skeleton};

/// The motion of the platform's reference point, and its rotation, for a small displacement `twist` (translation of
/// `point`, then rotation) of everything behind a point.
fn carried(twist: &Vector6<f64>, point: Vector3<f64>, reference: Vector3<f64>) -> Vector6<f64> {
    let (v, w) = (twist.fixed_rows::<3>(0), twist.fixed_rows::<3>(3));
    let moved = v + w.cross(&(reference - point));
    Vector6::new(moved.x, moved.y, moved.z, w.x, w.y, w.z)
}

/// The columns of a leg: what the platform does for a unit of each joint coordinate, and of each spring of a link. By
/// displacing the leg's own bodies a little, not by screws.
struct LegColumns {
    /// With the number of the joint in its leg.
    joints: Vec<(usize, Vector6<f64>)>,
    /// Three translations and three rotations for each link, with the number of the joint at its end.
    links: Vec<(usize, Vector6<f64>)>,
}

fn columns(leg: &opm_core::Leg, values: &[f64], reference: Vector3<f64>) -> LegColumns {
    let place = leg.displacement(values).unwrap();
    let step = 1e-6;
    let numbers = leg.joints.iter().enumerate();
    let numbers = numbers.flat_map(|(number, joint)| vec![number; joint.coordinates.len()]);
    let joints = (0..values.len()).map(|i| {
        let at = |t: f64| {
            let mut values = values.to_vec();
            values[i] += t;
            let moved = leg.displacement(&values).unwrap() * place.inverse();
            let v = moved * nalgebra::Point3::from(reference) - nalgebra::Point3::from(reference);
            let w = moved.rotation.scaled_axis();
            Vector6::new(v.x, v.y, v.z, w.x, w.y, w.z)
        };
        (at(step) - at(-step)) / (2.0 * step)
    });
    let joints = numbers.zip(joints).collect();
    let (mut links, mut g, mut rest) = (Vec::new(), nalgebra::Isometry3::identity(), values);
    for (number, joint) in leg.joints.iter().enumerate() {
        if number > 0 {
            let point = (g * joint.point).coords;
            let column = |i| carried(&Vector6::ith(i, 1.0), point, reference);
            links.extend((0..6).map(|i| (number, column(i))));
        }
        let (own, others) = rest.split_at(joint.coordinates.len());
        (g, rest) = (g * joint.displacement(own).unwrap(), others);
    }
    LegColumns { joints, links }
}

/// The weights of the links, for each leg and each joint that carries one, and then that of the platform, each as a wrench at
/// the reference point: masses and places are those of what is drawn.
fn weights(manipulator: &Manipulator, at: &Solution, gravity: &Gravity) -> Vec<Vec<Vector6<f64>>> {
    let platform = at.displacement(manipulator);
    let reference = manipulator.platform_at(&platform).translation.vector;
    let skeleton = Skeleton::new(manipulator.mechanism(), None);
    let masses = skeleton.masses(manipulator.mechanism(), gravity.density);
    let of = Configuration { joints: at.joints(), imaginary: &[], platform };
    let placed = skeleton.place_in_base(&of).unwrap();
    let mut each = placed.iter().zip(&masses).skip(1).map(|(at, own)| {
        let force = gravity.acceleration * own.mass;
        let moment = ((at * own.centre).coords - reference).cross(&force);
        Vector6::new(force.x, force.y, force.z, moment.x, moment.y, moment.z)
    });
    let legs = manipulator.mechanism().legs.iter();
    let mut all: Vec<Vec<_>> =
        legs.map(|leg| each.by_ref().take(leg.joints.len() - 1).collect()).collect();
    all.push(each.collect());
    all
}

/// Minimises the energy of all springs under a load on the platform and the weights of links, with a multiplier for each leg
/// that has to end at the platform: displacement, and the load on each leg.
fn least_energy(
    manipulator: &Manipulator,
    at: &Solution,
    springs: &Springs,
    load: &Vector6<f64>,
    weights: &[Vec<Vector6<f64>>],
) -> Option<(Vector6<f64>, Vec<Vector6<f64>>)> {
    let platform = manipulator.platform_at(&at.displacement(manipulator));
    let reference = platform.translation.vector;
    let legs = &manipulator.mechanism().legs;
    let mut first = 0;
    // Unknowns: the platform, then what gives way in each leg, then multipliers. Rows of springs and joints.
    let (mut moves, mut stiff): (Vec<(usize, Vector6<f64>)>, Vec<f64>) = (Vec::new(), Vec::new());
    // The work of the weights for each of them.
    let mut works = Vec::new();
    for (number, leg) in legs.iter().enumerate() {
        let count = leg.coordinates().count();
        let values = &at.joints()[first..first + count];
        let LegColumns { joints, links } = columns(leg, values, reference);
        let work = |place: usize, column: &Vector6<f64>| {
            weights[number].iter().skip(place).map(|weight| weight.dot(column)).sum::<f64>()
        };
        for (i, (place, joint)) in joints.into_iter().enumerate() {
            let driven = manipulator.actuated().iter().position(|&c| c == first + i);
            let k = driven.map_or(0.0, |driven| springs.actuators[driven]);
            if k.is_finite() {
                works.push(work(place, &joint));
                moves.push((number, joint));
                stiff.push(k);
            }
        }
        for (i, (place, link)) in links.into_iter().enumerate() {
            works.push(work(place, &link));
            moves.push((number, link));
            stiff.push(if i % 6 < 3 { springs.translation } else { springs.rotation });
        }
        first += count;
    }
    let (n, m) = (moves.len(), 6 * legs.len());
    let size = 6 + n + m;
    let mut system = DMatrix::zeros(size, size);
    for (i, k) in stiff.iter().enumerate() {
        system[(6 + i, 6 + i)] = *k;
    }
    for leg in 0..legs.len() {
        for row in 0..6 {
            // δt − Σ columns = 0.
            let multiplier = 6 + n + 6 * leg + row;
            system[(multiplier, row)] = 1.0;
            system[(row, multiplier)] = 1.0;
            for (i, (_, column)) in moves.iter().enumerate().filter(|(_, (own, _))| *own == leg) {
                system[(multiplier, 6 + i)] = -column[row];
                system[(6 + i, multiplier)] = -column[row];
            }
        }
    }
    let mut right = DVector::zeros(size);
    right.rows_mut(0, 6).copy_from(load);
    right.rows_mut(6, n).copy_from_slice(&works);
    let found = system.full_piv_lu().solve(&right)?;
    let of = |from: usize| Vector6::from_fn(|i, _| found[from + i]);
    Some((of(0), (0..legs.len()).map(|leg| of(6 + n + 6 * leg)).collect()))
}

#[test]
fn shipped_mechanisms_share_loads_as_the_least_energy_says() {
    let mut rng = Rng::with_seed(90);
    let (mut compared, mut determined) = (0, 0);
    for example in EXAMPLES {
        let Ok(manipulator) = Manipulator::read(example.text) else { continue };
        let mut at = manipulator.solution();
        let pose: Vec<f64> =
            manipulator.home_pose().iter().map(|h| h + 0.03 * (rng.f64() - 0.5)).collect();
        let mode = manipulator.home_mode();
        if manipulator.inverse(&pose, mode, &mut at).unwrap().is_none() {
            continue;
        }
        let mut drawn = |least: f64| least * 10f64.powf(rng.f64());
        let springs = Springs {
            actuators: manipulator.actuated().iter().map(|_| drawn(1e4)).collect(),
            translation: drawn(1e5),
            rotation: drawn(1e3),
        };
        let load = Wrench::from_components([3.0, -1.0, 2.0, 0.2, 0.1, -0.3]);
        let acceleration = Vector3::new(2.0, -3.0, -9.0);
        let gravity = Gravity { acceleration, density: Density::default() };
        let all = weights(&manipulator, &at, &gravity);
        let (links, own) = all.split_at(all.len() - 1);
        let components = Vector6::from(load.components()) + own[0][0];
        let mut compliant =
            Compliant::new(&manipulator, springs.clone()).unwrap().with_gravity(&gravity);
        let Some(stiffness) = compliant.stiffness(&at) else { continue };
        let symmetric = (stiffness.platform - stiffness.platform.transpose()).amax();
        assert!(symmetric < 1e-9 * stiffness.platform.amax());
        let Some(found) = compliant.reactions(&stiffness, &load) else { continue };
        let Some((displacement, legs)) =
            least_energy(&manipulator, &at, &springs, &components, links)
        else {
            continue;
        };
        let name = example.name;
        let apart = (found.displacement - displacement).norm() / displacement.norm();
        assert!(apart < 1e-5, "{name}: {apart}");
        for (own, expected) in found.legs.iter().zip(&legs) {
            // The multiplier is what the platform does to the leg.
            let own = Vector6::from(own.components());
            assert!((own - expected).norm() < 1e-5 * components.norm(), "{name}: {own} {expected}");
        }
        let whole: Vector6<f64> =
            found.legs.iter().map(|leg| Vector6::from(leg.components())).sum();
        assert!((whole - components).norm() < 1e-7 * components.norm(), "{name}");
        // What passes through the first joints holds everything.
        let reference = manipulator.platform_at(&at.displacement(&manipulator)).translation.vector;
        let mut first = 0;
        let mut on_base = Vector6::zeros();
        for leg in &manipulator.mechanism().legs {
            let point = leg.joints[0].point;
            let through = found.joints[first].moved(&point, &reference.into());
            on_base += Vector6::from(through.components());
            first += leg.joints.len();
        }
        let weight: Vector6<f64> = links.iter().flatten().sum();
        assert!((on_base - components - weight).norm() < 1e-7 * components.norm(), "{name}");
        compared += 1;
        // What statics determine does not depend on springs.
        let mut statics = Statics::new(&manipulator, manipulator.characteristic_length());
        if !statics.update(&at).unwrap() {
            continue;
        }
        let load = Some(Load { wrench: load, ..Load::default() });
        let setup = Setup { load, gravity: Some(gravity), ..Setup::new(1.0) };
        let efforts = Loads::new(&manipulator, &setup).unwrap().efforts(&statics, &at);
        assert_eq!(efforts.balance, Balance::Balanced);
        for (own, known) in found.efforts.iter().zip(&efforts.actuated) {
            let Some(known) = known else { continue };
            assert!((own - known).abs() < 1e-6 * (1.0 + known.abs()), "{name}: {own} {known}");
            determined += 1;
        }
    }
    assert!(compared > 12 && determined > 40, "{compared} {determined}");
}

/// Two equal sliders that carry a platform upwards share a weight evenly; a slider that is twice as stiff carries twice as
/// much. The links are stiff, and joints between them are level.
#[test]
fn redundant_actuators_share_a_load_by_their_stiffness() {
    let text = r#"
format = 1
name = "lift"
units = { length = "m", angle = "rad" }
[platform]
point = [0, 0, 1]
[[leg]]
name = "a"
joints = [
  { name = "Sa", type = "prismatic", axis = [0, 0, 1], point = [-1, 0, 0], actuated = true },
  { name = "Xa", type = "prismatic", axis = [1, 0, 0], point = [-1, 0, 1] },
]
[[leg]]
name = "b"
joints = [
  { name = "Sb", type = "prismatic", axis = [0, 0, 1], point = [1, 0, 0], actuated = true },
  { name = "Xb", type = "prismatic", axis = [1, 0, 0], point = [1, 0, 1], actuated = true },
]
"#;
    let manipulator = Manipulator::read(text).unwrap();
    let mut at = manipulator.solution();
    let home = manipulator.home_pose();
    manipulator.inverse(&home, manipulator.home_mode(), &mut at).unwrap().unwrap();
    let springs = Springs { actuators: vec![1e3, 2e3, 1e3], translation: 1e12, rotation: 1e12 };
    let mut compliant = Compliant::new(&manipulator, springs).unwrap();
    let stiffness = compliant.stiffness(&at).unwrap();
    let load = Wrench::from_components([0.0, 0.0, -30.0, 0.0, 0.0, 0.0]);
    let found = compliant.reactions(&stiffness, &load).unwrap();
    assert!((stiffness.platform[(2, 2)] - 3e3).abs() < 1e-3);
    assert!((found.displacement[2] + 0.01).abs() < 1e-6);
    for (effort, expected) in found.efforts.iter().zip([10.0, 20.0, 0.0]) {
        assert!((effort - expected).abs() < 1e-3, "{:?}", found.efforts);
    }
    // Statics alone do not say how the two share it.
    let mut statics = Statics::new(&manipulator, 1.0);
    assert!(statics.update(&at).unwrap());
    let [a, b, x] = statics.efforts(&load).actuated[..] else { unreachable!() };
    assert_eq!((a, b, statics.internal()), (None, None, 1));
    assert!(x.unwrap().abs() < 1e-9);
}

#[test]
fn springs_are_checked() {
    let manipulator = Manipulator::example("planar-3rrr").unwrap();
    for (actuators, translation, expected) in [
        (vec![1.0; 2], 1.0, "2 stiffnesses of actuators, expected 3"),
        (vec![1.0, 0.0, 1.0], 1.0, "a stiffness is 0, expected a positive number"),
        (vec![1.0; 3], f64::INFINITY, "a stiffness is inf"),
        (vec![1.0; 3], f64::NAN, "a stiffness is NaN"),
    ] {
        let springs = Springs { actuators, translation, rotation: 1.0 };
        let error = Compliant::new(&manipulator, springs).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}
