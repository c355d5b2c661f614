//! One value per pixel: Middlebury and KITTI flow, occlusion masks, foreground.

use std::io::{BufRead, BufReader, Read, Seek};
use std::path::Path;

use motionscope_core::base::Error;
use motionscope_core::data::{Disparity, Flow, PixelClass, TrueMask};
use motionscope_core::geometry::Grid;
use motionscope_core::products::model::{Matrix3, mapped, oriented};
use png::{BitDepth, ColorType, Transformations};

use super::file_error;
use crate::files::File;
use crate::media::cannot_read;
use crate::media::names::{extension, stem};
use crate::media::numbers::single;

/// Magnitudes above this say that the motion is not known (Middlebury).
const UNKNOWN_ABOVE: f32 = 1e9;

/// The flow in the file at `path`, whichever format it has, if it is `size` pixels.
///
/// # Errors
/// If it cannot be read, is damaged or has another size.
pub fn flow(path: &Path, size: (usize, usize)) -> Result<Flow, Error> {
    let mut reader = start(path)?;
    match detect(&mut reader, path)? {
        Format::Flo => flo(reader, path, size),
        Format::Png => kitti(reader, path, size),
        Format::Xml => homography(reader, path).map(|matrix| flow_of(&matrix, size)),
    }
}

/// Whether `path` is a homography, which belongs to the first frame whatever number its name has.
pub fn is_homography(path: &Path) -> bool {
    start(path).is_ok_and(|mut reader| matches!(detect(&mut reader, path), Ok(Format::Xml)))
}

/// Whether the header of the flow at `path` states this `size`.
///
/// # Errors
/// If it cannot be read, is no flow or has another size.
pub fn check_flow(path: &Path, size: (usize, usize)) -> Result<(), Error> {
    let mut reader = start(path)?;
    let found = match detect(&mut reader, path)? {
        Format::Flo => flo_size(&mut reader, path)?,
        Format::Png => Picture::open(reader, path, Transformations::IDENTITY)?.flow_size(path)?,
        // It is one for pictures of any size.
        Format::Xml => return homography(reader, path).map(|_| ()),
    };
    must_fit(path, found, size)
}

/// Whether the header of the mask at `path` states this `size`.
///
/// # Errors
/// If it cannot be read, is no PNG or has another size.
pub fn check_mask(path: &Path, size: (usize, usize)) -> Result<(), Error> {
    must_fit(path, Picture::open(start(path)?, path, Transformations::IDENTITY)?.size, size)
}

/// The mask in the PNG at `path`, true where any of its colours is not black, if it is `size` pixels.
///
/// # Errors
/// If it cannot be read, is damaged or has another size.
pub fn mask(path: &Path, size: (usize, usize)) -> Result<Grid<bool>, Error> {
    let expand = Transformations::EXPAND | Transformations::STRIP_16;
    let mut picture = Picture::open(start(path)?, path, expand)?;
    must_fit(path, picture.size, size)?;
    let (color, _) = picture.reader.output_color_type();
    let colors = if matches!(color, ColorType::Rgb | ColorType::Rgba) { 3 } else { 1 };
    let samples = picture.samples(path)?;
    let set = samples.chunks_exact(color.samples()).map(|pixel| pixel[..colors].iter().any(|&c| c != 0)).collect();
    Grid::from_vec(size.0, size.1, set)
}

/// The depths in m in the 16-bit gray PNG at `path`, if it is `size` pixels; 0 is unknown.
///
/// # Errors
/// If it cannot be read, is damaged, or has another size or depth of samples.
pub fn depth(path: &Path, size: (usize, usize), units_per_m: f32) -> Result<Grid<f32>, Error> {
    let mut picture = Picture::open(start(path)?, path, Transformations::IDENTITY)?;
    must_fit(path, picture.size, size)?;
    let info = picture.reader.info();
    if (info.color_type, info.bit_depth) != (ColorType::Grayscale, BitDepth::Sixteen) {
        return Err(file_error(path, "depths are a PNG with one gray channel of 16 bits; this one has others"));
    }
    let samples = picture.samples(path)?;
    let level = |bytes: &[u8]| match u16::from_be_bytes([bytes[0], bytes[1]]) {
        0 => f32::NAN,
        units => f32::from(units) / units_per_m,
    };
    Grid::from_vec(size.0, size.1, samples.chunks_exact(2).map(level).collect())
}

