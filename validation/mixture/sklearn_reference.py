#!/usr/bin/env python3
"""Prints the reference values of tests/stats/population/normal_mixture_test.cpp by scikit-learn (Debian's python3-sklearn)."""
import numpy as np
from sklearn.mixture import GaussianMixture

POINTS = np.array([
    [1.2, 0.3], [0.8, -0.4], [1.9, 0.9], [0.1, 0.2], [1.4, -0.8], [0.6, 1.1], [2.2, 0.1], [1.0, 0.7], [-0.3, -0.2], [1.6, 1.5],
    [4.1, 3.2], [5.0, 2.1], [4.6, 3.9], [3.7, 2.4], [5.6, 3.3], [4.3, 1.2], [3.2, 2.9], [2.9, 1.4]])

for kind in ("full", "tied"):
    fit = GaussianMixture(2, covariance_type=kind, tol=1e-13, max_iter=20000, reg_covar=0, means_init=[[1, 0], [4.5, 2.5]]).fit(POINTS)
    print(kind, "log-likelihood", fit.score(POINTS) * len(POINTS), "weights", fit.weights_, "means", fit.means_.tolist(),
          "covariances", fit.covariances_.tolist(), "probabilities", fit.predict_proba(POINTS)[[9, 17]].tolist())
