//! Forward kinematics by continuation: every assembly of mechanisms whose legs are solved whole. What is found is held against plain
//! geometry, published numbers of solutions, and Newton's method from many starts.

use fastrand::Rng;
use nalgebra::{Isometry3, Point3, Vector3};
use opm_core::Manipulator;
use opm_core::forward::{Assemblies, Completeness, ForwardMethod};
use std::f64::consts::PI;

/// The start of a mechanism file.
const HEAD: &str = "format = 1\nname = \"telescopes\"\nunits = { length = \"m\", angle = \"rad\" }\n[platform]\npoint = [0, 0, 0]\n";

fn list(v: Vector3<f64>) -> String {
    format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z)
}

/// A telescope between two points, with a ball at its end. It swings about a side of its own, or in all directions.
fn telescope(number: usize, [a, b]: [Vector3<f64>; 2], in_plane: bool) -> String {
    let along = (b - a).normalize();
    let side = along.cross(&Vector3::new(0.3, 0.5, 0.8)).normalize();
    let swings = match in_plane {
        true => format!("type = \"revolute\", axis = {}", list(side)),
        false => {
            let other = along.cross(&side);
            format!("type = \"universal\", axis = {}, axis2 = {}", list(side), list(other))
        }
    };
    format!(
        "[[leg]]\nname = \"leg{number}\"\njoints = [\n\
         {{ name = \"u{number}\", {swings}, point = {} }},\n\
         {{ name = \"p{number}\", type = \"prismatic\", axis = {}, actuated = true }},\n\
         {{ name = \"s{number}\", type = \"spherical\", point = {} }},\n]\n",
        list(a),
        list(along),
        list(b)
    )
}

/// A 3-RPS, or three telescopes about a ball (3-UPS-S), at home as given.
fn three_legs(kind: &str, base: &[[f64; 3]], platform: &[[f64; 3]]) -> Manipulator {
    let mut text = HEAD.to_owned();
    for (number, (a, b)) in base.iter().zip(platform).enumerate() {
        let ends = [Vector3::from(*a), Vector3::from(*b) + Vector3::z() * 1.2];
        text += &telescope(number, ends, kind == "RPS");
    }
    if kind == "UPS-S" {
        text += "[[leg]]\nname = \"stem\"\njoints = [{ name = \"s\", type = \"spherical\", point = [0.1, 0.2, 0.6] }]\n";
    }
    Manipulator::read(&text).unwrap()
}

/// A hexapod with universal joints at its base, telescopes, and balls at its platform, at home as given.
fn hexapod(base: &[[f64; 3]; 6], platform: &[[f64; 3]; 6], height: f64) -> Manipulator {
    let mut text = HEAD.to_owned();
    for (number, (a, b)) in base.iter().zip(platform).enumerate() {
        let ends = [Vector3::from(*a), Vector3::from(*b) + Vector3::z() * height];
        text += &telescope(number, ends, false);
    }
    Manipulator::read(&text).unwrap()
}

/// The actuated joints with which legs have these lengths.
fn telescopes(
    base: &[[f64; 3]; 6],
    platform: &[[f64; 3]; 6],
    height: f64,
    lengths: [f64; 6],
) -> Vec<f64> {
    let at_home = base
        .iter()
        .zip(platform)
        .map(|(a, b)| (Vector3::from(*b) + Vector3::z() * height - Vector3::from(*a)).norm());
    at_home.zip(lengths).map(|(home, length)| length - home).collect()
}

/// The lengths of the legs where the platform is displaced from home.
fn lengths(
    base: &[[f64; 3]; 6],
    platform: &[[f64; 3]; 6],
    height: f64,
    g: &Isometry3<f64>,
) -> [f64; 6] {
    std::array::from_fn(|i| {
        let home = Point3::from(Vector3::from(platform[i]) + Vector3::z() * height);
        (g * home - Point3::from(base[i])).norm()
    })
}

fn random(rng: &mut Rng, flat: bool) -> [[f64; 3]; 6] {
    let mut number = || 2.0 * rng.f64() - 1.0;
    std::array::from_fn(|_| [number(), number(), if flat { 0.0 } else { 0.3 * number() }])
}

