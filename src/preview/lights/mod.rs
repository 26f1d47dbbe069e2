//! Lights on the CPU side: the light buffer, light culling by screen tiles, the environment estimate.

pub mod bounced_light;
pub mod environment;
pub mod intensity_tables;
pub mod light_table;
pub mod light_tiles;
