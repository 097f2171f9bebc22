//! Report and files of a suite of records: tables, pictures, fragility.

use askama::Template;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::fragility::{Fragility, NoFit};
use super::ida::Fractiles;
use super::strength::{Efficiency, MEASURES, RecordCapacity, efficiencies, warning_of_few_records};
use super::{
    CaseRow, Counts, FragilityRow, Heading, SuiteFragility, ida, outcomes, picture,
    records_in_words,
};
use crate::argument::plain;
use crate::dynamics::{Direction, Directions};
use crate::output::{Column, Figure, OutputError, Table, column, each, fields, list};
use crate::scenario::{Measure, Spectral, shown};
use crate::studies::ending::columns::{self, FAILED, yes_or_no};
use crate::studies::page::{DrawPicture, Page, PageCases};
use crate::studies::quotable::{self, ModelAnswer, directions_in_words};
use crate::studies::report::{Report, Warnings};
use crate::studies::threshold::rounded_range;
use crate::studies::threshold::survival::{Survival, survival_in_words};
use crate::studies::{OutcomeCounts, Remarks, Results, Verdict, format_edge, rounded_down};

/// Words after intensities that are the lowest of the levels tried.
pub const OF_LEVELS: &str = ", of the levels tried";

const fn levels_suffix(levels_only: bool) -> &'static str {
    if levels_only { OF_LEVELS } else { "" }
}

const FRAGILITY: &str = "fragility.json";

/// The treatment of cases without a verdict, in words.
const AT_ENDS: &str = "they count only in the curves that take them as survived and as overturned";

/// Names of the files, the seal last.
pub const FILES: [&str; 11] = [
    "suite.html",
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

/// Report on a suite of records. Missing values are null.
#[derive(Serialize, Deserialize, Template)]
#[template(path = "studies/suite/words.txt")]
pub struct SuiteSummary {
    /// Name of the program.
    program: String,
    /// Version of the program.
    version: String,
    /// The scenario with all defaults.
    scenario: Value,
    #[serde(flatten)]
    warnings: Warnings,
    /// The answer that may be quoted, in words.
    to_quote: Option<String>,
    /// Largest friction coefficient that the surviving cases up to the quoted intensity and their repetitions require without slip; null if joints slip
    /// or are elastic.
    #[serde(default)]
    friction_demand: Option<f64>,
    /// Number of all computed cases with each outcome.
    outcomes: OutcomeCounts,
    /// The measure of the intensities.
    intensity: Measure,
    #[serde(flatten)]
    curve: Curve,
    /// Number of records.
    records: usize,
    /// The number of records that overturn the structure, if each acts once, unscaled; null with levels.
    #[serde(default)]
    as_recorded: Option<AsRecorded>,
    #[serde(flatten)]
    counts: Counts,
    /// The levels that were tried.
    levels: Levels,
    /// The intensities that the structure survives, for each record; for mirrored records only if they differ.
    survivals: Vec<RecordSurvival>,
    /// The oscillator of the spectral acceleration.
    spectral: Spectral,
    /// Number of capacities: the lowest overturning intensities of the records, with each sign.
    capacities: usize,
    /// Number of capacities that are upper bounds.
    capacities_at_most: usize,
    /// Measures of intensity, the most efficient first.
    intensity_measures: Vec<Efficiency>,
    /// True if records act with both signs. Otherwise only one direction is requested, or the results of mirrored records are mirror images.
    mirrored_cases_count: bool,
    /// Records that never overturn the structure.
    records_that_never_overturn: Vec<String>,
    /// Records that overturn the structure at every level.
    records_that_always_overturn: Vec<String>,
    /// The curve with uncertain, incomplete and failed cases counted as survived, if there are any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    with_uncertain_as_survived: Option<Curve>,
    /// The curve with uncertain, incomplete and failed cases counted as overturned, if there are any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    with_uncertain_as_overturned: Option<Curve>,
    #[serde(flatten)]
    remarks: Remarks,
}

/// The number of unscaled records that overturn the structure. A record counts if it does so in at least one direction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct AsRecorded {
    /// Number of records that certainly overturn the structure.
    records_that_overturn: usize,
    /// Their share of all records.
    share: f64,
    /// Number of other records of which a case is uncertain or has no verdict.
    records_in_doubt: usize,
}

