//! The largest disc, ball or box in a workspace, for printing.

use crate::args::WorkspaceArgs;
use crate::failure::Failure;
use crate::runs::Cell;
use crate::text::{self, Table, short};
use opm_core::Quantity;
use opm_core::mechanism::file::FileUnits;
use opm_study::{Analysis, Workspace, unit_product};
use opm_workspace::{Inscribed, InscribedShape};
use serde_json::{Map, Value, json};

/// What was found.
pub struct FoundInscribed {
    shape: InscribedShape,
    /// `None` if the set is empty, or the given centre outside.
    inscribed: Option<Inscribed>,
    quantities: Vec<Quantity>,
    given: bool,
}

/// Finds what `--inscribed` requests.
pub fn find(
    args: &WorkspaceArgs,
    workspace: &Workspace,
    analysis: &Analysis,
) -> Result<Option<FoundInscribed>, Failure> {
    let Some(shape) = args.inscribed else { return Ok(None) };
    let varying = workspace.varying();
    let centre = match &args.centre {
        None => None,
        Some(given) => Some(given.each_of(&varying).map_err(|e| Failure::flag("--centre", e))?),
    };
    let Some(set) = &analysis.set else { return Ok(None) };
    let inscribed = workspace.inscribed(set, shape, centre.as_deref())?;
    let quantities = varying.into_iter().map(|(_, quantity)| quantity).collect();
    Ok(Some(FoundInscribed { shape, inscribed, quantities, given: centre.is_some() }))
}

impl FoundInscribed {
    /// The shape that was found.
    pub fn shape(&self) -> Option<&Inscribed> {
        self.inscribed.as_ref()
    }

    fn powers(&self) -> [(Quantity, usize); 2] {
        [Quantity::Length, Quantity::Angle].map(|quantity| {
            (quantity, self.quantities.iter().filter(|&&other| other == quantity).count())
        })
    }

    /// The measure, in a table of several workspaces.
    pub fn cell(&self, units: FileUnits) -> Cell {
        let (unit, factor) = unit_product(&self.powers(), units);
        let measure = self.inscribed.as_ref().map_or(0.0, Inscribed::measure);
        let header = format!("{} [{unit}]", self.shape.name());
        Cell { header, ..Cell::new("inscribed", self.json(), short(measure / factor)) }
    }

    pub fn json(&self) -> Value {
        let Some(found) = &self.inscribed else { return Value::Null };
        let named = |values: &[f64]| -> Map<String, Value> {
            found.names.iter().cloned().zip(values.iter().map(|&value| value.into())).collect()
        };
        let mut json = json!({
            "shape": self.shape.name(),
            "centre": named(&found.centre),
            "measure": found.measure(),
            "units": unit_product(&self.powers(), FileUnits::SI).0,
            "at_edge_of_grid": found.at_edge,
        });
        match self.shape {
            InscribedShape::Disc | InscribedShape::Ball => {
                json["radius"] = found.radii[0].into();
                json["error"] = found.error[0].into();
            }
            InscribedShape::Box => {
                json["half_sides"] = named(&found.radii).into();
                json["error"] = named(&found.error).into();
            }
        }
        json
    }

    pub fn text(&self, units: FileUnits) -> String {
        let name = self.shape.name();
        let Some(found) = &self.inscribed else {
            let why = if self.given { "the centre is not inside" } else { "the set is empty" };
            return format!("\nno inscribed {name}: {why}\n");
        };
        let radius = if self.shape == InscribedShape::Box { ">half side" } else { ">radius" };
        let headers = [&*format!("inscribed {name}"), ">centre", radius, ">error", "unit"];
        let mut table = Table::new(headers);
        for (i, &quantity) in self.quantities.iter().enumerate() {
            let number = |value| text::number(value, quantity, units);
            let [centre, radius, error] =
                [found.centre[i], found.radii[i], found.error[i]].map(number);
            table.row([&*found.names[i], &centre, &radius, &error, units.symbol(quantity)]);
        }
        let (unit, factor) = unit_product(&self.powers(), units);
        let edge = match found.at_edge {
            true => "it touches the edge of the grid, beyond which the workspace may go on\n",
            false => "",
        };
        format!("\n{table}size in coordinates {} {unit}\n{edge}", short(found.measure() / factor))
    }
}
