//! How points that go through a clip are drawn, and how many there are from pair to pair.

use std::sync::Arc;

use crate::products::Track;
use crate::run::Span;
use crate::scene::{Arrow, Picture, Readout, Role, Scene, Series, Shape};

/// So many frames back a trail reaches.
const TRAIL_FRAMES: usize = 20;

/// Marks places of frame t, if there are any.
pub(crate) fn points(scene: &mut Scene, role: Role, meaning: &'static str, places: Vec<[f32; 2]>) {
    if !places.is_empty() {
        scene.mark(Picture::CURRENT, role, Shape::Points(places));
        scene.legend(role, meaning);
    }
}

/// Marks the displacements that were found, if there are any.
pub(crate) fn displacements(scene: &mut Scene, arrows: Vec<Arrow>) {
    if !arrows.is_empty() {
        scene.mark(Picture::CURRENT, Role::Result, Shape::Arrows(arrows));
        scene.legend(Role::Result, "displacements found");
    }
}

/// Where a point was in the frames up to `frame`.
pub(crate) fn trail(scene: &mut Scene, (role, meaning): (Role, &'static str), track: &Track, frame: usize) {
    let first = frame.saturating_sub(TRAIL_FRAMES);
    let points: Vec<_> = (first..=frame).filter_map(|t| track.at(t)).map(|feature| feature.at).collect();
    if points.len() > 1 {
        scene.mark(Picture::CURRENT, role, Shape::Path { points, closed: false });
        scene.legend(role, meaning);
    }
}

/// How many points were tracked in each pair, as `counts` says, how many of them were new there, and how many were lost.
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
    // What is not lost has its last point in a frame that no pair before begins with.
    let lost = tally(&|track| track.first + track.points.len() - 1);
    let series = Series {
        title,
        x_label: "pair",
        y_label: "how many",
        x_max: span.frames().map_or(line.len(), |frames| frames - 1),
        lines: vec![("tracked", Role::Result, line), ("new", Role::Measured, new), ("lost", Role::Rejected, lost)],
        ..Series::default()
    };
    (series.lines[0].2.len() > 1).then_some(Readout::Series(series))
}
