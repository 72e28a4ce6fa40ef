//! Generated structured text, executed by an interpreter of these tests and compared with `opm-core`.
//!
//! No package registry has a compiler of structured text. The interpreter reads and executes the part of the language that
//! is written, from the standard alone (IEC 61131-3): strictly in types and names, and it stops where a controller may stop,
//! at a division by zero for example. The grammar is also tested with a parser of others, from Python.

mod code;
mod machine;
mod parser;
mod words;

use crate::comparison::{compare_all, forward_leads_from_home, reach_ends_where_it_does_for_opm};
use crate::drawn::{content, covering, shipped};
use crate::program::{Answer, Forward, Program, Question, Shape};
use machine::{Instance, Machine};
use opm_core::Manipulator;
use std::cell::RefCell;

/// Several mechanisms, each with its text.
struct Texts {
    machines: Vec<(RefCell<Machine>, String)>,
    shapes: Vec<Shape>,
}

impl Texts {
    fn new(manipulators: &[Manipulator]) -> Self {
        let machines = manipulators
            .iter()
            .map(|m| {
                let package = opm_generate::st(m, content(m)).expect("few choices");
                (RefCell::new(Machine::new(&[&package.files[0].1])), package.name)
            })
            .collect();
        Self { machines, shapes: manipulators.iter().map(Shape::of).collect() }
    }
}

/// What is given to the inputs of a function block.
type Inputs<'a> = [(&'static str, &'a [f64])];

/// A machine while it answers a question.
struct Asked<'a> {
    machine: &'a mut Machine,
    name: &'a str,
    geometry: Instance,
}

impl Asked<'_> {
    /// Runs a new function block: its status, and what it gives, or as many times -77 where it gives nothing.
    fn run(&mut self, block: &str, inputs: &Inputs<'_>, outputs: &[&str]) -> (f64, Vec<Vec<f64>>) {
        let instance = self.machine.instance(&format!("{}_{block}", self.name));
        let instance = instance.unwrap_or_else(|| panic!("there is no {block}"));
        self.machine.refer(instance, "geometry", self.geometry);
        for (name, values) in inputs {
            self.machine.set(instance, name, values);
        }
        self.machine.run(instance);
        let status = self.machine.get(instance, "status")[0];
        let hidden = status != 0.0 && block != "deficits";
        let found = outputs.iter().map(|name| {
            let values = self.machine.get(instance, name);
            if hidden { vec![-77.0; values.len()] } else { values }
        });
        (status, found.collect())
    }

    /// Forward kinematics, from a pose.
    fn forward(&mut self, actuated: &[f64], mode: f64, from: &[f64]) -> (f64, f64, Vec<f64>) {
        let instance =
            self.machine.instance(&format!("{}_forward", self.name)).expect("it is there");
        self.machine.refer(instance, "geometry", self.geometry);
        self.machine.refer_to_array(instance, "pose", from);
        self.machine.set(instance, "actuated", actuated);
        self.machine.set(instance, "mode", &[mode]);
        self.machine.run(instance);
        let one = |name| self.machine.get(instance, name)[0];
        (one("status"), one("residual"), self.machine.get(instance, "pose"))
    }

    fn answer(&mut self, question: &Question, shape: Shape) -> Answer {
        let mode = question.mode.bits() as f64;
        let at: &Inputs<'_> = &[("pose", &question.pose), ("mode", &[mode])];
        let imaginary: &[&str] = if shape.imaginary > 0 { &["imaginary"] } else { &[] };
        let last = |mut found: Vec<Vec<f64>>| found.pop().unwrap_or_default();
        let solved = |found: Vec<Vec<f64>>| {
            let mut found = found.into_iter();
            (found.next().unwrap_or_default(), found.next().unwrap_or_default())
        };
        let (status, found) = self.run("inverse", at, &[&["joints"], imaginary].concat());
        let (joints, of_imaginary) = solved(found);
        let (actuated_status, actuated) = match shape.actuated {
            0 => (status, Vec::new()),
            _ => {
                let (status, found) = self.run("actuated", at, &["actuated"]);
                (status, last(found))
            }
        };
        let (deficits_status, deficits) = self.run("deficits", at, &["deficits"]);
        let (limits, _) = self.run("limits", &[("joints", &joints)], &[]);
        let (transform_status, place) = self.run("transform", at, &["position", "rotation"]);
        let next: &Inputs<'_> = &[("pose", &question.next), ("previous", &joints)];
        let outputs = [&["mode", "joints"], imaginary].concat();
        let (nearest_status, nearest) = self.run("nearest", next, &outputs);
        let mut nearest = nearest.into_iter();
        let nearest_mode = nearest.next().map_or(0.0, |mode| mode[0]);
        let (nearest_joints, nearest_imaginary) = solved(nearest.collect());
        let (jacobian_status, jacobian) = self.run("jacobian", at, &["jacobian"]);
        let (twist_status, twist) = self.run("twist", at, &["twist"]);
        let moving = [at, &[("rates", &question.next)]].concat();
        let (rates_status, rates) = self.run("rates", &moving, &["joint_rates"]);
        let named = format!("{}_inverse_dynamics", self.name);
        let dynamics = self.machine.instance(&named).map(|_| {
            let accelerations = [("accelerations", &*question.pose)];
            let moving = [&*moving, &accelerations].concat();
            let (status, efforts) = self.run("inverse_dynamics", &moving, &["efforts"]);
            (status, last(efforts))
        });
        let has_forward = self.machine.instance(&format!("{}_forward", self.name)).is_some();
        let forward = has_forward.then(|| {
            let (forward_status, residual, pose) = self.forward(&actuated, mode, &question.next);
            let mut wrong = actuated.clone();
            *wrong.last_mut().expect("an actuated joint") = f64::NAN;
            let (refused, ..) = self.forward(&wrong, mode, &question.pose);
            Forward { status: forward_status, residual, pose, refused }
        });
        let mut place = place.into_iter();
        Answer {
            status,
            joints,
            imaginary: of_imaginary,
            actuated_status,
            actuated,
            deficits_status,
            deficits: last(deficits).into_iter().map(infinite).collect(),
            limits,
            transform_status,
            position: place.next().unwrap_or_default(),
            rotation: place.next().unwrap_or_default(),
            nearest_status,
            nearest_mode,
            nearest_joints,
            nearest_imaginary,
            jacobian_status,
            jacobian: last(jacobian),
            twist_status,
            twist: last(twist),
            rates_status,
            rates: last(rates),
            dynamics,
            forward,
        }
    }
}

