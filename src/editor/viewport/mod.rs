//! The viewport: navigation, the images of the live view, overlays and tools.

pub mod live;
pub mod navigation;
pub mod overlays;
pub mod studio_view;
pub mod tools;
pub mod viewport_area;
