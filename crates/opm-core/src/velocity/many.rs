//! Condition numbers of many poses at once.
//!
//! Poses are solved in the blocks of [`Manipulator::inverse_many`], and every further step is a loop over the block, too:
//! each leg's rows of the Jacobian, their weights, the singular values. It is the arithmetic of
//! [`Manipulator::differentiate`] and [`Manipulator::conditioning`] without what nobody asks for here, and condition
//! numbers are equal to theirs to the bit. A block of branches of the legs is combined to working modes.

mod leg;
mod platform;

use super::condition::of_point;
use super::jacobian::Basis;
use super::weighted::{Metric, Weighted};
use crate::chain::Chain;
use crate::manipulator::batch::Batch;
use crate::manipulator::batch::lanes::{Column, LANES, Lanes, Mask};
use crate::manipulator::{Choices, LARGEST, Manipulator, Mode};
use leg::{BranchRows, LegRows, RowJoint, locked};
use nalgebra::Vector3;
use platform::PlatformColumns;
use pulp::{Simd, WithSimd};
use std::ops::Range;

/// What [`Manipulator::condition_many`] is asked for.
#[derive(Clone, Copy, Debug)]
pub struct ConditionQuery {
    /// The working mode; `None` for any.
    pub mode: Option<Mode>,
    /// The characteristic length, metres.
    pub length: f64,
    /// The largest condition number that is admitted.
    pub most: f64,
    /// Whether imaginary joints are asked for in every admitted mode.
    pub every: bool,
}

/// Working memory of [`Manipulator::condition_many`]; made by [`Manipulator::condition_batch`].
#[derive(Clone, Debug)]
pub struct ConditionBatch {
    batch: Batch,
    work: Box<Work>,
}

/// The results of a block, and what leads to them.
#[derive(Clone, Debug)]
struct Work {
    /// Whether all steps are straight-line arithmetic for this mechanism.
    applies: bool,
    basis: Basis,
    platform: PlatformColumns,
    leg: LegRows,
    /// The leg of each actuated joint, and the number of its row there.
    places: Vec<(usize, usize)>,
    /// The same for the joints that constraining legs lack.
    locked: Vec<(usize, usize)>,
    /// The branches of every leg that reach any pose of the block within the leg's limits.
    branches: Vec<Vec<BranchRows>>,
    /// The number of those of each leg that are of the present block.
    counts: Vec<usize>,
    /// The present one of each leg.
    choice: Vec<usize>,
    /// Whether a pose has to be decided by itself.
    open: Mask,
    /// The condition number in the first mode that is admitted; NaN where there is none.
    conditions: Column,
    /// The least and the largest value of every imaginary joint in admitted modes.
    ranges: Vec<[f64; 2]>,
}

impl Manipulator {
    /// Working memory for [`Manipulator::condition_many`].
    pub fn condition_batch(&self) -> ConditionBatch {
        let basis = Basis::new(self.task(), &self.mechanism().platform);
        let freedoms = basis.in_base.len();
        // The rates of a spherical joint are those of its rotation vector, which has no straight-line arithmetic.
        let drives_ball = self.legs.iter().any(|leg| {
            [&leg.lower, &leg.upper]
                .iter()
                .any(|section| matches!(section.chain, Chain::Ball(_)) && section.driven)
        });
        let place = |joint: RowJoint, mut legs: Range<usize>| {
            legs.find_map(|leg| {
                let rows = BranchRows::new(self, leg).rows;
                Some((leg, rows.iter().position(|row| row.joint == joint)?))
            })
        };
        let actuated = self.actuated().iter().map(|&coordinate| RowJoint::Actuated(coordinate));
        ConditionBatch {
            batch: self.batch(),
            work: Box::new(Work {
                applies: self.decides_many() && !drives_ball,
                leg: LegRows::new(self, &basis),
                basis,
                platform: PlatformColumns::new(freedoms),
                places: actuated.filter_map(|joint| place(joint, 0..self.legs.len())).collect(),
                locked: locked(self)
                    .filter_map(|(leg, joint)| place(joint, leg..leg + 1))
                    .collect(),
                branches: vec![Vec::new(); self.legs.len()],
                counts: vec![0; self.legs.len()],
                choice: vec![0; self.legs.len()],
                open: Lanes::all(0),
                conditions: Lanes::all(f64::NAN),
                ranges: vec![[f64::INFINITY, f64::NEG_INFINITY]; self.imaginary().len()],
            }),
        }
    }

