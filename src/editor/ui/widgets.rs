//! Rows and number fields with photographers' units, all named for screen readers and tests.

use crate::editor::ui::theme;
use crate::photo::thirds::Dial;
use eframe::egui::{self, Button, Color32, CornerRadius, DragValue, Event, Key, Response, RichText, Sense, Ui, vec2};
use glam::Vec3;

/// Width of the label column, points.
const LABEL_WIDTH: f32 = 96.0;

/// Width of the number beside a slider, points.
const SLIDER_NUMBER_WIDTH: f32 = 60.0;

/// Draws a collapsible section of a panel.
pub fn section(ui: &mut Ui, title: &str, open: bool, add: impl FnOnce(&mut Ui)) {
    ui.add_space(2.0);
    egui::CollapsingHeader::new(RichText::new(title).strong()).id_salt(title).default_open(open).show_unindented(
        ui,
        |ui| {
            ui.add_space(2.0);
            add(ui);
            ui.add_space(6.0);
        },
    );
    ui.separator();
}

/// Draws a label with its fields to the right; those that do not fit there go on in the next line. The label names
/// every field of the row without a name.
pub fn row<R>(ui: &mut Ui, label: &str, tip: &str, add: impl FnOnce(&mut Ui) -> R) -> R {
    ui.horizontal(|ui| {
        let size = vec2(LABEL_WIDTH, ui.spacing().interact_size.y);
        let cell = ui.allocate_ui_with_layout(size, egui::Layout::left_to_right(egui::Align::Center), |ui| {
            ui.set_min_width(LABEL_WIDTH);
            ui.add(egui::Label::new(RichText::new(label).weak()).truncate());
        });
        cell.response.on_hover_text(tip);
        let layout = egui::Layout::left_to_right(egui::Align::Center).with_main_wrap(true);
        let size = vec2(ui.available_width(), ui.spacing().interact_size.y);
        let fields = |ui: &mut Ui| {
            ui.set_max_width(size.x);
            // A slider with its number fits into the line
            let slider = size.x - SLIDER_NUMBER_WIDTH - ui.spacing().item_spacing.x;
            ui.spacing_mut().slider_width = slider.clamp(40.0, ui.spacing().slider_width);
            ui.name_inputs(label, add)
        };
        ui.allocate_ui_with_layout(size, layout, fields).inner
    })
    .inner
}

/// Draws a row with a read-only value.
pub fn fact(ui: &mut Ui, label: &str, tip: &str, value: impl Into<RichText>) {
    row(ui, label, tip, |ui| ui.label(value.into())).on_hover_text(tip);
}

/// A number field that is dragged or typed. Invalid text leaves the value unchanged.
#[derive(Clone, Copy, Debug)]
pub struct NumberField {
    speed: f64,
    low: f32,
    high: f32,
    decimals: usize,
    suffix: &'static str,
}

/// Positions, metres.
pub const METRES: NumberField = NumberField { speed: 0.01, low: -1000.0, high: 1000.0, decimals: 2, suffix: " m" };
/// Distances, metres.
pub const DISTANCE: NumberField = NumberField { speed: 0.01, low: 0.01, high: 1000.0, decimals: 2, suffix: " m" };
/// Sizes, shown in centimetres of a value in metres.
pub const SIZE_CM: NumberField = NumberField { speed: 0.5, low: 0.1, high: 10_000.0, decimals: 1, suffix: " cm" };
/// Angles, degrees.
pub const DEGREES: NumberField = NumberField { speed: 0.5, low: -360.0, high: 360.0, decimals: 1, suffix: "\u{b0}" };

impl NumberField {
    /// Returns a field with these limits.
    pub const fn new(speed: f64, low: f32, high: f32, decimals: usize, suffix: &'static str) -> Self {
        NumberField { speed, low, high, decimals, suffix }
    }

    /// Draws the field.
    pub fn ui(self, ui: &mut Ui, value: &mut f32) -> Response {
        self.scaled_ui(ui, value, 1.0)
    }

