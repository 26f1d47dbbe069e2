//! The catalog of lights, figures, props and backdrops that can be added to a studio.

use super::prop_list::{MODEL_BACKDROPS, MODELS, ModelEntry, new_model};
use crate::figures::{self, ReadyFigure};
use crate::scene::{
    Aim, Emitter, Light, Material, MaterialPreset, Modifier, NamedModifier, Object, Output, Power, PropModel, Shape,
    Spring, Tank,
};
use glam::Vec3;

/// The tabs of the catalog.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CatalogTab {
    /// Lights.
    Lights,
    /// People.
    Figures,
    /// Props and products.
    Props,
    /// Paper rolls and cloths.
    Backdrops,
}

impl CatalogTab {
    /// All tabs, in order.
    pub const ALL: [CatalogTab; 4] =
        [CatalogTab::Lights, CatalogTab::Figures, CatalogTab::Props, CatalogTab::Backdrops];

    /// Returns the label.
    pub fn label(self) -> &'static str {
        match self {
            CatalogTab::Lights => "Lights",
            CatalogTab::Figures => "Figures",
            CatalogTab::Props => "Props",
            CatalogTab::Backdrops => "Backdrops",
        }
    }
}

/// The light or object that a catalog entry creates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CatalogKind {
    /// A light with this emitter and modifier, and its output at full power.
    Light(Emitter, Modifier, Output),
    /// A person: an index into [`figures::READY`].
    Figure(usize),
    /// A parametric shape with a material, on the floor.
    Prop(PropShape, MaterialPreset),
    /// A generated model on the floor, with its own materials or another for the whole.
    Model(PropModel, Option<MaterialPreset>),
    /// A paper roll, or a cloth that hangs and lies like one.
    Roll {
        /// Width, metres.
        width_m: f32,
        /// Its surface.
        surface: RollSurface,
    },
}

/// The surface of a backdrop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RollSurface {
    /// A preset.
    Preset(MaterialPreset),
    /// Matte paper or cloth of this albedo, linear RGB. Typical values: makers state none.
    Matte([f32; 3]),
}

impl RollSurface {
    /// Returns the material.
    pub fn material(self) -> Material {
        match self {
            RollSurface::Preset(preset) => preset.material(),
            RollSurface::Matte(base_color) => Material { base_color, ..MaterialPreset::WhitePaper.material() },
        }
    }
}

/// Shapes of props with their sizes, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PropShape {
    /// Edge lengths.
    Box([f32; 3]),
    /// Radius.
    Sphere(f32),
    /// Radius and height.
    Cylinder(f32, f32),
    /// Width and depth, horizontal.
    Plane(f32, f32),
    /// Width and height, vertical, facing the front.
    Card(f32, f32),
    /// Width of each of two boards, and height.
    VFlat(f32, f32),
    /// A landscape with water.
    Tank,
}

/// An entry of the catalog.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CatalogEntry {
    /// Name of the entry and of the item it creates.
    pub name: &'static str,
    /// Tooltip: one line on its use.
    pub tip: &'static str,
    /// The light or object to create.
    pub kind: CatalogKind,
}

/// A studio flash head of 400 Ws.
pub const HEAD: Output = Output::FlashWs { energy_ws: 400.0, efficacy_lm_s_per_ws: Output::DEFAULT_EFFICACY };

/// Returns the entry of a flash head with a named modifier.
const fn modified(named: &NamedModifier) -> CatalogEntry {
    CatalogEntry { name: named.name, tip: named.tip, kind: CatalogKind::Light(named.emitter, named.modifier, HEAD) }
}

/// Returns the entry of a continuous light.
const fn continuous(name: &'static str, tip: &'static str, emitter: Emitter, output: Output) -> CatalogEntry {
    CatalogEntry { name, tip, kind: CatalogKind::Light(emitter, Modifier::loss(0.0), output) }
}

const fn figure(index: usize) -> CatalogEntry {
    let ReadyFigure { name, tip, .. } = figures::READY[index];
    CatalogEntry { name, tip, kind: CatalogKind::Figure(index) }
}

