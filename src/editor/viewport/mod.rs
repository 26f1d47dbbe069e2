//! The viewport: camera navigation, picking, overlays, the floor plan and the view through a light.

pub mod live;
pub mod navigation;
pub mod overlays;
pub mod studio_view;
pub mod tools;
pub mod viewport_area;
