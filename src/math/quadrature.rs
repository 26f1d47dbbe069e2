//! Quadrature rules.

use std::f64::consts::PI;

/// Returns nodes in 0..1 and weights of the Gauss-Legendre rule, which integrates polynomials of degree 2 N - 1 exactly.
pub fn gauss_legendre<const N: usize>() -> [(f64, f64); N] {
    std::array::from_fn(|i| {
        // Find the root of the Legendre polynomial by Newton's method (Press et al., "Numerical Recipes", section 4.6)
        let mut x = (PI * (i as f64 + 0.75) / (N as f64 + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..6 {
            let (mut value, mut last) = (1.0, 0.0);
            for k in 0..N {
                let k = k as f64;
                (value, last) = (((2.0 * k + 1.0) * x * value - k * last) / (k + 1.0), value);
            }
            slope = N as f64 * (x * value - last) / (x * x - 1.0);
            x -= value / slope;
        }
        (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_of_degree_two_n_less_one_are_integrated_exactly() {
        let rule = gauss_legendre::<12>();
        for degree in 0..24 {
            let integral: f64 = rule.iter().map(|(x, weight)| weight * x.powi(degree)).sum();
            assert!((integral - 1.0 / f64::from(degree + 1)).abs() < 1e-14, "degree {degree}: {integral}");
        }
        // Degree 24 is the first that is not.
        let integral: f64 = rule.iter().map(|(x, weight)| weight * x.powi(24)).sum();
        assert!((integral - 1.0 / 25.0).abs() > 1e-16);
        assert!(rule.windows(2).all(|pair| pair[0].0 < pair[1].0));
    }
}
