//! Triangles to pixels: positions in 1/256 of a pixel, exact integer edges, the top-left rule, 1/w as depth.
//!
//! The picture is cut into tiles that are filled in parallel. A tile first finds which triangle each of its pixels
//! shows, and then shades each pixel once.

use super::Drawing;
use super::row::{self, Row, Run};
use super::shade::Shader;
use crate::photo::Picture;
use glam::{Mat3, Vec3, Vec4};
use rayon::prelude::*;

/// Size of a tile, pixels.
const TILE_WIDTH: usize = row::WIDTH;
const TILE_HEIGHT: usize = 16;
/// Pixels in a row of a triangle that are asked one by one; more are found by dividing.
const FEW_PIXELS: usize = 12;
/// Positions in a pixel, along each side.
const SUBPIXELS: i64 = 256;
/// Largest picture edge, pixels: the edges' products stay far inside 64 bits.
const LARGEST_EDGE: u32 = 16384;
/// No triangle.
const NONE: u32 = u32::MAX;

/// A picture's size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Screen {
    pub width: u32,
    pub height: u32,
}

impl Screen {
    pub fn new((width, height): (u32, u32)) -> Self {
        Screen { width: width.clamp(1, LARGEST_EDGE), height: height.clamp(1, LARGEST_EDGE) }
    }

    fn tiles(self) -> (usize, usize) {
        ((self.width as usize).div_ceil(TILE_WIDTH), (self.height as usize).div_ceil(TILE_HEIGHT))
    }

    /// Where a point inside clip space lies.
    pub fn project(self, clip: Vec4) -> OnScreen {
        let inverse_w = 1.0 / clip.w;
        // Not negative inside: adding a half and cutting off rounds.
        let fixed = |part: f32, pixels: u32| (f64::from(part) * f64::from(pixels) * SUBPIXELS as f64 + 0.5) as i32;
        let x = fixed(0.5 + 0.5 * clip.x * inverse_w, self.width);
        let y = fixed(0.5 - 0.5 * clip.y * inverse_w, self.height);
        OnScreen { at: [x, y], inverse_w }
    }
}

/// A point on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OnScreen {
    /// In 1/256 pixels, y down.
    at: [i32; 2],
    /// One over the distance along the camera's axis, 1/m.
    inverse_w: f32,
}

/// A triangle inside the screen, its corners in an order that makes the area positive.
#[derive(Clone, Copy, Debug)]
pub(super) struct ScreenTriangle {
    at: [[i64; 2]; 3],
    inverse_w: [f32; 3],
    /// Weights of the whole triangle's corners at each of these.
    pub weights: [Vec3; 3],
    /// Its mesh among the placed, and its number there.
    pub placed: u32,
    pub triangle: u32,
    pub surface: u32,
}

/// Which of a mesh's sides are drawn, and how far it stands back.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facing {
    pub one_sided: bool,
    /// Factor of 1/w: a little under 1 lets paper lie on a floor.
    pub depth_factor: f32,
}

impl ScreenTriangle {
    /// None if it has no area, or shows its back where only fronts are drawn.
    pub fn new(
        [a, b, c]: [OnScreen; 3],
        weights: [Vec3; 3],
        facing: Facing,
        (placed, triangle, surface): (u32, u32, u32),
    ) -> Option<Self> {
        let wide = |corner: OnScreen| corner.at.map(i64::from);
        let area = edge(wide(a), wide(b), wide(c));
        // Counter-clockwise fronts have a negative area where y runs down.
        if area == 0 || (facing.one_sided && area > 0) {
            return None;
        }
        let ([a, b, c], weights) =
            if area > 0 { ([a, b, c], weights) } else { ([a, c, b], [weights[0], weights[2], weights[1]]) };
        let inverse_w = [a, b, c].map(|corner| corner.inverse_w * facing.depth_factor);
        Some(ScreenTriangle { at: [a, b, c].map(wide), inverse_w, weights, placed, triangle, surface })
    }

    /// Smallest and largest position of a side, 1/256 pixels.
    fn extent(&self, axis: usize) -> (i64, i64) {
        let [a, b, c] = self.at.map(|p| p[axis]);
        (a.min(b).min(c), a.max(b).max(c))
    }

