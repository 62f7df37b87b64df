//! `[plant]`: matrices in place of a shaft, written out or in files beside.

use std::ops::Range as Span;

use nalgebra::DMatrix;
use text::{Table, Value, as_number};
use toml::de::DeValue;

use super::read::Reading;
use crate::matrices::{NAMES, read_named};
use crate::{MAX_ROWS, Matrices};

/// Reads `[plant]`.
pub(super) fn plant(reading: &mut Reading<'_, '_, '_>) {
    let file = reading.file;
    let Some(table) = reading.reader.table(file, "plant") else { return };
    let at = file.get("plant").map_or(0..0, |value| value.span());
    reading.place("plant", 0, table, at.clone());
    let names = NAMES.map(|(name, _)| name);
    let mut known = vec!["stations", "positions", "names", "matrices"];
    known.extend(names);
    reading.reader.only(table, &known);

    let mut matrices = Matrices { names: written_names(reading, table), ..Matrices::default() };
    for name in names {
        if let (Some(value), Some(place)) = (table.get(name), matrices.named(name)) {
            *place = written(reading, name, value);
        }
    }
    if let Some(value) = table.get("matrices") {
        if let Some(name) = names.iter().find(|name| table.contains_key(**name)) {
            reading.reader.wrong("matrices", value, format!("either it or {name} = [[..]], not both"));
        } else {
            in_files(reading, value, &mut matrices);
        }
    }
    let size = matrices.mass.nrows();
    if !table.contains_key("mass") && !table.contains_key("matrices") {
        let expected = "mass = [[..], ..], or matrices = \"FILE.npz\" with M, C, G, K and Kc";
        reading.reader.fault(at.clone(), "[plant] without mass", expected);
    }
    // What is not there is nothing.
    for name in names {
        if let Some(place) = matrices.named(name).filter(|matrix| matrix.is_empty()) {
            *place = DMatrix::zeros(size, size);
        }
    }
    matrices.stations = stations(reading, table, at, size, &matrices.names);
    let positions = reading.reader.numbers(table, "positions", "positions in m, one a station");
    matrices.positions = positions.map_or_else(
        // Evenly, where nobody says: places need an order and no more.
        || (0..matrices.stations.len()).map(|i| i as f64).collect(),
        |positions| positions.into_iter().map(|(position, _)| position).collect(),
    );
    reading.sketch.matrices = Some(matrices);
}

/// `names = ["p1", ..]`, of all coordinates.
fn written_names(reading: &mut Reading<'_, '_, '_>, table: &Table<'_>) -> Vec<String> {
    let Some(value) = table.get("names") else { return vec![] };
    let list = value.get_ref().as_array().and_then(|list| {
        list.iter().map(|name| name.get_ref().as_str().map(str::to_owned)).collect::<Option<Vec<String>>>()
    });
    list.unwrap_or_else(|| {
        reading.reader.wrong("names", value, "a name in quotes for every coordinate, [\"p1\", ..]");
        vec![]
    })
}

/// Which coordinates are stations, counted from 0: by number, or by name where coordinates have names.
fn stations(
    reading: &mut Reading<'_, '_, '_>,
    table: &Table<'_>,
    at: Span<usize>,
    size: usize,
    names: &[String],
) -> Vec<usize> {
    let of = "coordinates that are displacements of stations, from left to right, counted from 1";
    let reader = &mut reading.reader;
    let Some(value) = table.get("stations") else {
        reader.fault(at, "[plant] without stations", format!("stations = {of}"));
        return vec![];
    };
    let Some(list) = value.get_ref().as_array() else {
        reader.wrong("stations", value, format!("a list of {of}"));
        return vec![];
    };
    let mut stations = Vec::with_capacity(list.len());
    for item in list {
        let found = match item.get_ref() {
            DeValue::String(name) => names.iter().position(|own| own.as_str() == &**name),
            _ => as_number(item)
                .filter(|number| number.fract() == 0.0 && (1.0..=size as f64).contains(number))
                .map(|number| number as usize - 1),
        };
        match found {
            Some(station) => stations.push(station),
            None if size == 0 => {}
            None => {
                let shown: Vec<&str> = names.iter().take(8).map(String::as_str).collect();
                let more = if names.len() > 8 { ", .." } else { "" };
                let called = match item.get_ref() {
                    DeValue::String(_) if names.is_empty() => " (these have no names)".to_owned(),
                    _ if names.is_empty() => String::new(),
                    _ => format!(", or its name: {}{more}", shown.join(", ")),
                };
                let written = reader.written(item.span());
                reader.fault(item.span(), format!("station {written}"), format!("a coordinate, 1 to {size}{called}"));
            }
        }
    }
    stations
}

