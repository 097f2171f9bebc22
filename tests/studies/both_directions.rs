//! Studies of many histories in both directions of the ground motion, compared with the same studies in one direction, and with the mirrored structure.

use std::slice;

use crate::common::{COLUMN, ON_A_PIER, UNEVEN_ARCH, pairs, parsed};
use archrock::dynamics::{Direction, Directions};
use archrock::scenario::Scenario;
use archrock::studies::ensemble::Histories;
use archrock::studies::map::CellRow;
use archrock::studies::threshold::{
    Along, AlongOptions, EDGE_WIDTH, FactorRange, Threshold, threshold,
};
use archrock::studies::{Ending, NoHistory, Runner, Study, Verdict};
use archrock::{Factors, OverturningMap};
use std::ops::ControlFlow;

const PULSE: &str =
    "[ground.one_sine]\namplitude_g = 0.45\nvertical_amplitude_g = 0.1\nduration_s = 1.0\n";
const MAP: &str = "[map]\nduration_s = [0.4, 0.6, 1.0]\namplitude_g = [0.2, 0.35, 0.5, 0.8, 1.2]\n";
/// A smaller map of rows of blocks, whose cells are repeated: they take longer.
const REPEATED_MAP: &str = "[free_hinges]\n\
    [map]\nduration_s = [0.4, 1.0]\namplitude_g = [0.35, 0.5]\nrepeat = true\n";

/// An uneven arch on a pier, and its mirror image.
fn uneven() -> [String; 2] {
    let image = ON_A_PIER
        .replace("piers.right", "piers.left")
        .replace("x_m = 1.0", "x_m = -1.0");
    [ON_A_PIER.to_owned(), image].map(|tables| format!("{UNEVEN_ARCH}{tables}"))
}

/// A column with a wall behind it, and its mirror image.
fn walled() -> [String; 2] {
    ["right", "left"]
        .map(|side| format!("{COLUMN}[column.back]\nside = '{side}'\nheight_m = 4.0\n"))
}

fn scenario(tables: &str, direction: &str) -> Scenario {
    parsed(&format!(
        "{tables}{PULSE}[simulation]\nduration_s = 15.0\ndirection = '{direction}'\n"
    ))
}

fn cells(tables: &str, direction: &str) -> Vec<CellRow> {
    let scenario = scenario(tables, direction);
    let map = OverturningMap::of(&scenario).unwrap();
    let rows = map.rows(&(0..map.count()).collect::<Vec<_>>());
    // No row depends on the rows that are computed with it.
    for (index, row) in rows.iter().enumerate() {
        assert_eq!(map.rows(&[index]), slice::from_ref(row));
    }
    rows
}

/// Asserts that an ending in both directions has the numbers of the worse one, apart from its friction demand, which is the larger one.
#[track_caller]
fn assert_worse(
    both: &Result<Ending, NoHistory>,
    given: &Result<Ending, NoHistory>,
    mirrored: &Result<Ending, NoHistory>,
) -> Direction {
    let [both, given, mirrored] = [both, given, mirrored].map(|one| one.clone().unwrap());
    assert_eq!(
        (given.direction, mirrored.direction),
        (Direction::AsGiven, Direction::Mirrored)
    );
    let severity = |one: &Ending| (one.verdict(), one.peak_or_infinite_rad());
    let is_mirrored =
        given.verdict() != Verdict::Overturns && severity(&mirrored) > severity(&given);
    let demands = match given.verdict() {
        Verdict::Overturns => given.friction_demand,
        _ => [given.friction_demand, mirrored.friction_demand]
            .into_iter()
            .flatten()
            .reduce(f64::max),
    };
    let worse = if is_mirrored { mirrored } else { given };
    let expected = Ending {
        friction_demand: demands,
        ..worse
    };
    assert_eq!(both, expected);
    both.direction
}

/// Every cell has the numbers of the worse direction; the map of the mirrored structure has the same verdicts.
#[test]
fn cells_are_those_of_the_worse_direction() {
    for ([own, image], map) in [(uneven(), MAP), (walled(), MAP), (uneven(), REPEATED_MAP)] {
        let [own, image] = [own, image].map(|tables| tables + map);
        let [both, given, mirrored] =
            ["both", "as_given", "mirrored"].map(|direction| cells(&own, direction));
        let mut counts = [0, 0];
        for ((both, given), mirrored) in pairs(&both, &given).zip(&mirrored) {
            let direction = assert_worse(&both.result, &given.result, &mirrored.result);
            counts[usize::from(direction == Direction::Mirrored)] += 1;
            let of = if direction == Direction::Mirrored {
                mirrored
            } else {
                given
            };
            assert_eq!(both.outcomes, of.outcomes);
            assert_eq!(both.outcomes.is_some(), map == REPEATED_MAP);
        }
        assert!(counts[0] > 0 && counts[1] > 0, "{counts:?}");
        for (own, image) in pairs(&both, &cells(&image, "both")) {
            let verdict = |cell: &CellRow| cell.result.as_ref().unwrap().verdict();
            assert_eq!(verdict(own), verdict(image));
        }
    }
}

