#include "model/solvers/trained_reduced_models.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "model/row_exchange.hpp"
#include "model/solvers/reduced_model_cache.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/linalg/dense/products.hpp"

namespace mottle::model {

TermCoefficients coefficients_at(const SparseStructure& structure, const Eigen::Ref<const Eigen::MatrixXd>& samples) {
  return term_coefficients(structure.stiffness_terms(), structure.mass_terms(), samples);
}

ReducedComparison::ReducedComparison(const Eigen::MatrixXd& reference_products, Eigen::MatrixXd masses_between)
    : modes(reference_products.rows()),
      reference(to_rows(reference_products.transpose())),
      mass(std::move(masses_between)),
      masses(mass.diagonal()) {
  if (is_nearly_diagonal(mass)) mass.resize(0, 0);  // the basis is of modes of a pencil with this mass
}

Eigen::MatrixXd ReducedComparison::cosines(const Eigen::Ref<const Eigen::MatrixXd>& coordinates) const {
  const VectorRows products = transposed_product_by_rows(coordinates, reference);
  const Eigen::RowVectorXd squares =
      mass.size() > 0 ? Eigen::RowVectorXd(coordinates.cwiseProduct(product(mass, coordinates)).colwise().sum())
                      : Eigen::RowVectorXd(masses.transpose() * coordinates.cwiseAbs2());
  return cosines_from(products.leftCols(modes).transpose(), squares);
}

std::shared_ptr<const ReducedComparison> TrainedReducedModel::comparison_with(const Eigen::MatrixXd& reference_shapes,
                                                                              BasisPart part) const {
  const std::lock_guard lock(mutex_);
  if (whole_ == nullptr || shapes_.cols() != reference_shapes.cols() || shapes_ != reference_shapes) {
    const Eigen::MatrixXd weighed = symmetric_product(exact_.reference_mass(), model_->basis());
    const Eigen::MatrixXd products = reference_shapes.transpose() * weighed;
    const Eigen::MatrixXd masses = model_->basis().transpose() * weighed, &leading = model_->leading_directions();
    shapes_ = reference_shapes;
    whole_ = std::make_shared<ReducedComparison>(products, masses);
    if (leading.size() > 0) {
      leading_ = std::make_shared<ReducedComparison>(product(products, leading),
                                                     transposed_product(leading, product(masses, leading)));
    }
  }
  return part == BasisPart::whole ? whole_ : leading_;
}

Digest TrainedReducedModel::digest() const {
  const std::lock_guard lock(mutex_);
  if (!digest_) digest_ = digest_of_matrices({model_->basis()});
  return *digest_;
}

namespace {

/// Modes so soft that the rounded numbers of the model decide on digits within the tolerance. What they decide
/// altogether is a rigid-body mode.
void note_unresolved_modes(const Eigen::MatrixXd& resolution, double tolerance, const RunContext& context) {
  constexpr double k_matters = 0.1, k_rigid = 0.5;
  std::vector<std::string> modes;
  for (Eigen::Index k = 0; k < resolution.rows(); ++k) {
    const double error = 0.5 * resolution(k, 1) / std::abs(resolution(k, 0));
    if (!(error > k_matters * tolerance && error < k_rigid)) continue;
    modes.push_back(fmt::format("{} ({:.4g} Hz) by {:.1e}", k + 1,
                                std::sqrt(std::abs(resolution(k, 0))) / (2.0 * std::numbers::pi), error));
  }
  if (modes.empty()) return;
  context.note(
      fmt::format("Rounding of the model's own numbers may change the frequency of mode {} of itself, however it is "
                  "solved; the error bounds of reduced models do not include that.",
                  join(modes)));
}

}  // namespace

std::shared_ptr<const TrainedReducedModel> TrainedReducedModels::at(const SampleRegion* region, int modes, int guards,
                                                                    const RunContext& context) {
  const std::lock_guard lock(mutex_);
  if (modes_ != modes || guards_ != guards) {
    modes_ = 0;  // a training that is stopped leaves nothing
    latest_.reset();
    latest_region_.reset();
    prior_ = train(settings_.prior, modes, guards, context);
    modes_ = modes;
    guards_ = guards;
    if (prior_ != nullptr && !prior_->model().reaches_tolerance()) {
      context.note(fmt::format("The prior is too wide for a reduced model within {:.1e}: training ended at {} vectors.",
                               settings_.frequency_error, prior_->model().basis().cols()));
    }
    if (prior_ != nullptr) note_unresolved_modes(prior_->model().resolution(), settings_.frequency_error, context);
  }
  if (region == nullptr) return prior_;
  if (latest_region_ == region->digest()) return latest_;
  latest_region_.reset();
  latest_.reset();  // one large basis less while the next is trained
  if (prior_ == nullptr || !serves(*prior_, *region, context)) latest_ = train(*region, modes, guards, context);
  if (latest_ == nullptr) latest_ = prior_;
  latest_region_ = region->digest();
  return latest_;
}

bool TrainedReducedModels::serves(const TrainedReducedModel& model, const SampleRegion& region,
                                  const RunContext& context) const {
  constexpr Eigen::Index k_samples = 64;
  constexpr double k_negligible = 0.5;  // exact solutions for all of them
  const Eigen::Index count = std::min(k_samples, region.samples().rows());
  const CertifiedModes found =
      model.model().solve(coefficients_at(exact_.sparse_structure(), region.samples().topRows(count)), context.threads);
  Uncertified uncertified;
  for (Eigen::Index s = 0; s < count; ++s) {
    const double bound = found.bounds.col(s).maxCoeff();
    if (bound <= 2.0 * settings_.frequency_error) continue;
    uncertified.rows.push_back(s);
    if (!std::isfinite(bound)) ++uncertified.unbounded;
  }
  return uncertified.cost() <= k_negligible;
}

std::shared_ptr<const TrainedReducedModel> TrainedReducedModels::train(const SampleRegion& region, int modes,
                                                                       int guards, const RunContext& context) const {
  const SparseStructure& structure = exact_.sparse_structure();
  const SparseStructure::Matrices nominal = structure.matrices_at(region.centre());
  try {
    return std::make_shared<TrainedReducedModel>(
        exact_,
        find_or_train({.folder = settings_.cache},
                      {.terms = pencil_terms(structure.stiffness_terms(), structure.mass_terms()),
                       .nominal = coefficients_at(structure, region.centre().transpose()),
                       .stiffness = nominal.stiffness,
                       .mass = nominal.mass,
                       .options = {.modes = modes, .guards = guards, .tolerance = 2.0 * settings_.frequency_error},
                       .training = coefficients_at(structure, region.samples())},
                      context));
  } catch (const InvalidInput&) {
    return nullptr;  // no modes at the centre; each sample is solved and reported by itself
  }
}

}  // namespace mottle::model
