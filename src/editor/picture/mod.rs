//! The rendered picture: the state of a render, the view that shows it.

mod compare;
pub mod mixer;
pub mod picture_view;
pub mod rendering;
pub mod variant_pictures;
