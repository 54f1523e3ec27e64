"""The section of the page on what happened to plans and runs, with what the files say of it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..results_file import read_json
from ..wording import joined, table
from .result_files import RUNS, digest_of_files

Json = dict[str, Any]

REPLACED = "replaced"
"""Folder of the results that were replaced."""
LOST = ("2961cc86fabd", "6b6e8460e5d0", "cfb485d79bd0")
"""Commits that runs name and that the repository does not have."""


def history(folder: Path, groups: Mapping[str, Mapping[str, Json]]) -> Json:
    """Return what the files say, as JSON data.

    Parameters
    ----------
    folder : Path
        Of the study.
    groups : mapping
        Results by the name of the run, by the folder that has their folder `RUNS`, from `folder`.
    """
    runs = groups["."]
    before = {p.stem: read_json(p) for p in sorted((folder / REPLACED).glob("*.json"))}
    return {
        "replaced": {
            name: {
                "plan": data["plan"],
                "jax": data["made"]["jax"],
                "before": data["ap"],
                "after": runs[name]["ap"],
            }
            for name, data in before.items()
            if name in runs
        },
        "groups": {
            name: {
                "runs": len(results),
                "sha256": digest_of_files(folder / name / RUNS),
                "plan_alone": sum("digest" not in run["made"] for run in results.values()),
                "digests": sorted(
                    {run["made"].get("digest", "") for run in results.values()} - {""}
                ),
                "lost": {
                    commit: count
                    for commit in LOST
                    if (count := sum(run["made"]["commit"] == commit for run in results.values()))
                },
            }
            for name, results in groups.items()
            if results
        },
    }


def history_section(found: Json) -> str:
    """Return the section of the page; empty without the runs that were replaced."""
    replaced, groups = found["replaced"], found["groups"]
    if not replaced:
        return ""
    lines = [
        [
            name,
            f"{row['before']:.3f}",
            f"{row['after']:.3f}",
            f"{row['after'] - row['before']:+.3f}",
        ]
        for name, row in replaced.items()
    ]
    changes = [row["after"] - row["before"] for row in replaced.values()]
    versions = joined(sorted({row["jax"] for row in replaced.values()}))
    plans = joined(sorted({row["plan"] for row in replaced.values()}))
    return f"""
## What happened to the runs

**{len(replaced)} results were replaced under the same digest.** They were computed with JAX {versions}. Then the detector was
written again in TensorFlow, for its speed, and they were computed again: AP {min(changes):+.3f} to {max(changes):+.3f}. The plan's digest
({plans}) did not change, as it is that of `plan.toml` alone. The old files are in the folder
`{REPLACED}`; no figure of this page is computed from them.

{table(["run", "AP, JAX", "AP, TensorFlow", "difference"], lines)}

**Commits are lost.** {_lost(groups)} A part of the history was lost and recovered as one commit, 9fc8c5e. The code of these runs
cannot be looked up.

**The plan of cameras and its first three results are in that same commit.** So the history does not show that the plan
came first. The plans of LiDARs and of the searches have commits of their own, before their first results.

**Digests.** {_digests(groups)}
"""


def _lost(groups: Json) -> str:
    texts = [
        f"{count} runs{'' if name == '.' else f' of {name}'} name {commit}"
        for name, group in groups.items()
        for commit, count in group["lost"].items()
    ]
    return f"{joined(texts)}: the repository does not have these commits." if texts else ""


def _digests(groups: Json) -> str:
    total = sum(group["runs"] for group in groups.values())
    alone = sum(group["plan_alone"] for group in groups.values())
    digests = sorted({d for group in groups.values() for d in group["digests"]})
    newer = f" The others have these: {joined(digests)}." if digests else ""
    files = joined(
        [f"`{'' if n == '.' else n + '/'}runs` {g['sha256']}" for n, g in groups.items()]
    )
    return (
        f"{alone} of {total} runs were made under a digest of their plan alone; code, prior and versions are known as far "
        f"as a commit and the versions in the file tell them. A run from now on has a digest of plan, code, prior and versions.{newer} "
        f"SHA-256 of the files of results, so that a replaced one is noticed: {files}."
    )
