//! Reports a suite of records: its table, the fragility of the structure, and its words.

use serde_json::{Value, json};

use super::fragility::{Errors, Fragility, NoFit};
use super::ida::{Fractiles, PeakUpTo};
use super::strength::{Capacity, Efficiency, MEASURES, efficiencies};
use super::{CaseRow, CurvePoint, FragilityRow, SuiteFragility, ida, picture};
use crate::argument::plain;
use crate::output::table::{Cell, Column, column, csv, several};
use crate::output::{Figure, OutputError, finite, pretty};
use crate::scenario::{Measure, Scenario, Spacing, Spectral, Suite, shown};
use crate::studies::ending::Verdict;
use crate::studies::ending::columns::{self, FAILED, number, yes};
use crate::studies::remarks::{Remarks, counts, in_words, rough_guide_of, warnings};
use crate::studies::results::Results;
use crate::studies::threshold::rounded;
use crate::studies::threshold::survival;

const FRAGILITY: &str = "fragility.json";

/// Names of the files, the seal last.
pub const FILES: [&str; 10] = [
    "suite.svg",
    "ida.svg",
    "peaks.svg",
    "ida.csv",
    "peaks.csv",
    "capacity.csv",
    "intensity.csv",
    "fragility.csv",
    FRAGILITY,
    "suite.csv",
];

/// What the results of a suite report about its scenario. The text of the resolved scenario is enough for that, so parts
/// can be joined where the records are not at hand.
#[derive(Clone, Debug, PartialEq)]
pub struct Heading {
    scenario: Value,
    /// The measure of the intensities.
    pub measure: Measure,
    pub(super) spacing: Spacing,
    warnings: Vec<String>,
}

impl Heading {
    /// The heading of a scenario with this suite.
    #[must_use]
    pub fn of(scenario: &Scenario, suite: &Suite) -> Self {
        Self {
            scenario: scenario.to_json(),
            measure: suite.measure,
            spacing: suite.levels.spacing(),
            warnings: warnings(scenario),
        }
    }

    /// The heading from the text of a scenario with every default filled in, and the warnings about it; `None` if it has no suite.
    #[must_use]
    pub fn of_resolved(scenario: &str, warnings: Vec<String>) -> Option<Self> {
        let scenario: Value = toml::from_str(scenario).ok()?;
        let suite = scenario.get("suite")?;
        let (measure, levels) = Measure::ALL
            .iter()
            .find_map(|measure| Some((*measure, suite.get(measure.name())?)))?;
        let logarithmic = levels["spacing"] == Spacing::Logarithmic.name();
        let spacing = if logarithmic {
            Spacing::Logarithmic
        } else {
            Spacing::Linear
        };
        Some(Self {
            scenario,
            measure,
            spacing,
            warnings,
        })
    }

    /// The files and words for all rows.
    ///
    /// # Errors
    /// When a value is not finite.
    pub fn tell(&self, rows: Vec<CaseRow>, figure: Figure) -> Result<Results, OutputError> {
        let results = SuiteFragility::new(self.measure, rows);
        let summary = to_json(self, &results)?;
        Ok(Results {
            peaks: ida::rotations_rad(&results.cases),
            files: vec![
                (
                    "suite.svg",
                    picture::draw(figure, self, &results).into_bytes(),
                ),
                ("ida.svg", ida::draw(figure, self, &results).into_bytes()),
                (
                    "peaks.svg",
                    ida::draw_peaks(figure, self, &results).into_bytes(),
                ),
                (
                    "ida.csv",
                    csv(self.ida_columns(), &ida::fractiles(&results))?,
                ),
                ("peaks.csv", csv(peak_columns(), &ida::peaks(&results))?),
                (
                    "capacity.csv",
                    csv(self.capacity_columns(), &results.capacities())?,
                ),
                (
                    "intensity.csv",
                    csv(efficiency_columns(), &efficiencies(&results.capacities()))?,
                ),
                ("fragility.csv", csv(self.level_columns(), &results.levels)?),
                (FRAGILITY, pretty(&summary).into_bytes()),
                ("suite.csv", csv(self.case_columns(), &results.cases)?),
            ],
            words: words(self, &results),
            summary,
        })
    }

