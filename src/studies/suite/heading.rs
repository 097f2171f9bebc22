//! The parts of a scenario that the report of its suite needs.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::{CaseRow, SuiteFragility};
use crate::argument::plain;
use crate::dynamics::{Direction, Directions};
use crate::output::caption::caption;
use crate::output::{Figure, Origin, Scale};
use crate::scenario::{
    Measure, ModelKind, Scenario, Sequence, Spacing, Spectral, Suite, UnitGround, Varied,
};
use crate::studies::format_edge;
use crate::studies::page::{CaseScenario, PageCases};
use crate::studies::quotable::{SlipWords, restitution_in_words};
use crate::studies::report::Warnings;

/// The parts of a scenario that the report of its suite needs. Part files keep them, so that `merge` needs no record files.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Heading {
    pub(in crate::studies) title: Option<String>,
    /// The scenario with all defaults.
    pub(super) scenario: Value,
    /// The model of motion.
    pub(in crate::studies) model: &'static ModelKind,
    pub(super) is_arch: bool,
    /// The measure of the intensities.
    pub measure: Measure,
    /// Spacing of the levels; `None` if each record acts once, unscaled.
    spacing: Option<Spacing>,
    /// True if each record acts in both directions, in cases of their own.
    has_both: bool,
    pub(super) directions: Directions,
    pub(super) spectral: Spectral,
    /// Warnings about unlikely numbers of the scenario.
    #[serde(flatten)]
    pub(super) warnings: Warnings,
    /// The scenario in one line.
    #[serde(default)]
    pub(super) what: String,
    /// The words about its friction.
    #[serde(default)]
    pub(super) slip: SlipWords,
    /// The assumed restitution, in words; `None` unless the model is one rigid block.
    #[serde(default)]
    pub(super) restitution: Option<String>,
    /// Each record with a peak of 1 g.
    #[serde(default)]
    unit_grounds: Vec<UnitGround>,
}

impl Heading {
    /// Makes the heading of a scenario with this suite. `has_both` is true if each record acts in both directions, in cases of their own.
    pub(super) fn new(scenario: &Scenario, suite: &Suite, has_both: bool) -> Self {
        Self {
            title: scenario.title.clone(),
            scenario: scenario.to_json(),
            model: scenario.motion.kind,
            is_arch: scenario.structure.has_horizontal_thrust(),
            measure: suite.measure,
            spacing: suite.levels.as_ref().map(Sequence::spacing),
            has_both,
            directions: scenario.simulation.direction,
            spectral: suite.spectral,
            warnings: Warnings::new(scenario.unlikely_in(&Varied::default()), []),
            // The records of the suite replace the ground motion of the scenario.
            what: caption(&scenario.with_ground(None), &[]),
            slip: SlipWords::of(scenario),
            restitution: restitution_in_words(scenario),
            unit_grounds: suite.unit_grounds(scenario.gravity_m_s2()),
        }
    }

    /// Origin of the results, without their records.
    pub(in crate::studies) fn origin(&self) -> Origin {
        Origin::of_tables(&self.scenario)
    }

    pub(super) fn title(&self) -> &str {
        let otherwise = "Fragility under a suite of records";
        self.title.as_deref().unwrap_or(otherwise)
    }

    /// True if each record acts once, unscaled.
    pub(super) const fn is_as_recorded(&self) -> bool {
        self.spacing.is_none()
    }

    /// Gravity of the scenario, which has all defaults.
    pub(super) fn gravity_m_s2(&self) -> f64 {
        let own = self.scenario["simulation"]["gravity_m_s2"].as_f64();
        own.unwrap_or(f64::NAN)
    }

    /// Axis of the intensities: its label, and the scale from a little below the lowest level to a little above the highest.
    pub(super) fn axis(&self, results: &SuiteFragility, figure: Figure) -> (&'static str, Scale) {
        let ends = [results.levels.first(), results.levels.last()];
        let [low, high] = ends.map(|level| level.map_or(1.0, |level| level.intensity));
        let label = match self.measure {
            Measure::Scale => "scale factor",
            Measure::PeakG => "peak ground acceleration (g)",
        };
        let scale = match self.spacing {
            Some(Spacing::Logarithmic) => {
                let margin = libm::pow(high / low, 0.05);
                Scale::logarithmic(low / margin, high * margin)
            }
            _ => Scale::exactly(0.0, 1.05 * high, figure.ticks(8)),
        };
        (label, scale)
    }

    /// Adds a text for each record to the cases of a page: the scenario under this record. Returns the index of the first.
    pub(super) fn add_texts(&self, cases: &mut PageCases) -> usize {
        let first = cases.texts.len();
        for unit in &self.unit_grounds {
            let mut ground = unit.ground.clone();
            // The right foot follows with its delay.
            if let Some(right) = self.scenario["ground"].get("right") {
                ground["right"] = right.clone();
            }
            let mut scenario = self.scenario.clone();
            scenario["ground"] = ground;
            cases.add_text(&scenario, false);
        }
        first
    }

    /// Scenario of a case, whose text is among those of [`Heading::add_texts`].
    pub(super) fn scenario_of(&self, case: &CaseRow, first: usize) -> Option<CaseScenario> {
        let mut known = self.unit_grounds.iter();
        let record = known.position(|unit| unit.record == case.record)?;
        let UnitGround { key, value, .. } = &self.unit_grounds[record];
        let scenario = CaseScenario::of(first + record, [(key, value * case.peak_g)]);
        let direction = match case.mirrored {
            true => Direction::Mirrored,
            false => Direction::AsGiven,
        };
        Some(match self.has_both {
            true => scenario.in_direction(direction),
            false => scenario,
        })
    }

    /// Level of a case in words.
    pub(super) fn level(&self, case: &CaseRow) -> String {
        let (name, level) = match self.is_as_recorded() {
            true => ("peak_g", format_edge(case.peak_g)),
            false => (self.measure.name(), plain(case.level(self.measure))),
        };
        format!("{name} {level}")
    }
}
