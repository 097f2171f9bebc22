//! The only clock of the library: it dates a check, times the slowest step of a run and the progress of a study.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// Returns the time since 1970 (UTC); `None` where there is no clock, as in a browser.
pub(crate) fn since_1970() -> Option<Duration> {
    let now = (!cfg!(target_family = "wasm")).then(SystemTime::now)?;
    now.duration_since(UNIX_EPOCH).ok()
}
