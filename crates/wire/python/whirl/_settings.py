"""Settings as a document: read, changed by the keys of ``whirl set``, and written again."""

from __future__ import annotations

import math
import tomllib
from typing import Any

#: Settings of the whole machine, and what `off` means of one that can be off.
_MACHINE: dict[str, float | None] = {"speed": None, "ramp": math.inf, "trip": None, "coast_down": 0.0}
_GAINS = ("kd", "cd", "kc", "cc")
#: Numbers of the loop, and what an absent one counts as.
_PARTS = {
    "sensor_lag": 0.0, "noise": 0.0, "quantum": 0.0, "seed": 1.0, "sample": 0.0, "delay": 0.0, "lag": 0.0, "lag_damping": 0.0,
    "limit": math.inf, "slew": math.inf, "external": 0.0, "external_trip": 0.0,
    "sensor_gain": 1.0, "sensor_at": 0.0, "amplifier_y": 1.0, "amplifier_z": 1.0,
}  # fmt: skip


def read(text: str) -> dict[str, Any]:
    """The settings that a document has, ``feedback`` as its file says it."""
    settings = tomllib.loads(text)
    settings["feedback"] = tomllib.loads(settings["feedback"])
    return settings


def changed(text: str, values: dict[str, object]) -> str:
    """The document with other values.

    :raises ValueError: no such key, or no such value.
    """
    settings = read(text)
    if not values:
        raise ValueError("nothing to set: expected KEY=VALUE, such as kd=0.1")
    for key, value in values.items():
        _assign(settings, key, value)
    return write(settings)


def _bearings(feedback: dict[str, Any]) -> list[dict[str, Any]]:
    """Every control bearing: of a machine with one the file itself is it."""
    bearings = feedback.get("bearing")
    return bearings if isinstance(bearings, list) else [feedback]


def _number(key: str, value: object, off: float | None) -> float:
    if value == "off" and off is not None:
        return off
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return float(value)
    raise ValueError(f"{key} = {value!r}: expected a number{' or off' if off is not None else ''}")


def _place(key: str, index: str, count: int, of: str) -> int:
    if not index.isdecimal() or not 1 <= int(index) <= count:
        raise ValueError(f"{key}: expected an index from 1 to {count}, of {count} {of}")
    return int(index) - 1


def _assign(settings: dict[str, Any], key: str, value: object) -> None:
    feedback = settings["feedback"]
    bearings = _bearings(feedback)
    named: dict[str, Any] | None = None
    rest = key
    if "." in key:
        front, back = key.split(".", 1)
        named = next((bearing for bearing in bearings if bearing.get("name") == front), None)
        rest = back if named is not None else key
    name, _, index = rest.partition(".")
    if named is None and name in _MACHINE and not index:
        settings[name] = _number(key, value, _MACHINE[name])
    elif named is None and name in ("deadband", "unbalance_added"):
        added = name == "unbalance_added"
        clearances: list[float] = settings.setdefault(name, [0.0] * len(settings["deadband"]))
        number = _number(key, value, 0.0 if added else None)
        places = [_place(key, index, len(clearances), "masses")] if index else range(len(clearances))
        for place in places:
            clearances[place] = number
    elif name in _GAINS:
        signals = [signal for bearing in ([named] if named is not None else bearings) for signal in bearing["signal"]]
        if not index and named is None and len(bearings) > 1:
            raise ValueError(f"{key}: which control bearing? NAME.{key}, or {key}.N of {len(signals)} signals")
        signals[_place(key, index, len(signals), "signals") if index else 0][name] = _number(key, value, None)
    elif name in _PARTS:
        number = _number(key, value, _PARTS[name])
        chosen = [named] if named is not None else bearings
        if index:
            chosen = [chosen[_place(key, index, len(chosen), "control bearings")]]
        for bearing in chosen:
            loop = bearing.setdefault("loop", {})
            loop[name] = number
            if number == _PARTS[name]:
                del loop[name]
            if not loop:
                del bearing["loop"]
    else:
        known = [*_MACHINE, "deadband", "unbalance_added", *_GAINS, *_PARTS]
        raise ValueError(f"no setting '{key}': expected one of {', '.join(known)}")


def write(settings: dict[str, Any]) -> str:
    """The document of settings: what tomllib reads of it is the same, and floats to the last bit."""
    keys = [key for key in ("speed", "trip", "ramp", "deadband", "coast_down", "unbalance_added", "masses") if key in settings]
    lines = [f"{key} = {_value(settings[key])}" for key in keys]
    return "\n".join([*lines, "feedback = '''", _table(settings["feedback"], "")]) + "'''\n"


def _table(table: dict[str, Any], within: str) -> str:
    """A table of TOML: its own keys, and then the tables in it."""
    own, inner = [], []
    for key, value in table.items():
        path = f"{within}{key}"
        if isinstance(value, list) and value and isinstance(value[0], dict) and key in ("signal", "bearing"):
            inner += [f"\n[[{path}]]\n{_table(item, path + '.')}" for item in value]
        elif isinstance(value, dict) and key == "loop":
            inner.append(f"\n[{path}]\n{_table(value, path + '.')}")
        else:
            own.append(f"{key} = {_value(value)}\n")
    return "".join(own + inner)


def _value(value: Any) -> str:
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return repr(value)
    if isinstance(value, list):
        return "[" + ", ".join(_value(item) for item in value) + "]"
    return "{ " + ", ".join(f"{key} = {_value(item)}" for key, item in value.items()) + " }"
