//! The explanation and the drawing of mean shift.

use super::vocabulary::{case, value};
use super::{Background, Event, LEAST_PX, MeanShift, SCALE_RATE, Search, Shift};
use crate::base::words::{MOST_FURTHER_DIGITS, fixed, further_digits, rounded};
use crate::data::Frame;
use crate::geometry::Grid;
use crate::methods::numbers::RATIO_DECIMALS;
use crate::methods::region::color::{Histogram, ellipse_rows};
use crate::methods::region::vocabulary::{case as shared, value as shared_value};
use crate::methods::region::{At, Ending, Explained, Outcome, plots};
use crate::products::Region;
use crate::scene::{Arrow, Number, Picture, PlaneCost, Readout, Role, Scene, Series, Shape, Step, Surface, Unit};

/// The Bhattacharyya coefficient.
const COEFFICIENT: &str = r"\rho = \sum_u \sqrt{p_u \, q_u}";
/// The bins of the model whose terms are written out.
const TERMS: usize = 3;
/// The sizes of a frame in words.
const SIZES: [&str; 3] = ["present size", "size 10 % smaller", "size 10 % larger"];

impl Explained for MeanShift {
    fn step(&self, at: &At<'_, Self>, step: Step) -> Step {
        match at.event {
            Event::Modelled(histogram) => {
                let fullest = histogram.shares.iter().copied().fold(0.0, f32::max);
                let step = plots::put_bins(step, histogram).put(value::FULLEST, fullest).say(case::MODELLED);
                step.say_if(histogram.is_flat(), shared::FLAT)
                    .show(histograms(histogram, &[("model q", Role::Reference, histogram)]))
            }
            Event::Weighted(all) => {
                let [own, around, weighted] = &**all;
                let share = |of: &Histogram| {
                    let bins = own.support.iter().map(|bin| usize::from(*bin));
                    bins.filter(|bin| around.shares[*bin] > 0.0).map(|bin| of.shares[bin]).sum::<f32>()
                };
                let step = step.put(value::SHARED, share(own)).put(value::KEPT, share(weighted)).say(case::WEIGHTED);
                let lines = [
                    ("object", Role::Candidate, own),
                    ("surroundings o", Role::Rejected, around),
                    ("model q", Role::Reference, weighted),
                ];
                step.show(histograms(own, &lines))
            }
            Event::Weighed(frame, shift) => {
                let step = put_shift(step, shift).put(value::CENTER, shift.from.center).say(case::WEIGHED);
                let step = match last(at, shift.trial, shift.iteration - 1) {
                    Some(before) => step
                        .put(value::COEFFICIENT_BEFORE, before.similarity)
                        .say(if shift.similarity >= before.similarity { case::NOT_FALLEN } else { case::FALLEN }),
                    None => step.say(shared::END),
                };
                let step = step.say(case::WEIGHT).formula(r"w_i = \sqrt{\frac{q_u}{p_u}}");
                add_charts(terms(at, (frame, shift), step.formula(COEFFICIENT)), at, frame, shift, false)
            }
            Event::Shifted(frame, shift) => {
                add_charts(self.tell_shift(put_shift(step, shift), shift), at, frame, shift, true)
            }
            Event::Scaled(scaled) => {
                let (trials, best, region) = &**scaled;
                let coefficients = [value::PRESENT, value::SMALLER, value::LARGER].into_iter().zip(trials);
                let step = coefficients.fold(step, |step, (of, trial)| step.fact(of, trial.similarity));
                let step = step.put(shared_value::WIDTH, region.size[0]).put(shared_value::HEIGHT, region.size[1]);
                let step = step.put(value::BEST_SIZE, SIZES[*best]).put(value::RATE, SCALE_RATE).say(case::SIZES);
                let step = step.say(if *best == 0 { case::SAME_SIZE } else { case::NEW_SIZE });
                let is_smallest = region.size.iter().any(|side| *side <= LEAST_PX);
                step.say_if(is_smallest, case::SMALLEST).say(shared::END).formula(COEFFICIENT)
            }
        }
    }

    fn draw(&self, at: &At<'_, Self>, scene: &mut Scene) {
        let (frame, shift, is_shift) = match at.event {
            Event::Weighed(frame, shift) => (frame, shift, false),
            Event::Shifted(frame, shift) => (frame, shift, true),
            Event::Scaled(scaled) => {
                let (trials, best, _) = &**scaled;
                for trial in trials {
                    plots::ellipse(scene, (Role::Candidate, "ellipses of all sizes"), trial.region);
                }
                plots::ellipse(scene, (Role::Best, "best size"), trials[*best].region);
                return;
            }
            Event::Modelled(_) | Event::Weighted(_) => {
                plots::ellipse(scene, (Role::Candidate, "ellipse of the histogram"), at.region);
                return;
            }
        };
        if let Some(model) = at.model {
            let (origin, values) = weights(&model.histogram, frame, shift.from);
            scene.mark(Picture::CURRENT, Role::Candidate, Shape::Heat { origin, values });
            scene.heat = Some("weight √(q/p)");
        }
        plots::ellipse(scene, (Role::Candidate, "ellipse"), shift.from);
        let of_trial = at.events.iter().filter_map(|event| match event {
            Event::Shifted(_, other) if other.trial == shift.trial => Some(other),
            _ => None,
        });
        let arrow = |shift: &Shift| Some(Arrow { from: shift.from.center, to: shift.to? });
        let arrows: Vec<_> = of_trial.filter_map(arrow).collect();
        if !arrows.is_empty() {
            scene.draw(Picture::CURRENT, (Role::Predicted, "shifts"), Shape::Arrows(arrows));
        }
        if let (true, Some(to)) = (is_shift, shift.to) {
            plots::ellipse(scene, (Role::Best, "shifted ellipse"), shift.from.at(to));
        }
    }

