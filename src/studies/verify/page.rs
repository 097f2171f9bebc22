//! The check on one page that prints on A4: everything that another engineer needs to redo it by hand.
//!
//! Every number on it is a rounded number of [`super::to_json`], in an element `data` that holds the full value.

use std::time::{SystemTime, UNIX_EPOCH};

use super::histories::{Histories, HistorySide, Peak};
use super::summary::{Sums, is_symmetric, scenario_sha256, to_json};
use super::words::{
    NO_VERDICT, in_passes, name, names, of_method, verdict_sentence, without_demand, words,
};
use super::{
    Activation, ByDisplacement, Check, EITHER, Margin, Mechanism, Method, SideCheck, Simplified,
    Spectrum, StateCheck, Way, notes, picture,
};
use crate::argument::fixed;
use crate::dynamics::demand::damping_factor;
use crate::dynamics::demand::ground::GroundSpectrum;
use crate::mechanics::chain::Hinge;
use crate::mechanics::geometry::ring::Edge;
use crate::mechanics::sway::Sway;
use crate::output::page::{escaped, filled};
use crate::output::{Figure, OutputError, pretty};
use crate::scenario::{LimitState, Scenario, StateRule, shown};
use crate::studies::results::Results;

/// Names of the files, the seal last.
pub const FILES: [&str; 2] = ["verify.html", "verify.json"];

/// Page, numbers and words of a check of a scenario.
///
/// # Errors
/// When a value is not finite.
pub fn tell(scenario: &Scenario, check: &Check) -> Result<Results, OutputError> {
    let summary = to_json(scenario, check)?;
    let page = page(scenario, check, &today());
    Ok(Results {
        files: FILES
            .into_iter()
            .zip([page.into_bytes(), pretty(&summary).into_bytes()])
            .collect(),
        words: words(check),
        summary,
        ..Results::default()
    })
}

/// The page of a check of a scenario, with the date of the check.
#[must_use]
pub fn page(scenario: &Scenario, check: &Check, date: &str) -> String {
    let title = scenario.title().unwrap_or("Check of local mechanisms");
    let (by, footer) = if check.by_the_code() {
        (
            "Local mechanisms by Circolare 7/2019, C8.7.1.2.1, with the spectra of NTC 2018. C: clauses of the Circolare; \
             \u{a7}: of NTC 2018.",
            "Computed by the formulas of Circolare 7/2019, C8.7.1.2.1 and C7.2.3, and of NTC 2018, \u{a7} 3.2; the engineer \
             answers for the applicability.",
        )
    } else {
        (
            "Local mechanisms, with spectra and limits given by the engineer: no clause is named.",
            "Computed with spectra and limits given by the engineer, who answers for the applicability.",
        )
    };
    let writer = Writer {
        scenario,
        check,
        is_symmetric: is_symmetric(check),
    };
    let program = format!("{} {}", env!("CARGO_PKG_NAME"), env!("CARGO_PKG_VERSION"));
    filled(
        include_str!("page/page.html"),
        &[
            ("PROGRAM", &program),
            ("STYLE", include_str!("page/page.css")),
            ("TITLE", &escaped(title)),
            ("BY", by),
            ("FILES", &writer.files()),
            ("HASH", &scenario_sha256(scenario)),
            ("DATE", &escaped(date)),
            ("RESULT", &writer.result()),
            ("MECHANISM", &writer.sides(Writer::mechanism)),
            ("DEMAND", &writer.demand()),
            ("CHECKS", &writer.sides(Writer::checks)),
            ("HISTORIES", &writer.histories()),
            ("NOTES", &writer.notes()),
            ("FOOTER", footer),
            ("SCENARIO", &escaped(&scenario.to_resolved_toml())),
        ],
    )
}

/// Today's date in Greenwich, as in 2025-01-31.
#[must_use]
pub fn today() -> String {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    date_of(since.map_or(0, |since| since.as_secs() / 86_400))
}

/// The date this many days after 1 January 1970.
fn date_of(mut days: u64) -> String {
    let leap = |year: u64| {
        year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400))
    };
    let mut year = 1970;
    while days >= 365 + u64::from(leap(year)) {
        days -= 365 + u64::from(leap(year));
        year += 1;
    }
    let february = 28 + u64::from(leap(year));
    let mut month = 1;
    for length in [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31] {
        if days < length {
            break;
        }
        days -= length;
        month += 1;
    }
    format!("{year}-{month:02}-{:02}", days + 1)
}

/// A number with this many decimals, and its full value.
fn n(value: f64, decimals: usize) -> String {
    let text = fixed(value, decimals);
    // Adding zero makes a negative zero positive.
    format!("<data value=\"{:?}\">{text}</data>", value + 0.0)
}

/// The same for a number that may be missing.
fn maybe(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(|| "\u{2013}".to_owned(), |value| n(value, decimals))
}

