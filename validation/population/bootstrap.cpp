// Coverage of the intervals by bootstrap on the three masses, linear around their true parameters.
//
//   mottle_bootstrap_coverage SPECIMENS NOISE DEVIATION MISSING REPLICATIONS SAMPLES [linear|modal [INTERVALS]]
//
// DEVIATION: true standard deviation of k1, k2, k5, whose means are 1. NOISE: standard deviation of the measurement as
// a part of what a deviation of 0.2 makes the outputs scatter, given to the method as repeatability. MISSING: part of
// the entries. SAMPLES: of each bootstrap. The linear model makes replications cheap; its intervals rest on the same
// pivots as those of any other. Prints one JSON object: how often each interval holds the truth.
#include <fmt/format.h>

#include <chrono>
#include <iostream>
#include <limits>
#include <string>
#include <vector>

#include "mottle/core/parallel.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/updating/methods/maximum_likelihood.hpp"
#include "support/linear_model.hpp"
#include "support/three_masses.hpp"

namespace {

using namespace mottle;
using namespace mottle::updating;

struct Settings {
  Eigen::Index specimens = 10;
  double noise = 0.0;
  double deviation = 0.2;
  double missing = 0.0;
  bool is_linear = true;
};

/// Intervals that held the truth, of those that say something.
struct Count {
  double covered = 0.0;
  double given = 0.0;
  double width = 0.0;

  void add(double low, double high, double truth) {
    if (std::isnan(low)) return;
    given += 1.0;
    covered += low <= truth && truth <= high ? 1.0 : 0.0;
    width += high - low;
  }
};

struct Counts {
  Count mean, deviation, correlation;
  double failed = 0.0;
};

Eigen::MatrixXd measure(const Model& model, const Settings& settings, const Eigen::VectorXd& noise,
                        std::uint32_t replication) {
  const StreamKey key{.seed = 20141, .purpose = StreamPurpose::truth, .iteration = replication};
  Eigen::MatrixXd x(settings.specimens, 3);
  std::vector<RandomStream> streams;
  for (Eigen::Index s = 0; s < x.rows(); ++s) {
    streams.emplace_back(key, static_cast<std::uint32_t>(s));
    for (double& value : x.row(s))
      value = 1.0 + settings.deviation * standard_normal_quantile(streams.back().uniform());
  }
  Eigen::MatrixXd tests = model.evaluate(x, {}).outputs;
  for (Eigen::Index s = 0; s < x.rows(); ++s) {
    RandomStream& stream = streams[static_cast<std::size_t>(s)];
    for (Eigen::Index k = 0; k < 3; ++k) tests(s, k) += noise(k) * standard_normal_quantile(stream.uniform());
    // Every specimen keeps an entry; with as many specimens as are drawn here, every output keeps two.
    const auto kept = static_cast<Eigen::Index>(3.0 * stream.uniform());
    for (Eigen::Index k = 0; k < 3; ++k) {
      if (stream.uniform() < settings.missing && k != kept) tests(s, k) = std::numeric_limits<double>::quiet_NaN();
    }
  }
  return tests;
}

/// What all replications share.
struct Bench {
  explicit Bench(const Settings& settings) {
    const Eigen::Vector3d truth = Eigen::Vector3d::Ones();
    const Eigen::MatrixXd slope = structure.model->jacobian(truth);
    const Eigen::VectorXd outputs = structure.model->evaluate(truth.transpose(), {}).outputs.row(0);
    linear = std::make_unique<test::LinearModel>(outputs - slope * truth, slope);
    noise = settings.noise * 0.2 * slope.rowwise().norm();
    // Bounds would hold means that the border drives far away; they are another matter.
    std::vector<Parameter> parameters = structure.space->parameters();
    for (Parameter& parameter : parameters) {
      parameter.lower_bound = -1e6;
      parameter.upper_bound = 1e6;
      if (settings.is_linear) parameter.limit = {-1e9, false};
    }
    space = std::make_unique<ParameterSpace>(parameters, structure.space->prior());
  }

