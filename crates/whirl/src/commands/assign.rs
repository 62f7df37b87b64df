//! `whirl assign`: feedback that puts the poles where they are wanted, and what each bearing and sensor can reach.

use std::path::PathBuf;

use rotor::{AssignError, Assignment, C64, ClosedLoop, Feedback, Gain, GainKind, Influence, PBH_LIMIT, Rotor, builtin};
use serde::Serialize;

use super::linear::Part;
use crate::catalog;
use crate::failure::Failure;
use crate::output::{Cell, Format, Table, print_json, print_text};

/// Options of `whirl assign`. What it prints is a feedback file, for `--feedback`.
#[derive(Debug, clap::Args)]
#[command(group = clap::ArgGroup::new("task").required(true).args(["poles", "cancel", "table"]))]
pub(crate) struct AssignArgs {
    /// The rotor: a built-in name, or what `whirl poles` takes
    #[arg(value_name = "ROTOR", default_value = "three-mass")]
    rotor: String,
    /// Wanted poles, two for each mass: "re,im;re,im;..."
    #[arg(long, value_name = "POLES", allow_hyphen_values = true, requires = "speed")]
    poles: Option<Poles>,
    /// The cancelling law kc = zeta (R0 - R), which holds the poles of R0 at every speed (one mass)
    #[arg(long)]
    cancel: bool,
    /// Reference speed R0 of the cancelling law
    #[arg(long, value_name = "R0", default_value_t = 0.0, allow_negative_numbers = true)]
    reference: f64,
    /// List how well a bearing or sensor at each mass reaches each mode
    #[arg(long, requires = "speed")]
    table: bool,
    /// Spin speed R = w / w0 at which the poles are assigned or the table is made
    #[arg(long, value_name = "R", allow_negative_numbers = true)]
    speed: Option<f64>,
    /// The mass that carries the control bearing
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    bearing: u16,
    /// Write the feedback to a file instead
    #[arg(long, value_name = "FILE", conflicts_with = "table")]
    out: Option<PathBuf>,
    #[command(flatten)]
    format: Format,
}

/// The text of `--poles`.
#[derive(Clone, Debug, PartialEq)]
struct Poles(Vec<C64>);

impl std::str::FromStr for Poles {
    type Err = String;

    fn from_str(typed: &str) -> Result<Self, String> {
        let pole = |text: &str| {
            let (re, im) = text.split_once(',')?;
            let number = |text: &str| text.trim().parse::<f64>().ok().filter(|x| x.is_finite());
            Some(C64::new(number(re)?, number(im)?))
        };
        typed
            .split(';')
            .filter(|text| !text.trim().is_empty())
            .map(|text| pole(text).ok_or_else(|| format!("'{}': expected re,im with finite numbers", text.trim())))
            .collect::<Result<_, _>>()
            .map(Self)
    }
}

/// Prints or writes what was asked for.
///
/// # Errors
/// A machine that cannot be made, poles that do not fit it, or a mode that the bearing does not move.
pub(crate) fn run(args: &AssignArgs) -> Result<(), Failure> {
    let rotor = catalog::rotor(&args.rotor)?;
    if args.table {
        return table(args, &rotor);
    }
    if args.cancel {
        return cancel(args, &rotor);
    }
    let wanted = args.poles.as_ref().map_or(&[][..], |poles| &poles.0);
    let made = rotor::assign_poles(&rotor, speed(args, &rotor)?, usize::from(args.bearing) - 1, wanted)?;
    let mut comment =
        format!("{} at R = {}: wanted and achieved poles\n", rotor.name(), args.speed.unwrap_or_default());
    for (wanted, achieved) in &made.poles {
        comment += &format!("{:+.6} {:+.6} j   off by {:.1e}\n", wanted.re, wanted.im, (wanted - achieved).norm());
    }
    deliver(args, &rotor, &made.feedback, &comment, &document(&rotor, args, Some(&made), &made.feedback))
}

/// `--speed`, checked.
fn speed(args: &AssignArgs, rotor: &Rotor) -> Result<f64, Failure> {
    let speed = args.speed.unwrap_or_default();
    let off = builtin::feedback(rotor, "off").ok_or_else(|| Failure::Work("no feedback to begin with".into()))?;
    rotor::Settings::new(rotor, speed, off).check(rotor)?;
    Ok(speed)
}

fn cancel(args: &AssignArgs, rotor: &Rotor) -> Result<(), Failure> {
    if !args.reference.is_finite() {
        return Err(Failure::Usage(format!("reference = {}: expected a finite number", args.reference)));
    }
    let feedback = rotor::cancelling(rotor, args.reference).ok_or_else(|| {
        Failure::Usage(format!(
            "the cancelling law is for one mass, and {} has {}: use --poles",
            rotor.name(),
            rotor.len()
        ))
    })?;
    let comment = format!("{}: kc = zeta (R0 - R) with R0 = {}\n", rotor.name(), args.reference);
    deliver(args, rotor, &feedback, &comment, &document(rotor, args, None, &feedback))
}

