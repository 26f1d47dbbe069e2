//! The comparison of the rendered picture with that of another variant: menu, wipe, side by side, difference.

use crate::editor::commands::choices::{CompareMode, Comparison};
use crate::editor::commands::command::Command;
use crate::editor::picture::rendering::Rendering;
use crate::editor::picture::variant_pictures::VariantPictures;
use crate::editor::ui::{legend, theme, widgets};
use crate::figures;
use crate::photo::text::signed_stops;
use crate::photo::{DIFFERENCE_STOPS, Spot, difference_color, stops_above};
use crate::scene::{Scene, VariantId};
use eframe::egui::{
    Align2, Color32, CursorIcon, FontId, Painter, Pos2, Rect, Sense, Stroke, TextureId, Ui, Vec2, pos2, vec2,
};

/// Distance of the names from the top of the view, points: under the bar and the read-out.
const LABEL_TOP: f32 = 84.0;
/// Width of the line that is dragged, points.
const GRIP: f32 = 12.0;

/// Draws the menu of comparisons; nothing for a studio without variants.
pub fn menu_ui(ui: &mut Ui, input: PictureInput<'_>, comparison: Comparison, out: &mut Vec<Command>) {
    let PictureInput { pictures, scene, .. } = input;
    if scene.variants.is_empty() {
        return;
    }
    let choices = [
        (CompareMode::Off, "This picture alone", "No comparison"),
        (CompareMode::Wipe, "Wipe", "Drag a line over the two pictures"),
        (CompareMode::SideBySide, "Side by side", "Both pictures"),
        (CompareMode::Difference, "Difference in stops", "Where this picture is brighter or darker than the other"),
    ];
    let title = choices.iter().find(|(mode, ..)| *mode == comparison.mode && *mode != CompareMode::Off);
    let button = ui.menu_button(title.map_or("Compare", |(_, name, _)| name), |ui| {
        ui.set_min_width(180.0);
        for (mode, name, tip) in choices {
            if ui.radio(comparison.mode == mode, name).on_hover_text(tip).clicked() {
                out.push(Command::Compare(Comparison { mode, ..comparison }));
            }
        }
        ui.separator();
        let shown = scene.variants.shown();
        let compared = pictures.other(comparison).map(|(id, _)| id);
        for (id, name) in scene.variants.list().filter(|(id, _)| *id != shown) {
            let has_picture = pictures.has_picture(id);
            let entry = ui.add_enabled_ui(has_picture, |ui| ui.radio(compared == Some(id), format!("with {name}")));
            if entry.inner.on_disabled_hover_text("It has no picture yet: show it and render").clicked() {
                let mode = if comparison.mode == CompareMode::Off { CompareMode::Wipe } else { comparison.mode };
                out.push(Command::Compare(Comparison { mode, with: Some(id) }));
            }
        }
    });
    button.response.on_hover_text("Compare the pictures of two variants");
}

/// What the view of the picture shows.
#[derive(Clone, Copy, Debug)]
pub struct PictureInput<'a> {
    /// The picture of the shown variant.
    pub rendering: &'a Rendering,
    /// The pictures of the other variants.
    pub pictures: &'a VariantPictures,
    /// The studio.
    pub scene: &'a Scene,
}

/// The picture of the other variant.
struct OtherPicture {
    name: String,
    texture: TextureId,
    /// Width and height on the screen, points.
    size: Vec2,
}

/// The picture or the pictures in the view.
#[derive(Debug)]
pub struct PicturePane<'a> {
    /// The pictures.
    pub input: PictureInput<'a>,
    /// Texture of the shown one.
    pub texture: TextureId,
    /// Place of one picture on the screen.
    pub place: Rect,
    /// The comparison.
    pub comparison: Comparison,
}

