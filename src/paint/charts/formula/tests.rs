//! Formulas as they are laid out.

use super::*;

/// Every letter is half as wide as its size.
struct Half;

impl Measure for Half {
    fn width(&mut self, text: &str, size_pt: f32, _: Face) -> f32 {
        text.chars().count() as f32 * size_pt / 2.0
    }
}

fn set(math: &Math, max_width: f32) -> Formula {
    lay_out(math, 20.0, max_width, &mut Half)
}

fn baselines(formula: &Formula) -> Vec<f32> {
    let y = |piece: &Piece| match piece {
        Piece::Text { at, .. } => Some(at[1]),
        Piece::Rule(_) | Piece::Stroke(..) => None,
    };
    formula.pieces.iter().filter_map(y).collect()
}

#[test]
fn a_row_stands_on_one_baseline() {
    let row = Math::Row(vec![Math::text("ab"), Math::Abs(Box::new(Math::Var("x"))), Math::text("c")]);
    let row = set(&row, 1000.0);
    assert_eq!(baselines(&row), [0.0; 3]);
    assert!(row.width > 4.0 * 10.0, "the bars take room");
}

#[test]
fn scripts_are_smaller_and_off_the_baseline() {
    let sub = set(&Math::indexed(Math::Var("I"), Math::Var("t")), 100.0);
    let sup = set(&Math::power(Math::Var("x"), Math::text("2")), 100.0);
    assert!(baselines(&sub)[1] > 0.0 && baselines(&sup)[1] < 0.0);
    let small = |f: &Formula| matches!(f.pieces[1], Piece::Text { size_pt, .. } if size_pt < 20.0);
    assert!(small(&sub) && small(&sup));
    assert!(sub.descent > set(&Math::Var("I"), 100.0).descent);
}

#[test]
fn a_fraction_stands_over_and_under_its_bar() {
    let frac = set(&Math::Frac(Box::new(Math::text("812")), Box::new(Math::text("256"))), 100.0);
    let [top, bottom] = baselines(&frac)[..] else { panic!("two texts") };
    let Some(Piece::Rule(bar)) = frac.pieces.last() else { panic!("a bar") };
    assert!(top < bar.min[1] && bottom - CAP * 18.0 > bar.max[1]);
}

#[test]
fn a_long_row_is_broken_and_nothing_is_lost() {
    let parts: Vec<_> = (0..12).map(|i| Math::text(format!("+ {i:02}"))).collect();
    let wide = set(&Math::Row(parts.clone()), 1000.0);
    let narrow = set(&Math::Row(parts), 130.0);
    assert_eq!(wide.pieces.len(), narrow.pieces.len());
    assert!(narrow.width <= 130.0 && narrow.descent > 2.0 * wide.descent);
    let ends = narrow.pieces.iter().map(|p| match p {
        Piece::Text { at, text, size_pt, .. } => at[0] + text.chars().count() as f32 * size_pt / 2.0,
        Piece::Rule(rect) => rect.max[0],
        Piece::Stroke(points, _) => points.iter().map(|at| at[0]).fold(0.0, f32::max),
    });
    assert!(ends.fold(0.0, f32::max) <= 130.0);
}

#[test]
fn an_operator_goes_with_what_follows_it() {
    let row = Math::Row(vec![Math::text("aaaa"), Math::text(" + "), Math::text("bbbb")]);
    let formula = set(&row, 75.0);
    let ys = baselines(&formula);
    assert!(ys[0] < ys[1] && ys[1] == ys[2], "{ys:?}");
}

#[test]
fn what_stands_in_parentheses_is_broken_before_it_shrinks() {
    let text = "L = C + min(a − b, c + d, e)";
    let formula = set(&Math::text(text), 120.0);
    assert!(formula.width <= 120.0, "{}", formula.width);
    let pieces = formula.pieces.iter().map(|piece| match piece {
        Piece::Text { text, size_pt, .. } => (text.clone(), *size_pt),
        Piece::Rule(_) | Piece::Stroke(..) => panic!("words alone"),
    });
    let (words, sizes): (Vec<_>, Vec<_>) = pieces.unzip();
    assert!(words.concat() == text && sizes.iter().all(|size| *size == 20.0), "{words:?}, {sizes:?}");
    let [wide, narrow] = [1000.0, 120.0].map(|width| baselines(&set(&Math::text(text), width)));
    assert!(wide.iter().all(|y| *y == 0.0) && narrow.iter().any(|y| *y > 0.0), "{narrow:?}");
}

