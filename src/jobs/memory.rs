//! The memory that a render needs, and what is free for it.

use crate::raytrace::{Film, FilmPart, Settings};
use std::fmt;
use sysinfo::{MemoryRefreshKind, Process, ProcessRefreshKind, ProcessesToUpdate, System};

/// The memory of a render from the first ray on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RenderMemory {
    /// What it takes, about: film, snapshot, picture, and denoised layers where the render keeps what the denoiser needs.
    pub need: Bytes,
    /// What the process may still take; none where the system does not tell.
    pub free: Option<Bytes>,
    /// What it would take with a layer for each light, if the lights of a role share one for want of memory.
    pub unshared: Option<Bytes>,
}

impl RenderMemory {
    /// Returns true if the need is more than what is free.
    pub fn is_too_little(&self) -> bool {
        self.free.is_some_and(|free| self.need > free)
    }

    /// Returns why lights share layers, and what follows from it; none if they do not.
    pub fn sharing(&self) -> Option<String> {
        let unshared = RenderMemory { need: self.unshared?, ..*self };
        Some(format!(
            "with a layer for each light {unshared}: the lights of a role share one, and cannot be changed one by one \
             after the render"
        ))
    }
}

impl fmt::Display for RenderMemory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the picture takes about {} of memory", self.need)?;
        self.free.map_or(Ok(()), |free| write!(f, ", and {free} are free"))
    }
}

/// An amount of memory, shown in MB or GB.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Bytes(pub u64);

impl fmt::Display for Bytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mb = self.0 as f64 / 1e6;
        if mb < 1e3 { write!(f, "{mb:.0} MB") } else { write!(f, "{:.1} GB", mb / 1e3) }
    }
}

/// The memory of a picture beside its film, bytes per pixel: what is written or shown, in floats and in 8 bits.
const PICTURE_BYTES: u64 = 12 + 3;
/// The memory of developed AOVs, bytes per pixel: those of the file and those of the denoiser.
const AOV_BYTES: u64 = 2 * 32;
/// The memory of denoising, bytes per pixel: of each layer, noisy and denoised, and of the factors by which the layers
/// sum to the picture.
const DENOISED_LAYER_BYTES: u64 = 2 * 12;
const DENOISED_SHARES_BYTES: u64 = 2 * 24;

/// Returns the memory that a render of a prepared scene takes: the film, its snapshot if there is one for a checkpoint or
/// for the window, the developed picture, and with AOVs the layers that are denoised.
pub(super) fn needed(settings: &Settings, layers: usize, snapshot: bool) -> Bytes {
    let denoised = DENOISED_SHARES_BYTES + DENOISED_LAYER_BYTES * layers as u64;
    let aovs = if settings.aovs { AOV_BYTES + denoised } else { 0 };
    let films = if snapshot { 2 } else { 1 };
    Bytes(films * Film::bytes(settings, layers) + settings.pixels() * (PICTURE_BYTES + aovs))
}

/// Returns the memory that a part of a picture's samples takes: its sums, and the film of one sample.
pub(super) fn needed_by_part(settings: &Settings, layers: usize) -> Bytes {
    Bytes(FilmPart::bytes(settings, layers) + Film::bytes(settings, layers))
}

