//! The overturning map: `[map]`.
//!
//! ```toml
//! [map]
//! duration_s = { from = 0.05, to = 1.0, count = 60 }
//! amplitude_g = { from = 0.15, to = 1.5, count = 80, spacing = "logarithmic" }
//! ```
//!
//! Two quantities of the scenario vary. The strength of a record varies as `scale` or `peak_g`. A number of another table is named by table and
//! key: `"column.width_m" = [0.6, 0.8]`. With free hinges, `repeat = true` repeats every cell with half and with double steps, to check whether
//! its outcome depends on the steps.

use super::ground::{AMPLITUDE_G, DURATION_S, FREQUENCY_HZ, Ground, PulseGround, RECORD};
use super::impact::RESTITUTION;
use super::model_kind::ModelKind;
use super::models::MotionModel;
use super::prelude::*;
use super::record::{PEAK_G, SCALE};
use super::sequence::Sequence;
use super::simulation::Simulation;
use super::structure::Structure;
use super::variant::parts;

named! {
    /// A quantity that varies over a map, named by its key in `[map]`. The quantity that comes first in this list is on the x axis.
    pub enum Quantity {
        /// A number of another table of the scenario, named by its table and key.
        Other = "table.key",
        /// Duration of the pulse.
        Duration = "duration_s",
        /// Frequency of the pulse, the reciprocal of its duration.
        Frequency = "frequency_hz",
        /// Peak velocity over peak acceleration of the pulse, which gives its duration.
        VelocityRatio = "pgv_over_pga_s",
        /// Mean radius of the arch; the thickness ratio is constant.
        MeanRadius = "mean_radius_m",
        /// Thickness over mean radius.
        ThicknessRatio = "thickness_ratio",
        /// Embrace angle.
        Embrace = "embrace_deg",
        /// Restitution coefficient, with the model `prescribed`.
        Restitution = "restitution",
        /// Peak acceleration of the pulse.
        Amplitude = "amplitude_g",
        /// Factor on the horizontal record, or on the only record.
        Scale = "scale",
        /// Horizontal peak acceleration to which the record is scaled.
        PeakG = "peak_g",
    }
}

impl Quantity {
    /// True for quantities that give the duration of a pulse.
    pub(crate) const fn gives_duration(self) -> bool {
        matches!(self, Self::Duration | Self::Frequency | Self::VelocityRatio)
    }

    /// Duration that a value of this quantity gives a pulse, in s; `None` for other quantities.
    pub(crate) fn duration_s(self, value: f64, pulse: &PulseGround) -> Option<f64> {
        match self {
            Self::Duration => Some(value),
            Self::Frequency => Some(1.0 / value),
            Self::VelocityRatio => {
                let ratio = pulse.shape().velocity_ratio();
                Some(value / ratio.expect("the pulse of a scenario has numbers in their ranges"))
            }
            _ => None,
        }
    }

    /// Range of the same key in its own table.
    const fn range(self) -> &'static Number {
        match self {
            Self::Duration => &DURATION_S,
            Self::Frequency => &FREQUENCY_HZ,
            Self::VelocityRatio => &DURATION_S,
            Self::MeanRadius => &MAGNITUDE,
            Self::ThicknessRatio => &THICKNESS_RATIO,
            Self::Embrace => &EMBRACE_DEG,
            Self::Restitution => &RESTITUTION,
            Self::Amplitude => &AMPLITUDE_G,
            Self::Scale => &SCALE,
            Self::PeakG => &PEAK_G,
            // The other table checks its own key.
            Self::Other => &ANY_NUMBER,
        }
    }
}

/// An axis of a map.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The quantity that varies.
    pub quantity: Quantity,
    /// Key in `[map]`; `table.key` for a number of another table.
    pub key: String,
    /// Values of the quantity.
    pub sequence: Sequence,
}

