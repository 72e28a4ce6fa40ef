//! Notes below a picture of slices.

use super::{Slices, cells};
use opm_plot::{Cells, Content};

impl Slices<'_> {
    /// The number of slices, with those that are not drawn.
    fn looked_at(&self) -> usize {
        let more = self.equal.values().map(|values| values.len() - 1).sum::<usize>();
        self.tiles.len() + self.empty + more
    }

    /// Notes on the picture.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = vec![];
        let coordinates = &self.layout.coordinates;
        if let Some(varied) = self.varied
            && let Some(axis) = &coordinates[varied].axis
            && (self.looked_at() as u64) < axis.count
        {
            notes.push(format!(
                "Slices: {} of the {} values of {} on the grid.",
                self.looked_at(),
                axis.count,
                axis.name
            ));
        }
        if self.polar.is_some() {
            let [around, outwards] =
                self.view.each_ref().map(|seen| &*coordinates[seen.number].name);
            notes.push(format!(
                "In polar form: {around} goes around, {outwards} from the middle outwards."
            ));
        }
        if !self.equal.is_empty() {
            notes.push("Slices that are equal are drawn once.".to_owned());
        }
        if self.empty > 0 {
            let slices = if self.empty == 1 { "slice" } else { "slices" };
            notes.push(format!("Left out: {} {slices} that hold nothing.", self.empty));
        }
        let bounded = |tile: &(u64, Content)| {
            cells(&tile.1).is_some_and(|cells| self.boundary(cells).is_some())
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
        let coarse = |tile: &(u64, Content)| cells(&tile.1).is_some_and(Cells::is_coarse);
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
