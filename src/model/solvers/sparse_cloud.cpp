// Clouds of a structure with sparse matrices: by the reduced model where it is allowed, exactly where it is not sure.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>
#include <numeric>
#include <optional>

#include "model/solvers/reduced_model_cache.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/parallel.hpp"
#include "mottle/model/structures/sparse_structure.hpp"

namespace mottle {
namespace {

using Rows = std::vector<Eigen::Index>;

constexpr Eigen::Index k_least_equations = 500;  // below, an exact solution is as cheap
constexpr Eigen::Index k_least_samples = 4;  // a basis costs three to ten exact solutions; who asks for some asks again
// Of exact solutions: what a refined sample costs, and what makes more vectors worth their training.
constexpr double k_refinement = 0.1;
constexpr double k_training = 8.0;

double processor_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

}  // namespace

/// Reads off full or reduced shapes what is observed.
struct SparseStructure::Observer {
  bool compares() const { return observation.reference.shapes.cols() > 0; }

  /// What a basis adds: reduced shapes are observed like full ones, at the size of the basis.
  struct Reduced {
    Eigen::MatrixXd reference;      ///< Phi_ref' M V
    Eigen::MatrixXd mass;           ///< V' M V
    Eigen::MatrixXd displacements;  ///< rows of V at the observed degrees of freedom
  };
  Reduced reduce(const Eigen::MatrixXd& basis) const {
    Reduced reduced;
    reduced.displacements = structure.displacements(basis, observation.degrees_of_freedom);
    if (!compares()) return reduced;
    const Eigen::MatrixXd weighed = symmetric_product(structure.reference_mass_, basis);
    reduced.reference = observation.reference.shapes.transpose() * weighed;
    reduced.mass = basis.transpose() * weighed;
    return reduced;
  }

  ObservedModes observe(const Eigen::VectorXd& values, const Eigen::MatrixXd& vectors) const {
    ObservedModes observed{values, {}, {}, {}};
    observed.displacements = structure.displacements(vectors, observation.degrees_of_freedom);
    if (compares()) observed.cosines = structure.cosines(observation.reference, {values, vectors});
    return observed;
  }

  ObservedModes observe(const Reduced& reduced, const Eigen::Ref<const Eigen::VectorXd>& values,
                        const Eigen::Ref<const Eigen::MatrixXd>& coordinates) const {
    ObservedModes observed{values, {}, reduced.displacements * coordinates, {}};
    if (compares()) {
      const Eigen::RowVectorXd squares = coordinates.cwiseProduct(reduced.mass * coordinates).colwise().sum();
      observed.cosines = cosines_from(reduced.reference * coordinates, squares);
    }
    return observed;
  }

  const SparseStructure& structure;
  const ModalObservation& observation;
};

/// Rows that the reduced model is not sure enough of.
struct SparseStructure::Unsure {
  Rows rows;
  std::size_t unknown = 0;  ///< of them those without any bound, which cannot be refined