/// The JSON document of `--poles` and `--cancel`.
#[derive(Debug, Serialize)]
struct Document<'a> {
    rotor: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    speed: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    reference: Option<f64>,
    feedback: FeedbackDocument,
    /// What the closed loop achieves; absent with `--cancel`, which has no list of poles.
    #[serde(skip_serializing_if = "Option::is_none")]
    achieved: Option<Vec<Achieved>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    largest_error: Option<f64>,
}

#[derive(Debug, Serialize)]
struct Achieved {
    wanted: Part,
    achieved: Part,
    error: f64,
}

fn document<'a>(rotor: &'a Rotor, args: &AssignArgs, made: Option<&Assignment>, feedback: &Feedback) -> Document<'a> {
    Document {
        rotor: rotor.name(),
        speed: made.and(args.speed),
        reference: made.is_none().then_some(args.reference),
        feedback: feedback.into(),
        achieved: made.map(|made| {
            made.poles
                .iter()
                .map(|&(w, a)| Achieved { wanted: w.into(), achieved: a.into(), error: (w - a).norm() })
                .collect()
        }),
        largest_error: made.map(Assignment::error),
    }
}

/// A feedback file's content.
#[derive(Debug, Serialize)]
struct FeedbackDocument {
    bearing: usize,
    signal: Vec<SignalDocument>,
}

#[derive(Debug, Serialize)]
struct SignalDocument {
    displacement: Vec<f64>,
    velocity: Vec<f64>,
    kd: GainDocument,
    cd: GainDocument,
    kc: GainDocument,
    cc: GainDocument,
}

/// A gain in the three forms that a feedback file has for it.
#[derive(Debug, Serialize)]
#[serde(untagged)]
enum GainDocument {
    Constant(f64),
    Linear { at_zero: f64, slope: f64 },
    Table { speed: Vec<f64>, value: Vec<f64> },
}

impl From<&Gain> for GainDocument {
    fn from(gain: &Gain) -> Self {
        match gain {
            Gain::Constant(value) => Self::Constant(*value),
            Gain::Linear { at_zero, slope } => Self::Linear { at_zero: *at_zero, slope: *slope },
            Gain::Table(points) => {
                let (speed, value) = points.iter().copied().unzip();
                Self::Table { speed, value }
            }
        }
    }
}

impl From<&Feedback> for FeedbackDocument {
    fn from(feedback: &Feedback) -> Self {
        let signal = |s: &rotor::Signal| SignalDocument {
            displacement: s.displacement.clone(),
            velocity: s.velocity.clone(),
            kd: s.gain(GainKind::Kd).into(),
            cd: s.gain(GainKind::Cd).into(),
            kc: s.gain(GainKind::Kc).into(),
            cc: s.gain(GainKind::Cc).into(),
        };
        Self { bearing: feedback.bearing + 1, signal: feedback.signals.iter().map(signal).collect() }
    }
}

/// The feedback as a file that `--feedback` reads, behind a comment.
fn toml(feedback: &Feedback, comment: &str) -> String {
    let mut text: String = comment.lines().map(|line| format!("# {line}\n")).collect();
    text += &format!("bearing = {}\n", feedback.bearing + 1);
    for signal in &feedback.signals {
        text += &format!("\n[[signal]]\ndisplacement = {:?}\nvelocity = {:?}\n", signal.displacement, signal.velocity);
        for kind in GainKind::ALL {
            let value = match GainDocument::from(signal.gain(kind)) {
                GainDocument::Constant(value) => format!("{value:?}"),
                GainDocument::Linear { at_zero, slope } => format!("{{ at_zero = {at_zero:?}, slope = {slope:?} }}"),
                GainDocument::Table { speed, value } => format!("{{ speed = {speed:?}, value = {value:?} }}"),
            };
            text += &format!("{} = {value}\n", kind.name());
        }
    }
    text
}

/// Writes the file with `--out`, then prints: the document with `--json`, else the file's text if it was not written.
fn deliver(
    args: &AssignArgs,
    rotor: &Rotor,
    feedback: &Feedback,
    comment: &str,
    document: &Document<'_>,
) -> Result<(), Failure> {
    feedback.check(rotor.len()).map_err(|error| Failure::Work(error.to_string()))?;
    let text = toml(feedback, comment);
    if let Some(path) = &args.out {
        write_whole(path, &text)?;
    }
    match (args.format.json, &args.out) {
        (true, _) => print_json(document),
        (false, Some(_)) => Ok(()),
        (false, None) => print_text(&text),
    }
}

