//! The closed forms of one mechanism, as a tree.
//!
//! What a kind of section needs is in the [`library`]: one function for each closed form. What one mechanism needs is written
//! here: its geometry as one struct, and for each leg two functions that call those of the library, in the order in which the leg
//! is solved.

mod assembly;
mod complete;
mod constrained;
mod counts;
mod displacement;
mod dynamics;
mod forward;
mod geometry;
mod interface;
mod leg;
mod nearest;
mod rates;
mod twist;
mod whole;

use crate::names::identifiers;
use crate::trace::{Any, Array, Bits, In, Parameters, Real, Truth, call_known, give, when};
use crate::trace::{Int, Number};
use crate::tree::{Code, Function, Member, Parameter, Pass, Struct, Type};
use crate::{Content, GenerateError, library};
use leg::Given;
use opm_core::Manipulator;
use opm_core::chain::Chain;
use opm_core::manipulator::Section;
use opm_core::manipulator::form::{ClosedForms, WholeStep};
use opm_core::nalgebra::Vector3;
use opm_core::task::Task;
use std::cell::RefCell;

/// The most choices: a working mode has 32 bits.
const MOST_CHOICES: u32 = 32;

/// How many there are of each.
pub const JOINTS: Int = Int::constant("JOINTS");
pub const ACTUATED: Int = Int::constant("ACTUATED");
pub const LEGS: Int = Int::constant("LEGS");
pub use library::COORDINATES;

/// The type of the struct of the geometry, and of that of the displacements.
const GEOMETRY: &str = "geometry";
const DISPLACEMENTS: &str = "displacements";

/// Values for the parameters of a function.
macro_rules! given {
    ($($value:expr),* $(,)?) => { [$(crate::trace::Any::from($value)),*] };
}
pub(crate) use given;

/// What is known of a mechanism while its code is traced.
pub struct Writer<'a> {
    pub manipulator: &'a Manipulator,
    pub task: &'a Task,
    pub forms: ClosedForms,
    content: Content,
    /// The names of the joints' displacements, as members of a struct.
    fields: Vec<String>,
    /// The functions that are traced already.
    functions: RefCell<Vec<Function>>,
}

impl<'a> Writer<'a> {
    pub fn new(manipulator: &'a Manipulator, content: Content) -> Result<Self, GenerateError> {
        let choices = manipulator.choices();
        if choices > MOST_CHOICES {
            return Err(GenerateError::Choices { choices, most: MOST_CHOICES });
        }
        let names = manipulator.coordinates().iter().map(|c| &*c.name);
        let fields = identifiers(names).into_iter().map(|name| format!("q_{name}")).collect();
        let (task, forms) = (manipulator.task(), manipulator.closed_forms());
        if matches!(&forms.whole, Some(WholeStep::Rows(rows)) if rows.by_place) {
            return Err(GenerateError::Place);
        }
        if matches!(&forms.whole, Some(WholeStep::Rows(rows)) if rows.slides) {
            return Err(GenerateError::Rail);
        }
        let functions = RefCell::default();
        let writer = Self { manipulator, task, forms, content, fields, functions };
        match content {
            Content::Kinematics => {}
            Content::Dynamics => dynamics::refused(&writer)?,
        }
        Ok(writer)
    }

    /// The code of the mechanism.
    pub fn code(&self) -> Code {
        for section in [Section::Lower, Section::Upper] {
            self.displacement(section);
        }
        for leg in 0..self.forms.legs.len() {
            self.leg(leg);
        }
        self.complete();
        self.interface();
        if self.content == Content::Dynamics {
            self.dynamics();
        }
        let (geometry, default) = self.geometry();
        let own = self.functions.borrow().clone();
        let functions = [library::functions_for(&own), own].concat();
        let displacements = self.displacements();
        let members = geometry.members.iter().chain(&displacements.members);
        let used =
            members.map(|m| m.kind.clone()).chain(functions.iter().flat_map(Function::types));
        let [of_geometry, others] = library::structs_for(used);
        let structs = [of_geometry, vec![geometry], others, vec![displacements]].concat();
        let constants = library::constants_for(&functions);
        Code { enums: self.counts(), constants, structs, functions, default }
    }

    /// The functions that were traced after the code, with those of the library that they need besides.
    pub fn functions_after(&self, code: &Code) -> Vec<Function> {
        let all = self.functions.borrow();
        let is_new = |one: &&Function| code.functions.iter().all(|known| known.name != one.name);
        let own: Vec<Function> = all.iter().filter(is_new).cloned().collect();
        let library = library::functions_for(&own).into_iter().filter(|one| is_new(&one));
        library.chain(own.iter().cloned()).collect()
    }

    /// Adds a function to the code.
    fn add(&self, function: Function) {
        self.functions.borrow_mut().push(function);
    }

    /// A function of this mechanism, or of the library.
    fn find<R>(&self, name: &str, of: impl FnOnce(&Function) -> R) -> Option<R> {
        let own = self.functions.borrow();
        let found = own.iter().chain(library::functions()).find(|known| known.name == name);
        found.map(of)
    }

