//! Textures of the skin that the program draws: gloss by region, and fine relief.
//!
//! Regions, and the furrows some 0.9 mm apart whose slopes have a root mean square of 0.1, are typical, not measured.

use super::body_data::BodyData;
use super::iris::{iris_picture, iris_relief};
use super::random::Random;
use super::skin_colors::{Region, factor_at, region};
use crate::scene::{BuiltinTexture, MaterialTextures, Texture, TextureRef, TextureSlot};
use glam::{IVec2, Vec2, Vec3};
use rayon::prelude::*;
use std::sync::{Arc, OnceLock};

/// Side of the gloss map, pixels: 1 mm a pixel on the face.
const GLOSS_SIZE: usize = 1024;
const GLOSS_SIDE: f32 = GLOSS_SIZE as f32;
/// Side of the relief, pixels: 0.1 mm a pixel.
const RELIEF_SIZE: usize = 256;
/// Cells between furrows along a side of the relief, which shows 24 mm.
const CELLS: i32 = 26;
/// Depth of furrows and of pores, in cells.
const FURROW: f32 = 0.055;
const PORE: f32 = 0.09;
/// Part of the corners of cells that has a pore.
const PORES: f32 = 0.3;

/// Farthest that a region of the face that shines is from between the eyes, metres.
const FACE_M: f32 = 0.2;
/// Regions of the face that shine, as factors of the roughness of skin: forehead, nose and chin have the most oil, and the
/// edges of the lids are wet.
const OILY: [Region; 7] = [
    oily([0.0, 0.05, 0.03], [0.036, 0.024, 0.04], 0.22),
    oily([0.0, -0.018, 0.04], [0.009, 0.026, 0.03], 0.25),
    oily([0.0, -0.04, 0.045], [0.013, 0.01, 0.02], 0.22),
    oily([0.0, -0.098, 0.03], [0.018, 0.012, 0.02], 0.2),
    oily([0.032, -0.022, 0.015], [0.02, 0.008, 0.02], 0.14),
    oily([0.031, 0.006, 0.018], [0.018, 0.006, 0.02], 0.2),
    oily([0.031, -0.0035, 0.016], [0.017, 0.0045, 0.014], 0.5),
];

const fn oily(middle: [f32; 3], radius: [f32; 3], strength: f32) -> Region {
    region(middle, radius, Vec3::ZERO, strength)
}

/// How many times the relief repeats along U and V of the base mesh, so that it has its size on the face.
const REPEATS: f32 = 40.0;

/// Factor of the relief's slopes on skin, whose roughness holds the rest of them.
const RELIEF_SCALE: f32 = 0.25;

/// Returns the textures of a figure's skin.
pub fn skin_textures() -> MaterialTextures {
    let mut textures = MaterialTextures {
        metallic_roughness: Some(TextureRef::Builtin(BuiltinTexture::SkinGloss)),
        normal: Some(TextureRef::Builtin(BuiltinTexture::SkinRelief)),
        normal_scale: RELIEF_SCALE,
        ..MaterialTextures::default()
    };
    textures.placements[TextureSlot::Normal as usize].scale = [REPEATS; 2];
    textures
}

/// Returns a texture that the program draws. It is kept.
pub fn builtin_texture(texture: BuiltinTexture) -> Arc<Texture> {
    static GLOSS: OnceLock<Arc<Texture>> = OnceLock::new();
    static RELIEF: OnceLock<Arc<Texture>> = OnceLock::new();
    static IRIS: OnceLock<Arc<Texture>> = OnceLock::new();
    static IRIS_RELIEF: OnceLock<Arc<Texture>> = OnceLock::new();
    match texture {
        BuiltinTexture::SkinGloss => kept(&GLOSS, || skin_gloss(BodyData::shipped())),
        BuiltinTexture::SkinRelief => kept(&RELIEF, skin_relief),
        BuiltinTexture::Iris => kept(&IRIS, iris_picture),
        BuiltinTexture::IrisRelief => kept(&IRIS_RELIEF, iris_relief),
    }
}

/// Returns a texture, which is drawn if it is not known yet.
fn kept(texture: &OnceLock<Arc<Texture>>, draw: impl FnOnce() -> Texture) -> Arc<Texture> {
    let known = texture.get().cloned();
    known.unwrap_or_else(|| {
        // Not under the lock: a thread that waits for parallel parts may run another task that wants the same texture
        let drawn = Arc::new(draw());
        texture.get_or_init(|| drawn).clone()
    })
}

