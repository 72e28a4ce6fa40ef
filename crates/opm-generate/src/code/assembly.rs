//! The signs of the determinants that tell assemblies apart, for a module that stays in one of them.

use super::rates::follow::numbers;
use super::*;
use crate::library::{NEARBY, near, sign_of};
use crate::trace::*;
use opm_core::manipulator::form::LegForm;
use opm_core::numeric::Quantity;

/// The rows of the determinants of the two sections.
struct Sections {
    /// The numbers of the imaginary joints that follow from the upper section.
    imaginary: Vec<usize>,
    /// The actuated joints of the lower section, and which of those imaginary joints moves each.
    lower: Vec<usize>,
    moved: Vec<Option<usize>>,
    /// The actuated joints of the upper section.
    upper: Vec<usize>,
}

impl Writer<'_> {
    /// Traces the function of the signs, and those that it calls: it gives how many signs there are.
    pub fn signs(&self) -> usize {
        let [rows, unknowns] = self.equations();
        let sections = self.sections().filter(|_| rows == unknowns);
        if let Some(sections) = &sections {
            if !sections.imaginary.is_empty() {
                self.imaginary_rates(&sections.imaginary);
            }
            self.signs_of_sections(sections);
        }
        let function = Traced::new(
            "signs",
            "The signs of the determinants at a pose. It returns 0 if they are known.",
        );
        self.add(function.body(|p| {
            let ((g, pose, mode), found) = (of_pose(p), p.add::<Out<[Int]>>("found"));
            let zero = Array::<Real>::named("zero", vec![0.0; self.manipulator.actuated().len()]);
            let q = self.steps_in_all().then(|| Array::<Real>::empty("q", unknowns));
            let a = Array::<Real>::empty("a", rows * (unknowns + 1));
            let mut given = given![g, pose, mode, zero].to_vec();
            given.extend(q.map(Any::from));
            given.push(a.into());
            name!(status = self.call("linearise", &given).is::<Int>());
            when(status.is(0), || match sections {
                _ if rows != unknowns => found.at(0).set(0),
                Some(_) => {
                    let given = given![g, pose, mode, a, found];
                    status.set(self.call("signs_of_sections", &given).is::<Int>());
                }
                None => {
                    let whole = Array::<Real>::empty("whole", unknowns * unknowns);
                    self.copy(whole, number(unknowns), |i, j| a.at(i * self.width() + j));
                    found.at(0).set(sign_of(whole, number(unknowns)));
                }
            });
            status
        }));
        if sections.is_some() { 2 } else { 1 }
    }

    /// How many numbers a row of the equations of a step has.
    fn width(&self) -> Int {
        number(self.equations()[1] + 1)
    }

    /// Writes the elements of a square matrix.
    fn copy(&self, to: Array<Real>, size: Int, from: impl FnOnce(Int, Int) -> Real) {
        count("i", 0, size, |i| count("j", 0, size, |j| to.at(i * size + j).set(from(i, j))));
    }

    /// What the determinants of the two sections consist of; `None` where one of them is not square: then assemblies are told
    /// apart by that of the whole.
    fn sections(&self) -> Option<Sections> {
        if self.dependent() || self.forms.height.is_some_and(|height| height.slope != 0.0) {
            return None;
        }
        // The imaginary joints that follow from the upper section.
        let above = |leg: &LegForm| leg.bridged && leg.first == Section::Upper;
        let taus: Vec<usize> =
            (0..self.forms.legs.len()).filter(|&leg| above(&self.forms.legs[leg])).collect();
        let imaginary: Vec<usize> =
            taus.iter().map(|&leg| self.forms.legs[leg].imaginary).collect::<Option<_>>()?;
        let (mut lower, mut moved, mut upper) = (Vec::new(), Vec::new(), Vec::new());
        for (row, &coordinate) in self.manipulator.actuated().iter().enumerate() {
            match self.section_of(coordinate)? {
                (leg, Section::Lower) => {
                    lower.push(row);
                    moved.push(taus.iter().position(|&tau| Some(tau) == leg));
                }
                (_, Section::Upper) => upper.push(row),
            }
        }
        let (own, all) = (self.task.lower_count, self.task.coordinates.len());
        let square = lower.len() == own + taus.len() && upper.len() + taus.len() == all - own;
        (square && own > 0 && own < all).then_some(Sections { imaginary, lower, moved, upper })
    }

    /// The leg and the section of a joint coordinate; of a lift, the section that has the height. `None` where a lift leans.
    fn section_of(&self, coordinate: usize) -> Option<(Option<usize>, Section)> {
        for (number, leg) in self.forms.legs.iter().enumerate() {
            if leg.lift.as_ref().is_some_and(|lift| lift.lean.is_some()) {
                return None;
            }
            for section in [Section::Lower, Section::Upper] {
                if leg.section(section).coordinates.contains(&Some(coordinate)) {
                    return Some((Some(number), section));
                }
            }
        }
        Some((None, self.forms.height?.section))
    }

    /// The function of the rates of imaginary joints.
    fn imaginary_rates(&self, imaginary: &[usize]) {
        let m = self.manipulator;
        let [_, unknowns] = self.equations();
        let function = Traced::new(
            "imaginary_rates",
            "The rates of imaginary joints by what moves the platform, a row for each, from poses beside this one. It returns 0 \
             if these are in reach.",
        );
        self.add(function.body(|p| {
            let ((g, pose, mode), rates) = (of_pose(p), p.add::<Out<[Real]>>("rates"));
            let turns = imaginary.iter().map(|&i| m.imaginary()[i].quantity == Quantity::Angle);
            let turns: Vec<usize> = turns.map(usize::from).collect();
            let (of_tau, turns) = (numbers("numbers", imaginary), numbers("turns", &turns));
            let joints = Array::<Real>::empty("joints", self.fields.len());
            let [here, there] =
                ["here", "there"].map(|name| Array::<Real>::empty(name, m.imaginary().len()));
            let next = Array::<Real>::empty("next", m.task_coordinates().len());
            let solved = |pose: Array<Real>, imaginary: Array<Real>| {
                self.call("inverse", &given![g, pose, mode, joints, imaginary]).is::<Int>()
            };
            name!(found = solved(pose, here));
            count_while("j", 0, number(unknowns), found.is(0), |j| {
                let step = Array::<Real>::named("step", vec![0.0; unknowns]);
                name!(way = NEARBY);
                step.at(j).set(1.0);
                let go = || {
                    self.go(g, pose, step, way, next);
                    found.set(solved(next, there));
                };
                go();
                when(found.is_not(0), || {
                    way.set(-NEARBY);
                    go();
                });
                count_while("i", 0, number(imaginary.len()), found.is(0), |i| {
                    name!(off = there.at(of_tau.at(i)) - here.at(of_tau.at(i)));
                    let length = off / g.member::<Real>("size");
                    let rate = turns.at(i).is_set().choose(near(off, 0.0), length);
                    rates.at(i * number(unknowns) + j).set(rate / way);
                });
            });
            found
        }));
    }

    /// Writes the pose that a step leads to.
    fn go(&self, g: Any, pose: Array<Real>, step: Array<Real>, way: Real, next: Array<Real>) {
        if self.turns() {
            self.call("stepped", &given![g, pose, pose, step, way, next]);
            return;
        }
        for (j, coordinate) in self.manipulator.task_coordinates().iter().enumerate() {
            let j = number(j);
            let moved = way * step.at(j) * self.unit(g, coordinate.quantity);
            next.at(j).set(pose.at(j) + moved);
        }
    }

    /// The function of the signs of the determinants of the sections.
    fn signs_of_sections(&self, sections: &Sections) {
        let Sections { imaginary, lower, moved, upper } = sections;
        let own = self.task.lower_count;
        let (taus, unknowns) = (imaginary.len(), self.equations()[1]);
        let function = Traced::new(
            "signs_of_sections",
            "The signs of the determinants of both sections, whose joints are the actuated ones and the imaginary ones: those \
             that follow from the upper section move the lower one.",
        );
        self.add(function.body(|p| {
            let (g, pose, mode) = of_pose(p);
            let (a, found) = (p.add::<In<[Real]>>("a"), p.add::<Out<[Int]>>("found"));
            let (below, width, tau_count) = (number(own), self.width(), number(taus));
            let [of_lower, of_upper] = [("of_lower", lower.len()), ("of_upper", unknowns - own)]
                .map(|(name, size)| (Array::<Real>::empty(name, size * size), number(size)));
            let lower = numbers("lower", lower);
            let upper = (!upper.is_empty()).then(|| numbers("upper", upper));
            let row_of_upper =
                |row: Int, j: Int| upper.map(|upper| a.at(upper.at(row) * width + below + j));
            if taus == 0 {
                self.copy(of_lower.0, of_lower.1, |i, j| a.at(lower.at(i) * width + j));
                self.copy(of_upper.0, of_upper.1, |i, j| {
                    row_of_upper(i, j).unwrap_or_else(|| Real::from(0.0))
                });
            } else {
                let index = |k: &Option<usize>| k.map_or(Int::from(-1), number);
                let moved = Array::<Int>::named("moved", moved.iter().map(index));
                let rates = Array::<Real>::empty("taus", taus * unknowns);
                let tau_rate = |k: Int, j: Int| rates.at(k * number(unknowns) + j);
                let call = self.call("imaginary_rates", &given![g, pose, mode, rates]);
                name!(status = call.is::<Int>());
                return_status(status);
                count("i", 0, of_lower.1, |i| {
                    count("k", 0, tau_count, |k| {
                        name!(along = 0.0, square = 0.0);
                        count("j", below, number(unknowns), |j| {
                            along.increase(a.at(lower.at(i) * width + j) * tau_rate(k, j));
                            square.increase(tau_rate(k, j) * tau_rate(k, j));
                        });
                        let share =
                            (moved.at(i).is(k) & square.gt(0.0)).choose(along / square, 0.0);
                        of_lower.0.at(i * of_lower.1 + below + k).set(share);
                    });
                    count("j", 0, below, |j| {
                        of_lower.0.at(i * of_lower.1 + j).set(a.at(lower.at(i) * width + j));
                    });
                });
                self.copy(of_upper.0, of_upper.1, |i, j| {
                    let rate = tau_rate(i, below + j);
                    let row = row_of_upper(i - tau_count, j);
                    row.map_or(rate, |row| i.lt(tau_count).choose(rate, row))
                });
            }
            found.at(0).set(sign_of(of_lower.0, of_lower.1));
            found.at(1).set(sign_of(of_upper.0, of_upper.1));
            done()
        }));
    }
}
