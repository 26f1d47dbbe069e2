//! The drawing of a view, and its ruler.

use super::drawing::{Element, Rgb, Stroke};
use super::font::Font;
use super::label_layout::contains;
use super::lengths::Units;
use super::view::{GREY, PlacedLight, StudioView, ViewFrom};
use super::view_labels::{LABEL_MM, PlacedView};
use glam::Vec2;

/// Longest ruler, millimetres.
const RULER_MM: f32 = 40.0;

const WALL: Rgb = [60; 3];
const CAMERA: Rgb = [40; 3];

impl StudioView {
    /// Draws the view with its top left corner at a point, millimetres.
    pub fn elements(&self, at: Vec2, mm_per_m: f32, font: &Font, units: Units) -> Vec<Element> {
        let size = self.size_m() * mm_per_m;
        let placed = PlacedView { view: self, frame: [at, at + size], mm_per_m };
        let path = |points: &[Vec2]| placed.path(points);
        let mut inside = Vec::new();
        self.draw_room(&mut inside, &path);
        self.draw_things(&mut inside, &path);
        for [from, to] in self.field {
            inside.push(Element::line(path(&[from, to]), Stroke::dashed([190; 3], 0.15)));
        }
        for light in &self.lights {
            light.draw(&mut inside, &path, self.from, self.is_before(light));
        }
        inside.extend(self.camera.iter().map(|part| Element::polygon(path(part), Some(CAMERA), None)));
        let subject = placed.on_page(self.subject);
        inside.push(Element::circle(subject, 0.7, Some([255; 3]), Some(Stroke::new([200, 30, 30], 0.4))));
        inside.extend(placed.labels(font, units));
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
}

impl PlacedLight {
    /// Draws the light, with its stand in an elevation, as an outline if it would hide what the picture is of.
    fn draw(&self, out: &mut Vec<Element>, path: &dyn Fn(&[Vec2]) -> Vec<Vec2>, from: ViewFrom, is_outline: bool) {
        let color = self.shown_color();
        let pale = color.map(|channel| 255 - (255 - channel) / 3);
        if from == ViewFrom::Side {
            out.push(Element::line(path(&[self.foot, self.head]), Stroke::new([150; 3], 0.3)));
        }
        let fill = |color: Rgb| Some(color).filter(|_| !is_outline);
        out.push(Element::polygon(path(&self.body), fill(pale), Some(Stroke::new(color, 0.25))));
        out.push(Element::polygon(path(&self.front), fill([255; 3]), Some(Stroke::new(color, 0.6))));
        // The shaft of an umbrella, whose head is before its front
        if !contains(std::slice::from_ref(&self.body), self.head) {
            out.push(Element::line(path(&[self.position, self.head]), Stroke::new(color, 0.25)));
        }
        for (line, is_aim) in self.sight_lines(from) {
            // In an elevation all are aims
            let is_pale = is_aim && from == ViewFrom::Above && self.target.is_some();
            out.push(Element::line(path(&line), Stroke::dashed(if is_pale { pale } else { color }, 0.25)));
        }
    }
}

/// Draws a ruler of whole units, of 20 to 40 mm where one is not too long, with its length at its end.
pub fn ruler(at: Vec2, mm_per_m: f32, units: Units) -> Vec<Element> {
    let (unit_m, unit) = units.ruler();
    let step = mm_per_m * unit_m;
    let (parts, each) = match step > RULER_MM {
        // A part of a unit
        true => (1, 0.1 * (10.0 * RULER_MM / step).floor().max(1.0)),
        false => {
            let count = (RULER_MM / step.max(1e-3)).floor();
            let each = if count < 2.0 { 0.5 } else { (count / 6.0).ceil() };
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
    let text = format!("{total:.decimals$} {unit}");
    let end = at + Vec2::new(part_mm * parts as f32 + 1.5, 1.6);
    elements.push(Element::text(end, text, LABEL_MM).colored(GREY).into());
    elements
}
