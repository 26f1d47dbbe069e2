//! Tiled light culling: the lights whose radius of influence intersects each screen tile.
//!
//! The bounding sphere of a light's influence is enclosed in a box in camera space, whose projection gives the tiles.
//! The test is conservative: a tile may list a light that does not reach it, but never misses one that does.

use super::light_table::{GpuLight, LightKind, LightTable};
use crate::scene::CameraFrame;
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// Tiles across the picture; repeated in `scene.wgsl`.
const COLUMNS: usize = 16;
/// Tiles down.
const ROWS: usize = 9;
/// Words (vec4u) per tile: one with the ends of the groups, then 256 light indices of one byte.
const STRIDE: usize = 17;
/// Fraction of all lights in all tiles above which tile lists do not pay.
const MAX_FILL: f32 = 0.75;
/// Size of all tile lists, bytes.
pub(crate) const TILES_BYTES: u64 = (COLUMNS * ROWS * STRIDE * size_of::<[u32; 4]>()) as u64;

/// Builds the lists of all tiles in the layout of `scene.wgsl`; none where nearly every light is in nearly every tile.
pub(crate) fn light_tiles(table: &LightTable, camera: &CameraFrame) -> Option<Vec<[u32; 4]>> {
    // Compute the rectangle of tiles of each light
    let rectangles: Vec<_> = table.lights.iter().map(|light| tile_rectangle(light, camera)).collect();
    let entries: usize = rectangles.iter().map(|(low, high)| (high[0] - low[0]) * (high[1] - low[1])).sum();
    if entries as f32 >= MAX_FILL * (table.lights.len() * COLUMNS * ROWS) as f32 {
        return None;
    }
    // Append each light to the lists of its tiles
    let mut tiles = vec![[0_u32; 4]; COLUMNS * ROWS * STRIDE];
    for (index, (light, (low, high))) in table.lights.iter().zip(rectangles).enumerate() {
        for row in low[1]..high[1] {
            for column in low[0]..high[0] {
                let tile = &mut tiles[(row * COLUMNS + column) * STRIDE..][..STRIDE];
                append(tile, index as u32, light.kind_group());
            }
        }
    }
    Some(tiles)
}

/// Appends a light to a tile's list. Lights must come in the order of their groups.
fn append(tile: &mut [[u32; 4]], index: u32, group: usize) {
    let entry = tile[0][3] as usize;
    tile[1 + entry / 16][entry / 4 % 4] |= index << (entry % 4 * 8);
    tile[0].iter_mut().skip(group).for_each(|end| *end = entry as u32 + 1);
}

/// Returns the first and one past the last tile (column, row) that a light's influence may intersect.
fn tile_rectangle(light: &GpuLight, camera: &CameraFrame) -> ([usize; 2], [usize; 2]) {
    let whole = ([0, 0], [COLUMNS, ROWS]);
    let (centre, radius_m) = bounding_sphere(light);
    let centre = camera.world_from_camera.inverse().transform_point3(centre);
    let (near, far) = (-centre.z - radius_m, -centre.z + radius_m);
    if light.cull_radius_m == 0.0 || !(far - near).is_finite() {
        return whole;
    }
    if far <= 0.0 {
        return ([0, 0], [0, 0]);
    }
    if near <= 0.0 {
        return whole;
    }
    // Project the nearest and the farthest face of the box and take the wider bounds
    let span = |centre: f32, half_extent: f32| {
        let (a, b) = (centre - radius_m, centre + radius_m);
        Vec2::new((a / near).min(a / far), (b / near).max(b / far)) / half_extent
    };
    let (x, y) = (span(centre.x, camera.half_extent.x), span(centre.y, camera.half_extent.y));
    let tile = |ndc: f32, count: usize| (0.5 * (ndc + 1.0) * count as f32).clamp(0.0, count as f32);
    let low = [tile(x.x, COLUMNS).floor() as usize, tile(-y.y, ROWS).floor() as usize];
    let high = [tile(x.y, COLUMNS).ceil() as usize, tile(-y.x, ROWS).ceil() as usize];
    (low, high)
}

/// Returns the bounding sphere of a light's influence: centre in world space, and radius in metres.
fn bounding_sphere(light: &GpuLight) -> (Vec3, f32) {
    let (position, axis, cull_radius_m) = (Vec3::from(light.position), Vec3::from(light.axis), light.cull_radius_m);
    let angle_rad = cone_rad(light);
    if angle_rad < FRAC_PI_4 {
        // The circumscribed sphere of a narrow cone passes through its apex and its rim
        let radius_m = 0.5 * cull_radius_m / angle_rad.cos();
        return (position + axis * radius_m, radius_m);
    }
    if angle_rad < FRAC_PI_2 {
        // The sphere around the rim of a wide cone contains its apex
        return (position + axis * (cull_radius_m * angle_rad.cos()), cull_radius_m * angle_rad.sin());
    }
    if light.kind == LightKind::Rect as u32 || light.kind == LightKind::Disc as u32 {
        // The influence of a panel is r = R sqrt(cos): at most 0.631 R from the point half-way along the axis
        let size_m = Vec3::from(light.right).length() + Vec3::from(light.up).length();
        return (position + axis * (0.5 * cull_radius_m), 0.632 * cull_radius_m + size_m);
    }
    (position, cull_radius_m)
}

