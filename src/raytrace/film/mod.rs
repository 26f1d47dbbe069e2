//! Where samples are gathered: one layer a light, so that lights can be dimmed and coloured after the render.

use crate::color;
use crate::photo::Picture;
use crate::photo::exposure::{self, Strength};
use crate::raytrace::lights::TracedLight;
use crate::raytrace::render::Method;
use crate::scene::{Light, LightId, Scene};
use glam::Vec3;

/// Edge of a tile, pixels. The film is kept tile by tile, so that threads write without locks.
pub const TILE: u32 = 32;

/// Lights up to this number have a layer each; above, lights of one role share one.
pub const MAX_LIGHT_LAYERS: usize = 16;

/// What a film layer holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// The light's name, the role of a group, or `Glow` for emissive surfaces.
    pub name: String,
    /// The light, where the layer holds just one.
    pub light: Option<LightId>,
    /// Output that was traced, to scale by when the light is changed later.
    traced: Option<Strength>,
    /// Whether colours and times are already in (shared layers).
    finished: bool,
}

impl Layer {
    /// The layer of one light.
    pub fn of_light(light: &Light) -> Self {
        Layer {
            name: light.name.clone(),
            light: Some(light.id),
            traced: Some(exposure::strength(light)),
            finished: false,
        }
    }

    /// A layer for several sources.
    pub fn shared(name: &str) -> Self {
        Layer { name: name.to_owned(), light: None, traced: None, finished: true }
    }

    /// Factor from the traced white luminance to time-integrated, coloured luminance (cd s/m2) as the scene is now.
    pub(super) fn weight(&self, scene: &Scene) -> Vec3 {
        if self.finished {
            return Vec3::ONE;
        }
        let light = self.light.and_then(|id| scene.light(id)).filter(|light| light.on);
        let (Some(light), Some(traced)) = (light, self.traced) else { return Vec3::ZERO };
        let rgb = color::light_rgb(&light.color, scene.camera.white_balance_k);
        rgb * (ratio(light, traced) * exposure::integration_time_s(&light.power.output, &scene.camera))
    }
}

/// Output of a light now over the output that was traced. 1 exactly when nothing changed.
fn ratio(light: &Light, traced: Strength) -> f32 {
    let per_flux = exposure::intensity_per_flux(&light.emitter).unwrap_or(0.0);
    let axial = |strength| match strength {
        Strength::Flux(flux) => flux * per_flux,
        Strength::AxialIntensity(value) | Strength::Illuminance(value) => value,
    };
    let now = exposure::strength(light);
    if now == traced { 1.0 } else { axial(now) / axial(traced) }
}

/// Colour and time of a light for a shared layer.
pub fn finished_tint(light: &Light, scene: &Scene) -> Vec3 {
    color::light_rgb(&light.color, scene.camera.white_balance_k)
        * exposure::integration_time_s(&light.power.output, &scene.camera)
}

/// Assigns layers: one a light, or one a role when there are many; the last layer is the glow of surfaces.
pub fn assign_layers(scene: &Scene, lights: &mut [(TracedLight, &Light)]) -> Vec<Layer> {
    let mut layers: Vec<Layer> = Vec::new();
    let grouped = lights.len() > MAX_LIGHT_LAYERS;
    for (traced, light) in lights {
        if grouped {
            let name = format!("{} lights", light.role.label());
            let known = layers.iter().position(|layer| layer.name == name);
            traced.layer = known.unwrap_or(layers.len());
            traced.tint = finished_tint(light, scene);
            if known.is_none() {
                layers.push(Layer::shared(&name));
            }
        } else {
            traced.layer = layers.len();
            layers.push(Layer::of_light(light));
        }
    }
    layers.push(Layer::shared("Glow"));
    layers
}

