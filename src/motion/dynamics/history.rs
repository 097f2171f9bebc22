//! Parts of a history, for all models: samples, events and a summary.

use std::fmt;
use std::time::Duration;

use nalgebra::Vector2;
use serde::{Deserialize, Serialize, Serializer};

use crate::dynamics::{FrictionRecord, ThrustRecord};
use crate::mechanics::{Demand, Hinge, Lanes, Pose, Sides, Sway, Tie, TieMemory};

/// Outcome of a history.
///
/// A history is complete if the structure has overturned. It is also complete if the ground is quiet from then on, and the remaining energy above
/// rest is at most a quarter of the energy barrier. The energy is kinetic plus potential energy, the barrier that of the first mechanism. A history of
/// four links, or of a column of one block, is also complete on quiet ground if the energy is below the barriers of the moving mechanism and of all that
/// may follow it: [such a structure cannot overturn](crate::mechanics::MechanismChain::least_barrier_from).
///
/// The barrier of a row or its energy at rest may be unknown: for joints that have slipped, feet that move differently, ties, and moved supports. The
/// criterion then compares the largest kinetic energy of the last part of the history with the barrier of the undeformed structure with rigid joints and
/// without ties. That is the barrier of the first mechanism if known, otherwise the least barrier to overturn the part above a joint as one block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Outcome {
    /// Nothing moved: no joint opened or slipped, and the kinetic energy of elastic joints stayed below 1e-9 of weight times size. They may have
    /// followed the ground slowly, without vibration, and turned a little. The history is complete.
    NeverMoved,
    /// Elastic joints vibrated, but no joint opened beyond its state at rest by more than the weight compresses a joint, and the structure
    /// did not slide. The history is complete.
    Vibrates,
    /// A joint opened or slipped, and the structure came to rest.
    Rest,
    /// The structure overturned to this side: it passed the position from which gravity alone overturns it, and did not return.
    Overturned(Sway),
    /// Still moving at the end of a complete history: the structure survives, but has not come to rest.
    StillRocking,
    /// The history ended too early to decide: the ground still moved, or so much energy was left that the structure may overturn. It counts neither
    /// as survived nor as overturned.
    Incomplete,
}

impl Outcome {
    /// Side to which the structure overturned; `None` if it did not.
    pub const fn overturning_sway(self) -> Option<Sway> {
        match self {
            Self::Overturned(sway) => Some(sway),
            _ => None,
        }
    }

    /// Outcome without the side of overturning.
    pub const fn kind(self) -> OutcomeKind {
        match self {
            Self::NeverMoved => OutcomeKind::NeverMoved,
            Self::Vibrates => OutcomeKind::Vibrates,
            Self::Rest => OutcomeKind::Rest,
            Self::Overturned(_) => OutcomeKind::Overturned,
            Self::StillRocking => OutcomeKind::StillRocking,
            Self::Incomplete => OutcomeKind::Incomplete,
        }
    }

    /// Name in machine-readable results.
    pub const fn name(self) -> &'static str {
        self.kind().name()
    }
}

named! {
    /// [`Outcome`] without the side of overturning.
    pub enum OutcomeKind {
        /// [`Outcome::NeverMoved`].
        NeverMoved = "never_moved",
        /// [`Outcome::Vibrates`].
        Vibrates = "vibrates",
        /// [`Outcome::Rest`].
        Rest = "rest",
        /// [`Outcome::Overturned`].
        Overturned = "overturned",
        /// [`Outcome::StillRocking`].
        StillRocking = "still_rocking",
        /// [`Outcome::Incomplete`].
        Incomplete = "incomplete",
    }
}

impl OutcomeKind {
    /// Outcome, with the side to which the structure overturned.
    pub fn to_outcome(self, sway: Option<Sway>) -> Outcome {
        match self {
            Self::NeverMoved => Outcome::NeverMoved,
            Self::Vibrates => Outcome::Vibrates,
            Self::Rest => Outcome::Rest,
            Self::Overturned => Outcome::Overturned(sway.unwrap_or_default()),
            Self::StillRocking => Outcome::StillRocking,
            Self::Incomplete => Outcome::Incomplete,
        }
    }
}

