//! Tiles: poses of a grid that differ in two coordinates, and boxes of parts of them.

use opm_core::enclosure::Side;
use opm_core::manipulator::Manipulator;
use opm_core::{Quantity, TaskCoordinate};
use std::ops::Range;

/// The least share by which boxes are wider than their poses are apart, for rounding.
const ROUNDING: f64 = 1e-15;

/// The poses of a tile: they differ in two coordinates.
#[derive(Clone, Copy)]
pub struct Tile<'t> {
    /// The numbers of these coordinates.
    pub axes: [usize; 2],
    /// The values of the first one along every row.
    pub first: &'t [f64],
    /// The value of the second one in each row; none, if there is one row and all poses share it.
    pub second: &'t [f64],
}

/// A part of a tile: some of its rows, and the same poses of each.
#[derive(Clone, Debug)]
pub struct TilePart {
    pub rows: Range<usize>,
    pub poses: Range<usize>,
}

impl TilePart {
    /// The number of its poses.
    pub fn len(&self) -> usize {
        self.rows.len() * self.poses.len()
    }

    /// The halves of a part with two poses or more whose box has half these lengths: across the longer one.
    pub fn halves(&self, [along, across]: [f64; 2]) -> [Self; 2] {
        let middle = |range: &Range<usize>| range.start + range.len() / 2;
        let (rows, poses) = (self.rows.clone(), self.poses.clone());
        if rows.len() < 2 || (poses.len() > 1 && along >= across) {
            let at = middle(&poses);
            [poses.start..at, at..poses.end].map(|poses| Self { rows: rows.clone(), poses })
        } else {
            let at = middle(&rows);
            [rows.start..at, at..rows.end].map(|rows| Self { rows, poses: poses.clone() })
        }
    }
}

/// The box of a part of a tile.
pub struct TileBox {
    /// A side for each coordinate.
    pub sides: Vec<Side>,
    /// For each coordinate, how much a unit of it counts, metres.
    weights: Vec<f64>,
}

impl TileBox {
    pub fn new(manipulator: &Manipulator) -> Self {
        let angle = manipulator.characteristic_length();
        let weight = |c: &TaskCoordinate| if c.quantity == Quantity::Length { 1.0 } else { angle };
        let weights = manipulator.task_coordinates().iter().map(weight).collect();
        Self { sides: Vec::new(), weights }
    }

    /// Takes the coordinates that all poses of a tile have from any of them.
    pub fn begin(&mut self, pose: &[f64]) {
        self.sides.clear();
        let side = |&middle: &f64| Side { middle, half: 0.0, half_turn: None };
        self.sides.extend(pose.iter().map(side));
    }

    /// Bounds a part of a tile; returns half of the lengths in both coordinates, metres.
    pub fn bound(&mut self, tile: &Tile<'_>, TilePart { rows, poses }: &TilePart) -> [f64; 2] {
        let mut set = |number: usize, values: &[f64]| {
            let ends = [values[0], values[values.len() - 1]];
            let middle = 0.5 * (ends[0] + ends[1]);
            let half = 0.5 * (ends[1] - ends[0]).abs();
            let rounding = ROUNDING * (ends[0].abs() + ends[1].abs());
            let half = if half > 0.0 { half + rounding } else { 0.0 };
            self.sides[number] = Side { middle, half, half_turn: None };
            half * self.weights[number]
        };
        let along = set(tile.axes[0], &tile.first[poses.clone()]);
        let across = match tile.second.get(rows.clone()) {
            Some(second) if !second.is_empty() => set(tile.axes[1], second),
            _ => 0.0,
        };
        [along, across]
    }
}
