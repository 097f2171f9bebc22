//! Row of blocks with elastic joints as a model of motion.

use std::cell::OnceCell;
use std::ops::RangeInclusive;
use std::sync::{Arc, OnceLock};

use nalgebra::Vector3;

use super::stepper::Group;
use crate::argument::{ArgumentError, require, require_within, short};
use crate::dynamics::model::{Case, Initial, Job, Jobs, Recorder, check, one_by_one};
use crate::dynamics::row::observer::{LARGEST_ENERGY_ERROR, require_balance};
use crate::dynamics::row::standing::RigidRow;
use crate::dynamics::row::stepper;
use crate::dynamics::until::EndCondition;
use crate::dynamics::{
    Details, GroundMotion, Model, MotionInput, Repetition, Request, RowModelError, RowMotionError,
    Settings, SimulationError, Summary, Variation,
};
use crate::mechanics::blocks::GRAVITY_M_S2;
use crate::mechanics::elastic_joint::{Contact, ElasticProperties, JointStiffness, Stiffness};
use crate::mechanics::{Column, ElasticStructure, Equilibrium, Movements, Row, Sway};

/// Row of rigid blocks, as an arch or a stack, whose joints carry no tension, deform elastically, slip and crush.
///
/// The motion starts from equilibrium under self-weight. No impact dissipates energy instantaneously, and the hinge of a joint is inside its edge.
/// Such a row therefore overturns earlier than the same row with rigid joints ([`FreeHinges`](crate::dynamics::FreeHinges)).
#[readonly::make]
#[derive(Clone, Debug)]
pub struct ElasticJoints {
    rigid: RigidRow,
    /// Properties of the joints.
    pub properties: ElasticProperties,
    /// The longest step that was given, in seconds.
    given_step_s: Option<f64>,
    /// Bodies and joints.
    pub structure: ElasticStructure,
    /// Gravity, and the equilibrium under it.
    rest: (f64, Equilibrium),
    /// Gravity, and the energy barrier under it, computed at the first request.
    barrier_j: Arc<OnceLock<(f64, Option<f64>)>>,
    /// Column of one block whose joints have the damping of this ratio of rates; `None` if the damping is given.
    rebound: Option<(Column, f64)>,
    /// True in a study of many cases, with longer default steps.
    many_cases: bool,
    /// Factor on the longest step, for a repetition.
    steps_times: f64,
    /// True if the first repetition is mirrored.
    repeats_mirrored: bool,
}

/// Longest step over the largest stable one, without damping, and with the damping ratio [`DAMPED`]. Undamped vibration that opens and closes joints
/// needs the shorter steps for an energy balance within a hundredth of the barrier.
const STEP_RATIO: [f64; 2] = [0.25, 0.5];
/// Damping ratio of the fastest vibration at which the longer steps are sufficient.
const DAMPED: f64 = 0.3;
/// Ratio of the steps with a wall to those without: column and wall are parallel, so their whole contact closes in one step.
const WALL_STEP_RATIO: f64 = 0.25;
/// Ratio of the steps in studies of many cases to those of a single run.
const MANY_CASES_STEP_RATIO: f64 = 1.6;
/// Steps of the repetitions, over those of the motion; none is longer, as steps may already be close to the largest stable one.
const OTHER_STEPS: [(&str, f64); 6] = [
    ("half steps", 0.5),
    ("steps of two thirds", 2.0 / 3.0),
    ("quarter steps", 0.25),
    ("steps times 0.4", 0.4),
    ("steps of three quarters", 0.75),
    ("steps of nine tenths", 0.9),
];
/// Number of parallel histories; eight are slower, because they exceed the processor's first-level cache.
const SIDE_BY_SIDE: usize = 4;
/// Number of stiffnesses in a decade that variations have: a structure may survive with two stiffnesses and overturn with one between them.
const STIFFNESSES_PER_DECADE: f64 = 3.0;
/// Usual stiffnesses of joints, which variations cover.
const USUAL_STIFFNESS_PA_M: RangeInclusive<f64> = 2.99e9..=1.01e11;
/// Powers of the step between stiffnesses that may be usual.
const MOST_POWERS: RangeInclusive<i32> = -18..=18;
/// Step length proposed after an error of the energy balance, over the longest step.
const SHORTER: f64 = 0.3;
/// Remedy in the message on too many steps.
const TOO_LONG: &str = "take a smaller damping time or stiffness of the joints, or free hinges, the limit of stiff joints";

