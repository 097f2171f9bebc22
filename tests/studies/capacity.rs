//! Capacity curves against closed forms, the onset, the potential of the simulation and mirror images.

use crate::common::parsed;
use crate::common::program;
use archrock::mechanics::settling::Held;
use archrock::mechanics::stability::onset;
use archrock::mechanics::{Capacity, CurvePoint, Mechanism as _, MechanismChain as _};
use archrock::scenario::Structure;
use archrock::studies::{self, CapacityCurveError};
use archrock::{
    Column, FourLinks, GroundMotion, ImpactModel, Initial, Model as _, Request, Scenario, Sway,
};
use nalgebra::Vector2;

/// The capacity curves to the right and to the left.
fn capacity(
    scenario: &Scenario,
    point_m: Option<Vector2<f64>>,
) -> Result<[Capacity; 2], CapacityCurveError> {
    let sides = studies::capacity(scenario, point_m)?;
    Ok(sides.map(|side| side.clone().unwrap()).into())
}

const SIDES: [Sway; 2] = [Sway::Right, Sway::Left];

const POINTED: &str = "[pointed_arch]\nspan_m = 6\nrise_m = 4\nthickness_m = 0.6\nvoussoirs = 14\n[piers]\nheight_m = 2\n\
                       width_m = 1.6\n[[load]]\nmass_kg = 1500\nx_m = 1\n";

/// A block that turns about its toe: `a = tan(alpha - q)`, and the middle of its top moves on a circle.
#[test]
fn a_column_has_the_capacity_of_a_block() {
    let (height_m, width_m) = (4.0, 0.8);
    let scenario = parsed("[column]\nheight_m = 4\nwidth_m = 0.8\n");
    let alpha = Column::new(height_m, width_m).unwrap().slenderness_rad();
    for side in &capacity(&scenario, None).unwrap() {
        assert!((side.mass_fraction - 1.0).abs() < 1e-12);
        assert!((side.participating_mass_kg / (2000.0 * height_m * width_m) - 1.0).abs() < 1e-12);
        let (end, start) = (side.end(), side.first_point());
        assert!((end.q_rad - alpha).abs() < 1e-12);
        assert!((start.acceleration_g - width_m / height_m).abs() < 1e-12);
        for point in &side.curve {
            let (sin, cos) = point.q_rad.sin_cos();
            assert!((point.acceleration_g - (alpha - point.q_rad).tan()).abs() < 1e-12);
            let top = height_m * sin + 0.5 * width_m * (1.0 - cos);
            assert!((point.displacement_m - top).abs() < 1e-12);
            // Its centre of gravity is half as high, and starts half as fast.
            assert!((point.oscillator_displacement_m - 0.5 * top).abs() < 1e-9);
        }
        // Both values are on straight lines between a hundred points.
        let half = side.secant_period_s(0.5, 9.81).unwrap();
        let middle = &side.curve[50];
        assert!(
            (half / middle.secant_period_s.unwrap() - 1.0).abs() < 0.02,
            "{half}"
        );
    }
}

fn check_side(side: &Capacity, incipient_g: f64) {
    assert!((side.first_point().acceleration_g / incipient_g - 1.0).abs() < 1e-9);
    assert_eq!(side.end().acceleration_g, 0.0);
    assert!(side.curve[99].acceleration_g > 0.0);
    assert!((side.first_point().displacement_m).abs() < 1e-12);
    let falls = side.curve.windows(2);
    for pair in falls {
        assert!(pair[1].acceleration_g < pair[0].acceleration_g);
        assert!(pair[1].displacement_m > pair[0].displacement_m);
    }
    assert!(side.mass_fraction > 0.0 && side.mass_fraction < 1.0);
    let start = side.first_point();
    let part = start.acceleration_g / start.oscillator_acceleration_g;
    assert!((part - side.mass_fraction).abs() < 1e-12);
}

#[test]
fn curves_begin_at_the_onset_and_end_at_the_unstable_equilibrium() {
    for text in [
        "[arch]\nmean_radius_m = 5\nthickness_ratio = 0.15\nembrace_deg = 180\n",
        "[arch]\nmean_radius_m = 10\nthickness_ratio = 0.15\nembrace_deg = 157.5\nvoussoirs = 7\n",
        POINTED,
    ] {
        let scenario = parsed(text);
        let model = scenario.mechanisms().unwrap();
        for side in &capacity(&scenario, None).unwrap() {
            check_side(side, model.incipient_acceleration_g(side.sway).unwrap());
        }
    }
}

