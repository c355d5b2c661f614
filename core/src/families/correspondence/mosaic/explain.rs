//! The explanation and the drawing of a mosaic.

use std::sync::Arc;

use super::{Event, Mosaic, Placed, State, line};
use crate::base::words::{self, fixed, grouped};
use crate::methods::camera_path::{
    Blending, Canvas as Sheet, bent_pairs, chain_facts, chain_step, draw_link, matrix, outline, path_series,
    unknown_pairs,
};
use crate::methods::numbers::percent;
use crate::products::{PathField, Views};
use crate::run::Seen;
use crate::scene::{Canvas, Fact, Math, Picture, PictureRole, Readout, Role, Scene, Sentence, Shape, Step};

/// The mosaic.
const MOSAIC: Picture = Picture { role: PictureRole::Mosaic, ..Picture::CURRENT };

/// A chained path that ends farther than this from the true one shows seams, in px.
const SEAMS_PX: f64 = 3.0;

fn size(canvas: &Sheet) -> String {
    let (width, height) = canvas.window.size;
    format!("{}×{} px", grouped(width), grouped(height))
}

impl State {
    fn field(&self) -> PathField {
        PathField {
            picture: self.chain.picture,
            first: self.chain.span.first,
            motions: self.chain.motions.to_vec(),
            corrections: Vec::new(),
            views: Views::None,
        }
    }
}

