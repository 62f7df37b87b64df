"""The messages of a whirl bench. Made of the tables of the crate `wire`; not to be edited."""

from __future__ import annotations

import builtins
import ctypes
from typing import Any, ClassVar, NamedTuple

ICEORYX2 = "0.10"
SCHEMA_ATTRIBUTE = "whirl.schema"
SCHEMA = 5  # version of all messages together
MAX_MASSES = 16  # masses of the largest rotor
MAX_BEARINGS = 8  # control bearings of the largest machine
MAX_BURST = 32  # steps of the largest message of whirl/NAME/state
EVENTS_KEPT = 64  # events that reach readers that come late
DOCUMENTS_KEPT = 96  # documents that reach readers that come late
MAX_DOCUMENT = 65536  # bytes of the largest document
MAX_SNAPSHOT = 32768  # words of the largest snapshot

#: Flags of a step, beside bit N - 1 for mass N that presses on its bearing.
FLAGS = {
    "saturated": 0x10000,  # the control bearing is at its limit
    "tripped": 0x20000,  # the machine has tripped: the rotor is held where it was, or coasts down
    "late": 0x40000,  # the step was sent more than one period of wake-ups (of a step, or of all steps that share one) after it was due
    "external": 0x80000,  # the command comes from a controller outside
    "held": 0x100000,  # a command from outside that should be there is not: the last one is held
    "coasting": 0x200000,  # beside TRIPPED: not held, the speed coasts down to rest and the rotor goes on moving
}


class Channel(NamedTuple):
    """A quantity of a step."""

    name: str
    scope: str  # once, mass, sensor, further
    place: int  # among the words of its scope
    is_number: bool
    unit: str
    meaning: str


CHANNELS = (
    Channel("run_id", "once", 0, False, "", "which run of which process: changes when the simulation starts anew"),
    Channel("seq", "once", 1, False, "", "number of the step since the process started: up by 1 each, also while tripped"),
    Channel("wall_ns", "once", 2, False, "", "wall clock when the step was due to be sent, nanoseconds since 1970"),
    Channel("revision", "once", 3, False, "", "revision of the settings that the step was made with"),
    Channel("flags", "once", 4, False, "", "bits 0 to 31: what is special; 32 to 47: how many masses; 48 to 55: how many sensors; 56 to 63: how many control bearings after the first"),
    Channel("tau", "once", 5, True, "1/w0", "time since the rotor was last at rest; stands still while the machine is held after a trip"),
    Channel("angle", "once", 6, True, "rad", "spin angle, unwrapped: the unbalance points along it"),
    Channel("speed", "once", 7, True, "w0", "spin speed R"),
    Channel("speed_rate", "once", 8, True, "w0^2", "rate of change of the spin speed"),
    Channel("uy_commanded", "once", 9, True, "w0^2 e_t", "control that the feedback asks for at the first control bearing, y"),
    Channel("uz_commanded", "once", 10, True, "w0^2 e_t", "control that the feedback asks for at the first control bearing, z"),
    Channel("uy", "once", 11, True, "w0^2 e_t", "control that the first control bearing delivers, y"),
    Channel("uz", "once", 12, True, "w0^2 e_t", "control that the first control bearing delivers, z"),
    Channel("y", "mass", 0, True, "e_t", "displacement, y"),
    Channel("z", "mass", 1, True, "e_t", "displacement, z"),
    Channel("vy", "mass", 2, True, "w0 e_t", "velocity, y"),
    Channel("vz", "mass", 3, True, "w0 e_t", "velocity, z"),
    Channel("reading_y", "sensor", 0, True, "e_t", "displacement as the loop reads it, y"),
    Channel("reading_z", "sensor", 1, True, "e_t", "displacement as the loop reads it, z"),
    Channel("bearing_uy_commanded", "further", 0, True, "w0^2 e_t", "control that the feedback asks for, y"),
    Channel("bearing_uz_commanded", "further", 1, True, "w0^2 e_t", "control that the feedback asks for, z"),
    Channel("bearing_uy", "further", 2, True, "w0^2 e_t", "control that the bearing delivers, y"),
    Channel("bearing_uz", "further", 3, True, "w0^2 e_t", "control that the bearing delivers, z"),
)