impl ElasticJoints {
    /// Range of the longest step, in seconds; shorter steps need too much time.
    pub const STEP_S: RangeInclusive<f64> = 1e-9..=1.0;
    /// Maximum number of steps of a motion: some hours of computing.
    pub const MOST_STEPS: f64 = 1e9;

    /// Model of a stable row with elastic joints.
    ///
    /// # Errors
    /// If a property is out of range, or the row does not carry its own weight; with the reason.
    pub fn new(row: Row, properties: ElasticProperties) -> Result<Self, RowModelError> {
        Self::under(GRAVITY_M_S2, row, properties)
    }

    /// Model of a row with elastic joints that is stable under this gravity, in m/s2. Under less gravity joints bend less.
    ///
    /// # Errors
    /// As [`ElasticJoints::new`].
    pub fn under(
        gravity_m_s2: f64,
        row: Row,
        properties: ElasticProperties,
    ) -> Result<Self, RowModelError> {
        Self::with_wall(None, gravity_m_s2, row, properties)
    }

    /// Model of a column under this gravity, in m/s2, with the wall behind it. Contacts with the wall push, without friction; their stiffness
    /// per area and their damping are those of the joints.
    ///
    /// # Errors
    /// As [`ElasticJoints::new`] and [`Column::wall_behind_drums`].
    pub fn of_column(
        gravity_m_s2: f64,
        column: &Column,
        properties: ElasticProperties,
    ) -> Result<Self, RowModelError> {
        let row = column.row()?;
        let wall = column.wall_behind_drums()?;
        Self::with_wall(wall, gravity_m_s2, row, properties)
    }

    fn with_wall(
        wall: Option<(Sway, f64)>,
        gravity_m_s2: f64,
        row: Row,
        properties: ElasticProperties,
    ) -> Result<Self, RowModelError> {
        let structure =
            ElasticStructure::of_row(&row, &properties)?.with_wall(&row, wall, &properties)?;
        let rigid = RigidRow::new(row)?
            .with_friction(properties.friction_coefficient)?
            .before_wall(wall.map(|(side, _)| side));
        Self::standing(rigid, properties, structure, gravity_m_s2)
    }

    fn standing(
        rigid: RigidRow,
        properties: ElasticProperties,
        structure: ElasticStructure,
        gravity_m_s2: f64,
    ) -> Result<Self, RowModelError> {
        let rest = structure.rest([0.0, -gravity_m_s2])?;
        Ok(Self {
            rigid,
            properties,
            given_step_s: None,
            structure,
            rest: (gravity_m_s2, rest),
            barrier_j: Arc::default(),
            rebound: None,
            many_cases: false,
            steps_times: 1.0,
            repeats_mirrored: false,
        })
    }

    /// This model on supports that moved slowly before time zero.
    ///
    /// # Errors
    /// If the row falls during the movement, with these joints or with rigid ones.
    pub fn on_supports(self, movements: Movements) -> Result<Self, RowModelError> {
        if movements.is_none() {
            return Ok(self);
        }
        let structure = self.structure.on_supports(movements.displacements());
        let rigid = self.rigid.on_supports(&movements)?;
        let settled = Self::standing(rigid, self.properties, structure, self.rest.0)?;
        Ok(Self {
            given_step_s: self.given_step_s,
            rebound: self.rebound,
            ..settled
        })
    }

    /// This model with this longest step, in seconds. The default is a quarter (undamped) to a half of the largest step that is proved
    /// to be stable.
    ///
    /// # Errors
    /// When the step is outside 1e-9 to 1.
    pub fn with_longest_step_s(mut self, step_s: f64) -> Result<Self, ArgumentError> {
        self.given_step_s = Some(require_within("longest_step_s", step_s, Self::STEP_S)?);
        Ok(self)
    }

    /// This model of a column, whose variations have the damping that gives this ratio of rates, if there is one; `None` if they have the damping time
    /// of this model.
    #[must_use]
    pub fn keeping_rebound(mut self, column: &Column, rate_ratio: Option<f64>) -> Self {
        self.rebound = rate_ratio.map(|rate_ratio| (column.clone(), rate_ratio));
        self
    }

    /// Row of blocks.
    pub const fn row(&self) -> &Row {
        &self.rigid.row
    }

    /// Equilibrium under this gravity.
    ///
    /// # Errors
    /// If there is no equilibrium, with the reason.
    pub fn rest(&self, gravity_m_s2: f64) -> Result<Equilibrium, RowMotionError> {
        let (known_m_s2, rest) = &self.rest;
        if gravity_m_s2 == *known_m_s2 {
            return Ok(rest.clone());
        }
        Ok(self.structure.rest([0.0, -gravity_m_s2])?)
    }

