"""How long work tells of its progress: not at all, on standard error, or to whoever asks."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

Tell = Callable[[str, int, int], object]
"""Is called with what is being done, as "sunlight", steps done, and steps in all."""
Progress = bool | Tell | None

_PATIENCE_S = 1.0
"""Work that takes less shows nothing."""


class _Shown:
    """A line on standard error for the stage at hand: by tqdm, which suits notebooks too, if it is installed, else by hand."""

    def __init__(self) -> None:
        try:
            from tqdm.auto import tqdm
        except ImportError:
            tqdm = None
        self._tqdm: Any = tqdm
        self._bar: Any = None
        self._stage: str | None = None
        self._began = time.monotonic()
        self._width = 0

    def __call__(self, stage: str, done: int, total: int) -> None:
        if time.monotonic() - self._began < _PATIENCE_S:
            return
        if stage != self._stage:
            self.end()
            self._stage = stage
        if self._tqdm is not None:
            if self._bar is None:
                self._bar = self._tqdm(total=total, desc=stage, leave=False)
            self._bar.total = total
            self._bar.update(done - self._bar.n)
            return
        text = f"{stage}: {100 * done / max(total, 1):3.0f} %"
        sys.stderr.write(f"\r{text:<{self._width}}")
        sys.stderr.flush()
        self._width = len(text)

    def end(self) -> None:
        """Takes the line away."""
        if self._bar is not None:
            self._bar.close()
        elif self._width > 0:
            sys.stderr.write("\r" + " " * self._width + "\r")
            sys.stderr.flush()
        self._bar, self._width = None, 0


@contextmanager
def telling(progress: Progress) -> Iterator[Tell | None]:
    """What the native half calls."""
    if progress is None or progress is False:
        yield None
    elif callable(progress):
        yield progress
    else:
        shown = _Shown()
        try:
            yield shown
        finally:
            shown.end()
