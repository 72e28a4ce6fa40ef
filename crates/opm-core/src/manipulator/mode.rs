//! Working modes: one sign for every two-valued choice of a leg's chains.

use super::leg::{CompiledLeg, LegBranches, Section};
use crate::chain::Branch;

/// One sign for every two-valued choice of a manipulator, a set bit for a minus.
///
/// ```
/// use opm_core::Manipulator;
///
/// let manipulator = Manipulator::example("plano-spherical-5dof")?;
/// let mode = manipulator.parse_mode("-+ ++ ++ +")?;
/// assert_eq!(manipulator.format_mode(mode), "-+ ++ ++ +");
/// assert_ne!(mode, manipulator.home_mode());
/// assert!(manipulator.parse_mode("-+").is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Mode(pub(super) u64);

/// A text that is not a working mode of the manipulator.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("working mode `{given}`: {problem}, expected {}", expected(example))]
#[non_exhaustive]
pub struct ModeError {
    /// The text that was given.
    pub given: String,
    /// The reason why it is not.
    pub problem: String,
    /// A valid mode; empty where there are no choices.
    pub example: String,
}

fn expected(example: &str) -> String {
    match example {
        "" => "none: the mechanism has no choices, and one working mode".to_owned(),
        _ => format!("one sign (+ or -) for every choice, in one group for each leg: `{example}`"),
    }
}

impl Mode {
    /// The signs as bits, the first one lowest: a set bit for a minus.
    ///
    /// ```
    /// use opm_core::Manipulator;
    ///
    /// let manipulator = Manipulator::example("plano-spherical-5dof")?;
    /// assert_eq!(manipulator.parse_mode("-+ ++ +- +")?.bits(), 0b100001);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn bits(self) -> u64 {
        self.0
    }

    /// This mode with the minus signs of another one added.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// The mode with the other sign for every choice.
    pub(crate) fn opposite(self) -> Self {
        Self(!self.0)
    }
}

/// The modes in which some choices are given.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Choices {
    /// The given choices, as the minus signs of a mode.
    pub given: Mode,
    /// A mode in which they are as they are given.
    pub chosen: Mode,
}

impl Choices {
    /// All choices.
    pub fn of(mode: Mode) -> Self {
        Self { given: Mode(u64::MAX), chosen: mode }
    }
}

/// The choices of each leg, and their bits in a [`Mode`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ModeLayout {
    legs: Vec<LegChoices>,
    count: u32,
}

/// The bits of a leg's choices; `None` where a section has a single solution.
#[derive(Clone, Debug, PartialEq, Eq)]
struct LegChoices {
    /// The choices of dependent coordinates that follow from the leg's constraints.
    pose: Vec<u32>,
    lower: Option<u32>,
    upper: Option<u32>,
    first: Section,
}

impl LegChoices {
    /// The bits in the order of the mode's text, which is the order in which they are solved.
    fn written(&self) -> impl Iterator<Item = u32> {
        self.pose.iter().copied().chain(self.sections())
    }

    /// The bits of the two sections, in the order in which these are solved.
    fn sections(&self) -> impl Iterator<Item = u32> + use<> {
        let order = match self.first {
            Section::Upper => [self.upper, self.lower],
            Section::Lower => [self.lower, self.upper],
        };
        order.into_iter().flatten()
    }
}

impl ModeLayout {
    /// The layout for these legs, and for the choices of dependent coordinates, which belong to the legs with
    /// the numbers `of_pose`.
    pub fn new(legs: &[CompiledLeg], of_pose: &[usize]) -> Self {
        let mut count = 0;
        let legs = (legs.iter().enumerate())
            .map(|(number, leg)| {
                let pose = of_pose.iter().filter(|&&leg| leg == number).map(|_| {
                    count += 1;
                    count - 1
                });
                let mut choices = LegChoices {
                    pose: pose.collect(),
                    lower: None,
                    upper: None,
                    first: leg.split_section,
                };
                for section in leg.order() {
                    if leg.section(section).has_choice() {
                        let bit = match section {
                            Section::Lower => &mut choices.lower,
                            Section::Upper => &mut choices.upper,
                        };
                        *bit = Some(count);
                        count += 1;
                    }
                }
                choices
            })
            .collect();
        Self { legs, count }
    }

