//! What happens when hinges close: `[impact]`.

use std::ops::Bound::Included;

use serde_json::{Value, json};

use super::table::{Number, OneOf, Reading, Table};
use crate::mechanics::four_link::impact::{ImpactLaw, ImpactModel};

/// From no rebound to far above the measured 0.67 to 0.97 times the theory.
const RESTITUTION_FACTOR: Number = Number(Included(0.0), Included(100.0));
pub(super) const RESTITUTION: Number = Number(Included(0.0), Included(1.0));

/// Reads `[impact]`.
pub(super) fn read(table: &mut Table<'_>) -> Reading<ImpactLaw> {
    let factor = table.or("restitution_factor", &RESTITUTION_FACTOR, 1.0);
    let model = read_model(table);
    Ok(ImpactLaw {
        model: model?,
        restitution_factor: factor?,
    })
}

fn read_model(table: &mut Table<'_>) -> Reading<ImpactModel> {
    // Only the names matter here; the restitution is filled in below.
    let all = [
        ImpactModel::MaxRestitution,
        ImpactModel::SameSections,
        ImpactModel::Mirrored,
        ImpactModel::Prescribed { restitution: 0.0 },
    ];
    let names = OneOf {
        all: &all,
        name: |model| model.name(),
    };
    let model = table.or("model", &names, ImpactModel::MaxRestitution);
    let restitution = table.optional("restitution", &RESTITUTION);
    match (model?, restitution?) {
        (ImpactModel::Prescribed { .. }, Some(restitution)) => {
            Ok(ImpactModel::Prescribed { restitution })
        }
        (ImpactModel::Prescribed { .. }, None) => Ok(ImpactModel::Prescribed {
            restitution: table.required("restitution", &RESTITUTION)?,
        }),
        (model, None) => Ok(model),
        (model, Some(_)) => {
            let wrong = format!(
                "applies to model = \"prescribed\" only; the model here is {:?}",
                model.name()
            );
            Err(table.wrong("restitution", wrong))
        }
    }
}

/// Writes `[impact]`.
pub(super) fn to_json(law: &ImpactLaw) -> Value {
    let mut table = json!({ "model": law.model.name() });
    if let ImpactModel::Prescribed { restitution } = law.model {
        table["restitution"] = json!(restitution);
    }
    if !law.is_theory() {
        table["restitution_factor"] = json!(law.restitution_factor);
    }
    table
}
