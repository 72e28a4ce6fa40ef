//! `opm workspace --kind`: sets other than that of poses, their boundaries and components.

use crate::run::{Folder, number, opm};
use crate::{HELICAL, PLANO};
use foxglove::Decode;
use foxglove::messages::SceneUpdate;
use opm_mcap::workspace::{BOUNDARY_TOPIC, SLICE_STEP, SLICES_TOPIC, START};
use opm_mcap::{ReadError, read};
use serde_json::Value;
use std::collections::BTreeMap;

fn workspace(args: &[&str]) -> Value {
    opm(&[&["workspace"], args, &["--format", "json", "--quiet"]].concat()).json()
}

/// Areas inside the boundary, slice by slice.
fn areas(found: &Value) -> Vec<f64> {
    let slices = found["boundary"]["slices"].as_array().unwrap();
    slices.iter().map(|slice| number(&slice["area"])).collect()
}

/// Twice the area inside closed lines, from their points alone.
fn shoelace(rings: &Value) -> f64 {
    let mut sum = 0.0;
    for ring in rings.as_array().unwrap() {
        let points: Vec<[f64; 2]> = serde_json::from_value(ring.clone()).unwrap();
        let next = points.iter().cycle().skip(1);
        sum += points.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>();
    }
    sum
}

/// A grid of places and orientations that are reached in part.
const GRID: [&str; 6] = [
    "--grid=x=-250mm:250mm:26",
    "--grid=y=-200mm:200mm:21",
    "--grid=xi=-30deg:30deg:7",
    "--grid=zeta=0:1:3",
    "--grid=psi=0.1",
    "--mode=any",
];

#[test]
fn reachable_and_dexterous_places_are_those_of_the_poses() {
    let folder = Folder::new();
    let cloud = folder.arg("poses.mcap");
    opm(&[&["workspace", PLANO, "-o", &cloud, "--quiet"], &GRID[..]].concat()).text();
    // The number of poses that the recording has at each place.
    let mut visits: BTreeMap<[u32; 2], u64> = BTreeMap::new();
    read::<ReadError>(cloud.as_ref(), |message| {
        if message.topic == SLICES_TOPIC {
            let cloud = message.cloud()?.unwrap();
            let (x, y) = (cloud.column("x").unwrap(), cloud.column("y").unwrap());
            for (x, y) in x.zip(y) {
                *visits.entry([x, y].map(|value| (value as f32).to_bits())).or_default() += 1;
            }
        }
        Ok(())
    })
    .unwrap();
    let orientations = 21;
    for (kind, least) in [("reachable", 1), ("dexterous", orientations)] {
        let places = folder.arg("places.mcap");
        let run = [&[PLANO, "--kind", kind, "-o", &places], &GRID[..]].concat();
        let found = workspace(&run);
        let expected = visits.values().filter(|&&n| n >= least).count();
        assert!(expected > 0 && expected < 26 * 21, "{kind}: {expected}, a poor test");
        assert_eq!(found["kind"], kind);
        assert_eq!(found["orientations"], orientations);
        assert_eq!(found["poses"], 26 * 21);
        assert_eq!(found["reachable"], expected);
        let sizes: Vec<u64> = serde_json::from_value(found["components"]["sizes"].clone()).unwrap();
        assert_eq!(sizes.iter().sum::<u64>() as usize, expected);
        let [area] = areas(&found)[..] else { panic!("{:?}", found["boundary"]) };
        let rings = &found["boundary"]["slices"][0]["rings"];
        assert!((2.0 * area - shoelace(rings)).abs() < 1e-12, "{area}");
        // The lines enclose a share of the box, which is one step narrower than the number of values.
        assert!((area / number(&found["measure"]["value"]) - 1.0).abs() < 0.15, "{area}");

        let mut seen = 0;
        read::<ReadError>(places.as_ref(), |message| {
            if message.topic == SLICES_TOPIC {
                let cloud = message.cloud()?.unwrap();
                let column = |name| cloud.column(name).unwrap();
                for ((x, y), share) in column("x").zip(column("y")).zip(column("share")) {
                    let found = visits[&[x, y].map(|value| (value as f32).to_bits())];
                    assert!((share - found as f64 / orientations as f64).abs() < 1e-6);
                    seen += 1;
                }
            }
            Ok(())
        })
        .unwrap();
        assert_eq!(seen, expected);
    }
}

