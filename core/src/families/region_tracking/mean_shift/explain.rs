//! The explanation and the drawing of mean shift.

use super::{Background, Event, LEAST_PX, MeanShift, SCALE_RATE, Search, Shift, Trial};
use crate::base::words::{counted, fixed, place};
use crate::data::Frame;
use crate::geometry::Grid;
use crate::methods::numbers::{px, ratio};
use crate::methods::region::color::{Histogram, ellipse_rows};
use crate::methods::region::{At, Ending, Explained, Outcome, plots};
use crate::products::Region;
use crate::scene::{Arrow, Fact, Math, Picture, PlaneCost, Readout, Role, Scene, Sentence, Series, Shape, Surface};

/// The sizes of a frame in words.
const SIZES: [&str; 3] = ["present size", "size 10 % smaller", "size 10 % larger"];

impl Explained for MeanShift {
    fn sentence(&self, at: &At<'_, Self>) -> Sentence {
        let said = Sentence::default();
        match at.event {
            Event::Modelled(histogram) => {
                let largest = histogram.largest(1).first().map_or(0.0, |bin| histogram.shares[*bin]);
                let said = said
                    .text("The ")
                    .ink(Role::Reference, "model q")
                    .text(format!(
                        " is the {} histogram of the ellipse: {} of {} bins are filled, the fullest with a share of {}. The \
                         Epanechnikov kernel gives pixels near the border little weight, where the background may be seen.",
                        histogram.binning.name(),
                        crate::base::words::grouped(histogram.support.len()),
                        crate::base::words::grouped(histogram.binning.count()),
                        ratio(largest.into())
                    ));
                plots::warned(said, histogram)
            }
            Event::Weighted(all) => weighted(all, said),
            Event::Weighed(_, shift) => self.weighed(at, shift, said),
            Event::Shifted(_, shift) => self.shifted(shift, said),
            Event::Scaled(scaled) => {
                let (trials, best, region) = &**scaled;
                chosen(trials, *best, *region, said)
            }
        }
    }

    fn facts(&self, at: &At<'_, Self>) -> Vec<Fact> {
        match at.event {
            Event::Weighed(_, shift) | Event::Shifted(_, shift) => vec![
                Fact::new("Size", SIZES[shift.trial], None),
                Fact::new("Shift", shift.iteration.to_string(), None),
                Fact::new("Bhattacharyya coefficient", ratio(shift.similarity.into()), Some(Role::Candidate)),
                Fact::new("Sum of weights", fixed(shift.weights.into(), 1), None),
            ],
            Event::Scaled(scaled) => {
                let sizes = scaled.0.iter().zip(["ρ, present size", "ρ, smaller", "ρ, larger"]);
                sizes.map(|(trial, label)| Fact::new(label, ratio(trial.similarity.into()), None)).collect()
            }
            _ => Vec::new(),
        }
    }

    fn readouts(&self, at: &At<'_, Self>) -> Vec<Readout> {
        match at.event {
            Event::Modelled(histogram) => {
                vec![Readout::Series(histograms(histogram, &[("model q", Role::Reference, histogram)]))]
            }
            Event::Weighted(all) => {
                let [own, around, weighted] = &**all;
                let lines = [
                    ("object", Role::Candidate, own),
                    ("surroundings o", Role::Rejected, around),
                    ("model q", Role::Reference, weighted),
                ];
                vec![Readout::Series(histograms(own, &lines))]
            }
            Event::Weighed(frame, shift) => of_shift(at, frame, shift, false),
            Event::Shifted(frame, shift) => of_shift(at, frame, shift, true),
            Event::Scaled(_) => vec![Readout::Equation(vec![coefficient()])],
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
            scene.mark(Picture::CURRENT, Role::Predicted, Shape::Arrows(arrows));
            scene.legend(Role::Predicted, "shifts");
        }
        if let (true, Some(to)) = (is_shift, shift.to) {
            plots::ellipse(scene, (Role::Best, "shifted ellipse"), shift.from.at(to));
        }
    }

    fn caveat(&self, at: &At<'_, Self>) -> Option<String> {
        let similarity = found(at)?;
        // Of one bin, with all pixels of the ellipse in it: equal weights.
        let is_flat = at.model?.histogram.support.len() == 1 && similarity > 0.9999;
        is_flat.then(|| {
            "All pixels of the ellipse lie in the one bin of the model and have the same weight: nothing distinguishes this position from \
             others on the flat region."
                .into()
        })
    }

    fn loss(&self, at: &At<'_, Self>) -> Option<String> {
        let is_empty = at.events.iter().any(|event| matches!(event, Event::Shifted(_, shift) if shift.to.is_none()));
        if is_empty {
            return Some("none of the pixels of the ellipse has a colour of the model".into());
        }
        let least = self.least(at.model?);
        (found(at)? < least).then(|| {
            let share = fixed(100.0 * f64::from(self.min_similarity), 0);
            format!("ρ is below {}, {share} % of that in the first frame", ratio(least.into()))
        })
    }

