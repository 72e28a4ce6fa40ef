//! Arguments of caps of the tool's motion.

use super::heading;
use crate::pose::Number;
use opm_core::Quantity;
use opm_core::motion::ToolLimits;

/// Caps of the tool's speed and acceleration.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct ToolArgs {
    /// With --time-optimal: the largest speed of the platform's reference point, for example 200mm/s
    #[arg(help_heading = heading::TIMING, long, value_name = "SPEED", requires = "time_optimal", allow_hyphen_values = true, value_parser = speed)]
    pub tool_speed: Option<f64>,
    /// With --time-optimal: its largest acceleration, for example 2m/s2
    #[arg(help_heading = heading::TIMING, long, value_name = "ACCELERATION", requires = "time_optimal", allow_hyphen_values = true, value_parser = acceleration)]
    pub tool_acceleration: Option<f64>,
    /// With --time-optimal: the largest angular speed of the platform, for example 90deg/s
    #[arg(help_heading = heading::TIMING, long, value_name = "SPEED", requires = "time_optimal", allow_hyphen_values = true, value_parser = angular_speed)]
    pub tool_angular_speed: Option<f64>,
    /// With --time-optimal: its largest angular acceleration, for example 5rad/s2
    #[arg(help_heading = heading::TIMING, long, value_name = "ACCELERATION", requires = "time_optimal", allow_hyphen_values = true, value_parser = angular_acceleration)]
    pub tool_angular_acceleration: Option<f64>,
}

impl ToolArgs {
    /// The caps.
    pub fn limits(&self) -> ToolLimits {
        ToolLimits {
            speed: self.tool_speed,
            acceleration: self.tool_acceleration,
            angular_speed: self.tool_angular_speed,
            angular_acceleration: self.tool_angular_acceleration,
        }
    }
}

fn speed(text: &str) -> Result<f64, String> {
    cap(text, Quantity::Length, &["s"])
        .ok_or_else(|| "expected a speed above 0 such as 200mm/s, or 0.2, in m/s".to_owned())
}

fn acceleration(text: &str) -> Result<f64, String> {
    cap(text, Quantity::Length, SQUARED)
        .ok_or_else(|| "expected an acceleration above 0 such as 2m/s2, or 2, in m/s²".to_owned())
}

fn angular_speed(text: &str) -> Result<f64, String> {
    cap(text, Quantity::Angle, &["s"]).ok_or_else(|| {
        "expected an angular speed above 0 such as 90deg/s, or 1.5, in rad/s".to_owned()
    })
}

fn angular_acceleration(text: &str) -> Result<f64, String> {
    cap(text, Quantity::Angle, SQUARED).ok_or_else(|| {
        "expected an angular acceleration above 0 such as 5rad/s2, or 5, in rad/s²".to_owned()
    })
}

/// How a square second is written.
const SQUARED: &[&str] = &["s2", "s^2", "s²"];

/// A number above zero with a unit of the quantity over one of time, or alone.
fn cap(text: &str, quantity: Quantity, times: &[&str]) -> Option<f64> {
    let value = match text.split_once('/') {
        Some((number, time)) => {
            let number: Number = number.parse().ok()?;
            let known = times.contains(&time.trim()) && number.quantity() == Some(quantity);
            known.then(|| number.value_of("", quantity).ok())??
        }
        None => text.parse::<Number>().ok()?.without_unit()?,
    };
    (value > 0.0).then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn caps_have_units_over_time() {
        for (text, expected) in [("200mm/s", 0.2), ("0.2", 0.2), ("1 m/s", 1.0)] {
            assert_eq!(speed(text), Ok(expected), "{text}");
        }
        for text in ["2000mm/s2", "2m/s^2", "2m/s²", "2"] {
            assert_eq!(acceleration(text), Ok(2.0), "{text}");
        }
        assert_eq!(angular_speed("180deg/s"), Ok(std::f64::consts::PI));
        assert_eq!(angular_acceleration("5rad/s2"), Ok(5.0));
        for text in
            ["", "200mm", "200deg/s", "0mm/s", "-1", "nan", "inf", "1e999", "2m/s2", "/s", "2/s"]
        {
            assert!(speed(text).is_err(), "{text}");
        }
        assert!(acceleration("2m/s").is_err() && angular_speed("2m/s").is_err());
    }
}
