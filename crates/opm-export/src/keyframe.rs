//! Postures at the home pose, one for each working mode.

use opm_core::linkage::Linkage;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::Mechanism;

/// Most two-valued choices of a mechanism whose modes are all written: a thousand postures.
const MOST_CHOICES: u32 = 10;

/// A posture of a mechanism at its home pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Keyframe {
    /// The working mode with `p` and `m` for its signs and `_` between the legs; `home` where there is no choice.
    pub name: String,
    /// Every joint coordinate, radians and metres, leg by leg.
    pub joints: Vec<f64>,
    /// Whether all of them are within their limits.
    pub within_limits: bool,
}

/// Where the postures come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The working modes of a manipulator, at the home pose.
    Modes,
    /// The branches of a linkage, with its input at home.
    Branches,
    /// The mechanism has more modes than are written: the one that it is assembled in.
    HomeMode,
    /// The mechanism has no closed forms: the posture that its file gives.
    Home,
}

/// The postures of a mechanism at its home pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Keyframes {
    /// Those that reach it, in the order of the modes.
    pub reached: Vec<Keyframe>,
    /// The names of the modes that do not.
    pub missed: Vec<String>,
    /// The name of the one that the mechanism is assembled in.
    pub home: String,
    /// Where they come from.
    pub source: Source,
}

impl Keyframes {
    /// The postures of any mechanism: of its modes, of its branches, or home alone.
    pub fn of(mechanism: &Mechanism) -> Self {
        if let Ok(manipulator) = Manipulator::new(mechanism.clone()) {
            return Self::of_manipulator(&manipulator);
        }
        let linkage = Linkage::new(mechanism).ok();
        linkage
            .and_then(|linkage| Self::of_linkage(&linkage))
            .unwrap_or_else(|| Self::home(mechanism))
    }

    /// A posture for each working mode of a manipulator.
    pub fn of_manipulator(manipulator: &Manipulator) -> Self {
        let every = manipulator.choices() <= MOST_CHOICES;
        let source = if every { Source::Modes } else { Source::HomeMode };
        let modes: Vec<_> = match source {
            Source::Modes => manipulator.modes().collect(),
            _ => vec![manipulator.home_mode()],
        };
        let pose = manipulator.home_pose();
        let mut buffer = manipulator.solution();
        let home = name(&manipulator.format_mode(manipulator.home_mode()));
        let mut keyframes = Self { reached: Vec::new(), missed: Vec::new(), home, source };
        for mode in modes {
            let name = name(&manipulator.format_mode(mode));
            match manipulator.inverse(&pose, mode, &mut buffer) {
                Ok(Some(solution)) => keyframes.reached.push(Keyframe {
                    name,
                    joints: solution.joints().to_vec(),
                    within_limits: solution.within_limits(),
                }),
                Ok(None) | Err(_) => keyframes.missed.push(name),
            }
        }
        keyframes
    }

    /// A posture for each branch of a linkage, with the first actuated joint, or else the first one, at home; `None`
    /// where that joint is no input.
    pub fn of_linkage(linkage: &Linkage) -> Option<Self> {
        let mechanism = linkage.mechanism();
        let first =
            mechanism.joints().find(|joint| joint.actuated).or(mechanism.joints().next())?;
        let input = linkage.input(&first.coordinates[0].name)?;
        let positions = input.solve(input.coordinate().home);
        let reached = positions.into_iter().map(|position| Keyframe {
            name: name(&position.branch.to_string()),
            joints: position.joints,
            within_limits: position.within_limits,
        });
        let (reached, home) = (reached.collect(), name(&input.home_branch().to_string()));
        Some(Self { reached, missed: Vec::new(), home, source: Source::Branches })
    }

    /// The posture at home alone.
    pub fn home(mechanism: &Mechanism) -> Self {
        let joints = mechanism.coordinates().map(|c| c.home).collect();
        let home = name("");
        let keyframe = Keyframe { name: home.clone(), joints, within_limits: true };
        Self { reached: vec![keyframe], missed: Vec::new(), home, source: Source::Home }
    }
}

/// The name of a mode, from its signs.
fn name(signs: &str) -> String {
    let letter = |sign| match sign {
        '+' => 'p',
        '-' => 'm',
        _ => '_',
    };
    match signs.trim() {
        "" => "home".to_owned(),
        signs => signs.chars().map(letter).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mode_is_named_by_letters() {
        assert_eq!(name("+- -+ +"), "pm_mp_p");
        assert_eq!(name(""), "home");
    }
}
