// The ten lowest modes of many dense pencils of one family, ours beside LAPACK's and Eigen's solvers on the same
// matrices. The matrices are left for NumPy; compare_dense.py runs this program and writes DENSE.md.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <span>

#include "eigen_peers.hpp"
#include "lapack_peers.hpp"
#include "mottle/linalg/batched/batch_eigen.hpp"
#include "patch_model.hpp"

namespace {

using Eigen::Index;
using mottle::benchmarks::LapackPeers;
using mottle::benchmarks::Lowest;
using mottle::benchmarks::MatrixXd;
using mottle::benchmarks::OpenBlas;
using mottle::benchmarks::VectorXd;
using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

constexpr int k_modes = 10;
constexpr Index k_terms = 5;
constexpr Index k_peer_samples = 16;  // of which the peers get the matrices; ours has many more

MatrixXd uniform(Index rows, Index columns, double low, double high, std::mt19937_64& random) {
  std::uniform_real_distribution<double> distribution(low, high);
  MatrixXd matrix(rows, columns);
  for (double& entry : matrix.reshaped()) entry = distribution(random);
  return matrix;
}

/// A rod of linear elements with lumped masses, fixed at one end, in five parts with a parameter each, seen in a turned
/// basis in which every matrix is full: K(x) = sum x_i K_i, M = sum y_i M_i or the same with y = 1.
struct Workload {
  mottle::linalg::PencilFamily family;
  MatrixXd stiffness_coefficients, mass_coefficients;

  MatrixXd stiffness(Index sample) const {
    return sum(family.stiffness_constant, family.stiffness_terms, stiffness_coefficients, sample);
  }
  MatrixXd mass(Index sample) const { return sum(family.mass_constant, family.mass_terms, mass_coefficients, sample); }

