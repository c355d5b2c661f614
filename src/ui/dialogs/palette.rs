//! The palette: a few letters find any command, estimator, lesson, sample or recent clip.

use std::cmp::Reverse;
use std::path::PathBuf;

use eframe::egui::{
    self, Align2, Key, Label, Layout, Modal, Modifiers, RichText, ScrollArea, Sense, TextEdit, TextStyle, Ui,
    WidgetInfo, vec2,
};
use lucide_icons::Icon;
use motionscope_core::course::estimators;
use motionscope_core::course::examples::{self, Cause, Example};
use motionscope_core::params::Kind;
use motionscope_core::run::AnyEstimator;
use motionscope_core::synth;

use super::fuzzy::{self, Rank, Words};
use crate::paint::Theme;
use crate::search::Target;
use crate::session::lesson::{self, Address};
use crate::ui::commands::{self, Action, Command, Granularities, Situation};
use crate::ui::drawing::style;
use crate::ui::parts::widgets;
use crate::view::panes::{EXPLANATION, PANES, STAGE};

/// The palette while it is open.
#[derive(Default)]
pub struct State {
    query: String,
    chosen: usize,
    /// Whether Enter was pressed before it was there.
    is_entered: bool,
}

impl State {
    /// The palette with something typed in it already, and Enter behind it if `is_entered`.
    pub fn asking(query: impl Into<String>, is_entered: bool) -> Self {
        Self { query: query.into(), chosen: 0, is_entered }
    }
}

/// One line of the palette.
struct Entry {
    icon: Icon,
    text: String,
    tip: String,
    /// What it is called in scripts.
    also: &'static str,
    /// What people call it who do not know its name.
    tags: &'static str,
    /// What it is about: words that count less than names.
    about: String,
    keys: String,
    action: Action,
}

/// What can be found.
pub struct Input<'a> {
    /// What is the case just now.
    pub now: Situation,
    /// The names of the ladder.
    pub granularities: Granularities,
    /// The estimator that is chosen.
    pub estimator: &'static str,
    /// Clips that were open lately.
    pub recent: &'a [PathBuf],
    /// The look.
    pub theme: Theme,
}

/// Shows the palette; gives what was chosen and whether it is still open.
pub fn show(ctx: &egui::Context, state: &mut State, input: &Input) -> (Option<Action>, bool) {
    let size = TextStyle::Body.resolve(&ctx.global_style()).size;
    let mut chosen = None;
    let id = egui::Id::unique("palette");
    let area = Modal::default_area(id).anchor(Align2::CENTER_TOP, vec2(0.0, 5.0 * size)).default_height(30.0 * size);
    let area = area.fade_in(false);
    let frame = egui::Frame::window(&ctx.global_style()).inner_margin(12);
    let modal = Modal::new(id).area(area).frame(frame).show(ctx, |ui| {
        ui.set_width((36.0 * size).min(ui.ctx().content_rect().width() - 48.0));
        let (up, down, enter) = ui.input_mut(|i| {
            let mut hit = |key| i.consume_key(Modifiers::NONE, key);
            (hit(Key::ArrowUp), hit(Key::ArrowDown), hit(Key::Enter))
        });
        let id = egui::Id::unique("query");
        widgets::catch_text(ui.ctx(), id, &mut state.query);
        let field = TextEdit::singleline(&mut state.query)
            .id(id)
            .hint_text("Find a command, an estimator, a lesson, a sample…")
            .desired_width(f32::INFINITY)
            .margin(egui::Margin::symmetric(8, 8));
        let response = ui.add(field).accessible_name("What to find");
        response.request_focus();
        if response.changed() {
            state.chosen = 0;
            // The field shows what was typed one frame after.
            ui.ctx().request_repaint();
        }
        let entries = found(&state.query, input);
        state.chosen = (state.chosen + usize::from(down)).saturating_sub(usize::from(up));
        state.chosen = state.chosen.min(entries.len().saturating_sub(1));
        if enter || std::mem::take(&mut state.is_entered) {
            chosen = entries.get(state.chosen).map(|entry| entry.action.clone());
        }
        ScrollArea::vertical().max_height(24.0 * size).min_scrolled_height(24.0 * size).show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            for (index, entry) in entries.iter().enumerate() {
                let lit = index == state.chosen;
                let response = row(ui, entry, lit, input.theme);
                if lit && (up || down) {
                    response.scroll_to_me(None);
                }
                if response.clicked() {
                    chosen = Some(entry.action.clone());
                }
            }
        });
    });
    let open = !modal.should_close() && chosen.is_none();
    (chosen, open)
}

