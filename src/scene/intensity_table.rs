//! Measured luminous intensity distributions, as photometric files (IES LM-63, EULUMDAT) state them.

use super::Emitter;
use glam::Vec3;
use std::f64::consts::PI;
use std::hash::{Hash, Hasher};

/// Luminous intensity by direction, at the vertical and horizontal angles of a file; bilinear in the angles between.
///
/// In the light's frame (right +X, up +Y, back +Z) the vertical angle counts from the axis -Z, the nadir of type C
/// photometry and the axis of the beam; the horizontal angle counts from +X towards +Y. The direction at (v, h) is
/// (sin v cos h, sin v sin h, -cos v). Outside of the vertical angles of the file there is no light.
#[derive(Clone, Debug, PartialEq)]
pub struct IntensityTable {
    vertical: Axis,
    /// One angle of 0 for a distribution of revolution; otherwise from 0 to 360, whose planes are the same.
    horizontal: Axis,
    /// Candela, plane by plane: all vertical angles of the first horizontal angle, then of the next.
    candela: Vec<f32>,
    peak_cd: f32,
    flux_lm: f32,
    /// Relative output by the tilt of the axis from straight down, degrees, in ascending order; empty if the lamp burns
    /// alike in all positions.
    pub tilt: Vec<[f32; 2]>,
    /// Name of the luminaire; empty if the file has none.
    pub luminaire: String,
    /// The luminous opening, as an emitter of its size: a point where the file states none.
    pub opening: Emitter,
}

/// The angles along one axis of a table, degrees, ascending.
#[derive(Clone, Debug, PartialEq)]
struct Axis {
    degrees: Vec<f32>,
    /// Angles per degree, if they are evenly spaced.
    per_degree: Option<f32>,
}

impl Axis {
    fn new(degrees: Vec<f32>) -> Self {
        let steps = degrees.len().saturating_sub(1);
        let per_degree = match (degrees.first(), degrees.last()) {
            (Some(first), Some(last)) if last > first => Some(steps as f32 / (last - first)),
            _ => None,
        };
        let is_even = |per_degree: &f32| {
            let at = |(index, degree): (usize, &f32)| ((degree - degrees[0]) * per_degree - index as f32).abs() < 1e-3;
            degrees.iter().enumerate().all(at)
        };
        let per_degree = per_degree.filter(is_even);
        Axis { degrees, per_degree }
    }

    /// Returns the interval of an angle, as the index of its first end and the part of it before the angle; none outside
    /// of the axis.
    #[inline]
    fn interval(&self, degree: f32) -> Option<(usize, f32)> {
        let (&first, &last) = (self.degrees.first()?, self.degrees.last()?);
        // Rounding of an angle must not lose the last row
        if !(degree >= first - 1e-3 && degree <= last + 1e-3) {
            return None;
        }
        let intervals = self.degrees.len() - 1;
        if intervals == 0 {
            return Some((0, 0.0));
        }
        let index = match self.per_degree {
            Some(per_degree) => ((degree - first) * per_degree) as usize,
            None => self.degrees.partition_point(|&angle| angle <= degree).saturating_sub(1),
        };
        let index = index.min(intervals - 1);
        let (low, high) = (self.degrees[index], self.degrees[index + 1]);
        Some((index, ((degree - low) / (high - low)).clamp(0.0, 1.0)))
    }
}

impl IntensityTable {
    /// Largest number of intensities.
    pub const MOST_VALUES: usize = 1 << 20;

