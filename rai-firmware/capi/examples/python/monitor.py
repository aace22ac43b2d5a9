"""The monitor from Python, through the shared library: seven satellites, with an error of 80 m on G05.

    cargo rustc --release -p rai-capi --lib --crate-type cdylib
    python3 rai-firmware/capi/examples/python/monitor.py target/release/librai.so
"""

import ctypes
import math
import sys

STATE_PROTECTED = 1
PHASE_NPA = 2


class Settings(ctypes.Structure):
    """`rai_settings_t`."""

    _fields_ = [
        ("size", ctypes.c_uint32),
        ("policy", ctypes.c_uint8),
        ("method", ctypes.c_uint8),
        ("clock_aid", ctypes.c_uint8),
        ("levels", ctypes.c_uint8),
        ("hal_m", ctypes.c_double),
        ("val_m", ctypes.c_double),
        ("false_alarm", ctypes.c_double),
        ("missed_detection", ctypes.c_double),
        ("max_speed_m_s", ctypes.c_double),
        ("min_height_m", ctypes.c_double),
        ("max_height_m", ctypes.c_double),
        ("recovery_s", ctypes.c_double),
        ("recovery_epochs", ctypes.c_uint16),
        ("reserved", ctypes.c_uint8 * 6),
    ]


class Range(ctypes.Structure):
    """`rai_range_t`."""

    _fields_ = [(name, ctypes.c_double) for name in ("x_m", "y_m", "z_m", "range_m", "sigma_m")] + [
        ("system", ctypes.c_char),
        ("number", ctypes.c_uint8),
        ("reserved", ctypes.c_uint8 * 6),
    ]


class Excluded(ctypes.Structure):
    """`rai_excluded_t`."""

    _fields_ = [
        ("bias_m", ctypes.c_double),
        ("w_test", ctypes.c_double),
        ("system", ctypes.c_char),
        ("number", ctypes.c_uint8),
        ("reserved", ctypes.c_uint8 * 6),
    ]


class Verdict(ctypes.Structure):
    """`rai_verdict_t`."""

    _fields_ = (
        [("size", ctypes.c_uint32)]
        + [
            (name, ctypes.c_uint8)
            for name in ("state", "reason", "tracked", "used", "dof", "excluded_count", "refused_count", "refused_status")
        ]
        + [("reserved", ctypes.c_uint8 * 4)]
        + [
            (name, ctypes.c_double)
            for name in ("statistic", "threshold", "hpl_m", "vpl_m", "x_m", "y_m", "z_m")
            + ("latitude_rad", "longitude_rad", "height_m")
        ]
        + [("excluded", Excluded * 3)]
    )


def demand(library, status):
    """Raises an error for any status except success."""
    if status != 0:
        raise ValueError(library.rai_status_text(status).decode())


def example_ranges():
    """Returns the example of the README: seven satellites 22,000 km away, with an error of 80 m on G05."""
    place = (3_582_105.0, 532_590.0, 5_232_755.0)
    longitude = math.atan2(place[1], place[0])
    flattening = 1 / 298.257223563
    squared = flattening * (2 - flattening)
    latitude = math.atan2(place[2], math.hypot(place[0], place[1]) * (1 - squared))
    for _ in range(10):
        normal = 6378137.0 / math.sqrt(1 - squared * math.sin(latitude) ** 2)
        latitude = math.atan2(place[2] + squared * normal * math.sin(latitude), math.hypot(place[0], place[1]))
    (sin_lat, cos_lat), (sin_lon, cos_lon) = ((math.sin(a), math.cos(a)) for a in (latitude, longitude))
    axes = (
        (-sin_lon, cos_lon, 0.0),
        (-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat),
        (cos_lat * cos_lon, cos_lat * sin_lon, sin_lat),
    )
    directions = [
        (0.0, 0.0, 22e6), (0.0, 17.6e6, 13.2e6), (0.0, -17.6e6, 13.2e6), (17.6e6, 0.0, 13.2e6),
        (-17.6e6, 0.0, 13.2e6), (13.2e6, 10.56e6, 14.08e6), (-10.56e6, 14.08e6, 13.2e6),
    ]
    for number, direction in enumerate(directions, start=1):
        x, y, z = (
            place[i] + sum(part * axis[i] for part, axis in zip(direction, axes)) for i in range(3)
        )
        yield Range(x, y, z, 22e6 + (80.0 if number == 5 else 0.0), 2.0, b"G", number)


def main():
    """Judges the example and prints the verdict."""
    library = ctypes.CDLL(sys.argv[1])
    library.rai_status_text.restype = library.rai_reason_text.restype = ctypes.c_char_p
    library.rai_monitor_size.restype = ctypes.c_size_t

    settings = Settings(size=ctypes.sizeof(Settings))
    demand(library, library.rai_settings_preset(ctypes.byref(settings), PHASE_NPA))
    # Doubles, because the object needs their alignment.
    memory = (ctypes.c_double * ((library.rai_monitor_size() + 7) // 8))()
    demand(library, library.rai_monitor_init(memory, ctypes.c_size_t(ctypes.sizeof(memory)), ctypes.byref(settings)))

    ranges = (Range * 7)(*example_ranges())
    verdict = Verdict(size=ctypes.sizeof(Verdict))
    demand(
        library,
        library.rai_monitor_judge(
            memory, ctypes.c_double(0.0), ranges, ctypes.c_size_t(len(ranges)), ctypes.byref(verdict)
        ),
    )
    print(f"{library.rai_reason_text(verdict.reason).decode()}: "
          f"{verdict.used} of {verdict.tracked} satellites, HPL {verdict.hpl_m:.1f} m")
    for excluded in verdict.excluded[: verdict.excluded_count]:
        print(f"left out: {excluded.system.decode()}{excluded.number:02}, off by {excluded.bias_m:.1f} m")
    return 0 if verdict.state == STATE_PROTECTED else 2


if __name__ == "__main__":
    sys.exit(main())
