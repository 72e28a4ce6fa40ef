//! Branch and bound for the place that is farthest from all cells outside.
//!
//! The distance from a cell is convex, and nowhere more curved than one over itself, so that its tangent bounds it on a
//! box of places with a small term on top. Any mean of such bounds bounds the least distance, and that with the least largest
//! value is looked for by mixing them one by one. So whole stretches half-way between two sides are done with at once.

use super::cells::Cells;

/// How near the largest radius is found, as a share of it.
const TOLERANCE: f64 = 1e-9;
/// Most boxes of places that are looked at; then what is left is said.
const MOST: u64 = 1 << 22;
/// Bounds that are mixed into a mean.
const STEPS: usize = 8;

/// The place that is farthest, so far.
#[derive(Clone, Copy)]
pub(super) struct Best {
    /// The place.
    pub centre: [f64; 3],
    /// Its distance from the nearest cell outside.
    pub radius: f64,
}

/// The lowest and the highest side of what is outside, along each axis.
type Obstacle = [[f64; 2]; 3];

/// A bound of the distance from an obstacle: its value in the middle of a box of places, and its slope.
#[derive(Clone, Copy)]
struct Bound {
    value: f64,
    slope: [f64; 3],
}

/// The search, and what it has found.
pub(super) struct Search<'a> {
    cells: &'a Cells,
    dimension: usize,
    /// Half of the box of places around a point of the lattice.
    half: [f64; 3],
    /// The best place.
    pub best: Best,
    /// By how much its radius may be too small; zero if it is as near as it should be.
    pub short: f64,
    boxes: u64,
}

impl<'a> Search<'a> {
    pub fn new(cells: &'a Cells, best: Best) -> Self {
        let dimension = cells.dimension();
        let half = std::array::from_fn(|i| if i < dimension { 0.25 * cells.step[i] } else { 0.0 });
        Self { cells, dimension, half, best, short: 0.0, boxes: 0 }
    }

    /// The least radius that would be better.
    fn worth(&self) -> f64 {
        self.best.radius * (1.0 + TOLERANCE)
    }

    /// Whether a better centre may be near a point of the lattice at this distance.
    pub fn may_hold(&self, distance: f64) -> bool {
        distance + norm(self.half) > self.worth()
    }

    /// Looks for a better centre around a point of the lattice at this distance.
    pub fn around(&mut self, point: [f64; 3], distance: f64) {
        if self.may_hold(distance) {
            let near = self.near(point, distance + 2.0 * norm(self.half));
            self.look(point, self.half, &near);
        }
    }

    /// What is outside within a distance from a place.
    fn near(&self, place: [f64; 3], reach: f64) -> Vec<Obstacle> {
        let (cells, everywhere) = (self.cells, [f64::NEG_INFINITY, f64::INFINITY]);
        let mut found = Vec::new();
        for axis in 0..self.dimension {
            let [low, high] = cells.ends[axis];
            for (near, sides) in [
                (place[axis] - low <= reach, [f64::NEG_INFINITY, low]),
                (high - place[axis] <= reach, [high, f64::INFINITY]),
            ] {
                let mut obstacle = [everywhere; 3];
                obstacle[axis] = sides;
                found.extend(near.then_some(obstacle));
            }
        }
        let [x, y, z] = [0, 1, 2].map(|axis| {
            let within = |&cell: &usize| cells.gap(axis, place[axis], cell) <= reach;
            let mut range = (0..cells.counts[axis]).filter(within);
            range.next().map_or(0..0, |first| first..range.next_back().unwrap_or(first) + 1)
        });
        for k in z {
            for j in y.clone() {
                for cell in x.clone().map(|i| [i, j, k]).filter(|&cell| !cells.has(cell)) {
                    let obstacle = [0, 1, 2].map(|axis| cells.sides(axis, cell[axis]));
                    if norm(gaps(&obstacle, place)) <= reach {
                        found.push(obstacle);
                    }
                }
            }
        }
        found
    }

