//! Records the points of a cubic grid that lie in a ball: a workspace that anyone can count.
//!
//! `cargo run -p opm-mcap --example ball -- OUT.mcap RADIUS_IN_CENTIMETRES`
//!
//! The slowest axis is x, with one slice for each value from -radius to +radius.

use std::path::Path;

use opm_mcap::{CloudLayout, Metadata, SliceAxis, Slices, Workspace, WorkspaceRecorder};

/// Grid spacing, in metres.
const SPACING: f64 = 0.01;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("expected the file to write")?;
    let radius: i64 = arguments.next().ok_or("expected a radius in centimetres")?.parse()?;

    let square = move |numbers: [i64; 3]| numbers.iter().map(|n| n * n).sum::<i64>();
    let inside = move |x: i64| {
        (-radius..=radius)
            .flat_map(move |y| (-radius..=radius).map(move |z| [x, y, z]))
            .filter(move |point| square(*point) <= radius * radius)
    };
    let row = move |point: [i64; 3]| {
        let [x, y, z] = point.map(|n| n as f64 * SPACING);
        [x, y, z, (square(point) as f64).sqrt() * SPACING]
    };

    let slices = (2 * radius + 1) as u64;
    let points = (-radius..=radius).flat_map(inside).count() as u64;
    let mut recorder = WorkspaceRecorder::create(
        Path::new(&path),
        &Workspace {
            layout: CloudLayout {
                axes: ["x", "y", "z"].map(String::from),
                scalars: vec!["distance".into()],
                color: "distance".into(),
                color_range: [0.0, radius as f64 * SPACING],
                frame_id: "base".into(),
                scale: [1.0; 3],
                units: ["m", "m", "rad"],
            },
            mechanism_name: "ball.toml",
            mechanism: b"name = \"ball\"\n",
            run: Metadata::from([("mechanism".into(), "ball".into())]),
            points,
            slices: Slices {
                axes: vec![SliceAxis {
                    name: "slice_x".into(),
                    unit: "m",
                    ends: [-(radius as f64), radius as f64].map(|n| n * SPACING),
                    count: slices,
                }],
                point_area: SPACING * SPACING,
            },
        },
    )?;
    let every = recorder.overview_every() as usize;
    for point in (-radius..=radius).flat_map(inside).step_by(every) {
        recorder.overview(&row(point))?;
    }
    for (slice, x) in (-radius..=radius).enumerate() {
        recorder.push(slice as u64, &inside(x).flat_map(row).collect::<Vec<_>>())?;
    }
    recorder.finish(&Metadata::from([("reachable".into(), points.to_string())]))?;
    Ok(())
}
