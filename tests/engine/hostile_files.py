"""Files that are out to do harm: endless, blocking, unfolding to far more than there is.

Each case is the reader, what makes the file in a folder and returns its path, and words that the
one line of the refusal has to hold (None: the file is fine, and has to be read).
"""

from __future__ import annotations

import io
import json
import os
import socket
import struct
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from tests.engine.mesh_files import FACES, HUGE, POINTS, glb_file, gltf, npz_bytes, ply_header

Maker = Callable[[Path], Path]
Case = tuple[str, Maker, str | None]
SUFFIXES = {"mesh": ".obj", "boxes": ".csv", "angles": ".csv", "table": ".csv", "study": ".toml"}
LIMITS = {"mesh": "2,147,483,648", "boxes": "2,147,483,648"}


def holding(name: str, data: bytes | str) -> Maker:
    """A file of these bytes."""

    def make(folder: Path) -> Path:
        path = folder / name
        path.write_bytes(data.encode("utf-8", "surrogatepass") if isinstance(data, str) else data)
        return path

    return make


def pipe(suffix: str) -> Maker:
    """A named pipe that nobody writes to."""

    def make(folder: Path) -> Path:
        path = folder / f"pipe{suffix}"
        os.mkfifo(path)
        return path

    return make


def link(target: str, suffix: str) -> Maker:
    """A link to something that is there, or not."""

    def make(folder: Path) -> Path:
        path = folder / f"link{suffix}"
        path.symlink_to(target)
        return path

    return make


def sparse(suffix: str) -> Maker:
    """Ten gigabytes of nothing, that take no place on the disk."""

    def make(folder: Path) -> Path:
        path = folder / f"sparse{suffix}"
        path.touch()
        os.truncate(path, 10 * 10**9)
        return path

    return make


def listening(suffix: str) -> Maker:
    """A socket's name in the file system."""

    def make(folder: Path) -> Path:
        here = os.getcwd()
        os.chdir(folder)  # a socket's name may not be long
        try:
            with socket.socket(socket.AF_UNIX) as server:
                server.bind(f"socket{suffix}")
        finally:
            os.chdir(here)
        return folder / f"socket{suffix}"

    return make


def special() -> dict[str, Case]:
    """What is no file at all, for every reader."""
    cases: dict[str, Case] = {}
    for reader, suffix in SUFFIXES.items():
        most = LIMITS.get(reader, "16,777,216")
        cases |= {
            f"{reader}: a pipe": (reader, pipe(suffix), "a readable file, found a pipe"),
            f"{reader}: endless": (reader, link("/dev/zero", suffix), "found a device"),
            f"{reader}: terminal": (reader, link("/dev/tty", suffix), "expected a"),
            f"{reader}: a socket": (reader, listening(suffix), "found a socket"),
            f"{reader}: nowhere": (reader, link("/none/at/all", suffix), "no such file"),
            f"{reader}: itself": (reader, link(f"link{suffix}", suffix), "a readable file"),
            f"{reader}: sparse": (reader, sparse(suffix), f"at most {most} bytes, found 10.0 GB"),
        }
    return cases


def npy(shape: tuple[int, ...], code: str, data: bytes = b"") -> bytes:
    """An .npy file whose header claims that shape."""
    buffer = io.BytesIO()
    header = {"shape": shape, "fortran_order": False, "descr": code}
    np.lib.format.write_array_header_1_0(buffer, header)
    return buffer.getvalue() + data


def zipped(*members: tuple[str, bytes]) -> bytes:
    """An archive, compressed; a name may come twice."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in members:
            info = zipfile.ZipInfo(name)
            archive.writestr(info, data, zipfile.ZIP_DEFLATED)
    return buffer.getvalue()


def with_claimed_size(data: bytes, size: int) -> bytes:
    """The archive's directory says that its first member unfolds to so many bytes."""
    at = data.index(b"PK\x01\x02") + 24
    return data[:at] + struct.pack("<I", size) + data[at + 4 :]


ONE = npy((1, 3, 3), "<f8", bytes(72))
MILLIONS = npy((3_000_000, 3, 3), "<f4", bytes(108_000_000))


