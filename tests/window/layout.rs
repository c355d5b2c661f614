//! The laid-out window of every estimator, in every theme, at every scale: most of it is stage and chart, nothing lies over
//! anything else, and no word is cut off.

use eframe::egui::Shape;
use eframe::egui::epaint::{ClippedShape, TextShape};
use motionscope::session::lesson::{self, Address};
use motionscope_core::course::estimators;

use super::*;
use objects::window;

/// The estimators are shared out among so many tests, which run beside each other.
const PARTS: usize = 4;
/// Sizes of windows, in pixels.
const SIZES: [[f32; 2]; 5] = [[844.0, 390.0], [1024.0, 768.0], [1280.0, 720.0], [1920.0, 1080.0], [2560.0, 1440.0]];
/// A phone held upright, in points.
const PHONE: [f32; 2] = [390.0, 844.0];
/// Pixels, and pixels per point, of the windows that leave the least room and the most, and of a projector.
const CORNERS: [([f32; 2], f32); 5] =
    [(SIZES[0], 1.0), (SIZES[1], 1.0), (SIZES[2], 1.0), (SIZES[2], 2.0), (SIZES[4], 1.0)];
/// Pixels per point, for those of which half a window is a usual one.
const SCALES: [f32; 3] = [1.0, 1.5, 2.0];
/// How far the copies of a word in its halo lie from each other, at most.
const HALO_PT: f32 = 8.0;
/// Two words that share no more than this share of the smaller one's area only touch.
const TOUCH: f32 = 0.12;

/// A word as it is painted, and the part of the window that it may be painted in.
#[derive(Clone, Debug)]
pub struct Word {
    pub text: String,
    pub rect: Rect,
    pub clip: Rect,
}

fn texts(shape: &Shape, clip: Rect, all: &mut Vec<Word>) {
    match shape {
        Shape::Vec(shapes) => shapes.iter().for_each(|shape| texts(shape, clip, all)),
        Shape::Text(text) => {
            let words = text.galley.job.text.trim();
            let rect = text.visual_bounding_rect();
            if !words.is_empty() && rect.is_positive() && is_seen(text) {
                all.push(Word { text: words.to_owned(), rect, clip });
            }
        }
        _ => {}
    }
}

fn is_seen(text: &TextShape) -> bool {
    text.opacity_factor > 0.05 && text.angle == 0.0
}

/// Every word in sight.
pub fn words(shapes: &[ClippedShape]) -> Vec<Word> {
    let mut all = Vec::new();
    shapes.iter().for_each(|clipped| texts(&clipped.shape, clipped.clip_rect, &mut all));
    all.retain(|word| word.clip.intersect(word.rect).is_positive());
    // A halo is the same word, painted around it.
    let mut once: Vec<Word> = Vec::new();
    for word in all {
        let is_halo =
            |other: &Word| other.text == word.text && (other.rect.center() - word.rect.center()).length() < HALO_PT;
        if !once.iter().any(is_halo) {
            once.push(word);
        }
    }
    once
}

fn rects(window: &Window, of: Region) -> Vec<Rect> {
    window.app().regions().iter().filter(|(region, _)| *region == of).map(|(_, rect)| *rect).collect()
}

fn area(window: &Window, of: Region) -> f32 {
    rects(window, of).iter().map(|rect| rect.area()).sum()
}

