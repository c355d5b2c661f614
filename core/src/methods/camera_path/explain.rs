//! The chaining of motions in words, numbers and marks.

use super::chain::pairs_line as line;
use super::{Chain, Link, Refused};
use crate::base::words::{self, fixed, grouped};
use crate::data::Clip;
use crate::geometry::Grid;
use crate::products::model::{Matrix3, Support, inverse, mapped, product};
use crate::products::path::{chained, corner_error, middle, track, true_motions};
use crate::scene::{Fact, Matrix, Name, Picture, Readout, Role, Scene, Sentence, Series, Shape};

/// A matrix with its symbol and its name, to be shown.
pub fn matrix(symbol: &'static str, name: &'static str, role: Role, entries: &Matrix3) -> Matrix {
    Matrix {
        symbol,
        name,
        role: Some(role),
        entries: Grid::from_fn(3, 3, |x, y| entries[y][x]),
        rows: Vec::new(),
        columns: Vec::new(),
        changed: None,
        decimals: None,
    }
}

fn px(value: f64) -> String {
    format!("{} px", fixed(value, 2))
}

fn vector([u, v]: [f64; 2]) -> String {
    format!("({},\u{a0}{}) px", fixed(u, 2), fixed(v, 2))
}

/// The displacement of the middle of a picture by a map.
fn displacement(map: &Matrix3, size: (usize, usize)) -> [f64; 2] {
    let from = middle(size);
    mapped(map, from).map_or([0.0; 2], |to| [to[0] - from[0], to[1] - from[1]])
}

/// The line and the sentence of a pair: its estimate, or once that `is_chained` the path.
pub fn chain_step(chain: &Chain, link: &Link, (is_chained, stage): (bool, &str)) -> (Name, Sentence) {
    let (said, size, t) = (Sentence::default(), chain.picture, chain.frame);
    if is_chained {
        let at = inverse(&link.after).and_then(|back| mapped(&back, middle(size))).unwrap_or(middle(size));
        let moved = [0, 1].map(|i| at[i] - middle(size)[i]);
        let sentence = said
            .text(format!("P({}) = M({t}) P({t}): the view has moved by ", t + 1))
            .ink(Role::Result, vector(moved))
            .text(" from the first frame. Errors of the motions add up along the chain.");
        return (line::CHAIN, sentence);
    }
    let found = said.text(format!("{stage} finds the motion of the background from frame {t} to frame {}: ", t + 1));
    let sentence = match link.refused {
        None => found
            .ink(Role::Measured, vector(displacement(&link.motion, size)))
            .text(" at the centre of the picture")
            .text(match link.field.support {
                Some(support) => {
                    format!(", with {} of {} matches.", grouped(support.inliers), grouped(support.matches))
                }
                None => ".".to_owned(),
            }),
        Some(refused) => found
            .ink(
                Role::Rejected,
                match refused {
                    Refused::Path => "none that continues the path",
                    _ => "none that is usable",
                },
            )
            .text(format!(". {} The camera counts as at rest in this pair.", why(refused))),
    };
    (line::ESTIMATE, sentence)
}

/// Why a motion is not used, as a sentence.
pub fn why(refused: Refused) -> String {
    match refused {
        Refused::Unknown(model, Some(Support { inliers, matches })) => format!(
            "A motion of the model ({}) has {} as inliers. At least {} are needed, and more than agree by chance: the frames overlap too little, or \
             have too little texture.",
            model.label().to_lowercase(),
            format_args!("{} of {}", grouped(inliers), words::counted(matches, "match")),
            model.sample_size()
        ),
        Refused::Unknown(model, None) => format!(
            "The motion stage rejects its estimate ({}); the steps of that method say which number was too small.",
            model.label().to_lowercase()
        ),
        Refused::Singular => "The matrix has no inverse.".to_owned(),
        Refused::Far { moved_px, .. } if moved_px.is_infinite() => "It maps a corner of the picture beyond the horizon line, as no camera does.".to_owned(),
        Refused::Far { moved_px, most_px } => {
            format!("The motion moves a corner by {}, and the diagonal of the picture, {}, is the most.", px(moved_px), px(most_px))
        }
        Refused::Worse { registered, at_rest } => format!(
            "Registered by it the frames differ by {} gray levels on average, and by {} as they are: its few inliers lie on an object, or are wrong.",
            fixed(registered, 2),
            fixed(at_rest, 2)
        ),
        Refused::Bent { bend_px, registered, at_rest } => format!(
            "The motion bends the picture: a corner is {} off the nearest similarity. The median difference of the frames registered by it is {} gray levels, \
             and {} as they are: many of its inliers lie on a moving object. The model similarity avoids it.",
            px(bend_px),
            fixed(registered, 2),
            fixed(at_rest, 2)
        ),
        Refused::Path => "Chained to the motions before, it gives a map from the first frame without an inverse: the view has moved too far from \
                          that of the first frame. A shorter run helps."
            .to_owned(),
    }
}

/// How many pairs of a run have no usable motion, and why the first has none, as sentences; empty if all have one.
pub fn unknown_pairs(chain: &Chain) -> String {
    let Some((frame, refused)) = chain.first_refused else { return String::new() };
    format!(
        " Pairs without a usable motion, which count as at rest: {} of {}. Frames {frame} and {}: {}",
        grouped(chain.unknown),
        grouped(chain.motions.len()),
        frame + 1,
        why(refused)
    )
}

