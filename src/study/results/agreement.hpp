// How well the first and the last cloud of an update reproduce its tests: mean and scatter of every output, and how
// many tests lie within the cloud. It describes; whether the model can be right is the verdict's to say.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/updater.hpp"
#include "study/results/result_json.hpp"

namespace mottle::study {

/// One output of a cloud against the tests; nan where it cannot be said.
struct CloudComparison {
  double mean_difference = 0.0;  ///< model minus tests, in the output's unit
  double mean_error = 0.0;       ///< the same as a fraction of the tests' mean; near a node of a shape, see
                                 ///< model::reference_sizes()
  double standard_errors = 0.0;  ///< the same in standard errors of the difference
  double std_ratio = 0.0;        ///< standard deviation of the model with the known noise over that of the tests
};

/// One output of the first and the last cloud.
struct OutputAgreement {
  Eigen::Index output = 0;
  CloudComparison initial;
  CloudComparison final;
  double critical_standard_errors = 0.0;  ///< beyond it the means differ
  double min_std_ratio = 0.0;             ///< what chance allows of `std_ratio`; nan: not known
  double max_std_ratio = 0.0;
  std::optional<bool> is_mean_reproduced = std::nullopt;     ///< by the last cloud; nothing: not known
  std::optional<bool> is_scatter_reproduced = std::nullopt;  ///< the same

  /// How far the scatter is off, 1 at the limit of chance; nan where it cannot be said.
  double scatter_misfit() const;
  /// How far the worse of mean and scatter is off, 1 at the limit of chance.
  double misfit() const;
};

/// Complete tests within the region that contains `probability` of a cloud.
struct RegionAgreement {
  double probability = 0.95;
  int tests = 0;
  std::optional<int> initial = std::nullopt;  ///< within that of the first cloud; nothing: it has no region
  int final = 0;
  int min_inside = 0;  ///< fewer lie inside in less than one of a hundred cases, if tests and cloud are one population

  /// Whether its count says something: with more outputs than parameters and noise that is not stated, a region without
  /// that noise is too thin for any tests.
  bool is_judged = true;

  bool is_reproduced() const { return !is_judged || final >= min_inside; }
};

struct Agreement {
  std::vector<OutputAgreement> outputs;  ///< the worst first
  std::optional<RegionAgreement> region = std::nullopt;

  bool are_means_reproduced() const;   ///< no output's mean is known to differ
  bool is_scatter_reproduced() const;  ///< no output's scatter is known to differ, and the region has enough tests
};

/// Probability that any limit of chance of a kind (means, scatter, region) is passed, for all outputs together.
inline constexpr double k_chance = 0.01;

/// Compares the clouds with the tests. With the cloud's mean y and variance C, the tests' mean z and variance V of n
/// specimens, the known noise R and the model's error D:
///
///   |y - z| <= t(n - 1; 1 - a / 2p) sqrt(V / n + C / N + D),   (n - 1) V / (C + R) within chi2(n - 1; a / 2p, 1 - a /
///   2p)
///
/// and z_s' within the region of the cloud where (z_s - y)' (C + R + D)^-1 (z_s - y) <= T^2 of one against N. The
/// limits hold for p outputs together with probability 1 - a (Bonferroni), a = k_chance, for independent specimens and
/// normal outputs. The estimate is fitted to the same tests, so a right model passes them more seldom.
///
/// @param result  with a first and a last cloud
Agreement compare_with_tests(const UpdatingProblem& problem, const UpdatingResult& result);

/// `agreement` of result.json.
Json agreement_json(const Agreement& agreement, const std::vector<Quantity>& outputs);

}  // namespace mottle::study
