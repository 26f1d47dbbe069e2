//! Messages at the lower edge of the window. They expire, errors last, but not while the pointer is on them, and not
//! before somebody is at the window.

use crate::editor::ui::theme;
use eframe::egui::{self, Align2, Area, Frame, Id, Label, RichText};
use std::time::Duration;

/// Most messages shown at once; the oldest is removed.
const SHOWN: usize = 5;

/// The kind of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ToastKind {
    /// Information.
    Info,
    /// A warning.
    Warning,
    /// An error.
    Error,
}

impl ToastKind {
    /// Returns the display time, seconds.
    fn shown_s(self) -> f64 {
        match self {
            ToastKind::Info => 5.0,
            ToastKind::Warning => 15.0,
            ToastKind::Error => 30.0,
        }
    }
}

#[derive(Clone, Debug)]
struct Toast {
    kind: ToastKind,
    text: String,
    /// Expiry time, in egui's time; set at the first input after it is shown.
    gone_at: Option<f64>,
}

/// The messages on show.
#[derive(Clone, Debug, Default)]
pub struct Toasts {
    toasts: Vec<Toast>,
    /// The pointer was on them in the last frame.
    is_pointed_at: bool,
}

impl Toasts {
    /// Adds information.
    pub fn info(&mut self, text: impl Into<String>) {
        self.push(ToastKind::Info, text.into());
    }

    /// Adds a warning.
    pub fn warning(&mut self, text: impl Into<String>) {
        self.push(ToastKind::Warning, text.into());
    }

    /// Adds an error and logs it.
    pub fn error(&mut self, text: impl Into<String>) {
        let text = text.into();
        log::error!("{text}");
        self.push(ToastKind::Error, text);
    }

    fn push(&mut self, kind: ToastKind, text: String) {
        // A repeated message replaces the old one.
        self.toasts.retain(|toast| toast.text != text);
        self.toasts.push(Toast { kind, text, gone_at: None });
        if self.toasts.len() > SHOWN {
            self.toasts.remove(0);
        }
    }

    /// Returns the texts of one kind, oldest first.
    pub fn texts(&self, kind: ToastKind) -> Vec<&str> {
        self.toasts.iter().filter(|t| t.kind == kind).map(|t| t.text.as_str()).collect()
    }

    /// Removes the messages that somebody had time to see.
    pub fn clear_seen(&mut self) {
        self.toasts.retain(|toast| toast.gone_at.is_none());
    }

    /// Removes the messages that have expired at a time, and returns the time at which the next one does, seconds; none
    /// if none will. `has_input` is true if somebody is at the window.
    fn expire(&mut self, now: f64, has_input: bool) -> Option<f64> {
        for toast in &mut self.toasts {
            let shown_s = toast.kind.shown_s();
            if has_input {
                toast.gone_at.get_or_insert(now + shown_s);
            }
            if self.is_pointed_at {
                toast.gone_at = toast.gone_at.map(|gone_at| gone_at.max(now + 0.5 * shown_s));
            }
        }
        self.toasts.retain(|toast| toast.gone_at.is_none_or(|gone_at| now < gone_at));
        self.toasts.iter().filter_map(|toast| toast.gone_at).min_by(f64::total_cmp)
    }

    /// Draws the messages in the foreground, at the lower edge of `over`.
    pub fn ui(&mut self, ctx: &egui::Context, over: egui::Rect) {
        let now = ctx.time();
        let has_input = ctx.input(|i| !i.events.is_empty());
        if let Some(next) = self.expire(now, has_input) {
            ctx.request_repaint_after(Duration::from_secs_f64((next - now).max(0.01)));
        }
        if self.toasts.is_empty() {
            self.is_pointed_at = false;
            return;
        }
        let mut dismissed = None;
        let foot = over.center_bottom() - egui::vec2(0.0, 12.0);
        let width = (over.width() - 140.0).clamp(160.0, 560.0);
        let area = Area::new(Id::unique("toasts"))
            .fixed_pos(foot)
            .pivot(Align2::CENTER_BOTTOM)
            .order(egui::Order::Foreground)
            .show(ctx, |ui| {
                for (i, toast) in self.toasts.iter().enumerate() {
                    if toast_ui(ui, toast, width) {
                        dismissed = Some(i);
                    }
                }
            });
        self.is_pointed_at = area.response.contains_pointer();
        if let Some(i) = dismissed {
            self.toasts.remove(i);
        }
    }
}

/// Draws a message; returns true when it is dismissed.
fn toast_ui(ui: &mut egui::Ui, toast: &Toast, width: f32) -> bool {
    let color = match toast.kind {
        ToastKind::Info => theme::GOOD,
        ToastKind::Warning => theme::accent(ui),
        ToastKind::Error => theme::bad(ui),
    };
    let frame = Frame::popup(ui.style()).stroke(egui::Stroke::new(1.0, color)).inner_margin(10);
    frame
        .show(ui, |ui| {
            ui.horizontal(|ui| {
                let (dot, _) = ui.allocate_exact_size(egui::vec2(10.0, 10.0), egui::Sense::hover());
                ui.painter().circle_filled(dot.center(), 4.0, color);
                ui.vertical(|ui| {
                    ui.set_max_width(width);
                    ui.add(Label::new(RichText::new(&toast.text)).wrap());
                });
                ui.button("Dismiss").on_hover_text("Take this message away").clicked()
            })
            .inner
        })
        .inner
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_expire_errors_last_and_not_under_the_pointer() {
        let mut toasts = Toasts::default();
        toasts.info("saved");
        toasts.warning("odd");
        toasts.error("lost");
        assert_eq!(toasts.expire(50.0, false), None, "nobody is there to read them");
        assert_eq!(toasts.expire(100.0, true), Some(105.0));
        assert_eq!(toasts.expire(106.0, false), Some(115.0));
        assert!(toasts.texts(ToastKind::Info).is_empty() && toasts.texts(ToastKind::Warning) == ["odd"]);
        toasts.is_pointed_at = true;
        assert_eq!(toasts.expire(114.0, true), Some(121.5), "half of its time from when it was pointed at");
        toasts.is_pointed_at = false;
        toasts.expire(122.0, true);
        assert_eq!(toasts.texts(ToastKind::Error), ["lost"]);
        assert_eq!(toasts.expire(131.0, true), None);
        assert!(toasts.toasts.is_empty());
        // What nobody has seen is not cleared.
        toasts.error("seen");
        toasts.expire(140.0, true);
        toasts.error("new");
        toasts.clear_seen();
        assert_eq!(toasts.texts(ToastKind::Error), ["new"]);
    }
}
