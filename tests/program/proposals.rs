//! Commands and options that messages propose exist.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use crate::common::program::printed;

/// Words of a text that a pattern accepts: letters and hyphens after `start`.
fn words_after<'t>(text: &'t str, start: &'t str) -> impl Iterator<Item = &'t str> {
    text.split(start).skip(1).filter_map(|rest| {
        let end = rest.find(|one: char| !one.is_ascii_lowercase() && one != '-');
        let word = rest[..end.unwrap_or(rest.len())].trim_end_matches('-');
        word.starts_with(|one: char| one.is_ascii_lowercase())
            .then_some(word)
    })
}

/// Templates, and the code without its comments, below a folder.
fn sources(folder: &Path, found: &mut String) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.to_str().unwrap();
        if path.is_dir() {
            sources(&path, found);
        } else if name.ends_with(".txt") {
            found.push_str(&fs::read_to_string(&path).unwrap());
        } else if name.ends_with(".rs") {
            let text = fs::read_to_string(&path).unwrap();
            let code = text.lines().filter(|line| {
                let line = line.trim_start();
                !line.starts_with("//") || line.starts_with("/// ") && name.contains("/cli/")
            });
            code.for_each(|line| {
                found.push_str(line);
                found.push('\n');
            });
        }
    }
}

#[test]
fn messages_name_commands_and_options_that_exist() {
    let folder = tempfile::tempdir().unwrap();
    let help = printed(folder.path(), &["--help"]);
    let listed = help
        .lines()
        .skip_while(|line| !line.starts_with("Commands:"));
    let listed = listed
        .skip(1)
        .map_while(|line| line.split_whitespace().next());
    let commands = listed.collect::<BTreeSet<_>>();
    assert!(commands.contains("threshold") && commands.contains("check"));
    let helps = commands.iter().filter(|name| **name != "help");
    let helps = helps.map(|name| printed(folder.path(), &[name, "--help"]));
    let helps = helps.collect::<String>() + &help;
    let options = words_after(&helps, "--").collect::<BTreeSet<_>>();

    let mut text = String::new();
    sources(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join("src"),
        &mut text,
    );
    // Options of other programs, and former options, whose message is their replacement.
    let others = ["features", "locked", "path", "no-spread"];
    let named = words_after(&text, " --").chain(words_after(&text, "\"--"));
    let named = named.chain(words_after(&text, "`--"));
    let mut count = 0;
    for option in named.filter(|option| !others.contains(option)) {
        assert!(options.contains(option), "no command has --{option}");
        count += 1;
    }
    assert!(count > 50, "{count}");
    // `archrock` in backticks or in an example is followed by a command.
    for start in ["`archrock ", "  archrock ", "\"archrock "] {
        for command in words_after(&text, start) {
            assert!(commands.contains(command), "no command {command}");
        }
    }
}
