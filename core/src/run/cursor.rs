//! A place in a run, as it is counted and written.
//!
//! It is written `UNIT.EVENT`: `0.0` is the start of a run, and `7.n` with the last event n is the end of unit 7.

use crate::base::Error;

/// A position in a run: the current unit and the number of its events passed.
///
/// The default is the start, before anything was seen. Every other cursor has seen at least one event of its
/// unit; the end of a unit has seen all of them. People count units from 1, so the cursor with `unit` 7 and
/// `event` 3 is written `8.3`, and the start `0`. An
/// `event` beyond the last means the end of the unit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Cursor {
    /// The current unit, from 0.
    pub unit: usize,
    /// Events of that unit that were seen.
    pub event: usize,
}

impl Cursor {
    /// The end of the run, wherever that is; written `end`.
    pub const END: Self = Self { unit: usize::MAX, event: usize::MAX };
}

impl std::fmt::Display for Cursor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self { unit: 0, event: 0 } => f.write_str("0"),
            &Self::END => f.write_str("end"),
            Self { unit, event: usize::MAX } => write!(f, "{}", unit.saturating_add(1)),
            Self { unit, event } => write!(f, "{}.{event}", unit.saturating_add(1)),
        }
    }
}

impl std::str::FromStr for Cursor {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        if text == "end" {
            return Ok(Self::END);
        }
        let parse = |part: &str| part.parse::<usize>().ok();
        let (unit, event) = text.split_once('.').map_or((text, None), |(unit, event)| (unit, Some(event)));
        match (parse(unit), event.map(parse)) {
            (Some(0), None | Some(Some(0))) => Ok(Self::default()),
            (Some(unit @ 1..), None) => Ok(Self { unit: unit - 1, event: usize::MAX }),
            (Some(unit @ 1..), Some(Some(event))) => Ok(Self { unit: unit - 1, event }),
            _ => Err(Error::new(format!(
                "a step is written UNIT.EVENT as in 35.412, UNIT for its end, 0 for the start, or end, not {text}"
            ))),
        }
    }
}
