# SPDX-License-Identifier: Apache-2.0
"""The wheel in a bare virtual environment with numpy alone: test_wheel.py BUILD/python/trocar"""
import os
import pathlib
import subprocess
import sys
import tempfile
import zipfile

import numpy

PACKAGE, ROOT = pathlib.Path(sys.argv[1]), pathlib.Path(__file__).resolve().parents[2]
USE = """
import pathlib, sys
import numpy
import trocar
home = pathlib.Path(sys.prefix)
assert home in pathlib.Path(trocar.__file__).parents, trocar.__file__
assert home in trocar.find("peg_transfer").parents, trocar.find("peg_transfer")
with trocar.make("peg_transfer", actions="tip", render_mode="rgb_array", render_size=(64, 48)) as env:
    trocar.check_env(env, steps=2)
    assert env.render().std() > 5
simulation = trocar.Simulation("cholecystectomy")
simulation.step(simulation.home(), ticks=2)
assert simulation.snapshot()["organs"]["gallbladder"]["volume"] > 1e-6
try:
    import torch
except ImportError:
    print("bare and works")
"""


def main():
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        made = subprocess.run([sys.executable, ROOT / "tools" / "make-wheel", PACKAGE, "-o", folder], check=True, capture_output=True, text=True).stdout.strip()
        again = subprocess.run([sys.executable, ROOT / "tools" / "make-wheel", PACKAGE, "-o", folder / "again"], check=True, capture_output=True, text=True).stdout.strip()
        assert pathlib.Path(made).read_bytes() == pathlib.Path(again).read_bytes(), "the same files give another wheel"
        with zipfile.ZipFile(made) as archive:
            names = archive.namelist()
            assert archive.testzip() is None and len(names) == len(set(names))
            for wanted in ("trocar/__init__.py", "trocar/py.typed", "trocar/share/scenes/tasks/peg_transfer.json", "trocar/share/assets/patients/visible-human-male/control_points.json"):
                assert wanted in names, f"{wanted} is not in the wheel"
        subprocess.run([sys.executable, "-m", "venv", folder / "bare"], check=True)
        python = folder / "bare" / "bin" / "python"
        packages = pathlib.Path(subprocess.run([python, "-c", 'import sysconfig; print(sysconfig.get_path("platlib"))'], check=True,
                                               capture_output=True, text=True).stdout.strip())
        # Debian's numpy and nothing else of Debian's: there is no network here
        installed = pathlib.Path(numpy.__file__).parent
        for path in (installed, *installed.parent.glob("numpy-*-info")):
            (packages / path.name).symlink_to(path)
        environment = {"PATH": os.environ["PATH"], "HOME": str(folder), "PYTHONDONTWRITEBYTECODE": "1"}
        subprocess.run([python, "-m", "pip", "install", "--no-index", "--disable-pip-version-check", "--quiet", made], check=True, cwd=folder, env=environment)
        used = subprocess.run([python, "-c", USE], check=True, cwd=folder, env=environment, capture_output=True, text=True)
        assert used.stdout == "bare and works\n", used.stdout
        subprocess.run([python, "-m", "pip", "uninstall", "--yes", "--quiet", "trocar"], check=True, cwd=folder, env=environment)
        assert not list(packages.glob("trocar*")), list(packages.glob("trocar*"))
    print("the wheel works in a bare virtual environment")


if __name__ == "__main__":
    main()
