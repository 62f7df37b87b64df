//! A rotor of as many elements as asked for: read, assembled, reduced, and its eigenvalues with all coordinates and with few.

use std::fmt::Write;

use beam::{Drawing, FullModel, Reduced};
use divan::{Bencher, black_box};

fn main() {
    divan::main();
}

/// A stepped shaft with a disc at every tenth station, as a file.
fn text(elements: usize) -> String {
    let mut text =
        "units = 'si'\n[material.steel]\ndensity = 7810.0\nyoungs_modulus = 211e9\npoisson = 0.3\n".to_owned();
    let last = elements + 1;
    for i in 0..elements {
        let outer = 0.05 + 0.03 * (i % 3) as f64;
        let _ = writeln!(text, "[[section]]\nlength = {}\nouter = {outer}", 1.5 / elements as f64);
        if i % 10 == 5 {
            let station = i + 1;
            let _ = writeln!(text, "[[disc]]\nstation = {station}\nouter = 0.3\nwidth = 0.05\nmaterial = 'steel'");
        }
    }
    for station in [1, last] {
        let _ = writeln!(text, "[[bearing]]\nstation = {station}\nstiffness = 1e7\ndamping = 1e3");
    }
    text
}

fn rotor(elements: usize) -> (Drawing, FullModel) {
    let drawing = beam::read(&text(elements), "bench").expect("a drawing");
    let full = drawing.full();
    (drawing, full)
}

const ELEMENTS: [usize; 3] = [10, 60, 120];

#[divan::bench(args = ELEMENTS)]
fn reading_and_assembling(bencher: Bencher<'_, '_>, elements: usize) {
    let text = text(elements);
    bencher.bench_local(|| beam::read(black_box(&text), "bench").expect("a drawing").full());
}

#[divan::bench(args = ELEMENTS)]
fn reducing_to_16(bencher: Bencher<'_, '_>, elements: usize) {
    let (drawing, full) = rotor(elements);
    bencher.bench_local(|| black_box(&full).reduce(&drawing, 16));
}

#[divan::bench(args = [10, 60], sample_count = 20)]
fn eigenvalues_of_all_elements(bencher: Bencher<'_, '_>, elements: usize) {
    let (_, full) = rotor(elements);
    bencher.bench_local(|| black_box(&full).eigenvalues(500.0));
}

#[divan::bench(args = [4, 8, 12, 16])]
fn eigenvalues_of_so_many_coordinates(bencher: Bencher<'_, '_>, coordinates: usize) {
    let (drawing, full) = rotor(60);
    let reduced: Reduced = full.reduce(&drawing, coordinates).expect("a reduction");
    bencher.bench_local(|| black_box(&reduced).eigenvalues(&full.springs, 500.0));
}
