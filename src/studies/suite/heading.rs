//! The parts of a scenario that the report of its suite needs.

use serde_json::Value;

use super::{CaseRow, SuiteFragility};
use crate::argument::plain;
use crate::output::{Figure, Scale};
use crate::scenario::{FOUR_LINKS, MODELS, Measure, ModelKind, Spacing, Spectral};

/// The parts of a scenario that the report of its suite needs. They come from the text of the resolved scenario, so that `merge` needs no record
/// files.
#[derive(Clone, Debug, PartialEq)]
pub struct Heading {
    pub(super) scenario: Value,
    /// The measure of the intensities.
    pub measure: Measure,
    spacing: Spacing,
    pub(super) warnings: Vec<String>,
}

impl Heading {
    /// Reads the text of a scenario with every default filled in. `warnings` are the warnings about the scenario. `None` if the scenario has no
    /// suite.
    pub fn of_resolved(scenario: &str, warnings: Vec<String>) -> Option<Self> {
        let scenario: Value = toml::from_str(scenario).ok()?;
        let suite = scenario.get("suite")?;
        let (measure, levels) = Measure::ALL
            .iter()
            .find_map(|measure| Some((*measure, suite.get(measure.name())?)))?;
        let spacing = serde_json::from_value(levels["spacing"].clone());
        Some(Self {
            spacing: spacing.unwrap_or(Spacing::Linear),
            scenario,
            measure,
            warnings,
        })
    }

    pub(super) fn model(&self) -> &'static ModelKind {
        let mut models = MODELS.into_iter().rev();
        let own = models.find(|model| self.scenario.get(model.table).is_some());
        own.unwrap_or(&FOUR_LINKS)
    }

    pub(super) fn title(&self) -> &str {
        let title = self.scenario.get("title").and_then(Value::as_str);
        title.unwrap_or("Fragility under a suite of records")
    }

    /// Returns the oscillator of the spectral acceleration in words: period and damping.
    pub(super) fn spectral(&self) -> String {
        let of = |key: &str, default: f64| {
            let own = self.scenario["suite"].get(key).and_then(Value::as_f64);
            plain(own.unwrap_or(default))
        };
        let default = Spectral::DEFAULT;
        let period_s = of("spectral_period_s", default.period_s);
        let damping_percent = of("spectral_damping_percent", default.damping_percent);
        format!("{period_s} s and {damping_percent} %")
    }

    /// Returns the axis of the intensities: its label, and the scale from a little below the lowest level to a little above the highest.
    pub(super) fn axis(&self, results: &SuiteFragility, figure: Figure) -> (&'static str, Scale) {
        let ends = [results.levels.first(), results.levels.last()];
        let [low, high] = ends.map(|level| level.map_or(1.0, |level| level.intensity));
        let label = match self.measure {
            Measure::Scale => "scale factor",
            Measure::PeakG => "peak ground acceleration (g)",
        };
        let scale = match self.spacing {
            Spacing::Logarithmic => {
                let margin = (high / low).powf(0.05);
                Scale::logarithmic(low / margin, high * margin)
            }
            Spacing::Linear => Scale::exactly(0.0, 1.05 * high, figure.ticks(8)),
        };
        (label, scale)
    }

    /// Returns the level of a case in words.
    pub(super) fn level(&self, case: &CaseRow) -> String {
        let level = plain(case.level(self.measure));
        format!("{} {level}", self.measure.column())
    }
}
