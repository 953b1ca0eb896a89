#include "mottle/model/solvers/dense_solver.hpp"

#include <cmath>

#include "model/solvers/static_solution.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/parallel.hpp"
#include "mottle/core/rank_share.hpp"
#include "mottle/dynamics/modes/damping.hpp"
#include "mottle/dynamics/modes/mac.hpp"
#include "mottle/dynamics/modes/sensitivity.hpp"
#include "mottle/linalg/batched/dense_modes.hpp"
#include "mottle/linalg/dense/decompositions.hpp"
#include "mottle/linalg/dense/products.hpp"
#include "mottle/linalg/sparse/negative_mass.hpp"

namespace mottle::model {
namespace {

PencilFamily make_pencils(const AffineStructure& structure) {
  PencilFamily family;
  family.stiffness_constant = structure.stiffness.constant;
  family.mass_constant = structure.mass.constant;
  for (const auto& term : structure.stiffness.terms) family.stiffness_terms.push_back(term.matrix);
  for (const auto& term : structure.mass.terms) family.mass_terms.push_back(term.matrix);
  return family;
}

/// Coefficients of the terms for each sample [term x sample].
Eigen::MatrixXd coefficients(const AffineMatrix& matrix, const Eigen::Ref<const Eigen::MatrixXd>& samples) {
  Eigen::MatrixXd result(static_cast<Eigen::Index>(matrix.terms.size()), samples.rows());
  for (Eigen::Index t = 0; t < result.rows(); ++t) {
    result.row(t) = samples.col(matrix.terms[static_cast<std::size_t>(t)].parameter).transpose();
  }
  return result;
}

/// u of K u = f, and of K^-1 times other columns by the same factor.
struct DenseStatics {
  explicit DenseStatics(Eigen::MatrixXd matrix) : stiffness(std::move(matrix)), factor(stiffness) {}

  StaticSolution solve(const Eigen::MatrixXd& loads) const {
    if (!factor.is_positive_definite()) return {.failure = k_no_static_solution};
    return refined_static_solution(
        {.solve = [this](const Eigen::MatrixXd& columns) { return factor.solve(columns); },
         .multiply = [this](const Eigen::MatrixXd& columns) -> Eigen::MatrixXd { return stiffness * columns; },
         .multiply_absolute = [this](const Eigen::MatrixXd& columns) -> Eigen::MatrixXd {
           return stiffness.cwiseAbs() * columns;
         },
         .diagonal = stiffness.diagonal()},
        loads);
  }

  Eigen::MatrixXd stiffness;
  CholeskyFactor factor;
};

}  // namespace

DenseSolver::DenseSolver(DenseStructure structure)
    : structure_(std::move(structure)), pencils_(make_pencils(structure_.matrices())) {
  for (Eigen::Index i = 0; i < structure_.parameter_count(); ++i) {
    stiffness_slopes_.emplace_back(structure_.matrices().stiffness.derivative(i));
    mass_slopes_.emplace_back(structure_.matrices().mass.derivative(i));
  }
}

DenseSolver::Slope::Slope(const Eigen::MatrixXd& matrix) : sparse(matrix.sparseView()) {
  constexpr Eigen::Index k_few = 8;  // one in so many: a product by the entries is as fast as one of full matrices
  if (k_few * sparse.nonZeros() <= matrix.size()) return;
  full = matrix;
  sparse = {};
}

Eigen::VectorXd DenseSolver::Slope::forms(const Eigen::MatrixXd& shapes) const {
  if (full.size() > 0) return shapes.cwiseProduct(product(shapes, full)).rowwise().sum();
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(shapes.rows());
  for (int column = 0; column < sparse.outerSize(); ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(sparse, column); entry; ++entry) {
      sums += entry.value() * shapes.col(entry.row()).cwiseProduct(shapes.col(column));
    }
  }
  return sums;
}

ModeSet DenseSolver::modes_at(const Eigen::Ref<const Eigen::VectorXd>& parameters, int /*modes*/) const {
  const AffineStructure& matrices = structure_.matrices();
  const auto solved = solve_modes(matrices.stiffness.at(parameters), matrices.mass.at(parameters), 0);
  return {solved.values, solved.vectors};
}

SolverUse DenseSolver::solve(const Eigen::Ref<const Eigen::MatrixXd>& samples, const SolutionRequest& request,
                             const RunContext& context, const Visitor& visit) const {
  const std::int64_t piece = samples_of_piece(request);
  if (context.share == nullptr || samples.rows() <= piece) {
    solve_part(samples, request, context, visit);
    return {};
  }
  // A sample has the same bits whatever its neighbours: only ranks need pieces.
  shared_for(context, samples.rows(), piece, [&](std::int64_t begin, std::int64_t end) {
    RunContext alone = context;
    alone.threads = 1;
    solve_part(samples.middleRows(begin, end - begin), request, alone,
               [&](Eigen::Index s, const Solution& solution, const std::string& failure) {
                 visit(begin + s, solution, failure);
               });
  });
  return {};
}

std::string DenseSolver::failure_at(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  const AffineStructure& matrices = structure_.matrices();
  const auto lower = [&](const AffineMatrix& matrix) -> SparseMatrix {
    const Eigen::MatrixXd full = matrix.at(parameters).triangularView<Eigen::Lower>();
    return full.sparseView();
  };
  const auto negative = find_negative_mass(lower(matrices.stiffness), lower(matrices.mass));
  if (!negative)
    return "the eigenproblem has no solution: the mass matrix is not positive definite or a value is not finite";
  return describe(*negative, matrices.degree_of_freedom_names[static_cast<std::size_t>(negative->row)]);
}

