//! The fixed list of pipelines. Constructors of pipelines are tables; they run long for that reason.

use super::channel::{Channel, Gloss};
use super::geometry::draw_list::Shadow;
use super::geometry::mesh_cache::VERTEX_LAYOUT;
use super::overlay::gizmo::{GpuLine, GpuTint};
use super::shaders;
use super::shadows::maps::{self as shadow_maps, Side};
use super::shadows::mask as shadow_mask;
use super::targets::{CELL_FORMAT, DEPTH_FORMAT, GBUFFER_FORMAT, ID_FORMAT, Output};
use eframe::wgpu;

/// Factor of the room's depth, near over distance: paper laid on its floor lies on top. Not a depth bias, whose unit is
/// that of a triangle's nearest corner: a floor that runs under the camera would sink by decimetres.
const BEHIND_COPLANAR: f64 = 1.0 - 1e-4;

/// Layouts of the bind groups that the pipelines take.
pub(super) struct Layouts<'a> {
    pub scene: &'a wgpu::BindGroupLayout,
    pub texture: &'a wgpu::BindGroupLayout,
    pub draw: &'a wgpu::BindGroupLayout,
    pub gbuffer: &'a wgpu::BindGroupLayout,
    pub shadow_view: &'a wgpu::BindGroupLayout,
    pub shadow_maps: &'a wgpu::BindGroupLayout,
    pub shadow_slots: &'a wgpu::BindGroupLayout,
    pub raw_mask: &'a wgpu::BindGroupLayout,
    pub masks: &'a wgpu::BindGroupLayout,
    pub cells: &'a wgpu::BindGroupLayout,
}

/// Pipelines that do not depend on the output's format.
#[derive(Debug)]
pub(super) struct GeometryPipelines {
    /// By whether textured, then by `Sides`.
    geometry: [[wgpu::RenderPipeline; 4]; 2],
    /// Of sheets, solids, mirrored solids.
    shadow: [wgpu::RenderPipeline; 3],
}

/// Which sides of a run of triangles are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Sides {
    /// Both: sheets, and solids with the camera inside.
    Both = 0,
    /// The front, as of a room that is seen into from outside.
    Room = 1,
    /// The front, as of a solid: its far side is hidden anyway.
    Front = 2,
    /// The back, as of a solid that is mirrored by its scale.
    Back = 3,
}

impl Sides {
    const ALL: [Sides; 4] = [Sides::Both, Sides::Room, Sides::Front, Sides::Back];

    fn culled(self) -> Option<wgpu::Face> {
        match self {
            Sides::Both => None,
            Sides::Room | Sides::Front => Some(wgpu::Face::Back),
            Sides::Back => Some(wgpu::Face::Front),
        }
    }
}

/// Pipelines of the shadow masks.
#[derive(Debug)]
pub(super) struct MaskPipelines {
    /// By whether lights are taken in parts.
    pub raw: [wgpu::RenderPipeline; 2],
    pub blur: wgpu::RenderPipeline,
}

/// What the lighting pass is compiled for: rasterisers on a processor pay for code that is not used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct LightingVariant {
    pub output: Output,
    /// Whether there are points or suns, balls, rectangles, discs.
    pub families: [bool; 4],
    pub masks: usize,
    pub scale: u32,
    /// Lights are left out where they fall under 1/256 of display white.
    pub reach: bool,
    /// Each tile of the picture has its own list of lights.
    pub listed: bool,
    /// A light's modifier narrows its beam.
    pub beams: bool,
    /// One pixel of each cell, for a draft.
    pub cells: bool,
    /// The light on surfaces, in false colour.
    pub illuminance: bool,
    pub gloss: Gloss,
}