impl fmt::Display for Outcome {
    /// Writes the outcome in words.
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
    /// Rocking, with the sway to this side.
    Rocking(Sway),
    /// Overturned, to this side.
    Overturned(Sway),
}

impl State {
    /// Name in machine-readable results: `rest`, `right`, `left` or `overturned`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rest => "rest",
            Self::Rocking(sway) => sway.name(),
            Self::Overturned(_) => "overturned",
        }
    }

    /// Side to which the structure sways or has overturned; `None` at rest.
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

/// Open hinge, with its current position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpenHinge {
    /// Joint or section of the hinge.
    pub hinge: Hinge,
    /// Current position, in metres, relative to the ground.
    pub position_m: Vector2<f64>,
}

/// State of a structure at an output time. Rotations are positive anticlockwise.
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
    /// Number of transitions up to this time. Those of a fall count, although they are not reported as events.
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
    /// Kinetic and potential energy over the energy barrier of the moving mechanism, or of the first mechanism of a row of blocks; `None` if the
    /// barrier is unknown.
    pub energy_ratio: Option<f64>,
    /// Rotation (anticlockwise) of the body that carries the coordinate, over its rotation at the unstable equilibrium of the moving mechanism. Below
    /// -1 or above 1 gravity overturns the structure. `None` if unknown.
    pub rotation_over_critical: Option<f64>,
    /// Gaps of the joints at intrados and extrados, in m; only for a row of blocks.
    pub gaps_m: Vec<[f64; 2]>,
    /// Thrust line: eccentricity towards the extrados in each joint, or in each section of `Arch::thrust_sections_rad`, over the thickness. `None`
    /// for a joint without compression. Empty unless a [`Recorder`](super::recorder::Recorder) wants it and the model can compute it; always given
    /// for elastic joints.
    pub eccentricity_ratios: Vec<Option<f64>>,
    /// Offsets of the joints, in m, of the right face towards the extrados; only for a row whose joints slip.
    pub offsets_m: Vec<f64>,
    /// Forces and stresses of the joints; only for a row with elastic joints.
    pub pressures: Vec<JointPressure>,
    /// Forces and elongations of the ties; empty without ties.
    pub ties: Vec<TieSample>,
}

/// Force and elongation of a tie at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TieSample {
    /// Tension, in N.
    pub force_n: f64,
    /// Lengthening from the undeformed structure, in m.
    pub elongation_m: f64,
    /// True once the tie has broken.
    pub is_broken: bool,
}

impl TieSample {
    /// Sample of a tie in a given state.
    pub(in crate::dynamics) fn of(tie: &Tie, memory: &TieMemory<Lanes<1>>) -> Self {
        Self {
            force_n: memory.force_n.0[0],
            elongation_m: memory.stretch_m.0[0] - tie.prestress_n / tie.stiffness_n_m,
            is_broken: memory.is_broken(),
        }
    }
}

/// Largest force of a tie in a history, and its state at the end, or at overturning.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TieSummary {
    /// Largest tension, in N, including the tension at which the tie breaks.
    pub peak_force_n: f64,
    /// Time of the largest tension, in s.
    pub peak_force_time_s: f64,
    /// Time of the first yield, in s; `None` if the tie does not yield.
    pub yielded_s: Option<f64>,
    /// Time of the break, in s; `None` if the tie does not break.
    pub broken_s: Option<f64>,
    /// Plastic elongation at the end or at overturning, in m.
    pub yielded_m: f64,
    /// Tension at the end or at overturning, in N.
    pub force_n: f64,
    /// Elastic energy of the tie at the end or at overturning, in J.
    pub elastic_j: f64,
    /// Energy dissipated by yield and break, in J.
    pub taken_j: f64,
}

