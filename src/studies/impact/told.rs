//! Reports impacts for programs: the chain, its impulses and their certificate as JSON, the impulse line as CSV.
//!
//! Impulses are per metre of depth, for a closing rate of 1 rad/s of the mechanism before.

use serde_json::{Value, json};

use super::LinkImpact;
use crate::dynamics::model::MechanismModel;
use crate::mechanics::four_link::certificate::Projection;
use crate::mechanics::four_link::impact::{Impact, ImpactModel};
use crate::mechanics::four_link::impulse_line::ImpulseLine;
use crate::mechanics::four_link::mechanism::{FourLink, HingeSites};
use crate::mechanics::four_links::FourLinks;
use crate::mechanics::geometry::profile::Profile;
use crate::mechanics::sway::Sway;
use crate::output::OutputError;
use crate::output::table::{Cell, column, csv};

/// Result of `impact` for any structure: the first `count` links of the chain that begins with a sway to
/// this side; fewer if an impact stops the structure.
#[must_use]
pub fn chain(model: &dyn MechanismModel, first: Sway, count: usize) -> Vec<Value> {
    let side = |index: usize| {
        let sway = first.before(index);
        json!({ "sway": sway.name(), "hinges": model.hinges_after(index, sway) })
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

/// The same for four links, with the impulses and the extremes of the impulse line.
pub(super) fn impacts(model: &FourLinks, first: Sway, count: usize) -> Value {
    let mut impacts = chain(model, first, count);
    for (index, told) in (1..).zip(&mut impacts) {
        let impact = LinkImpact {
            model,
            first,
            index,
        };
        told["impulses"] = impact.line().map(|line| impulses(&impact, line)).into();
        told["impulse_line"] = impact.line().map(|line| extremes(&impact, line)).into();
    }
    impacts.into()
}

fn impulses(impact: &LinkImpact<'_>, line: &ImpulseLine) -> Value {
    let unit = impact.model.impulse_unit_n_s_per_m();
    let names = ["a", "b", "c", "d"].into_iter();
    names
        .zip(line.hinge_impulses_from_left(impact.sway()))
        .map(|(hinge, impulse)| {
            json!({
                "hinge": hinge,
                "x_n_s_per_m": impulse.x * unit,
                "y_n_s_per_m": impulse.y * unit,
            })
        })
        .collect()
}

/// The name and value of a section, counted from the left, in JSON.
fn section(profile: &dyn Profile, section: f64) -> (&'static str, Value) {
    match profile.joint(section) {
        Some(joint) => ("joint", joint.into()),
        None => ("angle_deg", section.to_degrees().into()),
    }
}

/// The same as a cell of a table.
fn section_cell(profile: &dyn Profile, section: f64) -> Cell<'static> {
    match profile.joint(section) {
        Some(joint) => joint.into(),
        None => section.to_degrees().into(),
    }
}

/// Extremes of the line; infinite values, which mean tension, become null.
fn extremes(impact: &LinkImpact<'_>, line: &ImpulseLine) -> Value {
    let extremes = line.extremes_from_left(impact.chain().sites, impact.sway());
    let unit = impact.model.impulse_unit_n_s_per_m();
    let mut told = json!({ "admissible": extremes.is_admissible() });
    for (what, value, extremum, unit) in [
        (
            "largest_eccentricity",
            "largest_eccentricity_ratio",
            extremes.eccentricity_ratio,
            1.0,
        ),
        (
            "least_normal",
            "least_normal_n_s_per_m",
            extremes.normal,
            unit,
        ),
        (
            "largest_tangential",
            "largest_tangential_ratio",
            extremes.friction_ratio,
            1.0,
        ),
    ] {
        told[value] = (extremum.value * unit).into();
        let (called, at) = section(impact.profile(), extremum.angle_rad);
        told[format!("{what}_{called}")] = at;
    }
    told
}

/// Comparison of the impact models; null for a model by which no mechanism can follow.
pub(super) fn models(impact: &LinkImpact<'_>, models: &[(ImpactModel, Option<Impact>)]) -> Value {
    let sway = impact.sway();
    let after = |by_model: &Impact| {
        let mechanism = &by_model.mechanism;
        let line = by_model.impulse_line.as_ref();
        json!({
            "restitution": by_model.restitution,
            "after": {
                "sway": sway.name(),
                "hinges": mechanism.named_hinges_from_left(impact.profile(), sway),
            },
            "impulses": line.map(|line| impulses(impact, line)),
            "impulse_line": line.map(|line| extremes(impact, line)),
        })
    };
    models
        .iter()
        .map(|(model, impact)| json!({ "model": model.name(), "impact": impact.as_ref().map(after) }))
        .collect()
}

/// The projection onto all admissible fields, compared with the link that the chain takes, if any mechanism can follow.
pub(super) fn certificate(impact: &LinkImpact<'_>, projection: &Projection) -> Value {
    let (sway, profile) = (impact.sway(), impact.profile());
    let mut opened: Vec<Value> = projection
        .opened()
        .map(|(joint, edge, rate)| {
            let from_left = sway.from_left(profile, projection.joints[joint].angle_rad);
            let (called, at) = section(profile, from_left);
            json!({
                called: at,
                "edge": edge.name(),
                "opening_rate_ratio": rate,
            })
        })
        .collect();
    if sway == Sway::Left {
        opened.reverse();
    }
    let four_link = impact.after().map_or(0.0, |link| link.link.restitution);
    let admissible = impact.line().map(|line| {
        line.extremes_from_left(impact.chain().sites, sway)
            .is_admissible()
    });
    json!({
        "index": impact.index,
        "joints": projection.joints.len(),
        "restitution_four_link": four_link,
        "restitution_all_fields": projection.restitution,
        "gap": projection.restitution - four_link,
        "impulse_line_admissible": admissible,
        "opened_joints": opened,
    })
}

/// Smallest number of parts of a ring between the rows of an impulse line.
const LINE_PARTS: usize = 720;

/// The impulse line of an impact as CSV, from the left springing. A ring has a row at each section of a fine division, at every
/// joint of voussoirs and at every hinge; a row of blocks has one at every joint. The eccentricity is empty if no impulse crosses the section.
pub(super) fn line_table(
    impact: &LinkImpact<'_>,
    mechanism: &FourLink,
    line: &ImpulseLine,
) -> Result<Vec<u8>, OutputError> {
    let unit = impact.model.impulse_unit_n_s_per_m();
    let (profile, sway) = (impact.profile(), impact.sway());
    let mut sections = profile.sections(match impact.chain().sites {
        HingeSites::Anywhere => LINE_PARTS,
        HingeSites::Voussoirs(count) => LINE_PARTS.next_multiple_of(count),
    });
    let hinges = mechanism.hinges_from_left(profile, sway);
    sections.extend(hinges.map(|(section, _)| section));
    sections.sort_by(f64::total_cmp);
    sections.dedup_by(|a, b| (*a - *b).abs() < 1e-12);
    let at = |section: &f64| line.section_from_left(*section, sway);
    let columns = [
        column(section(profile, 0.0).0, |place: &f64| {
            section_cell(profile, *place)
        }),
        column("eccentricity_ratio", |place| {
            Some(at(place).eccentricity_ratio).filter(|ratio| ratio.is_finite())
        }),
        column("normal_n_s_per_m", |place| at(place).normal * unit),
        column("tangential_n_s_per_m", |place| at(place).tangential * unit),
    ];
    csv(columns, &sections)
}
