//! What is proven of assemblies, in words and as JSON.

use opm_core::forward::Certificate;
use serde::Serialize;
use std::fmt::Write;

/// What is proven of an assembly.
#[derive(Serialize)]
pub struct Json {
    certificate: &'static str,
    /// How far the exact assembly is away at most: radians, and lengths over the mechanism's size; null if nothing is proven.
    radius: Option<f64>,
    /// Whether it is none of those before it; null if nothing is proven.
    distinct: Option<bool>,
}

impl Json {
    pub fn new(certificate: &Certificate) -> Self {
        let proof = certificate.proof();
        Self {
            certificate: match certificate {
                Certificate::Proven(_) => "proven",
                Certificate::DoubleSuspected => "double-suspected",
                Certificate::Redundant => "redundant",
            },
            radius: proof.map(|proof| proof.radius),
            distinct: proof.map(|proof| proof.distinct),
        }
    }
}

/// What is proven of the assemblies of a table.
pub fn text(certificates: &[Certificate]) -> String {
    let mut text = String::new();
    let numbers = |wanted: &dyn Fn(&Certificate) -> bool| {
        let numbered = certificates.iter().enumerate().filter(|(_, c)| wanted(c));
        numbered.map(|(number, _)| (number + 1).to_string()).collect::<Vec<_>>()
    };
    let proofs = || certificates.iter().filter_map(Certificate::proof);
    let count = proofs().count();
    if let Some(first) = proofs().next() {
        let radius = proofs().map(|proof| proof.radius).fold(0.0, f64::max);
        let which = match (count, certificates.len()) {
            (1, 1) => "It is proven".to_owned(),
            (n, all) if n == all => "All are proven".to_owned(),
            (n, all) => format!("{n} of {all} are proven"),
        };
        let each = if certificates.len() == 1 { "it" } else { "each" };
        let _ = write!(
            text,
            "{which}: one exact assembly is within {radius:.1e} of {each} (radians, shares of the size)"
        );
        let same = numbers(&|c| c.proof().is_some_and(|proof| !proof.distinct));
        match (count, same.is_empty()) {
            (1, _) => text.push('.'),
            (_, true) => text += ", and no two are the same.",
            (_, false) => {
                let _ = write!(text, "; {} may be the same as another one.", same.join(", "));
            }
        }
        if first.implied > 0 {
            let _ = write!(
                text,
                " Of {} closure equations {} follow from the decomposition.",
                first.proven + first.implied,
                first.implied
            );
        }
        text.push('\n');
    }
    let double = numbers(&|c| matches!(c, Certificate::DoubleSuspected));
    if !double.is_empty() {
        let _ = writeln!(
            text,
            "{}: not proven, double pose suspected: two assemblies nearly meet, or a body can move with these joints held.",
            double.join(", ")
        );
    }
    if certificates.contains(&Certificate::Redundant) {
        text += "Nothing is proven: more joints are actuated than the platform has freedoms.\n";
    }
    match text.is_empty() {
        true => text,
        false => format!("\n{text}"),
    }
}
