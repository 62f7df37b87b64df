use tuner::*;
fn main() {
    let rotor = rotor::builtin::rotor("three-mass").unwrap();
    let which = std::env::args().nth(1).unwrap_or_default();
    let starts = std::env::args().nth(2).and_then(|s| s.parse().ok());
    let go = |name: &str, fam: &Family, fb: rotor::Feedback, bound: f64| {
        if !name.starts_with(&which) { return }
        let s = Structure::new(&rotor, &fb, Schedule::Fixed).unwrap();
        let p = Problem::new(fam.clone(), s, bound);
        let mut o = Options::for_problem(&p);
        if let Some(n) = starts { o.starts = n }
        if let Some(sp) = std::env::args().nth(3).and_then(|s| s.parse().ok()) { o.spread = sp }
        if let Some(sp) = std::env::args().nth(4).and_then(|s| s.parse().ok()) { o.seed = sp }
        let t = tune(&p, &o, &|_| {}, Stop::NEVER).unwrap();
        let n = t.values.iter().filter(|v| **v > t.values[0] - 0.01 * t.values[0].abs()).count();
        println!("{name}: {:.8} proven {} boxes {} at {:.4?} | first {:.8} within1% {n}/{} | {:.0} ms evals {} | stat {:.1e} act {} merge {} bound {} | {:.4?}",
            t.worst.value, t.worst.proven, t.worst.boxes, t.worst.point, t.values[0], o.starts, t.elapsed.as_secs_f64()*1e3, t.evaluations, t.stationarity.norm, t.stationarity.active, t.stationarity.merging, t.stationarity.at_bound, t.gains);
        println!("    {:.5?}", &t.values[..t.values.len().min(16)]);
    };
    let comp = Structure::composite(3, 0, &[0, 1]);
    let ind = Structure::individual(3, 0, &[0, 1]);
    for r in [7.2, 6.0, 4.0] { go(&format!("comp{r}"), &Family::new(&rotor, r, r).unwrap(), comp.clone(), 20.0); }
    for r in [5.0, 7.2] { go(&format!("compto{r}"), &Family::new(&rotor, 0.0, r).unwrap(), comp.clone(), 20.0); }
    for b in [5.0, 20.0] { go(&format!("ind{b}"), &Family::new(&rotor, 0.0, 7.2).unwrap(), ind.clone(), b); }
    for (r, b) in [(6.0,5.0),(7.2,5.0),(7.2,20.0)] {
        let mut f = Family::new(&rotor, 0.0, r).unwrap(); f.any_deadband(true).unwrap();
        go(&format!("robust{r}/{b}"), &f, ind.clone(), b);
    }
}
