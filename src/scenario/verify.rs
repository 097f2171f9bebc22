//! A check by the Circolare 7/2019: the demand, `[demand]`, and the options of the check, `[verify]`.
//!
//! ```toml
//! [verify]                      # all may be left out
//! confidence_factor = 1.35
//! behaviour_factor = 2.0
//! sides = "both"                # or "right", "left"
//! free_standing = { t0_s = 0.143 }     # or { kappa = 6.2, length_m = 4, thickness_m = 0.8, modulus_gpa = 1.5 }
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

use std::ops::Bound::{Excluded, Included, Unbounded};
use std::path::Path;

use serde::Serialize;
use serde::ser::{SerializeMap as _, Serializer};
use toml::de::DeValue;

use super::LineFault;
use super::listing::{Listing, serialize_layout};
use super::record::{Format, Series, faulty, read_numbers};
use super::structure::MAGNITUDE;
use super::table::{Number, OneOf, OneOrMore, Reading, Rule, Table, Text};
use crate::dynamics::demand::floor::Mode;
use crate::dynamics::demand::ground::{GroundSpectrum, Hazard, Site, Soil, Topography};
use crate::dynamics::demand::points::PointSpectrum;

named! {
    /// A limit state.
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
    pub enum Sides {
        /// Both; the worse result counts.
        Both = "both",
        /// To the right only: something holds the structure on the other side.
        Right = "right",
        /// To the left only.
        Left = "left",
    }
}

/// Period of the elastic vibration before a mechanism moves, for a structure that no walls hold.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum FreeStanding {
    /// A known period.
    Period {
        /// The period, in seconds.
        t0_s: f64,
    },
    /// The period by [C8.7.1.7].
    Elastic {
        /// 6.2 for a cantilever, 2.2 if it is supported at both ends.
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
    /// The period in seconds, for masonry of this density in kg/m3: `kappa lambda L sqrt(W / (E g))`, with `lambda = L / t` and
    /// the weight per volume `W` [C8.7.1.7].
    #[must_use]
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
}

/// The options of a check.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verify {
    /// Confidence factor FC, by which accelerations are divided.
    pub confidence_factor: f64,
    /// Behaviour factor q for the simplified check of SLV.
    pub behaviour_factor: f64,
    /// The sides that are checked.
    pub sides: Sides,
    /// If given, the structure is free to vibrate before it moves; `None`: walls hold it all along.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub free_standing: Option<FreeStanding>,
    /// Records of the dynamic route.
    #[serde(flatten)]
    pub records: Records,
}

/// Records of the motion at the place of the mechanism, for each limit state; empty for a state that is not checked with records.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Records {
    /// For SLV.
    pub slv: Vec<Series>,
    /// For SLC.
    pub slc: Vec<Series>,
}

const SLV_RECORDS: &str = "slv_records";
const SLC_RECORDS: &str = "slc_records";
/// The least number of records of which the worst counts (NTC 2018, § 7.3.5).
const LEAST_RECORDS: usize = 3;

impl Records {
    /// The records of a state.
    #[must_use]
    pub fn of(&self, state: LimitState) -> &[Series] {
        match state {
            LimitState::Sld => &[],
            LimitState::Slv => &self.slv,
            LimitState::Slc => &self.slc,
        }
    }

    fn read(table: &mut Table<'_>, folder: &Path, gravity_m_s2: Reading<f64>) -> Reading<Self> {
        let keys = [SLV_RECORDS, SLC_RECORDS];
        let patterns = keys.map(|key| (key, table.optional(key, &OneOrMore(&Text))));
        let given = patterns
            .into_iter()
            .filter_map(|(key, patterns)| match patterns {
                Ok(None) => None,
                Ok(Some(patterns)) => Some((key, Ok(patterns))),
                Err(reported) => Some((key, Err(reported))),
            });
        let given: Vec<_> = given.collect();
        if given.is_empty() {
            return Ok(Self::default());
        }
        let asked: Vec<&str> = given.iter().map(|(key, _)| *key).collect();
        let format = Format::read(table);
        let listing = Listing::read(table, folder, given, format)?;
        let gravity_m_s2 = gravity_m_s2?;
        let accept = |series: &Series| match series.peak_g(gravity_m_s2) {
            0.0 => Err("is zero throughout".to_owned()),
            _ => series.check_strength(gravity_m_s2),
        };
        let mut records = Self::default();
        for (key, series) in listing.series(table, folder, accept)? {
            table.note_file(folder, &series.file);
            match key {
                SLV_RECORDS => records.slv.push(series),
                _ => records.slc.push(series),
            }
        }
        for key in asked {
            let count = if key == SLV_RECORDS {
                records.slv.len()
            } else {
                records.slc.len()
            };
            if count < LEAST_RECORDS {
                let wrong = format!(
                    "has {count} records; must be at least {LEAST_RECORDS}, of which the worst counts, or 7 for their mean \
                     (NTC 2018, § 7.3.5)"
                );
                return Err(table.wrong(key, wrong));
            }
        }
        Ok(records)
    }
}

