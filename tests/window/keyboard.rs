//! The window without a mouse: the way of Tab and F6, the ring around what has the keyboard, definitions, and names for screen readers.

use eframe::egui::accesskit::Action;
use eframe::egui::{Color32, Shape};
use motionscope_core::course::glossary::find as term;

use super::*;

/// The panes in the order of Tab.
const ORDER: [Region; 10] = [
    Region::Header,
    Region::Stage,
    Region::Question,
    Region::Lesson,
    Region::Explanation,
    Region::Strip,
    Region::Chart,
    Region::Parameters,
    Region::Transport,
    Region::Status,
];

impl Window {
    /// Where the widget lies that has the keyboard.
    fn focused(&self) -> Option<Rect> {
        let ctx = &self.harness.ctx;
        ctx.memory(|memory| memory.focused()).and_then(|id| ctx.read_response(id)).map(|response| response.rect)
    }

    /// The pane to which a place belongs: small pictures lie beside the stage, next to what is told.
    fn pane(&self, at: Pos2) -> Option<Region> {
        let panes = self.app().regions().iter().filter(|(region, _)| ORDER.contains(region));
        let far = |rect: &Rect| rect.distance_sq_to_pos(at);
        panes.min_by(|(_, a), (_, b)| far(a).total_cmp(&far(b))).map(|(region, _)| *region)
    }

    /// Everything that Tab leads to from the first widget on, once round.
    fn tab_stops(&mut self) -> Vec<Rect> {
        let mut stops: Vec<Rect> = Vec::new();
        for _ in 0..200 {
            self.key(Key::Tab);
            let Some(now) = self.focused() else { break };
            if stops.first() == Some(&now) {
                return stops;
            }
            stops.push(now);
        }
        panic!("Tab leads nowhere: {stops:?}");
    }

    /// The rings of two points in the colour of the keyboard.
    fn rings(&self) -> usize {
        let [r, g, b, _] = self.app().settings().look.theme.chrome().accent.0;
        let is_ring = |shape: &Shape| {
            matches!(shape, Shape::Rect(rect) if rect.stroke.width == 2.0
                && rect.stroke.color == Color32::from_rgb(r, g, b))
        };
        self.harness.output().shapes.iter().filter(|clipped| is_ring(&clipped.shape)).count()
    }
}

#[test]
fn tab_leads_through_the_panes_as_one_reads() {
    for (size, theme) in [(vec2(1280.0, 720.0), Command::ProjectorTheme), (vec2(1440.0, 900.0), Command::DarkTheme)] {
        let mut window = Window::new(size);
        window.command(theme);
        let stops = window.tab_stops();
        let places: Vec<_> = stops
            .iter()
            .map(|stop| window.pane(stop.center()).and_then(|pane| ORDER.iter().position(|other| *other == pane)))
            .collect();
        assert!(places.iter().all(Option::is_some), "{stops:?}");
        assert!(places.is_sorted(), "{places:?}");
        for wanted in [Region::Header, Region::Stage, Region::Transport] {
            let place = ORDER.iter().position(|other| *other == wanted);
            assert!(places.contains(&place), "{wanted:?} is passed by");
        }
        for (stops, places) in stops.windows(2).zip(places.windows(2)).filter(|(_, places)| places[0] == places[1]) {
            let [a, b] = [stops[0], stops[1]];
            let is_same_row = a.y_range().contains(b.center().y) && b.y_range().contains(a.center().y);
            assert!(!is_same_row || a.min.x <= b.min.x, "{a} before {b} in pane {:?}", places[0]);
        }
        window.press(Modifiers::SHIFT, Key::Tab);
        window.press(Modifiers::SHIFT, Key::Tab);
        assert_eq!(window.focused(), stops.iter().rev().nth(1).copied(), "with Shift back");
    }
}

#[test]
fn one_ring_stands_around_whatever_has_the_keyboard() {
    let mut window = Window::new(vec2(1280.0, 720.0));
    for theme in [Command::ProjectorTheme, Command::LightTheme, Command::DarkTheme] {
        window.command(theme);
        assert_eq!(window.rings(), usize::from(window.focused().is_some()));
        for _ in 0..40 {
            window.key(Key::Tab);
            assert_eq!(window.rings(), 1, "{theme:?}: {:?}", window.focused());
        }
    }
    window.command(Command::Open);
    assert_eq!(window.rings(), 1, "the field of a dialog has it as well");
}

