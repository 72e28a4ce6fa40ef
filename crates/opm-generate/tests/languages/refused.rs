//! Closed forms that no code is written for: that is said, and no code has less than the mechanism.

use opm_core::Manipulator;
use opm_generate::{Content, GenerateError, c_package};

fn refusal(text: &str) -> GenerateError {
    let manipulator = Manipulator::read(text).expect("it has closed forms");
    c_package(&manipulator, Content::Kinematics).map(|_| ()).expect_err("it has no code")
}

#[test]
fn a_ball_that_slides_on_a_line_has_no_code() {
    let text = include_str!("../../../../tests/tests/rails/2pur-psr.toml");
    assert_eq!(refusal(text), GenerateError::Rail);
}

#[test]
fn an_orientation_that_follows_from_the_position_has_no_code() {
    let exechon = include_str!("../../../opm-core/templates/exechon.toml");
    assert!(exechon.contains("[platform]"));
    let by_place = "[task]\nindependent = [\"x\", \"y\", \"z\"]\n[platform]";
    assert_eq!(refusal(&exechon.replace("[platform]", by_place)), GenerateError::Place);
}