    fn tell_caveat(&self, at: &At<'_, Self>, step: Step) -> Step {
        // Of one bin, with all pixels of the ellipse in it: equal weights.
        let is_flat = at.model.is_some_and(|model| model.histogram.is_flat());
        step.say_if(is_flat && found(at).is_some_and(|coefficient| coefficient > 0.9999), case::UNIFORM)
    }

    fn tell_loss(&self, at: &At<'_, Self>, step: Step) -> Step {
        let is_empty = at.events.iter().any(|event| matches!(event, Event::Shifted(_, shift) if shift.to.is_none()));
        let Some(model) = at.model.filter(|_| !is_empty) else { return step.say_if(is_empty, case::LOST_COLOURS) };
        let step =
            step.put(value::MIN_COEFFICIENT, self.least(model)).put(value::MIN_SHARE, 100.0 * self.min_similarity);
        step.say(case::LOW_COEFFICIENT)
    }

    fn advise(&self, ending: Ending, _at: &At<'_, Self>, step: Step) -> Step {
        let is_ignored = self.background == Background::Ignored;
        match ending.outcome {
            Outcome::Followed => step.say(if is_ignored { case::FOLLOWED } else { case::FOLLOWED_WEIGHTED }),
            Outcome::Regained => step.say(case::REGAINED),
            Outcome::Grown => step.say(case::GROWN).say_if(is_ignored, case::REMEDY),
            Outcome::Shrunk => step.say(case::SHRUNK),
            Outcome::Beside | Outcome::Unknown => step.say(case::BESIDE).say_if(is_ignored, case::REMEDY),
            Outcome::Lost => step.say(if ending.hidden > 0 { case::HIDDEN } else { case::LOST }),
        }
    }
}

impl MeanShift {
    fn tell_shift(&self, step: Step, shift: &Shift) -> Step {
        let Some(to) = shift.to else { return step.say(case::NO_WEIGHT) };
        let step =
            step.put(value::MEAN, to).put(value::SHIFT_LENGTH, shift.length()).put(value::SHIFTS, shift.iteration);
        let step = step.put(value::EPSILON, self.epsilon).put(value::ITERATIONS, self.iterations).say(case::SHIFTED);
        let step = step.say(if self.has_converged(shift) {
            case::CONVERGED
        } else if shift.iteration == self.iterations {
            case::EXHAUSTED
        } else {
            case::NOT_CONVERGED
        });
        step.formula(r"\mathbf{y} = \frac{\sum_i w_i \, \mathbf{x}_i}{\sum_i w_i} = {mean:unit}")
    }
}

/// Writes the terms of the largest bins of the model, and the sum of all others.
fn terms(at: &At<'_, MeanShift>, (frame, shift): (&Frame, &Shift), step: Step) -> Step {
    let Some(model) = at.model.map(|model| &model.histogram) else { return step };
    let mut search = Search::new(model, frame);
    search.weigh(shift.from);
    let candidate = Histogram::new(model.binning, search.candidate.clone());
    let bins = model.largest(TERMS);
    let shares = |of: &Histogram| bins.iter().map(|bin| f64::from(of.shares[*bin])).collect::<Vec<_>>();
    let (own, others) = (shares(model), shares(&candidate));
    let sum = |decimals: usize| {
        let written = |share: &f64| rounded(*share, decimals);
        own.iter().zip(&others).map(|(q, p)| (written(q) * written(p)).sqrt()).sum::<f64>()
    };
    let coefficient = f64::from(shift.similarity);
    let rest = coefficient - sum(RATIO_DECIMALS + MOST_FURTHER_DIGITS);
    let total = |further: &usize| {
        let decimals = RATIO_DECIMALS + further;
        fixed(sum(decimals) + rounded(rest, decimals), RATIO_DECIMALS) == fixed(coefficient, RATIO_DECIMALS)
    };
    let unit = Unit::RATIO.finer(further_digits(total) as u8);
    let term = |i: usize| format!(r"\sqrt{{{{candidate_shares:{i}}} \cdot {{model_shares:{i}}}}}");
    let written: Vec<String> = (1..=bins.len()).map(term).collect();
    let rest_of_bins = if model.support.len() > bins.len() { r" + {other_bins}\text{ (other bins)}" } else { "" };
    let step = step.put_value(value::MODEL_SHARES.is(Number::Vector(own)).in_unit(unit));
    let step = step.put_value(value::CANDIDATE_SHARES.is(Number::Vector(others)).in_unit(unit));
    let step = step.put_value(value::OTHER_BINS.is(rest.max(0.0)).in_unit(unit));
    step.formula(format!("= {}{rest_of_bins} = {{coefficient}}", written.join(" + ")))
}

