#include "mottle/model/solvers/reduced_solver.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>

#include "model/solvers/reduced_model_cache.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/parallel.hpp"

namespace mottle::model {
namespace {

using Rows = std::vector<Eigen::Index>;

constexpr Eigen::Index k_min_equations = 500;  // below, an exact solution is as cheap
constexpr Eigen::Index k_min_samples = 4;  // a basis costs three to ten exact solutions; who asks for some asks again
// In exact solutions: the cost of a refined sample, and the saving at which more training pays.
constexpr double k_refinement = 0.1;
constexpr double k_training = 8.0;

double processor_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

TermCoefficients coefficients_at(const SparseStructure& structure, const Eigen::Ref<const Eigen::MatrixXd>& samples) {
  return term_coefficients(structure.stiffness_terms(), structure.mass_terms(), samples);
}

/// Rows whose reduced solution has an error bound above the tolerance.
struct Uncertified {
  Rows rows;
  std::size_t unbounded = 0;  ///< of them those without any bound, which cannot be refined

  double cost() const {
    return k_refinement * static_cast<double>(rows.size() - unbounded) + static_cast<double>(unbounded);
  }
};

/// The requested results from reduced coordinates.
class ReducedObservation {
 public:
  ReducedObservation(const ExactSolver& exact, const SolutionRequest& request, const Eigen::MatrixXd& basis)
      : displacements_(request.observation * basis), compares_(request.reference.shapes.cols() > 0) {
    if (!compares_) return;
    const Eigen::MatrixXd weighed = symmetric_product(exact.reference_mass(), basis);
    reference_ = request.reference.shapes.transpose() * weighed;
    mass_ = basis.transpose() * weighed;
  }

  Solution of(const Eigen::Ref<const Eigen::VectorXd>& values,
              const Eigen::Ref<const Eigen::MatrixXd>& coordinates) const {
    Solution solution{.eigenvalues = values, .displacements = displacements_ * coordinates};
    if (compares_) {
      const Eigen::RowVectorXd squares = coordinates.cwiseProduct(mass_ * coordinates).colwise().sum();
      solution.cosines = cosines_from(reference_ * coordinates, squares);
    }
    return solution;
  }

 private:
  Eigen::MatrixXd displacements_;  // rows of the basis V at the observed degrees of freedom
  bool compares_;
  Eigen::MatrixXd reference_;  // Phi_ref' M V
  Eigen::MatrixXd mass_;       // V' M V
};

}  // namespace

const ReducedModel* TrainedReducedModel::at(int modes, const RunContext& context) {
  const std::lock_guard lock(mutex_);
  if (modes_ == modes) return model_.get();
  modes_ = 0;  // a training that is stopped leaves nothing
  model_.reset();
  const SparseStructure::Matrices nominal = structure_.matrices_at(settings_.nominal);
  try {
    model_ = find_or_train({.folder = settings_.cache},
                           {.terms = pencil_terms(structure_.stiffness_terms(), structure_.mass_terms()),
                            .nominal = coefficients_at(structure_, settings_.nominal.transpose()),
                            .stiffness = nominal.stiffness,
                            .mass = nominal.mass,
                            .options = {.modes = modes, .tolerance = 2.0 * settings_.frequency_error},
                            .training = coefficients_at(structure_, settings_.training)},
                           context);
    modes_ = modes;
  } catch (const InvalidInput&) {
    modes_ = modes;
    return nullptr;  // no modes at the prior's mean; each sample is solved and reported by itself
  }
  if (!model_->reaches_tolerance()) {
    context.note(fmt::format("The prior is too wide for a reduced model within {:.1e}: training ended at {} vectors.",
                             settings_.frequency_error, model_->basis().cols()));
  }
  return model_.get();
}

/// The solution of one cloud: which of its samples are certified, and the visits of those that are.
class ReducedSolver::CloudSolution {
 public:
  CloudSolution(const ExactSolver& exact, double frequency_error, const Eigen::Ref<const Eigen::MatrixXd>& samples,
                const SolutionRequest& request, const RunContext& context, const Visitor& visit)
      : exact_(exact),
        tolerance_(2.0 * frequency_error),
        samples_(samples),
        request_(request),
        context_(context),
        visit_(visit) {}

