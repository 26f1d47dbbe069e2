//! The destination of what a sample finds.

use super::events::PathEvent;
use crate::math::Ray;
use glam::Vec3;

/// Receives the contributions of one sample, and optionally its first hit and the steps of its computation.
pub trait RadianceSink {
    /// Adds white luminance (coloured, time-integrated luminance in shared layers) to a film layer.
    fn add(&mut self, layer: usize, value: Vec3);

    /// Receives the first surface or emitter on the camera ray. The default ignores it, at no cost.
    #[inline]
    fn first_hit(&mut self, _hit: impl FnOnce() -> FirstHit) {}

    /// Receives a surface or emitter that the camera sees directly or by mirrors and clear glass. The default ignores it,
    /// at no cost.
    #[inline]
    fn seen_surface(&mut self, _surface: impl FnOnce() -> SeenSurface) {}

    /// Receives a step of the computation. The default ignores it, at no cost.
    #[inline]
    fn record(&mut self, _event: impl FnOnce() -> PathEvent) {}
}

/// The first surface or emitter that a camera ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstHit {
    /// The camera ray.
    pub ray: Ray,
    /// Distance along the ray, metres; infinite for sun and surround.
    pub distance: f32,
    /// Unit shading normal towards the viewer, world space; zero for an emitter.
    pub normal: Vec3,
    /// Base colour times its texture, also of clear glass, whose transmitted light it tints. Of a fibre, the mean albedo
    /// over all directions; white for emitters.
    pub albedo: Vec3,
    /// The object.
    pub object: FirstObject,
}

/// A surface that the camera sees directly or by mirrors and clear glass. A pane shows two of them, each in part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenSurface {
    /// Reflectance, times what mirrors and glass leave of it.
    pub albedo: Vec3,
    /// Shading normal towards the ray, world space, times the same part.
    pub normal: Vec3,
}

/// The object that a camera ray meets first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FirstObject {
    /// An emitter that the camera sees, or the body of a light.
    Emitter,
    /// The room.
    Room,
    /// Index into the scene's objects.
    Object(u32),
}
