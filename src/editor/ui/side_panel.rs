//! A panel at the side of the window that keeps its width and shrinks only with the window.

use eframe::egui::{Panel, PanelState, Rangef, Ui};

/// Widths of a side panel, points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PanelWidths {
    /// Smallest and largest width.
    pub range: Rangef,
    /// Initial width.
    pub first: f32,
    /// Largest fraction of the window's width.
    pub share: f32,
}

impl PanelWidths {
    fn most(&self, window_width: f32) -> f32 {
        (self.share * window_width).clamp(self.range.min, self.range.max)
    }
}

/// The state of a side panel.
#[derive(Clone, Copy, Debug, Default)]
pub struct SidePanel {
    /// The width that the user set.
    wanted: Option<f32>,
}

impl SidePanel {
    /// Draws `panel`, which has this name as its id.
    pub fn show(&mut self, ui: &mut Ui, name: &str, panel: Panel, widths: PanelWidths, contents: impl FnOnce(&mut Ui)) {
        let (ctx, id) = (ui.ctx().clone(), ui.scope_id().with(name));
        let range = Rangef { max: widths.most(ctx.content_rect().width()), ..widths.range };
        let wanted = range.clamp(self.wanted.unwrap_or(widths.first));
        if let Some(PanelState { mut outer_rect }) = PanelState::load(&ctx, id) {
            outer_rect.set_width(wanted);
            ctx.data_mut(|data| data.insert_persisted(id, PanelState { outer_rect }));
        }
        panel.default_size(wanted).size_range(range).show(ui, contents);
        // egui stores another width when a drag of the edge ends.
        let width = PanelState::load(&ctx, id).map(|state| state.size().x);
        if ctx.input(|i| i.pointer.any_released()) {
            self.wanted = width.filter(|width| (width - wanted).abs() > 0.5).or(self.wanted);
        }
    }
}
