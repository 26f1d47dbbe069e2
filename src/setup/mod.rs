//! A set-up as the light meter sees it: the exposure that each light gives where it acts, the dials for wanted exposures,
//! and the
//! part that the room has in the light.
//!
//! Data flow: `metering` -> `transport`; `wish`, `transport`, `dial_system` -> `dial_solver`; `metering`, `flare` -> `room_audit`; `measurement_job`
//! measures in the background.

mod dial_solver;
mod dial_system;
mod flare;
mod light_shape;
mod measurement_job;
mod metering;
mod room_audit;
mod transport;
mod wish;

pub use dial_solver::{DialPlan, PlannedDial, WishOutcome, solve_dials};
pub use light_shape::LightShape;
pub use measurement_job::MeasurementJob;
pub use metering::{Background, LightExposure, MeteredAt, MeteredSetup};
pub use room_audit::{AuditedLight, CeilingTrial, RoomAudit, RoomSurface};
pub use transport::{LightTransport, SetupTransport};
pub use wish::{Wish, WishError, WishLevel, WishTarget, check_wishes, named_levels, wishes};

#[cfg(test)]
mod tests;
