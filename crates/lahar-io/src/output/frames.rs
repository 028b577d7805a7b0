//! `frames/000000.npz` and the like: the particles of one frame.

use std::path::Path;

use lahar::Snapshot;

use crate::export::Format;
use crate::files::{Durability, OutputError, write_whole};

/// Returns the name of a frame's file: `000000.npz` for frame 0 and the ending `npz`.
pub fn frame_name(index: u64, ending: &str) -> String {
    format!("{index:06}.{ending}")
}

/// Writes the fields that `snapshot` has to a file, whole or not at all.
///
/// # Errors
/// If the file cannot be written.
pub fn write_frame(path: &Path, snapshot: &Snapshot, format: Format) -> Result<(), OutputError> {
    write_whole(path, Durability::Eventual, |writer| {
        format.write(writer, snapshot)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use lahar::{Data, Field};

    #[test]
    fn a_frame_reads_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(frame_name(7, "npz"));
        let snapshot = Snapshot {
            time: 0.5,
            dimension: 3,
            count: 1,
            columns: vec![
                (Field::Id, Data::U32(vec![4])),
                (Field::Position, Data::F64(vec![1.0, 2.0, 3.0])),
                (Field::Affine, Data::F32((0..9_u8).map(f32::from).collect())),
            ],
        };
        write_frame(&path, &snapshot, Format::Npz).unwrap();
        let arrays = lahar_scene::npz::read(&path).unwrap();
        let names: Vec<_> = arrays
            .iter()
            .map(|a| (a.name.as_str(), a.shape.as_slice()))
            .collect();
        assert_eq!(
            names,
            [
                ("position", [1, 3].as_slice()),
                ("affine", &[1, 3, 3]),
                ("id", &[1]),
                ("time", &[])
            ]
        );
        assert_eq!(arrays[3].data, Data::F64(vec![0.5]));
        let files: Vec<_> = std::fs::read_dir(folder.path())
            .unwrap()
            .map(|e| e.unwrap().file_name())
            .collect();
        assert_eq!(files, ["000007.npz"], "no partial file stays");
    }

    #[test]
    fn a_folder_that_is_not_there_is_named() {
        let path = Path::new("no/such/folder/000000.npz");
        let snapshot = Snapshot {
            time: 0.0,
            dimension: 2,
            count: 0,
            columns: vec![],
        };
        let error = write_frame(path, &snapshot, Format::Npz).unwrap_err();
        assert!(
            error
                .to_string()
                .starts_with("no/such/folder/000000.npz: cannot write"),
            "{error}"
        );
    }
}
