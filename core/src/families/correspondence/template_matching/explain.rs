//! The explanation and the drawing of template matching.

use super::{
    DRIFT_PX, Drift, Event, Found, LEAST_DEVIATION, Pair, Past, Stage, State, Template, TemplateMatching, Update, line,
    window,
};
use crate::base::words::{self, counted, fixed, grouped};
use crate::data::Frame;
use crate::geometry::Grid;
use crate::methods::correlation::{Evaluation, Moments, Score};
use crate::methods::differential::numbers;
use crate::methods::features::trails;
use crate::run::Seen;
use crate::scene::{
    Arrow, Canvas, Fact, Footing, Math, Picture, PictureRole, Readout, Role, Scene, Sentence, Series, Shape, Step,
    Surface, Tile,
};

/// Peaks whose ratio is smaller are ambiguous.
const DISTINCT: f64 = 1.1;
/// A block with a smaller eigenvalue below this, in (gray levels per px)², has no texture in some direction.
const LEAST_EIGENVALUE: f32 = 0.01;

fn whole([x, y]: [i32; 2]) -> String {
    format!("({},\u{a0}{})", fixed(x.into(), 0), fixed(y.into(), 0))
}

fn px(uv: [f32; 2]) -> String {
    format!("{} px", numbers::vector(uv))
}

impl Score {
    /// A score as text: sums whole, correlations to a thousandth.
    fn show(self, value: f64) -> String {
        if self.is_similarity() { fixed(value, 3) } else { words::cost(value) }
    }

    /// The score of a cost as text, with its name.
    fn named(self, cost: f64) -> String {
        format!("{} {}", self.label(), self.show(self.of_cost(cost)))
    }

    fn better(self) -> &'static str {
        if self.is_similarity() { "above" } else { "below" }
    }

    fn best(self) -> &'static str {
        if self.is_similarity() { "highest" } else { "lowest" }
    }
}

/// What a step shows: the pair, the best place so far, and the place with its numbers.
struct Shown<'a> {
    pair: &'a Pair,
    /// Number of places scored before, row by row.
    done: usize,
    /// Number of places scored in this unit.
    here: usize,
    best: Option<(usize, usize)>,
    place: Option<(usize, usize)>,
    found: Option<&'a Found>,
}

impl<'a> Shown<'a> {
    fn of(seen: &Seen<'a, TemplateMatching>) -> Option<Self> {
        let state = seen.before;
        match seen.events.last()? {
            Event::Chosen(_) | Event::Flat(_) => None,
            Event::Area(pair) => Some(Self { pair, done: 0, here: 0, best: None, place: None, found: None }),
            Event::Candidate(pair, [x, y]) => {
                let (x, y) = (*x as usize, *y as usize);
                let best = (0..=x).fold(state.best, |best, x| Some(pair.better(best, (x, y))));
                let done = y * pair.costs.width();
                Some(Self { pair, done, here: x + 1, best, place: Some((x, y)), found: None })
            }
            Event::Decided(_, found) => {
                let (pair, best) = (&*found.pair, Some(found.best));
                let done = pair.costs.cells().len();
                Some(Self { pair, done, here: 0, best, place: best, found: Some(found) })
            }
        }
    }

    /// The role of the place with its numbers.
    fn role(&self) -> Role {
        if self.found.is_some() || self.place == self.best { Role::Best } else { Role::Candidate }
    }
}