  /// Visits what the reduced model certifies and returns the rows that are left, ascending.
  Rows reduce(TrainedReducedModel& reduced) {
    const double begin = processor_seconds();
    Rows finite;
    Rows others;
    for (Eigen::Index s = 0; s < samples_.rows(); ++s) (samples_.row(s).allFinite() ? finite : others).push_back(s);
    const ReducedModel* trained = reduced.at(request_.modes, context_);
    Rows left = trained == nullptr ? finite : solve_with(*trained, finite);
    if (trained != nullptr) {
      use_.reduced = static_cast<std::int64_t>(finite.size() - left.size());
      use_.reduced_seconds = processor_seconds() - begin;
      use_.exact_seconds = trained->exact_seconds();
    }
    left.insert(left.end(), others.begin(), others.end());
    std::sort(left.begin(), left.end());
    return left;
  }

  SolverUse finish(const Rows& left) {
    const double begin = processor_seconds();
    exact_.solve_rows(samples_, left, request_, context_, visit_);
    use_.exact = static_cast<std::int64_t>(left.size());
    if (!left.empty()) use_.exact_seconds = (processor_seconds() - begin) / static_cast<double>(left.size());
    return use_;
  }

 private:
  TermCoefficients coefficients(const Rows& rows) const {
    return coefficients_at(exact_.sparse_structure(), samples_(rows, Eigen::all));
  }

  bool is_certified(double bound) const { return bound <= tolerance_; }
  void count_bound(double bound) { use_.frequency_error = std::max(use_.frequency_error, 0.5 * bound); }

  Rows solve_with(const ReducedModel& trained, const Rows& rows);
  Uncertified solve_reduced(const ReducedModel& reduced, const Rows& rows);
  Rows refine(const ReducedModel& reduced, const Rows& rows);

