//! A motion's columns while it is followed.

use super::{Contact, Source, Trajectory, Violation};
use crate::error::failed;
use crate::pickle::frozen;
use crate::rows::no_memory;
use crate::solutions::units;
use numpy::{IntoPyArray, PyArray2, PyArrayMethods};
use opm_core::manipulator as core;
use opm_core::trajectory::{self as core_trajectory, Change, Sample};
use opm_interference::{Interference, Nearest, Watch};
use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// The columns while they are filled.
#[derive(Default)]
pub(super) struct Record {
    times: Vec<f64>,
    /// Poses, rates and accelerations; of the dependent coordinates; of the joints; of the imaginary joints.
    tables: [Vec<f64>; 12],
    condition: Vec<f64>,
    /// Reachable, within limits, regular.
    answers: [Vec<bool>; 3],
    violations: Vec<core_trajectory::Violation>,
    /// The contacts, and the nearest pair with its time.
    contacts: (Vec<opm_interference::Contact>, Option<(Nearest, f64)>),
}

impl Record {
    pub(super) fn follow(
        manipulator: &core::Manipulator,
        mut followed: core_trajectory::Trajectory<'_>,
        mut watch: Option<(Watch<'_>, f64)>,
        stop: &AtomicBool,
    ) -> PyResult<Self> {
        let mut record = Self::default();
        let samples = followed.samples();
        let width = manipulator.task_coordinates().len()
            + manipulator.dependent_coordinates().len()
            + manipulator.coordinates().len()
            + manipulator.imaginary().len();
        let room = usize::try_from(samples).ok().and_then(|n| n.checked_mul(3 * width));
        // Memory is allocated table by table; this reports early if there is not enough.
        let whole = room.filter(|&room| Vec::<f64>::new().try_reserve_exact(room).is_ok());
        whole.ok_or_else(|| no_memory(format_args!("{samples} samples")))?;
        while !stop.load(Ordering::Relaxed) && followed.advance().map_err(|e| failed(&e))? {
            let sample = followed.sample();
            record.add(sample);
            if let Some((watch, step)) = &mut watch {
                let solution = sample.reached.then_some(&sample.solution);
                watch.advance(sample.time, *step, solution).map_err(|error| failed(&error))?;
            }
            for change in followed.changes() {
                if let Change::Ends(violation) = change {
                    record.violations.push(*violation);
                }
            }
        }
        record.violations.extend(followed.open());
        record.violations.sort_by(|a, b| a.start.total_cmp(&b.start));
        if let Some((watch, _)) = watch {
            record.contacts = watch.finish();
        }
        Ok(record)
    }

    fn add(&mut self, sample: &Sample) {
        let Sample { time, instant, reached, solution, regular, motion, condition, .. } = sample;
        self.times.push(*time);
        self.condition.push(if *reached { *condition } else { f64::NAN });
        let rows: [(&[f64], bool); 12] = [
            (&instant.pose, true),
            (&instant.velocity, true),
            (&instant.acceleration, true),
            (solution.dependent(), *reached),
            (&motion.dependent_rates, *reached && *regular),
            (&motion.dependent_accelerations, *reached && *regular),
            (solution.joints(), *reached),
            (&motion.joint_rates, *reached && *regular),
            (&motion.joint_accelerations, *reached && *regular),
            (solution.imaginary(), *reached),
            (&motion.imaginary_rates, *reached && *regular),
            (&motion.imaginary_accelerations, *reached && *regular),
        ];
        for (table, (row, known)) in self.tables.iter_mut().zip(rows) {
            table.extend(row.iter().map(|&value| if known { value } else { f64::NAN }));
        }
        let answers = [*reached, sample.valid(), *reached && *regular];
        for (list, answer) in self.answers.iter_mut().zip(answers) {
            list.push(answer);
        }
    }

    pub(super) fn finish(
        self,
        py: Python<'_>,
        source: Source,
        interference: Option<&Interference>,
    ) -> PyResult<Trajectory> {
        let manipulator = &*source.manipulator.get().inner;
        let rows = self.times.len();
        let widths = [
            manipulator.task_coordinates().len(),
            manipulator.dependent_coordinates().len(),
            manipulator.coordinates().len(),
            manipulator.imaginary().len(),
        ];
        let mut tables = self.tables.into_iter().enumerate();
        let mut table = || -> PyResult<Py<PyArray2<f64>>> {
            let (number, values) = tables.next().unwrap_or_default();
            frozen(values.into_pyarray(py).reshape([rows, widths[number / 3]])?)
        };
        let [reachable, within_limits, regular] =
            self.answers.map(|answers| frozen(answers.into_pyarray(py)));
        Ok(Trajectory {
            times: frozen(self.times.into_pyarray(py))?,
            poses: table()?,
            pose_rates: table()?,
            pose_accelerations: table()?,
            dependent: table()?,
            dependent_rates: table()?,
            dependent_accelerations: table()?,
            joints: table()?,
            joint_rates: table()?,
            joint_accelerations: table()?,
            imaginary: table()?,
            imaginary_rates: table()?,
            imaginary_accelerations: table()?,
            condition: frozen(self.condition.into_pyarray(py))?,
            reachable: reachable?,
            within_limits: within_limits?,
            regular: regular?,
            violations: self.violations.iter().map(|v| Violation::new(v, manipulator)).collect(),
            contacts: interference
                .map(|of| self.contacts.0.iter().map(|found| Contact::new(found, of)).collect()),
            nearest: interference.zip(self.contacts.1).map(|(of, (nearest, time))| {
                let [one, other] = of.names_of(nearest.pair).map(str::to_owned);
                (one, other, nearest.distance, time)
            }),
            joint_names: manipulator.coordinates().iter().map(|c| c.name.clone()).collect(),
            imaginary_names: manipulator.imaginary().iter().map(|j| j.name.clone()).collect(),
            units: units(manipulator),
            mode: manipulator.format_mode(source.mode),
            name: source.motion.name.clone(),
            rows,
            source,
        })
    }
}
