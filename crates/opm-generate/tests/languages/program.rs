//! Programs of generated code: what they are asked, and what they answer.

use opm_core::{Manipulator, Mode};
use std::io::Write as _;
use std::process::{Command, Stdio};

/// A program of the code of several mechanisms.
pub trait Program {
    /// The answers of one mechanism.
    fn ask(&self, number: usize, questions: &[Question]) -> Vec<Answer>;
}

/// How many numbers there are of each kind.
#[derive(Clone, Copy)]
pub struct Shape {
    pub coordinates: usize,
    pub joints: usize,
    pub imaginary: usize,
    pub actuated: usize,
    pub legs: usize,
}

/// A question: a mode and a pose, and a pose that is reached from there.
#[derive(Clone, Debug)]
pub struct Question {
    pub mode: Mode,
    pub pose: Vec<f64>,
    pub next: Vec<f64>,
}

/// What the functions return and write for a question.
#[derive(Debug)]
pub struct Answer {
    /// Of `NAME_inverse`.
    pub status: f64,
    pub joints: Vec<f64>,
    pub imaginary: Vec<f64>,
    /// Of `NAME_actuated`.
    pub actuated_status: f64,
    pub actuated: Vec<f64>,
    /// Of `NAME_deficits`: that of the lower and that of the upper section of each leg.
    pub deficits_status: f64,
    pub deficits: Vec<f64>,
    /// Of `NAME_limits`, for the joints.
    pub limits: f64,
    /// Of `NAME_transform`.
    pub transform_status: f64,
    pub position: Vec<f64>,
    pub rotation: Vec<f64>,
    /// Of `NAME_nearest`, for the next pose and the joints.
    pub nearest_status: f64,
    pub nearest_mode: f64,
    pub nearest_joints: Vec<f64>,
    pub nearest_imaginary: Vec<f64>,
    /// Of `NAME_jacobian`.
    pub jacobian_status: f64,
    pub jacobian: Vec<f64>,
    /// Of `NAME_twist`.
    pub twist_status: f64,
    pub twist: Vec<f64>,
    /// Of `NAME_rates`, for the coordinates of the next pose as rates.
    pub rates_status: f64,
    pub rates: Vec<f64>,
    /// Of `NAME_inverse_dynamics`, for the next pose as rates and the pose as accelerations: the status and the efforts; nothing
    /// where there is no such function.
    pub dynamics: Option<(f64, Vec<f64>)>,
    /// Of `NAME_forward`, from the next pose to the actuated joints; nothing where there is no such function.
    pub forward: Option<Forward>,
}

/// What `NAME_forward` returns and writes.
#[derive(Debug)]
pub struct Forward {
    pub status: f64,
    pub residual: f64,
    pub pose: Vec<f64>,
    /// The status where the last actuated joint is no number.
    pub refused: f64,
}

impl Shape {
    pub fn of(m: &Manipulator) -> Self {
        Self {
            coordinates: m.task_coordinates().len(),
            joints: m.coordinates().len(),
            imaginary: m.imaginary().len(),
            actuated: m.actuated().len(),
            legs: m.mechanism().legs.len(),
        }
    }
}

/// Asks a program: its input is a record for each question, of a mode in four bytes and the numbers of two poses in eight
/// each; its output is the numbers of the answers.
pub fn ask(command: &mut Command, shape: Shape, questions: &[Question]) -> Vec<Answer> {
    let mut input = Vec::new();
    for Question { mode, pose, next } in questions {
        assert_eq!((pose.len(), next.len()), (shape.coordinates, shape.coordinates));
        input.extend(u32::try_from(mode.bits()).expect("few choices").to_ne_bytes());
        input.extend(pose.iter().chain(next).flat_map(|value| value.to_ne_bytes()));
    }
    let mut child = command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program that was compiled");
    let mut stdin = child.stdin.take().expect("a pipe");
    let writer = std::thread::spawn(move || stdin.write_all(&input));
    let output = child.wait_with_output().expect("it ends");
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success() && told.is_empty(), "{}: {told}", output.status);
    writer.join().expect("it writes").expect("all is read");
    let numbers: Vec<f64> = output
        .stdout
        .chunks_exact(8)
        .map(|bytes| f64::from_ne_bytes(bytes.try_into().expect("eight bytes")))
        .collect();
    let mut numbers = numbers.into_iter();
    let answers = questions.iter().map(|_| Answer::read(&mut numbers, shape)).collect();
    assert_eq!(numbers.next(), None);
    answers
}

impl Answer {
    fn read(numbers: &mut impl Iterator<Item = f64>, shape: Shape) -> Self {
        let mut take = |count: usize| -> Vec<f64> { numbers.by_ref().take(count).collect() };
        let one = |values: Vec<f64>| values[0];
        Self {
            status: one(take(1)),
            joints: take(shape.joints),
            imaginary: take(shape.imaginary),
            actuated_status: one(take(1)),
            actuated: take(shape.actuated),
            deficits_status: one(take(1)),
            deficits: take(2 * shape.legs),
            limits: one(take(1)),
            transform_status: one(take(1)),
            position: take(3),
            rotation: take(9),
            nearest_status: one(take(1)),
            nearest_mode: one(take(1)),
            nearest_joints: take(shape.joints),
            nearest_imaginary: take(shape.imaginary),
            jacobian_status: one(take(1)),
            jacobian: take(shape.joints * shape.coordinates),
            twist_status: one(take(1)),
            twist: take(6 * shape.coordinates),
            rates_status: one(take(1)),
            rates: take(shape.joints),
            dynamics: (one(take(1)) == 1.0).then(|| (one(take(1)), take(shape.actuated))),
            forward: (one(take(1)) == 1.0).then(|| Forward {
                status: one(take(1)),
                residual: one(take(1)),
                pose: take(shape.coordinates),
                refused: one(take(1)),
            }),
        }
    }
}
