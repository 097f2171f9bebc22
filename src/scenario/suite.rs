//! The suite of records: `[suite]`.
//!
//! ```toml
//! [suite]
//! records = ["records/*.at2", "north.csv"]   # files or patterns of files, relative to the scenario file
//! scales = { from = 0.2, to = 3.0, count = 20, spacing = "logarithmic" }   # or peaks_g
//! both_signs = true                          # every record mirrored as well
//! time_column = 1                            # of the CSV files, as in [ground.record]
//! acceleration_column = 2
//! unit = "cm/s2"
//! ```
//!
//! Every record shakes the structure at every level: multiplied by every factor of `scales`, or scaled to
//! every peak of `peaks_g`. `[ground]` is not used.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Bound::{Excluded, Included};
use std::path::{Component as PathPart, Path, PathBuf};
use std::sync::Arc;

use glob::MatchOptions;
use serde::ser::{Error as _, Serialize, SerializeMap as _, Serializer};

use super::record::{self, Form, Format, Layout, Record, Scaling, Series};
use super::sequence::Sequence;
use super::table::{Number, OneOrMore, Reading, Switch, Table, Text};
use super::{Component, Ground, Scenario, Simulation, shown};
use crate::argument::{plain, short};

named! {
    /// What the levels of a suite are, named by their key in `[suite]`.
    pub enum Measure {
        /// Factors of the records.
        Scale = "scales",
        /// Peak accelerations that the records are scaled to, in units of gravity.
        PeakG = "peaks_g",
    }
}

/// Largest factor on a record: beyond it the unit must be wrong.
const MAX_SCALE: f64 = 1e6;
const SCALE: Number = Number(Excluded(0.0), Included(MAX_SCALE));

impl Measure {
    /// What a single level may be.
    const fn range(self) -> &'static Number {
        match self {
            Self::Scale => &SCALE,
            Self::PeakG => &record::PEAK_G,
        }
    }

    /// What one of the levels is called.
    #[must_use]
    pub const fn column(self) -> &'static str {
        match self {
            Self::Scale => "scale",
            Self::PeakG => "peak_g",
        }
    }

    const fn scaling(self, level: f64) -> Scaling {
        match self {
            Self::Scale => Scaling::Factor(level),
            Self::PeakG => Scaling::PeakG(level),
        }
    }
}

/// Which records shake the structure, and how strongly.
#[derive(Clone, Debug, PartialEq)]
pub struct Suite {
    /// The records as they are in their files, sorted by file name; at least one.
    pub records: Vec<Series>,
    /// What the levels are.
    pub measure: Measure,
    /// How strong each record is made, above 0.
    pub levels: Sequence,
    /// Whether every record is also run mirrored, which acts to the other side.
    pub both_signs: bool,
}

/// Cases of a suite: their rows must fit into memory.
const MAX_CASES: usize = 1_000_000;

/// A file named by the key `records`.
struct Listed {
    file: String,
    /// Index of the element that names it first.
    element: usize,
    format: Format,
}

impl Suite {
    /// Reads `[suite]` with its records; `None`: `[simulation]` is faulty.
    pub(super) fn read(
        table: &mut Table<'_>,
        folder: &Path,
        simulation: Option<&Simulation>,
    ) -> Reading<Self> {
        let patterns = table.required(RECORDS, &OneOrMore(&Text));
        let format = Format::read(table);
        let levels = Measure::ALL.iter().map(|&measure| {
            let levels = Sequence::read(table, measure.name(), measure.range());
            let levels = levels.map(|levels| levels.map(|levels| (measure, levels)));
            (measure.name(), levels)
        });
        let levels = levels.collect();
        let levels = table.exactly_one("keys", levels);
        let both_signs = table.or("both_signs", &Switch, true);
        let listed = match (patterns, format) {
            (Ok(patterns), Ok(format)) => list(table, folder, &patterns, format),
            (Err(reported), _) | (_, Err(reported)) => Err(reported),
        };
        // The keys of tables are needed if and only if one of the files is a table.
        let layout = Layout::read(
            table,
            listed.as_ref().map_err(|reported| *reported).map(|listed| {
                let formats = || listed.iter().map(|listed| listed.format);
                let first = formats().next().unwrap_or(Format::At2);
                formats()
                    .find(|format| *format == Format::Csv)
                    .unwrap_or(first)
            }),
        );
        let (listed, layout, (measure, levels), both_signs) =
            (listed?, layout?, levels?, both_signs?);
        let values = levels.values();
        let cases = listed.len() * (1 + usize::from(both_signs)) * values.len();
        if cases > MAX_CASES {
            return Err(table.wrong_itself(format!(
                "has {cases} cases, {} records at {} levels; at most {MAX_CASES} are allowed",
                listed.len(),
                values.len()
            )));
        }
        let strongest = measure.scaling(values[values.len() - 1]);
        let records: Vec<_> = listed
            .into_iter()
            .map(
                |Listed {
                     file,
                     element,
                     format,
                 }| {
                    let form = match format {
                        format if format == layout.format() => layout.form.clone(),
                        Format::At2 => Form::At2 { unit: None },
                        Format::Asc => Form::Asc,
                        Format::Knet => Form::Knet,
                        Format::Csv => layout.form.clone(),
                    };
                    let layout = Layout {
                        form,
                        ..layout.clone()
                    };
                    Series::of_file(folder, file.clone(), layout)
                        .and_then(|series| suits(&series, strongest, simulation).map(|()| series))
                        .map_err(|wrong| {
                            let wrong = format!("names {}, which {wrong}", shown(&file));
                            table.wrong_element(RECORDS, element, wrong)
                        })
                },
            )
            .collect();
        Ok(Self {
            records: records.into_iter().collect::<Reading<_>>()?,
            measure,
            levels,
            both_signs,
        })
    }

