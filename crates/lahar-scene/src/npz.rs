//! NumPy's array files: `.npz` (a zip of `.npy`) and `.npy` alone.
//!
//! Frames are written in this format, and particle lists may be read from it. The reader trusts nothing: a cut file,
//! a header that contradicts the data, or a shape whose product overflows is an error that names the file and the
//! array. Memory grows with the bytes that are there, not with those that a header promises.
//!
//! ```text
//! x.npy:  \x93NUMPY  major minor  length of header  {'descr': '<f4', 'fortran_order': False, 'shape': (n, 3), }  numbers
//! ```

use std::fmt;
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Seek, Write};
use std::path::{Path, PathBuf};

use crate::after_error::AfterError;
use lahar::Data;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

/// One array of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct NpzArray {
    /// The name in the archive, without `.npy`; empty for a lone `.npy` file.
    pub name: String,
    /// The extents, slowest first; empty for a single number.
    pub shape: Vec<usize>,
    /// The numbers, row by row. `f4` and `f8` keep their precision; whole numbers and booleans become `u32`, or
    /// `f64` if one of them does not fit.
    pub data: Data,
}

/// The error of a file that NumPy could not have written, or that cannot be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NpzError {
    /// The path of the file.
    pub path: PathBuf,
    /// The array, if the error concerns one.
    pub array: Option<String>,
    /// The fault of the file.
    pub what: String,
}

impl fmt::Display for NpzError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.path.display())?;
        if let Some(array) = &self.array {
            write!(f, "array \"{array}\": ")?;
        }
        f.write_str(&self.what)
    }
}

impl std::error::Error for NpzError {}

/// Largest number of bytes of numbers in one file, unless [`read_limited`] sets another: a zip of megabytes can
/// unpack to that many.
pub const MAX_BYTES: u64 = 16 << 30;

/// Longest `.npy` header that is read \[bytes\]; NumPy's own are under 200.
const MAX_HEADER: u32 = 1 << 16;

/// Numbers are decoded through a buffer of this size \[bytes\], a multiple of every item size.
const CHUNK: usize = 1 << 16;

/// Reads all arrays of an `.npz` file, in the order of the file. Entries that are not arrays are skipped.
///
/// # Errors
/// The file, the array, and its fault.
pub fn read(path: impl AsRef<Path>) -> Result<Vec<NpzArray>, NpzError> {
    read_limited(path, MAX_BYTES)
}

/// [`read`] with an error for files with more than `limit` bytes of numbers.
///
/// # Errors
/// As [`read`].
pub fn read_limited(path: impl AsRef<Path>, limit: u64) -> Result<Vec<NpzArray>, NpzError> {
    let path = path.as_ref();
    let fail = |array: Option<String>, what: String| NpzError {
        path: path.to_owned(),
        array,
        what,
    };
    let file = File::open(path).map_err(|error| fail(None, error.to_string()))?;
    read_from(BufReader::new(file), limit).map_err(|(array, what)| fail(array, what))
}

/// Reads the one array of an `.npy` file.
///
/// # Errors
/// As [`read`].
pub fn read_npy(path: impl AsRef<Path>) -> Result<NpzArray, NpzError> {
    let path = path.as_ref();
    let fail = |what: String| NpzError {
        path: path.to_owned(),
        array: None,
        what,
    };
    let file = File::open(path).map_err(|error| fail(error.to_string()))?;
    let mut left = MAX_BYTES;
    read_array(&mut BufReader::new(file), String::new(), &mut left).map_err(fail)
}

/// [`read_npy`] from a reader.
///
/// # Errors
/// The fault of the file.
pub(crate) fn read_array_from(mut reader: impl Read) -> Result<NpzArray, String> {
    let mut left = MAX_BYTES;
    read_array(&mut reader, String::new(), &mut left)
}

