//! What a design found, as text and as JSON.

use crate::load::Loaded;
use crate::output::Shown;
use crate::text::{Table, plural, range, short};
use opm_core::Quantity;
use opm_core::manipulator::Manipulator;
use opm_design::{Design, Measure, Outcome, Polished, Problem, Variable};
use serde_json::{Map, Value, json};
use std::fmt::Write as _;
use std::path::PathBuf;

pub struct Report<'a> {
    pub problem: &'a Problem,
    pub loaded: &'a Loaded,
    pub found: &'a Outcome,
    /// The file of each design, if it has one.
    pub names: &'a [Option<PathBuf>],
    /// How many designs were taken from the table of an interrupted run.
    pub resumed: u64,
}

/// The units that measures are shown in.
pub struct Units<'a> {
    loaded: &'a Loaded,
    measures: Vec<(Measure, Option<Quantity>)>,
}

impl<'a> Units<'a> {
    pub fn new(problem: &Problem, loaded: &'a Loaded) -> Self {
        let manipulator = Manipulator::new(loaded.file.mechanism.clone()).ok();
        let quantity = |m: &Measure| manipulator.as_ref().and_then(|found| m.quantity(found));
        let measures = problem.measures().into_iter().map(|m| (m.clone(), quantity(&m))).collect();
        Self { loaded, measures }
    }

    /// A measure, with the factor and the symbol of the unit of its values.
    pub fn of<'m>(&self, measure: &'m Measure) -> (&'m Measure, f64, &'static str) {
        let known = self.measures.iter().find(|(known, _)| known == measure);
        let units = self.loaded.file.units;
        match known.and_then(|(_, quantity)| *quantity) {
            Some(quantity) => (measure, units.factor(quantity), units.symbol(quantity)),
            None => (measure, 1.0, ""),
        }
    }
}

impl Report<'_> {
    pub fn json(&self) -> Value {
        let Outcome { designs, before, ranges, evaluations, polished } = self.found;
        let polished =
            polished.map(|p| json!({ "evaluations": p.evaluations, "from": p.from, "to": p.to }));
        let ranges: Map<String, Value> =
            ranges.iter().map(|(name, ends)| (name.clone(), json!(ends))).collect();
        let designs = designs.iter().zip(self.names).map(|(design, name)| {
            json!({
                "file": name.as_ref().map(|name| name.display().to_string()),
                "measures": self.measures(&design.values),
                "variables": self.variables(design),
                "feasible": design.feasible,
            })
        });
        json!({
            "name": self.loaded.file.mechanism.name,
            "objectives": self.problem.objectives.iter().map(ToString::to_string).collect::<Vec<_>>(),
            "evaluations": { "upper": evaluations[0], "lower_or_whole": evaluations[1] },
            "polished": polished,
            "resumed": self.resumed,
            "seed": self.problem.seed,
            "before": before.as_ref().map(|values| self.measures(values)),
            "imaginary_range": ranges,
            "designs": designs.collect::<Vec<_>>(),
        })
    }

    /// The values of all measures by name, SI. JSON has no infinity.
    fn measures(&self, values: &[f64]) -> Map<String, Value> {
        let measures = self.problem.measures().into_iter().zip(values);
        measures.map(|(measure, value)| (measure.to_string(), json!(value))).collect()
    }

    fn variables(&self, design: &Design) -> Map<String, Value> {
        let mut rest = &*design.variables;
        let own = |variable: &Variable| {
            let (own, others) = rest.split_at(variable.bounds.len());
            rest = others;
            let value = if let [number] = own { json!(number) } else { json!(own) };
            (variable.name.clone(), value)
        };
        self.problem.variables.all().into_iter().map(own).collect()
    }

    pub fn text(&self) -> String {
        let Outcome { designs, before, ranges, evaluations, polished } = self.found;
        let units = Units::new(self.problem, self.loaded);
        let measures = self.problem.measures();
        let mut text = String::new();
        let total = evaluations[0] + evaluations[1];
        let _ = write!(text, "{}: {}", self.loaded.label, plural(total, "design"));
        if evaluations[0] > 0 {
            let _ = write!(text, ", {} of the upper section", evaluations[0]);
        }
        if self.resumed > 0 {
            let _ = write!(text, "; {} were known", self.resumed);
        }
        text += "\n";
        if let (Some(Polished { evaluations, from, to }), [objective]) =
            (polished, &*self.problem.objectives)
        {
            let (_, factor, symbol) = units.of(objective);
            let show = |value: f64| format!("{} {symbol}", short(value / factor));
            let (from, to) = (show(*from), show(*to));
            let _ = writeln!(
                text,
                "polished by its rates, {} more: {objective} from {} to {}",
                plural(*evaluations, "design"),
                from.trim_end(),
                to.trim_end()
            );
        }
        if !ranges.is_empty() {
            text += "imaginary joints:";
            let quantity = self.imaginary_quantity();
            for (name, ends) in ranges {
                let ends = range(*ends, quantity, self.loaded.file.units);
                let symbol = self.loaded.file.units.symbol(quantity);
                let _ = write!(text, "  {name} {ends} {symbol}");
            }
            text += "\n";
        }
        text += "\n";
        let headers = measures.iter().map(|measure| match units.of(measure) {
            (measure, _, "") => format!(">{measure}"),
            (measure, _, symbol) => format!(">{measure} [{symbol}]"),
        });
        let mut table = Table::new(std::iter::once("design".to_owned()).chain(headers));
        let row = |name: String, values: &[f64]| {
            let cells = measures.iter().zip(values);
            let cells = cells.map(|(measure, value)| short(value / units.of(measure).1));
            std::iter::once(name).chain(cells).collect::<Vec<_>>()
        };
        if let Some(before) = before {
            table.row(row("as given".to_owned(), before));
        }
        for (number, (design, name)) in designs.iter().zip(self.names).enumerate() {
            let name = name.as_ref().map(|name| name.shown());
            let broken = if design.feasible { "" } else { " (breaks constraints)" };
            let name = name.unwrap_or_else(|| format!("found {}", number + 1));
            table.row(row(name + broken, &design.values));
        }
        let _ = write!(text, "{table}");
        if let [design] = &**designs {
            let _ = write!(text, "\n{}", self.dimensions(design));
        }
        text
    }

    fn imaginary_quantity(&self) -> Quantity {
        let manipulator = Manipulator::new(self.loaded.file.mechanism.clone()).ok();
        let first = manipulator.and_then(|m| m.imaginary().first().map(|joint| joint.quantity));
        first.unwrap_or(Quantity::Angle)
    }

    /// A table of the variables of a design.
    fn dimensions(&self, design: &Design) -> Table {
        let units = self.loaded.file.units;
        let mut table = Table::new(["variable", ">value", "unit"]);
        let mut values = design.variables.iter();
        for variable in self.problem.variables.all() {
            let quantity = self.loaded.file.quantity_of(&variable.name);
            for (name, value) in variable.components().into_iter().zip(values.by_ref()) {
                let (value, unit) = match quantity {
                    Some(quantity) => {
                        (crate::text::number(*value, quantity, units), units.symbol(quantity))
                    }
                    None => (value.to_string(), ""),
                };
                table.row([name, value, unit.to_owned()]);
            }
        }
        table
    }
}