const fn prop(name: &'static str, tip: &'static str, shape: PropShape, material: MaterialPreset) -> CatalogEntry {
    CatalogEntry { name, tip, kind: CatalogKind::Prop(shape, material) }
}

const fn paper(name: &'static str, tip: &'static str, width_m: f32, paper: MaterialPreset) -> CatalogEntry {
    CatalogEntry { name, tip, kind: CatalogKind::Roll { width_m, surface: RollSurface::Preset(paper) } }
}

/// Returns the entry of a coloured paper, or a cloth, 2.72 m wide.
const fn colored(name: &'static str, tip: &'static str, albedo: [f32; 3]) -> CatalogEntry {
    CatalogEntry { name, tip, kind: CatalogKind::Roll { width_m: 2.72, surface: RollSurface::Matte(albedo) } }
}

const RACK: usize = NamedModifier::ALL.len();

/// Flash heads with every modifier, then continuous lights.
const LIGHTS: [CatalogEntry; RACK + CONTINUOUS.len()] = {
    let mut list = [CONTINUOUS[0]; RACK + CONTINUOUS.len()];
    let mut i = 0;
    while i < list.len() {
        list[i] = if i < RACK { modified(&NamedModifier::ALL[i]) } else { CONTINUOUS[i - RACK] };
        i += 1;
    }
    list
};

const CONTINUOUS: [CatalogEntry; 4] = [
    continuous(
        "LED panel 30 x 30",
        "A continuous LED panel of 5000 lm: faint beside flash at a short shutter.",
        Emitter::RectPanel { width_m: 0.3, height_m: 0.3 },
        Output::Lumens(5000.0),
    ),
    continuous(
        "Window 1 x 2 m",
        "A tall window with an even, overcast sky outside: 3000 cd/m2.",
        Emitter::RectPanel { width_m: 1.0, height_m: 2.0 },
        Output::Lumens(18_850.0),
    ),
    continuous(
        "Sun",
        "Parallel light with hard shadows, up to full sunlight.",
        Emitter::Sun { angular_diameter_deg: 0.53 },
        Output::Lux(100_000.0),
    ),
    continuous(
        "Overcast surround",
        "Even light from everywhere: a cloudy sky, a white tent.",
        Emitter::Surround,
        Output::Lux(20_000.0),
    ),
];

const FIGURES: [CatalogEntry; figures::READY.len()] = {
    let mut entries = [figure(0); figures::READY.len()];
    let mut index = 1;
    while index < entries.len() {
        entries[index] = figure(index);
        index += 1;
    }
    entries
};

