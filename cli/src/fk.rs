//! `opm fk`: forward kinematics.

mod aspects;
mod families;
mod least;
mod not_found;
mod poses;
mod proofs;
mod table;

use crate::args::{FkArgs, Output};
use crate::failure::Failure;
use crate::load::{self, Loaded};
use crate::output::named;
use crate::pose::Pose;
use crate::text::{self, Table, reason};
use crate::unitless;
use opm_core::forward::{
    Assemblies, Assembly, Certificate, Completeness, Family, ForwardMethod, LeastChange, NearError,
    Unmet,
};
use opm_core::group::JointDisplacement;
use opm_core::manipulator::{Manipulator, Mode, Section};
use opm_core::mechanism::file::FileUnits;
use opm_core::mechanism::joint::JointCoordinate;
use opm_workspace::{HomeAspect, home_aspects};
use serde::Serialize;
use serde_json::{Map, Value};
use std::fmt::Write;
use std::path::Path;

pub fn run(args: &FkArgs, output: &Output) -> Result<(), Failure> {
    let loaded = load::open(&args.mechanism, output)?;
    if let (Some(vary), Some(joints)) = (&args.vary, &args.joints) {
        return table::run((args, joints), &loaded, vary, output);
    }
    let manipulator = loaded.compile()?;
    let given = match (&args.joints, &args.poses) {
        (Some(joints), _) => joints,
        (None, input) => {
            let input = input.as_deref().unwrap_or(Path::new("-"));
            return poses::run(args, input, output, (&loaded, &manipulator));
        }
    };
    let FoundAssemblies { actuated, mut found, only, method } =
        solve(args, given, output, (&loaded, &manipulator))?;
    for (&coordinate, &value) in manipulator.actuated().iter().zip(&actuated) {
        let (c, limits) =
            (&manipulator.coordinates()[coordinate], &manipulator.limits()[coordinate]);
        if let Some(range) =
            c.limits.filter(|_| !limits.admits(JointDisplacement::Value(value - c.home)))
        {
            let units = loaded.file.units;
            output.note(text::beyond_limits(&c.name, value, range, c.quantity, units));
        }
    }
    let least = match found.unmet.is_empty() {
        true => None,
        false => manipulator.least_change(&actuated).ok().flatten(),
    };
    let mut certificates = manipulator.certify(&found.list);
    // Newton's method looks for one assembly.
    let families = match method {
        Method::Newton => vec![],
        _ => manipulator.families(&actuated, &found, &certificates),
    };
    // Members of a family are told with it, unless only a leg moves.
    let moves = |number| {
        families.iter().any(|family| family.platform > 0 && family.members.contains(&number))
    };
    for number in (0..found.list.len()).rev() {
        if moves(number) {
            found.list.remove(number);
            certificates.remove(number);
        }
    }
    let aspects = match args.aspects {
        true => Some(aspects::of(args, &found.list, &loaded, output)?),
        false => None,
    };
    let of_home = home_aspects(&manipulator, &found.list);
    let answer = Answer {
        loaded: &loaded,
        manipulator: &manipulator,
        actuated,
        found,
        certificates,
        families,
        of_home,
        least,
        only,
        method,
        aspects,
    };
    output.print(&answer.json(), answer.text())
}

/// The assemblies for one set of joints.
struct FoundAssemblies {
    actuated: Vec<f64>,
    found: Assemblies,
    only: Option<Mode>,
    method: Method,
}

