"""The ledger: every check by name with its two sides."""

import numpy as np


class Ledger:
    """The checks made so far: {name: {found, expected, holds, says}}."""

    def __init__(self):
        self.checks = {}

    def enter(self, name, found, expected, holds=None, says=""):
        """Enter a check.

        Parameters
        ----------
        name : str
        found, expected
            Its two sides.
        holds : bool, optional
            Whether it holds; if not given, whether the two sides are equal.
        says : str
            What differs.
        """
        holds = found == expected if holds is None else holds
        self.checks[name] = {"found": _plain(found), "expected": _plain(expected), "holds": bool(holds), "says": says}

    def rows(self, name, agree, what):
        """Enter a check of the rows of a table.

        Parameters
        ----------
        name : str
        agree : (n,) bool
            All must.
        what : str
            What each row is held against.
        """
        agree = np.asarray(agree, bool)
        wrong = np.flatnonzero(~agree)
        says = f"{len(wrong)} of {len(agree)} rows differ: {what}; the first is row {wrong[0]}." if len(wrong) else ""
        self.enter(name, int(agree.sum()), len(agree), says=says)

    def compare(self, name, stated, *columns):
        """Enter a check of each of some columns.

        Parameters
        ----------
        name : str
            What the columns are of; a check is called `name`.column.
        stated : dict
            {column: array or list}.
        *columns : tuple
            (column, expected, what), and a fourth where numbers may differ: by how much.
        """
        for column, expected, what, *room in columns:
            self.rows(f"{name}.{column}", agree(stated[column], expected, *room), what)

    def close(self, name, found, expected, tolerance):
        """Enter a check of two numbers.

        Parameters
        ----------
        name : str
        found, expected : float
        tolerance : float
            By how much they may differ.
        """
        holds = bool(abs(found - expected) <= tolerance)
        says = "" if holds else f"They differ by more than {tolerance:.3g}."
        self.enter(name, float(found), float(expected), holds, says)

    def holds(self):
        """Tell whether there are checks and all of them hold."""
        return bool(self.checks) and all(check["holds"] for check in self.checks.values())


def agree(found, expected, room=None):
    """Tell which members of two columns are equal, or differ by no more than `room`; NaN is equal to NaN then.

    Parameters
    ----------
    found, expected : (n,) array or list
    room : float or (n,) float64, optional

    Returns
    -------
    (n,) bool
    """
    if room is not None:
        return (np.abs(found - expected) <= room) | (np.isnan(found) & np.isnan(expected))
    if isinstance(found, list) or isinstance(expected, list):
        return [one == other for one, other in zip(found, expected)]
    return found == expected


def _plain(value):
    """A value as JSON can hold it."""
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not np.isfinite(value):
        return str(value)
    if isinstance(value, dict):
        return {str(name): _plain(entry) for name, entry in value.items()}
    return [_plain(entry) for entry in value] if isinstance(value, (list, tuple, np.ndarray)) else value
