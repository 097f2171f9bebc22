//! Walls whose top is held, in `limit`, `capacity` and `verify`: numbers of the mechanics, words in both languages, and refusals.

use crate::common::program::{printed, refused, scenarios};
use crate::common::prose::{golden, shows};
use crate::common::results::{json, named, texts};
use archrock::mechanics::HeldMechanism;
use archrock::mechanics::HeldTop;
use archrock::scenario::{LimitState, ReadOptions, Source};
use archrock::studies::verify::{VerifyPage, verify};
use archrock::studies::{capacity, limit};
use archrock::{Column, Scenario, Sway};
use roxmltree::Document;

const WALL: &str = "[column]\nheight_m = 3.5\nwidth_m = 0.45\ndensity_kg_m3 = 1900\n";
const TOP: &str = "[column.top]\nweight_n = 25e3\nx_m = -0.1\n";
const DEMAND: &str = "[demand]\nsoil = 'B'\ntopography = 'T1'\n\
    [demand.sld]\nag_g = 0.10\nf0 = 2.40\ntc_star_s = 0.28\n\
    [demand.slv]\nag_g = 0.25\nf0 = 2.40\ntc_star_s = 0.35\n";

/// A scenario for statics.
fn held(text: &str) -> Scenario {
    let options = ReadOptions {
        statics: true,
        ..ReadOptions::default()
    };
    Scenario::of(&Source::of_text(text, "s.toml"), &options)
        .unwrap_or_else(|error| panic!("{error}"))
}

fn mechanism(sway: Sway) -> HeldMechanism {
    let top = HeldTop {
        weight_n: 25e3,
        x_m: -0.1,
    };
    let wall = Column::new(3.5, 0.45)
        .unwrap()
        .with_density_kg_m3(1900.0)
        .unwrap();
    HeldMechanism::new(&wall.with_top(top, 9.81).unwrap(), sway).unwrap()
}

#[test]
fn limit_prints_the_mechanism_to_either_side() {
    let folder = tempfile::tempdir().unwrap();
    let file = scenarios().join("recipes/vertical-bending.toml");
    let words = printed(folder.path(), &["limit", file.to_str().unwrap()]);
    golden("limit-held-top", &words);
    let out = ["limit", file.to_str().unwrap(), "--out", "l"];
    printed(folder.path(), &out);
    let found = json(&folder.path().join("l/limit.json"));
    for sway in [Sway::Right, Sway::Left] {
        let (name, own) = (sway.name(), mechanism(sway));
        let [_, upper_m] = own.hinges_m();
        let number = |key: &str| found[key][name].as_f64().unwrap();
        assert_eq!(number("incipient_acceleration_g"), own.acceleration_g);
        assert_eq!(number("top_reaction_n"), own.reaction_n);
        assert_eq!(number("friction_demand"), own.displaced(0.0).friction);
        let [toe, face] = [0, 1].map(|at| found["mechanism"][name][at].clone());
        assert_eq!(toe["toe"], name);
        assert_eq!(face["side"], sway.opposite().name());
        assert_eq!(face["height_m"].as_f64().unwrap(), upper_m.y);
        shows(
            &words,
            &[own.acceleration_g, upper_m.y, own.reaction_n / 1e3],
        );
    }
    let picture = std::fs::read_to_string(folder.path().join("l/limit.svg")).unwrap();
    let picture = Document::parse(&picture).unwrap();
    for (name, count) in [("hinge", 4), ("body 1", 2), ("body 2", 2), ("load", 2)] {
        assert_eq!(named(&picture, name).len(), count, "{name}");
    }
    let words = texts(&picture);
    assert!(
        words.iter().any(|words| words == "push to the left"),
        "{words:?}"
    );
    assert!(
        words.iter().any(|words| words == "floor 25 kN"),
        "{words:?}"
    );
}

