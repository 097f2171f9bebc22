//! Impacts of the structure of a scenario: the chain of mechanisms, and one impact in detail.

mod report;

use self::report::{Certificate, ModelComparison, chain_of_four_links};
pub use self::report::{ImpactSummary, chain};
use super::StudyError;
use super::results::PrintedResult;
use crate::mechanics::Profile;
use crate::mechanics::four_link::{
    ArchLink, Chain, DEFAULT_JOINTS, FourLink, ImpulseLine, Projection, ProjectionError,
    closing_field, impact as impact_by, joints_rad, project,
};
use crate::{FourLinks, ImpactModel, MechanismModel, Scenario, Sway};

/// The impact that leads to a link of the chain of four links, after a first sway to a given side.
#[derive(Clone, Copy, Debug)]
pub struct LinkImpact<'a> {
    /// The model of the structure.
    pub model: &'a FourLinks,
    /// The first sway.
    pub first: Sway,
    /// Number of the impact, from 1, and of the link after the impact.
    pub index: usize,
}

impl<'a> LinkImpact<'a> {
    /// Chain of mechanisms.
    pub fn chain(&self) -> &'a Chain {
        self.model.chain_from(self.first)
    }

    /// Mechanism before the impact; `None` if an earlier impact stops the structure.
    pub fn mechanism_before(&self) -> Option<&'a ArchLink> {
        self.chain().link(self.index.checked_sub(1)?)
    }

    /// Mechanism after the impact; `None` if no mechanism can follow.
    pub fn mechanism_after(&self) -> Option<&'a ArchLink> {
        self.chain().link(self.index)
    }

    /// Impulse line; `None` if no mechanism can follow, or the restitution coefficient is prescribed.
    pub fn line(&self) -> Option<&'a ImpulseLine> {
        self.mechanism_after()?.impulse_line.as_ref()
    }

    /// Words that follow the number of the impact; empty for a first sway to the right.
    pub const fn words_after_number(&self) -> &'static str {
        match self.first {
            Sway::Right => "",
            Sway::Left => " after a first sway to the left",
        }
    }

    /// Side to which the structure sways after the impact.
    pub const fn sway(&self) -> Sway {
        self.first.after(self.index)
    }

    /// Profile in the frame in which the sway after the impact is to the right.
    pub fn profile(&self) -> &'a dyn Profile {
        self.chain().profile(self.index)
    }

    /// Computes this impact by the models that obey the momentum theorems, and by the model of the scenario.
    fn compare_models(&self, before: &FourLink, own: ImpactModel) -> Vec<ModelComparison> {
        let all = ImpactModel::ALL.iter().copied();
        let theories = all.filter(|model| !model.is_prescribed());
        let (profile, sites) = (self.profile(), self.chain().sites);
        let models = theories.chain(Some(own).filter(|own| own.is_prescribed()));
        models
            .map(|model| ModelComparison::of(self, model, impact_by(before, profile, sites, model)))
            .collect()
    }

    /// Computes the largest restitution of all admissible motions.
    fn largest_restitution(
        &self,
        before: &FourLink,
        joints: Option<usize>,
    ) -> Result<Projection, ProjectionError> {
        let (profile, sites) = (self.profile(), self.chain().sites);
        let mechanism = self.mechanism_after().map(|link| &link.mechanism);
        let joints = joints.unwrap_or(DEFAULT_JOINTS);
        let joints_rad = joints_rad(profile, sites, joints, mechanism);
        project(&closing_field(before, profile), profile, &joints_rad)
    }
}

/// A question about the impacts of four links.
#[derive(Clone, Copy, Debug)]
pub struct ImpactOptions {
    /// Number of impacts.
    pub count: usize,
    /// True to compare the impact models.
    pub models: bool,
    /// True to certify the restitution.
    pub certificate: bool,
    /// Number of parts into which a ring without joints is divided for the certificate; `None` for the default.
    pub joints: Option<usize>,
}

/// Computes the chain of mechanisms of a structure after a first sway to this side; `None` chooses right, or the side away from a wall behind a column.
///
/// # Errors
/// When the wall is on this side, or a number is not finite.
pub fn chain_result(
    scenario: &Scenario,
    model: &dyn MechanismModel,
    first: Option<Sway>,
    count: usize,
) -> Result<PrintedResult, StudyError> {
    let first = first.unwrap_or_else(|| model.first_side());
    if scenario.structure.wall_behind() == Some(first) {
        let (wall, away) = (first.name(), first.opposite().name());
        return Err(StudyError::Scenario(format!(
            "the column cannot sway to the {wall}, where a wall stands; leave `--first` out, or choose {away}"
        )));
    }
    let impacts = |side| chain(model, side, count);
    let summary = ImpactSummary::new(scenario, model, (&[first], count), impacts);
    Ok(PrintedResult::of(&summary)?)
}

/// Computes the chain of four links with its impulses, and the requested details of one impact.
///
/// # Errors
/// When no certificate is found, or a number is not finite.
pub fn four_links_result(
    scenario: &Scenario,
    impact: &LinkImpact<'_>,
    options: &ImpactOptions,
) -> Result<PrintedResult, StudyError> {
    let (model, count) = (impact.model, options.count);
    // An arch of equal voussoirs, or without voussoirs, is symmetric: both chains are mirror images.
    let sides = match scenario.structure.is_symmetric() {
        true => &[impact.first][..],
        false => Sway::ALL,
    };
    let impacts = |first| chain_of_four_links(&LinkImpact { first, ..*impact }, count);
    let mut summary = ImpactSummary::new(scenario, model, (sides, count), impacts);
    summary.chosen = Some(format!(
        "impact {}{}",
        impact.index,
        impact.words_after_number()
    ));
    if let Some(before) = impact.mechanism_before().map(|link| &link.mechanism) {
        if options.models {
            summary.models = Some(impact.compare_models(before, scenario.motion.impact().model));
        }
        if options.certificate {
            let projection = impact
                .largest_restitution(before, options.joints)
                .map_err(StudyError::failed)?;
            summary.certificate = Some(Certificate::of(impact, &projection));
        }
    }
    Ok(PrintedResult::of(&summary)?)
}