/// What is wrong with the window as it is.
fn faults(window: &Window) -> Vec<String> {
    let mut faults = Vec::new();
    let screen = window.harness.ctx.content_rect();
    let type_pt = window.app().settings().look.theme.sizes().body;
    let panes: Vec<(Region, Rect)> =
        window.app().regions().iter().filter(|(region, _)| *region != Region::Pictures).copied().collect();
    for (i, (region, rect)) in panes.iter().enumerate() {
        if !screen.expand(1.0).contains_rect(*rect) {
            faults.push(format!("{region:?} leaves the window: {rect:?}"));
        }
        let least = match region {
            Region::Stage => [12.0, 8.0],
            Region::Chart => [15.0, 8.0],
            Region::Explanation => [16.0, 8.0],
            Region::Strip => [16.0, 2.9],
            _ => [0.0; 2],
        };
        if rect.width() < least[0] * type_pt || rect.height() < least[1] * type_pt {
            faults.push(format!("{region:?} is too small for anything: {:?}", rect.size()));
        }
        for (other, there) in &panes[..i] {
            if rect.shrink(1.0).intersects(there.shrink(1.0)) {
                faults.push(format!("{region:?} and {other:?} lie over each other"));
            }
        }
    }
    let pictures = rects(window, Region::Pictures);
    // What is longer than its pane is scrolled there.
    let scrolled = [Region::Explanation, Region::Strip, Region::Parameters].map(|of| rects(window, of)).concat();
    let all = words(&window.harness.output().shapes);
    // Without header and transport a step may tell a sentence and nothing else.
    if all.len() < if window.has(Region::Header) { 10 } else { 5 } {
        faults.push(format!("only {} words are in sight", all.len()));
    }
    for (i, Word { text, rect, clip }) in all.iter().enumerate() {
        let is_in = |pane: &Rect| pane.expand(2.0).contains(clip.center()) && pane.intersects(*rect);
        let (min, max) = (clip.min - Vec2::splat(1.5), clip.max + Vec2::splat(1.5));
        let is_wide = rect.min.x < min.x || rect.max.x > max.x;
        // The numbers of pixels and matrices are scrolled where not all of them have room.
        let is_pixel = text.chars().all(|c| c.is_ascii_digit() || ".−∞".contains(c));
        let is_high = (rect.min.y < min.y || rect.max.y > max.y) && !is_pixel && !scrolled.iter().any(is_in);
        // The labels of marks are cut where their picture ends.
        let is_mark = pictures.iter().any(|pane| pane.expand(2.0).contains_rect(clip.intersect(*rect)));
        if (is_wide || is_high) && !is_mark && !is_pixel {
            faults.push(format!("“{text}” is cut off: {rect:?} in {clip:?}"));
        }
        for other in all[..i].iter().filter(|_| !is_mark) {
            let shared = rect.intersect(*clip).intersect(other.rect.intersect(other.clip));
            if shared.size().min_elem() > 2.5 && shared.area() > TOUCH * rect.area().min(other.rect.area()) {
                faults.push(format!("“{text}” lies over “{}”: {rect:?}, {:?}", other.text, other.rect));
            }
        }
    }
    faults
}

/// Least share of the window's area that the pictures have, and of its height.
fn least_shares(window: &Window) -> [f32; 2] {
    match () {
        // Three in a row cannot have more of a window that is no wider.
        () if window.has(Region::Lesson) && window.shown().tiles.len() > 2 => [0.30, f32::INFINITY],
        () if window.has(Region::Lesson) => [0.40, f32::INFINITY],
        () if !window.has(Region::Header) => [0.55, 0.70],
        () => [0.45, 0.60],
    }
}

/// What is too small of the window as it is.
fn small(window: &Window) -> Option<String> {
    let screen = window.harness.ctx.content_rect();
    let pictures = rects(window, Region::Pictures);
    let largest = pictures.iter().map(|rect| rect.area()).fold(0.0, f32::max);
    // Pictures of one size that stand below each other are looked at together.
    let alike = pictures.iter().filter(|rect| rect.area() > 0.9 * largest);
    let height = alike.copied().reduce(Rect::union).map_or(0.0, |rect| rect.height()) / screen.height();
    let share = pictures.iter().map(|rect| rect.area()).sum::<f32>() / screen.area();
    let [least_share, least_height] = least_shares(window);
    if rects(window, Region::Explanation).len() + rects(window, Region::Strip).len() == 0 {
        return Some("nothing is told of the step".into());
    }
    (share < least_share && height < least_height).then(|| {
        format!("the pictures have {:.1} % of the window and {:.1} % of its height", 100.0 * share, 100.0 * height)
    })
}