    /// A record as it shakes at a level, perhaps mirrored.
    pub(crate) fn shake(&self, record: usize, level: f64, mirrored: bool) -> Record {
        let signed = if mirrored { -level } else { level };
        shaking(&self.records[record], self.measure.scaling(signed))
    }
}

impl Serialize for Suite {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        let files: Vec<_> = self.records.iter().map(|series| &series.file).collect();
        map.serialize_entry(RECORDS, &files)?;
        let layouts = || self.records.iter().map(|series| &series.layout);
        // Files of both formats were told apart by their endings.
        if let Some(first) = layouts().next()
            && layouts().all(|layout| layout.format() == first.format())
        {
            map.serialize_entry("format", &first.format())?;
        }
        // What tables have in common is that of all, or else AT2 files may have a unit in common.
        let telling = layouts()
            .find(|layout| layout.format() == Format::Csv)
            .or_else(|| layouts().next());
        let keys = serde_json::to_value(telling).map_err(S::Error::custom)?;
        for (key, value) in keys.as_object().into_iter().flatten() {
            if key != "format" {
                map.serialize_entry(key, value)?;
            }
        }
        map.serialize_entry(self.measure.name(), &self.levels)?;
        map.serialize_entry("both_signs", &self.both_signs)?;
        map.end()
    }
}

const RECORDS: &str = "records";

/// Why a record cannot be used at the strongest level.
fn suits(
    series: &Series,
    strongest: Scaling,
    simulation: Option<&Simulation>,
) -> Result<(), String> {
    let Some(&Simulation {
        gravity_m_s2,
        duration_s,
        ..
    }) = simulation
    else {
        return Ok(());
    };
    let own_g = series.peak_g(gravity_m_s2);
    if own_g == 0.0 {
        return Err("is zero throughout".to_owned());
    }
    if let Scaling::PeakG(peak_g) = strongest
        && peak_g / own_g > MAX_SCALE
    {
        return Err(format!(
            "has a peak of {} g, which cannot be scaled to {} g: factors are at most {}",
            plain(own_g),
            plain(peak_g),
            short(MAX_SCALE)
        ));
    }
    series.scaled(strongest).check_strength(gravity_m_s2)?;
    let lasts_s = start_s(series) + series.last_s();
    if lasts_s > duration_s {
        return Err(format!(
            "lasts {} s and would be cut off at {} s; give a longer `duration_s` in [simulation]",
            plain(lasts_s),
            plain(duration_s)
        ));
    }
    Ok(())
}

/// The horizontal ground motion of a record.
fn shaking(series: &Series, scaling: Scaling) -> Record {
    Record {
        component: Component::Horizontal,
        main: series.scaled(scaling),
        vertical: None,
        start_s: start_s(series),
    }
}

impl Scenario {
    /// The scenario once for each record of its suite, which shakes it as it is in its file; none without a suite.
    /// What other studies there are is left out.
    #[must_use]
    pub fn by_record(&self) -> Vec<(String, Self)> {
        let records = self.suite.iter().flat_map(|suite| &suite.records);
        records
            .map(|series| {
                let record = shaking(series, Scaling::Factor(1.0));
                let scenario = Self {
                    motion: Arc::new(record.motion(self.simulation.gravity_m_s2)),
                    ground: Some(Ground::Record(Box::new(record))),
                    map: None,
                    spectrum: None,
                    suite: None,
                    ..self.clone()
                };
                (series.file.clone(), scenario)
            })
            .collect()
    }
}

