//! What a figure shows of each picture: all of it or a part magnified, how large its pane is, and which marks reach into it.

use std::sync::Arc;

use motionscope_core::geometry::Grid;
use motionscope_core::scene::{Link, Mark, Picture, Shape};

use super::{FigureOptions, Part};
use crate::paint::focus::Site;
use crate::paint::primitive::{Point, Primitive, Rect};
use crate::paint::{CloseUp, Look, Panel, Placement, Work, ellipse, is_lengthened};

/// A part of a picture that is shown magnified, in its pane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Magnified {
    /// Where it lies and how closely it is shown.
    pub close_up: CloseUp,
    /// Width and height of its pane in px of the picture unmagnified; `None` for those of the picture.
    pub pane: Option<[f32; 2]>,
}

impl Magnified {
    /// The part that was chosen by hand of the pictures of `part`; `None` where they are shown whole.
    fn chosen(part: &Part<'_>, section: Rect) -> Option<Self> {
        let chosen = CloseUp::of_section(section, part.pictures.pair[0].size());
        chosen.map(|(close_up, pane)| Self { close_up, pane: Some(pane) })
    }

    /// Where a picture lies of which `pane` shows it; `zoom` points are a pixel of the whole.
    pub fn placement(&self, pane: Rect, zoom: f32) -> Placement {
        let CloseUp { center, times } = self.close_up;
        let zoom = zoom * times;
        let origin = [0, 1].map(|i| (pane.min[i] + pane.max[i]) / 2.0 - (center[i] + 0.5) * zoom);
        Placement { seen: Some(pane), ..Placement::new(origin, zoom) }
    }
}

/// Whether a part of frame t is one of the picture of `panel` too.
pub(super) fn has_part(panel: Panel) -> bool {
    panel.picture().is_aligned_with(Picture::CURRENT)
}

