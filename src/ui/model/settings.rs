//! What the window remembers from one day to the next.

use std::path::{Path, PathBuf};

use eframe::egui::Vec2;
use motionscope_core::run::AnyEstimator;
use serde::{Deserialize, Serialize};

use super::chosen_charts::ChosenCharts;
use super::player::Player;
use super::practice::Practice;
use crate::files;
use crate::media::camera::Size;
use crate::paint::View;
use crate::session::lesson::Address;
use crate::ui::drawing::style::{Interface, ZOOM};
use crate::ui::layout::{self, Folded, Mode, Pane, SHARES, Shares};
use crate::view::look::Look;

/// Clips that are remembered.
const RECENT: usize = 12;
/// The key under which everything is stored.
const KEY: &str = "motionscope";

/// What is folded away by default in a working layout too narrow for the parameters.
const NARROW: Folded = Folded { parameters: true, explanation: false, charts: false };
/// Panes folded away by default in a lecture, where sentence and formula need the room.
const LECTURE: Folded = Folded { parameters: true, explanation: true, charts: false };

/// Clips of which is remembered where they were left.
const LEFT: usize = 40;

/// Where a clip was left.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LeftAt {
    /// The clip, as a session names it.
    pub clip: String,
    /// The estimator with its parameters.
    pub run: String,
    /// Frame t of the run, from 0.
    pub frame: usize,
    /// The step.
    pub step: String,
}

impl LeftAt {
    /// An estimator with its parameters, as text that says whether another is the same.
    pub fn run_of(estimator: &dyn AnyEstimator) -> String {
        let values = estimator.all_values().into_iter().map(|(name, value)| format!(" {name}={value}"));
        format!("{}{}", estimator.info().id, values.collect::<String>())
    }
}

/// What was chosen for the camera.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct CameraChoices {
    /// The name of the camera, if one was chosen.
    pub device: Option<String>,
    /// Width and height of the frames in px.
    pub size: Size,
    /// Duration of a recording in seconds.
    pub seconds: u32,
    /// The id of the estimator that runs on the camera, if one does.
    pub estimator: Option<String>,
    /// Whether a countdown precedes a recording.
    pub has_countdown: bool,
}

impl Default for CameraChoices {
    fn default() -> Self {
        Self { device: None, size: Size::default(), seconds: 3, estimator: None, has_countdown: true }
    }
}

/// What is remembered.
#[derive(Clone, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// How pictures look, on the stage and written.
    pub look: Look,
    /// Interface scale: what fits one screen would be all wrong on the next.
    #[serde(skip)]
    zoom: f32,
    /// Whether things change at once.
    pub reduced_motion: bool,
    /// What is folded away in the working layout.
    folded: Folded,
    /// What is folded away in a narrow working layout.
    folded_narrow: Folded,
    /// What is folded away in a lecture.
    folded_lecture: Folded,
    /// Whether the window is in the lecture layout: over when it closes.
    #[serde(skip)]
    pub lecture: bool,
    /// Clips that were open lately, the last one first.
    pub recent: Vec<PathBuf>,
    /// Where clips were left, the last one first.
    left: Vec<LeftAt>,
    /// Whether a start without a clip shows the start page.
    pub has_start_page: bool,
    /// What was tried of stepping.
    pub practice: Practice,
    /// What was chosen for the camera.
    pub camera: CameraChoices,
    /// The address that copied links lead to, if it is not the published page.
    pub link_base: Option<String>,
    /// How fast to play.
    pub speed: usize,
    /// How the person has shared out the room.
    pub shares: Shares,
    /// Which charts are looked at.
    pub charts: ChosenCharts,
    /// How the panes are arranged in the window as it is.
    #[serde(skip)]
    pub mode: Option<Mode>,
    /// Whether the parameters have no place of their own in the window as it is.
    #[serde(skip)]
    pub is_narrow: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            look: Look::of_window(),
            zoom: 1.0,
            reduced_motion: false,
            folded: Folded::default(),
            folded_narrow: NARROW,
            folded_lecture: LECTURE,
            lecture: false,
            recent: Vec::new(),
            left: Vec::new(),
            has_start_page: true,
            practice: Practice::default(),
            camera: CameraChoices::default(),
            link_base: None,
            speed: Player::default().speed,
            shares: Shares::default(),
            charts: ChosenCharts::default(),
            mode: None,
            is_narrow: false,
        }
    }
}

impl Settings {
    /// What was remembered, or the settings of the first start.
    pub fn load(storage: Option<&dyn eframe::Storage>) -> Self {
        let mut settings: Self = storage.and_then(|storage| eframe::get_value(storage, KEY)).unwrap_or_default();
        let Shares { column, charts, parameters } = &mut settings.shares;
        for share in [column, charts, parameters] {
            *share = if share.is_finite() { share.clamp(*SHARES.start(), *SHARES.end()) } else { 1.0 };
        }
        // Frame t alone belonged to an estimator of single frames; a start opens one of pairs.
        if settings.look.view == Some(View::Current) {
            settings.look.view = Some(View::default());
        }
        settings
    }

    /// Remembers everything.
    pub fn save(&self, storage: &mut dyn eframe::Storage) {
        eframe::set_value(storage, KEY, self);
    }

    /// Both frames, where what a run has made of them was seen: another clip is not at its end yet.
    pub fn leave_end(&mut self) {
        if self.look.view.is_some_and(View::is_of_the_end) {
            self.look.view = Some(View::default());
        }
    }

