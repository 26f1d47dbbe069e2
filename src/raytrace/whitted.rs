//! Whitted's recursive ray tracer (1980, "An Improved Illumination Model for Shaded Display"), for comparison.
//!
//! Models Phong lobes, hard shadows, mirrored and refracted rays. Every light shines from its centre: there are no soft
//! shadows, and a large panel nearby is too bright, as the inverse square of a point's distance. A surround is an even
//! ambient light without shadows. No light bounces between surfaces but by mirrors and glass. The units are those of
//! the path tracer.

use super::bsdf::{Polarisation, fresnel, pane_transmittance};
use super::connection::Connection;
use super::emitters::MisVertex;
use super::events::{PathEvent, PathVertex};
use super::geometry::SurfaceInteraction;
use super::medium_stack::MediumStack;
use super::ray_caster::RayCaster;
use super::sink::RadianceSink;
use crate::math::Ray;
use glam::Vec3;

/// A ray of the recursion.
struct PendingRay {
    ray: Ray,
    throughput: Vec3,
    media: MediumStack,
    depth: u32,
}

/// Throughput below which rays are discarded.
const MIN_THROUGHPUT: f32 = 1.0 / 512.0;

/// Traces a camera ray and adds its contributions to `sink`. Mirrors and glass are followed `max_depth` times.
pub fn trace(caster: &mut RayCaster<'_>, origin: Vec3, direction: Vec3, max_depth: u32, sink: &mut impl RadianceSink) {
    sink.record(|| PathEvent::CameraRay { origin, direction });
    let ray = Ray { origin, direction, t_max: f32::INFINITY };
    let mut pending = vec![PendingRay { ray, throughput: Vec3::ONE, media: MediumStack::default(), depth: 0 }];
    while let Some(next) = pending.pop() {
        trace_ray(caster, next, max_depth, &mut pending, sink);
    }
}

fn trace_ray(
    caster: &mut RayCaster<'_>,
    pending_ray: PendingRay,
    max_depth: u32,
    pending: &mut Vec<PendingRay>,
    sink: &mut impl RadianceSink,
) {
    let scene = caster.scene;
    let PendingRay { ray, mut throughput, media, depth } = pending_ray;

    // Intersect the ray with the studio, and add the light of emitters in front of the surface
    let hit = if depth == 0 { caster.intersect_from_camera(&ray) } else { caster.intersect(&ray) };
    let distance = hit.map_or(f32::INFINITY, |hit| hit.t);
    if depth > 0 {
        let vertex = MisVertex::new(ray.origin, Vec3::ZERO);
        caster.add_emitter_hits(&ray, hit.as_ref(), throughput, &vertex, &media, sink);
    } else if caster.add_visible_emitter(&ray, distance, sink) {
        return;
    }
    let Some(hit) = hit else {
        sink.record(|| PathEvent::Miss);
        return;
    };
    let surface = scene.surface(&ray, &hit);
    if depth == 0 {
        sink.first_hit(|| scene.first_hit(&ray, &hit, &surface));
        sink.seen_surface(|| scene.seen_surface(&ray, throughput, &surface));
    }

    // Absorb light along the ray (Beer-Lambert) and add the surface's emission
    let view_dir = -ray.direction;
    let outside = view_dir.dot(surface.geometric_normal) >= 0.0;
    throughput *= media.transmittance_to(&scene.materials, &surface, outside, distance);
    sink.record(|| {
        let (object, part) = scene.object_and_part(&hit);
        let (position, normal, material) = (surface.position, surface.normal, surface.material);
        PathEvent::Vertex(PathVertex {
            depth,
            position,
            distance,
            normal,
            object,
            part: part.to_owned(),
            material,
            throughput,
        })
    });
    let material = &scene.materials[surface.material as usize];
    if material.is_emissive() {
        sink.record(|| PathEvent::Emission);
        sink.add(scene.emission_layer(), throughput * scene.emission(&surface) * scene.emission_time_s);
    }

    // Add direct and ambient light on fibres, from all sides
    if surface.strand.is_some() && material.fibre().is_some() {
        let bsdf = scene.bsdf(scene.material_of(&surface), &surface, view_dir, &media, Polarisation::NONE);
        add_direct_light(caster, &surface, &media, throughput, sink, |light_dir| bsdf.eval(light_dir).0);
        add_ambient_light(caster, throughput * scene.albedo(&surface), sink);
        return;
    }

    // Add direct and ambient light
    let side = if outside { 1.0 } else { -1.0 };
    let smooth = surface.normal * side;
    let normal = if smooth.dot(view_dir) > 0.0 { smooth } else { surface.geometric_normal * side };
    let phong = scene.material_point(&surface).phong();
    add_direct_light(caster, &surface, &media, throughput, sink, |light_dir| {
        let above = light_dir.dot(normal) > 0.0 && light_dir.dot(surface.geometric_normal) * side > 0.0;
        if above { phong.eval(light_dir, view_dir, normal) * light_dir.dot(normal) } else { Vec3::ZERO }
    });
    add_ambient_light(caster, throughput * phong.albedo, sink);

    // Spawn the mirrored and the transmitted ray
    let mut spawn = |direction: Vec3, throughput: Vec3, media: MediumStack| {
        if depth < max_depth && throughput.max_element() > MIN_THROUGHPUT && direction != Vec3::ZERO {
            let ray = Ray { origin: surface.spawn_origin(direction), direction, t_max: f32::INFINITY };
            pending.push(PendingRay { ray, throughput, media, depth: depth + 1 });
        }
    };
    let mirrored = (2.0 * view_dir.dot(normal) * normal - view_dir).normalize_or_zero();
    if phong.transmission <= 0.0 {
        spawn(mirrored, throughput * phong.specular, media);
        return;
    }
    if surface.is_thin {
        let transmittance = pane_transmittance(view_dir.dot(normal), material.ior());
        spawn(mirrored, throughput * (phong.specular + phong.transmission * (1.0 - transmittance)), media);
        spawn(ray.direction, throughput * phong.transmission_color(true) * transmittance, media);
        return;
    }
    let interface = media.interface(&scene.materials, surface.material, outside);
    let reflectance = fresnel::dielectric(view_dir.dot(normal), interface.eta);
    spawn(mirrored, throughput * (phong.specular + phong.transmission * reflectance), media);
    if let Some(refracted) = fresnel::refract_about(view_dir, normal, interface.eta) {
        let mut media_beyond = media;
        media_beyond.cross(surface.material, outside);
        let transmitted = phong.transmission_color(false) * ((1.0 - reflectance) * interface.radiance_scale());
        spawn(refracted, throughput * transmitted, media_beyond);
    }
}

