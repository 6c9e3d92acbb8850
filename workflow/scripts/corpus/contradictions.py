"""Keys of the configuration that contradict each other, or together make every model fail."""

from reebslice.slicing.sampling_rule import MOST_LEVELS

# The lengths in which a mesh that is read can be told: see LARGEST and SMALLEST of reebslice.mesh.faults.
LARGEST_LENGTH, SMALLEST_LENGTH = 1e75, 1e-75


def list_contradictions(config):
    """Return the faults of a complete configuration that involve more than one key, a sentence for each."""
    tilt = config["tilt"]
    faults = []
    if tilt["mode"] == "direction" and tilt["direction"] is None:
        faults.append("tilt.direction is missing: tilt.mode is 'direction', which needs direction: [x, y, z]")
    if tilt["mode"] != "direction" and tilt["direction"] is not None:
        faults.append(
            f"tilt.direction is given, but tilt.mode is {tilt['mode']!r}: write mode: direction, or remove it"
        )
    if tilt["mode"] == "direction" and tilt["up"] != "z":
        faults.append(
            f"tilt.up is {tilt['up']!r}, but tilt.mode is 'direction', which takes tilt.direction: remove one"
        )
    faults += [
        f"{group}.{key} is true, but {group}.find is false: it is made of what is found, so set both"
        for group, key in (("pockets", "cut"), ("loops", "draw"))
        if config[group][key] and not config[group]["find"]
    ]
    spread = [name for name in config["functions"] if name.startswith("directions:")]
    if len(spread) > 1:
        faults.append(f"functions names {' and '.join(spread)}: directions can be spread once, so keep one of them")
    if config["descriptors"]["find"] and not config["functions"]:
        faults.append(
            "descriptors.find is true, but functions is empty: shapes are told apart by the graphs of functions, so "
            "name some, such as functions: [geodesic, barycentre]"
        )
    if config["similarity"]["find"]:
        faults += _contradictions_of_similarity(config)
    size = max(map(abs, tilt["direction"] or [1.0]))
    if not size:
        faults.append("tilt.direction is the zero vector: at least one of its three numbers must differ from 0")
    elif not SMALLEST_LENGTH <= size <= LARGEST_LENGTH:
        faults.append(
            f"tilt.direction is {tilt['direction']!r}: its length does not count, but it must be one that can be "
            f"computed with, from {SMALLEST_LENGTH:g} to {LARGEST_LENGTH:g}; [0, 0, 1] is z"
        )
    return faults + _contradictions_of_levels(**config["levels"])


def _contradictions_of_similarity(config):
    """Return the faults of a `similarity` that is to be found: what models are compared by has to be there."""
    by = config["similarity"]["by"]
    if by == "descriptors":
        if config["descriptors"]["find"]:
            return []
        return ["similarity.find is true, but descriptors.find is false: models are compared by these, so set both"]
    if any(not name.startswith("directions:") for name in config["functions"]):
        return []
    return [
        f"similarity.by is {by!r}, but functions names none but heights, if any, which are others for a model that is "
        "turned: name some, such as functions: [geodesic, barycentre]"
    ]


def _contradictions_of_levels(distance, feature_size, units, **_):
    """Return the faults of `levels` that involve more than one key, or would make every model fail."""
    given = {"distance": distance, "feature_size": feature_size}
    given = {key: value for key, value in given.items() if value is not None}
    if not given:
        return ["levels.distance and levels.feature_size are both null: give one of them"]
    faults = []
    for key, value in given.items():
        if units == "relative" and value > 1:
            faults.append(
                f"levels.{key} is {value!r}: with units: relative it is a part of the model's height "
                "range, at most 1; for mesh units write units: absolute"
            )
        elif not SMALLEST_LENGTH / MOST_LEVELS <= value <= LARGEST_LENGTH:
            faults.append(
                f"levels.{key} is {value!r}: no mesh is so small or so large; it must be from "
                f"{SMALLEST_LENGTH / MOST_LEVELS:g} to {LARGEST_LENGTH:g}"
            )
    key, least = ("distance", 1) if distance is not None else ("feature_size", 2)
    if units == "relative" and given[key] * MOST_LEVELS < least:
        faults.append(
            f"levels.{key} is {given[key]!r}: every model would have more than the {MOST_LEVELS} levels that can be "
            f"held; it must be at least {least / MOST_LEVELS:g}"
        )
    return faults
