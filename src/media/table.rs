//! Lines of tables that other programs wrote: their separators, decimal commas and headers.

/// The lines of a table with their numbers, counted from 1, without a header and empty lines.
pub(crate) fn rows(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let lines = text.lines().enumerate().map(|(i, line)| (i + 1, line));
    let mut filled = lines.filter(|(_, line)| !line.trim().is_empty()).peekable();
    filled.next_if(|(_, line)| is_header(line));
    filled
}

/// The cells of a line. Semicolons or tabs separate them if there are any, since numbers may then have decimal commas; else commas;
/// else blanks.
pub(crate) fn cells(line: &str) -> Vec<&str> {
    let line = line.trim();
    match [';', '\t', ','].into_iter().find(|separator| line.contains(*separator)) {
        Some(separator) => line.trim_end_matches(separator).split(separator).map(str::trim).collect(),
        None => line.split_whitespace().collect(),
    }
}

/// The number in a cell, NaN included, with a decimal point or comma.
///
/// # Errors
/// A clause that quotes the cell if it is no number.
pub(crate) fn number(cell: &str) -> Result<f64, String> {
    cell.replacen(',', ".", 1).parse().map_err(|_| format!("“{cell}” is not a number"))
}

/// A table has at least left, top, width and height.
const LEAST_COLUMNS: usize = 4;

/// Whether a line names columns: words alone.
pub(crate) fn is_header(line: &str) -> bool {
    cells(line).len() >= LEAST_COLUMNS
        && cells(line).iter().all(|cell| number(cell).is_err() && cell.contains(char::is_alphabetic))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn separators_and_decimal_commas_are_recognized() {
        for line in ["1;2,5;-3", "1\t2,5\t-3", "1,2.5,-3", " 1  2.5 -3", "1; 2,5; -3;"] {
            let numbers: Result<Vec<f64>, _> = cells(line).into_iter().map(number).collect();
            assert_eq!(numbers, Ok(vec![1.0, 2.5, -3.0]), "{line}");
        }
        assert!(number("x").is_err() && number("").is_err() && number("NaN").is_ok_and(f64::is_nan));
    }

    #[test]
    fn a_header_is_no_row_and_lines_keep_their_numbers() {
        let table = "frame,id,left,top\n\n1,2,3\n";
        assert_eq!(rows(table).collect::<Vec<_>>(), [(3, "1,2,3")]);
        assert_eq!(rows("1,x,3,4\n").count(), 1, "a damaged row is not taken for a header");
        assert_eq!(rows("a;b;c;d\ne;f;g;h\n").collect::<Vec<_>>(), [(2, "e;f;g;h")], "one header at most");
    }
}
