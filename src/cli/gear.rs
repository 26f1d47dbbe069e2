//! `catchlight gear`: lists heads, modifiers, stands and booms.

use super::failure::Failure;
use super::terminal;
use crate::gear::{GearList, SupportKind};
use crate::io;
use crate::photo::dial_text;
use anyhow::anyhow;
use std::path::{Path, PathBuf};

/// Arguments of `gear`.
///
/// Prints the heads with their full power, their dial from lowest to full, and where the figures are from; then
/// modifiers, stands and booms. What you own is counted.
///
/// Your own list is the file gear.ron in the settings folder (on Linux ~/.config/catchlight). It has the form of
/// assets/gear/gear.ron in the source; its entries replace those of the same name, and `owned: 2` counts what you own.
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Arguments {
    /// Your list of gear [default: gear.ron in the settings folder].
    #[arg(long, value_name = "FILE")]
    gear: Option<PathBuf>,
}

/// Prints the list.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let own = match &arguments.gear {
        Some(path) => read_list(path)?,
        None => io::settings_folder()
            .map(|folder| io::read_gear(&io::own_gear_path(&folder)))
            .transpose()?
            .unwrap_or_default(),
    };
    print(&io::bundled_gear().with(&own));
    Ok(())
}

/// Reads a list that the user named.
///
/// # Errors
/// If there is no such file, or it is no list of gear.
pub fn read_list(path: &Path) -> Result<GearList, Failure> {
    if !path.exists() {
        return Err(anyhow!("there is no list of gear {}", path.display()).into());
    }
    Ok(io::read_gear(path)?)
}

fn print(gear: &GearList) {
    let owned = |count: u32| if count > 0 { format!("{count} x ") } else { String::new() };
    let weight = |kg: Option<f32>| kg.map(|kg| format!(", {kg:.1} kg")).unwrap_or_default();
    terminal::result(format_args!("Heads"));
    for model in &gear.heads {
        let dial = &model.head.dial;
        let range = [dial.lowest_stops, 0.0].map(|stops| dial_text(dial, stops)).join(" to ");
        terminal::result(format_args!(
            "  {}{}: {}, dial {range}, {:.0} K{}. Source: {}",
            owned(model.owned),
            model.head.name,
            model.power_text(),
            model.kelvin,
            weight(model.weight_kg),
            model.source
        ));
    }
    terminal::result(format_args!("Modifiers"));
    for model in &gear.modifiers {
        let loss = model.modifier.loss_stops + model.modifier.scrim_stops;
        terminal::result(format_args!(
            "  {}{}: takes {loss:.1} stops{}. Source: {}",
            owned(model.owned),
            model.name,
            weight(model.weight_kg),
            model.source
        ));
    }
    terminal::result(format_args!("Stands and booms"));
    for support in &gear.supports {
        let kind = match support.kind {
            SupportKind::Stand => "stand",
            SupportKind::Boom => "boom",
        };
        terminal::result(format_args!(
            "  {}{}: {kind}, reaches {:.1} m, carries {:.1} kg. Source: {}",
            owned(support.owned),
            support.name,
            support.reach_m,
            support.load_kg,
            support.source
        ));
    }
}
