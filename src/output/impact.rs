//! Results of `impact`: the chain, its impulses and their certificate as JSON, the impulse line as CSV.
//!
//! Impulses are per metre of depth, for a closing rate of 1 rad/s of the mechanism before.

use std::io::Write;

use serde_json::{Value, json};

use super::OutputError;
use super::mechanisms::hinges;
use crate::dynamics::model::MechanismModel;
use crate::mechanics::chain::Hinge;
use crate::mechanics::four_link::arch::FourLinkArch;
use crate::mechanics::four_link::certificate::Projection;
use crate::mechanics::four_link::chain::ArchLink;
use crate::mechanics::four_link::impact::{Impact, ImpactModel};
use crate::mechanics::four_link::impulse_line::ImpulseLine;
use crate::mechanics::four_link::mechanism::{FourLink, HingeSites};
use crate::mechanics::sway::Sway;

/// The sway of a link of the chain that begins with a sway to the right.
#[must_use]
pub const fn sway(link: usize) -> Sway {
    if link.is_multiple_of(2) {
        Sway::Right
    } else {
        Sway::Left
    }
}

/// Result of `impact` for any structure: the first `count` links of the chain that begins with a sway to
/// this side; fewer when an impact stops the structure.
#[must_use]
pub fn chain(model: &dyn MechanismModel, first: Sway, count: usize) -> Vec<Value> {
    let side = |index: usize| {
        let sway = first.before(index);
        json!({ "sway": sway.name(), "hinges": hinges(&model.hinges_after(index, sway)) })
    };
    (1..=count)
        .map_while(|index| Some((index, model.restitution_from(first, index)?)))
        .map(|(index, restitution)| {
            json!({
                "index": index,
                "restitution": restitution,
                "before": side(index - 1),
                "after": side(index),
            })
        })
        .collect()
}

/// The same for an arch, with the impulses and the extremes of the impulse line.
#[must_use]
pub fn impacts(arch: &FourLinkArch, count: usize) -> Value {
    let mut impacts = chain(arch, Sway::Right, count);
    for (index, impact) in (1..).zip(&mut impacts) {
        let line = arch
            .chain()
            .link(index)
            .and_then(|link| link.impulse_line.as_ref());
        impact["impulses"] = line.map(|line| impulses(arch, line, sway(index))).into();
        impact["impulse_line"] = line.map(|line| extremes(arch, line, sway(index))).into();
    }
    impacts.into()
}

fn impulses(arch: &FourLinkArch, line: &ImpulseLine, sway: Sway) -> Value {
    let unit = arch.impulse_unit_n_s_per_m();
    let names = ["a", "b", "c", "d"].into_iter();
    names
        .zip(line.hinge_impulses_from_left(sway))
        .map(|(hinge, impulse)| {
            json!({
                "hinge": hinge,
                "x_n_s_per_m": impulse.x * unit,
                "y_n_s_per_m": impulse.y * unit,
            })
        })
        .collect()
}

/// Extremes of the line; values that are infinite, because there is tension, become null.
fn extremes(arch: &FourLinkArch, line: &ImpulseLine, sway: Sway) -> Value {
    let extremes = line.extremes_from_left(arch.chain().sites(), sway);
    json!({
        "admissible": extremes.is_admissible(),
        "largest_eccentricity_ratio": extremes.eccentricity_ratio.value,
        "largest_eccentricity_angle_deg": extremes.eccentricity_ratio.angle_rad.to_degrees(),
        "least_normal_n_s_per_m": extremes.normal.value * arch.impulse_unit_n_s_per_m(),
        "least_normal_angle_deg": extremes.normal.angle_rad.to_degrees(),
        "largest_tangential_ratio": extremes.friction_ratio.value,
        "largest_tangential_angle_deg": extremes.friction_ratio.angle_rad.to_degrees(),
    })
}

fn sections(arch: &FourLinkArch, impact: &Impact, sway: Sway) -> [Hinge; 4] {
    let hinges = impact.mechanism.hinges_from_left(arch.chain().ring(), sway);
    hinges.map(|(angle_rad, edge)| Hinge::Section { angle_rad, edge })
}

