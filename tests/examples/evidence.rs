//! Makes `docs/book/src/side-by-side.md`: sets of gains beside each other, on the report's three-mass rotor and on the rig, as they are, late, detuned and
//! with clearance. Every number is what a command of the program prints: `cargo build --release -p promises && cargo run --release -p promises --example evidence --
//! docs/book/src/side-by-side.md`.

#![expect(clippy::print_stderr, reason = "how long it took")]

use std::error::Error;
use std::path::Path;
use std::process::Stdio;
use std::time::Instant;

use promises::whirl;
use serde_json::Value;

type Done<T> = Result<T, Box<dyn Error + Send + Sync>>;

/// A set of gains: what the page calls it, and its feedback.
type Gains = (&'static str, &'static str);
/// What is done to a machine: what the page calls it, its rotor, and further options.
type Variant = (&'static str, &'static str, &'static [&'static str]);

const THREE_MASS: [Gains; 4] = [
    ("built in", "built-in.toml"),
    ("Powell", "powell.toml"),
    ("ours", "ours.toml"),
    ("ours, any clearance", "robust.toml"),
];
const RIG: [Gains; 3] = [("its drawing", "own"), ("Powell", "rig-powell.toml"), ("ours", "rig-ours.toml")];

const OF_THREE_MASS: [Variant; 4] = [
    ("as it is", "three-mass.toml", &[]),
    ("a delay of 0.05", "three-mass.toml", &["--set", "delay=0.05"]),
    ("detuned", "detuned.toml", &[]),
    ("detuned, and the delay", "detuned.toml", &["--set", "delay=0.05"]),
];
const OF_RIG: [Variant; 3] = [
    ("as it is", "rig.toml", &[]),
    ("a delay of 20 us", "rig.toml", &["--set", "delay=20e-6"]),
    ("detuned", "rig-detuned.toml", &[]),
];

/// How gains are found, in order; each a command of the program.
const SEARCHES: [&str; 5] = [
    "tune three-mass --over 0..6 --method powell --starts 60 --out powell.toml",
    "tune three-mass --over 0..6 --starts 8 --out ours.toml",
    "tune three-mass --over 0..6 --signal individual --sensors 1,2 --bound 5 --robust deadband --out robust.toml",
    "tune rig --speed 6000 --method powell --starts 1 --out rig-powell.toml",
    "tune rig --speed 6000 --max-sensitivity 3 --starts 1 --out rig-ours.toml",
];

/// Rows of the report's rotor: what it is, and how it is read.
const MEASURES: [(&str, Measure); 8] = [
    ("smallest damping ratio over 0 to 6", |of| {
        of.smallest(&["trace", "--over", "0..6", "--points", "121"], "min_damping")
    }),
    ("peak of the sensitivity over 0 to 6", |of| {
        of.at(&["margin", "--over", "0..6"], "/worst/sensitivity/sensitivity/peak")
    }),
    ("orbit at R = 6, no clearance", |of| {
        of.largest(&["run", "--speed", "6", "--duration", "1500"], "max_displacement")
    }),
    ("force there", |of| of.at(&["run", "--speed", "6", "--duration", "1500"], "/max_force")),
    ("orbit at R = 6, clearance 10", |of| {
        of.largest(&["run", "--speed", "6", "--duration", "1500", "--deadband", "10"], "max_displacement")
    }),
    ("force there ", |of| of.at(&["run", "--speed", "6", "--duration", "1500", "--deadband", "10"], "/max_force")),
    ("speeds of 12 with a stable limit cycle, clearance 10", |of| {
        of.cycles("0.5..6", "12", Some("10")).map(|found| found.0)
    }),
    ("the largest of those", |of| of.cycles("0.5..6", "12", Some("10")).map(|found| found.1)),
];
/// Rows of the rig.
/// The last two are solved exactly, which takes minutes with a delay: that variant is told without them.
const MEASURES_OF_RIG: [(&str, Measure); 5] = [
    ("smallest damping ratio at 6000 rpm", |of| of.at(&["poles", "--speed", "6000"], "/min_damping")),
    ("peak of the sensitivity there", |of| of.largest(&["bode", "--speed", "6000", "--of", "sensitivity"], "points")),
    ("orbit there, um", |of| of.orbit("5990..6000")),
    ("force there, N", |of| of.force("5990..6000")),
    ("speeds of 2 with a stable limit cycle in the touchdown bearings", |of| {
        of.cycles("5000..6000", "2", None).map(|found| found.0)
    }),
];

/// How a row is read of a machine; words where there is no number.
type Measure = fn(&Machine<'_>) -> Done<String>;

/// A machine under a set of gains.
struct Machine<'a> {
    folder: &'a Path,
    rotor: &'a str,
    feedback: &'a str,
    options: &'a [&'a str],
}

