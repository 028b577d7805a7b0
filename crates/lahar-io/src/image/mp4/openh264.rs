//! MP4 made by OpenH264, which is compiled into this program, and written to a file by muxide.

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;

use muxide::api::{Muxer, MuxerBuilder, VideoCodec};
use openh264::OpenH264API;
use openh264::encoder::{
    Encoder, EncoderConfig, FrameRate, FrameType, IntraFramePeriod, RateControlMode, VuiConfig,
};
use openh264::formats::{RgbSliceU8, YUVBuffer};

use super::super::Picture;

/// Most pictures from one key picture to the next. Players can seek to key pictures only.
const BETWEEN_KEYS: u32 = 60;

/// A film that is being made.
pub(super) struct OpenH264 {
    encoder: Encoder,
    muxer: Muxer<BufWriter<File>>,
    rate: f64,
    /// Number of pictures so far.
    pictures: u64,
    /// The error that ended the film early.
    failed: Option<io::Error>,
}

impl OpenH264 {
    pub(super) fn start(path: &Path, rate: f64, first: &Picture) -> io::Result<Self> {
        // The same quality throughout, whatever number of bytes that takes.
        let config = EncoderConfig::new()
            .max_frame_rate(FrameRate::from_hz(rate as f32))
            .rate_control_mode(RateControlMode::Off)
            .skip_frames(false)
            .vui(VuiConfig::bt601())
            .intra_frame_period(IntraFramePeriod::from_num_frames(BETWEEN_KEYS));
        let encoder = Encoder::with_api_config(OpenH264API::from_source(), config)
            .map_err(io::Error::other)?;
        let [width, height] = [first.width, first.height].map(|side| side.next_multiple_of(2));
        let muxer = MuxerBuilder::new(BufWriter::new(File::create(path)?))
            .video(VideoCodec::H264, width, height, rate)
            .with_fast_start(true)
            .build()
            .map_err(io::Error::other)?;
        Ok(Self {
            encoder,
            muxer,
            rate,
            pictures: 0,
            failed: None,
        })
    }

    /// Adds a picture.
    ///
    /// # Errors
    /// If the encoder fails; then [`Self::finish`] returns the reason.
    pub(super) fn push(&mut self, picture: &Picture) -> io::Result<()> {
        self.encode(picture).map_err(|error| {
            let kind = error.kind();
            self.failed = Some(error);
            io::Error::from(kind)
        })
    }

    fn encode(&mut self, picture: &Picture) -> io::Result<()> {
        let (rgb, sides) = even(picture);
        let yuv = YUVBuffer::from_rgb8_source(RgbSliceU8::new(&rgb, sides));
        let stream = self.encoder.encode(&yuv).map_err(io::Error::other)?;
        let is_key = matches!(stream.frame_type(), FrameType::IDR | FrameType::I);
        let time = self.pictures as f64 / self.rate;
        self.pictures += 1;
        (self.muxer.write_video(time, &stream.to_vec(), is_key)).map_err(io::Error::other)
    }

    /// Ends the film.
    ///
    /// # Errors
    /// If the encoder has failed, or the file cannot be written.
    pub(super) fn finish(self) -> io::Result<()> {
        match self.failed {
            Some(error) => Err(error),
            None => self.muxer.finish().map_err(io::Error::other),
        }
    }
}

/// Returns the pixels with both sides even, as H.264 needs; an odd side gets its last row or column twice.
fn even(picture: &Picture) -> (Vec<u8>, (usize, usize)) {
    let (width, height) = (picture.width as usize, picture.height as usize);
    let row_at = |row: usize| &picture.rgb[3 * width * row.min(height - 1)..][..3 * width];
    let mut rgb = Vec::with_capacity(3 * (width + 1) * (height + 1));
    for row in 0..height.next_multiple_of(2) {
        rgb.extend_from_slice(row_at(row));
        if !width.is_multiple_of(2) {
            rgb.extend_from_slice(&row_at(row)[3 * (width - 1)..]);
        }
    }
    (rgb, (width.next_multiple_of(2), height.next_multiple_of(2)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use openh264::decoder::Decoder;
    use openh264::formats::YUVSource;

    /// A bright square that moves to the right with the number of the picture.
    fn picture(number: usize, width: u32, height: u32) -> Picture {
        let mut rgb = [0x11, 0x2f, 0x41].repeat(width as usize * height as usize);
        for row in 8..24 {
            for column in 8 + 2 * number..24 + 2 * number {
                let at = 3 * (row * width as usize + column);
                rgb[at..at + 3].copy_from_slice(&[0xed, 0x55, 0x3b]);
            }
        }
        Picture { width, height, rgb }
    }

    #[test]
    fn films_are_decoded_to_their_pictures() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("film.mp4");
        // Odd sides.
        let pictures: Vec<Picture> = (0..12).map(|number| picture(number, 95, 63)).collect();
        let mut film = OpenH264::start(&path, 24.0, &pictures[0]).unwrap();
        let mut decoder = Decoder::new().unwrap();
        for picture in &pictures {
            film.push(picture).unwrap();
        }
        film.finish().unwrap();
        let bytes = std::fs::read(&path).unwrap();
        assert_eq!(&bytes[4..8], b"ftyp");
        let boxes = boxes(&bytes);
        let names: Vec<&[u8]> = boxes.iter().map(|(name, _)| *name).collect();
        // The index comes first, so that a browser can begin before it has the whole file.
        assert_eq!(names, [b"ftyp", b"moov", b"mdat"]);

        let mut seen = 0;
        for unit in units(boxes[2].1) {
            let annex_b = [&[0, 0, 0, 1], unit].concat();
            let Some(frame) = decoder.decode(&annex_b).unwrap() else {
                continue;
            };
            let (width, height) = frame.dimensions();
            assert_eq!((width, height), (96, 64));
            let mut rgb = vec![0; 3 * width * height];
            frame.write_rgb8(&mut rgb);
            for (row, column) in [(16, 16 + 2 * seen), (40, 10), (62, 94)] {
                for part in 0..3 {
                    let was = pictures[seen].rgb[3 * (row * 95 + column) + part];
                    let is = rgb[3 * (row * width + column) + part];
                    assert!(was.abs_diff(is) < 12, "{seen}: {was} {is}");
                }
            }
            seen += 1;
        }
        assert_eq!(seen, pictures.len());
    }

    #[test]
    fn a_film_too_large_says_so() {
        let folder = tempfile::tempdir().unwrap();
        let picture = picture(0, 4000, 100);
        let mut film = OpenH264::start(&folder.path().join("film.mp4"), 24.0, &picture).unwrap();
        assert!(film.push(&picture).is_err());
        assert!(film.finish().unwrap_err().to_string().contains("3840"));
    }

    /// Returns the boxes of a file: name and contents.
    fn boxes(mut bytes: &[u8]) -> Vec<(&[u8], &[u8])> {
        let mut boxes = vec![];
        while let Some((size, _)) = bytes.split_first_chunk() {
            let (one, rest) = bytes.split_at(u32::from_be_bytes(*size) as usize);
            boxes.push((&one[4..8], &one[8..]));
            bytes = rest;
        }
        boxes
    }

    /// Returns the units of an H.264 stream, each of which follows its length.
    fn units(mut bytes: &[u8]) -> Vec<&[u8]> {
        let mut units = vec![];
        while let Some((size, rest)) = bytes.split_first_chunk() {
            let (one, rest) = rest.split_at(u32::from_be_bytes(*size) as usize);
            units.push(one);
            bytes = rest;
        }
        units
    }
}
