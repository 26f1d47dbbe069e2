//! Wanted exposures: `Key=f/8`, `Fill=-1.5`, `Background=white`.

use super::metering::MeteredAt;
use super::transport::{LightTransport, SetupTransport};
use crate::scene::{LightId, Role};
use std::collections::HashSet;
use std::fmt;

/// Names of places, which come before lights of such a name.
const SUBJECT: [&str; 2] = ["subject", "face"];
const BACKGROUND: &str = "background";
const SPILL: &str = "spill";
/// Ranges of wanted f-numbers and stops.
const F_NUMBERS: std::ops::RangeInclusive<f32> = 0.5..=128.0;
const STOPS: std::ops::RangeInclusive<f32> = -20.0..=20.0;

/// What is metered for a wish.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum WishTarget {
    /// Lights by themselves, together where they are metered at the subject.
    Lights(Vec<LightId>),
    /// All light on the subject.
    Subject,
    /// All light on the background behind the subject, wherever the picture shows it.
    Background,
    /// The light on the subject of lights that aim at something else.
    Spill,
}

/// A wanted exposure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WishLevel {
    /// The f-number that a meter shows at the camera's ISO and shutter.
    FNumber(f32),
    /// Stops over the key.
    StopsOverKey(f32),
    /// White in the picture, at the least. Backgrounds only.
    White,
    /// Middle grey in the picture. Backgrounds only.
    MiddleGrey,
}

impl fmt::Display for WishLevel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            WishLevel::FNumber(number) => write!(f, "f/{number}"),
            WishLevel::StopsOverKey(stops) => write!(f, "{stops:+}"),
            WishLevel::White => write!(f, "white"),
            WishLevel::MiddleGrey => write!(f, "grey"),
        }
    }
}

impl WishLevel {
    /// Reads `f/8`, `+0.5`, `-1.5`, `0`, `white` or `grey`. None for anything else, and for levels that no studio has.
    pub fn parse(text: &str) -> Option<WishLevel> {
        let lower = text.trim().to_lowercase().replace('\u{2212}', "-");
        let number = |text: &str, range: std::ops::RangeInclusive<f32>| {
            text.trim().parse().ok().filter(|number| range.contains(number))
        };
        match lower.as_str() {
            "white" => Some(WishLevel::White),
            "grey" | "gray" => Some(WishLevel::MiddleGrey),
            _ if lower.starts_with('f') => {
                let text = lower.trim_start_matches('f').trim_start_matches('/');
                number(text, F_NUMBERS).map(WishLevel::FNumber)
            }
            // A bare number may be meant as either
            _ if lower.starts_with(['+', '-']) || lower == "0" => number(&lower, STOPS).map(WishLevel::StopsOverKey),
            _ => None,
        }
    }
}

/// A wish.
#[derive(Clone, Debug, PartialEq)]
pub struct Wish {
    /// Name of its light, role or place.
    pub name: String,
    /// What is metered.
    pub target: WishTarget,
    /// The wanted exposure.
    pub level: WishLevel,
}

/// A wish that cannot be understood.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WishError {
    /// Not `NAME=LEVEL`.
    #[error("{0:?} is not a wish: write NAME=LEVEL, such as Key=f/8, Fill=-1.5, Background=white")]
    NoLevel(String),
    /// No light, role or place of this name.
    #[error("{name:?} is no light, role or place of this studio: it has {known}")]
    UnknownName {
        /// The name.
        name: String,
        /// The names that there are.
        known: String,
    },
    /// Several lights contain the name.
    #[error("{name:?} may be {candidates}: write more of the name")]
    AmbiguousName {
        /// The name.
        name: String,
        /// The lights.
        candidates: String,
    },
    /// Neither an f-number, stops nor a tone.
    #[error("{level:?} of {name:?} is no level: write f/8, +0.5, -1.5, white or grey")]
    UnknownLevel {
        /// The name of its target.
        name: String,
        /// The level.
        level: String,
    },
    /// White or grey of something else than the background.
    #[error("only a background can be {level}: {name:?} takes an f-number or stops over the key")]
    ToneOfLight {
        /// The name of its target.
        name: String,
        /// The level.
        level: WishLevel,
    },
    /// Two wishes for one thing.
    #[error("there are two wishes for {0:?}")]
    Twice(String),
    /// A wish relative to a key that there is not.
    #[error("{level} for {name:?} is relative to the key, and no light is one: give it an f-number, such as f/8")]
    NoKey {
        /// The name of its target.
        name: String,
        /// The level.
        level: WishLevel,
    },
    /// A wish for the key relative to the key.
    #[error("{name:?} is the key, which others are relative to: give it an f-number, such as f/8")]
    RelativeKey {
        /// The name of the key.
        name: String,
    },
    /// A wish for all light at the subject relative to a key without a wish.
    #[error("{level} for the subject is relative to the key: give the key an f-number, too, or the subject one")]
    RelativeSubject {
        /// The level.
        level: WishLevel,
    },
    /// A light whose output has no dial.
    #[error("{0:?} has no dial: suns and surrounds stay as they are")]
    NoDial(String),
}

