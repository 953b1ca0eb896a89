#include "mottle/model/journal.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <string_view>

#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/own_file.hpp"
#include "mottle/model/sample_region.hpp"

namespace mottle::model {
namespace {

constexpr std::string_view k_magic = "mottle journal 6\n";

void append_bytes(std::string& bytes, const void* data, std::size_t size) {
  bytes.append(static_cast<const char*>(data), size);
}

template <typename Value>
void append_value(std::string& bytes, Value value) {
  append_bytes(bytes, &value, sizeof(value));
}

/// Reads values from bytes; says whether they were all there.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}
  template <typename Value>
  bool read(Value& value) {
    return copy(&value, sizeof(value));
  }
  bool copy(void* destination, std::size_t size) {
    if (bytes_.size() < size) return false;
    std::memcpy(destination, bytes_.data(), size);
    bytes_.remove_prefix(size);
    return true;
  }
  std::size_t left() const { return bytes_.size(); }

 private:
  std::string_view bytes_;
};

Digest digest_of_samples(const SampleRegion* region, const Eigen::MatrixXd& samples) {
  Checksum checksum;
  if (region != nullptr) checksum.add(hexadecimal(region->digest()));
  checksum.add(std::to_string(samples.rows()));
  checksum.add(samples.data(), static_cast<std::size_t>(samples.size()) * sizeof(double));
  return checksum.digest();
}

void append_remark(std::string& body, Eigen::Index sample, const std::string& text) {
  append_value(body, std::int64_t{sample});
  append_value(body, static_cast<std::int64_t>(text.size()));
  body += text;
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
  std::string record;
  append_value(record, static_cast<std::uint64_t>(body.size()));
  append_value(record, digest_of(body));
  return record + body;
}

/// A list of (sample, text); false where the record ends too early.
template <typename Remark>
bool read_remarks(Reader& reader, std::vector<Remark>& remarks) {
  std::int64_t count = 0;
  if (!reader.read(count)) return false;
  for (std::int64_t i = 0; i < count; ++i) {
    std::int64_t sample = 0;
    std::int64_t length = 0;
    if (!reader.read(sample) || !reader.read(length) || length < 0) return false;
    if (static_cast<std::size_t>(length) > reader.left()) return false;
    std::string text(static_cast<std::size_t>(length), ' ');
    if (!reader.copy(text.data(), text.size())) return false;
    remarks.push_back({sample, std::move(text)});
  }
  return true;
}

bool decode(std::string_view body, const Digest& question, Eigen::Index rows, Eigen::Index outputs,
            Evaluation& result) {
  Reader reader(body);
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
    Reader reader(std::string_view(old_).substr(position_));
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

JournalledModel::JournalledModel(const Model& model, std::filesystem::path file, const Digest& fingerprint, bool resume)
    : model_(model), file_(file.empty() ? nullptr : std::make_unique<File>(std::move(file), fingerprint, resume)) {}

JournalledModel::~JournalledModel() = default;

std::int64_t JournalledModel::reused() const {
  return file_ ? file_->reused() : 0;
}

Evaluation JournalledModel::compute(const SampleRegion* region, const Eigen::MatrixXd& samples,
                                    const RunContext& context) const {
  return region == nullptr ? model_.evaluate(samples, context) : model_.evaluate_in(*region, samples, context);
}

Evaluation JournalledModel::answer_to(const SampleRegion* region, const Eigen::MatrixXd& samples,
                                      const RunContext& context) const {
  if (!file_) return compute(region, samples, context);
  const Digest question = digest_of_samples(region, samples);
  Evaluation answer;
  if (file_->find(question, samples.rows(), static_cast<Eigen::Index>(outputs().size()), answer)) return answer;
  answer = compute(region, samples, context);
  file_->append(encode(question, answer));
  return answer;
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
