//! A check by the Circolare 7/2019: the demand, `[demand]`, and the options of the check, `[verify]`.
//!
//! ```toml
//! [verify]                      # all may be left out
//! confidence_factor = 1.35
//! behaviour_factor = 2.0
//! sides = "both"                # or "right", "left"
//! free_standing = { t0_s = 0.143 }     # or { kappa = 6.2, length_m = 4, thickness_m = 0.8, modulus_gpa = 1.5 }
//! language = "en"               # or "it"
//! slv_records = "slv/*.at2"     # the dynamic route; likewise slc_records; of tables, columns and units as in [suite]
//!
//! [demand]
//! soil = "B"
//! topography = "T1"             # or topographic_factor = 1.1
//! [demand.slv]                  # likewise sld, slc
//! ag_g = 0.25
//! f0 = 2.40
//! tc_star_s = 0.35
//! [demand.height]               # left out: on the ground
//! modes = [{ gamma = 1.2857, psi = 0.75, slv = { t_s = 0.45, damping_percent = 10 } }]
//! ```
//!
//! or, in place of those parameters, spectra by points:
//!
//! ```toml
//! [demand.slv]
//! spectrum = "slv.csv"          # period_s, acceleration_g
//! damping_percent = 5           # of the file
//! state = { part_of_d0 = 0.4, period_factor = 1.68, damping_percent = 8, divide_acceleration = 1.35, divide_displacement = 1 }
//! ```

use std::collections::BTreeMap;

use serde::Deserialize;

use super::files::Files;
use super::listing::{RecordListing, table_entries};
use super::prelude::*;
use super::record::{Decimal, LineFault, Series, faulty, format, layout, read_numbers};
use super::study_table::StudyTable;
use crate::dynamics::demand::{Hazard, Mode, PointSpectrum, Soil, Topography};
use crate::dynamics::{GroundSpectrum, Site};

named! {
    /// A limit state.
    #[derive(PartialOrd, Ord)]
    pub enum LimitState {
        /// Damage (stato limite di danno).
        Sld = "sld",
        /// Life safety (stato limite di salvaguardia della vita).
        Slv = "slv",
        /// Collapse (stato limite di prevenzione del collasso).
        Slc = "slc",
    }
}

named! {
    /// The sides to which a mechanism is checked.
    pub enum CheckedSides {
        /// Both sides; the worse result counts.
        Both = "both",
        /// The right side only: something holds the structure on the other side.
        Right = "right",
        /// The left side only.
        Left = "left",
    }
}

named! {
    /// The language of the words and the page of a check.
    #[derive(Default)]
    pub enum Language {
        /// English.
        #[default]
        English = "en",
        /// Italian, in the terms of the Circolare.
        Italian = "it",
    }
}

impl Language {
    /// True for English, which resolved scenarios and summaries leave out.
    pub const fn is_english(&self) -> bool {
        matches!(self, Self::English)
    }

    /// Chooses the phrase in this language.
    pub(crate) const fn choose<'a>(self, english: &'a str, italian: &'a str) -> &'a str {
        match self {
            Self::English => english,
            Self::Italian => italian,
        }
    }

    /// Returns the decimal mark.
    pub(crate) const fn decimal_mark(self) -> &'static str {
        self.choose(".", ",")
    }

    /// Gives a printed number the decimal mark of this language.
    pub(crate) fn number(self, number: String) -> String {
        number.replace('.', self.decimal_mark())
    }
}

/// Period of the elastic vibration before a mechanism moves, of a structure that walls do not hold.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum FreeStanding {
    /// A known period.
    Period {
        /// The period, in seconds.
        t0_s: f64,
    },
    /// The period from formula [C8.7.1.7].
    Elastic {
        /// Factor of the support: 6.2 for a cantilever, 2.2 for supports at both ends.
        kappa: f64,
        /// Height or span, in metres.
        length_m: f64,
        /// Thickness, in metres.
        thickness_m: f64,
        /// Young's modulus, reduced for cracking, in GPa.
        modulus_gpa: f64,
    },
}

