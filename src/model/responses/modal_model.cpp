#include "mottle/model/responses/modal_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/dynamics/modes/tracking.hpp"
#include "mottle/model/structures/dense_structure.hpp"

namespace mottle {
namespace {

constexpr int k_guard_modes = 4;  // tracking must see a mode that left the band of wanted ones
constexpr double k_two_pi = 2.0 * std::numbers::pi;

void require_modes(const std::vector<int>& modes, const std::string& key, Eigen::Index available) {
  std::set<int> seen;
  for (const int mode : modes) {
    require(mode >= 1 && mode <= available, "outputs.{}: mode {} is not there, the model has modes 1 to {}", key, mode,
            available);
    require(seen.insert(mode).second, "outputs.{}: mode {} stands twice", key, mode);
  }
}

/// "modes 7 and 8 crossed; modes 19, 20 mixed", of those that are outputs.
std::string tracking_note(const TrackedModes& tracked, const std::vector<bool>& is_output) {
  std::vector<std::string> parts;
  for (const auto& [i, j] : tracked.crossed) {
    if (!is_output[static_cast<std::size_t>(i)] && !is_output[static_cast<std::size_t>(j)]) continue;
    parts.push_back(fmt::format("modes {} and {} crossed", i + 1, j + 1));
  }
  for (const std::vector<int>& group : tracked.mixed) {
    std::vector<std::string> names;
    for (const int mode : group) names.push_back(fmt::format("{}", mode + 1));
    parts.push_back(fmt::format("modes {} mixed", join(names)));
  }
  return join(parts, "; ");
}

/// Whether a degree of freedom, by the names that all formats have in common, is a rotation: "101:+RX".
bool is_rotation(const std::string& degree_of_freedom) {
  const std::size_t colon = degree_of_freedom.rfind(':');
  return colon != std::string::npos && degree_of_freedom.size() == colon + 4 && degree_of_freedom[colon + 2] == 'R';
}

int largest(const std::vector<int>& modes) {
  return modes.empty() ? 0 : *std::max_element(modes.begin(), modes.end());
}

}  // namespace

/// Which column of a sample is which mode, and how its shape is turned.
struct ModalModel::Match {
  std::vector<int> column;   ///< by mode
  std::vector<double> sign;  ///< by mode, of its shape against the reference's
  std::string failure;
  std::string note;
};

ModalModel::ModalModel(AffineStructure structure, ModalOutputs selection, const Eigen::VectorXd& reference)
    : ModalModel(std::make_unique<DenseStructure>(std::move(structure), reference.size()), std::move(selection),
                 reference) {}

ModalModel::ModalModel(std::unique_ptr<ModalStructure> structure, ModalOutputs selection,
                       const Eigen::VectorXd& reference)
    : structure_(std::move(structure)), selection_(std::move(selection)), reference_parameters_(reference) {
  check_selection();
  highest_mode_ =
      std::max({largest(selection_.frequencies), largest(selection_.shape_modes), largest(selection_.damping)});
  reference_ = structure_->modes_at(reference, solved_modes());
  require(reference_.eigenvalues.size() >= highest_mode_ && reference_.eigenvalues.allFinite(),
          "model: it has no modes at the parameters' means: the mass matrix is not positive definite there");
  const double scale = reference_.eigenvalues.cwiseAbs().maxCoeff();
  require(
      !std::isnan(natural_frequency_hz(reference_.eigenvalues(0), scale)),
      "model: it is unstable at the parameters' means, its lowest eigenvalue is {:.6g}; a stiffness must be negative",
      reference_.eigenvalues(0));
  name_outputs();
}

void ModalModel::check_selection() const {
  const Eigen::Index available = structure_->mode_count();
  require_modes(selection_.frequencies, "frequencies", available);
  require_modes(selection_.shape_modes, "shapes.modes", available);
  require_modes(selection_.damping, "damping", available);
  require(!selection_.frequencies.empty() || !selection_.shape_modes.empty() || !selection_.damping.empty(),
          "outputs: none is named; give for example frequencies = [1, 2]");
  require(selection_.damping.empty() || structure_->is_damped(), "outputs.damping: the model has no damper");
}

void ModalModel::name_outputs() {
  is_output_.assign(static_cast<std::size_t>(highest_mode_), false);
  for (const std::vector<int>* modes : {&selection_.frequencies, &selection_.shape_modes, &selection_.damping}) {
    for (const int mode : *modes) is_output_[static_cast<std::size_t>(mode - 1)] = true;
  }
  for (const int mode : selection_.frequencies) outputs_.push_back(frequency_output(mode, selection_.frequency_unit));
  for (const std::string& wanted : selection_.shape_degrees_of_freedom) {
    const int row = structure_->find_degree_of_freedom(wanted);
    if (row < 0) {
      throw InvalidInput(fmt::format("outputs.shapes.dofs: {}", structure_->unknown_degree_of_freedom(wanted)));
    }
    require(std::find(shape_rows_.begin(), shape_rows_.end(), row) == shape_rows_.end(),
            "outputs.shapes.dofs: '{}' stands twice", wanted);
    shape_rows_.push_back(row);
  }
  require(selection_.shape_modes.empty() || !shape_rows_.empty(), "outputs.shapes.dofs: {}",
          structure_->unknown_degree_of_freedom(""));
  for (const int mode : selection_.shape_modes) {
    for (const std::string& name : selection_.shape_degrees_of_freedom) {
      const OutputKind kind = is_rotation(name) ? OutputKind::rotation : OutputKind::displacement;
      outputs_.push_back(shape_output(mode, name, kind, selection_.shape_unit));
    }
  }
  for (const int mode : selection_.damping) outputs_.push_back(damping_output(mode));
}

bool ModalModel::needs_shapes() const {
  return selection_.tracking == ModeTracking::mac || !selection_.shape_modes.empty() || !selection_.damping.empty();
}

int ModalModel::solved_modes() const {
  const int all = static_cast<int>(structure_->mode_count());
  if (!selection_.damping.empty()) return structure_->modes_for_damping(highest_mode_);
  return selection_.tracking == ModeTracking::mac ? std::min(all, highest_mode_ + k_guard_modes) : highest_mode_;
}

ModalModel::Match ModalModel::match_modes(Eigen::Index found, const Eigen::MatrixXd& cosines) const {
  Match match;
  match.sign.assign(static_cast<std::size_t>(highest_mode_), 1.0);
  for (int mode = 0; mode < highest_mode_; ++mode) match.column.push_back(mode);
  if (found < highest_mode_) {
    match.failure = fmt::format("only {} modes were found, {} are needed", found, highest_mode_);
    return match;
  }
  if (cosines.size() == 0) return match;
  if (selection_.tracking == ModeTracking::mac) {
    const TrackedModes tracked = track_modes(cosines, selection_.minimum_mac);
    match.column = tracked.mode;
    for (int mode = 0; mode < highest_mode_ && match.failure.empty(); ++mode) {
      const auto k = static_cast<std::size_t>(mode);
      if (!is_output_[k] || tracked.subspace_mac[k] >= selection_.minimum_mac) continue;
      match.failure =
          fmt::format("mode {} is lost: its best MAC with the reference is {:.2f}", mode + 1, tracked.mac[k]);
    }
    match.note = tracking_note(tracked, is_output_);
  }
  for (std::size_t mode = 0; mode < match.column.size(); ++mode) {
    if (cosines(static_cast<Eigen::Index>(mode), match.column[mode]) < 0.0) match.sign[mode] = -1.0;
  }
  return match;
}

std::string ModalModel::fill_outputs(const ObservedModes& modes, const Match& match,
                                     Eigen::Ref<Eigen::RowVectorXd, 0, Eigen::InnerStride<>> row) const {
  const auto column = [&](int mode) { return match.column[static_cast<std::size_t>(mode - 1)]; };
  const double scale = reference_.eigenvalues.cwiseAbs().maxCoeff();
  Eigen::Index output = 0;
  for (const int mode : selection_.frequencies) {
    row(output++) = natural_frequency_hz(modes.eigenvalues(column(mode)), scale);
    if (std::isnan(row(output - 1))) return fmt::format("mode {} is unstable: its eigenvalue is negative", mode);
  }
  for (const int mode : selection_.shape_modes) {
    const double sign = match.sign[static_cast<std::size_t>(mode - 1)];
    for (const double component : modes.displacements.col(column(mode))) row(output++) = sign * component;
  }
  for (const int mode : selection_.damping) {
    row(output++) = modes.damping_ratios(column(mode));
    if (std::isnan(row(output - 1))) return fmt::format("mode {} does not oscillate: it is overdamped", mode);
  }
  return {};
}

Evaluation ModalModel::evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext& context) const {
  Evaluation result;
  result.outputs.setConstant(samples.rows(), static_cast<Eigen::Index>(outputs_.size()),
                             std::numeric_limits<double>::quiet_NaN());
  std::vector<std::string> reasons(static_cast<std::size_t>(samples.rows()));
  std::vector<std::string> notes(reasons.size());
  const auto visit = [&](Eigen::Index s, const ObservedModes& modes, const std::string& failure) {
    std::string& reason = reasons[static_cast<std::size_t>(s)];
    reason = samples.row(s).allFinite() ? failure : "a parameter is not finite";
    if (!reason.empty()) return;
    Match match = match_modes(modes.eigenvalues.size(), modes.cosines);
    reason = match.failure;
    if (reason.empty()) reason = fill_outputs(modes, match, result.outputs.row(s));
    if (!reason.empty()) result.outputs.row(s).setConstant(std::numeric_limits<double>::quiet_NaN());
    notes[static_cast<std::size_t>(s)] = std::move(match.note);
  };
  result.use = structure_->solve(samples, solved_modes(), observation(), context, visit);
  for (Eigen::Index s = 0; s < samples.rows(); ++s) {
    const auto k = static_cast<std::size_t>(s);
    if (!reasons[k].empty()) {
      result.failures.push_back({s, std::move(reasons[k])});
    } else if (!notes[k].empty()) {
      result.notes.push_back({s, std::move(notes[k])});
    }
  }
  return result;
}

