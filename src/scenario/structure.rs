//! What stands on the ground: `[arch]` or `[column]`.

use std::ops::Bound::{Excluded, Included, Unbounded};

use serde::Serialize;

use super::table::{Count, Number, Reading, Table};
use crate::dynamics::model::MechanismModel;
use crate::mechanics::arch::{self, Arch};
use crate::mechanics::column::{Column, RockingColumn};
use crate::mechanics::four_link::arch::{FourLinkArch, FourLinkError};
use crate::mechanics::four_link::impact::ImpactModel;
use crate::mechanics::four_link::limit::{LimitError, least_thickness_ratio};

/// Lengths and densities.
pub(super) const MAGNITUDE: Number = Number(
    Included(*arch::MAGNITUDE.start()),
    Included(*arch::MAGNITUDE.end()),
);
pub(super) const THICKNESS_RATIO: Number = Number(
    Included(arch::MIN_THICKNESS_RATIO),
    Excluded(arch::THICKNESS_RATIO_BOUND),
);
const POSITIVE: Number = Number(Excluded(0.0), Unbounded);
pub(super) const EMBRACE_DEG: Number = Number(
    Included(*arch::EMBRACE_DEG.start()),
    Included(*arch::EMBRACE_DEG.end()),
);
const VOUSSOIRS: Count = Count {
    range: arch::VOUSSOIRS,
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
        let arch = table.table("arch", |table| read_arch(table).map(Self::Arch));
        let column = table.table("column", |table| read_column(table).map(Self::Column));
        table.exactly_one("tables", vec![("arch", arch), ("column", column)])
    }

    /// The model of its motion by mechanisms of one degree of freedom: four links, or Housner's block.
    ///
    /// # Errors
    /// When it does not rock as four links.
    pub fn model(&self, impact: ImpactModel) -> Result<Box<dyn MechanismModel>, FourLinkError> {
        Ok(match self {
            Self::Arch(arch) => Box::new(FourLinkArch::new(arch.clone(), impact)?),
            Self::Column(column) => Box::new(RockingColumn::new(column, impact)?),
        })
    }
}

fn read_arch(table: &mut Table<'_>) -> Reading<Arch> {
    let mean_radius_m = table.required("mean_radius_m", &MAGNITUDE);
    let ratio = table.optional("thickness_ratio", &THICKNESS_RATIO);
    let from_m = read_thickness_m(table, mean_radius_m);
    let thickness_ratio = table.exactly_one(
        "keys",
        vec![("thickness_ratio", ratio), ("thickness_m", from_m)],
    );
    let embrace_deg = table.required("embrace_deg", &EMBRACE_DEG);
    let depth_m = table.or("depth_m", &MAGNITUDE, arch::DEPTH_M);
    let density_kg_m3 = table.or("density_kg_m3", &MAGNITUDE, arch::DENSITY_KG_M3);
    let voussoirs = table.optional("voussoirs", &VOUSSOIRS);
    let (depth_m, density_kg_m3, voussoirs) = (depth_m?, density_kg_m3?, voussoirs?);
    let arch = Arch::new(mean_radius_m?, thickness_ratio?, embrace_deg?)
        .and_then(|arch| arch.with_depth_m(depth_m))
        .and_then(|arch| arch.with_density_kg_m3(density_kg_m3))
        .and_then(|arch| match voussoirs {
            Some(voussoirs) => arch.with_voussoirs(voussoirs),
            None => Ok(arch),
        })
        .expect("the ranges of the keys are those of an arch");
    match arch.incipient() {
        Ok(_) => Ok(arch),
        Err(error) => {
            let key = if table.gives("thickness_m") {
                "thickness_m"
            } else {
                "thickness_ratio"
            };
            Err(table.wrong(key, why_not(&arch, error)))
        }
    }
}

/// What a limit error means for an arch, and what to change.
fn why_not(arch: &Arch, error: LimitError) -> String {
    let embrace_deg = arch.embrace_deg();
    match error {
        LimitError::CannotStand => {
            let least = least_thickness_ratio(embrace_deg.to_radians(), arch.sites(), 1e-12)
                .expect("the ranges of the keys are those of a ring");
            format!(
                "makes an arch that cannot carry its own weight at an embrace angle of {embrace_deg:?} degrees; \
                 allowed is a thickness of at least {:?} mean radii",
                rounded_up(least)
            )
        }
        LimitError::OtherMechanism { .. } | LimitError::NoPush => format!(
            "makes an arch too thick for its embrace angle of {embrace_deg:?} degrees: {error}; allowed is a \
             thinner arch or a larger angle"
        ),
    }
}

/// The thickness ratio, when the thickness is given in metres.
fn read_thickness_m(table: &mut Table<'_>, mean_radius_m: Reading<f64>) -> Reading<Option<f64>> {
    let Some(thickness_m) = table.optional("thickness_m", &POSITIVE)? else {
        return Ok(None);
    };
    let mean_radius_m = mean_radius_m?;
    let ratio = thickness_m / mean_radius_m;
    if THICKNESS_RATIO.contains(ratio) {
        Ok(Some(ratio))
    } else {
        let wrong = format!(
            "is out of range: {ratio:?} mean radii; allowed is a number below {:?}, twice the mean radius, and not \
             below a millionth of the mean radius",
            2.0 * mean_radius_m
        );
        Err(table.wrong("thickness_m", wrong))
    }
}

/// The next larger number of four significant digits: a bound that is said is then one that holds.
fn rounded_up(x: f64) -> f64 {
    let unit = 10.0_f64.powf(3.0 - x.log10().floor());
    (x * unit).ceil() / unit
}

fn read_column(table: &mut Table<'_>) -> Reading<Column> {
    let height_m = table.required("height_m", &MAGNITUDE);
    let width_m = table.required("width_m", &MAGNITUDE);
    let depth_m = table.or("depth_m", &MAGNITUDE, arch::DEPTH_M);
    let density_kg_m3 = table.or("density_kg_m3", &MAGNITUDE, arch::DENSITY_KG_M3);
    let (height_m, width_m, depth_m, density_kg_m3) =
        (height_m?, width_m?, depth_m?, density_kg_m3?);
    let column = Column::new(height_m, width_m)
        .and_then(|column| column.with_depth_m(depth_m))
        .and_then(|column| column.with_density_kg_m3(density_kg_m3));
    Ok(column.expect("the ranges of the keys are within those of a column"))
}
