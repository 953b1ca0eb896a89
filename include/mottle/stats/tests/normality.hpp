// Tests of normality of a population from the estimates of its specimens.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/stats/population/random_effects.hpp"

namespace mottle::stats {

/// Statistics of normality of a sample.
struct NormalityStatistics {
  double shapiro_wilk = 1.0;  ///< W, 1 where the ordered values are those of a normal sample
  /// Engelman and Hartigan's ratio: largest sum of squares between two batches, split at a value, to that within them;
  /// each batch has a fifth of the values at least.
  double two_batches = 0.0;
  double skewness = 0.0;         ///< m3 / m2^(3/2)
  Eigen::Index lower_batch = 0;  ///< values below the best split
};

/// W with Royston's weights. Source: [Shapiro1965]; [Royston1995]; [Engelman1969].
/// @param values  at least 5, not all equal
NormalityStatistics normality_statistics(const Eigen::Ref<const Eigen::VectorXd>& values);

/// Probabilities that a normal sample has statistics at least as extreme.
struct NormalityProbabilities {
  double p_value = 1.0;      ///< of W and of two batches together
  double two_batches = 1.0;  ///< of two batches alone
};
/// By 1999 normal samples of the same size, with fixed streams.
NormalityProbabilities normality_probabilities(const NormalityStatistics& statistics, Eigen::Index size);

/// Henze and Zirkler's statistic: a weighted distance between the characteristic functions of a sample and of a normal
/// population with its moments.
/// @param samples  [specimen x variable], more specimens than variables
/// Source: [Henze1990].
double henze_zirkler(const Eigen::Ref<const Eigen::MatrixXd>& samples);

/// One variable's own estimates of the specimens.
struct VariableNormality {
  /// Each estimate over its own standard deviation, scaled to the population's units, mean 0; nan: the specimen hardly
  /// determines it [specimen].
  Eigen::VectorXd scores;
  double reliability = 0.0;  ///< mean fraction of the estimates' variance that is the population's, not noise
  NormalityStatistics statistics;
  NormalityProbabilities probabilities;
  bool is_tested = false;  ///< five specimens or more
};

struct NormalityTest {
  std::vector<VariableNormality> variables;
  double henze_zirkler = 0.0;
  double henze_zirkler_p = 1.0;
  bool is_joint_tested = false;  ///< enough specimens determine all variables
  double p_value = 1.0;          ///< probability that a normal population is as extreme in any of these
  int tests = 0;

  /// Of one of the tests, where all together have this level.
  double level_of_each(double level) const;
};

/// Tests the estimates E[x | y] of the specimens, each in its own standard deviations: where its test has noise or
/// lacks entries, that is less than the population's. Shapiro and Wilk's W and a split in two batches for each
/// variable, Henze and Zirkler's statistic for all; references by simulation; Sidak's correction over the variables and
/// the last.
///
/// @param map  variables of effects [variable x effect]
NormalityTest test_normality(const std::vector<RandomEffectsUnit>& units, const RandomEffectsFit& fit,
                             const Eigen::Ref<const Eigen::MatrixXd>& map);

}  // namespace mottle::stats
