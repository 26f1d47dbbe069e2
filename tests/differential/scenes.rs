//! Random small scenes: a floor or a room, some objects, one to three lights, of a kind that follows from the seed.

use crate::studio::statistics::TestRng;
use catchlight::scene::{
    Aim, Camera, Emitter, Light, LightId, Material, Object, ObjectId, Output, Room, Scene, Shape, Transform,
};
use glam::Vec3;
use std::collections::HashMap;
use std::fmt::Write;

/// The objects that a scene has beside plain ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Plastics and metals of all roughness.
    Opaque,
    /// Mirrors and polished metal.
    Mirrors,
    /// Thin panes, some one behind the other.
    Panes,
    /// Slabs and boxes of glass and water.
    Glass,
    /// Things inside of a glass box: an object, another body, a mirror, a lamp.
    Enclosed,
    /// Balls of flat facets of glass and water.
    Balls,
    /// A room with all of these.
    Room,
    /// Surfaces that are partly clear or partly metal.
    Mixed,
    /// Nine lights: more than are all sampled at the first surface.
    ManyLights,
}

impl Kind {
    /// All kinds; a seed has the one of its remainder.
    pub const ALL: [Kind; 9] = [
        Kind::Opaque,
        Kind::Mirrors,
        Kind::Panes,
        Kind::Glass,
        Kind::Enclosed,
        Kind::Balls,
        Kind::Room,
        Kind::Mixed,
        Kind::ManyLights,
    ];
}

/// File names of the balls, with the subdivisions of their icosahedra: 80 and 320 triangles.
pub const BALLS: [(&str, u32); 2] = [("ball_80.obj", 1), ("ball_320.obj", 2)];

/// Returns the kind of a seed's scene.
pub fn kind(seed: u64) -> Kind {
    Kind::ALL[(seed % Kind::ALL.len() as u64) as usize]
}

/// Returns the scene of a seed.
pub fn scene(seed: u64) -> Scene {
    let mut builder = Builder { rng: TestRng::new(seed), scene: Scene::default(), kind: kind(seed) };
    builder.scene.name = format!("Differential test, seed {seed}, {:?}", builder.kind);
    builder.add_camera();
    builder.add_surroundings();
    builder.add_objects();
    builder.add_lights();
    builder.scene
}

struct Builder {
    rng: TestRng,
    scene: Scene,
    kind: Kind,
}

impl Builder {
    fn chance(&mut self, probability: f32) -> bool {
        self.rng.uniform() < probability
    }

    fn choose<T: Copy>(&mut self, of: &[T]) -> T {
        of[(self.rng.uniform() * of.len() as f32) as usize]
    }

    fn within(&mut self, low: Vec3, high: Vec3) -> Vec3 {
        Vec3::new(self.rng.range(low.x, high.x), self.rng.range(low.y, high.y), self.rng.range(low.z, high.z))
    }

    fn add_camera(&mut self) {
        let position = self.within(Vec3::new(-1.2, 0.5, 2.6), Vec3::new(1.2, 2.0, 3.4));
        let aim = Aim::Point(self.within(Vec3::new(-0.2, 0.2, -0.2), Vec3::new(0.2, 0.5, 0.2)));
        let focal_length_mm = self.rng.range(35.0, 70.0);
        self.scene.camera = Camera { position, aim, focal_length_mm, ..Camera::default() };
    }

    fn add_surroundings(&mut self) {
        if self.kind == Kind::Room {
            let size_m = Vec3::new(4.5, 2.8, 7.5);
            let [floor, walls, ceiling] = [(); 3].map(|()| self.matte());
            self.scene.room = Some(Room { size_m, floor, walls, ceiling });
            return;
        }
        let floor = self.opaque();
        let size = self.rng.range(3.0, 6.0);
        self.add("Floor", Shape::Plane { width_m: size, depth_m: size }, Vec3::ZERO, Vec3::ZERO, floor);
        if self.chance(0.3) {
            let wall = self.opaque();
            let position = Vec3::new(0.0, 1.0, -1.5);
            self.add("Wall", Shape::Plane { width_m: 4.0, depth_m: 2.5 }, position, Vec3::new(90.0, 0.0, 0.0), wall);
        }
    }

