//! `opm workspace --shard` and `opm merge`: many processes give the result of a single one.

use crate::PLANO;
use crate::run::{Folder, command, opm};
use serde_json::Value;
use std::fs;
use std::process::Command;

/// A grid of several blocks, part of which is in reach.
const GRID: [&str; 8] = [
    "--grid",
    "x=-250mm:250mm:61",
    "--grid",
    "y=-200mm:200mm:33",
    "--grid",
    "xi=-100deg:100deg:23",
    "--grid",
    "zeta=0:1:9",
];

/// A small grid of few poses.
const SMALL: [&str; 4] = ["--grid", "x=-250mm:250mm:21", "--grid", "xi=0:1:3"];

fn shard(folder: &Folder, number: u64, of: u64, flags: &[&str]) -> String {
    let output = folder.arg(&format!("part-{number}.mcap"));
    let shard = format!("{number}/{of}");
    opm(&[&["workspace", PLANO, "--shard", &shard, "-o", &output, "-q"], flags].concat()).text();
    output
}

/// The output of a run, without its times.
fn timeless(mut value: Value) -> Value {
    for key in ["seconds", "poses_per_second"] {
        value[key] = Value::Null;
    }
    value
}

#[test]
fn merged_shards_are_the_one_run_byte_for_byte() {
    let limit = ["--max-condition", "9.5"];
    let cases: [(&[&str], &[&str]); 5] = [
        (&[], &[]),
        (&["--mode", "any"], &["--axes", "tip", "--scalars", "S1,theta11"]),
        (&["--mode", "-+ +- -- -"], &["--color", "theta12"]),
        // The range of this colour is found from the points.
        (&[], &["--color", "phi14", "--axes", "x,y,zeta"]),
        (&limit, &["--color", "S1"]),
    ];
    for (number, (flags, cloud)) in cases.into_iter().enumerate() {
        let folder = Folder::new();
        let (one, joined) = (folder.arg("one.mcap"), folder.arg("joined.mcap"));
        let grid = if flags == limit { &SMALL[..] } else { &GRID[..] };
        let flags = [grid, flags].concat();
        let json = ["--format", "json", "-q"];
        let run = ["workspace", PLANO, "-o", &one];
        let whole = opm(&[&run[..], &flags, cloud, &json].concat()).json();
        assert!(whole["reachable"].as_u64() > Some(5), "{whole}");
        let of = [1, 3, 8, 40, 2][number];
        // The order of the files does not matter.
        let parts: Vec<String> = (1..=of).rev().map(|i| shard(&folder, i, of, &flags)).collect();
        let parts: Vec<&str> = parts.iter().map(|part| &**part).collect();
        let merge = ["merge", "-o", &joined, "--threads", "2"];
        let merged = opm(&[&merge[..], &parts, cloud, &json].concat()).json();
        assert_eq!(merged["seconds"], Value::Null);
        assert_eq!(timeless(merged), timeless(whole), "{flags:?}");
        assert!(fs::read(one).unwrap() == fs::read(joined).unwrap(), "{flags:?} {cloud:?}");
    }
}

#[test]
fn a_shard_is_not_drawn_and_says_what_is() {
    let folder = Folder::new();
    let part = shard(&folder, 2, 3, &SMALL);
    let plot = ["plot", &part, "-o", &folder.arg("part.svg")];
    for flags in [&[][..], &["--slice", "xi=0"]] {
        let run = opm(&[&plot[..], flags].concat());
        run.fails_with_one_line(1, &["part-2.mcap: shard 2/3", "join", "`opm merge`"]);
    }
    assert_eq!(folder.names(), ["part-2.mcap"]);
}