fn row(ui: &mut Ui, entry: &Entry, lit: bool, theme: Theme) -> egui::Response {
    let height = ui.spacing().interact_size.y * 1.2;
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::click());
    let text = &entry.text;
    response.widget_info(|| WidgetInfo::selected(egui::Role::ListBoxOption, true, lit, text));
    let chrome = theme.chrome();
    if lit || response.hovered() {
        let fill = if lit { chrome.selection } else { chrome.raised };
        ui.painter().rect_filled(rect, 5.0, style::color(fill));
    }
    let inner = rect.shrink2(vec2(8.0, 0.0));
    let mut ui = widgets::inside(ui, inner, Layout::left_to_right(egui::Align::Center));
    ui.label(widgets::icon(&ui, entry.icon).color(style::color(chrome.dim)));
    ui.add(Label::new(text).truncate().selectable(false));
    ui.with_layout(Layout::right_to_left(egui::Align::Center), |ui| {
        if !entry.keys.is_empty() {
            widgets::key_cap(ui, &entry.keys, theme);
        }
        ui.add(Label::new(RichText::new(&entry.tip).small().weak()).truncate().selectable(false));
    });
    response
}

/// What `query` finds, the best first.
fn found(query: &str, input: &Input) -> Vec<Entry> {
    let mut ranked: Vec<(Rank, Entry)> =
        entries(input).into_iter().filter_map(|entry| Some((rank(query, &entry)?, entry))).collect();
    // Equal ranks stay in the order of the menus.
    ranked.sort_by_key(|(rank, _)| Reverse(*rank));
    ranked.into_iter().map(|(_, entry)| entry).chain(in_texts(query)).collect()
}

/// How well an entry fits; `None` if it does not.
fn rank(query: &str, entry: &Entry) -> Option<Rank> {
    let Entry { text, tip, also, tags, about, .. } = entry;
    fuzzy::rank(query, Words { name: text, also, kind: tip, tags, about })
}

/// The search of all texts for `query`, behind everything that is called so.
fn in_texts(query: &str) -> Option<Entry> {
    let command = Command::SearchText;
    let action = Action::Type(command, query.to_owned(), false);
    let text = format!("Search all texts for “{}”", query.trim());
    let (tip, about, keys) = (String::new(), String::new(), command.key());
    let is_asked = !query.trim().is_empty();
    is_asked.then(|| Entry { icon: command.entry().icon, text, tip, also: "", tags: "", about, keys, action })
}

/// What an estimator is about: what it does, how, and what can be set.
pub(super) fn about(estimator: &dyn AnyEstimator) -> String {
    let info = estimator.info();
    let parameters = estimator.specs().iter().flat_map(|spec| [spec.label.as_str(), spec.doc.as_str()]);
    let pseudocode = info.pseudocode.iter().map(|line| line.text);
    let all = [info.summary, info.family, info.source].into_iter().chain(parameters).chain(pseudocode);
    all.collect::<Vec<_>>().join(" ")
}

