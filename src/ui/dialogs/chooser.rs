//! The estimators by family, each with a small picture of a step, and first those that suit the clip.
//!
//! It serves header, parameters, lockstep and start page. Whether the clip suits an estimator follows from declarations and
//! examples alone (`experiment/suitability.rs`).

use std::cmp::Reverse;
use std::ops::Range;

use eframe::egui::text::LayoutJob;
use eframe::egui::{
    self, Align, Key, Label, Layout, Margin, Modifiers, Rect, RichText, ScrollArea, Sense, TextEdit, TextStyle, Ui,
    Vec2, pos2, vec2,
};
use lucide_icons::Icon;
use motionscope_core::course::{estimators, examples};
use motionscope_core::run::{Info, lockstep};

use super::fuzzy::{self, Place, Words};
use super::palette;
use crate::experiment::suitability::{Merit, Suitability};
use crate::paint::Theme;
use crate::ui::commands::{Action, Actions};
use crate::ui::model::document::Document;
use crate::ui::model::step_pictures::StepPictures;
use crate::ui::parts::entry_card::{self, Card};
use crate::ui::parts::{arrows, widgets};

/// Space between columns.
const GAP: f32 = 12.0;
/// Least and largest width of a column and height of a row, in sizes of the type.
const COLUMN_LETTERS: f32 = 13.0;
const ROW_LETTERS: [f32; 2] = [3.1, 5.0];
const WIDEST_LETTERS: f32 = 22.0;
/// Heights of rows in halves of one: a heading or a reason, a card, a card with a note.
const HEADING: usize = 1;
const CARD: usize = 2;
const CARD_WITH_NOTE: usize = 3;

/// What an estimator is chosen for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// To run on the clip.
    Run,
    /// To run in lockstep with the one that does.
    Beside,
    /// To open its example, where no clip is in sight.
    Example,
}

/// The chooser while it is open.
pub struct State {
    query: String,
    /// Whether Enter was pressed before it was there.
    is_entered: bool,
    purpose: Purpose,
    /// All estimators in the order of the course.
    all: Vec<Entry>,
    /// The id of the one in use.
    now: &'static str,
    /// Number of the card that Enter takes, of those that are shown.
    lit: usize,
    /// Whether it may be out of sight.
    is_moved: bool,
    /// Where the cards lay in the last frame.
    cards: Vec<(usize, Rect)>,
}

/// An estimator to choose.
struct Entry {
    info: &'static Info,
    /// Whether the clip suits it, if there is one.
    suitability: Option<Suitability>,
    /// Why it cannot be chosen.
    refused: Option<String>,
    about: String,
}

impl Entry {
    /// Why the clip suits it.
    fn merit(&self) -> Option<Merit> {
        match self.suitability {
            Some(Suitability::Suits(merit)) => Some(merit),
            _ => None,
        }
    }

    /// Why the clip does not suit it.
    fn flaw(&self) -> String {
        match self.suitability {
            Some(Suitability::Unsuited(flaw)) => flaw.words(),
            _ => String::new(),
        }
    }

    fn place(&self, query: &str) -> Option<fuzzy::Rank> {
        let Info { id, name, family, .. } = self.info;
        fuzzy::rank(query, Words { name, also: id, kind: family, tags: "", about: &self.about })
    }

    fn action(&self, purpose: Purpose) -> Option<Action> {
        let id = self.info.id;
        Some(match purpose {
            Purpose::Run => Action::Choose(id),
            Purpose::Beside => Action::AddBeside(id),
            Purpose::Example => Action::OpenExample(id, examples::of(id).find(|example| !example.is_failure())?),
        })
    }
}

/// Estimators below a heading.
struct Group {
    heading: &'static str,
    parts: Vec<Part>,
}

/// Some of them, by their numbers, with what is said of all of them.
struct Part {
    reason: &'static str,
    entries: Vec<usize>,
}

