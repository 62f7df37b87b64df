//! Files that are damaged: read around the damage, and told by every command.

use std::path::Path;

use promises::{Root, Screen, run};
use serde_json::Value;

use super::recorder::{info, steps, text};

/// A damaged file is read before and behind the damage, and every command says what is lost.
#[test]
fn a_damaged_recording_is_read_and_told_by_every_command() {
    let root = Root::new();
    let path = root.path().join("r.rrd");
    let out = ["run", "three-mass", "--speed", "2", "--duration", "200", "--dtau", "0.01", "--out", text(&path)];
    assert_eq!(run(&out).code, Some(0));
    let (whole, rows) = (info(&path), steps(&path).len());
    assert_eq!((&whole["checksums"], &whole["damage"]), (&true.into(), &Value::Array(vec![])), "{whole}");
    let mut bytes = std::fs::read(&path).unwrap();
    let place = bytes.len() / 2;
    bytes[place] ^= 1;
    bytes.push(b'x');
    std::fs::write(&path, bytes).unwrap();
    let told = info(&path);
    let damage = told["damage"].as_array().unwrap();
    let kinds: Vec<&Value> = damage.iter().map(|damage| &damage["kind"]).collect();
    assert_eq!(kinds, ["checksum", "foreign"], "{told}");
    let (byte, length) = (damage[0]["byte"].as_u64().unwrap(), damage[0]["bytes"].as_u64().unwrap());
    assert!((byte..byte + length).contains(&(place as u64)), "{told}");
    // Half of the bytes are drawings, of which nothing is read.
    let lost = damage[0]["steps"]["count"].as_u64().unwrap_or_default();
    assert_eq!((told["steps"].as_u64(), &told["lost"]), (Some(rows as u64 - lost), &lost.into()), "{told}");
    let exported = run(&["export", text(&path), "--csv", "--json"]);
    assert_eq!((exported.code, &exported.json()["damage"]), (Some(0), &told["damage"]), "{exported:?}");
    assert_eq!(exported.json()["rows"], told["steps"]);
    assert!(exported.stderr.contains(&format!("damaged at byte {byte}")), "{exported:?}");
    let words = run(&["info", text(&path)]);
    assert!(words.stdout.contains(&format!("damaged at byte {byte}")), "{words:?}");
    let mut screen = Screen::start(root.path(), &["replay", text(&path)], (200, 40));
    screen.wait_words("REPLAY");
    screen.wait_words("damaged at byte");
    screen.press("q");
    assert!(screen.ended().success());
}

/// Bytes of the sample that made `info`, `export` and `replay` panic, or end for want of 1e15 bytes.
#[test]
fn regress_bytes_that_panicked_or_aborted_are_damage_at_their_place() {
    let root = Root::new();
    let path = root.path().join("run-up.rrd");
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("../recordings/run-up.rrd");
    for (place, changed) in [(306_670, 29), (203_945, 91), (87_687, 2)] {
        let mut bytes = std::fs::read(&sample).unwrap();
        bytes[place] = changed;
        std::fs::write(&path, bytes).unwrap();
        let told = info(&path);
        assert_eq!(told["damage"][0]["kind"], "unreadable", "{told}");
        let exported = run(&["export", text(&path), "--csv", "--json", "--force"]);
        assert_eq!((exported.code, &exported.json()["damage"]), (Some(0), &told["damage"]), "{exported:?}");
        let mut screen = Screen::start(root.path(), &["replay", text(&path)], (160, 40));
        screen.wait_words("REPLAY");
        screen.wait_words("damaged at byte");
        screen.press("q");
        assert!(screen.ended().success());
    }
}
