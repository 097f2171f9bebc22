//! Files of limit analysis: the page, the picture and the summary.

use super::{held_mechanisms, summary};
use crate::argument::format_fixed;
use crate::output::elevation::{draw_bent, draw_hinges};
use crate::output::page::{Spot, SpotKind};
use crate::output::{Figure, Scene};
use crate::studies::draw_limit;
use crate::studies::limit::{LimitSummary, LiveLimit};
use crate::studies::page::{CaseScenario, DrawPicture, Marked, Page, PageCases};
use crate::studies::{Results, StudyError};
use crate::{Scenario, Sway};

/// Names of the files, the seal last.
pub const FILES: [&str; 5] = [
    "limit.html",
    "limit.svg",
    "vehicle.svg",
    "limit.csv",
    "limit.json",
];

const HINGES: &str = "circles: hinges that a push opens, to the right large and orange, to the left small and purple; blue arrow: positive \
                      ground acceleration, which pushes to the left";
const LIVE: &str = "live loads at collapse; circles: joints that open or slip; blue line: thrust line between its points in the joints";
const SLOWLY: &str = "the push grows slowly from zero; a short pulse may exceed it without overturning; joints slip only in results with a \
                      coefficient of friction";

/// Computes the onset of motion, and makes its files and words. Four links are drawn with their thrust line, other structures with their hinges.
///
/// # Errors
/// As for [`super::limit`].
pub fn results(scenario: &Scenario, figure: Figure) -> Result<Results, StudyError> {
    let (summary, scene) = (summary(scenario)?, Scene::new(&scenario.structure));
    if let Some(live) = &summary.live {
        return live_results(scenario, &summary, live, figure);
    }
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
    keep_command(&mut cases, &text);
    let at_rest = |figure, spots: &[Spot]| match &bent {
        Some(bent) => draw_bent(figure, title, &scenario.structure, bent, spots),
        None => draw_hinges(figure, title, (&scene, HINGES), &hinges_m, spots, &[]),
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

/// Adds the command to a page without marks.
fn keep_command(cases: &mut PageCases, text: &CaseScenario) {
    if cases.spots.is_empty() {
        cases.push((SpotKind::Hinge, false), String::new(), || {
            Some(text.clone())
        });
        cases.spots.clear();
    }
}

/// Makes the files and the words of a structure under live loads, or under a vehicle, drawn at its worst position.
fn live_results(
    scenario: &Scenario,
    summary: &LimitSummary,
    live: &LiveLimit,
    figure: Figure,
) -> Result<Results, StudyError> {
    let title = scenario.title.as_deref().unwrap_or("Limit analysis");
    let (structure, answer) = (&scenario.structure, live.governing());
    let scene = Scene::new(&live.loaded(structure));
    let mut cases = PageCases::default();
    let text = CaseScenario::unchanged(cases.add_text(&scenario.to_json(), false));
    let hinges = answer.hinges_m(structure);
    for (at_m, words) in &hinges {
        let [x, y] = [at_m.x, at_m.y].map(|at_m| format_fixed(at_m, 5));
        let words = format!("({x}, {y}) m: {words}");
        cases.push((SpotKind::Hinge, false), words, || Some(text.clone()));
    }
    keep_command(&mut cases, &text);
    let hinges_m: Vec<_> = hinges
        .iter()
        .map(|(at_m, _)| (Sway::Right, *at_m))
        .collect();
    let line_m = &answer.thrust_line_m;
    let draw = |figure, spots: &[Spot]| {
        draw_hinges(figure, title, (&scene, LIVE), &hinges_m, spots, line_m)
    };
    let results = Results::of("limit.json", summary)?.with_file("limit.svg", draw(figure, &[]));
    let mut page = Page::new(title, structure.describe(), &[], &[]);
    page.marked = Marked::Hinges;
    page.command = "limit - --out case".to_owned();
    let positions = |figure| live.draw_positions(figure, title);
    let draw = |figure| draw(figure, &cases.spots);
    if live.positions.is_empty() {
        let results = results.with_page("limit.html", page, &cases, (&draw, &[]));
        return Ok(results.in_order(&FILES));
    }
    let results = results
        .with_page("limit.html", page, &cases, (&draw, &[&positions]))
        .with_file("vehicle.svg", positions(figure))
        .with_table("limit.csv", live.table()?);
    Ok(results.in_order(&FILES))
}
