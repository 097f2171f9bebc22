//! Studies of columns with loads: statics, the check by the Circolare, motion by all models, pictures and words.

use std::fs;
use std::path::Path;

use crate::common::parsed;
use crate::common::program::{printed, scenarios};
use archrock::mechanics::stability::onset;
use archrock::studies::capacity;
use archrock::studies::verify::verify;
use archrock::{ImpactModel, Scenario, Sway};
use roxmltree::Document;
use serde_json::Value;

const WALL: &str = "[column]\nheight_m = 8\nwidth_m = 0.6\n";
const ROOF: &str = "[[load]]\nmass_kg = 1500\nx_m = -0.15\n";
const VAULT: &str =
    "[[load]]\nmass_kg = 2000\nmoves = false\nthrust_n = 1500\nx_m = -0.1\nheight_m = 5\n";
const DEMAND: &str = "[demand]\nsoil = 'B'\ntopography = 'T1'\n[demand.sld]\nag_g = 0.10\nf0 = 2.40\ntc_star_s = 0.28\n\
                      [demand.slv]\nag_g = 0.25\nf0 = 2.40\ntc_star_s = 0.35\n";
const SINE: &str = "[ground.one_sine]\namplitude_g = 0.16\nduration_s = 0.9\n";
const GRAVITY_M_S2: f64 = 9.81;
const BLOCK_KG: f64 = 9600.0;

fn refusal(text: &str) -> String {
    Scenario::parse(text, "s.toml").unwrap_err().to_string()
}

/// The results of a command on this text, as JSON.
fn answer(folder: &Path, arguments: &[&str], text: &str) -> Value {
    fs::write(folder.join("s.toml"), text).unwrap();
    let all = [arguments, &["s.toml", "--format", "json"]].concat();
    serde_json::from_str(&printed(folder, &all)).unwrap()
}

/// Push in g that starts a sway, and the displacement of the top at the unstable equilibrium, by the moments about the toe.
fn by_hand(sway: Sway) -> [f64; 2] {
    let sign = sway.sign();
    let thrust_kg = sign * 1500.0 / GRAVITY_M_S2;
    // Distances from the toe against the sway.
    let [block, roof, vault] = [0.3, 0.3 + sign * 0.15, 0.3 + sign * 0.1];
    let held = BLOCK_KG * block + 1500.0 * roof + 2000.0 * vault - thrust_kg * 5.0;
    let tall = BLOCK_KG * 4.0 + 1500.0 * 8.0;
    let falls = tall + 2000.0 * 5.0 + thrust_kg * vault;
    let q = (held / falls).atan();
    // The middle of the top turns about the toe.
    let shift_m = 0.3 + 8.0 * q.sin() - 0.3 * q.cos();
    [held / tall, shift_m]
}

#[test]
fn limit_and_capacity_are_those_of_the_moments() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!("{WALL}{ROOF}{VAULT}");
    let limit = answer(folder.path(), &["limit"], &text);
    let words = printed(folder.path(), &["limit", "s.toml"]);
    let capacity = answer(folder.path(), &["capacity"], &text);
    // The limit of drums at their lowest joint, and of elastic joints, which are rigid in limit analysis.
    let free = answer(folder.path(), &["limit"], &format!("{text}[free_hinges]\n"));
    for sway in Sway::ALL {
        let [due_g, due_m] = by_hand(*sway);
        for limit in [&limit, &free] {
            let own_g = limit["incipient_acceleration_g"][sway.name()]
                .as_f64()
                .unwrap();
            assert!((own_g / due_g - 1.0).abs() < 1e-9, "{own_g} {due_g}");
        }
        let own_m = capacity["capacity"][sway.name()]["ultimate_displacement_m"].as_f64();
        let own_m = own_m.unwrap();
        assert!((own_m / due_m - 1.0).abs() < 1e-9, "{own_m} {due_m}");
    }
    // The words have both sides, and columns without loads have one.
    assert!(
        words.contains("A_L to the left")
            && words.contains("on quiet ground, swaying right")
            && words.contains("swaying left"),
        "{words}"
    );
    let left = &limit["to_the_left"];
    let rotation_rad = left["unstable_equilibrium_rad"][0].as_f64().unwrap();
    let slenderness_rad = left["equivalent_block"]["slenderness_rad"]
        .as_f64()
        .unwrap();
    assert!(
        rotation_rad > 0.0 && (slenderness_rad.tan() / by_hand(Sway::Left)[0] - 1.0).abs() < 1e-9
    );
    assert!(
        answer(folder.path(), &["limit"], WALL)
            .get("to_the_left")
            .is_none()
    );
    // A stack of drums that starts as one block has the same curve.
    let text = format!("{text}[free_hinges]\n");
    let stack = text.replace("width_m = 0.6", "width_m = 0.6\ndrums = 2");
    let stack = answer(folder.path(), &["capacity"], &stack);
    for sway in Sway::ALL {
        let own_m = stack["capacity"][sway.name()]["ultimate_displacement_m"]
            .as_f64()
            .unwrap();
        assert!((own_m / by_hand(*sway)[1] - 1.0).abs() < 1e-9);
    }
}

