//! Series as they are laid out.

use super::super::super::ColorMap;
use super::super::{flat, texts};
use super::*;

fn series(points: usize) -> Series {
    let tested = (1..=points).map(|i| [i as f32, 500.0 + (i * 37 % 400) as f32]).collect();
    let best = vec![[1.0, 537.0], [3.0, 511.0]];
    let lines = vec![("candidate", Role::Candidate, tested), ("best so far", Role::Best, best)];
    Series {
        title: "Cost by candidate",
        x_label: "candidate",
        y_label: "SAD",
        x_max: 1089,
        events: (1..=points).collect(),
        lines,
        ..Series::default()
    }
}

fn plotted(series: &Series, logarithmic: bool) -> Plotted<'_> {
    Plotted { series, whose: "Full search", logarithmic, window: None }
}

fn plot(series: &Series) -> Plot {
    Plot::new(plotted(series, false), Rect::new([0.0; 2], [400.0, 200.0]), Theme::Dark)
}

#[test]
fn what_is_numbered_has_ticks_at_its_numbers() {
    let numbered = Series { x_max: 16, x_ticks: vec![1.0, 5.0, 9.0, 13.0], is_sweep: true, ..series(3) };
    let drawing = draw(plotted(&numbered, false), Rect::new([0.0; 2], [500.0, 240.0]), style());
    let words = texts(&flat(drawing));
    assert!(["1", "5", "9", "13"].iter().all(|tick| words.iter().any(|word| word == tick)), "{words:?}");
    assert!(!words.iter().any(|word| word == "10"), "{words:?}");
}

fn style() -> ChartStyle {
    ChartStyle { theme: Theme::Dark, colors: ColorMap::Viridis, density: 1.0 }
}

#[test]
fn a_line_passes_through_its_data() {
    let series = series(10);
    let drawing = draw(plotted(&series, false), Rect::new([0.0; 2], [400.0, 200.0]), style());
    let plot = drawing.place.clone();
    let primitives = flat(drawing);
    let mut lines = primitives.iter().filter_map(|primitive| match primitive {
        Primitive::Polyline { points, .. } => Some(points),
        _ => None,
    });
    let places: Vec<_> = series.lines[0].2.iter().map(|&point| plot.at(point)).collect();
    assert!(lines.any(|points| *points == places), "the candidates' costs are one line");
    let words = texts(&primitives);
    for label in ["Full search · Cost by candidate, SAD", "candidate", "best so far 511", "0", "10", "1000"] {
        assert!(words.iter().any(|word| word == label), "{label} is missing in {words:?}");
    }
}

#[test]
fn a_unit_that_repeats_the_title_is_left_out() {
    let mut series = series(3);
    (series.title, series.y_label) = ("Objects", "objects");
    let wide = Rect::new([0.0; 2], [600.0, 200.0]);
    let description = title(Plotted { whose: "Blob tracker", ..plotted(&series, false) }, wide, 12.0);
    assert_eq!(description, "Blob tracker · Objects");
}

#[test]
fn the_values_of_a_step_stand_beside_the_names() {
    let series = series(10);
    let area = Rect::new([0.0; 2], [400.0, 200.0]);
    let drawing = draw(plotted(&series, false), area, style());
    let words = texts(&head(plotted(&series, false), &drawing.place, area, Some(3.2), style()));
    assert!(words.contains(&"candidate 3".into()) && words.contains(&"best so far 511".into()), "{words:?}");
}

#[test]
fn the_axes_hold_every_value_and_do_not_jump() {
    let (few, many) = (series(10), series(1089));
    let (a, b) = (plot(&few), plot(&many));
    assert_eq!(a.x, b.x);
    assert_eq!(a.y.values, b.y.values, "the top is a round number");
    for [_, y] in &many.lines[0].2 {
        assert!((b.rect.min[1]..=b.rect.max[1]).contains(&b.y.place(*y)));
    }
}

#[test]
fn without_values_a_plot_says_so_and_stays_finite() {
    let none = vec![("NIS", Role::Measured, vec![[1.0, f32::NAN], [2.0, f32::NAN]])];
    for lines in [none, vec![("NIS", Role::Measured, vec![])], vec![]] {
        for fits_values in [false, true] {
            let series = Series { lines: lines.clone(), fits_values, ..series(1) };
            assert!(!has_values(&series));
            let drawing = draw(plotted(&series, true), Rect::new([0.0; 2], [400.0, 240.0]), style());
            assert!(drawing.place.y.values.iter().all(|end| end.is_finite()), "{:?}", drawing.place.y);
            let words = texts(&flat(drawing));
            assert!(words.iter().any(|word| word == "No value yet: step on."), "{words:?}");
        }
    }
    assert!(has_values(&series(1)));
}

