//! The session file, `*.motionscope`: a small text that reopens exactly what was on the screen.
//!
//! ```toml
//! motionscope = 1
//! clip = "clips/ball.mp4"          # beside the session file, or synth:NAME,SLIDER=VALUE
//! estimator = "full-search"
//! pace = "block"                   # of those in lockstep: the same block, or the same budget
//! frame = 12
//! step = "35.412"
//! pixel = "303,202"                # the one that is held to be explained by itself
//!
//! [set]
//! block = 8
//!
//! [[beside]]                       # up to three more, which go in lockstep with it
//! estimator = "hierarchical"
//! set = { levels = 4 }             # what it does not share with the first
//!
//! [picture]
//! view = "side-by-side"
//! layer = "error"                  # the colours that tell of motion
//! ```

mod read;
mod toml_text;

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::{Component, Path, PathBuf};

use motionscope_core::params::Parameter;
use motionscope_core::{AnyEstimator, Cursor, Error, Pace, Value};
use serde::Serialize;

use crate::experiment::company::Company;
use crate::experiment::pixel::Pixel;
use crate::experiment::source::Source;
use crate::media::{self, export};
use crate::paint::{ColorMap, FlowLayer, Lengthen, LevelShown, Opacity, Phase, Share, Theme, View};
use crate::view::shot::Look;

/// The version of the format that is written.
const VERSION: u32 = 1;
/// The ending of a session file's name.
pub const EXTENSION: &str = "motionscope";

/// Everything that a session keeps.
pub struct Session {
    /// Where the clip comes from.
    pub source: Source,
    /// Truth given by hand.
    pub truth: Option<PathBuf>,
    /// The estimator with its parameters.
    pub estimator: Box<dyn AnyEstimator>,
    /// Who goes in lockstep with it.
    pub company: Company,
    /// Frame t.
    pub frame: usize,
    /// Where the run stands; `None` for its end.
    pub cursor: Option<Cursor>,
    /// The pixel that is held to be explained by itself.
    pub pixel: Option<Pixel>,
    /// How it is looked at.
    pub look: Wanted,
    /// Which part of the picture is seen, if not all of it.
    pub sight: Option<Sight>,
}

/// What a person called a clip: the clip itself, or a session that leads to it.
pub struct Named {
    /// Where the clip comes from.
    pub source: Source,
    /// Its truth, if that was given by hand.
    pub truth: Option<PathBuf>,
    /// The session, if one was named.
    pub session: Option<Session>,
}

impl Named {
    /// What `name` stands for; `truth` overrides that of a session.
    ///
    /// # Errors
    /// If it is a session that cannot be read, or a scene that does not exist.
    pub fn find(name: &OsStr, truth: Option<PathBuf>) -> Result<Self, Error> {
        if !Session::is_named(Path::new(name)) {
            return Ok(Self { source: Source::parse(name)?, truth, session: None });
        }
        let session = Session::load(Path::new(name))?;
        let truth = truth.or_else(|| session.truth.clone());
        Ok(Self { source: session.source.clone(), truth, session: Some(session) })
    }
}

/// How a session is looked at; what it does not say is left to whoever opens it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wanted {
    /// The view.
    pub view: Option<View>,
    /// Which level of a pyramid is seen.
    pub level: Option<LevelShown>,
    /// The share of frame t + 1 in a blend.
    pub share: Option<Share>,
    /// Colours and sizes.
    pub theme: Option<Theme>,
    /// Colours of heat.
    pub colors: Option<ColorMap>,
    /// The layer of colours that tells of motion.
    pub layer: Option<FlowLayer>,
    /// How opaque that is.
    pub opacity: Option<Opacity>,
    /// How long displacements are drawn.
    pub lengthen: Option<Lengthen>,
    /// From one displacement to the next in px.
    pub spacing_px: Option<u16>,
    /// The moment at which streaklines are seen.
    pub streaks: Option<Phase>,
    /// Whether what the marks mean stands below.
    pub legend: Option<bool>,
    /// Whether estimator, parameters and sentence stand around the pictures.
    pub caption: Option<bool>,
}

