# SPDX-License-Identifier: Apache-2.0
"""Errors of Trocar as exceptions."""
from __future__ import annotations

import re
from typing import Optional, Union

from ._trocar import error_table

_TEXT = re.compile(r"(E-[A-Z]+-[0-9]{3}) (.*)", re.DOTALL)


class Error(Exception):
    """What Trocar refuses. ``code`` is stable ("E-ENV-001"); ``trocar errors`` lists all.

    It can also be made of its own text, or of another error, as programs do that hand errors from process to process.
    ``code`` is "" where a text begins with none.
    """

    def __init__(self, code: Union[str, Exception], message: Optional[str] = None, meaning: Optional[str] = None) -> None:
        if message is None:
            text = str(code)
            found = _TEXT.fullmatch(text)
            code, message = found.groups() if found else ("", text)
        super().__init__(f"{code} {message}" if code else message)
        self.code = str(code)
        self.message = message
        self.meaning = error_table().get(self.code, "") if meaning is None else meaning

    @property
    def remedy(self) -> str:
        """What to do next: the last part of the message."""
        return self.message.rsplit("; ", 1)[-1].rsplit(": ", 1)[-1]

    def __reduce__(self):
        return type(self), (self.code, self.message, self.meaning)


def closed(what: str) -> Error:
    return Error("E-ENV-002", f"this {what} is closed; make another one")
