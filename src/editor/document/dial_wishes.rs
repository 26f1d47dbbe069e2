//! Wanted exposures as they are typed, and the dials that give them.

use crate::editor::document::action::Action;
use crate::jobs::sentence;
use crate::scene::{LightId, Scene};
use crate::setup::{DialPlan, SetupTransport, Wish, WishLevel, WishTarget, check_wishes, solve_dials};
use std::collections::BTreeMap;

/// What a wish is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum WishRow {
    /// A light by itself.
    Light(LightId),
    /// All light on the subject.
    Subject,
    /// All light on the background.
    Background,
    /// The light on the subject of lights that aim at something else.
    Spill,
}

impl WishRow {
    /// The places.
    pub const PLACES: [WishRow; 3] = [WishRow::Subject, WishRow::Background, WishRow::Spill];

    /// Returns what is metered for it.
    pub fn target(self) -> WishTarget {
        match self {
            WishRow::Light(light) => WishTarget::Lights(vec![light]),
            WishRow::Subject => WishTarget::Subject,
            WishRow::Background => WishTarget::Background,
            WishRow::Spill => WishTarget::Spill,
        }
    }

    /// Returns its name.
    pub fn name(self, setup: &SetupTransport) -> String {
        match self {
            WishRow::Light(light) => setup.light(light).map(|light| light.name.clone()).unwrap_or_default(),
            WishRow::Subject => "Subject".to_owned(),
            WishRow::Background => "Background".to_owned(),
            WishRow::Spill => "Spill".to_owned(),
        }
    }
}

/// The typed wishes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DialWishes {
    texts: BTreeMap<WishRow, String>,
    planned: Option<Planned>,
}

/// A plan, and what it was made of.
#[derive(Clone, Debug, PartialEq)]
struct Planned {
    texts: BTreeMap<WishRow, String>,
    setup: SetupTransport,
    plan: Result<DialPlan, String>,
}

impl DialWishes {
    /// Returns the text of a wish.
    pub fn text(&self, row: WishRow) -> &str {
        self.texts.get(&row).map_or("", String::as_str)
    }

    /// Sets the text of a wish.
    pub fn set(&mut self, row: WishRow, text: String) {
        if text.trim().is_empty() {
            self.texts.remove(&row);
        } else {
            self.texts.insert(row, text);
        }
    }

    /// Forgets all wishes.
    pub fn clear(&mut self) {
        self.texts.clear();
    }

    /// Returns true without a wish.
    pub fn is_empty(&self) -> bool {
        self.texts.is_empty()
    }

    /// Returns true for a text that is no level.
    pub fn is_wrong(&self, row: WishRow) -> bool {
        self.texts.get(&row).is_some_and(|text| WishLevel::parse(text).is_none())
    }

    /// Returns the dials for the wishes, or the reason why there are none. Wishes for lights and
    /// places that are not there are left out.
    pub fn plan(&mut self, setup: &SetupTransport) -> &Result<DialPlan, String> {
        let is_current = |planned: &Planned| planned.texts == self.texts && planned.setup == *setup;
        let planned = match self.planned.take().filter(is_current) {
            Some(planned) => planned,
            None => Planned { texts: self.texts.clone(), setup: setup.clone(), plan: self.new_plan(setup) },
        };
        &self.planned.insert(planned).plan
    }

    fn new_plan(&self, setup: &SetupTransport) -> Result<DialPlan, String> {
        let wish = |(row, text): (&WishRow, &String)| {
            let name = row.name(setup);
            match WishLevel::parse(text) {
                Some(level) => Ok(Wish { name, target: row.target(), level }),
                None => Err(format!("{text:?} for {name} is no level: write f/8, +0.5 or -1.5.")),
            }
        };
        let is_there = |row: &WishRow| match row {
            WishRow::Light(light) => setup.light(*light).is_some_and(|light| light.has_dial),
            WishRow::Background => setup.has_background(),
            WishRow::Subject | WishRow::Spill => true,
        };
        let wishes: Vec<Wish> =
            self.texts.iter().filter(|(row, _)| is_there(row)).map(wish).collect::<Result<_, _>>()?;
        check_wishes(&wishes, setup).map_err(|error| sentence(&error))?;
        Ok(solve_dials(setup, &wishes))
    }
}

/// Returns the action that sets the dials of a plan; none if there is nothing to change.
pub fn dial_action(plan: &DialPlan, scene: &Scene) -> Option<Action> {
    let mut planned = scene.clone();
    plan.apply(&mut planned);
    let changed = planned.lights.into_iter().filter(|light| scene.light(light.id) != Some(light));
    let actions: Vec<Action> = changed.map(|light| Action::SetLight(Box::new(light))).collect();
    (!actions.is_empty()).then(|| Action::Together { label: "Set dials".to_owned(), actions })
}
