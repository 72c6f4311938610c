"""A second reader of `export --format objects`: SCENE.glb OBJECTS.json, and CELL=IDS.txt of each cell.

Reads the GLB by itself, counts ids by node and primitive, and compares."""
import json
import struct
import sys


def primitives(glb):
    """(first id, triangles, node, mesh, primitive) in the order of the scene's tree."""
    length = struct.unpack_from("<I", glb, 12)[0]
    document = json.loads(glb[20:20 + length])
    found, first = [], 0
    stack = list(reversed(document["scenes"][document.get("scene", 0)]["nodes"]))
    while stack:
        node = stack.pop()
        stack += reversed(document["nodes"][node].get("children", []))
        mesh = document["nodes"][node].get("mesh")
        for number, primitive in enumerate(document["meshes"][mesh]["primitives"] if mesh is not None else []):
            count = document["accessors"][primitive["indices"]]["count"] // 3
            found.append((first, count, node, mesh, number))
            first += count
    return found


def main(scene, objects, *sets):
    parts = primitives(open(scene, "rb").read())
    cells = {cell["name"]: cell for cell in json.load(open(objects))["cells"]}
    assert len(cells) == len(sets) > 0
    for name, file in (entry.split("=") for entry in sets):
        ids = [int(line) for line in open(file)]
        expected = {}
        for first, count, *part in parts:
            if visible := sum(first <= i < first + count for i in ids):
                expected[tuple(part)] = (count, visible)
        listed = cells[name]["objects"]
        assert {(o["node"], o["mesh"], o["primitive"]): (o["triangles"], o["visible"]) for o in listed} == expected, name
        assert cells[name]["visible"] == len(ids)
        assert all(o["share"] == o["hits"] / cells[name]["hits"] for o in listed)
        assert 0.999 < sum(o["share"] for o in listed) <= 1 + 1e-9, name
    print("agreed on", len(sets), "cells")


main(*sys.argv[1:])