    fn add_objects(&mut self) {
        // What the kind is about, before the camera's aim
        match self.kind {
            Kind::Panes => self.add_row_of_panes(),
            Kind::Enclosed => self.add_enclosed(),
            _ => {
                let material = self.featured();
                self.add_thing(Vec3::ZERO, material);
            }
        }
        // Others around it
        for slot in [Vec3::new(-0.95, 0.0, 0.2), Vec3::new(0.95, 0.0, 0.0), Vec3::new(-0.5, 0.0, -0.9)] {
            if self.chance(0.6) {
                let material = if self.chance(0.5) { self.featured() } else { self.opaque() };
                let jitter = self.within(Vec3::splat(-0.08), Vec3::splat(0.08));
                self.add_thing(slot + jitter * Vec3::new(1.0, 0.0, 1.0), material);
            }
        }
    }

    /// Adds a box, a slab, a ball or, of clear glass, a pane over a place on the floor.
    fn add_thing(&mut self, floor: Vec3, material: Material) {
        let turn = Vec3::new(0.0, self.rng.range(-180.0, 180.0), 0.0);
        let tilt = self.within(Vec3::new(-40.0, 0.0, -40.0), Vec3::new(40.0, 0.0, 40.0));
        if self.kind == Kind::Balls || self.chance(0.25) {
            let (file, _) = BALLS[usize::from(self.chance(0.2))];
            let radius = self.rng.range(0.18, 0.34);
            let scale = Vec3::splat(radius);
            self.add("Ball", Shape::MeshFile { path: file.into() }, floor + Vec3::Y * (radius + 0.01), turn, material);
            self.scene.objects.last_mut().unwrap().transform.scale = scale;
            return;
        }
        if self.chance(0.25) {
            let size_m = Vec3::new(self.rng.range(0.3, 0.5), self.rng.range(0.3, 0.5), self.rng.range(0.01, 0.1));
            self.add("Slab", Shape::Box { size_m }, floor + Vec3::Y * 0.36, turn + tilt, material);
            return;
        }
        let size_m = self.within(Vec3::splat(0.15), Vec3::splat(0.42));
        if self.chance(0.5) {
            self.add("Box", Shape::Box { size_m }, floor + Vec3::Y * (0.5 * size_m.y + 0.002), turn, material);
        } else {
            self.add("Box", Shape::Box { size_m }, floor + Vec3::Y * 0.42, turn + tilt, material);
        }
    }

    fn add_row_of_panes(&mut self) {
        let count = self.choose(&[1, 2, 2, 3, 4]);
        let tilted = self.chance(0.5);
        let material = self.opaque();
        self.add_thing(Vec3::new(0.0, 0.0, -0.4), material);
        for index in 0..count {
            let range = if tilted { 35.0 } else { 0.0 };
            let turn = Vec3::new(90.0 + self.rng.range(-range, range), self.rng.range(-range, range), 0.0);
            let position = Vec3::new(0.0, 0.5, 0.2 + 0.3 * index as f32);
            let (width_m, depth_m) = (self.rng.range(0.5, 1.0), self.rng.range(0.5, 0.8));
            let clear = self.clear();
            self.add("Pane", Shape::Plane { width_m, depth_m }, position, turn, clear);
        }
    }

    fn add_enclosed(&mut self) {
        let size_m = self.within(Vec3::splat(0.5), Vec3::splat(0.75));
        let turn = Vec3::new(self.rng.range(-20.0, 20.0), self.rng.range(-180.0, 180.0), 0.0);
        let clear = self.clear();
        let centre = Vec3::Y * 0.5;
        self.add("Case", Shape::Box { size_m }, centre, turn, clear);
        if self.chance(0.2) {
            let emitter = Emitter::Sphere { radius_m: 0.12 };
            let lumens = self.rng.range(300.0, 1500.0);
            self.add_light(emitter, Output::Lumens(lumens), centre);
            return;
        }
        let material = match self.choose(&[0, 1, 2, 2]) {
            0 => self.mirror(),
            1 => self.clear(),
            _ => self.opaque(),
        };
        let turn = self.within(Vec3::splat(-90.0), Vec3::splat(90.0));
        if self.chance(0.5) {
            let size_m = self.within(Vec3::splat(0.1), Vec3::splat(0.26));
            self.add("Content", Shape::Box { size_m }, centre, turn, material);
        } else {
            self.add("Content", Shape::MeshFile { path: BALLS[0].0.into() }, centre, turn, material);
            self.scene.objects.last_mut().unwrap().transform.scale = Vec3::splat(0.2);
        }
    }