    /// First and one past the last pixel along an axis whose centre may lie inside.
    fn pixels(&self, axis: usize, count: u32) -> (usize, usize) {
        let (low, high) = self.extent(axis);
        let half = SUBPIXELS / 2;
        let first = (low + half - 1).div_euclid(SUBPIXELS).max(0);
        let end = ((high - half).div_euclid(SUBPIXELS) + 1).min(i64::from(count));
        (first as usize, end.max(first) as usize)
    }

    fn area(&self) -> i64 {
        edge(self.at[0], self.at[1], self.at[2])
    }

    /// Weights of the screen's corners over their distance, at a pixel's centre and from one pixel to the next.
    fn over_distance(&self, x: usize, y: usize) -> (Vec3, Vec3) {
        let p = centre(x, y);
        let [a, b, c] = self.at;
        let scale = Vec3::from(self.inverse_w) / self.area() as f32;
        let at = Vec3::new(edge(b, c, p) as f32, edge(c, a, p) as f32, edge(a, b, p) as f32);
        let fall = |from: [i64; 2], to: [i64; 2]| ((from[1] - to[1]) * SUBPIXELS) as f32;
        let step = Vec3::new(fall(b, c), fall(c, a), fall(a, b));
        (at * scale, step * scale)
    }

    /// Pixels of a row that show it, from `first` to `end` of a tile that begins at pixel `tile_x` of the screen.
    fn run(&self, tile_x: usize, y: usize, first: usize, end: usize) -> Run {
        let (start, step) = self.over_distance(tile_x + first, y);
        let whole = Mat3::from_cols(self.weights[0], self.weights[1], self.weights[2]);
        Run { first, end, start: whole * start, step: whole * step }
    }
}