const SHAPES: [CatalogEntry; 23] = [
    prop("Box", "A box of 50 cm.", PropShape::Box([0.5, 0.5, 0.5]), MaterialPreset::MatteFabric),
    prop("Sphere", "A matte ball of 30 cm.", PropShape::Sphere(0.15), MaterialPreset::MatteFabric),
    prop("Cylinder", "An upright cylinder, 30 cm across.", PropShape::Cylinder(0.15, 0.4), MaterialPreset::MatteFabric),
    prop("Plane", "A flat sheet of 1 x 1 m.", PropShape::Plane(1.0, 1.0), MaterialPreset::GreyPaper),
    prop(
        "Posing cube",
        "A seat of 45 cm for seated figures.",
        PropShape::Box([0.45, 0.45, 0.45]),
        MaterialPreset::WhitePaper,
    ),
    prop(
        "Table",
        "A table top at 75 cm for product work.",
        PropShape::Box([1.2, 0.75, 0.8]),
        MaterialPreset::StudioFloor,
    ),
    prop(
        "V-flat, white",
        "Two white boards of 1.2 x 2.4 m: beside the subject they bounce light back.",
        PropShape::VFlat(1.2, 2.4),
        MaterialPreset::WhitePaper,
    ),
    prop(
        "V-flat, black",
        "Two black boards of 1.2 x 2.4 m: beside the subject they take light away.",
        PropShape::VFlat(1.2, 2.4),
        MaterialPreset::BlackVelvet,
    ),
    prop("Grey card", "18 % grey, 20 x 25 cm.", PropShape::Card(0.2, 0.25), MaterialPreset::GreyCard),
    prop("Chrome ball", "A mirror ball: shows every light around it.", PropShape::Sphere(0.1), MaterialPreset::Chrome),
    prop(
        "Grey ball",
        "An 18 % grey ball: shows where the light falls.",
        PropShape::Sphere(0.1),
        MaterialPreset::GreyCard,
    ),
    prop("Glass ball", "A ball of clear glass.", PropShape::Sphere(0.08), MaterialPreset::ClearGlass),
    prop(
        "Flacon",
        "A block of clear glass, 6 x 11 x 4 cm.",
        PropShape::Box([0.06, 0.11, 0.04]),
        MaterialPreset::ClearGlass,
    ),
    prop("Can", "A drink can of aluminium.", PropShape::Cylinder(0.033, 0.116), MaterialPreset::BrushedAluminium),
    prop(
        "Glossy pack",
        "A shiny carton, 10 x 16 x 5 cm.",
        PropShape::Box([0.1, 0.16, 0.05]),
        MaterialPreset::GlossyPlastic,
    ),
    prop("Gold bar", "A gold block.", PropShape::Box([0.16, 0.04, 0.07]), MaterialPreset::Gold),
    prop(
        "Card 60 x 90, white",
        "Bounces light into the shadows of a bust or a table.",
        PropShape::Card(0.6, 0.9),
        MaterialPreset::WhitePaper,
    ),
    prop(
        "Card 60 x 90, black",
        "Takes light away: a dark edge on glass, a darker cheek.",
        PropShape::Card(0.6, 0.9),
        MaterialPreset::BlackVelvet,
    ),
    prop(
        "Card 60 x 90, silver",
        "Bounces more, and harder, than white.",
        PropShape::Card(0.6, 0.9),
        MaterialPreset::BrushedAluminium,
    ),
    prop(
        "Card A3, white",
        "30 x 42 cm: bounces light on a table.",
        PropShape::Card(0.297, 0.42),
        MaterialPreset::WhitePaper,
    ),
    prop(
        "Card A4, white",
        "21 x 30 cm: a small bounce beside a product.",
        PropShape::Card(0.21, 0.297),
        MaterialPreset::WhitePaper,
    ),
    prop(
        "Card A4, black",
        "21 x 30 cm: a small flag beside a product.",
        PropShape::Card(0.21, 0.297),
        MaterialPreset::BlackVelvet,
    ),
    prop(
        "Water landscape",
        "Hills with a lake and a spring, 64 x 64 cm: its water runs.",
        PropShape::Tank,
        MaterialPreset::PaintedWall,
    ),
];

/// Shapes and cards, then generated models.
const PROPS: [CatalogEntry; SHAPES.len() + MODELS.len()] = joined(&SHAPES, &MODELS);

/// Paper and cloth, then generated models.
const BACKDROPS: [CatalogEntry; ROLLS.len() + MODEL_BACKDROPS.len()] = joined(&ROLLS, &MODEL_BACKDROPS);

/// Returns two lists one after the other; they are not empty.
const fn joined<const N: usize>(first: &[CatalogEntry], second: &[ModelEntry]) -> [CatalogEntry; N] {
    let mut list = [first[0]; N];
    let mut i = 0;
    while i < N {
        list[i] = if i < first.len() { first[i] } else { modelled(&second[i - first.len()]) };
        i += 1;
    }
    list
}

/// Returns the entry of a generated model.
const fn modelled(entry: &ModelEntry) -> CatalogEntry {
    CatalogEntry { name: entry.name, tip: entry.tip, kind: CatalogKind::Model(entry.model, entry.whole) }
}

