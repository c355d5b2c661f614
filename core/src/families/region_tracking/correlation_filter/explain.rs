//! The explanation and the drawing of the correlation filter.

use super::perturbation::PERTURBED_SCALE;
use super::{CorrelationFilter, Event, Evidence, Model, Response};
use crate::base::words::{counted, fixed, place};
use crate::geometry::Grid;
use crate::methods::numbers::ratio;
use crate::methods::region::{At, Ending, Explained, Outcome};
use crate::scene::{
    Arrow, BetweenPixels, Fact, Footing, Math, Picture, Readout, Role, Scene, Sentence, Shape, Surface, Tile,
};

/// The response is drawn as a surface up to this displacement, in px.
const REACH_PX: i32 = 24;

fn psr(value: f32) -> String {
    fixed(value.into(), 2)
}

impl Explained for CorrelationFilter {
    fn sentence(&self, at: &At<'_, Self>) -> Sentence {
        let said = Sentence::default();
        match at.event {
            Event::Learned(patch, _) => said
                .text("The ")
                .ink(Role::Reference, "filter H*")
                .text(format!(
                    " is learned from a window of {}×{} px{}. It minimises the squared difference of its response from a Gaussian of \
                     σ = {} px at the object.",
                    patch.width(),
                    patch.height(),
                    self.perturbed_copies(),
                    fixed(self.sigma.into(), 1)
                )),
            Event::Cut(response) => {
                let (width, height) = response.patch.size();
                said.ink(Role::Window, format!("The window of {width}×{height} px")).text(
                    " around the last position: the logarithm of its gray levels, without their mean and of norm 1, so that brightness and \
                     contrast do not matter, and under the Hann window, which fades to its border.",
                )
            }
            Event::Responded(response) => said.text(format!(
                "The product of the spectrum with the filter is transformed back: a response for all {} displacements at once.",
                crate::base::words::grouped(response.values.cells().len())
            )),
            Event::Found(response) => said
                .text("The highest response, ")
                .ink(Role::Best, ratio(response.values[response.peak].into()))
                .text(format!(
                    ", lies at a displacement of {} px, with parabolas along x and y. A perfect match would give 1.",
                    place(response.displacement)
                )),
            Event::Judged(response, evidence) => self.judged(response, evidence.as_ref(), said),
            Event::Updated(..) => said.text(format!(
                "The window at the new position is averaged into numerator and denominator of the filter with η = {}, so that it follows \
                 changes of appearance.",
                ratio(self.learning_rate.into())
            )),
        }
    }

    fn facts(&self, at: &At<'_, Self>) -> Vec<Fact> {
        match at.event {
            Event::Found(response) | Event::Judged(response, _) => {
                let mut facts = vec![
                    Fact::new("Displacement", format!("{} px", place(response.displacement)), Some(Role::Best)),
                    Fact::new("Peak", ratio(response.values[response.peak].into()), Some(Role::Best)),
                    Fact::new("Peak-to-sidelobe ratio", psr(response.psr), Some(Role::Measured)),
                ];
                if let Some(Evidence { zncc, coefficients: [object, around] }) = evidence(at) {
                    let zncc = zncc.map_or_else(|| "undefined, a region is uniform".into(), ratio);
                    facts.push(Fact::new("ZNCC with the first region", zncc, None));
                    let levels = format!("{} and {}", ratio(*object), ratio(*around));
                    facts.push(Fact::new("ρ of gray levels, object and surroundings", levels, None));
                }
                facts
            }
            Event::Cut(response) | Event::Responded(response) | Event::Updated(response, _) => {
                let (width, height) = response.patch.size();
                vec![Fact::new("Window", format!("{width}×{height} px"), Some(Role::Window))]
            }
            Event::Learned(..) => Vec::new(),
        }
    }

