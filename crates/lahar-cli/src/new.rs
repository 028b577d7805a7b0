//! `lahar new`: writes a scene file to start from, and never overwrites a file.

use std::fs::{self, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use lahar_lab::shell;
use lahar_scene::builtin::{self, Builtin};

use crate::error::CliError;
use crate::{args, terminal};

/// Writes a commented dam break, or the built-in scene that `args.from` names and the files that it needs.
pub(crate) fn new(args: &args::New) -> Result<ExitCode, CliError> {
    let path = &args.file;
    let scene = args.from.as_deref().map(find).transpose()?;
    let missing = match scene {
        Some(scene) => missing_files(scene, path)?,
        None => Vec::new(),
    };
    write_new(path, scene.map_or(builtin::starter(), |scene| scene.text))?;
    for (file, text) in &missing {
        write_new(file, text)?;
    }

    let mut written = path.display().to_string();
    for (file, _) in &missing {
        written += &format!(" and {}", file.display());
    }
    let shown = shell::quoted_path(path);
    terminal::note(&format!(
        "wrote {written}\nlook at it with: lahar view {shown}\nrun it with:     lahar run {shown}"
    ));
    Ok(ExitCode::SUCCESS)
}

fn find(name: &str) -> Result<&'static Builtin, CliError> {
    builtin::find(name).ok_or_else(|| {
        CliError::Usage(format!(
            "there is no built-in scene \"{name}\"; `lahar list` shows all"
        ))
    })
}

/// The files that `scene` names and that do not exist beside `path` yet, with their contents. A file with other
/// contents in such a place is an error.
fn missing_files(scene: &Builtin, path: &Path) -> Result<Vec<(PathBuf, &'static str)>, CliError> {
    let mut missing = Vec::new();
    for (name, text) in scene.files {
        let file = path.with_file_name(name);
        match fs::read(&file) {
            Ok(existing) if existing == text.as_bytes() => {}
            Ok(_) => return Err(refused(&file, &ErrorKind::AlreadyExists.into())),
            Err(error) if error.kind() == ErrorKind::NotFound => missing.push((file, *text)),
            Err(error) => return Err(refused(&file, &error)),
        }
    }
    Ok(missing)
}

/// Writes a file that must not exist yet.
fn write_new(path: &Path, text: &str) -> Result<(), CliError> {
    OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(path)
        .and_then(|mut file| file.write_all(text.as_bytes()))
        .map_err(|error| refused(path, &error))
}

fn refused(path: &Path, error: &io::Error) -> CliError {
    let shown = path.display();
    CliError::Usage(match error.kind() {
        ErrorKind::AlreadyExists => format!("{shown} already exists and was left as it is"),
        ErrorKind::NotFound => format!("there is no folder for {shown}"),
        _ => format!("{shown} cannot be written: {error}"),
    })
}