impl Wanted {
    /// What is wanted, and for the rest what is usual.
    pub fn over(self, usual: Look) -> Look {
        Look {
            view: self.view.or(usual.view),
            level: self.level.unwrap_or(usual.level),
            share: self.share.unwrap_or(usual.share),
            theme: self.theme.unwrap_or(usual.theme),
            colors: self.colors.unwrap_or(usual.colors),
            layer: self.layer.or(usual.layer),
            opacity: self.opacity.or(usual.opacity),
            lengthen: self.lengthen.unwrap_or(usual.lengthen),
            spacing_px: self.spacing_px.or(usual.spacing_px),
            streaks: self.streaks.or(usual.streaks),
            legend: self.legend.unwrap_or(usual.legend),
            caption: self.caption.unwrap_or(usual.caption),
        }
    }
}

impl From<Look> for Wanted {
    fn from(look: Look) -> Self {
        let Look { view, level, share, theme, colors, layer, opacity, .. } = look;
        let Look { lengthen, spacing_px, streaks, legend, caption, .. } = look;
        Self {
            view,
            layer,
            opacity,
            spacing_px,
            streaks,
            level: Some(level),
            share: Some(share),
            theme: Some(theme),
            colors: Some(colors),
            lengthen: Some(lengthen),
            legend: Some(legend),
            caption: Some(caption),
        }
    }
}

/// The part of the picture that is seen on the stage.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Sight {
    /// The pixel in the middle of the stage.
    pub center: [f32; 2],
    /// Points per pixel.
    pub zoom: f32,
}

impl Sight {
    fn is_sound(&self) -> bool {
        self.center.iter().all(|c| c.abs() < 1e6) && (1e-3..=1e3).contains(&self.zoom)
    }
}

/// The file as it is written.
#[derive(Serialize)]
struct Text {
    motionscope: u32,
    clip: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    truth: Option<String>,
    estimator: String,
    frame: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    step: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pixel: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pace: Option<String>,
    set: BTreeMap<String, toml::Value>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    beside: Vec<Companion>,
    picture: Picture,
    #[serde(skip_serializing_if = "Option::is_none")]
    sight: Option<Sight>,
}

/// An estimator in lockstep with the first, and what it does not share with that.
#[derive(Serialize)]
struct Companion {
    estimator: String,
    set: BTreeMap<String, toml::Value>,
}

impl Companion {
    fn of(estimator: &dyn AnyEstimator, leader: &dyn AnyEstimator) -> Self {
        let own = estimator.values().into_iter().filter(|(name, _)| leader.get(name).is_err());
        Self {
            estimator: estimator.info().id.into(),
            set: own.map(|(name, value)| (name.to_string(), told(value))).collect(),
        }
    }
}

#[derive(Serialize)]
struct Picture {
    #[serde(skip_serializing_if = "Option::is_none")]
    view: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    level: Option<Level>,
    /// The share of frame t + 1 in a blend.
    #[serde(skip_serializing_if = "Option::is_none")]
    blend: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    theme: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    colors: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    layer: Option<String>,
    /// How far that hides the picture.
    #[serde(rename = "layer-opacity", skip_serializing_if = "Option::is_none")]
    layer_opacity: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    arrows: Option<Arrows>,
    /// From one arrow to the next in px.
    #[serde(rename = "arrow-spacing", skip_serializing_if = "Option::is_none")]
    arrow_spacing: Option<i64>,
    /// The moment at which streaklines are seen.
    #[serde(skip_serializing_if = "Option::is_none")]
    streaks: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    legend: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    caption: Option<bool>,
}

/// A level of a pyramid by its number, or `at-work`.
#[derive(Serialize)]
#[serde(untagged)]
enum Level {
    Number(usize),
    Named(String),
}

impl Level {
    fn of(shown: LevelShown) -> Self {
        match shown {
            LevelShown::Number(level) => Self::Number(level),
            LevelShown::AtWork => Self::Named(shown.to_string()),
        }
    }
}

