//! Receivers of the samples and events of a history.

use std::ops::ControlFlow;
use std::time::Duration;

use crate::dynamics::{Event, FallEnd, OpenHinge, Sample};
use crate::mechanics::Pose;

/// Receives the samples and events of a history. Breaking ends the history there.
///
/// Samples arrive in order of time, and so do events. A sample may arrive after a later event, and events of a row of blocks arrive late: once it is
/// certain that they do not belong to its fall.
pub trait Recorder {
    /// Receives a sample: one at every multiple of the output step from zero on, and the last one at the end.
    fn sample(&mut self, _sample: &Sample) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// Receives an event.
    fn event(&mut self, _event: &Event) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// Whether samples need the thrust excess and the friction demand. These take most of the time of a history of four links. Without them,
    /// the summary of mechanisms has no thrust record.
    fn wants_demand(&self) -> bool {
        true
    }

    /// Whether the recorder needs events, which take time to make.
    fn wants_events(&self) -> bool {
        true
    }

    /// Whether samples need the thrust line, which takes time to compute.
    fn wants_thrust_line(&self) -> bool {
        false
    }

    /// Time of a clock, to measure the slowest step; `None` without a clock.
    fn clock(&self) -> Option<Duration> {
        None
    }

    /// Receives the positions after a step of the computation: the time in seconds, the poses of the bodies, and the open hinges of a mechanism.
    fn step(&mut self, _time_s: f64, _poses: &[Pose], _hinges: &[OpenHinge]) {}

    /// Whether the recorder needs samples after the structure has overturned.
    fn wants_fall(&self) -> bool {
        false
    }

    /// Receives a sample of the fall. These follow all samples and events of the history and are no part of it. Breaking ends the fall.
    fn fall_sample(&mut self, _sample: &Sample) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// Receives the reason for the end of the fall.
    fn fall_end(&mut self, _end: FallEnd) {}
}

/// A function is a recorder of samples.
impl<F: FnMut(&Sample) -> ControlFlow<()>> Recorder for F {
    fn sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        self(sample)
    }
}

/// Recorder of samples by a function, without the demand of the thrust line.
pub struct WithoutDemand<F>(pub F);

impl<F: FnMut(&Sample) -> ControlFlow<()>> Recorder for WithoutDemand<F> {
    fn sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        (self.0)(sample)
    }

    fn wants_demand(&self) -> bool {
        false
    }
}
