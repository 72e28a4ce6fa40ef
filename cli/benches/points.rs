//! Points of a sweep, recorded by the program, against what compressing and copying the same bytes takes.

use opm_benches::{Contender, compare};
use opm_mcap::workspace::{CHUNK_BYTES, OVERVIEW_TOPIC, SLICES_TOPIC};
use opm_mcap::{COMPRESSION_LEVEL, ReadError, read};
use std::fs;
use std::hint::black_box;
use std::path::Path;
use std::process::{Command, Stdio};
use zstd::bulk::Compressor;

const MECHANISM: &str = "plano-spherical-5dof";
/// Twenty million poses of it are in reach; many more than an overview has.
const GRID: [&str; 5] =
    ["x=-0.15:0.15:201", "y=-0.15:0.15:201", "zeta=-0.4:0.4:9", "xi=-0.4:0.4:9", "psi=-0.4:0.4:9"];
fn main() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).to_str().expect("UTF-8").to_owned();
    let [mcap, ply] = ["points.mcap", "points.ply"].map(path);
    let run = |threads: &str, output: Option<&str>| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_opm"));
        command.args(["workspace", MECHANISM, "--threads", threads, "--quiet"]);
        command.args(GRID.iter().flat_map(|axis| ["--grid", axis]));
        command.args(output.iter().flat_map(|output| ["-o", output]));
        let status = command.stdout(Stdio::null()).status();
        assert!(status.expect("the program starts").success());
    };
    run("2", Some(&mcap));
    // What is in the recording: an overview, then all points.
    let mut bytes = Vec::new();
    let recording = read(Path::new(&mcap), |message| {
        bytes.extend_from_slice(message.data);
        Ok::<(), ReadError>(())
    });
    let recording = recording.expect("what was written");
    let [points, overview] = [SLICES_TOPIC, OVERVIEW_TOPIC]
        .map(|topic| recording.topic(topic).and_then(|topic| topic.points).expect("points"));
    let stride = bytes.len() as u64 / (points + overview);
    let recorded = fs::metadata(&mcap).expect("what was written").len();

    let mut compressor = Compressor::new(COMPRESSION_LEVEL as i32).expect("a level of zstd");
    let mut copy = vec![0; bytes.len()];
    let timings = compare(vec![
        Contender::new("recorded, one thread", points, || run("1", Some(&mcap))),
        Contender::new("recorded, two threads", points, || run("2", Some(&mcap))),
        Contender::new("as PLY, not compressed, every coordinate, one thread", points, || {
            run("1", Some(&ply));
        }),
        Contender::new("only counted, one thread", points, || run("1", None)),
        Contender::new("its bytes compressed, by zstd alone", points, || {
            for chunk in bytes.chunks(CHUNK_BYTES as usize) {
                black_box(compressor.compress(chunk)).expect("room for a chunk");
            }
        }),
        Contender::new("its bytes copied", points, || {
            copy.copy_from_slice(&bytes);
            black_box(&copy);
        }),
    ]);
    println!("| points, 5 DoF | million points a second | of the recording's time |");
    println!("|---|---:|---:|");
    for t in &timings {
        println!("| {} | {:.1} | {:.2} |", t.name, 1e-6 / t.seconds, t.ratio);
    }
    println!(
        "{points} points of {stride} bytes, in the recording {:.2}, the {overview} of its overview among \
         them; the program's whole time, counting included. Compressing alone takes {:.0} % of it.",
        recorded as f64 / points as f64,
        100.0 * timings[4].ratio,
    );
}
