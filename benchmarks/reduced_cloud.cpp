// A cloud through the certified reduced model: what each step costs, and the true errors of some samples.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <numeric>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/formats/nastran/model.hpp"
#include "mottle/linalg/reduced/reduced_model.hpp"
#include "patch_model.hpp"

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using mottle::benchmarks::time_of;
using Lines = std::vector<std::string>;

struct Arguments {
  std::string deck;
  int patches = 0;
  std::string fields;
  int modes = 10;
  double variation = 0.1;  ///< coefficient of variation of each parameter, lognormal with mean 1
  Index samples = 1000;
  double frequency_error = 1e-4;
  Index audited = 0;  ///< samples compared with full solutions: half those with the largest bounds, half at random
  int threads = 1;
};

MatrixXd lognormal(Index samples, Index parameters, double variation, unsigned seed) {
  std::mt19937_64 random(seed);
  const double sigma = std::sqrt(std::log(1.0 + variation * variation));
  std::lognormal_distribution<double> distribution(-0.5 * sigma * sigma, sigma);
  MatrixXd x(samples, parameters);
  for (Index s = 0; s < samples; ++s) {
    for (double& value : x.row(s)) value = distribution(random);
  }
  return x;
}

mottle::linalg::TermCoefficients coefficients(const mottle::fem::AssembledModel& model, const MatrixXd& samples) {
  return mottle::fem::term_coefficients(model.stiffness, model.mass, samples);
}

/// What is kept of a cloud: its shapes are read off batch by batch.
struct Found {
  MatrixXd values, bounds;  ///< [mode x sample]
};

Found solve_cloud(const mottle::linalg::ReducedModel& reduced, const mottle::linalg::TermCoefficients& samples,
                  int threads) {
  constexpr Index k_batch = 2048;  // as in a study
  Found found;
  for (Index first = 0; first < samples.samples(); first += k_batch) {
    const Index count = std::min(k_batch, samples.samples() - first);
    const mottle::linalg::CertifiedModes part = reduced.solve(samples.range(first, count), threads);
    found.values.conservativeResize(part.values.rows(), first + count);
    found.bounds.conservativeResize(part.values.rows(), first + count);
    found.values.rightCols(count) = part.values;
    found.bounds.rightCols(count) = part.bounds;
  }
  return found;
}

/// Half of them the samples with the largest bounds, half evenly from the rest.
std::vector<Index> chosen_samples(const VectorXd& worst, Index count) {
  std::vector<Index> order(static_cast<std::size_t>(worst.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return worst(a) > worst(b); });
  const auto half = static_cast<std::size_t>(count / 2);
  std::vector<Index> chosen(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(half));
  const std::size_t step = std::max<std::size_t>(1, (order.size() - half) / std::max<std::size_t>(1, half));
  for (std::size_t i = half; i < order.size() && static_cast<Index>(chosen.size()) < count; i += step) {
    chosen.push_back(order[i]);
  }
  return chosen;
}

Lines audit(const mottle::fem::AssembledModel& model, const MatrixXd& x, const Found& found,
            const Arguments& arguments) {
  const VectorXd worst = found.bounds.colwise().maxCoeff().transpose();
  mottle::linalg::SparseModeSolver solver;
  double largest = 0.0;
  Index pairs = 0;
  Index violations = 0;
  std::vector<double> overestimates;
  for (const Index s : chosen_samples(worst, std::min(arguments.audited, x.rows()))) {
    const VectorXd at = x.row(s).transpose();
    const auto exact =
        solver.solve(model.stiffness.at(at), model.mass.at(at), {.modes = arguments.modes, .measures = false});
    for (Index r = 0; r < arguments.modes; ++r) {
      if (!std::isfinite(found.bounds(r, s))) continue;  // nothing is claimed
      const double error = found.values(r, s) / exact.values(r) - 1.0;
      ++pairs;
      if (error > found.bounds(r, s) + 1e-9 || error < -1e-9) ++violations;
      if (worst(s) <= 2.0 * arguments.frequency_error) largest = std::max(largest, 0.5 * std::abs(error));
      if (error > 1e-9) overestimates.push_back(found.bounds(r, s) / error);
    }
  }
  std::sort(overestimates.begin(), overestimates.end());
  const double middle = overestimates.empty() ? 0.0 : overestimates[overestimates.size() / 2];
  return {fmt::format("\"pairs\": {}", pairs), fmt::format("\"violations\": {}", violations),
          fmt::format("\"largest_error\": {:.3g}", largest), fmt::format("\"median_overestimate\": {:.3g}", middle)};
}

