//! The parts of a history, for every model: samples, events and a summary.

use std::fmt;
use std::time::Duration;

use nalgebra::Vector2;
use serde::{Serialize, Serializer};

use super::thrust::ThrustRecord;
use crate::mechanics::chain::{Demand, Hinge};
use crate::mechanics::geometry::pose::Pose;
use crate::mechanics::lanes::Lanes;
use crate::mechanics::sway::Sway;
use crate::mechanics::tie::{Tie, TieMemory};

/// Outcome of a history.
///
/// A history is complete if the structure overturned, or if the ground is quiet for good and at most a quarter of the energy barrier is
/// left as energy above rest. The energy is the kinetic and potential energy beside the barrier of the first mechanism. Where that barrier
/// or the energy at rest is not known (joints that slipped, feet that move differently, ties, supports that have moved) it is the largest
/// kinetic energy of the last part of the history, beside the barrier of the structure as it was built, with rigid joints and without ties:
/// that of its first mechanism, else that of the part above a joint which overturns most easily as one block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// Nothing moved: no joint opened or slipped, and elastic joints did not vibrate. The history is complete.
    NeverMoved,
    /// Elastic joints vibrated, but no joint opened beyond its state at rest by more than the weight compresses a joint, and the structure
    /// did not slide. The history is complete.
    Vibrates,
    /// A joint opened or slipped, and the structure came to rest.
    Rest,
    /// Overturned, to this side: the structure passed the point from which gravity alone overturns it, and did not return.
    Overturned(Sway),
    /// Still moving at the end of a complete history: the structure survives, but has not come to rest.
    StillRocking,
    /// The history ended too early for a verdict: the ground still moved, or more than a quarter of the energy barrier was left. It
    /// counts neither as survived nor as overturned.
    Incomplete,
}

impl Outcome {
    /// The side to which the structure overturned.
    #[must_use]
    pub const fn overturning_sway(self) -> Option<Sway> {
        match self {
            Self::Overturned(sway) => Some(sway),
            _ => None,
        }
    }

    /// The name in machine-readable results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::NeverMoved => "never_moved",
            Self::Vibrates => "vibrates",
            Self::Rest => "rest",
            Self::Overturned(_) => "overturned",
            Self::StillRocking => "still_rocking",
            Self::Incomplete => "incomplete",
        }
    }
}

impl fmt::Display for Outcome {
    /// In words.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NeverMoved => "never moved",
            Self::Vibrates => "vibrated, and no joint opened",
            Self::Rest => "came to rest",
            Self::Overturned(Sway::Right) => "overturned to the right",
            Self::Overturned(Sway::Left) => "overturned to the left",
            Self::StillRocking => "still rocking",
            Self::Incomplete => "incomplete",
        })
    }
}

/// State of motion of a structure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum State {
    /// At rest, undeformed.
    #[default]
    Rest,
    /// Rocking, swayed to this side.
    Rocking(Sway),
    /// Overturned, to this side.
    Overturned(Sway),
}

impl State {
    /// The name in machine-readable results: `rest`, `right`, `left` or `overturned`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rest => "rest",
            Self::Rocking(sway) => sway.name(),
            Self::Overturned(_) => "overturned",
        }
    }

    /// The side to which it sways or has overturned.
    #[must_use]
    pub const fn sway(self) -> Option<Sway> {
        match self {
            Self::Rest => None,
            Self::Rocking(sway) | Self::Overturned(sway) => Some(sway),
        }
    }
}

impl Serialize for State {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// A hinge that is open, and where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpenHinge {
    /// Its place in the structure.
    pub hinge: Hinge,
    /// Its position now, in metres, relative to the ground.
    pub position_m: Vector2<f64>,
}

