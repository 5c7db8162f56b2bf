//! Derivatives by differences, to check exact ones against.

/// A derivative and how far it may be off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The derivative.
    pub value: f64,
    /// How much the last two extrapolations differ, but not less than the rounding of f.
    pub error: f64,
}

/// How often the step is halved.
const LEVELS: usize = 4;

/// df/dx at x by central differences with Richardson's extrapolation.
///
/// ```text
///  D(h) = (f(x+h) − f(x−h)) / 2h = f' + c₂ h² + c₄ h⁴ + …
///  Dⱼ(h) = Dⱼ₋₁(h) + (Dⱼ₋₁(h) − Dⱼ₋₁(2h)) / (4ʲ − 1)          cancels c₂, c₄, …
/// ```
///
/// Differences are taken at `step`, `step`/2, `step`/4 and `step`/8; of the extrapolated values the
/// one that differs least from those it was made of is returned (Ridders 1982).
///
/// A good `step` is about 1e-3 of the length over which f changes: with a rollout's rounding of
/// 1e-15 the smallest difference then carries an error of 1e-11, and what extrapolation leaves of
/// the truncation is of the order (1e-3)⁸. Larger steps gain nothing here, because f must not cross
/// a switch (a contact that opens or begins to slide) between x − step and x + step; whoever calls
/// must know that it does not.
pub fn derivative(mut f: impl FnMut(f64) -> f64, x: f64, step: f64) -> Estimate {
    let mut best = Estimate { value: f64::NAN, error: f64::INFINITY };
    let mut above: Vec<f64> = Vec::new();
    let mut h = step;
    for level in 0..LEVELS {
        let (right, left) = (x + h, x - h);
        let (above_x, below_x) = (f(right), f(left));
        let rounding = f64::EPSILON * above_x.abs().max(below_x.abs()) / h;
        let mut row = vec![(above_x - below_x) / (right - left)];
        let mut power = 1.0;
        for j in 0..level {
            power *= 4.0;
            let value = row[j] + (row[j] - above[j]) / (power - 1.0);
            let error = (value - row[j]).abs().max((value - above[j]).abs()).max(rounding);
            if error <= best.error {
                best = Estimate { value, error };
            }
            row.push(value);
        }
        above = row;
        h /= 2.0;
    }
    best
}

#[cfg(test)]
mod tests {
    use super::derivative;

    #[track_caller]
    fn check(f: impl Fn(f64) -> f64, x: f64, exact: f64) {
        let found = derivative(f, x, 1e-3 * x.abs().max(1.0));
        assert!((found.value - exact).abs() <= 1e-10 * exact.abs().max(1.0), "{found:?}");
        assert!(found.error <= 1e-9 * exact.abs().max(1.0), "{found:?}");
    }

    #[test]
    fn known_derivatives_come_out_to_ten_digits() {
        check(f64::sin, 0.7, 0.7_f64.cos());
        check(f64::exp, -2.0, (-2.0_f64).exp());
        check(|x| x.powi(5), 3.0, 405.0);
        check(|_| 1.0, 0.0, 0.0);
    }

    #[test]
    fn rounding_is_part_of_the_error() {
        let found = derivative(|x| 1e6 + x, 4.0, 4e-3);
        assert!((found.value - 1.0).abs() <= found.error && found.error < 1e-6, "{found:?}");
    }
}