/// The threshold in both directions has the ranges of each, and quotes the lower one.
#[test]
fn thresholds_quote_the_lower_direction() {
    let factors = Factors::new(0.2, 3.0, 0.05).unwrap();
    for [own, image] in [uneven(), walled()] {
        let found = |tables: &str, direction: &str| -> Threshold {
            let scenario = scenario(tables, direction);
            let model = scenario.model().unwrap();
            let go_on = |_| ControlFlow::Continue(());
            let shaken = (scenario.simulation.direction, scenario.ground_motion());
            let (named, request) = (("model", &*model), scenario.request());
            threshold(named, shaken, &request, &factors, &Runner::default(), go_on).unwrap()
        };
        let [both, given, mirrored] =
            ["both", "as_given", "mirrored"].map(|direction| found(&own, direction));
        assert!(given.mirrored.is_none() && mirrored.mirrored.is_none());
        let second = both.mirrored.as_ref().unwrap();
        assert_eq!(
            (&both.samples, &both.ranges),
            (&given.samples, &given.ranges)
        );
        assert_eq!(
            [both.direction, second.direction, mirrored.direction],
            [Direction::AsGiven, Direction::Mirrored, Direction::Mirrored]
        );
        // The mirrored motion is searched up to the first factor that certainly overturns as given.
        let count = second.samples.len();
        assert!(count < mirrored.samples.len());
        let alike = second.samples.iter().zip(&mirrored.samples);
        assert!(
            alike
                .take(count - 1)
                .all(|(one, other)| one.factor == other.factor)
        );
        let [low, high] = [given.survives_up_to(), mirrored.survives_up_to()];
        let (low, high) = (low.unwrap(), high.unwrap());
        assert!(low != high);
        assert_eq!(both.survives_up_to(), Some(low.min(high)));
        let [low, high] = [&given, &mirrored].map(|one| one.lowest_factor().unwrap());
        assert_eq!(both.lowest_factor(), Some(low.min(high)));
        let governs = if low < high {
            Direction::AsGiven
        } else {
            Direction::Mirrored
        };
        assert_eq!(both.governing().direction, governs);
        // The mirrored structure exchanges the directions.
        let exchanged = found(&image, "both");
        let near = |one: Option<f64>, other: Option<f64>| {
            (one.unwrap() / other.unwrap() - 1.0).abs() < EDGE_WIDTH
        };
        assert!(near(exchanged.survives_up_to(), both.survives_up_to()));
        assert!(exchanged.governing().direction != governs);
        let first = |one: &Threshold| one.ranges_with(Verdict::Survives).first().copied();
        let [one, other] = [first(&exchanged), first(&mirrored)];
        let to = |range: Option<FactorRange>| range.map(|range| range.to);
        assert!(near(to(one), to(other)));
    }
}

/// A threshold along a key is the lower one of both directions, with the direction.
#[test]
fn thresholds_along_a_key_are_those_of_the_worse_direction() {
    let [own, _] = uneven();
    let found = |direction: &str| {
        let scenario = scenario(&own, direction);
        let options = AlongOptions {
            along: "ground.one_sine.duration_s=0.9..1.1:2".parse().unwrap(),
            factors: Factors::new(0.2, 3.0, 0.05).unwrap(),
            no_impact: true,
        };
        Along::of(&scenario, options).unwrap().rows(&[0, 1])
    };
    let [both, given, mirrored] = ["both", "as_given", "mirrored"].map(found);
    for ((both, given), mirrored) in pairs(both, given).zip(mirrored) {
        let [edge, given_edge, mirrored_edge] =
            [&both, &given, &mirrored].map(|row| row.edge.clone().unwrap());
        let lower = match given_edge.factor < mirrored_edge.factor {
            true => &given_edge,
            false => &mirrored_edge,
        };
        assert_eq!(
            (edge.factor, edge.survives_up_to, edge.direction),
            (lower.factor, lower.survives_up_to, lower.direction)
        );
        let [one, other, all] =
            [&given, &mirrored, &both].map(|row| row.no_impact.clone().unwrap().unwrap());
        assert_eq!(all, one.into_iter().chain(other).reduce(f64::min));
    }
}

/// Each sample of a run has the ending of the worse direction, and the rotations of the ground motion as given.
#[test]
fn samples_of_a_run_are_those_of_the_worse_direction() {
    let [own, _] = uneven();
    let uncertain = "[free_hinges]\n[uncertain]\nsamples = 6\n\"ground.one_sine.amplitude_g\" = { from = 0.25, to = 0.6 }\n";
    let found = |direction: &str| {
        let scenario = scenario(&format!("{own}{uncertain}"), direction);
        let ensemble = Histories::of(&scenario).unwrap();
        let rows = ensemble.rows(&(0..ensemble.count()).collect::<Vec<_>>());
        let answers = rows.into_iter().map(|row| row.answer.unwrap());
        answers.collect::<Vec<_>>()
    };
    let [both, given, mirrored] = ["both", "as_given", "mirrored"].map(found);
    let mut mirrored_count = 0;
    for ((both, given), mirrored) in pairs(both, given).zip(mirrored) {
        assert_eq!(both.course_rad, given.course_rad);
        // The energy balance is checked at samples too, which only the first direction has.
        let [worse, given, mirrored] = [both, given, mirrored].map(|one| {
            Ok(Ending {
                energy_defect_ratio: 0.0,
                ..one.ending
            })
        });
        let direction = assert_worse(&worse, &given, &mirrored);
        mirrored_count += usize::from(direction == Direction::Mirrored);
    }
    assert!(mirrored_count > 0);
}

/// The name of a direction is that of its key, and the default is both.
#[test]
fn both_directions_are_the_default() {
    let [own, _] = uneven();
    let scenario = parsed(&format!("{own}{PULSE}"));
    assert_eq!(scenario.simulation.direction, Directions::Both);
    let model = scenario.model().unwrap();
    assert!(scenario.has_second_direction(&*model));
}
