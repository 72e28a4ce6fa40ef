//! Reactions in motion: what passes through two joints of a link differs by what changes the link's momentum, and efforts are those of
//! inverse dynamics.

#[allow(dead_code, reason = "energies are for other tests")]
mod bodies;

use bodies::Bodies;
use nalgebra::{DVector, Isometry3, Point3, Vector3, Vector6};
use opm_analysis::{Compliant, Gravity, JointMotion, Loads, Setup, Springs, Statics, Wrench};
use opm_core::Manipulator;
use opm_core::mechanism::examples::EXAMPLES;
use opm_core::mechanism::joint::{Drive, JointKind};
use opm_core::skeleton::{Density, Mass, Skeleton};

const STEP: f64 = 1e-3;

/// With rotors at motors, and friction at all joints.
fn driven(name: &str) -> Option<Manipulator> {
    let mut mechanism = Manipulator::example(name).ok()?.mechanism().clone();
    for joint in mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints) {
        let rotor_inertia = if joint.actuated { 1e-5 } else { 0.0 };
        for c in &mut joint.coordinates {
            let (gear, viscous_friction, coulomb_friction) = (20.0, 0.05, 0.1);
            c.drive = Drive { rotor_inertia, gear, viscous_friction, coulomb_friction };
        }
    }
    Manipulator::new(mechanism).ok()
}

/// The force and the moment about a point that change the momentum of a body besides its weight: differences of fourth order along a
/// motion that `placed` gives.
fn needed(
    mass: &Mass,
    about: &Point3<f64>,
    gravity: &Vector3<f64>,
    placed: impl Fn(f64) -> Isometry3<f64>,
) -> Vector6<f64> {
    let momentum = |t: f64| {
        let h = STEP / 4.0;
        let at = |k: f64| placed(t + k * h);
        let rate = |f: &dyn Fn(f64) -> Vector3<f64>| {
            ((f(1.0) - f(-1.0)) * 8.0 - (f(2.0) - f(-2.0))) / (12.0 * h)
        };
        let here = at(0.0);
        let velocity = rate(&|k| (at(k) * mass.centre).coords);
        let turned = |k: f64| (at(k).rotation * here.rotation.inverse()).scaled_axis();
        let own = here.rotation.inverse() * rate(&turned);
        let linear = velocity * mass.mass;
        let arm = here * mass.centre - about;
        let angular = here.rotation * (mass.inertia * own) + arm.cross(&linear);
        Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
    };
    let one = momentum(STEP) - momentum(-STEP);
    let change = (one * 8.0 - (momentum(2.0 * STEP) - momentum(-2.0 * STEP))) / (12.0 * STEP);
    let weight = gravity * mass.mass;
    let moment = (placed(0.0) * mass.centre - about).cross(&weight);
    change - Vector6::new(weight.x, weight.y, weight.z, moment.x, moment.y, moment.z)
}

