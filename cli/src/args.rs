//! Every argument of the command line; the doc comments are the help.

mod accuracy;
mod analyze;
mod calibrate;
mod check;
mod convert;
mod design;
mod explore;
mod export;
mod generate;
mod heading;
mod measure;
mod motion;
mod new;
mod path;
mod pose;
mod recording;
mod setup;
mod table;
mod tool;
mod workspace;

pub use accuracy::AccuracyArgs;
pub use analyze::AnalyzeArgs;
pub use calibrate::CalibrateArgs;
pub use check::CheckArgs;
pub use convert::ConvertArgs;
pub use design::DesignArgs;
pub use explore::ExploreArgs;
pub use export::{ExportArgs, ExportFormat, MjcfArgs, UrdfArgs};
pub use generate::{CodeArgs, GenerateArgs, Language};
pub use heading::FEW;
pub use measure::{MeasureArgs, SectionName};
pub use motion::{LinkageArgs, TableUnits, TrajectoryArgs};
pub use new::NewArgs;
pub use path::PathArgs;
pub use pose::{FkArgs, IkArgs, VelocityArgs};
pub use recording::{InspectArgs, LayoutArgs, PlotArgs, RecoverArgs};
pub use setup::SetupArgs;
pub use table::MotionTableArgs;
pub use tool::ToolArgs;
pub use workspace::{CloudArgs, MergeArgs, WorkspaceArgs};

use crate::change::Change;
use crate::pose::{GridAxis, Number};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Parser, Subcommand, ValueEnum, ValueHint};
use opm_core::mechanism::OrientationCoordinates;
use std::path::PathBuf;

/// Columns of the help on a terminal that has as many.
pub const WIDEST: usize = 100;

/// Kinematics and workspaces of overconstrained parallel manipulators
///
/// Reads a mechanism file, finds its partial subspaces and imaginary joints from the joint screws
/// alone, and solves joint values and workspaces in closed form.
///
/// Numbers without a unit are metres and radians; 10mm, 2.5cm, 20um, 1in, 15deg, 0.2rad, 3mrad and 20urad carry theirs.
/// JSON, CSV and MCAP are always SI; text is in the units of the mechanism file.
///
/// Exit status: 0 done, 1 the work failed, 2 wrong usage, 130 interrupted.
#[derive(Debug, Parser)]
#[command(name = "opm", version, max_term_width = WIDEST, after_long_help = ROOT_EXAMPLES)]
pub struct Args {
    /// The subcommand.
    #[command(subcommand)]
    pub command: Command,
    /// Options of every subcommand.
    #[command(flatten)]
    pub output: Output,
}

const ROOT_EXAMPLES: &str = "\
Examples:
  opm examples                                         what comes with opm
  opm new delta --set crank=150mm -o mine.toml         a robot by its dimensions
  opm decompose plano-spherical-5dof                   how a mechanism falls into two sections
  opm check plano-spherical-5dof                       its closed forms against other computations
  opm ik plano-spherical-5dof --pose x=10mm,xi=15deg   joint values at a pose
  opm velocity plano-spherical-5dof --rates zeta=1     joint rates, and how near it is to singular
  opm analyze plano-spherical-5dof --wrench 0,0,0,1,0,0   what the actuators carry at a pose
  opm calibrate plano-spherical-5dof --plan 40 -o plan.csv   poses to measure a machine at
  opm accuracy plano-spherical-5dof --axes 0.05mm,0.02deg   what errors of its parts do
  opm design problem.toml -o better.toml               dimensions that reach more, by optimisation
  opm fk translational-helical-3dof --joints S1=9mm,S2=-14mm,S3=5mm
                                                       poses at joint values
  opm workspace plano-spherical-5dof -o cloud.mcap     its workspace, for Foxglove or Rerun
  opm measure plano-spherical-5dof --section upper     its share of all orientations, with bounds
  opm merge part-*.mcap -o cloud.mcap                  the parts of a sweep, joined to one recording
  opm trajectory plano-spherical-5dof --motion plano-spherical-sinusoids -o play.mcap
                                                       a motion, as a recording that plays
  opm path planar-3rpr --from x=14mm --to x=9mm        a path without a singularity
  opm linkage bennett-double-spherical-6r              joint values of a loop with one input
  opm plot cloud.mcap -o cloud.svg                     a picture of a recording
  opm inspect cloud.mcap                               what a recording holds
  opm recover cloud.mcap.partial                       what a run that was cut short has recorded
  opm layout cloud.mcap -o layout.json                 how Foxglove or Lichtblick shows it
  opm explore plano-spherical-5dof -o robot.html       a page for browsers, workspace and all
  opm convert plano-spherical-5dof --joints            a family as a list of joints
  opm export mjcf plano-spherical-5dof -o plano.xml    a model for MuJoCo, loops and all
  opm generate c plano-spherical-5dof -o controller    kinematics as C, for a controller
  opm help format                                      how to write a mechanism file";

