//! The indices and the efforts of a sample of a motion, as columns.

use crate::motion::MotionRequest;
use opm_analysis::{Index, Indices, Setup};
use opm_core::manipulator::{Manipulator, Solution};
use opm_core::mechanism::joint::DriveLimit;

/// All indices that a mechanism has in a setup and, with a load, the efforts of its joints.
pub struct Judged<'a> {
    indices: Indices<'a>,
    /// Names and units.
    columns: Vec<(String, &'static str)>,
    values: Vec<f64>,
}

impl<'a> Judged<'a> {
    /// What a request asks for; nothing without a setup. Efforts in motion take the place of those at rest.
    pub fn of(request: &MotionRequest<'a>) -> Option<Self> {
        let at_rest = request.efforts.is_none();
        request.indices.and_then(|setup| Self::new(request.manipulator, setup, at_rest))
    }

    fn new(manipulator: &'a Manipulator, setup: &Setup, efforts: bool) -> Option<Self> {
        let known = Index::known(manipulator, setup);
        let named = known.iter().map(|index| (index.name().to_owned(), index.facts().unit));
        let mut columns: Vec<(String, &'static str)> = named.collect();
        let mut indices = Indices::new(manipulator, setup, known).ok()?;
        if efforts && setup.has_load() {
            indices = indices.with_efforts(setup);
            let all = manipulator.coordinates();
            let actuated = manipulator.actuated().iter().map(|&number| all[number].quantity);
            let imaginary = manipulator.imaginary().iter().map(|joint| joint.quantity);
            let units = actuated.chain(imaginary).map(|quantity| DriveLimit::Effort.unit(quantity));
            columns.extend(crate::columns::efforts(manipulator).zip(units));
        }
        let values = vec![f64::NAN; columns.len()];
        Some(Self { indices, columns, values })
    }

    /// Names and units of the columns.
    pub fn columns(&self) -> impl Iterator<Item = (&str, &'static str)> {
        self.columns.iter().map(|(name, unit)| (&**name, *unit))
    }

    /// The values at a solution; not numbers without one.
    pub fn values(&mut self, at: Option<&Solution>) -> &[f64] {
        self.values.fill(f64::NAN);
        if let Some(at) = at {
            let (values, rest) = self.values.split_at_mut(self.indices.indices().len());
            values.copy_from_slice(self.indices.evaluate(at));
            rest.copy_from_slice(self.indices.efforts());
        }
        &self.values
    }
}