    fn add(&mut self, name: &str, shape: Shape, position: Vec3, rotation_deg: Vec3, material: Material) {
        let name = self.scene.unique_name(name);
        let transform = Transform { position, rotation_deg, ..Transform::default() };
        let id = ObjectId(self.scene.objects.len() as u32);
        let object =
            Object { id, name, transform, shape, material, part_materials: Vec::new(), visible: true, locked: false };
        self.scene.objects.push(object);
    }

    fn add_lights(&mut self) {
        let count = if self.kind == Kind::ManyLights { 9 } else { self.choose(&[1, 1, 2, 3]) };
        for index in 0..count {
            let is_inside = self.kind == Kind::Room;
            let direction = loop {
                let direction = self.rng.direction();
                if direction.y > 0.25 && direction.z > -0.5 {
                    break direction;
                }
            };
            let distance = if is_inside { self.rng.range(1.2, 1.9) } else { self.rng.range(1.6, 2.5) };
            let position = Vec3::Y * 0.5 + direction * distance;
            let lumens = Output::Lumens(self.rng.range(3000.0, 10_000.0));
            let lux = Output::Lux(self.rng.range(300.0, 2000.0));
            // The first light is wide, so that paths hit it often
            let (low, high) = match (index, is_inside) {
                (0, false) => (1.8, 3.0),
                (0, true) => (1.2, 2.0),
                _ => (0.5, 1.2),
            };
            let (width_m, height_m) = (self.rng.range(low, high), self.rng.range(low, high));
            let kinds: &[u32] = if is_inside { &[0, 1, 2] } else { &[0, 0, 1, 2, 3, 4, 4, 4] };
            let (emitter, output) = match self.choose(kinds) {
                0 => (Emitter::RectPanel { width_m, height_m }, lumens),
                1 => (Emitter::RoundPanel { diameter_m: width_m }, lumens),
                2 => (Emitter::Sphere { radius_m: 0.22 * width_m }, lumens),
                3 => (Emitter::Sun { angular_diameter_deg: 25.0 * width_m }, lux),
                _ => (Emitter::Surround, lux),
            };
            self.add_light(emitter, output, position);
        }
    }

    fn add_light(&mut self, emitter: Emitter, output: Output, position: Vec3) {
        let name = self.scene.unique_name("Light");
        let aim = Aim::Point(self.within(Vec3::new(-0.3, 0.0, -0.3), Vec3::new(0.3, 0.5, 0.3)));
        let roll_deg = self.rng.range(-180.0, 180.0);
        let visible_to_camera = self.chance(0.3);
        let id = LightId(self.scene.lights.len() as u32);
        let light = Light { id, name, position, aim, roll_deg, visible_to_camera, ..Light::new(emitter, output) };
        self.scene.lights.push(light);
    }

    fn featured(&mut self) -> Material {
        match self.kind {
            Kind::Opaque => self.opaque(),
            Kind::Mirrors => self.mirror(),
            Kind::Panes | Kind::Glass | Kind::Enclosed | Kind::Balls => self.clear(),
            Kind::Room | Kind::ManyLights => match self.choose(&[0, 1, 2]) {
                0 => self.opaque(),
                1 => self.mirror(),
                _ => self.clear(),
            },
            Kind::Mixed => self.mixed(),
        }
    }

    fn color(&mut self, low: f32, high: f32) -> [f32; 3] {
        self.within(Vec3::splat(low), Vec3::splat(high)).to_array()
    }

    /// Returns a roughness of any size; one in ten is that of a mirror.
    fn roughness(&mut self) -> f32 {
        if self.chance(0.1) { 0.0 } else { self.rng.range(0.04, 1.0) }
    }

    fn matte(&mut self) -> Material {
        let roughness = self.rng.range(0.5, 1.0);
        Material { base_color: self.color(0.1, 0.75), roughness, ..Material::default() }
    }

    fn opaque(&mut self) -> Material {
        let metallic = if self.chance(0.35) { 1.0 } else { 0.0 };
        let roughness = self.roughness();
        let ior = if self.chance(0.1) { 1.0 } else { self.rng.range(1.2, 2.2) };
        let emission = self.rng.range(50.0, 300.0);
        let emission_cd_m2 = if self.chance(0.05) { [emission; 3] } else { [0.0; 3] };
        Material { base_color: self.color(0.05, 0.9), metallic, roughness, ior, emission_cd_m2, ..Material::default() }
    }