    fn readouts(&self, at: &At<'_, Self>) -> Vec<Readout> {
        let filter = || at.model.map(filter_tile);
        match at.event {
            Event::Learned(patch, model) => {
                let numbers = |name| Math::indexed(Math::Var(name), Math::Var("i"));
                let sum = |of: Vec<Math>| Math::Row(vec![Math::Sum(Box::new(Math::Var("i"))), Math::Row(of)]);
                let star = |name| Math::power(numbers(name), Math::text("*"));
                let formula = Math::Row(vec![
                    Math::power(Math::Var("H"), Math::text("*")),
                    Math::text(" = "),
                    Math::over(sum(vec![numbers("G"), star("F")]), sum(vec![numbers("F"), star("F")])),
                ]);
                vec![Readout::Equation(vec![formula]), Readout::Tiles(vec![patch_tile(patch), filter_tile(model)])]
            }
            Event::Cut(response) => {
                vec![Readout::Tiles([patch_tile(&response.patch)].into_iter().chain(filter()).collect())]
            }
            Event::Responded(response) | Event::Found(response) => {
                let tiles = [patch_tile(&response.patch)].into_iter().chain(filter()).chain([response_tile(response)]);
                vec![Readout::Tiles(tiles.collect()), Readout::Surface(surface(response))]
            }
            Event::Judged(response, _) => {
                let [mean, deviation] = response.sidelobes;
                let peak = response.values[response.peak];
                let formula = Math::Row(vec![
                    Math::text("PSR = "),
                    Math::over(
                        Math::text(format!("{} − {}", ratio(peak.into()), ratio(mean.into()))),
                        Math::text(fixed(deviation.into(), 4)),
                    ),
                    Math::text(" = "),
                    Math::ink(Role::Measured, psr(response.psr)),
                ]);
                vec![Readout::Equation(vec![formula]), Readout::Surface(surface(response))]
            }
            Event::Updated(_, model) => {
                let formula = Math::Row(vec![
                    Math::Var("A"),
                    Math::text(" ← η "),
                    Math::Var("G"),
                    Math::power(Math::Var("F"), Math::text("*")),
                    Math::text(" + (1 − η) "),
                    Math::Var("A"),
                ]);
                let updated = Tile { label: "filter, updated", ..filter_tile(model) };
                vec![Readout::Equation(vec![formula]), Readout::Tiles(filter().into_iter().chain([updated]).collect())]
            }
        }
    }

    fn draw(&self, at: &At<'_, Self>, scene: &mut Scene) {
        let response = match at.event {
            Event::Learned(patch, model) => {
                window(scene, model.origin(at.region.center), patch.size());
                return;
            }
            Event::Cut(response) => {
                window(scene, response.origin, response.patch.size());
                return;
            }
            Event::Responded(response)
            | Event::Found(response)
            | Event::Judged(response, _)
            | Event::Updated(response, _) => response,
        };
        let (width, height) = response.values.size();
        let origin = response.origin.map(|c| c as f32);
        scene.mark(Picture::CURRENT, Role::Candidate, Shape::Heat { origin, values: response.values.clone() });
        scene.heat = Some("response g");
        window(scene, response.origin, (width, height));
        if matches!(at.event, Event::Responded(_)) {
            return;
        }
        let from = [origin[0] + (width / 2) as f32, origin[1] + (height / 2) as f32];
        let to = [0, 1].map(|i| from[i] + response.displacement[i]);
        scene.mark(Picture::CURRENT, Role::Predicted, Shape::Arrows(vec![Arrow { from, to }]));
        scene.legend(Role::Predicted, "displacement of the peak");
        scene.mark(Picture::CURRENT, Role::Best, Shape::Points(vec![to]));
        scene.legend(Role::Best, "peak");
    }

    fn loss(&self, at: &At<'_, Self>) -> Option<String> {
        let Event::Judged(_, evidence) = at.event else { return None };
        Some(match evidence {
            None => "the peak does not stand out".into(),
            Some(_) => "the region holds its surroundings and not the object of the first frame".into(),
        })
    }

    fn caveat(&self, at: &At<'_, Self>) -> Option<String> {
        let unlike = evidence(at).filter(|evidence| evidence.is_unlike())?;
        Some(format!(
            "The region has a ZNCC of {} with that of the first frame: the object has turned, changed or is covered, or the filter, which \
             adapts, follows something else. The peak-to-sidelobe ratio cannot tell these apart.",
            ratio(unlike.zncc?)
        ))
    }

    fn advice(&self, ending: Ending, _at: &At<'_, Self>) -> String {
        match ending.outcome {
            Outcome::Followed => {
                "The filter knows shape and texture, so colours of the background do not attract it; it has no scale, and a velocity is \
                 not predicted."
            }
            Outcome::Regained => "The overlap was low for a while: by a fast motion, a change of appearance, or a change of size, as the region keeps its own. A template \
                 tracker follows a change of size.",
            Outcome::Grown | Outcome::Shrunk => {
                "The region keeps the size of the first frame, and the object changed its own: this filter has no scale."
            }
            Outcome::Beside | Outcome::Unknown => {
                "The peak lies beside the object: windows that were off by some pixels, or of another pose, were averaged into the filter. Where \
                 blur or light changed the appearance, mean shift keeps to the colours."
            }
            Outcome::Lost if ending.hidden > 0 => {
                return format!(
                    "The object was hidden in {}. The filter searches around the last position, and a velocity is not predicted.",
                    counted(ending.hidden, "frame")
                );
            }
            Outcome::Lost => {
                "Between two frames the object left the window of the filter, turned farther than the perturbations, was hidden for long, or \
                 changed faster than the learning rate follows. A larger window reaches farther, and a larger rotation recognises more poses."
            }
        }
        .into()
    }
}

impl CorrelationFilter {
    /// The perturbations as a part of a sentence.
    fn perturbed_copies(&self) -> String {
        if self.perturbations == 0 {
            return " alone".to_owned();
        }
        format!(
            " and {} of it, turned by up to {}° and scaled by up to {} % at random, so that a turn between two frames does not lower the peak",
            counted(self.perturbations, "perturbation"),
            fixed(self.rotation.into(), 0),
            fixed(100.0 * PERTURBED_SCALE, 0)
        )
    }