    /// The number of two-valued choices.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// The branches of a leg's two chains in a mode.
    #[inline(always)]
    pub fn branches(&self, mode: Mode, leg: usize) -> LegBranches {
        let branch = |bit: Option<u32>| match bit {
            Some(bit) if mode.0 >> bit & 1 == 1 => Branch::Minus,
            _ => Branch::Plus,
        };
        let choices = &self.legs[leg];
        LegBranches { lower: branch(choices.lower), upper: branch(choices.upper) }
    }

    /// The bits of the dependent coordinates that follow from a leg's constraints.
    pub fn pose_bits(&self, leg: usize) -> impl Iterator<Item = u32> + '_ {
        self.legs[leg].pose.iter().copied()
    }

    /// The bit of a leg's section, if that has a choice.
    pub fn section_bit(&self, leg: usize, section: Section) -> Option<u32> {
        match section {
            Section::Lower => self.legs[leg].lower,
            Section::Upper => self.legs[leg].upper,
        }
    }

    /// The modes with every combination of the choices of one leg's sections, and plus for everything else.
    pub fn leg_modes(&self, leg: usize) -> impl Iterator<Item = Mode> + use<> {
        let mut bits = [0; 2];
        let mut len = 0;
        for bit in self.legs[leg].sections() {
            bits[len] = bit;
            len += 1;
        }
        (0..1u64 << len).map(move |combination| {
            Mode((0..len).fold(0, |mode, i| mode | (combination >> i & 1) << bits[i]))
        })
    }

    /// Those of [`ModeLayout::leg_modes`] in which the leg's choices are as they are given, with their numbers.
    #[inline(always)]
    pub fn chosen_leg_modes(
        &self,
        Choices { given, chosen }: Choices,
        leg: usize,
    ) -> impl Iterator<Item = (usize, Mode)> + use<> {
        let own = self.legs[leg].sections().fold(0, |own, bit| own | 1 << bit);
        let differ = move |mode: Mode| (mode.0 ^ chosen.0) & given.0 & own;
        self.leg_modes(leg).enumerate().filter(move |&(_, mode)| differ(mode) == 0)
    }

    /// The mode with these branches of one leg, and plus for everything else.
    #[inline]
    pub fn leg_mode(&self, leg: usize, branches: LegBranches) -> Mode {
        let sign = |bit: Option<u32>, branch: Branch| match (bit, branch) {
            (Some(bit), Branch::Minus) => 1 << bit,
            _ => 0,
        };
        let choices = &self.legs[leg];
        Mode(sign(choices.lower, branches.lower) | sign(choices.upper, branches.upper))
    }

    /// The number of a leg's combination of choices in a mode, in the order of [`ModeLayout::leg_modes`].
    #[inline]
    pub fn of_leg(&self, mode: Mode, leg: usize) -> usize {
        self.legs[leg]
            .sections()
            .enumerate()
            .fold(0, |part, (i, bit)| part | ((mode.0 >> bit & 1) as usize) << i)
    }

    /// The text of a mode: one group of signs for each leg that has choices.
    pub fn format(&self, mode: Mode) -> String {
        let groups: Vec<String> = self
            .legs
            .iter()
            .map(|leg| {
                leg.written().map(|bit| if mode.0 >> bit & 1 == 1 { '-' } else { '+' }).collect()
            })
            .filter(|group: &String| !group.is_empty())
            .collect();
        groups.join(" ")
    }

    /// Parses the text of a mode; whitespace is ignored.
    pub fn parse(&self, text: &str) -> Result<Mode, ModeError> {
        let error = |problem: String| ModeError {
            given: text.to_owned(),
            problem,
            example: self.format(Mode::default()),
        };
        let mut signs = Vec::new();
        for c in text.chars().filter(|c| !c.is_whitespace()) {
            match c {
                '+' => signs.push(false),
                '-' | '\u{2212}' => signs.push(true),
                other => return Err(error(format!("`{other}` is not a sign"))),
            }
        }
        if signs.len() != self.count as usize {
            return Err(error({
                let plural = if signs.len() == 1 { "" } else { "s" };
                format!("{} sign{plural} for {} choices", signs.len(), self.count)
            }));
        }
        let bits = self.legs.iter().flat_map(LegChoices::written);
        Ok(Mode(bits.zip(signs).fold(0, |mode, (bit, minus)| mode | u64::from(minus) << bit)))
    }
}
