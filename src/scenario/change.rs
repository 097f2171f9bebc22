//! Changes of the tables that were given: the one way in which `--set`, axes of maps, `--along` and samples change a scenario.
//!
//! A new value replaces its alternatives, such as `thickness_m` for `thickness_ratio`. Relations of the readers define them. Values that depend on
//! the new one follow, such as the drums of a column under a new height.

use std::mem;
use std::sync::LazyLock;

use super::document::{Entries, KeyGroup};
use super::prelude::*;
use super::{Scenario, span};

/// The JSON schema of all tables of a scenario, and the keys that exclude or need each other.
static DESCRIPTION: LazyLock<(Value, Vec<KeyGroup>)> = LazyLock::new(Scenario::describe);

/// The key of `[suite]` that is an older name of `direction` in `[simulation]`.
pub(super) const BOTH_SIGNS: &str = "both_signs";

/// True if a key is a count, which must be a whole number.
pub(super) fn is_count(tables: &[&str], key: &str) -> bool {
    let table = tables.iter().fold(&DESCRIPTION.0, |outer, name| {
        let inner = &outer["properties"][*name];
        inner.get("items").unwrap_or(inner)
    });
    table["properties"][key]["type"] == "integer"
}

/// Groups of keys in a table. `tables` are the names of the table and of those around it, the outermost first.
fn groups_in<'t>(tables: &[&'t str]) -> impl Iterator<Item = &'static KeyGroup> + use<'t> {
    let tables = tables.to_vec();
    DESCRIPTION.1.iter().filter(move |group| {
        // A described key with a dot represents all such keys.
        let fits = |(known, name): (&String, &&str)| {
            known == name || known.contains('.') && name.contains('.')
        };
        group.tables.len() == tables.len() && group.tables.iter().zip(&tables).all(fits)
    })
}

/// True if a given table has another key that excludes this one.
pub(super) fn is_replaced(tables: &[&str], key: &str, given: &Entries) -> bool {
    let mut groups = groups_in(tables).filter(|group| group.are_alternatives);
    groups.any(|group| {
        let mut others = group.keys.iter().filter(|other| *other != key);
        group.keys.iter().any(|one| one == key) && others.any(|other| given.contains_key(other))
    })
}

/// Changes values that are not compatible with new ones. `new` are the paths of the new values, such as `/load/0/mass_kg`, which are in the tables
/// already. Alternatives of new values are removed. If a new mean radius replaces span and rise of an arch, the arch keeps its embrace angle. The
/// joints of an arch keep their proportions under a new embrace angle, and the drums of a column under a new height. New drums set the height.
pub(super) fn adjust_others(root: &mut Entries, new: &[String]) {
    let mut tables = Value::Object(mem::take(root));
    let is_new = |path: &str| {
        let mut new = new.iter().filter_map(|new| new.strip_prefix(path));
        new.any(|inner| inner.is_empty() || inner.starts_with('/'))
    };
    if let Some(Value::Object(arch)) = tables.get_mut("arch") {
        span::keep_embrace_angle(arch, |key| is_new(&format!("/arch/{key}")));
    }
    for path in new {
        if let Some((outer, key)) = path.rsplit_once('/')
            && let Some(Value::Object(table)) = tables.pointer_mut(outer)
        {
            let names: Vec<_> = outer
                .split('/')
                .skip(1)
                .filter(|name| name.parse::<usize>().is_err())
                .collect();
            replace_alternatives(table, (&names, key), |key| {
                is_new(&format!("{outer}/{key}"))
            });
        }
    }
    // The older name of the key replaces it, and the reverse.
    let directions = [("simulation", "direction"), ("suite", BOTH_SIGNS)];
    let is_new_direction = directions.map(|(table, key)| is_new(&format!("/{table}/{key}")));
    if let Some(new) = is_new_direction.iter().position(|is_new| *is_new) {
        let (table, key) = directions[1 - new];
        if let Some(Value::Object(other)) = tables.get_mut(table)
            && !is_new_direction[1 - new]
        {
            other.shift_remove(key);
        }
    }
    if let Some(Value::Object(piers)) = tables.get_mut("piers") {
        drop_overridden(piers, |side, key| is_new(&format!("/piers/{side}/{key}")));
    }
    if let Some(Value::Object(arch)) = tables.get_mut("arch") {
        scale_joints(arch, |key| is_new(&format!("/arch/{key}")));
    }
    if let Some(Value::Object(column)) = tables.get_mut("column") {
        scale_drums(column, |key| is_new(&format!("/column/{key}")));
    }
    if let Value::Object(tables) = tables {
        *root = tables;
    }
}

