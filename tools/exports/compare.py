#!/usr/bin/env python3
"""Score what several Blenders export of the example vehicles, and compare the entropies.

usage: tools/exports/compare.py BLENDER...

A BLENDER is a command that starts one, or a Python that has bpy. Each exports both vehicles in
every format that it has, with default settings; each file is the vehicle of one study. The table
has the entropies. The exit status is 1 when one differs from the scene's own in its first six
digits, or a Blender exported nothing.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

import pe_core as pe  # noqa: E402

INSIDE = Path(__file__).with_name("inside.py")
SPACE = pe.PerceptionSpace((-20.0, 20.0), (-10.0, 10.0), (0.0, 3.0), 0.5)
STUDIES = {"sedan": "1_pandar64", "bus": "3_default"}
SIX_DIGITS = 2e-6
TIMEOUT_S = 300


def main(blenders: list[str]) -> int:
    """Compare, and print a table."""
    worst = 0.0
    silent = []
    for name, study_name in STUDIES.items():
        path = ROOT / "blend_assets" / "experiments" / f"{study_name}.toml"
        study = replace(pe.load_study(path), space=SPACE)
        study = replace(study, vehicle=replace(study.vehicle, glass=()))
        own = study.evaluator().entropy(study.rig)
        print(f"\n{name}: {own:.9f} of the scene itself")
        for blender in blenders:
            rows = list(exported(blender, name, study))
            silent += [] if any(entropy is not None for *_, entropy, _ in rows) else [blender]
            for version, ending, entropy, said in rows:
                apart = abs(entropy / own - 1.0) if entropy is not None else 0.0
                worst = max(worst, apart)
                told = said if entropy is None else f"{entropy:.9f}  {apart:.1e}"
                print(f"  {version:14} {ending:5} {told}")
    print(f"\nlargest relative difference {worst:.1e}")
    return int(worst > SIX_DIGITS or bool(silent))


def exported(
    blender: str, name: str, study: pe.Study
) -> Iterator[tuple[str, str, float | None, str]]:
    """Yield version, format, entropy and what went wrong, for each format of one Blender."""
    with tempfile.TemporaryDirectory(dir=ROOT) as folder:
        blend = str(ROOT / "blend_assets" / f"{name}.blend")
        answer = subprocess.run(
            [blender, *started(blender), blend, folder],
            capture_output=True,
            text=True,
            timeout=TIMEOUT_S,
        )
        lines = [line.split("\t") for line in answer.stdout.splitlines() if "EXPORT\t" in line]
        if not lines:
            yield blender, "", None, (answer.stderr.strip().splitlines() or ["nothing said"])[-1]
        for _, version, ending, said in lines:
            if said:
                yield version, ending, None, said
            else:
                yield version, ending, *entropy_of(Path(folder) / f"{name}.{ending}", study)


def started(blender: str) -> list[str]:
    """Return the arguments before the script's own."""
    if "python" in Path(blender).name:
        return [str(INSIDE)]
    return ["-b", "--factory-startup", "--python-exit-code", "3", "--python", str(INSIDE), "--"]


def entropy_of(path: Path, study: pe.Study) -> tuple[float | None, str]:
    """Return a study's entropy with a file's vehicle, or why there is none."""
    data = pe.study_to_dict(study)
    data["vehicle"] = {"mesh": path.name}
    try:
        again = pe.study_from_dict(data, folder=path.parent)
        return again.evaluator().entropy(again.rig), ""
    except pe.InputError as error:
        return None, str(error)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
