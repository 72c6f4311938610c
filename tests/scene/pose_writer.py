#!/usr/bin/env python3
"""Writes a glTF file with skins and morph targets at random, and where its triangles then are: by double arithmetic
that follows the specification, and nothing of ours.
usage: pose_writer.py SEED MORPHS FOLDER: FOLDER/pose.gltf, pose.bin, and pose.txt with nine numbers a triangle"""
import json, math, random, struct, sys

seed, morphs, folder = int(sys.argv[1]), int(sys.argv[2]), sys.argv[3]
rng = random.Random(seed)
blob, views, accessors = bytearray(), [], []


def single(x): return struct.unpack('<f', struct.pack('<f', x))[0]
def real(low=-2.0, high=2.0): return single(rng.uniform(low, high))
def product(a, b): return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]
def placed(m, p): return [m[i][0] * p[0] + m[i][1] * p[1] + m[i][2] * p[2] + m[i][3] for i in range(3)]
def columns(m): return [m[i][j] for j in range(4) for i in range(4)]


def add(letter, component, kind, rows, **more):
    while len(blob) % 4: blob.append(0)
    views.append({'buffer': 0, 'byteOffset': len(blob), 'byteLength': struct.calcsize(letter) * sum(map(len, rows))})
    for row in rows: blob.extend(struct.pack('<%d%s' % (len(row), letter), *row))
    accessors.append(dict(bufferView=len(views) - 1, componentType=component, count=len(rows), type=kind, **more))
    return len(accessors) - 1


def affine():
    m = [[real() for _ in range(4)] for _ in range(3)] + [[0.0, 0.0, 0.0, 1.0]]
    return m if abs(sum(m[0][i] * (m[1][(i + 1) % 3] * m[2][(i + 2) % 3] - m[1][(i + 2) % 3] * m[2][(i + 1) % 3])
                        for i in range(3))) > 0.2 else affine()


def node(**more):
    """A node's JSON and its own matrix."""
    if rng.random() < 0.3:
        m = affine()
        return dict(matrix=columns(m), **more), m
    q = [rng.gauss(0, 1) for _ in range(4)]
    length = math.sqrt(sum(x * x for x in q))
    x, y, z, w = q = [single(c / length) for c in q]
    t, s = [real() for _ in range(3)], [real(0.3, 2.0) * rng.choice([1, -1]) for _ in range(3)]
    norm = sum(c * c for c in q)  # quaternions are of length 1 but for rounding
    turn = [[1 - 2 * (y * y + z * z) / norm, 2 * (x * y - w * z) / norm, 2 * (x * z + w * y) / norm],
            [2 * (x * y + w * z) / norm, 1 - 2 * (x * x + z * z) / norm, 2 * (y * z - w * x) / norm],
            [2 * (x * z - w * y) / norm, 2 * (y * z + w * x) / norm, 1 - 2 * (x * x + y * y) / norm]]
    m = [[turn[i][j] * s[j] for j in range(3)] + [t[i]] for i in range(3)] + [[0.0, 0.0, 0.0, 1.0]]
    return dict(translation=t, rotation=q, scale=s, **more), m


vertices, faces, joints = 12, 20, 6
positions = [[real() for _ in range(3)] for _ in range(vertices)]
corners = [rng.sample(range(vertices), 3) for _ in range(faces)]
shape = {'POSITION': add('f', 5126, 'VEC3', positions)}
for unit, letter, component in ((0, 'B', 5121), (1, 'H', 5123)):
    shape['JOINTS_%d' % unit] = add(letter, component, 'VEC4', [[rng.randrange(joints) for _ in range(4)] for _ in positions])
parts = [[rng.randrange(1, 30) for _ in range(8)] for _ in positions]
weights = [[single(p / sum(row)) for p in row] for row in parts]
shape['WEIGHTS_0'] = add('f', 5126, 'VEC4', [row[:4] for row in weights])
shape['WEIGHTS_1'] = add('f', 5126, 'VEC4', [row[4:] for row in weights])
targets = [[[real(-1, 1) for _ in range(3)] for _ in positions] for _ in range(morphs)]
mesh = {'primitives': [{'attributes': shape, 'indices': add('H', 5123, 'SCALAR', [[c] for t in corners for c in t])}]}
if morphs:
    mesh['primitives'][0]['targets'] = [{'POSITION': add('f', 5126, 'VEC3', t)} for t in targets]
    mesh['weights'] = [real(-1, 1) for _ in targets]

# Nodes: a root above all, the joints as a random tree below it, a skinned node, a rigid one with weights of its own.
nodes, own, parent = [], [], {}
for name in ['root'] + ['joint%d' % j for j in range(joints)] + ['skinned', 'rigid']:
    more = {'name': name}
    if name in ('skinned', 'rigid'): more['mesh'] = 0
    if name == 'skinned': more['skin'] = 0
    if name == 'rigid' and morphs: more['weights'] = [real(-1, 1) for _ in targets]
    description, matrix = node(**more)
    if nodes:
        parent[len(nodes)] = rng.randrange(len(nodes)) if name.startswith('joint') else 0
        nodes[parent[len(nodes)]].setdefault('children', []).append(len(nodes))
    nodes.append(description)
    own.append(matrix)
world = []
for n, m in enumerate(own): world.append(product(world[parent[n]], m) if n in parent else m)
order = rng.sample(range(1, joints + 1), joints)
binds = [affine() for _ in order]
skin = {'joints': order, 'inverseBindMatrices': add('f', 5126, 'MAT4', [columns(b) for b in binds])}
matrices = [product(world[j], b) for j, b in zip(order, binds)]

numbers = [struct.unpack_from('<4' + letter, blob, views[accessors[shape['JOINTS_%d' % u]]['bufferView']]['byteOffset'] + v * size)
           for v in range(vertices) for u, letter, size in ((0, 'B', 4), (1, 'H', 8))]


def morphed(v, by): return [positions[v][c] + sum(w * t[v][c] for w, t in zip(by, targets)) for c in range(3)]


def corner(v, skinned):
    if not skinned: return placed(world[-1], morphed(v, nodes[-1].get('weights', [])))
    p, total = morphed(v, mesh.get('weights', [])), sum(weights[v])
    ends = [placed(matrices[j], p) for j in numbers[2 * v] + numbers[2 * v + 1]]
    return [sum(w * e[c] for w, e in zip(weights[v], ends)) / total for c in range(3)]


document = {'asset': {'version': '2.0', 'generator': 'pose_writer'}, 'scene': 0, 'scenes': [{'nodes': [0]}], 'nodes': nodes,
            'meshes': [mesh], 'skins': [skin], 'accessors': accessors, 'bufferViews': views,
            'buffers': [{'uri': 'pose.bin', 'byteLength': len(blob)}]}
open(folder + '/pose.bin', 'wb').write(blob)
json.dump(document, open(folder + '/pose.gltf', 'w'))
with open(folder + '/pose.txt', 'w') as text:
    for skinned in (True, False):
        for t in corners: text.write(' '.join(repr(x) for v in t for x in corner(v, skinned)) + '\n')