/// The virtual work of the numbers on the page, weights of the body and constant forces, is alpha0.
#[test]
fn verify_has_constant_forces_as_external_forces() {
    for joints in ["", "[free_hinges]\n"] {
        let check = verify(&parsed(&format!("{WALL}{ROOF}{VAULT}{DEMAND}{joints}"))).unwrap();
        for (sway, own) in &check.mechanisms {
            let [due_g, due_m] = by_hand(*sway);
            assert!((own.alpha0 / due_g - 1.0).abs() < 1e-9, "{joints}");
            let [body] = &own.bodies[..] else {
                panic!("one body")
            };
            assert!((body.mass_kg - 11100.0).abs() < 1e-6);
            let [force] = &own.forces[..] else {
                panic!("one force")
            };
            assert!((force.force_x_kn - sway.sign() * 1.5).abs() < 1e-9);
            assert!((force.force_y_kn + 19.62).abs() < 1e-9);
            assert_eq!([force.x_m, force.y_m], [-0.1, 5.0]);
            let work = force.force_x_kn * force.delta_x + force.force_y_kn * force.delta_y;
            let alpha0 = (body.weight_kn * body.delta_y - work) / (body.weight_kn * body.delta_x);
            assert!((alpha0 / own.alpha0 - 1.0).abs() < 1e-12);
            assert!((own.sum_f_delta_l_kn + work).abs() < 1e-12 * body.weight_kn);
            assert!((own.e_star - 1.0).abs() < 1e-12);
            assert!((own.d_c0_crown_m.unwrap() / due_m - 1.0).abs() < 1e-9);
        }
    }
    let bare = verify(&parsed(&format!("{WALL}{ROOF}{DEMAND}"))).unwrap();
    assert!(bare.mechanisms.values().all(|own| own.forces.is_empty()));
    // Displacements grow with the height: 4 m for the wall, 8 m for the roof.
    let [first, second] =
        [1, 2].map(|power| BLOCK_KG * 4_f64.powi(power) + 1500.0 * 8_f64.powi(power));
    let fraction = first * first / second / (BLOCK_KG + 1500.0);
    assert!(fraction < 0.92);
    for joints in ["", "[free_hinges]\n"] {
        let check = verify(&parsed(&format!("{WALL}{ROOF}{DEMAND}{joints}"))).unwrap();
        for own in check.mechanisms.values() {
            let apart_g = own.a0_with_separate_loads_over_fc_g.unwrap();
            let due_g = own.a0_over_fc_g / fraction;
            assert!((apart_g / due_g - 1.0).abs() < 1e-12, "{apart_g} {due_g}");
        }
    }
    let alone = verify(&parsed(&format!("{WALL}{DEMAND}"))).unwrap();
    let mut alone = alone.mechanisms.values();
    assert!(alone.all(|own| own.a0_with_separate_loads_over_fc_g.is_none()));
}