/// The work of the horizontal force that holds the mechanism equals its potential energy: `int a dX = Y`, where `X` and `Y`
/// are mass times displacement of the centre of gravity. It also equals the energy of a history released there.
#[test]
fn the_work_along_the_curve_is_the_potential_of_the_simulation() {
    let scenario = parsed(POINTED);
    let Structure::Masonry(masonry) = &scenario.structure else {
        panic!("{:?}", &scenario.structure);
    };
    let model = FourLinks::of_row(&masonry.row, ImpactModel::MaxRestitution).unwrap();
    let unit_j = 9.81 * model.mass_unit_kg() * model.length_m();
    for (sway, side) in SIDES.into_iter().zip(&capacity(&scenario, None).unwrap()) {
        let mechanism = &model.link_from(sway, 0).unwrap().mechanism;
        let mut work = 0.0;
        // Simpson over pairs of intervals.
        for pair in side.curve.windows(3).step_by(2) {
            let slope =
                |i: usize| pair[i].acceleration_g * mechanism.coefficients(pair[i].q_rad).s_x;
            work += (slope(0) + 4.0 * slope(1) + slope(2)) * (pair[2].q_rad - pair[0].q_rad) / 6.0;
            let q_rad = pair[2].q_rad;
            assert!((work / mechanism.displacement(q_rad).y - 1.0).abs() < 1e-8);
            if q_rad > 0.99 * side.end().q_rad {
                continue;
            }
            let request = Request {
                initial: Some(Initial {
                    sway,
                    rotation_rad: q_rad,
                    rate_rad_s: 0.0,
                }),
                end_s: 0.01,
                ..Request::default()
            };
            let history = model.history(&GroundMotion::still(), &request).unwrap();
            let energy_j = history.samples.iter().next().unwrap().energy_j;
            assert!((work * unit_j / energy_j - 1.0).abs() < 1e-8);
        }
    }
}

#[test]
fn mirror_images_exchange_their_sides() {
    let mirrored = POINTED.replace("x_m = 1", "x_m = -1");
    let (own, image) = (
        capacity(&parsed(POINTED), Some(Vector2::new(0.5, 4.0))).unwrap(),
        capacity(&parsed(&mirrored), Some(Vector2::new(-0.5, 4.0))).unwrap(),
    );
    for (side, seen) in own.iter().zip(image.iter().rev()) {
        assert!((side.mass_fraction / seen.mass_fraction - 1.0).abs() < 1e-9);
        for (a, b) in side.curve.iter().zip(&seen.curve) {
            assert!((a.displacement_m - b.displacement_m).abs() < 1e-9);
            assert!((a.acceleration_g - b.acceleration_g).abs() < 1e-9);
        }
    }
    assert!((own[0].end().displacement_m / own[1].end().displacement_m - 1.0).abs() > 0.05);
}

/// The command writes what the library returns, and a wrong point is a usage error.
#[test]
fn the_command_writes_table_picture_and_summary() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.toml"), POINTED).unwrap();
    let output = program::archrock(folder.path(), &["capacity", "a.toml", "--format", "json"]);
    assert!(output.status.success(), "{}", program::stderr(&output));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["masses"], "16 blocks");
    let own = capacity(&parsed(POINTED), None).unwrap();
    let results = folder.path().join("results/a");
    let table = std::fs::read_to_string(results.join("capacity.csv")).unwrap();
    let rows: Vec<Vec<&str>> = table
        .lines()
        .map(|line| line.split(',').collect())
        .collect();
    for (index, side) in own.iter().enumerate() {
        let reported = &json["capacity"][side.sway.name()];
        assert_eq!(
            reported["acceleration_g"],
            side.first_point().acceleration_g
        );
        assert_eq!(
            reported["ultimate_displacement_m"],
            side.end().displacement_m
        );
        assert_eq!(reported["oscillator"]["mass_fraction"], side.mass_fraction);
        for (point, row) in side.curve.iter().zip(&rows[1 + index * side.curve.len()..]) {
            assert_eq!(row[0], side.sway.name());
            assert_eq!(row[2].parse::<f64>().unwrap(), point.displacement_m);
            assert_eq!(row[3].parse::<f64>().unwrap(), point.acceleration_g);
        }
    }
    let picture = std::fs::read_to_string(results.join("capacity.svg")).unwrap();
    assert!(roxmltree::Document::parse(&picture).is_ok());
    for (point, words) in [("0", "two coordinates"), ("0,100", "not on the structure")] {
        let output = program::archrock(folder.path(), &["capacity", "a.toml", "--point", point]);
        assert_eq!(output.status.code(), Some(2));
        assert!(
            program::stderr(&output).contains(words),
            "{}",
            program::stderr(&output)
        );
    }
}

