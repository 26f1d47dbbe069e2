//! The ray tracer.
//!
//! [`prepare()`] turns a scene into flat tables, [`render()`] adds sample passes to a [`Film`], [`Film::develop`] makes the
//! picture. In a pass, `pixel_sampler` makes camera rays, `path_tracer` traces their paths with the help of
//! `ray_caster`, `connection`, `emitters`, `lights`, `bsdf` and `caustics`, and a `sink` receives the contributions behind
//! the film's non-finite gate. [`LightMeter`] traces from a receptor instead of a camera, [`LivePicture`] keeps a film while the
//! scene changes, [`replay()`] records every step of one sample.
//!
//! No clock, no entropy, no globals. A rendered value is a function of scene, pixel, sample, dimension and seed: the
//! same bits for any number of threads.
//!
//! To add a rendering method: [`Method`], `limits`, `pixel_sampler`. To add a step to replays: `events`, and its line of
//! text in the command line's `explain_pixel`.
//!
//! A new film channel needs
//! - a field of `sink::FirstHit` or `sink::SeenSurface`, and its check in `film::gate`;
//! - its sum in `film::aov`, with the copies of bands and `BYTES_PER_PIXEL`;
//! - its sum without rounding in `film_part`, with `FilmPart::bytes`;
//! - a field of `photo::AovPicture`;
//! - its names in `io::picture` and in `io::picture::part_file`.

mod aggregate;
mod approximated_vertex;
mod approximations;
mod blas;
mod bsdf;
mod bvh;
mod caustics;
mod coarse;
mod connection;
mod control;
mod coverage;
mod emitters;
mod enclosure;
mod events;
mod exact_sum;
mod face_stack;
mod film;
mod film_part;
mod geometry;
mod geometry_cache;
mod intersectors;
mod irradiance_cache;
mod irradiance_gather;
mod irradiance_probes;
mod lens;
mod light_meter;
mod lights;
mod limits;
mod live;
mod medium_stack;
mod moments;
mod noise_target;
mod passes;
mod path_lights;
mod path_splitting;
mod path_tracer;
mod pilot_path;
mod pixel_sampler;
mod plan;
mod prepare;
mod primary_objects;
mod ray_caster;
mod ray_filter;
mod regularisation;
mod render;
mod render_part;
mod render_scene;
mod replay;
mod retrace;
mod roulette;
mod sample_pass;
mod sampler;
mod settings;
mod shadow_ray;
mod simd;
mod sink;
mod straight_path;
mod strand_blas;
mod strand_detail;
mod strand_geometry;
mod strand_surface;
#[cfg(test)]
mod strand_tests;
mod subsurface;
#[cfg(test)]
mod test_pictures;
mod texture;
mod textured_surface;
mod voxels;
mod wavefront;
mod whitted;

pub use approximations::Approximations;
pub use control::RenderControl;
pub use events::{PathEnd, PathEvent, PathVertex, ScatteringKind};
pub use exact_sum::ExactSum;
pub use film::{Film, Layer, MAX_LIGHT_LAYERS, MIN_ESTIMATE_SPP, NonFiniteReport, TILE};
pub use film_part::{FilmPart, PartAovs, PartLayer, PixelSum};
pub use geometry_cache::GeometryCache;
pub use intersectors::{IntersectionMethod, Intersector};
pub use irradiance_probes::{IrradianceProbes, ProbeScene};
pub use light_meter::{DirectLight, LightMeter, MeterEffort, MeterPoint, MeterResult, MeteredSource, SurfacePoint};
pub use live::{AtrousFilter, LiveCamera, LivePicture};
pub use noise_target::{NoiseTarget, predicted_rays_left};
pub use plan::{RenderPlan, Shortcut};
pub use prepare::{PrepareError, Purpose, prepare, prepare_for, prepare_kept};
pub use primary_objects::{bodies_in_picture, primary_objects};
pub use render::{TracedFilm, empty_film, render, resume, resume_coarse_first};
pub use render_part::render_part;
pub use render_scene::RenderScene;
pub use replay::{Replay, brightest_sample, replay};
pub use retrace::is_up_to_date;
pub use sampler::SampleId;
pub use settings::{Method, Settings};
pub use voxels::{VoxelGrid, VoxelHit, VoxelWay};
