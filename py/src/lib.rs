//! The native half of the Python package `opm_kinematics`: NumPy arrays in and out, metres and
//! radians. The modules mirror those of the crates, which document what they do. The package's stubs
//! document it for Python.

// Arguments come from Python by value.
#![allow(clippy::needless_pass_by_value)]
// Doc comments here are docstrings for Python, in numpydoc's format.
#![allow(clippy::doc_markdown, clippy::doc_link_with_quotes)]

mod accuracy;
mod analysis;
mod arguments;
mod calibration;
mod check;
mod clearance;
mod columns;
mod command;
mod decomposition;
mod dimensions;
mod dynamics;
mod error;
mod explorer;
mod export;
mod forward;
mod generate;
mod given;
mod html;
mod interrupt;
mod joint;
mod joints;
mod linkage;
mod manipulator;
mod matrices;
mod measure;
mod nearest;
mod one;
mod parts;
mod pickle;
mod pictures;
mod place;
mod response;
mod restored;
mod rows;
mod screws;
mod setup;
mod shared;
mod simulation;
mod snap;
mod solids;
mod solutions;
mod sweep;
mod trajectory;
mod velocity;

use pyo3::prelude::*;

#[pymodule]
mod _native {
    #[pymodule_export]
    use crate::accuracy::{Accuracy, AccuracyBounds, AccuracySamples};
    #[pymodule_export]
    use crate::analysis::Analysis;
    #[pymodule_export]
    use crate::calibration::{Calibration, calibrate};
    #[pymodule_export]
    use crate::check::{Certificate, Comparison, recover};
    #[pymodule_export]
    use crate::clearance::Clearance;
    #[pymodule_export]
    use crate::command::command;
    #[pymodule_export]
    use crate::decomposition::{Decomposition, Intersection, LegSplit};
    #[pymodule_export]
    use crate::dimensions::ParameterJacobian;
    #[pymodule_export]
    use crate::error::OpmError;
    #[pymodule_export]
    use crate::explorer::{Explorer, explore};
    #[pymodule_export]
    use crate::forward::{Assemblies, Assembly};
    #[pymodule_export]
    use crate::joint::Joint;
    #[pymodule_export]
    use crate::linkage::Linkage;
    #[pymodule_export]
    use crate::manipulator::{Manipulator, TaskCoordinate, example, examples};
    #[pymodule_export]
    use crate::measure::{Measure, measure};
    #[pymodule_export]
    use crate::nearest::NearestReachable;
    #[pymodule_export]
    use crate::place::Nearest;
    #[pymodule_export]
    use crate::solids::Solid;
    #[pymodule_export]
    use crate::solutions::Solutions;
    #[pymodule_export]
    use crate::sweep::{Aspect, Conditioning, Inscribed, Outline, Rejection, Sweep, sweep};
    #[pymodule_export]
    use crate::trajectory::{Contact, Trajectory, Violation, trajectory};
    #[pymodule_export]
    use crate::velocity::{Motion, Singularity};
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        // This is needed for pickling only and is not exported.
        module.setattr("_Boxes", module.py().get_type::<crate::measure::Boxes>())?;
        let mapping = module.py().import("collections.abc")?.getattr("Mapping")?;
        mapping.call_method1("register", (module.py().get_type::<Solutions>(),))?;
        mapping.call_method1("register", (module.py().get_type::<Trajectory>(),))?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
