#include "mottle/dynamics/modes/mac.hpp"

#include <algorithm>
#include <limits>

#include "mottle/core/error.hpp"

namespace mottle::dynamics {

Eigen::MatrixXd modal_assurance_criterion(const Eigen::Ref<const Eigen::MatrixXd>& a,
                                          const Eigen::Ref<const Eigen::MatrixXd>& b) {
  return shape_cosines(a, b).cwiseAbs2();
}

std::vector<int> optimal_assignment(const Eigen::Ref<const Eigen::MatrixXd>& score) {
  const int rows = static_cast<int>(score.rows());
  const int columns = static_cast<int>(score.cols());
  require(rows <= columns, "{} rows cannot be assigned to {} columns", rows, columns);
  // Index `columns` of the column arrays is the artificial start of each augmenting path.
  std::vector<double> row_price(rows, 0.0);
  std::vector<double> column_price(columns + 1, 0.0);
  std::vector<int> row_of(columns + 1, -1);
  for (int row = 0; row < rows; ++row) {
    std::vector<double> shortest(columns, std::numeric_limits<double>::infinity());
    std::vector<int> previous(columns, columns);
    std::vector<bool> is_done(columns + 1, false);
    int column = columns;
    row_of[columns] = row;
    while (row_of[column] >= 0) {
      is_done[column] = true;
      const int active = row_of[column];
      double step = std::numeric_limits<double>::infinity();
      int next = -1;
      for (int candidate = 0; candidate < columns; ++candidate) {
        if (is_done[candidate]) continue;
        const double reduced = -score(active, candidate) - row_price[active] - column_price[candidate];
        if (reduced < shortest[candidate]) {
          shortest[candidate] = reduced;
          previous[candidate] = column;
        }
        if (next < 0 || shortest[candidate] < step) {
          step = shortest[candidate];
          next = candidate;
        }
      }
      for (int other = 0; other <= columns; ++other) {
        if (is_done[other]) {
          row_price[row_of[other]] += step;
          column_price[other] -= step;
        } else if (other < columns) {
          shortest[other] -= step;
        }
      }
      column = next;
    }
    while (column != columns) {
      row_of[column] = row_of[previous[column]];
      column = previous[column];
    }
  }
  std::vector<int> column_of(rows, -1);
  for (int column = 0; column < columns; ++column) {
    if (row_of[column] >= 0) column_of[row_of[column]] = column;
  }
  return column_of;
}

Eigen::MatrixXd shape_cosines(const Eigen::Ref<const Eigen::MatrixXd>& a, const Eigen::Ref<const Eigen::MatrixXd>& b) {
  require(a.rows() == b.rows(), "shapes with {} and {} degrees of freedom cannot be compared", a.rows(), b.rows());
  Eigen::MatrixXd cosines = a.transpose() * b;
  const Eigen::VectorXd lengths_a = a.colwise().norm();
  const Eigen::VectorXd lengths_b = b.colwise().norm();
  for (Eigen::Index j = 0; j < b.cols(); ++j) {
    for (Eigen::Index i = 0; i < a.cols(); ++i) {
      const bool is_zero = lengths_a(i) == 0.0 || lengths_b(j) == 0.0;
      // Divided one by one, lest products of small or large shapes leave the range of double.
      cosines(i, j) = is_zero ? 0.0 : std::clamp(cosines(i, j) / lengths_a(i) / lengths_b(j), -1.0, 1.0);
    }
  }
  return cosines;
}

}  // namespace mottle::dynamics
