//! The wrenches by which the legs of a symmetric platform hold it.

use super::dependent::{Square, System};
use super::whole::{WholeDifferential, about};
use super::{Manipulator, SINGULAR};
use crate::manipulator::Solution;
use nalgebra::{Vector3, Vector6};

/// The most wrenches.
const MOST: usize = 6;

impl Manipulator {
    /// As many wrenches as there are dependent coordinates, each with the number of its leg. Where legs share
    /// some, those combinations count that are known least from the ones before.
    pub(super) fn mirror_wrenches(
        &self,
        at: &Solution,
        legs: &[usize],
        point: &Vector3<f64>,
        differential: impl Fn(usize) -> WholeDifferential,
    ) -> [Option<(usize, Vector6<f64>)>; MOST] {
        let wanted = self.dependent_coordinates().len().min(MOST);
        let (mut found, mut known) = ([None; MOST], 0);
        let of_leg = |leg: usize| {
            let own = differential(leg);
            let mut given = self.stem_wrenches(&own, point, MOST - own.count);
            let wrenches: [Vector6<f64>; MOST] =
                std::array::from_fn(|_| given.next().unwrap_or_default());
            (wrenches, MOST - own.count)
        };
        let all: usize = legs.iter().map(|&leg| of_leg(leg).1).sum();
        if all == wanted {
            for &leg in legs {
                let (wrenches, count) = of_leg(leg);
                for wrench in wrenches.into_iter().take(count) {
                    found[known] = Some((leg, wrench));
                    known += 1;
                }
            }
            return found;
        }
        let mut basis = [Vector6::zeros(); MOST];
        while known < wanted {
            let without = |wrench: Vector6<f64>| {
                basis[..known].iter().fold(wrench, |rest, unit| rest - unit * unit.dot(&rest))
            };
            // Of the leg with the wrench that is least known, the combination that is.
            let mut best = (0.0, 0, Vector6::zeros());
            for &leg in legs {
                let (wrenches, _) = of_leg(leg);
                let rests = wrenches.map(without);
                let longest = rests.into_iter().max_by(|a, b| a.norm().total_cmp(&b.norm()));
                let longest = longest.unwrap_or_default();
                if longest.norm() > best.0 + SINGULAR {
                    let unit = longest.normalize();
                    let shares = wrenches.iter().zip(&rests).map(|(w, rest)| w * rest.dot(&unit));
                    best = (longest.norm(), leg, shares.sum::<Vector6<f64>>().normalize());
                }
            }
            let (_, leg, wrench) = best;
            let rest = without(wrench);
            if rest.norm() < SINGULAR {
                break;
            }
            (basis[known], found[known]) = (rest.normalize(), Some((leg, wrench)));
            known += 1;
        }
        // Combinations have no sense of their own. Theirs is that in which dependent coordinates grow, so that measures change
        // their sign at singularities alone.
        if self.sense(at, point, &found) < 0.0
            && let Some((_, last)) = found[..known].last_mut().and_then(Option::as_mut)
        {
            *last = -*last;
        }
        found
    }

    /// The determinant of the rates along wrenches for those of the dependent coordinates.
    fn sense(
        &self,
        at: &Solution,
        point: &Vector3<f64>,
        wrenches: &[Option<(usize, Vector6<f64>)>; MOST],
    ) -> f64 {
        let coordinates = self.task().coordinates.len();
        let mut rates: Square = Default::default();
        for (column, &i) in self.dependent.iter().flat_map(|d| &d.coordinates).enumerate() {
            let (mut unit, still) = ([0.0; MOST], [0.0; MOST]);
            unit[i] = 1.0;
            let pose = &at.solved.pose;
            let twists = self.section_twists(pose, &unit[..coordinates], &still[..coordinates]);
            let [twist, _] = twists.of_platform(self.task(), &at.solved.v);
            let moved = about(&twist, point, self.characteristic_length());
            for (row, (_, wrench)) in wrenches.iter().flatten().enumerate() {
                rates[row][column] = wrench.dot(&moved);
            }
        }
        System::new(&rates, self.dependent_units(), self.dependent_coordinates().len())
            .determinant()
    }
}
