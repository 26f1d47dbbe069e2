//! A set-up as the light meter sees it: the exposure that each light gives where it acts, and the dials for wanted
//! exposures.
//!
//! Data flow: `metering` -> `transport`; `wish`, `transport`, `dial_system` -> `dial_solver`; `transport_job` measures in the background.

mod dial_solver;
mod dial_system;
mod metering;
mod transport;
mod transport_job;
mod wish;

pub use dial_solver::{DialPlan, PlannedDial, WishOutcome, solve_dials};
pub use dial_system::DIAL_STOPS;
pub use metering::{Background, LightExposure, MeteredAt, MeteredSetup};
pub use transport::{LightTransport, SetupTransport};
pub use transport_job::TransportJob;
pub use wish::{Wish, WishError, WishLevel, WishTarget, wishes};

#[cfg(test)]
mod tests;
