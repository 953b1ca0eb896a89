#include "study/results/estimate_json.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "mottle/core/error.hpp"
#include "mottle/core/rounding.hpp"
#include "mottle/updating/estimate/normal_estimates.hpp"
#include "study/results/density_curves.hpp"

namespace mottle::study {
namespace {

constexpr Eigen::Index k_density_points = 161;
constexpr Eigen::Index k_outline_points = 65;  // a polygon 0.1 % inside of its ellipse
constexpr double k_reach = 2.0;                // of the regions of a normal population, in standard deviations

/// Probability that a pair of normal variables is within k_reach standard deviations: 86 %.
double region_probability() {
  return -std::expm1(-0.5 * k_reach * k_reach);
}

/// Ascending points of a curve: in all their digits where fewer would make two equal, as beside a bound.
Json abscissae_json(const Eigen::VectorXd& x) {
  Json list = drawn_json(x);
  for (Eigen::Index k = 1; k < x.size(); ++k) {
    if (x(k) == x(k - 1) || list[static_cast<std::size_t>(k)] != list[static_cast<std::size_t>(k - 1)]) continue;
    list = Json::array();
    for (const double value : x) list.push_back(value);
    break;
  }
  return list;
}

Json curve_json(const DensityCurve& curve) {
  if (curve.x.size() == 0) return nullptr;
  return {{"x", abscissae_json(curve.x)}, {"density", drawn_json(curve.density)}};
}

Json band_json(const DensityBand& band) {
  if (band.x.size() == 0) return nullptr;
  return {{"x", abscissae_json(band.x)}, {"least", drawn_json(band.lower)}, {"greatest", drawn_json(band.upper)}};
}

Json outline_json(const Eigen::MatrixXd& outline) {
  return {{"x", drawn_json(outline.col(0))}, {"y", drawn_json(outline.col(1))}};
}

DensityCurve prior_of(const ParameterSpace& space, Eigen::Index i) {
  const std::vector<Distribution>& marginals = space.prior().marginals();
  if (!marginals.empty()) return prior_curve(marginals[static_cast<std::size_t>(i)]);
  return normal_curve(space.prior().mean()(i), std::sqrt(space.prior().covariance()(i, i)));
}

/// Density of a parameter's estimate; empty where its standard deviation is zero but for rounding, as of a parameter
/// that the tests do not determine.
DensityCurve updated_curve(const UpdatingResult& result, Eigen::Index i) {
  constexpr double k_min_width = 1e-6;
  constexpr double k_smallest = 1e-300;
  const double std = std::sqrt(std::max(result.covariance(i, i), 0.0));
  if (!(std > k_min_width * std::max(std::abs(result.mean(i)), k_smallest))) return {};
  DensityCurve curve{result.estimate->density_points(i, k_density_points), {}};
  if (curve.x.size() > 0) curve.density = result.estimate->density(i, curve.x);
  return curve;
}

Json densities_json(const UpdatingProblem& problem, const UpdatingResult& result) {
  Json list = Json::array();
  for (Eigen::Index i = 0; i < result.mean.size(); ++i) {
    DensityBand band;
    if (result.intervals && result.is_population) {
      band = density_band(problem.space.parameters()[static_cast<std::size_t>(i)].transform,
                          result.intervals->mean.row(i).transpose(), result.intervals->std.row(i).transpose());
    }
    list.push_back({{"prior", curve_json(prior_of(problem.space, i))},
                    {"updated", curve_json(updated_curve(result, i))},
                    {"band", band_json(band)}});
  }
  return list;
}

Json quantiles_json(const Estimate& estimate) {
  const Json probabilities = {0.025, 0.16, 0.5, 0.84, 0.975};
  Json values = Json::array();
  for (Eigen::Index i = 0; i < estimate.parameter_count(); ++i) {
    Json row = Json::array();
    for (const Json& probability : probabilities) row.push_back(number_json(estimate.quantile(i, probability)));
    values.push_back(std::move(row));
  }
  return {{"probabilities", probabilities}, {"values", std::move(values)}};
}

bool has_interval(const UpdatingResult& result, Eigen::Index i, Eigen::Index j) {
  return result.intervals && std::isfinite(result.intervals->correlation_lower(i, j)) &&
         std::isfinite(result.intervals->correlation_upper(i, j));
}

/// nan where not determined: of a parameter without scatter, and where other pairs have an interval and one has none.
Eigen::MatrixXd determined_correlation(const UpdatingResult& result) {
  Eigen::MatrixXd correlation = result.estimate->correlation();
  const Eigen::Index q = correlation.rows();
  bool has_intervals = false;
  for (Eigen::Index i = 0; i < q; ++i) {
    for (Eigen::Index j = 0; j < i; ++j) has_intervals = has_intervals || has_interval(result, i, j);
  }
  for (Eigen::Index i = 0; i < q; ++i) {
    for (Eigen::Index j = 0; j < q; ++j) {
      if (i != j && has_intervals && !has_interval(result, i, j)) correlation(i, j) = std::nan("");
    }
  }
  return correlation;
}

/// The region of a pair at either end of its correlation's interval.
Json ends_json(const UpdatingProblem& problem, const UpdatingResult& result, Eigen::Index i, Eigen::Index j) {
  Json ends = Json::array();
  const PopulationOnScales* population = result.estimate->population();
  if (population == nullptr || !has_interval(result, i, j)) return ends;
  const auto variable = [&](Eigen::Index k) {
    return TransformedNormal{problem.space.parameters()[static_cast<std::size_t>(k)].transform, population->moments(k)};
  };
  const TransformedPair pair{variable(i), variable(j)};
  if (!pair.first.has_width() || !pair.second.has_width()) return ends;
  for (const double rho : {result.intervals->correlation_lower(i, j), result.intervals->correlation_upper(i, j)}) {
    ends.push_back(outline_json(pair_outline(pair, rho, k_reach, k_outline_points)));
  }
  return ends;
}

Json regions_json(const UpdatingProblem& problem, const UpdatingResult& result, const Eigen::MatrixXd& correlation) {
  Json list = Json::array();
  for (Eigen::Index i = 0; i < correlation.rows(); ++i) {
    for (Eigen::Index j = i + 1; j < correlation.rows(); ++j) {
      Json outlines = Json::array();
      if (std::isfinite(correlation(i, j))) {
        for (const Eigen::MatrixXd& outline : result.estimate->region(i, j, region_probability(), k_outline_points)) {
          outlines.push_back(outline_json(outline));
        }
      }
      list.push_back({{"first", i},
                      {"second", j},
                      {"outlines", std::move(outlines)},
                      {"interval_ends", ends_json(problem, result, i, j)}});
    }
  }
  return list;
}

Json optional_json(const std::optional<double>& value) {
  return value ? number_json(*value) : Json(nullptr);
}

}  // namespace

Json drawn_json(const Eigen::Ref<const Eigen::VectorXd>& values) {
  Json list = Json::array();
  if (values.size() == 0) return list;
  const int digits = digits_of_range(values.maxCoeff() - values.minCoeff(), values.cwiseAbs().maxCoeff());
  for (const double value : values) list.push_back(number_json(rounded(value, digits)));
  return list;
}

void add_estimate(const UpdatingProblem& problem, const UpdatingResult& result, Json& parameters) {
  if (!result.estimate) return;
  const Estimate& estimate = *result.estimate;
  const Eigen::MatrixXd correlation = determined_correlation(result);
  parameters["estimate"] = {{"kind", estimate_kind_text(estimate.kind())},
                            {"log_evidence", optional_json(estimate.log_evidence())},
                            {"effective_samples", optional_json(estimate.effective_samples())},
                            {"region_probability", region_probability()}};
  parameters["quantiles"] = quantiles_json(estimate);
  parameters["correlation"] = to_json_rows(correlation);
  parameters["densities"] = densities_json(problem, result);
  parameters["regions"] = regions_json(problem, result, correlation);
}

}  // namespace mottle::study