/// Returns the memory that this process may still take, within the machine and within its control group. None where the
/// system does not tell.
pub(super) fn free() -> Option<Bytes> {
    let own = sysinfo::get_current_pid().ok()?;
    let mut system = System::new().ok()?;
    system.refresh_memory_specifics(MemoryRefreshKind::nothing().with_ram());
    system.refresh_processes_specifics(ProcessesToUpdate::Some(&[own]), false, ProcessRefreshKind::nothing());
    let machine = Some(system.available_memory()).filter(|bytes| *bytes > 0);
    // The pages of files in a group's memory are given back when it is needed.
    let group = system.process(own).and_then(Process::cgroup_limits);
    let group = group.map(|limits| limits.total_memory.saturating_sub(limits.rss));
    machine.into_iter().chain(group).min().map(Bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jobs::{RenderError, RenderInput, RenderMonitor, RenderStage, Rendered, render, render_part};
    use crate::raytrace::{GeometryCache, RenderControl};
    use crate::scene::{Assets, Emitter, Light, LightId, Output, Room, Scene};
    use glam::Vec3;
    use std::sync::Arc;

    /// Returns a room with three lights of one role.
    fn three_lights() -> Scene {
        let light = |id: u8| Light {
            id: LightId(id.into()),
            name: format!("Light {id}"),
            position: Vec3::new(f32::from(id) - 1.0, 2.0, 0.0),
            ..Light::new(Emitter::Point, Output::Lumens(1000.0))
        };
        Scene { room: Some(Room::default()), lights: (0..3).map(light).collect(), ..Scene::default() }
    }

    /// Calls a function with the input of a render of [`three_lights`] within some memory.
    fn with_memory<T>(memory: Bytes, run: impl FnOnce(&RenderInput<'_>) -> T) -> T {
        let settings = Settings { width: 40, height: 30, spp: 2, ..Settings::default() };
        let input = RenderInput {
            scene: &three_lights(),
            assets: &Assets::default(),
            cache: &GeometryCache::default(),
            settings: &settings,
            without: &[],
            checkpoint: None,
            time_limit: None,
            memory: Some(memory),
            snapshots: true,
        };
        run(&input)
    }

    fn rendered(memory: Bytes) -> Result<(Rendered, Option<RenderMemory>), RenderError> {
        with_memory(memory, |input| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
            let monitor = RenderMonitor::new(input.settings, Arc::new(RenderControl::new()));
            let mut told = None;
            let rendered = render(input, &pool, &monitor, &mut |stage| {
                if let RenderStage::Prepared(_, memory) = stage {
                    told = Some(memory);
                }
            })?;
            Ok((rendered, told))
        })
    }

    #[test]
    fn lights_of_a_role_share_a_layer_where_the_memory_does_not_suffice_for_one_each() {
        let four_layers = with_memory(Bytes(0), |input| needed(input.settings, 4, true));
        let (whole, told) = rendered(four_layers).unwrap();
        let memory = RenderMemory { need: four_layers, free: Some(four_layers), unshared: None };
        assert_eq!((whole.film.layers().len(), told), (4, Some(memory)));
        assert_eq!(memory.sharing(), None);
        let little = Bytes(four_layers.0 - 1);
        let (shared, told) = rendered(little).unwrap();
        let told = told.unwrap();
        assert_eq!((shared.film.layers().len(), told.unshared, told.free), (2, Some(four_layers), Some(little)));
        assert!(
            told.need < little && told.sharing().unwrap().starts_with("with a layer for each light the picture takes")
        );
        let scene = three_lights();
        for (one, other) in whole.film.develop(&scene).rgb.iter().zip(&shared.film.develop(&scene).rgb) {
            let (one, other) = (Vec3::from(*one), Vec3::from(*other));
            assert!((one - other).length() <= 1e-5 * one.length(), "{one} {other}: the same light, added otherwise");
        }
    }

    #[test]
    fn a_resumed_render_keeps_the_layers_of_its_checkpoint_whatever_the_memory() {
        let plenty = Bytes(1 << 40);
        let little = with_memory(Bytes(0), |input| Bytes(needed(input.settings, 4, true).0 - 1));
        let resumed = |bytes: &[u8], memory| {
            with_memory(memory, |input| {
                let input = RenderInput { checkpoint: Some(bytes), ..*input };
                let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
                let monitor = RenderMonitor::new(input.settings, Arc::new(RenderControl::new()));
                render(&input, &pool, &monitor, &mut |_| {})
            })
        };
        for (first, then, layers) in [(little, plenty, 2), (plenty, little, 4)] {
            let (whole, _) = rendered(first).unwrap();
            let mut bytes = Vec::new();
            whole.film.store(&mut bytes).unwrap();
            let resumed = resumed(&bytes, then).unwrap();
            assert_eq!(resumed.film.layers().len(), layers);
            assert_eq!(resumed.film.develop(&three_lights()), whole.film.develop(&three_lights()));
        }
        let error = resumed(b"of another render", plenty).unwrap_err();
        assert!(matches!(error, RenderError::Checkpoint(_)), "{error}");
    }

    #[test]
    fn a_picture_that_does_not_fit_into_the_memory_is_refused_before_its_first_ray() {
        let two_layers = with_memory(Bytes(0), |input| needed(input.settings, 2, true));
        let error = rendered(Bytes(two_layers.0 - 1)).unwrap_err().to_string();
        assert!(
            error.starts_with("the picture takes about 0 MB of memory, and 0 MB are free: choose a smaller size"),
            "{error}"
        );
        // Parts of a picture have the layers of all machines, and sums without rounding.
        let four_layers = needed_by_part(&Settings { width: 40, height: 30, ..Settings::default() }, 4);
        assert_eq!(four_layers, Bytes(40 * 30 * (4 * 48 + 16 + 4 * 12 + 8)));
        let refused = with_memory(Bytes(four_layers.0 - 1), |input| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
            let monitor = RenderMonitor::new(input.settings, Arc::new(RenderControl::new()));
            render_part(input, 0..1, &pool, &monitor, &mut |_| {}).unwrap_err()
        });
        assert!(matches!(refused, RenderError::Memory(_)), "{refused}");
    }

    #[test]
    fn the_free_memory_is_some_and_less_than_that_of_any_machine() {
        let free = free().unwrap();
        assert!(free > Bytes(1 << 20) && free < Bytes(1 << 50), "{free:?}");
    }

    #[test]
    fn the_need_grows_with_pixels_layers_and_aovs() {
        let settings = Settings { width: 6000, height: 4000, ..Settings::default() };
        let five = needed(&settings, 5, true);
        // Five layers of three floats, two blocks of luminance; twice; and the picture.
        assert_eq!(five, Bytes(24_000_000 * (2 * (5 * 12 + 8) + 15)));
        assert_eq!(five.to_string(), "3.6 GB");
        assert!(needed(&settings, 6, true) > five);
        // Two sets of AOVs of 32 bytes; five layers, noisy and denoised, and two sets of shares.
        let with_aovs = Settings { aovs: true, ..settings.clone() };
        let film = Film::bytes(&with_aovs, 5);
        let denoising = 24_000_000 * (5 * 24 + 2 * 24);
        assert_eq!(needed(&with_aovs, 5, false), Bytes(film + 24_000_000 * (15 + 64) + denoising));
        assert_eq!(needed(&settings, 5, false), Bytes(24_000_000 * (5 * 12 + 8 + 15)));
        let quarter = Settings { width: 3000, height: 2000, ..settings };
        assert_eq!(needed(&quarter, 5, true).0 * 4, five.0);
        assert_eq!(needed(&quarter, 5, true).to_string(), "906 MB");
    }
}
