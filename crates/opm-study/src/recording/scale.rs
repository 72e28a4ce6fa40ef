//! The scale of the axes of a cloud: lengths beside angles are drawn with comparable extents.

use opm_core::Quantity;

/// The quantity and the extent of each axis; `None` for an axis without values.
pub type Measures = [Option<(Quantity, f64)>; 3];

/// The factors by which the axes of a cloud are multiplied. Axes of the quantity of the first keep their numbers. Any other gets the factor 1, 2 or 5 times a
/// power of ten that brings it nearest to the extent of the largest of those.
pub fn factors(axes: Measures) -> [f64; 3] {
    let Some(quantity) = axes.iter().flatten().next().map(|(quantity, _)| *quantity) else {
        return [1.0; 3];
    };
    let of_first = axes.iter().flatten().filter(|axis| axis.0 == quantity);
    let largest = of_first.map(|axis| axis.1).fold(0.0, f64::max);
    axes.map(|axis| match axis {
        Some((other, extent)) if other != quantity && extent > 0.0 && largest > 0.0 => {
            round(largest / extent)
        }
        _ => 1.0,
    })
}

/// The nearest of 1, 2 and 5 times a power of ten, by ratio.
fn round(factor: f64) -> f64 {
    let power = factor.log10().floor() as i32;
    let candidates = [1, 2, 5, 10].map(|step| {
        // Decimals that are as short as they are written.
        let text = format!("{step}e{power}");
        text.parse().unwrap_or(factor)
    });
    let off = |candidate: f64| (candidate / factor).ln().abs();
    candidates.into_iter().min_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap_or(factor)
}

#[cfg(test)]
mod tests {
    use super::*;
    use Quantity::{Angle, Length};

    #[test]
    fn other_quantities_get_comparable_extents() {
        let [x, y, z] = [Some((Length, 0.4)), Some((Length, 0.3)), Some((Angle, 2.0))];
        assert_eq!(factors([x, y, z]), [1.0, 1.0, 0.2]);
        // A screw of one millimetre a turn: 165 rad beside half a metre.
        assert_eq!(factors([x, y, Some((Angle, 165.0))]), [1.0, 1.0, 0.002]);
        assert_eq!(factors([Some((Angle, 2.0)), x, y]), [1.0, 5.0, 5.0]);
        // Of one quantity, without values, or of one value, they stay.
        for axes in [[x, y, x], [x, y, None], [None; 3], [x, y, Some((Angle, 0.0))]] {
            assert_eq!(factors(axes), [1.0; 3]);
        }
        assert_eq!(factors([Some((Length, 0.0)), None, z]), [1.0; 3]);
    }

    #[test]
    fn factors_are_short_and_near() {
        for i in -60..60 {
            let factor = 1.23 * 10f64.powf(0.1 * f64::from(i));
            let rounded = round(factor);
            assert!(
                (rounded / factor).ln().abs() <= 0.5 * 2.5f64.ln() + 1e-12,
                "{factor} {rounded}"
            );
            let text = format!("{rounded:e}");
            assert!(["1e", "2e", "5e"].iter().any(|start| text.starts_with(start)), "{text}");
        }
    }
}
