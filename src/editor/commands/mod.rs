//! The commands that menus, shortcuts, panels and the viewport give, their shortcuts and the menu of an item.

pub mod command;
pub mod item_menu;
pub mod shortcuts;
