//! Separate motion of the right foot: `[ground.right]`.
//!
//! ```toml
//! [ground.right]
//! delay_s = 0.05                  # the same motion, later by this time, or earlier if negative; or
//! apparent_velocity_m_s = 300.0   # later by the distance between the feet over this; or
//!
//! [ground.right.record]           # a record of its own, with the keys of [ground.record]
//! file = "right.at2"
//! ```

use super::model_kind::ModelKind;
use super::prelude::*;
use super::record::{KnownRecords, Record};
use super::structure::Structure;
use super::study_table::StudyTable;
use crate::GroundMotion;
use crate::dynamics::FEET_NEED_JOINTS;

/// Smallest velocity of a wave, in m/s; smaller values are probably in another unit.
const SLOWEST_M_S: f64 = 1.0;
const RECORD: &str = "record";
const WAVE: &str = "apparent_velocity_m_s";

/// Motion of the ground under the right foot.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum RightFoot {
    /// Motion of the left foot with this delay, in s. Negative: the right foot starts earlier.
    #[serde(rename = "delay_s")]
    Late(f64),
    /// Motion of the left foot with a delay equal to the distance between the feet over this velocity, in m/s. Negative: the wave travels to the
    /// left, and the right foot starts earlier.
    #[serde(rename = "apparent_velocity_m_s")]
    Wave(f64),
    /// A separate record.
    #[serde(rename = "record")]
    Record(Box<Record>),
}

impl RightFoot {
    pub(super) fn read(table: &mut Table<'_>, known: KnownRecords<'_>) -> ReadResult<Self> {
        let delay_s = table.optional("delay_s", &within(&(-1e3..=1e3)));
        let velocity_m_s = table.optional(WAVE, &within(&(-1e6..=1e6)));
        let record = table.table(RECORD, |table| Record::read(table, known));
        table.apply_relations(&[OneOf(&["delay_s", WAVE, RECORD], None)])?;
        let is_slow = |velocity_m_s: f64| velocity_m_s.abs() < SLOWEST_M_S;
        let wrong = "is slower than any wave: must be at least 1 m/s, or at most -1 m/s for a wave that travels to the left";
        table.refuse(velocity_m_s.is_some_and(is_slow), WAVE, wrong)?;
        let record = record.map(|(record, _)| Self::Record(Box::new(record)));
        let late = delay_s.map(Self::Late);
        let right = late.or(velocity_m_s.map(Self::Wave)).or(record);
        right.ok_or(FaultRecorded)
    }

    /// Rejects different motions of the feet if the structure, the model or a study does not support them. `outer` is the table of the whole
    /// scenario.
    pub(super) fn check_model(
        &self,
        outer: &mut Table<'_>,
        structure: Option<&Structure>,
        kind: &ModelKind,
    ) -> ReadResult<()> {
        if !kind.has_joints {
            let wrong = format!(
                "needs free hinges or elastic joints: {FEET_NEED_JOINTS}; choose one, or leave it out"
            );
            return Err(outer.reject_in(&["ground"], "right", wrong));
        }
        if structure.is_some_and(Structure::stands_on_one_support) {
            let wrong = "needs two feet, and this stands on one: leave it out";
            return Err(outer.reject_in(&["ground"], "right", wrong));
        }
        let mut changing = [StudyTable::Map, StudyTable::Suite]
            .map(StudyTable::name)
            .into_iter()
            .filter(|study| outer.has_key(study));
        if let (Self::Record(_), Some(study)) = (self, changing.next()) {
            let wrong = "changes the motion of the ground, and [ground.right] has a record of its own: give `delay_s` or \
                         `apparent_velocity_m_s` there, with which both feet change";
            return Err(outer.reject(study, wrong));
        }
        Ok(())
    }

    /// Record of the right foot; `None` if it has the delayed motion of the left foot.
    pub fn record(&self) -> Option<&Record> {
        match self {
            Self::Record(record) => Some(record),
            Self::Late(_) | Self::Wave(_) => None,
        }
    }

    /// Delay in s for feet at the distance `apart_m`; `None` if the right foot has a separate record.
    pub fn delay_s(&self, apart_m: f64) -> Option<f64> {
        match self {
            Self::Late(delay_s) => Some(*delay_s),
            Self::Wave(velocity_m_s) => Some(apart_m / velocity_m_s),
            Self::Record(_) => None,
        }
    }

    /// Motion of both feet, from that of the left foot and the distance between the feet in m.
    ///
    /// With two records, the foot with the shorter record stops at the end of that record.
    pub(super) fn with_left_foot(
        &self,
        left: GroundMotion,
        apart_m: f64,
        gravity_m_s2: f64,
    ) -> GroundMotion {
        const IN_RANGE: &str = "the ranges of the keys are those of a delay";
        if let Some(delay_s) = self.delay_s(apart_m) {
            return left.with_delayed_right_foot(delay_s).expect(IN_RANGE);
        }
        let right = self
            .record()
            .map(|record| record.ground_motion(gravity_m_s2))
            .unwrap_or_else(GroundMotion::still);
        match (left.end_s(), right.end_s()) {
            (left_s, right_s) if left_s < right_s => left.stopping().with_right_foot(right),
            (left_s, right_s) if right_s < left_s => left.with_right_foot(right.stopping()),
            _ => left.with_right_foot(right),
        }
    }
}