impl State {
    /// The chooser with `query` typed into it, and Enter behind it if `is_entered`.
    pub fn new(document: &Document, purpose: Purpose, query: impl Into<String>, is_entered: bool) -> Self {
        let opened = document.source().zip(document.clip());
        let opened = opened.filter(|_| purpose == Purpose::Run && !document.has_own_clip());
        let leader = document.estimator();
        let all = estimators().into_iter().map(|estimator| Entry {
            info: estimator.info(),
            suitability: opened.map(|(source, clip)| Suitability::of(&*estimator, source, clip)),
            refused: (purpose == Purpose::Beside)
                .then(|| lockstep::check(&[leader, &*estimator]).err().map(|error| error.to_string()))
                .flatten(),
            about: palette::about(&*estimator),
        });
        let mut state = Self {
            query: query.into(),
            is_entered,
            purpose,
            all: all.collect(),
            now: if purpose == Purpose::Run { leader.info().id } else { "" },
            lit: 0,
            is_moved: true,
            cards: Vec::new(),
        };
        state.light_best();
        state
    }

    /// Lights the card that the query means, or that of the estimator in use.
    fn light_best(&mut self) {
        let shown: Vec<usize> = numbers(&self.groups()).collect();
        let best = if self.query.trim().is_empty() {
            shown.iter().rposition(|number| self.all[*number].info.id == self.now)
        } else {
            let place = |card: &usize| self.all[shown[*card]].place(&self.query);
            // Of equal ranks the first.
            (0..shown.len()).min_by_key(|card| Reverse(place(card)))
        };
        (self.lit, self.is_moved) = (best.unwrap_or(0), true);
    }

    /// Lights the next card that way. Up and down stay in their column.
    fn go(&mut self, way: Vec2) {
        let Some((_, from)) = self.cards.iter().find(|(card, _)| *card == self.lit) else { return };
        let is_there = |rect: &Rect| way.y == 0.0 || rect.x_range() == from.x_range();
        let cards: Vec<_> = self.cards.iter().filter(|(_, rect)| is_there(rect)).copied().collect();
        (self.lit, self.is_moved) = (arrows::nearest(&cards, *from, way).unwrap_or(self.lit), true);
    }

    /// What is shown: all with those first that suit the clip, or what the query finds, by family.
    fn groups(&self) -> Vec<Group> {
        let is_asked = !self.query.trim().is_empty();
        let found = self.found();
        let families = found.chunk_by(|a, b| self.all[*a].info.family == self.all[*b].info.family);
        let families = families.map(|of| Group {
            heading: self.all[of[0]].info.family,
            parts: vec![Part { reason: "", entries: of.to_vec() }],
        });
        let of = |merit| {
            let entries = (0..self.all.len()).filter(|number| self.all[*number].merit() == Some(merit)).collect();
            Part { reason: merit.words(), entries }
        };
        let parts: Vec<Part> = Merit::ALL.map(of).into_iter().filter(|part| !part.entries.is_empty()).collect();
        let suits = Group { heading: "Especially suited to this clip", parts };
        (!is_asked && !suits.parts.is_empty()).then_some(suits).into_iter().chain(families).collect()
    }

    /// Estimators whose names match the query; if none does, those whose descriptions match it, misspelt or not, or whose letters do.
    fn found(&self) -> Vec<usize> {
        let kind = |place: Place| place.min(Place::Beside);
        let all = self.all.iter().enumerate();
        let ranked: Vec<(usize, Place)> =
            all.filter_map(|(number, entry)| Some((number, kind(entry.place(&self.query)?.0)))).collect();
        let best = ranked.iter().map(|(_, place)| *place).max();
        ranked.into_iter().filter(|(_, place)| Some(*place) == best).map(|(number, _)| number).collect()
    }

    /// Halves of a row that a card takes.
    fn height(&self, number: usize) -> usize {
        if self.all[number].flaw().is_empty() { CARD } else { CARD_WITH_NOTE }
    }

    /// Halves of a row that a group takes.
    fn length(&self, group: &Group) -> usize {
        let of_part = |part: &Part| {
            let cards: usize = part.entries.iter().map(|number| self.height(*number)).sum();
            cards + if part.reason.is_empty() { 0 } else { HEADING }
        };
        HEADING + group.parts.iter().map(of_part).sum::<usize>()
    }

