//! The largest disc, ball or box in a set of points of a grid.
//!
//! Each point stands for its cell: a box around it that is one step wide along every axis. What is found is inside the
//! union of the cells of the set; what is outside of the grid's cells is not in the set.
//!
//! A disc or ball is the largest in that union, to a share of 1e-9 of its radius. First the distance from the nearest cell
//! outside is found on the lattice of the cells' middles, corners, and middles of sides. There it is exact: of such a cell,
//! the point nearest to a point of the lattice is on the lattice too, and the distances of all of them are found axis by
//! axis (P. F. Felzenszwalb, D. P. Huttenlocher, *Distance Transforms of Sampled Functions*, Theory of Computing 8, 2012).
//! Then the centre is looked for between the points of the lattice that may be next to it.
//!
//! A box is inside the boundary that is drawn, too, which cuts the corners of cells and ends with the points of the grid: it
//! has sides half-way between points, or at points, and is as large as any of those.

mod cells;
mod centred;
mod distance;
mod rectangle;
mod search;

use crate::set::GridSet;
use cells::{Cells, CentreAndRadii};

/// Most points of the lattice, which take a GiB of memory.
const MOST: u64 = 1 << 27;

/// What is inscribed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InscribedShape {
    /// A disc, in a set that varies in two coordinates.
    Disc,
    /// A ball, in a set that varies in three coordinates.
    Ball,
    /// A box with its sides along the axes, in two coordinates or three.
    Box,
}

impl InscribedShape {
    /// Every shape.
    pub const ALL: [Self; 3] = [Self::Disc, Self::Ball, Self::Box];

    /// The name of the shape.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Disc => "disc",
            Self::Ball => "ball",
            Self::Box => "box",
        }
    }

    /// The shape of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|shape| shape.name() == name)
    }
}

/// Why nothing is inscribed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InscribedError {
    /// The set does not vary in as many coordinates as the shape.
    #[error(
        "a {} needs a set that varies in {}, but this one varies in {}",
        shape.name(),
        match shape {
            InscribedShape::Disc => "two coordinates",
            InscribedShape::Ball => "three coordinates",
            InscribedShape::Box => "two coordinates or three",
        },
        if varying.is_empty() { "none".to_owned() } else { varying.join(", ") }
    )]
    Coordinates {
        /// The shape.
        shape: InscribedShape,
        /// The names of the coordinates in which the set varies.
        varying: Vec<String>,
    },
    /// The lattice does not fit in memory.
    #[error("{given} points of its lattice, expected at most {most}; sweep a coarser grid")]
    Size {
        /// The number of points.
        given: u64,
        /// The largest number.
        most: u64,
    },
}

/// The largest shape in a set.
#[derive(Clone, Debug, PartialEq)]
pub struct Inscribed {
    /// The shape.
    pub shape: InscribedShape,
    /// The names of its coordinates.
    pub names: Vec<String>,
    /// The centre, radians and metres.
    pub centre: Vec<f64>,
    /// The radius along each coordinate, of a box half of each side; radians and metres.
    pub radii: Vec<f64>,
    /// How far the set's true boundary may be from the cells' sides: half of a cell's diagonal for a disc or a ball, half a
    /// step along each coordinate for a box. If the search for a disc or a ball had to end before its radius was known to
    /// 1e-9 of it, what may be missing is added.
    pub error: Vec<f64>,
    /// Whether it touches the edge of the grid, beyond which the set may go on.
    pub at_edge: bool,
}

impl Inscribed {
    /// Its area or volume, with the units of its coordinates multiplied.
    pub fn measure(&self) -> f64 {
        let product: f64 = self.radii.iter().product();
        match self.shape {
            InscribedShape::Disc => std::f64::consts::PI * product,
            InscribedShape::Ball => 4.0 / 3.0 * std::f64::consts::PI * product,
            InscribedShape::Box => product * 2_f64.powi(self.radii.len() as i32),
        }
    }
}

/// The largest shape in a set, with its centre free or given by one value for each coordinate in which the set varies.
/// `None` if the set is empty, or the given centre is not inside it. Of several that are equally large it is one, the same
/// each time.
///
/// # Errors
/// The set varies in too many coordinates or too few, or is too large.
///
/// ```
/// use opm_workspace::{Axis, GridSet, InscribedShape, SetAxis, inscribed};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let axis = |name: &str| SetAxis { axis: Axis::new(name, -1.0, 1.0, 201), circle: false };
/// let (x, y) = (axis("x"), axis("y"));
/// let ring = |number: u64| {
///     let [x, y] = [x.axis.value(number % 201), y.axis.value(number / 201)];
///     (0.2..=0.8).contains(&x.hypot(y))
/// };
/// let set = GridSet::of(vec![x.clone(), y.clone()], ring)?;
/// let disc = inscribed(&set, InscribedShape::Disc, None)?.ok_or("empty")?;
/// assert!((disc.radii[0] - 0.3).abs() <= disc.error[0]);
/// # Ok(())
/// # }
/// ```
pub fn inscribed(
    set: &GridSet,
    shape: InscribedShape,
    centre: Option<&[f64]>,
) -> Result<Option<Inscribed>, InscribedError> {
    let axes: Vec<_> = set.varying().into_iter().map(|i| set.axes()[i].axis.clone()).collect();
    let suits = match shape {
        InscribedShape::Disc => axes.len() == 2,
        InscribedShape::Ball => axes.len() == 3,
        InscribedShape::Box => (2..=3).contains(&axes.len()),
    };
    if !suits || centre.is_some_and(|centre| centre.len() != axes.len()) {
        let varying = axes.into_iter().map(|axis| axis.name).collect();
        return Err(InscribedError::Coordinates { shape, varying });
    }
    let lattice = axes.iter().map(|axis| 2 * axis.count + 1).product();
    if lattice > MOST {
        return Err(InscribedError::Size { given: lattice, most: MOST });
    }
    let cells = Cells::new(set, &axes);
    let exact = |found: Option<CentreAndRadii>| found.map(|found| (found, 0.0));
    let found = match (shape, centre) {
        (InscribedShape::Disc | InscribedShape::Ball, None) => distance::largest_ball(&cells),
        (InscribedShape::Disc | InscribedShape::Ball, Some(at)) => exact(centred::ball(&cells, at)),
        (InscribedShape::Box, None) => exact(rectangle::largest_box(&cells.halves())),
        (InscribedShape::Box, Some(at)) => exact(centred::cuboid(&cells.halves(), at)),
    };
    Ok(found.map(|((centre, radii), short)| {
        let half = cells.step.map(|step| 0.5 * step);
        let diagonal = half[..axes.len()].iter().map(|h| h * h).sum::<f64>().sqrt();
        let used = |values: [f64; 3]| values[..axes.len()].to_vec();
        let error = match shape {
            InscribedShape::Disc | InscribedShape::Ball => vec![diagonal + short; axes.len()],
            InscribedShape::Box => used(half),
        };
        let at_edge = cells.is_at_edge(centre, radii, axes.len());
        let names = axes.iter().map(|axis| axis.name.clone()).collect();
        Inscribed { shape, names, centre: used(centre), radii: used(radii), error, at_edge }
    }))
}

#[cfg(test)]
mod tests;
