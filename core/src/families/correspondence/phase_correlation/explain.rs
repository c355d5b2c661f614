//! The explanation and the drawing of phase correlation.

use super::doubt::Doubt;
use super::{Event, PhaseCorrelation, Stage, State, Subpixel, larger_side, line, spectrum, unexplained};
use crate::base::words::{fixed, grouped};
use crate::geometry::Grid;
use crate::methods::differential::numbers;
use crate::methods::numbers::percent;
use crate::products::{FlowError, metrics};
use crate::run::Seen;
use crate::scene::{
    BetweenPixels, Fact, Footing, Math, Matrix, Picture, Readout, Role, Scene, Sentence, Shape, Step, Surface, Tile,
};

/// Cells along a side of a tile, at most.
const CELLS: usize = 96;
/// Largest displacement on the chart from its middle, in px.
const REACH: i32 = 32;
/// A peak this many times as high as the second is distinct.
const DISTINCT: f64 = 2.0;
/// Above this share of the picture that moves otherwise, one translation explains only a part; up to the other one it explains all.
const PART: f64 = 0.1;
const LITTLE: f64 = 0.01;
/// A peak of this height has most phases in common.
const AGREEMENT: f64 = 0.5;

fn whole([u, v]: [i32; 2]) -> String {
    format!("({},\u{a0}{}) px", fixed(u.into(), 0), fixed(v.into(), 0))
}

fn exact(uv: [f64; 2]) -> String {
    format!("{} px", numbers::vector(uv.map(|c| c as f32)))
}

fn frame(i: usize) -> &'static str {
    ["frame t", "frame t+1"][i]
}

fn name(i: usize) -> &'static str {
    ["G₁", "G₂"][i]
}

/// How much of the picture a translation with a distinct peak explains, by the ground truth, without it by the pictures.
fn explained(state: &State, error: Option<&FlowError>) -> String {
    let by_truth = error.map(|error| {
        let share = error.beyond[1];
        (share, format!("by the ground truth {} of the pixels move otherwise by more than 1 px", percent(share)))
    });
    let by_pictures = || {
        let pair = state.fixed.pair.each_ref().map(|frame| frame.luma());
        let share = unexplained::share(pair, state.translation())?;
        let what = "of the 8×8 blocks still differ clearly after the displacement: they move otherwise, are hidden or have changed";
        Some((share, format!("{} {what}", percent(share))))
    };
    match by_truth.or_else(by_pictures) {
        Some((share, evidence)) if share > PART => {
            format!("but one translation explains only a part of the picture: {evidence}.")
        }
        Some((share, evidence)) if share > LITTLE => {
            format!("so one translation explains the motion of most of the picture; {evidence}.")
        }
        Some(_) => "so one translation explains the motion.".to_owned(),
        None => {
            "but the frames have too small a part in common to tell how much of the picture it explains.".to_owned()
        }
    }
}

/// The evidence against the highest peak in words.
fn doubted(doubt: &Doubt) -> String {
    match *doubt {
        Doubt::Contradicted { other, residuals: [own, least] } => format!(
            "The pictures contradict the highest peak: displaced by it they differ by {} gray levels on average, displaced by {} by {}. \
             The peak comes from a part of the picture that moves otherwise, such as a border at rest, or from few phases that agree.",
            fixed(own, 2),
            whole(other),
            fixed(least, 2)
        ),
        Doubt::Aperture { across: [x, y], period_px } => {
            let repeats = period_px.map_or_else(String::new, |period| {
                format!(" Across the edges the pattern repeats every {period} px, so multiples of it fit as well.")
            });
            format!(
                "All gradients have the direction ({}, {}): the displacement along the edges is undetermined (aperture problem).{repeats}",
                fixed(x, 2),
                fixed(y, 2)
            )
        }
        Doubt::Repeats { other } => format!(
            "The pattern repeats: the displacement {} leaves as small a residual, so the peak is ambiguous.",
            whole(other)
        ),
    }
}