/// Whether `path` is a PNG of 8 bits with a palette, as pictures of labels are, and its colours are not the levels of a mask.
pub fn is_labels(path: &Path) -> bool {
    let open = || Picture::open(start(path).ok()?, path, Transformations::IDENTITY).ok();
    let picture = open().filter(|picture| {
        (picture.reader.info().color_type, picture.reader.info().bit_depth) == (ColorType::Indexed, BitDepth::Eight)
    });
    picture.is_some_and(|picture| foreground(path, picture.size).is_err())
}

/// The label of each pixel of the PNG at `path`, its index in the palette or its gray level, if it is `size` pixels; 0 is no label.
///
/// # Errors
/// If it cannot be read, is damaged, or has another size, several channels or another depth than 8 bits.
pub fn labels(path: &Path, size: (usize, usize)) -> Result<Grid<u32>, Error> {
    let mut picture = Picture::open(start(path)?, path, Transformations::IDENTITY)?;
    must_fit(path, picture.size, size)?;
    let info = picture.reader.info();
    let has_labels = matches!(info.color_type, ColorType::Indexed | ColorType::Grayscale);
    if !has_labels || info.bit_depth != BitDepth::Eight {
        return Err(file_error(
            path,
            "labels are a PNG with a palette or one gray channel, of 8 bits; this one has others",
        ));
    }
    let samples = picture.samples(path)?;
    Grid::from_vec(size.0, size.1, samples.into_iter().map(u32::from).collect())
}

/// Whether `path` is a PNG of 8 bits or less, as masks are and flows are not.
pub fn is_mask(path: &Path) -> bool {
    let open = || Picture::open(start(path).ok()?, path, Transformations::IDENTITY).ok();
    open().is_some_and(|picture| picture.reader.info().bit_depth != BitDepth::Sixteen)
}

/// The true foreground in the PNG at `path`, if it is `size` pixels: gray levels as on changedetection.net, 0 background, 50 shadow,
/// 85 and 170 ignored, 255 foreground; a mask of 0 and 1 is one too.
///
/// # Errors
/// If it cannot be read, is damaged, or has another size or other levels.
pub fn foreground(path: &Path, size: (usize, usize)) -> Result<TrueMask, Error> {
    let expand = Transformations::EXPAND | Transformations::STRIP_16;
    let mut picture = Picture::open(start(path)?, path, expand)?;
    must_fit(path, picture.size, size)?;
    let (color, _) = picture.reader.output_color_type();
    let samples = picture.samples(path)?;
    let class = |pixel: &[u8]| match pixel[0] {
        0 => Ok(PixelClass::Background),
        50 => Ok(PixelClass::Shadow),
        85 | 170 => Ok(PixelClass::Ignored),
        1 | 255 => Ok(PixelClass::Foreground),
        other => Err(file_error(
            path,
            format!(
                "it is neither a flow (a KITTI flow has three 16-bit channels) nor a true mask (gray levels 0, 50, 85, 170 and 255): \
                 it has the level {other}"
            ),
        )),
    };
    let classes = samples.chunks_exact(color.samples()).map(class).collect::<Result<_, _>>()?;
    Ok(TrueMask(Grid::from_vec(size.0, size.1, classes)?))
}

/// Gray levels per px of disparity in a KITTI PNG of 16 bits.
const KITTI_SCALE: f32 = 256.0;

/// The disparity in the file at `path`, if it is `size` pixels: a PFM, a KITTI PNG of 16 bits, or a PNG of 8 bits with a scale. In a PNG 0
/// is unknown, in a PFM what is not finite.
///
/// # Errors
/// If it cannot be read, is damaged, has another size, or its scale is not known.
pub fn disparity(path: &Path, size: (usize, usize), given: Option<f32>) -> Result<Disparity, Error> {
    if extension(path) == "pfm" {
        return pfm(start(path)?, path, size);
    }
    let mut picture = Picture::open(start(path)?, path, Transformations::EXPAND)?;
    must_fit(path, picture.disparity_size(path)?, size)?;
    let scale = scale_of(&picture, path, given)?;
    let samples = picture.samples(path)?;
    let level = |level: u16| if level == 0 { Disparity::UNKNOWN } else { f32::from(level) / scale };
    let cells = match picture.reader.output_color_type().1 {
        BitDepth::Sixteen => samples.chunks_exact(2).map(|b| level(u16::from_be_bytes([b[0], b[1]]))).collect(),
        _ => samples.iter().map(|&b| level(b.into())).collect(),
    };
    Grid::from_vec(size.0, size.1, cells).map(Disparity)
}

