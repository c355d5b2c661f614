//! Points in space, as a file that point-cloud viewers open.

use motionscope_core::base::Error;
use motionscope_core::products::{DisparityField, Output, Product, SceneFlowField};

use super::{EncodedFiles, Export, Format};

pub const EXPORT: Export = Export {
    flag: "cloud",
    value: "FILE.ply",
    help: "Save the pixels of known depth as points in m as a binary .ply, those of a scene flow with colour, displacement and own motion; `-` is standard output",
    name: "Point cloud",
    explained: "The pixels of known depth as points in space, in m.",
    takes: &[SceneFlowField::KIND, DisparityField::KIND],
    folder: None,
    or_file: false,
    formats: &[Format { ending: "ply", doc: "PLY, binary", encode }],
};

/// The mark of a vertex of which it is not known whether it has a motion of its own.
const UNKNOWN: u8 = 255;

/// A vertex: position, colour, displacement in m a frame, and whether it has a motion of its own.
struct Vertex {
    at: [f64; 3],
    color: [u8; 3],
    motion: [f64; 3],
    own: Option<bool>,
}

fn encode(output: &Output) -> Result<EncodedFiles, Error> {
    if let Some(field) = output.get::<SceneFlowField>() {
        if field.calibration.is_none() {
            return Err(Error::new(
                "points in metres need the focal length and the baseline of the cameras; open their calibration or type it",
            ));
        }
        return Ok(EncodedFiles::file(of_scene_flow(field)));
    }
    let field = output.get::<DisparityField>();
    let field = field.ok_or_else(|| Error::new("this result has no depths; choose an estimator of stereo"))?;
    Ok(EncodedFiles::file(of_disparity(field)?))
}

fn of_scene_flow(field: &SceneFlowField) -> Vec<u8> {
    let picture = &field.picture;
    let vertex = |(x, y): (usize, usize)| {
        let color = picture.color().map_or([picture.luma()[(x, y)]; 3], |color| color[(x, y)]);
        Some(Vertex {
            at: field.position((x, y))?,
            color,
            motion: field.motion((x, y)).map_or([f64::NAN; 3], |motion| motion.displacement()),
            own: field.moving.as_ref().filter(|_| field.motion((x, y)).is_some()).map(|moving| moving.get(x, y)),
        })
    };
    let all: Vec<_> = field.pixels().filter_map(vertex).collect();
    let properties = "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float dx\nproperty float dy\n\
                      property float dz\nproperty uchar own_motion\n";
    let mut bytes = header(all.len(), properties);
    for Vertex { at, color, motion, own } in all {
        write_vector(&mut bytes, at);
        bytes.extend(color);
        write_vector(&mut bytes, motion);
        bytes.push(own.map_or(UNKNOWN, u8::from));
    }
    bytes
}

fn of_disparity(field: &DisparityField) -> Result<Vec<u8>, Error> {
    field.depth_m()?;
    let (width, height) = field.map.0.size();
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let place = |(x, y): (usize, usize)| field.calibration?.point_m([x as f64, y as f64], field.map.at(x, y)?.into());
    let all: Vec<_> = pixels.filter_map(place).collect();
    let mut bytes = header(all.len(), "");
    all.into_iter().for_each(|at| write_vector(&mut bytes, at));
    Ok(bytes)
}

fn header(vertices: usize, properties: &str) -> Vec<u8> {
    format!(
        "ply\nformat binary_little_endian 1.0\ncomment metres; x to the right, y down, z forwards from the left camera; own_motion 255 is unknown\n\
         element vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n{properties}end_header\n"
    )
    .into_bytes()
}

fn write_vector(bytes: &mut Vec<u8>, vector: [f64; 3]) {
    vector.into_iter().for_each(|c| bytes.extend((c as f32).to_le_bytes()));
}

#[cfg(test)]
mod tests {
    use motionscope_core::base::Threads;
    use motionscope_core::course::estimator;
    use motionscope_core::data::{Calibration, Disparity};
    use motionscope_core::geometry::Grid;
    use motionscope_core::synth;

    use super::*;

    /// The header of a file, and its vertices of `size` bytes.
    fn parts(bytes: &[u8], size: usize) -> (String, Vec<&[u8]>) {
        let end = b"end_header\n";
        let at = bytes.windows(end.len()).position(|part| part == end).expect("an end of the header") + end.len();
        (String::from_utf8(bytes[..at].to_vec()).expect("text"), bytes[at..].chunks(size).collect())
    }

    fn float(vertex: &[u8], index: usize) -> f32 {
        f32::from_le_bytes(vertex[4 * index..4 * index + 4].try_into().expect("four bytes"))
    }

    #[test]
    fn depths_become_points() {
        let map = Disparity(Grid::from_vec(2, 1, vec![Disparity::UNKNOWN, 18.0]).unwrap());
        let calibration = Calibration::new(300.0, 0.12, [0.0; 2]).ok();
        let field = DisparityField { map, calibration, candidates: 64, filled: None };
        let made = encode(&Output::of(field.clone())).unwrap();
        let (header, vertices) = parts(&made.files[0].1, 12);
        assert!(header.contains("element vertex 1\n") && vertices.len() == 1);
        assert_eq!([0, 1, 2].map(|i| float(vertices[0], i)), [2.0 / 300.0, 0.0, 2.0]);
        let why = encode(&Output::of(DisparityField { calibration: None, ..field })).unwrap_err().to_string();
        assert!(why.contains("focal length"), "{why}");
    }

    #[test]
    fn a_scene_flow_has_colours_and_displacements() {
        let scene = synth::scene("drive").unwrap();
        let clip = scene.clip(&scene.difficulty()).unwrap();
        let mut estimator = estimator("scene-flow").unwrap();
        estimator.set("source", "truth").unwrap();
        estimator.set("noise", "0").unwrap();
        let output = estimator.run(&clip, 0, &Threads::single()).unwrap();
        let made = encode(&output).unwrap();
        let (header, vertices) = parts(&made.files[0].1, 28);
        assert_eq!(vertices.len(), 320 * 240, "{header}");
        assert!(header.contains("element vertex 76800\n") && header.contains("property uchar own_motion"));
        // The house fronts stand still, so they come nearer by what the cameras drive.
        let near = f32::from_le_bytes(vertices[120 * 320 + 4][23..27].try_into().unwrap());
        assert!((near + 0.314).abs() < 0.05, "{near}");
    }
}