impl Axis {
    /// Key of the scenario that the axis sets; for the values of a duration see [`Quantity::duration_s`].
    pub(crate) fn path(&self, ground: Option<&Ground>) -> String {
        let of_ground = |key: &str| {
            let kind = ground.map_or(RECORD, Ground::kind);
            format!("ground.{kind}.{key}")
        };
        match self.quantity {
            Quantity::Other => self.key.clone(),
            Quantity::Duration | Quantity::Frequency | Quantity::VelocityRatio => {
                of_ground(DURATION)
            }
            Quantity::Amplitude | Quantity::Scale | Quantity::PeakG => of_ground(&self.key),
            Quantity::MeanRadius | Quantity::ThicknessRatio | Quantity::Embrace => {
                format!("arch.{}", self.key)
            }
            Quantity::Restitution => format!("impact.{}", self.key),
        }
    }

    /// Quantity of the ground motion that the axis sets, also by table and key; otherwise its own.
    pub(crate) fn quantity_under(&self, ground: &Ground) -> Quantity {
        let by_key = Quantity::ALL.iter().copied().find(|quantity| {
            let axis = Self {
                quantity: *quantity,
                key: quantity.name().to_owned(),
                sequence: self.sequence.clone(),
            };
            let is_of_ground = match ground {
                Ground::Pulse(_) => matches!(quantity, Quantity::Duration | Quantity::Amplitude),
                Ground::Record(_) => matches!(quantity, Quantity::Scale | Quantity::PeakG),
            };
            is_of_ground && parts(&axis.path(Some(ground))) == parts(&self.key)
        });
        let is_allowed = |quantity: &Quantity| {
            let values = self.sequence.values();
            values.iter().all(|value| quantity.range().contains(*value))
        };
        by_key.filter(is_allowed).unwrap_or(self.quantity)
    }
}

/// The cells of a map.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis; it is the amplitude if the amplitude varies.
    pub y: Axis,
    /// True to repeat every cell with half and with double steps; with free hinges only.
    pub repeat: bool,
}

/// Largest number of cells: limited by pictures and by memory.
const MAX_CELLS: usize = 1_000_000;

impl Map {
    /// Reads `[map]`, and checks it against the valid tables of the scenario. [`Map::check`] checks the axes against the ground: a map of pulses
    /// may be in a scenario whose record other commands use.
    pub(super) fn read(
        table: &mut Table<'_>,
        structure: Option<&Structure>,
        (kind, motion): (&ModelKind, Option<&MotionModel>),
    ) -> ReadResult<Self> {
        let repeat = table.or(REPEAT, &switch(), false);
        let wrong = "goes with a table [free_hinges] or [elastic_joints]: four links are integrated to a tolerance, not in steps";
        let _ = table.refuse(repeat && !kind.is_repeated, REPEAT, wrong);
        let is_no_ring = structure.is_some_and(|structure| structure.circular_arch().is_none());
        let is_found = motion.is_some_and(|motion| !motion.impact().model.is_prescribed());
        // Message about a quantity that the scenario does not have.
        let unsuited = |quantity| match quantity {
            Quantity::MeanRadius | Quantity::ThicknessRatio | Quantity::Embrace if is_no_ring => {
                Some("applies to a circular [arch] without piers and loads")
            }
            Quantity::Restitution if !kind.has_mechanism => Some(
                "goes with four links: with free hinges impacts follow from the blocks, and elastic joints have none",
            ),
            Quantity::Restitution if is_found => Some("needs model = \"prescribed\" in [impact]"),
            _ => None,
        };
        let mut axes = Vec::new();
        let others = table
            .keys_of_other_tables()
            .into_iter()
            .map(|key| (Quantity::Other, key));
        let own = Quantity::ALL
            .iter()
            .skip(1)
            .map(|quantity| (*quantity, quantity.name().to_owned()));
        for (quantity, key) in own.chain(others) {
            if let Some(sequence) = Sequence::read(table, &key, quantity.range()) {
                if let Some(wrong) = unsuited(quantity) {
                    table.reject(&key, wrong);
                }
                axes.push(Axis {
                    quantity,
                    key,
                    sequence,
                });
            }
        }
        table.check_faultless()?;
        // Numbers of other tables are on the x axis.
        axes.sort_by_key(|axis| axis.quantity != Quantity::Other);
        let mut axes = axes.into_iter();
        let (Some(x), Some(y), None) = (axes.next(), axes.next(), axes.next()) else {
            let keys: Vec<_> = Quantity::ALL.iter().skip(1).map(|one| one.name()).collect();
            return Err(table.fault_of_table(format!(
                "needs exactly two of the keys {}, or of other tables, such as \"arch.depth_m\"",
                keys.join(", ")
            )));
        };
        if x.quantity.gives_duration() && y.quantity.gives_duration() {
            let wrong = format!(
                "cannot be combined with `{}`: both give the duration of the pulse",
                x.key
            );
            table.refuse(true, &y.key, &wrong)?;
        }
        let of_shape = y.quantity == Quantity::VelocityRatio && x.key.starts_with("ground.");
        table.refuse(of_shape, &y.key, "goes with `amplitude_g` or a key of another table than [ground], which may change the shape of the pulse")?;
        let cells = x.sequence.values().len() * y.sequence.values().len();
        let wrong = format!("has {cells} cells; at most {MAX_CELLS} are allowed");
        table.refuse_all(cells > MAX_CELLS, wrong)?;
        Ok(Self { x, y, repeat })
    }

