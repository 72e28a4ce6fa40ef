use super::samples::*;
use super::*;
use crate::joint::{Joint, JointKind};
use crate::mobility::mobility;
use nalgebra::{Isometry3, Point3, Unit, Vector3};

/// Geometry fitted to exact joints, relative to the mechanism: rounding of a few dozen operations.
const EXACT: f64 = 1e-13;

#[test]
fn report() {
    let mut numbers = Numbers::new(1);
    for m in [
        PlanoSpherical::default().mechanism(),
        translational_helical(),
        bennett(),
        two_spherical(&mut numbers),
        two_planar(&mut numbers),
        planar_cylindrical(),
        gough(&mut numbers),
    ] {
        let t = std::time::Instant::now();
        let mob = mobility(&m).unwrap();
        let t1 = t.elapsed();
        println!("{} {mob:?}", m.name);
        let t = std::time::Instant::now();
        let (found, visited) = search(&m, mob.lambda, mob.mobility);
        println!("{t1:?} {:?} visited {visited} {}", t.elapsed(), found.len());
        for d in found {
            println!(
                "{} {} {} J{} M{} F0 {} red {} dev {:e}",
                d.lower,
                d.upper,
                d.intersection,
                d.imaginary_joints,
                d.first_section_motions,
                d.upper_mobility,
                d.redundancy,
                d.deviation
            );
            println!(
                "{:?}",
                d.legs
                    .iter()
                    .map(|l| (l.lower.len(), l.upper.len(), l.imaginary))
                    .collect::<Vec<_>>()
            );
        }
    }
}
