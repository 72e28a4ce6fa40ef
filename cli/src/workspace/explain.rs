//! What rejects the poses of a workspace, for printing.

use crate::text::{self, Table, count, short};
use opm_core::Quantity;
use opm_core::manipulator::part_of;
use opm_core::mechanism::file::FileUnits;
use opm_core::mechanism::joint::Joint;
use opm_core::mechanism::{Cone, JointDifference};
use opm_study::Workspace;
use opm_workspace::{Cause, Rejection, Rejections};
use serde_json::{Value, json};

pub struct Report<'a> {
    pub workspace: &'a Workspace,
    pub found: &'a Rejections,
}

impl Report<'_> {
    fn leg(&self, rejection: &Rejection) -> &str {
        &self.workspace.manipulator().mechanism().legs[rejection.leg].name
    }

    /// The limit that a cause is about, SI.
    fn limit(&self, cause: Cause) -> Option<f64> {
        let (joint, end) = match cause {
            Cause::Reach(_) => return None,
            Cause::Lowest(joint) => (joint, 0),
            Cause::Highest(joint) => (joint, 1),
            Cause::Cone(joint) => return self.cone(joint).map(|(_, cone)| cone.half_angle),
            // There are two.
            Cause::Difference(_) => return None,
        };
        Some(self.workspace.manipulator().coordinates()[joint].limits?[end])
    }

    fn difference(&self, number: usize) -> &JointDifference {
        &self.workspace.manipulator().differences()[number]
    }

    /// The joint with a cone that has a first coordinate.
    fn cone(&self, first: usize) -> Option<(&Joint, Cone)> {
        let joint = self.workspace.manipulator().mechanism().joint_from(first)?;
        Some((joint, joint.cone?))
    }

    pub fn json(&self) -> Value {
        let coordinates = self.workspace.manipulator().coordinates();
        let causes: Vec<Value> = (self.found.rejections.iter())
            .map(|rejection| {
                let (section, joint, limit) = match rejection.cause {
                    Cause::Reach(section) => {
                        (section.map(|section| section.to_string()), None, None)
                    }
                    Cause::Lowest(joint) => (None, Some(&*coordinates[joint].name), Some("lowest")),
                    Cause::Highest(joint) => {
                        (None, Some(&*coordinates[joint].name), Some("highest"))
                    }
                    Cause::Difference(number) => {
                        (None, Some(&*self.difference(number).name), Some("difference"))
                    }
                    Cause::Cone(joint) => {
                        (None, self.cone(joint).map(|(joint, _)| &*joint.name), Some("cone"))
                    }
                };
                json!({
                    "leg": self.leg(rejection),
                    "section": section,
                    "joint": joint,
                    "limit": limit,
                    "value": self.limit(rejection.cause),
                    "alone": rejection.alone,
                    "with_others": rejection.with_others,
                })
            })
            .collect();
        let Rejections { poses, reachable, .. } = self.found;
        json!({ "poses": poses, "reachable": reachable, "causes": causes })
    }

    pub fn text(&self, units: FileUnits) -> String {
        let Rejections { poses, reachable, rejections } = self.found;
        let rejected = poses - reachable;
        let all = format!("\n{} of {} poses are rejected\n", count(rejected), count(*poses));
        if rejected == 0 {
            return all;
        }
        let coordinates = self.workspace.manipulator().coordinates();
        let mut table = Table::new(["leg", "rejects", ">alone", ">", ">with others", ">"]);
        for rejection in rejections {
            let what = match rejection.cause {
                Cause::Reach(section) => format!("{} out of reach", part_of(section)),
                Cause::Cone(joint) => {
                    let name = self.cone(joint).map_or("", |(joint, _)| &joint.name);
                    let limit = self.limit(rejection.cause).unwrap_or(f64::NAN);
                    let limit = text::number(limit, Quantity::Angle, units);
                    format!("{name} beyond its cone of {limit} {}", units.symbol(Quantity::Angle))
                }
                Cause::Difference(number) => {
                    let JointDifference { name, limits, quantity, .. } = self.difference(number);
                    format!("{name} beyond its limits {}", text::range(*limits, *quantity, units))
                }
                Cause::Lowest(joint) | Cause::Highest(joint) => {
                    let coordinate = &coordinates[joint];
                    let past = match rejection.cause {
                        Cause::Lowest(_) => "below",
                        _ => "above",
                    };
                    let limit = self.limit(rejection.cause).unwrap_or(f64::NAN);
                    let limit = text::number(limit, coordinate.quantity, units);
                    format!(
                        "{} {past} {limit} {}",
                        coordinate.name,
                        units.symbol(coordinate.quantity)
                    )
                }
            };
            let share = |poses: u64| format!("{} %", short(100.0 * poses as f64 / rejected as f64));
            let Rejection { alone, with_others, .. } = *rejection;
            table.row([
                self.leg(rejection).to_owned(),
                what,
                count(alone),
                share(alone),
                count(with_others),
                share(with_others),
            ]);
        }
        format!("{all}\n{table}")
    }
}