    /// Draws the field of a value that is shown multiplied by `factor`.
    pub fn scaled_ui(self, ui: &mut Ui, value: &mut f32, factor: f32) -> Response {
        let mut shown = *value * factor;
        let before = shown;
        let field = DragValue::new(&mut shown)
            .speed(self.speed)
            .range(self.low..=self.high)
            .clamp_existing_to_range(false)
            .max_decimals(self.decimals)
            .suffix(self.suffix)
            .custom_parser(move |text| crate::editor::ui::units::parse(text, self.suffix))
            .update_while_editing(false);
        let response = ui.add(field);
        // The accessible name comes from the row, not from the unit.
        ui.ctx().accesskit_node_builder(response.id, |node| node.clear_label());
        // An unchanged value keeps the digits of the file.
        if shown != before && shown.is_finite() {
            *value = shown / factor;
        }
        response
    }
}

/// Draws three fields for a position or a size, with the axes' letters.
pub fn vec3_ui(ui: &mut Ui, name: &str, number: NumberField, value: &mut Vec3) {
    const AXES: [(&str, Color32, &str); 3] = [
        ("x", Color32::from_rgb(222, 104, 96), "to the right of the room"),
        ("y", Color32::from_rgb(128, 190, 96), "up"),
        ("z", Color32::from_rgb(96, 148, 222), "to the front of the room"),
    ];
    // Three fields fit into the narrowest panel
    (ui.spacing_mut().item_spacing.x, ui.spacing_mut().button_padding.x) = (2.0, 2.0);
    for (i, (axis, color, tip)) in AXES.into_iter().enumerate() {
        ui.label(RichText::new(axis).color(color).small());
        ui.name_inputs(format!("{name} {axis}"), |ui| number.ui(ui, &mut value[i])).on_hover_text(tip);
    }
}

/// Draws a choice of values as buttons side by side.
pub fn choice<T: Copy + PartialEq>(ui: &mut Ui, value: &mut T, options: &[(T, &str, &str)]) {
    ui.spacing_mut().item_spacing.x = 2.0;
    for (option, label, tip) in options {
        if ui.add(Button::selectable(*value == *option, *label)).on_hover_text(*tip).clicked() {
            *value = *option;
        }
    }
}

/// Draws a dial of the exposure: buttons in thirds of a stop and a list of nominal values.
pub fn dial_ui(ui: &mut Ui, name: &str, dial: Dial, value: &mut f32) {
    ui.spacing_mut().item_spacing.x = 2.0;
    if small_button(ui, "\u{2212}", &format!("{name} down")).on_hover_text("A third of a stop down the scale").clicked()
    {
        *value = dial.step(*value, -1);
    }
    let label = dial.label(*value);
    egui::ComboBox::from_id_salt(name).selected_text(&label).width(84.0).show_ui(ui, |ui| {
        for thirds in dial.range() {
            let exact = dial.value(thirds);
            let text = dial.label(exact);
            let is_current = text == label;
            let response = ui.selectable_label(is_current, &text);
            if is_current {
                scroll_once(ui, name, &response);
            }
            if response.clicked() {
                *value = exact;
            }
        }
    });
    if small_button(ui, "+", &format!("{name} up")).on_hover_text("A third of a stop up the scale").clicked() {
        *value = dial.step(*value, 1);
    }
}

/// Scrolls a list that has just been opened to its current entry.
fn scroll_once(ui: &Ui, name: &str, response: &Response) {
    let id = egui::Id::unique(("opened at", name));
    let pass = ui.ctx().cumulative_pass_nr();
    let last: Option<u64> = ui.data(|data| data.get_temp(id));
    if last.is_none_or(|last| last + 1 < pass) {
        response.scroll_to_me(Some(egui::Align::Center));
    }
    ui.data_mut(|data| data.insert_temp(id, pass));
}

/// Draws a small button with a sign and an accessible name.
pub fn small_button(ui: &mut Ui, sign: &str, name: &str) -> Response {
    let response = ui.add(Button::new(sign).min_size(vec2(22.0, 22.0)));
    named(ui, &response, name);
    response
}

/// Draws the name of a light after a patch of its role's colour, none for what is no light; shortened to a width.
pub fn role_name(ui: &mut Ui, color: Option<Color32>, name: &str, width: f32) -> Response {
    let row = |ui: &mut Ui| {
        swatch(ui, color.unwrap_or(Color32::TRANSPARENT), vec2(6.0, 14.0));
        let layout = egui::Layout::left_to_right(egui::Align::Center);
        let name = |ui: &mut Ui| {
            ui.set_min_width(width);
            ui.add(egui::Label::new(name).truncate())
        };
        ui.allocate_ui_with_layout(vec2(width, 18.0), layout, name).inner
    };
    ui.horizontal(row).inner
}

