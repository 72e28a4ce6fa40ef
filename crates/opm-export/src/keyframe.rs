//! Postures at the home pose, one for each working mode.

use opm_core::linkage::{Linkage, LinkageBranch};
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
    /// Whether the platform can move while the actuated joints are held (a parallel singularity).
    pub loose: bool,
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
pub struct Keyframes<'a> {
    mechanism: &'a Mechanism,
    reached: Vec<Keyframe>,
    missed: Vec<String>,
    home: String,
    source: Source,
}

impl<'a> Keyframes<'a> {
    /// The postures of any mechanism: of its modes, of its branches, or home alone.
    pub fn of(mechanism: &'a Mechanism) -> Self {
        if let Ok(manipulator) = Manipulator::new(mechanism.clone()) {
            return Self::in_modes(mechanism, &manipulator);
        }
        let linkage = Linkage::new(mechanism).ok();
        linkage
            .and_then(|linkage| Self::in_branches(mechanism, &linkage))
            .unwrap_or_else(|| Self::at_home(mechanism))
    }

    /// A posture for each working mode of a manipulator.
    pub fn of_manipulator(manipulator: &'a Manipulator) -> Self {
        Self::in_modes(manipulator.mechanism(), manipulator)
    }

    /// The mechanism.
    pub fn mechanism(&self) -> &'a Mechanism {
        self.mechanism
    }

    /// The postures that reach the home pose, in the order of the modes.
    pub fn reached(&self) -> &[Keyframe] {
        &self.reached
    }

    /// The names of the modes that do not reach it.
    pub fn missed(&self) -> &[String] {
        &self.missed
    }

    /// The name of the posture that the mechanism is assembled in.
    pub fn home(&self) -> &str {
        &self.home
    }

    /// Where the postures come from.
    pub fn source(&self) -> Source {
        self.source
    }

    pub(crate) fn push(&mut self, keyframe: Keyframe) {
        self.reached.push(keyframe);
    }

    fn in_modes(mechanism: &'a Mechanism, manipulator: &Manipulator) -> Self {
        let every = manipulator.choices() <= MOST_CHOICES;
        let source = if every { Source::Modes } else { Source::HomeMode };
        let modes: Vec<_> = match source {
            Source::Modes => manipulator.modes().collect(),
            _ => vec![manipulator.home_mode()],
        };
        let pose = manipulator.home_pose();
        let mut buffer = manipulator.solution();
        let (mut jacobians, length) =
            (manipulator.jacobians(), manipulator.characteristic_length());
        // With too few motors every posture is loose, which says nothing of it.
        let held = manipulator.actuated().len() >= manipulator.task_coordinates().len();
        let (mut reached, mut missed) = (Vec::new(), Vec::new());
        for mode in modes {
            let name = name(&manipulator.format_mode(mode));
            let Ok(Some(solution)) = manipulator.inverse(&pose, mode, &mut buffer) else {
                missed.push(name);
                continue;
            };
            let singular = manipulator.differentiate(solution, &mut jacobians).is_ok() && {
                let conditioning = manipulator.conditioning(&jacobians, length);
                conditioning.manipulability.is_infinite()
            };
            reached.push(Keyframe {
                name,
                joints: solution.joints().to_vec(),
                within_limits: solution.within_limits(),
                loose: held && singular,
            });
        }
        let home = name(&manipulator.format_mode(manipulator.home_mode()));
        Self { mechanism, reached, missed, home, source }
    }

    /// The input is the first actuated joint, or else the first one; `None` where that joint cannot be an input.
    fn in_branches(mechanism: &'a Mechanism, linkage: &Linkage) -> Option<Self> {
        let first =
            mechanism.joints().find(|joint| joint.actuated).or(mechanism.joints().next())?;
        let input = linkage.input(&first.coordinates[0].name)?;
        let positions = input.solve(input.coordinate().home);
        let reached = positions.into_iter().map(|position| Keyframe {
            name: branch_name(position.branch),
            joints: position.joints,
            within_limits: position.within_limits,
            loose: false,
        });
        let (reached, home) = (reached.collect(), branch_name(input.home_branch()));
        Some(Self { mechanism, reached, missed: Vec::new(), home, source: Source::Branches })
    }

    fn at_home(mechanism: &'a Mechanism) -> Self {
        let joints = mechanism.coordinates().map(|c| c.home).collect();
        let home = name("");
        let reached =
            vec![Keyframe { name: home.clone(), joints, within_limits: true, loose: false }];
        Self { mechanism, reached, missed: Vec::new(), home, source: Source::Home }
    }
}

/// The name of a branch: its signs as letters, or `branch` and its number.
fn branch_name(branch: LinkageBranch) -> String {
    match branch {
        LinkageBranch::Signs(signs) => name(&signs.to_string()),
        LinkageBranch::Arc(number) => format!("branch{number}"),
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
