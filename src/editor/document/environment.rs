//! Reading environment maps for the window.

use crate::io;
use crate::jobs::sentence;
use crate::scene::EnvironmentMap;
use std::path::PathBuf;
use std::sync::Arc;

/// An environment map that was read.
#[derive(Clone, Debug)]
pub struct ReadEnvironment {
    /// File.
    pub file: PathBuf,
    /// The map.
    pub map: Arc<EnvironmentMap>,
    /// What is odd about the file.
    pub warnings: Vec<String>,
}

/// Reads an environment map; an error is a message to the user.
pub fn read(file: PathBuf) -> Result<Box<ReadEnvironment>, String> {
    let io::EnvironmentFile { map, warnings } = io::read_environment(&file).map_err(|error| sentence(&error))?;
    Ok(Box::new(ReadEnvironment { file, map: Arc::new(map), warnings }))
}
