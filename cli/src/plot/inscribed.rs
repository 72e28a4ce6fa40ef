//! The largest disc, ball or box inside a workspace, as slices show it.

use super::label::value_label;
use super::source::{Rate, Source};
use opm_study::recording::inscribed_of;
use opm_workspace::InscribedShape;
use std::f64::consts::TAU;

/// Number of corners of the line that is drawn for a circle.
const CORNERS: u32 = 180;

/// The largest shape inside: for each coordinate its name, centre and radius, radians and metres.
pub struct Shape {
    shape: InscribedShape,
    sizes: Vec<(String, [f64; 2])>,
    /// Its name and numbers, in the units of the picture.
    pub text: String,
}

impl Shape {
    /// The shape that a recording has.
    pub fn of(source: &Source<'_>) -> Option<Self> {
        let (shape, sizes) = inscribed_of(&source.metadata("result"))?;
        let shown = |name: &str, value: f64| {
            let quantity = source.quantity_of(name);
            let (measure, factor) = source.measure(name, quantity, Rate::Position);
            format!("{} {}", value_label(value / factor), measure.unit.symbol)
        };
        let centre = sizes.iter().map(|(name, [at, _])| format!("{name} = {}", shown(name, *at)));
        let centre = centre.collect::<Vec<_>>().join(", ");
        let radii = match (shape, sizes.first()) {
            (InscribedShape::Disc | InscribedShape::Ball, Some((name, [_, radius]))) => {
                format!("radius {}", shown(name, *radius))
            }
            _ => {
                let sides = sizes.iter().map(|(name, [_, half])| shown(name, 2.0 * half));
                format!("sides {}", sides.collect::<Vec<_>>().join(", "))
            }
        };
        let text = format!("{} inside: {radii}, centre {centre}", shape.name());
        Some(Self { shape, sizes, text })
    }

    /// The line where a plane of two coordinates meets the shape, with the other coordinates held; `None` where they do not
    /// meet, or where the shape is of other coordinates.
    pub fn across<'a>(
        &self,
        plane: [&str; 2],
        held: impl Iterator<Item = (&'a str, f64)>,
    ) -> Option<Vec<[f64; 2]>> {
        let size =
            |name: &str| self.sizes.iter().find(|known| known.0 == name).map(|known| known.1);
        let [[x, a], [y, b]] = [size(plane[0])?, size(plane[1])?];
        // The distance of the plane from the centre, as a share of the radius.
        let mut apart = 0.0_f64;
        let mut beyond = self.sizes.len() - 2;
        for (name, value) in held {
            if let Some([centre, radius]) = size(name) {
                apart = apart.hypot((value - centre) / radius);
                beyond -= 1;
            }
        }
        if apart > 1.0 || beyond > 0 {
            return None;
        }
        Some(match self.shape {
            InscribedShape::Box => [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
                .map(|[s, t]| [x + s * a, y + t * b])
                .into(),
            InscribedShape::Disc | InscribedShape::Ball => {
                let share = (1.0 - apart * apart).sqrt();
                let corner = |i: u32| (TAU * f64::from(i) / f64::from(CORNERS)).sin_cos();
                let corners = (0..CORNERS).map(corner);
                corners.map(|(sin, cos)| [x + share * a * cos, y + share * b * sin]).collect()
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plane at three fifths of the radius meets a ball in a circle of four fifths.
    #[test]
    fn a_slice_of_a_ball_is_a_smaller_circle() {
        let sizes = ["x", "y", "z"].map(|name| (name.to_owned(), [1.0, 5.0]));
        let ball =
            Shape { shape: InscribedShape::Ball, sizes: sizes.clone().into(), text: String::new() };
        let line = ball.across(["x", "z"], [("y", 4.0)].into_iter()).expect("they meet");
        assert!(line.iter().all(|[x, z]| ((x - 1.0).hypot(z - 1.0) - 4.0).abs() < 1e-12));
        assert_eq!(ball.across(["x", "z"], [("y", 6.5)].into_iter()), None);
        assert_eq!(ball.across(["x", "psi"], [("y", 1.0)].into_iter()), None);
        let cuboid = Shape { shape: InscribedShape::Box, sizes: sizes.into(), text: String::new() };
        let line = cuboid.across(["x", "y"], [("z", 5.9)].into_iter()).expect("they meet");
        assert_eq!(line, [[-4.0, -4.0], [6.0, -4.0], [6.0, 6.0], [-4.0, 6.0]]);
    }
}