impl TemplateMatching {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let line = match seen.events.last() {
            None => line::EACH_PAIR,
            Some(Event::Chosen(_) | Event::Flat(_)) => line::CHOOSE,
            Some(Event::Area(_)) => line::SET_AREA,
            Some(Event::Candidate(..)) => line::SCORE,
            Some(Event::Decided(stage, _)) => match stage {
                Stage::Peak => line::TAKE_PEAK,
                Stage::Subpixel => line::FIT_PARABOLA,
                Stage::Second => line::COMPARE_SECOND,
                Stage::Check => line::CHECK,
                Stage::Drift => line::MEASURE_DRIFT,
                Stage::Update => line::UPDATE,
            },
        };
        Step { values: Vec::new(), line, sentence: self.sentence(seen), readouts: self.readouts(seen) }
    }

    fn sentence(&self, seen: &Seen<Self>) -> Sentence {
        let (state, said) = (seen.before, Sentence::default());
        let Some(event) = seen.events.last() else {
            return said.text(format!(
                "Template matching slides a template over a search area of each next frame and scores every window with {}, \
                 through at most {} frames.{}",
                self.score.label(),
                self.frames,
                self.clipped(&state.first)
            ));
        };
        match event {
            Event::Chosen(template) => self.chosen(template, said),
            Event::Flat(template) => self.chosen(template, said).text(format!(
                " Its standard deviation of {} gray levels is below {}: without texture every window fits alike, and the run \
                 ends. Place the template on an object with corners.",
                fixed(template.deviation(), 2),
                fixed(LEAST_DEVIATION, 2)
            )),
            Event::Area(pair) => self.area_sentence(state, pair, said),
            Event::Candidate(..) => self.candidate(seen, said),
            Event::Decided(stage, found) => {
                let sentence = self.decided(*stage, state, found, said);
                self.concluded(seen, sentence)
            }
        }
    }

    fn chosen(&self, template: &Template, said: Sentence) -> Sentence {
        let (width, height) = template.pixels.size();
        let said = said.ink(Role::Reference, format!("Template of {width}×{height} px")).text(format!(
            " at {} in frame {}, ",
            whole(template.at),
            template.frame
        ));
        match template.eigenvalue {
            Some(eigenvalue) if eigenvalue < LEAST_EIGENVALUE => said.text(format!(
                "chosen automatically: the picture has {} near its middle. The structure tensor of the best block there has the smaller \
                 eigenvalue λ₂ = {}.",
                if template.deviation() < LEAST_DEVIATION { "no texture" } else { "no block with texture in all directions" },
                fixed(eigenvalue.into(), 2)
            )),
            Some(eigenvalue) => said.text(format!(
                "chosen automatically: the smaller eigenvalue λ₂ = {} of its structure tensor is the largest of all blocks near the \
                 middle, so it differs from its surroundings in all directions.",
                fixed(eigenvalue.into(), 2)
            )),
            None => {
                said.text("cut from the first frame of the run at the place given.").text(self.clipped(template))
            }
        }
    }

    /// That the picture border clips the placed rectangle, as a sentence with a space before it; empty if it does not.
    fn clipped(&self, template: &Template) -> String {
        let (width, height) = template.pixels.size();
        self.cut_off(template).map_or_else(String::new, |[wide, high]| {
            format!(
                " The rectangle of {}×{} px reaches outside the picture, so the template is clipped to {width}×{height} px.",
                fixed(wide, 0),
                fixed(high, 0)
            )
        })
    }

    /// Width and height of the placed rectangle in px, where the picture border cuts it.
    fn cut_off(&self, template: &Template) -> Option<[f64; 2]> {
        let zone = self.template?;
        let [width, height] = [0, 1].map(|i| f64::from(zone.max[i].ceil()) - f64::from(zone.min[i].ceil()));
        let inside = template.pixels.size();
        (width > inside.0 as f64 || height > inside.1 as f64).then_some([width, height])
    }

    fn area_sentence(&self, state: &State, pair: &Pair, said: Sentence) -> Sentence {
        let (columns, rows) = pair.costs.size();
        let (width, height) = pair.template.pixels.size();
        let products = grouped(columns * rows * width * height);
        let said = said
            .text(format!("In frame {} the template is tried at ", state.frame + 1))
            .ink(Role::Window, format!("{columns} × {rows} places"))
            .text(format!(
                " up to {} px from its position {}, where it stays inside the frame. ",
                self.search_range,
                whole(pair.from)
            ));
        match pair.way {
            Evaluation::Direct => said.text(format!("Direct sums take {products} products.")),
            Evaluation::Fourier => said.text(format!(
                "Direct sums would take {products} products; products of spectra, by the fast Fourier transform, give the same \
                 scores with less effort."
            )),
        }
    }

    fn candidate(&self, seen: &Seen<Self>, said: Sentence) -> Sentence {
        let Some(Shown { pair, best: Some(best), place: Some(place), here, .. }) = Shown::of(seen) else { return said };
        let score = self.score.named(pair.costs[place]);
        let (x, y) = place;
        let before = (0..x).fold(seen.before.best, |best, x| Some(pair.better(best, (x, y))));
        let said = said
            .text("Displacement ")
            .ink(Role::Candidate, format!("{} px", whole(pair.displacement(place))))
            .text(format!(": {score}, "));
        let is_last = here == pair.costs.width();
        let said = match before {
            None => said.text("the first place and so the best so far."),
            Some(_) if best == place => {
                let before = before.map_or(0.0, |before| pair.costs[before]);
                said.text(format!(
                    "{} the best so far, {}: ",
                    self.score.better(),
                    self.score.show(self.score.of_cost(before))
                ))
                .ink(Role::Best, "the new best")
                .text(".")
            }
            Some(before) => said
                .text(format!("not {} the best so far, ", self.score.better()))
                .ink(Role::Best, self.score.show(self.score.of_cost(pair.costs[before])))
                .text(format!(" at {} px.", whole(pair.displacement(before)))),
        };
        if is_last {
            said.text(format!(" The row ends: {} of {} rows are scored.", y + 1, pair.costs.height()))
        } else {
            said
        }
    }

    fn decided(&self, stage: Stage, state: &State, found: &Found, said: Sentence) -> Sentence {
        let pair = &found.pair;
        let score = |place| self.score.named(pair.costs[place]);
        match stage {
            Stage::Peak => said
                .text(format!("The {} score of all {} places is ", self.score.best(), grouped(pair.costs.cells().len())))
                .ink(Role::Best, score(found.best))
                .text(format!(" at displacement {} px.", whole(pair.displacement(found.best))))
                .text(if found.is_at_limit(self.search_range) {
                    " It lies at the limit of the search area, and a better one may lie beyond: a larger search range shows it."
                } else {
                    ""
                }),
            Stage::Subpixel if found.around.iter().all(Option::is_none) => {
                said.text("The peak lies at the border of the search area along x and y, so no parabola fits: the position stays whole.")
            }
            Stage::Subpixel => said
                .text("Parabolas through the peak and its neighbours have their vertices at ")
                .ink(Role::Best, px(found.fraction))
                .text(format!(" from it: the displacement is {}.", px(self.exact(found)))),
            Stage::Second => self.second_sentence(found, said),
            Stage::Check => {
                let (zncc, least) = (fixed(found.zncc, 3), fixed(self.min_zncc.into(), 3));
                if found.is_lost() {
                    return said
                        .text(format!("ZNCC at the peak: {zncc}, below the minimum of {least}. The template is "))
                        .ink(Role::Rejected, "lost")
                        .text(": it is occluded, has left the search area, or has changed.");
                }
                said.text(format!("ZNCC at the peak: {zncc}, not below the minimum of {least}. The template moves by "))
                    .ink(Role::Result, px(found.feature.displacement.unwrap_or_default()))
                    .text(format!(" to {}.", numbers::vector(found.point)))
            }
            Stage::Drift => {
                let Some(drift) = found.drift else { return said };
                let said = said
                    .text(format!("The template of frame {} fits best at an offset of ", state.first.frame))
                    .ink(Role::Error, px(drift.offset.map(|c| -c)));
                let updates = counted(state.past.len() + 1, "update");
                said.text(match drift.is_at_least {
                    false => format!(" from there: a drift of {} px after {updates}.", numbers::px(drift.length())),
                    true => format!(
                        " from there, at the border of its search of ±{DRIFT_PX} px: after {updates} the drift is at least {DRIFT_PX} px, or \
                         the first template fits nowhere near."
                    ),
                })
            }
            Stage::Update => said.text(format!(
                "The window at the match becomes the template of frame {}. It follows changes of appearance, but the error of \
                 this match stays in it.",
                state.frame + 1
            )),
        }
    }

    /// The displacement of the template to its sub-pixel position, in px.
    fn exact(&self, found: &Found) -> [f32; 2] {
        let whole = found.pair.displacement(found.best);
        [0, 1].map(|i| whole[i] as f32 + found.fraction[i])
    }

    fn second_sentence(&self, found: &Found, said: Sentence) -> Sentence {
        let pair = &found.pair;
        let Some(second) = found.second else {
            return said.text(
                "There is no second peak: the score falls from the best place to all sides, so the match is distinct.",
            );
        };
        let said = said
            .text("Second-best peak: ")
            .ink(Role::Rejected, self.score.named(pair.costs[second]))
            .text(format!(" at {} px. ", whole(pair.displacement(second))));
        match found.ratio(self.score) {
            Some(ratio) if ratio < DISTINCT => said.text(format!(
                "Its ratio to the best, {}, is below {}: the match is ambiguous, as on texture that repeats. A larger template \
                 would help.",
                fixed(ratio, 2),
                fixed(DISTINCT, 2)
            )),
            Some(ratio) => said.text(format!(
                "The best peak is {} times as good, at least {}: the match is distinct.",
                fixed(ratio, 2),
                fixed(DISTINCT, 2)
            )),
            None if self.score.is_similarity() => {
                said.text("No positive correlation stands beside the best, so the match is distinct.")
            }
            None if pair.costs[second] == 0.0 => said.text(
                "Both costs are 0, so their ratio is undefined: two places fit exactly, and the match is ambiguous, as on texture that repeats.",
            ),
            None => said.text("The best fits exactly, with a cost of 0, so the match is distinct."),
        }
    }

    /// Adds the conclusion at the end of the run.
    fn concluded(&self, seen: &Seen<Self>, said: Sentence) -> Sentence {
        let Some(after) = seen.after.filter(|after| after.is_over) else { return said };
        let past = &after.past;
        let kept = after.track.points.len().saturating_sub(1);
        let lowest = past.iter().enumerate().min_by(|(_, a), (_, b)| a.zncc.total_cmp(&b.zncc));
        let mut sentence = format!(" End of the run: tracked through {} of {}", kept, counted(past.len(), "pair"));
        if let Some((i, Past { zncc, .. })) = lowest {
            sentence += &format!(", lowest ZNCC {} in frame {}.", fixed((*zncc).into(), 3), after.span.first + i + 1);
        }
        let limited = past.iter().filter(|past| past.is_at_limit).count();
        if limited > 0 {
            sentence += &format!(
                " Warning: in {} the peak lies at the limit of the search area (±{} px), so the true displacement may be larger.",
                counted(limited, "pair"),
                self.search_range
            );
        }
        sentence += &self.clipped(&after.first);
        if let Some(error) = past.iter().rev().find_map(|past| past.error) {
            sentence += &format!(" The final distance from the true position is {} px.", numbers::px(error));
        }
        if let Some(drift) = past.iter().rev().find_map(|past| past.drift) {
            sentence += &match drift.is_at_least {
                false => format!(" The final drift from the first template is {} px.", numbers::px(drift.length())),
                true => format!(" The final drift from the first template is at least {DRIFT_PX} px."),
            };
        }
        let is_lost = kept < past.len();
        sentence += match (is_lost, self.update) {
            (true, Update::Fixed) => {
                " A larger search range helps if the motion is large, updates if the appearance changes."
            }
            (true, Update::EveryFrame) => {
                " A larger search range helps if the motion is large; an occluded template cannot be kept."
            }
            (false, Update::Fixed) => {
                " A fixed template does not drift; updates would let it follow changes of appearance."
            }
            (false, Update::EveryFrame) => " A fixed template would not drift if the appearance stays the same.",
        };
        said.text(sentence)
    }

    fn readouts(&self, seen: &Seen<Self>) -> Vec<Readout> {
        let Some(event) = seen.events.last() else { return Vec::new() };
        let Some(shown) = Shown::of(seen) else {
            let (Event::Chosen(template) | Event::Flat(template)) = event else { return Vec::new() };
            return vec![Readout::Facts(template_facts(template)), Readout::Tiles(vec![template_tile(template)])];
        };
        let mut readouts = vec![Readout::Facts(self.facts(&shown))];
        if let Some(place) = shown.place {
            let mut lines = self.equation(shown.pair, place, shown.role());
            if let (Some(Event::Decided(Stage::Subpixel, found)), true) = (seen.events.last(), shown.found.is_some()) {
                lines = self.parabolas(found);
            }
            readouts.push(Readout::Equation(lines));
            readouts.push(Readout::Tiles(tiles(shown.pair, place, shown.role())));
        } else {
            readouts.push(Readout::Tiles(vec![template_tile(&shown.pair.template)]));
        }
        readouts.push(Readout::Surface(self.surface(seen, &shown)));
        readouts.extend(self.plots(seen.after.filter(|_| shown.found.is_some()).unwrap_or(seen.before)));
        readouts
    }

    fn facts(&self, shown: &Shown) -> Vec<Fact> {
        let (pair, score) = (shown.pair, self.score);
        let all = pair.costs.cells().len();
        let mut facts = vec![
            Fact::new("Template", format!("at {}", whole(pair.from)), Some(Role::Reference)),
            Fact::new("Places", format!("{} of {}", grouped(shown.done + shown.here), grouped(all)), None),
        ];
        let of = |place| format!("{} px, {}", whole(pair.displacement(place)), score.named(pair.costs[place]));
        let candidate = shown.place.filter(|_| shown.found.is_none());
        facts.extend(candidate.map(|place| Fact::new("Candidate", of(place), Some(Role::Candidate))));
        facts.extend(shown.best.map(|best| match shown.found {
            Some(_) => Fact::new("Best", of(best), Some(Role::Best)),
            None => Fact::new("Best so far", of(best), Some(Role::Best)),
        }));
        if let Some(found) = shown.found {
            facts.extend(found.second.map(|second| Fact::new("Second peak", of(second), Some(Role::Rejected))));
            let ratio = found.ratio(score).map(|ratio| fixed(ratio, 2));
            facts.extend(ratio.map(|ratio| Fact::new("Peak ratio", ratio, None)));
            facts.push(Fact::new("ZNCC at the peak", fixed(found.zncc, 3), None));
            facts.push(Fact::new("Displacement", px(self.exact(found)), Some(Role::Result)));
        }
        facts
    }

    /// The score of a place: its formula, and with its numbers.
    fn equation(&self, pair: &Pair, place: (usize, usize), role: Role) -> Vec<Math> {
        let moments = pair.moments(place);
        let result = || Math::ink(role, self.score.show(self.score.of_cost(pair.costs[place])));
        let text = |text: &str| Math::text(text.to_owned());
        let sum = || Math::Sum(Box::new(text("x, y")));
        let (template, image) = (|| Math::Var("T"), || Math::Var("I"));
        let means = || [Math::mean(template()), Math::mean(image())];
        let deviation = |of: Math| Math::indexed(Math::Var("σ"), of);
        let row = Math::Row;
        let [aa, bb, ab] = [moments.squares[0], moments.squares[1], moments.product].map(words::cost);
        match self.score {
            Score::Ssd => vec![
                row(vec![
                    text("SSD = "),
                    sum(),
                    Math::squared(row(vec![text("("), template(), text(" − "), image(), text(")")])),
                ]),
                row(vec![
                    text("= "),
                    sum(),
                    Math::squared(template()),
                    text(" + "),
                    sum(),
                    Math::squared(image()),
                    text(" − 2 "),
                    sum(),
                    template(),
                    image(),
                ]),
                row(vec![Math::text(format!("= {aa} + {bb} − 2 · {ab} = ")), result()]),
            ],
            Score::Sad => {
                let mean = pair.costs[place] / moments.count;
                vec![
                    row(vec![text("SAD = "), sum(), Math::abs(row(vec![template(), text(" − "), image()]))]),
                    row(vec![
                        Math::text(format!(
                            "= {} · {} gray levels = ",
                            grouped(moments.count as usize),
                            fixed(mean, 2)
                        )),
                        result(),
                    ]),
                ]
            }
            Score::Ncc => vec![
                row(vec![
                    text("NCC = "),
                    Math::over(
                        row(vec![sum(), template(), image()]),
                        Math::root(row(vec![
                            sum(),
                            Math::squared(template()),
                            text(" · "),
                            sum(),
                            Math::squared(image()),
                        ])),
                    ),
                ]),
                row(vec![
                    text("= "),
                    Math::over(Math::text(ab), Math::root(Math::text(format!("{aa} · {bb}")))),
                    text(" = "),
                    result(),
                ]),
            ],
            Score::Zncc => {
                let [mean_t, mean_i] = means();
                vec![
                    row(vec![
                        text("ZNCC = "),
                        Math::over(
                            row(vec![
                                Math::over(text("1"), Math::Var("N")),
                                sum(),
                                text("("),
                                template(),
                                text(" − "),
                                mean_t,
                                text(") ("),
                                image(),
                                text(" − "),
                                mean_i,
                                text(")"),
                            ]),
                            row(vec![deviation(template()), deviation(image())]),
                        ),
                    ]),
                    zero_mean_numbers(&moments),
                    row(vec![
                        text("= "),
                        Math::over(
                            Math::text(fixed(moments.covariance(), 2)),
                            Math::text(moments.deviations().map(|deviation| fixed(deviation, 2)).join(" · ")),
                        ),
                        text(" = "),
                        result(),
                    ]),
                ]
            }
        }
    }

    /// The vertices of the parabolas along x and y, with the costs behind them.
    fn parabolas(&self, found: &Found) -> Vec<Math> {
        let show = |cost: f64| if self.score.is_similarity() { fixed(cost, 4) } else { words::cost(cost) };
        let along = |i: usize, name: &'static str| {
            let [before, at, after] = found.around[i]?.map(show);
            let cost = self.score.cost_name();
            Some(Math::Row(vec![
                Math::text("Δ"),
                Math::Var(name),
                Math::text(" = "),
                Math::over(
                    Math::text(format!("{before} − {after}")),
                    Math::text(format!("2 · ({before} − 2 · {at} + {after})")),
                ),
                Math::text(" = "),
                Math::ink(Role::Best, format!("{} px", numbers::px(found.fraction[i]))),
                Math::text(format!("   ({cost} at −1, 0 and 1)")),
            ]))
        };
        let lines: Vec<_> = [along(0, "x"), along(1, "y")].into_iter().flatten().collect();
        if lines.is_empty() { self.equation(&found.pair, found.best, Role::Best) } else { lines }
    }

    /// The costs of the places scored so far.
    fn surface(&self, seen: &Seen<Self>, shown: &Shown) -> Surface {
        let (pair, width) = (shown.pair, shown.pair.costs.width());
        let count = shown.done + shown.here;
        let values = Grid::from_fn(width, pair.costs.height(), |x, y| {
            if y * width + x < count { pair.costs[(x, y)] as f32 } else { f32::NAN }
        });
        // A click leads to events of this unit.
        let event = |x: usize, y: usize| {
            let index = y * width + x;
            (shown.done..count).contains(&index).then(|| index - shown.done + 1)
        };
        let events = Grid::from_fn(width, pair.costs.height(), event);
        let truth = shown.found.and_then(|found| {
            let to = found.true_point?;
            Some([0, 1].map(|i| to[i] - seen.before.template.anchor[i] - pair.from[i] as f32))
        });
        // A match stands at its centre.
        let (width_px, height_px) = seen.before.template.pixels.size();
        let center =
            [(pair.from[0], width_px), (pair.from[1], height_px)].map(|(c, side)| c as f32 + (side as f32 - 1.0) / 2.0);
        let footing = Footing::new(Picture::NEXT, center);
        let all = pair.costs.cells().iter().map(|cost| *cost as f32);
        let range = all.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], cost| [low.min(cost), high.max(cost)]);
        Surface {
            unit: match self.score {
                Score::Ssd => "gray levels²",
                Score::Sad => "gray levels",
                Score::Ncc | Score::Zncc => "",
            },
            scale: (range[0] < range[1]).then_some(range),
            probe: shown.place.filter(|_| shown.found.is_none()).map(|place| pair.displacement(place)),
            best: shown.best.map(|best| pair.displacement(best)),
            truth,
            footing: Some(Footing { whole: Some(pair.costs.map(|cost| *cost as f32)), ..footing }),
            ..Surface::new(self.score.cost_name(), pair.displacement((0, 0)), values, events)
        }
    }

    /// The score and the drift of the pairs so far.
    fn plots(&self, state: &State) -> Vec<Readout> {
        if state.past.is_empty() {
            return Vec::new();
        }
        let line = |of: fn(&Past) -> Option<f32>| -> Vec<[f32; 2]> {
            let points = state.past.iter().enumerate().filter_map(|(i, past)| Some([(i + 1) as f32, of(past)?]));
            points.collect()
        };
        let x_max = state.span.frames().map_or(state.past.len(), |frames| frames - 1);
        let score = Series {
            title: "ZNCC at the peak",
            x_label: "pair",
            y_label: "ZNCC",
            x_max,
            lines: vec![("ZNCC", Role::Best, line(|past| Some(past.zncc)))],
            thresholds: vec![("minimum".into(), self.min_zncc)],
            ..Series::default()
        };
        let lines = [
            ("from the first template", Role::Error, line(|past| past.drift.map(Drift::length))),
            ("from the true position", Role::Truth, line(|past| past.error)),
        ];
        let lines: Vec<_> = lines.into_iter().filter(|(.., points)| !points.is_empty()).collect();
        let drift = (!lines.is_empty()).then(|| Series {
            title: "Drift",
            x_label: "pair",
            y_label: "distance (px)",
            x_max,
            lines,
            ..Series::default()
        });
        [Some(score), drift].into_iter().flatten().map(Readout::Series).collect()
    }

    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.before;
        let (width, height) = state.template.pixels.size();
        let rectangle = |[x, y]: [i32; 2]| Shape::pixels(x, y, width, height);
        trails::trail(scene, (Role::Estimate, "path of the template"), &state.track, state.frame);
        scene.mark(Picture::CURRENT, Role::Reference, rectangle(state.at));
        scene.legend(Role::Reference, "template");
        let template = std::sync::Arc::clone(&state.template);
        let canvas = Picture { role: PictureRole::Template, ..Picture::CURRENT };
        scene.pictures = vec![
            Canvas::of_clip(Picture::CURRENT),
            Canvas::of_clip(Picture::NEXT),
            Canvas::made(canvas, move || Frame::gray(template.pixels.clone())),
        ];
        let Some(shown) = Shown::of(seen) else { return };
        let (pair, places) = (shown.pair, shown.pair.costs.size());
        let mut mark = |role, meaning, shape| {
            scene.mark(Picture::NEXT, role, shape);
            scene.legend(role, meaning);
        };
        let area = Shape::pixels(pair.origin[0], pair.origin[1], places.0 + width - 1, places.1 + height - 1);
        mark(Role::Window, "search area", area);
        if let Some(best) = shown.best {
            mark(Role::Best, "best so far", rectangle(pair.corner(best)));
        }
        if let Some(place) = shown.place.filter(|_| shown.found.is_none()) {
            mark(Role::Candidate, "candidate", rectangle(pair.corner(place)));
        }
        let Some(found) = shown.found else { return };
        if let Some(second) = found.second {
            mark(Role::Rejected, "second-best peak", rectangle(pair.corner(second)));
        }
        if let Some(truth) = found.true_point {
            mark(Role::Truth, "true position", Shape::Points(vec![truth]));
        }
        if let Some([u, v]) = found.feature.displacement {
            let from = found.feature.at;
            trails::displacements(scene, vec![Arrow { from, to: [from[0] + u, from[1] + v] }]);
        }
    }
}