#[test]
fn the_page_of_verify_lists_the_forces() {
    let folder = tempfile::tempdir().unwrap();
    answer(
        folder.path(),
        &["verify"],
        &format!("{WALL}{ROOF}{VAULT}{DEMAND}"),
    );
    let page = fs::read_to_string(folder.path().join("results/s/verify.html")).unwrap();
    assert!(page.contains("∑Fδ<sub>F</sub>) / ∑Pδ<sub>x</sub>") && page.contains("-19.620"));
    assert!(page.contains("act up to collapse"));
}

/// The peaks of all models agree over one impact. Without the thrust the peak is lower.
#[test]
fn all_models_move_with_loads() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!("{WALL}{ROOF}{VAULT}{SINE}[simulation]\nduration_s = 1.5\n");
    let peak = |options: &[&str]| {
        let run = answer(folder.path(), &[&["run"], options].concat(), &text);
        assert!(run.get("ties").is_none());
        run["largest_peak_rotation_rad"].as_f64().unwrap()
    };
    let rigid = peak(&[]);
    assert!(rigid > 0.005, "{rigid}");
    let stiff = "elastic_joints.normal_stiffness_gpa_m=1000";
    for options in [
        &["--hinges", "free"][..],
        &["--hinges", "elastic", "--set", stiff],
    ] {
        let other = peak(options);
        assert!((other / rigid - 1.0).abs() < 1e-3, "{other} {rigid}");
    }
    let without = peak(&["--set", "load.2.thrust_n=0"]);
    assert!(without < 0.8 * rigid, "{without} {rigid}");
}

#[test]
fn pictures_and_words_have_the_loads() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = scenarios().join("facade-with-roof.toml");
    let scenario = scenario.to_str().unwrap();
    printed(folder.path(), &["check", scenario, "--plot", "facade.svg"]);
    let text = fs::read_to_string(folder.path().join("facade.svg")).unwrap();
    let svg = Document::parse(&text).unwrap();
    let words: Vec<&str> = svg.descendants().filter_map(|node| node.text()).collect();
    let words = words.join("\n");
    for shown in [
        "1500 kg",
        "2000 kg as constant weight",
        "thrust of 1.5 kN to the right",
    ] {
        assert!(words.contains(shown), "{words}");
    }
    // The wall is on the left, so the label of the thrust begins to the right of the column.
    let label = "thrust of 1.5 kN to the right";
    let mut labels = svg.descendants();
    let label = labels.find(|node| node.has_tag_name("text") && node.text() == Some(label));
    assert_eq!(label.unwrap().attribute("text-anchor"), Some("start"));
    let described = parsed(&format!("{WALL}{ROOF}{VAULT}")).structure.describe();
    assert!(
        described.contains("load at (-0.15, 8) m: 1500 kg;"),
        "{described}"
    );
    assert!(
        described.contains(
            "load at (-0.1, 5) m: 2000 kg as constant weight, thrust of 1.5 kN to the right;"
        ),
        "{described}"
    );
    let run = answer(
        folder.path(),
        &["run"],
        &fs::read_to_string(scenario).unwrap(),
    );
    assert_eq!(run["outcome"], "rest", "{run}");
}

/// Snapshots have the arrows of the loads over the blocks, the wall behind them, and both in words.
#[test]
fn snapshots_show_loads_over_the_blocks() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = scenarios().join("facade-with-roof.toml");
    let scenario = scenario.to_str().unwrap();
    let run = ["run", scenario, "--snapshots", "0.5", "--out", "r"];
    printed(folder.path(), &run);
    let svg = fs::read_to_string(folder.path().join("r/snapshots.svg")).unwrap();
    let places = |name: &str| {
        let found = svg.match_indices(name).map(|(place, _)| place);
        found.collect::<Vec<_>>()
    };
    let [wall, block, loads] = ["\"wall behind\"", "\"body 0\"", "\"load\""].map(places);
    assert_eq!([wall.len(), block.len(), loads.len()], [1, 1, 3]);
    assert!(wall[0] < block[0] && block[0] < loads[0]);
    let words = svg.replace("\n", " ");
    assert!(words.contains("wall behind it over its"), "{words}");
}

