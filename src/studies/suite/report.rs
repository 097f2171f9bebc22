//! Files and words of a suite of records: tables, pictures, fragility.

use serde::Serialize;
use serde_json::Value;

use super::fragility::{Errors, Fragility, NoFit};
use super::ida::Fractiles;
use super::strength::{Capacity, Efficiency, MEASURES, efficiencies, few};
use super::{CaseRow, Counts, FragilityRow, Heading, SuiteFragility, ida, picture};
use crate::output::{Column, Figure, OutputError, column, csv, each, fields, list};
use crate::scenario::{Measure, shown};
use crate::studies::ending::columns::{self, FAILED, yes};
use crate::studies::quotable::{self, ModelAnswer};
use crate::studies::threshold::survival::{self, Survival};
use crate::studies::{OutcomeCounts, Remarks, Results, Verdict, rounded, rounded_down};

const FRAGILITY: &str = "fragility.json";

/// Names of the files, the seal last.
pub const FILES: [&str; 10] = [
    "suite.svg",
    "ida.svg",
    "peaks.svg",
    "ida.csv",
    "peaks.csv",
    "capacities.csv",
    "intensity.csv",
    "fragility.csv",
    FRAGILITY,
    "suite.csv",
];

/// Summary of a suite of records. Missing values are null.
#[derive(Serialize)]
pub struct Summary<'a> {
    /// Name of the program.
    program: &'static str,
    /// Version of the program.
    version: &'static str,
    /// The scenario with all defaults.
    scenario: &'a Value,
    /// Warnings about unlikely numbers, limits of the model, and histories without a verdict.
    warnings: Vec<String>,
    /// The answer that may be quoted, in words.
    to_quote: Option<String>,
    /// The measure of the intensities.
    intensity: &'static str,
    #[serde(flatten)]
    curve: Curve,
    /// Number of records.
    records: usize,
    #[serde(flatten)]
    counts: Counts,
    /// Measures of intensity, the most efficient first.
    intensity_measures: Vec<Efficiency>,
    /// True if mirrored records count because their results are not mirror images.
    mirrored_cases_count: bool,
    /// Records that never overturn the structure.
    records_that_never_overturn: Vec<&'a str>,
    /// Records that overturn the structure at every level.
    records_that_always_overturn: Vec<&'a str>,
    /// The curve with uncertain, incomplete and failed cases counted as survived, if there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    with_uncertain_as_survived: Option<Curve>,
    /// The curve with uncertain, incomplete and failed cases counted as overturned, if there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    with_uncertain_as_overturned: Option<Curve>,
    #[serde(flatten)]
    remarks: Remarks,
}

/// A fragility curve with its standard errors, or the reason why there is none.
#[derive(Serialize)]
struct Curve {
    /// The intensity at which half of the cases overturn.
    median: Option<f64>,
    /// Standard error of the median if all cases are independent.
    median_standard_error: Option<f64>,
    /// Standard error of the median if the cases of a record depend on each other.
    median_standard_error_by_record: Option<f64>,
    /// Standard deviation of the logarithm of the overturning intensity.
    dispersion: Option<f64>,
    /// Standard error of the dispersion if all cases are independent.
    dispersion_standard_error: Option<f64>,
    /// Standard error of the dispersion if the cases of a record depend on each other.
    dispersion_standard_error_by_record: Option<f64>,
    /// The maximum of the log-likelihood.
    log_likelihood: Option<f64>,
    /// The reason why there is no curve.
    no_fit: Option<String>,
}

impl From<&Result<Fragility, NoFit>> for Curve {
    fn from(found: &Result<Fragility, NoFit>) -> Self {
        let fit = found.as_ref().ok();
        let by_record = fit.and_then(|fit| fit.clustered);
        Self {
            median: fit.map(|fit| fit.median),
            median_standard_error: fit.map(|fit| fit.independent.median),
            median_standard_error_by_record: by_record.map(|errors| errors.median),
            dispersion: fit.map(|fit| fit.dispersion),
            dispersion_standard_error: fit.map(|fit| fit.independent.dispersion),
            dispersion_standard_error_by_record: by_record.map(|errors| errors.dispersion),
            log_likelihood: fit.map(|fit| fit.log_likelihood),
            no_fit: found.as_ref().err().map(ToString::to_string),
        }
    }
}

