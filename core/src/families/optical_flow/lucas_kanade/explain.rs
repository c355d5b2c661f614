//! How Lucas and Kanade's method is told and drawn.

use super::{Event, LucasKanade, Solution, line, solved};
use crate::base::{Threads, words};
use crate::methods::differential::{Constraints, Linear, Tensor, Texture, explain, field};
use crate::run::Seen;
use crate::scene::{
    Constraint, Fact, Math, Picture, Plane, Readout, Role, Scene, Sentence, Shape, Spread, Step, arrow_spacing,
};

/// The pixel that is explained, the one pointed at or else the one at work, and what its window says.
struct Looked<'a> {
    pixel: (usize, usize),
    linear: &'a Linear,
    tensor: Tensor,
    solution: Solution,
    spread: Option<Spread>,
}

impl Looked<'_> {
    fn is_told(&self) -> bool {
        self.solution.displacement[0].is_finite()
    }
}

fn px(uv: [f32; 2]) -> String {
    format!("{} px", words::vector(uv))
}

impl LucasKanade {
    fn look<'a>(&self, seen: &Seen<'a, Self>) -> Option<Looked<'a>> {
        let state = seen.before;
        let last = solved(seen.events).len().checked_sub(1)?;
        let pointed_at = seen.point().and_then(|point| state.given.pixel_at(point));
        let pixel = pointed_at.unwrap_or((last, state.y));
        let linear = self.linear(state, &Threads::single());
        let mut tensor = Tensor::default();
        self.window().sums(&linear.factors).row(pixel.1, |x, found| {
            if x == pixel.0 {
                tensor = found;
            }
        });
        let solution = self.solve(&tensor);
        Some(Looked { pixel, linear, tensor, solution, spread: tensor.spread(solution.displacement) })
    }

    pub(super) fn told(&self, seen: &Seen<Self>) -> Step {
        if let [Event::Linearized] = seen.events {
            return self.linearized(seen.before.iteration);
        }
        let Some(looked) = self.look(seen) else {
            let sentence = "One pixel says too little, so those of a window are asked together: T (u, v) = −Σ w ∇I I_t, where \
                            T holds the products of I_x and I_y alone, summed over the window. (In some course notes it reads \
                            (I_x, I_y; I_t, I_y) (u, v) = −(I_t, I_x): a misprint.)";
            return Step {
                line: line::START_AT_ZERO,
                sentence: Sentence::default().text(sentence),
                readouts: Vec::new(),
            };
        };
        let line = if looked.is_told() { line::SOLVE } else { line::IS_SINGULAR };
        Step { line, sentence: self.sentence(&looked), readouts: self.readouts(seen, &looked) }
    }

    /// What is told before the first row of an iteration.
    fn linearized(&self, iteration: usize) -> Step {
        let number = format!("Iteration {} of {}", iteration + 1, self.iterations);
        let what = match iteration {
            0 => ": the gradient constraint of each pixel is taken from both frames as they are.",
            _ => {
                ": frame t+1 is brought back along the displacements found so far, and the gradient constraints are taken \
                 anew."
            }
        };
        let facts = vec![Fact::new("Iteration", format!("{} of {}", iteration + 1, self.iterations), None)];
        let sentence = Sentence::default().text(number + what);
        Step { line: line::LINEARIZE, sentence, readouts: vec![Readout::Facts(facts)] }
    }

    pub(super) fn drawn(&self, seen: &Seen<Self>, scene: &mut Scene) {
        field::draw(seen.before.flow(seen.events), scene);
        draw_textures(seen, scene);
        let Some(looked) = self.look(seen) else { return };
        let ((x, y), reach) = (looked.pixel, self.window as i32 / 2);
        let (left, top, side) = (x as i32 - reach, y as i32 - reach, 2 * reach as usize + 1);
        scene.mark(Picture::CURRENT, Role::Window, Shape::pixels(left, top, side, side));
        scene.legend(Role::Window, "window");
        scene.mark(Picture::CURRENT, Role::Reference, Shape::pixels(x as i32, y as i32, 1, 1));
        scene.legend(Role::Reference, "pixel");
        if let Some(spread) = looked.spread {
            let center = [x as f32 + spread.center[0], y as f32 + spread.center[1]];
            let shape = Shape::Ellipse { center, radii: spread.radii, angle_rad: spread.angle_rad };
            scene.mark(Picture::CURRENT, Role::Measured, shape);
            scene.legend(Role::Measured, "one standard deviation");
        }
    }

    fn sentence(&self, looked: &Looked) -> Sentence {
        let Solution { displacement, eigenvalues, texture } = looked.solution;
        let (x, y) = looked.pixel;
        let [large, small] = eigenvalues.map(words::number);
        let said = Sentence::default().text("Around ").ink(Role::Reference, format!("pixel ({x}, {y})"));
        // Where the threshold is not the reason, it is that there is nothing but rounding.
        let why = |eigenvalue: f32, otherwise: &str| match eigenvalue < self.threshold {
            true => format!("below the threshold of {}", words::number(self.threshold)),
            false => otherwise.to_owned(),
        };
        match texture {
            Texture::Gone => said.text(" all pixels of the window left the picture. It says nothing."),
            Texture::Flat => said.text(format!(
                " there is hardly any gradient: both eigenvalues, {large} and {small}, are {}. The window says nothing.",
                why(eigenvalues[0], "nearly 0")
            )),
            Texture::Edge => said.text(format!(
                " all gradients point the same way: one eigenvalue is {large}, but the other {small}, {}. The lines of the \
                 window are all but parallel, and cross nowhere for certain.",
                why(eigenvalues[1], "nearly 0 beside it")
            )),
            Texture::Corner => said
                .text(format!(
                    " gradients point in several directions: the eigenvalues are {large} and {small}. The lines of the \
                     window cross near "
                ))
                .ink(Role::Result, px(displacement))
                .text(", which fits them best in the mean square."),
        }
    }

    fn facts(&self, seen: &Seen<Self>, looked: &Looked) -> Vec<Fact> {
        let Looked { pixel, linear, tensor, solution, spread } = looked;
        let fact = |label, value, role| Fact { label, value, role };
        let mut facts =
            vec![fact("Pixel", format!("({}, {})", pixel.0, pixel.1), Some(Role::Reference)), linear.fact(*pixel)];
        if seen.before.iteration > 0 {
            facts.push(fact("Before, (u₀, v₀)", px(linear.start.at(pixel.0, pixel.1)), Some(Role::Best)));
        }
        let [gone, all] = self.left(&linear.factors, *pixel);
        if gone > 0 {
            facts.push(fact("Left the picture", format!("{gone} of {all} pixels of the window"), None));
        }
        let [large, small] = solution.eigenvalues.map(words::number);
        let texture = match solution.texture {
            Texture::Gone => "gone",
            Texture::Flat => "flat",
            Texture::Edge => "edge",
            Texture::Corner => "corner",
        };
        facts.push(fact("Eigenvalues", format!("{large} and {small}: {texture}"), None));
        if looked.is_told() {
            let off = words::number(tensor.residual(solution.displacement).sqrt());
            facts.push(fact("Displacement", px(solution.displacement), Some(Role::Result)));
            facts.push(fact("Constraints off by", format!("{off} gray levels (root mean square)"), None));
        }
        if let Some(spread) = spread {
            let [a, b] = spread.radii.map(words::number);
            facts.push(fact("Standard deviation", format!("{a} to {b} px"), None));
        }
        let truth = seen.before.given.true_displacement(*pixel);
        facts.extend(truth.map(|truth| fact("Truth", px(truth), Some(Role::Truth))));
        facts
    }

    fn readouts(&self, seen: &Seen<Self>, looked: &Looked) -> Vec<Readout> {
        let (given, displacement) = (&seen.before.given, looked.solution.displacement);
        let mut points = vec![("zero", Role::Reference, [0.0; 2])];
        points.extend(looked.is_told().then_some(("displacement", Role::Result, displacement)));
        let truth = given.true_displacement(looked.pixel);
        points.extend(truth.map(|truth| ("truth", Role::Truth, truth)));
        let plane = Plane {
            title: "Gradient constraints of the window",
            unit: "px".into(),
            reach: explain::reach(points.iter().map(|(.., point)| *point)),
            lines: self.lines(&looked.linear.factors, looked.pixel),
            points,
            ellipse: looked.spread,
        };
        let [current, next] = &given.pictures;
        let radius = (self.window / 2).min(5);
        vec![
            Readout::Facts(self.facts(seen, looked)),
            Readout::Equation(equation(looked, seen.before.iteration > 0)),
            Readout::Plane(plane),
            Readout::Tiles(looked.linear.tiles([current, next], looked.pixel, radius)),
        ]
    }

    /// How many pixels of the window around a pixel left the picture, and how many it has in frame t.
    fn left(&self, of: &Constraints, (x, y): (usize, usize)) -> [usize; 2] {
        let (window, (width, height)) = (self.window(), of.a.size());
        let ((left, across), (top, down)) = (window.inside(x, width), window.inside(y, height));
        let (columns, rows) = (left..left + across.len(), top..top + down.len());
        let all = columns.len() * rows.len();
        let gone = |y: usize| of.unknown_in_row(y).filter(|x| columns.contains(x)).count();
        [rows.map(gone).sum(), all]
    }

    /// The lines of the window's pixels, of a large one only of every few; the more a pixel counts, the stronger.
    fn lines(&self, of: &Constraints, (x, y): (usize, usize)) -> Vec<Constraint> {
        let (window, reach) = (self.window(), self.window as isize / 2);
        let step = self.window / 12 + 1;
        let along = || (-reach..=reach).step_by(step);
        let pixels = along().flat_map(|j| along().map(move |i| [i, j])).filter_map(|[i, j]| {
            let place = (x.checked_add_signed(i)?, y.checked_add_signed(j)?);
            of.a.get(place.0, place.1)?;
            let [a, b, c] = of.at(place);
            Some(([a, b, c], window.weight([i, j]) * a.hypot(b)))
        });
        let pixels: Vec<_> = pixels.collect();
        let most = pixels.iter().fold(f32::MIN_POSITIVE, |most, (_, weight)| most.max(*weight));
        let line = |(factors, weight)| explain::line(factors, weight / most, Role::Candidate);
        pixels.into_iter().filter_map(line).collect()
    }
}

