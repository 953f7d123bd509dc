//! Turns panics of a decoder into errors: the Parquet decoder panics on some damaged files.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

thread_local! {
    static QUIET: Cell<bool> = const { Cell::new(false) };
}

/// What `decode` returns, or the message with which it panicked.
///
/// Such a panic is not printed: it says nothing about this program. For that the panic hook is wrapped, once and for
/// all; panics outside of `decode` reach the hook that was there.
pub(crate) fn caught<T>(decode: impl FnOnce() -> T) -> Result<T, String> {
    static WRAP: Once = Once::new();
    WRAP.call_once(|| {
        let outer = take_hook();
        set_hook(Box::new(move |panic| {
            if !QUIET.get() {
                outer(panic);
            }
        }));
    });
    QUIET.set(true);
    // Nothing that `decode` has touched is used after a panic.
    let result = catch_unwind(AssertUnwindSafe(decode));
    QUIET.set(false);
    result.map_err(|cause| {
        let text = cause.downcast_ref::<String>().map(String::as_str);
        text.or_else(|| cause.downcast_ref::<&str>().copied()).unwrap_or("no message").to_owned()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_pass_and_panics_become_messages() {
        assert_eq!(caught(|| 3), Ok(3));
        assert_eq!(caught(|| -> u8 { panic!("{} left", 0) }), Err("0 left".into()));
        assert_eq!(caught(|| -> u8 { panic!("none left") }), Err("none left".into()));
    }
}
