#include "mottle/model/modal_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "mottle/core/error.hpp"
#include "mottle/core/parallel.hpp"
#include "mottle/core/text.hpp"
#include "mottle/linalg/dense_modes.hpp"
#include "mottle/modal/damping.hpp"
#include "mottle/modal/mac.hpp"
#include "mottle/modal/sensitivity.hpp"

namespace mottle {
namespace {

constexpr int k_guard_modes = 4;  // tracking must see a mode that left the band of wanted ones
constexpr double k_two_pi = 2.0 * std::numbers::pi;

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

void require_modes(const std::vector<int>& modes, const std::string& key, Eigen::Index available) {
  std::set<int> seen;
  for (const int mode : modes) {
    require(mode >= 1 && mode <= available, "outputs.{}: mode {} is not there, the model has modes 1 to {}", key, mode,
            available);
    require(seen.insert(mode).second, "outputs.{}: mode {} stands twice", key, mode);
  }
}

int largest(const std::vector<int>& modes) {
  return modes.empty() ? 0 : *std::max_element(modes.begin(), modes.end());
}

}  // namespace

ModalModel::ModalModel(AffineStructure structure, ModalOutputs selection, const Eigen::VectorXd& reference)
    : structure_(std::move(structure)),
      selection_(std::move(selection)),
      reference_parameters_(reference),
      pencils_(make_pencils(structure_)) {
  check_selection();
  reference_ = modes_at(reference);
  require(reference_.eigenvalues.allFinite(),
          "model: it has no modes at the parameters' means: the mass matrix is not positive definite there");
  const double scale = reference_.eigenvalues.cwiseAbs().maxCoeff();
  require(
      !std::isnan(natural_frequency_hz(reference_.eigenvalues(0), scale)),
      "model: it is unstable at the parameters' means, its lowest eigenvalue is {:.6g}; a stiffness must be negative",
      reference_.eigenvalues(0));
  highest_mode_ =
      std::max({largest(selection_.frequencies), largest(selection_.shape_modes), largest(selection_.damping)});
  name_outputs();
}

void ModalModel::check_selection() const {
  const Eigen::Index available = structure_.stiffness.constant.rows();
  require_modes(selection_.frequencies, "frequencies", available);
  require_modes(selection_.shape_modes, "shapes.modes", available);
  require_modes(selection_.damping, "damping", available);
  require(!selection_.frequencies.empty() || !selection_.shape_modes.empty() || !selection_.damping.empty(),
          "outputs: none is named; give for example frequencies = [1, 2]");
  const bool is_damped = !structure_.damping.terms.empty() || !structure_.damping.constant.isZero(0.0);
  require(selection_.damping.empty() || is_damped, "outputs.damping: the model has no damper");
}

void ModalModel::name_outputs() {
  is_output_.assign(static_cast<std::size_t>(highest_mode_), false);
  for (const std::vector<int>* modes : {&selection_.frequencies, &selection_.shape_modes, &selection_.damping}) {
    for (const int mode : *modes) is_output_[static_cast<std::size_t>(mode - 1)] = true;
  }
  const std::vector<std::string>& names = structure_.degree_of_freedom_names;
  for (const int mode : selection_.frequencies)
    outputs_.push_back({fmt::format("f{}", mode), selection_.frequency_unit});
  for (const std::string& wanted : selection_.shape_degrees_of_freedom) {
    const auto found = std::find(names.begin(), names.end(), wanted);
    require(found != names.end(), "outputs.shapes.dofs: {}", unknown_name_message("degree of freedom", wanted, names));
    const int row = static_cast<int>(found - names.begin());
    require(std::find(shape_rows_.begin(), shape_rows_.end(), row) == shape_rows_.end(),
            "outputs.shapes.dofs: '{}' stands twice", wanted);
    shape_rows_.push_back(row);
  }
  require(selection_.shape_modes.empty() || !shape_rows_.empty(), "outputs.shapes.dofs: none is named, known: {}",
          join(names));
  for (const int mode : selection_.shape_modes) {
    for (const std::string& name : selection_.shape_degrees_of_freedom) {
      outputs_.push_back({fmt::format("phi{}:{}", mode, name), selection_.shape_unit});
    }
  }
  for (const int mode : selection_.damping) outputs_.push_back({fmt::format("zeta{}", mode), "-"});
}

bool ModalModel::needs_shapes() const {
  return selection_.tracking == ModeTracking::mac || !selection_.shape_modes.empty() || !selection_.damping.empty();
}

int ModalModel::solved_modes() const {
  const int all = static_cast<int>(structure_.stiffness.constant.rows());
  if (!selection_.damping.empty()) return all;
  return selection_.tracking == ModeTracking::mac ? std::min(all, highest_mode_ + k_guard_modes) : highest_mode_;
}

ModeSet ModalModel::modes_at(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  const auto solved = solve_modes(structure_.stiffness.at(parameters), structure_.mass.at(parameters), 0);
  return {solved.values, solved.vectors};
}

std::string ModalModel::match_modes(const ModeSet& modes, std::vector<int>& column_of_mode) const {
  column_of_mode.resize(static_cast<std::size_t>(highest_mode_));
  if (selection_.tracking == ModeTracking::order) {
    for (int mode = 0; mode < highest_mode_; ++mode) column_of_mode[static_cast<std::size_t>(mode)] = mode;
    return {};
  }
  const TrackedModes tracked = track_modes(reference_.shapes.leftCols(highest_mode_), modes.shapes);
  for (std::size_t mode = 0; mode < column_of_mode.size(); ++mode) {
    if (is_output_[mode] && tracked.mac[mode] < selection_.minimum_mac) {
      return fmt::format("mode {} is lost: its best MAC with the reference is {:.2f}", mode + 1, tracked.mac[mode]);
    }
    column_of_mode[mode] = tracked.mode[mode];
  }
  return {};
}

double ModalModel::shape_sign(const ModeSet& modes, int column, int mode) const {
  return modes.shapes.col(column).dot(reference_.shapes.col(mode)) < 0.0 ? -1.0 : 1.0;
}

std::string ModalModel::fill_outputs(const ModeSet& modes, const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                     Eigen::Ref<Eigen::RowVectorXd, 0, Eigen::InnerStride<>> row) const {
  std::vector<int> column_of;
  if (std::string reason = match_modes(modes, column_of); !reason.empty()) return reason;
  const auto column = [&](int mode) { return column_of[static_cast<std::size_t>(mode - 1)]; };
  const double scale = reference_.eigenvalues.cwiseAbs().maxCoeff();
  Eigen::Index output = 0;
  for (const int mode : selection_.frequencies) {
    row(output++) = natural_frequency_hz(modes.eigenvalues(column(mode)), scale);
    if (std::isnan(row(output - 1))) return fmt::format("mode {} is unstable: its eigenvalue is negative", mode);
  }
  for (const int mode : selection_.shape_modes) {
    const double sign = shape_sign(modes, column(mode), mode - 1);
    for (const int degree_of_freedom : shape_rows_)
      row(output++) = sign * modes.shapes(degree_of_freedom, column(mode));
  }
  if (selection_.damping.empty()) return {};
  const Eigen::VectorXd ratios = modal_damping_ratios(modes, structure_.damping.at(parameters));
  for (const int mode : selection_.damping) {
    row(output++) = ratios(column(mode));
    if (std::isnan(row(output - 1))) return fmt::format("mode {} does not oscillate: it is overdamped", mode);
  }
  return {};
}

Evaluation ModalModel::evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext& context) const {
  const BatchModes batch =
      solve_batch(pencils_, coefficients(structure_.stiffness, samples), coefficients(structure_.mass, samples),
                  {.modes = solved_modes(), .vectors = needs_shapes(), .threads = context.threads});
  Evaluation result;
  result.outputs.setConstant(samples.rows(), static_cast<Eigen::Index>(outputs_.size()),
                             std::numeric_limits<double>::quiet_NaN());
  std::vector<std::string> reasons(static_cast<std::size_t>(samples.rows()));
  constexpr std::int64_t k_grain = 256;
  parallel_for(samples.rows(), k_grain, context.threads, [&](std::int64_t begin, std::int64_t end) {
    for (Eigen::Index s = begin; s < end; ++s) {
      std::string& reason = reasons[static_cast<std::size_t>(s)];
      ModeSet modes{batch.values.col(s), {}};
      if (!modes.eigenvalues.allFinite()) {
        reason = "the eigenproblem has no solution: the mass matrix is not positive definite or a value is not finite";
        continue;
      }
      if (!samples.row(s).allFinite()) {
        reason = "a parameter is not finite";
        continue;
      }
      if (needs_shapes()) {
        modes.shapes = batch.sample_vectors(s);
      }
      reason = fill_outputs(modes, samples.row(s).transpose(), result.outputs.row(s));
      if (!reason.empty()) result.outputs.row(s).setConstant(std::numeric_limits<double>::quiet_NaN());
    }
  });
  for (Eigen::Index s = 0; s < samples.rows(); ++s) {
    if (std::string& reason = reasons[static_cast<std::size_t>(s)]; !reason.empty()) {
      result.failures.push_back({s, std::move(reason)});
    }
  }
  return result;
}