    /// Creates a table from its angles, degrees, and its intensities, candela, plane by plane. The horizontal angles are
    /// a single 0, or go from 0 to 360.
    ///
    /// # Errors
    /// A sentence, if there are no values or too many, if angles do not ascend or are out of range, if an intensity is
    /// negative or not finite, or if there is no light at all.
    pub fn new(vertical_deg: Vec<f32>, horizontal_deg: Vec<f32>, candela: Vec<f32>) -> Result<Self, String> {
        let ascends = |angles: &[f32]| angles.windows(2).all(|pair| pair[0] < pair[1]);
        if vertical_deg.len() < 2 || horizontal_deg.is_empty() {
            return Err("at least two vertical angles and one horizontal angle are needed".to_owned());
        }
        if candela.len() > Self::MOST_VALUES {
            return Err(format!("{} intensities are too many; at most {} are read", candela.len(), Self::MOST_VALUES));
        }
        if vertical_deg.len() * horizontal_deg.len() != candela.len() {
            return Err(format!("{} intensities do not fill the table of angles", candela.len()));
        }
        let in_range = |angles: &[f32], most: f32| angles.iter().all(|angle| (0.0..=most).contains(angle));
        if !ascends(&vertical_deg) || !in_range(&vertical_deg, 180.0) {
            return Err("the vertical angles do not ascend from 0 to at most 180 degrees".to_owned());
        }
        let is_closed =
            horizontal_deg == [0.0] || (horizontal_deg.first() == Some(&0.0) && horizontal_deg.last() == Some(&360.0));
        if !ascends(&horizontal_deg) || !is_closed {
            return Err("the horizontal angles do not ascend around the whole circle".to_owned());
        }
        if let Some(bad) = candela.iter().find(|value| !(value.is_finite() && **value >= 0.0 && **value <= 1e12)) {
            return Err(format!("{bad} cd is no intensity"));
        }
        let peak_cd = candela.iter().copied().fold(0.0, f32::max);
        let mut table = IntensityTable {
            vertical: Axis::new(vertical_deg),
            horizontal: Axis::new(horizontal_deg),
            candela,
            peak_cd,
            flux_lm: 0.0,
            tilt: Vec::new(),
            luminaire: String::new(),
            opening: Emitter::Point,
        };
        table.flux_lm = table.integrate(0.0) as f32;
        if table.flux_lm > 0.0 && table.flux_lm.is_finite() {
            Ok(table)
        } else {
            Err("every intensity is 0: it gives no light".to_owned())
        }
    }

    /// Returns the largest intensity, cd.
    pub fn peak_cd(&self) -> f32 {
        self.peak_cd
    }

    /// Returns the luminous flux, lm: the exact integral of the interpolated intensity.
    pub fn flux_lm(&self) -> f32 {
        self.flux_lm
    }

    /// Returns the luminous flux at more than 90 degrees from the axis, lm.
    pub fn flux_behind_lm(&self) -> f32 {
        self.integrate(90.0) as f32
    }

    /// Returns flux over peak intensity, sr.
    pub fn solid_angle_sr(&self) -> f32 {
        self.flux_lm / self.peak_cd
    }

    /// Returns the vertical angles, degrees.
    pub fn vertical_deg(&self) -> &[f32] {
        &self.vertical.degrees
    }

    /// Returns the horizontal angles, degrees: a single 0 for a distribution of revolution, else from 0 to 360.
    pub fn horizontal_deg(&self) -> &[f32] {
        &self.horizontal.degrees
    }

    /// Returns the intensities at the vertical angles of one horizontal angle, cd.
    pub fn plane(&self, horizontal: usize) -> &[f32] {
        let rows = self.vertical.degrees.len();
        &self.candela[horizontal * rows..(horizontal + 1) * rows]
    }

    /// Returns the intensity in a unit direction of the light's frame, cd.
    pub fn candela_towards(&self, direction_light: Vec3) -> f32 {
        let Vec3 { x, y, z } = direction_light;
        let horizontal_deg = if self.horizontal.degrees.len() == 1 { 0.0 } else { y.atan2(x).to_degrees() };
        self.candela_at(x.hypot(y).atan2(-z).to_degrees(), horizontal_deg)
    }

    /// Returns the intensity at angles in degrees, cd; 0 outside of the vertical angles of the file.
    pub fn candela_at(&self, vertical_deg: f32, horizontal_deg: f32) -> f32 {
        let Some((row, down)) = self.vertical.interval(vertical_deg) else { return 0.0 };
        let along = |plane: usize| {
            let plane = self.plane(plane);
            plane[row] + (plane[row + 1] - plane[row]) * down
        };
        if self.horizontal.degrees.len() == 1 {
            return along(0);
        }
        let Some((plane, across)) = self.horizontal.interval(horizontal_deg.rem_euclid(360.0)) else { return 0.0 };
        let (one, other) = (along(plane), along(plane + 1));
        one + (other - one) * across
    }