/// Adds every light from its centre, with a hard shadow. `scatter` is BSDF times cosine.
fn add_direct_light(
    caster: &mut RayCaster<'_>,
    surface: &SurfaceInteraction,
    media: &MediumStack,
    throughput: Vec3,
    sink: &mut impl RadianceSink,
    scatter: impl Fn(Vec3) -> Vec3,
) {
    for (light, index) in caster.scene.lights.iter().zip(0..) {
        let Some(sample) = light.sample_centre(surface.position) else { continue };
        let value = scatter(sample.direction);
        if value == Vec3::ZERO {
            continue;
        }
        let origin = surface.spawn_origin(sample.direction);
        let connection = caster.connect(origin, light, &sample, *media);
        sink.record(|| PathEvent::LightSample {
            light: index,
            pmf: 1.0,
            pdf: None,
            bsdf_pdf: 0.0,
            visibility: connection.map_or(Vec3::ZERO, |connection| connection.transmittance),
            mis_weight: 1.0,
        });
        if let Some(Connection { direction, value: light_value, transmittance, .. }) = connection {
            let value = if direction == sample.direction { value } else { scatter(direction) };
            sink.add(light.layer, throughput * transmittance * value * light.tint_towards(direction) * light_value);
        }
    }
}

/// Adds surrounds, without shadows.
fn add_ambient_light(caster: &RayCaster<'_>, reflected: Vec3, sink: &mut impl RadianceSink) {
    for light in &caster.scene.lights {
        if let Some(luminance) = light.surround_luminance() {
            sink.add(light.layer, reflected * light.tint * luminance);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::raytrace::test_pictures::{blocks, mean};
    use crate::raytrace::{Method, RenderControl, Settings, prepare, render};
    use crate::scene::{Aim, Assets, Camera, Material, Object, ObjectId, Scene, Shape, Transform};
    use glam::Vec3;
    use std::ops::ControlFlow;

    #[test]
    fn a_camera_inside_of_glass_sees_a_wall_as_bright_as_the_glass_transmits_it() {
        let wall = Material { base_color: [0.0; 3], emission_cd_m2: [1000.0; 3], ..Material::default() };
        let glass =
            Material { base_color: [1.0; 3], transmission: 1.0, absorption_per_m: [0.5; 3], ..Material::default() };
        let body = |id, z: f32, size_m, material| Object {
            id: ObjectId(id),
            transform: Transform::at(Vec3::Z * z),
            material,
            ..Object::new(format!("Body {id}"), Shape::Box { size_m })
        };
        let camera =
            Camera { position: Vec3::ZERO, aim: Aim::Point(Vec3::NEG_Z), focal_length_mm: 200.0, ..Camera::default() };
        let brightness = |objects| {
            let scene = Scene { objects, camera: camera.clone(), ..Scene::default() };
            let settings = Settings { width: 6, height: 4, spp: 4, method: Method::Whitted, ..Settings::default() };
            let prepared = prepare(&scene, &Assets::default()).unwrap();
            let film = render(&prepared, &settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(()));
            mean(&blocks(&film.develop(&scene), 1))
        };
        let wall = body(1, -3.0, Vec3::new(9.0, 9.0, 0.1), wall);
        // The face is one metre away, and reflects 4 %: what comes back from the far side is a thousandth
        let ratio = brightness(vec![wall.clone(), body(2, 0.0, Vec3::splat(2.0), glass)]) / brightness(vec![wall]);
        let right = 0.96 * (-0.5_f64).exp();
        assert!((ratio / right - 1.0).abs() < 0.01, "{ratio} for {right}");
    }
}