/// A matrix written out, row by row.
fn written(reading: &mut Reading<'_, '_, '_>, name: &str, value: &Value<'_>) -> DMatrix<f64> {
    let reader = &mut reading.reader;
    let expected = "rows of finite numbers, [[..], ..]";
    let rows: Option<Vec<_>> = match value.get_ref() {
        DeValue::Array(rows) => rows.iter().map(|row| row.get_ref().as_array()).collect(),
        _ => None,
    };
    let Some(rows) = rows else {
        reader.wrong(name, value, expected);
        return DMatrix::zeros(0, 0);
    };
    let columns = rows.first().map_or(0, |row| row.len());
    if rows.is_empty() || rows.len() > MAX_ROWS || columns > MAX_ROWS {
        reader.fault(
            value.span(),
            format!("{name} with {} rows", rows.len()),
            format!("1 to {MAX_ROWS} rows and columns"),
        );
        return DMatrix::zeros(0, 0);
    }
    let mut matrix = DMatrix::zeros(rows.len(), columns);
    for (i, row) in rows.into_iter().enumerate() {
        if row.len() != columns {
            let found = format!("{name}, row {}, of {} numbers", i + 1, row.len());
            reader.fault(value.span(), found, format!("{columns}, as in the first row"));
            return DMatrix::zeros(0, 0);
        }
        for (k, item) in row.iter().enumerate() {
            match as_number(item).filter(|number| number.is_finite()) {
                Some(number) => matrix[(i, k)] = number,
                None => {
                    let found = format!("{name}, row {}, column {}: {}", i + 1, k + 1, reader.written(item.span()));
                    reader.fault(item.span(), found, "a finite number");
                }
            }
        }
    }
    matrix
}

/// `matrices = "FILE.npz"`, or `{ mass = "FILE.mtx", stiffness = "FILE.csv" }`.
fn in_files(reading: &mut Reading<'_, '_, '_>, value: &Value<'_>, matrices: &mut Matrices) {
    let names = NAMES.map(|(name, _)| name);
    let expected = "\"FILE.npz\", or { mass = \"FILE\", stiffness = \"FILE\", .. }, each .npy, .mtx, .csv or .txt";
    let files: Vec<(Option<&str>, &Value<'_>)> = match value.get_ref() {
        DeValue::String(_) => vec![(None, value)],
        DeValue::Table(table) => {
            reading.reader.only(table, &names);
            names.iter().filter_map(|&name| Some((Some(name), table.get(name)?))).collect()
        }
        _ => vec![],
    };
    if files.is_empty() {
        reading.reader.wrong("matrices", value, expected);
    }
    // Whose names count for all the files.
    let mut first = "names = [..]";
    for (name, value) in files {
        let Some(file) = value.get_ref().as_str() else {
            reading.reader.wrong("matrices", value, expected);
            continue;
        };
        let Some(open) = reading.also.open else {
            let expected = "matrices written out here, mass = [[..], ..]: no other file is opened";
            reading.reader.wrong("matrices", value, expected);
            continue;
        };
        let read = open(file).and_then(|bytes| read_named(file, &bytes).map_err(|error| error.to_string()));
        let (found, coordinates) = match read {
            Ok(read) => read,
            Err(why) => {
                let (found, expected) = why.rsplit_once(": expected ").unwrap_or((&why, "a file of matrices"));
                let (found, expected) = (format!("{file}: {found}"), expected.to_owned());
                reading.reader.fault(value.span(), found, expected);
                continue;
            }
        };
        if let Some(coordinates) = coordinates {
            if matrices.names.is_empty() {
                (matrices.names, first) = (coordinates.list(), file);
            } else if let Some((found, expected)) = coordinates.differs(file, (&matrices.names, first)) {
                reading.reader.fault(value.span(), found, expected);
            }
        }
        for (own, matrix) in found {
            if let Some(place) = matrices.named(name.unwrap_or(&own)) {
                *place = matrix;
            } else {
                reading.reader.wrong(
                    "matrices",
                    value,
                    "an archive with M, C, G, K and Kc: this holds one without a name",
                );
            }
        }
    }
}