    /// What is said of an estimator in the line at the bottom.
    fn description(&self, number: usize) -> String {
        let entry = &self.all[number];
        let said = match (&entry.refused, entry.merit()) {
            (Some(refused), _) => format!("{}.", motionscope_core::base::words::capital(refused)),
            (None, Some(merit)) => merit.words().to_owned(),
            (None, None) => entry.flaw(),
        };
        format!("{}: {} {said}", entry.info.name, entry.info.summary).trim_end().to_owned()
    }
}

/// The numbers of the estimators in the order of their cards.
fn numbers(groups: &[Group]) -> impl Iterator<Item = usize> {
    groups.iter().flat_map(|group| &group.parts).flat_map(|part| part.entries.iter().copied())
}

/// Divides groups of these lengths, in their order, into at most `count` columns of which the longest is as short as can be.
fn columns(lengths: &[usize], count: usize) -> Vec<Range<usize>> {
    let within = |limit: usize| {
        let mut columns: Vec<(Range<usize>, usize)> = Vec::new();
        for (index, length) in lengths.iter().enumerate() {
            match columns.last_mut() {
                Some((column, sum)) if *sum + length <= limit => (column.end, *sum) = (index + 1, *sum + length),
                _ => columns.push((index..index + 1, *length)),
            }
        }
        columns
    };
    let least = lengths.iter().copied().max().unwrap_or(0);
    let fits = (least..).map(within).find(|columns| columns.len() <= count.max(1));
    fits.unwrap_or_default().into_iter().map(|(column, _)| column).collect()
}

/// Shows the chooser; gives whether it is still open.
pub fn show(
    ctx: &egui::Context,
    state: &mut State,
    steps: &mut StepPictures,
    theme: Theme,
    actions: &mut Actions,
) -> bool {
    let screen = ctx.content_rect().size();
    let margin = (0.02 * screen.x).clamp(8.0, 24.0);
    let modal = widgets::modal(ctx, "estimators", screen);
    let frame = egui::Frame::window(&ctx.global_style()).inner_margin(Margin::same(margin as i8));
    let (mut chosen, mut is_closed) = (None, false);
    let modal = modal.frame(frame).show(ctx, |ui| {
        ui.set_width(screen.x - 4.0 * margin);
        let (way, enter) = ui.input_mut(|input| {
            let mut hit = |key| input.consume_key(Modifiers::NONE, key);
            (arrows::pressed(&mut hit), hit(Key::Enter))
        });
        is_closed = head(ui, state);
        way.into_iter().for_each(|way| state.go(way));
        let small = TextStyle::Small.resolve(ui.style()).size;
        let foot = (2.7 * small).round();
        let room = vec2(ui.available_width(), screen.y - 4.0 * margin - ui.min_size().y - foot - 24.0);
        let mut list = List { state, steps, theme, pointed_at: None, clicked: None };
        list.show(ui, room);
        let (pointed_at, clicked) = (list.pointed_at, list.clicked);
        let shown: Vec<usize> = numbers(&state.groups()).collect();
        let lit = shown.get(state.lit).copied();
        describe(ui, pointed_at.or(lit).map(|number| state.description(number)), foot);
        let entered = lit.filter(|_| enter || std::mem::take(&mut state.is_entered));
        let is_free = |number: &usize| state.all[*number].refused.is_none();
        chosen = clicked.or(entered).filter(is_free).and_then(|number| state.all[number].action(state.purpose));
    });
    let is_open = !modal.should_close() && !is_closed && chosen.is_none();
    actions.0.extend(chosen);
    is_open
}

/// The title, the search field and the way out, which was taken if it says so.
fn head(ui: &mut Ui, state: &mut State) -> bool {
    let title = if state.purpose == Purpose::Beside { "Add in lockstep" } else { "Estimators" };
    ui.horizontal(|ui| {
        ui.heading(title);
        ui.add_space(GAP);
        let right = Layout::right_to_left(Align::Center);
        ui.with_layout(right, |ui| {
            let is_closed = widgets::icon_button(ui, Icon::X, "Close", false).clicked();
            let id = egui::Id::unique("estimator query");
            let before = state.query.clone();
            widgets::catch_text(ui.ctx(), id, &mut state.query);
            let field = TextEdit::singleline(&mut state.query).id(id).hint_text("Find an estimator…");
            let field = ui.add(field.desired_width(f32::INFINITY).margin(Margin::symmetric(8, 6)));
            field.accessible_name("Which estimator").request_focus();
            if state.query != before {
                state.light_best();
                // The field shows what was typed one frame after.
                ui.ctx().request_repaint();
            }
            is_closed
        })
        .inner
    })
    .inner
}

