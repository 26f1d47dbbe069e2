//! The solid parts of a tank as its fluid meets them: the sides, the ground and the obstacles.
//!
//! Positions are in cells from the lowest corner, speeds in cells per second.

use super::faces::{Faces, Layout};
use crate::scene::{Obstacle, ObstacleForm, Tank};
use crate::water::grid::{FULL, Grid};
use glam::{Vec2, Vec3};

/// Distance that particles keep from solids, cells.
const CLEARANCE: f32 = 0.02;
/// Thickness of the wall of a glass, cells.
const GLASS_WALL: f32 = 3.0;
/// Open parts of a face below this one are closed: they make the pressures ill-conditioned.
const SMALLEST_OPENING: f32 = 0.05;

/// The solids of a tank.
#[derive(Clone, Debug)]
pub(in crate::water) struct Solids {
    layout: Layout,
    /// Part of each cell that the ground fills.
    ground: Vec<f32>,
    cell_m: f32,
    low_m: Vec3,
    obstacles: Vec<Obstacle>,
}

impl Solids {
    pub(in crate::water) fn new(grid: &Grid, tank: &Tank) -> Self {
        let layout = Layout::new(grid.size());
        let ground = (0..layout.cell_count()).map(|cell| f32::from(grid.ground(cell)) / f32::from(FULL)).collect();
        let obstacles = tank.fluid.as_ref().map(|fluid| fluid.obstacles.clone()).unwrap_or_default();
        Solids { layout, ground, cell_m: tank.cell_m, low_m: tank.low_m(), obstacles }
    }

    /// Returns the position in cells of one in metres.
    pub(super) fn cells_from_m(&self, at_m: Vec3) -> Vec3 {
        (at_m - self.low_m) / self.cell_m
    }

    /// Returns true if no obstacle moves at or after a time.
    pub(super) fn is_still(&self, time_s: f32) -> bool {
        self.obstacles.iter().all(|obstacle| obstacle.falls_m_s == 0.0 || time_s >= obstacle.stands_s)
    }

    /// Returns the signed distance of a point from the nearest obstacle, cells, negative inside; and that obstacle.
    fn nearest(&self, at: Vec3, time_s: f32) -> (f32, Option<&Obstacle>) {
        let distance = |obstacle: &Obstacle| {
            let foot = self.cells_from_m(obstacle.at_time_m(time_s));
            form_distance(&obstacle.form, at - foot, 1.0 / self.cell_m)
        };
        let nearest = self.obstacles.iter().map(|obstacle| (distance(obstacle), Some(obstacle)));
        nearest.fold((f32::INFINITY, None), |a, b| if b.0 < a.0 { b } else { a })
    }

    /// Returns the signed distance of a point from the obstacles, cells, negative inside.
    pub(in crate::water) fn obstacle_distance(&self, at: Vec3, time_s: f32) -> f32 {
        self.nearest(at, time_s).0
    }

    /// Returns true for a point in the drink that a glass has at the start.
    pub(super) fn is_in_drink(&self, at: Vec3) -> bool {
        self.obstacles.iter().any(|obstacle| {
            let ObstacleForm::Glass { floor_m, floor_radius_m, rim_radius_m, drink_m, .. } = obstacle.form else {
                return false;
            };
            let place = (at - self.cells_from_m(obstacle.at_time_m(0.0))) * self.cell_m;
            let radius_m = floor_radius_m.max(rim_radius_m);
            (floor_m..floor_m + drink_m).contains(&place.y) && Vec2::new(place.x, place.z).length() < radius_m
        })
    }

    /// Returns true where there are obstacles.
    pub(in crate::water) fn has_obstacles(&self) -> bool {
        !self.obstacles.is_empty()
    }

    /// Returns the outward normal of the obstacles at a point.
    pub(in crate::water) fn obstacle_normal(&self, at: Vec3, time_s: f32) -> Vec3 {
        const STEP: f32 = 0.05;
        let distance = |axis: Vec3| self.obstacle_distance(at + axis * STEP, time_s);
        let slope = |axis: Vec3| distance(axis) - distance(-axis);
        Vec3::new(slope(Vec3::X), slope(Vec3::Y), slope(Vec3::Z)).try_normalize().unwrap_or(Vec3::Y)
    }

    /// Returns the part of a cell that the ground fills.
    pub(in crate::water) fn ground(&self, cell: usize) -> f32 {
        self.ground[cell]
    }

    /// Returns a distance from a point within which all of the tank is, cells.
    pub(super) fn reach_from(&self, at: Vec3) -> f32 {
        let middle = 0.5 * Vec3::from(self.layout.size().map(|side| side as f32));
        middle.length() + at.distance(middle)
    }

    /// Returns true for a point between the sides.
    pub(super) fn is_in_tank(&self, at: Vec3) -> bool {
        let high = Vec3::from(self.layout.size().map(|side| side as f32));
        at.cmpgt(Vec3::ZERO).all() && at.cmplt(high).all()
    }