impl Serialize for Records {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for (key, records) in [(SLV_RECORDS, &self.slv), (SLC_RECORDS, &self.slc)] {
            if !records.is_empty() {
                let files: Vec<_> = records.iter().map(|series| &series.file).collect();
                map.serialize_entry(key, &files)?;
            }
        }
        let all = self.slv.iter().chain(&self.slc);
        if all.clone().next().is_some() {
            serialize_layout(&mut map, all)?;
        }
        map.end()
    }
}

/// FC of the lowest level of knowledge, LC1 (Tab. C8.5.IV); it applies if the load multiplier does not account for the
/// compressive strength.
pub const CONFIDENCE_FACTOR: f64 = 1.35;
/// q if nothing better is known (C8.7.1.2.1.7).
pub const BEHAVIOUR_FACTOR: f64 = 2.0;

/// A number in a range, and the clause that sets the range.
struct ByClause(Number, &'static str);

impl Rule for ByClause {
    type Value = f64;

    fn allowed(&self) -> String {
        format!("{} ({})", self.0.allowed(), self.1)
    }

    fn read(&self, value: &DeValue<'_>) -> Result<f64, String> {
        self.0.read(value)
    }
}

const CONFIDENCE: ByClause = ByClause(
    Number(Included(1.0), Included(2.0)),
    "Circolare 7/2019, Tab. C8.5.IV has 1.00 to 1.35",
);
const BEHAVIOUR: ByClause = ByClause(
    Number(Included(1.0), Included(5.0)),
    "Circolare 7/2019, C8.7.1.2.1.7 has 2 without better knowledge",
);
const PERIOD_S: Number = Number(Excluded(0.0), Included(10.0));
const KAPPA: Number = Number(Excluded(0.0), Included(100.0));
const MODULUS_GPA: Number = Number(Excluded(0.0), Included(1e3));

impl Default for Verify {
    fn default() -> Self {
        Self {
            confidence_factor: CONFIDENCE_FACTOR,
            behaviour_factor: BEHAVIOUR_FACTOR,
            sides: Sides::Both,
            free_standing: None,
            records: Records::default(),
        }
    }
}

impl Verify {
    /// Reads `[verify]`, whose files are relative to `folder`.
    pub(super) fn read(
        table: &mut Table<'_>,
        folder: &Path,
        gravity_m_s2: Reading<f64>,
    ) -> Reading<Self> {
        let default = Self::default();
        let confidence_factor =
            table.or("confidence_factor", &CONFIDENCE, default.confidence_factor);
        let behaviour_factor = table.or("behaviour_factor", &BEHAVIOUR, default.behaviour_factor);
        let names = OneOf {
            all: Sides::ALL,
            name: Sides::name,
        };
        let sides = table.or("sides", &names, default.sides);
        let free_standing = table.table("free_standing", FreeStanding::read);
        let records = Records::read(table, folder, gravity_m_s2);
        Ok(Self {
            confidence_factor: confidence_factor?,
            behaviour_factor: behaviour_factor?,
            sides: sides?,
            free_standing: free_standing?,
            records: records?,
        })
    }

    /// Refuses records for states that are not checked, and records if only one side is checked.
    pub(super) fn suits(&self, table: &mut Table<'_>, demand: Option<&Demand>) -> Reading<()> {
        for (key, state) in [
            (SLV_RECORDS, LimitState::Slv),
            (SLC_RECORDS, LimitState::Slc),
        ] {
            if self.records.of(state).is_empty() {
                continue;
            }
            let asked = demand.is_some_and(|demand| demand.states().any(|one| one == state));
            if !asked {
                let wrong = format!(
                    "needs [demand.{}], which tells what is allowed",
                    state.name()
                );
                return Err(table.wrong_in("verify", key, wrong));
            }
            if self.sides != Sides::Both {
                let wrong = "goes with sides = \"both\": histories sway to both sides";
                return Err(table.wrong_in("verify", key, wrong));
            }
        }
        Ok(())
    }
}

impl FreeStanding {
    fn read(table: &mut Table<'_>) -> Reading<Self> {
        if table.gives("t0_s") {
            let t0_s = table.required("t0_s", &PERIOD_S)?;
            return Ok(Self::Period { t0_s });
        }
        let kappa = table.required("kappa", &KAPPA);
        let length_m = table.required("length_m", &MAGNITUDE);
        let thickness_m = table.required("thickness_m", &MAGNITUDE);
        let modulus_gpa = table.required("modulus_gpa", &MODULUS_GPA);
        Ok(Self::Elastic {
            kappa: kappa?,
            length_m: length_m?,
            thickness_m: thickness_m?,
            modulus_gpa: modulus_gpa?,
        })
    }
}

/// One value for each limit state that has one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ByState<T> {
    /// For SLD.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sld: Option<T>,
    /// For SLV.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slv: Option<T>,
    /// For SLC.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slc: Option<T>,
}

