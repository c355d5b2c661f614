//! Search over all text: lessons, glossary, estimators, parameters, charts and examples, with the words around each match.

use eframe::egui::text::{LayoutJob, TextFormat, TextWrapping};
use eframe::egui::{
    self, Align, Align2, Key, Label, Layout, Modal, Modifiers, RichText, ScrollArea, Sense, TextEdit, TextStyle, Ui,
    WidgetInfo, vec2,
};
use lucide_icons::Icon;

use super::path::to_end;
use crate::paint::Theme;
use crate::paint::script::Script;
use crate::search::{Excerpt, Hit, Kind, TRANSPOSED, grouped, search, suggest};
use crate::ui::commands::{Action, Actions};
use crate::ui::drawing::style;
use crate::ui::parts::widgets;

/// Number of hits of a kind that are listed initially.
const MOST: usize = 6;

/// The dialog while it is open.
#[derive(Default)]
pub struct State {
    query: String,
    /// What was found for which query.
    found: Option<(String, Vec<Hit>)>,
    /// What was probably meant where nothing was found.
    meant: Option<String>,
    chosen: usize,
    /// The kinds of which all hits are listed.
    unfolded: Vec<Kind>,
    /// Whether Enter was pressed before it was there.
    is_entered: bool,
}

impl State {
    /// The dialog with something typed in it already, and Enter behind it if `is_entered`.
    pub fn asking(query: impl Into<String>, is_entered: bool) -> Self {
        Self { query: query.into(), is_entered, ..Self::default() }
    }

    /// Searches anew where something else was typed.
    fn update(&mut self) {
        if self.found.as_ref().is_none_or(|(query, _)| *query != self.query) {
            let hits = search(&self.query);
            self.meant = if hits.is_empty() { suggest(&self.query) } else { None };
            self.found = Some((self.query.clone(), hits));
            (self.chosen, self.unfolded) = (0, Vec::new());
        }
    }

    fn hits(&self) -> &[Hit] {
        self.found.as_ref().map_or(&[], |(_, hits)| hits)
    }
}

/// A line of the list.
enum Line<'a> {
    /// The heading of a kind, with its number of hits.
    Heading(Kind, usize),
    /// A hit.
    Hit(&'a Hit),
    /// More hits of a kind.
    More(Kind, usize),
    /// What was probably meant.
    Meant(&'a str),
}

impl Line<'_> {
    fn can_be_chosen(&self) -> bool {
        !matches!(self, Line::Heading(..))
    }
}

/// What is listed: the hits kind by kind, or else what was probably `meant`.
fn lines<'a>((hits, meant): (&'a [Hit], Option<&'a str>), unfolded: &[Kind]) -> Vec<Line<'a>> {
    let mut lines: Vec<_> = meant.into_iter().map(Line::Meant).collect();
    for (kind, hits) in grouped(hits) {
        // One more is no shorter than the line that hides it.
        let most = if unfolded.contains(&kind) || hits.len() <= MOST + 1 { hits.len() } else { MOST };
        lines.push(Line::Heading(kind, hits.len()));
        lines.extend(hits.iter().take(most).map(|hit| Line::Hit(hit)));
        if hits.len() > most {
            lines.push(Line::More(kind, hits.len() - most));
        }
    }
    lines
}

