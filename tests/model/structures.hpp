// Small structures with known modes for the tests of the model layer.
#pragma once

#include <Eigen/Core>
#include <cstring>
#include <string>
#include <vector>

#include "mottle/fem/assembly/mass_spring.hpp"
#include "mottle/model/parameters/parameter_targets.hpp"

namespace mottle::test {

using namespace model;  // of which these are the tests

/// Three unit masses ([Mares2006]): k1, k2, k3 to ground, k4 = 1-2, k5 = 2-3, k6 = 1-3.
inline MassSpringSystem three_mass_system() {
  return {.masses = {{"m1", 1.0}, {"m2", 1.0}, {"m3", 1.0}},
          .springs = {{"k1", k_ground, 0, 1.0},
                      {"k2", k_ground, 1, 1.0},
                      {"k3", k_ground, 2, 1.0},
                      {"k4", 0, 1, 1.0},
                      {"k5", 1, 2, 1.0},
                      {"k6", 0, 2, 3.0}},
          .dampers = {}};
}

/// Two unit masses, each on its own spring to ground and tied to one another by kc: shapes are the axes where kc = 0.
inline MassSpringSystem two_mass_system(double k1, double k2, double kc) {
  return {.masses = {{"m1", 1.0}, {"m2", 1.0}},
          .springs = {{"k1", k_ground, 0, k1}, {"k2", k_ground, 1, k2}, {"kc", 0, 1, kc}},
          .dampers = {}};
}

/// One parameter for each target, named like it.
inline std::vector<ParameterTargets> one_each(const std::vector<std::string>& targets) {
  std::vector<ParameterTargets> parameters;
  for (const std::string& target : targets) parameters.push_back({target, {target}, false});
  return parameters;
}

/// Whether two matrices hold the same bits, nan included.
inline bool have_same_bits(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const auto bytes = static_cast<std::size_t>(a.size()) * sizeof(double);
  return a.rows() == b.rows() && a.cols() == b.cols() && (bytes == 0 || std::memcmp(a.data(), b.data(), bytes) == 0);
}

}  // namespace mottle::test
