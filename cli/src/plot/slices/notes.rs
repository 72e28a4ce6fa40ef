//! Notes below a picture of slices.

use super::Slices;
use opm_plot::Content;

impl Slices<'_> {
    /// Notes on the picture.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = vec![];
        let coordinates = &self.layout.coordinates;
        if let Some(varied) = self.varied
            && let Some(axis) = &coordinates[varied].axis
            && ((self.tiles.len() + self.empty) as u64) < axis.count
        {
            notes.push(format!(
                "Slices: {} of the {} values of {} on the grid.",
                self.tiles.len() + self.empty,
                axis.count,
                axis.name
            ));
        }
        if self.empty > 0 {
            let slices = if self.empty == 1 { "slice" } else { "slices" };
            notes.push(format!("Left out: {} {slices} that hold nothing.", self.empty));
        }
        let bounded = |tile: &(u64, Content)| match &tile.1 {
            Content::Cells(cells, _) => self.boundary(cells).is_some(),
            _ => false,
        };
        if self.tiles.iter().any(bounded) {
            let line =
                "The line is the boundary, half-way between values of the grid, and on its edge.";
            notes.push(line.to_owned());
        }
        if self.curves.iter().any(|lines| !lines.is_empty()) {
            notes.push(
                "The red lines are parallel singularities, found by bisection on the lines of the grid.".to_owned(),
            );
        }
        if let Some(shape) = &self.shape
            && self.tiles.iter().any(|(value, _)| self.inside(*value).is_some())
        {
            notes.push(format!("The thick line is the largest {}.", shape.text));
        }
        let coarse = |tile: &(u64, Content)| match &tile.1 {
            Content::Cells(cells, _) => cells.is_coarse(),
            _ => false,
        };
        if self.tiles.iter().any(coarse) {
            notes.push(
                "A cell holds several values of the grid, at least one of them reachable."
                    .to_owned(),
            );
        }
        if self.tiles.iter().any(|(value, _)| self.mark(*value).is_some()) {
            notes.push("The cross is home.".to_owned());
        }
        notes
    }
}
