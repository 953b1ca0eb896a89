#include "mottle/model/journal.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <optional>
#include <string_view>

#include "mottle/core/bytes.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/gather_alike.hpp"
#include "mottle/core/own_file.hpp"
#include "mottle/core/rank_share.hpp"
#include "mottle/model/ranked_model.hpp"
#include "mottle/model/sample_region.hpp"

namespace mottle::model {
namespace {

constexpr std::string_view k_magic = "mottle journal 6\n";
static_assert(k_magic.starts_with(k_journal_magic));

void append_remark(std::string& body, Eigen::Index sample, const std::string& text) {
  append_value(body, std::int64_t{sample});
  append_text(body, text);
}

std::string encode(const Digest& question, const Evaluation& evaluation) {
  std::string body;
  append_value(body, question);
  append_value(body, std::int64_t{evaluation.outputs.rows()});
  append_bytes(body, evaluation.outputs.data(), static_cast<std::size_t>(evaluation.outputs.size()) * sizeof(double));
  append_value(body, static_cast<std::int64_t>(evaluation.failures.size()));
  for (const FailedRun& failure : evaluation.failures) append_remark(body, failure.sample, failure.reason);
  append_value(body, static_cast<std::int64_t>(evaluation.notes.size()));
  for (const SampleNote& note : evaluation.notes) append_remark(body, note.sample, note.text);
  append_value(body, evaluation.use);
  return body;
}

std::string record_of(const std::string& body) {
  std::string record;
  append_value(record, static_cast<std::uint64_t>(body.size()));
  append_value(record, digest_of(body));
  return record + body;
}

/// A list of (sample, text); false where the record ends too early.
template <typename Remark>
bool read_remarks(ByteReader& reader, std::vector<Remark>& remarks) {
  std::int64_t count = 0;
  if (!reader.read(count)) return false;
  for (std::int64_t i = 0; i < count; ++i) {
    std::int64_t sample = 0;
    std::string text;
    if (!reader.read(sample) || !reader.read_text(text)) return false;
    remarks.push_back({sample, std::move(text)});
  }
  return true;
}

bool decode(std::string_view body, const Digest& question, Eigen::Index rows, Eigen::Index outputs,
            Evaluation& result) {
  ByteReader reader(body);
  Digest asked = {};
  std::int64_t stored_rows = 0;
  if (!reader.read(asked) || asked != question || !reader.read(stored_rows) || stored_rows != rows) return false;
  result.outputs.resize(rows, outputs);
  if (!reader.copy(result.outputs.data(), static_cast<std::size_t>(rows * outputs) * sizeof(double))) return false;
  return read_remarks(reader, result.failures) && read_remarks(reader, result.notes) && reader.read(result.use);
}

}  // namespace

/// The open journal: what an earlier run left and where to append.
class JournalledModel::File {
 public:
  File(std::filesystem::path path, const Digest& study, bool resume) : path_(std::move(path)) {
    std::string head(k_magic);
    append_value(head, study);
    const bool is_there = std::filesystem::exists(path_);
    if (resume && is_there) {
      old_ = read_file(path_);
      require(old_.size() < head.size() || old_.starts_with(head),
              "{}: the study, the model or the tests have changed since that run; run again without --resume",
              path_.string());
      if (old_.size() < head.size()) old_.clear();  // killed while the head was written
    }
    position_ = old_.empty() ? 0 : head.size();
    descriptor_ = open_own_file(path_, resume ? ExistingFile::keep : ExistingFile::replace);
    if (old_.empty()) {
      cut();
      append(head);
    }
  }
  ~File() { ::close(descriptor_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  /// The answer that an earlier run left for this question, if it is the next one.
  bool find(const Digest& question, Eigen::Index rows, Eigen::Index outputs, Evaluation& result) {
    if (position_ >= old_.size()) return false;
    ByteReader reader(std::string_view(old_).substr(position_));
    std::uint64_t size = 0;
    Digest digest = {};
    constexpr std::size_t k_head = sizeof(size) + sizeof(digest);
    const bool is_whole = reader.read(size) && reader.read(digest) && size <= reader.left();
    const std::string_view body =
        is_whole ? std::string_view(old_).substr(position_ + k_head, size) : std::string_view();
    if (is_whole && digest_of(body) == digest && decode(body, question, rows, outputs, result)) {
      position_ += k_head + size;
      reused_ += rows;
      return true;
    }
    old_.resize(position_);  // records behind this point may be invalid
    cut();
    return false;
  }

  void append(std::string_view bytes) {
    std::string_view rest = bytes;
    while (!rest.empty()) {
      const ssize_t written = ::pwrite(descriptor_, rest.data(), rest.size(), static_cast<off_t>(position_));
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) {
        throw SystemFailure(fmt::format("{}: cannot be written: {}", path_.string(), std::strerror(errno)));
      }
      rest.remove_prefix(static_cast<std::size_t>(written));
      position_ += static_cast<std::size_t>(written);
    }
  }

  std::int64_t reused() const { return reused_; }

 private:
  void cut() const {
    if (::ftruncate(descriptor_, static_cast<off_t>(position_)) != 0) {
      throw SystemFailure(fmt::format("{}: cannot be cut to size: {}", path_.string(), std::strerror(errno)));
    }
  }

  std::filesystem::path path_;
  std::string old_;
  std::size_t position_ = 0;
  int descriptor_ = -1;
  std::int64_t reused_ = 0;
};

JournalledModel::JournalledModel(const Model& model, std::filesystem::path file, const Digest& fingerprint, bool resume,
                                 Ranks* ranks)
    : model_(model),
      fingerprint_(fingerprint),
      file_(file.empty() ? nullptr : std::make_unique<File>(std::move(file), fingerprint, resume)),
      ranks_(ranks) {}

JournalledModel::~JournalledModel() = default;

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
  if (file_) file_->append(record_of(encode(question, answer)));
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
