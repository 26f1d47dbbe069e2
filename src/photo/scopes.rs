//! Scopes for pictures: histogram, false colour, zebra and the read-out of a spot, from scene-linear values.

use super::false_color::{FALSE_STOPS, false_color};
use super::picture::Picture;
use crate::color::{ToneTable, display_srgb8, luminance};
use rayon::prelude::*;

/// Value of a correctly metered grey card.
pub const MIDDLE_GREY: f32 = 0.18;
/// Stops above middle grey between which light skin typically lies: a face that is lit as the meter says is about one
/// stop above a grey card. Darker skin lies lower.
const SKIN_STOPS: std::ops::RangeInclusive<f32> = 0.5..=1.5;
/// Pairs of a black and a white stripe of the zebra along the longer side of a picture.
const STRIPE_PAIRS: usize = 120;

/// How the values of a picture are displayed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PictureDisplay {
    /// As a photo.
    #[default]
    Plain,
    /// A colour for each stop about middle grey; clipped white is white, and clipped black is black.
    FalseColor,
    /// As a photo, with stripes where a channel is less than so many thirds of a stop under clipped white.
    Zebra {
        /// Thirds of a stop under clipped white.
        thirds_under: u8,
    },
    /// As a photo, with stripes on all that is as bright as light skin usually is.
    SkinZebra,
}

impl PictureDisplay {
    /// Converts a picture to display values, 8 bits per channel.
    pub fn to_srgb8(self, picture: &Picture) -> Vec<[u8; 3]> {
        match self {
            PictureDisplay::Plain => picture.to_srgb8(),
            PictureDisplay::FalseColor => {
                let (black, white) = (least_value_of(1), least_value_of(255));
                picture.rgb.par_iter().map(|rgb| false_band_color(*rgb, black, white)).collect()
            }
            PictureDisplay::Zebra { thirds_under } => {
                let limit = value_at(clipping_stops() - f32::from(thirds_under) / 3.0);
                striped(picture, |rgb| rgb.into_iter().any(|value| value >= limit))
            }
            PictureDisplay::SkinZebra => {
                let skin = value_at(*SKIN_STOPS.start())..=value_at(*SKIN_STOPS.end());
                striped(picture, |rgb| skin.contains(&luminance(rgb.into())))
            }
        }
    }
}

/// Converts a picture to display values, with stripes on some of its pixels.
fn striped(picture: &Picture, is_striped: impl Fn([f32; 3]) -> bool) -> Vec<[u8; 3]> {
    let stripe = (picture.width.max(picture.height) as usize / (2 * STRIPE_PAIRS)).max(2);
    let (mut codes, width) = (picture.to_srgb8(), picture.width.max(1) as usize);
    for (index, (code, rgb)) in codes.iter_mut().zip(&picture.rgb).enumerate() {
        let along = index % width + index / width;
        if is_striped(*rgb) {
            *code = if (along / stripe).is_multiple_of(2) { [0; 3] } else { [255; 3] };
        }
    }
    codes
}

/// Returns the value that is so many stops above middle grey.
fn value_at(stops: f32) -> f32 {
    MIDDLE_GREY * stops.exp2()
}

/// Returns how many stops the luminance of a pixel is above middle grey; minus infinity for black.
fn stops_from_grey(rgb: [f32; 3]) -> f32 {
    (luminance(rgb.into()) / MIDDLE_GREY).max(0.0).log2()
}

/// Returns how many stops above middle grey a picture is clipped: the least value that is displayed with the highest
/// code.
pub fn clipping_stops() -> f32 {
    (least_value_of(255) / MIDDLE_GREY).log2()
}

/// Returns the least value that is displayed with this code or a higher one.
fn least_value_of(code: u8) -> f32 {
    // The tone curve is monotonic: bisect
    let (mut low, mut high) = (-16.0_f32, 8.0_f32);
    for _ in 0..32 {
        let middle = 0.5 * (low + high);
        if display_srgb8([value_at(middle); 3])[0] >= code { high = middle } else { low = middle }
    }
    value_at(high)
}

