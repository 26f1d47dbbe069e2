//! Which lights reach which part of the picture, so that of many lights each pixel pays for few.
//!
//! What a light reaches is enclosed in a ball, the ball boxed in the camera's space and the box projected: a tile may
//! list a light that does not reach it, never the other way round.

use super::light_table::{GpuLight, Kind, LightTable};
use crate::scene::CameraFrame;
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// Tiles across the picture; repeated in `scene.wgsl`.
const COLUMNS: usize = 16;
/// Tiles down.
const ROWS: usize = 9;
/// Words of four numbers a tile: the ends of the families, then 256 indices of a byte.
const STRIDE: usize = 17;
/// Lists that hold more than this part of all lights in all tiles are not worth looking up.
const FULL: f32 = 0.75;
/// Bytes of all lists.
pub(crate) const TILES_BYTES: u64 = (COLUMNS * ROWS * STRIDE * size_of::<[u32; 4]>()) as u64;

/// The lists of all tiles, as `scene.wgsl` reads them; none where nearly every light reaches nearly every tile.
pub(crate) fn light_tiles(table: &LightTable, camera: &CameraFrame) -> Option<Vec<[u32; 4]>> {
    let reached: Vec<_> = table.lights.iter().map(|light| tiles_reached(light, camera)).collect();
    let listed: usize = reached.iter().map(|(low, high)| (high[0] - low[0]) * (high[1] - low[1])).sum();
    if listed as f32 >= FULL * (table.lights.len() * COLUMNS * ROWS) as f32 {
        return None;
    }
    let mut tiles = vec![[0_u32; 4]; COLUMNS * ROWS * STRIDE];
    for (index, (light, (low, high))) in table.lights.iter().zip(reached).enumerate() {
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
    let (centre, radius_m) = ball_of_reach(light);
    let centre = camera.world_from_camera.inverse().transform_point3(centre);
    let (near, far) = (-centre.z - radius_m, -centre.z + radius_m);
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
        let (a, b) = (middle - radius_m, middle + radius_m);
        Vec2::new((a / near).min(a / far), (b / near).max(b / far)) / half_extent
    };
    let (x, y) = (span(centre.x, camera.half_extent.x), span(centre.y, camera.half_extent.y));
    let tile = |ndc: f32, count: usize| (0.5 * (ndc + 1.0) * count as f32).clamp(0.0, count as f32);
    let low = [tile(x.x, COLUMNS).floor() as usize, tile(-y.y, ROWS).floor() as usize];
    let high = [tile(x.y, COLUMNS).ceil() as usize, tile(-y.x, ROWS).ceil() as usize];
    (low, high)
}

/// A ball around all that a light reaches: its middle and radius, metres.
fn ball_of_reach(light: &GpuLight) -> (Vec3, f32) {
    let (position, axis, reach_m) = (Vec3::from(light.position), Vec3::from(light.axis), light.reach_m);
    let angle_rad = cone_rad(light);
    if angle_rad < FRAC_PI_4 {
        // The ball through a cone's tip and its rim.
        let radius_m = 0.5 * reach_m / angle_rad.cos();
        return (position + axis * radius_m, radius_m);
    }
    if angle_rad < FRAC_PI_2 {
        // The ball about its rim holds the tip, too.
        return (position + axis * (reach_m * angle_rad.cos()), reach_m * angle_rad.sin());
    }
    if light.kind == Kind::Rect as u32 || light.kind == Kind::Disc as u32 {
        // A panel reaches as far as the root of the cosine says: from half the way along the axis, at most 0.631 of it.
        let size_m = Vec3::from(light.right).length() + Vec3::from(light.up).length();
        return (position + axis * (0.5 * reach_m), 0.632 * reach_m + size_m);
    }
    (position, reach_m)
}

/// Half angle of the cone in which a light shines that comes from one place; half a turn where it shines all round.
fn cone_rad(light: &GpuLight) -> f32 {
    let spot = if light.kind == Kind::Spot as u32 { light.outer_rad } else { PI };
    let from_one_place = light.family() < 2 && light.kind != Kind::Sun as u32;
    let beam = if from_one_place && light.has_beam != 0 { light.beam_rad[1].min(light.beam_rad[2]) } else { PI };
    spot.min(beam)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preview::lights::light_table::Kind;
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
    fn the_ball_holds_all_that_panels_and_spots_reach_and_no_more_than_that() {
        let light = |kind: Kind| GpuLight {
            kind: kind as u32,
            position: [1.0, 2.0, 3.0],
            axis: [0.0, 0.0, -1.0],
            reach_m: 4.0,
            outer_rad: 0.4,
            ..GpuLight::zeroed()
        };
        for (kind, widest, reach) in [
            (Kind::Rect, 1.57_f32, (|angle| angle.cos().max(0.0).sqrt()) as fn(f32) -> f32),
            (Kind::Spot, 0.4, |_| 1.0),
            (Kind::Spot, 1.2, |_| 1.0),
            (Kind::Point, 3.0, |_| 1.0),
        ] {
            let (centre, radius) = ball_of_reach(&GpuLight { outer_rad: widest, ..light(kind) });
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
    fn families_keep_their_order_and_lights_that_reach_all_have_no_list() {
        let mut many = table(&[(Vec3::ZERO, 0.0); 12]);
        assert!(light_tiles(&many, &camera()).is_none());
        let behind = GpuLight { position: [0.0, 0.0, 20.0], reach_m: 1.0, ..many.lights[0] };
        many.lights.extend([behind; 12]);
        many.lights.iter_mut().skip(12).for_each(|light| light.kind = Kind::Disc as u32);
        many.lights[10].kind = Kind::Rect as u32;
        many.lights[11].kind = Kind::Disc as u32;
        let tiles = light_tiles(&many, &camera()).unwrap();
        assert_eq!((tiles[0], listed(&tiles, 3, 3)), ([10, 10, 11, 12], (0..12).collect()));
        let one = light_tiles(&table(&[(Vec3::ZERO, 0.5)]), &camera()).unwrap();
        assert_eq!((listed(&one, 8, 4), listed(&one, 0, 0)), (vec![0], vec![]), "one light has a reach, too");
    }
}
