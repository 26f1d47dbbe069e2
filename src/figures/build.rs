//! Builds the mesh of a figure.

use super::body_data::{BodyData, Mask};
use super::eyes::add_eye;
use super::hair::{self, HairBody};
use super::morph::rest_positions;
use super::patch::Patch;
use super::regions::{Edges, Garment};
use super::skeleton::Skeleton;
use super::skin_colors::{NO_SKIN, skin_colors};
use super::skinning::skin;
use super::subdivide::QuadMesh;
use crate::scene::{Bottom, Extent, Figure, FigureMeshes, Mesh, MeshPart};
use glam::{Affine3A, Quat, Vec2, Vec3};
use std::sync::{Arc, LazyLock};

/// Names of a figure's parts, each with a material of its own.
pub const PARTS: [&str; 12] =
    ["skin", "eyes", "iris", "pupil", "teeth", "tongue", "top", "bottom", "shoes", "lips", "nails", "mouth"];
const SKIN: u8 = 0;
const EYES: u8 = 1;
const TEETH: u8 = 4;
const TONGUE: u8 = 5;
const TOP: u8 = 6;
const BOTTOM: u8 = 7;
const SHOE: u8 = 8;
/// Regions of the skin that are parts, with their masks.
const REGIONS: [(u8, &str); 3] = [(9, "lips"), (10, "fingernails"), (11, "inside-mouth")];
/// Skin reaches this far below the edge of a garment, metres.
const OVERLAP_M: f32 = 0.03;
/// Distance of a collar from the cage of the skin, metres.
const COLLAR_M: f32 = 0.007;
/// Heights of the cut of a bust, as a part of the way from hips to neck.
const BUST_CUT: f32 = 0.42;
/// Distance of the pupils in front of the origin in the rest pose, as a part of the height.
const EYES_FORWARD: f32 = 0.043;

/// A body in its pose: the cage of all vertices.
#[derive(Clone, Debug)]
pub struct PosedBody {
    /// Vertices of the body data, metres; the figure stands on height 0.
    pub positions: Vec<Vec3>,
    /// From the skeleton's space to the object's: the figure stands on the floor, with its eyes above the origin.
    pub shift: Vec3,
    /// World from rest for the bones.
    transforms: Vec<Affine3A>,
    /// Middle of the eyeballs in the rest pose, left and right, and their radius.
    eyes: [(Vec3, f32); 2],
}

impl PosedBody {
    /// Shapes and poses a body.
    pub fn new(data: &BodyData, figure: &Figure) -> PosedBody {
        let rest = rest_positions(data, figure);
        let skeleton = Skeleton::new(data, &rest, figure);
        let mut transforms = skeleton.transforms;
        let mut positions = skin(data, &rest, &transforms);
        // Stand on the floor, or on the cut of a bust
        let soles = || data.quads("body").iter().flatten().map(|&v| positions[usize::from(v)].y);
        let floor = match figure.extent {
            Extent::Whole if figure.pose.seat_m.is_none() => soles().fold(f32::INFINITY, f32::min),
            Extent::Whole => 0.0,
            Extent::Bust => bust_cut(data, &positions),
        };
        let eyes = ["helper-l-eye", "helper-r-eye"].map(|group| ball(data.quads(group), &rest));
        let (eye, radius) = eyes[0];
        let shift = Vec3::new(0.0, -floor, EYES_FORWARD * figure.body.height_m - eye.z - radius);
        let to_origin = Affine3A::from_translation(shift);
        positions.iter_mut().for_each(|p| *p += shift);
        transforms.iter_mut().for_each(|t| *t = to_origin * *t);
        PosedBody { positions, shift, transforms, eyes }
    }

    /// Returns world from head: origin between the eyes, +Z the direction of the face.
    pub fn head(&self, data: &BodyData) -> Affine3A {
        let head = data.bone("head").map_or(Affine3A::IDENTITY, |bone| self.transforms[bone]);
        head * Affine3A::from_translation((self.eyes[0].0 + self.eyes[1].0) / 2.0)
    }

    /// Returns world from a ball of radius 1 that looks along +Z, for the left and right eye.
    pub fn eyeballs(&self, data: &BodyData, figure: &Figure) -> [Affine3A; 2] {
        let head = data.bone("head").map_or(Affine3A::IDENTITY, |bone| self.transforms[bone]);
        let t = &figure.pose.torso;
        let gaze =
            Quat::from_rotation_y(t.gaze_yaw_deg.to_radians()) * Quat::from_rotation_x(t.gaze_pitch_deg.to_radians());
        self.eyes
            .map(|(middle, radius)| head * Affine3A::from_scale_rotation_translation(Vec3::splat(radius), gaze, middle))
    }
}

/// Returns the middle and the radius of a ball of quads.
fn ball(quads: &[[u16; 4]], positions: &[Vec3]) -> (Vec3, f32) {
    let points = || quads.iter().flatten().map(|&v| positions[usize::from(v)]);
    let (low, high) = points().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
    let middle = (low + high) / 2.0;
    // The helper ball bulges in front where its cornea is: the height tells the radius.
    let radius = (high.y - low.y) / 2.0;
    (middle.with_z(low.z + radius), radius)
}

