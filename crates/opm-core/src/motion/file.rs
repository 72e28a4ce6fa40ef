//! Motion files: TOML text is read into a [`PlatformMotion`], or every problem is reported with its location.
//!
//! ```toml
//! format = 1
//! name = "figure-of-eight"
//! units = { length = "mm", angle = "deg" }   # as in mechanism files
//! duration = 10                              # seconds
//! rate = 100                                 # samples per second
//! mode = "++ ++ ++ +"                        # optional; the default is the mode of home
//!
//! [coordinates]                              # absolute task coordinates; the others stay at home
//! x = { amplitude = 30, frequency = 0.2 }
//! y = { amplitude = 15, frequency = 0.4, phase = 90, offset = 10 }
//! zeta = 5
//! xi = [{ amplitude = 10, frequency = 0.1 }, { amplitude = 2, frequency = 0.7, phase = 45 }]
//! ```
//!
//! A coordinate is a constant number, one sinusoid, or an array of sinusoids that are added. A
//! sinusoid is
//!
//! ```text
//! offset + amplitude · sin(2π · frequency · t + phase)
//! ```
//!
//! In place of `duration` and `[coordinates]`, a file may have points in `[points]`: an array of times and one of
//! values for each coordinate that moves. Cubic splines join them, and start and end as `ends` says: `"rest"`,
//! `"natural"` or `"periodic"` ([`Ends`]). Angles are as they are written: 0 and 360 degrees are a revolution apart.
//!
//! ```toml
//! format = 1
//! name = "there"
//! units = { length = "mm", angle = "deg" }
//! rate = 100
//!
//! [points]
//! t = [0, 2]
//! x = [-20, 20]
//! xi = 5                                     # a number: constant
//! ```
//!
//! Or it may have straight lines and circular arcs in `[[moves]]`, with a feed rate: see `cli/src/format.md`.
//!
//! ```toml
//! format = 1
//! name = "slot"
//! units = { length = "mm", angle = "deg" }
//! rate = 100
//! feed = 100                                 # mm/s along the path
//! acceleration = 1000                        # mm/s² along the path
//! blend = 5                                  # mm before and behind a corner
//! start = { x = -20 }                        # the others at home
//!
//! [[moves]]
//! to = { x = 20 }
//!
//! [[moves]]
//! to = { x = 20, y = 40 }
//! via = { x = 40, y = 20 }                   # an arc
//! ```
//!
//! Amplitudes and offsets are in the file's unit for the coordinate, phases in its unit for angles.
//! Frequencies are in hertz and times in seconds, whatever the units are. `phase` and `offset`
//! default to zero. An unknown key is a problem, and its message suggests the nearest known key.

use super::points::through;
#[cfg(feature = "schema")]
pub use super::schema::schema;
use super::{Ends, Harmonics, Move, MoveProblem, Path, PlatformMotion, Sinusoid};
use crate::manipulator::{Manipulator, Mode};
use crate::mechanism::file::{FileErrors, LARGEST, Table, Value, all, document, head};
use crate::numeric::Quantity;
use crate::task::TaskCoordinate;

/// The keys of a motion file.
pub(super) const KEYS: &[&str] = &[
    "format",
    "name",
    "units",
    "duration",
    "rate",
    "mode",
    "coordinates",
    "ends",
    "points",
    "feed",
    "acceleration",
    "blend",
    "start",
    "moves",
];
/// The keys that `[coordinates]`, `[points]` and `[[moves]]` have beside them.
pub(super) const OF_COORDINATES: &[&str] = &["duration", "coordinates"];
pub(super) const OF_POINTS: &[&str] = &["ends", "points"];
pub(super) const OF_MOVES: &[&str] = &["feed", "acceleration", "blend", "start", "moves"];
/// The keys of a move.
pub(super) const MOVE_KEYS: &[&str] = &["to", "via", "feed", "blend"];
/// The keys of a sinusoid.
pub(super) const SINUSOID_KEYS: &[&str] = &["amplitude", "frequency", "phase", "offset"];