/// At rest the secant has no displacement, and its period is undefined: in every scenario of the repository that has four
/// links or is a block.
#[test]
fn curves_begin_at_no_displacement_and_no_period() {
    let folder = tempfile::tempdir().unwrap();
    let mut curves = 0;
    for path in program::scenario_files() {
        let arguments = ["capacity", path.to_str().unwrap(), "--out", "out"];
        let output = program::archrock(folder.path(), &arguments);
        if !output.status.success() {
            continue;
        }
        let table = std::fs::read_to_string(folder.path().join("out/capacity.csv")).unwrap();
        assert!(!table.contains("NaN"), "{}", path.display());
        // A wall behind a column leaves one side.
        let name = path.file_name().unwrap().to_string_lossy();
        let sides: &[&str] = match name.starts_with("facade") {
            true => &["right"],
            false => &["right", "left"],
        };
        for side in sides {
            let first = table.lines().find(|line| line.starts_with(side)).unwrap();
            let cells: Vec<&str> = first.split(',').collect();
            assert_eq!([cells[2], cells[4], cells[6]], ["0.0"; 3], "{first}");
            curves += 1;
        }
    }
    assert!(curves >= 2 * 8, "{curves}");
}

#[test]
fn control_points_must_be_on_the_structure_and_move() {
    let scenario = parsed(POINTED);
    let outside = capacity(&scenario, Some(Vector2::new(0.0, 0.0))).unwrap_err();
    assert_eq!(outside, CapacityCurveError::Outside(Vector2::zeros()));
    // The left pier stands still while the arch sways right, because the hinges are in the arch and at the right springing.
    let still = capacity(&scenario, Some(Vector2::new(-3.5, -1.0))).unwrap_err();
    assert!(
        still.to_string().contains("does not move to the right"),
        "{still}"
    );
    let lintel = "[arch]\nmean_radius_m = 5\nthickness_ratio = 0.3\nembrace_deg = 90\nvoussoirs = 5\n[free_hinges]\n";
    let refused = capacity(&parsed(lintel), None);
    assert!(
        matches!(refused, Err(CapacityCurveError::FourLinks(_))),
        "{refused:?}"
    );
}

/// A column on its toe with a bar to its left that starts level, by moments about the toe at any rotation. The bar yields and
/// breaks during the motion.
#[test]
fn a_tied_column_has_the_capacity_of_a_block_and_a_bar() {
    let (stiffness, natural) = (1e5, 3.0 - 5e3 / 1e5);
    // The bar never breaks, breaks after yielding, breaks before it could yield, or breaks when nothing else holds the column.
    let whole = f64::INFINITY;
    for (yields_at, breaks_at) in [
        (5e3, whole),
        (8e3, whole),
        (8e3, 0.1),
        (8e3, 0.02),
        (8e3, 0.3),
    ] {
        let breaks = if breaks_at < 1.0 {
            format!("breaks_at_strain = {breaks_at}\n")
        } else {
            String::new()
        };
        let scenario = parsed(&format!(
            "[column]\nheight_m = 4\nwidth_m = 0.8\n[free_hinges]\n[[tie]]\nfrom_m = [-0.4, 3.5]\nto_m = [-3.4, 3.5]\nto_block = 0\n\
             stiffness_n_m = 1e5\nprestress_n = 5e3\nyield_force_n = {yields_at:?}\n{breaks}"
        ));
        let [right, left] = capacity(&scenario, None).unwrap();
        // The value of this column by the clause.
        assert!((right.first_point().acceleration_g - 0.339_366_718).abs() < 5e-10);
        let weight = 6400.0 * 9.81;
        let bears = |q: f64| {
            let (sin, cos) = q.sin_cos();
            let turned = |x: f64, y: f64| [x * cos + y * sin, y * cos - x * sin];
            let ([x, y], end) = (turned(-0.4, 2.0), turned(-0.8, 3.5));
            let apart = [-3.8 - end[0], 3.5 - end[1]];
            let length = apart[0].hypot(apart[1]);
            let broken = length - natural >= breaks_at * natural;
            let force = (stiffness * (length - natural)).min(yields_at);
            let force = if broken { 0.0 } else { force / length };
            let back = force * (end[0] * apart[1] - end[1] * apart[0]);
            ((back - weight * x) / (weight * y), length)
        };
        for point in &right.curve {
            // The curve just before and just after the break; if the break takes all strength, the curve ends at zero.
            let due_g = |more: f64| bears(point.q_rad + more).0.max(0.0);
            let off = |more: f64| (point.acceleration_g - due_g(more)).abs();
            let off_g = off(0.0).min(off(-1e-13)).min(off(1e-13));
            assert!(off_g < 1e-9, "{}: {off_g:e}", point.q_rad);
        }
        assert!(bears(right.end().q_rad + 1e-9).0 < 0.0);
        let gives_way = right.ties[0];
        // The force of the bar is largest at yielding and drops to zero at the break; the curve has points at both.
        let at = |displacement_m: f64| {
            let near = |point: &&CurvePoint| (point.displacement_m - displacement_m).abs() < 1e-12;
            right.curve.iter().filter(near).copied().collect::<Vec<_>>()
        };
        let yields = gives_way.yields_at_m.map(at);
        let yields_first = yields_at / stiffness < breaks_at * natural;
        assert_eq!(yields.is_some(), yields_first, "{breaks_at}");
        if let Some(yields) = yields {
            let stretch = bears(yields[0].q_rad).1 - natural;
            assert!((stretch - yields_at / stiffness).abs() < 1e-9);
        }
        let breaks = gives_way.breaks_at_m.map(at);
        assert_eq!(breaks.is_some(), breaks_at < 1.0);
        if let Some(breaks) = breaks {
            let [whole, broken] = breaks[..] else {
                panic!("{breaks:?}");
            };
            assert!((bears(whole.q_rad).1 - natural * (1.0 + breaks_at)).abs() < 1e-9);
            // The whole force of the bar acts at its lever arm, initially 3.5 m above the toe; that of the weight is 2 m.
            assert!(whole.acceleration_g > broken.acceleration_g + 0.1);
            assert_eq!(broken == *right.end(), breaks_at == 0.3);
        }
        // In a sway to the left the bar goes slack at once. The column falls as without it, from a push reduced by the force at
        // rest.
        let least = 0.2 - 5e3 * 3.5 / (weight * 2.0);
        assert!((left.first_point().acceleration_g - least).abs() < 1e-9);
    }
}