/// The solutions that were found, and how many there are; of a closed form, which has the real ones alone, those.
fn solutions(found: &Assemblies) -> [usize; 2] {
    match found.completeness {
        Completeness::Continuation { found, of } => [found, of],
        Completeness::ClosedForm => [found.list.len(); 2],
    }
}

/// The hexapod with 40 real postures of P. Dietmaier, "The Stewart-Gough platform of general geometry can have 40 real postures",
/// Advances in Robot Kinematics, 1998.
#[test]
fn dietmaiers_hexapod_has_forty_assemblies() {
    let base = [
        [0.0, 0.0, 0.0],
        [1.107915, 0.0, 0.0],
        [0.549094, 0.756063, 0.0],
        [0.735077, -0.223935, 0.525991],
        [0.514188, -0.526063, -0.368418],
        [0.590473, 0.094733, -0.205018],
    ];
    let platform = [
        [0.0, 0.0, 0.0],
        [0.542805, 0.0, 0.0],
        [0.956919, -0.528915, 0.0],
        [0.665885, -0.353482, 1.402538],
        [0.478359, 1.158742, 0.107672],
        [-0.137087, -0.235121, 0.353913],
    ];
    let wanted = [1.0, 0.645275, 1.086284, 1.503439, 1.281933, 0.771071];
    let m = hexapod(&base, &platform, 1.0);
    assert_eq!(m.forward_method(), Ok(ForwardMethod::Continuation));
    let found = m.forward(&telescopes(&base, &platform, 1.0, wanted)).unwrap();
    assert_eq!(solutions(&found), [40, 40]);
    assert_eq!(found.list.len(), 40);
    for (number, one) in found.list.iter().enumerate() {
        let place = m.displacement_of(one);
        for (length, wanted) in lengths(&base, &platform, 1.0, &place).iter().zip(wanted) {
            assert!((length - wanted).abs() < 1e-11, "{length} {wanted}");
        }
        for other in &found.list[..number] {
            assert!(m.platform_distance(&place, &m.displacement_of(other)) > 1e-3);
        }
    }
}

/// Joints of inverse kinematics lead back to their pose, on random hexapods in space and flat ones; every assembly has its lengths, and
/// none comes twice.
#[test]
fn hexapods_lead_back() {
    let mut rng = Rng::with_seed(54);
    for flat in [false, false, true] {
        let [base, platform] = [random(&mut rng, flat), random(&mut rng, flat)];
        let m = hexapod(&base, &platform, 1.2);
        for _ in 0..4 {
            let pose = near(&m, 0.3, &mut rng);
            let (actuated, g) = joints_at(&m, &pose).unwrap();
            let found = m.forward(&actuated).unwrap();
            assert_eq!(solutions(&found), [40, 40]);
            check(&m, &actuated, &g, &found);
            let wanted = lengths(&base, &platform, 1.2, &g);
            for one in &found.list {
                let own = lengths(&base, &platform, 1.2, &m.displacement_of(one));
                assert!(own.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-10));
            }
        }
    }
}

/// As many solutions as are published: 16 where legs meet in pairs at three points of the platform (6-3, Innocenti and
/// Parenti-Castelli 1990) and of a 3-RPS, 8 of three spheres about a ball (3-UPS-S, Wohlhart 1994), 28 of a Tricept, 2 of a Delta, 1 of a
/// Tripteron.
#[test]
fn there_are_as_many_solutions_as_published() {
    let mut rng = Rng::with_seed(55);
    let base = random(&mut rng, false);
    let mut platform = random(&mut rng, false);
    for i in [1, 3, 5] {
        platform[i] = platform[i - 1];
    }
    let m = hexapod(&base, &platform, 1.2);
    let home = vec![0.0; 6];
    assert_eq!(solutions(&m.forward(&home).unwrap()), [16, 16]);

    let three = |rng: &mut Rng| random(rng, false).into_iter().step_by(2).collect::<Vec<_>>();
    for (kind, count) in [("RPS", 16), ("UPS-S", 8)] {
        let m = three_legs(kind, &three(&mut rng), &three(&mut rng));
        let (actuated, g) = joints_at(&m, &near(&m, 0.1, &mut rng)).unwrap();
        let found = m.forward(&actuated).unwrap();
        assert_eq!(solutions(&found), [count, count], "{kind}");
        check(&m, &actuated, &g, &found);
    }

    for (name, count) in [
        ("delta", 2),
        ("linear-delta", 2),
        ("orthoglide", 2),
        ("3-upu", 2),
        ("tripteron", 1),
        ("tricept", 28),
    ] {
        let m = Manipulator::example(name).unwrap();
        let (actuated, g) = joints_at(&m, &near(&m, 0.03, &mut rng)).unwrap();
        let found = m.forward(&actuated).unwrap();
        assert_eq!(solutions(&found), [count, count], "{name}");
        check(&m, &actuated, &g, &found);
    }
}

