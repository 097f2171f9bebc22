//! The ways to distribute a study over several machines, as in docs/commands.md.

use crate::common::program::skip_without;
use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The code block of the documentation that contains these words.
fn block(words: &str) -> String {
    let page = fs::read_to_string(repository().join("docs/commands.md")).unwrap();
    let block = page.split("```").find_map(|block| {
        block
            .strip_prefix("bash\n")
            .filter(|code| code.contains(words))
    });
    block
        .unwrap_or_else(|| panic!("no code with {words:?}"))
        .to_owned()
}

fn repository() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A folder with the scenario of the documentation, on a coarser grid to be quick.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let name = "scenarios/semicircle-map.toml";
    let scenario = fs::read_to_string(repository().join(name)).unwrap();
    let coarse = scenario
        .replace("count = 76", "count = 7")
        .replace("count = 80", "count = 9");
    assert!(coarse != scenario);
    fs::create_dir(folder.path().join("scenarios")).unwrap();
    fs::write(folder.path().join(name), coarse).unwrap();
    folder
}

/// Runs a script in a folder; the program is among the commands.
#[track_caller]
fn bash(folder: &Path, script: &str, variables: &[(&str, &str)]) {
    let own = PathBuf::from(env!("CARGO_BIN_EXE_archrock"));
    let others = env::var_os("PATH").unwrap();
    let paths = [own.parent().unwrap().to_owned()].into_iter();
    let paths = paths.chain(env::split_paths(&others));
    let output = Command::new("bash")
        .args(["-euc", script])
        .current_dir(folder)
        .env("PATH", env::join_paths(paths).unwrap())
        .envs(variables.iter().copied())
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{stderr}");
}

/// Asserts that the joined parts equal the results of a single run.
#[track_caller]
fn assert_whole(folder: &Path) {
    bash(
        folder,
        "archrock --quiet map scenarios/semicircle-map.toml --out whole",
        &[],
    );
    for name in ["map.csv", "map.svg"] {
        let joined = fs::read(folder.join("results/semicircle-map").join(name)).unwrap();
        assert!(
            joined == fs::read(folder.join("whole").join(name)).unwrap(),
            "{name}"
        );
    }
}

/// There is no Slurm here, but the script needs only its variables.
#[test]
fn the_slurm_array_computes_the_whole_study() {
    let folder = folder();
    let script = block("#SBATCH");
    let tasks = script
        .lines()
        .find_map(|line| line.strip_prefix("#SBATCH --array=1-"))
        .unwrap();
    for task in 1..=tasks.parse().unwrap() {
        let task: i32 = task;
        let variables = [
            ("SLURM_ARRAY_TASK_ID", &*task.to_string()),
            ("SLURM_CPUS_PER_TASK", "2"),
        ];
        bash(folder.path(), &script, &variables);
    }
    let merge = block("archrock merge");
    assert!(!merge.contains("parallel"));
    bash(folder.path(), &merge, &[]);
    assert_whole(folder.path());
}

/// Without GNU parallel nothing is tested; the checks of the repository install it.
#[test]
fn gnu_parallel_computes_the_whole_study() {
    let version = Command::new("parallel").arg("--version").output();
    if !version.is_ok_and(|output| String::from_utf8_lossy(&output.stdout).contains("GNU parallel"))
    {
        skip_without("GNU parallel");
        return;
    }
    let folder = folder();
    bash(folder.path(), &block("parallel archrock"), &[]);
    assert_whole(folder.path());
}