#[test]
fn long_numbers_of_the_axis_are_not_cut_off() {
    let high = vec![("energy", Role::Result, vec![[1.0, 123_456_789.0], [2.0, 3.0]])];
    let series = Series { lines: high, ..series(1) };
    let drawing = draw(plotted(&series, false), Rect::new([0.0; 2], [400.0, 240.0]), style());
    let left = drawing.place.rect.min[0];
    let primitives = flat(drawing);
    let lines = primitives.iter().filter_map(|p| if let Primitive::Text(line) = p { Some(line) } else { None });
    let numbers = lines.filter(|line| line.anchor == Anchor::End && line.at[0] < left);
    assert!(numbers.map(|line| line.at[0] - line.width()).all(|start| start >= 0.0));
    assert!(left > 4.6 * Theme::Dark.sizes().small);
}

#[test]
fn a_logarithmic_axis_goes_by_powers_of_ten() {
    let mut series = series(3);
    series.lines[0].2 = vec![[4.0, 13.0], [8.0, 81.0], [16.0, 4225.0]];
    let area = Rect::new([0.0; 2], [400.0, 200.0]);
    let plot = Plot::new(plotted(&series, true), area, Theme::Dark);
    assert_eq!(plot.ticks().iter().map(|tick| tick.0.round()).collect::<Vec<_>>(), [10.0, 100.0, 1000.0, 10000.0]);
    let up = |y| plot.at([4.0, y])[1];
    assert!((up(10.0) - up(100.0) - (up(100.0) - up(1000.0))).abs() < 1e-3 && up(10.0) > up(100.0));
    series.lines[0].2.push([32.0, 0.0]);
    assert!(!Plot::new(plotted(&series, true), area, Theme::Dark).logarithmic, "nothing has no logarithm");
}

#[test]
fn stretches_are_named_where_there_is_room() {
    let (whole, part) = (false, true);
    let places = [(0.0, whole), (30.0, part), (60.0, part), (100.0, whole), (120.0, part), (170.0, part)];
    assert_eq!(named(&places, &[40.0, 20.0, 20.0, 40.0, 20.0, 20.0], 190.0), [true, false, true, true, false, false]);
    assert_eq!(named(&places, &[200.0, 20.0, 20.0, 10.0, 20.0, 20.0], 250.0), [false, true, true, true, true, true]);
}

#[test]
fn a_best_value_holds_until_it_is_beaten() {
    assert_eq!(steps(&[[1.0, 9.0], [4.0, 5.0]]), [[1.0, 9.0], [4.0, 9.0], [4.0, 5.0]]);
    let series = series(10);
    let (_, _, best) = &series.lines[1];
    assert_eq!([0.0, 1.0, 2.0, 9.0].map(|x| value(Role::Best, best, x)), [None, Some(537.0), Some(537.0), Some(511.0)]);
    assert_eq!(value(Role::Candidate, &series.lines[0].2, 2.5), None);
}

#[test]
fn rejected_values_of_another_line_are_marked() {
    let mut series = series(10);
    let some = vec![series.lines[0].2[3], series.lines[0].2[7]];
    assert!(are_marks(&series, Role::Rejected, &some) && !are_marks(&series, Role::Error, &some));
    let apart = [some[0], [some[1][0], some[1][1] + 1.0]];
    assert!(!are_marks(&series, Role::Rejected, &apart), "a line that meets another");
    series.lines[0].2.clear();
    assert!(!are_marks(&series, Role::Rejected, &some), "a line of its own");
}

#[test]
fn many_points_are_thinned_without_losing_the_extremes() {
    let series = series(1089);
    let points = &series.lines[0].2;
    let kept = thinned(points, &plot(&series));
    assert!(kept.len() < points.len());
    let low = |points: &[[f32; 2]]| points.iter().map(|p| p[1]).fold(f32::MAX, f32::min);
    assert_eq!(low(&kept), low(points));
    assert_eq!(kept.last(), points.last());
}

