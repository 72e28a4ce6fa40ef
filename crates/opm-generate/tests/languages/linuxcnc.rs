//! The module for LinuxCNC, compiled with declarations of its headers, and called as `motmod` does.

use crate::comparison::unit;
use crate::compiled::{STRICT, compiler};
use crate::drawn::shipped;
use fastrand::Rng;
use opm_core::velocity::Measures;
use opm_core::{Manipulator, Quantity};
use std::f64::consts::TAU;
use std::io::Write as _;
use std::process::{Command, Stdio};

/// What the module for LinuxCNC includes, and what it needs of it: declarations alone.
const LINUXCNC: [(&str, &str); 4] = [
    (
        "kinematics.h",
        "typedef struct { double x, y, z; } PmCartesian;
         typedef struct EmcPose { PmCartesian tran; double a, b, c, u, v, w; } EmcPose;
         typedef enum { KINEMATICS_IDENTITY = 1, KINEMATICS_FORWARD_ONLY, KINEMATICS_INVERSE_ONLY, KINEMATICS_BOTH } KINEMATICS_TYPE;
         typedef unsigned long int KINEMATICS_FORWARD_FLAGS;
         typedef unsigned long int KINEMATICS_INVERSE_FLAGS;
         extern int kinematicsForward(const double *joint, struct EmcPose *world, const KINEMATICS_FORWARD_FLAGS *fflags,
                                      KINEMATICS_INVERSE_FLAGS *iflags);
         extern int kinematicsInverse(const struct EmcPose *world, double *joint, const KINEMATICS_INVERSE_FLAGS *iflags,
                                      KINEMATICS_FORWARD_FLAGS *fflags);
         extern KINEMATICS_TYPE kinematicsType(void);
         extern int kinematicsSwitchable(void);
         extern int kinematicsSwitch(int type);
         #define KINS_NOT_SWITCHABLE int kinematicsSwitchable(void) { return 0; } int kinematicsSwitch(int type) { (void)type; return 0; }
         ",
    ),
    ("hal.h", "int hal_init(const char *name);\nint hal_ready(int id);\nint hal_exit(int id);\n"),
    ("rtapi.h", "#define RTAPI_MP_INT(name, text) extern const int name##_is_a_parameter\n#define RTAPI_MSG_ERR 1\nvoid rtapi_print_msg(int level, const char *fmt, ...);\n"),
    (
        "rtapi_app.h",
        "#define EXPORT_SYMBOL(name) extern const int name##_is_exported\n#define MODULE_LICENSE(text) extern const int is_licensed\n\
         int rtapi_app_main(void);\nvoid rtapi_app_exit(void);\n",
    ),
];

/// For each pose in LinuxCNC's order of axes, asks for the joints, and then, from a world of zeros, for the pose of these
/// joints. With an argument, it is given joints, and asks for their poses alone.
const ASK: &str = "
#include <stdio.h>
#include <string.h>
#include \"kinematics.h\"
#include \"hal.h\"
#include \"rtapi.h\"
#include \"rtapi_app.h\"
int hal_init(const char *name) { return name[0] ? 7 : -1; }
int hal_ready(int id) { return id - 7; }
int hal_exit(int id) { return id - 7; }
void rtapi_print_msg(int level, const char *fmt, ...) { (void)level; (void)fmt; }
int main(int argc, char **argv)
{
    double p[9], joints[16] = { 0 };
    (void)argv;
    KINEMATICS_FORWARD_FLAGS forward = 0;
    KINEMATICS_INVERSE_FLAGS inverse = 0;
    if (rtapi_app_main() != 0 || kinematicsType() != KINEMATICS_BOTH) return 2;
    /* Joints alone. */
    while (argc > 1 && fread(joints, sizeof joints, 1, stdin) == 1) {
        struct EmcPose world;
        double answer[2 + 16 + 9] = { 0 };
        memset(&world, 0, sizeof world);
        answer[17] = kinematicsForward(joints, &world, &forward, &inverse);
        answer[18] = world.tran.x; answer[19] = world.tran.y; answer[20] = world.tran.z;
        answer[21] = world.a; answer[22] = world.b; answer[23] = world.c;
        answer[24] = world.u; answer[25] = world.v; answer[26] = world.w;
        fwrite(answer, sizeof answer, 1, stdout);
    }
    while (fread(p, sizeof p, 1, stdin) == 1) {
        struct EmcPose world;
        double answer[2 + 16 + 9] = { 0 };
        memset(&world, 0, sizeof world);
        world.tran.x = p[0]; world.tran.y = p[1]; world.tran.z = p[2];
        world.a = p[3]; world.b = p[4]; world.c = p[5];
        world.u = p[6]; world.v = p[7]; world.w = p[8];
        memset(joints, 0, sizeof joints);
        answer[0] = kinematicsInverse(&world, joints, &inverse, &forward);
        memcpy(answer + 1, joints, sizeof joints);
        memset(&world, 0, sizeof world);
        answer[17] = kinematicsForward(joints, &world, &forward, &inverse);
        answer[18] = world.tran.x; answer[19] = world.tran.y; answer[20] = world.tran.z;
        answer[21] = world.a; answer[22] = world.b; answer[23] = world.c;
        answer[24] = world.u; answer[25] = world.v; answer[26] = world.w;
        fwrite(answer, sizeof answer, 1, stdout);
    }
    rtapi_app_exit();
    return 0;
}
";

