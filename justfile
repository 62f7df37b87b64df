# The front door. `just` alone lists what there is; every recipe is one command that also works without just.

_default:
    @just --list --unsorted

# The bench, live: a simulation and a dashboard on it
run *ARGS:
    cargo run --release -- {{ARGS}}

# All tests but those of recordings and Parquet files, which `just ci` has too
test *ARGS:
    cargo test --workspace {{ARGS}}

# Formatting, clippy and docs, warnings denied
lint:
    cargo fmt --all --check
    cargo clippy --workspace --all-targets -- -D warnings
    RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps

# The crates as libraries, on the page that leads to each
docs:
    cargo doc --workspace --no-deps
    cargo doc --no-deps --open -p whirl

# Files by the thousand that no reader may stumble over: SECONDS for each kind of file, from SEED on (recordings need rerun: minutes to build)
fuzz SECONDS="60" SEED="1000":
    WHIRL_FUZZ_SECONDS={{SECONDS}} WHIRL_FUZZ_SEED={{SEED}} cargo test -p promises --test corpus
    WHIRL_FUZZ_SECONDS={{SECONDS}} WHIRL_FUZZ_SEED={{SEED}} cargo test -p tape -p promises --features promises/rerun --test damage

# The end-to-end tests TIMES times, beside a busy loop for every processor (minutes each)
shake TIMES="30" *ARGS:
    tests/shake {{TIMES}} {{ARGS}}

# Licences, sources, duplicates and unused dependencies of what comes from outside
dependencies:
    cargo run -p promises --example dependencies

# What must hold before a change lands
ci:
    .ci/run

# What docs/book/src/measurements.md promises of the live bench, measured on this machine (2 minutes; Linux)
measure:
    cargo bench -p promises --bench measure

# What a recorder costs the simulation (5 minutes, and minutes to build the first time; Linux)
measure-recorder:
    cargo bench -p promises --features rerun --bench recorder

# Recordings: the sink, the reader and the commands, with rerun (minutes to build the first time)
test-recordings:
    cargo test -p tape -p promises --features promises/rerun --lib --test files --test damage
    cargo test -p tape -p promises --features promises/rerun --test promises -- recordings replay after_a_trip tutorial

# The small recording in recordings/, made again
sample:
    rm -f recordings/run-up.rrd
    cargo run -p tape --features rerun --example sample -- recordings/run-up.rrd

# Every value of the sample as the public Rerun SDK reads it, beside ours (sets up Python's rerun-sdk in target/)
check-recordings:
    cargo build --release --features rerun
    python3 -m venv target/rerun-sdk
    target/rerun-sdk/bin/pip install --quiet rerun-sdk==0.36.3 pyarrow
    target/rerun-sdk/bin/python tests/reference/recordings.py target/release/whirl

# Margins beside python-control: the same crossings, and the ratio of times (sets up Python's control in target/)
check-margins:
    cargo build --release
    python3 -m venv target/python-control
    target/python-control/bin/pip install --quiet control==0.10.2 scipy
    target/python-control/bin/python tests/reference/margins_beside_control.py target/release/whirl

# A Campbell diagram beside ROSS: the same frequencies, and the ratio of times (sets up Python's ross-rotordynamics in target/)
check-campbell:
    cargo build --release
    python3 -m venv target/ross
    target/ross/bin/pip install --quiet ross-rotordynamics==2.3.0 "plotly<6"
    target/ross/bin/python tests/reference/campbell_beside_ross.py target/release/whirl

# A job array of `whirl sweep plan --slurm` on a real Slurm of one node, one task killed half way (as root on Debian; installs slurm-wlm and munge)
check-slurm *ARGS:
    cargo build --release --features parquet
    python3 -m venv target/slurm
    target/slurm/bin/pip install --quiet duckdb polars pyarrow
    target/slurm/bin/python tests/slurm target/release/whirl {{ARGS}}

