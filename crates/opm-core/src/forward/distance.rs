//! Where the platform is in an assembly, the distance between two poses of it, and assemblies in that order.

use super::Assembly;
use super::accept::APART;
use crate::manipulator::{Manipulator, Mode};
use nalgebra::Isometry3;

impl Manipulator {
    /// All task coordinates of an assembly.
    fn all_of(&self, assembly: &Assembly) -> Vec<f64> {
        let Some(dependent) = &self.dependent else { return assembly.pose.clone() };
        let mut all = vec![0.0; self.task().coordinates.len()];
        dependent.merge([&assembly.pose, &assembly.dependent], &mut all);
        all
    }

    /// The platform's displacement from home in an assembly, base coordinates: that of its pose, dependent coordinates too.
    pub fn displacement_of(&self, assembly: &Assembly) -> Isometry3<f64> {
        self.task().displacement(&self.all_of(assembly))
    }

    /// The same assembly with the coordinates that it has in another working mode; `None` where it is none of that mode.
    ///
    /// Where coordinates are dependent, two triples of angles may give one orientation, and the others may follow from each
    /// in modes of its own: one pose of the platform, and one set of joints, then has a name in each of these modes. Other joints
    /// than the actuated ones, as those of a leg without a motor, may have several values with the same actuated ones.
    pub fn assembly_in(&self, assembly: &Assembly, mode: Mode) -> Option<Assembly> {
        if assembly.mode == mode {
            return Some(assembly.clone());
        }
        let (mut all, mut pose, mut solution) =
            (self.all_of(assembly), Vec::new(), self.solution());
        let place = self.task().displacement(&all);
        self.write_independent(Some(mode), &mut all, &mut pose);
        let solution = self.inverse(&pose, mode, &mut solution).ok()??;
        let actuated = || self.actuated().iter().copied();
        let wanted: Vec<f64> =
            actuated().map(|c| assembly.joints[c] - self.coordinates()[c].home).collect();
        let modulo = self.modulo_revolutions();
        let errors = actuated().zip(&wanted).zip(&modulo).map(|((c, wanted), &modulo)| {
            self.actuated_error(c, solution.joints()[c], *wanted, modulo)
        });
        let same = self.apart(&solution.displacement(self), &place) <= APART
            && errors.fold(0.0, f64::max) <= APART;
        let mut buffer = self.closure.buffer();
        same.then(|| self.assembly_of((&pose, mode), solution, &wanted, &mut buffer)).flatten()
    }

    /// Keeps the assemblies of one working mode, with the coordinates that they have in it:
    /// [`Manipulator::assembly_in`].
    pub fn keep_assemblies_in(&self, list: &mut Vec<Assembly>, mode: Mode) {
        let mut kept: Vec<Assembly> = Vec::with_capacity(list.len());
        for assembly in list.iter().filter_map(|assembly| self.assembly_in(assembly, mode)) {
            // Several may differ in nothing but the joints of legs without a motor.
            let off = |known: &Assembly| {
                let joints = known.joints.iter().zip(&assembly.joints);
                joints.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
            };
            if !kept.iter().any(|known| off(known) <= APART) {
                kept.push(assembly);
            }
        }
        *list = kept;
    }

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
            let place = self.platform_at(&self.displacement_of(&assembly));
            (self.platform_distance(seed, &place), assembly)
        });
        let mut measured: Vec<(f64, Assembly)> = measured.collect();
        measured.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        list.extend(measured.into_iter().map(|(_, assembly)| assembly));
    }
}
