//! Shipped files that construct their points, against the numbers that were typed before, in `typed.csv`: millimetres and
//! degrees, with up to 15 digits.

use super::*;
use crate::mechanism::examples::find;
use crate::mechanism::joint::JointKind;
use crate::mechanism::leg::Leg;
use crate::numeric::Quantity;
use nalgebra::Vector3;

/// The numbers of the table have at least twelve decimals; lengths are millimetres there and metres here.
const TYPED: f64 = 2e-12;

/// Where a slider is drawn was typed with six decimals.
const DRAWN: f64 = 1e-9;

fn numbers(text: &str) -> Vec<f64> {
    text.split(' ').filter(|word| !word.is_empty()).map(|word| word.parse().unwrap()).collect()
}

#[test]
fn constructed_points_are_those_that_were_typed() {
    let (mut name, mut joints) = ("", Vec::new().into_iter());
    let mut compared = 0;
    for line in include_str!("typed.csv").lines().skip(1) {
        let [mechanism, leg, joint, point, axis, axis2, home, limits] =
            line.split(',').collect::<Vec<_>>()[..]
        else {
            panic!("{line}")
        };
        if mechanism != name {
            assert_eq!(joints.len(), 0, "{name}");
            name = mechanism;
            let legs = read(find(name).unwrap().text).unwrap().mechanism.legs;
            let of = |leg: Leg| leg.joints.into_iter().map(move |joint| (leg.name.clone(), joint));
            joints = legs.into_iter().flat_map(of).collect::<Vec<_>>().into_iter();
        }
        let (found_leg, found) = joints.next().expect(line);
        assert_eq!((&*found_leg, &*found.name), (leg, joint), "{line}");
        let direction = |text: &str| Vector3::from_vec(numbers(text)).normalize();
        let place = Vector3::from_vec(numbers(point)) * 1e-3;
        let within = if found.kind == JointKind::Prismatic { DRAWN } else { TYPED };
        assert!((found.point.coords - place).norm() < within, "{line}: {}", found.point);
        if !axis.is_empty() {
            assert!((*found.axis - direction(axis)).norm() < TYPED, "{line}: {:?}", found.axis);
        }
        if let JointKind::Universal { second } = found.kind {
            assert!((*second - direction(axis2)).norm() < TYPED, "{line}: {second:?}");
        }
        let [coordinate] = &found.coordinates[..] else {
            compared += 1;
            continue;
        };
        let unit = if coordinate.quantity == Quantity::Angle { 1_f64.to_radians() } else { 1e-3 };
        let home = home.parse::<f64>().unwrap() * unit;
        assert!((coordinate.home - home).abs() < TYPED, "{line}: {}", coordinate.home);
        let limits: Vec<f64> = numbers(limits).into_iter().map(|limit| limit * unit).collect();
        let found: Vec<f64> = coordinate.limits.into_iter().flatten().collect();
        assert_eq!(found.len(), limits.len(), "{line}");
        assert!(found.iter().zip(limits).all(|(a, b)| (a - b).abs() < TYPED), "{line}: {found:?}");
        compared += 1;
    }
    assert_eq!((joints.len(), compared), (0, 106));
}
