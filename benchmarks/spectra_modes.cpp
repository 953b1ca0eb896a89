// Spectra as a contender: the lowest modes of the matrices that mottle_sparse_benchmark left, with its own default
// (Eigen's SparseLU) or with our CHOLMOD factor behind its operator.
#include <Spectra/MatOp/SparseSymMatProd.h>
#include <Spectra/MatOp/SymShiftInvert.h>
#include <Spectra/SymGEigsShiftSolver.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/linalg/sparse/symmetric_factor.hpp"
#include "patch_model.hpp"

namespace {

using mottle::linalg::SparseMatrix;

template <typename T>
std::vector<T> read_array(const std::filesystem::path& file) {
  std::vector<T> values(std::filesystem::file_size(file) / sizeof(T));
  std::ifstream in(file, std::ios::binary);
  in.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(T)));
  if (!in) throw mottle::SystemFailure(fmt::format("{}: cannot be read", file.string()));
  return values;
}

SparseMatrix read_matrix(const std::filesystem::path& folder, const std::string& name) {
  const auto starts = read_array<int>(folder / fmt::format("{}.starts", name));
  const auto rows = read_array<int>(folder / fmt::format("{}.rows", name));
  const auto values = read_array<double>(folder / fmt::format("{}.values", name));
  const auto size = static_cast<Eigen::Index>(starts.size()) - 1;
  const SparseMatrix matrix = Eigen::Map<const SparseMatrix>(size, size, static_cast<Eigen::Index>(values.size()),
                                                             starts.data(), rows.data(), values.data());
  return matrix.pruned(0.0, 0.0);  // a lumped M keeps the pattern of K in the engine; the peer need not carry that
}

/// y = K^-1 x by CHOLMOD, as Spectra wants it.
class CholmodShiftInvert {
 public:
  using Scalar = double;
  explicit CholmodShiftInvert(const SparseMatrix& stiffness) : stiffness_(stiffness) {}
  Eigen::Index rows() const { return stiffness_.rows(); }
  Eigen::Index cols() const { return stiffness_.cols(); }
  void set_shift(double shift) {
    mottle::require(shift == 0.0 && factor_->factorise(stiffness_), "shift {}: K is not definite", shift);
  }
  void perform_op(const double* in, double* out) const {
    Eigen::Map<Eigen::MatrixXd> solution(out, rows(), 1);
    solution = Eigen::Map<const Eigen::MatrixXd>(in, rows(), 1);
    factor_->solve(solution);
  }

 private:
  const SparseMatrix& stiffness_;
  std::unique_ptr<mottle::linalg::DefiniteFactor> factor_ = mottle::linalg::make_definite_factor();
};

template <typename Operator>
Eigen::VectorXd solve(Operator&& inverse, const SparseMatrix& mass, int modes) {
  Spectra::SparseSymMatProd<double> product(mass);
  Spectra::SymGEigsShiftSolver<std::remove_reference_t<Operator>, Spectra::SparseSymMatProd<double>,
                               Spectra::GEigsMode::ShiftInvert>
      solver(inverse, product, modes, 2 * modes, 0.0);
  solver.init();
  const auto found = solver.compute(Spectra::SortRule::LargestMagn, 1000, 1e-10, Spectra::SortRule::SmallestAlge);
  mottle::require(found == modes && solver.eigenvectors().cols() == modes, "Spectra found {} modes", found);
  return solver.eigenvalues();
}

void run(const std::filesystem::path& folder, int modes, std::string_view factor, double budget) {
  const SparseMatrix stiffness = read_matrix(folder, "K"), mass = read_matrix(folder, "M");
  Eigen::VectorXd values;
  const double best = mottle::benchmarks::best_time(budget, [&] {
    if (factor == "cholmod") {
      values = solve(CholmodShiftInvert(stiffness), mass, modes);
    } else {
      values = solve(Spectra::SymShiftInvert<double, Eigen::Sparse, Eigen::Sparse>(stiffness, mass), mass, modes);
    }
  });
  fmt::print("{{\"seconds\": {}, \"eigenvalues\": [{:.17g}]}}\n", best, fmt::join(values, ", "));
}

}  // namespace

int main(int argc, char** argv) {
  const std::span<char*> words(argv, static_cast<std::size_t>(argc));
  if (words.size() < 5) {
    fmt::print("usage: mottle_spectra_benchmark FOLDER MODES cholmod|default SECONDS\n");
    return words.size() == 1 ? 0 : 2;  // `make bench` runs all programs without arguments
  }
  try {
    run(words[1], std::atoi(words[2]), words[3], std::atof(words[4]));
  } catch (const std::exception& error) {
    fmt::print(stderr, "mottle_spectra_benchmark: {}\n", error.what());
    return 1;
  }
  return 0;
}
