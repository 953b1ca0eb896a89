#include "study/proposal/sensitive_numbers.hpp"

#include <cmath>

namespace mottle::study {
namespace {

/// Changes by one spread of each number, in scales of the outputs.
struct Changes {
  Eigen::MatrixXd known;    ///< [direction x number]
  Eigen::VectorXd unknown;  ///< sizes of those in unknown combinations of modes of one frequency [number]
};

/// The outputs of a group become one row, of the mean of the group's eigenvalues, and the sizes of the rest.
void merge_group(const std::vector<CandidateNumber>& candidates, const ProposedOutputs& outputs, const ModeGroup& group,
                 Changes& changes) {
  std::vector<Eigen::Index> members;
  for (std::size_t k = 0; k < outputs.modes.size(); ++k) {
    if (group.contains(outputs.modes[k] - 1)) members.push_back(static_cast<Eigen::Index>(k));
  }
  if (members.empty()) return;
  const Eigen::VectorXd scales = outputs.scales(members);
  const double weight = std::sqrt(static_cast<double>(members.size())) / scales.mean();
  changes.known(members, Eigen::all).setZero();
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const auto j = static_cast<Eigen::Index>(i);
    const double spread = candidates[i].parameter.spread;
    const Eigen::RowVectorXd values = candidates[i].sensitivity.segment(group.first, group.count);
    if (!values.allFinite()) continue;
    const double mean_square = (values.array() - values.mean()).square().mean();
    changes.known(members.front(), j) = weight * spread * values.mean();
    changes.unknown(j) = std::hypot(changes.unknown(j), weight * spread * std::sqrt(mean_square));
  }
}

Changes changes_of(const std::vector<CandidateNumber>& candidates, const ProposedOutputs& outputs) {
  const auto count = static_cast<Eigen::Index>(candidates.size());
  Changes changes{Eigen::MatrixXd(outputs.scales.size(), count), Eigen::VectorXd::Zero(count)};
  for (Eigen::Index j = 0; j < count; ++j) {
    const CandidateNumber& candidate = candidates[static_cast<std::size_t>(j)];
    for (Eigen::Index k = 0; k < outputs.scales.size(); ++k) {
      const double sensitivity = candidate.sensitivity(outputs.modes[static_cast<std::size_t>(k)] - 1);
      changes.known(k, j) =
          std::isnan(sensitivity) ? 0.0 : sensitivity * candidate.parameter.spread / outputs.scales(k);
    }
  }
  for (const ModeGroup& group : outputs.groups) merge_group(candidates, outputs, group, changes);
  return changes;
}

}  // namespace

SensitiveNumbers::SensitiveNumbers(const std::vector<CandidateNumber>& candidates, const ProposedOutputs& outputs) {
  Changes changes = changes_of(candidates, outputs);
  columns_ = std::move(changes.known);
  rest_ = columns_;
  own_ = std::move(changes.unknown);
}

double SensitiveNumbers::length(Eigen::Index j) const {
  return std::hypot(columns_.col(j).norm(), own_(j));
}

double SensitiveNumbers::rest(Eigen::Index j) const {
  return std::hypot(rest_.col(j).norm(), own_(j));
}

void SensitiveNumbers::choose(Eigen::Index j) {
  chosen_.push_back(j);
  add_row_of(j);
  const double norm = rest_.col(j).norm();
  if (norm == 0.0) return;
  const Eigen::VectorXd direction = rest_.col(j) / norm;
  rest_ -= direction * (direction.transpose() * rest_).eval();
}

Eigen::Index SensitiveNumbers::next() const {
  Eigen::Index best = -1;
  for (Eigen::Index j = 0; j < rest_.cols(); ++j) {
    if (!is_seen(j) || !is_told_apart(j)) continue;
    if (best < 0 || rest(j) > rest(best)) best = j;
  }
  return best;
}

Eigen::Index SensitiveNumbers::most_alike(Eigen::Index j) const {
  Eigen::Index best = -1;
  double largest = 0.0;
  for (const Eigen::Index other : chosen_) {
    const double cosine = std::abs(columns_.col(j).dot(columns_.col(other))) / (length(j) * length(other));
    if (best >= 0 && !(cosine > largest)) continue;
    largest = cosine;
    best = other;
  }
  return best;
}

/// The direction of its own becomes one that others can get a part in.
void SensitiveNumbers::add_row_of(Eigen::Index j) {
  if (own_(j) == 0.0) return;
  for (Eigen::MatrixXd* matrix : {&columns_, &rest_}) {
    matrix->conservativeResize(matrix->rows() + 1, Eigen::NoChange);
    matrix->bottomRows(1).setZero();
    (*matrix)(matrix->rows() - 1, j) = own_(j);
  }
  own_(j) = 0.0;
}

}  // namespace mottle::study