impl<T> ByState<T> {
    /// The value for a state.
    #[must_use]
    pub const fn get(&self, state: LimitState) -> Option<&T> {
        match state {
            LimitState::Sld => self.sld.as_ref(),
            LimitState::Slv => self.slv.as_ref(),
            LimitState::Slc => self.slc.as_ref(),
        }
    }

    fn read(
        table: &mut Table<'_>,
        read: impl Fn(&mut Table<'_>, LimitState) -> Reading<T>,
    ) -> Reading<Self> {
        let mut of = |state: LimitState| table.table(state.name(), |table| read(table, state));
        let (sld, slv, slc) = (
            of(LimitState::Sld),
            of(LimitState::Slv),
            of(LimitState::Slc),
        );
        Ok(Self {
            sld: sld?,
            slv: slv?,
            slc: slc?,
        })
    }
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
    pub relief: Relief,
    /// Hazard of each state that is checked.
    #[serde(flatten)]
    pub hazards: ByState<Hazard>,
    /// Position at a height in a building; `None`: on the ground.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub height: Option<Height>,
}

/// The topography of a site.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Relief {
    /// A category, with its largest coefficient.
    Topography(Topography),
    /// The coefficient itself.
    TopographicFactor(f64),
}

impl Relief {
    /// The coefficient `S_T`.
    #[must_use]
    pub const fn factor(&self) -> f64 {
        match self {
            Self::Topography(category) => category.factor(),
            Self::TopographicFactor(factor) => *factor,
        }
    }
}

/// The building at a height of which the mechanism stands.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Height {
    /// The building's modes.
    pub modes: Vec<BuildingMode>,
}

/// A mode of a building, with its vibration at each limit state.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BuildingMode {
    /// Participation factor; its sign depends on that of the modal shape.
    pub gamma: f64,
    /// Modal shape at the height of the mechanism.
    pub psi: f64,
    /// Its vibration at each limit state.
    #[serde(flatten)]
    pub states: ByState<ModeState>,
}

/// How a mode of the building vibrates.
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
    /// Its file.
    pub spectrum: String,
    /// Damping of the given spectrum, in per cent.
    pub damping_percent: f64,
    /// The rule of the state; `None` for SLD, which is the onset of motion.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub state: Option<StateRule>,
    /// The points.
    #[serde(skip)]
    pub points: PointSpectrum,
}

/// The rule that defines a limit state in terms of displacements.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StateRule {
    /// Fraction of the ultimate displacement that may be reached.
    pub part_of_d0: f64,
    /// The period is pi times this factor times `sqrt(d / a)`.
    pub period_factor: f64,
    /// Damping of the mechanism, in per cent.
    pub damping_percent: f64,
    /// Divisor of the accelerations of the mechanism.
    pub divide_acceleration: f64,
    /// Divisor of the displacements that may be reached, applied once the period is known.
    pub divide_displacement: f64,
}

impl StateRule {
    /// The rule of the Circolare 7/2019 (C8.7.1.2.1.6 and .8) for a confidence factor; `None` for SLD.
    #[must_use]
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
}

