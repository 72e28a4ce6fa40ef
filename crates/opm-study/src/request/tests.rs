//! Every wrong request names the option that is wrong, and says why.

use super::*;
use crate::error::RequestOption;
use crate::example;
use crate::kind::WorkspaceKind as Kind;

fn wrong(request: WorkspaceRequest) -> RequestError {
    request.check(example()).expect_err("a wrong request")
}

fn points(points: PointOptions) -> WorkspaceRequest {
    WorkspaceRequest::new(Kind::Grid).axis(Axis::fixed("x", 0.1)).points(points)
}

#[test]
fn the_option_that_is_wrong_is_named() {
    let request = WorkspaceRequest::new;
    let names = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect::<Vec<_>>();
    let scalars = |list: &[&str]| PointOptions { scalars: Some(names(list)), ..Default::default() };
    let axes = |list: &[&str]| PointOptions { axes: names(list), ..Default::default() };
    let color = PointOptions { color: Some("w".to_owned()), ..Default::default() };
    for (request, option, problem) in [
        (
            request(Kind::Grid).max_condition(0.5),
            RequestOption::MaxCondition,
            "0.5, expected a number of at least 1",
        ),
        (
            request(Kind::Upper).max_condition(9.0),
            RequestOption::MaxCondition,
            "with kind upper: a section alone has no condition number",
        ),
        (
            request(Kind::Grid).length(-1.0),
            RequestOption::Length,
            "-1.0 m, expected a positive length, 1e-75 to 1e75 m",
        ),
        (
            request(Kind::Reachable).conditioning(),
            RequestOption::Conditioning,
            "with kind reachable: only poses have a condition number; ask for it of grid, \
             constant-orientation or orientation",
        ),
        (
            request(Kind::Imaginary).modes(Modes::Any),
            RequestOption::Mode,
            "with kind imaginary: the imaginary joints have other values in each mode; give one",
        ),
        (
            request(Kind::Orientation).axis(Axis::new("x", 0.0, 0.1, 2)),
            RequestOption::Grid,
            "x has 2 values; kind orientation holds the place's coordinates: give one value, x=VALUE",
        ),
        (
            request(Kind::Upper).axis(Axis::fixed("x", 0.1)),
            RequestOption::Grid,
            "grid axis x: no such task coordinate of the upper section, expected one of zeta, xi, psi",
        ),
        (
            points(axes(&["x", "y"])),
            RequestOption::Axes,
            "\"x,y\", expected three different task coordinates, or tip",
        ),
        (
            points(axes(&["x", "y", "w"])),
            RequestOption::Axes,
            "no task coordinate \"w\", expected one of x, y, zeta, xi, psi",
        ),
        (
            points(scalars(&["x"])),
            RequestOption::Scalars,
            "a cloud has a field x already; use axes",
        ),
        (points(scalars(&["S1", "S1"])), RequestOption::Scalars, "S1 is given twice"),
        (
            points(color),
            RequestOption::Color,
            "\"w\" is not one of x, y, zeta, xi, psi, theta11, theta12, theta13, S1, S2, S3, phi14, \
             phi24, inverse_condition, iti, oti, lti, effort_per_force, effort_per_moment, holding_torque, holding_force, clearance",
        ),
    ] {
        let error = wrong(request);
        assert_eq!((error.option(), &*error.problem(RequestOption::name)), (option, problem));
        assert_eq!(error.to_string(), format!("{}: {problem}", option.name()));
    }
}

#[test]
fn names_of_places_are_those_of_their_kind() {
    let points = PointOptions { scalars: Some(vec!["S1".to_owned()]), ..Default::default() };
    let error = wrong(WorkspaceRequest::new(Kind::Dexterous).points(points));
    let problem = error.problem(|option| match option {
        RequestOption::Kind => "--kind",
        other => other.name(),
    });
    assert_eq!(problem, "\"S1\" with --kind dexterous: not one of x, y, share");
}

#[test]
fn a_length_is_for_condition_numbers() {
    let request = WorkspaceRequest::new(Kind::Grid).length(0.1);
    let checked = request.clone().check(example()).unwrap();
    assert_eq!(checked.refuse_unused_length(), Err(RequestError::UnusedLength));
    for request in [request.clone().conditioning(), request.clone().max_condition(3.0)] {
        assert_eq!(request.check(example()).unwrap().refuse_unused_length(), Ok(()));
    }
    let color = Some(crate::INVERSE_CONDITION.to_owned());
    let request = request.points(PointOptions { color, ..Default::default() });
    assert_eq!(request.check(example()).unwrap().refuse_unused_length(), Ok(()));
}

#[test]
fn the_rules_of_every_kind_are_met_by_a_fitted_grid() {
    let progress = Progress::default();
    for kind in [Kind::ConstantOrientation, Kind::Orientation, Kind::Upper, Kind::Lower] {
        let workspace = WorkspaceRequest::new(kind).resolve(example(), &progress).unwrap();
        assert!(workspace.unbounded().is_some(), "{kind}");
        let held = kind.held_axes(workspace.grid());
        assert!(workspace.grid().axes()[held].iter().all(|axis| axis.count == 1), "{kind}");
        let axes = workspace.grid().axes().to_vec();
        let again = WorkspaceRequest { axes, ..WorkspaceRequest::new(kind) };
        let again = again.check(example()).unwrap();
        assert_eq!(again.grid(), Some(workspace.grid()), "{kind}");
    }
}

#[test]
fn a_dexterous_set_is_within_the_reachable_one() {
    let progress = Progress::default();
    let [reachable, dexterous] = [Kind::Reachable, Kind::Dexterous].map(|kind| {
        let request = WorkspaceRequest::new(kind)
            .axis(Axis::new("x", -0.3, 0.3, 31))
            .axis(Axis::new("y", -0.3, 0.3, 31))
            .axis(Axis::new("xi", -0.5, 0.5, 5));
        let workspace = request.resolve(example(), &progress).unwrap();
        let analysis = workspace.analyse(&progress).unwrap();
        let visits = workspace.visits(&workspace.sweep(), &progress).unwrap().unwrap();
        let required = workspace.required_visits().unwrap();
        let set = workspace.set(|place| visits[place as usize] >= required).unwrap();
        assert_eq!(Some(&set), analysis.set.as_ref());
        set
    });
    assert!(0 < dexterous.count() && dexterous.count() < reachable.count());
    assert!(dexterous.numbers().all(|place| reachable.contains(place)));
}
