//! Which layers hold which light's shadow maps. A light keeps its layers from frame to frame, and a map is drawn anew
//! only when its view has moved or what that view sees has changed.

use glam::{Mat4, Vec3};

/// A light's number, and which part of its emitter the maps are seen from: 0 the middle.
pub(crate) type ViewOwner = (u32, u32);

/// The maps of one owner: one view, or a cube's six, in layers that follow each other.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LightViews {
    pub owner: ViewOwner,
    pub views: Vec<ShadowView>,
}

/// What a map sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ShadowView {
    pub clip_from_world: Mat4,
    /// Where the light is.
    pub eye: Vec3,
    /// Distance beyond which it is dark anyway, metres; 0 for a sun, which never is.
    pub reach_m: f32,
}

impl ShadowView {
    /// Whether the light gets so far.
    pub fn is_in_radius(&self, distance_m: f32) -> bool {
        self.reach_m == 0.0 || distance_m < self.reach_m
    }
}

/// What a layer shows.
#[derive(Clone, Copy, Debug, PartialEq)]
struct LayerContent {
    view: ShadowView,
    /// Changes with anything that casts a shadow anywhere.
    everything: u64,
    /// Changes with what the view sees of it.
    seen: u64,
}

/// A layer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Layer {
    /// Whose it is, and which of the run's views.
    owner: Option<(ViewOwner, usize)>,
    content: Option<LayerContent>,
    /// Frame in which it was last asked for.
    used: u64,
}

/// The owners and contents of all layers.
#[derive(Debug, Default)]
pub(crate) struct ShadowLayers {
    layers: Vec<Layer>,
    frame: u64,
}

/// A map that must be drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StaleMap {
    pub layer: usize,
    pub view: ShadowView,
}

impl ShadowLayers {
    /// So many empty layers.
    pub fn with_capacity(count: usize) -> Self {
        ShadowLayers { layers: vec![Layer::default(); count], frame: 0 }
    }

    pub fn len(&self) -> usize {
        self.layers.len()
    }

    /// Forgets what the layers show.
    pub fn invalidate(&mut self) {
        self.layers.iter_mut().for_each(|layer| layer.content = None);
    }

    /// The first layer of each run, and the maps that must be drawn. There is a layer for each view.
    /// `everything` changes with all that casts shadows, `seen_by` with what one view sees of it.
    pub fn assign(
        &mut self,
        runs: &[LightViews],
        everything: u64,
        seen_by: impl Fn(&ShadowView) -> u64,
    ) -> (Vec<usize>, Vec<StaleMap>) {
        let firsts = self.firsts(runs);
        let mut stale = Vec::new();
        for (run, first) in runs.iter().zip(&firsts) {
            for (layer, view) in (*first..).zip(&run.views) {
                // Brighter light shows more, but what it showed before looks the same.
                let same_place = |content: &LayerContent| content.view.clip_from_world == view.clip_from_world;
                let old = self.layers[layer].content.filter(same_place);
                // Which things a view sees is asked only when one of all has changed.
                let seen = match old {
                    Some(content) if content.everything == everything && content.view == *view => content.seen,
                    _ => seen_by(view),
                };
                if old.is_none_or(|content| content.seen != seen) {
                    stale.push(StaleMap { layer, view: *view });
                }
                self.layers[layer].content = Some(LayerContent { view: *view, everything, seen });
            }
        }
        (firsts, stale)
    }

    fn firsts(&mut self, runs: &[LightViews]) -> Vec<usize> {
        self.frame += 1;
        let mut firsts: Vec<Option<usize>> = runs.iter().map(|run| self.find(run)).collect();
        for (run, first) in runs.iter().zip(&firsts) {
            first.iter().for_each(|&first| self.claim(run, first));
        }
        for (run, first) in runs.iter().zip(&mut firsts).filter(|(_, first)| first.is_none()) {
            *first = self.oldest(run.views.len());
            first.iter().for_each(|&first| self.claim(run, first));
        }
        firsts.into_iter().collect::<Option<Vec<usize>>>().unwrap_or_else(|| self.packed(runs))
    }

    /// Where a run was.
    fn find(&self, run: &LightViews) -> Option<usize> {
        let first = self.layers.iter().position(|layer| layer.owner == Some((run.owner, 0)))?;
        let layers = self.layers.get(first..first + run.views.len())?;
        layers.iter().enumerate().all(|(face, layer)| layer.owner == Some((run.owner, face))).then_some(first)
    }

