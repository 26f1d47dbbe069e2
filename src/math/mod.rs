//! Mathematics beyond glam: safe square roots and angles, frames, quadrature, quantiles, bounded least squares, sampling
//! warps with their densities, rays with error bounds, nearest points, pictures under domes, SIMD dispatch, vectors in
//! lanes, and approximations for them.

mod angle;
pub mod approx;
mod bounded_least_squares;
mod dome;
mod frame;
mod interval;
mod lanes;
mod mean;
mod normal_map;
mod point_set;
mod quadrature;
mod quantile;
mod ray;
mod safe;
pub mod simd;
pub mod warp;

pub use angle::{atan2, sin_cos, sin_cos_eighth, sin_cos_turn};
pub use bounded_least_squares::{BoundedUnknown, LinearEquation, bounded_least_squares};
pub use dome::Dome;
pub use frame::{look_along, look_at, orthonormal_basis};
pub use interval::find_interval;
pub use lanes::Vec3Lanes;
pub use mean::mean;
pub use normal_map::{bend_above, decode_normal, position_derivatives, tangent_frame, tilted_normal};
pub use point_set::PointSet;
pub use quadrature::gauss_legendre;
pub use quantile::quantile;
pub use ray::{Ray, gamma, offset_origin};
pub use safe::{angle_between, safe_acos, safe_sqrt};