  const ExactSolver& exact_;
  double tolerance_;  // of eigenvalues, relative
  const Eigen::Ref<const Eigen::MatrixXd>& samples_;
  const SolutionRequest& request_;
  const RunContext& context_;
  const Visitor& visit_;
  SolverUse use_;
};

Rows ReducedSolver::CloudSolution::solve_with(const ReducedModel& trained, const Rows& rows) {
  Uncertified uncertified = solve_reduced(trained, rows);
  const ReducedModel* used = &trained;
  std::optional<ReducedModel> enlarged;
  if (uncertified.cost() > k_training && trained.reaches_tolerance()) {
    // The cloud lies outside the training samples: a copy is trained further on the uncertified rows, so that the next
    // batch does not depend on this one.
    constexpr std::size_t k_max_training = 400;
    const Rows& all = uncertified.rows;
    const Rows some(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(std::min(k_max_training, all.size())));
    enlarged.emplace(trained);
    enlarged->train(coefficients(some), context_.threads);
    uncertified = solve_reduced(*enlarged, Rows(all));
    used = &*enlarged;
  }
  Rows left = refine(*used, uncertified.rows);
  constexpr std::size_t k_many = 4;  // one in so many
  if (trained.has_indefinite_terms() && k_many * left.size() > rows.size()) {
    context_.note(fmt::format(
        "Terms of K or M are not positive semidefinite, so that {} of {} samples have no certified bound: these "
        "are solved in full.",
        left.size(), rows.size()));
  }
  return left;
}

Uncertified ReducedSolver::CloudSolution::solve_reduced(const ReducedModel& reduced, const Rows& rows) {
  const ReducedObservation observation(exact_, request_, reduced.basis());
  const CertifiedModes found = reduced.solve(coefficients(rows), context_.threads);
  const Eigen::Index vectors = reduced.basis().cols();
  const Eigen::Index modes = found.values.rows();
  const Eigen::VectorXd largest = found.bounds.colwise().maxCoeff().transpose();
  constexpr std::int64_t k_grain = 64;
  parallel_for(static_cast<std::int64_t>(rows.size()), k_grain, context_.threads,
               [&](std::int64_t begin, std::int64_t end) {
                 for (Eigen::Index i = begin; i < end; ++i) {
                   if (!is_certified(largest(i))) continue;
                   const Eigen::Map<const Eigen::MatrixXd> coordinates(found.vectors.col(i).data(), vectors, modes);
                   visit_(rows[static_cast<std::size_t>(i)], observation.of(found.values.col(i), coordinates), {});
                 }
               });
  context_.throw_if_stopped();
  Uncertified uncertified;
  for (Eigen::Index i = 0; i < largest.size(); ++i) {
    if (is_certified(largest(i))) {
      count_bound(largest(i));
    } else {
      uncertified.rows.push_back(rows[static_cast<std::size_t>(i)]);
      if (!std::isfinite(largest(i))) ++uncertified.unbounded;
    }
  }
  use_.basis = std::max<std::int64_t>(use_.basis, vectors);
  return uncertified;
}

/// Refines the rows, visits those that it certifies and returns the others.
Rows ReducedSolver::CloudSolution::refine(const ReducedModel& reduced, const Rows& rows) {
  if (rows.empty()) return {};
  Eigen::VectorXd largest(static_cast<Eigen::Index>(rows.size()));
  reduced.refine(coefficients(rows), context_.threads, [&](Eigen::Index i, const RefinedModes& modes) {
    context_.throw_if_stopped();
    largest(i) = modes.bounds.maxCoeff();
    if (!is_certified(largest(i))) return;
    visit_(rows[static_cast<std::size_t>(i)], exact_.observe(modes.values, modes.vectors, request_), {});
  });
  Rows left;
  for (Eigen::Index i = 0; i < largest.size(); ++i) {
    if (is_certified(largest(i))) {
      count_bound(largest(i));
    } else {
      left.push_back(rows[static_cast<std::size_t>(i)]);
    }
  }
  use_.refined = static_cast<std::int64_t>(rows.size() - left.size());
  return left;
}

ReducedSolver::ReducedSolver(std::unique_ptr<const ExactSolver> exact, ReductionSettings settings)
    : exact_(std::move(exact)), reduced_(exact_->sparse_structure(), std::move(settings)) {}

SolverUse ReducedSolver::solve(const Eigen::Ref<const Eigen::MatrixXd>& samples, const SolutionRequest& request,
                               const RunContext& context, const Visitor& visit) const {
  const bool is_worth_it = samples.rows() >= k_min_samples && request.modes + k_min_samples < structure().mode_count();
  if (!is_worth_it || request.modes == 0) return exact_->solve(samples, request, context, visit);
  if (request.loads.cols() > 0) return solve_with_loads(samples, request, context, visit);
  CloudSolution cloud(*exact_, reduced_.settings().frequency_error, samples, request, context, visit);
  return cloud.finish(cloud.reduce(reduced_));
}

/// Static solutions by the full matrices, modes by the reduced model.
SolverUse ReducedSolver::solve_with_loads(const Eigen::Ref<const Eigen::MatrixXd>& samples,
                                          const SolutionRequest& request, const RunContext& context,
                                          const Visitor& visit) const {
  std::vector<Eigen::MatrixXd> displacements(static_cast<std::size_t>(samples.rows()));
  std::vector<std::string> failures(displacements.size());
  SolutionRequest statics{.observation = request.observation, .loads = request.loads};
  exact_->solve(samples, statics, context, [&](Eigen::Index s, const Solution& solution, const std::string& failure) {
    displacements[static_cast<std::size_t>(s)] = solution.static_displacements;
    failures[static_cast<std::size_t>(s)] = failure;
  });
  SolutionRequest modes = request;
  modes.loads.resize(0, 0);
  return solve(samples, modes, context, [&](Eigen::Index s, Solution solution, const std::string& failure) {
    const auto k = static_cast<std::size_t>(s);
    solution.static_displacements = std::move(displacements[k]);
    visit(s, solution, failure.empty() ? failures[k] : failure);
  });
}

std::unique_ptr<Solver> make_sparse_solver(std::unique_ptr<const SparseStructure> structure,
                                           std::optional<ReductionSettings> settings) {
  const bool is_reducible = structure->is_separable() && structure->mode_count() >= k_min_equations;
  auto exact = std::make_unique<ExactSolver>(std::move(structure));
  if (!settings || !is_reducible) return exact;
  return std::make_unique<ReducedSolver>(std::move(exact), std::move(*settings));
}

}  // namespace mottle::model
