//! Triangles to pixels: positions in 1/256 of a pixel, exact integer edges, the top-left rule, 1/w as depth.
//!
//! The picture is cut into tiles that are filled in parallel. A tile first finds which triangle each of its pixels
//! shows, and then shades each pixel once.

use super::Drawing;
use super::shade::Shader;
use crate::photo::Picture;
use glam::{Vec3, Vec4};
use rayon::prelude::*;

/// Side of a tile, pixels.
const TILE: usize = 64;
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
        ((self.width as usize).div_ceil(TILE), (self.height as usize).div_ceil(TILE))
    }

    /// Position in 1/256 pixels, y down, and 1/w of a point inside clip space.
    fn project(self, clip: Vec4) -> ([i64; 2], f32) {
        let inverse = 1.0 / clip.w;
        let fixed = |part: f32, pixels: u32| (f64::from(part) * f64::from(pixels) * SUBPIXELS as f64).round() as i64;
        let x = fixed(0.5 + 0.5 * clip.x * inverse, self.width);
        let y = fixed(0.5 - 0.5 * clip.y * inverse, self.height);
        ([x, y], inverse)
    }
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
        screen: Screen,
        clip: [Vec4; 3],
        weights: [Vec3; 3],
        facing: Facing,
        (placed, triangle, surface): (u32, u32, u32),
    ) -> Option<Self> {
        let [a, b, c] = clip.map(|corner| screen.project(corner));
        let area = edge(a.0, b.0, c.0);
        // Counter-clockwise fronts have a negative area where y runs down.
        if area == 0 || (facing.one_sided && area > 0) {
            return None;
        }
        let ([a, b, c], weights) =
            if area > 0 { ([a, b, c], weights) } else { ([a, c, b], [weights[0], weights[2], weights[1]]) };
        let depth = |corner: ([i64; 2], f32)| corner.1 * facing.depth_factor;
        let inverse_w = [depth(a), depth(b), depth(c)];
        Some(ScreenTriangle { at: [a.0, b.0, c.0], inverse_w, weights, placed, triangle, surface })
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

    /// Weights of the corners at a pixel's centre, as they are on the screen.
    fn screen_weights(&self, x: usize, y: usize) -> Vec3 {
        let p = centre(x, y);
        let [a, b, c] = self.at;
        Vec3::new(edge(b, c, p) as f32, edge(c, a, p) as f32, edge(a, b, p) as f32) / self.area() as f32
    }

    /// Weights of the whole triangle's corners at a pixel's centre, correct in perspective.
    pub fn weights_at(&self, x: usize, y: usize) -> Vec3 {
        let near = self.screen_weights(x, y) * Vec3::from(self.inverse_w);
        let w = 1.0 / near.element_sum();
        (self.weights[0] * near.x + self.weights[1] * near.y + self.weights[2] * near.z) * w
    }
}

