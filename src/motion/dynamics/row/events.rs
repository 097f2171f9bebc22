//! Events and impacts of a row, held back until it is certain that they do not belong to its fall.

use std::vec::Drain;

use crate::dynamics::Event;

/// Events and impacts up to now.
#[derive(Default)]
pub struct EventLog {
    /// Number of transitions up to now.
    pub phase: usize,
    /// Time of the last impact, in seconds.
    pub last_impact_s: Option<f64>,
    /// State at the last time at which the row could return; `None` if no events are wanted.
    pub last_return: Option<Event>,
    /// Impacts up to that time.
    settled_impacts: usize,
    /// Times of the impacts since then, in seconds.
    late_impacts_s: Vec<f64>,
    /// Events since then.
    late: Vec<Event>,
    /// Events held back until an impact is reported; `None` if no impact is pending.
    pending: Option<Vec<Event>>,
}

impl EventLog {
    /// Records an impact.
    pub fn note_impact(&mut self, time_s: f64) {
        self.last_impact_s = Some(time_s);
        self.late_impacts_s.push(time_s);
    }

    /// Number of impacts.
    pub const fn impacts(&self) -> usize {
        self.settled_impacts + self.late_impacts_s.len()
    }

    /// Records an event that begins a phase. Events after a pending impact are held back until the impact is reported.
    pub fn report(&mut self, event: &Event) {
        let pending = match &mut self.pending {
            Some(pending) if event.impact.is_none() => {
                self.phase += 1;
                pending.push(event.clone());
                return;
            }
            pending => pending.take(),
        };
        if pending.is_none() {
            self.phase += 1;
        }
        self.late.push(event.clone());
        self.late.extend(pending.into_iter().flatten());
    }

    /// Begins the phase of an impact that is reported after the next step, when its energy is known.
    pub fn await_impact(&mut self) {
        self.phase += 1;
        self.pending = Some(Vec::new());
    }

    /// Settles the impacts up to a time, in seconds, and returns the events up to then: they do not belong to a fall.
    pub fn settle(&mut self, until_s: f64) -> Drain<'_, Event> {
        let impacts = (self.late_impacts_s).partition_point(|time_s| *time_s <= until_s);
        self.late_impacts_s.drain(..impacts);
        self.settled_impacts += impacts;
        let events = (self.late).partition_point(|event| event.time_s <= until_s);
        self.late.drain(..events)
    }

    /// Drops the events and impacts of the fall.
    pub fn drop_late(&mut self) {
        self.late.clear();
        self.late_impacts_s.clear();
    }
}