/// What is magnified of the pictures of each part.
pub(super) fn magnified(parts: &[Part<'_>], options: &FigureOptions) -> Vec<Option<Magnified>> {
    let Some(size) = parts.first().map(|part| part.pictures.pair[0].size()) else { return Vec::new() };
    if let Some(section) = options.section {
        return parts.iter().map(|part| Magnified::chosen(part, section)).collect();
    }
    let works: Vec<_> = parts.iter().map(|part| Work::of(part.scene, size)).collect();
    let site =
        Site { size, room: [size.0 as f32, size.1 as f32], at_end: options.at_end, before: &[], is_same_unit: false };
    // A close-up must not cut off what was drawn by hand.
    let close_ups = CloseUp::of(options.focus, &works, site);
    let cuts = |close_up: &CloseUp| {
        let seen = close_up.seen(site.room);
        options
            .freehand
            .iter()
            .filter(|line| line.picture().is_some())
            .flat_map(|line| &line.points)
            .any(|point| (0..2).any(|i| point[i] < seen.min[i] || point[i] > seen.max[i]))
    };
    let is_whole = close_ups.iter().flatten().any(cuts);
    let magnified = |close_up: CloseUp| Magnified { close_up, pane: None };
    close_ups.into_iter().map(|close_up| close_up.filter(|_| !is_whole).map(magnified)).collect()
}

/// Width and height of the pane of `panel` in px of its picture unmagnified.
pub(super) fn pane_size(part: &Part<'_>, panel: Panel, magnified: Option<Magnified>) -> [f32; 2] {
    let (width, height) = panel.size(&part.pictures);
    let pane = magnified.filter(|_| has_part(panel)).and_then(|magnified| magnified.pane);
    pane.unwrap_or([width as f32, height as f32])
}

/// The panes of `parts` in px of their pictures, one after the other, where `section` of them was chosen by hand.
pub(super) fn pane_sizes(
    parts: &[Part<'_>],
    panels: impl Fn(&Part<'_>) -> Vec<Panel>,
    section: Option<Rect>,
) -> Vec<[f32; 2]> {
    let sizes = |part: &Part<'_>| {
        let chosen = section.and_then(|section| Magnified::chosen(part, section));
        panels(part).into_iter().map(|panel| pane_size(part, panel, chosen)).collect::<Vec<_>>()
    };
    parts.iter().flat_map(sizes).collect()
}

/// The pixels that are seen at `place` and no others, where they lie.
pub(super) fn cut(pixels: &Grid<[u8; 4]>, place: Placement, seen: Rect) -> Primitive {
    let last = [pixels.width(), pixels.height()];
    let from = [0, 1].map(|i| (((seen.min[i] - place.origin[i]) / place.zoom).floor().max(0.0) as usize).min(last[i]));
    let to = [0, 1].map(|i| (((seen.max[i] - place.origin[i]) / place.zoom).ceil().max(0.0) as usize).min(last[i]));
    let part = Grid::from_fn(to[0] - from[0].min(to[0]), to[1] - from[1].min(to[1]), |x, y| {
        pixels[(from[0] + x, from[1] + y)]
    });
    let at = |pixel: [usize; 2]| [0, 1].map(|i| place.origin[i] + pixel[i] as f32 * place.zoom);
    Primitive::Image { pixels: Arc::new(part), rect: Rect::between(at(from), at(to)) }
}

/// Whether `mark` is seen on one of `panels`: on a whole picture always, else if it reaches into the part that is shown.
pub(super) fn is_seen(mark: &Mark, panels: &[(Panel, Placement)], look: &Look) -> bool {
    let mut shown = panels.iter().filter(|(panel, _)| panel.shows(mark.on));
    shown.any(|(_, place)| {
        let ink = look.theme.ink(mark.role);
        // Lines lie outside of what they frame.
        let part = part(place).map(|part| part.grown((ink.width + ink.halo_width) / place.zoom));
        part.is_none_or(|part| reaches(mark, part, look))
    })
}

/// Whether both ends of `link` lie in what `panels` show; an end lies on the other picture where its own is not shown.
pub(super) fn is_link_seen(link: &Link, panels: &[(Panel, Placement)]) -> bool {
    link.ends.iter().all(|(picture, at)| {
        let is_own_shown = panels.iter().any(|(panel, _)| panel.shows(*picture));
        let mut shown = panels.iter().filter(|(panel, _)| !is_own_shown || panel.shows(*picture));
        shown.any(|(_, place)| part(place).is_none_or(|part| part.contains(*at)))
    })
}

/// The visible part of a picture at `place`, in px; `None` if all of it is visible.
fn part(place: &Placement) -> Option<Rect> {
    let at = |point: Point| [0, 1].map(|i| (point[i] - place.origin[i]) / place.zoom - 0.5);
    place.seen.map(|seen| Rect { min: at(seen.min), max: at(seen.max) })
}

/// Whether something of `mark` lies in `part` of its picture: an outline around all of it does not.
fn reaches(mark: &Mark, part: Rect, look: &Look) -> bool {
    let is_filled = look.theme.ink(mark.role).fill.0[3] > 0;
    let outline = |points: &[Point]| crosses(points, true, part) || (is_filled && encloses(points, part.center()));
    let covers = |origin: [f32; 2], (width, height): (usize, usize)| {
        Rect::new(origin.map(|c| c - 0.5), [width as f32, height as f32]).meets(&part)
    };
    match &mark.shape {
        Shape::Rect { min, max } => outline(&Rect::between(*min, *max).corners()),
        Shape::Ellipse { center, radii, angle_rad } => outline(&ellipse(*center, *radii, *angle_rad)),
        Shape::Path { points, closed } => crosses(points, *closed, part),
        Shape::Arrows(arrows) => {
            let times = if is_lengthened(mark.role) { look.lengthen } else { 1.0 };
            arrows.iter().any(|arrow| {
                let to = [0, 1].map(|i| arrow.from[i] + times * (arrow.to[i] - arrow.from[i]));
                is_crossed(part, [arrow.from, to])
            })
        }
        Shape::Points(points) => points.iter().any(|point| part.contains(*point)),
        Shape::Text { at, .. } => part.contains(*at),
        Shape::Heat { origin, values } => covers(*origin, values.size()),
        Shape::Flow { origin, values } => covers(*origin, values.size()),
        Shape::Labels(labels) => covers([0.0; 2], labels.size()),
        Shape::Mask(mask) => {
            let (width, height) = mask.size();
            let along = |i: usize, extent: usize| {
                let [first, last] = [part.min[i], part.max[i]].map(|edge| (edge + 0.5).max(0.0));
                first as usize..(last.ceil() as usize).min(extent)
            };
            along(1, height).any(|y| along(0, width).any(|x| mask.get(x, y)))
        }
    }
}

/// Whether a line along `points` runs through `part`.
fn crosses(points: &[Point], closed: bool, part: Rect) -> bool {
    let back = points.last().zip(points.first()).filter(|_| closed).map(|(last, first)| [*last, *first]);
    points.windows(2).map(|pair| [pair[0], pair[1]]).chain(back).any(|ends| is_crossed(part, ends))
}

/// Whether a point of the straight line between two lies in `part`.
fn is_crossed(part: Rect, [from, to]: [Point; 2]) -> bool {
    let shares = [0, 1].map(|i| {
        // Along an axis without way they are infinite: all of the line, or none of it.
        let [first, last] = [part.min[i], part.max[i]].map(|edge| (edge - from[i]) / (to[i] - from[i]));
        [first.min(last), first.max(last)]
    });
    let enters = shares.iter().fold(0.0, |enters: f32, [first, _]| enters.max(*first));
    let leaves = shares.iter().fold(1.0, |leaves: f32, [_, last]| leaves.min(*last));
    enters <= leaves
}

/// Whether a point lies inside the polygon with these corners.
fn encloses(corners: &[Point], [x, y]: Point) -> bool {
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    // Each edge to the right of the point leads in or out.
    let is_right =
        |(a, b): &(&Point, &Point)| (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) * (b[0] - a[0]) / (b[1] - a[1]);
    edges.filter(is_right).count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use motionscope_core::data::Frame;
    use motionscope_core::scene::{Arrow, Role, Scene};

    use super::*;
    use crate::paint::{Figure, Pictures, View};

    const SIZE: (usize, usize) = (320, 240);

    /// What a figure shows of each picture in px, where `section` was chosen by hand.
    fn seen(section: Rect, options: &FigureOptions, scene: &Scene) -> (Figure, Vec<Rect>) {
        let frame = || Arc::new(Frame::gray(Grid::new(SIZE.0, SIZE.1, 90)));
        let options = FigureOptions { view: View::SideBySide, section: Some(section), ..options.clone() };
        let figure = Figure::new(&Pictures::of([frame(), frame()]), scene, &options);
        let parts = figure.panels.iter().map(|(_, place)| part(place).expect("a part is shown")).collect();
        (figure, parts)
    }

    #[test]
    fn a_figure_shows_the_part_that_was_chosen_and_no_more() {
        for size in [[23.0, 21.0], [22.4, 20.3], [40.0, 90.0], [200.0, 31.0], [320.0, 100.0]] {
            let section = Rect::centered([159.5, 120.0], size);
            for titles in [false, true] {
                let options = FigureOptions { titles, ..FigureOptions::default() };
                let (figure, parts) = seen(section, &options, &Scene::default());
                assert_eq!(parts.len(), 2);
                for part in parts {
                    let off = |i: usize| (part.min[i] - section.min[i]).abs().max((part.max[i] - section.max[i]).abs());
                    assert!(off(0).max(off(1)) <= 0.5, "{part:?} in place of {section:?}");
                }
                assert!(figure.size.iter().all(|side| side.fract() == 0.0), "{:?}", figure.size);
                let mut panes = figure.panels.iter().filter_map(|(_, place)| place.seen);
                assert!(panes.all(|pane| pane.size()[0] <= 320.0 && pane.size()[1] <= 240.0), "{section:?}");
            }
        }
    }

    #[test]
    fn what_lies_beyond_the_picture_is_cut_off() {
        let (_, parts) = seen(Rect::centered([0.0, 100.0], [60.0, 40.0]), &FigureOptions::default(), &Scene::default());
        for part in parts {
            assert!((part.min[0] + 0.5).abs() <= 0.5 && (part.max[0] - 30.0).abs() <= 0.5, "{part:?}");
            assert!((part.min[1] - 80.0).abs() <= 0.5 && (part.max[1] - 120.0).abs() <= 0.5, "{part:?}");
        }
    }

    #[test]
    fn the_legend_tells_only_of_what_reaches_into_the_part() {
        let section = Rect::new([100.0, 80.0], [23.0, 21.0]);
        let mut scene = Scene::default();
        scene.mark(Picture::NEXT, Role::Window, Shape::Rect { min: [60.5, 40.5], max: [160.5, 140.5] });
        scene.mark(Picture::NEXT, Role::Candidate, Shape::pixels(130, 90, 16, 16));
        scene.mark(Picture::CURRENT, Role::Reference, Shape::pixels(110, 90, 16, 16));
        let arrow = |x: f32| Arrow { from: [x, 88.0], to: [x + 4.0, 90.0] };
        scene.mark(Picture::CURRENT, Role::Result, Shape::Arrows(vec![arrow(20.0), arrow(98.0)]));
        let filled = Shape::Ellipse { center: [110.0, 90.0], radii: [90.0; 2], angle_rad: 0.0 };
        scene.mark(Picture::CURRENT, Role::Predicted, filled);
        for (role, meaning) in [
            (Role::Window, "search window"),
            (Role::Candidate, "candidate"),
            (Role::Reference, "block"),
            (Role::Result, "displacement"),
            (Role::Predicted, "gate"),
        ] {
            scene.legend(role, meaning);
        }
        let told = |section: Rect| {
            let options = FigureOptions { legend: true, ..FigureOptions::default() };
            let (figure, _) = seen(section, &options, &scene);
            let primitives = figure.layers.iter().flat_map(|layer| &layer.primitives);
            let words = primitives.filter_map(|primitive| match primitive {
                Primitive::Text(line) => Some(line.runs.iter().map(|run| run.text.as_str()).collect::<String>()),
                _ => None,
            });
            words.collect::<Vec<_>>().join("\n")
        };
        let of_part = told(section);
        for (meaning, is_told) in
            [("search window", false), ("candidate", false), ("block", true), ("displacement", true), ("gate", true)]
        {
            assert_eq!(of_part.contains(meaning), is_told, "{meaning} in {of_part}");
        }
        let of_more = told(Rect::new([50.0, 30.0], [120.0, 115.0]));
        assert!(of_more.contains("search window") && of_more.contains("candidate"), "{of_more}");
    }

    #[test]
    fn lines_are_found_where_they_run_through_a_part() {
        let part = Rect::new([10.0, 10.0], [10.0, 10.0]);
        for (ends, is_met) in [
            ([[0.0, 15.0], [30.0, 15.0]], true),
            ([[0.0, 5.0], [30.0, 5.0]], false),
            ([[0.0, 18.0], [18.0, 0.0]], false),
            ([[0.0, 22.0], [22.0, 0.0]], true),
            ([[12.0, 12.0], [12.0, 12.0]], true),
        ] {
            assert_eq!(is_crossed(part, ends), is_met, "{ends:?}");
        }
        let square = Rect::new([0.0; 2], [30.0; 2]).corners();
        assert!(encloses(&square, part.center()) && !crosses(&square, true, part) && !encloses(&square, [40.0, 15.0]));
    }

    #[test]
    fn a_link_is_told_of_where_both_its_ends_are_seen() {
        let (figure, _) = seen(Rect::new([100.0, 80.0], [23.0, 21.0]), &FigureOptions::default(), &Scene::default());
        let from = (Picture::CURRENT, [104.0, 85.0]);
        let link = |to: [f32; 2]| Link { role: Role::Best, ends: [from, (Picture::NEXT, to)] };
        assert!(is_link_seen(&link([110.0, 90.0]), &figure.panels));
        assert!(!is_link_seen(&link([200.0, 90.0]), &figure.panels));
    }
}
