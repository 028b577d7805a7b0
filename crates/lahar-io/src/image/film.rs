//! A GIF of pictures, all in one palette, so that nothing flickers.
//!
//! A GIF's palette stands before its first frame, but a good palette needs all frames. So pictures are kept, compressed,
//! while their colors are counted. At the end the palette is computed from the counts, and the frames are written, each
//! only where it differs from the one before.

use std::io::{self, Read, Write};
use std::path::Path;

use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;

use super::Picture;
use super::palette::Color;
use crate::files::{Durability, write_whole_io};

/// Bits per channel by which colors are told apart while they are counted.
const BITS: u32 = 5;

/// Colors of a palette; one more stands for "as in the frame before".
const COLORS: usize = 255;

/// A film: pictures of one size that become a GIF.
///
/// ```
/// use lahar_io::image::{Film, Picture};
///
/// let mut film = Film::new(25.0);
/// for shade in [0, 100, 200] {
///     film.push(&Picture { width: 16, height: 16, rgb: vec![shade; 3 * 16 * 16] })?;
/// }
/// let mut gif = Vec::new();
/// film.write(&mut gif)?;
/// assert!(gif.starts_with(b"GIF89a"));
/// # Ok::<(), std::io::Error>(())
/// ```
pub struct Film {
    size: Option<(u32, u32)>,
    /// Pictures per second.
    rate: f64,
    /// Compressed pictures, in order.
    frames: Vec<Vec<u8>>,
    /// For the leading bits of each color: the number of pixels, and the sums of their channels.
    counts: Vec<(u64, [u64; 3])>,
}

impl Film {
    /// Begins a film of `rate` pictures per second on average: the format counts in hundredths of a second.
    pub fn new(rate: f64) -> Self {
        Self {
            size: None,
            rate: rate.clamp(0.1, 50.0),
            frames: Vec::new(),
            counts: vec![(0, [0; 3]); 1 << (3 * BITS)],
        }
    }

    /// Returns the number of pictures so far.
    pub fn len(&self) -> usize {
        self.frames.len()
    }

    /// Returns true if there is no picture yet.
    pub fn is_empty(&self) -> bool {
        self.frames.is_empty()
    }

    /// Adds a picture.
    ///
    /// # Errors
    /// If its size differs from that of the first picture.
    pub fn push(&mut self, picture: &Picture) -> io::Result<()> {
        let size = (picture.width, picture.height);
        if *self.size.get_or_insert(size) != size || u16::try_from(size.0.max(size.1)).is_err() {
            return Err(io::Error::new(
                io::ErrorKind::InvalidInput,
                "pictures of a film have one size, below 65536",
            ));
        }
        self.count(&picture.rgb);
        let mut packer = ZlibEncoder::new(Vec::new(), Compression::fast());
        packer.write_all(&picture.rgb)?;
        self.frames.push(packer.finish()?);
        Ok(())
    }

    fn count(&mut self, rgb: &[u8]) {
        for pixel in rgb.chunks_exact(3) {
            let (count, sum) = &mut self.counts[bin([pixel[0], pixel[1], pixel[2]])];
            *count += 1;
            for (sum, &channel) in sum.iter_mut().zip(pixel) {
                *sum += u64::from(channel);
            }
        }
    }

    /// Returns the last picture as [`Film::unpack`] reads it: width, height and length as `u32`, and compressed pixels.
    pub(crate) fn last_packed(&self) -> Vec<u8> {
        let (Some((width, height)), Some(packed)) = (self.size, self.frames.last()) else {
            return Vec::new();
        };
        let head = [width, height, packed.len() as u32].map(u32::to_le_bytes);
        [head.as_flattened(), packed].concat()
    }

    /// Adds pictures that [`Film::last_packed`] returned, as if they were pushed again.
    pub(crate) fn unpack(&mut self, mut pictures: &[u8]) -> io::Result<()> {
        let wrong = || {
            io::Error::new(
                io::ErrorKind::InvalidData,
                "these are not pictures of a film",
            )
        };
        while !pictures.is_empty() {
            let (head, rest) = pictures.split_at_checked(12).ok_or_else(wrong)?;
            let [width, height, length] =
                [0, 4, 8].map(|at| u32::from_le_bytes([0, 1, 2, 3].map(|i| head[at + i])));
            let (packed, rest) = rest.split_at_checked(length as usize).ok_or_else(wrong)?;
            let size = 3 * u64::from(width) * u64::from(height);
            let mut rgb = Vec::new();
            ZlibDecoder::new(packed)
                .take(size + 1)
                .read_to_end(&mut rgb)?;
            if rgb.len() as u64 != size
                || *self.size.get_or_insert((width, height)) != (width, height)
            {
                return Err(wrong());
            }
            self.count(&rgb);
            self.frames.push(packed.to_vec());
            pictures = rest;
        }
        Ok(())
    }

