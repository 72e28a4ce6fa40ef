//! Measures of counted sets, and the units of products.

use opm_core::Quantity;
use opm_core::mechanism::file::FileUnits;
use opm_workspace::Axis;

/// The size of a counted set.
#[derive(Clone, Debug, PartialEq)]
pub struct Measure {
    /// The value, in the unit.
    pub value: f64,
    /// The unit, a product; `1` if there is none.
    pub unit: String,
}

/// The counted share of a box, over the axes with more than one value.
pub(crate) fn grid_measure<'a>(
    fraction: f64,
    axes: impl Iterator<Item = (&'a Axis, Quantity)>,
    units: FileUnits,
) -> Measure {
    let mut value = fraction;
    let mut powers = [(Quantity::Length, 0), (Quantity::Angle, 0)];
    for (axis, quantity) in axes {
        if axis.count > 1 {
            value *= axis.max - axis.min;
            powers.iter_mut().filter(|p| p.0 == quantity).for_each(|p| p.1 += 1);
        }
    }
    let (unit, factor) = unit_product(&powers, units);
    Measure { value: value / factor, unit }
}

/// The unit of a product with this many factors of each quantity, and its value in SI units.
pub fn unit_product(powers: &[(Quantity, usize)], units: FileUnits) -> (String, f64) {
    let (mut symbols, mut factor) = (Vec::new(), 1.0);
    for &(quantity, power) in powers.iter().filter(|(_, power)| *power > 0) {
        let symbol = units.symbol(quantity);
        symbols.push(if power == 1 { symbol.to_owned() } else { format!("{symbol}^{power}") });
        factor *= units.factor(quantity).powi(power as i32);
    }
    (if symbols.is_empty() { "1".to_owned() } else { symbols.join(" ") }, factor)
}
