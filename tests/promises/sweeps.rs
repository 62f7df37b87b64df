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
        ("run = \"poles three-mass --speed 2\"\n", "2", "expected a map, or a margin with --samples"),
        ("run = \"margin three-mass --speed 1\"\n", "2", "expected --samples N"),
        ("run = \"map --x kd=0..1\"\n", "2", "required arguments were not provided"),
        ("walk = \"map\"\n", "2", "walk"),
        ("run = 3\n", "2", "text in quotes"),
    ] {
        let (code, stdout, stderr) = sweep(text, shards);
        assert_eq!((code, stdout.as_str()), (Some(2), ""), "{text}: {stderr}");
        assert!(stderr.contains(words), "{text}: {stderr}");
    }
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
