//! Triangle meshes from STL (text and binary) and OBJ files. Every error carries its place.

use crate::error::SceneError;
use crate::text::{Lines, not_text, shorten};
use lahar::geometry::{Mesh, MeshError};

/// Vertices \[m\], and triangles by the numbers of their corners.
type Triangles = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// Reads a mesh file: `bytes` is its content, and the ending of `name` says which format it has.
///
/// # Errors
/// The first part of the file that is malformed, or the reason why the mesh encloses no body.
pub(crate) fn parse_mesh(bytes: &[u8], name: &str) -> Result<Mesh, SceneError> {
    let lower = name.to_ascii_lowercase();
    let (vertices, faces) = if lower.ends_with(".stl") {
        parse_stl(bytes, name)?
    } else if lower.ends_with(".obj") {
        parse_obj(text(bytes, name)?, name)?
    } else {
        return Err(SceneError::of_file(name, "a mesh is an .stl or .obj file"));
    };
    Mesh::new(vertices, faces).map_err(|error| match error {
        MeshError::Empty => SceneError::of_file(name, "there is no triangle in this mesh"),
        MeshError::Open { edges, face } => SceneError::of_file(
            name,
            format!("this mesh is not closed: {edges} edges have a hole on one side, the first at face {face} (from 0)"),
        )
        .hint("only closed surfaces have an inside; fill its holes in the program that made it"),
    })
}

fn text<'a>(bytes: &'a [u8], name: &str) -> Result<&'a str, SceneError> {
    core::str::from_utf8(bytes).map_err(|error| not_text(name, bytes, error.valid_up_to()))
}

/// Bytes of a binary STL file before its triangles, and bytes per triangle.
const STL_HEADER: usize = 84;
const STL_TRIANGLE: usize = 50;

fn parse_stl(bytes: &[u8], name: &str) -> Result<Triangles, SceneError> {
    let fail = |message: String| SceneError::of_file(name, message);
    let promised = bytes
        .get(STL_HEADER - 4..STL_HEADER)
        .map(|n| u32::from_le_bytes([n[0], n[1], n[2], n[3]]) as usize);
    let whole = |n: usize| bytes.len() == STL_HEADER + STL_TRIANGLE * n;
    // Binary files may begin with "solid" too; their length tells them apart.
    let is_text = bytes.trim_ascii_start().starts_with(b"solid") && !promised.is_some_and(whole);
    if is_text {
        return parse_text_stl(text(bytes, name)?, name);
    }
    let Some(promised) = promised else {
        return Err(fail(
            "this is no STL file: it is too short, and does not begin with \"solid\"".to_owned(),
        ));
    };
    let there = (bytes.len() - STL_HEADER) / STL_TRIANGLE;
    if there < promised {
        return Err(fail(format!(
            "the header promises {promised} triangles, the file ends after {there}"
        ))
        .hint("was the file cut short?"));
    }
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    let triangles = bytes[STL_HEADER..].chunks_exact(STL_TRIANGLE);
    for (index, triangle) in triangles.take(promised).enumerate() {
        // The normal, three corners, two unused bytes.
        for corner in triangle[12..48].chunks_exact(12) {
            let number = |i: usize| {
                let b = &corner[4 * i..4 * i + 4];
                f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
            };
            let vertex = [number(0), number(1), number(2)];
            if let Some(bad) = vertex.iter().find(|x| !x.is_finite()) {
                return Err(fail(format!(
                    "triangle {index} (from 0) has a corner at {bad}"
                )));
            }
            vertices.push(vertex);
        }
        let first = 3 * index as u32;
        faces.push([first, first + 1, first + 2]);
    }
    Ok((vertices, faces))
}

/// Reads three numbers; an error points at the word in `line`.
fn parse_vertex(words: &[&str], whole: &str, name: &str) -> Result<[f64; 3], SceneError> {
    let mut vertex = [0.0; 3];
    for (x, word) in vertex.iter_mut().zip(words) {
        let message = match word.parse::<f64>() {
            Ok(number) if number.is_finite() => {
                *x = number;
                continue;
            }
            Ok(number) => format!("a corner cannot be at {number}"),
            Err(_) => format!("\"{}\" is not a number", shorten(word)),
        };
        return Err(at_word(word, whole, name, message));
    }
    Ok(vertex)
}

