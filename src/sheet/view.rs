//! The studio from above and from the side, to scale.

use super::drawing::{Align, Element, Rgb, Stroke};
use super::font::Font;
use super::lengths::Units;
use super::silhouette::{convex_hull, outlines};
use crate::scene::{Assets, CameraFrame, Light, Object, Scene, Shape, tessellate};
use crate::setup::LightShape;
use glam::{Mat3, Quat, Vec2, Vec3};
use std::f32::consts::FRAC_PI_2;

/// Details of outlines, metres.
const DETAIL_M: f32 = 0.012;
/// Space around the things of a view, metres.
const AROUND_M: f32 = 0.35;
/// Most of a backdrop that widens a view beyond lights, camera and people, metres.
const BACKDROP_M: f32 = 2.5;
/// Edge from which a plane is a backdrop, not a card, metres.
const LARGE_PLANE_M: f32 = 1.5;
/// Sizes of text, millimetres.
const LABEL_MM: f32 = 2.2;
const NUMBER_MM: f32 = 2.6;
/// Width that the name of a small thing may have, millimetres.
const NAME_MM: f32 = 18.0;
const BADGE_MM: f32 = 2.1;

const GREY: Rgb = [120; 3];
const WALL: Rgb = [60; 3];
const CAMERA: Rgb = [40; 3];

/// The side that a view is seen from, with the camera looking up the page in a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewFrom {
    /// A plan.
    Above,
    /// An elevation from the camera's right: the camera is at the left of the page.
    Side,
}

/// A thing with its outline in a view.
#[derive(Clone, Debug)]
struct Outlined {
    name: String,
    outlines: Vec<Vec<Vec2>>,
    low: Vec2,
    high: Vec2,
    /// Nearness to the viewer, metres: nearer things are drawn over others.
    nearness: f32,
    is_person: bool,
    is_backdrop: bool,
}

/// A light in a view.
#[derive(Clone, Debug)]
struct PlacedLight {
    number: usize,
    color: Rgb,
    is_on: bool,
    front: Vec<Vec2>,
    body: Vec<Vec2>,
    position: Vec2,
    /// The point that it aims at, if there is one, and its distance, metres.
    aim: Option<(Vec2, f32)>,
    /// The direction from its front to its back.
    backwards: Vec2,
    head: Vec2,
    /// The foot of its stand.
    foot: Vec2,
}

