"""Binary layers and packages of OpenUSD (.usdc, .usdz), by usd-core."""

import tempfile
from collections.abc import Mapping
from pathlib import Path

from pxr import Sdf, Tf, Usd, UsdUtils

from pe_core.base.errors import InputError

HEAVY = ("points", "faceVertexCounts", "faceVertexIndices", "normals", "primvars:st", "extent")
"""Attributes of meshes, which no rig needs: they are left out of a layer's text."""


def text_of_binary(path: Path) -> str:
    """Return a binary layer or package as the text of one layer, with all that it refers to."""
    diagnostics = UsdUtils.CoalescingDiagnosticDelegate()  # while it exists, USD prints nothing
    try:
        layer = Usd.Stage.Open(str(path)).Flatten()
        meshes = []
        layer.Traverse("/", lambda at: meshes.append(at) if at.IsPrimPath() else None)
        for at in meshes:
            spec = layer.GetPrimAtPath(at)
            for name in HEAVY:
                if spec is not None and name in spec.properties:
                    spec.RemoveProperty(spec.properties[name])
        text: str = layer.ExportToString()
        return text
    except Tf.ErrorException as error:
        raise InputError(path, "file", "USD", " ".join(str(error).split())) from error
    finally:
        del diagnostics


def packed(files: Mapping[str, bytes], suffix: str) -> dict[str, bytes]:
    """Return written layers with the first as a binary one (.usdc), or all as a package (.usdz)."""
    with tempfile.TemporaryDirectory() as folder:
        first, *others = files
        for name, data in files.items():
            (Path(folder) / name).write_bytes(data)
        root = str(Path(folder) / first)
        binary = Path(folder) / f"packed{suffix}"
        if suffix == ".usdz":
            UsdUtils.CreateNewUsdzPackage(Sdf.AssetPath(root), str(binary))
            return {first: binary.read_bytes()}
        Sdf.Layer.FindOrOpen(root).Export(str(binary))
        return {first: binary.read_bytes(), **{name: files[name] for name in others}}
