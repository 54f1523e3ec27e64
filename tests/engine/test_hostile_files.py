"""Files out to do harm are refused in one line: none hangs, none takes memory, none warns.

`python -m tests.engine.test_hostile_files LIST` reads files in a process with little memory: the
list is JSON, [name, reader, path] each. A line comes back at once for each: one that hung is known.
"""

import io
import json
import os
import socket
import struct
import subprocess
import sys
import traceback
import warnings
import zipfile
from contextlib import suppress
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_tools.formats import read_ap_table
from pe_tools.formats.angles import read_angles
from pe_tools.formats.xml_text import parse_xml
from pe_tools.formats.yaml_text import parse_yaml
from tests.engine.mesh_files import HUGE, POINTS, glb_file, gltf, ply_header
from tests.engine.refusals import wrongly_refused
from tests.limits import HANG_S

ROOM_BYTES = 400 << 20
"""How much more memory the reading process may take than it has at its start."""
READERS = {
    "mesh": pt.read_mesh,
    "boxes": pt.read_boxes,
    "angles": read_angles,
    "table": read_ap_table,
    "study": pe.load_study,
}
HEADER = "class,x,y,z,length,width,height,yaw\n"
ROW = ",1,2,3,4,5,6,7\n"


def holding(name, data):
    """Make a file of these bytes."""

    def make(folder):
        path = folder / name
        path.write_bytes(data.encode("utf-8", "surrogatepass") if isinstance(data, str) else data)
        return path

    return make


def link(target):
    def make(folder):
        (folder / "link.obj").symlink_to(target)
        return folder / "link.obj"

    return make


def pipe(folder):
    os.mkfifo(folder / "pipe.obj")
    return folder / "pipe.obj"


def sparse(folder):
    """Ten gigabytes of nothing, that take no place on the disk."""
    (folder / "sparse.obj").touch()
    os.truncate(folder / "sparse.obj", 10 * 10**9)
    return folder / "sparse.obj"


def listening(folder):
    """A socket's name in the file system."""
    here = os.getcwd()
    os.chdir(folder)  # a socket's name may not be long
    try:
        with socket.socket(socket.AF_UNIX) as server:
            server.bind("socket.obj")
    finally:
        os.chdir(here)
    return folder / "socket.obj"


NO_FILES = {
    "a pipe": (pipe, "file"),
    "endless": (link("/dev/zero"), "file"),
    "a socket": (listening, "file"),
    "nowhere": (link("/none/at/all"), ""),
    "itself": (link("link.obj"), "file"),
    "sparse": (sparse, "size"),
}


def npy(shape, code, data=b""):
    """An .npy file whose header claims that shape."""
    buffer = io.BytesIO()
    header = {"shape": shape, "fortran_order": False, "descr": code}
    np.lib.format.write_array_header_1_0(buffer, header)
    return buffer.getvalue() + data


def npz(triangles, names=None):
    """An archive of .npy files, compressed."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("triangles.npy", triangles)
        if names is not None:
            archive.writestr("part_names.npy", names)
    return buffer.getvalue()


def lying_npz():
    """An archive whose directory says that its first member unfolds to 4 GB."""
    data = npz(npy((20_000_000, 3, 3), "<f4"))
    at = data.index(b"PK\x01\x02") + 24
    return data[:at] + struct.pack("<I", 2**32 - 2) + data[at + 4 :]


def scene(**change):
    """The glb of a box with parts of its document replaced."""
    root, binary = gltf()
    return glb_file({**root, **change}, binary)


def instances(count):
    """The glb of a box with an accessor that claims so many instances of it."""
    root, binary = gltf()
    root["accessors"].append({**root["accessors"][0], "count": count})
    attributes = {"TRANSLATION": len(root["accessors"]) - 1}
    root["nodes"][0]["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": attributes}}
    return glb_file(root, binary)


def zigzag(corners):
    """The OBJ of one polygon that is concave at every second corner."""
    points = [f"v {k} {k % 2} 0" for k in range(corners - 1)] + [f"v 0 {corners} 0"]
    face = " ".join(str(k + 1) for k in range(corners))
    return "\n".join([*points, f"f {face}"])


def packed(name, size):
    """An archive of a member that unfolds to so many bytes."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(name, b" " * size)
    return buffer.getvalue()


def ply(faces, data, of="uchar int"):
    head = ply_header("binary_little_endian", 8, faces).replace("uchar int", of)
    return head.encode() + np.asarray(POINTS, "<f4").tobytes() + data


def one_box(**change):
    """A nuScenes file of one box."""
    box = {"translation": [1, 2, 3], "size": [1, 1, 1], "rotation": [1, 0, 0, 0]}
    return json.dumps([{"category_name": "vehicle.car", **box, **change}])


