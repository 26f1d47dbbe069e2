//! Pipelines of the lighting passes. Constructors of pipelines are tables; they run long for that reason.

use crate::preview::channel::{Channel, Gloss};
use crate::preview::geometry::draw_item::Sides;
use crate::preview::geometry::pipelines::mesh_vertices;
use crate::preview::gpu::pipeline::{BindGroupLayouts, fullscreen, pipeline_layout, reversed_depth};
use crate::preview::shaders;
use crate::preview::targets::{COARSE_FORMAT, DEPTH_FORMAT, ID_FORMAT, Output};
use eframe::wgpu;

/// The specialisation of a lighting pipeline. CPU rasterisers pay for shader code that no light uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct LightingVariant {
    pub output: Output,
    /// True for the kinds of lights that are present: points and suns, spheres, rectangles, discs.
    pub light_kinds: [bool; 4],
    /// Layers of the shadow mask, four lights each.
    pub masks: usize,
    /// Picture pixels per mask pixel along each axis.
    pub mask_scale: u32,
    /// Skips lights beyond their radius, where they fall under 1/256 of display white.
    pub light_radius: bool,
    /// Reads a list of lights per tile.
    pub tiled: bool,
    /// A modifier narrows the beam of at least one light.
    pub has_beams: bool,
    /// Shades one pixel of each coarse pixel, for a draft or for the diffusion pass.
    pub coarse: bool,
    /// Writes the illuminance in false colour.
    pub illuminance: bool,
    pub gloss: Gloss,
    /// Strands are present.
    pub has_fibres: bool,
    /// Surfaces with lacquer or translucency are present.
    pub has_layers: bool,
    /// Surfaces with normal maps are present.
    pub has_relief: bool,
}

/// Returns a WGSL flag: 1 or 0.
fn flag(set: bool) -> f64 {
    f64::from(u8::from(set))
}

/// Returns the constants that the lighting and glass shaders share: the output encoding and the kinds of lights.
fn light_constants(variant: &LightingVariant) -> [(&'static str, f64); 5] {
    let [delta, spheres, rects, discs] = variant.light_kinds.map(flag);
    [
        ("LINEAR", flag(variant.output == Output::Linear)),
        ("HAS_DELTA", delta),
        ("HAS_SPHERES", spheres),
        ("HAS_RECTS", rects),
        ("HAS_DISCS", discs),
    ]
}

/// Creates the pipeline of the lighting pass.
pub(crate) fn lighting(
    device: &wgpu::Device,
    layouts: &BindGroupLayouts,
    variant: &LightingVariant,
) -> wgpu::RenderPipeline {
    let [linear, delta, spheres, rects, discs] = light_constants(variant);
    let constants = [
        linear,
        delta,
        spheres,
        rects,
        discs,
        ("MASKS", variant.masks as f64),
        ("MASK_SCALE", f64::from(variant.mask_scale)),
        ("LIGHT_CULLING", flag(variant.light_radius)),
        ("TILED", flag(variant.tiled)),
        ("HAS_BEAMS", flag(variant.has_beams)),
        ("ILLUMINANCE", flag(variant.illuminance)),
        ("HAS_FIBRES", flag(variant.has_fibres && !variant.illuminance)),
        ("HAS_LAYERS", flag(variant.has_layers && !variant.illuminance)),
        ("HAS_RELIEF", flag(variant.has_relief)),
        ("BLINN_PHONG", flag(variant.gloss == Gloss::BlinnPhong)),
    ];
    let layout = pipeline_layout(device, "lighting", &[&layouts.scene, &layouts.gbuffer, &layouts.masks]);
    let (entry, format) =
        if variant.coarse { ("coarse_fragment", COARSE_FORMAT) } else { ("fragment", variant.output.format()) };
    fullscreen(device, ("lighting", entry), shaders::LIGHTING, &layout, &constants, format)
}

/// Creates the pipeline that upsamples coarse lighting to the display picture.
pub(crate) fn resolve(device: &wgpu::Device, layouts: &BindGroupLayouts, illuminance: bool) -> wgpu::RenderPipeline {
    let layout = pipeline_layout(device, "resolve", &[&layouts.scene, &layouts.gbuffer, &layouts.coarse]);
    let constants = [("ILLUMINANCE", flag(illuminance))];
    fullscreen(device, ("resolve", "fragment"), shaders::RESOLVE, &layout, &constants, Output::Display.format())
}

/// Creates the pipeline that spreads light under soft surfaces.
pub(crate) fn diffusion(device: &wgpu::Device, layouts: &BindGroupLayouts, output: Output) -> wgpu::RenderPipeline {
    let layout = pipeline_layout(device, "diffusion", &[&layouts.scene, &layouts.gbuffer, &layouts.coarse]);
    let constants = [("LINEAR", flag(output == Output::Linear))];
    fullscreen(device, ("diffusion", "fragment"), shaders::DIFFUSION, &layout, &constants, output.format())
}

/// Creates the pipeline that shows one channel of the G-buffer.
pub(crate) fn channel(
    device: &wgpu::Device,
    layouts: &BindGroupLayouts,
    channel: Channel,
    output: Output,
) -> wgpu::RenderPipeline {
    let layout = pipeline_layout(device, "channel", &[&layouts.scene, &layouts.gbuffer]);
    let constants = [("CHANNEL", f64::from(channel.number())), ("LINEAR", flag(output == Output::Linear))];
    fullscreen(device, ("channel", "fragment"), shaders::CHANNEL, &layout, &constants, output.format())
}

/// Creates the pipeline that draws these sides of glass over the lit picture; `inner` sides are seen through others.
pub(crate) fn glass(
    device: &wgpu::Device,
    layouts: &BindGroupLayouts,
    variant: &LightingVariant,
    (sides, inner): (Sides, bool),
) -> wgpu::RenderPipeline {
    let [linear, delta, spheres, rects, discs] = light_constants(variant);
    let constants = [linear, delta, spheres, rects, discs, ("INNER", flag(inner))];
    let module = shaders::module(device, "glass", shaders::GLASS);
    let layout = pipeline_layout(device, "glass", &[&layouts.scene, &layouts.draw]);
    let color = wgpu::ColorTargetState {
        blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
        ..variant.output.format().into()
    };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("glass"),
        layout: Some(&layout),
        vertex: mesh_vertices(&module),
        primitive: wgpu::PrimitiveState { cull_mode: sides.cull_mode(), ..Default::default() },
        depth_stencil: Some(reversed_depth(DEPTH_FORMAT)),
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