impl Mosaic {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let Some(event) = seen.events.last() else {
            let said = "A mosaic registers all frames of a shot in one coordinate system. The motions of consecutive frames are chained \
                        first; this is exact for a rotating camera or a planar scene.";
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
            Event::Bounded(canvas) => (line::BOUND, Self::bounded(seen.before, canvas)),
            Event::Found(placed) => (line::PLACE, Self::found(seen.before, placed)),
            Event::Blended(placed) => (line::BLEND, self.blended(seen, placed)),
        };
        Step { values: Vec::new(), line, sentence, readouts: self.readouts(seen, event) }
    }

    fn bounded(state: &State, canvas: &Sheet) -> Sentence {
        let frames = state.chain.to_frames.len();
        let said = Sentence::default()
            .text(format!(
                "The mosaic takes the coordinates of frame {}, in the middle of the shot, so that errors of the chain grow to both \
                 sides alike. All outlines span ",
                state.chain.span.first + state.reference()
            ))
            .ink(Role::Result, size(canvas));
        match canvas.complete == frames {
            true => said.text("."),
            false => said.text(format!(
                "; {} {} cut, because the outline would make the mosaic too large or reach infinity. A shorter shot or a simpler motion model \
                 helps.",
                words::counted(frames - canvas.complete, "frame"),
                if frames - canvas.complete == 1 { "is" } else { "are" }
            )),
        }
    }

    fn found(state: &State, placed: &Placed) -> Sentence {
        let number = state.chain.span.first + state.placed;
        if placed.map.is_none() {
            return Sentence::default()
                .text(format!("Frame {number} has "))
                .ink(Role::Rejected, "no place on the mosaic")
                .text(": its map A to the reference frame has no inverse. A shorter shot or a simpler motion model helps.");
        }
        Sentence::default()
            .text(format!(
                "Frame {number} is registered by A = P({}) P({number})⁻¹: its outline on the mosaic is the ",
                state.chain.span.first + state.reference()
            ))
            .ink(Role::Result, "marked quadrilateral")
            .text(".")
    }

    fn blended(&self, seen: &Seen<Self>, placed: &Placed) -> Sentence {
        let number = seen.before.chain.span.first + seen.before.placed;
        let said = Sentence::default().text(match (placed.map, self.blending) {
            (None, _) => format!("Frame {number} has no place on the mosaic and is left out. "),
            (_, Blending::Mean) => format!(
                "Frame {number} is blended in, with weights that fall to 0 at its border: seams vanish, but moving objects leave faint \
                 ghosts. "
            ),
            (_, Blending::Newest) => format!(
                "Frame {number} is blended in: it covers all earlier frames, so each moving object is shown where it was last, with \
                 seams. "
            ),
        });
        let said = said.ink(Role::Result, percent(placed.canvas.covered())).text(" of the mosaic is covered.");
        match seen.after.filter(|after| after.done.is_some()) {
            Some(after) => said.text(Self::concluded(seen, after)),
            None => said,
        }
    }

    /// The conclusion of the run.
    fn concluded(seen: &Seen<Self>, after: &State) -> String {
        let drift = after.field().errors(seen.clip).map(|errors| errors.drift_px);
        let frames = words::counted(after.chain.to_frames.len(), "frame");
        let quality = match drift {
            Err(error) => format!(" The drift of the path is unknown. {error}."),
            Ok(Some(drift)) if !drift.is_finite() => {
                " The chained map of the last frame sends a corner of the picture to infinity.".to_owned()
            }
            Ok(Some(drift)) if drift > SEAMS_PX => format!(
                " At the end of the chained path the corners are up to {} px off: parallax, moving objects or a model with too much freedom. Blurred \
                 seams show it.",
                fixed(drift, 2)
            ),
            Ok(Some(drift)) => {
                format!(" At the end of the chained path the corners are up to {} px off.", fixed(drift, 2))
            }
            Ok(None) => {
                " Double edges show errors of the chained path; broken straight lines show parallax.".to_owned()
            }
        };
        format!(
            " End of the run: {frames} in one picture.{quality}{}{}",
            unknown_pairs(&after.chain),
            bent_pairs(&after.chain)
        )
    }

    fn readouts(&self, seen: &Seen<Self>, event: &Event) -> Vec<Readout> {
        let state = seen.before;
        let chain = &seen.after.unwrap_or(state).chain;
        match event {
            Event::Estimated(link) | Event::Chained(link) => {
                let is_chained = matches!(event, Event::Chained(_));
                let mut all = vec![matrix("M", "motion of the pair", Role::Measured, &link.motion)];
                if is_chained {
                    all.push(matrix("P", "from the first frame", Role::Result, &link.after));
                }
                let facts = Readout::Facts(chain_facts(&state.chain, link, is_chained));
                let shown = if is_chained { chain } else { &state.chain };
                [vec![facts, Readout::Matrices(all)], path_series(shown, &[], seen.clip)].concat()
            }
            Event::Bounded(canvas) => {
                let facts = vec![
                    Fact::new("Mosaic", size(canvas), Some(Role::Result)),
                    Fact::new("Frames on it", canvas.complete.to_string(), None),
                    Fact::new("Reference frame", (chain.span.first + state.reference()).to_string(), None),
                ];
                [vec![Readout::Facts(facts)], path_series(chain, &[], seen.clip)].concat()
            }
            Event::Found(placed) | Event::Blended(placed) => {
                let facts = vec![
                    Fact::new("Frame", (chain.span.first + state.placed).to_string(), None),
                    Fact::new("Mosaic", size(&placed.canvas), None),
                    Fact::new("Frames blended", (state.placed + 1).to_string(), None),
                ];
                let path = matrix("P", "from the first frame", Role::Measured, &chain.to_frames[state.placed]);
                let mut all = vec![path];
                all.extend(placed.map.as_ref().map(|map| matrix("A", "to the mosaic", Role::Result, map)));
                let shown = vec![Readout::Facts(facts), Readout::Equation(equation()), Readout::Matrices(all)];
                [shown, path_series(chain, &[], seen.clip)].concat()
            }
        }
    }

    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        match seen.events.last() {
            None => {}
            Some(Event::Estimated(link) | Event::Chained(link)) => draw_link(&seen.before.chain, link, scene),
            Some(Event::Bounded(canvas)) => {
                show(canvas, scene);
                for i in 0..seen.before.chain.to_frames.len() {
                    draw_outline(canvas, (seen.before, i), Role::Window, scene);
                }
                scene.legend(Role::Window, "outline of a frame");
            }
            Some(Event::Found(placed) | Event::Blended(placed)) => {
                // The frame itself appears with its blending.
                match (seen.events.last(), &seen.before.canvas) {
                    (Some(Event::Found(_)), Some(before)) => show(before, scene),
                    _ => show(&placed.canvas, scene),
                }
                draw_outline(&placed.canvas, (seen.before, seen.before.placed), Role::Result, scene);
                scene.legend(Role::Result, "outline of frame t");
            }
        }
    }
}

/// A = P(c) P(t)⁻¹ in symbols.
fn equation() -> Vec<Math> {
    vec![Math::Row(vec![
        Math::Var("A"),
        Math::text(" = "),
        Math::Var("P"),
        Math::text("(c) "),
        Math::power(Math::Row(vec![Math::Var("P"), Math::text("(t)")]), Math::text("−1")),
    ])]
}

/// Shows the frame beside the mosaic so far.
fn show(canvas: &Arc<Sheet>, scene: &mut Scene) {
    let canvas = Arc::clone(canvas);
    scene.pictures = vec![Canvas::of_clip(Picture::CURRENT), Canvas::made(MOSAIC, move || canvas.picture())];
}

/// Draws the outline of frame `i` of the run on the mosaic.
fn draw_outline(canvas: &Sheet, (state, i): (&State, usize), role: Role, scene: &mut Scene) {
    let origin = canvas.window.origin.map(f64::from);
    let corners = state.to_reference(i).and_then(|map| outline(&map, state.chain.picture));
    let Some(corners) = corners else { return };
    let points = corners.iter().map(|at| [0, 1].map(|c| (at[c] - origin[c]) as f32)).collect();
    scene.mark(MOSAIC, role, Shape::Path { points, closed: true });
}