/// Says if the pictures or the words are too narrow in an upright window.
fn narrow(window: &Window) -> Option<String> {
    let width = window.harness.ctx.content_rect().width();
    let widest = |of: Region| rects(window, of).iter().map(|rect| rect.width()).fold(0.0, f32::max);
    let told = widest(Region::Strip).max(widest(Region::Explanation));
    // A smaller picture may stand beside the words.
    let is_narrow = widest(Region::Pictures) < 0.6 * width || told < 0.5 * width;
    is_narrow.then(|| format!("the pictures have {} points of its width, the words {told}", widest(Region::Pictures)))
}

pub fn close_messages(window: &mut Window) {
    let count = window.harness.query_all_by_label("Close message").count();
    for _ in 0..count {
        window.harness.query_all_by_label("Close message").next().into_iter().for_each(|close| close.click());
        window.settle();
    }
}

fn resize(window: &mut Window, pixels: [f32; 2], scale: f32) {
    // The system's own scale, not that of the interface.
    let input = window.harness.input_mut();
    input.viewports.entry(input.viewport_id).or_default().native_pixels_per_point = Some(scale);
    window.size = Vec2::from(pixels) / scale;
    for _ in 0..4 {
        window.step();
    }
}

/// The windows in which a theme is looked at: pixels, and pixels per point. All of them in the night, when `EVERY_LAYOUT` is set.
fn windows(theme: Theme) -> Vec<([f32; 2], f32)> {
    // The light theme differs from the dark one in nothing but its colours.
    let is_plain = theme == Theme::Light;
    if std::env::var_os("EVERY_LAYOUT").is_none() {
        return if is_plain { Vec::new() } else { CORNERS.to_vec() };
    }
    let is_usual = |pixels: [f32; 2]| [1280.0, 1920.0].contains(&pixels[0]);
    let all = SIZES.into_iter().flat_map(|pixels| SCALES.map(|scale| (pixels, scale)));
    all.filter(|(pixels, scale)| *scale == 1.0 || !is_plain && is_usual(*pixels)).collect()
}

/// Looks at an estimator in the middle of a run and at its end, in every window.
fn look_at(id: &str, faults_of: &mut Vec<String>) {
    for step in ["1.4", "end"] {
        let mut window = window(id, "0.0");
        window.key(Key::PageDown);
        if step == "end" {
            window.key(Key::End);
        } else {
            for _ in 0..3 {
                window.key(Key::ArrowRight);
            }
        }
        window.harness.remove_cursor();
        for theme in Theme::ALL.into_iter().filter(|theme| !windows(*theme).is_empty()) {
            window.command(match theme {
                Theme::Dark => Command::DarkTheme,
                Theme::Light => Command::LightTheme,
                Theme::Projector => Command::ProjectorTheme,
            });
            for (pixels, scale) in windows(theme) {
                resize(&mut window, pixels, scale);
                let at = format!("{id} at {step}, {theme:?}, {}×{} at {scale}×", pixels[0], pixels[1]);
                faults_of.extend(faults(&window).into_iter().map(|fault| format!("{at}: {fault}")));
                let small = small(&window).filter(|_| scale == 1.0);
                faults_of.extend(small.map(|fault| format!("{at}: {fault}")));
            }
        }
        window.command(Command::DarkTheme);
        resize(&mut window, PHONE, 1.0);
        let at = format!("{id} at {step}, on a phone");
        faults_of.extend(faults(&window).into_iter().chain(narrow(&window)).map(|fault| format!("{at}: {fault}")));
        window.command(Command::Present);
        close_messages(&mut window);
        for pixels in SIZES {
            resize(&mut window, pixels, 1.0);
            let at = format!("{id} at {step}, presented in {}×{}", pixels[0], pixels[1]);
            faults_of.extend(faults(&window).into_iter().chain(small(&window)).map(|fault| format!("{at}: {fault}")));
        }
    }
}

fn look_at_part(part: usize) {
    let mut faults = Vec::new();
    for estimator in estimators().iter().skip(part).step_by(PARTS) {
        look_at(estimator.info().id, &mut faults);
    }
    let shown: Vec<_> = faults.iter().take(40).cloned().collect();
    assert!(faults.is_empty(), "{} faults, the first of which are\n{}", faults.len(), shown.join("\n"));
}

