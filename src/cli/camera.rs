//! `motionscope camera`: lists the cameras and records a clip.

use std::ffi::OsStr;
use std::path::Path;
use std::time::Duration;

use motionscope_core::base::{Error, Stop};

use super::args::CameraArgs;
use crate::media::camera::{Cameras, Device, Ffmpeg, Recorded, Size, record};
use crate::media::names::file_name;
use crate::work::finish;

/// Lists the cameras, or records from one; returns the text of the outcome.
///
/// # Errors
/// If there is no such camera, it sends no frames, or the file cannot be written.
pub fn camera(args: &CameraArgs) -> Result<String, Error> {
    let cameras = Ffmpeg::default();
    match &args.out {
        Some(out) if !args.list => recorded(&cameras, args, out),
        _ => Ok(listed(&cameras)),
    }
}

fn listed(cameras: &impl Cameras) -> String {
    let (all, error) = finish(cameras.list());
    let line = |device: &Device| match device {
        Device::Camera { name, address } => format!("{name} ({address})\n"),
        Device::TestPicture => format!("{} (a moving pattern, without a camera)\n", device.name()),
    };
    let lines: String = all.iter().map(line).collect();
    match error {
        Some(error) => format!("{lines}No camera is listed: {error}.\n"),
        None if all.len() == 1 => format!("{lines}No camera is connected.\n"),
        None => lines,
    }
}

/// The first camera of `all`: the test picture is recorded only if it is asked for.
fn first(all: &[Device], error: Option<Error>) -> Result<&Device, Error> {
    let none = || Error::new("no camera is connected; connect one, or record the test picture with --device test");
    let camera = all.iter().find(|device| **device != Device::TestPicture);
    camera.ok_or_else(|| error.unwrap_or_else(none))
}

fn recorded(cameras: &impl Cameras, args: &CameraArgs, out: &Path) -> Result<String, Error> {
    if out.extension().and_then(OsStr::to_str) != Some("y4m") {
        return Err(Error::new(format!("{}: the name of a recorded clip must end in .y4m", out.display())));
    }
    // What was recorded cannot be made again.
    if out.exists() && !args.force {
        let out = out.display();
        return Err(Error::new(format!(
            "--out {out} would replace an earlier file; choose another name, or add --force to overwrite"
        )));
    }
    let (all, error) = finish(cameras.list());
    let device = match &args.device {
        None => first(&all, error)?.clone(),
        // The list may leave a device out that ffmpeg can open.
        Some(path) if path.starts_with("/dev/") => Device::Camera { name: path.clone(), address: path.clone() },
        Some(wanted) => Device::find(&all, wanted).map_err(|unknown| error.unwrap_or(unknown))?.clone(),
    };
    let feed = finish(cameras.open(&device, args.size, &Stop::default()))?;
    let Recorded { frames, size: (width, height), time, ended } =
        finish(record(feed, Duration::from_secs_f32(args.seconds), out, None))?;
    let seconds = time.as_secs_f32();
    let early = ended.map_or_else(String::new, |why| format!("\nThe recording ended early: {why}."));
    let (name, from) = (file_name(out), device.name());
    let other = if Size::new(width, height) == args.size { String::new() } else { unsent(args.size, from) };
    Ok(format!("{name}: {frames} frames of {width}×{height} px in {seconds:.1} s, from {from}{other}{early}"))
}

/// Says that a camera has sent frames of another size than was asked for.
fn unsent(Size { width, height }: Size, from: &str) -> String {
    format!("\n{from} sends no frames of {width}×{height} px.")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_test_picture_is_not_recorded_unasked() {
        let camera = Device::Camera { name: "Webcam".into(), address: "/dev/video0".into() };
        assert_eq!(first(&[camera.clone(), Device::TestPicture], None), Ok(&camera));
        let none = first(&[Device::TestPicture], None).unwrap_err().to_string();
        assert!(none.contains("no camera is connected") && none.contains("--device test"), "{none}");
        let why = Error::new("cameras need ffmpeg");
        assert_eq!(first(&[Device::TestPicture], Some(why.clone())), Err(why));
    }
}
