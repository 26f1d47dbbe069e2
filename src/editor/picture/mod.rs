//! The rendered picture: the state of a render, the view that shows it, and the scopes over it.

mod compare;
pub mod mixer;
pub mod picture_view;
pub mod rendering;
mod scopes;
pub mod variant_pictures;