    fn advice(&self, ending: Ending, _at: &At<'_, Self>) -> String {
        let remedy = match self.background {
            Background::Ignored => " The background-weighted histogram gives them little weight.",
            Background::Weighted => "",
        };
        match (ending.outcome, self.background) {
            (Outcome::Followed, Background::Ignored) => {
                "The colours of the object led the ellipse. Mean shift follows the colours, not the shape: a background of like colour \
                 attracts it, which the background-weighted histogram resists."
                    .into()
            }
            (Outcome::Followed, Background::Weighted) => {
                "The colours that only the object has led the ellipse; they were learned in the first frame and are not updated.".into()
            }
            (Outcome::Regained, _) => {
                "The ellipse left the object and met it again. Mean shift predicts no velocity, so it finds only what comes back into the \
                 ellipse."
                    .into()
            }
            (Outcome::Grown, _) => format!("The ellipse grew over a background with colours of the model.{remedy}"),
            (Outcome::Shrunk, _) => {
                "The ellipse shrank to a part of the object: its commonest colours alone have the larger ρ. Without an adapted scale the size \
                 stays."
                    .into()
            }
            (Outcome::Beside | Outcome::Unknown, _) => {
                format!("The ellipse holds a part of the object only: colours of the background in the model attract it too.{remedy}")
            }
            (Outcome::Lost, _) if ending.hidden > 0 => format!(
                "The object was hidden in {}, and mean shift predicts no velocity; a particle filter does.",
                counted(ending.hidden, "frame")
            ),
            (Outcome::Lost, _) => {
                "The object left the picture or, between two frames, the ellipse, or passed a background of like colour. A particle filter keeps several \
                 hypotheses and a velocity, which mean shift has not."
                    .into()
            }
        }
    }
}

impl MeanShift {
    fn weighed(&self, at: &At<'_, Self>, shift: &Shift, said: Sentence) -> Sentence {
        let said = said
            .text(format!("With the {}, ", SIZES[shift.trial]))
            .ink(Role::Candidate, format!("ρ = {}", ratio(shift.similarity.into())))
            .text(format!(" at {} px", place(shift.from.center)));
        let before = last(at, shift.trial, shift.iteration - 1);
        let said = match before {
            Some(before) if shift.similarity >= before.similarity => said.text(format!(
                "; before the last shift it was {}, so it has not fallen. ",
                ratio(before.similarity.into())
            )),
            Some(before) => said.text(format!(
                "; before the last shift it was {}, so it has fallen: the weights were linearised there. ",
                ratio(before.similarity.into())
            )),
            None => said.text(". "),
        };
        said.text(
            "A pixel weighs √(q/p) of its bin: above 1 where its colour is rarer in the ellipse than in the model, 0 where the model \
             lacks its colour.",
        )
    }

    fn shifted(&self, shift: &Shift, said: Sentence) -> Sentence {
        let Some(to) = shift.to else {
            return said.text(
                "All weights are 0: none of the pixels of the ellipse has a colour of the model, so there is no shift.",
            );
        };
        let said = said
            .text("The weighted mean of the pixels lies at ")
            .ink(Role::Best, format!("{} px", place(to)))
            .text(format!(": a shift of {} px, ", px(shift.length().into())));
        let epsilon = px(self.epsilon.into());
        if shift.length() < self.epsilon {
            said.text(format!("shorter than ε = {epsilon} px. Converged after {}.", counted(shift.iteration, "shift")))
        } else if shift.iteration == self.iterations {
            said.text(format!(
                "not shorter than ε = {epsilon} px, but the limit of {} shifts is reached.",
                self.iterations
            ))
        } else {
            said.text(format!(
                "not shorter than ε = {epsilon} px, so the ellipse moves there and the weights are computed anew."
            ))
        }
    }
}

fn weighted([own, around, weighted]: &[Histogram; 3], said: Sentence) -> Sentence {
    let shared: f32 = own
        .support
        .iter()
        .map(|bin| usize::from(*bin))
        .filter(|bin| around.shares[*bin] > 0.0)
        .map(|bin| own.shares[bin])
        .sum();
    let left: f32 = own
        .support
        .iter()
        .map(|bin| usize::from(*bin))
        .filter(|bin| around.shares[*bin] > 0.0)
        .map(|bin| weighted.shares[bin])
        .sum();
    said.text("The surroundings have colours of the object with a share of ")
        .ink(Role::Rejected, ratio(shared.into()))
        .text(" in its histogram. Each such bin is multiplied by the ratio of the smallest share of the surroundings to its own there, so that these colours keep a share of ")
        .ink(Role::Reference, ratio(left.into()))
        .text(": a background-weighted histogram of the model alone.")
}