    /// Finds the condition numbers of some poses, row after row, each in the first working mode, all-plus first, in which
    /// the pose is in reach within all joint limits and no worse conditioned than asked for; NaN where there is no such
    /// mode. `used` is called with the number of an imaginary joint and the least and the largest of its values in all such
    /// modes, if [`ConditionQuery::every`] of them is asked for.
    ///
    /// Returns a bit for each pose, set where it is not decided, and has to be asked for by itself.
    ///
    /// # Panics
    /// If there are more answers than [`AT_ONCE`](crate::reach::AT_ONCE), or fewer poses than answers.
    ///
    /// ```
    /// use opm_core::Manipulator;
    /// use opm_core::velocity::ConditionQuery;
    ///
    /// let manipulator = Manipulator::example("plano-spherical-5dof")?;
    /// let (mode, length) = (Some(manipulator.home_mode()), manipulator.characteristic_length());
    /// let query = ConditionQuery { mode, length, most: 1e6, every: false };
    /// let poses = [0.01, 0.0, 0.0, 0.26, 0.0, /* out of reach: */ 9.0, 0.0, 0.0, 0.26, 0.0];
    /// let (mut batch, mut found) = (manipulator.condition_batch(), [0.0; 2]);
    /// let open = manipulator.condition_many(&poses, &query, &mut batch, &mut found, &mut |_, _| {});
    /// assert_eq!(open & 0b11, 0); // both poses are decided
    /// assert!(found[0] >= 1.0 && found[1].is_nan());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn condition_many(
        &self,
        poses: &[f64],
        query: &ConditionQuery,
        batch: &mut ConditionBatch,
        conditions: &mut [f64],
        used: &mut dyn FnMut(usize, [f64; 2]),
    ) -> u64 {
        let count = conditions.len();
        let ConditionBatch { batch, work } = batch;
        // Each mode has dependent coordinates of its own.
        if !work.applies || self.dependent.is_some() && query.mode.is_none() {
            return self.leave_reached(poses, query.mode, batch, conditions);
        }
        if count == 0 {
            return u64::MAX;
        }
        let arch = batch.arch;
        batch.block.take(self, poses);
        if let Some(mode) = query.mode {
            self.complete_block(mode, arch, &mut batch.block);
        }
        batch.block.displace(self, arch);
        arch.dispatch(Conditions { manipulator: self, query, count, batch, work });
        conditions.copy_from_slice(&work.conditions[..count]);
        for (number, &range) in work.ranges.iter().enumerate() {
            if range[0] <= range[1] {
                used(number, range);
            }
        }
        work.open.iter().rev().fold(0, |bits, open| bits << 1 | open)
    }
}

impl Manipulator {
    /// Finds the poses that are out of reach, which have no condition number. Returns a bit for each pose, set for the other
    /// ones.
    fn leave_reached(
        &self,
        poses: &[f64],
        mode: Option<Mode>,
        batch: &mut Batch,
        conditions: &mut [f64],
    ) -> u64 {
        let fits = |value: &f64| value.abs() <= LARGEST;
        if !(self.decides_many() && poses.iter().all(fits)) {
            return u64::MAX;
        }
        let mut reached = [false; LANES];
        let reached = &mut reached[..conditions.len()];
        self.reach().decide_many(poses, mode, batch, reached, &mut |_, _| {});
        conditions.fill(f64::NAN);
        reached.iter().rev().fold(0, |bits, &reached| bits << 1 | u64::from(reached))
    }
}

/// Finds the condition numbers of a block with the instructions of the processor at hand.
struct Conditions<'a> {
    manipulator: &'a Manipulator,
    query: &'a ConditionQuery,
    /// The number of poses.
    count: usize,
    batch: &'a mut Batch,
    work: &'a mut Work,
}

impl WithSimd for Conditions<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) {
        self.work.conditions = Lanes::all(f64::NAN);
        self.work.ranges.fill([f64::INFINITY, f64::NEG_INFINITY]);
        if !self.solve() {
            return;
        }
        // Several vectors together hide how long an operation takes, and their matrices fit into the fastest memory. Where
        // vectors are short, more poses would only be more code.
        if S::F64_LANES >= 4 && self.work.locked.is_empty() {
            self.combine_all::<16, false>();
        } else {
            self.combine_few();
        }
    }
}