impl Machine<'_> {
    /// The document that a command prints of it; none where the command refuses the machine, as one that is not stable has no margins.
    fn told(&self, words: &[&str]) -> Done<Option<Value>> {
        let mut command = whirl();
        command
            .arg(words[0])
            .arg(self.rotor)
            .args(&words[1..])
            .args(["--feedback", self.feedback, "--json"])
            .args(self.options);
        let output = command.current_dir(self.folder).stderr(Stdio::piped()).output()?;
        let errors = String::from_utf8_lossy(&output.stderr);
        match output.status.code() {
            Some(0) => Ok(Some(serde_json::from_slice(&output.stdout)?)),
            _ if errors.contains("not stable") => Ok(None),
            code => {
                Err(format!("whirl {words:?} of {} under {}: {code:?}: {errors}", self.rotor, self.feedback).into())
            }
        }
    }

    fn at(&self, words: &[&str], pointer: &str) -> Done<String> {
        let Some(document) = self.told(words)? else { return Ok("unstable".into()) };
        if document["diverged"] == true || document["tripped"] == true {
            return Ok("diverges".into());
        }
        let found =
            document.pointer(pointer).and_then(Value::as_f64).ok_or_else(|| format!("{words:?} has no {pointer}"))?;
        Ok(told(found))
    }

    fn largest(&self, words: &[&str], list: &str) -> Done<String> {
        let Some(document) = self.told(words)? else { return Ok("unstable".into()) };
        if document["diverged"] == true {
            return Ok("diverges".into());
        }
        let found = numbers(&document, list).into_iter().fold(f64::NAN, f64::max);
        Ok(told(found))
    }

    fn smallest(&self, words: &[&str], list: &str) -> Done<String> {
        let document = self.told(words)?.ok_or("a trace is of any machine")?;
        Ok(told(numbers(&document, list).into_iter().fold(f64::NAN, f64::min)))
    }

    /// The largest orbit of the steady response to unbalance at the end of a range of speeds, in micrometres.
    fn orbit(&self, over: &str) -> Done<String> {
        let Some(document) = self.told(&["bode", "--over", over, "--of", "unbalance"])? else {
            return Ok("unstable".into());
        };
        let last = document["points"].as_array().and_then(|points| points.last()).ok_or("points")?;
        let largest = numbers(last, "stations").into_iter().fold(f64::NAN, f64::max);
        Ok(told(largest * scale(&document, "e_t")? * 1e6))
    }

    /// The control force of the orbit that the machine stays on there, clearances and all, in newtons.
    fn force(&self, over: &str) -> Done<String> {
        let document =
            self.told(&["response", "--over", over, "--points", "2"])?.ok_or("a response is of any machine")?;
        let branches = document["points"][1]["branches"].as_array().ok_or("branches")?.iter();
        let stable = branches.filter(|branch| branch["stable"] == true);
        let largest = stable.filter_map(|branch| branch["force"].as_f64()).fold(f64::NAN, f64::max);
        let unit = scale(&document, "k_t")? * scale(&document, "e_t")?;
        Ok(if largest.is_nan() { "none it stays on".into() } else { told(largest * unit) })
    }

    /// At how many speeds there is a stable limit cycle, and the largest radius of any.
    fn cycles(&self, over: &str, points: &str, deadband: Option<&str>) -> Done<(String, String)> {
        let mut words = vec!["cycles", "--over", over, "--points", points];
        words.extend(deadband.into_iter().flat_map(|deadband| ["--deadband", deadband]));
        let document = self.told(&words)?.ok_or("cycles are of any machine")?;
        let (mut speeds, mut largest) = (0, f64::NAN);
        for point in document["points"].as_array().ok_or("points")? {
            let branches =
                point["branches"].as_array().ok_or("branches")?.iter().filter(|branch| branch["stable"] == true);
            let radii: Vec<f64> = branches.flat_map(|branch| numbers(branch, "radius")).collect();
            speeds += usize::from(!radii.is_empty());
            largest = radii.into_iter().fold(largest, f64::max);
        }
        Ok((speeds.to_string(), if largest.is_nan() { "none".into() } else { told(largest) }))
    }
}

/// Numbers of a list; of points their amplitude.
fn numbers(document: &Value, list: &str) -> Vec<f64> {
    let items = document[list].as_array().map_or(&[][..], Vec::as_slice);
    items.iter().filter_map(|item| item.as_f64().or_else(|| item["amplitude"].as_f64())).collect()
}

/// What one of something is in SI units.
fn scale(document: &Value, name: &str) -> Done<f64> {
    document["scales"][name].as_f64().ok_or_else(|| format!("no scale {name}").into())
}

fn told(number: f64) -> String {
    match number.abs() {
        size if size < 0.1 => format!("{number:.4}"),
        size if size < 10.0 => format!("{number:.2}"),
        _ => format!("{number:.0}"),
    }
}

/// The lines of a rotor's file with some numbers times a factor.
fn detuned(text: &str, factors: &[(&str, f64)]) -> Done<String> {
    let mut out = String::new();
    for line in text.lines() {
        let scaled = factors.iter().find_map(|(key, factor)| {
            let value = line.strip_prefix(key)?.trim_start().strip_prefix('=')?.split('#').next()?.trim();
            Some(format!("{key} = {:e}", value.parse::<f64>().ok()? * factor))
        });
        out += scaled.as_deref().unwrap_or(line);
        out.push('\n');
    }
    Ok(out)
}

