//! Strands on the GPU: an instance a segment, drawn as a ribbon that faces the camera or the light.
//!
//! A hair is a fraction of a pixel wide. Ribbons are at least a pixel wide, and of strands that are thinner only so many
//! are drawn that they cover the same area: the strands of a part are shuffled, and a fraction of them is a run from the
//! first one.

use crate::preview::gpu::pipeline::{BindGroupLayouts, pipeline_layout, reversed_depth};
use crate::preview::shaders;
use crate::preview::targets::{DEPTH_FORMAT, GBUFFER_FORMAT, ID_FORMAT};
use crate::scene::Strands;
use bytemuck::{Pod, Zeroable};
use eframe::wgpu::{self, util::DeviceExt as _};
use std::ops::Range;

/// How the strands of a part are drawn into shadow maps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StrandShadows {
    /// Some of many strands, in place of all: hair.
    Dense,
    /// All: brows, lashes and stubble. Some wide ones would leave no light on an eye under its lashes.
    Sparse,
}

impl StrandShadows {
    /// Returns the fraction of the strands that is drawn, and the factor on their width.
    ///
    /// That of dense ones is more than one over the fraction, since a mesh for the live view has strands with less area
    /// than those that they stand for: fitted to the tracer's pictures of heads of hair and of shipped portraits. With 12,
    /// rims of light from behind are a quarter of a stop brighter.
    pub fn fraction_and_width(self) -> (f32, f32) {
        match self {
            StrandShadows::Dense => (0.125, 15.0),
            StrandShadows::Sparse => (1.0, 1.0),
        }
    }
}

/// A control point; twin of the vertex input in `strands.wgsl`. The radius of the last point of a strand is negative.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
struct Point {
    position: [f32; 3],
    radius: f32,
}

/// Returns the layout of the points at a location.
const fn points_at(attributes: &'static [wgpu::VertexAttribute]) -> Option<wgpu::VertexBufferLayout<'static>> {
    let step_mode = wgpu::VertexStepMode::Instance;
    Some(wgpu::VertexBufferLayout { array_stride: size_of::<Point>() as u64, step_mode, attributes })
}

/// A segment reads the points before, at its start, at its end, and after it: four views of one buffer.
const POINT_LAYOUTS: [Option<wgpu::VertexBufferLayout<'static>>; 4] = [
    points_at(&wgpu::vertex_attr_array![0 => Float32x4]),
    points_at(&wgpu::vertex_attr_array![1 => Float32x4]),
    points_at(&wgpu::vertex_attr_array![2 => Float32x4]),
    points_at(&wgpu::vertex_attr_array![3 => Float32x4]),
];

/// The strands of a mesh on the GPU.
#[derive(Debug)]
pub(crate) struct GpuStrands {
    points: wgpu::Buffer,
    pub parts: Vec<GpuStrandPart>,
}

/// A part of the strands of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct GpuStrandPart {
    pub name: String,
    pub instances: Range<u32>,
    pub mean_radius_m: f32,
    /// Mean length of a strand, metres.
    pub mean_length_m: f32,
}

impl GpuStrands {
    /// Uploads strands; none without any, or if they do not fit into a buffer.
    pub fn upload(device: &wgpu::Device, strands: &Strands) -> Option<Self> {
        let bytes = (strands.points().len() + 3) * size_of::<Point>();
        if strands.is_empty() || bytes > device.limits().max_buffer_size as usize {
            return None;
        }
        let (points, parts) = shuffled(strands);
        let points = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("strands"),
            contents: bytemuck::cast_slice(&points),
            usage: wgpu::BufferUsages::VERTEX,
        });
        Some(GpuStrands { points, parts })
    }

    /// Draws a run of instances.
    pub fn draw(&self, pass: &mut wgpu::RenderPass, instances: Range<u32>) {
        for slot in 0..POINT_LAYOUTS.len() as u32 {
            pass.set_vertex_buffer(slot, self.points.slice(u64::from(slot) * size_of::<Point>() as u64..));
        }
        pass.draw(0..4, instances);
    }
}