/// Loads can be set, varied and drawn at random; the resolved scenario gives the same structure again.
#[test]
fn keys_of_loads_can_vary() {
    let uncertain = "[uncertain]\nsamples = 4\n\"load.1.mass_kg\" = { from = 1000, to = 2000 }\n";
    let text = format!("{WALL}{ROOF}{VAULT}{SINE}");
    assert!(Scenario::parse(&format!("{text}{uncertain}"), "s.toml").is_ok());
    let scenario = parsed(&text);
    assert_eq!(parsed(&scenario.to_toml()), scenario);
    let json = scenario.to_json();
    assert_eq!(
        json["load"][0],
        serde_json::json!({"mass_kg": 1500.0, "x_m": -0.15, "moves": true, "thrust_n": 0.0})
    );
    assert_eq!(json["load"][1]["moves"], false);
    // A load without mass has no key for it. Tops follow the height of the column, so they are not written.
    let text = |height_m: f64| {
        let wall = WALL.replace("= 8", &format!("= {height_m}"));
        format!("{wall}[column.back]\nside = 'left'\n{ROOF}[[load]]\nthrust_n = 100\n")
    };
    let scenario = parsed(&text(8.0));
    let again = parsed(&scenario.to_toml());
    assert_eq!(again, scenario);
    assert_eq!(
        scenario.to_json()["load"][1],
        serde_json::json!({"x_m": 0.0, "moves": true, "thrust_n": 100.0})
    );
    let higher =
        [&scenario, &again].map(|one| one.with_values(&[("column.height_m", 9.5)]).unwrap());
    for higher in higher {
        assert_eq!(higher.structure, parsed(&text(9.5)).structure);
    }
}

/// A load without force has no arrow; a load far beside its column is probably in another unit.
#[test]
fn unlikely_loads_are_noticed() {
    let load = |keys: &str| parsed(&format!("{WALL}[[load]]\n{keys}\n"));
    let empty = load("mass_kg = 0\nmoves = false").structure.describe();
    assert!(empty.contains("load at (0, 8) m: 0 kg;"), "{empty}");
    for (x_m, count) in [(-0.85, 0), (0.95, 1)] {
        let warnings = load(&format!("mass_kg = 10\nx_m = {x_m}")).unlikely_values();
        assert_eq!(warnings.len(), count, "{warnings:?}");
        let names = |warning: &String| warning.starts_with("load 1 is at x = 0.95 m");
        assert!(warnings.iter().all(names), "{warnings:?}");
    }
}