/// Returns the half angle of the cone of a point light; pi for lights with a size or without a cone, radians.
fn cone_rad(light: &GpuLight) -> f32 {
    let spot = if light.kind == LightKind::Spot as u32 { light.outer_rad } else { PI };
    let is_point = light.kind_group() < 2 && light.kind != LightKind::Sun as u32;
    let beam = if is_point && light.has_beam != 0 { light.beam_rad[1].min(light.beam_rad[2]) } else { PI };
    spot.min(beam)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preview::lights::light_table::LightKind;
    use bytemuck::Zeroable;
    use glam::{Affine3A, Vec3};

    fn camera() -> CameraFrame {
        CameraFrame { world_from_camera: Affine3A::from_translation(Vec3::Z * 5.0), half_extent: Vec2::new(0.5, 0.3) }
    }

    fn table(places: &[(Vec3, f32)]) -> LightTable {
        let light = |&(place, cull_radius_m): &(Vec3, f32)| GpuLight {
            kind: LightKind::Point as u32,
            position: place.into(),
            cull_radius_m,
            ..GpuLight::zeroed()
        };
        LightTable { lights: places.iter().map(light).collect(), ..LightTable::default() }
    }

    fn listed(tiles: &[[u32; 4]], column: usize, row: usize) -> Vec<u32> {
        let tile = &tiles[(row * COLUMNS + column) * STRIDE..][..STRIDE];
        (0..tile[0][3] as usize).map(|k| tile[1 + k / 16][k / 4 % 4] >> (k % 4 * 8) & 255).collect()
    }

    #[test]
    fn every_point_within_the_cull_radius_is_in_a_tile_that_lists_the_light() {
        let camera = camera();
        let places: Vec<_> = (0..40)
            .map(|i| (Vec3::new((i % 7) as f32 - 3.0, (i % 5) as f32 - 2.0, (i % 11) as f32 - 5.0), 0.7))
            .collect();
        let tiles = light_tiles(&table(&places), &camera).unwrap();
        for (index, (place, reach)) in places.iter().enumerate() {
            for i in 0..200 {
                let turn = Vec2::from_angle(i as f32 * 2.4);
                let up = 1.0 - 2.0 * (i as f32 + 0.5) / 200.0;
                let side = turn * (1.0 - up * up).sqrt();
                let point = *place + Vec3::new(side.x, up, side.y) * *reach * 0.999;
                let Some(seen) = camera.project(point).filter(|p| p.min_element() >= 0.0 && p.max_element() < 1.0)
                else {
                    continue;
                };
                let (column, row) = ((seen.x * COLUMNS as f32) as usize, (seen.y * ROWS as f32) as usize);
                assert!(listed(&tiles, column, row).contains(&(index as u32)), "{place} at {seen}");
            }
        }
        let all: usize = (0..COLUMNS * ROWS).map(|t| listed(&tiles, t % COLUMNS, t / COLUMNS).len()).sum();
        assert!(all < 40 * COLUMNS * ROWS / 3, "most tiles are spared most lights: {all}");
    }

    #[test]
    fn the_bounding_sphere_of_panels_and_spots_is_tight() {
        let light = |kind: LightKind| GpuLight {
            kind: kind as u32,
            position: [1.0, 2.0, 3.0],
            axis: [0.0, 0.0, -1.0],
            cull_radius_m: 4.0,
            outer_rad: 0.4,
            ..GpuLight::zeroed()
        };
        for (kind, widest, reach) in [
            (LightKind::Rect, 1.57_f32, (|angle| angle.cos().max(0.0).sqrt()) as fn(f32) -> f32),
            (LightKind::Spot, 0.4, |_| 1.0),
            (LightKind::Spot, 1.2, |_| 1.0),
            (LightKind::Point, 3.0, |_| 1.0),
        ] {
            let (centre, radius) = bounding_sphere(&GpuLight { outer_rad: widest, ..light(kind) });
            let mut farthest = 0.0_f32;
            for i in 0..=100 {
                let angle = widest * i as f32 / 100.0;
                let away = Vec3::new(angle.sin(), 0.0, -angle.cos()) * 4.0 * reach(angle);
                farthest = farthest.max((Vec3::new(1.0, 2.0, 3.0) + away).distance(centre));
            }
            assert!(farthest <= radius * 1.0001 && farthest > 0.99 * radius, "{kind:?}: {farthest} in {radius}");
        }
    }

    #[test]
    fn groups_keep_their_order_and_lights_in_all_tiles_have_no_lists() {
        let mut many = table(&[(Vec3::ZERO, 0.0); 12]);
        assert!(light_tiles(&many, &camera()).is_none());
        let behind = GpuLight { position: [0.0, 0.0, 20.0], cull_radius_m: 1.0, ..many.lights[0] };
        many.lights.extend([behind; 12]);
        many.lights.iter_mut().skip(12).for_each(|light| light.kind = LightKind::Disc as u32);
        many.lights[10].kind = LightKind::Rect as u32;
        many.lights[11].kind = LightKind::Disc as u32;
        let tiles = light_tiles(&many, &camera()).unwrap();
        assert_eq!((tiles[0], listed(&tiles, 3, 3)), ([10, 10, 11, 12], (0..12).collect()));
        let one = light_tiles(&table(&[(Vec3::ZERO, 0.5)]), &camera()).unwrap();
        assert_eq!((listed(&one, 8, 4), listed(&one, 0, 0)), (vec![0], vec![]), "one light has a reach, too");
    }
}