    /// Energy in J that the first mechanism of the row with rigid joints needs to overturn; `None` if unknown.
    pub fn barrier_j(&self, gravity_m_s2: f64) -> Option<f64> {
        self.rigid.barrier_j(gravity_m_s2)
    }

    /// Longest step of a motion, in seconds.
    pub fn longest_step_s(&self) -> f64 {
        let mut default_s = Self::default_step_s(&self.structure);
        if self.many_cases {
            default_s *= MANY_CASES_STEP_RATIO;
        }
        self.steps_times * self.given_step_s.unwrap_or(default_s)
    }

    /// Default of the longest step, in seconds.
    pub fn default_step_s(structure: &ElasticStructure) -> f64 {
        let frequency = structure.frequency_bound_rad_s();
        let damped = 0.5 * structure.damping_time_s * frequency / DAMPED;
        let [undamped, enough] = STEP_RATIO;
        let mut ratio = undamped + (enough - undamped) * damped.min(1.0);
        if structure.wall.is_some() {
            ratio *= WALL_STEP_RATIO;
        }
        ratio * structure.stable_step_s()
    }

    /// Copies with other steps, for repetitions. In studies of many cases those with longer steps come first.
    fn other_steps(&self) -> [(&'static str, Self); 6] {
        let mut others = OTHER_STEPS;
        if self.many_cases {
            others.reverse();
        }
        others.map(|(name, factor)| {
            let mut other = self.clone();
            other.steps_times *= factor;
            (name, other)
        })
    }

    /// Copies with other plausible properties: lower stiffness, higher stiffness, and another integration of the stress.
    pub fn variations(&self) -> Vec<Variation> {
        let stiffness = |power: i32| {
            let factor = libm::pow(10.0, f64::from(power) / STIFFNESSES_PER_DECADE);
            let other = self.properties.stiffness_times(factor);
            let (name, is_usual) = match other.stiffness {
                Stiffness::Uniform(JointStiffness { normal_pa_m, .. }) => {
                    let stiffness = format!("{:.2e}", 1e-9 * normal_pa_m);
                    let name = format!("{} GPa/m", short(stiffness.parse().unwrap_or(0.0)));
                    (name, USUAL_STIFFNESS_PA_M.contains(&normal_pa_m))
                }
                Stiffness::Materials(_) => {
                    (format!("{factor:.2} times the stiffness"), power.abs() <= 2)
                }
            };
            (power != 0 && (is_usual || power.abs() == 1)).then_some((name, other))
        };
        let (contact, words) = match self.properties.contact {
            Contact::Continuous => (Contact::Points(3), "three contact points"),
            Contact::Points(_) => (Contact::Continuous, "continuous contact"),
        };
        let mut summed_otherwise = self.properties;
        summed_otherwise.contact = contact;
        let others = MOST_POWERS
            .filter_map(stiffness)
            .chain([(words.to_owned(), summed_otherwise)]);
        let variation = |(name, properties): (String, ElasticProperties)| Variation {
            name,
            model: match self.varied(properties) {
                Ok(model) => Ok(Box::new(model)),
                Err(error) => Err(error.to_string()),
            },
        };
        others.map(variation).collect()
    }

    fn varied(&self, mut properties: ElasticProperties) -> Result<Self, RowModelError> {
        if let Some((column, rate_ratio)) = &self.rebound {
            // Where no damping gives the ratio, the damping time stays.
            properties.damping_time_s = match Self::damping_time_of_rebound_s(
                self.rest.0,
                column,
                &properties,
                *rate_ratio,
            ) {
                Err(RowModelError::Rebound(_)) => properties.damping_time_s,
                found => found?,
            };
        }
        let structure = ElasticStructure::of_row(self.row(), &properties)?;
        let structure = structure.on_supports(self.structure.supports);
        let structure = structure.with_wall(self.row(), self.structure.wall, &properties)?;
        Self::standing(self.rigid.clone(), properties, structure, self.rest.0)
    }

    /// Input of a motion, and the initial velocities of the blocks; empty at rest.
    fn input<'a>(
        &'a self,
        ground: &'a GroundMotion,
        request: &Request,
    ) -> Result<(MotionInput<'a>, Vec<Vector3<f64>>), SimulationError> {
        check(ground, request)?;
        let velocities = request
            .initial
            .map(|initial| self.velocities(initial))
            .transpose()?
            .unwrap_or_default();
        let (step_s, longest_s) = (self.longest_step_s(), self.structure.stable_step_s());
        if step_s > longest_s {
            let why = format!(
                "a step of {step_s:.3e} s is not stable with these joints: the longest one is {longest_s:.3e} s; leave \
                 longest_step_s out, or take a smaller stiffness or damping time"
            );
            return Err(RowMotionError::Failed(why).into());
        }
        let settings = Settings {
            longest_step_s: step_s,
            may_halve: self.given_step_s.is_none(),
            shortest_step_s: step_s,
            end_s: request.end_s,
            outcome_by_s: request.outcome_by_s,
            output_step_s: Some(request.output_step_s),
            ..Settings::default()
        };
        let settings = settings.within(Self::MOST_STEPS, TOO_LONG)?;
        let input = self.rigid.input(ground, request.gravity_m_s2, settings);
        Ok((input, velocities))
    }