impl FreeStanding {
    /// Period in seconds, for masonry of this density in kg/m3: `kappa lambda L sqrt(W / (E g))`, with `lambda = L / t` and the
    /// weight per volume `W` [C8.7.1.7].
    pub fn period_s(&self, density_kg_m3: f64) -> f64 {
        match *self {
            Self::Period { t0_s } => t0_s,
            Self::Elastic {
                kappa,
                length_m,
                thickness_m,
                modulus_gpa,
            } => {
                let slenderness = length_m / thickness_m;
                kappa * slenderness * length_m * (density_kg_m3 / (modulus_gpa * 1e9)).sqrt()
            }
        }
    }

    fn read(table: &mut Table<'_>) -> ReadResult<Self> {
        let t0_s = table.optional("t0_s", &PERIOD_S);
        let kappa = table.optional("kappa", &above(0.0, 100.0));
        let length_m = table.optional("length_m", &MAGNITUDE);
        let thickness_m = table.optional("thickness_m", &MAGNITUDE);
        let modulus_gpa = table.optional("modulus_gpa", &above(0.0, 1e3));
        let elastic = ["kappa", "length_m", "thickness_m", "modulus_gpa"];
        table.check_relations(&[OneOf(&["t0_s", "kappa"], None), Together(&elastic)])?;
        if let Some(t0_s) = t0_s {
            return Ok(Self::Period { t0_s });
        }
        Ok(Self::Elastic {
            kappa: kappa.ok_or(FaultRecorded)?,
            length_m: length_m.ok_or(FaultRecorded)?,
            thickness_m: thickness_m.ok_or(FaultRecorded)?,
            modulus_gpa: modulus_gpa.ok_or(FaultRecorded)?,
        })
    }
}

/// The options of a check.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verify {
    /// Confidence factor FC, by which accelerations are divided.
    pub confidence_factor: f64,
    /// Behaviour factor q for the simplified check of SLV.
    pub behaviour_factor: f64,
    /// The sides that are checked.
    pub sides: CheckedSides,
    /// Elastic vibration of a structure that is free to vibrate before it moves; `None` if walls hold it up to the mechanism.
    pub free_standing: Option<FreeStanding>,
    /// Language of the words and the page.
    #[serde(skip_serializing_if = "Language::is_english")]
    pub language: Language,
    /// Records of the dynamic route.
    #[serde(flatten)]
    pub records: Records,
}

/// Records of the motion at the position of the mechanism, for each limit state that is checked with records.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Records(ByState<Vec<Series>>);

/// Keys of the records of a limit state.
const RECORDS: [(LimitState, &str); 2] = [
    (LimitState::Slv, "slv_records"),
    (LimitState::Slc, "slc_records"),
];
/// Smallest number of records; with few records the worst counts (NTC 2018, § 7.3.5).
const LEAST_RECORDS: usize = 3;

impl Records {
    /// Keys of the limit states that have records.
    pub fn keys(&self) -> Vec<&'static str> {
        let given = RECORDS
            .iter()
            .filter(|(state, _)| !self.records_of(*state).is_empty());
        given.map(|(_, key)| *key).collect()
    }

    /// Records of a limit state.
    pub fn records_of(&self, state: LimitState) -> &[Series] {
        self.0.get(&state).map_or(&[], Vec::as_slice)
    }

    /// Records of all limit states.
    pub(super) fn all_records(&self) -> impl Iterator<Item = &Series> + Clone {
        self.0.values().flatten()
    }

    fn read(table: &mut Table<'_>, gravity_m_s2: Option<f64>) -> ReadResult<Self> {
        let patterns =
            RECORDS.map(|(_, key)| Some((key, table.optional(key, &one_or_more(&text()))?)));
        let given: Vec<_> = patterns.into_iter().flatten().collect();
        if given.is_empty() && !table.describes() {
            return Ok(Self::default());
        }
        let format = format::read(table);
        let listing = RecordListing::read(table, &given, format, &[]);
        table.check_faultless()?;
        let gravity_m_s2 = gravity_m_s2.ok_or(FaultRecorded)?;
        let accept = |series: &Series| {
            series.check_not_zero(gravity_m_s2)?;
            series.check_strength(gravity_m_s2)
        };
        let mut records = Self::default();
        for (key, series) in listing.series(table, accept)? {
            table.note_file(&series.file);
            let [(slv, slv_records), (slc, _)] = RECORDS;
            let state = if key == slv_records { slv } else { slc };
            records.0.entry(state).or_default().push(series);
        }
        for (state, key) in RECORDS {
            let count = records.records_of(state).len();
            let is_few = table.has_key(key) && count < LEAST_RECORDS;
            let wrong = format!(
                "has {count} records; must be at least {LEAST_RECORDS}, of which the worst counts, or 7 for their mean \
                 (NTC 2018, § 7.3.5)"
            );
            let _ = table.refuse(is_few, key, wrong);
        }
        Ok(records)
    }
}

