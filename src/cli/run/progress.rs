//! The progress of a run on the terminal.

use std::fmt;
use std::io::{self, IsTerminal as _};
use std::time::{Duration, Instant};

use archrock::studies::run::Stage;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

/// A run shorter than this shows no progress.
const PATIENCE: Duration = Duration::from_secs(1);
/// The bar counts thousandths of the longest time to simulate.
const WHOLE: u64 = 1000;

/// A bar that shows the simulated time reached so far. It vanishes when dropped.
pub struct RunProgress {
    bar: ProgressBar,
    duration_s: f64,
    begun: Instant,
    /// Whether progress is wanted and standard error is a terminal.
    wanted: bool,
}

impl RunProgress {
    pub fn new(duration_s: f64, quiet: bool) -> Self {
        let bar = ProgressBar::with_draw_target(Some(WHOLE), ProgressDrawTarget::hidden());
        let template = "{bar:40} {reached} of {duration} s simulated, {eta} left{msg}";
        let seconds = move |state: &ProgressState| f64::from(state.fraction()) * duration_s;
        let style = ProgressStyle::with_template(template)
            .expect("the template is valid")
            // A bar that cannot be written does no harm.
            .with_key(
                "reached",
                move |state: &ProgressState, out: &mut dyn fmt::Write| {
                    let _ = write!(out, "{:.2}", seconds(state));
                },
            )
            .with_key(
                "duration",
                move |_: &ProgressState, out: &mut dyn fmt::Write| {
                    let _ = write!(out, "{duration_s}");
                },
            );
        bar.set_style(style);
        Self {
            bar,
            duration_s,
            begun: Instant::now(),
            wanted: !quiet && io::stderr().is_terminal(),
        }
    }

    /// Shows how far the run has come.
    pub fn show(&self, stage: Stage) {
        if !self.shows() {
            return;
        }
        match stage {
            Stage::Reached(time_s) => {
                let part = WHOLE as f64 * time_s / self.duration_s;
                self.bar.set_position(part as u64);
            }
            Stage::Repeating => self.bar.set_message("; repeating it with other steps"),
        }
    }

    fn shows(&self) -> bool {
        let shows = self.wanted && self.begun.elapsed() > PATIENCE;
        if shows && self.bar.is_hidden() {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        shows
    }
}

impl Drop for RunProgress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
