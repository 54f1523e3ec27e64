"""The plugin `examples/plugin`, installed for all tests: before anything looks for plugins."""

import sys
import tempfile
import tomllib
from pathlib import Path

EXAMPLE_PLUGIN = Path(__file__).parents[1] / "examples" / "plugin"


def plugin_site():
    """Return the folder that installs `examples/plugin`: its entry points, as pip writes them."""
    project = tomllib.loads((EXAMPLE_PLUGIN / "pyproject.toml").read_text("utf-8"))["project"]
    site = Path(tempfile.mkdtemp(prefix="pe-plugin-"))
    info = site / f"{project['name'].replace('-', '_')}-{project['version']}.dist-info"
    info.mkdir()
    head = f"Metadata-Version: 2.1\nName: {project['name']}\nVersion: {project['version']}\n"
    (info / "METADATA").write_text(head)
    points = project["entry-points"]["perception_entropy.plugins"].items()
    lines = "".join(f"{name} = {to}\n" for name, to in points)
    (info / "entry_points.txt").write_text(f"[perception_entropy.plugins]\n{lines}")
    return site


PLUGIN_SITE = plugin_site()
sys.path[:0] = [str(PLUGIN_SITE), str(EXAMPLE_PLUGIN)]
