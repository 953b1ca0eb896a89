#include "model/batch_record.hpp"

#include <limits>

#include "model/row_exchange.hpp"

namespace mottle::model {

BatchRecord::BatchRecord(Eigen::Index samples, Eigen::Index outputs)
    : values(Eigen::MatrixXd::Constant(samples, outputs, std::numeric_limits<double>::quiet_NaN())),
      words(static_cast<std::size_t>(samples)),
      is_own(words.size(), 0) {}

void BatchRecord::say(Eigen::Index sample, std::string reason, std::string note) {
  if (reason.empty() && note.empty()) return;
  words[static_cast<std::size_t>(sample)] =
      std::make_unique<Words>(Words{.reason = std::move(reason), .note = std::move(note)});
}

void BatchRecord::put_together(Ranks& ranks, const Digest& state) {
  RowRecords records;
  for (Eigen::Index s = 0; s < values.rows(); ++s) {
    const auto k = static_cast<std::size_t>(s);
    if (is_own[k] == 0) continue;
    std::string& bytes = records.begin(s);
    for (const double value : values.row(s)) append_value(bytes, value);
    append_text(bytes, words[k] ? words[k]->reason : "");
    append_text(bytes, words[k] ? words[k]->note : "");
  }
  const auto read = [this](Eigen::Index s, ByteReader& reader) {
    Words own;
    for (double& value : values.row(s)) {
      if (!reader.read(value)) return false;
    }
    if (!reader.read_text(own.reason) || !reader.read_text(own.note)) return false;
    say(s, std::move(own.reason), std::move(own.note));
    return true;
  };
  records.exchange(ranks, state, "the model's modes at the parameters' means", values.rows(), read);
}

Evaluation BatchRecord::evaluation() && {
  Evaluation result{.outputs = std::move(values), .failures = {}};
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (!words[k]) continue;
    if (!words[k]->reason.empty()) {
      result.failures.push_back({static_cast<Eigen::Index>(k), std::move(words[k]->reason)});
    } else {
      result.notes.push_back({static_cast<Eigen::Index>(k), std::move(words[k]->note)});
    }
  }
  return result;
}

}  // namespace mottle::model