fn run(folder: &Path, line: &str) -> Done<String> {
    let output = whirl().args(line.split(' ')).current_dir(folder).output()?;
    if !output.status.success() {
        return Err(format!("whirl {line}: {}", String::from_utf8_lossy(&output.stderr)).into());
    }
    Ok(String::from_utf8(output.stdout)?)
}

/// A table: a row a measure, a column a set of gains.
fn table(
    out: &mut String,
    folder: &Path,
    rotor: (&str, &[&str]),
    gains: &[Gains],
    measures: &[(&str, Measure)],
) -> Done<()> {
    *out += &format!(
        "\n| | {} |\n|---|{}\n",
        gains.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(" | "),
        "---|".repeat(gains.len())
    );
    for (what, measure) in measures {
        // The columns beside each other in time, too.
        let cells = std::thread::scope(|scope| {
            let columns: Vec<_> = gains
                .iter()
                .map(|(_, feedback)| {
                    scope.spawn(move || measure(&Machine { folder, rotor: rotor.0, feedback, options: rotor.1 }))
                })
                .collect();
            columns
                .into_iter()
                .map(|column| column.join().map_err(|_| "a column panicked")?)
                .collect::<Done<Vec<String>>>()
        })?;
        *out += &format!("| {} | {} |\n", what.trim_end(), cells.join(" | "));
    }
    Ok(())
}

fn main() -> Done<()> {
    let page = std::env::args().nth(1).unwrap_or_else(|| "side-by-side.md".into());
    let began = Instant::now();
    let folder = tempfile::tempdir()?;
    let folder = folder.path();
    let show = |line: &str, file: &str| -> Done<String> {
        let text = run(folder, line)?;
        std::fs::write(folder.join(file), &text)?;
        Ok(text)
    };
    let three_mass = show("rotor show three-mass", "three-mass.toml")?;
    let rig = show("rotor show rig", "rig.toml")?;
    show("rotor show three-mass --feedback composite", "built-in.toml")?;
    let seals = [("damping", 1.1), ("bearing_stiffness", 0.9), ("stiffness", 0.9)];
    std::fs::write(folder.join("detuned.toml"), detuned(&three_mass, &seals)?)?;
    let magnets =
        [("force_per_current", 0.9), ("negative_stiffness", 1.1), ("youngs_modulus", 0.95), ("shear_modulus", 0.95)];
    std::fs::write(folder.join("rig-detuned.toml"), detuned(&rig, &magnets)?)?;
    let mut out = String::from(HEAD);
    out += "```text\n";
    for search in SEARCHES {
        run(folder, search)?;
        out += &format!("whirl {search}\n");
    }
    out += "```\n\n## The report's three-mass rotor\n\nOrbits are in e_t, forces in w0^2 e_t. *Detuned*: seals 10 % stronger, support bearings and shafts 10 % softer, the gains as they were.\n";
    for (name, rotor, options) in OF_THREE_MASS {
        out += &format!("\n### {}, {name}\n", "Three masses");
        table(&mut out, folder, (rotor, options), &THREE_MASS, &MEASURES)?;
    }
    out += "\n## The rig\n\nA flexible shaft on two magnetic bearings, at 6000 rpm under the unbalance and with the touchdown clearances of its drawing. *Detuned*: 10 % less force per current, 10 % more negative stiffness, a \
            material 5 % softer.\n";
    for (name, rotor, options) in OF_RIG {
        out += &format!("\n### The rig, {name}\n");
        let measures = if options.is_empty() { &MEASURES_OF_RIG[..] } else { &MEASURES_OF_RIG[..3] };
        table(&mut out, folder, (rotor, options), &RIG, measures)?;
    }
    std::fs::write(page, out)?;
    eprintln!("made in {:.0} s", began.elapsed().as_secs_f64());
    Ok(())
}

/// What stands before the tables.
const HEAD: &str = "<!-- Made by `just side-by-side`: do not edit. -->

# Gains side by side

The same rotor under different gains, as it is and as it may turn out to be. Every number is what a command of the program prints; `just side-by-side` makes the page again. The gains are

* **built in**: `composite`, in the structure of the NASA report, whose own gains are lost; **its drawing**: the law that the rig comes with;
* **Powell**: what the report's method finds, Powell's search, from 60 starts (of the rig, whose search takes longer, from one: its own law);
* **ours**: what `whirl tune` finds in the same structure; of the rig with the peak of the sensitivity held below 3;
* **ours, any clearance**: four gains for each of two sensors, held for whatever stiffness a clearance leaves.

A search is as good as what it is asked for. The largest damping alone may cost a peak of the sensitivity, and no clearance was asked of the first three; a set that holds for
any clearance was not asked to hold for other parameters too. `--max-sensitivity`, `--robust` and `--vary` ask for those.

";