impl Serialize for Records {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        table_entries(&RECORDS.map(|(state, key)| (key, self.records_of(state))))
            .serialize(serializer)
    }
}

/// Default confidence factor FC: that of the lowest level of knowledge, LC1 (Tab. C8.5.IV). It applies if the load multiplier does not account
/// for the compressive strength.
pub const CONFIDENCE_FACTOR: f64 = 1.35;
/// Default behaviour factor q (C8.7.1.2.1.7).
pub const BEHAVIOUR_FACTOR: f64 = 2.0;

const CONFIDENCE: Number =
    within(&(1.0..=2.0)).because("Circolare 7/2019, Tab. C8.5.IV has 1.00 to 1.35");
const BEHAVIOUR: Number =
    within(&(1.0..=5.0)).because("Circolare 7/2019, C8.7.1.2.1.7 has 2 without better knowledge");
const PERIOD_S: Number = above(0.0, 10.0);

impl Default for Verify {
    fn default() -> Self {
        Self {
            confidence_factor: CONFIDENCE_FACTOR,
            behaviour_factor: BEHAVIOUR_FACTOR,
            sides: CheckedSides::Both,
            free_standing: None,
            language: Language::English,
            records: Records::default(),
        }
    }
}

impl Verify {
    /// Reads `[verify]` with its records.
    pub(super) fn read(table: &mut Table<'_>, gravity_m_s2: Option<f64>) -> ReadResult<Self> {
        Ok(Self {
            confidence_factor: table.or("confidence_factor", &CONFIDENCE, CONFIDENCE_FACTOR),
            behaviour_factor: table.or("behaviour_factor", &BEHAVIOUR, BEHAVIOUR_FACTOR),
            sides: table.or("sides", &one_of(CheckedSides::ALL), CheckedSides::Both),
            free_standing: table.table("free_standing", FreeStanding::read),
            language: table.or("language", &one_of(Language::ALL), Language::English),
            records: Records::read(table, gravity_m_s2)?,
        })
    }

    /// Rejects records of limit states that are not checked, and records if only one side is checked.
    pub(super) fn check_demand(
        &self,
        table: &mut Table<'_>,
        demand: Option<&Demand>,
    ) -> ReadResult<()> {
        let has_records =
            |(state, _): &(LimitState, _)| !self.records.records_of(*state).is_empty();
        for (state, key) in RECORDS.into_iter().filter(has_records) {
            let is_checked =
                demand.is_some_and(|demand| demand.limit_states().any(|one| one == state));
            let wrong = match self.sides {
                _ if !is_checked => {
                    format!("needs [demand.{}], which sets the limits", state.name())
                }
                CheckedSides::Both => continue,
                _ => "goes with sides = \"both\": histories sway to both sides".to_owned(),
            };
            return Err(table.reject_in(&["verify"], key, wrong));
        }
        Ok(())
    }
}

/// Values by limit state.
pub type ByState<T> = BTreeMap<LimitState, T>;

