#include "mottle/model/structure_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/batch_record.hpp"
#include "model/responses/response.hpp"
#include "model/row_exchange.hpp"
#include "mottle/core/subject.hpp"
#include "mottle/core/text.hpp"
#include "mottle/core/work_counter.hpp"
#include "mottle/dynamics/modes/tracking.hpp"
#include "mottle/model/solvers/dense_solver.hpp"

namespace mottle::model {
namespace {

constexpr int k_guard_modes = 4;  // tracking must see a mode that left the band of wanted ones

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

}  // namespace

/// A response with its share of the outputs and of the request.
struct StructureModel::Part {
  std::unique_ptr<Response> response;
  ResponseShare share;
  Eigen::Index outputs = 0, measured = 0;
};

StructureModel::StructureModel(AffineStructure structure, OutputSelection selection, const Eigen::VectorXd& reference)
    : StructureModel(std::make_unique<DenseSolver>(DenseStructure(std::move(structure), reference.size())),
                     std::move(selection), reference) {}

StructureModel::StructureModel(std::unique_ptr<Solver> solver, OutputSelection selection,
                               const Eigen::VectorXd& reference)
    : solver_(std::move(solver)), selection_(std::move(selection)), reference_parameters_(reference) {
  std::vector<int> degrees_of_freedom;
  for (auto& response : make_responses(selection_, structure())) take(std::move(response), degrees_of_freedom);
  complete_request(degrees_of_freedom);
  solve_reference();
  take_outputs();
  if (compares_) request_.reference = numbered_modes();
}

StructureModel::StructureModel(StructureModel&&) noexcept = default;
StructureModel::~StructureModel() = default;

/// What it needs goes behind that of the responses before it.
void StructureModel::take(std::unique_ptr<Response> response, std::vector<int>& degrees_of_freedom) {
  const ResponseNeeds needs = response->needs();
  for (const int mode : needs.modes) {
    is_output_.resize(std::max(is_output_.size(), static_cast<std::size_t>(mode)));
    is_output_[static_cast<std::size_t>(mode - 1)] = true;
  }
  const ResponseShare share{.first_row = static_cast<Eigen::Index>(degrees_of_freedom.size()),
                            .rows = static_cast<Eigen::Index>(needs.degrees_of_freedom.size()),
                            .first_load = request_.loads.cols()};
  degrees_of_freedom.insert(degrees_of_freedom.end(), needs.degrees_of_freedom.begin(), needs.degrees_of_freedom.end());
  if (needs.loads.cols() > 0) {
    request_.loads.conservativeResize(needs.loads.rows(), share.first_load + needs.loads.cols());
    request_.loads.rightCols(needs.loads.cols()) = needs.loads;
  }
  request_.damping = request_.damping || needs.damping;
  compares_ = compares_ || needs.shapes;
  responses_.push_back({.response = std::move(response), .share = share});
}

void StructureModel::take_outputs() {
  Eigen::MatrixXd shapes(request_.observation.rows(), highest_mode());
  if (shapes.size() > 0) shapes = request_.observation * reference_.shapes.leftCols(highest_mode());
  for (Part& part : responses_) {
    part.response->take_reference(shapes.middleRows(part.share.first_row, part.share.rows));
    const std::vector<Quantity> outputs = part.response->quantities();
    const std::vector<Quantity> measured = part.response->measured();
    part.outputs = static_cast<Eigen::Index>(outputs.size());
    part.measured = static_cast<Eigen::Index>(measured.size());
    outputs_.insert(outputs_.end(), outputs.begin(), outputs.end());
    measured_.insert(measured_.end(), measured.begin(), measured.end());
  }
}

Eigen::MatrixXd StructureModel::outputs_of(const Eigen::Ref<const Eigen::MatrixXd>& measured) const {
  Eigen::MatrixXd outputs(measured.rows(), static_cast<Eigen::Index>(outputs_.size()));
  for (Eigen::Index s = 0; s < measured.rows(); ++s) {
    Eigen::Index from = 0;
    Eigen::Index to = 0;
    for (const Part& part : responses_) {
      outputs.row(s).segment(to, part.outputs) =
          part.response->outputs_of(measured.row(s).segment(from, part.measured));
      from += part.measured;
      to += part.outputs;
    }
  }
  return outputs;
}

void StructureModel::complete_request(const std::vector<int>& degrees_of_freedom) {
  request_.observation = structure().observation(degrees_of_freedom);
  if (highest_mode() == 0) return;
  const int all = static_cast<int>(structure().mode_count());
  const bool is_tracked = selection_.tracking == ModeTracking::mac;
  compares_ = compares_ || is_tracked;
  request_.modes = is_tracked ? std::min(all, highest_mode() + k_guard_modes) : highest_mode();
  if (request_.damping) request_.modes = solver_->modes_for_damping(highest_mode());
}

ModeSet StructureModel::sound_modes_at(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  ModeSet modes = solver_->modes_at(parameters, request_.modes);
  const Eigen::VectorXd& values = modes.eigenvalues;
  if (values.size() >= highest_mode() && !values.allFinite()) {
    solver_->solve(parameters.transpose(), {.modes = request_.modes}, {},
                   [](Eigen::Index, const Solution&, const std::string& failure) {
                     require_of(failure.empty(), {Subject::Kind::model}, "it has no modes at the parameters' means: {}",
                                failure);
                   });
  }
  require_of(values.size() >= highest_mode() && values.allFinite(), {Subject::Kind::model},
             "it has no modes at the parameters' means: the mass matrix is not positive definite there");
  require_of(
      !std::isnan(natural_frequency_hz(values(0), scale_of(modes, parameters))), {Subject::Kind::model},
      "it is unstable at the parameters' means, its lowest eigenvalue is {:.6g}; a stiffness is negative, or a preload "
      "makes it buckle",
      values(0));
  return modes;
}

/// Scale for natural_frequency_hz(): the largest eigenvalue, or more where the lowest may be what rounding leaves of a
/// rigid-body motion, of a size that has nothing to do with the modes that are asked for.
double StructureModel::scale_of(const ModeSet& modes, const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  constexpr double k_rigid = 1e-6;
  const double largest = modes.eigenvalues.cwiseAbs().maxCoeff();
  const Eigen::Index rigid = (modes.eigenvalues.array() <= k_rigid * largest).count();
  if (rigid == 0 || modes.shapes.cols() < rigid) return largest;
  const ModeSet lowest{modes.eigenvalues.head(rigid), modes.shapes.leftCols(rigid)};
  return std::max(largest, solver_->eigenvalue_rounding(parameters, lowest) / k_eigenvalue_rounding);
}

void StructureModel::require_statics_at(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  if (request_.loads.cols() == 0) return;
  const SolutionRequest statics{.observation = request_.observation, .loads = request_.loads};
  solver_->solve(parameters.transpose(), statics, {}, [](Eigen::Index, const Solution&, const std::string& failure) {
    require_of(failure.empty(), {Subject::Kind::model},
               "it has no static solution under the outputs' loads at the parameters' means: {}", failure);
  });
}

void StructureModel::solve_reference() {
  require_statics_at(reference_parameters_);
  if (highest_mode() == 0) return;
  reference_ = sound_modes_at(reference_parameters_);
  largest_eigenvalue_ = scale_of(reference_, reference_parameters_);
}

void StructureModel::require_solution_at(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  if (parameters == reference_parameters_) return;
  require_statics_at(parameters);
  if (highest_mode() > 0) sound_modes_at(parameters);
}

ModeMatch StructureModel::match_modes(Eigen::Index found, const Eigen::MatrixXd& cosines) const {
  ModeMatch match;
  match.sign.assign(static_cast<std::size_t>(highest_mode()), 1.0);
  for (int mode = 0; mode < highest_mode(); ++mode) match.column.push_back(mode);
  if (found < highest_mode()) {
    match.failure = fmt::format("only {} modes were found, {} are needed", found, highest_mode());
    return match;
  }
  if (cosines.size() == 0) return match;
  if (selection_.tracking == ModeTracking::mac) {
    const TrackedModes tracked = track_modes(cosines, selection_.minimum_mac);
    match.column = tracked.mode;
    for (int mode = 0; mode < highest_mode() && match.failure.empty(); ++mode) {
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

std::string StructureModel::fill_outputs(const Solution& solution, const ModeMatch& match,
                                         Eigen::Ref<Eigen::RowVectorXd, 0, Eigen::InnerStride<>> row) const {
  Eigen::Index output = 0;
  for (const Part& part : responses_) {
    const NumberedSolution numbered(solution, match, part.share, largest_eigenvalue_);
    if (std::string reason = part.response->fill(numbered, row.segment(output, part.outputs)); !reason.empty()) {
      return reason;
    }
    output += part.outputs;
  }
  return {};
}

Evaluation StructureModel::evaluate(const SampleRegion* region, const Eigen::Ref<const Eigen::MatrixXd>& samples,
                                    const RunContext& context) const {
  BatchRecord batch(samples.rows(), static_cast<Eigen::Index>(outputs_.size()));
  WorkCounter runs(context, "model runs", samples.rows());
  const auto visit = [&](Eigen::Index s, const Solution& solution, const std::string& failure) {
    runs.add();
    batch.is_own[static_cast<std::size_t>(s)] = 1;
    std::string reason = samples.row(s).allFinite() ? failure : "a parameter is not finite";
    if (!reason.empty()) return batch.say(s, std::move(reason), {});
    ModeMatch match = match_modes(solution.eigenvalues.size(), solution.cosines);
    reason = match.failure;
    if (reason.empty()) reason = fill_outputs(solution, match, batch.values.row(s));
    if (!reason.empty()) batch.values.row(s).setConstant(std::numeric_limits<double>::quiet_NaN());
    batch.say(s, std::move(reason), std::move(match.note));
  };
  SolutionRequest request = request_;
  request.region = region;
  if (selection_.tracking == ModeTracking::mac && !request.damping) {
    request.certain = highest_mode();
    request.keeps_to_certain = [this](const Eigen::MatrixXd& cosines) {
      const ModeMatch match = match_modes(cosines.cols(), cosines);
      return match.failure.empty() && std::ranges::all_of(match.column, [&](int k) { return k < highest_mode(); });
    };
  }
  if (context.share != nullptr) context.share->count_with(&runs);
  const SolverUse use = solver_->solve(samples, request, context, visit);
  if (context.share != nullptr && context.share->is_shared()) {
    batch.put_together(context.share->ranks(), digest_of_matrices({reference_.eigenvalues, reference_.shapes}));
  }
  Evaluation result = std::move(batch).evaluation();
  result.use = use;
  return result;
}

ModeSet StructureModel::numbered_modes() const {
  return {reference_.eigenvalues.head(highest_mode()), reference_.shapes.leftCols(highest_mode())};
}

ModeMatch StructureModel::match_all(const ModeSet& modes) const {
  if (!compares_) return match_modes(modes.eigenvalues.size(), {});
  return match_modes(modes.eigenvalues.size(), solver_->cosines(numbered_modes(), modes));
}

StructureModel::FollowedModes StructureModel::follow(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  const ModeSet modes = solver_->modes_at(parameters, request_.modes);
  const ModeMatch match = match_all(modes);
  if (!match.failure.empty()) throw InvalidInput(match.failure);
  FollowedModes followed{{modes.eigenvalues(match.column), modes.shapes(Eigen::all, match.column)}, match.column, {}};
  const Eigen::MatrixXd cosines = solver_->cosines(numbered_modes(), followed.modes);
  for (Eigen::Index k = 0; k < highest_mode(); ++k) followed.mac.push_back(cosines(k, k) * cosines(k, k));
  return followed;
}

Eigen::MatrixXd StructureModel::reference_displacements() const {
  std::vector<int> degrees_of_freedom;
  for (const std::string& name : selection_.shape_degrees_of_freedom) {
    degrees_of_freedom.push_back(structure().find_degree_of_freedom(name));
  }
  return structure().displacements(reference_.shapes.leftCols(highest_mode()), degrees_of_freedom);
}

Eigen::MatrixXd StructureModel::jacobian(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  const Eigen::VectorXd point = parameters;
  ModeSet modes;
  if (request_.modes > 0) modes = solver_->modes_at(point, request_.modes);
  const ModeMatch match = match_all(modes);
  if (!match.failure.empty()) throw InvalidInput(match.failure);
  Eigen::MatrixXd d_lambda;
  if (request_.modes > 0) d_lambda = solver_->eigenvalue_derivatives(point, modes);
  const SolvedPoint solved{*solver_, point, modes, match, d_lambda};
  Eigen::MatrixXd jacobian(static_cast<Eigen::Index>(outputs_.size()), point.size());
  Eigen::Index first = 0;
  for (const Part& part : responses_) {
    jacobian.middleRows(first, part.outputs) = part.response->derivatives(solved);
    first += part.outputs;
  }
  return jacobian;
}

}  // namespace mottle::model