impl TieSummary {
    /// Summary of a tie at rest.
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

    /// Records force and state of the tie at a time; returns the events since the last call.
    pub(in crate::dynamics) fn record_state(
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

/// Forces and stresses of an elastic joint, without damping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointPressure {
    /// Normal force, in N; compression is positive.
    pub normal_n: f64,
    /// Shear force, in N, positive if it prevents the right face from slipping towards the extrados.
    pub shear_n: f64,
    /// Eccentricity of the normal force towards the extrados, over the length of the joint; `None` without contact.
    pub eccentricity_ratio: Option<f64>,
    /// Fraction of the joint in contact.
    pub contact_ratio: f64,
    /// Compressive stress at intrados and extrados, in Pa.
    pub edge_stresses_pa: [f64; 2],
}

impl Sample {
    /// Resets this sample to a state of rest at another time. All lists are empty and keep their memory.
    pub(super) fn reset_to_rest(&mut self, time_s: f64, ground_m_s2: Vector2<f64>, phase: usize) {
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
    /// Kind of an event.
    #[non_exhaustive]
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

/// Event of a history, with the state just after it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Event {
    /// Time in seconds.
    pub time_s: f64,
    /// Kind of the event.
    pub kind: EventKind,
    /// State from here on: in files `rest`, `right`, `left` or `overturned`.
    pub state: State,
    /// Number of impacts since uplift, which is the index of the mechanism; `None` at rest, and for a row of blocks.
    pub mechanism: Option<usize>,
    /// Rotations of the bodies.
    pub rotations_rad: Vec<f64>,
    /// Rotation rates of the bodies just after.
    pub rates_rad_s: Vec<f64>,
    /// Kinetic and potential energy just after, in J.
    pub energy_j: f64,
    /// Hinges of the mechanism from left to right; empty at rest. For a row of blocks: all open joints and those that open at this time, also at
    /// rest.
    pub hinges: Vec<Hinge>,
    /// Impact; `None` for other events. An impact may lead to rest.
    pub impact: Option<Impact>,
    /// Index of the tie, from 0 (tables of a run count from 1); `None` for events without a tie.
    pub tie: Option<usize>,
}

impl Event {
    /// Event with empty lists.
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

    /// Event of rest with the state of a sample.
    pub(super) fn of_sample(sample: &Sample) -> Self {
        Self {
            rotations_rad: sample.rotations_rad.clone(),
            rates_rad_s: sample.rates_rad_s.clone(),
            energy_j: sample.energy_j,
            hinges: sample.hinges.iter().map(|open| open.hinge).collect(),
            ..Self::new(sample.time_s, EventKind::Rest, State::Rest)
        }
    }