/// Sets other than that of the poses are made from all poses when merging; each shard makes its indices.
#[test]
fn merged_shards_are_the_one_run_of_every_kind() {
    let plane = ["--grid", "x=-0.25:0.25:301", "--grid", "y=-0.2:0.2:301"];
    let tilted = [&plane[..], &["--grid", "xi=0.3"]].concat();
    let sphere = ["--grid", "zeta=-1:1:31", "--grid", "xi=-1.7:1.7:61", "--grid", "psi=-1:1:41"];
    let few = ["--grid", "zeta=0:0.2:9", "--grid", "xi=-0.2:0.2:15"];
    let places = [&GRID[..4], &few, &["--grid", "psi=0:0.2:2"]].concat();
    let long = ["--grid", "x=-0.25:0.25:2001", "--grid", "xi=-1:1:33"];
    let cuts = ["--grid", "theta11=-0.7:0.9:17", "--grid", "theta12=-0.7:0.7:5"];
    let lower = [&GRID[..4], &cuts].concat();
    // Options of a shard, options of the merge, and options of the recording alone.
    let cases: [[&[&str]; 4]; 10] = [
        [&["--kind", "constant-orientation"], &tilted, &[], &[]],
        [&["--kind", "orientation", "--mode", "any"], &sphere, &[], &["--color", "psi"]],
        [&["--kind", "reachable"], &GRID, &[], &["--axes", "x,y,share"]],
        [&["--kind", "dexterous"], &places, &[], &[]],
        [&["--kind", "imaginary"], &places, &[], &["--color", "theta11"]],
        [&["--kind", "upper"], &sphere, &[], &["--scalars", "theta12"]],
        [&["--kind", "lower"], &lower, &[], &[]],
        [&[], &GRID, &["--shape"], &["--axes", "x,y,xi"]],
        [&["--conditioning"], &long, &[], &["--scalars", "inverse_condition"]],
        [
            &["--conditioning", "--length", "80mm", "--max-condition", "20"],
            &long,
            &["--shape"],
            &["--color", "inverse_condition"],
        ],
    ];
    for [asked, grid, later, cloud] in cases {
        let folder = Folder::new();
        let one = folder.arg("one.mcap");
        let run = [&["workspace", PLANO, "--format", "json", "-q"], asked, grid].concat();
        let whole = opm(&[&run[..], later, cloud, &["-o", &one]].concat()).json();
        for of in [1, 2, 3, 7] {
            let name = |i: u64| folder.arg(&format!("part-{i}-of-{of}.mcap"));
            let parts: Vec<String> = (1..=of).map(name).collect();
            let mut filled = 0;
            for (number, part) in (1_u64..).zip(&parts) {
                let shard = format!("{number}/{of}");
                let found = opm(&[&run[..], &["--shard", &shard, "-o", part]].concat()).json();
                filled += u64::from(found["reachable"].as_u64() > Some(0));
                if of == 2 {
                    // The file exists already: the output is the same.
                    let again = opm(&[&run[..], &["--shard", &shard, "-o", part]].concat()).json();
                    assert_eq!(timeless(again), timeless(found), "{run:?} {shard}");
                }
            }
            assert!(filled >= of.min(2), "{run:?}: points in {filled} of {of} shards");
            let joined = folder.arg("joined.mcap");
            let merge = ["merge", "--format", "json", "-q", "-o", &joined];
            let parts: Vec<&str> = parts.iter().map(|part| &**part).collect();
            let merged = opm(&[&merge[..], later, cloud, &parts].concat()).json();
            assert_eq!(timeless(merged), timeless(whole.clone()), "{run:?} {of}");
            let same = fs::read(&one).unwrap() == fs::read(&joined).unwrap();
            assert!(same, "{run:?} {later:?} {cloud:?} {of}");
        }
    }
}