impl GeometryPipelines {
    pub fn new(device: &wgpu::Device, layouts: &Layouts) -> Self {
        let module = shaders::module(device, "geometry", shaders::GEOMETRY);
        let layout = pipeline_layout(device, "geometry", &[layouts.scene, layouts.draw, layouts.texture]);
        let geometry = |textured: bool, sides: Sides| {
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("geometry"),
                layout: Some(&layout),
                vertex: wgpu::VertexState {
                    compilation_options: wgpu::PipelineCompilationOptions {
                        constants: &[("DEPTH_FACTOR", if sides == Sides::Room { BEHIND_COPLANAR } else { 1.0 })],
                        ..Default::default()
                    },
                    ..mesh_vertices(&module)
                },
                primitive: wgpu::PrimitiveState { cull_mode: sides.culled(), ..Default::default() },
                depth_stencil: Some(nearer(DEPTH_FORMAT)),
                multisample: Default::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some("fragment"),
                    compilation_options: wgpu::PipelineCompilationOptions {
                        constants: &[("TEXTURED", f64::from(u8::from(textured)))],
                        ..Default::default()
                    },
                    targets: &[Some(GBUFFER_FORMAT.into()), Some(ID_FORMAT.into())],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        let shadow_module = shaders::module(device, "shadow map", shaders::SHADOW_MAP);
        let shadow_layout = pipeline_layout(device, "shadow map", &[layouts.scene, layouts.draw, layouts.shadow_view]);
        let shadow = |cull_mode| {
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("shadow map"),
                layout: Some(&shadow_layout),
                vertex: mesh_vertices(&shadow_module),
                primitive: wgpu::PrimitiveState { cull_mode, ..Default::default() },
                depth_stencil: Some(nearer(shadow_maps::FORMAT)),
                multisample: Default::default(),
                fragment: None,
                multiview_mask: None,
                cache: None,
            })
        };
        GeometryPipelines {
            geometry: [false, true].map(|textured| Sides::ALL.map(|sides| geometry(textured, sides))),
            shadow: [shadow(None), shadow(Some(wgpu::Face::Front)), shadow(Some(wgpu::Face::Back))],
        }
    }

    /// The pipeline that draws a run of triangles into the G-buffer.
    pub fn geometry(&self, textured: bool, sides: Sides) -> &wgpu::RenderPipeline {
        &self.geometry[usize::from(textured)][sides as usize]
    }

    /// The pipeline that draws a run of triangles into a shadow map; none if it casts no shadow.
    pub fn shadow(&self, shadow: Shadow, side: Side) -> Option<&wgpu::RenderPipeline> {
        match (shadow, side) {
            (Shadow::Nothing, _) => None,
            (Shadow::Sheet, _) | (_, Side::Near) => Some(&self.shadow[0]),
            (Shadow::Solid, Side::Far) => Some(&self.shadow[1]),
            (Shadow::MirroredSolid, Side::Far) => Some(&self.shadow[2]),
        }
    }
}

impl MaskPipelines {
    pub fn new(device: &wgpu::Device, layouts: &Layouts) -> Self {
        let raw_groups = [layouts.scene, layouts.gbuffer, layouts.shadow_maps, layouts.shadow_slots];
        let blur_groups = [layouts.scene, layouts.gbuffer, layouts.raw_mask];
        let fullscreen = |label, source, groups: &[_], constants: &[_]| {
            let layout = pipeline_layout(device, label, groups);
            fullscreen(device, (label, "fragment"), source, &layout, constants, shadow_mask::FORMAT)
        };
        let raw = |in_parts| fullscreen("shadow mask", shaders::SHADOW_MASK, &raw_groups, &[("IN_PARTS", in_parts)]);
        MaskPipelines {
            raw: [raw(0.0), raw(1.0)],
            blur: fullscreen("shadow blur", shaders::SHADOW_BLUR, &blur_groups, &[]),
        }
    }
}

/// The lighting pass.
pub(super) fn lighting(device: &wgpu::Device, layouts: &Layouts, variant: &LightingVariant) -> wgpu::RenderPipeline {
    let flag = |set: bool| f64::from(u8::from(set));
    let [delta, spheres, rects, discs] = variant.families.map(flag);
    let constants = [
        ("LINEAR", flag(variant.output == Output::Linear)),
        ("HAS_DELTA", delta),
        ("HAS_SPHERES", spheres),
        ("HAS_RECTS", rects),
        ("HAS_DISCS", discs),
        ("MASKS", variant.masks as f64),
        ("SCALE", f64::from(variant.scale)),
        ("REACH", flag(variant.reach)),
        ("LISTED", flag(variant.listed)),
        ("HAS_BEAMS", flag(variant.beams)),
        ("ILLUMINANCE", flag(variant.illuminance)),
        ("BLINN_PHONG", flag(variant.gloss == Gloss::BlinnPhong)),
    ];
    let layout = pipeline_layout(device, "lighting", &[layouts.scene, layouts.gbuffer, layouts.masks]);
    let (entry, format) = if variant.cells { ("cell", CELL_FORMAT) } else { ("fragment", variant.output.format()) };
    fullscreen(device, ("lighting", entry), shaders::LIGHTING, &layout, &constants, format)
}

/// Light of one pixel of each cell, spread over the picture as it is shown.
pub(super) fn resolve(device: &wgpu::Device, layouts: &Layouts, illuminance: bool) -> wgpu::RenderPipeline {
    let layout = pipeline_layout(device, "resolve", &[layouts.scene, layouts.gbuffer, layouts.cells]);
    let constants = [("ILLUMINANCE", f64::from(u8::from(illuminance)))];
    fullscreen(device, ("resolve", "fragment"), shaders::RESOLVE, &layout, &constants, Output::Display.format())
}

