#include "study/proposal/proposal_model.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "mottle/core/error.hpp"
#include "mottle/stats/moments/robust.hpp"
#include "mottle/study/jobs/study_objects.hpp"
#include "mottle/updating/methods/deterministic.hpp"
#include "study/results/init_text.hpp"

namespace mottle::study {
namespace {

constexpr double k_frequency_noise = 0.001;
constexpr double k_shape_noise = 0.02;

Study draft_study(InitOutcome draft, const std::vector<CandidateNumber>& candidates) {
  draft.parameters.clear();
  for (const CandidateNumber& candidate : candidates) draft.parameters.push_back(candidate.parameter);
  Study study = read_study_text(study_text_of(draft), draft.settings.study);
  study.may_reduce = false;  // a few points do not pay for the training of a reduced model
  return study;
}

/// What the linear model leaves out of differences of this size, standard deviation.
Eigen::VectorXd curvature_of(const Eigen::VectorXd& means) {
  return 0.5 * means.cwiseAbs2() + 0.05 * means.cwiseAbs();
}

/// Distances from the median, in robust standard deviations; 0 where too few are known [specimen].
Eigen::VectorXd robust_distances(const Eigen::VectorXd& values, double least_scale) {
  constexpr Eigen::Index k_fewest = 6;
  const auto is_known = !values.array().isNaN();
  if (is_known.count() < k_fewest) return Eigen::VectorXd::Zero(values.size());
  const double scale = std::max(robust_deviation(values), least_scale);
  return is_known.select((values.array() - median(values)).abs() / scale, 0.0);
}

}  // namespace

/// One row of the linear problem: an output, or the sum of the frequencies of a group.
struct ProposalModel::Row {
  std::vector<Eigen::Index> outputs;
  bool is_frequency = true;

  double weight() const {
    return std::sqrt(static_cast<double>(outputs.size()));
  }  ///< so that the noise is one output's
  double typical_noise() const { return is_frequency ? k_frequency_noise : k_shape_noise; }
};

struct ProposalModel::Parts {
  const std::vector<CandidateNumber>* candidates = nullptr;
  ProposedOutputs outputs;
  StudyModel made;
  TestData data;
  std::vector<Row> rows;
  Eigen::VectorXd reference;  ///< outputs at the deck's numbers

