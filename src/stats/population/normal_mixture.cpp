#include "mottle/stats/population/normal_mixture.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "mottle/linalg/dense/decompositions.hpp"
#include "stats/population/mixture_step.hpp"

namespace mottle::stats {
namespace {

/// The rows of one unit that depend on effects.
struct ReducedUnit {
  MixtureDesign design;
  Eigen::VectorXd response;
  bool is_determined = false;
};

ReducedUnit reduce(const RandomEffectsUnit& unit) {
  constexpr double k_smallest_noise = 1e-14;  // of what effects of size 1 move a row: rows without noise count alike
  constexpr double k_determined = 1e-10;
  const Eigen::Index q = unit.design.cols();
  const Eigen::VectorXd smallest = k_smallest_noise * unit.design.rowwise().squaredNorm();
  const Eigen::VectorXd weight = unit.noise.cwiseMax(smallest).cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = weight.asDiagonal() * unit.design;
  const Eigen::VectorXd own_noise = unit.noise.cwiseProduct(weight.cwiseAbs2());
  if (scaled.rows() >= q && PivotedQr(scaled, k_determined).rank() == q) {
    const Eigen::MatrixXd inverse = LeastNormSolver(scaled).pseudo_inverse();
    return {{Eigen::MatrixXd::Identity(q, q), inverse * own_noise.asDiagonal() * inverse.transpose()},
            inverse * (weight.asDiagonal() * unit.response),
            true};
  }
  if (scaled.rows() <= q) return {{unit.design, unit.noise.asDiagonal()}, unit.response};
  const SingularValues values(scaled, Eigen::ComputeThinU);
  const Eigen::MatrixXd u = values.left().leftCols(values.rank());
  return {{u.transpose() * scaled, u.transpose() * own_noise.asDiagonal() * u},
          u.transpose() * (weight.asDiagonal() * unit.response)};
}

bool is_same(const MixtureDesign& a, const MixtureDesign& b) {
  return a.design.rows() == b.design.rows() && a.design == b.design && a.noise == b.noise;
}

/// Steps until the likelihood rests.
std::optional<MixtureFit> iterate(MixtureStep& step, MixtureFit fit, const MixtureSettings& settings) {
  double before = 0.0;
  for (fit.iterations = 0; fit.iterations < settings.iterations; ++fit.iterations) {
    if (!step.expect(fit)) return std::nullopt;
    if (fit.iterations > 0 && std::abs(fit.log_likelihood - before) <= settings.tolerance) {
      fit.converged = true;
      break;
    }
    before = fit.log_likelihood;
    if (!step.maximise(fit)) return std::nullopt;
  }
  if (!fit.converged && !step.expect(fit)) return std::nullopt;
  if (!step.maximise(fit)) return std::nullopt;  // covariances of the means
  return fit;
}

}  // namespace

MixtureData mixture_data(const std::vector<RandomEffectsUnit>& units, const std::vector<int>& alike) {
  MixtureData data;
  std::map<int, std::size_t> kinds;
  std::vector<double> counts;
  for (std::size_t s = 0; s < units.size(); ++s) {
    ReducedUnit own = reduce(units[s]);
    data.responses.push_back(std::move(own.response));
    std::size_t place = data.designs.size();
    if (!alike.empty() && own.is_determined) {
      place = kinds.try_emplace(alike[s], place).first->second;
    } else if (!data.designs.empty() && is_same(data.designs.back(), own.design)) {
      place = data.designs.size() - 1;
    }
    if (place == data.designs.size()) {
      data.designs.push_back(std::move(own.design));
      counts.push_back(1.0);
    } else {
      counts[place] += 1.0;
      MixtureDesign& mean = data.designs[place];
      if (!is_same(mean, own.design)) mean.noise += (own.design.noise - mean.noise) / counts[place];
    }
    data.design_of.push_back(place);
  }
  return data;
}

Eigen::Index MixtureFit::component_of(Eigen::Index unit) const {
  Eigen::Index place = 0;
  probabilities.row(unit).head(probabilities.cols() - 1).maxCoeff(&place);
  return place;
}

Eigen::VectorXd MixtureFit::mean() const {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(components.front().mean.size());
  for (const MixtureComponent& own : components) sum += own.weight * own.mean;
  return sum;
}

Eigen::MatrixXd MixtureFit::within() const {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(components.front().mean.size(), components.front().mean.size());
  for (const MixtureComponent& own : components) sum += own.weight * own.covariance;
  return sum;
}

Eigen::MatrixXd MixtureFit::covariance() const {
  const Eigen::VectorXd centre = mean();
  Eigen::MatrixXd sum = within();
  for (const MixtureComponent& own : components) {
    sum += own.weight * (own.mean - centre) * (own.mean - centre).transpose();
  }
  return sum;
}

std::optional<MixtureFit> fit_mixture(const MixtureData& data, const Eigen::Ref<const Eigen::MatrixXd>& start,
                                      const MixtureSettings& settings) {
  MixtureStep step(data, settings);
  MixtureFit fit;
  fit.probabilities = start;
  // One population of all units holds those that do not determine their own effects.
  const Eigen::Index q = data.effects();
  const Eigen::MatrixXd points =
      held_points(data, Eigen::VectorXd::Zero(q), 1e6 * Eigen::MatrixXd(Eigen::MatrixXd::Identity(q, q)));
  if (!step.begin(points, fit)) return std::nullopt;
  return iterate(step, std::move(fit), settings);
}

std::optional<MixtureFit> fit_mixture(const MixtureData& data, const MixtureFit& start,
                                      const MixtureSettings& settings) {
  MixtureStep step(data, settings);
  return iterate(step, start, settings);
}

OutlierPopulation outlier_population(const MixtureData& data, double fraction, double width,
                                     const MixtureSettings& settings) {
  MixtureSettings one = settings;
  one.outliers = {};
  const auto units = static_cast<Eigen::Index>(data.size());
  const std::optional<MixtureFit> fit = fit_mixture(data, Eigen::MatrixXd(Eigen::MatrixXd::Ones(units, 1)), one);
  if (!fit) return {};
  return {fraction, fit->components[0].mean, width * width * fit->components[0].covariance};
}

Eigen::MatrixXd held_points(const MixtureData& data, const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance) {
  Eigen::MatrixXd points(static_cast<Eigen::Index>(data.size()), data.effects());
  std::vector<Eigen::MatrixXd> gains;
  for (const MixtureDesign& design : data.designs) {
    const Eigen::MatrixXd moved = design.design * covariance;
    gains.emplace_back(solve_semidefinite(moved * design.design.transpose() + design.noise, moved).transpose());
  }
  for (std::size_t s = 0; s < data.size(); ++s) {
    points.row(static_cast<Eigen::Index>(s)) =
        (mean + gains[data.design_of[s]] * (data.responses[s] - data.design(s).design * mean)).transpose();
  }
  return points;
}

std::vector<Eigen::Index> mixture_order(const MixtureFit& fit) {
  constexpr double k_equal = 1e-9;
  std::vector<Eigen::Index> order(fit.components.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index i, Eigen::Index j) {
    const MixtureComponent& a = fit.components[static_cast<std::size_t>(i)];
    const MixtureComponent& b = fit.components[static_cast<std::size_t>(j)];
    if (std::abs(a.weight - b.weight) > k_equal) return a.weight > b.weight;
    return std::lexicographical_compare(a.mean.begin(), a.mean.end(), b.mean.begin(), b.mean.end());
  });
  return order;
}

MixtureFit reordered(const MixtureFit& fit, const std::vector<Eigen::Index>& order) {
  MixtureFit next = fit;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const auto from = static_cast<std::size_t>(order[k]);
    next.components[k] = fit.components[from];
    next.mean_covariances[k] = fit.mean_covariances[from];
    next.probabilities.col(static_cast<Eigen::Index>(k)) = fit.probabilities.col(order[k]);
  }
  return next;
}

}  // namespace mottle::stats
