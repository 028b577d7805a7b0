//! `lahar mesh`: makes surfaces around the particles of a run, one file per material and frame.

use std::process::ExitCode;

use lahar::{Data, Field, Snapshot};
use lahar_io::export::MeshFormat;
use lahar_io::files::output_folder;
use lahar_io::output::{MeshFiles, Recording};
use lahar_io::surface::{Style, Surface};

use crate::error::CliError;
use crate::recorded_frames;
use crate::{args, terminal};

/// Makes the meshes of `args.recorded.run`.
pub(crate) fn mesh(args: &args::Mesh) -> Result<ExitCode, CliError> {
    let recording = recorded_frames::open(&args.recorded.run)?;
    if recording.record().dimension != 3 {
        return Err(CliError::Usage(format!(
            "{} is a run in 2D; only runs in 3D have surfaces",
            recording.folder().display()
        )));
    }
    let materials = materials(&recording, &args.materials)?;
    let formats = formats(&args.format)?;
    let style = Style {
        cube: args.cube,
        smoothing: args.smoothing,
    };
    let default = recording.folder().join("meshes");
    let folder = output_folder(args.output.as_deref(), default)?;
    let names: Vec<&str> = materials.iter().map(|(_, name)| name.as_str()).collect();
    let mut files = MeshFiles::create(&folder, &names, &formats)?;
    let completion =
        recorded_frames::each(&recording, args.recorded.frames, |number, snapshot| {
            let mut triangles = 0;
            for (index, name) in &materials {
                let (positions, volume) = particles(snapshot, *index).map_err(CliError::Usage)?;
                let surface = Surface::around(&positions, volume, style)
                    .map_err(|error| CliError::Usage(format!("frame {number}, {name}: {error}")))?;
                triangles += surface.triangles.len();
                files.write(name, number, snapshot.time, surface.as_triangles())?;
            }
            Ok(format!("t = {:.3} s  {triangles} triangles", snapshot.time))
        })?;
    for name in names {
        terminal::print(&format!("  {}/\n", files.folder_of(name).display()));
    }
    Ok(completion.exit_code())
}

/// Returns the chosen materials, or all without a choice, with their numbers in the scene.
fn materials(recording: &Recording, chosen: &[String]) -> Result<Vec<(u32, String)>, CliError> {
    let materials = recording.record().view().materials;
    let all: Vec<(u32, String)> = (0..)
        .zip(materials.into_iter().map(|material| material.name))
        .collect();
    if let Some(unknown) = (chosen.iter()).find(|name| !all.iter().any(|(_, own)| own == *name)) {
        let names: Vec<&str> = all.iter().map(|(_, name)| name.as_str()).collect();
        return Err(CliError::Usage(format!(
            "there is no material \"{unknown}\" in this run; there are {}",
            names.join(", ")
        )));
    }
    Ok(all
        .into_iter()
        .filter(|(_, name)| chosen.is_empty() || chosen.contains(name))
        .collect())
}

fn formats(names: &[String]) -> Result<Vec<MeshFormat>, CliError> {
    let format = |name: &String| {
        MeshFormat::named(name).ok_or_else(|| {
            let names = MeshFormat::ALL.map(MeshFormat::name).join(", ");
            CliError::Usage(format!(
                "there is no mesh format \"{name}\"; there are {names}"
            ))
        })
    };
    names.iter().map(format).collect()
}

/// Returns the positions \[m\] of the particles of a material, and the mean of their present volumes \[m³\].
fn particles(snapshot: &Snapshot, material: u32) -> Result<(Vec<[f64; 3]>, f64), String> {
    let field = |field: Field| {
        snapshot.get(field).map(Data::to_f64).ok_or_else(|| {
            format!(
                "the frames have no \"{}\"; run the scene again with position, material and volume0 among output.fields",
                field.info().name
            )
        })
    };
    let (positions, volume0) = (field(Field::Position)?, field(Field::Volume0)?);
    let jacobian = snapshot.get(Field::Jacobian).map(Data::to_f64);
    let materials = field(Field::Material)?;
    let (mut chosen, mut volume) = (Vec::new(), 0.0);
    for (row, of) in materials.iter().enumerate() {
        if *of == f64::from(material) {
            chosen.push([0, 1, 2].map(|axis| positions[3 * row + axis]));
            volume += volume0[row] * jacobian.as_ref().map_or(1.0, |jacobian| jacobian[row]);
        }
    }
    let mean = match chosen.len() {
        // Without particles there is no surface, so any volume will do.
        0 => 1.0,
        count => volume / count as f64,
    };
    Ok((chosen, mean))
}