/// Whether the header of the disparity at `path` states this `size`, and its scale is known.
///
/// # Errors
/// As [`disparity`].
pub fn check_disparity(path: &Path, size: (usize, usize), given: Option<f32>) -> Result<(), Error> {
    if extension(path) == "pfm" {
        return must_fit(path, pfm_header(&mut start(path)?, path)?.size, size);
    }
    let picture = Picture::open(start(path)?, path, Transformations::EXPAND)?;
    must_fit(path, picture.disparity_size(path)?, size)?;
    scale_of(&picture, path, given).map(drop)
}

/// Whether the file at `path` is a disparity rather than a flow or a mask: a PFM, a gray PNG of 16 bits, or one of 8 bits that is called
/// one or has a scale.
pub fn is_disparity(path: &Path, given: Option<f32>) -> bool {
    if extension(path) == "pfm" {
        return true;
    }
    let open = || Picture::open(start(path).ok()?, path, Transformations::EXPAND).ok();
    open().is_some_and(|picture| match picture.reader.output_color_type() {
        (ColorType::Grayscale, BitDepth::Sixteen) => true,
        (ColorType::Grayscale, _) => given.is_some() || stem(path).starts_with("disp"),
        _ => false,
    })
}

/// The gray levels per px of a disparity of 8 bits; none for other formats.
///
/// # Errors
/// If it cannot be read, or its scale is not known.
pub fn scale(path: &Path, size: (usize, usize), given: Option<f32>) -> Result<Option<f32>, Error> {
    if extension(path) == "pfm" {
        return Ok(None);
    }
    let picture = Picture::open(start(path)?, path, Transformations::EXPAND)?;
    must_fit(path, picture.size, size)?;
    let is_deep = picture.reader.output_color_type().1 == BitDepth::Sixteen;
    if is_deep { Ok(None) } else { scale_of(&picture, path, given).map(Some) }
}

/// Gray levels per px of disparity: those of the format, those given, or those of Middlebury's folders.
fn scale_of<R: BufRead + Seek>(picture: &Picture<R>, path: &Path, given: Option<f32>) -> Result<f32, Error> {
    if picture.reader.output_color_type().1 == BitDepth::Sixteen {
        return Ok(KITTI_SCALE);
    }
    given.or_else(|| usual_scale(&stem(path), picture.size)).ok_or_else(|| {
        let why = "a disparity of 8 bits needs its scale, the gray levels per px of disparity; give it with --disparity-scale, or as \
                   disparity-scale in a session";
        file_error(path, why)
    })
}

/// Gray levels per px of a disparity called `name` in Middlebury's folders of 2003, 2005 and 2006, which store the disparities of the full
/// size, whatever the size of the views; none for other sizes, such as those of 2001, with other scales under the same names.
fn usual_scale(name: &str, (width, height): (usize, usize)) -> Option<f32> {
    match (name, width, height) {
        ("disp2" | "disp6", 1800, 1500) => Some(1.0),
        ("disp2" | "disp6", 900, 750) => Some(2.0),
        ("disp2" | "disp6", 450, 375) => Some(4.0),
        // Full, half and third size; the scenes differ in width.
        ("disp1" | "disp5", 1240..=1396, 1110) => Some(1.0),
        ("disp1" | "disp5", 620..=698, 555) => Some(2.0),
        ("disp1" | "disp5", 413..=466, 370) => Some(3.0),
        _ => None,
    }
}

/// What precedes the samples of a PFM.
struct PfmHeader {
    size: (usize, usize),
    is_little_endian: bool,
}

/// The three lines that a PFM begins with.
fn pfm_header(reader: &mut impl BufRead, path: &Path) -> Result<PfmHeader, Error> {
    /// Longer than any such header.
    const MOST_BYTES: u64 = 256;
    let mut header = reader.take(MOST_BYTES);
    let mut words = Vec::new();
    while words.len() < 4 {
        let mut line = String::new();
        let read = header.read_line(&mut line);
        if !read.is_ok_and(|bytes| bytes > 0) {
            return Err(file_error(path, "this is not a PFM: it ends within its header"));
        }
        words.extend(line.split_whitespace().map(str::to_owned));
    }
    let wrong =
        || file_error(path, "this is not a PFM of disparities: its header must be Pf, width, height and a scale");
    let [kind, width, height, scale] = words.as_slice() else { return Err(wrong()) };
    let side = |word: &String| word.parse::<usize>().map_err(|_| wrong());
    let scale: f32 = scale.parse().map_err(|_| wrong())?;
    if kind != "Pf" || !scale.is_finite() || scale == 0.0 {
        return Err(wrong());
    }
    Ok(PfmHeader { size: (side(width)?, side(height)?), is_little_endian: scale < 0.0 })
}

