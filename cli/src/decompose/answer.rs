//! The answer about a mechanism that does not decompose: what it is, what it can do, and why.

use super::{actuation, describe, joints, line_of_snapped, misses, triple_json};
use crate::load::Loaded;
use crate::text::Table;
use opm_core::decomposition::{Applies, LegSurvey, PlatformMotion, Survey};
use opm_core::group::subspace::SubspaceClass;
use serde_json::{Value, json};
use std::fmt::Write;

pub struct Answer<'a> {
    pub loaded: &'a Loaded,
    pub survey: &'a Survey,
}

impl Answer<'_> {
    pub fn json(&self, warnings: &[String]) -> Value {
        let survey = self.survey;
        let mut json = json!({
            "name": self.loaded.file.mechanism.name,
            "lambda": survey.mobility.lambda,
            "mobility": survey.mobility.mobility,
            "architecture": survey.notation,
            "common_name": survey.common_name,
            "platform": {
                "dimension": survey.platform.dimension,
                "translations": survey.platform.translations,
                "subspace": survey.platform.subspace.map(|class| class.name()),
            },
            "legs": survey.legs.iter().map(leg_json).collect::<Vec<_>>(),
            "applies": survey.applies.name(),
            "because": self.because(),
            "warnings": warnings,
        });
        if let Value::Object(json) = &mut json {
            joints::insert(json, &self.loaded.file);
        }
        if let Some(near) = &survey.near {
            json["nearly"] = json!({
                "lower": { "subspace": near.lower.name() },
                "upper": { "subspace": near.upper.name() },
                "tolerance": near.tolerance,
                "joints": misses(&near.joints),
            });
        }
        if let Some(snapped) = &self.loaded.snapped {
            json["snapped"] = misses(snapped);
        }
        json
    }

    pub fn text(&self) -> String {
        let (survey, units) = (self.survey, self.loaded.file.units);
        let mut text = String::new();
        let name = survey.common_name.map_or_else(String::new, |name| format!(" ({name})"));
        let _ = writeln!(
            text,
            "{}: {}{name}, joint screws of rank lambda = {}, mobility N = {}\n",
            self.loaded.file.mechanism.name,
            survey.notation,
            survey.mobility.lambda,
            survey.mobility.mobility,
        );
        let mut legs =
            Table::new(["leg", "chain", ">freedoms", ">dimension", "subspace", "actuated"]);
        for leg in &survey.legs {
            let subspace = describe(&leg.subspace, units);
            legs.row([
                &leg.name,
                &leg.chain,
                &leg.span.to_string(),
                &leg.subspace.dimension().to_string(),
                &subspace,
                &leg.actuated.join(" "),
            ]);
        }
        let _ = writeln!(text, "{legs}");
        let _ = writeln!(text, "platform at home: {}", self.platform(&survey.platform));
        let _ = writeln!(text, "{}\n", actuation(self.loaded, &survey.mobility));
        match (&survey.applies, &survey.near) {
            (Applies::Nearly, Some(near)) => {
                let (lower, upper) = (describe(&near.lower, units), describe(&near.upper, units));
                if near.upper == SubspaceClass::Identity {
                    let _ = writeln!(text, "nearly one subspace: {lower}");
                } else {
                    let _ = writeln!(text, "nearly two subspaces");
                    let _ = writeln!(text, "  lower section   {lower}");
                    let _ = writeln!(text, "  upper section   {upper}");
                }
                let _ = writeln!(text, "but these joints are off:");
                for miss in &near.joints {
                    let _ = writeln!(text, "  {miss}");
                }
                let hint = self.loaded.tolerance_hint(near);
                let _ = writeln!(text, "{}", hint.trim_start_matches("; "));
            }
            _ => {
                let _ = writeln!(text, "outside the class, because {}", self.because());
            }
        }
        line_of_snapped(&mut text, self.loaded);
        text
    }

    /// Why opm cannot solve the mechanism, as the rest of a sentence.
    fn because(&self) -> String {
        match (&self.survey.applies, &self.survey.near) {
            (Applies::Outside(reason), _) => match &self.survey.order {
                Some(order) => format!("{reason}; {order}"),
                None => match &self.survey.whole {
                    Some(whole) => {
                        format!("{reason}; nor can its legs be solved by themselves: {whole}")
                    }
                    None => reason.to_string(),
                },
            },
            (Applies::Nearly, Some(near)) => near.to_string(),
            (Applies::Nearly, None) | (Applies::Decomposed(_), _) => String::new(),
        }
    }

    fn platform(&self, motion: &PlatformMotion) -> String {
        let PlatformMotion { dimension, translations, subspace } = motion;
        let rotations = dimension - translations;
        let freedoms = format!("{dimension} freedoms ({translations}T{rotations}R)");
        match subspace {
            Some(class) => format!("{freedoms}: {}", describe(class, self.loaded.file.units)),
            None => format!("{freedoms}, no subgroup"),
        }
    }
}

fn leg_json(leg: &LegSurvey) -> Value {
    let (direction, point, pitch) = geometry(&leg.subspace);
    json!({
        "name": leg.name,
        "chain": leg.chain,
        "actuated": leg.actuated,
        "freedoms": leg.span,
        "subspace": leg.subspace.name(),
        "dimension": leg.subspace.dimension(),
        "closed": leg.is_closed(),
        "direction": direction,
        "point": point,
        "pitch": pitch,
    })
}

/// The axis or normal of a group, a point of its axis or its centre, and its pitch.
fn geometry(class: &SubspaceClass) -> (Option<[f64; 3]>, Option<[f64; 3]>, Option<f64>) {
    match class {
        SubspaceClass::Identity | SubspaceClass::TranslationalSpace | SubspaceClass::Full => {
            (None, None, None)
        }
        SubspaceClass::Rotation { axis, point } | SubspaceClass::Cylindrical { axis, point } => {
            (Some(triple_json(axis)), Some(triple_json(&point.coords)), None)
        }
        SubspaceClass::Translation { axis } | SubspaceClass::Schoenflies { axis } => {
            (Some(triple_json(axis)), None, None)
        }
        SubspaceClass::Helical { axis, point, pitch } => {
            (Some(triple_json(axis)), Some(triple_json(&point.coords)), Some(*pitch))
        }
        SubspaceClass::TranslationalPlane { normal } | SubspaceClass::Planar { normal } => {
            (Some(triple_json(normal)), None, None)
        }
        SubspaceClass::Spherical { centre } => (None, Some(triple_json(&centre.coords)), None),
        SubspaceClass::PlanarHelical { axis, pitch } => {
            (Some(triple_json(axis)), None, Some(*pitch))
        }
    }
}
