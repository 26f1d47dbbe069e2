//! The sheet on a page of A4: picture, facts, plan, elevation, lights, gear and checks.

use super::content::{MEASURES, SheetContent};
use super::drawing::{Align, Drawing, Element, Stroke};
use super::font::Font;
use super::light_facts::COLUMNS;
use super::view_drawing::ruler;
use super::view_labels::badge;
use glam::{Vec2, vec2};

/// A4, upright, millimetres.
const PAGE_MM: Vec2 = Vec2::new(210.0, 297.0);
const MARGIN_MM: f32 = 12.0;
const WIDTH_MM: f32 = PAGE_MM.x - 2.0 * MARGIN_MM;
/// Most of the picture's width and height.
const PICTURE_MM: Vec2 = Vec2::new(69.0, 46.0);
/// Widths of the columns of the table of lights.
const COLUMNS_MM: [f32; 7] = [38.0, 46.0, 27.0, 23.0, 18.0, 16.0, 18.0];
/// Width of the column of names of facts.
const NAMES_MM: f32 = 20.0;
const TITLE_MM: f32 = 6.2;
const HEADING_MM: f32 = 3.6;
const BODY_MM: f32 = 2.9;
const SMALL_MM: f32 = 2.2;
const LINE_MM: f32 = 4.1;
/// Text and lines of the lists.
const LIST_MM: f32 = 2.6;
const LIST_LINE_MM: f32 = 3.7;
/// Width of each of the two columns of gear beside the checks, which have the rest.
const GEAR_MM: f32 = 54.0;
/// Height of the heading of a list.
const LIST_HEAD_MM: f32 = HEADING_MM + 1.5;
/// Heights of the heading of a view, and of ruler and notes under it.
const VIEW_HEAD_MM: f32 = 3.8;
const UNDER_VIEWS_MM: f32 = 10.0;
/// Most by which the plan, in which the lights are placed, is larger than the elevation.
const PLAN_OVER_ELEVATION: f32 = 1.6;
/// Height of a row of the table with its smaller line, and without it.
const ROW_MM: [f32; 2] = [8.0, 4.2];
/// Height of the views, at least and at most.
const VIEWS_MM: [f32; 2] = [62.0, 160.0];
/// Gap between parts of the page.
const GAP_MM: f32 = 4.0;
/// Denominators of the scale.
const SCALES: [f32; 23] = [
    2.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 40.0, 50.0, 60.0, 75.0, 80.0, 100.0, 125.0, 150.0, 200.0, 250.0, 300.0,
    400.0, 500.0, 1000.0, 2000.0, 5000.0,
];

/// Lowest line of lists.
const BOTTOM_MM: f32 = PAGE_MM.y - MARGIN_MM - SMALL_MM;
/// Heading of the checks.
const CHECKS: &str = "Check on the set";

const GREY: [u8; 3] = [110; 3];
const RULE: [u8; 3] = [200; 3];

/// Returns the denominator of the largest usual scale in which sizes in metres, beside each other, fit a width and
/// height in millimetres.
fn scale_of(sizes_m: &[Vec2], room_mm: Vec2) -> f32 {
    let width_m: f32 = sizes_m.iter().map(|size| size.x).sum();
    let height_m = sizes_m.iter().map(|size| size.y).fold(0.0, f32::max);
    let gaps_mm = GAP_MM * (sizes_m.len() as f32 - 1.0);
    let least = (1000.0 * width_m / (room_mm.x - gaps_mm)).max(1000.0 * height_m / room_mm.y);
    SCALES.into_iter().find(|scale| *scale >= least).unwrap_or(least)
}

