//! UI elements without knowledge of studios: theme, widgets, units, name fields, messages, image textures, legends.

pub mod image_texture;
pub mod legend;
pub mod lengths;
pub mod name_field;
pub mod search;
pub mod side_panel;
pub mod theme;
pub mod toasts;
pub mod units;
pub mod wake;
pub mod widgets;
pub mod window_part;