/// State of a structure at an instant of the output. Rotations are positive anticlockwise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sample {
    /// Time in seconds.
    pub time_s: f64,
    /// Ground acceleration, positive to +x.
    pub ground_acceleration_m_s2: f64,
    /// Vertical ground acceleration, positive upwards.
    pub vertical_acceleration_m_s2: f64,
    /// Displacement of the right foot relative to the left one, to the right and upwards in m; only if the feet move
    /// differently.
    pub feet_apart_m: Vector2<f64>,
    /// Events so far.
    pub phase: usize,
    /// Rest, rocking or overturned.
    pub state: State,
    /// Rotations of the bodies.
    pub rotations_rad: Vec<f64>,
    /// Rotation rates of the bodies.
    pub rates_rad_s: Vec<f64>,
    /// Poses of the bodies relative to the undeformed structure, in metres. The origin is the centre of a
    /// circular arch, the middle of a column's base.
    pub poses: Vec<Pose>,
    /// The hinges that are open, from left to right.
    pub hinges: Vec<OpenHinge>,
    /// Thrust excess and friction demand of the sections.
    pub demand: Demand,
    /// Kinetic and potential energy, in J.
    pub energy_j: f64,
    /// Kinetic and potential energy over the energy barrier of the mechanism that moves, or of the first mechanism of a row of blocks; `None` where
    /// no barrier is known.
    pub energy_ratio: Option<f64>,
    /// Rotation (anticlockwise) of the body that carries the coordinate, over its rotation at the unstable
    /// equilibrium of the mechanism that moves: below -1 or above 1 gravity overturns the structure. `None`
    /// where it is not known.
    pub rotation_over_critical: Option<f64>,
    /// Gaps of the joints at intrados and extrados, in m; only for a row of blocks.
    pub gaps_m: Vec<[f64; 2]>,
    /// Line of thrust: how far it lies towards the extrados from the middle of each joint, or of each section of
    /// `Arch::thrust_sections_rad`, over the thickness; `None`
    /// where there is no pressure. Empty unless a [`Recorder`](super::recorder::Recorder) wants it and the model knows it; elastic joints
    /// always give it.
    pub eccentricity_ratios: Vec<Option<f64>>,
    /// Offsets of the joints, in m, of the right face towards the extrados; only for a row whose joints slip.
    pub offsets_m: Vec<f64>,
    /// Forces and stresses of the joints; only for a row with elastic joints.
    pub pressures: Vec<JointPressure>,
    /// Forces and elongations of the ties; none without ties.
    pub ties: Vec<TieSample>,
}

/// Force and elongation of a tie at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TieSample {
    /// Tension, in N.
    pub force_n: f64,
    /// Lengthening from the undeformed structure, in m.
    pub elongation_m: f64,
    /// Whether it has broken.
    pub is_broken: bool,
}

impl TieSample {
    /// The state of a tie, from its memory.
    pub(in crate::dynamics) fn of(tie: &Tie, memory: &TieMemory<Lanes<1>>) -> Self {
        Self {
            force_n: memory.force_n.0[0],
            elongation_m: memory.stretch_m.0[0] - tie.prestress_n / tie.stiffness_n_m,
            is_broken: memory.is_broken(),
        }
    }
}

/// The largest force of a tie in a history, and its state at the end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct TieSummary {
    /// The largest force with which it pulled, in N; of a tie that breaks, also where it broke.
    pub peak_force_n: f64,
    /// When, in s.
    pub peak_force_time_s: f64,
    /// When it yielded first, in s, if it did.
    pub yielded_s: Option<f64>,
    /// When it broke, in s, if it did.
    pub broken_s: Option<f64>,
    /// Plastic lengthening, in m.
    pub yielded_m: f64,
    /// Tension at the end, in N.
    pub force_n: f64,
    /// Elastic energy in it at the end, in J.
    pub elastic_j: f64,
    /// Energy that it took as it yielded and broke, in J.
    pub taken_j: f64,
}

impl TieSummary {
    /// Of a tie at rest.
    pub(in crate::dynamics) fn at_rest(
        tie: &Tie,
        memory: &TieMemory<Lanes<1>>,
        time_s: f64,
    ) -> Self {
        Self {
            peak_force_n: memory.force_n.0[0],
            peak_force_time_s: time_s,
            yielded_m: memory.yielded_m.0[0],
            force_n: memory.force_n.0[0],
            elastic_j: memory.energy_j(tie).0[0],
            ..Self::default()
        }
    }

    /// Notes its force and state at a time; returns the events since the last time.
    pub(in crate::dynamics) fn note(
        &mut self,
        tie: &Tie,
        memory: &TieMemory<Lanes<1>>,
        time_s: f64,
    ) -> [Option<EventKind>; 2] {
        if memory.peak_n.0[0] > self.peak_force_n {
            self.peak_force_n = memory.peak_n.0[0];
            self.peak_force_time_s = time_s;
        }
        let yields = self.yielded_s.is_none() && memory.yielded_m.0[0] > self.yielded_m;
        let breaks = self.broken_s.is_none() && memory.is_broken();
        if yields {
            self.yielded_s = Some(time_s);
        }
        if breaks {
            self.broken_s = Some(time_s);
        }
        self.yielded_m = memory.yielded_m.0[0];
        self.force_n = memory.force_n.0[0];
        self.elastic_j = memory.energy_j(tie).0[0];
        self.taken_j = memory.taken_j.0[0];
        [
            yields.then_some(EventKind::TieYields),
            breaks.then_some(EventKind::TieBreaks),
        ]
    }
}

