//! The start of a tank: its ground, its still water, its blocks and the strokes of the brush.

use super::grid::{FULL, Grid};
use crate::scene::{Block, BrushStroke, CellContent, Tank, Terrain, Texture};
use glam::{IVec2, Vec2, Vec3};

/// Octaves of the noise of hills.
const OCTAVES: u32 = 5;

/// Returns the cells of a tank at its start. `heights` is the picture of its ground, if that is made of one.
pub fn start(tank: &Tank, heights: Option<&Texture>) -> Grid {
    let mut grid = Grid::new(tank.cells.map(usize::from));
    let [nx, ny, nz] = grid.size();
    let units = |height_m: f32| f64::from(height_m) / f64::from(tank.cell_m) * f64::from(FULL);
    // The share of a height that is in a cell
    let share = |units: f64, y: usize| (units - y as f64 * f64::from(FULL)).round().clamp(0.0, f64::from(FULL)) as u16;
    let heights_m = heights_m(tank, heights);
    for z in 0..nz {
        for x in 0..nx {
            let (ground, water) = (units(heights_m[z * nx + x]), units(tank.water_m));
            for y in 0..ny {
                let cell = grid.index([x, y, z]);
                grid.set_ground(cell, share(ground, y));
                grid.set_level(cell, share(water, y));
            }
        }
    }
    tank.blocks.iter().for_each(|block| place(&mut grid, block));
    tank.strokes.iter().for_each(|stroke| paint(&mut grid, tank, stroke));
    grid
}

/// Fills the cells whose middle is within the radius of a stroke's path.
fn paint(grid: &mut Grid, tank: &Tank, stroke: &BrushStroke) {
    let in_cells = |point: &Vec3| (*point - tank.low_m()) / tank.cell_m;
    let radius = stroke.radius_m / tank.cell_m;
    let path: Vec<Vec3> = stroke.path_m.iter().map(in_cells).collect();
    let lone = path.first().filter(|_| path.len() == 1).map(|point| [*point, *point]);
    for [from, to] in path.windows(2).map(|pair| [pair[0], pair[1]]).chain(lone) {
        let (low, high) = (from.min(to) - radius, from.max(to) + radius);
        let range =
            |axis: usize| low[axis].max(0.0) as usize..(high[axis].max(0.0) as usize + 1).min(grid.size()[axis]);
        let [xs, ys, zs] = [range(0), range(1), range(2)];
        for z in zs {
            for x in xs.clone() {
                for y in ys.clone() {
                    let middle = Vec3::new(x as f32, y as f32, z as f32) + 0.5;
                    let along = to - from;
                    let part = (middle - from).dot(along) / along.length_squared().max(f32::MIN_POSITIVE);
                    if middle.distance(from + along * part.clamp(0.0, 1.0)) <= radius {
                        let cell = grid.index([x, y, z]);
                        fill(grid, cell, stroke.content);
                    }
                }
            }
        }
    }
}

fn place(grid: &mut Grid, block: &Block) {
    let Block { from, to, content } = *block;
    let range = |axis: usize| usize::from(from[axis])..(usize::from(to[axis]) + 1).min(grid.size()[axis]);
    let [xs, ys, zs] = [range(0), range(1), range(2)];
    for z in zs {
        for x in xs.clone() {
            for y in ys.clone() {
                let cell = grid.index([x, y, z]);
                fill(grid, cell, content);
            }
        }
    }
}

fn fill(grid: &mut Grid, cell: usize, content: CellContent) {
    match content {
        CellContent::Air => grid.set_ground(cell, 0),
        CellContent::Ground => grid.set_ground(cell, FULL),
        CellContent::Metal => grid.set_metal(cell),
        CellContent::Water => {
            grid.set_ground(cell, 0);
            grid.set_level(cell, FULL);
        }
    }
}

/// Returns the height of the ground in each column, metres, rows along X.
fn heights_m(tank: &Tank, picture: Option<&Texture>) -> Vec<f32> {
    let [nx, _, nz] = tank.cells.map(i32::from);
    // Twice the offset of a column from the middle, in cells: exact, so that a basin is symmetric to the bit
    let columns = (0..nz).flat_map(|z| (0..nx).map(move |x| IVec2::new(2 * x + 1 - nx, 2 * z + 1 - nz)));
    match tank.terrain {
        Terrain::Flat { height_m } => vec![height_m; (nx * nz) as usize],
        Terrain::Basin { floor_m, rim_m } => columns
            .map(|offset| {
                let from_middle = (offset.abs().as_vec2() / IVec2::new(nx, nz).as_vec2()).length().min(1.0);
                floor_m + (rim_m - floor_m) * smooth_step(from_middle)
            })
            .collect(),
        Terrain::Hills { seed, low_m, high_m, period_m } => {
            let scale = 0.5 * tank.cell_m / period_m;
            let noise: Vec<f32> = columns.map(|offset| fractal_noise(seed, offset.as_vec2() * scale)).collect();
            let low = noise.iter().copied().fold(f32::INFINITY, f32::min);
            let high = noise.iter().copied().fold(f32::NEG_INFINITY, f32::max);
            let range = (high - low).max(1e-6);
            noise.iter().map(|value| low_m + (high_m - low_m) * ((value - low) / range)).collect()
        }
        Terrain::Picture { low_m, high_m, .. } => {
            let size = IVec2::new(nx, nz).as_vec2();
            let brightness =
                |offset: IVec2| picture.map_or(0.0, |picture| brightness(picture, 0.5 + 0.5 * offset.as_vec2() / size));
            columns.map(|offset| low_m + (high_m - low_m) * brightness(offset)).collect()
        }
    }
}

