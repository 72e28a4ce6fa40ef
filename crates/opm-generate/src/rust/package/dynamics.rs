
/// The efforts of the actuated joints, N m and N, for rates and accelerations of the coordinates of the pose: what moves the bodies
/// of the geometry against their inertia and weight, the rotors, and friction. They are positive where the actuator pushes its
/// joint towards larger values. [`Refusal::NoNumber`] counts the rates, then the accelerations.
pub fn inverse_dynamics(
    geometry: &Geometry,
    pose: &[Real; COORDINATES],
    mode: u32,
    rates: &[Real; COORDINATES],
    accelerations: &[Real; COORDINATES],
) -> Result<[Real; ACTUATED], Refusal> {
    let mut efforts = [0.0; ACTUATED];
    checked(kinematics::inverse_dynamics(geometry, pose, mode, rates, accelerations, &mut efforts))?;
    Ok(efforts)
}
