"""Checking the configuration, and saying in a sentence what is wrong with it."""

import difflib
import math
from pathlib import Path

import jsonschema

from reebslice.slicing.sampling_rule import sampling_rule

from .contradictions import list_contradictions

# Models of which all pairs are held against each other: by memory, and diagrams by their time, a fifth of a ms a pair.
MOST_COMPARED = {"descriptors": 20_000, "graphs": 20_000, "diagrams": 3_000}

# Of the checkout, with every key, and of the working directory, with what is another there.
CONFIG_FILE = Path("config", "config.yaml")

# What JSON schema calls a type, said to a person.
TYPES = {
    "object": "a group of keys",
    "array": "a list",
    "string": "a text",
    "number": "a number",
    "integer": "a whole number",
    "boolean": "true or false",
    "null": "null",
}


class ConfigError(ValueError):
    """The configuration, or the sheet of models, cannot be used; one line per fault: place, value, what is allowed."""

    def __init__(self, text, faults=()):
        super().__init__("\n".join([text, *(f"  {fault}" for fault in faults)]))
        self.faults = tuple(faults)


def check_config(config, schema):
    """Return the configuration, complete and in the schema's order.

    Keys left out take the schema's default. Of `levels`, distance and
    feature size follow from each other where one is null.

    Raises ConfigError, which lists every fault.
    """
    config = _read_texts(config, schema)
    validator = jsonschema.Draft202012Validator(schema)
    errors = sorted(validator.iter_errors(config), key=lambda error: str(error.path))
    faults = [_say(error) for error in errors] + list(_nonfinite(config))
    if not faults:
        config = _complete(config, schema)
        faults = list_contradictions(config)
    if faults:
        raise ConfigError("the configuration cannot be used:", faults)
    levels = config["levels"]
    levels["distance"], levels["feature_size"] = sampling_rule(levels["distance"], levels["feature_size"])
    return config


def restore_texts(config, arguments, schema):
    """Return the configuration with texts of the command line as they were typed.

    Snakemake reads each `--config KEY=VALUE` as a number, or as true or false,
    where it can: a folder called 007 arrives as 7.

    Parameters
    ----------
    config : dict
    arguments : iterable of str
        The entries of `--config`, as typed.
    schema : dict
        Of its keys on the top level, those that may be a string are restored.
    """
    typed = dict(argument.split("=", 1) for argument in arguments if "=" in argument)
    texts = {key for key, part in schema["properties"].items() if "string" in _kinds(part)}
    texts -= {key for key, value in config.items() if isinstance(value, (list, dict))}
    return config | {key: value.strip("'\"") for key, value in typed.items() if key in texts}


def _kinds(schema):
    """Return the types that a schema allows."""
    kinds = schema.get("type", ())
    return (kinds,) if isinstance(kinds, str) else tuple(kinds)


def describe_sources(files, given_files, given_keys):
    """Return a sentence's part on where the configuration comes from, the later winning over the earlier.

    Parameters
    ----------
    files : sequence of path
        Of the checkout and of the working directory.
    given_files : sequence of path
        Of `--configfile`.
    given_keys : mapping of str to object
        Of `--config`.
    """
    told = [str(file) for file in files] + [f"--configfile {file}" for file in given_files]
    if given_keys:
        told.append(f"--config {' '.join(given_keys)}")
    return ", then ".join(told)


def _read_texts(value, schema):
    """Read values as what the schema asks for where that is plain: '0.02', 15 and '1e-6' as numbers.

    On the command line, `--config levels='{distance: 0.02}'` hands over the
    text '0.02' and `--config meshes=2024` a number; in a file, YAML takes
    1e-6, without a point, for a text. That 15 and 15.0 are one value keeps
    results that were made with the other, and a schema takes 64.0 for a whole
    number, which counts nothing in Python.
    """
    if isinstance(value, dict):
        parts = schema.get("properties", {})
        return {key: _read_texts(entry, parts.get(key, {})) for key, entry in value.items()}
    if isinstance(value, list):
        return [_read_texts(entry, schema.get("items", {})) for entry in value]
    kinds = _kinds(schema)
    if isinstance(value, str) and "null" in kinds and value in ("null", "~", ""):
        return None
    if kinds == ("boolean",) and value in ("true", "false"):  # as --config verify=true hands over
        return value == "true"
    if "string" in kinds and type(value) in (int, float):
        return str(value)
    if kinds == ("integer",) and type(value) is float and value.is_integer():
        return int(value)
    if (isinstance(value, str) and {"integer", "number"} & set(kinds)) or (type(value) is int and "number" in kinds):
        try:
            return float(value) if "number" in kinds else int(value)
        except ValueError:
            pass
    return value