/// A semicircle with an almost forceless tie has the capacity of the linkage without ties, which is computed separately. With a
/// real tie the curve starts at the push of limit analysis and follows the slope of the energy of weight and bar, which uses no
/// forces.
#[test]
fn the_capacity_of_a_tied_arch_is_the_slope_of_its_energy() {
    let arch = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\nvoussoirs = 24\n[free_hinges]\n";
    let tie = |stiffness: f64, prestress: f64| {
        parsed(&format!(
            "{arch}[[tie]]\nheight_m = 2.0\nstiffness_n_m = {stiffness:?}\nprestress_n = {prestress:?}\nyield_force_n = 2e4\n"
        ))
    };
    let untied = capacity(&parsed(arch), None).unwrap();
    let loose = capacity(&tie(1e-3, 0.0), None).unwrap();
    for (own, other) in untied.iter().zip(&loose) {
        let (own_m, other_m) = (own.end().displacement_m, other.end().displacement_m);
        assert!((own_m / other_m - 1.0).abs() < 1e-6, "{own_m} {other_m}");
        // The rotation of the body at the same end, with and without ties, to either side.
        assert!((own.end().q_rad / other.end().q_rad - 1.0).abs() < 1e-6);
        assert!((own.participating_mass_kg / other.participating_mass_kg - 1.0).abs() < 1e-6);
        for part in [0.0, 0.3, 0.7] {
            let [own_g, other_g] = [own, other].map(|side| side.oscillator_acceleration_g(part));
            assert!((own_g - other_g).abs() < 2e-5, "{part}: {own_g} {other_g}");
        }
    }
    let scenario = tie(1e5, 1e4);
    let row = scenario.structure.row().unwrap();
    for side in SIDES {
        let held = Held::new(&row, side).unwrap();
        let start_g = onset(&row, side).unwrap().unwrap().acceleration_g;
        assert!((held.displaced_mechanism(0.0).acceleration_g - start_g).abs() < 1e-9);
        // Heights, lateral displacements and energy of the bar, over the whole mass.
        let known = |part: f64| {
            let displaced = held.displaced_mechanism(part);
            let joints: Vec<usize> = held.pins.hinges.iter().map(|hinge| hinge.joint).collect();
            let place = |block: usize, at: Vector2<f64>| {
                let before = joints.iter().filter(|joint| **joint <= block).count();
                let body = before.checked_sub(1).filter(|body| *body < 3);
                body.map_or(at, |body| displaced.poses[body].current_position(at))
            };
            let blocks = row.blocks.iter().enumerate();
            let sum: Vector2<f64> = blocks
                .map(|(index, block)| place(index, block.centre_m) * block.mass_kg)
                .sum();
            let tie = &row.ties[0];
            let [one, other] =
                [0, 1].map(|end| place(tie.ends[end].block.unwrap(), tie.ends[end].at_m));
            let stretch = (other - one).norm() - tie.slack_length_m();
            let yields = tie.yield_force_n / tie.stiffness_n_m;
            let elastic = stretch.clamp(0.0, yields);
            let energy = 0.5 * tie.stiffness_n_m * elastic * elastic
                + tie.yield_force_n * (stretch - yields).max(0.0);
            (sum.y + energy / 9.81, side.sign() * sum.x)
        };
        for part in [0.05, 0.3, 0.6, 0.95] {
            let ((before, left), (after, right)) = (known(part - 1e-4), known(part + 1e-4));
            let due_g = (after - before) / (right - left);
            let told_g = held.displaced_mechanism(part).acceleration_g;
            assert!((told_g - due_g).abs() < 1e-6, "{part}: {told_g} {due_g}");
        }
    }
    let rigid = "stiffness_n_m = 1e8\n";
    let text = format!("{arch}[[tie]]\nheight_m = 2.0\n{rigid}");
    let error = capacity(&parsed(&text), None).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("give the ties a `yield_force_n`"),
        "{error}"
    );
}

