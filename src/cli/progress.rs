//! The progress of long computations on the terminal, and Ctrl-C.

use std::io::{self, IsTerminal as _, Write as _};
use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use archrock::scenario::shown_lines;
use archrock::studies::runner::Progress;
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
    /// Number of cases done before this start; they do not count in the pace.
    before: usize,
    begun: Instant,
    /// Time of the last line; `None`: no lines are printed.
    said: Option<Instant>,
}

/// Time between lines.
const MINUTE: Duration = Duration::from_secs(60);

impl Display {
    pub fn new(begin: Progress) -> Self {
        let quiet = QUIET.load(Ordering::Relaxed);
        let on_terminal = io::stderr().is_terminal();
        let target = if quiet || !on_terminal {
            ProgressDrawTarget::hidden()
        } else {
            ProgressDrawTarget::stderr()
        };
        let bar = ProgressBar::with_draw_target(Some(begin.all as u64), target);
        let style = ProgressStyle::with_template("{bar:40} {pos}/{len} cases, {msg}")
            .expect("the template is valid");
        bar.set_style(style);
        bar.set_position(begin.done as u64);
        bar.set_message(pace(0, begin.all, Duration::ZERO));
        Self {
            bar,
            before: begin.done,
            begun: Instant::now(),
            said: (!quiet && !on_terminal).then(Instant::now),
        }
    }

    pub fn show(&mut self, progress: Progress) {
        let pace = pace(
            progress.done.saturating_sub(self.before),
            progress.all.saturating_sub(progress.done),
            self.begun.elapsed(),
        );
        self.bar.set_length(progress.all as u64);
        self.bar.set_position(progress.done as u64);
        self.bar.set_message(pace.clone());
        if let Some(said) = &mut self.said
            && said.elapsed() >= MINUTE
        {
            *said = Instant::now();
            say(&format!(
                "{} of {} cases, {pace}",
                progress.done, progress.all
            ));
        }
    }

    pub fn finish(self) {
        self.bar.finish_and_clear();
    }

    /// Ends the progress without removing the bar.
    pub fn abandon(&self) {
        self.bar.abandon();
    }
}

/// "12 a second, 3 minutes left", from the mean of all finished cases: with a moving mean one slow case would spoil the estimate.
fn pace(done: usize, left: usize, elapsed: Duration) -> String {
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
