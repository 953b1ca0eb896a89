// Models of the same data compared by estimates of their evidence.
#pragma once

#include <vector>

#include "mottle/layers.hpp"

namespace mottle::stats {

/// ln evidence of a model as independent runs of a sampler, or independent draws, estimate it.
struct EstimatedEvidence {
  double log_evidence = 0.0;
  double standard_error = 0.0;      ///< >= 0
  double degrees_of_freedom = 1.0;  ///< of the standard error, >= 1: runs or draws less one
};

/// One of several models.
struct ModelProbability {
  /// ln of the best model's evidence over this one's: by how much the data change the odds between them. 0: the best.
  double log_bayes_factor = 0.0;
  double standard_error = 0.0;  ///< of it; 0 of the best
  double probability = 0.0;     ///< of the model where all were equally probable before the data
  double lower = 0.0;           ///< ends of the 95 % interval of `probability` by the evidences' standard errors
  double upper = 1.0;
  /// What is left to 1, of the probability and of both ends: with digits where they round to 1.
  double rest = 1.0, rest_of_lower = 1.0, rest_of_upper = 0.0;
};

/// Bayes factors and probabilities, by errors that are independent of each other.
///
///   ln B_i = ln Z_best - ln Z_i,            se^2 = se_best^2 + se_i^2
///   logit P_i = ln Z_i - ln sum_j Z_j,      se^2 = se_i^2 + sum_j (Z_j / sum_k Z_k)^2 se_j^2,   j, k other than i
///
/// The interval is that of logit P_i to first order, by Student's t with Welch and Satterthwaite's degrees of freedom:
/// it holds where the standard errors are small beside 1, and knows nothing of a bias of the evidences.
///
/// @param evidences      two models or more
/// @throws InvalidInput  fewer, an evidence that is not finite, an error below 0, degrees of freedom below 1
/// Source: [Kass1995].
std::vector<ModelProbability> compare_evidences(const std::vector<EstimatedEvidence>& evidences);

/// "not worth more than a bare mention", "positive", "strong", "very strong": the scale of [Kass1995] for 2 ln B (below
/// 2, 6, 10, beyond).
const char* evidence_strength(double log_bayes_factor);

}  // namespace mottle::stats
