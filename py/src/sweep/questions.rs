//! What rejects the poses of a workspace, and the largest disc, ball or box in it.

use super::Sweep;
use crate::arguments;
use crate::error::{study, wrong};
use crate::interrupt::{self, few};
use crate::parts::Parts;
use crate::pickle::pickled;
use opm_study::Workspace;
use opm_workspace::{Cause, InscribedShape, Progress};
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::num::NonZeroU64;

/// Poses that are worth a thread.
const POSES: u64 = 4096;

/// One cause that rejects poses of a grid: a leg that does not reach them, or a joint that is past a limit.
#[pyclass(frozen, get_all, module = "opm_kinematics")]
pub struct Rejection {
    /// Name of the leg.
    leg: String,
    /// ``"lower"`` or ``"upper"``, the section that does not close; None for a limit.
    section: Option<String>,
    /// Name of the joint coordinate that is past a limit; None for a leg that does not reach.
    joint: Option<String>,
    /// ``"lowest"`` or ``"highest"``; None for a leg that does not reach.
    limit: Option<String>,
    /// Number of poses that would be reached without it.
    alone: u64,
    /// Number of other poses in whose rejection it takes part.
    with_others: u64,
}

pickled!(Rejection { leg, section, joint, limit, alone, with_others });

#[pymethods]
impl Rejection {
    fn __repr__(&self) -> String {
        let what = match (&self.section, &self.joint, &self.limit) {
            (Some(section), ..) => format!("{section} section of {} out of reach", self.leg),
            (None, joint, limit) => {
                format!(
                    "{} past its {} value",
                    joint.as_deref().unwrap_or(""),
                    limit.as_deref().unwrap_or("")
                )
            }
        };
        format!("<Rejection: {what}, {} alone, {} with others>", self.alone, self.with_others)
    }
}

/// The largest disc, ball or box in a set of points of a grid.
#[pyclass(frozen, get_all, module = "opm_kinematics")]
pub struct Inscribed {
    /// ``"disc"``, ``"ball"`` or ``"box"``.
    shape: String,
    /// The centre by coordinate, radians and metres.
    centre: BTreeMap<String, f64>,
    /// The radius by coordinate, of a box half of each side; radians and metres.
    radii: BTreeMap<String, f64>,
    /// How far the true boundary may be from the cells of the grid: half of a cell's diagonal for a disc or a ball, half a step
    /// along each coordinate for a box.
    error: BTreeMap<String, f64>,
    /// Area or volume, with the units of its coordinates multiplied.
    measure: f64,
    /// Whether it touches the edge of the grid, beyond which the workspace may go on.
    at_edge: bool,
}

pickled!(Inscribed { shape, centre, radii, error, measure, at_edge });

impl Inscribed {
    /// The shape in a set of this workspace.
    pub fn of(&self, workspace: &Workspace) -> PyResult<opm_workspace::Inscribed> {
        let names: Vec<String> = workspace.varying().into_iter().map(|(name, _)| name).collect();
        let values = |of: &BTreeMap<String, f64>| -> Option<Vec<f64>> {
            let known = of.len() == names.len();
            names.iter().map(|name| of.get(name).copied()).collect::<Option<_>>().filter(|_| known)
        };
        let parts = (values(&self.centre), values(&self.radii), values(&self.error));
        let (Some(centre), Some(radii), Some(error)) = parts else {
            let has: Vec<&str> = self.centre.keys().map(|name| &**name).collect();
            let (has, names) = (has.join(", "), names.join(", "));
            return Err(wrong(format!("inscribed is a shape in {has}, expected one in {names}")));
        };
        let shape = InscribedShape::from_name(&self.shape)
            .ok_or_else(|| wrong(format!("inscribed is a {:?}", self.shape)))?;
        let at_edge = self.at_edge;
        Ok(opm_workspace::Inscribed { shape, names, centre, radii, error, at_edge })
    }
}

#[pymethods]
impl Inscribed {
    fn __repr__(&self) -> String {
        let centre: Vec<_> =
            self.centre.iter().map(|(name, at)| format!("{name}={at:?}")).collect();
        let radii: Vec<_> = self.radii.values().map(|radius| format!("{radius:?}")).collect();
        format!("<Inscribed {} at {}, {}>", self.shape, centre.join(", "), radii.join(" x "))
    }
}

