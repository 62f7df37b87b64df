//! Trajectories as files: whole, under their own name, with every digit.

use std::sync::atomic::AtomicBool;

use files::{Existing, FileError};
use rotor::builtin;
use study::run::{Observer, Plan, RunError, Settle, run};
use study::table::{Form, FormError};
use study::trajectory::{Writer, columns};

fn plan() -> Plan {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let feedback = builtin::feedback(&rotor, "composite").expect("built in");
    let steady = Plan::steady(&rotor, &feedback, 2.0, &[1.0; 3], 10.0, Settle::From(0.0)).expect("can be stepped");
    Plan { dtau: 0.02, ..steady }
}

fn files_in(folder: &std::path::Path) -> usize {
    std::fs::read_dir(folder).expect("readable").count()
}

#[test]
fn csv_keeps_every_digit_and_replaces_what_was_there_only_if_told_to() {
    let folder = tempfile::tempdir().expect("made");
    let path = folder.path().join("run.csv");
    std::fs::write(&path, "old").expect("written");
    let refused = Writer::create(&path, Form::Csv, 3, 5, Existing::Keep).err();
    assert!(matches!(refused, Some(FileError::Exists(_))), "{refused:?}");
    let mut writer = Writer::create(&path, Form::Csv, 3, 5, Existing::Replace).expect("opened");
    let outcome = run(&plan(), &mut [&mut writer as &mut dyn Observer], &AtomicBool::new(false)).expect("runs");
    assert_eq!(std::fs::read_to_string(&path).expect("there"), "old", "not before it is whole");
    writer.finish().expect("renamed");
    let text = std::fs::read_to_string(&path).expect("there");
    let rows: Vec<Vec<f64>> =
        text.lines().skip(1).map(|l| l.split(',').map(|f| f.parse().expect("a number")).collect()).collect();
    assert_eq!(text.lines().next(), Some(columns(3).join(",").as_str()));
    assert_eq!((rows.len(), files_in(folder.path())), (101, 1));
    let last = rows.last().expect("rows");
    // Readers guess types from the first rows: what is a number there must not become one of another kind later.
    let first: Vec<&str> = text.lines().nth(1).expect("a row").split(',').collect();
    assert!(first[..15].iter().all(|field| field.contains('.')) && !first[15].contains('.'), "{first:?}");
    assert_eq!((last[0], last[1], last[2]), (10.0, outcome.last.displacement[0].re, outcome.last.displacement[0].im));
}

#[test]
fn an_interrupted_run_leaves_nothing() {
    let folder = tempfile::tempdir().expect("made");
    let path = folder.path().join("run.csv");
    let mut writer = Writer::create(&path, Form::Csv, 3, 1, Existing::Keep).expect("opened");
    let stopped = run(&plan(), &mut [&mut writer as &mut dyn Observer], &AtomicBool::new(true));
    assert!(matches!(stopped, Err(RunError::Interrupted)));
    drop(writer);
    assert_eq!(files_in(folder.path()), 0);
}

#[test]
fn the_ending_says_the_form() {
    assert_eq!(Form::of("a/b.CSV".as_ref()), Ok(Form::Csv));
    assert_eq!(Form::of("run.rrd".as_ref()), Err(FormError::Unknown("run.rrd".into())));
    assert!(matches!(Form::of("run".as_ref()), Err(FormError::Unknown(_))));
    let parquet = if cfg!(feature = "parquet") { Ok(Form::Parquet) } else { Err(FormError::NoParquet) };
    assert_eq!(Form::of("run.parquet".as_ref()), parquet);
}

#[cfg(feature = "parquet")]
#[test]
fn parquet_reads_back_what_csv_says() {
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::RowAccessor;

    let folder = tempfile::tempdir().expect("made");
    let (csv, columnar) = (folder.path().join("run.csv"), folder.path().join("run.parquet"));
    let mut text = Writer::create(&csv, Form::Csv, 3, 1, Existing::Keep).expect("opened");
    let mut binary = Writer::create(&columnar, Form::Parquet, 3, 1, Existing::Keep).expect("opened");
    run(&plan(), &mut [&mut text as &mut dyn Observer, &mut binary], &AtomicBool::new(false)).expect("runs");
    text.finish().expect("renamed");
    binary.finish().expect("renamed");
    let text = std::fs::read_to_string(&csv).expect("there");
    let reader = SerializedFileReader::new(std::fs::File::open(&columnar).expect("there")).expect("Parquet");
    let names: Vec<String> =
        reader.metadata().file_metadata().schema().get_fields().iter().map(|f| f.name().to_owned()).collect();
    assert_eq!(names, columns(3));
    let mut rows = 0;
    for (line, row) in text.lines().skip(1).zip(reader.get_row_iter(None).expect("rows")) {
        let row = row.expect("a row");
        let fields: Vec<f64> = line.split(',').map(|f| f.parse().expect("a number")).collect();
        for (i, field) in fields[..15].iter().enumerate() {
            assert_eq!(row.get_double(i).expect("a double").to_bits(), field.to_bits());
        }
        assert_eq!(f64::from(row.get_int(15).expect("an integer")), fields[15]);
        rows += 1;
    }
    assert_eq!(rows, 501);
}
