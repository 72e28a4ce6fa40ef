//! Linkages at half and quarter turns of their inputs, at home, and at the ends of their ranges.

use opm_core::Linkage;
use opm_core::linkage::InputRange;
use opm_core::mechanism::{Mechanism, examples, file};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// The bound on closure of the loop, metres and radians: the shipped linkage is about a metre in size.
const CLOSES: f64 = 1e-10;

fn shipped() -> Mechanism {
    file::read(examples::find("bennett-double-spherical-6r").unwrap().text).unwrap().mechanism
}

/// How far the platform by one leg is from the platform by the other, from the products of exponentials.
fn gap(mechanism: &Mechanism, joints: &[f64]) -> f64 {
    let (one, two) = joints.split_at(mechanism.legs[0].coordinates().count());
    let [one, two] =
        [(0, one), (1, two)].map(|(leg, q)| mechanism.legs[leg].displacement(q).unwrap());
    (one.to_homogeneous() - two.to_homogeneous()).norm()
}

#[test]
fn structured_inputs_close_the_loop() {
    let mechanism = shipped();
    let linkage = Linkage::new(&mechanism).unwrap();
    let mut closed = 0;
    for coordinate in linkage.coordinates() {
        let input = linkage.input(&coordinate.name).unwrap();
        let mut values: Vec<f64> = (-16..=16).map(|n| f64::from(n) * FRAC_PI_4).collect();
        values.extend((-8..=8).map(|n| coordinate.home + f64::from(n) * FRAC_PI_2));
        for value in values {
            let positions = input.solve(value);
            assert_eq!(!positions.is_empty(), input.range().contains(value), "{value}");
            for position in positions {
                let off = gap(&mechanism, &position.joints);
                assert!(off < CLOSES, "{} = {value}: {off:e}", coordinate.name);
                closed += 1;
            }
        }
        // Home is one of the positions at its own input.
        let home =
            |q: &[f64]| linkage.coordinates().iter().zip(q).all(|(c, q)| (q - c.home).abs() < 1e-7);
        let at_home = input.solve(coordinate.home);
        assert!(at_home.iter().any(|position| home(&position.joints)), "{}", coordinate.name);
        if let InputRange::Intervals(intervals) = input.range() {
            for end in intervals.iter().flatten() {
                for position in input.solve(*end) {
                    // Two branches meet there, so that half of the digits are lost.
                    assert!(
                        gap(&mechanism, &position.joints) < 1e-7,
                        "{} at {end}",
                        coordinate.name
                    );
                    closed += 1;
                }
            }
        }
    }
    assert!(closed > 200, "{closed}");
}
