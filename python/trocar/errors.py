# SPDX-License-Identifier: Apache-2.0
"""Errors of Trocar as exceptions."""


class Error(Exception):
    """What Trocar refuses. ``code`` is stable ("E-ENV-001"); ``trocar errors`` lists all."""

    def __init__(self, code: str, message: str, meaning: str = "") -> None:
        super().__init__(f"{code} {message}")
        self.code = code
        self.message = message
        self.meaning = meaning

    @property
    def remedy(self) -> str:
        """What to do next: the last part of the message."""
        return self.message.rsplit("; ", 1)[-1].rsplit(": ", 1)[-1]

    def __reduce__(self):
        return type(self), (self.code, self.message, self.meaning)


def closed(what: str) -> Error:
    return Error("E-ENV-002", f"this {what} is closed; make another one",
                 "a simulation, environment, pool or camera was called out of turn or in a fork, or is closed")