/// A sweep consists of blocks, and no shard is smaller than one block.
#[test]
fn a_shard_without_poses_says_why() {
    let folder = Folder::new();
    let (mut empty, mut filled) = (0, 0);
    for number in 1..=4 {
        let (shard, part) = (format!("{number}/4"), folder.arg(&format!("part-{number}.mcap")));
        let args = ["workspace", PLANO, "--shard", &shard, "-o", &part, "--format", "json"];
        let run = opm(&[&args[..], &SMALL].concat());
        let told = format!("shard {shard} has no poses: the sweep comes in ");
        let none = run.json()["poses"] == 0;
        assert_eq!(run.stderr.contains(&told), none, "{}", run.stderr);
        assert_eq!(run.stderr.contains("fewer than 4 shards"), none, "{}", run.stderr);
        *(if none { &mut empty } else { &mut filled }) += 1;
    }
    assert!(empty > 0 && filled > 0, "{empty} {filled}");
}

/// Processes run side by side, as from a queue; one of them is killed and run again.
#[cfg(unix)]
#[test]
fn a_killed_shard_is_run_again() {
    use std::thread::sleep;
    use std::time::{Duration, Instant};

    let folder = Folder::new();
    let flags = [&GRID[..], &["--max-condition", "12", "--threads", "1"]].concat();
    let part = folder.arg("part-5.mcap");
    let own = [&["workspace", PLANO, "--shard", "5/8", "-o", &part], &flags[..]].concat();
    let mut child = command(&own).spawn().unwrap();
    let started = Instant::now();
    while !folder.path("part-5.mcap.partial").exists() {
        assert!(started.elapsed() < Duration::from_secs(60));
        sleep(Duration::from_millis(1));
    }
    child.kill().unwrap();
    assert!(!child.wait().unwrap().success());
    assert_eq!(folder.names(), ["part-5.mcap.partial"]);

    let program = env!("CARGO_BIN_EXE_opm");
    let all = format!(
        "seq 8 | xargs -P 3 -I {{}} '{program}' -q workspace {PLANO} {} --shard {{}}/8 -o '{}'",
        flags.join(" "),
        folder.arg("part-{}.mcap"),
    );
    let done = Command::new("sh").args(["-c", &all]).output().unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let one = folder.arg("one.mcap");
    opm(&[&["workspace", PLANO, "-o", &one, "-q"], &flags[..]].concat()).text();
    let parts: Vec<String> = (1..=8).map(|i| folder.arg(&format!("part-{i}.mcap"))).collect();
    let parts: Vec<&str> = parts.iter().map(|part| &**part).collect();
    let joined = folder.arg("joined.mcap");
    opm(&[&["merge", "-o", &joined, "-q"], &parts[..]].concat()).text();
    assert!(fs::read(one).unwrap() == fs::read(joined).unwrap());
}

#[test]
fn a_shard_that_is_there_is_not_swept_again() {
    let folder = Folder::new();
    let part = shard(&folder, 2, 3, &SMALL);
    let args = ["workspace", PLANO, "--shard", "2/3", "-o", &part, "--format", "json"];
    let before = fs::read(&part).unwrap();
    let found = opm(&[&args[..], &SMALL, &["--force"]].concat()).json();
    assert!(fs::read(&part).unwrap() == before, "the same run, the same bytes");
    assert_eq!(found["shard"], "2/3");
    assert!(found["seconds"].is_f64());

    let again = opm(&[&args[..], &SMALL].concat());
    assert!(again.stderr.contains("part-2.mcap: shard 2/3 is there already"), "{}", again.stderr);
    assert_eq!(timeless(again.json()), timeless(found));
    assert_eq!(again.json()["seconds"], Value::Null);

    // A file of another run, another part or another kind is not overwritten because of a wrong name.
    let other = |args: &[&str], problem: &str| {
        opm(args).fails_with_one_line(1, &["part-2.mcap: ", problem, "--force"]);
        assert!(fs::read(&part).unwrap() == before);
    };
    let mode = ["--mode", "any"];
    other(&[&args[..], &SMALL, &mode].concat(), "mode is \"++ ++ ++ +\", not \"any\"");
    other(&[&args[..], &SMALL[..2]].concat(), "grid.xi is \"0:1:3\", not \"0:0:1\"");
    let third = [&args[..3], &["1/3"], &args[4..], &SMALL[..]].concat();
    other(&third, "shard 2/3, expected 1/3");
    fs::write(&part, "no recording").unwrap();
    let args = [&args[..], &SMALL].concat();
    opm(&args).fails_with_one_line(1, &["is not an MCAP file", "--force"]);
    opm(&[&args[..], &["--force"]].concat()).text();
    assert!(fs::read(&part).unwrap() == before);
}

