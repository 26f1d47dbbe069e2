//! Overlays that egui paints over the live view: markers and labels, the metre grid, the view through a light, the
//! axes.

pub mod axis_widget;
pub mod floor_plan;
pub mod light_view;
pub mod markers;
