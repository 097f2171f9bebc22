//! The ground motion: `[ground.<kind>]`.

use nalgebra::Vector2;

use super::Scenario;
use super::error::ScenarioErrors;
use super::prelude::*;
use super::record::{KnownRecords, MAX_ACCELERATION_G, Record, free_fall};
use super::right_foot::RightFoot;
use super::source::Source;
use super::table;
use crate::argument::{self, ArgumentError};
use crate::dynamics::{Pulse, PulseShape, WaveTrain};
use crate::{GroundMotion, Request};

pub(super) const AMPLITUDE_G: Number = within(&(-MAX_ACCELERATION_G..=MAX_ACCELERATION_G));
pub(super) const DURATION_S: Number = within(&(1e-6..=1e6));
/// Range of frequencies: the reciprocals of the range of durations.
pub(super) const FREQUENCY_HZ: Number = within(&(1e-6..=1e6));
/// Range of `gamma`: at 1 the envelope of the velocity pulse is one period long; above 100 the motion is not a pulse.
const GAMMA: Number = above(1.0, 100.0);
const CYCLES: Number = within(&(1.0..=100.0));
/// Reason why the motion of a checked pulse is always valid.
const IN_RANGE: &str = "the ranges of the keys are those of a ground motion";
/// Kind of ground motion that is read from files.
pub(super) const RECORD: &str = "record";

/// Ground motion of a scenario.
#[derive(Clone, Debug, PartialEq)]
pub enum Ground {
    /// A single pulse.
    Pulse(PulseGround),
    /// A record, from `[ground.record]`.
    Record(Box<Record>),
}

impl Ground {
    /// Reads a ground motion from a text that contains only the table `[ground.<kind>]` of a scenario. `gravity_m_s2` is needed to check that
    /// the motion is not too strong.
    ///
    /// # Errors
    /// All faults of the text and of its records.
    pub fn of(source: &Source, gravity_m_s2: f64) -> Result<Self, ScenarioErrors> {
        table::read_text((&source.text, &source.files), &[], |table| {
            let known = (&[][..], Some(gravity_m_s2), false);
            let ground = table.given_table("ground", |table| Self::read(table, known))?;
            let missing =
                "lacks a ground motion: give a table [ground.<kind>], such as [ground.rectangular]";
            table.refuse_all(ground.is_none(), missing)?;
            ground.map(|(ground, _)| ground).ok_or(FaultRecorded)
        })
        .map_err(|faults| ScenarioErrors::placed((&source.text, &source.name), &[], faults))
    }

    /// Name of the table `[ground.<kind>]`.
    pub(crate) const fn kind(&self) -> &'static str {
        match self {
            Self::Pulse(pulse) => pulse.kind.name(),
            Self::Record(_) => RECORD,
        }
    }

    /// Motion under a gravity from 0.001 to 1000 m/s2.
    ///
    /// # Errors
    /// When gravity is outside that range.
    pub fn ground_motion(&self, gravity_m_s2: f64) -> Result<GroundMotion, ArgumentError> {
        argument::require_within("gravity_m_s2", gravity_m_s2, Request::GRAVITY_M_S2)?;
        Ok(self.ground_motion_under(gravity_m_s2))
    }

    /// Motion under the gravity of a scenario, whose range was checked.
    pub(super) fn ground_motion_under(&self, gravity_m_s2: f64) -> GroundMotion {
        match self {
            Self::Pulse(pulse) => pulse.ground_motion(gravity_m_s2),
            Self::Record(record) => record.ground_motion(gravity_m_s2),
        }
    }

    /// Reads `[ground]` and makes the motion. `[ground]` contains one table named after its kind, so that kinds may have different keys.
    pub(super) fn read(
        table: &mut Table<'_>,
        known: KnownRecords<'_>,
    ) -> ReadResult<(Self, GroundMotion)> {
        let mut found = None;
        for &kind in Pulse::ALL {
            let pulse = table.table(kind.name(), |table| PulseGround::read(table, kind, known));
            found = found.or(pulse.map(|(pulse, motion)| (Self::Pulse(pulse), motion)));
        }
        let record = table.table(RECORD, |table| Record::read(table, known));
        let kinds: Vec<_> = Pulse::ALL
            .iter()
            .map(|kind| kind.name())
            .chain([RECORD])
            .collect();
        table.apply_relations(&[OneOf(&kinds, None)])?;
        let record = record.map(|(record, motion)| (Self::Record(Box::new(record)), motion));
        found.or(record).ok_or(FaultRecorded)
    }
}

