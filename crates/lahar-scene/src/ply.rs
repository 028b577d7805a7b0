//! Particles from PLY files: text, or binary of either byte order.
//!
//! The particles are the elements `vertex`. Properties with the names of columns of a CSV particle list are
//! read; others (colors, normals, lists) are skipped, and so is `z` in 2D.

use crate::error::SceneError;
use crate::particle_list::{
    Column, ParticleList, check_columns, check_number, known_columns, parse_number,
};
use crate::text::{Lines, not_text};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Text,
    LittleEndian,
    BigEndian,
}

/// Types of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Type {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

const TYPES: &[(&str, &str, Type)] = &[
    ("char", "int8", Type::I8),
    ("uchar", "uint8", Type::U8),
    ("short", "int16", Type::I16),
    ("ushort", "uint16", Type::U16),
    ("int", "int32", Type::I32),
    ("uint", "uint32", Type::U32),
    ("float", "float32", Type::F32),
    ("double", "float64", Type::F64),
];

impl Type {
    fn find(name: &str) -> Option<Self> {
        let is = |known: &&(&str, &str, Self)| known.0 == name || known.1 == name;
        TYPES.iter().find(is).map(|known| known.2)
    }

    fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// Decodes a number from its bytes.
    fn read(self, bytes: &[u8], format: Format) -> f64 {
        let mut little = [0; 8];
        let n = self.bytes();
        little[..n].copy_from_slice(bytes);
        if format == Format::BigEndian {
            little[..n].reverse();
        }
        let [a, b, c, d, ..] = little;
        match self {
            Self::I8 => f64::from(a as i8),
            Self::U8 => f64::from(a),
            Self::I16 => f64::from(i16::from_le_bytes([a, b])),
            Self::U16 => f64::from(u16::from_le_bytes([a, b])),
            Self::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            Self::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            Self::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            Self::F64 => f64::from_le_bytes(little),
        }
    }
}

#[derive(Clone, Debug)]
struct Property {
    name: String,
    /// The type of the length, for a list.
    length: Option<Type>,
    kind: Type,
}

impl Property {
    /// Reads a property from the words of its type and its name.
    fn parse(types: &[&str], name: &str) -> Option<Self> {
        let (length, kind) = match types {
            ["list", length, kind] => (Some(Type::find(length)?), kind),
            [kind] => (None, kind),
            _ => return None,
        };
        Some(Self {
            name: name.to_owned(),
            length,
            kind: Type::find(kind)?,
        })
    }
}

#[derive(Clone, Debug)]
struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

struct Header {
    format: Format,
    elements: Vec<Element>,
    /// The byte at which the numbers begin.
    body: usize,
}

/// Longest header \[bytes\].
const LONGEST_HEADER: usize = 1 << 20;

