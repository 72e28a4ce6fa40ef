//! Poses of TITLE, with the joints that opm VERSION found.

use CRATE::{COORDINATES, DEFAULT, JOINTS, Real, Refusal, inverse};

/// The mode, the number of the leg that is out of reach (from 1) or 0, the pose, the joints and the imaginary joints.
type Row = (u32, usize, [Real; COORDINATES], &'static [Real], &'static [Real]);

/// How far a joint may be from what opm found, radians or sizes of the mechanism.
const TOLERANCE: Real = if size_of::<Real>() == 4 { 1e-3 } else { 1e-10 };

#[test]
fn joints_are_those_of_opm() {
    for (number, (mode, leg, pose, joints, imaginary)) in GOLDEN.iter().enumerate() {
        let found = match inverse(&DEFAULT, pose, *mode) {
            Ok(found) => found,
            Err(why) => {
                assert_eq!(why, Refusal::OutOfReach { leg: leg - 1 }, "pose {number}");
                continue;
            }
        };
        assert_eq!(*leg, 0, "pose {number}");
        for (i, (found, expected)) in found.joints.iter().zip(*joints).enumerate() {
            let off = apart(*found, *expected, IS_ANGLE[i]) / DEFAULT.joint[i].size;
            assert!(off <= TOLERANCE, "pose {number}, joint {i}: {found}, expected {expected}");
        }
        assert_eq!(found.imaginary.len(), imaginary.len());
    }
}

/// The difference of two values of a joint; full revolutions are none where half a revolution from home decides.
fn apart(found: Real, expected: Real, angle: bool) -> Real {
    let full = 2.0 * (-1.0 as Real).acos();
    let off = (found - expected).abs();
    if angle && off > full / 2.0 { (off - full).abs() } else { off }
}

/// Which joints are angles.
const IS_ANGLE: [bool; JOINTS] = [ANGLES];

#[rustfmt::skip]
#[allow(clippy::all)]
const GOLDEN: &[Row] = &[
    ROWS
];
