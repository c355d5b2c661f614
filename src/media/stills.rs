//! Numbered pictures, folders of pictures, and a single picture.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use image::imageops::FilterType;
use motionscope_core::base::{Error, Stop};
use motionscope_core::data::{ClipInfo, Frame};
use motionscope_core::geometry::Grid;

use super::names::file_name;
use super::picture::Contrast;
use super::sequence::Sequence;
use super::stereo::keep_left;
use super::tiff::Page;
use super::{Decoder, Open, Source, check_size, picture};
use crate::files;

/// Opens the folder, pattern or picture at `path`; a numbered picture brings those that come after it.
///
/// # Errors
/// One sentence, without the file's name.
pub(crate) fn open(path: &Path, options: &Open) -> Result<Source, Error> {
    let pages = if files::is_file(path) { picture::pages(path) } else { Default::default() };
    if pages.0.len() > 1 {
        return stack(path, &pages, options);
    }
    let mut sequence = Sequence::find(path)?;
    keep_left(&mut sequence, &options.given);
    clip(path, file_name(path), sequence, (Fit::Exact, options))
}

/// Opens pictures as one clip.
///
/// # Errors
/// One sentence, without the name of the first file.
pub(crate) fn of_files(files: Vec<PathBuf>, options: &Open) -> Result<Source, Error> {
    let first = files.first().cloned().unwrap_or_default();
    clip(&first, file_name(&first), Sequence { files, warnings: Vec::new() }, (Fit::Exact, options))
}

/// Opens two pictures as one clip.
///
/// # Errors
/// One sentence, without the name of the first file.
pub(crate) fn pair(files: &[PathBuf; 2], options: &Open) -> Result<Source, Error> {
    let [first, second] = files;
    let name = format!("{} → {}", file_name(first), file_name(second));
    let fit = match [first, second].map(|file| picture::size(file)) {
        [Some(one), Some(other)] if one != other => Fit::of(one, other),
        // A damaged picture is reported when it is shown.
        _ => Fit::Exact,
    };
    let size = |file: &Path| picture::size(file).map_or_else(String::new, sized);
    let warnings = match fit {
        Fit::Exact => Vec::new(),
        Fit::Scaled => vec![format!(
            "{} is scaled from {} to {}, the size of {}",
            file_name(second),
            size(second),
            size(first),
            file_name(first)
        )],
        Fit::Padded(to) => vec![format!(
            "{} has {} and {} has {}: both are padded with black at the right and at the bottom to {}",
            file_name(first),
            size(first),
            file_name(second),
            size(second),
            sized(to)
        )],
    };
    clip(first, name, Sequence { files: files.to_vec(), warnings }, (fit, options))
}

/// How a picture of another size than the first one becomes a frame of the clip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fit {
    /// It is refused.
    Exact,
    /// It is scaled to the size of the first picture.
    Scaled,
    /// Every picture is padded to this width and height in px, so that coordinates stay those of its file.
    Padded((usize, usize)),
}

impl Fit {
    /// The way for two pictures of different sizes: one with the proportions of the other is the same view at another scale, so it is
    /// scaled; others, such as an object and a scene, keep their pixels.
    fn of((width, height): (usize, usize), (w, h): (usize, usize)) -> Self {
        // A side may be rounded by half a pixel of the smaller picture.
        let (crossed, slack) = ((width * h).abs_diff(w * height), (width + height).max(w + h));
        match 2 * crossed <= slack {
            true => Self::Scaled,
            false => Self::Padded((width.max(w), height.max(h))),
        }
    }

    /// `frame` in the size of the clip.
    fn apply(self, frame: &Frame, size: (usize, usize)) -> Result<Frame, Error> {
        let fitted = match (self, frame.color()) {
            (Self::Scaled, Some(rgb)) => scaled::<image::Rgb<u8>, 3>(rgb, size).map(Frame::rgb),
            (Self::Scaled, None) => scaled::<image::Luma<u8>, 1>(&frame.luma().map(|gray| [*gray]), size)
                .map(|gray| Frame::gray(gray.map(|[gray]| *gray))),
            (_, Some(rgb)) => Some(Frame::rgb(padded(rgb, size))),
            (_, None) => Some(Frame::gray(padded(frame.luma(), size))),
        };
        fitted.ok_or_else(|| Error::new("it cannot be scaled to the size of the other picture"))
    }
}

