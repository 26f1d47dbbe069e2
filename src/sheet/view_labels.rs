//! The labels of a view: the numbers of lights, in a plan their distances along the floor and the names of things, in an
//! elevation their heights.

use super::drawing::{Align, Element, Rgb, Stroke};
use super::font::Font;
use super::label_layout::{
    LabelLayout, LabelPosition, Overlap, Owner, PageRect, area_around, corners, nearest_in, positions_around,
    segment_meets,
};
use super::lengths::Units;
use super::view::{GREY, Outlined, PlacedLight, StudioView, ViewFrom};
use glam::Vec2;
use std::f32::consts::TAU;

/// Height of the font of labels, millimetres.
pub const LABEL_MM: f32 = 2.2;
/// Height of the font of a light's number, millimetres.
const NUMBER_MM: f32 = 2.6;
/// Radius of the number of a light, millimetres.
const BADGE_MM: f32 = 2.1;
/// Width that a name may have, millimetres.
const NAME_MM: f32 = 34.0;
/// Cost above which the name of a prop is left out, millimetres: it is in the list of gear.
const FAR_MM: f32 = 24.0;
/// Distance from which a label has a line to its thing, millimetres.
const LEADER_MM: f32 = 2.2;
/// Length from which the line to the subject has its distance, millimetres.
const SHORT_MM: f32 = 3.0;
/// Smallest gap between a label and the frame, millimetres.
const EDGE_MM: f32 = 0.5;

/// A view on the page.
pub struct PlacedView<'a> {
    /// The view.
    pub view: &'a StudioView,
    /// Its frame, millimetres.
    pub frame: PageRect,
    /// Millimetres on the page in a metre.
    pub mm_per_m: f32,
}