#: Words of a row for each of a scope.
WORDS = {"once": 13, "mass": 4, "sensor": 2, "further": 4}


class Analysis(ctypes.Structure):
    """The poles of the linear rotor, deadband neglected."""

    #: The revision of the settings that it is for; 0 while there is none.
    revision: int
    #: How many of `poles` are used: all, or the 32 least damped; 0 if there are none, as with unequal
    #: amplifiers or too long a delay.
    count: int
    #: Always 0.
    reserved: int
    #: Spin speed `R` that it is for: while that changes, the one of some tenth of a second ago.
    speed: float
    #: The smallest damping ratio of the modes that count (of shaft elements not the fastest, as long as
    #: they decay); 0 if there are no poles.
    min_damping: float
    #: The poles `[re, im]`, least damped first.
    poles: ctypes.Array[Any]
    _fields_: ClassVar = [
        ("revision", ctypes.c_uint64),
        ("count", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
        ("speed", ctypes.c_double),
        ("min_damping", ctypes.c_double),
        ("poles", ctypes.c_double * 2 * 32),
    ]

    @staticmethod
    def type_name() -> str:
        """Its name on the wire."""
        return "whirl.Analysis"


assert ctypes.sizeof(Analysis) == 544


class Health(ctypes.Structure):
    """How well the simulation keeps its pace. Counts are since the process started; percentiles too."""

    #: Steps sent.
    steps: int
    #: Steps sent more than one period of wake-ups (of a step, or of all steps that share one) after they
    #: were due.
    late: int
    #: Deadlines given up because the process was too far behind to catch up.
    missed: int
    #: How long after its deadline a wake-up came, microseconds: median.
    lateness_p50_us: float
    #: The same, 99th percentile.
    lateness_p99_us: float
    #: The same, the worst.
    lateness_max_us: float
    #: What a step costs (step, fill and send), microseconds: median.
    cost_p50_us: float
    #: The same, 99th percentile.
    cost_p99_us: float
    #: How many readers of the state there are.
    subscribers: int
    #: Always 0.
    reserved: int
    _fields_: ClassVar = [
        ("steps", ctypes.c_uint64),
        ("late", ctypes.c_uint64),
        ("missed", ctypes.c_uint64),
        ("lateness_p50_us", ctypes.c_double),
        ("lateness_p99_us", ctypes.c_double),
        ("lateness_max_us", ctypes.c_double),
        ("cost_p50_us", ctypes.c_double),
        ("cost_p99_us", ctypes.c_double),
        ("subscribers", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
    ]

    @staticmethod
    def type_name() -> str:
        """Its name on the wire."""
        return "whirl.Health"


assert ctypes.sizeof(Health) == 72


class ControlHealth(ctypes.Structure):
    """How a controller outside does. Counts are since the process started; percentiles too."""

    #: Commands that were taken.
    taken: int
    #: Of these, commands that came after their deadline.
    late: int
    #: Samples whose command was not there at its deadline.
    missed: int
    #: Commands that were not taken, because they were not finite.
    refused: int
    #: How often commands from outside came to act.
    took_over: int
    #: How often the law of the bench had to take over.
    lost: int
    #: How long after its readings a command was sent, by its own time stamp, microseconds: median; 0 where
    #: none has one.
    age_p50_us: float
    #: The same, 99th percentile.
    age_p99_us: float
    #: 1 if commands from outside act, 0 while the law of the bench does.
    acting: int
    #: Always 0.
    reserved: int
    _fields_: ClassVar = [
        ("taken", ctypes.c_uint64),
        ("late", ctypes.c_uint64),
        ("missed", ctypes.c_uint64),
        ("refused", ctypes.c_uint64),
        ("took_over", ctypes.c_uint64),
        ("lost", ctypes.c_uint64),
        ("age_p50_us", ctypes.c_double),
        ("age_p99_us", ctypes.c_double),
        ("acting", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
    ]

    @staticmethod
    def type_name() -> str:
        """Its name on the wire."""
        return "whirl.ControlHealth"


assert ctypes.sizeof(ControlHealth) == 72


class Trip(ctypes.Structure):
    """What tripped the machine; all zero while it runs."""

    #: 0 running, 1 an orbit grew past the limit, 2 the motion left the range of numbers, 3 no command came
    #: from outside, 4 an orbit grew past the limit, and the speed coasts down.
    cause: int
    #: The mass with the largest orbit, counted from 1.
    mass: int
    #: The step at which it happened.
    step: int
    #: Its radius then, in `e_t`; the last finite one.
    radius: float
    #: The limit then in force, in `e_t`.
    limit: float
    _fields_: ClassVar = [
        ("cause", ctypes.c_uint32),
        ("mass", ctypes.c_uint32),
        ("step", ctypes.c_uint64),
        ("radius", ctypes.c_double),
        ("limit", ctypes.c_double),
    ]

    @staticmethod
    def type_name() -> str:
        """Its name on the wire."""
        return "whirl.Trip"


assert ctypes.sizeof(Trip) == 32


class DocumentHead(ctypes.Structure):
    """What stands before the text of a document."""

    #: Its name: FNV-1a, 64 bits, of the text.
    hash: int
    #: 1 a rotor, 2 settings.
    kind: int
    #: Always 0.
    reserved: int
    _fields_: ClassVar = [
        ("hash", ctypes.c_uint64),
        ("kind", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
    ]

    @staticmethod
    def type_name() -> str:
        """Its name on the wire."""
        return "whirl.DocumentHead"


assert ctypes.sizeof(DocumentHead) == 16


class BenchStatus(ctypes.Structure):
    """The whole slow picture of a bench in one message, so that its parts always fit together. `BenchStatus`
    is it with the documents that it names."""

    #: Which run of which process: as in the steps.
    run_id: int
    #: Number of this bench status in its run: rises by 1.
    number: int
    #: Wall clock when it was made, nanoseconds since 1970.
    wall_ns: int
    #: Wall clock when the process started, nanoseconds since 1970.
    started_ns: int
    #: Process id of the simulation.
    pid: int
    #: How many masses the rotor has, and sensors: what a step's words are laid out for in this run.
    masses: int
    #: Version of the program that simulates.
    version: builtins.bytes
    #: The rotor's name.
    rotor_name: builtins.bytes
    #: Hash of the rotor's document.
    rotor: int
    #: Hash of the document of the settings in force.
    settings: int
    #: Scales of an SI rotor: `w0` in rad/s, `K_t` in N/m, `M_t` in kg, `e_t` in m; all zero for a
    #: dimensionless one.
    scales: ctypes.Array[Any]
    #: Steps a second that it paces itself to.
    rate_hz: float
    #: Advance of `tau` per step.
    dtau: float
    #: Runge-Kutta steps that make one step under the settings in force, at least 1: see `rotor.step`.
    substeps: int
    #: The leg of its profile that the speed is on, counted from 1, and how many legs there are; zeros
    #: where it follows none, or has come to the end of it.
    leg: ctypes.Array[Any]
    #: Revision of the settings: 1 at the start, up by 1 with each change.
    revision: int
    #: The first step made with them.
    applied_at_step: int
    #: Who made the last change.
    changed_by: builtins.bytes
    #: Poles under the settings in force.
    analysis: Analysis
    #: How well the process keeps its pace.
    health: Health
    #: How a controller outside does; all zero where there was none.
    control: ControlHealth
    #: What tripped the machine.
    trip: Trip
    _fields_: ClassVar = [
        ("run_id", ctypes.c_uint64),
        ("number", ctypes.c_uint64),
        ("wall_ns", ctypes.c_uint64),
        ("started_ns", ctypes.c_uint64),
        ("pid", ctypes.c_uint32),
        ("masses", ctypes.c_uint32),
        ("version", ctypes.c_char * 16),
        ("rotor_name", ctypes.c_char * 64),
        ("rotor", ctypes.c_uint64),
        ("settings", ctypes.c_uint64),
        ("scales", ctypes.c_double * 4),
        ("rate_hz", ctypes.c_double),
        ("dtau", ctypes.c_double),
        ("substeps", ctypes.c_uint32),
        ("leg", ctypes.c_uint16 * 2),
        ("revision", ctypes.c_uint64),
        ("applied_at_step", ctypes.c_uint64),
        ("changed_by", ctypes.c_char * 32),
        ("analysis", Analysis),
        ("health", Health),
        ("control", ControlHealth),
        ("trip", Trip),
    ]

    @staticmethod
    def type_name() -> str:
        """Its name on the wire."""
        return "whirl.BenchStatus"


assert ctypes.sizeof(BenchStatus) == 960


class Event(ctypes.Structure):
    """Something that has happened. `EventMessage.happening` says what; `Event` is it with the settings in
    force after it."""

    #: Which run of which process: as in the steps.
    run_id: int
    #: Number of this event in its run: 1 is the start, and each further one is up by 1.
    number: int
    #: The first step made with it; for a trip the step that tripped; for what is no order (a refusal, lost
    #: pace, the end) the next step to be made when it was noticed.
    seq: int
    #: Time of the rotor when it happened: for an order that of the step before `seq`, 0 after a restart.
    tau: float
    #: Wall clock when it was noted, nanoseconds since 1970.
    wall_ns: int
    #: Revision of the settings in force after it.
    revision: int
    #: Hash of the document of those settings.
    settings: int
    #: 1 started, 2 settings, 3 refused, 4 impulse, 5 restarted, 6 tripped, 7 late, 8 note, 9 ended, 10
    #: excited, 11 excitation over.
    kind: int
    #: Impulse: the mass, counted from 0. Refused: the kind of the request (see `RequestMessage.kind`).
    detail: int
    #: Runge-Kutta steps that make one step under `settings`, as `BenchStatusMessage.substeps`.
    substeps: int
    #: Always 0.
    reserved: int
    #: Impulse: change of velocity `[vy, vz]`.
    impulse: ctypes.Array[Any]
    #: Tripped: what tripped.
    trip: Trip
    #: Late: steps sent late, and deadlines given up, since the last such event.
    late: ctypes.Array[Any]
    #: Who did it; `sim` for what the simulation did by itself.
    who: builtins.bytes
    #: Why, in the words of who asked: `undo`, `typed`, or a reason that a person gave. May be empty.
    why: builtins.bytes
    #: Note: what it says. Refused: the reason. Excited: the tones, as in `RequestMessage.text`.
    text: builtins.bytes
    _fields_: ClassVar = [
        ("run_id", ctypes.c_uint64),
        ("number", ctypes.c_uint64),
        ("seq", ctypes.c_uint64),
        ("tau", ctypes.c_double),
        ("wall_ns", ctypes.c_uint64),
        ("revision", ctypes.c_uint64),
        ("settings", ctypes.c_uint64),
        ("kind", ctypes.c_uint32),
        ("detail", ctypes.c_uint32),
        ("substeps", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
        ("impulse", ctypes.c_double * 2),
        ("trip", Trip),
        ("late", ctypes.c_uint64 * 2),
        ("who", ctypes.c_char * 32),
        ("why", ctypes.c_char * 120),
        ("text", ctypes.c_char * 240),
    ]

    @staticmethod
    def type_name() -> str:
        """Its name on the wire."""
        return "whirl.Event"


assert ctypes.sizeof(Event) == 528


class Request(ctypes.Structure):
    """A change that a reader asks for. The document of the settings that it names comes with it; `Request` is
    both."""

    #: 1 settings, 2 impulse, 3 restart, 4 note, 5 excitation of the loop's command, 6 end of it.
    kind: int
    #: Impulse: the mass, counted from 0.
    mass: int
    #: Settings: the revision they are based on; refused if it is no longer in force.
    base_revision: int
    #: Settings: hash of the document of the new ones.
    settings: int
    #: Impulse: change of velocity `[vy, vz]`.
    impulse: ctypes.Array[Any]
    #: Who asks.
    who: builtins.bytes
    #: Why, as it shall stand in the log: `undo`, `typed`, a reason that a person gave; may be empty.
    why: builtins.bytes
    #: Note: what it says. Excitation: its tones, such as `seed=1 period=50.0 lines=1..40 tones=20
    #: away_from=2.5 amplitude=0.125 duration=250.0`: amplitude and a random phase each on multiples of 2 pi /
    #: period, of both signs, away from the spin speed by two.
    text: builtins.bytes
    _fields_: ClassVar = [
        ("kind", ctypes.c_uint32),
        ("mass", ctypes.c_uint32),
        ("base_revision", ctypes.c_uint64),
        ("settings", ctypes.c_uint64),
        ("impulse", ctypes.c_double * 2),
        ("who", ctypes.c_char * 32),
        ("why", ctypes.c_char * 120),
        ("text", ctypes.c_char * 240),
    ]

    @staticmethod
    def type_name() -> str:
        """Its name on the wire."""
        return "whirl.Request"


assert ctypes.sizeof(Request) == 432


class Answer(ctypes.Structure):
    """What became of a request."""

    #: 1 accepted, 0 refused.
    accepted: int
    #: 1 if it was refused because the settings had changed meanwhile: look again and ask again.
    outdated: int
    #: Runge-Kutta steps that make one step, as `BenchStatusMessage.substeps`, now and before the request.
    substeps: ctypes.Array[Any]
    #: The revision now in force.
    revision: int
    #: Hash of the document of the settings now in force.
    settings: int
    #: Accepted: the first step made with the change.
    applied_at_step: int
    #: Accepted: time of the rotor when it took effect, as in `EventMessage.tau`.
    tau: float
    #: Refused: why.
    reason: builtins.bytes
    _fields_: ClassVar = [
        ("accepted", ctypes.c_uint32),
        ("outdated", ctypes.c_uint32),
        ("substeps", ctypes.c_uint32 * 2),
        ("revision", ctypes.c_uint64),
        ("settings", ctypes.c_uint64),
        ("applied_at_step", ctypes.c_uint64),
        ("tau", ctypes.c_double),
        ("reason", ctypes.c_char * 240),
    ]

    @staticmethod
    def type_name() -> str:
        """Its name on the wire."""
        return "whirl.Answer"


assert ctypes.sizeof(Answer) == 288


class RecorderStatus(ctypes.Structure):
    """How a recorder stands. It sends this at least once a second; the latest reaches readers that come
    later."""

    #: Which run it records: as in the steps.
    run_id: int
    #: Wall clock when this was sent, nanoseconds since 1970.
    wall_ns: int
    #: Wall clock when it began, nanoseconds since 1970.
    started_ns: int
    #: Bytes written, all parts together.
    bytes: int
    #: Steps written.
    rows: int
    #: Steps that were sent and did not reach the file.
    lost: int
    #: 1 recording, 2 stopped in good order, 3 failed, 4 died. A recorder sends 1 to 3; readers make 4 of a
    #: 1 whose process has gone.
    state: int
    #: The part that is being written, counted from 1, when a recording is split.
    part: int
    #: 0 keeps everything, 1 keeps the last `window_s` seconds, 2 holds them in memory and writes on a
    #: trip.
    mode: int
    #: Process id of the recorder.
    pid: int
    #: Modes 1 and 2: how many seconds; else 0.
    window_s: float
    #: The file.
    path: builtins.bytes
    #: Failed: why.
    error: builtins.bytes
    _fields_: ClassVar = [
        ("run_id", ctypes.c_uint64),
        ("wall_ns", ctypes.c_uint64),
        ("started_ns", ctypes.c_uint64),
        ("bytes", ctypes.c_uint64),
        ("rows", ctypes.c_uint64),
        ("lost", ctypes.c_uint64),
        ("state", ctypes.c_uint32),
        ("part", ctypes.c_uint32),
        ("mode", ctypes.c_uint32),
        ("pid", ctypes.c_uint32),
        ("window_s", ctypes.c_double),
        ("path", ctypes.c_char * 1024),
        ("error", ctypes.c_char * 240),
    ]

    @staticmethod
    def type_name() -> str:
        """Its name on the wire."""
        return "whirl.RecorderStatus"


assert ctypes.sizeof(RecorderStatus) == 1336


class SnapshotHead(ctypes.Structure):
    """What stands before the words of a snapshot."""

    #: Which run of which process: as in the steps.
    run_id: int
    #: The step that the machine makes next: the state is that before it, with all that was done to the
    #: machine in between.
    seq: int
    #: Revision of the settings that this step is made with.
    revision: int
    #: Time of the rotor.
    tau: float
    _fields_: ClassVar = [
        ("run_id", ctypes.c_uint64),
        ("seq", ctypes.c_uint64),
        ("revision", ctypes.c_uint64),
        ("tau", ctypes.c_double),
    ]

    @staticmethod
    def type_name() -> str:
        """Its name on the wire."""
        return "whirl.SnapshotHead"


assert ctypes.sizeof(SnapshotHead) == 32


class Readings(ctypes.Structure):
    """What a controller outside is given: what the sensors read before a step with which a sample is due."""

    #: Which run of which process: as in the steps.
    run_id: int
    #: Number of these readings in their run: up by 1 with every sample. The command that answers them has
    #: it.
    number: int
    #: The step that the machine makes next.
    seq: int
    #: Wall clock when they were sent, nanoseconds since 1970.
    wall_ns: int
    #: Wall clock by which their command must be there to act in time, nanoseconds since 1970; 0 where the
    #: machine waits for it.
    deadline_ns: int
    #: Time of the rotor.
    tau: float
    #: Spin angle in radians, unwrapped.
    angle: float
    #: Spin speed R.
    speed: float
    #: How many masses there are.
    masses: int
    #: How many control bearings there are.
    bearings: int
    #: 1 if the machine waits for the command (lockstep), 0 in real time.
    lockstep: int
    #: 1 if commands from outside act, 0 while the law of the bench does.
    acting: int
    #: The newest readings that were answered.
    answered: int
    #: Commands that came after their deadline, since the start.
    late: int
    #: Samples whose command was not there at its deadline, since the start.
    missed: int
    #: Commands that were not taken, because they were not finite, since the start.
    refused: int
    #: Of every mass [y, z, vy, vz] as the sensors of the first control bearing read them, in e_t and w0
    #: e_t; zeros after the last.
    readings: ctypes.Array[Any]
    _fields_: ClassVar = [
        ("run_id", ctypes.c_uint64),
        ("number", ctypes.c_uint64),
        ("seq", ctypes.c_uint64),
        ("wall_ns", ctypes.c_uint64),
        ("deadline_ns", ctypes.c_uint64),
        ("tau", ctypes.c_double),
        ("angle", ctypes.c_double),
        ("speed", ctypes.c_double),
        ("masses", ctypes.c_uint32),
        ("bearings", ctypes.c_uint32),
        ("lockstep", ctypes.c_uint32),
        ("acting", ctypes.c_uint32),
        ("answered", ctypes.c_uint64),
        ("late", ctypes.c_uint64),
        ("missed", ctypes.c_uint64),
        ("refused", ctypes.c_uint64),
        ("readings", ctypes.c_double * 4 * 16),
    ]

    @staticmethod
    def type_name() -> str:
        """Its name on the wire."""
        return "whirl.Readings"


assert ctypes.sizeof(Readings) == 624


class ControlCommand(ctypes.Structure):
    """What a controller outside sends back."""

    #: The run_id of the readings.
    run_id: int
    #: The number of the readings that it answers.
    number: int
    #: Wall clock when it was sent, nanoseconds since 1970; 0 if it is not told.
    wall_ns: int
    #: Control [uy, uz] at every control bearing, in w0^2 e_t; what is after the last is not looked at.
    command: ctypes.Array[Any]
    _fields_: ClassVar = [
        ("run_id", ctypes.c_uint64),
        ("number", ctypes.c_uint64),
        ("wall_ns", ctypes.c_uint64),
        ("command", ctypes.c_double * 2 * 8),
    ]

    @staticmethod
    def type_name() -> str:
        """Its name on the wire."""
        return "whirl.ControlCommand"


assert ctypes.sizeof(ControlCommand) == 152
