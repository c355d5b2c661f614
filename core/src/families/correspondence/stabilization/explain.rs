//! The explanation and the drawing of video stabilisation.

use super::{Event, Stabilization, Stable, State, line};
use crate::base::words::{self, fixed};
use crate::methods::camera_path::{
    Chain, bent_pairs, chain_facts, chain_step, draw_link, matrix, path_series, unknown_pairs,
};
use crate::methods::numbers::percent;
use crate::products::model::{IDENTITY, Matrix3, inverse, mapped};
use crate::products::path::{PathErrors, middle};
use crate::products::registration::{Window, registered};
use crate::products::{PathField, Views};
use crate::run::Seen;
use crate::scene::{Canvas, Fact, Math, Picture, Readout, Role, Scene, Sentence, Shape, Step};

/// More of the picture empty than this is much.
const MUCH_EMPTY: f64 = 0.1;
/// A smaller share of a stabilised frame is not told.
const LEAST_EMPTY: f64 = 5e-4;
/// A motion with a larger error at the corners is not that of the background, in px.
const FOREIGN_PX: f64 = 1.0;
/// A jitter below this share of that before is suppressed well.
const SUPPRESSED: f64 = 0.5;

fn px(value: f64) -> String {
    format!("{} px", fixed(value, 2))
}

/// The state in which the pair or the frame of a step is done.
fn chain<'a>(seen: &Seen<'a, Stabilization>) -> &'a Chain {
    &seen.after.unwrap_or(seen.before).chain
}

impl State {
    fn field(&self) -> PathField {
        PathField {
            picture: self.chain.picture,
            first: self.chain.span.first,
            motions: self.chain.motions.to_vec(),
            corrections: self.corrections.to_vec(),
            views: Views::None,
        }
    }
}