/// Reads wishes, separated by commas: `Key=f/8, Fill=-1.5, Background=white`.
///
/// A name is `subject` (or `face`), `background`, `spill`, a light, a role, or a part of a light's name, in any case of
/// letters. Lights of a role that are metered each by themselves (rim lights) have a wish each.
///
/// # Errors
/// When a name or level cannot be understood, or the wishes contradict each other.
pub fn wishes(text: &str, setup: &SetupTransport) -> Result<Vec<Wish>, WishError> {
    let mut wishes: Vec<Wish> = Vec::new();
    for (name, level) in named_levels(text)? {
        wishes.extend(targets(name, setup)?.into_iter().map(|(name, target)| Wish { name, target, level }));
    }
    check_wishes(&wishes, setup)?;
    Ok(wishes)
}

/// Reads the names and levels of wishes, as in [`wishes`], without a studio: names are not looked up.
///
/// # Errors
/// When a wish has no level, or one that cannot be understood.
pub fn named_levels(text: &str) -> Result<Vec<(&str, WishLevel)>, WishError> {
    text.split(',').map(str::trim).filter(|item| !item.is_empty()).map(named_level).collect()
}

/// Reads one wish: `Key=f/8`.
fn named_level(item: &str) -> Result<(&str, WishLevel), WishError> {
    let named = item.rsplit_once('=').filter(|(name, _)| !name.trim().is_empty());
    let (name, text) = named.ok_or_else(|| WishError::NoLevel(item.to_owned()))?;
    let unknown = || WishError::UnknownLevel { name: name.trim().to_owned(), level: text.trim().to_owned() };
    Ok((name.trim(), WishLevel::parse(text).ok_or_else(unknown)?))
}

/// Fails for wishes that contradict each other or have no meaning in a studio.
///
/// # Errors
/// For two wishes for one thing, a tone of something else than the background, and levels relative to a key that there
/// is not, or that is meant itself.
pub fn check_wishes(wishes: &[Wish], setup: &SetupTransport) -> Result<(), WishError> {
    for (index, wish) in wishes.iter().enumerate() {
        let is_tone = matches!(wish.level, WishLevel::White | WishLevel::MiddleGrey);
        if is_tone && wish.target != WishTarget::Background {
            return Err(WishError::ToneOfLight { name: wish.name.clone(), level: wish.level });
        }
        if wishes[..index].iter().any(|earlier| overlap(&earlier.target, &wish.target)) {
            return Err(WishError::Twice(wish.name.clone()));
        }
    }
    check_key(wishes, setup)
}

/// Returns the lights that wishes name.
pub fn named_lights(wishes: &[Wish]) -> HashSet<LightId> {
    let of_wish = |wish: &Wish| match &wish.target {
        WishTarget::Lights(lights) => lights.clone(),
        WishTarget::Subject | WishTarget::Background | WishTarget::Spill => Vec::new(),
    };
    wishes.iter().flat_map(of_wish).collect()
}