ModalObservation ModalModel::observation() const {
  if (!needs_shapes()) return {};
  return {numbered_modes(), shape_rows_, !selection_.damping.empty()};
}

ModeSet ModalModel::numbered_modes() const {
  return {reference_.eigenvalues.head(highest_mode_), reference_.shapes.leftCols(highest_mode_)};
}

ModalModel::Match ModalModel::match_all(const ModeSet& modes) const {
  if (!needs_shapes()) return match_modes(modes.eigenvalues.size(), {});
  return match_modes(modes.eigenvalues.size(), structure_->cosines(numbered_modes(), modes));
}

ModalModel::FollowedModes ModalModel::follow(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  const ModeSet modes = structure_->modes_at(parameters, solved_modes());
  const Match match = match_all(modes);
  if (!match.failure.empty()) throw InvalidInput(match.failure);
  FollowedModes followed{{modes.eigenvalues(match.column), modes.shapes(Eigen::all, match.column)}, match.column, {}};
  const Eigen::MatrixXd cosines = structure_->cosines(numbered_modes(), followed.modes);
  for (Eigen::Index k = 0; k < highest_mode_; ++k) followed.mac.push_back(cosines(k, k) * cosines(k, k));
  return followed;
}

Eigen::MatrixXd ModalModel::reference_displacements() const {
  return structure_->displacements(reference_.shapes.leftCols(highest_mode_), shape_rows_);
}