impl AsRecorded {
    fn of(results: &SuiteFragility) -> Self {
        let (mut overturn, mut doubt, mut all) = (0, 0, 0);
        for cases in results.cases.chunk_by(|a, b| a.record == b.record) {
            let any = |is: fn(Option<Verdict>) -> bool| cases.iter().any(|case| is(case.verdict()));
            let overturns = any(|verdict| verdict == Some(Verdict::Overturns));
            let doubtful = any(|verdict| verdict != Some(Verdict::Survives));
            all += 1;
            overturn += usize::from(overturns);
            doubt += usize::from(doubtful && !overturns);
        }
        Self {
            records_that_overturn: overturn,
            share: overturn as f64 / f64::from(all.max(1)),
            records_in_doubt: doubt,
        }
    }

    /// The answer in words.
    fn in_words(self, records: usize, directions: Directions) -> String {
        let overturn = match self.records_that_overturn {
            1 => "overturns it unscaled",
            _ => "overturn it unscaled",
        };
        let direction = match directions {
            Directions::Both => " in at least one direction",
            one => directions_in_words(one, Direction::AsGiven),
        };
        let doubt = match self.records_in_doubt {
            0 => String::new(),
            more => format!(", and {more} may (uncertain, or without a verdict)"),
        };
        let (count, share) = (self.records_that_overturn, 100.0 * self.share);
        let records = records_in_words(records);
        format!("{count} of {records} ({share:.1} %) {overturn}{direction}{doubt}")
    }
}

/// The levels of a suite.
#[derive(Clone, Copy, Serialize, Deserialize)]
struct Levels {
    /// Number of levels.
    count: usize,
    /// Lowest level.
    from: f64,
    /// Highest level.
    to: f64,
}

impl Levels {
    fn of(results: &SuiteFragility) -> Self {
        let ends = [results.levels.first(), results.levels.last()];
        let [from, to] = ends.map(|level| level.map_or(0.0, |level| level.intensity));
        Self {
            count: results.levels.len(),
            from,
            to,
        }
    }
}

/// The intensities that the structure survives under a record.
#[derive(Serialize, Deserialize)]
struct RecordSurvival {
    /// The record, in words.
    record: String,
    #[serde(flatten)]
    survival: Survival,
    /// True if intensities between the levels below `survives_up_to` were not tried, so that some of them may overturn the structure.
    #[serde(default)]
    levels_only: bool,
}

/// A fragility curve with its standard errors, or the reason why there is none.
#[derive(Serialize, Deserialize)]
struct Curve {
    /// The intensity at which half of the cases overturn.
    median: Option<f64>,
    /// Standard error of the median if all cases are independent.
    median_standard_error: Option<f64>,
    /// Standard error of the median if the cases of a record depend on each other.
    median_standard_error_by_record: Option<f64>,
    /// Ends of the 95 % interval of the median; null with one record.
    #[serde(default)]
    median_interval: Option<[f64; 2]>,
    /// The highest level if the median is above it, the lowest if it is below it: the median is extrapolated. Null between them.
    #[serde(default)]
    extrapolated_beyond: Option<f64>,
    /// Standard deviation of the logarithm of the overturning intensity.
    dispersion: Option<f64>,
    /// Standard error of the dispersion if all cases are independent.
    dispersion_standard_error: Option<f64>,
    /// Standard error of the dispersion if the cases of a record depend on each other.
    dispersion_standard_error_by_record: Option<f64>,
    /// Ends of the 95 % interval of the dispersion; null with one record.
    #[serde(default)]
    dispersion_interval: Option<[f64; 2]>,
    /// The maximum of the log-likelihood.
    log_likelihood: Option<f64>,
    /// The reason why there is no curve.
    no_fit: Option<String>,
}

impl Curve {
    /// Makes the summary of a curve.
    fn of(found: &Result<Fragility, NoFit>, levels: &Levels) -> Self {
        let fit = found.as_ref().ok();
        let beyond = |fit: &Fragility| match fit.median {
            median if median > levels.to => Some(levels.to),
            median if median < levels.from => Some(levels.from),
            _ => None,
        };
        let by_record = fit.and_then(|fit| fit.clustered);
        Self {
            median: fit.map(|fit| fit.median),
            median_standard_error: fit.map(|fit| fit.independent.median),
            median_standard_error_by_record: by_record.map(|errors| errors.median),
            median_interval: fit.and_then(Fragility::median_interval),
            extrapolated_beyond: fit.and_then(beyond),
            dispersion: fit.map(|fit| fit.dispersion),
            dispersion_standard_error: fit.map(|fit| fit.independent.dispersion),
            dispersion_standard_error_by_record: by_record.map(|errors| errors.dispersion),
            dispersion_interval: fit.and_then(Fragility::dispersion_interval),
            log_likelihood: fit.map(|fit| fit.log_likelihood),
            no_fit: found.as_ref().err().map(ToString::to_string),
        }
    }
}