/// What the module answers for a pose.
struct Moved {
    /// Of `kinematicsInverse`, with the joints.
    inverse: f64,
    joints: [f64; 16],
    /// Of `kinematicsForward` for these joints, with the axes.
    forward: f64,
    axes: [f64; 9],
}

/// A module that is compiled.
struct Module {
    folder: tempfile::TempDir,
    /// Which of LinuxCNC's axes each coordinate is, and its units in a metre or a radian.
    axes: Vec<(usize, f64)>,
    units: Vec<f64>,
}

impl Module {
    /// `None` where there is no module, or no compiler.
    fn new(m: &Manipulator) -> Option<Self> {
        let code = opm_generate::c(m, opm_generate::Content::Kinematics).unwrap();
        code.linuxcnc.as_ref()?;
        let compiler = compiler()?;
        let folder = tempfile::tempdir().expect("a directory for temporary files");
        let write = |name: &str, text: &str| {
            std::fs::write(folder.path().join(name), text).expect("a file in it");
        };
        code.files().iter().for_each(|(name, text)| write(name, text));
        LINUXCNC.iter().for_each(|(name, text)| write(name, text));
        write("ask.c", ASK);
        let module = format!("{}_linuxcnc.c", code.name);
        let built = Command::new(&compiler)
            .args(STRICT)
            .args(["-Werror", "-O1", "-I.", "-o", "ask", "ask.c", &module, "-lm"])
            .current_dir(folder.path())
            .output()
            .expect("a compiler that runs");
        assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
        let (mut angles, mut lengths) = (3..6, 6..9);
        let of_quantity = |quantity| if quantity == Quantity::Length { 1e3 } else { 360.0 / TAU };
        let axes = m.task_coordinates().iter().map(|c| {
            let place = ["x", "y", "z"].iter().position(|name| *name == c.name);
            let axis = match (c.quantity, place) {
                (Quantity::Length, Some(axis)) => axis,
                (Quantity::Length, None) => lengths.next().unwrap(),
                (Quantity::Angle, _) => angles.next().unwrap(),
            };
            (axis, of_quantity(c.quantity))
        });
        let axes = axes.collect();
        let units =
            m.actuated().iter().map(|&i| of_quantity(m.coordinates()[i].quantity)).collect();
        Some(Self { folder, axes, units })
    }

    fn ask(&self, poses: &[Vec<f64>]) -> Vec<Moved> {
        let axes = poses.iter().map(|pose| {
            let mut axes = [0.0; 9];
            for ((axis, unit), value) in self.axes.iter().zip(pose) {
                axes[*axis] = value * unit;
            }
            axes
        });
        self.run(&[], &axes.flatten().collect::<Vec<_>>())
    }

    /// The poses of joints, radians and metres.
    fn ask_for_poses(&self, joints: &[Vec<f64>]) -> Vec<Moved> {
        let all = joints.iter().map(|joints| {
            let mut all = [0.0; 16];
            for ((to, unit), value) in all.iter_mut().zip(&self.units).zip(joints) {
                *to = value * unit;
            }
            all
        });
        self.run(&["joints"], &all.flatten().collect::<Vec<_>>())
    }

    fn run(&self, arguments: &[&str], input: &[f64]) -> Vec<Moved> {
        let mut child = Command::new(self.folder.path().join("ask"))
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("it runs");
        let input: Vec<u8> = input.iter().flat_map(|value| value.to_ne_bytes()).collect();
        let mut stdin = child.stdin.take().expect("a pipe");
        let writer = std::thread::spawn(move || stdin.write_all(&input));
        let done = child.wait_with_output().expect("it ends");
        writer.join().expect("it writes").expect("all is read");
        assert!(done.status.success(), "{}", done.status);
        let numbers =
            done.stdout.chunks_exact(8).map(|bytes| f64::from_ne_bytes(bytes.try_into().unwrap()));
        let numbers: Vec<f64> = numbers.collect();
        let answers = numbers.chunks_exact(27).map(|row| Moved {
            inverse: row[0],
            joints: row[1..17].try_into().unwrap(),
            forward: row[17],
            axes: row[18..].try_into().unwrap(),
        });
        answers.collect()
    }