@cache
def cases():
    """Return the reader, what makes the file in a folder, and the field that is named; None: it is
    read."""
    one = npy((1, 3, 3), "<f8", bytes(72))
    primitives = gltf()[0]["meshes"][0]["primitives"]
    doubling = [{"children": [i + 1, i + 1]} for i in range(60)] + [{"mesh": 0}]
    deep = [*({"children": [i + 1]} for i in range(19_999)), {"mesh": 0}]
    held = [*({"children": [i + 1], "mesh": 0} for i in range(18_999)), {"mesh": 0}]
    loop = [{"children": [(i + 1) % 1000]} for i in range(1000)]
    triangle = b"v 0 0 0\nv 1 0 0\nv 0 1 0\n"
    meshes = {
        "claims 10^15 triangles.npz": (npz(npy((10**15, 3, 3), "<f8")), "file"),
        "claims 10^4000 triangles.npz": (npz(npy((10**4000, 3, 3), "<f8")), "file"),
        "5,000 digits.npz": (npz(npy((1, 3, 3), "<f8").replace(b"1,", b"9" * 5000)), "file"),
        "1000 to 1.npz": (npz(npy((3_000_000, 3, 3), "<f4", bytes(108_000_000))), "triangles"),
        "a lying directory.npz": (lying_npz(), "file"),
        "many names.npz": (npz(one, npy((10**9,), "<U1")), "file"),
        "nested header.npz": (npz(one.replace(b"(1,", b"(" * 9000 + b"1,")), "file"),
        "impossible letters.npz": (npz(one, npy((1,), "<U1", b"\xff" * 4)), "file"),
        "a crowd.glb": (scene(nodes=[{"mesh": 0}] * 20_001), "scene"),
        "many primitives.glb": (scene(meshes=[{"primitives": primitives * 99_999}]), "scene"),
        "2^60 nodes.glb": (scene(nodes=doubling), "scene"),
        "too many nodes.glb": (scene(nodes=[{}] * 200_001), "scene"),
        "20,000 deep.glb": (scene(nodes=deep), None),
        "a mesh in each of 19,000, deep.glb": (scene(nodes=held), None),
        "a long loop.glb": (scene(nodes=loop), "scene"),
        "many instances.glb": (instances(20_001), "scene"),
        "brackets.glb": (glb_file(b'{"a":' + b"[" * 100_000, b""), "JSON"),
        "much JSON.glb": (glb_file(b" " * 40_000_000, b""), "file"),
        "a polygon of millions.ply": (
            ply(1, struct.pack("<I", 2_000_000) + bytes(2_000_000), "uint uchar"),
            "triangles",
        ),
        "a list of 2^32.ply": (
            ply(1, struct.pack("<I", 2**32 - 1) + bytes(12), "uint int"),
            "file",
        ),
        "uneven lists.ply": (ply(3_000_000, b"\3" + bytes(3_000_012)), None),
        "many corners.obj": (zigzag(20_000), "polygons"),
        "2^32 facets.stl": (b"x" * 80 + b"\xff" * 4 + bytes(50), "triangles"),
        "one line in a million.obj": (triangle + b"\\\n" * 1_000_000 + b"f 1 2 3\n", None),
        "much text.obj": (b"#" * 30_000_000, "file"),
        "5,000 digits.obj": (triangle + f"f 1 2 {HUGE}\n".encode(), "faces"),
        "1e308.obj": (b"v 1e308 -1e308 1e308\n" + triangle + b"f 1 2 3\nf 2 3 4", None),
    }
    if find_spec("collada") is not None:
        meshes["an archive.dae"] = packed("a.dae", 1 << 29), "file"
        meshes["laughs.dae"] = laughs().encode("utf-16"), "file"
    strangers = json.dumps(
        [json.loads(one_box(category_name=f"thing.{i}"))[0] for i in range(50_000)]
    )
    texts = {
        "100,000 digits": ("boxes", f"{HEADER}car,{'9' * 100_000}x{ROW[2:]}", "line 2"),
        "a cell of 200,000": ("boxes", f"{HEADER}{'c' * 200_000}{ROW}", "line 2"),
        "a class turned round": ("boxes", f"{HEADER}car\u202e{ROW}", "line 2"),
        "a class with an escape": ("boxes", f"{HEADER}c\x1b[2Jar{ROW}", "line 2"),
        "5,000 digits": ("boxes", one_box().replace("[1, 2, 3]", f"[1, 2, {HUGE}]"), "file"),
        "NaN where nobody looks": ("boxes", one_box(velocity=[float("nan")] * 2), None),
        "half a character": ("boxes", one_box(category_name="\ud800"), "boxes"),
        "strangers": ("boxes", strangers, "boxes"),
        "a shout": ("boxes", json.dumps({"k\n" * 10**5: 3}), "file"),
        "a unit of a million": ("angles", f"elevation{'_deg' * 200_000}x\n", "line 1"),
        "a header of 200,000": ("table", f"m,ap,{'9' * 200_000}", "line 1"),
        "a key of 40 kB": ("study", ".".join("a" * 20_000) + " = 1", "line 1"),
        "braces": ("study", "a = " + "{a = " * 100_000, "study"),
        "5,000 digits of TOML": ("study", f"samples = {HUGE}", "study"),
    }
    return {
        **{name: ("mesh", make, field) for name, (make, field) in NO_FILES.items()},
        **{name: ("mesh", holding(name, data), field) for name, (data, field) in meshes.items()},
        **{
            name: (reader, holding("a", data), field)
            for name, (reader, data, field) in texts.items()
        },
    }


