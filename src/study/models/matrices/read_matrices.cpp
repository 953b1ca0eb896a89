#include "study/models/matrices/read_matrices.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>

#include "mottle/core/error.hpp"
#include "mottle/formats/matrices/matrix_file.hpp"
#include "study/input/key_error.hpp"

namespace mottle::study {
namespace {

/// A text whose last line has no end may have been cut short within its last number.
std::string note_of_open_end(const std::filesystem::path& file) {
  constexpr std::streamoff k_looked_at = 64;
  std::ifstream stream(file, std::ios::binary);
  stream.seekg(0, std::ios::end);
  const std::streamoff size = stream.tellg();
  stream.seekg(std::max(std::streamoff{0}, size - k_looked_at));
  const std::string last{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  const bool is_text =
      std::ranges::all_of(last, [](char c) { return (c >= ' ' && c <= '~') || c == '\n' || c == '\r'; });
  if (!is_text || last.empty() || last.back() < '0' || last.back() > '9') return {};
  return fmt::format("{}: its last line has no end; where the file was cut short, its last number is wrong",
                     file.string());
}

}  // namespace

MatrixModel read_matrices(const MatrixFiles& source, const std::vector<ParameterTargets>& targets,
                          const Eigen::VectorXd& prior_mean, std::vector<std::string>& files) {
  std::vector<std::string> names;
  std::vector<std::string> notes;
  if (!source.row_names.empty()) {
    names = read_row_names(source.row_names);
    files.push_back(source.row_names.string());
  }
  const auto read = [&](const std::string& location) -> std::optional<SymmetricMatrix> {
    if (location.empty()) return std::nullopt;
    SymmetricMatrix matrix = read_symmetric_matrix(location);
    files.push_back(file_of_matrix(location).string());
    if (std::string note = note_of_open_end(files.back()); !note.empty()) notes.push_back(std::move(note));
    if (!names.empty()) {
      require_key(names.size() == static_cast<std::size_t>(matrix.lower.rows()), "model.degrees_of_freedom",
                  "{} names, but {} has {} rows", names.size(), location, matrix.lower.rows());
      matrix.names = names;
    }
    return matrix;
  };
  MatrixSystem system{read(source.constant_part.stiffness), read(source.constant_part.mass), {}};
  for (const MatrixPartFiles& part : source.parts) {
    system.parts.push_back({part.name, read(part.stiffness), read(part.mass), part.nominal, part.exponent});
  }
  MatrixModel model = bind_parameters(system, targets, prior_mean);
  model.notes.insert(model.notes.end(), notes.begin(), notes.end());
  return model;
}

}  // namespace mottle::study