/// Marks where windows say nothing: at the places where arrows would stand.
fn draw_textures(seen: &Seen<LucasKanade>, scene: &mut Scene) {
    let textures = seen.before.solutions(seen.events, |solution| solution.map(|solution| solution.texture));
    // At every other place of an arrow, so that the edge itself is seen between the marks.
    let spacing = 2 * arrow_spacing(textures.size());
    let along = |extent: usize| (spacing / 2..extent).step_by(spacing);
    let places: Vec<_> = along(textures.height()).flat_map(|y| along(textures.width()).map(move |x| (x, y))).collect();
    for (texture, role, meaning) in [
        (Texture::Edge, Role::Rejected, "edge: only the motion across it is seen"),
        (Texture::Flat, Role::Predicted, "flat: no motion is seen"),
    ] {
        let is_so = |place: &&(usize, usize)| textures[**place] == Some(texture);
        let points: Vec<_> = places.iter().filter(is_so).map(|(x, y)| [*x as f32, *y as f32]).collect();
        if !points.is_empty() {
            scene.mark(Picture::CURRENT, role, Shape::Points(points));
            scene.legend(role, meaning);
        }
    }
}

/// The two equations of the window, in symbols and with its means. Once frame t + 1 is brought back (`is_about`), c stands for
/// I_t; what that is, is told of the pixel itself.
fn equation(looked: &Looked, is_about: bool) -> Vec<Math> {
    let Looked { pixel, linear, tensor, .. } = looked;
    let right = || if is_about { Math::Var("c") } else { explain::derivative("t") };
    let mut lines = if is_about { linear.definition(*pixel, Role::Reference).to_vec() } else { Vec::new() };
    let squared = |along| Math::power(explain::derivative(along), Math::text("2"));
    let mixed = || Math::Row(vec![explain::derivative("x"), explain::derivative("y")]);
    let equal = |along| Math::Row(vec![explain::derivative(along), right()]);
    lines.extend([
        symbols([squared("x"), mixed(), equal("x")], ""),
        symbols([mixed(), squared("y"), equal("y")], ",  Σ w = 1"),
        numbers(tensor.xx, tensor.xy, tensor.xt),
        numbers(tensor.xy, tensor.yy, tensor.yt),
    ]);
    if looked.is_told() {
        let found = Math::ink(Role::Result, words::vector(looked.solution.displacement));
        let parts = [Math::text("("), Math::Var("u"), Math::text(", "), Math::Var("v"), Math::text(") = "), found];
        lines.push(Math::Row(parts.to_vec()));
    }
    lines
}

/// An equation of the window in symbols: the products whose means it has.
fn symbols([first, second, right]: [Math; 3], after: &str) -> Math {
    let sum = |product| Math::Row(vec![Math::text("Σ "), Math::Var("w"), Math::text(" "), product]);
    Math::Row(vec![
        sum(first),
        Math::text(" "),
        Math::Var("u"),
        Math::text(" + "),
        sum(second),
        Math::text(" "),
        Math::Var("v"),
        Math::text(" = − "),
        sum(right),
        Math::text(after),
    ])
}

/// An equation of the window with its means.
fn numbers(a: f32, b: f32, c: f32) -> Math {
    Math::Row(vec![
        Math::ink(Role::Reference, words::number(a)),
        Math::text(" "),
        Math::Var("u"),
        Math::text(" "),
        Math::ink(Role::Reference, words::plus(b)),
        Math::text(" "),
        Math::Var("v"),
        Math::text(" = "),
        Math::ink(Role::Reference, words::number(-c)),
    ])
}
