//! The clocks of the library: the date of a check, and the time of the slowest step of a run and of the progress of a study.

use std::sync::OnceLock;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// False in a browser, which has no clock for the library.
const HAS_CLOCK: bool = !cfg!(target_family = "wasm");

/// Time since 1970 (UTC); `None` without a clock.
pub(crate) fn since_1970() -> Option<Duration> {
    let now = HAS_CLOCK.then(SystemTime::now)?;
    now.duration_since(UNIX_EPOCH).ok()
}

/// Time since the first call, which never goes back; `None` without a clock.
pub(crate) fn elapsed() -> Option<Duration> {
    static START: OnceLock<Instant> = OnceLock::new();
    HAS_CLOCK.then(|| START.get_or_init(Instant::now).elapsed())
}
