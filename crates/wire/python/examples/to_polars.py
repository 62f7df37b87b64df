"""Logs a running bench to a Parquet file with Polars: every step, every channel, for so many seconds of its own time.

    pip install polars
    python crates/wire/python/examples/to_polars.py lab 10 run.parquet
"""

import sys

import polars

import whirl


def log(bench: whirl.Bench, seconds: float) -> polars.DataFrame:
    """Every step of the next ``seconds`` as a data frame, a column a channel."""
    wanted, parts, lost, count = round(seconds * bench.status.rate_hz), [], 0, 0
    for block in bench.steps(timeout=5.0):
        # A data frame of its own: the block goes back to the bench.
        parts.append(polars.DataFrame({name: data.copy() for name, data in block.columns().items()}))
        lost += block.lost
        count += len(block)
        if count >= wanted:
            break
    if lost:
        print(f"{lost} steps were lost", file=sys.stderr)
    return polars.concat(parts)


def main() -> None:
    """Logs, and says what was seen."""
    name, seconds, path = sys.argv[1], float(sys.argv[2]), sys.argv[3]
    with whirl.attach(name) as bench:
        frame = log(bench, seconds)
    frame.write_parquet(path)
    summary = frame.select(
        polars.len().alias("steps"),
        (polars.col("y1").pow(2) + polars.col("z1").pow(2)).sqrt().max().alias("largest_radius"),
        polars.col("speed").last(),
    )
    print(summary)


if __name__ == "__main__":
    main()
