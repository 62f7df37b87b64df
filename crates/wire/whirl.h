/* The messages of a whirl bench, for C and C++. Made of the tables of the crate wire; not to be edited.
   Dimensionless units of the model throughout: displacement in e_t, time tau = w0 t, velocity in w0 e_t, control in
   w0^2 e_t. The services are those of iceoryx2, called whirl/NAME/state and so on; the schema is their attribute
   whirl.schema. Texts are UTF-8, padded with zeros, and have no zero at the end where they fill their place. */
#ifndef WHIRL_H
#define WHIRL_H

#include <stdint.h>
#include <string.h>

#define WHIRL_SCHEMA 5 /* version of all messages together */
#define WHIRL_MAX_MASSES 16 /* masses of the largest rotor */
#define WHIRL_MAX_BEARINGS 8 /* control bearings of the largest machine */
#define WHIRL_MAX_BURST 32 /* steps of the largest message of whirl/NAME/state */
#define WHIRL_EVENTS_KEPT 64 /* events that reach readers that come late */
#define WHIRL_DOCUMENTS_KEPT 96 /* documents that reach readers that come late */
#define WHIRL_MAX_DOCUMENT 65536 /* bytes of the largest document */
#define WHIRL_MAX_SNAPSHOT 32768 /* words of the largest snapshot */

/* whirl/NAME/state carries slices of 64-bit words: rows of WHIRL_WIDTH words, one after the other, one row a step,
   up to WHIRL_MAX_BURST. Each row says itself how many masses, sensors and control bearings it has. Below are the
   places of its words; masses and sensors are counted from 0, and so are control bearings after the first. Doubles
   are read with whirl_number. */
#define WHIRL_RUN_ID 0 /* uint64_t: which run of which process: changes when the simulation starts anew */
#define WHIRL_SEQ 1 /* uint64_t: number of the step since the process started: up by 1 each, also while tripped */
#define WHIRL_WALL_NS 2 /* uint64_t: wall clock when the step was due to be sent, nanoseconds since 1970 */
#define WHIRL_REVISION 3 /* uint64_t: revision of the settings that the step was made with */
#define WHIRL_FLAGS 4 /* uint64_t: bits 0 to 31: what is special; 32 to 47: how many masses; 48 to 55: how many sensors; 56 to 63: how many control bearings after the first */
#define WHIRL_TAU 5 /* double, 1/w0: time since the rotor was last at rest; stands still while the machine is held after a trip */
#define WHIRL_ANGLE 6 /* double, rad: spin angle, unwrapped: the unbalance points along it */
#define WHIRL_SPEED 7 /* double, w0: spin speed R */
#define WHIRL_SPEED_RATE 8 /* double, w0^2: rate of change of the spin speed */
#define WHIRL_UY_COMMANDED 9 /* double, w0^2 e_t: control that the feedback asks for at the first control bearing, y */
#define WHIRL_UZ_COMMANDED 10 /* double, w0^2 e_t: control that the feedback asks for at the first control bearing, z */
#define WHIRL_UY 11 /* double, w0^2 e_t: control that the first control bearing delivers, y */
#define WHIRL_UZ 12 /* double, w0^2 e_t: control that the first control bearing delivers, z */
#define WHIRL_Y(mass) (13 + 4 * (mass) + 0) /* double, e_t: displacement, y */
#define WHIRL_Z(mass) (13 + 4 * (mass) + 1) /* double, e_t: displacement, z */
#define WHIRL_VY(mass) (13 + 4 * (mass) + 2) /* double, w0 e_t: velocity, y */
#define WHIRL_VZ(mass) (13 + 4 * (mass) + 3) /* double, w0 e_t: velocity, z */
#define WHIRL_READING_Y(masses, sensor) (13 + 4 * (masses) + 2 * (sensor) + 0) /* double, e_t: displacement as the loop reads it, y */
#define WHIRL_READING_Z(masses, sensor) (13 + 4 * (masses) + 2 * (sensor) + 1) /* double, e_t: displacement as the loop reads it, z */
#define WHIRL_BEARING_UY_COMMANDED(masses, sensors, further) (13 + 4 * (masses) + 2 * (sensors) + 4 * (further) + 0) /* double, w0^2 e_t: control that the feedback asks for, y */
#define WHIRL_BEARING_UZ_COMMANDED(masses, sensors, further) (13 + 4 * (masses) + 2 * (sensors) + 4 * (further) + 1) /* double, w0^2 e_t: control that the feedback asks for, z */
#define WHIRL_BEARING_UY(masses, sensors, further) (13 + 4 * (masses) + 2 * (sensors) + 4 * (further) + 2) /* double, w0^2 e_t: control that the bearing delivers, y */
#define WHIRL_BEARING_UZ(masses, sensors, further) (13 + 4 * (masses) + 2 * (sensors) + 4 * (further) + 3) /* double, w0^2 e_t: control that the bearing delivers, z */