/// So many that they take about a tenth of a second, by measured times of this solver with shapes; full lanes.
std::int64_t DenseSolver::samples_of_piece(const SolutionRequest& request) const {
  constexpr double k_piece_s = 0.1;
  constexpr double k_visit_s = 1e-6, k_modes_s = 6e-9, k_full_s = 5e-9;  // a sample; times order^2; times order^3
  constexpr double k_lanes = 32.0;
  const auto order = static_cast<double>(structure_.mode_count());
  const bool needs_full = request.damping || request.loads.cols() > 0;
  const double seconds = k_visit_s + k_modes_s * order * order + (needs_full ? k_full_s * order * order * order : 0.0);
  return static_cast<std::int64_t>(k_lanes * std::ceil(k_piece_s / seconds / k_lanes));
}

void DenseSolver::solve_part(const Eigen::Ref<const Eigen::MatrixXd>& samples, const SolutionRequest& request,
                             const RunContext& context, const Visitor& visit) const {
  BatchModes batch;
  if (request.modes > 0) {
    batch = solve_batch(pencils_, coefficients(structure_.matrices().stiffness, samples),
                        coefficients(structure_.matrices().mass, samples),
                        {.modes = request.modes, .vectors = request.needs_shapes(), .threads = context.threads});
  }
  constexpr std::int64_t k_grain = 256;
  parallel_for(samples.rows(), k_grain, context.threads, [&](std::int64_t begin, std::int64_t end) {
    for (Eigen::Index s = begin; s < end; ++s) {
      Solution solution;
      std::string failure;
      if (request.modes > 0) {
        solution.eigenvalues = batch.values.col(s);
        if (!solution.eigenvalues.allFinite()) {
          visit(s, solution, failure_at(samples.row(s).transpose()));
          continue;
        }
        if (request.needs_shapes())
          observe_shapes(batch.sample_vectors(s), samples.row(s).transpose(), request, solution);
      }
      if (request.loads.cols() > 0) {
        const DenseStatics statics(structure_.matrices().stiffness.at(samples.row(s).transpose()));
        const StaticSolution found = statics.solve(request.loads);
        failure = found.failure;
        if (failure.empty()) solution.static_displacements = request.observation * found.displacements;
      }
      visit(s, solution, failure);
    }
  });
}

void DenseSolver::observe_shapes(const Eigen::MatrixXd& shapes, const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                 const SolutionRequest& request, Solution& solution) const {
  const ModeSet found{solution.eigenvalues, shapes};
  if (request.reference.shapes.cols() > 0) solution.cosines = cosines(request.reference, found);
  solution.displacements = request.observation * shapes;
  if (request.damping) {
    solution.damping_ratios = modal_damping_ratios(found, structure_.matrices().damping.at(parameters));
  }
}

Eigen::MatrixXd DenseSolver::cosines(const ModeSet& reference, const ModeSet& modes) const {
  return shape_cosines(reference.shapes, modes.shapes);
}

Eigen::MatrixXd DenseSolver::eigenvalue_derivatives(const Eigen::Ref<const Eigen::VectorXd>&,
                                                    const ModeSet& modes) const {
  const Eigen::MatrixXd shapes = modes.shapes.transpose();
  Eigen::MatrixXd stiffness(shapes.rows(), structure_.parameter_count());
  Eigen::MatrixXd mass(shapes.rows(), structure_.parameter_count());
  for (Eigen::Index i = 0; i < structure_.parameter_count(); ++i) {
    stiffness.col(i) = stiffness_slopes_[static_cast<std::size_t>(i)].forms(shapes);
    mass.col(i) = mass_slopes_[static_cast<std::size_t>(i)].forms(shapes);
  }
  return eigenvalue_sensitivity_from_forms(modes.eigenvalues, stiffness, mass);
}

Eigen::MatrixXd DenseSolver::shape_derivatives(const Eigen::Ref<const Eigen::VectorXd>&, const ModeSet& modes,
                                               int mode) const {
  Eigen::MatrixXd derivatives(modes.shapes.rows(), structure_.parameter_count());
  for (Eigen::Index i = 0; i < structure_.parameter_count(); ++i) {
    derivatives.col(i) = shape_sensitivity(modes, structure_.matrices().stiffness.derivative(i),
                                           structure_.matrices().mass.derivative(i))
                             .col(mode);
  }
  return derivatives;
}

std::vector<Eigen::MatrixXd> DenseSolver::static_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                                             const Eigen::MatrixXd& loads,
                                                             const ObservationMatrix& observation) const {
  const DenseStatics statics(structure_.matrices().stiffness.at(parameters));
  const StaticSolution found = statics.solve(loads);
  require(found.failure.empty(), "{}", found.failure);
  const Eigen::MatrixXd adjoint = statics.factor.solve(Eigen::MatrixXd(observation.transpose()));
  return static_sensitivity(adjoint, loads.cols(), structure_.parameter_count(),
                            [&](Eigen::Index i) -> Eigen::MatrixXd {
                              return structure_.matrices().stiffness.derivative(i) * found.displacements;
                            });
}

int DenseSolver::modes_for_damping(int /*modes*/) const {
  return static_cast<int>(structure_.mode_count());
}

}  // namespace mottle::model
