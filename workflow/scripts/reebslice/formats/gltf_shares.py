"""Bounds on what the few bytes of a glTF 2.0 file can ask for any number of times."""

from ..errors import MeshFormatError

# A few bytes can place a mesh, or name the elements of a buffer, any number of times. How many are read of what: so
# many of any file, and so many for each byte of a larger one. What a file holds once is always fewer.
MOST = {"elements": (2**26, 256), "vertices": (2**22, 4), "faces": (2**22, 4), "places": (2**20, 1 / 2)}


def weigh(asset):
    """Return how many bytes the file has, and the buffers beside it that were read so far."""
    return asset.path.stat().st_size + sum(map(len, asset.files.values()))


def take_share(asset, kind, count):
    """Count what a few bytes can ask for any number of times, and refuse what is beyond its bound.

    Parameters
    ----------
    asset : Asset
    kind : str
        A key of `MOST`.
    count : int
        How many more there will be.

    Raises
    ------
    MeshFormatError
        With them there are more than both numbers of `MOST` allow: that many,
        and that many for each byte of the file.
    """
    asset.counts[kind] += count
    free, each = MOST[kind]
    if asset.counts[kind] > free and asset.counts[kind] > (most := max(free, int(each * weigh(asset)))):
        raise MeshFormatError(
            f"The scene asks for {asset.counts[kind]} {kind} and more, of a file of {weigh(asset)} bytes; at most"
            f" {most} are read from it: refer to each mesh fewer times, or show fewer instances."
        )
