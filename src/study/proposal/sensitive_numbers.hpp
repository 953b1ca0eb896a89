// Which numbers of a model the outputs see, and which they cannot tell apart.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mottle/layers.hpp"
#include "study/jobs/repeated_modes.hpp"
#include "study/proposal/candidate_numbers.hpp"

namespace mottle::study {

/// What the tests see.
struct ProposedOutputs {
  std::vector<int> modes;              ///< by number from 1
  Eigen::VectorXd scales;              ///< of their logarithms, of the tests' scatter [output]
  std::vector<ModeGroup> groups = {};  ///< modes of the model that have one frequency
};

/// Numbers by pivoted orthogonalisation of what they change: A(k, j) = sensitivity of output k to number j times its
/// proposed spread, over the scale of output k.
///
/// In modes of one frequency a number's sensitivities are the eigenvalues of the derivative on the space that they
/// span; its eigenvectors are not known. Their mean, a multiple of the identity, is an entry like others; what is left
/// is taken for a direction of the number's own, so that no number is called like another for equal eigenvalues.
class SensitiveNumbers {
 public:
  SensitiveNumbers(const std::vector<CandidateNumber>& candidates, const ProposedOutputs& outputs);

  double length(Eigen::Index j) const;
  /// Part of a column that the chosen ones cannot give, as a fraction of it.
  double independent(Eigen::Index j) const { return length(j) > 0.0 ? rest(j) / length(j) : 0.0; }
  /// Whether the column is shorter than 1: the number moves no output by more than the scale.
  bool is_seen(Eigen::Index j) const { return length(j) >= 1.0; }
  /// Whether what the chosen ones cannot give is more than 0.15 of the column.
  bool is_told_apart(Eigen::Index j) const { return independent(j) >= 0.15; }

  void choose(Eigen::Index j);
  /// The candidate with the longest rest among those that are seen and told apart; -1: none.
  Eigen::Index next() const;
  /// The chosen column that is most like this one; -1: none is chosen.
  Eigen::Index most_alike(Eigen::Index j) const;
  const std::vector<Eigen::Index>& chosen() const { return chosen_; }

 private:
  double rest(Eigen::Index j) const;
  void add_row_of(Eigen::Index j);

  Eigen::MatrixXd columns_, rest_;
  Eigen::VectorXd own_;  // lengths in a direction that no other column has
  std::vector<Eigen::Index> chosen_;
};

}  // namespace mottle::study
