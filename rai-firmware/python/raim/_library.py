"""The shared library of the C interface: its structs and its functions, as `rai.h` declares them."""

from __future__ import annotations

import ctypes
import os
import pathlib
import sys
from ctypes import POINTER, c_char, c_char_p, c_double, c_size_t, c_uint8, c_uint16, c_uint32, c_uint64, c_void_p

ABI_VERSION = 4
MAX_SATELLITES = 48
MAX_SEEN = 64

STATES = {0: "none", 1: "protected", 2: "alert", 3: "unavailable"}
PHASES = {"ENROUTE": 0, "TERMINAL": 1, "NPA": 2, "LPV200": 3}
POLICIES = {"T1": 0, "T2": 1, "TOP": 2}
METHODS = {
    "AUTO": 0, "BAARDA": 1, "SIMULTANEOUS": 2, "SEQUENTIAL": 3, "HYBRID": 4, "GROUPING": 5, "RANSAC": 6, "SEPARATION": 7,
}  # fmt: skip
LEVELS = {"BOUND": 0, "SLOPE": 1}
OSNMA = ["", "NOKEY", "WAIT", "OTHERKEY", "UNSUPPORTED", "UNDATED", "LATER", "DATED", "DONTUSE", "STOPPED", "FALSE"]


class RefusedError(ValueError):
    """A call that the library refused; nothing has changed."""


class _Sized(ctypes.Structure):
    """A struct that begins with its size."""

    def __init__(self):
        super().__init__()
        self.size = ctypes.sizeof(self)


class Settings(_Sized):
    """`rai_settings_t`."""

    _fields_ = (
        [("size", c_uint32)]
        + [(name, c_uint8) for name in ("policy", "method", "clock_aid", "levels")]
        + [(name, c_double) for name in ("hal_m", "val_m", "false_alarm", "missed_detection", "max_speed_m_s")]
        + [(name, c_double) for name in ("min_height_m", "max_height_m", "recovery_s")]
        + [("recovery_epochs", c_uint16), ("reserved", c_uint8 * 6)]
    )


class Excluded(ctypes.Structure):
    """`rai_excluded_t`."""

    _fields_ = [
        ("bias_m", c_double), ("w_test", c_double), ("system", c_char), ("number", c_uint8), ("reserved", c_uint8 * 6),
    ]  # fmt: skip


class Verdict(_Sized):
    """`rai_verdict_t`."""

    _fields_ = (
        [("size", c_uint32)]
        + [(name, c_uint8) for name in ("state", "reason", "tracked", "used", "dof", "excluded_count")]
        + [("refused_count", c_uint8), ("refused_status", c_uint8), ("reserved", c_uint8 * 4)]
        + [(name, c_double) for name in ("statistic", "threshold", "hpl_m", "vpl_m", "x_m", "y_m", "z_m")]
        + [(name, c_double) for name in ("latitude_rad", "longitude_rad", "height_m")]
        + [("excluded", Excluded * 3)]
    )


class Accuracy(_Sized):
    """`rai_accuracy_t`."""

    _fields_ = (
        [("size", c_uint32), ("suspect_system", c_char), ("suspect_number", c_uint8), ("reserved", c_uint8 * 2)]
        + [("suspect_w_test", c_double), ("covariance_m2", c_double * 6)]
        + [(name, c_double) for name in ("hdop", "vdop", "residual_rms_m", "sigma_check")]
        + [(name, c_double) for name in ("gps_clock_m", "glonass_clock_m", "galileo_clock_m", "beidou_clock_m")]
    )


class Velocity(_Sized):
    """`rai_velocity_t`."""

    _fields_ = (
        [("size", c_uint32), ("dof", c_uint8), ("excluded_count", c_uint8), ("reserved", c_uint8 * 2)]
        + [(name, c_double) for name in ("east_m_s", "north_m_s", "up_m_s")]
        + [("covariance_m2_s2", c_double * 6)]
        + [(name, c_double) for name in ("clock_drift_m_s", "horizontal_level_m_s", "vertical_level_m_s")]
        + [(name, c_double) for name in ("statistic", "threshold")]
    )


class Authentication(_Sized):
    """`rai_authentication_t`."""

    _fields_ = (
        [("size", c_uint32)]
        + [(name, c_uint8) for name in ("state", "key", "chain", "proved", "unproved", "false_count")]
        + [("reserved", c_uint8 * 6), ("oldest_proof_s", c_double)]
    )


class Residual(ctypes.Structure):
    """`rai_residual_t`."""

    _fields_ = [
        ("residual_m", c_double), ("sigma_m", c_double), ("system", c_char), ("number", c_uint8), ("is_used", c_uint8),
        ("reserved", c_uint8 * 5),
    ]  # fmt: skip