const ROLLS: [CatalogEntry; 22] = [
    paper("White paper 1.35 m", "A narrow roll, for heads and busts.", 1.35, MaterialPreset::WhitePaper),
    paper("White paper 2.72 m", "The usual roll, for one full figure.", 2.72, MaterialPreset::WhitePaper),
    paper("White paper 3.55 m", "A wide roll, for groups.", 3.55, MaterialPreset::WhitePaper),
    paper("Grey paper 1.35 m", "A narrow roll, for heads and busts.", 1.35, MaterialPreset::GreyPaper),
    paper("Grey paper 2.72 m", "The usual roll, for one full figure.", 2.72, MaterialPreset::GreyPaper),
    paper("Grey paper 3.55 m", "A wide roll, for groups.", 3.55, MaterialPreset::GreyPaper),
    paper("Black paper 1.35 m", "A narrow roll, for heads and busts.", 1.35, MaterialPreset::BlackPaper),
    paper("Black paper 2.72 m", "The usual roll, for one full figure.", 2.72, MaterialPreset::BlackPaper),
    paper("Black paper 3.55 m", "A wide roll, for groups.", 3.55, MaterialPreset::BlackPaper),
    colored("Light grey paper", "Half a stop under white: white or mid-grey as it is lit.", [0.52, 0.52, 0.53]),
    colored("Dark grey paper", "A stop and a half under mid-grey: dark without being black.", [0.1, 0.1, 0.105]),
    colored("Cream paper", "A warm near-white.", [0.76, 0.69, 0.56]),
    colored("Beige paper", "A sandy tone, for skin and products.", [0.52, 0.4, 0.27]),
    colored("Brown paper", "A dark, warm tone.", [0.12, 0.065, 0.04]),
    colored("Pink paper", "A pale pink.", [0.78, 0.45, 0.5]),
    colored("Red paper", "A strong red: it colours what stands close.", [0.42, 0.025, 0.03]),
    colored("Yellow paper", "A strong yellow.", [0.78, 0.48, 0.03]),
    colored("Sky blue paper", "A pale blue.", [0.26, 0.46, 0.68]),
    colored("Navy paper", "A dark blue.", [0.015, 0.03, 0.085]),
    colored("Key green paper", "To cut a subject out; keep it two metres behind.", [0.06, 0.4, 0.07]),
    colored("Muslin, natural", "Unbleached cotton, on the floor and up the wall.", [0.62, 0.55, 0.43]),
    colored("Canvas, grey", "A painted canvas, plain: warm, darker than grey paper.", [0.17, 0.16, 0.145]),
];

/// Returns the entries of a tab.
pub fn entries(tab: CatalogTab) -> &'static [CatalogEntry] {
    match tab {
        CatalogTab::Lights => &LIGHTS,
        CatalogTab::Figures => &FIGURES,
        CatalogTab::Props => &PROPS,
        CatalogTab::Backdrops => &BACKDROPS,
    }
}

/// The light or object of a catalog entry, before placement.
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "an item is made and placed, and not kept")]
pub enum CatalogItem {
    /// A light.
    Light(Light),
    /// A figure, prop or backdrop.
    Object(Object),
}

impl CatalogEntry {
    /// Creates the item at the origin; `placement` positions it.
    pub fn make(&self) -> CatalogItem {
        match self.kind {
            CatalogKind::Light(emitter, modifier, output) => {
                CatalogItem::Light(new_light(self.name, emitter, modifier, output))
            }
            CatalogKind::Figure(index) => CatalogItem::Object(new_figure(&figures::READY[index])),
            CatalogKind::Prop(shape, material) => CatalogItem::Object(new_prop(self.name, shape, material.material())),
            CatalogKind::Model(model, whole) => CatalogItem::Object(new_model(self.name, model, whole)),
            CatalogKind::Roll { width_m, surface } => CatalogItem::Object(Object {
                material: surface.material(),
                ..Object::new(self.name, Shape::Sweep { width_m, height_m: 2.75, depth_m: 3.0, radius_m: 0.6 })
            }),
        }
    }
}

/// Returns the light of the entry of this name.
#[cfg(test)]
pub fn light_named(name: &str) -> Option<Light> {
    LIGHTS.iter().find(|e| e.name == name).and_then(|e| match e.make() {
        CatalogItem::Light(light) => Some(light),
        CatalogItem::Object(_) => None,
    })
}