    /// Memory of the event, in bytes.
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

/// Impact: hinges that close, others that open, and the dissipated energy.
///
/// The rates after the impact are those of the new mechanism, even if they are so small that the structure comes to rest.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Impact {
    /// Sway of the mechanism that closed.
    pub sway_before: Sway,
    /// True if the structure strikes a wall behind it, and leaves to the side from which it came.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub strikes_wall: bool,
    /// Kinetic energy after the impact over that before it; 0 if no mechanism can follow.
    pub restitution: f64,
    /// Kinetic energy before, in J.
    pub energy_before_j: f64,
    /// Kinetic energy after, in J.
    pub energy_after_j: f64,
    /// Part of the loss dissipated by friction, in J; `None` if joints do not slip.
    pub friction_j: Option<f64>,
    /// Rotation rates of the bodies just before; empty for a row of blocks.
    pub rates_before_rad_s: Vec<f64>,
    /// Rotation rates of the bodies just after.
    pub rates_after_rad_s: Vec<f64>,
    /// The hinges that closed, from left to right.
    pub closed: Vec<Hinge>,
    /// Hinges that opened, from left to right; empty if no mechanism can follow.
    pub opened: Vec<Hinge>,
    /// Impulses at the opened hinges on the part towards the crown, in N s; empty if unknown.
    pub impulses_n_s: Vec<Vector2<f64>>,
}

impl Impact {
    /// Sway of the mechanism that opened.
    pub const fn sway_after(&self) -> Sway {
        match self.strikes_wall {
            true => self.sway_before,
            false => self.sway_before.opposite(),
        }
    }
}

/// Peak, over the largest peak, below which half cycles are not reported.
const LEAST_PEAK_RATIO: f64 = 1e-3;

/// Summary of a history.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Outcome of the history.
    pub outcome: Outcome,
    /// Time of the outcome, in seconds: the last outward passage of the unstable equilibrium, the last time of rest, or otherwise the end of the
    /// history.
    pub outcome_time_s: f64,
    /// Time at which the simulation ended, in seconds.
    pub end_s: f64,
    /// True if the simulation ended early, at an [`EndCondition`](super::EndCondition): the structure may still move afterwards.
    pub is_cut: bool,
    /// Number of impacts up to the time of the outcome.
    pub impacts: usize,
    /// Largest rotations of the bodies, without sign, in radians.
    pub peak_rotations_rad: Vec<f64>,
    /// Largest error of the energy balance (initial energy, work of the ground, and losses at impacts), over the energy barrier of the first
    /// mechanism; for a row of blocks, over its weight times its size.
    pub energy_defect_ratio: f64,
    /// Thrust record of all samples; `None` without samples. For a mechanism that overturns: of all samples before the last passage of the unstable
    /// equilibrium.
    pub thrust: Option<ThrustRecord>,
    /// Friction that a motion without slip requires. If joints slip or are elastic: `None` without samples.
    pub friction: Option<FrictionRecord>,
    /// Computational effort.
    pub cost: Cost,
    /// Results of one kind of model only.
    pub details: Details,
}

/// Results of mechanisms only.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MechanismSummary {
    /// Largest rotation over that at the unstable equilibrium of the moving mechanism; from 1 on, gravity alone overturns the structure.
    pub peak_over_critical: f64,
    /// Largest excess of the thrust line up to the largest rotation, or up to overturning, over the thickness. It is computed at every step below the
    /// critical rotation, at the joints or at 49 sections of a continuous ring. `None` for a column.
    pub thrust_excess_ratio: Option<f64>,
    /// Energy at the end over the least energy barrier of the moving mechanism and of all that may follow it, if it is below 1: the structure cannot
    /// overturn any more. `None` for other outcomes than [`Outcome::StillRocking`], and below a quarter of the barrier.
    pub remaining_over_barrier: Option<f64>,
    /// Largest sum of the masses times their horizontal displacements to each side, in kg m; arbitrary for the side to which the structure overturns.
    pub largest_shifts_kg_m: Sides<f64>,
}

/// Results of one kind of model only.
#[derive(Clone, Debug, PartialEq)]
pub enum Details {
    /// Summary of four links or of a column.
    Mechanisms(MechanismSummary),
    /// Summary of a row of blocks with rigid joints.
    Rigid(Box<RowSummary>),
    /// Summary of a row of blocks with elastic joints.
    Elastic(Box<RowSummary>, ElasticSummary),
}

impl Summary {
    /// Results of a row of blocks; `None` for mechanisms.
    pub const fn row(&self) -> Option<&RowSummary> {
        match &self.details {
            Details::Mechanisms(_) => None,
            Details::Rigid(row) | Details::Elastic(row, _) => Some(row),
        }
    }

    /// Results of elastic joints; `None` for other models.
    pub const fn elastic_summary(&self) -> Option<&ElasticSummary> {
        match &self.details {
            Details::Elastic(_, elastic) => Some(elastic),
            Details::Mechanisms(_) | Details::Rigid(_) => None,
        }
    }

