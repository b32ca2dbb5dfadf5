"""Builds the wheel of goingrate with CMake, for `pip install ./apps/python` (PEP 517).

Nothing is fetched: what the library is built with (README, apps/setup.sh) and pybind11 must be
installed. The build is kept in `build/wheel-<version of Python>` of the source tree;
``--config-settings build-dir=DIR`` names another folder, relative to the source's root.
"""

import base64
import hashlib
import os
import re
import subprocess
import sys
import sysconfig
import tempfile
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]


def version() -> str:
    text = (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
    return re.search(r"project\(goingrate VERSION ([0-9.]+)", text)[1]


def tag() -> str:
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    return f"{python}-{python}-{platform}"


def metadata() -> str:
    return (
        "Metadata-Version: 2.1\n"
        "Name: goingrate\n"
        f"Version: {version()}\n"
        "Summary: Fits, diagnoses and simulates pendulum clocks from their timing logs\n"
        "License: GPL-3.0-or-later\n"
        "Requires-Python: >=3.9\n"
        "Requires-Dist: numpy\n"
        "Provides-Extra: tables\n"
        'Requires-Dist: pandas; extra == "tables"\n'
        "Provides-Extra: figures\n"
        'Requires-Dist: matplotlib; extra == "figures"\n'
    )


def built(config_settings) -> Path:
    """Builds and installs the package; returns the folder it is in."""
    usual = ROOT / "build" / f"wheel-{sys.version_info.major}.{sys.version_info.minor}"
    build = (ROOT / (config_settings or {}).get("build-dir", usual)).resolve()
    place = Path(tempfile.mkdtemp(prefix="goingrate-"))
    commands = (
        ["-S", str(ROOT), "-B", str(build), "-DCMAKE_BUILD_TYPE=Release", "-DGOINGRATE_PYTHON=ON",
         f"-DPython_EXECUTABLE={sys.executable}"],
        ["--build", str(build), "--target", "goingrate_python", "--parallel",
         os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL", str(os.cpu_count() or 1))],
        ["--install", str(build), "--component", "python", "--prefix", str(place)],
    )
    for words in commands:
        subprocess.run(["cmake", *words], check=True, stdout=sys.stderr)
    return place / "lib/python3/dist-packages"


def files_of(config_settings) -> dict:
    """The content of each file of the wheel, by its place there."""
    packages = built(config_settings)
    files = {
        path.relative_to(packages).as_posix(): path.read_bytes()
        for path in sorted(packages.rglob("*")) if path.is_file()
    }
    info = f"goingrate-{version()}.dist-info"
    files[f"{info}/METADATA"] = metadata().encode()
    files[f"{info}/WHEEL"] = (
        f"Wheel-Version: 1.0\nGenerator: goingrate\nRoot-Is-Purelib: false\nTag: {tag()}\n"
    ).encode()
    files[f"{info}/LICENSE"] = (ROOT / "LICENSE").read_bytes()
    record = "".join(
        f"{name},sha256={digest(content)},{len(content)}\n" for name, content in files.items()
    )
    files[f"{info}/RECORD"] = (record + f"{info}/RECORD,,\n").encode()
    return files


def digest(content: bytes) -> str:
    return base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """Writes the metadata alone: without this hook pip would build twice, first for the name."""
    info = Path(metadata_directory) / f"goingrate-{version()}.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(metadata(), encoding="utf-8")
    return info.name


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    name = f"goingrate-{version()}-{tag()}.whl"
    with zipfile.ZipFile(Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for place, content in files_of(config_settings).items():
            wheel.writestr(place, content)
    return name


def build_sdist(sdist_directory, config_settings=None):
    raise SystemExit("goingrate's package is built from the whole source: pip install ./apps/python")
