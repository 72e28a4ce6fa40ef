//! The picture of a motion: all values over time, or over the input of a linkage.

use super::demand;
use super::label::value_label;
use super::options::PanelName;
use super::sized::drawn;
use super::source::{Rate, ReadStop, Source};
use super::titles::{axis, shown, title};
use super::traces::{Group, TOPICS, TopicKind, Trace, skipped, traces};
use super::violations::{count_of, listed, violations};
use crate::args::PlotArgs;
use crate::failure::Failure;
use crate::text::count;
use opm_core::Quantity;
use opm_core::text::cell;
use opm_mcap::Flat;
use opm_mcap::trajectory::JOINTS_TOPIC;
use opm_plot::{Drawing, Heading, Measure, Panel, PanelRow, Scale, TimeFigure};
use std::collections::{BTreeMap, BTreeSet};

/// Nanoseconds per second.
const SECOND: f64 = 1e9;

pub fn draw(source: &Source<'_>, args: &PlotArgs) -> Result<Drawing, Failure> {
    if let Some(slices) = args.slice.first() {
        let problem = format!("{}: {} is not a workspace", slices.name, source.label);
        return Err(Failure::flag("--slice", problem));
    }
    let topics = || source.recording.topics.iter();
    if !topics().any(|topic| TOPICS.iter().any(|known| known.name == topic.name)) {
        let names: Vec<_> = topics().map(|topic| cell(&topic.name)).take(8).collect();
        let found = if names.is_empty() { "nothing".to_owned() } else { names.join(", ") };
        let cut = if source.recording.complete { "" } else { "cut short, and " };
        return Err(Failure::work(format!(
            "{}: {cut}nothing to draw: it holds {found}, expected /workspace/slices or /joints, as opm \
             records them",
            source.label
        )));
    }
    let wanted = Wanted::new(args)?;
    let mut motion = Motion::new(source);
    let mut values = vec![];
    source.messages(|message| {
        let known = TOPICS.iter().position(|topic| topic.name == message.topic);
        if let (Some(topic), Some(flat)) = (known, message.flat) {
            message.values(&mut values)?;
            motion.add(topic, flat, message.time, &values);
        }
        Ok::<(), ReadStop>(())
    })?;
    motion.finish();
    if motion.instants == 0 {
        return Err(Failure::work(format!("{}: no sample to draw", source.label)));
    }
    let figure = motion.figure(wanted, args)?;
    drawn(args, |size| figure.draw(size))
}

/// The panels that `--panels` selects.
struct Wanted {
    groups: Option<Vec<Group>>,
    rates: Vec<Rate>,
}

impl Wanted {
    fn new(args: &PlotArgs) -> Result<Self, Failure> {
        let (mut groups, mut rates) = (vec![], vec![]);
        for panel in &args.panels {
            groups.extend(rows_of(*panel));
            match panel {
                PanelName::Pose
                | PanelName::Imaginary
                | PanelName::Actuated
                | PanelName::Passive
                | PanelName::Condition
                | PanelName::Indices
                | PanelName::Efforts => {}
                PanelName::Positions => rates.push(Rate::Position),
                PanelName::Velocities => rates.push(Rate::Velocity),
                PanelName::Accelerations => rates.push(Rate::Acceleration),
                PanelName::Slices | PanelName::Rejected => {
                    let problem = format!("{} are of a workspace, not of a motion", panel.name());
                    return Err(Failure::flag("--panels", problem));
                }
            }
        }
        if rates.is_empty() {
            rates = vec![Rate::Position, Rate::Velocity];
        }
        Ok(Self { groups: (!groups.is_empty()).then_some(groups), rates })
    }

    /// Without --panels, passive joints are drawn if --values names them.
    fn has(&self, group: Group, args: &PlotArgs) -> bool {
        match &self.groups {
            Some(groups) => groups.contains(&group),
            None => group != Group::Passive || !args.values.is_empty(),
        }
    }

    /// Condition number, measures, indices and efforts are not positions: if --panels names them, they are drawn with any
    /// rates.
    fn takes(&self, trace: &Trace) -> bool {
        let judged = matches!(
            trace.group,
            Group::Condition | Group::Singularity | Group::Indices | Group::Efforts
        );
        self.rates.contains(&trace.rate) || (judged && self.groups.is_some())
    }
}

