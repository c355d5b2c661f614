//! Colours over a picture that tell of the motion of every pixel.

use std::sync::Arc;

use motionscope_core::base::{Error, Threads};
use motionscope_core::data::Flow;
use motionscope_core::geometry::Grid;
use motionscope_core::scene::{Quantity, Role};

use super::flow_color::{flow_color, hatch, veil};
use super::legend::{Bar, Entry, Sample};
use super::{ColorMap, number};

/// How far a layer of colours hides the picture under it, from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Opacity(f32);

impl Opacity {
    /// Of a flow's colours over footage, unless another is chosen; where little moves they are clearer.
    pub const WHEEL: Self = Self(0.8);
    /// Of the colours of numbers: so opaque that over a dimmed picture they can be read off their scale.
    pub const SCALE: Self = Self(0.82);
    /// Of pixels that failed a check.
    const MARKS: Self = Self(0.88);

    /// This opacity, if it is one.
    ///
    /// # Errors
    /// If it does not lie between 0 and 1.
    pub fn new(opacity: f32) -> Result<Self, Error> {
        let message = || Error::new(format!("a layer has an opacity from 0 to 1, as in 0.8, and not {opacity}"));
        (0.0..=1.0).contains(&opacity).then_some(Self(opacity)).ok_or_else(message)
    }

    /// Its number.
    pub fn get(self) -> f32 {
        self.0
    }

    fn alpha(self) -> u8 {
        (255.0 * self.0).round() as u8
    }
}

/// How the picture under a layer of colours is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Backdrop {
    /// Gray and dark.
    #[default]
    Dimmed,
    /// As it is.
    Plain,
}

impl Backdrop {
    /// Every way.
    pub const ALL: [Backdrop; 2] = [Backdrop::Dimmed, Backdrop::Plain];

    /// Stable name, for sessions and the command line.
    pub fn id(self) -> &'static str {
        match self {
            Backdrop::Dimmed => "dimmed",
            Backdrop::Plain => "plain",
        }
    }

    /// Name as shown.
    pub fn name(self) -> &'static str {
        match self {
            Backdrop::Dimmed => "Dimmed picture",
            Backdrop::Plain => "Picture in its own colours",
        }
    }

    /// What it shows, in one sentence.
    pub fn tip(self) -> &'static str {
        match self {
            Backdrop::Dimmed => "The picture under colours is gray and dark, so that they can be read off their scale.",
            Backdrop::Plain => "The picture under colours keeps its own, which mix with them.",
        }
    }
}

/// How bright a dimmed picture is.
const DIMMED: f32 = 0.45;

/// A picture gray and dark, for colours to lie over.
pub fn dimmed(pixels: &Grid<[u8; 4]>) -> Grid<[u8; 4]> {
    colored(pixels, |&[r, g, b, a]| {
        let gray = 0.299 * f32::from(r) + 0.587 * f32::from(g) + 0.114 * f32::from(b);
        let gray = (DIMMED * gray).round() as u8;
        [gray, gray, gray, a]
    })
}

/// What is chosen of a layer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LayerStyle {
    /// How opaque it is; `None` for what suits it, and clear where nothing moves.
    pub opacity: Option<Opacity>,
    /// The number at the end of its scale; `None` for one that the values have.
    pub high: Option<f32>,
}

/// From so many values on, only every few are asked how large they are.
const SAMPLE: usize = 1 << 18;

/// What colours stand over the picture where motion is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum FlowLayer {
    /// None.
    #[default]
    None,
    /// Direction and length in the colours of a wheel.
    Wheel,
    /// How far each pixel moves.
    Magnitude,
    /// How far that is from the truth.
    Error,
    /// How far that is from the flow of the first estimator in lockstep.
    Difference,
    /// How far the estimator trusts it.
    Confidence,
    /// How far from its pixel one comes back along the flow of the reverse pair.
    Consistency,
    /// A quantity of a model.
    Model(Quantity),
}

impl FlowLayer {
    /// The layers of a flow.
    const OF_FLOW: [FlowLayer; 7] = [
        FlowLayer::None,
        FlowLayer::Wheel,
        FlowLayer::Magnitude,
        FlowLayer::Error,
        FlowLayer::Difference,
        FlowLayer::Confidence,
        FlowLayer::Consistency,
    ];

