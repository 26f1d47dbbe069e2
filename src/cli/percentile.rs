//! Percentiles of measured values.

/// Returns the value below which `percent` percent of the sorted values lie, by the nearest rank; 0 without values.
pub fn percentile(sorted: &[f64], percent: usize) -> f64 {
    let rank = (sorted.len().saturating_sub(1) * percent + 50) / 100;
    sorted.get(rank).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_values_of_the_list() {
        let values = [1.0, 2.0, 3.0, 4.0, 10.0];
        assert_eq!([0, 50, 90, 100].map(|percent| percentile(&values, percent)), [1.0, 3.0, 10.0, 10.0]);
        assert_eq!((percentile(&[7.0], 90), percentile(&[], 50)), (7.0, 0.0));
    }
}
