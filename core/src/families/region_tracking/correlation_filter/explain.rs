//! The explanation and the drawing of the correlation filter.

use super::perturbation::PERTURBED_SCALE;
use super::vocabulary::{case, value};
use super::{CorrelationFilter, Event, Evidence, Model, Response};
use crate::geometry::Grid;
use crate::methods::region::{At, Ending, Explained, Outcome};
use crate::scene::{Arrow, BetweenPixels, Footing, Number, Picture, Readout, Role, Scene, Shape, Step, Surface, Tile};

/// The response is drawn as a surface up to this displacement, in px.
const REACH_PX: i32 = 24;

impl Explained for CorrelationFilter {
    fn step(&self, at: &At<'_, Self>, step: Step) -> Step {
        let filter = || at.model.map(filter_tile);
        match at.event {
            Event::Learned(patch, model) => {
                let step =
                    put_size(step, patch).put(value::PERTURBATIONS, self.perturbations).put(value::SIGMA, self.sigma);
                let step = step.put(value::ROTATION, self.rotation).put(value::SCALING, 100.0 * PERTURBED_SCALE);
                let step = step.say(if self.perturbations > 0 { case::LEARNED_PERTURBED } else { case::LEARNED });
                let step = step.say(case::MINIMISES);
                let step = step.formula(r"H^{\text{*}} = \frac{\sum_i G_i F_i^{\text{*}}}{\sum_i F_i F_i^{\text{*}}}");
                step.show(Readout::Tiles(vec![patch_tile(patch), filter_tile(model)]))
            }
            Event::Cut(response) => {
                let tiles = [patch_tile(&response.patch)].into_iter().chain(filter());
                put_size(step, &response.patch).say(case::CUT).show(Readout::Tiles(tiles.collect()))
            }
            Event::Responded(response) => {
                let step = put_size(step, &response.patch).put(value::DISPLACEMENTS, response.values.cells().len());
                add_charts(at, step.say(case::RESPONDED), response)
            }
            Event::Found(response) => add_charts(at, put_peak(step, response).say(case::FOUND), response),
            Event::Judged(response, evidence) => {
                let step = self.tell_verdict(put_peak(step, response), response, evidence.as_ref());
                let step =
                    step.formula(r"\text{PSR} = \frac{g_{\max} - \mu}{s} = \frac{{peak} - {mean}}{{spread}} = {psr}");
                step.show(Readout::Surface(surface(response)))
            }
            Event::Updated(response, model) => {
                let step =
                    put_size(step, &response.patch).put(value::LEARNING_RATE, self.learning_rate).say(case::UPDATED);
                let step = step.formula(r"A \gets \eta \, G F^{\text{*}} + (1 - \eta) \, A");
                let updated = Tile { label: "filter, updated", ..filter_tile(model) };
                step.show(Readout::Tiles(filter().into_iter().chain([updated]).collect()))
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
        scene.draw(
            Picture::CURRENT,
            (Role::Predicted, "displacement of the peak"),
            Shape::Arrows(vec![Arrow { from, to }]),
        );
        scene.draw(Picture::CURRENT, (Role::Best, "peak"), Shape::Points(vec![to]));
    }

    fn tell_loss(&self, at: &At<'_, Self>, step: Step) -> Step {
        match at.event {
            Event::Judged(_, evidence) => step.say(if evidence.is_some() { case::BACKGROUND } else { case::NO_PEAK }),
            _ => step,
        }
    }

    fn tell_caveat(&self, at: &At<'_, Self>, step: Step) -> Step {
        match evidence(at).filter(|evidence| evidence.is_unlike()) {
            Some(unlike) => put_zncc(step, unlike).say(case::UNLIKE),
            None => step,
        }
    }

    fn advise(&self, ending: Ending, _at: &At<'_, Self>, step: Step) -> Step {
        step.say(match ending.outcome {
            Outcome::Followed => case::FOLLOWED,
            Outcome::Regained => case::REGAINED,
            Outcome::Grown | Outcome::Shrunk => case::RESIZED,
            Outcome::Beside | Outcome::Unknown => case::BESIDE,
            Outcome::Lost if ending.hidden > 0 => case::HIDDEN,
            Outcome::Lost => case::LOST,
        })
    }
}

impl CorrelationFilter {
    fn tell_verdict(&self, step: Step, response: &Response, evidence: Option<&Evidence>) -> Step {
        let [mean, deviation] = response.sidelobes;
        let step = step.put(value::MEAN, mean).put(value::SPREAD, deviation).put(value::MIN_PSR, self.min_psr);
        let step = step.say(case::JUDGED);
        let Some(evidence) = evidence else { return step.say(case::LOW_PSR) };
        let [object, surroundings] = evidence.coefficients;
        let step = put_zncc(step, evidence).put(value::SURROUNDINGS, surroundings);
        let step = step.fact_as(value::OBJECT.is(object), case::COEFFICIENTS).say(case::HIGH_PSR);
        let pattern = if evidence.zncc.is_some() { case::ZNCC } else { case::UNIFORM };
        match (self.is_gone(evidence), evidence.is_unlike()) {
            (true, _) => step.say(case::BUT).say(pattern).say(case::LIKE_SURROUNDINGS),
            (false, true) => step.say(case::ALTHOUGH).say(pattern).say(case::NOT_GONE),
            (false, false) => step.say(case::ACCEPTED),
        }
    }
}

fn put_size(step: Step, window: &Grid<f32>) -> Step {
    let (width, height) = window.size();
    step.put(value::HEIGHT, height).fact_as(value::WIDTH.is(width), case::SIZE)
}

fn put_peak(step: Step, response: &Response) -> Step {
    let step = step.fact(value::DISPLACEMENT, response.displacement);
    step.fact(value::PEAK, response.values[response.peak]).fact(value::PSR, response.psr)
}

/// Adds the ZNCC with the first region, where neither is uniform.
fn put_zncc(step: Step, evidence: &Evidence) -> Step {
    step.fact(value::ZNCC, evidence.zncc.map_or("undefined, a region is uniform".into(), Number::from))
}

/// Shows the window, the filter and the response.
fn add_charts(at: &At<'_, CorrelationFilter>, step: Step, response: &Response) -> Step {
    let tiles = [patch_tile(&response.patch)].into_iter().chain(at.model.map(filter_tile));
    let tiles = tiles.chain([tile("response g", Role::Best, response.values.clone())]).collect();
    step.show(Readout::Tiles(tiles)).show(Readout::Surface(surface(response)))
}

/// The comparison with the first region in a frame.
fn evidence<'a>(at: &At<'a, CorrelationFilter>) -> Option<&'a Evidence> {
    at.events.iter().find_map(|event| if let Event::Judged(_, evidence) = *event { evidence.as_ref() } else { None })
}

/// A tile with the range of its values.
fn tile(label: &'static str, role: Role, values: Grid<f32>) -> Tile {
    let range =
        values.cells().iter().fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], v| [low.min(*v), high.max(*v)]);
    let range = if range[0] < range[1] { range } else { [0.0, 1.0] };
    Tile::new(label, values, range).with_role(role)
}

fn patch_tile(patch: &Grid<f32>) -> Tile {
    tile("window f", Role::Window, patch.clone())
}

/// The filter as a picture: the kernel with which windows are correlated.
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
    tile("filter h", Role::Reference, values)
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

fn window(scene: &mut Scene, [x, y]: [i32; 2], (width, height): (usize, usize)) {
    scene.draw(Picture::CURRENT, (Role::Window, "window of the filter"), Shape::pixels(x, y, width, height));
}