/// Makes an error that points at `word`, a part of `whole`.
fn at_word(word: &str, whole: &str, name: &str, message: impl Into<String>) -> SceneError {
    let at = word.as_ptr() as usize - whole.as_ptr() as usize;
    SceneError::at(name, whole, at, at + word.len(), message)
}

fn parse_text_stl(text: &str, name: &str) -> Result<Triangles, SceneError> {
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    let mut in_facet = 0;
    let mut ended = false;
    for (_, line) in (Lines { text, at: 0 }) {
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        match words[..] {
            ["vertex", x, y, z] => {
                vertices.push(parse_vertex(&[x, y, z], text, name)?);
                in_facet += 1;
            }
            ["endfacet", ..] => {
                if in_facet != 3 {
                    let message = format!("this facet has {in_facet} corners; 3 are needed");
                    return Err(at_word(words[0], text, name, message));
                }
                let first = vertices.len() as u32 - 3;
                faces.push([first, first + 1, first + 2]);
                in_facet = 0;
            }
            ["endsolid", ..] => ended = true,
            [] | ["solid" | "facet" | "outer" | "endloop", ..] => ended = false,
            [word, ..] => {
                return Err(at_word(
                    word,
                    text,
                    name,
                    format!("\"{}\" is not expected in an STL file", shorten(word)),
                ));
            }
        }
    }
    if !ended {
        return Err(SceneError::of_file(
            name,
            format!(
                "the file ends after {} triangles, without \"endsolid\"",
                faces.len()
            ),
        )
        .hint("was the file cut short?"));
    }
    Ok((vertices, faces))
}

fn parse_obj(text: &str, name: &str) -> Result<Triangles, SceneError> {
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for (start, line) in (Lines { text, at: 0 }) {
        let line = line.split('#').next().unwrap_or_default();
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let whole_line =
            |message: &str| SceneError::at(name, text, start, start + line.len(), message);
        match words[..] {
            ["v", x, y, z, ..] => vertices.push(parse_vertex(&[x, y, z], text, name)?),
            ["v", ..] => return Err(whole_line("a vertex needs three numbers")),
            ["f", ref corners @ ..] => {
                if corners.len() < 3 {
                    return Err(whole_line("a face needs three corners or more"));
                }
                let corners = corners
                    .iter()
                    .map(|word| corner(word, vertices.len(), text, name))
                    .collect::<Result<Vec<u32>, _>>()?;
                // A fan of triangles: faces with more corners are taken to be flat and convex.
                for pair in corners[1..].windows(2) {
                    faces.push([corners[0], pair[0], pair[1]]);
                }
            }
            // Normals, textures, groups and materials are skipped.
            _ => {}
        }
    }
    Ok((vertices, faces))
}

