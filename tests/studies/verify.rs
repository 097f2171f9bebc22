//! The whole check by the Circolare 7/2019: worked numbers computed independently of this program, both sides, on the ground and
//! at a height; spectra from files; refusals with their reasons.

use crate::common::browser;
use crate::common::parsed;
use crate::common::program::{archrock, printed as print_of, refused, scenarios};
use crate::common::prose::{golden, shows};
use crate::common::{ARCH, COLUMN};
use archrock::scenario::LimitState;
use archrock::studies::verify::{
    CheckVerdict, CheckedMechanism, DisplacementCheck, GoverningSide, Method, SideCheck,
    StateCheck, VerifyError, VerifyPage, VerifySummary, page_of, verify, words,
};
use archrock::studies::words_of_json;
use archrock::{Scenario, Sway};
use nalgebra::Vector2;
use serde_json::Value;

const DEMAND: &str = "[demand]\nsoil = 'B'\ntopography = 'T1'\n\
    [demand.sld]\nag_g = 0.10\nf0 = 2.40\ntc_star_s = 0.28\n\
    [demand.slv]\nag_g = 0.25\nf0 = 2.40\ntc_star_s = 0.35\n\
    [demand.slc]\nag_g = 0.32\nf0 = 2.45\ntc_star_s = 0.36\n";
const HEIGHT: &str = "[demand.height]\nmodes = [{ gamma = 1.2857142857142858, psi = 0.75, \
    sld = { t_s = 0.30, damping_percent = 5 }, slv = { t_s = 0.45, damping_percent = 10 }, \
    slc = { t_s = 0.60, damping_percent = 15 } }]\n";

/// The arch on piers without fill on them, as other programs computed it.
fn on_piers() -> String {
    let text = std::fs::read_to_string(scenarios().join("pointed-arch-on-piers.toml")).unwrap();
    text.replace("[fill]\n", "[fill]\non_piers = false\n")
}

fn check(text: &str) -> VerifySummary {
    let check = verify(&parsed(text)).unwrap_or_else(|error| panic!("{error}"));
    has_the_words_of_its_json(&check);
    check
}

#[track_caller]
fn has_the_words_of_its_json(check: &VerifySummary) {
    let json = serde_json::to_string(check).unwrap();
    let again = words_of_json::<VerifySummary>(&serde_json::from_str(&json).unwrap()).unwrap();
    assert_eq!(again, words(check).trim_end());
    let read: VerifySummary = serde_json::from_str(&json).unwrap();
    for (state, one) in &check.states {
        assert_eq!(read.states[state].demand, one.demand);
    }
}

fn side(check: &VerifySummary, state: LimitState, sway: Sway) -> &SideCheck {
    &check.states[&state].sides[&sway]
}

/// The governing side, method and result of a state.
fn governing(check: &VerifySummary, state: LimitState) -> Option<(GoverningSide, Method, f64)> {
    let one: &StateCheck = &check.states[&state];
    Some((one.side?, one.method?, one.zeta_e?))
}

fn displacement(check: &VerifySummary, state: LimitState, sway: Sway) -> DisplacementCheck {
    side(check, state, sway).displacement.unwrap()
}

/// Asserts a number to its last printed digit: half a unit, plus a millionth for the straight lines between a hundred points of
/// the curve.
#[track_caller]
fn printed(value: f64, expected: &str) {
    let digits = expected.split_once('.').map_or(0, |(_, after)| after.len());
    let unit = 0.1_f64.powi(i32::try_from(digits).unwrap());
    let known: f64 = expected.parse().unwrap();
    let allowed = 0.5 * unit + 5e-6 * known;
    assert!((value - known).abs() < allowed, "{value:?} {expected}");
}

/// The structures, each with a side.
fn cases() -> [(String, Sway); 4] {
    [
        (COLUMN.to_owned(), Sway::Right),
        (ARCH.to_owned(), Sway::Right),
        (on_piers(), Sway::Right),
        (on_piers(), Sway::Left),
    ]
}

#[test]
fn c8_7_1_2_1_5_and_7_activation_and_its_multiple() {
    let expected = [
        ["0.14815", "0.12346", "0.05308", "0.98765", "0.42465"],
        ["0.12192", "0.10160", "0.04368", "0.81283", "0.34948"],
        ["0.22241", "0.18534", "0.07969", "1.48272", "0.63750"],
        ["0.12906", "0.10755", "0.04624", "0.86037", "0.36992"],
    ];
    for ((structure, sway), [a0, ground, height, zeta, zeta_height]) in cases().iter().zip(expected)
    {
        let at_ground = check(&format!("{structure}{DEMAND}"));
        let at_height = check(&format!("{structure}{DEMAND}{HEIGHT}"));
        printed(at_ground.mechanisms[sway].a0_over_fc_g, a0);
        for (check, ag_g, zeta_e) in [(at_ground, ground, zeta), (at_height, height, zeta_height)] {
            let sld = side(&check, LimitState::Sld, *sway).activation.unwrap();
            printed(sld.margin.ag_capacity_g.unwrap(), ag_g);
            let slv = side(&check, LimitState::Slv, *sway).simplified.unwrap();
            printed(slv.margin.zeta_e, zeta_e);
            assert!(side(&check, LimitState::Slc, *sway).simplified.is_none());
        }
    }
}

#[test]
fn c8_7_1_2_1_8_displacements_on_the_ground_and_at_a_height() {
    // d, a, T; on the ground: demand, a_g capacity, zeta_E, a_g with varying shape; at the height: demand, a_g capacity, zeta_E.
    let expected = [
        [
            "0.16000", "0.087773", "2.27513", "0.16391", "0.24404", "0.97616", "0.24254",
            "0.20832", "0.19201", "0.76805",
        ],
        [
            "0.24000", "0.058288", "3.17509", "0.24177", "0.31766", "0.99269", "0.31798",
            "0.37680", "0.20382", "0.63694",
        ],
        [
            "0.04981", "0.070051", "1.42097", "0.10237", "0.12165", "0.48659", "0.11759",
            "0.15994", "0.07786", "0.31144",
        ],
        [
            "0.07472", "0.045812", "1.99832", "0.16775", "0.14253", "0.44541", "0.12904",
            "0.27681", "0.08638", "0.26992",
        ],
        [
            "0.17597", "0.128656", "1.97073", "0.14198", "0.30985", "1.23940", "0.33258",
            "0.19117", "0.23012", "0.92049",
        ],
        [
            "0.26395", "0.085181", "2.75443", "0.23123", "0.36529", "1.14153", "0.38986",
            "0.34212", "0.24688", "0.77152",
        ],
        [
            "0.05457", "0.073256", "1.45435", "0.10478", "0.13020", "0.52080", "0.12586",
            "0.16183", "0.08430", "0.33718",
        ],
        [
            "0.08185", "0.047724", "2.04921", "0.17202", "0.15226", "0.47581", "0.13785",
            "0.28136", "0.09309", "0.29091",
        ],
    ];
    let mut rows = expected.iter();
    for (structure, sway) in cases() {
        let ground = check(&format!("{structure}{DEMAND}"));
        let height = check(&format!("{structure}{DEMAND}{HEIGHT}"));
        for state in [LimitState::Slv, LimitState::Slc] {
            let [d, a, t, demand, ag, zeta, following, demand_h, ag_h, zeta_h] =
                rows.next().unwrap();
            let own = displacement(&ground, state, sway);
            printed(own.capacity_m, d);
            printed(own.acceleration_g, a);
            printed(own.period_s, t);
            printed(own.demand_m, demand);
            printed(own.by_displacement_ag_g.unwrap(), ag);
            printed(own.margin.zeta_e, zeta);
            printed(own.ag_capacity_following_g.unwrap(), following);
            let above = displacement(&height, state, sway);
            assert_eq!(
                (above.capacity_m, above.period_s),
                (own.capacity_m, own.period_s)
            );
            printed(above.demand_m, demand_h);
            printed(above.by_displacement_ag_g.unwrap(), ag_h);
            printed(above.margin.zeta_e, zeta_h);
            assert_eq!(above.ag_capacity_following_g, None);
        }
    }
}

