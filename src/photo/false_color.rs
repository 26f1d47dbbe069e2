//! False colours of brightness, shared by illuminance in the live view and by rendered pictures.

/// Lowest and highest stop of the false colour scale.
pub const FALSE_STOPS: (i32, i32) = (-6, 3);

/// sRGB colours of whole stops from the lowest to the highest; twin of `false_color.wgsl`.
const FALSE_COLORS: [[f32; 3]; 10] = [
    [0.05, 0.03, 0.10],
    [0.20, 0.08, 0.36],
    [0.23, 0.22, 0.66],
    [0.13, 0.43, 0.78],
    [0.10, 0.62, 0.70],
    [0.16, 0.70, 0.42],
    [0.55, 0.78, 0.22],
    [0.95, 0.83, 0.16],
    [0.97, 0.53, 0.12],
    [0.85, 0.15, 0.16],
];

/// Returns the sRGB false colour of a brightness in stops relative to the exposure, in steps of a third of a stop.
pub fn false_color(stops: f32) -> [u8; 3] {
    let (low, high) = (FALSE_STOPS.0 as f32, FALSE_STOPS.1 as f32);
    let thirds = ((3.0 * stops).round() / 3.0).clamp(low, high) - low;
    let index = (thirds.floor() as usize).min(FALSE_COLORS.len() - 2);
    let fraction = thirds - index as f32;
    std::array::from_fn(|i| {
        let value = FALSE_COLORS[index][i] + (FALSE_COLORS[index + 1][i] - FALSE_COLORS[index][i]) * fraction;
        (value * 255.0).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn false_colours_change_in_thirds_of_a_stop_and_are_clamped() {
        assert_eq!(false_color(0.1), false_color(-0.1));
        assert_ne!(false_color(0.2), false_color(0.1));
        assert_eq!(false_color(9.0), false_color(FALSE_STOPS.1 as f32));
        assert_eq!(false_color(f32::NEG_INFINITY), false_color(FALSE_STOPS.0 as f32));
        let all: Vec<_> = (FALSE_STOPS.0..=FALSE_STOPS.1).map(|stop| false_color(stop as f32)).collect();
        assert!(all.windows(2).all(|pair| pair[0] != pair[1]));
        assert_eq!(all.len(), FALSE_COLORS.len());
    }
}