fn chosen(trials: &[Trial; 3], best: usize, region: Region, said: Sentence) -> Sentence {
    let [now, smaller, larger] = trials.each_ref().map(|trial| ratio(trial.similarity.into()));
    let said = said
        .text(format!("ρ is {now} with the present size, {smaller} with the smaller and {larger} with the larger one. The best is the "))
        .ink(Role::Best, SIZES[best]);
    let size = format!("{}×{} px", px(region.size[0].into()), px(region.size[1].into()));
    let said = match best {
        0 => said.text(format!(", so the size stays {size}")),
        _ => said.text(format!(", and the size moves {} of the way to it: {size}", fixed(SCALE_RATE.into(), 1))),
    };
    if region.size.iter().any(|side| *side <= LEAST_PX) {
        said.text(", the smallest that is allowed.")
    } else {
        said.text(".")
    }
}

/// The Bhattacharyya coefficient at the end of a frame.
fn found(at: &At<'_, MeanShift>) -> Option<f32> {
    match at.event {
        Event::Scaled(scaled) => Some(scaled.0[scaled.1].similarity),
        Event::Shifted(_, shift) => Some(shift.similarity),
        _ => None,
    }
}

/// The shift of a number in a trial of the frame.
fn last<'a>(at: &At<'a, MeanShift>, trial: usize, iteration: usize) -> Option<&'a Shift> {
    at.events.iter().find_map(|event| match event {
        Event::Shifted(_, shift) if (shift.trial, shift.iteration) == (trial, iteration) => Some(shift),
        _ => None,
    })
}

/// ρ = Σ √(p_u q_u).
fn coefficient() -> Math {
    let of = |name| Math::indexed(Math::Var(name), Math::Var("u"));
    Math::Row(vec![
        Math::Var("ρ"),
        Math::text(" = "),
        Math::Sum(Box::new(Math::Var("u"))),
        Math::root(Math::Row(vec![of("p"), Math::text(" "), of("q")])),
    ])
}

fn of_shift(at: &At<'_, MeanShift>, frame: &Frame, shift: &Shift, is_shift: bool) -> Vec<Readout> {
    let Some(model) = at.model.map(|model| &model.histogram) else { return Vec::new() };
    let mut search = Search::new(model, frame);
    search.weigh(shift.from);
    let candidate = Histogram::new(model.binning, search.candidate.clone());
    let lines = [("model q", Role::Reference, &**model), ("candidate p", Role::Candidate, &candidate)];
    let mut readouts = vec![Readout::Equation(if is_shift { mean_of(shift) } else { weight_of(shift) })];
    readouts.push(Readout::Landscape(hill(at, (search, shift), is_shift)));
    readouts.push(Readout::Series(histograms(model, &lines)));
    let values: Vec<_> = (1..=shift.iteration)
        .filter_map(|i| last(at, shift.trial, i).or((i == shift.iteration).then_some(shift)))
        .map(|shift| [shift.iteration as f32, shift.similarity])
        .collect();
    if values.len() > 1 {
        readouts.push(Readout::Series(Series {
            title: "Bhattacharyya coefficient of the shifts",
            x_label: "shift",
            y_label: "ρ",
            x_max: values.len(),
            lines: vec![("ρ", Role::Candidate, values)],
            fits_values: true,
            ..Series::default()
        }));
    }
    readouts
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

/// The weight of a pixel, and the coefficient.
fn weight_of(shift: &Shift) -> Vec<Math> {
    let of = |name| Math::indexed(Math::Var(name), Math::Var("u"));
    let weight = Math::Row(vec![
        Math::indexed(Math::Var("w"), Math::Var("i")),
        Math::text(" = "),
        Math::root(Math::over(of("q"), of("p"))),
    ]);
    let Math::Row(mut parts) = coefficient() else { return vec![weight] };
    parts.extend([Math::text(" = "), Math::ink(Role::Candidate, ratio(shift.similarity.into()))]);
    vec![weight, Math::Row(parts)]
}

/// The weighted mean with its numbers.
fn mean_of(shift: &Shift) -> Vec<Math> {
    let Some(to) = shift.to else { return Vec::new() };
    let of = |name| Math::indexed(Math::Var(name), Math::Var("i"));
    let sum = |parts| Math::Row(vec![Math::Sum(Box::new(Math::Var("i"))), Math::Row(parts)]);
    vec![Math::Row(vec![
        Math::Bold("y"),
        Math::text(" = "),
        Math::over(
            sum(vec![of("w"), Math::text(" "), Math::indexed(Math::Bold("x"), Math::Var("i"))]),
            sum(vec![of("w")]),
        ),
        Math::text(" = "),
        Math::ink(Role::Best, format!("{} px", place(to))),
    ])]
}

/// Histograms over each other, by the largest bins of the first.
fn histograms(order: &Histogram, all: &[(&'static str, Role, &Histogram)]) -> Series {
    let bins = order.largest(plots::BARS);
    let line = |(name, role, of): &(&'static str, Role, &Histogram)| {
        (*name, *role, plots::bars(bins.iter().map(|bin| of.shares[*bin])))
    };
    plots::histograms("Colour histograms", ["largest bins of the model", "share"], all.iter().map(line).collect())
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
