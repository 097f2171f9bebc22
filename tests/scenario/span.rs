//! Arches given by their span.

use crate::common::parsed;
use crate::common::program::printed;
use archrock::Scenario;
use archrock::scenario::Structure;

fn arch(keys: &str) -> Result<archrock::Arch, String> {
    let text = format!("[arch]\n{keys}\n");
    match Scenario::parse(&text, "s.toml") {
        Ok(scenario) => match &scenario.structure {
            Structure::Arch(arch) => Ok(arch.clone()),
            other => panic!("{other:?}"),
        },
        Err(errors) => Err(errors.to_string()),
    }
}

/// Distance between the springings and height of the crown above them, along the line that lies this many thicknesses
/// outside the middle line.
fn span_and_rise_m(arch: &archrock::Arch, outwards: f64) -> (f64, f64) {
    let radius_m = arch.mean_radius_m * (1.0 + outwards * arch.thickness_ratio);
    let half = 0.5 * arch.embrace_deg.to_radians();
    (2.0 * radius_m * half.sin(), radius_m * (1.0 - half.cos()))
}

#[test]
fn an_arch_has_the_given_span_and_rise() {
    for (line, outwards) in [("intrados", -0.5), ("mean", 0.0), ("extrados", 0.5)] {
        for thickness in ["thickness_m = 0.9", "thickness_ratio = 0.2"] {
            for (height, rise_m) in [("rise_m = 2.2", Some(2.2)), ("embrace_deg = 150", None)] {
                let keys = format!("span_m = 6\nmeasured_at = '{line}'\n{height}\n{thickness}");
                let arch = arch(&keys).unwrap();
                let (span_m, rise) = span_and_rise_m(&arch, outwards);
                assert!((span_m - 6.0).abs() < 1e-12, "{keys}");
                match rise_m {
                    Some(rise_m) => assert!((rise - rise_m).abs() < 1e-12, "{keys}"),
                    None => assert_eq!(arch.embrace_deg, 150.0),
                }
                let thickness_m = arch.thickness_ratio * arch.mean_radius_m;
                if thickness.contains("_m") {
                    assert!((thickness_m - 0.9).abs() < 1e-12);
                } else {
                    assert!((arch.thickness_ratio - 0.2).abs() < 1e-15);
                }
            }
        }
    }
    // A semicircle, exact to the last bit.
    let semicircle = arch("span_m = 6\nmeasured_at = 'mean'\nrise_m = 3\nthickness_ratio = 0.2");
    let by_radius = arch("mean_radius_m = 3\nembrace_deg = 180\nthickness_ratio = 0.2");
    assert_eq!(semicircle, by_radius);
}

#[test]
fn conflicting_dimensions_are_refused() {
    const SPAN: &str = "span_m = 6\nmeasured_at = 'intrados'\n";
    for (keys, message) in [
        (
            "span_m = 6\nrise_m = 2\nthickness_m = 0.9".to_owned(),
            "s.toml:2:10: `span_m = 6` needs `measured_at` beside it: \"intrados\", \"mean\" or \"extrados\"",
        ),
        (
            format!("{SPAN}thickness_m = 0.9"),
            "s.toml:1:1: [arch] needs exactly one of the keys rise_m, embrace_deg",
        ),
        (
            format!("{SPAN}rise_m = 2\nembrace_deg = 150\nthickness_m = 0.9"),
            "s.toml:5:15: `embrace_deg` cannot be combined with `rise_m`",
        ),
        (
            format!("{SPAN}rise_m = 2\nmean_radius_m = 3\nthickness_m = 0.9"),
            "s.toml:5:17: `mean_radius_m` cannot be combined with `span_m`",
        ),
        (
            format!("{SPAN}rise_m = 3.1\nthickness_m = 0.9"),
            "s.toml:4:10: `rise_m = 3.1` makes an embrace angle of 183.757 degrees; must be from 1 to 180, which is a \
             rise of at most half the span",
        ),
        // span/2 tan(1/4 degree), rounded up so that it is allowed.
        (
            format!("{SPAN}rise_m = 0.001\nthickness_m = 0.001"),
            "s.toml:4:10: `rise_m = 0.001` makes an embrace angle of 0.0763944 degrees; must be from 1 to 180, which is a \
             rise of at least 0.0131 m for this span",
        ),
        (
            "mean_radius_m = 3\nrise_m = 2\nembrace_deg = 150\nthickness_m = 0.9".to_owned(),
            "s.toml:3:10: `rise_m = 2` needs `span_m`",
        ),
        (
            "span_m = 6\nmeasured_at = 'extrados'\nembrace_deg = 150\nthickness_m = 8".to_owned(),
            "s.toml:5:15: `thickness_m = 8` is out of range: -8.94683 mean radii of -0.894171 m",
        ),
        (
            format!("{SPAN}embrace_deg = 150\nthickness_m = 0.01"),
            "s.toml:5:15: `thickness_m = 0.01` makes an arch that cannot carry its own weight",
        ),
    ] {
        assert!(
            arch(&keys).unwrap_err().starts_with(message),
            "{}",
            arch(&keys).unwrap_err()
        );
    }
}

