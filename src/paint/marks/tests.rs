//! Marks as they are laid out.

use super::labels::{LABEL_RIM, MOST_LABELS, letters};
use super::*;
use motionscope_core::scene::Picture;

fn field(step: f32, motion: f32) -> Scene {
    let arrows = (0..20).map(|i| {
        let from = [i as f32 * step, 0.0];
        scene::Arrow { from, to: [from[0] + motion, 0.0] }
    });
    let mut scene = Scene::default();
    scene.mark(Picture::CURRENT, Role::Result, Shape::Arrows(arrows.collect()));
    scene
}

#[test]
fn the_number_of_a_region_is_seen_on_its_colour() {
    let color = |is_over_regions: bool| {
        let mut scene = Scene::default();
        if is_over_regions {
            let labels = Shape::Labels(Arc::new(Grid::new(8, 8, 3)));
            scene.mark(Picture::CURRENT, Role::Result, labels);
        }
        scene.mark_of(3, Picture::CURRENT, Role::Result, Shape::Text { at: [2.0, 6.0], text: "3".into() });
        let look = Look::new(&scene, Style::default());
        let all = resolve(&scene.marks, &look, Placement::new([0.0; 2], 8.0));
        let text = all.iter().find_map(|p| if let Primitive::Text(line) = p { Some(line) } else { None });
        text.expect("a number").runs[0].color
    };
    assert_eq!(color(true), Color::WHITE);
    assert_eq!(color(false), own_color(3), "elsewhere it has the colour of its object");
}

#[test]
fn small_motions_are_lengthened_and_large_ones_shortened() {
    let factor = |step, motion| Look::new(&field(step, motion), Style::default()).lengthen;
    assert_eq!(factor(16.0, 1.0), 8.0);
    assert_eq!(factor(16.0, 3.0), 4.0);
    assert_eq!(factor(16.0, 5.0), 2.0);
    assert_eq!(factor(16.0, 15.0), 1.0);
    assert_eq!(factor(16.0, 30.0), 0.5);
    assert_eq!(factor(16.0, 0.0), 1.0);
}

#[test]
fn the_range_of_a_search_decides_whatever_was_found() {
    let factor = |range: i32, motion: f32| {
        let side = (16 + 2 * range) as usize;
        let mut scene = field(16.0, motion);
        scene.mark(Picture::CURRENT, Role::Reference, Shape::pixels(100, 100, 16, 16));
        scene.mark(Picture::NEXT, Role::Window, Shape::pixels(100 - range, 100 - range, side, side));
        Look::new(&scene, Style::default()).lengthen
    };
    assert_eq!([factor(50, 1.0), factor(50, 40.0), factor(7, 1.0), factor(4, 4.0)], [1.0, 1.0, 2.0, 4.0]);
}

#[test]
fn displacements_that_are_too_close_are_thinned_out_evenly() {
    let all = (0..40).flat_map(|y| (0..60).map(move |x| [1.5 + 4.0 * x as f32, 1.5 + 4.0 * y as f32]));
    let arrows: Vec<_> = all.map(|from| scene::Arrow { from, to: [from[0] + 1.0, from[1]] }).collect();
    assert_eq!(apart(&arrows, 1.3, None).len(), 60 * 40);
    // At a third of the size every fourth place is left: 5.3 points apart.
    let kept: Vec<_> = apart(&arrows, 1.0 / 3.0, None).iter().map(|arrow| arrow.from).collect();
    assert!(is_thinned(&arrows, 1.0 / 3.0, None) && !is_thinned(&arrows[..1], 0.01, None));
    assert_eq!(kept.len(), 15 * 10);
    assert!(kept.iter().all(|from| from.iter().all(|c| (c - 1.5) % 16.0 == 0.0)));
}

#[test]
fn a_candidate_is_drawn_over_the_best() {
    let mut scene = Scene::default();
    scene.mark(Picture::NEXT, Role::Candidate, Shape::pixels(4, 8, 16, 16));
    scene.mark(Picture::NEXT, Role::Best, Shape::pixels(4, 8, 16, 16));
    let look = Look::new(&scene, Style::default());
    let primitives = resolve(&scene.marks, &look, Placement::new([0.0; 2], 2.0));
    let Some(Primitive::Polyline { stroke, .. }) = primitives.last() else { panic!("{primitives:?}") };
    assert_eq!(stroke.color, Theme::Dark.ink(Role::Candidate).color);
}

#[test]
fn numbers_of_both_signs_have_zero_in_the_middle() {
    let heat = |values: [f32; 2]| {
        let mut scene = Scene::default();
        let values = Grid::from_fn(2, 1, |x, _| values[x]);
        scene.mark(Picture::CURRENT, Role::Candidate, Shape::Heat { origin: [0.0; 2], values });
        let look = Look::new(&scene, Style::default());
        (look.heat, look.colors)
    };
    assert_eq!(heat([-2.0, 8.0]), (Some([-8.0, 8.0]), ColorMap::Diverging));
    assert_eq!(heat([0.0, 8.0]), (Some([0.0, 8.0]), ColorMap::Viridis));
}