/// The lines of the recording are those of the JSON output, and a picture is made of them.
#[test]
fn boundaries_are_recorded_with_their_slices() {
    let folder = Folder::new();
    let cloud = folder.arg("cloud.mcap");
    let axes = ["--grid=x=-400mm:400mm:81", "--grid=y=-400mm:400mm:81", "--grid=phi=-2:2:5"];
    let run = [&[HELICAL, "--shape", "--axes", "phi,y,x", "-o", &cloud], &axes[..]].concat();
    let found = workspace(&run);
    let slices = found["boundary"]["slices"].as_array().unwrap();
    assert_eq!(slices.len(), 5);
    assert_eq!(found["boundary"]["axes"], serde_json::json!(["x", "y"]));
    let mut lines = vec![];
    read::<ReadError>(cloud.as_ref(), |message| {
        if message.topic == BOUNDARY_TOPIC {
            let scene = SceneUpdate::decode(message.data).unwrap();
            assert_eq!(scene.entities.len(), 1);
            lines.push((message.time, scene.entities[0].lines.clone()));
        }
        Ok(())
    })
    .unwrap();
    assert_eq!(lines.len(), 5);
    for (number, ((time, lines), slice)) in lines.iter().zip(slices).enumerate() {
        let written = (*time - START) / SLICE_STEP;
        assert_eq!(written, number as u64);
        let rings: Vec<Vec<[f64; 2]>> = serde_json::from_value(slice["rings"].clone()).unwrap();
        assert_eq!(lines.len(), rings.len());
        for (line, ring) in lines.iter().zip(&rings) {
            let at = slice["at"]["phi"].as_f64().unwrap();
            // The box is 4 rad long and 0.8 m wide: a metre is drawn as five.
            let expected: Vec<_> = ring.iter().map(|&[x, y]| [at, 5.0 * y, 5.0 * x]).collect();
            let found: Vec<[f64; 3]> = line.points.iter().map(|p| [p.x, p.y, p.z]).collect();
            // JSON numbers may be rounded when read.
            let near = |(a, b): (&[f64; 3], &[f64; 3])| (0..3).all(|i| (a[i] - b[i]).abs() < 1e-12);
            assert!(found.len() == expected.len() && found.iter().zip(&expected).all(near));
        }
    }
    let picture = folder.arg("cloud.svg");
    opm(&["plot", &cloud, "-o", &picture, "--quiet"]).text();
    let svg = std::fs::read_to_string(picture).unwrap();
    assert!(svg.contains("The line is the boundary"), "{svg:.300}");
}

#[test]
fn sections_alone_are_counted_recorded_and_drawn() {
    let folder = Folder::new();
    let cloud = folder.arg("set.mcap");
    let upper = ["--grid=zeta=-1:1:9", "--grid=xi=0:180deg:13", "--grid=psi=-1:1:7"];
    let lower = ["--grid=x=-0.3:0.3:31", "--grid=y=-0.3:0.3:31", "--grid=theta11=-0.7:0.9:5"];
    for (kind, axes, poses) in
        [("upper", upper, 9 * 13 * 7), ("lower", lower, 31 * 31 * 5), ("imaginary", upper, 819)]
    {
        let found = workspace(&[&[PLANO, "--kind", kind, "-o", &cloud], &axes[..]].concat());
        assert_eq!(found["kind"], kind);
        assert_eq!(found["poses"], poses, "{kind}");
        let reachable = found["reachable"].as_u64().unwrap();
        assert!(reachable > 0 && reachable < poses, "{kind}: {reachable}");
        assert_eq!(found["boundary"].is_null(), kind == "imaginary");
        let mut points = 0;
        read::<ReadError>(cloud.as_ref(), |message| {
            if message.topic == SLICES_TOPIC {
                points += message.cloud()?.unwrap().len() as u64;
            }
            Ok(())
        })
        .unwrap();
        assert_eq!(points, reachable, "{kind}");
        let picture = folder.arg(&format!("{kind}.svg"));
        opm(&["plot", &cloud, "-o", &picture, "--quiet"]).text();
    }
}

