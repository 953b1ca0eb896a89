// A model with every candidate as a parameter, beside the tests, linearised where one asks.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/jobs/init.hpp"
#include "study/proposal/candidate_numbers.hpp"
#include "study/proposal/linear_explanation.hpp"
#include "study/proposal/sensitive_numbers.hpp"

namespace mottle::study {

class ProposalModel {
 public:
  /// @param outcome     with outputs, pairing and shapes
  /// @param candidates  must outlive it
  /// @throws InvalidInput, FormatError  tests or outputs that cannot be read
  ProposalModel(const InitOutcome& outcome, const std::vector<CandidateNumber>& candidates,
                const ProposedOutputs& outputs);
  ~ProposalModel();

  /// Specimens far from the others are left out of all linear problems: in some output by more than 8 robust standard
  /// deviations from the median. The numbers by which a reader knows them.
  const std::vector<int>& left_out() const { return left_out_; }
  /// Whether the model can be linearised elsewhere than at the deck's numbers.
  bool can_move() const { return can_move_; }
  /// Outputs of the linear problems.
  Eigen::Index output_count() const;

  /// The problem about a point: frequencies by logarithm, shapes over the largest component of all.
  ///
  /// @param point  logarithms of the candidates' factors, in their standard deviations [candidate]
  LinearisedTests linearise(const Eigen::VectorXd& point) const;

 private:
  struct Row;
  struct Parts;

  std::unique_ptr<Parts> parts_;
  std::vector<int> left_out_;
  bool can_move_ = false;
};

}  // namespace mottle::study
