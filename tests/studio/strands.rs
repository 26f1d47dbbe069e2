//! Strands of hair on a ball, for tests of renderers. Unit tests and integration tests use it.

use glam::Vec3;

/// Hair on a ball about the origin.
#[derive(Clone, Copy, Debug)]
pub struct HairyBall {
    /// Radius of the ball, metres.
    pub radius_m: f32,
    /// Length of each strand, metres.
    pub length_m: f32,
    /// Radius of each strand at its root, metres.
    pub strand_radius_m: f32,
    /// Number of strands.
    pub strands: u32,
    /// Segments of each strand.
    pub segments: u32,
}

impl HairyBall {
    /// A head of long hair.
    pub const HEAD: HairyBall =
        HairyBall { radius_m: 0.1, length_m: 0.16, strand_radius_m: 40e-6, strands: 40_000, segments: 12 };

    /// Returns positions and radii of each strand from root to tip. Roots lie on all of the ball but its lower front;
    /// strands are combed from a parting to both sides and backwards, fall by their weight, form clumps, and do not enter
    /// the ball.
    pub fn grow(&self) -> Vec<Vec<(Vec3, f32)>> {
        (0..self.strands).filter_map(|index| self.strand(index)).collect()
    }

    fn strand(&self, index: u32) -> Option<Vec<(Vec3, f32)>> {
        // Roots on a Fibonacci lattice
        let height = 1.0 - 2.0 * (index as f32 + 0.5) / self.strands as f32;
        let ring = (1.0 - height * height).max(0.0).sqrt();
        let (sin, cos) = (f64::from(index) * 2.399_963_229_728_653).sin_cos();
        let normal = Vec3::new(ring * cos as f32, height, ring * sin as f32);
        if normal.z > 0.25 && normal.y < 0.55 {
            return None;
        }
        // Lean towards the strand in the middle of the clump, more at the tip
        let clump = (normal * 14.0).round();
        let clump_seed = (clump.x as i32 * 73 + clump.y as i32 * 1009 + clump.z as i32 * 31) as u32;
        let own = self.path(normal, index);
        let middle = self.path(clump.normalize_or(normal), clump_seed);
        let points = own.into_iter().zip(middle).enumerate().map(|(i, (own, middle))| {
            let along = i as f32 / self.segments as f32;
            (own.lerp(middle, 0.75 * along), self.strand_radius_m * (1.0 - 0.6 * along))
        });
        Some(points.collect())
    }

    fn path(&self, normal: Vec3, seed: u32) -> Vec<Vec3> {
        let number = |k: u32| hash(seed.wrapping_mul(8).wrapping_add(k));
        let jitter = Vec3::new(number(0), number(1), number(2)) - 0.5;
        let step = self.length_m * (0.7 + 0.3 * number(3)) / self.segments as f32;
        let (phase, wave) = (std::f32::consts::TAU * number(4), 0.15 * number(5));
        let (mut position, mut direction) = (normal * self.radius_m, (normal + 0.5 * jitter).normalize());
        let mut points = Vec::with_capacity(self.segments as usize + 1);
        for i in 0..=self.segments {
            points.push(position);
            let along = i as f32 / self.segments as f32;
            let sway = Vec3::new((phase + 9.0 * along).sin(), 0.0, (phase + 9.0 * along).cos()) * wave;
            let comb =
                Vec3::new(0.8 * normal.x.signum() * (1.0 - along), -1.0, if position.z > 0.0 { -1.5 } else { 0.0 });
            direction = (direction + (comb + sway) * (6.0 / self.segments as f32)).normalize();
            position += direction * step;
            // Stay outside, in a layer of some thickness
            let least = self.radius_m * (1.01 + 0.12 * number(6) * along.sqrt());
            if position.length() < least {
                position = position.normalize() * least;
            }
        }
        points
    }
}

/// Returns a number in 0..1 that depends on the index (Mueller's 32-bit finaliser).
fn hash(index: u32) -> f32 {
    let mix = |x: u32| ((x >> 16) ^ x).wrapping_mul(0x045d_9f3b);
    let mixed = mix(mix(index.wrapping_add(1)));
    ((mixed >> 16 ^ mixed) >> 8) as f32 / (1_u32 << 24) as f32
}
