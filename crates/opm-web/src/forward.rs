//! The assemblies for given actuated joints.

use crate::explorer::Explorer;
use crate::pose::values;
use crate::problem::Problems;
use crate::request::Coordinates;
use crate::session::Reply;
use crate::units::shown;
use opm_core::forward::Assembly;
use opm_study::text::chain;
use serde::Serialize;
use std::collections::BTreeMap;

#[derive(Serialize)]
struct Assemblies {
    assemblies: Vec<Shown>,
}

/// One assembly, in the file's units.
#[derive(Serialize)]
struct Shown {
    pose: Vec<f64>,
    mode: String,
    within: bool,
    values: Vec<f64>,
}

/// Every assembly for these values of the actuated joints, those nearest to a pose first.
pub fn assemble(
    explorer: &Explorer,
    joints: &BTreeMap<String, f64>,
    near: &Coordinates,
) -> Result<Reply, Problems> {
    let (manipulator, units) = (explorer.manipulator(), explorer.units());
    let near =
        manipulator.platform_pose(&explorer.pose(near)?).map_err(|error| Problems::of(&error))?;
    let value = |&number: &usize| {
        let c = &manipulator.coordinates()[number];
        let given = joints.get(&c.name).map(|&value| units.si(value, c.quantity));
        given.ok_or_else(|| Problems::one(format!("no value for {}", c.name)))
    };
    let actuated = manipulator.actuated().iter().map(value).collect::<Result<Vec<_>, _>>()?;
    let mut found =
        manipulator.forward(&actuated).map_err(|error| Problems::one(chain(&error)))?.list;
    manipulator.sort_assemblies(&mut found, &near);
    let assembly = |assembly: &Assembly| {
        let pose = assembly.pose.iter().zip(manipulator.task_coordinates());
        Shown {
            pose: pose.map(|(&value, c)| shown(value, c.quantity, units)).collect(),
            mode: manipulator.format_mode(assembly.mode),
            within: assembly.within_limits,
            values: values(explorer, &assembly.joints, &assembly.imaginary),
        }
    };
    Ok(Reply::new(&Assemblies { assemblies: found.iter().map(assembly).collect() }))
}