#[test]
fn points_beside_each_other_do_not_merge() {
    let bounds = |gap: f32, zoom: f32| {
        let mut scene = Scene::default();
        scene.mark(Picture::NEXT, Role::Rejected, Shape::Points(vec![[10.0, 10.0], [10.0 + gap, 10.0]]));
        let look = Look::new(&scene, Style::default());
        let all = resolve(&scene.marks, &look, Placement::new([0.0; 2], zoom));
        let ends = all.iter().filter_map(|primitive| match primitive {
            Primitive::Polyline { points, .. } => {
                Some([points[0][0].min(points[1][0]), points[0][0].max(points[1][0])])
            }
            _ => None,
        });
        ends.map(|[from, to]| to - from).fold(0.0, f32::max)
    };
    assert!(bounds(1.0, 6.0) < 6.0, "{} wide at 6 points", bounds(1.0, 6.0));
    assert!(bounds(1.0, 30.0) >= 6.0 && bounds(9.0, 6.0) >= 6.0, "as large as ever where there is room");
}

#[test]
fn heat_hides_no_mark_that_lies_over_it() {
    let mut scene = Scene::default();
    scene.mark(Picture::NEXT, Role::Candidate, Shape::Heat { origin: [0.0; 2], values: Grid::new(9, 9, 3.0) });
    scene.mark(Picture::NEXT, Role::Best, Shape::pixels(4, 8, 16, 16));
    let look = Look::new(&scene, Style::default());
    let primitives = resolve(&scene.marks, &look, Placement::new([0.0; 2], 2.0));
    let heat = primitives.iter().position(|primitive| matches!(primitive, Primitive::Image { .. }));
    assert_eq!((heat, primitives.len()), (Some(0), 3), "the best's rim and line come after");
}

/// A field that moves to the right, but for its first column, of which nothing is known.
fn dense() -> Scene {
    let values = Grid::from_fn(360, 180, |x, _| if x < 10 { [f32::NAN; 2] } else { [2.5, 0.0] });
    let mut scene = Scene::default();
    scene.mark(Picture::CURRENT, Role::Result, Shape::Flow { origin: [0.0; 2], values });
    scene
}

