//! Computations in parallel with the caller.

use std::panic;
use std::thread::{self, JoinHandle};

/// Computation whose result is awaited later.
pub enum Pending<T> {
    /// It runs on a thread. The thread ends with the program if nobody waits for the result.
    Running(JoinHandle<T>),
    /// It runs when its result is awaited.
    Deferred(Box<dyn FnOnce() -> T + Send>),
}

impl<T: Send + 'static> Pending<T> {
    /// Starts a computation on a thread. With a single processor, and where threads are missing, the computation is deferred.
    pub fn start(compute: impl FnOnce() -> T + Send + 'static) -> Self {
        match thread::available_parallelism() {
            Ok(processors) if processors.get() > 1 => Self::Running(thread::spawn(compute)),
            _ => Self::Deferred(Box::new(compute)),
        }
    }

    /// Waits for the result. A panic of the thread continues in the caller.
    pub fn wait(self) -> T {
        match self {
            Self::Running(thread) => thread.join().unwrap_or_else(|it| panic::resume_unwind(it)),
            Self::Deferred(compute) => compute(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_result_is_the_same_with_and_without_a_thread() {
        let sum = || (0..100_u32).sum::<u32>();
        let all = [
            Pending::start(sum),
            Pending::Running(thread::spawn(sum)),
            Pending::Deferred(Box::new(sum)),
        ];
        assert_eq!(all.map(Pending::wait), [4950; 3]);
    }
}