/// Forces and stresses of an elastic joint, by its elastic stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointPressure {
    /// Normal force, in N; compression is positive.
    pub normal_n: f64,
    /// Shear force, in N, positive where it keeps the right face from slipping towards the extrados.
    pub shear_n: f64,
    /// Distance of the normal force from the middle of the joint towards the extrados, over the length of the joint; `None` without contact.
    pub eccentricity_ratio: Option<f64>,
    /// Fraction of the joint in contact.
    pub contact_ratio: f64,
    /// Compressive stress at intrados and extrados, in Pa.
    pub edge_stresses_pa: [f64; 2],
}

impl Sample {
    /// Makes of this the sample of another instant, at rest, with the memory of its lists, which are empty.
    pub(super) fn begin(&mut self, time_s: f64, ground_m_s2: Vector2<f64>, phase: usize) {
        self.time_s = time_s;
        // Adding zero makes a negative zero positive.
        self.ground_acceleration_m_s2 = ground_m_s2.x + 0.0;
        self.vertical_acceleration_m_s2 = ground_m_s2.y + 0.0;
        self.feet_apart_m = Vector2::zeros();
        self.phase = phase;
        self.state = State::Rest;
        self.rotations_rad.clear();
        self.rates_rad_s.clear();
        self.poses.clear();
        self.hinges.clear();
        self.demand = Demand::default();
        self.gaps_m.clear();
        self.eccentricity_ratios.clear();
        self.offsets_m.clear();
        self.pressures.clear();
        self.ties.clear();
    }
}

named! {
    /// The kind of an event.
    pub enum EventKind {
        /// The structure starts to move from rest.
        Uplift = "uplift",
        /// Hinges close, and others open.
        Impact = "impact",
        /// Hinges close, and the structure comes to rest.
        Rest = "rest",
        /// The structure has overturned.
        Overturned = "overturned",
        /// A tie yields for the first time.
        TieYields = "tie_yields",
        /// A tie breaks.
        TieBreaks = "tie_breaks",
    }
}

/// An event of a history, and the state just after.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Event {
    /// Instant in seconds.
    pub time_s: f64,
    /// The kind of the event.
    pub kind: EventKind,
    /// Rest, rocking or overturned, from here on.
    pub state: State,
    /// Impacts since uplift, which is the index of its mechanism; `None` at rest, and for a row of blocks.
    pub mechanism: Option<usize>,
    /// Rotations of the bodies.
    pub rotations_rad: Vec<f64>,
    /// Rotation rates of the bodies just after.
    pub rates_rad_s: Vec<f64>,
    /// Kinetic and potential energy just after, in J.
    pub energy_j: f64,
    /// Hinges of its mechanism from left to right; none at rest. For a row of blocks, the joints that are open or open
    /// at this instant, including those left open at rest.
    pub hinges: Vec<Hinge>,
    /// The impact, if the event is one, also if it leads to rest.
    pub impact: Option<Impact>,
    /// The tie, where the event is one of a tie, from 0 on.
    pub tie: Option<usize>,
}

impl Event {
    /// An event of which nothing else is known: all lists are empty.
    pub(super) const fn new(time_s: f64, kind: EventKind, state: State) -> Self {
        Self {
            time_s,
            kind,
            state,
            mechanism: None,
            rotations_rad: Vec::new(),
            rates_rad_s: Vec::new(),
            energy_j: 0.0,
            hinges: Vec::new(),
            impact: None,
            tie: None,
        }
    }

    /// Memory that it takes.
    pub(super) fn bytes(&self) -> u64 {
        let impact = self.impact.as_ref().map_or(0, |impact| {
            size_of_val(&impact.rates_before_rad_s[..])
                + size_of_val(&impact.rates_after_rad_s[..])
                + size_of_val(&impact.closed[..])
                + size_of_val(&impact.opened[..])
                + size_of_val(&impact.impulses_n_s[..])
        });
        let own = size_of_val(&self.rotations_rad[..])
            + size_of_val(&self.rates_rad_s[..])
            + size_of_val(&self.hinges[..]);
        (size_of::<Self>() + own + impact) as u64
    }
}