/// Returns the false colour of a pixel: that of its luminance in whole stops from middle grey; black where all channels
/// are below `black`, white where one is not below `white`.
fn false_band_color(rgb: [f32; 3], black: f32, white: f32) -> [u8; 3] {
    if rgb.into_iter().any(|value| value >= white) {
        return [255; 3];
    }
    if !rgb.into_iter().any(|value| value >= black) {
        return [0; 3];
    }
    false_color(stops_from_grey(rgb).round().clamp(FALSE_STOPS.0 as f32, FALSE_STOPS.1 as f32))
}

/// Numbers of pixels by display value, from black to white.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// By the display value of the luminance.
    pub luminance: [u32; 256],
    /// By the display values of red, green and blue.
    pub rgb: [[u32; 256]; 3],
    /// Pixels that are black in all channels, and pixels that are white in a channel.
    clipped: [u32; 2],
}

impl Histogram {
    /// Counts the pixels of a picture.
    pub fn of(picture: &Picture) -> Self {
        let mut histogram = Histogram { luminance: [0; 256], rgb: [[0; 256]; 3], clipped: [0; 2] };
        let tone = ToneTable::new();
        for rgb in &picture.rgb {
            let codes = tone.display_srgb8(*rgb);
            let [grey, ..] = tone.display_srgb8([luminance((*rgb).into()); 3]);
            histogram.luminance[usize::from(grey)] += 1;
            for (counts, code) in histogram.rgb.iter_mut().zip(codes) {
                counts[usize::from(code)] += 1;
            }
            histogram.clipped[0] += u32::from(codes == [0; 3]);
            histogram.clipped[1] += u32::from(codes.contains(&255));
        }
        histogram
    }

    /// Returns the share of pixels that are black in all channels.
    pub fn black_share(&self) -> f32 {
        self.share(self.clipped[0])
    }

    /// Returns the share of pixels that are white in a channel.
    pub fn white_share(&self) -> f32 {
        self.share(self.clipped[1])
    }

    /// Returns so many pixels as a share of all.
    fn share(&self, pixels: u32) -> f32 {
        pixels as f32 / self.luminance.iter().sum::<u32>().max(1) as f32
    }
}

/// The mean of a few pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Scene-linear mean.
    pub rgb: [f32; 3],
}

impl Spot {
    /// Half of the side of the square that is averaged, pixels.
    const REACH: u32 = 2;

    /// Averages the pixels around (x, y) that `at` returns, in a picture of so many pixels across and down.
    pub fn around((x, y): (u32, u32), (width, height): (u32, u32), at: impl Fn(u32, u32) -> [f32; 3]) -> Self {
        let range = |middle: u32, end: u32| middle.saturating_sub(Self::REACH)..(middle + Self::REACH + 1).min(end);
        let (mut sum, mut count) = ([0.0; 3], 0.0);
        for y in range(y, height) {
            for x in range(x, width) {
                let rgb = at(x, y);
                sum = [0, 1, 2].map(|channel| sum[channel] + rgb[channel]);
                count += 1.0;
            }
        }
        Spot { rgb: sum.map(|sum| if count > 0.0 { sum / count } else { 0.0 }) }
    }

    /// Returns how many stops it is above middle grey; minus infinity for black.
    pub fn stops(&self) -> f32 {
        stops_from_grey(self.rgb)
    }

    /// Returns the display values of red, green and blue.
    pub fn codes(&self) -> [u8; 3] {
        display_srgb8(self.rgb)
    }