    /// Hashes everything that its light depends on.
    pub fn hash_content(&self, hasher: &mut impl Hasher) {
        let axes = [&self.vertical.degrees, &self.horizontal.degrees, &self.candela];
        axes.into_iter().for_each(|values| values.iter().for_each(|value| value.to_bits().hash(hasher)));
        self.tilt.as_flattened().iter().for_each(|value| value.to_bits().hash(hasher));
    }

    /// Returns the relative output of a lamp whose axis is tilted from straight down by an angle, degrees.
    pub fn tilt_factor(&self, tilt_deg: f32) -> f32 {
        let (Some(&[first, factor]), Some(&[_, last])) = (self.tilt.first(), self.tilt.last()) else { return 1.0 };
        if tilt_deg <= first {
            return factor;
        }
        let pair = self.tilt.windows(2).find(|pair| tilt_deg <= pair[1][0]);
        pair.map_or(last, |pair| {
            let ([from, one], [to, other]) = (pair[0], pair[1]);
            one + (other - one) * ((tilt_deg - from) / (to - from)).clamp(0.0, 1.0)
        })
    }

    /// Integrates the intensity over the directions from a vertical angle on, lm: exact for bilinear interpolation. Along a plane,
    /// int (a + b v) sin v dv over [v0, v1] = I0 cos v0 - I1 cos v1 + (I1 - I0) / (v1 - v0) (sin v1 - sin v0); across the
    /// planes, the mean of two times their distance.
    fn integrate(&self, from_deg: f64) -> f64 {
        let from = from_deg.to_radians();
        let rows: Vec<f64> = self.vertical.degrees.iter().map(|degree| f64::from(*degree).to_radians()).collect();
        let plane = |index: usize| -> f64 {
            let cells = rows.windows(2).zip(self.plane(index).windows(2));
            cells
                .map(|(v, i)| {
                    if v[1] <= from {
                        return 0.0;
                    }
                    let slope = f64::from(i[1] - i[0]) / (v[1] - v[0]);
                    let (v0, v1) = (v[0].max(from), v[1]);
                    let (i0, i1) = (f64::from(i[0]) + slope * (v0 - v[0]), f64::from(i[1]));
                    i0 * v0.cos() - i1 * v1.cos() + slope * (v1.sin() - v0.sin())
                })
                .sum()
        };
        if self.horizontal.degrees.len() == 1 {
            return 2.0 * PI * plane(0);
        }
        let planes: Vec<f64> = (0..self.horizontal.degrees.len()).map(plane).collect();
        let widths = self.horizontal.degrees.windows(2).map(|pair| f64::from(pair[1] - pair[0]).to_radians());
        widths.zip(planes.windows(2)).map(|(width, ends)| width * 0.5 * (ends[0] + ends[1])).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thousand_candela_everywhere_are_4000_pi_lumens() {
        for vertical in [vec![0.0, 180.0], (0..=36).map(|i| 5.0 * i as f32).collect(), vec![0.0, 1.0, 7.5, 90.0, 180.0]]
        {
            for horizontal in [vec![0.0], vec![0.0, 33.0, 360.0]] {
                let candela = vec![1000.0; vertical.len() * horizontal.len()];
                let table = IntensityTable::new(vertical.clone(), horizontal, candela).unwrap();
                assert!((table.flux_lm() / (4000.0 * std::f32::consts::PI) - 1.0).abs() < 1e-6, "{}", table.flux_lm());
                assert_eq!((table.peak_cd(), table.candela_towards(Vec3::Y)), (1000.0, 1000.0));
                assert!((table.flux_behind_lm() / table.flux_lm() - 0.5).abs() < 1e-6, "{}", table.flux_behind_lm());
            }
        }
    }

    #[test]
    fn the_flux_is_the_integral_of_the_interpolated_intensity() {
        let candela = vec![50.0, 400.0, 90.0, 10.0, 500.0, 0.0, 70.0, 30.0, 50.0, 400.0, 90.0, 10.0];
        let table = IntensityTable::new(vec![0.0, 20.0, 35.0, 100.0], vec![0.0, 120.0, 360.0], candela).unwrap();
        let (rows, columns) = (4000, 720);
        let mut sum = 0.0;
        for row in 0..rows {
            let vertical = (f64::from(row) + 0.5) / f64::from(rows) * 100.0;
            for column in 0..columns {
                let horizontal = (f64::from(column) + 0.5) / f64::from(columns) * 360.0;
                sum += f64::from(table.candela_at(vertical as f32, horizontal as f32)) * vertical.to_radians().sin();
            }
        }
        let cell = 100_f64.to_radians() * 2.0 * PI / f64::from(rows * columns);
        assert!((sum * cell / f64::from(table.flux_lm()) - 1.0).abs() < 1e-5, "{} and {}", sum * cell, table.flux_lm());
        assert_eq!(table.candela_at(100.1, 0.0), 0.0, "behind the last angle there is no light");
    }

    #[test]
    fn directions_of_the_lights_frame_have_the_angles_of_the_file() {
        // Planes at 0, 90, 180 and 270 degrees, different at a vertical angle of 90
        let candela = [[7.0, 1.0], [7.0, 2.0], [7.0, 3.0], [7.0, 4.0], [7.0, 1.0]].concat();
        let horizontal = vec![0.0, 90.0, 180.0, 270.0, 360.0];
        let table = IntensityTable::new(vec![0.0, 90.0], horizontal, candela).unwrap();
        let directions = [Vec3::NEG_Z, Vec3::X, Vec3::Y, Vec3::NEG_X, Vec3::NEG_Y];
        for (direction, candela) in directions.into_iter().zip([7.0, 1.0, 2.0, 3.0, 4.0]) {
            assert!((table.candela_towards(direction) - candela).abs() < 1e-4, "{direction}");
        }
        let between = Vec3::new(1.0, 1.0, 0.0).normalize();
        assert!((table.candela_towards(between) - 1.5).abs() < 1e-4);
        assert_eq!(table.candela_towards(Vec3::Z), 0.0);
    }

    #[test]
    fn unusable_tables_are_refused() {
        let new = IntensityTable::new;
        assert!(new(vec![0.0], vec![0.0], vec![1.0]).is_err());
        assert!(new(vec![0.0, 90.0], vec![0.0], vec![1.0]).is_err());
        assert!(new(vec![90.0, 0.0], vec![0.0], vec![1.0; 2]).is_err());
        assert!(new(vec![0.0, 190.0], vec![0.0], vec![1.0; 2]).is_err());
        assert!(new(vec![0.0, f32::NAN], vec![0.0], vec![1.0; 2]).is_err());
        assert!(new(vec![0.0, 90.0], vec![0.0, 180.0], vec![1.0; 4]).is_err());
        assert!(new(vec![0.0, 90.0], vec![0.0], vec![0.0; 2]).is_err());
        assert!(new(vec![0.0, 90.0], vec![0.0], vec![-1.0, 5.0]).is_err());
        assert!(new(vec![0.0, 90.0], vec![0.0], vec![f32::INFINITY, 5.0]).is_err());
    }

    #[test]
    fn the_tilt_factor_is_interpolated_and_ends_at_the_last_angle() {
        let mut table = IntensityTable::new(vec![0.0, 90.0], vec![0.0], vec![1.0; 2]).unwrap();
        assert_eq!(table.tilt_factor(40.0), 1.0);
        table.tilt = vec![[0.0, 1.0], [60.0, 0.7], [90.0, 0.9]];
        let factors = [0.0, 30.0, 60.0, 75.0, 170.0].map(|tilt| table.tilt_factor(tilt));
        for (factor, expected) in factors.into_iter().zip([1.0, 0.85, 0.7, 0.8, 0.9]) {
            assert!((factor - expected).abs() < 1e-6, "{factors:?}");
        }
    }
}