/// Reads the text of a motion file, in the task coordinates and working modes of `manipulator`.
///
/// # Errors
/// [`FileErrors`] lists every problem of the file; if the text is not TOML, only the parser's
/// problems.
pub fn read(text: &str, manipulator: &Manipulator) -> Result<PlatformMotion, FileErrors> {
    document(text, "motion", |root| read_document(root, manipulator))
}

fn read_document(root: &Table<'_>, manipulator: &Manipulator) -> Option<PlatformMotion> {
    let name = head(root, "motion")?;
    root.allow(KEYS);
    let positive = |key: &str, expected: &str| {
        let value = root.require(key, expected)?;
        let number = value.number()?;
        if number > 0.0 && number <= LARGEST {
            return Some(number);
        }
        value.report(format!("is {number}, expected {expected} above 0 and up to {LARGEST:e}"));
        None
    };
    let rate = positive("rate", "a number of samples per second");
    let mode = root.get("mode").and_then(|value| read_mode(&value, manipulator));
    let refuse = |keys: &[&[&str]], given: &str| {
        for value in keys.iter().copied().flatten().filter_map(|key| root.get(key)) {
            value.report(format!("is given beside `{given}`, expected one or the other"));
        }
    };
    let motion = if let Some(moves) = root.get("moves") {
        refuse(&[OF_COORDINATES, OF_POINTS], "moves");
        read_moves(root, &moves, name, manipulator)
    } else if let Some(points) = root.get("points") {
        refuse(&[OF_COORDINATES, OF_MOVES], "points");
        let ends = match root.get("ends") {
            Some(value) => value.word(&Ends::NAMES),
            None => Some(Ends::default()),
        };
        read_points(&points, name, ends, manipulator)
    } else {
        if let Some(value) = root.get("ends") {
            value.report("is given without `points`, expected them: sinusoids have no ends");
        }
        for value in OF_MOVES.iter().filter_map(|key| root.get(key)) {
            value.report("is given without `[[moves]]`, expected them");
        }
        let duration = positive("duration", "a number of seconds");
        let expected =
            "a table [coordinates] of the coordinates that move, or [points], or [[moves]]";
        let coordinates = root
            .require("coordinates", expected)
            .and_then(|value| value.open_table())
            .map(|table| read_coordinates(&table, manipulator));
        duration.zip(coordinates).map(|(duration, coordinates)| PlatformMotion {
            name: name.to_owned(),
            start: 0.0,
            duration,
            rate: None,
            mode: None,
            path: Path::Harmonics(coordinates),
        })
    };
    Some(PlatformMotion { rate: Some(rate?), mode, ..motion? })
}

fn read_mode(value: &Value<'_>, manipulator: &Manipulator) -> Option<Mode> {
    let text = value.string()?;
    if text == "home" {
        return Some(manipulator.home_mode());
    }
    let mode = manipulator.parse_mode(text);
    mode.map_err(|error| {
        value.report(format!(
            "is {text:?}: {}, expected `home` or one sign for every choice, in a group for each leg, as \
             in {:?}",
            error.problem, error.example
        ));
    })
    .ok()
}

fn read_coordinates(table: &Table<'_>, manipulator: &Manipulator) -> Vec<Harmonics> {
    allow_coordinates(table, &[], manipulator);
    let read = |c: &TaskCoordinate| match table.get(c.name) {
        Some(value) => read_harmonics(&value, c.quantity),
        None => Harmonics::constant(c.home),
    };
    manipulator.task_coordinates().iter().map(read).collect()
}

/// Reports every key that is neither a task coordinate nor one of `others`.
fn allow_coordinates(table: &Table<'_>, others: &[&'static str], manipulator: &Manipulator) {
    let mut names: Vec<_> = others.to_vec();
    names.extend(manipulator.task_coordinates().iter().map(|c| c.name));
    for c in manipulator.dependent_coordinates() {
        if let (Some(value), Err(follows)) =
            (table.get(c.name), manipulator.refuse_following(c.name))
        {
            value.report(follows.problem());
            names.push(c.name);
        }
    }
    table.allow(&names);
}