/// A view of a studio, in metres on the page: x to the right, y down.
#[derive(Clone, Debug)]
pub struct StudioView {
    from: ViewFrom,
    low: Vec2,
    high: Vec2,
    things: Vec<Outlined>,
    lights: Vec<PlacedLight>,
    camera: [Vec<Vec2>; 2],
    field: [[Vec2; 2]; 4],
    subject: Vec2,
    /// Floor and ceiling, or the walls: a rectangle.
    room: Option<[Vec2; 2]>,
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
    /// Returns the view of a studio with the subject at a point, metres. `aims` are the points that the lights aim at,
    /// where they aim at any.
    pub fn new(scene: &Scene, assets: &Assets, subject: Vec3, aims: &[Option<Vec3>], from: ViewFrom) -> Self {
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
                let aim = aims.get(index).copied().flatten();
                PlacedLight::new(scene, index + 1, light, aim, &project)
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
        self.lights.iter().filter_map(|light| light.aim).for_each(|(aim, _)| take(aim));
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

    /// Draws the view with its top left corner at a point, millimetres.
    pub fn elements(&self, at: Vec2, mm_per_m: f32, font: &Font, units: Units) -> Vec<Element> {
        let place = |point: Vec2| at + (point - self.low) * mm_per_m;
        let path = |points: &[Vec2]| points.iter().map(|point| place(*point)).collect::<Vec<_>>();
        let mut inside = Vec::new();
        self.draw_room(&mut inside, &path);
        self.draw_things(&mut inside, &path);
        for [from, to] in self.field {
            inside.push(Element::line(path(&[from, to]), Stroke::dashed([190; 3], 0.15)));
        }
        for light in &self.lights {
            light.draw(&mut inside, &path, self.from);
        }
        inside.extend(self.camera.iter().map(|part| Element::polygon(path(part), Some(CAMERA), None)));
        inside.push(Element::circle(place(self.subject), 0.7, Some([255; 3]), Some(Stroke::new([200, 30, 30], 0.4))));
        let mut labels = Vec::new();
        if self.from == ViewFrom::Above {
            self.lights.iter().for_each(|light| light.draw_distance(&mut labels, &place, font, units));
            self.draw_names(&mut labels, &place, font);
        }
        self.lights.iter().for_each(|light| light.draw_number(&mut labels, &place));
        inside.extend(labels);
        let size = self.size_m() * mm_per_m;
        vec![
            Element::Clipped { at, size, elements: inside },
            Element::rect(at, size, None, Some(Stroke::new([200; 3], 0.2))),
        ]
    }

    fn draw_room(&self, out: &mut Vec<Element>, path: &dyn Fn(&[Vec2]) -> Vec<Vec2>) {
        if let Some([low, high]) = self.room {
            let corners = [low, Vec2::new(high.x, low.y), high, Vec2::new(low.x, high.y)];
            out.push(Element::polygon(path(&corners), Some([252, 252, 250]), Some(Stroke::new(WALL, 0.6))));
        } else if self.from == ViewFrom::Side {
            let floor = [Vec2::new(self.low.x, 0.0), Vec2::new(self.high.x, 0.0)];
            out.push(Element::line(path(&floor), Stroke::new(WALL, 0.4)));
        }
    }

    fn draw_things(&self, out: &mut Vec<Element>, path: &dyn Fn(&[Vec2]) -> Vec<Vec2>) {
        for thing in &self.things {
            let (fill, line) = match (thing.is_person, thing.is_backdrop) {
                (true, _) => ([222, 203, 188], [120, 92, 72]),
                (_, true) => ([238, 238, 236], [150; 3]),
                _ => ([218, 220, 222], [130; 3]),
            };
            let lines = thing.outlines.iter().map(|outline| path(outline)).collect();
            let stroke = Some(Stroke::new(line, 0.2));
            out.push(Element::Path { lines, closed: true, fill: Some(fill), stroke });
        }
    }

    /// Draws the names of what is large enough for them, unless they would lie over other names: people's first, then
    /// those of the largest things.
    fn draw_names(&self, out: &mut Vec<Element>, place: &dyn Fn(Vec2) -> Vec2, font: &Font) {
        let mut things: Vec<&Outlined> = self.things.iter().collect();
        let area = |thing: &Outlined| (thing.high - thing.low).element_product();
        things.sort_by(|a, b| b.is_person.cmp(&a.is_person).then(area(b).total_cmp(&area(a))));
        let mut taken: Vec<[Vec2; 2]> = Vec::new();
        for thing in things {
            let (low, high) = (place(thing.low.max(self.low)), place(thing.high.min(self.high)));
            let width = if thing.is_backdrop { high.x - low.x - 2.0 } else { (high.x - low.x).max(NAME_MM) };
            let text = font.fitted(&thing.name, LABEL_MM, width);
            if text.is_empty() || (high - low).max_element() < LABEL_MM {
                continue;
            }
            let at = match thing.is_backdrop {
                true => low + Vec2::new(1.2, LABEL_MM + 0.6),
                false => Vec2::new(0.5 * (low.x + high.x), high.y + LABEL_MM),
            };
            let align = if thing.is_backdrop { Align::Left } else { Align::Center };
            let width = font.width(&text, LABEL_MM);
            let left = if thing.is_backdrop { at.x } else { at.x - 0.5 * width };
            let area = [Vec2::new(left, at.y - LABEL_MM), Vec2::new(left + width, at.y + 0.3 * LABEL_MM)];
            if taken.iter().any(|other| area[0].cmplt(other[1]).all() && other[0].cmplt(area[1]).all()) {
                continue;
            }
            taken.push(area);
            out.push(Element::text(at, text, LABEL_MM).colored([90; 3]).aligned(align).into());
        }
    }
}

impl Outlined {
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
        let mut outlines = outlines(&triangles, &strands, DETAIL_M);
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
    fn new(
        scene: &Scene,
        number: usize,
        light: &Light,
        aim: Option<Vec3>,
        project: &dyn Fn(Vec3) -> Vec2,
    ) -> Option<Self> {
        let shape = LightShape::new(scene, light)?;
        let position = project(light.position);
        Some(PlacedLight {
            number,
            color: print_color(light),
            is_on: light.on,
            front: convex_hull(shape.front.iter().map(|point| project(*point)).collect()),
            body: convex_hull(shape.points().map(project).collect()),
            position,
            aim: aim.map(|aim| (project(aim), (aim - light.position).length())),
            backwards: project(light.position - shape.axis) - position,
            head: project(shape.head),
            foot: project(Vec3::new(shape.head.x, 0.0, shape.head.z)),
        })
    }