def outcomes_of(new_folder):
    """How each file went, read in another process with little memory."""
    listed = new_folder("list") / "cases.json"
    made = [(name, row[0], str(row[1](new_folder("a")))) for name, row in cases().items()]
    listed.write_text(json.dumps(made))
    command = [sys.executable, "-m", "tests.engine.test_hostile_files", str(listed)]
    with subprocess.Popen(
        command, cwd=Path(__file__).parents[2], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE
    ) as child:
        try:
            out, _ = child.communicate(timeout=HANG_S)
        except subprocess.TimeoutExpired:
            child.kill()
            out, _ = child.communicate()
    return {(told := json.loads(line))["name"]: told for line in out.splitlines()}


@pytest.mark.thorough
@pytest.mark.skipif(sys.platform != "linux", reason="limits memory and asks for it as Linux does")
def test_hostile_files_are_refused_in_one_line(tmp_path_factory):
    """What is not in the answers hung, or took the process with it; odd files are read."""
    told = outcomes_of(tmp_path_factory.mktemp)
    expected = {
        name: {"name": name, "fault": "", "field": field} for name, (_, _, field) in cases().items()
    }
    assert told == expected


def outcome(reader, path):
    """The field that a refusal names, None where the file is read; and what is wrong with it."""
    field = None
    fault = ""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            READERS[reader](path)
        except pe.InputError as error:
            field = error.field
            line = str(error)
            fault = "" if line.isprintable() and len(line) < 600 else f"no line: {line:.300}"
        except BaseException:
            fault = traceback.format_exc(limit=-5)[-2000:]
    return {"field": field, "fault": fault}


def read_with_little_memory():
    """Read all files of the list."""
    import resource

    import trimesh  # noqa: F401  (before memory is limited)

    listed = json.loads(Path(sys.argv[1]).read_text())
    for reader in READERS.values():  # what they import on their first call is not the files' fault
        with suppress(pe.InputError):
            reader(Path("/none.obj"))
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    most = pages * resource.getpagesize() + ROOM_BYTES
    resource.setrlimit(resource.RLIMIT_AS, (most, most))
    for name, reader, path in listed:
        print(json.dumps({"name": name, **outcome(reader, Path(path))}), flush=True)


def laughs():
    """A billion laughs: ten words of ten words of ..."""
    words = ['<!ENTITY a0 "ha">']
    words += [f'<!ENTITY a{i} "{f"&a{i - 1};" * 10}">' for i in range(1, 10)]
    return f"<!DOCTYPE px [{''.join(words)}]><px><id_>&a9;</id_></px>"


UNFOLDING = [
    ("file", (parse_xml, laughs().encode())),
    ("file", (parse_xml, laughs().encode("utf-16"))),
    ("file", (parse_xml, b'<!DOCTYPE a [<!ENTITY x SYSTEM "/dev/zero">]><a>&x;</a>')),
    ("file", (parse_xml, b"<a>" * 100_000)),
    ("file", (parse_yaml, "a:\n- " + "{" * 100_000)),
    ("file", (parse_yaml, "a: " + "9" * 1_000_000)),
    ("line 1", (parse_yaml, "a: &x [1, 2]\nb: [*x, *x]")),
    ("line 2", (parse_yaml, "a: 1\na: 2")),
    ("line 1", (parse_yaml, "a: *x")),
    ("file", (parse_yaml, "- 1")),
    ("file", (parse_yaml, "a: \x00")),
]


@pytest.mark.thorough
def test_texts_that_unfold_are_refused_in_one_line():
    assert wrongly_refused(lambda given: given[0]("kit", given[1]), UNFOLDING, "kit") == []


if __name__ == "__main__":
    read_with_little_memory()