impl Conditions<'_> {
    /// Solves every branch of every leg. Returns whether each leg has one that reaches any pose.
    #[inline(always)]
    fn solve(&mut self) -> bool {
        let Self { manipulator, query, batch, work, .. } = self;
        let choices = query.mode.map_or_else(Choices::default, Choices::of);
        let (block, arch) = (&mut *batch.block, batch.arch);
        work.open = block.status.open;
        for column in &block.pose {
            for (open, value) in work.open.iter_mut().zip(column) {
                let fits = value.abs() <= LARGEST;
                *open |= u64::from(!fits);
            }
        }
        let mut possible = block.status.within_limits;
        for (possible, beyond) in possible.iter_mut().zip(&block.status.beyond) {
            *possible &= beyond ^ 1;
        }
        work.platform.find(manipulator, &work.basis, block);
        work.leg.begin(manipulator, &work.basis, block);
        let mut all = true;
        for number in 0..manipulator.legs.len() {
            let mut found = 0;
            for branches in manipulator.branches_of(choices, number) {
                block.reach(manipulator, number, branches, arch);
                let mut reaches = block.status.reaches(&mut work.open);
                for lane in 0..LANES {
                    reaches[lane] &= possible[lane];
                }
                if reaches.iter().all(|&reaches| reaches == 0) {
                    continue;
                }
                let of_leg = &mut work.branches[number];
                if found == of_leg.len() {
                    of_leg.push(BranchRows::new(manipulator, number));
                }
                of_leg[found].reaches = reaches;
                work.leg.differentiate(manipulator, number, block, &mut of_leg[found]);
                found += 1;
            }
            work.counts[number] = found;
            all &= found > 0;
        }
        all
    }

    /// [`Self::combine_all`] where vectors are short, or where constraining legs lack joints.
    // Inlined, it would be compiled for every set of instructions.
    #[inline(never)]
    fn combine_few(&mut self) {
        self.combine_all::<4, true>();
    }

    /// Combines the branches to working modes, with singular values of `L` poses computed together.
    #[inline(always)]
    fn combine_all<const L: usize, const RESTRICTED: bool>(&mut self) {
        // With a constant number of freedoms, loops over the components are none.
        match self.work.basis.in_base.len() {
            1 => self.combine::<1, L, RESTRICTED>(),
            2 => self.combine::<2, L, RESTRICTED>(),
            3 => self.combine::<3, L, RESTRICTED>(),
            4 => self.combine::<4, L, RESTRICTED>(),
            5 => self.combine::<5, L, RESTRICTED>(),
            _ => self.combine::<6, L, RESTRICTED>(),
        }
    }

    /// Combines the branches to working modes, all-plus first, for a platform with `N` freedoms.
    #[inline(always)]
    fn combine<const N: usize, const L: usize, const RESTRICTED: bool>(&mut self) {
        let scale = self.query.length.recip();
        let mut metric = None;
        for start in (0..self.count).step_by(L) {
            // The platform's twist depends on the upper section alone; which motions a leg lets it make, on the branch.
            if RESTRICTED && let Some(offset) = &self.manipulator.judged_at {
                self.combine_by_point::<N, L>(start, offset, scale);
                continue;
            }
            if metric.is_none() || !self.batch.block.one_upper() {
                let Work { platform, basis, .. } = &*self.work;
                metric = Some(Metric::new(&platform.chunk::<N, L>(basis, start), scale));
            }
            let metric = metric.as_ref().expect("that of the first chunk, at least");
            self.work.choice.fill(0);
            loop {
                let (mask, any) = self.asked::<L>(start);
                if any {
                    // Without joints that legs lack, every loop has a constant length.
                    let locked = if RESTRICTED { &*self.work.locked } else { &[] };
                    let found = self.conditions(metric, start, locked);
                    self.admit(start, &mask, &found);
                }
                if !self.work.choose_next() {
                    break;
                }
            }
        }
    }

    /// Combines the branches of a chunk where the velocity of a point stands for the platform's twist.
    #[inline(always)]
    fn combine_by_point<const N: usize, const L: usize>(
        &mut self,
        start: usize,
        offset: &Vector3<f64>,
        scale: f64,
    ) {
        self.work.choice.fill(0);
        loop {
            let (mask, any) = self.asked::<L>(start);
            if any {
                let Work { platform, basis, locked, .. } = &*self.work;
                let mut twists = platform.chunk::<N, L>(basis, start);
                of_point(&mut twists, offset, &self.rates_of(&locked[0], start), scale);
                let found = self.conditions(&Metric::new(&twists, scale), start, locked);
                self.admit(start, &mask, &found);
            }
            if !self.work.choose_next() {
                break;
            }
        }
    }

    /// The rates of a row in the present mode, for each component of the section twist.
    #[inline(always)]
    fn rates_of<const N: usize, const L: usize>(
        &self,
        &(leg, row): &(usize, usize),
        start: usize,
    ) -> [[f64; L]; N] {
        let Work { branches, choice, .. } = &*self.work;
        let found = &branches[leg][choice[leg]].rows[row].rates;
        let mut rates = [[0.0; L]; N];
        for (rates, found) in rates.iter_mut().zip(found) {
            rates.copy_from_slice(&found[start..start + L]);
        }
        rates
    }

    /// Which poses of a chunk the present mode reaches that are still asked for, and whether there are any.
    #[inline(always)]
    fn asked<const L: usize>(&self, start: usize) -> ([u64; L], bool) {
        let Work { branches, choice, open, conditions, .. } = &*self.work;
        let mut mask = [0; L];
        for (i, mask) in mask.iter_mut().enumerate() {
            let decided = !self.query.every && !conditions[start + i].is_nan();
            *mask = u64::from(start + i < self.count && !decided) & (open[start + i] ^ 1);
        }
        for (of_leg, &choice) in branches.iter().zip(choice) {
            for (i, mask) in mask.iter_mut().enumerate() {
                *mask &= of_leg[choice].reaches[start + i];
            }
        }
        (mask, mask.iter().any(|&mask| mask != 0))
    }

    /// The condition numbers of a chunk in the present mode. Of the joints that constraining legs lack, the legs and the
    /// numbers of their rows are given.
    #[inline(always)]
    fn conditions<const N: usize, const L: usize>(
        &self,
        metric: &Metric<N, L>,
        start: usize,
        locked: &[(usize, usize)],
    ) -> [f64; L] {
        let Work { branches, choice, places, .. } = &*self.work;
        let rates_of = |place: &(usize, usize)| self.rates_of(place, start);
        let mut weighted = Weighted::new(metric);
        for (&coordinate, place) in self.manipulator.actuated().iter().zip(places) {
            weighted.push(rates_of(place), self.manipulator.coordinates()[coordinate].quantity);
        }
        let found = weighted.conditioning(locked.iter().map(rates_of));
        let mut serial = [0; L];
        for (of_leg, &choice) in branches.iter().zip(choice) {
            for (i, serial) in serial.iter_mut().enumerate() {
                *serial |= of_leg[choice].serial[start + i];
            }
        }
        std::array::from_fn(|i| if serial[i] == 0 { found[i].condition } else { f64::INFINITY })
    }

    /// Takes the condition numbers of the asked poses of a chunk that are small enough.
    #[inline(always)]
    fn admit<const L: usize>(&mut self, start: usize, asked: &[u64; L], found: &[f64; L]) {
        let Work { branches, choice, conditions, ranges, .. } = &mut *self.work;
        let admitted: [bool; L] =
            std::array::from_fn(|i| asked[i] != 0 && found[i] <= self.query.most);
        for i in 0..L {
            let first = admitted[i] && conditions[start + i].is_nan();
            conditions[start + i] = if first { found[i] } else { conditions[start + i] };
        }
        if !self.query.every {
            return;
        }
        for (of_leg, &choice) in branches.iter().zip(&*choice) {
            let Some((number, values)) = &of_leg[choice].imaginary else { continue };
            let range = &mut ranges[*number];
            for i in (0..L).filter(|&i| admitted[i]) {
                let value = values[start + i];
                *range = [range[0].min(value), range[1].max(value)];
            }
        }
    }
}

impl Work {
    /// Goes on to the next combination of branches, the first leg's fastest. Returns whether there is one.
    #[inline(always)]
    fn choose_next(&mut self) -> bool {
        for (choice, &count) in self.choice.iter_mut().zip(&self.counts) {
            *choice += 1;
            if *choice < count {
                return true;
            }
            *choice = 0;
        }
        false
    }
}
