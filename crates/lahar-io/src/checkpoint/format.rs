//! A checkpoint as bytes.
//!
//! ```text
//!  0   8  magic: "LAHAR", CR, LF, 1A: a copy that changed line ends or was cut at 1A does not have it
//!  8   4  version of this format
//! 12   4  0A0B0C0D: numbers are little-endian
//! 16   8  length of the file
//! 24   4  length of the contents
//! 28   4  CRC-32 of the contents
//! 32      the contents: JSON, with one entry per array (name, type, shape, place, CRC-32)
//!         the arrays, raw, each at a multiple of 8
//! end−4   CRC-32 of everything before
//! ```
//! The reader trusts nothing: an array that is larger than the rest of the file is an error before memory is allocated,
//! and each array is checked against its checksum before it is used.

use std::io::{self, Read, Write};
use std::ops::Range;

use lahar::Checkpoint;
use lahar::checkpoint::{Array, Values};
use serde::{Deserialize, Serialize};

use super::Progress;

const MAGIC: [u8; 8] = *b"LAHAR\r\n\x1a";
const FORMAT: u32 = 1;
const BYTE_ORDER: u32 = 0x0A0B_0C0D;
/// Place of the file's length.
pub(crate) const LENGTH_AT: Range<usize> = 16..24;
/// Number of bytes before the contents.
const HEAD: u64 = 32;
/// Number of bytes after the arrays.
const TAIL: u64 = 4;
/// Arrays begin at multiples of this number of bytes.
const ALIGN: u64 = 8;
/// Number of bytes that are converted at a time.
const CHUNK: usize = 1 << 16;

/// The part of a checkpoint that is not arrays.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// Version of the program that wrote the checkpoint.
    pub lahar: String,
    /// Dimension: 2 or 3.
    pub dimension: usize,
    /// Precision: "f32" or "f64".
    pub precision: String,
    /// Name of the instruction set in use.
    pub isa: String,
    /// Checksum of the run's start: [`Start::sum`](super::Start::sum).
    pub start: u32,
    /// Progress of the run.
    pub progress: Progress,
}

#[derive(Serialize, Deserialize)]
struct Contents {
    #[serde(flatten)]
    header: Header,
    arrays: Vec<ArrayEntry>,
}

/// The entry of an array in the contents.
#[derive(Serialize, Deserialize)]
struct ArrayEntry {
    name: String,
    #[serde(rename = "type")]
    kind: NumberType,
    shape: Vec<usize>,
    /// Place of its first byte, from the start of the file.
    at: u64,
    crc32: u32,
}

#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum NumberType {
    F32,
    F64,
    U32,
    I32,
    U64,
}

impl NumberType {
    fn of(values: &Values) -> Self {
        match values {
            Values::F32(_) => Self::F32,
            Values::F64(_) => Self::F64,
            Values::U32(_) => Self::U32,
            Values::I32(_) => Self::I32,
            Values::U64(_) => Self::U64,
        }
    }

    /// Returns the bytes per number.
    fn size(self) -> u64 {
        match self {
            Self::F32 | Self::U32 | Self::I32 => 4,
            Self::F64 | Self::U64 => 8,
        }
    }
}

/// Passes the little-endian bytes of `values` to `to`, one chunk at a time.
fn each_chunk(values: &Values, mut to: impl FnMut(&[u8]) -> io::Result<()>) -> io::Result<()> {
    fn each<V: Copy, const N: usize>(
        values: &[V],
        bytes: impl Fn(V) -> [u8; N],
        to: &mut impl FnMut(&[u8]) -> io::Result<()>,
    ) -> io::Result<()> {
        let mut chunk = Vec::with_capacity(CHUNK);
        for values in values.chunks(CHUNK / N) {
            chunk.clear();
            chunk.extend(values.iter().flat_map(|value| bytes(*value)));
            to(&chunk)?;
        }
        Ok(())
    }
    match values {
        Values::F32(values) => each(values, f32::to_le_bytes, &mut to),
        Values::F64(values) => each(values, f64::to_le_bytes, &mut to),
        Values::U32(values) => each(values, u32::to_le_bytes, &mut to),
        Values::I32(values) => each(values, i32::to_le_bytes, &mut to),
        Values::U64(values) => each(values, u64::to_le_bytes, &mut to),
    }
}

