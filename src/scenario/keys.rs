//! The keys of the scenario file, table by table: how each is read, and how it is written back.
//!
//! A new key is a field of the model, a line in `read` and a line in `write`; the compiler asks for
//! the last two.

use std::f64::consts::PI;
use std::ops::Bound::{Excluded, Included, Unbounded};
use std::path::Path;

use super::table::{Count, Number, OneOf, Reading, Table, Text, Writer};
use super::{
    Arch, Column, Ground, Initial, Map, PulseGround, Record, Scenario, Simulation, Spectrum,
    Structure, Suite,
};
use crate::dynamics::ground::{Pulse, WaveTrain};
use crate::mechanics::four_link::impact::ImpactModel;
use crate::mechanics::four_link::limit::{LimitError, least_thickness_ratio};
use crate::mechanics::four_link::mechanism::Sway;

/// Lengths and densities: so wide that only slips of the pen are outside, and so that
/// no product of them leaves the range of an `f64`.
pub(super) const MAGNITUDE: Number = Number(Included(1e-3), Included(1e6));
const DEPTH_M: f64 = 1.0;
const DENSITY_KG_M3: f64 = 2000.0;
/// A structure as thick as its diameter has no hole; one much thinner than a millionth is lost in rounding.
pub(super) const THICKNESS_RATIO: Number = Number(Included(1e-6), Excluded(2.0));
const POSITIVE: Number = Number(Excluded(0.0), Unbounded);
/// Below one degree every ring but the thinnest has room for a straight line, and no push moves it.
pub(super) const EMBRACE_DEG: Number = Number(Included(1.0), Included(180.0));
const VOUSSOIRS: Count = Count {
    range: 3..=200,
    why: "four hinges need four joints",
};
/// What is beyond is no ground motion.
pub(crate) const LARGEST_G: f64 = 1e3;
pub(super) const AMPLITUDE_G: Number = Number(Included(-LARGEST_G), Included(LARGEST_G));
const GRAVITY_M_S2: Number = Number(Included(1e-3), Included(1e3));
pub(super) const DURATION_S: Number = Number(Included(1e-6), Included(1e6));
/// Inverses of durations.
pub(super) const FREQUENCY_HZ: Number = Number(Included(1e-6), Included(1e6));
/// At one the envelope of the velocity pulse is as long as a period; far beyond nothing is a pulse.
const GAMMA: Number = Number(Excluded(1.0), Included(100.0));
const CYCLES: Number = Number(Included(1.0), Included(100.0));
const PHASE_DEG: Number = Number(Included(-360.0), Included(360.0));
const START_S: Number = Number(Included(0.0), Included(1e6));
pub(super) const RESTITUTION: Number = Number(Included(0.0), Included(1.0));
const ROTATION_RAD: Number = Number(Excluded(0.0), Excluded(PI));
const RELATIVE_TOLERANCE: Number = Number(Included(1e-13), Included(1e-3));
const REST_ENERGY_RATIO: Number = Number(Included(1e-16), Included(0.1));
/// Rows of output that a run may write: about a gigabyte.
const MOST_ROWS: f64 = 1e7;

impl Scenario {
    /// Reads a scenario whose files are relative to `folder`.
    pub(super) fn read_table(table: &mut Table<'_>, folder: &Path) -> Reading<Self> {
        let title = table.optional("title", &Text);
        let structure = Structure::read(table);
        let simulation = table.table_or_defaults("simulation", Simulation::read);
        let gravity_m_s2 = match &simulation {
            Ok(simulation) => Ok(simulation.gravity_m_s2),
            Err(reported) => Err(*reported),
        };
        let ground = table.table("ground", |table| Ground::read(table, folder, gravity_m_s2));
        let impact = table.table_or_defaults("impact", ImpactModel::read);
        let initial = table.table("initial", |table| {
            Initial::read(table, structure.as_ref().ok())
        });
        let map = table.table("map", |table| {
            let (structure, ground) = (structure.as_ref().ok(), ground.as_ref().ok());
            let (impact, simulation) = (impact.as_ref().ok(), simulation.as_ref().ok());
            Map::read(table, structure, ground, impact, simulation)
        });
        let spectrum = table.table("spectrum", |table| {
            let structure = structure.as_ref().ok();
            Spectrum::read(table, structure, ground.as_ref().ok(), gravity_m_s2)
        });
        let suite = table.table("suite", |table| {
            Suite::read(table, folder, simulation.as_ref().ok())
        });
        Ok(Self {
            title: title?,
            structure: structure?,
            ground: ground?,
            impact: impact?,
            initial: initial?,
            simulation: simulation?,
            map: map?,
            spectrum: spectrum?,
            suite: suite?,
        })
    }