    /// Every layer.
    pub const ALL: [FlowLayer; Self::OF_FLOW.len() + Quantity::ALL.len()] = {
        let mut all = [FlowLayer::None; Self::OF_FLOW.len() + Quantity::ALL.len()];
        let mut i = 0;
        while i < all.len() {
            all[i] = match i.checked_sub(Self::OF_FLOW.len()) {
                None => Self::OF_FLOW[i],
                Some(quantity) => FlowLayer::Model(Quantity::ALL[quantity]),
            };
            i += 1;
        }
        all
    };

    /// Stable name, for sessions and the command line.
    pub fn id(self) -> &'static str {
        match self {
            FlowLayer::None => "none",
            FlowLayer::Wheel => "wheel",
            FlowLayer::Magnitude => "magnitude",
            FlowLayer::Error => "error",
            FlowLayer::Difference => "difference",
            FlowLayer::Confidence => "confidence",
            FlowLayer::Consistency => "consistency",
            FlowLayer::Model(quantity) => quantity.id(),
        }
    }

    /// Name as shown.
    pub fn name(self) -> &'static str {
        match self {
            FlowLayer::None => "No colours",
            FlowLayer::Wheel => "Colour wheel",
            FlowLayer::Magnitude => "Magnitude",
            FlowLayer::Error => "Error",
            FlowLayer::Difference => "Flow difference",
            FlowLayer::Confidence => "Confidence",
            FlowLayer::Consistency => "Consistency",
            FlowLayer::Model(quantity) => quantity.title(),
        }
    }

    /// The quantity of a model that it shows, if it shows one.
    pub fn quantity(self) -> Option<Quantity> {
        match self {
            FlowLayer::Model(quantity) => Some(quantity),
            _ => None,
        }
    }

    /// Whether only the end of a run has it.
    pub fn is_of_the_end(self) -> bool {
        matches!(self, FlowLayer::Error | FlowLayer::Confidence | FlowLayer::Consistency)
    }

    /// What stands in the legend while the end of the run is awaited.
    pub fn awaited(self) -> Entry {
        let meaning = format!("{}: at the end of the run", self.name().to_lowercase());
        Entry { role: Role::Estimate, sample: Sample::Awaited, own: Vec::new(), meaning }
    }

    /// How opaque it is where nothing else is chosen.
    pub fn usual_opacity(self) -> Opacity {
        if self == FlowLayer::Wheel { Opacity::WHEEL } else { Opacity::SCALE }
    }

    /// What it shows, in one sentence.
    pub fn tip(self) -> &'static str {
        match self {
            FlowLayer::None => "The picture alone, without flow colours.",
            FlowLayer::Wheel => {
                "Direction and magnitude of motion in the colours of the Middlebury wheel: white where nothing moves."
            }
            FlowLayer::Magnitude => "How far each pixel moves from frame to frame, whatever the direction.",
            FlowLayer::Error => "How far the end of each displacement is from the true one, where that is known.",
            FlowLayer::Difference => {
                "How far the displacement of each pixel is from that of the first estimator in lockstep."
            }
            FlowLayer::Confidence => "How far the estimator itself trusts the displacement of each pixel.",
            FlowLayer::Consistency => {
                "How far one misses the pixel on going along the flow and back along that of the reverse pair; what \
                 fails this check is hidden in the other frame, or wrong."
            }
            FlowLayer::Model(quantity) => quantity.tip(),
        }
    }
}

/// A picture of colours that lies over frame t, and what they stand for.
#[derive(Clone, Debug, PartialEq)]
pub struct Tint {
    /// What it shows.
    pub kind: FlowLayer,
    /// Red, green, blue and straight alpha of every pixel of the picture; clear where nothing is known.
    pub pixels: Arc<Grid<[u8; 4]>>,
    /// What its colours stand for.
    pub key: TintKey,
}

/// What the colours of a layer stand for.
#[derive(Clone, Debug, PartialEq)]
pub enum TintKey {
    /// Directions: full at this length in px/frame.
    Wheel(f32),
    /// Numbers.
    Scale {
        /// What is measured: `endpoint error`.
        label: String,
        /// Its unit.
        unit: &'static str,
        /// The number in the last colour; 0 is in the first.
        high: f32,
        /// Whether there are larger ones.
        is_cut: bool,
        /// The colours.
        colors: ColorMap,
        /// Whether pixels that failed a check are marked.
        has_marks: bool,
    },
}

/// Numbers to be shown as colours.
pub struct Scalars {
    /// What they show.
    pub kind: FlowLayer,
    /// What is measured: `endpoint error`.
    pub label: String,
    /// Its unit.
    pub unit: &'static str,
    /// The numbers of each of several that share one scale; NaN where nothing is known.
    pub values: Vec<Grid<f32>>,
    /// Pixels that failed a check, of a single one.
    pub marks: Option<Grid<bool>>,
}

