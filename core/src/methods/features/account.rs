//! How the following of one point is told and drawn, one level at a time.

use super::follow::{Event, Follow};
use super::tracker::{Level, Mismatch};
use crate::base::words;
use crate::geometry::Grid;
use crate::methods::differential::{Tensor, explain};
use crate::products::Status;
use crate::scene::{Fact, Math, Picture, Readout, Role, Scene, Sentence, Shape, Tile};

/// What has happened to a point on a level by now.
pub struct Account<'a> {
    /// How it is followed.
    pub follow: Follow,
    /// The levels of the picture that it is in, and of that in which it is looked for.
    pub pyramids: [&'a [Level]; 2],
    /// The level at hand.
    pub level: usize,
    /// Its place in px of the picture.
    pub at: [f32; 2],
    /// The displacement with which the level begins, in px of the level.
    pub guess: [f32; 2],
    /// The events on this level; at least one.
    pub events: Vec<Event>,
    /// What it is called: `Point 7`.
    pub name: String,
}

fn px(uv: [f32; 2]) -> String {
    in_px(uv, 0)
}

/// A displacement in px of a level.
fn in_px(uv: [f32; 2], level: usize) -> String {
    let of = if level == 0 { String::new() } else { format!(" of level {level}") };
    format!("{} px{of}", words::vector(uv))
}

fn after(from: [f32; 2], update: [f32; 2]) -> [f32; 2] {
    [0, 1].map(|i| from[i] + update[i])
}

impl Account<'_> {
    /// A displacement on the level at hand.
    fn px(&self, uv: [f32; 2]) -> String {
        in_px(uv, self.level)
    }

    fn scale(&self) -> f32 {
        (1u32 << self.level) as f32
    }

    /// The displacement by now, in px of the level.
    pub fn displacement(&self) -> [f32; 2] {
        match self.events.last() {
            None | Some(Event::Window(_)) => self.guess,
            Some(Event::Iteration { from, update, .. }) => after(*from, *update),
            Some(Event::Handed(displacement, _) | Event::End(displacement, _)) => *displacement,
        }
    }

    /// The displacement by now, in px of the picture.
    pub fn on_picture(&self) -> [f32; 2] {
        self.displacement().map(|c| c * self.scale())
    }

    fn tensor(&self) -> Option<Tensor> {
        self.events.iter().find_map(|event| if let Event::Window(tensor) = event { Some(*tensor) } else { None })
    }

    /// The last update and the mismatch that led to it.
    fn last(&self) -> Option<(Mismatch, [f32; 2])> {
        self.events.iter().rev().find_map(|event| match event {
            Event::Iteration { mismatch, update, .. } => Some((*mismatch, *update)),
            _ => None,
        })
    }

    /// The window in the first picture, its guess and its places in the second.
    pub fn draw(&self, [from, to]: [Picture; 2], scene: &mut Scene) {
        let half = (self.follow.reach as f32 + 0.5) * self.scale();
        let place = |by: [f32; 2]| [0, 1].map(|i| self.at[i] + by[i] * self.scale());
        let rect = |[x, y]: [f32; 2]| Shape::Rect { min: [x - half, y - half], max: [x + half, y + half] };
        let mut mark = |on, role, shape, meaning| {
            scene.mark(on, role, shape);
            scene.legend(role, meaning);
        };
        mark(from, Role::Reference, rect(self.at), "window");
        mark(to, Role::Predicted, rect(place(self.guess)), "guess from the coarser level");
        let is_done = matches!(self.events.last(), Some(Event::Handed(..) | Event::End(..)));
        let role = if is_done { Role::Best } else { Role::Candidate };
        mark(to, role, rect(place(self.displacement())), "its place in the other frame");
        let steps = self.events.iter().filter_map(|event| match event {
            Event::Iteration { from, update, .. } => Some([*from, after(*from, *update)]),
            _ => None,
        });
        let steps: Vec<_> = steps.collect();
        if let Some(first) = steps.first() {
            let trail = [first[0]].into_iter().chain(steps.iter().map(|step| step[1]));
            mark(
                to,
                Role::Estimate,
                Shape::Path { points: trail.map(place).collect(), closed: false },
                "path of its centre",
            );
        }
    }

    /// The last event in words.
    pub fn sentence(&self) -> Sentence {
        let said = Sentence::default().ink(Role::Reference, self.name.clone());
        let (width, height) = self.pyramids[0][self.level].size();
        match self.events.last() {
            None => said,
            Some(Event::Window(tensor)) => {
                let [large, small] = tensor.eigenvalues().map(words::number);
                let told = format!(
                    " on level {}, {width}×{height} px: the tensor of its window has the eigenvalues {large} and {small}. It \
                     begins at ",
                    self.level
                );
                said.text(told).ink(Role::Predicted, self.px(self.guess)).text(".")
            }
            Some(Event::Iteration { from, mismatch, update }) => {
                let end = if self.follow.converges(*update) { ", less than epsilon: that was the last" } else { "" };
                Sentence::default()
                    .text("At ")
                    .ink(Role::Candidate, words::vector(*from))
                    .text(format!(
                        " the windows differ by {} gray levels on average. The mismatch says to move by {}{end}: now ",
                        words::number(mismatch.residual),
                        self.px(*update)
                    ))
                    .ink(Role::Candidate, self.px(after(*from, *update)))
                    .text(".")
            }
            Some(Event::Handed(displacement, reason)) => {
                let told = match reason {
                    None => format!(" leaves level {} with {}.", self.level, self.px(*displacement)),
                    Some(status) => format!(
                        " finds nothing on level {}{} The guess of {} is handed on.",
                        self.level,
                        why(*status),
                        self.px(*displacement)
                    ),
                };
                let told = format!("{told} The finer level begins with twice that, ");
                said.text(told).ink(Role::Predicted, in_px(displacement.map(|c| 2.0 * c), self.level - 1)).text(".")
            }
            Some(Event::End(displacement, Ok(residual))) => {
                let differs =
                    format!(": its window differs by {} gray levels on average there.", words::number(*residual));
                said.text(" moves by ").ink(Role::Result, px(*displacement)).text(differs)
            }
            Some(Event::End(_, Err(status))) => said.text(" is ").ink(Role::Rejected, "lost").text(why(*status)),
        }
    }

    /// The level in numbers.
    pub fn facts(&self) -> Vec<Fact> {
        let fact = |label, value: String, role| Fact { label, value, role };
        let mut facts = vec![
            fact("Level", format!("{}, from {} down to 0", self.level, self.pyramids[0].len() - 1), None),
            fact("Guess", self.px(self.guess), Some(Role::Predicted)),
        ];
        if let Some(tensor) = self.tensor() {
            let [large, small] = tensor.eigenvalues().map(words::number);
            facts.push(fact("Eigenvalues", format!("{large} and {small}"), None));
        }
        if let Some((mismatch, update)) = self.last() {
            facts.push(fact("Update", self.px(update), Some(Role::Candidate)));
            facts.push(fact("Residual", format!("{} gray levels before it", words::number(mismatch.residual)), None));
        }
        let role = if self.level == 0 { Role::Result } else { Role::Best };
        facts.push(fact("Displacement", self.px(self.displacement()), Some(role)));
        if self.level > 0 {
            facts.push(fact("On the picture", px(self.on_picture()), None));
        }
        facts
    }

    /// The equation of the last update, and the windows.
    pub fn readouts(&self) -> Vec<Readout> {
        let equation = self.tensor().map(|tensor| Readout::Equation(equation(&tensor, self.last())));
        equation.into_iter().chain([Readout::Tiles(self.tiles())]).collect()
    }

    /// The window, where it lies in the other picture, and what differs.
    fn tiles(&self) -> Vec<Tile> {
        let [current, next] = self.pyramids.map(|levels| &levels[self.level]);
        let (reach, side) = (self.follow.reach as f32, 2 * self.follow.reach + 1);
        let at = self.at.map(|c| c / self.scale());
        let of = |level: &Level, by: [f32; 2]| {
            Grid::from_fn(side, side, |i, j| {
                let place = [at[0] + by[0] + i as f32 - reach, at[1] + by[1] + j as f32 - reach];
                if level.holds(place) { (level.sample(place) * 10.0).round() / 10.0 } else { f32::NAN }
            })
        };
        let (window, there) = (of(current, [0.0; 2]), of(next, self.displacement()));
        let difference = Grid::from_fn(side, side, |i, j| window[(i, j)] - there[(i, j)]);
        let most = difference.cells().iter().filter(|v| v.is_finite()).fold(1.0f32, |most, v| most.max(v.abs()));
        let tile = |label, role, values, range| Tile { label, role, values, range };
        vec![
            tile("Window", Some(Role::Reference), window, [0.0, 255.0]),
            tile("Its place", Some(Role::Candidate), there, [0.0, 255.0]),
            tile("δI", None, difference, [-most, most]),
        ]
    }
}

