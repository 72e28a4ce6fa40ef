//! The distance between two poses of the platform, and assemblies in its order.

use super::Assembly;
use crate::manipulator::Manipulator;
use nalgebra::Isometry3;

impl Manipulator {
    /// How far two poses of the platform in SE(3) are apart ([`Manipulator::platform_pose`]): the angle between their
    /// orientations, in radians, plus the distance of their reference points over the mechanism's size. The
    /// residual of an assembly is measured in the same way. Task coordinates are not compared: many mechanisms have
    /// singular Euler angles at home, and there different angles give the same orientation.
    pub fn platform_distance(&self, from: &Isometry3<f64>, to: &Isometry3<f64>) -> f64 {
        let way = to.translation.vector - from.translation.vector;
        from.rotation.angle_to(&to.rotation) + way.norm() / self.closure.size
    }

    /// Sorts assemblies by their [distance](Self::platform_distance) from one pose of the platform, the nearest first.
    /// Equal distances stay in their order.
    pub fn sort_assemblies(&self, list: &mut Vec<Assembly>, seed: &Isometry3<f64>) {
        let measured = list.drain(..).map(|assembly| {
            let place = self.displacement_in(&assembly.pose, assembly.mode);
            let place = place.map(|displacement| self.platform_at(&displacement));
            (place.map_or(f64::INFINITY, |place| self.platform_distance(seed, &place)), assembly)
        });
        let mut measured: Vec<(f64, Assembly)> = measured.collect();
        measured.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        list.extend(measured.into_iter().map(|(_, assembly)| assembly));
    }
}