impl Heading {
    /// Makes files and words of all rows.
    ///
    /// # Errors
    /// When a value is not finite.
    pub fn report(&self, rows: Vec<CaseRow>, figure: Figure) -> Result<Results, OutputError> {
        let results = SuiteFragility::new(self.measure, rows);
        let capacities = results.capacities();
        let measures = efficiencies(&capacities);
        let remarks = self.remarks(&results);
        let answer = self.answer(&results);
        let to_quote = quotable::in_words(std::slice::from_ref(&answer));
        let mut words = self.words(&results, &capacities, &measures, &remarks);
        words.extend(to_quote.iter().map(|quote| format!("\n  {quote}")));
        let efficiencies = csv(efficiency_columns(), &measures)?;
        let limits = remarks.warnings("cases");
        let end = |end: usize| results.fits().nth(1 + end).map(Into::into);
        let summary = Summary {
            program: env!("CARGO_PKG_NAME"),
            version: env!("CARGO_PKG_VERSION"),
            scenario: &self.scenario,
            warnings: self.warnings.iter().cloned().chain(limits).collect(),
            to_quote,
            intensity: self.measure.column(),
            curve: (&results.fit).into(),
            records: results.record_count(),
            counts: Counts::of(&results.evidence()),
            intensity_measures: measures,
            mirrored_cases_count: results.mirrored_count,
            records_that_never_overturn: results.always(Verdict::Survives),
            records_that_always_overturn: results.always(Verdict::Overturns),
            with_uncertain_as_survived: end(0),
            with_uncertain_as_overturned: end(1),
            remarks,
        };
        let curves = results.curves().into_iter();
        let captions = curves.map(|(taken, curve)| match curve {
            Ok(curve) => format!("{curve}{taken}"),
            Err(reason) => format!("no curve: {reason}{taken}"),
        });
        let caption = captions.collect::<Vec<_>>().join("; ");
        let mut fractiles = vec![column(self.measure.column(), |at: &Fractiles| at.intensity)];
        fractiles.extend(fields!(|at: &Fractiles| at => cases, overturned));
        let names = ["peak_16", "peak_50", "peak_84"];
        fractiles.push(list(names, |at: &Fractiles| at.peaks));
        let peaks = [list(["peak", "share"], |at: &(f64, f64)| [at.0, at.1])];
        let others = [
            picture::draw(figure, self, &results, &caption).into_bytes(),
            ida::draw(figure, self, &results).into_bytes(),
            ida::draw_peaks(figure, self, &results).into_bytes(),
            csv(fractiles, &ida::fractiles(&results))?,
            csv(peaks, &ida::peaks(&results))?,
            csv(capacity_columns(), &capacities)?,
            efficiencies,
            csv(self.level_columns(), &results.levels)?,
            csv(self.case_columns(), &results.cases)?,
        ];
        Ok(Results {
            largest_rotations_rad: ida::rotations_rad(&results.cases),
            answer: Some(answer),
            ..Results::with_words(&FILES, &summary, words, others)?
        })
    }

    /// Returns the answer that may be quoted: the largest intensity that is safe under all records.
    fn answer(&self, results: &SuiteFragility) -> ModelAnswer {
        let survivals = results.survivals().into_iter();
        let safe = |survival: &Survival| survival.survives_up_to.unwrap_or(0.0);
        let excess = |case: &CaseRow| case.result.as_ref().ok()?.thrust_excess_ratio;
        let lowest = survivals.min_by(|(_, a), (_, b)| safe(a).total_cmp(&safe(b)));
        let quoted = lowest.as_ref().map_or(0.0, |(_, survival)| safe(survival));
        // The quoted intensity may lie between two levels. The thrust line is then followed up to the upper one, which is on the safe side.
        let records = results.cases.chunk_by(CaseRow::has_shake_of);
        let cases = records.flat_map(|cases| {
            let is_above = |case: &CaseRow| case.level(self.measure) >= quoted;
            let above = cases.iter().position(is_above);
            &cases[..above.map_or(cases.len(), |above| above + 1)]
        });
        let excess_ratio = cases.filter_map(excess).reduce(f64::max);
        let answer = lowest.map_or(Err("there are no cases".to_owned()), |(case, survival)| {
            let (record, unit) = (case.record_in_words(), unit(self.measure));
            match survival.survives_up_to.map(rounded_down) {
                Some(safe) => Ok(format!(
                    "survives all records up to {safe}{unit} ({record})"
                )),
                None => Err(format!(
                    "the lowest level of {record} is not certainly survived"
                )),
            }
        });
        let is_arch = self.scenario.get("column").is_none();
        ModelAnswer::new(self.hinges(), is_arch, excess_ratio, answer)
    }

    /// Returns the failed and uncertain cases among those that count, with the reasons.
    fn remarks(&self, results: &SuiteFragility) -> Remarks {
        let mut remarks = Remarks::default();
        for case in results.evidence() {
            let name = || format!("{}, {}", case.record_in_words(), self.level(case));
            remarks.note(name, &case.result);
        }
        remarks
    }