impl PicturePane<'_> {
    /// Draws the picture, or the comparison. `wipe` is where the line is, from 0 on the left to 1 on the right. Returns
    /// where the shown picture is, and the part of the view in which it is visible.
    pub fn ui(&self, ui: &mut Ui, view: Rect, wipe: &mut f32) -> (Rect, Rect) {
        let painter = ui.painter_at(view);
        let compared = self.input.pictures.other(self.comparison);
        let Some(other) = compared.and_then(|(id, other)| self.other(id, other)) else {
            image(&painter, self.texture, self.place);
            return (self.place, view);
        };
        let shown = self.name_of(self.input.scene.variants.shown(), self.input.rendering);
        match self.comparison.mode {
            CompareMode::Off => {
                image(&painter, self.texture, self.place);
                (self.place, view)
            }
            CompareMode::Wipe => self.wipe(ui, view, [&other.name, &shown], &other, wipe),
            CompareMode::SideBySide => self.side_by_side(ui, view, [&other.name, &shown], &other),
            CompareMode::Difference => {
                self.difference(&painter, view, [&other.name, &shown]);
                (self.place, view)
            }
        }
    }

    /// Returns the other picture at the height of the shown one. None until it has a texture.
    fn other(&self, id: VariantId, other: &Rendering) -> Option<OtherPicture> {
        let (width, height) = other.size()?;
        let size = vec2(self.place.height() * width as f32 / height as f32, self.place.height());
        Some(OtherPicture { name: self.name_of(id, other), texture: other.texture()?, size })
    }

    fn wipe(&self, ui: &mut Ui, view: Rect, names: [&str; 2], other: &OtherPicture, wipe: &mut f32) -> (Rect, Rect) {
        let (painter, place) = (ui.painter_at(view), self.place);
        self.drag_wipe(ui, view, wipe);
        let x = place.left() + place.width() * *wipe;
        let (left, right) = view.split_left_right_at_x(x.clamp(view.left(), view.right()));
        image(&ui.painter_at(left), other.texture, Rect::from_center_size(place.center(), other.size));
        image(&ui.painter_at(right), self.texture, place);
        painter.vline(x, view.y_range(), Stroke::new(2.0, theme::ACCENT));
        label(&painter, pos2(x - 8.0, view.top() + LABEL_TOP), Align2::RIGHT_TOP, names[0]);
        label(&painter, pos2(x + 8.0, view.top() + LABEL_TOP), Align2::LEFT_TOP, names[1]);
        (place, right)
    }

    fn side_by_side(&self, ui: &Ui, view: Rect, names: [&str; 2], other: &OtherPicture) -> (Rect, Rect) {
        let [left, right] = view.split_left_right_at_fraction(0.5).into();
        let offset = self.place.center() - view.center();
        let halves = [(left, other.texture, other.size), (right, self.texture, self.place.size())];
        for ((half, texture, size), name) in halves.into_iter().zip(names) {
            let painter = ui.painter_at(half);
            image(&painter, texture, Rect::from_center_size(half.center() + offset, size));
            label(&painter, half.center_top() + vec2(0.0, LABEL_TOP), Align2::CENTER_TOP, name);
        }
        ui.painter_at(view).vline(view.center().x, view.y_range(), Stroke::new(1.0, Color32::from_gray(70)));
        (Rect::from_center_size(right.center() + offset, self.place.size()), right)
    }

    /// Returns the name of a variant, with a mark if its picture is out of date.
    fn name_of(&self, id: VariantId, rendering: &Rendering) -> String {
        let name = self.input.scene.variants.name(id).unwrap_or_default();
        let scene = figures::as_variant(self.input.scene, id);
        let is_old = scene.is_some_and(|scene| rendering.is_out_of_date(&scene));
        if is_old { format!("{name} (out of date)") } else { name.to_owned() }
    }

    fn difference(&self, painter: &Painter, view: Rect, [other, shown]: [&str; 2]) {
        match self.input.pictures.difference(self.input.rendering, self.comparison) {
            None => image(painter, self.texture, self.place),
            Some(Err(message)) => {
                painter.text(view.center(), Align2::CENTER_CENTER, message, FontId::proportional(14.0), Color32::GRAY);
            }
            Some(Ok((texture, mean))) => {
                image(painter, texture, self.place);
                let line = |stops: i32| {
                    let text = match stops {
                        0 => "equal, within 1/6 stop".to_owned(),
                        -1 | 1 => format!("{stops:+} stop"),
                        _ => format!("{stops:+} stops"),
                    };
                    (difference_color(stops as f32), text)
                };
                let lines: Vec<_> = (-DIFFERENCE_STOPS..=DIFFERENCE_STOPS).rev().map(line).collect();
                legend::paint(painter, view, &format!("{shown} against {other}, mean {mean:.2} stops"), &lines);
            }
        }
    }

    /// Moves the line of the wipe with the pointer.
    fn drag_wipe(&self, ui: &mut Ui, view: Rect, wipe: &mut f32) {
        let x = self.place.left() + self.place.width() * *wipe;
        let grip = Rect::from_center_size(pos2(x, view.center().y), vec2(GRIP, view.height()));
        let response = ui.interact(grip, ui.scope_id().with("wipe"), Sense::drag());
        widgets::named(ui, &response, "Wipe line");
        let response = response.on_hover_cursor(CursorIcon::ResizeHorizontal);
        if response.dragged()
            && let Some(pointer) = response.interact_pointer_pos()
        {
            *wipe = ((pointer.x - self.place.left()) / self.place.width()).clamp(0.0, 1.0);
        }
    }
}

/// Returns the difference at a pixel in words: `+0.7 stops against A`. None without a picture of the same size.
pub fn spot_text(pixel: (u32, u32), input: PictureInput<'_>, comparison: Comparison) -> Option<String> {
    let (id, other) = input.pictures.other(comparison)?;
    let [shown, other] = [input.rendering, other].map(|rendering| rendering.developed().map(|d| &d.picture));
    let (shown, other) = (shown?, other?);
    let is_inside = pixel.0 < shown.width && pixel.1 < shown.height;
    if !is_inside || (shown.width, shown.height) != (other.width, other.height) {
        return None;
    }
    let [shown, other] =
        [shown, other].map(|picture| Spot::around(pixel, (picture.width, picture.height), |x, y| picture.at(x, y)).rgb);
    let name = input.scene.variants.name(id).unwrap_or_default();
    Some(format!("{} stops against {name}", signed_stops(stops_above(shown, other))))
}

/// Paints a picture.
fn image(painter: &Painter, texture: TextureId, place: Rect) {
    let uv = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
    painter.image(texture, place, uv, Color32::WHITE);
}

fn label(painter: &Painter, at: Pos2, align: Align2, text: &str) {
    let galley = painter.layout_no_wrap(text.to_owned(), FontId::proportional(14.0), Color32::WHITE);
    let place = align.anchor_size(at, galley.size() + vec2(12.0, 6.0));
    painter.rect_filled(place, 4.0, Color32::from_black_alpha(190));
    painter.galley(place.min + vec2(6.0, 3.0), galley, Color32::WHITE);
}