/// Reads the particles of a PLY file. `name` is the file's, for messages.
///
/// ```
/// let file = b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n0.5 0.25\n";
/// let list = lahar_scene::ply::parse_ply::<2>(file, "one.ply")?;
/// assert_eq!(list.position, [[0.5, 0.25]]);
/// # Ok::<(), lahar_scene::error::SceneError>(())
/// ```
///
/// # Errors
/// The first part that disagrees with the header, or a value that particles cannot have.
pub fn parse_ply<const D: usize>(bytes: &[u8], name: &str) -> Result<ParticleList<D>, SceneError> {
    let header = parse_header(bytes, name)?;
    let fail = |message: String| SceneError::of_file(name, message);
    let before = header
        .elements
        .iter()
        .position(|element| element.name == "vertex")
        .ok_or_else(|| {
            fail("there is no element \"vertex\" in the header".to_owned())
                .hint("particles are the vertices of a PLY file")
        })?;
    let vertex = &header.elements[before];
    let known = known_columns::<D>();
    let column = |property: &Property| {
        let name = match property.name.as_str() {
            "volume0" => "volume",
            name => name,
        };
        let found = known.iter().find(|(known, _)| known == name);
        found
            .map(|(_, column)| *column)
            .filter(|_| property.length.is_none())
    };
    let mut columns: Vec<Option<Column>> = vertex.properties.iter().map(column).collect();
    if columns.contains(&Some(Column::Gradient(0, 0))) {
        // Frames have both J and F. F carries more.
        for column in &mut columns {
            column.take_if(|column| *column == Column::Jacobian);
        }
    }
    let given: Vec<Column> = columns.iter().flatten().copied().collect();
    if let Some(twice) = (1..given.len()).find(|&i| given[..i].contains(&given[i])) {
        let (name, _) = known
            .iter()
            .find(|(_, c)| *c == given[twice])
            .expect("it is known");
        return Err(fail(format!("the property \"{name}\" is there twice")));
    }
    check_columns::<D>(&given).map_err(|message| {
        fail(message.replace("column", "property"))
            .hint("x, y (z), vx, vy (vz), volume, mass, J, F11, .. are read")
    })?;
    let mut list = ParticleList::default();
    let wanted = (before, vertex, &columns[..], &given[..]);
    if header.format == Format::Text {
        read_text(bytes, name, &header, wanted, &mut list)?;
    } else {
        read_binary(bytes, name, &header, wanted, &mut list)?;
    }
    Ok(list)
}

/// Index of the vertex element, the element, the column of each property, and the columns that are known.
type Wanted<'a> = (usize, &'a Element, &'a [Option<Column>], &'a [Column]);

fn read_text<const D: usize>(
    bytes: &[u8],
    name: &str,
    header: &Header,
    (before, vertex, columns, given): Wanted<'_>,
    list: &mut ParticleList<D>,
) -> Result<(), SceneError> {
    let text =
        core::str::from_utf8(bytes).map_err(|error| not_text(name, bytes, error.valid_up_to()))?;
    let mut lines = Lines {
        text,
        at: header.body,
    }
    .filter(|(_, line)| !line.trim().is_empty());
    let counts = header.elements[..before].iter().map(|e| e.count);
    let skipped = counts.fold(0, u64::saturating_add);
    for _ in 0..skipped {
        if lines.next().is_none() {
            break;
        }
    }
    let mut values = Vec::new();
    for row in 0..vertex.count {
        let Some((start, line)) = lines.next() else {
            return Err(cut(name, vertex, row));
        };
        values.clear();
        let mut words = line.split_ascii_whitespace();
        for (property, column) in vertex.properties.iter().zip(columns) {
            let missing = || {
                let message = format!("this line has no \"{}\"", property.name);
                SceneError::at(name, text, start, start + line.len(), message)
            };
            let word = words.next().ok_or_else(missing)?;
            if property.length.is_some() {
                for _ in 0..word.parse::<usize>().map_err(|_| missing())? {
                    words.next().ok_or_else(missing)?;
                }
            } else if let Some(column) = *column {
                let number = parse_number(word, column).map_err(|message| {
                    let at = word.as_ptr() as usize - text.as_ptr() as usize;
                    SceneError::at(name, text, at, at + word.len(), message)
                })?;
                values.push(number);
            }
        }
        list.add(given, &values);
    }
    Ok(())
}

fn read_binary<const D: usize>(
    bytes: &[u8],
    name: &str,
    header: &Header,
    (before, vertex, columns, given): Wanted<'_>,
    list: &mut ParticleList<D>,
) -> Result<(), SceneError> {
    let format = header.format;
    let mut rest = &bytes[header.body..];
    for element in &header.elements[..before] {
        for row in 0..element.count {
            if element.properties.is_empty() {
                break;
            }
            for property in &element.properties {
                take(&mut rest, property, format).ok_or_else(|| cut(name, element, row))?;
            }
        }
    }
    let mut values = Vec::new();
    for row in 0..vertex.count {
        values.clear();
        for (property, column) in vertex.properties.iter().zip(columns) {
            let number = take(&mut rest, property, format).ok_or_else(|| cut(name, vertex, row))?;
            if let Some(column) = *column {
                let number = check_number(number, column).map_err(|message| {
                    let place = format!("{} of vertex {row} (from 0)", property.name);
                    SceneError::of_file(name, format!("{place}: {message}"))
                })?;
                values.push(number);
            }
        }
        list.add(given, &values);
    }
    Ok(())
}

