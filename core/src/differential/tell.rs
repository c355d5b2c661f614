//! How derivatives and displacements are told.

use super::Derivatives;
use crate::Grid;
use crate::scene::{Constraint, Fact, Math, Role, Tile};

/// A real number as a person reads it: a true minus sign, and about three digits that count.
pub fn number(v: f32) -> String {
    let size = v.abs();
    let decimals = match size {
        _ if size >= 100.0 => 0,
        _ if size >= 10.0 => 1,
        _ if size >= 1.0 || size == 0.0 => 2,
        _ => 3,
    };
    let digits = format!("{size:.decimals$}");
    let is_negative = v < 0.0 && digits.bytes().any(|b| (b'1'..=b'9').contains(&b));
    if is_negative { format!("−{digits}") } else { digits }
}

/// A displacement as a person reads it.
pub fn vector([u, v]: [f32; 2]) -> String {
    // A space at which no line is broken.
    format!("({},\u{a0}{})", number(u), number(v))
}

/// `+ 3.1` or `− 3.1`.
pub fn plus(v: f32) -> String {
    let number = number(v);
    number.strip_prefix('−').map_or_else(|| format!("+ {number}"), |size| format!("− {size}"))
}

/// Iₓ, I_y or Iₜ.
pub fn derivative(along: &'static str) -> Math {
    Math::indexed(Math::Var("I"), Math::Var(along))
}

/// The gradient constraint: in symbols, and with the derivatives of one pixel.
pub fn constraint_equation([a, b, c]: [f32; 3], role: Role) -> [Math; 2] {
    let symbols = Math::Row(vec![
        derivative("x"),
        Math::text(" "),
        Math::Var("u"),
        Math::text(" + "),
        derivative("y"),
        Math::text(" "),
        Math::Var("v"),
        Math::text(" + "),
        derivative("t"),
        Math::text(" = 0"),
    ]);
    let numbers = Math::Row(vec![
        Math::ink(role, number(a)),
        Math::text(" "),
        Math::Var("u"),
        Math::text(" "),
        Math::ink(role, plus(b)),
        Math::text(" "),
        Math::Var("v"),
        Math::text(" "),
        Math::ink(role, plus(c)),
        Math::text(" = 0"),
    ]);
    [symbols, numbers]
}

/// The constraint of a pixel as a line of the plane of displacements; a flat one allows any.
pub fn line(factors: [f32; 3], weight: f32, role: Role) -> Option<Constraint> {
    let is_line = factors.iter().all(|f| f.is_finite()) && factors[0].hypot(factors[1]) > 1e-3;
    is_line.then_some(Constraint { factors, weight, role })
}

/// Displacements up to here are shown in a plane so that `points` are well inside.
pub fn reach(points: impl IntoIterator<Item = [f32; 2]>) -> f32 {
    let most = points.into_iter().flatten().filter(|c| c.is_finite()).fold(0.0f32, |most, c| most.max(c.abs()));
    // By powers of two, so that it stays the same from step to step.
    let mut reach = 1.0;
    while reach < 1.25 * most && reach < 1024.0 {
        reach *= 2.0;
    }
    reach
}

impl Derivatives {
    /// Iₓ, I_y and Iₜ of a pixel.
    pub fn at(&self, place: (usize, usize)) -> [f32; 3] {
        [self.x[place], self.y[place], self.t[place]]
    }

    /// A table's row with them.
    pub fn fact(&self, place: (usize, usize)) -> Fact {
        let [x, y, t] = self.at(place).map(number);
        Fact { label: "Iₓ, I_y, Iₜ", value: format!("{x}, {y}, {t}"), role: None }
    }

    /// Frame t, frame t + 1 and their derivatives around a pixel, as far as `radius` px.
    pub fn tiles(&self, pictures: [&Grid<f32>; 2], place: (usize, usize), radius: usize) -> Vec<Tile> {
        let around = |grid: &Grid<f32>| around(grid, place, radius);
        let signed = |label, grid: &Grid<f32>| {
            let values = around(grid);
            let most = values.cells().iter().filter(|v| v.is_finite()).fold(1.0f32, |most, v| most.max(v.abs()));
            Tile { label, role: None, values, range: [-most, most] }
        };
        let picture =
            |label, role, grid: &Grid<f32>| Tile { label, role: Some(role), values: around(grid), range: [0.0, 255.0] };
        vec![
            picture("Frame t", Role::Reference, pictures[0]),
            picture("Frame t+1", Role::Candidate, pictures[1]),
            signed("Iₓ", &self.x),
            signed("I_y", &self.y),
            signed("Iₜ", &self.t),
        ]
    }
}

/// The values of `grid` around a place; NaN outside it. Rounded to a tenth, as they are read.
pub fn around<T: Copy + Into<f32>>(grid: &Grid<T>, (x, y): (usize, usize), radius: usize) -> Grid<f32> {
    let side = 2 * radius + 1;
    let inside = |i: usize, k: usize| (i + k).checked_sub(radius);
    Grid::from_fn(side, side, |i, j| {
        let place = inside(x, i).zip(inside(y, j));
        let value = place.and_then(|(x, y)| grid.get(x, y)).map_or(f32::NAN, |value| (*value).into());
        (value * 10.0).round() / 10.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_have_a_true_sign() {
        let told = [0.0, -0.0001, 0.1234, -3.456, 12.34, -255.0].map(number);
        assert_eq!(told, ["0.00", "0.000", "0.123", "−3.46", "12.3", "−255"]);
        assert_eq!((plus(-2.0), plus(0.5)), ("− 2.00".into(), "+ 0.500".into()));
    }

    #[test]
    fn the_plane_holds_its_points() {
        assert_eq!(reach([[0.1, -0.2]]), 1.0);
        assert_eq!(reach([[3.0, 0.0], [f32::NAN, 99.0]]), 128.0);
        assert!(reach([[1e9, 0.0]]).is_finite());
    }
}