    /// Returns true for a point in the ground.
    pub(in crate::water) fn is_in_ground(&self, at: Vec3) -> bool {
        let cell = self.layout.cell_at(at);
        let ground = self.ground[cell];
        ground > 0.0 && at.y - at.y.floor() < ground
    }

    /// Returns the open part of each cell.
    pub(super) fn openness(&self, time_s: f32) -> Vec<f32> {
        let mut open: Vec<f32> = self.ground.iter().map(|ground| 1.0 - ground).collect();
        self.near_obstacles(time_s, |at, cell| {
            open[cell] *= (0.5 + self.obstacle_distance(at + 0.5, time_s)).clamp(0.0, 1.0);
        });
        open
    }

    /// Calls a function for the low corner and the index of each cell that an obstacle may touch.
    fn near_obstacles(&self, time_s: f32, mut call: impl FnMut(Vec3, usize)) {
        let last = self.layout.size().map(|side| side as f32 - 1.0);
        for obstacle in &self.obstacles {
            let foot = self.cells_from_m(obstacle.at_time_m(time_s));
            let (low, high) = form_bounds(&obstacle.form, 1.0 / self.cell_m);
            let clamp = |at: Vec3| at.clamp(Vec3::ZERO, Vec3::from(last)).as_usizevec3();
            let (low, high) = (clamp((foot + low - 2.0).floor()), clamp((foot + high + 2.0).floor()));
            for z in low.z..=high.z {
                for x in low.x..=high.x {
                    for y in low.y..=high.y {
                        call(Vec3::new(x as f32, y as f32, z as f32), self.layout.cell([x, y, z]));
                    }
                }
            }
        }
    }

    /// Computes the open part of each face, and the flow that obstacles which fall push through faces across Y.
    pub(super) fn openings(&self, time_s: f32) -> (Faces, Vec<f32>) {
        let mut open = self.ground_openings();
        let mut pushed = vec![0.0; self.layout.face_count()];
        let size = self.layout.size();
        let mut done = vec![false; self.layout.cell_count()];
        self.near_obstacles(time_s, |low, cell| {
            if std::mem::replace(&mut done[cell], true) {
                return;
            }
            let at = low.to_array().map(|side| side as usize);
            for axis in (0..3).filter(|&axis| at[axis] > 0 && at[axis] < size[axis]) {
                let face = self.layout.face(at);
                let (open_part, speed) = self.obstacle_opening(low, axis, time_s);
                if axis == 1 {
                    pushed[face] = (1.0 - open_part) * open[axis][face] * speed;
                }
                open[axis][face] *= open_part;
                if open[axis][face] < SMALLEST_OPENING {
                    open[axis][face] = 0.0;
                }
            }
        });
        (open, pushed)
    }

    /// Returns the open part of the lower face of a cell across an axis, and the upward speed of what closes the rest.
    fn obstacle_opening(&self, low: Vec3, axis: usize, time_s: f32) -> (f32, f32) {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let middle = low + Vec3::ONE * 0.5 - Vec3::AXES[axis] * 0.5;
        let (distance, obstacle) = self.nearest(middle, time_s);
        let speed = obstacle.map_or(0.0, |o| if time_s < o.stands_s { -o.falls_m_s / self.cell_m } else { 0.0 });
        if distance.abs() > 1.0 {
            return (if distance > 0.0 { 1.0 } else { 0.0 }, speed);
        }
        // The mean over quarters of the face
        let part = |i: usize| {
            let offset = |bit: usize| if bit == 0 { -0.25 } else { 0.25 };
            let at = middle + Vec3::AXES[u] * offset(i & 1) + Vec3::AXES[v] * offset(i >> 1);
            (0.5 + 2.0 * self.obstacle_distance(at, time_s)).clamp(0.0, 1.0)
        };
        (0.25 * (0..4).map(part).sum::<f32>(), speed)
    }

    /// Returns for each face whether it is a wall: a side of the tank, or the end of the ground.
    pub(super) fn walls(&self) -> [Vec<bool>; 3] {
        let mut walls = [(); 3].map(|()| vec![true; self.layout.face_count()]);
        let open = self.ground_openings();
        self.layout.for_each_cell(|at, cell| {
            for axis in (0..3).filter(|&axis| at[axis] > 0) {
                let (face, other) = (self.layout.face(at), cell - self.layout.cell_stride(axis));
                // Beside faces inside of the ground water slips
                let is_inside = self.ground[cell] >= 1.0 && self.ground[other] >= 1.0;
                walls[axis][face] = open[axis][face] == 0.0 && !is_inside;
            }
        });
        walls
    }