#[test]
fn c8_7_1_2_1_the_control_point_at_the_crown() {
    let d0 = ["0.39612", "0.13007", "0.48103", "0.14566"];
    let zeta_e = ["0.97332", "0.49300", "1.27654", "0.53135"];
    for (((structure, sway), d0), zeta_e) in cases().iter().zip(d0).zip(zeta_e) {
        let check = check(&format!("{structure}{DEMAND}"));
        let way = check.mechanisms[sway].curves.as_ref().unwrap();
        let crown = way.crown.as_ref().unwrap();
        printed(crown.end().oscillator_displacement_m, d0);
        let own = displacement(&check, LimitState::Slv, *sway);
        printed(own.zeta_e_crown.unwrap(), zeta_e);
        // The displacement of the crown itself does not depend on the grouping of masses.
        let scenario = parsed(&format!("{structure}{DEMAND}"));
        let grouped = archrock::studies::capacity(&scenario, None).unwrap();
        let grouped = grouped.get(*sway).as_ref().unwrap();
        let ratio = grouped.end().displacement_m / crown.end().displacement_m;
        assert!((ratio - 1.0).abs() < 1e-12);
    }
}

/// The worse side counts; if a wall holds the other side, only one does.
#[test]
fn the_worse_side_governs_unless_a_wall_holds_it() {
    let text = format!("{}{DEMAND}", on_piers());
    let both = check(&text);
    let (side, method, zeta_e) = governing(&both, LimitState::Slv).unwrap();
    assert_eq!((side, method), (GoverningSide::Left, Method::Displacement));
    printed(zeta_e, "0.52080");
    printed(both.zeta_e.unwrap(), "0.47581");
    let right = check(&format!("{text}[verify]\nsides = 'right'\n"));
    assert_eq!(right.mechanisms.len(), 1);
    printed(right.zeta_e.unwrap(), "1.14153");
    let (side, method, zeta_e) = governing(&right, LimitState::Slv).unwrap();
    assert_eq!((side, method), (GoverningSide::Right, Method::Displacement));
    printed(zeta_e, "1.23940");
    shows(&words(&right), &[zeta_e]);
}

/// T_0 of C8.7.1.7, the acceleration demanded at that period, and the end of the elastic branch. The check by displacement, which
/// is far beyond that branch, is that of a column held by walls.
#[test]
fn c8_7_1_6_to_9_a_column_that_is_free_to_vibrate() {
    let text = format!("{COLUMN}{DEMAND}");
    let given =
        "[verify.free_standing]\nkappa = 6.2\nlength_m = 4\nthickness_m = 0.8\nmodulus_gpa = 1.5\n";
    let free = check(&format!("{text}{given}"));
    printed(free.t0_s.unwrap(), "0.14318");
    let sld = side(&free, LimitState::Sld, Sway::Right)
        .activation
        .unwrap();
    printed(sld.demand_g, "0.288");
    printed(sld.margin.ag_capacity_g.unwrap(), "0.05144");
    let mechanism = &free.mechanisms[&Sway::Right];
    let (d_y_m, a_y_g) = (mechanism.d_y_m.unwrap(), mechanism.a_y_over_fc_g.unwrap());
    printed(d_y_m, "0.000753");
    let circular = free.t0_s.unwrap() / (2.0 * std::f64::consts::PI);
    assert!((d_y_m / (circular * circular * 9.81) / a_y_g - 1.0).abs() < 1e-9);
    let held = check(&text);
    let slv = |check: &VerifySummary| {
        displacement(check, LimitState::Slv, Sway::Left)
            .margin
            .zeta_e
    };
    assert_eq!(slv(&free), slv(&held));
    let known = check(&format!(
        "{text}[verify]\nfree_standing = {{ t0_s = 0.14318 }}\n"
    ));
    let ag_g = |check: &VerifySummary| {
        side(check, LimitState::Sld, Sway::Left)
            .activation
            .unwrap()
            .margin
            .ag_capacity_g
            .unwrap()
    };
    assert!((ag_g(&known) / ag_g(&free) - 1.0).abs() < 1e-9);
}

/// The displacement capacity of a stout column is reached before motion starts: then the onset counts.
#[test]
fn c8_7_1_2_1_8_a_capacity_reached_before_onset_counts_as_the_onset() {
    let text = format!("[column]\nheight_m = 0.3\nwidth_m = 0.12\n{DEMAND}");
    let check = check(&text);
    let slv = displacement(&check, LimitState::Slv, Sway::Right);
    let start_g = slv.activation_ag_g.unwrap();
    assert!(start_g > slv.by_displacement_ag_g.unwrap());
    assert!((slv.margin.zeta_e - start_g / 0.25).abs() < 1e-12);
    shows(&words(&check), &[slv.margin.zeta_e]);
    let json = serde_json::to_value(&check).unwrap();
    assert_eq!(json["states"]["slv"]["method"], "activation");
    assert_eq!(json["states"]["slv"]["side"], "either");
    // The row of the page has the accelerations that are compared, not the displacements.
    let html = page(&parsed(&text), &check);
    let row = html
        .split("<tr class=\"counts\">")
        .find(|row| row.contains(">SLV<"));
    let row = row.unwrap().split("</tr>").next().unwrap();
    assert!(
        row.contains(&format!("{:.4}</data> g</td>", start_g)),
        "{row}"
    );
    assert!(
        row.contains("0.2500</data> g</td>") && !row.contains(" m</td>"),
        "{row}"
    );
}

/// The table of the file; the code's own numbers for it are FC 1.35, 0.4 d0, 1.68, 8 %.
const POINTS: &str =
    "period_s,acceleration_g\n0,0.29\n0.15,0.70\n0.5,0.70\n1,0.35\n2,0.20\n2.6,0.08\n4,0.03\n";