    /// The columns for one row per case.
    fn case_columns(&self) -> Vec<Column<'static, CaseRow>> {
        let mut all = vec![
            column("record", |case: &CaseRow| shown(&case.record)),
            column(
                "sign",
                |case: &CaseRow| if case.mirrored { "-1" } else { "1" },
            ),
            column("scale", |case: &CaseRow| number(case.scale)),
            column("peak_g", |case: &CaseRow| number(case.peak_g)),
        ];
        all.extend(columns::columns(self.has_joints(), |case: &CaseRow| {
            case.result.as_ref().map_err(|_| FAILED)
        }));
        all
    }

    /// The columns for one row per level. Missing values are empty.
    fn level_columns(&self) -> Vec<Column<'static, FragilityRow>> {
        type Curve = fn(&FragilityRow) -> Option<CurvePoint>;
        let probability = |[probability, low, high]: [&'static str; 3], curve: Curve| {
            [
                column(probability, move |level| {
                    curve(level).map(|point| point.probability)
                }),
                column(low, move |level| curve(level).map(|point| point.low)),
                column(high, move |level| curve(level).map(|point| point.high)),
            ]
        };
        let mut all = vec![
            column(self.measure.column(), |level: &FragilityRow| {
                level.intensity
            }),
            column("cases", |level: &FragilityRow| level.cases),
            column("overturned", |level: &FragilityRow| level.overturned),
            column("still_rocking", |level: &FragilityRow| level.still_rocking),
            column("incomplete", |level: &FragilityRow| level.incomplete),
            column("failed", |level: &FragilityRow| level.failed),
            column("fraction", FragilityRow::fraction),
        ];
        let names = ["probability", "probability_low", "probability_high"];
        all.extend(probability(names, |level| level.curve));
        if self.has_joints() {
            // The number of uncertain cases, and the columns that count them as overturned.
            all.extend([
                column("uncertain", |level: &FragilityRow| level.uncertain),
                column(
                    "fraction_with_uncertain",
                    FragilityRow::fraction_with_uncertain,
                ),
            ]);
            let names = [
                "probability_with_uncertain",
                "probability_with_uncertain_low",
                "probability_with_uncertain_high",
            ];
            all.extend(probability(names, |level| level.curve_with_uncertain));
        }
        all
    }

    /// The columns for one row per level of the incremental dynamic analysis.
    fn ida_columns(&self) -> Vec<Column<'static, Fractiles>> {
        vec![
            column(self.measure.column(), |level: &Fractiles| level.intensity),
            column("cases", |level: &Fractiles| level.cases),
            column("overturned", |level: &Fractiles| level.overturned),
            column("peak_16", |level: &Fractiles| level.peaks[0]),
            column("peak_50", |level: &Fractiles| level.peaks[1]),
            column("peak_84", |level: &Fractiles| level.peaks[2]),
        ]
    }

    /// The columns for one row per record. Missing values are empty.
    fn capacity_columns<'r>(&self) -> Vec<Column<'r, Capacity<'r>>> {
        let measures = MEASURES.map(|(name, _, _)| name.to_owned()).to_vec();
        vec![
            column("record", |capacity: &Capacity<'_>| shown(capacity.record)),
            column(
                "sign",
                |capacity: &Capacity<'_>| if capacity.mirrored { "-1" } else { "1" },
            ),
            column("scale", |capacity: &Capacity<'_>| capacity.scale),
            several(
                measures,
                |capacity: &Capacity<'_>, cells: &mut Vec<Cell<'_>>| {
                    cells.extend(capacity.in_measures.map(Cell::from));
                },
            ),
            column("at_most", |capacity: &Capacity<'_>| yes(capacity.at_most)),
        ]
    }

    /// What a measure of intensity is called.
    fn measure_in_words(&self, measure: usize) -> String {
        let (name, words, _) = MEASURES[measure];
        if name != "spectral_acceleration_g" {
            return words.to_owned();
        }
        let of = |key: &str, default: f64| {
            let own = self.scenario["suite"].get(key).and_then(Value::as_f64);
            plain(own.unwrap_or(default))
        };
        let Spectral {
            period_s,
            damping_percent,
        } = Spectral::DEFAULT;
        format!(
            "{words} at {} s and {} %",
            of("spectral_period_s", period_s),
            of("spectral_damping_percent", damping_percent)
        )
    }

    fn has_joints(&self) -> bool {
        let tables = ["free_hinges", "elastic_joints"];
        tables
            .iter()
            .any(|table| self.scenario.get(*table).is_some())
    }

    pub(super) fn title(&self) -> &str {
        let title = self.scenario.get("title").and_then(Value::as_str);
        title.unwrap_or("Fragility under a suite of records")
    }
}

/// A row per measure of intensity, the most efficient first.
fn efficiency_columns() -> Vec<Column<'static, Efficiency>> {
    vec![
        column("measure", |of: &Efficiency| MEASURES[of.measure].0),
        column("capacities", |of: &Efficiency| of.capacities),
        column("median", |of: &Efficiency| of.median),
        column("dispersion", |of: &Efficiency| of.dispersion),
        column("dispersion_of_factor", |of: &Efficiency| {
            of.dispersion_of_factor
        }),
        column("dispersion_of_factor_low", |of: &Efficiency| {
            of.dispersion_of_factor_interval.map(|[low, _]| low)
        }),
        column("dispersion_of_factor_high", |of: &Efficiency| {
            of.dispersion_of_factor_interval.map(|[_, high]| high)
        }),
        column("best_share", |of: &Efficiency| of.best_share),
    ]
}

