"""Who follows a long call: a callback, or a bar where tqdm is installed."""

from __future__ import annotations

from importlib import import_module
from types import TracebackType
from typing import Callable, Optional, Protocol, Type, Union

from ._voidwalk import Progress

#: What may follow a long call: a callback, ``True`` for a bar where tqdm is installed, or nothing.
Follower = Union[None, bool, Callable[[Progress], object]]


class _Bar(Protocol):
    """What is used of a bar of tqdm."""

    total: Optional[float]
    n: float

    def set_postfix_str(self, s: str, refresh: bool) -> None: ...
    def set_description_str(self, desc: str, refresh: bool) -> None: ...
    def refresh(self) -> object: ...
    def close(self) -> None: ...


class Following:
    """Hands a follower on to the library, and closes a bar whatever ends the call."""

    def __init__(self, progress: Follower) -> None:
        self.bar: Optional[_Bar] = None
        self.callback: Optional[Callable[[Progress], object]] = None
        if progress is True:
            try:
                tqdm = import_module("tqdm.auto")
            except ImportError:
                return
            self.bar = tqdm.tqdm(unit="run", leave=False)
            self.callback = self._show
        elif callable(progress):
            self.callback = progress
        elif progress:
            raise ValueError(f"progress = {progress!r} is not allowed; a function, True or None")

    def _show(self, progress: Progress) -> None:
        if self.bar is None:
            return
        self.bar.total = progress.total or None
        self.bar.n = progress.done
        if progress.stage == "walking":
            self.bar.set_postfix_str(f"{progress.moving} moving", refresh=False)
        else:
            self.bar.set_description_str(progress.stage, refresh=False)
        self.bar.refresh()

    def __enter__(self) -> Optional[Callable[[Progress], object]]:
        return self.callback

    def __exit__(
        self,
        kind: Optional[Type[BaseException]],
        error: Optional[BaseException],
        trace: Optional[TracebackType],
    ) -> None:
        if self.bar is not None:
            self.bar.close()
