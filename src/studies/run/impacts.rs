//! The impacts of a history that are described: the first one, and the one that takes the most energy.

use serde::{Deserialize, Serialize};

use super::tables::energy_loss_j;
use crate::{Event, Hinge, Summary};

/// An impact that is described.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct NotableImpact {
    /// Time in seconds.
    pub time_s: f64,
    /// Kinetic energy after the impact over that before it; 0 if no mechanism can follow.
    pub restitution: f64,
    /// Joints that closed; absent for mechanisms.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub closed_joints: Vec<usize>,
    /// Joints that opened; absent for mechanisms.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub opened_joints: Vec<usize>,
}

/// Impacts that may be described: the first impact, and each impact that takes more energy than all before. Each with this energy, in J.
#[derive(Clone, Debug, Default)]
pub struct NotableImpacts(Vec<(f64, NotableImpact)>);

impl<'a> FromIterator<&'a Event> for NotableImpacts {
    fn from_iter<I: IntoIterator<Item = &'a Event>>(events: I) -> Self {
        let mut notable = Self::default();
        events
            .into_iter()
            .for_each(|event| notable.add_event(event));
        notable
    }
}

impl NotableImpacts {
    /// Adds an event. Events come in the order of time.
    pub(super) fn add_event(&mut self, event: &Event) {
        let Some(impact) = &event.impact else { return };
        let loss_j = energy_loss_j(impact);
        if self
            .0
            .last()
            .is_none_or(|(hardest_j, _)| loss_j > *hardest_j)
        {
            let notable = NotableImpact {
                time_s: event.time_s,
                restitution: impact.restitution,
                closed_joints: joints(&impact.closed),
                opened_joints: joints(&impact.opened),
            };
            self.0.push((loss_j, notable));
        }
    }

    /// First impact, and the impact of a row that takes the most energy, if this is another one.
    pub(super) fn first_and_hardest(&self, history: &Summary) -> [Option<NotableImpact>; 2] {
        let mut impacts = self.0.iter().map(|(_, impact)| impact).cloned();
        let first = impacts.next();
        [
            first,
            impacts.next_back().filter(|_| history.row().is_some()),
        ]
    }
}

fn joints(hinges: &[Hinge]) -> Vec<usize> {
    let joint = |hinge: &Hinge| match *hinge {
        Hinge::Joint { joint, .. } => Some(joint),
        Hinge::Section { .. } | Hinge::Toe(_) | Hinge::Face { .. } => None,
    };
    hinges.iter().filter_map(joint).collect()
}