/// Returns the denominators of the scales of plan and elevation, beside each other, that fit a width and height in
/// millimetres: the plan's is the largest, and the elevation's not much smaller.
fn scales_of(sizes_m: [Vec2; 2], room_mm: Vec2) -> [f32; 2] {
    let elevation_of = |plan: f32| {
        let plan_mm = 1000.0 / plan * sizes_m[0];
        let left = room_mm.x - GAP_MM - plan_mm.x;
        let fits = plan_mm.y <= room_mm.y && left > GAP_MM;
        let elevation = scale_of(&sizes_m[1..], vec2(left.max(GAP_MM), room_mm.y)).max(plan);
        (fits && elevation <= PLAN_OVER_ELEVATION * plan).then_some([plan, elevation])
    };
    let both = scale_of(&sizes_m, room_mm);
    SCALES.into_iter().find_map(elevation_of).unwrap_or([both; 2])
}

/// A page that is filled from the top.
struct Page<'a> {
    content: &'a SheetContent,
    font: &'a Font,
    elements: Vec<Element>,
}

/// The heights of the parts of a page under the facts.
struct Layout {
    /// Height of a row of the table.
    row: f32,
    /// Denominators of the scales of plan and elevation.
    scales: [f32; 2],
    /// Sizes of plan and elevation on the page.
    views_mm: [Vec2; 2],
    /// The list of gear, in columns of a width.
    gear: Vec<String>,
    gear_columns: (usize, f32),
    /// The list of checks, over the elevation or beside the gear.
    checks: Vec<String>,
    are_checks_over_elevation: bool,
}

/// Lays a sheet out on a page.
pub fn page(content: &SheetContent, font: &Font) -> Drawing {
    let mut page = Page { content, font, elements: Vec::new() };
    let top = page.head();
    let top = page.picture_and_facts(top);
    let layout = Some(page.layout(top, true)).filter(Layout::has_room_for_checks);
    let layout = layout.unwrap_or_else(|| page.layout(top, false));
    let bottom = BOTTOM_MM;
    let top = page.views(top, &layout);
    // Long lists are cut at the end of the page
    let rows = ((bottom - top - LINE_MM - 3.0 - GAP_MM - 4.0 * LIST_LINE_MM) / layout.row).max(1.0) as usize;
    let top = page.lights(top, layout.row, rows);
    let lines = ((bottom - top - LIST_HEAD_MM) / LIST_LINE_MM).max(0.0) as usize;
    let (columns, width) = layout.gear_columns;
    let each = layout.gear.len().div_ceil(columns).clamp(1, lines.max(1));
    for column in 0..columns {
        // The last column has what is left
        let from = (column * each).min(layout.gear.len());
        let to = if column + 1 == columns { layout.gear.len() } else { (from + each).min(layout.gear.len()) };
        let heading = if column == 0 { "Bring" } else { "" };
        page.list(vec2(MARGIN_MM + width * column as f32, top), heading, &layout.gear[from..to], lines);
    }
    if !layout.are_checks_over_elevation {
        page.list(vec2(MARGIN_MM + width * columns as f32, top), CHECKS, &layout.checks, lines);
    }
    page.foot();
    Drawing { size_mm: PAGE_MM, elements: page.elements }
}

impl Layout {
    /// Returns the height of the taller view.
    fn tall(&self) -> f32 {
        self.views_mm[0].y.max(self.views_mm[1].y)
    }

    /// Returns the x at which the column of the elevation begins.
    fn elevation_left(&self) -> f32 {
        MARGIN_MM + WIDTH_MM - self.views_mm[1].x
    }

    fn has_room_for_checks(&self) -> bool {
        let free = self.tall() - self.views_mm[1].y - GAP_MM;
        free >= LIST_HEAD_MM + LIST_LINE_MM * self.checks.len() as f32
    }
}