fn checksum(values: &Values) -> u32 {
    let mut sum = crc32fast::Hasher::new();
    let summed = each_chunk(values, |chunk| {
        sum.update(chunk);
        Ok(())
    });
    debug_assert!(summed.is_ok(), "sums do not fail");
    sum.finalize()
}

/// A writer that counts the bytes that pass and computes their checksum.
struct SummingWriter<W> {
    inner: W,
    sum: crc32fast::Hasher,
    written: u64,
}

impl<W: Write> SummingWriter<W> {
    fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.sum.update(bytes);
        self.written += bytes.len() as u64;
        self.inner.write_all(bytes)
    }

    fn pad(&mut self) -> io::Result<()> {
        let zeros = [0; ALIGN as usize];
        let missing = self.written.next_multiple_of(ALIGN) - self.written;
        self.put(&zeros[..missing as usize])
    }
}

/// Writes a checkpoint and returns the writer.
///
/// ```
/// use lahar::Checkpoint;
/// use lahar_io::checkpoint::{Header, Progress, read, write};
///
/// let header = Header {
///     lahar: "0.1.0".into(),
///     dimension: 2,
///     precision: "f32".into(),
///     isa: "portable".into(),
///     start: 0,
///     progress: Progress::default(),
/// };
/// let state = Checkpoint { arrays: vec![] };
/// let mut bytes = write(Vec::new(), &header, &state)?;
/// assert_eq!(read(&*bytes, bytes.len() as u64), Ok((header, state)));
/// bytes[40] ^= 1;
/// assert!(read(&*bytes, bytes.len() as u64).is_err());
/// # Ok::<(), std::io::Error>(())
/// ```
///
/// # Errors
/// If `writer` fails.
pub fn write<W: Write>(writer: W, header: &Header, checkpoint: &Checkpoint) -> io::Result<W> {
    let line = |array: &Array| ArrayEntry {
        name: array.name.clone(),
        kind: NumberType::of(&array.values),
        shape: array.shape.clone(),
        at: u64::MAX,
        crc32: checksum(&array.values),
    };
    let mut contents = Contents {
        header: header.clone(),
        arrays: checkpoint.arrays.iter().map(line).collect(),
    };
    // The places of arrays depend on the length of the contents, which depends on the digits of the places. So room is
    // made for the widest places, and the rest is filled with spaces.
    let wide = serde_json::to_string(&contents)?.len() as u64;
    let mut at = (HEAD + wide).next_multiple_of(ALIGN);
    for (line, array) in contents.arrays.iter_mut().zip(&checkpoint.arrays) {
        line.at = at;
        at = (at + line.kind.size() * array.values.len() as u64).next_multiple_of(ALIGN);
    }
    let length = at + TAIL;
    let mut text = serde_json::to_string(&contents)?;
    text.extend(core::iter::repeat_n(' ', wide as usize - text.len()));

    let mut out = SummingWriter {
        inner: writer,
        sum: crc32fast::Hasher::new(),
        written: 0,
    };
    out.put(&MAGIC)?;
    out.put(&FORMAT.to_le_bytes())?;
    out.put(&BYTE_ORDER.to_le_bytes())?;
    out.put(&length.to_le_bytes())?;
    let text_length = u32::try_from(text.len()).map_err(io::Error::other)?;
    out.put(&text_length.to_le_bytes())?;
    out.put(&crc32fast::hash(text.as_bytes()).to_le_bytes())?;
    out.put(text.as_bytes())?;
    out.pad()?;
    for (line, array) in contents.arrays.iter().zip(&checkpoint.arrays) {
        debug_assert_eq!(line.at, out.written);
        each_chunk(&array.values, |chunk| out.put(chunk))?;
        out.pad()?;
    }
    let sum = out.sum.clone().finalize();
    out.put(&sum.to_le_bytes())?;
    Ok(out.inner)
}

/// A reader that counts the bytes that pass, up to a known length, and computes their checksum.
struct CheckedReader<R> {
    inner: R,
    sum: crc32fast::Hasher,
    read: u64,
    length: u64,
}

const CUT: &str = "it is cut short";

