//! Converts type A and type B photometry, whose polar axes lie across the beam, to type C, by sampling on a fine grid.
//!
//! With the beam ahead, to the right x, upwards y and ahead z (IES LM-75): type A, whose polar axis is upright, has the
//! direction (cos v sin h, sin v, cos v cos h); type B, whose polar axis is level, (sin h, cos h sin v, cos h cos v).

use crate::scene::IntensityTable;

/// The type of photometry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Polar axis upright.
    A,
    /// Polar axis level.
    B,
}

/// Intensities over the angles of a type A or B goniometer.
#[derive(Clone, Debug)]
pub(super) struct Goniometer {
    pub kind: Kind,
    /// Degrees, ascending.
    pub vertical_deg: Vec<f32>,
    /// Degrees, ascending; symmetric about 0 if they begin there.
    pub horizontal_deg: Vec<f32>,
    /// By horizontal, then vertical angle, cd.
    pub planes: Vec<Vec<f32>>,
}

impl Goniometer {
    /// Returns the table of type C: rows of a quarter of a degree to two degrees, as fine as the file's angles.
    pub fn table(&self) -> Result<IntensityTable, String> {
        let finest = |angles: &[f32]| angles.windows(2).map(|pair| pair[1] - pair[0]).fold(f32::INFINITY, f32::min);
        let step = finest(&self.vertical_deg).min(finest(&self.horizontal_deg));
        let (rows_per_quarter, columns): (usize, usize) = match step {
            step if step >= 2.0 => (45, 180),
            step if step >= 1.0 => (90, 360),
            step if step >= 0.5 => (180, 360),
            _ => (360, 360),
        };
        // Where the file ends at a right angle from the beam, the table does
        let reaches = |angles: &[f32]| angles.iter().map(|angle| angle.abs()).fold(0.0, f32::max);
        let along_beam = match self.kind {
            Kind::A => reaches(&self.horizontal_deg),
            Kind::B => reaches(&self.vertical_deg),
        };
        let rows = if along_beam <= 90.0 { rows_per_quarter } else { 2 * rows_per_quarter };
        let vertical: Vec<f32> = (0..=rows).map(|row| row as f32 * 90.0 / rows_per_quarter as f32).collect();
        let horizontal: Vec<f32> = (0..=columns).map(|column| column as f32 * 360.0 / columns as f32).collect();
        let mut candela = Vec::with_capacity(vertical.len() * horizontal.len());
        for &h in &horizontal {
            // The last plane repeats the first to the bit
            let (sin_h, cos_h) = (h % 360.0).to_radians().sin_cos();
            for &v in &vertical {
                let (sin_v, cos_v) = v.to_radians().sin_cos();
                candela.push(self.intensity(sin_v * cos_h, sin_v * sin_h, cos_v));
            }
        }
        IntensityTable::new(vertical, horizontal, candela)
    }

    /// Returns the intensity in a unit direction: right, up, ahead.
    fn intensity(&self, right: f32, up: f32, ahead: f32) -> f32 {
        // At a polar axis rounding must not turn the other angle round
        let [right, up, ahead] = [right, up, ahead].map(|x| if x.abs() < 1e-6 { 0.0 } else { x });
        let (v, h) = match self.kind {
            Kind::A => (up.atan2(right.hypot(ahead)), right.atan2(ahead)),
            Kind::B => (up.atan2(ahead), right.atan2(up.hypot(ahead))),
        };
        let (v, h) = (v.to_degrees(), h.to_degrees());
        let is_symmetric = self.horizontal_deg.first().is_some_and(|first| *first == 0.0);
        let h = if is_symmetric { h.abs() } else { h };
        let (Some((row, down)), Some((plane, across))) =
            (interval(&self.vertical_deg, v), interval(&self.horizontal_deg, h))
        else {
            return 0.0;
        };
        let along = |plane: &[f32]| plane[row] + (plane[row + 1] - plane[row]) * down;
        let (one, other) = (along(&self.planes[plane]), along(&self.planes[plane + 1]));
        one + (other - one) * across
    }
}

/// Returns the interval of an angle and the part of it before the angle; none outside of the angles. Rounding of a
/// direction does not lead out of them.
fn interval(angles: &[f32], degree: f32) -> Option<(usize, f32)> {
    let (first, last) = (angles.first()?, angles.last()?);
    if !(degree >= first - 1e-2 && degree <= last + 1e-2) || angles.len() < 2 {
        return None;
    }
    let index = angles.partition_point(|angle| *angle <= degree).saturating_sub(1).min(angles.len() - 2);
    let (low, high) = (angles[index], angles[index + 1]);
    Some((index, ((degree - low) / (high - low)).clamp(0.0, 1.0)))
}