#[test]
fn windows_of_the_first_quarter_of_estimators_have_room() {
    look_at_part(0);
}

#[test]
fn windows_of_the_second_quarter_of_estimators_have_room() {
    look_at_part(1);
}

#[test]
fn windows_of_the_third_quarter_of_estimators_have_room() {
    look_at_part(2);
}

#[test]
fn windows_of_the_last_quarter_of_estimators_have_room() {
    look_at_part(3);
}

#[test]
fn beside_every_page_of_a_lesson_the_pictures_have_most_of_the_window() {
    let mut faults_of = Vec::new();
    let mut pages = 0;
    for lesson in lesson::all() {
        let open = Some(Address::from(lesson).name());
        let mut window = Window::with(vec2(1280.0, 720.0), Start { open });
        window.command(Command::ProjectorTheme);
        for page in 1..=lesson.pages.len() {
            for pixels in [[1024.0, 768.0], [1280.0, 720.0], [1920.0, 1080.0]] {
                resize(&mut window, pixels, 1.0);
                let at = format!("{}, page {page}, {}×{}", lesson.title, pixels[0], pixels[1]);
                faults_of.extend(
                    small(&window).filter(|_| !window.has(Region::Question)).map(|fault| format!("{at}: {fault}")),
                );
                pages += 1;
            }
            window.command(Command::NextPage);
        }
    }
    assert!(pages > 300, "{pages} pages were looked at");
    assert!(faults_of.is_empty(), "{} faults\n{}", faults_of.len(), faults_of.join("\n"));
}

/// The height of the letter x where `words` are painted, in pixels; of letters as high as it, where there is no x.
fn x_height_px(window: &Window, pane: Rect, is_wanted: impl Fn(&str) -> bool) -> Option<f32> {
    let mut least: Option<f32> = None;
    for clipped in &window.harness.output().shapes {
        each_text(&clipped.shape, &mut |text| {
            let words = text.galley.job.text.trim();
            if !pane.contains_rect(text.visual_bounding_rect()) || !is_wanted(words) {
                return;
            }
            let glyphs = text.galley.rows.iter().flat_map(|row| row.glyphs.iter());
            let flat = glyphs.filter(|glyph| "xvwz".contains(glyph.chr)).map(|glyph| glyph.uv_rect.size.y);
            least = flat.reduce(f32::min).into_iter().chain(least).reduce(f32::min);
        });
    }
    least.map(|height| height * window.harness.ctx.pixels_per_point())
}

fn each_text(shape: &Shape, see: &mut impl FnMut(&TextShape)) {
    match shape {
        Shape::Vec(shapes) => shapes.iter().for_each(|shape| each_text(shape, see)),
        Shape::Text(text) => see(text),
        _ => {}
    }
}

#[test]
fn what_is_presented_can_be_read_in_the_last_row() {
    let (mut sentences, mut long_ones, mut labels) = (0, 0, 0);
    for id in TOLD {
        let mut window = window(id, "0.0");
        window.command(Command::ProjectorTheme);
        window.command(Command::Present);
        resize(&mut window, [1280.0, 720.0], 1.0);
        window.key(Key::PageDown);
        for step in 0..8 {
            window.key(Key::ArrowRight);
            let is_sentence = |words: &str| words.split(' ').count() > 3;
            for strip in rects(&window, Region::Strip) {
                if let Some(height) = x_height_px(&window, strip, is_sentence) {
                    assert!(height >= 14.5, "{id}, step {step}: the x of a sentence has {height} px");
                    // The longest are smaller, so that all of it is seen.
                    long_ones += usize::from(height < 15.5);
                    sentences += 1;
                }
            }
            for chart in rects(&window, Region::Chart) {
                if let Some(height) = x_height_px(&window, chart, |words| words.split(' ').count() < 4) {
                    assert!(height >= 11.5, "{id}, step {step}: the x of a label has {height} px");
                    labels += 1;
                }
            }
        }
    }
    assert!(sentences > 40 && labels >= 8, "{sentences} sentences, {labels} charts");
    assert!(10 * long_ones <= sentences, "{long_ones} of {sentences} sentences are smaller than 16 px");
}

