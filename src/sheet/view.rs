//! The studio from above and from the side, to scale.

use super::drawing::Rgb;
use super::label_layout::contains;
use super::silhouette::{convex_hull, outlines};
use crate::scene::{Assets, CameraFrame, Light, Object, Scene, Shape, tessellate};
use crate::setup::LightShape;
use glam::{Mat3, Quat, Vec2, Vec3};
use std::f32::consts::FRAC_PI_2;

/// Details of outlines, of things without hair as a part of their longest edge and at least so many metres.
const DETAIL_M: f32 = 0.012;
const FINE: (f32, f32) = (1.0 / 150.0, 0.002);
/// Space around the things of a view, metres.
const AROUND_M: f32 = 0.2;
/// Most of a backdrop that widens a view beyond lights, camera and people, metres.
const BACKDROP_M: f32 = 2.5;
/// Edge from which a plane is a backdrop, not a card, metres.
const LARGE_PLANE_M: f32 = 1.5;
/// Longest edge of a thing that labels do not cover, metres.
const SMALL_M: f32 = 0.6;
/// Angle in a plan between the ways to the subject and to the aim from which a light's aim has a line of its own,
/// degrees.
const APART_DEG: f32 = 4.0;

/// The colour of lights that are off, and of notes.
pub const GREY: Rgb = [120; 3];

/// The side that a view is seen from, with the camera looking up the page in a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewFrom {
    /// A plan.
    Above,
    /// An elevation from the camera's right: the camera is at the left of the page.
    Side,
}

/// The points that a light is aimed at and measured to, world space, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sight {
    /// The point that it aims at, if there is one.
    pub aim: Option<Vec3>,
    /// The point to which its distance is given, if there is one.
    pub target: Option<Vec3>,
}

/// A thing with its outline in a view.
#[derive(Clone, Debug)]
pub(super) struct Outlined {
    pub(super) name: String,
    pub(super) outlines: Vec<Vec<Vec2>>,
    pub(super) low: Vec2,
    pub(super) high: Vec2,
    /// Nearness to the viewer, metres: nearer things are drawn over others.
    pub(super) nearness: f32,
    pub(super) is_person: bool,
    pub(super) is_backdrop: bool,
}

/// A light in a view.
#[derive(Clone, Debug)]
pub(super) struct PlacedLight {
    pub(super) number: usize,
    pub(super) color: Rgb,
    pub(super) is_on: bool,
    pub(super) front: Vec<Vec2>,
    pub(super) body: Vec<Vec2>,
    pub(super) position: Vec2,
    /// The point that it aims at, if there is one.
    pub(super) aim: Option<Vec2>,
    /// The point that it is measured to, if there is one, and its distance along the floor, metres.
    pub(super) target: Option<(Vec2, f32)>,
    /// The direction from its front to its back.
    pub(super) backwards: Vec2,
    pub(super) head: Vec2,
    /// The foot of its stand.
    pub(super) foot: Vec2,
}

/// A view of a studio, in metres on the page: x to the right, y down.
#[derive(Clone, Debug)]
pub struct StudioView {
    pub(super) from: ViewFrom,
    pub(super) low: Vec2,
    pub(super) high: Vec2,
    pub(super) things: Vec<Outlined>,
    pub(super) lights: Vec<PlacedLight>,
    pub(super) camera: [Vec<Vec2>; 2],
    pub(super) field: [[Vec2; 2]; 4],
    pub(super) subject: Vec2,
    /// Floor and ceiling, or the walls: a rectangle.
    pub(super) room: Option<[Vec2; 2]>,
}

impl ViewFrom {
    /// Projects a point whose -Z is the camera's direction.
    fn project(self, point: Vec3) -> Vec2 {
        match self {
            ViewFrom::Above => Vec2::new(point.x, point.z),
            ViewFrom::Side => Vec2::new(-point.z, -point.y),
        }
    }

    fn nearness(self, point: Vec3) -> f32 {
        match self {
            ViewFrom::Above => point.y,
            ViewFrom::Side => point.x,
        }
    }
}

/// Returns the turn about the vertical, in steps of 90°, after which the camera looks along -Z as nearly as possible.
fn turn_to_camera(frame: &CameraFrame) -> Mat3 {
    let forward = frame.forward();
    let yaw = (-forward.x).atan2(-forward.z);
    Mat3::from_quat(Quat::from_rotation_y(-(yaw / FRAC_PI_2).round() * FRAC_PI_2))
}