/// The rows that the name of a panel stands for; none if it names columns.
fn rows_of(panel: PanelName) -> &'static [Group] {
    match panel {
        PanelName::Pose => &[Group::Pose],
        PanelName::Imaginary => &[Group::Imaginary],
        PanelName::Actuated => &[Group::Actuated, Group::Joints],
        PanelName::Passive => &[Group::Passive],
        PanelName::Condition => &[Group::Condition, Group::Singularity],
        PanelName::Indices => &[Group::Indices],
        PanelName::Efforts => &[Group::Efforts],
        PanelName::Positions
        | PanelName::Velocities
        | PanelName::Accelerations
        | PanelName::Slices
        | PanelName::Rejected => &[],
    }
}

/// What records the values of a panel, if not every recording of such a mechanism has them.
fn recorded_by(panel: PanelName) -> &'static str {
    match panel {
        PanelName::Condition => "; `opm trajectory -o` records it for every motion",
        PanelName::Indices => "; record with `opm trajectory --indices`",
        PanelName::Efforts => "; record with `opm trajectory --efforts`",
        _ => "",
    }
}

/// All values over time, or over the input of a linkage.
struct Motion<'a> {
    source: &'a Source<'a>,
    /// The name of the joint that moves the linkage.
    input: Option<String>,
    /// What the curves are drawn over, the divisor of its SI values, and its range so far.
    over: Measure,
    factor: f64,
    range: [f64; 2],
    /// Time of the first message, in nanoseconds.
    start: u64,
    /// Time of the motion at that message, in seconds.
    offset: f64,
    /// The traces of every topic that has been read.
    traces: Vec<Option<Vec<Trace>>>,
    /// Time of the current messages.
    now: Option<u64>,
    /// The values of each topic at that time; none if it has no message there.
    current: Vec<Option<Vec<f64>>>,
    instants: u64,
    end: u64,
    invalid: Vec<[f64; 2]>,
    valid: bool,
    /// Whether the mechanism follows at the current time.
    follows: bool,
}

impl<'a> Motion<'a> {
    fn new(source: &'a Source<'a>) -> Self {
        let run = source.metadata("run");
        let offset =
            run.get("start").and_then(|start| start.parse().ok()).filter(|s: &f64| s.is_finite());
        let input = source.input();
        let (over, factor) = match &input {
            Some((name, quantity)) => source.measure(name, Some(*quantity), Rate::Position),
            None => (Measure::time(), 1.0),
        };
        Self {
            source,
            input: input.map(|(name, _)| name),
            over,
            factor,
            range: [f64::MAX, f64::MIN],
            offset: offset.unwrap_or(0.0),
            start: source.recording.time_range.map_or(0, |range| range[0]),
            traces: TOPICS.iter().map(|_| None).collect(),
            now: None,
            current: vec![None; TOPICS.len()],
            instants: 0,
            end: 0,
            invalid: vec![],
            valid: true,
            follows: true,
        }
    }

    fn seconds(&self, time: u64) -> f64 {
        self.offset + time.saturating_sub(self.start) as f64 / SECOND
    }

    fn add(&mut self, topic: usize, flat: &Flat, time: u64, values: &[f64]) {
        if self.now != Some(time) {
            self.finish();
            self.now = Some(time);
            self.instants += 1;
            self.end = time;
        }
        let source = self.source;
        self.traces[topic].get_or_insert_with(|| traces(source, TOPICS[topic], flat));
        let values = flat.names.iter().zip(values);
        let mut drawn = self.current[topic].take().unwrap_or_default();
        drawn.clear();
        for (name, value) in values {
            match skipped(topic, name) {
                true => self.follows = *value != 0.0,
                false => drawn.push(*value),
            }
        }
        self.current[topic] = Some(drawn);
    }

