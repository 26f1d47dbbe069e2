//! Which lights reach which part of the picture, so that of many lights each pixel pays for few.
//!
//! A light's ball of reach is boxed in the camera's space and the box projected: a tile may list a light that does not
//! reach it, never the other way round.

use super::light_table::{GpuLight, LightTable};
use crate::scene::CameraFrame;
use glam::Vec2;

/// Tiles across the picture; repeated in `scene.wgsl`.
const COLUMNS: usize = 16;
/// Tiles down.
const ROWS: usize = 9;
/// Words of four numbers a tile: the ends of the families, then 256 indices of a byte.
const STRIDE: usize = 17;
/// Fewer lights than this are not worth a list, and are shown without a limit to their reach.
const FEWEST: usize = 9;
/// Bytes of all lists.
pub(super) const TILES_BYTES: u64 = (COLUMNS * ROWS * STRIDE * size_of::<[u32; 4]>()) as u64;

/// The lists of all tiles, as `scene.wgsl` reads them.
pub(super) fn light_tiles(table: &LightTable, camera: &CameraFrame) -> Option<Vec<[u32; 4]>> {
    if table.lights.len() < FEWEST {
        return None;
    }
    let mut tiles = vec![[0_u32; 4]; COLUMNS * ROWS * STRIDE];
    for (index, light) in table.lights.iter().enumerate() {
        let (low, high) = tiles_reached(light, camera);
        for row in low[1]..high[1] {
            for column in low[0]..high[0] {
                let tile = &mut tiles[(row * COLUMNS + column) * STRIDE..][..STRIDE];
                append(tile, index as u32, light.family());
            }
        }
    }
    Some(tiles)
}

/// Adds a light to a tile's list. Lights come in the order of their families.
fn append(tile: &mut [[u32; 4]], index: u32, family: usize) {
    let place = tile[0][3] as usize;
    tile[1 + place / 16][place / 4 % 4] |= index << (place % 4 * 8);
    tile[0].iter_mut().skip(family).for_each(|end| *end = place as u32 + 1);
}

/// First and one past the last tile across and down that a light may reach.
fn tiles_reached(light: &GpuLight, camera: &CameraFrame) -> ([usize; 2], [usize; 2]) {
    let whole = ([0, 0], [COLUMNS, ROWS]);
    let centre = camera.world_from_camera.inverse().transform_point3(light.position.into());
    let (near, far) = (-centre.z - light.reach_m, -centre.z + light.reach_m);
    if light.reach_m == 0.0 || !(far - near).is_finite() {
        return whole;
    }
    if far <= 0.0 {
        return ([0, 0], [0, 0]);
    }
    if near <= 0.0 {
        return whole;
    }
    // Over the box's nearest and farthest face, whichever reaches out more.
    let span = |middle: f32, half_extent: f32| {
        let (a, b) = (middle - light.reach_m, middle + light.reach_m);
        Vec2::new((a / near).min(a / far), (b / near).max(b / far)) / half_extent
    };
    let (x, y) = (span(centre.x, camera.half_extent.x), span(centre.y, camera.half_extent.y));
    let tile = |ndc: f32, count: usize| (0.5 * (ndc + 1.0) * count as f32).clamp(0.0, count as f32);
    let low = [tile(x.x, COLUMNS).floor() as usize, tile(-y.y, ROWS).floor() as usize];
    let high = [tile(x.y, COLUMNS).ceil() as usize, tile(-y.x, ROWS).ceil() as usize];
    (low, high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preview::light_table::Kind;
    use bytemuck::Zeroable;
    use glam::{Affine3A, Vec3};

    fn camera() -> CameraFrame {
        CameraFrame { world_from_camera: Affine3A::from_translation(Vec3::Z * 5.0), half_extent: Vec2::new(0.5, 0.3) }
    }

    fn table(places: &[(Vec3, f32)]) -> LightTable {
        let light = |&(place, reach_m): &(Vec3, f32)| GpuLight {
            kind: Kind::Point as u32,
            position: place.into(),
            reach_m,
            ..GpuLight::zeroed()
        };
        LightTable { lights: places.iter().map(light).collect(), ..LightTable::default() }
    }

    fn listed(tiles: &[[u32; 4]], column: usize, row: usize) -> Vec<u32> {
        let tile = &tiles[(row * COLUMNS + column) * STRIDE..][..STRIDE];
        (0..tile[0][3] as usize).map(|k| tile[1 + k / 16][k / 4 % 4] >> (k % 4 * 8) & 255).collect()
    }

    #[test]
    fn every_point_within_reach_lies_in_a_tile_that_lists_the_light() {
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
    fn families_keep_their_order_and_few_lights_have_no_list() {
        let mut many = table(&[(Vec3::ZERO, 0.0); 12]);
        many.lights[10].kind = Kind::Rect as u32;
        many.lights[11].kind = Kind::Disc as u32;
        let tiles = light_tiles(&many, &camera()).unwrap();
        assert_eq!((tiles[0], listed(&tiles, 3, 3)), ([10, 10, 11, 12], (0..12).collect()));
        assert!(light_tiles(&table(&[(Vec3::ZERO, 1.0); 8]), &camera()).is_none());
    }
}
