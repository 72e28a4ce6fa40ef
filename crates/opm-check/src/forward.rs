//! Forward kinematics compared with the poses that joint values came from.

use crate::certificate::{Comparison, Options, PoseInMode};
use crate::closure::{apart, gap};
use crate::poses::{pose, tolerance};
use opm_core::manipulator::{Manipulator, Mode};
use opm_core::mechanism::joint::JointKind;

/// The largest distance of an assembly from the pose that its joint values came from: radians, and lengths over the
/// size.
const SAME: f64 = 1e-6;

/// A pose nearer to a singularity is left out: two assemblies merge there, or a family of poses has the same joint
/// values. The measures have no unit.
const SINGULAR: f64 = 1e-3;

/// Every pose is among the assemblies for its joint values, by the closed form or near it by Newton's method, and
/// every assembly closes.
pub fn forward(
    manipulator: &Manipulator,
    options: &Options,
    go_on: &mut impl FnMut() -> bool,
) -> Option<Comparison> {
    let every = manipulator.forward_method();
    let what = match every {
        Ok(_) => {
            "every assembly for joint values of inverse kinematics, with the poses that these came from"
        }
        Err(_) => {
            "the assembly that Newton's method finds nearby, with the pose that its joint values came from"
        }
    };
    // Whole revolutions of a screw that its motor does not show are further assemblies, of which one is listed.
    let screws =
        manipulator.mechanism().joints().any(|j| matches!(j.kind, JointKind::Helical { .. }));
    let most = tolerance(manipulator, SAME);
    let mut found = Comparison::new("forward", what, Some(most));
    let mut rng = options.rng(4);
    let (mut all, mut at) = (manipulator.all_modes(), manipulator.solution());
    let (mut jacobians, mut measured) = (manipulator.jacobians(), manipulator.singularities());
    for _ in 0..options.samples {
        if !go_on() {
            return None;
        }
        let pose = pose(&mut rng, manipulator);
        if let Err(error) = manipulator.inverse_all(&pose, &mut all) {
            found.fail(|| error.to_string());
            continue;
        }
        let modes: Vec<Mode> = all.modes(manipulator).collect();
        if modes.is_empty() {
            found.leave_out("out of reach, or near a singularity");
            continue;
        }
        let mode = modes[rng.usize(..modes.len())];
        let place = || PoseInMode { manipulator, pose: &pose, mode }.to_string();
        let regular = manipulator.solution_in_mode(&all, mode, &mut at).is_some()
            && manipulator.differentiate(&at, &mut jacobians).is_ok_and(|regular| regular);
        if regular {
            manipulator.measure_singularities(&jacobians, &mut measured);
        }
        let near = |measure: f64| measure.abs() < SINGULAR;
        let stuck = measured.legs.iter().flatten().any(|measure| near(*measure));
        if !regular || stuck || measured.whole.parallel.is_none_or(near) {
            found.leave_out("out of reach, or near a singularity");
            continue;
        }
        let target = at.displacement(manipulator);
        let actuated: Vec<f64> = manipulator.actuated().iter().map(|&i| at.joints()[i]).collect();
        let mut assemblies = match every.as_ref().map(|_| manipulator.forward(&actuated)) {
            Ok(Ok(found)) => found.list,
            Ok(Err(error)) => {
                found.fail(|| format!("{error}: {}", place()));
                continue;
            }
            Err(_) => Vec::new(),
        };
        let near = [0.0, 1e-4].map(|farthest| {
            let step = |q: &f64| q + farthest * (2.0 * rng.f64() - 1.0);
            let start: Vec<f64> = pose.iter().map(step).collect();
            manipulator.forward_near(&actuated, &start, mode)
        });
        let listed = if every.is_ok() && !screws { assemblies.len() } else { usize::MAX };
        assemblies.extend(near.into_iter().flatten());
        let mut nearest = f64::INFINITY;
        for (number, assembly) in assemblies.iter().enumerate() {
            // All coordinates as they are given, dependent ones too.
            let there = manipulator.displacement_of(assembly);
            let open = gap(manipulator, &assembly.joints, &there);
            if open.is_nan() || open > most {
                found.fail(|| format!("an assembly whose legs are {open:.2e} open: {}", place()));
            }
            let follows = manipulator.displacement_in(&assembly.pose, assembly.mode);
            if !follows.is_ok_and(|follows| apart(manipulator, &follows, &there) <= most.max(SAME))
            {
                found.fail(|| {
                    let signs = manipulator.format_mode(assembly.mode);
                    format!(
                        "an assembly whose coordinates do not follow in mode {signs:?}: {}",
                        place()
                    )
                });
            }
            // One pose may have two sets of angles, each in modes of its own: places are compared, not numbers.
            if number < listed && manipulator.assembly_in(assembly, mode).is_some() {
                nearest = nearest.min(apart(manipulator, &there, &target));
            }
        }
        found.note(nearest, place);
    }
    Some(found)
}
