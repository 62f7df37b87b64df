"""Joins a running whirl bench from Python: reads every step of it, changes it, controls it.

>>> import whirl                                        # doctest: +SKIP
>>> bench = whirl.attach("default")                     # doctest: +SKIP
>>> for block in bench.steps():                         # doctest: +SKIP
...     print(block.tau[-1], abs(block.y).max())

Built on the public packages ``iceoryx2`` and NumPy. All numbers are dimensionless: displacement in e_t, time tau = w0 t, velocity in
w0 e_t, control in w0^2 e_t; :attr:`BenchStatus.scales` has what they are in SI units.
"""

from . import messages
from ._bench import Answer, Bench, Event, Refused, attach
from ._block import Block
from ._control import Controller
from ._root import NoBench, Root, WhirlError

__all__ = ["Answer", "Bench", "Block", "Controller", "Event", "NoBench", "Refused", "Root", "WhirlError", "attach", "messages"]