    fn draw(&self, out: &mut Vec<Element>, path: &dyn Fn(&[Vec2]) -> Vec<Vec2>, from: ViewFrom) {
        let color = if self.is_on { self.color } else { GREY };
        if from == ViewFrom::Side {
            out.push(Element::line(path(&[self.foot, self.head]), Stroke::new([150; 3], 0.3)));
        }
        if let Some((aim, _)) = self.aim {
            out.push(Element::line(path(&[self.position, aim]), Stroke::dashed(color, 0.25)));
        }
        let pale = color.map(|channel| 255 - (255 - channel) / 3);
        out.push(Element::polygon(path(&self.body), Some(pale), Some(Stroke::new(color, 0.25))));
        out.push(Element::polygon(path(&self.front), Some([255; 3]), Some(Stroke::new(color, 0.6))));
    }

    fn draw_distance(&self, out: &mut Vec<Element>, place: &dyn Fn(Vec2) -> Vec2, font: &Font, units: Units) {
        let Some((aim, distance_m)) = self.aim else { return };
        let (from, to) = (place(self.position), place(aim));
        let text = units.distance(distance_m);
        let width = font.width(&text, LABEL_MM);
        if (to - from).length() < width + 4.0 {
            return;
        }
        let middle = from.lerp(to, 0.45);
        let half = Vec2::new(0.5 * width + 0.4, 0.5 * LABEL_MM + 0.2);
        out.push(Element::rect(middle - half, 2.0 * half, Some([255; 3]), None));
        let base = middle + Vec2::Y * 0.36 * LABEL_MM;
        out.push(Element::text(base, text, LABEL_MM).colored(self.color).aligned(Align::Center).into());
    }

    fn draw_number(&self, out: &mut Vec<Element>, place: &dyn Fn(Vec2) -> Vec2) {
        let behind = self.backwards.normalize_or(Vec2::NEG_Y);
        let middle = place(self.head) + behind * (BADGE_MM + 0.6);
        out.extend(badge(middle, self.number, if self.is_on { self.color } else { GREY }));
    }
}

/// Draws a ruler of whole units, of 20 to 60 mm where one is not too long, with its length and a note at its end.
pub fn ruler(at: Vec2, mm_per_m: f32, units: Units, note: &str) -> Vec<Element> {
    let (unit_m, unit) = units.ruler();
    let step = mm_per_m * unit_m;
    let (parts, each) = match step > 60.0 {
        // A part of a unit
        true => (1, 0.1 * (600.0 / step).floor().max(1.0)),
        false => {
            let count = (60.0 / step.max(1e-3)).floor();
            let each = (count / 6.0).ceil();
            ((count / each) as u32, each)
        }
    };
    let (part_mm, total) = (step * each, each * parts as f32);
    let mut elements = Vec::new();
    for index in 0..parts {
        let fill = if index % 2 == 0 { [40; 3] } else { [255; 3] };
        let from = at + Vec2::X * part_mm * index as f32;
        let stroke = Some(Stroke::new([40; 3], 0.15));
        elements.push(Element::rect(from, Vec2::new(part_mm, 1.2), Some(fill), stroke));
    }
    let decimals = usize::from(total.fract() != 0.0);
    let text = format!("{total:.decimals$} {unit}{note}");
    let end = at + Vec2::new(part_mm * parts as f32 + 1.5, 1.6);
    elements.push(Element::text(end, text, LABEL_MM).colored(GREY).into());
    elements
}

/// Draws the number of a light.
pub fn badge(middle: Vec2, number: usize, color: Rgb) -> [Element; 2] {
    let base = middle + Vec2::Y * 0.36 * NUMBER_MM;
    let number = Element::text(base, number.to_string(), NUMBER_MM).colored([255; 3]).aligned(Align::Center).strong();
    [Element::circle(middle, BADGE_MM, Some(color), None), number.into()]
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
