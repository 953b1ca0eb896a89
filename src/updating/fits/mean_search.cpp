#include "updating/fits/mean_search.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "mottle/core/error.hpp"
#include "mottle/linalg/dense/decompositions.hpp"

namespace mottle::updating {
namespace {

/// Directions, in prior deviations, that do not move the outputs.
Eigen::MatrixXd flat_directions(const Eigen::MatrixXd& moved) {
  constexpr double k_small = 1e-3;  // of the strongest direction's movement
  const SingularValues svd(moved, Eigen::ComputeFullV);
  Eigen::Index rank = 0;
  while (rank < svd.values().size() && svd.values()(rank) > k_small * svd.values()(0)) ++rank;
  return svd.right().rightCols(moved.cols() - rank);
}

}  // namespace

void MeanSearch::descend(const Eigen::MatrixXd& points, const Eigen::MatrixXd& outputs) {
  starts_ += static_cast<int>(points.rows());
  std::vector<Eigen::Index> usable;
  for (Eigen::Index s = 0; s < points.rows(); ++s) {
    if (outputs.row(s).allFinite()) usable.push_back(s);
  }
  if (usable.empty()) return;
  const auto from = [&](const std::vector<Eigen::Index>& rows) {
    add(fit(points(rows, Eigen::all), outputs(rows, Eigen::all)));
  };
  try {
    from(usable);
  } catch (const ModelFailure&) {  // one of them leads to where the model fails: each by itself
    for (const Eigen::Index row : usable) {
      try {
        from({row});
      } catch (const ModelFailure&) {  // NOLINT(bugprone-empty-catch): a start that leads nowhere
      }
    }
  }
}

void MeanSearch::descend(const Eigen::MatrixXd& points) {
  descend(points, outputs_on_scales(problem(), points, context_, evaluations_));
}

void MeanSearch::descend_from_prior() {
  constexpr double k_beside = 0.5;
  const Eigen::MatrixXd point = prior_.mean.transpose();
  const Eigen::MatrixXd outputs = outputs_on_scales(problem(), point, context_, evaluations_);
  descend(point, outputs);
  for (MeanSolution& one : found_) one.is_from_prior = true;
  if (!outputs.allFinite()) return;
  const ScaledParameters parameters(problem_.space);
  const Eigen::MatrixXd g = scaled_jacobians(problem(), parameters, point, outputs, context_, evaluations_).front();
  if (!g.allFinite()) return;
  const Eigen::MatrixXd unmoved = flat_directions(g * std_.asDiagonal());
  if (unmoved.cols() == 0) return;
  const Eigen::VectorXd ramp = Eigen::VectorXd::LinSpaced(std_.size(), 1.0, 2.0);
  const Eigen::VectorXd beside = unmoved * (unmoved.transpose() * ramp);
  descend((prior_.mean + k_beside * std_.cwiseProduct(beside / beside.norm())).transpose());
}

void MeanSearch::exchange() {
  constexpr std::size_t k_nearest = 8;
  if (permutations_.empty()) return;
  for (std::size_t k = 0; k < found_.size() && starts_ < settings_.starts; ++k) {
    if (found_[k].is_exchanged || !is_close(found_[k])) continue;
    found_[k].is_exchanged = true;
    Eigen::MatrixXd points(static_cast<Eigen::Index>(permutations_.size()), std_.size());
    for (std::size_t p = 0; p < permutations_.size(); ++p) {
      points.row(static_cast<Eigen::Index>(p)) = found_[k].point(permutations_[p]).transpose();
    }
    const Eigen::MatrixXd outputs = outputs_on_scales(problem(), points, context_, evaluations_);
    std::vector<Eigen::Index> order = nearest_first(outputs);
    order.resize(std::min(order.size(), k_nearest));
    descend(points(order, Eigen::all), outputs(order, Eigen::all));
  }
}

std::vector<Eigen::Index> MeanSearch::nearest_first(const Eigen::MatrixXd& outputs) const {
  std::vector<std::pair<double, Eigen::Index>> sorted;
  for (Eigen::Index s = 0; s < outputs.rows(); ++s) {
    if (outputs.row(s).allFinite()) sorted.emplace_back(misfit(outputs.row(s)), s);
  }
  std::ranges::sort(sorted);
  std::vector<Eigen::Index> order;
  for (const auto& [distance, row] : sorted) order.push_back(row);
  return order;
}

MeanSolutions MeanSearch::result() const {
  if (found_.empty())
    throw ModelFailure("the model fails at the parameters' prior means, and from no other start a fit succeeds");
  MeanSolutions result{.solutions = {}, .starts = starts_};
  std::ranges::copy_if(found_, std::back_inserter(result.solutions), [&](const auto& one) { return is_close(one); });
  std::ranges::stable_sort(result.solutions, {}, &MeanSolution::residual);
  return result;
}

bool MeanSearch::are_met_twice() const {
  return !found_.empty() &&
         std::ranges::all_of(result().solutions, [](const MeanSolution& one) { return one.met >= 2; });
}

bool MeanSearch::is_settled() const {
  return are_met_twice() && result().solutions.front().residual <= settings_.expected_residual;
}

SpecimenFits MeanSearch::fit(const Eigen::MatrixXd& points, const Eigen::MatrixXd& outputs) {
  constexpr double k_flat = 1e4;        // times the prior's deviations: it then holds nothing that the outputs see
  constexpr double k_tolerance = 1e-5;  // prior deviations
  constexpr int k_passes = 3;
  const HoldingPopulation hold{prior_.mean, k_flat * k_flat * prior_.covariance, settings_.noise};
  const auto from = [&](const SpecimenStart& start) {
    return fit_specimens(problem(), target_.replicate(start.points.rows(), 1), hold, start, context_, evaluations_);
  };
  SpecimenFits fits = from({points, {}, k_tolerance, outputs});
  for (int pass = 1; pass < k_passes; ++pass) {
    std::vector<Eigen::Index> stuck;
    SpecimenStart again{.points = {}, .tolerance = k_tolerance};
    for (Eigen::Index s = 0; s < points.rows(); ++s) {
      if (fits.converged[static_cast<std::size_t>(s)]) continue;
      stuck.push_back(s);
      again.jacobians.push_back(fits.jacobians[static_cast<std::size_t>(s)]);
    }
    if (stuck.empty()) break;
    again.points = fits.points(stuck, Eigen::all);
    again.outputs = fits.outputs(stuck, Eigen::all);
    const SpecimenFits further = from(again);
    for (std::size_t k = 0; k < stuck.size(); ++k) fits.take(stuck[k], further, static_cast<Eigen::Index>(k));
  }
  return fits;
}

void MeanSearch::add(SpecimenFits fits) {
  const ScaledParameters parameters(problem_.space);
  const Eigen::MatrixXd ends = fits.points;
  for (Eigen::Index s = 0; s < ends.rows(); ++s) fits.points.row(s) = parameters.clamp(ends.row(s).transpose());
  if (fits.points != ends) fits.outputs = outputs_on_scales(problem(), fits.points, context_, evaluations_);
  for (Eigen::Index s = 0; s < ends.rows(); ++s) {
    if (!fits.outputs.row(s).allFinite()) continue;
    MeanSolution end{.point = fits.points.row(s), .outputs = fits.outputs.row(s)};
    end.jacobian = fits.jacobians[static_cast<std::size_t>(s)];
    end.misfit = misfit(fits.outputs.row(s));
    end.residual = residual(end);
    end.met = 1;
    keep(std::move(end));
  }
}

bool MeanSearch::is_close(const MeanSolution& one) const {
  constexpr double k_far = 1e3;  // times the best's residual: no scatter of the specimens makes good for that
  const double least = std::ranges::min_element(found_, {}, &MeanSolution::misfit)->misfit;
  const double least_residual = std::ranges::min_element(found_, {}, &MeanSolution::residual)->residual;
  return one.misfit <= least + 4.0 * doubt_ && one.residual <= k_far * (1.0 + least_residual);
}

double MeanSearch::residual(const MeanSolution& end) const {
  const Eigen::VectorXd floor = 1e-6 * (end.jacobian * std_.asDiagonal()).rowwise().squaredNorm();
  const Eigen::VectorXd noise = settings_.noise.cwiseMax(floor).cwiseMax(1e-300);
  return (end.outputs - target_.transpose()).cwiseAbs2().cwiseQuotient(noise).sum();
}

void MeanSearch::keep(MeanSolution end) {
  for (MeanSolution& known : found_) {
    if (!is_one(known, end)) continue;
    end.met += known.met;
    if (end.residual >= known.residual) {
      known.met = end.met;
      return;
    }
    // The prior's mean leads to the lower one only where the two are the same to what is to be decided.
    end.is_from_prior = known.is_from_prior && known.residual - end.residual <= 1.0;
    known = std::move(end);
    return;
  }
  found_.push_back(std::move(end));
}

bool MeanSearch::is_one(const MeanSolution& a, const MeanSolution& b) const {
  constexpr double k_near = 0.1;  // prior deviations
  const Eigen::VectorXd between = b.point - a.point;
  if (between.cwiseQuotient(std_).cwiseAbs().maxCoeff() < k_near) return true;
  const auto moved = [&](const MeanSolution& at) {
    return (at.jacobian * between).cwiseAbs2().cwiseQuotient(settings_.variance).sum();
  };
  return std::max(moved(a), moved(b)) <= doubt_;
}

}  // namespace mottle::updating