/// [`read_limited`] from a reader.
///
/// # Errors
/// The array, and its fault.
pub(crate) fn read_from<R: Read + Seek>(
    reader: R,
    limit: u64,
) -> Result<Vec<NpzArray>, (Option<String>, String)> {
    let mut archive = ZipArchive::new(reader)
        .map_err(|error| (None, format!("not an .npz file (a zip archive): {error}")))?;
    let mut left = limit;
    let mut arrays = Vec::new();
    for index in 0..archive.len() {
        let mut entry = archive
            .by_index(index)
            .map_err(|error| (None, format!("entry {index} of the archive: {error}")))?;
        let name = entry
            .name()
            .map_err(|error| {
                (
                    None,
                    format!("entry {index} of the archive: its name: {error}"),
                )
            })?
            .into_owned();
        let Some(name) = name.strip_suffix(".npy") else {
            continue;
        };
        arrays.push(
            read_array(&mut entry, name.to_owned(), &mut left)
                .map_err(|what| (Some(name.to_owned()), what))?,
        );
    }
    Ok(arrays)
}

/// The kind of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Float,
    Signed,
    Unsigned,
}

/// The content of an `.npy` header.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Header {
    kind: Kind,
    item_bytes: usize,
    big_endian: bool,
    fortran_order: bool,
    shape: Vec<usize>,
}

/// Reads the header and numbers of one array, to the end of `reader`. `left` bytes may still be read.
fn read_array(reader: &mut impl Read, name: String, left: &mut u64) -> Result<NpzArray, String> {
    let header = read_header(reader)?;
    let count = header
        .shape
        .iter()
        .try_fold(1_usize, |product, &extent| product.checked_mul(extent))
        .filter(|&count| count.checked_mul(header.item_bytes).is_some())
        .ok_or_else(|| {
            format!(
                "its shape {:?} has more numbers than any memory holds",
                header.shape
            )
        })?;
    let bytes = (count * header.item_bytes) as u64;
    if bytes > *left {
        return Err(format!(
            "its shape {:?} takes {bytes} bytes, more than the {left} still allowed for this file",
            header.shape
        ));
    }
    *left -= bytes;

    let mut data = Decoded::new(&header);
    let mut buffer = vec![0_u8; CHUNK];
    let mut remaining = count * header.item_bytes;
    while remaining > 0 {
        let part = remaining.min(CHUNK);
        reader
            .read_exact(&mut buffer[..part])
            .map_err(|error| match error.kind() {
                io::ErrorKind::UnexpectedEof => {
                    format!("cut short: {remaining} of {bytes} bytes of numbers are missing")
                }
                _ => error.to_string(),
            })?;
        data.push(&buffer[..part], &header)?;
        remaining -= part;
    }
    // Reading to the end also makes the archive check its checksum.
    match reader.read(&mut buffer[..1]) {
        Ok(0) => {}
        Ok(_) => {
            return Err(format!("longer than its shape {:?} says", header.shape));
        }
        Err(error) => return Err(error.to_string()),
    }
    let data = data.finish();
    Ok(NpzArray {
        name,
        data: if header.fortran_order {
            by_rows(&data, &header.shape)
        } else {
            data
        },
        shape: header.shape,
    })
}

/// Decoded numbers, before they become [`Data`].
enum Decoded {
    F32(Vec<f32>),
    F64(Vec<f64>),
    /// Whole numbers, as long as all fit.
    U32(Vec<u32>),
    /// Whole numbers, of which one does not fit.
    Whole(Vec<f64>),
}

/// Whole numbers up to this are exact as `f64`.
const EXACT_WHOLE: i128 = 1 << f64::MANTISSA_DIGITS;

impl Decoded {
    fn new(header: &Header) -> Self {
        match (header.kind, header.item_bytes) {
            (Kind::Float, 4) => Self::F32(Vec::new()),
            (Kind::Float, _) => Self::F64(Vec::new()),
            _ => Self::U32(Vec::new()),
        }
    }