fn drawn(scene: &Scene, arrows: ArrowStyle, place: Placement) -> Vec<scene::Arrow> {
    let look = Look::new(scene, Style { arrows, ..Style::default() });
    match &resolve(&scene.marks, &look, place)[..] {
        [Primitive::Arrows(arrows)] => arrows.ends.to_vec(),
        [] => Vec::new(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_dense_field_has_more_arrows_the_closer_one_looks() {
    let scene = dense();
    let count = |zoom| drawn(&scene, ArrowStyle::default(), Placement::new([0.0; 2], zoom)).len();
    // One every 10 px, 5 px, and 1 px.
    assert_eq!([count(1.0), count(3.0), count(14.0)], [35 * 18, 70 * 36, 350 * 180]);
    assert!(count(0.3) < count(1.0), "they never touch");
    let all = drawn(&scene, ArrowStyle::default(), Placement::new([0.0; 2], 1.0));
    assert!(all.iter().all(|arrow| arrow.from[0] >= 10.0 && arrow.to[0] - arrow.from[0] == 2.5));
}

#[test]
fn a_dense_field_has_the_spacing_that_is_chosen() {
    let scene = dense();
    let spaced = ArrowStyle { spacing_px: Some(20), ..ArrowStyle::default() };
    for zoom in [1.0, 8.0] {
        assert_eq!(drawn(&scene, spaced, Placement::new([0.0; 2], zoom)).len(), 18 * 9);
    }
    for (px, count) in [(1, 350 * 180), (2, 175 * 90), (3, 117 * 60), (4, 88 * 45), (5, 70 * 36)] {
        let spaced = ArrowStyle { spacing_px: Some(px), ..ArrowStyle::default() };
        assert_eq!(drawn(&scene, spaced, Placement::new([0.0; 2], 1.0)).len(), count, "{px} px");
    }
    let far = |px| {
        let spaced = ArrowStyle { spacing_px: Some(px), ..ArrowStyle::default() };
        drawn(&scene, spaced, Placement::new([0.0; 2], 0.25)).len()
    };
    assert!(far(1) == far(4) && far(4) > far(5) && far(5) > far(7), "several to a point of the screen are one");
    let streaks = ArrowStyle { streak_frames: Some(32), ..ArrowStyle::default() };
    assert!(drawn(&scene, streaks, Placement::new([0.0; 2], 1.0)).is_empty(), "streaklines stand in their place");
}

#[test]
fn only_arrows_that_can_be_seen_are_made() {
    let scene = dense();
    let seen = Some(Rect::new([0.0; 2], [200.0, 200.0]));
    let near = drawn(&scene, ArrowStyle::default(), Placement { seen, ..Placement::new([-2800.0, -1400.0], 28.0) });
    assert!((7 * 7..17 * 17).contains(&near.len()), "{}", near.len());
    assert!(near.iter().all(|arrow| (90.0..120.0).contains(&arrow.from[0])));
}

#[test]
fn blocks_are_thinned_to_the_spacing_that_is_chosen() {
    let all = (0..40).flat_map(|y| (0..60).map(move |x| [8.0 * x as f32, 8.0 * y as f32]));
    let arrows: Vec<_> = all.map(|from| scene::Arrow { from, to: [from[0] + 1.0, from[1]] }).collect();
    let kept = |wanted| apart(&arrows, 1.0, Some(wanted)).len();
    assert_eq!([kept(1.0), kept(8.0), kept(17.0), kept(32.0)], [60 * 40, 60 * 40, 30 * 20, 15 * 10]);
    let small: Vec<_> =
        arrows.iter().map(|arrow| scene::Arrow { from: arrow.from.map(|c| c / 8.0), ..*arrow }).collect();
    let kept = [1.0, 2.0, 3.0, 4.0, 5.0].map(|wanted| apart(&small, 1.0, Some(wanted)).len());
    assert_eq!(kept, [60 * 40, 30 * 20, 20 * 14, 15 * 10, 12 * 8]);
}

#[test]
fn only_displacements_are_lengthened() {
    let arrow = scene::Arrow { from: [0.0, 0.0], to: [10.0, 0.0] };
    let mut scene = Scene::default();
    scene.mark(Picture::NEXT, Role::Best, Shape::Arrows(vec![arrow]));
    scene.mark(Picture::NEXT, Role::Result, Shape::Arrows(vec![arrow]));
    let look = Look { lengthen: 2.0, ..Look::new(&scene, Style::default()) };
    let tips: Vec<_> = resolve(&scene.marks, &look, Placement::new([0.0; 2], 3.0))
        .into_iter()
        .flat_map(|primitive| match primitive {
            Primitive::Arrows(arrows) => arrows.iter().map(|arrow| arrow.to[0]).collect::<Vec<_>>(),
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(tips, [31.5, 61.5]);
}

/// The labels that are drawn of those with a role, a place in points and their words.
fn labels(all: &[(Role, [f32; 2], &str)]) -> Vec<String> {
    let mut scene = Scene::default();
    for (role, at, text) in all {
        scene.mark(Picture::CURRENT, *role, Shape::Text { at: *at, text: (*text).into() });
    }
    let look = Look::new(&scene, Style::default());
    let words = |one: Primitive| match one {
        Primitive::Text(line) => line.runs.into_iter().map(|run| run.text).collect::<String>(),
        other => panic!("{other:?}"),
    };
    resolve(&scene.marks, &look, Placement::new([0.0; 2], 1.0)).into_iter().map(words).collect()
}

#[test]
fn labels_of_measurements_give_way_to_others() {
    let size = Theme::Dark.sizes().small + LABEL_RIM;
    let (near, far) = ([10.0, 10.0], [10.0, 90.0]);
    let measured = |at, text| (Role::Measured, at, text);
    assert_eq!(labels(&[measured(near, "a"), measured(far, "b")]), ["a", "b"], "both have room");
    assert_eq!(labels(&[measured(near, "a"), measured(near, "b")]), ["a"], "the first stays");
    // Tracks keep their labels, also where two lie over each other and where they come later.
    let under = [near[0], near[1] + size];
    let tracks = [measured(near, "a"), (Role::Result, under, "1"), (Role::Result, under, "2")];
    assert_eq!(labels(&tracks), ["1", "2"]);
    let many: Vec<_> = (0..MOST_LABELS + 20).map(|i| measured([0.0, 40.0 * i as f32], "a")).collect();
    assert_eq!(labels(&many).len(), MOST_LABELS, "more cannot be read");
}

/// The labels of boxes of 40×20 px at `boxes`, in a picture of 200×100 px, with the rectangles of their letters.
fn boxed(boxes: &[(Role, [f32; 2], &str)]) -> Vec<(String, Rect)> {
    let mut scene = Scene::default();
    for (role, min, text) in boxes {
        let max = [min[0] + 40.0, min[1] + 20.0];
        // The name of a measurement belongs below its box, drawn before or after it.
        let at = if *role == Role::Measured { [min[0], max[1]] } else { *min };
        scene.mark(Picture::CURRENT, *role, Shape::Text { at, text: (*text).into() });
        scene.mark(Picture::CURRENT, *role, Shape::Rect { min: *min, max });
    }
    let look = Look::new(&scene, Style::default());
    let place = Placement { room: Some(Rect::new([0.0; 2], [200.0, 100.0])), ..Placement::new([0.0; 2], 1.0) };
    let all = resolve(&scene.marks, &look, place);
    let first = all.iter().position(|one| matches!(one, Primitive::Text(_))).expect("labels");
    assert!(all[first..].iter().all(|one| matches!(one, Primitive::Text(_))), "no line lies over a label");
    let label = |one: &Primitive| match one {
        Primitive::Text(line) => (line.runs.iter().map(|run| run.text.clone()).collect(), letters(line, line.at)),
        other => panic!("{other:?}"),
    };
    all[first..].iter().map(label).collect()
}

#[test]
fn labels_of_boxes_keep_clear_of_the_edge_of_each_other_and_of_their_box() {
    let room = Rect::new([0.0; 2], [200.0, 100.0]);
    for at in [[80.0, 40.0], [2.0, 1.0], [170.0, 1.0], [155.0, 78.0], [2.0, 78.0]] {
        let beside = [at[0] + 3.0, at[1] + 2.0];
        let all = boxed(&[(Role::Measured, beside, "d 1"), (Role::Estimate, at, "12"), (Role::Measured, at, "d 2")]);
        assert_eq!(all.len(), 3, "{at:?}: {all:?}");
        for (i, (text, rect)) in all.iter().enumerate() {
            let is_inside = (0..2).all(|i| room.min[i] <= rect.min[i] + 1e-3 && rect.max[i] <= room.max[i] + 1e-3);
            assert!(is_inside, "{text} at {at:?}: {rect:?}");
            assert!(all[..i].iter().all(|(_, other)| !other.meets(rect)), "{at:?}: {all:?}");
        }
    }
    let [(_, above), (_, below)] =
        &boxed(&[(Role::Estimate, [80.0, 40.0], "12"), (Role::Measured, [80.0, 40.0], "d")])[..]
    else {
        panic!("two labels")
    };
    assert!(above.max[1] <= 40.0 && below.min[1] >= 60.0, "{above:?}, {below:?}");
}

#[test]
fn a_frame_lies_outside_the_pixels_that_it_frames() {
    let mut scene = Scene::default();
    scene.mark(Picture::CURRENT, Role::Reference, Shape::pixels(4, 8, 16, 16));
    let look = Look::new(&scene, Style::default());
    let primitives = resolve(&scene.marks, &look, Placement::new([100.0, 0.0], 2.0));
    let Some(Primitive::Polyline { points, stroke, closed: true }) = primitives.last() else {
        panic!("{primitives:?}")
    };
    assert_eq!(stroke.width, 2.0);
    assert_eq!((points[0], points[2]), ([107.0, 15.0], [141.0, 49.0]));
}

#[test]
fn what_is_not_finite_is_not_drawn() {
    let mut scene = Scene::default();
    scene.mark(Picture::CURRENT, Role::Truth, Shape::Points(vec![[f32::NAN, 1.0]]));
    scene.mark(Picture::CURRENT, Role::Truth, Shape::Heat { origin: [0.0; 2], values: Grid::new(2, 2, f32::NAN) });
    let look = Look::new(
        &scene,
        Style {
            arrows: ArrowStyle { lengthen: Lengthen::Times(f32::NAN), ..ArrowStyle::default() },
            ..Style::default()
        },
    );
    assert_eq!((look.heat, look.lengthen), (None, 1.0));
    assert!(resolve(&scene.marks, &look, Placement::new([0.0; 2], 1.0)).is_empty());
}

#[test]
fn a_coasting_track_is_dashed_in_its_box_and_its_trail() {
    for theme in Theme::ALL {
        let mut scene = Scene::default();
        scene.mark_of(3, Picture::CURRENT, Role::Predicted, Shape::pixels(4, 4, 9, 9));
        let points = vec![[0.0, 0.0], [4.0, 4.0], [9.0, 8.0]];
        scene.mark_of(3, Picture::CURRENT, Role::Predicted, Shape::Path { points, closed: false });
        let look = Look::new(&scene, Style { theme, ..Style::default() });
        let all = resolve(&scene.marks, &look, Placement::new([0.0; 2], 3.0));
        let lines =
            all.iter().filter_map(|p| if let Primitive::Polyline { stroke, .. } = p { Some(stroke) } else { None });
        let own: Vec<_> = lines.filter(|stroke| stroke.color == own_color(3)).collect();
        assert!(own.len() == 2 && own.iter().all(|stroke| !stroke.dash.is_empty()), "{theme:?}: {own:?}");
    }
}