/// The counted points have the name of their kind: only three kinds have poses.
#[test]
fn pictures_say_what_they_count() {
    let folder = Folder::new();
    let [cloud, picture] = ["set.mcap", "set.svg"].map(|name| folder.arg(name));
    let places = ["--grid=x=-0.3:0.3:31", "--grid=y=-0.3:0.3:31", "--grid=xi=0:1:3"];
    let tilts = ["--grid=xi=0:1:21", "--grid=psi=-1:1:21"];
    let joints = ["--scalars", "theta11,theta12"];
    let title = "Joint values in";
    for (kind, flags, expected) in [
        (
            "imaginary",
            &[][..],
            [&*format!("{title} reachable orientations: theta11"), "orientations in one place"],
        ),
        (
            "upper",
            &[&tilts[..], &joints].concat(),
            [&*format!("{title} closing orientations: theta11"), " orientations that it covers"],
        ),
        ("reachable", &places, ["Values in reachable places: share", "places over share"]),
        ("dexterous", &places, ["Values in dexterous places: share", "places over share"]),
        (
            "grid",
            &[&places[..], &joints].concat(),
            [&*format!("{title} reachable poses: theta11"), " poses that it covers"],
        ),
    ] {
        opm(&[&["workspace", PLANO, "-q", "--kind", kind, "-o", &cloud], flags].concat()).text();
        let values = if places == flags { &["--values", "share"][..] } else { &[] };
        opm(&[&["plot", &cloud, "-o", &picture, "-q"], values].concat()).text();
        let svg = std::fs::read_to_string(&picture).unwrap();
        for word in expected {
            assert!(svg.contains(word), "{kind}: {word}");
        }
        assert_eq!(svg.contains("poses"), kind == "grid", "{kind}");
    }
    let far = ["workspace", PLANO, "-q", "--kind", "dexterous", "-o", &cloud, "--grid=x=1:2:3"];
    opm(&far).text();
    opm(&["plot", &cloud, "-o", &picture]).fails_with_one_line(1, &["nothing to draw: no place"]);
}

#[test]
fn what_a_kind_cannot_do_is_refused() {
    let cases: [(&[&str], &[&str]); 10] = [
        (
            &["--kind", "constant-orientation", "--grid", "xi=0:1:3"],
            &["--grid", "xi has 3 values", "the orientation's coordinates", "xi=VALUE"],
        ),
        (&["--kind", "orientation", "--grid", "x=0:1:3"], &["--grid", "x has 3 values"]),
        (&["--kind", "upper", "--grid", "x=0:1:3"], &["--grid", "upper section", "zeta, xi, psi"]),
        (&["--kind", "lower", "--grid", "xi=1"], &["--grid", "imaginary joint", "theta11"]),
        (&["--kind", "lower", "--max-condition", "9"], &["--max-condition", "--kind lower"]),
        (&["--kind", "reachable", "--conditioning"], &["--conditioning", "--kind reachable"]),
        (&["--kind", "imaginary", "--mode", "any"], &["--mode", "--kind imaginary"]),
        (&["--kind", "upper", "--length", "1"], &["--length", "nothing uses it"]),
        (&["--kind", "dexterous", "-o", "a.mcap", "--color", "S1"], &["--color", "S1", "share"]),
        (&["--kind", "upper", "-o", "a.mcap", "--axes", "tip"], &["--axes", "tip"]),
    ];
    for (args, words) in cases {
        opm(&[&["workspace", PLANO], args].concat()).fails_with_one_line(2, words);
    }
}

/// The global conditioning index is the mean of the values stored with the points.
#[test]
fn the_global_index_is_the_mean_of_the_recorded_ones() {
    let folder = Folder::new();
    let cloud = folder.arg("cloud.mcap");
    for more in [&["--mode", "home"][..], &["--mode", "any", "--max-condition", "30"]] {
        let flags = [
            PLANO,
            "--kind",
            "constant-orientation",
            "--grid=x=-0.2:0.2:21",
            "--grid=y=-0.2:0.2:21",
            "--grid=xi=20deg",
            "--conditioning",
            "--length=80mm",
            "--scalars=inverse_condition",
            "--color=inverse_condition",
            "-o",
            &cloud,
        ];
        let found = workspace(&[&flags[..], more].concat());
        let mut all: Vec<f64> = vec![];
        read::<ReadError>(cloud.as_ref(), |message| {
            if message.topic == SLICES_TOPIC {
                all.extend(message.cloud()?.unwrap().column("inverse_condition").unwrap());
            }
            Ok(())
        })
        .unwrap();
        assert_eq!(found["reachable"], all.len());
        assert!(all.len() > 30);
        let index = &found["conditioning"];
        let mean = all.iter().sum::<f64>() / all.len() as f64;
        assert!((number(&index["global"]) - mean).abs() < 1e-6, "{index} {mean}");
        assert!((number(&index["characteristic_length"]) - 0.08).abs() < 1e-15);
        let least = all.iter().copied().fold(f64::MAX, f64::min);
        assert!((number(&index["local_min"]) - least).abs() < 1e-6);
    }
}

