// Cases of the method `interval` that carry their own answer; prints one JSON object. See README.md.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "mottle/linalg/batched/dense_modes.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/updating/methods/interval.hpp"
#include "support/linear_model.hpp"
#include "support/parameter_pencils.hpp"
#include "support/three_masses.hpp"
#include "updating/methods/specimen_bounds.hpp"

using namespace mottle;
using namespace mottle::updating;
using Json = nlohmann::ordered_json;

namespace {

constexpr StreamPurpose k_purpose = StreamPurpose::truth;

Json list(const Eigen::VectorXd& values) {
  return std::vector<double>(values.begin(), values.end());
}

/// By the whole matrices at each point, assembled by the structure itself [point x mode].
Eigen::MatrixXd dense_eigenvalues(const StructureModel& model, const Eigen::MatrixXd& points) {
  const auto& structure = dynamic_cast<const SparseStructure&>(model.structure());
  Eigen::MatrixXd values(points.rows(), structure.mode_count());
  for (Eigen::Index s = 0; s < points.rows(); ++s) {
    const SparseStructure::Matrices matrices = structure.matrices_at(points.row(s).transpose());
    values.row(s) = solve_modes(Eigen::MatrixXd(matrices.stiffness), Eigen::MatrixXd(matrices.mass)).values.transpose();
  }
  return values;
}

/// Random boxes of random pencils: the proven ranges against all corners and 200 points in each.
Json enclosures(std::uint32_t cases) {
  constexpr double k_tolerance = 1e-2;
  int violations = 0, mixed = 0, unfinished = 0;
  double worst_gap = 0.0;
  std::int64_t values = 0, solutions = 0;
  for (std::uint32_t number = 0; number < cases; ++number) {
    test::RandomPencil random(2011, number);
    const EigenvalueBounds bounds(*random.model);
    const EigenvalueRanges found =
        bounds.over(random.box, random.order, {.tolerance = k_tolerance, .max_solutions = 5000}, {});
    const int corners = 1 << random.parameters;
    Eigen::MatrixXd points(200 + corners, random.parameters);
    for (Eigen::Index s = 0; s < 200; ++s) points.row(s) = random.inside().transpose();
    for (int c = 0; c < corners; ++c) {
      for (int i = 0; i < random.parameters; ++i) {
        points(200 + c, i) = ((c >> i) & 1) != 0 ? random.box.upper(i) : random.box.lower(i);
      }
    }
    const Eigen::MatrixXd y = dense_eigenvalues(*random.model, points);
    solutions += found.solutions;
    unfinished += found.reaches_tolerance ? 0 : 1;
    for (const EigenvalueTrend trend : bounds.trends()) mixed += trend == EigenvalueTrend::mixed ? 1 : 0;
    for (Eigen::Index k = 0; k < random.order; ++k) {
      values += y.rows();
      violations += static_cast<int>((y.col(k).array() < found.proven_lower(k)).count() +
                                     (y.col(k).array() > found.proven_upper(k)).count());
      if (!found.reaches_tolerance) continue;
      const double low = (found.attained_lower(k) - found.proven_lower(k)) / found.attained_lower(k);
      const double high = (found.proven_upper(k) - found.attained_upper(k)) / found.attained_upper(k);
      worst_gap = std::max({worst_gap, low, high});
    }
  }
  return {{"cases", cases},           {"values", values},       {"violations", violations}, {"mixed_parameters", mixed},
          {"tolerance", k_tolerance}, {"worst_gap", worst_gap}, {"unfinished", unfinished}, {"solutions", solutions}};
}

/// k1, k2, k5 evenly in a box, as by chance.
Eigen::MatrixXd box_specimens(const ParameterBox& box, Eigen::Index n, std::uint32_t iteration) {
  Eigen::MatrixXd x(n, box.lower.size());
  for (Eigen::Index s = 0; s < n; ++s) {
    RandomStream stream({.seed = 19, .purpose = k_purpose, .iteration = iteration}, static_cast<std::uint32_t>(s));
    for (Eigen::Index i = 0; i < x.cols(); ++i) x(s, i) = box.lower(i) + stream.uniform() * box.width()(i);
  }
  return x;
}

const ParameterBox k_true_box{Eigen::Vector3d(0.8, 0.9, 0.7), Eigen::Vector3d(1.4, 1.3, 1.2)};

/// How often limits of n specimens contain 95 % of the population, output by output.
Json coverage(int n, const std::string& outputs, std::uint32_t replications) {
  const bool is_normal = outputs == "normal";
  const test::ThreeMasses structure;
  const Eigen::MatrixXd population =
      is_normal ? Eigen::MatrixXd() : test::frequencies_of(structure, box_specimens(k_true_box, 100000, 999999));
  const test::LinearModel line(Eigen::VectorXd::Zero(1), Eigen::MatrixXd::Ones(1, 1));
  const auto count = is_normal ? 1 : population.cols();
  Eigen::VectorXd limits = Eigen::VectorXd::Zero(count), observed = Eigen::VectorXd::Zero(count);
  double inside_observed = 0.0;
  for (std::uint32_t replication = 0; replication < replications; ++replication) {
    Eigen::MatrixXd tests;
    if (is_normal) {
      tests.resize(n, 1);
      RandomStream stream({.seed = 23, .purpose = k_purpose, .iteration = static_cast<std::uint32_t>(n)}, replication);
      for (double& value : tests.reshaped()) value = standard_normal_quantile(stream.uniform());
    } else {
      tests = test::frequencies_of(structure, box_specimens(k_true_box, n, replication));
    }
    const Model& model = is_normal ? static_cast<const Model&>(line) : *structure.model;
    const UpdatingProblem problem{
        .model = model, .space = *structure.space, .tests = {tests, Eigen::VectorXd::Zero(tests.cols())}};
    const SpecimenBounds bounds = find_specimen_bounds(problem, {});
    for (Eigen::Index k = 0; k < count; ++k) {
      const auto content = [&](const Eigen::MatrixXd& ends) {
        if (is_normal) return standard_normal_cdf(ends(k, 1)) - standard_normal_cdf(ends(k, 0));
        return ((population.col(k).array() >= ends(k, 0)) && (population.col(k).array() <= ends(k, 1)))
            .cast<double>()
            .mean();
      };
      limits(k) += content(bounds.limits) >= 0.95 ? 1.0 : 0.0;
      const double between = content(bounds.observed);
      observed(k) += between >= 0.95 ? 1.0 : 0.0;
      inside_observed += between / static_cast<double>(count);
    }
  }
  return {{"n", n},
          {"outputs", outputs},
          {"replications", replications},
          {"limits_cover", list(limits / replications)},
          {"observed_cover", list(observed / replications)},
          {"between_observed", inside_observed / replications},
          {"expected_between_observed", (n - 1.0) / (n + 1.0)}};
}

Json box_json(const ParameterBox& box) {
  return {{"lower", list(box.lower)}, {"upper", list(box.upper)}};
}

Json describe(const UpdatingResult& result, const ParameterBox& truth) {
  const IntervalResult& found = *result.interval;
  bool is_certified = true;
  for (const OutputRange& range : found.image) is_certified = is_certified && range.is_certified;
  const Eigen::ArrayXd width = truth.width().array();
  return {{"status", status_text(result.status)},
          {"box", box_json(found.box)},
          {"truth", box_json(truth)},
          {"hull", box_json(found.hull)},
          {"width_ratio", list(found.box.width().array() / width)},
          {"hull_ratio", list(found.hull.width().array() / width)},
          {"largest_error_of_width", std::max(((found.box.lower - truth.lower).array().abs() / width).maxCoeff(),
                                              ((found.box.upper - truth.upper).array().abs() / width).maxCoeff())},
          {"least_excess", found.excess.minCoeff()},
          {"outside", found.outside.size()},
          {"certified", is_certified},
          {"updates", result.history.size()},
          {"model_evaluations", result.model_evaluations}};
}

/// 1,000 specimens from a box, or those that make the bounds exact, against the box.
Json recovery(const std::string& specimens, const IntervalOptions& options) {
  const test::ThreeMasses structure;
  Eigen::MatrixXd x = box_specimens(k_true_box, specimens == "exact" ? 20 : 1000, 7);
  if (specimens == "exact") {
    x.row(0) = k_true_box.lower.transpose();
    x.row(1) = k_true_box.upper.transpose();
  }
  const UpdatingProblem problem = structure.problem(test::frequencies_of(structure, x));
  return describe(IntervalUpdater(options).update(problem, {}), k_true_box);
}

/// The examples of [Khodaparast2011]: bounds of the eigenvalues over the true box, from a start that is off.
Json literature(const std::string& name) {
  const bool is_close = name == "close";
  MassSpringSystem system = test::three_mass_system(is_close ? 1.0 : 3.0);
  if (is_close) {
    system.masses[1].mass = 4.0;
    std::erase_if(system.springs, [](const Connector& spring) { return spring.name == "k1" || spring.name == "k3"; });
  }
  const std::vector<std::string> names =
      is_close ? std::vector<std::string>{"k2", "k4", "k5"} : std::vector<std::string>{"k1", "k2", "k5"};
  const ParameterBox truth = is_close ? ParameterBox{Eigen::Vector3d(7.5, 1.8, 1.8), Eigen::Vector3d(8.5, 2.2, 2.2)}
                                      : ParameterBox{Eigen::Vector3d::Constant(0.8), Eigen::Vector3d::Constant(1.2)};
  const Eigen::VectorXd start = truth.middle() * 1.2;
  std::vector<ParameterTargets> targets;
  std::vector<Parameter> parameters;
  std::vector<Distribution> priors;
  for (std::size_t i = 0; i < names.size(); ++i) {
    targets.push_back({names[i], {"spring:" + names[i]}});
    parameters.push_back({names[i], "N/m"});
    const double mean = start(static_cast<Eigen::Index>(i));
    priors.emplace_back(DistributionSpec{.kind = DistributionKind::normal, .mean = mean, .std = 0.15 * mean});
  }
  const ParameterSpace space(parameters, JointDistribution(priors));
  const StructureModel model(separate(system, targets), OutputSelection{.eigenvalues = {1, 2, 3}}, start);
  Eigen::MatrixXd x(2, 3);
  x << truth.lower.transpose(), truth.upper.transpose();
  const Eigen::MatrixXd tests = model.evaluate(x, {}).outputs;
  const UpdatingProblem problem{
      .model = model, .derivatives = &model, .space = space, .tests = {tests, Eigen::VectorXd::Zero(3)}};
  return describe(IntervalUpdater({.bounds = IntervalOptions::Bounds::observed}).update(problem, {}), truth);
}

}  // namespace

int main(int count, char** words) {
  const std::string name = count > 1 ? words[1] : "";
  const auto number = [&](int k) { return static_cast<std::uint32_t>(std::stoul(words[k])); };
  Json result;
  if (name == "enclosures" && count == 3) {
    result = enclosures(number(2));
  } else if (name == "coverage" && count == 5) {
    result = coverage(static_cast<int>(number(2)), words[3], number(4));
  } else if (name == "recovery" && count == 4) {
    using Bounds = IntervalOptions::Bounds;
    const std::string bounds = words[3];
    result = recovery(words[2], {.bounds = bounds == "observed"            ? Bounds::observed
                                           : bounds == "distribution-free" ? Bounds::distribution_free
                                                                           : Bounds::normal_tolerance});
  } else if (name == "literature" && count == 3) {
    result = literature(words[2]);
  } else {
    std::cerr << "usage: mottle_interval_cases enclosures CASES | coverage N normal|box REPLICATIONS | recovery "
                 "exact|random BOUNDS | literature separated|close\n";
    return 2;
  }
  std::cout << result.dump(1) << '\n';
  return 0;
}
