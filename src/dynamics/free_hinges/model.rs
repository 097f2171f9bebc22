//! A row of blocks with free hinges as a model of motion.

use std::ops::ControlFlow;

use serde::Serialize;

use super::{
    FreeHingeError, Impact as Landing, Outcome as RowOutcome, Recorder as RowRecorder, Run,
    Sample as RowSample, Settings, Uplift, spread::Repeated,
};
use crate::argument::{ArgumentError, above};
use crate::dynamics::ground::GroundMotion;
use crate::dynamics::history::{
    Event, EventKind, Impact, OpenHinge, Outcome, Sample, Shape, State, Summary,
};
use crate::dynamics::hybrid::integrator::Cost;
use crate::dynamics::model::{Initial, Model, Recorder, Repetition, Request, SimulationError};
use crate::dynamics::thrust::ThrustRecord;
use crate::mechanics::arch::Arch;
use crate::mechanics::blocks::{Row, RowError, Supports};
use crate::mechanics::chain::{Demand, Hinge, Mechanism, MechanismChain};
use crate::mechanics::column::Column;
use crate::mechanics::four_link::impact::ImpactModel;
use crate::mechanics::four_link::row::FourLinkRow;
use crate::mechanics::friction::{self, FrictionError};
use crate::mechanics::geometry::ring::Edge;
use crate::mechanics::stability::{StabilityError, onset};
use crate::mechanics::sway::Sway;

/// Rigid blocks in a row, an arch or a stack, whose joints open about either edge, and shut again, at any time.
///
/// Joints carry no tension and do not slide; impacts are perfectly inelastic. Nothing is asked of it but the
/// blocks: which hinges open, and what an impact leaves, follow.
#[derive(Clone, Debug)]
pub struct FreeHinges {
    row: Row,
    /// The push that starts it to the right and to the left where joints do not slip, in units of gravity.
    incipient_g: [Option<f64>; 2],
    /// The same where they do.
    with_friction_g: Option<[Option<f64>; 2]>,
    /// Its first mechanism, where that has one degree of freedom that is known: four links, or one block.
    first: Option<FirstMechanism>,
    options: RowOptions,
    /// In which other way its motion is computed, if in another.
    repeated: Option<Repeated>,
}

/// What was asked of the model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct RowOptions {
    /// The longest step, in seconds; without it, it follows the size of the row.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub longest_step_s: Option<f64>,
    /// Where landings crowd within this time, in seconds, they are taken as one; without it, a thirtieth of the longest step.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shortest_step_s: Option<f64>,
    /// Coulomb's coefficient of friction at every joint; without it joints do not slip.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction_coefficient: Option<f64>,
}

impl RowOptions {
    /// Refuses steps and coefficients that are none.
    pub(crate) fn checked(self) -> Result<Self, ArgumentError> {
        for (argument, value) in [
            ("longest_step_s", self.longest_step_s),
            ("shortest_step_s", self.shortest_step_s),
            ("friction_coefficient", self.friction_coefficient),
        ] {
            if let Some(value) = value {
                above(argument, value, 0.0, 1e9)?;
            }
        }
        let wrong = |argument, value, allowed| {
            Err(ArgumentError {
                argument,
                value,
                allowed,
            })
        };
        match (self.longest_step_s, self.shortest_step_s) {
            (_, Some(shortest_s)) if self.friction_coefficient.is_some() => wrong(
                "shortest_step_s",
                shortest_s,
                "left out where joints slip: then all steps are the longest".to_owned(),
            ),
            (Some(longest_s), Some(shortest_s)) if longest_s < shortest_s => wrong(
                "longest_step_s",
                longest_s,
                format!("at least the shortest step, {shortest_s:?}"),
            ),
            _ => Ok(self),
        }
    }
}

/// A row has slipped when friction took more than this part of the barrier of its first mechanism. It then stands lower than it did,
/// and its potential energy tells nothing about that barrier.
const SLIPPED_RATIO: f64 = 0.01;

