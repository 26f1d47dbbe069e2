//! The user's commands, their shortcuts, and the menu entries of an item.

pub mod choices;
pub mod command;
pub mod file_purpose;
pub mod item_menu;
pub mod menu_entry;
pub mod preferences;
pub mod shortcuts;
