//! Scenarios with their files in memory: the same as from a disk.

use std::fs;
use std::path::{Path, PathBuf};

use crate::common::program::{example, is_for_statics};
use archrock::scenario::{FileContents, Ground, ReadOptions, Scenario, ScenarioErrors, Source};

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
    let mut records = 0;
    for folder in ["scenarios", "scenarios/recipes"] {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
        let files = contents(&folder, &folder);
        let texts = files.iter().filter(|(name, _)| {
            let is_inside = name.parent() == Some(Path::new(""));
            is_inside && name.extension().is_some_and(|ending| ending == "toml")
        });
        for (name, text) in texts {
            let on_disk = example(&folder.join(name));
            let options = ReadOptions {
                statics: is_for_statics(name),
                ..ReadOptions::default()
            };
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
    let none: [(PathBuf, Vec<u8>); 0] = [];
    for (name, wrong) in [
        ("semicircle-record.toml", "is not among the given files"),
        ("column-suite.toml", "matches no file"),
    ] {
        let text = fs::read_to_string(folder.join(name)).unwrap();
        let source = Source::of_text(&text, &folder.join(name).display().to_string());
        let error =
            Scenario::of(&source.with_files(none.clone()), &ReadOptions::default()).unwrap_err();
        assert!(error.to_string().contains(wrong), "{error}");
    }
}

/// Samples in place of a file are the record of the table with these numbers; faults name the sample, and no file.
#[test]
fn samples_take_the_place_of_a_file() {
    let read = |more: &str, samples: &[(f64, f64)], as_text: bool| {
        let text = format!(
            "[column]\nheight_m = 4\nwidth_m = 0.8\n[ground.record]\nfile = 'record'\nformat = 'csv'\nunit = 'g'\n{more}"
        );
        let contents = FileContents::Samples(samples.to_vec());
        let contents = match as_text {
            true => FileContents::Bytes(contents.bytes().into_owned()),
            false => contents,
        };
        let source = Source::of_text(&text, "s.toml");
        let source = source.with_files([(PathBuf::from("record"), contents)]);
        let scenario = Scenario::of(&source, &ReadOptions::default())?;
        Ok::<_, ScenarioErrors>((scenario.record_checksums(), scenario))
    };
    let sine = |index: usize| {
        let time_s = 0.01 * index as f64;
        (time_s, 0.3 * (7.0 * time_s).sin() + 1e-17)
    };
    let samples: Vec<(f64, f64)> = (0..500).map(sine).collect();
    for more in [
        "",
        "peak_g = 0.2\n",
        "baseline = 'mean'\n",
        "baseline = 'linear'\nhigh_pass_hz = 0.5\nstart_s = 10\n",
        "time_column = 1\nacceleration_column = 2\n",
    ] {
        let [direct, as_text] = [false, true].map(|as_text| read(more, &samples, as_text).unwrap());
        assert_eq!(direct, as_text, "{more}");
    }
    let (_, scenario) = read("", &samples, false).unwrap();
    let Some(Ground::Record(record)) = &scenario.ground else {
        panic!("no record");
    };
    assert_eq!(record.main.samples[..], samples[..]);
    let wrong = |samples: &[(f64, f64)]| read("", samples, false).unwrap_err().to_string();
    for (samples, words) in [
        (
            &[(0.0, 1.0), (1.0, f64::NAN)][..],
            "sample 2: `nan` is not a finite number",
        ),
        (
            &[(0.0, 1.0), (f64::INFINITY, 1.0)],
            "sample 2: `inf` is not a finite number",
        ),
        (
            &[(0.0, 1.0), (1.0, 2e12)],
            "sample 2: `2e12` is out of range",
        ),
        (
            &[(0.0, 1.0), (1.0, 1.0), (1.0, 2.0)],
            "sample 3: the time does not increase: 1 s follows 1 s",
        ),
        (
            &[(0.0, 1.0), (2e6, 1.0)],
            "sample 2: the time 2e6 s is out of range",
        ),
        (&[(0.0, 1.0)], "sample 1: the number of samples is 1"),
        (&[], "sample 1: the number of samples is 0"),
    ] {
        let said = wrong(samples);
        assert!(
            said.contains(&format!("the record \"record\" is faulty: {words}")),
            "{said}"
        );
        assert!(!said.contains("file"), "{said}");
    }
    let early = wrong(&[(-1.0, 0.0), (1.0, 0.1)]);
    assert!(
        early.contains("the record \"record\" begins at -1 s"),
        "{early}"
    );
    let many = (0..1_800_001).map(|index| (0.01 * f64::from(index), 0.0));
    assert!(wrong(&many.collect::<Vec<_>>()).contains("sample 1800001: more than 1800000 samples"));
}
