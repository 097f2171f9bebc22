//! Scenarios with their files in memory: the same as from a disk.

use std::fs;
use std::path::{Path, PathBuf};

use archrock::scenario::{ReadOptions, Scenario, Source};

/// Reads all files of a folder and of the folders in it, with their names relative to `base`.
fn contents(folder: &Path, base: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    let paths = entries.map(|entry| entry.path());
    let read = paths.flat_map(|path| match path.is_dir() {
        true => contents(&path, base),
        false => {
            let name = path.strip_prefix(base).unwrap().to_owned();
            vec![(name, fs::read(path).unwrap())]
        }
    });
    read.collect()
}

#[test]
fn every_example_is_the_same_with_its_files_in_memory() {
    let options = ReadOptions::default();
    let mut records = 0;
    for folder in ["scenarios", "scenarios/recipes"] {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
        let files = contents(&folder, &folder);
        let texts = files.iter().filter(|(name, _)| {
            let is_inside = name.parent() == Some(Path::new(""));
            is_inside && name.extension().is_some_and(|ending| ending == "toml")
        });
        for (name, text) in texts {
            let on_disk = Scenario::read(&folder.join(name)).unwrap();
            let text = std::str::from_utf8(text).unwrap();
            let source = Source::of_text(text, &name.display().to_string());
            let source = source.with_files(files.clone());
            let in_memory = Scenario::of(&source, &options).unwrap();
            assert_eq!(in_memory, on_disk, "{name:?}");
            assert_eq!(in_memory.to_resolved_toml(), on_disk.to_resolved_toml());
            assert_eq!(in_memory.files(), on_disk.files());
            records += in_memory.record_checksums().len();
            // Cells of maps read the scenario again.
            let cells = [&in_memory, &on_disk]
                .map(|one| one.with_values(&[("simulation.gravity_m_s2", 9.8)]));
            assert_eq!(cells[0], cells[1]);
        }
    }
    assert!(records > 10, "{records} records");
}

/// Names may begin with `./`, and a folder on the disk with the name of a file does not matter.
#[test]
fn names_of_files_in_memory_have_nothing_to_do_with_the_disk() {
    let table = b"0.0,0.0\n0.2,2.0\n0.4,-2.0\n0.6,0.0\n".to_vec();
    let column = "[column]\nheight_m = 4\nwidth_m = 0.8\n";
    for name in ["./a.csv", "a.csv", "src"] {
        let text = format!(
            "{column}[suite]\nrecords = ['{name}']\nformat = 'csv'\nunit = 'm/s2'\nscales = [1.0]\n"
        );
        let source = Source::of_text(&text, "s.toml");
        let source = source.with_files([(PathBuf::from(name), table.clone())]);
        let scenario = Scenario::of(&source, &ReadOptions::default());
        let scenario = scenario.unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(scenario.suite.as_ref().unwrap().records.len(), 1, "{name}");
    }
}

#[test]
fn files_on_a_disk_are_not_read_with_files_in_memory() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    for (name, wrong) in [
        ("semicircle-record.toml", "is not among the given files"),
        ("column-suite.toml", "matches no file"),
    ] {
        let text = fs::read_to_string(folder.join(name)).unwrap();
        let source = Source::of_text(&text, &folder.join(name).display().to_string());
        let error = Scenario::of(&source.with_files([]), &ReadOptions::default()).unwrap_err();
        assert!(error.to_string().contains(wrong), "{error}");
    }
}