impl Heading {
    /// Makes report and files of all rows.
    ///
    /// # Errors
    /// When a value is not finite.
    pub fn report(&self, rows: Vec<CaseRow>, figure: Figure) -> Result<Results, OutputError> {
        let results = SuiteFragility::new(self.measure, rows);
        let as_recorded = self.is_as_recorded().then(|| AsRecorded::of(&results));
        let of_levels = as_recorded.is_none();
        let capacities = match of_levels {
            true => results.capacities(),
            false => Vec::new(),
        };
        let remarks = self.remarks(&results);
        let (answer, friction_demand) = self.answer(&results, as_recorded);
        let friction = self.slip.condition(friction_demand, "suite FILE");
        let incomplete = remarks
            .incomplete_in_words()
            .map(|words| format!("{words}; {AT_ENDS}"));
        let limits = [remarks.model.in_words("cases"), incomplete]
            .into_iter()
            .flatten()
            .chain(friction.as_ref().map(ToString::to_string));
        let is_uncertain = !self.scenario["uncertain"].is_null();
        let answer = answer
            .with_friction(friction.clone())
            .unless_uncertain(is_uncertain);
        let levels = Levels::of(&results);
        let curve = |found| Curve::of(found, &levels);
        let end = |end: usize| results.fits().nth(1 + end).map(curve);
        let survivals = results.survivals().into_iter().filter(|_| of_levels);
        let owned = |names: Vec<&str>| names.into_iter().map(str::to_owned).collect();
        let report = SuiteSummary {
            program: env!("CARGO_PKG_NAME").to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            scenario: self.scenario.clone(),
            warnings: self.warnings.clone().with(limits),
            to_quote: quotable::quote_answers(std::slice::from_ref(&answer)),
            friction_demand,
            outcomes: OutcomeCounts::of(results.cases.iter().map(|case| &case.result)),
            intensity: self.measure,
            curve: curve(&results.fit),
            records: results.record_count(),
            as_recorded,
            counts: Counts::of(&results.cases.iter().collect::<Vec<_>>()),
            levels,
            survivals: survivals
                .map(|(cases, survival)| RecordSurvival {
                    record: cases[0].record_in_words(),
                    levels_only: SuiteFragility::is_of_levels_only(cases, &survival),
                    survival,
                })
                .collect(),
            spectral: self.spectral,
            capacities: capacities.len(),
            capacities_at_most: capacities.iter().filter(|one| one.at_most).count(),
            intensity_measures: efficiencies(&capacities),
            mirrored_cases_count: results.has_both_signs(),
            records_that_never_overturn: owned(results.records_with(Verdict::Survives)),
            records_that_always_overturn: owned(results.records_with(Verdict::Overturns)),
            with_uncertain_as_survived: end(0),
            with_uncertain_as_overturned: end(1),
            remarks,
        };
        let caption = report.caption();
        let measures = &report.intensity_measures;
        let found = Results::of(FRAGILITY, &report)?;
        let found = self.with_tables(found, &results, (&capacities, measures))?;
        let found = match of_levels {
            true => found
                .with_file("suite.svg", picture::draw(figure, self, &results, &caption))
                .with_file("ida.svg", ida::draw(figure, self, &results, &[])),
            false => found.with_file("suite.svg", outcomes::draw(figure, self, &results, &[])),
        };
        let found = found.with_file("peaks.svg", ida::draw_peaks(figure, self, &results));
        Ok(Results {
            largest_rotations_rad: ida::rotations_rad(&results.cases),
            answer: Some(answer),
            ..self.with_page(found, &results, &caption).in_order(&FILES)
        })
    }