/// Twice the signed area of three points; exact.
fn edge(a: [i64; 2], b: [i64; 2], p: [i64; 2]) -> i64 {
    (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
}

fn centre(x: usize, y: usize) -> [i64; 2] {
    [x as i64 * SUBPIXELS + SUBPIXELS / 2, y as i64 * SUBPIXELS + SUBPIXELS / 2]
}

/// Fills and shades the tiles, a row of tiles at a time.
pub(super) fn draw(screen: Screen, triangles: &[ScreenTriangle], shader: &Shader) -> Drawing {
    let bins = bins(screen, triangles);
    let (columns, _) = screen.tiles();
    let (width, height) = (screen.width as usize, screen.height as usize);
    let mut picture = Picture::new(screen.width, screen.height);
    let mut objects = vec![super::NO_OBJECT; width * height];
    let mut inverse_depths = vec![0.0; width * height];
    let rows = picture.rgb.par_chunks_mut(width * TILE_HEIGHT).zip(objects.par_chunks_mut(width * TILE_HEIGHT));
    let rows = rows.zip(inverse_depths.par_chunks_mut(width * TILE_HEIGHT));
    rows.zip(bins.par_chunks(columns)).enumerate().for_each(|(row, (((rgb, objects), depths), bins))| {
        let mut shown = Row::new(shader.nothing());
        for (column, bin) in bins.iter().enumerate() {
            let mut tile = Tile::new(screen, column, row);
            bin.iter().for_each(|&t| tile.fill(&triangles[t as usize], t));
            for y in 0..tile.height {
                let pixels = y * width + tile.x..y * width + tile.x + tile.width;
                tile.show(y, triangles, shader, &mut shown, &mut objects[pixels.clone()]);
                depths[pixels.clone()].copy_from_slice(&tile.depth[y][..tile.width]);
                shader.pixels(&shown, &mut rgb[pixels]);
            }
        }
    });
    Drawing { picture, objects, inverse_depths }
}

/// The triangles that may touch each tile, in their order: a tile's content does not depend on threads.
fn bins(screen: Screen, triangles: &[ScreenTriangle]) -> Vec<Vec<u32>> {
    let (columns, rows) = screen.tiles();
    let mut bins = vec![Vec::new(); columns * rows];
    for (index, triangle) in (0..).zip(triangles) {
        let ((x0, x1), (y0, y1)) = (triangle.pixels(0, screen.width), triangle.pixels(1, screen.height));
        if x0 < x1 && y0 < y1 {
            for y in y0 / TILE_HEIGHT..=(y1 - 1) / TILE_HEIGHT {
                (x0 / TILE_WIDTH..=(x1 - 1) / TILE_WIDTH).for_each(|x| bins[y * columns + x].push(index));
            }
        }
    }
    bins
}

/// A part of the picture.
struct Tile {
    x: usize,
    y: usize,
    width: usize,
    height: usize,
    /// 1/w, nearer is greater; 0 where there is nothing.
    depth: [[f32; TILE_WIDTH]; TILE_HEIGHT],
    shown: [[u32; TILE_WIDTH]; TILE_HEIGHT],
}

impl Tile {
    fn new(screen: Screen, column: usize, row: usize) -> Self {
        let (x, y) = (column * TILE_WIDTH, row * TILE_HEIGHT);
        Tile {
            x,
            y,
            width: TILE_WIDTH.min(screen.width as usize - x),
            height: TILE_HEIGHT.min(screen.height as usize - y),
            depth: [[0.0; TILE_WIDTH]; TILE_HEIGHT],
            shown: [[NONE; TILE_WIDTH]; TILE_HEIGHT],
        }
    }

    /// Keeps the triangle where it is nearer than what is there.
    fn fill(&mut self, triangle: &ScreenTriangle, index: u32) {
        let (y0, y1) = triangle.pixels(1, (self.y + self.height) as u32);
        let (x0, x1) = triangle.pixels(0, (self.x + self.width) as u32);
        let (x0, y0) = (x0.max(self.x), y0.max(self.y));
        if x0 >= x1 || y0 >= y1 {
            return;
        }
        let [a, b, c] = triangle.at;
        let mut edges = [(b, c), (c, a), (a, b)].map(|(from, to)| Edge::new(from, to, x0, y0));
        let (start, step) = triangle.over_distance(x0, y0);
        let (depth, right) = (start.element_sum(), step.element_sum());
        let down = edges.each_ref().map(|e| e.per_row as f32);
        let down = Vec3::from(down).dot(Vec3::from(triangle.inverse_w)) / triangle.area() as f32;
        for (row, y) in (y0 - self.y..y1 - self.y).enumerate() {
            let depth = depth + row as f32 * down;
            let pixels = x0 - self.x..x1 - self.x;
            let (depths, shown) = (&mut self.depth[y][pixels.clone()], &mut self.shown[y][pixels]);
            let mut keep = |from: usize, to: usize| {
                let pixels = depths[from..to].iter_mut().zip(&mut shown[from..to]);
                for ((nearest, shown), i) in pixels.zip(&row::STEPS[from..to]) {
                    let here = depth + i * right;
                    // Written either way, so that it needs no jump.
                    let nearer = here > *nearest;
                    *nearest = if nearer { here } else { *nearest };
                    *shown = if nearer { index } else { *shown };
                }
            };
            if x1 - x0 <= FEW_PIXELS {
                (0..x1 - x0).filter(|&x| edges.iter().all(|edge| edge.at(x) >= 0)).for_each(|x| keep(x, x + 1));
            } else {
                let (mut low, mut high) = (0, (x1 - x0) as i64);
                edges.iter().for_each(|edge| edge.narrow(&mut low, &mut high));
                if low < high {
                    keep(low as usize, high as usize);
                }
            }
            edges.iter_mut().for_each(|edge| edge.start += edge.per_row);
        }
    }

    /// Collects what each pixel of a row shows, run by run.
    fn show(&self, y: usize, triangles: &[ScreenTriangle], shader: &Shader, row: &mut Row, objects: &mut [u32]) {
        row.surface.fill(shader.nothing());
        let mut first = 0;
        for same in self.shown[y][..self.width].chunk_by(|a, b| a == b) {
            let end = first + same.len();
            if let Some(triangle) = triangles.get(same[0] as usize) {
                shader.show(row, &triangle.run(self.x, self.y + y, first, end), triangle);
                objects[first..end].fill(shader.object(triangle));
            }
            first = end;
        }
    }
}

/// An edge function over the screen, with the top-left rule: a pixel centre on the edge counts where the edge is the
/// top or the left one, so that of two neighbours exactly one has it.
struct Edge {
    /// At the first pixel of a row.
    start: i64,
    per_pixel: i64,
    per_row: i64,
}

impl Edge {
    fn new(from: [i64; 2], to: [i64; 2], x: usize, y: usize) -> Self {
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let top_or_left = dy < 0 || (dy == 0 && dx > 0);
        let bias = if top_or_left { 0 } else { -1 };
        Edge { start: edge(from, to, centre(x, y)) + bias, per_pixel: -dy * SUBPIXELS, per_row: dx * SUBPIXELS }
    }

    fn at(&self, x: usize) -> i64 {
        self.start + self.per_pixel * x as i64
    }

    /// Narrows a run of pixels of a row to those inside.
    fn narrow(&self, low: &mut i64, high: &mut i64) {
        match self.per_pixel {
            0 if self.start < 0 => *high = *low,
            0 => {}
            // start + per_pixel x >= 0.
            rise if rise > 0 => *low = (*low).max((-self.start + rise - 1).div_euclid(rise)),
            fall => *high = (*high).min(self.start.div_euclid(-fall) + 1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCREEN: Screen = Screen { width: 97, height: 61 };

    fn clip(x: f32, y: f32) -> Vec4 {
        Vec4::new(2.0 * x / SCREEN.width as f32 - 1.0, 1.0 - 2.0 * y / SCREEN.height as f32, 0.1, 1.0)
    }

    fn triangle(corners: [(f32, f32); 3]) -> Option<ScreenTriangle> {
        let facing = Facing { one_sided: false, depth_factor: 1.0 };
        let weights = [Vec3::X, Vec3::Y, Vec3::Z];
        ScreenTriangle::new(corners.map(|(x, y)| SCREEN.project(clip(x, y))), weights, facing, (0, 0, 0))
    }

    /// How often each pixel is filled.
    fn counts(triangles: &[ScreenTriangle]) -> Vec<u32> {
        let (columns, rows) = SCREEN.tiles();
        let mut counts = vec![0; (SCREEN.width * SCREEN.height) as usize];
        for t in triangles {
            for index in 0..columns * rows {
                let mut tile = Tile::new(SCREEN, index % columns, index / columns);
                tile.fill(t, 0);
                for y in 0..tile.height {
                    for x in 0..tile.width {
                        let place = (tile.y + y) * SCREEN.width as usize + tile.x + x;
                        counts[place] += u32::from(tile.shown[y][x] == 0);
                    }
                }
            }
        }
        counts
    }

    #[test]
    fn neighbours_leave_no_crack_and_fill_no_pixel_twice() {
        // Fans about points on, beside and between pixel centres, over the whole screen.
        for centre in [(40.5, 30.5), (40.0, 30.0), (40.25, 30.73), (3.001, 58.999)] {
            let (w, h) = (SCREEN.width as f32, SCREEN.height as f32);
            let rim = [(0.0, 0.0), (33.3, 0.0), (w, 0.0), (w, 20.7), (w, h), (60.5, h), (0.0, h), (0.0, 17.5)];
            let fan: Vec<_> =
                (0..rim.len()).filter_map(|i| triangle([centre, rim[i], rim[(i + 1) % rim.len()]])).collect();
            assert!(counts(&fan).iter().all(|count| *count == 1), "about {centre:?}");
        }
    }

    #[test]
    fn a_pixel_is_inside_when_its_centre_is() {
        let counted: u32 = counts(&[triangle([(10.0, 10.0), (20.0, 10.0), (10.0, 20.0)]).unwrap()]).iter().sum();
        // Centres with x + y < 10 of a ten by ten square; those on the long side belong to the neighbour.
        assert_eq!(counted, 45);
        assert!(triangle([(3.0, 3.0), (9.0, 9.0), (6.0, 6.0)]).is_none(), "no area");
    }

    #[test]
    fn weights_are_correct_in_perspective() {
        // A strip that runs from distance 1 to 9: half-way on the screen is a tenth of the way along.
        let near = Vec4::new(-1.0, -1.0, 0.1, 1.0);
        let far = Vec4::new(9.0, -9.0, 0.1, 9.0);
        let side = Vec4::new(9.0, 9.0, 0.1, 9.0);
        let facing = Facing { one_sided: false, depth_factor: 1.0 };
        let weights = [Vec3::X, Vec3::Y, Vec3::Z];
        let t = ScreenTriangle::new([near, far, side].map(|p| SCREEN.project(p)), weights, facing, (0, 0, 0)).unwrap();
        let along = t.run(0, 60, 48, 49).weights(48);
        assert!((along.y - 0.1).abs() < 0.01, "{along}");
    }
}