def archives() -> dict[str, Case]:
    """.npz: headers that claim much, members that unfold to much."""
    claims = npy((10**15, 3, 3), "<f8")
    lie = with_claimed_size(zipped(("triangles.npy", npy((20_000_000, 3, 3), "<f4"))), 2**32 - 2)
    files = {
        "10^15 triangles": (zipped(("triangles.npy", claims)), "fit in memory"),
        "10^4000 triangles": (npz_of(npy((10**4000, 3, 3), "<f8")), "a complete NumPy"),
        "5,000 digits": (npz_of(npy((1, 3, 3), "<f8").replace(b"1,", b"9" * 5000)), "archive"),
        "fewer than none": (npz_of(npy((-1, 3, 3), "<f8")), "archive"),
        "1000 to 1": (npz_of(MILLIONS), "memory that are free, found about 960.0 MB"),
        "a lying directory": (lie, "memory that are free, found about 4."),
        "cut short": (npz_of(npy((9, 3, 3), "<f8")), "a complete NumPy"),
        "one name twice": (zipped(("triangles.npy", ONE), ("triangles", ONE)), None),
        "many members": (zipped(*((f"{i}", b"") for i in range(1001))), "at most 1,000 arrays"),
        "many names": (npz_of(ONE, npy((10**9,), "<U1")), "fit in memory"),
        "long names": (npz_of(ONE, npy((1000,), "<U1000000")), "fit in memory"),
        "wide parts": (npz_of(ONE, npy((1,), "<U1"), npy((1,), "|S999999999")), "fit in memory"),
        "objects": (npz_bytes(triangles=np.array([{}])), "a complete NumPy"),
        "nested header": (npz_of(ONE.replace(b"(1,", b"(" * 9000 + b"1,")), "archive"),
        "impossible letters": (npz_of(ONE, npy((1,), "<U1", b"\xff" * 4)), "archive"),
    }
    return {f"npz: {k}": ("mesh", holding("a.npz", d), words) for k, (d, words) in files.items()}


def npz_of(triangles: bytes, names: bytes | None = None, parts: bytes | None = None) -> bytes:
    """An archive of .npy files."""
    wanted = (("triangles.npy", triangles), ("part_names.npy", names), ("parts.npy", parts))
    return zipped(*((name, data) for name, data in wanted if data is not None))


def scene(**change: Any) -> bytes:
    """The glb of a box with parts of its document replaced."""
    root, binary = gltf()
    return glb_file({**root, **change}, binary)


def chain(count: int, last: dict[str, Any]) -> list[dict[str, Any]]:
    """Nodes below each other."""
    return [*({"children": [i + 1]} for i in range(count - 1)), last]


def glbs() -> dict[str, Case]:
    """Scenes that show one mesh without end, or are deep."""
    root, _ = gltf()
    primitives = root["meshes"][0]["primitives"]
    crowd = [{"mesh": 0}] * 20_000
    all_of_them = [{"nodes": list(range(20_000))}]
    dag = [{"children": [i + 1, i + 1]} for i in range(60)] + [{"mesh": 0}]
    huge = [{**root["accessors"][0], "count": 2**60}, root["accessors"][1]]
    still = [{**root["bufferViews"][0], "byteStride": 0}, root["bufferViews"][1]]
    digits = json.dumps(root).replace('"scene": 0', f'"scene": {HUGE}').encode()
    chunks = struct.pack("<4sII", b"glTF", 2, 12 + 8 * 999) + struct.pack("<I4s", 0, b"MORE") * 999
    files: dict[str, tuple[bytes, str | None]] = {
        "a crowd": (
            scene(nodes=crowd, scenes=all_of_them, meshes=[{"primitives": primitives * 150}]),
            "20,000 surfaces",
        ),
        "a smaller crowd": (
            scene(nodes=crowd, scenes=all_of_them, meshes=[{"primitives": primitives * 15}]),
            "20,000 surfaces",
        ),
        "many primitives": (scene(meshes=[{"primitives": primitives * 99_999}]), "20,000 surfaces"),
        "too many primitives": (
            scene(meshes=[{"primitives": primitives * 100_001}]),
            "20,000 surfaces",
        ),
        "2^60 nodes by doubling": (scene(nodes=dag), "one parent to a node"),
        "too many nodes": (scene(nodes=[{}] * 200_001), "at most 200,000 nodes"),
        "too many with a mesh": (scene(nodes=[{"mesh": 0}] * 20_001), "20,000 surfaces"),
        "20,000 deep": (scene(nodes=chain(20_000, {"mesh": 0})), None),
        "a long loop": (scene(nodes=chain(1000, {"children": [0]})), "at least one triangle"),
        "2^60 vertices": (scene(accessors=huge), "a whole .glb"),
        "all at one place": (scene(bufferViews=still), "a whole .glb"),
        "brackets": (glb_file(b'{"a":' + b"[" * 100_000, b""), "a well-formed"),
        "5,000 digits": (glb_file(digits, b""), "a well-formed"),
        "NaN": (glb_file(json.dumps({**root, "x": float("nan")}).encode(), b""), "a whole .glb"),
        "Infinity": (
            glb_file(json.dumps({**root, "x": float("inf")}).encode(), b""),
            "a whole .glb",
        ),
        "many chunks": (chunks, "a well-formed"),
        "much JSON": (glb_file(b" " * 40_000_000, b""), "memory that"),
    }
    return {f"glb: {k}": ("mesh", holding("a.glb", d), words) for k, (d, words) in files.items()}


