//! The windows about the set-up: wanted exposures, the room's part in the light, and the gear for it.

use crate::editor::commands::command::Command;
use crate::editor::document::dial_wishes::dial_action;
use crate::editor::document::gear_shelf::GearEntry;
use crate::editor::panels::dials::dials_ui;
use crate::editor::panels::gear::gear_ui;
use crate::editor::panels::room_audit::room_audit_ui;
use crate::editor::ui::wake::wake;
use crate::editor::window::app::App;
use crate::setup::DialPlan;
use eframe::egui::{Context, Rect};

impl App {
    /// Draws the windows that are open, and meters the lights for them.
    pub(super) fn setup_windows_ui(&mut self, ctx: &Context, view: Rect, out: &mut Vec<Command>) {
        let (scene, assets, revision) = (self.document.scene(), self.document.assets(), self.document.revision());
        let (panels, transport) = (&mut self.panels, &mut self.background.transport);
        if panels.show_dials {
            transport.update(scene, assets, revision, &wake(ctx));
            dials_ui(ctx, view, &mut panels.show_dials, &mut panels.dial_wishes, transport, scene, out);
        } else {
            transport.reset();
        }
        let audit = &mut self.background.room_audit;
        if panels.show_room_audit {
            audit.update(scene, assets, revision, &wake(ctx));
            room_audit_ui(ctx, view, &mut panels.show_room_audit, audit.latest(), audit.is_current());
        } else {
            audit.reset();
        }
        if panels.show_gear {
            gear_ui(ctx, view, &mut panels.show_gear, &mut panels.gear_tab, &panels.gear, scene, out);
        }
    }

    /// Shows or hides the window of the user's gear; it shows the file as it is now.
    pub(super) fn toggle_gear(&mut self) {
        self.panels.show_gear = !self.panels.show_gear;
        if self.panels.show_gear {
            self.panels.gear.read();
        }
    }

    /// Notes how many pieces the user owns.
    pub(super) fn set_owned(&mut self, entry: &GearEntry, count: u32) {
        if let Err(message) = self.panels.gear.set_owned(entry, count) {
            self.toasts.error(format!("Your gear is not saved: {message}"));
        }
    }

    /// Sets the dials of a plan.
    pub(super) fn set_dials(&mut self, plan: &DialPlan) {
        if let Some(action) = dial_action(plan, self.document.scene()) {
            self.apply(action, None);
        }
    }
}
