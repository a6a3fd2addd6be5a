#!/usr/bin/env python3
"""Writes the first inputs of the fuzz harnesses into corpus/<harness>/: one small file per dialect and per array.

What a fuzzer finds is kept there too, under other names. Layouts: data_schema/SCHEMA.md and the readers' heads.
"""

import struct
from pathlib import Path

CORPUS = Path(__file__).parent / "corpus"
EXAMPLES = Path(__file__).parents[2] / "data_schema" / "examples"


def keep(harness, name, content):
    folder = CORPUS / harness
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)


def floats(*values):
    return struct.pack(f"<{len(values)}f", *values)


def strand(index, count, spacing=0.05):
    return [(0.01 * index, 1 - spacing * k, 0.002 * k * k) for k in range(count)]


STRANDS = [strand(i, n) for i, n in enumerate((3, 2, 4))]
POINTS = [p for s in STRANDS for p in s]


def hair(bits, segments=None, magic=b"HAIR", tail=b"", thickness=1e-4, counts=None):
    strands, points = counts or (len(STRANDS), len(POINTS))
    head = magic + struct.pack("<4I", strands, points, bits, segments or 0)
    head += floats(thickness, 0.25, 0.5, 0.25, 0.125) + b"corpus".ljust(88, b"\0")
    arrays = b""
    if bits & 1:
        arrays += struct.pack("<3H", *(len(s) - 1 for s in STRANDS))
    if bits & 2:
        arrays += b"".join(floats(*p) for p in POINTS)
    if bits & 4:
        arrays += floats(*[1e-4] * len(POINTS))
    if bits & 8:
        arrays += floats(*[0.25] * len(POINTS))
    if bits & 16:
        arrays += floats(*[0.5, 0.25, 0.125] * len(POINTS))
    return head + arrays + tail


def hair_corpus():
    keep("hair", "all-arrays", hair(31))
    keep("hair", "points-only", hair(2, segments=2, counts=(3, 9)))
    keep("hair", "lowercase", hair(3, magic=b"hair"))
    keep("hair", "luxcore-uv", hair(35, tail=floats(*[0.5] * 2 * len(POINTS))))
    keep("hair", "vkhr", hair(35, tail=floats(*[0.5] * 3 * len(POINTS))))
    keep("hair", "huge-counts", hair(3, counts=(0xFFFFFFFF, 0xFFFFFFFF)))
    keep("hair", "not-a-number", hair(7).replace(floats(1e-4), floats(float("nan")), 2))


def tfx4(strands=2, vertices=4, uv=False):
    positions = b"".join(floats(0.01 * i, 1 - 0.05 * k, 0, float(k > 0)) for i in range(strands) for k in range(vertices))
    arrays, offsets = positions, [160, 0, 0, 0, 0]
    for slot, present, size in ((1, uv, 2 * strands), (2, uv, 2 * strands * vertices), (3, True, strands), (4, True, 4 * strands * vertices)):
        if present:
            offsets[slot] = 160 + len(arrays)
            arrays += floats(*[2e-4 if slot == 3 else 0.5] * size)
    return floats(4.0) + struct.pack("<7I", strands, vertices, *offsets) + bytes(128) + arrays


def tfx_corpus():
    keep("tfx4", "plain", tfx4())
    keep("tfx4", "with-uv", tfx4(3, 8, uv=True))
    keep("tfx4", "version-3", floats(3.0) + tfx4()[4:])


def mesh_corpus():
    keep("obj_mesh", "tetrahedron", "# mesh\nmtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n")
    keep("obj_mesh", "quad-with-normals", "o q\nv 0 0 0\nv .1 0 0\nv .1 .1 0\nv 0 +1e-1 0\nvt 0 0\nvn 0 0 1\ns off\nf 1/1/1 2//1 -2/1 4\n")
    keep("obj_mesh", "windows-lines", "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\nl 1 2\r\n")
    keep("obj_mesh", "degenerate", "v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\nf 1 1 1\n")


def json_corpus():
    for harness, example in (("json_scene", "lock.scene.json"), ("json_scene", "material.json"), ("json_bake", "bake.json"),
                             ("json_hairstyle", "lock.hairstyle.json"), ("json_hairstyle", "three_locks.hairstyle.json")):
        keep(harness, example, (EXAMPLES / example).read_bytes())
    keep("json_scene", "bare", '{"version": 1, "hair": "a.hair", "unit": "cm", "up": "z", "clusters": 3}')
    keep("json_bake", "all-keys", '{"version": 1, "seed": 9007199254740991, "sectors": 3, "grid": 8, "sigma": 0.08, "views": 4, "lights": 4,'
         ' "samples": 4, "smoothing": 0, "reference_scale": 0.025, "max_path": 1, "early_stop": 1, "max_strands": 2,'
         ' "phong": {"diffuse": 0, "specular": 1, "exponent": 1000}, "features": "paper3", "storage": "half"}')


for write in (hair_corpus, tfx_corpus, mesh_corpus, json_corpus):
    write()
