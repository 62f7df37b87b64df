//! Eigenvalues beside nalgebra's Schur decomposition and, with the feature `faer`, beside faer's on one thread: random
//! matrices, as many of each size as keep one iteration short.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use linear::{C64, eigenvalues};
use nalgebra::{DMatrix, Schur};

fn main() {
    divan::main();
}

const ROWS: [usize; 8] = [4, 8, 12, 16, 24, 32, 64, 128];

fn each(bencher: Bencher<'_, '_>, rows: usize, work: impl Fn(&DMatrix<C64>)) {
    let mut random = fastrand::Rng::with_seed(1);
    let mut entry = || C64::new(random.f64() - 0.5, random.f64() - 0.5);
    let count = (4096 / (rows * rows)).max(1);
    let matrices: Vec<_> = (0..count).map(|_| DMatrix::from_fn(rows, rows, |_, _| entry())).collect();
    bencher.counter(ItemsCount::new(count)).bench_local(|| matrices.iter().for_each(|a| work(black_box(a))));
}

#[divan::bench(args = ROWS)]
fn ours(bencher: Bencher<'_, '_>, rows: usize) {
    each(bencher, rows, |a| drop(black_box(eigenvalues(a.clone()))));
}

#[divan::bench(args = ROWS)]
fn nalgebras(bencher: Bencher<'_, '_>, rows: usize) {
    each(bencher, rows, |a| drop(black_box(Schur::try_new(a.clone(), f64::EPSILON, 100 * rows))));
}

#[cfg(feature = "faer")]
#[divan::bench(args = ROWS)]
fn faers(bencher: Bencher<'_, '_>, rows: usize) {
    faer::set_global_parallelism(faer::Par::Seq);
    each(bencher, rows, |a| {
        drop(black_box(faer::MatRef::from_column_major_slice(a.as_slice(), rows, rows).eigenvalues()))
    });
}
