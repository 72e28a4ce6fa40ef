//! Wrong sizes and impossible questions are errors, not panics.

use opm_core::manipulator::Manipulator;
use opm_workspace::measure::{CoordinateRange, Domain, DomainError, Goal, Search, WrongAnswer};
use opm_workspace::{
    Axis, ConditionError, ConditioningIndex, Grid, MaskError, Modes, OtherGrid, PoseLimit,
    Progress, Sections, Sweep, Visits, mask_boundary,
};

fn manipulator() -> Manipulator {
    Manipulator::example("plano-spherical-5dof").unwrap()
}

#[test]
fn a_section_alone_has_no_condition_numbers() {
    let manipulator = manipulator();
    let axes = vec![Axis::new("x", -0.1, 0.1, 3)];
    let lower = Grid::of(Sections::Lower, &manipulator, axes.clone()).unwrap();
    let whole = Grid::new(&manipulator, axes).unwrap();
    let limit = |length| PoseLimit::none(length).with_condition(10.0);
    let sweep = |grid| Sweep::new(&manipulator, grid, Modes::Any);
    assert_eq!(sweep(&lower).with_limit(limit(0.1)).err(), Some(ConditionError::Section));
    let wrong = sweep(&whole).with_limit(limit(-1.0));
    assert_eq!(wrong.err(), Some(ConditionError::Length(-1.0)));
    assert_eq!(sweep(&whole).with_limit(limit(0.1)).unwrap().limit(), Some(&limit(0.1)));

    let progress = Progress::default();
    let index = ConditioningIndex::of(&sweep(&lower), 0.1, &progress);
    assert_eq!(index, Err(ConditionError::Section));
    let limited = sweep(&whole).with_limit(limit(0.1)).unwrap();
    let lengths = ConditionError::Lengths { index: 0.2, limit: 0.1 };
    assert_eq!(ConditioningIndex::of(&limited, 0.2, &progress), Err(lengths));
    progress.cancel();
    let index = ConditioningIndex::of(&limited, 0.1, &progress);
    assert!(matches!(index, Err(ConditionError::Cancelled(_))), "{index:?}");
}

#[test]
fn what_does_not_fit_is_refused() {
    let manipulator = manipulator();
    let visits = |count| {
        let grid = Grid::new(&manipulator, vec![Axis::new("x", -0.1, 0.1, count)]).unwrap();
        Visits::new(&Sweep::new(&manipulator, &grid, Modes::Any), &Progress::default()).unwrap()
    };
    let (mut three, five) = (visits(3), visits(5));
    let before = three.clone();
    assert_eq!(three.merge(&five), Err(OtherGrid));
    assert_eq!(three, before);
    assert_eq!(three.merge(&before), Ok(()));
    assert_eq!(three.counts().iter().sum::<u64>(), 2 * before.counts().iter().sum::<u64>());

    let axis = Axis::new("x", 0.0, 1.0, 3);
    let error = MaskError { found: 8, expected: 9 };
    assert_eq!(mask_boundary(&axis, &axis, &[true; 8]), Err(error));
    assert_eq!(mask_boundary(&axis, &axis, &[true; 9]).unwrap().len(), 1);

    let ranges = [CoordinateRange::new("x", -0.1, 0.1)];
    let domain = Domain::new(&manipulator, Sections::Whole, &ranges).unwrap();
    let error = DomainError::Shares { found: 2, expected: 1 };
    assert_eq!(domain.pose(&[0.5, 0.5]), Err(error));
    assert_eq!(domain.pose(&[1.0]).unwrap()[0], 0.1);

    let mut search = Search::new(&domain, Goal::default());
    assert_eq!(search.round().map(<[_]>::len), Some(1));
    assert_eq!(search.answer(vec![]), Err(WrongAnswer { found: 0, expected: 1 }));
}
