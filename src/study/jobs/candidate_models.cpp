#include "study/jobs/candidate_models.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace mottle::study {
namespace {

constexpr std::size_t k_max_kept = 3;   // a set of parameters, and the same with one more candidate
constexpr std::size_t k_max_moved = 6;  // candidates of a model that is still cheap

}  // namespace

CandidateModels::CandidateModels(const StructureModel& whole, Eigen::Index given, Eigen::VectorXd nominal, Factory make)
    : whole_(whole), given_(given), nominal_(std::move(nominal)), make_(std::move(make)) {}

std::vector<Eigen::Index> CandidateModels::moved_in(const Eigen::Ref<const Eigen::MatrixXd>& samples) const {
  std::vector<Eigen::Index> moved;
  for (Eigen::Index i = given_; i < samples.cols(); ++i) {
    if ((samples.col(i).array() != nominal_(i)).any()) moved.push_back(i - given_);
  }
  return moved;
}

std::vector<Eigen::Index> CandidateModels::columns_of(const std::vector<Eigen::Index>& candidates) const {
  std::vector<Eigen::Index> columns(static_cast<std::size_t>(given_));
  std::iota(columns.begin(), columns.end(), Eigen::Index{0});
  for (const Eigen::Index candidate : candidates) columns.push_back(given_ + candidate);
  return columns;
}

std::shared_ptr<const CandidateModels::Made> CandidateModels::model_of(
    const std::vector<Eigen::Index>& candidates) const {
  const std::lock_guard lock(mutex_);
  const auto found =
      std::find_if(made_.begin(), made_.end(), [&](const auto& made) { return made->candidates == candidates; });
  std::shared_ptr<const Made> made;
  if (found != made_.end()) {
    made = *found;
    made_.erase(found);
  } else {
    made = std::make_shared<const Made>(Made{candidates, make_(candidates)});
  }
  made_.push_front(made);
  if (made_.size() > k_max_kept) made_.pop_back();
  return made;
}

Evaluation CandidateModels::evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples,
                                     const RunContext& context) const {
  const std::vector<Eigen::Index> moved = moved_in(samples);
  if (moved.size() > k_max_moved) return whole_.evaluate(samples, context);
  return model_of(moved)->model.model->evaluate(samples(Eigen::all, columns_of(moved)), context);
}

Eigen::MatrixXd CandidateModels::jacobian(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  const std::vector<Eigen::Index> moved = moved_in(parameters.transpose());
  if (moved.empty() || moved.size() > k_max_moved) return whole_.jacobian(parameters);
  const std::vector<Eigen::Index> columns = columns_of(moved);
  Eigen::MatrixXd all = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(outputs().size()), parameters.size(),
                                                  std::numeric_limits<double>::quiet_NaN());
  all(Eigen::all, columns) = model_of(moved)->model.model->jacobian(parameters(columns));
  return all;
}

}  // namespace mottle::study