/// As a filter tells whether it is consistent.
fn consistency() -> Series {
    let values: Vec<_> = (1..=20).map(|i| [i as f32, if i == 7 { 80.0 } else { 1.0 + (i % 5) as f32 }]).collect();
    let refused = vec![values[6]];
    Series {
        title: "NIS",
        x_label: "frame",
        y_label: "squared Mahalanobis distance",
        x_max: 40,
        lines: vec![("NIS", Role::Measured, values), ("outside the gate", Role::Rejected, refused)],
        bands: vec![Band { name: "95 % band".into(), values: [0.0506, 7.378], at: None }],
        thresholds: vec![("99 % gate".into(), 9.21)],
        ..Series::default()
    }
}

#[test]
fn a_band_is_drawn_and_named_with_its_ends() {
    let series = consistency();
    let drawing = draw(plotted(&series, false), Rect::new([0.0; 2], [700.0, 300.0]), style());
    let plot = drawing.place.clone();
    let primitives = flat(drawing);
    let is_band = |points: &Vec<Point>| {
        let ys = [0.0506, 7.378].map(|y| plot.at([0.0, y])[1]);
        ys.iter().all(|y| points.iter().any(|point| (point[1] - y).abs() < 0.01))
    };
    let color = band_color(Theme::Dark);
    let found = primitives
        .iter()
        .any(|p| matches!(p, Primitive::Polygon { points, color: filled } if *filled == color && is_band(points)));
    assert!(found, "the band lies between its ends");
    let words = texts(&primitives);
    for wanted in ["95 % band 0.05 to 7.38", "99 % gate 9.21", "NIS 1", "20"] {
        assert!(words.iter().any(|word| word == wanted), "{wanted} is missing in {words:?}");
    }
    assert!(summary(&series).ends_with("95 % band 0.05 to 7.38, 99 % gate 9.21"), "{}", summary(&series));
}

#[test]
fn a_band_of_one_step_is_drawn_there_alone() {
    let mut series = consistency();
    series.bands[0].at = Some(12.0);
    let drawing = draw(plotted(&series, false), Rect::new([0.0; 2], [700.0, 300.0]), style());
    let plot = drawing.place.clone();
    let color = band_color(Theme::Dark);
    let bands: Vec<_> = flat(drawing)
        .into_iter()
        .filter_map(|p| match p {
            Primitive::Polygon { points, color: filled } if filled == color && points.len() == 4 => Some(points),
            _ => None,
        })
        .filter(|points| points.iter().any(|point| point[0] > plot.rect.min[0] && point[1] > plot.rect.min[1]))
        .collect();
    let [band] = &bands[..] else { panic!("{bands:?}") };
    let near = plot.x.place(12.0) - plot.x.place(11.0);
    assert!(band.iter().all(|point| (point[0] - plot.x.place(12.0)).abs() <= near.max(LEAST_HALF)), "{band:?}");
}

#[test]
fn a_value_beyond_the_edge_is_an_arrow_there() {
    let series = consistency();
    let drawing = draw(plotted(&series, false), Rect::new([0.0; 2], [700.0, 300.0]), style());
    let plot = drawing.place.clone();
    assert!(plot.y.values[1] < 80.0, "what was rejected does not set the scale");
    let tips = |primitives: &[Primitive]| -> Vec<Point> {
        let tip = |p: &Primitive| match p {
            Primitive::Polygon { points, .. } if points.len() == 3 => Some(points[0]),
            _ => None,
        };
        primitives.iter().filter_map(tip).collect()
    };
    // One more explains it in the legend.
    let found: Vec<Point> = tips(&flat(drawing)).into_iter().filter(|tip| tip[1] >= plot.rect.min[1]).collect();
    assert!(!found.is_empty() && found.iter().all(|tip| *tip == [plot.x.place(7.0), plot.rect.min[1]]), "{found:?}");
    // One that is near enough shows it.
    let near = Plotted { window: Some(Window { x: [5.0, 9.0], y: [60.0, 90.0] }), ..plotted(&series, false) };
    let drawing = draw(near, Rect::new([0.0; 2], [700.0, 300.0]), style());
    let [top, bottom] = [drawing.place.rect.min[1], drawing.place.rect.max[1]];
    let arrows = tips(&flat(drawing)).into_iter().filter(|tip| tip[1] >= top);
    assert!(arrows.into_iter().all(|tip| tip[1] == bottom), "now the others lie below");
    let head = texts(&head(plotted(&series, false), &plot, Rect::new([0.0; 2], [700.0, 300.0]), Some(7.1), style()));
    assert!(head.contains(&"frame 7".into()) && head.contains(&"outside the gate 80".into()), "{head:?}");
}