    fn push(&mut self, bytes: &[u8], header: &Header) -> Result<(), String> {
        // Little-endian bytes of one number, whatever order the file has.
        let item = |bytes: &[u8]| {
            let mut wide = [0_u8; 8];
            wide[..bytes.len()].copy_from_slice(bytes);
            if header.big_endian {
                wide[..bytes.len()].reverse();
            }
            wide
        };
        let items = bytes.chunks_exact(header.item_bytes).map(item);
        match self {
            Self::F32(v) => {
                v.extend(items.map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])));
            }
            Self::F64(v) => v.extend(items.map(f64::from_le_bytes)),
            Self::U32(_) | Self::Whole(_) => {
                let unused = 64 - 8 * header.item_bytes as u32;
                for b in items {
                    let number = match header.kind {
                        Kind::Signed => {
                            i128::from((u64::from_le_bytes(b) << unused).cast_signed() >> unused)
                        }
                        Kind::Unsigned | Kind::Float => i128::from(u64::from_le_bytes(b)),
                    };
                    self.push_whole(number)?;
                }
            }
        }
        Ok(())
    }

    fn push_whole(&mut self, number: i128) -> Result<(), String> {
        if let Self::U32(v) = self {
            if let Ok(number) = u32::try_from(number) {
                v.push(number);
                return Ok(());
            }
            *self = Self::Whole(v.iter().map(|&x| f64::from(x)).collect());
        }
        if number.abs() > EXACT_WHOLE {
            return Err(format!(
                "{number} is beyond 2^53, the whole numbers that can be kept exactly"
            ));
        }
        if let Self::Whole(v) = self {
            v.push(number as f64);
        }
        Ok(())
    }

    fn finish(self) -> Data {
        match self {
            Self::F32(v) => Data::F32(v),
            Self::F64(v) | Self::Whole(v) => Data::F64(v),
            Self::U32(v) => Data::U32(v),
        }
    }
}

/// Reorders numbers from Fortran's order (first index fastest) to ours (last index fastest).
fn by_rows(data: &Data, shape: &[usize]) -> Data {
    fn reorder<T: Copy>(v: &[T], shape: &[usize]) -> Vec<T> {
        let mut stride = 1;
        let strides: Vec<usize> = shape
            .iter()
            .map(|&extent| {
                let own = stride;
                stride *= extent;
                own
            })
            .collect();
        let mut index = vec![0_usize; shape.len()];
        let mut out = Vec::with_capacity(v.len());
        for _ in 0..v.len() {
            out.push(
                v[index
                    .iter()
                    .zip(&strides)
                    .map(|(i, s)| i * s)
                    .sum::<usize>()],
            );
            for axis in (0..shape.len()).rev() {
                index[axis] += 1;
                if index[axis] < shape[axis] {
                    break;
                }
                index[axis] = 0;
            }
        }
        out
    }
    match data {
        Data::F32(v) => Data::F32(reorder(v, shape)),
        Data::F64(v) => Data::F64(reorder(v, shape)),
        Data::U32(v) => Data::U32(reorder(v, shape)),
    }
}

const MAGIC: &[u8; 6] = b"\x93NUMPY";

fn read_header(reader: &mut impl Read) -> Result<Header, String> {
    let short = |error: io::Error| match error.kind() {
        io::ErrorKind::UnexpectedEof => "cut short in its header".to_owned(),
        _ => error.to_string(),
    };
    let mut start = [0_u8; 8];
    reader.read_exact(&mut start).map_err(short)?;
    if &start[..6] != MAGIC {
        return Err("not an .npy array: it does not start with \\x93NUMPY".to_owned());
    }
    let length = match start[6] {
        1 => {
            let mut b = [0_u8; 2];
            reader.read_exact(&mut b).map_err(short)?;
            u32::from(u16::from_le_bytes(b))
        }
        2 | 3 => {
            let mut b = [0_u8; 4];
            reader.read_exact(&mut b).map_err(short)?;
            u32::from_le_bytes(b)
        }
        version => return Err(format!("version {version} of the .npy format is not known")),
    };
    if length > MAX_HEADER {
        return Err(format!("a header of {length} bytes is not NumPy's"));
    }
    let mut text = vec![0_u8; length as usize];
    reader.read_exact(&mut text).map_err(short)?;
    let text = String::from_utf8(text).map_err(|_| "its header is not text".to_owned())?;
    parse_header(&text)
}

