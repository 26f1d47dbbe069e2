//! Read access to the application, for the window's main loop and for tests.

use crate::editor::commands::choices::CentralView;
use crate::editor::commands::preferences::Preferences;
use crate::editor::document::selection::Selection;
use crate::editor::document::studio_document::Document;
use crate::editor::panels::thumbnails::Thumbnails;
use crate::editor::picture::rendering::Rendering;
use crate::editor::picture::variant_pictures::VariantPictures;
use crate::editor::ui::toasts::Toasts;
use crate::editor::viewport::viewport_area::Viewport;
use crate::editor::window::app::App;
use crate::jobs::{Forecaster, MeterJob, PatternJob};
use std::time::Duration;

impl App {
    /// Returns the open studio.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// Returns the selection.
    pub fn selection(&self) -> &Selection {
        &self.selection
    }

    /// Returns render settings, job and picture.
    pub fn rendering(&self) -> &Rendering {
        &self.rendering
    }

    /// Returns the mutable render settings.
    pub fn rendering_mut(&mut self) -> &mut Rendering {
        &mut self.rendering
    }

    /// Returns the pictures of the variants that are not shown.
    pub fn variant_pictures(&self) -> &VariantPictures {
        &self.variant_pictures
    }

    /// Returns the preferences.
    pub fn preferences(&self) -> &Preferences {
        self.session.preferences.get()
    }

    /// Returns the messages.
    pub fn toasts(&self) -> &Toasts {
        &self.toasts
    }

    /// Returns the viewport.
    pub fn viewport(&self) -> &Viewport {
        &self.views.viewport
    }

    /// Returns the light meter's job.
    pub fn meter(&self) -> &MeterJob {
        &self.background.meter
    }

    /// Returns the pattern check of the selected figure's face.
    pub fn pattern(&self) -> &PatternJob {
        &self.background.pattern
    }

    /// Returns the thumbnails.
    pub fn thumbnails(&self) -> &Thumbnails {
        &self.background.thumbnails
    }

    /// Returns the title of the window.
    pub fn title(&self) -> &str {
        &self.window.title
    }

    /// Returns the central view.
    pub fn central_view(&self) -> CentralView {
        self.views.central
    }

    /// Returns true during background work: files, a render, the start of the preview or its full image, a file dialog.
    pub fn is_busy(&self) -> bool {
        self.background.is_busy()
            || self.rendering.is_busy()
            || self.variant_pictures.is_busy()
            || self.session.is_waiting()
            || self.views.viewport.preview.is_starting()
            || self.views.viewport.is_reading_spot()
            || (self.views.viewport.preview.is_draft() && self.views.central != CentralView::Picture)
    }

    /// Returns the time from the start of the program to the end of the first frame.
    pub fn first_frame(&self) -> Option<Duration> {
        self.diagnostics.first_frame
    }

    /// Returns the forecast of renders.
    pub fn forecaster(&self) -> &Forecaster {
        &self.background.forecaster
    }
}
