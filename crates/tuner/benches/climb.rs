//! One search beside the other in one process: the same problem, the same random gains, ours and Powell's method.
//!
//! `best` says what each ends with: time alone would flatter whoever gives up first.

use divan::Bencher;
use tuner::{Family, Method, Options, Problem, Schedule, Stop, Structure, tune};

#[expect(clippy::print_stdout, reason = "what each search ends with belongs beside its time")]
fn main() {
    for (name, method) in [("nonsmooth", Method::Nonsmooth), ("powell", Method::Powell)] {
        let (problem, options) = asked(method);
        let found = tune(&problem, &options, &|_| {}, Stop::NEVER).expect("a sound problem");
        println!("{name}: best {:.6} of {} starts", found.worst.value, options.starts);
    }
    divan::main();
}

/// Composite gains for the three-mass rotor at R = 6, eight starts on one thread.
fn asked(method: Method) -> (Problem, Options) {
    let rotor = rotor::builtin::rotor("three-mass").expect("built in");
    let family = Family::new(&rotor, 6.0, 6.0).expect("a speed");
    let structure = Structure::new(&rotor, &Structure::composite(3, 0, &[0, 1]), Schedule::Fixed).expect("it fits");
    let problem = Problem::new(family, structure, 20.0);
    let options = Options { method, starts: 8, threads: Some(1), ..Options::for_problem(&problem) };
    (problem, options)
}

fn search(bencher: Bencher<'_, '_>, method: Method) {
    let (problem, options) = asked(method);
    bencher.bench(|| tune(&problem, &options, &|_| {}, Stop::NEVER));
}

#[divan::bench]
fn nonsmooth(bencher: Bencher<'_, '_>) {
    search(bencher, Method::Nonsmooth);
}

#[divan::bench]
fn powell(bencher: Bencher<'_, '_>) {
    search(bencher, Method::Powell);
}

/// Individual gains over 0..6, with limits of both margins and without: two starts on one thread, proof and all.
#[divan::bench(args = [false, true], sample_count = 5)]
fn individual_gains(bencher: Bencher<'_, '_>, with_margins: bool) {
    let rotor = rotor::builtin::rotor("three-mass").expect("built in");
    let family = Family::new(&rotor, 0.0, 6.0).expect("a range");
    let structure = Structure::new(&rotor, &Structure::individual(3, 0, &[0, 1]), Schedule::Fixed).expect("it fits");
    let free = Problem::new(family, structure, 5.0);
    let asked = Problem { max_sensitivity: Some(1.5), min_delay: Some(0.1), ..free.clone() };
    let problem = if with_margins { asked } else { free };
    let options = Options { starts: 2, threads: Some(1), ..Options::for_problem(&problem) };
    bencher.bench_local(|| tune(&problem, &options, &|_| {}, Stop::NEVER));
}