/// The motion through the points of a table: `t`, and for each coordinate a number or one for each time.
fn read_points(
    value: &Value<'_>,
    name: &str,
    ends: Option<Ends>,
    manipulator: &Manipulator,
) -> Option<PlatformMotion> {
    let table = value.open_table()?;
    allow_coordinates(&table, &["t"], manipulator);
    let times = table.require("t", "an array of times in seconds").and_then(|value| {
        let times = all(value.items("an array of times in seconds")?.iter().map(Value::number))?;
        if let Some(time) = times.iter().find(|time| time.abs() > LARGEST) {
            value.report(format!("has {time:e}, expected at most {LARGEST:e} seconds"));
            return None;
        }
        if let Some(i) = (1..times.len()).find(|&i| times[i] <= times[i - 1]) {
            value.report(format!("has {} after {}, expected a later time", times[i], times[i - 1]));
            return None;
        }
        Some(times)
    });
    let count = times.as_ref().map(Vec::len);
    let column = |c: &TaskCoordinate| match table.get(c.name) {
        None => Some(Vec::new()),
        Some(value) => read_column(&value, c.quantity, count),
    };
    let values = all(manipulator.task_coordinates().iter().map(column));
    let units = table.reader.units();
    let motion = through(name, times?, values?, ends?, manipulator, |_| units);
    motion.map_err(|error| table.reader.report(table.location_of("t"), error.to_string())).ok()
}

/// The motion along lines and arcs.
fn read_moves(
    root: &Table<'_>,
    value: &Value<'_>,
    name: &str,
    manipulator: &Manipulator,
) -> Option<PlatformMotion> {
    let coordinates = manipulator.task_coordinates();
    if coordinates.iter().all(|coordinate| coordinate.quantity == Quantity::Angle) {
        value.report("are along positions, which this mechanism does not have, expected [points]");
        return None;
    }
    let positive = |value: Value<'_>, what: &str| {
        let number = value.number()?;
        if number > 0.0 && number <= LARGEST {
            return value.length();
        }
        value.report(format!("is {number}, expected {what} above 0 and up to {LARGEST:e}"));
        None
    };
    let blend = |value: Value<'_>| {
        let number = value.length()?;
        if number >= 0.0 {
            return Some(number);
        }
        value.report("is below 0, expected the distance from a corner within which it is rounded");
        None
    };
    let speed = "a speed along the path";
    let acceleration = root
        .require(
            "acceleration",
            "the acceleration along the path, in the unit of lengths per second squared",
        )
        .and_then(|value| positive(value, "an acceleration along the path"));
    let common_feed = root.get("feed").map(|value| positive(value, speed));
    let common_blend = root.get("blend").map_or(Some(0.0), blend);
    let home = manipulator.home_pose();
    let start = match root.get("start") {
        Some(value) => read_pose(&value, &home, manipulator),
        None => Some(home),
    };
    let items = value.items("an array of tables [[moves]]")?;
    let mut at = start.clone();
    let mut moves = Vec::with_capacity(items.len());
    for (number, item) in items.iter().enumerate() {
        let table = item.table(MOVE_KEYS);
        let read = table.as_ref().and_then(|table| {
            let to = table.require("to", "a table of coordinates, the end of the move");
            let to = to.and_then(|value| read_pose(&value, at.as_ref()?, manipulator));
            let via = match table.get("via") {
                Some(value) => {
                    let via = read_pose(&value, at.as_ref()?, manipulator);
                    Some(refuse_angles(&value, manipulator).and(via)?)
                }
                None => None,
            };
            let feed = match table.get("feed") {
                Some(value) => positive(value, speed),
                None => common_feed.unwrap_or_else(|| {
                    table.require("feed", "a speed, here or for all moves beside `rate`");
                    None
                }),
            };
            let last = number + 1 == items.len();
            let blend = match table.get("blend") {
                Some(value) if last => {
                    value.report("is given for the last move, which has no corner at its end");
                    None
                }
                Some(value) => blend(value),
                None => common_blend.map(|blend| if last { 0.0 } else { blend }),
            };
            Some(Move { to: to?, via, feed: feed?, blend: blend? })
        });
        at = read.as_ref().map(|read| read.to.clone());
        moves.push(read);
    }
    let moves = all(moves.into_iter())?;
    if moves.is_empty() {
        value.report("is empty, expected one move or more");
        return None;
    }
    let units = root.reader.units();
    let shown = |length: f64| units.show(length, Quantity::Length).to_string();
    let motion = PlatformMotion::along(name, &start?, &moves, acceleration?, manipulator);
    motion
        .map_err(|error| {
            let problem = match error.problem {
                MoveProblem::Overlap { needed, length } => format!(
                    "it is {} long, and the blends at its ends need {}, expected less",
                    shown(length),
                    shown(needed)
                ),
                problem => problem.to_string(),
            };
            root.reader
                .report(items[error.number].at, format!("move {}: {problem}", error.number + 1));
        })
        .ok()
}

