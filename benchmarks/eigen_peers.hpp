// Eigen's dense solvers as a contender, in a library of their own: there they are compiled for this very processor, as
// a user who wants speed would compile them, and no function of theirs can replace one of ours.
#pragma once

namespace mottle::benchmarks {

/// SelfAdjointEigenSolver (vectors included); leaves the lowest values and vectors, whose columns are `order` long.
void eigen_standard(int order, int modes, const double* matrix, double* values, double* vectors);

/// GeneralizedSelfAdjointEigenSolver.
void eigen_generalised(int order, int modes, const double* stiffness, const double* mass, double* values,
                       double* vectors);

/// Closed form for `count` matrices of 3 x 3; `vectors` may be null: then the values alone are sought.
void eigen_compute_direct(long count, const double* matrices, double* values, double* vectors);

}  // namespace mottle::benchmarks