    /// Writes the GIF file `path`, whole or not at all. It plays in a loop.
    ///
    /// # Errors
    /// If there is no picture, or writing fails.
    pub fn save(&self, path: impl AsRef<Path>) -> io::Result<()> {
        write_whole_io(path.as_ref(), Durability::Eventual, |mut writer| {
            self.write(&mut writer)?;
            Ok(writer)
        })
    }

    /// Writes the film as GIF.
    ///
    /// # Errors
    /// If there is no picture, or writing fails.
    pub fn write(&self, writer: impl Write) -> io::Result<()> {
        let Some((width, height)) = self.size else {
            return Err(io::Error::new(
                io::ErrorKind::InvalidInput,
                "a film without pictures",
            ));
        };
        let (width, height) = (width as u16, height as u16);
        let palette = Palette::cut(&self.counts);
        let mut encoder =
            gif::Encoder::new(writer, width, height, &palette.bytes()).map_err(io::Error::other)?;
        encoder
            .set_repeat(gif::Repeat::Infinite)
            .map_err(io::Error::other)?;

        let mut shown: Vec<u8> = Vec::new();
        let mut rgb = Vec::new();
        // Time from the start to the end of a picture [1/100 s].
        let end = |index: usize| (100.0 * index as f64 / self.rate).round();
        for (index, packed) in self.frames.iter().enumerate() {
            rgb.clear();
            ZlibDecoder::new(packed.as_slice()).read_to_end(&mut rgb)?;
            let indices: Vec<u8> = rgb
                .chunks_exact(3)
                .map(|pixel| palette.nearest[bin([pixel[0], pixel[1], pixel[2]])])
                .collect();
            let frame = changed(&shown, &indices, width, height);
            encoder
                .write_frame(&gif::Frame {
                    delay: (end(index + 1) - end(index)) as u16,
                    dispose: gif::DisposalMethod::Keep,
                    transparent: Some(AS_BEFORE),
                    ..frame
                })
                .map_err(io::Error::other)?;
            shown = indices;
        }
        Ok(())
    }
}

/// Index in the palette that stands for "as in the frame before".
const AS_BEFORE: u8 = COLORS as u8;

/// Returns the smallest rectangle that differs, with unchanged pixels left out.
fn changed(shown: &[u8], new: &[u8], width: u16, height: u16) -> gif::Frame<'static> {
    let whole = gif::Frame {
        width,
        height,
        buffer: new.to_vec().into(),
        ..gif::Frame::default()
    };
    if shown.len() != new.len() {
        return whole;
    }
    let w = usize::from(width);
    let differs = |row: usize| shown[row * w..][..w] != new[row * w..][..w];
    let rows = usize::from(height);
    let Some(top) = (0..rows).find(|&row| differs(row)) else {
        // A frame must have at least one pixel.
        return gif::Frame {
            width: 1,
            height: 1,
            buffer: vec![AS_BEFORE].into(),
            ..gif::Frame::default()
        };
    };
    let bottom = (0..rows).rfind(|&row| differs(row)).unwrap_or(top);
    let column_differs =
        |column: usize| (top..=bottom).any(|row| shown[row * w + column] != new[row * w + column]);
    let left = (0..w).find(|&column| column_differs(column)).unwrap_or(0);
    let right = (0..w)
        .rfind(|&column| column_differs(column))
        .unwrap_or(w - 1);
    let mut buffer = Vec::with_capacity((right - left + 1) * (bottom - top + 1));
    for row in top..=bottom {
        for at in row * w + left..=row * w + right {
            buffer.push(if shown[at] == new[at] {
                AS_BEFORE
            } else {
                new[at]
            });
        }
    }
    gif::Frame {
        left: left as u16,
        top: top as u16,
        width: (right - left + 1) as u16,
        height: (bottom - top + 1) as u16,
        buffer: buffer.into(),
        ..gif::Frame::default()
    }
}

fn bin(color: Color) -> usize {
    let part = |i: usize| usize::from(color[i] >> (8 - BITS));
    part(0) << (2 * BITS) | part(1) << BITS | part(2)
}

/// A group of colors with equal leading bits, with its mean color and weight.
#[derive(Clone, Copy)]
struct Counted {
    bin: usize,
    color: [f64; 3],
    weight: f64,
}

struct Palette {
    colors: Vec<Color>,
    /// Index in the palette of each bin.
    nearest: Vec<u8>,
}

