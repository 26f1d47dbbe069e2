//! Pictures of what surrounds a studio: the light from every direction, with tables to sample it by importance.

use glam::Vec3;
use std::f32::consts::{PI, TAU};
use std::hash::{Hash, Hasher};

/// Steps towards the plane that gets most light.
const PLANE_STEPS: u32 = 12;
/// Cells across of the coarse picture on which that plane is searched.
const COARSE_WIDTH: u32 = 128;

/// An equirectangular picture of the light from every direction. Its middle lies towards -Z, its left half towards -X,
/// its top towards +Y. Pixels are even cells of directions.
#[derive(Clone, Debug)]
pub struct EnvironmentMap {
    width: u32,
    height: u32,
    /// Rows from the top.
    rgb: Vec<[f32; 3]>,
    /// Probability of all pixels up to the end of a row.
    row_ends: Vec<f32>,
    /// Probability, within its row, of all pixels up to the end of one.
    pixel_ends: Vec<f32>,
    peak_illuminance: f32,
    peak_direction: Vec3,
    mean: Vec3,
    sun: Option<BrightSpot>,
}

/// A small bright spot that gives much of the light: the sun, or a lamp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BrightSpot {
    /// Unit direction of its middle.
    pub direction: Vec3,
    /// Its light on a plane that faces it, for pixels in cd/m2: lx.
    pub irradiance: Vec3,
    /// Half the angle of an even disc of its size, radians.
    pub half_angle_rad: f32,
    /// Mean colour around it.
    around: Vec3,
    /// Direction of the brightest pixel, and the cosine of the radius in which pixels belong to the spot.
    centre: Vec3,
    cos_radius: f32,
    /// Least luminance of its pixels.
    least: f32,
}

impl BrightSpot {
    /// Radius in which pixels belong to the spot, degrees.
    const RADIUS_DEG: f32 = 5.0;
    /// Least luminance of a pixel of the spot, over that of the brightest.
    const LEAST: f32 = 0.05;
    /// Least luminance of a pixel of the spot, over the mean of the map.
    const CONTRAST: f32 = 4.0;
    /// Least part of the illuminance of the map that a spot gives.
    const LEAST_PART: f32 = 0.2;
    /// Largest part of its own light that comes from around the spot: more is a window.
    const MOST_AROUND: f32 = 0.25;

    /// Returns true if a pixel of a colour in a unit direction belongs to the spot.
    fn has(&self, direction: Vec3, color: Vec3) -> bool {
        direction.dot(self.centre) >= self.cos_radius && crate::color::luminance(color) >= self.least
    }
}

impl EnvironmentMap {
    /// Returns the map of a picture, rows from the top. Returns none for a picture without light, of the wrong number of
    /// pixels, or with values that are negative or not finite.
    pub fn new(width: u32, height: u32, rgb: Vec<[f32; 3]>) -> Option<Self> {
        let is_usable = |value: &f32| value.is_finite() && *value >= 0.0;
        let pixels = (width as usize).checked_mul(height as usize)?;
        if pixels == 0 || rgb.len() != pixels || !rgb.iter().flatten().all(is_usable) {
            return None;
        }
        let mut map = EnvironmentMap {
            width,
            height,
            rgb,
            row_ends: Vec::new(),
            pixel_ends: Vec::new(),
            peak_illuminance: 0.0,
            peak_direction: Vec3::Y,
            mean: Vec3::ZERO,
            sun: None,
        };
        map.tabulate();
        (map.peak_illuminance > 0.0 && map.peak_illuminance.is_finite()).then_some(map)
    }

    /// Returns width and height, pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// Returns the pixels, rows from the top.
    pub fn rgb(&self) -> &[[f32; 3]] {
        &self.rgb
    }

    /// Returns the illuminance on the plane that gets most of the light, for pixels in cd/m2: pi for an even map of 1,
    /// the luminance of a single bright pixel times its solid angle.
    pub fn peak_illuminance(&self) -> f32 {
        self.peak_illuminance
    }

    /// Returns the unit normal of that plane.
    pub fn peak_direction(&self) -> Vec3 {
        self.peak_direction
    }

