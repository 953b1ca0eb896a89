#include "model/batch_record.hpp"

#include <limits>

#include "model/row_exchange.hpp"

namespace mottle::model {

BatchRecord::BatchRecord(Eigen::Index samples, Eigen::Index outputs)
    : values(Eigen::MatrixXd::Constant(samples, outputs, std::numeric_limits<double>::quiet_NaN())),
      reasons(static_cast<std::size_t>(samples)),
      notes(reasons.size()),
      is_own(reasons.size(), 0) {}

void BatchRecord::put_together(Ranks& ranks, const Digest& state) {
  RowRecords records;
  for (Eigen::Index s = 0; s < values.rows(); ++s) {
    const auto k = static_cast<std::size_t>(s);
    if (is_own[k] == 0) continue;
    std::string& bytes = records.begin(s);
    for (const double value : values.row(s)) append_value(bytes, value);
    append_text(bytes, reasons[k]);
    append_text(bytes, notes[k]);
  }
  const auto read = [this](Eigen::Index s, ByteReader& reader) {
    const auto k = static_cast<std::size_t>(s);
    for (double& value : values.row(s)) {
      if (!reader.read(value)) return false;
    }
    return reader.read_text(reasons[k]) && reader.read_text(notes[k]);
  };
  records.exchange(ranks, state, "the model's modes at the parameters' means", values.rows(), read);
}

Evaluation BatchRecord::evaluation() && {
  Evaluation result{.outputs = std::move(values), .failures = {}};
  for (std::size_t k = 0; k < reasons.size(); ++k) {
    if (!reasons[k].empty()) {
      result.failures.push_back({static_cast<Eigen::Index>(k), std::move(reasons[k])});
    } else if (!notes[k].empty()) {
      result.notes.push_back({static_cast<Eigen::Index>(k), std::move(notes[k])});
    }
  }
  return result;
}

}  // namespace mottle::model