/// Options of every subcommand.
#[derive(Debug, clap::Args)]
pub struct Output {
    /// How results are printed
    #[arg(long, global = true, value_enum, default_value_t = Format::Text)]
    pub format: Format,
    /// No progress, notes or warnings: only results and errors
    #[arg(short, long, global = true)]
    pub quiet: bool,
    /// Results are made and not printed: for fuzzers.
    #[arg(skip)]
    pub silent: bool,
}

/// How results are printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// Tables for people, in the units of the mechanism file
    Text,
    /// One JSON object, in metres and radians
    Json,
}

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum Command {
    Decompose(DecomposeArgs),
    Check(CheckArgs),
    Ik(IkArgs),
    Velocity(VelocityArgs),
    Analyze(AnalyzeArgs),
    Calibrate(CalibrateArgs),
    Accuracy(AccuracyArgs),
    Design(DesignArgs),
    Fk(FkArgs),
    Linkage(LinkageArgs),
    Trajectory(TrajectoryArgs),
    Path(PathArgs),
    Workspace(WorkspaceArgs),
    Measure(MeasureArgs),
    Merge(MergeArgs),
    Plot(PlotArgs),
    Inspect(InspectArgs),
    Recover(RecoverArgs),
    Layout(LayoutArgs),
    Explore(ExploreArgs),
    Convert(ConvertArgs),
    Export(ExportArgs),
    Generate(GenerateArgs),
    New(NewArgs),
    Examples(ExamplesArgs),
    Schema(SchemaArgs),
    Format(FormatArgs),
    Licenses(LicensesArgs),
    Completions(CompletionsArgs),
}

/// The mechanism of a command.
#[derive(Debug, clap::Args)]
pub struct MechanismArgs {
    /// Mechanism file, - for standard input, or the name of a shipped example
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub file: PathBuf,
    /// Accept joints that miss their subspaces by at most this length, for example 0.5mm, and move them
    /// exactly into these; angles count as lengths at the mechanism's size
    #[arg(help_heading = heading::MECHANISM, long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub tolerance: Option<Number>,
    /// What is changed of the file.
    #[command(flatten)]
    pub change: ChangeArgs,
}

/// What is changed of a mechanism file.
#[derive(Clone, Debug, Default, PartialEq, clap::Args)]
pub struct ChangeArgs {
    /// Change numbers of the file: a parameter that it names (rb=120mm,rod=350mm), one of a family's leg (leg1.h=140mm) or
    /// of all its legs (h=140mm), or limits (limits.S=-0.2:0.2, or none); in a list of joints S1.limits=...,
    /// S1.max_rate=..., S1.gear=... and S1.home=...; masses (masses.platform=2, payload.mass=0.5)
    #[arg(help_heading = heading::MECHANISM, long, value_name = "NAME=VALUE", allow_hyphen_values = true, value_delimiter = ',')]
    pub set: Vec<Change>,
    /// Angles of orientations: `euler-angles` (zeta xi psi), `tilt-torsion` (azimuth tilt torsion) or `roll-pitch-yaw` (roll
    /// pitch yaw)
    #[arg(help_heading = heading::MECHANISM, long, value_name = "ANGLES", value_parser = coordinates())]
    pub coordinates: Option<OrientationCoordinates>,
}

/// Parses which angles an orientation is written with.
fn coordinates() -> impl TypedValueParser<Value = OrientationCoordinates> {
    let names = PossibleValuesParser::new(OrientationCoordinates::NAMED.map(|(name, _)| name));
    names.try_map(|name| OrientationCoordinates::from_name(&name).ok_or("no such angles"))
}

/// Find the partial subspaces and the imaginary joints of a mechanism
///
/// Splits every leg into a lower part, which moves in one subspace, and an upper part, which moves in
/// another; the two subspaces share one motion. A leg whose upper part cannot make that motion gets
/// an imaginary joint. Of several decompositions the preferred one comes first. The task coordinates are
/// measured in the frames that are printed; [task] in the file can set them.
///
/// A mechanism that does not decompose gets an answer too (exit status 0): the subspace of each leg, what
/// the platform can do at home, and why it is outside the class. If it nearly decomposes, the answer names
/// the joints that are off, and by how much. Missing or redundant actuators are a warning.
///
/// JSON also has the mechanism as data: the platform's `reference_point` at home, and `joints` with the keys of a list of
/// joints in a mechanism file, in metres and radians, whatever the form of the file. `imaginary_joints` there, and in the
/// table of --vary, is J: the number of motions of the upper section with its imaginary joints, not of these joints, whose
/// names are in `legs`.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm decompose plano-spherical-5dof
  opm decompose my-mechanism.toml --format json
  opm decompose my-mechanism.toml --tolerance 0.5mm
  opm decompose plano-spherical-5dof --coordinates tilt-torsion
  opm decompose plano-spherical-5dof --vary h=100mm:160mm:7")]
