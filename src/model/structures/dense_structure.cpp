#include "mottle/model/structures/dense_structure.hpp"

#include <algorithm>

#include "mottle/core/parallel.hpp"
#include "mottle/core/text.hpp"
#include "mottle/dynamics/modes/damping.hpp"
#include "mottle/dynamics/modes/mac.hpp"
#include "mottle/dynamics/modes/sensitivity.hpp"
#include "mottle/linalg/batched/dense_modes.hpp"

namespace mottle {
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

}  // namespace

DenseStructure::DenseStructure(AffineStructure structure, Eigen::Index parameters)
    : structure_(std::move(structure)), parameters_(parameters), pencils_(make_pencils(structure_)) {}

bool DenseStructure::is_damped() const {
  return !structure_.damping.terms.empty() || !structure_.damping.constant.isZero(0.0);
}

int DenseStructure::find_degree_of_freedom(const std::string& name) const {
  const std::vector<std::string>& names = structure_.degree_of_freedom_names;
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

std::string DenseStructure::unknown_degree_of_freedom(const std::string& name) const {
  if (name.empty()) return fmt::format("none is named, known: {}", join(structure_.degree_of_freedom_names));
  return unknown_name_message("degree of freedom", name, structure_.degree_of_freedom_names);
}

Eigen::MatrixXd DenseStructure::displacements(const Eigen::Ref<const Eigen::MatrixXd>& shapes,
                                              const std::vector<int>& degrees_of_freedom) const {
  return shapes(degrees_of_freedom, Eigen::all);
}

ModeSet DenseStructure::modes_at(const Eigen::Ref<const Eigen::VectorXd>& parameters, int /*modes*/) const {
  const auto solved = solve_modes(structure_.stiffness.at(parameters), structure_.mass.at(parameters), 0);
  return {solved.values, solved.vectors};
}

SolverUse DenseStructure::solve(const Eigen::Ref<const Eigen::MatrixXd>& samples, int modes,
                                const ModalObservation& observation, const RunContext& context,
                                const Visitor& visit) const {
  const BatchModes batch =
      solve_batch(pencils_, coefficients(structure_.stiffness, samples), coefficients(structure_.mass, samples),
                  {.modes = modes, .vectors = observation.needs_shapes(), .threads = context.threads});
  constexpr std::int64_t k_grain = 256;
  parallel_for(samples.rows(), k_grain, context.threads, [&](std::int64_t begin, std::int64_t end) {
    for (Eigen::Index s = begin; s < end; ++s) {
      ObservedModes observed{batch.values.col(s), {}, {}, {}};
      if (!observed.eigenvalues.allFinite()) {
        visit(s, observed,
              "the eigenproblem has no solution: the mass matrix is not positive definite or a value is not finite");
        continue;
      }
      if (observation.needs_shapes()) {
        const ModeSet found{batch.values.col(s), batch.sample_vectors(s)};
        if (observation.reference.shapes.cols() > 0) observed.cosines = cosines(observation.reference, found);
        observed.displacements = displacements(found.shapes, observation.degrees_of_freedom);
        if (observation.damping) observed.damping_ratios = damping_ratios(samples.row(s).transpose(), found);
      }
      visit(s, observed, {});
    }
  });
  return {};
}

Eigen::MatrixXd DenseStructure::cosines(const ModeSet& reference, const ModeSet& modes) const {
  return shape_cosines(reference.shapes, modes.shapes);
}

Eigen::MatrixXd DenseStructure::eigenvalue_derivatives(const Eigen::Ref<const Eigen::VectorXd>&,
                                                       const ModeSet& modes) const {
  Eigen::MatrixXd derivatives(modes.eigenvalues.size(), parameters_);
  for (Eigen::Index i = 0; i < parameters_; ++i) {
    derivatives.col(i) =
        eigenvalue_sensitivity(modes, structure_.stiffness.derivative(i), structure_.mass.derivative(i));
  }
  return derivatives;
}

Eigen::MatrixXd DenseStructure::shape_derivatives(const Eigen::Ref<const Eigen::VectorXd>&, const ModeSet& modes,
                                                  int mode) const {
  Eigen::MatrixXd derivatives(modes.shapes.rows(), parameters_);
  for (Eigen::Index i = 0; i < parameters_; ++i) {
    derivatives.col(i) =
        shape_sensitivity(modes, structure_.stiffness.derivative(i), structure_.mass.derivative(i)).col(mode);
  }
  return derivatives;
}

Eigen::VectorXd DenseStructure::damping_ratios(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                               const ModeSet& modes) const {
  return modal_damping_ratios(modes, structure_.damping.at(parameters));
}

int DenseStructure::modes_for_damping(int /*modes*/) const {
  return static_cast<int>(mode_count());
}

double DenseStructure::total_mass(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  return structure_.mass.at(parameters).trace();
}

std::vector<std::string> DenseStructure::description(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  return {fmt::format("model: {} degrees of freedom, total mass {:.6g}", mode_count(), total_mass(parameters))};
}

}  // namespace mottle
