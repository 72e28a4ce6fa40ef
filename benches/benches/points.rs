//! Points of a sweep, recorded by the program, against what compressing and copying the same bytes takes: a large grid,
//! then for each shipped mechanism the grid that is fitted to it and a denser one.

use opm_benches::{Contender, Timing, compare, denser, program};
use opm_core::mechanism::examples::EXAMPLES;
use opm_mcap::workspace::{CHUNK_BYTES, OVERVIEW_TOPIC, SLICES_TOPIC};
use opm_mcap::{COMPRESSION_LEVEL, ReadError, read};
use opm_workspace::Axis;
use serde_json::Value;
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
    large(&mcap, &ply);
    println!();
    shipped(&mcap);
}

/// The least number of points of a denser grid: of fewer, the start of the program and the overview, which has all of them
/// once more, take a large part of the time.
const MANY: u64 = 10_000_000;

/// A run of the program.
struct Run<'a> {
    mechanism: &'a str,
    grid: &'a [String],
}

impl Run<'_> {
    fn command(&self, threads: &str) -> Command {
        let mut command = program();
        command.args(["workspace", self.mechanism, "--threads", threads, "--quiet"]);
        command.args(self.grid.iter().flat_map(|axis| ["--grid", axis]));
        command
    }

    fn perform(&self, threads: &str, output: Option<&str>) {
        let mut command = self.command(threads);
        command.args(output.iter().flat_map(|output| ["-o", output]));
        let status = command.stdout(Stdio::null()).status();
        assert!(status.expect("the program starts").success());
    }

    /// What the program answers: the grid, fitted if there is none, and how many of its poses are in reach.
    fn answer(&self) -> Option<(Vec<Axis>, u64)> {
        let output = self.command("1").args(["--format", "json"]).output().expect("it starts");
        let answer: Value = serde_json::from_slice(&output.stdout).ok()?;
        let axis = |(name, axis): (&String, &Value)| {
            let [min, max] = ["min", "max"].map(|end| axis[end].as_f64());
            Some(Axis::new(name.clone(), min?, max?, axis["count"].as_u64()?))
        };
        let axes = answer["grid"].as_object()?.iter().map(axis).collect::<Option<_>>()?;
        Some((axes, answer["reachable"].as_u64()?))
    }
}

/// The flags for a grid.
fn flags(axes: &[Axis]) -> Vec<String> {
    let flag = |Axis { name, min, max, count }: &Axis| format!("{name}={min}:{max}:{count}");
    axes.iter().map(flag).collect()
}

/// What is in a recording: an overview, then all points.
struct Content {
    points: u64,
    overview: u64,
    bytes: Vec<u8>,
}

impl Content {
    fn of(mcap: &str) -> Self {
        let mut bytes = Vec::new();
        let recording = read(Path::new(mcap), |message| {
            bytes.extend_from_slice(message.data);
            Ok::<(), ReadError>(())
        });
        let recording = recording.expect("what was written");
        let [points, overview] = [SLICES_TOPIC, OVERVIEW_TOPIC]
            .map(|topic| recording.topic(topic).and_then(|topic| topic.points).expect("points"));
        Self { points, overview, bytes }
    }

    fn compressed(&self) -> impl FnMut() + '_ {
        let mut compressor = Compressor::new(COMPRESSION_LEVEL as i32).expect("a level of zstd");
        move || {
            for chunk in self.bytes.chunks(CHUNK_BYTES as usize) {
                black_box(compressor.compress(chunk)).expect("room for a chunk");
            }
        }
    }
}

fn large(mcap: &str, ply: &str) {
    let grid = GRID.map(str::to_owned);
    let run = Run { mechanism: MECHANISM, grid: &grid };
    run.perform("2", Some(mcap));
    let content = Content::of(mcap);
    let Content { points, overview, ref bytes } = content;
    let stride = bytes.len() as u64 / (points + overview);
    let recorded = fs::metadata(mcap).expect("what was written").len();
    let mut copy = vec![0; bytes.len()];
    let timings = compare(vec![
        Contender::new("recorded, one thread", points, || run.perform("1", Some(mcap))),
        Contender::new("recorded, two threads", points, || run.perform("2", Some(mcap))),
        Contender::new("as PLY, not compressed, every coordinate, one thread", points, || {
            run.perform("1", Some(ply));
        }),
        Contender::new("only counted, one thread", points, || run.perform("1", None)),
        Contender::new("its bytes compressed, by zstd alone", points, content.compressed()),
        Contender::new("its bytes copied", points, || {
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
        "{points} points of {stride} bytes, in the recording {:.2}, the {overview} of its overview among \
         them; the program's whole time, counting included. Compressing alone takes {:.0} % of it.",
        recorded as f64 / points as f64,
        100.0 * timings[4].ratio,
    );
}

/// Every shipped mechanism that has a workspace, on the grid that is fitted to it and on a denser one.
fn shipped(mcap: &str) {
    println!(
        "| points, one thread | fitted grid | million points a second | compressed by zstd alone, of its time | \
         denser grid | million points a second | only counted, of its time | compressed by zstd alone, of its time |"
    );
    println!("|---|---:|---:|---:|---:|---:|---:|---:|");
    for mechanism in EXAMPLES.iter().map(|example| example.name) {
        let Some((fitted, _)) = (Run { mechanism, grid: &[] }).answer() else { continue };
        let (few, [of_few, _, compressed_few]) =
            recorded(mcap, &Run { mechanism, grid: &flags(&fitted) });
        let denser = denser(&fitted, |axes| {
            let answer = Run { mechanism, grid: &flags(axes) }.answer();
            answer.expect("as of the fitted grid").1 >= MANY
        });
        let grid = flags(&denser);
        let (many, [of_many, counted, compressed]) =
            recorded(mcap, &Run { mechanism, grid: &grid });
        println!(
            "| {mechanism} | {few} | {:.1} | {:.2} | {many} | {:.1} | {:.2} | {:.2} |",
            1e-6 / of_few.seconds,
            compressed_few.ratio,
            1e-6 / of_many.seconds,
            counted.ratio,
            compressed.ratio
        );
    }
}

/// The number of points, and the times to record them, to count them alone, and to compress their bytes alone.
fn recorded(mcap: &str, run: &Run<'_>) -> (u64, [Timing; 3]) {
    run.perform("2", Some(mcap));
    let content = Content::of(mcap);
    let points = content.points;
    let timings = compare(vec![
        Contender::new("recorded", points, || run.perform("1", Some(mcap))),
        Contender::new("counted", points, || run.perform("1", None)),
        Contender::new("compressed", points, content.compressed()),
    ]);
    (points, timings.try_into().expect("three timings"))
}