/// How many motions of a run bend the picture, and what that means, as sentences; empty if none does.
pub fn bent_pairs(chain: &Chain) -> String {
    let Some((frame, bend_px)) = chain.first_bent else { return String::new() };
    format!(
        " Motions that bend the picture: {} of {}. From frame {frame} to {} a corner is {} off the nearest similarity. A camera bends \
         consecutive frames less, so matches on a moving object may be taken for the background; the model similarity avoids it.",
        grouped(chain.bent),
        grouped(chain.motions.len()),
        frame + 1,
        px(bend_px)
    )
}

/// The numbers of a pair.
pub fn chain_facts(chain: &Chain, link: &Link, is_chained: bool) -> Vec<Fact> {
    let size = chain.picture;
    let mut facts = vec![Fact::new("Pair", format!("frames {} and {}", chain.frame, chain.frame + 1), None)];
    facts.push(Fact::new("Motion of the centre", vector(displacement(&link.motion, size)), Some(Role::Measured)));
    match &link.truth {
        Ok(None) => {}
        Ok(Some(truth)) => {
            let error = corner_error([&link.motion, truth], size);
            facts.push(Fact::new("Motion of the centre, true", vector(displacement(truth, size)), Some(Role::Truth)));
            facts.push(Fact::new("Error at the corners", px(error), Some(Role::Error)));
        }
        Err(error) => facts.push(Fact::new("Motion of the centre, true", error.to_string(), Some(Role::Rejected))),
    }
    if is_chained {
        facts.push(Fact::new("Pairs chained", (chain.motions.len() + 1).to_string(), None));
    }
    if chain.unknown > 0 {
        facts.push(Fact::new("Pairs without a motion", words::counted(chain.unknown, "pair"), Some(Role::Rejected)));
    }
    facts
}

/// The camera's path along x and along y: by the estimated motions, smoothed, and true.
pub fn path_series(chain: &Chain, corrections: &[Matrix3], clip: &Clip) -> Vec<Readout> {
    let (maps, size) = (&chain.to_frames[..], chain.picture);
    if maps.len() < 2 {
        return Vec::new();
    }
    let smooth: Vec<_> = corrections.iter().zip(maps).map(|(correction, map)| product(correction, map)).collect();
    // A truth that cannot be read is said with the pair that needs it.
    let truth = true_motions(clip, (chain.span.first, maps.len() - 1)).unwrap_or_default().map(|all| chained(&all));
    let line = |maps: &[Matrix3], axis: usize| -> Vec<[f32; 2]> {
        let places = track(maps, size);
        places.iter().enumerate().map(|(i, at)| [(chain.span.first + i) as f32, at[axis] as f32]).collect()
    };
    let series = |axis: usize, title, y_label| {
        let mut lines = vec![("estimated", Role::Measured, line(maps, axis))];
        lines.extend(truth.as_ref().map(|truth| ("true", Role::Truth, line(truth, axis))));
        if !smooth.is_empty() {
            lines.push(("smoothed", Role::Result, line(&smooth, axis)));
        }
        Readout::Series(Series {
            title,
            x_label: "frame",
            y_label,
            x_max: chain.span.first + chain.frames().unwrap_or(maps.len()) - 1,
            lines,
            fits_values: true,
            ..Series::default()
        })
    };
    vec![series(0, "Path of the camera along x", "x in px"), series(1, "Path of the camera along y", "y in px")]
}

/// The outline of frame t in frame t + 1, and the path of the camera so far in frame t.
pub fn draw_link(chain: &Chain, link: &Link, scene: &mut Scene) {
    let (width, height) = chain.picture;
    let [right, bottom] = [(width - 1) as f64, (height - 1) as f64];
    let corners = [[0.0, 0.0], [right, 0.0], [right, bottom], [0.0, bottom]];
    let outline = |map: &Matrix3| -> Option<Vec<[f32; 2]>> {
        corners.iter().map(|at| mapped(map, *at).map(|to| to.map(|c| c as f32))).collect()
    };
    if let Some(points) = outline(&link.motion) {
        scene.mark(Picture::NEXT, Role::Window, Shape::Path { points, closed: true });
        scene.legend(Role::Window, "outline of frame t");
    }
    if let Some(points) = link.truth.iter().flatten().next().and_then(outline) {
        scene.mark(Picture::NEXT, Role::Truth, Shape::Path { points, closed: true });
        scene.legend(Role::Truth, "its true outline");
    }
    draw_path(chain, &link.before, scene);
}

/// Draws where the camera looked at in the frames so far, in the frame to which `to_frame` maps the first one.
fn draw_path(chain: &Chain, to_frame: &Matrix3, scene: &mut Scene) {
    let places = track(&chain.to_frames, chain.picture);
    let reach = 2.0 * chain.picture.0.max(chain.picture.1) as f64;
    let here = places.iter().filter_map(|at| mapped(to_frame, *at));
    let points: Vec<_> = here.filter(|at| at.iter().all(|c| c.abs() < reach)).map(|at| at.map(|c| c as f32)).collect();
    scene.mark(Picture::CURRENT, Role::Measured, Shape::Points(points.last().copied().into_iter().collect()));
    scene.mark(Picture::CURRENT, Role::Measured, Shape::Path { points, closed: false });
    scene.legend(Role::Measured, "path of the frame centre");
}