    /// The pose of an answer, radians and metres.
    fn pose(&self, moved: &Moved) -> Vec<f64> {
        self.axes.iter().map(|(axis, unit)| moved.axes[*axis] / unit).collect()
    }
}

/// The parallel measures of the sections and of the whole at a pose, and the serial ones of the sections; `None` where it is out
/// of reach.
fn measures(m: &Manipulator, pose: &[f64]) -> Option<([f64; 3], [f64; 2])> {
    let mut at = m.solution();
    m.inverse(pose, m.home_mode(), &mut at).unwrap()?;
    let (mut jacobians, mut measured) = (m.jacobians(), m.singularities());
    m.differentiate(&at, &mut jacobians).unwrap();
    m.measure_singularities(&jacobians, &mut measured);
    let of = |measures: &Measures| measures.parallel.unwrap_or(0.0);
    let [lower, upper] = [of(&measured.lower), of(&measured.upper)];
    // That of the whole is a volume, which has no sign, where it is not square.
    let whole = if lower * upper == 0.0 { of(&measured.whole) } else { lower * upper };
    let parallel = [lower, upper, whole];
    Some((parallel, [measured.lower.serial, measured.upper.serial]))
}

/// Whether the actuated joints are as many as the freedoms, so that determinants have signs.
fn is_square(m: &Manipulator) -> bool {
    m.actuated().len() == m.task_coordinates().len()
}

/// On a random walk about home, joints are opm's, and go on smoothly; and from a world of zeros, the pose is found again. A pose
/// in another assembly than home's is refused.
#[test]
fn linuxcnc_keeps_to_the_assembly_of_home() {
    let mut modules = 0;
    let mut rng = Rng::with_seed(61);
    for m in shipped() {
        let Some(module) = Module::new(&m) else { continue };
        modules += 1;
        let name = &m.mechanism().name;
        let home = m.home_pose();
        let (of_home, serial) = measures(&m, &home).unwrap();
        let intersection = m.task().intersection.as_ref();
        let shares_rotation = intersection.is_none_or(|axis| axis.point.is_some());
        let count = if name == "planar-3rrr" { 10_000 } else { 1_000 };
        let mut here = home.clone();
        let mut poses = Vec::new();
        for number in 0..count {
            // Far poses without a way to them, and a walk.
            let leaps = number % 50 == 49;
            for ((q, home), c) in here.iter_mut().zip(&home).zip(m.task_coordinates()) {
                let span = unit(&m, c.quantity);
                let goal = home + 0.8 * span * (2.0 * rng.f64() - 1.0);
                *q = if leaps { goal } else { *q + (goal - *q).clamp(-0.02 * span, 0.02 * span) };
            }
            poses.push(here.clone());
        }
        let answers = module.ask(&poses);
        assert_eq!(answers.len(), poses.len());
        let mut at = m.solution();
        let (mut reached, mut refused, mut missed) = (0, 0, 0);
        for (pose, moved) in poses.iter().zip(&answers) {
            let found = measures(&m, pose);
            // Beyond a serial singularity without a choice of the working mode, both answers are right.
            let beyond =
                found.is_some_and(|(_, now)| now.iter().zip(serial).any(|(a, b)| a * b < 0.0));
            let now = found.map(|(parallel, _)| parallel);
            let other = now.filter(|_| is_square(&m)).is_some_and(|now| {
                // Where the sections share a translation, the module knows the determinant of the whole alone.
                let first = if shares_rotation { 0 } else { 2 };
                let pairs = now.iter().zip(of_home).skip(first);
                pairs.into_iter().any(|(now, home)| now * home < 0.0 && home.abs() > 1e-6)
            });
            let near = now.is_none_or(|now| {
                now.iter().zip(of_home).any(|(now, home)| now.abs() < 1e-5 && home.abs() > 1e-6)
            });
            if now.is_none() || (other && !near && !beyond) {
                refused += 1;
                assert_eq!(moved.inverse, -1.0, "{name}: {pose:?} {now:?} {of_home:?}");
                continue;
            }
            if near || (beyond && moved.inverse != 0.0) {
                continue;
            }
            assert_eq!(moved.inverse, 0.0, "{name}: {pose:?}");
            reached += 1;
            let at = m.inverse(pose, m.home_mode(), &mut at).unwrap().unwrap();
            for ((joint, unit), &number) in moved.joints.iter().zip(&module.units).zip(m.actuated())
            {
                let mut off = joint / unit - at.joints()[number];
                if m.coordinates()[number].quantity == Quantity::Angle {
                    off -= TAU * (off / TAU).round();
                }
                assert!(off.abs() < 1e-9, "{name}: {pose:?} {off:e}");
            }
            if moved.forward != 0.0 {
                missed += 1;
                continue;
            }
            let found = module.pose(moved);
            let [found, wanted] = [&found, pose]
                .map(|pose| m.platform_at(&m.displacement_in(pose, m.home_mode()).unwrap()));
            let off = m.platform_distance(&found, &wanted);
            assert!(off < 1e-6, "{name}: {pose:?} {off:e}");
        }
        println!("{name}: {reached} poses found again, {missed} not, {refused} refused");
        assert!(reached > 0 && missed * 100 <= reached, "{name}: {missed} of {reached}");
    }
    assert!(modules > 8, "{modules}");
}

