//! UI elements without knowledge of studios: theme, widgets, units, messages, image textures.

pub mod image_texture;
pub mod side_panel;
pub mod theme;
pub mod toasts;
pub mod units;
pub mod wake;
pub mod widgets;
