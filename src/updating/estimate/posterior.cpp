#include "mottle/updating/estimate/posterior.hpp"

#include <cmath>

#include "mottle/stats/chains/chain_diagnostics.hpp"
#include "updating/sampling/posterior_modes.hpp"

namespace mottle::updating {
namespace {

/// Probability, mean and highest draw of each mode; the spread of the chains' own shares gives the error.
std::vector<PosteriorMode> describe_modes(const Eigen::VectorXi& modes, const Eigen::VectorXd& log_density,
                                          const SampledPosterior& posterior) {
  std::vector<PosteriorMode> described;
  const auto chains = static_cast<double>(posterior.chains);
  for (int number = 0; number <= modes.maxCoeff(); ++number) {
    const Eigen::VectorXd is_there = (modes.array() == number).cast<double>();
    const Eigen::RowVectorXd shares = posterior.chains_of(is_there).colwise().mean();
    PosteriorMode mode{.probability = is_there.mean()};
    mode.standard_error = std::sqrt((shares.array() - shares.mean()).square().sum() / (chains * (chains - 1.0)));
    mode.mean = posterior.values.transpose() * is_there / is_there.sum();
    (modes.array() == number).select(log_density.array(), -HUGE_VAL).maxCoeff(&mode.highest);
    described.push_back(std::move(mode));
  }
  return described;
}

std::int64_t sum_over_stages(const SampledPosterior& posterior, std::int64_t SamplingStage::*count) {
  std::int64_t sum = 0;
  for (const std::vector<SamplingStage>& stages : posterior.stages) {
    for (const SamplingStage& stage : stages) sum += stage.*count;
  }
  return sum;
}

}  // namespace

std::int64_t SampledPosterior::trajectories() const {
  return sum_over_stages(*this, &SamplingStage::trajectories);
}

std::int64_t SampledPosterior::divergences() const {
  return sum_over_stages(*this, &SamplingStage::divergences);
}

Eigen::MatrixXd SampledPosterior::chains_of(const Eigen::Ref<const Eigen::VectorXd>& column) const {
  Eigen::MatrixXd split(draws, chains);
  for (Eigen::Index c = 0; c < chains; ++c) split.col(c) = column.segment(c * draws, draws);
  return split;
}

SampledPosterior make_posterior(const std::vector<SampledIsland>& islands, std::vector<std::string> names,
                                Eigen::MatrixXd values, PosteriorModes modes) {
  SampledPosterior posterior;
  posterior.chains = static_cast<Eigen::Index>(islands.size());
  posterior.draws = islands.front().points.rows();
  posterior.names = std::move(names);
  posterior.values = std::move(values);
  Eigen::MatrixXd points(posterior.values.rows(), islands.front().points.cols());
  posterior.log_likelihood.resize(points.rows());
  posterior.chain_log_evidence.resize(posterior.chains);
  for (Eigen::Index c = 0; c < posterior.chains; ++c) {
    const SampledIsland& island = islands[static_cast<std::size_t>(c)];
    points.middleRows(c * posterior.draws, posterior.draws) = island.points;
    posterior.log_likelihood.segment(c * posterior.draws, posterior.draws) = island.log_likelihood;
    posterior.chain_log_evidence(c) = island.log_evidence;
    posterior.stages.push_back(island.stages);
  }
  const Eigen::Index columns = posterior.values.cols() + 1;
  posterior.r_hat.resize(columns);
  posterior.ess_bulk.resize(columns);
  posterior.ess_tail.resize(columns);
  for (Eigen::Index k = 0; k < columns; ++k) {
    const Eigen::MatrixXd chains =
        posterior.chains_of(k + 1 < columns ? Eigen::VectorXd(posterior.values.col(k)) : posterior.log_likelihood);
    posterior.r_hat(k) = rank_normalised_r_hat(chains);
    posterior.ess_bulk(k) = bulk_effective_sample_size(chains);
    posterior.ess_tail(k) = tail_effective_sample_size(chains);
  }
  posterior.evidence = combine_evidence(islands);
  const Eigen::VectorXd log_density = posterior.log_likelihood - 0.5 * points.rowwise().squaredNorm();
  log_density.maxCoeff(&posterior.highest);
  if (modes == PosteriorModes::not_sought) return posterior;
  posterior.modes = describe_modes(find_modes(points, log_density), log_density, posterior);
  return posterior;
}

void add_specimens(Eigen::MatrixXd log_likelihood, SampledPosterior& posterior) {
  const auto draws = static_cast<double>(log_likelihood.rows());
  Eigen::VectorXd efficiency(log_likelihood.cols());
  for (Eigen::Index s = 0; s < efficiency.size(); ++s) {
    efficiency(s) = bulk_effective_sample_size(posterior.chains_of(log_likelihood.col(s))) / draws;
  }
  posterior.leave_one_out = leave_one_out(log_likelihood, efficiency);
  posterior.waic = widely_applicable_information(log_likelihood);
  posterior.specimen_log_likelihood = std::move(log_likelihood);
}

}  // namespace mottle::updating