/// How many times their length displacements are drawn, or `auto`.
#[derive(Serialize)]
#[serde(untagged)]
enum Arrows {
    Times(f32),
    Named(String),
}

/// What displacements can be lengthened by: beyond, nothing is left to see.
const LENGTHEN: std::ops::RangeInclusive<f32> = 0.01..=100.0;

/// So many times as long, if displacements can be drawn so.
fn stretch(factor: Option<f32>) -> Result<Lengthen, Error> {
    let (least, most) = (LENGTHEN.start(), LENGTHEN.end());
    let told = || Error::new(format!("arrows can be drawn {least} to {most} times as long, or auto"));
    factor.filter(|factor| LENGTHEN.contains(factor)).map(Lengthen::Times).ok_or_else(told)
}

/// How long displacements are drawn, as `auto` or a factor.
///
/// # Errors
/// A sentence with the factors that there may be.
pub fn lengthen(text: &str) -> Result<Lengthen, Error> {
    if text == "auto" { Ok(Lengthen::Auto) } else { stretch(text.parse().ok()) }
}

/// How far displacements may be from each other, in px.
pub const SPACING_PX: std::ops::RangeInclusive<u16> = 1..=256;

/// The distance of displacements in px.
///
/// # Errors
/// A sentence with those that there may be.
pub fn spacing_px(px: i64) -> Result<u16, Error> {
    let (least, most) = (SPACING_PX.start(), SPACING_PX.end());
    let told = || Error::new(format!("arrows can be {least} to {most} px from each other, and not {px}"));
    u16::try_from(px).ok().filter(|px| SPACING_PX.contains(px)).ok_or_else(told)
}

impl Session {
    /// Whether `path` is called like a session.
    pub fn is_named(path: &Path) -> bool {
        path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(EXTENSION))
    }

    /// Reads the session in `path`; the clip is not opened.
    ///
    /// # Errors
    /// One sentence that names the file, tells what is wrong and what to do.
    pub fn load(path: &Path) -> Result<Self, Error> {
        let name = Error::short_name(&path.display().to_string());
        let about = |error: String| Error::new(format!("cannot open the session {name}: {error}"));
        let text = media::read_text(path).map_err(|error| about(error.to_string()))?;
        Self::parse(&text, folder_of(path)).map_err(|error| about(error.to_string()))
    }

    /// Reads a session whose paths are told from `folder`.
    ///
    /// # Errors
    /// If the text is no session, or names what does not exist.
    pub fn parse(text: &str, folder: &Path) -> Result<Self, Error> {
        read::session(text, folder)
    }

    /// Writes the session to `path`, whole or not at all.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn save(&self, path: &Path) -> Result<(), Error> {
        export::save(path, self.text(folder_of(path))?.as_bytes())
    }

    /// The text of a session file in `folder`.
    ///
    /// # Errors
    /// If it cannot be told as TOML, or the name of the clip or its truth is no Unicode.
    pub fn text(&self, folder: &Path) -> Result<String, Error> {
        let beside = |path: &Path| relative(path, folder);
        let set = self.estimator.all_values().into_iter().map(|(name, value)| (name, told(value))).collect();
        let text = Text {
            motionscope: VERSION,
            clip: match self.source.clone().map_path(beside) {
                Source::File(path) => slashed(&path)?,
                synth => synth.to_string(),
            },
            truth: self.truth.as_deref().map(|path| slashed(&relative(path, folder))).transpose()?,
            estimator: self.estimator.info().id.into(),
            frame: self.frame,
            step: self.cursor.map(|cursor| cursor.to_string()),
            pixel: self.pixel.map(|pixel| pixel.to_string()),
            pace: (!self.company.is_empty()).then(|| self.company.pace.to_value().to_string()),
            set,
            beside: self.company.beside.iter().map(|one| Companion::of(&**one, &*self.estimator)).collect(),
            picture: Picture::of(&self.look),
            sight: self.sight,
        };
        toml::to_string(&text).map_err(|error| Error::new(format!("the session cannot be written: {error}")))
    }
}

