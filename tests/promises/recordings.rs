//! Recordings: `record`, `up --record`, `run --out FILE.rrd`, `info`, `export`. Without the cargo feature `rerun`, how to
//! get them; with it, that they keep every step.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

#[cfg(feature = "rerun")]
mod console;
#[cfg(feature = "rerun")]
mod damage;
#[cfg(feature = "rerun")]
mod endings;
#[cfg(feature = "rerun")]
mod parts;
#[cfg(feature = "rerun")]
mod recorder;
#[cfg(feature = "rerun")]
mod snapshots;
#[cfg(feature = "rerun")]
mod steps;
#[cfg(feature = "rerun")]
mod viewer;

#[cfg(not(feature = "rerun"))]
#[test]
fn a_build_without_recordings_says_how_to_get_them() {
    use promises::run;

    for arguments in [
        &["record", "x.rrd"][..],
        &["info", "x.rrd", "--json"],
        &["export", "x.rrd", "--csv"],
        &["run", "jeffcott", "--speed", "1", "--duration", "5", "--out", "x.rrd"],
        &["runup", "jeffcott", "--to", "2", "--rate", "0.1", "--out", "x.rrd"],
        &["up", "--record", "x.rrd"],
    ] {
        let ran = run(arguments);
        assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""), "{arguments:?}: {ran:?}");
        assert!(ran.stderr.contains("cargo build --release --features rerun"), "{arguments:?}: {ran:?}");
    }
}
