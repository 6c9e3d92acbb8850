"""Sorts of floats inside kernels, held against numpy's."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from reebslice.arrays.sorting import order_floats, sort_floats

floats = st.lists(st.floats(allow_nan=False) | st.sampled_from([0.0, -0.0, 1.0, 2.0]), max_size=60)


@given(floats)
def test_sorted_like_numpy(values):
    numbers = np.array(values, float)
    expected = np.sort(numbers)
    sort_floats(numbers)
    assert np.array_equal(numbers, expected)


@given(floats)
def test_ordered_like_numpy_equal_ones_as_they_come(values):
    numbers = np.array(values, float)
    assert np.array_equal(order_floats(numbers), np.argsort(numbers, kind="stable"))


@pytest.mark.parametrize("count", [0, 1, 2, 3, 1000, 1024, 5000])
@pytest.mark.parametrize("distinct", [2, 50, 10**6])
def test_many(count, distinct):
    numbers = np.random.default_rng(count).integers(0, distinct, count).astype(float)
    assert np.array_equal(order_floats(numbers), np.argsort(numbers, kind="stable"))
    expected = np.sort(numbers)
    sort_floats(numbers)
    assert np.array_equal(numbers, expected)