    /// What is folded away in the window as it is.
    pub fn folded(&self) -> Folded {
        match self.mode {
            // A frame in another page has no menus to bring something back with.
            Some(Mode::Embedded) => LECTURE,
            Some(mode) if mode.is_lecture() => self.folded_lecture,
            _ if self.is_narrow => self.folded_narrow,
            _ => self.folded,
        }
    }

    /// Folds the parameters away where they have the place of the words.
    pub fn fold_parameters(&mut self) {
        if self.mode.is_some_and(Mode::is_lecture) || self.is_narrow {
            self.folded_mut().parameters = true;
        }
    }

    fn folded_mut(&mut self) -> &mut Folded {
        match self.mode {
            Some(mode) if mode.is_lecture() => &mut self.folded_lecture,
            _ if self.is_narrow => &mut self.folded_narrow,
            _ => &mut self.folded,
        }
    }

    /// Folds `pane` away or brings it back.
    pub fn toggle(&mut self, pane: Pane) {
        let folded = self.folded_mut();
        let folded = match pane {
            Pane::Parameters => &mut folded.parameters,
            Pane::Explanation => &mut folded.explanation,
            Pane::Charts => &mut folded.charts,
        };
        *folded = !*folded;
    }

    /// Gives every pane its default place and size.
    pub fn reset_layout(&mut self) {
        let Self { folded, folded_narrow, folded_lecture, lecture, shares, charts, .. } = Self::default();
        (self.folded, self.folded_narrow, self.folded_lecture) = (folded, folded_narrow, folded_lecture);
        (self.lecture, self.shares, self.charts) = (lecture, shares, charts);
    }

    /// Interface scale.
    pub fn zoom(&self) -> f32 {
        self.zoom
    }

    /// Returns the interface scale that is seen where the window is zoomed by `factor`.
    pub fn seen_zoom(&self, factor: f32) -> f32 {
        self.zoom.min(factor / self.mode.map_or(1.0, layout::Mode::zoom))
    }

    /// Takes another interface scale, within bounds.
    pub fn set_zoom(&mut self, zoom: f32) {
        let (least, most, step) = ZOOM;
        let rounded = (zoom / step).round() * step;
        self.zoom = if rounded.is_finite() { rounded.clamp(least, most) } else { 1.0 };
    }

    /// How large and how lively a window of `size` points at scale 1 is.
    pub fn interface(&self, size: Vec2) -> Interface {
        let mode = self.mode.unwrap_or(layout::Mode::Working);
        let zoom = layout::zoom_that_fits(self.zoom * mode.zoom(), size, self.look.theme.sizes().body, mode);
        Interface { theme: self.look.theme, zoom, reduced_motion: self.reduced_motion }
    }

    /// Puts a clip at the front of those that were open lately, unless its name is no Unicode: what is remembered is text.
    pub fn remember(&mut self, path: &Path) {
        // A file given to a page cannot be opened again later.
        if path.to_str().is_none() || files::is_in_memory(path) {
            return;
        }
        let path = files::absolute(path);
        self.recent.retain(|other| *other != path);
        self.recent.insert(0, path);
        self.recent.truncate(RECENT);
    }

    /// Puts the page of a bundled lesson at the front of what was open lately, instead of its other pages.
    pub fn remember_page(&mut self, page: &Address) {
        let is_of_lesson = |path: &PathBuf| {
            Address::parse(path.as_os_str()).is_some_and(|other| other.file().is_none() && other.lesson == page.lesson)
        };
        self.recent.retain(|other| !is_of_lesson(other));
        self.recent.insert(0, page.name().into());
        self.recent.truncate(RECENT);
    }

    /// Remembers where a clip was left.
    pub fn leave(&mut self, at: LeftAt) {
        self.left.retain(|other| other.clip != at.clip);
        self.left.insert(0, at);
        self.left.truncate(LEFT);
    }

    /// Where `clip` was left, if that is known.
    pub fn left_at(&self, clip: &str) -> Option<&LeftAt> {
        self.left.iter().find(|at| at.clip == clip)
    }

    /// Forgets a clip that is not there any more.
    pub fn forget(&mut self, path: &Path) {
        self.recent.retain(|other| other != path);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::{ColorMap, Lengthen, Theme};

    #[test]
    fn what_is_remembered_comes_back() {
        let mut settings = Settings::default();
        settings.look = Look { theme: Theme::Projector, colors: ColorMap::Turbo, ..settings.look };
        settings.look.arrow_scale = Lengthen::Times(4.0);
        settings.set_zoom(99.0);
        settings.remember(Path::new("/a.mp4"));
        settings.remember(Path::new("/b.mp4"));
        #[cfg(unix)]
        settings.remember(Path::new(<std::ffi::OsStr as std::os::unix::ffi::OsStrExt>::from_bytes(b"/caf\xE9.mp4")));
        settings.remember(Path::new("/a.mp4"));
        settings.camera.estimator = Some("diamond".into());
        settings.camera.has_countdown = false;
        let text = serde_json::to_string(&settings).unwrap();
        let back: Settings = serde_json::from_str(&text).unwrap();
        assert_eq!((settings.zoom(), back.zoom()), (ZOOM.1, 1.0), "the next screen may be another");
        assert_eq!((back.look, &back.camera), (settings.look, &settings.camera));
        assert_eq!(back.recent, [PathBuf::from("/a.mp4"), PathBuf::from("/b.mp4")]);
    }

    #[test]
    fn an_older_file_still_opens() {
        for text in ["{\"theme\":\"Sepia\"}", "{\"look\":{\"theme\":\"sepia\"}}"] {
            let old: Settings = serde_json::from_str(text).unwrap();
            assert_eq!(old.look, Look::of_window());
        }
    }
}
