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


def tfxbone(names, strands):
    content = struct.pack("<i", len(names))
    for i, name in enumerate(names):
        content += struct.pack("<2i", i, len(name) + 1) + name.encode() + b"\0"
    content += struct.pack("<i", len(strands))
    for i, (bones, weights) in enumerate(strands):
        content += struct.pack("<i", i) + b"".join(struct.pack("<if", b, w) for b, w in zip(bones, weights))
    return content


def tfx_corpus():
    keep("tfx4", "plain", tfx4())
    keep("tfx4", "with-uv", tfx4(3, 8, uv=True))
    keep("tfx2", "guides", "version 2.0\nscale 1\nrotation 0 0 0\ntranslation 0 0 0\nbothEndsImmovable 0\n"
         "maxNumVerticesInStrand 8\nnumFollowHairsPerGuideHair 4\nmaxRadiusAroundGuideHair 0.5\nnumStrands 3\nis sorted 1\n" +
         "".join(f"strand {i} numVerts {len(s)} texcoord 0.5 000000\n" + "".join("%g, %g, %g\n" % p for p in s)
                 for i, s in enumerate(STRANDS)))
    keep("tfx2", "moved", "version 2.0\r\nscale 0.5\r\nrotation 90 0 0\r\nnumStrands 1\r\nstrand 0 numVerts 2 texcoord 0 0\r\n0,0,0\r\n0,.1,0\r\n")
    keep("tfxbone", "two-bones", tfxbone(["root", "tip"], [((0, 1, 0, 0), (0.5, 0.42, 0, 0)), ((1, 0, 0, 0), (0, 0, 0, 0))]))
    keep("tfxbone", "none", tfxbone([], []))
    keep("tfxbone", "odd-weights", tfxbone(["a"], [((0, 0, 0, 0), (1e38, 1e38, 1e38, 1e38)), ((0, 0, 0, 0), (-1, float("nan"), 1, 0))]))
    keep("tfx4", "version-3", floats(3.0) + tfx4()[4:])


def data(strands, rest=b""):
    return struct.pack("<i", len(strands)) + b"".join(
        struct.pack("<i", len(s)) + b"".join(floats(*p) + rest for p in s) for s in strands)


def data_corpus():
    keep("data", "plain", data(STRANDS))
    keep("data", "bald-roots", data([STRANDS[0], [(0, 0, 0)], [], STRANDS[2]]))
    keep("data", "ct2hair", data(STRANDS, rest=floats(0, 1, 0, 0)))


def ply_corpus():
    head = "ply\nformat %s 1.0\ncomment corpus\nelement vertex 9\nproperty float x\nproperty float y\nproperty float z\n%s" \
           "element strand 3\nproperty ushort nsegs\nelement edge 2\nproperty int vertex1\nproperty int vertex2\nend_header\n"
    segments, edges = [len(s) - 1 for s in STRANDS], (0, 1, 1, 2)
    text = "".join("%g %g %g\n" % p for p in POINTS) + "".join(f"{n}\n" for n in segments) + "0 1\n1 2\n"
    keep("ply", "text", head % ("ascii", "") + text)
    for name, order in (("binary_little_endian", "<"), ("binary_big_endian", ">")):
        body = b"".join(struct.pack(order + "3f4Bf", *p, 128, 64, 32, 255, 1e-4) for p in POINTS)
        body += struct.pack(order + "3H", *segments) + struct.pack(order + "4i", *edges)
        more = "".join(f"property uchar {c}\n" for c in ("red", "green", "blue", "alpha")) + "property float thickness\n"
        keep("ply", name, (head % (name, more)).encode() + body)
    keep("ply", "lists", "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nelement vertex 2\n"
         "property double x\nproperty double y\nproperty double z\nelement strand 1\nproperty uint nsegs\nend_header\n3 0 1 0\n0 0 0\n0 .1 0\n1\n")
    keep("ply", "no-strands", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n")


def obj_strands_corpus():
    keep("obj_strands", "plain", "o hair\n" + "".join("v %g %g %g\n" % p for p in POINTS) + "l 1 2 3\nl 4 5\nl -4 -3 -2 -1\n")
    keep("obj_strands", "edges", "v 0 0 0 .5 .25 0\nv 0 .1 0 .5 .25 0\r\nv 0 .2 0\nl 1 2\nl 2 3\nf 1 2 3\n")
    keep("obj_strands", "edges-in-any-order", "v 0 0 0\nv 0 .1 0\nv 0 .2 0\nv 0 .3 0\nvt 0 1\nl 3 4\nl 1/1 2/1\nl 2 3\nl 2 2\nv 1 1 1\nl 3 2\nl 2 1\nl 2 4\n")
    keep("obj_strands", "continued-lines", "\ufeffv 0 0 0 # \\\nv 0 \\\n.1 \\\r\n+0\nl 1 \\\n2 # end\nl 1\\")


def found_corpus():
    """What the harnesses found, made small."""
    keep("usda", "found-note-that-is-no-utf8", b'#usda 1.0\ndef BasisCurves "a" {\n uniform token type = "linear"\n int[] curveVertexCounts = [2]\n'
         b' point3f[] points = [(0,0,0), (0,.1,0)]\n float[] widths = [1e-4] (interpolation = "v\xa4rying")\n}\n')


def usda_corpus():
    stage = '#usda 1.0\n(\n    metersPerUnit = 0.01\n    upAxis = "Z"\n    doc = """text"""\n)\n'
    points = ", ".join("(%g, %g, %g)" % tuple(100 * c for c in p) for p in POINTS)
    keep("usda", "linear", stage + 'def Xform "head" (kind = "group")\n{\n  double3 xformOp:translate = (1, 2, 3)\n  def BasisCurves "hair"\n  {\n'
         '    uniform token type = "linear"\n    int[] curveVertexCounts = [3, 2, 4]\n    point3f[] points = [' + points + ']\n'
         '    float[] widths = [0.01, 0.02, 0.03] (interpolation = "uniform")\n'
         '    color3f[] primvars:displayColor = [(1, 0.5, 0.25)] (interpolation = "constant")\n    float[] primvars:displayOpacity = [0.5]\n  }\n}\n')
    for basis, wrap in (("bezier", "nonperiodic"), ("bspline", "pinned"), ("catmullRom", "pinned")):
        keep("usda", basis, '#usda 1.0\ndef BasisCurves "a" {\n uniform token basis = "' + basis + '"; uniform token wrap = "' + wrap + '"\n'
             ' int[] curveVertexCounts = [4, 4]\n point3f[] points.timeSamples = { 0: [(0,0,0), (0,.1,0), (0,.2,0), (.1,.3,0), (1,0,0), (1,.1,0),'
             ' (1,.2,0), (1.1,.3,0)], 1: [(0,0,0)] }\n float[] primvars:widths = [1e-4, 2e-4, 1e-4, 1e-4] (\n interpolation = "varying"\n )\n}\n')


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


for write in (hair_corpus, tfx_corpus, data_corpus, ply_corpus, obj_strands_corpus, usda_corpus, mesh_corpus, json_corpus,
              found_corpus):
    write()
