#include "mottle/model/solvers/reduced_solver.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <utility>

#include "model/row_exchange.hpp"
#include "model/solvers/trained_reduced_models.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/rank_share.hpp"
#include "mottle/linalg/dense/products.hpp"

namespace mottle::model {
namespace {

using Rows = std::vector<Eigen::Index>;

constexpr Eigen::Index k_min_equations = 500;  // below, an exact solution is as cheap
constexpr Eigen::Index k_min_samples = 4;  // a basis costs three to ten exact solutions; who asks for some asks again
constexpr double k_training = 8.0;         // saving in exact solutions at which more training pays
constexpr double k_beyond = -1.0;          // instead of a bound: a mode counts that has none

double processor_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// The requested results from reduced coordinates.
class ReducedObservation {
 public:
  ReducedObservation(const SolutionRequest& request, const TrainedReducedModel& trained, BasisPart part)
      : displacements_(request.observation * trained.model().basis()),
        comparison_(request.reference.shapes.cols() > 0 ? trained.comparison_with(request.reference.shapes, part)
                                                        : nullptr) {
    if (part == BasisPart::leading) displacements_ = product(displacements_, trained.model().leading_directions());
  }

  Solution of(const Eigen::Ref<const Eigen::VectorXd>& values,
              const Eigen::Ref<const Eigen::MatrixXd>& coordinates) const {
    Solution solution{.eigenvalues = values, .displacements = product(displacements_, coordinates)};
    if (comparison_ != nullptr) solution.cosines = comparison_->cosines(coordinates);
    return solution;
  }

 private:
  Eigen::MatrixXd displacements_;                        // rows of the basis V at the observed degrees of freedom
  std::shared_ptr<const ReducedComparison> comparison_;  // null where shapes are not compared
};

}  // namespace

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
  Rows reduce(TrainedReducedModels& narrow, TrainedReducedModels& wide) {
    Rows finite;
    Rows left;
    for (Eigen::Index s = 0; s < samples_.rows(); ++s) (samples_.row(s).allFinite() ? finite : left).push_back(s);
    if (request_.certain > 0 && request_.certain < request_.modes) {
      const Rows uncertified = reduce_with(narrow, request_.certain, finite);
      left.insert(left.end(), uncertified.begin(), uncertified.end());
      finite = std::exchange(beyond_, {});
    }
    if (!finite.empty()) {
      const Rows uncertified = reduce_with(wide, request_.modes, finite);
      left.insert(left.end(), uncertified.begin(), uncertified.end());
    }
    std::sort(left.begin(), left.end());
    return left;
  }

  SolverUse finish(const Rows& left) {
    const double seconds = exact_.solve_rows(samples_, left, request_, context_, visit_);
    use_.exact = static_cast<std::int64_t>(left.size());
    if (seconds > 0.0) use_.exact_seconds = seconds;
    return use_;
  }

 private:
  TermCoefficients coefficients(const Rows& rows) const {
    return coefficients_at(exact_.sparse_structure(), samples_(rows, Eigen::all));
  }

  bool is_certified(double bound) const { return bound <= tolerance_; }
  void count_bound(double bound) { use_.frequency_error = std::max(use_.frequency_error, 0.5 * bound); }
  /// Visits a sample with the bound of its eigenvalues, where this is small enough; returns it, or k_beyond.
  double visit_certified(Eigen::Index row, double bound, const Solution& solution) const {
    if (!is_certified(bound)) return bound;
    if (certain_ < request_.modes && !request_.keeps_to_certain(solution.cosines)) return k_beyond;
    visit_(row, solution, {});
    return bound;
  }

  Rows reduce_with(TrainedReducedModels& reduced, int certain, const Rows& rows);
  Rows solve_with(const TrainedReducedModel& trained, const Rows& rows);
  Uncertified solve_reduced(const TrainedReducedModel& trained, const Rows& rows);
  Uncertified solve_by(BasisPart part, const TrainedReducedModel& trained, const Rows& rows);
  Rows refine(const TrainedReducedModel& reduced, const Rows& rows);
  void put_together(const TrainedReducedModel& reduced, Eigen::VectorXd& bounds,
                    const std::vector<std::uint8_t>& is_own) const;

  const ExactSolver& exact_;
  double tolerance_;  // of eigenvalues, relative
  const Eigen::Ref<const Eigen::MatrixXd>& samples_;
  const SolutionRequest& request_;
  const RunContext& context_;
  const Visitor& visit_;
  int certain_ = 0;  ///< of the present pass
  Rows beyond_;      ///< whose comparison asks for modes that this pass does not certify
  SolverUse use_;
};