#[test]
fn f6_leads_from_pane_to_pane() {
    let mut window = Window::usual();
    let mut panes = Vec::new();
    for _ in 0..12 {
        window.key(Key::F6);
        let at = window.focused().expect("something has the keyboard").center();
        panes.push(window.pane(at).expect("it lies in a pane"));
    }
    let round = panes.iter().skip(1).position(|pane| *pane == panes[0]).expect("it comes round") + 1;
    let expected: Vec<_> = ORDER.into_iter().filter(|pane| panes.contains(pane)).collect();
    assert_eq!(panes[..round], expected);
    assert!(round >= 5, "{panes:?}");
    let last = panes[11];
    window.key(Key::F6);
    window.press(Modifiers::SHIFT, Key::F6);
    assert_eq!(window.focused().and_then(|rect| window.pane(rect.center())), Some(last));
}

#[test]
fn a_term_that_has_the_keyboard_is_defined() {
    let mut window = Window::usual();
    let words = window.harness.query_all_by_role(Role::Term).filter_map(|node| node.accesskit_node().label());
    let name = words.into_iter().next().expect("a sentence has terms");
    let definition = term(&name).expect("it is in the glossary").definition;
    let start: String = definition.split([',', '.']).next().expect("it has words").to_owned();
    assert!(window.harness.query_by_label_contains(&start).is_none());
    window.harness.query_all_by_role(Role::Term).next().expect("a term").focus();
    window.settle();
    assert!(window.harness.query_by_label_contains(&start).is_some(), "{name}: {start}");
    window.key(Key::F6);
    assert!(window.harness.query_by_label_contains(&start).is_none(), "it closes where the keyboard leaves");
}

/// The interactive widgets without a name, in words.
fn nameless(window: &Window) -> Vec<String> {
    let roles = [
        Role::Button,
        Role::CheckBox,
        Role::RadioButton,
        Role::Slider,
        Role::SpinButton,
        Role::ComboBox,
        Role::TextInput,
        Role::MultilineTextInput,
        Role::Link,
        Role::Tab,
        Role::MenuItem,
        Role::ListBoxOption,
    ];
    let is_nameless = |node: &egui_kittest::Node<'_>| {
        let of = node.accesskit_node();
        let acts = [Action::Click, Action::Focus, Action::SetValue]
            .into_iter()
            .any(|action| of.data().supports_action(action));
        let is_named = of.label().is_some_and(|label| !label.trim().is_empty());
        // A label is its own name, and a bar for scrolling that of its pane.
        let needs_none = [Role::Label, Role::ScrollBar].contains(&of.role());
        (acts || roles.contains(&of.role())) && !needs_none && !is_named
    };
    let nodes = window.harness.root().children_recursive().filter(is_nameless);
    nodes.map(|node| format!("{:?} at {}", node.accesskit_node().role(), node.rect())).collect()
}

#[test]
fn every_widget_that_can_be_used_has_a_name() {
    let size = vec2(1440.0, 900.0);
    let mut found = Vec::new();
    let mut look = |window: &Window, what: &str| {
        found.extend(nameless(window).into_iter().map(|node| format!("{what}: {node}")));
    };
    let mut window = Window::usual();
    look(&window, "main");
    window.unfold();
    look(&window, "advanced parameters");
    for command in [
        Command::Palette,
        Command::SearchText,
        Command::Glossary,
        Command::Shortcuts,
        Command::Open,
        Command::ExportPicture,
        Command::ExportSteps,
        Command::ExportResult,
        Command::Samples,
        Command::Lessons,
        Command::Compare,
        Command::About,
    ] {
        window.command(command);
        look(&window, &format!("{command:?}"));
        window.key(Key::Escape);
    }
    for menu in Menu::ALL {
        window.click_role(Role::Button, menu.name());
        look(&window, menu.name());
        window.key(Key::Escape);
    }
    for command in [Command::Predict, Command::Over, Command::Lockstep, Command::Pen, Command::Present] {
        window.command(command);
        look(&window, &format!("{command:?}"));
    }
    for open in ["lesson:sequential-search/3", "synth:traffic", "synth:drive"] {
        let window = Window::with(size, Start { open: Some(open.into()) });
        look(&window, open);
    }
    look(&Window::begun(size, Start::default(), None), "start page");
    assert!(found.is_empty(), "{}", found.join("\n"));
}
