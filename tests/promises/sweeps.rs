//! `whirl sweep`: shards that are the map, row for row, however it was cut, and that are told apart from those of others.

use std::path::Path;

use promises::whirl;

const MAP: &str = "map three-mass --feedback individual --x speed=0..8 --y kd.1=0..8 --points 9x7";

fn run_in(folder: &Path, arguments: &[&str]) -> (Option<i32>, String, String) {
    let ran = whirl().current_dir(folder).args(arguments).output().expect("it runs");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text");
    (ran.status.code(), text(ran.stdout), text(ran.stderr))
}

fn rows(folder: &Path) -> Vec<String> {
    let mut files: Vec<_> =
        std::fs::read_dir(folder.join("out")).expect("a folder").flatten().map(|e| e.path()).collect();
    files.sort();
    let csv = files.iter().filter(|path| path.extension().is_some_and(|end| end == "csv"));
    let read = |path: &std::path::PathBuf| std::fs::read_to_string(path).expect("a file");
    csv.flat_map(|path| read(path).lines().skip(1).map(str::to_owned).collect::<Vec<_>>()).collect()
}

#[test]
fn shards_are_the_map_row_for_row_however_it_is_cut() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    std::fs::write(at.join("sweep.toml"), format!("run = \"{MAP}\"\n")).expect("written");
    let (code, _, stderr) = run_in(at, &["sweep", "plan", "sweep.toml", "--shards", "4", "--slurm", "--kubernetes"]);
    assert_eq!(code, Some(0), "{stderr}");
    let array = std::fs::read_to_string(at.join("array.sh")).expect("a file");
    assert!(array.contains("--array=0-3") && array.contains("--requeue"), "{array}");
    assert!(std::fs::read_to_string(at.join("job.yaml")).expect("a file").contains("completions: 4"));
    for shard in ["2", "0", "3"] {
        assert_eq!(run_in(at, &["sweep", "run", "out/plan.toml", "--shard", shard]).0, Some(0));
    }
    let (code, stdout, stderr) = run_in(at, &["sweep", "gather", "out"]);
    assert_eq!((code, stdout.as_str()), (Some(1), ""));
    assert!(stderr.contains("1 of 4 shards are missing: 1. Run them again"), "{stderr}");
    // One that died leaves nothing under its name; run again, what is there already is left.
    assert_eq!(run_in(at, &["sweep", "run", "out/plan.toml", "--shard", "1"]).0, Some(0));
    assert!(run_in(at, &["sweep", "run", "out/plan.toml", "--shard", "1"]).1.contains("is there already"));
    let (code, stdout, stderr) = run_in(at, &["sweep", "gather", "out"]);
    assert!(code == Some(0) && stdout.contains("4 shards, 63 rows, whole"), "{stdout} {stderr}");
    let whole = run_in(at, &[&MAP.split(' ').collect::<Vec<_>>()[..], &["--csv"]].concat()).1;
    let expected: Vec<String> = whole.lines().skip(1).zip(0..).map(|(row, index)| format!("{row},{index}")).collect();
    assert_eq!(rows(at), expected);
    // Another plan in the same folder: its shards are not those.
    std::fs::write(at.join("sweep.toml"), format!("run = \"{MAP} --set delay=0.01\"\n")).expect("written");
    let (code, _, stderr) = run_in(at, &["sweep", "plan", "sweep.toml", "--shards", "4"]);
    assert!(code == Some(2) && stderr.contains("plan.toml"), "{stderr}");
    assert_eq!(run_in(at, &["sweep", "plan", "sweep.toml", "--shards", "4", "--force"]).0, Some(0));
    let (code, _, stderr) = run_in(at, &["sweep", "gather", "out"]);
    assert!(code == Some(1) && stderr.contains("shards of another plan or version: shard-00000-of-00004-"), "{stderr}");
}

#[test]
fn samples_are_cut_like_maps_and_what_makes_no_sense_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let sweep = |text: &str, shards: &str| {
        std::fs::write(at.join("sweep.toml"), text).expect("written");
        run_in(at, &["sweep", "plan", "sweep.toml", "--shards", shards, "--force"])
    };
    let line = "run = \"margin three-mass --feedback individual --speed 6 --vary mass.2=10% --samples 10 --seed 3\"\n";
    assert_eq!(sweep(line, "3").0, Some(0));
    for shard in ["0", "1", "2"] {
        assert_eq!(run_in(at, &["sweep", "run", "out/plan.toml", "--shard", shard]).0, Some(0));
    }
    assert_eq!(rows(at).len(), 10);
    assert_eq!(run_in(at, &["sweep", "run", "out/plan.toml", "--shard", "3"]).0, Some(2));
    for (text, shards, words) in [
        (line, "11", "--shards 11: expected at most 10, a row each"),
        ("run = \"poles three-mass --speed 2\"\n", "2", "expected a map, a margin with --samples, or a tune"),
        ("run = \"margin three-mass --speed 1\"\n", "2", "expected --samples N"),
        ("run = \"map --x kd=0..1\"\n", "2", "required arguments were not provided"),
        ("run = \"tune --over 0..6 --pareto force\"\n", "2", "--pareto and --criteria are several searches"),
        ("run = \"tune --over 0..6 --bearing any\"\n", "2", "Name the places"),
        ("run = \"tune --over 0..6 --out gains.toml\"\n", "2", "its shards are the result"),
        ("walk = \"map\"\n", "2", "walk"),
        ("run = 3\n", "2", "text in quotes"),
    ] {
        let (code, stdout, stderr) = sweep(text, shards);
        assert_eq!((code, stdout.as_str()), (Some(2), ""), "{text}: {stderr}");
        assert!(stderr.contains(words), "{text}: {stderr}");
    }
}

