use super::*;
use crate::decomposition::samples::{Numbers, displaced, gough};
use crate::mechanism::examples::EXAMPLES;
use crate::mechanism::file;
use crate::mechanism::joint::{Joint, JointKind};
use nalgebra::{Unit, UnitQuaternion, Vector3};

/// The shipped mechanisms that are lists of joints.
fn shipped() -> Vec<Mechanism> {
    let read = |text| file::read(text).expect("a shipped mechanism");
    let files = EXAMPLES.iter().map(|example| read(example.text));
    files.filter(|file| file.family.is_none()).map(|file| file.mechanism).collect()
}

/// A number with some significant digits.
fn digits(value: f64, count: usize) -> f64 {
    format!("{value:.*e}", count - 1).parse().expect("a number")
}

fn edited(mechanism: &Mechanism, mut edit: impl FnMut(&mut Joint)) -> Mechanism {
    let mut edited = mechanism.clone();
    edited.legs.iter_mut().flat_map(|leg| &mut leg.joints).for_each(&mut edit);
    edited
}

/// A mechanism whose axes and points (in millimetres) have some significant digits.
fn rounded(mechanism: &Mechanism, count: usize) -> Mechanism {
    let direction = |axis: Unit<Vector3<f64>>| Unit::new_normalize(axis.map(|c| digits(c, count)));
    edited(mechanism, |joint| {
        joint.axis = direction(joint.axis);
        joint.point = joint.point.map(|c| digits(c * 1e3, count) / 1e3);
        if let JointKind::Universal { second } = &mut joint.kind {
            *second = direction(*second);
        }
    })
}

/// λ, N, J, M, the sections and the splits of the legs.
fn essence(mechanism: &Mechanism) -> Vec<String> {
    let found = plain(mechanism).expect("a mechanism that decomposes");
    let one = |d: &Decomposition| {
        let names = [d.lower, d.upper, d.intersection].map(|class| class.name());
        let counts = (d.lambda, d.mobility, d.imaginary_joints, d.first_section_motions);
        format!("{counts:?} {names:?} {:?}", d.legs)
    };
    found.iter().map(one).collect()
}

#[test]
fn explore() {
    for mechanism in shipped() {
        for count in [2, 3] {
            for seed in 0..4 {
                let g = Numbers::new(seed).displacement(0.1);
                let moved = if seed == 0 { mechanism.clone() } else { displaced(&mechanism, &g) };
                let printed = rounded(&moved, count);
                let near = nearly(&printed).unwrap();
                let snapped = snap(&printed, 0.02).unwrap();
                let same = plain(&snapped.mechanism).is_ok() && essence(&snapped.mechanism) == essence(&mechanism);
                println!("{} {count} {seed}: {same} {:?} | {}", mechanism.name,
                    plain(&snapped.mechanism).map(|f| f[0].deviation).map_err(|e| e.to_string()),
                    near.map(|n| format!("{:.4} {n}", n.tolerance)).unwrap_or_default());
            }
        }
    }
    println!("{:?}", nearly(&gough(&mut Numbers::new(1))));
    let _ = UnitQuaternion::<f64>::identity();
}