fn in_folder(structure: &str, demand: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("slv.csv"), POINTS).unwrap();
    std::fs::write(folder.path().join("a.toml"), format!("{structure}{demand}")).unwrap();
    folder
}

#[test]
fn a_spectrum_of_points_names_no_clause() {
    let demand = "[demand.slv]\nspectrum = 'slv.csv'\n[demand.sld]\nspectrum = 'slv.csv'\n";
    let folder = in_folder(COLUMN, demand);
    let path = folder.path().join("a.toml");
    let scenario = Scenario::read(&path).unwrap();
    let check = verify(&scenario).unwrap();
    has_the_words_of_its_json(&check);
    let slv = displacement(&check, LimitState::Slv, Sway::Right);
    printed(slv.demand_m, "0.17435");
    printed(slv.zeta_e_by_displacement(), "0.91768");
    let sld = side(&check, LimitState::Sld, Sway::Right)
        .activation
        .unwrap();
    assert!(
        (
            sld.demand_g,
            side(&check, LimitState::Slv, Sway::Left).simplified
        ) == (0.29, None)
    );
    let json = serde_json::to_value(&check).unwrap();
    assert_eq!(json["formulas"], Value::Null);
    assert!(!words(&check).contains("C8.7"));
    // The resolved scenario reads back the same, in its folder.
    let resolved = folder.path().join("b.toml");
    std::fs::write(&resolved, scenario.to_toml()).unwrap();
    assert_eq!(Scenario::read(&resolved).unwrap(), scenario);
    // Other rules: a without FC, T by 1.6 pi, d divided.
    let rule = "state = { part_of_d0 = 0.4, period_factor = 1.6, damping_percent = 5, divide_acceleration = 1, \
                divide_displacement = 1.55 }\n";
    let folder = in_folder(
        COLUMN,
        &format!("[demand.slv]\nspectrum = 'slv.csv'\n{rule}"),
    );
    let check = verify(&Scenario::read(&folder.path().join("a.toml")).unwrap()).unwrap();
    let other = displacement(&check, LimitState::Slv, Sway::Right);
    assert!((other.capacity_m * 1.55 / slv.capacity_m - 1.0).abs() < 1e-12);
    let period_s = slv.period_s / 1.68 * 1.6 / 1.35_f64.sqrt();
    assert!((other.period_s / period_s - 1.0).abs() < 1e-12);
}

#[test]
fn spectra_of_points_are_refused_beyond_their_range() {
    let short = POINTS.replace("2.6,0.08\n4,0.03\n", "");
    let early = POINTS.replace("0,0.29\n0.15", "0.15");
    for (points, demand, words) in [
        (
            &*short,
            "[demand.slv]\nspectrum = 'slv.csv'\n",
            &["[demand.slv]", "from 0.0 to 2.0 s", "add rows"][..],
        ),
        (
            &*early,
            "[demand.slv]\nspectrum = 'slv.csv'\n[demand.sld]\nspectrum = 'slv.csv'\n",
            &["[demand.sld]", "needed at 0.0 s"],
        ),
        (
            "period_s,acceleration_g\n0,0.3\n",
            "[demand.slv]\nspectrum = 'slv.csv'\n",
            &["a.toml:5:12", "fewer than two rows"],
        ),
        (
            "period_s,acceleration_g\n0,0.3\n1,0.2\n1,0.1\n",
            "[demand.slv]\nspectrum = 'slv.csv'\n",
            &["a.toml:5:12", "slv.csv:4", "not above the one before"],
        ),
        (
            POINTS,
            "[demand]\nsoil = 'B'\n[demand.slv]\nspectrum = 'slv.csv'\n",
            &["a.toml:5:8", "`soil = 'B'` applies to ag_g"],
        ),
        (
            POINTS,
            "[demand.sld]\nspectrum = 'slv.csv'\n",
            &["nothing to check beyond damage"],
        ),
        (
            POINTS,
            "[demand.slv]\nspectrum = 'other.csv'\n",
            &["a.toml:5:12", "cannot be read"],
        ),
    ] {
        let folder = in_folder(COLUMN, demand);
        std::fs::write(folder.path().join("slv.csv"), points).unwrap();
        refused(folder.path(), &["verify", "a.toml"], words);
    }
}

/// Each error has its place, clause and range.
#[test]
fn input_outside_the_range_of_the_code_is_refused() {
    for (from, to, words) in [
        (
            "f0 = 2.40",
            "f0 = 2.1",
            &["a.toml:9:6", "2.2 (NTC 2018, § 3.2.1)"][..],
        ),
        (
            "ag_g = 0.25",
            "ag_g = 0.9",
            &["a.toml:12:8", "at most 0.85 on soil B", "§ 3.2.3.2"],
        ),
        (
            "ag_g = 0.25",
            "ag_g = 25",
            &["a.toml:12:8", "out of range", "at most 0.85", "§ 3.2.3.2"],
        ),
        (
            "ag_g = 0.25",
            "ag_g = 0",
            &["a.toml:12:8", "above 0 (NTC 2018, § 3.2)"],
        ),
        (
            "f0 = 2.40",
            "f0 = 12",
            &["a.toml:9:6", "2.2 (NTC 2018, § 3.2.1) to 10"],
        ),
        (
            "tc_star_s = 0.35",
            "tc_star_s = 3.5",
            &["a.toml:14:13", "Tab. 3.2.IV"],
        ),
        (
            "soil = 'B'",
            "soil = 'S1'",
            &["a.toml:5:8", "one of \"A\", \"B\", \"C\", \"D\", \"E\""],
        ),
        (
            "topography = 'T1'",
            "topographic_factor = 0.5",
            &["a.toml:6:22", "from 1 to 2 (NTC 2018, Tab. 3.2.V"],
        ),
        ("topography = 'T1'", "", &["topography, topographic_factor"]),
        (
            "tc_star_s = 0.35",
            "tc_star = 0.35",
            &["did you mean `tc_star_s`", "lacks `tc_star_s`"],
        ),
        (
            "slv = { t_s = 0.45, damping_percent = 10 }, ",
            "",
            &["lacks `slv`", "damping_percent"],
        ),
        (
            "damping_percent = 15",
            "damping_percent = 50",
            &["out of range", "at most 30"],
        ),
        ("modes", "modi", &["lacks `modes`"]),
    ] {
        let text = format!("{COLUMN}{DEMAND}{HEIGHT}");
        assert!(text.contains(from), "{from}");
        let folder = in_folder(&text.replacen(from, to, 1), "");
        refused(folder.path(), &["verify", "a.toml"], words);
    }
    let folder = in_folder(COLUMN, "");
    refused(
        folder.path(),
        &["verify", "a.toml"],
        &["a.toml: the scenario has no [demand]", "[demand.slv]"],
    );
    let folder = in_folder(
        COLUMN,
        &format!("{DEMAND}[verify]\nconfidence_factor = 0.9\n"),
    );
    refused(
        folder.path(),
        &["verify", "a.toml"],
        &["a.toml:20:21", "from 1 to 2", "Tab. C8.5.IV"],
    );
    let folder = in_folder(
        COLUMN,
        &format!("{DEMAND}[verify]\nbehaviour_factor = 0.9\n"),
    );
    refused(
        folder.path(),
        &["verify", "a.toml"],
        &["a.toml:20:20", "from 1 to 5", "C8.7.1.2.1.7"],
    );
}