  double cost() const {
    return k_refinement * static_cast<double>(rows.size() - unknown) + static_cast<double>(unknown);
  }
};

void SparseStructure::allow_reduction(ReductionSettings settings) {
  if (is_separable() && mode_count() >= k_least_equations) reduction_ = std::move(settings);
}

TermCoefficients SparseStructure::coefficients_at(const Eigen::Ref<const Eigen::MatrixXd>& samples) const {
  return term_coefficients(stiffness_terms(), mass_terms(), samples);
}

const ReducedModel* SparseStructure::trained_model(int modes, const RunContext& context) const {
  const std::lock_guard lock(reduction_mutex_);
  if (reduced_modes_ == modes) return reduced_.get();
  reduced_modes_ = modes;
  reduced_.reset();
  const Matrices nominal = matrices_at(reduction_->nominal);
  try {
    reduced_ = find_or_train({.folder = reduction_->cache},
                             {.terms = pencil_terms(stiffness_terms(), mass_terms()),
                              .nominal = coefficients_at(reduction_->nominal.transpose()),
                              .stiffness = nominal.stiffness,
                              .mass = nominal.mass,
                              .options = {.modes = modes, .tolerance = 2.0 * reduction_->frequency_error},
                              .training = coefficients_at(reduction_->training)},
                             context);
  } catch (const InvalidInput&) {
    return nullptr;  // no modes at the prior's mean; each sample tells its own story
  }
  if (!reduced_->reaches_tolerance()) {
    context.note(fmt::format("The prior is too wide for a reduced model within {:.1e}: training ended at {} vectors.",
                             reduction_->frequency_error, reduced_->basis().cols()));
  }
  return reduced_.get();
}

SolverUse SparseStructure::solve(const Eigen::Ref<const Eigen::MatrixXd>& samples, int modes,
                                 const ModalObservation& observation, const RunContext& context,
                                 const Visitor& visit) const {
  const Observer observer{*this, observation};
  SolverUse use;
  Rows rows(static_cast<std::size_t>(samples.rows()));
  std::iota(rows.begin(), rows.end(), Eigen::Index{0});
  const bool is_worth_it = samples.rows() >= k_least_samples && modes + k_least_samples < mode_count();
  if (reduction_ && is_worth_it) rows = reduce(samples, modes, observer, context, visit, use);
  const double begin = processor_seconds();
  solve_exactly(samples, rows, modes, observer, context, visit);
  use.exact = static_cast<std::int64_t>(rows.size());
  if (!rows.empty()) use.exact_seconds = (processor_seconds() - begin) / static_cast<double>(rows.size());
  return use;
}

Rows SparseStructure::reduce(const Eigen::Ref<const Eigen::MatrixXd>& samples, int modes, const Observer& observer,
                             const RunContext& context, const Visitor& visit, SolverUse& use) const {
  const double begin = processor_seconds();
  Rows finite;
  Rows others;
  for (Eigen::Index s = 0; s < samples.rows(); ++s) (samples.row(s).allFinite() ? finite : others).push_back(s);
  const ReducedModel* trained = trained_model(modes, context);
  if (trained == nullptr) {
    others.insert(others.end(), finite.begin(), finite.end());
    std::sort(others.begin(), others.end());
    return others;
  }
  Unsure unsure = solve_reduced(*trained, samples, finite, observer, context, visit, use);
  const ReducedModel* used = trained;
  std::optional<ReducedModel> enlarged;
  if (unsure.cost() > k_training && trained->reaches_tolerance()) {
    // The cloud is where the basis was not trained: a copy learns from the unsure ones, so that the next batch does not
    // depend on this one.
    constexpr std::size_t k_most_training = 400;
    const Rows& rows = unsure.rows;
    const Rows some(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(std::min(k_most_training, rows.size())));
    enlarged.emplace(*trained);
    enlarged->train(coefficients_at(samples(some, Eigen::all)), context.threads);
    unsure = solve_reduced(*enlarged, samples, rows, observer, context, visit, use);
    used = &*enlarged;
  }
  Rows left = refine(*used, samples, unsure.rows, observer, context, visit, use);
  constexpr std::size_t k_many = 4;  // one in so many
  if (trained->has_indefinite_terms() && k_many * left.size() > finite.size()) {
    context.note(fmt::format(
        "Terms of K or M are not positive semidefinite, and what they may do leaves {} of {} samples without "
        "a certain bound: these are solved in full.",
        left.size(), finite.size()));
  }
  use.reduced = static_cast<std::int64_t>(finite.size() - left.size());
  use.reduced_seconds = processor_seconds() - begin;
  use.exact_seconds = trained->exact_seconds();
  left.insert(left.end(), others.begin(), others.end());
  std::sort(left.begin(), left.end());
  return left;
}

SparseStructure::Unsure SparseStructure::solve_reduced(const ReducedModel& reduced,
                                                       const Eigen::Ref<const Eigen::MatrixXd>& samples,
                                                       const Rows& rows, const Observer& observer,
                                                       const RunContext& context, const Visitor& visit,
                                                       SolverUse& use) const {
  const Observer::Reduced observed = observer.reduce(reduced.basis());
  const CertifiedModes found = reduced.solve(coefficients_at(samples(rows, Eigen::all)), context.threads);
  const Eigen::Index vectors = reduced.basis().cols();
  const Eigen::Index modes = found.values.rows();
  const double tolerance = 2.0 * reduction_->frequency_error;
  const Eigen::VectorXd worst = found.bounds.colwise().maxCoeff().transpose();
  constexpr std::int64_t k_grain = 64;
  parallel_for(
      static_cast<std::int64_t>(rows.size()), k_grain, context.threads, [&](std::int64_t begin, std::int64_t end) {
        for (Eigen::Index i = begin; i < end; ++i) {
          if (!(worst(i) <= tolerance)) continue;
          const Eigen::Map<const Eigen::MatrixXd> coordinates(found.vectors.col(i).data(), vectors, modes);
          visit(rows[static_cast<std::size_t>(i)], observer.observe(observed, found.values.col(i), coordinates), {});
        }
      });
  context.throw_if_stopped();
  Unsure unsure;
  for (Eigen::Index i = 0; i < worst.size(); ++i) {
    if (!(worst(i) <= tolerance)) {
      unsure.rows.push_back(rows[static_cast<std::size_t>(i)]);
      if (!std::isfinite(worst(i))) ++unsure.unknown;
    } else {
      use.frequency_error = std::max(use.frequency_error, 0.5 * worst(i));
    }
  }
  use.basis = std::max<std::int64_t>(use.basis, vectors);
  return unsure;
}

Rows SparseStructure::refine(const ReducedModel& reduced, const Eigen::Ref<const Eigen::MatrixXd>& samples,
                             const Rows& rows, const Observer& observer, const RunContext& context,
                             const Visitor& visit, SolverUse& use) const {
  if (rows.empty()) return {};
  const double tolerance = 2.0 * reduction_->frequency_error;
  Eigen::VectorXd worst(static_cast<Eigen::Index>(rows.size()));
  reduced.refine(coefficients_at(samples(rows, Eigen::all)), context.threads,
                 [&](Eigen::Index i, const RefinedModes& modes) {
                   context.throw_if_stopped();
                   worst(i) = modes.bounds.maxCoeff();
                   if (!(worst(i) <= tolerance)) return;
                   visit(rows[static_cast<std::size_t>(i)], observer.observe(modes.values, modes.vectors), {});
                 });
  Rows left;
  for (Eigen::Index i = 0; i < worst.size(); ++i) {
    if (!(worst(i) <= tolerance)) {
      left.push_back(rows[static_cast<std::size_t>(i)]);
    } else {
      use.frequency_error = std::max(use.frequency_error, 0.5 * worst(i));
    }
  }
  use.refined = static_cast<std::int64_t>(rows.size() - left.size());
  return left;
}

void SparseStructure::solve_exactly(const Eigen::Ref<const Eigen::MatrixXd>& samples, const Rows& rows, int modes,
                                    const Observer& observer, const RunContext& context, const Visitor& visit) const {
  parallel_for(static_cast<std::int64_t>(rows.size()), 1, context.threads, [&](std::int64_t begin, std::int64_t end) {
    for (Eigen::Index i = begin; i < end; ++i) {
      context.throw_if_stopped();
      const Eigen::Index s = rows[static_cast<std::size_t>(i)];
      const Eigen::VectorXd parameters = samples.row(s).transpose();
      ObservedModes observed{Eigen::VectorXd::Constant(modes, std::numeric_limits<double>::quiet_NaN()), {}, {}, {}};
      std::string failure;
      try {
        SparseModes solved;
        if (parameters.allFinite()) solved = solve_one(parameters, {.modes = modes, .measures = false});
        failure = failure_text(solved);
        if (failure.empty() && solved.values.size() > 0) observed = observer.observe(solved.values, solved.vectors);
      } catch (const InvalidInput& error) {
        failure = error.what();  // a geometry that this sample's parameters make impossible
      }
      visit(s, observed, failure);
    }
  });
}

}  // namespace mottle
