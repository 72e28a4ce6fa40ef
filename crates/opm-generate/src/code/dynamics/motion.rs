//! The rates and the accelerations of all joints, and of all bodies.

use super::*;

impl Writer<'_> {
    /// The rates of all joints by the motions, and what the equations of legs leave over.
    pub(super) fn rates_by_motions(
        &self,
        moving: &Moving,
        tables: &Tables,
        follow: Option<Follow>,
    ) {
        let &Moving { g, screws, by_motions, motions, equations, solved, .. } = moving;
        let motions_of = number(self.task.coordinates.len());
        let size = g.member::<Real>("size");
        block(|| {
            let (first, columns) = (tables.first(), tables.columns());
            let unknowns = tables.unknowns();
            if let Some(Follow { left, .. }) = follow {
                count("i", 0, ROWS * LEGS * motions_of, |i| left.at(i).set(0.0));
            }
            count("leg", 0, LEGS, |leg| {
                name!(unknown = unknowns.at(leg));
                self.call(
                    "leg_equations",
                    &given![g, screws, leg, unknown + motions_of, equations],
                );
                count("k", 0, motions_of, |k| {
                    let width = unknown + motions_of;
                    add_column(equations, unknown + k, width, motions.at(k), 1.0, size);
                });
                let singular = eliminate(equations, ROWS, unknown, motions_of, solved);
                when(singular.is_set(), || give(LEGS + leg + 1));
                count("i", first.at(leg), first.at(leg + 1), |i| {
                    let column = columns.map_or(i - first.at(leg), |columns| columns.at(i));
                    count("k", 0, motions_of, |k| {
                        let rate = solved.at(column * motions_of + k);
                        by_motions.at(i * motions_of + k).set(rate * self.scale(g, tables, i));
                    });
                });
                let Some(Follow { left, .. }) = follow else { return };
                count("k", 0, motions_of, |k| {
                    name!(rest = motions.at(k));
                    count("i", first.at(leg), first.at(leg + 1), |i| {
                        let rate = by_motions.at(i * motions_of + k);
                        rest.set(add_screw(rest, -rate, screws.at(i)));
                    });
                    let place = ROWS * leg * motions_of + k;
                    add_column(left, place, motions_of, rest, 1.0, size);
                });
            });
        });
    }

    /// The rates of the motions that follow, and the part of their accelerations that is in proportion to those that are given.
    pub(super) fn follow_given(&self, given: [Given; 2], follow: Follow) {
        block(|| {
            let [own, sought] = self.own_and_follow();
            let [sides, unknowns] = [own.len(), sought.len()].map(number);
            let (given_of, sought) = (listed("given", &own), listed("sought", &sought));
            count("i", 0, unknowns, |i| {
                count("j", 0, sides, |j| {
                    for Given { of_motions, .. } in given {
                        let part = of_motions.at(given_of.at(j));
                        of_motions.at(sought.at(i)).increase(follow.rates.at(i * sides + j) * part);
                    }
                });
            });
        });
    }

    /// The twist of the platform, and what its rate is without accelerations of the motions.
    pub(super) fn platform_moves(
        &self,
        moving: &Moving,
        [rates, _]: [Array<Real>; 2],
    ) -> (Screw, Screw) {
        name!(twist = still(), change = still());
        let moves = |before: Screw, rate: Real, screw: Screw| {
            change.set(add_screw(change, rate, bracket(before, screw)));
            twist.set(add_screw(twist, rate, screw));
        };
        let screw = |k: usize| moving.motions.at(number(k));
        let (angles, turned) = (self.all_angles(), self.three_angles());
        let first = angles.as_ref().map(|angles| angles.start);
        for k in 0..self.task.coordinates.len() {
            if first != Some(k) {
                if angles.as_ref().is_none_or(|angles| !angles.contains(&k)) {
                    moves(twist, rates.at(number(k)), screw(k));
                }
            } else if turned.is_some() {
                note("The directions of the section's frame move with what is before all three.");
                name!(carrier = twist);
                (k..k + 3).for_each(|k| moves(carrier, rates.at(number(k)), screw(k)));
            } else {
                for (columns, signs) in self.factors() {
                    let all = columns.iter().map(|&i| screw(k + i));
                    let axis = all.reduce(|sum, column| add_screw(sum, 1.0, column));
                    let rate = factor_rate(signs, |i| rates.at(number(k + i)));
                    moves(twist, rate, axis.unwrap_or_else(still));
                }
            }
        }
        (twist, change)
    }

    /// The rates and the accelerations of all joints, and the twists of what is behind them with their rates.
    pub(super) fn joints_accelerate(
        &self,
        moving: &Moving,
        tables: &Tables,
        change: Screw,
        [motion_rates, motion_accelerations]: [Array<Real>; 2],
        follow: Option<Follow>,
    ) {
        let &Moving { g, screws, twists, changes, rates, accelerations, by_motions, .. } = moving;
        let &Moving { motions, equations, solved, .. } = moving;
        let motions_of = number(self.task.coordinates.len());
        let size = g.member::<Real>("size");
        count("i", 0, JOINTS, |i| {
            rates.at(i).set(0.0);
            count("k", 0, motions_of, |k| {
                rates.at(i).increase(by_motions.at(i * motions_of + k) * motion_rates.at(k));
            });
        });
        block(|| {
            let (first, columns) = (tables.first(), tables.columns());
            let (unknowns, balls) = (tables.unknowns(), tables.balls());
            if let Some(Follow { missing, .. }) = follow {
                count("i", 0, ROWS * LEGS, |i| missing.at(i).set(0.0));
            }
            count("leg", 0, LEGS, |leg| {
                name!(unknown = unknowns.at(leg));
                name!(moved = still(), changed = still());
                let base = balls.map(|_| named("base", still()));
                count("i", first.at(leg), first.at(leg + 1), |i| {
                    if let (Some(balls), Some(base)) = (balls, base) {
                        note("The three axes of a ball move with what is before it.");
                        when(balls.at(i).le(1), || base.set(moved));
                    }
                    let screw = screws.at(i);
                    let moves = bracket(base.unwrap_or(moved), screw);
                    changed.set(add_screw(changed, rates.at(i), moves));
                    moved.set(add_screw(moved, rates.at(i), screw));
                    twists.at(i).set(moved);
                    changes.at(i).set(changed);
                });
                name!(rest = add_screw(change, -1.0, changed));
                self.call("leg_equations", &given![g, screws, leg, unknown + 1, equations]);
                add_column(equations, unknown, unknown + 1, rest, 1.0, size);
                let singular = eliminate(equations, ROWS, unknown, 1, solved);
                when(singular.is_set(), || give(LEGS + leg + 1));
                count("i", first.at(leg), first.at(leg + 1), |i| {
                    let column = columns.map_or(i - first.at(leg), |columns| columns.at(i));
                    accelerations.at(i).set(solved.at(column) * self.scale(g, tables, i));
                    if follow.is_some() {
                        rest.set(add_screw(rest, -accelerations.at(i), screws.at(i)));
                    }
                });
                if let Some(Follow { missing, .. }) = follow {
                    add_column(missing, ROWS * leg, 1, rest, 1.0, size);
                }
            });
        });
        if let Some(follow) = follow {
            self.follow_accelerates(g, motion_accelerations, follow);
        }
        count("k", 0, motions_of, |k| {
            change.set(add_screw(change, motion_accelerations.at(k), motions.at(k)));
        });
        block(|| {
            let first = tables.first();
            count("leg", 0, LEGS, |leg| {
                name!(gained = still());
                count("i", first.at(leg), first.at(leg + 1), |i| {
                    count("k", 0, motions_of, |k| {
                        let part = by_motions.at(i * motions_of + k);
                        accelerations.at(i).increase(part * motion_accelerations.at(k));
                    });
                    gained.set(add_screw(gained, accelerations.at(i), screws.at(i)));
                    changes.at(i).set(add_screw(changes.at(i), 1.0, gained));
                });
            });
        });
    }

    /// The accelerations of the motions that follow at which the equations of all legs leave nothing over.
    pub(super) fn follow_accelerates(&self, g: Any, accelerations: Array<Real>, follow: Follow) {
        let [_, sought_of] = self.own_and_follow();
        let (legs, unknowns) = (self.forms.legs.len(), number(sought_of.len()));
        let width = sought_of.len() + 1;
        let units = sought_of.iter().map(|&i| self.unit(g, self.task.coordinates[i].quantity));
        block(|| {
            let sought = listed("sought", &sought_of);
            let unit = Array::<Real>::named("unit", units);
            let closing = Array::<Real>::empty("closing", 6 * legs * width);
            let found = Array::<Real>::empty("found", sought_of.len().max(1));
            let (width, motions_of) = (number(width), number(self.task.coordinates.len()));
            count("i", 0, ROWS * LEGS, |i| {
                count("j", 0, unknowns, |j| {
                    let entry = follow.left.at(i * motions_of + sought.at(j));
                    closing.at(i * width + j).set(entry * unit.at(j));
                });
                closing.at(i * width + unknowns).set(-follow.missing.at(i));
            });
            let singular = eliminate(closing, ROWS * LEGS, unknowns, 1, found);
            when(singular.is_set(), || give(2 * LEGS + 1));
            count("j", 0, unknowns, |j| {
                accelerations.at(sought.at(j)).increase(found.at(j) * unit.at(j));
            });
        });
    }
}
