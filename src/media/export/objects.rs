//! Detections and tracked objects as tables and as MOTChallenge rows.

use std::path::Path;

use motionscope_core::objects::trajectory::{Sighting, Trajectory};
use motionscope_core::{Bounds, Detection, Error, Followed, Grid, Life, Object, ObjectField, PackedMask};

use super::{Cell, Table, objects_npy};

/// What tracked objects are written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrackFormat {
    /// MOTChallenge's rows: [`tracks`].
    Mot,
    /// A table with units.
    Csv,
    /// A NumPy array: [`objects_npy`].
    Npy,
}

impl TrackFormat {
    /// The format that the ending of a file's name asks for; MOTChallenge's for `-`.
    ///
    /// # Errors
    /// If it asks for none of them.
    pub fn of(path: &Path) -> Result<Self, Error> {
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase();
        match ending.as_str() {
            _ if path == Path::new("-") => Ok(Self::Mot),
            "txt" => Ok(Self::Mot),
            "csv" => Ok(Self::Csv),
            "npy" => Ok(Self::Npy),
            _ => Err(Error::new(format!(
                "{} is no name for tracks; one ends in .txt (MOTChallenge), .csv or .npy, or is -",
                path.display()
            ))),
        }
    }

    /// The bytes of the file.
    ///
    /// # Errors
    /// If nobody is followed.
    pub fn encode(self, field: &ObjectField) -> Result<Vec<u8>, Error> {
        let rows = tracks(field)?;
        Ok(match self {
            Self::Mot => rows.into_bytes(),
            Self::Csv => objects(field).csv().into_bytes(),
            Self::Npy => objects_npy(field),
        })
    }
}

/// One row for each place of a trajectory where these were looked at; else for each object in each frame, or for each detection
/// where nobody is followed. Velocities are in px/frame; the edge of the first pixel lies at −0.5 px.
pub fn csv(field: &ObjectField) -> String {
    if !field.trajectories.is_empty() {
        trajectories(field).csv()
    } else if field.followed == Followed::Nobody {
        detections(field).csv()
    } else {
        objects(field).csv()
    }
}

fn frames(field: &ObjectField) -> impl Iterator<Item = (Cell, &motionscope_core::ObjectFrame)> {
    field.frames.iter().enumerate().map(|(i, frame)| (Cell::Int((field.first + i) as i64), &**frame))
}

/// Upper left corner, width and height.
fn place(bounds: &Bounds) -> [Cell; 4] {
    let ([x, y], [width, height]) = (bounds.min, bounds.size());
    [x, y, width, height].map(Cell::Single)
}

fn objects(field: &ObjectField) -> Table<13> {
    let columns = [
        "frame",
        "id",
        "x_px",
        "y_px",
        "u_px_per_frame",
        "v_px_per_frame",
        "left_px",
        "top_px",
        "width_px",
        "height_px",
        "status",
        "sigma_x_px",
        "sigma_y_px",
    ];
    let row = |frame: Cell, object: &Object| {
        let [x, y] = object.position.map(Cell::Real);
        let [u, v] = object.velocity.map_or([Cell::Empty; 2], |velocity| velocity.map(Cell::Real));
        let [left, top, width, height] = place(&object.bounds);
        let sigma = |i: usize| object.covariance.map_or(Cell::Empty, |c| Cell::Real(c[i][i].max(0.0).sqrt()));
        let status = Cell::Word(object.life.name());
        let id = Cell::Int(i64::from(object.id));
        [frame, id, x, y, u, v, left, top, width, height, status, sigma(0), sigma(1)]
    };
    let rows = frames(field).flat_map(|(t, frame)| frame.objects.iter().map(move |object| row(t, object)));
    Table { columns, rows: rows.collect() }
}