/// Finds the assemblies, the nearest one to home first.
fn solve(
    args: &FkArgs,
    given: &Pose,
    output: &Output,
    (loaded, manipulator): (&Loaded, &Manipulator),
) -> Result<FoundAssemblies, Failure> {
    unitless::note_joints(output, "--joints", given, loaded, manipulator);
    let actuated = joints(given, manipulator)?;
    let only = args.mode.as_deref().map(|mode| load::mode(manipulator, mode)).transpose()?;
    let wrong = |error: &dyn std::error::Error| Failure::flag("--joints", error);
    // With --near nothing is prepared that is not used.
    let every = args.near.is_none().then(|| manipulator.forward_method());
    let (found, method) = match every {
        Some(Ok(method)) => {
            let mut found = manipulator.forward(&actuated).map_err(|e| wrong(&e))?;
            if let Some(mode) = only {
                manipulator.keep_assemblies_in(&mut found.list, mode);
            }
            let home = manipulator.platform_pose(&manipulator.home_pose());
            let home = home.map_err(|error| Failure::at(&loaded.label, error))?;
            manipulator.sort_assemblies(&mut found.list, &home);
            (found, Method::from(method))
        }
        every => {
            let start = match &args.near {
                Some(pose) => {
                    unitless::note_pose(output, "--near", pose, loaded, manipulator);
                    pose.resolve_for("--near", manipulator)?
                }
                None => manipulator.home_pose(),
            };
            if let Some(Err(why)) = every {
                output.note(format_args!(
                    "no closed form of the forward kinematics: {why}; by Newton's method from home, \
                     which finds one assembly (--near says from where)"
                ));
            }
            let mode = only.unwrap_or_else(|| manipulator.home_mode());
            let assembly =
                manipulator.forward_near(&actuated, &start, mode).map_err(|e| match e {
                    NearError::Joints(error) => wrong(&error),
                    NearError::Start(error) => Failure::flag("--near", error),
                    NearError::NotFound(not_found) => Failure::work(format!(
                        "{}: {}",
                        loaded.label,
                        not_found::explain(
                            manipulator,
                            (&actuated, mode),
                            &not_found,
                            loaded.file.units
                        )
                    )),
                    error => Failure::because(format!("{}: {error}", loaded.label), error),
                })?;
            (Assemblies { list: vec![assembly], ..Default::default() }, Method::Newton)
        }
    };
    Ok(FoundAssemblies { actuated, found, only, method })
}

/// The value of every actuated joint.
fn joints(given: &Pose, manipulator: &Manipulator) -> Result<Vec<f64>, Failure> {
    let actuated: Vec<&JointCoordinate> =
        manipulator.actuated().iter().map(|&i| &manipulator.coordinates()[i]).collect();
    let wrong = |problem: String| Failure::flag("--joints", problem);
    let names = || actuated.iter().map(|c| &*c.name).collect::<Vec<_>>().join(", ");
    let unknown: Vec<String> = (given.assignments())
        .filter(|(name, _)| actuated.iter().all(|c| c.name != *name))
        .map(|(name, _)| {
            let passive = manipulator.coordinates().iter().any(|c| c.name == name);
            if passive { format!("{name} is passive") } else { format!("no joint {name:?}") }
        })
        .collect();
    let missing: Vec<&str> = (actuated.iter())
        .filter(|c| given.assignments().all(|(name, _)| c.name != name))
        .map(|c| &*c.name)
        .collect();
    let mut problems = unknown;
    if !missing.is_empty() {
        problems.push(format!("no value for {}", missing.join(", ")));
    }
    if !problems.is_empty() {
        return Err(wrong(format!("{}; the actuated joints are {}", problems.join(", "), names())));
    }
    actuated
        .iter()
        .filter_map(|c| {
            let (_, number) = given.assignments().find(|(name, _)| c.name == *name)?;
            Some(number.value_of(&c.name, c.quantity).map_err(|e| wrong(e.to_string())))
        })
        .collect()
}

/// The text of a mode; a mode without choices has no signs.
fn shown(manipulator: &Manipulator, mode: Mode) -> String {
    match manipulator.choices() {
        0 => "(no choices)".to_owned(),
        _ => manipulator.format_mode(mode),
    }
}

/// The method that found the assemblies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Method {
    ClosedForm,
    Continuation,
    Newton,
}

impl From<ForwardMethod> for Method {
    fn from(method: ForwardMethod) -> Self {
        match method {
            ForwardMethod::ClosedForm => Self::ClosedForm,
            ForwardMethod::Continuation => Self::Continuation,
        }
    }
}

/// What is known of further assemblies.
fn solutions(found: usize, of: usize) -> String {
    let all = match of {
        1 => "one solution, which was found".to_owned(),
        _ => format!("{of} solutions, complex ones too, and all were found"),
    };
    match of.saturating_sub(found) {
        0 => format!(
            "The equations have {all}: with probability one there is no other assembly of the platform."
        ),
        missing => format!(
            "Of {of} solutions of the equations, complex ones too, {missing} were not found: they are far away, or where assemblies \
             meet, or where the platform can move with these joints held."
        ),
    }
}

