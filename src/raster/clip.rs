//! Triangles cut at the six planes of clip space, in homogeneous coordinates (Sutherland and Hodgman 1974).
//!
//! Depth is reversed and endless: near at z = w, far at z = 0. A cut always runs from the corner inside to the one
//! outside, so that two triangles with a common edge cut it at the very same point and leave no crack.

use glam::{Vec3, Vec4};

/// A corner of a cut triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Corner {
    /// Clip space.
    pub clip: Vec4,
    /// Weights of the three corners of the whole triangle.
    pub weights: Vec3,
}

/// Three corners and one more for each plane.
const MOST_CORNERS: usize = 9;

/// A convex polygon.
#[derive(Clone, Copy, Debug)]
pub(super) struct Polygon {
    corners: [Corner; MOST_CORNERS],
    count: usize,
}

impl Polygon {
    /// The corners in order; none or at least three.
    pub fn corners(&self) -> &[Corner] {
        &self.corners[..self.count]
    }

    fn push(&mut self, corner: Corner) {
        // Rounding may make a sliver cross a plane once too often; its corner is no loss.
        if let Some(place) = self.corners.get_mut(self.count) {
            *place = corner;
            self.count += 1;
        }
    }
}

/// Signed distances from the planes left, right, bottom, top, near, far, each times w: inside where not negative.
fn distances(p: Vec4) -> [f32; 6] {
    [p.w + p.x, p.w - p.x, p.w + p.y, p.w - p.y, p.w - p.z, p.z]
}

/// Where a triangle lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// Wholly inside.
    Inside,
    /// Wholly beyond one of the planes.
    Outside,
    /// Neither: it must be cut.
    Across,
}

/// Bits of the planes that a corner is beyond.
pub(super) type Planes = u8;

/// The planes that a corner is beyond: all, if it is no number.
pub(super) fn beyond(corner: Vec4) -> Planes {
    distances(corner).iter().enumerate().fold(0, |bits, (plane, distance)| {
        let inside = *distance >= 0.0;
        bits | (Planes::from(!inside) << plane)
    })
}

/// A first look at a triangle.
pub(super) fn place(corners: [Planes; 3]) -> Place {
    match corners {
        [0, 0, 0] => Place::Inside,
        [a, b, c] if a & b & c != 0 => Place::Outside,
        _ => Place::Across,
    }
}

/// The part of a triangle inside all six planes.
pub(super) fn cut(corners: [Vec4; 3]) -> Polygon {
    let weights = [Vec3::X, Vec3::Y, Vec3::Z];
    let none = Corner { clip: Vec4::ZERO, weights: Vec3::ZERO };
    let empty = Polygon { corners: [none; MOST_CORNERS], count: 0 };
    let mut polygon = empty;
    for (clip, weights) in corners.into_iter().zip(weights) {
        polygon.push(Corner { clip, weights });
    }
    for plane in 0..6 {
        let mut inside = empty;
        let corners = polygon.corners();
        for (i, &to) in corners.iter().enumerate() {
            let from = corners[(i + corners.len() - 1) % corners.len()];
            let (a, b) = (distances(from.clip)[plane], distances(to.clip)[plane]);
            match (a >= 0.0, b >= 0.0) {
                (true, true) => inside.push(to),
                (true, false) => inside.push(crossing(from, a, to, b)),
                (false, true) => {
                    inside.push(crossing(to, b, from, a));
                    inside.push(to);
                }
                (false, false) => {}
            }
        }
        polygon = inside;
    }
    if polygon.count < 3 { empty } else { polygon }
}

/// Where the edge from a corner inside to one outside meets the plane.
fn crossing(inside: Corner, distance_inside: f32, outside: Corner, distance_outside: f32) -> Corner {
    let part = distance_inside / (distance_inside - distance_outside);
    Corner {
        clip: inside.clip + (outside.clip - inside.clip) * part,
        weights: inside.weights + (outside.weights - inside.weights) * part,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_that_covers_the_screen_is_kept_though_all_its_corners_are_outside() {
        let far = |x: f32, y: f32| Vec4::new(x, y, 0.5, 1.0);
        let corners = [far(-9.0, -9.0), far(9.0, -9.0), far(0.0, 20.0)];
        assert_eq!(place(corners.map(beyond)), Place::Across);
        let polygon = cut(corners);
        assert_eq!(polygon.corners().len(), 4, "the whole screen");
        for corner in polygon.corners() {
            assert!(corner.clip.x.abs() == 1.0 && corner.clip.y.abs() == 1.0, "{corner:?}");
        }
    }

    #[test]
    fn what_lies_behind_the_camera_is_cut_at_the_near_plane() {
        // Reversed depth: z is the near distance, w the distance.
        let near = 0.1;
        let corners =
            [Vec4::new(0.0, 0.0, near, 2.0), Vec4::new(0.5, 0.0, near, -1.0), Vec4::new(0.0, 0.5, near, -1.0)];
        let polygon = cut(corners);
        assert!(polygon.corners().len() >= 3);
        for corner in polygon.corners() {
            assert!(corner.clip.w >= near * 0.999, "{corner:?}");
            assert!((corner.weights.element_sum() - 1.0).abs() < 1e-5);
            let again = corners[0] * corner.weights.x + corners[1] * corner.weights.y + corners[2] * corner.weights.z;
            assert!((again - corner.clip).length() < 1e-5, "weights lead to the same point");
        }
        assert_eq!(place([beyond(Vec4::new(0.0, 0.0, near, -1.0)); 3]), Place::Outside);
        assert_eq!(place([beyond(Vec4::NAN); 3]), Place::Outside);
    }

    #[test]
    fn neighbours_cut_their_common_edge_at_the_same_point() {
        let (a, b) = (Vec4::new(0.3, -0.2, 0.1, 0.7), Vec4::new(3.1, 0.4, 0.1, 1.3));
        let (c, d) = (Vec4::new(0.2, 0.6, 0.1, 0.9), Vec4::new(0.1, -0.7, 0.1, 0.8));
        let on_edge = |corners: [Vec4; 3]| -> Vec<[u32; 4]> {
            let bits = |p: Vec4| p.to_array().map(f32::to_bits);
            cut(corners).corners().iter().filter(|c| c.weights.min_element() == 0.0).map(|c| bits(c.clip)).collect()
        };
        let (one, other) = (on_edge([a, b, c]), on_edge([b, a, d]));
        assert!(one.iter().filter(|point| other.contains(point)).count() >= 2, "{one:?} {other:?}");
    }
}