    /// Velocities (m/s) and rotation rates of the blocks if the row starts with a rate in the first mechanism of rigid joints.
    ///
    /// # Errors
    /// If the row is rotated: elastic joints have no hinges about which blocks turn.
    fn velocities(&self, initial: Initial) -> Result<Vec<Vector3<f64>>, ArgumentError> {
        let rotation_rad = initial.rotation_rad;
        let allowed = "0 with elastic joints, which have no hinges to rotate about: they start under the weight of the structure";
        require(rotation_rad == 0.0, "rotation_rad", rotation_rad, allowed)?;
        let release = self.rigid.release(initial)?;
        let placement = &self.rigid.standing.placement;
        Ok(placement.velocities(&release.rates_rad_s))
    }

    fn simulate_one(
        &self,
        ground: &GroundMotion,
        request: &Request,
        recorder: Option<&mut dyn Recorder>,
        until: EndCondition,
    ) -> Result<Summary, SimulationError> {
        let gravity_m_s2 = request.gravity_m_s2;
        let (input, velocities) = self.input(ground, request)?;
        let rest = self.rest(gravity_m_s2)?;
        let barrier_j = || self.elastic_barrier_j(gravity_m_s2);
        // The cast shortens the lifetime of the recorder to that of the input.
        let recorder = recorder.map(|recorder| recorder as _);
        let start = (&self.structure, &rest);
        let mut group = Group::<1>::new(self.row(), start, gravity_m_s2, &barrier_j);
        group.begin_motion(0, (input, &velocities), until, recorder);
        self.checked_summary(stepper::step_to_end(group)?, &rest, gravity_m_s2)
    }

    /// Computes jobs on cases under one gravity, several in parallel.
    fn simulate_group(
        &self,
        rest: &Equilibrium,
        gravity_m_s2: f64,
        cases: &[Case],
        jobs: &mut dyn Jobs,
    ) {
        let repeated: Vec<Self> = self.other_steps().map(|(_, model)| model).into();
        let is_mirrored = |job: Job| self.repeats_mirrored && job.repetition == Some(0);
        let model_of = |job: Job| match job.repetition {
            Some(index) if !is_mirrored(job) => &repeated[index],
            _ => self,
        };
        // Mirrored ground motions, made when first needed.
        let mirrored: Vec<OnceCell<GroundMotion>> = vec![OnceCell::new(); cases.len()];
        let barrier_j = || self.elastic_barrier_j(gravity_m_s2);
        let start = (&self.structure, rest);
        let mut group = Group::<SIDE_BY_SIDE>::new(self.row(), start, gravity_m_s2, &barrier_j);
        let mut running = [None; SIDE_BY_SIDE];
        loop {
            let may_begin = group.may_begin();
            for (lane, running) in running.iter_mut().enumerate() {
                if let Some(job) = *running
                    && let Some(ended) = group.continue_lane(lane)
                {
                    let ended = ended.map_err(SimulationError::from);
                    let checked_summary =
                        |summary| model_of(job).checked_summary(summary, rest, gravity_m_s2);
                    let mut summary = ended.and_then(checked_summary);
                    if is_mirrored(job) {
                        summary = summary.map(|summary| summary.mirrored(Some(self.row())));
                    }
                    jobs.receive_result(job, summary);
                    *running = None;
                }
                while may_begin
                    && running.is_none()
                    && let Some(job) = jobs.next_job()
                {
                    let (given, request) = &cases[job.case];
                    let ground = match is_mirrored(job) {
                        true => mirrored[job.case].get_or_init(|| given.mirrored()),
                        false => given,
                    };
                    match model_of(job).input(ground, request) {
                        Ok((input, velocities)) => {
                            group.begin_motion(lane, (input, &velocities), job.until, None);
                            *running = Some(job);
                            group.continue_lane(lane);
                        }
                        Err(error) => jobs.receive_result(job, Err(error)),
                    }
                }
            }
            if running.iter().any(Option::is_some) {
                group.stride();
            } else if may_begin {
                break;
            }
        }
    }