    fn judged(&self, response: &Response, evidence: Option<&Evidence>, said: Sentence) -> Sentence {
        let [mean, deviation] = response.sidelobes;
        let said = said.text("Peak-to-sidelobe ratio: ").ink(Role::Measured, psr(response.psr)).text(format!(
            ", from sidelobes of mean {} and standard deviation {} outside 11×11 px around the peak",
            ratio(mean.into()),
            fixed(deviation.into(), 4)
        ));
        let least = psr(self.min_psr);
        let Some(evidence) = evidence else {
            return said.text(format!(
                ", below {least}. The peak does not stand out, as under occlusion or a turn beyond the perturbations: the filter is \
                 not updated."
            ));
        };
        let said = said.text(format!(", not below {least}: the peak stands out"));
        let [object, around] = evidence.coefficients.map(ratio);
        let pattern = || match evidence.zncc {
            Some(zncc) => format!("has a ZNCC of {} with that of the first frame", ratio(zncc)),
            None => "is uniform, or was in the first frame".into(),
        };
        if self.is_gone(evidence) {
            return said.text(format!(
                ". But the region there {}, and its gray levels are those of its surroundings (Bhattacharyya coefficient {around}) rather than \
                 those of the object ({object}). The filter answers to what is behind the object, so it is not updated.",
                pattern()
            ));
        }
        said.text(match evidence.is_unlike() {
            true => format!(
                ", and the match is accepted, although the region there {}: its gray levels (Bhattacharyya coefficient {object} with the object, \
                 {around} with the surroundings) do not tell that the object is gone.",
                pattern()
            ),
            false => ", and the match is accepted.".into(),
        })
    }
}

/// The comparison with the first region in a frame.
fn evidence<'a>(at: &At<'a, CorrelationFilter>) -> Option<&'a Evidence> {
    at.events.iter().find_map(|event| if let Event::Judged(_, evidence) = *event { evidence.as_ref() } else { None })
}

/// A tile with the range of its values.
fn tile(label: &'static str, role: Option<Role>, values: Grid<f32>) -> Tile {
    let range =
        values.cells().iter().fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], v| [low.min(*v), high.max(*v)]);
    let range = if range[0] < range[1] { range } else { [0.0, 1.0] };
    Tile { label, role, values, range, framed: Vec::new() }
}

fn patch_tile(patch: &Grid<f32>) -> Tile {
    tile("window f", Some(Role::Window), patch.clone())
}

fn response_tile(response: &Response) -> Tile {
    tile("response g", Some(Role::Best), response.values.clone())
}

/// The filter as a picture: what the windows are correlated with.
fn filter_tile(model: &Model) -> Tile {
    let mut filter = model.filter();
    filter.iter_mut().for_each(|value| *value = value.conj());
    let filter = model.fixed.transform.inverse(filter);
    let (width, height) = model.size();
    // Displacement 0 in the middle, where the Gaussian has its peak.
    let values = Grid::from_fn(width, height, |x, y| {
        let turned = |c: usize, extent: usize| (c + extent - extent / 2) % extent;
        filter[turned(y, height) * width + turned(x, width)]
    });
    tile("filter h", Some(Role::Reference), values)
}

/// The response around displacement 0.
fn surface(response: &Response) -> Surface {
    let (width, height) = response.values.size();
    let middle = [width as i32 / 2, height as i32 / 2];
    let reach = [(width as i32 - 1) / 2, (height as i32 - 1) / 2].map(|side| side.min(REACH_PX));
    let size = reach.map(|reach| (2 * reach + 1) as usize);
    let values = Grid::from_fn(size[0], size[1], |x, y| {
        let at = [x as i32 - reach[0] + middle[0], y as i32 - reach[1] + middle[1]];
        response.values[(at[0] as usize, at[1] as usize)]
    });
    let best = [response.peak.0 as i32 - middle[0], response.peak.1 as i32 - middle[1]];
    let is_shown = (0..2).all(|i| best[i].abs() <= reach[i]);
    let origin = reach.map(|reach| -reach);
    Surface {
        best: is_shown.then_some(best),
        between: if is_shown { vec![BetweenPixels::of_unknown(response.displacement)] } else { Vec::new() },
        is_similarity: true,
        footing: Some(Footing::new(Picture::CURRENT, [0, 1].map(|i| (response.origin[i] + middle[i]) as f32))),
        ..Surface::new("g", origin, values, Grid::new(size[0], size[1], Some(1)))
    }
}

/// Draws the window of the filter.
fn window(scene: &mut Scene, [x, y]: [i32; 2], (width, height): (usize, usize)) {
    scene.mark(Picture::CURRENT, Role::Window, Shape::pixels(x, y, width, height));
    scene.legend(Role::Window, "window of the filter");
}
