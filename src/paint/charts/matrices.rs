//! Matrices with the numbers of a step, side by side; what the step has changed is lit.

use motionscope_core::base::words::fixed;
use motionscope_core::geometry::Grid;
use motionscope_core::scene::{Math, Matrix};

use super::super::number::with_power;
use super::super::primitive::{Anchor, Point, Rect, Run};
use super::super::wrap::wrap;
use super::super::{Color, Face, Theme};
use super::canvas::{Canvas, Level, Type, middle, solid};
use super::{ChartStyle, Drawing};

/// Between two matrices, in letters.
const GAP_LETTERS: [f32; 2] = [1.6, 0.8];
/// Least width of a column, in letters, and what lies between one and what stands in the next.
const COLUMN_LETTERS: f32 = 2.4;
const COLUMN_GAP_LETTERS: f32 = 1.1;
/// Height of a row, in letters.
const ROW_LETTERS: f32 = 1.45;
/// The same where entries are left out.
const BLANK_LETTERS: f32 = 2.3;
/// Height of a line with the name and of what lies below the last one, in letters.
const NAME_LETTERS: f32 = 1.3;
const HEAD_LETTERS: f32 = 0.6;
/// Least width of a name before it is broken into lines, in letters.
const LEAST_NAME_LETTERS: f32 = 12.0;

/// Sizes of the type that are tried, as shares of the usual one, until all matrices fit. The largest is little larger than the
/// usual one, so that the size hardly changes from step to step.
const TYPE_SHARES: [f32; 11] = [1.2, 1.1, 1.0, 0.95, 0.9, 0.85, 0.8, 0.75, 0.7, 0.65, 0.6];
/// The last of them.
const SMALLEST: f32 = TYPE_SHARES[TYPE_SHARES.len() - 1];
/// The least size in points in which a class reads numbers; the usual type of a desk is smaller anyway.
const READ_PT: f32 = 18.0;
/// Room for the bar of an area that is scrolled, in points.
const BAR_PT: f32 = 14.0;
/// Those that are tried first in a large area, as that of a chart that takes the place of the stage.
const LARGE_SHARES: [f32; 3] = [1.8, 1.6, 1.4];
/// How many times larger the type has to be for the matrices to leave their order.
const WORTH: f32 = 1.2;
/// The most matrices that may leave it.
const MOST_EXCHANGED: usize = 3;
/// What makes another symbol of the one before it.
const MARKS: [char; 4] = ['′', '⁻', '⁺', '*'];
/// Width of a large area, in letters.
const LARGE_LETTERS: f32 = 40.0;

/// Lays all matrices out from the upper left corner of `area` on, as many beside each other as it is wide, in the largest type
/// in which they fit; returns where each lies. They may need more room than there is: [`Drawing::place`] tells how much.
pub fn draw(matrices: &[Matrix], area: Rect, style: ChartStyle) -> Drawing<Vec<Rect>> {
    let smallest = || (SMALLEST, (0..matrices.len()).collect::<Vec<usize>>());
    let (share, order) = fitting(matrices, area.size(), style, SMALLEST).unwrap_or_else(smallest);
    draw_at(matrices, (&order, area), style, share)
}

/// As [`draw`], for an area that is scrolled: where only smaller type than can be read from the last row has room for all
/// matrices, those that the step changes come first and then those that its `formula` names, in type of that size.
pub fn draw_to_scroll((matrices, formula): (&[Matrix], &[Math]), area: Rect, style: ChartStyle) -> Drawing<Vec<Rect>> {
    let least = (READ_PT / style.theme.sizes().small).min(1.0);
    if let Some((share, order)) = fitting(matrices, area.size(), style, least) {
        return draw_at(matrices, (&order, area), style, share);
    }
    let area = Rect { max: [area.max[0] - BAR_PT, area.max[1]], ..area };
    let width = |matrix: &Matrix, share: f32| {
        Place::of(matrix, Letters { theme: style.theme, share, has_blanks: false }).size[0]
    };
    let is_wide_enough = |share: f32| matrices.iter().all(|matrix| width(matrix, share) <= area.size()[0]);
    let read = TYPE_SHARES.into_iter().rfind(|share| *share >= least).unwrap_or(1.0);
    let share = TYPE_SHARES.into_iter().find(|share| *share <= read && is_wide_enough(*share)).unwrap_or(SMALLEST);
    draw_at(matrices, (&by_weight(matrices, formula), area), style, share)
}