/// The largest number stands for an infinite one.
fn infinite(value: f64) -> f64 {
    if value == f64::MAX { f64::INFINITY } else { value }
}

impl Program for Texts {
    fn ask(&self, number: usize, questions: &[Question]) -> Vec<Answer> {
        let (machine, name) = &self.machines[number];
        let mut machine = machine.borrow_mut();
        let mut all = Vec::new();
        for question in questions {
            let mark = machine.mark();
            let geometry = machine.instance(&format!("{name}_geometry")).expect("it is there");
            let mut asked = Asked { machine: &mut machine, name, geometry };
            all.push(asked.answer(question, self.shapes[number]));
            machine.release(mark);
        }
        all
    }
}

#[test]
fn st_solves_shipped_mechanisms_as_opm() {
    let all = shipped();
    let program = Texts::new(&all);
    compare_all(&program, &all, 400, 51);
    forward_leads_from_home(&program, &all, 200, 52);
    reach_ends_where_it_does_for_opm(&program, &all, 30);
}

#[test]
fn st_solves_random_mechanisms_as_opm() {
    let all = covering(2, 500);
    let program = Texts::new(&all);
    compare_all(&program, &all, 200, 53);
    forward_leads_from_home(&program, &all, 60, 54);
}

/// The test beside the code accepts it, one pose in each cycle, and finds a changed joint.
#[test]
fn the_test_beside_st_finds_errors() {
    for m in shipped() {
        let package = opm_generate::st(&m, content(&m)).expect("few choices");
        let [(_, code), (_, test)] = &package.files[..] else { panic!("two files") };
        let run = |code: &str| {
            let mut machine = Machine::new(&[code, test]);
            let block = machine.instance(&format!("{}_test", package.name)).expect("the test");
            let mut cycles = 0;
            while machine.get(block, "done") == [0.0] {
                machine.run(block);
                cycles += 1;
                assert!(cycles < 1_000, "{}: it does not end", package.name);
            }
            (cycles, machine.get(block, "wrong")[0], machine.get(block, "worst")[0])
        };
        let (cycles, wrong, worst) = run(code);
        assert!(cycles > 0 && wrong == 0.0 && worst < 1e-10, "{}: {wrong} {worst}", package.name);
        if code.contains(".home + here.q_") {
            let changed = code.replacen(".home + here.q_", ".home + 0.01 + here.q_", 1);
            assert!(run(&changed).1 > 0.0, "{}", package.name);
        }
    }
}

/// Numbers that are none, and far too large ones, are told before anything is computed with them.
#[test]
fn st_refuses_what_is_no_number() {
    let m = Manipulator::example("plano-spherical-5dof").unwrap();
    let program = Texts::new(std::slice::from_ref(&m));
    for (i, wrong) in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e80].into_iter().enumerate() {
        let mut pose = m.home_pose();
        pose[i] = wrong;
        let next = pose.clone();
        let answer = &program.ask(0, &[Question { mode: m.home_mode(), pose, next }])[0];
        let refused = -(i as f64 + 1.0);
        assert_eq!([answer.status, answer.nearest_status, answer.rates_status], [refused; 3]);
    }
}

/// The interpreter refuses what the standard refuses.
#[test]
fn the_interpreter_is_strict() {
    let function = |variables: &str, body: &str| {
        format!("FUNCTION f : LREAL VAR_INPUT x : LREAL; END_VAR {variables} {body} END_FUNCTION")
    };
    let right = function("VAR i : DINT; END_VAR", "i := 2; f := x * DINT_TO_LREAL(i);");
    Machine::new(&[&right]);
    let wrong = [
        ("", "f := y;"),
        ("", "f := 1;"),
        ("", "x := 1.0;"),
        ("", "f := 1e-3;"),
        ("", "f := 1.0"),
        ("", "IF x THEN f := 1.0; END_IF;"),
        ("VAR X : LREAL; END_VAR", "f := x;"),
        ("VAR at : LREAL; END_VAR", "f := x;"),
        ("VAR a__b : LREAL; END_VAR", "f := x;"),
        ("VAR CONSTANT c : LREAL := 1.0; END_VAR", "c := x;"),
        ("VAR i : DINT; END_VAR", "FOR i := 0 TO 3 DO i := 2; END_FOR;"),
        ("VAR i : DINT; END_VAR", "i := DINT_TO_LREAL(i);"),
        ("VAR a : ARRAY[0..1] OF LREAL; END_VAR", "f := a[x];"),
        ("", "f := SQRT(x, x);"),
        ("", "EXIT;"),
    ];
    for (variables, body) in wrong {
        let text = function(variables, body);
        let found = std::panic::catch_unwind(|| Machine::new(&[&text]));
        assert!(found.is_err(), "{text}");
    }
}
