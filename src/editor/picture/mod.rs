//! The rendered picture: the state of a render, the view that shows it, and its mixer.

mod compare;
pub mod mixer;
pub mod picture_view;
pub mod render_settings;
pub mod rendering;
pub mod variant_pictures;
