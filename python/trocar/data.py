# SPDX-License-Identifier: Apache-2.0
"""Where the delivered tasks and patients are, of a package that was installed from a wheel: in it."""
from __future__ import annotations

from pathlib import Path

from . import _trocar

FOLDER = Path(__file__).parent / "share"
if (FOLDER / "scenes").is_dir():
    _trocar.set_data_folder(str(FOLDER))