impl Page<'_> {
    fn text(&mut self, at: Vec2, text: &str, size: f32) {
        self.elements.push(Element::text(at, text, size).into());
    }

    fn grey(&mut self, at: Vec2, text: &str, size: f32) {
        self.elements.push(Element::text(at, text, size).colored(GREY).into());
    }

    fn rule(&mut self, y: f32) {
        let line = [vec2(MARGIN_MM, y), vec2(MARGIN_MM + WIDTH_MM, y)];
        self.elements.push(Element::line(line, Stroke::new(RULE, 0.25)));
    }

    /// Draws title and description; returns the y below.
    fn head(&mut self) -> f32 {
        let mut y = MARGIN_MM + TITLE_MM;
        let title = self.font.fitted(&self.content.title, TITLE_MM, WIDTH_MM);
        self.elements.push(Element::text(vec2(MARGIN_MM, y), title, TITLE_MM).strong().into());
        let lines = self.font.lines(&self.content.description, BODY_MM, WIDTH_MM);
        for (index, line) in lines.iter().take(2).enumerate() {
            let rest = if index == 1 && lines.len() > 2 { " \u{2026}" } else { "" };
            y += LINE_MM + 0.6;
            self.grey(vec2(MARGIN_MM, y), &format!("{line}{rest}"), BODY_MM);
        }
        self.rule(y + 2.4);
        y + 2.4 + GAP_MM
    }

    /// Draws the picture with the facts beside it; returns the y below.
    fn picture_and_facts(&mut self, top: f32) -> f32 {
        let pixels = vec2(self.content.picture.width as f32, self.content.picture.height as f32).max(Vec2::ONE);
        let size = pixels * (PICTURE_MM / pixels).min_element();
        self.elements.push(Element::Picture { at: vec2(MARGIN_MM, top), size });
        let left = MARGIN_MM + size.x + 6.0;
        let column = 0.5 * (PAGE_MM.x - MARGIN_MM - left);
        let content = self.content;
        let camera = self.facts(vec2(left, top), column - 3.0, "Camera", &content.camera);
        let subject = self.facts(vec2(left + column, top), column, "Subject", &content.subject);
        (top + size.y).max(camera).max(subject) + GAP_MM
    }

    /// Draws facts under a heading in a column of a width; returns the y below.
    fn facts(&mut self, at: Vec2, width: f32, heading: &str, facts: &[(&'static str, String)]) -> f32 {
        let mut y = at.y + 0.8 * BODY_MM;
        self.elements.push(Element::text(vec2(at.x, y), heading, HEADING_MM).strong().into());
        y += LINE_MM + 1.0;
        for (name, value) in facts {
            self.grey(vec2(at.x, y), name, BODY_MM);
            for line in self.font.lines(value, BODY_MM, width - NAMES_MM) {
                self.text(vec2(at.x + NAMES_MM, y), &line, BODY_MM);
                y += LINE_MM;
            }
        }
        y - LINE_MM
    }

    /// Returns the layout under the facts, whose checks are over the elevation or beside the gear.
    fn layout(&self, top: f32, are_checks_over_elevation: bool) -> Layout {
        let (columns, width) = if are_checks_over_elevation { (3, WIDTH_MM / 3.0) } else { (2, GEAR_MM) };
        let gear = self.gear_lines(width - 2.0);
        let beside = self.check_lines(WIDTH_MM - 2.0 * GEAR_MM);
        let checks = if are_checks_over_elevation { 0 } else { beside.len() };
        let lists = LIST_HEAD_MM + LIST_LINE_MM * gear.len().div_ceil(columns).max(checks) as f32;
        let lights = self.content.lights.len() as f32;
        let around_views = VIEW_HEAD_MM + UNDER_VIEWS_MM + 2.0 * GAP_MM;
        // What is left for the views decides whether the rows have their smaller line
        let left = |row: f32| BOTTOM_MM - top - lists - (LINE_MM + 3.0 + row * lights) - around_views;
        let row = ROW_MM.into_iter().find(|row| left(*row) >= VIEWS_MM[0]).unwrap_or(ROW_MM[1]);
        let height = left(row).clamp(VIEWS_MM[0], VIEWS_MM[1]);
        let sizes = [0, 1].map(|view| self.content.views[view].size_m());
        let scales = scales_of(sizes, vec2(WIDTH_MM, height));
        let views_mm = [0, 1].map(|view| sizes[view] * (1000.0 / scales[view]));
        let mut layout = Layout {
            row,
            scales,
            views_mm,
            gear,
            gear_columns: (columns, width),
            checks: beside,
            are_checks_over_elevation,
        };
        if are_checks_over_elevation {
            layout.checks = self.check_lines(MARGIN_MM + WIDTH_MM - layout.elevation_left());
        }
        layout
    }

    /// Draws plan and elevation with their rulers, and the checks over the elevation; returns the y below.
    fn views(&mut self, top: f32, layout: &Layout) -> f32 {
        if layout.are_checks_over_elevation {
            self.list(vec2(layout.elevation_left(), top), CHECKS, &layout.checks, layout.checks.len());
        }
        let names = ["Plan", "From the camera's right"];
        let lefts = [MARGIN_MM, MARGIN_MM + WIDTH_MM - layout.views_mm[1].x];
        // Floors of elevations and the camera's end of plans are down
        let bottom = top + VIEW_HEAD_MM + layout.tall();
        for (index, (name, left)) in names.into_iter().zip(lefts).enumerate() {
            let (scale, size) = (layout.scales[index], layout.views_mm[index]);
            let (at, mm_per_m) = (vec2(left, bottom - size.y), 1000.0 / scale);
            self.grey(at - Vec2::Y * 1.2, &format!("{name}, scale 1:{scale:.0} on A4"), SMALL_MM + 0.2);
            let view = &self.content.views[index];
            self.elements.extend(view.elements(at, mm_per_m, self.font, self.content.units));
            self.elements.extend(ruler(vec2(left, bottom + 1.4), mm_per_m, self.content.units));
        }
        for (index, line) in MEASURES.into_iter().enumerate() {
            self.grey(vec2(MARGIN_MM, bottom + 6.4 + 2.9 * index as f32), line, SMALL_MM);
        }
        bottom + UNDER_VIEWS_MM + 0.5 * GAP_MM
    }

    /// Draws the table of lights, of at most so many rows; returns the y below.
    fn lights(&mut self, top: f32, row: f32, rows: usize) -> f32 {
        let content = self.content;
        let has_small = row == ROW_MM[0];
        let mut y = top + LINE_MM;
        let lefts = COLUMNS_MM.iter().scan(MARGIN_MM, |x, width| Some(std::mem::replace(x, *x + width)));
        let lefts: Vec<f32> = lefts.collect();
        for (left, heading) in lefts.iter().zip(COLUMNS) {
            self.grey(vec2(*left, y), heading, SMALL_MM + 0.2);
        }
        self.rule(y + 1.2);
        y += 1.2;
        let fits = if content.lights.len() > rows { rows.saturating_sub(1) } else { rows };
        for light in content.lights.iter().take(fits) {
            let base = y + if has_small { 3.9 } else { 3.1 };
            let middle = vec2(MARGIN_MM + 2.2, base - 0.36 * BODY_MM);
            if has_small {
                self.elements.extend(badge(middle, light.facts.number, light.color));
            } else {
                self.grey(vec2(MARGIN_MM, base), &light.facts.number.to_string(), SMALL_MM);
            }
            for ((cell, left), width) in light.facts.cells().iter().zip(&lefts).zip(COLUMNS_MM) {
                let indent = if *left == MARGIN_MM { 6.0 } else { 0.0 };
                let [line, small] = [(&cell[0], BODY_MM), (&cell[1], SMALL_MM)]
                    .map(|(text, size)| self.font.fitted(text, size, width - indent - 1.2));
                self.text(vec2(left + indent, base), &line, BODY_MM);
                if has_small {
                    self.grey(vec2(left + indent, base + 3.0), &small, SMALL_MM);
                }
            }
            y += row;
            self.elements
                .push(Element::line([vec2(MARGIN_MM, y), vec2(MARGIN_MM + WIDTH_MM, y)], Stroke::new([232; 3], 0.15)));
        }
        if content.lights.len() > fits {
            let more = format!("and {} more lights: the HTML sheet lists all", content.lights.len() - fits);
            self.grey(vec2(MARGIN_MM, y + 3.1), &more, SMALL_MM);
            y += row;
        }
        y + GAP_MM
    }

    fn gear_lines(&self, width: f32) -> Vec<String> {
        let pieces = self.content.gear.iter().map(|(count, name)| format!("{count} x {name}"));
        pieces.map(|piece| self.font.fitted(&piece, LIST_MM, width)).collect()
    }

    fn check_lines(&self, width: f32) -> Vec<String> {
        let checks = self.content.checks.iter();
        let lines = checks.flat_map(|check| {
            let lines = self.font.lines(check, LIST_MM, width - 3.0).into_iter().enumerate();
            lines.map(|(index, line)| if index == 0 { format!("\u{2013} {line}") } else { format!("   {line}") })
        });
        lines.collect()
    }

    /// Draws a list of at most so many lines.
    fn list(&mut self, at: Vec2, heading: &str, list: &[String], most: usize) {
        let mut at = at + Vec2::Y * HEADING_MM;
        self.elements.push(Element::text(at, heading, HEADING_MM).strong().into());
        at.y += 1.0;
        let fits = if list.len() > most { most.saturating_sub(1) } else { list.len() };
        for line in list.iter().take(fits) {
            at.y += LIST_LINE_MM;
            self.text(at, line, LIST_MM);
        }
        if list.len() > fits {
            at.y += LIST_LINE_MM;
            self.grey(at, "\u{2026} more in the HTML sheet", LIST_MM);
        }
    }

    fn foot(&mut self) {
        let at = vec2(MARGIN_MM + WIDTH_MM, PAGE_MM.y - 7.0);
        let text = concat!("Catchlight ", env!("CARGO_PKG_VERSION"));
        self.elements.push(Element::text(at, text, SMALL_MM).colored([160; 3]).aligned(Align::Right).into());
    }
}

/// Height of a ruler under a view, millimetres.
const RULER_MM: f32 = 4.0;

/// Returns a view by itself, as wide as `width_mm`, with a ruler under it.
pub fn view_drawing(content: &SheetContent, index: usize, width_mm: f32, font: &Font) -> Drawing {
    let view = &content.views[index];
    let mm_per_m = width_mm / view.size_m().x.max(1e-3);
    let size_mm = view.size_m() * mm_per_m;
    let mut elements = view.elements(Vec2::ZERO, mm_per_m, font, content.units);
    elements.extend(ruler(vec2(0.3, size_mm.y + 1.5), mm_per_m, content.units));
    Drawing { size_mm: size_mm + Vec2::Y * RULER_MM, elements }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_plan_has_the_largest_scale_that_leaves_the_elevation_readable() {
        let sizes = [vec2(3.5, 4.8), vec2(4.8, 3.6)];
        assert_eq!(scale_of(&sizes, vec2(186.0, 123.0)), 50.0);
        assert_eq!(scales_of(sizes, vec2(186.0, 123.0)), [40.0, 60.0]);
        // At 1:30 the elevation would be at 1:60
        assert_eq!(scales_of([vec2(2.8, 2.7), vec2(4.8, 2.5)], vec2(186.0, 115.0)), [40.0, 50.0]);
        assert_eq!(
            scales_of([vec2(1e5, 1.0), vec2(1.0, 1.0)], vec2(186.0, 100.0))[0],
            scale_of(&[vec2(1e5, 1.0), vec2(1.0, 1.0)], vec2(186.0, 100.0))
        );
    }

    #[test]
    fn the_scale_is_the_largest_usual_one_that_fits() {
        let room = vec2(186.0, 100.0);
        assert_eq!(scale_of(&[vec2(3.0, 3.9), vec2(4.0, 3.0)], room), 40.0);
        assert_eq!(scale_of(&[vec2(3.0, 4.1), vec2(4.0, 3.0)], room), 50.0);
        assert_eq!(scale_of(&[vec2(0.1, 0.1), vec2(0.1, 0.1)], room), 2.0);
        assert!(scale_of(&[vec2(1e5, 1.0), vec2(1.0, 1.0)], room) > 5e5);
    }
}
