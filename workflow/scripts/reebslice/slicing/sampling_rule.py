"""The paper's sampling rule, apart from all that takes time to load: planning a run asks for it, too."""

MOST_LEVELS = 1_000_000  # each takes rows of tables and objects of Python, some kilobytes of memory


def sampling_rule(distance, feature_size):
    """Apply the paper's sampling rule: features of size d need levels at a distance of d / 2.

    Parameters
    ----------
    distance, feature_size : float or None
        Distance between levels and size of the smallest feature to be told apart; one may be missing.

    Returns
    -------
    distance, feature_size : float
        Both, the missing one by the rule.
    """
    distance = feature_size / 2 if distance is None else distance
    return float(distance), float(2 * distance if feature_size is None else feature_size)