impl PlacedView<'_> {
    /// Returns the point of the page for a point of the view.
    pub fn on_page(&self, point: Vec2) -> Vec2 {
        self.frame[0] + (point - self.view.low) * self.mm_per_m
    }

    /// Returns the points of the page for an outline of the view.
    pub fn path(&self, points: &[Vec2]) -> Vec<Vec2> {
        points.iter().map(|point| self.on_page(*point)).collect()
    }

    /// Returns the labels: numbers first, then distances or heights, then names.
    pub fn labels(&self, font: &Font, units: Units) -> Vec<Element> {
        let mut layout = self.marks();
        let mut out = Vec::new();
        self.view.lights.iter().for_each(|light| self.draw_number(&mut out, &mut layout, light));
        for light in &self.view.lights {
            let length = match self.view.from {
                ViewFrom::Above => light.target.map(|(target, floor_m)| ([light.position, target], floor_m)),
                ViewFrom::Side => Some(([light.foot, light.head], light.height_m())),
            };
            if let Some((line, length_m)) = length {
                self.draw_length(&mut out, &mut layout, light, (line, &units.distance(length_m)), font);
            }
        }
        if self.view.from == ViewFrom::Above {
            self.draw_names(&mut out, &mut layout, font);
        }
        out
    }

    /// Returns what labels keep off.
    fn marks(&self) -> LabelLayout {
        let view = self.view;
        let mut layout = LabelLayout::new([self.frame[0] + EDGE_MM, self.frame[1] - EDGE_MM]);
        layout.add(vec![corners(area_around(self.on_page(view.subject), Vec2::splat(2.0)))], Overlap::Never, None);
        for thing in &view.things {
            let outlines: Vec<Vec<Vec2>> = thing.outlines.iter().map(|outline| self.path(outline)).collect();
            match (thing.is_person, thing.is_small()) {
                (true, _) => layout.add(outlines, Overlap::Never, None),
                (false, true) => layout.add(outlines, Overlap::Reluctant, None),
                // The edges of what is large
                (false, false) => outlines.into_iter().for_each(|mut outline| {
                    outline.extend(outline.first().copied());
                    layout.add_line(outline, None);
                }),
            }
        }
        view.camera.iter().for_each(|part| layout.add(vec![self.path(part)], Overlap::Reluctant, None));
        view.field.iter().for_each(|line| layout.add_line(self.path(line), None));
        for light in &view.lights {
            let (body, sight) = (Some(Owner::Body(light.number)), Some(Owner::Sight(light.number)));
            let outline = self.path(&light.body);
            match view.is_before(light) {
                true => layout.add_line(outline.iter().chain(outline.first()).copied().collect(), body),
                false => layout.add(vec![outline], Overlap::Reluctant, body),
            }
            light.sight_lines(view.from).for_each(|(line, _)| layout.add_line(self.path(&line), sight));
            if view.from == ViewFrom::Side {
                layout.add_line(self.path(&[light.foot, light.head]), sight);
            }
        }
        layout
    }

    /// Draws the number of a light behind its head, or beside it where that is taken.
    fn draw_number(&self, out: &mut Vec<Element>, layout: &mut LabelLayout, light: &PlacedLight) {
        let behind = light.backwards.normalize_or(Vec2::NEG_Y);
        let head = nearest_in(self.frame, self.on_page(light.head));
        let ways = [0.6, 2.4, 5.0, 9.0, 14.0].into_iter().flat_map(|gap| {
            (0..16).map(move |turn| {
                let turned = Vec2::from_angle(TAU * turn as f32 / 16.0).rotate(behind);
                let middle = head + turned * (BADGE_MM + gap);
                let leader = (gap > LEADER_MM).then_some([middle - turned * BADGE_MM, head]);
                LabelPosition { leader, ..LabelPosition::new(middle, gap + 2.0 * (1.0 - turned.dot(behind))) }
            })
        });
        let inside = [self.frame[0] + BADGE_MM, self.frame[1] - BADGE_MM];
        let own = Some(Owner::Body(light.number));
        let position = layout.take(Vec2::splat(2.0 * BADGE_MM), &ways.collect::<Vec<_>>(), own, f32::INFINITY);
        let LabelPosition { middle, leader: line, .. } =
            position.unwrap_or(LabelPosition::new(nearest_in(inside, head), 0.0));
        let color = light.shown_color();
        out.extend(line.map(|line| leader(line, color)));
        out.extend(badge(middle, light.number, color));
    }

    /// Draws the length of a light's line on it or beside it.
    fn draw_length(
        &self,
        out: &mut Vec<Element>,
        layout: &mut LabelLayout,
        light: &PlacedLight,
        (line, text): ([Vec2; 2], &str),
        font: &Font,
    ) {
        let [from, to] = line.map(|point| self.on_page(point));
        if (to - from).length() < SHORT_MM {
            return;
        }
        let size = label_size(font, text);
        let ways = places_along([from, to], size);
        let Some(position) = layout.take(size, &ways, Some(Owner::Sight(light.number)), f32::INFINITY) else { return };
        let area = area_around(position.middle, size);
        if segment_meets(area, from, to) {
            out.push(Element::rect(area[0], size, Some([255; 3]), None));
        }
        let color = light.shown_color();
        out.extend(position.leader.map(|line| leader(line, color)));
        out.push(label(position.middle, text.to_owned(), color));
    }

    /// Draws the names of what is large enough for them: people's first, then those of the largest things.
    fn draw_names(&self, out: &mut Vec<Element>, layout: &mut LabelLayout, font: &Font) {
        let mut things: Vec<&Outlined> = self.view.things.iter().collect();
        let area = |thing: &Outlined| (thing.high - thing.low).element_product();
        things.sort_by(|a, b| b.is_person.cmp(&a.is_person).then(area(b).total_cmp(&area(a))));
        for thing in things {
            let (low, high) =
                (self.on_page(thing.low.max(self.view.low)), self.on_page(thing.high.min(self.view.high)));
            if low.cmple(high).all() && (high - low).max_element() >= LABEL_MM {
                self.draw_name(out, layout, font, (thing, [low, high]));
            }
        }
    }

    /// Draws the name of a thing that takes a rectangle: a backdrop's within it, others' beside them.
    fn draw_name(
        &self,
        out: &mut Vec<Element>,
        layout: &mut LabelLayout,
        font: &Font,
        (thing, taken): (&Outlined, PageRect),
    ) {
        let text = font.fitted(&thing.name, LABEL_MM, NAME_MM);
        let size = label_size(font, &text);
        let mut ways = positions_around(taken, size);
        if !thing.is_small() && !thing.is_person {
            ways.extend(places_within(taken, size));
        }
        let points: Vec<Vec2> = thing.outlines.iter().flatten().map(|point| self.on_page(*point)).collect();
        for way in ways.iter_mut().filter(|way| nearest_in(taken, way.middle) != way.middle) {
            let distance = |point: &Vec2| (*point - way.middle).length_squared();
            let nearest = points.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
            way.leader = nearest.and_then(|point| long_leader(area_around(way.middle, size), *point));
        }
        let most = if thing.is_person { f32::INFINITY } else { FAR_MM };
        if let Some(position) = layout.take(size, &ways, None, most).filter(|_| !text.is_empty()) {
            out.extend(position.leader.map(|line| leader(line, GREY)));
            out.push(label(position.middle, text, [90; 3]));
        }
    }
}

