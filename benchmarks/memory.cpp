// Peak memory of one exact solve, or of a cloud by the reduced model, above what the process held before it; one of
// them a process, since a peak never falls. compare_memory.py makes the table.
#include <fmt/format.h>
#include <malloc.h>

#include <cstdlib>
#include <exception>
#include <fstream>
#include <random>
#include <span>
#include <string>
#include <string_view>

#include "mottle/core/error.hpp"
#include "mottle/formats/nastran/model.hpp"
#include "mottle/linalg/reduced/reduced_model.hpp"
#include "patch_model.hpp"

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A line of /proc/self/status, in bytes: VmHWM is the highest resident size, VmRSS the present one.
double status_bytes(std::string_view key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(key)) return 1024.0 * std::atof(line.c_str() + key.size() + 1);
  }
  throw mottle::SystemFailure("/proc/self/status: no such line");
}

/// Gives back what is free and lets the peak start anew from what is held; that, in bytes.
double begin_peak() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
  const double held = status_bytes("VmRSS:");
  mottle::require(status_bytes("VmHWM:") < 1.01 * held + 1e6, "the peak of memory cannot be reset{}", "");
  return held;
}

MatrixXd factors(Eigen::Index samples, Eigen::Index parameters, unsigned seed) {
  std::mt19937_64 random(seed);
  std::lognormal_distribution<double> distribution(-0.005, 0.1);
  MatrixXd x(samples, parameters);
  for (double& value : x.reshaped()) value = distribution(random);
  return x;
}

void run(const char* deck_file, int patches, int modes, std::string_view what) {
  mottle::fem::AssembledModel model;
  {
    mottle::formats::NastranModel deck = mottle::formats::read_nastran_model(deck_file);
    const auto targets =
        mottle::model::find_field_targets(deck.model, mottle::benchmarks::patch_parameters(patches, "E"));
    model = mottle::fem::assemble(deck.model, targets.parameters);
  }
  const VectorXd ones = VectorXd::Ones(patches);
  const mottle::linalg::SparseMatrix stiffness = model.stiffness.at(ones);
  const mottle::linalg::SparseMatrix mass = model.mass.at(ones);
  const auto coefficients = [&](const MatrixXd& x) {
    return mottle::fem::term_coefficients(model.stiffness, model.mass, x);
  };
  double factor = 0.0, vectors = 0.0;
  const double held = begin_peak();
  double peak = 0.0;
  if (what == "exact") {
    mottle::linalg::SparseModeSolver solver;
    const mottle::linalg::SparseModes found = solver.solve(stiffness, mass, {.modes = modes, .measures = false});
    peak = status_bytes("VmHWM:");
    mottle::require(found.failure.empty(), "{}", found.failure);
    factor = solver.factor().factor_entries();
    vectors = found.basis_vectors;
  } else {
    mottle::linalg::ReducedModel reduced(mottle::fem::pencil_terms(model.stiffness, model.mass),
                                         coefficients(ones.transpose()), stiffness, mass, {.modes = modes});
    reduced.train(coefficients(factors(400, patches, 1)), 1);
    reduced.solve(coefficients(factors(1000, patches, 2)), 1);
    peak = status_bytes("VmHWM:");
    vectors = static_cast<double>(reduced.basis().cols());
  }
  fmt::print(
      "{{\"equations\": {}, \"entries\": {}, \"held\": {}, \"peak\": {}, \"factor_entries\": {}, \"vectors\": {}}}\n",
      stiffness.rows(), stiffness.nonZeros(), held, peak, factor, vectors);
}

}  // namespace

int main(int argc, char** argv) {
  const std::span<char*> words(argv, static_cast<std::size_t>(argc));
  if (words.size() < 5) {
    fmt::print("usage: mottle_memory_benchmark DECK PATCHES MODES exact|cloud\n");
    return words.size() == 1 ? 0 : 2;  // `make bench` runs all programs without arguments
  }
  try {
    run(words[1], std::atoi(words[2]), std::atoi(words[3]), words[4]);
  } catch (const std::exception& error) {
    fmt::print(stderr, "mottle_memory_benchmark: {}\n", error.what());
    return 1;
  }
  return 0;
}