/// An impact: hinges that close, others that open, and the energy that is lost.
///
/// The mechanism after is the one that the impact leads to, with its rates just after, even where these are so
/// small that the structure comes to rest.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Impact {
    /// Sway of the mechanism that closed.
    pub sway_before: Sway,
    /// Kinetic energy after the impact over that before it; 0 where no mechanism can follow.
    pub restitution: f64,
    /// Kinetic energy before, in J.
    pub energy_before_j: f64,
    /// Kinetic energy after, in J.
    pub energy_after_j: f64,
    /// The part of the loss that friction took, in J, if joints slip.
    pub friction_j: Option<f64>,
    /// Rotation rates of the bodies just before; empty for a row of blocks.
    pub rates_before_rad_s: Vec<f64>,
    /// Rotation rates of the bodies of the mechanism after.
    pub rates_after_rad_s: Vec<f64>,
    /// The hinges that closed, from left to right.
    pub closed: Vec<Hinge>,
    /// The hinges that opened, from left to right; none where no mechanism can follow.
    pub opened: Vec<Hinge>,
    /// Impulses at the hinges that opened, on the part towards the crown, in N s; none where they are not known.
    pub impulses_n_s: Vec<Vector2<f64>>,
}

impl Impact {
    /// Sway of the mechanism that opened.
    #[must_use]
    pub const fn sway_after(&self) -> Sway {
        self.sway_before.opposite()
    }
}

/// Half cycles that peak below this fraction of the largest peak are not reported.
const LEAST_PEAK_RATIO: f64 = 1e-3;

/// Summary of a history.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Its outcome.
    pub outcome: Outcome,
    /// When: the last outward passage of the unstable equilibrium, the last time it came to rest, or else the end of
    /// the history.
    pub outcome_time_s: f64,
    /// When the simulation ended.
    pub end_s: f64,
    /// Number of impacts.
    pub impacts: usize,
    /// Largest magnitudes of the rotations of the bodies.
    pub peak_rotations_rad: Vec<f64>,
    /// Largest difference between the energy of the structure and its initial energy plus the work of the
    /// ground minus the losses at impacts, over the energy barrier of the first mechanism; for a row of
    /// blocks, over its weight times its size.
    pub energy_defect_ratio: f64,
    /// The demands over all samples, if any were made; for a mechanism that overturns, over those before it
    /// passes the unstable equilibrium for the last time.
    pub thrust: Option<ThrustRecord>,
    /// Work done.
    pub cost: Cost,
    /// Results that only one kind of model has.
    pub details: Details,
}

/// Results that only one kind of model has.
#[derive(Clone, Debug, PartialEq)]
pub enum Details {
    /// Summary of four links or of a column.
    Mechanisms {
        /// Largest rotation over that at the unstable equilibrium of the mechanism that moved: from 1 on, gravity alone overturns.
        peak_over_critical: f64,
    },
    /// Summary of a row of blocks with rigid joints.
    Rigid(Box<RowSummary>),
    /// Summary of a row of blocks with elastic joints.
    Elastic(Box<RowSummary>, ElasticSummary),
}

impl Summary {
    /// Results of a row of blocks; `None` for mechanisms.
    #[must_use]
    pub const fn row(&self) -> Option<&RowSummary> {
        match &self.details {
            Details::Mechanisms { .. } => None,
            Details::Rigid(row) | Details::Elastic(row, _) => Some(row),
        }
    }

    /// Results of elastic joints; `None` for other models.
    #[must_use]
    pub const fn elastic(&self) -> Option<&ElasticSummary> {
        match &self.details {
            Details::Elastic(_, elastic) => Some(elastic),
            Details::Mechanisms { .. } | Details::Rigid(_) => None,
        }
    }

    /// Largest rotation over that at the unstable equilibrium of the mechanism that moved; `None` for rows of blocks.
    #[must_use]
    pub const fn peak_over_critical(&self) -> Option<f64> {
        match self.details {
            Details::Mechanisms { peak_over_critical } => Some(peak_over_critical),
            Details::Rigid(_) | Details::Elastic(..) => None,
        }
    }