def meshes() -> dict[str, Case]:
    """PLY, OBJ and STL with counts, lines and polygons beyond reason."""
    binary = "binary_little_endian"
    many = ply_header(binary, 10**14, 1).encode() + bytes(1000)
    polygon = ply_header(binary, 8, 1).replace("uchar int", "uint uchar").encode()
    polygon += np.asarray(POINTS, "<f4").tobytes() + struct.pack("<I", 2_000_000) + bytes(2_000_000)
    long_list = ply_header(binary, 8, 1).replace("uchar int", "uint int").encode()
    long_list += np.asarray(POINTS, "<f4").tobytes() + struct.pack("<I", 2**32 - 1) + bytes(12)
    uneven = ply_header(binary, 8, 3_000_000).encode() + np.asarray(POINTS, "<f4").tobytes()
    uneven += b"\3" + bytes(12) + bytes(3_000_000)
    wide = b"ply\nformat ascii 1.0\nelement vertex 1\n"
    wide += b"".join(b"property char p%d\n" % i for i in range(40_000)) + b"end_header\n"
    vertices = b"v 0 0 0\nv 1 0 0\nv 0 1 0\n"
    faces = b"".join(b"f %d %d %d\n" % tuple(f + 1) for f in FACES)
    files: dict[str, tuple[str, bytes, str | None]] = {
        "10^14 vertices": ("a.ply", many, "a whole .ply"),
        "a polygon of millions": ("a.ply", polygon, "memory that are free, found about 639"),
        "a list of 2^32": ("a.ply", long_list, "a whole .ply"),
        "uneven lists": ("a.ply", uneven, "a whole .ply"),
        "an endless header": ("a.ply", b"ply\n" + b"comment\n" * 500_000, "a whole .ply"),
        "many properties": ("a.ply", wide, "a whole .ply"),
        "2^32 facets": ("a.stl", b"x" * 80 + b"\xff" * 4 + bytes(50), "at least one triangle"),
        "one line in a million": ("a.obj", vertices + b"\\\n" * 1_000_000 + faces, "a whole .obj"),
        "much text": ("a.obj", b"#" * 30_000_000, "memory that are free, found about 600.0 MB"),
        "a number of a million": ("a.obj", b"v 0 0 " + b"9" * 1_000_000 + b"x\n", "a whole .obj"),
        "5,000 digits": ("a.obj", vertices + f"f 1 2 {HUGE}\n".encode(), "a whole .obj"),
        "1e308": ("a.obj", b"v 1e308 -1e308 1e308\n" + vertices + b"f 1 2 3\nf 2 3 4", None),
        "1e309": ("a.obj", b"v 1e309 0 0\n" + vertices + b"f 1 2 3\n", "finite coordinates"),
    }
    return {f"mesh: {k}": ("mesh", holding(n, d), words) for k, (n, d, words) in files.items()}


HEADER = "class,x,y,z,length,width,height,yaw\n"
BOX = {"translation": [1, 2, 3], "size": [1, 1, 1], "rotation": [1, 0, 0, 0]}


def one_box(**change: Any) -> str:
    """A nuScenes file of one box."""
    return json.dumps([{"category_name": "vehicle.car", **BOX, **change}])


