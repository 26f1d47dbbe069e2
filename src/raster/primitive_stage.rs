//! The primitive stage: clips triangles, sets them up for the screen and bins them into tiles.

use super::binning::TriangleBatch;
use super::clip::{self, ClipTest};
use super::geometry::{Chunk, MeshInstance, SceneGeometry};
use super::triangle::{ScreenTriangle, TriangleId};
use super::vertex_stage::{ChunkVertices, VertexBuffer};
use super::viewport::Viewport;
use rayon::prelude::*;

/// Sets up and bins the triangles of a chunk's batches, in parallel.
pub(super) fn set_up(
    geometry: &SceneGeometry,
    chunk: &Chunk,
    vertices: &ChunkVertices,
    viewport: Viewport,
    batches: &mut Vec<TriangleBatch>,
) {
    batches.resize_with(chunk.batches.len(), TriangleBatch::default);
    batches.par_iter_mut().zip(&geometry.batches[chunk.batches.clone()]).enumerate().for_each(
        |(index, (batch, range))| {
            let instance = geometry.surfaces[range.surface as usize].instance as usize;
            batch.fill(index, viewport, |out| {
                for triangle in range.triangles.clone() {
                    let id = TriangleId { surface: range.surface, triangle: triangle as u32 };
                    set_up_triangle(vertices.of(instance), &geometry.instances[instance], id, viewport, out);
                }
            });
        },
    );
}

/// Appends the visible part of a triangle: the triangle itself, or a fan of clipped pieces.
fn set_up_triangle(
    vertices: &VertexBuffer,
    instance: &MeshInstance,
    id: TriangleId,
    viewport: Viewport,
    out: &mut Vec<ScreenTriangle>,
) {
    let corners = instance.mesh.triangles[id.triangle as usize];
    let [Some(a), Some(b), Some(c)] = corners.map(|i| vertices.positions.get(i as usize)) else { return };
    match clip::clip_test([a.outcode, b.outcode, c.outcode]) {
        ClipTest::Outside => {}
        ClipTest::Inside => {
            out.extend(ScreenTriangle::new([a.screen, b.screen, c.screen], instance.state, id, None));
        }
        ClipTest::Straddles => {
            let polygon = clip::clip_triangle([a.clip, b.clip, c.clip]);
            for pair in polygon.vertices().windows(2).skip(1) {
                let fan = [polygon.vertices()[0], pair[0], pair[1]];
                let screen = fan.map(|vertex| viewport.screen_from_clip(vertex.clip));
                let barycentric = fan.map(|vertex| vertex.barycentric);
                out.extend(ScreenTriangle::new(screen, instance.state, id, Some(barycentric)));
            }
        }
    }
}
