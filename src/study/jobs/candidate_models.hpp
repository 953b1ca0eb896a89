// A model with many candidates, solved by models that know only those candidates that samples move.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/study_model.hpp"

namespace mottle::study {

/// The model of parameters and candidates together. A batch goes to a smaller model of the parameters and of those
/// candidates that differ from their nominal values in some row: a certified reduced model of so few parameters is
/// cheap, one of all candidates is not, and one that cannot be separated spoils it for all. Where a batch moves a
/// candidate far from its nominal value, its reduced model is one that was trained around there.
class CandidateModels final : public Model, public DifferentiableModel {
 public:
  /// Makes the model of the parameters and of some candidates, numbered from 0 on, in this order, for clouds around
  /// `centre` [parameter of that model].
  using Factory = std::function<StudyModel(const std::vector<Eigen::Index>& candidates, const Eigen::VectorXd& centre)>;

  /// @param whole    of all parameters and candidates; must outlive this object
  /// @param given    number of parameters, which stand before the candidates
  /// @param space    of parameters and candidates, which are nominal at its prior's mean; must outlive this object
  CandidateModels(const StructureModel& whole, Eigen::Index given, const ParameterSpace& space, Factory make);

  Eigen::Index parameter_count() const override { return whole_.parameter_count(); }
  const std::vector<Quantity>& outputs() const override { return whole_.outputs(); }
  double difference_step() const override { return k_coarse_difference_step; }
  Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext& context) const override;
  /// Batches are solved by reduced models: their differences are cheaper than the full matrices.
  bool has_cheap_jacobian() const override { return false; }
  /// By all parameters and candidates, from the full matrices.
  Eigen::MatrixXd jacobian(const Eigen::Ref<const Eigen::VectorXd>& parameters) const override {
    return whole_.jacobian(parameters);
  }

 private:
  struct Made {
    std::vector<Eigen::Index> candidates;
    Eigen::VectorXd centre;
    StudyModel model;
  };

  std::vector<Eigen::Index> moved_in(const Eigen::Ref<const Eigen::MatrixXd>& samples) const;
  /// Columns of the parameters and of some candidates.
  std::vector<Eigen::Index> columns_of(const std::vector<Eigen::Index>& candidates) const;
  /// Where a model that serves these samples [sample x parameter of that model] is centred.
  Eigen::VectorXd centre_of(const std::vector<Eigen::Index>& candidates, const Eigen::MatrixXd& samples) const;
  /// Says once of a set of candidates that many of its samples are solved in full.
  void note_full_solutions(const std::vector<Eigen::Index>& candidates, std::int64_t full, Eigen::Index samples,
                           const RunContext& context) const;
  std::shared_ptr<const Made> model_of(const std::vector<Eigen::Index>& candidates,
                                       const Eigen::MatrixXd& samples) const;

  const StructureModel& whole_;
  Eigen::Index given_;
  const ParameterSpace& space_;
  Eigen::VectorXd nominal_;
  Factory make_;
  mutable std::mutex mutex_;                              // of the next two
  mutable std::set<std::vector<Eigen::Index>> noted_;     // candidates whose slow fits were noted
  mutable std::deque<std::shared_ptr<const Made>> made_;  // used last comes first; a function of the factory
};

}  // namespace mottle::study