/// `pixels` scaled to a width and height in px; where it becomes smaller, pixels are averaged.
fn scaled<P: image::Pixel<Subpixel = u8> + 'static, const N: usize>(
    pixels: &Grid<[u8; N]>,
    (width, height): (usize, usize),
) -> Option<Grid<[u8; N]>> {
    let side = |side: usize| u32::try_from(side).ok();
    let from = pixels.cells().as_flattened().to_vec();
    let image = image::ImageBuffer::<P, _>::from_raw(side(pixels.width())?, side(pixels.height())?, from)?;
    let to = image::imageops::resize(&image, side(width)?, side(height)?, FilterType::Triangle).into_raw();
    Grid::from_vec(width, height, to.as_chunks().0.to_vec()).ok()
}

/// `pixels` at the top left of a larger picture that is black elsewhere.
fn padded<T: Copy + Default>(pixels: &Grid<T>, (width, height): (usize, usize)) -> Grid<T> {
    let inside = |x, y| x < pixels.width() && y < pixels.height();
    Grid::from_fn(width, height, |x, y| if inside(x, y) { pixels[(x, y)] } else { T::default() })
}

fn sized((width, height): (usize, usize)) -> String {
    format!("{width}×{height} px")
}

/// The clip of the pages of one TIFF that have the same size; there are so many `others`.
fn stack(path: &Path, (pages, others): &(Vec<Page>, usize), options: &Open) -> Result<Source, Error> {
    let first = picture::open_page(path, pages.first().map(|page| page.directory))?;
    let mut info = ClipInfo {
        name: file_name(path),
        width: first.size.0,
        height: first.size.1,
        frames: Some(pages.len()),
        fps: None,
        container: first.codec.into(),
        codec: first.codec.into(),
        warnings: first.warnings(),
    };
    if *others > 0 {
        info.warnings.push(format!("pages of another size than {} are left out: {others}", sized(first.size)));
    }
    let places: Arc<[Place]> =
        pages.iter().map(|page| Place { file: path.into(), page: Some(page.directory) }).collect();
    let contrast = first.is_deep().then(|| contrast(&places, options, &mut info.warnings)).transpose()?;
    Ok(Source { contrast, ..Source::new(info, Stills { places, size: first.size, fit: Fit::Exact, contrast }) })
}

/// Most pictures that are decoded to find the range of their samples.
const MOST_RANGED: usize = 64;

/// The range in which all 16-bit pictures are shown, so that brightness stays constant over time; with a warning that says so.
fn contrast(places: &[Place], options: &Open, warnings: &mut Vec<String>) -> Result<Contrast, Error> {
    if let Some(given) = options.given.contrast {
        let Contrast { low, high } = given;
        warnings.push(format!("16 bits per channel are reduced to 8: {low} is black and {high} white, as given"));
        return Ok(given);
    }
    let count = places.len().min(MOST_RANGED);
    let mut range: Option<Contrast> = None;
    for k in 0..count {
        options.report(k as f32 / count as f32)?;
        // Evenly, with the first and the last.
        let Place { file, page } = &places[k * (places.len() - 1) / (count - 1).max(1)];
        // Damage is reported when the frame is shown.
        if let Ok(Some(own)) = picture::open_page(file, *page).and_then(|picture| picture.extremes()) {
            range = Some(range.map_or(own, |range| range.with(own)));
        }
    }
    let shown = range.map_or_else(Contrast::default, Contrast::shown);
    let Contrast { low, high } = shown;
    let from = if Some(shown) == range { "the range of the whole clip" } else { "the bits that its samples use" };
    let seen = if count < places.len() { format!(", found in {count} of its frames") } else { String::new() };
    warnings.push(if (low, high) == (0, u16::MAX) {
        "16 bits per channel are reduced to 8".into()
    } else {
        format!(
            "16 bits per channel are reduced to 8: {low} is black and {high} white in every frame, {from}{seen}; --contrast {low}..{high} sets another"
        )
    });
    Ok(Contrast { low, high })
}