/// What an estimator does, in at most two lines.
fn describe(ui: &mut Ui, said: Option<String>, height: f32) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    let said = said.unwrap_or_else(|| "No estimator has these words.".into());
    let font = TextStyle::Small.resolve(ui.style());
    let mut job = LayoutJob::simple(said, font, ui.visuals().weak_text_color(), rect.width());
    job.wrap.max_rows = 2;
    widgets::inside(ui, rect, Layout::top_down(Align::LEFT)).add(Label::new(job).selectable(false));
}

/// The cards as they are drawn.
struct List<'a> {
    state: &'a mut State,
    steps: &'a mut StepPictures,
    theme: Theme,
    /// The estimator under the pointer.
    pointed_at: Option<usize>,
    clicked: Option<usize>,
}

impl List<'_> {
    /// Shows columns of groups in as much room, which scroll where they are longer.
    fn show(&mut self, ui: &mut Ui, room: Vec2) {
        let size = TextStyle::Body.resolve(ui.style()).size;
        let groups = self.state.groups();
        let lengths: Vec<usize> = groups.iter().map(|group| self.state.length(group)).collect();
        // Beside the bar that scrolls.
        let width = room.x - 12.0;
        let most = ((width + GAP) / (COLUMN_LETTERS * size + GAP)).max(1.0) as usize;
        let columns = columns(&lengths, most);
        let longest = columns.iter().map(|column| lengths[column.clone()].iter().sum()).max().unwrap_or(0);
        let row = (2.0 * room.y / longest.max(1) as f32).clamp(ROW_LETTERS[0] * size, ROW_LETTERS[1] * size).floor();
        let column = ((width + GAP) / columns.len().max(1) as f32 - GAP).min(WIDEST_LETTERS * size);
        ScrollArea::vertical().max_height(room.y).min_scrolled_height(room.y).auto_shrink(false).show(ui, |ui| {
            let size = vec2(width, longest as f32 * row / 2.0);
            let (all, _) = ui.allocate_exact_size(size, Sense::hover());
            self.state.cards.clear();
            for (index, groups_of) in columns.into_iter().enumerate() {
                let left = all.min.x + index as f32 * (column + GAP);
                let strip = Rect::from_x_y_ranges(left..=left + column, all.y_range());
                self.column(ui, strip, row, &groups[groups_of]);
            }
        });
        self.state.is_moved = false;
    }

    fn column(&mut self, ui: &mut Ui, strip: Rect, row: f32, groups: &[Group]) {
        let mut top = strip.min.y;
        let mut take = |halves: usize| {
            let height = halves as f32 * row / 2.0;
            top += height;
            Rect::from_x_y_ranges(strip.x_range(), top - height..=top)
        };
        for group in groups {
            let mut heading = widgets::inside(ui, take(HEADING), Layout::left_to_right(Align::Max));
            widgets::heading(&mut heading, group.heading);
            for part in &group.parts {
                if !part.reason.is_empty() {
                    let mut line = widgets::inside(ui, take(HEADING), Layout::left_to_right(Align::Center));
                    line.add(Label::new(RichText::new(part.reason).small().weak()).truncate().selectable(false));
                }
                for number in &part.entries {
                    let rect = take(self.state.height(*number));
                    self.card(ui, rect.shrink2(vec2(0.0, 1.0)), *number, part.reason, row);
                }
            }
        }
    }

    fn card(&mut self, ui: &mut Ui, rect: Rect, number: usize, reason: &str, row: f32) {
        let index = self.state.cards.len();
        // What lies above or below the part in sight has a place, too.
        self.state.cards.push((index, rect));
        let entry = &self.state.all[number];
        let (info, flaw, is_lit) = (entry.info, entry.flaw(), index == self.state.lit);
        let name = if reason.is_empty() { info.name.to_owned() } else { format!("{}: {reason}", info.name) };
        let card = Card {
            name: &name,
            title: info.name,
            note: &flaw,
            picture: row - 8.0,
            texture: ui.is_rect_visible(rect).then(|| self.steps.picture(info.id)).flatten(),
            is_lit,
            is_now: info.id == self.state.now,
            is_disabled: entry.refused.is_some(),
            has_edge: false,
            theme: self.theme,
        };
        let id = ui.scope_id().with(("estimator", index));
        let response = entry_card::show(ui, rect, id, &card);
        if is_lit && self.state.is_moved {
            // With the headings of its group and its part above it.
            let headings = if reason.is_empty() { 1 } else { 2 } * HEADING;
            let above =
                Rect::from_min_max(pos2(rect.min.x, rect.min.y - (headings as f32 + 1.0) * row / 2.0), rect.max);
            ui.scroll_to_rect(above, None);
        }
        if response.hovered() {
            self.pointed_at = Some(number);
        }
        if response.clicked() {
            self.clicked = Some(number);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::source::Source;
    use crate::media::{Given, Open};

    fn on(clip: &str) -> Document {
        let source = Source::parse(clip).expect("a scene");
        let mut document = Document::default();
        document.open(source.open(&Open::default()).expect("a clip").clip, source, Given::default());
        document
    }

    fn names(state: &State, group: &Group) -> Vec<&'static str> {
        numbers(std::slice::from_ref(group)).map(|number| state.all[number].info.name).collect()
    }

    #[test]
    fn every_estimator_stands_once_in_its_family_in_the_order_of_the_course() {
        for clip in ["synth:pillar", "synth:still-life"] {
            let state = State::new(&on(clip), Purpose::Run, "", false);
            let groups = state.groups();
            assert_eq!(groups[0].heading, "Especially suited to this clip");
            let listed: Vec<_> = groups[1..].iter().flat_map(|group| names(&state, group)).collect();
            let all: Vec<_> = estimators().iter().map(|estimator| estimator.info().name).collect();
            assert_eq!(listed, all);
        }
    }

    #[test]
    fn stereo_is_said_to_suit_a_clip_with_two_views_alone() {
        let first = |clip| {
            let state = State::new(&on(clip), Purpose::Run, "", false);
            names(&state, &state.groups()[0])
        };
        assert_eq!(first("synth:still-life")[0], "Block stereo");
        assert!(!first("synth:pillar").contains(&"Block stereo"));
    }

    #[test]
    fn a_query_finds_names_before_what_only_speaks_of_them() {
        let found = |query: &str| {
            let state = State::new(&on("synth:pillar"), Purpose::Run, query, false);
            let groups = state.groups();
            let lit = numbers(&groups).nth(state.lit).map(|number| state.all[number].info.name);
            (lit.unwrap_or_default(), groups.iter().flat_map(|group| names(&state, group)).collect::<Vec<_>>())
        };
        assert_eq!(found("kalman"), ("Kalman filter", vec!["Kalman filter", "Kalman tracker"]));
        assert!(found("tracker").0.to_lowercase().contains("tracker"), "{:?}", found("tracker"));
        assert_eq!(found("optical flow").1.len(), 9, "a family");
        assert!(found("aperture").1.contains(&"Normal flow"), "{:?}", found("aperture"));
        let occluded = found("occlu").1;
        let slipped = found("oclu").1;
        assert!(!occluded.is_empty() && occluded.iter().all(|name| slipped.contains(name)), "{slipped:?}");
        assert_eq!(found("qqqq"), ("", vec![]));
    }

    #[test]
    fn columns_keep_the_order_and_are_about_as_long() {
        assert_eq!(columns(&[5, 2, 3, 4, 1], 2), [0..2, 2..5]);
        assert_eq!(columns(&[5, 2, 3], 9), [0..1, 1..3]);
        assert_eq!(columns(&[5, 2], 0), vec![Range { start: 0, end: 2 }]);
        assert_eq!(columns(&[], 3), Vec::<Range<usize>>::new());
    }
}