    pub(super) fn write(&self, out: &mut Writer) {
        let Self {
            title,
            structure,
            ground,
            impact,
            initial,
            simulation,
            map,
            spectrum,
            suite,
        } = self;
        if let Some(title) = title {
            out.text("title", title);
        }
        match structure {
            Structure::Arch(arch) => arch.write(out),
            Structure::Column(column) => column.write(out),
        }
        if let Some(ground) = ground {
            ground.write(out);
        }
        impact.write(out);
        if let Some(initial) = initial {
            initial.write(out);
        }
        simulation.write(out);
        if let Some(map) = map {
            map.write(out);
        }
        if let Some(spectrum) = spectrum {
            spectrum.write(out);
        }
        if let Some(suite) = suite {
            suite.write(out);
        }
    }
}

impl Structure {
    fn read(table: &mut Table<'_>) -> Reading<Self> {
        let arch = table.table("arch", |table| Arch::read(table).map(Self::Arch));
        let column = table.table("column", |table| Column::read(table).map(Self::Column));
        table.exactly_one("tables", vec![("arch", arch), ("column", column)])
    }
}

impl Arch {
    fn read(table: &mut Table<'_>) -> Reading<Self> {
        let mean_radius_m = table.required("mean_radius_m", &MAGNITUDE);
        let ratio = table.optional("thickness_ratio", &THICKNESS_RATIO);
        let from_m = Self::read_thickness_m(table, mean_radius_m);
        let thickness_ratio = table.exactly_one(
            "keys",
            vec![("thickness_ratio", ratio), ("thickness_m", from_m)],
        );
        let embrace_deg = table.required("embrace_deg", &EMBRACE_DEG);
        let depth_m = table.or("depth_m", &MAGNITUDE, DEPTH_M);
        let density_kg_m3 = table.or("density_kg_m3", &MAGNITUDE, DENSITY_KG_M3);
        let voussoirs = table.optional("voussoirs", &VOUSSOIRS);
        let arch = Self {
            mean_radius_m: mean_radius_m?,
            thickness_ratio: thickness_ratio?,
            embrace_deg: embrace_deg?,
            depth_m: depth_m?,
            density_kg_m3: density_kg_m3?,
            voussoirs: voussoirs?,
        };
        match arch.incipient() {
            Ok(_) => Ok(arch),
            Err(error) => {
                let key = if table.gives("thickness_m") {
                    "thickness_m"
                } else {
                    "thickness_ratio"
                };
                Err(table.wrong(key, arch.why_not(error)))
            }
        }
    }

    /// What a limit error means for this arch, and what to change.
    fn why_not(&self, error: LimitError) -> String {
        let embrace_deg = self.embrace_deg;
        match error {
            LimitError::CannotStand => {
                let least = least_thickness_ratio(embrace_deg.to_radians(), self.sites(), 1e-12)
                    .expect("the ranges of the keys are those of a ring");
                format!(
                    "makes an arch that cannot carry its own weight at an embrace angle of \
                     {embrace_deg:?} degrees; allowed is a thickness of at least {:?} mean radii",
                    rounded_up(least)
                )
            }
            LimitError::OtherMechanism { .. } | LimitError::NoPush => format!(
                "makes an arch too thick for its embrace angle of {embrace_deg:?} degrees: {error}; \
                 allowed is a thinner arch or a larger angle"
            ),
        }
    }

    /// The thickness ratio, when the thickness is given in metres.
    fn read_thickness_m(
        table: &mut Table<'_>,
        mean_radius_m: Reading<f64>,
    ) -> Reading<Option<f64>> {
        let Some(thickness_m) = table.optional("thickness_m", &POSITIVE)? else {
            return Ok(None);
        };
        let mean_radius_m = mean_radius_m?;
        let ratio = thickness_m / mean_radius_m;
        if THICKNESS_RATIO.contains(ratio) {
            Ok(Some(ratio))
        } else {
            let wrong = format!(
                "is out of range: {ratio:?} mean radii; allowed is a number below {:?}, twice the mean \
                 radius, and not below a millionth of the mean radius",
                2.0 * mean_radius_m
            );
            Err(table.wrong("thickness_m", wrong))
        }
    }

    fn write(&self, out: &mut Writer) {
        let Self {
            mean_radius_m,
            thickness_ratio,
            embrace_deg,
            depth_m,
            density_kg_m3,
            voussoirs,
        } = *self;
        out.table("arch");
        out.number("mean_radius_m", mean_radius_m);
        out.number("thickness_ratio", thickness_ratio);
        out.number("embrace_deg", embrace_deg);
        out.number("depth_m", depth_m);
        out.number("density_kg_m3", density_kg_m3);
        if let Some(voussoirs) = voussoirs {
            out.count("voussoirs", voussoirs);
        }
    }
}

