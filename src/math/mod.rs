//! Vectors beyond glam: safe forms, frames, warps with their densities, rays with error bounds.

mod frame;
mod ray;
mod safe;
#[cfg(test)]
pub mod statistics;
pub mod warp;

pub use frame::{look_at, orthonormal_basis};
pub use ray::{Ray, gamma, offset_origin};
pub use safe::{angle_between, safe_acos, safe_sqrt};
