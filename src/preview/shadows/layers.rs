//! Allocation of shadow map layers. A light keeps its layers from frame to frame, and a map is redrawn only when its
//! view or the casters in its view have changed.

use crate::scene::LightId;
use glam::{Mat4, Vec3};

/// Light id and emitter part; part 0 is the whole emitter, seen from its centre.
pub(crate) type ViewOwner = (u32, u32);

/// The views of one owner in consecutive layers: one, or those of a cube map.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LightViews {
    pub owner: ViewOwner,
    pub views: Vec<ShadowView>,
}

/// The view of a shadow map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ShadowView {
    pub clip_from_world: Mat4,
    /// Position of the light, world space.
    pub eye: Vec3,
    /// Light radius, metres, beyond which the light is negligible; 0 for a sun, which has none.
    pub cull_radius_m: f32,
    /// The light, which passes its own body.
    pub light: LightId,
}

impl ShadowView {
    /// Returns true if a distance is within the light radius.
    pub fn is_in_radius(&self, distance_m: f32) -> bool {
        self.cull_radius_m == 0.0 || distance_m < self.cull_radius_m
    }
}

/// The inputs from which a layer was drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
struct LayerContent {
    view: ShadowView,
    /// Hash of all casters.
    all_casters: u64,
    /// Hash of the casters in the view.
    visible_casters: u64,
}

/// One layer of the map array.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Layer {
    /// Owner, and index of the view among the owner's.
    owner: Option<(ViewOwner, usize)>,
    content: Option<LayerContent>,
    /// Frame in which the layer was last assigned.
    last_used: u64,
}

/// Owners and contents of all layers.
#[derive(Debug, Default)]
pub(crate) struct ShadowLayers {
    layers: Vec<Layer>,
    frame: u64,
}

/// A shadow map that must be drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StaleMap {
    pub layer: usize,
    pub view: ShadowView,
}

impl ShadowLayers {
    /// Returns `count` empty layers.
    pub fn with_capacity(count: usize) -> Self {
        ShadowLayers { layers: vec![Layer::default(); count], frame: 0 }
    }

    pub fn len(&self) -> usize {
        self.layers.len()
    }

    /// Marks all layers as not drawn.
    pub fn invalidate(&mut self) {
        self.layers.iter_mut().for_each(|layer| layer.content = None);
    }

    /// Assigns layers to each light's views. Returns the first layer of each light and the maps that must be drawn.
    /// `all_casters` is a hash of all casters, `visible_casters` returns that of the casters in one view. There must be
    /// at least as many layers as views.
    pub fn assign(
        &mut self,
        lights: &[LightViews],
        all_casters: u64,
        visible_casters: impl Fn(&ShadowView) -> u64,
    ) -> (Vec<usize>, Vec<StaleMap>) {
        let firsts = self.first_layers(lights);
        let mut stale = Vec::new();
        for (light, first) in lights.iter().zip(&firsts) {
            for (layer, view) in (*first..).zip(&light.views) {
                // A change of the light radius alone does not invalidate the map: it only culls casters
                let same_view = |content: &LayerContent| content.view.clip_from_world == view.clip_from_world;
                let old = self.layers[layer].content.filter(same_view);
                // Hash the casters in the view only if any caster has changed
                let visible = match old {
                    Some(content) if content.all_casters == all_casters && content.view == *view => {
                        content.visible_casters
                    }
                    _ => visible_casters(view),
                };
                if old.is_none_or(|content| content.visible_casters != visible) {
                    stale.push(StaleMap { layer, view: *view });
                }
                self.layers[layer].content = Some(LayerContent { view: *view, all_casters, visible_casters: visible });
            }
        }
        (firsts, stale)
    }

    fn first_layers(&mut self, lights: &[LightViews]) -> Vec<usize> {
        self.frame += 1;
        // Keep the layers of lights that have some
        let mut firsts: Vec<Option<usize>> = lights.iter().map(|light| self.find(light)).collect();
        for (light, first) in lights.iter().zip(&firsts) {
            first.iter().for_each(|&first| self.claim(light, first));
        }
        // Give the least recently used layers to the others
        for (light, first) in lights.iter().zip(&mut firsts).filter(|(_, first)| first.is_none()) {
            *first = self.least_recently_used(light.views.len());
            first.iter().for_each(|&first| self.claim(light, first));
        }
        // Reassign everything where fragmentation left no run of free layers
        firsts.into_iter().collect::<Option<Vec<usize>>>().unwrap_or_else(|| self.packed(lights))
    }

    /// Returns the first layer that a light's views already own.
    fn find(&self, light: &LightViews) -> Option<usize> {
        let first = self.layers.iter().position(|layer| layer.owner == Some((light.owner, 0)))?;
        let layers = self.layers.get(first..first + light.views.len())?;
        layers.iter().enumerate().all(|(face, layer)| layer.owner == Some((light.owner, face))).then_some(first)
    }