/// Drums with flush faces turn about the base as one block does.
#[test]
fn drums_have_the_capacity_of_a_block() {
    let curve = |drums: &str| {
        let text = format!("[column]\nheight_m = 4.0\nwidth_m = 0.8\n{drums}[free_hinges]\n");
        capacity(&parsed(&text), Some(Vector2::new(0.0, 3.9))).unwrap()
    };
    for (drums, block) in curve("drums = 5\n").iter().zip(&curve("")) {
        assert_eq!(drums.curve.len(), block.curve.len());
        for (drums, block) in drums.curve.iter().zip(&block.curve) {
            assert!((drums.acceleration_g - block.acceleration_g).abs() < 1e-12);
            assert!((drums.displacement_m - block.displacement_m).abs() < 1e-9);
        }
    }
}

/// Static commands need neither records of the ground nor a model of motion: records may be missing, and drums and moved
/// springings work. Commands that simulate still need both.
#[test]
fn statics_need_no_ground_motion_and_no_model_of_motion() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let record = "[ground.record]\nfile = \"nowhere.at2\"\n";
    let arch = "[arch]\nmean_radius_m = 5.0\nthickness_ratio = 0.15\nembrace_deg = 180.0\nvoussoirs = 12\n";
    let drums = "[column]\nheight_m = 4.0\nwidth_m = 1.0\ndrums = 5\n";
    let moved = "[supports]\nright = { spread_m = 0.05 }\n";
    let write = |name: &str, text: &str| {
        std::fs::write(path.join(format!("{name}.toml")), text).unwrap();
        format!("{name}.toml")
    };
    let missing = "cannot be read";
    let of_arch = write("arch", &format!("{arch}{record}"));
    let of_drums = write("drums", &format!("{drums}{record}"));
    let of_moved = write("moved", &format!("{arch}{moved}{record}"));
    let pulse = "[ground.half_sine]\namplitude_g = 0.3\nduration_s = 0.5\n";
    let of_right_foot = write(
        "right-foot",
        &format!("{arch}[free_hinges]\n{pulse}[ground.right.record]\nfile = \"nowhere.at2\"\n"),
    );
    for (command, file) in [
        ("limit", &of_right_foot),
        ("spread", &of_right_foot),
        ("capacity", &of_right_foot),
        ("limit", &of_arch),
        ("spread", &of_arch),
        ("capacity", &of_arch),
        ("limit", &of_drums),
        ("capacity", &of_drums),
        ("limit", &of_moved),
        ("spread", &of_moved),
    ] {
        program::printed(path, &[command, file]);
        program::refused(path, &["run", file], &[missing]);
    }
    for file in [&of_right_foot, &of_arch, &of_drums, &of_moved] {
        program::refused(path, &["check", file], &[missing]);
    }
    // Errors in the scenario itself are errors in all of them.
    let wrong = write("wrong", &format!("{arch}{record}scael = 2.0\n"));
    for command in ["limit", "check"] {
        program::refused(path, &[command, &wrong], &["unknown key `scael`"]);
    }
    // The numbers are the same with a model of motion.
    let free = write("free", &format!("{arch}{moved}[free_hinges]\n"));
    let numbers = |file: &str| program::printed(path, &["limit", file, "--format", "json"]);
    assert_eq!(numbers(&of_moved), numbers(&free));
}
