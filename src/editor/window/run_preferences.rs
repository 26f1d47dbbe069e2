//! The preferences in effect, and the tour of the first start.

use crate::editor::commands::command::Command;
use crate::editor::commands::preferences::{Preferences, SCALES};
use crate::editor::document::item::Item;
use crate::editor::panels::preferences::preferences_ui;
use crate::editor::ui::lengths;
use crate::editor::ui::window_part::WindowPart;
use crate::editor::window::app::App;
use crate::scene::Role;
use eframe::egui::{Context, Rect};

impl App {
    /// Makes the window look as the preferences say.
    pub(super) fn use_preferences(&self, ctx: &Context) {
        let Preferences { scale, theme, units, .. } = *self.session.preferences.get();
        ctx.set_zoom_factor(scale);
        ctx.set_theme(theme);
        lengths::set_units(ctx, units);
    }

    /// Changes the preferences.
    pub(super) fn set_preferences(&mut self, preferences: Preferences, ctx: &Context) {
        self.session.preferences.set(preferences);
        self.use_preferences(ctx);
    }

    /// Draws the tour, if it is open and no dialog is. Its card on power shows the key light.
    pub(super) fn tour_ui(&mut self, ctx: &Context, view: Rect, out: &mut Vec<Command>) {
        WindowPart::View.note(ctx, view);
        if self.session.is_asking() || self.panels.preset_picker.is_open() {
            return;
        }
        let lights = &self.document.scene().lights;
        let key = lights.iter().find(|light| light.role == Role::Key).or(lights.first());
        let is_shown = matches!(self.selection.last(), Some(Item::Light(_)));
        let show_light = key.filter(|_| !is_shown).map(|key| Command::Select(Some(Item::Light(key.id))));
        self.panels.tour.ui(ctx, show_light, out);
    }

    /// Draws the preferences, if they are open. egui's keys change the scale, too: it is kept then.
    pub(super) fn preferences_ui(&mut self, ctx: &Context, out: &mut Vec<Command>) {
        let kept = *self.session.preferences.get();
        if ctx.options(|options| options.theme_preference) != kept.theme {
            ctx.set_theme(kept.theme);
        }
        let scale = ctx.zoom_factor();
        if scale != kept.scale && (SCALES.0..=SCALES.1).contains(&scale) {
            self.session.preferences.set(Preferences { scale, ..kept });
        }
        preferences_ui(ctx, &mut self.panels.show_preferences, self.session.preferences.get(), out);
    }
}
