//! A box of a domain, by the splits that led to it.

use opm_core::enclosure::MOST;

/// Most splits along one axis: numbers of cells are 32 bits wide.
const DEEPEST: u8 = 32;

/// A box: one of the domain's first ones, halved so many times along each axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// Number of the first box.
    pub first: u32,
    /// How many times it was halved.
    pub depth: [u8; MOST],
    /// Which of the parts it is.
    pub number: [u32; MOST],
}

/// What is known of a cell.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    pub cell: Cell,
    /// Its measure is not less.
    pub lower: f64,
    /// Its measure is not more.
    pub upper: f64,
    /// The axis along which it is best split; `None` where it is decided or no split helps.
    pub split: Option<usize>,
}

impl Cell {
    pub fn new(first: u32) -> Self {
        Self { first, depth: [0; MOST], number: [0; MOST] }
    }

    /// Whether it can be halved along an axis.
    pub fn splits(&self, axis: usize) -> bool {
        self.depth[axis] < DEEPEST
    }

    pub fn halves(self, axis: usize) -> [Self; 2] {
        [0, 1].map(|half| {
            let mut cell = self;
            cell.depth[axis] += 1;
            cell.number[axis] = 2 * self.number[axis] + half;
            cell
        })
    }

    /// Its part of the range from 0 to 1: where its middle is, and how far its ends are from there.
    pub fn part(&self, axis: usize) -> [f64; 2] {
        let half = 0.5_f64.powi(i32::from(self.depth[axis]) + 1);
        [(2.0 * f64::from(self.number[axis]) + 1.0) * half, half]
    }
}
