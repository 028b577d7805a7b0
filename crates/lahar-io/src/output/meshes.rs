//! `meshes/MATERIAL/000000.ply`: surfaces, one folder per material, and a list by time for ParaView.

use std::fs;
use std::path::{Path, PathBuf};

use super::frame_name;
use crate::export::{MeshFormat, TimeSeries, Triangles};
use crate::files::{Durability, OutputError, file_name, make_folder, write_whole};

/// Sequences of meshes, one per material.
#[derive(Debug)]
pub struct MeshFiles {
    folder: PathBuf,
    formats: Vec<MeshFormat>,
    /// For each material, the list of its VTK files by time; empty if VTK is not written.
    series: Vec<(String, TimeSeries)>,
}

impl MeshFiles {
    /// Makes `folder`, and in it one folder for each of `materials`. Meshes that are there already are replaced.
    ///
    /// # Errors
    /// If a folder cannot be made.
    pub fn create(
        folder: &Path,
        materials: &[&str],
        formats: &[MeshFormat],
    ) -> Result<Self, OutputError> {
        fs::create_dir_all(folder).map_err(OutputError::at(folder))?;
        let mut series = Vec::new();
        for material in materials {
            let name = file_name(material);
            make_folder(&folder.join(&name))?;
            if formats.contains(&MeshFormat::Vtk) {
                let path = folder.join(format!("{name}.pvd"));
                let list = TimeSeries::start(&path, 0).map_err(OutputError::at(&path))?;
                series.push(((*material).to_owned(), list));
            }
        }
        Ok(Self {
            folder: folder.to_owned(),
            formats: formats.to_owned(),
            series,
        })
    }

    /// Returns the folder of a material's meshes.
    pub fn folder_of(&self, material: &str) -> PathBuf {
        self.folder.join(file_name(material))
    }

    /// Writes the mesh of a material in frame `frame`, at the time `time` \[s\].
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(
        &mut self,
        material: &str,
        frame: u64,
        time: f64,
        mesh: Triangles<'_>,
    ) -> Result<(), OutputError> {
        for &format in &self.formats {
            let name = frame_name(frame, format.ending());
            let own = file_name(material);
            let path = self.folder.join(&own).join(&name);
            write_whole(&path, Durability::Eventual, |writer| {
                format.write(writer, mesh, time)
            })?;
            let list = (self.series.iter_mut()).find(|(of, _)| of == material);
            if let Some((_, list)) = list.filter(|_| format == MeshFormat::Vtk) {
                (list.push(time, &format!("{own}/{name}")))
                    .map_err(OutputError::at(list.path()))?;
            }
        }
        Ok(())
    }
}