/// Sums of one tile.
#[derive(Clone, Debug)]
pub struct TileFilm {
    /// Left edge, pixels.
    pub x: u32,
    /// Upper edge, pixels.
    pub y: u32,
    /// Pixels across; less than [`TILE`] at the right edge.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Sums, layer by layer, pixels in rows.
    sums: Vec<Vec3>,
    /// Sum of exposed luminance of the two halves of the samples, to estimate the noise.
    halves: [Vec<f32>; 2],
    /// Samples a pixel in each half.
    samples: [u32; 2],
    /// Non-finite contributions that were dropped.
    pub nonfinite: u64,
    /// Pixel and sample of the first of them.
    pub first_nonfinite: Option<(u32, u32, u32)>,
}

impl TileFilm {
    fn new(x: u32, y: u32, width: u32, height: u32, layers: usize) -> Self {
        let pixels = (width * height) as usize;
        TileFilm {
            x,
            y,
            width,
            height,
            sums: vec![Vec3::ZERO; pixels * layers],
            halves: [vec![0.0; pixels], vec![0.0; pixels]],
            samples: [0; 2],
            nonfinite: 0,
            first_nonfinite: None,
        }
    }

    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        (self.width * self.height) as usize
    }

    /// Adds to a layer at a pixel of the tile.
    #[inline]
    pub fn add(&mut self, layer: usize, pixel: usize, value: Vec3) {
        let pixels = self.pixels();
        self.sums[layer * pixels + pixel] += value;
    }

    /// Adds the sample's exposed luminance to one half.
    pub fn add_luminance(&mut self, half: usize, pixel: usize, luminance: f32) {
        self.halves[half][pixel] += luminance;
    }

    /// Samples a pixel so far.
    pub fn spp(&self) -> u32 {
        self.samples[0] + self.samples[1]
    }

    /// Factor from sums to means.
    fn per_sample(&self) -> f32 {
        1.0 / self.spp().max(1) as f32
    }

    /// Which half the next wave goes to: the one with fewer samples.
    pub fn next_half(&self) -> usize {
        usize::from(self.samples[1] < self.samples[0])
    }

    /// Books a wave of samples of every pixel.
    pub fn finish_wave(&mut self, half: usize, samples: u32) {
        self.samples[half] += samples;
    }

    /// Estimated noise: root mean square error of the pixels over the mean brightness, in stops. From the difference of
    /// the two halves of the samples; infinite before there are two, none for tiles darker than eight stops under grey.
    pub fn noise_stops(&self) -> Option<f32> {
        let [a, b] = self.samples.map(|n| n as f32);
        if a == 0.0 || b == 0.0 {
            return Some(f32::INFINITY);
        }
        // Var(mean of all) = Var(difference of the halves' means) ab / (a + b)^2.
        let scale = a * b / ((a + b) * (a + b));
        let pixels = self.pixels() as f32;
        let (mut square, mut mean) = (0.0, 0.0);
        for (first, second) in self.halves[0].iter().zip(&self.halves[1]) {
            let difference = first / a - second / b;
            square += difference * difference * scale;
            mean += (first + second) / (a + b);
        }
        let mean = mean / pixels;
        (mean > 0.18 / 256.0).then(|| (1.0 + (square / pixels).sqrt() / mean).log2())
    }

    /// Counts a non-finite contribution.
    pub fn report_nonfinite(&mut self, x: u32, y: u32, sample: u32) {
        self.nonfinite += 1;
        self.first_nonfinite.get_or_insert((x, y, sample));
    }
}

/// A picture in the making: sums of samples, layer by layer.
#[derive(Clone, Debug)]
pub struct Film {
    width: u32,
    height: u32,
    layers: Vec<Layer>,
    /// How light was followed.
    pub(super) method: Method,
    /// Photons brought caustics.
    pub(super) photons: bool,
    /// Rows of tiles from the top.
    pub(super) tiles: Vec<TileFilm>,
}

impl Film {
    /// An empty film.
    pub fn new(width: u32, height: u32, layers: Vec<Layer>) -> Self {
        let mut tiles = Vec::new();
        for y in (0..height).step_by(TILE as usize) {
            for x in (0..width).step_by(TILE as usize) {
                tiles.push(TileFilm::new(x, y, TILE.min(width - x), TILE.min(height - y), layers.len()));
            }
        }
        Film { width, height, layers, method: Method::Path, photons: false, tiles }
    }

