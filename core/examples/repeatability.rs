//! The repeatability of every detector of single frames on two PNG files of a plane:
//! `cargo run --release -p motionscope-core --example repeatability a.png b.png h11 h12 h13 h21 … h33`.
//!
//! The strongest 500 keypoints of each picture; one is repeated if another lies within 1.5 px of where the homography maps it.
//!
//! On graffiti 1 and 3 of Oxford it prints 0.578 for FAST and 0.451 for SIFT. By the same measure OpenCV 5.0.0 has 0.576 and, with
//! `enable_precise_upscale`, 0.451 on the gray levels of `cvtColor`. `imread` with `IMREAD_GRAYSCALE` truncates gray levels where both
//! round them; half of all pixels are then darker by 1, and OpenCV has 0.601 and 0.459.

use std::error::Error;
use std::fs::File;
use std::io::BufReader;

use motionscope_core::base::Threads;
use motionscope_core::course::estimators;
use motionscope_core::data::{Clip, Frame};
use motionscope_core::geometry::Grid;
use motionscope_core::products::{PointField, Product, repeatability};

fn picture(path: &str) -> Result<Frame, Box<dyn Error>> {
    let mut decoder = png::Decoder::new(BufReader::new(File::open(path)?));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info()?;
    let mut bytes = vec![0; reader.output_buffer_size().ok_or("the picture is too large")?];
    let info = reader.next_frame(&mut bytes)?;
    let (width, height, samples) = (info.width as usize, info.height as usize, info.color_type.samples());
    Ok(match samples {
        1 | 2 => Frame::gray(Grid::from_fn(width, height, |x, y| bytes[(y * width + x) * samples])),
        _ => Frame::rgb(Grid::from_fn(width, height, |x, y| [0, 1, 2].map(|k| bytes[(y * width + x) * samples + k]))),
    })
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [first, second, matrix @ ..] = &arguments[..] else {
        return Err("give two PNG files and the nine numbers of a homography, row by row".into());
    };
    let numbers = matrix.iter().map(|number| number.parse()).collect::<Result<Vec<f64>, _>>()?;
    let [a, b, c, d, e, f, g, h, i] = numbers[..] else { return Err("a homography has nine numbers".into()) };
    let homography = [[a, b, c], [d, e, f], [g, h, i]];
    let clips =
        [first, second].map(|path| picture(path).and_then(|frame| Ok(Clip::from_frames(path.clone(), vec![frame])?)));
    let [first, second] = clips;
    let (first, second) = (first?, second?);
    for mut estimator in estimators() {
        if estimator.info().frames > 1 || !estimator.produces().contains(&PointField::KIND) {
            continue;
        }
        for (name, value) in [("min-distance", "0"), ("max-points", "500")] {
            // Not every detector has both.
            estimator.set(name, value).ok();
        }
        let points = |clip: &Clip| -> Result<PointField, Box<dyn Error>> {
            let output = estimator.run(clip, 0, &Threads::all()?)?;
            Ok(output.get::<PointField>().cloned().ok_or("no keypoints")?)
        };
        let found = repeatability([&points(&first)?, &points(&second)?], homography, 1.5);
        let found = found.ok_or("the homography has no inverse")?;
        println!("{:12} {:.3} ({found:?})", estimator.info().id, found.share().unwrap_or_default());
    }
    Ok(())
}