/// The next larger number of four significant digits: a bound that is said is then one that holds.
fn rounded_up(x: f64) -> f64 {
    let unit = 10.0_f64.powf(3.0 - x.log10().floor());
    (x * unit).ceil() / unit
}

impl Column {
    fn read(table: &mut Table<'_>) -> Reading<Self> {
        let height_m = table.required("height_m", &MAGNITUDE);
        let width_m = table.required("width_m", &MAGNITUDE);
        let depth_m = table.or("depth_m", &MAGNITUDE, DEPTH_M);
        let density_kg_m3 = table.or("density_kg_m3", &MAGNITUDE, DENSITY_KG_M3);
        Ok(Self {
            height_m: height_m?,
            width_m: width_m?,
            depth_m: depth_m?,
            density_kg_m3: density_kg_m3?,
        })
    }

    fn write(&self, out: &mut Writer) {
        let Self {
            height_m,
            width_m,
            depth_m,
            density_kg_m3,
        } = *self;
        out.table("column");
        out.number("height_m", height_m);
        out.number("width_m", width_m);
        out.number("depth_m", depth_m);
        out.number("density_kg_m3", density_kg_m3);
    }
}

impl Ground {
    /// Reads `[ground]`, which holds one table, named by its kind: an inner key for the kind
    /// would not keep the keys of different kinds apart.
    fn read(table: &mut Table<'_>, folder: &Path, gravity_m_s2: Reading<f64>) -> Reading<Self> {
        let mut kinds: Vec<_> = Pulse::ALL
            .iter()
            .map(|&kind| {
                let read = |table: &mut Table<'_>| PulseGround::read(table, kind).map(Self::Pulse);
                (kind.name(), table.table(kind.name(), read))
            })
            .collect();
        let read =
            |table: &mut Table<'_>| Record::read(table, folder, gravity_m_s2).map(Self::Record);
        kinds.push(("record", table.table("record", read)));
        table.exactly_one("tables", kinds)
    }

    /// Refuses the table of a study that is about pulses where there is no pulse; `None`: not known.
    pub(super) fn check_pulse(table: &mut Table<'_>, ground: Option<&Option<Self>>) -> Reading<()> {
        match ground {
            Some(None | Some(Self::Record(_))) => Err(table.wrong_itself(
                "needs a pulse: give a table [ground.<kind>], such as [ground.rectangular]",
            )),
            Some(Some(Self::Pulse(_))) | None => Ok(()),
        }
    }

    fn write(&self, out: &mut Writer) {
        match self {
            Self::Pulse(pulse) => pulse.write(out),
            Self::Record(record) => record.write(out),
        }
    }
}

/// The key for the length of a wave train, as its source calls it, and its range.
const fn cycles_key(kind: Pulse) -> (&'static str, &'static Number) {
    match kind {
        Pulse::WindowedSine => ("cycles", &CYCLES),
        _ => ("gamma", &GAMMA),
    }
}

impl PulseGround {
    fn read(table: &mut Table<'_>, kind: Pulse) -> Reading<Self> {
        let amplitude_g = table.required("amplitude_g", &AMPLITUDE_G);
        let vertical_amplitude_g = table.or("vertical_amplitude_g", &AMPLITUDE_G, 0.0);
        let duration_s = table.required("duration_s", &DURATION_S);
        let start_s = table.or("start_s", &START_S, 0.0);
        let (mut cycles, mut phase_deg) = (Ok(WaveTrain::default().cycles), Ok(0.0));
        if kind.is_wave_train() {
            let (key, range) = cycles_key(kind);
            cycles = table.or(key, range, WaveTrain::default().cycles);
            phase_deg = table.or("phase_deg", &PHASE_DEG, 0.0);
        }
        let pulse = Self {
            kind,
            amplitude_g: amplitude_g?,
            vertical_amplitude_g: vertical_amplitude_g?,
            duration_s: duration_s?,
            start_s: start_s?,
            cycles: cycles?,
            phase_deg: phase_deg?,
        };
        // In units of gravity this does not depend on gravity.
        match pulse.motion(1.0).free_fall_s(1.0) {
            None => Ok(pulse),
            Some(time_s) => Err(table.wrong("vertical_amplitude_g", super::free_fall(time_s))),
        }
    }

    fn write(&self, out: &mut Writer) {
        let Self {
            kind,
            amplitude_g,
            vertical_amplitude_g,
            duration_s,
            start_s,
            cycles,
            phase_deg,
        } = *self;
        out.table(&format!("ground.{}", kind.name()));
        out.number("amplitude_g", amplitude_g);
        out.number("vertical_amplitude_g", vertical_amplitude_g);
        out.number("duration_s", duration_s);
        out.number("start_s", start_s);
        if kind.is_wave_train() {
            out.number(cycles_key(kind).0, cycles);
            out.number("phase_deg", phase_deg);
        }
    }
}