/// Varying coordinates are the axes of the cloud. A single orientation, that of home, gives a warning.
#[test]
fn what_varies_is_seen() {
    let folder = Folder::new();
    let [cloud, picture] = ["o.mcap", "o.svg"].map(|name| folder.arg(name));
    let grid = ["--grid=zeta=-1:1:9", "--grid=xi=0:120deg:13", "--grid=psi=-1:1:3"];
    let orientation = ["workspace", PLANO, "-q", "--kind", "orientation", "-o", &cloud];
    opm(&[&orientation[..], &grid].concat()).text();
    let said = opm(&["inspect", &cloud, "--format", "json"]).json().to_string();
    assert!(said.contains("zeta,xi,psi"), "{said}");
    opm(&["plot", &cloud, "-o", &picture, "-q"]).text();
    let svg = std::fs::read_to_string(&picture).unwrap();
    for word in ["xi (deg)", "zeta (deg)", "The line is the boundary"] {
        assert!(svg.contains(word), "{word}");
    }
    assert!(!svg.contains("at one value or more"));

    let run = opm(&["workspace", PLANO, "--kind", "reachable", "--grid=x=0:0.1:5"]);
    run.text();
    assert!(run.stderr.contains("only one orientation") && run.stderr.contains("--grid xi="));
    let run =
        opm(&["workspace", PLANO, "--kind", "reachable", "--grid=x=0:0.1:5", "--grid=xi=0:1:2"]);
    run.text();
    assert!(!run.stderr.contains("only one orientation"), "{}", run.stderr);
}

/// A set of one coordinate is a bar along its axis: the other has neither name nor numbers.
#[test]
fn a_set_of_one_coordinate_is_a_bar() {
    let folder = Folder::new();
    let [cloud, picture] = ["o.mcap", "o.svg"].map(|name| folder.arg(name));
    for kind in ["upper", "orientation"] {
        let grid = ["--grid=phi=-1:1:41", "-o", &cloud, "-q"];
        opm(&[&["workspace", HELICAL, "--kind", kind], &grid[..]].concat()).text();
        opm(&["plot", &cloud, "-o", &picture, "-q"]).text();
        let svg = std::fs::read_to_string(&picture).unwrap();
        assert!(svg.contains("phi (deg)") && svg.contains("x-axis"), "{kind}");
        assert!(!svg.contains("y-axis") && !svg.contains("x (mm)"), "{kind}");
    }
}

/// A cross marks home. A slice at other values has none, nor has a joint without an axis in the picture.
#[test]
fn only_a_slice_at_home_has_a_cross() {
    let folder = Folder::new();
    let [cloud, picture] = ["c.mcap", "c.svg"].map(|name| folder.arg(name));
    let places = ["--grid=x=-0.2:0.2:21", "--grid=y=-0.2:0.2:21"];
    for (kind, more, expected) in [
        ("lower", &[][..], true),
        ("lower", &["--grid=theta11=0.15:0.16:3"], true),
        ("lower", &["--grid=theta12=2.9"], false),
        ("lower", &["--grid=theta13=2.9", "--grid=theta11=0.15:0.16:3"], false),
        ("lower", &["--grid=theta11=0.5:1:3"], false),
        ("grid", &["--grid=xi=0.3"], false),
        ("grid", &["--grid=xi=0:0.3:4"], true),
    ] {
        let args = ["workspace", PLANO, "-q", "--kind", kind, "-o", &cloud];
        opm(&[&args[..], &places, more].concat()).text();
        opm(&["plot", &cloud, "-o", &picture, "-q"]).text();
        let svg = std::fs::read_to_string(&picture).unwrap();
        assert_eq!(svg.contains("The cross is home"), expected, "{kind} {more:?}");
    }
}

