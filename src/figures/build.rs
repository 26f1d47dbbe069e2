//! Builds the mesh of a figure.

use super::body_data::{BodyData, Mask};
use super::eyes::add_eye;
use super::garments::dress;
use super::gaze::without_gaze;
use super::hair::{self, HairBody};
use super::last_results::LastResults;
use super::materials::LIP_TINT;
use super::patch::Patch;
use super::posed_body::PosedBody;
use super::regions::{Clothes, Edges, Garment};
use super::skin_colors::{NO_SKIN, skin_colors};
use super::subdivide::{QuadMesh, SubdivisionSurface};
use super::tear_line::{Lashes, add_tear_line};
use crate::scene::{Expression, Figure, FigureMeshes, Mesh, MeshPart, Strands};
use glam::{Affine3A, Vec2, Vec3};
use std::sync::Arc;

/// Names of a figure's parts, each with a material of its own.
pub const PARTS: [&str; 11] =
    ["skin", "eyes", "iris", "teeth", "tongue", "top", "bottom", "shoes", "lips", "nails", "mouth"];
const SKIN: u8 = 0;
const EYES: u8 = 1;
/// Helper meshes of what is inside of the mouth, with their parts.
const INSIDE_MOUTH: [(&str, u8); 3] = [("helper-upper-teeth", 3), ("helper-lower-teeth", 3), ("helper-tongue", 4)];
/// Regions of the skin that are parts, with their masks.
const REGIONS: [(u8, &str); 3] = [(8, "lips"), (9, "fingernails"), (10, "inside-mouth")];
/// Figures whose clothes and hair are kept: for each some 15 MB. A slider changes the face of one.
const KEPT_FIGURES: usize = 2;
/// Distance from the lips over which skin loses their colour, in texture coordinates: 1.6 mm.
const LIP_FADE: f32 = 1.6 / 1024.0;
/// Middle of the mouth, metres from between the eyes, and the radius of a ball round the lips and their fading colour.
const MOUTH: (Vec3, f32) = (Vec3::new(0.0, -0.072, 0.03), 0.04);
/// Skin reaches this far below the edge of a garment, metres.
const OVERLAP_M: f32 = 0.03;

/// Builds the meshes of a figure in object space, metres.
pub fn build(figure: &Figure) -> FigureMeshes {
    let data = BodyData::shipped();
    let body = PosedBody::new(data, figure);
    let still = &without_expression(figure);
    let eyeballs = body.eyeballs(data, figure);
    let (eyes_mesh, eye_colors) = both_eyes(eyeballs);
    let finish = |mut quads: QuadMesh, normals: &[Vec3], colors: &[Vec3], tears: &(QuadMesh, Vec<Vec3>)| {
        // The vertices of the coarse mesh are the first ones of the fine mesh: both lie on the limit surface
        let count = quads.positions.len();
        split_skin(data, &mut quads);
        let lip_strengths = lip_strengths(data, &quads);
        quads.append(&eyes_mesh);
        quads.append(&tears.0);
        let normals = [&normals[..count], &eyes_mesh.normals(), &tears.0.normals()].concat();
        to_mesh(&quads, &normals, &[&colors[..count], &eye_colors, &tears.1].concat(), &lip_strengths)
    };
    let skin = || {
        let (mut coarse, clothes) =
            rayon::join(|| SubdivisionSurface::new(cage(data, figure, &body)).subdivided(), || clothes(still));
        coarse.append(&clothes);
        let mut fine = coarse.subdivided();
        fine.move_to_limit();
        let (mut coarse, fine) = (coarse.mesh, fine.mesh);
        let shared = coarse.positions.len();
        coarse.positions.copy_from_slice(&fine.positions[..shared]);
        let ((normals, colors), tears) = rayon::join(
            || rayon::join(|| fine.normals(), || skin_colors(&fine.values, figure)),
            || tear_lines(data, figure, &body, &fine),
        );
        rayon::join(|| finish(coarse, &normals, &colors, &tears), || finish(fine, &normals, &colors, &tears))
    };
    let hair = || {
        let of_head = || {
            let mut strands = Strands::default();
            strands.append_all(&head_hair(still));
            strands.end_part("hair");
            strands
        };
        let of_face = || hair::grow_on_face(&hair_body(data, figure, &body), figure);
        let (mut strands, of_face) = rayon::join(of_head, of_face);
        strands.append(&of_face);
        strands
    };
    let ((mut coarse, mut fine), strands) = rayon::join(skin, hair);
    coarse.strands = hair::thinned(&strands);
    fine.strands = strands;
    FigureMeshes { fine: Arc::new(fine), coarse: Arc::new(coarse) }
}