/// Returns the brightness of a picture at a place, 0 to 1 from its top left: the luminance of its stored values,
/// interpolated between pixels.
fn brightness(picture: &Texture, at: Vec2) -> f32 {
    let (width, height) = (picture.width as usize, picture.height as usize);
    if width == 0 || height == 0 {
        return 0.0;
    }
    let last = Vec2::new((width - 1) as f32, (height - 1) as f32);
    let place = (at * Vec2::new(width as f32, height as f32) - 0.5).clamp(Vec2::ZERO, last);
    let (low, t) = (place.floor(), place - place.floor());
    let value = |dx: usize, dy: usize| {
        let (x, y) = ((low.x as usize + dx).min(width - 1), (low.y as usize + dy).min(height - 1));
        let [r, g, b] = picture.rgb.get(y * width + x).copied().unwrap_or_default().map(f32::from);
        (0.2126 * r + 0.7152 * g + 0.0722 * b) / 255.0
    };
    let row = |dy: usize| value(0, dy) + (value(1, dy) - value(0, dy)) * t.x;
    row(0) + (row(1) - row(0)) * t.y
}

fn smooth_step(t: f32) -> f32 {
    t * t * (3.0 - 2.0 * t)
}

/// Returns the sum of octaves of gradient noise, each of twice the frequency and somewhat less than half the height of
/// the one before.
fn fractal_noise(seed: u32, at: Vec2) -> f32 {
    (0..OCTAVES)
        .map(|octave| gradient_noise(seed ^ octave, at * (1 << octave) as f32) * 0.46_f32.powi(octave as i32))
        .sum()
}

/// Returns gradient noise with the fifth-order fade of Perlin 2002, "Improving Noise".
fn gradient_noise(seed: u32, at: Vec2) -> f32 {
    let corner = at.floor();
    let (t, corner) = (at - corner, corner.as_ivec2());
    let fade = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let slope = |dx: i32, dy: i32| {
        let offset = IVec2::new(dx, dy);
        gradient(seed, corner + offset).dot(t - offset.as_vec2())
    };
    let low = slope(0, 0) + (slope(1, 0) - slope(0, 0)) * fade.x;
    let high = slope(0, 1) + (slope(1, 1) - slope(0, 1)) * fade.x;
    low + (high - low) * fade.y
}

/// Returns the gradient at a lattice point: one of eight directions, from a hash of the point.
fn gradient(seed: u32, point: IVec2) -> Vec2 {
    const DIAGONAL: f32 = std::f32::consts::FRAC_1_SQRT_2;
    let hash = mix(seed ^ mix(point.x as u32 ^ mix(point.y as u32)));
    let straight = [Vec2::X, Vec2::Y, Vec2::NEG_X, Vec2::NEG_Y];
    let diagonal = [Vec2::ONE, Vec2::new(-1.0, 1.0), Vec2::NEG_ONE, Vec2::new(1.0, -1.0)];
    let index = (hash >> 8 & 3) as usize;
    if hash & 1 == 0 { straight[index] } else { diagonal[index] * DIAGONAL }
}