/// Locks before its multiplier reaches zero.
const LOCKS: &str = "[pointed_arch]\nspan_m = 2.02\nrise_m = 1.46\nthickness_m = 0.6\nvoussoirs = 6\n\
    [piers]\nheight_m = 2.62\nwidth_m = 2.09\nblocks = 2\n";
const DRUMS: &str = "[column]\nheight_m = 4\nwidth_m = 0.8\ndrums = 5\n[free_hinges]\n";

/// A tie of 5 kN at 3.5 m on a column of 4 m by 0.8 m: by hand `alpha0` is 0.33937 to the right, against the tie.
const TIED: &str = "[column]\nheight_m = 4\nwidth_m = 0.8\n[[tie]]\nfrom_m = [0.0, 3.5]\nto_m = [-4.0, 3.5]\n\
    stiffness_n_m = 1e6\nprestress_n = 5000\nto_block = 0\n";

/// With ties there is no curve: only the damage limit state and its multiple can be checked.
#[test]
fn c8_7_1_2_1_7_without_a_curve_there_is_the_simplified_check() {
    let check = check(&format!("{TIED}{DEMAND}"));
    for mechanism in check.mechanisms.values() {
        assert!(mechanism.curves.is_none() && mechanism.no_curve.is_some());
    }
    printed(check.mechanisms[&Sway::Right].alpha0, "0.33937");
    let (_, method, _) = governing(&check, LimitState::Slv).unwrap();
    assert_eq!(method, Method::Simplified);
    assert_eq!(governing(&check, LimitState::Slc), None);
    golden("verify-without-curve", &words(&check));
    let only = DEMAND.split_once("[demand.slc]").unwrap().1;
    let only = format!("{TIED}[demand]\nsoil = 'B'\ntopography = 'T1'\n[demand.slc]{only}");
    let error = verify(&parsed(&only)).unwrap_err();
    assert!(matches!(error, VerifyError::NoCurve(_)));
    assert!(error.to_string().contains("C8.7.1.2.1.7"), "{error}");
    // If one side is checked, the first sentence names it: the column does not pass to the left.
    for (side, passes) in [("right", true), ("left", false)] {
        let sides = format!("{TIED}{DEMAND}[verify]\nsides = '{side}'\n");
        let said = words(&verify(&parsed(&sides)).unwrap());
        let first = said.split_once('.').unwrap().0;
        assert!(
            first.contains(side) && first.contains("passes") == passes,
            "{first}"
        );
    }
}

/// A column that is cut into drums, given as blocks or tapered turns about its toe as one block. Its curve is that of the block: with the
/// centre of mass at the height `h` and the distance `b` from the toe, `alpha0 = b / h` and `d0 = b`, and `alpha` falls as the tangent of an
/// angle.
#[test]
fn c8_7_1_2_1_3_a_stack_on_one_support_is_a_block_about_its_toe() {
    let column = check(&format!("{COLUMN}{DEMAND}"));
    let drums = check(&format!("{DRUMS}{DEMAND}"));
    for state in [LimitState::Sld, LimitState::Slv, LimitState::Slc] {
        for sway in [Sway::Right, Sway::Left] {
            let [own, block] =
                [&drums, &column].map(|check| side(check, state, sway).governing_result());
            let ((method, own), (same, block)) = (own.unwrap(), block.unwrap());
            assert_eq!(method, same);
            assert!((own.zeta_e / block.zeta_e - 1.0).abs() < 1e-9);
        }
    }
    let [own, block] = [&drums, &column].map(|check| &check.mechanisms[&Sway::Right]);
    assert_eq!(own.bodies.len(), 1);
    let delta = |one: &CheckedMechanism| Vector2::new(one.bodies[0].delta_x, one.bodies[0].delta_y);
    assert!((delta(own) - delta(block)).norm() < 1e-9);
    let crowns = [own, block].map(|one| {
        let way = one.curves.as_ref().unwrap();
        assert!((way.friction_up_to(0.6) - 0.2).abs() < 1e-9);
        way.crown.as_ref().unwrap().end().displacement_m
    });
    assert!((crowns[0] / crowns[1] - 1.0).abs() < 1e-9);

    // A parallelogram of 3 m by 0.8 m that leans 0.2 m to the left, and a taper from 1 m to 0.6 m.
    let folder = in_folder("[blocks]\njoints = 'lean.csv'\nsupports = 'left'\n", DEMAND);
    std::fs::write(
        folder.path().join("lean.csv"),
        "-0.3,0,0.5,0\n-0.5,3,0.3,3\n",
    )
    .unwrap();
    let leaning = verify(&Scenario::read(&folder.path().join("a.toml")).unwrap()).unwrap();
    let taper = "[column]\nheight_m = 3\nwidth_m = 1\ntop_width_m = 0.6\n[free_hinges]\n";
    let taper = check(&format!("{taper}{DEMAND}"));
    let taper_centre_m = 3.0 * (1.0 + 2.0 * 0.6) / (3.0 * (1.0 + 0.6));
    for (check, sway, b_m, h_m) in [
        (&leaning, Sway::Right, 0.5, 1.5),
        (&leaning, Sway::Left, 0.3, 1.5),
        (&taper, Sway::Right, 0.5, taper_centre_m),
        (&taper, Sway::Left, 0.5, taper_centre_m),
    ] {
        let mechanism = &check.mechanisms[&sway];
        let way = mechanism.curves.as_ref().unwrap();
        let (alpha0, slenderness) = (b_m / h_m, f64::atan2(b_m, h_m));
        assert!((mechanism.alpha0 / alpha0 - 1.0).abs() < 1e-9);
        assert!((way.centre.end().oscillator_displacement_m / b_m - 1.0).abs() < 1e-9);
        assert!((way.friction_up_to(1.0) / alpha0 - 1.0).abs() < 1e-9);
        for point in &way.centre.curve {
            let alpha = (slenderness - point.q_rad).tan();
            assert!((point.oscillator_acceleration_g - alpha).abs() < 1e-9);
            let radius_m = f64::hypot(b_m, h_m);
            let d_m = b_m - radius_m * (slenderness - point.q_rad).sin();
            assert!((point.oscillator_displacement_m - d_m).abs() < 1e-9);
        }
    }
    let (side, _, zeta_e) = governing(&leaning, LimitState::Slv).unwrap();
    assert_eq!(side, GoverningSide::Left);
    printed(zeta_e, "0.84538");
    shows(&words(&leaning), &[zeta_e]);
    let (_, method, _) = governing(&taper, LimitState::Slv).unwrap();
    assert_eq!(method, Method::Displacement);
}