/// The order in which matrices are read: those that the step changes, then those that its `formula` names, as it names them.
fn by_weight(matrices: &[Matrix], formula: &[Math]) -> Vec<usize> {
    let read: Vec<String> = formula.iter().flat_map(symbols).collect();
    let weight = |index: &usize| {
        let matrix = &matrices[*index];
        let is_changed = matrix.changed.as_ref().is_some_and(|changed| changed.cells().contains(&true));
        let symbol = words(matrix.symbol);
        let named = read.windows(symbol.len().max(1)).position(|part| part == symbol).unwrap_or(usize::MAX);
        (!is_changed, if is_changed { 0 } else { named })
    };
    let mut order: Vec<usize> = (0..matrices.len()).collect();
    order.sort_by_key(weight);
    order
}

/// The symbols of a formula as they are read; a word in it is one of its own, whatever letters it has.
fn symbols(math: &Math) -> Vec<String> {
    if let Some(name) = math.prediction() {
        return words(&name);
    }
    match math {
        Math::Text(text, _) => words(text),
        Math::Value(value, style) => words(&style.text(value)),
        Math::Var(name) | Math::Bold(name) => words(name),
        Math::Row(parts) => parts.iter().flat_map(symbols).collect(),
        Math::Sub(first, second) | Math::Sup(first, second) | Math::Frac(first, second) => {
            [symbols(first), symbols(second)].concat()
        }
        Math::Sum(inner) | Math::Abs(inner) | Math::Sqrt(inner) | Math::Bar(inner) | Math::Hat(inner) => symbols(inner),
        Math::Matrix(rows) => rows.iter().flatten().flat_map(symbols).collect(),
    }
}

/// The words of a text with their marks, and each other sign by itself.
fn words(text: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut goes_on = false;
    for letter in text.chars() {
        let is_part = goes_on && (letter.is_alphanumeric() || MARKS.contains(&letter));
        match words.last_mut() {
            Some(word) if is_part => word.push(letter),
            _ if letter.is_whitespace() => {}
            _ => words.push(letter.to_string()),
        }
        goes_on = is_part || letter.is_alphanumeric();
    }
    words
}

/// The largest share of the usual type, `least` or more of it, and an order in which all matrices have room in `size`; `None` where
/// there are none.
fn fitting(matrices: &[Matrix], size: [f32; 2], style: ChartStyle, least: f32) -> Option<(f32, Vec<usize>)> {
    let given: Vec<usize> = (0..matrices.len()).collect();
    let fits = |share: f32, order: &[usize]| {
        let needed = extent(&draw_at(matrices, (order, Rect::new([0.0; 2], size)), style, share).place);
        needed[0] <= size[0] && needed[1] <= size[1]
    };
    let is_large = size[0] > LARGE_LETTERS * style.theme.sizes().body;
    let shares = || LARGE_SHARES.into_iter().filter(|_| is_large).chain(TYPE_SHARES).filter(|share| *share >= least);
    let share = shares().find(|share| fits(*share, &given));
    // Each order is laid out in each size, while the window waits.
    let is_worth_it = |larger: &f32| given.len() <= MOST_EXCHANGED && *larger >= WORTH * share.unwrap_or(SMALLEST);
    let mut other = shares().filter(is_worth_it).flat_map(|larger| exchanged(&given).map(move |order| (larger, order)));
    let found = other.find(|(larger, order)| fits(*larger, order));
    found.or_else(|| share.map(|share| (share, given.clone())))
}

/// Lays all matrices out in the usual type for a worksheet: an entry that is NaN is a box to write in.
pub fn draw_with_blanks(matrices: &[Matrix], area: Rect, style: ChartStyle) -> Drawing<Vec<Rect>> {
    let given: Vec<usize> = (0..matrices.len()).collect();
    drawn(matrices, (&given, area), Letters { theme: style.theme, share: 1.0, has_blanks: true })
}

