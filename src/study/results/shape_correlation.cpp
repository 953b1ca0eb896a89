#include "study/results/shape_correlation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "mottle/dynamics/modes/mac.hpp"
#include "study/tests/pair_modes.hpp"
#include "study/tests/specimen_pairing.hpp"

namespace mottle::study {
namespace {

constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();

/// Collects the MAC of single specimens.
class Collection {
 public:
  explicit Collection(Eigen::Index modes)
      : sum_(Eigen::MatrixXd::Zero(modes, modes)),
        minimum_(Eigen::VectorXd::Constant(modes, 1.0)),
        count_(Eigen::VectorXi::Zero(modes)) {}

  /// @param mac  of one test shape with each of the model's modes
  void add(Eigen::Index mode, const Eigen::Ref<const Eigen::VectorXd>& mac) {
    sum_.col(mode) += mac;
    minimum_(mode) = std::min(minimum_(mode), mac(mode));
    ++count_(mode);
  }
  const Eigen::VectorXi& count() const { return count_; }
  ShapeCorrelation::State state() const {
    ShapeCorrelation::State state{sum_, minimum_};
    for (Eigen::Index k = 0; k < count_.size(); ++k) {
      if (count_(k) == 0) state.minimum(k) = k_nan;
      state.mean.col(k) = count_(k) == 0 ? Eigen::VectorXd::Constant(sum_.rows(), k_nan)
                                         : Eigen::VectorXd(sum_.col(k) / static_cast<double>(count_(k)));
    }
    return state;
  }

 private:
  Eigen::MatrixXd sum_;
  Eigen::VectorXd minimum_;
  Eigen::VectorXi count_;
};

/// Measured shapes of the specimens against shapes of the model [equation x mode].
Collection compare_measured(const StructureModel& model, const Eigen::Ref<const Eigen::MatrixXd>& shapes,
                            const std::vector<PairedSpecimen>& specimens, const std::vector<int>& modes) {
  Collection collection(static_cast<Eigen::Index>(modes.size()));
  std::vector<Eigen::Index> rows;
  for (const int mode : modes) rows.push_back(mode - 1);
  for (const PairedSpecimen& specimen : specimens) {
    const ShapeComparison comparison = compare_shapes(model, shapes, specimen.modes);
    if (comparison.seen < 2) continue;
    for (std::size_t k = 0; k < modes.size(); ++k) {
      const auto pair = specimen.assigned.find(modes[k] - 1);
      if (pair == specimen.assigned.end() || !specimen.modes.has_shape(pair->second)) continue;
      const Eigen::VectorXd cosines = comparison.cosines.col(pair->second);
      collection.add(static_cast<Eigen::Index>(k), cosines(rows).cwiseAbs2());
    }
  }
  return collection;
}

/// Columns of each mode's shape components among the outputs, in the same order of degrees of freedom.
std::map<int, std::vector<Eigen::Index>> shape_columns(const std::vector<Quantity>& outputs) {
  std::map<int, std::vector<Eigen::Index>> columns;
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    if (outputs[k].kind != QuantityKind::displacement) continue;
    columns[outputs[k].number].push_back(static_cast<Eigen::Index>(k));
  }
  return columns;
}

/// Shape components of a table's rows against those of a mean of the model.
Collection compare_columns(const std::map<int, std::vector<Eigen::Index>>& columns, const Eigen::VectorXd& mean,
                           const Eigen::MatrixXd& tests) {
  const auto count = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd shapes(static_cast<Eigen::Index>(columns.begin()->second.size()), count);
  Eigen::Index next = 0;
  for (const auto& [mode, own] : columns) shapes.col(next++) = mean(own);
  Collection collection(count);
  for (Eigen::Index s = 0; s < tests.rows(); ++s) {
    Eigen::Index k = 0;
    for (const auto& [mode, own] : columns) {
      const Eigen::VectorXd test = tests.row(s)(own).transpose();
      if (test.allFinite()) collection.add(k, modal_assurance_criterion(shapes, test).col(0));
      ++k;
    }
  }
  return collection;
}

std::optional<ShapeCorrelation> correlate_columns(const StructureModel& model, const TestData& tests,
                                                  const UpdatingResult& result) {
  const std::map<int, std::vector<Eigen::Index>> columns = shape_columns(model.outputs());
  if (columns.empty() || columns.begin()->second.size() < 2) return std::nullopt;
  ShapeCorrelation correlation;
  for (const auto& [mode, own] : columns) {
    if (own.size() != columns.begin()->second.size()) return std::nullopt;
    correlation.modes.push_back(mode);
  }
  const Collection before = compare_columns(columns, result.history.front().output_mean, tests.values);
  correlation.count = before.count();
  correlation.initial = before.state();
  correlation.final = compare_columns(columns, result.history.back().output_mean, tests.values).state();
  return correlation;
}

Json state_json(const ShapeCorrelation::State& state) {
  return {{"mac", to_json_rows(state.mean)}, {"least", to_json(state.minimum)}};
}

}  // namespace

std::optional<ShapeCorrelation> correlate_shapes(const StructureModel& model, const StudyTests& tests,
                                                 const UpdatingResult& result,
                                                 const StructureModel::FollowedModes* followed) {
  if (!tests.specimens) return correlate_columns(model, tests.data, result);
  ShapeCorrelation correlation;
  for (int mode = 1; mode <= model.highest_mode(); ++mode) {
    if (model.is_output(mode - 1)) correlation.modes.push_back(mode);
  }
  const Collection before =
      compare_measured(model, model.reference_modes().shapes, *tests.specimens, correlation.modes);
  if (before.count().size() == 0 || before.count().maxCoeff() == 0) return std::nullopt;
  correlation.count = before.count();
  correlation.initial = before.state();
  if (followed != nullptr) {
    correlation.final = compare_measured(model, followed->modes.shapes, *tests.specimens, correlation.modes).state();
  }
  return correlation;
}

Json shape_correlation_json(const std::optional<ShapeCorrelation>& correlation) {
  if (!correlation) return nullptr;
  const std::vector<int> counts(correlation->count.begin(), correlation->count.end());
  return {{"modes", correlation->modes},
          {"specimens", counts},
          {"initial", state_json(correlation->initial)},
          {"final", correlation->final ? state_json(*correlation->final) : Json(nullptr)}};
}

}  // namespace mottle::study