impl Picture {
    fn of(look: &Wanted) -> Self {
        Self {
            view: look.view.map(|view| view.id().into()),
            level: look.level.map(Level::of),
            blend: look.share.map(Share::get),
            theme: look.theme.map(|theme| theme.name().to_lowercase()),
            colors: look.colors.map(|colors| colors.name().to_lowercase()),
            layer: look.layer.map(|layer| layer.id().into()),
            layer_opacity: look.opacity.map(Opacity::get),
            arrow_spacing: look.spacing_px.map(i64::from),
            streaks: look.streaks.map(Phase::get),
            arrows: look.lengthen.map(|lengthen| match lengthen {
                Lengthen::Auto => Arrows::Named("auto".into()),
                Lengthen::Times(factor) => Arrows::Times(factor),
            }),
            legend: look.legend,
            caption: look.caption,
        }
    }
}

/// The view called `id`.
///
/// # Errors
/// A sentence with the views there are.
pub fn view(id: &str) -> Result<View, Error> {
    named("view", id, View::ALL.map(|view| (view.id().to_string(), view)))
}

/// The pace called `id`.
///
/// # Errors
/// A sentence with the paces there are.
pub fn pace(id: &str) -> Result<Pace, Error> {
    named("pace", id, [Pace::Block, Pace::Budget].map(|pace| (pace.to_value().to_string(), pace)))
}

/// The theme called `id`.
///
/// # Errors
/// A sentence with the themes there are.
pub fn theme(id: &str) -> Result<Theme, Error> {
    named("theme", id, Theme::ALL.map(|theme| (theme.name().to_lowercase(), theme)))
}

/// The colour map called `id`.
///
/// # Errors
/// A sentence with the colour maps there are.
pub fn colors(id: &str) -> Result<ColorMap, Error> {
    named("colour map", id, ColorMap::ALL.map(|colors| (colors.name().to_lowercase(), colors)))
}