/// The orders in which two of `given` have changed places: a wide one between two narrow ones keeps these from standing beside each
/// other.
fn exchanged(given: &[usize]) -> impl Iterator<Item = Vec<usize>> {
    let pairs = (0..given.len()).flat_map(|i| (i + 1..given.len()).map(move |j| (i, j)));
    pairs.map(|(i, j)| {
        let mut order = given.to_vec();
        order.swap(i, j);
        order
    })
}

/// Draws the matrices in an `order`; the places are those of the matrices as given.
fn draw_at(matrices: &[Matrix], (order, area): (&[usize], Rect), style: ChartStyle, share: f32) -> Drawing<Vec<Rect>> {
    drawn(matrices, (order, area), Letters { theme: style.theme, share, has_blanks: false })
}

/// Draws the matrices in an `order` with these letters.
fn drawn(matrices: &[Matrix], (order, area): (&[usize], Rect), letters: Letters) -> Drawing<Vec<Rect>> {
    let gaps = GAP_LETTERS.map(|gap| gap * letters.text().size);
    let mut canvas = Canvas::default();
    let (mut at, mut below) = (area.min, area.min[1]);
    let mut places = vec![Rect::new(area.min, [0.0; 2]); matrices.len()];
    for index in order {
        let matrix = &matrices[*index];
        let place = Place::of(matrix, letters);
        if at[0] > area.min[0] && at[0] + place.size[0] > area.max[0] {
            at = [area.min[0], below + gaps[1]];
        }
        let rect = Rect::new(at, place.size);
        one(&mut canvas, matrix, &place, at, letters);
        at[0] = rect.max[0] + gaps[0];
        below = below.max(rect.max[1]);
        places[*index] = rect;
    }
    Drawing { place: places, body: canvas.into_layers(), head: Vec::new() }
}

/// Width and height that matrices need in the usual type where they may be `width` points wide.
pub fn size(matrices: &[Matrix], width: f32, style: ChartStyle) -> [f32; 2] {
    let given: Vec<usize> = (0..matrices.len()).collect();
    extent(&draw_at(matrices, (&given, Rect::new([0.0; 2], [width, 0.0])), style, 1.0).place)
}

/// The type of matrices.
#[derive(Clone, Copy)]
struct Letters {
    theme: Theme,
    /// Its size as a share of the usual one.
    share: f32,
    /// Whether an entry that is NaN is a box to write in.
    has_blanks: bool,
}

impl Letters {
    /// Whether an entry is a box.
    fn is_blank(self, value: f64) -> bool {
        self.has_blanks && value.is_nan()
    }

    fn scaled(self, of: Type) -> Type {
        Type { size: of.size * self.share, ..of }
    }

    fn text(self) -> Type {
        self.scaled(Type::text(self.theme))
    }

    fn dim(self) -> Type {
        self.scaled(Type::dim(self.theme))
    }

    fn symbol(self) -> Type {
        let (size, color) = (self.theme.sizes().body, self.theme.chrome().text);
        self.scaled(Type { face: Face::Italic, size, color })
    }
}

/// Entries below this are written with a power of ten: four decimals would leave less than two of their digits.
const SMALL: f64 = 1e-3;
/// A share of the largest entry that is nothing but the rounding of many operations.
const ROUNDING: f64 = 1e-13;

/// The least decimals of a gain: it has no unit, and 0.996 is not 1.
const GAIN_DECIMALS: usize = 3;

/// The entries of a matrix as text, with the decimals of its quantity; where it has none, all with as many as suit the smallest,
/// and small ones with a power of ten, so that no entry loses its digits. What is nothing is 0.
pub fn entries(matrix: &Matrix) -> Grid<String> {
    let sizes = || matrix.entries.cells().iter().map(|value| value.abs());
    let rounding = ROUNDING * sizes().filter(|size| size.is_finite()).fold(0.0, f64::max);
    if let Some(decimals) = matrix.decimals {
        let is_nothing = |value: &f64| value.abs() <= rounding;
        return matrix.entries.map(|v| if is_nothing(v) { NOTHING.to_owned() } else { fixed(*v, decimals) });
    }
    let smallest = sizes().filter(|size| *size > rounding).fold(f64::INFINITY, f64::min);
    let decimals = match smallest {
        _ if smallest >= 100.0 => 1,
        _ if smallest >= 0.1 => 2,
        _ if smallest >= 0.01 => 3,
        _ => 4,
    };
    let decimals = if matrix.name.ends_with("gain") { decimals.max(GAIN_DECIMALS) } else { decimals };
    matrix.entries.map(|value| match value.abs() {
        size if size <= rounding => NOTHING.to_owned(),
        size if size < SMALL => with_power(*value),
        _ => fixed(*value, decimals),
    })
}

