//! Undo and redo lists of scene snapshots. A scene is small plain data; meshes and textures are shared assets.

use crate::editor::document::item::Item;
use crate::figures;
use crate::scene::{Scene, VariantId};

/// Most steps kept; the oldest are dropped.
const CAPACITY: usize = 300;

/// Identifies the steps of one drag, which are merged: the press that began it and the items it changes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MergeKey {
    /// Number of the press.
    pub press_id: u64,
    /// The dragged items.
    pub targets: Vec<Item>,
    /// The variant that they belong to.
    pub variant: VariantId,
}

#[derive(Clone, Debug)]
struct HistoryStep {
    label: String,
    /// The scene before the step in the undo list, after it in the redo list.
    scene: Scene,
    merge: Option<MergeKey>,
    /// The variants that were shown before and after the step.
    shown: [VariantId; 2],
}

/// The undo and redo lists.
#[derive(Clone, Debug, Default)]
pub struct History {
    undo: Vec<HistoryStep>,
    redo: Vec<HistoryStep>,
}

impl History {
    /// Records a step from the scene `before`, after which variant `shown` is shown. A step with the merge key of the last
    /// one is merged with it. Clears the redo list.
    pub fn record(&mut self, before: Scene, label: String, merge: Option<MergeKey>, shown: VariantId) {
        self.redo.clear();
        let joins = merge.is_some() && self.undo.last().is_some_and(|last| last.merge == merge);
        if joins {
            return;
        }
        if self.undo.len() == CAPACITY {
            self.undo.remove(0);
        }
        let shown = [before.variants.shown(), shown];
        self.undo.push(HistoryStep { label, scene: before, merge, shown });
    }

    /// Undoes the last step, in the variant that it changed; returns its label.
    pub fn undo(&mut self, scene: &mut Scene) -> Option<String> {
        let step = self.undo.pop()?;
        figures::show_variant(scene, step.shown[1]);
        let after = std::mem::replace(scene, step.scene);
        self.redo.push(HistoryStep { label: step.label.clone(), scene: after, merge: None, shown: step.shown });
        Some(step.label)
    }

    /// Redoes the step undone last, in the variant that it changed; returns its label.
    pub fn redo(&mut self, scene: &mut Scene) -> Option<String> {
        let step = self.redo.pop()?;
        figures::show_variant(scene, step.shown[0]);
        let before = std::mem::replace(scene, step.scene);
        self.undo.push(HistoryStep { label: step.label.clone(), scene: before, merge: None, shown: step.shown });
        Some(step.label)
    }

    /// Undoes and discards the last step if it belongs to this press; returns true if it did.
    pub fn abandon(&mut self, scene: &mut Scene, press_id: u64) -> bool {
        let belongs = self.undo.last().and_then(|step| step.merge.as_ref()).is_some_and(|key| key.press_id == press_id);
        if belongs {
            self.undo(scene);
            self.redo.pop();
        }
        belongs
    }

    /// Returns the label of the step to undo.
    pub fn undo_label(&self) -> Option<&str> {
        self.undo.last().map(|step| step.label.as_str())
    }

    /// Returns the label of the step to redo.
    pub fn redo_label(&self) -> Option<&str> {
        self.redo.last().map(|step| step.label.as_str())
    }

    /// Returns the number of steps that can be undone.
    pub fn depth(&self) -> usize {
        self.undo.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(name: &str) -> Scene {
        Scene { name: name.to_owned(), ..Scene::default() }
    }

    #[test]
    fn undo_and_redo_are_inverse() {
        let (mut history, mut scene) = (History::default(), named("c"));
        history.record(named("a"), "first".into(), None, VariantId::default());
        history.record(named("b"), "second".into(), None, VariantId::default());
        assert_eq!(history.undo(&mut scene).as_deref(), Some("second"));
        assert_eq!(scene.name, "b");
        history.undo(&mut scene);
        assert_eq!((history.undo(&mut scene), scene.name.as_str()), (None, "a"));
        history.redo(&mut scene);
        history.redo(&mut scene);
        assert_eq!((history.redo(&mut scene), scene.name.as_str()), (None, "c"));
    }

    #[test]
    fn one_drag_is_one_step_and_the_next_drag_another() {
        let mut history = History::default();
        let key = |press_id, target| Some(MergeKey { press_id, targets: vec![target], variant: VariantId::default() });
        for name in ["a", "b", "c"] {
            history.record(named(name), "drag".into(), key(1, Item::Camera), VariantId::default());
        }
        assert_eq!(history.depth(), 1);
        history.record(named("d"), "drag".into(), key(2, Item::Camera), VariantId::default());
        history.record(named("e"), "drag".into(), key(2, Item::Room), VariantId::default());
        assert_eq!(history.depth(), 3);
        let mut scene = named("f");
        (0..3).for_each(|_| drop(history.undo(&mut scene)));
        assert_eq!(scene.name, "a");
    }

    #[test]
    fn a_new_step_clears_redo_and_the_list_has_a_capacity() {
        let (mut history, mut scene) = (History::default(), Scene::default());
        for _ in 0..CAPACITY + 10 {
            history.record(Scene::default(), "step".into(), None, VariantId::default());
        }
        assert_eq!(history.depth(), CAPACITY);
        history.undo(&mut scene);
        assert!(history.redo_label().is_some());
        history.record(Scene::default(), "other".into(), None, VariantId::default());
        assert!(history.redo_label().is_none());
    }
}