#[test]
fn ten_lines_of_type_are_enough() {
    let (series, small) = (consistency(), style().small());
    for width in [280.0, 420.0, 800.0] {
        let area = Rect::new([0.0; 2], [width, 10.0 * 1.35 * small]);
        let drawing = draw(plotted(&series, false), area, style());
        let plot = drawing.place.clone();
        assert!(plot.rect.size()[1] >= 0.45 * area.size()[1], "{width}: {:?}", plot.rect);
        assert!(plot.ticks().len() >= 2);
        for primitive in flat(drawing) {
            if let Primitive::Text(line) = &primitive {
                let rect = super::super::canvas::covered(line);
                let is_out = rect.max[1] < plot.rect.min[1] + 2.0 || rect.min[1] > plot.rect.max[1] - 2.0;
                assert!(is_out || rect.max[0] <= plot.rect.min[0], "{line:?} covers the lines");
                assert!(rect.max[0] <= width + 1.0 && rect.min[1] >= -2.0, "{line:?} is cut off");
            }
        }
    }
}

#[test]
fn coming_nearer_keeps_what_is_under_the_pointer_and_stays_inside() {
    let whole = Window { x: [0.0, 40.0], y: [0.0, 10.0] };
    let near = whole.nearer([10.0, 5.0], 4.0, whole);
    assert_eq!(near, Window { x: [7.5, 17.5], y: [3.75, 6.25] });
    assert_eq!(near.nearer([10.0, 5.0], 0.01, whole), whole);
    assert_eq!(near.moved([-100.0, 100.0], whole), Window { x: [0.0, 10.0], y: [7.5, 10.0] });
    let nearest = whole.nearer([10.0, 5.0], 1e9, whole);
    assert!((nearest.x[1] - nearest.x[0] - 40.0 / NEAREST).abs() < 1e-4);
}

#[test]
fn a_stretch_far_from_the_first_step_begins_where_its_data_do() {
    let mut series = consistency();
    assert_eq!(plot(&series).whole.x, [0.0, 40.0]);
    series.lines.iter_mut().flat_map(|line| &mut line.2).for_each(|point| point[0] += 500.0);
    series.x_max = 540;
    assert_eq!(plot(&series).whole.x, [501.0, 540.0]);
}

/// The texts inside the axes, with what they cover.
fn inside(drawing: Drawing<Plot>) -> Vec<(String, Rect)> {
    let plot = drawing.place.rect;
    let words = flat(drawing).into_iter().filter_map(|p| if let Primitive::Text(line) = p { Some(line) } else { None });
    let told = words.map(|line| (line.runs[0].text.clone(), super::super::canvas::covered(&line)));
    told.filter(|(_, rect)| plot.contains(rect.center())).collect()
}

#[test]
fn few_lines_carry_their_names_where_there_is_room() {
    let few = series(10);
    let named =
        |series: &Series, area: [f32; 2]| inside(draw(plotted(series, false), Rect::new([0.0; 2], area), style()));
    let found = named(&few, [500.0, 300.0]);
    let names: Vec<_> = found.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["candidate 870", "best so far 511"]);
    assert!(!found[0].1.meets(&found[1].1), "{found:?}");
    assert!(named(&few, [200.0, 300.0]).is_empty() && named(&few, [500.0, 160.0]).is_empty(), "too small");
    let line = || few.lines[0].clone();
    let many = Series { lines: (0..5).map(|_| line()).collect(), ..series(10) };
    assert!(named(&many, [500.0, 300.0]).is_empty(), "five lines keep their legend");
}

#[test]
fn a_name_at_a_line_is_not_in_the_legend_as_well() {
    let series = consistency();
    let area = Rect::new([0.0; 2], [700.0, 300.0]);
    let drawing = draw(plotted(&series, false), area, style());
    let (plot, head_words) = (drawing.place.clone(), texts(&drawing.head));
    let names = inside(drawing);
    assert!(["NIS 1", "99 % gate 9.21"].iter().all(|name| names.iter().any(|(found, _)| found == name)), "{names:?}");
    assert!(
        head_words.iter().any(|word| word == "outside the gate")
            && !head_words.iter().any(|word| word.starts_with("99"))
    );
    let gate = plot.at([0.0, 9.21])[1];
    let (_, rect) = names.iter().find(|(name, _)| name.starts_with("99")).expect("it is named");
    assert!(rect.max[1] - 3.0 <= gate || rect.min[1] + 3.0 >= gate, "{rect:?} on {gate}");
}