Eigen::MatrixXd ModalModel::jacobian(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  const ModeSet modes = modes_at(parameters);
  std::vector<int> column_of;
  if (const std::string reason = match_modes(modes, column_of); !reason.empty()) throw InvalidInput(reason);
  const auto column = [&](int mode) { return column_of[static_cast<std::size_t>(mode - 1)]; };
  const double scale = modes.eigenvalues.cwiseAbs().maxCoeff();
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(outputs_.size()), parameters.size(),
                                                       std::numeric_limits<double>::quiet_NaN());
  for (Eigen::Index i = 0; i < parameters.size(); ++i) {
    const Eigen::MatrixXd dK = structure_.stiffness.derivative(i);
    const Eigen::MatrixXd dM = structure_.mass.derivative(i);
    const Eigen::VectorXd d_lambda = eigenvalue_sensitivity(modes, dK, dM);
    Eigen::Index output = 0;
    for (const int mode : selection_.frequencies) {
      const double frequency = natural_frequency_hz(modes.eigenvalues(column(mode)), scale);
      if (frequency > 0.0) jacobian(output, i) = d_lambda(column(mode)) / (2.0 * k_two_pi * k_two_pi * frequency);
      ++output;
    }
    if (selection_.shape_modes.empty()) continue;
    const Eigen::MatrixXd d_shapes = shape_sensitivity(modes, dK, dM);
    for (const int mode : selection_.shape_modes) {
      const double sign = shape_sign(modes, column(mode), mode - 1);
      for (const int row : shape_rows_) jacobian(output++, i) = sign * d_shapes(row, column(mode));
    }
  }
  return jacobian;
}

}  // namespace mottle
