//! Columns of numbers, one for each pose of a block, so that one loop works on all poses.

use crate::chain::Branch;
use crate::group::{CylindricalDisplacement, JointDisplacement, PlanarDisplacement};
use crate::manipulator::leg::LegBranches;
use crate::mechanism::leg::Section;
use nalgebra::{Complex, Matrix3, Vector3};
use std::ops::{Deref, DerefMut};
use std::slice;

/// The number of poses in a block.
pub const LANES: usize = 64;

/// So many lanes, and some more, so that they are whole vectors of every processor.
#[inline(always)]
pub fn vectors(lanes: usize) -> usize {
    lanes.next_multiple_of(8).min(LANES)
}

/// One value for each pose. They begin at a line of the cache: a vector that reaches over two lines takes longer to read and
/// to write.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Lanes<T>(pub [T; LANES]);

impl<T: Copy> Lanes<T> {
    /// The same value for all poses.
    #[inline(always)]
    pub const fn all(value: T) -> Self {
        Self([value; LANES])
    }
}

impl<T> Deref for Lanes<T> {
    type Target = [T; LANES];

    #[inline(always)]
    fn deref(&self) -> &[T; LANES] {
        &self.0
    }
}

impl<T> DerefMut for Lanes<T> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [T; LANES] {
        &mut self.0
    }
}

impl<'a, T> IntoIterator for &'a Lanes<T> {
    type Item = &'a T;
    type IntoIter = slice::Iter<'a, T>;

    #[inline(always)]
    fn into_iter(self) -> slice::Iter<'a, T> {
        self.0.iter()
    }
}

impl<'a, T> IntoIterator for &'a mut Lanes<T> {
    type Item = &'a mut T;
    type IntoIter = slice::IterMut<'a, T>;

    #[inline(always)]
    fn into_iter(self) -> slice::IterMut<'a, T> {
        self.0.iter_mut()
    }
}

/// One number for each pose.
pub type Column = Lanes<f64>;

/// Zero or one for each pose. It is as wide as the numbers it is computed from, so that loops need no
/// packing.
pub type Mask = Lanes<u64>;

/// The branch of a chain for each pose.
pub type Branches = [Branch; LANES];

/// One displacement for each pose, in as many of the columns as it has numbers.
pub type Displacements = [Column; 9];

/// A displacement that can be stored in columns.
pub trait Lane {
    /// The displacement of pose number `lane`.
    fn load(from: &Displacements, lane: usize) -> Self;
    /// Stores the displacement of pose number `lane`.
    fn store(&self, to: &mut Displacements, lane: usize);
}

impl Lane for Complex<f64> {
    #[inline(always)]
    fn load(from: &Displacements, lane: usize) -> Self {
        Self::new(from[0][lane], from[1][lane])
    }

    #[inline(always)]
    fn store(&self, to: &mut Displacements, lane: usize) {
        (to[0][lane], to[1][lane]) = (self.re, self.im);
    }
}

impl Lane for Vector3<f64> {
    #[inline(always)]
    fn load(from: &Displacements, lane: usize) -> Self {
        Self::new(from[0][lane], from[1][lane], from[2][lane])
    }

    #[inline(always)]
    fn store(&self, to: &mut Displacements, lane: usize) {
        (to[0][lane], to[1][lane], to[2][lane]) = (self.x, self.y, self.z);
    }
}

impl Lane for PlanarDisplacement {
    #[inline(always)]
    fn load(from: &Displacements, lane: usize) -> Self {
        Self {
            rotation: Complex::new(from[0][lane], from[1][lane]),
            translation: Complex::new(from[2][lane], from[3][lane]),
        }
    }

    #[inline(always)]
    fn store(&self, to: &mut Displacements, lane: usize) {
        (to[0][lane], to[1][lane]) = (self.rotation.re, self.rotation.im);
        (to[2][lane], to[3][lane]) = (self.translation.re, self.translation.im);
    }
}

impl Lane for CylindricalDisplacement {
    #[inline(always)]
    fn load(from: &Displacements, lane: usize) -> Self {
        Self { angle: from[0][lane], advance: from[1][lane] }
    }

    #[inline(always)]
    fn store(&self, to: &mut Displacements, lane: usize) {
        (to[0][lane], to[1][lane]) = (self.angle, self.advance);
    }
}