/// Room for an entry that is left out.
const LEFT_OUT: &str = "−00000.00";

/// As [`entries`], with `left_out` instead of those that are NaN.
fn entries_with(matrix: &Matrix, left_out: Option<&str>) -> Grid<String> {
    let all = entries(matrix);
    Grid::from_fn(all.width(), all.height(), |x, y| match left_out {
        Some(left_out) if matrix.entries[(x, y)].is_nan() => left_out.to_owned(),
        _ => all[(x, y)].clone(),
    })
}

/// What stands in place of an entry that is nothing.
const NOTHING: &str = "0";

fn extent(places: &[Rect]) -> [f32; 2] {
    places.iter().fold([0.0; 2], |size, rect| [size[0].max(rect.max[0]), size[1].max(rect.max[1])])
}

/// Where the parts of a matrix lie within its own rectangle.
struct Place {
    /// The lines of its name, and the height of all of them.
    name: Vec<String>,
    head: f32,
    /// Room for the names of the columns and rows; none where there are no names.
    columns: f32,
    rows: f32,
    /// Width of each column, and height of a row.
    widths: Vec<f32>,
    row: f32,
    /// Size of all of it.
    size: [f32; 2],
}

impl Place {
    fn of(matrix: &Matrix, letters: Letters) -> Self {
        let text = letters.text();
        let small = text.size;
        let (width, height) = matrix.entries.size();
        let widest = |words: &mut dyn Iterator<Item = String>| words.map(|word| text.width(&word)).fold(0.0, f32::max);
        let words = entries_with(matrix, letters.has_blanks.then_some(LEFT_OUT));
        let of_column = |x: usize| {
            let entries = (0..height).map(|y| words[(x, y)].clone());
            let column = widest(&mut entries.chain(matrix.columns.get(x).cloned()));
            (column + COLUMN_GAP_LETTERS * small).max(COLUMN_LETTERS * small)
        };
        let widths: Vec<f32> = (0..width).map(of_column).collect();
        let rows = widest(&mut matrix.rows.iter().cloned());
        let columns = if matrix.columns.is_empty() { 0.0 } else { ROW_LETTERS * small };
        let rows = if matrix.rows.is_empty() { 0.0 } else { (rows + small).max(2.2 * small) };
        let has_blanks = matrix.entries.cells().iter().any(|value| letters.is_blank(*value));
        let row = if has_blanks { BLANK_LETTERS } else { ROW_LETTERS } * small;
        let body = [rows + widths.iter().sum::<f32>(), columns + row * height as f32];
        // A long name must not make a narrow matrix wide: what is beside it would have to be smaller.
        let symbol = letters.symbol().width(matrix.symbol) + 0.5 * small;
        let room = (body[0] - symbol).max(LEAST_NAME_LETTERS * small);
        let plain = |line: Vec<Run>| line.into_iter().map(|run| run.text).collect::<String>();
        let lines = wrap(&[Run::new(matrix.name, text.color)], small, room);
        let name: Vec<String> = lines.into_iter().map(plain).collect();
        let head = (NAME_LETTERS * name.len() as f32 + HEAD_LETTERS) * small;
        let width = body[0].max(symbol + widest(&mut name.iter().cloned()) + 2.0);
        Self { name, head, columns, rows, widths, row, size: [width.ceil(), (head + body[1]).ceil()] }
    }
}

