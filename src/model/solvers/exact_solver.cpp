#include "mottle/model/solvers/exact_solver.hpp"

#include <algorithm>
#include <atomic>
#include <ctime>
#include <limits>
#include <numeric>

#include "model/solvers/static_solution.hpp"
#include "mottle/core/rank_share.hpp"
#include "mottle/core/subject.hpp"
#include "mottle/dynamics/modes/sensitivity.hpp"

namespace mottle::model {
namespace {

/// K's factor, and what K^-1 makes of loads. The arguments must live as long.
class SparseStatics {
 public:
  SparseStatics(SparseModeSolverPool& pool, const SparseStructure& structure, const SparseMatrix& stiffness)
      : pool_(pool), structure_(structure), stiffness_(stiffness), solver_(pool.take()) {
    is_definite_ = solver_->factorise_stiffness(stiffness);
  }
  SparseStatics(const SparseStatics&) = delete;
  SparseStatics& operator=(const SparseStatics&) = delete;
  ~SparseStatics() { pool_.give_back(std::move(solver_)); }

  /// K^-1 of columns, of a definite K.
  Eigen::MatrixXd apply(Eigen::MatrixXd columns) const {
    solver_->factor().solve(columns);
    return columns;
  }

  StaticSolution solve(const Eigen::MatrixXd& loads) const {
    if (!is_definite_) {
      const int row = solver_->factor().failed_column();
      const std::string where = row < 0 ? "" : fmt::format(" (first seen at {})", structure_.equation_name(row));
      return {.failure = k_no_static_solution + where};
    }
    return refined_static_solution(
        {.solve = [this](const Eigen::MatrixXd& columns) { return apply(columns); },
         .multiply = [this](const Eigen::MatrixXd& columns) { return symmetric_product(stiffness_, columns); },
         .multiply_absolute =
             [this](const Eigen::MatrixXd& columns) { return symmetric_product(stiffness_.cwiseAbs(), columns); },
         .diagonal = stiffness_.diagonal()},
        loads);
  }

 private:
  SparseModeSolverPool& pool_;
  const SparseStructure& structure_;
  const SparseMatrix& stiffness_;
  std::unique_ptr<SparseModeSolver> solver_;
  bool is_definite_ = false;
};

}  // namespace

SparseStructure::Matrices MatrixDerivatives::at(const SparseStructure& structure,
                                                const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                                Eigen::Index parameter) {
  if (structure.terms_give_derivative(parameters, parameter)) return structure.derivative_at(parameters, parameter);
  {
    const std::lock_guard lock(mutex_);
    if (point_.size() != parameters.size() || point_ != parameters) {
      point_ = parameters;
      known_.clear();
    }
    const auto known = known_.find(parameter);
    if (known != known_.end()) return known->second;
  }
  SparseStructure::Matrices result = structure.derivative_at(parameters, parameter);
  const std::lock_guard lock(mutex_);
  if (point_.size() == parameters.size() && point_ == parameters) known_[parameter] = result;
  return result;
}

std::unique_ptr<SparseModeSolver> SparseModeSolverPool::take() {
  const std::lock_guard lock(mutex_);
  if (idle_.empty()) return std::make_unique<SparseModeSolver>();
  std::unique_ptr<SparseModeSolver> solver = std::move(idle_.back());
  idle_.pop_back();
  return solver;
}

void SparseModeSolverPool::give_back(std::unique_ptr<SparseModeSolver> solver) {
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(solver));
}

SparseModes SparseModeSolverPool::solve(const SparseStructure::Matrices& matrices, const SparseModesOptions& options) {
  std::unique_ptr<SparseModeSolver> solver = take();
  SparseModes modes = solver->solve(matrices.stiffness, matrices.mass, options);
  give_back(std::move(solver));
  return modes;
}

ExactSolver::ExactSolver(std::unique_ptr<const SparseStructure> structure)
    : structure_(std::move(structure)), reference_mass_(structure_->matrices_at(structure_->reference()).mass) {}

