#include "supported_matrix.hpp"

#include "blas.hpp"

namespace mottle {

SupportedMatrix::SupportedMatrix(const SparseMatrix& lower) {
  std::vector<int> place(static_cast<std::size_t>(lower.rows()), -1);
  for (int j = 0; j < lower.outerSize(); ++j) {
    for (SparseMatrix::InnerIterator entry(lower, j); entry; ++entry) {
      place[static_cast<std::size_t>(entry.row())] = 0;
      place[static_cast<std::size_t>(j)] = 0;
    }
  }
  for (std::size_t i = 0; i < place.size(); ++i) {
    if (place[i] < 0) continue;
    place[i] = static_cast<int>(rows_.size());
    rows_.push_back(static_cast<int>(i));
  }
  const auto order = static_cast<Eigen::Index>(rows_.size());
  lower_.resize(order, order);
  lower_.reserve(lower.nonZeros());
  for (Eigen::Index j = 0; j < order; ++j) {
    lower_.startVec(j);
    for (SparseMatrix::InnerIterator entry(lower, rows_[static_cast<std::size_t>(j)]); entry; ++entry) {
      lower_.insertBack(place[static_cast<std::size_t>(entry.row())], j) = entry.value();
    }
  }
  lower_.finalize();
}

void SupportedMatrix::add_scaled_product(const VectorRows& x, const Eigen::VectorXd& scales, VectorRows& result) const {
  VectorRows in(static_cast<Eigen::Index>(rows_.size()), x.cols());
  const Eigen::RowVectorXd factors = scales.transpose();
  for (Eigen::Index i = 0; i < in.rows(); ++i) {
    in.row(i) = x.row(rows_[static_cast<std::size_t>(i)]).cwiseProduct(factors);
  }
  const VectorRows product = product_rows(lower_, in);
  for (Eigen::Index i = 0; i < in.rows(); ++i) result.row(rows_[static_cast<std::size_t>(i)]) += product.row(i);
}

VectorRows SupportedMatrix::local_product(const VectorRows& x) const {
  if (is_full(x.rows())) return product_rows(lower_, x);
  return product_rows(lower_, x(rows_, Eigen::all));
}

Eigen::MatrixXd SupportedMatrix::project(const Eigen::Ref<const Eigen::MatrixXd>& left, const VectorRows& product,
                                         Eigen::Index count) const {
  // Row by row is the transpose column by column: the product needs no turning.
  const Eigen::Map<const Eigen::MatrixXd> transposed(product.data(), product.cols(), product.rows());
  Eigen::MatrixXd result(product.cols(), left.cols());
  if (is_full(left.rows())) {
    multiply(1.0, transposed, false, left, 0.0, result);
  } else {
    multiply(1.0, transposed, false, left(rows_, Eigen::all), 0.0, result);
  }
  return result.topRows(count).transpose();
}

Eigen::MatrixXd SupportedMatrix::project_rows(const VectorRows& left, const VectorRows& product,
                                              Eigen::Index count) const {
  const auto columns = [](const VectorRows& rows) {
    return Eigen::Map<const Eigen::MatrixXd>(rows.data(), rows.cols(), rows.rows());
  };
  if (is_full(left.rows())) return product_transposed(columns(left), columns(product).topRows(count));
  VectorRows own(product.rows(), left.cols());
  for (Eigen::Index i = 0; i < own.rows(); ++i) own.row(i) = left.row(rows_[static_cast<std::size_t>(i)]);
  return product_transposed(columns(own), columns(product).topRows(count));
}

void SupportedMatrix::add_to(SparseMatrix& sum, double factor) const {
  for (Eigen::Index j = 0; j < lower_.cols(); ++j) {
    int k = sum.outerIndexPtr()[rows_[static_cast<std::size_t>(j)]];
    for (SparseMatrix::InnerIterator entry(lower_, j); entry; ++entry) {
      const int row = rows_[static_cast<std::size_t>(entry.row())];
      while (sum.innerIndexPtr()[k] < row) ++k;
      sum.valuePtr()[k] += factor * entry.value();
    }
  }
}

void add_weighted_products(const std::vector<SupportedMatrix>& terms, const Eigen::MatrixXd& weights,
                           const VectorRows& x, VectorRows& result) {
  Eigen::VectorXd scales = Eigen::VectorXd::Zero(x.cols());
  for (std::size_t t = 0; t < terms.size(); ++t) {
    scales.head(weights.cols()) = weights.row(static_cast<Eigen::Index>(t)).transpose();
    if (!terms[t].is_empty()) terms[t].add_scaled_product(x, scales, result);
  }
}

}  // namespace mottle
