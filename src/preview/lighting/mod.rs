//! The passes that write the picture: lighting of the G-buffer, upsampling of drafts, glass, channel views.

pub mod glass_pass;
pub mod lighting_pass;
pub mod pipelines;
