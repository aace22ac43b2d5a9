"""The bytes of a receiver in, epochs and satellites out: the module of the chip, on a recording.

A recording has no times of arrival. The first pass reads the times of its epochs; in the second, the bytes of an epoch
arrive at its time, and the module's clock runs between them, so that a gap is the silence that it was.
"""

from __future__ import annotations

import ctypes
import dataclasses
import gzip
import math
import os
from collections.abc import Mapping
from typing import TYPE_CHECKING

from . import _library as c
from ._library import LIBRARY, demand

if TYPE_CHECKING:
    import pandas

# Few enough bytes that no two epochs end in them.
_CHUNK = 64
_TICK_MS = 100
# The longest time to alert is a minute; a longer gap has no other effect.
_LONGEST_GAP_MS = 70_000
_DAY_S = 86_400.0


@dataclasses.dataclass(frozen=True)
class Replay:
    """Output of the module for a recording."""

    epochs: pandas.DataFrame
    """One row for each verdict: time of day in UTC, state, reason, levels, position, velocity, pin.

    With a `KEY`, `osnma_state` is the state in `PRAIO`, and `osnma_proved`, `osnma_unproved` and `osnma_false` count the
    Galileo satellites in view by what is known of their ephemerides, never of their ranges. `osnma_oldest_proof_s` is NaN
    without a proof.
    """
    satellites: pandas.DataFrame
    """One row for each satellite that is tracked in an epoch, as in the table of `rai replay --satellites`.

    `epoch` is the row of `epochs`. `azimuth_deg` counts from north over east, `elevation_deg` from the horizon. `cn0_dbhz`
    is that of the strongest signal. `residual_m` is the range minus distance and receiver clock, `sigma_m` its standard
    deviation, `w_test` the residual over its own standard deviation. `is_used` is true for a part of the position, and
    `reason` names the treatment, for example "below the elevation mask". Unknown values are NaN.
    """
    counters: dict[str, int]
    """Counters by name: unused input by its reason, verdicts."""
    sentences: list[str]
    """Everything that the module has sent."""


def replay(path: str | os.PathLike[str], settings: Mapping[str, str] | None = None) -> Replay:
    """Runs the module on a recording: UBX, SBF or RTCM 3, also mixed, plain or gz.

    `settings` are keys of the module and their values: `{"PHASE": "LPV200", "OUTPUT": "RMC,1"}`.

    Raises `RefusedError` for a setting that the module refuses, and `ImportError` without pandas.
    """
    import pandas

    name = os.fspath(path)
    with gzip.open(name) if name.endswith(".gz") else open(name, "rb") as file:
        data = file.read()
    module = _Module(settings or {})
    times = [(end, row["time_s"]) for end, row, _ in _pass(module, data, []) if not math.isnan(row["time_s"])]
    module = _Module(settings or {})
    rows = list(_pass(module, data, _arrivals(times)))
    satellites = [{"epoch": number} | known for number, (_, _, seen) in enumerate(rows) for known in seen]
    columns = ["epoch", "satellite", "azimuth_deg", "elevation_deg", "cn0_dbhz", "residual_m", "sigma_m", "w_test"]
    columns += ["is_used", "reason"]
    return Replay(
        epochs=pandas.DataFrame([row for _, row, _ in rows]),
        satellites=pandas.DataFrame(satellites, columns=columns),
        counters=module.counters(),
        sentences=module.sentences,
    )


def _arrivals(times: list[tuple[int, float]]) -> list[tuple[int, int]]:
    """Returns where each epoch ends, and its time since the first, ms, over midnight and never backwards."""
    arrivals, day, before, last_ms = [], 0.0, None, 0
    for end, time_s in times:
        if before is not None and time_s < before - _DAY_S / 2:
            day += _DAY_S
        before = time_s
        last_ms = max(last_ms, round((day + time_s - times[0][1]) * 1000))
        arrivals.append((end, last_ms))
    return arrivals


def _pass(module: _Module, data: bytes, arrivals: list[tuple[int, int]]):
    """Feeds a recording; yields the place, the epoch and its satellites after each verdict.

    `arrivals` are the places at which epochs end, with their times; without them the clock stands still.
    """
    now_ms, start = 0, 0
    for end, time_ms in [*arrivals, (len(data), arrivals[-1][1] if arrivals else 0)]:
        now_ms = max(now_ms, time_ms - _LONGEST_GAP_MS)
        while now_ms < time_ms:
            now_ms = min(now_ms + _TICK_MS, time_ms)
            yield from ((start, *verdict) for verdict in module.tick(now_ms))
        while start < end:
            # In the first pass an epoch ends at a byte, so that in the second no pause cuts a frame.
            chunk = data[start : min(start + _CHUNK, end)]
            taken, verdicts = module.feed(chunk, now_ms, is_exact=not arrivals)
            start += taken
            yield from ((start, *verdict) for verdict in verdicts)
    if arrivals:
        yield from ((len(data), *verdict) for verdict in module.tick(now_ms + 5 * _TICK_MS))


