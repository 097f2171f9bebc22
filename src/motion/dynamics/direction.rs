//! Directions of the horizontal ground motion: as given, and mirrored.
//!
//! The side to which a sensor or a pulse points is chance. A structure is therefore moved in both directions, unless the mirrored motion is the mirror
//! image of the motion as given: see [`Model::covers_mirrored`]. A mirrored ground motion has the opposite horizontal accelerations under both feet.
//! Feet are not exchanged, and an initial rotation keeps its side, so with two feet or an initial rotation the second direction is another problem
//! even for a symmetric structure.

use crate::dynamics::{
    Case, Model, Outcome, Recorder, Repetition, Request, SimulationError, Summary,
};
use crate::dynamics::{Details, EndCondition, GroundMotion, Job, Jobs, RowSummary};
use crate::mechanics::{Row, Sides, Sway};

named! {
    /// Direction of the horizontal ground motion.
    #[derive(Default, PartialOrd, Ord)]
    pub enum Direction {
        /// The ground moves as given.
        #[default]
        AsGiven = "as_given",
        /// Horizontal accelerations have the opposite sign.
        Mirrored = "mirrored",
    }
}

impl Direction {
    /// Direction in words.
    pub const fn in_words(self) -> &'static str {
        match self {
            Self::AsGiven => "as given",
            Self::Mirrored => "mirrored",
        }
    }
}

named! {
    /// Directions of the horizontal ground motion in which motions are computed.
    #[derive(Default)]
    pub enum Directions {
        /// As given and mirrored; the worse result counts.
        #[default]
        Both = "both",
        /// As given only.
        AsGiven = "as_given",
        /// Mirrored only: all horizontal accelerations change sign.
        Mirrored = "mirrored",
    }
}

impl Directions {
    /// Direction of the scenario's ground motion, which is computed first.
    pub const fn first(self) -> Direction {
        match self {
            Self::Both | Self::AsGiven => Direction::AsGiven,
            Self::Mirrored => Direction::Mirrored,
        }
    }

    /// Whether a motion is computed in a second direction: both directions are requested, the ground moves horizontally, and the motion does
    /// not [cover](Model::covers_mirrored) the mirrored ground.
    pub fn has_second(self, model: &dyn Model, ground: &GroundMotion, request: &Request) -> bool {
        let is_alike = ground.right_foot().is_none() && request.initial.is_none();
        self == Self::Both && ground.has_horizontal() && !(is_alike && model.covers_mirrored())
    }
}

/// Symmetric model under the mirrored ground. Its summaries are mirrored back, so that they are comparable with those of the model itself; samples and
/// events are those under the mirrored ground.
#[derive(Debug)]
pub(super) struct MirroredModel<M>(pub M);

impl<M: Model> Model for MirroredModel<M> {
    fn bodies(&self) -> Vec<String> {
        self.0.bodies()
    }

    fn incipient_acceleration_g(&self, sway: Sway) -> Option<f64> {
        self.0.incipient_acceleration_g(sway.opposite())
    }

    fn row(&self) -> Option<&Row> {
        self.0.row()
    }

    fn simulate(
        &self,
        ground: &GroundMotion,
        request: &Request,
        recorder: Option<&mut dyn Recorder>,
    ) -> Result<Summary, SimulationError> {
        let summary = self.0.simulate(&ground.mirrored(), request, recorder)?;
        Ok(summary.mirrored(self.row()))
    }

    fn elastic_barrier_j(&self, gravity_m_s2: f64) -> Option<f64> {
        self.0.elastic_barrier_j(gravity_m_s2)
    }

    fn slips(&self) -> bool {
        self.0.slips()
    }

    fn has_impacts(&self) -> bool {
        self.0.has_impacts()
    }

    fn has_pressures(&self) -> bool {
        self.0.has_pressures()
    }

    fn moves_below_incipient(&self) -> bool {
        self.0.moves_below_incipient()
    }

    fn lanes(&self) -> usize {
        self.0.lanes()
    }

    fn simulate_until(&self, until: EndCondition, case: &Case) -> Result<Summary, SimulationError> {
        let (ground, request) = case;
        let summary = self
            .0
            .simulate_until(until, &(ground.mirrored(), *request))?;
        Ok(summary.mirrored(self.row()))
    }

