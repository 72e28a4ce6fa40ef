//! The largest errors over many poses, and where they are.

use crate::budget::Budget;

/// The largest value of something, and the pose that has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Largest {
    /// The value, radians or metres; negative if there is no pose.
    pub value: f64,
    /// The pose; empty if there is none.
    pub pose: Vec<f64>,
    /// At how many poses it is not determined.
    pub unknown: u64,
}

impl Largest {
    fn none() -> Self {
        Self { value: -1.0, pose: Vec::new(), unknown: 0 }
    }

    /// Takes a value if it is larger; of equal values the first stays.
    fn take(&mut self, value: f64, pose: &[f64]) {
        if value > self.value {
            (self.value, self.pose) = (value, pose.to_vec());
        }
        self.unknown += u64::from(value.is_nan());
    }
}

/// The largest worst cases of many poses.
#[derive(Clone, Debug, PartialEq)]
pub struct Worst {
    /// How many poses were added.
    pub poses: u64,
    /// How many of these the actuators do not hold.
    pub loose: u64,
    /// Of each task coordinate, radians and metres.
    pub coordinates: Vec<Largest>,
    /// Of the displacement of the platform's reference point, metres.
    pub length: Largest,
    /// Of the platform's rotation, radians.
    pub angle: Largest,
    /// Of the play of each joint, leg by leg: a length, metres, and an angle, radians.
    pub misfit: Vec<[Largest; 2]>,
}

impl Worst {
    /// Of no pose, for this number of task coordinates and of joints.
    pub fn new(coordinates: usize, joints: usize) -> Self {
        Self {
            poses: 0,
            loose: 0,
            coordinates: vec![Largest::none(); coordinates],
            length: Largest::none(),
            angle: Largest::none(),
            misfit: vec![[Largest::none(), Largest::none()]; joints],
        }
    }

    /// Adds the errors at a pose. Where the actuators do not hold the platform, its error is not bounded, and only the
    /// misfits count.
    pub fn add(&mut self, budget: &Budget, pose: &[f64]) {
        self.poses += 1;
        if budget.length.worst.is_nan() {
            self.loose += 1;
        } else {
            for (own, spread) in self.coordinates.iter_mut().zip(&budget.coordinates) {
                own.take(spread.worst, pose);
            }
            self.length.take(budget.length.worst, pose);
            self.angle.take(budget.angle.worst, pose);
        }
        for ([length, angle], play) in self.misfit.iter_mut().zip(&budget.misfit) {
            length.take(play.length.worst, pose);
            angle.take(play.angle.worst, pose);
        }
    }

    /// Adds poses that come after these.
    pub fn merge(&mut self, after: &Self) {
        self.poses += after.poses;
        self.loose += after.loose;
        let own = self.coordinates.iter_mut().chain([&mut self.length, &mut self.angle]);
        let own = own.chain(self.misfit.iter_mut().flatten());
        let others = after.coordinates.iter().chain([&after.length, &after.angle]);
        for (own, other) in own.zip(others.chain(after.misfit.iter().flatten())) {
            own.take(other.value, &other.pose);
            own.unknown += other.unknown;
        }
    }
}