    /// Looks for a better centre in a box of places, to which no other obstacles are nearest.
    fn look(&mut self, centre: [f64; 3], half: [f64; 3], obstacles: &[Obstacle]) {
        let radius = norm(half);
        let distances: Vec<f64> =
            obstacles.iter().map(|obstacle| norm(gaps(obstacle, centre))).collect();
        let distance = distances.iter().copied().fold(f64::INFINITY, f64::min);
        if distance > self.best.radius {
            self.best = Best { centre, radius: distance };
        }
        if distance + radius <= self.worth() {
            return;
        }
        let near = obstacles.iter().zip(&distances);
        let near: Vec<Obstacle> = near
            .filter(|(_, own)| **own <= distance + 2.0 * radius)
            .map(|(obstacle, _)| *obstacle)
            .collect();
        let bounds: Vec<Bound> =
            near.iter().map(|obstacle| bound(obstacle, centre, half, radius)).collect();
        let highest = highest(&bounds, half);
        let most = highest.most(half).min(distance + radius);
        if most <= self.worth() {
            return;
        }
        self.boxes += 1;
        if self.boxes > MOST {
            self.short = self.short.max(most - self.best.radius);
            return;
        }
        let quarter = half.map(|half| 0.5 * half);
        // The likely one first: what it finds makes the others short.
        let first = (0..3).fold(0, |first, i| first | usize::from(highest.slope[i] > 0.0) << i);
        let children = 1_usize << self.dimension;
        for child in (0..children).map(|child| child ^ (first % children)) {
            let side =
                |axis: usize| if child >> axis & 1 == 0 { -quarter[axis] } else { quarter[axis] };
            let centre = std::array::from_fn(|axis| centre[axis] + side(axis));
            self.look(centre, quarter, &near);
        }
    }
}

fn norm([x, y, z]: [f64; 3]) -> f64 {
    (x * x + y * y + z * z).sqrt()
}

/// The distance along each axis from an obstacle to a place, with its sign.
fn gaps(obstacle: &Obstacle, place: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| {
        let [low, high] = obstacle[axis];
        (place[axis] - high).max(0.0) - (low - place[axis]).max(0.0)
    })
}

/// A bound of the distance from an obstacle on a box of places, which has this radius.
fn bound(obstacle: &Obstacle, centre: [f64; 3], half: [f64; 3], radius: f64) -> Bound {
    let gaps = gaps(obstacle, centre);
    let distance = norm(gaps);
    if distance <= radius {
        return Bound { value: distance + radius, slope: [0.0; 3] };
    }
    // Opposite to one side of the obstacle, the distance is linear.
    let beside = |axis: usize| {
        let [low, high] = obstacle[axis];
        low <= centre[axis] - half[axis] && centre[axis] + half[axis] <= high
    };
    let beyond = |axis: usize| gaps[axis].abs() >= half[axis];
    let across = (0..3).filter(|&axis| !beside(axis)).count();
    let linear = across == 1 && (0..3).all(|axis| beside(axis) || beyond(axis));
    let curved = if linear { 0.0 } else { 0.5 * radius * radius / (distance - radius) };
    Bound { value: distance + curved, slope: gaps.map(|gap| gap / distance) }
}

/// A bound of the least of some bounds on a box of places: the largest value of a mean of them.
fn highest(bounds: &[Bound], half: [f64; 3]) -> Bound {
    let lower = |a: &&Bound, b: &&Bound| a.most(half).total_cmp(&b.most(half));
    let Some(&first) = bounds.iter().min_by(lower) else {
        return Bound { value: f64::INFINITY, slope: [0.0; 3] };
    };
    let mut mean = first;
    for _ in 0..STEPS {
        let means = bounds.iter().map(|bound| mean.mixed(bound, half));
        let next = means.min_by(|a, b| a.most(half).total_cmp(&b.most(half)));
        let Some(next) = next.filter(|next| next.most(half) < mean.most(half)) else { break };
        mean = next;
    }
    mean
}

impl Bound {
    /// Its largest value on a box of places.
    fn most(&self, half: [f64; 3]) -> f64 {
        (0..3).fold(self.value, |most, i| most + half[i] * self.slope[i].abs())
    }

    /// The mean with another one whose largest value is least: it is linear in the share between those at which a slope is
    /// zero along an axis.
    fn mixed(&self, other: &Self, half: [f64; 3]) -> Self {
        let rise: [f64; 3] = std::array::from_fn(|i| other.slope[i] - self.slope[i]);
        let shares =
            (0..3).map(|i| -self.slope[i] / rise[i]).filter(|share| (0.0..1.0).contains(share));
        let mean = |share: f64| Self {
            value: self.value + share * (other.value - self.value),
            slope: std::array::from_fn(|i| self.slope[i] + share * rise[i]),
        };
        let means = shares.chain([0.0, 1.0]).map(mean);
        means.min_by(|a, b| a.most(half).total_cmp(&b.most(half))).unwrap_or(*self)
    }
}