    fn work(&self, cases: &[Case], jobs: &mut dyn Jobs) {
        let mirrored = |(ground, request): &Case| (ground.mirrored(), *request);
        let cases: Vec<Case> = cases.iter().map(mirrored).collect();
        let row = self.row();
        self.0.work(&cases, &mut MirroredBack { jobs, row });
    }
}

/// Queue whose answers are mirrored.
struct MirroredBack<'a> {
    jobs: &'a mut dyn Jobs,
    row: Option<&'a Row>,
}

impl Jobs for MirroredBack<'_> {
    fn next_job(&mut self) -> Option<Job> {
        self.jobs.next_job()
    }

    fn receive_result(&mut self, job: Job, answer: Result<Summary, SimulationError>) {
        let row = self.row;
        self.jobs
            .receive_result(job, answer.map(|summary| summary.mirrored(row)));
    }
}

impl Outcome {
    /// Outcome of the mirrored motion.
    #[must_use]
    pub const fn mirrored(self) -> Self {
        match self {
            Self::Overturned(sway) => Self::Overturned(sway.opposite()),
            other => other,
        }
    }
}

impl Summary {
    /// Summary of the mirror image of the motion of a symmetric structure; `row` are its blocks, if it is a row.
    #[must_use]
    pub fn mirrored(mut self, row: Option<&Row>) -> Self {
        self.outcome = self.outcome.mirrored();
        if let Details::Mechanisms(of) = &mut self.details {
            let own_kg_m = of.largest_shifts_kg_m;
            of.largest_shifts_kg_m = Sides::of(|sway| *own_kg_m.get(sway.opposite()));
        }
        let Some(row) = row else { return self };
        self.peak_rotations_rad = (0..self.peak_rotations_rad.len())
            .map(|block| self.peak_rotations_rad[row.mirrored_block(block)])
            .collect();
        match &mut self.details {
            Details::Mechanisms(_) => {}
            Details::Rigid(summary) => summary.mirror(row),
            Details::Elastic(summary, elastic) => {
                summary.mirror(row);
                let joints = [
                    &mut elastic.largest_stress.joint,
                    &mut elastic.rest_eccentricity_joint,
                ];
                for joint in joints {
                    *joint = row.opposite_joint(*joint);
                }
            }
        }
        self
    }
}

impl RowSummary {
    /// Exchanges left and right.
    fn mirror(&mut self, row: &Row) {
        for cycle in &mut self.half_cycles {
            cycle.sway = cycle.sway.opposite();
        }
        if let Some(sliding) = &mut self.sliding {
            let joints = 0..row.joints.len();
            let opposite = |values_m: &[f64], sign: f64| {
                let of = |joint| sign * values_m[row.opposite_joint(joint)];
                joints.clone().map(of).collect()
            };
            // The right face becomes the left one, and offsets of the right face relative to the left one change sign.
            sliding.offsets_m = opposite(&sliding.offsets_m, -1.0);
            sliding.largest_offsets_m = opposite(&sliding.largest_offsets_m, 1.0);
        }
        if let Some(opposite) = row.opposite_ties()
            && self.ties.len() == opposite.len()
        {
            self.ties = opposite.iter().map(|tie| self.ties[*tie]).collect();
        }
    }
}

impl Repetition {
    /// Name of the repetition under the mirrored ground.
    pub const MIRRORED: &'static str = "mirrored";

    /// Repetition of a symmetric model under the mirrored ground.
    pub(super) fn mirrored(model: impl Model + 'static) -> Self {
        Self {
            name: Self::MIRRORED,
            model: Box::new(MirroredModel(model)),
        }
    }

    /// These repetitions; the first one is mirrored if the model [covers](Model::covers_mirrored) the mirrored ground by repetitions.
    pub(super) fn first_mirrored(
        mut repetitions: Vec<Self>,
        model: &(impl Model + Clone + 'static),
    ) -> Vec<Self> {
        if model.covers_mirrored() {
            repetitions[0] = Self::mirrored(model.clone());
        }
        repetitions
    }
}