/// Refines what is not certain; how many samples remain so.
Index refine_uncertified(const mottle::linalg::ReducedModel& reduced, const mottle::linalg::TermCoefficients& samples,
                         const Arguments& arguments, Found& found, Index& refined, double& seconds) {
  std::vector<Index> rows;
  for (Index s = 0; s < found.bounds.cols(); ++s) {
    if (!(0.5 * found.bounds.col(s).maxCoeff() <= arguments.frequency_error)) rows.push_back(s);
  }
  if (rows.empty()) return 0;
  const mottle::linalg::TermCoefficients uncertified{samples.stiffness(Eigen::all, rows),
                                                     samples.mass(Eigen::all, rows)};
  seconds = time_of([&] {
    reduced.refine(uncertified, arguments.threads, [&](Index i, const mottle::linalg::RefinedModes& modes) {
      const Index s = rows[static_cast<std::size_t>(i)];
      found.values.col(s) = modes.values;
      found.bounds.col(s) = modes.bounds;
    });
  });
  for (const Index s : rows) {
    if (0.5 * found.bounds.col(s).maxCoeff() <= arguments.frequency_error) ++refined;
  }
  return static_cast<Index>(rows.size()) - refined;
}

Lines run(const Arguments& arguments) {
  mottle::formats::NastranModel deck = mottle::formats::read_nastran_model(arguments.deck);
  const auto targets = mottle::model::find_field_targets(
      deck.model, mottle::benchmarks::patch_parameters(arguments.patches, arguments.fields));
  const mottle::fem::AssembledModel model = mottle::fem::assemble(deck.model, targets.parameters);
  const auto parameters = static_cast<Index>(targets.parameters.size());
  const VectorXd ones = VectorXd::Ones(parameters);
  const auto k = model.stiffness.at(ones);
  const auto m = model.mass.at(ones);
  const double exact = mottle::benchmarks::best_time(3.0, [&] {
    mottle::linalg::SparseModeSolver solver;
    solver.solve(k, m, {.modes = arguments.modes, .measures = false});
  });
  const MatrixXd x = lognormal(arguments.samples, parameters, arguments.variation, 2);
  const MatrixXd training = lognormal(400, parameters, arguments.variation, 1);
  std::unique_ptr<mottle::linalg::ReducedModel> reduced;
  const double begun = time_of([&] {
    reduced = std::make_unique<mottle::linalg::ReducedModel>(
        mottle::fem::pencil_terms(model.stiffness, model.mass), coefficients(model, ones.transpose()), k, m,
        mottle::linalg::ReducedModelOptions{.modes = arguments.modes, .tolerance = 2.0 * arguments.frequency_error});
  });
  const double trained = time_of([&] { reduced->train(coefficients(model, training), arguments.threads); });
  Found found;
  const double solved = time_of([&] { found = solve_cloud(*reduced, coefficients(model, x), arguments.threads); });
  Index refined = 0;
  double refining = 0.0;
  const Index uncertified = refine_uncertified(*reduced, coefficients(model, x), arguments, found, refined, refining);
  Lines lines{
      fmt::format("\"equations\": {}", k.rows()),        fmt::format("\"exact_s\": {:.4g}", exact),
      fmt::format("\"begin_s\": {:.4g}", begun),         fmt::format("\"train_s\": {:.4g}", trained),
      fmt::format("\"cloud_s\": {:.4g}", solved),        fmt::format("\"vectors\": {}", reduced->basis().cols()),
      fmt::format("\"samples\": {}", arguments.samples), fmt::format("\"refined\": {}", refined),
      fmt::format("\"refine_s\": {:.4g}", refining),     fmt::format("\"unsure\": {}", uncertified)};
  if (arguments.audited > 0) {
    const Lines audited = audit(model, x, found, arguments);
    lines.insert(lines.end(), audited.begin(), audited.end());
  }
  return lines;
}

}  // namespace

int main(int argc, char** argv) {
  const std::span<char*> words(argv, static_cast<std::size_t>(argc));
  if (words.size() < 9) {
    fmt::print(
        "usage: mottle_cloud_benchmark DECK PATCHES E|RHO|E+RHO MODES VARIATION SAMPLES ERROR AUDITED [THREADS]\n");
    return words.size() == 1 ? 0 : 2;  // `make bench` runs all programs without arguments
  }
  try {
    Arguments arguments{words[1],
                        std::atoi(words[2]),
                        words[3],
                        std::atoi(words[4]),
                        std::atof(words[5]),
                        std::atoi(words[6]),
                        std::atof(words[7]),
                        std::atoi(words[8])};
    if (words.size() > 9) arguments.threads = std::atoi(words[9]);
    fmt::print("{{{}}}\n", fmt::join(run(arguments), ", "));
  } catch (const std::exception& error) {
    fmt::print(stderr, "mottle_cloud_benchmark: {}\n", error.what());
    return 1;
  }
  return 0;
}