/// Over large ranges of angles no place is dexterous: the flags of the hint ask for what is.
#[test]
fn an_empty_dexterous_workspace_says_how_to_ask_for_fewer_orientations() {
    let places = ["--grid=x=-0.1:0.1:11", "--grid=y=-0.1:0.1:11"];
    let tilts = ["--grid=zeta=-3:3:9", "--grid=xi=0:3:7"];
    let dexterous = ["workspace", PLANO, "--kind", "dexterous"];
    let run = opm(&[&dexterous[..], &places, &tilts].concat());
    run.text();
    let hint = "these are 63 orientations; ask for fewer, for example \
                --grid zeta=-20deg:20deg:5 --grid xi=0deg:20deg:5\n";
    assert!(run.stderr.contains(hint), "{}", run.stderr);
    let tilts: Vec<&str> = hint.split_whitespace().filter(|word| word.contains('=')).collect();
    let tilts: Vec<String> = tilts.iter().map(|flag| format!("--grid={flag}")).collect();
    let tilts: Vec<&str> = tilts.iter().map(|flag| &**flag).collect();
    let found = workspace(&[&dexterous[1..], &places, &tilts].concat());
    assert!(found["reachable"].as_u64() > Some(0) && found["orientations"] == 25, "{found}");

    let one = opm(&[&dexterous[..], &["--grid=x=1:2:3"]].concat());
    one.text();
    assert!(one.stderr.contains("no place") && !one.stderr.contains("fewer"), "{}", one.stderr);
}

/// Which coordinates are the place, and what a mechanism in one subspace does not have.
#[test]
fn kinds_of_one_subspace_work_or_say_why_not() {
    let grid = ["--grid=x=-0.1:0.1:11", "--grid=y=-0.1:0.1:11", "--grid=theta=-10deg:10deg:5"];
    let found = workspace(&[&["planar-3rrr", "--kind", "dexterous"][..], &grid].concat());
    assert!(found["reachable"].as_u64() > Some(0) && found["poses"] == 121, "{found}");
    assert_eq!(found["orientations"], 5);
    let refused = |mechanism: &str, kind: &str, message: &str| {
        opm(&["workspace", mechanism, "--kind", kind]).fails_with_one_line(2, &["--kind", message]);
    };
    for kind in ["dexterous", "reachable", "constant-orientation"] {
        refused("agile-eye", kind, "zeta, xi, psi, have no place among them; use grid");
    }
    for (kind, what) in [("imaginary", "no imaginary joints"), ("upper", "no upper section")] {
        let message = format!("all legs of this mechanism move in one subspace, so it has {what}");
        refused("planar-3rrr", kind, &message);
    }
    for kind in ["dexterous", "orientation", "constant-orientation"] {
        let message = "orientation follows from the other coordinates (dependent: theta";
        refused("five-bar", kind, message);
    }
}

/// The values of imaginary joints are on no grid that they could be a share of.
#[test]
fn imaginary_joints_have_no_measure() {
    let found = workspace(&[PLANO, "--kind", "imaginary", "--grid=xi=0:1:5", "--grid=psi=0:1:5"]);
    assert!(found["measure"].is_null() && found["boundary"].is_null());
}

/// The picture names the limit on the condition number, and its colours span the recorded values.
#[test]
fn a_picture_tells_the_condition() {
    let folder = Folder::new();
    let [cloud, picture] = ["c.mcap", "c.svg"].map(|name| folder.arg(name));
    let flags = ["--max-condition", "20", "--color", "inverse_condition", "-q", "-o", &cloud];
    let grid = ["--grid=x=-0.1:0.1:21", "--grid=y=-0.1:0.1:21"];
    opm(&[&["workspace", PLANO], &flags[..], &grid].concat()).text();
    opm(&["plot", &cloud, "-o", &picture, "-q"]).text();
    let svg = std::fs::read_to_string(&picture).unwrap();
    assert!(svg.contains("condition number at most 20"));
    let values = opm(&["inspect", &cloud, "--format", "json"]).json();
    let run = values["metadata"]["clouds"].clone();
    let top: f64 = run["color_max"].as_str().unwrap().parse().unwrap();
    assert!(top > 0.05 && top < 0.5, "{top}");
}
