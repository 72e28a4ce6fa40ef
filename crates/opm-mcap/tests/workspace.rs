//! What is in a workspace recording.

mod common;

use common::{Seen, bare_layout, clouds, file, layout, record, recorded, row, rows, workspace};
use foxglove::Decode;
use foxglove::messages::{LinePrimitive, SceneUpdate};
use opm_mcap::workspace::{
    AXES_TOPIC, BOUNDARY_TOPIC, MAX_MESSAGE_POINTS, OVERVIEW_TOPIC, PART_STEP,
};
use opm_mcap::workspace::{LABEL_TOPIC, SLICE_STEP, SLICE_TOPIC, SLICES_TOPIC, START};
use opm_mcap::{ReadError, RecordError, WorkspaceRecorder};
use std::io::Cursor;

/// Ends of the viridis map as published (matplotlib's `_viridis_data`, first and last entry).
const VIRIDIS_ENDS: [[f64; 3]; 2] = [[68.0, 1.0, 84.0], [253.0, 231.0, 37.0]];
/// Smoothing between the table's entries moves a channel by no more than this.
const CHANNEL_TOLERANCE: f64 = 2.0;

/// Slices, some empty, at both ends too.
const COUNTS: [u64; 7] = [0, 5, 0, 0, 3, 7, 0];

fn column(range: std::ops::Range<u64>, index: usize) -> Vec<f64> {
    range.map(|i| f64::from(row(i)[index] as f32)).collect()
}

#[test]
fn everything_comes_back() {
    let directory = tempfile::tempdir().unwrap();
    let path = file(&directory, "w.mcap", &recorded(&COUNTS, 2));
    let (seen, recording) = clouds(&path).unwrap();

    assert!(recording.complete);
    assert_eq!(recording.time_range, Some([START, START + 2 * SLICE_STEP]));
    let topics: Vec<_> =
        (recording.topics.iter()).map(|t| (&*t.name, &*t.schema, t.messages, t.points)).collect();
    let schema = "foxglove.PointCloud";
    assert_eq!(
        topics,
        [
            (AXES_TOPIC, "foxglove.SceneUpdate", 1, None),
            (OVERVIEW_TOPIC, schema, 1, Some(15)),
            (LABEL_TOPIC, "foxglove.SceneUpdate", 3, None),
            (SLICE_TOPIC, "opm.Slice", 3, None),
            (SLICES_TOPIC, schema, 3, Some(15)),
        ]
    );
    let [attachment] = &recording.attachments[..] else { panic!("one attachment") };
    assert_eq!((&*attachment.name, &*attachment.media_type), ("test.toml", "application/toml"));
    assert_eq!(attachment.size, common::MECHANISM.len() as u64);

    let names: Vec<_> = recording.metadata.iter().map(|(name, _)| &**name).collect();
    assert_eq!(names, ["run", "clouds", "result"]);
    assert_eq!(recording.metadata("run").unwrap()["mode"], "++ ++ ++ +");
    assert_eq!(recording.metadata("result").unwrap()["complete"], "true");
    assert_eq!(recording.metadata("result").unwrap()["reachable"], "15");
    assert_eq!(recording.metadata("clouds").unwrap()["axes"], "x,y,xi");

    // The extents of the fields, by hand from the formulas of `row`.
    let extent = |name: &str| {
        let found = recording.extents.iter().find(|extent| extent.field == name).unwrap();
        [found.min, found.max]
    };
    assert_eq!(recording.extents.len(), 4, "x y z theta11, and no colours");
    assert_eq!(extent("x"), [0.0, f64::from(0.014_f32)]);
    assert_eq!(extent("y"), [f64::from(-0.028_f32), 0.0]);
    assert_eq!(extent("z"), [0.0, 7.0]);

    let [overview, slices @ ..] = &seen[..] else { panic!("no messages") };
    assert_eq!((&*overview.topic, overview.time, overview.len()), (OVERVIEW_TOPIC, START, 15));
    // Slices without points take no time.
    let mut first = 0;
    let numbered = (0..).zip(COUNTS).filter(|(_, count)| *count > 0);
    assert_eq!(slices.len(), 3);
    for ((written, slice), (number, count)) in (0..).zip(slices).zip(numbered) {
        assert_eq!(slice.slice, Some(number));
        assert_eq!(slice.time, START + written * SLICE_STEP);
        check_points(slice, first..first + count);
        first += count;
    }
    check_points(overview, 0..15);

    // What the slices are comes before their points, as numbers and in words.
    let (mut told, mut words, mut values) = (vec![], vec![], vec![]);
    opm_mcap::read::<ReadError>(&path, |message| {
        if message.topic == SLICE_TOPIC && message.values(&mut values)? {
            assert_eq!(message.flat.unwrap().names, ["slice", "xi", "count", "area"]);
            told.push((message.time, values.clone()));
        } else if message.topic == LABEL_TOPIC {
            let scene = SceneUpdate::decode(message.data).unwrap();
            words.push(scene.entities[0].texts[0].text.clone());
        }
        Ok(())
    })
    .unwrap();
    let expected = [(0, vec![1.0, 1.0, 5.0, 1.25]), (1, vec![4.0, 4.0, 3.0, 0.75])];
    let expected = expected.into_iter().chain([(2, vec![5.0, 5.0, 7.0, 1.75])]);
    let expected: Vec<_> = expected.map(|(i, row)| (START + i * SLICE_STEP, row)).collect();
    assert_eq!(told, expected);
    assert_eq!(words, ["xi = 1 rad: 5 points", "xi = 4 rad: 3 points", "xi = 5 rad: 7 points"]);
}