/// Reads a corner of a face, "3", "3/1/2" or "-1": the number of its vertex, counted from 0.
fn corner(word: &str, vertices: usize, text: &str, name: &str) -> Result<u32, SceneError> {
    let number = word.split('/').next().and_then(|n| n.parse::<i64>().ok());
    let index = match number {
        Some(n) if n > 0 => usize::try_from(n - 1).ok(),
        Some(n) if n < 0 => usize::try_from(n.unsigned_abs())
            .ok()
            .and_then(|back| vertices.checked_sub(back)),
        _ => None,
    };
    index
        .filter(|index| *index < vertices)
        .and_then(|index| u32::try_from(index).ok())
        .ok_or_else(|| {
            let message = format!("there is no vertex \"{}\"", shorten(word));
            at_word(word, text, name, message).hint(format!("there are {vertices} so far"))
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A tetrahedron with a corner at 0 and edges of length 1 along the axes.
    const OBJ: &str = "# a corner\nv 0 0 0\nv 1 0 0 # x\nv 0 1 0\nv 0 0 1\nvn 0 0 1\n\
        f 1 3 2\nf 1/1/1 2/2/2 4/3/3\nf -4 -1 -2\nf 2//1 3//1 4//1\n";

    fn corners() -> Vec<[[f64; 3]; 3]> {
        let (vertices, faces) = parse_obj(OBJ, "a.obj").unwrap();
        faces
            .iter()
            .map(|f| f.map(|c| vertices[c as usize]))
            .collect()
    }

    fn text_stl() -> String {
        let mut text = "solid corner\n".to_owned();
        for triangle in corners() {
            text += "facet normal 0 0 0\n outer loop\n";
            for [x, y, z] in triangle {
                text += &format!("  vertex {x} {y} {z:e}\n");
            }
            text += " endloop\nendfacet\n";
        }
        text + "endsolid corner\n"
    }

    fn binary_stl() -> Vec<u8> {
        let mut bytes = b"solid but binary".to_vec();
        bytes.resize(80, 0);
        bytes.extend((corners().len() as u32).to_le_bytes());
        for triangle in corners() {
            bytes.extend([0; 12]);
            for x in triangle.as_flattened() {
                bytes.extend((*x as f32).to_le_bytes());
            }
            bytes.extend([0; 2]);
        }
        bytes
    }

    #[test]
    fn three_formats_one_body() {
        for (bytes, name) in [
            (OBJ.as_bytes().to_vec(), "a.obj"),
            (text_stl().into_bytes(), "a.STL"),
            (text_stl().replace('\n', "\r\n").into_bytes(), "a.stl"),
            (binary_stl(), "a.stl"),
        ] {
            let mesh = parse_mesh(&bytes, name).unwrap();
            assert_eq!(mesh.faces(), 4);
            assert!(
                mesh.contains([0.2, 0.2, 0.2]) && !mesh.contains([0.5, 0.5, 0.5]),
                "{name}"
            );
        }
    }

    #[test]
    fn what_is_wrong_is_pointed_at() {
        let place = |text: &str, name: &str| {
            let error = parse_mesh(text.as_bytes(), name).unwrap_err();
            (error.line, error.column, error.message)
        };
        let obj = |from: &str, to: &str| place(&OBJ.replacen(from, to, 1), "a.obj");
        assert_eq!(obj("v 1 0 0", "v 1 nan 0").1, 5);
        assert_eq!(obj("v 1 0 0", "v 1 0,5 0").2, "\"0,5\" is not a number");
        assert_eq!(
            (obj("f 1 3 2", "f 1 9 2").0, obj("f 1 3 2", "f 1 9 2").1),
            (7, 5)
        );
        assert_eq!(obj("f 1 3 2", "f 1 0 2").1, 5);
        assert_eq!(obj("f 1 3 2", "f 1 3").0, 7);
        assert!(obj("f 1 3 2\n", "").2.contains("3 edges"));
        assert!(place("", "a.obj").2.contains("no triangle"));
        let stl = |from: &str, to: &str| place(&text_stl().replacen(from, to, 1), "a.stl");
        assert_eq!(stl("  vertex 1 0 0e0", "  vertex 1 0 inf").1, 14);
        assert_eq!(stl("endfacet", "endfacets").0, 8);
        assert!(
            stl("endsolid corner", "")
                .2
                .contains("without \"endsolid\"")
        );
        let cut = |bytes: &[u8]| parse_mesh(bytes, "a.stl").unwrap_err().message;
        let mut bytes = binary_stl();
        bytes[0] = b'S';
        assert!(cut(&bytes[..200]).contains("promises 4 triangles, the file ends after 2"));
        assert!(cut(&bytes[..50]).contains("too short"));
        bytes[84 + 12..84 + 16].copy_from_slice(&f32::NAN.to_le_bytes());
        assert!(cut(&bytes).contains("NaN"));
        assert!(place("x", "a.fbx").2.contains(".stl or .obj"));
    }

    proptest! {
        #[test]
        fn altered_files_never_panic(at in 0_usize..1000, byte in any::<u8>(), len in 0_usize..1000) {
            for (mut bytes, name) in [
                (OBJ.as_bytes().to_vec(), "a.obj"),
                (text_stl().into_bytes(), "a.stl"),
                (binary_stl(), "a.stl"),
            ] {
                let at = at % bytes.len();
                bytes[at] = byte;
                bytes.truncate(1 + len);
                drop(parse_mesh(&bytes, name));
            }
        }

        #[test]
        fn junk_never_panics(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
            drop(parse_mesh(&bytes, "a.stl"));
            drop(parse_mesh(&bytes, "a.obj"));
        }
    }
}