impl ImpactModel {
    fn read(table: &mut Table<'_>) -> Reading<Self> {
        // The name alone decides here; the restitution is filled in below.
        let all = [
            Self::MaxRestitution,
            Self::SameSections,
            Self::Mirrored,
            Self::Prescribed { restitution: 0.0 },
        ];
        let names = OneOf {
            all: &all,
            name: |model| model.name(),
        };
        let model = table.or("model", &names, Self::MaxRestitution);
        let restitution = table.optional("restitution", &RESTITUTION);
        match (model?, restitution?) {
            (Self::Prescribed { .. }, Some(restitution)) => Ok(Self::Prescribed { restitution }),
            (Self::Prescribed { .. }, None) => Ok(Self::Prescribed {
                restitution: table.required("restitution", &RESTITUTION)?,
            }),
            (model, None) => Ok(model),
            (model, Some(_)) => {
                let wrong = format!(
                    "goes with model = \"prescribed\" only; the model here is {:?}",
                    model.name()
                );
                Err(table.wrong("restitution", wrong))
            }
        }
    }

    fn write(&self, out: &mut Writer) {
        out.table("impact");
        out.text("model", self.name());
        if let Self::Prescribed { restitution } = *self {
            out.number("restitution", restitution);
        }
    }
}

impl Initial {
    fn read(table: &mut Table<'_>, structure: Option<&Structure>) -> Reading<Self> {
        let sways = OneOf {
            all: Sway::ALL,
            name: Sway::name,
        };
        let sway = table.required("sway", &sways);
        let rotation_rad = table.required("rotation_rad", &ROTATION_RAD);
        if let (Some(structure), Ok(rotation_rad)) = (structure, &rotation_rad) {
            let limit_rad = structure.limit_rad();
            if *rotation_rad >= limit_rad {
                let wrong = format!(
                    "is beyond the limit position of the mechanism; allowed is a number above 0.0 and \
                     below {limit_rad:?}"
                );
                return Err(table.wrong("rotation_rad", wrong));
            }
        }
        Ok(Self {
            sway: sway?,
            rotation_rad: rotation_rad?,
        })
    }

    fn write(&self, out: &mut Writer) {
        let Self { sway, rotation_rad } = *self;
        out.table("initial");
        out.text("sway", sway.name());
        out.number("rotation_rad", rotation_rad);
    }
}

impl Simulation {
    fn read(table: &mut Table<'_>) -> Reading<Self> {
        let duration_s = table.or("duration_s", &DURATION_S, 10.0);
        let output_step_s = table.or("output_step_s", &DURATION_S, 0.005);
        let rows = Self::check_rows(table, duration_s, output_step_s);
        let relative_tolerance = table.or("relative_tolerance", &RELATIVE_TOLERANCE, 1e-9);
        let rest_energy_ratio = table.or("rest_energy_ratio", &REST_ENERGY_RATIO, 1e-8);
        let gravity_m_s2 = table.or("gravity_m_s2", &GRAVITY_M_S2, 9.81);
        rows?;
        Ok(Self {
            duration_s: duration_s?,
            output_step_s: output_step_s?,
            relative_tolerance: relative_tolerance?,
            rest_energy_ratio: rest_energy_ratio?,
            gravity_m_s2: gravity_m_s2?,
        })
    }

    /// Checks that the output has a row, and not more than a disk would like.
    fn check_rows(
        table: &mut Table<'_>,
        duration_s: Reading<f64>,
        output_step_s: Reading<f64>,
    ) -> Reading<()> {
        let (duration_s, step_s) = (duration_s?, output_step_s?);
        let rows = duration_s / step_s;
        let wrong = if rows < 1.0 {
            format!(
                "makes the output step of {step_s:?} s longer than the run of {duration_s:?} s; \
                 allowed is a step of at most the run"
            )
        } else if rows > MOST_ROWS {
            format!(
                "makes {rows:.0} rows of output, every {step_s:?} s for {duration_s:?} s; allowed \
                 are at most {MOST_ROWS:.0}"
            )
        } else {
            return Ok(());
        };
        // The defaults agree, so one of the two is given; the step is the one that is easily
        // changed.
        let culprit = if table.gives("output_step_s") {
            "output_step_s"
        } else {
            "duration_s"
        };
        Err(table.wrong(culprit, wrong))
    }

    fn write(&self, out: &mut Writer) {
        let Self {
            duration_s,
            output_step_s,
            relative_tolerance,
            rest_energy_ratio,
            gravity_m_s2,
        } = *self;
        out.table("simulation");
        out.number("duration_s", duration_s);
        out.number("output_step_s", output_step_s);
        out.number("relative_tolerance", relative_tolerance);
        out.number("rest_energy_ratio", rest_energy_ratio);
        out.number("gravity_m_s2", gravity_m_s2);
    }
}
