//! `catchlight import MODEL -o SCENE.ron`: makes a studio of a model.

use super::failure::Failure;
use super::terminal;
use crate::io::{self, AssetFiles};
use crate::scene::{self, Assets, Severity};
use anyhow::{Context, anyhow};
use std::path::{Path, PathBuf};

/// Arguments of `import`.
///
/// The model stands on a grey sweep under a softbox, and the camera shows all of it. Lamps and a camera of the file are
/// taken over instead: their candela and lux are those of the file. A model that lies elsewhere is copied beside the
/// studio, with its data and textures.
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Arguments {
    /// The model.
    #[arg(help = format!("The model: {}", io::model_extension_list()))]
    model: PathBuf,
    /// The studio to write, a .ron file.
    #[arg(short, long, value_name = "SCENE.ron")]
    output: PathBuf,
}

/// Runs `import`.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { model, output } = arguments;
    if output.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("ron")) {
        return Err(Failure::Input(anyhow!("a studio is a .ron file, not {}", output.display())));
    }
    let folder = output.parent().unwrap_or(Path::new(""));
    let imported = io::import_model(model).context("can't import the model")?;
    let studio = io::studio_of(imported, model, folder).context("can't import the model")?;
    studio.notes.iter().for_each(terminal::warning);
    if let Some(error) = scene::validate(&studio.scene).into_iter().find(|f| f.severity == Severity::Error) {
        return Err(Failure::Input(anyhow!("can't make a studio of the model: {}: {}", error.place, error.message)));
    }
    let files = AssetFiles { folder: None, imported: &studio.imported };
    let (copies, _) = files.copies_into(folder, &studio.scene, &Assets::default());
    for copy in copies {
        copy.make().context("can't copy the model beside the studio")?;
    }
    io::save_scene(&studio.scene, output)?;
    terminal::progress(format_args!("the studio is written to {}", output.display()));
    Ok(())
}
