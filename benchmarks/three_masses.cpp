// Clouds of the three-mass model: draw, solve, and both together, as propagation does them. `--json` prints one line
// for compare_three_masses.py.
#include "support/three_masses.hpp"

#include <fmt/format.h>

#include <string_view>

#include "mottle/updating/methods/cloud.hpp"
#include "patch_model.hpp"

namespace {

using mottle::benchmarks::seconds;

/// Best time of one call over about two seconds of calls.
template <typename Work>
double best_time(Work&& work) {
  double best = 1e300;
  for (const double end = seconds() + 2.0; seconds() < end;) {
    const double start = seconds();
    work();
    best = std::min(best, seconds() - start);
  }
  return best;
}

}  // namespace

int main(int argc, char** argv) {
  const mottle::test::ThreeMasses structure;
  constexpr int k_samples = 1000;
  constexpr int k_many = 1 << 20;
  std::uint32_t iteration = 0;
  const auto cloud = [&](int samples) {
    const mottle::updating::Cloud result =
        mottle::updating::evaluate_cloud(*structure.model, *structure.space, structure.space->prior(),
                                         {.samples = samples}, {.iteration = ++iteration}, {});
    if (result.outputs.rows() != samples) std::abort();
  };
  const Eigen::MatrixXd points =
      structure.space->draw(structure.space->prior(), mottle::stats::SamplingDesign::monte_carlo, k_many, {}).samples;
  const double one_cloud = best_time([&] { cloud(k_samples); });
  const double many = best_time([&] { cloud(k_many); }) / k_many;
  const double solve = best_time([&] { structure.model->evaluate(points, {}); }) / k_many;
  if (argc > 1 && std::string_view(argv[1]) == "--json") {
    fmt::print("{{\"cloud_1000_s\": {}, \"sample_s\": {}, \"solve_s\": {}}}\n", one_cloud, many, solve);
  } else {
    fmt::print(
        "three masses, one thread: cloud of 1000 {:.1f} us ({:.0f} a second); per sample of 2^20: drawn and "
        "solved {:.3f} us, solved {:.3f} us\n",
        1e6 * one_cloud, 1.0 / one_cloud, 1e6 * many, 1e6 * solve);
  }
  return 0;
}
