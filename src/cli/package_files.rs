//! `catchlight package-files DIR`: shell completions and man pages, for those who make packages.

use super::failure::Failure;
use anyhow::Context;
use clap::Command;
use clap_complete::{Shell, generate_to};
use std::fs;
use std::path::{Path, PathBuf};

/// Arguments of `package-files`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Folder to write to.
    folder: PathBuf,
}

/// Writes completions for Bash, Zsh and Fish, and a man page for the program and each of its commands.
pub fn run(arguments: &Arguments, program: Command) -> Result<(), Failure> {
    let (completions, man) = (arguments.folder.join("completions"), arguments.folder.join("man"));
    for folder in [&completions, &man] {
        fs::create_dir_all(folder).with_context(|| format!("can't make the folder {}", folder.display()))?;
    }
    let mut program = without_hidden(program);
    for shell in [Shell::Bash, Shell::Zsh, Shell::Fish] {
        let written = generate_to(shell, &mut program, "catchlight", &completions);
        written.with_context(|| format!("can't write the completions to {}", completions.display()))?;
    }
    write_man_pages(program, &man).with_context(|| format!("can't write the man pages to {}", man.display()))?;
    Ok(())
}

/// Returns the program without the commands that only its developers use.
fn without_hidden(program: Command) -> Command {
    let about = program.get_about().cloned().unwrap_or_default();
    let arguments: Vec<_> = program.get_arguments().cloned().collect();
    let commands: Vec<_> = program.get_subcommands().filter(|command| !command.is_hide_set()).cloned().collect();
    Command::new(env!("CARGO_PKG_NAME"))
        .about(about)
        .version(env!("CARGO_PKG_VERSION"))
        .args(arguments)
        .subcommands(commands)
        .args_conflicts_with_subcommands(true)
        .disable_help_subcommand(true)
}

/// Writes `catchlight.1`, and `catchlight-COMMAND.1` for each command.
fn write_man_pages(mut program: Command, folder: &Path) -> anyhow::Result<()> {
    program.build();
    let commands: Vec<Command> = program.get_subcommands().cloned().collect();
    let pages = std::iter::once(program).chain(commands.into_iter().map(|command| {
        let name = format!("catchlight-{}", command.get_name());
        command.bin_name(name.replacen('-', " ", 1)).display_name(name)
    }));
    for page in pages {
        let name = page.get_display_name().unwrap_or_else(|| page.get_name()).to_owned();
        let mut text = Vec::new();
        clap_mangen::Man::new(page).manual("Catchlight").render(&mut text)?;
        fs::write(folder.join(format!("{name}.1")), text)?;
    }
    Ok(())
}