fn named<T: Copy, const N: usize>(kind: &str, id: &str, all: [(String, T); N]) -> Result<T, Error> {
    all.iter().find(|(name, _)| name == id).map(|(_, value)| *value).ok_or_else(|| {
        let names: Vec<_> = all.iter().map(|(name, _)| name.as_str()).collect();
        Error::new(format!("there is no {kind} {id}; there are {}", names.join(", ")))
    })
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// `path` as told from `folder`: with `..` where needed, whole where the two have nothing in common.
fn relative(path: &Path, folder: &Path) -> PathBuf {
    // What exists is looked up, so that links and `..` lead where they lead; the rest is told by its parts.
    let whole = |path: &Path| {
        let whole = path.canonicalize().or_else(|_| std::path::absolute(path)).unwrap_or_else(|_| path.to_path_buf());
        whole.components().fold(PathBuf::new(), |mut whole, part| {
            match part {
                Component::ParentDir => drop(whole.pop()),
                Component::CurDir => {}
                part => whole.push(part),
            }
            whole
        })
    };
    let (path, folder) = (whole(path), whole(folder));
    let (parts, folders): (Vec<_>, Vec<_>) = (path.components().collect(), folder.components().collect());
    let common = parts.iter().zip(&folders).take_while(|(a, b)| a == b).count();
    if common == 0 {
        return path;
    }
    let up = folders[common..].iter().map(|_| Component::ParentDir);
    up.chain(parts[common..].iter().copied()).collect()
}

/// Written alike on every system.
fn slashed(path: &Path) -> Result<String, Error> {
    let text = path.to_str().ok_or_else(|| {
        Error::new(format!("a session cannot name {}, which is no Unicode; rename the file", path.display()))
    })?;
    Ok(if std::path::MAIN_SEPARATOR == '\\' { text.replace('\\', "/") } else { text.into() })
}

fn told(value: Value) -> toml::Value {
    match value {
        Value::Int(v) => v.into(),
        Value::Real(v) => v.into(),
        Value::Switch(v) => v.into(),
        Value::Choice(v) => v.into(),
        Value::Placed(v) => v.to_string().into(),
        Value::Stage(v) => v.id().into(),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use motionscope_core::estimator;

    use super::*;

    fn session(source: Source) -> Session {
        let mut estimator = estimator("full-search").unwrap();
        estimator.set("block", "8").unwrap();
        estimator.set("early-exit", "on").unwrap();
        let mut company = Company::of(&*estimator, &["diamond", "hierarchical"], Pace::Budget).unwrap();
        company.set(&mut *estimator, "hierarchical.levels=4").unwrap();
        let share = Share::new(0.8).unwrap();
        let level = LevelShown::Number(2);
        let look =
            Look { view: Some(View::Blend), level, share, theme: Theme::Projector, legend: true, ..Look::default() };
        let sight = Some(Sight { center: [10.5, 3.0], zoom: 4.0 });
        let (cursor, pixel) = (Some(Cursor { unit: 35, event: 412 }), Some("303,202".parse().expect("a pixel")));
        Session { source, truth: None, estimator, company, frame: 12, cursor, pixel, look: look.into(), sight }
    }

    #[test]
    fn what_was_saved_opens_exactly() {
        let folder = tempfile::tempdir().unwrap();
        let clip = folder.path().join("clips").join("a.mp4");
        let path = folder.path().join("lessons").join("one.motionscope");
        fs::create_dir(path.parent().unwrap()).unwrap();
        for source in [Source::File(clip), Source::parse("synth:pillar,noise=5").unwrap()] {
            let saved = session(source.clone());
            saved.save(&path).unwrap();
            let read = Session::load(&path).unwrap();
            assert_eq!(read.estimator.values(), saved.estimator.values());
            assert_eq!((read.frame, read.cursor, read.sight), (saved.frame, saved.cursor, saved.sight));
            assert_eq!(read.pixel, saved.pixel);
            assert_eq!(read.look, saved.look);
            assert!(read.company == saved.company, "those beside it have their own parameters");
            match (read.source, source) {
                (Source::File(read), Source::File(_)) => {
                    assert!(fs::read_to_string(&path).unwrap().contains("clip = \"../clips/a.mp4\""));
                    assert_eq!(read, path.parent().unwrap().join("../clips/a.mp4"));
                }
                (read, source) => assert_eq!(read, source),
            }
        }
    }

    #[test]
    fn paths_are_told_from_where_the_session_is() {
        let top = tempfile::tempdir().unwrap();
        let here = top.path().join("here");
        fs::create_dir_all(here.join("deep")).unwrap();
        let clip = here.join("a.mp4");
        fs::write(&clip, []).unwrap();
        for (folder, told) in [
            (here.clone(), "a.mp4"),
            (here.join("deep"), "../a.mp4"),
            (here.join("deep").join(".."), "a.mp4"),
            (here.join("deep").join("..").join(".."), "here/a.mp4"),
        ] {
            assert_eq!(slashed(&relative(&clip, &folder)).unwrap(), told, "{}", folder.display());
        }
        assert_eq!(folder_of(Path::new("one.motionscope")), Path::new("."));
    }

    #[test]
    fn a_pixel_is_named_only_where_one_is_held() {
        let saved = session(Source::parse("synth:pillar").unwrap());
        let names = |session: &Session| session.text(Path::new(".")).unwrap().contains("\npixel = \"303,202\"\n");
        assert!(names(&saved));
        let free = Session { pixel: None, ..saved };
        let text = free.text(Path::new(".")).unwrap();
        assert!(!text.contains("\npixel"), "{text}");
        assert_eq!(Session::parse(&text, Path::new(".")).unwrap().pixel, None);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn what_cannot_be_written_down_is_told() {
        use std::os::unix::ffi::OsStrExt;
        let clip = Path::new(std::ffi::OsStr::from_bytes(b"caf\xE9.mp4"));
        let saved = Session { truth: Some(clip.into()), ..session(Source::parse("synth:pillar").unwrap()) };
        for session in [session(Source::parse(clip).unwrap()), saved] {
            let told = session.text(Path::new(".")).unwrap_err().to_string();
            assert!(told.contains("caf\u{FFFD}.mp4") && told.contains("rename"), "{told}");
        }
    }

    #[test]
    fn what_a_session_does_not_say_is_left_as_it_is() {
        let start = "motionscope = 1\nclip = \"a.mp4\"\nestimator = \"full-search\"\n[picture]\n";
        let look = |picture: &str| Session::parse(&format!("{start}{picture}"), Path::new("")).unwrap().look;
        let usual = Look {
            view: Some(View::Blink),
            level: LevelShown::Number(1),
            share: Share::new(0.2).unwrap(),
            theme: Theme::Projector,
            colors: ColorMap::Turbo,
            layer: Some(FlowLayer::Magnitude),
            opacity: Opacity::new(0.3).ok(),
            lengthen: Lengthen::Times(4.0),
            spacing_px: Some(24),
            streaks: Some(Phase::default()),
            legend: true,
            caption: true,
        };
        assert_eq!(look("").over(usual), usual);
        assert_eq!(look("arrows = \"auto\"").over(usual), Look { lengthen: Lengthen::Auto, ..usual });
        assert_eq!(look("legend = false\ntheme = \"light\"").over(usual).theme, Theme::Light);
        assert_eq!(look("arrows = 2").over(usual).lengthen, Lengthen::Times(2.0));
        let motion = look("layer = \"error\"\nlayer-opacity = 1\narrow-spacing = 9\nstreaks = 0.25").over(usual);
        let wanted = (Some(FlowLayer::Error), Some(9), Phase::new(0.25).ok());
        assert_eq!((motion.layer, motion.spacing_px, motion.streaks), wanted);
        assert_eq!(motion.opacity, Opacity::new(1.0).ok());
        assert_eq!(look("level = 2").over(usual).level, LevelShown::Number(2));
        assert_eq!(look("level = \"at-work\"").over(usual).level, LevelShown::AtWork);
        let wrong = Session::parse(&format!("{start}level = \"top\""), Path::new("")).err().unwrap();
        assert!(wrong.to_string().contains("at-work or a number"), "{wrong}");
    }

    #[test]
    fn a_sight_that_cannot_be_is_left_out() {
        let start = "motionscope = 1\nclip = \"a.mp4\"\nestimator = \"full-search\"\n[sight]\n";
        for (sight, is_kept) in [
            ("center = [1, 2]\nzoom = 4", true),
            ("center = [nan, 2]\nzoom = 4", false),
            ("center = [1, 2]\nzoom = inf", false),
        ] {
            let read = Session::parse(&format!("{start}{sight}"), Path::new("")).unwrap();
            assert_eq!(read.sight.is_some(), is_kept, "{sight}");
        }
    }

    #[test]
    fn what_is_no_session_is_told_in_a_sentence() {
        let parse = |text: &str| Session::parse(text, Path::new("")).err().map(|e| e.to_string()).unwrap_or_default();
        let start = "motionscope = 1\nclip = \"a.mp4\"\n";
        for (text, told) in [
            ("\u{0}PNG", "no session"),
            ("clip = 3", "no session"),
            ("motionscope = 2\nclip = \"a\"\nestimator = \"full-search\"", "its format is 2"),
            (&format!("{start}estimator = \"magic\""), "full-search"),
            (&format!("{start}estimator = \"full-search\"\nstep = \"x\""), "UNIT.EVENT"),
            (&format!("{start}estimator = \"full-search\"\npixel = \"303\""), "X,Y"),
            (&format!("{start}estimator = \"full-search\"\n[[beside]]\nestimator = \"magic\""), "no estimator magic"),
            (&format!("{start}estimator = \"full-search\"\n[[beside]]\nestimator = \"full-search\""), "beside itself"),
            (&format!("{start}estimator = \"full-search\"\npace = \"slow\""), "block, budget"),
            (&format!("{start}estimator = \"full-search\"\n[set]\nblock = 400"), "4 to 64 px"),
            (&format!("{start}estimator = \"full-search\"\n[picture]\nview = \"up\""), "side-by-side"),
            (&format!("{start}estimator = \"full-search\"\n[picture]\nblend = 1.5"), "from 0 to 1"),
            (&format!("{start}estimator = \"full-search\"\n[picture]\narrows = 1e38"), "0.01 to 100 times"),
            (&format!("{start}estimator = \"full-search\"\n[picture]\narrows = nan"), "0.01 to 100 times"),
            (&format!("{start}estimator = \"full-search\"\n[picture]\narrows = \"long\""), "or auto"),
        ] {
            assert!(parse(text).contains(told), "{text}: {}", parse(text));
        }
    }

    #[test]
    fn line_and_key_are_told_in_words() {
        let start = "motionscope = 1\nclip = \"a.mp4\"\nestimator = \"full-search\"\n";
        for (text, told) in [
            ("frame = \"x\"", "line 4, frame: a whole number is needed, not the text \"x\""),
            ("frame = -1", "line 4, frame: a whole number from 0 on is needed, not -1"),
            ("frame = 99999999999999999999", "line 4, frame: a whole number is needed, not 99999999999999999999"),
            ("frame = ", "line 4 is not written as key = value"),
            ("frame = 1\nframe = 2", "line 5 has a key that is there already"),
            ("step = 35.412", "line 4, step: a text in quotes is needed, not 35.412"),
            ("step = \"x\"", "line 4, step: a step is written UNIT.EVENT"),
            ("frmae = 3", "line 4: there is no key frmae here; there are motionscope, clip, truth, estimator"),
            ("clip.a = 3", "line 4 is not written as key = value"),
            ("\n[set]\n\nblock = 400", "line 7, set.block: "),
            ("[set]\nblock = [4]", "line 5, set.block: a single value is needed, not a list"),
            ("[set]\nblok = 4", "line 5, set.blok: "),
            ("set = 3", "line 4, set: a section is needed, not 3"),
            ("[picture]\nlevel = true", "line 5, picture.level: a level is at-work or a number"),
            ("[picture]\narrows = []", "line 5, picture.arrows: a number or a text in quotes is needed, not a list"),
            ("[picture]\nlegend = \"yes\"", "line 5, picture.legend: true or false is needed, not the text \"yes\""),
            ("[picture]\nstreaks = {}", "line 5, picture.streaks: a number is needed, not a section"),
            ("[picture]\nlooks = 1", "line 5: there is no key looks here; there are view, level"),
            (
                "[sight]\ncenter = [1, 2, 3]\nzoom = 1",
                "line 5, sight.center: a list of 2 numbers is needed, not a list",
            ),
            ("[sight]\ncenter = [1, 2]", "line 4: sight has no key zoom; add it"),
            ("beside = 1", "line 4, beside: a list of sections is needed, not 1"),
            ("[[beside]]\nset = {}", "line 4: beside has no key estimator; add it"),
            ("[[beside]]\nestimator = \"diamond\"\nset = { block = 4 }", "line 6, beside.set.block: "),
            ("[[beside]]\nestimator = \"magic\"", "line 5, beside.estimator: there is no estimator magic"),
        ] {
            let whole = format!("{start}{text}\n");
            let found = Session::parse(&whole, Path::new("")).err().map(|e| e.to_string()).unwrap_or_default();
            assert!(found.starts_with(told), "{text}: {found}");
            assert!(!found.contains("variant") && !found.contains("expected"), "{found}");
        }
        let lacks = Session::parse("motionscope = 1\nestimator = \"full-search\"", Path::new("")).err().unwrap();
        assert_eq!(lacks.to_string(), "it has no key clip; add a line clip = …");
    }
}