/// The distribution of peaks: a row per case that did not overturn.
fn peak_columns() -> Vec<Column<'static, PeakUpTo>> {
    vec![
        column("peak", |at: &PeakUpTo| at.peak),
        column("share", |at: &PeakUpTo| at.share),
    ]
}

/// The number of records, in words.
pub(super) fn records_in_words(results: &SuiteFragility) -> String {
    match results.record_count() {
        1 => "1 record".to_owned(),
        count => format!("{count} records"),
    }
}

/// The fragility as JSON. Missing values are null.
///
/// # Errors
/// When a value is not finite.
fn to_json(heading: &Heading, results: &SuiteFragility) -> Result<Value, OutputError> {
    let total =
        |count: fn(&FragilityRow) -> usize| -> usize { results.levels.iter().map(count).sum() };
    let remarks = remarks(results);
    let mut json = json!({
        "program": env!("CARGO_PKG_NAME"),
        "version": env!("CARGO_PKG_VERSION"),
        "scenario": heading.scenario,
        "warnings": remarks.with_incomplete(heading.warnings.clone()),
        "intensity": results.measure.column(),
    });
    let curve = curve_to_json(&results.fit)?;
    if let (Some(json), Value::Object(curve)) = (json.as_object_mut(), curve) {
        json.extend(curve);
    }
    let counts = [
        ("records", results.record_count()),
        ("cases", total(|level| level.cases)),
        ("overturned", total(|level| level.overturned)),
        ("uncertain", total(|level| level.uncertain)),
        (
            "still_rocking_counted_as_not_overturned",
            total(|level| level.still_rocking),
        ),
        ("incomplete_left_out", total(|level| level.incomplete)),
        ("failed_left_out", total(|level| level.failed)),
    ];
    for (name, count) in counts {
        json[name] = json!(count);
    }
    let capacities = results.capacities();
    let measures = efficiencies(&capacities).into_iter().map(|of| {
        json!({
            "measure": MEASURES[of.measure].0,
            "capacities": of.capacities,
            "median": of.median,
            "dispersion": of.dispersion,
            "dispersion_of_factor": of.dispersion_of_factor,
            "dispersion_of_factor_interval": of.dispersion_of_factor_interval,
            "best_share": of.best_share,
        })
    });
    json["intensity_measures"] = measures.collect();
    json["mirrored_cases_count"] = json!(results.mirrored_count);
    json["records_that_never_overturn"] = json!(results.always(Verdict::Survives));
    json["records_that_always_overturn"] = json!(results.always(Verdict::Overturns));
    if results.has_uncertain() {
        json["with_uncertain_as_overturned"] = curve_to_json(&results.fit_with_uncertain)?;
    }
    remarks.add_to(&mut json);
    Ok(json)
}