pub struct DecomposeArgs {
    /// The mechanism.
    #[command(flatten)]
    pub mechanism: MechanismArgs,
    /// Decompose for each of these values of a number that --set takes, and print a table
    #[arg(long, value_name = "NAME=MIN:MAX:COUNT", allow_hyphen_values = true)]
    pub vary: Option<GridAxis>,
}

/// List the mechanisms and motions that come with opm, or print one
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm examples
  opm examples plano-spherical-5dof > my-mechanism.toml")]
pub struct ExamplesArgs {
    /// The example to print
    #[arg(value_name = "NAME")]
    pub name: Option<String>,
}

/// Print a JSON schema of mechanism or motion files, for editors
///
/// Editors that know the schema complete keys, explain them, and mark what opm would refuse. It is draft 7,
/// which Taplo and the extension Even Better TOML of VS Code understand. With `#:schema ./opm.schema.json` as
/// the first line of a file they use it; `opm help format` has more. The output is the schema itself;
/// --format has no effect.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm schema > opm.schema.json
  opm schema motion > opm-motion.schema.json")]
pub struct SchemaArgs {
    /// The kind of file
    #[arg(value_name = "KIND", value_enum, default_value_t = FileKind::Mechanism)]
    pub kind: FileKind,
}

/// A kind of file that opm reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FileKind {
    /// Mechanism files
    Mechanism,
    /// Motion files
    Motion,
}

/// Explain the format of mechanism and motion files
#[derive(Debug, clap::Args)]
#[command(override_help = crate::format::TEXT)]
pub struct FormatArgs {}

/// Print the licences of opm and of everything that is part of the program
#[derive(Debug, clap::Args)]
pub struct LicensesArgs {}

/// Print a completion script for a shell, or the manual page
///
/// The output is the script or the page itself; --format has no effect.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm completions bash > ~/.local/share/bash-completion/completions/opm
  opm completions fish > ~/.config/fish/completions/opm.fish
  opm completions man --directory ~/.local/share/man/man1")]
pub struct CompletionsArgs {
    /// The shell, or man
    #[arg(value_name = "SHELL", value_enum)]
    pub shell: Completion,
    /// Write one manual page for opm and one for each command to this folder, which is created
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub directory: Option<PathBuf>,
}

/// What `opm completions` prints.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Completion {
    /// For Bash
    Bash,
    /// For Elvish
    Elvish,
    /// For Fish
    Fish,
    /// For PowerShell
    #[value(name = "powershell")]
    PowerShell,
    /// For Zsh
    Zsh,
    /// The manual page
    Man,
}

#[cfg(test)]
mod tests {
    use super::{Args, WIDEST};
    use clap::CommandFactory;

    #[test]
    fn arguments_do_not_contradict_each_other() {
        Args::command().debug_assert();
    }

    /// A command with many options has them under headings, and few that matter first.
    #[test]
    fn no_list_of_options_is_long() {
        const MOST: usize = 9;
        fn look(command: &clap::Command, lists: &mut usize) {
            let mut counts = std::collections::BTreeMap::new();
            for option in command.get_opts() {
                *counts.entry(option.get_help_heading()).or_insert(0) += 1;
            }
            for (heading, count) in counts {
                assert!(count <= MOST, "{} {heading:?}: {count} options", command.get_name());
                *lists += 1;
            }
            command.get_subcommands().for_each(|command| look(command, lists));
        }
        let mut lists = 0;
        look(&Args::command(), &mut lists);
        assert!(lists > 40, "{lists}");
    }

    /// Examples are copied line by line, so no line may be wider than the help on a terminal.
    #[test]
    fn examples_in_the_help_are_not_wrapped() {
        let program = Args::command();
        let of = |command: &clap::Command| command.get_after_long_help().map(ToString::to_string);
        let examples: Vec<String> =
            program.get_subcommands().chain([&program]).filter_map(of).collect();
        assert!(examples.len() > 10);
        for line in examples.iter().flat_map(|text| text.lines()) {
            assert!(line.chars().count() <= WIDEST, "{line:?}");
        }
    }
}
