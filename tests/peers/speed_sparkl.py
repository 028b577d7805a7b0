"""Builds sparkl 0.4.0 with one line corrected, without which it panics, and the program in sparkl/ that runs it.

As published, `SpGrid::new` maps `2 ^ 30` bytes for its grid, which is an exclusive or and gives 28 bytes, too few for a node.
"""

import json
import pathlib
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
OUT = HERE.parent.parent / "out" / "peers"
WRONG, RIGHT = "MmapMut::map_anon(2 ^ 30)", "MmapMut::map_anon(1 << 30)"


def build():
    """Builds the program and returns its path."""
    corrected = OUT / "sparkl3d"
    if not corrected.exists():
        correct(published(), corrected)
    command = ["cargo", "build", "--release", "--manifest-path", HERE / "sparkl" / "Cargo.toml", "--target-dir", OUT / "sparkl"]
    run([*command, "--quiet"])
    return OUT / "sparkl" / "release" / "peer-sparkl"


def published():
    """Returns the folder of sparkl3d as published, which cargo downloads."""
    project = OUT / "sparkl-fetch"
    (project / "src").mkdir(parents=True, exist_ok=True)
    (project / "src" / "lib.rs").touch()
    manifest = project / "Cargo.toml"
    manifest.write_text('[package]\nname = "fetch"\nversion = "0.1.0"\n[workspace]\n[dependencies]\nsparkl3d = "=0.4.0"\n')
    metadata = json.loads(run(["cargo", "metadata", "--format-version", "1", "--manifest-path", manifest]))
    paths = (package["manifest_path"] for package in metadata["packages"] if package["name"] == "sparkl3d")
    return pathlib.Path(next(paths)).parent


def correct(source, target):
    """Copies the crate and corrects the line."""
    shutil.copytree(source, target)
    file = target / "src" / "geometry" / "sp_grid.rs"
    text = file.read_text()
    if WRONG not in text:
        shutil.rmtree(target)
        sys.exit(f"{file}: expected {WRONG}")
    file.write_text(text.replace(WRONG, RIGHT))


def run(command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(done.stderr)
    return done.stdout


def measure(job):
    """Returns the particle-steps per second of one run."""
    numbers = (job["cells"], job["threads"], job["seconds"], job["sound_speed"], job["dt"])
    return json.loads(run([build(), *numbers]))
