//! Examples: synthetic clips with settings on which an estimator works, or fails for a stated reason.

use std::sync::LazyLock;

use serde::de::Error;
use serde::{Deserialize, Deserializer};

use super::bundled;

/// What makes an estimator fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cause {
    /// Only the motion along the gradient is seen.
    Aperture,
    /// The motion is larger than the estimator can follow.
    LargeMotion,
    /// There is nothing to tell one place from another.
    LowTexture,
    /// The texture repeats within the motion.
    Repetition,
    /// The brightness changes between the frames.
    LightChange,
    /// The object is covered for a while.
    Occlusion,
    /// The image turns.
    Rotation,
    /// Something else looks like the object.
    Clutter,
    /// The camera moves.
    CameraMotion,
    /// Noise hides the texture.
    Noise,
    /// The model that is estimated is not determined by the scene.
    Degenerate,
    /// The object moves otherwise than predicted.
    #[serde(rename = "manoeuvre")]
    Maneuver,
    /// Objects are too near to each other to be told apart.
    Proximity,
    /// The object has stronger edges inside than at its outline.
    InnerEdges,
    /// The object grows or shrinks.
    ScaleChange,
    /// The exposure smears what moves.
    MotionBlur,
    /// The cost has minima beside that of the motion.
    LocalMinima,
    /// The object moves too little from frame to frame.
    SlowMotion,
}

impl Cause {
    /// The cause in words: `large motion`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Aperture => "aperture problem",
            Self::LargeMotion => "large motion",
            Self::LowTexture => "low texture",
            Self::Repetition => "repeating texture",
            Self::LightChange => "change of light",
            Self::Occlusion => "occlusion",
            Self::Rotation => "rotation",
            Self::Clutter => "clutter",
            Self::CameraMotion => "camera motion",
            Self::Noise => "noise",
            Self::Degenerate => "degenerate scene",
            Self::Maneuver => "manoeuvre",
            Self::Proximity => "objects close together",
            Self::InnerEdges => "edges inside the object",
            Self::ScaleChange => "change of scale",
            Self::MotionBlur => "motion blur",
            Self::LocalMinima => "local minima",
            Self::SlowMotion => "slow motion",
        }
    }
}

/// The parameters that are not at their defaults: names and values.
pub type Settings = Vec<(&'static str, &'static str)>;

/// A limit of a measure.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Limit {
    /// At most this.
    AtMost(f64),
    /// At least this.
    AtLeast(f64),
}

impl Limit {
    /// Whether `value` keeps to it.
    pub fn holds(self, value: f64) -> bool {
        match self {
            Self::AtMost(limit) => value <= limit,
            Self::AtLeast(limit) => value >= limit,
        }
    }
}

/// An estimator that works where another one fails.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Alternative {
    /// Its id.
    #[serde(rename = "estimator")]
    pub id: &'static str,
    /// Its settings.
    #[serde(default, rename = "set", deserialize_with = "settings")]
    pub settings: Settings,
    /// The limit of the example's measure that it keeps to.
    pub limit: Limit,
}

/// A synthetic clip with settings that shows one effect.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Example {
    /// Names the example among those of an estimator: `large-motion`.
    pub id: &'static str,
    /// The effect in a few words.
    pub title: &'static str,
    /// The ids of the estimators that it belongs to.
    #[serde(rename = "estimators")]
    pub of: Vec<&'static str>,
    /// Why they fail; `None` where they work.
    pub cause: Option<Cause>,
    /// The scene with its sliders, without prefix: `pillar,speed=4`.
    pub clip: &'static str,
    /// The parameters of the estimator.
    #[serde(default, rename = "set", deserialize_with = "settings")]
    pub settings: Settings,
    /// Frame t.
    #[serde(default)]
    pub frame: usize,
    /// What happens and why, in one or two sentences.
    pub says: &'static str,
    /// The key of the measure that shows it.
    pub measure: &'static str,
    /// The limit of this measure that the estimators keep to.
    pub limit: Limit,
    /// An estimator that works on the same clip, by the same measure.
    pub instead: Option<Alternative>,
}

impl Example {
    /// Whether the estimators fail.
    pub fn is_failure(&self) -> bool {
        self.cause.is_some()
    }
}

/// Reads a list of texts `NAME=VALUE`, as they stand on the command line.
fn settings<D: Deserializer<'static>>(list: D) -> Result<Settings, D::Error> {
    let setting = |text: &'static str| {
        text.split_once('=').ok_or_else(|| D::Error::custom(format!("{text} is no setting; write NAME=VALUE")))
    };
    Vec::deserialize(list)?.into_iter().map(setting).collect()
}

/// The files of the examples, in the order of the course.
const FILES: [(&str, &str); 9] = [
    ("examples/block-matching.toml", include_str!("../../assets/examples/block-matching.toml")),
    ("examples/optical-flow.toml", include_str!("../../assets/examples/optical-flow.toml")),
    ("examples/motion-segmentation.toml", include_str!("../../assets/examples/motion-segmentation.toml")),
    ("examples/interest-points.toml", include_str!("../../assets/examples/interest-points.toml")),
    ("examples/correspondence.toml", include_str!("../../assets/examples/correspondence.toml")),
    ("examples/moving-objects.toml", include_str!("../../assets/examples/moving-objects.toml")),
    ("examples/tracking.toml", include_str!("../../assets/examples/tracking.toml")),
    ("examples/region-tracking.toml", include_str!("../../assets/examples/region-tracking.toml")),
    ("examples/stereo.toml", include_str!("../../assets/examples/stereo.toml")),
];

static EXAMPLES: LazyLock<Vec<Example>> = LazyLock::new(|| {
    let read = |(name, text)| bundled::read::<Example>(name, text).expect("the laws read it");
    FILES.into_iter().flat_map(read).collect()
});

/// Returns the examples of all estimators, in the order of the course.
pub fn examples() -> impl Iterator<Item = &'static Example> {
    EXAMPLES.iter()
}

/// Returns the examples of the estimator `id`.
pub fn of(id: &str) -> impl Iterator<Item = &'static Example> {
    examples().filter(move |example| example.of.contains(&id))
}
