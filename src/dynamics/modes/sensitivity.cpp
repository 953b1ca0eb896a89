#include "mottle/dynamics/modes/sensitivity.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "mottle/core/error.hpp"
#include "mottle/linalg/dense/decompositions.hpp"

namespace mottle::dynamics {
namespace {

/// Whether two eigenvalues are one to rounding: their shapes, and derivatives along these, are arbitrary. Compared with
/// themselves, since soft and stiff modes may stand in one set; those near zero by rounding are all one.
class Repetitions {
 public:
  explicit Repetitions(const Eigen::VectorXd& eigenvalues)
      : eigenvalues_(eigenvalues), zero_(k_zero * eigenvalues.cwiseAbs().maxCoeff()) {}

  bool are_equal(Eigen::Index r, Eigen::Index s) const {
    const double a = eigenvalues_(r);
    const double b = eigenvalues_(s);
    return std::abs(a - b) <= std::max(zero_, k_repeated * std::max(std::abs(a), std::abs(b)));
  }

  bool is_repeated(Eigen::Index mode) const {
    for (Eigen::Index s = 0; s < eigenvalues_.size(); ++s) {
      if (s != mode && are_equal(mode, s)) return true;
    }
    return false;
  }

 private:
  static constexpr double k_repeated = 1e-10;
  static constexpr double k_zero = 1e-14;

  const Eigen::VectorXd& eigenvalues_;
  double zero_;
};

}  // namespace

Eigen::VectorXd eigenvalue_sensitivity(const ModeSet& modes, const Eigen::Ref<const Eigen::MatrixXd>& dK,
                                       const Eigen::Ref<const Eigen::MatrixXd>& dM) {
  return eigenvalue_sensitivity_from_products(modes, dK * modes.shapes, dM * modes.shapes);
}

Eigen::VectorXd eigenvalue_sensitivity_from_products(const ModeSet& modes,
                                                     const Eigen::Ref<const Eigen::MatrixXd>& dK_shapes,
                                                     const Eigen::Ref<const Eigen::MatrixXd>& dM_shapes) {
  return eigenvalue_sensitivity_from_forms(modes.eigenvalues,
                                           modes.shapes.cwiseProduct(dK_shapes).colwise().sum().transpose(),
                                           modes.shapes.cwiseProduct(dM_shapes).colwise().sum().transpose());
}

Eigen::MatrixXd eigenvalue_sensitivity_from_forms(const Eigen::VectorXd& eigenvalues,
                                                  const Eigen::Ref<const Eigen::MatrixXd>& dK_forms,
                                                  const Eigen::Ref<const Eigen::MatrixXd>& dM_forms) {
  const Repetitions repetitions(eigenvalues);
  Eigen::MatrixXd derivatives = dK_forms - eigenvalues.asDiagonal() * dM_forms;
  for (Eigen::Index r = 0; r < derivatives.rows(); ++r) {
    if (repetitions.is_repeated(r)) derivatives.row(r).setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  return derivatives;
}

Eigen::VectorXd repeated_eigenvalue_sensitivity(const ModeSet& modes, const std::vector<int>& members,
                                                const Eigen::Ref<const Eigen::MatrixXd>& dK_shapes,
                                                const Eigen::Ref<const Eigen::MatrixXd>& dM_shapes) {
  require(!members.empty() && dK_shapes.cols() == static_cast<Eigen::Index>(members.size()),
          "{} members and {} products; one product a member is needed", members.size(), dK_shapes.cols());
  const Eigen::MatrixXd shapes = modes.shapes(Eigen::all, members);
  const Eigen::MatrixXd split = shapes.transpose() * (dK_shapes - modes.eigenvalues(members.front()) * dM_shapes);
  const Eigen::MatrixXd symmetric = 0.5 * (split + split.transpose());
  return symmetric_eigenvalues(symmetric);
}

Eigen::MatrixXd nelson_shape_sensitivity(const SparseMatrix& stiffness, const SparseMatrix& mass, const ModeSet& modes,
                                         int mode, const Eigen::Ref<const Eigen::MatrixXd>& dK_shape,
                                         const Eigen::Ref<const Eigen::MatrixXd>& dM_shape) {
  const Eigen::VectorXd shape = modes.shapes.col(mode);
  const double lambda = modes.eigenvalues(mode);
  if (Repetitions(modes.eigenvalues).is_repeated(mode)) {
    return Eigen::MatrixXd::Constant(shape.size(), dK_shape.cols(), std::numeric_limits<double>::quiet_NaN());
  }
  Eigen::Index largest = 0;
  shape.cwiseAbs().maxCoeff(&largest);
  SparseMatrix system = stiffness - lambda * mass;
  system.makeCompressed();
  for (int column = 0; column < system.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator entry(system, column); entry; ++entry) {
      if (entry.row() == largest || column == largest) entry.valueRef() = entry.row() == column ? 1.0 : 0.0;
    }
  }
  const Eigen::VectorXd inertia = mass.selfadjointView<Eigen::Lower>() * shape;
  const Eigen::RowVectorXd d_lambda = shape.transpose() * (dK_shape - lambda * dM_shape);
  Eigen::MatrixXd v = inertia * d_lambda - (dK_shape - lambda * dM_shape);
  v.row(largest).setZero();
  const auto factor = make_indefinite_factor();
  if (!factor->factorise(system)) {
    return Eigen::MatrixXd::Constant(shape.size(), dK_shape.cols(), std::numeric_limits<double>::quiet_NaN());
  }
  factor->solve(v);
  const Eigen::RowVectorXd weights = -inertia.transpose() * v - 0.5 * shape.transpose() * dM_shape;
  return v + shape * weights;
}

Eigen::MatrixXd shape_sensitivity(const ModeSet& modes, const Eigen::Ref<const Eigen::MatrixXd>& dK,
                                  const Eigen::Ref<const Eigen::MatrixXd>& dM) {
  require(modes.shapes.cols() == modes.shapes.rows(), "{} modes of {}: the expansion needs all of them",
          modes.shapes.cols(), modes.shapes.rows());
  const Eigen::MatrixXd modal_dK = modes.shapes.transpose() * dK * modes.shapes;
  const Eigen::MatrixXd modal_dM = modes.shapes.transpose() * dM * modes.shapes;
  const Repetitions repetitions(modes.eigenvalues);
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(modes.shapes.cols(), modes.shapes.cols());
  for (Eigen::Index r = 0; r < weights.cols(); ++r) {
    const double lambda = modes.eigenvalues(r);
    for (Eigen::Index s = 0; s < weights.rows(); ++s) {
      const double gap = lambda - modes.eigenvalues(s);
      if (s == r) {
        weights(s, r) = -0.5 * modal_dM(r, r);
      } else if (repetitions.are_equal(r, s)) {
        weights.col(r).setConstant(std::numeric_limits<double>::quiet_NaN());
        break;
      } else {
        weights(s, r) = (modal_dK(s, r) - lambda * modal_dM(s, r)) / gap;
      }
    }
  }
  return modes.shapes * weights;
}

}  // namespace mottle::dynamics