    /// Returns the results in words.
    fn words(
        &self,
        results: &SuiteFragility,
        capacities: &[Capacity<'_>],
        measures: &[Efficiency],
        remarks: &Remarks,
    ) -> String {
        let mut lines = vec![format!(
            "{} cases of {}: {}",
            results.cases.len(),
            results.records_in_words(),
            OutcomeCounts::of(results.cases.iter().map(|case| &case.result))
        )];
        let column = self.measure.column();
        let curves = results.curves().into_iter();
        lines.extend(curves.map(|(taken, curve)| match curve {
            Ok(curve) => format!("fragility over {column}{taken}: {curve}\n    ({FIT})"),
            Err(reason) => format!("no fragility curve{taken}: {reason}"),
        }));
        lines.extend(self.measures_in_words(capacities, measures));
        if results.fit.is_ok() || !measures.is_empty() {
            lines.extend(few(results.record_count()));
        }
        for (case, survival) in results.survivals() {
            let words = survival::in_words(&survival, unit(self.measure), None);
            lines.push(format!("{}: {words}", case.record_in_words()));
        }
        lines.push(searched(results));
        lines.extend(remarks.model.in_words("cases"));
        if results.cases.iter().any(CaseRow::still_rocking) {
            lines.push("those still rocking at the end count as not overturned".to_owned());
        }
        let incomplete = remarks.incomplete_in_words();
        lines.extend(incomplete.map(|words| format!("{words}; {AT_ENDS}")));
        lines.extend(remarks.uncertain_in_words(FRAGILITY));
        let failed = remarks.failed_in_words(FRAGILITY);
        lines.extend(failed.map(|words| format!("{words}; {AT_ENDS}")));
        lines.join("\n  ")
    }

    /// Returns the measures of intensity in words, the most efficient first; `None` without capacities.
    fn measures_in_words(
        &self,
        capacities: &[Capacity<'_>],
        measures: &[Efficiency],
    ) -> Option<String> {
        let bounds = capacities.iter().filter(|one| one.at_most).count();
        if measures.is_empty() && bounds > 0 {
            return Some(format!(
                "measures of intensity are not compared: {bounds} capacities are upper bounds; add lower levels"
            ));
        }
        let (best, others) = measures.split_first()?;
        let of = |one: &Efficiency| {
            let at = match one.measure {
                "spectral_acceleration_g" => format!(" at {}", self.spectral()),
                _ => String::new(),
            };
            let interval = one.dispersion_of_factor_interval;
            let interval = interval.map_or(String::new(), |[low, high]| {
                format!(" ({low:.2} to {high:.2})")
            });
            let (words, dispersion) = (one.words, one.dispersion_of_factor);
            format!("{words}{at} {dispersion:.2}{interval}")
        };
        let others: Vec<String> = others.iter().map(of).collect();
        let all = capacities.len();
        let left_out = match all - best.capacities {
            0 => String::new(),
            count => format!("; {count} of {all} that do not overturn are left out"),
        };
        let bounds = match bounds {
            0 => String::new(),
            count => format!("; {count} of {all} are upper bounds"),
        };
        Some(format!(
            "most efficient measure of intensity: {}; {}\n    (dispersion of the factor on a record that overturns, 95 % by bootstrap over \
             records; the first is the best in {:.0} % of the draws){left_out}{bounds}",
            of(best),
            others.join(", "),
            100.0 * best.best_share
        ))
    }

    /// Returns the columns of `suite.csv`, one row per case.
    fn case_columns(&self) -> Vec<Column<'static, CaseRow>> {
        let mut all = vec![
            column("record", |case: &CaseRow| shown(&case.record)),
            column("sign", |case: &CaseRow| sign(case.mirrored)),
            column("scale", |case: &CaseRow| case.scale),
            column("peak_g", |case: &CaseRow| case.peak_g),
        ];
        all.extend(columns::columns(
            self.hinges().has_joints(),
            |case: &CaseRow| case.result.as_ref().map_err(|_| FAILED),
        ));
        all
    }

    /// Returns the columns of `fragility.csv`, one row per level. Missing values are empty.
    fn level_columns(&self) -> Vec<Column<'static, FragilityRow>> {
        let curve = |name: &str, curve: fn(&FragilityRow) -> Option<[f64; 3]>| {
            let names = ["", "_low", "_high"].map(|end| format!("{name}{end}"));
            list(names, move |level: &FragilityRow| each(curve(level)))
        };
        let intensity = |level: &FragilityRow| level.intensity;
        let mut all = vec![column(self.measure.column(), intensity)];
        all.extend(fields!(
            |level: &FragilityRow| level.counts => cases, overturned, still_rocking, incomplete, failed
        ));
        all.push(column("fraction", FragilityRow::fraction));
        // Doubtful cases count as survived in the first of these columns, and as overturned in the second.
        let ends = ["fraction_certain", "fraction_with_uncertain"];
        all.extend([
            curve("probability", |level| level.curve),
            column("uncertain", |level: &FragilityRow| level.counts.uncertain),
            list(ends, |level: &FragilityRow| each(level.fraction_ends())),
        ]);
        all
    }
}