    /// A call of a function with a value for each parameter.
    fn call(&self, name: &str, given: &[Any]) -> Any {
        let called = self.find(name, |function| call_known(function, given));
        called.expect("functions are traced before their calls")
    }

    /// A call of a function with those of the values that it has parameters for.
    fn call_with(&self, name: &str, known: &[(&str, Any)]) -> Any {
        let value = |p: &Parameter| {
            let found = known.iter().find(|(name, _)| *name == p.name);
            found.expect("every parameter has a value").1
        };
        let given: Option<Vec<Any>> =
            self.find(name, |function| function.parameters.iter().map(value).collect());
        self.call(name, &given.unwrap_or_default())
    }

    /// The struct of the displacements that the legs' functions write.
    fn displacements(&self) -> Struct {
        let mut members = Vec::new();
        let mut add = |name: String, kind: Type| {
            members.push(Member { name, kind, comment: String::new() });
        };
        for (number, field) in self.fields.iter().enumerate() {
            add(field.clone(), self.given(number).of_type());
        }
        for (number, leg) in self.forms.legs.iter().enumerate() {
            if let Some(tau) = self.tau(leg) {
                add(format!("tau_{}", number + 1), tau.of_type());
            }
            for section in [Section::Lower, Section::Upper] {
                if leg.section(section).chain.is_ball() {
                    add(leg::ball(number, section), Given::Direction.of_type());
                }
            }
        }
        Struct {
            name: DISPLACEMENTS.to_owned(),
            comment: "Displacements of the joints and along the intersection motion (tau) from home: lengths, angles as \
                      directions, and of spherical joints the axis, and half the angle."
                .to_owned(),
            members,
        }
    }

    /// The member that has half the angle of the spherical joint that a coordinate belongs to.
    fn ball_of(&self, coordinate: usize) -> Option<String> {
        let legs = self.forms.legs.iter().enumerate();
        let sections =
            legs.flat_map(|(leg, form)| [Section::Lower, Section::Upper].map(|of| (leg, of, form)));
        let mut balls = sections.filter(|(_, of, form)| form.section(*of).chain.is_ball());
        let found =
            balls.find(|(_, of, form)| form.section(*of).coordinates.contains(&Some(coordinate)));
        found.map(|(leg, of, _)| leg::ball(leg, of))
    }

    /// The form in which the displacement of a joint coordinate is given.
    fn given(&self, coordinate: usize) -> Given {
        if let Some(given) = self.given_of_whole(coordinate) {
            return given;
        }
        for leg in &self.forms.legs {
            for section in [&leg.lower, &leg.upper] {
                if let Some(joint) = section.coordinates.iter().position(|c| *c == Some(coordinate))
                {
                    return match section.chain {
                        Chain::Ball(_) => Given::Value,
                        _ => leg::given(section, joint),
                    };
                }
            }
        }
        // One that carries a height.
        Given::Value
    }

    /// The value of a coordinate at home.
    fn home(&self, g: Any, coordinate: usize) -> Real {
        g.list("home", self.task.coordinates.len()).at(number(coordinate))
    }

    /// What is known of a joint coordinate.
    fn joint(&self, g: Any, coordinate: usize) -> library::Joint {
        g.list("joint", self.fields.len()).at(number(coordinate))
    }
}

/// A vector of the mechanism.
fn constant(v: &Vector3<f64>) -> library::Vector {
    library::vector_of(v.x, v.y, v.z)
}

/// A whole number of code.
fn number(value: usize) -> Int {
    Int::from(i32::try_from(value).unwrap_or(i32::MAX))
}

/// The parameter that is the geometry.
fn geometry(p: &mut Parameters) -> Any {
    p.of_kind("g", Type::Struct(GEOMETRY.to_owned()), Pass::Read)
}

/// The parameters of a function of a pose.
fn of_pose(p: &mut Parameters) -> (Any, Array<Real>, Bits) {
    (geometry(p), p.add::<In<[Real]>>("pose"), p.add::<Bits>("mode"))
}

/// A list of real numbers that a function writes.
fn written(p: &mut Parameters, name: &str, length: usize) -> Array<Real> {
    let kind = Type::Array(Box::new(Type::Real), length);
    p.of_kind(name, kind, Pass::Write).array()
}

/// Declares displacements.
fn displacements(name: &str) -> Any {
    Any::variable(name, &Type::Struct(DISPLACEMENTS.to_owned()), None)
}

/// Returns a status that is not zero.
fn return_status(status: Int) {
    when(status.is_not(0), || give(status));
}

/// Whether one of several functions fails.
fn any_fails(calls: &[Any]) -> Option<Truth> {
    calls.iter().map(|call| call.is::<Int>().is_set()).reduce(|a, b| a | b)
}

/// What a function returns that succeeds.
fn done() -> Int {
    Int::from(0)
}

/// The name of a section as in names of the code.
fn word(section: Section) -> &'static str {
    match section {
        Section::Lower => "lower",
        Section::Upper => "upper",
    }
}

/// The symbol of a section's displacement.
fn symbol(section: Section) -> &'static str {
    match section {
        Section::Lower => "v",
        Section::Upper => "b",
    }
}