impl Scenario {
    /// Keys and values of `[ground]` that multiply all ground accelerations by a factor.
    pub(crate) fn ground_values_times(&self, factor: f64) -> Vec<(String, f64)> {
        let mut values = match &self.ground {
            None => Vec::new(),
            Some(Ground::Pulse(pulse)) => {
                let key = |name: &str| format!("ground.{}.{name}", pulse.kind.name());
                let amplitudes = [
                    ("amplitude_g", pulse.amplitude_g),
                    ("vertical_amplitude_g", pulse.vertical_amplitude_g),
                ];
                let moving = amplitudes.into_iter().filter(|(_, g)| *g != 0.0);
                moving.map(|(name, g)| (key(name), factor * g)).collect()
            }
            Some(Ground::Record(record)) => record.values_times("ground.record", factor),
        };
        if let Some(RightFoot::Record(record)) = &self.right_foot {
            values.extend(record.values_times("ground.right.record", factor));
        }
        values
    }
}

impl Serialize for Ground {
    /// Writes a table named after the kind.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Pulse(pulse) => serializer.collect_map([(self.kind(), pulse)]),
            Self::Record(record) => serializer.collect_map([(self.kind(), record)]),
        }
    }
}

/// A pulse of ground acceleration. Before and after the pulse the ground velocity is constant.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PulseGround {
    /// Shape of the pulse.
    #[serde(skip)]
    pub kind: Pulse,
    /// Peak acceleration in g, positive to the right, from -1000 to 1000.
    pub(crate) amplitude_g: f64,
    /// Peak of the vertical acceleration in g, positive upwards, from -1000 to 1000, with the same shape and timing. The ground must not
    /// accelerate downwards by 1 g or more.
    pub(crate) vertical_amplitude_g: f64,
    /// Duration in s of the part of the pulse to which its kind refers, from 1e-6 to 1e6.
    pub(crate) duration_s: f64,
    /// Start of the pulse in s, from 0 to 1e6.
    pub(crate) start_s: f64,
    /// Length of a wave train in periods, named gamma in most papers, above 1 and at most 100; `None` for other kinds.
    pub(crate) gamma: Option<f64>,
    /// Length of a windowed sine in periods, from 1 to 100; `None` for other kinds.
    pub(crate) cycles: Option<f64>,
    /// Phase of a wave train in degrees, from -360 to 360; `None` for other kinds.
    pub(crate) phase_deg: Option<f64>,
}

impl PulseGround {
    /// Pulse without its amplitudes.
    pub fn shape(&self) -> PulseShape {
        let default = WaveTrain::default();
        let train = WaveTrain {
            cycles: self.gamma.or(self.cycles).unwrap_or(default.cycles),
            phase_rad: self.phase_deg.map_or(default.phase_rad, f64::to_radians),
        };
        self.kind
            .lasting_s(self.duration_s)
            .starting_at_s(self.start_s)
            .with_train(train)
    }

    /// Ground motion under a gravity in m/s2.
    pub(crate) fn ground_motion(&self, gravity_m_s2: f64) -> GroundMotion {
        let amplitude_g = Vector2::new(self.amplitude_g, self.vertical_amplitude_g);
        self.shape()
            .inclined_m_s2(amplitude_g * gravity_m_s2)
            .expect(IN_RANGE)
    }

    fn read(
        table: &mut Table<'_>,
        kind: Pulse,
        known: KnownRecords<'_>,
    ) -> ReadResult<(Self, GroundMotion)> {
        let (is_train, periods) = (kind.is_wave_train(), WaveTrain::default().cycles);
        let has_cycles = kind == Pulse::WindowedSine;
        let pulse = Self {
            kind,
            amplitude_g: table.read_required("amplitude_g", &AMPLITUDE_G),
            vertical_amplitude_g: table.or("vertical_amplitude_g", &AMPLITUDE_G, 0.0),
            duration_s: table.read_required("duration_s", &DURATION_S),
            start_s: table.or("start_s", &within(&(0.0..=1e6)), 0.0),
            gamma: (is_train && !has_cycles).then(|| table.or("gamma", &GAMMA, periods)),
            cycles: has_cycles.then(|| table.or("cycles", &CYCLES, periods)),
            phase_deg: is_train.then(|| table.or("phase_deg", &within(&(-360.0..=360.0)), 0.0)),
        };
        table.check_faultless()?;
        // Free fall of the ground does not depend on gravity, whose value may be faulty.
        let gravity_m_s2 = known.1.unwrap_or(1.0);
        let motion = pulse.ground_motion(gravity_m_s2);
        match motion.free_fall_s(gravity_m_s2).filter(|_| !known.2) {
            None => Ok((pulse, motion)),
            Some(time_s) => Err(table.reject("vertical_amplitude_g", free_fall(time_s))),
        }
    }
}