/// Returns the points of all strands, those of each part in a shuffled order, and the parts.
fn shuffled(strands: &Strands) -> (Vec<Point>, Vec<GpuStrandPart>) {
    let none = Point { position: [0.0; 3], radius: -1.0 };
    // The first segment reads a point before it.
    let mut points = vec![none];
    let mut parts = Vec::new();
    for part in strands.parts() {
        let (start, mut length_m) = (points.len(), 0.0);
        let mut order: Vec<u32> = part.strands.clone().collect();
        order.sort_by_key(|&strand| strand.wrapping_mul(0x9e37_79b9).rotate_left(15).wrapping_mul(0x85eb_ca6b));
        for strand in order {
            let own = strands.strand(strand as usize);
            length_m += own.windows(2).map(|ends| ends[0].position.distance(ends[1].position)).sum::<f32>();
            points.extend(own.iter().map(|p| Point { position: p.position.into(), radius: p.radius_m }));
            if let Some(last) = points.last_mut() {
                last.radius = -last.radius;
            }
        }
        let mean_radius_m =
            points[start..].iter().map(|p| p.radius.abs()).sum::<f32>() / (points.len() - start).max(1) as f32;
        // An instance starts at the point before its segment
        let instances = start as u32 - 1..points.len() as u32 - 1;
        let mean_length_m = length_m / part.strands.len().max(1) as f32;
        parts.push(GpuStrandPart { name: part.name.clone(), instances, mean_radius_m, mean_length_m });
    }
    points.extend([none; 3]);
    (points, parts)
}

/// The pipelines of strands: into the G-buffer and into shadow maps.
#[derive(Debug)]
pub(crate) struct StrandPipelines {
    pub geometry: wgpu::RenderPipeline,
    dense_shadows: wgpu::RenderPipeline,
    sparse_shadows: wgpu::RenderPipeline,
}

impl StrandPipelines {
    pub fn new(device: &wgpu::Device, layouts: &BindGroupLayouts, shadow_format: wgpu::TextureFormat) -> Self {
        let pipeline = |label, source, constants: &[(&str, f64)], groups: &[_], targets: Option<&[_]>, format| {
            let module = shaders::module(device, label, source);
            let layout = pipeline_layout(device, label, groups);
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(label),
                layout: Some(&layout),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some("vertex"),
                    compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
                    buffers: &POINT_LAYOUTS,
                },
                primitive: wgpu::PrimitiveState {
                    topology: wgpu::PrimitiveTopology::TriangleStrip,
                    ..Default::default()
                },
                depth_stencil: Some(reversed_depth(format)),
                multisample: Default::default(),
                fragment: targets.map(|targets| wgpu::FragmentState {
                    module: &module,
                    entry_point: Some("fragment"),
                    compilation_options: Default::default(),
                    targets,
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        let gbuffer = [Some(GBUFFER_FORMAT.into()), Some(ID_FORMAT.into())];
        let (camera, light) = ([&layouts.scene, &layouts.draw], [&layouts.scene, &layouts.draw, &layouts.shadow_view]);
        let shadows = |of: StrandShadows| {
            let (_, width) = of.fraction_and_width();
            let constants = [("SHADOW_WIDTH", width.into())];
            pipeline("strand shadows", shaders::SHADOW_STRANDS, &constants, &light, None, shadow_format)
        };
        StrandPipelines {
            geometry: pipeline("strands", shaders::STRANDS, &[], &camera, Some(&gbuffer), DEPTH_FORMAT),
            dense_shadows: shadows(StrandShadows::Dense),
            sparse_shadows: shadows(StrandShadows::Sparse),
        }
    }

    /// Returns the pipeline that draws a part into shadow maps.
    pub fn shadow_map(&self, shadows: StrandShadows) -> &wgpu::RenderPipeline {
        match shadows {
            StrandShadows::Dense => &self.dense_shadows,
            StrandShadows::Sparse => &self.sparse_shadows,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::StrandPoint;
    use glam::Vec3;

    #[test]
    fn a_run_of_instances_has_strands_from_all_over_the_part() {
        let mut strands = Strands::default();
        for x in 0..1000 {
            strands.push((0..5).map(|y| StrandPoint { position: Vec3::new(x as f32, y as f32, 0.0), radius_m: 4e-5 }));
        }
        strands.end_part("hair");
        let (points, parts) = shuffled(&strands);
        assert_eq!((points.len(), parts[0].instances.clone()), (5004, 0..5000));
        let ends = points.iter().filter(|p| p.radius < 0.0).count();
        assert_eq!(ends, 1000 + 4, "the last points of strands, and four beyond all");
        let mean = points[1..501].iter().map(|p| p.position[0]).sum::<f32>() / 500.0;
        assert!((mean - 500.0).abs() < 120.0, "a hundred strands from one side alone: {mean}");
    }
}