impl Tint {
    /// The colours of the wheel for each of `flows`, which share one scale. Where an opacity is chosen, all colours have it.
    pub fn wheel(flows: &[Arc<Flow>], style: LayerStyle) -> Vec<Self> {
        let alpha = style.opacity.unwrap_or(Opacity::WHEEL).alpha();
        let lengths = flows.iter().flat_map(|flow| flow.0.cells().iter().map(|[u, v]| u.hypot(*v)));
        let found = || usual_most(lengths, flows.iter().map(|flow| flow.0.cells().len()).sum()).0;
        let longest = style.high.unwrap_or_else(found).max(1e-3);
        let color = |uv: &[f32; 2]| match flow_color(*uv, longest) {
            color if color.0[3] == 0 => [0; 4],
            color if style.opacity.is_some() => color.alpha(alpha).0,
            color => color.alpha((f32::from(alpha) * veil(uv[0].hypot(uv[1]) / longest)).round() as u8).0,
        };
        let layer = |flow: &Arc<Flow>| Self {
            kind: FlowLayer::Wheel,
            pixels: Arc::new(colored(&flow.0, color)),
            key: TintKey::Wheel(longest),
        };
        flows.iter().map(layer).collect()
    }

    /// Numbers in the colours of `colors`. Lengths of motion are clear where nothing moves, unless an opacity is chosen.
    pub fn scale(scalars: Scalars, colors: ColorMap, style: LayerStyle) -> Vec<Self> {
        let LayerStyle { opacity, .. } = style;
        let alpha = opacity.unwrap_or(Opacity::SCALE).alpha();
        let Scalars { kind, label, unit, values, marks } = scalars;
        let all = values.iter().flat_map(|values| values.cells().iter().copied());
        let (usual, most) = usual_most(all, values.iter().map(|values| values.cells().len()).sum());
        let high = style.high.unwrap_or(usual);
        let is_cut = most > high * 1.001;
        let is_veiled = opacity.is_none() && kind == FlowLayer::Magnitude;
        let alpha_at = |share: f32| if is_veiled { (f32::from(alpha) * veil(share)).round() as u8 } else { alpha };
        let entry = |share: f32| colors.at(share).alpha(alpha_at(share)).0;
        let table: Vec<[u8; 4]> = (0..=255).map(|i| entry(i as f32 / 255.0)).collect();
        let color = |v: &f32| match v.is_finite() {
            true => table[((v / high.max(f32::MIN_POSITIVE) * 255.0 + 0.5) as usize).min(255)],
            false => [0; 4],
        };
        let key = TintKey::Scale { label, unit, high, is_cut, colors, has_marks: marks.is_some() };
        let layer = |values: &Grid<f32>| {
            let mut pixels = colored(values, color);
            if let Some(marks) = &marks {
                mark(&mut pixels, marks, opacity.unwrap_or(Opacity::MARKS));
            }
            Self { kind, pixels: Arc::new(pixels), key: key.clone() }
        };
        values.iter().map(layer).collect()
    }

    /// The number at the end of its scale.
    pub fn end(&self) -> f32 {
        match &self.key {
            TintKey::Wheel(longest) => *longest,
            TintKey::Scale { high, .. } => *high,
        }
    }

    /// Whether its scale is one of px.
    pub fn has_unit(&self) -> bool {
        !matches!(self.key, TintKey::Scale { unit: "", .. })
    }

    /// What stands in the legend for it: signs with their meaning, and a bar of colours.
    pub fn legend(&self) -> (Vec<Entry>, Option<Bar>) {
        match &self.key {
            TintKey::Wheel(longest) => {
                let meaning = format!("direction of motion, full colour at {} px/frame", number(*longest));
                (vec![Entry { role: Role::Estimate, sample: Sample::Wheel, own: Vec::new(), meaning }], None)
            }
            TintKey::Scale { label, unit, high, is_cut, colors, has_marks } => {
                let entry = || {
                    let meaning = "fails the check: hidden in frame t+1, or wrong".into();
                    Entry { role: Role::Error, sample: Sample::Hatch, own: Vec::new(), meaning }
                };
                let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
                let at_least = if *is_cut { "≥ " } else { "" };
                let ends = match *high > 0.0 {
                    true => [format!("{label} 0"), format!("{at_least}{}{unit}", number(*high))],
                    false => [format!("{label} 0{unit}"), String::new()],
                };
                (has_marks.then(entry).into_iter().collect(), Some(Bar { ends, colors: *colors }))
            }
        }
    }
}

