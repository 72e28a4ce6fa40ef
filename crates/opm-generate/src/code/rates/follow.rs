//! The rates of coordinates that follow from others, where legs constrain the platform.

use crate::code::*;
use crate::library::*;
use crate::trace::*;
use opm_core::numeric::Quantity;

/// The functions of the rates by all coordinates, and of their sums for those that are given.
impl Writer<'_> {
    /// The coordinates that are given, and those that follow.
    pub fn own_and_follow(&self) -> [Vec<usize>; 2] {
        let own = self.forms.independent.clone();
        let follow = (0..self.task.coordinates.len()).filter(|i| !own.contains(i)).collect();
        [own, follow]
    }

    /// How many rates there are of the coordinates that follow by those that are given.
    pub fn follow_rates(&self) -> usize {
        let [own, follow] = self.own_and_follow();
        (own.len() * follow.len()).max(1)
    }

    /// Gives `follow`, the rates of the coordinates that follow at which no joint moves that a leg lacks.
    pub fn eliminated(&self, g: Any, lacking: usize, locked: Array<Real>, follow: Array<Real>) {
        let count_of = number(self.task.coordinates.len());
        let [own, others] = self.own_and_follow();
        let [sides, unknowns] = [own.len(), others.len()].map(number);
        let (width, lacking_rows) = (own.len() + others.len(), number(lacking));
        let units = others.iter().map(|&i| self.unit(g, self.task.coordinates[i].quantity));
        block(|| {
            let given = numbers("given", &own);
            let sought = numbers("sought", &others);
            let unit = Array::<Real>::named("unit", units);
            let a = Array::<Real>::empty("a", lacking * width);
            let width = number(width);
            count("i", 0, lacking_rows, |i| {
                count("j", 0, unknowns, |j| {
                    a.at(i * width + j).set(locked.at(i * count_of + sought.at(j)) * unit.at(j));
                });
                count("j", 0, sides, |j| {
                    a.at(i * width + unknowns + j).set(-locked.at(i * count_of + given.at(j)));
                });
            });
            let singular = eliminate(a, lacking_rows, unknowns, sides, follow);
            when(singular.is_set(), || give(2 * LEGS + 1));
            count("i", 0, unknowns, |i| {
                count("j", 0, sides, |j| follow.at(i * sides + j).multiply(unit.at(i)));
            });
        });
    }

    /// The unit of a rate of a coordinate.
    pub fn unit(&self, g: Any, quantity: Quantity) -> Real {
        match quantity {
            Quantity::Angle => Real::from(1.0),
            Quantity::Length => g.member("size"),
        }
    }

    /// The function of the rates of all joints by all coordinates.
    pub fn differentiate(&self, lacking: usize) {
        let function = Traced::new(
            "differentiate",
            "The rates of all joints by all coordinates, and those of the coordinates that follow by the others. It returns \
             what NAME_jacobian returns.",
        );
        self.add(function.body(|p| {
            let of_pose = of_pose(p);
            let [all, follow] = ["all", "follow"].map(|name| p.add::<Out<[Real]>>(name));
            match self.turns() {
                true => self.by_all_coordinates(of_pose, lacking, all, follow),
                false => {
                    let locked = self.rates_body(of_pose, None, all, None);
                    self.eliminated(of_pose.0, lacking, locked, follow);
                }
            }
            done()
        }));
    }

    /// The function of their sums.
    pub fn by_pose(&self) {
        let [own, follow_of] = self.own_and_follow();
        let comment = "Rates by the coordinates of a pose, from rows of those by all coordinates.";
        self.add(Traced::new("by_pose", comment).body(|p| {
            let (all, rows) = (p.add::<In<[Real]>>("all"), p.add::<Int>("rows"));
            let follow = p.add::<In<[Real]>>("follow");
            let by_pose = p.add::<Out<[Real]>>("by_pose");
            let count_of = number(self.task.coordinates.len());
            let [sides, unknowns] = [own.len(), follow_of.len()].map(number);
            let (given, sought) = (numbers("given", &own), numbers("sought", &follow_of));
            count("i", 0, rows, |i| {
                count("j", 0, sides, |j| {
                    let sum = by_pose.at(i * sides + j);
                    sum.set(all.at(i * count_of + given.at(j)));
                    count("k", 0, unknowns, |k| {
                        let rate = all.at(i * count_of + sought.at(k));
                        sum.increase(rate * follow.at(k * sides + j));
                    });
                });
            });
        }));
    }

    /// The Jacobian where coordinates follow.
    pub fn of_independent(&self, (g, pose, mode): (Any, Array<Real>, Bits), jacobian: Array<Real>) {
        let length = self.fields.len() * self.task.coordinates.len();
        let all = Array::<Real>::empty("all", length);
        let follow = Array::<Real>::empty("follow", self.follow_rates());
        let call = self.call("differentiate", &given![g, pose, mode, all, follow]);
        name!(status = call.is::<Int>());
        return_status(status);
        self.call("by_pose", &given![all, JOINTS, follow, jacobian]);
    }
}

/// Declares a list of whole numbers, which has at least one.
pub fn numbers(name: &str, values: &[usize]) -> Array<Int> {
    let values = if values.is_empty() { &[0] } else { values };
    Array::named(name, values.iter().map(|&value| number(value)))
}
