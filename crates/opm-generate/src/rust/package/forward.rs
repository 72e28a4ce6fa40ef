
/// The pose at which the actuated joints have given values, by Newton's method from a pose nearby, in the working mode of
/// that; and how far the actuated joints are off in the end, radians or sizes of the mechanism.
pub fn forward(
    geometry: &Geometry,
    actuated: &[Real; ACTUATED],
    mode: u32,
    near: &[Real; COORDINATES],
) -> Result<([Real; COORDINATES], Real), Refusal> {
    let (mut pose, mut residual) = (*near, 0.0);
    checked(kinematics::forward(geometry, actuated, mode, &mut pose, &mut residual))?;
    Ok((pose, residual))
}