/// The clip `name` of a `sequence` of pictures, opened from `path`.
fn clip(path: &Path, name: String, sequence: Sequence, (fit, options): (Fit, &Open)) -> Result<Source, Error> {
    let Sequence { files, mut warnings } = sequence;
    let is_alone = files.len() == 1;
    match files.first().map(|first| (first, picture::pages(first))) {
        Some((first, pages)) if pages.0.len() > 1 && is_alone => return stack(first, &pages, options),
        Some((first, (pages, _))) if pages.len() > 1 => {
            let (name, count) = (file_name(first), pages.len());
            warnings
                .push(format!("{name} has {count} pages, of which the first is a frame; open it by itself for all"));
        }
        _ => {}
    }
    let Some(first) = files.first() else { return Err(Error::new("it holds no pictures")) };
    let picture = picture::open(first).map_err(|why| if first == path { why } else { about(first, &why) })?;
    warnings.extend(picture.warnings());
    let size = if let Fit::Padded(size) = fit { size } else { picture.size };
    check_size(size.0, size.1)?;
    if fit == Fit::Exact {
        warnings.extend(misfits(&files, size, options)?);
    }
    let mut info = ClipInfo {
        name,
        width: size.0,
        height: size.1,
        frames: Some(files.len()),
        fps: None,
        container: CONTAINER.into(),
        codec: picture.codec.into(),
        warnings,
    };
    let is_deep = picture.is_deep();
    let places: Arc<[Place]> = files.iter().map(|file| Place { file: file.clone(), page: None }).collect();
    let contrast = is_deep.then(|| contrast(&places, options, &mut info.warnings)).transpose()?;
    let source = Source::new(info, Stills { places, size, fit, contrast });
    Ok(Source { contrast, files: Arc::from(files), ..source })
}

/// The container name of image sequences.
pub(crate) const CONTAINER: &str = "images";

/// Most headers that are read when a folder is opened; the other pictures are measured when they are shown.
const MOST_HEADERS: usize = 2000;

/// Tells of pictures that are not of the first one's `size`, going by their headers.
fn misfits(files: &[PathBuf], size: (usize, usize), options: &Open) -> Result<Option<String>, Error> {
    let mut odd = None;
    let mut count = 0;
    for (done, file) in files.iter().enumerate().take(MOST_HEADERS).skip(1) {
        options.report(done as f32 / files.len() as f32)?;
        // What is damaged is told when it is shown.
        if let Some(other) = picture::size(file).filter(|other| *other != size) {
            odd.get_or_insert((file, other));
            count += 1;
        }
    }
    Ok(odd.map(|(file, (w, h))| {
        let others = match count - 1 {
            0 => String::new(),
            n => format!(", and {n} more differ as well"),
        };
        let (name, (width, height)) = (file_name(file), size);
        format!("{name} cannot be shown: it is {w}×{h} px, not {width}×{height} px as the first picture{others}")
    }))
}

fn about(file: &Path, why: &Error) -> Error {
    Error::new(format!("{}: {why}", file_name(file)))
}

/// Where a frame lies.
struct Place {
    file: PathBuf,
    /// Where the directory of its page is, if it is a page of a TIFF.
    page: Option<u32>,
}

/// One picture per frame.
struct Stills {
    places: Arc<[Place]>,
    size: (usize, usize),
    fit: Fit,
    /// The range of samples that is shown, of pictures with 16 bits.
    contrast: Option<Contrast>,
}

impl Decoder for Stills {
    fn decode(&mut self, index: usize, _stop: &Stop, keep: &mut dyn FnMut(usize, Frame)) -> Result<(), Error> {
        let Some(place) = self.places.get(index) else { return Ok(()) };
        let frame = self.read(place).map_err(|why| about(&place.file, &why))?;
        keep(index, frame);
        Ok(())
    }
}