#[test]
fn shards_that_do_not_belong_together_are_refused() {
    let folder = Folder::new();
    let [one, two] = [1, 2].map(|number| shard(&folder, number, 2, &SMALL));
    let refused = |parts: &[&str], problem: &[&str]| {
        let joined = folder.arg("joined.mcap");
        let args = [&["merge", "-o", &joined], parts].concat();
        opm(&args).fails_with_one_line(1, problem);
        assert!(!folder.names().iter().any(|name| name.starts_with("joined")));
    };
    refused(&[&one, &two, &one], &["part-1.mcap: shard 1/2 a second time"]);

    let others = Folder::new();
    let grid = ["--grid", "x=-250mm:250mm:21", "--grid", "xi=0:1:5"];
    let other = shard(&others, 2, 2, &grid);
    refused(&[&one, &other], &["part-2.mcap: a shard of another run: grid.xi is \"0:1:5\", not"]);
    let others = Folder::new();
    let any = shard(&others, 2, 2, &[&SMALL[..], &["--mode", "any"]].concat());
    refused(&[&one, &any], &["part-2.mcap: a shard of another run: mode is \"any\", not"]);
    let others = Folder::new();
    let limited = shard(&others, 2, 2, &[&SMALL[..], &["--max-condition", "9"]].concat());
    refused(&[&one, &limited], &["a shard of another run: it has characteristic_length, \"0.09"]);
    let others = Folder::new();
    let third = shard(&others, 3, 3, &SMALL);
    refused(&[&one, &third], &["part-3.mcap: shard 3/3, but ", "part-1.mcap is 1/2"]);
    let others = Folder::new();
    let places = shard(&others, 2, 2, &[&SMALL[..], &["--kind", "reachable"]].concat());
    refused(&[&one, &places], &["part-2.mcap: a shard of another run: kind is \"reachable\", not"]);
    let others = Folder::new();
    let told = shard(&others, 2, 2, &[&SMALL[..], &["--conditioning"]].concat());
    refused(&[&one, &told], &["a shard of another run: it has conditioning, \"0.09"]);

    // The mechanism file has one more comment.
    let others = Folder::new();
    let text = opm(&["examples", PLANO]).text().to_owned() + "# more\n";
    let mechanism = others.write(&format!("{PLANO}.toml"), text);
    let part = others.arg("part-2.mcap");
    let flags = ["--shard", "2/2", "-o", &part];
    opm(&[&["workspace", &*mechanism], &flags[..], &SMALL].concat()).text();
    refused(&[&one, &part], &["part-2.mcap: a shard of another run: its mechanism file differs"]);

    let whole = others.arg("whole.mcap");
    opm(&[&["workspace", PLANO, "-o", &whole], &SMALL[..]].concat()).text();
    refused(&[&one, &whole], &["whole.mcap: no shard of `opm workspace --shard`"]);
    let text = others.write("text.mcap", "no recording");
    refused(&[&one, &text], &["text.mcap", "is not an MCAP file"]);
    refused(&[&one, "nowhere.mcap"], &["nowhere.mcap: "]);
    let bytes = fs::read(&two).unwrap();
    // The file ends before it says which shard it is.
    let begun = others.write("begun.mcap", &bytes[..100]);
    refused(&[&one, &begun], &["begun.mcap: cut short"]);
    let short = others.write("short.mcap", &bytes[..bytes.len() / 2]);
    opm(&["merge", &one, &short]).fails(1, &["short.mcap: "]);

    opm(&["merge", &one, &two, "-o", &one]).fails_with_one_line(2, &["is also the input"]);
    for wrong in ["0/3", "4/3", "3", "a/b", ""] {
        opm(&["workspace", PLANO, "--shard", wrong, "-o", "p.mcap"])
            .fails(2, &["--shard", "expected I/N"]);
    }
    opm(&["workspace", PLANO, "--shard", "1/3"]).fails(2, &["--output"]);
    opm(&["workspace", PLANO, "--shard", "1/3", "-o", "p.mcap", "--color", "x"])
        .fails(2, &["--color"]);
    opm(&["workspace", PLANO, "--shard", "1/3", "-o", "p.mcap", "--shape"]).fails(2, &["--shape"]);
    opm(&["merge"]).fails(2, &["PART.mcap"]);
}