impl Lane for Matrix3<f64> {
    #[inline(always)]
    fn load(from: &Displacements, lane: usize) -> Self {
        let at = |number: usize| from[number][lane];
        Self::new(at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7), at(8))
    }

    #[inline(always)]
    fn store(&self, to: &mut Displacements, lane: usize) {
        (to[0][lane], to[1][lane], to[2][lane]) = (self.m11, self.m12, self.m13);
        (to[3][lane], to[4][lane], to[5][lane]) = (self.m21, self.m22, self.m23);
        (to[6][lane], to[7][lane], to[8][lane]) = (self.m31, self.m32, self.m33);
    }
}

/// Repeats the first value of every column for all poses.
#[inline(always)]
pub fn repeat(columns: &mut [Column]) {
    for column in columns {
        *column = Lanes::all(column[0]);
    }
}

/// The branches of a leg's two chains for each pose.
#[derive(Clone, Copy, Debug)]
pub struct BranchesOfLeg {
    pub lower: Branches,
    pub upper: Branches,
}

impl BranchesOfLeg {
    /// The same branches for all poses.
    #[inline(always)]
    pub fn repeated(LegBranches { lower, upper }: LegBranches) -> Self {
        Self { lower: [lower; LANES], upper: [upper; LANES] }
    }

    /// The branches for poses that have one each. The remaining lanes get the last one.
    #[inline(always)]
    pub fn of_each(mut branches: impl Iterator<Item = LegBranches>) -> Self {
        let mut last = LegBranches { lower: Branch::Plus, upper: Branch::Plus };
        let mut of_leg = Self::repeated(last);
        for lane in 0..LANES {
            last = branches.next().unwrap_or(last);
            (of_leg.lower[lane], of_leg.upper[lane]) = (last.lower, last.upper);
        }
        of_leg
    }

    /// Whether the upper chain has the same branch for so many poses.
    #[inline(always)]
    pub fn one_upper(&self, lanes: usize) -> bool {
        self.upper[..lanes.min(LANES)].iter().all(|branch| *branch == self.upper[0])
    }

    /// The branches of a section's chain.
    #[inline(always)]
    pub fn of(&self, section: Section) -> &Branches {
        match section {
            Section::Lower => &self.lower,
            Section::Upper => &self.upper,
        }
    }
}

/// One joint displacement for each pose, all of the same variant.
#[derive(Clone, Debug)]
pub struct DisplacementColumns {
    /// Whether they are directions; otherwise they are values.
    pub are_directions: bool,
    /// The two components of directions, or values in the first column; the second one is then not valid.
    columns: [Column; 2],
}

impl DisplacementColumns {
    pub fn new() -> Self {
        Self { are_directions: false, columns: [Lanes::all(0.0); 2] }
    }

    /// Sets every displacement to zero.
    #[inline(always)]
    pub fn clear(&mut self) {
        self.are_directions = false;
        self.columns[0] = Lanes::all(0.0);
    }

    /// Repeats the first one for all poses.
    #[inline(always)]
    pub fn repeat(&mut self) {
        repeat(&mut self.columns);
    }

    /// The displacement of pose number `lane`.
    #[inline(always)]
    pub fn get(&self, lane: usize) -> JointDisplacement {
        if self.are_directions { self.direction(lane) } else { self.value(lane) }
    }

    /// The displacement of pose number `lane`, which must be a direction.
    #[inline(always)]
    pub fn direction(&self, lane: usize) -> JointDisplacement {
        JointDisplacement::Direction(Complex::new(self.columns[0][lane], self.columns[1][lane]))
    }

    /// The displacement of pose number `lane`, which must be a value.
    #[inline(always)]
    pub fn value(&self, lane: usize) -> JointDisplacement {
        JointDisplacement::Value(self.columns[0][lane])
    }

    /// Stores a displacement of the variant that `are_directions` tells.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, displacement: JointDisplacement) {
        match displacement {
            JointDisplacement::Direction(e) => {
                (self.columns[0][lane], self.columns[1][lane]) = (e.re, e.im);
            }
            JointDisplacement::Value(value) => self.columns[0][lane] = value,
        }
    }
}