/// A portable float map of one channel; its rows go from the bottom to the top.
fn pfm(mut reader: BufReader<File>, path: &Path, size: (usize, usize)) -> Result<Disparity, Error> {
    let header = pfm_header(&mut reader, path)?;
    must_fit(path, header.size, size)?;
    let mut bytes = vec![0; 4 * size.0 * size.1];
    reader.read_exact(&mut bytes).map_err(|_| file_error(path, "it is cut short; get a whole copy"))?;
    let float = |b: &[u8]| {
        let b = [b[0], b[1], b[2], b[3]];
        if header.is_little_endian { f32::from_le_bytes(b) } else { f32::from_be_bytes(b) }
    };
    let known = |d: f32| if d.is_finite() { d } else { Disparity::UNKNOWN };
    let cells = bytes.chunks_exact(4 * size.0).rev().flat_map(|row| row.chunks_exact(4).map(|b| known(float(b))));
    Grid::from_vec(size.0, size.1, cells.collect()).map(Disparity)
}

enum Format {
    Flo,
    Png,
    Xml,
}

fn start(path: &Path) -> Result<BufReader<File>, Error> {
    File::open(path).map(BufReader::new).map_err(|e| file_error(path, cannot_read(&e)))
}

fn detect(reader: &mut BufReader<File>, path: &Path) -> Result<Format, Error> {
    let head = reader.fill_buf().map_err(|e| file_error(path, cannot_read(&e)))?;
    if head.starts_with(b"PIEH") {
        Ok(Format::Flo)
    } else if head.starts_with(b"\x89PNG") {
        Ok(Format::Png)
    } else if head.starts_with(b"<?xml") {
        Ok(Format::Xml)
    } else {
        Err(file_error(
            path,
            "this is not ground truth; give a Middlebury .flo, a KITTI 16-bit PNG, a disparity as .pfm, a homography as .xml of OpenCV, or a MOTChallenge gt.txt",
        ))
    }
}

fn must_fit(path: &Path, (w, h): (usize, usize), (width, height): (usize, usize)) -> Result<(), Error> {
    if (w, h) == (width, height) {
        return Ok(());
    }
    Err(file_error(path, format!("it is {w}×{h} but the clip is {width}×{height}; it belongs to another clip")))
}

fn flo_size(reader: &mut impl Read, path: &Path) -> Result<(usize, usize), Error> {
    let mut head = [0; 12];
    reader.read_exact(&mut head).map_err(|_| file_error(path, "the file ends within its header"))?;
    let side = |at: usize| {
        let value = i32::from_le_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]]);
        usize::try_from(value).map_err(|_| file_error(path, format!("its header claims a side of {value} pixels")))
    };
    Ok((side(4)?, side(8)?))
}

fn flo(mut reader: BufReader<File>, path: &Path, size: (usize, usize)) -> Result<Flow, Error> {
    must_fit(path, flo_size(&mut reader, path)?, size)?;
    let mut bytes = vec![0; 8 * size.0 * size.1];
    reader.read_exact(&mut bytes).map_err(|_| file_error(path, "it is cut short; get a whole copy"))?;
    let float = |b: &[u8]| f32::from_le_bytes([b[0], b[1], b[2], b[3]]);
    let cells = bytes.chunks_exact(8).map(|cell| known([float(&cell[..4]), float(&cell[4..])])).collect();
    Grid::from_vec(size.0, size.1, cells).map(Flow)
}

fn known(uv: [f32; 2]) -> [f32; 2] {
    // Not a number compares false: unknown as well.
    if uv.iter().all(|c| c.abs() <= UNKNOWN_ABOVE) { uv } else { Flow::UNKNOWN }
}