fn read_by_state<T>(
    table: &mut Table<'_>,
    read: impl Fn(&mut Table<'_>, LimitState) -> ReadResult<T>,
) -> ByState<T> {
    let states = LimitState::ALL.iter();
    let values = states.filter_map(|state| {
        let value = table.table(state.name(), |table| read(table, *state))?;
        Some((*state, value))
    });
    values.collect()
}

/// The demand of the ground or of the building.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Demand {
    /// Spectra of NTC 2018, from their parameters.
    Code(CodeDemand),
    /// Spectra given by points.
    Points(ByState<PointDemand>),
}

/// Parameters of the spectra of NTC 2018.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CodeDemand {
    /// Soil category.
    pub soil: Soil,
    /// Topography.
    #[serde(flatten)]
    pub topography: SiteTopography,
    /// Hazard of each checked limit state.
    #[serde(flatten)]
    pub hazards: ByState<Hazard>,
    /// Position in a building; `None` on the ground.
    pub height: Option<Building>,
}

/// The topography of a site.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SiteTopography {
    /// A category, with the largest coefficient of the category.
    Topography(Topography),
    /// The coefficient itself.
    TopographicFactor(f64),
}

impl SiteTopography {
    /// Coefficient `S_T`.
    pub const fn factor(&self) -> f64 {
        match self {
            Self::Topography(category) => category.factor(),
            Self::TopographicFactor(factor) => *factor,
        }
    }
}

/// The building that carries the mechanism.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Building {
    /// Modes of the building.
    pub modes: Vec<BuildingMode>,
}

/// A mode of a building, with its vibration at each limit state.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BuildingMode {
    /// Participation factor; its sign depends on the sign of the modal shape.
    pub gamma: f64,
    /// Modal shape at the height of the mechanism.
    pub psi: f64,
    /// Vibration of the mode at each limit state.
    #[serde(flatten)]
    pub states: ByState<ModeState>,
}

/// Vibration of a mode of the building at a limit state.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ModeState {
    /// Period, in seconds.
    pub t_s: f64,
    /// Damping, in per cent.
    pub damping_percent: f64,
}

/// A spectrum given by points, and the rule of its limit state.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PointDemand {
    /// Name of the file.
    pub spectrum: String,
    /// Decimal mark of its numbers.
    #[serde(skip_serializing_if = "is_point")]
    pub decimal: Decimal,
    /// Damping of the given spectrum, in per cent.
    pub damping_percent: f64,
    /// Rule of the limit state; `None` for SLD, which is the onset of motion.
    pub state: Option<StateRule>,
    /// The points.
    #[serde(skip)]
    pub points: PointSpectrum,
}

/// The rule that defines a limit state in terms of displacements.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StateRule {
    /// Fraction of the ultimate displacement that is allowed.
    pub part_of_d0: f64,
    /// Factor of the period, which is pi times this factor times `sqrt(d / a)`.
    pub period_factor: f64,
    /// Damping of the mechanism, in per cent.
    pub damping_percent: f64,
    /// Divisor of the accelerations of the mechanism.
    pub divide_acceleration: f64,
    /// Divisor of the allowed displacements; it does not affect the period.
    pub divide_displacement: f64,
}

impl StateRule {
    /// Rule of the Circolare 7/2019 (C8.7.1.2.1.6 and .8) for a confidence factor; `None` for SLD.
    pub const fn circolare(state: LimitState, confidence_factor: f64) -> Option<Self> {
        let (part_of_d0, period_factor, damping_percent) = match state {
            LimitState::Sld => return None,
            LimitState::Slv => (0.40, 1.68, 8.0),
            LimitState::Slc => (0.60, 1.56, 10.0),
        };
        Some(Self {
            part_of_d0,
            period_factor,
            damping_percent,
            divide_acceleration: confidence_factor,
            divide_displacement: 1.0,
        })
    }

    fn read(table: &mut Table<'_>, default: Self) -> ReadResult<Self> {
        let mut or = |key, rule: &Number, default| table.or(key, rule, default);
        let part = between(Excluded(0.0), Excluded(1.0));
        Ok(Self {
            part_of_d0: or("part_of_d0", &part, default.part_of_d0),
            period_factor: or("period_factor", &above(0.0, 10.0), default.period_factor),
            damping_percent: or("damping_percent", &DAMPING_PERCENT, default.damping_percent),
            divide_acceleration: or("divide_acceleration", &DIVIDE, default.divide_acceleration),
            divide_displacement: or("divide_displacement", &DIVIDE, default.divide_displacement),
        })
    }
}

