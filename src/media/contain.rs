//! Keeps a decoder's panic from reaching the program.

use std::any::Any;
use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;

thread_local! {
    static CONTAINED: Cell<bool> = const { Cell::new(false) };
}

/// What `f` returns, or the message of its panic, of which nothing is printed.
///
/// Decoders of others' making meet damaged files here; what `f` leaves behind must not be relied on after a panic.
pub(crate) fn contain<T>(f: impl FnOnce() -> T) -> Result<T, String> {
    silence();
    let outer = CONTAINED.replace(true);
    let result = panic::catch_unwind(AssertUnwindSafe(f));
    CONTAINED.set(outer);
    result.map_err(|panic| message(panic.as_ref()))
}

/// Keeps panics on a contained thread off standard error; all others are told as before.
fn silence() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let told = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if !CONTAINED.get() {
                told(info);
            }
        }));
    });
}

fn message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied().or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("no reason was given").to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_its_message() {
        assert_eq!(contain(|| 7), Ok(7));
        assert_eq!(contain(|| -> u8 { panic!("index {}", 3) }), Err("index 3".into()));
        assert_eq!(contain(|| contain(|| -> u8 { panic!("inner") })), Ok(Err("inner".into())));
    }
}