/// Estimators with short sentences and long conclusions, with formulas of many lines, and with none.
const TOLD: [&str; 8] = [
    "full-search",
    "diamond",
    "horn-schunck",
    "lucas-kanade",
    "harris",
    "sift",
    "mixture-of-gaussians",
    "kalman-tracker",
];

/// Shows the window at the start, at the steps of a unit, at its end and at the end of the run.
fn along_a_unit(window: &mut Window, mut look: impl FnMut(&Window, &str)) {
    look(window, "start");
    window.key(Key::PageDown);
    for step in 1..=8 {
        window.key(Key::ArrowRight);
        look(window, &format!("step {step}"));
    }
    window.key(Key::U);
    look(window, "the end of a unit");
    window.key(Key::End);
    look(window, "the end of the run");
    window.key(Key::PageUp);
    look(window, "the unit before");
}

#[test]
fn the_stage_of_a_lecture_stays_as_it_is_from_step_to_step() {
    for id in TOLD {
        for (theme, pixels) in [
            (Command::ProjectorTheme, [1280.0, 720.0]),
            (Command::ProjectorTheme, [1920.0, 1080.0]),
            (Command::DarkTheme, [1280.0, 720.0]),
        ] {
            let mut window = window(id, "0.0");
            window.command(theme);
            if theme == Command::DarkTheme {
                window.key(Key::L);
            }
            resize(&mut window, pixels, 1.0);
            let mut heights = Vec::new();
            along_a_unit(&mut window, |window, at| {
                let stage = rects(window, Region::Stage);
                assert_eq!((stage.len(), rects(window, Region::Strip).len()), (1, 1), "{id}, {theme:?}, {at}");
                heights.push((stage[0].height(), at.to_owned()));
            });
            let all = || heights.iter().map(|(height, _)| *height);
            let (least, most) = (all().fold(f32::INFINITY, f32::min), all().fold(0.0, f32::max));
            assert!(least >= 0.95 * most, "{id}, {theme:?}, {pixels:?}: {heights:?}");
        }
    }
}

#[test]
fn every_layout_settles() {
    for id in TOLD {
        for theme in [Command::DarkTheme, Command::ProjectorTheme] {
            let mut window = window(id, "0.0");
            window.command(theme);
            // Low enough that the line at work comes into sight and goes out of it, and that the panes share the height.
            resize(&mut window, [1440.0, 760.0], 1.0);
            along_a_unit(&mut window, |window, at| {
                // What was drawn last had its final size at once.
                let passes = window.harness.output().platform_output.num_completed_passes;
                assert_eq!(passes, 1, "{id}, {theme:?}, {at}: the layout goes on changing");
            });
        }
    }
}

#[test]
fn the_explanation_keeps_its_height_as_formulas_come_and_go() {
    for (id, least) in [("horn-schunck", 3), ("sift", 0)] {
        let mut window = window(id, "0.0");
        resize(&mut window, [1440.0, 700.0], 1.0);
        let pictures = rects(&window, Region::Pictures).len();
        // Without a chart it has the whole column, and beside other pictures another one.
        let mut heights = Vec::new();
        along_a_unit(&mut window, |window, _| {
            if window.has(Region::Chart) && rects(window, Region::Pictures).len() == pictures {
                heights.push(window.region(Region::Explanation).height());
            }
        });
        assert!(heights.len() >= least, "{id}: {heights:?}");
        assert!(heights.windows(2).all(|pair| pair[1] >= pair[0] - 0.5), "{id} shrinks: {heights:?}");
    }
}

