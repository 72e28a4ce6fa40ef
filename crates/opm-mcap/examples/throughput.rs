//! Records synthetic points as a sweep would stream them, and says how fast and in how much memory.
//!
//! `cargo run --release -p opm-mcap --example throughput -- OUT.mcap [MILLION_POINTS]`

use std::path::Path;
use std::time::Instant;

use opm_mcap::{CloudLayout, Metadata, Workspace, WorkspaceRecorder};

/// Points along the fastest axis and the next.
const ROW: u64 = 128;
const PLANE: u64 = ROW * ROW;
/// Points of a slice: more than one message holds.
const SLICE: u64 = PLANE * 275;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("expected the file to write")?;
    let millions: u64 = arguments.next().map_or(Ok(20), |text| text.parse())?;
    let points = (millions * 1_000_000).next_multiple_of(PLANE);

    let layout = CloudLayout {
        axes: ["x", "y", "xi"].map(String::from),
        scalars: ["theta11", "theta12", "S1"].map(String::from).to_vec(),
        color: "xi".into(),
        color_range: [0.0, 2.0],
        frame_id: "base".into(),
    };
    let workspace = Workspace {
        layout,
        mechanism_name: "synthetic.toml",
        mechanism: b"format = 1\n",
        run: Metadata::new(),
        points,
        slices: points.div_ceil(SLICE),
    };
    let started = Instant::now();
    let mut recorder = WorkspaceRecorder::create(Path::new(&path), &workspace)?;
    let every = recorder.overview_every();
    let mut rows = Vec::new();
    for number in (0..points).step_by(every as usize) {
        rows.extend(Plane::new(number / PLANE).point(number));
        if rows.len() >= 6 * 4096 {
            recorder.overview(&rows)?;
            rows.clear();
        }
    }
    recorder.overview(&rows)?;
    for plane in 0..points / PLANE {
        rows.clear();
        let shared = Plane::new(plane);
        (0..PLANE).for_each(|i| rows.extend_from_slice(&shared.point(i)));
        recorder.push(plane * PLANE / SLICE, &rows)?;
    }
    recorder.finish(&Metadata::new())?;

    let seconds = started.elapsed().as_secs_f64();
    let size = std::fs::metadata(&path)?.len();
    println!(
        "{points} points in {seconds:.2} s: {:.1} M points/s, {:.2} bytes a point",
        points as f64 * 1e-6 / seconds,
        size as f64 / points as f64
    );
    if let Ok(status) = std::fs::read_to_string("/proc/self/status") {
        println!("{}", status.lines().find(|line| line.starts_with("VmHWM")).unwrap_or_default());
    }
    Ok(())
}

/// Everything that a plane's points share: an orientation and its two imaginary joints.
struct Plane([f64; 3]);

impl Plane {
    fn new(number: u64) -> Self {
        let orientation = number as f64;
        Self([(orientation * 0.001) % 2.0, (orientation * 0.7).sin(), (orientation * 0.3).cos()])
    }

    /// A point: x and y on a grid, and a slider.
    fn point(&self, number: u64) -> [f64; 6] {
        let Self([xi, theta1, theta2]) = *self;
        let x = (number % ROW) as f64 * 0.003 - 0.2;
        let y = (number % PLANE / ROW) as f64 * 0.003 - 0.2;
        let root = (0.04 - (0.1 * x - 0.05 * y + 0.02 * theta1).powi(2)).sqrt();
        [x, y, xi, theta1, theta2, 0.3 * x + 0.9 * y + root]
    }
}
