//! The workspace as a body in three coordinates.

use crate::explorer::Explorer;
use crate::problem::Problems;
use crate::request::{Coordinates, Others};
use crate::session::Reply;
use crate::surface::{normals, surface};
use crate::workspace;
use opm_workspace::{Axis, Poses, Progress, Run};
use serde::Serialize;

/// Values along each coordinate where the others are those of the pose.
const VALUES: u64 = 61;

/// The answer to a body. The bytes are its surface: three 32-bit numbers for each corner, SI, then the normals at the
/// corners, outwards and of any length, and then three numbers of corners for each triangle.
#[derive(Serialize)]
struct Body {
    /// The points of the three coordinates that are inside, and all of them.
    inside: u64,
    points: u64,
    /// The poses that were decided.
    poses: u64,
    corners: usize,
    triangles: usize,
    /// The lowest and highest value of each coordinate in the grid, SI.
    ranges: [[f64; 2]; 3],
}

/// The points of three coordinates that are in reach, with the others at a pose or with any value of the fitted grid.
pub fn body(
    explorer: &Explorer,
    fitted: &[Axis],
    names: &[String; 3],
    others: Others,
    pose: &Coordinates,
    mode: Option<&str>,
) -> Result<Reply, Problems> {
    let place = |name: &String| {
        let place = fitted.iter().position(|axis| axis.name == *name);
        place.ok_or_else(|| Problems::one(format!("no coordinate {name:?} in the fitted grid")))
    };
    let [a, b, c] = [place(&names[0])?, place(&names[1])?, place(&names[2])?];
    if a == b || b == c || a == c {
        return Err(Problems::one("expected three different coordinates"));
    }
    let at = explorer.pose(pose)?;
    let axis = |(i, axis): (usize, &Axis)| match others {
        Others::Any => axis.clone(),
        Others::Pose if ![a, b, c].contains(&i) => Axis::fixed(&*axis.name, at[i]),
        Others::Pose if axis.count == 1 => axis.clone(),
        Others::Pose => Axis::new(&*axis.name, axis.min, axis.max, VALUES),
    };
    let axes = fitted.iter().enumerate().map(axis).collect();
    let workspace = workspace::grid(explorer, axes, mode)?;
    let grid = workspace.grid();
    let chosen = [a, b, c].map(|i| &grid.axes()[i]);
    let counts = chosen.map(|axis| axis.count as usize);
    let mut inside = vec![false; counts.iter().product()];
    // How far the number of a pose, and that of a point of the body, are from that of the next value of each coordinate.
    let strides = |i: usize| grid.axes()[..i].iter().map(|axis| axis.count).product::<u64>();
    let digits = [(a, 1), (b, counts[0]), (c, counts[0] * counts[1])]
        .map(|(i, stride)| (strides(i), grid.axes()[i].count, stride));
    // A row differs in the first coordinate of the grid.
    let along = [a, b, c].iter().position(|&i| i == 0).map_or(0, |i| digits[i].2);
    let mark = |run: Run| {
        let first: usize = digits
            .iter()
            .map(|&(stride, count, step)| (run.from / stride % count) as usize * step)
            .sum();
        match along {
            0 => inside[first] = true,
            _ => (0..(run.to - run.from) as usize).for_each(|i| inside[first + i * along] = true),
        }
    };
    let mut mark = mark;
    workspace
        .poses()
        .points(
            &Progress::default(),
            |hits, made: &mut Vec<Run>| made.extend(hits.numbers(grid)),
            Vec::new,
            |made| {
                made.into_iter().for_each(&mut mark);
                Ok(())
            },
        )
        .map_err(|error| Problems::of(&error))?;
    let made = surface(counts, &inside);
    let si = |corner: &[f32; 3]| -> [f32; 3] {
        std::array::from_fn(|i| {
            let Axis { min, max, count, .. } = *chosen[i];
            let step = if count > 1 { (max - min) / (count - 1) as f64 } else { 0.0 };
            (min + step * f64::from(corner[i])) as f32
        })
    };
    let corners: Vec<[f32; 3]> = made.corners.iter().map(si).collect();
    let normals = normals(&corners, &made.triangles);
    let vectors = corners.iter().chain(&normals).flatten().flat_map(|number| number.to_le_bytes());
    let triangles = made.triangles.iter().flatten().flat_map(|number| number.to_le_bytes());
    let body = Body {
        inside: inside.iter().filter(|&&inside| inside).count() as u64,
        points: inside.len() as u64,
        poses: grid.poses(),
        corners: corners.len(),
        triangles: made.triangles.len(),
        ranges: chosen.map(|axis| [axis.min, axis.max]),
    };
    Ok(Reply::with_bytes(&body, vectors.chain(triangles).collect()))
}