/// Drums have hinges at joints, which `limit` numbers; ties pull with their forces at rest, and have no curve.
#[test]
fn drums_and_ties_are_those_of_other_columns() {
    let drums = held(&format!("{WALL}drums = 7\n{TOP}"));
    let printed = limit(&drums).unwrap();
    assert!(
        printed
            .text
            .contains("joint   0 at x    0.22500 m, y    0.00000 m, extrados"),
        "{}",
        printed.text
    );
    assert!(
        printed
            .text
            .contains("joint   5 at x   -0.22500 m, y    2.50000 m, intrados"),
        "{}",
        printed.text
    );
    let tie = "[[tie]]\nfrom_m = [0.0, 3.0]\nto_m = [-4.0, 3.0]\nto_block = 0\nstiffness_n_m = 1e6\nprestress_n = 3000\n";
    let tied = held(&format!("{WALL}{TOP}{tie}{DEMAND}"));
    let text = limit(&tied).unwrap().text;
    assert!(
        text.contains("this is for the tie force at rest: 3.000 kN"),
        "{text}"
    );
    let error = capacity(&tied, None).unwrap_err().to_string();
    assert!(error.contains("leave the ties out"), "{error}");
    let check = verify(&tied).unwrap();
    let one = &check.mechanisms[&Sway::Right];
    assert!(one.curve_m_g.is_none() && one.forces.len() == 2);
    // A tie at 3 m pulls the upper body to the left, by 0.5 m over the arm of the floor.
    assert!(one.alpha0 > mechanism(Sway::Right).acceleration_g);
    assert!(
        check.states[&LimitState::Slv].sides[&Sway::Right]
            .simplified
            .is_some()
    );
}

/// Both bodies of a uniform wall have the same horizontal displacement of their centres, so e* is one. The multiplier follows from the virtual work of
/// the numbers on the page.
#[test]
fn verify_checks_the_two_bodies() {
    let scenario = held(&format!("{WALL}{TOP}{DEMAND}"));
    let check = verify(&scenario).unwrap();
    assert!(!check.is_symmetric);
    for (sway, one) in &check.mechanisms {
        let own = mechanism(*sway);
        assert!((one.e_star - 1.0).abs() < 1e-12);
        assert!((one.alpha0 / own.acceleration_g - 1.0).abs() < 1e-12);
        let [floor] = &one.forces[..] else {
            panic!("{:?}", one.forces)
        };
        assert_eq!((floor.x_m, floor.y_m, floor.force_y_kn), (-0.1, 3.5, -25.0));
        assert!(floor.delta_x.abs() < 1e-12);
        let weights = one.bodies.iter().map(|body| body.weight_kn * body.delta_y);
        let work = weights.sum::<f64>() + 25.0 * floor.delta_y;
        assert!((work / one.sum_p_delta_x_kn / one.alpha0 - 1.0).abs() < 1e-12);
        let end_m = own.displaced(own.end_rad().unwrap());
        let [lower, upper] = [0, 1].map(|body| {
            let centre_m = [one.bodies[body].x_m, one.bodies[body].y_m].into();
            (end_m.poses[body].current_position(centre_m) - centre_m).x * one.bodies[body].mass_kg
        });
        let due_m = sway.sign() * (lower + upper) / one.moving_mass_kg;
        assert!((one.d_c0_m.unwrap() / due_m - 1.0).abs() < 1e-9);
        assert_eq!(one.top_reaction_kn, Some(own.reaction_n / 1e3));
        let start = check.states[&LimitState::Sld].sides[sway]
            .activation
            .unwrap();
        assert!((start.capacity_g / (own.acceleration_g / 1.35) - 1.0).abs() < 1e-12);
        assert!(
            check.states[&LimitState::Slv].sides[sway]
                .displacement
                .is_some()
        );
    }
    // In the middle of the top the floor makes both sides alike.
    let middle = verify(&held(&format!(
        "{WALL}[column.top]\nweight_n = 25e3\n{DEMAND}"
    )))
    .unwrap();
    assert!(middle.is_symmetric);
    let italian = held(&format!("{WALL}{TOP}{DEMAND}[verify]\nlanguage = 'it'\n"));
    for (scenario, words) in [
        (
            &scenario,
            [
                "face, left",
                "the floor holds the top sideways with 8.67 kN",
            ],
        ),
        (
            &italian,
            [
                "faccia, sinistra",
                "il solaio trattiene la sommità con 8,67 kN",
            ],
        ),
    ] {
        let check = verify(scenario).unwrap();
        let page = VerifyPage::new(scenario, &check, None).html();
        for words in words {
            assert!(page.contains(words), "{words}");
        }
    }
}

