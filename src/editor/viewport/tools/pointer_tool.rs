//! The tool that has the pointer in place of handles and selection, if one is active.

use crate::editor::commands::choices::Brush;
use crate::editor::commands::command::Command;
use crate::editor::document::item::Item;
use crate::editor::document::selection::Selection;
use crate::editor::document::studio_document::Document;
use crate::editor::viewport::tools::place_light_drag::PlaceLightDrag;
use crate::editor::viewport::tools::tank_brush::TankBrush;
use crate::editor::viewport::tools::tool_pointer::ToolPointer;
use crate::scene::{CameraFrame, Scene};
use eframe::egui::{CursorIcon, Painter, Rect, Response, Ui};

/// A tool that has the pointer.
#[derive(Clone, Debug)]
pub enum PointerTool {
    /// Places a light by its highlight, its light or its shadow.
    PlaceLight(Box<PlaceLightDrag>),
    /// Paints cells of a water tank.
    Brush(TankBrush),
}

impl PointerTool {
    /// Returns the brush, if that is the tool.
    pub fn brush(&self) -> Option<Brush> {
        match self {
            PointerTool::PlaceLight(_) => None,
            PointerTool::Brush(brush) => Some(brush.brush()),
        }
    }

    /// Returns true during a drag.
    pub fn is_dragging(&self) -> bool {
        match self {
            PointerTool::PlaceLight(drag) => drag.is_dragging(),
            PointerTool::Brush(brush) => brush.is_dragging(),
        }
    }

    /// Cancels the drag; the button may still be down.
    pub fn cancel(&mut self) {
        match self {
            PointerTool::PlaceLight(drag) => drag.cancel(),
            PointerTool::Brush(brush) => brush.cancel(),
        }
    }

    /// Returns true if the tool works on what is selected: another selection ends it.
    pub fn is_for(&self, selection: &Selection) -> bool {
        match self {
            PointerTool::PlaceLight(drag) => selection.lights().last() == Some(&drag.placing().light),
            PointerTool::Brush(brush) => selection.last() == Some(Item::Object(brush.brush().tank)),
        }
    }

    /// Handles the mouse. Returns false if what it works on no longer exists.
    pub fn drag(
        &mut self,
        ui: &Ui,
        response: &Response,
        document: &Document,
        frame: &CameraFrame,
        out: &mut Vec<Command>,
    ) -> bool {
        let pointer = ToolPointer::of(ui, response, frame);
        if pointer.is_inside || self.is_dragging() {
            ui.ctx().set_cursor_icon(CursorIcon::Crosshair);
        }
        match self {
            PointerTool::PlaceLight(drag) => drag.drag(&pointer, document, out),
            PointerTool::Brush(brush) => brush.drag(&pointer, document, out),
        }
    }

    /// Draws the tool over the view, with a line of help.
    pub fn paint(&self, painter: &Painter, scene: &Scene, frame: &CameraFrame, rect: Rect) {
        match self {
            PointerTool::PlaceLight(drag) => drag.paint(painter, scene, frame, rect),
            PointerTool::Brush(brush) => brush.paint(painter, scene, frame, rect),
        }
    }
}