/// Words with symbols set as in formulas: `a_g,SLD` gets an index, `alpha` becomes a letter.
fn typeset(text: &str) -> String {
    let mut words = escaped(text);
    for (name, letter) in [("alpha_", "\u{3b1}_"), ("xi\u{b2}", "\u{3be}\u{b2}")] {
        words = words.replace(name, letter);
    }
    let mut set = String::new();
    let mut rest = words.as_str();
    while let Some((before, after)) = rest.split_once('_') {
        set += before;
        // Only a single letter has an index.
        let mut letters = before.chars().rev();
        let letter = letters.next().is_some_and(char::is_alphabetic);
        let alone = letter && !letters.next().is_some_and(char::is_alphanumeric);
        let index = |c: char| c.is_alphanumeric() || c == ',';
        let end = after.find(|c| !index(c)).unwrap_or(after.len());
        let index = after[..end].trim_end_matches(',');
        if alone && !index.is_empty() {
            set += &format!("<sub>{index}</sub>");
            rest = &after[index.len()..];
        } else {
            set.push('_');
            rest = after;
        }
    }
    set + rest
}

/// A row of cells.
fn row(class: &str, cells: &[String]) -> String {
    let cells: String = cells
        .iter()
        .map(|cell| format!("<td>{cell}</td>"))
        .collect();
    let class = if class.is_empty() {
        String::new()
    } else {
        format!(" class=\"{class}\"")
    };
    format!("<tr{class}>{cells}</tr>\n")
}

fn table(head: &[&str], body: &str) -> String {
    let head: String = head.iter().map(|cell| format!("<th>{cell}</th>")).collect();
    format!("<table><thead><tr>{head}</tr></thead>\n<tbody>\n{body}</tbody></table>\n")
}

fn formula(text: &str) -> String {
    format!("<p class=\"formula\">{text}</p>\n")
}

struct Writer<'a> {
    scenario: &'a Scenario,
    check: &'a Check,
    /// Whether the left side is the mirror image of the right side.
    is_symmetric: bool,
}

