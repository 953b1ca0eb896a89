// Posteriors of populations whose answer is known, and simulation-based calibration.
//
//   mottle_hierarchical_references eight-schools|curved|oracle SEEDS
//   mottle_hierarchical_references sbc SPECIMENS NOISE DATA_SETS PARTICLES [FIRST]
//
// Prints one JSON object. NOISE: scale of the prior of the noise's level, a fraction of the frequencies.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <map>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "mottle/core/parallel.hpp"
#include "mottle/model/function_model.hpp"
#include "mottle/updating/estimate/posterior.hpp"
#include "mottle/updating/methods/hierarchical.hpp"
#include "support/eight_schools.hpp"
#include "support/three_masses.hpp"

namespace {

using namespace mottle;
using namespace mottle::updating;

std::string list(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += fmt::format("{}{:.8g}", text.empty() ? "" : ", ", value);
  return "[" + text + "]";
}

Eigen::VectorXd column(const SampledPosterior& posterior, const std::string& name) {
  const auto place = std::find(posterior.names.begin(), posterior.names.end(), name);
  require(place != posterior.names.end(), "{}: is not in the posterior", name);
  return posterior.values.col(std::distance(posterior.names.begin(), place));
}

double deviation(const Eigen::VectorXd& values) {
  return std::sqrt((values.array() - values.mean()).square().mean());
}

/// What one seed found: numbers by name.
using Numbers = std::map<std::string, double>;

Numbers common(const UpdatingResult& result) {
  const Evidence& evidence = result.posterior->evidence;
  return {{"ln_evidence", evidence.log_evidence},
          {"stated", evidence.standard_error},
          {"lower", evidence.lower},
          {"upper", evidence.upper},
          {"converged", result.status == UpdatingStatus::converged ? 1.0 : 0.0},
          {"r_hat", result.posterior->r_hat.maxCoeff()},
          {"evaluations", static_cast<double>(result.posterior->evaluations)}};
}

Numbers eight_schools(std::uint64_t seed) {
  using test::EightSchools;
  const EightSchools schools;
  const UpdatingResult result = HierarchicalUpdater(EightSchools::options()).update(schools.problem(), {.seed = seed});
  Numbers found = common(result);
  found["mu"] = column(*result.posterior, "mu:x").mean();
  found["mu_std"] = deviation(column(*result.posterior, "mu:x"));
  found["tau"] = column(*result.posterior, "sigma:x").mean();
  found["theta_1"] = result.specimens->parameters(0, 0);
  return found;
}

/// y = exp(x), three specimens, noise 0.4 as large as their scatter: mu ~ N(0, 0.5), sigma half-t with 4 degrees of
/// freedom and scale 0.5.
Numbers curved(std::uint64_t seed) {
  const FunctionModel model(1, {named_quantity("y", "-")},
                            [](const Eigen::VectorXd& x) -> Eigen::VectorXd { return x.array().exp().matrix(); });
  constexpr PhysicalLimit k_free{.lower = -1e9, .excludes_lower = false};
  const Distribution prior({.kind = DistributionKind::normal, .mean = 0.0, .std = 0.5});
  const ParameterSpace space({{"x", "-", -50.0, 50.0, k_free}}, JointDistribution({prior}));
  const UpdatingProblem problem{.model = model,
                                .space = space,
                                .tests = {Eigen::Vector3d(0.5, 1.4, 2.3), Eigen::VectorXd::Constant(1, 0.4)},
                                .cloud = {.samples = 20}};
  const UpdatingResult result = HierarchicalUpdater({}).update(problem, {.seed = seed});
  Numbers found = common(result);
  found["mu"] = column(*result.posterior, "mu:x").mean();
  found["mu_std"] = deviation(column(*result.posterior, "mu:x"));
  found["sigma"] = column(*result.posterior, "sigma:x").mean();
  found["x_1"] = column(*result.posterior, "x:1").mean();
  return found;
}

/// oracle10.csv with noise of 1e-5, a normal prior of standard deviation 5 of each mean, and an inverse-Wishart prior
/// of the covariance with nu = 0.5 and a = 0.05.
Numbers oracle(std::uint64_t seed) {
  const test::ThreeMasses structure;
  const Distribution wide({.kind = DistributionKind::normal, .mean = 1.0, .std = 5.0});
  std::vector<Parameter> parameters = structure.space->parameters();
  for (Parameter& parameter : parameters) {
    parameter.lower_bound = 0.05;
    parameter.upper_bound = 50.0;
  }
  const ParameterSpace space(parameters, JointDistribution({wide, wide, wide}));
  const Eigen::MatrixXd z = test::frequencies_of(structure, test::oracle_parameters());
  HierarchicalOptions options;
  options.covariance_prior = HierarchicalOptions::CovariancePrior::inverse_wishart;
  options.scatter_degrees_of_freedom = 0.5;
  options.scatter_scale = 0.01;
  options.particles = 300;
  options.decorrelation = 0.3;
  const UpdatingProblem problem{.model = *structure.model,
                                .derivatives = structure.model.get(),
                                .space = space,
                                .tests = {z, 1e-5 * z.colwise().mean().transpose()},
                                .cloud = {.samples = 20}};
  const UpdatingResult result = HierarchicalUpdater(options).update(problem, {.seed = seed});
  Numbers found = common(result);
  for (const std::string& name : space.names()) {
    Eigen::VectorXd mu = column(*result.posterior, "mu:" + name);
    found["mu_" + name] = mu.mean();
    found["mu_std_" + name] = deviation(mu);
    found["sigma_" + name] = column(*result.posterior, "sigma:" + name).mean();
    std::sort(mu.begin(), mu.end());
    const auto at = [&](double probability) {
      return mu(static_cast<Eigen::Index>(probability * static_cast<double>(mu.size())));
    };
    found["half_width_" + name] = 0.5 * (at(0.975) - at(0.025));
  }
  return found;
}

template <typename Run>
void print_seeds(int seeds, const Run& run) {
  std::vector<Numbers> found(static_cast<std::size_t>(seeds));
  const auto start = std::chrono::steady_clock::now();
  parallel_for(seeds, 1, 1, [&](std::int64_t begin, std::int64_t) {
    found[static_cast<std::size_t>(begin)] = run(static_cast<std::uint64_t>(begin) + 1);
  });
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::string text = fmt::format("{{\"seeds\": {}, \"seconds\": {:.3f}", seeds, seconds / seeds);
  for (const auto& [name, first] : found.front()) {
    std::vector<double> values;
    for (const Numbers& seed : found) values.push_back(seed.at(name));
    text += fmt::format(", \"{}\": {}", name, list(values));
  }
  std::cout << text << "}\n";
}

/// Two stiffnesses of the three masses, log-normal: of the mean's prior mean 1.5 and standard deviation 0.3; scatter
/// and correlation as the method's defaults have them; the noise's level inverse gamma with 20 degrees of freedom.
struct Calibration {
  explicit Calibration(double noise) {
    const std::vector<ParameterTargets> targets{{"k1", {"spring:k1"}}, {"k5", {"spring:k5"}}};
    std::vector<Parameter> parameters;
    for (const ParameterTargets& target : targets) {
      parameters.push_back({target.parameter, "N/m"});
      parameters.back().transform.kind = ParameterTransform::Kind::log;
    }
    const Distribution prior({.kind = DistributionKind::lognormal, .mean = 1.5, .std = 0.3});
    space = std::make_unique<ParameterSpace>(parameters, JointDistribution({prior, prior}));
    model =
        std::make_unique<StructureModel>(separate(test::three_mass_system(), targets),
                                         OutputSelection{.frequencies = {1, 2, 3}}, Eigen::VectorXd::Constant(2, 1.5));
    options.noise_prior = BayesOptions::NoisePrior::inverse_gamma;
    options.noise_degrees_of_freedom = 20.0;
    options.noise_scale = noise;
    options.decorrelation = 0.3;
  }
  std::unique_ptr<ParameterSpace> space;
  std::unique_ptr<StructureModel> model;
  HierarchicalOptions options;
};

const std::vector<std::string> k_ranked = {"mu:k1",     "mu:k5",   "sigma:k1",      "sigma:k5",
                                           "rho:k1:k5", "noise:f", "log_likelihood"};

/// Numbers of k_ranked that a data set was made with, and its tests.
struct DataSet {
  std::vector<double> truth;
  Eigen::MatrixXd tests;
  Eigen::MatrixXd outputs;  ///< without noise
};

DataSet draw(const Calibration& calibration, Eigen::Index specimens, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const double variance = std::log1p(0.04);
  const double nu = calibration.options.scatter_degrees_of_freedom;
  DataSet made;
  Eigen::Vector2d mu;
  Eigen::Vector2d sigma;
  for (double& value : mu) value = std::log(1.5) - 0.5 * variance + std::sqrt(variance) * normal(random);
  for (double& value : sigma) {
    std::chi_squared_distribution<double> chi_squared(nu);
    value = std::sqrt(variance) * std::abs(normal(random)) / std::sqrt(chi_squared(random) / nu);
  }
  std::gamma_distribution<double> gamma(calibration.options.correlation_shape);
  const double first = gamma(random);
  const double rho = 2.0 * first / (first + gamma(random)) - 1.0;
  const double freedom = calibration.options.noise_degrees_of_freedom;
  std::chi_squared_distribution<double> chi_squared(freedom);
  const double level = calibration.options.noise_scale * std::sqrt(freedom / chi_squared(random));
  Eigen::MatrixXd x(specimens, 2);
  for (Eigen::Index s = 0; s < specimens; ++s) {
    const double w = normal(random);
    x(s, 0) = std::exp(mu(0) + sigma(0) * w);
    x(s, 1) = std::exp(mu(1) + sigma(1) * (rho * w + std::sqrt(1.0 - rho * rho) * normal(random)));
  }
  made.outputs = calibration.model->evaluate(x, {}).outputs;
  made.tests = made.outputs;
  for (Eigen::Index k = 0; k < made.tests.cols(); ++k) {
    const double size = std::sqrt(made.outputs.col(k).squaredNorm() / static_cast<double>(specimens));
    for (double& value : made.tests.col(k)) value += level * size * normal(random);
  }
  made.truth = {mu(0), mu(1), sigma(0), sigma(1), rho, level};
  double log_likelihood = 0.0;
  for (Eigen::Index k = 0; k < made.tests.cols(); ++k) {
    const double noise = level * std::sqrt(made.tests.col(k).squaredNorm() / static_cast<double>(specimens));
    log_likelihood -= 0.5 * (made.tests.col(k) - made.outputs.col(k)).squaredNorm() / (noise * noise) +
                      static_cast<double>(specimens) * std::log(noise * std::sqrt(2.0 * std::numbers::pi));
  }
  made.truth.push_back(log_likelihood);
  return made;
}

constexpr Eigen::Index k_ranks = 100;  // draws that a truth is ranked among, thinned evenly from all

std::vector<double> ranks_of(const Calibration& calibration, const DataSet& data, std::uint64_t seed,
                             double& converged) {
  const UpdatingProblem problem{.model = *calibration.model,
                                .derivatives = calibration.model.get(),
                                .space = *calibration.space,
                                .tests = {data.tests, Eigen::VectorXd::Zero(3)},
                                .cloud = {.samples = 20}};
  const UpdatingResult result = HierarchicalUpdater(calibration.options).update(problem, {.seed = seed});
  converged += result.status == UpdatingStatus::converged ? 1.0 : 0.0;
  std::vector<double> ranks;
  for (std::size_t k = 0; k < k_ranked.size(); ++k) {
    const Eigen::VectorXd draws =
        k_ranked[k] == "log_likelihood" ? result.posterior->log_likelihood : column(*result.posterior, k_ranked[k]);
    double rank = 0.0;
    for (Eigen::Index i = 0; i < k_ranks; ++i) rank += draws(i * draws.size() / k_ranks) < data.truth[k] ? 1.0 : 0.0;
    ranks.push_back(rank);
  }
  return ranks;
}

/// @param first  number of the first data set, from 1
void calibrate(Eigen::Index specimens, double noise, int data_sets, int particles, int first) {
  Calibration calibration(noise);
  calibration.options.particles = particles;
  const auto start = std::chrono::steady_clock::now();
  std::string rows;
  double converged = 0.0;
  int failed = 0;
  for (int i = 0; i < data_sets; ++i) {
    const auto seed = static_cast<std::uint64_t>(i) + static_cast<std::uint64_t>(first);
    try {
      const auto own = static_cast<std::uint64_t>(specimens) * 1000000U + static_cast<std::uint64_t>(1e6 * noise);
      const DataSet data = draw(calibration, specimens, own * 1000U + seed);  // other data sets in every case
      rows += (rows.empty() ? "" : ", ") + list(ranks_of(calibration, data, seed, converged));
    } catch (const std::exception& error) {
      std::cerr << "data set " << seed << ": " << error.what() << '\n';
      ++failed;
    }
  }
  std::string names;
  for (const std::string& name : k_ranked) names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", name);
  std::cout << fmt::format(
      "{{\"data_sets\": {}, \"failed\": {}, \"draws\": {}, \"converged\": {:.4f}, \"seconds\": {:.4f}, \"names\": "
      "[{}], "
      "\"ranks\": [{}]}}\n",
      data_sets, failed, k_ranks, converged / data_sets,
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / data_sets, names, rows);
}

}  // namespace

int main(int count, char** arguments) {
  try {
    require(count >= 3,
            "usage: mottle_hierarchical_references eight-schools|curved|oracle SEEDS, or sbc SPECIMENS NOISE "
            "DATA_SETS PARTICLES [FIRST]");
    const std::string name = arguments[1];
    if (name == "eight-schools") {
      print_seeds(std::stoi(arguments[2]), eight_schools);
    } else if (name == "curved") {
      print_seeds(std::stoi(arguments[2]), curved);
    } else if (name == "oracle") {
      print_seeds(std::stoi(arguments[2]), oracle);
    } else {
      require(name == "sbc" && (count == 6 || count == 7),
              "the case is eight-schools, curved, oracle or sbc SPECIMENS NOISE DATA_SETS PARTICLES [FIRST]");
      calibrate(std::stoi(arguments[2]), std::stod(arguments[3]), std::stoi(arguments[4]), std::stoi(arguments[5]),
                count == 7 ? std::stoi(arguments[6]) : 1);
    }
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
}
