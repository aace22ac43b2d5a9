"""Ranges, Doppler frequencies and C/N0 of the blocks on standard input, as pysbf2 1.0.7 reads them.

pysbf2 reads and scales the fields; the sums are those that its definition of MeasEpoch quotes from
the maker's guide. Two of its fields are signed in the guide and unsigned there.
"""
import csv
import io
import sys

from pysbf2 import SBFReader

CHIP = 10.23
# Frequencies of the signals in the recording, MHz.
MHZ = {0: 154 * CHIP, 1: 154 * CHIP, 2: 120 * CHIP, 3: 120 * CHIP, 4: 115 * CHIP, 17: 154 * CHIP, 20: 115 * CHIP,
       21: 118 * CHIP, 28: 152.6 * CHIP, 29: 118 * CHIP, 30: 124 * CHIP}


def frequency(signal, high):
    if signal in (8, 9):
        return 1602 + (high - 8) * 0.5625
    if signal in (10, 11):
        return 1246 + (high - 8) * 0.4375
    return MHZ[signal]


def signed(scaled, step, bits):
    return scaled - step * (1 << bits) if scaled >= step * (1 << (bits - 1)) else scaled


def cn0(signal, scaled):
    return scaled + (0 if signal in (1, 2) else 10)


out = csv.writer(sys.stdout, lineterminator="\n")
out.writerow(["tow_ms", "svid", "signal", "high", "range_m", "doppler_hz", "cn0_dbhz"])
for _, block in SBFReader(io.BytesIO(sys.stdin.buffer.read())):
    if getattr(block, "identity", None) != "MeasEpoch":
        continue
    for n in range(1, block.N1 + 1):
        def first(name):
            return getattr(block, f"{name}_{n:02d}")

        svid, signal, high = first("SVID"), first("SigIdxLo"), first("SigIdxHi")
        if 107 <= svid <= 140:
            continue
        range_m, doppler = first("CodeMSB") + first("CodeLSB"), first("Doppler")
        out.writerow([block.TOW, svid, signal, high, f"{range_m:.3f}", f"{doppler:.4f}", cn0(signal, first("CN0"))])
        for m in range(1, first("N2") + 1):
            def other(name):
                return getattr(block, f"{name}_{n:02d}_{m:02d}")

            further = other("SigIdxLo")
            code = signed(other("CodeOffsetMSB"), 65.536, 3)
            shift = signed(other("DopplerOffsetMSB"), 6.5536, 5)
            if (code, other("CodeOffsetLSB")) == (-262.144, 0):
                continue
            # Only the first signal states the channel of GLONASS.
            ratio = frequency(further, high) / frequency(signal, high)
            has_doppler = (round(shift, 4), other("DopplerOffsetLSB")) != (-104.8576, 0)
            value = f"{doppler * ratio + shift + other('DopplerOffsetLSB'):.5f}" if has_doppler else ""
            out.writerow([block.TOW, svid, further, high, f"{range_m + code + other('CodeOffsetLSB'):.3f}", value,
                          cn0(further, other("CN0"))])
