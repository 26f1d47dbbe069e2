//! The tour: a few cards that point at the parts of the window.

use crate::editor::commands::command::Command;
use crate::editor::ui::theme;
use crate::editor::ui::widgets::primary_button;
use crate::editor::ui::window_part::WindowPart;
use eframe::egui::{
    Align2, Area, Button, Context, Frame, Id, Label, LayerId, Order, Pos2, Rect, RichText, Stroke, StrokeKind, Ui, vec2,
};

/// Width of a card's text, points.
const WIDTH: f32 = 300.0;
/// Room for a card with its margins, points.
const ROOM: f32 = WIDTH + 40.0;
/// A part that is lower than this is a button: its card lies below it, points.
const BUTTON_HEIGHT: f32 = 60.0;

/// A card: the part that it points at, heading and text.
const CARDS: [(WindowPart, &str, &str); 6] = [
    (
        WindowPart::Shelf,
        "The shelf",
        "Lights, figures, props and backdrops. A click puts one into the studio, where it makes sense; search finds it \
         by name.",
    ),
    (
        WindowPart::View,
        "The studio",
        "A click selects. The coloured handles move what is selected, turn it or size it; drag them, and type a number \
         for exactly that. Middle drag or Alt + left drag orbits, the wheel goes nearer.",
    ),
    (
        WindowPart::Inspector,
        "Power of a light",
        "All about what is selected, here a light. Its dial goes in stops, as on the head; below is what a meter at its \
         aim would read.",
    ),
    (
        WindowPart::Meter,
        "The light meter",
        "Puts an incident meter before the face. It shows the f-number to set, the ratios and the part of each light, \
         and follows every change.",
    ),
    (
        WindowPart::Render,
        "Render",
        "Traces the picture that the camera would take (R). Quality is the noise that it may have; \"Time and noise\" says \
         how long that takes on this machine.",
    ),
    (
        WindowPart::Picture,
        "The picture",
        "Shows it large, with histogram, false colour, and a mixer with a fader for each light. Ctrl+E exports it. \
         F1 lists all keys; the menu Help has this tour.",
    ),
];

/// The open card; none while the tour is closed.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tour {
    card: Option<usize>,
}

impl Tour {
    /// Opens the first card.
    pub fn open(&mut self) {
        self.card = Some(0);
    }

    /// Closes the tour; returns true if it was open.
    pub fn close(&mut self) -> bool {
        self.card.take().is_some()
    }

    /// Moves on from the card on rendering to that on the picture, and closes any other card, so that none lies over a
    /// picture that is being rendered.
    pub fn show_picture(&mut self) {
        self.card = self.card.filter(|card| CARDS.get(*card).is_some_and(|(part, ..)| *part == WindowPart::Render));
        self.card = self.card.map(|card| card + 1);
    }

    /// Draws the open card. `show_light` is the command that shows a light in the inspector, if there is one.
    pub fn ui(&mut self, ctx: &Context, show_light: Option<Command>, out: &mut Vec<Command>) {
        let Some(index) = self.card else { return };
        let Some((part, heading, text)) = CARDS.get(index) else { return self.card = None };
        let place = part.place(ctx);
        if let Some(place) = place {
            let painter = ctx.layer_painter(LayerId::new(Order::Foreground, Id::unique("tour mark")));
            painter.rect_stroke(place.expand(2.0), 4.0, Stroke::new(3.0, theme::ACCENT), StrokeKind::Inside);
        }
        let (at, pivot) = card_place(place, ctx.content_rect());
        let area = Area::new(Id::unique(("tour", index))).order(Order::Foreground).fixed_pos(at).pivot(pivot);
        let next = area.constrain(true).show(ctx, |ui| {
            let frame = Frame::popup(ui.style()).inner_margin(14).stroke(Stroke::new(1.0, theme::ACCENT));
            frame.show(ui, |ui| card_ui(ui, index, heading, text)).inner
        });
        if let Some(next) = next.inner {
            self.card = next.filter(|next| *next < CARDS.len());
            let shows_light = self.card.is_some_and(|next| CARDS[next].0 == WindowPart::Inspector);
            out.extend(show_light.filter(|_| shows_light));
        }
    }
}

/// Returns position and pivot of a card beside a part: below a button, else to the right or left, else in the middle.
fn card_place(part: Option<Rect>, window: Rect) -> (Pos2, Align2) {
    match part {
        Some(part) if part.height() < BUTTON_HEIGHT => (part.left_bottom() + vec2(0.0, 10.0), Align2::LEFT_TOP),
        Some(part) if part.right() + ROOM < window.right() => {
            (part.right_center() + vec2(12.0, 0.0), Align2::LEFT_CENTER)
        }
        Some(part) if part.left() - ROOM > window.left() => {
            (part.left_center() - vec2(12.0, 0.0), Align2::RIGHT_CENTER)
        }
        Some(part) => (part.center(), Align2::CENTER_CENTER),
        None => (window.center(), Align2::CENTER_CENTER),
    }
}

/// Draws a card; returns the next one, or none to end the tour, once a button is pressed.
fn card_ui(ui: &mut Ui, index: usize, heading: &str, text: &str) -> Option<Option<usize>> {
    ui.set_width(WIDTH);
    ui.horizontal(|ui| {
        ui.label(RichText::new(heading).heading().strong());
        ui.label(RichText::new(format!("{} of {}", index + 1, CARDS.len())).weak());
    });
    ui.add(Label::new(text).wrap());
    ui.add_space(6.0);
    let mut next = None;
    ui.horizontal(|ui| {
        let is_last = index + 1 == CARDS.len();
        if primary_button(ui, if is_last { "Done" } else { "Next" }, 80.0).clicked() {
            next = Some(Some(index + 1));
        }
        let back = Button::new("Back").min_size(vec2(64.0, 28.0));
        if ui.add_enabled(index > 0, back).clicked() {
            next = Some(index.checked_sub(1));
        }
        if !is_last {
            let skip = ui.add(Button::new("Skip the tour").min_size(vec2(64.0, 28.0)));
            if skip.on_hover_text("Esc; the menu Help has it").clicked() {
                next = Some(None);
            }
        }
    });
    next
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_card_lies_beside_its_part_and_inside_of_the_window() {
        let window = Rect::from_min_size(Pos2::ZERO, vec2(1440.0, 900.0));
        let parts = [
            Rect::from_min_size(Pos2::new(0.0, 30.0), vec2(270.0, 400.0)),
            Rect::from_min_size(Pos2::new(1100.0, 600.0), vec2(340.0, 290.0)),
            Rect::from_min_size(Pos2::new(400.0, 40.0), vec2(60.0, 22.0)),
        ];
        for part in parts {
            let (at, pivot) = card_place(Some(part), window);
            let card = pivot.anchor_size(at, vec2(ROOM, 160.0));
            assert!(!card.intersects(part) && window.contains_rect(card), "{card} for {part}");
        }
    }
}