/// An arch that needs a friction coefficient of 0.590, with less.
const SLIPS: &str = "[arch]\nmean_radius_m = 5\nthickness_ratio = 0.2\nembrace_deg = 180\nvoussoirs = 20\n\
    [free_hinges]\nfriction_coefficient = 0.42\n";

/// A block with its centre at a distance of 1.2 m from its right toe and 0.3 m from its left one, 1.5 m high: it slides to the right at the
/// coefficient of the Circolare, and rocks to the left from 0.2 g.
const ECCENTRIC: &str = "[blocks]\njoints = 'block.csv'\nsupports = 'left'\n";

fn eccentric(demand: &str) -> tempfile::TempDir {
    let folder = in_folder(ECCENTRIC, demand);
    let joints = "-0.3,0,1.2,0\n-1.2,3,0.3,3\n";
    std::fs::write(folder.path().join("block.csv"), joints).unwrap();
    folder
}

/// The demand of SLV alone.
fn slv(ag_g: f64) -> String {
    format!(
        "[demand]\nsoil = 'B'\ntopography = 'T1'\n[demand.slv]\nag_g = {ag_g}\nf0 = 2.40\ntc_star_s = 0.35\n"
    )
}

/// Asserts that joints slide first to a side: at this acceleration at most, with no other result.
#[track_caller]
fn slides(check: &VerifySummary, sway: Sway, known_g: f64, within_g: f64) {
    let sliding = check.mechanisms[&sway].sliding.unwrap();
    assert!((sliding.bound_g - known_g).abs() < within_g, "{sliding:?}");
    assert!(sliding.bound_g < check.mechanisms[&sway].alpha0);
    assert_eq!(check.mechanisms[&sway].d0_m, None);
    assert_eq!(check.zeta_e, None);
    assert!(check.no_zeta_e_because.is_some());
    for (state, one) in &check.states {
        let own = &one.sides[&sway];
        let expected = SideCheck {
            sliding: own.sliding,
            ..SideCheck::default()
        };
        assert_eq!(own, &expected);
        let compared = own.sliding.unwrap();
        assert_eq!(compared.bound_g, sliding.bound_g);
        let verdict = match compared.demand_g > sliding.bound_g {
            true => CheckVerdict::NotPassed,
            false => CheckVerdict::NoAnswer,
        };
        assert_eq!((compared.verdict, own.verdict()), (verdict, verdict));
        assert_eq!((one.zeta_e, &one.histories), (None, &None));
        assert_ne!(check.verdict[state], CheckVerdict::Passed);
    }
}

/// The least multiplier counts. If joints slide first, only an upper bound of it is known.
#[test]
fn c8_7_1_1_joints_that_slide_first_have_an_upper_bound() {
    let lintel = "[arch]\nmean_radius_m = 5\nthickness_ratio = 0.3\nembrace_deg = 90\nvoussoirs = 5\n[free_hinges]\n";
    // A block slides at its coefficient, if that is less than its slenderness; a linkage that locks before it overturns slides as well.
    let squat = COLUMN.replace("width_m = 0.8", "width_m = 2.8");
    for (structure, known_g, within_g) in [
        (squat.as_str(), 0.577, 1e-7),
        (LOCKS, 0.4288, 5e-5),
        (lintel, 3.066, 5e-4),
    ] {
        let check = check(&format!("{structure}{DEMAND}"));
        for sway in [Sway::Right, Sway::Left] {
            slides(&check, sway, known_g, within_g);
        }
        assert!(check.is_symmetric);
    }
    let slender = check(&format!("{COLUMN}{DEMAND}"));
    assert!(slender.warnings.all().is_empty());
    assert!(slender.mechanisms.values().all(|one| one.sliding.is_none()));
}

/// Friction is compared with the smaller of 0.577 and the coefficient of the scenario.
#[test]
fn c8_7_1_1_the_friction_of_the_scenario_counts() {
    let squat = COLUMN.replace("width_m = 0.8", "width_m = 2");
    let with = |coefficient: f64| {
        format!("{squat}[free_hinges]\nfriction_coefficient = {coefficient}\n{DEMAND}")
    };
    let slipping = check(&with(0.3));
    slides(&slipping, Sway::Right, 0.3, 1e-7);
    assert_eq!(slipping.allowed_friction, 0.3);
    let enough = parsed(&with(0.52));
    let check_enough = verify(&enough).unwrap();
    assert!(check_enough.warnings.all().is_empty());
    let json = serde_json::to_value(&check_enough).unwrap();
    assert_eq!(json["allowed_friction"], 0.52);
    assert!(page(&enough, &check_enough).contains("0.52"));
    assert_eq!(check(&with(0.8)).allowed_friction, 0.577);
    // This arch needs 0.590. With a smaller coefficient it slides first, whether the coefficient is that of the scenario or of the Circolare, and
    // whether the arch has joints or is continuous.
    let arch = "[arch]\nmean_radius_m = 5\nthickness_ratio = 0.2\nembrace_deg = 180\n";
    let of = |more: &str| check(&format!("{arch}{more}{DEMAND}"));
    slides(
        &check(&format!("{SLIPS}{DEMAND}")),
        Sway::Left,
        0.1204,
        5e-5,
    );
    let without = of("voussoirs = 20\n");
    let more = of("voussoirs = 20\n[free_hinges]\nfriction_coefficient = 0.7\n");
    assert_eq!(without.states, more.states);
    for check in [without, of("")] {
        slides(&check, Sway::Right, 0.2725, 1e-3);
    }
    // A block on a bed with a slope of 0.7 slides under its own weight.
    let folder = in_folder(
        "[blocks]\njoints = 'slope.csv'\nsupports = 'left'\n",
        DEMAND,
    );
    let joints = "-0.5,-0.35,0.5,0.35\n-0.5,1,0.5,1\n";
    std::fs::write(folder.path().join("slope.csv"), joints).unwrap();
    let sloping = verify(&Scenario::read(&folder.path().join("a.toml")).unwrap()).unwrap();
    for sway in [Sway::Right, Sway::Left] {
        slides(&sloping, sway, 0.0, 1e-12);
    }
    let verdicts = sloping.verdict.values();
    assert_eq!(
        verdicts
            .filter(|one| **one == CheckVerdict::NotPassed)
            .count(),
        3
    );
    assert!(words(&sloping).contains("joints slide under the weight of the structure"));
}