/// Writes a file beside its place and moves it there, so that an interruption leaves no half of it.
fn write_whole(path: &std::path::Path, text: &str) -> Result<(), Failure> {
    let failed = |error: std::io::Error| Failure::Work(format!("cannot write {}: {error}", path.display()));
    let mut beside = path.as_os_str().to_owned();
    beside.push(format!(".{}.part", std::process::id()));
    std::fs::write(&beside, text).and_then(|()| std::fs::rename(&beside, path)).map_err(|error| {
        // Whatever was left is of no use to anybody; that it may not be there is no second failure.
        let _ = std::fs::remove_file(&beside);
        failed(error)
    })
}

/// The JSON document of `--table`.
#[derive(Debug, Serialize)]
struct Reach<'a> {
    rotor: &'a str,
    speed: f64,
    modes: Vec<ReachOfMode>,
}

/// Per mode, one entry a mass.
#[derive(Debug, Serialize)]
struct ReachOfMode {
    re: f64,
    im: f64,
    whirl: rotor::Whirl,
    shape: Vec<Part>,
    controllability: Vec<f64>,
    observability: Vec<f64>,
    pbh: Vec<f64>,
    controllable: Vec<bool>,
}

fn table(args: &AssignArgs, rotor: &Rotor) -> Result<(), Failure> {
    let speed = speed(args, rotor)?;
    let off = builtin::feedback(rotor, "off").ok_or_else(|| Failure::Work("no feedback to begin with".into()))?;
    let reach = rotor::influence(&ClosedLoop::new(rotor, &off, speed, &[]))?;
    let whirl = |pole: C64| rotor::Mode { pole, shape: vec![] }.whirl();
    let reaches = |mode: &Influence, mass: usize| mode.pbh[mass] >= PBH_LIMIT;
    let mut table = Table::new(&["re", "im", "whirl", "mass", "control", "observe", "pbh", "controllable"]);
    for mode in &reach {
        for mass in 0..rotor.len() {
            let word = if reaches(mode, mass) { "yes" } else { "NO" };
            table.row([
                mode.pole.re.into(),
                mode.pole.im.into(),
                Cell::from(&whirl(mode.pole)),
                Cell::from(&(mass + 1)),
                mode.controllability[mass].into(),
                mode.observability[mass].into(),
                mode.pbh[mass].into(),
                Cell::from(&word),
            ]);
        }
    }
    let document = Reach {
        rotor: rotor.name(),
        speed,
        modes: reach
            .iter()
            .map(|mode| ReachOfMode {
                re: mode.pole.re,
                im: mode.pole.im,
                whirl: whirl(mode.pole),
                shape: mode.shape.iter().map(|&p| p.into()).collect(),
                controllability: mode.controllability.clone(),
                observability: mode.observability.clone(),
                pbh: mode.pbh.clone(),
                controllable: (0..rotor.len()).map(|mass| reaches(mode, mass)).collect(),
            })
            .collect(),
    };
    args.format.print(
        &document,
        &format!("{} at R = {speed}, control off: what a bearing or a displacement sensor at each mass reaches", rotor.name()),
        &table,
        "control, observe: cosines between 0 and 1; pbh: least singular value of [A - lambda I, b] over |A|, 0 if the mode stays",
    )
}

impl From<AssignError> for Failure {
    fn from(error: AssignError) -> Self {
        match error {
            AssignError::Bearing { .. } | AssignError::Count { .. } | AssignError::NotFinite(_) => {
                Self::Usage(error.to_string())
            }
            AssignError::NotControllable { .. } | AssignError::Poles(_) => Self::Work(error.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poles_are_read_as_typed() {
        let poles: Poles = "-0.5,1; -1e-1 , -2;".parse().expect("well formed");
        assert_eq!(poles.0, [C64::new(-0.5, 1.0), C64::new(-0.1, -2.0)]);
        for wrong in ["1", "1,2,3", "a,b", "1,inf", "1,2;x"] {
            assert!(wrong.parse::<Poles>().unwrap_err().contains("expected re,im"), "{wrong}");
        }
    }

    #[test]
    fn a_feedback_file_has_every_gain_in_full() {
        let rotor = builtin::rotor("jeffcott").expect("built in");
        let feedback = rotor::cancelling(&rotor, 0.78).expect("one mass");
        assert_eq!(
            toml(&feedback, "a\nb"),
            "# a\n# b\nbearing = 1\n\n[[signal]]\ndisplacement = [1.0]\nvelocity = [1.0]\nkd = 0.0\ncd = 0.0\n\
             kc = { at_zero = 0.39, slope = -0.5 }\ncc = 0.0\n"
        );
    }
}
