//! Samples against NumPy: the same draws, the damping by LAPACK (`tests/reference/samples.py`).

use rotor::{Settings, builtin};
use serde_json::Value;
use variation::{Distribution, Model, Range, Samples, draw, samples};

fn model() -> Model {
    let rotor = builtin::rotor("three-mass").expect("built in");
    let feedback = builtin::feedback(&rotor, "individual").expect("built in");
    let settings = Settings::new(&rotor, 6.0, feedback);
    Model::new(rotor, settings)
}

fn ranges(model: &Model) -> Vec<Range> {
    let range = |(name, from, to)| Range { parameter: model.parameter(name).expect("a parameter"), from, to };
    [("mass.1", 0.2, 0.3), ("damping.1", 0.1, 1.2), ("shaft.2", 0.2, 0.8)].map(range).into()
}

#[test]
fn val_samples_are_those_of_numpy() {
    let told: Value = serde_json::from_str(include_str!("../../../tests/reference/samples.json")).expect("JSON");
    let number = |value: &Value| value.as_f64().expect("a number");
    let list = |value: &Value| value.as_array().expect("a list").iter().map(number).collect::<Vec<f64>>();
    let (seed, count) = (told["seed"].as_u64().expect("a seed"), told["count"].as_u64().expect("a count"));
    for (index, draws) in [0, 1, 123_456_789].into_iter().zip(told["draws"].as_array().expect("a list")) {
        assert_eq!(draw(seed, index, 9), list(draws));
    }
    let model = model();
    for (name, distribution) in [("uniform", Distribution::Uniform), ("normal", Distribution::Normal)] {
        let told = &told[name];
        let drawn = samples(&model, &ranges(&model), distribution, seed, [0, count], &|_| ()).expect("samples");
        for (ours, theirs) in drawn.iter().zip(list(&told["first"])) {
            assert!((ours - theirs).abs() < 1e-11, "{name}: {ours} {theirs}");
        }
        let found = Samples::of(drawn);
        assert_eq!(found.stable.share, number(&told["stable"]) / count as f64);
        for (ours, theirs) in found.stable.interval.iter().zip(list(&told["interval"])) {
            assert!((ours - theirs).abs() < 1e-12, "{name}");
        }
        for (part, theirs) in told["quantiles"].as_object().expect("quantiles") {
            assert!((found.quantile(part.parse().expect("a number")) - number(theirs)).abs() < 1e-11, "{name} {part}");
        }
    }
}

#[test]
fn samples_do_not_depend_on_how_they_are_cut_or_on_how_many_threads_draw_them() {
    let model = model();
    let ranges = ranges(&model);
    let of = |part: [u64; 2]| samples(&model, &ranges, Distribution::Normal, 3, part, &|_| ()).expect("samples");
    let whole = of([0, 3000]);
    let cut = [of([0, 1]), of([1, 1500]), of([1501, 1499])].concat();
    assert_eq!(whole, cut);
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool").install(|| of([0, 3000]));
    assert_eq!(whole, alone);
}