    /// Adds the tables, that of the cases first. Without levels there are no capacities and fractions.
    fn with_tables(
        &self,
        found: Results,
        results: &SuiteFragility,
        (capacities, measures): (&[RecordCapacity<'_>], &[Efficiency]),
    ) -> Result<Results, OutputError> {
        let mut fractiles = vec![column(self.measure.name(), |at: &Fractiles| at.intensity)];
        fractiles.extend(fields!(|at: &Fractiles| at => cases, overturned));
        let names = ["peak_16", "peak_50", "peak_84"];
        fractiles.push(list(names, |at: &Fractiles| at.peaks));
        let peaks = [list(["peak", "share"], |at: &(f64, f64)| [at.0, at.1])];
        let cases = Table::new(self.case_columns(), &results.cases)?;
        let found = found
            .with_table("suite.csv", cases)
            .with_table("peaks.csv", Table::new(peaks, &ida::peaks(results))?);
        if self.is_as_recorded() {
            return Ok(found);
        }
        let levels = Table::new(self.level_columns(), &results.levels)?;
        Ok(found
            .with_table("fragility.csv", levels)
            .with_table("intensity.csv", Table::new(efficiency_columns(), measures)?)
            .with_table(
                "capacities.csv",
                Table::new(capacity_columns(), capacities)?,
            )
            .with_table("ida.csv", Table::new(fractiles, &ida::fractiles(results))?))
    }

    /// Adds the page. `caption` has the fragility curves in words.
    fn with_page(&self, found: Results, results: &SuiteFragility, caption: &str) -> Results {
        let mut cases = PageCases::default();
        let first = self.add_texts(&mut cases);
        for case in &results.cases {
            let words = format!("{}, {}", case.record_in_words(), self.level(case));
            cases.push_history(&words, &case.result, || self.scenario_of(case, first));
        }
        let own = match self.is_as_recorded() {
            true => "each record acts alone, once, unscaled, and starts from rest",
            false => {
                "each record acts alone, at every level, and starts from rest; the lowest overturning level of a record is bisected between \
                 two levels, and a finer search below it finds bands, unless it is \"of the levels tried\"; the curve takes the records as equally \
                 likely"
            }
        };
        let draw = |figure| match self.is_as_recorded() {
            true => outcomes::draw(figure, self, results, &cases.spots),
            false => ida::draw(figure, self, results, &cases.spots),
        };
        let page = Page::new(self.title(), self.what.clone(), &[own], &[self.model]);
        let more: [DrawPicture<'_>; 2] = [
            &|figure| picture::draw(figure, self, results, caption),
            &|figure| ida::draw_peaks(figure, self, results),
        ];
        // The first of these pictures has levels.
        let more = &more[usize::from(self.is_as_recorded())..];
        found.with_page("suite.html", page, &cases, (&draw, more))
    }

    /// Answer that may be quoted: the largest intensity that is safe under all records, or the number of unscaled records that overturn the structure.
    /// Also returns the largest friction demand of the surviving cases up to it.
    fn answer(
        &self,
        results: &SuiteFragility,
        as_recorded: Option<AsRecorded>,
    ) -> (ModelAnswer, Option<f64>) {
        let survivals = results.survivals().into_iter();
        let safe = |survival: &Survival| survival.survives_up_to.unwrap_or(0.0);
        let excess = |case: &CaseRow| case.result.as_ref().ok()?.thrust_excess_ratio;
        let lowest = survivals.min_by(|(_, a), (_, b)| safe(a).total_cmp(&safe(b)));
        let quoted = lowest.as_ref().map_or(0.0, |(_, survival)| safe(survival));
        // The quoted intensity may lie between two levels. The thrust line is then followed up to the upper one, which is on the safe side.
        let cases = results.cases_by_record().flat_map(|cases| {
            let is_above = |case: &CaseRow| case.level(self.measure) >= quoted;
            let above = cases.iter().position(is_above);
            &cases[..above.map_or(cases.len(), |above| above + 1)]
        });
        let survives = |case: &&CaseRow| case.verdict() == Some(Verdict::Survives);
        let demand = |case: &CaseRow| case.result.as_ref().ok()?.friction_demand;
        let demands = cases.clone().filter(survives).filter_map(demand);
        let below_edges = cases.clone().filter_map(|case| case.friction_below_edge);
        let found = cases
            .clone()
            .filter_map(|case| case.found_below.as_ref()?.friction_demand);
        let friction_demand = demands.chain(below_edges).chain(found).reduce(f64::max);
        let excess_ratio = cases.filter_map(excess).reduce(f64::max);
        let answer = lowest.map_or(Err("there are no cases".to_owned()), |(cases, survival)| {
            let (record, unit) = (cases[0].record_in_words(), self.measure.unit());
            match survival.survives_up_to.map(rounded_down) {
                Some(safe) => Ok(format!(
                    "survives all records up to {safe}{unit} ({record}){}{}",
                    directions_in_words(self.directions, Direction::AsGiven),
                    levels_suffix(SuiteFragility::is_of_levels_only(cases, &survival))
                )),
                None => Err(format!(
                    "the lowest level of {record} is not certainly survived"
                )),
            }
        });
        let answer = as_recorded.map_or(answer, |found| {
            Ok(found.in_words(results.record_count(), self.directions))
        });
        let answer = ModelAnswer::new(self.model, self.is_arch, excess_ratio, answer)
            .with_restitution(self.restitution.clone());
        (answer, friction_demand)
    }

    /// Failed and uncertain cases with the reasons.
    fn remarks(&self, results: &SuiteFragility) -> Remarks {
        let mut remarks = Remarks::default();
        for case in &results.cases {
            let name = || format!("{}, {}", case.record_in_words(), self.level(case));
            remarks.add_case(name, &case.result);
        }
        remarks
    }

    /// Columns of `suite.csv`, one row per case.
    fn case_columns(&self) -> Vec<Column<'static, CaseRow>> {
        let mut all = vec![
            column("record", |case: &CaseRow| shown(&case.record)),
            column("sign", |case: &CaseRow| sign(case.mirrored)),
            column("scale", |case: &CaseRow| case.scale),
            column("peak_g", |case: &CaseRow| case.peak_g),
        ];
        all.extend(columns::columns(
            self.model.is_repeated,
            |case: &CaseRow| case.result.as_ref().map_err(|_| FAILED),
        ));
        let names = MEASURES[1..].iter().map(|(name, ..)| *name);
        all.push(list(names, CaseRow::intensities));
        all
    }

    /// Columns of `fragility.csv`, one row per level. Missing values are empty.
    fn level_columns(&self) -> Vec<Column<'static, FragilityRow>> {
        let curve = |name: &str, curve: fn(&FragilityRow) -> Option<[f64; 3]>| {
            let names = ["", "_low", "_high"].map(|end| format!("{name}{end}"));
            list(names, move |level: &FragilityRow| each(curve(level)))
        };
        let intensity = |level: &FragilityRow| level.intensity;
        let mut all = vec![column(self.measure.name(), intensity)];
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

/// Sign of a record.
const fn sign(mirrored: bool) -> i64 {
    if mirrored { -1 } else { 1 }
}

/// Columns of `capacities.csv`, one row per record. Missing values are empty.
fn capacity_columns<'r>() -> [Column<'r, RecordCapacity<'r>>; 7] {
    let measures = MEASURES.map(|(name, _, _)| name);
    [
        column("record", |one: &RecordCapacity<'_>| shown(one.record)),
        column("sign", |one: &RecordCapacity<'_>| sign(one.mirrored)),
        column("survives_up_to_scale", |one: &RecordCapacity<'_>| {
            one.survives_up_to_scale
        }),
        column("scale", |one: &RecordCapacity<'_>| one.scale),
        list(measures, |one: &RecordCapacity<'_>| one.in_measures),
        column("at_most", |one: &RecordCapacity<'_>| yes_or_no(one.at_most)),
        column("levels_only", |one: &RecordCapacity<'_>| {
            yes_or_no(one.levels_only)
        }),
    ]
}

/// Columns of `intensity.csv`, one row per measure of intensity, the most efficient first.
fn efficiency_columns() -> Vec<Column<'static, Efficiency>> {
    let mut all = Vec::from(fields!(
        |of: &Efficiency| of => capacities, median, dispersion, dispersion_of_factor
    ));
    all.insert(0, column("measure", |of: &Efficiency| of.measure.clone()));
    let ends = ["dispersion_of_factor_low", "dispersion_of_factor_high"];
    all.push(list(ends, |of: &Efficiency| {
        each(of.dispersion_of_factor_interval)
    }));
    all.extend(fields!(|of: &Efficiency| of => best_share));
    all
}

impl SuiteSummary {
    /// Returns the fragility curves in words.
    fn caption(&self) -> String {
        let curves = self.curves().into_iter();
        let captions = curves.map(|(taken, curve)| match curve {
            Ok(curve) => format!("{curve}{taken}"),
            Err(reason) => format!("no curve: {reason}{taken}"),
        });
        captions.collect::<Vec<_>>().join("; ")
    }
}

impl Report for SuiteSummary {
    fn verdict(&self) -> String {
        let (cases, records) = (self.outcomes.total(), records_in_words(self.records));
        format!("{cases} cases of {records}: {}", self.outcomes)
    }

    fn numbers(&self) -> Vec<String> {
        let curve = self.curves().into_iter().next();
        let curve = curve.and_then(|(_, curve)| curve.ok());
        let curve = curve.map(|curve| format!("fragility over {}: {curve}", self.intensity.name()));
        [self.verdict()].into_iter().chain(curve).collect()
    }

    fn quote(&self) -> Option<&str> {
        self.to_quote.as_deref()
    }

    fn warnings(&self) -> &Warnings {
        &self.warnings
    }
}

impl SuiteSummary {
    /// Curves in words, or the reason why there is none. Before each is the treatment of doubtful cases: uncertain ones count by their
    /// fractions, and in two more curves all count as survived and as overturned.
    fn curves(&self) -> Vec<(String, Result<String, String>)> {
        let (doubtful, uncertain) = (self.counts.doubtful(), self.counts.uncertain);
        let kind = if doubtful == uncertain {
            "uncertain"
        } else {
            "doubtful"
        };
        let ends = [
            &self.with_uncertain_as_survived,
            &self.with_uncertain_as_overturned,
        ];
        let curves = [
            (Some(&self.curve), uncertain, "by their fractions"),
            (ends[0].as_ref(), doubtful, "taken as survived"),
            (ends[1].as_ref(), doubtful, "taken as overturned"),
        ];
        let in_words = |(curve, cases, how): (Option<&Curve>, usize, &str)| {
            let taken = match cases {
                0 => String::new(),
                1 => format!(", 1 {kind} case {how}"),
                _ => format!(", {cases} {kind} cases {how}"),
            };
            let curve = curve?;
            let words = curve.in_words(self.intensity.unit());
            Some((taken, words.ok_or(curve.no_fit.clone().unwrap_or_default())))
        };
        curves.into_iter().filter_map(in_words).collect()
    }

    /// Measure of intensity with its dispersion, in words.
    fn measure(&self, one: &Efficiency) -> String {
        let known = MEASURES.iter().find(|(name, ..)| *name == one.measure);
        let words = known.map_or("", |(_, words, _)| words);
        let Spectral {
            period_s,
            damping_percent,
        } = self.spectral;
        let at = match one.measure.as_str() {
            "spectral_acceleration_g" => {
                format!(" at {} s and {} %", plain(period_s), plain(damping_percent))
            }
            _ => String::new(),
        };
        let interval = one
            .dispersion_of_factor_interval
            .map_or(String::new(), |[low, high]| {
                format!(" ({low:.2} to {high:.2})")
            });
        format!("{words}{at} {:.2}{interval}", one.dispersion_of_factor)
    }

    /// Words after the dispersion of all capacities.
    fn levels_suffix(&self) -> &'static str {
        levels_suffix(self.survivals.iter().any(|one| one.levels_only))
    }

    /// All measures but the best, in words.
    fn other_measures(&self) -> String {
        let others = self
            .intensity_measures
            .iter()
            .skip(1)
            .map(|one| self.measure(one));
        others.collect::<Vec<_>>().join(", ")
    }
}

impl RecordSurvival {
    fn in_words(&self, unit: &str) -> String {
        survival_in_words(&self.survival, unit, None) + levels_suffix(self.levels_only)
    }
}

impl Curve {
    /// Curve in words, with its 95 % intervals. `None` without a curve.
    fn in_words(&self, unit: &str) -> Option<String> {
        let interval = |ends: Option<[f64; 2]>, unit: &str| {
            let ends = ends.map(rounded_range);
            ends.map_or(String::new(), |[low, high]| {
                format!(" (95 %: {low} to {high}{unit})")
            })
        };
        let (median, dispersion) = (self.median?, self.dispersion?);
        let extrapolated = self.extrapolated_beyond.map_or(String::new(), |level| {
            format!(
                ", extrapolated beyond the level {}{unit}",
                format_edge(level)
            )
        });
        Some(format!(
            "median {}{unit}{extrapolated}{}, dispersion {}{}",
            format_edge(median),
            interval(self.median_interval, unit),
            format_edge(dispersion),
            interval(self.dispersion_interval, "")
        ))
    }
}