/// Returns the object of the entry of this name.
#[cfg(test)]
pub fn object_named(name: &str) -> Option<Object> {
    [&FIGURES[..], &PROPS, &BACKDROPS].concat().iter().find(|e| e.name == name).and_then(|e| match e.make() {
        CatalogItem::Object(object) => Some(object),
        CatalogItem::Light(_) => None,
    })
}

fn new_figure(ready: &ReadyFigure) -> Object {
    let figure = ready.figure();
    let (material, part_materials) = ready.materials();
    Object { material, part_materials, ..Object::new(ready.name, Shape::Figure(Box::new(figure))) }
}

fn new_prop(name: &str, shape: PropShape, material: Material) -> Object {
    let (shape, height_m, pitch_deg) = match shape {
        PropShape::Box(size) => (Shape::Box { size_m: Vec3::from(size) }, 0.5 * size[1], 0.0),
        PropShape::Sphere(radius_m) => (Shape::Sphere { radius_m }, radius_m, 0.0),
        PropShape::Cylinder(radius_m, height_m) => (Shape::Cylinder { radius_m, height_m }, 0.5 * height_m, 0.0),
        PropShape::Plane(width_m, depth_m) => (Shape::Plane { width_m, depth_m }, 0.002, 0.0),
        PropShape::Card(width_m, height_m) => (Shape::Plane { width_m, depth_m: height_m }, 0.5 * height_m, 90.0),
        PropShape::Tank => (Shape::Tank(Box::new(spring_landscape())), 0.0, 0.0),
        PropShape::VFlat(wing_m, height_m) => (Shape::VFlat { wing_m, height_m, angle_deg: 90.0 }, 0.5 * height_m, 0.0),
    };
    let mut object = Object { material, ..Object::new(name, shape) };
    if matches!(object.shape, Shape::Tank(_)) {
        object.part_materials.push(("water".to_owned(), Tank::water_material()));
    }
    object.transform.position.y = height_m;
    object.transform.rotation_deg.x = pitch_deg;
    object
}

/// Returns a landscape with a spring above it.
fn spring_landscape() -> Tank {
    Tank { springs: vec![Spring::new(Vec3::new(0.08, 0.3, -0.08), 0.1)], ..Tank::default() }
}

/// Returns a light before placement, whose dial makes up for the loss of its modifier.
pub fn new_light(name: &str, emitter: Emitter, modifier: Modifier, output: Output) -> Light {
    // The dial compensates for the modifier's loss in thirds, so that all modifiers are about equally bright.
    let loss_thirds = (3.0 * (modifier.loss_stops + modifier.scrim_stops)).round();
    Light {
        name: name.to_owned(),
        position: Vec3::new(-1.2, 2.0, 1.4),
        aim: Aim::Point(Vec3::new(0.0, 1.4, 0.0)),
        modifier,
        power: Power { output, dial_stops: -3.0 + loss_thirds / 3.0 },
        visible_to_camera: matches!(emitter, Emitter::Surround),
        ..Light::new(emitter, output)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn catalog_names_are_unique() {
        let mut names = HashSet::new();
        for tab in CatalogTab::ALL {
            for entry in entries(tab) {
                assert!(names.insert(entry.name), "{} twice", entry.name);
                assert!(entry.tip.ends_with('.'), "{}: tips are sentences", entry.name);
            }
        }
    }

    #[test]
    fn props_stand_on_the_floor() {
        for entry in &PROPS {
            let CatalogItem::Object(object) = entry.make() else { unreachable!() };
            let Some(mesh) = crate::scene::tessellate(&object.shape) else {
                assert!(matches!(object.shape, Shape::Tank(_)) && object.transform.position.y == 0.0);
                continue;
            };
            let world = object.transform.world_from_object();
            let low = mesh.positions.iter().map(|p| world.transform_point3(*p).y).fold(f32::MAX, f32::min);
            assert!((0.0..0.003).contains(&(low + 1e-6)), "{}: {low}", entry.name);
        }
    }

    #[test]
    fn cards_face_the_front() {
        let card = object_named("Grey card").unwrap();
        let facing = card.transform.world_from_object().transform_vector3(Vec3::Y);
        assert!((facing - Vec3::Z).length() < 1e-6, "{facing}");
    }
}
