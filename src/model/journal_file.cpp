#include "model/journal_file.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include "mottle/core/bytes.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/own_file.hpp"
#include "mottle/model/journal.hpp"

namespace mottle::model {
namespace {

constexpr std::string_view k_magic = "mottle journal 6\n";
static_assert(k_magic.starts_with(k_journal_magic));

void append_remark(std::string& body, Eigen::Index sample, const std::string& text) {
  append_value(body, std::int64_t{sample});
  append_text(body, text);
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

/// Derivatives at a point; where an evaluation has its number of rows, they have a negative one.
std::string encode_derivatives(const Digest& point, const Eigen::MatrixXd& jacobian) {
  std::string body;
  append_value(body, point);
  append_value(body, std::int64_t{-jacobian.rows()});
  append_bytes(body, jacobian.data(), static_cast<std::size_t>(jacobian.size()) * sizeof(double));
  return body;
}

/// Nothing of a record that is an evaluation.
std::optional<std::pair<Digest, Eigen::MatrixXd>> decode_derivatives(std::string_view body) {
  ByteReader reader(body);
  Digest point = {};
  std::int64_t rows = 0;
  if (!reader.read(point) || !reader.read(rows) || rows >= 0) return std::nullopt;
  Eigen::MatrixXd jacobian(-rows, static_cast<Eigen::Index>(reader.left() / sizeof(double)) / -rows);
  if (!reader.copy(jacobian.data(), static_cast<std::size_t>(jacobian.size()) * sizeof(double))) return std::nullopt;
  return std::pair(point, std::move(jacobian));
}

}  // namespace

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

JournalFile::JournalFile(std::filesystem::path path, const Digest& study, bool resume) : path_(std::move(path)) {
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
  for (auto record = record_at(position_); record; record = record_at(record->end)) {
    if (auto kept = decode_derivatives(record->body)) derivatives_.insert(*std::move(kept));
  }
  descriptor_ = open_own_file(path_, resume ? ExistingFile::keep : ExistingFile::replace);
  if (old_.empty()) {
    cut();
    append(head);
  }
}

JournalFile::~JournalFile() {
  ::close(descriptor_);
}

bool JournalFile::find(const Digest& question, Eigen::Index rows, Eigen::Index outputs, Evaluation& result) {
  const std::lock_guard lock(mutex_);
  pass_derivatives();
  if (position_ >= old_.size()) return false;
  const std::optional<Record> record = record_at(position_);
  if (record && decode(record->body, question, rows, outputs, result)) {
    position_ = record->end;
    reused_ += rows;
    return true;
  }
  drop_rest();
  return false;
}

void JournalFile::keep(const Digest& question, const Evaluation& answer) {
  const std::lock_guard lock(mutex_);
  append(record_of(encode(question, answer)));
}

std::optional<Eigen::MatrixXd> JournalFile::find_derivatives(const Digest& point) const {
  const std::lock_guard lock(mutex_);
  const auto found = derivatives_.find(point);
  return found == derivatives_.end() ? std::nullopt : std::optional(found->second);
}

void JournalFile::keep_derivatives(const Digest& point, const Eigen::MatrixXd& jacobian) {
  const std::lock_guard lock(mutex_);
  pass_derivatives();
  drop_rest();
  append(record_of(encode_derivatives(point, jacobian)));
  derivatives_.emplace(point, jacobian);
}

std::optional<JournalFile::Record> JournalFile::record_at(std::size_t position) const {
  if (position >= old_.size()) return std::nullopt;
  ByteReader reader(std::string_view(old_).substr(position));
  std::uint64_t size = 0;
  Digest digest = {};
  constexpr std::size_t k_head = sizeof(size) + sizeof(digest);
  if (!reader.read(size) || !reader.read(digest) || size > reader.left()) return std::nullopt;
  const std::string_view body = std::string_view(old_).substr(position + k_head, size);
  if (digest_of(body) != digest) return std::nullopt;
  return Record{body, position + k_head + size};
}

void JournalFile::pass_derivatives() {
  for (auto record = record_at(position_); record && decode_derivatives(record->body); record = record_at(position_)) {
    position_ = record->end;
  }
}

void JournalFile::drop_rest() {
  if (position_ >= old_.size()) return;
  old_.resize(position_);
  cut();
}

void JournalFile::append(std::string_view bytes) {
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

void JournalFile::cut() const {
  if (::ftruncate(descriptor_, static_cast<off_t>(position_)) != 0) {
    throw SystemFailure(fmt::format("{}: cannot be cut to size: {}", path_.string(), std::strerror(errno)));
  }
}

}  // namespace mottle::model