    /// Largest rotation over that at the unstable equilibrium of the moving mechanism; `None` for rows of blocks.
    pub const fn peak_over_critical(&self) -> Option<f64> {
        match self.details {
            Details::Mechanisms(of) => Some(of.peak_over_critical),
            Details::Rigid(_) | Details::Elastic(..) => None,
        }
    }

    /// Remaining energy over the barrier that it cannot pass any more, as in [`MechanismSummary`]; `None` for other models.
    pub const fn remaining_over_barrier(&self) -> Option<f64> {
        match self.details {
            Details::Mechanisms(of) => of.remaining_over_barrier,
            Details::Rigid(_) | Details::Elastic(..) => None,
        }
    }

    /// Largest excess of the thrust line of four links, as in [`MechanismSummary`]; `None` for other models.
    pub const fn thrust_excess_ratio(&self) -> Option<f64> {
        match self.details {
            Details::Mechanisms(of) => of.thrust_excess_ratio,
            Details::Rigid(_) | Details::Elastic(..) => None,
        }
    }

    /// Largest potential energy over the barrier of the first mechanism, as in [`RowSummary`]; `None` for mechanisms.
    pub fn peak_potential_over_barrier(&self) -> Option<f64> {
        self.row()?.peak_potential_over_barrier
    }

    /// Friction coefficient on which the history depends, because joints that slip would move otherwise. `None` if joints slip or are
    /// elastic.
    pub fn required_friction(&self) -> Option<f64> {
        let rigid = self.elastic_summary().is_none();
        let slips = self.row().is_some_and(|row| row.sliding.is_some());
        let friction = self.friction.filter(|_| rigid && !slips);
        friction.map(|friction| friction.required_coefficient())
    }

    /// Largest rotation of any body, without sign, in radians.
    pub fn largest_rotation_rad(&self) -> f64 {
        self.peak_rotations_rad.iter().copied().fold(0.0, f64::max)
    }

    /// Index of the body with the largest rotation; the last one of several.
    pub fn largest_body(&self) -> usize {
        let most_rad = self.largest_rotation_rad();
        let mut peaks_rad = self.peak_rotations_rad.iter();
        let last = peaks_rad.rposition(|peak_rad| *peak_rad == most_rad);
        last.unwrap_or(0)
    }

    /// Number of impacts; `None` for elastic joints, which have no instantaneous impacts.
    pub fn known_impacts(&self) -> Option<usize> {
        self.elastic_summary().is_none().then_some(self.impacts)
    }

    /// Time of overturning, in seconds; `None` if the structure did not overturn.
    pub fn overturned_s(&self) -> Option<f64> {
        matches!(self.outcome, Outcome::Overturned(_)).then_some(self.outcome_time_s)
    }

    /// Half cycles of a row of blocks with peaks of at least a thousandth of the largest peak; empty for other structures. Smaller half
    /// cycles are vibration, and their number is arbitrary.
    pub fn half_cycles(&self) -> Vec<HalfCycle> {
        let mut cycles = self
            .row()
            .map_or_else(Vec::new, RowSummary::joined_half_cycles);
        let peaks_rad = cycles.iter().map(|cycle| cycle.peak_rad);
        let least_rad = LEAST_PEAK_RATIO * peaks_rad.fold(0.0, f64::max);
        cycles.retain(|cycle| cycle.peak_rad >= least_rad);
        cycles
    }
}

/// Computational effort of a history.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Number of evaluations of the right-hand side; for a row of blocks, of solved systems of equations.
    pub evaluations: u64,
    /// Number of accepted steps.
    pub steps: u64,
}