/// Takes the number of a property, or a list, from `rest`; `None` if there are too few bytes.
fn take(rest: &mut &[u8], property: &Property, format: Format) -> Option<f64> {
    let mut one = |kind: Type| {
        let (number, behind) = rest.split_at_checked(kind.bytes())?;
        *rest = behind;
        Some(kind.read(number, format))
    };
    let Some(length) = property.length else {
        return one(property.kind);
    };
    let items = one(length)?;
    let size = (items.max(0.0) as usize).checked_mul(property.kind.bytes())?;
    *rest = rest.get(size..)?;
    Some(items)
}

/// Makes the error of a file that ends too soon.
fn cut(name: &str, element: &Element, row: u64) -> SceneError {
    let message = format!(
        "the header promises {} of \"{}\", the file ends after {row}",
        element.count, element.name
    );
    SceneError::of_file(name, message).hint("was the file cut short?")
}

fn parse_header(bytes: &[u8], name: &str) -> Result<Header, SceneError> {
    const END: &[u8] = b"end_header";
    let start = &bytes[..bytes.len().min(LONGEST_HEADER)];
    if !start.starts_with(b"ply") {
        return Err(SceneError::of_file(
            name,
            "this is no PLY file: it does not begin with \"ply\"",
        ));
    }
    let end = start
        .windows(END.len())
        .position(|window| window == END)
        .ok_or_else(|| {
            SceneError::of_file(name, "the header has no end: there is no \"end_header\"")
        })?;
    let body = end
        + start[end..]
            .iter()
            .position(|byte| *byte == b'\n')
            .map_or(start.len() - end, |at| at + 1);
    let text = core::str::from_utf8(&start[..end])
        .map_err(|error| not_text(name, start, error.valid_up_to()))?;
    let mut format = None;
    let mut elements: Vec<Element> = Vec::new();
    for (at, line) in (Lines { text, at: 0 }).skip(1) {
        let bad = |message: &str| Err(SceneError::at(name, text, at, at + line.len(), message));
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        match words[..] {
            [] | ["comment" | "obj_info", ..] => {}
            ["format", word, _] => {
                format = match word {
                    "ascii" => Some(Format::Text),
                    "binary_little_endian" => Some(Format::LittleEndian),
                    "binary_big_endian" => Some(Format::BigEndian),
                    _ => {
                        return bad(
                            "the format must be ascii, binary_little_endian or binary_big_endian",
                        );
                    }
                };
            }
            ["element", element, count] => match count.parse() {
                Ok(count) => elements.push(Element {
                    name: element.to_owned(),
                    count,
                    properties: Vec::new(),
                }),
                Err(_) => return bad("the number of elements is not a whole number"),
            },
            ["property", ref types @ .., property] => {
                let Some(property) = Property::parse(types, property) else {
                    return bad(
                        "a property is written: property TYPE NAME, with TYPE char, uchar, short, ushort, int, uint, float or double",
                    );
                };
                let Some(element) = elements.last_mut() else {
                    return bad("a property before any element");
                };
                element.properties.push(property);
            }
            _ => return bad("this is no line of a PLY header"),
        }
    }
    let Some(format) = format else {
        return Err(SceneError::of_file(
            name,
            "the header has no line \"format\"",
        ));
    };
    Ok(Header {
        format,
        elements,
        body,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const HEADER: &str = "ply\nformat ascii 1.0\ncomment two\nelement sensor 1\nproperty float a\n\
        element vertex 2\nproperty float x\nproperty double y\nproperty uchar red\n\
        property list uchar int links\nproperty float vx\nproperty float vy\nproperty float volume0\nend_header\n";

    fn text() -> String {
        format!("{HEADER}0.5\n1 2 255 0 3 4 0.5\n-1 -2 0 2 7 8 -3 -4 0.25\n")
    }

    /// The same file in binary.
    fn binary(format: &str) -> Vec<u8> {
        let mut bytes = HEADER.replace("ascii", format).into_bytes();
        let little = format.contains("little");
        let mut put = |number: &[u8]| {
            let mut number = number.to_vec();
            if !little {
                number.reverse();
            }
            bytes.extend(number);
        };
        put(&0.5_f32.to_le_bytes());
        for (x, y, links, v, volume) in [
            (1.0_f32, 2.0_f64, &[][..], [3.0_f32, 4.0], 0.5_f32),
            (-1.0, -2.0, &[7_i32, 8], [-3.0, -4.0], 0.25),
        ] {
            put(&x.to_le_bytes());
            put(&y.to_le_bytes());
            put(&[9]);
            put(&[links.len() as u8]);
            links.iter().for_each(|link| put(&link.to_le_bytes()));
            v.iter().for_each(|v| put(&v.to_le_bytes()));
            put(&volume.to_le_bytes());
        }
        bytes
    }

    #[test]
    fn text_and_both_byte_orders_say_the_same() {
        let list = parse_ply::<2>(text().as_bytes(), "a.ply").unwrap();
        assert_eq!(list.position, [[1.0, 2.0], [-1.0, -2.0]]);
        assert_eq!(list.velocity, [[3.0, 4.0], [-3.0, -4.0]]);
        assert_eq!(list.volume, [0.5, 0.25]);
        for format in ["binary_little_endian", "binary_big_endian"] {
            assert_eq!(parse_ply::<2>(&binary(format), "a.ply").unwrap(), list);
        }
        let windows = text().replace('\n', "\r\n");
        assert_eq!(parse_ply::<2>(windows.as_bytes(), "a.ply").unwrap(), list);
    }

    #[test]
    fn what_is_wrong_is_named() {
        let error = |bytes: &[u8]| parse_ply::<2>(bytes, "a.ply").unwrap_err();
        let with = |from: &str, to: &str| error(text().replacen(from, to, 1).as_bytes());
        let found = with("-3 -4", "-3 nan");
        assert_eq!((found.line, found.column), (17, 18), "{found}");
        assert!(
            with("element vertex 2", "element vertex 2000000000000")
                .message
                .contains("ends after 2")
        );
        assert!(
            with("element vertex", "element points")
                .message
                .contains("vertex")
        );
        assert!(
            with("property float x", "property float w")
                .message
                .contains("\"x\"")
        );
        assert!(
            with("property float vx", "property float x")
                .message
                .contains("twice")
        );
        assert!(with("property float x", "property real x").line == 7);
        assert!(with("ascii", "text").line == 2);
        assert!(error(b"solid").message.contains("no PLY"));
        assert!(error(b"ply\nformat ascii 1.0\n").message.contains("no end"));
        let cut = binary("binary_big_endian");
        assert!(
            error(&cut[..cut.len() - 3])
                .message
                .contains("ends after 1")
        );
    }

    proptest! {
        #[test]
        fn altered_files_never_panic(at in 0_usize..400, byte in any::<u8>(), len in 0_usize..400) {
            for mut bytes in [text().into_bytes(), binary("binary_little_endian")] {
                let at = at % bytes.len();
                bytes[at] = byte;
                bytes.truncate(bytes.len().min(200 + len));
                drop(parse_ply::<2>(&bytes, "a.ply"));
                drop(parse_ply::<3>(&bytes, "a.ply"));
            }
        }

        #[test]
        fn junk_never_panics(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
            drop(parse_ply::<3>(&bytes, "a.ply"));
            let mut behind = HEADER.as_bytes().to_vec();
            behind.extend(&bytes);
            drop(parse_ply::<2>(&behind, "a.ply"));
        }
    }
}