/// Range of the parameters. The ranges of the code depend on the soil; [`GroundSpectrum::new`] checks them.
const HAZARD: Number = between(Excluded(0.0), Unbounded).because("NTC 2018, § 3.2");
const TOPOGRAPHIC_FACTOR: Number =
    within(&(1.0..=2.0)).because("NTC 2018, Tab. 3.2.V has 1.0 to 1.4");
/// Largest damping: beyond it the spectrum of a floor does not exceed its peak acceleration.
const DAMPING_PERCENT: Number = above(0.0, 30.0);
const DIVIDE: Number = within(&(1.0..=10.0));

/// Keys of `[demand]` for spectra of the code.
const CODE_KEYS: [&str; 4] = ["soil", "topography", "topographic_factor", "height"];

impl Demand {
    /// Reads `[demand]` of the scenario.
    pub(super) fn read_given(outer: &mut Table<'_>, options: &Verify) -> ReadResult<Option<Self>> {
        let points = |table: &mut Table<'_>| {
            Ok(read_by_state(table, |table, state| {
                PointDemand::read(table, state, options.confidence_factor)
            }))
        };
        if outer.describes() {
            outer.table(StudyTable::Demand.name(), points);
        }
        StudyTable::Demand.read(outer, |table| Self::read(table, points))
    }

    fn read(table: &mut Table<'_>, points: impl Reader<ByState<PointDemand>>) -> ReadResult<Self> {
        let mut states = LimitState::ALL.iter().map(|state| state.name());
        let demand = if states.any(|state| table.has_key_in(state, "spectrum")) {
            if let Some(key) = CODE_KEYS.into_iter().find(|key| table.has_key(key)) {
                let wrong = "applies to ag_g, f0 and tc_star_s; spectra from files are used unchanged: leave it out";
                return Err(table.reject(key, wrong));
            }
            Self::Points(points(table)?)
        } else {
            Self::Code(CodeDemand::read(table)?)
        };
        table.check_faultless()?;
        let is_damage = demand.limit_states().all(|state| state == LimitState::Sld);
        let wrong = "has nothing to check beyond damage: give [demand.slv] or [demand.slc]";
        table.refuse_all(is_damage, wrong)?;
        Ok(demand)
    }

    /// Checked limit states.
    pub fn limit_states(&self) -> impl Iterator<Item = LimitState> {
        let states = LimitState::ALL.iter().copied();
        states.filter(move |state| match self {
            Self::Code(code) => code.hazards.contains_key(state),
            Self::Points(points) => points.contains_key(state),
        })
    }
}

impl CodeDemand {
    fn read(table: &mut Table<'_>) -> ReadResult<Self> {
        let soil = table.read_required("soil", &one_of(Soil::ALL));
        let category = table.optional("topography", &one_of(Topography::ALL));
        let factor = table.optional("topographic_factor", &TOPOGRAPHIC_FACTOR);
        let is_site = table.check_relations(&[OneOf(&["topography", "topographic_factor"], None)]);
        let category = category.map(SiteTopography::Topography);
        let topography = category.or(factor.map(SiteTopography::TopographicFactor));
        let site = topography
            .filter(|_| is_site.is_ok())
            .map(|topography| Site {
                soil,
                topographic_factor: topography.factor(),
            });
        let hazards = read_by_state(table, |table, _| read_hazard(table, site));
        let height = table.table("height", |table| Building::read(table, &hazards));
        Ok(Self {
            soil,
            topography: topography.ok_or(FaultRecorded)?,
            hazards,
            height,
        })
    }
}

