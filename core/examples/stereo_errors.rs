//! The errors of semi-global matching on a rectified pair with a true disparity map, as a share of wrong pixels.
//!
//! `cargo run -p motionscope-core --example stereo_errors -- LEFT.png RIGHT.png TRUTH.png 4`, where gray levels of the truth
//! are so many times the disparity in px, and 0 is unknown. OpenCV 5.0.0 in the mode SGBM 3-way (64 disparities, block 5, P1 200,
//! P2 800, uniqueness 10, left–right difference 1) leaves 21.0 % of the known pixels of Middlebury's Cones wrong by more than
//! 3 px or without a disparity, and 4.5 % of those that it estimates.

use std::path::Path;

use motionscope_core::base::{Error, Threads};
use motionscope_core::course::estimator;
use motionscope_core::data::{Clip, Disparity, Frame};
use motionscope_core::geometry::Grid;
use motionscope_core::products::DisparityField;

/// Errors above so many px are wrong.
const WRONG_PX: f32 = 3.0;

fn main() -> Result<(), Error> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [left, right, truth, scale] = &arguments[..] else {
        return Err(Error::new("name the left picture, the right picture, the true disparities and their scale"));
    };
    let scale: f32 =
        scale.parse().map_err(|_| Error::new(format!("{scale} is no scale; Middlebury's quarter size has 4")))?;
    let known = |level: &u8| if *level == 0 { f32::NAN } else { f32::from(*level) / scale };
    let truth = picture(Path::new(truth))?.luma().map(known);
    let clip = |path: &String| Clip::from_frames("pair", vec![picture(Path::new(path))?]);
    let clip = clip(left)?.with_right(clip(right)?)?;
    let found = |fill: &str| -> Result<Disparity, Error> {
        let mut estimator = estimator("semi-global-matching")?;
        estimator.set("fill", fill)?;
        let output = estimator.run(&clip, 0, &Threads::single())?;
        let field = output.get::<DisparityField>().ok_or_else(|| Error::new("the run made no disparities"))?;
        Ok(field.map.clone())
    };
    let (filled, unfilled) = (found("on")?, found("off")?);
    let [all, _] = wrong(&filled, &truth);
    let [_, of_estimated] = wrong(&unfilled, &truth);
    println!("{:.2} % of the known pixels are wrong by more than {WRONG_PX} px or without a disparity", 100.0 * all);
    println!("{:.2} % of those that pass all tests are wrong", 100.0 * of_estimated);
    Ok(())
}

/// The share of known pixels that are wrong or missing, and the share of estimated ones that are wrong.
fn wrong(map: &Disparity, truth: &Grid<f32>) -> [f32; 2] {
    let (mut known, mut estimated, mut wrong) = (0, 0, 0);
    for (found, truth) in map.0.cells().iter().zip(truth.cells()).filter(|(_, truth)| truth.is_finite()) {
        known += 1;
        estimated += u32::from(found.is_finite());
        wrong += u32::from((found - truth).abs() > WRONG_PX);
    }
    let missing = known - estimated;
    [(wrong + missing) as f32 / known.max(1) as f32, wrong as f32 / estimated.max(1) as f32]
}

/// A picture in 8 bits, in colour or gray.
fn picture(path: &Path) -> Result<Frame, Error> {
    let file = std::fs::File::open(path).map_err(|error| unread(path, &error))?;
    let mut decoder = png::Decoder::new(std::io::BufReader::new(file));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().map_err(|error| unread(path, &error))?;
    let mut bytes = vec![0; reader.output_buffer_size().ok_or_else(|| unread(path, &"it is too large"))?];
    let info = reader.next_frame(&mut bytes).map_err(|error| unread(path, &error))?;
    let (width, height) = (info.width as usize, info.height as usize);
    let samples = info.color_type.samples();
    let at = |x: usize, y: usize| &bytes[(y * width + x) * samples..];
    Ok(match samples {
        1 | 2 => Frame::gray(Grid::from_fn(width, height, |x, y| at(x, y)[0])),
        _ => Frame::rgb(Grid::from_fn(width, height, |x, y| [at(x, y)[0], at(x, y)[1], at(x, y)[2]])),
    })
}

fn unread(path: &Path, why: &dyn std::fmt::Display) -> Error {
    Error::new(format!("{} cannot be read: {why}", path.display()))
}