    /// Summary of a motion with the largest eccentricity at rest.
    ///
    /// # Errors
    /// If the energy balance is wrong.
    fn checked_summary(
        &self,
        mut summary: Summary,
        rest: &Equilibrium,
        gravity_m_s2: f64,
    ) -> Result<Summary, SimulationError> {
        let Details::Elastic(row, elastic) = &mut summary.details else {
            unreachable!("its joints are elastic");
        };
        let (joint, ratio) = rest.largest_eccentricity(&self.structure);
        elastic.damping_time_s = self.structure.damping_time_s;
        elastic.rest_eccentricity_joint = joint;
        elastic.rest_eccentricity_ratio = ratio;
        // Stacks have no first mechanism with one degree of freedom and a known barrier, but the energy to push them over is known.
        if row.energy_error > LARGEST_ENERGY_ERROR
            && self.barrier_j(gravity_m_s2).is_none()
            && let Some(barrier_j) = self.elastic_barrier_j(gravity_m_s2)
        {
            let weight_n = self.row().mass_kg() * gravity_m_s2;
            let defect_j = summary.energy_defect_ratio * weight_n * self.row().size_m;
            row.energy_error = defect_j / barrier_j.max(row.largest_kinetic_j);
        }
        let step_s = SHORTER * self.longest_step_s();
        Ok(require_balance(summary, "elastic_joints", step_s)?)
    }
}

impl Model for ElasticJoints {
    fn repetitions(&self) -> Vec<Repetition> {
        let repetition = |(name, model): (&'static str, Self)| Repetition {
            name,
            model: Box::new(model),
        };
        Repetition::first_mirrored(self.other_steps().map(repetition).into(), self)
    }

    fn covers_mirrored(&self) -> bool {
        self.repeats_mirrored
    }

    fn repeat_mirrored(&mut self) {
        self.repeats_mirrored = self.rigid.is_symmetric();
    }

    fn for_many_cases(&self) -> Option<Box<dyn Model>> {
        self.given_step_s.is_none().then(|| {
            Box::new(Self {
                many_cases: true,
                ..self.clone()
            }) as _
        })
    }

    fn bodies(&self) -> Vec<String> {
        self.rigid.bodies()
    }

    fn slips(&self) -> bool {
        self.properties.friction_coefficient.is_some()
    }

    fn row(&self) -> Option<&Row> {
        Some(&self.rigid.row)
    }

    fn incipient_acceleration_g(&self, sway: Sway) -> Option<f64> {
        self.rigid.incipient_acceleration_g(sway)
    }

    fn simulate(
        &self,
        ground: &GroundMotion,
        request: &Request,
        recorder: Option<&mut dyn Recorder>,
    ) -> Result<Summary, SimulationError> {
        self.simulate_one(ground, request, recorder, EndCondition::End)
    }

    fn elastic_barrier_j(&self, gravity_m_s2: f64) -> Option<f64> {
        let find = || {
            let rest = self.rest(gravity_m_s2).ok()?;
            self.structure.barrier_j(&rest, gravity_m_s2)
        };
        let (known_m_s2, barrier_j) = self.barrier_j.get_or_init(|| (gravity_m_s2, find()));
        if gravity_m_s2 == *known_m_s2 {
            *barrier_j
        } else {
            find()
        }
    }

    fn has_impacts(&self) -> bool {
        false
    }

    fn has_pressures(&self) -> bool {
        true
    }

    fn moves_below_incipient(&self) -> bool {
        true
    }

    fn lanes(&self) -> usize {
        SIDE_BY_SIDE
    }

    fn simulate_until(&self, until: EndCondition, case: &Case) -> Result<Summary, SimulationError> {
        let (ground, request) = case;
        self.simulate_one(ground, request, None, until)
    }

    fn work(&self, cases: &[Case], jobs: &mut dyn Jobs) {
        let gravity_m_s2 = cases.first().map(|(_, request)| request.gravity_m_s2);
        let alike = |(_, request): &Case| Some(request.gravity_m_s2) == gravity_m_s2;
        if let Some(gravity_m_s2) = gravity_m_s2
            && cases.len() > 1
            && cases.iter().all(alike)
            && let Ok(rest) = self.rest(gravity_m_s2)
        {
            self.simulate_group(&rest, gravity_m_s2, cases, jobs);
            return;
        }
        one_by_one(self, cases, jobs);
    }
}