    /// Ends an instant. What had values before and has none now has a gap. So have the measures where
    /// the joints are unknown: out of reach, `/condition` goes on, but there is no posture to measure.
    fn finish(&mut self) {
        let Some(time) = self.now.take() else { return };
        let place = self.place(self.seconds(time));
        self.range = [self.range[0].min(place), self.range[1].max(place)];
        let follows = std::mem::replace(&mut self.follows, true);
        self.judge(place, follows);
        let of = |kind| (0..TOPICS.len()).filter(move |&n| TOPICS[n].kind == kind);
        let known = |values: &Vec<f64>| !values.iter().all(|value| value.is_nan());
        let posture =
            of(TopicKind::Joints).any(|topic| self.current[topic].as_ref().is_some_and(known));
        for (topic, traces) in self.traces.iter_mut().enumerate() {
            let values = self.current[topic].take();
            let values = values.filter(|_| TOPICS[topic].kind != TopicKind::Condition || posture);
            for (number, trace) in traces.iter_mut().flatten().enumerate() {
                let value = values.as_ref().map_or(f64::NAN, |values| values[number]);
                trace.curve.push(place, value / trace.factor);
            }
        }
    }

    /// Where the current values are drawn: at this time, or at the value of the input.
    fn place(&self, seconds: f64) -> f64 {
        let Some(input) = &self.input else { return seconds };
        let topics = self.traces.iter().zip(&self.current).zip(TOPICS);
        let joints = topics.filter(|(_, topic)| topic.name == JOINTS_TOPIC);
        let values =
            joints.filter_map(|((traces, values), _)| traces.as_ref().zip(values.as_ref()));
        let mut named = values.flat_map(|(traces, values)| traces.iter().zip(values));
        let found = named.find(|(trace, _)| trace.name == *input);
        found.map_or(f64::NAN, |(_, value)| value / self.factor)
    }

    /// Extends the span in which the mechanism cannot follow, or begins a new one. An input may go back.
    fn judge(&mut self, place: f64, valid: bool) {
        match (valid, self.valid, self.invalid.last_mut()) {
            (false, false, Some([low, high])) => {
                *low = low.min(place);
                *high = high.max(place);
            }
            (false, ..) => self.invalid.push([place; 2]),
            (true, ..) => {}
        }
        self.valid = valid;
    }

    fn figure(self, mut wanted: Wanted, args: &PlotArgs) -> Result<TimeFigure, Failure> {
        let heading = self.heading();
        let Self { source, input, over, range, traces, mut invalid, .. } = self;
        let mut all: Vec<Trace> = traces.into_iter().flatten().flatten().collect();
        check_names(args, &all)?;
        // Over itself, an input is a straight line.
        all.retain(|trace| {
            input.as_ref() != Some(&trace.name) || args.values.contains(&trace.name)
        });
        let violations = violations(source);
        let mut notes = listed(&violations, count_of(source, &violations));
        // What is wrong is shown.
        if args.panels.is_empty() && violations.iter().any(|violation| violation.accelerates) {
            wanted.rates.push(Rate::Acceleration);
        }
        notes.extend(demand::notes(source, &all));
        // Violations between samples are marked too, if they are recorded.
        invalid.extend(violations.iter().map(|violation| [violation.start, violation.end]));
        if !invalid.is_empty() {
            let shaded = match input {
                None => "Shaded: the mechanism cannot follow.",
                Some(_) => {
                    "Shaded: a joint is beyond its limits, in one direction of the input at least."
                }
            };
            notes.insert(0, shaded.to_owned());
        }
        if let Some(thinned) = all.iter().find(|trace| trace.curve.is_thinned()) {
            notes.push(format!(
                "Each curve is drawn by the extremes of its {} samples in thousands of spans.",
                count(thinned.curve.samples())
            ));
        }
        let held: BTreeSet<Group> = all.iter().map(|trace| trace.group).collect();
        // Rows in order, one for each unit; each has the positions and then their derivatives.
        let mut rows: BTreeMap<(Group, u8, String, &str), Vec<Trace>> = BTreeMap::new();
        for trace in all {
            let named = args.values.is_empty() || args.values.contains(&trace.name);
            if named && wanted.has(trace.group, args) && wanted.takes(&trace) {
                let order = match trace.quantity {
                    Some(Quantity::Length) => 0,
                    Some(Quantity::Angle) => 1,
                    None => 2,
                };
                let key = (trace.group, order, trace.unit.clone(), shown(&trace));
                rows.entry(key).or_default().push(trace);
            }
        }
        let label = &source.label;
        for panel in &args.panels {
            let wanted = rows_of(*panel);
            if wanted.is_empty() || rows.keys().any(|(group, ..)| wanted.contains(group)) {
                continue;
            }
            let name = panel.name();
            let problem = match wanted.iter().any(|group| held.contains(group)) {
                true => format!("{label}: no {name} in what --panels and --values ask for"),
                false => format!("{name}: {label} has none{}", recorded_by(*panel)),
            };
            return Err(Failure::flag("--panels", problem));
        }
        if rows.is_empty() {
            let problem = format!("{label}: it holds none of what --panels and --values ask for");
            return Err(match (args.panels.is_empty(), args.values.is_empty()) {
                (false, _) => Failure::flag("--panels", problem),
                (true, false) => Failure::flag("--values", problem),
                (true, true) => Failure::work(problem),
            });
        }
        // Empty columns are left out.
        let rates: Vec<Rate> = [Rate::Position, Rate::Velocity, Rate::Acceleration]
            .into_iter()
            .filter(|rate| rows.values().flatten().any(|trace| trace.rate == *rate))
            .collect();
        let rows = rows.into_iter().map(|((group, ..), traces)| row(source, group, traces, &rates));
        let notes = [notes, source.notes()].concat();
        Ok(TimeFigure {
            heading: Heading { notes, ..heading },
            over,
            range,
            rows: rows.collect(),
            invalid,
            marks: violations.iter().map(|violation| violation.start).collect(),
        })
    }