impl Writer<'_> {
    /// The clause of a formula, if clauses are cited.
    fn clause(&self, clause: &str) -> String {
        if self.check.by_the_code() {
            format!(" <span class=\"clause\">[{clause}]</span>")
        } else {
            String::new()
        }
    }

    /// The files from which the scenario was read, with their hashes.
    fn files(&self) -> String {
        let files = self.scenario.files().iter();
        let lines = files.map(|one| {
            format!(
                "<span class=\"hash\">{}: SHA-256 {}</span>",
                escaped(&shown(&one.file)),
                one.sha256
            )
        });
        lines.collect()
    }

    /// The reports on each side; for a symmetric structure, on the right side only.
    fn sides(&self, tell: fn(&Self, &Mechanism, Figure) -> String) -> String {
        let one = self.is_symmetric || self.check.mechanisms.len() == 1;
        let figure = if one { "78mm" } else { "90mm" };
        let figure: Figure = figure.parse().expect("a width of a figure");
        let shown = if one { 1 } else { self.check.mechanisms.len() };
        let mut text = String::new();
        for mechanism in &self.check.mechanisms[..shown] {
            let told = tell(self, mechanism, figure);
            text += &if one {
                told
            } else {
                format!(
                    "<div>\n<h3>To the {}</h3>\n{told}</div>\n",
                    mechanism.sway.name()
                )
            };
        }
        let class = if one { "pair one" } else { "pair" };
        let mirror = if self.is_symmetric {
            "<p class=\"before\">To the right. To the left it is the mirror image, with the same numbers.</p>\n"
        } else {
            ""
        };
        format!("{mirror}<div class=\"{class}\">\n{text}</div>\n")
    }

    // Result.

    fn result(&self) -> String {
        let mut body = String::new();
        for state in &self.check.states {
            let counts = state.governing();
            let either = state.governing_side() == Some(EITHER);
            let sides = &state.sides[..if self.is_symmetric {
                1
            } else {
                state.sides.len()
            }];
            for side in sides {
                for (method, margin, what) in rows_of(side) {
                    let is_it = counts.is_some_and(|(sway, counted, _)| {
                        counted == method && (either || sway == side.sway)
                    });
                    body += &self.result_row(state, side.sway, method, &margin, &what, is_it);
                }
            }
            if let Some(histories) = &state.histories {
                body += &self.histories_rows(state.state, histories);
            }
            if counts.is_none() {
                let cells = [
                    name(state.state),
                    "not checked: there is no capacity curve".to_owned(),
                ];
                body += &format!(
                    "<tr><td class=\"word\">{}</td><td class=\"word\" colspan=\"8\">{}</td></tr>\n",
                    cells[0], cells[1]
                );
            }
        }
        let head = "<tr><th class=\"word\">State</th><th class=\"word\">Method</th><th class=\"word\">To the</th>\
                    <th>Capacity</th><th>Demand</th><th>a<sub>g</sub> borne (g)</th><th>a<sub>g</sub> (g)</th>\
                    <th>\u{3b6}<sub>E</sub></th><th class=\"word\"></th></tr>";
        let least = n(self.check.zeta_e(), 3);
        let number = |zeta_e| format!("\u{3b6}<sub>E</sub> = {}", n(zeta_e, 3));
        let mut text = format!(
            "<p class=\"sentence\">{}</p>\n<table><thead>{head}</thead>\n<tbody>\n{body}</tbody></table>\n\
             <p>Bold: the governing result of a state. Least of the checked states, {}: \u{3b6}<sub>E</sub> = <b>{least}</b>.",
            verdict_sentence(self.check, number),
            names(self.check.checked())
        );
        if self.check.by_the_code() {
            text += " SLV or SLC suffices (C8.7.1, \u{a7} 8.3); SLD is asked for in use class IV (\u{a7} 8.3).";
            let sld = self
                .check
                .states
                .iter()
                .any(|one| one.state == LimitState::Sld);
            if !sld {
                text += " SLD is not given: whether a<sub>g,SLV</sub> is below a<sub>g,SLD</sub>, which would then count, is not checked.";
            }
        }
        text += "</p>\n";
        let warnings = self.check.warnings.iter();
        let warnings = warnings.map(|line| format!("<p class=\"warning\">{}</p>\n", typeset(line)));
        text + &warnings.collect::<String>()
    }

    fn histories_rows(&self, state: LimitState, histories: &Histories) -> String {
        let sides = &histories.sides[..if self.is_symmetric {
            1
        } else {
            histories.sides.len()
        }];
        let rows = sides.iter().map(|side| {
            let class = if side.passes[1] == Some(true) { "verdict" } else { "verdict no" };
            let to = if self.is_symmetric { "either side" } else { side.sway.name() };
            let demand = side.demand_m.map_or(without_demand(side).to_owned(), |demand_m| n(demand_m, 4) + " m");
            format!(
                "<tr><td class=\"word\">{}</td><td class=\"word\">histories{}</td><td class=\"word\">{to}</td><td>{} m</td>\
                 <td>{demand}</td><td></td><td></td><td></td><td class=\"word\"><span class=\"{class}\">{}</span></td></tr>\n",
                name(state),
                self.clause("C8.7.1.2.1.9"),
                n(side.capacity_over_fc_m, 4),
                in_passes(side.passes)
            )
        });
        rows.collect()
    }

    fn result_row(
        &self,
        state: &StateCheck,
        sway: Sway,
        method: Method,
        margin: &Margin,
        (capacity, demand): &(String, String),
        counts: bool,
    ) -> String {
        let clause = match (method, state.state) {
            (Method::Activation, LimitState::Sld) => "C8.7.1.2.1.5",
            (Method::Simplified, _) => "C8.7.1.2.1.7",
            (Method::Activation | Method::Displacement, _) => "C8.7.1.2.1.8",
        };
        let side = if self.is_symmetric {
            "either side"
        } else {
            sway.name()
        };
        let (class, word) = if margin.passes() {
            ("verdict", "passed")
        } else {
            ("verdict no", "not passed")
        };
        let verdict = format!("<span class=\"{class}\">{word}</span>");
        let counts = if counts { " class=\"counts\"" } else { "" };
        format!(
            "<tr{counts}><td class=\"word\">{}</td><td class=\"word\">{}{}</td><td class=\"word\">{side}</td><td>{capacity}</td>\
             <td>{demand}</td><td>{}</td><td>{}</td><td>{}</td><td class=\"word\">{verdict}</td></tr>\n",
            name(state.state),
            of_method(method),
            self.clause(clause),
            maybe(margin.ag_capacity_g, 4),
            maybe(margin.ag_g, 4),
            n(margin.zeta_e, 3),
        )
    }

    // Mechanism.

    fn mechanism(&self, mechanism: &Mechanism, figure: Figure) -> String {
        let picture = picture::mechanism(figure, self.scenario.structure(), mechanism);
        let hinges = ('A'..='Z').zip(&mechanism.hinges).map(|(letter, placed)| {
            let place = match placed.hinge {
                Hinge::Section { edge, .. } => edge.name().to_owned(),
                Hinge::Toe(side) => format!("{} toe", side.name()),
                Hinge::Joint { joint, edge } => {
                    format!("joint {joint}, {}", edge.map_or("parted", Edge::name))
                }
            };
            format!(
                "{letter} {place} ({}, {}) m",
                n(placed.at_m.x, 3),
                n(placed.at_m.y, 3)
            )
        });
        let hinges: Vec<String> = hinges.collect();
        format!(
            "<div><figure>{picture}<figcaption>Bodies by number with their centres and virtual displacements; hinges: {}. \
             {}.</figcaption></figure></div>\n<div>\n{}{}</div>\n",
            hinges.join("; "),
            escaped(&self.scenario.structure().described()),
            self.bodies(mechanism),
            self.activation_formulas(mechanism)
        )
    }

    fn bodies(&self, mechanism: &Mechanism) -> String {
        let mut body = String::new();
        for (number, one) in (1..).zip(&mechanism.bodies) {
            body += &row(
                "",
                &[
                    format!("{number}"),
                    n(one.mass_kg * self.check.gravity_m_s2 / 1000.0, 3),
                    n(one.centre_m.x, 4),
                    n(one.centre_m.y, 4),
                    n(one.displacement.x, 5),
                    n(one.displacement.y, 5),
                ],
            );
        }
        let head = [
            "k",
            "P<sub>k</sub> (kN)",
            "x (m)",
            "y (m)",
            "\u{3b4}<sub>x</sub>",
            "\u{3b4}<sub>y</sub>",
        ];
        table(&head, &body)
            + "<p>Virtual displacements of the centres for one of their common centre; x to the side of the motion.</p>\n"
            + &self.ties(mechanism)
    }

    fn ties(&self, mechanism: &Mechanism) -> String {
        if mechanism.ties.is_empty() {
            return String::new();
        }
        let mut body = String::new();
        for (number, tie) in (1..).zip(&mechanism.ties) {
            let force_kn = tie.force_kg * self.check.gravity_m_s2 / 1000.0;
            body += &row(
                "",
                &[format!("{number}"), n(force_kn, 3), n(tie.lengthening, 5)],
            );
        }
        table(&["tie", "F (kN)", "\u{3b4}<sub>l</sub>"], &body)
            + "<p>Forces of the ties at rest, and their lengthening.</p>\n"
    }

    fn activation_formulas(&self, mechanism: &Mechanism) -> String {
        let sums = Sums::of(mechanism, self.check.gravity_m_s2);
        let part = &mechanism.participation;
        let settings = &self.check.settings;
        let (name, work) = if mechanism.ties.is_empty() {
            ("\u{2211}P\u{3b4}<sub>y</sub>", n(sums.rise_kn, 4))
        } else {
            (
                "(\u{2211}P\u{3b4}<sub>y</sub> + \u{2211}F\u{3b4}<sub>l</sub>)",
                if sums.held_kn < 0.0 {
                    format!("({} + ({}))", n(sums.rise_kn, 4), n(sums.held_kn, 4))
                } else {
                    format!("({} + {})", n(sums.rise_kn, 4), n(sums.held_kn, 4))
                },
            )
        };
        let mut text = formula(&format!(
            "\u{3b1}<sub>0</sub> = {name} / \u{2211}P\u{3b4}<sub>x</sub> = {work} / {} = <b>{}</b>; A<sub>L</sub> = \
             \u{3b1}<sub>0</sub> g = {} g{}",
            n(sums.sway_kn, 4),
            n(mechanism.alpha0, 5),
            n(mechanism.alpha0, 5),
            self.clause("C8.7.1.1")
        ));
        text += &formula(&format!(
            "e* = (\u{2211}P\u{3b4}<sub>x</sub>)\u{b2} / (\u{2211}P \u{2211}P\u{3b4}<sub>x</sub>\u{b2}) = {}\u{b2} / ({} \u{b7} {}) = \
             <b>{}</b>; M* = e* \u{2211}P/g = {} kg{}",
            n(sums.sway_kn, 4),
            n(sums.weight_kn, 4),
            n(sums.sway_squared_kn, 4),
            n(part.mass_fraction, 5),
            n(part.participating_mass_kg, 1),
            self.clause("C8.7.1.5")
        ));
        text += &formula(&format!(
            "a<sub>0</sub>/FC = \u{3b1}<sub>0</sub> g/(e* FC) = {} / ({} \u{b7} {}) g = <b>{}</b> g{}",
            n(mechanism.alpha0, 5),
            n(part.mass_fraction, 5),
            settings.confidence_factor,
            n(self.check.activation_g(mechanism), 5),
            self.clause("C8.7.1.3")
        ));
        match &mechanism.way {
            Ok(way) => text += &self.way_formulas(way),
            Err(why) => text += &formula(&format!("No capacity curve: {}.", escaped(why))),
        }
        text
    }

    fn way_formulas(&self, way: &Way) -> String {
        let end = way.centre.end();
        let mut text = formula(&format!(
            "\u{3b1} = 0 at d<sub>C0</sub> = {} m of the common centre; d<sub>0</sub> = d<sub>C0</sub>/e* = <b>{}</b> m{}",
            n(end.displacement_m, 5),
            n(end.oscillator_displacement_m, 5),
            self.clause("C8.7.1.4")
        ));
        if let Some(crown) = &way.crown {
            text += &formula(&format!(
                "With the {} as control point d<sub>C0</sub> = {} m, d<sub>0</sub> = {} m.",
                self.check.top,
                n(crown.end().displacement_m, 5),
                n(crown.end().oscillator_displacement_m, 5)
            ));
        }
        if let (Some(t0_s), Some((d_m, a_g))) = (self.check.t0_s, self.check.yielding(way)) {
            text += &formula(&format!(
                "Elastic up to d<sub>y</sub> = {} m, a<sub>y</sub>/FC = {} g, with T<sub>0</sub> = {} s{}",
                n(d_m, 6),
                n(a_g, 5),
                n(t0_s, 5),
                self.clause("C8.7.1.6, C8.7.1.7")
            ));
        }
        text
    }

    // Demand.

    fn demand(&self) -> String {
        let mut body = String::new();
        for one in &self.check.states {
            if let Some(ground) = one.spectrum.ground() {
                body += &parameters(one.state, ground, self.check.gravity_m_s2);
            }
        }
        let mut text = String::new();
        if !body.is_empty() {
            let head = [
                "State",
                "soil",
                "a<sub>g</sub> (g)",
                "F<sub>o</sub>",
                "T<sub>C</sub>* (s)",
                "S<sub>S</sub>",
                "S<sub>T</sub>",
                "S",
                "C<sub>C</sub>",
                "T<sub>B</sub> (s)",
                "T<sub>C</sub> (s)",
                "T<sub>D</sub> (s)",
                "a<sub>g</sub>S (g)",
                "d<sub>g</sub> (m)",
            ];
            text += &table(&head, &body);
            text += "<p>\u{a7} 3.2.3.2: S<sub>S</sub>, C<sub>C</sub> by Tab. 3.2.IV, S<sub>T</sub> by Tab. 3.2.V, S = S<sub>S</sub> S<sub>T</sub>, \
                     T<sub>C</sub> = C<sub>C</sub> T<sub>C</sub>*, T<sub>B</sub> = T<sub>C</sub>/3, T<sub>D</sub> = 4 a<sub>g</sub>/g + 1.6, \
                     \u{3b7} = \u{221a}(10/(5 + \u{3be})).</p>\n";
        }
        text + &self.modes() + &self.points()
    }

    fn modes(&self) -> String {
        let mut body = String::new();
        for one in &self.check.states {
            let Spectrum::Floor(ground, floor) = &one.spectrum else {
                continue;
            };
            let damping = one.rule.map_or(5.0, |rule| rule.damping_percent);
            for (number, mode) in (1..).zip(&floor.modes) {
                body += &row(
                    "",
                    &[
                        name(one.state),
                        number.to_string(),
                        n(mode.t_s, 3),
                        n(mode.damping_percent, 1),
                        n(mode.gamma, 4),
                        n(mode.psi, 4),
                        n(ground.acceleration_g(mode.t_s, mode.damping_percent), 5),
                        n(mode.peak_g(ground), 5),
                        n(floor.peak_g(), 5),
                        n(mode.amplification(damping), 4),
                    ],
                );
            }
        }
        if body.is_empty() {
            return String::new();
        }
        let head = [
            "State",
            "mode",
            "T<sub>k</sub> (s)",
            "\u{3be}<sub>k</sub> (%)",
            "\u{3b3}<sub>k</sub>",
            "\u{3c8}<sub>k</sub>",
            "S<sub>e</sub>(T<sub>k</sub>) (g)",
            "a<sub>Z,k</sub> (g)",
            "a<sub>Z</sub> (g)",
            "f",
        ];
        table(&head, &body)
            + "<p>C7.2.3: a<sub>Z,k</sub> [C7.2.7], a<sub>Z</sub> [C7.2.8] and at least a<sub>g</sub>S, f at the damping of the mechanism, \
               S<sub>eZ</sub> [C7.2.5, C7.2.6] with a = 0.8, b = 1.1.</p>\n"
    }

    fn points(&self) -> String {
        let mut text = String::new();
        for one in &self.check.states {
            let Spectrum::Points(demand) = &one.spectrum else {
                continue;
            };
            let points = demand.points.points();
            let shown: Vec<String> = points
                .iter()
                .take(MOST_POINTS)
                .map(|(period_s, acceleration_g)| {
                    format!("({}, {})", n(*period_s, 3), n(*acceleration_g, 4))
                })
                .collect();
            let more = points.len().saturating_sub(MOST_POINTS);
            let more = if more > 0 {
                format!(" and {more} more in the file")
            } else {
                String::new()
            };
            text += &format!(
                "<p><b>{}</b>: {}, at {} % damping, straight between (T in s, S in g): {}{more}.",
                name(one.state),
                escaped(&demand.spectrum),
                demand.damping_percent,
                shown.join(" ")
            );
            if let Some(rule) = &one.rule {
                text += &format!(
                    " Limit: {} d<sub>0</sub>, divided by {}; T = {} \u{3c0} \u{221a}(d/a), a divided by {}; {} % damping.",
                    rule.part_of_d0,
                    rule.divide_displacement,
                    rule.period_factor,
                    rule.divide_acceleration,
                    rule.damping_percent
                );
            }
            text += "</p>\n";
        }
        text
    }

    // Checks.

    fn checks(&self, mechanism: &Mechanism, figure: Figure) -> String {
        let picture = mechanism.way.as_ref().map_or(String::new(), |way| {
            let drawn = picture::capacity(figure, self.check, mechanism, way);
            format!(
                "<div><figure>{drawn}<figcaption>Dotted: lines of the periods; circles: reached, and demanded.</figcaption></figure></div>\n"
            )
        });
        let mut text = String::new();
        for state in &self.check.states {
            let Some(side) = state.sides.iter().find(|side| side.sway == mechanism.sway) else {
                continue;
            };
            if let Some((_, margin)) = side.governing() {
                let word = if margin.passes() {
                    "passed"
                } else {
                    "not passed"
                };
                text += &format!("<h3>{}: {word}</h3>\n", name(state.state));
            }
            if let Some(one) = &side.activation {
                text += &self.activation(one);
            }
            if let (Some(one), Some(rule)) = (&side.displacement, &state.rule) {
                text += &self.displacement(state, mechanism, one, rule);
            }
            if let Some(one) = &side.simplified {
                text += &self.simplified(one);
            }
        }
        format!("{picture}<div>\n{text}</div>\n")
    }

    fn activation(&self, one: &Activation) -> String {
        let (what, clause) = match (self.check.t0_s, &self.check.states[0].spectrum) {
            (Some(_), _) => ("S<sub>e</sub>(T<sub>0</sub>, 5 %)", "C8.7.1.9"),
            (None, Spectrum::Ground(_)) => ("a<sub>g</sub>S", "C8.7.1.8"),
            (None, Spectrum::Floor(..)) => ("a<sub>Z</sub>", "C8.7.1.8"),
            (None, Spectrum::Points(_)) => ("S(0)", ""),
        };
        let borne =
            one.margin
                .ag_capacity_g
                .zip(one.margin.ag_g)
                .map_or(String::new(), |(borne, ag_g)| {
                    format!(
                        "; a<sub>g,SLD</sub> = {} \u{b7} {} / {} = {} g",
                        n(ag_g, 4),
                        n(one.capacity_g, 5),
                        n(one.demand_g, 5),
                        n(borne, 5)
                    )
                });
        formula(&format!(
            "a<sub>0</sub>/FC = {} g against {what} = {} g{borne}; \u{3b6}<sub>E</sub> = <b>{}</b>{}",
            n(one.capacity_g, 5),
            n(one.demand_g, 5),
            n(one.margin.zeta_e, 4),
            self.clause(clause)
        ))
    }

    fn simplified(&self, one: &Simplified) -> String {
        formula(&format!(
            "Simplified: a<sub>g,SLV</sub> = q a<sub>g,SLD</sub> = {} \u{b7} {} = {} g; \u{3b6}<sub>E</sub> = {}{}",
            one.behaviour_factor,
            n(one.activation_ag_g, 5),
            maybe(one.margin.ag_capacity_g, 5),
            n(one.margin.zeta_e, 4),
            self.clause("C8.7.1.2.1.7")
        ))
    }

    fn displacement(
        &self,
        state: &StateCheck,
        mechanism: &Mechanism,
        one: &ByDisplacement,
        rule: &StateRule,
    ) -> String {
        let Ok(way) = &mechanism.way else {
            return String::new();
        };
        let name = name(state.state);
        let d0_m = way.centre.end().oscillator_displacement_m;
        let period_clause = if state.state == LimitState::Slv {
            "C8.7.1.10"
        } else {
            "C8.7.1.11"
        };
        let divided = if rule.divide_displacement == 1.0 {
            String::new()
        } else {
            format!(" / {}", rule.divide_displacement)
        };
        let mut text = formula(&format!(
            "d<sub>{name}</sub> = {} d<sub>0</sub>{divided} = {} \u{b7} {}{divided} = <b>{}</b> m; a(d)/{} = {} g{}",
            rule.part_of_d0,
            rule.part_of_d0,
            n(d0_m, 5),
            n(one.capacity_m, 5),
            if self.check.by_the_code() {
                "FC".to_owned()
            } else {
                rule.divide_acceleration.to_string()
            },
            n(one.acceleration_g, 5),
            self.clause("C8.7.1.2.1.6")
        ));
        text += &formula(&format!(
            "T = {} \u{3c0} \u{221a}(d/a) = {} \u{3c0} \u{221a}({} / ({} \u{b7} {})) = <b>{}</b> s{}",
            rule.period_factor,
            rule.period_factor,
            n(one.reached_m, 5),
            n(one.acceleration_g, 5),
            self.check.gravity_m_s2,
            n(one.period_s, 4),
            self.clause(period_clause)
        ));
        text += &self.demanded(state, one, rule);
        let following = one.ag_following_g.map_or(String::new(), |ag_g| {
            format!(
                "; with S<sub>S</sub>, T<sub>D</sub> following a<sub>g</sub>: {} g",
                n(ag_g, 5)
            )
        });
        let borne = one
            .displacement
            .ag_capacity_g
            .map_or(String::new(), |borne| {
                format!(
                    "a<sub>g</sub> borne = a<sub>g</sub> d/S<sub>D</sub> = {} g{following}; ",
                    n(borne, 5)
                )
            });
        let crown = one.zeta_e_crown.map_or(String::new(), |zeta_e| {
            format!("; at the {} {}", self.check.top, n(zeta_e, 4))
        });
        text += &formula(&format!(
            "{borne}\u{3b6}<sub>E</sub> = {} / {} = <b>{}</b>{crown}",
            n(one.capacity_m, 5),
            n(one.demand_m, 5),
            n(one.displacement.zeta_e, 4)
        ));
        if let Some(start_g) = one.activation_ag_g {
            text += &formula(&format!(
                "It starts at a<sub>g,SLD</sub> = {} g only, which is more and counts: \u{3b6}<sub>E</sub> = <b>{}</b>{}",
                n(start_g, 5),
                n(one.margin.zeta_e, 4),
                self.clause("C8.7.1.2.1.8")
            ));
        }
        text
    }

    /// The displacement demand, with the formula of its spectrum.
    fn demanded(&self, state: &StateCheck, one: &ByDisplacement, rule: &StateRule) -> String {
        let damping = rule.damping_percent;
        match &state.spectrum {
            Spectrum::Ground(ground) => formula(&format!(
                "{}; S<sub>De</sub> = <b>{}</b> m{}",
                branch(ground, one, damping),
                n(one.demand_m, 5),
                self.clause("\u{a7} 3.2.3.2.3")
            )),
            Spectrum::Floor(..) => {
                let resonance = one.resonance_m.map_or(String::new(), |resonance_m| {
                    format!("; T &gt; b T<sub>1</sub>: at least S<sub>eZ</sub>(T<sub>1</sub>)(b T<sub>1</sub>)\u{b2}/4\u{3c0}\u{b2} = {} m", n(resonance_m, 5))
                });
                formula(&format!(
                    "S<sub>eZ</sub>(T, {damping} %) = {} g; S<sub>eZ</sub>T\u{b2}/4\u{3c0}\u{b2}{resonance}; demand <b>{}</b> m{}",
                    n(one.demand_g, 5),
                    n(one.demand_m, 5),
                    self.clause("C8.7.1.12")
                ))
            }
            Spectrum::Points(_) => formula(&format!(
                "S(T, {damping} %) = {} g; the largest S T\u{b2}/4\u{3c0}\u{b2} up to T is <b>{}</b> m",
                n(one.demand_g, 5),
                n(one.demand_m, 5)
            )),
        }
    }

    // Histories.

    /// The results of each record, if there are histories.
    fn histories(&self) -> String {
        let mut text = String::new();
        for state in &self.check.states {
            if let Some(histories) = &state.histories {
                text += &self.histories_of(state, histories);
            }
        }
        text
    }

    fn histories_of(&self, state: &StateCheck, histories: &Histories) -> String {
        let peak = |peak: Peak| {
            if peak.overturned {
                "overturns".to_owned()
            } else if peak.incomplete {
                NO_VERDICT.to_owned()
            } else {
                n(peak.displacement_m, 5)
            }
        };
        let rows = histories.records.iter().map(|record| {
            let [right, left] = record.peaks.map(peak);
            format!(
                "<tr><td class=\"word\">{} <span class=\"clause\">CRC {:08x}</span></td><td>{}</td><td>{right}</td><td>{left}</td></tr>\n",
                escaped(&record.file),
                record.checksum,
                n(record.peak_g, 4)
            )
        });
        let mut text = format!(
            "<h3>{}: histories{}</h3>\n<table><thead><tr><th class=\"word\">Record</th><th>peak (g)</th><th>peak d to the right (m)\
             </th><th>to the left (m)</th></tr></thead>\n<tbody>\n{}</tbody></table>\n",
            name(state.state),
            self.clause("C8.7.1.2.1.9"),
            rows.collect::<String>()
        );
        for side in &histories.sides {
            text += &formula(&history_side(state.state, histories, side));
        }
        if let Some([least, largest]) = histories.spectrum_ratios {
            let [from_s, to_s] = histories.periods_s;
            text += &formula(&format!(
                "Mean spectrum of the records at 5 % over the one demanded, {} to {} s: {} to {}{}.",
                n(from_s, 2),
                n(to_s, 2),
                n(least, 3),
                n(largest, 3),
                self.clause("\u{a7} 3.2.3.6")
            ));
        }
        text
    }

    // Notes.

    fn notes(&self) -> String {
        let decisions = notes::decisions(self.check).into_iter();
        let decisions: String = decisions
            .map(|(name, text)| format!("<dt>{name}</dt><dd>{}</dd>\n", typeset(&text)))
            .collect();
        let list = |lines: Vec<String>| -> String {
            let items = lines
                .iter()
                .map(|line| format!("<li>{}</li>\n", typeset(line)));
            format!("<ul>\n{}</ul>\n", items.collect::<String>())
        };
        format!(
            "<h3>Where the text leaves room, decided here</h3>\n<dl class=\"notes\">\n{decisions}</dl>\n<h3>Assumed</h3>\n{}<h3>Not \
             covered</h3>\n{}",
            list(notes::assumptions(self.check)),
            list(notes::not_covered(self.scenario, self.check))
        )
    }
}

