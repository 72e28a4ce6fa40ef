//! A box of a domain, by the splits that led to it.

use opm_core::enclosure::MOST;

/// Most splits along one axis: the numbers of cells have 32 bits.
const DEEPEST: u8 = 32;

/// Stands for no split, in place of its axis.
const NO_SPLIT: u8 = u8::MAX;

/// A box of a domain: one of the domain's first boxes, halved a number of times along each axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// The number of the first box.
    pub(super) first: u32,
    /// How many times it was halved along each axis.
    depth: [u8; MOST],
    /// The number of the part along each axis.
    number: [u32; MOST],
}

/// How much of a cell is in the workspace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The lower bound of the measure.
    pub lower: f64,
    /// The upper bound of the measure.
    pub upper: f64,
    /// The axis along which the cell is best split; `None` if it is decided or no split helps. Axes with a
    /// width are counted, in their order.
    pub split: Option<usize>,
}

impl Cell {
    /// The number of bytes of a packed cell.
    pub const BYTES: usize = 4 + 5 * MOST;

    pub(super) fn new(first: u32) -> Self {
        Self { first, depth: [0; MOST], number: [0; MOST] }
    }

    /// The cell as bytes, for another process.
    pub fn pack(&self) -> [u8; Self::BYTES] {
        let mut bytes = [0; Self::BYTES];
        let (first, rest) = bytes.split_at_mut(4);
        let (depth, number) = rest.split_at_mut(MOST);
        first.copy_from_slice(&self.first.to_le_bytes());
        depth.copy_from_slice(&self.depth);
        for (bytes, number) in number.chunks_exact_mut(4).zip(self.number) {
            bytes.copy_from_slice(&number.to_le_bytes());
        }
        bytes
    }

    /// The cell from bytes of another process.
    pub fn unpack(bytes: &[u8; Self::BYTES]) -> Self {
        let word = |at: usize| u32::from_le_bytes(std::array::from_fn(|i| bytes[at + i]));
        Self {
            first: word(0),
            depth: std::array::from_fn(|axis| bytes[4 + axis]),
            number: std::array::from_fn(|axis| word(4 + MOST + 4 * axis)),
        }
    }

    /// Whether the cell can be halved along an axis.
    pub(super) fn splits(&self, axis: usize) -> bool {
        self.depth[axis] < DEEPEST
    }

    pub(super) fn halves(self, axis: usize) -> [Self; 2] {
        [0, 1].map(|half| {
            let mut cell = self;
            cell.depth[axis] += 1;
            cell.number[axis] = 2 * self.number[axis] + half;
            cell
        })
    }

    /// The part of the range from 0 to 1 that it has along an axis: its middle, and half its width.
    pub(super) fn part(&self, axis: usize) -> [f64; 2] {
        let half = 0.5_f64.powi(i32::from(self.depth[axis]) + 1);
        [(2.0 * f64::from(self.number[axis]) + 1.0) * half, half]
    }
}

impl Bounds {
    /// The number of bytes of packed bounds.
    pub const BYTES: usize = 17;

    /// The bounds as bytes, for another process, to the last bit.
    pub fn pack(&self) -> [u8; Self::BYTES] {
        let mut bytes = [NO_SPLIT; Self::BYTES];
        bytes[..8].copy_from_slice(&self.lower.to_le_bytes());
        bytes[8..16].copy_from_slice(&self.upper.to_le_bytes());
        if let Some(axis) = self.split {
            bytes[16] = axis as u8;
        }
        bytes
    }

    /// The bounds from bytes of another process.
    pub fn unpack(bytes: &[u8; Self::BYTES]) -> Self {
        let number = |at: usize| f64::from_le_bytes(std::array::from_fn(|i| bytes[at + i]));
        let split = (bytes[16] != NO_SPLIT).then_some(usize::from(bytes[16]));
        Self { lower: number(0), upper: number(8), split }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_packed_is_what_is_unpacked() {
        let mut cell = Cell::new(0x0102_0304);
        for axis in [0, 3, 3, MOST - 1, 0, 3] {
            cell = cell.halves(axis)[1];
        }
        assert_eq!(Cell::unpack(&cell.pack()), cell);
        for split in [None, Some(0), Some(MOST - 1)] {
            let bounds = Bounds { lower: -0.1 + 0.3, upper: 1e-300, split };
            assert_eq!(Bounds::unpack(&bounds.pack()), bounds);
        }
    }
}