#[test]
fn wrong_loads_are_refused() {
    let load = |keys: &str| refusal(&format!("{WALL}[[load]]\n{keys}\n"));
    assert!(load("x_m = 0.1").contains("needs one of the keys mass_kg, thrust_n"));
    assert!(
        load("mass_kg = 10\nwidth_m = 1")
            .contains("s.toml:6:11: `width_m = 1` of load 1 applies to arches")
    );
    assert!(
        load("mass_kg = 10\nheight_m = 9")
            .contains("must be from 0 to the height of the column, 8.0 m")
    );
    let falls = load("thrust_n = -9000");
    assert!(
        falls.contains("overturns the column to the left, without ground motion"),
        "{falls}"
    );
    let drums = refusal(&format!(
        "{WALL}drums = 4\n[[load]]\nmass_kg = 9000\nx_m = 0.4\n[free_hinges]\n"
    ));
    assert!(drums.contains("opens joints of the column"), "{drums}");
    let arch = "[arch]\nmean_radius_m = 5\nthickness_ratio = 0.15\nembrace_deg = 180\nvoussoirs = 20\n[[load]]\nmass_kg = 500\nx_m = 0\n";
    let high = refusal(&format!("{arch}height_m = 2\n"));
    let words = "s.toml:9:12: `height_m = 2` of load 1 applies to columns and piers";
    assert!(high.contains(words), "{high}");
    let pier = refusal(&format!("{arch}pier = 'left'\n"));
    assert!(
        pier.contains(
            "s.toml:9:8: `pier = 'left'` of load 1 names a pier that the arch does not have"
        ),
        "{pier}"
    );
    let on_column = load("mass_kg = 10\npier = 'left'");
    assert!(
        on_column.contains("`pier = 'left'` of load 1 applies to arches"),
        "{on_column}"
    );
    let spread = refusal(&format!("{arch}thrust_n = 10\nwidth_m = 0.5\n"));
    assert!(spread.contains("other loads act at a point"), "{spread}");
    let supports = "[free_hinges]\n[supports]\nright = { spread_m = 0.01 }\n";
    let moved = refusal(&format!("{arch}thrust_n = 10\n{supports}"));
    assert!(moved.contains("without constant forces"), "{moved}");
    let tied = "[[tie]]\nheight_m = 2\nstiffness_n_m = 1e6\n[free_hinges]\n";
    let tied = refusal(&format!("{arch}moves = false\n{tied}"));
    assert!(
        tied.contains("the model computes ties or constant forces"),
        "{tied}"
    );
    let four = parsed(&format!("{arch}thrust_n = 10\n"));
    let four = four
        .structure
        .model(ImpactModel::MaxRestitution)
        .unwrap_err();
    assert!(
        four.to_string()
            .contains("four links cannot have constant forces"),
        "{four}"
    );
    let lacking = refusal(&arch.replace("\nx_m = 0", ""));
    assert!(
        lacking.contains("s.toml:6:1: `x_m` of load 1 is missing"),
        "{lacking}"
    );
    let tie = "[[tie]]\nfrom_m = [-3, 7]\nfrom_block = 0\nto_m = [-0.3, 7]\nstiffness_n_m = 1e6\n";
    let tied = refusal(&format!("{WALL}{VAULT}{tie}[free_hinges]\n"));
    assert!(
        tied.contains("the model computes ties or constant forces"),
        "{tied}"
    );
    assert!(Scenario::parse(&format!("{WALL}{ROOF}{tie}[free_hinges]\n"), "s.toml").is_ok());
    let low = refusal(&format!(
        "{WALL}[column.back]\nside = 'left'\nheight_m = 4.2\nrestitution = 0.4\n{ROOF}"
    ));
    assert!(low.contains("the height of the centre of gravity"), "{low}");
}

const PIERS: &str = "[pointed_arch]\nspan_m = 4\nrise_m = 3\nthickness_m = 0.6\nvoussoirs = 10\n[piers]\nheight_m = 3\nwidth_m = 1.5\nblocks = 3\n";

/// Pushes of an arch on piers in g that start it to the right and to the left.
fn onsets_g(more: &str) -> [f64; 2] {
    onsets_g_of(&format!("{PIERS}{more}"))
}

fn onsets_g_of(text: &str) -> [f64; 2] {
    let scenario = parsed(text);
    let row = scenario.structure.row().unwrap();
    [Sway::Right, Sway::Left].map(|sway| onset(&row, sway).unwrap().unwrap().acceleration_g)
}

/// A thrust on a pier, compared with the pull of a very long, soft tie with the same force, which hardly changes in motion.
#[test]
fn a_thrust_on_a_pier_is_the_pull_of_a_very_long_tie() {
    let thrust = "[[load]]\npier = 'left'\nheight_m = 2.5\nthrust_n = -4000\n";
    // The axis of the left pier is 2.45 m left of the middle: half of the clear span of 3.4 m and half of the width.
    let tie = "[[tie]]\nfrom_m = [-2.45, -0.5]\nto_m = [-200002.45, -0.5]\nto_block = 0\nstiffness_n_m = 0.0400001\nprestress_n = 4000\n";
    let motion = "[ground.one_sine]\namplitude_g = 0.45\nduration_s = 0.8\n[simulation]\nduration_s = 1.2\n[free_hinges]\n";
    let [bare, pushed, tied] = ["", thrust, tie].map(onsets_g);
    for side in 0..2 {
        let error = pushed[side] / tied[side] - 1.0;
        assert!(error.abs() < 1e-9, "{pushed:?} {tied:?}");
    }
    // The left pier turns about its outer toe if the arch sways to the left.
    assert!(pushed[1] < 0.95 * bare[1], "{pushed:?} {bare:?}");
    let peaks = [thrust, tie].map(|more| {
        let scenario = parsed(&format!("{PIERS}{more}{motion}"));
        let model = scenario.model().unwrap();
        let summary = model
            .simulate(scenario.ground_motion(), &scenario.request(), None)
            .unwrap();
        assert!(
            summary.energy_defect_ratio < 1e-2,
            "{}",
            summary.energy_defect_ratio
        );
        summary
            .peak_rotations_rad
            .iter()
            .copied()
            .fold(0.0, f64::max)
    });
    assert!(
        peaks[0] > 0.005 && (peaks[0] / peaks[1] - 1.0).abs() < 1e-3,
        "{peaks:?}"
    );
    // At the foot a thrust does no work in any mechanism.
    let foot = onsets_g(&thrust.replace("2.5", "0"));
    assert!((0..2).all(|side| (foot[side] / bare[side] - 1.0).abs() < 1e-9));
}

