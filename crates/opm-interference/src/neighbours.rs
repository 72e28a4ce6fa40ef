//! Which members meet by construction, and so are not tested against each other.
//!
//! Two members are neighbours if they meet in one point at every pose. These are
//!
//! * the two bodies of a joint;
//! * all bodies of joints whose centres are one point of a common body: two legs with balls at one point of the platform,
//!   coaxial joints at one point, a slider and the joint that it carries;
//! * a guide, and what is carried at the centre of its slider.
//!
//! The centre of a joint is fixed in both of its bodies; that of a slider only in the body on the platform side.

use crate::member::{Member, MemberKind};
use opm_core::mechanism::Mechanism;
use opm_core::skeleton::{Seat, SeatMotion, Skeleton};

/// Centres closer than this, as a share of the mechanism's size, are one point.
const ONE_POINT: f64 = 1e-6;

/// The points in which members meet.
#[derive(Clone, Debug)]
pub(crate) struct Meetings {
    /// For every point, the bodies and the guides that meet there, sorted.
    points: Vec<Vec<MemberOfPoint>>,
}

/// What meets in a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum MemberOfPoint {
    Body(usize),
    Guide(usize),
}

impl Meetings {
    pub fn new(mechanism: &Mechanism, skeleton: &Skeleton) -> Self {
        let bodies = skeleton.bodies();
        let near = ONE_POINT * skeleton.size();
        // Joints have the numbers in which they come, leg by leg.
        let starts: Vec<usize> = mechanism
            .legs
            .iter()
            .scan(0, |next, leg| Some(std::mem::replace(next, *next + leg.joints.len())))
            .collect();
        let count = mechanism.joints().count();
        let mut group: Vec<usize> = (0..count).collect();
        let mut join = |one: usize, other: usize| {
            let (from, to) = (group[one].max(group[other]), group[one].min(group[other]));
            group.iter_mut().filter(|g| **g == from).for_each(|g| *g = to);
        };
        for seats in seats(mechanism, skeleton, &starts) {
            let fixed: Vec<_> = seats.iter().filter(|seat| seat.fixed).collect();
            for (i, one) in fixed.iter().enumerate() {
                for other in &fixed[..i] {
                    if (one.seat.centre - other.seat.centre).norm() <= near {
                        join(one.joint, other.joint);
                    }
                }
            }
        }
        let mut points = vec![Vec::new(); count];
        let platform = bodies.len() - 1;
        let mut body = 0;
        for (leg, (joints, start)) in mechanism.legs.iter().zip(&starts).enumerate() {
            let count = joints.joints.len();
            for joint in 0..count {
                let inner =
                    if joint == 0 { MemberOfPoint::Guide(leg) } else { MemberOfPoint::Body(body) };
                let outer = if joint + 1 == count {
                    platform
                } else {
                    body += 1;
                    body
                };
                points[group[start + joint]].extend([inner, MemberOfPoint::Body(outer)]);
            }
        }
        points.retain(|members| !members.is_empty());
        points.iter_mut().for_each(|members| members.sort_unstable());
        Self { points }
    }

    /// Whether two members meet in a point.
    pub fn meet(&self, one: &Member, other: &Member) -> bool {
        let of = |member: &Member| match member.kind {
            MemberKind::Body(body) => Some(MemberOfPoint::Body(body)),
            MemberKind::Guide(leg) => Some(MemberOfPoint::Guide(leg)),
            MemberKind::Obstacle(_) => None,
        };
        let (Some(one), Some(other)) = (of(one), of(other)) else { return false };
        let has = |members: &[MemberOfPoint], member| members.binary_search(&member).is_ok();
        self.points.iter().any(|members| has(members, one) && has(members, other))
    }
}

/// A joint of a body.
struct BodySeat<'a> {
    seat: &'a Seat,
    /// The number of the joint.
    joint: usize,
    /// Whether the joint's centre is fixed in the body.
    fixed: bool,
}

/// The joints of every body.
fn seats<'a>(
    mechanism: &Mechanism,
    skeleton: &'a Skeleton,
    starts: &[usize],
) -> Vec<Vec<BodySeat<'a>>> {
    let bodies = skeleton.bodies();
    let still = |seat: &Seat| seat.motion != SeatMotion::Slide;
    let base = bodies[0].seats.iter().zip(starts);
    let mut all: Vec<Vec<_>> =
        vec![base.map(|(seat, &joint)| BodySeat { seat, joint, fixed: still(seat) }).collect()];
    let mut body = 0;
    for (leg, &start) in mechanism.legs.iter().zip(starts) {
        for joint in 0..leg.joints.len().saturating_sub(1) {
            body += 1;
            let of_link = bodies[body].seats.iter().enumerate().map(|(side, seat)| {
                let fixed = side == 0 || still(seat);
                BodySeat { seat, joint: start + joint + side, fixed }
            });
            all.push(of_link.collect());
        }
    }
    let last = mechanism.legs.iter().zip(starts).map(|(leg, start)| start + leg.joints.len() - 1);
    let platform = bodies[bodies.len() - 1].seats.iter().zip(last);
    all.push(platform.map(|(seat, joint)| BodySeat { seat, joint, fixed: true }).collect());
    all
}