/// Returns the figure without expression and gaze: all that matters to clothes and to the hair of the head.
fn without_expression(figure: &Figure) -> Figure {
    Figure { expression: Expression::default(), ..without_gaze(figure) }
}

/// Returns the garments of a figure without expression; those of the last ones are kept.
fn clothes(still: &Figure) -> Arc<SubdivisionSurface> {
    static LAST: LastResults<Arc<SubdivisionSurface>> = LastResults::new(KEPT_FIGURES);
    let data = BodyData::shipped();
    LAST.get_or(still, || Arc::new(dress(data, still, &PosedBody::new(data, still), garment_part)))
}

/// Returns the hair of the head of a figure without expression, in groups; those of the last figures are kept.
fn head_hair(still: &Figure) -> Arc<[Strands]> {
    static LAST: LastResults<Arc<[Strands]>> = LastResults::new(KEPT_FIGURES);
    let data = BodyData::shipped();
    LAST.get_or(still, || {
        let body = PosedBody::new(data, still);
        Arc::from(hair::grow_on_head(&hair_body(data, still, &body), still))
    })
}

/// Returns the body of a figure that hair grows on.
fn hair_body<'a>(data: &'a BodyData, figure: &Figure, body: &'a PosedBody) -> HairBody<'a> {
    let eyes = body.eyeballs(data, figure).map(|ball| ball.translation.into());
    HairBody { data, positions: &body.positions, head: body.head(data), eyes }
}

/// Returns the meshes of a figure from those of one that differs from it in the gaze alone: the same bits as
/// [`build`] gives, sooner.
pub fn with_other_gaze(built: &FigureMeshes, figure: &Figure) -> FigureMeshes {
    let data = BodyData::shipped();
    let (eyes, colors) = both_eyes(PosedBody::new(data, figure).eyeballs(data, figure));
    let eyes = to_mesh(&eyes, &eyes.normals(), &colors, &[]);
    let turned = |mesh: &Mesh| {
        let mut mesh = mesh.clone();
        // The vertices of each part of the eyes are a block
        let starts = |mesh: &Mesh| mesh.parts.iter().map(|p| mesh.triangles[p.triangles.start as usize][0]).collect();
        let (own_starts, mesh_starts): (Vec<u32>, Vec<u32>) = (starts(&eyes), starts(&mesh));
        for (index, part) in eyes.parts.iter().enumerate() {
            let end = own_starts.get(index + 1).map_or(eyes.positions.len(), |start| *start as usize);
            let own = own_starts[index] as usize..end;
            let Some(place) = mesh.parts.iter().position(|p| p.name == part.name) else { continue };
            let first = mesh_starts[place] as usize;
            let block = first..first + own.len();
            if block.end <= mesh.positions.len() {
                mesh.positions[block.clone()].copy_from_slice(&eyes.positions[own.clone()]);
                mesh.normals[block.clone()].copy_from_slice(&eyes.normals[own.clone()]);
                mesh.colors[block].copy_from_slice(&eyes.colors[own]);
            }
        }
        Arc::new(mesh)
    };
    let (fine, coarse) = rayon::join(|| turned(&built.fine), || turned(&built.coarse));
    FigureMeshes { fine, coarse }
}

/// Returns the part of a garment.
fn garment_part(garment: Garment) -> u8 {
    match garment {
        Garment::Top => 5,
        Garment::Bottom => 6,
        Garment::Shoe => 7,
    }
}

/// Returns the quads of a pair of eyes, and the colours of their vertices.
fn both_eyes(eyeballs: [Affine3A; 2]) -> (QuadMesh, Vec<Vec3>) {
    let (mut mesh, mut colors) = (QuadMesh::default(), Vec::new());
    for eyeball in eyeballs {
        colors.extend(add_eye(&mut mesh, eyeball, |part| EYES + part as u8));
    }
    (mesh, colors)
}

/// Returns the quads of the tear lines of both eyes, and the colours of their vertices.
fn tear_lines(data: &BodyData, figure: &Figure, body: &PosedBody, skin: &QuadMesh) -> (QuadMesh, Vec<Vec3>) {
    let (mut mesh, mut colors) = (QuadMesh::default(), Vec::new());
    let eyeballs = body.eyeballs(data, &without_gaze(figure));
    for (eye, lashes) in eyeballs.into_iter().zip(Lashes::of_both_eyes(data, &body.positions)) {
        colors.extend(add_tear_line(&mut mesh, skin, eye, &lashes, EYES));
    }
    (mesh, colors)
}