class _Module:
    """A receiver of the C interface."""

    def __init__(self, settings: Mapping[str, str]):
        self.sentences: list[str] = []
        self._room = ctypes.create_string_buffer(16384)
        self._text = c.Text(ctypes.addressof(self._room), len(self._room), 0, 0)
        self._memory = c.memory(LIBRARY.rai_receiver_size())
        self._judged = ctypes.c_uint8()
        self._verdict, self._accuracy, self._velocity = c.Verdict(), c.Accuracy(), c.Velocity()
        self._authentication = c.Authentication()
        self._time_s, self._watched = ctypes.c_double(), ctypes.c_size_t()
        self._seen, self._count = (c.Seen * c.MAX_SEEN)(), ctypes.c_size_t()
        demand(LIBRARY.rai_receiver_init(self._memory, ctypes.sizeof(self._memory), self._text))
        self._said()
        for key, values in settings.items():
            demand(LIBRARY.rai_receiver_set(self._memory, key.encode(), str(values).encode(), self._text))
            self._said()

    def feed(self, chunk: bytes, now_ms: int, is_exact: bool):
        """Takes bytes; returns how many, and the verdicts. If their place must be exact, it takes none behind a verdict."""
        if not is_exact:
            self._gnss(chunk, now_ms)
            return len(chunk), list(self._verdicts())
        for taken in range(1, len(chunk) + 1):
            self._gnss(chunk[taken - 1 : taken], now_ms)
            if self._judged.value:
                return taken, list(self._verdicts())
        return len(chunk), list(self._verdicts())

    def _gnss(self, chunk: bytes, now_ms: int) -> None:
        demand(LIBRARY.rai_receiver_gnss(self._memory, chunk, len(chunk), now_ms, self._text, self._judged))

    def tick(self, now_ms: int):
        """Advances the time; yields a verdict if there is one."""
        demand(LIBRARY.rai_receiver_tick(self._memory, now_ms, self._text))
        return self._verdicts()

    def counters(self) -> dict[str, int]:
        """Returns all counters by name."""
        counters, counter = {}, c.Counter()
        while LIBRARY.rai_receiver_counter(self._memory, len(counters), counter) == 0:
            counters[counter.name.decode()] = counter.value
        return counters

    def _said(self) -> None:
        if self._text.length > 0:
            self.sentences.extend(self._room.raw[: self._text.length].decode("ascii", "replace").splitlines())
            self._text.length = 0

    def _verdicts(self):
        self._said()
        before = self._watched.value
        demand(LIBRARY.rai_receiver_watched(self._memory, self._time_s, self._watched))
        if self._watched.value != before:
            yield self._row(self._time_s.value), self._satellites()

    def _row(self, time_s: float) -> dict[str, object]:
        for call, struct in (
            (LIBRARY.rai_receiver_report, self._verdict),
            (LIBRARY.rai_receiver_accuracy, self._accuracy),
            (LIBRARY.rai_receiver_velocity, self._velocity),
            (LIBRARY.rai_receiver_authentication, self._authentication),
        ):
            demand(call(self._memory, struct))
        verdict, accuracy, velocity = self._verdict, self._accuracy, self._velocity
        excluded = verdict.excluded[: verdict.excluded_count]
        row: dict[str, object] = {"time_s": time_s, "state": c.STATES[verdict.state], "reason": c.reason(verdict.reason)}
        row |= {name: getattr(verdict, name) for name in ("tracked", "used", "dof", "statistic", "threshold")}
        row |= {name: getattr(verdict, name) for name in ("hpl_m", "vpl_m", "x_m", "y_m", "z_m", "height_m")}
        row |= {"latitude_deg": math.degrees(verdict.latitude_rad), "longitude_deg": math.degrees(verdict.longitude_rad)}
        row |= {name: getattr(accuracy, name) for name in ("hdop", "vdop", "residual_rms_m")}
        row |= {name: getattr(velocity, name) for name in ("east_m_s", "north_m_s", "up_m_s")}
        row["excluded"] = " ".join(f"{known.system.decode()}{known.number:02}" for known in excluded)
        known = self._authentication
        row |= {"osnma_state": c.OSNMA[known.state], "osnma_proved": known.proved, "osnma_unproved": known.unproved}
        row |= {"osnma_false": known.false_count, "osnma_oldest_proof_s": known.oldest_proof_s}
        row["pin"] = bool(LIBRARY.rai_receiver_pin(self._memory))
        return row

    def _satellites(self) -> list[dict[str, object]]:
        demand(LIBRARY.rai_receiver_satellites(self._memory, self._seen, c.MAX_SEEN, self._count))
        return [
            {
                "satellite": f"{known.system.decode()}{known.number:02}",
                "azimuth_deg": math.degrees(known.azimuth_rad),
                "elevation_deg": math.degrees(known.elevation_rad),
                "cn0_dbhz": known.cn0_dbhz,
                "residual_m": known.residual_m,
                "sigma_m": known.sigma_m,
                "w_test": known.w_test,
                "is_used": known.fate == 0,
                "reason": c.fate(known.fate),
            }
            for known in self._seen[: self._count.value]
        ]