    /// Largest potential energy over the barrier of the first mechanism, as of [`RowSummary`]; `None` for mechanisms.
    #[must_use]
    pub fn peak_potential_over_barrier(&self) -> Option<f64> {
        self.row()?.peak_potential_over_barrier
    }

    /// Largest magnitude of the rotation of any body, in radians.
    #[must_use]
    pub fn largest_rotation_rad(&self) -> f64 {
        self.peak_rotations_rad.iter().copied().fold(0.0, f64::max)
    }

    /// Index of the body that turns most; the last one, if several do.
    #[must_use]
    pub fn largest_body(&self) -> usize {
        let most_rad = self.largest_rotation_rad();
        let mut peaks_rad = self.peak_rotations_rad.iter();
        let last = peaks_rad.rposition(|peak_rad| *peak_rad == most_rad);
        last.unwrap_or(0)
    }

    /// Number of impacts; `None` for elastic joints, whose contact lasts.
    #[must_use]
    pub fn known_impacts(&self) -> Option<usize> {
        self.elastic().is_none().then_some(self.impacts)
    }

    /// When it overturned, in seconds; `None` where it did not.
    #[must_use]
    pub fn overturned_s(&self) -> Option<f64> {
        matches!(self.outcome, Outcome::Overturned(_)).then_some(self.outcome_time_s)
    }

    /// Half cycles of a row of blocks that peak at a thousandth of the largest peak or more; empty for other structures. Smaller ones
    /// are vibration and rattling, of which a motion has any number.
    #[must_use]
    pub fn half_cycles(&self) -> Vec<HalfCycle> {
        let all = self.row().map_or(&[][..], |row| &row.half_cycles);
        let peaks_rad = all.iter().map(|cycle| cycle.peak_rad);
        let least_rad = LEAST_PEAK_RATIO * peaks_rad.fold(0.0, f64::max);
        let counts = |cycle: &&HalfCycle| cycle.peak_rad >= least_rad;
        all.iter().filter(counts).copied().collect()
    }
}

/// Work done for a history.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Evaluations of the right-hand side; for a row of blocks, systems of equations that were solved.
    pub evaluations: u64,
    /// Accepted steps.
    pub steps: u64,
}

/// Additional summary of a row of blocks.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RowSummary {
    /// All half cycles, however small; [`Summary::half_cycles`] omits those that are no rocking.
    #[serde(skip)]
    pub half_cycles: Vec<HalfCycle>,
    /// Number of half cycles, with those of the fall after the row has overturned.
    #[serde(skip)]
    pub half_cycles_with_fall: usize,
    /// Slip; `None` where joints do not slip.
    #[serde(flatten)]
    pub sliding: Option<Sliding>,
    /// Largest potential energy over the barrier of its first mechanism, which may not be the one by which it overturns. `None` where no
    /// barrier is known, or if joints slipped so far that friction took a hundredth of it.
    pub peak_potential_over_barrier: Option<f64>,
    /// Forces and energies of its ties; absent without ties.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub ties: Vec<TieSummary>,
    /// Largest kinetic energy at the end of a step, in J.
    pub largest_kinetic_j: f64,
    /// Largest potential energy above rest, in J, with that of elastic joints.
    pub largest_potential_j: f64,
    /// Energy taken by impacts, in J, without what friction takes; with elastic joints, all that damping, friction and crushing
    /// took.
    pub energy_taken_j: f64,
    /// Work of the moving ground, in J; of feet that move differently, of the ground under the left one, on all that rides on it.
    pub ground_j: f64,
    /// Work of the right foot as it goes away from the left one, in J.
    pub right_foot_j: f64,
    /// Error of the energy balance, over the larger of the largest kinetic energy and the barrier, where that is known.
    #[serde(rename = "energy_defect_over_largest")]
    pub energy_error: f64,
    /// Least normal force at a joint outside impacts, in N; infinite without any step, and with elastic joints, and then absent from results.
    #[serde(skip_serializing_if = "is_infinite")]
    pub least_normal_n: f64,
    /// Largest error of closure of an arch, in m.
    pub closure_error_m: f64,
    /// The longest step that was allowed, in seconds.
    pub longest_step_s: f64,
    /// The time within which landings count as crowded, in seconds.
    pub shortest_step_s: f64,
    /// Programs solved.
    pub programs: u64,
    /// Most systems of equations in one step.
    pub most_iterations: u64,
    /// Number of times that the tolerance of a program was relaxed.
    pub relaxed: u64,
    /// Steps with more than one landing, or with landings too close to end at.
    pub merged: u64,
    /// Number of times that the longest step was halved to balance the energy.
    #[serde(rename = "step_halvings")]
    pub halvings: u32,
    /// Time that the longest step took to compute, where samples are made.
    #[serde(skip)]
    pub longest_step: Elapsed,
}