  test::ThreeMasses structure;
  std::unique_ptr<test::LinearModel> linear;
  std::unique_ptr<ParameterSpace> space;
  Eigen::VectorXd noise;
};

Counts replicate(const Settings& settings, const Bench& bench, const MaximumLikelihoodOptions& options,
                 std::uint32_t replication) {
  Counts counts;
  const test::LinearModel linear = *bench.linear;  // it counts its runs: one a thread
  const Model& model = settings.is_linear ? static_cast<const Model&>(linear) : *bench.structure.model;
  const UpdatingProblem problem{.model = model,
                                .space = *bench.space,
                                .tests = {measure(model, settings, bench.noise, replication), bench.noise},
                                .cloud = {.samples = 10, .max_failed = 1.0}};
  try {
    const UpdatingResult result = MaximumLikelihoodUpdater(options).update(problem, {.seed = replication + 1});
    const ParameterIntervals& ends = *result.intervals;
    for (Eigen::Index i = 0; i < 3; ++i) {
      counts.mean.add(ends.mean(i, 0), ends.mean(i, 1), 1.0);
      counts.deviation.add(ends.std(i, 0), ends.std(i, 1), settings.deviation);
      for (Eigen::Index j = 0; j < i && settings.deviation > 0.0; ++j) {
        counts.correlation.add(ends.correlation_lower(i, j), ends.correlation_upper(i, j), 0.0);
      }
    }
  } catch (const std::exception& error) {
    std::cerr << fmt::format("replication {}: {}\n", replication, error.what());
    counts.failed = 1.0;
  }
  return counts;
}

std::string text_of(const std::string& name, const std::vector<Counts>& all, Count Counts::*member) {
  Count sum;
  for (const Counts& one : all) {
    sum.covered += (one.*member).covered;
    sum.given += (one.*member).given;
    sum.width += (one.*member).width;
  }
  const double given = std::max(sum.given, 1.0);
  return fmt::format("\"{0}\": {1:.4f}, \"{0}_given\": {2}, \"{0}_width\": {3:.4f}", name, sum.covered / given,
                     sum.given, sum.width / given);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 7) {
    std::cerr << "usage: SPECIMENS NOISE DEVIATION MISSING REPLICATIONS SAMPLES [linear|modal [INTERVALS]]\n";
    return 2;
  }
  const Settings settings{.specimens = std::stoi(argv[1]),
                          .noise = std::stod(argv[2]),
                          .deviation = std::stod(argv[3]),
                          .missing = std::stod(argv[4]),
                          .is_linear = argc < 8 || std::string(argv[7]) == "linear"};
  using Intervals = MaximumLikelihoodOptions::Intervals;
  const bool is_analytic = argc > 8 && std::string(argv[8]) == "analytic";
  const MaximumLikelihoodOptions options{.intervals = is_analytic ? Intervals::analytic : Intervals::bootstrap,
                                         .bootstrap_samples = std::stoi(argv[6])};
  const Bench bench(settings);
  std::vector<Counts> counts(static_cast<std::size_t>(std::stoi(argv[5])));
  const auto start = std::chrono::steady_clock::now();
  parallel_for(
      static_cast<std::int64_t>(counts.size()), 1, available_threads(), [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t r = begin; r < end; ++r)
          counts[static_cast<std::size_t>(r)] = replicate(settings, bench, options, static_cast<std::uint32_t>(r));
      });
  double failed = 0.0;
  for (const Counts& one : counts) failed += one.failed;
  fmt::print("{{{}, {}, {}, \"failed\": {}, \"seconds\": {:.1f}}}\n", text_of("mean", counts, &Counts::mean),
             text_of("deviation", counts, &Counts::deviation), text_of("correlation", counts, &Counts::correlation),
             failed, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  return 0;
}