/// Returns the line from a label to its thing, if that is not close by.
fn long_leader(area: PageRect, thing: Vec2) -> Option<[Vec2; 2]> {
    let from = nearest_in(area, thing);
    ((thing - from).length() > LEADER_MM).then_some([from, thing])
}

/// Draws a thin line from a label to its thing.
fn leader(line: [Vec2; 2], color: Rgb) -> Element {
    Element::line(line, Stroke::new(color, 0.15))
}

/// Returns positions for a label of a size on a line and beside it, near its middle first.
fn places_along([from, to]: [Vec2; 2], size: Vec2) -> Vec<LabelPosition> {
    const ASIDE: [(f32, f32); 7] =
        [(0.0, 0.0), (1.0, 2.0), (-1.0, 2.0), (2.5, 6.0), (-2.5, 6.0), (5.0, 12.0), (-5.0, 12.0)];
    let across = (to - from).perp().normalize_or(Vec2::Y);
    let aside_mm = 0.5 * across.abs().dot(size) + 0.2;
    let along = (0..=24).map(|step| 0.14 + 0.03 * step as f32);
    let positions = along.flat_map(|along| {
        let foot = from.lerp(to, along);
        ASIDE.map(|(aside, cost)| {
            let middle = foot + across * aside * aside_mm;
            let leader = long_leader(area_around(middle, size), foot);
            LabelPosition { leader, ..LabelPosition::new(middle, cost + 8.0 * (along - 0.47).abs()) }
        })
    });
    positions.collect()
}

/// Returns the width and height of a label with a little space around it.
fn label_size(font: &Font, text: &str) -> Vec2 {
    Vec2::new(font.width(text, LABEL_MM) + 0.8, LABEL_MM + 0.4)
}

fn label(middle: Vec2, text: String, color: Rgb) -> Element {
    Element::text(middle + Vec2::Y * 0.36 * LABEL_MM, text, LABEL_MM).colored(color).aligned(Align::Center).into()
}

/// Returns positions within a rectangle along its upper and its lower edge, the upper left corner first, with their costs.
fn places_within([low, high]: PageRect, size: Vec2) -> Vec<LabelPosition> {
    const STEPS: u32 = 6;
    let (low, high) = (low + 0.5 * size + 0.8, high - 0.5 * size - 0.8);
    let along = (0..=STEPS).map(|step| step as f32 / STEPS as f32);
    let positions = along.flat_map(|part| {
        let x = low.x + (high.x - low.x) * part;
        [(Vec2::new(x, low.y), part), (Vec2::new(x, high.y), 1.5 + part)]
    });
    positions.filter(|_| low.cmple(high).all()).map(|(middle, cost)| LabelPosition::new(middle, cost - 1.0)).collect()
}

/// Draws the number of a light.
pub fn badge(middle: Vec2, number: usize, color: Rgb) -> [Element; 2] {
    let base = middle + Vec2::Y * 0.36 * NUMBER_MM;
    let number = Element::text(base, number.to_string(), NUMBER_MM).colored([255; 3]).aligned(Align::Center).strong();
    [Element::circle(middle, BADGE_MM, Some(color), None), number.into()]
}