/// Additional summary of a row of blocks.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RowSummary {
    /// Half cycles of any size, each up to a change of the side of the centre of gravity; see [`Self::joined_half_cycles`].
    #[serde(skip)]
    pub half_cycles: Vec<HalfCycle>,
    /// Number of half cycles, including those of the fall after the row has overturned.
    #[serde(skip)]
    pub half_cycles_with_fall: usize,
    /// Slip; `None` if joints do not slip.
    #[serde(flatten)]
    pub sliding: Option<Sliding>,
    /// Largest potential energy over the barrier of the first mechanism; the row may overturn by another mechanism. Of a row
    /// that slips, above its least potential energy. `None` if the barrier is unknown, or if a joint slipped by a hundredth of the thickness of the
    /// thinnest one, and friction dissipated more than a hundredth of the barrier.
    pub peak_potential_over_barrier: Option<f64>,
    /// Forces and energies of the ties; absent without ties.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ties: Vec<TieSummary>,
    /// Largest kinetic energy at the end of a step, in J.
    pub largest_kinetic_j: f64,
    /// Largest potential energy above rest, in J, including the elastic energy of joints.
    pub largest_potential_j: f64,
    /// Energy dissipated by impacts, in J, without friction; with elastic joints, by damping, friction and crushing.
    pub energy_taken_j: f64,
    /// Work of the moving ground on the whole row, in J; for feet that move differently, of the ground under the left foot.
    pub ground_j: f64,
    /// Work of the right foot due to its motion relative to the left one, in J.
    pub right_foot_j: f64,
    /// Error of the energy balance, over the largest kinetic energy, or over the barrier if this is known and larger.
    #[serde(rename = "energy_defect_over_largest")]
    pub energy_error: f64,
    /// Least normal force at a joint outside impacts, in N; infinite without any step and for elastic joints, and then absent from results.
    #[serde(default = "infinity", skip_serializing_if = "is_infinite")]
    pub least_normal_n: f64,
    /// Largest closure error of an arch, in m.
    pub closure_error_m: f64,
    /// Longest allowed step, in seconds.
    pub longest_step_s: f64,
    /// Time within which landings are merged if impacts are too frequent, in seconds.
    pub shortest_step_s: f64,
    /// Number of solved contact problems.
    pub programs: u64,
    /// Largest number of solved systems of equations in a step.
    pub most_iterations: u64,
    /// Number of times the tolerance of a quadratic program was relaxed.
    pub relaxed: u64,
    /// Number of steps with several landings, or with landings that are too frequent.
    pub merged: u64,
    /// Number of times the longest step was halved because of the energy balance.
    #[serde(rename = "step_halvings")]
    pub halvings: u32,
    /// Computing time of the slowest step; `None` unless the recorder has a clock.
    #[serde(skip)]
    pub longest_step: Option<Duration>,
}

const fn infinity() -> f64 {
    f64::INFINITY
}

const fn is_infinite(number: &f64) -> bool {
    number.is_infinite()
}

/// Half cycle: motion between passages of the centre of gravity through its undeformed position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HalfCycle {
    /// Side of the sway.
    pub sway: Sway,
    /// Start, in seconds.
    pub start_s: f64,
    /// Duration in seconds; for the last half cycle, up to the end of the motion.
    pub duration_s: f64,
    /// Largest rotation of a block, in radians.
    pub peak_rad: f64,
    /// Time of the peak, in seconds.
    pub peak_time_s: f64,
    /// Energy at the end over that at the start; `None` for the first and the last half cycle.
    pub energy_ratio: Option<f64>,
    /// True if this part continues the half cycle before it, because the blocks have not turned back between them.
    #[serde(skip)]
    pub continues: bool,
}

impl RowSummary {
    /// Half cycles of any size; [`Summary::half_cycles`] omits vibration. A half cycle continues when the centre of gravity changes its side
    /// before the blocks have turned back. Its side is that of its largest rotation.
    pub fn joined_half_cycles(&self) -> Vec<HalfCycle> {
        let mut joined: Vec<HalfCycle> = Vec::new();
        for cycle in &self.half_cycles {
            match joined.last_mut() {
                Some(last) if cycle.continues => last.extend(cycle),
                _ => joined.push(*cycle),
            }
        }
        joined
    }
}

