//! The viewport: camera navigation, picking, overlays, the floor plan and the view through a light.

pub mod axis_widget;
pub mod floor_plan;
pub mod light_view;
pub mod live;
pub mod navigation;
pub mod overlay;
pub mod picking;
pub mod studio_view;
pub mod tools;
pub mod viewport_area;