fn check_points(cloud: &Seen, range: std::ops::Range<u64>) {
    let fields: Vec<_> = cloud.columns.iter().map(|(name, _)| &**name).collect();
    assert_eq!(fields, ["x", "y", "z", "theta11", "red", "green", "blue", "alpha"]);
    for (index, field) in ["x", "y", "z", "theta11"].into_iter().enumerate() {
        assert_eq!(cloud.column(field), column(range.clone(), index), "{field}");
    }
    assert!(cloud.column("alpha").iter().all(|alpha| *alpha == 255.0));
}

#[test]
fn colours_follow_viridis_and_are_clamped() {
    let mut bytes = Vec::new();
    let values = [-9.0, -1.0, 0.0, 1.0, 9.0];
    let mut recorder =
        WorkspaceRecorder::new(Cursor::new(&mut bytes), &workspace(layout(), 5, 1)).unwrap();
    let rows: Vec<f64> = values.into_iter().flat_map(|s1| [0.0, 0.0, 0.0, 0.0, s1]).collect();
    recorder.overview(&rows).unwrap();
    recorder.push(0, &rows).unwrap();
    recorder.finish(&record([])).unwrap();

    let directory = tempfile::tempdir().unwrap();
    let (seen, _) = clouds(&file(&directory, "w.mcap", &bytes)).unwrap();
    let color = |i: usize| ["red", "green", "blue"].map(|channel| seen[1].column(channel)[i]);
    let close =
        |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= CHANNEL_TOLERANCE);
    assert!(close(color(1), VIRIDIS_ENDS[0]), "{:?}", color(1));
    assert!(close(color(3), VIRIDIS_ENDS[1]), "{:?}", color(3));
    assert_eq!(color(0), color(1), "below the range");
    assert_eq!(color(4), color(3), "above the range");
    assert!(!close(color(2), color(1)) && !close(color(2), color(3)));
}

#[test]
fn an_empty_workspace_is_a_whole_recording() {
    let directory = tempfile::tempdir().unwrap();
    for counts in [&[][..], &[0, 0, 0]] {
        let (seen, recording) = clouds(&file(&directory, "e.mcap", &recorded(counts, 1))).unwrap();
        assert!(recording.complete);
        assert_eq!(recording.topic(OVERVIEW_TOPIC).unwrap().points, Some(0));
        assert_eq!(recording.topic(OVERVIEW_TOPIC).unwrap().messages, 1);
        assert_eq!(recording.topic(SLICES_TOPIC).unwrap().messages, 0);
        assert_eq!(recording.extents, []);
        assert_eq!(seen[0].columns.len(), 8, "an empty cloud still tells its fields");
    }
}

#[test]
fn the_same_points_give_the_same_bytes() {
    // Enough that chunks are closed in between, however the points come.
    let counts = [20_000, 1, 0, 60_000, 30_000, 3, 90_000];
    let reference = recorded(&counts, 1 << 20);
    assert_eq!(reference, recorded(&counts, 1 << 20));
    for portion in [1, 7, 1000, 65_536] {
        assert!(reference == recorded(&counts, portion), "portions of {portion}");
    }
}

