//! Derivatives by central differences, extrapolated to step zero, with an error bound.

/// The number of steps; each step is `SHRINK` times the previous one.
const STEPS: usize = 9;
const SHRINK: f64 = 0.6;
/// The largest step of a second set, as a share of the first.
const OTHER: f64 = 0.8;

/// A derivative, with a bound on its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The value of the derivative.
    pub value: f64,
    /// The difference of the last extrapolations, or of two sets of steps, as an error bound.
    pub error: f64,
}

/// The first and second derivative at zero of every component of `f`, with `step` as the largest
/// step; `None` if `f` is undefined at one of the points. The method is Neville's scheme in the
/// square of the step: Ridders, "Accurate computation of F'(x) and F'(x) F''(x)", Adv. Eng.
/// Software 4 (1982).
pub fn derivatives(
    step: f64,
    mut f: impl FnMut(f64) -> Option<Vec<f64>>,
) -> Option<Vec<[Estimate; 2]>> {
    let middle = f(0.0)?;
    let found = from_steps(step, &middle, &mut f)?;
    // Where rounding decides, two extrapolations may agree by chance, but hardly those of other steps, too.
    let again = from_steps(OTHER * step, &middle, &mut f)?;
    let both = |(one, other): (Estimate, Estimate)| {
        let apart = (one.value - other.value).abs();
        Estimate { value: one.value, error: one.error.max(apart) }
    };
    let pairs = found.into_iter().zip(again);
    Some(pairs.map(|([a, b], [c, d])| [(a, c), (b, d)].map(both)).collect())
}

fn from_steps(
    step: f64,
    middle: &[f64],
    mut f: impl FnMut(f64) -> Option<Vec<f64>>,
) -> Option<Vec<[Estimate; 2]>> {
    let mut sides = Vec::new();
    let mut h = step;
    for _ in 0..STEPS {
        sides.push((h, f(h)?, f(-h)?));
        h *= SHRINK;
    }
    let estimate = |i: usize| {
        let first = sides.iter().map(|(h, up, down)| (up[i] - down[i]) / (2.0 * h));
        let second =
            sides.iter().map(|(h, up, down)| (up[i] - 2.0 * middle[i] + down[i]) / (h * h));
        [extrapolated(first), extrapolated(second)]
    };
    Some((0..middle.len()).map(estimate).collect())
}

fn extrapolated(differences: impl Iterator<Item = f64>) -> Estimate {
    let mut best = Estimate { value: 0.0, error: f64::INFINITY };
    let mut above: Vec<f64> = Vec::new();
    for difference in differences {
        let mut row = vec![difference];
        let mut factor = 1.0;
        for (k, old) in above.iter().enumerate() {
            factor /= SHRINK * SHRINK;
            let value = row[k] + (row[k] - old) / (factor - 1.0);
            let error = (value - row[k]).abs().max((value - old).abs());
            if error < best.error {
                best = Estimate { value, error };
            }
            row.push(value);
        }
        above = row;
    }
    best
}

#[cfg(test)]
mod tests {
    use super::derivatives;

    #[test]
    fn known_derivatives_are_found_within_their_error() {
        let found = derivatives(0.1, |t| Some(vec![(1.0 + t).sin(), (0.3 - 2.0 * t).exp()]));
        let [sine, exponential] = found.unwrap()[..] else { panic!() };
        let e = 0.3_f64.exp();
        for (found, known) in [
            (sine[0], 1_f64.cos()),
            (sine[1], -1_f64.sin()),
            (exponential[0], -2.0 * e),
            (exponential[1], 4.0 * e),
        ] {
            assert!(found.error < 1e-8, "{found:?}");
            assert!((found.value - known).abs() < 10.0 * found.error + 1e-12, "{found:?} {known}");
        }
        assert!(derivatives(0.1, |t| (t > -0.05).then(|| vec![t])).is_none());
    }
}
