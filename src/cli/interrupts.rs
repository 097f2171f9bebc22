//! Signals that end the program: Ctrl-C ends long work between two rows, and all of them wait while results get their names.

use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// True after Ctrl-C, if the work listens to it.
pub static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// True if the work ends by itself after the first Ctrl-C.
static LISTENS: AtomicBool = AtomicBool::new(false);

/// Locked while results get their names.
static EXCHANGE: Mutex<()> = Mutex::new(());

/// Exit code of shells for a program that was ended by Ctrl-C.
pub const INTERRUPTED_CODE: i32 = 130;

/// From now on the first Ctrl-C ends the work between two lines of its file, and the second one ends the program.
pub fn listen_to_interrupts() {
    LISTENS.store(true, Ordering::Relaxed);
}

/// Does work that no signal interrupts: signals end the program after it.
pub fn uninterrupted<T>(work: impl FnOnce() -> T) -> T {
    let _locked = exchange();
    work()
}

/// Waits until no results are getting their names.
fn exchange() -> MutexGuard<'static, ()> {
    EXCHANGE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Handles Ctrl-C. Returns true if the program must end, as it does without a handler.
fn interrupt() -> bool {
    if !LISTENS.load(Ordering::Relaxed) {
        return true;
    }
    if INTERRUPTED.swap(true, Ordering::Relaxed) {
        let _locked = exchange();
        process::exit(INTERRUPTED_CODE);
    }
    false
}

/// Starts the thread that receives the signals which end the program. Other threads must not exist yet, because they inherit the signals that
/// this one blocks.
#[cfg(unix)]
pub fn receive_signals() {
    use nix::sys::signal::{SigSet, Signal, raise};
    use std::thread;

    let all: SigSet = [Signal::SIGINT, Signal::SIGTERM, Signal::SIGHUP]
        .into_iter()
        .collect();
    if all.thread_block().is_err() {
        return;
    }
    let receiver = thread::Builder::new().spawn(move || {
        while let Ok(signal) = all.wait() {
            if signal == Signal::SIGINT && !interrupt() {
                continue;
            }
            let _locked = exchange();
            // The default effect of the signal: the program ends, or under `nohup` goes on.
            let alone = SigSet::from(signal);
            let raised = alone.thread_unblock().and_then(|()| raise(signal));
            if raised.and_then(|()| alone.thread_block()).is_err() {
                process::exit(INTERRUPTED_CODE);
            }
        }
    });
    if receiver.is_err() {
        // Without the thread signals end the program at once.
        let _ = all.thread_unblock();
    }
}

/// Receives Ctrl-C.
#[cfg(not(unix))]
pub fn receive_signals() {
    // Without the handler Ctrl-C ends the program at once.
    let _ = ctrlc::set_handler(|| {
        if interrupt() {
            let _locked = exchange();
            process::exit(INTERRUPTED_CODE);
        }
    });
}