/// Time of the simulation at the file's time zero: no record begins before the simulation does.
fn start_s(series: &Series) -> f64 {
    (-series.first_s()).max(0.0)
}

/// All files that match the patterns, sorted by name, each once.
fn list(
    table: &mut Table<'_>,
    folder: &Path,
    patterns: &[String],
    format: Option<Format>,
) -> Reading<Vec<Listed>> {
    let mut found = BTreeMap::new();
    // A file with several names counts once.
    let mut seen = BTreeSet::new();
    let mut all_well = Ok(());
    for (element, pattern) in patterns.iter().enumerate() {
        match find(folder, pattern) {
            Ok(files) => {
                for file in files {
                    let path = folder.join(&file);
                    if seen.insert(path.canonicalize().unwrap_or(path)) {
                        found.insert(file, element);
                    }
                }
            }
            Err(wrong) => all_well = Err(table.wrong_element(RECORDS, element, wrong)),
        }
    }
    let listed: Vec<_> = found
        .into_iter()
        .map(|(file, element)| {
            let format = format
                .map_or_else(|| Format::of_ending(&file), Ok)
                .map_err(|wrong| {
                    let wrong = format!("names {}, which {wrong}", shown(&file));
                    table.wrong_element(RECORDS, element, wrong)
                })?;
            Ok(Listed {
                file,
                element,
                format,
            })
        })
        .collect();
    all_well?;
    listed.into_iter().collect()
}

/// The files that match a pattern, relative to the folder; or why there are none, as words to follow the pattern.
fn find(folder: &Path, pattern: &str) -> Result<Vec<String>, String> {
    // A file whose name looks like a pattern is taken as that file, so that a resolved scenario reads back the
    // same.
    let path = folder.join(pattern);
    if path.is_dir() {
        return Err("is a folder; must be a file or a pattern such as \"folder/*.at2\"".to_owned());
    }
    if path.is_file() {
        return Ok(vec![file_name(Path::new(pattern))?]);
    }
    if !pattern.contains(['*', '?', '[']) {
        return Err(
            "does not exist; must be a file or a pattern such as \"folder/*.at2\"".to_owned(),
        );
    }
    let folder = if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        folder
    };
    // `glob` has no folder to start from: its patterns are made absolute.
    let folder =
        std::path::absolute(folder).map_err(|error| format!("cannot be found: {error}"))?;
    let escaped = folder
        .to_str()
        .map(glob::Pattern::escape)
        .ok_or("is relative to a folder whose name is not UTF-8 text; name the files one by one")?;
    let absolute = Path::new(&escaped).join(pattern);
    let options = MatchOptions {
        // As in a shell, `*` does not match hidden files.
        require_literal_leading_dot: true,
        require_literal_separator: true,
        case_sensitive: true,
    };
    let matches = glob::glob_with(&absolute.to_string_lossy(), options)
        .map_err(|error| format!("is not a valid file pattern: {}", error.msg))?;
    let mut files = Vec::new();
    for path in matches {
        let path = path.map_err(|error| format!("cannot be searched: {}", error.error()))?;
        if path.is_file() {
            files.push(file_name(path.strip_prefix(&folder).unwrap_or(&path))?);
        }
    }
    if files.is_empty() {
        return Err("matches no file".to_owned());
    }
    Ok(files)
}

/// What a cell begins with that spreadsheets compute; so does a tab, a control character.
const FORMULA: [char; 4] = ['=', '+', '-', '@'];

/// The name of a file for scenarios and results, where it must fit on a line and in a cell.
fn file_name(path: &Path) -> Result<String, String> {
    let plain: PathBuf = path
        .components()
        .filter(|part| *part != PathPart::CurDir)
        .collect();
    match plain.to_str() {
        Some(name) if name.starts_with(FORMULA) => Err(format!(
            "names {}, which spreadsheets that open the table of results would take for a formula: give the file a name \
             that does not begin with any of = + - @",
            shown(name)
        )),
        Some(name) if !name.contains(char::is_control) => Ok(name.to_owned()),
        _ => Err(format!(
            "names \"{}\"; file names must be UTF-8 without control characters",
            shown(&plain.display().to_string())
        )),
    }
}