/// Why nothing is found, or a feature is lost, as the end of a sentence.
pub fn why(status: Status) -> &'static str {
    match status {
        Status::Outside => ": it leaves the picture.",
        Status::Flat => ": its window has too little gradient in one direction, or in both.",
        Status::Astray => ": it does not come back to where it was.",
        Status::Changed => ": it does not look like its first view any more, however that is turned.",
        Status::Unlike => ": what it led to looks too different from the frame before.",
        Status::Found | Status::Tracked => ".",
    }
}

/// T η = b in symbols, and with the means over the window.
fn equation(window: &Tensor, last: Option<(Mismatch, [f32; 2])>) -> Vec<Math> {
    // Of a window that lies partly outside the other picture only the rest counts.
    let tensor = last.as_ref().map_or(window, |(mismatch, _)| &mismatch.tensor);

    let eta = |index| Math::indexed(Math::Var("η"), Math::Var(index));
    let product = |along| {
        let factors = vec![Math::text("δ"), Math::Var("I"), Math::text(" "), explain::derivative(along)];
        Math::mean(Math::Row(factors))
    };
    let symbols = Math::Row(vec![
        Math::Bold("T"),
        Math::text(" "),
        Math::Bold("η"),
        Math::text(" = "),
        Math::Bold("b"),
        Math::text(" = "),
        Math::column([product("x"), product("y")]),
    ]);
    let entry = |value: f32| Math::ink(Role::Reference, words::number(value));
    let right = |value: Option<f32>| Math::ink(Role::Candidate, value.map_or_else(|| "?".into(), words::number));
    let vector = last.map(|(mismatch, _)| mismatch.vector);
    let numbers = Math::Row(vec![
        Math::Matrix(vec![vec![entry(tensor.xx), entry(tensor.xy)], vec![entry(tensor.xy), entry(tensor.yy)]]),
        Math::column([eta("u"), eta("v")]),
        Math::text(" = "),
        Math::column([0, 1].map(|i| right(vector.map(|b| b[i])))),
    ]);
    let mut lines = vec![symbols, numbers];
    lines.extend(last.map(|(_, update)| {
        Math::Row(vec![Math::Bold("η"), Math::text(" = "), Math::ink(Role::Result, words::vector(update))])
    }));
    lines
}
