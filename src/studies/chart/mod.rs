//! Compares arches of many shapes: onset, first impact, and the limit to which repeated impacts tend.

mod told;

pub use self::told::FILES;
use rayon::iter::{IntoParallelRefIterator as _, ParallelIterator as _};

use crate::mechanics::arch::Arch;
use crate::mechanics::four_link::arch::FourLinkArch;
use crate::mechanics::four_link::impact::ImpactLaw;
use crate::mechanics::four_link::limit::least_thickness_ratio;
use crate::mechanics::four_link::mechanism::HingeSites;

/// Incipient acceleration and restitution of a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeResult {
    /// Embrace angle in degrees.
    pub embrace_deg: f64,
    /// Thickness over mean radius.
    pub thickness_ratio: f64,
    /// Incipient acceleration in g.
    pub incipient_g: f64,
    /// Restitution coefficient of the first impact; `None` if it stops the arch.
    pub first_restitution: Option<f64>,
    /// Restitution coefficient to which the impacts of the chain tend; `None` if one stops the arch.
    pub last_restitution: Option<f64>,
}

/// The chain has settled when an impact raises the restitution coefficient by no more than this. The rises
/// get ever smaller, nearly in geometric progression, so the remaining rise is about ten times as much.
const SETTLED: f64 = 1e-7;

/// Number of impacts after which a chain counts as settled in any case.
const MAX_IMPACTS: usize = 200;

/// Incipient acceleration and restitution coefficients of one shape; `None` if the arch does not start as a
/// four-link mechanism, because it cannot stand or is too thick.
#[must_use]
pub fn shape_result(
    embrace_deg: f64,
    thickness_ratio: f64,
    sites: HingeSites,
    law: impl Into<ImpactLaw>,
) -> Option<ShapeResult> {
    let mut arch = Arch::new(1.0, thickness_ratio, embrace_deg).ok()?;
    if let HingeSites::Voussoirs(voussoirs) = sites {
        arch = arch.with_voussoirs(voussoirs).ok()?;
    }
    let arch = FourLinkArch::new(arch, law).ok()?;
    let chain = arch.chain();
    let restitution = |index: usize| chain.link(index).map(|link| link.link.restitution);
    let mut last = restitution(1);
    for index in 2..MAX_IMPACTS {
        let next = restitution(index);
        let settled = match (last, next) {
            (Some(last), Some(next)) => (next - last).abs() <= SETTLED,
            _ => true,
        };
        last = next;
        if settled {
            break;
        }
    }
    Some(ShapeResult {
        embrace_deg,
        thickness_ratio,
        incipient_g: chain.incipient().acceleration_g,
        first_restitution: restitution(1),
        last_restitution: last,
    })
}

/// The shapes compared with the arch of a scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// One embrace angle after another, each with ascending thicknesses.
    shapes: Vec<ShapeResult>,
    /// The arch itself.
    own: Option<ShapeResult>,
}

/// Embrace angles of the chart, in addition to that of the scenario, in degrees.
const EMBRACES_DEG: [f64; 5] = [180.0, 170.0, 157.5, 140.0, 120.0];

/// Number of thickness ratios of a curve, from the thinnest arch that stands to the thickest of the chart.
const THICKNESSES: u32 = 24;

/// Largest thickness ratio of the chart, unless that of the scenario is larger.
const MAX_THICKNESS_RATIO: f64 = 0.3;

impl Chart {
    /// Computes the shapes to compare with an arch, on all processors.
    #[must_use]
    pub fn of(arch: &Arch, law: ImpactLaw) -> Self {
        let mut embraces_deg = EMBRACES_DEG.to_vec();
        if !embraces_deg.contains(&arch.embrace_deg()) {
            embraces_deg.push(arch.embrace_deg());
            embraces_deg.sort_by(|a, b| b.total_cmp(a));
        }
        let sites = arch.sites();
        let largest = MAX_THICKNESS_RATIO.max(arch.thickness_ratio());
        let shapes: Vec<(f64, f64)> = embraces_deg
            .into_iter()
            .flat_map(|embrace_deg| {
                let least = least_thickness_ratio(embrace_deg.to_radians(), sites, 1e-6).expect(
                    "the embrace angle of an arch is checked, and the others are constants",
                );
                thicknesses(least, largest)
                    .map(move |thickness_ratio| (embrace_deg, thickness_ratio))
            })
            .collect();
        Self {
            shapes: shape_results(&shapes, sites, law),
            own: shape_result(arch.embrace_deg(), arch.thickness_ratio(), sites, law),
        }
    }
}

/// From just above the least thickness ratio at which an arch stands to the largest of the chart.
fn thicknesses(least: f64, largest: f64) -> impl Iterator<Item = f64> {
    let least = 1.001 * least;
    let step = (largest - least) / f64::from(THICKNESSES - 1);
    (0..THICKNESSES).map(move |i| least + f64::from(i) * step)
}

/// The results of shapes, each given by embrace angle in degrees and thickness over mean radius, in their order and
/// on all processors. Shapes that do not start as a four-link mechanism are left out.
fn shape_results(shapes: &[(f64, f64)], sites: HingeSites, law: ImpactLaw) -> Vec<ShapeResult> {
    shapes
        .par_iter()
        .filter_map(|(embrace_deg, thickness_ratio)| {
            shape_result(*embrace_deg, *thickness_ratio, sites, law)
        })
        .collect()
}
