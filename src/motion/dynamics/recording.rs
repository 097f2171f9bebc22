//! Histories in memory, with all samples and events of a motion.

use std::ops::ControlFlow;

use nalgebra::Vector2;
use thiserror::Error;

use super::history::{Impact, JointPressure};
use super::recorder::Recorder;
use crate::dynamics::{Event, OpenHinge, Sample, State, Summary, TieSample};
use crate::mechanics::{Demand, Pose};

/// History with all its samples and events.
#[derive(Clone, Debug, PartialEq)]
pub struct History {
    /// Names of the bodies, as in [`Model::bodies`](super::model::Model::bodies).
    pub bodies: Vec<String>,
    /// Summary of the history.
    pub summary: Summary,
    /// Samples at every output step and at the end.
    pub samples: Samples,
    /// All events; event `i` begins phase `i + 1`.
    pub events: Vec<Event>,
}

impl History {
    /// Impacts, with their times in seconds.
    pub fn impacts(&self) -> impl Iterator<Item = (f64, &Impact)> {
        let events = self.events.iter();
        events.filter_map(|event| Some((event.time_s, event.impact.as_ref()?)))
    }
}

/// Samples of a history as columns with one entry per sample, without thrust lines. Columns by body have one entry per body and sample, sample by
/// sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Samples {
    /// Times, in seconds.
    pub time_s: Vec<f64>,
    /// Ground accelerations, positive to +x.
    pub ground_acceleration_m_s2: Vec<f64>,
    /// Vertical ground accelerations, positive upwards.
    pub vertical_acceleration_m_s2: Vec<f64>,
    /// Displacement of the right foot relative to the left one, to the right and upwards, in m.
    pub feet_apart_m: Vec<[f64; 2]>,
    /// Number of transitions up to each sample. Those of a fall count, although they are not reported as events.
    pub phase: Vec<usize>,
    /// Rest, rocking or overturned.
    pub state: Vec<State>,
    /// Rotations, by body.
    pub rotations_rad: Vec<f64>,
    /// Rotation rates, by body.
    pub rates_rad_s: Vec<f64>,
    /// Poses by body: rotation in radians and displacement in metres, to the right and upwards; see [`Pose`].
    pub poses: Vec<[f64; 3]>,
    /// Open hinges: those of sample `i` are from `first_hinge[i]` up to `first_hinge[i + 1]`, or the end.
    pub hinges: Vec<OpenHinge>,
    /// Index of the first hinge of each sample.
    pub first_hinge: Vec<usize>,
    /// Thrust excess and friction demand of the sections.
    pub demand: Vec<Demand>,
    /// Kinetic and potential energies, in J.
    pub energy_j: Vec<f64>,
    /// Energies over the barrier of the moving mechanism; `None` if unknown.
    pub energy_ratio: Vec<Option<f64>>,
    /// Rotations over the critical rotation; `None` if unknown.
    pub rotation_over_critical: Vec<Option<f64>>,
    /// Gaps of the joints at intrados and extrados, in m, joint by joint; only for a row of blocks.
    pub gaps_m: Vec<[f64; 2]>,
    /// Offsets of the joints, in m, joint by joint; only for a row whose joints slip.
    pub offsets_m: Vec<f64>,
    /// Forces and stresses of the joints, joint by joint; only for a row with elastic joints.
    pub pressures: Vec<JointPressure>,
    /// Forces and elongations of the ties, tie by tie.
    pub ties: Vec<TieSample>,
}

impl Samples {
    /// Number of samples.
    pub const fn len(&self) -> usize {
        self.time_s.len()
    }

    /// Whether there are no samples.
    pub const fn is_empty(&self) -> bool {
        self.time_s.is_empty()
    }

    /// Adds a sample.
    pub fn push(&mut self, sample: &Sample) {
        self.time_s.push(sample.time_s);
        self.ground_acceleration_m_s2
            .push(sample.ground_acceleration_m_s2);
        self.vertical_acceleration_m_s2
            .push(sample.vertical_acceleration_m_s2);
        self.feet_apart_m.push(sample.feet_apart_m.into());
        self.phase.push(sample.phase);
        self.state.push(sample.state);
        self.rotations_rad.extend(&sample.rotations_rad);
        self.rates_rad_s.extend(&sample.rates_rad_s);
        let poses = sample.poses.iter();
        self.poses.extend(
            poses.map(|pose| [pose.rotation_rad(), pose.translation.x, pose.translation.y]),
        );
        self.first_hinge.push(self.hinges.len());
        self.hinges.extend(&sample.hinges);
        self.demand.push(sample.demand);
        self.energy_j.push(sample.energy_j);
        self.energy_ratio.push(sample.energy_ratio);
        self.gaps_m.extend(&sample.gaps_m);
        self.offsets_m.extend(&sample.offsets_m);
        self.pressures.extend(&sample.pressures);
        self.ties.extend(&sample.ties);
        self.rotation_over_critical
            .push(sample.rotation_over_critical);
    }