/// Twice the signed area of three points; exact.
fn edge(a: [i64; 2], b: [i64; 2], p: [i64; 2]) -> i64 {
    (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
}

fn centre(x: usize, y: usize) -> [i64; 2] {
    [x as i64 * SUBPIXELS + SUBPIXELS / 2, y as i64 * SUBPIXELS + SUBPIXELS / 2]
}

/// Fills, shades and joins the tiles.
pub(super) fn draw(screen: Screen, triangles: &[ScreenTriangle], shader: &Shader) -> Drawing {
    let (columns, rows) = screen.tiles();
    let bins = bins(screen, triangles);
    let tiles: Vec<Tile> = (0..columns * rows)
        .into_par_iter()
        .map(|index| {
            let mut tile = Tile::new(screen, index % columns, index / columns);
            bins[index].iter().for_each(|&t| tile.fill(&triangles[t as usize], t));
            tile.shade(triangles, shader);
            tile
        })
        .collect();
    let (width, height) = (screen.width as usize, screen.height as usize);
    let mut picture = Picture::new(screen.width, screen.height);
    let mut objects = vec![super::NO_OBJECT; width * height];
    picture.rgb.par_chunks_mut(width).zip(objects.par_chunks_mut(width)).enumerate().for_each(|(y, (rgb, objects))| {
        for tile in &tiles[y / TILE * columns..][..columns] {
            let from = (y - tile.y) * TILE;
            rgb[tile.x..tile.x + tile.width].copy_from_slice(&tile.rgb[from..from + tile.width]);
            objects[tile.x..tile.x + tile.width].copy_from_slice(&tile.objects[from..from + tile.width]);
        }
    });
    Drawing { picture, objects }
}

/// The triangles that may touch each tile, in their order: a tile's content does not depend on threads.
fn bins(screen: Screen, triangles: &[ScreenTriangle]) -> Vec<Vec<u32>> {
    let (columns, rows) = screen.tiles();
    let mut bins = vec![Vec::new(); columns * rows];
    for (index, triangle) in (0..).zip(triangles) {
        let ((x0, x1), (y0, y1)) = (triangle.pixels(0, screen.width), triangle.pixels(1, screen.height));
        if x0 < x1 && y0 < y1 {
            for y in y0 / TILE..=(y1 - 1) / TILE {
                (x0 / TILE..=(x1 - 1) / TILE).for_each(|x| bins[y * columns + x].push(index));
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
    depth: Vec<f32>,
    shown: Vec<u32>,
    rgb: Vec<[f32; 3]>,
    objects: Vec<u32>,
}

impl Tile {
    fn new(screen: Screen, column: usize, row: usize) -> Self {
        let (x, y) = (column * TILE, row * TILE);
        Tile {
            x,
            y,
            width: TILE.min(screen.width as usize - x),
            height: TILE.min(screen.height as usize - y),
            depth: vec![0.0; TILE * TILE],
            shown: vec![NONE; TILE * TILE],
            rgb: vec![[0.0; 3]; TILE * TILE],
            objects: vec![super::NO_OBJECT; TILE * TILE],
        }
    }

    fn fill(&mut self, triangle: &ScreenTriangle, index: u32) {
        let (first, end) = triangle.pixels(1, (self.y + self.height) as u32);
        let x_range = triangle.pixels(0, (self.x + self.width) as u32);
        let (x0, x1) = (x_range.0.max(self.x), x_range.1);
        let [a, b, c] = triangle.at;
        let edges = [(b, c), (c, a), (a, b)].map(|(from, to)| Edge::new(from, to));
        let area = triangle.area() as f32;
        let depth_at = |x: usize, y: usize| triangle.screen_weights(x, y).dot(Vec3::from(triangle.inverse_w));
        // 1/w is affine over the screen: its change from one pixel to the next.
        let slope = {
            let change = |e: &Edge| e.per_pixel as f32 / area;
            Vec3::from(edges.each_ref().map(change)).dot(Vec3::from(triangle.inverse_w))
        };
        for y in first.max(self.y)..end {
            let (mut low, mut high) = (x0 as i64, x1 as i64);
            edges.iter().for_each(|edge| edge.narrow(y, &mut low, &mut high));
            if low >= high {
                continue;
            }
            let row = (y - self.y) * TILE;
            let (from, to) = (row + low as usize - self.x, row + high as usize - self.x);
            let start = depth_at(low as usize, y);
            let pixels = self.depth[from..to].iter_mut().zip(&mut self.shown[from..to]);
            for (step, (depth, shown)) in pixels.enumerate() {
                let here = start + step as f32 * slope;
                if here > *depth {
                    (*depth, *shown) = (here, index);
                }
            }
        }
    }

    fn shade(&mut self, triangles: &[ScreenTriangle], shader: &Shader) {
        for y in 0..self.height {
            for x in 0..self.width {
                let i = y * TILE + x;
                let Some(triangle) = triangles.get(self.shown[i] as usize) else {
                    self.rgb[i] = shader.nothing();
                    continue;
                };
                let weights = triangle.weights_at(self.x + x, self.y + y);
                self.rgb[i] = shader.pixel(triangle, weights).into();
                self.objects[i] = shader.object(triangle);
            }
        }
    }
}

/// An edge function over the screen, with the top-left rule: a pixel centre on the edge counts where the edge is the
/// top or the left one, so that of two neighbours exactly one has it.
struct Edge {
    from: [i64; 2],
    to: [i64; 2],
    per_pixel: i64,
    bias: i64,
}

impl Edge {
    fn new(from: [i64; 2], to: [i64; 2]) -> Self {
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let top_or_left = dy < 0 || (dy == 0 && dx > 0);
        Edge { from, to, per_pixel: -dy * SUBPIXELS, bias: if top_or_left { 0 } else { -1 } }
    }

    /// Narrows a run of pixels of a row to those inside.
    fn narrow(&self, y: usize, low: &mut i64, high: &mut i64) {
        let at_zero = edge(self.from, self.to, centre(0, y)) + self.bias;
        match self.per_pixel {
            0 if at_zero < 0 => *high = *low,
            0 => {}
            // at_zero + per_pixel x >= 0.
            rise if rise > 0 => *low = (*low).max((-at_zero + rise - 1).div_euclid(rise)),
            fall => *high = (*high).min(at_zero.div_euclid(-fall) + 1),
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
        ScreenTriangle::new(SCREEN, corners.map(|(x, y)| clip(x, y)), weights, facing, (0, 0, 0))
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
                        counts[place] += u32::from(tile.shown[y * TILE + x] == 0);
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
        let t = ScreenTriangle::new(SCREEN, [near, far, side], weights, facing, (0, 0, 0)).unwrap();
        let along = t.weights_at(48, 60);
        assert!((along.y - 0.1).abs() < 0.01, "{along}");
    }
}