#[test]
fn a_term_too_wide_with_its_operators_shrinks() {
    let long = vec![Math::Sum(Box::new(Math::text("x, y"))), Math::Abs(Box::new(Math::text("0123456789")))];
    assert!(set(&Math::Row(long), 120.0).width <= 120.0);
}

#[test]
fn what_cannot_be_broken_shrinks() {
    let long = Math::Abs(Box::new(Math::text("0123456789")));
    assert!(set(&long, 90.0).width <= 90.0);
    assert!(set(&long, 10.0).width > 10.0, "but stays readable");
}

#[test]
fn the_bar_of_a_root_covers_what_is_under_it() {
    let root = set(&Math::root(Math::text("a + b")), 1000.0);
    let Some(Piece::Stroke(points, width)) = root.pieces.last() else { panic!("a sign") };
    let Piece::Text { at, .. } = &root.pieces[0] else { panic!("a text") };
    let [up, end] = [points[3], points[4]];
    assert!(up[1] == end[1] && up[0] <= at[0] && end[0] >= at[0] + 50.0, "{points:?}");
    assert!(end[1] < -CAP * 20.0 && root.ascent >= width / 2.0 - end[1] && root.width >= end[0]);
    // A fraction makes it higher.
    let tall = set(&Math::root(Math::over(Math::text("a"), Math::text("b"))), 1000.0);
    assert!(tall.ascent > root.ascent && tall.descent > root.descent);
}

#[test]
fn a_mean_has_its_bar_above_the_letter_and_the_index_beside_it() {
    let mean = set(&Math::mean(Math::indexed(Math::Var("u"), Math::text("0"))), 1000.0);
    let bars: Vec<_> = mean.pieces.iter().filter_map(|p| if let Piece::Rule(r) = p { Some(r) } else { None }).collect();
    assert!(bars.len() == 1 && bars[0].max[1] < -0.5 * 20.0 && bars[0].max[0] < 12.0, "{bars:?}");
    let capital = set(&Math::mean(Math::Var("I")), 1000.0);
    assert!(capital.ascent > mean.ascent, "the bar is above the capital as well");
    assert_eq!(mean.symbols[0].1, "u\u{304}_0");
}

#[test]
fn a_matrix_has_rows_and_columns_in_brackets() {
    let cell = |words: &str| Math::text(words);
    let matrix = Math::Matrix(vec![vec![cell("1"), cell("−10")], vec![cell("100"), cell("2")]]);
    let formula = set(&matrix, 1000.0);
    let ys = baselines(&formula);
    assert!(ys[0] == ys[1] && ys[2] == ys[3] && ys[0] < -0.2 * 20.0 && ys[2] > 0.0, "{ys:?}");
    let right = |i: usize| match &formula.pieces[i] {
        Piece::Text { at, text, .. } => at[0] + 10.0 * text.chars().count() as f32,
        _ => panic!("an entry"),
    };
    assert!(right(0) == right(2) && right(1) == right(3) && right(0) < right(1) - 30.0);
    let rules: Vec<_> =
        formula.pieces.iter().filter_map(|p| if let Piece::Rule(r) = p { Some(r) } else { None }).collect();
    assert_eq!(rules.len(), 6, "two brackets of three sides");
    assert!(rules.iter().all(|rule| rule.min[0] >= 0.0 && rule.max[0] <= formula.width));
    // It stands on the axis of its line.
    let middle = (formula.descent - formula.ascent) / 2.0;
    assert!((middle + AXIS * 20.0).abs() < 0.5, "{middle}");
}

