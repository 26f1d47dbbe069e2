//! Linear least squares with bounds on the unknowns.

/// Weights of the costs, one pass after the other: the first ones move quickly along directions that the rows leave
/// open, the last one leaves the residuals as they would be without costs.
const COST_WEIGHTS: [f64; 5] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5];
/// Most sweeps over the unknowns in a pass, and the change of an unknown at which a pass ends.
const MOST_SWEEPS: u32 = 2000;
const SMALLEST_CHANGE: f64 = 1e-9;

/// An equation: the sum of `coefficients` times the unknowns should be `value`.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearEquation {
    /// One coefficient for each unknown.
    pub coefficients: Vec<f64>,
    /// Right-hand side.
    pub value: f64,
}

/// An unknown of a least-squares problem.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundedUnknown {
    /// Least value.
    pub least: f64,
    /// Greatest value.
    pub most: f64,
    /// Value that it keeps if no equation has it.
    pub initial: f64,
    /// Cost of a unit, from 0 to 1. Of solutions that are equally good the cheapest is taken.
    pub cost: f64,
}

/// Returns the unknowns that minimise the sum of the squared residuals of the equations; of several solutions the one of
/// least cost. Unknowns without a coefficient keep their initial values. Coordinate descent: each unknown in turn is set to
/// its best value within its bounds (Bertsekas, Nonlinear Programming, section 3.7).
///
/// Equations should be scaled to right-hand sides of about 1, which the weights of the costs suppose.
pub fn bounded_least_squares(unknowns: &[BoundedUnknown], equations: &[LinearEquation]) -> Vec<f64> {
    let product = |i: usize, j: usize| equations.iter().map(|e| e.coefficients[i] * e.coefficients[j]).sum::<f64>();
    let gram: Vec<Vec<f64>> =
        (0..unknowns.len()).map(|i| (0..unknowns.len()).map(|j| product(i, j)).collect()).collect();
    let right: Vec<f64> =
        (0..unknowns.len()).map(|i| equations.iter().map(|e| e.coefficients[i] * e.value).sum()).collect();
    let mut x: Vec<f64> = unknowns.iter().map(|unknown| unknown.initial.clamp(unknown.least, unknown.most)).collect();
    for weight in COST_WEIGHTS {
        for _ in 0..MOST_SWEEPS {
            let mut change = 0.0_f64;
            for (i, unknown) in unknowns.iter().enumerate().filter(|(i, _)| gram[*i][*i] > 0.0) {
                let others: f64 = (0..x.len()).filter(|j| *j != i).map(|j| gram[i][j] * x[j]).sum();
                let best = (right[i] - weight * unknown.cost - others) / gram[i][i];
                let next = best.clamp(unknown.least, unknown.most);
                change = change.max((next - x[i]).abs());
                x[i] = next;
            }
            if change < SMALLEST_CHANGE {
                break;
            }
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unknown(least: f64, most: f64, cost: f64) -> BoundedUnknown {
        BoundedUnknown { least, most, initial: 0.7, cost }
    }

    fn equation(coefficients: &[f64], value: f64) -> LinearEquation {
        LinearEquation { coefficients: coefficients.to_vec(), value }
    }

    #[test]
    fn the_solution_of_a_regular_system_within_the_bounds_is_found() {
        let equations =
            [equation(&[2.0, 1.0, 0.0], 1.0), equation(&[0.5, 3.0, 0.2], 1.0), equation(&[0.0, 0.1, 4.0], 1.0)];
        let x = bounded_least_squares(&[unknown(0.0, 1.0, 0.1); 3], &equations);
        for row in &equations {
            let sum: f64 = row.coefficients.iter().zip(&x).map(|(a, x)| a * x).sum();
            assert!((sum - 1.0).abs() < 1e-4, "{x:?}");
        }
    }

    #[test]
    fn bounds_are_kept_and_the_others_make_up_for_them() {
        // x <= 0.5: minimise (x + y - 1)^2 + (y - 0.1)^2 with x = 0.5, so y = (0.5 + 0.1) / 2.
        let equations = [equation(&[1.0, 1.0], 1.0), equation(&[0.0, 1.0], 0.1)];
        let x = bounded_least_squares(&[unknown(0.0, 0.5, 0.0), unknown(0.0, 1.0, 0.0)], &equations);
        assert!((x[0] - 0.5).abs() < 1e-9 && (x[1] - 0.3).abs() < 1e-6, "{x:?}");
        // A least value that is too much already.
        let x = bounded_least_squares(&[unknown(0.2, 1.0, 0.0)], &[equation(&[10.0], 1.0)]);
        assert_eq!(x, [0.2]);
    }

    #[test]
    fn of_equally_good_solutions_the_cheapest_is_taken() {
        // The second gives more for its cost: it is used up first.
        let equations = [equation(&[1.0, 2.0], 1.0)];
        let cheapest = |most| bounded_least_squares(&[unknown(0.0, 1.0, 0.5), unknown(0.0, most, 0.5)], &equations);
        assert!((cheapest(1.0)[1] - 0.5).abs() < 1e-4 && cheapest(1.0)[0] < 1e-9);
        let limited = cheapest(0.2);
        assert!((limited[1] - 0.2).abs() < 1e-9 && (limited[0] - 0.6).abs() < 1e-4, "{limited:?}");
        // An unknown that no equation has.
        assert_eq!(bounded_least_squares(&[unknown(0.1, 1.0, 0.5)], &[equation(&[0.0], 1.0)]), [0.7]);
    }
}
