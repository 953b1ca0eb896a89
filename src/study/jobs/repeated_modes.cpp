#include "study/jobs/repeated_modes.hpp"

#include "mottle/linalg/dense/decompositions.hpp"

namespace mottle::study {

std::vector<ModeGroup> modes_of_one_frequency(const Eigen::VectorXd& frequencies) {
  constexpr double k_equal = 1e-6;  // relative; closer modes are mixed by the slightest change of the model
  std::vector<ModeGroup> groups;
  for (Eigen::Index first = 0, next = 1; first < frequencies.size(); first = next++) {
    while (next < frequencies.size() && frequencies(next) - frequencies(next - 1) <= k_equal * frequencies(next))
      ++next;
    if (next - first > 1) groups.push_back({first, next - first});
  }
  return groups;
}

Eigen::Index with_whole_group(Eigen::Index asked, const Eigen::VectorXd& frequencies,
                              const std::vector<ModeGroup>& groups) {
  for (const auto& [first, count] : groups) {
    if (frequencies(first) > 0.0 && first < asked && asked < first + count) return first + count;
  }
  return asked;
}

Eigen::MatrixXd sums_of_pairs(const Eigen::MatrixXd& shapes, const std::vector<ModeGroup>& groups) {
  Eigen::Index pairs = 0;
  for (const ModeGroup& group : groups) pairs += group.count * (group.count - 1) / 2;
  Eigen::MatrixXd sums(shapes.rows(), pairs);
  Eigen::Index pair = 0;
  for (const auto& [first, count] : groups) {
    for (Eigen::Index j = first + 1; j < first + count; ++j) {
      for (Eigen::Index i = first; i < j; ++i) sums.col(pair++) = shapes.col(i) + shapes.col(j);
    }
  }
  return sums;
}

Eigen::RowVectorXd principal_values(const Eigen::RowVectorXd& values, Eigen::Index modes,
                                    const std::vector<ModeGroup>& groups) {
  Eigen::RowVectorXd result = values.head(modes);
  Eigen::Index pair = modes;
  for (const auto& [first, count] : groups) {
    Eigen::MatrixXd form(count, count);
    for (Eigen::Index j = 0; j < count; ++j) {
      form(j, j) = values(first + j);
      for (Eigen::Index i = 0; i < j; ++i) {
        form(i, j) = form(j, i) = 0.5 * (values(pair++) - values(first + i) - values(first + j));
      }
    }
    if (!form.allFinite()) continue;  // fractions of the energy that a rigid-body motion has not
    result.segment(first, count) = symmetric_eigenvalues(form).transpose();
  }
  return result;
}

}  // namespace mottle::study
