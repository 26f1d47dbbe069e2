//! Elements that panels and viewport share: theme, widgets, units, toasts, the texture of a picture. They know nothing of a studio.

pub mod image_texture;
pub mod side_panel;
pub mod theme;
pub mod toasts;
pub mod units;
pub mod wake;
pub mod widgets;
