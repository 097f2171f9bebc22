//! Receivers of the samples and events of a history.

use std::ops::ControlFlow;

use super::fall::FallEnd;
use super::history::{Event, Sample};

/// Receives the samples and events of a history. Breaking ends the history there.
///
/// Samples arrive in order of time, and so do events; the last sample before an event may arrive after it.
pub trait Recorder {
    /// A sample: one at every multiple of the output step from zero on, and a last one at the end.
    fn sample(&mut self, _sample: &Sample) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// An event.
    fn event(&mut self, _event: &Event) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// Whether samples need the thrust excess and the friction demand, which take most of the time of a history of four links. Without
    /// them, the summary of mechanisms has no record of thrust.
    fn wants_demand(&self) -> bool {
        true
    }

    /// Whether samples need the line of thrust, which takes time to compute.
    fn wants_thrust_line(&self) -> bool {
        false
    }

    /// Whether the recorder needs samples after the structure has overturned.
    fn wants_fall(&self) -> bool {
        false
    }

    /// A sample of the fall. They come after all samples and events of the history, of which they are no part. Breaking ends the fall.
    fn fall(&mut self, _sample: &Sample) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// Why the fall is followed no further.
    fn fell(&mut self, _end: FallEnd) {}
}

/// A function records samples.
impl<F: FnMut(&Sample) -> ControlFlow<()>> Recorder for F {
    fn sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        self(sample)
    }
}

/// A function records samples without the demand of the line of thrust.
pub struct WithoutDemand<F>(pub F);

impl<F: FnMut(&Sample) -> ControlFlow<()>> Recorder for WithoutDemand<F> {
    fn sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        (self.0)(sample)
    }

    fn wants_demand(&self) -> bool {
        false
    }
}