impl HalfCycle {
    /// Extends this half cycle by the one that follows it.
    fn extend(&mut self, next: &Self) {
        self.duration_s = next.end_s() - self.start_s;
        let ratios = self.energy_ratio.zip(next.energy_ratio);
        self.energy_ratio = ratios.map(|(own, of_next)| own * of_next);
        if next.peak_rad > self.peak_rad {
            self.sway = next.sway;
            self.peak_rad = next.peak_rad;
            self.peak_time_s = next.peak_time_s;
        }
    }

    /// End of the half cycle, in seconds.
    pub fn end_s(&self) -> f64 {
        self.start_s + self.duration_s
    }

    /// Corresponding half cycle of another motion: to the same side, overlapping in time, and with the nearest peak in time; `None` if
    /// there is none.
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

/// Slip in a motion.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sliding {
    /// Energy dissipated by friction, in J.
    pub friction_j: f64,
    /// Final offsets of the right face of every joint towards the extrados, in metres.
    #[serde(rename = "slips_m")]
    pub offsets_m: Vec<f64>,
    /// Largest offsets, without sign, in metres.
    #[serde(rename = "largest_slips_m")]
    pub largest_offsets_m: Vec<f64>,
    /// Number of steps in which friction bounds did not converge; zero for elastic joints, whose bounds are always known.
    #[serde(rename = "unconverged_steps")]
    pub unconverged: u64,
    /// Largest error of a friction bound, relative to the largest bound.
    #[serde(rename = "friction_bound_error")]
    pub bound_error: f64,
}

impl Sliding {
    /// Largest slip of any joint, in metres.
    pub(super) fn largest_m(&self) -> f64 {
        self.largest_offsets_m.iter().copied().fold(0.0, f64::max)
    }

    /// Record without slip.
    pub fn none(joints: usize) -> Self {
        Self {
            offsets_m: vec![0.0; joints],
            largest_offsets_m: vec![0.0; joints],
            ..Self::default()
        }
    }
}

/// Additional summary of a motion with elastic joints. Energies are totals of the whole motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ElasticSummary {
    /// Largest elastic compressive stress. Damping adds to it, and the strength limits the sum.
    #[serde(flatten)]
    pub largest_stress: Stress,
    /// Elastic energy at the end, in J.
    pub elastic_j: f64,
    /// Damping time of the joints in s: given, or found for `rebound_ratio` or `damping_ratio`.
    pub damping_time_s: f64,
    /// Energy dissipated by damping, in J.
    pub damped_j: f64,
    /// Energy dissipated by friction, in J.
    pub friction_j: f64,
    /// Energy dissipated by crushing, in J.
    pub crushed_j: f64,
    /// Energy dissipated by yield and break of ties, in J.
    pub ties_j: f64,
    /// Largest eccentricity of the thrust in a joint at rest before the motion, over the length of the joint.
    pub rest_eccentricity_ratio: f64,
    /// Index of the joint with this eccentricity.
    pub rest_eccentricity_joint: usize,
    /// Opening beyond the state at rest above which a joint counts as open, in m: the compression of the most compressed edge under self-weight.
    pub opening_tolerance_m: f64,
    /// Time in s since which the row rests or only vibrates, on quiet ground: its kinetic and potential energy are each below a tenth of the elastic
    /// energy under self-weight, or below 0.03 of the barrier of the first mechanism. Null if it still moved more.
    pub vibrates_since_s: Option<f64>,
}

/// Largest compressive stress, with its joint and time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Stress {
    /// Largest elastic compressive stress, in Pa. Damping adds to it, and the strength limits the sum.
    #[serde(rename = "largest_compressive_stress_pa")]
    pub stress_pa: f64,
    /// Index of the joint with this stress at an edge.
    #[serde(rename = "largest_compressive_stress_joint")]
    pub joint: usize,
    /// Time of this stress, in seconds.
    #[serde(rename = "largest_compressive_stress_time_s")]
    pub time_s: f64,
}