    /// Returns the luminance, as a picture value.
    pub fn luminance(&self) -> f32 {
        luminance(self.rgb.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a picture of one row, with grey values of so many stops above middle grey.
    fn greys(stops: &[f32]) -> Picture {
        let rgb: Vec<[f32; 3]> = stops.iter().map(|stops| [MIDDLE_GREY * stops.exp2(); 3]).collect();
        Picture { width: rgb.len() as u32, height: 1, rgb }
    }

    #[test]
    fn a_picture_is_clipped_where_its_highest_code_begins() {
        let stops = clipping_stops();
        assert!(stops > 3.0 && stops < 4.5, "{stops}");
        let is_white = |stops: f32| display_srgb8([MIDDLE_GREY * stops.exp2(); 3]) == [255; 3];
        assert!(!is_white(stops - 0.01) && is_white(stops + 1e-4));
    }

    #[test]
    fn false_colours_are_bands_of_a_stop_and_clipping_has_none() {
        let picture = greys(&[0.0, 0.4, -0.4, 0.6, 1.4, -5.9, -7.0, clipping_stops() + 0.1]);
        let colors = PictureDisplay::FalseColor.to_srgb8(&picture);
        assert!(colors[0] == colors[1] && colors[0] == colors[2] && colors[3] == colors[4]);
        assert_eq!((colors[0], colors[3], colors[5]), (false_color(0.0), false_color(1.0), false_color(-6.0)));
        assert_eq!((colors[6], colors[7]), (false_color(-6.0), [255; 3]));
        // One channel suffices for clipping
        let extremes = Picture { width: 3, height: 1, rgb: vec![[0.0; 3], [9.0, 0.1, 0.1], [f32::NAN; 3]] };
        assert_eq!(PictureDisplay::FalseColor.to_srgb8(&extremes), [[0; 3], [255; 3], [0; 3]]);
    }

    #[test]
    fn zebras_stripe_what_is_clipped_or_as_bright_as_skin_and_nothing_else() {
        let white = clipping_stops();
        let picture = greys(&[0.0, white - 0.9, white - 0.1, white + 0.1, 1.0]);
        let striped = |display: PictureDisplay| -> Vec<bool> {
            let (plain, shown) = (picture.to_srgb8(), display.to_srgb8(&picture));
            let stripe = |code: &[u8; 3]| *code == [0; 3] || *code == [255; 3];
            plain.iter().zip(&shown).map(|(plain, code)| stripe(code) && (plain != code || stripe(plain))).collect()
        };
        let clipped = |thirds_under| striped(PictureDisplay::Zebra { thirds_under });
        assert_eq!(clipped(0), [false, false, false, true, false]);
        assert_eq!(clipped(1), [false, false, true, true, false]);
        assert_eq!(clipped(3), [false, true, true, true, false]);
        // The clipped pixel is white without any stripe
        assert_eq!(striped(PictureDisplay::SkinZebra), [false, false, false, true, true]);
        let large = Picture { width: 40, height: 1, rgb: vec![[9.0; 3]; 40] };
        let stripes = PictureDisplay::Zebra { thirds_under: 0 }.to_srgb8(&large);
        assert!(stripes.contains(&[0; 3]) && stripes.contains(&[255; 3]));
        assert_eq!(PictureDisplay::Plain.to_srgb8(&picture), picture.to_srgb8());
    }

    #[test]
    fn the_histogram_counts_each_pixel_once_and_knows_what_is_clipped() {
        let mut picture = greys(&[0.0, 0.0, 9.0, 1.0]);
        picture.rgb.push([0.0; 3]);
        picture.rgb.push([9.0, 0.0, 0.0]);
        (picture.width, picture.height) = (6, 1);
        let histogram = Histogram::of(&picture);
        // Middle grey is code 118
        assert_eq!((histogram.luminance[118], histogram.rgb[1][118]), (2, 2));
        for counts in histogram.rgb.iter().chain([&histogram.luminance]) {
            assert_eq!(counts.iter().sum::<u32>(), 6);
        }
        assert_eq!((histogram.black_share(), histogram.white_share()), (1.0 / 6.0, 2.0 / 6.0));
        let empty = Histogram::of(&Picture::default());
        assert_eq!((empty.black_share(), empty.white_share()), (0.0, 0.0));
    }

    #[test]
    fn a_spot_is_the_mean_of_the_pixels_around_it_that_exist() {
        let picture = greys(&[0.0, 1.0, 2.0, 3.0]);
        let spot = |x| Spot::around((x, 0), (4, 1), |x, y| picture.at(x, y));
        assert!((spot(0).luminance() / (MIDDLE_GREY * 7.0 / 3.0) - 1.0).abs() < 1e-5);
        assert!((spot(3).stops() - (14.0_f32 / 3.0).log2()).abs() < 1e-5);
        assert_eq!(spot(0).codes(), display_srgb8(spot(0).rgb));
        assert_eq!(Spot::around((0, 0), (0, 0), |_, _| [1.0; 3]).rgb, [0.0; 3]);
    }
}