fn one(canvas: &mut Canvas, matrix: &Matrix, place: &Place, min: Point, letters: Letters) {
    let theme = letters.theme;
    let (chrome, text, dim) = (theme.chrome(), letters.text(), letters.dim());
    let small = text.size;
    let color = matrix.role.map_or(chrome.text, |role| theme.word(role));
    let y = min[1] + 0.9 * small;
    let (start, end) = ((Anchor::Start, Level::Middle), (Anchor::End, Level::Middle));
    let name = canvas.text([min[0], y], start, matrix.symbol, letters.symbol().color(color)).max[0];
    for (index, line) in place.name.iter().enumerate() {
        canvas.text([name + 0.5 * small, y + NAME_LETTERS * small * index as f32], start, line, dim);
    }
    let (width, height) = matrix.entries.size();
    if width == 0 || height == 0 {
        return;
    }
    let origin = [min[0] + place.rows, min[1] + place.head + place.columns];
    let cell = |x: usize, y: usize| {
        let left = origin[0] + place.widths[..x].iter().sum::<f32>();
        Rect::new([left, origin[1] + y as f32 * place.row], [place.widths[x], place.row])
    };
    let words = entries_with(matrix, letters.has_blanks.then_some(""));
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let rect = cell(x, y);
        if matrix.changed.as_ref().is_some_and(|changed| changed[(x, y)]) {
            canvas.fill(rect.grown(-1.0), chrome.selection);
        }
        if letters.is_blank(matrix.entries[(x, y)]) {
            canvas.frame(rect.grown(-2.5), 1.0, chrome.text);
        }
        // What is nothing steps back, so that the shape of a matrix can be seen.
        let style = if words[(x, y)] == NOTHING { dim } else { text };
        let at = [rect.max[0] - 0.4 * small, middle(&rect)[1]];
        canvas.text(at, end, &words[(x, y)], style);
    }
    for (x, name) in matrix.columns.iter().enumerate() {
        let Rect { min: [_, top], max: [right, _] } = cell(x, 0);
        canvas.text([right - 0.4 * small, top - 0.3 * small], (Anchor::End, Level::Bottom), name, dim);
    }
    for (y, name) in matrix.rows.iter().enumerate() {
        let rect = cell(0, y);
        canvas.text([rect.min[0] - 0.6 * small, middle(&rect)[1]], end, name, dim);
    }
    brackets(canvas, Rect { min: origin, max: cell(width - 1, height - 1).max }, chrome.dim);
}

fn brackets(canvas: &mut Canvas, Rect { min: [left, top], max: [right, bottom] }: Rect, color: Color) {
    for (x, inwards) in [(left, 4.0), (right, -4.0)] {
        let points = vec![[x + inwards, top], [x, top], [x, bottom], [x + inwards, bottom]];
        canvas.line(points, false, solid(1.0, color));
    }
}

/// The matrix in words, for a screen reader.
pub fn plain(matrix: &Matrix) -> String {
    told(matrix, &entries(matrix))
}

/// The matrix of a worksheet in words: an entry that is NaN is a box.
pub fn plain_with_blanks(matrix: &Matrix) -> String {
    told(matrix, &entries_with(matrix, Some("□")))
}

fn told(matrix: &Matrix, words: &Grid<String>) -> String {
    let (width, height) = words.size();
    let row = |y| (0..width).map(|x| words[(x, y)].clone()).collect::<Vec<_>>().join(", ");
    let rows: Vec<_> = (0..height).map(row).collect();
    format!("{}, {}: {}", matrix.symbol, matrix.name, rows.join("; "))
}

#[cfg(test)]
mod tests {
    use ab_glyph::Font;

    use super::super::super::{ColorMap, Primitive};
    use super::super::{flat, texts};
    use super::*;

    fn matrix() -> Matrix {
        Matrix {
            symbol: "P",
            name: "covariance of the state",
            role: None,
            entries: Grid::from_fn(2, 2, |x, y| [4.5, 0.0, -0.25, 812.0][2 * y + x]),
            rows: vec!["x".into(), "v".into()],
            columns: Vec::new(),
            changed: Some(Grid::from_fn(2, 2, |x, y| (x, y) == (1, 1))),
            decimals: None,
        }
    }

    fn style() -> ChartStyle {
        ChartStyle { theme: Theme::Dark, colors: ColorMap::Viridis, density: 1.0 }
    }