    /// The neighbouring layers that have been of no use for longest.
    fn oldest(&self, count: usize) -> Option<usize> {
        let last_use = |layers: &[Layer]| layers.iter().map(|layer| layer.used).max().unwrap_or(0);
        let windows = self.layers.windows(count).enumerate().map(|(first, layers)| (last_use(layers), first));
        windows.min().filter(|(used, _)| *used < self.frame).map(|(_, first)| first)
    }

    /// All runs one after the other, where they found no room between each other.
    fn packed(&mut self, runs: &[LightViews]) -> Vec<usize> {
        self.layers.fill(Layer::default());
        let mut next = 0;
        let place = |run: &LightViews| {
            let first = next;
            self.claim(run, first);
            next += run.views.len();
            first
        };
        runs.iter().map(place).collect()
    }

    fn claim(&mut self, run: &LightViews, first: usize) {
        for (face, layer) in self.layers[first..first + run.views.len()].iter_mut().enumerate() {
            let owner = Some((run.owner, face));
            let content = layer.content.filter(|_| layer.owner == owner);
            *layer = Layer { owner, content, used: self.frame };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(light: u32, place: f32, count: usize) -> LightViews {
        let view = |face: usize| ShadowView {
            clip_from_world: Mat4::from_translation(Vec3::new(place, face as f32, light as f32)),
            eye: Vec3::ZERO,
            reach_m: 0.0,
        };
        LightViews { owner: (light, 0), views: (0..count).map(view).collect() }
    }

    fn drawn(layers: &mut ShadowLayers, runs: &[LightViews]) -> usize {
        layers.assign(runs, 1, |_| 1).1.len()
    }

    #[test]
    fn a_light_that_moves_goes_out_or_comes_back_leaves_the_others_maps_alone() {
        let mut layers = ShadowLayers::with_capacity(16);
        let (a, b, c) = (run(0, 0.0, 1), run(1, 0.0, 6), run(2, 0.0, 1));
        assert_eq!(drawn(&mut layers, &[a.clone(), b.clone(), c.clone()]), 8);
        assert_eq!(drawn(&mut layers, &[a.clone(), b.clone(), c.clone()]), 0);
        assert_eq!(drawn(&mut layers, &[run(0, 0.1, 1), b.clone(), c.clone()]), 1);
        assert_eq!(drawn(&mut layers, &[b.clone(), c.clone()]), 0, "the first is off");
        assert_eq!(drawn(&mut layers, &[run(0, 0.1, 1), b.clone(), c]), 0, "and on again");
        assert_eq!(drawn(&mut layers, &[run(0, 0.1, 1), run(1, 0.2, 6)]), 6);
    }

    #[test]
    fn only_views_that_see_a_change_are_drawn_and_others_are_not_even_asked_when_nothing_changed() {
        let mut layers = ShadowLayers::with_capacity(8);
        let runs = [run(0, 0.0, 6), run(1, 0.0, 1)];
        let (firsts, _) = layers.assign(&runs, 1, |_| 1);
        // Something moves before the fourth face of the cube.
        let fourth = runs[0].views[3];
        let (again, stale) = layers.assign(&runs, 2, |view| if *view == fourth { 2 } else { 1 });
        assert_eq!((again, stale), (firsts.clone(), vec![StaleMap { layer: firsts[0] + 3, view: fourth }]));
        let (_, stale) = layers.assign(&runs, 2, |_| unreachable!("nothing has changed"));
        assert!(stale.is_empty());
        layers.invalidate();
        assert_eq!(drawn(&mut layers, &runs), 7);
    }

    #[test]
    fn whatever_fits_finds_room_and_no_two_share_a_layer() {
        let mut layers = ShadowLayers::with_capacity(8);
        for (step, counts) in [[1, 6, 1], [6, 1, 1], [1, 1, 6], [6, 1, 0], [1, 1, 1], [1, 6, 1]].into_iter().enumerate()
        {
            let runs: Vec<LightViews> =
                (0..3).map(|i| run(i + 3 * (step as u32 % 2), 0.0, counts[i as usize])).collect();
            let runs: Vec<LightViews> = runs.into_iter().filter(|run| !run.views.is_empty()).collect();
            let (firsts, _) = layers.assign(&runs, 1, |_| 1);
            let mut taken: Vec<usize> =
                runs.iter().zip(firsts).flat_map(|(run, first)| first..first + run.views.len()).collect();
            taken.sort_unstable();
            assert!(taken.windows(2).all(|pair| pair[0] < pair[1]) && taken.iter().all(|layer| *layer < 8), "{step}");
        }
    }
}