/// The means against it.
fn remedy(doubt: &Doubt) -> &'static str {
    match doubt {
        Doubt::Contradicted { .. } => {
            " Crop a part at rest, or use global motion, which tells such parts apart as outliers."
        }
        Doubt::Repeats { .. } | Doubt::Aperture { .. } => {
            " No method finds more in this texture alone; a larger picture with corners or an end of the pattern would tell."
        }
    }
}

impl PhaseCorrelation {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let Some(Event { stage, state }) = seen.events.last() else {
            let said = "Phase correlation finds one translation for the whole picture: a displacement only turns the phases of \
                        the frequencies, and the inverse transform of the phase difference has its peak at the displacement.";
            return Step {
                values: Vec::new(),
                line: line::WINDOW,
                sentence: Sentence::default().text(said),
                readouts: Vec::new(),
            };
        };
        let line = match stage {
            Stage::Window(_) => line::WINDOW,
            Stage::Rows(_) => line::TRANSFORM_ROWS,
            Stage::Columns(_) => line::TRANSFORM_COLUMNS,
            Stage::Cross => line::MULTIPLY,
            Stage::Normalize => line::NORMALISE,
            Stage::InverseColumns => line::INVERT_COLUMNS,
            Stage::InverseRows => line::INVERT_ROWS,
            Stage::Peak => line::TAKE_PEAK,
            Stage::Second => line::COMPARE_SECOND,
            Stage::Subpixel(0) => line::REFINE_X,
            Stage::Subpixel(_) => line::REFINE_Y,
            Stage::Result => line::TAKE_RESULT,
        };
        Step {
            values: Vec::new(),
            line,
            sentence: self.sentence(*stage, state),
            readouts: self.readouts(*stage, state),
        }
    }

    fn sentence(&self, stage: Stage, state: &State) -> Sentence {
        let (said, (width, height)) = (Sentence::default(), state.size());
        let peak = state.peak.map(|peak| (state.wrapped(peak), state.height_at(state.wrapped(peak))));
        match stage {
            Stage::Window(i) => {
                let mean = fixed(state.fixed.means[i], 2);
                let said = said.text(format!("The mean of {}, {mean} gray levels, is subtracted. ", frame(i)));
                said.text(match self.hann {
                    true => "The Hann window fades to 0 at the border, because the transform continues it periodically and a jump \
                             there would count as an edge at rest.",
                    false => "Without a window, the jump from one border to the opposite one counts as an edge at rest and \
                              raises the correlation at zero displacement.",
                })
            }
            Stage::Rows(i) => said.text(format!(
                "The fast Fourier transform of each of the {} rows of {}: each row gives {} frequencies.",
                grouped(height),
                frame(i),
                grouped(width)
            )),
            Stage::Columns(i) => said.text(format!(
                "The transform of each of the {} columns completes the spectrum {}. Its magnitude is the strength of a \
                 frequency, its phase the position.",
                grouped(width),
                name(i)
            )),
            Stage::Cross => said.text(
                "The cross-power spectrum multiplies each frequency of G₂ by the conjugate of G₁: magnitudes are multiplied, and \
                 phases subtracted. A translation makes the phase difference a plane.",
            ),
            Stage::Normalize => said.text(format!(
                "Division by the magnitude leaves only the phase difference, so that every frequency counts alike. {} of {} \
                 frequencies are kept; the others have less than {} times the cross power of rounding to whole gray levels.",
                grouped(state.kept),
                grouped(width * height),
                fixed(self.min_snr.into(), 1)
            )),
            Stage::InverseColumns => said.text(format!("The inverse transform of each of the {} columns.", grouped(width))),
            Stage::InverseRows => said.text(format!(
                "The inverse transform of each of the {} rows gives the phase correlation r. A pure translation of all pixels \
                 would give 1 at the displacement and 0 elsewhere.",
                grouped(height)
            )),
            Stage::Peak => match peak {
                Some((at, height)) => said
                    .text("The highest peak is ")
                    .ink(Role::Best, format!("r = {}", fixed(height, 3)))
                    .text(" at displacement ")
                    .ink(Role::Best, whole(at))
                    .text(": 1 would mean that all phases agree. ")
                    .text(Self::judged(state)),
                None => said.text(format!(
                    "No frequency rises above the noise: the strongest has {} times the cross power of rounding, and more than {} times is needed. \
                     There is no texture in common, and no peak; the displacement remains unknown.",
                    fixed(state.highest_snr, 1),
                    fixed(self.min_snr.into(), 1)
                )),
            },
            Stage::Second => self.second(state, peak, said),
            Stage::Subpixel(axis) => self.refined(state, axis, said),
            Stage::Result => self.concluded(state, peak.map_or(0.0, |(_, height)| height), said),
        }
    }

    /// The height of the peak against the noise of the correlation, as a sentence.
    fn judged(state: &State) -> String {
        let sigmas = state.sigmas().unwrap_or_default();
        let against = format!(
            "The standard deviation of r is 1/√{} = {}, so this is {} standard deviations; ",
            grouped(state.kept),
            fixed(state.sigma(), 3),
            fixed(sigmas, 1)
        );
        let needed = fixed(state.least_sigmas, 1);
        match state.is_significant() {
            true => format!("{against}random phases reach {needed} in 1 % of all pairs, so the peak is accepted."),
            false => format!(
                "{against}random phases reach {needed} in 1 % of all pairs, so the peak is rejected and the displacement unknown."
            ),
        }
    }

    fn ratio(state: &State) -> Option<f64> {
        let [best, second] = [state.peak?, state.second?].map(|place| state.height_at(state.wrapped(place)));
        (second > 0.0).then(|| best / second)
    }

    fn second(&self, state: &State, peak: Option<([i32; 2], f64)>, said: Sentence) -> Sentence {
        let (Some(_), Some(second)) = (peak, state.second) else {
            return said.text("Without a peak beside the highest one there is nothing to compare it with.");
        };
        let at = state.wrapped(second);
        let said = said
            .text("The second-highest peak is ")
            .ink(Role::Rejected, format!("r = {}", fixed(state.height_at(at), 3)))
            .text(format!(" at {}. ", whole(at)));
        if let Some(doubt) = &state.doubt {
            return said.text(doubted(doubt));
        }
        match Self::ratio(state) {
            Some(ratio) if ratio < DISTINCT => said.text(format!(
                "The highest is only {} times as high, less than {}: the peak is ambiguous, because the motion is no pure \
                 translation, or the frames have little in common.",
                fixed(ratio, 2),
                fixed(DISTINCT, 2)
            )),
            Some(ratio) => said.text(format!(
                "The highest is {} times as high, at least {}: the peak is distinct.",
                fixed(ratio, 2),
                fixed(DISTINCT, 2)
            )),
            None => said.text("It is not above 0, so the peak is distinct."),
        }
    }

    fn refined(&self, state: &State, axis: usize, said: Sentence) -> Sentence {
        let along = ["x", "y"][axis];
        let Some([before, at, after]) = Self::around(state, axis) else {
            return said
                .text(format!("Along {along} no neighbours of a peak are known, so there is no sub-pixel offset."));
        };
        let heights = format!(
            "Along {along} the peak and its neighbours have the heights {}, {} and {}. ",
            fixed(before, 3),
            fixed(at, 3),
            fixed(after, 3)
        );
        let offset = format!("{} px", fixed(state.fraction[axis], 3));
        let said = said.text(heights);
        match self.subpixel {
            Subpixel::None => said.text("Sub-pixel refinement is off, so the displacement stays whole."),
            Subpixel::Ratio => said
                .text("A fraction of a pixel spreads the peak to one side. The share of the higher neighbour in the sum with the peak, \
                       without what the window adds to both sides, is the offset, ")
                .ink(Role::Estimate, offset)
                .text("."),
            Subpixel::Parabola => said
                .text("The parabola through them has its vertex at ")
                .ink(Role::Estimate, offset)
                .text(" from the peak."),
        }
    }

    fn concluded(&self, state: &State, height: f64, said: Sentence) -> Sentence {
        let model = state.model();
        if state.peak.is_none() {
            return said.text(format!(
                "The translation remains unknown. No frequency is kept, because the strongest has {} times the cross power of rounding, and more than \
                 {} times is needed. Without texture no method finds a displacement.",
                fixed(state.highest_snr, 1),
                fixed(self.min_snr.into(), 1)
            ));
        }
        if let Some(doubt) = state.doubt.as_ref().filter(|doubt| doubt.is_refuting()) {
            return said.text("The translation remains unknown. ").text(doubted(doubt)).text(remedy(doubt));
        }
        if !state.is_accepted() {
            return said.text("The translation remains unknown: the peak is ").ink(Role::Rejected, "rejected").text(format!(
                ", because {} standard deviations of r are less than {}. The phases of most frequencies do not agree: the frames share no \
                 translation, as with rotation, zoom or several motions, or noise covers a smooth texture. Image alignment or matched features \
                 need no common phase.",
                fixed(state.sigmas().unwrap_or_default(), 1),
                fixed(state.least_sigmas, 1)
            ));
        }
        let said =
            said.text("Translation of the whole picture: ").ink(Role::Result, exact(state.translation())).text(".");
        let truth = state.fixed.truth.as_deref();
        let error = truth.and_then(|truth| metrics::flow_error(&model.displacements_of_pixels(), truth).ok().flatten());
        let said = match &error {
            Some(error) => said.text(format!(" Mean endpoint error over all pixels: {} px.", fixed(error.epe_px, 3))),
            None => said,
        };
        if let Some(doubt) = &state.doubt {
            return said.text(format!(" {}", doubted(doubt)));
        }
        let advice = match Self::ratio(state) {
            Some(ratio) if ratio < DISTINCT && height > AGREEMENT => {
                " The peak is high but broad, because few frequencies are kept: the pictures have little fine texture."
                    .to_owned()
            }
            Some(ratio) if ratio < DISTINCT => format!(
                " A peak of only {} means that few phases agree: rotation, zoom or several motions need image alignment or matched \
                 features.",
                fixed(height, 3)
            ),
            // One peak may be that of most of the picture only.
            _ => format!(" The peak of {} stands out, {}", fixed(height, 3), explained(state, error.as_ref())),
        };
        said.text(advice)
    }

    fn readouts(&self, stage: Stage, state: &State) -> Vec<Readout> {
        let mut readouts = vec![Readout::Facts(self.facts(stage, state))];
        readouts.extend(self.equation(stage, state).map(Readout::Equation));
        readouts.push(Readout::Tiles(self.tiles(stage, state)));
        let is_correlation =
            matches!(stage, Stage::InverseRows | Stage::Peak | Stage::Second | Stage::Subpixel(_) | Stage::Result);
        if is_correlation {
            readouts.push(Readout::Surface(surface(stage, state)));
        }
        if let (Stage::Result, Some(matrix)) = (stage, state.model().matrix) {
            let entries = Grid::from_fn(3, 3, |x, y| matrix[y][x]);
            readouts.push(Readout::Matrices(vec![Matrix {
                symbol: "H",
                name: "translation",
                role: Some(Role::Result),
                entries,
                rows: Vec::new(),
                columns: Vec::new(),
                changed: None,
                decimals: None,
            }]));
        }
        readouts
    }

    fn facts(&self, stage: Stage, state: &State) -> Vec<Fact> {
        let (width, height) = state.size();
        let mut facts = vec![Fact::new("Frequencies", format!("{width} × {height}"), None)];
        if state.done > 7 {
            facts.push(Fact::new("Kept", grouped(state.kept), None));
        }
        let of = |place| {
            let at = state.wrapped(place);
            format!("r = {} at {}", fixed(state.height_at(at), 3), whole(at))
        };
        facts.extend(state.peak.map(|peak| Fact::new("Highest peak", of(peak), Some(Role::Best))));
        if let Some(sigmas) = state.sigmas() {
            let (height, least) = (fixed(sigmas, 1), fixed(state.least_sigmas, 1));
            let role = if state.is_accepted() { Role::Best } else { Role::Rejected };
            facts.push(Fact::new("Peak / σ of r", format!("{height}, at least {least} needed"), Some(role)));
        }
        facts.extend(state.second.map(|second| Fact::new("Second peak", of(second), Some(Role::Rejected))));
        let ratio = Self::ratio(state).map(|ratio| Fact::new("Peak ratio", fixed(ratio, 2), None));
        facts.extend(ratio);
        if matches!(stage, Stage::Subpixel(_) | Stage::Result) && state.is_accepted() {
            facts.push(Fact::new("Displacement", exact(state.translation()), Some(Role::Estimate)));
        }
        let middle = state.fixed.truth.as_ref().and_then(|truth| truth.at(width / 2, height / 2));
        let truth = middle.filter(|_| stage == Stage::Result);
        facts.extend(
            truth.map(|uv| Fact::new("True displacement in the middle", exact(uv.map(f64::from)), Some(Role::Truth))),
        );
        facts
    }

    fn equation(&self, stage: Stage, state: &State) -> Option<Vec<Math>> {
        let text = |text: &str| Math::text(text.to_owned());
        let spectrum = |index: &str| Math::indexed(Math::Var("G"), text(index));
        Some(match stage {
            Stage::Window(_) => vec![Math::Row(vec![
                text("w(i) = ½ − ½ cos(2π (i + ½) / n), "),
                Math::Var("g"),
                text("(x, y) = (I(x, y) − mean) · w(x) · w(y)"),
            ])],
            Stage::Cross => vec![Math::Row(vec![
                Math::Var("C"),
                text(" = "),
                spectrum("2"),
                text(" · "),
                Math::mean(spectrum("1")),
                text(" = |C| · exp(−2πi (f d_x + g d_y))"),
            ])],
            Stage::Normalize => {
                vec![Math::Row(vec![
                    Math::Var("R"),
                    text(" = "),
                    Math::over(Math::Var("C"), Math::abs(Math::Var("C"))),
                ])]
            }
            Stage::Subpixel(axis) if self.subpixel != Subpixel::None => {
                let [before, at, after] = Self::around(state, axis)?;
                let show = |value: f64| fixed(value, 3);
                let fraction = match self.subpixel {
                    Subpixel::Parabola => Math::over(
                        Math::text(format!("{} − {}", show(before), show(after))),
                        Math::text(format!("2 · ({} − 2 · {} + {})", show(before), show(at), show(after))),
                    ),
                    _ => {
                        let (side, sign) = larger_side([before, after]);
                        let sign = if sign > 0.0 { "" } else { "−" };
                        let share =
                            Math::over(Math::text(show(side)), Math::text(format!("{} + {}", show(side), show(at))));
                        Math::Row(vec![text(sign), share])
                    }
                };
                vec![Math::Row(vec![
                    text("δ = "),
                    fraction,
                    text(" = "),
                    Math::ink(Role::Estimate, format!("{} px", show(state.fraction[axis]))),
                ])]
            }
            _ => return None,
        })
    }

    /// The picture of the stage.
    fn tiles(&self, stage: Stage, state: &State) -> Vec<Tile> {
        let shown = |label, values: Grid<f32>| {
            let values = spectrum::reduced(&values, CELLS);
            let known = values.cells().iter().copied().filter(|value| value.is_finite());
            let range = known.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)]);
            let range = if range[0] < range[1] { range } else { [0.0, 1.0] };
            Tile { label, role: None, values, range, framed: Vec::new() }
        };
        let magnitude = |of: rustfft::num_complex::Complex<f64>| (1.0 + of.norm()).ln();
        let labels = |i: usize, labels: [&'static str; 2]| labels[i];
        match stage {
            Stage::Window(i) => {
                let label = labels(i, ["frame t, windowed", "frame t+1, windowed"]);
                state.spectra[i].iter().map(|picture| shown(label, picture.map(|value| value.re as f32))).collect()
            }
            Stage::Rows(i) => {
                let label = labels(i, ["rows of G₁, log magnitude", "rows of G₂, log magnitude"]);
                state.spectra[i].iter().map(|picture| shown(label, spectrum::centred(picture, magnitude))).collect()
            }
            Stage::Columns(i) => {
                let label = labels(i, ["|G₁|, logarithmic", "|G₂|, logarithmic"]);
                let picture = state.spectra[i].iter();
                picture.map(|picture| shown(label, spectrum::centred(picture, magnitude))).collect()
            }
            Stage::Cross => {
                let both = |picture| {
                    let phase = spectrum::centred(picture, |value| value.arg());
                    [shown("|C|, logarithmic", spectrum::centred(picture, magnitude)), shown("phase of C", phase)]
                };
                state.cross.iter().flat_map(|cross| both(cross)).collect()
            }
            Stage::Normalize => {
                let real = |picture| shown("real part of R", spectrum::centred(picture, |value| value.re));
                state.cross.iter().map(|cross| real(cross)).collect()
            }
            Stage::InverseColumns => {
                let picture = state.cross.iter();
                picture
                    .map(|cross| shown("columns of r, magnitude", spectrum::centred(cross, |value| value.norm())))
                    .collect()
            }
            _ => {
                let picture = state.cross.iter();
                picture
                    .map(|cross| shown("r, displacement 0 in the middle", spectrum::centred(cross, |value| value.re)))
                    .collect()
            }
        }
    }

    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let (width, height) = seen.before.size();
        let Some(Event { stage, state }) = seen.events.last() else { return };
        let [width, height] = [width, height].map(|c| c as f32);
        if *stage == Stage::Result && state.is_accepted() {
            scene.mark(
                Picture::CURRENT,
                Role::Result,
                Shape::Flow { origin: [0.0; 2], values: state.model().displacements_of_pixels().0 },
            );
            scene.legend(Role::Result, "translation");
            return;
        }
        // Where the window has half its height.
        let half = if self.hann { [0.25, 0.75] } else { [0.0, 1.0] };
        let edge = |share: f32| [share * width - 0.5, share * height - 0.5];
        let on = if matches!(stage, Stage::Window(1) | Stage::Rows(1) | Stage::Columns(1)) {
            Picture::NEXT
        } else {
            Picture::CURRENT
        };
        scene.mark(on, Role::Window, Shape::Rect { min: edge(half[0]), max: edge(half[1]) });
        scene.legend(Role::Window, if self.hann { "half height of the Hann window" } else { "window" });
    }
}

