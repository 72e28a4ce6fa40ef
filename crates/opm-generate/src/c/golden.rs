//! A test program, and the poses that it compares with what opm solved.

use crate::golden::rows;
use crate::names::comment;
use opm_core::Manipulator;

/// The poses: a header of constants.
pub fn vectors(manipulator: &Manipulator) -> String {
    let rows = rows(manipulator, |mode, status, lists| {
        let [pose, joints, imaginary] =
            lists.map(|list| if list.is_empty() { "0".to_owned() } else { list });
        format!(
            "    {{ {mode}u, {status}, {{ {pose} }},\n      {{ {joints} }},\n      {{ {imaginary} }} }},\n"
        )
    });
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

/// The test program.
pub fn program(name: &str) -> String {
    TEST.replace("NAME_.h", &format!("{name}.h")).replace("NAME_:", &format!("{name}:"))
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
    let flags = crate::golden::angles(manipulator, ["1", "0"]);
    format!("\n/* Which joints are angles. */\nstatic const int NAME_is_angle[] = {{ {flags} }};\n")
}
