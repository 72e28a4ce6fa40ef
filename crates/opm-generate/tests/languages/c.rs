//! Generated C, compiled and compared with `opm-core`.

use crate::comparison::{
    compare_all, float_closes_every_leg, forward_leads_from_home, reach_ends_where_it_does_for_opm,
};
use crate::compiled::{Compiled, Real, compiled_by, compilers_with, programs_of};
use crate::drawn::{Drawn, content, covering, shipped};
use crate::program::Program;
use fastrand::Rng;
use opm_core::{Manipulator, Mode};

/// Poses of each shipped mechanism, and of each random one: 10⁵ with those of the other languages.
const POSES: [usize; 2] = [3_000, 200];

/// One in so many random mechanisms whose code has nothing new.
const EVERY: usize = 6;

#[test]
fn shipped_mechanisms_are_solved_as_by_opm() {
    let all = shipped();
    let Some(program) = Compiled::new(&all, Real::Double, &["-O2"]) else { return };
    compare_all(&program, &all, POSES[0], 1);
    reach_ends_where_it_does_for_opm(&program, &all, 60);
    forward_leads_from_home(&program, &all, 400, 5);
}

/// Of every pair of subspaces, with limits, spherical and universal joints, leaning lifts, and legs that constrain.
#[test]
fn random_mechanisms_are_solved_as_by_opm() {
    let all = covering(2, EVERY);
    let Some(program) = Compiled::new(&all, Real::Double, &["-O0"]) else { return };
    compare_all(&program, &all, POSES[1], 3);
    forward_leads_from_home(&program, &all, 100, 6);
}

#[test]
fn joints_in_float_close_every_leg() {
    let all: Vec<Manipulator> = shipped().into_iter().step_by(2).collect();
    let Some(program) = Compiled::new(&all, Real::Float, &["-O1"]) else { return };
    float_closes_every_leg(&program, &all, 2_000);
}

/// Numbers that are none are told; nothing is undefined then, or anywhere else.
#[test]
fn nothing_is_undefined() {
    let names = [
        "plano-spherical-5dof",
        "five-bar",
        "translational-helical-3dof",
        "schoenflies-column-4dof",
    ];
    let manipulators = names.map(|name| Manipulator::example(name).unwrap());
    let flags = ["-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"];
    let compilers = compilers_with(&flags);
    let all = compilers.iter().flat_map(|one| [(one, Real::Double), (one, Real::Float)]);
    for (compiler, real) in all {
        let program = Compiled::by(compiler, &manipulators, real, &flags);
        let mut rng = Rng::with_seed(11);
        for (number, m) in manipulators.iter().enumerate() {
            let mut questions = Drawn { rng: &mut rng, manipulator: m }.questions(300);
            let count = m.task_coordinates().len();
            let wrong = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e80, -1e80];
            for (i, question) in questions.iter_mut().enumerate().take(100).skip(50) {
                question.next[i % count] = wrong[i % 3];
            }
            for (i, question) in questions.iter_mut().enumerate().skip(100) {
                if real == Real::Double || !wrong[i % 5].is_finite() || i % 5 < 3 {
                    question.pose[i % count] = wrong[i % 5];
                    question.next[(i + 1) % count] = wrong[(i + 2) % 3];
                }
            }
            for (i, answer) in program.ask(number, &questions).iter().enumerate().skip(50) {
                if i < 100 {
                    let refused = -((count + i % count) as f64 + 1.0);
                    assert!(answer.status != 0.0 || answer.rates_status == refused, "{answer:?}");
                    continue;
                }
                if real == Real::Double || i % 5 < 3 {
                    assert_eq!(
                        answer.status,
                        -((i % count) as f64 + 1.0),
                        "{}",
                        m.mechanism().name
                    );
                    assert!(answer.nearest_status < 0.0);
                }
            }
        }
    }
}

/// The test program that is written beside the code accepts it, and a changed geometry it does not.
#[test]
fn the_test_beside_the_code_finds_errors() {
    for m in shipped().into_iter().step_by(5) {
        let code = opm_generate::c(&m, content(&m)).unwrap();
        let wrong = code.source.replacen(".home + at.q_", ".home + R(0.01) + at.q_", 1);
        let told = programs_of(&code, &[&code.source, &wrong]);
        let Some([right, wrong]) = told.as_deref() else { return };
        assert!(right.0, "{}", right.1);
        if code.source.contains(".home + at.q_") {
            assert!(!wrong.0, "{}: {}", code.name, wrong.1);
        }
    }
}

/// The bits of a mode are its signs, the first one lowest.
#[test]
fn bits_are_signs() {
    let m = Manipulator::example("plano-spherical-5dof").unwrap();
    for (number, mode) in m.modes().enumerate() {
        let signs: String = m.format_mode(mode).chars().filter(|c| *c != ' ').collect();
        let bits = signs.chars().rev().fold(0, |bits, sign| 2 * bits + u64::from(sign == '-'));
        assert_eq!((mode.bits(), bits), (number as u64, number as u64));
        assert_eq!(mode, Mode::clone(&m.parse_mode(&signs).unwrap()));
    }
}

/// Every closed form and every condition of the library is in the code of a mechanism that is compared.
#[test]
fn every_closed_form_is_compared() {
    let library = [
        include_str!("../../src/library/planar.rs"),
        include_str!("../../src/library/spherical.rs"),
        include_str!("../../src/library/others.rs"),
        include_str!("../../src/library/conditions.rs"),
    ];
    let all: Vec<Manipulator> = shipped().into_iter().chain(covering(2, EVERY)).collect();
    let codes: Vec<_> = all.iter().map(|m| opm_generate::c(m, content(m)).unwrap()).collect();
    let forms = library.iter().flat_map(|file| file.split("    fn ").skip(1));
    let forms = forms.filter_map(|rest| rest.split_once('(')).map(|(name, _)| name);
    let forms = forms.filter(|name| {
        ["solve_", "value_", "axis_", "zero_"].iter().any(|begin| name.starts_with(begin))
    });
    let forms: Vec<&str> = forms.collect();
    assert!(forms.len() > 30, "{forms:?}");
    for form in forms {
        let used = codes.iter().filter(|code| code.source.contains(&format!("_{form}("))).count();
        assert!(used > 0, "no mechanism has {form}");
    }
}

/// clang accepts the code, and so do C++ compilers, as C++17.
#[test]
fn every_compiler_accepts_the_code() {
    let manipulators =
        shipped().into_iter().step_by(4).chain(covering(2, 500).into_iter().step_by(4));
    let codes: Vec<_> = manipulators.map(|m| opm_generate::c(&m, content(&m)).unwrap()).collect();
    let cpp = ["-x", "c++", "-std=c++17"];
    for (compiler, flags) in
        [("clang", &["-std=c99"][..]), ("c++", &cpp[..]), ("clang++", &cpp[..])]
    {
        if let Some(told) = compiled_by(compiler, flags, &codes) {
            assert_eq!(told, "", "{compiler}");
        }
    }
}