fn entries(input: &Input) -> Vec<Entry> {
    let wanted = |c: &&Command| **c != Command::Palette && c.is_listed(&input.granularities) && c.enabled(&input.now);
    let commands = Command::ALL.iter().filter(wanted).map(|command| {
        let (text, keys, tip) = (command.text(&input.granularities), command.key(), String::new());
        let commands::Entry { icon, menu, submenu, tags, .. } = command.entry();
        let submenu = submenu.map_or("", |submenu| submenu.info().0);
        let about = format!("{submenu} {}", command.tip(&input.granularities));
        let (also, action) = (menu.name(), Action::Command(*command));
        Entry { icon, text, tip, also, tags, about, keys, action }
    });
    let all = estimators();
    let estimators = all.iter().map(|estimator| {
        let info = estimator.info();
        let (text, tip) = (format!("Estimator: {}", info.name), info.family.to_owned());
        let (about, keys) = (about(&**estimator), String::new());
        Entry { icon: Icon::Grid3x3, text, tip, also: info.id, tags: "", about, keys, action: Action::Choose(info.id) }
    });
    let samples = synth::SCENES.iter().map(|sample| {
        let text = format!("Sample: {}", sample.title);
        let action = Action::OpenSample(sample);
        let (tip, about, keys) = (String::new(), sample.teaches.to_owned(), String::new());
        Entry { icon: Icon::Film, text, tip, also: sample.id, tags: "", about, keys, action }
    });
    let lessons = lesson::all().iter().map(|lesson| {
        let text = format!("Lesson: {}", lesson.title);
        let action = Action::OpenPage(Address::from(lesson));
        let pages = lesson.pages.iter().map(|page| page.title.as_str());
        let about = pages.chain([lesson.summary.as_str()]).collect::<Vec<_>>().join(" ");
        let (tip, keys) = (format!("{} pages", lesson.pages.len()), String::new());
        Entry { icon: Icon::BookOpen, text, tip, also: &lesson.slug, tags: "", about, keys, action }
    });
    let recent = input.recent.iter().map(|path| {
        let text = format!("Open {}", widgets::elide(&path.display().to_string(), 56));
        let action = Action::Open(path.into());
        let (tip, about, keys) = (String::new(), "recent file".to_owned(), String::new());
        Entry { icon: Icon::History, text, tip, also: "", tags: "", about, keys, action }
    });
    let charts = PANES.into_iter().filter(|pane| **pane != STAGE && **pane != EXPLANATION).map(|pane| {
        let (text, tip, about) = (format!("Chart: {}", pane.title), String::new(), pane.doc.to_owned());
        let action = Action::Show(Target::Chart(pane));
        Entry { icon: Icon::ChartColumn, text, tip, also: pane.id, tags: "", about, keys: String::new(), action }
    });
    commands
        .chain(estimators)
        .chain(placed_parameters())
        .chain(charts)
        .chain(samples)
        .chain(examples(&all, input.estimator))
        .chain(lessons)
        .chain(recent)
        .collect()
}

/// The examples, each once. One of several estimators opens with the one that is chosen, if it is among them.
fn examples(all: &[Box<dyn AnyEstimator>], chosen: &str) -> Vec<Entry> {
    let mut rows: Vec<Vec<&'static Example>> = Vec::new();
    for example in examples::examples() {
        match rows.iter_mut().find(|row| is_alike(row[0], example)) {
            Some(row) => row.push(example),
            None => rows.push(vec![example]),
        }
    }
    rows.iter().filter_map(|row| example_row(row, all, chosen)).collect()
}

/// Whether both show the same on the same clip, of different estimators.
fn is_alike(a: &Example, b: &Example) -> bool {
    let shown = [a, b].map(|one| (one.title, one.clip, one.frame, &one.settings, one.cause));
    shown[0] == shown[1]
}