#[test]
fn a_big_slice_is_split_and_the_overview_is_decimated_evenly() {
    // One point more than a message holds, then exactly a message; three rows a push.
    let counts = [MAX_MESSAGE_POINTS + 1, MAX_MESSAGE_POINTS];
    let points = counts[0] + counts[1];
    // 8 000 001 points: every fifth makes 1 600 001, every fourth would make 2 000 001.
    let (every, kept) = (5, 1_600_001);
    let point = |i: u64| [i as f64 * 0.5, (i % 1000) as f64, 1.0];

    let mut bytes = Vec::new();
    let mut recorder =
        WorkspaceRecorder::new(Cursor::new(&mut bytes), &workspace(bare_layout(), points, 2))
            .unwrap();
    assert_eq!(recorder.overview_every(), every);
    let block =
        |numbers: &mut dyn Iterator<Item = u64>| numbers.flat_map(point).collect::<Vec<_>>();
    recorder.overview(&block(&mut (0..points).step_by(every as usize))).unwrap();
    recorder.push(0, &block(&mut (0..counts[0]))).unwrap();
    recorder.push(1, &block(&mut (counts[0]..points))).unwrap();
    recorder.finish(&record([])).unwrap();

    let directory = tempfile::tempdir().unwrap();
    let (seen, recording) = clouds(&file(&directory, "w.mcap", &bytes)).unwrap();
    let sizes: Vec<_> = seen.iter().map(|cloud| (cloud.slice, cloud.time, cloud.len())).collect();
    let full = MAX_MESSAGE_POINTS as usize;
    assert_eq!(
        sizes,
        [
            (None, START, kept),
            (Some(0), START, full),
            (Some(0), START + PART_STEP, 1),
            (Some(1), START + SLICE_STEP, full),
        ]
    );
    let declared = recording.metadata("clouds").unwrap();
    assert_eq!(declared["overview_every"], every.to_string());
    assert_eq!(declared["overview_points"], kept.to_string());
    assert_eq!(declared["overview_decimated"], "true");

    let all: Vec<f64> = seen[1..].iter().flat_map(|cloud| cloud.column("x")).copied().collect();
    assert!(all.iter().enumerate().all(|(i, x)| *x == f64::from((i as f64 * 0.5) as f32)));
    let every_fifth: Vec<f64> = all.iter().step_by(5).copied().collect();
    assert!(seen[0].column("x") == every_fifth);
}

#[test]
fn memory_is_bounded_for_wide_points_too() {
    let wide = |scalars: usize| {
        let scalars = (0..scalars).map(|i| format!("s{i}")).collect();
        WorkspaceRecorder::new(
            Cursor::new(&mut Vec::new()),
            &workspace(opm_mcap::CloudLayout { scalars, ..bare_layout() }, 1_000_000_000, 1),
        )
        .unwrap()
        .overview_every()
    };
    assert_eq!(wide(4), 500, "two million points of 32 bytes");
    // 60 scalars: 256 bytes a point, of which 128 MiB hold 524 288; 10^9 over that is 1907.3.
    assert_eq!(wide(60), 1908);
}