#define WHIRL_WIDTH(masses, sensors, further) (13 + 4 * (masses) + 2 * (sensors) + 4 * (further))
#define WHIRL_MASSES(row) ((unsigned)((row)[WHIRL_FLAGS] >> 32 & 0xffff))
#define WHIRL_SENSORS(row) ((unsigned)((row)[WHIRL_FLAGS] >> 48 & 0xff))
/* Control bearings after the first. */
#define WHIRL_FURTHER(row) ((unsigned)((row)[WHIRL_FLAGS] >> 56))

/* Bit m of the flags is set while mass m presses on its bearing. */
#define WHIRL_SATURATED UINT32_C(0x10000) /* the control bearing is at its limit */
#define WHIRL_TRIPPED UINT32_C(0x20000) /* the machine has tripped: the rotor is held where it was, or coasts down */
#define WHIRL_LATE UINT32_C(0x40000) /* the step was sent more than one period of wake-ups (of a step, or of all steps that share one) after it was due */
#define WHIRL_EXTERNAL UINT32_C(0x80000) /* the command comes from a controller outside */
#define WHIRL_HELD UINT32_C(0x100000) /* a command from outside that should be there is not: the last one is held */
#define WHIRL_COASTING UINT32_C(0x200000) /* beside TRIPPED: not held, the speed coasts down to rest and the rotor goes on moving */

/* The double whose bits a word is. */
static inline double whirl_number(uint64_t word) {
    double number;
    memcpy(&number, &word, sizeof number);
    return number;
}

/* The poles of the linear rotor, deadband neglected. */
struct whirl_analysis { /* 544 bytes, whirl.Analysis */
    /* 0: The revision of the settings that it is for; 0 while there is none. */
    uint64_t revision;
    /* 8: How many of poles are used: all, or the 32 least damped; 0 if there are none, as with unequal amplifiers
       or too long a delay. */
    uint32_t count;
    /* 12: Always 0. */
    uint32_t reserved;
    /* 16: Spin speed R that it is for: while that changes, the one of some tenth of a second ago. */
    double speed;
    /* 24: The smallest damping ratio of the modes that count (of shaft elements not the fastest, as long as they
       decay); 0 if there are no poles. */
    double min_damping;
    /* 32: The poles re, im, least damped first. */
    double poles[32][2];
};

/* How well the simulation keeps its pace. Counts are since the process started; percentiles too. */
struct whirl_health { /* 72 bytes, whirl.Health */
    /* 0: Steps sent. */
    uint64_t steps;
    /* 8: Steps sent more than one period of wake-ups (of a step, or of all steps that share one) after they were
       due. */
    uint64_t late;
    /* 16: Deadlines given up because the process was too far behind to catch up. */
    uint64_t missed;
    /* 24: How long after its deadline a wake-up came, microseconds: median. */
    double lateness_p50_us;
    /* 32: The same, 99th percentile. */
    double lateness_p99_us;
    /* 40: The same, the worst. */
    double lateness_max_us;
    /* 48: What a step costs (step, fill and send), microseconds: median. */
    double cost_p50_us;
    /* 56: The same, 99th percentile. */
    double cost_p99_us;
    /* 64: How many readers of the state there are. */
    uint32_t subscribers;
    /* 68: Always 0. */
    uint32_t reserved;
};