/// Draws the roughness of the skin in the texture coordinates of the base mesh: the factor is green.
fn skin_gloss(data: &BodyData) -> Texture {
    let eyes = data.eyes_middle();
    let quads = data.group("body").into_iter().flat_map(|group| group.quads.iter().zip(&group.uvs));
    let on_face = quads.filter_map(|(quad, uvs)| {
        let places = quad.map(|v| data.positions[usize::from(v)] - eyes);
        let pixel = |uv: u16| Vec2::new(data.uvs[usize::from(uv)].x, 1.0 - data.uvs[usize::from(uv)].y) * GLOSS_SIDE;
        (places[0].length() <= FACE_M).then(|| (places, uvs.map(pixel)))
    });
    // Sample each quad, twice a pixel along its sides, and keep the least factor of each pixel
    let samples = |(places, pixels): ([Vec3; 4], [Vec2; 4])| {
        let both_sides = [places, places.map(|place| place.with_x(-place.x))];
        let is_near = |region: &Region| both_sides.iter().any(|corners| region.may_reach(corners));
        let regions: Vec<Region> = OILY.into_iter().filter(is_near).collect();
        let longest = (0..4).map(|k| pixels[k].distance(pixels[(k + 1) % 4])).fold(0.0, f32::max);
        let steps = (2.0 * longest).ceil().max(1.0) as u32;
        let rows = if regions.is_empty() { 0..0 } else { 0..steps + 1 };
        rows.flat_map(move |i| (0..=steps).map(move |j| (i, j))).filter_map(move |(i, j)| {
            let (s, t) = (i as f32 / steps as f32, j as f32 / steps as f32);
            let place = places[0].lerp(places[1], s).lerp(places[3].lerp(places[2], s), t);
            let factor = factor_at(place.with_x(place.x.abs()), &regions).y;
            let pixel = pixels[0].lerp(pixels[1], s).lerp(pixels[3].lerp(pixels[2], s), t).as_uvec2();
            let [x, y] = pixel.to_array().map(|c| (c as usize).min(GLOSS_SIZE - 1));
            (factor < 1.0).then_some((y * GLOSS_SIZE + x, factor))
        })
    };
    let samples: Vec<(usize, f32)> = on_face.collect::<Vec<_>>().into_par_iter().flat_map_iter(samples).collect();
    let mut least = vec![1.0_f32; GLOSS_SIZE * GLOSS_SIZE];
    for (pixel, factor) in samples {
        least[pixel] = least[pixel].min(factor);
    }
    // A pixel beyond the edge of an island belongs to it, too: between pixels they are mixed
    let factors = least_around(&least);
    let rgb = factors.iter().map(|factor| [255, (factor * 255.0 + 0.5) as u8, 255]).collect();
    Texture::opaque(GLOSS_SIZE as u32, GLOSS_SIZE as u32, rgb)
}

/// Returns for each pixel of the gloss map the least value of those within one row and one column.
fn least_around(values: &[f32]) -> Vec<f32> {
    let last = GLOSS_SIZE - 1;
    // `at` is the place of a pixel along the line of its neighbours, which are `step` apart
    let least_of_three = |values: &[f32], index: usize, step: usize, at: usize| {
        let before = if at > 0 { values[index - step] } else { f32::INFINITY };
        let after = if at < last { values[index + step] } else { f32::INFINITY };
        values[index].min(before).min(after)
    };
    let pixels = || (0..values.len()).into_par_iter();
    let of_rows: Vec<f32> = pixels().map(|i| least_of_three(values, i, 1, i % GLOSS_SIZE)).collect();
    pixels().map(|i| least_of_three(&of_rows, i, GLOSS_SIZE, i / GLOSS_SIZE)).collect()
}

/// Draws the relief of skin, which repeats: plateaus between furrows, and pores where furrows meet.
fn skin_relief() -> Texture {
    let side = RELIEF_SIZE as i32;
    let cells: Vec<ReliefCell> = (0..CELLS * CELLS).map(|cell| ReliefCell::new(cell % CELLS, cell / CELLS)).collect();
    let heights: Vec<f32> = (0..side * side)
        .into_par_iter()
        .map(|pixel| {
            let point = Vec2::new((pixel % side) as f32, (pixel / side) as f32) * CELLS as f32 / side as f32;
            relief_height(point, &cells)
        })
        .collect();
    let height = |x: i32, y: i32| heights[(y.rem_euclid(side) * side + x.rem_euclid(side)) as usize];
    let pixels_per_cell = side as f32 / CELLS as f32;
    let normal = |pixel: i32| {
        let (x, y) = (pixel % side, pixel / side);
        // Rows run down, V runs up
        let slope = Vec2::new(height(x + 1, y) - height(x - 1, y), height(x, y - 1) - height(x, y + 1)) / 2.0;
        let normal = (-slope * pixels_per_cell).extend(1.0).normalize_or(Vec3::Z);
        normal.to_array().map(|c| ((c + 1.0) * 127.5).round() as u8)
    };
    Texture::opaque(RELIEF_SIZE as u32, RELIEF_SIZE as u32, (0..side * side).map(normal).collect())
}

/// A cell of the relief: points from its corner, in sides of a cell.
#[derive(Clone, Copy, Debug)]
struct ReliefCell {
    /// Middle of a plateau.
    middle: Vec2,
    /// Place of a pore, if there is one.
    pore: Option<Vec2>,
}

