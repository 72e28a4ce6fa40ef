//! The assemblies for many rows of joint values, as arrays and as lists.

use super::{Assembly, Found};
use crate::columns::tabled;
use crate::manipulator::Manipulator;
use crate::pickle::{frozen, pickled};
use crate::rows::Rows;
use numpy::{Element, IntoPyArray, PyArrayDyn, PyUntypedArrayMethods};
use opm_core::forward as core;
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::{PyIterator, PyList};

/// Every assembly for each row of actuated joint values: arrays, and a sequence of lists of :class:`Assembly`.
///
/// The arrays have an axis for the assemblies of a row, sorted, with ``m`` places: as many as the row with the most. Places
/// beyond a row's `counts` are NaN. The arrays begin with the axes of
/// the rows. For one row alone it is a sequence of assemblies; along several axes, one of such objects.
#[pyclass(frozen, get_all, module = "opm_kinematics")]
pub struct Assemblies {
    /// (...): number of assemblies of each row.
    counts: Py<PyArrayDyn<i64>>,
    /// (...): whether all assemblies of a row are known; see :meth:`Manipulator.forward`. Newton's method does not tell.
    complete: Py<PyArrayDyn<bool>>,
    /// (..., m, d): task coordinates, metres and radians.
    poses: Py<PyArrayDyn<f64>>,
    /// (..., m, 4, 4): homogeneous matrices of the platform, as :meth:`Manipulator.transform` gives them, metres.
    transforms: Py<PyArrayDyn<f64>>,
    /// (..., m, k): every joint coordinate, metres and radians.
    joints: Py<PyArrayDyn<f64>>,
    /// (..., m, j): every imaginary joint, metres and radians.
    imaginary: Py<PyArrayDyn<f64>>,
    /// (..., m): whether all joints are within their limits.
    within_limits: Py<PyArrayDyn<bool>>,
    /// (..., m), no unit: closure error of the legs: radians, and lengths divided by the mechanism's size.
    residuals: Py<PyArrayDyn<f64>>,
    /// (..., m), no unit: within this of an assembly is one exact one that is none of those before it; NaN where that is not proven,
    /// or was not asked for (`certify`).
    radii: Py<PyArrayDyn<f64>>,
    /// The working modes of the assemblies: a list for each row; a list of modes for one row alone.
    modes: Py<PyList>,
    /// Names along the last axis of `joints`.
    joint_names: Vec<String>,
    /// Names along the last axis of `imaginary`.
    imaginary_names: Vec<String>,
    /// Names of the task coordinates.
    pose_names: Vec<String>,
}

tabled!(Assemblies);

pickled!(Assemblies {
    counts,
    complete,
    poses,
    transforms,
    joints,
    imaginary,
    within_limits,
    residuals,
    radii,
    modes,
    joint_names,
    imaginary_names,
    pose_names
});

/// The lists of all rows, as lists of lists along these axes.
fn nested<'py>(
    py: Python<'py>,
    lead: &[usize],
    mut lists: Vec<Bound<'py, PyList>>,
) -> PyResult<Bound<'py, PyList>> {
    for (axis, &length) in lead.iter().enumerate().rev() {
        // Without entries there are no lists to be put together.
        let count: usize = lead[..axis].iter().product();
        let lists_of = |part: usize| PyList::new(py, &lists[part * length..][..length]);
        lists = (0..count).map(lists_of).collect::<PyResult<_>>()?;
    }
    Ok(lists.pop().unwrap_or_else(|| PyList::empty(py)))
}

impl Assemblies {
    /// The assemblies of every row.
    pub fn new(
        py: Python<'_>,
        manipulator: &Manipulator,
        rows: &Rows<'_>,
        found: &[Found],
    ) -> PyResult<Self> {
        let inner = &manipulator.inner;
        let most = found.iter().map(|row| row.list.len()).max().unwrap_or(0);
        let table = |width: usize, of: &dyn Fn(&core::Assembly, &mut Vec<f64>)| {
            let mut table = Vec::with_capacity(found.len() * most * width);
            for (row, Found { list, .. }) in found.iter().enumerate() {
                list.iter().for_each(|assembly| of(assembly, &mut table));
                table.resize((row + 1) * most * width, f64::NAN);
            }
            table.into_pyarray(py)
        };
        let [d, k, j] =
            [inner.task_coordinates().len(), inner.coordinates().len(), inner.imaginary().len()];
        let poses = table(d, &|assembly, to| to.extend(&assembly.pose));
        let joints = table(k, &|assembly, to| to.extend(&assembly.joints));
        let imaginary = table(j, &|assembly, to| to.extend(&assembly.imaginary));
        let residuals = table(1, &|assembly, to| to.push(assembly.residual));
        let mut radii = Vec::with_capacity(found.len() * most);
        for (row, Found { proofs, .. }) in found.iter().enumerate() {
            let proven = |proof: Option<&core::Proof>| match proof {
                Some(proof) if proof.distinct => proof.radius,
                _ => f64::NAN,
            };
            radii.extend(proofs.iter().map(|certificate| proven(certificate.proof())));
            radii.resize((row + 1) * most, f64::NAN);
        }
        let radii = radii.into_pyarray(py);
        let transforms = table(16, &|assembly, to| {
            let platform = inner.platform_at(&inner.displacement_of(assembly));
            to.extend(platform.to_homogeneous().transpose().iter());
        });
        let mut within = Vec::with_capacity(found.len() * most);
        let mut modes = Vec::with_capacity(found.len());
        for (row, Found { list, .. }) in found.iter().enumerate() {
            within.extend(list.iter().map(|assembly| assembly.within_limits));
            within.resize((row + 1) * most, false);
            let signs = list.iter().map(|assembly| inner.format_mode(assembly.mode));
            modes.push(PyList::new(py, signs)?);
        }
        let counts: Vec<i64> = found.iter().map(|row| row.list.len() as i64).collect();
        let complete: Vec<bool> = found.iter().map(|row| row.complete).collect();
        let modes = nested(py, rows.lead, modes)?;
        Ok(Self {
            counts: rows.frozen(&counts.into_pyarray(py), &[])?,
            complete: rows.frozen(&complete.into_pyarray(py), &[])?,
            poses: rows.frozen(&poses, &[most, d])?,
            transforms: rows.frozen(&transforms, &[most, 4, 4])?,
            joints: rows.frozen(&joints, &[most, k])?,
            imaginary: rows.frozen(&imaginary, &[most, j])?,
            within_limits: rows.frozen(&within.into_pyarray(py), &[most])?,
            residuals: rows.frozen(&residuals, &[most])?,
            radii: rows.frozen(&radii, &[most])?,
            modes: modes.unbind(),
            joint_names: manipulator.joint_names(),
            imaginary_names: manipulator.imaginary_names(),
            pose_names: manipulator.pose_names().into_iter().map(str::to_owned).collect(),
        })
    }

