//! The selection: any number of items, in the order in which they were selected.

use crate::editor::document::item::Item;
use crate::scene::{LightId, Scene};
use glam::Vec3;

/// The selected items. The inspector shows the last one.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selection {
    items: Vec<Item>,
}

impl Selection {
    /// Returns the selection of these items without duplicates.
    pub fn of(items: impl IntoIterator<Item = Item>) -> Self {
        let mut selection = Selection::default();
        selection.add(items);
        selection
    }

    /// Returns the items, the last selected last.
    pub fn items(&self) -> &[Item] {
        &self.items
    }

    /// Returns the item selected last.
    pub fn last(&self) -> Option<Item> {
        self.items.last().copied()
    }

    /// Returns true if nothing is selected.
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// Returns the number of items.
    pub fn len(&self) -> usize {
        self.items.len()
    }

    /// Returns true if this item is selected.
    pub fn contains(&self, item: Item) -> bool {
        self.items.contains(&item)
    }

    /// Adds items, or moves them to the end.
    pub fn add(&mut self, items: impl IntoIterator<Item = Item>) {
        for item in items {
            self.items.retain(|other| *other != item);
            self.items.push(item);
        }
    }

    /// Adds an item, or removes it if it is selected.
    pub fn toggle(&mut self, item: Item) {
        if self.contains(item) {
            self.items.retain(|other| *other != item);
        } else {
            self.items.push(item);
        }
    }

    /// Removes items that no longer exist.
    pub fn keep_existing(&mut self, scene: &Scene) {
        self.items.retain(|item| item.exists_in(scene));
    }

    /// Returns the selected lights.
    pub fn lights(&self) -> Vec<LightId> {
        let light = |item: &Item| if let Item::Light(id) = item { Some(*id) } else { None };
        self.items.iter().filter_map(light).collect()
    }

    /// Returns the selected items that have a position and are not locked.
    pub fn movable(&self, scene: &Scene) -> Vec<Item> {
        let can_move = |item: &Item| item.position(scene).is_some() && !item.is_locked(scene);
        self.items.iter().copied().filter(can_move).collect()
    }

    /// Returns the mean position, metres.
    pub fn centre(&self, scene: &Scene) -> Option<Vec3> {
        centre(&self.items, scene)
    }
}

/// Returns the mean position of items, metres; none if no item has one.
pub fn centre(items: &[Item], scene: &Scene) -> Option<Vec3> {
    let places: Vec<Vec3> = items.iter().filter_map(|item| item.position(scene)).collect();
    (!places.is_empty()).then(|| places.iter().sum::<Vec3>() / places.len() as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::ObjectId;

    #[test]
    fn the_item_selected_last_comes_last_without_duplicates() {
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