/// The assemblies of a Delta are where three spheres meet, of which the elbows are the centres.
#[test]
fn a_delta_stands_where_three_spheres_meet() {
    let m = Manipulator::example("delta").unwrap();
    let mut rng = Rng::with_seed(56);
    for _ in 0..20 {
        let (actuated, g) = joints_at(&m, &near(&m, 0.05, &mut rng)).unwrap();
        let found = m.forward(&actuated).unwrap();
        check(&m, &actuated, &g, &found);
        assert_eq!(found.list.len(), 2);
        // The displacements of the two are mirror images in the plane through the centres: the centres are as far from both.
        let moved: Vec<Vector3<f64>> =
            found.list.iter().map(|one| m.displacement_of(one).translation.vector).collect();
        let mut joints = 0;
        for leg in &m.mechanism().legs {
            let crank = &leg.joints[0];
            let home = m.coordinates()[joints].home;
            let number = m.actuated().iter().position(|&c| c == joints).unwrap();
            let turn =
                nalgebra::UnitQuaternion::from_axis_angle(&crank.axis, actuated[number] - home);
            let [elbow, hand] = [leg.joints[1].point, leg.joints[2].point];
            let elbow = crank.point + turn * (elbow - crank.point);
            let rod = (leg.joints[2].point - leg.joints[1].point).norm();
            for moved in &moved {
                assert!(((hand + moved - elbow).norm() - rod).abs() < 1e-11);
            }
            joints += leg.joints.iter().map(|joint| joint.coordinates.len()).sum::<usize>();
        }
    }
}

/// Newton's method, from many places and in many modes, finds no assembly that is not in the list.
#[test]
fn no_assembly_is_missing() {
    let mut rng = Rng::with_seed(57);
    for name in ["delta", "quadrupteron", "tricept", "ankle", "hexa", "stewart"] {
        let m = Manipulator::example(name).unwrap();
        let (actuated, g) = joints_at(&m, &near(&m, 0.05, &mut rng)).unwrap();
        let found = m.forward(&actuated).unwrap();
        check(&m, &actuated, &g, &found);
        let [all, of] = solutions(&found);
        assert_eq!(all, of, "{name}");
        let modes = m.modes().take(64).collect::<Vec<_>>();
        let mut others = 0;
        for _ in 0..150 {
            let start = near(&m, 1.0, &mut rng);
            let mode = modes[rng.usize(..modes.len())];
            let Ok(one) = m.forward_near(&actuated, &start, mode) else { continue };
            let place = m.displacement_of(&one);
            let known = |other| m.platform_distance(&place, &m.displacement_of(other)) < 1e-6;
            assert!(found.list.iter().any(known), "{name}: {:?}", one.pose);
            others += 1;
        }
        assert!(others > 2, "{name}: {others}");
    }
}

/// Joints with which legs do not meet have no assembly, and all solutions are complex.
/// At home, and turned by half a turn, products in a leg's equations are zero: each of them alone says nothing there. Both
/// assemblies are known by symmetry.
#[test]
fn a_quadrupteron_at_home_has_its_mirror_image() {
    let m = Manipulator::example("quadrupteron").unwrap();
    // `θ` is that of sin θ = (S2 - S1) / (2 rp), as the levers of its legs 1 and 2 are opposite.
    for [x, y, z] in [[0.0, 0.0, 0.0], [0.1, -0.05, 0.02], [0.0, 0.05, -0.03]] {
        let found = m.forward(&[x, x, y, z]).unwrap();
        assert_eq!(solutions(&found), [2, 2], "{x} {y} {z}");
        let mut turns: Vec<f64> = found.list.iter().map(|a| a.pose[3].abs()).collect();
        turns.sort_by(f64::total_cmp);
        assert!(turns[0] < 1e-9 && (turns[1] - PI).abs() < 1e-9, "{turns:?}");
        for a in &found.list {
            assert!((a.pose[0] - x).abs() + (a.pose[2] - z).abs() < 1e-9, "{:?}", a.pose);
        }
    }
}

