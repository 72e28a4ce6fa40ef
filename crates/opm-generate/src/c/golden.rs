//! A test program, and the poses that it compares with what opm solved.

use crate::names::comment;
use opm_core::numeric::Quantity;
use opm_core::{Manipulator, Mode, Solution};
use std::f64::consts::PI;

/// The most poses in reach, and out of it.
const POSES: [usize; 2] = [64, 16];

/// The most poses that are tried.
const TRIED: usize = 4000;

/// The largest changes of coordinates for which joints are compared, radians or sizes of the mechanism, and by how much
/// more than the pose the joints may move then: nearer to a singularity, float has too few digits to compare.
const STEP: f64 = 1e-4;
const GAIN: f64 = 200.0;

/// The poses: a header of constants.
pub fn vectors(manipulator: &Manipulator) -> String {
    let mut rows = String::new();
    let (mut at, mut near) = (manipulator.solution(), manipulator.solution());
    let mut left = POSES;
    for number in 1..=TRIED {
        if left == [0; 2] {
            break;
        }
        let (pose, mode) = sample(manipulator, number);
        let Some(status) = status(manipulator, &pose, mode, &mut at) else { continue };
        let left = &mut left[usize::from(status != 0)];
        if *left == 0 || !is_plain(manipulator, &pose, mode, (&at, status), &mut near) {
            continue;
        }
        *left -= 1;
        rows += &row(&pose, mode, status, &at);
    }
    if rows.is_empty() {
        let (pose, mode) = (manipulator.home_pose(), manipulator.home_mode());
        if let Some(status) = status(manipulator, &pose, mode, &mut at) {
            rows = row(&pose, mode, status, &at);
        }
    }
    let size = |count: usize| count.max(1);
    format!(
        "/* Poses of {}, with the joints that opm {} found: the mode, what NAME_inverse returns, the pose, the joints and the\n   \
         imaginary joints, metres and radians. */\n\
         static const struct {{\n    unsigned mode;\n    int status;\n    double pose[{}], joints[{}], imaginary[{}];\n\
         }} NAME_golden[] = {{\n{rows}}};\n",
        comment(&manipulator.mechanism().name),
        env!("CARGO_PKG_VERSION"),
        size(manipulator.task_coordinates().len()),
        size(manipulator.coordinates().len()),
        size(manipulator.imaginary().len()),
    )
}

/// One pose as a row of the constant.
fn row(pose: &[f64], mode: Mode, status: usize, at: &Solution) -> String {
    let list = |values: &[f64]| {
        let all: Vec<String> = values.iter().map(|&value| format!("{:?}", value + 0.0)).collect();
        if all.is_empty() { "0".to_owned() } else { all.join(", ") }
    };
    let of_solution = |values: &[f64]| if status == 0 { list(values) } else { "0".to_owned() };
    format!(
        "    {{ {}u, {status}, {{ {} }},\n      {{ {} }},\n      {{ {} }} }},\n",
        mode.bits(),
        list(pose),
        of_solution(at.joints()),
        of_solution(at.imaginary())
    )
}

/// The number of the first leg that does not reach a pose, from 1, or zero; `None` for what is no pose.
fn status(m: &Manipulator, pose: &[f64], mode: Mode, at: &mut Solution) -> Option<usize> {
    m.inverse(pose, mode, at).ok()?;
    Some(at.unreachable().first().map_or(0, |missed| missed.leg + 1))
}

/// Whether the answer does not change, or only in proportion, where every coordinate of the pose does.
fn is_plain(
    m: &Manipulator,
    pose: &[f64],
    mode: Mode,
    (at, expected): (&Solution, usize),
    near: &mut Solution,
) -> bool {
    let size = m.characteristic_length();
    let unit = |quantity: Quantity| if quantity == Quantity::Angle { 1.0 } else { size };
    let mut moved = pose.to_vec();
    for (i, coordinate) in m.task_coordinates().iter().enumerate() {
        for step in [STEP, -STEP] {
            moved[i] = pose[i] + step * unit(coordinate.quantity);
            if status(m, &moved, mode, near) != Some(expected) {
                return false;
            }
            let joints = at.joints().iter().zip(near.joints()).zip(m.coordinates());
            let far =
                joints.map(|((a, b), c)| (a - b).abs() / unit(c.quantity)).fold(0.0, f64::max);
            if expected == 0 && far > GAIN * STEP {
                return false;
            }
        }
        moved[i] = pose[i];
    }
    true
}

