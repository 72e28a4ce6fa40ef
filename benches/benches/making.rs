//! Time of making a manipulator from its mechanism: mobility, decomposition, closed forms of all legs.

use opm_benches::{Contender, compare, example};
use opm_core::Manipulator;
use opm_core::mechanism::Mechanism;
use std::hint::black_box;

const NAMES: [&str; 6] =
    ["planar-3rrr", "plano-spherical-5dof", "tricept", "tripteron", "delta", "stewart"];

fn main() {
    let mechanisms = NAMES.map(|name| (name, example(name).mechanism().clone()));
    let contender = |(name, mechanism): &(&'static str, Mechanism)| {
        let mechanism = mechanism.clone();
        Contender::new(name, 1, move || {
            black_box(Manipulator::new(black_box(&mechanism).clone()))
                .expect("a shipped mechanism");
        })
    };
    let timings = compare(mechanisms.iter().map(contender).collect());
    println!("| making a manipulator, one thread | µs | of planar-3rrr's time |");
    println!("|---|---:|---:|");
    for t in timings {
        println!("| {} | {:.0} | {:.1} |", t.name, t.seconds * 1e6, t.ratio);
    }
}