SparseModes ExactSolver::solve_one(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                   const SparseModesOptions& options) const {
  return solve_matrices(structure_->matrices_at(parameters), options);
}

SparseModes ExactSolver::solve_matrices(const SparseStructure::Matrices& matrices, SparseModesOptions options) const {
  options.is_mass_semidefinite = matrices.is_mass_semidefinite;
  return pool_.solve(matrices, options);
}

std::string ExactSolver::failure_text(const SparseModes& modes) const {
  if (modes.failed_row < 0) return modes.failure;
  const std::string place = structure_->equation_name(modes.failed_row);
  if (modes.negative_mass) return describe(*modes.negative_mass, place);
  const bool turns_freely = modes.is_massless && place.find("+R") != std::string::npos;
  return fmt::format("{} (first seen at {}{})", modes.failure, place,
                     turns_freely ? ", a rotation without inertia: bars, for example, have none about their own axis, "
                                    "and what they make up must be held against turning about it"
                                  : "");
}

Solution ExactSolver::observe(const Eigen::VectorXd& values, const Eigen::MatrixXd& vectors,
                              const SolutionRequest& request) const {
  Solution solution{.eigenvalues = values};
  solution.displacements = request.observation * vectors;
  if (request.reference.shapes.cols() > 0) solution.cosines = cosines(request.reference, {values, vectors});
  return solution;
}

SolverUse ExactSolver::solve(const Eigen::Ref<const Eigen::MatrixXd>& samples, const SolutionRequest& request,
                             const RunContext& context, const Visitor& visit) const {
  std::vector<Eigen::Index> rows(static_cast<std::size_t>(samples.rows()));
  std::iota(rows.begin(), rows.end(), Eigen::Index{0});
  const double seconds = solve_rows(samples, rows, request, context, visit);
  return {.exact = samples.rows(), .exact_seconds = seconds};
}

double ExactSolver::solve_rows(const Eigen::Ref<const Eigen::MatrixXd>& samples, const std::vector<Eigen::Index>& rows,
                               const SolutionRequest& request, const RunContext& context, const Visitor& visit) const {
  const std::clock_t start = std::clock();
  std::atomic<std::int64_t> own{0};
  shared_for(context, static_cast<std::int64_t>(rows.size()), 1, [&](std::int64_t begin, std::int64_t end) {
    for (Eigen::Index i = begin; i < end; ++i) {
      context.throw_if_stopped();
      const Eigen::Index s = rows[static_cast<std::size_t>(i)];
      const Eigen::VectorXd parameters = samples.row(s).transpose();
      Solution solution{.eigenvalues =
                            Eigen::VectorXd::Constant(request.modes, std::numeric_limits<double>::quiet_NaN())};
      std::string failure;
      try {
        if (parameters.allFinite()) failure = solve_row(parameters, request, solution);
      } catch (const InvalidInput& error) {
        failure = error.what();  // a geometry that this sample's parameters make impossible
      }
      visit(s, solution, failure);
    }
    own += end - begin;
  });
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  return own > 0 ? seconds / static_cast<double>(own) : 0.0;
}

/// Why there is no solution; empty: there is.
std::string ExactSolver::solve_row(const Eigen::VectorXd& parameters, const SolutionRequest& request,
                                   Solution& solution) const {
  const SparseStructure::Matrices matrices = structure_->matrices_at(parameters);
  if (request.modes > 0) {
    const SparseModes solved = solve_matrices(matrices, {.modes = request.modes, .measures = false});
    if (std::string failure = failure_text(solved); !failure.empty()) return failure;
    solution = observe(solved.values, solved.vectors, request);
  }
  if (request.loads.cols() == 0) return {};
  const StaticSolution found = SparseStatics(pool_, *structure_, matrices.stiffness).solve(request.loads);
  if (found.failure.empty()) solution.static_displacements = request.observation * found.displacements;
  return found.failure;
}