/// The number that one in a hundred exceeds, and the largest: a few that went astray would pale all others.
fn usual_most(values: impl Iterator<Item = f32>, count: usize) -> (f32, f32) {
    let every = count.div_ceil(SAMPLE).max(1);
    let mut most = 0.0f32;
    let mut sample = Vec::with_capacity(count / every + 1);
    for (i, v) in values.enumerate().filter(|(_, v)| v.is_finite()) {
        most = most.max(v);
        if i % every == 0 {
            sample.push(v);
        }
    }
    let Some(place) = sample.len().checked_sub(1).map(|last| last * 99 / 100) else { return (most, most) };
    let usual = *sample.select_nth_unstable_by(place, f32::total_cmp).1;
    // Where all but a few are nothing, these are the scale.
    let usual = if usual > 0.0 { usual } else { most };
    (usual, most)
}

/// `color` of every value, worked out on all cores; a small picture is done before they would be at hand.
fn colored<T: Sync>(values: &Grid<T>, color: impl Fn(&T) -> [u8; 4] + Sync) -> Grid<[u8; 4]> {
    let mut pixels = Grid::new(values.width(), values.height(), [0; 4]);
    let all = (values.cells().len() > 1 << 15).then(Threads::all).and_then(Result::ok);
    all.unwrap_or_else(Threads::single).rows(&mut pixels, |y, row| {
        row.iter_mut().zip(values.row(y)).for_each(|(to, from)| *to = color(from));
    });
    pixels
}