/// The code's own ranges depend on the soil; [`GroundSpectrum::new`] checks them.
const HAZARD: ByClause = ByClause(Number(Excluded(0.0), Unbounded), "NTC 2018, § 3.2");
const TOPOGRAPHIC_FACTOR: ByClause = ByClause(
    Number(Included(1.0), Included(2.0)),
    "NTC 2018, Tab. 3.2.V has 1.0 to 1.4",
);
const GAMMA: Number = Number(Included(-10.0), Included(10.0));
const PSI: Number = Number(Included(-10.0), Included(10.0));
/// At more damping than this the spectrum of a floor is no longer larger than its peak.
const DAMPING_PERCENT: Number = Number(Excluded(0.0), Included(30.0));
const PART_OF_D0: Number = Number(Excluded(0.0), Excluded(1.0));
const PERIOD_FACTOR: Number = Number(Excluded(0.0), Included(10.0));
const DIVIDE: Number = Number(Included(1.0), Included(10.0));

/// Keys of `[demand]` that define spectra of the code.
const CODE_KEYS: [&str; 4] = ["soil", "topography", "topographic_factor", "height"];

impl Demand {
    /// Reads `[demand]`, whose files are relative to `folder`.
    pub(super) fn read(
        table: &mut Table<'_>,
        folder: &Path,
        confidence_factor: Reading<f64>,
    ) -> Reading<Self> {
        let states = || LimitState::ALL.iter().map(|state| state.name());
        let demand = if states().any(|state| table.gives_in(state, "spectrum")) {
            for key in CODE_KEYS {
                if table.gives(key) {
                    let wrong = "goes with ag_g, f0 and tc_star_s; spectra from files are taken as they are: leave it out";
                    return Err(table.wrong(key, wrong));
                }
            }
            let confidence_factor = confidence_factor?;
            let of = |table: &mut Table<'_>, state| {
                PointDemand::read(table, folder, state, confidence_factor)
            };
            Self::Points(ByState::read(table, of)?)
        } else {
            Self::Code(CodeDemand::read(table)?)
        };
        if demand.states().all(|state| state == LimitState::Sld) {
            return Err(table.wrong_itself(
                "has nothing to check beyond damage: give [demand.slv] or [demand.slc]",
            ));
        }
        Ok(demand)
    }

    /// The limit states that are checked.
    pub fn states(&self) -> impl Iterator<Item = LimitState> {
        let states = LimitState::ALL.iter().copied();
        states.filter(|state| match self {
            Self::Code(code) => code.hazards.get(*state).is_some(),
            Self::Points(points) => points.get(*state).is_some(),
        })
    }
}

impl CodeDemand {
    fn read(table: &mut Table<'_>) -> Reading<Self> {
        let soils = OneOf {
            all: Soil::ALL,
            name: Soil::name,
        };
        let categories = OneOf {
            all: Topography::ALL,
            name: Topography::name,
        };
        let soil = table.required("soil", &soils);
        let category = table.optional("topography", &categories);
        let factor = table.optional("topographic_factor", &TOPOGRAPHIC_FACTOR);
        let relief = table.exactly_one(
            "keys",
            vec![
                ("topography", category.map(|x| x.map(Relief::Topography))),
                (
                    "topographic_factor",
                    factor.map(|x| x.map(Relief::TopographicFactor)),
                ),
            ],
        );
        let site = match (&soil, &relief) {
            (Ok(soil), Ok(relief)) => Some(Site {
                soil: *soil,
                topographic_factor: relief.factor(),
            }),
            _ => None,
        };
        let hazards = ByState::read(table, |table, _| read_hazard(table, site));
        let height = table.table("height", |table| Height::read(table, hazards.as_ref().ok()));
        Ok(Self {
            soil: soil?,
            relief: relief?,
            hazards: hazards?,
            height: height?,
        })
    }
}

fn read_hazard(table: &mut Table<'_>, site: Option<Site>) -> Reading<Hazard> {
    let ag_g = table.required("ag_g", &HAZARD);
    let f0 = table.required("f0", &HAZARD);
    let tc_star_s = table.required("tc_star_s", &HAZARD);
    let hazard = Hazard {
        ag_g: ag_g?,
        f0: f0?,
        tc_star_s: tc_star_s?,
    };
    if let Some(site) = site {
        GroundSpectrum::new(hazard, site).map_err(|error| {
            let wrong = format!("is out of range: must be {}", error.allowed);
            table.wrong(error.argument, wrong)
        })?;
    }
    Ok(hazard)
}

