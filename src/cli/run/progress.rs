//! The progress of a run on the terminal.

use std::fmt;
use std::io::{self, IsTerminal as _};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use super::super::progress::say;
use archrock::studies::run::Stage;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

/// A run shorter than this shows no progress.
const PATIENCE: Duration = Duration::from_secs(1);
/// Time between the lines of a run that is not on a terminal.
const MINUTE: Duration = Duration::from_secs(60);
/// The bar counts thousandths of the longest time to simulate.
const WHOLE: u64 = 1000;

/// The simulated time reached so far: on a terminal as a bar, which vanishes when dropped; elsewhere as a line a minute.
pub struct RunProgress {
    bar: ProgressBar,
    duration_s: f64,
    begun: Instant,
    /// Whether progress is wanted and standard error is a terminal.
    wanted: bool,
    /// The stage that lines report; `None` if there are no lines.
    reported: Option<Arc<Mutex<Stage>>>,
    /// Ends the lines when dropped.
    _lines: Option<Sender<()>>,
}

impl RunProgress {
    pub fn new(duration_s: f64, quiet: bool) -> Self {
        let (mut reported, mut lines) = (None, None);
        if !quiet && !io::stderr().is_terminal() {
            let stage = Arc::new(Mutex::new(Stage::Reached(0.0)));
            lines = Some(print_lines(Arc::clone(&stage), duration_s));
            reported = Some(stage);
        }
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
            reported,
            _lines: lines,
        }
    }

    /// Shows how far the run has come.
    pub fn show(&self, stage: Stage) {
        if let Some(reported) = &self.reported {
            *reported.lock().unwrap_or_else(PoisonError::into_inner) = stage;
        }
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

/// Prints the stage every minute, until the sender that is returned is dropped.
fn print_lines(stage: Arc<Mutex<Stage>>, duration_s: f64) -> Sender<()> {
    let (sender, receiver) = mpsc::channel();
    thread::spawn(move || {
        while receiver.recv_timeout(MINUTE) == Err(RecvTimeoutError::Timeout) {
            let stage = *stage.lock().unwrap_or_else(PoisonError::into_inner);
            say(&match stage {
                Stage::Reached(time_s) => format!("{time_s:.2} of {duration_s} s simulated"),
                Stage::Repeating => "repeating the history with other steps".to_owned(),
            });
        }
    });
    sender
}

impl Drop for RunProgress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