impl<R: Read> CheckedReader<R> {
    fn bytes(&mut self, count: u64) -> Result<Vec<u8>, String> {
        // Checked before memory is allocated.
        if count > self.length - self.read {
            return Err(CUT.to_owned());
        }
        let mut bytes = vec![0; count as usize];
        self.inner
            .read_exact(&mut bytes)
            .map_err(|error| match error.kind() {
                io::ErrorKind::UnexpectedEof => CUT.to_owned(),
                _ => format!("it cannot be read: {error}"),
            })?;
        self.read += count;
        self.sum.update(&bytes);
        Ok(bytes)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let bytes = self.bytes(N as u64)?;
        bytes.try_into().map_err(|_| CUT.to_owned())
    }

    fn values(&mut self, kind: NumberType, count: u64) -> Result<(Values, u32), String> {
        let length = count.checked_mul(kind.size()).ok_or(CUT)?;
        let bytes = self.bytes(length)?;
        let sum = crc32fast::hash(&bytes);
        fn each<V, const N: usize>(bytes: &[u8], value: impl Fn([u8; N]) -> V) -> Vec<V> {
            bytes.as_chunks().0.iter().map(|b| value(*b)).collect()
        }
        let values = match kind {
            NumberType::F32 => Values::F32(each(&bytes, f32::from_le_bytes)),
            NumberType::F64 => Values::F64(each(&bytes, f64::from_le_bytes)),
            NumberType::U32 => Values::U32(each(&bytes, u32::from_le_bytes)),
            NumberType::I32 => Values::I32(each(&bytes, i32::from_le_bytes)),
            NumberType::U64 => Values::U64(each(&bytes, u64::from_le_bytes)),
        };
        Ok((values, sum))
    }
}

/// Treatment of a file's checksums.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Checksums {
    /// Checksums must be right.
    Checked,
    /// Checksums are ignored, as if they had been adapted to altered contents.
    Ignored,
}

/// Reads a checkpoint from a file of `length` bytes.
///
/// # Errors
/// A sentence about the file, if it is cut, altered, or of another version.
pub fn read<R: Read>(reader: R, length: u64) -> Result<(Header, Checkpoint), String> {
    read_with(reader, length, Checksums::Checked)
}