/// The load multiplier by virtual work, with constant forces as external forces, is the push of limit analysis. The mirror image has exchanged sides.
#[test]
fn verify_of_an_arch_on_piers_has_the_forces() {
    let loads = |side: &str, sign: f64| {
        format!(
            "[[load]]\npier = '{side}'\nheight_m = 2.5\nthrust_n = {}\nmass_kg = 800\nmoves = false\nx_m = {}\n\
             [[load]]\nmass_kg = 500\nmoves = false\nx_m = {}\n[[load]]\npier = '{side}'\nmass_kg = 700\nheight_m = 1\n",
            sign * 3000.0,
            sign * 0.2,
            sign * 0.5
        )
    };
    let left = loads("left", -1.0);
    let fill = "[fill]\nheight_m = 1.5\ndensity_kg_m3 = 1600\n";
    let onset_g = onsets_g(&format!("{fill}{left}"));
    // To the right its joints slide first.
    let text = format!("{PIERS}{fill}{left}{DEMAND}[verify]\nsides = 'left'\n");
    let check = verify(&parsed(&text.replace("width_m = 1.5", "width_m = 1.2"))).unwrap();
    let narrow = onsets_g_of(&text.replace("width_m = 1.5", "width_m = 1.2"));
    let own = &check.mechanisms[&Sway::Left];
    assert!((own.alpha0 / narrow[1] - 1.0).abs() < 1e-9);
    assert_eq!(own.forces.len(), 2);
    let works = own.forces.iter();
    let works = works.map(|it| it.force_x_kn * it.delta_x + it.force_y_kn * it.delta_y);
    let works: f64 = works.sum();
    // The pier turns outwards, with the thrust.
    let thrust = &own.forces[0];
    assert!(thrust.force_x_kn * thrust.delta_x > 0.01 * own.sum_p_delta_x_kn);
    let alpha0 = (own.sum_p_delta_y_kn - works) / own.sum_p_delta_x_kn;
    assert!((alpha0 / own.alpha0 - 1.0).abs() < 1e-9);
    let right = loads("right", 1.0);
    let mirrored = onsets_g(&format!("{fill}{right}"));
    assert!((mirrored[0] / onset_g[1] - 1.0).abs() < 1e-9);
    assert!((mirrored[1] / onset_g[0] - 1.0).abs() < 1e-9);
    let words = parsed(&format!("{PIERS}{left}")).structure.describe();
    assert!(words.contains("load on the left pier 2.5 m above its foot: 800 kg as constant weight, thrust of 3 kN to the left"), "{words}");
}

/// The capacity curve of a pushed arch begins at its onset, and decreases to zero.
#[test]
fn an_arch_on_piers_has_a_capacity_with_constant_forces() {
    let thrust = "[[load]]\npier = 'left'\nheight_m = 2.5\nthrust_n = -4000\n";
    let onset_g = onsets_g(thrust);
    let curves = capacity(&parsed(&format!("{PIERS}{thrust}")), None).unwrap();
    for (side, sway) in [Sway::Right, Sway::Left].into_iter().enumerate() {
        let curve = &curves.get(sway).as_ref().unwrap().curve;
        assert!((curve[0].acceleration_g / onset_g[side] - 1.0).abs() < 1e-9);
        assert!(curve.last().unwrap().acceleration_g.abs() < 1e-9);
    }
}