def labels() -> dict[str, Case]:
    """Boxes: names, digits and depth."""
    row = ",1,2,3,4,5,6,7\n"
    digits = one_box().replace("[1, 2, 3]", f"[1, 2, {HUGE}]")
    strangers = [{"category_name": f"thing.{i}", **BOX} for i in range(50_000)]
    files: dict[str, tuple[str, str | None]] = {
        "100,000 digits": (f"{HEADER}car,{'9' * 100_000}x{row[2:]}", "for x"),
        "a million digits": (f"{HEADER}car,{'9' * 1_000_000}x{row[2:]}", "a line of CSV"),
        "a header of a million": (f"{HEADER[:-1]},{'_' * 100_000}x\n", "at least one box"),
        "a cell of 200,000": (f"{HEADER}{'c' * 200_000}{row}", "a line of CSV"),
        "a long class": (f"{HEADER}{'c' * 300}{row}", "a class in printable letters"),
        "a class turned round": (f"{HEADER}car\u202e{row}", "a class in printable letters"),
        "a class with an escape": (f"{HEADER}c\x1b[2Jar{row}", "a class in printable letters"),
        "1e308": (f"{HEADER}car{row.replace('2', '1e308')}", "y within"),
        "brackets": ("[" * 100_000, "JSON of boxes"),
        "brackets in a box": (one_box(size=0).replace("0}", "[" * 900 + "]" * 900 + "}"), "size"),
        "5,000 digits": (digits, "JSON of boxes"),
        "400 digits": (one_box(translation=[1, 2, 10**400]), "3 finite numbers"),
        "NaN": (one_box(translation=[1, 2, float("nan")]), "3 finite numbers"),
        "NaN where nobody looks": (one_box(velocity=[float("nan")] * 2), None),
        "one key twice": (one_box().replace('"size"', '"size": 3, "size"'), None),
        "half a character": (one_box(category_name="\ud800"), "1 of unknown class"),
        "strangers": (json.dumps(strangers), "at least one box of a known class"),
        "a long sample": (json.dumps({"results": {"t" * 10**6: 3}}), "a list of boxes"),
        "a shout": (json.dumps({"k\n" * 10**5: 3}), "a list of boxes"),
    }
    return {f"boxes: {k}": ("boxes", holding("a", d), words) for k, (d, words) in files.items()}


def laughs() -> str:
    """A billion laughs: ten words of ten words of ..."""
    words = ['<!ENTITY a0 "ha">']
    words += [f'<!ENTITY a{i} "{f"&a{i - 1};" * 10}">' for i in range(1, 10)]
    return f"<!DOCTYPE px [{''.join(words)}]><px><id_>&a9;</id_></px>"


def angles() -> dict[str, Case]:
    """Channel angles: digits, and long names."""
    files = {
        "digits": ("elevation\n" + "9" * 1_000_000 + "x\n", "a finite number"),
        "a unit of a million": (f"elevation{'_deg' * 200_000}x\n", "a column named elevation"),
    }
    return {f"angles: {k}": ("angles", holding("a", d), words) for k, (d, words) in files.items()}


def studies() -> dict[str, Case]:
    """Studies and tables of AP."""
    files = {
        "a key of 40 kB": ("study", ".".join("a" * 20_000) + " = 1", "keys of at most 30 parts"),
        "a table of 40 kB": ("study", "[" + ".".join("a" * 20_000) + "]", "keys of at most 30"),
        "brackets": ("study", "a = " + "[" * 100_000, "valid TOML"),
        "braces": ("study", "a = " + "{a = " * 100_000, "valid TOML"),
        "5,000 digits": ("study", f"samples = {HUGE}", "valid TOML"),
        "a cell of 200,000": ("table", f"m,ap\n1,{'9' * 200_000}", "a line of CSV"),
        "a header of 200,000": ("table", f"m,ap,{'9' * 200_000}", "a line of CSV"),
        "100,000 digits": ("table", f"m,ap\n1,{'9' * 100_000}x", "a finite number"),
    }
    return {f"text: {k}": (r, holding("a", d), words) for k, (r, d, words) in files.items()}


def all_cases() -> dict[str, Case]:
    """Every case by its name."""
    groups = (special, archives, glbs, meshes, labels, angles, studies)
    return {name: case for group in groups for name, case in group().items()}
