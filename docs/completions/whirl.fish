# Print an optspec for argparse to handle cmd's options that are independent of any subcommand.
function __fish_whirl_global_optspecs
    string join \n h/help V/version
end

function __fish_whirl_needs_command
    # Figure out if the current invocation already has a command.
    set -l cmd (commandline -opc)
    set -e cmd[1]
    argparse -s (__fish_whirl_global_optspecs) -- $cmd 2>/dev/null
    or return
    if set -q argv[1]
        # Also print the command, so this can be used to figure out what it is.
        echo $argv[1]
        return 1
    end
    return 0
end

function __fish_whirl_using_subcommand
    set -l cmd (__fish_whirl_needs_command)
    test -z "$cmd"
    and return 1
    contains -- $cmd[1] $argv
end

complete -c whirl -n "__fish_whirl_needs_command" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c whirl -n "__fish_whirl_needs_command" -s V -l version -d 'Print version'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "up" -d 'Start a simulation and a dashboard on it; quitting the dashboard ends both'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "sim" -d 'Run the simulation process alone'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "dash" -d 'Show a dashboard on a running simulation'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "record" -d 'Record a running simulation in a file, every step'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "replay" -d 'Play a recording in the dashboard, and run on from any moment of it with other gains'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "info" -d 'Tell what a recording holds: length, rates, changes, losses, trips, alarms, extremes'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "export" -d 'Make a table of a recording, as CSV or Parquet'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "tail" -d 'Print live telemetry, or what happens'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "layout" -d 'List the layouts of the dashboard, show one as a file, or check files'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "config" -d 'Say where the configuration is, what it says, and what holds without one'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "set" -d 'Change gains, speed, deadband ... of a running simulation'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "drill" -d 'Hold a drill: one fault at a time on a running simulation, and back'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "note" -d 'Mark the present step of a running simulation with a note'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "status" -d 'List running benches: rates, lateness, losses, who is attached'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "control" -d 'Let any program control a running simulation, by its standard input and output'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "wire" -d 'Say how another program finds and reads a bench: root, services, types, units'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "clean" -d 'Remove what crashed processes left behind; never touches a live bench'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "poles" -d 'Print eigenvalues and minimum damping at one speed'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "trace" -d 'Print every pole as a branch over speed, or the Campbell diagram'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "thresholds" -d 'Print every speed at which a mode changes stability'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "modes" -d 'Print mode shapes and orbits at one speed'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "margin" -d 'Print margins of delay, gain and phase, and peaks of sensitivity'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "measure" -d 'Measure the sensitivity of a running simulation\'s loop, beside the computed one'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "bode" -d 'Print frequency responses, and the response to unbalance'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "assess" -d 'Print what standards ask of a machine, line by line: found, asked, passed or not'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "run" -d 'Simulate offline, as fast as it can'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "runup" -d 'Run up or coast down through the critical speeds, offline'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "force" -d 'Print the largest steady control force over speed'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "response" -d 'Print the exact synchronous response, branch by branch'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "cycles" -d 'Print the exact self-excited limit cycles, branch by branch'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "map" -d 'Map a quantity over a plane of two parameters: damping, margins, orbits, forces'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "sweep" -d 'Cut maps, samples or searches into shards for schedulers, and gather them'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "tune" -d 'Search the gains that damp the worst mode best, over speeds and deadband states'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "report" -d 'Make the NASA report again: every figure, and every printed number beside ours'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "assign" -d 'Make feedback that assigns poles, or show which modes each bearing and sensor reaches'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "rotor" -d 'List the built-in rotors, show one as a file, or check files'
complete -c whirl -n "__fish_whirl_needs_command" -f -a "help" -d 'Show a page of the book, or what a command takes'
complete -c whirl -n "__fish_whirl_using_subcommand up" -l feedback -d 'The feedback: off; cancel (jeffcott); composite, individual (three-mass); own (magnetic bearings of a drawing, the default there); or a TOML file' -r
complete -c whirl -n "__fish_whirl_using_subcommand up" -l deadband -d 'Clearance of every support bearing, in e_t (SI rotors: in m)' -r
complete -c whirl -n "__fish_whirl_using_subcommand up" -l set -d 'Any other setting, such as delay=0.02 or deadband.2=0.5; `off` takes a part of the loop out (repeatable)' -r
complete -c whirl -n "__fish_whirl_using_subcommand up" -l bench -d 'Name of the bench' -r
complete -c whirl -n "__fish_whirl_using_subcommand up" -l speed -d 'Spin speed R = w / w0 at the start (SI rotors: in rpm) [default: R = 2.5]' -r
complete -c whirl -n "__fish_whirl_using_subcommand up" -l profile -d 'Legs of speed from a file, from the start on, until somebody sets `speed` or `ramp`' -r
complete -c whirl -n "__fish_whirl_using_subcommand up" -l rate -d 'Steps a second, also as 2kHz' -r
complete -c whirl -n "__fish_whirl_using_subcommand up" -l dtau -d 'Advance of tau = w0 t per step (of an SI rotor also 20us); it is made in as many substeps as keep numbers within 1e-4' -r
complete -c whirl -n "__fish_whirl_using_subcommand up" -l trip -d 'Orbit radius at which the machine trips, in e_t (SI rotors: in m) [default: 1000 e_t]' -r
complete -c whirl -n "__fish_whirl_using_subcommand up" -l coast-down -d 'Coast down after a trip, at first at this rate, in R per tau (SI rotors: rpm/s) [default: hold the machine where it is]' -r
complete -c whirl -n "__fish_whirl_using_subcommand up" -l history -d 'Megabytes that the steps kept for looking back may take' -r
complete -c whirl -n "__fish_whirl_using_subcommand up" -l layout -d 'The layout to start with: a name (`whirl layout list`), or a TOML file' -r
complete -c whirl -n "__fish_whirl_using_subcommand up" -l theme -d 'Colours: default (the terminal\'s own sixteen), full, contrast or colour-blind' -r
complete -c whirl -n "__fish_whirl_using_subcommand up" -l fps -d 'Frames a second at most; fewer where the line to the terminal is slow' -r
complete -c whirl -n "__fish_whirl_using_subcommand up" -l record -d 'Record the session in FILE.rrd, by a process of its own' -r -F
complete -c whirl -n "__fish_whirl_using_subcommand up" -l ascii -d 'Show nothing but ASCII, whatever the locale says'
complete -c whirl -n "__fish_whirl_using_subcommand up" -l read-only -d 'Only look: change nothing'
complete -c whirl -n "__fish_whirl_using_subcommand up" -l locked -d 'Begin with the machine locked against keys: ctrl-l unlocks it'
complete -c whirl -n "__fish_whirl_using_subcommand up" -l force -d 'Replace a file that is there already'
complete -c whirl -n "__fish_whirl_using_subcommand up" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand sim" -l feedback -d 'The feedback: off; cancel (jeffcott); composite, individual (three-mass); own (magnetic bearings of a drawing, the default there); or a TOML file' -r
complete -c whirl -n "__fish_whirl_using_subcommand sim" -l deadband -d 'Clearance of every support bearing, in e_t (SI rotors: in m)' -r
complete -c whirl -n "__fish_whirl_using_subcommand sim" -l set -d 'Any other setting, such as delay=0.02 or deadband.2=0.5; `off` takes a part of the loop out (repeatable)' -r
complete -c whirl -n "__fish_whirl_using_subcommand sim" -l bench -d 'Name of the bench' -r
complete -c whirl -n "__fish_whirl_using_subcommand sim" -l speed -d 'Spin speed R = w / w0 at the start (SI rotors: in rpm) [default: R = 2.5]' -r
complete -c whirl -n "__fish_whirl_using_subcommand sim" -l profile -d 'Legs of speed from a file, from the start on, until somebody sets `speed` or `ramp`' -r
complete -c whirl -n "__fish_whirl_using_subcommand sim" -l rate -d 'Steps a second, also as 2kHz' -r
complete -c whirl -n "__fish_whirl_using_subcommand sim" -l dtau -d 'Advance of tau = w0 t per step (of an SI rotor also 20us); it is made in as many substeps as keep numbers within 1e-4' -r
complete -c whirl -n "__fish_whirl_using_subcommand sim" -l trip -d 'Orbit radius at which the machine trips, in e_t (SI rotors: in m) [default: 1000 e_t]' -r
complete -c whirl -n "__fish_whirl_using_subcommand sim" -l coast-down -d 'Coast down after a trip, at first at this rate, in R per tau (SI rotors: rpm/s) [default: hold the machine where it is]' -r
complete -c whirl -n "__fish_whirl_using_subcommand sim" -l lockstep -d 'Not in real time: wait at every sample for the command of a controller outside (`external`), and go as fast as that, bit for bit repeatable'
complete -c whirl -n "__fish_whirl_using_subcommand sim" -l as-child -d 'Serve a parent process: say `ready` once the bench is ours, and end when standard input closes, as it does when the parent dies'
complete -c whirl -n "__fish_whirl_using_subcommand sim" -l when-told -d 'Make no step before the parent has said something'
complete -c whirl -n "__fish_whirl_using_subcommand sim" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand dash" -l bench -d 'Name of the bench' -r
complete -c whirl -n "__fish_whirl_using_subcommand dash" -l history -d 'Megabytes that the steps kept for looking back may take' -r
complete -c whirl -n "__fish_whirl_using_subcommand dash" -l layout -d 'The layout to start with: a name (`whirl layout list`), or a TOML file' -r
complete -c whirl -n "__fish_whirl_using_subcommand dash" -l theme -d 'Colours: default (the terminal\'s own sixteen), full, contrast or colour-blind' -r
complete -c whirl -n "__fish_whirl_using_subcommand dash" -l fps -d 'Frames a second at most; fewer where the line to the terminal is slow' -r
complete -c whirl -n "__fish_whirl_using_subcommand dash" -l picture -d 'Take a picture of the screen, SVG or plain text, instead of showing it' -r -F
complete -c whirl -n "__fish_whirl_using_subcommand dash" -l size -d 'The size of that screen in cells' -r
complete -c whirl -n "__fish_whirl_using_subcommand dash" -l after -d 'Seconds to listen before the picture is taken' -r
complete -c whirl -n "__fish_whirl_using_subcommand dash" -l press -d 'Keys to press before it is taken: letters, names in brackets as <enter> or <ctrl-r>, and <3s> to wait' -r
complete -c whirl -n "__fish_whirl_using_subcommand dash" -l ascii -d 'Show nothing but ASCII, whatever the locale says'
complete -c whirl -n "__fish_whirl_using_subcommand dash" -l read-only -d 'Only look: change nothing'
complete -c whirl -n "__fish_whirl_using_subcommand dash" -l locked -d 'Begin with the machine locked against keys: ctrl-l unlocks it'
complete -c whirl -n "__fish_whirl_using_subcommand dash" -l force -d 'Replace a file that is there already'
complete -c whirl -n "__fish_whirl_using_subcommand dash" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand record" -l connect -d 'Show it in a running Rerun viewer as it comes, beside the file or without; never waits for it' -r
complete -c whirl -n "__fish_whirl_using_subcommand record" -l bench -d 'Name of the bench' -r
complete -c whirl -n "__fish_whirl_using_subcommand record" -l keep -d 'Keep the last so long only, such as 10min; in several files while it runs, joined at the end' -r
complete -c whirl -n "__fish_whirl_using_subcommand record" -l pretrigger -d 'Write nothing until the machine trips; then the last so long before it, and as long after it but at most 10 s' -r
complete -c whirl -n "__fish_whirl_using_subcommand record" -l split -d 'Go on in FILE-2.rrd, FILE-3.rrd ... whenever a file is this large, such as 1GB' -r
complete -c whirl -n "__fish_whirl_using_subcommand record" -l min-free -d 'End in good order when the disk has less room left than this' -r
complete -c whirl -n "__fish_whirl_using_subcommand record" -l force -d 'Replace a file that is there already'
complete -c whirl -n "__fish_whirl_using_subcommand record" -l follow -d 'Go on with the next simulation of the same name when one ends'
complete -c whirl -n "__fish_whirl_using_subcommand record" -l as-child -d 'Serve a parent process: say `ready` once it records, with the number of the first step, and end when standard input closes'
complete -c whirl -n "__fish_whirl_using_subcommand record" -l from-the-start -d 'Serve a parent process whose simulation has not begun yet: say `ready` before any step'
complete -c whirl -n "__fish_whirl_using_subcommand record" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand replay" -l history -d 'Megabytes that the steps kept for looking back may take' -r
complete -c whirl -n "__fish_whirl_using_subcommand replay" -l layout -d 'The layout to start with: a name (`whirl layout list`), or a TOML file' -r
complete -c whirl -n "__fish_whirl_using_subcommand replay" -l theme -d 'Colours: default (the terminal\'s own sixteen), full, contrast or colour-blind' -r
complete -c whirl -n "__fish_whirl_using_subcommand replay" -l fps -d 'Frames a second at most; fewer where the line to the terminal is slow' -r
complete -c whirl -n "__fish_whirl_using_subcommand replay" -l ascii -d 'Show nothing but ASCII, whatever the locale says'
complete -c whirl -n "__fish_whirl_using_subcommand replay" -l read-only -d 'Only look: change nothing'
complete -c whirl -n "__fish_whirl_using_subcommand replay" -l locked -d 'Begin with the machine locked against keys: ctrl-l unlocks it'
complete -c whirl -n "__fish_whirl_using_subcommand replay" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand info" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand info" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand export" -l out -d 'Write this file instead: .csv or .parquet' -r -F
complete -c whirl -n "__fish_whirl_using_subcommand export" -l from -d 'Steps from this tau on (of an SI rotor also 2s or 50ms); after a restart tau begins at 0 again, and each stretch has its share' -r
complete -c whirl -n "__fish_whirl_using_subcommand export" -l to -d 'Steps up to this tau' -r
complete -c whirl -n "__fish_whirl_using_subcommand export" -l every -d 'Steps whose number is a multiple of N' -r
complete -c whirl -n "__fish_whirl_using_subcommand export" -l csv -d 'Write FILE.csv beside it'
complete -c whirl -n "__fish_whirl_using_subcommand export" -l parquet -d 'Write FILE.parquet beside it'
complete -c whirl -n "__fish_whirl_using_subcommand export" -l force -d 'Replace a file that is there already'
complete -c whirl -n "__fish_whirl_using_subcommand export" -l json -d 'Print one JSON document about what was written, and where the recording is damaged'
complete -c whirl -n "__fish_whirl_using_subcommand export" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand tail" -l bench -d 'Name of the bench' -r
complete -c whirl -n "__fish_whirl_using_subcommand tail" -l every -d 'Print every Nth step' -r
complete -c whirl -n "__fish_whirl_using_subcommand tail" -l count -d 'End after N lines' -r
complete -c whirl -n "__fish_whirl_using_subcommand tail" -l events -d 'Print what happens instead, who did it and why: first what has happened so far (the last 64), then what comes'
complete -c whirl -n "__fish_whirl_using_subcommand tail" -l json -d 'Print JSON lines'
complete -c whirl -n "__fish_whirl_using_subcommand tail" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand layout; and not __fish_seen_subcommand_from list panels show check" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand layout; and not __fish_seen_subcommand_from list panels show check" -f -a "list" -d 'List the layouts: built in, and yours'
complete -c whirl -n "__fish_whirl_using_subcommand layout; and not __fish_seen_subcommand_from list panels show check" -f -a "panels" -d 'List the panels that a layout can have'
complete -c whirl -n "__fish_whirl_using_subcommand layout; and not __fish_seen_subcommand_from list panels show check" -f -a "show" -d 'Print a layout as the TOML of its file'
complete -c whirl -n "__fish_whirl_using_subcommand layout; and not __fish_seen_subcommand_from list panels show check" -f -a "check" -d 'Say what is wrong with layout files'
complete -c whirl -n "__fish_whirl_using_subcommand layout; and __fish_seen_subcommand_from list" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand layout; and __fish_seen_subcommand_from list" -l csv -d 'Print rows for a spreadsheet'
complete -c whirl -n "__fish_whirl_using_subcommand layout; and __fish_seen_subcommand_from list" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand layout; and __fish_seen_subcommand_from panels" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand layout; and __fish_seen_subcommand_from panels" -l csv -d 'Print rows for a spreadsheet'
complete -c whirl -n "__fish_whirl_using_subcommand layout; and __fish_seen_subcommand_from panels" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand layout; and __fish_seen_subcommand_from show" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand layout; and __fish_seen_subcommand_from check" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand config; and not __fish_seen_subcommand_from path show defaults" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand config; and not __fish_seen_subcommand_from path show defaults" -f -a "path" -d 'Print the paths of the configuration file, your layouts, your gains and the commands you typed'
complete -c whirl -n "__fish_whirl_using_subcommand config; and not __fish_seen_subcommand_from path show defaults" -f -a "show" -d 'Check the configuration file and print it'
complete -c whirl -n "__fish_whirl_using_subcommand config; and not __fish_seen_subcommand_from path show defaults" -f -a "defaults" -d 'Print what holds without a file, as a file to change'
complete -c whirl -n "__fish_whirl_using_subcommand config; and __fish_seen_subcommand_from path" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand config; and __fish_seen_subcommand_from show" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand config; and __fish_seen_subcommand_from defaults" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand set" -l bench -d 'Name of the bench' -r
complete -c whirl -n "__fish_whirl_using_subcommand set" -l why -d 'Why, for the log of events: `whirl tail --events` shows it' -r
complete -c whirl -n "__fish_whirl_using_subcommand set" -l force -d 'Make the change even if a stable machine becomes unstable by it, or trips at once'
complete -c whirl -n "__fish_whirl_using_subcommand set" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand set" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand drill" -l at -d 'Where a fault is: the number or name of a mass or control bearing' -r
complete -c whirl -n "__fish_whirl_using_subcommand drill" -l size -d 'How large it is, in the units of the bench' -r
complete -c whirl -n "__fish_whirl_using_subcommand drill" -l bench -d 'Name of the bench' -r
complete -c whirl -n "__fish_whirl_using_subcommand drill" -l force -d 'Make the fault even if a stable machine becomes unstable by it'
complete -c whirl -n "__fish_whirl_using_subcommand drill" -l json -d 'Print JSON, one object a change'
complete -c whirl -n "__fish_whirl_using_subcommand drill" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand note" -l bench -d 'Name of the bench' -r
complete -c whirl -n "__fish_whirl_using_subcommand note" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand note" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand status" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand status" -l csv -d 'Print rows for a spreadsheet'
complete -c whirl -n "__fish_whirl_using_subcommand status" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand control" -l bench -d 'Name of the bench' -r
complete -c whirl -n "__fish_whirl_using_subcommand control" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand wire" -l bench -d 'Name of the bench' -r
complete -c whirl -n "__fish_whirl_using_subcommand wire" -l header -d 'Print the C header of all messages, whirl.h'
complete -c whirl -n "__fish_whirl_using_subcommand wire" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand wire" -l csv -d 'Print rows for a spreadsheet'
complete -c whirl -n "__fish_whirl_using_subcommand wire" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand clean" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand clean" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand poles" -l feedback -d 'The feedback: off; cancel (jeffcott); composite, individual (three-mass); own (magnetic bearings of a drawing, the default there); or a TOML file' -r
complete -c whirl -n "__fish_whirl_using_subcommand poles" -l deadband -d 'Clearance of every support bearing, in e_t (SI rotors: in m)' -r
complete -c whirl -n "__fish_whirl_using_subcommand poles" -l set -d 'Any other setting, such as delay=0.02 or deadband.2=0.5; `off` takes a part of the loop out (repeatable)' -r
complete -c whirl -n "__fish_whirl_using_subcommand poles" -l speed -d 'Spin speed R = w / w0 (SI rotors: in rpm) [default: that of `up`, R = 2.5]' -r
complete -c whirl -n "__fish_whirl_using_subcommand poles" -l below -d 'With shaft elements: the damping of modes counts up to this frequency in Hz, while all are to be stable [default: 4 times the top speed, and past the fourth forward mode]' -r
complete -c whirl -n "__fish_whirl_using_subcommand poles" -l full -d 'Look at all coordinates of shaft elements, not at those that are stepped'
complete -c whirl -n "__fish_whirl_using_subcommand poles" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand poles" -l csv -d 'Print rows for a spreadsheet'
complete -c whirl -n "__fish_whirl_using_subcommand poles" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand trace" -l feedback -d 'The feedback: off; cancel (jeffcott); composite, individual (three-mass); own (magnetic bearings of a drawing, the default there); or a TOML file' -r
complete -c whirl -n "__fish_whirl_using_subcommand trace" -l deadband -d 'Clearance of every support bearing, in e_t (SI rotors: in m)' -r
complete -c whirl -n "__fish_whirl_using_subcommand trace" -l set -d 'Any other setting, such as delay=0.02 or deadband.2=0.5; `off` takes a part of the loop out (repeatable)' -r
complete -c whirl -n "__fish_whirl_using_subcommand trace" -l over -d 'Spin speeds R, both ends included (SI rotors: in rpm)' -r
complete -c whirl -n "__fish_whirl_using_subcommand trace" -l points -d 'How many speeds, evenly spaced [default: 101]' -r
complete -c whirl -n "__fish_whirl_using_subcommand trace" -l below -d 'With shaft elements: the damping of modes counts up to this frequency in Hz, while all are to be stable [default: 4 times the top speed, and past the fourth forward mode]' -r
complete -c whirl -n "__fish_whirl_using_subcommand trace" -l campbell -d 'Print the Campbell diagram instead: frequencies, and critical speeds where a branch meets 0.5X or 1X'
complete -c whirl -n "__fish_whirl_using_subcommand trace" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand trace" -l csv -d 'Print rows for a spreadsheet'
complete -c whirl -n "__fish_whirl_using_subcommand trace" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand thresholds" -l feedback -d 'The feedback: off; cancel (jeffcott); composite, individual (three-mass); own (magnetic bearings of a drawing, the default there); or a TOML file' -r
complete -c whirl -n "__fish_whirl_using_subcommand thresholds" -l deadband -d 'Clearance of every support bearing, in e_t (SI rotors: in m)' -r
complete -c whirl -n "__fish_whirl_using_subcommand thresholds" -l set -d 'Any other setting, such as delay=0.02 or deadband.2=0.5; `off` takes a part of the loop out (repeatable)' -r
complete -c whirl -n "__fish_whirl_using_subcommand thresholds" -l over -d 'Spin speeds R to search, both ends included (SI rotors: in rpm)' -r
complete -c whirl -n "__fish_whirl_using_subcommand thresholds" -l below -d 'With shaft elements: the damping of modes counts up to this frequency in Hz, while all are to be stable [default: 4 times the top speed, and past the fourth forward mode]' -r
complete -c whirl -n "__fish_whirl_using_subcommand thresholds" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand thresholds" -l csv -d 'Print rows for a spreadsheet'
complete -c whirl -n "__fish_whirl_using_subcommand thresholds" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c whirl -n "__fish_whirl_using_subcommand modes" -l feedback -d 'The feedback: off; cancel (jeffcott); composite, individual (three-mass); own (magnetic bearings of a drawing, the default there); or a TOML file' -r
complete -c whirl -n "__fish_whirl_using_subcommand modes" -l deadband -d 'Clearance of every support bearing, in e_t (SI rotors: in m)' -r
complete -c whirl -n "__fish_whirl_using_subcommand modes" -l set -d 'Any other setting, such as delay=0.02 or deadband.2=0.5; `off` takes a part of the loop out (repeatable)' -r
complete -c whirl -n "__fish_whirl_using_subcommand modes" -l speed -d 'Spin speed R = w / w0 (SI rotors: in rpm)' -r
complete -c whirl -n "__fish_whirl_using_subcommand modes" -l points -d 'Points of an orbit, the last of which ends the whirl period, with --json or --csv [default: 65]' -r
complete -c whirl -n "__fish_whirl_using_subcommand modes" -l out -d 'Draw the slowest modes along the rotor into a file that ends in .svg or .png' -r -F
complete -c whirl -n "__fish_whirl_using_subcommand modes" -l full -d 'Look at all coordinates of shaft elements, not at those that are stepped'
complete -c whirl -n "__fish_whirl_using_subcommand modes" -l draw -d 'Draw them in the terminal, in place of the table'
complete -c whirl -n "__fish_whirl_using_subcommand modes" -l force -d 'Replace a file that is there already'
complete -c whirl -n "__fish_whirl_using_subcommand modes" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand modes" -l csv -d 'Print rows for a spreadsheet'
complete -c whirl -n "__fish_whirl_using_subcommand modes" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand margin" -l feedback -d 'The feedback: off; cancel (jeffcott); composite, individual (three-mass); own (magnetic bearings of a drawing, the default there); or a TOML file' -r
complete -c whirl -n "__fish_whirl_using_subcommand margin" -l deadband -d 'Clearance of every support bearing, in e_t (SI rotors: in m)' -r
complete -c whirl -n "__fish_whirl_using_subcommand margin" -l set -d 'Any other setting, such as delay=0.02 or deadband.2=0.5; `off` takes a part of the loop out (repeatable)' -r
complete -c whirl -n "__fish_whirl_using_subcommand margin" -l speed -d 'Spin speed R = w / w0 (SI rotors: in rpm)' -r
complete -c whirl -n "__fish_whirl_using_subcommand margin" -l over -d 'The worst over spin speeds R, both ends included (SI rotors: in rpm)' -r
complete -c whirl -n "__fish_whirl_using_subcommand margin" -l points -d 'How many speeds of the range, evenly spaced; the worst is sought between them too [default: 201]' -r
complete -c whirl -n "__fish_whirl_using_subcommand margin" -l zones -d 'Peaks of sensitivity at which zones A, B and C end [default: 3,4,5, those of ISO 14839-3]' -r
complete -c whirl -n "__fish_whirl_using_subcommand margin" -l box -d 'The worst damping when every parameter of the rotor that is not 0 lies anywhere within so much of its value; of a drawing the mass and inertias of a disc by one factor (disc.1.inertia), and the moduli of a material (material.1.moduli)' -r
complete -c whirl -n "__fish_whirl_using_subcommand margin" -l vary -d 'The same of one parameter: damping.1=0.2..0.3, delay=0..0.1, shaft.2=10%; repeatable, and before what `--box` says. Settings are typed as for `--set`, a drawing\'s numbers in SI units, a chain\'s dimensionless' -r
complete -c whirl -n "__fish_whirl_using_subcommand margin" -l tolerance -d 'How sharply the worst is bounded where it can be proven' -r
complete -c whirl -n "__fish_whirl_using_subcommand margin" -l samples -d 'Draw so many machines whose parameters lie anywhere there' -r
complete -c whirl -n "__fish_whirl_using_subcommand margin" -l distribution -d 'How they are spread' -r -f -a "uniform\t'All of a range alike'
normal\t'About its middle, three standard deviations to either end; nothing outside'"
complete -c whirl -n "__fish_whirl_using_subcommand margin" -l seed -d 'What random numbers start from; the same seed draws the same machines, on any number of threads' -r
complete -c whirl -n "__fish_whirl_using_subcommand margin" -l below -d 'With shaft elements: the damping of modes counts up to this frequency in Hz, while all are to be stable [default: 4 times the top speed, and past the fourth forward mode]' -r
complete -c whirl -n "__fish_whirl_using_subcommand margin" -l full -d 'Look at all coordinates of shaft elements, not at those that are stepped'
complete -c whirl -n "__fish_whirl_using_subcommand margin" -l sensitivities -d 'What every parameter does to damping and margins, the largest effects first; `--csv` has these rows'
complete -c whirl -n "__fish_whirl_using_subcommand margin" -l simulate -d 'Simulate each of them from rest, with its clearances and limits, and tell how large orbits and forces get; `--vary` takes deadband and unbalance too then'
complete -c whirl -n "__fish_whirl_using_subcommand margin" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand margin" -l csv -d 'Print rows for a spreadsheet'
complete -c whirl -n "__fish_whirl_using_subcommand margin" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c whirl -n "__fish_whirl_using_subcommand measure" -l bench -d 'Name of the bench' -r
complete -c whirl -n "__fish_whirl_using_subcommand measure" -l band -d 'Frequencies, each forward and backward, in radians per tau (SI rotors: in Hz) [default: up to twice the fastest mode]' -r
complete -c whirl -n "__fish_whirl_using_subcommand measure" -l tones -d 'How many tones of each direction, at most, evenly over the logarithm of frequency' -r
complete -c whirl -n "__fish_whirl_using_subcommand measure" -l amplitude -d 'Amplitude of each tone, in w0^2 e_t (SI rotors: in N); or all of them together as a share of the present force, such as 2%' -r
complete -c whirl -n "__fish_whirl_using_subcommand measure" -l periods -d 'How many periods are measured, after the machine has settled' -r
complete -c whirl -n "__fish_whirl_using_subcommand measure" -l seed -d 'Which phases: the same seed gives the same tones' -r
complete -c whirl -n "__fish_whirl_using_subcommand measure" -l out -d 'Draw it into a file that ends in .svg or .png' -r -F
complete -c whirl -n "__fish_whirl_using_subcommand measure" -l force -d 'Replace a file that is there already'
complete -c whirl -n "__fish_whirl_using_subcommand measure" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand measure" -l csv -d 'Print rows for a spreadsheet'
complete -c whirl -n "__fish_whirl_using_subcommand measure" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand bode" -l feedback -d 'The feedback: off; cancel (jeffcott); composite, individual (three-mass); own (magnetic bearings of a drawing, the default there); or a TOML file' -r
complete -c whirl -n "__fish_whirl_using_subcommand bode" -l deadband -d 'Clearance of every support bearing, in e_t (SI rotors: in m)' -r
complete -c whirl -n "__fish_whirl_using_subcommand bode" -l set -d 'Any other setting, such as delay=0.02 or deadband.2=0.5; `off` takes a part of the loop out (repeatable)' -r
complete -c whirl -n "__fish_whirl_using_subcommand bode" -l speed -d 'Spin speed R = w / w0 (SI rotors: in rpm)' -r
complete -c whirl -n "__fish_whirl_using_subcommand bode" -l over -d 'Spin speeds R of the response to unbalance, both ends included (SI rotors: in rpm)' -r
complete -c whirl -n "__fish_whirl_using_subcommand bode" -l of -d 'Which: the loop\'s gain, its sensitivity, the closed loop, displacement at a mass per force, or unbalance over speed' -r
complete -c whirl -n "__fish_whirl_using_subcommand bode" -l band -d 'Frequencies, negative for backward whirl, in radians per tau (SI rotors: in Hz) [default: all that matter]' -r
complete -c whirl -n "__fish_whirl_using_subcommand bode" -l show -d 'What a picture shows' -r -f -a "bode\t'Amplitude, and phase below it'
amplitude\t'Amplitude over frequency'
phase\t'Phase over frequency'
nyquist\t'The response in the complex plane, with -1 and circles of equal sensitivity around it'"
complete -c whirl -n "__fish_whirl_using_subcommand bode" -l out -d 'Draw it into a file that ends in .svg or .png' -r -F
complete -c whirl -n "__fish_whirl_using_subcommand bode" -l full -d 'Look at all coordinates of shaft elements, not at those that are stepped'
complete -c whirl -n "__fish_whirl_using_subcommand bode" -l draw -d 'Draw it in the terminal, in place of the table'
complete -c whirl -n "__fish_whirl_using_subcommand bode" -l force -d 'Replace a file that is there already'
complete -c whirl -n "__fish_whirl_using_subcommand bode" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand bode" -l csv -d 'Print rows for a spreadsheet'
complete -c whirl -n "__fish_whirl_using_subcommand bode" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c whirl -n "__fish_whirl_using_subcommand assess" -l feedback -d 'The feedback: off; cancel (jeffcott); composite, individual (three-mass); own (magnetic bearings of a drawing, the default there); or a TOML file' -r
complete -c whirl -n "__fish_whirl_using_subcommand assess" -l deadband -d 'Clearance of every support bearing, in e_t (SI rotors: in m)' -r
complete -c whirl -n "__fish_whirl_using_subcommand assess" -l set -d 'Any other setting, such as delay=0.02 or deadband.2=0.5; `off` takes a part of the loop out (repeatable)' -r
complete -c whirl -n "__fish_whirl_using_subcommand assess" -l over -d 'Spin speeds R that the machine passes, both ends included (SI rotors: in rpm)' -r
complete -c whirl -n "__fish_whirl_using_subcommand assess" -l operating -d 'Of them those at which it stays [default: all of them]' -r
complete -c whirl -n "__fish_whirl_using_subcommand assess" -l grade -d 'Balance quality grade, such as G2.5 (SI rotors)' -r
complete -c whirl -n "__fish_whirl_using_subcommand assess" -l cross-stiffness -d 'The cross-coupled stiffness that is expected, in K_t (SI rotors: in N/m)' -r
complete -c whirl -n "__fish_whirl_using_subcommand assess" -l cross-at -d 'The mass, counted from 1, to which cross-coupled stiffness is added [default: the middle one]' -r
complete -c whirl -n "__fish_whirl_using_subcommand assess" -l clearance -d 'Smallest radial clearance, in e_t (SI rotors: in m) [default: the smallest clearance of a bearing]' -r
complete -c whirl -n "__fish_whirl_using_subcommand assess" -l force-limit -d 'The largest force of the control bearing, in w0^2 e_t (SI rotors: in N) [default: the limit of the loop]' -r
complete -c whirl -n "__fish_whirl_using_subcommand assess" -l limits -d 'A file of limits, for those that are to be others than the table\'s' -r
complete -c whirl -n "__fish_whirl_using_subcommand assess" -l out -d 'Write a page that ends in .html, with its charts, or in .md' -r -F
complete -c whirl -n "__fish_whirl_using_subcommand assess" -l below -d 'With shaft elements: the damping of modes counts up to this frequency in Hz, while all are to be stable [default: 4 times the top speed, and past the fourth forward mode]' -r
complete -c whirl -n "__fish_whirl_using_subcommand assess" -l print-limits -d 'Print every limit with its origin, as such a file to start from, and end'
complete -c whirl -n "__fish_whirl_using_subcommand assess" -l force -d 'Replace a file that is there already'
complete -c whirl -n "__fish_whirl_using_subcommand assess" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand assess" -l csv -d 'Print rows for a spreadsheet'
complete -c whirl -n "__fish_whirl_using_subcommand assess" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand run" -l feedback -d 'The feedback: off; cancel (jeffcott); composite, individual (three-mass); own (magnetic bearings of a drawing, the default there); or a TOML file' -r
complete -c whirl -n "__fish_whirl_using_subcommand run" -l deadband -d 'Clearance of every support bearing, in e_t (SI rotors: in m)' -r
complete -c whirl -n "__fish_whirl_using_subcommand run" -l set -d 'Any other setting, such as delay=0.02 or deadband.2=0.5; `off` takes a part of the loop out (repeatable)' -r
complete -c whirl -n "__fish_whirl_using_subcommand run" -l speed -d 'Spin speed R = w / w0 (SI rotors: in rpm)' -r
complete -c whirl -n "__fish_whirl_using_subcommand run" -l profile -d 'Legs of speed from a file instead of a steady speed' -r
complete -c whirl -n "__fish_whirl_using_subcommand run" -l duration -d 'How long, in tau = w0 t for any rotor [default: as long as the profile]' -r
complete -c whirl -n "__fish_whirl_using_subcommand run" -l dtau -d 'Step of the integration, in tau [default: 126 steps to the fastest turn of any mode or the spin, at most 0.05]' -r
complete -c whirl -n "__fish_whirl_using_subcommand run" -l settle -d 'Take maxima and means from this tau on [default: 0 with impulses or a profile, else from where transients have died]' -r
complete -c whirl -n "__fish_whirl_using_subcommand run" -l impulse -d 'A sudden change of velocity in w0 e_t (SI rotors: in m/s, or as it says), mass=N[,vy=V][,vz=V][,at=TAU] (repeatable)' -r
complete -c whirl -n "__fish_whirl_using_subcommand run" -l out -d 'Write the trajectory, dimensionless for any rotor, to FILE.csv, FILE.parquet or, as a recording, FILE.rrd' -r -F
complete -c whirl -n "__fish_whirl_using_subcommand run" -l every -d 'Write one step in every N' -r
complete -c whirl -n "__fish_whirl_using_subcommand run" -l psd -d 'Two-sided power spectral density of y + j z at a mass, once settled' -r
complete -c whirl -n "__fish_whirl_using_subcommand run" -l force -d 'Replace a file that is there already'
complete -c whirl -n "__fish_whirl_using_subcommand run" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand run" -l csv -d 'Print rows for a spreadsheet'
complete -c whirl -n "__fish_whirl_using_subcommand run" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand runup" -l feedback -d 'The feedback: off; cancel (jeffcott); composite, individual (three-mass); own (magnetic bearings of a drawing, the default there); or a TOML file' -r
complete -c whirl -n "__fish_whirl_using_subcommand runup" -l deadband -d 'Clearance of every support bearing, in e_t (SI rotors: in m)' -r
complete -c whirl -n "__fish_whirl_using_subcommand runup" -l set -d 'Any other setting, such as delay=0.02 or deadband.2=0.5; `off` takes a part of the loop out (repeatable)' -r
complete -c whirl -n "__fish_whirl_using_subcommand runup" -l from -d 'Spin speed R at the beginning, in the steady orbit there (SI rotors: in rpm)' -r
complete -c whirl -n "__fish_whirl_using_subcommand runup" -l to -d 'Spin speed R at the end; below --from for a coast-down (SI rotors: in rpm)' -r
complete -c whirl -n "__fish_whirl_using_subcommand runup" -l rate -d 'Rate of change of R per unit of tau, more than 0 (SI rotors: rpm per second)' -r
complete -c whirl -n "__fish_whirl_using_subcommand runup" -l profile -d 'Legs of speed from a file instead' -r
complete -c whirl -n "__fish_whirl_using_subcommand runup" -l points -d 'How many points of the response, evenly over time' -r
complete -c whirl -n "__fish_whirl_using_subcommand runup" -l out -d 'Draw amplitude and phase over speed into FILE.svg or FILE.png, or keep every step of it as a recording, FILE.rrd' -r -F
complete -c whirl -n "__fish_whirl_using_subcommand runup" -l force -d 'Replace a file that is there already'
complete -c whirl -n "__fish_whirl_using_subcommand runup" -l draw -d 'Draw amplitude and phase over speed in the terminal, above the table of critical speeds'
complete -c whirl -n "__fish_whirl_using_subcommand runup" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand runup" -l csv -d 'Print rows for a spreadsheet'
complete -c whirl -n "__fish_whirl_using_subcommand runup" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand force" -l feedback -d 'The feedback: off; cancel (jeffcott); composite, individual (three-mass); or a TOML file' -r
complete -c whirl -n "__fish_whirl_using_subcommand force" -l deadband -d 'Clearances of all support bearings to try, in e_t (SI rotors: in m) [default: the rotor\'s own]' -r
complete -c whirl -n "__fish_whirl_using_subcommand force" -l over -d 'Spin speeds R, both ends included (SI rotors: in rpm)' -r
complete -c whirl -n "__fish_whirl_using_subcommand force" -l points -d 'How many speeds, evenly spaced' -r
complete -c whirl -n "__fish_whirl_using_subcommand force" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand force" -l csv -d 'Print rows for a spreadsheet'
complete -c whirl -n "__fish_whirl_using_subcommand force" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand response" -l feedback -d 'The feedback: off; cancel (jeffcott); composite, individual (three-mass); own (magnetic bearings of a drawing, the default there); or a TOML file' -r
complete -c whirl -n "__fish_whirl_using_subcommand response" -l deadband -d 'Clearance of every support bearing, in e_t (SI rotors: in m)' -r
complete -c whirl -n "__fish_whirl_using_subcommand response" -l set -d 'Any other setting, such as delay=0.02 or deadband.2=0.5; `off` takes a part of the loop out (repeatable)' -r
complete -c whirl -n "__fish_whirl_using_subcommand response" -l over -d 'Spin speeds R, both ends included (SI rotors: in rpm)' -r
complete -c whirl -n "__fish_whirl_using_subcommand response" -l points -d 'How many speeds, evenly spaced' -r
complete -c whirl -n "__fish_whirl_using_subcommand response" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand response" -l csv -d 'Print rows for a spreadsheet'
complete -c whirl -n "__fish_whirl_using_subcommand response" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand cycles" -l feedback -d 'The feedback: off; cancel (jeffcott); composite, individual (three-mass); own (magnetic bearings of a drawing, the default there); or a TOML file' -r
complete -c whirl -n "__fish_whirl_using_subcommand cycles" -l deadband -d 'Clearance of every support bearing, in e_t (SI rotors: in m)' -r
complete -c whirl -n "__fish_whirl_using_subcommand cycles" -l set -d 'Any other setting, such as delay=0.02 or deadband.2=0.5; `off` takes a part of the loop out (repeatable)' -r
complete -c whirl -n "__fish_whirl_using_subcommand cycles" -l over -d 'Spin speeds R, both ends included (SI rotors: in rpm)' -r
complete -c whirl -n "__fish_whirl_using_subcommand cycles" -l points -d 'How many speeds, evenly spaced' -r
complete -c whirl -n "__fish_whirl_using_subcommand cycles" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand cycles" -l csv -d 'Print rows for a spreadsheet'
complete -c whirl -n "__fish_whirl_using_subcommand cycles" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand map" -l feedback -d 'The feedback: off; cancel (jeffcott); composite, individual (three-mass); own (magnetic bearings of a drawing, the default there); or a TOML file' -r
complete -c whirl -n "__fish_whirl_using_subcommand map" -l deadband -d 'Clearance of every support bearing, in e_t (SI rotors: in m)' -r
complete -c whirl -n "__fish_whirl_using_subcommand map" -l set -d 'Any other setting, such as delay=0.02 or deadband.2=0.5; `off` takes a part of the loop out (repeatable)' -r
complete -c whirl -n "__fish_whirl_using_subcommand map" -l below -d 'With shaft elements: the damping of modes counts up to this frequency in Hz, while all are to be stable [default: 4 times the top speed, and past the fourth forward mode]' -r
complete -c whirl -n "__fish_whirl_using_subcommand map" -l speed -d 'Spin speed R = w / w0 where no axis is it (SI rotors: in rpm)' -r
complete -c whirl -n "__fish_whirl_using_subcommand map" -l x -d 'What varies across: a setting as for `--set`, a parameter of the rotor such as damping.1, a start such as start.1.y, or an impulse on the settled motion such as impulse.1.vy' -r
complete -c whirl -n "__fish_whirl_using_subcommand map" -l y -d 'What varies up, likewise' -r
complete -c whirl -n "__fish_whirl_using_subcommand map" -l points -d 'How many values across and up [default: 81x61; 31x21 where every cell is simulated]' -r
complete -c whirl -n "__fish_whirl_using_subcommand map" -l quantity -d 'What is mapped' -r
complete -c whirl -n "__fish_whirl_using_subcommand map" -l duration -d 'A simulated motion that has not settled by then is told as it is then, in tau (SI rotors: in s)' -r
complete -c whirl -n "__fish_whirl_using_subcommand map" -l out -d 'Write the map as a picture (.svg, .png) or a table (.csv, .parquet)' -r -F
complete -c whirl -n "__fish_whirl_using_subcommand map" -l force -d 'Replace a file that is there already'
complete -c whirl -n "__fish_whirl_using_subcommand map" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand map" -l csv -d 'Print rows for a spreadsheet'
complete -c whirl -n "__fish_whirl_using_subcommand map" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand sweep; and not __fish_seen_subcommand_from plan run gather" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand sweep; and not __fish_seen_subcommand_from plan run gather" -f -a "plan" -d 'Cut a map, samples or the starts of a search into shards, and write the job files that run them'
complete -c whirl -n "__fish_whirl_using_subcommand sweep; and not __fish_seen_subcommand_from plan run gather" -f -a "run" -d 'Run one shard; one that is there already is left as it is'
complete -c whirl -n "__fish_whirl_using_subcommand sweep; and not __fish_seen_subcommand_from plan run gather" -f -a "gather" -d 'Check that every shard is there, whole and of this plan, and say what they hold'
complete -c whirl -n "__fish_whirl_using_subcommand sweep; and __fish_seen_subcommand_from plan" -l shards -d 'Into how many shards' -r
complete -c whirl -n "__fish_whirl_using_subcommand sweep; and __fish_seen_subcommand_from plan" -l out -d 'The folder for plan and shards' -r -F
complete -c whirl -n "__fish_whirl_using_subcommand sweep; and __fish_seen_subcommand_from plan" -l slurm -d 'Write array.sh, a job array for Slurm: sbatch array.sh'
complete -c whirl -n "__fish_whirl_using_subcommand sweep; and __fish_seen_subcommand_from plan" -l kubernetes -d 'Write job.yaml, an indexed job for Kubernetes'
complete -c whirl -n "__fish_whirl_using_subcommand sweep; and __fish_seen_subcommand_from plan" -l force -d 'Replace a file that is there already'
complete -c whirl -n "__fish_whirl_using_subcommand sweep; and __fish_seen_subcommand_from plan" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand sweep; and __fish_seen_subcommand_from run" -l shard -d 'Which shard, counted from 0' -r
complete -c whirl -n "__fish_whirl_using_subcommand sweep; and __fish_seen_subcommand_from run" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand sweep; and __fish_seen_subcommand_from gather" -l out -d 'Of a search: finish it from the best start, as `whirl tune` with all of them would, print its answer and write the feedback' -r -F
complete -c whirl -n "__fish_whirl_using_subcommand sweep; and __fish_seen_subcommand_from gather" -l force -d 'Replace a file that is there already'
complete -c whirl -n "__fish_whirl_using_subcommand sweep; and __fish_seen_subcommand_from gather" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand sweep; and __fish_seen_subcommand_from gather" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l over -d 'Every spin speed of a range, both ends included (SI rotors: in rpm)' -r
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l speed -d 'One spin speed R alone (SI rotors: in rpm)' -r
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l signal -d 'What drives a bearing: the sum of all sensors with four gains, or four gains for each sensor [default: composite; with shaft elements the law of the drawing]' -r -f -a "composite\t'The sum of all sensors, with four gains: the report\'s'
individual\t'Every sensor by itself, with four gains each'"
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l sensors -d 'The masses with sensors, such as 1,2; or any:2 to compare every choice of two [default: the bearing\'s and its neighbour\'s]. With shaft elements: places by name or number, such as left,right, read by every magnetic bearing [default: each its own]' -r
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l bearing -d 'The mass that carries the control bearing; or any, to compare all [default: 1; with shaft elements every magnetic bearing]' -r
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l feedback -d 'Search the gains of this feedback: its bearings, signals, filters and loops are taken as they are' -r
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l corners -d 'Search frequencies of filters too: all, or a corner such as left.filter.1.zero, or words of its name for several; from a fourth to four times what they are, or KEY=A..B in the units of the file, or KEY=P% either way (repeatable)' -r
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l set -d 'A part of the loop, such as lag=0.02, sample=0.05 or delay=0.02 (repeatable)' -r
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l gains -d 'How gains depend on speed: fixed, linear, or table:N for N values over the range' -r
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l bound -d 'The largest magnitude of any gain [default: 20]; with shaft elements in times of the largest gain that its signal has in the law that is searched [default: 4], or of the stiffness K_t where that has none' -r
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l force-limit -d 'The largest steady control force of the linear rotor, in w0^2 e_t (SI rotors: in N)' -r
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l max-sensitivity -d 'The largest peak of the sensitivity |S| at the command of any control bearing, the others closed, at every condition' -r
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l min-delay -d 'The smallest delay margin at every condition, in tau (SI rotors: in s); of one delay in the commands of all bearings' -r
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l robust -d 'Hold for every stiffness that deadband can leave: of each support bearing by itself, or one factor for all' -r -f -a "deadband\t'The factor of each support bearing anywhere from 0 to 1, each by itself'
deadband-common\t'One factor from 0 to 1 for all support bearings'"
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l delay -d 'Hold for a delay between measurement and force, one or a range, in tau (SI rotors: in s)' -r
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l vary -d 'Hold for every value of a parameter: damping.1=0.2..0.3, shaft.2=10%; repeatable, dimensionless' -r
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l measure -d 'What is made as good as can be' -r -f -a "ratio\t'Damping ratio, -Re / |lambda|'
decay\t'Decay rate, -Re lambda per tau'
region\t'How deep in the region of --region it is'
cost\t'The mean square of motion and force under unbalance and noise, made small: see --cost'"
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l below -d 'With shaft elements: the damping of modes counts up to this frequency in Hz, while all are to be stable [default: 4 times the top speed, and past the fourth forward mode]' -r
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l mode-weights -d 'Weights of forward and backward whirl: a mode\'s damping ratio counts divided by its weight' -r
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l region -d 'The region of poles of --measure region: a damping ratio, a decay rate per tau (SI rotors: per s) and a largest |lambda| in radians per tau (SI rotors: in Hz), or some of them, with or without units (frequency=300Hz). A machine is worth t if its poles are in the region made t times as tight' -r
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l cost -d 'What --measure cost weighs: the force beside the orbit, standard deviation of the sensors\' noise in e_t (SI rotors: in m), and its corner in radians per tau (SI rotors: in Hz), with or without units (noise=2um,corner=1kHz) [default: force=0.1,noise=0.1,corner=10, dimensionless]' -r
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l method -d 'How a climb goes' -r -f -a "nonsmooth\t'Smoothing continuation with slopes, then convex steps on the modes that matter, and a proof'
powell\t'Powell\'s direction sets, as in the report'"
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l starts -d 'How many climbs from random gains [default: 4 to 32, by how much there is to get wrong]' -r
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l seed -d 'What random numbers start from; the same seed gives the same answer' -r
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l spread -d 'Random gains are drawn from -W to W' -r
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l tolerance -d 'How sharply the worst over a continuous family is bounded' -r
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l track -d 'Follow the gains over N speeds of the range: at each as good as can be, from one to the next with a penalty on jumps' -r
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l stiffness -d 'What a gain that changes by 1 per unit of speed costs, in damping at each speed' -r
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l pareto -d 'Trade damping for control force, for the size of gains, or for the peak of the sensitivity' -r -f -a "force\t'Steady control force of the linear rotor under its unbalance'
gain\t'The largest gain'
sensitivity\t'The largest peak of the sensitivity'"
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l criteria -d 'Search for each of these by itself, and tell side by side what it buys, in simulation too; --out is a folder for the files' -r -f -a "all\t'Every one below'
ratio\t'Damping ratio'
decay\t'Decay rate'
weighted\t'Damping ratio, forward and backward whirl by --mode-weights [default: 2,1]'
region\t'The region of --region [default: damping=0.1,decay=0.1,frequency=4]'
sensitivity\t'Damping ratio under --max-sensitivity [default: 2]'
cost\t'The cost of --cost'"
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l deadband -d 'Clearances of all support bearings to simulate with --criteria, in e_t (SI rotors: in m) [default: the rotor\'s own]' -r
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l points -d 'How many points the trade has' -r
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l plot -d 'Draw the trade, or the gains over speed, as .svg or .png' -r -F
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l out -d 'Write the feedback to a file; with --pareto, a file a point into this folder' -r -F
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l write-unstable -d 'Write it even if it does not hold the rotor'
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l force -d 'Replace a file that is there already'
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand tune" -l csv -d 'Print rows for a spreadsheet'
complete -c whirl -n "__fish_whirl_using_subcommand tune" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c whirl -n "__fish_whirl_using_subcommand report" -l out -d 'Write page, figures and data into this folder; files of other names in it are left alone' -r -F
complete -c whirl -n "__fish_whirl_using_subcommand report" -l page -d 'Write the page alone, as Markdown without pictures' -r -F
complete -c whirl -n "__fish_whirl_using_subcommand report" -l force -d 'Replace a file that is there already'
complete -c whirl -n "__fish_whirl_using_subcommand report" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand report" -l csv -d 'Print rows for a spreadsheet'
complete -c whirl -n "__fish_whirl_using_subcommand report" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand assign" -l poles -d 'Wanted poles, two for each mass, per unit of tau = w0 t for any rotor: "re,im;re,im;..."' -r
complete -c whirl -n "__fish_whirl_using_subcommand assign" -l reference -d 'Reference speed R0 of the cancelling law (SI rotors: in rpm) [default: 0]' -r
complete -c whirl -n "__fish_whirl_using_subcommand assign" -l speed -d 'Spin speed R = w / w0 (SI rotors: in rpm) at which the poles are assigned or the table is made' -r
complete -c whirl -n "__fish_whirl_using_subcommand assign" -l bearing -d 'The mass that carries the control bearing' -r
complete -c whirl -n "__fish_whirl_using_subcommand assign" -l out -d 'Write the feedback to a file instead' -r -F
complete -c whirl -n "__fish_whirl_using_subcommand assign" -l cancel -d 'The cancelling law kc = zeta (R0 - R), which holds the poles of R0 at every speed (one mass)'
complete -c whirl -n "__fish_whirl_using_subcommand assign" -l table -d 'List how well a bearing or sensor at each mass reaches each mode'
complete -c whirl -n "__fish_whirl_using_subcommand assign" -l force -d 'Replace a file that is there already'
complete -c whirl -n "__fish_whirl_using_subcommand assign" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand assign" -l csv -d 'Print rows for a spreadsheet'
complete -c whirl -n "__fish_whirl_using_subcommand assign" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand rotor; and not __fish_seen_subcommand_from list show check import reduce" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand rotor; and not __fish_seen_subcommand_from list show check import reduce" -f -a "list" -d 'List the built-in rotors'
complete -c whirl -n "__fish_whirl_using_subcommand rotor; and not __fish_seen_subcommand_from list show check import reduce" -f -a "show" -d 'Print a rotor, or feedback for it, as the TOML of its file'
complete -c whirl -n "__fish_whirl_using_subcommand rotor; and not __fish_seen_subcommand_from list show check import reduce" -f -a "check" -d 'Say what is wrong with rotor and feedback files'
complete -c whirl -n "__fish_whirl_using_subcommand rotor; and not __fish_seen_subcommand_from list show check import reduce" -f -a "import" -d 'Print a rotor that another program has saved (ROSS: TOML or JSON) as the TOML of its file'
complete -c whirl -n "__fish_whirl_using_subcommand rotor; and not __fish_seen_subcommand_from list show check import reduce" -f -a "reduce" -d 'Say what a rotor of shaft elements loses by the coordinates that it is stepped in'
complete -c whirl -n "__fish_whirl_using_subcommand rotor; and __fish_seen_subcommand_from list" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand rotor; and __fish_seen_subcommand_from list" -l csv -d 'Print rows for a spreadsheet'
complete -c whirl -n "__fish_whirl_using_subcommand rotor; and __fish_seen_subcommand_from list" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand rotor; and __fish_seen_subcommand_from show" -l feedback -d 'Print this feedback for the rotor instead' -r
complete -c whirl -n "__fish_whirl_using_subcommand rotor; and __fish_seen_subcommand_from show" -l dimensionless -d 'Print an SI rotor in dimensionless form'
complete -c whirl -n "__fish_whirl_using_subcommand rotor; and __fish_seen_subcommand_from show" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand rotor; and __fish_seen_subcommand_from show" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand rotor; and __fish_seen_subcommand_from check" -l for -d 'Check feedback files against this rotor' -r
complete -c whirl -n "__fish_whirl_using_subcommand rotor; and __fish_seen_subcommand_from check" -l feedback -d 'Take every file for feedback, whatever is in it'
complete -c whirl -n "__fish_whirl_using_subcommand rotor; and __fish_seen_subcommand_from check" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand rotor; and __fish_seen_subcommand_from check" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand rotor; and __fish_seen_subcommand_from import" -l name -d 'What the rotor is called [default: as its file]' -r
complete -c whirl -n "__fish_whirl_using_subcommand rotor; and __fish_seen_subcommand_from import" -l average -d 'Go on with the mean where the two directions differ; the rotor\'s name says so, and comments in the file with which numbers'
complete -c whirl -n "__fish_whirl_using_subcommand rotor; and __fish_seen_subcommand_from import" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand rotor; and __fish_seen_subcommand_from reduce" -l over -d 'Look at this range of spin speeds (in rpm, or as it says)' -r
complete -c whirl -n "__fish_whirl_using_subcommand rotor; and __fish_seen_subcommand_from reduce" -l points -d 'How many speeds of the range to look at' -r
complete -c whirl -n "__fish_whirl_using_subcommand rotor; and __fish_seen_subcommand_from reduce" -l up-to -d 'Compare poles up to this frequency (in Hz, or as it says) [default: ten times the highest speed, at least that of the fourth mode]' -r
complete -c whirl -n "__fish_whirl_using_subcommand rotor; and __fish_seen_subcommand_from reduce" -l coordinates -d 'Keep this many coordinates in place of those of the file' -r
complete -c whirl -n "__fish_whirl_using_subcommand rotor; and __fish_seen_subcommand_from reduce" -l check -d 'Fail if a pole is off by more than this part of its size' -r
complete -c whirl -n "__fish_whirl_using_subcommand rotor; and __fish_seen_subcommand_from reduce" -l json -d 'Print one JSON document'
complete -c whirl -n "__fish_whirl_using_subcommand rotor; and __fish_seen_subcommand_from reduce" -l csv -d 'Print rows for a spreadsheet'
complete -c whirl -n "__fish_whirl_using_subcommand rotor; and __fish_seen_subcommand_from reduce" -s h -l help -d 'Print help'
complete -c whirl -n "__fish_whirl_using_subcommand help" -s h -l help -d 'Print help'
