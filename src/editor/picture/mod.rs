//! The rendered picture: the state of a render and the view that shows it.

pub mod picture_view;
pub mod rendering;
