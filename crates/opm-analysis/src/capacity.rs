//! Capacity: the loads that actuators with limited efforts bear.
//!
//! Each actuator adds `−gᵢ τᵢ` to the work that the platform resists, `gᵢ` its row of `G` ([`Statics`]), with `|τᵢ|` at
//! most its `max_effort`. The loads that they bear together are the sum of these segments, a zonotope: the *wrench
//! polytope* (S. Bouchard, C. Gosselin, B. Moore, *On the ability of a cable-driven robot to generate a prescribed set of
//! wrenches*, J. Mechanisms Robotics 2 (2010), sec. 3). With as many actuators as freedoms `f` it is a parallelepiped. A
//! facet is parallel to `f − 1` segments. Its normal `n` is perpendicular to them, and its distance is `Σ |n · gᵢ| τᵢ`:
//! the polytope is the set of all loads `w` with `|n · w|` at most that, for every facet. So it is exact, and so is the
//! largest ball in it, whose radius is the least distance of a facet from the load that acts already.
//!
//! Only the part of a wrench that does work for a motion of the platform counts. The legs bear the rest, whatever the
//! actuators do.

use crate::statics::{MOST, Statics, Velocity};
use nalgebra::{Vector3, Vector6};

/// A number below this share of those it is computed from counts as zero.
const ZERO: f64 = 1e-10;

/// A pair of opposite facets of the wrench polytope: `|normal · W| ≤ bound` for every wrench that the actuators bear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet {
    /// The factors of the components `FX FY FZ MX MY MZ` of a wrench; metres for forces, no unit for moments.
    pub normal: [f64; 6],
    /// The bound, newton metres.
    pub bound: f64,
}

/// The largest loads in the worst direction, on top of a load that acts already.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capacity {
    /// The largest force at the reference point that is borne in every direction, newtons; infinite if no actuator that
    /// has a limit bears a force. Negative if not even the load that acts is borne.
    pub force: f64,
    /// The largest moment that is borne about every axis, newton metres; likewise.
    pub moment: f64,
    /// The radius of the largest ball in the wrench polytope around the load that acts, newton metres: a force counts
    /// with the characteristic length as its lever.
    pub ball: f64,
}

/// A facet, in independent velocities.
pub(crate) struct LocalFacet {
    pub(crate) normal: Velocity,
    pub(crate) bound: f64,
}