/// An energy balance that is wrong by more than this part of the largest energy of the motion is worth a word ...
pub const DOUBTFUL_ENERGY_ERROR: f64 = 1e-3;
/// ... and by more than this, an error.
const LARGEST_ENERGY_ERROR: f64 = 1e-2;
/// Motions whose energies are below this part of weight times size are none: their balance is rounding.
const LEAST_ENERGY_RATIO: f64 = 1e-6;

/// What the motion of the first mechanism is known by.
#[derive(Clone, Debug)]
enum FirstMechanism {
    /// Four links.
    FourLinks(FourLinkRow),
    /// A stack turns about an edge of its base.
    Base,
}

/// Why there is no such model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FreeHingesError {
    /// The blocks are none, or make no row.
    #[error(transparent)]
    Row(#[from] RowError),
    /// The row does not stand, or that could not be told.
    #[error(transparent)]
    Stability(#[from] StabilityError),
    /// An argument is not allowed.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
    /// It slides apart under its own weight.
    #[error(transparent)]
    Friction(#[from] FrictionError),
}

impl FreeHinges {
    /// Any row that stands.
    ///
    /// # Errors
    /// When the row cannot carry its own weight.
    pub fn new(row: Row) -> Result<Self, FreeHingesError> {
        let incipient_g = [
            onset(&row, Sway::Right)?.map(|onset| onset.acceleration_g),
            onset(&row, Sway::Left)?.map(|onset| onset.acceleration_g),
        ];
        let first = match row.supports() {
            Supports::Left => Some(FirstMechanism::Base),
            // An impact model is asked for, and not used: the first mechanism comes before any impact.
            Supports::Both => FourLinkRow::new(&row, ImpactModel::MaxRestitution)
                .ok()
                .map(FirstMechanism::FourLinks),
        };
        Ok(Self {
            row,
            incipient_g,
            with_friction_g: None,
            first,
            options: RowOptions::default(),
            repeated: None,
        })
    }

    /// The voussoirs of an arch.
    ///
    /// # Errors
    /// When the arch has no voussoirs, or cannot carry its own weight.
    pub fn of_arch(arch: &Arch) -> Result<Self, FreeHingesError> {
        let voussoirs = arch.voussoirs().ok_or(ArgumentError {
            argument: "voussoirs",
            value: 0.0,
            allowed: "given: free hinges open at joints".to_owned(),
        })?;
        Self::new(Row::arch(
            &arch.ring(),
            voussoirs,
            arch.mean_radius_m(),
            arch.depth_m(),
            arch.density_kg_m3(),
        )?)
    }

    /// The drums of a column.
    ///
    /// # Errors
    /// When the drums make no row, or the column cannot carry its own weight.
    pub fn of_column(column: &Column) -> Result<Self, FreeHingesError> {
        let row = Row::tapered_stack(
            &column.drum_heights_m(),
            column.width_m(),
            column.top_width_m(),
            column.depth_m(),
            column.density_kg_m3(),
        )?;
        Self::new(row.with_supports_that_go_on([!column.is_on_pedestal(), false]))
    }

    /// The same with other options.
    ///
    /// # Errors
    /// When a step or the coefficient is not positive and finite, the longest step is shorter than the shortest, a
    /// shortest step is given for joints that slip, or the row slides apart under its own weight.
    pub fn with_options(self, options: RowOptions) -> Result<Self, FreeHingesError> {
        let options = options.checked()?;
        let with_friction_g = match options.friction_coefficient {
            None => None,
            Some(coefficient) if friction::stands(&self.row, coefficient)? => {
                Some(self.with_friction_g(coefficient)?)
            }
            Some(coefficient) => return Err(FrictionError::CannotStand(coefficient).into()),
        };
        Ok(Self {
            options,
            with_friction_g,
            ..self
        })
    }

    /// The push that starts it to either side where joints slip, by limit analysis.
    fn with_friction_g(&self, coefficient: f64) -> Result<[Option<f64>; 2], FrictionError> {
        let [mut right, mut left] = self.incipient_g;
        for (push_g, sway) in [(&mut right, Sway::Right), (&mut left, Sway::Left)] {
            *push_g = match friction::onset_of_standing(&self.row, coefficient, sway) {
                Ok(onset) => onset.map(|onset| onset.acceleration_g),
                // Joints that do not slip bear no less: theirs is a bound as well.
                Err(FrictionError::NotSolved(_)) => *push_g,
                Err(error) => return Err(error),
            };
        }
        Ok([right, left])
    }

    /// Coulomb's coefficient of friction, where joints slip.
    #[must_use]
    pub const fn friction_coefficient(&self) -> Option<f64> {
        self.options.friction_coefficient
    }

    /// The blocks.
    #[must_use]
    pub const fn row(&self) -> &Row {
        &self.row
    }

    /// Energy that the first mechanism has to gain to overturn, in J, to the side where that is less; `None` where it is
    /// not known.
    #[must_use]
    pub fn barrier_j(&self, gravity_m_s2: f64) -> Option<f64> {
        match &self.first {
            Some(FirstMechanism::FourLinks(row)) => {
                let links = Sway::ALL.iter().filter_map(|sway| row.link_from(*sway, 0));
                let barrier = links.map(|link| link.barrier).reduce(f64::min)?;
                Some(gravity_m_s2 * barrier * row.mass_unit_kg() * row.length_m())
            }
            Some(FirstMechanism::Base) | None => match (self.row.blocks(), self.row.joints()) {
                // One block turns about the nearer edge of its base, up to where its centre is above that.
                ([block], [base]) => {
                    let rise = |edge: Edge| {
                        let arm_m = block.centre_m - base.corner_m(edge);
                        arm_m.norm() - arm_m.y
                    };
                    let rise_m = rise(Edge::Intrados).min(rise(Edge::Extrados));
                    Some(block.mass_kg * gravity_m_s2 * rise_m)
                }
                _ => None,
            },
        }
    }

    /// By how much the energy balance of a motion is wrong, over the larger of its largest kinetic energy and the barrier, where that is
    /// known.
    #[must_use]
    pub fn energy_error(&self, run: &Run, gravity_m_s2: f64) -> f64 {
        let unit_j = self.row.mass_kg() * gravity_m_s2 * self.row.size_m();
        let barrier_j = self.barrier_j(gravity_m_s2).unwrap_or(0.0);
        let least_j = LEAST_ENERGY_RATIO * unit_j;
        run.energy_defect_ratio * unit_j / run.largest_kinetic_j.max(barrier_j).max(least_j)
    }

    /// The longest step that a history takes, in seconds.
    pub(crate) fn longest_step_s(&self, request: &Request) -> f64 {
        self.settings(request).longest_step_s
    }

    /// How a motion is computed.
    fn settings(&self, request: &Request) -> Settings {
        let (row, gravity_m_s2, end_s) = (&self.row, request.gravity_m_s2, request.end_s);
        let mut settings = match self.options.friction_coefficient {
            None => Settings::to_landings(row, gravity_m_s2, end_s),
            Some(_) => Settings::equal(row, gravity_m_s2, end_s),
        };
        if let Some(longest_s) = self.options.longest_step_s {
            settings = settings.times(longest_s / settings.longest_step_s);
        }
        if let Some(shortest_s) = self.options.shortest_step_s {
            settings.shortest_step_s = shortest_s;
            settings.longest_step_s = settings.longest_step_s.max(shortest_s);
        }
        settings.output_step_s = Some(request.output_step_s);
        settings.friction_coefficient = self.options.friction_coefficient;
        self.repeated.map_or(settings, |way| way.of(&settings))
    }

    /// Rotations of the blocks when the first mechanism is open so far.
    fn released(&self, initial: Initial) -> Result<Vec<f64>, SimulationError> {
        let refused = |allowed: String| {
            SimulationError::Argument(ArgumentError {
                argument: "rotation_rad",
                value: initial.rotation_rad,
                allowed,
            })
        };
        let blocks = self.row.blocks().len();
        // Swaying right, in the frame in which the mechanism does so; the other side is its mirror image.
        let side = match initial.sway {
            Sway::Right => 1.0,
            Sway::Left => -1.0,
        };
        let row = match &self.first {
            Some(FirstMechanism::FourLinks(row)) => row,
            Some(FirstMechanism::Base) => return Ok(vec![-side * initial.rotation_rad; blocks]),
            None => {
                return Err(refused(
                    "left out: this row starts as no mechanism that it could be released in"
                        .to_owned(),
                ));
            }
        };
        let link = row
            .link_from(initial.sway, 0)
            .expect("a row that starts as four links has its first mechanism");
        if initial.rotation_rad >= link.limit_rad {
            let limit_rad = link.limit_rad;
            return Err(refused(format!(
                "below {limit_rad:?}, the limit position of the first mechanism"
            )));
        }
        let mut bodies_rad = link.mechanism.rotations(initial.rotation_rad);
        if initial.sway == Sway::Left {
            bodies_rad.reverse();
        }
        let hinges = row.hinges(0, initial.sway);
        let hinges_before = |block: usize| {
            let before =
                |hinge: &&Hinge| matches!(hinge, Hinge::Joint { joint, .. } if *joint <= block);
            hinges.iter().filter(before).count()
        };
        let rotation_rad = |block: usize| {
            let body = hinges_before(block).checked_sub(1);
            side * body.and_then(|body| bodies_rad.get(body)).unwrap_or(&0.0)
        };
        Ok((0..blocks).map(rotation_rad).collect())
    }
}

impl Model for FreeHinges {
    fn repetitions(&self) -> Vec<Repetition> {
        let ways = match self.options.friction_coefficient {
            None => [Repeated::DoubleSteps, Repeated::MergedLandings],
            Some(_) => [Repeated::HalfSteps, Repeated::DoubleSteps],
        };
        let repetition = |way: Repeated| Repetition {
            name: way.name(),
            model: Box::new(Self {
                repeated: Some(way),
                ..self.clone()
            }),
        };
        ways.map(repetition).into()
    }

    fn bodies(&self) -> Vec<String> {
        (1..=self.row.blocks().len())
            .map(|block| block.to_string())
            .collect()
    }

    fn shape(&self) -> Shape {
        let joints = self.row.joints().len();
        Shape {
            bodies: self.row.blocks().len(),
            joints,
            slipping: self.options.friction_coefficient.map_or(0, |_| joints),
        }
    }

    fn incipient_acceleration_g(&self, sway: Sway) -> Option<f64> {
        let [right, left] = self.with_friction_g.unwrap_or(self.incipient_g);
        match sway {
            Sway::Right => right,
            Sway::Left => left,
        }
    }

    fn simulate(
        &self,
        ground: &GroundMotion,
        request: &Request,
        recorder: Option<&mut dyn Recorder>,
    ) -> Result<Summary, SimulationError> {
        request.check()?;
        let settings = self.settings(request);
        let initial_rad = request
            .initial
            .map(|initial| self.released(initial))
            .transpose()?;
        let barrier_j = self.barrier_j(request.gravity_m_s2);
        let mut relay = Relay {
            ground,
            barrier_j,
            phase: 0,
            thrust: ThrustRecord::default(),
            sample: Sample::at_rest(0.0),
            recorder,
        };
        let run = super::simulate(
            &self.row,
            ground,
            request.gravity_m_s2,
            &settings,
            initial_rad.as_deref(),
            &mut relay,
        )?;
        let error = self.energy_error(&run, request.gravity_m_s2);
        if error > LARGEST_ENERGY_ERROR {
            let longest_step_s = settings.longest_step_s;
            return Err(FreeHingeError::Energy {
                error,
                longest_step_s,
            }
            .into());
        }
        let (outcome, outcome_time_s) = match run.outcome {
            RowOutcome::NeverMoved => (Outcome::NeverMoved, run.end_s),
            RowOutcome::Rest { time_s } => (Outcome::Rest, time_s),
            RowOutcome::Overturned { sway, time_s } => (Outcome::Overturned(sway), time_s),
            RowOutcome::Rocking => (Outcome::StillRocking, run.end_s),
        };
        relay.end(outcome, run.end_s);
        let rubbed_j = run
            .sliding
            .as_ref()
            .map_or(0.0, |sliding| sliding.friction_j);
        Ok(Summary {
            outcome,
            outcome_time_s,
            end_s: run.end_s,
            impacts: run.cost.impacts,
            peak_rotations_rad: run.peaks_rad.clone(),
            peak_over_critical: None,
            peak_potential_over_barrier: barrier_j
                .filter(|barrier_j| rubbed_j <= SLIPPED_RATIO * barrier_j)
                .map(|barrier_j| run.peak_potential_j / barrier_j),
            energy_defect_ratio: run.energy_defect_ratio,
            thrust: relay.recorder.is_some().then_some(relay.thrust),
            cost: Cost {
                evaluations: run.cost.iterations as u64,
                steps: run.cost.steps as u64,
            },
            free_hinges: Some(Box::new(run)),
        })
    }
}

/// Hands on what happens to a row in the words of any model.
struct Relay<'r, 'k> {
    ground: &'r GroundMotion,
    barrier_j: Option<f64>,
    phase: usize,
    thrust: ThrustRecord,
    /// The sample that is made, again and again.
    sample: Sample,
    recorder: Option<&'k mut dyn Recorder>,
}

/// What a row does that moves, swayed to a side.
const fn swaying(sway: Sway, overturned: bool) -> State {
    if overturned {
        State::Overturned(sway)
    } else {
        State::Rocking(sway)
    }
}

impl Relay<'_, '_> {
    /// Tells of the end, if it is one.
    fn end(&mut self, outcome: Outcome, end_s: f64) {
        let (kind, state) = match outcome {
            Outcome::Rest => (EventKind::Rest, State::Rest),
            Outcome::Overturned(sway) => (EventKind::Overturned, State::Overturned(sway)),
            Outcome::NeverMoved | Outcome::StillRocking => return,
        };
        if let Some(recorder) = &mut self.recorder {
            // It ends here anyway.
            let _ = recorder.event(&Event {
                time_s: end_s,
                kind,
                state,
                mechanism: None,
                rotations_rad: self.sample.rotations_rad.clone(),
                rates_rad_s: self.sample.rates_rad_s.clone(),
                energy_j: self.sample.energy_j,
                hinges: self.sample.hinges.iter().map(|open| open.hinge).collect(),
                impact: None,
            });
        }
    }
}

/// How a joint with these gaps is open: the edge about which it turns, `None` where both are open; nothing where it is shut.
fn opening(gaps_m: &[f64; 2]) -> Option<Option<Edge>> {
    match gaps_m {
        [0.0, 0.0] => None,
        [0.0, _] => Some(Some(Edge::Intrados)),
        [_, 0.0] => Some(Some(Edge::Extrados)),
        _ => Some(None),
    }
}

impl RowRecorder for Relay<'_, '_> {
    fn wants_samples(&self) -> bool {
        self.recorder.is_some()
    }

    fn sample(&mut self, sample: &RowSample<'_>) -> ControlFlow<()> {
        let shut = sample.open_joints == 0 && sample.slipping_joints == 0;
        let still = shut || sample.rotations_rad.iter().all(|angle| *angle == 0.0);
        let state = if still {
            State::Rest
        } else {
            swaying(sample.sway, sample.overturned)
        };
        let pieces = self.ground.pieces();
        let piece = pieces.partition_point(|piece| piece.start_s <= sample.time_s) - 1;
        let (ground_m_s2, _) = pieces[piece].at(sample.time_s);
        let demand = Demand {
            excess_ratio: 0.0,
            friction: sample.friction_demand,
        };
        let next = &mut self.sample;
        next.time_s = sample.time_s;
        // Adding zero makes a negative zero positive.
        next.ground_acceleration_m_s2 = ground_m_s2.x + 0.0;
        next.vertical_acceleration_m_s2 = ground_m_s2.y + 0.0;
        next.phase = self.phase;
        next.state = state;
        next.rotations_rad.clear();
        next.rotations_rad.extend(sample.rotations_rad);
        next.rates_rad_s.clear();
        next.rates_rad_s.extend(sample.rates_rad_s);
        next.poses.clear();
        next.poses.extend(sample.poses);
        next.hinges.clear();
        for (joint, (gaps, frame)) in sample.gaps_m.iter().zip(sample.frames).enumerate() {
            let Some(edge) = opening(gaps) else {
                continue;
            };
            next.hinges.push(OpenHinge {
                hinge: Hinge::Joint { joint, edge },
                position_m: frame.corner_m(edge.unwrap_or(Edge::Intrados)),
            });
        }
        next.demand = demand;
        next.energy_j = sample.kinetic_j + sample.potential_j;
        next.energy_ratio = self.barrier_j.map(|barrier_j| next.energy_j / barrier_j);
        next.gaps_m.clear();
        next.gaps_m.extend(sample.gaps_m);
        next.eccentricity_ratios.clear();
        if self
            .recorder
            .as_ref()
            .is_some_and(|recorder| recorder.wants_thrust_line())
        {
            let corners = sample.corner_impulses_n_s.iter();
            next.eccentricity_ratios
                .extend(corners.map(|corner_impulses| {
                    // The solver takes a pull below its tolerance for none.
                    let [intrados, extrados] = corner_impulses.map(|impulse| impulse.max(0.0));
                    let normal = intrados + extrados;
                    (normal > 0.0).then(|| 0.5 * (extrados - intrados) / normal)
                }));
        }
        next.offsets_m.clear();
        next.offsets_m.extend(sample.offsets_m);
        self.thrust
            .note(sample.time_s, state != State::Rest, &demand);
        match &mut self.recorder {
            Some(recorder) => recorder.sample(&self.sample),
            None => ControlFlow::Continue(()),
        }
    }

    fn uplift(&mut self, uplift: &Uplift<'_>) -> ControlFlow<()> {
        self.phase += 1;
        let Some(recorder) = &mut self.recorder else {
            return ControlFlow::Continue(());
        };
        recorder.event(&Event {
            time_s: uplift.time_s,
            kind: EventKind::Uplift,
            state: State::Rocking(uplift.sway),
            mechanism: None,
            rotations_rad: uplift.rotations_rad.to_vec(),
            rates_rad_s: uplift.rates_rad_s.to_vec(),
            energy_j: uplift.energy_j,
            hinges: uplift.opened.to_vec(),
            impact: None,
        })
    }

    fn impact(&mut self, landing: &Landing<'_>) -> ControlFlow<()> {
        self.phase += 1;
        let state = landing
            .sway
            .map_or(State::Rest, |sway| swaying(sway, landing.overturned));
        let Some(recorder) = &mut self.recorder else {
            return ControlFlow::Continue(());
        };
        let opens_at_once = |joint: usize| {
            let mut opened = landing.opened.iter().copied();
            opened
                .find(|hinge| matches!(hinge, Hinge::Joint { joint: opens, .. } if *opens == joint))
        };
        let hinge = |(joint, gaps_m)| {
            let open = || opening(gaps_m).map(|edge| Hinge::Joint { joint, edge });
            opens_at_once(joint).or_else(open)
        };
        let hinges = landing.gaps_m.iter().enumerate().filter_map(hinge);
        let energy_after_j = (landing.energy_before_j - landing.energy_taken_j).max(0.0);
        let restitution = if landing.energy_before_j > 0.0 {
            energy_after_j / landing.energy_before_j
        } else {
            0.0
        };
        // What lands undeformed came from the other side.
        let undeformed = landing.rotations_rad.iter().all(|angle| *angle == 0.0);
        let sway = landing.sway.unwrap_or(Sway::Right);
        let sway_before = if undeformed { sway.opposite() } else { sway };
        recorder.event(&Event {
            time_s: landing.time_s,
            kind: EventKind::Impact,
            state,
            mechanism: None,
            rotations_rad: landing.rotations_rad.to_vec(),
            rates_rad_s: landing.rates_after_rad_s.to_vec(),
            energy_j: energy_after_j + landing.potential_j,
            hinges: hinges.collect(),
            impact: Some(Impact {
                sway_before,
                restitution,
                energy_before_j: landing.energy_before_j,
                energy_after_j,
                friction_j: landing.friction_j,
                rates_before_rad_s: Vec::new(),
                rates_after_rad_s: landing.rates_after_rad_s.to_vec(),
                closed: landing.shut.to_vec(),
                opened: landing.opened.to_vec(),
                impulses_n_s: Vec::new(),
            }),
        })
    }
}