fn kitti(reader: BufReader<File>, path: &Path, size: (usize, usize)) -> Result<Flow, Error> {
    let mut picture = Picture::open(reader, path, Transformations::IDENTITY)?;
    must_fit(path, picture.flow_size(path)?, size)?;
    let samples = picture.samples(path)?;
    let component = |b: &[u8]| (f32::from(u16::from_be_bytes([b[0], b[1]])) - 32_768.0) / 64.0;
    let pixel = |b: &[u8]| match b {
        [.., 0, 0] => Flow::UNKNOWN,
        _ => [component(b), component(&b[2..])],
    };
    Grid::from_vec(size.0, size.1, samples.chunks_exact(6).map(pixel).collect()).map(Flow)
}

/// The homography in a file of OpenCV's XML storage: the nine entries of a 3×3 matrix, row by row.
fn homography(reader: BufReader<File>, path: &Path) -> Result<Matrix3, Error> {
    /// Longer than any such file.
    const MOST_BYTES: u64 = 64 << 10;
    let mut text = String::new();
    reader.take(MOST_BYTES).read_to_string(&mut text).map_err(|e| file_error(path, cannot_read(&e)))?;
    let entries = text.split_once("<data>").and_then(|(_, rest)| Some(rest.split_once("</data>")?.0));
    let numbers = entries.unwrap_or_default().split_whitespace().map(|word| word.parse::<f64>().ok());
    let numbers: Vec<f64> =
        numbers.map(|number| number.filter(|n| n.is_finite())).collect::<Option<_>>().unwrap_or_default();
    match numbers[..] {
        [a, b, c, d, e, f, g, h, i] => Ok([[a, b, c], [d, e, f], [g, h, i]]),
        _ => Err(file_error(path, "this is no homography: its <data> must be the 9 finite numbers of a 3×3 matrix")),
    }
}

/// The flow of a homography that is given up to a factor: the middle of the picture lies before the horizon. Unknown beyond it.
fn flow_of(matrix: &Matrix3, (width, height): (usize, usize)) -> Flow {
    let middle = [(width as f64 - 1.0) / 2.0, (height as f64 - 1.0) / 2.0];
    let matrix = oriented(matrix, std::iter::once(middle)).unwrap_or(*matrix);
    Flow(Grid::from_fn(width, height, |x, y| {
        let at = [x as f64, y as f64];
        mapped(&matrix, at).map_or(Flow::UNKNOWN, |to| known([0, 1].map(|i| single(to[i] - at[i]))))
    }))
}

/// A PNG whose header was read but not its pixels.
struct Picture<R: BufRead + Seek> {
    reader: png::Reader<R>,
    size: (usize, usize),
}

impl<R: BufRead + Seek> Picture<R> {
    fn open(input: R, path: &Path, transformations: Transformations) -> Result<Self, Error> {
        let mut decoder = png::Decoder::new(input);
        decoder.set_transformations(transformations);
        let reader = decoder.read_info().map_err(|e| file_error(path, format!("this is not a valid PNG ({e})")))?;
        let (width, height) = reader.info().size();
        Ok(Self { reader, size: (width as usize, height as usize) })
    }

    /// Width and height, if the channels are those of a KITTI flow.
    fn flow_size(&self, path: &Path) -> Result<(usize, usize), Error> {
        if self.reader.output_color_type() == (ColorType::Rgb, BitDepth::Sixteen) {
            Ok(self.size)
        } else {
            Err(file_error(path, "a KITTI flow is a PNG with three 16-bit channels; this one has others"))
        }
    }

    /// Width and height, if there is one channel.
    fn disparity_size(&self, path: &Path) -> Result<(usize, usize), Error> {
        match self.reader.output_color_type() {
            (ColorType::Grayscale, BitDepth::Eight | BitDepth::Sixteen) => Ok(self.size),
            _ => Err(file_error(path, "a disparity is a PNG with one channel of 8 or 16 bits; this one has others")),
        }
    }

    /// All samples. The size must have been checked.
    fn samples(&mut self, path: &Path) -> Result<Vec<u8>, Error> {
        let length =
            self.reader.output_buffer_size().ok_or_else(|| file_error(path, "its header claims too large an image"))?;
        let mut samples = vec![0; length];
        self.reader.next_frame(&mut samples).map_err(|e| file_error(path, format!("the PNG is damaged ({e})")))?;
        Ok(samples)
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use proptest::prelude::*;

    use super::*;
    use crate::media::export;

    fn sample() -> Flow {
        Flow(Grid::from_fn(5, 3, |x, y| match (x, y) {
            (4, 2) => Flow::UNKNOWN,
            _ => [x as f32 * 0.25 - 1.0, y as f32 * -3.5],
        }))
    }

    fn formats() -> [Vec<u8>; 2] {
        [export::flo(&sample()), export::kitti(&sample()).unwrap().bytes]
    }

    fn read(bytes: &[u8], size: (usize, usize)) -> Result<Flow, Error> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("flow10.flo");
        fs::write(&path, bytes).unwrap();
        flow(&path, size)
    }