#[pymethods]
impl Sweep {
    /// What rejects the other poses of the grid: each leg that does not reach them, and each limit.
    ///
    /// Every pose is solved in the working mode, or in all of them. A leg that is out of reach has no joint values, so that
    /// its limits reject nothing there. With mode ``"any"``, what rejects a pose alone is what would have to go in one of
    /// the modes, and a leg that reaches the pose in one of them rejects nothing.
    ///
    /// Returns
    /// -------
    /// list[Rejection]
    ///     The causes that reject any pose, leg by leg.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The kind has no poses of both sections.
    fn rejections(&self, py: Python<'_>) -> PyResult<Vec<Rejection>> {
        let progress = Progress::default();
        let threads = few(self.threads, self.workspace.grid().poses() / POSES + 1);
        let work = || self.workspace.rejections(&progress);
        let found = interrupt::run(py, threads, work, || progress.cancel())?.map_err(study)?;
        let manipulator = self.workspace.manipulator();
        let name = |joint: usize| Some(manipulator.coordinates()[joint].name.clone());
        let joint_of = |first: usize| {
            manipulator.mechanism().joint_from(first).map(|joint| joint.name.clone())
        };
        let rejections = found.rejections.iter().map(|rejection| {
            let (section, joint, limit) = match rejection.cause {
                Cause::Reach(section) => (section.map(|section| section.to_string()), None, None),
                Cause::Lowest(joint) => (None, name(joint), Some("lowest".to_owned())),
                Cause::Highest(joint) => (None, name(joint), Some("highest".to_owned())),
                Cause::Cone(joint) => (None, joint_of(joint), Some("cone".to_owned())),
                Cause::Difference(number) => {
                    let name = manipulator.differences()[number].name.clone();
                    (None, Some(name), Some("difference".to_owned()))
                }
            };
            let leg = manipulator.mechanism().legs[rejection.leg].name.clone();
            let (alone, with_others) = (rejection.alone, rejection.with_others);
            Rejection { leg, section, joint, limit, alone, with_others }
        });
        Ok(rejections.collect())
    }

    /// The largest disc, ball or box in the set of points.
    ///
    /// Each point stands for a cell of the grid, and what lies beyond the grid is outside. A disc or ball is the largest in
    /// these cells, to 1e-9 of its radius; a box is inside the boundary, with sides at points or half-way between them. The disc
    /// in the kind ``"dexterous"`` is the regular dexterous workspace.
    ///
    /// Parameters
    /// ----------
    /// shape : str
    ///     ``"disc"`` in two coordinates, ``"ball"`` in three, or ``"box"`` in two or three.
    /// centre : mapping, optional
    ///     The centre by coordinate, radians and metres. The best one if not given.
    /// executor : concurrent.futures.Executor or callable, optional
    ///     As for :func:`sweep`.
    /// shards : int, optional
    ///     As for :func:`sweep`.
    ///
    /// Returns
    /// -------
    /// Inscribed or None
    ///     None if the set is empty, or the given centre is not inside it.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The set does not suit the shape: it varies in other coordinates, or a disc would have different units.
    #[pyo3(signature = (shape, *, centre = None, executor = None, shards = None))]
    fn inscribed(
        slf: &Bound<'_, Self>,
        shape: &str,
        centre: Option<BTreeMap<String, f64>>,
        executor: Option<Bound<'_, PyAny>>,
        #[pyo3(from_py_with = arguments::shards)] shards: Option<NonZeroU64>,
    ) -> PyResult<Option<Inscribed>> {
        let Some(shape) = InscribedShape::from_name(shape) else {
            let names = InscribedShape::ALL.map(|shape| format!("{:?}", shape.name()));
            return Err(wrong(format!("shape is {shape:?}, expected one of {}", names.join(", "))));
        };
        let workspace = &slf.get().workspace;
        let varying: Vec<String> = workspace.varying().into_iter().map(|(name, _)| name).collect();
        let at = match &centre {
            None => None,
            Some(given) if given.keys().all(|name| varying.contains(name)) => {
                let value = |name: &String| given.get(name).copied().filter(|at| at.is_finite());
                let values: Option<Vec<f64>> = varying.iter().map(value).collect();
                let names = varying.join(", ");
                Some(values.ok_or_else(|| {
                    wrong(format!("centre is not complete, expected finite values of {names}"))
                })?)
            }
            Some(_) => {
                let names = varying.join(", ");
                return Err(wrong(format!("centre has other names, expected {names}")));
            }
        };
        let set = Sweep::set(slf, Parts::new(executor, shards)?.as_ref())?;
        let found = slf.py().detach(|| workspace.inscribed(&set, shape, at.as_deref()));
        let Some(found) = found.map_err(study)? else { return Ok(None) };
        let named =
            |values: &[f64]| found.names.iter().cloned().zip(values.iter().copied()).collect();
        Ok(Some(Inscribed {
            shape: shape.name().to_owned(),
            centre: named(&found.centre),
            radii: named(&found.radii),
            error: named(&found.error),
            measure: found.measure(),
            at_edge: found.at_edge,
        }))
    }
}