/// Reads `{'descr': '<f4', 'fortran_order': False, 'shape': (3, 2), }`, with the keys in any order.
fn parse_header(text: &str) -> Result<Header, String> {
    let broken = || format!("its header is not understood: {}", text.trim());
    let mut rest = text.trim();
    rest = rest.strip_prefix('{').ok_or_else(broken)?;
    let (mut descr, mut order, mut shape) = (None, None, None);
    loop {
        rest = rest.trim_start().trim_start_matches(',').trim_start();
        if rest.strip_prefix('}').is_some() {
            break;
        }
        let (key, after) = quoted(rest).ok_or_else(broken)?;
        rest = after
            .trim_start()
            .strip_prefix(':')
            .ok_or_else(broken)?
            .trim_start();
        match key {
            "descr" if rest.starts_with('[') => {
                return Err(
                    "records of named fields are not read; save one array per field".to_owned(),
                );
            }
            "descr" => {
                let (value, after) = quoted(rest).ok_or_else(broken)?;
                (descr, rest) = (Some(value), after);
            }
            "fortran_order" => {
                let (value, after) = truth(rest).ok_or_else(broken)?;
                (order, rest) = (Some(value), after);
            }
            "shape" => {
                let (value, after) = tuple(rest).ok_or_else(broken)?;
                (shape, rest) = (Some(value), after);
            }
            _ => return Err(broken()),
        }
    }
    let (Some(descr), Some(fortran_order), Some(shape)) = (descr, order, shape) else {
        return Err(broken());
    };
    let (kind, item_bytes, big_endian) = number_type(descr).ok_or_else(|| {
        format!(
            "numbers of type '{descr}' are not read; save as float32, float64 or an integer type"
        )
    })?;
    Ok(Header {
        kind,
        item_bytes,
        big_endian,
        fortran_order,
        shape,
    })
}

/// Returns the kind of a type of numbers, its bytes per number, and whether the first byte is the highest.
fn number_type(descr: &str) -> Option<(Kind, usize, bool)> {
    let mut letters = descr.chars();
    let big_endian = match letters.next()? {
        '<' | '|' => false,
        '>' => true,
        '=' => cfg!(target_endian = "big"),
        _ => return None,
    };
    let (kind, item_bytes) = match letters.as_str() {
        "f4" => (Kind::Float, 4),
        "f8" => (Kind::Float, 8),
        "i1" => (Kind::Signed, 1),
        "i2" => (Kind::Signed, 2),
        "i4" => (Kind::Signed, 4),
        "i8" => (Kind::Signed, 8),
        "b1" | "u1" => (Kind::Unsigned, 1),
        "u2" => (Kind::Unsigned, 2),
        "u4" => (Kind::Unsigned, 4),
        "u8" => (Kind::Unsigned, 8),
        _ => return None,
    };
    Some((kind, item_bytes, big_endian))
}

/// Returns the word True or False at the start of `text`, and the text after it.
fn truth(text: &str) -> Option<(bool, &str)> {
    match text.strip_prefix("True") {
        Some(after) => Some((true, after)),
        None => Some((false, text.strip_prefix("False")?)),
    }
}

/// Returns the tuple of whole numbers at the start of `text`, and the text after it.
fn tuple(text: &str) -> Option<(Vec<usize>, &str)> {
    let (inside, after) = text.strip_prefix('(')?.split_once(')')?;
    let numbers: Result<Vec<usize>, _> = inside
        .split(',')
        .map(str::trim)
        .filter(|number| !number.is_empty())
        .map(|number| number.trim_end_matches('L').parse())
        .collect();
    Some((numbers.ok()?, after))
}

/// Returns the quoted word at the start of `text`, and the text after it.
fn quoted(text: &str) -> Option<(&str, &str)> {
    let mark = text.chars().next().filter(|c| matches!(c, '\'' | '"'))?;
    text[1..].split_once(mark)
}

/// The compression of arrays in an archive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Compression {
    /// None: fastest, and readable without unpacking.
    #[default]
    Stored,
    /// Deflate at a low level.
    Deflated,
}

/// Writes an `.npz` file, array after array. The same arrays give the same bytes: no time is recorded.
///
/// ```
/// use lahar_scene::npz::{Compression, NpzWriter};
/// use lahar::Data;
/// let mut bytes = std::io::Cursor::new(Vec::new());
/// let mut npz = NpzWriter::new(&mut bytes, Compression::Stored);
/// npz.add("position", &[2, 2], &Data::F32(vec![0.0, 0.1, 0.2, 0.3]))?;
/// npz.finish()?;
/// # Ok::<(), std::io::Error>(())
/// ```
pub struct NpzWriter<W: Write + Seek> {
    zip: ZipWriter<AfterError<W>>,
    compression: Compression,
}