    fn heading(&self) -> Heading {
        let run = self.source.metadata("run");
        let mut parts = vec![];
        for (key, label) in
            [("motion", "motion "), ("mode", "mode "), ("input", "input "), ("branch", "branch ")]
        {
            if let Some(value) = run.get(key).filter(|value| !value.is_empty()) {
                parts.push(format!("{label}{value}"));
            }
        }
        let samples = count(self.instants);
        parts.push(match self.input {
            Some(_) => format!("{samples} positions"),
            None => {
                let seconds = value_label(self.seconds(self.end) - self.offset);
                format!("{samples} samples in {seconds} s")
            }
        });
        let lines = vec![format!("{}; {}", parts.join(", "), self.source.units_line())];
        Heading { title: self.source.title(), lines, notes: vec![] }
    }
}

fn check_names(args: &PlotArgs, all: &[Trace]) -> Result<(), Failure> {
    let mut known: Vec<&str> = all.iter().map(|trace| &*trace.name).collect();
    for name in &args.values {
        if !known.contains(&&**name) {
            let mut seen = Vec::new();
            known.retain(|name| {
                !seen.contains(name) && {
                    seen.push(*name);
                    true
                }
            });
            let problem = format!("{name:?} is not one of {}", known.join(", "));
            return Err(Failure::flag("--values", problem));
        }
    }
    Ok(())
}

fn row(source: &Source<'_>, group: Group, traces: Vec<Trace>, rates: &[Rate]) -> PanelRow {
    let mut names: Vec<String> = Vec::new();
    let mut columns: Vec<Vec<Trace>> = rates.iter().map(|_| vec![]).collect();
    for trace in traces {
        if !names.contains(&trace.name) {
            names.push(trace.name.clone());
        }
        if let Some(column) = rates.iter().position(|rate| *rate == trace.rate) {
            columns[column].push(trace);
        }
    }
    let number = |name: &str| names.iter().position(|known| known == name).unwrap_or(0);
    let panel = |traces: Vec<Trace>| {
        let (quantity, rate) = traces.first().map(|trace| (trace.quantity, trace.rate))?;
        let symbol = traces.first().map(|trace| trace.unit.clone()).filter(|of| !of.is_empty());
        let (Measure { name, mut unit }, _) =
            source.measure(axis(group, quantity, rate), quantity, rate);
        unit.symbol = symbol.unwrap_or(unit.symbol);
        let title = title(&traces);
        let limits = traces.iter().flat_map(|trace| {
            let limits = demand::limits(source, trace).into_iter().flatten();
            limits.map(|limit| (number(&trace.name), limit))
        });
        let limits = limits.collect();
        let curves = traces.into_iter().map(|trace| (number(&trace.name), trace.curve)).collect();
        let scale = match group {
            Group::Condition => Scale::Logarithmic,
            _ => Scale::Linear,
        };
        Some(Panel { title, name, unit, scale, curves, limits })
    };
    let panels = columns.into_iter().map(panel).collect();
    PanelRow { names, panels }
}