    /// Checks that the axes fit the ground, and that every ground motion ends within the simulation.
    ///
    /// # Errors
    /// The change that the scenario needs.
    pub(crate) fn check(
        &self,
        ground: Option<&Ground>,
        simulation: &Simulation,
    ) -> Result<(), String> {
        let missing = "[map] needs a ground motion: give a table [ground.<kind>], such as [ground.rectangular], or [ground.record]";
        let ground = ground.ok_or(missing)?;
        use Quantity::{Amplitude, PeakG, Scale};
        let axes = [&self.x, &self.y];
        for axis in axes {
            let wrong = match (axis.quantity, ground) {
                (Scale | PeakG, Ground::Pulse(_)) => {
                    "goes with a record, and [ground] has a pulse: the axis of its strength is `amplitude_g`"
                }
                (quantity, Ground::Record(_))
                    if quantity.gives_duration() || quantity == Amplitude =>
                {
                    "goes with a pulse, and [ground] has a record: the axes of its strength are `scale` and `peak_g`"
                }
                _ => continue,
            };
            return Err(format!("`{}` in [map] {wrong}", axis.key));
        }
        let (what, end_s) = match ground {
            Ground::Record(record) => ("a record that lasts", record.end_s()),
            Ground::Pulse(pulse) => {
                let durations_s = axes.into_iter().flat_map(|axis| {
                    let values = axis.sequence.values();
                    let ends = [values.first(), values.last()].into_iter().flatten();
                    let given_s = ends.map(|value| axis.quantity.duration_s(*value, pulse));
                    given_s.flatten().collect::<Vec<_>>()
                });
                let mut durations_s: Vec<f64> = durations_s.collect();
                durations_s.sort_by(f64::total_cmp);
                for duration_s in &durations_s {
                    ensure(DURATION_S.contains(*duration_s), || {
                        let allowed = DURATION_S.allowed();
                        let duration = plain(*duration_s);
                        format!(
                            "[map] has a pulse whose duration is {duration} s; must be {allowed}"
                        )
                    })?;
                }
                let longest = PulseGround {
                    duration_s: durations_s.last().copied().unwrap_or(pulse.duration_s),
                    ..pulse.clone()
                };
                ("pulses that last", longest.ground_motion(1.0).end_s())
            }
        };
        let duration_s = simulation.duration_s.unwrap_or(f64::INFINITY);
        ensure(end_s <= duration_s, || {
            let [last, end] = [end_s, duration_s].map(plain);
            format!(
                "[map] has {what} until {last} s and would be cut off at {end} s; give a longer `duration_s` in [simulation]"
            )
        })
    }
}

impl Serialize for Map {
    /// Writes the two sequences, named by their quantities, and `repeat` if it is true.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let axes = [&self.x, &self.y].map(|axis| (&*axis.key, json!(axis.sequence)));
        let repeat = self.repeat.then(|| (REPEAT, json!(true)));
        serializer.collect_map(axes.into_iter().chain(repeat))
    }
}

const REPEAT: &str = "repeat";
/// Key of the duration of a pulse.
const DURATION: &str = "duration_s";
