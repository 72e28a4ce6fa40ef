//! Tables of places are the motions of the poses that have these places.

use opm_core::Manipulator;
use opm_core::motion::table::{TableOptions, read};
use opm_core::motion::{Instant, PlatformMotion};

/// Digits of a place: those of all numbers.
const SAME: f64 = 1e-9;

/// Poses beside home: a wave of each coordinate, so that tilts pass through zero and angles grow beyond π.
fn poses(m: &Manipulator) -> Vec<Vec<f64>> {
    let waves = (0..40).map(|i| {
        let t = f64::from(i) / 39.0;
        let one = |(number, c): (usize, &opm_core::task::TaskCoordinate)| match c.name {
            "zeta" => c.home + 4.0 * t,
            "xi" | "pitch" => c.home + 0.35 * (6.0 * t + 0.4).cos(),
            "psi" | "yaw" | "roll" => c.home + 0.3 * (5.0 * t + number as f64).sin(),
            "theta" | "phi" => c.home + 0.3 * t,
            _ => c.home + 0.02 * (4.0 * t + number as f64).sin(),
        };
        m.task_coordinates().iter().enumerate().map(one).collect()
    });
    waves.collect()
}

fn followed(m: &Manipulator, text: &str) -> PlatformMotion {
    read(text, "test", m, &TableOptions::default()).unwrap_or_else(|e| panic!("{text}\n{e}")).motion
}

#[test]
fn places_are_those_of_poses() {
    for name in
        ["stewart", "delta", "plano-spherical-5dof", "agile-eye", "planar-3rrr", "tripteron"]
    {
        let m = Manipulator::example(name).unwrap();
        let names: Vec<_> = m.task_coordinates().iter().map(|c| c.name).collect();
        let mut table = format!("t,{}\n", names.join(","));
        let mut tum = "# timestamp tx ty tz qx qy qz qw\n\n".to_owned();
        let mut csv = "qw,qx,qy,qz,t,x [mm],y [mm],z [mm]\n".to_owned();
        for (i, pose) in poses(&m).iter().enumerate() {
            let cells: Vec<String> = pose.iter().map(|value| format!("{value:?}")).collect();
            table += &format!("{i},{}\n", cells.join(","));
            let place = m.platform_pose(pose).unwrap();
            let ([x, y, z], q) = (place.translation.vector.into(), place.rotation);
            let _: [f64; 3] = [x, y, z];
            tum += &format!("{i} {x:?} {y:?}\t{z:?} {:?} {:?} {:?} {:?}\n", q.i, q.j, q.k, q.w);
            let [x, y, z] = [x, y, z].map(|value| 1e3 * value);
            csv += &format!("{:?},{:?},{:?},{:?},{i},{x:?},{y:?},{z:?}\n", q.w, q.i, q.j, q.k);
        }
        let expected = followed(&m, &table);
        for text in [&tum, &csv] {
            let found = followed(&m, text);
            assert_eq!((found.start, found.duration), (expected.start, expected.duration));
            let [mut one, mut other] = [(); 2].map(|()| Instant::new(names.len()));
            for i in 0..390 {
                let t = f64::from(i) / 10.0;
                found.at(t, &mut one);
                expected.at(t, &mut other);
                let places = [&one, &other].map(|at| m.platform_pose(&at.pose).unwrap());
                let apart = (places[0].translation.vector - places[1].translation.vector).norm()
                    + places[0].rotation.angle_to(&places[1].rotation);
                assert!(apart < SAME * 1e3, "{name} at {t}: {apart:e}");
            }
        }
    }
}

#[test]
fn what_is_no_place_is_told_at_its_line() {
    let m = Manipulator::example("delta").unwrap();
    let z = m.platform_pose(&m.home_pose()).unwrap().translation.z;
    for (text, expected) in [
        (
            format!("# a\n0 0 0 {z} 0 0 0 1\n1 0 0 {z} 0 0 0 2\n"),
            "3:1: the quaternion 2,0,0,0 has length 2.0000",
        ),
        (
            format!("0 0 0 {z} 0 0 0 1\n1 0 0 {z} 0 0 0.6 0.8\n"),
            "2:1: outside the manipulator's motion by 1.287e0 rad",
        ),
        (format!("0 0 0 {z} 0 0 0 1\n\n0 0 0 {z} 0 0 0 1\n"), "3:1: t is 0 after 0"),
        (format!("0 0 0 {z} 0 0 0 1\n"), "1:1: 1 time given, expected at least 2"),
        (format!("0 0 0 {z} 0 0 0 1\n1 0 0 {z} 0 0 0\n"), "2:1: 7 cells, expected 8"),
        (format!("0 0 0 {z} 0 0 0 1\n1 0 0 {z} 0 0 0 a\n"), ": \"a\", expected a number"),
        ("t,x,y,qx,qy,qz,qw\n".to_owned(), "1:1: no column z, expected a place in each row"),
        ("t,x,y,z,qx,qy,qz,qw,e\n".to_owned(), "1:21: \"e\" beside a quaternion"),
        ("t,x,y,z,qx,qy,qz,qw,x\n".to_owned(), "1:21: two columns are called x"),
        ("x,y,z,qx,qy,qz,qw\n".to_owned(), "1:1: no column t"),
    ] {
        let error = read(&text, "test", &m, &TableOptions::default()).unwrap_err();
        assert!(error.to_string().contains(expected), "{text}: {error}");
    }
}
