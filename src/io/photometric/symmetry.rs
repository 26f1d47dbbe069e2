//! Unfolds the planes of a photometric file to the whole circle of horizontal angles.

use crate::scene::IntensityTable;

/// The symmetry of a distribution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Symmetry {
    /// None: the planes go round the whole circle.
    None,
    /// About the axis: one plane stands for all.
    Axis,
    /// About the plane of 0 and 180 degrees.
    Plane0,
    /// About the plane of 90 and 270 degrees.
    Plane90,
    /// About both planes.
    Quadrants,
}

/// A plane: its horizontal angle, degrees, and the intensities at the vertical angles.
pub(super) type Plane = (f32, Vec<f32>);

/// Angles that differ by less are one, degrees.
const SAME_DEG: f32 = 1e-3;

impl Symmetry {
    /// Returns the angles at which a plane stands, its own first.
    fn images(self, degree: f32) -> Vec<f32> {
        match self {
            Symmetry::None | Symmetry::Axis => vec![degree],
            Symmetry::Plane0 => vec![degree, -degree],
            Symmetry::Plane90 => vec![degree, 180.0 - degree],
            Symmetry::Quadrants => vec![degree, -degree, 180.0 - degree, 180.0 + degree],
        }
    }
}

/// Returns the horizontal angles and intensities of the whole circle, as [`IntensityTable::new`] takes them.
pub(super) fn full_circle(planes: &[Plane], symmetry: Symmetry) -> Result<(Vec<f32>, Vec<f32>), String> {
    let Some((_, first)) = planes.first() else { return Err("there is no plane of intensities".to_owned()) };
    if symmetry == Symmetry::Axis || planes.len() == 1 {
        return Ok((vec![0.0], first.clone()));
    }
    let rows = first.len();
    if (planes.len() * 4 + 2) * rows > IntensityTable::MOST_VALUES {
        return Err(format!("{} planes of {rows} intensities are too many", planes.len()));
    }
    // Every plane at its images, in ascending order, each angle once
    let mut images: Vec<(f32, usize)> = Vec::new();
    for (index, (degree, _)) in planes.iter().enumerate() {
        let wrapped = symmetry.images(*degree).into_iter().map(|degree| {
            let degree = degree.rem_euclid(360.0);
            (if degree > 360.0 - SAME_DEG { 0.0 } else { degree }, index)
        });
        images.extend(wrapped);
    }
    images.sort_by(|a, b| a.0.total_cmp(&b.0));
    images.dedup_by(|later, earlier| later.0 - earlier.0 < SAME_DEG);
    // The plane at 0, which closes the circle, may lie between two of the file
    let (Some(&(low, first)), Some(&(high, last))) = (images.first(), images.last()) else {
        return Err("there is no plane of intensities".to_owned());
    };
    let (first, last) = (&planes[first].1, &planes[last].1);
    let part = (360.0 - high) / (360.0 - high + low);
    let seam: Vec<f32> = last.iter().zip(first).map(|(last, first)| last + (first - last) * part).collect();
    let mut degrees = vec![0.0];
    let mut candela = seam.clone();
    for (degree, plane) in images.into_iter().filter(|(degree, _)| *degree >= SAME_DEG) {
        degrees.push(degree);
        candela.extend_from_slice(&planes[plane].1);
    }
    degrees.push(360.0);
    candela.extend(seam);
    Ok((degrees, candela))
}
