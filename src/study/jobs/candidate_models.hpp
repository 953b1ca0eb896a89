// A model with many candidates, solved by models that know only those candidates that samples move.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/study_model.hpp"

namespace mottle::study {

/// The model of parameters and candidates together. A batch goes to a smaller model of the parameters and of those
/// candidates that differ from their nominal values in some row: a certified reduced model of so few parameters is
/// cheap, one of all candidates is not, and one that cannot be separated spoils it for all.
class CandidateModels final : public Model, public DifferentiableModel {
 public:
  /// Makes the model of the parameters and of some candidates, numbered from 0 on, in this order.
  using Factory = std::function<StudyModel(const std::vector<Eigen::Index>& candidates)>;

  /// @param whole    of all parameters and candidates; must outlive this object
  /// @param given    number of parameters, which stand before the candidates
  /// @param nominal  values of parameters and candidates [parameter]
  CandidateModels(const StructureModel& whole, Eigen::Index given, Eigen::VectorXd nominal, Factory make);

  Eigen::Index parameter_count() const override { return whole_.parameter_count(); }
  const std::vector<Quantity>& outputs() const override { return whole_.outputs(); }
  double difference_step() const override { return k_coarse_difference_step; }
  Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext& context) const override;
  /// By all parameters where every candidate has its nominal value; elsewhere by the parameters and the candidates that
  /// differ from it, nan for the others.
  Eigen::MatrixXd jacobian(const Eigen::Ref<const Eigen::VectorXd>& parameters) const override;

 private:
  struct Made {
    std::vector<Eigen::Index> candidates;
    StudyModel model;
  };

  std::vector<Eigen::Index> moved_in(const Eigen::Ref<const Eigen::MatrixXd>& samples) const;
  /// Columns of the parameters and of some candidates.
  std::vector<Eigen::Index> columns_of(const std::vector<Eigen::Index>& candidates) const;
  std::shared_ptr<const Made> model_of(const std::vector<Eigen::Index>& candidates) const;

  const StructureModel& whole_;
  Eigen::Index given_;
  Eigen::VectorXd nominal_;
  Factory make_;
  mutable std::mutex mutex_;                              // of the next
  mutable std::deque<std::shared_ptr<const Made>> made_;  // used last comes first; a function of the factory
};

}  // namespace mottle::study