Eigen::MatrixXd ModalModel::jacobian(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  const ModeSet modes = structure_->modes_at(parameters, solved_modes());
  const Match match = match_all(modes);
  if (!match.failure.empty()) throw InvalidInput(match.failure);
  const auto column = [&](int mode) { return match.column[static_cast<std::size_t>(mode - 1)]; };
  const double scale = modes.eigenvalues.cwiseAbs().maxCoeff();
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(outputs_.size()), parameters.size(),
                                                       std::numeric_limits<double>::quiet_NaN());
  const Eigen::MatrixXd d_lambda = structure_->eigenvalue_derivatives(parameters, modes);
  Eigen::Index output = 0;
  for (const int mode : selection_.frequencies) {
    const double frequency = natural_frequency_hz(modes.eigenvalues(column(mode)), scale);
    if (frequency > 0.0) jacobian.row(output) = d_lambda.row(column(mode)) / (2.0 * k_two_pi * k_two_pi * frequency);
    ++output;
  }
  for (const int mode : selection_.shape_modes) {
    const Eigen::MatrixXd d_shape = structure_->shape_derivatives(parameters, modes, column(mode));
    const auto rows = static_cast<Eigen::Index>(shape_rows_.size());
    jacobian.middleRows(output, rows) =
        match.sign[static_cast<std::size_t>(mode - 1)] * structure_->displacements(d_shape, shape_rows_);
    output += rows;
  }
  return jacobian;
}

}  // namespace mottle