    /// Returns the mean colour over all directions.
    pub fn mean(&self) -> Vec3 {
        self.mean
    }

    /// Returns the small bright spot that gives much of the light, if there is one.
    pub fn sun(&self) -> Option<&BrightSpot> {
        self.sun.as_ref()
    }

    /// Returns the mean colour over all directions without the sun.
    pub fn mean_without_sun(&self) -> Vec3 {
        let sun = self.sun.map_or(Vec3::ZERO, |sun| sun.irradiance / (4.0 * PI));
        (self.mean - sun).max(Vec3::ZERO)
    }

    /// Returns the colour in a unit direction, that around the sun in its place.
    pub fn without_sun_at(&self, direction: Vec3) -> Vec3 {
        let color = self.at(direction);
        match &self.sun {
            Some(sun) if sun.has(direction, color) => sun.around,
            _ => color,
        }
    }

    /// Returns the colour in a unit direction.
    pub fn at(&self, direction: Vec3) -> Vec3 {
        self.rgb[self.index_of(direction)].into()
    }

    /// Returns the density with which [`EnvironmentMap::sample`] samples a unit direction, 1/sr.
    pub fn pdf(&self, direction: Vec3) -> f32 {
        let index = self.index_of(direction);
        let row = index / self.width as usize;
        self.pixel_probability(index) / self.solid_angle_sr(row as u32)
    }

