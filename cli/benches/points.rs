//! Points of a sweep, recorded by the program, against what compressing and copying the same bytes takes.

use opm_benches::{Contender, compare};
use opm_mcap::{CHUNK_BYTES, COMPRESSION_LEVEL};
use std::fs;
use std::hint::black_box;
use std::process::{Command, Stdio};
use zstd::bulk::Compressor;

const MECHANISM: &str = "plano-spherical-5dof";
/// Twenty million poses of it are in reach; many more than an overview has.
const GRID: [&str; 5] =
    ["x=-0.15:0.15:201", "y=-0.15:0.15:201", "zeta=-0.4:0.4:9", "xi=-0.4:0.4:9", "psi=-0.4:0.4:9"];
/// What ends the header of a PLY file.
const END: &[u8] = b"end_header\n";

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
    run("2", Some(&ply));
    // As the recording has them, but for what is between them there.
    let table = fs::read(&ply).expect("what was written");
    let header = table.windows(END.len()).position(|bytes| bytes == END).expect("a header");
    let bytes = &table[header + END.len()..];
    let points = points(&table[..header]);
    let stride = bytes.len() as u64 / points;
    let recorded = fs::metadata(&mcap).expect("what was written").len();

    let mut compressor = Compressor::new(COMPRESSION_LEVEL as i32).expect("a level of zstd");
    let mut copy = vec![0; bytes.len()];
    let timings = compare(vec![
        Contender::new("recorded, one thread", points, || run("1", Some(&mcap))),
        Contender::new("recorded, two threads", points, || run("2", Some(&mcap))),
        Contender::new("as PLY, which is not compressed, one thread", points, || {
            run("1", Some(&ply));
        }),
        Contender::new("only counted, one thread", points, || run("1", None)),
        Contender::new("their bytes compressed, by zstd alone", points, || {
            for chunk in bytes.chunks(CHUNK_BYTES as usize) {
                black_box(compressor.compress(chunk)).expect("room for a chunk");
            }
        }),
        Contender::new("their bytes copied", points, || {
            copy.copy_from_slice(bytes);
            black_box(&copy);
        }),
    ]);
    println!("| points, 5 DoF | million points a second | of the recording's time |");
    println!("|---|---:|---:|");
    for t in &timings {
        println!("| {} | {:.1} | {:.2} |", t.name, 1e-6 / t.seconds, t.ratio);
    }
    println!(
        "{points} points of {stride} bytes, in the recording {:.2}; the program's whole time, counting \
         included. Compressing alone takes {:.0} % of it.",
        recorded as f64 / points as f64,
        100.0 * timings[4].ratio,
    );
}

/// How many points the header of a PLY file announces.
fn points(header: &[u8]) -> u64 {
    let header = std::str::from_utf8(header).expect("a header in UTF-8");
    let mut lines = header.lines();
    let number = lines.find_map(|line| line.strip_prefix("element vertex "));
    number.and_then(|number| number.parse().ok()).expect("a number of points")
}
