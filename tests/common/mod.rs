//! Damage as files meet it, made by chance that is the same on every computer.
#![allow(dead_code, reason = "not every test needs all of it")]

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// No single file may keep a reader busy for longer, whatever it holds and however busy the computer is.
const LONGEST: Duration = Duration::from_secs(20);

/// A source of chance: SplitMix64 (Steele, Lea and Flood, 2014).
pub struct Random(u64);

impl Random {
    /// The one of number `seed`.
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x5851_F42D_4C95_7F2D)
    }

    /// Any number.
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ self.0 >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ mixed >> 31
    }

    /// A number below `end`, or 0.
    pub fn below(&mut self, end: usize) -> usize {
        (self.next() % end.max(1) as u64) as usize
    }

    /// One of several.
    pub fn one<'a, T>(&mut self, all: &'a [T]) -> &'a T {
        &all[self.below(all.len())]
    }
}

/// Numbers at which something ends.
const EDGES: [u64; 12] = [0, 1, 2, 7, 0x7F, 0x80, 0xFF, 0x7FFF, 0xFFFF, 0x7FFF_FFFF, 0xFFFF_FFFF, u64::MAX];
/// Headers are short and easily missed.
const HEAD: usize = 700;

/// `bytes` with some damage.
pub fn damaged(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..=random.below(4) {
        damage(&mut bytes, random);
    }
    bytes
}

fn damage(bytes: &mut Vec<u8>, random: &mut Random) {
    let reach = if random.below(2) == 0 { bytes.len().min(HEAD) } else { bytes.len() };
    let at = random.below(reach);
    let length = (1 + random.below(64)).min(bytes.len() - at.min(bytes.len()));
    let piece = bytes[at.min(bytes.len())..][..length].to_vec();
    match random.below(10) {
        _ if bytes.is_empty() => bytes.push(random.next() as u8),
        0 | 1 => bytes[at] ^= 1 << random.below(8),
        2 => bytes[at] = random.next() as u8,
        3 | 4 => {
            let (edge, width) = (*random.one(&EDGES), *random.one(&[1, 2, 4, 8]));
            let digits =
                if random.below(2) == 0 { edge.to_le_bytes() } else { (edge << (64 - 8 * width)).to_be_bytes() };
            bytes.iter_mut().skip(at).zip(&digits[..width]).for_each(|(byte, digit)| *byte = *digit);
        }
        5 => bytes.truncate(at),
        6 => drop(bytes.drain(at..at + length)),
        7 => drop(bytes.splice(at..at, piece)),
        8 => {
            let to = random.below(bytes.len() - length + 1);
            bytes[to..to + length].copy_from_slice(&piece);
        }
        _ => bytes[at..at + length].iter_mut().for_each(|byte| *byte = random.next() as u8),
    }
}

/// Words that stand where a number or a name should.
const WORDS: [&str; 16] = [
    "-1",
    "0",
    "-0.0",
    "1e300",
    "-1e-300",
    "nan",
    "inf",
    "99999999999999999999",
    "4294967296",
    "0.5",
    "x",
    "\"\"",
    "[]",
    "\u{1B}[31m\u{0}",
    "\u{202E}..",
    "運動",
];

/// `text` with some damage: lines and words that are wrong rather than bytes.
pub fn mistaken(text: &str, random: &mut Random) -> Vec<u8> {
    if random.below(4) == 0 {
        return damaged(text.as_bytes(), random);
    }
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    for _ in 0..=random.below(3) {
        let at = random.below(lines.len());
        let line = lines.get(at).cloned().unwrap_or_default();
        match random.below(6) {
            0 if lines.len() > 1 => drop(lines.remove(at)),
            1 => lines.insert(at, line),
            2 => lines.insert(at, random.one(&WORDS).repeat(1 + random.below(400))),
            _ => {
                let is_apart = |c: char| c.is_whitespace() || ",=[]\"".contains(c);
                let words: Vec<&str> = line.split_inclusive(is_apart).collect();
                let which = random.below(words.len());
                let wrong = *random.one(&WORDS);
                let changed = words.iter().enumerate().map(|(i, word)| {
                    let end = word.chars().last().filter(|c| is_apart(*c)).map_or(String::new(), String::from);
                    if i == which { format!("{wrong}{end}") } else { (*word).to_owned() }
                });
                let changed: String = changed.collect();
                if let Some(line) = lines.get_mut(at) {
                    *line = changed;
                }
            }
        }
    }
    lines.join("\n").into_bytes()
}

/// Whether `told` is what a person is told: one sentence that can be seen whole.
pub fn check_sentence(told: &str) {
    assert!(!told.is_empty() && told.chars().count() <= 300, "{} characters: {told}", told.chars().count());
    assert!(!told.chars().any(char::is_control), "control characters: {told:?}");
    assert!(!told.ends_with('.') || told.ends_with(".."), "it has a full stop: {told}");
    for odd in ["Unknown(", "untagged", "any variant", "unwrap", "panicked", "::", "Some(", "None", "Err("] {
        assert!(!told.contains(odd), "{odd} is no word for a person: {told}");
    }
}

/// What `work` comes to, which must neither panic nor go on for ever; `what` tells what it is.
pub fn in_time<T: Send + 'static>(what: &str, work: impl FnOnce() -> T + Send + 'static) -> T {
    let (sender, receiver) = channel();
    let thread = thread::spawn(move || sender.send(work()));
    match receiver.recv_timeout(LONGEST) {
        Ok(outcome) => outcome,
        Err(RecvTimeoutError::Timeout) => panic!("{what} does not come to an end"),
        Err(RecvTimeoutError::Disconnected) => {
            let panic = thread.join().err();
            let said = panic.as_ref().and_then(|panic| panic.downcast_ref::<String>().cloned()).unwrap_or_default();
            panic!("{what} panics: {said}");
        }
    }
}