#[test]
fn joints_out_of_reach_have_no_assembly() {
    let m = Manipulator::example("linear-delta").unwrap();
    let found = m.forward(&[2.0, -2.0, 2.0]).unwrap();
    assert!(found.list.is_empty() && !found.unmet.is_empty(), "{found:?}");
    assert_eq!(found.completeness, Completeness::ClosedForm);
    let bad = m.forward(&[f64::NAN, 0.0, 0.0]).unwrap_err();
    assert!(bad.to_string().contains("NaN"), "{bad}");
}

/// The same assembly in another working mode has the same actuated joints, and another value of a joint of that leg.
#[test]
fn other_branches_of_legs_are_other_modes_of_an_assembly() {
    let m = Manipulator::example("tripteron").unwrap();
    let mut rng = Rng::with_seed(58);
    let (actuated, _) = joints_at(&m, &near(&m, 0.05, &mut rng)).unwrap();
    let found = m.forward(&actuated).unwrap();
    assert_eq!(found.list.len(), 1);
    let [one] = &found.list[..] else { unreachable!() };
    assert_eq!(one.mode, m.home_mode());
    let mut elsewhere = 0;
    for mode in m.modes() {
        let Some(other) = m.assembly_in(one, mode) else { continue };
        assert!(m.platform_distance(&m.displacement_of(one), &m.displacement_of(&other)) < 1e-9);
        for (&c, wanted) in m.actuated().iter().zip(&actuated) {
            assert!((other.joints[c] - wanted).abs() < 1e-9);
        }
        elsewhere += usize::from(mode != one.mode);
    }
    assert!(elsewhere > 0);
}

/// A pose near home: lengths within a share of the size, angles within that many radians.
fn near(m: &Manipulator, share: f64, rng: &mut Rng) -> Vec<f64> {
    let size = m.characteristic_length();
    let of = |c: &opm_core::task::TaskCoordinate| {
        let unit = if c.quantity == opm_core::Quantity::Length { size } else { 1.0 };
        c.home + share * unit * (2.0 * rng.f64() - 1.0)
    };
    m.task_coordinates().iter().map(of).collect()
}

/// The actuated joints at a pose in home's mode, and the displacement of the platform.
fn joints_at(m: &Manipulator, pose: &[f64]) -> Option<(Vec<f64>, Isometry3<f64>)> {
    let mut solution = m.solution();
    let solution = m.inverse(pose, m.home_mode(), &mut solution).unwrap()?;
    let actuated = m.actuated().iter().map(|&c| solution.joints()[c]).collect();
    Some((actuated, solution.displacement(m)))
}

/// A displacement is among the assemblies, all close, have the actuated joints that were given, and differ.
fn check(m: &Manipulator, actuated: &[f64], g: &Isometry3<f64>, found: &Assemblies) {
    let name = &m.mechanism().name;
    let mut solution = m.solution();
    let places: Vec<Isometry3<f64>> = found.list.iter().map(|one| m.displacement_of(one)).collect();
    assert!(places.iter().any(|place| m.platform_distance(place, g) < 1e-7), "{name}");
    for (number, one) in found.list.iter().enumerate() {
        assert!(one.residual < 1e-10, "{name} {}", one.residual);
        let again = m.inverse(&one.pose, one.mode, &mut solution).unwrap().expect("it is in reach");
        for (&c, wanted) in m.actuated().iter().zip(actuated) {
            let off = again.joints()[c] - wanted;
            let angle = m.coordinates()[c].quantity == opm_core::Quantity::Angle;
            let off = if angle { off.sin().abs() } else { off.abs() };
            assert!(off < 1e-6, "{name} {off}");
        }
        for other in &places[..number] {
            assert!(m.platform_distance(&places[number], other) > 1e-6, "{name}");
        }
    }
}