/// Where each object was seen, how it moved there, and what became of it: `crossed` is 1 where it went over the line to its right
/// and −1 to its left, `in_zone` is 1 in the zone, and `unusual_deg` is how far its heading is off those of others where that
/// is unusual. Headings count from right, against the clock.
fn trajectories(field: &ObjectField) -> Table<10> {
    let columns = [
        "frame",
        "id",
        "x_px",
        "y_px",
        "speed_px_per_frame",
        "heading_deg",
        "step_px_per_frame",
        "crossed",
        "in_zone",
        "unusual_deg",
    ];
    let row = |of: &Trajectory, seen: &Sighting| {
        let [x, y] = seen.at.map(Cell::Real);
        let speed = |v: Option<[f64; 2]>| v.map_or(Cell::Empty, |[u, v]| Cell::Real(u.hypot(v)));
        let crossing = of.crossings.iter().find(|crossing| crossing.frame == seen.frame);
        let is_inside = of.stays.iter().any(|stay| (stay.entered..=stay.last).contains(&seen.frame));
        [
            Cell::Int(seen.frame as i64),
            Cell::Int(i64::from(of.id)),
            x,
            y,
            speed(seen.velocity),
            seen.heading_deg().map_or(Cell::Empty, Cell::Real),
            speed(seen.step),
            Cell::Int(crossing.map_or(0, |crossing| if crossing.is_forward { 1 } else { -1 })),
            Cell::Int(i64::from(is_inside)),
            seen.unusual.map_or(Cell::Empty, |unusual| Cell::Real(unusual.angle_deg)),
        ]
    };
    let rows = field.trajectories.iter().flat_map(|of| of.sightings.iter().map(move |seen| row(of, seen)));
    Table { columns, rows: rows.collect() }
}

fn detections(field: &ObjectField) -> Table<12> {
    let columns = [
        "frame",
        "x_px",
        "y_px",
        "left_px",
        "top_px",
        "width_px",
        "height_px",
        "score",
        "area_px",
        "angle_deg",
        "elongation",
        "gray",
    ];
    let row = |frame: Cell, found: &Detection| {
        let [x, y] = found.center.map(Cell::Single);
        let [left, top, width, height] = place(&found.bounds);
        let blob = found.blob.map_or([Cell::Empty; 4], |blob| {
            let [long, short] = blob.radii;
            let angle = Cell::Single(blob.angle_rad.to_degrees());
            [Cell::Int(i64::from(blob.area_px)), angle, Cell::Single(long / short), Cell::Single(blob.gray)]
        });
        let [area, angle, elongation, gray] = blob;
        [frame, x, y, left, top, width, height, Cell::Single(found.score), area, angle, elongation, gray]
    };
    let rows = frames(field).flat_map(|(t, frame)| frame.detections.iter().map(move |found| row(t, found)));
    Table { columns, rows: rows.collect() }
}

/// The objects seen in each frame as MOTChallenge's results: frame, id, left, top, width, height, 1, −1, −1, −1; frames and
/// pixels counted from 1. Tentative objects and those that coast are left out.
///
/// # Errors
/// If nobody is followed.
pub fn tracks(field: &ObjectField) -> Result<String, Error> {
    if field.followed == Followed::Nobody {
        return Err(Error::new(
            "each frame was looked at by itself, so there are no tracks; choose a tracker, or --table",
        ));
    }
    let seen = |object: &&Object| object.life == Life::Confirmed;
    let row = |t: usize, object: &Object| {
        let ([x, y], [width, height]) = (object.bounds.min, object.bounds.size());
        let [left, top, width, height] = super::mot::rect([x, y, width, height]);
        format!("{},{},{left},{top},{width},{height},1,-1,-1,-1\n", t + 1, object.id)
    };
    let frames = field.frames.iter().enumerate();
    let rows = frames.flat_map(|(i, frame)| frame.objects.iter().filter(seen).map(move |o| row(field.first + i, o)));
    Ok(rows.collect())
}

/// The mask of each frame that has one as a PNG, white where something was found, and what its file is called: `mask_0007.png`.
///
/// # Errors
/// If there are no masks.
pub fn masks(field: &ObjectField) -> Result<Vec<(String, Vec<u8>)>, Error> {
    let masks = field.frames.iter().enumerate().filter_map(|(i, frame)| Some((field.first + i, frame.mask.as_ref()?)));
    let picture = |(t, mask): (usize, &PackedMask)| {
        let mask = mask.unpacked();
        let (width, height) = mask.size();
        let pixels = Grid::from_fn(width, height, |x, y| if mask.get(x, y) { 255 } else { 0 });
        Ok((mask_name(t), super::png_result(width, height, super::Pixels::Gray(pixels.cells()))?))
    };
    let files = masks.map(picture).collect::<Result<Vec<_>, Error>>()?;
    if files.is_empty() {
        return Err(Error::new("no pixels were told apart, so there are no masks; choose a background model"));
    }
    Ok(files)
}

/// What the names of all masks begin with.
pub const MASK: &str = "mask_";