/// A demand above the bound is not passed; below it there is no answer, and never a passed check. The demand is the peak of the ground, of the
/// floor, or the spectral acceleration of a structure that is free to vibrate.
#[test]
fn c8_7_1_1_the_demand_is_compared_with_the_bound_of_sliding() {
    let bound_g = check(&format!("{SLIPS}{DEMAND}")).mechanisms[&Sway::Right]
        .sliding
        .unwrap()
        .bound_g;
    // S = 1.2 for these accelerations.
    for (part, verdict) in [
        (0.01, CheckVerdict::NoAnswer),
        (0.999, CheckVerdict::NoAnswer),
        (1.001, CheckVerdict::NotPassed),
        (1.9, CheckVerdict::NotPassed),
    ] {
        let check = check(&format!("{SLIPS}{}", slv(part * bound_g / 1.2)));
        assert_eq!(check.verdict[&LimitState::Slv], verdict, "{part}");
        let compared = side(&check, LimitState::Slv, Sway::Right).sliding.unwrap();
        assert!((compared.demand_g / bound_g - part).abs() < 1e-9);
        let said = words(&check);
        assert_eq!(
            said.contains("no answer: 0.1204 g is an upper bound"),
            verdict == CheckVerdict::NoAnswer,
            "{said}"
        );
        assert!(
            !said.contains("passed: zeta_E") && !said.contains("displacement:"),
            "{said}"
        );
        assert_eq!(check.states[&LimitState::Slv].method, Some(Method::Sliding));
        assert_eq!(
            check.states[&LimitState::Slv].side,
            Some(GoverningSide::Either)
        );
    }
    let at_height = check(&format!("{SLIPS}{DEMAND}{HEIGHT}"));
    let compared = side(&at_height, LimitState::Sld, Sway::Right)
        .sliding
        .unwrap();
    printed(compared.demand_g, "0.27910");
    let free = "[verify]\nfree_standing = { t0_s = 0.143178 }\n";
    let free = check(&format!("{SLIPS}{DEMAND}{free}"));
    let compared = side(&free, LimitState::Sld, Sway::Right).sliding.unwrap();
    printed(compared.demand_g, "0.288");
}

/// Each side has its own answer. A side that fails decides; otherwise a side without an answer.
#[test]
fn c8_7_1_1_joints_slide_to_one_side_only() {
    let checked = |ag_g: f64, more: &str| {
        let folder = eccentric(&format!("{}{more}", slv(ag_g)));
        let check = verify(&Scenario::read(&folder.path().join("a.toml")).unwrap()).unwrap();
        has_the_words_of_its_json(&check);
        check
    };
    let of_slv = LimitState::Slv;
    // The left side alone has d0 = 0.3 m.
    let left = checked(0.25, "[verify]\nsides = 'left'\n");
    let alone = left.zeta_e.unwrap();
    assert!((left.mechanisms[&Sway::Left].d0_m.unwrap() - 0.3).abs() < 1e-9);
    let passes = checked(0.25 * alone * 0.9, "");
    slides(&passes, Sway::Right, 0.577, 1e-7);
    assert_eq!(
        side(&passes, of_slv, Sway::Left).verdict(),
        CheckVerdict::Passed
    );
    assert!(side(&passes, of_slv, Sway::Left).zeta_e.unwrap() > 1.0);
    assert_eq!(passes.verdict[&of_slv], CheckVerdict::NoAnswer);
    assert_eq!(passes.states[&of_slv].side, Some(GoverningSide::Right));
    let said = words(&passes);
    assert!(
        said.contains("no answer: 0.5770 g is an upper bound, to the right"),
        "{said}"
    );

    let fails = checked(0.25, "");
    slides(&fails, Sway::Right, 0.577, 1e-7);
    assert_eq!(
        side(&fails, of_slv, Sway::Right).verdict(),
        CheckVerdict::NoAnswer
    );
    assert_eq!(side(&fails, of_slv, Sway::Left).zeta_e, Some(alone));
    assert_eq!(fails.verdict[&of_slv], CheckVerdict::NotPassed);
    assert_eq!(fails.states[&of_slv].method, Some(Method::Displacement));
    assert_eq!(fails.states[&of_slv].side, Some(GoverningSide::Left));
    assert_eq!(fails.states[&of_slv].zeta_e, None);
    assert!(!fails.is_symmetric);

    let right = checked(0.25, "[verify]\nsides = 'right'\n");
    assert_eq!(right.verdict[&of_slv], CheckVerdict::NoAnswer);
    slides(&right, Sway::Right, 0.577, 1e-7);
    // Both fail: the bound is a smaller part of its demand than the displacement.
    let high = checked(
        0.25,
        "[demand.height]\nmodes = [{ gamma = 4, psi = 1, slv = { t_s = 0.4, damping_percent = 5 } }]\n",
    );
    assert_eq!(high.verdict[&of_slv], CheckVerdict::NotPassed);
    assert_eq!(
        side(&high, of_slv, Sway::Right).verdict(),
        CheckVerdict::NotPassed
    );
    assert_eq!(
        side(&high, of_slv, Sway::Left).verdict(),
        CheckVerdict::NotPassed
    );
}

/// The program ends with exit code 0; words, JSON and page in both languages have the reason. Histories are not computed.
#[test]
fn verify_reports_joints_that_slide_first() {
    let folder = in_folder(SLIPS, DEMAND);
    let said = print_of(folder.path(), &["verify", "a.toml"]);
    golden("verify-slides", &said);
    let output = archrock(folder.path(), &["verify", "a.toml", "--format", "json"]);
    assert_eq!(output.status.code(), Some(0));
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(json["zeta_e"].is_null() && json.as_object().unwrap().contains_key("zeta_e"));
    let why = json["no_zeta_e_because"].as_str().unwrap();
    shows(why, &[0.12044, 0.28520, 0.42]);
    assert_eq!(json["verdict"]["sld"], "no_answer");
    assert_eq!(json["verdict"]["slv"], "not_passed");
    for state in ["sld", "slv", "slc"] {
        let one = &json["states"][state];
        assert!(one["zeta_e"].is_null() && one["right"]["displacement"].is_null());
        assert_eq!(one["method"], "sliding");
        shows(
            &said,
            &[one["right"]["sliding"]["demand_g"].as_f64().unwrap()],
        );
    }
    let page = std::fs::read_to_string(folder.path().join("results/a/verify.html")).unwrap();
    assert!(page.contains(why) && page.contains("is never passed"));
    let italian = [
        "verify",
        "a.toml",
        "--set",
        "verify.language=it",
        "--out",
        "o",
    ];
    golden("verify-slides-it", &print_of(folder.path(), &italian));
    let page = std::fs::read_to_string(folder.path().join("o/verify.html")).unwrap();
    assert!(page.contains("senza esito") && page.contains("mai soddisfatta"));

    let records = scenarios().join("records/wave-*.at2");
    let squat = COLUMN.replace("width_m = 0.8", "width_m = 2.8");
    let records = format!("{DEMAND}[verify]\nslv_records = '{}'\n", records.display());
    let folder = in_folder(&squat, &records);
    let said = print_of(folder.path(), &["verify", "a.toml", "--format", "json"]);
    let json: Value = serde_json::from_str(&said).unwrap();
    assert!(json["states"]["slv"]["histories"].is_null());
    assert_eq!(json["verdict"]["slv"], "no_answer");
    let warnings = json["warnings"].as_array().unwrap();
    assert_eq!(warnings.len(), 1);
    assert!(warnings[0].as_str().unwrap().contains("slv_records"));
}

