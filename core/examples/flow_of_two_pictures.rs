//! Estimates the optical flow between two 8-bit PNGs of one size, and says how far they moved.
//!
//! ```text
//! cargo run -p motionscope-core --example flow_of_two_pictures -- FIRST.png SECOND.png [METHOD]
//! ```

use std::fs::File;
use std::io::BufReader;

use motionscope_core::base::{Error, Threads};
use motionscope_core::course::estimator;
use motionscope_core::data::{Clip, Frame};
use motionscope_core::geometry::Grid;
use motionscope_core::products::Reference;

fn main() -> Result<(), Error> {
    let names: Vec<String> = std::env::args().skip(1).collect();
    let [first, second, rest @ ..] = &names[..] else {
        return Err(Error::new("name two PNGs, and a method of optical flow if you like"));
    };
    let method = estimator(rest.first().map_or("horn-schunck", String::as_str))?;
    let clip = Clip::from_frames("two pictures", vec![read(first)?, read(second)?])?;

    let output = method.run(&clip, 0, &Threads::all()?)?;
    let flow = output.flow().ok_or_else(|| Error::new(format!("{} makes no flow", method.info().id)))?;
    let known: Vec<_> = flow.0.cells().iter().filter(|uv| uv.iter().all(|c| c.is_finite())).collect();
    let mean = |axis: usize| known.iter().map(|uv| f64::from(uv[axis])).sum::<f64>() / known.len().max(1) as f64;
    println!(
        "{}: mean displacement ({:.3}, {:.3}) px over {} pixels",
        method.info().name,
        mean(0),
        mean(1),
        known.len()
    );
    for fact in output.assess(&Reference { clip: &clip, frame: 0 })?.facts {
        println!("{}: {}", fact.label, fact.value);
    }
    Ok(())
}

/// A picture of 8-bit gray or colour values.
fn read(name: &str) -> Result<Frame, Error> {
    let unreadable = |error: String| Error::new(format!("{name} cannot be read: {error}"));
    let file = File::open(name).map_err(|error| unreadable(error.to_string()))?;
    let mut decoder = png::Decoder::new(BufReader::new(file));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().map_err(|error| unreadable(error.to_string()))?;
    let mut samples = vec![0; reader.output_buffer_size().ok_or_else(|| unreadable("it is too large".into()))?];
    let info = reader.next_frame(&mut samples).map_err(|error| unreadable(error.to_string()))?;
    let (width, height) = (info.width as usize, info.height as usize);
    let channels = info.color_type.samples();
    let pixel = |x: usize, y: usize| &samples[(y * width + x) * channels..][..channels];
    Ok(match channels {
        1 | 2 => Frame::gray(Grid::from_fn(width, height, |x, y| pixel(x, y)[0])),
        _ => Frame::rgb(Grid::from_fn(width, height, |x, y| [pixel(x, y)[0], pixel(x, y)[1], pixel(x, y)[2]])),
    })
}