/// Removes the alternatives of a new key, and the keys that need them. Other new keys stay: the reader rejects new values that exclude each other.
fn replace_alternatives(
    table: &mut Entries,
    (tables, key): (&[&str], &str),
    is_new: impl Fn(&str) -> bool,
) {
    let has = |group: &KeyGroup, key: &str| group.keys.iter().any(|one| one == key);
    let others = groups_in(tables)
        .filter(|group| group.are_alternatives && has(group, key))
        .flat_map(|group| &group.keys);
    let replaced: Vec<&String> = others
        .filter(|other| *other != key && table.contains_key(*other) && !is_new(other))
        .collect();
    for other in replaced {
        table.shift_remove(other);
        let needed = groups_in(tables).filter(|group| !group.are_alternatives && has(group, other));
        for companion in needed.flat_map(|group| &group.keys) {
            if companion != key && !is_new(companion) {
                table.shift_remove(companion);
            }
        }
    }
}

/// Removes the keys of both piers that a new key of one pier leaves without effect, because the other pier has its own.
fn drop_overridden(piers: &mut Entries, is_new: impl Fn(&str, &str) -> bool) {
    const SIDES: [&str; 2] = ["left", "right"];
    let gives = |piers: &Entries, side: &str, key: &str| {
        piers.get(side).is_some_and(|pier| pier.get(key).is_some())
    };
    let overridden = |key: &String| {
        SIDES.iter().all(|side| gives(piers, side, key))
            && SIDES.iter().any(|side| is_new(side, key))
    };
    let keys: Vec<String> = piers
        .keys()
        .filter(|key| overridden(key))
        .cloned()
        .collect();
    for key in keys {
        piers.shift_remove(&key);
    }
}

/// Moves the last joint of an arch to the springing under a new embrace angle; the other joints keep their proportions.
fn scale_joints(arch: &mut Entries, is_new: impl Fn(&str) -> bool) {
    let changes = ["span_m", "rise_m", "embrace_deg"].into_iter().any(&is_new);
    if !changes || is_new("joints_deg") {
        return;
    }
    let joints_deg = numbers(arch, "joints_deg");
    if let Some((embrace_deg, [joints_deg @ .., last_deg])) =
        span::given_embrace_deg(arch).zip(joints_deg.as_deref())
    {
        let angles_deg: Vec<f64> = joints_deg
            .iter()
            .map(|angle_deg| angle_deg / last_deg * embrace_deg)
            .chain([embrace_deg])
            .collect();
        arch.insert("joints_deg".to_owned(), Value::from(angles_deg));
    }
}

/// Scales the drums of a column to a new height, or sets the height of the column to that of new drums. If both are new, the reader checks the sum.
fn scale_drums(column: &mut Entries, is_new: impl Fn(&str) -> bool) {
    let Some(drums_m) = numbers(column, "drum_heights_m") else {
        return;
    };
    let (sum_m, height_m) = (drums_m.iter().sum::<f64>(), column.get("height_m"));
    match (
        ["height_m", "drum_heights_m"].map(is_new),
        height_m.and_then(Value::as_f64),
    ) {
        ([true, false], Some(height_m)) => {
            let ratio = height_m / sum_m;
            let drums_m: Vec<f64> = drums_m.iter().map(|drum_m| drum_m * ratio).collect();
            column.insert("drum_heights_m".to_owned(), Value::from(drums_m));
        }
        ([false, true], _) => {
            column.insert("height_m".to_owned(), Value::from(sum_m));
        }
        _ => {}
    }
}

/// Numbers of a list.
fn numbers(table: &Entries, key: &str) -> Option<Vec<f64>> {
    let numbers = table.get(key)?.as_array()?.iter();
    Some(numbers.filter_map(Value::as_f64).collect())
}