impl StudioView {
    /// Returns the view of a studio with the subject at a point, metres. `sights` are those of the lights, in their order.
    pub fn new(scene: &Scene, assets: &Assets, subject: Vec3, sights: &[Sight], from: ViewFrom) -> Self {
        let frame = scene.camera_frame(scene.camera.aspect());
        let turn = turn_to_camera(&frame);
        let project = |point: Vec3| from.project(turn * point);
        let outlined = scene.objects.iter().filter(|object| object.visible);
        let mut things: Vec<Outlined> =
            outlined.filter_map(|object| Outlined::new(object, assets, from, turn)).collect();
        things.sort_by(|a, b| a.nearness.total_cmp(&b.nearness));
        let lights = scene.lights.iter().enumerate();
        let lights: Vec<PlacedLight> = lights
            .filter_map(|(index, light)| {
                let sight = sights.get(index).copied().unwrap_or_default();
                PlacedLight::new(scene, index + 1, light, sight, &project)
            })
            .collect();
        let camera = camera_outline(&frame).map(|points| convex_hull(points.into_iter().map(project).collect()));
        let reach_m = 1.15 * (subject - frame.position()).length();
        let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(x, y)| Vec2::new(x, y));
        let field = corners.map(|corner| {
            let end = frame.position() + frame.direction(corner).normalize_or_zero() * reach_m;
            [project(frame.position()), project(end)]
        });
        let room = scene.room.as_ref().map(|room| {
            let corners = room.bounds().map(project);
            [corners[0].min(corners[1]), corners[0].max(corners[1])]
        });
        let mut view = StudioView {
            from,
            low: Vec2::ZERO,
            high: Vec2::ZERO,
            things,
            lights,
            camera,
            field,
            subject: project(subject),
            room,
        };
        view.fit_area();
        view
    }

    /// Sets the area of the view: lights, camera and subject; of people, props, aims and the backdrops near them as
    /// much as is in the room and a little around it.
    fn fit_area(&mut self) {
        let of_lights = self.lights.iter().flat_map(|light| light.body.iter().chain([&light.foot]));
        let points = of_lights.chain(self.camera.iter().flatten()).chain([&self.subject]).copied();
        let (mut low, mut high) = (self.subject, self.subject);
        let mut take = |point: Vec2| (low, high) = (low.min(point), high.max(point));
        points.filter(|point| point.is_finite()).for_each(&mut take);
        let needed = [low - AROUND_M, high + AROUND_M];
        let mut take = |point: Vec2| (low, high) = (low.min(point), high.max(point));
        self.lights.iter().filter_map(|light| light.aim).for_each(&mut take);
        for thing in self.things.iter().filter(|thing| !thing.is_backdrop) {
            [thing.low, thing.high].into_iter().for_each(&mut take);
        }
        if self.from == ViewFrom::Side {
            take(Vec2::new(self.subject.x, 0.0));
        }
        let most = [low - BACKDROP_M, high + BACKDROP_M];
        for thing in self.things.iter().filter(|thing| thing.is_backdrop) {
            (low, high) = (low.min(thing.low.max(most[0])), high.max(thing.high.min(most[1])));
        }
        (self.low, self.high) = (low - AROUND_M, high + AROUND_M);
        if let Some([room_low, room_high]) = self.room {
            self.low = self.low.max(room_low - AROUND_M).min(needed[0]);
            self.high = self.high.min(room_high + AROUND_M).max(needed[1]);
            if self.from == ViewFrom::Side {
                // The ceiling limits lights and booms
                self.low.y = self.low.y.min(room_low.y - AROUND_M);
            }
        }
    }

    /// Returns width and height, metres.
    pub fn size_m(&self) -> Vec2 {
        self.high - self.low
    }

    /// Returns true for a light between the viewer and the subject, a person or a small thing: it is drawn as an outline.
    pub(super) fn is_before(&self, light: &PlacedLight) -> bool {
        let body = std::slice::from_ref(&light.body);
        let mut people = self.things.iter().filter(|thing| thing.is_person || thing.is_small());
        contains(body, self.subject)
            || people.any(|thing| thing.outlines.iter().flatten().any(|point| contains(body, *point)))
    }
}

impl Outlined {
    /// Returns true for a prop that is small enough to be hidden by a label.
    pub(super) fn is_small(&self) -> bool {
        !self.is_person && !self.is_backdrop && (self.high - self.low).max_element() < SMALL_M
    }