  const std::vector<Quantity>& quantities() const { return made.model->outputs(); }
  bool read(const InitOutcome& outcome);
  void find_rows();
  void drop_rows(bool has_shapes);
  std::vector<int> leave_out_far_specimens();
  Eigen::MatrixXd differences_from(const Eigen::VectorXd& values, const Eigen::VectorXd& sizes) const;
  Eigen::VectorXd factors_at(const Eigen::VectorXd& point) const;
  Eigen::VectorXd sizes_of(const Eigen::VectorXd& values) const;
  /// d output / d ln factor over size, from the model's derivatives or the numbers' sensitivities.
  Eigen::MatrixXd slopes_at(const Eigen::VectorXd& factors, const Eigen::VectorXd& sizes) const;
  Eigen::MatrixXd known_slopes() const;
};

/// Shapes of modes of one frequency are left out: any combination of them is a mode.
void ProposalModel::Parts::find_rows() {
  std::vector<std::pair<ModeGroup, Row>> merged;
  for (const ModeGroup& group : outputs.groups) merged.emplace_back(group, Row{});
  for (std::size_t k = 0; k < quantities().size(); ++k) {
    const Quantity& output = quantities()[k];
    const auto index = static_cast<Eigen::Index>(k);
    const auto group =
        std::ranges::find_if(merged, [&](const auto& item) { return item.first.contains(output.number - 1); });
    const bool is_frequency = output.kind == QuantityKind::frequency;
    if (group == merged.end()) {
      rows.push_back({{index}, is_frequency});
    } else if (is_frequency) {
      group->second.outputs.push_back(index);
    }
  }
  for (const auto& [group, row] : merged) {
    if (!row.outputs.empty()) rows.push_back(row);
  }
}

Eigen::VectorXd ProposalModel::Parts::factors_at(const Eigen::VectorXd& point) const {
  Eigen::VectorXd factors(point.size());
  for (Eigen::Index j = 0; j < point.size(); ++j) {
    factors(j) = std::exp(point(j) * (*candidates)[static_cast<std::size_t>(j)].parameter.spread);
  }
  return factors;
}

/// A frequency's value, of shapes the largest component of all: their noise has one level [output].
Eigen::VectorXd ProposalModel::Parts::sizes_of(const Eigen::VectorXd& values) const {
  Eigen::VectorXd sizes = values.cwiseAbs();
  for (std::size_t k = 0; k < quantities().size(); ++k) {
    if (quantities()[k].kind == QuantityKind::frequency) continue;
    double largest = 0.0;
    for (std::size_t i = 0; i < quantities().size(); ++i) {
      const bool is_same = quantities()[i].kind == quantities()[k].kind;
      if (is_same) largest = std::max(largest, std::abs(values(static_cast<Eigen::Index>(i))));
    }
    sizes(static_cast<Eigen::Index>(k)) = largest;
  }
  return sizes;
}

Eigen::MatrixXd ProposalModel::Parts::known_slopes() const {
  Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(reference.size(), static_cast<Eigen::Index>(candidates->size()));
  for (std::size_t k = 0; k < quantities().size(); ++k) {
    for (std::size_t j = 0; j < candidates->size(); ++j) {
      const double slope = (*candidates)[j].sensitivity(quantities()[k].number - 1);
      const bool is_known = quantities()[k].kind == QuantityKind::frequency && !std::isnan(slope);
      if (is_known) slopes(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(j)) = slope;
    }
  }
  return slopes;
}

Eigen::MatrixXd ProposalModel::Parts::slopes_at(const Eigen::VectorXd& factors, const Eigen::VectorXd& sizes) const {
  const Eigen::MatrixXd jacobian = made.model->jacobian(factors);
  return sizes.cwiseInverse().asDiagonal() * jacobian * factors.asDiagonal();
}

/// The model with all candidates as parameters, or where these exclude each other with the first: then the slopes at
/// the deck's values are those that are known.
///
/// @return  whether the model can be linearised elsewhere
bool ProposalModel::Parts::read(const InitOutcome& outcome) {
  const RunSettings settings{.cache = outcome.settings.cache};
  std::optional<Study> study;
  bool can_move = false;
  try {
    study = draft_study(outcome, *candidates);
    made = make_model(*study, study->parameters, settings);
    can_move = made.model->derivatives() != nullptr && outputs.groups.empty();
  } catch (const InvalidInput&) {
    study = draft_study(outcome, {candidates->front()});
    made = make_model(*study, study->parameters, settings);
  }
  data = read_tests(*study, *made.model).data;
  const Eigen::VectorXd& ones = made.model->reference_parameters();
  reference = made.model->evaluate(ones.transpose(), {}).outputs.row(0).transpose();
  return can_move;
}

/// Drops what the slopes at hand do not know, and what was not measured.
void ProposalModel::Parts::drop_rows(bool has_shapes) {
  std::erase_if(rows, [&](const Row& row) {
    const auto known = data.values(Eigen::all, row.outputs).array().isFinite().rowwise().all();
    return !known.any() || (!has_shapes && !row.is_frequency);
  });
  require(!rows.empty(), "no output was measured");
}

std::vector<int> ProposalModel::Parts::leave_out_far_specimens() {
  constexpr double k_far = 8.0;  // robust standard deviations
  Eigen::VectorXd farthest = Eigen::VectorXd::Zero(data.values.rows());
  const Eigen::VectorXd sizes = sizes_of(reference);
  for (const Row& row : rows) {
    const Eigen::VectorXd values = data.values.col(row.outputs.front()) / sizes(row.outputs.front());
    farthest = farthest.cwiseMax(robust_distances(values, row.typical_noise()));
  }
  std::vector<int> left_out;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index s = 0; s < farthest.size(); ++s) {
    if (farthest(s) > k_far) left_out.push_back(data.number_of(s));
    if (farthest(s) <= k_far) kept.push_back(s);
  }
  data.values = Eigen::MatrixXd(data.values(kept, Eigen::all));
  return left_out;
}

