//! WGSL sources of the passes. WGSL has no includes: each module is a concatenation of files.

use eframe::wgpu;

/// The geometry pass.
pub(crate) const GEOMETRY: &str = concat!(
    "const TEXTURE_GROUP: u32 = 2;\n",
    include_str!("scene.wgsl"),
    include_str!("draw.wgsl"),
    include_str!("textures.wgsl"),
    include_str!("geometry.wgsl")
);
/// The geometry pass of strands.
pub(crate) const STRANDS: &str =
    concat!(include_str!("scene.wgsl"), include_str!("draw.wgsl"), include_str!("strands.wgsl"));
/// The shadow map pass of strands.
pub(crate) const SHADOW_STRANDS: &str =
    concat!(include_str!("scene.wgsl"), include_str!("draw.wgsl"), include_str!("shadow_strands.wgsl"));
/// The shadow map pass.
pub(crate) const SHADOW_MAP: &str =
    concat!(include_str!("scene.wgsl"), include_str!("draw.wgsl"), include_str!("shadow_map.wgsl"));
/// The shadow map pass of masked and blended surfaces.
pub(crate) const SHADOW_HOLES: &str = concat!(
    "const TEXTURE_GROUP: u32 = 3;\n",
    include_str!("scene.wgsl"),
    include_str!("draw.wgsl"),
    include_str!("textures.wgsl"),
    include_str!("shadow_holes.wgsl")
);
/// The shadow mask pass.
pub(crate) const SHADOW_MASK: &str = concat!(include_str!("scene.wgsl"), include_str!("shadow_mask.wgsl"));
/// The blur pass of the shadow masks.
pub(crate) const SHADOW_BLUR: &str = concat!(include_str!("scene.wgsl"), include_str!("shadow_blur.wgsl"));
/// The lighting pass.
pub(crate) const LIGHTING: &str = concat!(
    include_str!("scene.wgsl"),
    include_str!("light.wgsl"),
    include_str!("brdf.wgsl"),
    include_str!("fibre.wgsl"),
    include_str!("tone.wgsl"),
    include_str!("false_color.wgsl"),
    include_str!("lighting.wgsl")
);
/// The resolve pass, which upsamples coarse lighting.
pub(crate) const RESOLVE: &str = concat!(
    include_str!("scene.wgsl"),
    include_str!("tone.wgsl"),
    include_str!("false_color.wgsl"),
    include_str!("resolve.wgsl")
);
/// The diffusion pass, which spreads light under soft surfaces.
pub(crate) const DIFFUSION: &str =
    concat!(include_str!("scene.wgsl"), include_str!("tone.wgsl"), include_str!("diffusion.wgsl"));
/// The channel pass.
pub(crate) const CHANNEL: &str =
    concat!(include_str!("scene.wgsl"), include_str!("tone.wgsl"), include_str!("channel.wgsl"));
/// The glass pass.
pub(crate) const GLASS: &str = concat!(
    include_str!("scene.wgsl"),
    include_str!("light.wgsl"),
    include_str!("brdf.wgsl"),
    include_str!("tone.wgsl"),
    include_str!("draw.wgsl"),
    include_str!("glass.wgsl")
);
/// The passes of still pictures.
pub(crate) const STILL: &str = concat!(include_str!("tone.wgsl"), include_str!("still.wgsl"));
/// The overlay pass: lines and tints.
pub(crate) const OVERLAY: &str = concat!(include_str!("scene.wgsl"), include_str!("overlay.wgsl"));
/// The overlay pass: selection outline.
pub(crate) const OUTLINE: &str = concat!(include_str!("scene.wgsl"), include_str!("outline.wgsl"));

/// Creates a shader module.
pub(crate) fn module(device: &wgpu::Device, label: &str, source: &str) -> wgpu::ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use wgpu::naga;

    #[test]
    fn every_module_is_valid_wgsl() {
        let modules = [
            ("geometry", GEOMETRY),
            ("strands", STRANDS),
            ("strand shadows", SHADOW_STRANDS),
            ("shadow map", SHADOW_MAP),
            ("shadows with holes", SHADOW_HOLES),
            ("shadow mask", SHADOW_MASK),
            ("shadow blur", SHADOW_BLUR),
            ("still picture", STILL),
            ("lighting", LIGHTING),
            ("resolve", RESOLVE),
            ("diffusion", DIFFUSION),
            ("channel", CHANNEL),
            ("glass", GLASS),
            ("overlay", OVERLAY),
            ("outline", OUTLINE),
        ];
        for (name, source) in modules {
            let module = naga::front::wgsl::parse_str(source)
                .unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(source)));
            naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::default())
                .validate(&module)
                .unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(source)));
        }
    }
}
