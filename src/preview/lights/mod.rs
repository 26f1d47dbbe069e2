//! Lights and lighting: the light buffer, light culling by tiles, the environment estimate, the lighting pass.

pub mod environment;
pub mod light_table;
pub mod light_tiles;
pub mod lighting_pass;
