//! UI elements without knowledge of studios: theme, widgets, units, name fields, messages, image textures, legends,
//! scopes.

pub mod image_texture;
pub mod legend;
pub mod lengths;
pub mod name_field;
pub mod scopes;
pub mod search;
pub mod side_panel;
pub mod spot_readout;
pub mod theme;
pub mod toasts;
pub mod units;
pub mod wake;
pub mod widgets;
pub mod window_part;
