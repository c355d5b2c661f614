//! Numbered pictures, folders of pictures, and a single picture.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use motionscope_core::{ClipInfo, Error, Frame, Stop};

use super::names::file_name;
use super::sequence::Sequence;
use super::stereo::keep_left;
use super::{Decoder, Open, Source, name_of, picture};

/// Opens the folder, pattern or picture at `path`; a numbered picture brings those that come after it.
///
/// # Errors
/// One sentence, without the file's name.
pub(crate) fn open(path: &Path, options: &Open) -> Result<Source, Error> {
    let mut sequence = Sequence::find(path)?;
    keep_left(&mut sequence, &options.given);
    clip(path, name_of(path), sequence, options)
}

/// Opens pictures as one clip.
///
/// # Errors
/// One sentence, without the name of the first file.
pub(crate) fn of_files(files: Vec<PathBuf>, options: &Open) -> Result<Source, Error> {
    let first = files.first().cloned().unwrap_or_default();
    clip(&first, name_of(&first), Sequence { files, warnings: Vec::new() }, options)
}

/// Opens two pictures as one clip.
///
/// # Errors
/// One sentence, without the name of the first file.
pub(crate) fn pair(files: &[PathBuf; 2], options: &Open) -> Result<Source, Error> {
    let [first, second] = files;
    let name = format!("{} → {}", name_of(first), name_of(second));
    let source = clip(first, name, Sequence { files: files.to_vec(), warnings: Vec::new() }, options)?;
    // Of two frames none can be left out.
    match picture::size(second).filter(|size| *size != (source.info.width, source.info.height)) {
        Some((w, h)) => Err(Error::new(format!(
            "it is {}×{} px, but {} is {w}×{h} px; scale one of them",
            source.info.width,
            source.info.height,
            file_name(second)
        ))),
        None => Ok(source),
    }
}

/// The clip `name` of a `sequence` of pictures, opened from `path`.
fn clip(path: &Path, name: String, sequence: Sequence, options: &Open) -> Result<Source, Error> {
    let Sequence { files, mut warnings } = sequence;
    let Some(first) = files.first() else { return Err(Error::new("it holds no pictures")) };
    let picture = picture::open(first).map_err(|why| if first == path { why } else { about(first, &why) })?;
    warnings.extend(picture.warnings());
    warnings.extend(misfits(&files, picture.size, options)?);
    let info = ClipInfo {
        name,
        width: picture.size.0,
        height: picture.size.1,
        frames: Some(files.len()),
        fps: None,
        container: CONTAINER.into(),
        codec: picture.codec.into(),
        warnings,
    };
    let (size, files) = (picture.size, Arc::from(files));
    Ok(Source { info, decoder: Box::new(Stills { files: Arc::clone(&files), size }), files })
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

/// One file per frame.
struct Stills {
    files: Arc<[PathBuf]>,
    size: (usize, usize),
}

impl Decoder for Stills {
    fn decode(&mut self, index: usize, _stop: &Stop, keep: &mut dyn FnMut(usize, Frame)) -> Result<(), Error> {
        let Some(file) = self.files.get(index) else { return Ok(()) };
        let frame = self.read(file).map_err(|why| about(file, &why))?;
        keep(index, frame);
        Ok(())
    }
}

impl Stills {
    fn read(&self, file: &Path) -> Result<Frame, Error> {
        let picture = picture::open(file)?;
        let ((w, h), (width, height)) = (picture.size, self.size);
        if (w, h) != (width, height) {
            return Err(Error::new(format!("it is {w}×{h} px, but the first picture is {width}×{height} px")));
        }
        picture.frame()
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use image::{DynamicImage, ImageFormat};
    use motionscope_core::Clip;
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
        media::open(path, &Open::default())
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