/* How a controller outside does. Counts are since the process started; percentiles too. */
struct whirl_control_health { /* 72 bytes, whirl.ControlHealth */
    /* 0: Commands that were taken. */
    uint64_t taken;
    /* 8: Of these, commands that came after their deadline. */
    uint64_t late;
    /* 16: Samples whose command was not there at its deadline. */
    uint64_t missed;
    /* 24: Commands that were not taken, because they were not finite. */
    uint64_t refused;
    /* 32: How often commands from outside came to act. */
    uint64_t took_over;
    /* 40: How often the law of the bench had to take over. */
    uint64_t lost;
    /* 48: How long after its readings a command was sent, by its own time stamp, microseconds: median; 0 where none
       has one. */
    double age_p50_us;
    /* 56: The same, 99th percentile. */
    double age_p99_us;
    /* 64: 1 if commands from outside act, 0 while the law of the bench does. */
    uint32_t acting;
    /* 68: Always 0. */
    uint32_t reserved;
};

/* What tripped the machine; all zero while it runs. */
struct whirl_trip { /* 32 bytes, whirl.Trip */
    /* 0: 0 running, 1 an orbit grew past the limit, 2 the motion left the range of numbers, 3 no command came from
       outside, 4 an orbit grew past the limit, and the speed coasts down. */
    uint32_t cause;
    /* 4: The mass with the largest orbit, counted from 1. */
    uint32_t mass;
    /* 8: The step at which it happened. */
    uint64_t step;
    /* 16: Its radius then, in e_t; the last finite one. */
    double radius;
    /* 24: The limit then in force, in e_t. */
    double limit;
};

/* What stands before the text of a document. */
struct whirl_document_head { /* 16 bytes, whirl.DocumentHead */
    /* 0: Its name: FNV-1a, 64 bits, of the text. */
    uint64_t hash;
    /* 8: 1 a rotor, 2 settings. */
    uint32_t kind;
    /* 12: Always 0. */
    uint32_t reserved;
};

/* The whole slow picture of a bench in one message, so that its parts always fit together. BenchStatus is it with
   the documents that it names. */
struct whirl_bench_status { /* 960 bytes, whirl.BenchStatus */
    /* 0: Which run of which process: as in the steps. */
    uint64_t run_id;
    /* 8: Number of this bench status in its run: rises by 1. */
    uint64_t number;
    /* 16: Wall clock when it was made, nanoseconds since 1970. */
    uint64_t wall_ns;
    /* 24: Wall clock when the process started, nanoseconds since 1970. */
    uint64_t started_ns;
    /* 32: Process id of the simulation. */
    uint32_t pid;
    /* 36: How many masses the rotor has, and sensors: what a step's words are laid out for in this run. */
    uint32_t masses;
    /* 40: Version of the program that simulates. */
    char version[16];
    /* 56: The rotor's name. */
    char rotor_name[64];
    /* 120: Hash of the rotor's document. */
    uint64_t rotor;
    /* 128: Hash of the document of the settings in force. */
    uint64_t settings;
    /* 136: Scales of an SI rotor: w0 in rad/s, K_t in N/m, M_t in kg, e_t in m; all zero for a dimensionless one. */
    double scales[4];
    /* 168: Steps a second that it paces itself to. */
    double rate_hz;
    /* 176: Advance of tau per step. */
    double dtau;
    /* 184: Runge-Kutta steps that make one step under the settings in force, at least 1: see rotor::step. */
    uint32_t substeps;
    /* 188: The leg of its profile that the speed is on, counted from 1, and how many legs there are; zeros where it
       follows none, or has come to the end of it. */
    uint16_t leg[2];
    /* 192: Revision of the settings: 1 at the start, up by 1 with each change. */
    uint64_t revision;
    /* 200: The first step made with them. */
    uint64_t applied_at_step;
    /* 208: Who made the last change. */
    char changed_by[32];
    /* 240: Poles under the settings in force. */
    struct whirl_analysis analysis;
    /* 784: How well the process keeps its pace. */
    struct whirl_health health;
    /* 856: How a controller outside does; all zero where there was none. */
    struct whirl_control_health control;
    /* 928: What tripped the machine. */
    struct whirl_trip trip;
};