/// The correlation around its peak.
fn surface(stage: Stage, state: &State) -> Surface {
    let (width, height) = state.size();
    let middle = state.peak.map_or([0, 0], |peak| state.wrapped(peak));
    let reach = [width, height].map(|extent| (extent as i32 / 2).min(REACH));
    // With the displacement 0, where there is room.
    let middle = [0, 1].map(|i| if middle[i].abs() <= reach[i] { 0 } else { middle[i] });
    let origin = [middle[0] - reach[0], middle[1] - reach[1]];
    let size = reach.map(|reach| (2 * reach + 1) as usize);
    let values =
        Grid::from_fn(size[0], size[1], |x, y| state.height_at([origin[0] + x as i32, origin[1] + y as i32]) as f32);
    let middle = state.fixed.truth.as_ref().and_then(|truth| truth.at(width / 2, height / 2));
    Surface {
        best: state.peak.map(|peak| state.wrapped(peak)),
        between: if matches!(stage, Stage::Subpixel(_) | Stage::Result) {
            vec![BetweenPixels::of_unknown(state.translation().map(|c| c as f32))]
        } else {
            Vec::new()
        },
        truth: middle.filter(|_| stage == Stage::Result),
        is_similarity: true,
        // A translation of the whole picture is shown from its middle.
        footing: Some(Footing::new(Picture::CURRENT, [width, height].map(|side| (side as f32 - 1.0) / 2.0))),
        ..Surface::new("r", origin, values, Grid::new(size[0], size[1], Some(1)))
    }
}
