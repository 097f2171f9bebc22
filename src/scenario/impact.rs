//! The impact law of four links: `[impact]`.

use super::prelude::*;
use crate::{ImpactLaw, ImpactModel};

pub(super) const RESTITUTION: Number = within(&(0.0..=1.0));
const MODELS: [ImpactModel; 4] = [
    ImpactModel::MaxRestitution,
    ImpactModel::SameSections,
    ImpactModel::Mirrored,
    ImpactModel::Prescribed { restitution: 0.0 },
];
/// Reads `[impact]`.
pub(super) fn read(table: &mut Table<'_>) -> ReadResult<ImpactLaw> {
    let names = MODELS.map(|model| model.name());
    let name = table.or("model", &one_of(&names), names[0]);
    let restitution = table.optional("restitution", &RESTITUTION);
    // Upper bound far above measured values, which are 0.67 to 0.97 times the theory.
    let restitution_factor = table.or("restitution_factor", &within(&(0.0..=100.0)), 1.0);
    let index = names.iter().position(|one| *one == name);
    let mut model = MODELS[index.unwrap_or(0)];
    if let ImpactModel::Prescribed { .. } = model {
        let restitution = table.needed("restitution", &RESTITUTION, restitution);
        model = ImpactModel::Prescribed { restitution };
    } else if restitution.is_some() {
        let wrong = format!("applies to model = \"prescribed\" only; the model here is {name:?}");
        return Err(table.wrong("restitution", wrong));
    }
    Ok(ImpactLaw {
        model,
        restitution_factor,
    })
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