/* Something that has happened. EventMessage::happening says what; Event is it with the settings in force after it. */
struct whirl_event { /* 528 bytes, whirl.Event */
    /* 0: Which run of which process: as in the steps. */
    uint64_t run_id;
    /* 8: Number of this event in its run: 1 is the start, and each further one is up by 1. */
    uint64_t number;
    /* 16: The first step made with it; for a trip the step that tripped; for what is no order (a refusal, lost
       pace, the end) the next step to be made when it was noticed. */
    uint64_t seq;
    /* 24: Time of the rotor when it happened: for an order that of the step before seq, 0 after a restart. */
    double tau;
    /* 32: Wall clock when it was noted, nanoseconds since 1970. */
    uint64_t wall_ns;
    /* 40: Revision of the settings in force after it. */
    uint64_t revision;
    /* 48: Hash of the document of those settings. */
    uint64_t settings;
    /* 56: 1 started, 2 settings, 3 refused, 4 impulse, 5 restarted, 6 tripped, 7 late, 8 note, 9 ended, 10 excited,
       11 excitation over. */
    uint32_t kind;
    /* 60: Impulse: the mass, counted from 0. Refused: the kind of the request (see message::RequestMessage::kind). */
    uint32_t detail;
    /* 64: Runge-Kutta steps that make one step under settings, as message::BenchStatusMessage::substeps. */
    uint32_t substeps;
    /* 68: Always 0. */
    uint32_t reserved;
    /* 72: Impulse: change of velocity vy, vz. */
    double impulse[2];
    /* 88: Tripped: what tripped. */
    struct whirl_trip trip;
    /* 120: Late: steps sent late, and deadlines given up, since the last such event. */
    uint64_t late[2];
    /* 136: Who did it; sim for what the simulation did by itself. */
    char who[32];
    /* 168: Why, in the words of who asked: undo, typed, or a reason that a person gave. May be empty. */
    char why[120];
    /* 288: Note: what it says. Refused: the reason. Excited: the tones, as in message::RequestMessage::text. */
    char text[240];
};

/* A change that a reader asks for. The document of the settings that it names comes with it; Request is both. */
struct whirl_request { /* 432 bytes, whirl.Request */
    /* 0: 1 settings, 2 impulse, 3 restart, 4 note, 5 excitation of the loop's command, 6 end of it. */
    uint32_t kind;
    /* 4: Impulse: the mass, counted from 0. */
    uint32_t mass;
    /* 8: Settings: the revision they are based on; refused if it is no longer in force. */
    uint64_t base_revision;
    /* 16: Settings: hash of the document of the new ones. */
    uint64_t settings;
    /* 24: Impulse: change of velocity vy, vz. */
    double impulse[2];
    /* 40: Who asks. */
    char who[32];
    /* 72: Why, as it shall stand in the log: undo, typed, a reason that a person gave; may be empty. */
    char why[120];
    /* 192: Note: what it says. Excitation: its tones, such as seed=1 period=50.0 lines=1..40 tones=20 away_from=2.5
       amplitude=0.125 duration=250.0: amplitude and a random phase each on multiples of 2 pi / period, of both
       signs, away from the spin speed by two. */
    char text[240];
};

/* What became of a request. */
struct whirl_answer { /* 288 bytes, whirl.Answer */
    /* 0: 1 accepted, 0 refused. */
    uint32_t accepted;
    /* 4: 1 if it was refused because the settings had changed meanwhile: look again and ask again. */
    uint32_t outdated;
    /* 8: Runge-Kutta steps that make one step, as BenchStatusMessage::substeps, now and before the request. */
    uint32_t substeps[2];
    /* 16: The revision now in force. */
    uint64_t revision;
    /* 24: Hash of the document of the settings now in force. */
    uint64_t settings;
    /* 32: Accepted: the first step made with the change. */
    uint64_t applied_at_step;
    /* 40: Accepted: time of the rotor when it took effect, as in EventMessage::tau. */
    double tau;
    /* 48: Refused: why. */
    char reason[240];
};

