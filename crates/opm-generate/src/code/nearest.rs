//! The function of the mode nearest to a previous solution.

use super::displacement::displacement_type;
use super::leg::{Given, other};
use super::*;
use crate::library::*;
use crate::trace::*;

/// The parameters of the function of one leg.
struct Nearest {
    g: Any,
    moved: [Any; 2],
    rise: Real,
    body: Body,
    previous: Array<Real>,
    mode: Bits,
    joints: Array<Real>,
    imaginary: Array<Real>,
    least_motion: Real,
}

impl Writer<'_> {
    /// The function of the interface, and those that it calls: of each leg, the best of its own choices.
    pub fn nearest(&self) {
        for leg in 0..self.forms.legs.len() {
            self.nearest_of_leg(leg);
        }
        self.nearest_of_legs();
        let head = |p: &mut Parameters| {
            let (g, pose) = (geometry(p), p.add::<In<[Real]>>("pose"));
            (g, pose, p.add::<In<[Real]>>("previous"), p.add::<Out<Bits>>("mode"))
        };
        let function = Traced::new(
            "nearest",
            "Every joint at a pose in that mode in which the joints move least from previous ones (the sum of the squares, \
             lengths over the size of the mechanism), angles with the revolutions nearest to the previous ones. It writes the \
             mode, too. Unless it returns 0, joints, imaginary and mode have no meaning.",
        );
        let outer = &self.forms.step_bits;
        self.add(function.public().body(|p| {
            let (g, pose, previous, mode) = head(p);
            let joints = p.add::<Out<[Real]>>("joints");
            let imaginary = p.add::<Out<[Real]>>("imaginary");
            let all = |mode: Bits, joints: Array<Real>, imaginary: Array<Real>, moved: Real| {
                let given = given![g, pose, previous, mode, joints, imaginary, moved];
                self.call("nearest_legs", &given).is::<Int>()
            };
            if outer.is_empty() {
                let moved = Real::empty("moved");
                mode.set(0);
                return all(mode, joints, imaginary, moved);
            }
            let others = self.manipulator.imaginary().len();
            name!(least = Real::infinity(), moved = 0.0);
            let other = Array::<Real>::empty("other", self.fields.len());
            let other_imaginary = Array::named("other_imaginary", vec![0.0; others.max(1)]);
            name!(best = Int::from(-1), status = done());
            note("Those choices on which coordinates of the pose depend.");
            count_bits("i", 1 << outer.len(), |i| {
                name!(tried = spread_bits(None, outer, i));
                name!(found = all(tried, other, other_imaginary, moved));
                when(found.is_not(0), || status.set(found)).otherwise(|| {
                    when(best.lt(0) | moved.lt(least), || {
                        least.set(moved);
                        best.set(i.int());
                        mode.set(tried);
                        count("j", 0, number(self.fields.len()), |j| joints.at(j).set(other.at(j)));
                        if others > 0 {
                            count("j", 0, number(others), |j| {
                                imaginary.at(j).set(other_imaginary.at(j));
                            });
                        }
                    });
                });
            });
            best.lt(0).choose(status, 0)
        }));
    }

    /// The function of all legs.
    fn nearest_of_legs(&self) {
        let function = Traced::new(
            "nearest_legs",
            "The same for all legs, with the choices in mode on which coordinates of the pose depend.",
        );
        self.add(function.body(|p| {
            let (g, pose) = (geometry(p), p.add::<In<[Real]>>("pose"));
            let (previous, mode) = (p.add::<In<[Real]>>("previous"), p.add::<Out<Bits>>("mode"));
            let [joints, imaginary] =
                ["joints", "imaginary"].map(|name| p.add::<Out<[Real]>>(name));
            let moved = p.add::<Out<Real>>("moved");
            let start = self.start_or_return((g, pose, mode), self.needs_of_legs(), None);
            moved.set(0.0);
            let own = given![previous, mode, joints, imaginary, moved];
            let own = ["previous", "mode", "joints", "imaginary", "moved"].into_iter().zip(own);
            let known: Vec<(&str, Any)> = start.known.iter().copied().chain(own).collect();
            for leg in 1..=self.forms.legs.len() {
                let call = self.call_with(&format!("nearest{leg}"), &known).is::<Int>();
                when(call.is_set(), || give(number(leg)));
            }
            start.status
        }));
    }

    /// The bits of a mode that are one leg's own, and on which no dependent coordinate depends.
    fn own_bits(&self, leg: usize) -> Vec<u32> {
        let leg = &self.forms.legs[leg];
        let bits = [leg.section(leg.first).bit, leg.lower.bit, leg.upper.bit];
        let mut own: Vec<u32> =
            bits.into_iter().flatten().filter(|bit| !self.forms.step_bits.contains(bit)).collect();
        own.sort_unstable();
        own.dedup();
        own
    }

    /// The best of the choices of one leg.
    fn nearest_of_leg(&self, leg: usize) {
        let function = Traced::new(
            &format!("nearest{}", leg + 1),
            &format!(
                "The choices of leg {} in which its joints are nearest to a previous solution: they are added to mode, and the \
                 motion to them to moved.",
                leg + 1
            ),
        );
        let function = function.body(|p| {
            let kind = |of| displacement_type(self.kind(of)).unwrap_or(Type::Int);
            let nearest = Nearest {
                g: geometry(p),
                moved: [Section::Lower, Section::Upper]
                    .map(|of| p.of_kind(symbol(of), kind(of), Pass::Value)),
                rise: p.add::<Real>("rise"),
                body: p.add::<Body>("body"),
                previous: p.add::<In<[Real]>>("previous"),
                mode: p.add::<Out<Bits>>("mode"),
                joints: p.add::<Out<[Real]>>("joints"),
                imaginary: p.add::<Out<[Real]>>("imaginary"),
                least_motion: p.add::<Out<Real>>("moved"),
            };
            self.nearest_body(leg, &nearest)
        });
        self.add(function.without_unused(&["v", "b", "rise", "body"]));
    }

    fn nearest_body(&self, leg: usize, nearest: &Nearest) -> Int {
        let Nearest {
            g,
            moved: [v, b],
            rise,
            body,
            previous,
            mode,
            joints,
            imaginary,
            least_motion,
        } = *nearest;
        let own = self.own_bits(leg);
        let numbers = self.joints_of(leg);
        name!(rest = mode);
        let at = displacements("at");
        let value = Array::<Real>::empty("value", numbers.len().max(1));
        let total = Real::empty("total");
        name!(least = Real::infinity());
        let needed = |name: &str| self.leg_takes(leg, name);
        let missed = if needed("missed") { named("missed", 0.0) } else { least };
        let previous_tau = if needed("near") {
            named("near", self.previous_tau(leg, g, b, previous))
        } else {
            least
        };
        name!(found = Int::from(0));
        count_bits("i", 1 << own.len(), |i| {
            let mask = if own.is_empty() { rest } else { spread_bits(Some(rest), &own, i) };
            name!(tried = mask);
            let known = ["g", "v", "b", "rise", "body", "near", "mode", "at", "missed"];
            let given = given![g, v, b, rise, body, previous_tau, tried, at, missed];
            let known: Vec<(&str, Any)> = known.into_iter().zip(given).collect();
            if let Some(fails) = any_fails(&self.leg_calls(leg, &known)) {
                when(fails, again);
            }
            self.near_values(leg, g, at, previous, value);
            total.set(0.0);
            for (place, &joint) in numbers.iter().enumerate() {
                let before = previous.at(number(joint));
                total.increase(moved(self.joint(g, joint), value.at(number(place)), before));
            }
            when(!found.is_set() | total.lt(least), || {
                found.set(1);
                least.set(total);
                mode.set(tried);
                for (place, &joint) in numbers.iter().enumerate() {
                    joints.at(number(joint)).set(value.at(number(place)));
                }
                let angle_of = |field: &str| angle(at.member::<Complex>(field));
                if let Some((place, value)) = self.imaginary_value(leg, g, at, angle_of) {
                    imaginary.at(number(place)).set(value);
                }
            });
        });
        least_motion.increase(least);
        (!found.is_set()).int()
    }

    /// The numbers of the joint coordinates of a leg.
    fn joints_of(&self, leg: usize) -> Vec<usize> {
        let legs = &self.manipulator.mechanism().legs;
        let first: usize = legs[..leg].iter().map(|leg| leg.coordinates().count()).sum();
        (first..first + legs[leg].coordinates().count()).collect()
    }

    /// The values of a leg's joints, with the revolutions that are nearest to the previous ones.
    fn near_values(&self, leg: usize, g: Any, at: Any, previous: Array<Real>, value: Array<Real>) {
        let joints = self.joints_of(leg);
        for (place, &joint) in joints.iter().enumerate() {
            if self.ball_of(joint).is_some() {
                continue;
            }
            let field = &self.fields[joint];
            let known = self.joint(g, joint);
            value.at(number(place)).set(match self.given(joint) {
                Given::Value => known.home + at.member::<Real>(field),
                Given::Direction | Given::Turns => {
                    nearest_angle(known, at.member::<Complex>(field), previous.at(number(joint)))
                }
            });
        }
        for of in [Section::Lower, Section::Upper] {
            let section = self.forms.legs[leg].section(of);
            let (true, [Some(x), Some(y), Some(z)]) =
                (section.chain.is_ball(), section.coordinates)
            else {
                continue;
            };
            let own = [x, y, z];
            block(|| {
                let before =
                    own.map(|joint| previous.at(number(joint)) - self.joint(g, joint).home);
                let (axis, half) = self.ball_at(at, leg, of);
                name!(vector = rotation_vector(axis, half));
                let before = vector_of(before[0], before[1], before[2]);
                name!(near_previous = nearest_rotation(vector, before));
                let parts = [near_previous.x, near_previous.y, near_previous.z];
                for (joint, part) in own.into_iter().zip(parts) {
                    let place = number(joint - joints[0]);
                    value.at(place).set(self.joint(g, joint).home + part);
                }
            });
        }
    }

    /// The displacement along the intersection motion at the previous solution, up to what a revolution does not change:
    /// the rotation of the joints on the axis where revolutions are counted.
    fn previous_tau(&self, leg: usize, g: Any, b: Any, previous: Array<Real>) -> Real {
        let leg = &self.forms.legs[leg];
        let second = other(leg.first);
        let form = leg.section(second);
        let zero = Real::from(0.0);
        let Chain::Cylindrical(chain) = &form.chain else { return zero };
        let joints = chain.joints().iter().zip(form.coordinates);
        let turned = joints.fold(zero, |sum, (joint, coordinate)| {
            let Some(coordinate) = coordinate.filter(|_| joint.rotation != 0.0) else { return sum };
            let turned = previous.at(number(coordinate)) - self.joint(g, coordinate).home;
            if joint.rotation > 0.0 { sum + turned } else { sum - turned }
        });
        match second {
            Section::Lower => turned,
            Section::Upper => b.is::<Cylindrical>().angle - turned,
        }
    }
}

/// A mode with the bits of a combination.
fn spread_bits(mode: Option<Bits>, bits: &[u32], combination: Bits) -> Bits {
    let parts = (0_u32..).zip(bits).map(|(place, &bit)| ((combination >> place) & 1) << bit);
    mode.into_iter().chain(parts).reduce(|a, b| a | b).unwrap_or_else(|| Bits::from(0))
}