/// Returns a movable window with a tool, initially at a distance from the upper left corner of a view.
pub fn tool_window(title: &str, view: egui::Rect, from_corner: egui::Vec2) -> egui::Window<'_> {
    let corner = view.min + from_corner;
    egui::Window::new(title).resizable(false).collapsible(false).default_pos(corner).constrain_to(view)
}

/// Sets the accessible name of a widget.
pub fn named(ui: &Ui, response: &Response, name: &str) {
    ui.ctx().accesskit_node_builder(response.id, |node| node.set_label(name));
}

/// Draws a button that opens a colour picker; scene-linear. An unchanged colour keeps its digits.
pub fn color_ui(ui: &mut Ui, rgb: &mut [f32; 3]) -> Response {
    let mut shown = *rgb;
    let response = ui.color_edit_button_rgb(&mut shown);
    if response.changed() && shown.iter().all(|c| c.is_finite()) {
        *rgb = shown;
    }
    response
}

/// Draws a patch of a display colour.
pub fn swatch(ui: &mut Ui, color: Color32, size: egui::Vec2) -> Response {
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    ui.painter().rect_filled(rect, CornerRadius::same(3), color);
    response
}

/// Returns the display colour of a scene-linear colour, scaled so that its largest channel is 1.
pub fn display_color(linear: Vec3) -> Color32 {
    let scaled = linear.max(Vec3::ZERO) / linear.max_element().max(1e-6);
    let [r, g, b] = scaled.to_array().map(|c| (crate::color::srgb_encode(c.min(1.0)) * 255.0 + 0.5) as u8);
    Color32::from_rgb(r, g, b)
}

/// Draws a toggle with an eye.
pub fn eye_toggle(ui: &mut Ui, seen: bool, name: &str) -> Response {
    icon_toggle(ui, name, |painter, rect, visuals| {
        let (c, color) = (rect.center(), visuals.fg_stroke.color.gamma_multiply(if seen { 1.0 } else { 0.35 }));
        let stroke = egui::Stroke::new(1.3, color);
        let arc = |up: f32| {
            (0..=8).map(move |i| {
                let t = i as f32 / 4.0 - 1.0;
                c + vec2(t * 7.0, -up * 4.5 * (1.0 - t * t))
            })
        };
        painter.line(arc(1.0).collect(), stroke);
        painter.line(arc(-1.0).collect(), stroke);
        painter.circle_filled(c, 2.0, color);
        if !seen {
            painter.line_segment([c + vec2(-6.0, 5.0), c + vec2(6.0, -5.0)], stroke);
        }
    })
}

/// Draws a toggle with a lamp, in the light's colour when it is on.
pub fn lamp_toggle(ui: &mut Ui, on: bool, glow: Color32, name: &str) -> Response {
    icon_toggle(ui, name, |painter, rect, visuals| {
        let c = rect.center();
        let stroke = egui::Stroke::new(1.3, if on { glow } else { visuals.fg_stroke.color.gamma_multiply(0.4) });
        if on {
            // The rim shows a white lamp on a light panel
            let rim = egui::Stroke::new(1.0, visuals.fg_stroke.color.gamma_multiply(0.5));
            painter.circle(c - vec2(0.0, 1.5), 4.5, glow, rim);
        } else {
            painter.circle_stroke(c - vec2(0.0, 1.5), 4.0, stroke);
        }
        painter.hline(c.x - 2.0..=c.x + 2.0, c.y + 4.5, stroke);
        painter.hline(c.x - 1.5..=c.x + 1.5, c.y + 6.5, stroke);
    })
}

/// Draws a toggle with a letter, on a patch of colour when it is on.
pub fn letter_toggle(ui: &mut Ui, letter: &str, on: bool, color: Color32, name: &str) -> Response {
    icon_toggle(ui, name, |painter, rect, visuals| {
        let patch = egui::Rect::from_center_size(rect.center(), vec2(16.0, 16.0));
        if on {
            painter.rect_filled(patch, CornerRadius::same(3), color);
        }
        let ink = if on { Color32::from_gray(16) } else { visuals.fg_stroke.color.gamma_multiply(0.45) };
        painter.text(rect.center(), egui::Align2::CENTER_CENTER, letter, egui::FontId::proportional(12.5), ink);
    })
}

