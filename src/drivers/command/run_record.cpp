// The bytes of a run's record.
#include <cstring>

#include "mottle/core/error.hpp"
#include "mottle/drivers/command/run_store.hpp"

namespace mottle::drivers {
namespace {

void add_text(std::string& body, const std::string& text) {
  const std::uint64_t size = text.size();
  body.append(reinterpret_cast<const char*>(&size), sizeof(size));
  body += text;
}

void add_matrix(std::string& body, const Eigen::MatrixXd& matrix) {
  const std::uint64_t sizes[2] = {static_cast<std::uint64_t>(matrix.rows()), static_cast<std::uint64_t>(matrix.cols())};
  body.append(reinterpret_cast<const char*>(sizes), sizeof(sizes));
  body.append(reinterpret_cast<const char*>(matrix.data()), static_cast<std::size_t>(matrix.size()) * sizeof(double));
}

}  // namespace

std::string encode(const RunRecord& record) {
  std::string body;
  add_text(body, record.failure);
  add_matrix(body, record.modes.eigenvalues);
  add_matrix(body, record.modes.shapes);
  std::string names;
  for (const std::string& name : record.modes.degree_of_freedom_names) names += name + '\n';
  add_text(body, names);
  return body;
}

namespace {

/// Takes values off the front of a body whose checksum was right.
class BodyReader {
 public:
  explicit BodyReader(std::string_view bytes) : bytes_(bytes) {}
  std::uint64_t size() {
    std::uint64_t value = 0;
    std::memcpy(&value, take(sizeof(value)).data(), sizeof(value));
    return value;
  }
  std::string text() { return std::string(take(size())); }
  Eigen::MatrixXd matrix() {
    const std::uint64_t rows = size();
    const std::uint64_t columns = size();
    Eigen::MatrixXd matrix(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
    const std::string_view values = take(rows * columns * sizeof(double));
    if (!values.empty()) std::memcpy(matrix.data(), values.data(), values.size());
    return matrix;
  }

 private:
  std::string_view take(std::uint64_t size) {
    if (size > bytes_.size()) throw SystemFailure("a record of runs is damaged");
    const std::string_view taken = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return taken;
  }
  std::string_view bytes_;
};

}  // namespace

RunRecord decode_run(std::string_view body) {
  BodyReader reader(body);
  RunRecord record;
  record.failure = reader.text();
  record.modes.eigenvalues = reader.matrix();
  record.modes.shapes = reader.matrix();
  const std::string names = reader.text();
  for (std::size_t begin = 0; begin < names.size();) {
    const std::size_t end = names.find('\n', begin);
    record.modes.degree_of_freedom_names.push_back(names.substr(begin, end - begin));
    begin = end + 1;
  }
  return record;
}

}  // namespace mottle::drivers
