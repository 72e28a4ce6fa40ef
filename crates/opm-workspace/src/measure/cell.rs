//! A box of a domain, by the splits that led to it.

use opm_core::enclosure::MOST;

/// Most splits along one axis: numbers of cells are 32 bits wide.
const DEEPEST: u8 = 32;

/// In place of the axis of a split: there is none.
const NO_SPLIT: u8 = u8::MAX;

/// A box: one of the domain's first ones, halved so many times along each axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// Number of the first box.
    pub(super) first: u32,
    /// How many times it was halved.
    depth: [u8; MOST],
    /// Which of the parts it is.
    number: [u32; MOST],
}

/// What is known of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Its measure is not less.
    pub lower: f64,
    /// Its measure is not more.
    pub upper: f64,
    /// The axis along which it is best split; `None` where it is decided or no split helps.
    pub split: Option<usize>,
}

impl Cell {
    /// Bytes that it is packed in.
    pub const BYTES: usize = 4 + 5 * MOST;

    pub(super) fn new(first: u32) -> Self {
        Self { first, depth: [0; MOST], number: [0; MOST] }
    }

    /// For another process.
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

    /// From another process.
    pub fn unpack(bytes: &[u8; Self::BYTES]) -> Self {
        let word = |at: usize| u32::from_le_bytes(std::array::from_fn(|i| bytes[at + i]));
        Self {
            first: word(0),
            depth: std::array::from_fn(|axis| bytes[4 + axis]),
            number: std::array::from_fn(|axis| word(4 + MOST + 4 * axis)),
        }
    }

    /// Whether it can be halved along an axis.
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

    /// Its part of the range from 0 to 1: where its middle is, and how far its ends are from there.
    pub(super) fn part(&self, axis: usize) -> [f64; 2] {
        let half = 0.5_f64.powi(i32::from(self.depth[axis]) + 1);
        [(2.0 * f64::from(self.number[axis]) + 1.0) * half, half]
    }
}

impl Bounds {
    /// Bytes that they are packed in.
    pub const BYTES: usize = 17;

    /// For another process, to the last bit.
    pub fn pack(&self) -> [u8; Self::BYTES] {
        let mut bytes = [NO_SPLIT; Self::BYTES];
        bytes[..8].copy_from_slice(&self.lower.to_le_bytes());
        bytes[8..16].copy_from_slice(&self.upper.to_le_bytes());
        if let Some(axis) = self.split {
            bytes[16] = axis as u8;
        }
        bytes
    }

    /// From another process.
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