const fn is_infinite(number: &f64) -> bool {
    number.is_infinite()
}

/// A half cycle: from one passage of the centre of gravity through its undeformed place to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct HalfCycle {
    /// To which side.
    pub sway: Sway,
    /// When it began, in seconds.
    pub start_s: f64,
    /// Duration in seconds; of the last one, until the motion ended.
    pub duration_s: f64,
    /// Largest rotation of a block, in radians.
    pub peak_rad: f64,
    /// When that was first reached, in seconds.
    pub peak_time_s: f64,
    /// Energy at its end over that at its beginning; unknown for the first and the last one.
    pub energy_ratio: Option<f64>,
}

impl HalfCycle {
    /// When it ended, in seconds.
    #[must_use]
    pub fn end_s(&self) -> f64 {
        self.start_s + self.duration_s
    }

    /// The half cycle of another motion that corresponds to this one: to the same side, at least partly at the same time, and with
    /// the nearest peak in time; `None` if there is none.
    #[must_use]
    pub fn counterpart<'a>(&self, others: &'a [Self]) -> Option<&'a Self> {
        let coincides = |other: &&Self| {
            other.sway == self.sway
                && other.start_s <= self.end_s()
                && self.start_s <= other.end_s()
        };
        let apart_s = |other: &&Self| (other.peak_time_s - self.peak_time_s).abs();
        let others = others.iter().filter(coincides);
        others.min_by(|one, other| apart_s(one).total_cmp(&apart_s(other)))
    }
}

/// The slip in a motion.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Sliding {
    /// Energy that friction took, in J.
    pub friction_j: f64,
    /// Offsets at the end: of the right face of every joint towards the extrados, in metres.
    #[serde(rename = "slips_m")]
    pub offsets_m: Vec<f64>,
    /// Largest magnitudes of the offsets, in metres.
    #[serde(rename = "largest_slips_m")]
    pub largest_offsets_m: Vec<f64>,
    /// Steps whose bounds of friction did not converge; none with elastic joints, whose bounds are known in every step.
    #[serde(rename = "unconverged_steps")]
    pub unconverged: u64,
    /// The largest error of such a bound, as a fraction of the largest bound.
    #[serde(rename = "friction_bound_error")]
    pub bound_error: f64,
}

impl Sliding {
    /// Nothing has slipped.
    #[must_use]
    pub fn none(joints: usize) -> Self {
        Self {
            offsets_m: vec![0.0; joints],
            largest_offsets_m: vec![0.0; joints],
            ..Self::default()
        }
    }
}

/// Additional summary of a motion with elastic joints; energies are totals from the beginning to the end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ElasticSummary {
    /// The largest elastic compressive stress; damping adds to it, and the strength caps both together.
    #[serde(flatten)]
    pub largest_stress: Stress,
    /// Elastic energy at the end, in J.
    pub elastic_j: f64,
    /// Energy that damping took, in J.
    pub damped_j: f64,
    /// Energy that friction took, in J.
    pub friction_j: f64,
    /// Energy that crushing took, in J.
    pub crushed_j: f64,
    /// Energy that ties took as they yielded and broke, in J.
    pub ties_j: f64,
    /// Distance of the thrust from the middle of the worst joint at rest before the motion, over the length of the joint.
    pub rest_eccentricity_ratio: f64,
    /// Index of that joint.
    pub rest_eccentricity_joint: usize,
}

/// A largest compressive stress, with its place and time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Stress {
    /// The largest elastic compressive stress, in Pa; damping adds to it, and the strength caps both together.
    #[serde(rename = "largest_compressive_stress_pa")]
    pub stress_pa: f64,
    /// The joint at whose edge it was.
    #[serde(rename = "largest_compressive_stress_joint")]
    pub joint: usize,
    /// When, in seconds.
    #[serde(rename = "largest_compressive_stress_time_s")]
    pub time_s: f64,
}

/// Time that a computation took; `None` where it was not measured. It is no part of a result: any two are equal.
#[derive(Clone, Copy, Debug, Default)]
pub struct Elapsed(pub Option<Duration>);

impl PartialEq for Elapsed {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}
