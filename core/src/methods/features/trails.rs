//! The drawing of point tracks through a clip, and the plot of their number.

use std::sync::Arc;

use crate::products::Track;
use crate::run::Span;
use crate::scene::{Arrow, Picture, Readout, Role, Scene, Series, Shape};

/// Length of a trail, in frames.
const TRAIL_FRAMES: usize = 20;

/// Marks positions in frame t, if there are any.
pub(crate) fn points(scene: &mut Scene, role: Role, meaning: &'static str, places: Vec<[f32; 2]>) {
    if !places.is_empty() {
        scene.draw(Picture::CURRENT, (role, meaning), Shape::Points(places));
    }
}

/// Draws displacements, if there are any.
pub(crate) fn displacements(scene: &mut Scene, arrows: Vec<Arrow>) {
    if !arrows.is_empty() {
        scene.draw(Picture::CURRENT, (Role::Result, "displacement to frame t+1"), Shape::Arrows(arrows));
    }
}

/// Draws the positions of a point in the frames up to `frame`.
pub(crate) fn trail(scene: &mut Scene, (role, meaning): (Role, &'static str), track: &Track, frame: usize) {
    let first = frame.saturating_sub(TRAIL_FRAMES);
    let points: Vec<_> = (first..=frame).filter_map(|t| track.at(t)).map(|feature| feature.at).collect();
    if points.len() > 1 {
        scene.draw(Picture::CURRENT, (role, meaning), Shape::line(points));
    }
}

/// Plots the number of tracked, new and lost points in each pair.
pub(crate) fn turnover(title: &'static str, counts: &[u32], tracks: &[Arc<Track>], span: &Span) -> Option<Readout> {
    let line: Vec<_> = counts.iter().enumerate().map(|(i, count)| [(i + 1) as f32, *count as f32]).collect();
    let tally = |frame: &dyn Fn(&Track) -> usize| {
        let mut counts = vec![0.0; line.len()];
        for track in tracks {
            if let Some(count) = counts.get_mut(frame(track) - span.first) {
                *count += 1.0;
            }
        }
        counts.iter().enumerate().map(|(i, count)| [(i + 1) as f32, *count]).collect()
    };
    let new = tally(&|track| track.first);
    // A track that is not lost ends in a frame with which no earlier pair begins.
    let lost = tally(&|track| track.first + track.points.len() - 1);
    let series = Series::new(
        title,
        ["pair", "number of points"],
        span.frames().map_or(line.len(), |frames| frames - 1),
        vec![("tracked", Role::Result, line), ("new", Role::Measured, new), ("lost", Role::Rejected, lost)],
    );
    (series.lines[0].2.len() > 1).then_some(Readout::Series(series))
}