/// The printed commands make the missing shards.
#[cfg(unix)]
#[test]
fn missing_shards_are_named_with_their_commands() {
    let limited = ["--mode", "-+ +- -- -", "--max-condition", "9.5"];
    let index = ["--kind", "constant-orientation", "--conditioning", "--length", "80mm"];
    let both = ["--conditioning", "--max-condition", "9.5", "--length", "80mm"];
    missing_shards_are_made(&[&SMALL[..], &limited].concat());
    missing_shards_are_made(&[&SMALL[..2], &index].concat());
    missing_shards_are_made(&[&SMALL[..], &both].concat());
    missing_shards_are_made(&[&SMALL[..], &["--kind", "dexterous"]].concat());
}

fn missing_shards_are_made(flags: &[&str]) {
    let folder = Folder::new();
    let parts: Vec<String> = [1, 4].into_iter().map(|i| shard(&folder, i, 5, flags)).collect();
    let parts: Vec<&str> = parts.iter().map(|part| &**part).collect();
    let merge = [&["merge"], &parts[..]].concat();
    let failed = opm(&merge);
    failed.fails(1, &["opm: error: 3 of 5 shards are missing: 2-3,5\n"]);
    let program = env!("CARGO_BIN_EXE_opm");
    for line in failed.stderr.lines().skip(1) {
        let words = line.strip_prefix("opm:   opm ").unwrap();
        let made = Command::new("sh").args(["-c", &format!("'{program}' {words}")]).output();
        let made = made.unwrap();
        assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    }
    let all: Vec<String> = (1..=5).map(|i| folder.arg(&format!("part-{i}.mcap"))).collect();
    let all: Vec<&str> = all.iter().map(|part| &**part).collect();
    assert!(opm(&[&["merge"], &all[..]].concat()).text().contains("merged from 5 shards"));
}

/// Tables, too, equal those of a single run. A name of another kind gives a message with the known names.
#[test]
fn the_ending_of_a_name_decides_what_points_are_written_as() {
    let folder = Folder::new();
    let parts: Vec<String> = (1..=3).map(|i| shard(&folder, i, 3, &GRID)).collect();
    let parts: Vec<&str> = parts.iter().map(|part| &**part).collect();
    for ending in ["npy", "ply"] {
        let [one, joined] = ["one", "joined"].map(|name| folder.arg(&format!("{name}.{ending}")));
        let flags = ["--scalars", "theta11"];
        opm(&[&["workspace", PLANO, "-o", &one], &GRID[..], &flags].concat()).text();
        opm(&[&["merge", "-o", &joined], &parts[..], &flags].concat()).text();
        let [one, joined] = [one, joined].map(|path| fs::read(path).unwrap());
        assert!(one.len() > 10_000 && one == joined, "{ending}");
    }
    for wrong in ["points.csv", "points", "points.mcap.gz"] {
        let output = folder.arg(wrong);
        let parts = [wrong, ".mcap (", ".npy (NumPy)", ".ply (mesh tools)"];
        opm(&[&["workspace", PLANO, "-o", &output], &SMALL[..]].concat())
            .fails_with_one_line(2, &parts);
        assert!(!folder.path(wrong).exists());
    }
}