/* How a recorder stands. It sends this at least once a second; the latest reaches readers that come later. */
struct whirl_recorder_status { /* 1336 bytes, whirl.RecorderStatus */
    /* 0: Which run it records: as in the steps. */
    uint64_t run_id;
    /* 8: Wall clock when this was sent, nanoseconds since 1970. */
    uint64_t wall_ns;
    /* 16: Wall clock when it began, nanoseconds since 1970. */
    uint64_t started_ns;
    /* 24: Bytes written, all parts together. */
    uint64_t bytes;
    /* 32: Steps written. */
    uint64_t rows;
    /* 40: Steps that were sent and did not reach the file. */
    uint64_t lost;
    /* 48: 1 recording, 2 stopped in good order, 3 failed, 4 died. A recorder sends 1 to 3; readers make 4 of a 1
       whose process has gone. */
    uint32_t state;
    /* 52: The part that is being written, counted from 1, when a recording is split. */
    uint32_t part;
    /* 56: 0 keeps everything, 1 keeps the last window_s seconds, 2 holds them in memory and writes on a trip. */
    uint32_t mode;
    /* 60: Process id of the recorder. */
    uint32_t pid;
    /* 64: Modes 1 and 2: how many seconds; else 0. */
    double window_s;
    /* 72: The file. */
    char path[1024];
    /* 1096: Failed: why. */
    char error[240];
};

/* What stands before the words of a snapshot. */
struct whirl_snapshot_head { /* 32 bytes, whirl.SnapshotHead */
    /* 0: Which run of which process: as in the steps. */
    uint64_t run_id;
    /* 8: The step that the machine makes next: the state is that before it, with all that was done to the machine
       in between. */
    uint64_t seq;
    /* 16: Revision of the settings that this step is made with. */
    uint64_t revision;
    /* 24: Time of the rotor. */
    double tau;
};

/* What a controller outside is given: what the sensors read before a step with which a sample is due. */
struct whirl_readings { /* 624 bytes, whirl.Readings */
    /* 0: Which run of which process: as in the steps. */
    uint64_t run_id;
    /* 8: Number of these readings in their run: up by 1 with every sample. The command that answers them has it. */
    uint64_t number;
    /* 16: The step that the machine makes next. */
    uint64_t seq;
    /* 24: Wall clock when they were sent, nanoseconds since 1970. */
    uint64_t wall_ns;
    /* 32: Wall clock by which their command must be there to act in time, nanoseconds since 1970; 0 where the
       machine waits for it. */
    uint64_t deadline_ns;
    /* 40: Time of the rotor. */
    double tau;
    /* 48: Spin angle in radians, unwrapped. */
    double angle;
    /* 56: Spin speed R. */
    double speed;
    /* 64: How many masses there are. */
    uint32_t masses;
    /* 68: How many control bearings there are. */
    uint32_t bearings;
    /* 72: 1 if the machine waits for the command (lockstep), 0 in real time. */
    uint32_t lockstep;
    /* 76: 1 if commands from outside act, 0 while the law of the bench does. */
    uint32_t acting;
    /* 80: The newest readings that were answered. */
    uint64_t answered;
    /* 88: Commands that came after their deadline, since the start. */
    uint64_t late;
    /* 96: Samples whose command was not there at its deadline, since the start. */
    uint64_t missed;
    /* 104: Commands that were not taken, because they were not finite, since the start. */
    uint64_t refused;
    /* 112: Of every mass y, z, vy, vz as the sensors of the first control bearing read them, in e_t and w0 e_t;
       zeros after the last. */
    double readings[16][4];
};

/* What a controller outside sends back. */
struct whirl_control_command { /* 152 bytes, whirl.ControlCommand */
    /* 0: The run_id of the readings. */
    uint64_t run_id;
    /* 8: The number of the readings that it answers. */
    uint64_t number;
    /* 16: Wall clock when it was sent, nanoseconds since 1970; 0 if it is not told. */
    uint64_t wall_ns;
    /* 24: Control uy, uz at every control bearing, in w0^2 e_t; what is after the last is not looked at. */
    double command[8][2];
};

#endif