    /// Equality that takes unknown for equal to unknown.
    fn same(a: &Flow, b: &Flow) -> bool {
        a.0.size() == b.0.size() && (0..3).all(|y| (0..5).all(|x| a.at(x, y) == b.at(x, y)))
    }

    #[test]
    fn what_was_written_is_read() {
        for bytes in formats() {
            assert!(same(&read(&bytes, (5, 3)).unwrap(), &sample()));
        }
    }

    #[test]
    fn unknown_is_what_the_formats_say() {
        let mut bytes = export::flo(&sample());
        bytes[12..16].copy_from_slice(&(-1.7e9_f32).to_le_bytes());
        assert_eq!(read(&bytes, (5, 3)).unwrap().at(0, 0), None);
    }

    #[test]
    fn another_size_is_a_sentence_and_nothing_is_allocated_for_it() {
        for bytes in formats() {
            let message = read(&bytes, (5, 4)).unwrap_err().to_string();
            assert!(message.contains("5×3") && message.contains("5×4") && message.contains("flow10.flo"), "{message}");
        }
        let mut hostile = export::flo(&sample());
        hostile[4..12].copy_from_slice(&[0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff, 0x7f]);
        assert!(read(&hostile, (5, 3)).is_err());
        hostile[7] = 0xff;
        assert!(read(&hostile, (5, 3)).unwrap_err().to_string().contains("-1 pixels"));
    }

