//! The progress of long computations on the terminal, and Ctrl-C.

use std::io::{self, IsTerminal as _, Write as _};
use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use archrock::scenario::shown_lines;
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Whether only errors and results are printed.
static QUIET: AtomicBool = AtomicBool::new(false);

/// Chooses whether only errors and results are printed.
pub fn set_quiet(quiet: bool) {
    QUIET.store(quiet, Ordering::Relaxed);
}

/// Whether Ctrl-C was pressed.
pub static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// On Ctrl-C: ends the work between two lines of its file; on a second Ctrl-C, at once.
pub fn listen_to_interrupts() {
    // Without the handler Ctrl-C still ends the program, without a message.
    let _ = ctrlc::set_handler(|| {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            process::exit(INTERRUPTED_CODE);
        }
    });
}

/// The exit code of shells for a program ended by Ctrl-C.
pub const INTERRUPTED_CODE: i32 = 130;

/// Prints a line on standard error, unless the program is quiet.
pub fn say(text: &str) {
    if !QUIET.load(Ordering::Relaxed) {
        say_always(text);
    }
}

/// Prints a line on standard error.
pub fn say_always(text: &str) {
    // When standard error fails there is nowhere to report it.
    let _ = writeln!(io::stderr(), "{}", shown_lines(text));
}

/// Progress: a bar on a terminal, a line a minute elsewhere.
pub struct Display {
    bar: ProgressBar,
    begun: Instant,
    /// The time before the bar is shown; `None`: there is no bar.
    patience: Option<Duration>,
    /// Time of the last line; `None`: no lines are printed.
    said: Option<Instant>,
}

/// Time between lines.
const MINUTE: Duration = Duration::from_secs(60);
/// The bar counts thousandths of the work.
const WHOLE: u64 = 1000;

impl Display {
    /// Shows nothing yet; a computation that takes less than the `patience` has no bar.
    pub fn new(patience: Duration) -> Self {
        let quiet = QUIET.load(Ordering::Relaxed);
        let on_terminal = io::stderr().is_terminal();
        let bar = ProgressBar::with_draw_target(Some(WHOLE), ProgressDrawTarget::hidden());
        let style = ProgressStyle::with_template("{bar:40} {msg}");
        bar.set_style(style.expect("the template is valid"));
        Self {
            bar,
            begun: Instant::now(),
            patience: (!quiet && on_terminal).then_some(patience),
            said: (!quiet && !on_terminal).then(Instant::now),
        }
    }

    /// Shows the part of the work that is done, and words about it, made from the time that it took.
    pub fn show(&mut self, part: f64, words: impl FnOnce(Duration) -> String) {
        let elapsed = self.begun.elapsed();
        if let Some(said) = &mut self.said
            && said.elapsed() >= MINUTE
        {
            *said = Instant::now();
            say(&words(elapsed));
        } else if self.patience.is_some_and(|patience| elapsed >= patience) {
            if self.bar.is_hidden() {
                self.bar.set_draw_target(ProgressDrawTarget::stderr());
            }
            self.bar.set_position((WHOLE as f64 * part) as u64);
            self.bar.set_message(words(elapsed));
        }
    }

    /// Ends the progress without removing the bar.
    pub fn abandon(&self) {
        self.bar.abandon();
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// "12 a second, 3 minutes left", from the mean of all finished cases: with a moving mean one slow case would spoil the estimate.
pub fn pace(done: usize, left: usize, elapsed: Duration) -> String {
    if done == 0 {
        return "none finished yet".to_owned();
    }
    let each = elapsed.div_f64(done as f64);
    let rate = 1.0 / each.as_secs_f64().max(1e-6);
    let rate = match rate {
        10.0.. => format!("{rate:.0} a second"),
        1.0.. => format!("{rate:.1} a second"),
        _ => format!("one in {:.1} s", each.as_secs_f64()),
    };
    format!("{rate}, {} left", HumanDuration(each.mul_f64(left as f64)))
}

/// The time left, from the part of the work that is done.
pub fn left(part: f64, elapsed: Duration) -> HumanDuration {
    // At the beginning nothing is known.
    HumanDuration(elapsed.mul_f64((1.0 / part - 1.0).clamp(0.0, 1e6)))
}
