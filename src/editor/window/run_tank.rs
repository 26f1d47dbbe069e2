//! Water that runs in the studio.

use crate::editor::window::app::App;
use crate::scene::ObjectId;
use eframe::egui::Context;

impl App {
    /// Lets the water of a tank run; none holds it.
    pub(super) fn play_tank(&mut self, tank: Option<ObjectId>) {
        self.panels.tank_player.play(self.document.scene(), tank);
    }

    /// Moves the water that runs on, once the surfaces of its last time are there.
    pub(super) fn advance_tank(&mut self, ctx: &Context) {
        if !self.panels.tank_player.is_running() {
            return;
        }
        let is_built = !self.background.tasks.is_busy() && self.document.wanted_assets().is_empty();
        let clock_s = ctx.input(|input| input.time);
        if let Some(action) = self.panels.tank_player.advance(self.document.scene(), clock_s, is_built) {
            self.apply(action, Some(self.panels.tank_player.merge_id()));
        }
        ctx.request_repaint();
    }
}