/// A curve with its standard errors, or why there is none.
fn curve_to_json(fit: &Result<Fragility, NoFit>) -> Result<Value, OutputError> {
    let no_fit = fit.as_ref().err().map(ToString::to_string);
    let fit = fit.as_ref().ok();
    let errors = |errors: Option<&Errors>| {
        errors.map_or([None; 2], |errors| {
            [Some(errors.median), Some(errors.dispersion)]
        })
    };
    let [median_error, dispersion_error] = errors(fit.map(|fit| &fit.independent));
    let [median_error_by_record, dispersion_error_by_record] =
        errors(fit.and_then(|fit| fit.clustered.as_ref()));
    let mut json = json!({});
    for (name, value) in [
        ("median", fit.map(|fit| fit.median)),
        ("median_standard_error", median_error),
        ("median_standard_error_by_record", median_error_by_record),
        ("dispersion", fit.map(|fit| fit.dispersion)),
        ("dispersion_standard_error", dispersion_error),
        (
            "dispersion_standard_error_by_record",
            dispersion_error_by_record,
        ),
        ("log_likelihood", fit.map(|fit| fit.log_likelihood)),
    ] {
        finite("of fragility.json", value.as_slice())?;
        json[name] = json!(value);
    }
    json["no_fit"] = json!(no_fit);
    Ok(json)
}

/// The remarks on the cases: those that failed or are uncertain, with the reasons.
fn remarks(results: &SuiteFragility) -> Remarks {
    let mut remarks = Remarks::default();
    for case in &results.cases {
        let name = || {
            let mirrored = if case.mirrored { " mirrored" } else { "" };
            let (column, level) = (results.measure.column(), case.level(results.measure));
            format!("{}{mirrored}, {column} {}", case.record, plain(level))
        };
        remarks.note(name, case.result.as_ref().map_err(String::as_str));
    }
    remarks
}

/// A curve in words, or why there is none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct CurveInWords {
    /// How uncertain cases are counted: `, 2 uncertain cases taken as survived`; empty if there are none.
    pub(super) taken: String,
    /// The curve, or the reason.
    pub(super) curve: Result<String, String>,
}

/// The curve in words; if cases are uncertain, first with these counted as survived, then as overturned.
pub(super) fn curves_in_words(results: &SuiteFragility) -> Vec<CurveInWords> {
    let uncertain: usize = results.levels.iter().map(|level| level.uncertain).sum();
    let curve = |fit: &Result<Fragility, NoFit>, how: &str| CurveInWords {
        taken: match uncertain {
            0 => String::new(),
            1 => format!(", 1 uncertain case taken as {how}"),
            _ => format!(", {uncertain} uncertain cases taken as {how}"),
        },
        curve: match fit {
            Ok(fit) => Ok(fit_in_words(fit, results.measure)),
            Err(reason) => Err(reason.to_string()),
        },
    };
    let mut curves = vec![curve(&results.fit, "survived")];
    if uncertain > 0 {
        curves.push(curve(&results.fit_with_uncertain, "overturned"));
    }
    curves
}

/// A curve in words, with its standard errors; those by record come last.
fn fit_in_words(fit: &Fragility, measure: Measure) -> String {
    let unit = unit(measure);
    let quantity = |value: f64, error: fn(&Errors) -> f64, unit: &str| {
        let independent = error(&fit.independent);
        // An error has at most two significant digits.
        let digits = digits(independent);
        let by_record = fit.clustered.as_ref().map_or(String::new(), |clustered| {
            format!(" (by record ± {:.digits$}{unit})", error(clustered))
        });
        format!("{value:.digits$}{unit} ± {independent:.digits$}{unit}{by_record}")
    };
    format!(
        "median {}, dispersion {}",
        quantity(fit.median, |errors| errors.median, unit),
        quantity(fit.dispersion, |errors| errors.dispersion, "")
    )
}

