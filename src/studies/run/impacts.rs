//! The impacts of a history that are described: the first one, and the one that takes the most energy.

use serde::{Deserialize, Serialize};

use super::tables::energy_loss_j;
use crate::{Event, Hinge, Impact, Summary as History};

/// An impact that is described.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ImpactSummary {
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

/// Impacts that may be described, with their times: the first impact, and each impact that takes more energy than all before.
#[derive(Clone, Debug, Default)]
pub struct NotableImpacts(Vec<(f64, Impact)>);

impl<'a> FromIterator<&'a Event> for NotableImpacts {
    fn from_iter<I: IntoIterator<Item = &'a Event>>(events: I) -> Self {
        let mut notable = Self::default();
        events.into_iter().for_each(|event| notable.note(event));
        notable
    }
}

impl NotableImpacts {
    /// Adds an event. Events come in the order of time.
    pub(super) fn note(&mut self, event: &Event) {
        let (time_s, Some(impact)) = (event.time_s, &event.impact) else {
            return;
        };
        let hardest = self.0.last();
        if hardest.is_none_or(|(_, hardest)| energy_loss_j(impact) > energy_loss_j(hardest)) {
            self.0.push((time_s, impact.clone()));
        }
    }

    /// Returns the first impact, and the impact of a row that takes the most energy, if this is another one. Impacts after overturning do not count.
    pub(super) fn before_the_end(&self, history: &History) -> [Option<ImpactSummary>; 2] {
        let until_s = history.overturned_s().unwrap_or(f64::INFINITY);
        let before: Vec<_> = self
            .0
            .iter()
            .filter(|(time_s, _)| *time_s <= until_s)
            .collect();
        let hardest = before.get(1..).and_then(<[_]>::last);
        let hardest = hardest.filter(|_| history.row().is_some());
        [before.first(), hardest].map(|one| {
            one.map(|(time_s, impact)| ImpactSummary {
                time_s: *time_s,
                restitution: impact.restitution,
                closed_joints: joints(&impact.closed),
                opened_joints: joints(&impact.opened),
            })
        })
    }
}

fn joints(hinges: &[Hinge]) -> Vec<usize> {
    let joint = |hinge: &Hinge| match *hinge {
        Hinge::Joint { joint, .. } => Some(joint),
        Hinge::Section { .. } | Hinge::Toe(_) => None,
    };
    hinges.iter().filter_map(joint).collect()
}
