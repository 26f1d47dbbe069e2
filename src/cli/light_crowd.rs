//! The test studio of `preview --lights`: five figures, and any number of small lights around them.

use crate::scene::{Aim, Emitter, Light, LightId, Object, ObjectId, Output, Role, Scene, Shape, Transform};
use glam::{Vec2, Vec3};

/// Number of figures.
const FIGURES: u32 = 5;
/// Distance between neighbours, metres.
const APART_M: f32 = 0.75;
/// Exposure of a figure by all lights together, each at a distance of `RING_M`, lx s: f/8 at ISO 100.
const EXPOSURE_LUX_S: f32 = 160.0;
/// Radius of the ring of lights, metres.
const RING_M: f32 = 2.2;
/// Angle from one light to the next, radians: no two lights coincide.
const GOLDEN_ANGLE: f32 = 2.399_963_2;

/// Returns the studio with five figures side by side, copied if it has fewer; none if it has no figure.
pub fn five_figures(scene: &Scene) -> Option<Scene> {
    let is_figure = |object: &&Object| matches!(object.shape, Shape::Figure(_));
    let figures: Vec<Object> = scene.objects.iter().filter(is_figure).cloned().collect();
    let mut crowd = scene.clone();
    crowd.objects.retain(|object| !is_figure(&object));
    for (position, figure) in (0..FIGURES).zip(figures.iter().cycle()) {
        let mut figure = figure.clone();
        figure.id = ObjectId(crowd.fresh_object_id().0.max(1000));
        figure.name = crowd.unique_name(&figure.name);
        figure.transform = Transform {
            position: Vec3::new((position as f32 - 2.0) * APART_M, 0.0, 0.0),
            rotation_deg: Vec3::Y * (2.0 - position as f32) * 8.0,
            ..figure.transform
        };
        crowd.objects.push(figure);
    }
    // The camera frames the whole group.
    crowd.camera.position = Vec3::new(0.0, 1.5, 5.0);
    crowd.camera.aim = Aim::Point(Vec3::new(0.0, 1.1, 0.0));
    crowd.camera.focal_length_mm = 35.0;
    (!figures.is_empty()).then_some(crowd)
}

/// Returns the studio with `count` lights, which are panels, spots and bulbs in turn. Together they give the same
/// exposure for any count.
pub fn lit_by(crowd: &Scene, count: u32) -> Scene {
    let mut scene = crowd.clone();
    scene.lights = (0..count).map(|index| small_light(index, count)).collect();
    scene
}

fn small_light(index: u32, count: u32) -> Light {
    let turn = index as f32 * GOLDEN_ANGLE;
    let height_m = 0.6 + 2.0 * ((index as f32 + 0.5) / count as f32);
    // An ellipse around the group: every light has about the same distance to its nearest figure.
    let around = Vec2::from_angle(turn + 0.6) * Vec2::new(RING_M + 0.5 * APART_M * (FIGURES - 1) as f32, RING_M);
    let figure = Vec3::X * APART_M * (index % FIGURES) as f32 - Vec3::X * APART_M * 2.0;
    let emitter = match index % 3 {
        0 => Emitter::RectPanel { width_m: 0.3, height_m: 0.4 },
        1 => Emitter::Spot { inner_deg: 20.0, outer_deg: 40.0 },
        _ => Emitter::Sphere { radius_m: 0.05 },
    };
    let intensity = EXPOSURE_LUX_S * RING_M * RING_M / count as f32;
    Light {
        id: LightId(index),
        name: format!("Small light {}", index + 1),
        role: Role::Accent,
        position: Vec3::new(around.x, height_m, around.y),
        aim: Aim::Point(figure + Vec3::Y * 1.4),
        // The guide number is the distance times the f-number at ISO 100: H(1 m) = 2.5 GN^2.
        ..Light::new(emitter, Output::FlashGuideNumber((intensity / 2.5).sqrt()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photo::light::axial_intensity;

    #[test]
    fn any_number_of_lights_gives_five_figures_the_same_exposure() {
        let loaded = crate::io::find_preset("three_point").unwrap().load().unwrap();
        let crowd = five_figures(&loaded.scene).unwrap();
        let figures = crowd.objects.iter().filter(|o| matches!(o.shape, Shape::Figure(_))).count();
        assert_eq!(figures, FIGURES as usize);
        for count in [1, 4, 60] {
            let scene = lit_by(&crowd, count);
            let total: f32 = scene.lights.iter().map(|light| axial_intensity(light, None)).sum();
            assert!((total / (EXPOSURE_LUX_S * RING_M * RING_M) - 1.0).abs() < 1e-3, "{count}: {total}");
            assert_eq!((scene.lights.len(), crate::scene::validate(&scene).len()), (count as usize, 0));
        }
        assert!(five_figures(&Scene::default()).is_none());
    }
}