    fn new(object: &Object, assets: &Assets, from: ViewFrom, turn: Mat3) -> Option<Self> {
        let mesh = match &object.shape {
            Shape::MeshFile { .. } | Shape::Figure(_) | Shape::Tank(_) => assets.coarse_mesh_of(&object.shape)?,
            shape => std::sync::Arc::new(tessellate(shape)?),
        };
        let world_from_object = object.transform.world_from_object();
        let turned = |point: Vec3| turn * world_from_object.transform_point3(point);
        let project = |point: &Vec3| from.project(turned(*point));
        let triangles = (0..mesh.triangles.len()).map(|index| mesh.corners(index).map(|corner| project(&corner)));
        let triangles: Vec<[Vec2; 3]> = triangles.collect();
        let strands: Vec<Vec2> = mesh.strands.points().iter().map(|point| project(&point.position)).collect();
        let corners = || triangles.iter().flatten().filter(|corner| corner.is_finite()).copied();
        let size = corners().reduce(Vec2::max).zip(corners().reduce(Vec2::min)).map_or(Vec2::ZERO, |(a, b)| a - b);
        let fine = (FINE.0 * size.max_element()).clamp(FINE.1, DETAIL_M);
        let mut outlines = outlines(&triangles, &strands, if strands.is_empty() { fine } else { DETAIL_M });
        if outlines.is_empty() {
            // A small thing
            outlines.push(convex_hull(triangles.into_iter().flatten().collect()));
        }
        let (low, high) = outlines.iter().flatten().fold(None, |bounds: Option<(Vec2, Vec2)>, point| {
            Some(bounds.map_or((*point, *point), |(low, high)| (low.min(*point), high.max(*point))))
        })?;
        let nearness = mesh.positions.iter().map(|point| from.nearness(turned(*point))).fold(f32::MIN, f32::max);
        let is_person = matches!(object.shape, Shape::Figure(_));
        let scale = object.transform.scale.abs().max_element();
        let is_backdrop = match object.shape {
            Shape::Sweep { .. } => true,
            Shape::Plane { width_m, depth_m } => width_m.max(depth_m) * scale > LARGE_PLANE_M,
            _ => false,
        };
        // A sweep lies behind all else, although its wall is high
        let nearness = if matches!(object.shape, Shape::Sweep { .. }) { f32::MIN } else { nearness };
        Some(Outlined { name: object.name.clone(), outlines, low, high, nearness, is_person, is_backdrop })
    }
}

impl PlacedLight {
    fn new(scene: &Scene, number: usize, light: &Light, sight: Sight, project: &dyn Fn(Vec3) -> Vec2) -> Option<Self> {
        let shape = LightShape::new(scene, light)?;
        let position = project(light.position);
        Some(PlacedLight {
            number,
            color: print_color(light),
            is_on: light.on,
            front: convex_hull(shape.front.iter().map(|point| project(*point)).collect()),
            body: convex_hull(shape.points().map(project).collect()),
            position,
            aim: sight.aim.map(project),
            target: sight.target.map(|target| (project(target), (target - light.position).with_y(0.0).length())),
            backwards: project(light.position - shape.axis) - position,
            head: project(shape.head),
            foot: project(Vec3::new(shape.head.x, 0.0, shape.head.z)),
        })
    }

    /// Returns its colour, grey if it is off.
    pub(super) fn shown_color(&self) -> Rgb {
        if self.is_on { self.color } else { GREY }
    }

    /// Returns the height of the middle of its front over the floor, metres, in an elevation.
    pub(super) fn height_m(&self) -> f32 {
        -self.position.y
    }

    /// Returns the lines from its front to what it is measured to, in a plan, and to its aim where that is elsewhere;
    /// the second lines are true for the aim.
    pub(super) fn sight_lines(&self, from: ViewFrom) -> impl Iterator<Item = ([Vec2; 2], bool)> {
        let target = self.target.map(|(target, _)| target).filter(|_| from == ViewFrom::Above);
        let way = |to: Vec2| (to - self.position).normalize_or_zero();
        let is_apart =
            |aim: &Vec2| target.is_none_or(|target| way(target).angle_to(way(*aim)).abs() > APART_DEG.to_radians());
        let aim = self.aim.filter(is_apart);
        let position = self.position;
        let lines = [target.map(|to| (to, false)), aim.map(|to| (to, true))];
        lines.into_iter().flatten().map(move |(to, is_aim)| ([position, to], is_aim))
    }
}

/// Returns the colour of a light's role, dark enough for paper.
pub fn print_color(light: &Light) -> Rgb {
    light.role.srgb8().map(|channel| (u16::from(channel) * 4 / 5) as u8)
}

/// Returns the points of the camera's body and of its lens.
fn camera_outline(frame: &CameraFrame) -> [Vec<Vec3>; 2] {
    let cuboid = |half: Vec2, z: [f32; 2]| -> Vec<Vec3> {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
        let corner =
            |(x, y): (f32, f32), z: f32| frame.world_from_camera.transform_point3(Vec3::new(x * half.x, y * half.y, z));
        z.into_iter().flat_map(|z| corners.map(|xy| corner(xy, z))).collect()
    };
    [cuboid(Vec2::new(0.075, 0.055), [0.02, 0.1]), cuboid(Vec2::splat(0.04), [-0.08, 0.02])]
}
