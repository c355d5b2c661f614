//! Examples: synthetic clips with settings on which an estimator works, or fails for a stated reason.

mod background;
mod block_matching;
mod correspondence;
mod interest_points;
mod motion_segmentation;
mod optical_flow;
mod region_tracking;
mod stereo;
mod tracking;

/// What makes an estimator fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
pub type Settings = &'static [(&'static str, &'static str)];

/// A limit of a measure.
#[derive(Clone, Copy, Debug, PartialEq)]
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
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alternative {
    /// Its id.
    pub id: &'static str,
    /// Its settings.
    pub settings: Settings,
    /// The limit of the example's measure that it keeps to.
    pub limit: Limit,
}

/// A synthetic clip with settings that shows one effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Example {
    /// Names the example among those of an estimator: `large-motion`.
    pub id: &'static str,
    /// The effect in a few words.
    pub title: &'static str,
    /// The ids of the estimators that it belongs to.
    pub of: &'static [&'static str],
    /// Why they fail; `None` where they work.
    pub cause: Option<Cause>,
    /// The scene with its sliders, without prefix: `pillar,speed=4`.
    pub clip: &'static str,
    /// The parameters of the estimator.
    pub settings: Settings,
    /// Frame t.
    pub frame: usize,
    /// What happens and why, in one or two sentences.
    pub says: &'static str,
    /// The key of the measure that shows it, and its limit.
    pub claim: (&'static str, Limit),
    /// An estimator that works on the same clip, by the same measure.
    pub instead: Option<Alternative>,
}

impl Example {
    /// Whether the estimators fail.
    pub fn is_failure(&self) -> bool {
        self.cause.is_some()
    }
}

/// Returns the examples of all estimators, in the order of the course.
pub fn examples() -> impl Iterator<Item = &'static Example> {
    [
        block_matching::EXAMPLES,
        optical_flow::EXAMPLES,
        motion_segmentation::EXAMPLES,
        interest_points::EXAMPLES,
        correspondence::EXAMPLES,
        background::EXAMPLES,
        tracking::EXAMPLES,
        region_tracking::EXAMPLES,
        stereo::EXAMPLES,
    ]
    .into_iter()
    .flatten()
}

/// Returns the examples of the estimator `id`.
pub fn of(id: &str) -> impl Iterator<Item = &'static Example> {
    examples().filter(move |example| example.of.contains(&id))
}