    /// The assembly at a place of all arrays: the row and its number there, or its number alone.
    fn assembly(&self, py: Python<'_>, place: &[usize]) -> PyResult<Assembly> {
        fn part<'py, T: Element>(
            py: Python<'py>,
            array: &Py<PyArrayDyn<T>>,
            place: &[usize],
        ) -> PyResult<Bound<'py, PyAny>> {
            place.iter().try_fold(array.bind(py).clone().into_any(), |of, at| of.get_item(at))
        }
        let mode = place
            .iter()
            .try_fold(self.modes.bind(py).clone().into_any(), |of, at| of.get_item(at))?;
        let vector = |array| -> PyResult<_> { frozen(part(py, array, place)?.cast_into()?) };
        Ok(Assembly {
            pose: vector(&self.poses)?,
            mode: mode.extract()?,
            joints: vector(&self.joints)?,
            imaginary: vector(&self.imaginary)?,
            within_limits: part(py, &self.within_limits, place)?.is_truthy()?,
            residual: part(py, &self.residuals, place)?.extract()?,
            radius: part(py, &self.radii, place)?
                .extract()
                .map(|radius: f64| (!radius.is_nan()).then_some(radius))?,
        })
    }

    /// Whether it is of one row alone.
    /// The assemblies for one entry of the first axis of several.
    fn part(&self, py: Python<'_>, at: usize) -> PyResult<Self> {
        fn of<T: Element>(
            py: Python<'_>,
            array: &Py<PyArrayDyn<T>>,
            at: usize,
        ) -> PyResult<Py<PyArrayDyn<T>>> {
            Ok(array.bind(py).get_item(at)?.cast_into()?.unbind())
        }
        Ok(Self {
            counts: of(py, &self.counts, at)?,
            complete: of(py, &self.complete, at)?,
            poses: of(py, &self.poses, at)?,
            transforms: of(py, &self.transforms, at)?,
            joints: of(py, &self.joints, at)?,
            imaginary: of(py, &self.imaginary, at)?,
            within_limits: of(py, &self.within_limits, at)?,
            residuals: of(py, &self.residuals, at)?,
            radii: of(py, &self.radii, at)?,
            modes: self.modes.bind(py).get_item(at)?.cast_into()?.unbind(),
            joint_names: self.joint_names.clone(),
            imaginary_names: self.imaginary_names.clone(),
            pose_names: self.pose_names.clone(),
        })
    }
}

#[pymethods]
impl Assemblies {
    fn __len__(&self, py: Python<'_>) -> usize {
        self.modes.bind(py).len()
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        let items = (0..self.__len__(py)).map(|at| self.__getitem__(py, at.cast_signed()));
        PyList::new(py, items.collect::<PyResult<Vec<_>>>()?)?.try_iter()
    }

    /// The assemblies of one row, a list; of one row alone, one assembly.
    fn __getitem__<'py>(&self, py: Python<'py>, number: isize) -> PyResult<Bound<'py, PyAny>> {
        let modes = self.modes.bind(py);
        let length = modes.len();
        let place = if number < 0 { number.checked_add_unsigned(length) } else { Some(number) };
        let place = place.and_then(|place| usize::try_from(place).ok()).filter(|&at| at < length);
        let place = place.ok_or_else(|| {
            PyIndexError::new_err(format!("{number} is not an index of {length} entries"))
        })?;
        match self.counts.bind(py).ndim() {
            0 => return Ok(Bound::new(py, self.assembly(py, &[place])?)?.into_any()),
            1 => {}
            _ => return Ok(Bound::new(py, self.part(py, place)?)?.into_any()),
        }
        let count = modes.get_item(place)?.len()?;
        let list = (0..count).map(|at| self.assembly(py, &[place, at]));
        Ok(PyList::new(py, list.collect::<PyResult<Vec<_>>>()?)?.into_any())
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let total: usize = self.counts.bind(py).call_method0("sum")?.extract()?;
        let rows: usize = self.counts.bind(py).getattr("size")?.extract()?;
        let plural = if rows == 1 { "" } else { "s" };
        Ok(format!("<Assemblies of {rows} row{plural}: {total} assemblies>"))
    }
}