impl NpzWriter<BufWriter<File>> {
    /// Creates the file at `path`, or empties it.
    ///
    /// # Errors
    /// If it cannot be created.
    pub fn create(path: impl AsRef<Path>, compression: Compression) -> io::Result<Self> {
        Ok(Self::new(
            BufWriter::with_capacity(1 << 20, File::create(path)?),
            compression,
        ))
    }
}

impl<W: Write + Seek> NpzWriter<W> {
    /// Starts an archive in `writer`.
    pub fn new(writer: W, compression: Compression) -> Self {
        Self {
            zip: ZipWriter::new(AfterError::new(writer)),
            compression,
        }
    }

    /// Adds an array of `shape`, slowest extent first; an empty shape is a single number.
    ///
    /// # Errors
    /// If writing fails, or `shape` is not that of `data`.
    pub fn add(&mut self, name: &str, shape: &[usize], data: &Data) -> io::Result<()> {
        let (count, descr, item_bytes) = match data {
            Data::F32(v) => (v.len(), "<f4", 4),
            Data::F64(v) => (v.len(), "<f8", 8),
            Data::U32(v) => (v.len(), "<u4", 4),
        };
        if shape.iter().product::<usize>() != count {
            return Err(io::Error::new(
                io::ErrorKind::InvalidInput,
                format!("array \"{name}\": {count} numbers do not fill the shape {shape:?}"),
            ));
        }
        let header = header_bytes(descr, shape);
        let options = SimpleFileOptions::default()
            .compression_method(match self.compression {
                Compression::Stored => CompressionMethod::Stored,
                Compression::Deflated => CompressionMethod::Deflated,
            })
            .compression_level(match self.compression {
                Compression::Stored => None,
                Compression::Deflated => Some(DEFLATE_LEVEL),
            })
            .last_modified_time(zip::DateTime::default())
            .large_file((header.len() + count * item_bytes) as u64 >= LARGE_FILE);
        self.zip.start_file(format!("{name}.npy"), options)?;
        self.zip.write_all(&header)?;
        match data {
            Data::F32(v) => write_numbers(&mut self.zip, v, f32::to_le_bytes),
            Data::F64(v) => write_numbers(&mut self.zip, v, f64::to_le_bytes),
            Data::U32(v) => write_numbers(&mut self.zip, v, u32::to_le_bytes),
        }
    }

    /// Writes the directory of the archive and returns the flushed writer.
    ///
    /// # Errors
    /// If writing fails.
    pub fn finish(self) -> io::Result<W> {
        let mut writer = self.zip.finish()?.into_inner();
        writer.flush()?;
        Ok(writer)
    }
}

/// Arrays of this size or more need the 64-bit sizes of the zip format \[bytes\], with a margin for deflate.
const LARGE_FILE: u64 = 0xFF00_0000;

/// Level of deflate. Floats hardly shrink further at higher levels, and take several times as long.
const DEFLATE_LEVEL: i64 = 1;

/// Returns a header in NumPy's own layout: version 1.0, padded with spaces to a multiple of 64 bytes, with a new line
/// at the end.
fn header_bytes(descr: &str, shape: &[usize]) -> Vec<u8> {
    let extents: String = match shape {
        [one] => format!("{one},"),
        many => many
            .iter()
            .map(usize::to_string)
            .collect::<Vec<_>>()
            .join(", "),
    };
    let dictionary =
        format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({extents}), }}");
    let start = MAGIC.len() + 2 + 2;
    let length = (start + dictionary.len() + 1).next_multiple_of(64) - start;
    let mut bytes = Vec::with_capacity(start + length);
    bytes.extend_from_slice(MAGIC);
    bytes.extend_from_slice(&[1, 0]);
    bytes.extend_from_slice(&(length as u16).to_le_bytes());
    bytes.extend_from_slice(dictionary.as_bytes());
    bytes.resize(start + length - 1, b' ');
    bytes.push(b'\n');
    bytes
}

