"""The sheet of models: what of the configuration is another for some of them.

A table of tab-separated columns with a header, one row per model or pattern.
Whatever a row says becomes keys of the configuration of its models, which is
then checked as a whole, so the sheet allows what the configuration allows.
"""

import csv
import re
from pathlib import Path

from .configuration import ConfigError, check_config, near_word
from .discovery import match_models, tell_near

COLUMNS = ("model", "direction", "distance", "feature_size", "unit", "up")


def read_sheet(path, models, config, schema):
    """Return the configuration of every model of which a sheet says something.

    Parameters
    ----------
    path : str or None
        Of the sheet; None for none. There need be none where the schema's default would have it.
    models : container of str
        Ids of all models that there are.
    config, schema
        The configuration for all models, as :func:`.configuration.check_config` takes it.

    Returns
    -------
    dict of str to dict
        Checked configurations by id. Where several rows match a model, the
        cells of the later one win.

    Raises
    ------
    ConfigError
        Lists every fault of the sheet, with its line.
    """
    if path is None or (path == schema["properties"]["models"]["default"] and not Path(path).exists()):
        return {}
    faults, cells, named = [], {}, {}
    for line, row in _read_rows(path, faults):
        pattern = row.pop("model", "")
        if named.setdefault(pattern, line) != line and pattern:
            faults.append(f"line {line}: {pattern!r} has a row already, line {named[pattern]}")
        for model in _match(pattern, models, line, faults):
            cells.setdefault(model, {}).update({column: (line, text) for column, text in row.items()})
    rows = {model: tuple((column, *cell) for column, cell in sorted(row.items())) for model, row in cells.items()}
    configured = {row: _configure(row, config, schema, faults) for row in dict.fromkeys(rows.values()) if row}
    if faults:
        raise ConfigError(f"{path} cannot be used:", sorted(dict.fromkeys(faults), key=_line_of))
    return {model: configured[row] for model, row in rows.items() if row}


def _configure(row, config, schema, faults):
    """Return the configuration that the cells (column, line, text) make of that for all models."""
    overrides = _make_overrides({column: text for column, _, text in row if column in COLUMNS}, config)
    try:
        return check_config(_merge(config, overrides), schema)
    except ConfigError as error:
        lines = " and ".join(map(str, sorted({line for _, line, _ in row})))
        faults += [f"line {lines}: {fault}" for fault in error.faults]
        return None


def _line_of(fault):
    return int(re.match(r"line (\d+)", fault)[1])


def _read_rows(path, faults):
    """Return (line, cells that are not empty by column) of the rows of a sheet."""
    try:
        text = Path(path).read_text("utf-8-sig")
    except OSError as fault:
        cure = "name another file by the key models, or null for none"
        raise ConfigError(f"{path} cannot be used:", [f"it cannot be read ({fault.strerror}); {cure}"]) from None
    except UnicodeDecodeError:
        raise ConfigError(f"{path} cannot be used:", ["it is no text in UTF-8"]) from None
    lines = csv.reader(text.splitlines(), delimiter="\t")
    rows = [(lines.line_num, [cell.strip() for cell in row]) for row in lines]
    rows = [(line, row) for line, row in rows if any(row) and not row[0].startswith("#")]
    (first, header), *rows = rows or [(1, [])]
    faults += [f"line {first}: {fault}" for fault in _check_header(header)]
    for line, row in rows:
        if len(row) > len(header):
            faults.append(f"line {line}: has {len(row)} cells for {len(header)} columns, which tabs separate")
    return [(line, {name: cell for name, cell in zip(header, row, strict=False) if cell}) for line, row in rows]


def _check_header(header):
    """Return the faults of the names of the columns."""
    known = f"allowed, with tabs between: {', '.join(COLUMNS)}"
    faults = []
    for name in header:
        near = near_word(name, COLUMNS)
        if name not in COLUMNS:
            faults.append(f"{name!r} is not a column; {f'did you mean {near!r}? ' if near else ''}{known}")
        elif header.count(name) > 1:
            faults.append(f"the column {name!r} is there twice")
    if "model" not in header:
        faults.append(f"there is no column 'model'; {known}")
    return list(dict.fromkeys(faults))


def _match(pattern, models, line, faults):
    """Return the models that a row is about."""
    if not pattern:
        faults.append(f"line {line}: the model is not named")
        return []
    matching = match_models(models, pattern)
    if not matching:
        faults.append(f"line {line}: {pattern!r} matches none of {len(models)} models; {tell_near(pattern, models)}")
    return matching


def _make_overrides(row, config):
    """Return the keys of the configuration that the cells of a row stand for."""
    tilt, levels = {}, {}
    if "up" in row:
        tilt |= {"up": row["up"]}
        if config.get("tilt", {}).get("mode") == "direction":
            tilt |= {"mode": "auto", "direction": None}
    if "direction" in row:
        numbers = re.split(r"[\s,;]+", row["direction"].strip("[]() "))
        tilt = {"up": "z"} | tilt | {"mode": "direction", "direction": numbers}
    if "distance" in row or "feature_size" in row:  # of one that is not given, the other one decides
        levels = {"distance": row.get("distance"), "feature_size": row.get("feature_size")}
    inspect = {"unit": row["unit"]} if "unit" in row else {}
    return {"tilt": tilt, "levels": levels, "inspect": inspect}


def _merge(config, overrides):
    """Return the configuration with the keys of some groups replaced."""
    return config | {group: (config.get(group) or {}) | keys for group, keys in overrides.items()}