ProposalModel::ProposalModel(const InitOutcome& outcome, const std::vector<CandidateNumber>& candidates,
                             const ProposedOutputs& outputs)
    : parts_(std::make_unique<Parts>()) {
  parts_->candidates = &candidates;
  parts_->outputs = outputs;
  can_move_ = parts_->read(outcome);
  parts_->find_rows();
  parts_->drop_rows(can_move_);
  left_out_ = parts_->leave_out_far_specimens();
}

ProposalModel::~ProposalModel() = default;

Eigen::Index ProposalModel::output_count() const {
  return static_cast<Eigen::Index>(parts_->rows.size());
}

/// Differences of the tests from `values`, by logarithm or over the sizes [specimen x row].
Eigen::MatrixXd ProposalModel::Parts::differences_from(const Eigen::VectorXd& values,
                                                       const Eigen::VectorXd& sizes) const {
  Eigen::MatrixXd differences(data.values.rows(), static_cast<Eigen::Index>(rows.size()));
  for (Eigen::Index k = 0; k < differences.cols(); ++k) {
    const Row& row = rows[static_cast<std::size_t>(k)];
    for (Eigen::Index s = 0; s < differences.rows(); ++s) {
      double sum = 0.0;
      for (const Eigen::Index output : row.outputs) {
        const double test = data.values(s, output);
        sum += row.is_frequency ? std::log(test / values(output)) : (test - values(output)) / sizes(output);
      }
      differences(s, k) = row.weight() * sum / static_cast<double>(row.outputs.size());
    }
  }
  return differences;
}

LinearisedTests ProposalModel::linearise(const Eigen::VectorXd& point) const {
  const Parts& parts = *parts_;
  const Eigen::VectorXd factors = parts.factors_at(point);
  Eigen::VectorXd values = parts.reference;
  if (can_move_) values = parts.made.model->evaluate(factors.transpose(), {}).outputs.row(0).transpose();
  const Eigen::VectorXd sizes = parts.sizes_of(values);
  const Eigen::MatrixXd slopes = can_move_ ? parts.slopes_at(factors, sizes) : parts.known_slopes();
  const auto count = static_cast<Eigen::Index>(parts.rows.size());
  LinearisedTests problem{.differences = parts.differences_from(values, sizes),
                          .changes = Eigen::MatrixXd(count, point.size()),
                          .preferences = Eigen::VectorXd(point.size()),
                          .typical_noise = Eigen::VectorXd(count),
                          .curvature = {}};
  problem.curvature = curvature_of(known_means(problem.differences));
  for (Eigen::Index k = 0; k < count; ++k) {
    const Row& row = parts.rows[static_cast<std::size_t>(k)];
    problem.typical_noise(k) = row.typical_noise();
    problem.changes.row(k) = row.weight() * slopes(row.outputs, Eigen::all).colwise().mean();
  }
  for (Eigen::Index j = 0; j < point.size(); ++j) {
    const CandidateNumber& candidate = (*parts.candidates)[static_cast<std::size_t>(j)];
    problem.changes.col(j) *= candidate.parameter.spread;
    problem.preferences(j) = candidate.preference;
  }
  // About the deck's numbers again: the differences that there are, and what the point has taken of them.
  problem.differences.rowwise() += (problem.changes * point).transpose();
  return problem;
}

}  // namespace mottle::study