/// Dimensions are printed and drawn as the file gives them.
#[test]
fn dimensions_are_printed_as_given() {
    let keys = "span_m = 4.2\nrise_m = 1.4\nmeasured_at = \"intrados\"\nthickness_m = 0.35\n";
    for beside in ["", "voussoirs = 15\n[piers]\nheight_m = 1\nwidth_m = 0.6\n"] {
        let scenario = parsed(&format!("[arch]\n{keys}{beside}"));
        assert!(scenario.to_toml().contains(keys), "{}", scenario.to_toml());
        assert!(!scenario.to_toml().contains("mean_radius_m"));
        assert_eq!(parsed(&scenario.to_toml()), scenario);
        let dimensions = scenario.structure.dimensions();
        assert_eq!(dimensions[0].words, "span 4.2 m at the intrados");
        assert_eq!(dimensions[1].words, "rise 1.4 m at the intrados");
        let [left, right] = dimensions[0].ends_m;
        assert!((right.x - left.x - 4.2).abs() < 1e-12);
        let words = scenario.structure.describe();
        assert!(words.contains("span and rise at the intrados"), "{words}");
    }
    let text =
        "[arch]\nspan_m = 6\nembrace_deg = 180\nmeasured_at = 'mean'\nthickness_ratio = 0.15\n";
    let scenario = parsed(text);
    let due = "span_m = 6.0\nembrace_deg = 180.0\nmeasured_at = \"mean\"\nthickness_ratio = 0.15\n";
    assert!(scenario.to_toml().contains(due), "{}", scenario.to_toml());
    // Values that vary in studies vary the resolved arch.
    let varied = scenario
        .with_values(&[("arch.mean_radius_m", 6.0)])
        .unwrap();
    let arch = varied.structure.circular_arch().unwrap();
    assert_eq!((arch.mean_radius_m, arch.thickness_ratio), (6.0, 0.15));
}

/// `check` states for every structure where y = 0 lies, and for a tie its position relative to the springings.
#[test]
fn check_states_the_frame_of_reference() {
    let tie = "[[tie]]\nstiffness_n_m = 1e7\nheight_m = ";
    let segment = "[arch]\nspan_m = 4.2\nrise_m = 1.4\nmeasured_at = \"intrados\"\nthickness_m = 0.35\nvoussoirs = 15\n";
    let circle = "y = 0 at the centre of the circle, 0.875 m below the intrados of the springings; x = 0 in the middle of the span";
    let pointed = "[pointed_arch]\nspan_m = 6\nrise_m = 4\nthickness_m = 0.6\nvoussoirs = 14\n";
    let springing = "y = 0 at the springings, x = 0 in the middle of the span";
    for (structure, height_m, origin, place) in [
        (
            segment,
            1.2,
            circle,
            "0.325 m above the intrados of the springings",
        ),
        (
            pointed,
            1.0,
            springing,
            "1 m above the intrados of the springings",
        ),
    ] {
        let text = format!("[free_hinges]\n{structure}{tie}{height_m}\n");
        let scenario = parsed(&text);
        let structure = &scenario.structure;
        assert_eq!(structure.origin(), origin);
        let ties = structure.ties_in_words();
        assert!(ties.len() == 1 && ties[0].ends_with(place), "{ties:?}");
        let [from, to] = structure.ties()[0].ends;
        assert!((from.at_m.y - height_m).abs() < 1e-9 && (to.at_m.y - height_m).abs() < 1e-9);
        for words in [origin, place] {
            assert!(structure.describe().contains(words));
        }
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("s.toml"), &text).unwrap();
        let said = printed(folder.path(), &["check", "s.toml"]);
        assert!(
            said.starts_with(&format!("# {origin}\n# tie 1 from (")),
            "{said}"
        );
        // The notes are comments: the text is a scenario.
        assert_eq!(parsed(&said).structure, scenario.structure);
    }
    let semicircle =
        parsed("[arch]\nmean_radius_m = 5\nthickness_ratio = 0.15\nembrace_deg = 180\n");
    let words = semicircle.structure.origin();
    assert!(
        words.contains("centre of the circle, level with the springings"),
        "{words}"
    );
    let column = parsed("[column]\nheight_m = 4\nwidth_m = 1\n");
    assert_eq!(
        column.structure.origin(),
        "y = 0 at the base, x = 0 in its middle"
    );
}