    /// Returns the first of `count` consecutive layers that have been unused for longest; none if all are in use.
    fn least_recently_used(&self, count: usize) -> Option<usize> {
        let last_use = |layers: &[Layer]| layers.iter().map(|layer| layer.last_used).max().unwrap_or(0);
        let windows = self.layers.windows(count).enumerate().map(|(first, layers)| (last_use(layers), first));
        windows.min().filter(|(last_use, _)| *last_use < self.frame).map(|(_, first)| first)
    }

    /// Assigns all layers anew, light after light.
    fn packed(&mut self, lights: &[LightViews]) -> Vec<usize> {
        self.layers.fill(Layer::default());
        let mut next = 0;
        let assign = |light: &LightViews| {
            let first = next;
            self.claim(light, first);
            next += light.views.len();
            first
        };
        lights.iter().map(assign).collect()
    }

    fn claim(&mut self, light: &LightViews, first: usize) {
        for (face, layer) in self.layers[first..first + light.views.len()].iter_mut().enumerate() {
            let owner = Some((light.owner, face));
            let content = layer.content.filter(|_| layer.owner == owner);
            *layer = Layer { owner, content, last_used: self.frame };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn light_views(light: u32, x: f32, count: usize) -> LightViews {
        let view = |face: usize| ShadowView {
            clip_from_world: Mat4::from_translation(Vec3::new(x, face as f32, light as f32)),
            eye: Vec3::ZERO,
            cull_radius_m: 0.0,
            light: LightId(light),
        };
        LightViews { owner: (light, 0), views: (0..count).map(view).collect() }
    }

    fn stale_count(layers: &mut ShadowLayers, lights: &[LightViews]) -> usize {
        layers.assign(lights, 1, |_| 1).1.len()
    }

    #[test]
    fn a_light_that_moves_or_is_switched_leaves_the_maps_of_others_valid() {
        let mut layers = ShadowLayers::with_capacity(16);
        let (a, b, c) = (light_views(0, 0.0, 1), light_views(1, 0.0, 6), light_views(2, 0.0, 1));
        assert_eq!(stale_count(&mut layers, &[a.clone(), b.clone(), c.clone()]), 8);
        assert_eq!(stale_count(&mut layers, &[a.clone(), b.clone(), c.clone()]), 0);
        assert_eq!(stale_count(&mut layers, &[light_views(0, 0.1, 1), b.clone(), c.clone()]), 1);
        assert_eq!(stale_count(&mut layers, &[b.clone(), c.clone()]), 0, "the first light is off");
        assert_eq!(stale_count(&mut layers, &[light_views(0, 0.1, 1), b.clone(), c]), 0, "and on again");
        assert_eq!(stale_count(&mut layers, &[light_views(0, 0.1, 1), light_views(1, 0.2, 6)]), 6);
    }

    #[test]
    fn only_views_with_changed_casters_are_redrawn_and_none_is_hashed_when_nothing_changed() {
        let mut layers = ShadowLayers::with_capacity(8);
        let lights = [light_views(0, 0.0, 6), light_views(1, 0.0, 1)];
        let (firsts, _) = layers.assign(&lights, 1, |_| 1);
        // A caster moves in the fourth face of the cube
        let fourth = lights[0].views[3];
        let (again, stale) = layers.assign(&lights, 2, |view| if *view == fourth { 2 } else { 1 });
        assert_eq!((again, stale), (firsts.clone(), vec![StaleMap { layer: firsts[0] + 3, view: fourth }]));
        let (_, stale) = layers.assign(&lights, 2, |_| unreachable!("nothing has changed"));
        assert!(stale.is_empty());
        layers.invalidate();
        assert_eq!(stale_count(&mut layers, &lights), 7);
    }

    #[test]
    fn views_that_fit_get_layers_and_no_two_share_one() {
        let mut layers = ShadowLayers::with_capacity(8);
        for (step, counts) in [[1, 6, 1], [6, 1, 1], [1, 1, 6], [6, 1, 0], [1, 1, 1], [1, 6, 1]].into_iter().enumerate()
        {
            let lights: Vec<LightViews> =
                (0..3).map(|i| light_views(i + 3 * (step as u32 % 2), 0.0, counts[i as usize])).collect();
            let lights: Vec<LightViews> = lights.into_iter().filter(|light| !light.views.is_empty()).collect();
            let (firsts, _) = layers.assign(&lights, 1, |_| 1);
            let mut taken: Vec<usize> =
                lights.iter().zip(firsts).flat_map(|(light, first)| first..first + light.views.len()).collect();
            taken.sort_unstable();
            assert!(taken.windows(2).all(|pair| pair[0] < pair[1]) && taken.iter().all(|layer| *layer < 8), "{step}");
        }
    }
}