/// Number of decimals that show two digits of an error.
fn digits(error: f64) -> usize {
    (1.0 - error.log10().floor()).clamp(0.0, 12.0) as usize
}

/// The results in words, line by line.
fn words(heading: &Heading, results: &SuiteFragility) -> String {
    let mut lines = vec![counted(results)];
    let column = results.measure.column();
    let curves = curves_in_words(results).into_iter();
    lines.extend(curves.map(|CurveInWords { taken, curve }| match curve {
        Ok(curve) => format!("fragility over {column}{taken}: {curve}\n    ({FIT})"),
        Err(reason) => format!("no fragility curve{taken}: {reason}"),
    }));
    lines.extend(measures_in_words(heading, results));
    for record in results.survivals() {
        let mirrored = if record.mirrored { " mirrored" } else { "" };
        let words = survival::in_words(&record.survival, unit(results.measure));
        lines.push(format!("{}{mirrored}: {words}", record.record));
    }
    lines.push(searched(results));
    lines.extend(rough_guide_of(&heading.warnings).map(str::to_owned));
    if results.cases.iter().any(CaseRow::still_rocking) {
        lines.push("those still rocking at the end count as not overturned".to_owned());
    }
    let remarks = remarks(results);
    if let Some(words) = remarks.incomplete_in_words() {
        lines.push(format!("{words}; they do not count"));
    }
    lines.extend(remarks.uncertain_in_words(FRAGILITY));
    if let Some(words) = remarks.failed_in_words(FRAGILITY) {
        lines.push(format!("{words}; what failed does not count"));
    }
    lines.join("\n  ")
}

/// Definition of the fitted curve, whose median is not that of the capacities.
const FIT: &str = "the lognormal curve that fits all cases best; cases that survive above the first overturning count too";

/// The levels that were tried, and between which overturning was not searched for.
fn searched(results: &SuiteFragility) -> String {
    let ends = [results.levels.first(), results.levels.last()];
    let [from, to] = ends.map(|level| rounded(level.map_or(0.0, |level| level.intensity)));
    let unit = unit(results.measure);
    format!(
        "tried: {} levels from {from} to {to}{unit}; where a record first overturns is bisected between two of them, and lower ranges that \
         overturn, below the first level or between levels, were not searched for",
        results.levels.len()
    )
}

/// Which measure of intensity tells best what overturns.
fn measures_in_words(heading: &Heading, results: &SuiteFragility) -> Option<String> {
    let capacities = results.capacities();
    let all = efficiencies(&capacities);
    let (best, others) = all.split_first()?;
    let of = |one: &Efficiency| {
        let interval = one.dispersion_of_factor_interval;
        let interval = interval.map_or(String::new(), |[low, high]| {
            format!(" ({low:.2} to {high:.2})")
        });
        format!(
            "{} {:.2}{interval}",
            heading.measure_in_words(one.measure),
            one.dispersion_of_factor
        )
    };
    let others: Vec<String> = others.iter().map(of).collect();
    let left_out = match capacities.len() - best.capacities {
        0 => String::new(),
        count => format!(
            "; {count} of {} that do not overturn are left out",
            capacities.len()
        ),
    };
    Some(format!(
        "most efficient measure of intensity: {}; {}\n    (dispersion of the factor on a record that overturns, 95 % by bootstrap over \
         records; the first is the best in {:.0} % of the draws){left_out}",
        of(best),
        others.join(", "),
        100.0 * best.best_share
    ))
}

/// The number of cases with each outcome.
fn counted(results: &SuiteFragility) -> String {
    let words = |case: &CaseRow| case.result.as_ref().map_or((5, "failed"), in_words);
    format!(
        "{} cases of {}: {}",
        results.cases.len(),
        records_in_words(results),
        counts(results.cases.iter().map(words))
    )
}

/// The unit that follows an intensity.
const fn unit(measure: Measure) -> &'static str {
    match measure {
        Measure::Scale => "",
        Measure::PeakG => " g",
    }
}
