//! Order statistics.

/// Returns the value below which there is this share of the values, reordering them; 0 without values.
pub fn quantile(values: &mut [f32], share: f32) -> f32 {
    let Some(last) = values.len().checked_sub(1) else { return 0.0 };
    let n = ((values.len() as f32 * share) as usize).min(last);
    *values.select_nth_unstable_by(n, f32::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::quantile;

    #[test]
    fn quantiles_are_values_with_the_share_below_them() {
        for (share, expected) in [(0.0, 1.0), (0.5, 3.0), (0.9, 4.0), (1.0, 4.0)] {
            assert_eq!(quantile(&mut [3.0, 1.0, 4.0, 2.0], share), expected, "{share}");
        }
        assert_eq!(quantile(&mut [], 0.5), 0.0);
    }
}
