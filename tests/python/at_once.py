"""Works in several Python threads at once: what tests of threads share."""

import threading

import mottle
import numpy as np
from test_functions import WithJacobian, frequencies, update


def at_once(*works):
    """What each work returns, all of them begun together; the first exception is raised."""
    results, barrier = [None] * len(works), threading.Barrier(len(works))

    def run(place):
        barrier.wait()
        try:
            results[place] = works[place]()
        except BaseException as error:
            results[place] = error

    threads = [threading.Thread(target=run, args=(place,)) for place in range(len(works))]
    for each in threads:
        each.start()
    for each in threads:
        each.join()
    for each in results:
        if isinstance(each, BaseException):
            raise each
    return results


def same(results):
    return all(np.array_equal(a, b) for result in results for a, b in zip(result, results[0]))


def assert_alone_and_at_once_alike(method, options, threads):
    """An update by `method` gives the same bits alone and in so many threads at once."""
    def one():
        try:
            found = update(WithJacobian() if method != "bayes" else frequencies, method=method, options=options, samples=100,
                           iterations=4)
        except mottle.Error as error:  # a method that these tests do not suit says the same to all
            return (np.frombuffer(str(error).encode(), dtype=np.uint8),)
        return found.mean, found.covariance, found.cloud_final.outputs

    assert same([one(), *at_once(*[one] * threads)])
