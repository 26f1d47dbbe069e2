//! What is selected: any number of things, in the order in which they were chosen.

use crate::editor::document::item::Item;
use crate::scene::{LightId, Scene};
use glam::Vec3;

/// The selected things. The last one chosen is the one whose values the inspector shows.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selection {
    items: Vec<Item>,
}

impl Selection {
    /// These things; what comes twice is taken once.
    pub fn of(items: impl IntoIterator<Item = Item>) -> Self {
        let mut selection = Selection::default();
        selection.add(items);
        selection
    }

    /// All of them, the last chosen last.
    pub fn items(&self) -> &[Item] {
        &self.items
    }

    /// The thing that was chosen last.
    pub fn last(&self) -> Option<Item> {
        self.items.last().copied()
    }

    /// Whether nothing is selected.
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// Number of things.
    pub fn len(&self) -> usize {
        self.items.len()
    }

    /// Whether this thing is selected.
    pub fn contains(&self, item: Item) -> bool {
        self.items.contains(&item)
    }

    /// Selects these, too; they become the last.
    pub fn add(&mut self, items: impl IntoIterator<Item = Item>) {
        for item in items {
            self.items.retain(|other| *other != item);
            self.items.push(item);
        }
    }

    /// Takes a thing in, or out if it is in.
    pub fn toggle(&mut self, item: Item) {
        if self.contains(item) {
            self.items.retain(|other| *other != item);
        } else {
            self.items.push(item);
        }
    }

    /// Forgets what the studio no longer has.
    pub fn keep_existing(&mut self, scene: &Scene) {
        self.items.retain(|item| item.exists_in(scene));
    }

    /// The selected lights.
    pub fn lights(&self) -> Vec<LightId> {
        let light = |item: &Item| if let Item::Light(id) = item { Some(*id) } else { None };
        self.items.iter().filter_map(light).collect()
    }

    /// What of it has a place and is not locked there.
    pub fn movable(&self, scene: &Scene) -> Vec<Item> {
        let can_move = |item: &Item| item.position(scene).is_some() && !item.is_locked(scene);
        self.items.iter().copied().filter(can_move).collect()
    }

    /// The common centre: the mean of all places, metres.
    pub fn centre(&self, scene: &Scene) -> Option<Vec3> {
        centre(&self.items, scene)
    }
}

/// The mean of the places of things, metres; none where none has a place.
pub fn centre(items: &[Item], scene: &Scene) -> Option<Vec3> {
    let places: Vec<Vec3> = items.iter().filter_map(|item| item.position(scene)).collect();
    (!places.is_empty()).then(|| places.iter().sum::<Vec3>() / places.len() as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::ObjectId;

    #[test]
    fn the_last_chosen_thing_comes_last_and_nothing_twice() {
        let thing = |i| Item::Object(ObjectId(i));
        let mut selection = Selection::of([thing(0), thing(1), thing(0)]);
        assert_eq!(selection.items(), [thing(1), thing(0)]);
        selection.toggle(thing(0));
        assert_eq!((selection.last(), selection.len()), (Some(thing(1)), 1));
        selection.toggle(Item::Camera);
        assert_eq!(selection.last(), Some(Item::Camera));
        selection.keep_existing(&Scene::default());
        assert_eq!(selection.items(), [Item::Camera]);
    }
}