/// Returns the quads of skin, teeth and tongue before subdivision.
fn cage(data: &BodyData, figure: &Figure, body: &PosedBody) -> QuadMesh {
    let (edges, clothes) = (Edges::shipped(), Clothes::new(figure));
    // Skin that a garment hides well is not there
    let covered =
        |v: u16| edges.top(v, clothes).max(edges.below_bottom(v, clothes.bottom)).max(edges.shoe(v)) > OVERLAP_M;
    let seen = |quad: &[u16; 4]| body.has(quad) && !quad.iter().all(|&v| covered(v));
    let skin = Patch::new(data, "body", &body.positions, &seen).cut(&|v| body.above_cut(v));
    let eyes = data.eyes_middle();
    let mut mesh = skin.into_mesh(SKIN, &|v| data.positions[usize::from(v)] - eyes);
    // Closed lips hide the teeth; the preview's shadows are too soft for the slit between them
    let Expression { mouth_open, teeth, .. } = figure.expression;
    for &(group, part) in INSIDE_MOUTH.iter().filter(|_| mouth_open > 0.0 || teeth > 0.0) {
        let patch = Patch::new(data, group, &body.positions, &|quad| body.has(quad));
        mesh.append(&patch.into_mesh(part, &|_| NO_SKIN));
    }
    mesh
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

/// Returns how much of the lips' colour the skin at each vertex has: 1 at their edge, 0 where it has faded out.
fn lip_strengths(data: &BodyData, mesh: &QuadMesh) -> Vec<f32> {
    let mut strengths = vec![0.0; mesh.positions.len()];
    let Some(lips) = data.masks.get("lips") else { return strengths };
    let (middle, radius) = MOUTH;
    let mut is_to_do: Vec<bool> =
        mesh.values.iter().map(|place| place.distance_squared(middle) < radius * radius).collect();
    is_to_do.resize(strengths.len(), false);
    for (quad, uvs) in mesh.quads.iter().zip(&mesh.uvs) {
        for (&vertex, uv) in quad.iter().zip(uvs) {
            if std::mem::take(&mut is_to_do[vertex as usize]) {
                // At the edge of the lips, half of the surroundings are lips
                strengths[vertex as usize] = (2.0 * lips.mean_around(*uv, LIP_FADE)).min(1.0);
            }
        }
    }
    strengths
}

/// Splits quads into triangles, by part, with a vertex for each position, texture coordinates and part: at the edge of
/// the lips, the skin alone is tinted. `lip_strengths` may be shorter than the positions: others have none.
fn to_mesh(quads: &QuadMesh, normals: &[Vec3], colors: &[Vec3], lip_strengths: &[f32]) -> Mesh {
    let (vertex_count, triangle_count) = (quads.positions.len() * 5 / 4, quads.quads.len() * 2);
    let mut mesh = Mesh {
        positions: Vec::with_capacity(vertex_count),
        normals: Vec::with_capacity(vertex_count),
        colors: Vec::with_capacity(vertex_count),
        uvs: Vec::with_capacity(vertex_count),
        triangles: Vec::with_capacity(triangle_count),
        ..Mesh::default()
    };
    // The vertices of each position form a list, the last one first
    const END: u32 = u32::MAX;
    let (mut first, mut next) = (vec![END; quads.positions.len()], Vec::with_capacity(vertex_count));
    let mut vertex_of = |mesh: &mut Mesh, (part, part_start): (usize, u32), position: u32, uv: Vec2| {
        let position = position as usize;
        let mut vertex = first[position];
        while vertex != END && vertex >= part_start && mesh.uvs[vertex as usize] != uv {
            vertex = next[vertex as usize];
        }
        if vertex == END || vertex < part_start {
            vertex = mesh.positions.len() as u32;
            next.push(std::mem::replace(&mut first[position], vertex));
            mesh.positions.push(quads.positions[position]);
            mesh.normals.push(normals[position]);
            let strength = lip_strengths.get(position).filter(|_| part == usize::from(SKIN)).copied().unwrap_or(0.0);
            mesh.colors.push(colors[position] * Vec3::ONE.lerp(Vec3::from(LIP_TINT), strength));
            mesh.uvs.push(uv);
        }
        vertex
    };
    for (part, name) in PARTS.into_iter().enumerate() {
        let start = mesh.triangles.len() as u32;
        let of_part = (part, mesh.positions.len() as u32);
        for index in (0..quads.quads.len()).filter(|&i| usize::from(quads.parts[i]) == part) {
            let [a, b, c, d] =
                std::array::from_fn(|k| vertex_of(&mut mesh, of_part, quads.quads[index][k], quads.uvs[index][k]));
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
        let end = mesh.triangles.len() as u32;
        if end > start {
            mesh.parts.push(MeshPart { name: name.to_owned(), triangles: start..end });
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::READY;

    #[test]
    fn an_expression_moves_the_face_and_neither_clothes_nor_hair_of_the_head() {
        let part = |mesh: &Mesh, name: &str| -> Vec<Vec3> {
            let Some(part) = mesh.parts.iter().find(|part| part.name == name) else { return Vec::new() };
            let triangles = &mesh.triangles[part.triangles.start as usize..part.triangles.end as usize];
            triangles.iter().flatten().map(|vertex| mesh.positions[*vertex as usize]).collect()
        };
        let hair = |meshes: &FigureMeshes, kept: &str| meshes.fine.strands.with_parts(|part| part == kept);
        for ready in [&READY[0], &READY[1]] {
            let figure = ready.figure();
            let mut laughing = figure;
            (laughing.expression.smile, laughing.expression.mouth_open) = (0.8, 0.4);
            let (before, after) = (build(&figure), build(&laughing));
            assert_eq!(hair(&before, "hair"), hair(&after, "hair"), "{}", ready.name);
            for clothing in ["top", "bottom", "shoes"] {
                let [before, after] = [&before, &after].map(|meshes| part(&meshes.fine, clothing));
                assert!(!before.is_empty() && before == after, "{}, {clothing}", ready.name);
            }
            assert_ne!(hair(&before, "brows"), hair(&after, "brows"), "{}", ready.name);
            assert_ne!(part(&before.fine, "lips"), part(&after.fine, "lips"), "{}", ready.name);
            // The same from kept hair and clothes, and after other figures have taken their room
            for other in &READY[2..4] {
                build(&other.figure());
            }
            assert_eq!(build(&laughing).fine, after.fine, "{}", ready.name);
        }
    }

    #[test]
    fn hair_has_its_roots_on_the_skin_of_a_laughing_face() {
        const DEPTH_M: f32 = 0.002;
        let mut figure = READY[0].figure();
        (figure.expression.smile, figure.expression.brows_up, figure.expression.mouth_open) = (1.0, 1.0, 1.0);
        let mesh = build(&figure).fine;
        let skin = &mesh.parts[0];
        assert_eq!(skin.name, "skin");
        let triangles = &mesh.triangles[skin.triangles.start as usize..skin.triangles.end as usize];
        let vertices: std::collections::BTreeSet<u32> = triangles.iter().flatten().copied().collect();
        for index in (0..mesh.strands.parts()[0].strands.end as usize).step_by(400) {
            let root = mesh.strands.strand(index)[0].position;
            let squared = |v: u32| mesh.positions[v as usize].distance_squared(root);
            let nearest = vertices.iter().copied().min_by(|a, b| squared(*a).total_cmp(&squared(*b))).unwrap() as usize;
            let height = (root - mesh.positions[nearest]).dot(mesh.normals[nearest]);
            assert!(height.abs() < DEPTH_M, "root {index} is {height} m over the skin");
        }
    }

    #[test]
    fn skin_has_the_colour_of_the_lips_at_their_edge_and_its_own_three_millimetres_from_it() {
        let mesh = build(&READY[0].figure()).fine;
        let vertices = |name: &str| {
            let part = mesh.parts.iter().find(|part| part.name == name).unwrap();
            let triangles = &mesh.triangles[part.triangles.start as usize..part.triangles.end as usize];
            let mut vertices: Vec<usize> = triangles.iter().flatten().map(|&v| v as usize).collect();
            vertices.sort_unstable();
            vertices.dedup();
            vertices
        };
        let (skin, lips) = (vertices("skin"), vertices("lips"));
        let middle = lips.iter().map(|&v| mesh.positions[v]).sum::<Vec3>() / lips.len() as f32;
        let near = skin.iter().filter(|&&v| mesh.positions[v].distance(middle) < 0.04);
        let to_lips = |v: usize| {
            let distance = |&lip: &usize| (mesh.positions[lip].distance(mesh.positions[v]), lip);
            lips.iter().map(distance).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
        };
        let (mut at_edge, mut beyond) = (Vec::new(), Vec::new());
        for &vertex in near {
            match to_lips(vertex) {
                (0.0, lip) => at_edge.push(mesh.colors[vertex] / mesh.colors[lip]),
                (0.003..0.007, lip) => beyond.push(mesh.colors[vertex] / mesh.colors[lip]),
                _ => (),
            }
        }
        let mean = |ratios: &[Vec3]| ratios.iter().sum::<Vec3>() / ratios.len() as f32;
        assert!(at_edge.len() > 50 && beyond.len() > 50, "{} {}", at_edge.len(), beyond.len());
        assert!(mean(&at_edge).distance(Vec3::from(LIP_TINT)) < 0.1, "{}", mean(&at_edge));
        assert!(mean(&beyond).distance(Vec3::ONE) < 0.1, "{}", mean(&beyond));
    }
}