/// Returns the height of a bust's cut.
fn bust_cut(data: &BodyData, positions: &[Vec3]) -> f32 {
    let joint = |name: &str| data.bone(name).map_or(0.0, |b| positions[usize::from(data.bones[b].head)].y);
    let (hips, neck) = (joint("pelvis.L"), joint("neck01"));
    hips + (neck - hips) * BUST_CUT
}

/// Builds the meshes of a figure in object space, metres.
pub fn build(data: &BodyData, figure: &Figure) -> FigureMeshes {
    let body = PosedBody::new(data, figure);
    let eyeballs = body.eyeballs(data, figure);
    let eyes = eyeballs.map(|ball| ball.translation.into());
    let hair_body = HairBody { data, positions: &body.positions, head: body.head(data), eyes };
    let (eyes_mesh, eye_colors) = both_eyes(eyeballs);
    let finish = |mut quads: QuadMesh, mut normals: Vec<Vec3>| {
        let mut colors = skin_colors(&quads.places, figure);
        quads.append(&eyes_mesh);
        normals.extend(eyes_mesh.normals());
        colors.extend(&eye_colors);
        to_mesh(&quads, &normals, &colors)
    };
    let skin = || {
        let mut coarse = cage(data, figure, &body).subdivided();
        let mut fine = coarse.subdivided();
        fine.move_to_limit();
        let normals = fine.normals();
        // The vertices of the coarse mesh are the first ones of the fine mesh: both lie on the limit surface
        let shared = coarse.positions.len();
        coarse.positions.copy_from_slice(&fine.positions[..shared]);
        let coarse_normals = normals[..shared].to_vec();
        rayon::join(|| split_skin(data, &mut coarse), || split_skin(data, &mut fine));
        rayon::join(|| finish(coarse, coarse_normals), || finish(fine, normals))
    };
    let ((mut coarse, mut fine), strands) = rayon::join(skin, || hair::grow(&hair_body, figure));
    coarse.strands = hair::thinned(&strands);
    fine.strands = strands;
    FigureMeshes { fine: Arc::new(fine), coarse: Arc::new(coarse) }
}

/// Returns the meshes of a figure from those of one that differs from it in the gaze alone: the same bits as
/// [`build`] gives, sooner.
pub fn with_other_gaze(data: &BodyData, built: &FigureMeshes, figure: &Figure) -> FigureMeshes {
    let (eyes, colors) = both_eyes(PosedBody::new(data, figure).eyeballs(data, figure));
    let eyes = to_mesh(&eyes, &eyes.normals(), &colors);
    let turned = |mesh: &Mesh| {
        let mut mesh = mesh.clone();
        // The vertices of eyes are a block of their own
        let part = mesh.parts.iter().find(|part| part.name == PARTS[usize::from(EYES)]);
        let first = part.map_or(0, |part| mesh.triangles[part.triangles.start as usize][0] as usize);
        let block = first..first + eyes.positions.len();
        if part.is_some() && block.end <= mesh.positions.len() {
            mesh.positions[block.clone()].copy_from_slice(&eyes.positions);
            mesh.normals[block.clone()].copy_from_slice(&eyes.normals);
            mesh.colors[block].copy_from_slice(&eyes.colors);
        }
        Arc::new(mesh)
    };
    let (fine, coarse) = rayon::join(|| turned(&built.fine), || turned(&built.coarse));
    FigureMeshes { fine, coarse }
}

/// Returns the quads of a pair of eyes, and the colours of their vertices.
fn both_eyes(eyeballs: [Affine3A; 2]) -> (QuadMesh, Vec<Vec3>) {
    let (mut mesh, mut colors) = (QuadMesh::default(), Vec::new());
    for eyeball in eyeballs {
        colors.extend(add_eye(&mut mesh, eyeball, |part| EYES + part as u8));
    }
    (mesh, colors)
}

/// The distance of a vertex from the edge of a garment, metres; negative outside.
type EdgeField<'a> = dyn Fn(u16) -> f32 + 'a;

