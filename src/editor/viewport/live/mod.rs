//! The images of the live view: GPU preview, CPU preview and traced view, the menu of their channels, and the scopes
//! over them.

pub mod channel_menu;
pub mod cpu_preview;
pub mod live_scopes;
pub mod preview_host;
pub mod traced_view;