/// Largest number of points of a spectrum on the page.
const MOST_POINTS: usize = 40;

/// The methods of a side, with the values that they compare.
fn rows_of(side: &SideCheck) -> Vec<(Method, Margin, (String, String))> {
    let mut rows = Vec::new();
    if let Some(one) = &side.activation {
        let what = (n(one.capacity_g, 4) + " g", n(one.demand_g, 4) + " g");
        rows.push((Method::Activation, one.margin, what));
    }
    if let Some(one) = &side.displacement {
        let what = match (one.activation_ag_g, one.margin.ag_g) {
            (Some(start_g), Some(ag_g)) => (n(start_g, 4) + " g", n(ag_g, 4) + " g"),
            _ => (n(one.capacity_m, 4) + " m", n(one.demand_m, 4) + " m"),
        };
        rows.push((one.method(), one.margin, what));
    }
    if let Some(one) = &side.simplified {
        rows.push((
            Method::Simplified,
            one.margin,
            (String::new(), String::new()),
        ));
    }
    rows
}

/// The result of the histories to one side.
fn history_side(state: LimitState, histories: &Histories, side: &HistorySide) -> String {
    let counted = if histories.is_mean() {
        "mean of the peaks"
    } else {
        "largest peak"
    };
    let without = match side.overturned {
        true => "a record overturns it",
        false => NO_VERDICT,
    };
    let demand = side.demand_m.map_or(without.to_owned(), |demand_m| {
        let spread = side.mean_interval_m.map_or(String::new(), |[low, high]| {
            format!(
                " (95 %: {} to {} m, by bootstrap over the records)",
                n(low, 5),
                n(high, 5)
            )
        });
        format!("{counted} <b>{}</b> m{spread}", n(demand_m, 5))
    });
    let restitution = side.restitution.map_or(String::new(), |kept| {
        format!(
            " The first impact after it leaves {} of the energy.",
            n(kept, 4)
        )
    });
    format!(
        "To the {}: {demand}; d<sub>{}</sub> = {} m, over FC {} m; d<sub>0</sub> = {} m is exceeded by {} of {} records, over FC by {}: \
         <b>{}</b>.{restitution}",
        side.sway.name(),
        name(state),
        n(side.capacity_m, 5),
        n(side.capacity_over_fc_m, 5),
        n(side.d0_m, 5),
        side.exceeded[0],
        histories.records.len(),
        side.exceeded[1],
        in_passes(side.passes)
    )
}

