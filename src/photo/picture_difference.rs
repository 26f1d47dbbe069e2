//! The difference of two pictures in stops, as numbers and as false colours.

use super::picture::Picture;
use super::scopes::MIDDLE_GREY;
use crate::color::luminance;

/// Largest difference with a colour of its own, stops.
pub const DIFFERENCE_STOPS: i32 = 3;
/// Differences up to this many stops have the colour of none.
const EQUAL_STOPS: f32 = 1.0 / 6.0;
/// Luminance below which all shadows are equal: eight stops below middle grey.
const LEAST: f32 = MIDDLE_GREY / 256.0;

/// Colours of whole stops from `-DIFFERENCE_STOPS` to `DIFFERENCE_STOPS`, sRGB: darker blue, equal grey, brighter orange.
const COLORS: [[f32; 3]; 7] = [
    [0.10, 0.16, 0.55],
    [0.16, 0.36, 0.78],
    [0.36, 0.56, 0.84],
    [0.42, 0.42, 0.42],
    [0.86, 0.60, 0.34],
    [0.93, 0.45, 0.12],
    [0.86, 0.16, 0.08],
];

/// Returns how many stops the luminance of a scene-linear pixel is above that of another one. Values below eight stops
/// under middle grey, where noise decides, count as equal.
pub fn stops_above(rgb: [f32; 3], other: [f32; 3]) -> f32 {
    let [value, other] = [rgb, other].map(|rgb| luminance(rgb.into()).max(LEAST));
    (value / other).log2()
}

/// Returns the sRGB colour of a difference in stops, in steps of a third of a stop.
pub fn difference_color(stops: f32) -> [u8; 3] {
    let most = DIFFERENCE_STOPS as f32;
    let thirds = ((3.0 * stops).round() / 3.0).clamp(-most, most);
    let place = if stops.abs() <= EQUAL_STOPS { most } else { thirds + most };
    let index = (place.floor() as usize).min(COLORS.len() - 2);
    let fraction = place - index as f32;
    std::array::from_fn(|c| {
        let value = COLORS[index][c] + (COLORS[index + 1][c] - COLORS[index][c]) * fraction;
        (value * 255.0).round() as u8
    })
}

/// The difference of a picture from another one.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureDifference {
    /// Width and height, pixels.
    pub size: (u32, u32),
    /// The colour of each pixel, rows from the top.
    pub srgb8: Vec<[u8; 3]>,
    /// Mean of the absolute differences, stops.
    pub mean_stops: f32,
}

impl PictureDifference {
    /// Compares two pictures. None if their sizes differ.
    pub fn between(picture: &Picture, other: &Picture) -> Option<Self> {
        let size = (picture.width, picture.height);
        if size != (other.width, other.height) {
            return None;
        }
        let stops = picture.rgb.iter().zip(&other.rgb).map(|(rgb, other)| stops_above(*rgb, *other));
        let mut sum = 0.0_f64;
        let srgb8 = stops.inspect(|stops| sum += f64::from(stops.abs())).map(difference_color).collect();
        Some(PictureDifference { size, srgb8, mean_stops: (sum / picture.rgb.len().max(1) as f64) as f32 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(value: f32) -> [f32; 3] {
        [value; 3]
    }

    #[test]
    fn a_difference_is_told_in_stops_of_luminance() {
        assert!((stops_above(grey(0.36), grey(0.18)) - 1.0).abs() < 1e-6);
        assert!((stops_above(grey(0.09), grey(0.36)) + 2.0).abs() < 1e-6);
        assert_eq!(stops_above(grey(0.0), grey(1e-5)), 0.0, "noise in black is no difference");
        assert!(stops_above(grey(f32::MIN_POSITIVE), grey(0.18)).is_finite());
    }

    #[test]
    fn colours_change_in_thirds_and_tell_the_sign() {
        let equal = difference_color(0.0);
        assert_eq!([difference_color(0.15), difference_color(-0.15)], [equal; 2]);
        assert_ne!(difference_color(0.3), equal);
        let all: Vec<_> = (-9..=9).map(|thirds| difference_color(thirds as f32 / 3.0)).collect();
        assert!(all.windows(2).all(|pair| pair[0] != pair[1]));
        assert_eq!(difference_color(f32::INFINITY), all[18]);
        assert!(difference_color(2.0)[0] > difference_color(2.0)[2], "brighter is warm");
        assert!(difference_color(-2.0)[0] < difference_color(-2.0)[2], "darker is cold");
    }

    #[test]
    fn pictures_of_other_sizes_have_no_difference() {
        let picture = |width, value| Picture { width, height: 1, rgb: vec![grey(value); width as usize] };
        assert_eq!(PictureDifference::between(&picture(2, 1.0), &picture(3, 1.0)), None);
        let difference = PictureDifference::between(&picture(2, 0.5), &picture(2, 0.25)).unwrap();
        assert_eq!((difference.size, difference.srgb8), ((2, 1), vec![difference_color(1.0); 2]));
        assert!((difference.mean_stops - 1.0).abs() < 1e-6);
    }
}