# All poles of a rotor of 60 elements beside LAPACK's zgeev (sets up Python's scipy in target/)
check-eigenvalues:
    cargo build --release
    python3 -m venv target/scipy
    target/scipy/bin/pip install --quiet scipy
    target/scipy/bin/python tests/reference/eigenvalues_beside_lapack.py target/release/whirl

# Benchmarks of the numerics and of drawing, each beside a peer in the same process
bench *ARGS:
    cargo bench --workspace --exclude promises {{ARGS}}

# Steps a second beside plain C at -O3 -march=native -ffast-math on the same equations: one trajectory, and many at once (needs cc)
check-steps:
    cargo bench -p study --bench beside_c

# The NASA report again, into ./out, and its committed page renewed
report:
    cargo run --release -- report --force --out out --page docs/book/src/nasa-report.md

# The evidence for the gain search, docs/book/src/gain-search.md, computed anew (a minute)
evidence:
    cargo run --release -p study --example gain_search -- docs/book/src

# A release in one file, target/dist: program, man pages, completions, licences, with its SHA-256 (`just dist --features rerun`: with recordings)
dist *ARGS:
    cargo run -p promises --example dist -- {{ARGS}}

# Sets of gains side by side, docs/book/src/side-by-side.md, computed anew (under two minutes)
side-by-side:
    cargo build --release -p promises
    cargo run --release -p promises --example evidence -- docs/book/src/side-by-side.md

# Man pages, shell completions and the book's reference pages, made from the program's tables (a test compares)
manual:
    rm -rf docs/man docs/completions
    cargo run -p promises --example manual -- docs

# The book's page of JSON fields, asked of the program (a test compares)
json:
    cargo build -p promises
    cargo run -p promises --example json -- docs/book/src/json.md

# The book as HTML, target/book (sets up mdBook in target/tools: a minute or two, once)
book:
    cargo install mdbook --version 0.5.4 --locked --no-default-features --features search --root target/tools
    target/tools/bin/mdbook build docs/book

# The spelling of the documents (sets up typos in target/tools: two minutes, once); words of the field go into docs/book/typos.toml
spelling:
    cargo install typos-cli --version 1.52.0 --locked --no-default-features --features dict --root target/tools
    target/tools/bin/typos --config docs/book/typos.toml README.md ARCHITECTURE.md CONTRIBUTING.md CHANGELOG.md recordings/README.md docs/book/src

# The C header of the messages, made from their tables (a test compares)
header:
    cargo run -p wire --example header -- crates/wire/whirl.h

# The messages for Python, made from the same tables (a test compares)
python-messages:
    cargo run -p wire --example python -- crates/wire/python/whirl/messages.py

# What a controller outside and a reader in Python cost and keep up with (`just check-python` makes the virtual environment)
measure-open-bench:
    cargo build --release
    cargo build --release -p wire --example controller
    python3 tests/reference/open_bench.py target/release target/python-bench/bin/python

# What a dashboard sends, and how long a key takes over a line that is far away or slow
measure-far-away:
    cargo build --release
    python3 tests/reference/far_away.py target/release/whirl

# The Python package against a real bench (sets up numpy, iceoryx2 and pytest in target/)
check-python:
    cargo build --release
    python3 -m venv target/python-bench
    target/python-bench/bin/pip install --quiet -e crates/wire/python[test]
    cd crates/wire/python && ../../../target/python-bench/bin/mypy whirl
    WHIRL=target/release/whirl target/python-bench/bin/python -m pytest -q crates/wire/python/tests

# The page of the protocol, docs/book/src/protocol.md, made from the same tables (a test compares)
protocol:
    cargo run -p wire --example protocol -- docs/book/src/protocol.md

# The documents' pictures, of a real bench, into docs/book/src/pictures
screenshots:
    docs/book/src/pictures/make

# Take over changed frames and texts of the snapshot tests, after reading them
accept:
    INSTA_UPDATE=always cargo test --workspace
