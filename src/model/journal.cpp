#include "mottle/model/journal.hpp"

#include <algorithm>
#include <optional>

#include "model/journal_file.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/gather_alike.hpp"
#include "mottle/core/rank_share.hpp"
#include "mottle/model/ranked_model.hpp"
#include "mottle/model/sample_region.hpp"

namespace mottle::model {

JournalledModel::JournalledModel(const Model& model, std::filesystem::path file, const Digest& fingerprint, bool resume,
                                 Ranks* ranks)
    : model_(model),
      fingerprint_(fingerprint),
      file_(file.empty() ? nullptr : std::make_unique<JournalFile>(std::move(file), fingerprint, resume)),
      ranks_(ranks) {}

JournalledModel::~JournalledModel() = default;

Eigen::MatrixXd JournalledModel::jacobian_of(const DifferentiableModel& derivatives,
                                             const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  if (!file_) return derivatives.jacobian(parameters);
  const Digest point = digest_of_samples(nullptr, parameters.transpose());
  if (std::optional<Eigen::MatrixXd> kept = file_->find_derivatives(point)) return *std::move(kept);
  Eigen::MatrixXd jacobian = derivatives.jacobian(parameters);
  file_->keep_derivatives(point, jacobian);
  return jacobian;
}

std::int64_t JournalledModel::reused() const {
  return file_ ? file_->reused() : 0;
}

Evaluation JournalledModel::compute(const SampleRegion* region, const Eigen::Ref<const Eigen::MatrixXd>& samples,
                                    const RunContext& context) const {
  return region == nullptr ? model_.evaluate(samples, context) : model_.evaluate_in(*region, samples, context);
}

Evaluation JournalledModel::answer_to(const SampleRegion* region, const Eigen::Ref<const Eigen::MatrixXd>& samples,
                                      const RunContext& context) const {
  const bool is_shared = ranks_ != nullptr && ranks_->is_together();
  if (!file_ && !is_shared) return compute(region, samples, context);
  const Digest question = digest_of_samples(region, samples);
  Evaluation answer;
  bool is_known = file_ && file_->find(question, samples.rows(), static_cast<Eigen::Index>(outputs().size()), answer);
  if (is_shared) is_known = ask_first_rank(question, samples.rows(), is_known, answer);
  if (is_known) return answer;
  RunContext shared = context;
  std::optional<RankShare> share;
  if (is_shared) shared.share = &share.emplace(*ranks_);
  answer = compute(region, samples, shared);
  if (file_) file_->keep(question, answer);
  return answer;
}

/// The ranks make sure that they ask the same, and get the answer that the first one has in its journal, if there is
/// one.
bool JournalledModel::ask_first_rank(const Digest& question, Eigen::Index rows, bool is_known,
                                     Evaluation& answer) const {
  const std::string own = is_known && ranks_->is_first() ? encode(question, answer) : "";
  const std::vector<std::string> all =
      gather_alike(*ranks_, {{fingerprint_, "the study's files"}, {question, "the samples of a batch"}}, own);
  const std::string& record = all.front();
  if (record.empty()) return false;
  if (!decode(record, question, rows, static_cast<Eigen::Index>(outputs().size()), answer)) {
    throw SystemFailure("the first rank's answer from its journal cannot be read");
  }
  return true;
}

Evaluation JournalledModel::evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples,
                                     const RunContext& context) const {
  return evaluate_parts(nullptr, samples, context);
}

Evaluation JournalledModel::evaluate_in(const SampleRegion& region, const Eigen::Ref<const Eigen::MatrixXd>& samples,
                                        const RunContext& context) const {
  return evaluate_parts(&region, samples, context);
}

Evaluation JournalledModel::evaluate_parts(const SampleRegion* region, const Eigen::Ref<const Eigen::MatrixXd>& samples,
                                           const RunContext& context) const {
  if (0 < samples.rows() && samples.rows() <= model_.batch_size()) {  // no copies of what may be large
    context.throw_if_stopped();
    Evaluation answer = answer_to(region, samples, context);
    use_ += answer.use;
    return answer;
  }
  Evaluation whole;
  whole.outputs.resize(samples.rows(), static_cast<Eigen::Index>(outputs().size()));
  for (Eigen::Index begin = 0; begin < samples.rows(); begin += model_.batch_size()) {
    context.throw_if_stopped();
    const Eigen::MatrixXd part = samples.middleRows(begin, std::min(model_.batch_size(), samples.rows() - begin));
    Evaluation answer = answer_to(region, part, context);
    whole.outputs.middleRows(begin, part.rows()) = answer.outputs;
    for (FailedRun& failure : answer.failures) {
      whole.failures.push_back({begin + failure.sample, std::move(failure.reason)});
    }
    for (SampleNote& note : answer.notes) whole.notes.push_back({begin + note.sample, std::move(note.text)});
    whole.use += answer.use;
  }
  use_ += whole.use;
  return whole;
}

}  // namespace mottle::model