/// The curves start at the push of `limit`, and end where the two bodies are in equilibrium without a push.
#[test]
fn capacity_follows_the_bending_wall() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.toml"), format!("{WALL}{TOP}")).unwrap();
    printed(folder.path(), &["capacity", "s.toml", "--out", "c"]);
    let found = json(&folder.path().join("c/capacity.json"));
    for sway in [Sway::Right, Sway::Left] {
        let (side, own) = (&found["capacity"][sway.name()], mechanism(sway));
        let number = |key: &str| side[key].as_f64().unwrap();
        assert!((number("acceleration_g") / own.acceleration_g - 1.0).abs() < 1e-12);
        let control_m = nalgebra::Vector2::new(0.0, mechanism(Sway::Right).hinges_m()[1].y);
        assert_eq!(side["control_point_m"][1].as_f64().unwrap(), control_m.y);
        let end = own.displaced(own.end_rad().unwrap());
        let moved_m = [0, 1].map(|body| {
            (end.poses[body].current_position(control_m) - control_m)
                .x
                .abs()
        });
        let due_m = number("ultimate_displacement_m");
        assert!(
            moved_m
                .iter()
                .any(|moved_m| (moved_m / due_m - 1.0).abs() < 1e-9)
        );
    }
}

/// Two supports at the same distance let the thrust grow with the push; a floor that rises does not.
#[test]
fn blocks_held_at_both_ends_are_another_structure() {
    let folder = tempfile::tempdir().unwrap();
    let joints: String = (0..8)
        .map(|joint| {
            let y_m = 0.5 * f64::from(joint);
            format!("0.225,{y_m},-0.225,{y_m}\n")
        })
        .collect();
    std::fs::write(folder.path().join("j.csv"), joints).unwrap();
    std::fs::write(
        folder.path().join("s.toml"),
        "[blocks]\njoints = 'j.csv'\ndensity_kg_m3 = 1900\n",
    )
    .unwrap();
    let words = printed(folder.path(), &["limit", "s.toml"]);
    assert!(
        words.contains(
            "no push to the right moves it without sliding: a straight line fits into it"
        ),
        "{words}"
    );
    assert!((mechanism(Sway::Right).acceleration_g - 0.877).abs() < 5e-4);
}

#[test]
fn what_a_held_top_excludes_is_refused_with_its_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let ground = "[ground.half_sine]\namplitude_g = 0.3\nduration_s = 0.3\n";
    let refuse = |arguments: &[&str], text: &str, words: &[&str]| {
        std::fs::write(folder.path().join("s.toml"), text).unwrap();
        let all = [arguments, &["s.toml"]].concat();
        // Long messages continue on indented lines.
        let said = refused(folder.path(), &all, &[]).replace("\n  ", " ");
        for words in words {
            assert!(said.contains(words), "{words:?} is not in: {said}");
        }
    };
    let motion = [
        "`top` holds the top of a column",
        "run `archrock limit`, `capacity` or `verify`",
    ];
    for command in ["run", "threshold", "impact", "suite"] {
        refuse(&[command], &format!("{WALL}{TOP}{ground}"), &motion);
    }
    refuse(
        &["run"],
        &format!("{WALL}drums = 3\n{TOP}{ground}"),
        &motion,
    );
    for model in [
        "[free_hinges]\n",
        "[elastic_joints]\nnormal_stiffness_gpa_m = 10\n",
    ] {
        refuse(&["limit"], &format!("{WALL}{TOP}{model}"), &motion);
    }
    let wrong = |text: String, words: &[&str]| refuse(&["limit"], &text, words);
    wrong(
        format!("{WALL}{TOP}[column.back]\nside = 'left'\n"),
        &["`top` cannot be combined with [column.back]"],
    );
    wrong(format!("{WALL}[column.top]\nx_m = 0.1\n"), &["weight_n"]);
    wrong(
        format!("{WALL}[column.top]\nweight_n = -1.0\n"),
        &["`weight_n = -1.0` is out of range"],
    );
    wrong(
        format!("{WALL}[column.top]\nweight_n = 1e3\nx_m = 0.3\n"),
        &["x_m", "from -0.225 to 0.225"],
    );
    wrong(
        format!("{WALL}top_width_m = 0.4\n{TOP}"),
        &["top_width_m", "give drums"],
    );
    wrong(
        format!("{WALL}{TOP}[[load]]\nmass_kg = 5000\nx_m = 0.9\n"),
        &["`top` does not fit", "give less load or eccentricity"],
    );
    wrong(
        format!("{WALL}{TOP}[supports.right]\nspread_m = 0.01\n"),
        &["supports"],
    );
    for record in ["r1.csv", "r2.csv", "r3.csv"] {
        std::fs::write(folder.path().join(record), "0,0\n0.01,0.1\n0.02,0\n").unwrap();
    }
    let records = "[verify]\nunit = 'g'\nslv_records = 'r?.csv'\n";
    refuse(
        &["verify"],
        &format!("{WALL}{TOP}{DEMAND}{records}"),
        &["the histories of slv_records are not possible"],
    );
}
