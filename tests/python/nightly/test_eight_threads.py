"""Eight Python threads at once by every method: each gets the bits that it would get alone, with its usual options."""

import mottle
import pytest
from at_once import assert_alone_and_at_once_alike


@pytest.mark.parametrize("method", sorted(mottle.methods()))
def test_every_method_gives_the_bits_that_it_gives_alone(method):
    assert_alone_and_at_once_alike(method, {"particles": 100} if method == "bayes" else {}, threads=8)