/// What a misuse answers, and that the recorder is finished with after it.
fn refused(misuse: impl FnOnce(&mut WorkspaceRecorder<'_>) -> RecordError) -> String {
    let mut bytes = Vec::new();
    let mut recorder =
        WorkspaceRecorder::new(Cursor::new(&mut bytes), &workspace(layout(), 4, 3)).unwrap();
    let error = misuse(&mut recorder).to_string();
    let after = recorder.push(2, &rows(0..1));
    assert!(after.is_err(), "{error}: went on");
    assert!(recorder.finish(&record([])).is_err(), "{error}: finished");
    assert!(!bytes.ends_with(mcap::MAGIC), "{error}: looks whole");
    error
}

#[test]
fn misuse_is_refused_and_final() {
    let bad = |value: f64| {
        let mut rows = rows(0..4);
        rows[13] = value;
        refused(move |recorder| recorder.overview(&rows).unwrap_err())
    };
    assert_eq!(bad(f64::NAN), "theta11 of point 2 is NaN, expected a finite float32");
    assert_eq!(bad(f64::INFINITY), "theta11 of point 2 is inf, expected a finite float32");
    assert!(bad(1e39).starts_with("theta11 of point 2 is 1000000000000000000"));

    let colour = refused(|recorder| {
        let mut rows = rows(0..4);
        rows[19] = f64::NAN;
        recorder.overview(&rows).unwrap_err()
    });
    assert_eq!(colour, "S1 of point 3 is NaN, expected a finite float32");

    let ragged = refused(|recorder| recorder.overview(&[0.0; 7]).unwrap_err());
    assert_eq!(ragged, "7 values are not a whole number of rows of 5");
    let few = refused(|recorder| recorder.push(0, &rows(0..1)).unwrap_err());
    assert_eq!(few, "overview: 0 points, expected 4");
    let many = refused(|recorder| recorder.overview(&rows(0..5)).unwrap_err());
    assert_eq!(many, "overview: 5 points, expected 4");

    let slice = |slice: u64| {
        refused(move |recorder| {
            recorder.overview(&rows(0..4)).unwrap();
            recorder.push(1, &rows(0..2)).unwrap();
            recorder.push(slice, &rows(2..4)).unwrap_err()
        })
    };
    assert_eq!(slice(0), "slice 0 is not in 1..3");
    assert_eq!(slice(3), "slice 3 is not in 1..3");
    let late = refused(|recorder| {
        recorder.overview(&rows(0..4)).unwrap();
        recorder.push(0, &rows(0..2)).unwrap();
        recorder.overview(&rows(0..1)).unwrap_err()
    });
    assert_eq!(late, "overview points after the first slice");

    let mut bytes = Vec::new();
    let mut recorder =
        WorkspaceRecorder::new(Cursor::new(&mut bytes), &workspace(layout(), 4, 3)).unwrap();
    recorder.overview(&rows(0..4)).unwrap();
    recorder.push(0, &rows(0..3)).unwrap();
    let missing = recorder.finish(&record([])).unwrap_err().to_string();
    assert_eq!(missing, "slices: 3 points, expected 4");
    assert!(!bytes.ends_with(mcap::MAGIC));
}

#[test]
fn layouts_that_contradict_themselves_are_refused() {
    let refusal = |change: fn(&mut opm_mcap::CloudLayout)| {
        let mut layout = layout();
        change(&mut layout);
        let mut bytes = Vec::new();
        let result = WorkspaceRecorder::new(Cursor::new(&mut bytes), &workspace(layout, 0, 0));
        result.err().map(|error| error.to_string()).unwrap_or_default()
    };
    assert_eq!(refusal(|_| ()), "");
    assert!(refusal(|l| l.scalars.push("theta11".into())).contains("theta11 is given twice"));
    assert!(refusal(|l| l.scalars.push("x".into())).contains("always there"));
    assert!(refusal(|l| l.scalars.push("red".into())).contains("always there"));
    assert!(refusal(|l| l.scalars.push(String::new())).contains("no name"));
    assert!(refusal(|l| l.frame_id.clear()).contains("frame"));
    assert!(refusal(|l| l.color_range = [1.0, 0.0]).contains("1 to 0"));
    assert!(refusal(|l| l.color_range = [0.0, f64::NAN]).contains("0 to NaN"));
    assert_eq!(refusal(|l| l.color_range = [1.0, 1.0]), "");
}

#[test]
fn slices_are_limited() {
    let mut bytes = Vec::new();
    let result = WorkspaceRecorder::new(Cursor::new(&mut bytes), &workspace(layout(), 0, u64::MAX));
    assert!(matches!(result, Err(RecordError::TooManySlices { .. })));
}

/// Boundaries come with the slices that have points, and the last stays in view.
#[test]
fn boundaries_are_shown_from_their_slices_on() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bounded.mcap");
    let square = |side: f64| vec![[0.0, 0.0, 1.0], [side, 0.0, 1.0], [side, side, 1.0]];
    let lines = vec![(0, vec![square(1.0)]), (2, vec![square(2.0), square(3.0)]), (3, vec![])];
    let mut recorder = WorkspaceRecorder::create(&path, &workspace(layout(), 4, 5)).unwrap();
    recorder.boundary(lines.clone()).unwrap();
    recorder.overview(&rows(0..4)).unwrap();
    recorder.push(1, &rows(0..1)).unwrap();
    recorder.push(2, &rows(1..3)).unwrap();
    recorder.push(4, &rows(3..4)).unwrap();
    recorder.finish(&record([])).unwrap();
    let mut seen: Vec<(u64, Vec<opm_mcap::ClosedLine>)> = vec![];
    opm_mcap::read::<ReadError>(&path, |message| {
        if message.topic == BOUNDARY_TOPIC {
            let scene = SceneUpdate::decode(message.data).unwrap();
            let [entity] = &scene.entities[..] else { panic!("{scene:?}") };
            assert_eq!((&*entity.id, &*entity.frame_id), ("boundary", "base"));
            let line = |line: &LinePrimitive| -> Vec<[f64; 3]> {
                line.points.iter().map(|p| [p.x, p.y, p.z]).collect()
            };
            let written = (message.time - START) / SLICE_STEP;
            seen.push((written, entity.lines.iter().map(line).collect()));
        }
        Ok(())
    })
    .unwrap();
    let expected: Vec<_> = (0..).zip(lines).map(|(written, (_, rings))| (written, rings)).collect();
    assert_eq!(seen, expected);

    for wrong in [vec![(1, vec![]), (1, vec![])], vec![(5, vec![])], vec![(2, vec![]), (0, vec![])]]
    {
        let mut bytes = Vec::new();
        let sink = Cursor::new(&mut bytes);
        let mut recorder = WorkspaceRecorder::new(sink, &workspace(layout(), 0, 5)).unwrap();
        assert!(matches!(recorder.boundary(wrong), Err(RecordError::Slice { .. })));
    }
}

