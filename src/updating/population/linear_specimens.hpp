// Specimens whose tests are linear in their parameters about a point of each: their densities given a population, in
// closed form, and draws of their parameters.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "mottle/layers.hpp"
#include "updating/fits/specimen_fit.hpp"
#include "updating/population/population_prior.hpp"

namespace mottle::updating {

/// One specimen's test about a point t0 of its parameters: z = f(t0) + G (t - t0) + d + e.
struct LinearSpecimen {
  std::vector<Eigen::Index> outputs;  ///< that were measured
  Eigen::VectorXd point;              ///< t0 [parameter]
  Eigen::MatrixXd design;             ///< G [measured x parameter]
  Eigen::VectorXd residual;           ///< z - f(t0) [measured]
};

/// Room for a specimen's algebra, and what it found last.
///
/// With t = mu + F w, w ~ N(0, 1), and r = R^-1/2 (z - f(t0) - d - G (mu - t0)) under noise R the test is r = D w + e,
/// D = R^-1/2 G F, e ~ N(0, 1). Reflections make the rows (1, 0) of w and (D, r) of the test (U, y) and (0, rest), U
/// upper triangular:
///
///   ln N(z) = -1/2 (m ln 2 pi + ln |R| + 2 ln |U| + |rest|^2)
///
/// and w given the test is U^-1 (y + v), v ~ N(0, 1). F may be singular, no specimen's scatter is inverted, and D is
/// not squared: a scatter of 1e6 times the noise leaves no digits of that, and likelihoods that are far too high.
class SpecimenAlgebra {
 public:
  /// Sets a specimen and a population.
  /// @param power  1; of the likelihood, as if the noise were R / power: 0 leaves the population alone
  /// @return       ln N(z), the specimen's parameters integrated out; -infinity where D is beyond 1e12
  double condition(const LinearSpecimen& specimen, const PopulationAt& population, double power = 1.0);
  /// w given the test: U^-1 (y + v) [parameter].
  /// @param normals  v ~ N(0, 1) [parameter]
  Eigen::VectorXd scores(const Eigen::Ref<const Eigen::VectorXd>& normals) const;
  /// ln of the density of w given the test, without the factor (2 pi)^(-q / 2): ln |U| - |U w - y|^2 / 2.
  double log_density(const Eigen::Ref<const Eigen::VectorXd>& scores) const;

 private:
  void reflect(Eigen::Index j);

  Eigen::MatrixXd design_;     // D, then reflected
  Eigen::VectorXd residual_;   // r, then rest
  Eigen::MatrixXd factor_;     // U
  Eigen::VectorXd projected_;  // y
};

/// Parameters of a specimen, drawn with tails that no model exceeds by much.
struct SpecimenDraw {
  Eigen::VectorXd parameters;  ///< t
  double log_ratio = 0.0;      ///< ln of N(t) given population and linear test, over the density that t was drawn from
};

/// Draws from a mixture of what is known of a specimen by its linear test, by that test with a fraction of its
/// information, and by the population alone:
///
///   q(t) = sum_k pi_k N(t | z, noise R / power_k)
///
/// Where the model is flatter than its linear specimen, its posterior has wider tails; weights of draws from q stay
/// below the largest likelihood over pi_k times that of the linear test. Source: [Hesterberg1995].
class DefensiveDraws {
 public:
  /// @param scores  q + 1 standard normal variables: v of each component, and which one
  SpecimenDraw draw(const LinearSpecimen& specimen, const PopulationAt& population,
                    const Eigen::Ref<const Eigen::VectorXd>& scores);

 private:
  static constexpr std::size_t k_components = 3;
  std::array<SpecimenAlgebra, k_components> components_;
};

/// ln N(z; f(t0) + G (t - t0) + d, R), the test given its specimen's parameters.
double log_density_linear(const LinearSpecimen& specimen, const PopulationAt& population,
                          const Eigen::Ref<const Eigen::VectorXd>& parameters);

/// ln N(z; f + d, R) - ln N(z; f(t0) + G (t - t0) + d, R).
/// @param outputs  f(t) [output]; nan: the result is nan
double log_ratio_to_linear(const LinearSpecimen& specimen, const PopulationAt& population,
                           const Eigen::Ref<const Eigen::VectorXd>& parameters,
                           const Eigen::Ref<const Eigen::VectorXd>& outputs,
                           const Eigen::Ref<const Eigen::VectorXd>& values);

/// Fits to linearise at: every specimen's most probable parameters, held by a population that is estimated from them by
/// expectation-maximisation, with the weight of one specimen on a tenth of the prior's scatter.
///
/// @param scale  of the scatter before the tests [parameter]
/// @param noise  variances [output]
/// @throws as fit_specimens
SpecimenFits fits_to_linearise(const UpdatingProblem& problem, const Eigen::VectorXd& scale,
                               const Eigen::VectorXd& noise, const RunContext& context, std::int64_t& evaluations);

std::vector<LinearSpecimen> linear_specimens(const Eigen::Ref<const Eigen::MatrixXd>& values, const SpecimenFits& fits);

}  // namespace mottle::updating
