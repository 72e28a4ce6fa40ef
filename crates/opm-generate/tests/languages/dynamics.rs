//! For which mechanisms the inverse dynamics are written.

use crate::drawn::shipped;
use opm_core::Manipulator;
use opm_core::mechanism::joint::JointKind;
use opm_generate::{Content, GenerateError, check_dynamics};

/// All mechanisms whose code is compared with opm have them, but one whose rods turn about themselves.
#[test]
fn shipped_mechanisms_have_inverse_dynamics() {
    let all = shipped();
    assert!(all.len() > 20);
    for m in &all {
        let leg = m.mechanism().legs[0].name.clone();
        let expected = match &*m.mechanism().name {
            "ankle" => Err(GenerateError::Idle { leg, freedoms: 7 }),
            _ => Ok(()),
        };
        assert_eq!(check_dynamics(m), expected, "{}", m.mechanism().name);
    }
}

/// What cannot be written is refused, and the message says why; the kinematics are written.
#[test]
fn what_is_not_determined_is_refused() {
    let m = Manipulator::example("planar-3rrr").unwrap();
    let mut mechanism = m.mechanism().clone();
    mechanism.legs[0].joints[1].actuated = true;
    let m = Manipulator::new(mechanism).unwrap();
    let refused = GenerateError::Actuators { actuators: 4, freedoms: 3 };
    assert_eq!(opm_generate::c(&m, Content::Dynamics), Err(refused.clone()));
    assert_eq!(check_dynamics(&m), Err(refused));
    assert!(opm_generate::c(&m, Content::Kinematics).is_ok());
    let mut mechanism = Manipulator::example("stewart").unwrap().mechanism().clone();
    let mut all = mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints);
    let ball = all.find(|joint| joint.kind == JointKind::Spherical).unwrap();
    ball.coordinates[1].drive.coulomb_friction = 0.1;
    let joint = ball.name.clone();
    let refused = check_dynamics(&Manipulator::new(mechanism).unwrap()).unwrap_err();
    assert_eq!(refused, GenerateError::BallFriction { joint: joint.clone() });
    assert!(refused.to_string().contains(&format!("the spherical joint {joint} has friction")));
}
