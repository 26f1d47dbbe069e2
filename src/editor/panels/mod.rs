//! The panels around the viewport. Each `*_ui` function draws from the document and pushes commands.

pub mod about;
pub mod add;
pub mod dials;
pub mod file_change_prompt;
pub mod gear;
pub mod help;
pub mod import_prompt;
pub mod inspector;
pub mod menu;
pub mod meter;
pub mod outliner;
pub mod preferences;
pub mod presets;
pub mod prompts;
pub mod quality;
pub mod recovery_prompt;
pub mod render;
pub mod room_audit;
pub mod status;
pub mod thumbnails;
pub mod tour;
pub mod variants;
pub mod view_bar;