impl Stills {
    fn read(&self, place: &Place) -> Result<Frame, Error> {
        let picture = picture::open_page(&place.file, place.page)?;
        let contrast = self.contrast.unwrap_or_default();
        let ((w, h), (width, height)) = (picture.size, self.size);
        if (w, h) == (width, height) {
            return picture.frame(contrast);
        }
        if self.fit == Fit::Exact {
            return Err(Error::new(format!(
                "it is {w}×{h} px, not {width}×{height} px as the first picture: scale it to that size"
            )));
        }
        self.fit.apply(&picture.frame(contrast)?, self.size)
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use image::{DynamicImage, ImageFormat};
    use motionscope_core::data::Clip;
    use proptest::prelude::*;

    use super::*;
    use crate::media;

    const FORMATS: [(&str, ImageFormat); 6] = [
        ("png", ImageFormat::Png),
        ("jpg", ImageFormat::Jpeg),
        ("tif", ImageFormat::Tiff),
        ("bmp", ImageFormat::Bmp),
        ("ppm", ImageFormat::Pnm),
        ("webp", ImageFormat::WebP),
    ];

    /// A smooth picture of `width × 6` pixels that `t` tells from others.
    fn picture(width: u32, t: u8) -> DynamicImage {
        image::RgbImage::from_fn(width, 6, |x, y| image::Rgb([40 * t, 8 * x as u8, 20 * y as u8])).into()
    }

    fn encode(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
        let mut bytes = std::io::Cursor::new(Vec::new());
        image.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    fn open(path: &Path) -> Result<Clip, Error> {
        media::open(path, &Open::default()).map(|opened| opened.clip)
    }

    #[test]
    fn every_format_gives_its_pixels() {
        for (extension, format) in FORMATS {
            let folder = tempfile::tempdir().unwrap();
            for t in 1..4 {
                let path = folder.path().join(format!("f{t}.{extension}"));
                fs::write(path, encode(&picture(8, t), format)).unwrap();
            }
            let clip = open(&folder.path().join(format!("f1.{extension}"))).unwrap();
            assert_eq!((clip.size(), clip.info().frames), ((8, 6), Some(3)), "{extension}");
            assert_eq!(clip.info().warnings, [""; 0]);
            // JPEG is not exact.
            let far = if extension == "jpg" { 12 } else { 0 };
            let frame = clip.frame(2).unwrap();
            let near = |a: &[u8; 3], b: &[u8; 3]| a.iter().zip(b).all(|(a, b)| a.abs_diff(*b) <= far);
            let wanted = picture(8, 3).into_rgb8();
            let cells = frame.color().unwrap().cells();
            assert!(cells.iter().zip(wanted.as_chunks().0).all(|(a, b)| near(a, b)), "{extension}");
        }
    }

    #[test]
    fn frames_are_called_as_their_files() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["f9.png", "f10.png", "f12.png"] {
            fs::write(folder.path().join(name), encode(&picture(8, 1), ImageFormat::Png)).unwrap();
        }
        let clip = open(&folder.path().join("f10.png")).unwrap();
        let names = [0, 1, 2].map(|index| clip.frame_name(index));
        assert_eq!(names, [Some("f10.png".into()), Some("f12.png".into()), None]);
        let made = Clip::from_frames("made", vec![clip.frame(0).unwrap().as_ref().clone()]).unwrap();
        assert_eq!(made.frame_name(0), None);
    }

    #[test]
    fn deep_and_clear_pictures_are_reported() {
        let folder = tempfile::tempdir().unwrap();
        let deep: DynamicImage = image::ImageBuffer::<image::Luma<u16>, _>::from_pixel(2, 2, [0x8080].into()).into();
        let clear: DynamicImage = image::RgbaImage::from_pixel(2, 2, [200, 100, 50, 128].into()).into();
        fs::write(folder.path().join("deep.png"), encode(&deep, ImageFormat::Png)).unwrap();
        fs::write(folder.path().join("clear.png"), encode(&clear, ImageFormat::Png)).unwrap();
        let deep = open(&folder.path().join("deep.png")).unwrap();
        assert_eq!(deep.info().warnings, ["16 bits per channel are reduced to 8"]);
        assert_eq!(deep.frame(0).unwrap().luma()[(0, 0)], 0x80);
        assert!(deep.frame(0).unwrap().color().is_none());
        let clear = open(&folder.path().join("clear.png")).unwrap();
        assert_eq!(clear.info().warnings, ["transparent pixels are shown on black"]);
        assert_eq!(clear.frame(0).unwrap().color().unwrap()[(1, 1)], [100, 50, 25]);
        assert!(clear.pair(0).unwrap_err().to_string().contains("single frame"));
    }

    /// Opens a folder of 16-bit pictures with `rows` of samples.
    fn deep_clip(rows: &[[u16; 4]]) -> Clip {
        let folder = tempfile::tempdir().unwrap();
        for (t, row) in rows.iter().enumerate() {
            let image = image::ImageBuffer::<image::Luma<u16>, _>::from_vec(4, 1, row.to_vec()).unwrap();
            fs::write(folder.path().join(format!("f{t}.png")), encode(&image.into(), ImageFormat::Png)).unwrap();
        }
        let clip = open(folder.path()).unwrap();
        // The frames stay in the cache when the folder is gone.
        (0..rows.len()).for_each(|t| drop(clip.frame(t).unwrap()));
        clip
    }

    #[test]
    fn deep_pictures_keep_what_they_hold_and_one_brightness() {
        let grays = |rows: &[[u16; 4]]| {
            let clip = deep_clip(rows);
            (0..rows.len()).map(|t| clip.frame(t).unwrap().luma().cells().to_vec()).collect::<Vec<_>>()
        };
        for bits in [10, 12, 14, 16] {
            let most = (1_u32 << bits) - 1;
            let part = |share: f64| (f64::from(most) * share).round() as u16;
            // The second frame is darker, and has to stay so.
            let frames = grays(&[[0, part(0.25), part(0.5), part(1.0)], [0, part(0.25), part(0.5), part(0.5)]]);
            let wanted = [[0, 64, 128, 255], [0, 64, 128, 128]];
            let is_near = |(a, b): (&u8, &u8)| a.abs_diff(*b) <= 1;
            assert!(frames.iter().flatten().zip(wanted.as_flattened()).all(is_near), "{bits}: {frames:?}");
        }
        // Samples of 8 bits are left alone, a narrow range far from black fills all levels.
        assert_eq!(grays(&[[0, 1, 100, 255]]), [[0, 1, 100, 255]]);
        assert_eq!(grays(&[[30_000, 30_051, 30_102, 30_255]]), [[0, 51, 102, 255]]);
        assert!(deep_clip(&[[0, 5, 900, 1023]]).info().warnings[0].contains("1023 white"));
    }

    #[test]
    fn a_given_contrast_counts_and_both_views_have_one() {
        let folder = tempfile::tempdir().unwrap();
        for (name, row) in [("left", [0, 100, 500, 1000]), ("right", [0, 100, 500, 600])] {
            let image = image::ImageBuffer::<image::Luma<u16>, _>::from_vec(4, 1, row.to_vec()).unwrap();
            fs::write(folder.path().join(format!("{name}.png")), encode(&image.into(), ImageFormat::Png)).unwrap();
        }
        let open = |contrast: Option<&str>| {
            let right = Some(media::RightView::File(folder.path().join("right.png")));
            let contrast = contrast.map(|range| range.parse().unwrap());
            let given = media::Given { right, contrast, ..media::Given::default() };
            media::open(&folder.path().join("left.png"), &given.into()).unwrap().clip
        };
        let grays = |clip: &Clip| {
            let right = clip.right().expect("a right view");
            [clip, right].map(|view| view.frame(0).unwrap().luma().cells().to_vec())
        };
        let [left, right] = grays(&open(None));
        assert_eq!(left[..3], right[..3], "the same samples");
        assert_eq!(grays(&open(Some("100..500"))), [[0, 0, 255, 255]; 2]);
        assert!(["500..100", "1..1", "5", "0..70000"].iter().all(|range| range.parse::<Contrast>().is_err()));
    }

    /// A little-endian TIFF of `pages` of gray samples in `bytes` bytes each; `kinds` are the kinds of sub-file of the pages.
    fn tiff(size: (u32, u32), bytes: u32, pages: &[Vec<u8>], kinds: &[u32], format: u32) -> Vec<u8> {
        let mut file = b"II*\0".to_vec();
        file.extend(8_u32.to_le_bytes());
        for (t, (page, kind)) in pages.iter().zip(kinds).enumerate() {
            let entries = [
                (254_u16, 4_u16, *kind),
                (256, 4, size.0),
                (257, 4, size.1),
                (258, 3, 8 * bytes),
                (259, 3, 1),
                (262, 3, 1),
                (273, 4, file.len() as u32 + 2 + 12 * 11 + 4),
                (277, 3, 1),
                (278, 4, size.1),
                (279, 4, page.len() as u32),
                (339, 3, format),
            ];
            file.extend((entries.len() as u16).to_le_bytes());
            for (tag, kind, value) in entries {
                file.extend([tag.to_le_bytes(), kind.to_le_bytes()].concat());
                file.extend([1_u32.to_le_bytes(), value.to_le_bytes()].concat());
            }
            let next = file.len() as u32 + 4 + page.len() as u32;
            file.extend(if t + 1 == pages.len() { 0 } else { next }.to_le_bytes());
            file.extend(page);
        }
        file
    }

    #[test]
    fn pages_of_a_tiff_are_frames() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("stack8.tif");
        let gray = |t: u8| vec![t, 50 + t, 100, 150, 200, 250];
        fs::write(&path, tiff((3, 2), 1, &[gray(1), gray(2), gray(3)], &[0; 3], 1)).unwrap();
        for opened in [path.as_path(), folder.path()] {
            let clip = open(opened).unwrap();
            assert_eq!((clip.info().frames, clip.size()), (Some(3), (3, 2)));
            // Backwards as well as forwards.
            for t in [2, 0, 1] {
                assert_eq!(clip.frame(t).unwrap().luma().cells(), gray(t as u8 + 1), "{t}");
            }
        }
        let deep = |t: u16| [t, 400, 1023].iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>();
        fs::write(&path, tiff((3, 1), 2, &[deep(0), deep(1023)], &[0; 2], 1)).unwrap();
        let clip = open(&path).unwrap();
        assert_eq!([0, 1].map(|t| clip.frame(t).unwrap().luma().cells().to_vec()), [[0, 100, 255], [255, 100, 255]]);
        // A thumbnail is no frame, wherever it stands.
        fs::write(&path, tiff((3, 2), 1, &[gray(1), gray(2)], &[0, 1], 1)).unwrap();
        assert_eq!(open(&path).unwrap().info().frames, Some(1));
        fs::write(&path, tiff((3, 2), 1, &[gray(9), gray(1), gray(2)], &[1, 0, 0], 1)).unwrap();
        let clip = open(&path).unwrap();
        assert_eq!((clip.info().frames, clip.frame(0).unwrap().luma().cells()), (Some(2), &gray(1)[..]));
        // What cannot be read is named.
        fs::write(&path, tiff((1, 1), 4, &[vec![0; 4]], &[0], 3)).unwrap();
        assert!(open(&path).unwrap_err().to_string().contains("floating-point"));
        fs::write(&path, b"II+\0\x08\0\0\0\x10\0\0\0\0\0\0\0").unwrap();
        assert!(open(&path).unwrap_err().to_string().contains("BigTIFF"));
        // Directories that lead in a circle end.
        let mut circle = tiff((3, 2), 1, &[gray(1), gray(2)], &[0; 2], 1);
        let last = circle.len() - 6 - 4;
        circle[last..last + 4].copy_from_slice(&8_u32.to_le_bytes());
        fs::write(&path, circle).unwrap();
        assert_eq!(open(&path).unwrap().info().frames, Some(2));
    }

