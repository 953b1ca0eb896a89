#include "updating/methods/abc_verdict.hpp"

#include "mottle/stats/moments/descriptive.hpp"
#include "updating/verdict/cloud_agreement.hpp"
#include "updating/verdict/scatter_tests.hpp"

namespace mottle::updating {
namespace {

/// An estimate of one study, less the bias of standard deviations, within limits.
Eigen::VectorXd corrected(const AbcFit& fit, const SampledPopulations& sampled, Eigen::VectorXd at) {
  const Eigen::Index q = fit.coordinates.parameters();
  at.segment(q, q) -= sampled.log_bias;
  return at.cwiseMax(fit.coordinates.lower()).cwiseMin(fit.coordinates.upper());
}

double statistic_of(const AbcFit& fit, const Eigen::MatrixXd& values, const Eigen::VectorXd& at) {
  const SampledPopulation population = fit.coordinates.at(at);
  const CloudTransport& transport = *fit.nearest.transport;
  TestData tests = fit.problem.tests;
  tests.values = values;
  const TestMoments moments = test_moments(tests);
  const Eigen::VectorXd model =
      sample_covariance(transport.outputs(population, transport.base())).diagonal() + population.noise_std.cwiseAbs2();
  std::vector<bool> is_whole;
  for (const double sigma : population.noise_std) is_whole.push_back(sigma > 0.0);
  // By chi-squared alone: the studies take the place of draws from the cloud.
  return cloud_agreement_test({moments.covariance.diagonal(),
                               model,
                               {},
                               counts_with_scatter(moments),
                               is_whole,
                               output_names(fit.problem)})
      .statistic;
}

}  // namespace

StudiedStatistic studied_cloud_scatter(const AbcFit& fit, const SampledPopulations& sampled) {
  const Eigen::MatrixXd observed = fit.nearest.offset.taken_off(fit.problem.tests.values);
  const auto studies = static_cast<Eigen::Index>(sampled.studies.tests.size());
  return {statistic_of(fit, observed, corrected(fit, sampled, sampled.estimate)),
          Eigen::VectorXd::NullaryExpr(studies, [&](Eigen::Index b) {
            return statistic_of(fit, sampled.studies.tests[static_cast<std::size_t>(b)],
                                corrected(fit, sampled, sampled.studies.estimates.row(b).transpose()));
          })};
}

}  // namespace mottle::updating