/// A pose that has these values in place of some of another.
fn read_pose(value: &Value<'_>, other: &[f64], manipulator: &Manipulator) -> Option<Vec<f64>> {
    let table = value.open_table()?;
    allow_coordinates(&table, &[], manipulator);
    let read = |(c, &other): (&TaskCoordinate, &f64)| match table.get(c.name) {
        Some(value) => value.quantity(c.quantity),
        None => Some(other),
    };
    all(manipulator.task_coordinates().iter().zip(other).map(read))
}

/// Reports angles in the place on an arc, which are not used.
fn refuse_angles(value: &Value<'_>, manipulator: &Manipulator) -> Option<()> {
    let table = value.open_table()?;
    let angles = manipulator.task_coordinates().iter().filter(|c| c.quantity == Quantity::Angle);
    let given: Vec<_> = angles.filter_map(|c| table.get(c.name)).collect();
    for angle in &given {
        angle
            .report("is an angle, expected positions only: angles change evenly from start to end");
    }
    given.is_empty().then_some(())
}

/// A value for each of `count` times; a number alone is the same at all.
fn read_column(value: &Value<'_>, quantity: Quantity, count: Option<usize>) -> Option<Vec<f64>> {
    if !value.is_array() {
        return Some(vec![value.quantity(quantity)?; count?]);
    }
    let values = value.items("a number, or one for each time")?;
    let values = all(values.iter().map(|value| value.quantity(quantity)))?;
    if let Some(expected) = count.filter(|&count| count != values.len()) {
        let (given, noun) = (values.len(), if values.len() == 1 { "value" } else { "values" });
        value.report(format!("has {given} {noun}, expected {expected} as `t` has"));
        return None;
    }
    Some(values)
}

fn read_harmonics(value: &Value<'_>, quantity: Quantity) -> Harmonics {
    let mut sum = Harmonics::default();
    let mut add = |value: &Value<'_>| {
        if !value.is_table() {
            sum.offset += value.quantity(quantity).unwrap_or_default();
            return;
        }
        let Some(table) = value.table(SINUSOID_KEYS) else {
            return;
        };
        let amplitude = table
            .require("amplitude", "the amplitude of the sinusoid")
            .and_then(|value| value.quantity(quantity));
        let frequency = table
            .require("frequency", "the frequency in hertz")
            .and_then(|value| read_frequency(&value));
        let of = |key: &str, quantity| {
            let value = table.get(key).and_then(|value| value.quantity(quantity));
            value.unwrap_or_default()
        };
        sum.offset += of("offset", quantity);
        let phase = of("phase", Quantity::Angle);
        if let (Some(amplitude), Some(frequency)) = (amplitude, frequency) {
            sum.sinusoids.push(Sinusoid { amplitude, frequency, phase });
        }
    };
    if value.is_array() {
        let items = value.items("a number, a sinusoid or an array of sinusoids");
        items.unwrap_or_default().iter().for_each(&mut add);
    } else {
        add(value);
    }
    sum
}

fn read_frequency(value: &Value<'_>) -> Option<f64> {
    let frequency = value.number()?;
    if frequency.abs() > LARGEST {
        value.report(format!("is {frequency:e}, expected at most {LARGEST:e} hertz"));
        return None;
    }
    Some(frequency)
}
