//! The largest disc, ball or box inside a workspace, as slices show it.

use super::label::value_label;
use super::source::{Rate, Source};
use opm_study::recording::inscribed_of;
use opm_workspace::{Inscribed, InscribedShape};
use std::f64::consts::TAU;

/// Number of corners of the line that is drawn for a circle.
const CORNERS: u32 = 180;

/// The largest shape inside, and what is said about it.
pub struct Shape {
    found: Inscribed,
    /// Its name and numbers, in the units of the picture.
    pub text: String,
}

impl Shape {
    /// The shape that a recording has.
    pub fn of(source: &Source<'_>) -> Option<Self> {
        let found = inscribed_of(&source.metadata("result"))?;
        let shown = |i: usize, value: f64| {
            let name = &*found.names[i];
            let quantity = source.quantity_of(name);
            let (measure, factor) = source.measure(name, quantity, Rate::Position);
            format!("{} {}", value_label(value / factor), measure.unit.symbol)
        };
        let each = |text: &dyn Fn(usize) -> String| {
            (0..found.names.len()).map(text).collect::<Vec<_>>().join(", ")
        };
        let centre = each(&|i| format!("{} = {}", found.names[i], shown(i, found.centre[i])));
        let size = match found.shape {
            InscribedShape::Disc | InscribedShape::Ball => {
                format!("radius {}", shown(0, found.radii[0]))
            }
            InscribedShape::Box => {
                format!("sides {}", each(&|i| shown(i, 2.0 * found.radii[i])))
            }
        };
        let text = format!("{} inside: {size}, centre {centre}", found.shape.name());
        Some(Self { found, text })
    }

    /// The line where a plane of two coordinates meets the shape, with the other coordinates held; `None` where they do not
    /// meet, or where the shape is of other coordinates.
    pub fn across<'a>(
        &self,
        plane: [&str; 2],
        held: impl Iterator<Item = (&'a str, f64)>,
    ) -> Option<Vec<[f64; 2]>> {
        let Inscribed { shape, names, centre, radii, .. } = &self.found;
        let size = |name: &str| {
            let i = names.iter().position(|known| known == name)?;
            Some([centre[i], radii[i]])
        };
        let [[x, a], [y, b]] = [size(plane[0])?, size(plane[1])?];
        // The distance of the plane from the centre, as a share of the radius.
        let mut apart = 0.0_f64;
        let mut beyond = names.len() - 2;
        for (name, value) in held {
            if let Some([centre, radius]) = size(name) {
                apart = apart.hypot((value - centre) / radius);
                beyond -= 1;
            }
        }
        if apart > 1.0 || beyond > 0 {
            return None;
        }
        Some(match shape {
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
        let of = |shape: InscribedShape| Shape {
            found: Inscribed {
                shape,
                names: ["x", "y", "z"].map(str::to_owned).into(),
                centre: vec![1.0; 3],
                radii: vec![5.0; 3],
                error: vec![0.0; 3],
                at_edge: false,
            },
            text: String::new(),
        };
        let ball = of(InscribedShape::Ball);
        let line = ball.across(["x", "z"], [("y", 4.0)].into_iter()).expect("they meet");
        assert!(line.iter().all(|[x, z]| ((x - 1.0).hypot(z - 1.0) - 4.0).abs() < 1e-12));
        assert_eq!(ball.across(["x", "z"], [("y", 6.5)].into_iter()), None);
        assert_eq!(ball.across(["x", "psi"], [("y", 1.0)].into_iter()), None);
        let cuboid = of(InscribedShape::Box);
        let line = cuboid.across(["x", "y"], [("z", 5.9)].into_iter()).expect("they meet");
        assert_eq!(line, [[-4.0, -4.0], [6.0, -4.0], [6.0, 6.0], [-4.0, 6.0]]);
    }
}
