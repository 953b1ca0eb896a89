// Linear random effects: the population behind specimens' values.
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <limits>

#include "bindings.hpp"
#include "calling_thread.hpp"
#include "mottle/mottle.hpp"
#include "mottle/stats/population/random_effects.hpp"

namespace mottle::python {
namespace {

namespace py = pybind11;
using stats::RandomEffectsFit;
using stats::RandomEffectsInformation;
using stats::RandomEffectsSettings;
using stats::RandomEffectsUnit;

/// Standard errors of the entries of the covariance; nan of those that are not estimated.
Eigen::MatrixXd standard_errors(const RandomEffectsInformation& information, Eigen::Index effects) {
  Eigen::MatrixXd errors = Eigen::MatrixXd::Constant(effects, effects, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t k = 0; k < information.entries.size(); ++k) {
    const auto [i, j] = information.entries[k];
    const auto index = static_cast<Eigen::Index>(k);
    errors(i, j) = errors(j, i) = std::sqrt(information.entry_covariance(index, index));
  }
  return errors;
}

/// @param units  design [row x effect], response [row] and noise's variance [row] of each
py::dict fit_population(const std::vector<std::tuple<Eigen::MatrixXd, Eigen::VectorXd, Eigen::VectorXd>>& units,
                        const Eigen::MatrixXd& start, bool is_restricted, bool estimates_noise, int iterations,
                        double tolerance) {
  std::vector<RandomEffectsUnit> specimens;
  for (const auto& [design, response, noise] : units) {
    specimens.push_back({.design = design, .response = response, .noise = noise});
    if (estimates_noise) specimens.back().factor.assign(static_cast<std::size_t>(response.size()), 0);
  }
  const RandomEffectsSettings settings{.is_restricted = is_restricted,
                                       .factors = estimates_noise ? 1 : 0,
                                       .iterations = iterations,
                                       .tolerance = tolerance};
  const auto [fit, information] = CallingThread::run_by_itself([=](const auto* /*stop*/) {
    RandomEffectsFit found = stats::fit_random_effects(specimens, start, settings);
    RandomEffectsInformation known = stats::random_effects_information(specimens, found, settings);
    return std::make_pair(std::move(found), std::move(known));
  });
  return py::dict(
      py::arg("mean") = fit.mean, py::arg("covariance") = fit.covariance,
      py::arg("mean_covariance") = Eigen::MatrixXd(information.mean_from_effects + information.mean_from_noise),
      py::arg("covariance_errors") = standard_errors(information, fit.mean.size()), py::arg("effects") = fit.effects,
      py::arg("noise_factor") = estimates_noise ? fit.noise_factors(0) : 1.0,
      py::arg("log_likelihood") = fit.log_likelihood, py::arg("iterations") = fit.iterations,
      py::arg("converged") = fit.converged);
}

}  // namespace

void add_population(py::module_& module) {
  module.def("fit_population", fit_population, py::arg("units"), py::arg("start"), py::kw_only(),
             py::arg("is_restricted"), py::arg("estimates_noise"), py::arg("iterations"), py::arg("tolerance"));
}

}  // namespace mottle::python
