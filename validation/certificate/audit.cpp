// Bounds of the reduced model, as solved and as refined, against dense solutions, for families made to break them.
//
//   mottle_certificate_audit [SEED [SHARE [NAME]]]
//
// writes the table of RESULTS.md to the standard output: SHARE of the samples of each family (1 by default), only the
// families whose names hold NAME. It ends with 1 where a bound is violated.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "linalg/hostile_families.hpp"

namespace {

using namespace mottle::test;
using mottle::linalg::CertifiedModes;
using mottle::linalg::RefinedModes;
using mottle::linalg::TermCoefficients;

constexpr double k_tolerance = 2e-4;

struct Audit {
  Index pairs = 0, violations = 0, samples = 0, in_full = 0, certain = 0;
  double largest = 0.0;  ///< error over bound
  std::vector<double> overestimates;

  /// One sample's values and bounds.
  void compare(const VectorXd& values, const VectorXd& bounds, const VectorXd& exact) {
    constexpr double k_rounding = 1e-9;  // of the dense solution, of the largest value
    for (Index k = 0; k < values.size(); ++k) {
      if (!std::isfinite(bounds(k))) continue;  // nothing is claimed
      ++pairs;
      if (exact.size() == 0) {  // a bound for a pencil that is not definite
        ++violations;
        continue;
      }
      const double error = values(k) - exact(k), rounding = k_rounding * exact(exact.size() - 1);
      const double allowed = bounds(k) * std::max(values(k), rounding);
      if (error > allowed + rounding || error < -rounding) ++violations;
      if (allowed > 3.0 * rounding) largest = std::max(largest, error / allowed);
      if (error > 3.0 * rounding) overestimates.push_back(allowed / error);
    }
  }

  double median() {
    if (overestimates.empty()) return std::numeric_limits<double>::quiet_NaN();
    const auto middle = overestimates.begin() + static_cast<std::ptrdiff_t>(overestimates.size() / 2);
    std::nth_element(overestimates.begin(), middle, overestimates.end());
    return *middle;
  }
};

Audit audit(const HostileFamily& hostile, Index samples, unsigned seed) {
  const mottle::linalg::ReducedModel model = hostile.trained(k_tolerance, seed);
  const TermCoefficients cloud = hostile.draw(samples, seed + 1);
  const CertifiedModes found = model.solve(cloud, 1);
  std::vector<VectorXd> exact;
  std::vector<Index> uncertified;
  Audit result;
  result.samples = samples;
  for (Index s = 0; s < samples; ++s) {
    exact.push_back(exact_values(hostile.family, cloud, s, hostile.modes));
    result.compare(found.values.col(s), found.bounds.col(s), exact.back());
    if (!(found.bounds.col(s).maxCoeff() <= k_tolerance)) uncertified.push_back(s);
  }
  const TermCoefficients rest{cloud.stiffness(Eigen::all, uncertified), cloud.mass(Eigen::all, uncertified)};
  model.refine(rest, 1, [&](Index i, const RefinedModes& modes) {
    if (modes.vectors.cols() > 0) {
      result.compare(modes.values, modes.bounds,
                     exact[static_cast<std::size_t>(uncertified[static_cast<std::size_t>(i)])]);
    }
    if (!(modes.bounds.maxCoeff() <= k_tolerance)) ++result.in_full;
  });
  return result;
}

struct Entry {
  HostileFamily family;
  Index samples;
};

std::vector<Entry> entries(unsigned seed) {
  std::vector<Entry> all{
      {tension_of_both_signs(200, 0.0), 100},
      {tension_of_both_signs(200, 1e-5), 100},
      {tension_of_both_signs(70, 0.0), 500},
      {tension_of_both_signs(70, 1e-5), 500},
      {mass_moved(70, 0.0), 500},
      {mass_moved(70, 1e-5), 500},
      {loaded_columns(60), 500},
      {preload_around_zero(18, 10), 500},
      {subsystems(70, 0.0, 0.3), 500},
      {subsystems(70, 1e-3, 0.3), 500},
      {symmetric_halves(100, 0.002), 500},
      {pairs_at_the_edge(100, 0.1), 500},
      {pairs_at_the_edge(100, 1e-5), 500},
      {near_mechanism(80), 500},
      {light_masses(90), 500},
      {wide_uniform(18, 10, false), 500},
      {wide_uniform(18, 10, true), 500},
      {one_soft_in_a_thousand(16, 9), 2000},
      {blind_basis(70, 1e-4), 500},
      {blind_basis(70, 1e-2), 500},
      {oscillators_above_the_edge(160, 1.1, 1e-5), 300},
      {oscillators_above_the_edge(160, 1.02, 1e-5), 300},
      {oscillators_above_the_edge(160, 1.005, 1e-5), 300},
      {free_body_with_tension(16, 9), 500},
  };
  for (unsigned i = 0; i < 10; ++i) {
    all.push_back({random_terms(120 + 5 * static_cast<int>(i), seed + i, false), 200});
    all.push_back({random_terms(120 + 5 * static_cast<int>(i), seed + 50 + i, true), 200});
  }
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  const std::span<char*> words(argv, static_cast<std::size_t>(argc));
  const auto seed = static_cast<unsigned>(words.size() > 1 ? std::atoi(words[1]) : 1);
  const double share = words.size() > 2 ? std::atof(words[2]) : 1.0;
  const std::string name = words.size() > 3 ? words[3] : "";
  Index pairs = 0, violations = 0;
  fmt::print(
      "| family | equations | pairs | violations | largest error / bound | median bound / error | in full |\n"
      "|---|---|---|---|---|---|---|\n");
  for (const Entry& entry : entries(seed)) {
    if (entry.family.name.find(name) == std::string::npos) continue;
    const auto samples = static_cast<Index>(std::ceil(share * static_cast<double>(entry.samples)));
    Audit seen = audit(entry.family, samples, seed);
    pairs += seen.pairs;
    violations += seen.violations;
    fmt::print("| {} | {} | {} | {} | {:.2g} | {:.1f} | {:.1f} % |\n", entry.family.name, entry.family.family.size(),
               seen.pairs, seen.violations, seen.largest, seen.median(),
               100.0 * static_cast<double>(seen.in_full) / static_cast<double>(samples));
    std::fflush(stdout);
  }
  fmt::print("| all | | {} | {} | | | |\n", pairs, violations);
  return violations == 0 ? 0 : 1;
}
