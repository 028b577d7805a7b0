//! Pictures side by side, each under its title.

use core::convert::Infallible;

use embedded_graphics::mono_font::{MonoTextStyle, ascii};
use embedded_graphics::pixelcolor::Rgb888;
use embedded_graphics::prelude::*;
use embedded_graphics::primitives::Rectangle;
use embedded_graphics::text::{Baseline, Text};

use super::Picture;
use super::palette::Color;

/// Height of the strip with the titles \[pixels\].
const STRIP: u32 = 28;

/// Gap between two pictures \[pixels\].
const GAP: u32 = 4;

/// Color of the strip with the titles.
const STRIP_COLOR: Color = [0x20, 0x20, 0x20];

/// Joins pictures of one size, from left to right, each under its title. Returns `None` if there is no picture, or their
/// sizes differ.
///
/// ```
/// use lahar_io::image::{Picture, side_by_side};
///
/// let picture = Picture { width: 90, height: 10, rgb: vec![0; 3 * 90 * 10] };
/// let both = side_by_side(&[("apic", &picture), ("pic", &picture)]).unwrap();
/// assert!(both.width > 180 && both.height > 10);
/// ```
pub fn side_by_side(pictures: &[(&str, &Picture)]) -> Option<Picture> {
    let (_, first) = pictures.first()?;
    let (width, height) = (first.width, first.height);
    if pictures
        .iter()
        .any(|(_, picture)| (picture.width, picture.height) != (width, height))
    {
        return None;
    }
    let count = pictures.len() as u32;
    let mut whole = Picture {
        width: count * width + (count - 1) * GAP,
        height: height + STRIP,
        rgb: Vec::new(),
    };
    let pixels = whole.width as usize * whole.height as usize;
    whole.rgb = STRIP_COLOR.repeat(pixels);
    for (index, (title, picture)) in (0..).zip(pictures) {
        let left = index * (width + GAP);
        let font = MonoTextStyle::new(&ascii::FONT_9X18, Rgb888::WHITE);
        let corner = Point::new(left as i32 + 8, (STRIP as i32 - 18) / 2);
        let strip = Rectangle::new(Point::new(left as i32, 0), Size::new(width, STRIP));
        let Ok(_) = Text::with_baseline(title, corner, font, Baseline::Top)
            .draw(&mut Canvas(&mut whole).clipped(&strip));
        for row in 0..height {
            let from = 3 * (row * width) as usize;
            let to = 3 * ((row + STRIP) * whole.width + left) as usize;
            let len = 3 * width as usize;
            whole.rgb[to..to + len].copy_from_slice(&picture.rgb[from..from + len]);
        }
    }
    Some(whole)
}

/// A picture as the library that draws text needs it.
struct Canvas<'a>(&'a mut Picture);

impl OriginDimensions for Canvas<'_> {
    fn size(&self) -> Size {
        Size::new(self.0.width, self.0.height)
    }
}

impl DrawTarget for Canvas<'_> {
    type Color = Rgb888;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Rgb888>>>(
        &mut self,
        pixels: I,
    ) -> Result<(), Infallible> {
        let (width, height) = (self.0.width, self.0.height);
        for Pixel(Point { x, y }, color) in pixels {
            let inside = (0..width as i32).contains(&x) && (0..height as i32).contains(&y);
            if inside {
                let at = 3 * (y as usize * width as usize + x as usize);
                self.0.rgb[at..at + 3].copy_from_slice(&[color.r(), color.g(), color.b()]);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(shade: u8) -> Picture {
        Picture {
            width: 90,
            height: 10,
            rgb: vec![shade; 3 * 90 * 10],
        }
    }

    #[test]
    fn each_picture_stands_under_its_title() {
        let (a, b) = (plain(100), plain(200));
        // The second title is too long: it ends with its picture.
        let whole = side_by_side(&[("transfer", &a), ("a very long title, cut", &b)]).unwrap();
        assert_eq!((whole.width, whole.height), (90 + GAP + 90, 10 + STRIP));
        let pixel = |x: u32, y: u32| whole.rgb[3 * (y * whole.width + x) as usize];
        assert_eq!(pixel(5, STRIP + 5), 100);
        assert_eq!(pixel(90 + 1, STRIP + 5), STRIP_COLOR[0]);
        assert_eq!(pixel(90 + GAP + 5, STRIP + 5), 200);
        let white = |from: u32, to: u32| {
            let strip = (0..STRIP).flat_map(|y| (from..to).map(move |x| (x, y)));
            strip.filter(|&(x, y)| pixel(x, y) == 255).count()
        };
        assert!(white(0, 90) > 50 && white(90 + GAP, whole.width) > 50);
        assert_eq!(white(90, 90 + GAP), 0);
    }

    #[test]
    fn pictures_of_different_sizes_are_refused() {
        let mut small = plain(0);
        (small.height, small.rgb) = (5, vec![0; 3 * 90 * 5]);
        assert_eq!(side_by_side(&[("a", &plain(0)), ("b", &small)]), None);
        assert_eq!(side_by_side(&[]), None);
    }
}