fn read_hazard(table: &mut Table<'_>, site: Option<Site>) -> ReadResult<Hazard> {
    let hazard = Hazard {
        ag_g: table.read_required("ag_g", &HAZARD),
        f0: table.read_required("f0", &HAZARD),
        tc_star_s: table.read_required("tc_star_s", &HAZARD),
    };
    table.check_faultless()?;
    if let Some(site) = site {
        GroundSpectrum::new(hazard, site).map_err(|error| {
            let wrong = format!("is out of range: must be {}", error.allowed);
            table.reject(error.argument, wrong)
        })?;
    }
    Ok(hazard)
}

impl Building {
    /// Reads `[demand.height]`, for the limit states with these hazards.
    fn read(table: &mut Table<'_>, hazards: &ByState<Hazard>) -> ReadResult<Self> {
        let modes = table.tables("modes", BuildingMode::read);
        table.check_faultless()?;
        let missing = "lacks `modes`: give the modes of the building, at least the first";
        table.refuse_all(modes.is_empty(), missing)?;
        for state in LimitState::ALL {
            let lacks = |mode: &BuildingMode| !mode.states.contains_key(state);
            let checked = hazards.contains_key(state);
            if let Some(index) = modes.iter().position(lacks).filter(|_| checked) {
                let name = state.name();
                let wrong = format!(
                    "lacks `{name}`, the period and damping of the building at that state: give \
                     {name} = {{ t_s = ..., damping_percent = ... }}"
                );
                return Err(table.reject_element("modes", index, wrong));
            }
        }
        Ok(Self { modes })
    }

    /// Modes at a limit state.
    pub fn modes_at(&self, state: LimitState) -> Vec<Mode> {
        let modes = self.modes.iter().filter_map(|mode| {
            let at_state = mode.states.get(&state)?;
            Some(Mode {
                t_s: at_state.t_s,
                damping_percent: at_state.damping_percent,
                gamma: mode.gamma,
                psi: mode.psi,
            })
        });
        modes.collect()
    }
}

impl BuildingMode {
    fn read(table: &mut Table<'_>) -> ReadResult<Self> {
        let any = within(&(-10.0..=10.0));
        Ok(Self {
            gamma: table.read_required("gamma", &any),
            psi: table.read_required("psi", &any),
            states: read_by_state(table, |table, _| {
                Ok(ModeState {
                    t_s: table.read_required("t_s", &PERIOD_S),
                    damping_percent: table.read_required("damping_percent", &DAMPING_PERCENT),
                })
            }),
        })
    }
}

fn is_point(decimal: &Decimal) -> bool {
    *decimal == Decimal::Point
}

impl PointDemand {
    fn read(table: &mut Table<'_>, state: LimitState, confidence_factor: f64) -> ReadResult<Self> {
        let spectrum = table.read_required("spectrum", &text());
        let damping_percent = table.or("damping_percent", &DAMPING_PERCENT, 5.0);
        let decimal = layout::decimal(table);
        let default = StateRule::circolare(state, confidence_factor);
        let rule = default.map(|default| {
            table.table_or_defaults("state", |table| StateRule::read(table, default))
        });
        table.check_faultless()?;
        let points = read_points(table.files(), &spectrum, decimal, damping_percent);
        let points = table.accept("spectrum", points)?;
        table.note_file(&spectrum);
        Ok(Self {
            spectrum,
            decimal,
            damping_percent,
            state: rule.transpose()?,
            points,
        })
    }
}

/// Reads the points of a spectrum from a file. The error is the fault in the file.
fn read_points(
    files: &Files,
    file: &str,
    decimal: Decimal,
    damping_percent: f64,
) -> Result<PointSpectrum, String> {
    let path = &files.path(file);
    let rows = read_numbers::<2>(files, path, decimal)?;
    let points = rows.iter().map(|(_, [period_s, at_g])| (*period_s, *at_g));
    PointSpectrum::new(points.collect(), damping_percent).map_err(|error| {
        let (line, message) = (error.row.and_then(|row| rows.get(row)), error.to_string());
        line.map_or(message.clone(), |(line, _)| {
            faulty(
                path,
                &LineFault {
                    line: *line,
                    message,
                },
            )
        })
    })
}