impl Statics<'_> {
    /// The largest loads in the worst direction on top of one that does this work ([`Statics::work`]; zeros for none).
    /// `None` at a serial singularity, and where no actuator has a `max_effort`. Nothing is allocated.
    pub fn capacity(&self, load: &Velocity) -> Option<Capacity> {
        if !self.is_regular() || !self.has_limits() {
            return None;
        }
        let whole = f64::INFINITY;
        let mut found = Capacity { force: whole, moment: whole, ball: whole };
        if self.loose() > 0 {
            return Some(Capacity { force: 0.0, moment: 0.0, ball: 0.0 });
        }
        self.each_facet(|facet| {
            let left = facet.bound - dot(&facet.normal, load).abs();
            let twist = self.twist_of(&facet.normal);
            let linear = twist.fixed_rows::<3>(3).norm() * self.length();
            let angular = twist.fixed_rows::<3>(0).norm();
            let of = |size: f64, unit: f64| if size > ZERO * unit { left / size } else { whole };
            found.force = found.force.min(of(linear, self.length()));
            found.moment = found.moment.min(of(angular, 1.0));
            found.ball = found.ball.min(left);
        });
        Some(found)
    }

    /// The largest force in a direction, newtons, at the reference point and on top of a load; infinite if no limited actuator
    /// bears a force in that direction. `None` as for [`Statics::capacity`].
    pub fn largest_force(&self, direction: &Vector3<f64>, load: &Velocity) -> Option<f64> {
        if !self.is_regular() || !self.has_limits() {
            return None;
        }
        let direction = direction.normalize();
        let own = self.work(&crate::Wrench { force: direction, moment: Vector3::zeros() });
        let size = own.iter().map(|part| part * part).sum::<f64>().sqrt();
        if size <= ZERO * self.length() {
            return Some(f64::INFINITY);
        }
        if self.loose() > 0 {
            return Some(0.0);
        }
        let mut largest = f64::INFINITY;
        self.each_facet(|facet| {
            let along = dot(&facet.normal, &own);
            if along.abs() > ZERO * size {
                let left = facet.bound - along.signum() * dot(&facet.normal, load);
                largest = largest.min(left / along.abs());
            }
        });
        Some(largest)
    }

    /// The facets of the wrench polytope, a pair of opposite ones each; empty where [`Statics::capacity`] is `None` and
    /// where the actuators leave the platform a motion.
    pub fn facets(&self) -> Vec<Facet> {
        let mut found: Vec<Facet> = Vec::new();
        if !self.is_regular() || self.loose() > 0 {
            return found;
        }
        self.each_facet(|facet| {
            let twist = self.twist_of(&facet.normal);
            let normal = std::array::from_fn(|i| {
                if i < 3 { twist[i + 3] * self.length() } else { twist[i - 3] }
            });
            // Parallel segments give one facet several times.
            let same = |known: &Facet| {
                let difference = |sign: f64| {
                    let parts = known.normal.iter().zip(&normal).map(|(a, b)| (a - sign * b).abs());
                    parts.fold(0.0, f64::max)
                };
                difference(1.0).min(difference(-1.0)) < ZERO * (1.0 + self.length())
            };
            if !found.iter().any(same) {
                found.push(Facet { normal, bound: facet.bound });
            }
        });
        found
    }

    /// Whether an actuator has a largest effort.
    pub(crate) fn has_limits(&self) -> bool {
        let manipulator = self.manipulator();
        let limited = |&c: &usize| manipulator.coordinates()[c].max_effort.is_some();
        manipulator.actuated().iter().any(limited)
    }

    /// The largest effort of an actuator in the units of this crate; infinite without a limit.
    fn largest_effort(&self, actuated: usize) -> f64 {
        let coordinate = self.manipulator().actuated()[actuated];
        let limit = self.manipulator().coordinates()[coordinate].max_effort;
        limit.map_or(f64::INFINITY, |effort| effort / self.effort_unit(actuated))
    }

    /// The platform's twist of a velocity.
    fn twist_of(&self, velocity: &Velocity) -> Vector6<f64> {
        (0..self.free).map(|k| self.twists.column(k) * velocity[k]).sum()
    }

    /// Gives every facet at a finite distance, with a unit normal, some of them several times.
    pub(crate) fn each_facet(&self, mut each: impl FnMut(&LocalFacet)) {
        let (f, m) = (self.free, self.manipulator().actuated().len());
        let mut chosen: [usize; MOST] = std::array::from_fn(|i| i);
        let count = f - 1;
        if m < count {
            return;
        }
        loop {
            if let Some(normal) = self.perpendicular(&chosen[..count]) {
                let mut bound = 0.0;
                for i in 0..m {
                    let row: f64 = (0..f).map(|k| normal[k] * self.rates[(i, k)]).sum();
                    let size = self.rates.row(i).norm();
                    if row.abs() > ZERO * size {
                        bound += row.abs() * self.largest_effort(i);
                    }
                }
                if bound.is_finite() {
                    each(&LocalFacet { normal, bound });
                }
            }
            // The next choice of `count` among `m`.
            let Some(place) = (0..count).rfind(|&place| chosen[place] < m - count + place) else {
                return;
            };
            chosen[place] += 1;
            for next in place + 1..count {
                chosen[next] = chosen[next - 1] + 1;
            }
        }
    }

    /// The unit vector that is perpendicular to some rows of `G`, one less than there are columns; `None` if they are
    /// dependent. By elimination with full pivoting.
    fn perpendicular(&self, chosen: &[usize]) -> Option<Velocity> {
        let f = self.free;
        let mut rows = [[0.0; MOST]; MOST];
        for (row, &i) in rows.iter_mut().zip(chosen) {
            let norm = self.rates.row(i).norm();
            (0..f).for_each(|k| row[k] = self.rates[(i, k)] / norm);
        }
        let mut order: [usize; MOST] = std::array::from_fn(|k| k);
        for step in 0..chosen.len() {
            let mut best = (step, step);
            for row in step..chosen.len() {
                for place in step..f {
                    if rows[row][order[place]].abs() > rows[best.0][order[best.1]].abs() {
                        best = (row, place);
                    }
                }
            }
            rows.swap(step, best.0);
            order.swap(step, best.1);
            let pivot = rows[step][order[step]];
            if pivot.is_nan() || pivot.abs() <= ZERO {
                return None;
            }
            for row in 0..chosen.len() {
                if row == step {
                    continue;
                }
                let factor = rows[row][order[step]] / pivot;
                let pivot_row = rows[step];
                for (entry, pivot) in rows[row].iter_mut().zip(pivot_row).take(f) {
                    *entry -= factor * pivot;
                }
            }
        }
        let free = order[f - 1];
        let mut normal = [0.0; MOST];
        normal[free] = 1.0;
        for step in 0..chosen.len() {
            normal[order[step]] = -rows[step][free] / rows[step][order[step]];
        }
        let norm = normal.iter().map(|part| part * part).sum::<f64>().sqrt();
        Some(normal.map(|part| part / norm))
    }
}

fn dot(a: &Velocity, b: &Velocity) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