/// Reads a checkpoint as [`read`] does, with or without a check of its checksums.
///
/// # Errors
/// As [`read`].
pub(crate) fn read_with<R: Read>(
    reader: R,
    length: u64,
    sums: Checksums,
) -> Result<(Header, Checkpoint), String> {
    let is_right = |is: u32, should_be: u32| is == should_be || sums == Checksums::Ignored;
    let mut bytes = CheckedReader {
        inner: reader,
        sum: crc32fast::Hasher::new(),
        read: 0,
        length,
    };
    if bytes.array::<8>()? != MAGIC {
        return Err("it is not a checkpoint of lahar".to_owned());
    }
    let format = u32::from_le_bytes(bytes.array()?);
    if format != FORMAT {
        return Err(format!(
            "it has version {format} of the format, this program reads version {FORMAT}"
        ));
    }
    if u32::from_le_bytes(bytes.array()?) != BYTE_ORDER {
        return Err("its bytes are in another order".to_owned());
    }
    let stated = u64::from_le_bytes(bytes.array()?);
    if stated != length {
        return Err(if stated > length {
            format!("{CUT}: {length} of {stated} bytes are there")
        } else {
            "something was added to it".to_owned()
        });
    }
    let text_length = u32::from_le_bytes(bytes.array()?);
    let text_sum = u32::from_le_bytes(bytes.array()?);
    let text = bytes.bytes(u64::from(text_length))?;
    if !is_right(crc32fast::hash(&text), text_sum) {
        return Err("its contents were altered".to_owned());
    }
    let contents: Contents = serde_json::from_slice(&text)
        .map_err(|error| format!("its contents cannot be read: {error}"))?;
    let mut arrays = Vec::with_capacity(contents.arrays.len());
    for line in contents.arrays {
        let gap = line.at.checked_sub(bytes.read).filter(|gap| *gap < ALIGN);
        let Some(gap) = gap else {
            return Err(format!("array \"{}\" is not where it should be", line.name));
        };
        bytes.bytes(gap)?;
        let count = (line.shape.iter()).try_fold(1, |n: u64, m| n.checked_mul(*m as u64));
        let (values, sum) = bytes.values(line.kind, count.ok_or(CUT)?)?;
        if !is_right(sum, line.crc32) {
            return Err(format!("array \"{}\" was altered", line.name));
        }
        arrays.push(Array {
            name: line.name,
            shape: line.shape,
            values,
        });
    }
    let left = bytes.length - bytes.read;
    if !(TAIL..TAIL + ALIGN).contains(&left) {
        return Err("its length is not that of its arrays".to_owned());
    }
    bytes.bytes(left - TAIL)?;
    let sum = bytes.sum.clone().finalize();
    if !is_right(sum, u32::from_le_bytes(bytes.array()?)) {
        return Err("it was altered".to_owned());
    }
    Ok((contents.header, Checkpoint { arrays }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> (Header, Checkpoint) {
        let header = Header {
            lahar: "1.2.3".into(),
            dimension: 2,
            precision: "f32".into(),
            isa: "portable".into(),
            start: 7,
            progress: Progress::default(),
        };
        let array = |name: &str, shape: &[usize], values| Array {
            name: name.into(),
            shape: shape.to_vec(),
            values,
        };
        let arrays = vec![
            array("a", &[3], Values::F32(vec![1.5, -0.0, f32::MIN_POSITIVE])),
            array("none", &[0, 2], Values::F64(vec![])),
            array("one", &[], Values::U64(vec![u64::MAX])),
            array("b", &[2, 1], Values::I32(vec![-1, i32::MIN])),
            array("many", &[50_000], Values::U32((0..50_000).collect())),
            array("c", &[1], Values::F64(vec![0.1 + 0.2])),
        ];
        (header, Checkpoint { arrays })
    }

    fn bytes() -> Vec<u8> {
        let (header, checkpoint) = example();
        write(Vec::new(), &header, &checkpoint).unwrap()
    }

    fn read_bytes(bytes: &[u8]) -> Result<(Header, Checkpoint), String> {
        read(bytes, bytes.len() as u64)
    }

    #[test]
    fn a_checkpoint_reads_back() {
        let bytes = bytes();
        assert!(bytes.len().is_multiple_of(4));
        assert_eq!(read_bytes(&bytes).unwrap(), example());
    }

    #[test]
    fn any_cut_and_any_altered_byte_is_noticed() {
        let bytes = bytes();
        for end in (0..2000).chain(bytes.len() - 2000..bytes.len()) {
            let why = read_bytes(&bytes[..end]).unwrap_err();
            assert!(why.contains("cut short"), "{end}: {why}");
        }
        for at in (0..3000).chain((3000..bytes.len()).step_by(97)) {
            for bit in [0, 7] {
                let mut bad = bytes.clone();
                bad[at] ^= 1 << bit;
                assert!(read_bytes(&bad).is_err(), "byte {at}, bit {bit}");
            }
        }
        let mut longer = bytes;
        longer.push(0);
        assert!(read_bytes(&longer).unwrap_err().contains("added"));
        assert!(
            read_bytes(b"LAHAR\n\x1a, once")
                .unwrap_err()
                .contains("not a checkpoint")
        );
    }

    #[test]
    fn another_version_is_named() {
        let mut bytes = bytes();
        bytes[8] = 2;
        let why = read_bytes(&bytes).unwrap_err();
        assert!(
            why.contains("version 2") && why.contains("version 1"),
            "{why}"
        );
    }

    /// Even with right checksums, sizes beyond the file are an error before memory is allocated.
    #[test]
    fn wrong_sizes_allocate_nothing() {
        let (header, checkpoint) = example();
        let good = write(Vec::new(), &header, &checkpoint).unwrap();
        let text = String::from_utf8_lossy(&good).into_owned();
        assert!(text.contains("\"shape\":[3]"));
        for shape in ["[9999999999999]", "[99999999999,99999999999]", "[4]"] {
            let start = good.windows(4).position(|w| w == b"e\":[").unwrap() + 3;
            let mut bad = good.clone();
            // The contents are padded with spaces, which a longer shape may take.
            let end = HEAD as usize + u32::from_le_bytes(good[24..28].try_into().unwrap()) as usize;
            let mut contents = bad[HEAD as usize..end].to_vec();
            contents.splice(
                start - HEAD as usize..start - HEAD as usize + 3,
                shape.bytes(),
            );
            while contents.len() > end - HEAD as usize {
                assert_eq!(contents.pop(), Some(b' '));
            }
            bad[HEAD as usize..end].copy_from_slice(&contents);
            let sum = crc32fast::hash(&contents);
            bad[28..32].copy_from_slice(&sum.to_le_bytes());
            assert!(read_bytes(&bad).is_err(), "{shape}");
        }
    }
}