/// One pass, by a model that certifies the lowest `certain` modes; returns the rows that it leaves, but for beyond_.
Rows ReducedSolver::CloudSolution::reduce_with(TrainedReducedModels& reduced, int certain, const Rows& rows) {
  const double begin = processor_seconds();
  const std::shared_ptr<const TrainedReducedModel> trained =
      reduced.at(request_.region, certain, request_.modes - certain, context_);
  if (trained == nullptr) return rows;
  certain_ = certain;
  Rows left = solve_with(*trained, rows);
  use_.reduced += static_cast<std::int64_t>(rows.size() - left.size() - beyond_.size());
  use_.reduced_seconds += processor_seconds() - begin;
  use_.exact_seconds = trained->model().exact_seconds();
  return left;
}

Rows ReducedSolver::CloudSolution::solve_with(const TrainedReducedModel& trained, const Rows& rows) {
  Uncertified uncertified = solve_reduced(trained, rows);
  const TrainedReducedModel* used = &trained;
  std::optional<TrainedReducedModel> enlarged;
  if (uncertified.cost() > k_training && trained.model().reaches_tolerance()) {
    // The cloud lies outside the training samples: a copy is trained further on the uncertified rows, so that the next
    // batch does not depend on this one.
    constexpr std::size_t k_max_training = 400;
    const Rows& all = uncertified.rows;
    const Rows some(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(std::min(k_max_training, all.size())));
    try {
      auto copy = std::make_shared<ReducedModel>(trained.model());
      copy->train(coefficients(some), context_.threads);
      enlarged.emplace(exact_, std::move(copy));
      uncertified = solve_reduced(*enlarged, Rows(all));
      used = &*enlarged;
    } catch (const InvalidInput&) {  // NOLINT(bugprone-empty-catch): one of them has no modes; each is solved by itself
    }
  }
  Rows left = refine(*used, uncertified.rows);
  constexpr std::size_t k_many = 4;  // one in so many
  if (trained.model().has_indefinite_terms() && k_many * left.size() > rows.size()) {
    context_.note(fmt::format(
        "Terms of K or M are not positive semidefinite, so that {} of {} samples have no certified bound: these "
        "are solved in full.",
        left.size(), rows.size()));
  }
  return left;
}

/// Bounds by row, of which each rank has found some.
void ReducedSolver::CloudSolution::put_together(const TrainedReducedModel& reduced, Eigen::VectorXd& bounds,
                                                const std::vector<std::uint8_t>& is_own) const {
  if (context_.share == nullptr || !context_.share->is_shared()) return;
  RowRecords records;
  for (Eigen::Index i = 0; i < bounds.size(); ++i) {
    if (is_own[static_cast<std::size_t>(i)] != 0) append_value(records.begin(i), bounds(i));
  }
  records.exchange(context_.share->ranks(), reduced.digest(), "the reduced models", bounds.size(),
                   [&](Eigen::Index i, ByteReader& reader) { return reader.read(bounds(i)); });
}

/// By the leading directions, where there are any, and what these leave by the whole basis.
Uncertified ReducedSolver::CloudSolution::solve_reduced(const TrainedReducedModel& trained, const Rows& rows) {
  use_.basis = std::max<std::int64_t>(use_.basis, trained.model().basis().cols());
  if (trained.model().leading_directions().size() == 0) return solve_by(BasisPart::whole, trained, rows);
  const Rows left = solve_by(BasisPart::leading, trained, rows).rows;
  return left.empty() ? Uncertified{} : solve_by(BasisPart::whole, trained, left);
}

Uncertified ReducedSolver::CloudSolution::solve_by(BasisPart part, const TrainedReducedModel& trained,
                                                   const Rows& rows) {
  const ReducedModel& reduced = trained.model();
  const ReducedObservation observation(request_, trained, part);
  const TermCoefficients all = coefficients(rows);
  Eigen::VectorXd largest(static_cast<Eigen::Index>(rows.size()));
  std::vector<std::uint8_t> is_own(rows.size(), 0);
  // About 10 ms of work, so that a batch keeps tens of threads or ranks busy; whole registers and groups of samples.
  constexpr std::int64_t k_piece = 64;
  shared_for(context_, static_cast<std::int64_t>(rows.size()), k_piece, [&](std::int64_t begin, std::int64_t end) {
    context_.throw_if_stopped();
    const TermCoefficients piece = all.range(begin, end - begin);
    const CertifiedModes found = part == BasisPart::whole ? reduced.solve(piece, 1) : reduced.solve_leading(piece, 1);
    const Eigen::Index vectors = found.vectors.rows() / found.values.rows();
    for (Eigen::Index i = begin; i < end; ++i) {
      const Eigen::Index k = i - begin;
      is_own[static_cast<std::size_t>(i)] = 1;
      largest(i) = found.bounds.col(k).maxCoeff();
      if (!is_certified(largest(i))) continue;
      const Eigen::Map<const Eigen::MatrixXd> coordinates(found.vectors.col(k).data(), vectors, found.values.rows());
      largest(i) = visit_certified(rows[static_cast<std::size_t>(i)], largest(i),
                                   observation.of(found.values.col(k), coordinates));
    }
  });
  context_.throw_if_stopped();
  put_together(trained, largest, is_own);
  Uncertified uncertified;
  for (Eigen::Index i = 0; i < largest.size(); ++i) {
    if (largest(i) == k_beyond) {
      beyond_.push_back(rows[static_cast<std::size_t>(i)]);
    } else if (is_certified(largest(i))) {
      count_bound(largest(i));
    } else {
      uncertified.rows.push_back(rows[static_cast<std::size_t>(i)]);
      if (!std::isfinite(largest(i))) ++uncertified.unbounded;
    }
  }
  return uncertified;
}