impl Stabilization {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let Some(event) = seen.events.last() else {
            let said = "Stabilisation first estimates the motion of the background between all consecutive frames and chains it to the path \
                        of the camera. Then it smooths the path and warps each frame to its smoothed place.";
            return Step {
                values: Vec::new(),
                line: line::EACH_PAIR,
                sentence: Sentence::default().text(said),
                readouts: Vec::new(),
            };
        };
        let name = self.motion.estimator().info().name;
        let (line, sentence) = match event {
            Event::Estimated(link) => chain_step(&seen.before.chain, link, (false, name)),
            Event::Chained(link) => chain_step(&seen.before.chain, link, (true, name)),
            Event::Smoothed(stable) => (line::SMOOTH, self.smoothed(seen, stable)),
            Event::Warped(stable) => (line::WARP, self.warped(seen, stable)),
        };
        Step { values: Vec::new(), line, sentence, readouts: self.readouts(seen, event) }
    }

    fn smoothed(&self, seen: &Seen<Self>, stable: &Stable) -> Sentence {
        let state = seen.before;
        if !stable.is_smoothed {
            return Sentence::default()
                .text(format!("Frame {} has ", state.chain.span.first + state.corrections.len()))
                .ink(Role::Rejected, "no place on the smoothed path")
                .text(
                    ": a map between it and one of its neighbours has no inverse. It stays where it is; less smoothing or a simpler motion \
                     model helps.",
                );
        }
        let place = middle(state.chain.picture);
        let to = mapped(&stable.correction, place).unwrap_or(place);
        let [u, v] = [0, 1].map(|i| to[i] - place[i]);
        Sentence::default()
            .text(format!(
                "The path is averaged around frame {} with Gaussian weights of σ = {} frames. The centre of the frame moves by ",
                state.chain.span.first + state.corrections.len(),
                fixed(self.smoothing.into(), 1)
            ))
            .ink(Role::Result, format!("({},\u{a0}{}) px", fixed(u, 2), fixed(v, 2)))
            .text(" to the smoothed path: the shake is removed; a steady pan stays.")
    }

    fn warped(&self, seen: &Seen<Self>, stable: &Stable) -> Sentence {
        let number = seen.before.chain.span.first + seen.before.corrections.len();
        let said = Sentence::default().text(format!("Frame {number} is warped by S. "));
        let said = match stable.empty() < LEAST_EMPTY {
            true => said.text("It covers the whole stabilised frame."),
            false => said
                .ink(Role::Rejected, percent(stable.empty()))
                .text(" of the stabilised frame is empty, because the frame does not cover it; zoom hides that."),
        };
        match seen.after.filter(|after| after.corrections.len() == after.chain.to_frames.len()) {
            Some(after) => said.text(self.concluded(seen, after)),
            None => said,
        }
    }

    /// The conclusion of the run.
    fn concluded(&self, seen: &Seen<Self>, after: &State) -> String {
        let PathErrors { before_px, after_px, drift_px, motion_px, residual_px, empty } =
            match after.field().errors(seen.clip) {
                Ok(errors) => errors,
                Err(error) => return format!(" End of the run: the errors of the path are unknown. {error}."),
            };
        let mut said = " End of the run: ".to_owned();
        match before_px.zip(after_px) {
            None => said.push_str("with fewer than three frames there is no jitter to suppress."),
            Some((before, left)) => {
                said.push_str(&format!("the jitter of the path falls from {} to {}.", px(before), px(left)));
                if left > SUPPRESSED * before && before > 0.1 {
                    said.push_str(" More smoothing would suppress more of it.");
                }
            }
        }
        if let Some(residual) = residual_px {
            said.push_str(&format!(" Measured by the true motion of the background, it is {}", px(residual)));
            match drift_px {
                Some(drift) if drift.is_finite() => {
                    said.push_str(&format!(
                        ", and at the end of the chained path the corners are up to {} off.",
                        px(drift)
                    ));
                }
                _ => said.push('.'),
            }
        }
        if let Some(motion) = motion_px.filter(|motion| *motion > FOREIGN_PX) {
            said.push_str(&format!(
                " The motion of a pair is up to {} off at the corners: a large object, parallax or a motion that the model does not have, as a rotation for a translation, dominates it, so it is not \
                 that of the background.",
                px(motion)
            ));
        }
        if let Some(empty) = empty.filter(|empty| *empty > MUCH_EMPTY) {
            said.push_str(&format!(
                " On average {} of the frames is empty; less smoothing or zoom helps.",
                percent(empty)
            ));
        }
        said.push_str(&unknown_pairs(&after.chain));
        said.push_str(&bent_pairs(&after.chain));
        if after.unsmoothed > 0 {
            said.push_str(&format!(" Without a smoothed place: {}.", words::counted(after.unsmoothed, "frame")));
        }
        said
    }

    fn readouts(&self, seen: &Seen<Self>, event: &Event) -> Vec<Readout> {
        let (state, chain) = (seen.before, chain(seen));
        let mut readouts = Vec::new();
        match event {
            Event::Estimated(link) | Event::Chained(link) => {
                let is_chained = matches!(event, Event::Chained(_));
                readouts.push(Readout::Facts(chain_facts(&state.chain, link, is_chained)));
                let mut all = vec![matrix("M", "motion of the pair", Role::Measured, &link.motion)];
                if is_chained {
                    all.push(matrix("P", "from the first frame", Role::Result, &link.after));
                }
                readouts.push(Readout::Matrices(all));
                let shown = if is_chained { chain } else { &state.chain };
                readouts.extend(path_series(shown, &[], seen.clip));
            }
            Event::Smoothed(stable) | Event::Warped(stable) => {
                let index = state.corrections.len();
                let place = mapped(&stable.correction, middle(chain.picture)).unwrap_or_default();
                let facts = vec![
                    Fact::new("Frame", (chain.span.first + index).to_string(), None),
                    Fact::new("Smoothing σ", format!("{} frames", fixed(self.smoothing.into(), 1)), None),
                    Fact::new(
                        "Centre of the frame to",
                        format!("({},\u{a0}{}) px", fixed(place[0], 2), fixed(place[1], 2)),
                        Some(Role::Result),
                    ),
                    Fact::new("Empty", percent(stable.empty()), Some(Role::Rejected)),
                ];
                readouts.push(Readout::Facts(facts));
                readouts.push(Readout::Equation(equation()));
                let path = matrix("P", "from the first frame", Role::Measured, &chain.to_frames[index]);
                readouts.push(Readout::Matrices(vec![
                    path,
                    matrix("S", "to the stabilised frame", Role::Result, &stable.correction),
                ]));
                let corrections = [&state.corrections[..], &[stable.correction]].concat();
                readouts.extend(path_series(chain, &corrections, seen.clip));
            }
        }
        readouts
    }

    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        match seen.events.last() {
            None => {}
            Some(Event::Estimated(link) | Event::Chained(link)) => draw_link(&seen.before.chain, link, scene),
            Some(Event::Smoothed(stable) | Event::Warped(stable)) => {
                let size = stable.frame.size();
                draw_kept(stable, scene);
                let (frame, back) = (stable.frame.clone(), inverse(&stable.correction).unwrap_or(IDENTITY));
                let made = move || registered(&frame, &back, &Window::of(size));
                scene.pictures = vec![Canvas::of_clip(Picture::CURRENT), Canvas::made(Picture::warped(0), made)];
            }
        }
    }
}

/// S(t) in symbols.
fn equation() -> Vec<Math> {
    vec![Math::Row(vec![
        Math::Var("S"),
        Math::text("(t) = "),
        Math::Sum(Box::new(Math::Var("k"))),
        Math::text(" "),
        Math::Var("w"),
        Math::text("(k) "),
        Math::Var("P"),
        Math::text("(t + k) "),
        Math::power(Math::Row(vec![Math::Var("P"), Math::text("(t)")]), Math::text("−1")),
    ])]
}

/// The part of the frame that the stabilised one shows, and the middle of the frame in it.
fn draw_kept(stable: &Stable, scene: &mut Scene) {
    let (width, height) = stable.frame.size();
    let [right, bottom] = [(width - 1) as f64, (height - 1) as f64];
    let corners = [[0.0, 0.0], [right, 0.0], [right, bottom], [0.0, bottom]];
    let outline = |map: &Matrix3| -> Option<Vec<[f32; 2]>> {
        corners.iter().map(|at| mapped(map, *at).map(|to| to.map(|c| c as f32))).collect()
    };
    if let Some(points) = inverse(&stable.correction).as_ref().and_then(outline) {
        scene.mark(Picture::CURRENT, Role::Result, Shape::Path { points, closed: true });
        scene.legend(Role::Result, "field of view of the stabilised frame");
    }
    if let Some(points) = outline(&stable.correction) {
        scene.mark(Picture::warped(0), Role::Window, Shape::Path { points, closed: true });
        scene.legend(Role::Window, "outline of frame t");
    }
}
