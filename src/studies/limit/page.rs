//! Files of limit analysis: the page, the picture and the summary.

use super::{held_mechanisms, summary};
use crate::argument::format_fixed;
use crate::output::elevation::{draw_bent, draw_hinges};
use crate::output::page::{Spot, SpotKind};
use crate::output::{Figure, Scene};
use crate::studies::draw_limit;
use crate::studies::page::{CaseScenario, DrawPicture, Marked, Page, PageCases};
use crate::studies::{Results, StudyError};
use crate::{Scenario, Sway};

/// Names of the files, the seal last.
pub const FILES: [&str; 3] = ["limit.html", "limit.svg", "limit.json"];

const HINGES: &str = "circles: hinges that a push opens, to the right large and orange, to the left small and purple; blue arrow: positive \
                      ground acceleration, which pushes to the left";
const SLOWLY: &str = "the push grows slowly from zero; a short pulse may exceed it without overturning; joints slip only in results with a \
                      coefficient of friction";

/// Computes the onset of motion, and makes its files and words. Four links are drawn with their thrust line, other structures with their hinges.
///
/// # Errors
/// As for [`super::limit`].
pub fn results(scenario: &Scenario, figure: Figure) -> Result<Results, StudyError> {
    let (summary, scene) = (summary(scenario)?, Scene::new(&scenario.structure));
    let bent = held_mechanisms(&scenario.structure)?;
    let title = scenario.title.as_deref().unwrap_or("Limit analysis");
    let (mut hinges_m, mut cases) = (Vec::new(), PageCases::default());
    let text = CaseScenario::unchanged(cases.add_text(&scenario.to_json(), false));
    let case = || Some(text.clone());
    for (sway, hinges) in summary.mechanism.iter() {
        for (index, hinge) in hinges.iter().enumerate() {
            let of_bent = bent.as_ref().map(|bent| bent.get(sway).hinges_m()[index]);
            let at_m = of_bent.unwrap_or_else(|| hinge.position_m(&scene));
            let (words, push) = (hinge.words(&index), sway.name());
            let [x, y] = [at_m.x, at_m.y].map(|at_m| format_fixed(at_m, 5));
            let words = format!("push to the {push}, ({x}, {y}) m: {words}");
            cases.push((SpotKind::Hinge, false), words, case);
            hinges_m.push((sway, at_m));
        }
    }
    if hinges_m.is_empty() {
        // The command remains, without a mark.
        cases.push((SpotKind::Hinge, false), String::new(), case);
        cases.spots.clear();
    }
    let at_rest = |figure, spots: &[Spot]| match &bent {
        Some(bent) => draw_bent(figure, title, &scenario.structure, bent, spots),
        None => draw_hinges(figure, title, (&scene, HINGES), &hinges_m, spots),
    };
    // Four links need the undeformed structure; the words have the reason if there are none.
    let as_built = scenario.motion.supports().is_none();
    let model = scenario
        .structure
        .four_links(scenario.motion.impact())
        .ok()
        .flatten()
        .filter(|_| as_built);
    let rocking = |figure, sway| Some(draw_limit(figure, model.as_ref()?, sway, &scene));
    let picture = rocking(figure, Sway::Right).unwrap_or_else(|| at_rest(figure, &[]));
    let results = Results::of("limit.json", &summary)?.with_file("limit.svg", picture);
    let mut page = Page::new(title, scenario.structure.describe(), &[SLOWLY], &[]);
    page.marked = Marked::Hinges;
    page.command = "limit - --out case".to_owned();
    let draw = |figure| at_rest(figure, &cases.spots);
    let right = |figure| rocking(figure, Sway::Right).unwrap_or_default();
    let left = |figure| rocking(figure, Sway::Left).unwrap_or_default();
    let more: &[DrawPicture<'_>] = match model.is_some() {
        true => &[&right, &left],
        false => &[],
    };
    let results = results.with_page("limit.html", page, &cases, (&draw, more));
    Ok(results.in_order(&FILES))
}
