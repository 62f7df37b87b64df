//! What can be asked of the dashboard.

use alarms::Watch;
use rotor::Key;
use rotor::typed::TypedRange;
use telemetry::edits::Edit;
use units::Typed;

use crate::axis::Scaling;
use crate::selection::ReadoutMove;
use crate::series::Strip;

/// What a person asks of the dashboard.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Action {
    /// Select the setting so many rows further down.
    Select(isize),
    /// Change the machine in a way that needs nothing filled in: undo, redo, control off, a note, a restart.
    Edit(Edit),
    /// Raise the selected setting by so many of its steps.
    NudgeSelected(f64),
    /// Start to type a value; enter takes it, esc drops it.
    Type,
    /// Set these, all at once, as they were typed: in the units of the bench.
    SetTyped(Vec<(Key, Typed)>),
    /// The speed goes from one (the present one if there is none) to another at a rate, all as typed.
    RunUp {
        /// The speed that it is to have now.
        from: Option<Typed>,
        /// The speed that it goes to.
        to: Typed,
        /// How fast.
        rate: Typed,
    },
    /// The speed stays where it is on its way.
    Stay,
    /// The speed goes to rest, as fast as it changes now or may change.
    ToRest,
    /// A fault, as typed, or `off`.
    Drill(String),
    /// Search gains; this says for what.
    Search(String),
    /// Strike the mass with the control bearing; of several with that of the selected setting, or the first.
    StrikeBearing,
    /// Hold the present settings to compare with.
    Hold,
    /// Change places between the held settings and the present ones.
    SwapHeld,
    /// Keep the gains under a name.
    Save(String),
    /// Take gains kept under a name.
    Load(String),
    /// Delete gains kept under a name.
    Delete(String),
    /// Stop and go on with the picture.
    Pause,
    /// Move the cursor by so many seconds.
    Seek(f64),
    /// Move the cursor by so many steps.
    Step(i64),
    /// Show so many times as much time.
    Zoom(f64),
    /// Show so many seconds.
    Span(f64),
    /// Show as much time as at the start.
    ZoomReset,
    /// Choose a plot by name, or the next (`1`) or the one before (`-1`).
    Choose(String),
    /// The scale of the values of a plot: of the named one, or of the chosen one.
    Scale(Option<String>, Vec<Scaling>),
    /// Move the read-out of the chosen plot.
    Read(ReadoutMove),
    /// What the strips show; what the layout says if there is none.
    Strips(Option<Vec<Strip>>),
    /// The mass, counted from 0, and the frequencies of the spectra: `None` leaves them as they are.
    Spectra(Option<Option<usize>>, Option<TypedScaling>),
    /// Start to record the bench, or end that.
    Record,
    /// Start to record the bench, after the last so many seconds that are kept in memory.
    RecordLast(f64),
    /// The limits of something that is watched, as typed: in the units of the bench.
    Limit(Watch, TypedLimit),
    /// All alarms have been seen.
    Acknowledge,
    /// A recording: play faster (1) or slower (-1).
    Pace(isize),
    /// A recording: to the next event (1) or the one before (-1).
    Event(isize),
    /// A recording: begin a loop, end it, drop it.
    Loop,
    /// A recording: to a dimensionless time.
    GoTo(f64),
    /// A recording: to its end, or its beginning.
    End(bool),
    /// Keep a picture of the screen, in this file or in one named by bench and time.
    FrameData(String),
    /// Another layout, by its number counted from 1 or its name.
    Layout(String),
    /// Start to type a command; this much is typed already.
    Command(String),
    /// Move the lists by so many rows.
    Scroll(isize),
    /// Start to type what the lists shall show.
    Filter,
    /// Put the selected setting, or all of them, on the clipboard.
    Copy(bool),
    /// Show every event and alarm in full.
    Log,
    /// Look at the step with the largest control force, or forget it.
    Peak(bool),
    /// Show and hide the help.
    Help,
    /// Close the top layer.
    Escape,
    /// Lock the machine against keys, or unlock it.
    Lock,
    /// Give the terminal back until the shell continues us.
    Suspend,
    /// End.
    Quit,
}

/// What is asked for as limits of something, as typed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum TypedLimit {
    /// None.
    Off,
    /// Those that follow the machine.
    Machine,
    /// Warning and alarm.
    Pair([Typed; 2]),
}

/// What is asked of an axis of frequencies, as typed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum TypedScaling {
    /// Follow what is shown.
    Auto,
    /// Stand still at this range.
    Fix(TypedRange),
}
