//! The open studio and every change of it: the document, its undo history, the selection and the [`action::Action`]s.

pub mod action;
pub mod action_error;
pub mod arrange;
pub mod asset_stamps;
pub mod bounds;
pub mod catalog;
pub mod clipboard;
pub mod dial_wishes;
pub mod dials_together;
pub mod environment;
pub mod files;
pub mod framing;
pub mod gear_shelf;
pub mod history;
pub mod item;
pub mod light_mix;
pub mod measured_light;
pub mod model_import;
pub mod placement;
mod prop_list;
pub mod readout;
pub mod revisions;
pub mod selection;
pub mod studio_document;
pub mod switches;
pub mod tank_player;
