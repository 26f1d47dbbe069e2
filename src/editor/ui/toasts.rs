//! Messages at the lower edge of the window. Errors and warnings stay until they are dismissed; information expires.

use crate::editor::ui::theme;
use eframe::egui::{self, Align2, Area, Frame, Id, Label, RichText};
use std::time::Duration;

/// Display time of information, seconds.
const INFO_S: f64 = 5.0;
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

#[derive(Clone, Debug)]
struct Toast {
    kind: ToastKind,
    text: String,
    /// Expiry time of information, in egui's time; set when it is first shown.
    gone_at: Option<f64>,
}

/// The messages on show.
#[derive(Clone, Debug, Default)]
pub struct Toasts {
    toasts: Vec<Toast>,
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

    /// Draws the messages in the foreground, at the lower edge of `over`.
    pub fn ui(&mut self, ctx: &egui::Context, over: egui::Rect) {
        let now = ctx.time();
        for toast in self.toasts.iter_mut().filter(|t| t.kind == ToastKind::Info) {
            let gone_at = *toast.gone_at.get_or_insert(now + INFO_S);
            ctx.request_repaint_after(Duration::from_secs_f64((gone_at - now).max(0.01)));
        }
        self.toasts.retain(|toast| toast.gone_at.is_none_or(|gone_at| now < gone_at));
        if self.toasts.is_empty() {
            return;
        }
        let mut dismissed = None;
        let foot = over.center_bottom() - egui::vec2(0.0, 12.0);
        let width = (over.width() - 140.0).clamp(160.0, 560.0);
        Area::new(Id::unique("toasts"))
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
        if let Some(i) = dismissed {
            self.toasts.remove(i);
        }
    }
}

/// Draws a message; returns true when it is dismissed.
fn toast_ui(ui: &mut egui::Ui, toast: &Toast, width: f32) -> bool {
    let color = match toast.kind {
        ToastKind::Info => theme::GOOD,
        ToastKind::Warning => theme::ACCENT,
        ToastKind::Error => theme::BAD,
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