    fn mirror(&mut self) -> Material {
        let roughness = self.choose(&[0.0, 0.0, 0.02, 0.05, 0.1]);
        Material { base_color: self.color(0.6, 0.95), metallic: 1.0, roughness, ..Material::default() }
    }

    fn clear(&mut self) -> Material {
        let ior = if self.chance(0.5) { self.choose(&[1.333, 1.52]) } else { self.rng.range(1.1, 2.0) };
        let absorption_per_m = if self.chance(0.5) { self.color(0.0, 4.0) } else { [0.0; 3] };
        let base_color = if self.chance(0.5) { self.color(0.2, 1.0) } else { [0.99; 3] };
        Material { base_color, roughness: 0.0, transmission: 1.0, ior, absorption_per_m, ..Material::default() }
    }

    fn mixed(&mut self) -> Material {
        let (transmission, metallic) = self.choose(&[(0.5, 0.0), (0.8, 0.0), (0.0, 0.4), (0.6, 0.3)]);
        let absorption_per_m = if self.chance(0.5) { self.color(0.0, 4.0) } else { [0.0; 3] };
        Material { transmission, metallic, absorption_per_m, ..self.opaque() }
    }
}

/// Returns the text of an OBJ file of a ball of radius 1 m with flat facets: an icosahedron, subdivided so often.
pub fn ball_obj(subdivisions: u32) -> String {
    let (vertices, triangles) = icosphere(subdivisions);
    let mut text = String::from("o ball\n");
    for vertex in &vertices {
        writeln!(text, "v {} {} {}", vertex.x, vertex.y, vertex.z).unwrap();
    }
    for triangle in &triangles {
        let [a, b, c] = triangle.map(|i| vertices[i]);
        let normal = (b - a).cross(c - a).normalize();
        writeln!(text, "vn {} {} {}", normal.x, normal.y, normal.z).unwrap();
    }
    for (face, [a, b, c]) in triangles.iter().enumerate() {
        let normal = face + 1;
        writeln!(text, "f {}//{normal} {}//{normal} {}//{normal}", a + 1, b + 1, c + 1).unwrap();
    }
    text
}

fn icosphere(subdivisions: u32) -> (Vec<Vec3>, Vec<[usize; 3]>) {
    let g = 0.5 * (1.0 + 5.0_f32.sqrt());
    let corners = [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)];
    let mut vertices: Vec<Vec3> = corners.iter().map(|&(x, y)| Vec3::new(x, y, 0.0).normalize()).collect();
    vertices.extend(corners.iter().map(|&(x, y)| Vec3::new(0.0, x, y).normalize()));
    vertices.extend(corners.iter().map(|&(x, y)| Vec3::new(y, 0.0, x).normalize()));
    // All triples of neighbours, wound outwards
    let edge = (vertices[0] - vertices[1]).length();
    let are_neighbours = |a: usize, b: usize| ((vertices[a] - vertices[b]).length() - edge).abs() < 1e-3;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if are_neighbours(a, b) && are_neighbours(b, c) && are_neighbours(a, c) {
                    let [p, q, r] = [a, b, c].map(|i| vertices[i]);
                    let is_outward = (q - p).cross(r - p).dot(p) > 0.0;
                    triangles.push(if is_outward { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    for _ in 0..subdivisions {
        let mut middles = HashMap::new();
        let mut middle = |a: usize, b: usize| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                vertices.push((vertices[a] + vertices[b]).normalize());
                vertices.len() - 1
            })
        };
        let quarters = triangles.iter().flat_map(|&[a, b, c]| {
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        });
        triangles = quarters.collect();
    }
    (vertices, triangles)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn balls_have_80_and_320_triangles_and_nearly_the_volume_of_a_sphere() {
        for ((_, subdivisions), (count, part)) in BALLS.into_iter().zip([(80, 0.87), (320, 0.96)]) {
            let (vertices, triangles) = icosphere(subdivisions);
            let volume: f32 =
                triangles.iter().map(|t| t.map(|i| vertices[i])).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum();
            assert_eq!(triangles.len(), count);
            assert!((volume / (4.0 / 3.0 * std::f32::consts::PI) - part).abs() < 0.02, "{volume}");
        }
    }
}