/// While the platform turns around twice and back, no joint jumps: coaxial motors turn around, too.
#[test]
fn linuxcnc_follows_full_turns() {
    for (name, yaw) in [("orbita", "psi"), ("planar-3rrr", "theta"), ("schoenflies-4dof", "phi")] {
        let m = Manipulator::example(name).unwrap();
        let Some(module) = Module::new(&m) else { return };
        let place = m.task_coordinates().iter().position(|c| c.name == yaw);
        let Some(place) = place else { panic!("{name} has no {yaw}: {:?}", m.task_coordinates()) };
        let mut poses = Vec::new();
        for step in (0..=1440).chain((0..1440).rev()) {
            let mut pose = m.home_pose();
            pose[place] += TAU * f64::from(step) / 720.0;
            poses.push(pose);
        }
        let answers = module.ask(&poses);
        let followed = answers.iter().take_while(|moved| moved.inverse == 0.0).count();
        println!("{name}: {followed} of {}", answers.len());
        for pair in answers[..followed].windows(2) {
            for (i, unit) in module.units.iter().enumerate() {
                let moved = (pair[1].joints[i] - pair[0].joints[i]).abs() / unit;
                assert!(moved < 0.2, "{name}: joint {i} jumps by {moved}");
            }
            assert_eq!(pair[1].forward, 0.0, "{name}");
        }
        if name == "orbita" {
            assert_eq!(followed, answers.len());
            let turned = answers[1440].joints[0] - answers[0].joints[0];
            assert!((turned.abs() - 720.0).abs() < 1e-6, "{turned}");
        }
    }
}

/// From measured joints alone, along a walk in home's assembly that starts there, every pose is found, though the world is always
/// zero.
#[test]
fn linuxcnc_finds_the_poses_of_joints() {
    let mut rng = Rng::with_seed(62);
    for name in ["planar-3rrr", "plano-spherical-5dof", "orbita", "agile-eye", "planar-planar-5dof"]
    {
        let m = Manipulator::example(name).unwrap();
        let Some(module) = Module::new(&m) else { return };
        let (home, mode) = (m.home_pose(), m.home_mode());
        let (of_home, _) = measures(&m, &home).unwrap();
        let (mut here, mut at) = (home.clone(), m.solution());
        let (mut poses, mut joints) = (Vec::new(), Vec::new());
        while poses.len() < 2_000 {
            let next: Vec<f64> = (here.iter().zip(&home).zip(m.task_coordinates()))
                .map(|((q, home), c)| {
                    let span = unit(&m, c.quantity);
                    let goal = home + 0.5 * span * (2.0 * rng.f64() - 1.0);
                    q + (goal - q).clamp(-0.01 * span, 0.01 * span)
                })
                .collect();
            // Joints move much faster than the platform near singularities.
            let same = measures(&m, &next).is_some_and(|(now, serial)| {
                let far =
                    now.iter().zip(of_home).all(|(now, home)| now / home > 0.05 || home == 0.0);
                far && serial.iter().all(|serial| serial.abs() > 0.02)
            });
            if same {
                let solved = m.inverse(&next, mode, &mut at).unwrap().unwrap();
                joints.push(m.actuated().iter().map(|&i| solved.joints()[i]).collect());
                poses.push(next.clone());
                here = next;
            }
        }
        let answers = module.ask_for_poses(&joints);
        assert_eq!(answers.len(), poses.len());
        for (pose, moved) in poses.iter().zip(&answers) {
            assert_eq!(moved.forward, 0.0, "{name}: {pose:?}");
            let [found, wanted] = [&module.pose(moved), pose]
                .map(|pose| m.platform_at(&m.displacement_in(pose, mode).unwrap()));
            let off = m.platform_distance(&found, &wanted);
            assert!(off < 1e-6, "{name}: {pose:?} {off:e}");
        }
    }
}