 private:
  static MatrixXd sum(MatrixXd result, const std::vector<MatrixXd>& terms, const MatrixXd& coefficients, Index sample) {
    for (std::size_t i = 0; i < terms.size(); ++i) result += coefficients(static_cast<Index>(i), sample) * terms[i];
    return result;
  }
};

Workload workload(Index order, Index samples, bool parametric_mass) {
  std::mt19937_64 random(1);
  const MatrixXd turn = Eigen::HouseholderQR<MatrixXd>(uniform(order, order, -1.0, 1.0, random)).householderQ() *
                        MatrixXd::Identity(order, order);
  std::vector<MatrixXd> stiffness(k_terms, MatrixXd::Zero(order, order)), mass = stiffness;
  for (Index element = 0; element < order; ++element) {
    const auto part = static_cast<std::size_t>(element * k_terms / order);
    for (const Index i : {element - 1, element}) {
      for (const Index j : {element - 1, element}) {
        if (i < 0 || j < 0) continue;
        stiffness[part](i, j) += i == j ? 1.0 : -1.0;
        if (i == j) mass[part](i, j) += 1.0;
      }
    }
  }
  const auto turned = [&](const MatrixXd& matrix) -> MatrixXd {
    const MatrixXd product = turn.transpose() * matrix * turn;
    return 0.5 * (product + product.transpose());
  };
  Workload work;
  const MatrixXd zero = MatrixXd::Zero(order, order);
  work.family = {zero, {}, zero, {}};
  for (std::size_t part = 0; part < stiffness.size(); ++part) {
    work.family.stiffness_terms.push_back(turned(stiffness[part]));
    const MatrixXd mass_term = turned(mass[part]);
    if (parametric_mass) {
      work.family.mass_terms.push_back(mass_term);
    } else {
      work.family.mass_constant += mass_term;
    }
  }
  work.stiffness_coefficients = uniform(k_terms, samples, 0.7, 1.3, random);
  work.mass_coefficients = uniform(parametric_mass ? k_terms : 0, samples, 0.7, 1.3, random);
  return work;
}

/// What the peers get for nothing: the samples' matrices; with a constant mass those of the standard problem.
struct PeerMatrices {
  std::vector<MatrixXd> stiffness, mass;
  MatrixXd back_transform;  ///< L^-T of a constant mass
};

PeerMatrices peer_matrices(const Workload& work) {
  PeerMatrices peers;
  const bool is_constant = work.family.mass_terms.empty();
  const Eigen::LLT<MatrixXd> factor(work.mass(0));
  if (is_constant) {
    peers.back_transform = factor.matrixU().solve(MatrixXd::Identity(work.mass(0).rows(), work.mass(0).rows()));
  }
  for (Index sample = 0; sample < k_peer_samples; ++sample) {
    const MatrixXd stiffness = work.stiffness(sample);
    if (is_constant) {
      const MatrixXd reduced = peers.back_transform.transpose() * stiffness * peers.back_transform;
      peers.stiffness.push_back(0.5 * (reduced + reduced.transpose()));
    } else {
      peers.stiffness.push_back(stiffness);
      peers.mass.push_back(work.mass(sample));
    }
  }
  return peers;
}

/// The lowest eigenvalues of one sample in extended precision, by Eigen, from the family's own terms.
VectorXd reference_values(const Workload& work, Index sample) {
  const auto sum = [&](const MatrixXd& constant, const std::vector<MatrixXd>& terms, const MatrixXd& coefficients) {
    LongMatrix result = constant.cast<long double>();
    for (std::size_t i = 0; i < terms.size(); ++i) {
      result += static_cast<long double>(coefficients(static_cast<Index>(i), sample)) * terms[i].cast<long double>();
    }
    return result;
  };
  const mottle::linalg::PencilFamily& f = work.family;
  const Eigen::GeneralizedSelfAdjointEigenSolver<LongMatrix> solver(
      sum(f.stiffness_constant, f.stiffness_terms, work.stiffness_coefficients),
      sum(f.mass_constant, f.mass_terms, work.mass_coefficients), Eigen::EigenvaluesOnly);
  return solver.eigenvalues().head(k_modes).cast<double>();
}

struct Contender {
  std::string name;
  Index samples;                             ///< in one call of `run`
  std::function<void()> run;                 ///< solves them all
  std::function<VectorXd(Index)> values_of;  ///< eigenvalues of one sample
  double best = 1e300;                       ///< s a sample
  double error = 0.0;                        ///< largest relative error of an eigenvalue
};

/// A peer that solves one sample at a time.
Contender one_by_one(const std::string& name, const std::function<Lowest(Index)>& solve) {
  return {name, k_peer_samples,
          [solve] {
            for (Index sample = 0; sample < k_peer_samples; ++sample) solve(sample);
          },
          [solve](Index sample) { return solve(sample).values; }};
}

/// What the driver returns, multiplied by L^-T as ours is.
template <typename Solve>
std::function<Lowest(Index)> transformed(const PeerMatrices& peers, Solve solve) {
  return [&peers, solve](Index sample) -> Lowest {
    const auto& lowest = solve(peers.stiffness[static_cast<std::size_t>(sample)]);
    return {lowest.values, peers.back_transform.triangularView<Eigen::Upper>() * lowest.vectors};
  };
}

Lowest space_for(const MatrixXd& matrix) {
  return {VectorXd(k_modes), MatrixXd(matrix.rows(), k_modes)};
}

std::vector<Contender> standard_peers(const PeerMatrices& peers, LapackPeers& lapack) {
  const auto eigen = [](const MatrixXd& matrix) {
    Lowest lowest = space_for(matrix);
    mottle::benchmarks::eigen_standard(static_cast<int>(matrix.rows()), k_modes, matrix.data(), lowest.values.data(),
                                       lowest.vectors.data());
    return lowest;
  };
  return {one_by_one("LAPACK dsyevr", transformed(peers, [&lapack](const MatrixXd& a) { return lapack.dsyevr(a); })),
          one_by_one("LAPACK dsyevx", transformed(peers, [&lapack](const MatrixXd& a) { return lapack.dsyevx(a); })),
          one_by_one("Eigen SelfAdjointEigenSolver", transformed(peers, eigen))};
}

std::vector<Contender> generalised_peers(const PeerMatrices& peers, LapackPeers& lapack) {
  const auto k = [&peers](Index sample) -> const MatrixXd& {
    return peers.stiffness[static_cast<std::size_t>(sample)];
  };
  const auto m = [&peers](Index sample) -> const MatrixXd& { return peers.mass[static_cast<std::size_t>(sample)]; };
  const auto eigen = [k, m](Index sample) {
    Lowest lowest = space_for(k(sample));
    mottle::benchmarks::eigen_generalised(static_cast<int>(k(sample).rows()), k_modes, k(sample).data(),
                                          m(sample).data(), lowest.values.data(), lowest.vectors.data());
    return lowest;
  };
  return {one_by_one("LAPACK dsygvx", [&lapack, k, m](Index sample) { return lapack.dsygvx(k(sample), m(sample)); }),
          one_by_one("LAPACK dpotrf, dsygst, dsyevr",
                     [&lapack, k, m](Index sample) { return lapack.dsygst_dsyevr(k(sample), m(sample)); }),
          one_by_one("Eigen GeneralizedSelfAdjointEigenSolver", eigen)};
}

Contender ours(const Workload& work) {
  const auto solve = [&work] {
    return solve_batch(work.family, work.stiffness_coefficients, work.mass_coefficients, {.modes = k_modes});
  };
  return {"Mottle", work.stiffness_coefficients.cols(), [solve] { solve(); },
          [solve](Index sample) -> VectorXd { return solve().values.col(sample); }};
}

void write(const std::filesystem::path& file, const std::vector<MatrixXd>& matrices) {
  std::ofstream out(file, std::ios::binary);
  for (const MatrixXd& matrix : matrices) {
    out.write(reinterpret_cast<const char*>(matrix.data()), matrix.size() * static_cast<Index>(sizeof(double)));
  }
}

/// In turn until the budget is spent, so that a slow moment of the machine meets all alike.
void measure(std::vector<Contender>& contenders, double budget) {
  const double end = mottle::benchmarks::seconds() + budget;
  for (int round = 0; round < 3 || mottle::benchmarks::seconds() < end; ++round) {
    for (Contender& contender : contenders) {
      const double time = mottle::benchmarks::time_of(contender.run);
      contender.best = std::min(contender.best, time / static_cast<double>(contender.samples));
    }
  }
}

std::string compare(const OpenBlas& library, int order, bool parametric_mass, double budget,
                    const std::filesystem::path& folder) {
  const Workload work = workload(order, order <= 120 ? 512 : 128, parametric_mass);
  const PeerMatrices peers = peer_matrices(work);
  LapackPeers lapack(library, order, k_modes);
  std::vector<Contender> contenders =
      parametric_mass ? generalised_peers(peers, lapack) : standard_peers(peers, lapack);
  contenders.insert(contenders.begin(), ours(work));
  measure(contenders, budget);
  const Index checked = order <= 120 ? 4 : 1;
  std::vector<VectorXd> references;
  for (Index sample = 0; sample < checked; ++sample) {
    references.push_back(reference_values(work, sample));
    for (Contender& contender : contenders) {
      const VectorXd ratios = contender.values_of(sample).cwiseQuotient(references.back());
      contender.error = std::max(contender.error, (ratios.array() - 1.0).abs().maxCoeff());
    }
  }
  const std::string name = fmt::format("{}{}", parametric_mass ? "generalised" : "standard", order);
  write(folder / fmt::format("{}.stiffness", name), peers.stiffness);
  write(folder / fmt::format("{}.mass", name), peers.mass);
  std::vector<std::string> rows;
  for (const Contender& c : contenders) {
    rows.push_back(fmt::format("{{\"name\": \"{}\", \"seconds\": {}, \"error\": {}}}", c.name, c.best, c.error));
  }
  return fmt::format(
      "{{\"name\": \"{}\", \"order\": {}, \"samples\": {}, \"values\": [{:.17g}], \"contenders\": [{}]}}", name, order,
      k_peer_samples, fmt::join(references.front(), ", "), fmt::join(rows, ", "));
}

}  // namespace

int main(int argc, char** argv) {
  const std::span<char*> words(argv, static_cast<std::size_t>(argc));
  if (words.size() < 4) {
    fmt::print("usage: mottle_dense_benchmark FOLDER SECONDS ORDER...      SECONDS for all contenders of an order\n");
    return words.size() == 1 ? 0 : 2;  // `make bench` runs all programs without arguments
  }
  try {
    const OpenBlas library;
    std::vector<std::string> tables;
    for (const bool parametric_mass : {false, true}) {
      for (const char* order : words.subspan(3)) {
        tables.push_back(compare(library, std::atoi(order), parametric_mass, std::atof(words[2]), words[1]));
      }
    }
    fmt::print("{{\"blas_kernel\": \"{}\", \"modes\": {}, \"tables\": [\n  {}\n]}}\n", library.kernel(), k_modes,
               fmt::join(tables, ",\n  "));
  } catch (const std::exception& error) {
    fmt::print(stderr, "mottle_dense_benchmark: {}\n", error.what());
    return 1;
  }
  return 0;
}