fn parameters(state: LimitState, ground: &GroundSpectrum, gravity_m_s2: f64) -> String {
    row(
        "",
        &[
            name(state),
            ground.site.soil.name().to_owned(),
            n(ground.hazard.ag_g, 4),
            n(ground.hazard.f0, 3),
            n(ground.hazard.tc_star_s, 3),
            n(ground.s_s, 4),
            n(ground.site.topographic_factor, 2),
            n(ground.s(), 4),
            n(ground.c_c, 4),
            n(ground.t_b_s, 4),
            n(ground.t_c_s, 4),
            n(ground.t_d_s, 3),
            n(ground.peak_g(), 4),
            n(ground.peak_displacement_m(gravity_m_s2), 4),
        ],
    )
}

/// The branch of [3.2.2] on which a period lies, with its numbers.
fn branch(ground: &GroundSpectrum, one: &ByDisplacement, damping_percent: f64) -> String {
    let (t, eta) = (one.period_s, damping_factor(damping_percent));
    let common = format!(
        "{} \u{b7} {} \u{b7} {eta:.4} \u{b7} {}",
        n(ground.hazard.ag_g, 4),
        n(ground.s(), 4),
        n(ground.hazard.f0, 3)
    );
    let head = "a<sub>g</sub>S\u{3b7}F<sub>o</sub>";
    let value = n(one.demand_g, 5);
    if t > ground.t_e_s {
        return format!(
            "T &gt; T<sub>E</sub> = {} s: what softened has passed the plateau",
            n(ground.t_e_s, 1)
        );
    }
    let (range, factor, numbers) = if t < ground.t_b_s {
        (
            "T &lt; T<sub>B</sub>",
            " (T/T<sub>B</sub> + (1 - T/T<sub>B</sub>)/(\u{3b7}F<sub>o</sub>))",
            String::new(),
        )
    } else if t < ground.t_c_s {
        ("T &lt; T<sub>C</sub>", "", String::new())
    } else if t < ground.t_d_s {
        (
            "T &lt; T<sub>D</sub>",
            " T<sub>C</sub>/T",
            format!(" \u{b7} {} / {}", n(ground.t_c_s, 4), n(t, 4)),
        )
    } else {
        (
            "T \u{2265} T<sub>D</sub>",
            " T<sub>C</sub>T<sub>D</sub>/T\u{b2}",
            format!(
                " \u{b7} {} \u{b7} {} / {}\u{b2}",
                n(ground.t_c_s, 4),
                n(ground.t_d_s, 3),
                n(t, 4)
            ),
        )
    };
    let numbers = if t < ground.t_b_s {
        String::new()
    } else {
        format!(" = {common}{numbers}")
    };
    format!("{range}: S<sub>e</sub> = {head}{factor}{numbers} = {value} g")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_those_of_the_calendar() {
        for (days, date) in [
            (0, "1970-01-01"),
            (58, "1970-02-28"),
            (59, "1970-03-01"),
            (789, "1972-02-29"),
            (11_016, "2000-02-29"),
            (20_088, "2024-12-31"),
            (20_089, "2025-01-01"),
        ] {
            assert_eq!(date_of(days), date);
        }
    }

    #[test]
    fn symbols_have_indices_and_keys_do_not() {
        let set = typeset("q times a_g,SLD, alpha_0 g/e* & S_eZ; give free_standing, T_C*");
        let expected = "q times a<sub>g,SLD</sub>, \u{3b1}<sub>0</sub> g/e* &amp; S<sub>eZ</sub>; give free_standing, T<sub>C</sub>*";
        assert_eq!(set, expected);
    }

    #[test]
    fn numbers_are_rounded_and_keep_their_value() {
        assert_eq!(n(-1e-9, 3), "<data value=\"-1e-9\">0.000</data>");
        assert_eq!(
            n(1.0 / 3.0, 2),
            "<data value=\"0.3333333333333333\">0.33</data>"
        );
    }
}