#[test]
fn sentence_and_formula_are_whole_in_a_lecture() {
    for id in TOLD {
        let mut window = window(id, "0.0");
        window.command(Command::ProjectorTheme);
        resize(&mut window, [1280.0, 720.0], 1.0);
        along_a_unit(&mut window, |window, at| {
            let strip = rects(window, Region::Strip)[0];
            // What is scrolled out of sight is painted as well.
            let shapes = window.harness.output().shapes.iter();
            let mut told = Vec::new();
            shapes
                .filter(|clipped| strip.expand(4.0).contains_rect(clipped.clip_rect))
                .for_each(|clipped| texts(&clipped.shape, clipped.clip_rect, &mut told));
            assert!(!told.is_empty(), "{id}, {at}: no text");
            let cut = told.iter().find(|word| !word.clip.expand(1.5).contains_rect(word.rect));
            assert_eq!(cut.map(|word| &word.text), None, "{id}, {at}");
        });
    }
}

#[test]
fn bad_windows_are_usable() {
    for (pixels, scale) in
        [([640.0, 480.0], 1.0), ([640.0, 480.0], 3.0), ([1920.0, 1080.0], 3.0), ([500.0, 900.0], 1.0)]
    {
        let mut window = Window::new(vec2(1280.0, 720.0));
        resize(&mut window, pixels, scale);
        assert_eq!(faults(&window), Vec::<String>::new(), "{pixels:?} at {scale}");
        window.key(Key::ArrowRight);
        assert!(window.cursor() > Cursor::default());
    }
}

#[test]
fn a_chart_takes_the_place_of_the_stage_and_gives_it_back() {
    let mut window = Window::new(vec2(1280.0, 720.0));
    let before = area(&window, Region::Chart);
    assert_eq!(rects(&window, Region::Stage).len(), 1);
    window.click("Enlarge the chart");
    assert!(rects(&window, Region::Stage).is_empty() && area(&window, Region::Chart) > 2.0 * before);
    assert_eq!(faults(&window), Vec::<String>::new());
    window.key(Key::Escape);
    let after = area(&window, Region::Chart);
    assert!(window.has(Region::Stage) && after < 1.5 * before, "{after} and {before}");
}

#[test]
fn entries_that_the_legend_has_no_room_for_are_listed_by_a_click() {
    let mut window = Window::new(vec2(1280.0, 720.0));
    resize(&mut window, [640.0, 480.0], 1.0);
    let node = window.harness.get_by_label_contains("Legend: ").accesskit_node();
    let legend = node.label().or_else(|| node.value()).expect("its entries");
    // The numbers of the scale are words of their own.
    let listed = |window: &Window| {
        let all = words(&window.harness.output().shapes);
        all.iter().filter(|word| word.text.len() > 4 && legend.contains(&word.text)).count()
    };
    let before = listed(&window);
    window.harness.get_by_label_contains("more in the legend").click();
    window.settle();
    assert!(listed(&window) > before + 1, "{before} of {legend}");
    window.key(Key::Escape);
    assert_eq!(listed(&window), before);
}

#[test]
fn what_is_wrong_is_found() {
    let mut window = Window::new(vec2(1280.0, 720.0));
    assert_eq!((faults(&window), small(&window)), (Vec::<String>::new(), None));
    // Zoomed out by hand, a picture does not fill its place.
    for _ in 0..12 {
        window.command(Command::ZoomOut);
    }
    assert!(small(&window).is_some(), "{:?}", rects(&window, Region::Pictures));
}

#[test]
fn the_parameters_lie_over_no_picture() {
    for pixels in [[844.0, 390.0], [1024.0, 768.0], [1280.0, 720.0], [1920.0, 1080.0]] {
        for theme in [Command::DarkTheme, Command::ProjectorTheme] {
            let mut window = Window::new(vec2(1280.0, 720.0));
            window.command(theme);
            resize(&mut window, pixels, 1.0);
            while !window.has(Region::Parameters) {
                window.command(Command::ShowParameters);
                window.step();
            }
            let parameters = window.region(Region::Parameters);
            let over =
                rects(&window, Region::Pictures).into_iter().find(|rect| rect.shrink(1.0).intersects(parameters));
            assert_eq!(over, None, "{pixels:?}, {theme:?}: {parameters:?}");
        }
    }
}