    /// Sample; `None` beyond the last.
    pub fn get(&self, index: usize) -> Option<Sample> {
        let time_s = *self.time_s.get(index)?;
        let samples = self.len();
        let hinges_end = self.first_hinge.get(index + 1).copied();
        let hinges = *self.first_hinge.get(index)?..hinges_end.unwrap_or(self.hinges.len());
        Some(Sample {
            time_s,
            ground_acceleration_m_s2: *self.ground_acceleration_m_s2.get(index)?,
            vertical_acceleration_m_s2: *self.vertical_acceleration_m_s2.get(index)?,
            feet_apart_m: (*self.feet_apart_m.get(index)?).into(),
            phase: *self.phase.get(index)?,
            state: *self.state.get(index)?,
            rotations_rad: part(&self.rotations_rad, index, samples),
            rates_rad_s: part(&self.rates_rad_s, index, samples),
            poses: part(&self.poses, index, samples).iter().map(pose).collect(),
            hinges: self.hinges.get(hinges)?.to_vec(),
            demand: *self.demand.get(index)?,
            energy_j: *self.energy_j.get(index)?,
            energy_ratio: *self.energy_ratio.get(index)?,
            rotation_over_critical: *self.rotation_over_critical.get(index)?,
            gaps_m: part(&self.gaps_m, index, samples),
            eccentricity_ratios: Vec::new(),
            offsets_m: part(&self.offsets_m, index, samples),
            pressures: part(&self.pressures, index, samples),
            ties: part(&self.ties, index, samples),
        })
    }

    /// All samples in their order.
    pub fn iter(&self) -> impl Iterator<Item = Sample> {
        (0..self.len()).map_while(|index| self.get(index))
    }
}

/// Part of a column that belongs to sample `index`; `samples` is the number of samples.
fn part<T: Clone>(column: &[T], index: usize, samples: usize) -> Vec<T> {
    let each = column.len() / samples;
    column[index * each..(index + 1) * each].to_vec()
}

/// Pose of an entry of [`Samples::poses`].
fn pose(&[rotation_rad, x_m, y_m]: &[f64; 3]) -> Pose {
    Pose::new(rotation_rad, Vector2::new(x_m, y_m))
}

/// Default limit of the memory of a history, in bytes.
pub const MEMORY_BYTES: u64 = 4_000_000_000;

/// Error if a history needs more memory than allowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error(
    "a history of so many samples and events takes {} of memory, and {} are allowed: take a longer output_step_s or a \
     shorter duration_s, or allow more",
    size_in_words(*.needed_bytes), size_in_words(*.allowed_bytes)
)]
pub struct MemoryError {
    /// Total memory needed, or memory needed up to the failure, in bytes.
    pub needed_bytes: u64,
    /// Allowed memory, in bytes.
    pub allowed_bytes: u64,
}

/// Size in readable units.
fn size_in_words(bytes: u64) -> String {
    let megabytes = bytes as f64 / 1e6;
    if megabytes < 1e3 {
        format!("{megabytes:.1} MB")
    } else {
        format!("{:.1} GB", megabytes / 1e3)
    }
}

/// Recorder that collects all samples and events within a limit of memory.
#[derive(Clone, Debug)]
pub struct Recording {
    samples: Samples,
    events: Vec<Event>,
    /// Memory of all samples and of the events up to now.
    memory: MemoryError,
}

impl Recording {
    /// Recorder for samples of at most `needed_bytes` of memory, see [`Model::sample_bytes`](super::model::Model::sample_bytes).
    /// `allowed_bytes` is the limit of memory for samples and events.
    ///
    /// # Errors
    /// If the samples alone may need more.
    pub fn new(needed_bytes: u64, allowed_bytes: u64) -> Result<Self, MemoryError> {
        let recording = Self {
            samples: Samples::default(),
            events: Vec::new(),
            memory: MemoryError {
                needed_bytes,
                allowed_bytes,
            },
        };
        recording.check()?;
        Ok(recording)
    }

    const fn check(&self) -> Result<(), MemoryError> {
        if self.memory.needed_bytes > self.memory.allowed_bytes {
            return Err(self.memory);
        }
        Ok(())
    }

    /// All samples and events.
    ///
    /// # Errors
    /// If they needed too much memory, which ended the history.
    pub fn finish(self) -> Result<(Samples, Vec<Event>), MemoryError> {
        self.check()?;
        Ok((self.samples, self.events))
    }
}

impl Recorder for Recording {
    fn sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        self.samples.push(sample);
        ControlFlow::Continue(())
    }

    fn event(&mut self, event: &Event) -> ControlFlow<()> {
        self.memory.needed_bytes += event.bytes();
        if self.check().is_err() {
            return ControlFlow::Break(());
        }
        self.events.push(event.clone());
        ControlFlow::Continue(())
    }
}
