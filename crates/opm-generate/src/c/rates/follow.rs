//! The rates of coordinates that follow from others, where legs constrain the platform.

use crate::c::Writer;
use crate::c::interface::RETURN;
use opm_core::numeric::Quantity;

impl Writer<'_> {
    /// The coordinates that are given, and those that follow.
    fn own_and_follow(&self) -> [Vec<usize>; 2] {
        let own = self.forms.independent.clone();
        let follow = (0..self.task.coordinates.len()).filter(|i| !own.contains(i)).collect();
        [own, follow]
    }

    /// How many rates there are of the coordinates that follow by those that are given.
    pub fn follow_rates(&self) -> usize {
        let [own, follow] = self.own_and_follow();
        (own.len() * follow.len()).max(1)
    }

    /// Statements that give `follow`, the rates of the coordinates that follow at which no joint moves that a leg lacks.
    pub fn eliminated(&self, lacking: usize) -> String {
        let count = self.task.coordinates.len();
        let [own, follow] = self.own_and_follow();
        let (sides, unknowns) = (own.len(), follow.len());
        let width = sides + unknowns;
        let units: Vec<&str> = follow
            .iter()
            .map(|&i| match self.task.coordinates[i].quantity {
                Quantity::Angle => "1",
                Quantity::Length => "g->size",
            })
            .collect();
        format!(
            "    {{\n        const int given[{0}] = {{ {1} }}, sought[{unknowns}] = {{ {2} }};\n        \
             const real unit[{unknowns}] = {{ {3} }};\n        \
             real a[{4}];\n        int i, j;\n        \
             for (i = 0; i < {lacking}; ++i) {{\n            \
             for (j = 0; j < {unknowns}; ++j) {{\n                \
             a[i * {width} + j] = locked[i * {count} + sought[j]] * unit[j];\n            }}\n            \
             for (j = 0; j < {sides}; ++j) {{\n                \
             a[i * {width} + {unknowns} + j] = -locked[i * {count} + given[j]];\n            }}\n        }}\n        \
             if (NAME_eliminate(a, {lacking}, {unknowns}, {sides}, follow)) {{\n            \
             return 2 * NAME_LEGS + 1;\n        }}\n        \
             for (i = 0; i < {unknowns}; ++i) {{\n            \
             for (j = 0; j < {sides}; ++j) {{\n                \
             follow[i * {sides} + j] *= unit[i];\n            }}\n        }}\n    }}\n",
            sides.max(1),
            listed(&own),
            listed(&follow),
            units.join(", "),
            lacking * width,
        )
    }

    /// The Jacobian where coordinates follow, with the functions that it shares with the twist: the rates by all coordinates,
    /// and their sums for those that are given.
    pub fn of_independent(&self, head: &str, body: &str) -> String {
        let count = self.task.coordinates.len();
        let [own, follow] = self.own_and_follow();
        let (sides, unknowns) = (own.len(), follow.len());
        format!(
            "/* The rates of all joints by all coordinates, and those of the coordinates that follow by the others. It returns what\n   \
             NAME_jacobian returns. */\n\
             static int NAME_differentiate(const NAME_geometry *g, const real pose[], unsigned mode, real all[], real follow[])\n\
             {{\n{body}}}\n\n\
             /* Rates by the coordinates of a pose, from rows of those by all coordinates. */\n\
             static void NAME_by_pose(const real all[], int rows, const real follow[], real by_pose[])\n\
             {{\n    const int given[{0}] = {{ {1} }}, sought[{unknowns}] = {{ {2} }};\n    int i, j, k;\n    \
             for (i = 0; i < rows; ++i) {{\n        \
             for (j = 0; j < {sides}; ++j) {{\n            \
             by_pose[i * {sides} + j] = all[i * {count} + given[j]];\n            \
             for (k = 0; k < {unknowns}; ++k) {{\n                \
             by_pose[i * {sides} + j] += all[i * {count} + sought[k]] * follow[k * {sides} + j];\n            \
             }}\n        }}\n    }}\n}}\n\n\
             {head}{{\n    real all[{3}], follow[{4}];\n    \
             const int status = NAME_differentiate(g, pose, mode, all, follow);\n{RETURN}    \
             NAME_by_pose(all, NAME_JOINTS, follow, jacobian);\n    return 0;\n}}\n\n",
            sides.max(1),
            listed(&own),
            listed(&follow),
            self.fields.len() * count,
            self.follow_rates(),
        )
    }
}

/// Numbers as the elements of an array, which has at least one.
fn listed(numbers: &[usize]) -> String {
    let each: Vec<String> = numbers.iter().map(usize::to_string).collect();
    if each.is_empty() { "0".to_owned() } else { each.join(", ") }
}
