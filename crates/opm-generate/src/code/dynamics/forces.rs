//! What bodies and drives resist, and the efforts that balance it.

use super::*;

impl Writer<'_> {
    /// What the platform and its payload resist, as its work for each motion.
    pub(super) fn platform_resists(
        &self,
        moving: &Moving,
        start: &Start,
        (twist, change): (Screw, Screw),
        works: Array<Real>,
    ) {
        let &Moving { g, point, gravity, motions, .. } = moving;
        let Some(body) = start.get("body") else { return };
        let own = |name: &str| {
            let mass = g.member::<Mass>(name);
            resistance(mass, body.is::<Body>(), twist, change, gravity, point)
        };
        name!(carried = add_screw(own("platform_mass"), 1.0, own("payload")));
        count("k", 0, number(self.task.coordinates.len()), |k| {
            works.at(k).set(work_of(carried, motions.at(k)));
        });
    }

    /// What the bodies and the drives of the legs resist.
    pub(super) fn legs_resist(&self, moving: &Moving, tables: &Tables, works: Array<Real>) {
        let &Moving { g, point, gravity, screws, after, twists, changes, .. } = moving;
        let &Moving { rates, accelerations, by_motions, .. } = moving;
        let motions_of = number(self.task.coordinates.len());
        block(|| {
            let (first, links) = (tables.first(), tables.links());
            count("leg", 0, LEGS, |leg| {
                name!(behind = still());
                count("back", 0, first.at(leg + 1) - first.at(leg), |back| {
                    name!(i = first.at(leg + 1) - 1 - back);
                    if let Some(links) = links {
                        when(links.at(i).is_set(), || {
                            let mass =
                                g.list::<Mass>("link", tables.link_count()).at(links.at(i) - 1);
                            let (twist, change) = (twists.at(i), changes.at(i));
                            let own = resistance(mass, after.at(i), twist, change, gravity, point);
                            behind.set(add_screw(behind, 1.0, own));
                        });
                    }
                    let drive = g.list::<Drive>("drive", self.fields.len()).at(i);
                    name!(needed = drive_effort(drive, rates.at(i), accelerations.at(i)));
                    name!(along = work_of(behind, screws.at(i)) - needed);
                    count("k", 0, motions_of, |k| {
                        works.at(k).increase(by_motions.at(i * motions_of + k) * along);
                    });
                });
            });
        });
    }

    /// The efforts that balance the works for all motions that are given.
    pub(super) fn balanced(
        &self,
        moving: &Moving,
        works: Array<Real>,
        follow: Option<Follow>,
        efforts: Array<Real>,
    ) {
        let g = moving.g;
        let [own, sought_of] = self.own_and_follow();
        let actuated = self.manipulator.actuated();
        let units = own.iter().map(|&i| self.unit(g, self.task.coordinates[i].quantity));
        let width = actuated.len() + 1;
        block(|| {
            let (given_of, driven) = (listed("given", &own), listed("driven", actuated));
            let follows = follow.map(|follow| (follow.rates, listed("sought", &sought_of)));
            let unit = Array::<Real>::named("unit", units);
            let balance = Array::<Real>::empty("balance", own.len() * width);
            let [width, sides, motions_of] =
                [width, own.len(), self.task.coordinates.len()].map(number);
            let size = |i: Int| g.list::<Joint>("joint", self.fields.len()).at(i).size;
            count("j", 0, sides, |j| {
                name!(work = works.at(given_of.at(j)));
                count("i", 0, ACTUATED, |i| {
                    let rate = moving.by_motions.at(driven.at(i) * motions_of + given_of.at(j));
                    balance.at(j * width + i).set(rate);
                });
                if let Some((rates, sought)) = follows {
                    count("k", 0, number(sought_of.len()), |k| {
                        name!(share = rates.at(k * sides + j));
                        work.increase(share * works.at(sought.at(k)));
                        count("i", 0, ACTUATED, |i| {
                            let place = driven.at(i) * motions_of + sought.at(k);
                            let rate = moving.by_motions.at(place);
                            balance.at(j * width + i).increase(share * rate);
                        });
                    });
                }
                count("i", 0, ACTUATED, |i| {
                    balance.at(j * width + i).multiply(unit.at(j) / size(driven.at(i)));
                });
                balance.at(j * width + ACTUATED).set(-(work * unit.at(j)));
            });
            let singular = eliminate(balance, sides, ACTUATED, 1, efforts);
            when(singular.is_set(), || give(2 * LEGS + 1));
            count("i", 0, ACTUATED, |i| efforts.at(i).divide(size(driven.at(i))));
        });
    }
}
