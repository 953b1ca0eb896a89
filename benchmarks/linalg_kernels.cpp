// Time a solve (counter `solve`) of the batch eigenproblem, ours beside Eigen's solvers. Run alone on one core: taskset
// -c 0.
#include <benchmark/benchmark.h>

#include <Eigen/Eigenvalues>
#include <random>

#include "mottle/linalg/batched/batch_eigen.hpp"
#include "mottle/linalg/batched/dense_modes.hpp"

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr Index k_terms = 5;

MatrixXd uniform(Index rows, Index columns, double low, double high, std::mt19937_64& random) {
  std::uniform_real_distribution<double> distribution(low, high);
  MatrixXd matrix(rows, columns);
  for (double& entry : matrix.reshaped()) entry = distribution(random);
  return matrix;
}

/// Springs between all neighbours and next neighbours of a chain, split over the terms, with a full constant mass.
mottle::linalg::PencilFamily chain_family(Index order, bool parametric_mass, bool diagonal_mass) {
  mottle::linalg::PencilFamily family{
      MatrixXd::Identity(order, order) * 0.01, {}, MatrixXd::Identity(order, order) * (diagonal_mass ? 1.5 : 4.0), {}};
  family.stiffness_terms.assign(k_terms, MatrixXd::Zero(order, order));
  const auto add_spring = [&](Index a, Index b, double stiffness) {
    MatrixXd& term = family.stiffness_terms[static_cast<std::size_t>((a + b) % k_terms)];
    term(a, a) += stiffness;
    term(b, b) += stiffness;
    term(a, b) -= stiffness;
    term(b, a) -= stiffness;
  };
  for (Index i = 0; i + 1 < order; ++i) {
    add_spring(i, i + 1, 1.0);
    if (i + 2 < order) add_spring(i, i + 2, 0.3);
    if (!diagonal_mass) family.mass_constant(i, i + 1) = family.mass_constant(i + 1, i) = 1.0;
  }
  if (parametric_mass) family.mass_terms = {family.mass_constant * 0.5};
  return family;
}

struct Workload {
  mottle::linalg::PencilFamily family;
  MatrixXd stiffness_coefficients;
  MatrixXd mass_coefficients;
};

Workload workload(Index order, Index samples, bool parametric_mass = false, bool diagonal_mass = false) {
  std::mt19937_64 random(1);
  Workload work{chain_family(order, parametric_mass, diagonal_mass), uniform(k_terms, samples, 0.8, 1.2, random), {}};
  work.mass_coefficients = uniform(parametric_mass ? 1 : 0, samples, 0.8, 1.2, random);
  return work;
}

MatrixXd stiffness_of(const Workload& work, Index sample) {
  MatrixXd sum = work.family.stiffness_constant;
  for (Index i = 0; i < k_terms; ++i) {
    sum += work.stiffness_coefficients(i, sample) * work.family.stiffness_terms[static_cast<std::size_t>(i)];
  }
  return sum;
}

void report(benchmark::State& state, Index samples) {
  state.counters["solve"] = benchmark::Counter(
      static_cast<double>(samples), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void run_batch(benchmark::State& state, const Workload& work, int modes, bool vectors,
               mottle::linalg::SimdLevel level) {
  if (!mottle::linalg::is_simd_level_available(level)) return state.SkipWithError("this processor lacks the level");
  for (auto _ : state) {
    benchmark::DoNotOptimize(solve_batch(work.family, work.stiffness_coefficients, work.mass_coefficients,
                                         {.modes = modes, .vectors = vectors, .simd = level}));
  }
  report(state, work.stiffness_coefficients.cols());
}

void batch_small(benchmark::State& state, mottle::linalg::SimdLevel level) {
  run_batch(state, workload(state.range(0), 1 << 14), 0, true, level);
}

void batch_small_values(benchmark::State& state) {
  run_batch(state, workload(state.range(0), 1 << 14), 0, false, mottle::linalg::SimdLevel::automatic);
}

void batch_small_parametric_mass(benchmark::State& state) {
  run_batch(state, workload(state.range(0), 1 << 14, true), 0, true, mottle::linalg::SimdLevel::automatic);
}

void batch_lowest_10(benchmark::State& state, mottle::linalg::SimdLevel level) {
  run_batch(state, workload(state.range(0), 256), 10, true, level);
}

void batch_lowest_10_values(benchmark::State& state) {
  run_batch(state, workload(state.range(0), 256), 10, false, mottle::linalg::SimdLevel::automatic);
}

void batch_lowest_10_parametric_mass(benchmark::State& state) {
  run_batch(state, workload(state.range(0), 256, true), 10, true, mottle::linalg::SimdLevel::automatic);
}

void batch_lowest_10_diagonal_parametric_mass(benchmark::State& state) {
  run_batch(state, workload(state.range(0), 256, true, true), 10, true, mottle::linalg::SimdLevel::automatic);
}

void eigen_generalised(benchmark::State& state) {
  const Index samples = state.range(0) <= 8 ? 1024 : 16;
  const Workload work = workload(state.range(0), samples);
  for (auto _ : state) {
    for (Index sample = 0; sample < samples; ++sample) {
      const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(stiffness_of(work, sample),
                                                                      work.family.mass_constant);
      benchmark::DoNotOptimize(solver.eigenvectors().data());
    }
  }
  report(state, samples);
}

/// Eigen's closed form for 3 x 3, given the reduced matrices for nothing: its best case.
void eigen_compute_direct(benchmark::State& state) {
  constexpr Index k_samples = 1024;
  const Workload work = workload(3, k_samples);
  std::vector<Eigen::Matrix3d> matrices;
  for (Index sample = 0; sample < k_samples; ++sample) matrices.emplace_back(stiffness_of(work, sample));
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  for (auto _ : state) {
    for (const Eigen::Matrix3d& matrix : matrices) {
      solver.computeDirect(matrix);
      benchmark::DoNotOptimize(solver.eigenvectors().data());
    }
  }
  report(state, k_samples);
}

BENCHMARK_CAPTURE(batch_small, automatic, mottle::linalg::SimdLevel::automatic)->DenseRange(2, 8);
BENCHMARK_CAPTURE(batch_small, avx2, mottle::linalg::SimdLevel::avx2)->Arg(3)->Arg(8);
BENCHMARK_CAPTURE(batch_small, plain, mottle::linalg::SimdLevel::plain)->Arg(3)->Arg(8);
BENCHMARK(batch_small_values)->Arg(3)->Arg(8);
BENCHMARK(batch_small_parametric_mass)->Arg(3)->Arg(8);
BENCHMARK(eigen_compute_direct);
BENCHMARK(eigen_generalised)->Arg(3)->Arg(8)->Arg(20)->Arg(40)->Arg(80)->Arg(120);
BENCHMARK_CAPTURE(batch_lowest_10, automatic, mottle::linalg::SimdLevel::automatic)
    ->Arg(10)
    ->Arg(20)
    ->Arg(40)
    ->Arg(80)
    ->Arg(120)
    ->Arg(200);
BENCHMARK_CAPTURE(batch_lowest_10, avx2, mottle::linalg::SimdLevel::avx2)->Arg(20)->Arg(80);
BENCHMARK_CAPTURE(batch_lowest_10, plain, mottle::linalg::SimdLevel::plain)->Arg(20)->Arg(80);
BENCHMARK(batch_lowest_10_values)->Arg(40)->Arg(80);
BENCHMARK(batch_lowest_10_parametric_mass)->Arg(20)->Arg(80);
BENCHMARK(batch_lowest_10_diagonal_parametric_mass)->Arg(20)->Arg(80);

}  // namespace