def _complete(value, schema):
    """Fill in defaults, group by group, in the schema's order of keys."""
    if schema.get("type") != "object":
        return value
    return {key: _complete(value.get(key, part.get("default", {})), part) for key, part in schema["properties"].items()}


def _nonfinite(value, place=""):
    """Yield a fault for every number that is infinite or none, which a schema lets pass."""
    if isinstance(value, float) and not math.isfinite(value):
        yield f"{place} is {value!r}: must be a finite number"
    entries = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, entry in entries:
        yield from _nonfinite(entry, f"{place}[{key}]" if isinstance(value, list) else _join(place, key))


def check_comparison(config, number):
    """Raise ConfigError where so many models cannot be compared with each other."""
    by = config["similarity"]["by"]
    if config["similarity"]["find"] and number > MOST_COMPARED[by]:
        raise ConfigError(
            f"similarity.by is {by!r}, and there are {number} models: at most {MOST_COMPARED[by]} can be compared in "
            f"this way{', but more by descriptors' if by == 'diagrams' else ''}; choose some by the key only, or set "
            "similarity.find to false"
        )


# --------------------------------------------------------------------------
# Sentences


def _say(error):
    """Turn one violation of the schema into a sentence."""
    place = ".".join(str(part) if isinstance(part, str) else f"[{part}]" for part in error.path).replace(".[", "[")
    if error.validator == "additionalProperties":
        return _say_unknown(place, error)
    if error.validator == "required":
        missing = next(key for key in error.validator_value if key not in error.instance)
        return f"{_join(place, missing)} is missing"
    found = f"{place or 'the configuration'} is {_show(error.instance)}"
    return f"{found}: {_allowed(error)}"


def _say_unknown(place, error):
    known = list(error.schema["properties"])
    sentences = []
    for key in (str(key) for key in error.instance if key not in known):
        near = near_word(key, known)
        guess = f"did you mean {_join(place, near)}? " if near else ""
        allowed = f"allowed {'in ' + place if place else 'at the top'}: {', '.join(known)}"
        sentences.append(f"{_join(place, key)} is not a key; {guess}{allowed}")
    return "\n  ".join(sentences)


def near_word(word, words):
    """Return the one of some words that is nearest to another, or None where none is near."""
    return next(iter(difflib.get_close_matches(word, words, n=1, cutoff=0.5)), None)


def _allowed(error):
    """Say what the schema allows at the place of the violation."""
    limit, rule = error.validator_value, error.validator
    says = {
        "type": lambda: f"must be {_types(limit)}",
        "enum": lambda: f"must be {_alternatives(map(repr, limit))}{_nearest(error.instance, limit)}",
        "minimum": lambda: f"must be at least {limit}",
        "maximum": lambda: f"must be at most {limit}",
        "exclusiveMinimum": lambda: f"must be more than {limit}",
        "exclusiveMaximum": lambda: f"must be less than {limit}",
        "minItems": lambda: f"must have at least {limit} entries",
        "maxItems": lambda: f"must have at most {limit} entries",
        "minLength": lambda: "must not be empty",
        "uniqueItems": lambda: "must not name anything twice",
        "pattern": lambda: f"must be {error.schema['description']}",
    }
    return says[rule]() if rule in says else error.message


def _types(kinds):
    return _alternatives(TYPES[kind] for kind in ([kinds] if isinstance(kinds, str) else kinds))


def _alternatives(words):
    *first, last = words
    return f"{', '.join(first)} or {last}" if first else last


def _nearest(value, allowed):
    near = difflib.get_close_matches(str(value), [str(word) for word in allowed], n=1)
    return f"; did you mean {near[0]!r}?" if near else ""


def _show(value):
    return "null" if value is None else str(value).lower() if isinstance(value, bool) else repr(value)


def _join(place, key):
    return f"{place}.{key}" if place else str(key)
