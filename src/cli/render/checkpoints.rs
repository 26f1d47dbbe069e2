//! Checkpoints of a render, beside its picture.

use super::arguments::Arguments;
use crate::cli::failure::Failure;
use crate::cli::terminal;
use crate::io::{self, Loaded, RenderId};
use crate::raytrace::{Film, Settings};
use anyhow::anyhow;
use std::cell::OnceCell;
use std::path::PathBuf;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// The checkpoints of one render.
#[derive(Debug)]
pub struct Checkpoints<'a> {
    path: PathBuf,
    loaded: &'a Loaded,
    /// Text that differs between different renders of a studio.
    settings: String,
    /// Computed with the first use: hashing large models takes time.
    render: OnceCell<RenderId>,
    /// Time between two checkpoints; none writes none.
    interval: Option<Duration>,
    last: Instant,
    /// The thread that writes the last one.
    writing: Option<JoinHandle<()>>,
}

impl<'a> Checkpoints<'a> {
    /// Returns the checkpoints of a render that begins now.
    pub fn new(arguments: &Arguments, loaded: &'a Loaded, settings: &Settings) -> Self {
        let mut path = arguments.output().as_os_str().to_owned();
        path.push(".checkpoint");
        Checkpoints {
            path: path.into(),
            loaded,
            settings: format!("{settings:?} {:?}", arguments.without()),
            render: OnceCell::new(),
            interval: arguments.checkpoint_interval(),
            last: Instant::now(),
            writing: None,
        }
    }

    fn render(&self) -> RenderId {
        *self.render.get_or_init(|| RenderId::new(&self.loaded.scene, &self.loaded.assets, &self.settings))
    }

    /// Returns the samples to go on from, if the arguments say so.
    pub fn resume(&self, arguments: &Arguments) -> Result<Option<Vec<u8>>, Failure> {
        if !arguments.resume {
            return Ok(None);
        }
        let found = io::read_checkpoint(&self.path, self.render());
        let found = found.map_err(|why| {
            let path = self.path.display();
            Failure::Input(anyhow!("can't go on from the checkpoint: {why}; remove it to begin anew: {path}"))
        })?;
        if found.is_none() {
            terminal::progress(format_args!("no checkpoint, it begins with the first sample: {}", self.path.display()));
        }
        Ok(found)
    }

    /// Writes the film after a pass in the background, if the last checkpoint is old enough.
    pub fn after_pass(&mut self, film: &Film) {
        let is_due = self.interval.is_some_and(|interval| self.last.elapsed() >= interval);
        if !is_due || self.writing.as_ref().is_some_and(|writing| !writing.is_finished()) {
            return;
        }
        self.last = Instant::now();
        let (path, render, film) = (self.path.clone(), self.render(), film.clone());
        self.writing = Some(std::thread::spawn(move || {
            if let Err(error) = io::write_checkpoint(&path, render, &film) {
                terminal::warning(format_args!("no checkpoint: {error}"));
            }
        }));
    }

    /// Waits for the checkpoint that is being written, so that it is whole.
    pub fn finish_writing(&mut self) {
        if let Some(writing) = self.writing.take() {
            // A panic of the thread costs a checkpoint, no more.
            let _ = writing.join();
        }
    }

    /// Removes the checkpoint of a picture that is complete.
    pub fn remove(&self) {
        // There may be none.
        let _ = std::fs::remove_file(&self.path);
    }
}