/// An axis in radians is drawn at a fifth; the box round the points says what the values are. Beside slices, the overview
/// is nearer to grey than they are.
#[test]
fn a_box_tells_the_values_of_scaled_axes() {
    let directory = tempfile::tempdir().unwrap();
    let layout = opm_mcap::CloudLayout {
        scale: [1.0, 1.0, 0.2],
        color: "x".into(),
        color_range: [-0.1, 0.3],
        scalars: vec!["theta11".into()],
        ..layout()
    };
    let path = directory.path().join("w.mcap");
    let mut recorder = WorkspaceRecorder::create(&path, &workspace(layout, 2, 2)).unwrap();
    let rows = [[-0.1, 0.0, -1.5, 7.0], [0.3, 0.2, 1.25, 8.0]];
    recorder.overview(&rows.concat()).unwrap();
    recorder.push(0, &rows[0]).unwrap();
    recorder.push(1, &rows[1]).unwrap();
    recorder.finish(&record([])).unwrap();
    let (mut at, mut colors, mut scenes) = (vec![], vec![], vec![]);
    let recording = opm_mcap::read(&path, |message| -> Result<(), ReadError> {
        if let Some(cloud) = message.cloud()? {
            let column = |name: &str| cloud.column(name).unwrap().collect::<Vec<_>>();
            at.push((column("z"), column("theta11")));
            colors.push(["red", "green", "blue"].map(|name| column(name)[0]));
        } else if message.topic == AXES_TOPIC {
            scenes.push(SceneUpdate::decode(message.data).unwrap());
        }
        Ok(())
    })
    .unwrap();
    let single = |value: f64| f64::from(value as f32);
    assert_eq!(at[0], ([-1.5 * 0.2, 1.25 * 0.2].map(single).to_vec(), vec![7.0, 8.0]));
    assert_eq!(recording.metadata("clouds").unwrap()["scale"], "1,1,0.2");
    let spread = |color: &[f64; 3]| {
        color.iter().copied().fold(f64::MIN, f64::max)
            - color.iter().copied().fold(f64::MAX, f64::min)
    };
    assert!(spread(&colors[0]) < 0.6 * spread(&colors[1]), "{colors:?}");
    let [scene] = &scenes[..] else { panic!("{scenes:?}") };
    let entity = &scene.entities[0];
    let texts: Vec<&str> = entity.texts.iter().map(|text| &*text.text).collect();
    let expected =
        ["x = -0.1 m", "x = 0.3 m", "y = 0 m", "y = 0.2 m", "xi = -1.5 rad", "xi = 1.25 rad"];
    assert_eq!(texts, expected);
    assert_eq!(entity.lines[0].points.len(), 24, "twelve edges");
    for (i, point) in entity.lines[0].points.iter().enumerate() {
        let is_near = |value: f64, ends: [f64; 2]| ends.iter().any(|e| (e - value).abs() < 1e-6);
        assert!(is_near(point.x, [-0.1, 0.3]) && is_near(point.y, [0.0, 0.2]), "{i}");
        assert!(is_near(point.z, [-0.3, 0.25]), "{i}");
    }
}