/// Returns the quads of all parts before subdivision.
fn cage(data: &BodyData, figure: &Figure, body: &PosedBody) -> QuadMesh {
    static EDGES: LazyLock<Edges> = LazyLock::new(|| Edges::new(BodyData::shipped()));
    let edges = &*EDGES;
    let is_kept = |quad: &[u16; 4]| {
        figure.extent == Extent::Whole || quad.iter().any(|&v| body.positions[usize::from(v)].y > 0.0)
    };
    let mut mesh = QuadMesh::default();
    // Skin that a garment hides well is not there
    let covered =
        |v: u16| edges.top(v, figure.top).max(edges.below_bottom(v, figure.bottom)).max(edges.shoe(v)) > OVERLAP_M;
    let seen = |quad: &[u16; 4]| is_kept(quad) && !quad.iter().all(|&v| covered(v));
    // The cut of a bust is level.
    let level = |v: u16| body.positions[usize::from(v)].y;
    let mut skin = Patch::new(data, "body", &body.positions, &seen);
    if figure.extent == Extent::Bust {
        skin.move_border(&level);
    }
    let eyes = data.eyes_middle();
    add_part(&mut mesh, &skin, SKIN);
    mesh.places = skin.sources.iter().map(|&v| data.positions[usize::from(v)] - eyes).collect();
    for (group, part) in [("helper-upper-teeth", TEETH), ("helper-lower-teeth", TEETH), ("helper-tongue", TONGUE)] {
        add_part(&mut mesh, &Patch::new(data, group, &body.positions, &is_kept), part);
    }
    // Garments
    let near_neck =
        Patch::new(data, "body", &body.positions, &|quad| quad.iter().all(|&v| edges.is_near_neckline(v, figure.top)));
    let skirt = figure.bottom == Bottom::Skirt;
    let legs = if skirt { "helper-skirt" } else { "helper-tights" };
    let garments: [(Garment, u8, &str, &EdgeField); 3] = [
        (Garment::Bottom, BOTTOM, legs, &|v| edges.bottom(v, figure.bottom)),
        (Garment::Top, TOP, "helper-tights", &|v| edges.top(v, figure.top)),
        (Garment::Shoe, SHOE, "helper-tights", &|v| edges.shoe(v)),
    ];
    for (garment, part, group, field) in garments {
        let is_inside = |quad: &[u16; 4]| is_kept(quad) && quad.iter().any(|&v| field(v) > 0.0);
        let mut patch = Patch::new(data, group, &body.positions, &is_inside);
        patch.move_border(&|v| if figure.extent == Extent::Bust { field(v).min(level(v)) } else { field(v) });
        let loose =
            |v: u16| if skirt && garment == Garment::Bottom { 0.0 } else { edges.looseness(v, garment, figure.top) };
        patch.move_outwards(&loose);
        // Only the edge of a collar lies close: further out the garment hangs from the shoulders
        if garment == Garment::Top {
            patch.lay_on(&near_neck, COLLAR_M, &|v| edges.nearness_to_neckline(v, figure.top).powi(8));
        }
        add_part(&mut mesh, &patch, part);
    }
    mesh
}

/// Appends a patch as a part.
fn add_part(mesh: &mut QuadMesh, patch: &Patch, part: u8) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(&patch.positions);
    mesh.quads.extend(patch.quads.iter().map(|quad| quad.map(|v| v + first)));
    mesh.uvs.extend(&patch.uvs);
    mesh.parts.extend(patch.quads.iter().map(|_| part));
    mesh.places.resize(mesh.positions.len(), NO_SKIN);
}

/// Gives the quads of skin in regions of their own to their parts. Done after subdivision, when quads are so small that
/// their steps are not seen.
fn split_skin(data: &BodyData, mesh: &mut QuadMesh) {
    let regions = REGIONS.map(|(part, mask)| (part, data.masks.get(mask)));
    for (part, uvs) in mesh.parts.iter_mut().zip(&mesh.uvs).filter(|(part, _)| **part == SKIN) {
        let middle = uvs.iter().sum::<Vec2>() / 4.0;
        let is_in = |mask: &Option<&Mask>| mask.is_some_and(|mask| mask.at(middle) > 0.5);
        *part = regions.iter().find(|(_, mask)| is_in(mask)).map_or(SKIN, |(part, _)| *part);
    }
}

/// Splits quads into triangles, by part, with a vertex for each pair of position and texture coordinates.
fn to_mesh(quads: &QuadMesh, normals: &[Vec3], colors: &[Vec3]) -> Mesh {
    let mut mesh = Mesh::default();
    // The vertices of each position form a list, one for each pair of texture coordinates
    const END: u32 = u32::MAX;
    let (mut first, mut next) = (vec![END; quads.positions.len()], Vec::with_capacity(quads.positions.len() * 5 / 4));
    let mut vertex_of = |mesh: &mut Mesh, position: u32, uv: Vec2| {
        let position = position as usize;
        let mut vertex = first[position];
        while vertex != END && mesh.uvs[vertex as usize] != uv {
            vertex = next[vertex as usize];
        }
        if vertex == END {
            vertex = mesh.positions.len() as u32;
            next.push(std::mem::replace(&mut first[position], vertex));
            mesh.positions.push(quads.positions[position]);
            mesh.normals.push(normals[position]);
            mesh.colors.push(colors[position]);
            mesh.uvs.push(uv);
        }
        vertex
    };
    for (part, name) in PARTS.into_iter().enumerate() {
        let start = mesh.triangles.len() as u32;
        for index in (0..quads.quads.len()).filter(|&i| usize::from(quads.parts[i]) == part) {
            let [a, b, c, d] =
                std::array::from_fn(|k| vertex_of(&mut mesh, quads.quads[index][k], quads.uvs[index][k]));
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
        let end = mesh.triangles.len() as u32;
        if end > start {
            mesh.parts.push(MeshPart { name: name.to_owned(), triangles: start..end });
        }
    }
    mesh
}
