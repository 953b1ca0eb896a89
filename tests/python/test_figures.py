"""Figures and tables of a result."""

import numpy as np
import pytest

import mottle


@pytest.fixture
def posterior(examples):
    return mottle.Study.read(examples / "01-three-masses" / "case1.toml", {
        "update.method": "bayes", "update.bayes.particles": 200, "test.repeatability": {"f*": "1 %"}}).update()


def test_figures_show_pairs(posterior):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    for figure, names in ((posterior.plot.ellipses(), posterior.outputs), (posterior.plot.parameters(), posterior.parameters)):
        shown = {(axes.get_xlabel(), axes.get_ylabel()) for axes in figure.axes if axes.get_visible()}
        assert shown == {(names[0], names[1]), (names[0], names[2]), (names[1], names[2])}
        figure.canvas.draw()


def test_the_ellipse_holds_95_per_cent():
    from mottle.plots import ellipse

    mean, covariance = np.array([1.0, 2.0]), np.array([[2.0, 0.6], [0.6, 0.5]])
    outline = ellipse(mean, covariance) - mean
    distance = np.einsum("ij,jk,ik->i", outline, np.linalg.inv(covariance), outline)
    assert np.allclose(distance, -2.0 * np.log(0.05), rtol=1e-10)


def test_posteriors_as_xarray(posterior):
    pytest.importorskip("xarray")
    draws = posterior.posterior.to_xarray()
    assert dict(draws.sizes) == {"chain": 8, "draw": 200}
    assert np.array_equal(draws["k1"].values, posterior.posterior.draws[:, :, 0])
    assert np.isclose(float(draws["k1"].mean()), posterior.mean[0], rtol=1e-12)
