// One deck from its file to its lowest modes, each step timed on one thread; K and M are left for the peers of
// compare_sparse.py, which sets OPENBLAS_CORETYPE for both sides.
#include "mottle/linalg/sparse/sparse_modes.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/formats/nastran/model.hpp"
#include "mottle/model/parameters/field_targets.hpp"
#include "patch_model.hpp"

namespace {

using mottle::benchmarks::best_time;
using mottle::benchmarks::patch_parameters;
using mottle::benchmarks::time_of;
using mottle::linalg::SparseMatrix;

struct Arguments {
  std::filesystem::path deck;
  int parameters = 0;  ///< MAT1:1:field ... MAT1:parameters:field, factors
  std::string field;
  int modes = 10;
  std::filesystem::path folder;
  double budget = 10.0;  ///< s, of the repetitions of each step
};

std::string blas_kernel() {
  using CoreName = char* (*)();
  const auto core_name = reinterpret_cast<CoreName>(dlsym(RTLD_DEFAULT, "openblas_get_corename"));
  return core_name == nullptr ? "unknown" : core_name();
}

/// The reference, and points about 10 % away from it, another one each time.
Eigen::VectorXd parameters_at(int point, int count) {
  Eigen::VectorXd x = Eigen::VectorXd::Ones(count);
  for (int p = 0; p < count; ++p) x(p) += point == 0 ? 0.0 : 0.1 * std::cos(7.0 * p + point);
  return x;
}

template <typename T>
void write_array(const std::filesystem::path& file, const T* values, Eigen::Index count) {
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(values), count * static_cast<std::streamsize>(sizeof(T)));
  if (!out.flush()) throw mottle::SystemFailure(fmt::format("{}: cannot be written", file.string()));
}

/// The lower triangle as three raw arrays: NAME.starts and NAME.rows (int32), NAME.values (float64).
void write_matrix(const std::filesystem::path& folder, const std::string& name, const SparseMatrix& matrix) {
  write_array(folder / fmt::format("{}.starts", name), matrix.outerIndexPtr(), matrix.cols() + 1);
  write_array(folder / fmt::format("{}.rows", name), matrix.innerIndexPtr(), matrix.nonZeros());
  write_array(folder / fmt::format("{}.values", name), matrix.valuePtr(), matrix.nonZeros());
}

std::vector<std::string> time_factor(const SparseMatrix& stiffness, double budget) {
  double first = 1e300;
  double again = 1e300;
  double entries = 0.0;
  best_time(budget, [&] {
    const auto factor = mottle::linalg::make_definite_factor();
    first = std::min(first, time_of([&] { factor->factorise(stiffness); }));
    again = std::min(again, time_of([&] { factor->factorise(stiffness); }));
    entries = factor->factor_entries();
  });
  return {fmt::format("\"factor_first_s\": {}", first), fmt::format("\"factor_s\": {}", again),
          fmt::format("\"factor_entries\": {}", entries)};
}

std::vector<std::string> time_modes(const mottle::fem::AssembledModel& model, const Arguments& arguments) {
  const mottle::linalg::SparseModesOptions options{.modes = arguments.modes, .measures = false};
  const Eigen::VectorXd reference = parameters_at(0, arguments.parameters);
  const SparseMatrix stiffness = model.stiffness.at(reference);
  const SparseMatrix mass = model.mass.at(reference);
  write_matrix(arguments.folder, "K", stiffness);
  write_matrix(arguments.folder, "M", mass);
  mottle::linalg::SparseModes modes;
  const double cold = best_time(arguments.budget, [&] {
    mottle::linalg::SparseModeSolver solver;
    modes = solver.solve(stiffness, mass, options);
  });
  mottle::require(modes.failure.empty(), "{}: {}", arguments.deck.string(), modes.failure);
  mottle::linalg::SparseModeSolver solver;
  solver.solve(stiffness, mass, options);
  mottle::linalg::SparseModes modes_at_point;
  int point = 0;
  const double sample = best_time(arguments.budget, [&] {
    const Eigen::VectorXd x = parameters_at(++point, arguments.parameters);
    modes_at_point = solver.solve(model.stiffness.at(x), model.mass.at(x), options);
  });
  mottle::require(modes_at_point.failure.empty(), "{}: {}", arguments.deck.string(), modes_at_point.failure);
  std::vector<std::string> lines = time_factor(stiffness, arguments.budget);
  lines.insert(lines.end(), {fmt::format("\"equations\": {}", stiffness.rows()),
                             fmt::format("\"entries\": {}", stiffness.nonZeros()), fmt::format("\"cold_s\": {}", cold),
                             fmt::format("\"sample_s\": {}", sample),
                             fmt::format("\"shifted_factor_first_s\": {}", modes.factor_seconds),
                             fmt::format("\"solved_vectors\": {}", modes.basis_vectors),
                             fmt::format("\"eigenvalues\": [{:.17g}]", fmt::join(modes.values, ", ")),
                             fmt::format("\"residuals\": [{:.3g}]", fmt::join(modes.residuals, ", "))});
  return lines;
}

void run(const Arguments& arguments) {
  std::filesystem::create_directories(arguments.folder);
  mottle::formats::NastranModel deck;
  const double read = best_time(arguments.budget, [&] { deck = mottle::formats::read_nastran_model(arguments.deck); });
  const mottle::model::FieldTargets targets =
      mottle::model::find_field_targets(deck.model, patch_parameters(arguments.parameters, arguments.field));
  mottle::fem::AssembledModel model;
  const double assembly =
      best_time(arguments.budget, [&] { model = mottle::fem::assemble(deck.model, targets.parameters); });
  std::vector<std::string> lines = time_modes(model, arguments);
  lines.insert(lines.end(), {fmt::format("\"read_s\": {}", read), fmt::format("\"assembly_s\": {}", assembly),
                             fmt::format("\"blas_kernel\": \"{}\"", blas_kernel())});
  std::ofstream out(arguments.folder / "result.json");
  out << fmt::format("{{\n  {}\n}}\n", fmt::join(lines, ",\n  "));
  if (!out.flush()) throw mottle::SystemFailure(fmt::format("{}: cannot be written", arguments.folder.string()));
}

}  // namespace

int main(int argc, char** argv) {
  const std::span<char*> words(argv, static_cast<std::size_t>(argc));
  if (words.size() < 6) {
    fmt::print("usage: mottle_sparse_benchmark DECK PARAMETERS FIELD MODES FOLDER [SECONDS A STEP]\n");
    return words.size() == 1 ? 0 : 2;  // `make bench` runs all programs without arguments
  }
  try {
    Arguments arguments{words[1], std::atoi(words[2]), words[3], std::atoi(words[4]), words[5]};
    if (words.size() > 6) arguments.budget = std::atof(words[6]);
    run(arguments);
  } catch (const std::exception& error) {
    fmt::print(stderr, "mottle_sparse_benchmark: {}\n", error.what());
    return 1;
  }
  return 0;
}