    /// Samples a direction by the luminance of the pixels. Returns it with its density, 1/sr.
    pub fn sample(&self, [u, v]: [f32; 2]) -> Option<(Vec3, f32)> {
        // Choose a row, and a pixel in it
        let row = find(&self.row_ends, v);
        let row_start = row.checked_sub(1).map_or(0.0, |above| self.row_ends[above]);
        let row_part = ((v - row_start) / (self.row_ends[row] - row_start).max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
        let width = self.width as usize;
        let ends = &self.pixel_ends[row * width..][..width];
        let column = find(ends, u);
        let start = column.checked_sub(1).map_or(0.0, |left| ends[left]);
        let part = ((u - start) / (ends[column] - start).max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
        // Evenly over its solid angle: by azimuth and height
        let [top, bottom] = self.heights(row as u32);
        let height = top + (bottom - top) * row_part;
        let direction = self.direction((column as f32 + part) / self.width as f32, height);
        let pdf = self.pixel_probability(row * width + column) / self.solid_angle_sr(row as u32);
        (pdf > 0.0).then_some((direction, pdf))
    }

    /// Adds the pixels to a hash.
    pub fn hash_content(&self, hasher: &mut impl Hasher) {
        (self.width, self.height).hash(hasher);
        self.rgb.iter().flatten().for_each(|value| value.to_bits().hash(hasher));
    }

    /// Returns the heights (cosines against +Y) of the upper and the lower edge of a row.
    fn heights(&self, row: u32) -> [f32; 2] {
        [row, row + 1].map(|edge| (PI * edge as f32 / self.height as f32).cos())
    }

    fn solid_angle_sr(&self, row: u32) -> f32 {
        // The difference of the cosines without cancellation near the poles
        let middle = PI * (row as f32 + 0.5) / self.height as f32;
        TAU / self.width as f32 * 2.0 * middle.sin() * (0.5 * PI / self.height as f32).sin()
    }

    /// Returns the direction at a part of the width and a height.
    fn direction(&self, across: f32, height: f32) -> Vec3 {
        let (sin, cos) = (TAU * (across - 0.5)).sin_cos();
        let out = (1.0 - height * height).max(0.0).sqrt();
        Vec3::new(sin * out, height, -cos * out)
    }

    fn index_of(&self, direction: Vec3) -> usize {
        let across = 0.5 + direction.x.atan2(-direction.z) / TAU;
        let down = crate::math::safe_acos(direction.y) / PI;
        let cell = |part: f32, cells: u32| ((part * cells as f32) as u32).min(cells - 1) as usize;
        cell(down, self.height) * self.width as usize + cell(across, self.width)
    }

    fn pixel_probability(&self, index: usize) -> f32 {
        let (row, column) = (index / self.width as usize, index % self.width as usize);
        let difference = |ends: &[f32], at: usize| ends[at] - at.checked_sub(1).map_or(0.0, |before| ends[before]);
        let width = self.width as usize;
        difference(&self.row_ends, row) * difference(&self.pixel_ends[row * width..][..width], column)
    }

    /// Fills the tables.
    fn tabulate(&mut self) {
        let luminance = |rgb: &[f32; 3]| f64::from(crate::color::luminance(Vec3::from(*rgb)));
        let (mut rows, mut total, mut mean) = (Vec::new(), 0.0, glam::DVec3::ZERO);
        for (row, pixels) in (0..).zip(self.rgb.chunks_exact(self.width as usize)) {
            let sum: f64 = pixels.iter().map(luminance).sum();
            let mut so_far = 0.0;
            let end = |pixel| {
                so_far += luminance(pixel);
                if sum > 0.0 { (so_far / sum) as f32 } else { 0.0 }
            };
            self.pixel_ends.extend(pixels.iter().map(end));
            let solid_angle = f64::from(self.solid_angle_sr(row));
            total += sum * solid_angle;
            rows.push(total);
            let colors = pixels.iter().map(|rgb| Vec3::from(*rgb).as_dvec3()).sum::<glam::DVec3>();
            mean += colors * (solid_angle / (4.0 * std::f64::consts::PI));
        }
        self.row_ends = rows.into_iter().map(|sum| if total > 0.0 { (sum / total) as f32 } else { 0.0 }).collect();
        self.mean = mean.as_vec3();
        (self.peak_direction, self.peak_illuminance) = self.brightest_plane();
        self.sun = self.find_sun();
    }

    /// Finds a small bright spot about the brightest pixel.
    fn find_sun(&self) -> Option<BrightSpot> {
        let luminance = |index: usize| crate::color::luminance(self.rgb[index].into());
        let brightest = (0..self.rgb.len()).max_by(|a, b| luminance(*a).total_cmp(&luminance(*b)))?;
        let least = BrightSpot::LEAST * luminance(brightest);
        if least < BrightSpot::CONTRAST * crate::color::luminance(self.mean) {
            return None;
        }
        let (width, middle) = (self.width as usize, |at: usize, of: u32| (at as f32 + 0.5) / of as f32);
        let direction = |index: usize| {
            self.direction(middle(index % width, self.width), (PI * middle(index / width, self.height)).cos())
        };
        // One pixel around the brightest at least
        let radius = BrightSpot::RADIUS_DEG.to_radians().max(1.5 * PI / self.height as f32);
        let (centre, cos_radius) = (direction(brightest), radius.cos());
        let mut sun = BrightSpot {
            direction: Vec3::ZERO,
            irradiance: Vec3::ZERO,
            half_angle_rad: 0.0,
            around: Vec3::ZERO,
            centre,
            cos_radius,
            least,
        };
        let (mut squares, mut around, mut around_sr, mut bright_around) = (0.0, Vec3::ZERO, 0.0, 0.0);
        for index in 0..self.rgb.len() {
            let towards = direction(index);
            if towards.dot(centre) < (2.0 * radius).cos() {
                continue;
            }
            let (color, solid_angle) = (Vec3::from(self.rgb[index]), self.solid_angle_sr((index / width) as u32));
            if sun.has(towards, color) {
                sun.irradiance += color * solid_angle;
                sun.direction += towards * (luminance(index) * solid_angle);
                squares += luminance(index).powi(2) * solid_angle;
            } else if luminance(index) < least {
                around += color * solid_angle;
                around_sr += solid_angle;
            } else {
                bright_around += luminance(index) * solid_angle;
            }
        }
        let lux = crate::color::luminance(sun.irradiance);
        sun.direction = sun.direction.try_normalize()?;
        sun.around = if around_sr > 0.0 { around / around_sr } else { Vec3::ZERO };
        // The solid angle of an even disc with the same sums
        sun.half_angle_rad = (lux * lux / (squares * PI)).sqrt();
        let is_dominant = lux >= BrightSpot::LEAST_PART * self.peak_illuminance;
        (is_dominant && bright_around <= BrightSpot::MOST_AROUND * lux).then_some(sun)
    }

    /// Returns the normal of the plane that gets most light, and its illuminance. A plane is best if its normal is that of
    /// the light's vector over its hemisphere: go there from several starts.
    fn brightest_plane(&self) -> (Vec3, f32) {
        let cells = self.coarse();
        let vector = |normal: Vec3| -> Vec3 { cells.iter().filter(|cell| cell.dot(normal) > 0.0).sum() };
        let brightest = cells.iter().copied().max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
        let starts = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
        let mut best = (Vec3::Y, 0.0_f32);
        for start in starts.into_iter().chain(brightest) {
            let mut normal = start.normalize_or(Vec3::Y);
            for _ in 0..PLANE_STEPS {
                normal = vector(normal).normalize_or(normal);
            }
            let illuminance = vector(normal).dot(normal);
            if illuminance > best.1 {
                best = (normal, illuminance);
            }
        }
        best
    }

    /// Returns the vectors of the light of coarse cells: direction times luminance times solid angle.
    fn coarse(&self) -> Vec<Vec3> {
        let step = self.width.div_ceil(COARSE_WIDTH).max(1);
        // Large pixels are divided: their middle does not stand for them
        let parts = COARSE_WIDTH.div_ceil(self.width).clamp(1, 16);
        let (columns, rows) = (self.width.div_ceil(step), self.height.div_ceil(step));
        let mut cells = vec![Vec3::ZERO; (columns * rows * parts * parts) as usize];
        for row in 0..self.height {
            let [top, bottom] = self.heights(row);
            for column in 0..self.width {
                let pixel = self.rgb[(row * self.width + column) as usize];
                let amount = crate::color::luminance(pixel.into()) * self.solid_angle_sr(row) / (parts * parts) as f32;
                let cell = (row / step * columns + column / step) as usize;
                for part in 0..parts * parts {
                    let [across, down] = [part % parts, part / parts].map(|at| (at as f32 + 0.5) / parts as f32);
                    let height = top + (bottom - top) * down;
                    let direction = self.direction((column as f32 + across) / self.width as f32, height);
                    cells[cell * (parts * parts) as usize + part as usize] += direction * amount;
                }
            }
        }
        cells
    }
}

/// Returns the first entry of rising ends that is above a number; the last one that rises if there is none.
fn find(ends: &[f32], u: f32) -> usize {
    let at = ends.partition_point(|end| *end <= u);
    let last = ends.last().copied().unwrap_or_default();
    if at < ends.len() { at } else { ends.partition_point(|end| *end < last).min(ends.len() - 1) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::{ChiSquare, TestRng};

    fn noisy() -> EnvironmentMap {
        let mut rng = TestRng::new(71);
        let pixel = |i: usize| if i % 7 == 3 { [0.0; 3] } else { [rng.uniform(), 2.0 * rng.uniform().powi(4), 0.3] };
        EnvironmentMap::new(16, 8, (0..128).map(pixel).collect()).unwrap()
    }

    #[test]
    fn sampled_directions_follow_their_pdf_and_its_integral_is_one() {
        let map = noisy();
        let mut rng = TestRng::new(72);
        let mut counts = vec![0.0; 128];
        const SAMPLES: usize = 60_000;
        for _ in 0..SAMPLES {
            let (direction, pdf) = map.sample(rng.unit_square().into()).unwrap();
            assert!((direction.length() - 1.0).abs() < 1e-5);
            let again = map.pdf(direction);
            // At the edge of a pixel, the direction may round into the next one
            counts[map.index_of(direction)] += 1.0;
            assert!((again - pdf).abs() < 1e-4 * pdf || rng.uniform() < 0.01, "{pdf} and {again}");
        }
        let mut test = ChiSquare::default();
        let expected = |index: usize| f64::from(map.pixel_probability(index));
        assert!(((0..128).map(expected).sum::<f64>() - 1.0).abs() < 1e-5);
        (0..128).filter(|i| expected(*i) > 0.0).for_each(|i| test.add_bin(counts[i], expected(i) * SAMPLES as f64));
        assert!(test.p_value() > 1e-4, "p = {}", test.p_value());
        assert!((0..128).filter(|i| expected(*i) <= 0.0).all(|i| counts[i] < 5.0), "black pixels are not sampled");
    }

    #[test]
    fn an_even_map_gives_pi_and_a_single_pixel_its_solid_angle() {
        let even = EnvironmentMap::new(64, 32, vec![[1.0; 3]; 2048]).unwrap();
        assert!((even.peak_illuminance() / PI - 1.0).abs() < 2e-3, "{}", even.peak_illuminance());
        assert!((even.mean() - Vec3::ONE).abs().max_element() < 1e-5);
        // Also of a few large pixels
        let coarse = EnvironmentMap::new(8, 4, vec![[1.0; 3]; 32]).unwrap();
        assert!((coarse.peak_illuminance() / PI - 1.0).abs() < 5e-3, "{}", coarse.peak_illuminance());
        let mut pixels = vec![[0.0; 3]; 2048];
        pixels[10 * 64 + 40] = [500.0; 3];
        let sun = EnvironmentMap::new(64, 32, pixels).unwrap();
        let solid_angle = sun.solid_angle_sr(10);
        assert!((sun.peak_illuminance() / (500.0 * solid_angle) - 1.0).abs() < 1e-3);
        // 10.5 rows of 32 from the top, 8.5 columns of 64 to the right of the middle
        let expected = sun.direction(40.5 / 64.0, (PI * 10.5 / 32.0).cos());
        assert!((sun.peak_direction() - expected).length() < 0.01, "{}", sun.peak_direction());
        assert!(expected.x > 0.0 && expected.z < 0.0 && expected.y > 0.0);
    }

    #[test]
    fn a_small_bright_spot_is_the_sun_and_a_window_is_none() {
        // A sky of 1 with a spot of 2 x 2 pixels and a window of 30 degrees
        let map = |spot: f32, window: f32| {
            let mut pixels = vec![[1.0, 1.0, 2.0]; 256 * 128];
            for row in [40, 41] {
                pixels[row * 256 + 160..][..2].fill([spot; 3]);
            }
            (60..80).for_each(|row| pixels[row * 256 + 30..][..20].fill([window; 3]));
            EnvironmentMap::new(256, 128, pixels).unwrap()
        };
        let sunny = map(2000.0, 1.0);
        let sun = sunny.sun().unwrap();
        let solid_angle = 2.0 * (sunny.solid_angle_sr(40) + sunny.solid_angle_sr(41));
        assert!((sun.irradiance / (2000.0 * solid_angle) - 1.0).abs().max_element() < 1e-3, "{sun:?}");
        assert!((sun.half_angle_rad - (solid_angle / PI).sqrt()).abs() < 1e-4);
        let expected = sunny.direction(161.0 / 256.0, (PI * 41.0 / 128.0).cos());
        assert!(sun.direction.distance(expected) < 2e-3, "{} for {expected}", sun.direction);
        // Without it, the sky is left
        let sky = Vec3::new(1.0, 1.0, 2.0);
        assert!(sunny.mean_without_sun().distance(sky) < 0.03, "{}", sunny.mean_without_sun());
        assert_eq!(
            [sunny.without_sun_at(sun.direction), sunny.without_sun_at(Vec3::Y)].map(|c| c.distance(sky) < 1e-4),
            [true; 2]
        );
        assert_eq!(sunny.at(sun.direction), Vec3::splat(2000.0));
        for (spot, window) in [(1.0, 1.0), (1.0, 200.0), (30.0, 1.0)] {
            assert!(map(spot, window).sun().is_none(), "{spot} {window}");
        }
    }

    #[test]
    fn pictures_without_light_and_with_impossible_values_are_no_maps() {
        assert!(EnvironmentMap::new(2, 1, vec![[0.0; 3]; 2]).is_none());
        assert!(EnvironmentMap::new(2, 2, vec![[1.0; 3]; 2]).is_none());
        for bad in [f32::NAN, f32::INFINITY, -1.0] {
            assert!(EnvironmentMap::new(1, 1, vec![[1.0, bad, 1.0]]).is_none());
        }
    }
}