/// Mixes the bits of a number: the finaliser of MurmurHash3 (Appleby).
fn mix(mut value: u32) -> u32 {
    value = value.wrapping_add(0x9e37_79b9);
    value = (value ^ value >> 16).wrapping_mul(0x85eb_ca6b);
    value = (value ^ value >> 13).wrapping_mul(0xc2b2_ae35);
    value ^ value >> 16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hills_fill_their_range_and_the_seed_chooses_them() {
        let hills = |seed| Tank {
            terrain: Terrain::Hills { seed, low_m: 0.03, high_m: 0.2, period_m: 0.3 },
            ..Tank::default()
        };
        let heights = heights_m(&hills(1), None);
        let (low, high) = heights.iter().fold((1.0_f32, 0.0_f32), |(low, high), &h| (low.min(h), high.max(h)));
        assert!((low - 0.03).abs() < 1e-6 && (high - 0.2).abs() < 1e-6, "{low} to {high}");
        let steepest =
            heights.chunks(64).flat_map(|row| row.windows(2)).map(|w| (w[0] - w[1]).abs()).fold(0.0, f32::max);
        assert!(steepest < 0.03, "a landscape, not noise: {steepest} m from column to column");
        assert_ne!(heights, heights_m(&hills(2), None));
    }

    #[test]
    fn a_picture_is_the_ground_with_its_upper_edge_at_the_back() {
        let terrain = Terrain::Picture { path: "hills.png".to_owned(), low_m: 0.1, high_m: 0.3 };
        let tank = Tank { cells: [4, 8, 4], terrain, ..Tank::default() };
        // Black at the back, white at the front right
        let picture = Texture::opaque(2, 2, vec![[0; 3], [0; 3], [0; 3], [255; 3]]);
        let heights = heights_m(&tank, Some(&picture));
        assert!((heights[0] - 0.1).abs() < 1e-6 && (heights[3] - 0.1).abs() < 1e-6, "{heights:?}");
        assert!((heights[15] - 0.3).abs() < 1e-6 && (heights[12] - 0.1).abs() < 1e-6, "{heights:?}");
        assert!(heights[10] > 0.1 && heights[10] < 0.3, "interpolated: {heights:?}");
        assert_eq!(heights_m(&tank, None), [0.1; 16]);
        let empty = Texture::opaque(0, 0, Vec::new());
        assert_eq!(heights_m(&tank, Some(&empty)), [0.1; 16]);
    }

    #[test]
    fn a_stroke_fills_the_cells_about_its_path_in_order() {
        let stroke = |content, cells: f32, path: &[[f32; 3]]| BrushStroke {
            content,
            radius_m: 0.1 * cells,
            path_m: path.iter().map(|point| (Vec3::from(*point) - Vec3::new(4.0, 0.0, 4.0)) * 0.1).collect(),
        };
        let tank = Tank {
            cells: [8, 8, 8],
            cell_m: 0.1,
            terrain: Terrain::Flat { height_m: 0.0 },
            water_m: 0.0,
            strokes: vec![
                stroke(CellContent::Ground, 1.01, &[[1.5, 1.5, 4.5], [5.5, 1.5, 4.5]]),
                stroke(CellContent::Water, 0.1, &[[3.5, 1.5, 4.5]]),
                // Beyond the tank
                stroke(CellContent::Metal, 2.0, &[[-50.0, 1.5, 4.5], [90.0, 40.0, 4.5]]),
                stroke(CellContent::Metal, 1.0, &[]),
            ],
            ..Tank::default()
        };
        let grid = start(&tank, None);
        let cells = |is: &dyn Fn(usize) -> bool| (0..512).filter(|cell| is(*cell)).count();
        // Five cells along the path with four neighbours each, and one beyond each end; one of them is water now
        assert_eq!(cells(&|cell| grid.ground(cell) == FULL && !grid.is_metal(cell)), 5 * 5 + 2 - 1);
        assert_eq!(cells(&|cell| grid.water(cell) > 0), 1);
        assert_eq!(grid.water(grid.index([3, 1, 4])), FULL);
        assert_eq!(cells(&|cell| grid.is_metal(cell)), 0);
    }

    #[test]
    fn still_water_fills_what_is_below_its_level_and_blocks_replace_it() {
        let block = |at, content| Block { from: at, to: at, content };
        let tank = Tank {
            cells: [4, 4, 4],
            cell_m: 0.1,
            terrain: Terrain::Flat { height_m: 0.15 },
            water_m: 0.275,
            blocks: vec![
                block([0, 3, 0], CellContent::Water),
                block([1, 0, 0], CellContent::Air),
                block([2, 2, 0], CellContent::Metal),
                block([3, 2, 0], CellContent::Ground),
            ],
            ..Tank::default()
        };
        let grid = start(&tank, None);
        let column = |x, z| -> Vec<(u16, u16)> {
            (0..4).map(|y| grid.index([x, y, z])).map(|cell| (grid.ground(cell), grid.water(cell))).collect()
        };
        assert_eq!(column(0, 1), [(FULL, 0), (FULL / 2, FULL / 2), (0, FULL / 4 * 3), (0, 0)]);
        assert_eq!(column(0, 0)[3], (0, FULL));
        assert_eq!(column(1, 0)[0], (0, 0), "a cave is dry at the start");
        assert_eq!(column(2, 0)[2], (FULL, 0));
        assert!(grid.is_metal(grid.index([2, 2, 0])) && !grid.is_metal(grid.index([3, 2, 0])));
    }
}
