//! Interruption by the user.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A flag that becomes true at the first Ctrl-C, or when the system asks to end (SIGTERM, as batch systems send it): the
/// run finishes its increment and closes its files. The second one ends the process at once. Where no handler can be
/// installed, the signals keep their usual meaning.
pub(super) fn flag() -> Arc<AtomicBool> {
    let flag = Arc::new(AtomicBool::new(false));
    let raised = flag.clone();
    let handler = move || {
        if raised.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    };
    let _ = ctrlc::set_handler(handler);
    flag
}