/// Shows the dialog; gives whether it is still open.
pub fn show(ctx: &egui::Context, state: &mut State, theme: Theme, actions: &mut Actions) -> bool {
    let size = TextStyle::Body.resolve(&ctx.global_style()).size;
    let room = ctx.content_rect().size() - vec2(64.0, 3.0 * size + 110.0);
    let id = egui::Id::unique("search");
    let area = Modal::default_area(id).anchor(Align2::CENTER_TOP, vec2(0.0, 2.0 * size)).default_height(room.y);
    let frame = egui::Frame::window(&ctx.global_style()).inner_margin(12);
    let mut is_done = false;
    let modal = Modal::new(id).area(area.fade_in(false)).frame(frame).show(ctx, |ui| {
        ui.set_width((52.0 * size).min(room.x));
        let (up, down, enter) = ui.input_mut(|i| {
            let mut hit = |key| i.consume_key(Modifiers::NONE, key);
            (hit(Key::ArrowUp), hit(Key::ArrowDown), hit(Key::Enter))
        });
        field(ui, state);
        state.update();
        let height = room.y.min(34.0 * size);
        let mut choice = None;
        ScrollArea::vertical().max_height(height).min_scrolled_height(height).auto_shrink([false, true]).show(
            ui,
            |ui| {
                ui.spacing_mut().item_spacing.y = 0.0;
                let all = lines((state.hits(), state.meant.as_deref()), &state.unfolded);
                if state.hits().is_empty() {
                    nothing(ui, state);
                }
                let count = all.iter().filter(|line| line.can_be_chosen()).count();
                let chosen =
                    (state.chosen + usize::from(down)).saturating_sub(usize::from(up)).min(count.saturating_sub(1));
                let entered = enter || state.is_entered;
                choice = list(ui, &all, theme, &Keys { chosen, is_moved: up || down, entered });
                (state.chosen, state.is_entered) = (chosen, false);
            },
        );
        match choice {
            Some(Choice::Hit(hit)) => {
                actions.ask(Action::Show(hit.target));
                is_done = true;
            }
            Some(Choice::More(kind)) => state.unfolded.push(kind),
            Some(Choice::Meant(query)) => {
                to_end(ui.ctx(), field_id(), &query);
                state.query = query;
                ui.ctx().request_repaint();
            }
            None => {}
        }
    });
    !(modal.should_close() || is_done)
}

fn field_id() -> egui::Id {
    egui::Id::unique("words to find")
}

/// The field for what is sought.
fn field(ui: &mut Ui, state: &mut State) {
    let id = field_id();
    widgets::catch_text(ui.ctx(), id, &mut state.query);
    let field = TextEdit::singleline(&mut state.query)
        .id(id)
        .hint_text("Search lessons, glossary, estimators, parameters, charts and examples…")
        .desired_width(f32::INFINITY)
        .margin(egui::Margin::symmetric(8, 8));
    let response = ui.add(field).accessible_name("Words to find");
    response.request_focus();
    if response.changed() {
        // The field shows what was typed one frame after.
        ui.ctx().request_repaint();
    }
    ui.add_space(4.0);
}

/// Why there is nothing in the list.
fn nothing(ui: &mut Ui, state: &State) {
    let text = match (state.query.trim().is_empty(), &state.meant) {
        (true, _) => "Type one word or several: all of them must occur. The beginning of a word is enough.",
        (false, Some(_)) => "Nothing has all of these words.",
        (false, None) => "Nothing has all of these words. Try fewer words, or the beginning of a word.",
    };
    ui.add_space(8.0);
    ui.label(RichText::new(text).weak());
    ui.add_space(8.0);
}

/// What the keys say.
struct Keys {
    /// The line that is chosen, of those that can be.
    chosen: usize,
    /// Whether it was just moved.
    is_moved: bool,
    /// Whether it is opened.
    entered: bool,
}

/// What was chosen.
enum Choice {
    /// To open it.
    Hit(Hit),
    /// To list the others of its kind.
    More(Kind),
    /// To search for this instead.
    Meant(String),
}