/// One channel of the G-buffer.
pub(super) fn channel(
    device: &wgpu::Device,
    layouts: &Layouts,
    channel: Channel,
    output: Output,
) -> wgpu::RenderPipeline {
    let layout = pipeline_layout(device, "channel", &[layouts.scene, layouts.gbuffer]);
    let constants =
        [("CHANNEL", f64::from(channel.number())), ("LINEAR", f64::from(u8::from(output == Output::Linear)))];
    fullscreen(device, ("channel", "fragment"), shaders::CHANNEL, &layout, &constants, output.format())
}

/// Glass over the lit picture.
pub(super) fn glass(
    device: &wgpu::Device,
    layouts: &Layouts,
    variant: &LightingVariant,
    (sides, inner): (Sides, bool),
) -> wgpu::RenderPipeline {
    let flag = |set: bool| f64::from(u8::from(set));
    let [delta, spheres, rects, discs] = variant.families.map(flag);
    let constants = [
        ("LINEAR", flag(variant.output == Output::Linear)),
        ("HAS_DELTA", delta),
        ("HAS_SPHERES", spheres),
        ("HAS_RECTS", rects),
        ("HAS_DISCS", discs),
        ("INNER", flag(inner)),
    ];
    let module = shaders::module(device, "glass", shaders::GLASS);
    let layout = pipeline_layout(device, "glass", &[layouts.scene, layouts.draw]);
    let color = wgpu::ColorTargetState {
        blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
        ..variant.output.format().into()
    };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("glass"),
        layout: Some(&layout),
        vertex: mesh_vertices(&module),
        primitive: wgpu::PrimitiveState { cull_mode: sides.culled(), ..Default::default() },
        depth_stencil: Some(nearer(DEPTH_FORMAT)),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() },
            targets: &[Some(color), Some(ID_FORMAT.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// Lines, tints and the outline, blended over the picture as it is shown.
#[derive(Debug)]
pub(super) struct OverlayPipelines {
    pub lines: wgpu::RenderPipeline,
    pub tints: wgpu::RenderPipeline,
    pub outline: wgpu::RenderPipeline,
}

impl OverlayPipelines {
    pub fn new(device: &wgpu::Device, layouts: &Layouts) -> Self {
        let layout = pipeline_layout(device, "overlay", &[layouts.scene, layouts.gbuffer]);
        let overlay = shaders::module(device, "overlay", shaders::OVERLAY);
        let outline = shaders::module(device, "outline", shaders::OUTLINE);
        let pipeline = |module: &wgpu::ShaderModule, entry_point, buffers: &[_]| {
            let color = wgpu::ColorTargetState {
                blend: Some(wgpu::BlendState::ALPHA_BLENDING),
                ..Output::Display.format().into()
            };
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("overlay"),
                layout: Some(&layout),
                vertex: wgpu::VertexState {
                    module,
                    entry_point: Some(entry_point),
                    compilation_options: Default::default(),
                    buffers,
                },
                primitive: Default::default(),
                depth_stencil: None,
                multisample: Default::default(),
                fragment: Some(wgpu::FragmentState {
                    module,
                    entry_point: Some("fragment"),
                    compilation_options: Default::default(),
                    targets: &[Some(color)],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        let line = wgpu::VertexBufferLayout {
            array_stride: size_of::<GpuLine>() as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x4, 2 => Float32x4],
        };
        let tint = wgpu::VertexBufferLayout {
            array_stride: size_of::<GpuTint>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x4],
        };
        OverlayPipelines {
            lines: pipeline(&overlay, "line_vertex", &[Some(line)]),
            tints: pipeline(&overlay, "tint_vertex", &[Some(tint)]),
            outline: pipeline(&outline, "vertex", &[]),
        }
    }
}

fn fullscreen(
    device: &wgpu::Device,
    (label, entry): (&str, &str),
    source: &str,
    layout: &wgpu::PipelineLayout,
    constants: &[(&str, f64)],
    format: wgpu::TextureFormat,
) -> wgpu::RenderPipeline {
    let module = shaders::module(device, label, source);
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(label),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some(entry),
            compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
            targets: &[Some(format.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn pipeline_layout(device: &wgpu::Device, label: &str, groups: &[&wgpu::BindGroupLayout]) -> wgpu::PipelineLayout {
    let groups: Vec<_> = groups.iter().map(|group| Some(*group)).collect();
    device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(label),
        bind_group_layouts: &groups,
        ..Default::default()
    })
}

fn mesh_vertices(module: &wgpu::ShaderModule) -> wgpu::VertexState<'_> {
    wgpu::VertexState {
        module,
        entry_point: Some("vertex"),
        compilation_options: Default::default(),
        buffers: &[Some(VERTEX_LAYOUT)],
    }
}

/// Reversed depth: greater is nearer.
fn nearer(format: wgpu::TextureFormat) -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format,
        depth_write_enabled: Some(true),
        depth_compare: Some(wgpu::CompareFunction::Greater),
        stencil: Default::default(),
        bias: Default::default(),
    }
}