/// Returns the sign of a record.
const fn sign(mirrored: bool) -> &'static str {
    if mirrored { "-1" } else { "1" }
}

/// Returns the columns of `capacities.csv`, one row per record. Missing values are empty.
fn capacity_columns<'r>() -> [Column<'r, Capacity<'r>>; 6] {
    let measures = MEASURES.map(|(name, _, _)| name);
    [
        column("record", |one: &Capacity<'_>| shown(one.record)),
        column("sign", |one: &Capacity<'_>| sign(one.mirrored)),
        column("survives_up_to_scale", |one: &Capacity<'_>| {
            one.survives_up_to_scale
        }),
        column("scale", |one: &Capacity<'_>| one.scale),
        list(measures, |one: &Capacity<'_>| one.in_measures),
        column("at_most", |one: &Capacity<'_>| yes(one.at_most)),
    ]
}

/// Returns the columns of `intensity.csv`, one row per measure of intensity, the most efficient first.
fn efficiency_columns() -> Vec<Column<'static, Efficiency>> {
    let mut all = Vec::from(fields!(
        |of: &Efficiency| of => measure, capacities, median, dispersion, dispersion_of_factor
    ));
    let ends = ["dispersion_of_factor_low", "dispersion_of_factor_high"];
    all.push(list(ends, |of: &Efficiency| {
        each(of.dispersion_of_factor_interval)
    }));
    all.extend(fields!(|of: &Efficiency| of => best_share));
    all
}

impl SuiteFragility {
    /// Returns the number of records in words.
    pub(super) fn records_in_words(&self) -> String {
        match self.record_count() {
            1 => "1 record".to_owned(),
            count => format!("{count} records"),
        }
    }

    /// Returns the curves in words, or the reason why there is none. Before each is the treatment of doubtful cases: uncertain ones count by their
    /// fractions, and in two more curves all count as survived and as overturned.
    fn curves(&self) -> Vec<(String, Result<String, String>)> {
        let counts = Counts::of(&self.evidence());
        let (doubtful, uncertain) = (counts.doubtful(), counts.uncertain);
        let kind = if doubtful == uncertain {
            "uncertain"
        } else {
            "doubtful"
        };
        let hows = [
            (uncertain, "by their fractions"),
            (doubtful, "taken as survived"),
            (doubtful, "taken as overturned"),
        ];
        let curve = |(fit, (cases, how)): (&Result<Fragility, NoFit>, _)| {
            let taken = match cases {
                0 => String::new(),
                1 => format!(", 1 {kind} case {how}"),
                _ => format!(", {cases} {kind} cases {how}"),
            };
            let words = fit.as_ref().map(|fit| fit_in_words(fit, self.measure));
            (taken, words.map_err(ToString::to_string))
        };
        self.fits().zip(hows).map(curve).collect()
    }
}

/// Returns a curve in words, with its standard errors; those by record come last.
fn fit_in_words(fit: &Fragility, measure: Measure) -> String {
    let unit = unit(measure);
    let quantity = |value: f64, error: fn(&Errors) -> f64, unit: &str| {
        let independent = error(&fit.independent);
        // The printed errors have two significant digits.
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

/// Returns the number of decimals that show two significant digits of an error.
fn digits(error: f64) -> usize {
    (1.0 - error.log10().floor()).clamp(0.0, 12.0) as usize
}

/// Treatment of cases without a verdict.
const AT_ENDS: &str = "they count only in the curves that take them as survived and as overturned";

/// Definition of the fitted curve: its median differs from that of the capacities.
const FIT: &str = "the lognormal curve that fits all cases best; cases that survive above the first overturning count too";

/// Returns the computed levels, and the limits of the search between them, in words.
fn searched(results: &SuiteFragility) -> String {
    let ends = [results.levels.first(), results.levels.last()];
    let [from, to] = ends.map(|level| rounded(level.map_or(0.0, |level| level.intensity)));
    let unit = unit(results.measure);
    format!(
        "levels tried: {}, from {from} to {to}{unit}; the first edge of a record is bisected between two of them; lower ranges that \
         overturn, below the first level or between levels, were not searched for",
        results.levels.len()
    )
}

/// Returns the unit that follows an intensity.
const fn unit(measure: Measure) -> &'static str {
    match measure {
        Measure::Scale => "",
        Measure::PeakG => " g",
    }
}