fn put_shift(step: Step, shift: &Shift) -> Step {
    let step = step.fact(value::SIZE, SIZES[shift.trial]).fact(value::ITERATION, shift.iteration);
    step.fact(value::COEFFICIENT, shift.similarity).fact(value::WEIGHTS, shift.weights)
}

/// The Bhattacharyya coefficient at the end of a frame.
fn found(at: &At<'_, MeanShift>) -> Option<f32> {
    match at.event {
        Event::Scaled(scaled) => Some(scaled.0[scaled.1].similarity),
        Event::Shifted(_, shift) => Some(shift.similarity),
        _ => None,
    }
}

fn last<'a>(at: &At<'a, MeanShift>, trial: usize, iteration: usize) -> Option<&'a Shift> {
    at.events.iter().find_map(|event| match event {
        Event::Shifted(_, shift) if (shift.trial, shift.iteration) == (trial, iteration) => Some(shift),
        _ => None,
    })
}

fn add_charts(step: Step, at: &At<'_, MeanShift>, frame: &Frame, shift: &Shift, is_shift: bool) -> Step {
    let Some(model) = at.model.map(|model| &model.histogram) else { return step };
    let mut search = Search::new(model, frame);
    search.weigh(shift.from);
    let candidate = Histogram::new(model.binning, search.candidate.clone());
    let lines = [("model q", Role::Reference, &**model), ("candidate p", Role::Candidate, &candidate)];
    let step = step.show(Readout::Landscape(hill(at, (search, shift), is_shift))).show(histograms(model, &lines));
    let values: Vec<_> = (1..=shift.iteration)
        .filter_map(|i| last(at, shift.trial, i).or((i == shift.iteration).then_some(shift)))
        .map(|shift| [shift.iteration as f32, shift.similarity])
        .collect();
    let series = Series {
        fits_values: true,
        ..Series::new(
            "Bhattacharyya coefficient of the shifts",
            ["shift", "ρ"],
            values.len(),
            vec![("ρ", Role::Candidate, values)],
        )
    };
    step.show_all((series.x_max > 1).then_some(Readout::Series(series)))
}

/// The Bhattacharyya coefficient of ellipses of one size around the first place of a trial, with the shifts on it.
fn hill(at: &At<'_, MeanShift>, (mut search, shift): (Search<'_>, &Shift), is_shift: bool) -> Surface {
    let first = last(at, shift.trial, 1).map_or(shift.from, |first| first.from);
    let [width, height] = first.size;
    let coefficient = |center: [f32; 2]| {
        let coefficient = search.weigh(first.at(center));
        // Outside the picture there are no pixels to compare.
        if search.candidate.iter().any(|share| *share > 0.0) { coefficient } else { f32::NAN }
    };
    let square = (Picture::CURRENT, first.center, width.max(height) / 2.0);
    let side = PlaneCost::cells((width * height) as usize);
    let surface = Surface::sampled_over_picture(("ρ", ""), square, side, coefficient);
    let before = (1..shift.iteration).filter_map(|i| last(at, shift.trial, i)).map(|shift| shift.from.center);
    let places = before.chain([shift.from.center]).chain(shift.to.filter(|_| is_shift));
    Surface { is_similarity: true, ..surface.with_trail(places) }
}

/// Histograms over each other, by the largest bins of the first.
fn histograms(order: &Histogram, all: &[(&'static str, Role, &Histogram)]) -> Readout {
    let bins = order.largest(plots::BARS);
    let line = |(name, role, of): &(&'static str, Role, &Histogram)| {
        (*name, *role, plots::bars(bins.iter().map(|bin| of.shares[*bin])))
    };
    let labels = ["largest bins of the model", "share"];
    Readout::Series(plots::histograms("Colour histograms", labels, all.iter().map(line).collect()))
}

/// The weights of the pixels of an ellipse as a heat map, with its first pixel.
fn weights(model: &Histogram, frame: &Frame, region: Region) -> ([f32; 2], Grid<f32>) {
    let mut search = Search::new(model, frame);
    search.weigh(region);
    let bounds = region.bounds();
    let first = bounds.min.map(|c| c.ceil().max(0.0));
    let size = [0, 1].map(|i| (bounds.max[i].floor() - first[i] + 1.0).max(1.0) as usize);
    let mut values = Grid::new(size[0], size[1], f32::NAN);
    ellipse_rows(&search.bins, region, |row, [dx, dy], _| {
        let (left, y) = (region.center[0] + dx - first[0], region.center[1] + dy - first[1]);
        for (i, bin) in row.iter().enumerate() {
            let at = (left.round() as usize + i, y.round() as usize);
            if at.0 < size[0] && at.1 < size[1] {
                values[at] = search.weights[usize::from(*bin)];
            }
        }
    });
    (first, values)
}