impl Height {
    /// Reads `[demand.height]`, for the states with these hazards.
    fn read(table: &mut Table<'_>, hazards: Option<&ByState<Hazard>>) -> Reading<Self> {
        let modes = table.tables("modes", BuildingMode::read)?;
        if modes.is_empty() {
            return Err(table.wrong_itself(
                "lacks `modes`: give the modes of the building, at least the first",
            ));
        }
        for state in LimitState::ALL {
            let asked = hazards.is_some_and(|hazards| hazards.get(*state).is_some());
            let lacks = |mode: &BuildingMode| mode.states.get(*state).is_none();
            if let Some(index) = modes.iter().position(lacks).filter(|_| asked) {
                let name = state.name();
                let wrong = format!(
                    "lacks `{name}`, the period and damping of the building at that state: give \
                     {name} = {{ t_s = ..., damping_percent = ... }}"
                );
                return Err(table.wrong_element("modes", index, wrong));
            }
        }
        Ok(Self { modes })
    }

    /// The modes at a limit state.
    #[must_use]
    pub fn at(&self, state: LimitState) -> Vec<Mode> {
        let modes = self.modes.iter();
        modes
            .filter_map(|mode| {
                let ModeState {
                    t_s,
                    damping_percent,
                } = *mode.states.get(state)?;
                Some(Mode {
                    t_s,
                    damping_percent,
                    gamma: mode.gamma,
                    psi: mode.psi,
                })
            })
            .collect()
    }
}

impl BuildingMode {
    fn read(table: &mut Table<'_>) -> Reading<Self> {
        let gamma = table.required("gamma", &GAMMA);
        let psi = table.required("psi", &PSI);
        let states = ByState::read(table, |table, _| {
            let t_s = table.required("t_s", &PERIOD_S);
            let damping_percent = table.required("damping_percent", &DAMPING_PERCENT);
            Ok(ModeState {
                t_s: t_s?,
                damping_percent: damping_percent?,
            })
        });
        Ok(Self {
            gamma: gamma?,
            psi: psi?,
            states: states?,
        })
    }
}

impl PointDemand {
    fn read(
        table: &mut Table<'_>,
        folder: &Path,
        state: LimitState,
        confidence_factor: f64,
    ) -> Reading<Self> {
        let spectrum = table.required("spectrum", &Text);
        let damping_percent = table.or("damping_percent", &DAMPING_PERCENT, 5.0);
        let rule = match StateRule::circolare(state, confidence_factor) {
            Some(default) => table
                .table_or_defaults("state", |table| StateRule::read(table, default))
                .map(Some),
            None => Ok(None),
        };
        let (spectrum, damping_percent) = (spectrum?, damping_percent?);
        let points = read_points(&folder.join(&spectrum), damping_percent)
            .map_err(|wrong| table.wrong("spectrum", wrong))?;
        table.note_file(folder, &spectrum);
        Ok(Self {
            spectrum,
            damping_percent,
            state: rule?,
            points,
        })
    }
}

impl StateRule {
    fn read(table: &mut Table<'_>, default: Self) -> Reading<Self> {
        let mut or = |key, rule: &Number, default| table.or(key, rule, default);
        let part_of_d0 = or("part_of_d0", &PART_OF_D0, default.part_of_d0);
        let period_factor = or("period_factor", &PERIOD_FACTOR, default.period_factor);
        let damping = or("damping_percent", &DAMPING_PERCENT, default.damping_percent);
        let acceleration = or("divide_acceleration", &DIVIDE, default.divide_acceleration);
        let displacement = or("divide_displacement", &DIVIDE, default.divide_displacement);
        Ok(Self {
            part_of_d0: part_of_d0?,
            period_factor: period_factor?,
            damping_percent: damping?,
            divide_acceleration: acceleration?,
            divide_displacement: displacement?,
        })
    }
}

/// Reads the points of a spectrum from a file, or explains what is wrong with it.
fn read_points(path: &Path, damping_percent: f64) -> Result<PointSpectrum, String> {
    let rows = read_numbers::<2>(path)?;
    let points = rows
        .iter()
        .map(|(_, [period_s, acceleration_g])| (*period_s, *acceleration_g));
    PointSpectrum::new(points.collect(), damping_percent).map_err(|error| {
        let line = error.row().and_then(|row| rows.get(row)).map(|row| row.0);
        match line {
            Some(line) => {
                let message = error.to_string();
                faulty(path, &LineFault { line, message })
            }
            None => error.to_string(),
        }
    })
}