/// Refines the rows, visits those that it certifies and returns the others.
Rows ReducedSolver::CloudSolution::refine(const TrainedReducedModel& trained, const Rows& rows) {
  if (rows.empty()) return {};
  const TermCoefficients all = coefficients(rows);
  Eigen::VectorXd largest(static_cast<Eigen::Index>(rows.size()));
  std::vector<std::uint8_t> is_own(rows.size(), 0);
  constexpr std::int64_t k_piece = 4;
  shared_for(context_, static_cast<std::int64_t>(rows.size()), k_piece, [&](std::int64_t begin, std::int64_t end) {
    trained.model().refine(all.range(begin, end - begin), 1, [&](Eigen::Index k, const RefinedModes& modes) {
      context_.throw_if_stopped();
      const Eigen::Index i = begin + k;
      is_own[static_cast<std::size_t>(i)] = 1;
      largest(i) = modes.bounds.maxCoeff();
      if (!is_certified(largest(i))) return;
      largest(i) = visit_certified(rows[static_cast<std::size_t>(i)], largest(i),
                                   exact_.observe(modes.values, modes.vectors, request_));
    });
  });
  put_together(trained, largest, is_own);
  Rows left;
  for (Eigen::Index i = 0; i < largest.size(); ++i) {
    const Eigen::Index row = rows[static_cast<std::size_t>(i)];
    if (largest(i) == k_beyond) {
      beyond_.push_back(row);
    } else if (is_certified(largest(i))) {
      count_bound(largest(i));
      ++use_.refined;
    } else {
      left.push_back(row);
    }
  }
  return left;
}

ReducedSolver::ReducedSolver(std::unique_ptr<const ExactSolver> exact, ReductionSettings settings)
    : exact_(std::move(exact)),
      frequency_error_(settings.frequency_error),
      narrow_(std::make_unique<TrainedReducedModels>(*exact_, settings)),
      wide_(std::make_unique<TrainedReducedModels>(*exact_, std::move(settings))) {}

ReducedSolver::~ReducedSolver() = default;

SolverUse ReducedSolver::solve(const Eigen::Ref<const Eigen::MatrixXd>& samples, const SolutionRequest& request,
                               const RunContext& context, const Visitor& visit) const {
  const bool is_cloud = request.region != nullptr || samples.rows() >= k_min_samples;
  const bool is_worth_it = is_cloud && request.modes + k_min_samples < structure().mode_count();
  if (!is_worth_it || request.modes == 0) return exact_->solve(samples, request, context, visit);
  if (request.loads.cols() > 0) return solve_with_loads(samples, request, context, visit);
  CloudSolution cloud(*exact_, frequency_error_, samples, request, context, visit);
  return cloud.finish(cloud.reduce(*narrow_, *wide_));
}

/// Static solutions by the full matrices, modes by the reduced model.
SolverUse ReducedSolver::solve_with_loads(const Eigen::Ref<const Eigen::MatrixXd>& samples,
                                          const SolutionRequest& request, const RunContext& context,
                                          const Visitor& visit) const {
  std::vector<Eigen::MatrixXd> displacements(static_cast<std::size_t>(samples.rows()));
  std::vector<std::string> failures(displacements.size());
  SolutionRequest statics{.observation = request.observation, .loads = request.loads};
  std::vector<std::uint8_t> is_own(displacements.size(), 0);
  exact_->solve(samples, statics, context, [&](Eigen::Index s, const Solution& solution, const std::string& failure) {
    is_own[static_cast<std::size_t>(s)] = 1;
    displacements[static_cast<std::size_t>(s)] = solution.static_displacements;
    failures[static_cast<std::size_t>(s)] = failure;
  });
  if (context.share != nullptr && context.share->is_shared()) {  // a sample's modes may be another rank's business
    RowRecords records;
    for (std::size_t k = 0; k < is_own.size(); ++k) {
      if (is_own[k] == 0) continue;
      std::string& bytes = records.begin(static_cast<Eigen::Index>(k));
      append_matrix(bytes, displacements[k]);
      append_text(bytes, failures[k]);
    }
    records.exchange(context.share->ranks(), {}, "static solutions", samples.rows(),
                     [&](Eigen::Index s, ByteReader& reader) {
                       const auto k = static_cast<std::size_t>(s);
                       return read_matrix(reader, displacements[k]) && reader.read_text(failures[k]);
                     });
  }
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
