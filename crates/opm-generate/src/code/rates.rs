//! The functions of the joint rates and of the Jacobian.
//!
//! As in `opm-core`, the closure of a leg is differentiated one section at a time, in the section's own frame. The rows of
//! the inverse of its screws are the reciprocal screws ([`screws`]), which give the rates of its joints. A section that
//! constrains the platform has further rows, of joints that it lacks: their rates are zero, which gives the rates of the
//! coordinates that follow from the others ([`follow`]).

pub mod follow;
mod motions;
mod screws;

use super::displacement::displacement_type;
use super::interface::{Needs, SECTIONS};
use super::*;
use crate::library::*;
use crate::trace::*;

/// What the columns of rates belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Columns {
    /// The coordinates.
    Coordinates,
    /// The same, but for the Euler angles, which are singular: in their place are the rotations about the directions of
    /// the section's frame.
    Motions,
}

/// The parameters of the function of the rates of a leg.
struct LegRates {
    g: Any,
    v: Any,
    at: Any,
    t: Array<Twists>,
    /// The rates of all joints, and those of joints that legs lack.
    all: Array<Real>,
    locked: Array<Real>,
}

const PARAMETERS: [&str; 6] = ["g", "v", "at", "t", "all", "locked"];

impl Writer<'_> {
    /// The functions of the Jacobian and of the rates.
    pub fn rates(&self) {
        let mut lacking = 0;
        for leg in 0..self.forms.legs.len() {
            lacking += self.leg_rates(leg, lacking);
        }
        let of_jacobian = Traced::new(
            "jacobian",
            "The rates of all joints for unit rates of the coordinates of the pose: entry i * NAME_COORDINATES + j is that of \
             joint i by coordinate j, rad/s and m/s. It returns what NAME_inverse returns; or NAME_LEGS + i where leg i, from \
             1, is singular; or 2 * NAME_LEGS + 1 where coordinates that follow from those of the pose have no rates.",
        );
        let (dependent, turns) = (self.dependent(), self.turns());
        if turns {
            self.motions();
        }
        if dependent {
            self.differentiate(lacking);
            self.by_pose();
        }
        let length = self.fields.len() * self.manipulator.task_coordinates().len();
        self.add(of_jacobian.public().body(|p| {
            let of_pose = of_pose(p);
            let jacobian = written(p, "jacobian", length);
            match (dependent, turns) {
                (true, _) => self.of_independent(of_pose, jacobian),
                (false, true) => self.by_coordinates(of_pose, jacobian),
                (false, false) => {
                    self.rates_body(of_pose, None, jacobian, None);
                }
            }
            done()
        }));
        self.joint_rates(length);
    }

    /// The function of the rates of all joints for those of the coordinates.
    fn joint_rates(&self, length: usize) {
        let function = Traced::new(
            "rates",
            "The rates of all joints for given rates of the coordinates of the pose. It returns what NAME_jacobian returns; or \
             -NAME_COORDINATES - i where rate i, from 1, is no number.",
        );
        self.add(function.public().body(|p| {
            let (g, pose, mode) = of_pose(p);
            let (rates, joint_rates) =
                (p.add::<In<[Real]>>("rates"), p.add::<Out<[Real]>>("joint_rates"));
            let jacobian = Array::<Real>::empty("jacobian", length);
            name!(status = self.call("jacobian", &given![g, pose, mode, jacobian]).is::<Int>());
            return_status(status);
            status.set(numbers(rates, COORDINATES));
            return_status(status);
            count("i", 0, JOINTS, |i| {
                joint_rates.at(i).set(0.0);
                count("j", 0, COORDINATES, |j| {
                    joint_rates.at(i).increase(jacobian.at(i * COORDINATES + j) * rates.at(j));
                });
            });
            done()
        }));
    }

    /// The rates of all joints by all motions, or by all coordinates where there are none. It gives those of joints that legs
    /// lack, which are written to `locked`, or to a variable.
    fn rates_body(
        &self,
        of_pose: (Any, Array<Real>, Bits),
        q: Option<Array<Real>>,
        all: Array<Real>,
        locked: Option<Array<Real>>,
    ) -> Array<Real> {
        let (g, pose, mode) = of_pose;
        let columns = if self.turns() { Columns::Motions } else { Columns::Coordinates };
        let legs = || (1..=self.forms.legs.len()).map(|leg| (leg, format!("leg{leg}_rates")));
        let takes = |name: &str, parameter: &str| self.find(name, |one| one.takes(parameter));
        let needs_v = legs().any(|(_, name)| takes(&name, "v") == Some(true));
        let at = displacements("at");
        let count_of = self.task.coordinates.len();
        let t = Array::<Twists>::empty("t", count_of);
        let own = (locked.is_none() && self.dependent())
            .then(|| Array::empty("locked", (self.lacking() * count_of).max(1)));
        let locked = locked.or(own).unwrap_or(all);
        let needs = match self.is_whole() {
            true => self.needs_of_platform(),
            false => Needs { moved: [needs_v, false], ..Needs::default() },
        };
        let start = self.start_or_return(of_pose, needs, q);
        start.status.set(self.call("close", &given![g, pose, mode, at]).is::<Int>());
        return_status(start.status);
        self.columns(columns, g, start.q, t);
        let own = ["at", "t", "all", "locked"].into_iter().zip(given![at, t, all, locked]);
        let mut known: Vec<(&str, Any)> = start.known.iter().copied().chain(own).collect();
        if self.is_whole() {
            let of_platform = self.platform_motions(g, &start, t);
            known.extend(["motions", "point"].into_iter().zip(of_platform));
        }
        for (leg, name) in legs().filter(|(_, name)| self.find(name, |_| ()).is_some()) {
            let singular = self.call_with(&name, &known).is::<Int>().is_set();
            when(singular, || give(LEGS + number(leg)));
        }
        locked
    }

    /// Gives the twists `t` of the sections for a unit of each column.
    pub fn columns(&self, of: Columns, g: Any, q: Array<Real>, t: Array<Twists>) {
        let zero = vector_of(0.0, 0.0, 0.0);
        let mut twists = vec![[zero, zero]; self.task.coordinates.len()];
        for section in SECTIONS {
            let screws = self.coordinate_screws(section, of, g, q);
            for (number, screw) in self.numbers(section).into_iter().zip(screws) {
                twists[number][section as usize] = screw;
            }
        }
        for (place, [lower, upper]) in twists.into_iter().enumerate() {
            let rises = self.forms.height.is_some_and(|height| height.coordinate == place);
            let rise = if rises { 1.0 } else { 0.0 };
            t.at(number(place)).set(twists_of(lower, upper, rise));
        }
    }

    /// The function of one leg: the columns of its joints' rates, and of the rates of joints that it lacks, whose rows begin
    /// at `first_lacking`. It gives how many these are.
    fn leg_rates(&self, leg: usize, first_lacking: usize) -> usize {
        if let Some(form) = &self.forms.legs[leg].whole {
            return self.whole_rates(leg, form, first_lacking);
        }
        let name = crate::names::comment(&self.manipulator.mechanism().legs[leg].name);
        let comment = format!(
            "Leg {}, {name}: the rates of its joints for the twists t of its sections. It returns 1 where it is singular.",
            leg + 1
        );
        let function = Traced::new(&format!("leg{}_rates", leg + 1), &comment);
        let function = function.body(|p| {
            let of_lower = displacement_type(self.kind(Section::Lower)).unwrap_or(Type::Int);
            let of_leg = LegRates {
                g: geometry(p),
                v: p.of_kind("v", of_lower, Pass::Value),
                at: p.of_kind("at", Type::Struct(DISPLACEMENTS.to_owned()), Pass::Read),
                t: p.add::<In<[Twists]>>("t"),
                all: p.add::<Out<[Real]>>("all"),
                locked: p.add::<Out<[Real]>>("locked"),
            };
            self.leg_rates_body(leg, first_lacking, &of_leg);
            done()
        });
        // One that writes nothing is none.
        let function = function.without_unused(&PARAMETERS);
        if function.takes("all") || function.takes("locked") {
            self.add(function);
        }
        SECTIONS.map(|section| self.lacking_in(leg, section).len()).iter().sum()
    }

    fn leg_rates_body(&self, leg: usize, first_lacking: usize, of_leg: &LegRates) {
        let LegRates { g, v, at, t, all, locked } = *of_leg;
        let form = &self.forms.legs[leg];
        let count_of = self.task.coordinates.len();
        let second = super::leg::other(form.first);
        let order = [form.first, second];
        let rows = order.map(|section| self.section_rows(leg, section, g, at));
        let leaning = rows.iter().find_map(|rows| rows.leaning);
        let lean = form.lift.as_ref().and_then(|lift| lift.lean);
        let sloped = self.forms.height.is_some_and(|height| height.slope != 0.0);
        let lower_or_upper = |twists: Twists, section| match section {
            Section::Lower => twists.lower,
            Section::Upper => twists.upper,
        };
        let is_bridge = |joint: &usize| form.section(form.first).coordinates[*joint].is_none();
        let along = (rows[0].free.iter().any(is_bridge) && rows[1].has_any())
            .then(|| named("along", self.along_moved(second, g, v)));
        let mut lacking = first_lacking;
        count("i", 0, number(count_of), |i| {
            let mut tau: Option<Real> = None;
            for (place, (section, rows)) in order.into_iter().zip(&rows).enumerate() {
                let of_section = form.section(section);
                let word = word(section);
                let mut twist = lower_or_upper(t.at(i), section);
                if let (1, Some(tau), Some(along)) = (place, tau, along) {
                    twist = match section {
                        // L = v exp(I tau)
                        Section::Lower => add(twist, tau, along),
                        // U = exp(-I tau) b
                        Section::Upper => {
                            let twist = add(twist, -tau, along);
                            self.shifted_back(leg, g, at, twist)
                        }
                    };
                }
                let mut rise = t.at(i).rise;
                if place == 1 && form.lift.is_some() {
                    let slope = tau.filter(|_| sloped).map(|tau| g.member::<Real>("slope") * tau);
                    rise = named("rise", slope.map_or(rise, |slope| rise + slope));
                }
                if let (true, Some(leaning)) =
                    (lean.is_some_and(|lean| lean.section == section), leaning)
                {
                    twist = add(twist, -rise, leaning);
                }
                if rows.has_any() {
                    twist = named(&format!("{word}_twist"), twist);
                }
                for (row, &joint) in rows.rows().zip(&rows.free) {
                    let rate = dot(row, twist);
                    let part = of_section.slider.is_some_and(|(slider, _)| slider == joint);
                    let by = || g.member::<Part>(&format!("leg{}_part", leg + 1)).rate;
                    match of_section.coordinates[joint] {
                        Some(coordinate) => {
                            let rate = if part { rate / by() } else { rate };
                            all.at(number(coordinate * count_of) + i).set(rate);
                        }
                        None => {
                            let rate = if section == Section::Lower { -rate } else { rate };
                            tau = Some(named("tau", if part { rate / by() } else { rate }));
                        }
                    }
                }
                for row in rows.lacking() {
                    locked.at(number(lacking * count_of) + i).set(dot(row, twist));
                    lacking += 1;
                }
                if let (1, Some(lift)) = (place, &form.lift) {
                    let kind = if lean.is_some() { LeaningLift::kind() } else { Lift::kind() };
                    let rate = g.part(&format!("leg{}_lift", leg + 1), kind).member::<Real>("rate");
                    all.at(number(lift.coordinate * count_of) + i).set(rate * rise);
                }
            }
        });
    }
}
