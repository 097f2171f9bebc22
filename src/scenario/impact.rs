//! The impact law of four links: `[impact]`.

use std::sync::Arc;

use super::model_kind::{AnyModel, ModelKind, ModelOptions, Site};
use super::prelude::*;
use super::structure::Structure;
use crate::{ImpactLaw, ImpactModel};

/// One mechanism of one degree of freedom at a time: four links, or Housner's column.
pub static FOUR_LINKS: ModelKind = ModelKind {
    option: "four",
    name: "four_links",
    table: "impact",
    label: "four links",
    assumptions: "four links: one mechanism with four hinges at a time, of a column one rigid block; at an impact all hinges close at once; joints do not slip. A tolerance sets the steps. Hinges at other places are neglected",
    has_joints: false,
    has_mechanism: true,
    is_repeated: false,
    has_stiffness: false,
    has_lanes: false,
    ignored: None,
    lacking: None,
    read: |table| Ok(Arc::new(read(table)?)),
};

pub(super) const RESTITUTION: Number = within(&(0.0..=1.0));

/// Reads `[impact]`.
fn read(table: &mut Table<'_>) -> ReadResult<ImpactLaw> {
    let names: Vec<_> = ImpactModel::ALL.iter().map(|model| model.name()).collect();
    let name = table.or("model", &one_of(&names), names[0]);
    let restitution = table.optional("restitution", &RESTITUTION);
    // The upper bound is far above measured values.
    let restitution_factor = table.or("restitution_factor", &within(&(0.0..=100.0)), 1.0);
    let index = names.iter().position(|one| *one == name);
    let mut model = ImpactModel::ALL[index.unwrap_or(0)];
    if let ImpactModel::Prescribed { restitution: given } = &mut model {
        *given = table.needed("restitution", &RESTITUTION, restitution);
    } else if restitution.is_some() {
        let wrong = format!("applies to model = \"prescribed\" only; the model here is {name:?}");
        return Err(table.reject("restitution", wrong));
    }
    Ok(ImpactLaw {
        model,
        restitution_factor,
    })
}

impl ModelOptions for ImpactLaw {
    fn to_json(&self) -> Value {
        let mut table = json!({ "model": self.model.name() });
        if let ImpactModel::Prescribed { restitution } = self.model {
            table["restitution"] = json!(restitution);
        }
        if !self.is_theory() {
            table["restitution_factor"] = json!(self.restitution_factor);
        }
        table
    }

    fn model(&self, structure: &Structure, _: &Site) -> AnyModel {
        Ok(structure.model(*self)?)
    }

    /// Rejects an impact law beside the ratio of rates of a wall behind a column. If the wall needs one of them, only the model of motion does.
    fn check(
        &self,
        table: &mut Table<'_>,
        structure: &Structure,
        _: &Site,
        _: Option<f64>,
    ) -> ReadResult<()> {
        let Some(column) = structure.column() else {
            return Ok(());
        };
        let is_given = (column.wall()).is_some_and(|(wall, _)| wall.rate_ratio.is_some());
        let is_own = self.is_theory() && !self.model.is_prescribed();
        let wrong = "changes the ratio of energies of the impact on the wall, and `restitution` of [column.back], a ratio of rates, gives it as well; \
                     leave one out";
        ensure(!is_given || is_own, || {
            let key = match self.is_theory() {
                true => "restitution",
                false => "restitution_factor",
            };
            table.reject_in(&["impact"], key, wrong)
        })
    }

    fn law(&self) -> Option<ImpactLaw> {
        Some(*self)
    }
}