/// What the file of the mask of a frame is called.
pub fn mask_name(frame: usize) -> String {
    format!("{MASK}{frame:04}.png")
}

/// Writes masks into a folder, which is made if there is none; says how many.
///
/// # Errors
/// If one cannot be written.
pub fn write_masks(folder: &Path, masks: &[(String, Vec<u8>)]) -> Result<String, Error> {
    super::make_folder(folder)?;
    masks.iter().try_for_each(|(name, bytes)| super::save_result(&folder.join(name), bytes))?;
    Ok(if masks.len() == 1 { "1 mask".into() } else { format!("{} masks", masks.len()) })
}

#[cfg(test)]
pub(super) mod tests {
    use std::sync::Arc;

    use motionscope_core::objects::trajectory::Places;
    use motionscope_core::params::Line;
    use motionscope_core::{Blob, ObjectFrame};

    use super::*;

    pub fn field() -> ObjectField {
        let bounds = Bounds { min: [-0.5, 9.5], max: [3.5, 12.0] };
        let blob = Blob { label: 1, area_px: 10, radii: [2.0, 1.0], angle_rad: 0.0, gray: 90.0 };
        let found = Detection { bounds, center: bounds.center(), score: 0.5, blob: Some(blob) };
        let object = |id, life| Object {
            id,
            bounds,
            life,
            position: [1.5, 10.75],
            velocity: Some([1.0, -0.5]),
            covariance: Some([[4.0, 0.0], [0.0, 2.25]]),
            detection: None,
        };
        let all = vec![object(3, Life::Confirmed), object(4, Life::Coasting), object(5, Life::Tentative)];
        let frames = vec![
            Arc::new(ObjectFrame { mask: None, detections: vec![found], objects: Vec::new() }),
            Arc::new(ObjectFrame { mask: None, detections: Vec::new(), objects: all }),
        ];
        ObjectField { followed: Followed::All, picture: (32, 24), first: 4, frames, trajectories: Vec::new() }
    }

    #[test]
    fn results_count_frames_and_pixels_from_one() {
        assert_eq!(tracks(&field()), Ok("6,3,1,11,4,2.5,1,-1,-1,-1\n".into()));
        let nobody = ObjectField { followed: Followed::Nobody, ..field() };
        assert!(tracks(&nobody).unwrap_err().to_string().contains("choose a tracker"));
    }

    #[test]
    fn a_table_of_trajectories_tells_what_became_of_each() {
        let places = Places { line: Some(Line { from: [10.0, 9.0], to: [10.0, 0.0] }), zone: None, window: 3 };
        let mut of = Trajectory { id: 4, ..Trajectory::default() };
        for (t, x) in [(6, 8.0), (7, 9.0), (8, 12.0)] {
            of.see(t, [x, 5.0], &places);
        }
        let all = csv(&ObjectField { trajectories: vec![Arc::new(of)], ..field() });
        let rows: Vec<_> = all.lines().collect();
        assert_eq!(rows[1..], ["6,4,8,5,,,,0,0,", "7,4,9,5,1,0,1,0,0,", "8,4,12,5,2,0,3,1,0,"]);
    }

    #[test]
    fn the_ending_of_a_name_says_how_tracks_are_written() {
        let of = |name: &str| TrackFormat::of(Path::new(name));
        let all = ["-", "a.txt", "a.CSV", "b/c.npy"].map(|name| of(name).unwrap());
        assert_eq!(all, [TrackFormat::Mot, TrackFormat::Mot, TrackFormat::Csv, TrackFormat::Npy]);
        assert!(of("a.png").unwrap_err().to_string().contains(".npy") && of("a").is_err());
    }

    #[test]
    fn a_table_tells_of_objects_or_else_of_detections() {
        let all = csv(&field());
        assert!(all.contains("\n5,4,1.5,10.75,1,-0.5,-0.5,9.5,4,2.5,coasting,2,1.5\n"), "{all}");
        let mut found = field();
        found.frames.truncate(1);
        assert!(
            csv(&found).starts_with("frame,id,x_px,y_px,u_px_per_frame,"),
            "whoever tracks nobody has the same columns"
        );
        found.followed = Followed::Nobody;
        let all = csv(&found);
        assert!(all.contains("\n4,1.5,10.75,-0.5,9.5,4,2.5,0.5,10,0,2,90\n"), "{all}");
    }
}