#[test]
fn reactions_change_the_momentum_of_each_body() {
    let acceleration = Vector3::new(0.4, -0.6, -9.81);
    let gravity = Gravity { acceleration, density: Density::default() };
    let (mut bodies_compared, mut efforts_compared) = (0, 0);
    for example in EXAMPLES {
        let (name, Some(m)) = (example.name, driven(example.name)) else { continue };
        let length = m.characteristic_length();
        let vector = |size: f64, seed: usize| {
            DVector::from_fn(m.task_coordinates().len(), |j, _| {
                let of_length = m.task_coordinates()[j].quantity == opm_core::Quantity::Length;
                let unit = if of_length { length } else { 1.0 };
                size * unit * (1.0 + 1.7 * (seed + j) as f64).cos()
            })
        };
        let x = DVector::from_vec(m.home_pose()) + vector(0.03, 0);
        let (v, a) = (vector(0.9, 2), vector(3.0, 5));
        let along = |t: f64| &x + &v * t + &a * (0.5 * t * t);
        let bodies = Bodies::new(&m, &gravity);
        let reached =
            [-3.0, 3.0].iter().all(|k| bodies.solved(along(k * STEP).as_slice()).is_some());
        let Some(at) = bodies.solved(x.as_slice()).filter(|_| reached) else { continue };
        let mut motion = m.joint_motion();
        if !m.velocity(&at, v.as_slice(), a.as_slice(), &mut motion).unwrap() {
            continue;
        }
        let (rates, accelerations) = (&motion.joint_rates[..], &motion.joint_accelerations[..]);
        let joint_motion = JointMotion { rates, accelerations };
        let springs =
            Springs { actuators: vec![3e4; m.actuated().len()], translation: 1e6, rotation: 1e4 };
        let mut compliant = Compliant::new(&m, springs).unwrap().with_gravity(&gravity);
        let Some(stiffness) = compliant.stiffness_in(&at, Some(joint_motion)) else { continue };
        let load = Wrench::from_components([3.0, -1.0, 2.0, 0.2, 0.1, -0.3]);
        let Some(found) = compliant.reactions(&stiffness, &load) else { continue };

        // Each link, then the platform.
        let skeleton = Skeleton::new(m.mechanism(), None);
        let masses = skeleton.masses(m.mechanism(), gravity.density);
        let reference = m.platform_at(&at.displacement(&m)).translation.vector.into();
        let place =
            |body: usize, t: f64| bodies.placed(along(t).as_slice()).expect("in reach")[body];
        let screws = {
            let mut screws = opm_analysis::Screws::new(&m);
            screws.update(&at);
            screws
        };
        let (mut body, mut joint, mut freedom) = (1, 0, 0);
        let mut on_platform = Vector6::from(load.components());
        for (leg, whole) in m.mechanism().legs.iter().zip(&found.legs) {
            let mut through = Vec::new();
            for own in &leg.joints {
                let point = screws.freedoms[freedom].point;
                let wrench = found.joints[joint].moved(&point, &reference);
                through.push(Vector6::from(wrench.components()));
                freedom += own.coordinates.len();
                joint += 1;
            }
            for pair in through.windows(2) {
                let expected = needed(&masses[body], &reference, &acceleration, |t| place(body, t));
                // The base side pushes back with what passes through.
                let off = (pair[1] - pair[0] - expected).amax();
                let size = pair[0].amax() + pair[1].amax() + expected.amax();
                assert!(off < 1e-6 * size, "{name} {body}: {} {expected}", pair[1] - pair[0]);
                body += 1;
                bodies_compared += 1;
            }
            on_platform -= Vector6::from(whole.components());
        }
        let expected = needed(&masses[body], &reference, &acceleration, |t| place(body, t));
        let off = (on_platform - expected).amax();
        let size = expected.amax() + load.components().iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        assert!(off < 1e-6 * size, "{name}: {on_platform} {expected}");
        bodies_compared += 1;

        // Passive joints carry their friction and nothing else.
        let (mut joint, mut freedom) = (0, 0);
        for own in m.mechanism().joints() {
            let free = !own.actuated && own.kind != JointKind::Spherical;
            for c in own.coordinates.iter().filter(|_| free) {
                let number = freedom + own.coordinates.iter().position(|o| o == c).unwrap();
                let screw = &screws.freedoms[number].screw;
                let wrench = &found.joints[joint];
                let point = screws.freedoms[freedom].point.coords;
                let velocity = screw.linear + screw.angular.cross(&point);
                let work = wrench.force.dot(&velocity) + wrench.moment.dot(&screw.angular);
                let friction = c.drive.effort(rates[number], accelerations[number]);
                let size = wrench.force.norm() * length + wrench.moment.norm();
                assert!(
                    (work - friction).abs() < 1e-7 * size.max(1.0),
                    "{name} {}: {work} {friction}",
                    c.name
                );
            }
            joint += 1;
            freedom += own.coordinates.len();
        }

        let setup = Setup { gravity: Some(gravity), ..Setup::new(length) };
        let mut statics = Statics::new(&m, length);
        if !statics.update(&at).unwrap() || statics.internal() > 0 {
            continue;
        }
        let mut loads = Loads::new(&m, &setup).unwrap();
        loads.set_load(opm_analysis::Load { wrench: load, ..Default::default() });
        let efforts = loads.efforts_in(&statics, &at, Some(joint_motion)).actuated;
        for (own, expected) in found.efforts.iter().zip(efforts) {
            let Some(expected) = expected else { continue };
            let size = found.efforts.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            assert!((own - expected).abs() < 1e-6 * size, "{name}: {own} {expected}");
            efforts_compared += 1;
        }
    }
    assert!(bodies_compared > 100 && efforts_compared > 40, "{bodies_compared} {efforts_compared}");
}
