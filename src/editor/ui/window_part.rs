//! Where the parts of the window are that the tour points at. egui's memory keeps the places of the last frame.

use eframe::egui::{Context, Id, Rect};

/// A part of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum WindowPart {
    /// The shelf of what can be added.
    Shelf,
    /// The view in the middle.
    View,
    /// The properties of what is selected.
    Inspector,
    /// The button of the light meter.
    Meter,
    /// The render panel.
    Render,
    /// The button of the rendered picture.
    Picture,
}

impl WindowPart {
    /// Notes where the part has been drawn in this frame.
    pub fn note(self, ctx: &Context, place: Rect) {
        let pass = ctx.cumulative_pass_nr();
        ctx.data_mut(|data| data.insert_temp(self.id(), (place, pass)));
    }

    /// Returns where the part is; none if neither this frame nor the last one has drawn it.
    pub fn place(self, ctx: &Context) -> Option<Rect> {
        let (place, pass): (Rect, u64) = ctx.data(|data| data.get_temp(self.id()))?;
        (pass + 1 >= ctx.cumulative_pass_nr()).then_some(place)
    }

    fn id(self) -> Id {
        Id::unique(("part of the window", self))
    }
}
