//! What stands on the ground: `[arch]` or `[column]`.

use std::ops::Bound::{Excluded, Included, Unbounded};

use serde::Serialize;

use super::table::{Count, Number, Reading, Table};
use crate::dynamics::model::MechanismModel;
use crate::mechanics::arch;
use crate::mechanics::column::{self, RockingColumn};
use crate::mechanics::four_link::arch::{FourLinkArch, FourLinkError};
use crate::mechanics::four_link::impact::ImpactModel;
use crate::mechanics::four_link::limit::{Incipient, LimitError, incipient, least_thickness_ratio};
use crate::mechanics::four_link::linkage::Linkage;
use crate::mechanics::four_link::mechanism::HingeSites;
use crate::mechanics::geometry::ring::Ring;

/// Lengths and densities: so wide that only slips of the pen are outside, and so that
/// no product of them leaves the range of an `f64`.
pub(super) const MAGNITUDE: Number = Number(Included(1e-3), Included(1e6));
const DEPTH_M: f64 = 1.0;
const DENSITY_KG_M3: f64 = 2000.0;
/// A structure as thick as its diameter has no hole. Much thinner ones than a millionth are lost in rounding.
pub(super) const THICKNESS_RATIO: Number = Number(Included(MIN_THICKNESS_RATIO), Excluded(2.0));
const MIN_THICKNESS_RATIO: f64 = 1e-6;
const POSITIVE: Number = Number(Excluded(0.0), Unbounded);
/// Below one degree every ring but the thinnest has room for a straight line, and no push moves it.
pub(super) const EMBRACE_DEG: Number = Number(Included(1.0), Included(180.0));
const VOUSSOIRS: Count = Count {
    range: 3..=200,
    why: "four hinges need four joints",
};

/// What stands on the ground.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Structure {
    /// A circular arch, from `[arch]`.
    Arch(Arch),
    /// A free-standing column, from `[column]`.
    Column(Column),
}

impl Structure {
    /// Reads `[arch]` or `[column]`.
    pub(super) fn read(table: &mut Table<'_>) -> Reading<Self> {
        let arch = table.table("arch", |table| Arch::read(table).map(Self::Arch));
        let column = table.table("column", |table| Column::read(table).map(Self::Column));
        table.exactly_one("tables", vec![("arch", arch), ("column", column)])
    }

    /// The model of its motion.
    ///
    /// # Errors
    /// When it does not rock as four links.
    pub fn model(&self, impact: ImpactModel) -> Result<Box<dyn MechanismModel>, FourLinkError> {
        Ok(match self {
            Self::Arch(arch) => Box::new(arch.build(impact)?),
            Self::Column(column) => Box::new(column.build(impact)?),
        })
    }

    /// `q` at the limit position of the mechanism that starts, for a structure that stands.
    pub(super) fn limit_rad(&self) -> f64 {
        match self {
            Self::Arch(arch) => arch.incipient().map_or(0.0, |incipient| {
                Linkage::new(&arch.ring(), &incipient.mechanism).limit_rad()
            }),
            Self::Column(_) => self
                .model(ImpactModel::MaxRestitution)
                .map_or(0.0, |model| model.limit_rad()),
        }
    }
}

/// A circular arch of constant thickness.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Arch {
    /// Radius of the middle line, in 0.001 to 1e6.
    pub mean_radius_m: f64,
    /// Thickness over mean radius, at least 1e-6 and below 2. The file may give `thickness_m` instead.
    pub thickness_ratio: f64,
    /// Angle from springing to springing, in 1 to 180.
    pub embrace_deg: f64,
    /// Length out of plane, in 0.001 to 1e6.
    pub depth_m: f64,
    /// Density, in 0.001 to 1e6.
    pub density_kg_m3: f64,
    /// Number of equal voussoirs whose joints are the only places of hinges, 3 to 200; `None`:
    /// hinges open anywhere. Two voussoirs have three joints, and a mechanism has four hinges.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub voussoirs: Option<usize>,
}

impl Arch {
    /// The shape.
    fn ring(&self) -> Ring {
        Ring::new(self.thickness_ratio, self.embrace_deg.to_radians())
            .expect("the ranges of the keys are those of a ring")
    }

    /// Where hinges may form.
    #[must_use]
    pub fn sites(&self) -> HingeSites {
        self.voussoirs
            .map_or(HingeSites::Anywhere, HingeSites::Voussoirs)
    }

    fn incipient(&self) -> Result<Incipient, LimitError> {
        incipient(&self.ring(), self.sites())
    }

    /// The arch, ready to rock.
    ///
    /// # Errors
    /// When it cannot stand or no four-link mechanism governs; never for an arch that was read from a
    /// file, where this is checked.
    pub fn build(&self, model: ImpactModel) -> Result<FourLinkArch, FourLinkError> {
        let mut arch = arch::Arch::new(self.mean_radius_m, self.thickness_ratio, self.embrace_deg)?
            .with_depth_m(self.depth_m)?
            .with_density_kg_m3(self.density_kg_m3)?;
        if let Some(voussoirs) = self.voussoirs {
            arch = arch.with_voussoirs(voussoirs)?;
        }
        FourLinkArch::new(arch, model)
    }

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
                "is out of range: {ratio:?} mean radii; allowed is a number of at least {:?} and below \
                 {:?}, a millionth of the mean radius and twice the mean radius",
                MIN_THICKNESS_RATIO * mean_radius_m,
                2.0 * mean_radius_m
            );
            Err(table.wrong("thickness_m", wrong))
        }
    }
}

/// The next larger number of four significant digits: a bound that is said is then one that holds.
fn rounded_up(x: f64) -> f64 {
    let unit = 10.0_f64.powf(3.0 - x.log10().floor());
    (x * unit).ceil() / unit
}

/// A free-standing column: a rectangular block on rigid ground, which does not slide.
///
/// It may have any proportions. A column wider than `sqrt(2)` times its height stops at its first impact;
/// and one that starts to rock from rest needs a friction coefficient of its width over its height.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Column {
    /// Height, in 0.001 to 1e6.
    pub height_m: f64,
    /// Width in the plane of the motion, in 0.001 to 1e6.
    pub width_m: f64,
    /// Length out of plane, in 0.001 to 1e6.
    pub depth_m: f64,
    /// Density, in 0.001 to 1e6.
    pub density_kg_m3: f64,
}

impl Column {
    /// The column, ready to rock.
    ///
    /// # Errors
    /// When a size is out of range; never for a column that was read from a file.
    pub fn build(&self, model: ImpactModel) -> Result<RockingColumn, FourLinkError> {
        let column = column::Column::new(self.height_m, self.width_m)?
            .with_depth_m(self.depth_m)?
            .with_density_kg_m3(self.density_kg_m3)?;
        Ok(RockingColumn::new(&column, model)?)
    }

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
}