impl ReliefCell {
    fn new(x: i32, y: i32) -> ReliefCell {
        let mut random = Random::new(x as u32, y as u32);
        let middle = Vec2::new(random.unit(), random.unit());
        let pore = Vec2::new(random.unit(), random.unit());
        ReliefCell { middle, pore: (random.unit() < PORES).then_some(pore) }
    }
}

/// Returns the height of the relief at a point, both in cells (Worley 1996, "A cellular texture basis function"). The
/// `cells` of the relief follow each other row by row.
fn relief_height(point: Vec2, cells: &[ReliefCell]) -> f32 {
    let corner = point.floor().as_ivec2();
    let mut near = [f32::INFINITY; 2];
    let mut to_pore_squared = f32::INFINITY;
    for offset in (-2..=2).flat_map(|y| (-2..=2).map(move |x| IVec2::new(x, y))) {
        let [x, y] = (corner + offset).to_array().map(|c| c.rem_euclid(CELLS));
        let cell = cells[(y * CELLS + x) as usize];
        let place = |in_cell: Vec2| (corner + offset).as_vec2() + in_cell;
        let distance = point.distance(place(cell.middle));
        if let Some(in_cell) = cell.pore {
            to_pore_squared = to_pore_squared.min(point.distance_squared(place(in_cell)));
        }
        if distance < near[0] {
            near = [distance, near[0]];
        } else {
            near[1] = near[1].min(distance);
        }
    }
    let from_furrow = ((near[1] - near[0]) / 0.45).clamp(0.0, 1.0);
    FURROW * from_furrow * (2.0 - from_furrow) - PORE * (-(to_pore_squared / 0.03)).exp()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::decode_normal;

    #[test]
    fn forehead_and_nose_shine_more_than_cheeks_and_hands_not_at_all() {
        let data = BodyData::shipped();
        let gloss = builtin_texture(BuiltinTexture::SkinGloss);
        let group = data.group("body").unwrap();
        let factor = |place: Vec3| {
            let distance = |v: u16| data.positions[usize::from(v)].distance(place + data.eyes_middle());
            let corners = group.quads.iter().flatten().zip(group.uvs.iter().flatten());
            let (_, uv) = corners.min_by(|(a, _), (b, _)| distance(**a).total_cmp(&distance(**b))).unwrap();
            let uv = data.uvs[usize::from(*uv)] * GLOSS_SIZE as f32;
            let (x, y) = (uv.x as usize, GLOSS_SIZE - 1 - uv.y as usize);
            f32::from(gloss.rgb[y * GLOSS_SIZE + x][1]) / 255.0
        };
        let [forehead, cheek] = [Vec3::new(0.0, 0.05, 0.03), Vec3::new(0.05, -0.05, 0.0)].map(factor);
        assert!(forehead < 0.85 && cheek > 0.92, "{forehead} {cheek}");
        let hand = data.positions[usize::from(data.bones[data.bone("finger3-1.L").unwrap()].head)] - data.eyes_middle();
        assert!(factor(hand) > 0.99);
    }

    #[test]
    fn the_relief_has_its_size_on_the_face() {
        let data = BodyData::shipped();
        let group = data.group("body").unwrap();
        let (mut uv, mut metres) = (0.0, 0.0);
        for (quad, uvs) in group.quads.iter().zip(&group.uvs) {
            let places = quad.map(|v| data.positions[usize::from(v)] - data.eyes_middle());
            if places[0].y.abs() < 0.1 && places[0].z > -0.02 {
                let uvs = uvs.map(|uv| data.uvs[usize::from(uv)]);
                uv += (uvs[2] - uvs[0]).perp_dot(uvs[3] - uvs[1]).abs();
                metres += (places[2] - places[0]).cross(places[3] - places[1]).length();
            }
        }
        let repeats_per_m = REPEATS * (uv / metres).sqrt();
        assert!((repeats_per_m * BuiltinTexture::RELIEF_M - 1.0).abs() < 0.1, "{repeats_per_m} times a metre");
    }

    #[test]
    fn the_slopes_of_the_relief_have_those_of_skin_and_no_direction() {
        let relief = builtin_texture(BuiltinTexture::SkinRelief);
        let normals: Vec<Vec3> = relief
            .rgb
            .iter()
            .map(|rgb| decode_normal(Vec3::from_array(rgb.map(|c| f32::from(c) / 255.0)), 1.0))
            .collect();
        let count = normals.len() as f32;
        let slopes = || normals.iter().map(|n| n.truncate() / n.z);
        let mean = slopes().sum::<Vec2>() / count;
        let rms = (slopes().map(|slope| slope * slope).sum::<Vec2>() / count).map(f32::sqrt);
        // Eight bits have no zero: 0.004 along each axis.
        assert!(mean.length() < 0.008, "{mean}");
        assert!((0.08..0.13).contains(&rms.x) && (0.08..0.13).contains(&rms.y), "{rms}");
    }
}