fn zero_mean_numbers(moments: &Moments) -> Math {
    let [mean_t, mean_i] = moments.means().map(|mean| fixed(mean, 2));
    let [of_t, of_i] = moments.deviations().map(|deviation| fixed(deviation, 2));
    let value = |symbol: Math, value: String| [symbol, Math::text(format!(" = {value}, "))];
    let sigma = |of: &'static str| Math::indexed(Math::Var("σ"), Math::Var(of));
    let mut parts = vec![Math::text(format!("N = {}, ", grouped(moments.count as usize)))];
    parts.extend(value(Math::mean(Math::Var("T")), mean_t));
    parts.extend(value(Math::mean(Math::Var("I")), mean_i));
    parts.extend(value(sigma("T"), of_t));
    parts.extend([sigma("I"), Math::text(format!(" = {of_i}"))]);
    Math::Row(parts)
}

fn template_facts(template: &Template) -> Vec<Fact> {
    let (width, height) = template.pixels.size();
    let mut facts = vec![
        Fact::new("Template", format!("{width}×{height} px at {}", whole(template.at)), Some(Role::Reference)),
        Fact::new("Standard deviation", format!("{} gray levels", fixed(template.deviation(), 2)), None),
    ];
    facts.extend(template.eigenvalue.map(|value| Fact::new("Smaller eigenvalue λ₂", fixed(value.into(), 2), None)));
    facts
}

fn template_tile(template: &Template) -> Tile {
    let values = template.pixels.map(|&pixel| f32::from(pixel));
    Tile { label: "template", role: Some(Role::Reference), values, range: [0.0, 255.0], framed: Vec::new() }
}

/// The template, the window at a place, and their difference.
fn tiles(pair: &Pair, place: (usize, usize), role: Role) -> Vec<Tile> {
    let template = &pair.template.pixels;
    let under = window(pair.frames[1].luma(), pair.corner(place), template.size());
    let difference = Grid::from_fn(template.width(), template.height(), |x, y| {
        f32::from(under[(x, y)]) - f32::from(template[(x, y)])
    });
    let values = under.map(|&pixel| f32::from(pixel));
    vec![
        template_tile(&pair.template),
        Tile { label: "window", role: Some(role), values, range: [0.0, 255.0], framed: Vec::new() },
        Tile {
            label: "difference",
            role: Some(Role::Error),
            values: difference,
            range: [-64.0, 64.0],
            framed: Vec::new(),
        },
    ]
}