struct Answer<'a> {
    loaded: &'a Loaded,
    manipulator: &'a Manipulator,
    actuated: Vec<f64>,
    found: Assemblies,
    /// What is proven of each assembly.
    certificates: Vec<Certificate>,
    families: Vec<Family>,
    /// Whether each assembly shares the aspect of home.
    of_home: Vec<HomeAspect>,
    /// The least change of the joints that closes, where there is no assembly.
    least: Option<LeastChange>,
    only: Option<Mode>,
    method: Method,
    /// The aspect of each assembly, if it was asked for.
    aspects: Option<Vec<Option<u32>>>,
}

#[derive(Serialize)]
struct Json {
    actuated: Map<String, Value>,
    method: Method,
    /// The number of solutions that were found, complex ones too, and how many there are; only of a continuation.
    #[serde(skip_serializing_if = "Option::is_none")]
    solutions: Option<Solutions>,
    assemblies: Vec<JsonAssembly>,
    unmet: Vec<String>,
    /// The least change of the joints that closes, null if there is an assembly or if none was found.
    least_change: Option<least::Json>,
    loose: Vec<String>,
    /// Motions with the joints held; not there if none was met.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    families: Vec<families::Json>,
}

#[derive(Serialize)]
struct Solutions {
    found: usize,
    of: usize,
}

#[derive(Serialize)]
struct JsonAssembly {
    pose: Map<String, Value>,
    mode: String,
    within_limits: bool,
    joints: Map<String, Value>,
    imaginary: Map<String, Value>,
    residual: f64,
    #[serde(flatten)]
    proof: proofs::Json,
    /// "shared" or "apart": whether it is in the aspect of home; null if that is not known.
    home_aspect: Option<&'static str>,
    /// The number of the aspect, null if the grid does not tell; only with --aspects.
    #[serde(skip_serializing_if = "Option::is_none")]
    aspect: Option<Value>,
}

