//! The content of a sheet, before it is laid out.

use super::camera_facts::{Fact, camera_facts, subject_facts};
use super::checks::Checks;
use super::drawing::Rgb;
use super::gear::gear;
use super::lengths::Units;
use super::light_facts::LightFacts;
use super::view::{Sight, StudioView, ViewFrom, print_color};
use crate::gear::{GearList, shortages};
use crate::photo::Picture;
use crate::raytrace::{GeometryCache, PrepareError, RenderControl};
use crate::scene::{Assets, Scene};
use crate::setup::{MeteredAt, MeteredSetup};

/// The check of a set-up that has none.
const NOTHING: &str = "Nothing that a plan can see.";

/// The places between which the lengths in drawings and table are measured.
pub const MEASURES: [&str; 2] = [
    "Distances in the plan: along the floor, from under the middle of a light's front to under the red ring (the subject) \
     or what the light aims at.",
    "Distances in the table: straight, as a tape from the middle of the front to the same point. Heights: of that middle \
     over the floor.",
];

/// A light of a sheet.
#[derive(Clone, Debug)]
pub struct SheetLight {
    /// Its facts.
    pub facts: LightFacts,
    /// Its colour in plan and table.
    pub color: Rgb,
}

/// The content of a sheet.
#[derive(Clone, Debug)]
pub struct SheetContent {
    /// Title.
    pub title: String,
    /// One line on the purpose of the set-up.
    pub description: String,
    /// Units of lengths.
    pub units: Units,
    /// The picture that the plan is for.
    pub picture: Picture,
    /// Camera and exposure.
    pub camera: Vec<Fact>,
    /// Meter and background.
    pub subject: Vec<Fact>,
    /// The lights, in the studio's order.
    pub lights: Vec<SheetLight>,
    /// Plan and elevation.
    pub views: [StudioView; 2],
    /// The gear to bring, with its number of pieces.
    pub gear: Vec<(usize, String)>,
    /// The checks for the set.
    pub checks: Vec<String>,
}

impl SheetContent {
    /// Collects the content of a studio's sheet: reads the meter, looks for stands in the picture, and compares heads,
    /// modifiers and stands with those that `gear_list` says the user owns. None once `control` is cancelled.
    ///
    /// # Errors
    /// If the scene has errors.
    pub fn new(
        scene: &Scene,
        assets: &Assets,
        picture: Picture,
        units: Units,
        gear_list: &GearList,
        cache: &GeometryCache,
        control: &RenderControl,
    ) -> Result<Option<Self>, PrepareError> {
        let Some(setup) = MeteredSetup::new(scene, assets, cache, control)? else { return Ok(None) };
        let mut checks = Checks::new(&setup, assets, units);
        checks.texts.extend(shortages(scene, gear_list, &checks.stands_seen));
        let facts = scene.lights.iter().enumerate();
        let mut facts: Vec<LightFacts> =
            facts.map(|(index, light)| LightFacts::new(&setup, index + 1, light, units, control)).collect();
        LightFacts::compare_with_key(&mut facts);
        let subject = setup.subject.position;
        let sights = facts.iter().zip(&scene.lights).map(|(facts, light)| {
            let aim = setup.aim_of(light);
            // The table gives the distance to the same point
            let target = if facts.metered_at == MeteredAt::Aim { aim } else { Some(subject) };
            Sight { aim, target }
        });
        let sights: Vec<Sight> = sights.collect();
        let lights = facts.into_iter().zip(&scene.lights);
        let lights = lights.map(|(facts, light)| SheetLight { facts, color: print_color(light) });
        let content = SheetContent {
            title: Some(scene.title())
                .filter(|title| !title.is_empty())
                .unwrap_or_else(|| "Untitled studio".to_owned()),
            description: scene.description.clone(),
            units,
            picture,
            camera: camera_facts(&setup, units),
            subject: subject_facts(&setup, setup.background().as_ref(), units),
            lights: lights.collect(),
            views: [ViewFrom::Above, ViewFrom::Side].map(|from| StudioView::new(scene, assets, subject, &sights, from)),
            gear: gear(scene, &checks.stands_seen, units),
            checks: if checks.texts.is_empty() { vec![NOTHING.to_owned()] } else { checks.texts },
        };
        Ok((!control.is_cancelled()).then_some(content))
    }
}
