// The three-mass eigenproblem alone, samples given: our batch beside Eigen's generic generalised solver and an
// OpenTURNS function written in C++ around Eigen's closed form. Prints one line of JSON for compare_three_masses.py.
#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <openturns/EvaluationImplementation.hxx>
#include <openturns/Function.hxx>
#include <random>
#include <string>
#include <vector>

#include "eigen_peers.hpp"
#include "mottle/core/error.hpp"
#include "mottle/linalg/batched/batch_eigen.hpp"
#include "patch_model.hpp"

namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;

constexpr Index k_samples = 1 << 14;

Matrix3d stiffness(double k1, double k2, double k5) {
  constexpr double k3 = 1.0, k4 = 1.0, k6 = 3.0;
  Matrix3d k;
  k << k1 + k4 + k6, -k4, -k6, -k4, k2 + k4 + k5, -k5, -k6, -k5, k3 + k5 + k6;
  return k;
}

mottle::linalg::PencilFamily family() {
  const Matrix3d constant = stiffness(0.0, 0.0, 0.0);
  return {
      constant,
      {stiffness(1.0, 0.0, 0.0) - constant, stiffness(0.0, 1.0, 0.0) - constant, stiffness(0.0, 0.0, 1.0) - constant},
      Matrix3d::Identity(),
      {}};
}

/// (k1, k2, k5) -> three frequencies, and the shapes if they are wanted; whole samples in one loop, its best case.
class ClosedForm : public OT::EvaluationImplementation {
 public:
  explicit ClosedForm(bool vectors) : vectors_(vectors) {}
  ClosedForm* clone() const override { return new ClosedForm(*this); }
  OT::UnsignedInteger getInputDimension() const override { return 3; }
  OT::UnsignedInteger getOutputDimension() const override { return vectors_ ? 12 : 3; }
  OT::Point operator()(const OT::Point& x) const override { return operator()(OT::Sample(1, x))[0]; }
  OT::Sample operator()(const OT::Sample& x) const override {
    const auto count = static_cast<Index>(x.getSize());
    MatrixXd matrices(9, count), values(3, count), shapes(vectors_ ? 9 : 0, count);
    const double* const in = x.data();
    for (Index i = 0; i < count; ++i) {
      Matrix3d::Map(matrices.col(i).data()) = stiffness(in[3 * i], in[3 * i + 1], in[3 * i + 2]);
    }
    mottle::benchmarks::eigen_compute_direct(count, matrices.data(), values.data(), vectors_ ? shapes.data() : nullptr);
    OT::Sample result(x.getSize(), getOutputDimension());
    for (Index i = 0; i < count; ++i) {
      double* const out = &result(static_cast<OT::UnsignedInteger>(i), 0);
      for (Index r = 0; r < 3; ++r) out[r] = std::sqrt(values(r, i)) / (2.0 * std::numbers::pi);
      if (vectors_) std::copy_n(shapes.col(i).data(), 9, out + 3);
    }
    return result;
  }

 private:
  bool vectors_;
};

MatrixXd draw() {
  std::mt19937_64 random(1);
  std::normal_distribution<double> distribution(2.0, 0.3);
  MatrixXd samples(3, k_samples);
  for (double& x : samples.reshaped()) x = distribution(random);
  return samples;
}

void eigen_generic(const MatrixXd& samples, MatrixXd& values) {
  MatrixXd shapes(3, 3);
  const Matrix3d mass = Matrix3d::Identity();
  for (Index i = 0; i < samples.cols(); ++i) {
    const Matrix3d k = stiffness(samples(0, i), samples(1, i), samples(2, i));
    mottle::benchmarks::eigen_generalised(3, 3, k.data(), mass.data(), values.col(i).data(), shapes.data());
  }
}

/// us a sample.
template <typename Work>
double best_of(Work&& work) {
  double best = 1e300;
  for (const double end = mottle::benchmarks::seconds() + 1.5; mottle::benchmarks::seconds() < end;) {
    best = std::min(best, mottle::benchmarks::time_of(work));
  }
  return 1e6 * best / static_cast<double>(k_samples);
}

void run() {
  const MatrixXd samples = draw();
  const mottle::linalg::PencilFamily pencils = family();
  mottle::linalg::BatchModes modes;
  const auto ours = [&](bool vectors) {
    return best_of([&] { modes = solve_batch(pencils, samples, MatrixXd(), {.vectors = vectors}); });
  };
  const double with_vectors = ours(true), values_alone = ours(false);
  MatrixXd values(3, k_samples);
  const double generic = best_of([&] { eigen_generic(samples, values); });
  mottle::require((values - modes.values).cwiseAbs().maxCoeff() < 1e-12, "Eigen's and our eigenvalues differ");
  OT::Sample x(static_cast<OT::UnsignedInteger>(k_samples), 3);
  std::copy_n(samples.data(), samples.size(), &x(0, 0));
  const auto openturns = [&](bool vectors) {
    const OT::Function function{ClosedForm(vectors)};
    OT::Sample y;
    const double time = best_of([&] { y = function(x); });
    mottle::require(std::abs(y(7, 0) * 2.0 * std::numbers::pi - std::sqrt(modes.values(0, 7))) < 1e-6,
                    "the closed form's and our frequencies differ");
    return time;
  };
  fmt::print(
      "{{\"ours\": {}, \"ours_values\": {}, \"eigen_generic\": {}, \"openturns\": {}, \"openturns_values\": {}}}\n",
      with_vectors, values_alone, generic, openturns(true), openturns(false));
}

}  // namespace

int main() {
  try {
    run();
  } catch (const std::exception& error) {
    fmt::print(stderr, "mottle_three_masses_peers_benchmark: {}\n", error.what());
    return 1;
  }
  return 0;
}