fn list(ui: &mut Ui, lines: &[Line], theme: Theme, keys: &Keys) -> Option<Choice> {
    let mut choice = None;
    let mut number = 0;
    for line in lines {
        if let Line::Heading(kind, count) = line {
            ui.add_space(8.0);
            widgets::heading(ui, &format!("{} · {count}", kind.title()));
            continue;
        }
        let lit = number == keys.chosen;
        let response = match line {
            Line::Hit(hit) => row(ui, hit, lit, theme),
            Line::More(kind, count) => {
                let (name, text) = (format!("{count} more: {}", kind.title()), format!("{count} more"));
                short(ui, (name.as_str(), RichText::new(text).small().weak()), lit, theme)
            }
            Line::Meant(query) => {
                let text = format!("Did you mean {query}?");
                short(ui, (text.as_str(), RichText::new(&text)), lit, theme)
            }
            Line::Heading(..) => continue,
        };
        if lit && keys.is_moved {
            response.scroll_to_me(None);
        }
        if response.clicked() || lit && keys.entered {
            choice = match line {
                Line::Hit(hit) => Some(Choice::Hit((*hit).clone())),
                Line::More(kind, _) => Some(Choice::More(*kind)),
                Line::Meant(query) => Some(Choice::Meant((*query).to_owned())),
                Line::Heading(..) => None,
            };
        }
        number += 1;
    }
    choice
}

/// The picture of a kind.
fn icon(kind: Kind) -> Icon {
    match kind {
        Kind::Term => Icon::BookA,
        Kind::Estimator => Icon::Grid3x3,
        Kind::Page => Icon::BookOpen,
        Kind::Parameter => Icon::SlidersHorizontal,
        Kind::Chart => Icon::ChartColumn,
        Kind::Example => Icon::Lightbulb,
    }
}

/// A hit: what it is, where it is from, and below it the words around the match.
fn row(ui: &mut Ui, hit: &Hit, lit: bool, theme: Theme) -> egui::Response {
    let small = TextStyle::Small.resolve(ui.style()).size;
    let line = ui.spacing().interact_size.y;
    let height = (line + 1.4 * small + 8.0).round();
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::click());
    let name = format!("{}, {}. {}", hit.title, hit.place, hit.excerpt.text);
    response.widget_info(|| WidgetInfo::selected(egui::Role::ListBoxOption, true, lit, &name));
    highlight(ui, rect, lit || response.hovered(), lit, theme);
    let inner = rect.shrink2(vec2(8.0, 4.0));
    let top = inner.with_max_y(inner.min.y + line);
    let mut head = widgets::inside(ui, top, Layout::left_to_right(Align::Center));
    head.label(widgets::icon(&head, icon(hit.kind)).color(style::color(theme.chrome().dim)));
    let start = head.cursor().min.x;
    head.with_layout(Layout::right_to_left(Align::Center), |ui| {
        ui.set_max_width(ui.available_width());
        let title = RichText::new(&hit.title).family(style::bold());
        let width = ui
            .painter()
            .layout_no_wrap(hit.title.clone(), TextStyle::Body.resolve(ui.style()), style::color(theme.chrome().text))
            .size()
            .x;
        let place = (ui.available_width() - width - 16.0).max(0.35 * ui.available_width());
        ui.scope(|ui| {
            ui.set_max_width(place);
            ui.add(Label::new(RichText::new(&hit.place).small().weak()).truncate().selectable(false));
        });
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
            ui.add(Label::new(title).truncate().selectable(false));
        });
    });
    let below = inner.with_min_x(start).with_min_y(top.max.y);
    let job = marked(ui, &hit.excerpt, below.width(), theme);
    let galley = ui.painter().layout_job(job);
    ui.painter().galley(below.left_top(), galley, style::color(theme.chrome().dim));
    response
}

/// A line of words alone, with its name for screen readers.
fn short(ui: &mut Ui, (name, text): (&str, RichText), lit: bool, theme: Theme) -> egui::Response {
    let height = ui.spacing().interact_size.y;
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::click());
    response.widget_info(|| WidgetInfo::selected(egui::Role::ListBoxOption, true, lit, name));
    highlight(ui, rect, lit || response.hovered(), lit, theme);
    let mut ui = widgets::inside(ui, rect.shrink2(vec2(8.0, 0.0)), Layout::left_to_right(Align::Center));
    ui.add(Label::new(text).truncate().selectable(false));
    response
}

