//! The progress of long computations on the terminal.

use std::io::{self, IsTerminal as _, Write as _};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use archrock::scenario::shown_lines;
use archrock::studies::{Counted, Progress, SearchStep};
use archrock_text::wrapped;
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};

/// True if only errors and results are printed.
static QUIET: AtomicBool = AtomicBool::new(false);

/// Sets whether only errors and results are printed.
pub fn set_quiet(quiet: bool) {
    QUIET.store(quiet, Ordering::Relaxed);
}

/// Returns true if only errors and results are printed.
pub fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Prints a line on standard error, unless the program is quiet.
pub fn print_status(text: &str) {
    if !is_quiet() {
        print_always(text);
    }
}

/// Prints lines on standard error; long ones continue on indented lines.
pub fn print_always(text: &str) {
    let text = shown_lines(text);
    let lines: Vec<String> = text.lines().flat_map(wrapped).collect();
    // If standard error fails, there is no place for a message.
    let _ = writeln!(io::stderr(), "{}", lines.join("\n"));
}

/// Display of progress: a bar on a terminal, otherwise a line per minute.
pub struct Display {
    bar: ProgressBar,
    begun: Instant,
    /// Number done before.
    before: usize,
    /// Time before the bar is shown; `None` if there is no bar.
    patience: Option<Duration>,
    /// Time of the last line; `None` if no lines are printed.
    said: Option<Instant>,
}

/// Time after which work without a display is announced.
const LONG: Duration = Duration::from_secs(2);
/// Time after which a history or a film shows its progress.
const PATIENCE: Duration = Duration::from_secs(1);
/// Interval between lines.
const MINUTE: Duration = Duration::from_secs(60);
/// Length of the bar: it counts thousandths of the work.
const WHOLE: u64 = 1000;

impl Display {
    /// Makes a display without a bar. The bar appears with the first cases of a study, or if a history or a film takes longer than a second.
    pub fn new(first: Progress) -> Self {
        let patience = match first.counted {
            Counted::Cases | Counted::Search(_) => Duration::ZERO,
            Counted::Milliseconds | Counted::Pictures => PATIENCE,
        };
        let quiet = is_quiet();
        let on_terminal = io::stderr().is_terminal();
        let bar = ProgressBar::with_draw_target(Some(WHOLE), ProgressDrawTarget::hidden());
        let style = ProgressStyle::with_template("{bar:40} {msg}");
        bar.set_style(style.expect("the template is valid"));
        Self {
            bar,
            begun: Instant::now(),
            before: first.done,
            patience: (!quiet && on_terminal).then_some(patience),
            said: (!quiet && !on_terminal).then(Instant::now),
        }
    }

    /// Shows the completed fraction of the work, the speed and the time left.
    pub fn show(&mut self, progress: Progress) {
        let elapsed = self.begun.elapsed();
        let words = || progress_in_words(progress, self.before, elapsed);
        if let Some(said) = &mut self.said
            && said.elapsed() >= MINUTE
        {
            *said = Instant::now();
            print_status(&words());
        } else if self.patience.is_some_and(|patience| elapsed >= patience) {
            if self.bar.is_hidden() {
                self.bar.set_draw_target(ProgressDrawTarget::stderr());
            }
            let part = progress.done as f64 / progress.all.max(1) as f64;
            self.bar.set_position((WHOLE as f64 * part) as u64);
            self.bar.set_message(words());
        }
    }

    /// Ends the progress and leaves the bar on the terminal.
    pub fn abandon(&self) {
        self.bar.abandon();
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// Does work, and prints a line about it if it takes long.
pub fn with_notice<T>(words: String, work: impl FnOnce() -> T) -> T {
    let (done, waits) = mpsc::channel::<()>();
    // Nothing depends on the thread.
    let _ = thread::Builder::new().spawn(move || {
        if waits.recv_timeout(LONG) == Err(RecvTimeoutError::Timeout) {
            print_status(&words);
        }
    });
    let result = work();
    drop(done);
    result
}

/// Returns the progress in words, of which a number was done `before` the display.
fn progress_in_words(
    Progress { done, all, counted }: Progress,
    before: usize,
    elapsed: Duration,
) -> String {
    let left = || {
        speed(
            done.saturating_sub(before),
            all.saturating_sub(done),
            elapsed,
        )
    };
    match counted {
        Counted::Cases => format!("{done} of {all} cases, {}", left()),
        Counted::Pictures => format!("{done} of {all} pictures, {}", left()),
        // The duration of an open step is unknown.
        Counted::Search(step) if step.is_open => {
            format!("{}; {done} factors tried", safe_in_words(step))
        }
        Counted::Search(step) => format!("{}; {} in this step", safe_in_words(step), left()),
        Counted::Milliseconds if done == all => "repeating the history with other steps".to_owned(),
        Counted::Milliseconds => {
            let [time_s, end_s] = [done, all].map(|time| time as f64 / 1e3);
            let left = time_left(elapsed.as_secs_f64() * (end_s / time_s - 1.0).max(0.0));
            format!("{time_s:.2} of {end_s} s simulated, {left}")
        }
    }
}

fn safe_in_words(step: SearchStep) -> String {
    match step.safe_up_to {
        Some(factor) => format!("survives up to {factor:.4} so far"),
        None => "survives no factor so far".to_owned(),
    }
}

/// Returns speed and remaining time, such as "12 a second, 3 minutes left". They are means over all finished cases, so a single slow case has
/// little effect.
fn speed(done: usize, left: usize, elapsed: Duration) -> String {
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
    format!("{rate}, {}", time_left(each.as_secs_f64() * left as f64))
}

/// Returns the remaining time in words, such as "3 minutes left".
fn time_left(left_s: f64) -> String {
    const YEAR_S: f64 = 365.25 * 86_400.0;
    // At the beginning the estimate is arbitrary, and nobody waits for years.
    match left_s < YEAR_S {
        true => format!("{} left", HumanDuration(Duration::from_secs_f64(left_s))),
        false => "more than a year left".to_owned(),
    }
}