impl Answer<'_> {
    fn json(&self) -> Json {
        let m = self.manipulator;
        let pair = |names: Vec<&str>, values: &[f64]| {
            named(names.into_iter().zip(values.iter().copied()).collect::<Vec<_>>())
        };
        let actuated = m.actuated().iter().map(|&i| &*m.coordinates()[i].name).collect();
        let assembly = |(number, a): (usize, &Assembly)| JsonAssembly {
            pose: named(crate::text::whole_pose(m, &a.pose, &a.dependent)),
            mode: m.format_mode(a.mode),
            within_limits: a.within_limits,
            joints: pair(m.coordinates().iter().map(|c| &*c.name).collect(), &a.joints),
            imaginary: pair(m.imaginary().iter().map(|j| &*j.name).collect(), &a.imaginary),
            residual: a.residual,
            proof: proofs::Json::new(&self.certificates[number]),
            home_aspect: match self.of_home[number] {
                HomeAspect::Shared => Some("shared"),
                HomeAspect::Apart => Some("apart"),
                HomeAspect::Unknown => None,
            },
            aspect: self.aspects.as_ref().map(|aspects| aspects[number].into()),
        };
        Json {
            actuated: pair(actuated, &self.actuated),
            method: self.method,
            solutions: self.solutions(),
            assemblies: self.found.list.iter().enumerate().map(assembly).collect(),
            unmet: self.unmet(FileUnits::SI),
            least_change: self.least.as_ref().map(|least| least::Json::new(m, least)),
            loose: self.found.loose.iter().map(Section::to_string).collect(),
            families: self.families.iter().map(|family| families::Json::new(m, family)).collect(),
        }
    }

    fn text(&self) -> String {
        let (m, units) = (self.manipulator, self.loaded.file.units);
        let joints: Vec<String> = (m.actuated().iter().zip(&self.actuated))
            .map(|(&i, &value)| {
                let c = &m.coordinates()[i];
                format!("{} = {}", c.name, units.show(value, c.quantity))
            })
            .collect();
        let mut text = format!("{} with {}\n\n", m.mechanism().name, joints.join(", "));
        let list = &self.found.list;
        let in_mode =
            self.only.map_or(String::new(), |mode| format!(" in mode {}", shown(m, mode)));
        if list.is_empty() {
            let alone = self.found.loose.is_empty() && self.families.is_empty();
            let single = if alone { "" } else { "single " };
            let _ = writeln!(text, "no {single}assembly{in_mode}");
            for unmet in self.unmet(units) {
                let _ = writeln!(text, "  {unmet}");
            }
            for line in self.least.iter().flat_map(|least| least::lines(m, least, units)) {
                let _ = writeln!(text, "  {line}");
            }
        } else {
            let (count, many) =
                (list.len(), if list.len() == 1 { "assembly" } else { "assemblies" });
            let beyond = list.iter().filter(|a| !a.within_limits).count();
            let limits = match beyond {
                0 => "within limits".to_owned(),
                n if n == count => "beyond limits".to_owned(),
                n => format!("{} within limits (the others are marked *)", count - n),
            };
            let how = match self.method {
                Method::ClosedForm => "",
                Method::Continuation => " by continuation",
                Method::Newton => " by Newton's method",
            };
            let worst = list.iter().map(|a| a.residual).fold(0.0, f64::max);
            let _ = writeln!(
                text,
                "{count} {many}{in_mode}{how}, {limits}; legs close to {worst:.1e} of the size\n"
            );
            let _ = write!(text, "{}", self.table());
            text += &proofs::text(&self.certificates);
            if let Some(aspects) = &self.aspects {
                text += &aspects::text(m, list, aspects);
            }
        }
        if let Some(Solutions { found, of }) = self.solutions() {
            let _ = writeln!(text, "\n{}", solutions(found, of));
        }
        for section in &self.found.loose {
            let _ = writeln!(
                text,
                "\nsingular: with these joints held the {section} section is loose; the poses of that motion \
                 are not listed"
            );
        }
        for family in &self.families {
            let _ = writeln!(text, "\n{}", families::line(m, family, units));
        }
        text
    }

    fn solutions(&self) -> Option<Solutions> {
        match self.found.completeness {
            Completeness::Continuation { found, of } => Some(Solutions { found, of }),
            Completeness::ClosedForm => None,
        }
    }

    /// A table with a row for each assembly.
    fn table(&self) -> Table {
        let (m, units) = (self.manipulator, self.loaded.file.units);
        let mut headers = vec![">".to_owned()];
        if m.choices() > 0 {
            headers.push("mode".to_owned());
        }
        headers
            .extend(m.task_coordinates().iter().map(|c| text::header(c.name, c.quantity, units)));
        let dependent = m.dependent_coordinates();
        headers.extend(dependent.iter().map(|c| text::header(c.name, c.quantity, units)));
        headers.extend(m.imaginary().iter().map(|j| text::header(&j.name, j.quantity, units)));
        headers.push("home's aspect".to_owned());
        if self.aspects.is_some() {
            headers.push(">aspect".to_owned());
        }
        headers.push(String::new());
        let mut table = Table::new(headers);
        for (number, a) in self.found.list.iter().enumerate() {
            let mut row = vec![(number + 1).to_string()];
            if m.choices() > 0 {
                row.push(m.format_mode(a.mode));
            }
            let pose = a.pose.iter().zip(m.task_coordinates());
            let pose = pose.chain(a.dependent.iter().zip(m.dependent_coordinates()));
            row.extend(pose.map(|(&value, c)| text::number(value, c.quantity, units)));
            let imaginary = a.imaginary.iter().zip(m.imaginary());
            row.extend(imaginary.map(|(&value, j)| text::number(value, j.quantity, units)));
            let of_home = match self.of_home[number] {
                HomeAspect::Shared => "shared",
                HomeAspect::Apart => "apart",
                HomeAspect::Unknown => "-",
            };
            row.push(of_home.to_owned());
            if let Some(aspects) = &self.aspects {
                row.push(aspects[number].map_or_else(|| "-".to_owned(), |label| label.to_string()));
            }
            row.push(if a.within_limits { "" } else { "*" }.to_owned());
            table.row(row);
        }
        table
    }

    fn unmet(&self, units: FileUnits) -> Vec<String> {
        let leg = |number: usize| &*self.manipulator.mechanism().legs[number].name;
        let line = |unmet: &Unmet| match unmet {
            Unmet::Leg(unreachable) => {
                format!("{}: {}", leg(unreachable.leg), reason(unreachable, units))
            }
            Unmet::Legs([a, b]) => {
                format!("{} and {} do not meet in the lower section", leg(*a), leg(*b))
            }
            Unmet::Section(section) => {
                format!("{section} section: no pose closes all of its legs at once")
            }
            Unmet::Together => "no pose of the platform closes all legs at once".to_owned(),
            Unmet::Contradiction => format!(
                "the actuated joints contradict each other: {} are given, and the mobility is N = {}",
                self.actuated.len(),
                self.manipulator.task_coordinates().len()
            ),
        };
        self.found.unmet.iter().map(line).collect()
    }
}
