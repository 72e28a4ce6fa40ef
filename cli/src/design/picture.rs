//! The picture of a design: the mechanism, or the front of two objectives.

use super::report::Units;
use crate::args::Output;
use crate::failure::Failure;
use crate::load::Loaded;
use crate::plot::mechanism::{At, figure};
use opm_core::mechanism::file::MechanismFile;
use opm_design::{Outcome, Problem};
use opm_plot::{
    Curve, Drawing, Heading, Measure, Panel, PanelRow, Scale, Steps, TimeFigure, TooSmall, Unit,
};

/// Draws what was found.
pub fn draw(
    problem: &Problem,
    loaded: &Loaded,
    found: &Outcome,
    output: &Output,
) -> Result<Drawing, Failure> {
    let failed = |error: TooSmall| Failure::at("the picture", error);
    if problem.objectives.len() == 1 {
        let design = &found.designs[0];
        let file = MechanismFile { places: Default::default(), ..design.file.clone() };
        let designed = Loaded { text: file.text(), file, ..loaded.clone() };
        return figure(&designed, &At::default(), output)?.draw(None).map_err(failed);
    }
    let units = Units::new(problem, loaded);
    let [over, of] = [0, 1].map(|number| {
        let (measure, factor, symbol) = units.of(&problem.objectives[number]);
        let unit = Unit { symbol: symbol.to_owned(), steps: Steps::Decimal, resolution: 1e-9 };
        (Measure { name: measure.to_string(), unit }, factor)
    });
    let mut curve = Curve::default();
    for design in &found.designs {
        curve.push(design.values[0] / over.1, design.values[1] / of.1);
    }
    let ends = found.designs.iter().map(|design| design.values[0] / over.1);
    let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    // A front of one design is a point.
    let wide = if low < high { [low, high] } else { [low - 0.5, high + 0.5] };
    let lines = vec![format!("front of {} designs", found.designs.len())];
    let title = format!("{} over {}", of.0.name, over.0.name);
    let panel = Panel {
        title,
        name: of.0.name,
        unit: of.0.unit,
        scale: Scale::Linear,
        curves: vec![(0, curve)],
        limits: vec![],
    };
    let front = TimeFigure {
        heading: Heading { title: loaded.file.mechanism.name.clone(), lines, notes: vec![] },
        over: over.0,
        range: wide,
        rows: vec![PanelRow { names: vec!["front".to_owned()], panels: vec![Some(panel)] }],
        invalid: vec![],
        marks: vec![],
    };
    front.draw(None).map_err(failed)
}
