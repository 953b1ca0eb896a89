"""Populations by restricted maximum likelihood, against closed forms and statsmodels."""

import numpy as np
import pytest

import mottle


def specimens(count, seed=1):
    rng = np.random.default_rng(seed)
    scatter = rng.normal(size=(3, 3))
    return rng.multivariate_normal([10.0, 20.0, 5.0], scatter @ scatter.T + 2.0 * np.eye(3), count)


def test_of_balanced_data_it_is_the_sample_covariance_less_that_of_the_noise():
    values, noise = specimens(12), np.array([0.3, 0.5, 0.2])
    found = mottle.reml(values, noise=noise)
    sample = np.cov(values, rowvar=False)
    assert found.converged and found.noise_factor == 1.0
    assert np.allclose(found.mean, values.mean(axis=0), rtol=1e-12)
    assert np.allclose(found.covariance, sample - np.diag(noise**2), rtol=1e-6)
    assert np.allclose(found.mean_covariance, sample / 12, rtol=1e-6)
    variances = np.diag(sample)
    wishart = np.sqrt((np.outer(variances, variances) + sample**2) / 11)  # of a sample covariance's entries
    assert np.allclose(found.covariance_errors, wishart, rtol=1e-5)
    shrunk = np.eye(3) - np.diag(noise**2) @ np.linalg.inv(sample)
    assert np.allclose(found.effects, found.mean + (values - found.mean) @ shrunk.T, rtol=1e-6)


def test_maximum_likelihood_divides_by_the_number_of_specimens():
    values = specimens(9)
    found = mottle.reml(values, noise=0.1, restricted=False)
    assert np.allclose(found.covariance, np.cov(values, rowvar=False, bias=True) - 0.01 * np.eye(3), rtol=1e-6)


def test_a_missing_value_leaves_a_specimen_its_others():
    # Bivariate normal, the second output missing for the last specimens: the factored likelihood [Anderson 1957] has a
    # closed form for maximum likelihood.
    values = specimens(20)[:, :2]
    values[14:, 1] = np.nan
    found = mottle.reml(values, restricted=False, tolerance=1e-12, iterations=20000)
    x, y = values[:14].T
    slope = np.cov(x, y, bias=True)[0, 1] / x.var()
    mean, variance = values[:, 0].mean(), values[:, 0].var()
    residual = (y - y.mean() - slope * (x - x.mean())).var()
    assert np.allclose(found.mean, [mean, y.mean() + slope * (mean - x.mean())], rtol=1e-8)
    wanted = [[variance, slope * variance], [slope * variance, residual + slope**2 * variance]]
    assert np.allclose(found.covariance, wanted, rtol=1e-6)


def test_random_slopes_beside_statsmodels():
    mixed = pytest.importorskip("statsmodels.regression.mixed_linear_model")
    rng = np.random.default_rng(5)
    times = np.arange(6.0)
    design = np.column_stack([np.ones(6), times])
    effects = rng.multivariate_normal([3.0, 0.7], [[1.0, 0.15], [0.15, 0.09]], 30)
    values = effects @ design.T + rng.normal(scale=0.4, size=(30, 6))
    found = mottle.reml(values, design=design, noise_is_known=False, tolerance=1e-10, iterations=20000)
    theirs = mixed.MixedLM(values.ravel(), np.tile(design, (30, 1)), groups=np.repeat(np.arange(30), 6),
                           exog_re=np.tile(design, (30, 1))).fit(reml=True, method="lbfgs")
    assert np.allclose(found.mean, theirs.fe_params, rtol=1e-6)
    assert np.allclose(found.covariance, theirs.cov_re, rtol=1e-3)
    assert np.isclose(found.noise_factor, theirs.scale, rtol=1e-4)
    assert np.allclose(found.mean_errors, theirs.bse_fe, rtol=1e-3)


def test_designs_may_differ_and_tables_be_named():
    pandas = pytest.importorskip("pandas")
    rng = np.random.default_rng(6)
    design = rng.normal(size=(8, 3, 2))
    effects = rng.normal(size=(8, 2)) + [5.0, -2.0]
    values = np.einsum("soe,se->so", design, effects)
    found = mottle.reml(values, design=design, noise=1e-4)  # hardly any noise: the effects are seen as they are
    assert np.allclose(found.effects, effects, atol=2e-3)
    assert np.allclose(found.covariance, np.cov(effects, rowvar=False), rtol=2e-3)
    table = pandas.DataFrame(specimens(6), columns=["a", "b", "c"])
    by_name = mottle.reml(table, noise={"c": 0.4})
    assert np.array_equal(by_name.covariance, mottle.reml(table.to_numpy(), noise=[0.0, 0.0, 0.4]).covariance)
    assert "mottle.Population: " in repr(by_name)


def test_what_does_not_fit_is_refused():
    values = specimens(5)
    for options, message in [({"noise": -1.0}, "negative"), ({"noise": np.ones((4, 3))}, "noise: shape"),
                             ({"design": np.eye(2)}, "design: shape"), ({"design": np.full((3, 2), np.nan)}, "not finite"),
                             ({"iterations": 0}, "iterations"), ({"restricted": 1}, "True or False"),
                             ({"design": np.ones((3, 2)), "noise": 1.0}, "mean")]:
        with pytest.raises(mottle.InvalidInput, match=message):
            mottle.reml(values, **options)
    with pytest.raises(mottle.InvalidInput, match="at least 2"):
        mottle.reml(values[:1])
    with pytest.raises(mottle.InvalidInput, match="infinite"):
        mottle.reml(values * np.inf)
    with pytest.raises(mottle.InvalidInput, match="values"):
        mottle.reml(values[0])


def test_more_outputs_than_effects_need_noise():
    with pytest.raises(mottle.InvalidInput, match="noise"):
        mottle.reml(specimens(5), design=np.array([[1.0], [1.0], [2.0]]))
