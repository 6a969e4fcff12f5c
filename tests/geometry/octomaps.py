"""A writer of OctoMaps, to test with."""

ROOT = 1 << 15


def written(cells, low=(-ROOT,) * 3, width=2 * ROOT):
    """The bytes of a node and the number of nodes below, for cells (x, y, z); a full cube is one leaf."""
    half, bits, below, count = width // 2, 0, b"", 0
    for i in range(8):
        first = [low[axis] + half * (i >> axis & 1) for axis in range(3)]
        mine = [cell for cell in cells if all(first[a] <= cell[a] < first[a] + half for a in range(3))]
        if len(mine) == half**3:
            bits, count = bits | 2 << 2 * i, count + 1
        elif mine:
            inside, more = written(mine, first, half)
            bits, below, count = bits | 3 << 2 * i, below + inside, count + 1 + more
    return bits.to_bytes(2, "little") + below, count


def octomap(folder, cells, resolution=0.1, cut=0, name="map.bt"):
    data, count = written(cells)
    head = f"# Octomap OcTree binary file\nid OcTree\nsize {count + 1}\nres {resolution}\ndata\n"
    path = folder / name
    path.write_bytes(head.encode() + data[: len(data) - cut])
    return path