    #[test]
    fn a_homography_moves_every_pixel_before_its_horizon() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("H1to3p.xml");
        let save = |data: &str| {
            let head =
                "<?xml version=\"1.0\"?>\n<opencv_storage><H13 type_id=\"opencv-matrix\"><rows>3</rows><cols>3</cols>";
            fs::write(&path, format!("{head}<data>\n{data}</data></H13></opencv_storage>")).unwrap();
        };
        save("1. 0.5 2.0\n 0. 1. -1.\n -2.5e-01 0. 1.");
        assert!(is_homography(&path) && check_flow(&path, (7, 3)).is_ok());
        let flow = flow(&path, (7, 3)).unwrap();
        assert_eq!((flow.at(0, 2), flow.at(2, 0)), (Some([3.0, -1.0]), Some([6.0, -2.0])));
        assert_eq!(flow.at(4, 1), None);
        save("-1. -0.5 -2.0 0. -1. 1. 2.5e-01 0. -1.");
        assert_eq!(super::flow(&path, (7, 3)).unwrap().at(0, 2), Some([3.0, -1.0]));
        // With its horizon between the origin and the middle of the picture.
        save("1. 0. 0. 0. 1. 0. -1. 0. 2.");
        let flow = super::flow(&path, (7, 3)).unwrap();
        assert_eq!((flow.at(0, 2), flow.at(3, 1)), (None, Some([-6.0, -2.0])));
        for data in ["1 2 3", "1 0 0 0 1 0 0 0 nan", "1 0 0 0 1 0 0 0 one"] {
            save(data);
            let told = check_flow(&path, (7, 3)).unwrap_err().to_string();
            assert!(told.contains("9 finite numbers") && told.contains("H1to3p.xml"), "{told}");
        }
    }

    #[test]
    fn disparities_of_every_format_are_those_that_were_written() {
        let folder = tempfile::tempdir().unwrap();
        let map =
            Disparity(Grid::from_fn(3, 2, |x, y| if (x, y) == (1, 1) { f32::NAN } else { 1.5 + (x + 3 * y) as f32 }));
        let at = |name: &str, bytes: &[u8]| {
            let path = folder.path().join(name);
            fs::write(&path, bytes).unwrap();
            path
        };
        let pfm = export::pfm(&map);
        let big: Vec<u8> = pfm[pfm.len() - 24..].chunks(4).flat_map(|b| [b[3], b[2], b[1], b[0]]).collect();
        let big = [b"Pf 3 2 1.0\n".as_slice(), &big].concat();
        let levels: Vec<u8> = map.0.cells().iter().map(|d| (8.0 * d) as u8).collect();
        let scaled = export::png(3, 2, export::Pixels::Gray(&levels)).unwrap();
        for (path, given) in [
            (at("a.pfm", &pfm), None),
            (at("b.pfm", &big), None),
            (at("c.png", &export::kitti_disparity(&map).unwrap().bytes), Some(3.0)),
            (at("d.png", &scaled), Some(8.0)),
        ] {
            assert!(is_disparity(&path, given) && check_disparity(&path, (3, 2), given).is_ok());
            assert_eq!(disparity(&path, (3, 2), given).unwrap(), map, "{}", path.display());
            let told = disparity(&path, (2, 2), given).unwrap_err().to_string();
            assert!(told.contains("3×2") && told.contains("2×2"), "{told}");
        }
        let path = at("d.png", &scaled);
        assert!(!is_disparity(&path, None), "it may be a mask");
        assert!(disparity(&path, (3, 2), None).unwrap_err().to_string().contains("--disparity-scale"));
        for (bytes, words) in [
            (&b"PF\n3 2\n-1\n"[..], "Pf, width"),
            (b"Pf\n3 x\n-1\n", "Pf, width"),
            (b"Pf\n3", "header"),
            (&[b"Pf\n".as_slice(), &b"\n".repeat(300), b"3 2\n-1\n"].concat(), "header"),
            (&pfm[..20], "cut short"),
            (b"Pf\n99999999999 99999999999\n-1\n", "99999999999"),
        ] {
            let told = disparity(&at("e.pfm", bytes), (3, 2), None).unwrap_err().to_string();
            assert!(told.contains(words) && told.contains("e.pfm"), "{told}");
        }
    }

    #[test]
    fn a_scale_follows_the_size_of_middlebury_views() {
        let folder = tempfile::tempdir().unwrap();
        for (name, (width, height), expected) in [
            ("disp2.png", (450, 375), Some(4.0)),
            ("disp6.png", (900, 750), Some(2.0)),
            ("disp2.png", (1800, 1500), Some(1.0)),
            ("disp1.png", (437, 370), Some(3.0)),
            ("disp5.png", (656, 555), Some(2.0)),
            ("disp1.png", (1312, 1110), Some(1.0)),
            // Views of 2001, with 8 and 16 gray levels per px.
            ("disp2.png", (434, 383), None),
            ("disp6.png", (384, 288), None),
            ("disp1.png", (450, 375), None),
            ("disp2.png", (437, 370), None),
        ] {
            let path = folder.path().join(name);
            let levels = vec![8; width * height];
            fs::write(&path, export::png(width, height, export::Pixels::Gray(&levels)).unwrap()).unwrap();
            assert_eq!(scale(&path, (width, height), None).ok().flatten(), expected, "{name} {width}×{height}");
            assert_eq!(scale(&path, (width, height), Some(8.0)), Ok(Some(8.0)));
        }
    }

    #[test]
    fn a_mask_is_set_where_it_is_not_black() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("occ_0000.png");
        fs::write(&path, export::png(3, 1, export::Pixels::Gray(&[0, 1, 255])).unwrap()).unwrap();
        assert_eq!(mask(&path, (3, 1)).unwrap().cells(), [false, true, true]);
        fs::write(&path, export::png(2, 1, export::Pixels::Rgba(&[0, 0, 0, 255, 0, 0, 9, 255])).unwrap()).unwrap();
        assert_eq!(mask(&path, (2, 1)).unwrap().cells(), [false, true]);
        assert!(mask(&path, (3, 1)).is_err());
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(128))]
        #[test]
        fn damage_is_reported(which in 0..2_usize, at in any::<prop::sample::Index>(), flip in 1..=255_u8, cut: bool) {
            let mut bytes = formats()[which].clone();
            let at = at.index(bytes.len());
            if cut {
                bytes.truncate(at);
                // Nothing after the pixels is needed.
                let needed = if which == 0 { bytes.len() } else { at + 12 };
                prop_assert!(read(&bytes, (5, 3)).is_err() || needed >= formats()[which].len());
            } else {
                bytes[at] ^= flip;
                if let Err(error) = read(&bytes, (5, 3)) {
                    prop_assert!(error.to_string().contains("flow10.flo"));
                }
            }
        }
    }
}