    /// Returns the open part of each face between sides and ground.
    fn ground_openings(&self) -> Faces {
        let size = self.layout.size();
        let mut open = self.layout.faces();
        self.layout.for_each_cell(|at, cell| {
            for axis in (0..3).filter(|&axis| at[axis] > 0) {
                let other = cell - self.layout.cell_stride(axis);
                let part = if axis == 1 {
                    // Ground fills cells from below
                    if self.ground[other] < 1.0 && self.ground[cell] == 0.0 { 1.0 } else { 0.0 }
                } else {
                    1.0 - self.ground[cell].max(self.ground[other])
                };
                open[axis][self.layout.face(at)] = if part < SMALLEST_OPENING { 0.0 } else { part };
            }
        });
        debug_assert!(size.iter().all(|&side| side > 0));
        open
    }

    /// Returns where a particle ends that moves from one point to another, and its velocity there: solids stop what
    /// leads into them.
    pub(super) fn stop(&self, from: Vec3, to: Vec3, mut velocity: Vec3, time_s: f32) -> (Vec3, Vec3) {
        let high = Vec3::from(self.layout.size().map(|side| side as f32)) - CLEARANCE;
        let mut at = to;
        // Ground: one axis after the other
        if self.is_in_ground(at.clamp(Vec3::splat(CLEARANCE), high)) {
            at = from;
            for axis in [1, 0, 2] {
                let mut next = at;
                next[axis] = to[axis].clamp(CLEARANCE, high[axis]);
                if self.is_in_ground(next) {
                    velocity[axis] = 0.0;
                } else {
                    at = next;
                }
            }
        }
        if let (distance, Some(obstacle)) = self.nearest(at, time_s)
            && distance < CLEARANCE
        {
            let normal = self.obstacle_normal(at, time_s);
            let out = at + normal * (CLEARANCE - distance).min(4.0);
            if !self.is_in_ground(out.clamp(Vec3::splat(CLEARANCE), high)) {
                at = out;
            }
            let falls = if time_s < obstacle.stands_s { obstacle.falls_m_s / self.cell_m } else { 0.0 };
            let inward = (velocity + Vec3::Y * falls).dot(normal).min(0.0);
            velocity -= normal * inward;
        }
        for axis in 0..3 {
            let kept = at[axis].clamp(CLEARANCE, high[axis]);
            if kept != at[axis] {
                at[axis] = kept;
                velocity[axis] = 0.0;
            }
        }
        (at, velocity)
    }
}

/// Returns the signed distance of a point from a form whose foot is at the origin, in cells; `scale` is cells per metre.
fn form_distance(form: &ObstacleForm, at: Vec3, scale: f32) -> f32 {
    let around = Vec2::new(at.x, at.z).length();
    let corner = |outside: Vec3| outside.max(Vec3::ZERO).length() + outside.max_element().min(0.0);
    match *form {
        ObstacleForm::Ball { radius_m } => (at - Vec3::Y * radius_m * scale).length() - radius_m * scale,
        ObstacleForm::Box { size_m } => {
            let half = 0.5 * size_m * scale;
            corner((at - Vec3::Y * half.y).abs() - half)
        }
        ObstacleForm::Cylinder { radius_m, height_m } => {
            let half = 0.5 * height_m * scale;
            corner(Vec3::new(around - radius_m * scale, (at.y - half).abs() - half, f32::NEG_INFINITY))
        }
        ObstacleForm::Glass { floor_m, floor_radius_m, rim_m, rim_radius_m, .. } => {
            let [floor, floor_radius, rim, rim_radius] =
                [floor_m, floor_radius_m, rim_m, rim_radius_m].map(|m| m * scale);
            let slope = (rim_radius - floor_radius) / (rim - floor).max(1e-6);
            let inner = floor_radius + slope * (at.y - floor).max(0.0);
            let wall = (inner - around) / (1.0 + slope * slope).sqrt();
            let hollow = wall.min(at.y - floor);
            hollow.max(at.y - rim).max(around - inner - GLASS_WALL).max(floor - GLASS_WALL - at.y)
        }
    }
}

/// Returns the lowest and highest corner of a form, cells from its foot.
fn form_bounds(form: &ObstacleForm, scale: f32) -> (Vec3, Vec3) {
    let upright =
        |radius: f32, low: f32, high: f32| (Vec3::new(-radius, low, -radius), Vec3::new(radius, high, radius));
    match *form {
        ObstacleForm::Ball { radius_m } => upright(radius_m * scale, 0.0, 2.0 * radius_m * scale),
        ObstacleForm::Box { size_m } => {
            let half = 0.5 * size_m * scale;
            (-half * Vec3::new(1.0, 0.0, 1.0), half * Vec3::new(1.0, 2.0, 1.0))
        }
        ObstacleForm::Cylinder { radius_m, height_m } => upright(radius_m * scale, 0.0, height_m * scale),
        ObstacleForm::Glass { floor_m, floor_radius_m, rim_m, rim_radius_m, .. } => {
            let radius = floor_radius_m.max(rim_radius_m) * scale + GLASS_WALL;
            upright(radius, floor_m * scale - GLASS_WALL, rim_m * scale)
        }
    }
}