/// Sides with a number that differs are printed one by one: a tie that holds one side, a leaning stack, a demand that only words of the
/// mechanism hide.
#[test]
fn the_page_shows_both_sides_if_they_differ() {
    let tied = "[[tie]]\nfrom_m = [0.0, 3.5]\nto_m = [-4.0, 3.5]\nstiffness_n_m = 1e6\nprestress_n = 5000\nto_block = 0\n";
    let arch_tie = "[[tie]]\nfrom_m = [-4.2, 2.5]\nto_m = [-7.0, 0.0]\nto_block = 0\nstiffness_n_m = 1e6\nprestress_n = 1000\n";
    let arch =
        "[arch]\nmean_radius_m = 5\nthickness_ratio = 0.15\nembrace_deg = 180\nvoussoirs = 36\n";
    for (structure, sides) in [
        (format!("{COLUMN}{tied}"), 2),
        (format!("{arch}{arch_tie}"), 2),
        (COLUMN.to_owned(), 1),
        (arch.to_owned(), 1),
        (DRUMS.to_owned(), 1),
    ] {
        let scenario = parsed(&format!("{structure}{DEMAND}"));
        let check = verify(&scenario).unwrap();
        let html = page(&scenario, &check);
        assert_eq!(html.contains("mirror image"), sides == 1, "{structure}");
        assert_eq!(html.contains("either side"), sides == 1, "{structure}");
        for sway in ["right", "left"] {
            assert_eq!(
                html.matches(&format!("<h3>To the {sway}</h3>")).count(),
                2 * (sides - 1)
            );
        }
        if sides == 2 {
            let worse = side(&check, LimitState::Sld, Sway::Left).zeta_e.unwrap();
            assert!(html.contains(&format!("{worse:?}")), "{structure}");
        }
    }
}

/// Input that is unlikely or ignored is a warning in words, on the page and in the JSON; the building of the page is named by the hashes of
/// its files.
#[test]
fn unlikely_and_ignored_input_causes_warnings() {
    let floor = HEIGHT
        .replace("damping_percent = 10", "damping_percent = 0.1")
        .replace("gamma = 1.2857142857142858", "gamma = -1.2857142857142858");
    let text = format!(
        "{COLUMN}[simulation]\nduration_s = 1\ngravity_m_s2 = 9.8\n{DEMAND}{floor}[uncertain]\nsamples = 10\n'column.width_m' = {{ from = 0.7, to = 0.9 }}\n"
    );
    let scenario = parsed(&text);
    let check = verify(&scenario).unwrap();
    let html = page(&scenario, &check);
    for words in ["0.1 %", "9.8 m/s2", "[uncertain]"] {
        let mut given = check.warnings.all().iter();
        assert!(
            given.any(|one| one.contains(words)),
            "{words}: {:?}",
            check.warnings
        );
        assert!(html.contains(words), "{words}");
    }
    assert_eq!(check.warnings.all().len(), 3);
    assert_eq!(check.top.name(), "top");
    assert!(html.contains("With the top as control point") && !html.contains("crown"));

    let folder = in_folder("[blocks]\njoints = 'j.csv'\nsupports = 'left'\n", DEMAND);
    let joints = "-0.4,0,0.4,0\n-0.4,4,0.4,4\n";
    std::fs::write(folder.path().join("j.csv"), joints).unwrap();
    let read = || {
        print_of(folder.path(), &["verify", "a.toml", "--out", "out"]);
        let json = std::fs::read_to_string(folder.path().join("out/verify.json")).unwrap();
        let json: Value = serde_json::from_str(&json).unwrap();
        let html = std::fs::read_to_string(folder.path().join("out/verify.html")).unwrap();
        for file in json["files"].as_array().unwrap() {
            assert!(html.contains(file["sha256"].as_str().unwrap()));
        }
        json["files"].clone()
    };
    let before = read();
    let sha256 = |bytes: &[u8]| {
        use sha2::{Digest as _, Sha256};
        let digest = Sha256::digest(bytes);
        digest
            .iter()
            .map(|byte| format!("{byte:02x}"))
            .collect::<String>()
    };
    assert_eq!(before[0]["file"], "a.toml");
    assert_eq!(
        before[0]["sha256"],
        sha256(&std::fs::read(folder.path().join("a.toml")).unwrap())
    );
    assert_eq!(before[1]["file"], "j.csv");
    assert_eq!(before[1]["sha256"], sha256(joints.as_bytes()));
    // The same joints in another file are another file.
    std::fs::write(
        folder.path().join("j.csv"),
        joints.replace("4,0.4,4", "4.0,0.4,4"),
    )
    .unwrap();
    let after = read();
    assert_eq!(after[0], before[0]);
    assert_ne!(after[1], before[1]);
}

#[test]
fn a_structure_that_does_not_stand_is_refused() {
    let thin = ARCH.replace("0.15", "0.08");
    let folder = in_folder(&thin, DEMAND);
    refused(
        folder.path(),
        &["verify", "a.toml"],
        &["cannot carry its own weight"],
    );
}

/// The command: words, JSON with the same numbers, files; a negative verdict is not a failure of the program.
#[test]
fn verify_prints_and_writes_the_check() {
    let folder = in_folder(ARCH, DEMAND);
    let said = print_of(folder.path(), &["verify", "a.toml"]);
    golden("verify", &said);
    let output = archrock(folder.path(), &["verify", "a.toml", "--format", "json"]);
    assert_eq!(output.status.code(), Some(0));
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    let file = std::fs::read(folder.path().join("results/a/verify.json")).unwrap();
    assert_eq!(file, output.stdout);
    assert_eq!(json["verdict"]["slv"], "not_passed");
    assert_eq!(json["verdict"]["sld"], "passed");
    for (state, known) in [("sld", "1.01604"), ("slv", "0.48659"), ("slc", "0.44541")] {
        let zeta_e = json["states"][state]["zeta_e"].as_f64().unwrap();
        printed(zeta_e, known);
        shows(&said, &[zeta_e]);
    }
    assert_eq!(json["states"]["slv"]["method"], "displacement");
    assert_eq!(json["states"]["slv"]["side"], "either");
    let scenario = Scenario::read(&folder.path().join("a.toml")).unwrap();
    let check = verify(&scenario).unwrap();
    assert_eq!(json["zeta_e"], check.zeta_e.unwrap());
    let own = displacement(&check, LimitState::Slv, Sway::Right);
    assert_eq!(
        json["states"]["slv"]["right"]["displacement"]["demand_m"],
        own.demand_m
    );
    assert_eq!(json["states"]["slv"]["demand"]["s_s"], 1.16);
    // The hash is that of the output of `check`.
    let resolved = print_of(folder.path(), &["check", "a.toml"]);
    assert_eq!(resolved, scenario.to_resolved_toml());
    assert_eq!(json["scenario_sha256"].as_str().unwrap().len(), 64);
    // alpha0 by hand, from the table of the bodies.
    let bodies = json["mechanisms"]["right"]["bodies"].as_array().unwrap();
    let sum = |key: &str| -> f64 {
        let each = bodies
            .iter()
            .map(|body| body["weight_kn"].as_f64().unwrap() * body[key].as_f64().unwrap());
        each.sum()
    };
    let alpha0 = json["mechanisms"]["right"]["alpha0"].as_f64().unwrap();
    assert!((sum("delta_y") / sum("delta_x") / alpha0 - 1.0).abs() < 1e-12);
    assert!(!said.contains("complian") && !json.to_string().contains("complian"));
    // Resolved scenarios read back the same.
    for text in [
        DEMAND.to_owned(),
        format!("{DEMAND}{HEIGHT}[verify]\nsides = 'left'\nfree_standing = {{ t0_s = 0.1 }}\n"),
    ] {
        let own = parsed(&format!("{COLUMN}{text}"));
        assert_eq!(parsed(&own.to_toml()), own);
    }
}