    #[test]
    fn cameras_that_were_turned_are_turned_back() {
        let jpeg = encode(&picture(8, 1), ImageFormat::Jpeg);
        let exif = b"Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0";
        let length = (exif.len() as u16 + 2).to_be_bytes();
        let turned = [&jpeg[..2], &[0xff, 0xe1], &length, exif, &jpeg[2..]].concat();
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("a.jpg"), turned).unwrap();
        let clip = open(&folder.path().join("a.jpg")).unwrap();
        assert_eq!(clip.size(), (6, 8));
        // What was the bottom left is the top left: much blue, no green.
        let [_, green, blue] = clip.frame(0).unwrap().color().unwrap()[(0, 0)];
        assert!(green < 12 && blue > 80, "{green} {blue}");
    }

    #[test]
    fn two_pictures_of_different_sizes_are_a_clip() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str, image: &DynamicImage| {
            let path = folder.path().join(name);
            fs::write(&path, encode(image, ImageFormat::Png)).unwrap();
            path
        };
        let open = |files| media::open_pair(&files, &Open::default()).unwrap().clip;
        let ramp = |width, height, unit: f32| -> DynamicImage {
            let gray = |x: u32, y: u32| image::Luma([(unit * (2 * x + 3 * y) as f32) as u8]);
            image::GrayImage::from_fn(width, height, gray).into()
        };
        // Twice as large: the same gray levels in the size of the first, half a pixel of the larger one apart at most.
        let clip = open([file("small.png", &ramp(24, 16, 2.0)), file("large.png", &ramp(48, 32, 1.0))]);
        let [one, other] = [0, 1].map(|t| clip.frame(t).unwrap());
        assert_eq!((clip.size(), other.size()), ((24, 16), (24, 16)));
        let off = |x, y| one.luma()[(x, y)].abs_diff(other.luma()[(x, y)]);
        // Beyond the border nothing is averaged.
        assert!((1..15).all(|y| (1..23).all(|x| off(x, y) <= 4)));
        let warnings = &clip.info().warnings;
        assert!(
            matches!(&warnings[..], [told] if told.contains("large.png") && told.contains("48×32")),
            "{warnings:?}"
        );
        // An object and a scene keep their pixels and their coordinates, in colour and gray.
        let clip = open([file("object.png", &picture(20, 1)), file("scene.png", &ramp(12, 30, 2.0))]);
        let [object, scene] = [0, 1].map(|t| clip.frame(t).unwrap());
        assert_eq!((clip.size(), object.size(), scene.size()), ((20, 30), (20, 30), (20, 30)));
        let color = object.color().unwrap();
        assert_eq!([color[(19, 5)], color[(19, 6)]], [[40, 152, 100], [0; 3]]);
        assert_eq!([(11, 29), (12, 29)].map(|at| scene.luma()[at]), [2 * (22 + 87) as u8, 0]);
        assert_eq!(clip.info().warnings.len(), 1);
    }

    #[test]
    fn damage_in_the_middle_leaves_the_rest() {
        let folder = tempfile::tempdir().unwrap();
        let png = |width, t| encode(&picture(width, t), ImageFormat::Png);
        let cut = png(8, 1)[..60].to_vec();
        for (name, bytes) in [("f0.png", png(8, 1)), ("f1.png", cut), ("f2.png", png(9, 1)), ("f3.png", png(8, 2))] {
            fs::write(folder.path().join(name), bytes).unwrap();
        }
        let clip = open(folder.path()).unwrap();
        let message = "f2.png cannot be shown: it is 9×6 px, not 8×6 px as the first picture";
        assert_eq!(clip.info().warnings, [message]);
        assert!(clip.frame(0).is_ok() && clip.frame(3).is_ok());
        assert!(clip.frame(1).unwrap_err().to_string().contains("f1.png"));
        let message = clip.frame(2).unwrap_err().to_string();
        assert!(message.contains("f2.png") && message.contains("9×6") && message.contains("8×6"), "{message}");
    }

    #[test]
    fn pictures_of_another_size_are_reported_in_every_format() {
        for (extension, format) in FORMATS {
            let folder = tempfile::tempdir().unwrap();
            for (t, width) in [8, 8, 9, 8, 7, 9].into_iter().enumerate() {
                let path = folder.path().join(format!("f{t}.{extension}"));
                fs::write(path, encode(&picture(width, 1), format)).unwrap();
            }
            let clip = open(folder.path()).unwrap();
            let message = format!("f2.{extension} cannot be shown: it is 9×6 px");
            let warnings = &clip.info().warnings;
            assert!(
                warnings[0].starts_with(&message) && warnings[0].ends_with("and 2 more differ as well"),
                "{warnings:?}"
            );
            assert!((0..6).all(|t| clip.frame(t).is_ok() == [0, 1, 3].contains(&t)), "{extension}");
        }
    }

    #[test]
    fn a_jpeg_without_its_end_is_not_made_up() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.jpg");
        let whole = encode(&picture(30, 1), ImageFormat::Jpeg);
        fs::write(&path, &whole[..whole.len() - 20]).unwrap();
        assert!(open(&path).unwrap_err().to_string().contains("cut short"));
        fs::write(&path, [whole, vec![7; 99]].concat()).unwrap();
        assert!(open(&path).unwrap().frame(0).is_ok());
    }

    #[test]
    fn a_jpeg_of_another_process_is_named_and_not_called_damaged() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.jpg");
        let baseline = encode(&picture(30, 1), ImageFormat::Jpeg);
        let frame = baseline.windows(2).position(|mark| mark == [0xFF, 0xC0]).unwrap();
        for (process, name) in [(0xC3, "lossless"), (0xC9, "arithmetic"), (0xC5, "hierarchical")] {
            let mut bytes = baseline.clone();
            bytes[frame + 1] = process;
            fs::write(&path, bytes).unwrap();
            let told = open(&path).unwrap_err().to_string();
            assert!(told.contains(name) && !told.contains("damaged"), "{told}");
        }
    }

    #[test]
    fn hostile_headers_are_refused_before_anything_is_allocated() {
        let folder = tempfile::tempdir().unwrap();
        let mut bmp = encode(&picture(8, 1), ImageFormat::Bmp);
        bmp[18..26].copy_from_slice(&[0, 0, 0, 0x40, 0, 0, 0, 0x40]);
        let ppm = b"P6\n100000 100000\n255\nabc".to_vec();
        let area = b"P6\n16000 16000\n255\nabc".to_vec();
        let empty = b"P6\n0 5\n255\n".to_vec();
        let mut png = encode(&picture(8, 1), ImageFormat::Png);
        png[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
        for (name, bytes) in [("a.bmp", bmp), ("b.ppm", ppm), ("c.ppm", area), ("d.ppm", empty), ("e.png", png)] {
            let path = folder.path().join(name);
            fs::write(&path, bytes).unwrap();
            let message = open(&path).unwrap_err().to_string();
            assert!(message.contains(name), "{message}");
        }
        assert!(open(&folder.path().join("gone.png")).unwrap_err().to_string().contains("no such file"));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]
        #[test]
        fn damage_never_panics(which in 0..6_usize, at in any::<prop::sample::Index>(), flip in 1..=255_u8, cut: bool) {
            let (extension, format) = FORMATS[which];
            let mut bytes = encode(&picture(8, 1), format);
            let at = at.index(bytes.len());
            if cut { bytes.truncate(at) } else { bytes[at] ^= flip }
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join(format!("hurt.{extension}"));
            fs::write(&path, bytes).unwrap();
            match open(&path).and_then(|clip| clip.frame(0)) {
                Ok(frame) => prop_assert!(frame.size().0 > 0),
                Err(error) => prop_assert!(error.to_string().contains("hurt."), "{error}"),
            }
        }
    }
}