/// The row of examples that are alike.
fn example_row(alike: &[&'static Example], all: &[Box<dyn AnyEstimator>], chosen: &str) -> Option<Entry> {
    let name = |id: &str| all.iter().map(|estimator| estimator.info()).find(|info| info.id == id).map(|info| info.name);
    let of: Vec<_> = alike.iter().flat_map(|example| example.of.iter().map(|id| (*id, *example))).collect();
    let (id, example) = of.iter().find(|(id, _)| *id == chosen).or(of.first()).copied()?;
    let verdict = if example.is_failure() { "Fails" } else { "Works" };
    let others = match of.len() - 1 {
        0 => String::new(),
        1 => " and 1 other".to_owned(),
        count => format!(" and {count} others"),
    };
    let names = of.iter().flat_map(|(id, _)| [name(id).unwrap_or_default(), id]).collect::<Vec<_>>().join(" ");
    let says = alike.iter().map(|example| example.says).collect::<Vec<_>>().join(" ");
    Some(Entry {
        icon: Icon::Lightbulb,
        text: format!("Example: {}", example.title),
        tip: format!("{verdict}: {}{others}", name(id)?),
        also: id,
        tags: "",
        about: format!("{names} {} {says}", example.cause.map_or("", Cause::name)),
        keys: String::new(),
        action: Action::OpenExample(id, example),
    })
}

/// What can be placed on the pictures, each once: it is a parameter of some estimator, which is chosen with it.
fn placed_parameters() -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    for estimator in estimators() {
        let info = estimator.info();
        for spec in estimator.specs().iter().filter(|spec| matches!(spec.kind, Kind::Placed(_))) {
            let first = spec.doc.split_once(". ").map_or(spec.doc.as_str(), |(first, _)| first).trim_end_matches('.');
            // A short definition is the name that people look for.
            let name = if first.chars().count() <= MOST_NAME { first } else { &spec.label };
            let text = format!("Parameter: {name}");
            if entries.iter().any(|entry| entry.text == text) {
                continue;
            }
            let (tip, about, keys) = (info.name.to_owned(), spec.doc.clone(), String::new());
            let action = Action::Show(Target::Parameter(info.id, &spec.name));
            entries.push(Entry {
                icon: Icon::SlidersHorizontal,
                text,
                tip,
                also: &spec.name,
                tags: "",
                about,
                keys,
                action,
            });
        }
    }
    entries
}

/// The most letters of a definition that serves as a name.
const MOST_NAME: usize = 24;

#[cfg(test)]
mod tests {
    use super::fuzzy::Place;
    use super::*;
    use crate::ui::commands::Menu;

    #[test]
    fn names_that_begin_with_the_query_come_first() {
        assert_eq!(names("chan")[0], "Estimator: Active contour without edges");
        for query in ["count", "counting line"] {
            let found = names(query);
            assert_eq!(found[0], "Parameter: Counting lines", "{query}: {found:?}");
        }
        for query in ["line", "zone"] {
            let found = names(query);
            assert!(found.iter().take(6).any(|name| name.starts_with("Parameter: ")), "{query}: {found:?}");
        }
    }

    /// What a query finds in a window with a run, by name.
    fn names(query: &str) -> Vec<String> {
        let now = Situation { has_clip: true, has_run: true, ..Situation::default() };
        let granularities = Granularities::new(&["run", "block", "candidate"]);
        let input = Input { now, granularities, estimator: "klt", recent: &[], theme: Theme::Dark };
        found(query, &input).into_iter().map(|entry| entry.text).collect()
    }

    #[test]
    fn words_of_every_day_find_what_they_mean_first() {
        for query in ["settings", "preferences", "font", "contrast"] {
            let meant = Command::ALL.iter().filter(|command| command.entry().tags.contains(query));
            let meant: Vec<_> = meant.map(|command| command.entry().text).collect();
            let found = names(query);
            assert!(meant.contains(&found[0].as_str()), "{query}: {:?}", &found[..3]);
        }
    }

    #[test]
    fn what_a_thing_is_about_finds_it() {
        for (query, text) in [
            ("pyramid", "Estimator: Hierarchical search"),
            ("zoom", Command::Fit.entry().text),
            ("export", Command::ExportPicture.entry().text),
            ("export", Command::ExportResult.entry().text),
            ("screenshot", Command::ExportPicture.entry().text),
            ("aperture", "Estimator: Normal flow"),
            ("stripes", "Sample: "),
            ("point cloud", "Chart: Point cloud"),
            ("search window", "Lesson: Sequential search"),
            ("settings", Command::NormalInterface.entry().text),
            ("preferences", Command::DarkTheme.entry().text),
            ("font", Command::NormalInterface.entry().text),
            ("contrast", Command::ProjectorTheme.entry().text),
        ] {
            assert!(names(query).iter().any(|found| found.starts_with(text)), "{query}: {:?}", names(query));
        }
    }

