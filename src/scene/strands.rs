//! Strands: many thin curves, such as hair, brows, lashes and beard.
//!
//! A strand is a polyline of control points with a radius each; the segments between them are straight and tapered.
//! Renderers interpolate the direction of a strand from segment to segment, so that 8 to 20 segments look smooth.

use glam::Vec3;
use std::hash::{Hash, Hasher};
use std::ops::Range;

/// A control point of a strand, in object space.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct StrandPoint {
    /// Position, metres.
    pub position: Vec3,
    /// Radius of the strand there, metres: 20 to 60 micrometres for human hair.
    pub radius_m: f32,
}

/// A named range of strands that can have its own material.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct StrandPart {
    /// `hair`, `brows`, `lashes`, `beard`.
    pub name: String,
    /// Range of strands.
    pub strands: Range<u32>,
}

/// The strands of a mesh. Every strand has at least two points. `parts` cover all strands, in order.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Strands {
    points: Vec<StrandPoint>,
    /// Index of the first point of each strand; a strand ends where the next one starts.
    starts: Vec<u32>,
    parts: Vec<StrandPart>,
}

impl Strands {
    /// Returns true without strands.
    pub fn is_empty(&self) -> bool {
        self.starts.is_empty()
    }

    /// Returns the number of strands.
    pub fn len(&self) -> usize {
        self.starts.len()
    }

    /// Returns the control points of all strands, one strand after the other, from root to tip.
    pub fn points(&self) -> &[StrandPoint] {
        &self.points
    }

    /// Returns the index of the first point of each strand.
    pub fn starts(&self) -> &[u32] {
        &self.starts
    }

    /// Returns the named ranges of strands.
    pub fn parts(&self) -> &[StrandPart] {
        &self.parts
    }

    /// Returns the range of a strand in [`Strands::points`].
    pub fn range(&self, strand: usize) -> Range<usize> {
        let end = self.starts.get(strand + 1).map_or(self.points.len(), |&next| next as usize);
        self.starts[strand] as usize..end
    }

    /// Returns the control points of a strand, from root to tip.
    pub fn strand(&self, strand: usize) -> &[StrandPoint] {
        &self.points[self.range(strand)]
    }

    /// Returns the first point of every segment; the next point is its second one.
    pub fn segments(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.len()).flat_map(|strand| {
            let range = self.range(strand);
            range.start as u32..range.end as u32 - 1
        })
    }

    /// Appends a strand, from root to tip. Strands of less than two points, and those with a point that is not finite
    /// or a radius that is not positive, are left out.
    pub fn push(&mut self, points: impl IntoIterator<Item = StrandPoint>) {
        let start = self.points.len();
        self.points.extend(points);
        let is_valid = |p: &StrandPoint| p.position.is_finite() && p.radius_m > 0.0 && p.radius_m.is_finite();
        if self.points.len() < start + 2 || !self.points[start..].iter().all(is_valid) {
            self.points.truncate(start);
            return;
        }
        self.starts.push(start as u32);
    }

    /// Makes a part of the strands that were appended since the last part. Does nothing without such strands.
    pub fn end_part(&mut self, name: &str) {
        let first = self.parts.last().map_or(0, |part| part.strands.end);
        if first < self.len() as u32 {
            self.parts.push(StrandPart { name: name.to_owned(), strands: first..self.len() as u32 });
        }
    }

    /// Feeds everything that the strands consist of into a hasher.
    pub fn hash_content(&self, hasher: &mut impl Hasher) {
        for StrandPoint { position, radius_m } in &self.points {
            [position.x, position.y, position.z, *radius_m].map(f32::to_bits).hash(hasher);
        }
        self.starts.hash(hasher);
        self.parts.hash(hasher);
    }

    /// Appends other strands and their parts.
    pub fn append(&mut self, other: &Strands) {
        let (first_point, first) = (self.points.len() as u32, self.len() as u32);
        self.points.extend(&other.points);
        self.starts.extend(other.starts.iter().map(|start| start + first_point));
        let moved = |part: &StrandPart| StrandPart {
            name: part.name.clone(),
            strands: part.strands.start + first..part.strands.end + first,
        };
        self.parts.extend(other.parts.iter().map(moved));
    }

    /// Appends groups of strands, one after the other.
    pub fn append_all(&mut self, groups: &[Strands]) {
        self.starts.reserve(groups.iter().map(Strands::len).sum());
        self.points.reserve(groups.iter().map(|group| group.points.len()).sum());
        groups.iter().for_each(|group| self.append(group));
    }

    /// Returns the strands of the parts whose names `is_kept` accepts.
    pub fn with_parts(&self, is_kept: impl Fn(&str) -> bool) -> Strands {
        let mut kept = Strands::default();
        for part in self.parts.iter().filter(|part| is_kept(&part.name)) {
            part.strands.clone().for_each(|strand| kept.push(self.strand(strand as usize).iter().copied()));
            kept.end_part(&part.name);
        }
        kept
    }

    /// Returns the lower and upper corner of the bounding box; none without strands.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        let around = |p: &StrandPoint| (p.position - p.radius_m, p.position + p.radius_m);
        self.points.iter().map(around).reduce(|(low, high), (l, h)| (low.min(l), high.max(h)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strand(x: f32, points: u32) -> impl Iterator<Item = StrandPoint> {
        (0..points).map(move |i| StrandPoint { position: Vec3::new(x, i as f32, 0.0), radius_m: 0.1 })
    }

    #[test]
    fn strands_and_parts_keep_their_ranges_when_appended() {
        let mut strands = Strands::default();
        strands.push(strand(0.0, 3));
        strands.push(strand(1.0, 1));
        strands.push([StrandPoint { position: Vec3::NAN, radius_m: 1.0 }; 2]);
        strands.push(strand(2.0, 2));
        strands.end_part("hair");
        strands.end_part("nothing");
        assert_eq!((strands.len(), strands.points().len()), (2, 5), "a point and a NaN are no strands");
        let mut other = Strands::default();
        other.push(strand(5.0, 4));
        other.end_part("brows");
        strands.append(&other);
        let parts: Vec<(&str, Range<u32>)> =
            strands.parts().iter().map(|part| (part.name.as_str(), part.strands.clone())).collect();
        assert_eq!(parts, [("hair", 0..2), ("brows", 2..3)]);
        assert_eq!(strands.strand(2)[0].position.x, 5.0);
        assert_eq!(strands.segments().collect::<Vec<_>>(), [0, 1, 3, 5, 6, 7]);
        let brows = strands.with_parts(|name| name == "brows");
        assert_eq!((brows.len(), brows.strand(0)), (1, strands.strand(2)));
        assert_eq!((brows.parts()[0].name.as_str(), brows.parts()[0].strands.clone()), ("brows", 0..1));
        assert_eq!(strands.bounds(), Some((Vec3::new(-0.1, -0.1, -0.1), Vec3::new(5.1, 3.1, 0.1))));
    }
}
