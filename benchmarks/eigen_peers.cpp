#include "eigen_peers.hpp"

#include <Eigen/Eigenvalues>

namespace mottle::benchmarks {
namespace {

using Matrix = Eigen::MatrixXd;
using ConstMap = Eigen::Map<const Matrix>;

template <typename Solver>
void keep_lowest(const Solver& solver, int order, int modes, double* values, double* vectors) {
  Eigen::Map<Eigen::VectorXd>(values, modes) = solver.eigenvalues().head(modes);
  Eigen::Map<Matrix>(vectors, order, modes) = solver.eigenvectors().leftCols(modes);
}

}  // namespace

#define MOTTLE_SHOWN __attribute__((visibility("default")))

MOTTLE_SHOWN void eigen_standard(int order, int modes, const double* matrix, double* values, double* vectors) {
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(ConstMap(matrix, order, order));
  keep_lowest(solver, order, modes, values, vectors);
}

MOTTLE_SHOWN void eigen_generalised(int order, int modes, const double* stiffness, const double* mass, double* values,
                                    double* vectors) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> solver(ConstMap(stiffness, order, order),
                                                                ConstMap(mass, order, order));
  keep_lowest(solver, order, modes, values, vectors);
}

MOTTLE_SHOWN void eigen_compute_direct(long count, const double* matrices, double* values, double* vectors) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  for (long i = 0; i < count; ++i) {
    solver.computeDirect(Eigen::Map<const Eigen::Matrix3d>(matrices + 9 * i),
                         vectors != nullptr ? Eigen::ComputeEigenvectors : Eigen::EigenvaluesOnly);
    Eigen::Map<Eigen::Vector3d>(values + 3 * i) = solver.eigenvalues();
    if (vectors != nullptr) Eigen::Map<Eigen::Matrix3d>(vectors + 9 * i) = solver.eigenvectors();
  }
}

}  // namespace mottle::benchmarks