fn write_numbers<T: Copy, const N: usize>(
    writer: &mut impl Write,
    numbers: &[T],
    to_bytes: impl Fn(T) -> [u8; N],
) -> io::Result<()> {
    let mut buffer = Vec::with_capacity(CHUNK);
    for part in numbers.chunks(CHUNK / N) {
        buffer.clear();
        for &number in part {
            buffer.extend_from_slice(&to_bytes(number));
        }
        writer.write_all(&buffer)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::io::Cursor;

    type Failure = (Option<String>, String);

    fn written(arrays: &[NpzArray], compression: Compression) -> Vec<u8> {
        let mut npz = NpzWriter::new(Cursor::new(Vec::new()), compression);
        for array in arrays {
            npz.add(&array.name, &array.shape, &array.data).unwrap();
        }
        npz.finish().unwrap().into_inner()
    }

    fn read_bytes(bytes: &[u8]) -> Result<Vec<NpzArray>, Failure> {
        read_from(Cursor::new(bytes), 1 << 20)
    }

    fn array(name: &str, shape: &[usize], data: Data) -> NpzArray {
        NpzArray {
            name: name.to_owned(),
            shape: shape.to_vec(),
            data,
        }
    }

    /// Makes an `.npy` file with this header and these bytes of numbers.
    fn npy(header: &str, numbers: &[u8]) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend_from_slice(&[1, 0]);
        bytes.extend_from_slice(&(header.len() as u16).to_le_bytes());
        bytes.extend_from_slice(header.as_bytes());
        bytes.extend_from_slice(numbers);
        bytes
    }

    fn read_one(bytes: &[u8]) -> Result<NpzArray, String> {
        read_array(&mut Cursor::new(bytes), String::new(), &mut (1 << 20))
    }

    fn samples() -> Vec<NpzArray> {
        vec![
            array(
                "position",
                &[3, 2],
                Data::F64(vec![0.0, -0.0, 1.5, f64::MIN_POSITIVE, 1e300, -7.0]),
            ),
            array(
                "J",
                &[4],
                Data::F32(vec![1.0, f32::INFINITY, f32::MIN, 1e-40]),
            ),
            array("affine", &[1, 2, 2], Data::F32(vec![1.0, 2.0, 3.0, 4.0])),
            array("id", &[2], Data::U32(vec![0, u32::MAX])),
            array("time", &[], Data::F64(vec![0.25])),
            array("empty", &[0, 3], Data::F32(vec![])),
        ]
    }

    #[test]
    fn what_is_written_is_read_back() {
        for compression in [Compression::Stored, Compression::Deflated] {
            let bytes = written(&samples(), compression);
            assert_eq!(read_bytes(&bytes).unwrap(), samples());
            assert_eq!(
                bytes,
                written(&samples(), compression),
                "same arrays, same bytes"
            );
        }
    }

    #[test]
    fn a_cut_or_altered_file_is_an_error_or_reads_the_same() {
        let bytes = written(&samples(), Compression::Deflated);
        for length in 0..bytes.len() {
            assert!(
                read_bytes(&bytes[..length]).is_err(),
                "cut to {length} bytes"
            );
        }
        for position in 0..bytes.len() {
            let mut altered = bytes.clone();
            altered[position] ^= 0x55;
            // The checksum covers numbers, not names, dates and flags.
            if let Ok(arrays) = read_bytes(&altered) {
                for one in arrays {
                    let found = samples().into_iter().any(|sample| sample.data == one.data);
                    assert!(found, "byte {position} changed {} unnoticed", one.name);
                }
            }
        }
    }

    #[test]
    fn every_type_and_byte_order() {
        let one = |descr: &str, bytes: &[u8]| {
            let count = bytes.len() / descr[2..].parse::<usize>().unwrap();
            let header =
                format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({count},), }}\n");
            read_one(&npy(&header, bytes)).unwrap().data
        };
        assert_eq!(one(">f4", &1.5_f32.to_be_bytes()), Data::F32(vec![1.5]));
        assert_eq!(one("<f8", &1.5_f64.to_le_bytes()), Data::F64(vec![1.5]));
        assert_eq!(one(">f8", &1.5_f64.to_be_bytes()), Data::F64(vec![1.5]));
        assert_eq!(one("<i4", &7_i32.to_le_bytes()), Data::U32(vec![7]));
        assert_eq!(one(">i4", &(-7_i32).to_be_bytes()), Data::F64(vec![-7.0]));
        assert_eq!(one("<i8", &(-1_i64).to_le_bytes()), Data::F64(vec![-1.0]));
        assert_eq!(
            one(">u8", &(1_u64 << 40).to_be_bytes()),
            Data::F64(vec![(1_u64 << 40) as f64])
        );
        assert_eq!(
            one("<u4", &u32::MAX.to_le_bytes()),
            Data::U32(vec![u32::MAX])
        );
        assert_eq!(one("|u1", &[1, 255]), Data::U32(vec![1, 255]));
        assert_eq!(one("|i1", &[1, 255]), Data::F64(vec![1.0, -1.0]));
        assert_eq!(one("|b1", &[1, 0]), Data::U32(vec![1, 0]));
        assert_eq!(one("<i2", &[0xFE, 0xFF, 2, 0]), Data::F64(vec![-2.0, 2.0]));
        let header = "{'descr': '<u8', 'fortran_order': False, 'shape': (1,), }";
        let error = read_one(&npy(header, &u64::MAX.to_le_bytes())).unwrap_err();
        assert!(error.contains("2^53"), "{error}");
    }

    #[test]
    fn fortran_order_is_turned() {
        let numbers: Vec<u8> = [1.0_f32, 4.0, 2.0, 5.0, 3.0, 6.0]
            .into_iter()
            .flat_map(f32::to_le_bytes)
            .collect();
        let header = "{'descr': '<f4', 'fortran_order': True, 'shape': (2, 3), }";
        let turned = read_one(&npy(header, &numbers)).unwrap();
        assert_eq!(turned.data, Data::F32(vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
    }

    #[test]
    fn headers_that_lie_are_errors() {
        for (header, expected) in [
            (
                "{'descr': '<f4', 'fortran_order': False, 'shape': (99999999999, 99999999999), }",
                "any memory",
            ),
            (
                "{'descr': '<f4', 'fortran_order': False, 'shape': (4611686018427387904,), }",
                "any memory",
            ),
            (
                "{'descr': '<f4', 'fortran_order': False, 'shape': (999999999,), }",
                "still allowed",
            ),
            (
                "{'descr': '<f4', 'fortran_order': False, 'shape': (3,), }",
                "cut short",
            ),
            (
                "{'descr': '<f4', 'fortran_order': False, 'shape': (1,), }",
                "longer than",
            ),
            (
                "{'descr': '<f4', 'fortran_order': False, 'shape': (-1,), }",
                "not understood",
            ),
            (
                "{'descr': '<c8', 'fortran_order': False, 'shape': (1,), }",
                "'<c8'",
            ),
            (
                "{'descr': [('x', '<f4')], 'fortran_order': False, 'shape': (1,), }",
                "named fields",
            ),
            ("{'descr': '<f4', 'shape': (1,), }", "not understood"),
            (
                "{'descr': '<f4', 'fortran_order': False, 'shape': (1",
                "not understood",
            ),
            ("{", "not understood"),
            ("", "not understood"),
        ] {
            let error = read_one(&npy(header, &[0; 8])).unwrap_err();
            assert!(error.contains(expected), "{header}: {error}");
        }
    }

    #[test]
    fn files_that_are_not_there_or_not_ours_are_named() {
        let error = read("no/such/file.npz").unwrap_err();
        assert!(
            error.to_string().starts_with("no/such/file.npz: "),
            "{error}"
        );
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.npz");
        std::fs::write(&path, "not a zip").unwrap();
        assert!(read(&path).unwrap_err().what.contains("not an .npz"));
        std::fs::write(
            &path,
            npy(
                "{'descr': '<f4', 'fortran_order': False, 'shape': (1,)}",
                &[0; 4],
            ),
        )
        .unwrap();
        assert_eq!(read_npy(&path).unwrap().shape, [1]);
    }

    #[test]
    fn a_shape_that_does_not_fit_is_refused() {
        let mut npz = NpzWriter::new(Cursor::new(Vec::new()), Compression::Stored);
        assert!(npz.add("x", &[2, 2], &Data::F32(vec![0.0; 3])).is_err());
    }

    proptest! {
        #[test]
        fn junk_never_panics(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
            let _ = read_bytes(&bytes);
            let _ = read_one(&bytes);
        }

        #[test]
        fn junk_headers_never_panic(header in "[{}'a-z<>:0-9,() ]{0,80}") {
            let _ = read_one(&npy(&header, &[0; 16]));
        }
    }
}