class Seen(ctypes.Structure):
    """`rai_seen_t`, which is not part of the header."""

    _fields_ = [(name, c_double) for name in ("azimuth_rad", "elevation_rad", "cn0_dbhz", "residual_m", "sigma_m", "w_test")] + [
        ("system", c_char), ("number", c_uint8), ("fate", c_uint8), ("reserved", c_uint8 * 5),
    ]  # fmt: skip


class Counter(_Sized):
    """`rai_counter_t`."""

    _fields_ = [("size", c_uint32), ("value", c_uint32), ("name", c_char * 36)]


class Text(ctypes.Structure):
    """`rai_text_t`."""

    _fields_ = [("bytes", c_void_p), ("capacity", c_size_t), ("length", c_size_t), ("lost", c_size_t)]


_STATUS = c_uint8
_FUNCTIONS = {
    "rai_abi_version": (c_uint32, []),
    "rai_version": (c_char_p, []),
    "rai_status_text": (c_char_p, [_STATUS]),
    "rai_reason_text": (c_char_p, [c_uint8]),
    "rai_settings_preset": (_STATUS, [POINTER(Settings), c_uint8]),
    "rai_monitor_size": (c_size_t, []),
    "rai_monitor_init": (_STATUS, [c_void_p, c_size_t, POINTER(Settings)]),
    "rai_monitor_forget": (_STATUS, [c_void_p]),
    "rai_monitor_judge": (_STATUS, [c_void_p, c_double, c_void_p, c_size_t, POINTER(Verdict)]),
    "rai_monitor_accuracy": (_STATUS, [c_void_p, POINTER(Accuracy)]),
    "rai_monitor_residuals": (_STATUS, [c_void_p, POINTER(Residual), c_size_t, POINTER(c_size_t)]),
    "rai_receiver_size": (c_size_t, []),
    "rai_receiver_init": (_STATUS, [c_void_p, c_size_t, POINTER(Text)]),
    "rai_receiver_gnss": (_STATUS, [c_void_p, c_char_p, c_size_t, c_uint64, POINTER(Text), POINTER(c_uint8)]),
    "rai_receiver_tick": (_STATUS, [c_void_p, c_uint64, POINTER(Text)]),
    "rai_receiver_set": (_STATUS, [c_void_p, c_char_p, c_char_p, POINTER(Text)]),
    "rai_receiver_pin": (c_uint8, [c_void_p]),
    "rai_receiver_report": (_STATUS, [c_void_p, POINTER(Verdict)]),
    "rai_receiver_accuracy": (_STATUS, [c_void_p, POINTER(Accuracy)]),
    "rai_receiver_velocity": (_STATUS, [c_void_p, POINTER(Velocity)]),
    "rai_receiver_authentication": (_STATUS, [c_void_p, POINTER(Authentication)]),
    "rai_receiver_satellites": (_STATUS, [c_void_p, POINTER(Seen), c_size_t, POINTER(c_size_t)]),
    "rai_receiver_watched": (_STATUS, [c_void_p, POINTER(c_double), POINTER(c_size_t)]),
    "rai_fate_text": (c_void_p, [c_uint8, POINTER(c_size_t)]),
    "rai_receiver_counter": (_STATUS, [c_void_p, c_size_t, POINTER(Counter)]),
}


def _path() -> str:
    """Returns the path of the library: that of `RAI_LIBRARY`, or the one in the package."""
    ending = {"darwin": "dylib", "win32": "dll"}.get(sys.platform, "so")
    return os.environ.get("RAI_LIBRARY") or str(pathlib.Path(__file__).with_name(f"librai.{ending}"))


def _load() -> ctypes.CDLL:
    library = ctypes.CDLL(_path())
    for name, (result, arguments) in _FUNCTIONS.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    found = library.rai_abi_version()
    if found != ABI_VERSION:
        raise ImportError(f"the library must have version {ABI_VERSION} of the interface, not {found}")
    return library


LIBRARY = _load()


def version() -> str:
    """Returns the version of the library."""
    return LIBRARY.rai_version().decode()


def demand(status: int) -> None:
    """Raises `RefusedError` with the library's words for any status except success."""
    if status:
        raise RefusedError(LIBRARY.rai_status_text(status).decode())


def reason(number: int) -> str:
    """Returns the word of a reason, as in the sentences."""
    return LIBRARY.rai_reason_text(number).decode()


def fate(number: int) -> str:
    """Returns the words of a satellite's treatment, as in the table of `rai replay --satellites`."""
    length = c_size_t()
    return ctypes.string_at(LIBRARY.rai_fate_text(number, length), length.value).decode()


def memory(size: int) -> ctypes.Array:
    """Returns memory for an object, aligned for every field."""
    return (c_uint64 * (-(-size // 8)))()


def choice(name: str, words: dict[str, int], value: str) -> int:
    """Returns the number of a word."""
    try:
        return words[value.upper()]
    except KeyError:
        raise ValueError(f"{name} must be one of {', '.join(words)}, not {value!r}") from None