    #[test]
    fn an_example_of_several_estimators_is_listed_once_and_opens_with_the_chosen_one() {
        let all = estimators();
        let rows = examples(&all, "three-step");
        for (i, row) in rows.iter().enumerate() {
            let is_told_apart = |other: &Entry| (&other.text, &other.tip) != (&row.text, &row.tip);
            assert!(rows[..i].iter().all(is_told_apart), "{}: {}", row.text, row.tip);
        }
        let called = |title: &str| {
            let found = rows.iter().filter(|row| row.text == format!("Example: {title}"));
            found.map(|row| row.tip.as_str()).collect::<Vec<_>>()
        };
        assert_eq!(called("A wall without texture"), ["Fails: Three-step search and 12 others"]);
        assert_eq!(called("A bus passes by"), ["Works: Pyramidal Lucas–Kanade and 5 others", "Fails: Normal flow"]);
        let listed: usize = examples::examples().map(|example| example.of.len()).sum();
        for example in examples::examples() {
            for id in &example.of {
                let rows = examples(&all, id);
                let opens =
                    |row: &Entry| matches!(row.action, Action::OpenExample(of, one) if of == *id && one == example);
                assert_eq!(rows.iter().filter(|row| opens(row)).count(), 1, "{id}: {}", example.title);
            }
        }
        assert!(rows.len() < listed / 2, "{} rows of {listed}", rows.len());
    }

    #[test]
    fn names_count_more_than_what_things_are_about() {
        for (query, first) in [("zoom", "Zoom in"), ("diamond", "Estimator: Diamond search"), ("session", "Save")] {
            assert!(names(query)[0].starts_with(first), "{query}: {:?}", &names(query)[..3]);
        }
    }

    #[test]
    fn a_command_is_found_by_its_menu_before_what_only_speaks_of_it() {
        let first = Command::ExportPicture.entry().text;
        for query in ["export", "export picture", "picture export", "exp pic", "picture of this step"] {
            assert_eq!(names(query)[0], first, "{query}: {:?}", &names(query)[..3]);
        }
        let menu = Command::ALL.iter().filter(|command| command.entry().menu == Menu::Export);
        let of_menu: Vec<_> = menu.map(|command| command.entry().text).collect();
        let found = names("export");
        let listed = found.iter().take_while(|name| of_menu.contains(&name.as_str())).count();
        assert!(listed > 3 && found.iter().skip(listed).all(|name| !of_menu.contains(&name.as_str())), "{found:?}");
        // The pen only says that its ink is exported with pictures.
        let pen = names("export picture").into_iter().position(|name| name == Command::Pen.entry().text);
        assert!(pen.is_some_and(|at| at > 0));
    }

    #[test]
    fn beginnings_of_words_count_more_than_strewn_letters() {
        for query in ["export picture", "search window", "kalman"] {
            let now = Situation { has_clip: true, has_run: true, ..Situation::default() };
            let granularities = Granularities::new(&["run", "block", "candidate"]);
            let input = Input { now, granularities, estimator: "klt", recent: &[], theme: Theme::Dark };
            let all = found(query, &input);
            let places: Vec<_> = all.iter().filter_map(|entry| rank(query, entry)).map(|(place, _)| place).collect();
            // The search of all texts comes last, whatever it is called.
            let listed = &places[..places.len() - 1];
            assert!(listed.is_sorted_by(|before, after| before >= after), "{query}: {listed:?}");
            assert!(listed[0] > Place::Strewn, "{query}: {:?}", names(query)[0]);
        }
    }
}