/// A pose and a mode from a sequence that fills their space evenly (Halton's).
fn sample(m: &Manipulator, number: usize) -> (Vec<f64>, Mode) {
    const PRIMES: [usize; 8] = [2, 3, 5, 7, 11, 13, 17, 19];
    let halton = |base: usize| {
        let (mut rest, mut digit, mut sum) = (number, 1.0, 0.0);
        while rest > 0 {
            digit /= base as f64;
            sum += digit * (rest % base) as f64;
            rest /= base;
        }
        2.0 * sum - 1.0
    };
    // Every second one is near home.
    let far = if number % 4 < 2 { 1.0 } else { 0.3 };
    let around = |(i, c): (usize, &opm_core::TaskCoordinate)| {
        let unit = if c.quantity == Quantity::Angle { PI } else { m.characteristic_length() };
        c.home + far * unit * halton(PRIMES[i % PRIMES.len()])
    };
    let pose = m.task_coordinates().iter().enumerate().map(around).collect();
    // Signs that change in no order: the bits of a product.
    let bits = (number as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let signs: String =
        (0..m.choices()).map(|bit| if bits >> (63 - bit) & 1 == 1 { '-' } else { '+' }).collect();
    (pose, m.parse_mode(&signs).unwrap_or_else(|_| m.home_mode()))
}

/// The test program.
pub fn program() -> &'static str {
    TEST
}

/// What CMake builds.
pub fn cmake(name: &str) -> String {
    format!(
        "cmake_minimum_required(VERSION 3.10)\nproject({name} C)\n\nset(CMAKE_C_STANDARD 99)\n\
         add_library({name} {name}.c)\n\
         target_include_directories({name} PUBLIC ${{CMAKE_CURRENT_SOURCE_DIR}})\n\
         if(UNIX)\n  target_link_libraries({name} PUBLIC m)\nendif()\n\n\
         enable_testing()\nadd_executable({name}_test {name}_test.c)\ntarget_link_libraries({name}_test {name})\n\
         add_test(NAME {name} COMMAND {name}_test)\n"
    )
}

const TEST: &str = "\
#include \"NAME_.h\"

#include \"NAME_golden.h\"

#include <math.h>
#include <stdio.h>

/* How far a joint may be from what opm found, radians or sizes of the mechanism. */
#define TOLERANCE (sizeof(NAME_real) == sizeof(float) ? 1e-3 : 1e-10)

/* The difference of two values of a joint; full revolutions are no difference where half a revolution from home decides. */
static double NAME_off(NAME_real found, double expected, double size, double full)
{
    const double off = fabs((double)found - expected);
    return (full > 0 && off > full / 2 ? fabs(off - full) : off) / size;
}

int main(void)
{
    const int count = (int)(sizeof NAME_golden / sizeof NAME_golden[0]);
    int failed = 0, i, j;
    double worst = 0;
    for (i = 0; i < count; ++i) {
        NAME_real pose[NAME_COORDINATES], joints[NAME_JOINTS], imaginary[NAME_IMAGINARY + 1];
        int status;
        double most = 0;
        for (j = 0; j < NAME_COORDINATES; ++j) {
            pose[j] = (NAME_real)NAME_golden[i].pose[j];
        }
        status = NAME_inverse(&NAME_default, pose, NAME_golden[i].mode, joints, imaginary);
        if (status == 0 && NAME_golden[i].status == 0) {
            for (j = 0; j < NAME_JOINTS; ++j) {
                const double size = (double)NAME_default.joint[j].size;
                const double full = NAME_is_angle[j] ? 6.283185307179586 : 0;
                const double off = NAME_off(joints[j], NAME_golden[i].joints[j], size, full);
                /* Not true of a number that is none. */
                most = off <= most ? most : off;
            }
        }
        if (status != NAME_golden[i].status || !(most <= TOLERANCE)) {
            printf(\"pose %d: status %d, expected %d; joints off by %g\\n\", i, status, NAME_golden[i].status, most);
            failed = 1;
        }
        worst = most <= worst ? worst : most;
    }
    printf(\"NAME_: %d poses, joints within %g\\n\", count, worst);
    return failed;
}
";

/// Which joint coordinates are angles: a constant of the header.
pub fn angles(manipulator: &Manipulator) -> String {
    let flag = |quantity: Quantity| if quantity == Quantity::Angle { "1" } else { "0" };
    let flags: Vec<&str> = manipulator.coordinates().iter().map(|c| flag(c.quantity)).collect();
    format!(
        "\n/* Which joints are angles. */\nstatic const int NAME_is_angle[] = {{ {} }};\n",
        flags.join(", ")
    )
}
