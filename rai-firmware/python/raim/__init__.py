"""Receiver autonomous integrity monitoring: may a GNSS position be trusted?

`judge` and `araim` take corrected ranges as numpy arrays, `replay` the bytes of a receiver.
"""

from ._judge import Judgements, araim, judge
from ._library import RefusedError, version
from ._replay import Replay, replay

__all__ = ["Judgements", "RefusedError", "Replay", "araim", "judge", "replay", "version"]