impl Palette {
    /// Chooses the colors by median cut: halves the group of colors with the largest spread along its longest side, until
    /// there are enough groups.
    fn cut(counts: &[(u64, [u64; 3])]) -> Self {
        let mut all: Vec<Counted> = counts
            .iter()
            .enumerate()
            .filter(|(_, (count, _))| *count > 0)
            .map(|(bin, (count, sum))| Counted {
                bin,
                color: sum.map(|sum| sum as f64 / *count as f64),
                // Small areas count for more than their share: edges and highlights are small but visible.
                weight: (*count as f64).sqrt(),
            })
            .collect();
        let mut groups: Vec<(usize, usize)> = vec![(0, all.len())];
        while groups.len() < COLORS {
            let Some((which, axis, spread)) = groups
                .iter()
                .enumerate()
                .map(|(which, &(start, end))| {
                    let (axis, spread) = widest(&all[start..end]);
                    (which, axis, spread)
                })
                .max_by(|a, b| a.2.total_cmp(&b.2))
            else {
                break;
            };
            if spread <= 0.0 {
                break;
            }
            let (start, end) = groups[which];
            let group = &mut all[start..end];
            group.sort_by(|a, b| {
                a.color[axis]
                    .total_cmp(&b.color[axis])
                    .then(a.bin.cmp(&b.bin))
            });
            let mean = mean(group)[axis];
            let middle = group
                .iter()
                .position(|c| c.color[axis] > mean)
                .unwrap_or(1)
                .max(1);
            groups[which] = (start, start + middle);
            groups.push((start + middle, end));
        }
        let colors: Vec<Color> = groups
            .iter()
            .map(|&(start, end)| {
                // A color that dominates its group stays exact, so that large even areas do not shift.
                let group = &all[start..end];
                let total: f64 = group.iter().map(|c| c.weight * c.weight).sum();
                let color = group
                    .iter()
                    .find(|c| c.weight * c.weight > 0.5 * total)
                    .map_or_else(|| mean(group), |c| c.color);
                color.map(|c| c.round() as u8)
            })
            .collect();
        let mut nearest = vec![0_u8; counts.len()];
        for counted in &all {
            nearest[counted.bin] = (0..colors.len())
                .min_by(|&a, &b| {
                    distance(counted.color, colors[a])
                        .total_cmp(&distance(counted.color, colors[b]))
                })
                .unwrap_or(0) as u8;
        }
        Self { colors, nearest }
    }

    fn bytes(&self) -> Vec<u8> {
        let mut bytes: Vec<u8> = self.colors.iter().flatten().copied().collect();
        bytes.resize(3 * (COLORS + 1), 0);
        bytes
    }
}

fn mean(group: &[Counted]) -> [f64; 3] {
    let total: f64 = group.iter().map(|c| c.weight).sum();
    core::array::from_fn(|i| group.iter().map(|c| c.weight * c.color[i]).sum::<f64>() / total)
}

/// Returns the channel in which a group spreads most, and its weighted squared spread there.
fn widest(group: &[Counted]) -> (usize, f64) {
    if group.len() < 2 {
        return (0, 0.0);
    }
    let mean = mean(group);
    let spread = |axis: usize| {
        group
            .iter()
            .map(|c| c.weight * (c.color[axis] - mean[axis]).powi(2))
            .sum::<f64>()
    };
    (0..3)
        .map(|axis| (axis, spread(axis)))
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap_or((0, 0.0))
}

/// Returns the squared distance of two colors; green counts most, as for the eye.
fn distance(a: [f64; 3], b: Color) -> f64 {
    [2.0, 4.0, 3.0]
        .iter()
        .zip(a.iter().zip(&b))
        .map(|(weight, (&a, &b))| weight * (a - f64::from(b)).powi(2))
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(shade: u8) -> Picture {
        let mut rgb = vec![0x11; 3 * 40 * 30];
        for pixel in rgb.chunks_exact_mut(3).skip(100).take(200) {
            pixel.copy_from_slice(&[shade, 0x85, 0x87]);
        }
        Picture {
            width: 40,
            height: 30,
            rgb,
        }
    }

    #[test]
    fn frames_come_back_in_their_colors() {
        let mut film = Film::new(25.0);
        let pictures = [picture(0), picture(0), picture(200), picture(90)];
        for picture in &pictures {
            film.push(picture).unwrap();
        }
        let mut bytes = Vec::new();
        film.write(&mut bytes).unwrap();
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(bytes.as_slice()).unwrap();
        let mut screen = vec![0_u8; 3 * 40 * 30];
        for picture in &pictures {
            let frame = decoder.read_next_frame().unwrap().unwrap();
            assert_eq!(frame.delay, 4);
            for (i, pixel) in frame.buffer.chunks_exact(4).enumerate() {
                let (row, column) = (i / usize::from(frame.width), i % usize::from(frame.width));
                let at =
                    3 * ((row + usize::from(frame.top)) * 40 + column + usize::from(frame.left));
                if pixel[3] != 0 {
                    screen[at..at + 3].copy_from_slice(&pixel[..3]);
                }
            }
            assert_eq!(screen, picture.rgb);
        }
        assert!(decoder.read_next_frame().unwrap().is_none());
    }

    #[test]
    fn pictures_of_another_size_are_refused() {
        let mut film = Film::new(25.0);
        assert!(film.write(Vec::new()).is_err());
        film.push(&picture(0)).unwrap();
        let other = Picture {
            width: 20,
            height: 30,
            rgb: vec![0; 3 * 20 * 30],
        };
        assert!(film.push(&other).is_err());
    }
}
