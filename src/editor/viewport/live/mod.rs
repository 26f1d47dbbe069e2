//! The images of the live view: GPU preview, CPU preview and traced view, and the menu of their channels.

pub mod channel_menu;
pub mod cpu_preview;
pub mod preview_host;
pub mod traced_view;