    /// Pixels across.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Pixels down.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// How light was followed, in words for the picture's file.
    pub fn method(&self) -> &'static str {
        match (self.method, self.photons) {
            (Method::Whitted, _) => "whitted",
            (Method::Direct, false) => "direct",
            (Method::Direct, true) => "direct, caustics from photons",
            (Method::Path, false) => "path",
            (Method::Path, true) => "path, caustics from photons",
        }
    }

    /// Whether photons brought caustics.
    pub fn has_photons(&self) -> bool {
        self.photons
    }

    /// Samples that every pixel has; some have more where noise was sought out, or where a wave was cut short.
    pub fn spp(&self) -> u32 {
        self.tiles.iter().map(TileFilm::spp).min().unwrap_or(0)
    }

    /// Samples a pixel in the mean.
    pub fn mean_spp(&self) -> f64 {
        let samples: u64 = self.tiles.iter().map(|tile| tile.pixels() as u64 * u64::from(tile.spp())).sum();
        samples as f64 / (f64::from(self.width) * f64::from(self.height)).max(1.0)
    }

    /// The layers, in the order of [`Film::develop_layers`].
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// Non-finite contributions that were dropped and shown black.
    pub fn nonfinite(&self) -> u64 {
        self.tiles.iter().map(|t| t.nonfinite).sum()
    }

    /// Pixel (x, y) and sample of the first non-finite contribution.
    pub fn first_nonfinite(&self) -> Option<(u32, u32, u32)> {
        self.tiles.iter().find_map(|t| t.first_nonfinite)
    }

    /// The picture with exposure, white balance, and each light's power, colour and switch as they are in `scene` now.
    /// Lights that were off when the render began have no layer and stay dark.
    pub fn develop(&self, scene: &Scene) -> Picture {
        let weights = self.weights(scene);
        self.picture(|tile, pixel| {
            let pixels = tile.pixels();
            let sums = weights.iter().enumerate().map(|(layer, weight)| tile.sums[layer * pixels + pixel] * *weight);
            sums.sum::<Vec3>() * tile.per_sample()
        })
    }

    /// Each layer developed alone; their sum is [`Film::develop`].
    pub fn develop_layers(&self, scene: &Scene) -> Vec<(String, Picture)> {
        let weights = self.weights(scene);
        let one = |(layer, info): (usize, &Layer)| {
            let picture = self
                .picture(|tile, pixel| tile.sums[layer * tile.pixels() + pixel] * weights[layer] * tile.per_sample());
            (info.name.clone(), picture)
        };
        self.layers.iter().enumerate().map(one).collect()
    }

    /// Factor of each layer from means to picture values.
    fn weights(&self, scene: &Scene) -> Vec<Vec3> {
        let scale = exposure::pixel_per_cd_s_m2(&scene.camera);
        self.layers.iter().map(|layer| layer.weight(scene) * scale).collect()
    }

    fn picture(&self, value: impl Fn(&TileFilm, usize) -> Vec3) -> Picture {
        let mut picture = Picture::new(self.width, self.height);
        for tile in &self.tiles {
            for pixel in 0..tile.pixels() {
                let (x, y) = (tile.x + pixel as u32 % tile.width, tile.y + pixel as u32 / tile.width);
                picture.rgb[y as usize * self.width as usize + x as usize] = value(tile, pixel).to_array();
            }
        }
        picture
    }

    /// Estimated noise: the median over the tiles of their noise, in stops. Infinite before there are two samples.
    pub fn noise_stops(&self) -> f32 {
        let mut noise: Vec<f32> = self.tiles.iter().filter_map(TileFilm::noise_stops).collect();
        noise.sort_by(f32::total_cmp);
        noise.get(noise.len() / 2).copied().unwrap_or(0.0)
    }
}