/// Draws a toggle with a padlock, closed or open.
pub fn lock_toggle(ui: &mut Ui, locked: bool, name: &str) -> Response {
    icon_toggle(ui, name, |painter, rect, visuals| {
        let color = visuals.fg_stroke.color.gamma_multiply(if locked { 1.0 } else { 0.3 });
        let (c, stroke) = (rect.center(), egui::Stroke::new(1.4, color));
        let body = egui::Rect::from_center_size(c + vec2(0.0, 3.0), vec2(10.0, 7.0));
        if locked {
            painter.rect_filled(body, CornerRadius::same(1), color);
        } else {
            painter.rect_stroke(body, CornerRadius::same(1), stroke, egui::StrokeKind::Inside);
        }
        // The open shackle is lifted and turned to the side.
        let hinge = if locked { c } else { c + vec2(4.0, -1.5) };
        let bow = (0..=8).map(|i| egui::emath::Vec2::angled(std::f32::consts::PI * (1.0 + i as f32 / 8.0)));
        painter.line(bow.map(|v| hinge + vec2(0.0, -2.0) + v * 3.2).collect(), stroke);
        for side in [-3.2, 3.2] {
            painter.line_segment([hinge + vec2(side, -2.0), hinge + vec2(side, 0.0)], stroke);
        }
    })
}

fn icon_toggle(
    ui: &mut Ui,
    name: &str,
    draw: impl FnOnce(&egui::Painter, egui::Rect, &egui::style::WidgetVisuals),
) -> Response {
    let (rect, response) = ui.allocate_exact_size(vec2(22.0, 20.0), Sense::click());
    let visuals = *ui.style().interact(&response);
    if response.hovered() {
        ui.painter().rect_filled(rect, CornerRadius::same(3), visuals.weak_bg_fill);
    }
    draw(ui.painter(), rect, &visuals);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name));
    response
}

/// Returns a modal dialog in the middle of the window.
pub fn dialog(ctx: &egui::Context, name: &str) -> egui::Modal {
    let frame = egui::Frame::popup(&ctx.global_style()).inner_margin(16);
    egui::Modal::new(egui::Id::unique(name)).frame(frame).backdrop_color(Color32::from_black_alpha(140))
}

/// The heading and the answers of a question.
pub struct Question<'a, T> {
    /// Name of the dialog, unique in the window.
    pub name: &'a str,
    /// Width, points.
    pub width: f32,
    /// Heading.
    pub heading: &'a str,
    /// Label, answer and tip of each button. The last one is the answer of Esc.
    pub answers: &'a [(&'a str, T, &'a str)],
    /// Answer of Enter; none for a question that comes up unasked.
    pub on_enter: Option<T>,
}

/// Draws a question in a modal dialog, with its text above the buttons, and returns the answer.
pub fn question_dialog<T: Copy>(
    ctx: &egui::Context,
    question: &Question<'_, T>,
    add_text: impl FnOnce(&mut Ui),
) -> Option<T> {
    let mut answer = None;
    let modal = dialog(ctx, question.name).show(ctx, |ui| {
        ui.set_width(question.width);
        ui.heading(question.heading);
        add_text(ui);
        ui.add_space(8.0);
        ui.horizontal(|ui| {
            for (i, (text, each, tip)) in question.answers.iter().enumerate() {
                let button = if i == 0 {
                    primary_button(ui, text, 96.0)
                } else {
                    ui.add(Button::new(*text).min_size(vec2(96.0, 28.0)))
                };
                if button.on_hover_text(*tip).clicked() {
                    answer = Some(*each);
                }
            }
        });
        // A button with the focus takes Enter itself; a key that is held answers no question that it did not see.
        let is_enter =
            |event: &Event| matches!(event, Event::Key { key: Key::Enter, pressed: true, repeat: false, .. });
        if ui.memory(|memory| memory.focused().is_none()) && ui.input(|i| i.events.iter().any(is_enter)) {
            answer = answer.or(question.on_enter);
        }
    });
    let on_escape = question.answers.last().map(|(_, answer, _)| *answer);
    answer.or(on_escape.filter(|_| modal.should_close()))
}

/// Draws the primary button of a panel.
pub fn primary_button(ui: &mut Ui, text: &str, width: f32) -> Response {
    let label = RichText::new(text).color(Color32::from_gray(16)).strong();
    ui.add(Button::new(label).fill(theme::ACCENT).min_size(vec2(width, 28.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warm_light_has_a_warm_swatch() {
        let swatch = display_color(crate::color::rgb_from_kelvin(3200.0, 5500.0));
        assert!(swatch.r() == 255 && swatch.b() < 180);
    }
}