/// Fails for wishes relative to a key that is not there, or that is meant itself.
fn check_key(wishes: &[Wish], setup: &SetupTransport) -> Result<(), WishError> {
    let key = key_of(wishes, setup);
    for wish in wishes.iter().filter(|wish| is_relative(wish)) {
        let (name, level) = (wish.name.clone(), wish.level);
        let Some(key) = key else { return Err(WishError::NoKey { name, level }) };
        match &wish.target {
            WishTarget::Lights(lights) if lights.contains(&key) => return Err(WishError::RelativeKey { name }),
            // The key is a part of the subject's light: without a wish of its own it would follow itself
            WishTarget::Subject if !named_lights(wishes).contains(&key) => {
                return Err(WishError::RelativeSubject { level });
            }
            _ => {}
        }
    }
    Ok(())
}

fn is_relative(wish: &Wish) -> bool {
    matches!(wish.level, WishLevel::StopsOverKey(_))
}

/// Returns the light that wishes for stops are relative to.
pub fn key_of(wishes: &[Wish], setup: &SetupTransport) -> Option<LightId> {
    let relative: Vec<Wish> = wishes.iter().filter(|wish| is_relative(wish)).cloned().collect();
    setup.key_light(&named_lights(wishes), &named_lights(&relative))
}

fn overlap(a: &WishTarget, b: &WishTarget) -> bool {
    match (a, b) {
        (WishTarget::Lights(a), WishTarget::Lights(b)) => a.iter().any(|light| b.contains(light)),
        _ => a == b,
    }
}

/// Returns the targets of a name, with their names.
fn targets(name: &str, setup: &SetupTransport) -> Result<Vec<(String, WishTarget)>, WishError> {
    let lower = name.to_lowercase();
    if SUBJECT.contains(&lower.as_str()) {
        return Ok(vec![("Subject".to_owned(), WishTarget::Subject)]);
    }
    if lower == BACKGROUND && setup.has_background() {
        return Ok(vec![("Background".to_owned(), WishTarget::Background)]);
    }
    if lower == SPILL {
        return Ok(vec![("Spill".to_owned(), WishTarget::Spill)]);
    }
    let named = |is_match: &dyn Fn(&str) -> bool| -> Vec<&LightTransport> {
        setup.lights().iter().filter(|light| is_match(&light.name.to_lowercase())).collect()
    };
    let of_role = |role: &Role| role.label().to_lowercase() == lower;
    let mut lights = named(&|light| light == lower);
    if lights.is_empty()
        && let Some(role) = Role::ALL.into_iter().find(of_role)
    {
        let of = |role: Role| setup.lights().iter().filter(|light| light.role == role).collect::<Vec<_>>();
        lights = of(role);
        // A hair light is a rim light from above
        lights = match role {
            Role::Rim if lights.is_empty() => of(Role::Hair),
            Role::Hair if lights.is_empty() => of(Role::Rim),
            _ => lights,
        };
        // Lights that are off stay off if others of the role are on
        if lights.iter().any(|light| light.is_on) {
            lights.retain(|light| light.is_on);
        }
    }
    if lights.is_empty() {
        lights = named(&|light| light.contains(&lower));
        if lights.len() > 1 {
            let candidates = lights.iter().map(|light| format!("{:?}", light.name)).collect::<Vec<_>>().join(" or ");
            return Err(WishError::AmbiguousName { name: name.to_owned(), candidates });
        }
    }
    if let Some(fixed) = lights.iter().find(|light| !light.has_dial) {
        return Err(WishError::NoDial(fixed.name.clone()));
    }
    let (together, each): (Vec<&LightTransport>, Vec<_>) =
        lights.into_iter().partition(|light| light.at == MeteredAt::Subject);
    let group = match together.as_slice() {
        [] => None,
        [light] => Some((light.name.clone(), WishTarget::Lights(vec![light.light]))),
        lights => Some((name.to_owned(), WishTarget::Lights(lights.iter().map(|light| light.light).collect()))),
    };
    let each = each.into_iter().map(|light| (light.name.clone(), WishTarget::Lights(vec![light.light])));
    let targets: Vec<_> = group.into_iter().chain(each).collect();
    if targets.is_empty() {
        let lights = setup.lights().iter().map(|light| light.name.as_str());
        let places = ["subject", "spill"].into_iter().chain(setup.has_background().then_some(BACKGROUND));
        let known = lights.chain(places).collect::<Vec<_>>().join(", ");
        return Err(WishError::UnknownName { name: name.to_owned(), known });
    }
    Ok(targets)
}