/// Comparison of the impact models, for the impact that leads to link `index`; null where by a model no
/// mechanism can follow.
#[must_use]
pub fn models(
    arch: &FourLinkArch,
    index: usize,
    models: &[(ImpactModel, Option<Impact>)],
) -> Value {
    let after = |impact: &Impact| {
        let sway = sway(index);
        json!({
            "restitution": impact.restitution,
            "after": { "sway": sway.name(), "hinges": hinges(&sections(arch, impact, sway)) },
            "impulses": impact.impulse_line.as_ref().map(|line| impulses(arch, line, sway)),
            "impulse_line": impact.impulse_line.as_ref().map(|line| extremes(arch, line, sway)),
        })
    };
    models
        .iter()
        .map(|(model, impact)| json!({ "model": model.name(), "impact": impact.as_ref().map(after) }))
        .collect()
}

/// The projection onto all admissible fields beside the link that the chain takes, if any mechanism can follow.
#[must_use]
pub fn certificate(
    arch: &FourLinkArch,
    index: usize,
    link: Option<&ArchLink>,
    projection: &Projection,
) -> Value {
    let sway = sway(index);
    let ring = arch.chain().ring();
    let mut opened: Vec<Value> = projection
        .opened()
        .map(|(joint, edge, rate)| {
            json!({
                "angle_deg": sway.from_left(ring, projection.joints[joint].angle_rad).to_degrees(),
                "edge": edge.name(),
                "opening_rate_ratio": rate,
            })
        })
        .collect();
    if sway == Sway::Left {
        opened.reverse();
    }
    let four_link = link.map_or(0.0, |link| link.link.restitution);
    let line = link.and_then(|link| link.impulse_line.as_ref());
    let admissible = line.map(|line| {
        line.extremes_from_left(arch.chain().sites(), sway)
            .is_admissible()
    });
    json!({
        "index": index,
        "joints": projection.joints.len(),
        "restitution_four_link": four_link,
        "restitution_all_fields": projection.restitution,
        "gap": projection.restitution - four_link,
        "impulse_line_admissible": admissible,
        "opened_joints": opened,
    })
}

/// Smallest number of parts of the ring between the rows of an impulse line.
const LINE_PARTS: usize = 720;

/// Writes the impulse line of the impact that leads to link `index` as CSV: a row at each section of a fine
/// division of the ring, every joint of voussoirs and every hinge, from the left springing.
///
/// The eccentricity is left empty where no impulse crosses a section.
///
/// # Errors
/// When the system refuses.
pub fn write_line(
    writer: impl Write,
    arch: &FourLinkArch,
    index: usize,
    mechanism: &FourLink,
    line: &ImpulseLine,
) -> Result<(), OutputError> {
    const WHAT: &str = "cannot write the impulse line";
    let mut csv = csv::Writer::from_writer(writer);
    csv.write_record([
        "angle_deg",
        "eccentricity_ratio",
        "normal_n_s_per_m",
        "tangential_n_s_per_m",
    ])
    .map_err(OutputError::csv(WHAT))?;
    let (unit, ring, sway) = (
        arch.impulse_unit_n_s_per_m(),
        arch.chain().ring(),
        sway(index),
    );
    let mut angles_rad = ring.sections(match arch.chain().sites() {
        HingeSites::Anywhere => LINE_PARTS,
        HingeSites::Voussoirs(count) => LINE_PARTS.next_multiple_of(count),
    });
    angles_rad.extend(
        mechanism
            .hinges_from_left(ring, sway)
            .map(|(angle_rad, _)| angle_rad),
    );
    angles_rad.sort_by(f64::total_cmp);
    angles_rad.dedup_by(|a, b| (*a - *b).abs() < 1e-12);
    for angle_rad in angles_rad {
        let section = line.section_from_left(angle_rad, sway);
        let eccentricity_ratio = section.eccentricity_ratio;
        csv.serialize((
            angle_rad.to_degrees(),
            eccentricity_ratio.is_finite().then_some(eccentricity_ratio),
            section.normal * unit,
            section.tangential * unit,
        ))
        .map_err(OutputError::csv(WHAT))?;
    }
    csv.flush().map_err(OutputError::io(WHAT))
}