std::vector<Eigen::MatrixXd> ExactSolver::static_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                                             const Eigen::MatrixXd& loads,
                                                             const ObservationMatrix& observation) const {
  const SparseMatrix stiffness = structure_->matrices_at(parameters).stiffness;
  const SparseStatics statics(pool_, *structure_, stiffness);
  const StaticSolution found = statics.solve(loads);
  require(found.failure.empty(), "{}", found.failure);
  const Eigen::MatrixXd adjoint = statics.apply(Eigen::MatrixXd(observation.transpose()));
  return static_sensitivity(adjoint, loads.cols(), structure_->parameter_count(), [&](Eigen::Index i) {
    return symmetric_product(derivatives_.at(*structure_, parameters, i).stiffness, found.displacements);
  });
}

ModeSet ExactSolver::modes_at(const Eigen::Ref<const Eigen::VectorXd>& parameters, int modes) const {
  SparseModes found = solve_one(parameters, {.modes = modes, .counts_below = true});
  require_of(found.failure.empty(), {Subject::Kind::model}, "it cannot be solved at the parameters' means: {}",
             failure_text(found));
  if (!found.is_complete()) {
    throw ModelFailure(
        fmt::format("the solver found {} modes below {:.6g} (rad/s)^2 where the inertia of K - s M counts {}",
                    found.values.size(), found.counted_at, found.counted_below));
  }
  return {found.values, found.vectors};
}

double ExactSolver::eigenvalue_rounding(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                        const ModeSet& modes) const {
  if (modes.shapes.cols() == 0) return 0.0;
  return structure_->entry_rounding() *
         sums_of_terms(structure_->matrices_at(parameters).stiffness, modes.shapes).maxCoeff();
}

Eigen::MatrixXd ExactSolver::cosines(const ModeSet& reference, const ModeSet& modes) const {
  const Eigen::MatrixXd weighed = symmetric_product(reference_mass_, modes.shapes);
  const Eigen::RowVectorXd squares = modes.shapes.cwiseProduct(weighed).colwise().sum();
  return cosines_from(reference.shapes.transpose() * weighed, squares);
}

Eigen::MatrixXd cosines_from(const Eigen::MatrixXd& products, const Eigen::RowVectorXd& squares) {
  return (products * squares.cwiseSqrt().cwiseInverse().asDiagonal()).cwiseMax(-1.0).cwiseMin(1.0);
}

Eigen::MatrixXd ExactSolver::eigenvalue_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                                    const ModeSet& modes) const {
  Eigen::MatrixXd derivatives(modes.eigenvalues.size(), structure_->parameter_count());
  for (Eigen::Index i = 0; i < structure_->parameter_count(); ++i) {
    const SparseStructure::Matrices d = derivatives_.at(*structure_, parameters, i);
    derivatives.col(i) = eigenvalue_sensitivity_from_products(modes, symmetric_product(d.stiffness, modes.shapes),
                                                              symmetric_product(d.mass, modes.shapes));
  }
  return derivatives;
}

Eigen::MatrixXd ExactSolver::shape_derivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                               const ModeSet& modes, int mode) const {
  const SparseStructure::Matrices at = structure_->matrices_at(parameters);
  const auto shape = modes.shapes.col(mode);
  Eigen::MatrixXd elastic(shape.size(), structure_->parameter_count());
  Eigen::MatrixXd inertial(shape.size(), structure_->parameter_count());
  for (Eigen::Index i = 0; i < structure_->parameter_count(); ++i) {
    const SparseStructure::Matrices d = derivatives_.at(*structure_, parameters, i);
    elastic.col(i) = symmetric_product(d.stiffness, shape);
    inertial.col(i) = symmetric_product(d.mass, shape);
  }
  return nelson_shape_sensitivity(at.stiffness, at.mass, modes, mode, elastic, inertial);
}

}  // namespace mottle::model
