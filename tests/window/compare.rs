//! The comparison of estimators: cards, the table and what is told below it.

use eframe::egui::epaint::TextShape;
use eframe::egui::{FontFamily, Shape};

use super::*;
use layout::words;

/// A window with a comparison of these estimators, the first of which is open.
fn comparing(size: Vec2, theme: Theme, estimator: &str, added: &[&str]) -> Window {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("one.motionscope");
    let theme = theme.id();
    let lines = format!(
        "motionscope = 1\nclip = \"synth:pillar\"\nestimator = \"{estimator}\"\n[picture]\ntheme = \"{theme}\"\n"
    );
    fs::write(&path, lines).expect("it is written");
    let mut window = Window::with(size, Start { open: Some(path.into()) });
    window.harness.key_press(Key::C);
    window.compared();
    if !added.is_empty() {
        window.harness.get_by_label("Change…").click();
        window.compared();
        for name in added {
            window.harness.get_by_label(name).click();
            window.compared();
        }
        window.harness.get_by_label("Done").click();
        window.compared();
    }
    window
}

/// Words of the cards, with their places.
fn cards(window: &Window) -> Vec<(String, Rect)> {
    let all = window.harness.query_all_by_role(Role::Image);
    let labelled = all.filter_map(|node| Some((node.accesskit_node().label()?, node.rect())));
    labelled.filter(|(label, _)| label.contains(": ") && label.ends_with('.')).collect()
}

/// Every text in sight that is in bold type.
fn bold(window: &Window) -> Vec<String> {
    fn add(shape: &Shape, all: &mut Vec<String>) {
        match shape {
            Shape::Vec(shapes) => shapes.iter().for_each(|shape| add(shape, all)),
            Shape::Text(TextShape { galley, .. }) => {
                let is_bold = |family: &FontFamily| *family == FontFamily::Name("bold".into());
                if galley.job.sections.iter().all(|section| is_bold(&section.format.font_id.family)) {
                    all.push(galley.job.text.clone());
                }
            }
            _ => {}
        }
    }
    let mut all = Vec::new();
    window.harness.output().shapes.iter().for_each(|clipped| add(&clipped.shape, &mut all));
    all
}

/// Places of the pictures that are painted inside `rect`.
fn pictures(window: &Window, rect: Rect) -> usize {
    let is_picture = |shape: &Shape| match shape {
        Shape::Rect(shape) => shape.brush.is_some() && rect.contains_rect(shape.rect),
        Shape::Mesh(mesh) => mesh.texture_id != Default::default() && rect.contains_rect(mesh.calc_bounds()),
        _ => false,
    };
    window.harness.output().shapes.iter().filter(|clipped| is_picture(&clipped.shape)).count()
}

#[test]
fn a_card_for_each_estimator_has_its_picture_and_a_sentence_that_is_true_of_the_table() {
    let window = comparing(vec2(1280.0, 720.0), Theme::Projector, "full-search", &[]);
    let cards = cards(&window);
    let [full, three, diamond] = &cards[..] else { panic!("{cards:?}") };
    assert_eq!(full.0, "Full search: The others are compared with it.");
    assert!(three.0.starts_with("Three-step search: 31 × fewer candidates, EPE 0.003 px better"), "{}", three.0);
    assert!(diamond.0.starts_with("Diamond search: 63 × fewer candidates, EPE 0.009 px better"), "{}", diamond.0);
    for number in ["969.2", "31.4", "15.5", "0.635", "0.632", "0.626"] {
        assert!(window.harness.query_by_label(number).is_some(), "{number} stands in the table");
    }
    for (text, rect) in &cards {
        assert_eq!(pictures(&window, *rect), 1, "{text}");
    }
}

#[test]
fn the_best_of_a_column_is_bold_and_no_number_that_is_not() {
    let window = comparing(vec2(1280.0, 720.0), Theme::Projector, "full-search", &[]);
    let bold = bold(&window);
    let is_bold = |text: &str| bold.iter().any(|other| other == text);
    // Candidates, EPE and PSNR.
    assert!(["15.5", "0.626", "37.14"].into_iter().all(is_bold), "{bold:?}");
    assert!(!["969.2", "31.4", "0.635", "36.91", "36.90"].into_iter().any(is_bold), "{bold:?}");
}

#[test]
fn nothing_of_a_comparison_is_cut_in_a_lecture_hall() {
    let four = ["Predictive search"].as_slice();
    for (theme, size) in [(Theme::Projector, vec2(1280.0, 720.0)), (Theme::Light, vec2(1920.0, 1080.0))] {
        for (estimator, added, names) in [
            ("full-search", [].as_slice(), ["Full search", "Diamond search"]),
            ("full-search", four, ["Full search", "Predictive search"]),
            ("lucas-kanade", &[], ["Lucas–Kanade", "Normal flow"]),
        ] {
            let window = comparing(size, theme, estimator, added);
            assert_eq!(cards(&window).len(), if added.is_empty() { 3 } else { 4 }, "{estimator}, {theme:?}");
            let left = window.harness.get_by_label("Compare estimators").rect().min.x;
            let right = window.harness.get_by_label("Close").rect().max.x;
            let bottom = window.harness.get_by_label("Save").rect().max.y;
            assert!(bottom < size.y / window.harness.ctx.zoom_factor());
            let all = words(&window.harness.output().shapes);
            let own = all.iter().filter(|word| word.clip.max.x < right + 40.0 && word.clip.min.x > left - 40.0);
            // A path is scrolled in its field.
            for word in own.filter(|word| !word.text.ends_with(".csv")) {
                let room = word.clip.expand(1.5);
                assert!(room.contains_rect(word.rect), "{estimator}, {theme:?}: “{}” is cut off", word.text);
            }
            for name in names {
                let count = all.iter().filter(|word| word.text == name).count();
                assert!(count >= 2, "{estimator}, {theme:?}: {name} stands on a card and in the table");
            }
            assert!(all.iter().any(|word| word.text.starts_with("stable under") && word.rect.max.x <= right));
        }
    }
}

#[test]
fn a_sweep_says_which_run_is_best() {
    let mut window = comparing(vec2(1280.0, 720.0), Theme::Projector, "full-search", &[]);
    window.harness.get_by_role_and_label(Role::ComboBox, "Sweep").click();
    window.compared();
    window.harness.get_by_label_contains("Search range: ").click();
    window.compared();
    assert!(cards(&window).is_empty(), "the plot has their place");
    assert!(window.harness.query_by_label_contains("Best EPE: 0.626 px, Diamond search with").is_some());
}
