#include "study/jobs/candidate_models.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mottle/core/text.hpp"

namespace mottle::study {
namespace {

constexpr std::size_t k_max_kept = 6;   // a set of parameters, and the same with one more candidate here and there
constexpr std::size_t k_max_moved = 6;  // candidates of a model that is still cheap

/// Without the notes of each batch, which would be hundreds.
class WithoutNotes final : public ProgressObserver {
 public:
  explicit WithoutNotes(ProgressObserver& next) : next_(next) {}

  void phase(const Phase& next) override { next_.phase(next); }
  void progress(const std::string& work, std::int64_t done, std::int64_t total) override {
    next_.progress(work, done, total);
  }
  void warning(const std::string& text) override { next_.warning(text); }
  void note(const std::string& /*text*/) override {}
  void finding(const std::string& text) override { next_.finding(text); }

 private:
  ProgressObserver& next_;
};

}  // namespace

CandidateModels::CandidateModels(const StructureModel& whole, Eigen::Index given, const ParameterSpace& space,
                                 Factory make)
    : whole_(whole), given_(given), space_(space), nominal_(space.prior().mean()), make_(std::move(make)) {}

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

Eigen::VectorXd CandidateModels::centre_of(const std::vector<Eigen::Index>& candidates,
                                           const Eigen::MatrixXd& samples) const {
  constexpr double k_apart = 3.0;  // prior standard deviations from one centre to the next
  const std::vector<Eigen::Index> columns = columns_of(candidates);
  Eigen::VectorXd all = nominal_;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const Eigen::Index i = given_ + candidates[k];
    const double step = k_apart * std::sqrt(space_.prior().covariance()(i, i));
    const double shift = samples.col(given_ + static_cast<Eigen::Index>(k)).mean() - nominal_(i);
    all(i) += step * std::round(shift / step);
  }
  if (!all.allFinite() || !space_.is_possible(all)) all = nominal_;
  return all(columns);
}

std::shared_ptr<const CandidateModels::Made> CandidateModels::model_of(const std::vector<Eigen::Index>& candidates,
                                                                       const Eigen::MatrixXd& samples) const {
  const Eigen::VectorXd centre = centre_of(candidates, samples);
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(made_.begin(), made_.end(), [&](const auto& made) {
    return made->candidates == candidates && made->centre == centre;
  });
  std::shared_ptr<const Made> made;
  if (found != made_.end()) {
    made = *found;
    made_.erase(found);
  } else {
    made = std::make_shared<const Made>(Made{candidates, centre, make_(candidates, centre)});
  }
  made_.push_front(made);
  if (made_.size() > k_max_kept) made_.pop_back();
  return made;
}

Evaluation CandidateModels::evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples,
                                     const RunContext& context) const {
  const std::vector<Eigen::Index> moved = moved_in(samples);
  if (moved.size() > k_max_moved) return whole_.evaluate(samples, context);
  const Eigen::MatrixXd own = samples(Eigen::all, columns_of(moved));
  if (context.observer == nullptr) return model_of(moved, own)->model.model->evaluate(own, context);
  WithoutNotes observer(*context.observer);
  RunContext quiet = context;
  quiet.observer = &observer;
  Evaluation evaluation = model_of(moved, own)->model.model->evaluate(own, quiet);
  note_full_solutions(moved, evaluation.use.exact, own.rows(), context);
  return evaluation;
}

void CandidateModels::note_full_solutions(const std::vector<Eigen::Index>& candidates, std::int64_t full,
                                          Eigen::Index samples, const RunContext& context) const {
  constexpr Eigen::Index k_cloud = 10;  // fewer may be solved in full anyway
  if (samples < k_cloud || 4 * full <= samples) return;
  {
    const std::lock_guard lock(mutex_);
    if (!noted_.insert(candidates).second) return;
  }
  std::vector<std::string> names;
  for (const Eigen::Index i : candidates) {
    names.push_back(space_.parameters()[static_cast<std::size_t>(given_ + i)].name);
  }
  context.note(
      fmt::format("Fits with {} are slow: more than a fourth of their samples are solved in full, since their values "
                  "are too far from "
                  "those that a reduced model was trained on, or a matrix that they multiply is not proven to be "
                  "positive semidefinite.",
                  names.empty() ? "the given parameters" : join(names)));
}

}  // namespace mottle::study