    #[test]
    fn every_entry_stands_there_and_the_changed_one_is_lit() {
        let drawing = draw(&[matrix()], Rect::new([0.0; 2], [500.0, 200.0]), style());
        let primitives = flat(drawing);
        let words = texts(&primitives);
        for label in ["P", "covariance of the state", "4.50", "0", "−0.25", "812.00", "x", "v"] {
            assert!(words.iter().any(|word| word == label), "{label} is missing in {words:?}");
        }
        let lit = primitives.iter().filter(|p| matches!(p, Primitive::Polygon { .. })).count();
        assert_eq!(lit, 1);
    }

    #[test]
    fn no_entry_loses_its_digits() {
        let of = |values: [f64; 4]| {
            let entries = Grid::from_fn(2, 2, |x, y| values[2 * y + x]);
            super::entries(&Matrix { entries, changed: None, ..matrix() }).cells().to_vec()
        };
        assert_eq!(of([0.7582, 225.5361, 0.000_283, 1.0]), ["0.7582", "225.5361", "2.8·10⁻⁴", "1.0000"]);
        assert_eq!(of([-2.44e-7, 9.96e-4, -0.001, 0.0]), ["−2.4·10⁻⁷", "1.0·10⁻³", "−0.0010", "0"]);
        assert_eq!(of([1.5e-12, 1e-17, -0.0, 2.5]), ["1.5·10⁻¹²", "0", "0", "2.5000"], "1e-17 is rounding");
        let font = Face::Sans.font().expect("a font");
        assert!("⁰¹²³⁴⁵⁶⁷⁸⁹⁻·".chars().all(|letter| font.glyph_id(letter).0 != 0), "exponents have no letters");
    }

    #[test]
    fn the_decimals_of_a_quantity_are_kept_whatever_its_entries() {
        let of = |values: [f64; 4]| {
            let entries = Grid::from_fn(2, 2, |x, y| values[2 * y + x]);
            super::entries(&Matrix { entries, ..matrix().with_decimals(2) }).cells().to_vec()
        };
        assert_eq!(of([16_664.898_1, 7.0e-5, 0.0, -0.05]), ["16\u{202f}664.90", "0.00", "0", "−0.05"]);
        assert_eq!(of([155.758, f64::INFINITY, 0.304, 2.0]), ["155.76", "∞", "0.30", "2.00"]);
    }

    #[test]
    fn what_is_undefined_is_a_box_on_a_worksheet_alone() {
        let all = [Matrix { entries: Grid::from_fn(2, 1, |x, _| [f64::NAN, 2.5][x]), changed: None, ..matrix() }];
        let area = Rect::new([0.0; 2], [500.0, 200.0]);
        let of = |drawing| {
            let primitives = flat(drawing);
            let boxes = primitives.iter().filter(|p| matches!(p, Primitive::Polyline { closed: true, .. })).count();
            (boxes, texts(&primitives).iter().any(|word| word == "undefined"))
        };
        assert_eq!(of(draw(&all, area, style())), (0, true));
        assert_eq!(of(draw_with_blanks(&all, area, style())), (1, false));
        assert!(plain(&all[0]).ends_with("undefined, 2.50") && plain_with_blanks(&all[0]).ends_with("□, 2.50"));
    }

    #[test]
    fn six_states_are_seen_whole_beside_the_stage_of_a_lecture() {
        let names = || ["x", "y", "u", "v", "a_x", "a_y"].map(String::from).to_vec();
        let square = |entry: f64, decimals| Matrix {
            symbol: "P",
            entries: Grid::from_fn(6, 6, |x, y| if x % 2 == y % 2 { entry } else { 0.0 }),
            rows: names(),
            columns: names(),
            changed: None,
            decimals,
            ..matrix()
        };
        let state =
            Matrix { name: "state", entries: Grid::new(1, 6, 330.64), columns: Vec::new(), ..square(0.0, Some(2)) };
        let all = [state, square(37.8, None), square(1.0, Some(1)), square(2.25, None)];
        let room = Rect::new([0.0; 2], [530.0, 400.0]);
        let style = ChartStyle { theme: Theme::Projector, ..style() };
        let extent = extent(&draw(&all, room, style).place);
        assert!(extent[0] <= 530.0 && extent[1] <= 400.0, "{extent:?}");
    }