/// Returns the page of a check, after it has been made again from its JSON alone.
fn page(scenario: &Scenario, check: &VerifySummary) -> String {
    let page = VerifyPage::new(scenario, check, Some("2025-01-31".to_owned()));
    let json = serde_json::to_string(&page).unwrap();
    assert_eq!(page_of(&json).unwrap(), page.html());
    page.html()
}

/// The words of all limit states and structures are functions of the JSON of the page.
#[test]
fn the_page_is_rendered_again_from_its_json() {
    for text in [
        format!("{ARCH}{DEMAND}"),
        format!("{}{DEMAND}{HEIGHT}", on_piers()),
        format!("{COLUMN}{DEMAND}[verify]\nsides = 'right'\nfree_standing = {{ t0_s = 0.15 }}\n"),
        format!("{TIED}{DEMAND}"),
        format!("{SLIPS}{DEMAND}"),
        format!("{DRUMS}{DEMAND}"),
    ] {
        let scenario = parsed(&text);
        let html = page(&scenario, &verify(&scenario).unwrap());
        assert!(html.contains(", 2025-01-31</td>"), "{text}");
        let dated = VerifyPage::new(&scenario, &verify(&scenario).unwrap(), None);
        assert_eq!(dated.html(), html.replace(", 2025-01-31</td>", "</td>"));
    }
}

/// Every number of the page is a number of the JSON, rounded as shown, and the important ones are in their places. The
/// page needs no network and claims nothing that the Circolare does not say.
#[test]
fn page_and_json_agree() {
    let free = "[verify]\nsides = 'right'\nfree_standing = { t0_s = 0.15 }\n";
    for text in [
        format!("title = 'A <title> & more'\n{ARCH}{DEMAND}"),
        format!("{}{DEMAND}{HEIGHT}", on_piers()),
        format!("{COLUMN}{DEMAND}{free}"),
        format!("{TIED}{DEMAND}"),
        format!("{SLIPS}{DEMAND}"),
        format!("{DRUMS}{DEMAND}"),
        format!("{COLUMN}[demand.slv]\nspectrum = 'slv.csv'\n[demand.sld]\nspectrum = 'slv.csv'\n"),
    ] {
        let folder = in_folder(&text, "");
        print_of(folder.path(), &["verify", "a.toml", "--out", "out"]);
        let json = std::fs::read_to_string(folder.path().join("out/verify.json")).unwrap();
        let page = folder.path().join("out/verify.html");
        let html = std::fs::read_to_string(&page).unwrap();
        for foreign in ["src=", "@import", "<link", "url(", "omplian", "NaN", "inf<"] {
            assert!(!html.contains(foreign), "{foreign}");
        }
        let script = browser::DATA_ARE_IN_THE_JSON.to_owned() + "
const result = document.getElementById('result').textContent;
if (data.zeta_e === null) verify(result.includes(`No ζE: ${data.no_zeta_e_because}`), 'no zeta_e');
else verify(result.includes(`= ${data.zeta_e.toFixed(3)}.`), 'zeta_e');
for (const [state, verdict] of Object.entries(data.verdict)) {
  const rows = [...document.querySelectorAll('#result tbody tr')].filter((row) => row.textContent.startsWith(state.toUpperCase()));
  const counts = rows.find((row) => row.className === 'counts');
  const words = { passed: 'passed', not_passed: 'not passed', no_answer: 'no answer', not_checked: undefined };
  verify(counts?.lastElementChild.textContent === words[verdict], `${state} ${verdict}`);
  const shown = data.states[state].zeta_e ?? data.states[state].right.sliding?.bound_g;
  if (counts) verify(counts.textContent.includes(shown.toFixed(3)), state);
}
verify(document.querySelectorAll('svg').length >= 1, 'pictures');
verify(document.title === (data.title ?? 'Check of local mechanisms'), document.title);
verify(document.body.textContent.includes(data.scenario_sha256), 'hash');
data.decisions.forEach((one) => verify([...document.querySelectorAll('dt')].some((dt) => dt.textContent === one.name), one.name));
";
        browser::assert_checked(&page, &script, &json, &[], 60);
    }
}

/// The page draws a tapered column as it is, whole or in drums.
#[test]
fn a_tapered_column_is_drawn_with_its_outline() {
    for (drums, count) in [("", 1), ("drums = 3\n", 3)] {
        let text = format!(
            "[column]\nheight_m = 3\nwidth_m = 1.0\ntop_width_m = 0.6\n{drums}[free_hinges]\n\
             [demand]\nsoil = 'B'\ntopography = 'T1'\n[demand.slv]\nag_g = 0.25\nf0 = 2.4\ntc_star_s = 0.35\n"
        );
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("s.toml"), text).unwrap();
        crate::common::program::printed(folder.path(), &["verify", "s.toml", "--out", "o"]);
        let page = std::fs::read_to_string(folder.path().join("o/verify.html")).unwrap();
        let bodies = page.split("data-name=\"body 1\" d=\"M").skip(1);
        let bodies = bodies.map(|rest| rest.split_once("Z\"").unwrap().0);
        let corners: Vec<[f64; 2]> = bodies
            .flat_map(|path| path.split('L'))
            .flat_map(|part| {
                let numbers = part
                    .split_whitespace()
                    .map(|number| number.parse().unwrap());
                let numbers: Vec<f64> = numbers.collect();
                let points = numbers.chunks(2).map(|point| [point[0], point[1]]);
                points.collect::<Vec<_>>()
            })
            .collect();
        assert_eq!(corners.len(), 4 * count);
        let width_at = |end: fn(f64, f64) -> f64| {
            let y = corners.iter().map(|corner| corner[1]).reduce(end).unwrap();
            let level = corners.iter().filter(|corner| (corner[1] - y).abs() < 0.02);
            let x: Vec<f64> = level.map(|corner| corner[0]).collect();
            (x[0] - x[1]).abs()
        };
        let ratio = width_at(f64::min) / width_at(f64::max);
        assert!((ratio - 0.6).abs() < 1e-3, "{drums}{ratio}");
    }
}
