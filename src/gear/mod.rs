//! Gear: the heads, modifiers and stands that a photographer can take to the set.
//!
//! [`GearList`] is the list, bundled or the user's own; `io` reads and writes it. A light takes a head from it by
//! [`HeadModel::mount`]. [`shortages`] compares a studio with what the user owns.

mod list;
mod shortage;

pub use list::{GearList, HeadModel, MOST_OWNED, ModifierModel, Support, SupportKind};
pub use shortage::{GearUse, gear_use, shortages};