fn highlight(ui: &Ui, rect: egui::Rect, is_seen: bool, lit: bool, theme: Theme) {
    let chrome = theme.chrome();
    if is_seen {
        let fill = if lit { chrome.selection } else { chrome.raised };
        ui.painter().rect_filled(rect, 5.0, style::color(fill));
    }
}

/// The excerpt in one line, the words that were sought in the colour of text.
fn marked(ui: &Ui, excerpt: &Excerpt, width: f32, theme: Theme) -> LayoutJob {
    let chrome = theme.chrome();
    let font = TextStyle::Small.resolve(ui.style());
    let plain = TextFormat::simple(font.clone(), style::color(chrome.dim));
    let mark = TextFormat::simple(egui::FontId::new(font.size, style::bold()), style::color(chrome.text));
    let mut job = LayoutJob { wrap: TextWrapping::truncate_at_width(width), ..LayoutJob::default() };
    let mut at = 0;
    for range in &excerpt.marks {
        append(&mut job, excerpt.text.get(at..range.start).unwrap_or_default(), &plain);
        append(&mut job, excerpt.text.get(range.clone()).unwrap_or_default(), &mark);
        at = range.end;
    }
    append(&mut job, excerpt.text.get(at..).unwrap_or_default(), &plain);
    job
}

/// Appends `text` in one format. No face of the program has the mark of transposed matrices: it is a raised T.
fn append(job: &mut LayoutJob, text: &str, format: &TextFormat) {
    for (i, words) in text.split(TRANSPOSED).enumerate() {
        if i > 0 {
            let size = Script::Super.share() * format.font_id.size;
            let font_id = egui::FontId::new(size, format.font_id.family.clone());
            job.append("T", 0.0, TextFormat { font_id, valign: Align::TOP, ..format.clone() });
        }
        job.append(words, 0.0, format.clone());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_hits_of_a_kind_are_folded_until_they_are_asked_for() {
        let mut state = State::asking("flow", false);
        state.update();
        let kinds = grouped(state.hits());
        let (kind, count) = kinds.iter().map(|(kind, hits)| (*kind, hits.len())).max_by_key(|(_, n)| *n).expect("hits");
        assert!(count > MOST + 1);
        let listed =
            |lines: &[Line]| lines.iter().filter(|line| matches!(line, Line::Hit(hit) if hit.kind == kind)).count();
        let folded = lines((state.hits(), None), &[]);
        assert_eq!(listed(&folded), MOST);
        assert!(folded.iter().any(|line| matches!(line, Line::More(of, more) if *of == kind && *more == count - MOST)));
        assert_eq!(listed(&lines((state.hits(), None), &[kind])), count);
    }

    #[test]
    fn transposed_matrices_have_a_raised_t() {
        let mut job = LayoutJob::default();
        let format = TextFormat::simple(egui::FontId::proportional(20.0), egui::Color32::WHITE);
        append(&mut job, "S = H P Hᵀ + R", &format);
        assert_eq!(job.text, "S = H P HT + R");
        let raised: Vec<_> = job.sections.iter().filter(|section| section.format.valign == Align::TOP).collect();
        assert_eq!(raised.len(), 1);
        assert!(raised[0].format.font_id.size < 20.0 && raised[0].leading_space == 0.0);
    }

    #[test]
    fn a_suggestion_goes_once_anything_is_found() {
        let mut state = State::asking("gradiant", false);
        state.update();
        assert!(state.hits().is_empty() && state.meant.is_some());
        state.query = state.meant.clone().unwrap_or_default();
        state.update();
        assert!(!state.hits().is_empty() && state.meant.is_none());
    }

    #[test]
    fn another_query_begins_at_its_first_hit() {
        let mut state = State::asking("gradient", false);
        state.update();
        (state.chosen, state.unfolded) = (5, vec![Kind::Term]);
        state.query = "gain".to_owned();
        state.update();
        assert!(state.chosen == 0 && state.unfolded.is_empty() && !state.hits().is_empty());
    }
}