/// Paints the pixels of `marks` in stripes, so that they can be told without colours.
fn mark(pixels: &mut Grid<[u8; 4]>, marks: &Grid<bool>, opacity: Opacity) {
    let stripes = hatch().map(|color| color.alpha(opacity.alpha()).0);
    for y in 0..pixels.height() {
        for (x, pixel) in pixels.row_mut(y).iter_mut().enumerate() {
            if marks.get(x, y) == Some(&true) {
                *pixel = stripes[(x + y) / 2 % 2];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scalars(values: Grid<f32>, marks: Option<Grid<bool>>) -> Tint {
        let scalars =
            Scalars { kind: FlowLayer::Error, label: "endpoint error".into(), unit: "px", values: vec![values], marks };
        Tint::scale(scalars, ColorMap::Viridis, LayerStyle::default()).remove(0)
    }

    #[test]
    fn a_few_astray_do_not_pale_the_wheel() {
        let flow = |odd: f32| Arc::new(Flow(Grid::from_fn(100, 10, |x, y| [if x + y == 0 { odd } else { 2.0 }, 0.0])));
        let layers = Tint::wheel(&[flow(2.0), flow(90.0)], LayerStyle::default());
        assert_eq!(layers[0].key, TintKey::Wheel(2.0));
        assert_eq!(layers[0].pixels[(5, 5)], layers[1].pixels[(5, 5)], "several share one scale");
        let said = layers[0].legend().0.remove(0).meaning;
        assert_eq!(said, "direction of motion, full colour at 2 px/frame");
    }

    #[test]
    fn what_is_unknown_stays_clear() {
        let layer = scalars(Grid::from_fn(4, 1, |x, _| [f32::NAN, 0.0, 0.5, 1.0][x]), None);
        assert_eq!(layer.pixels[(0, 0)], [0; 4]);
        let color = |t| ColorMap::Viridis.at(t).alpha(Opacity::SCALE.alpha()).0;
        // Of three, the 99th percentile is the second.
        assert_eq!([layer.pixels[(1, 0)], layer.pixels[(3, 0)]], [color(0.0), color(1.0)]);
        let (entries, bar) = layer.legend();
        assert_eq!((entries.len(), bar.unwrap().ends), (0, ["endpoint error 0", "≥ 0.500 px"].map(str::to_owned)));
    }

    #[test]
    fn numbers_beyond_the_scale_have_its_last_colour_and_the_legend_says_so() {
        let layer = scalars(Grid::from_fn(400, 1, |x, _| if x == 7 { 50.0 } else { x as f32 / 400.0 }), None);
        assert_eq!(layer.pixels[(7, 0)], ColorMap::Viridis.at(1.0).alpha(Opacity::SCALE.alpha()).0);
        assert!(layer.legend().1.unwrap().ends[1].starts_with("≥ 0.99"));
        let still = scalars(Grid::new(4, 4, 0.0), None).legend().1.unwrap();
        assert_eq!(still.ends, ["endpoint error 0 px".to_owned(), String::new()]);
    }

    #[test]
    fn marked_pixels_stand_off_from_every_colour() {
        let marks = Grid::from_fn(8, 8, |x, _| x < 4);
        let layer = scalars(Grid::from_fn(8, 8, |x, _| x as f32), Some(marks));
        let marked: std::collections::HashSet<_> = (0..4).map(|x| layer.pixels[(x, 0)]).collect();
        assert_eq!(marked.len(), 2, "stripes");
        assert!((4..8).all(|x| !marked.contains(&layer.pixels[(x, 0)])));
        assert_eq!(layer.legend().0[0].sample, Sample::Hatch);
    }

    #[test]
    fn what_is_known_hides_the_picture_as_far_as_is_chosen() {
        let numbers = || Scalars {
            kind: FlowLayer::Consistency,
            label: "forward–backward error".into(),
            unit: "px",
            values: vec![Grid::from_fn(4, 1, |x, _| if x == 0 { f32::NAN } else { x as f32 })],
            marks: Some(Grid::from_fn(4, 1, |x, _| x == 3)),
        };
        let flow = Arc::new(Flow(Grid::from_fn(4, 1, |x, _| if x == 0 { Flow::UNKNOWN } else { [1.0, 0.0] })));
        let alphas = |tint: Vec<Tint>| tint[0].pixels.cells().iter().map(|pixel| pixel[3]).collect::<Vec<_>>();
        for (chosen, alpha) in [(1.0, 255), (0.4, 102), (0.0, 0)] {
            let style = LayerStyle { opacity: Opacity::new(chosen).ok(), high: None };
            let known = [0, alpha, alpha, alpha];
            assert_eq!(alphas(Tint::scale(numbers(), ColorMap::Viridis, style)), known);
            assert_eq!(alphas(Tint::wheel(std::slice::from_ref(&flow), style)), known);
        }
        assert!(Opacity::new(1.1).is_err() && Opacity::new(f32::NAN).is_err());
    }

    #[test]
    fn what_does_not_move_is_no_veil_unless_its_opacity_is_chosen() {
        let flow = Arc::new(Flow(Grid::from_fn(40, 1, |x, _| [if x < 8 { 0.0 } else { 2.0 }, 0.0])));
        let wheel =
            |opacity| Tint::wheel(std::slice::from_ref(&flow), LayerStyle { opacity, high: None }).remove(0).pixels;
        assert_eq!(wheel(None)[(0, 0)][3], 0);
        assert_eq!(wheel(None)[(20, 0)][3], Opacity::WHEEL.alpha());
        assert_eq!(wheel(Opacity::new(1.0).ok())[(0, 0)], [255; 4], "white by choice");
        let lengths = flow.0.map(|[u, _]| *u);
        let of = |kind| Scalars { kind, label: String::new(), unit: "px", values: vec![lengths.clone()], marks: None };
        let alpha = |kind| Tint::scale(of(kind), ColorMap::Viridis, LayerStyle::default()).remove(0).pixels[(0, 0)][3];
        assert_eq!([alpha(FlowLayer::Magnitude), alpha(FlowLayer::Error)], [0, Opacity::SCALE.alpha()]);
    }

    #[test]
    fn a_fixed_scale_is_the_same_whatever_was_found() {
        let flow = |u: f32| Arc::new(Flow(Grid::from_fn(40, 1, |_, _| [u, 0.0])));
        let style = LayerStyle { opacity: None, high: Some(8.0) };
        for found in [1.0, 4.0, 20.0] {
            let layer = Tint::wheel(&[flow(found)], style).remove(0);
            assert_eq!(layer.key, TintKey::Wheel(8.0));
        }
        let of = |most: f32| Scalars {
            kind: FlowLayer::Error,
            label: "endpoint error".into(),
            unit: "px",
            values: vec![Grid::new(4, 1, most)],
            marks: None,
        };
        let end = |most| Tint::scale(of(most), ColorMap::Viridis, style).remove(0).legend().1.unwrap().ends[1].clone();
        assert_eq!([end(2.0), end(9.0)], ["8 px", "≥ 8 px"].map(str::to_owned));
    }

    #[test]
    fn a_dimmed_picture_is_gray_and_dark() {
        let pixels = dimmed(&Grid::new(2, 1, [200, 40, 90, 255]));
        let [r, g, b, a] = pixels[(0, 0)];
        assert!(r == g && g == b && r < 60 && a == 255);
    }
}