    #[test]
    fn a_long_name_is_broken_into_lines_of_the_width_of_its_matrix() {
        let name = "squared Mahalanobis distance in the gate: tracks (rows), detections (columns)";
        let wide = Matrix { name, entries: Grid::new(3, 3, 4096.5), changed: None, ..matrix() };
        let [width, height] = size(&[wide], 2000.0, style());
        let [usual, low] =
            size(&[Matrix { entries: Grid::new(3, 3, 4096.5), changed: None, ..matrix() }], 2000.0, style());
        assert!(width < 1.2 * usual && height > low, "{width}×{height} and {usual}×{low}");
    }

    #[test]
    fn little_room_makes_the_type_smaller_before_anything_is_out_of_sight() {
        let all = [matrix(), matrix(), matrix()];
        let [width, height] = size(&all, 200.0, style());
        let small = Rect::new([0.0; 2], [width, 0.75 * height]);
        let extent = extent(&draw(&all, small, style()).place);
        assert!(extent[1] <= small.size()[1] && extent[0] <= small.size()[0], "{extent:?} in {small:?}");
    }

    #[test]
    fn what_is_scrolled_can_be_read_and_begins_with_what_the_step_is_about() {
        let named = |symbol: &'static str| Matrix { symbol, changed: Some(Grid::new(2, 2, symbol == "x")), ..matrix() };
        let all = ["R", "K", "x", "S"].map(named);
        let formula = [Math::Row(vec![Math::Bold("K"), Math::text(" = "), Math::Bold("S")])];
        let style = ChartStyle { theme: Theme::Projector, ..style() };
        let drawing = draw_to_scroll((&all, &formula), Rect::new([0.0; 2], [300.0, 160.0]), style);
        let mut order = [0, 1, 2, 3];
        order.sort_by(|a, b| drawing.place[*a].min[1].total_cmp(&drawing.place[*b].min[1]));
        assert_eq!(order.map(|index| all[index].symbol), ["x", "K", "S", "R"], "each on a line of its own");
        assert!(drawing.place.iter().all(|place| place.max[0] <= 300.0 - BAR_PT), "{:?}", drawing.place);
        let sizes = flat(drawing).into_iter().filter_map(|primitive| match primitive {
            Primitive::Text(line) => Some(line.size),
            _ => None,
        });
        let least = sizes.fold(f32::INFINITY, f32::min);
        assert!(least >= READ_PT, "{least}");
        let large = Rect::new([0.0; 2], [900.0, 500.0]);
        assert_eq!(draw_to_scroll((&all, &formula), large, style).place, draw(&all, large, style).place);
    }

    #[test]
    fn letters_inside_a_word_name_no_matrix() {
        let named = |symbol: &'static str| Matrix { symbol, changed: None, ..matrix() };
        let all = ["D", "S", "P", "P⁻", "P(θ)", "K"].map(named);
        let order = |parts: Vec<Math>| -> Vec<&str> {
            by_weight(&all, &[Math::Row(parts)]).into_iter().map(|index| all[index].symbol).collect()
        };
        let words = vec![Math::text("SAD = "), Math::Bold("K"), Math::Bold("S")];
        assert_eq!(order(words), ["K", "S", "D", "P", "P⁻", "P(θ)"]);
        let marks = vec![Math::squared(Math::Bold("P⁻")), Math::text(" = 2PSR, "), Math::Bold("S"), Math::Bold("P")];
        assert_eq!(order(marks), ["P⁻", "S", "P", "D", "P(θ)", "K"]);
        let ratio = Math::over(Math::text("D"), Math::Bold("K"));
        let signs = vec![Math::Var("P"), Math::text("("), Math::Var("θ"), Math::text(") = "), ratio];
        assert_eq!(order(signs), ["P", "P(θ)", "D", "K", "S", "P⁻"]);
    }

    #[test]
    fn matrices_go_on_below_where_there_is_no_room_beside() {
        let all = [matrix(), matrix(), matrix()];
        let [wide, low] = size(&all, 2000.0, style());
        let [narrow, high] = size(&all, 200.0, style());
        assert!(wide > 2.5 * narrow && high > 2.5 * low, "{wide}×{low} and {narrow}×{high}");
        assert_eq!(plain(&all[0]), "P, covariance of the state: 4.50, 0; −0.25, 812.00");
    }
}
