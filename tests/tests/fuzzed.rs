//! The corpora of the fuzz targets, and random changes of them: nothing panics, and what is accepted holds.

mod command;

use command::{flags, foreign, number};
use fastrand::Rng;
use opm_core::mechanism::examples;
use opm_tests::fuzzed::{joint_list, mechanism, motion, recording};
use std::fs;
use std::path::Path;

/// Changes of every stored input. OPM_FUZZ multiplies it.
const CHANGES: usize = 60;

/// Inputs without any model, of joint lists.
const LISTS: usize = 700;

/// Command lines without any model.
const LINES: usize = 60;

fn factor() -> usize {
    std::env::var("OPM_FUZZ").ok().and_then(|text| text.parse().ok()).unwrap_or(1)
}

fn corpus(target: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus").join(target);
    let mut paths: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    assert!(!paths.is_empty(), "no corpus of {target}");
    paths.iter().map(|path| fs::read(path).unwrap()).collect()
}

/// Bytes changed, removed, repeated, or replaced by what often decides.
fn change(rng: &mut Rng, data: &[u8]) -> Vec<u8> {
    const TOKENS: [&[u8]; 12] =
        [b"0", b"-1", b"1e308", b"nan", b"inf", b"[", b"]", b"{", b"\"", b"\n", b"=", b"1e-320"];
    let mut data = data.to_vec();
    for _ in 0..1 + rng.usize(..6) {
        let at = rng.usize(..=data.len());
        let end = (at + 1 + rng.usize(..16)).min(data.len());
        match rng.u8(..6) {
            0 if at < data.len() => data[at] = rng.u8(..),
            1 if at < data.len() => data[at] ^= 1 << rng.u8(..8),
            2 => drop(data.drain(at..end)),
            3 => drop(data.splice(at..at, data[at..end].to_vec())),
            4 => drop(data.splice(at..end, TOKENS[rng.usize(..TOKENS.len())].iter().copied())),
            _ => data.truncate(at.max(1)),
        }
    }
    data
}

fn replay(target: &str, seed: u64, mut inputs: Vec<Vec<u8>>, run: impl Fn(&[u8])) {
    let mut rng = Rng::with_seed(seed);
    inputs.extend(corpus(target));
    let mut executions = 0;
    for input in &inputs {
        run(input);
        for _ in 0..CHANGES * factor() {
            run(&change(&mut rng, input));
            executions += 1;
        }
    }
    println!("{target}: {} inputs, {executions} changes", inputs.len());
}

#[test]
fn mechanism_files() {
    let shipped = examples::EXAMPLES.iter().map(|example| example.text.as_bytes().to_vec());
    replay("mechanism", 1, shipped.collect(), mechanism);
}

#[test]
fn motions() {
    let shipped = opm_core::motion::examples::MOTIONS.iter();
    let shipped = shipped.map(|motion| [b"\0", motion.text.as_bytes()].concat());
    replay("motion", 2, shipped.collect(), motion);
}

#[test]
fn recordings() {
    replay("recording", 3, Vec::new(), recording);
}

#[test]
fn joint_lists() {
    let mut rng = Rng::with_seed(4);
    let random = (0..LISTS).map(|_| (0..20 + rng.usize(..120)).map(|_| rng.u8(..)).collect());
    let random: Vec<Vec<u8>> = random.collect();
    random.iter().for_each(|input| joint_list(input));
    replay("joint_list", 5, Vec::new(), joint_list);
}

#[test]
fn numbers() {
    replay("number", 6, Vec::new(), number);
}

#[test]
fn command_lines() {
    let mut rng = Rng::with_seed(7);
    let random = (0..LINES).map(|_| (0..4 + rng.usize(..40)).map(|_| rng.u8(..)).collect());
    replay("flags", 8, random.collect(), flags);
}

/// Those of the target before, and others; all commands read them.
#[test]
fn recordings_of_strangers() {
    replay("foreign", 9, Vec::new(), foreign);
}