/// Runs every shard of `line` cut into so many; the rows of its files.
fn swept(at: &Path, line: &str, shards: u64) -> Vec<String> {
    std::fs::write(at.join("sweep.toml"), format!("run = \"{line}\"\n")).expect("written");
    let _ = std::fs::remove_dir_all(at.join("out"));
    let (code, _, stderr) = run_in(at, &["sweep", "plan", "sweep.toml", "--shards", &shards.to_string()]);
    assert_eq!(code, Some(0), "{stderr}");
    for shard in 0..shards {
        let (code, _, stderr) = run_in(at, &["sweep", "run", "out/plan.toml", "--shard", &shard.to_string()]);
        assert_eq!(code, Some(0), "{stderr}");
    }
    rows(at)
}

fn document(told: &str) -> serde_json::Value {
    serde_json::from_str(told).expect("JSON")
}

#[test]
fn starts_of_a_search_are_climbed_apart_and_finished_together() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    for line in [
        "tune three-mass --over 0..5 --signal individual --sensors 1,2 --bound 5 --starts 5",
        "tune three-mass --over 0..5 --gains linear --starts 3 --seed 4",
    ] {
        let rows = swept(at, line, 1);
        assert_eq!(rows, swept(at, line, 3), "however it is cut");
        let cell = |row: &String, k: usize| -> f64 { row.split(',').nth(k).expect("there").parse().expect("a number") };
        assert!(rows.iter().all(|row| row.split(',').count() == 8 + 2), "an objective, gains and an index: {rows:?}");
        // What a search with all of them has, in one process.
        let words = [&line.split(' ').collect::<Vec<_>>()[..], &["--json", "--out", "whole.toml", "--force"]].concat();
        let (code, told, stderr) = run_in(at, &words);
        assert_eq!(code, Some(0), "{stderr}");
        let whole = document(&told);
        let mut values: Vec<f64> = rows.iter().map(|row| cell(row, 0)).collect();
        let highest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let best = values.iter().position(|value| *value == highest).expect("it is there");
        values.sort_by(|a, b| b.total_cmp(a));
        assert_eq!(whole["values"], serde_json::json!(values));
        let (code, told, stderr) = run_in(at, &["sweep", "gather", "out"]);
        assert!(code == Some(0) && told.contains(&format!("best start {best}, objective ")), "{told}{stderr}");
        let finish = ["sweep", "gather", "out", "--out", "shared.toml", "--json", "--force"];
        let (code, told, stderr) = run_in(at, &finish);
        assert_eq!(code, Some(0), "{stderr}");
        let shared = document(&told);
        for field in ["objective", "feedback", "proven", "values", "starts", "stationarity", "max_force"] {
            assert_eq!(shared[field], whole[field], "{field}");
        }
        // But for the command that stands at their head.
        let gains = |name: &str| {
            let text = std::fs::read_to_string(at.join(name)).expect("written");
            text.lines().filter(|line| !line.starts_with('#')).map(str::to_owned).collect::<Vec<_>>()
        };
        assert_eq!(gains("shared.toml"), gains("whole.toml"));
        let (code, _, stderr) = run_in(at, &finish[..5]);
        assert!(code == Some(2) && stderr.contains("shared.toml"), "nothing is overwritten: {stderr}");
    }
    swept(at, MAP, 1);
    let (code, _, stderr) = run_in(at, &["sweep", "gather", "out", "--out", "gains.toml"]);
    assert!(code == Some(2) && stderr.contains("nothing to finish"), "{stderr}");
}

#[test]
fn samples_that_are_simulated_are_cut_too() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let line = "margin three-mass --feedback individual --speed 3 --vary mass.2=10% --vary deadband.1=0..1 --samples 7 --simulate";
    let rows = swept(at, line, 1);
    assert_eq!(rows, swept(at, line, 3), "however it is cut");
    let told = run_in(at, &[&line.split(' ').collect::<Vec<_>>()[..], &["--json"]].concat()).1;
    let simulated = &document(&told)["samples"]["simulated"];
    // mass.2, deadband.1, min_damping, orbit, force, bounded, settled, index
    let column = |k: usize| {
        let cells = rows.iter().map(|row| row.split(',').nth(k).expect("there").parse::<f64>().expect("a number"));
        let mut cells: Vec<f64> = cells.collect();
        cells.sort_by(f64::total_cmp);
        cells
    };
    assert_eq!(simulated["orbit"]["0.5"], serde_json::json!(column(3)[3]), "the middle one of seven");
    assert_eq!(simulated["force"]["0.5"], serde_json::json!(column(4)[3]));
    assert_eq!(column(5), [1.0; 7], "all stay within bounds");
}

/// A plan is of the files that its line reads as they were, whichever way the option is written.
#[test]
fn regress_a_file_that_is_changed_makes_another_plan() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let gains = run_in(at, &["rotor", "show", "three-mass", "--feedback", "individual"]).1;
    for option in ["--feedback gains.toml", "--feedback=gains.toml"] {
        std::fs::write(at.join("gains.toml"), &gains).expect("written");
        let line = format!("run = \"map three-mass {option} --x speed=0..8 --y kd.1=0..8 --points 3x3\"\n");
        std::fs::write(at.join("sweep.toml"), line).expect("written");
        let (code, _, stderr) = run_in(at, &["sweep", "plan", "sweep.toml", "--shards", "2", "--force"]);
        assert_eq!(code, Some(0), "{stderr}");
        std::fs::write(at.join("gains.toml"), gains.replace("kd = -", "kd = -1")).expect("written");
        let (code, _, stderr) = run_in(at, &["sweep", "run", "out/plan.toml", "--shard", "0"]);
        assert!(code == Some(2) && stderr.contains("plan it anew"), "{option}: {stderr}");
    }
}