#[test]
fn no_line_ends_inside_parentheses() {
    let text = |words: &str| Math::text(words);
    let row = Math::Row(vec![
        Math::Var("x"),
        text(" = "),
        text("2 ("),
        Math::Var("a"),
        text(" + "),
        Math::Var("b"),
        text(")"),
        text(" + "),
        Math::Row(vec![text("("), Math::Var("c"), text(" − "), Math::Var("d"), text(")")]),
    ]);
    let formula = set(&row, 130.0);
    let ys = baselines(&formula);
    assert_eq!(ys[..7], [0.0; 7], "{ys:?}");
    assert!(ys[7] > 0.0 && ys[7..].iter().all(|y| *y == ys[7]), "{ys:?}");
    // Factors that stand side by side are not parted either.
    let product = Math::Row(vec![Math::Var("a"), text(" "), Math::Var("b"), text(" "), Math::Var("c")]);
    assert!(baselines(&set(&product, 40.0)).iter().all(|y| *y == 0.0));
}

#[test]
fn numbers_of_a_chain_of_equations_stay_with_their_equals_sign() {
    let text = |words: &str| Math::text(words);
    let row = Math::Row(vec![
        Math::Var("u"),
        text(" = "),
        text("old"),
        text(" + "),
        text("step"),
        text(" = "),
        text("0.4"),
        text(" + "),
        text("1.9"),
        text(" = "),
        text("2.3"),
    ]);
    let ys = baselines(&set(&row, 230.0));
    assert_eq!(ys[..5], [0.0; 5], "{ys:?}");
    assert!(ys[5] > 0.0 && ys[5..].iter().all(|y| *y == ys[5]), "{ys:?}");
    // One equation alone does not leave its left side by itself.
    let sum = Math::Row(vec![Math::Var("u"), text(" = "), text("0123456"), text(" + "), text("0123456")]);
    assert_eq!(baselines(&set(&sum, 120.0))[..3], [0.0; 3]);
}

#[test]
fn what_is_too_wide_even_when_small_is_broken_in_parentheses() {
    let parts = (0..9).map(|i| Math::text(format!("+ {i:02}")));
    let row: Vec<_> = [Math::text("(")].into_iter().chain(parts).chain([Math::text(")")]).collect();
    assert!(set(&Math::Row(row), 130.0).width <= 130.0);
}

#[test]
fn what_is_left_out_is_a_box_with_room_to_write() {
    let row = |last: String| Math::Row(vec![Math::text("7 − 2 = "), Math::text(last)]);
    let (number, left_out) = (set(&row("812.50".into()), 1000.0), set(&row(blank("812.50")), 1000.0));
    assert!(left_out.width > number.width && left_out.ascent > number.ascent);
    let Some(Piece::Stroke(corners, _)) = left_out.pieces.last() else { panic!("a box") };
    assert!(corners.first() == corners.last() && corners[1][0] <= left_out.width);
}

#[test]
fn a_letter_with_a_minus_sign_is_a_symbol_of_its_own() {
    let names = |exponent: &str| {
        let formula = set(&Math::power(Math::Bold("P"), Math::text(exponent)), 1000.0);
        formula.symbols.into_iter().map(|(_, name)| name).collect::<Vec<_>>()
    };
    assert_eq!((names("−"), names("2")), (vec!["P⁻".to_owned(), "P".to_owned()], vec!["P".to_owned()]));
}

#[test]
fn symbols_tell_where_they_stand() {
    let formula = set(&Math::Row(vec![Math::indexed(Math::Var("I"), Math::Var("x")), Math::Bold("T")]), 1000.0);
    let names: Vec<_> = formula.symbols.iter().map(|(_, name)| name.as_str()).collect();
    assert_eq!(names, ["I_x", "I", "x", "T"]);
    assert!(formula.symbols[3].0.min[0] >= formula.symbols[0].0.max[0] - 0.1);
}

#[test]
fn a_sum_without_a_range_is_no_higher_than_its_line() {
    let height = |index: &str| typeset(&Math::Sum(Box::new(Math::text(index))), 20.0, 400.0).size()[1];
    assert_eq!(height(""), typeset(&Math::text("Σ"), 20.0, 400.0).size()[1]);
    assert!(height("i") > 1.5 * height(""), "{}", height("i"));
}
