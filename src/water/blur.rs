//! Binomial smoothing along an axis of a grid.

/// Replaces values by the mean of them and their neighbours along an axis, with weights of 1/4, 1/2 and 1/4. Beyond the
/// ends of the axis it goes on with the last value.
pub(super) fn blur(values: &mut [f32], stride: usize, length: usize) {
    for start in (0..values.len()).filter(|cell| (cell / stride).is_multiple_of(length)) {
        let mut before = values[start];
        for at in 0..length {
            let index = start + at * stride;
            let own = values[index];
            let after = if at + 1 < length { values[index + stride] } else { own };
            values[index] = 0.25 * (before + after) + 0.5 * own;
            before = own;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_blur_keeps_the_sum_away_from_the_ends_and_a_constant_everywhere() {
        let [nx, ny, nz] = [5, 7, 6];
        let mut constant = vec![0.7; nx * ny * nz];
        let mut point = vec![0.0; nx * ny * nz];
        point[(3 * nx + 2) * ny + 3] = 1.0;
        for values in [&mut constant, &mut point] {
            blur(values, 1, ny);
            blur(values, ny, nx);
            blur(values, ny * nx, nz);
        }
        assert!(constant.iter().all(|value| (value - 0.7).abs() < 1e-6));
        assert!((point.iter().sum::<f32>() - 1.0).abs() < 1e-6);
        assert_eq!(point[(3 * nx + 2) * ny + 3], 0.125);
        assert_eq!(point[(4 * nx + 1) * ny + 2], 1.0 / 64.0);
    }
}
