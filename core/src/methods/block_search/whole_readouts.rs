//! The formulas of costs that need the whole block: means, transform coefficients, moments.

use super::explain::signed;
use super::probe::Probe;
use super::readouts::offset;
use super::{Cost, Match};
use crate::base::words::fixed;
use crate::geometry::Grid;
use crate::methods::cost::{Cut, whole};
use crate::scene::{Math, Role};

impl Probe<'_> {
    /// The formula of the cost, and with the numbers of block `a` and candidate `b`.
    pub(super) fn whole_equation(&self, candidate: Match, a: &Cut, b: &Cut) -> Vec<Math> {
        let [u, v] = candidate.vector().map(signed);
        let name = Math::text(format!("{}({u}, {v}) = ", self.settings.matching.cost.label()));
        let result = Math::text(format!("= {}", self.distortion(candidate)));
        let mut lines = match self.settings.matching.cost {
            Cost::Satd => vec![hadamard(), self.first_coefficients(a, b)],
            Cost::Ncc => vec![correlation(candidate.vector()), self.moments(a, b)],
            _ => vec![zero_mean(candidate.vector()), self.off_means(a, b)],
        };
        lines[0] = Math::Row(vec![name, lines[0].clone()]);
        lines.push(result);
        lines
    }

    /// The means of block and candidate.
    fn means(&self, a: &Cut, b: &Cut) -> [f64; 2] {
        let block = self.block();
        let places = || (0..block.height).flat_map(|y| (0..block.width).map(move |x| (x, y)));
        [a, b].map(|cut| {
            let sum: u32 = places().map(|(x, y)| u32::from(cut.pixel(x, y))).sum();
            f64::from(sum) / (block.width * block.height) as f64
        })
    }

    fn off_means(&self, a: &Cut, b: &Cut) -> Math {
        let [mean_a, mean_b] = self.means(a, b);
        let term = |x: usize, y: usize| {
            Math::Abs(Box::new(Math::Row(vec![
                Math::text("("),
                Math::ink(Role::Reference, a.pixel(x, y).to_string()),
                Math::text(format!(" − {mean_a:.2}) − (")),
                Math::ink(self.shown_role(), b.pixel(x, y).to_string()),
                Math::text(format!(" − {mean_b:.2})")),
            ])))
        };
        let block = self.block();
        Math::Row(vec![Math::text("= "), term(0, 0), Math::text(" + … + "), term(block.width - 1, block.height - 1)])
    }

    fn first_coefficients(&self, a: &Cut, b: &Cut) -> Math {
        let (pixels, stride) = b.rows();
        let [first, ..] = whole::coefficients(a, pixels, stride, (0, 0));
        let shown = first.map(|coefficient| coefficient.to_string()).join(" + ");
        Math::Row(vec![
            Math::text("= "),
            Math::Frac(Box::new(Math::text("1")), Box::new(Math::text("2"))),
            Math::text(format!(" · ({shown} + …)")),
        ])
    }

    fn moments(&self, a: &Cut, b: &Cut) -> Math {
        let (pixels, stride) = b.rows();
        let count = (self.block().width * self.block().height) as f64;
        let [of_a, of_b, both] = whole::moments(a, pixels, stride).map(|moment| fixed(moment as f64 / count, 0));
        let below = vec![Math::ink(Role::Reference, of_a), Math::text(" · "), Math::ink(self.shown_role(), of_b)];
        let root = Math::root(Math::Row(below));
        Math::Row(vec![Math::text("= 1 − "), Math::Frac(Box::new(Math::text(both)), Box::new(root))])
    }

    /// The contribution of each pixel to the cost, its name, and its largest possible value.
    pub(super) fn whole_tile(&self, a: &Cut, b: &Cut) -> (&'static str, Grid<f32>, f32) {
        let block = self.block();
        if self.settings.matching.cost == Cost::Satd {
            let (pixels, stride) = b.rows();
            let coefficient = |x: usize, y: usize| {
                let tile = whole::coefficients(a, pixels, stride, (x / 4 * 4, y / 4 * 4));
                tile[y % 4][x % 4] as f32 / 2.0
            };
            return ("|coefficient| / 2", Grid::from_fn(block.width, block.height, coefficient), 255.0 * 8.0);
        }
        let [mean_a, mean_b] = self.means(a, b);
        let off = |x, y| ((f64::from(a.pixel(x, y)) - mean_a) - (f64::from(b.pixel(x, y)) - mean_b)).abs() as f32;
        ("|zero-mean difference|", Grid::from_fn(block.width, block.height, off), 255.0)
    }
}

/// The difference of a pixel from the mean of its block.
fn off_mean_of_current() -> Math {
    Math::Row(vec![
        Math::text("("),
        Math::indexed(Math::Var("I"), Math::Var("t")),
        Math::text("(x, y) − "),
        Math::mean(Math::indexed(Math::Var("I"), Math::Var("t"))),
        Math::text(")"),
    ])
}

/// The same of the candidate's pixel.
fn off_mean_of_next(displacement: [f32; 2]) -> Math {
    Math::Row(vec![
        Math::text("("),
        Math::indexed(Math::Var("I"), Math::text("t+1")),
        Math::text(format!("(x{}, y{}) − ", offset(displacement[0]), offset(displacement[1]))),
        Math::mean(Math::indexed(Math::Var("I"), Math::text("t+1"))),
        Math::text(")"),
    ])
}

fn zero_mean(displacement: [f32; 2]) -> Math {
    let difference = vec![off_mean_of_current(), Math::text(" − "), off_mean_of_next(displacement)];
    Math::Row(vec![Math::Sum(Box::new(Math::text("x, y"))), Math::Abs(Box::new(Math::Row(difference)))])
}

fn hadamard() -> Math {
    let transform = Math::Row(vec![Math::Var("H"), Math::Var("D"), Math::Var("H")]);
    let bracketed = Math::Row(vec![Math::text("("), transform, Math::text(")")]);
    Math::Row(vec![
        Math::Frac(Box::new(Math::text("1")), Box::new(Math::text("2"))),
        Math::text(" "),
        Math::Sum(Box::new(Math::text("4×4"))),
        Math::Sum(Box::new(Math::text("i, j"))),
        Math::Abs(Box::new(Math::indexed(bracketed, Math::text("i, j")))),
    ])
}

fn correlation(displacement: [f32; 2]) -> Math {
    let sum = |what: Vec<Math>| Math::Row([vec![Math::Sum(Box::new(Math::text("x, y")))], what].concat());
    let (current, next) = (off_mean_of_current(), off_mean_of_next(displacement));
    let square = |base: &Math| Math::power(base.clone(), Math::text("2"));
    let below = vec![sum(vec![square(&current)]), Math::text(" · "), sum(vec![square(&next)])];
    Math::Row(vec![
        Math::text("1 − "),
        Math::Frac(Box::new(sum(vec![current, Math::text(" · "), next])), Box::new(Math::root(Math::Row(below)))),
    ])
}
