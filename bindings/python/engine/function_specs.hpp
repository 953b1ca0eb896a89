// Parameters and outputs of a function as Python gives them.
#pragma once

#include <string>
#include <vector>

#include "mottle/mottle.hpp"

namespace mottle::python {

/// One parameter as Python gives it.
struct ParameterSpec {
  std::string name, kind, scale, unit;
  double mean, std, lower, upper;                // of the distribution
  double lower_bound, upper_bound, lower_limit;  // lower_limit: below lies what is physically impossible
};

/// One output as Python gives it.
struct OutputSpec {
  std::string name, unit;
};

/// Their space; `correlation` of the prior's copula, 0 x 0: none.
///
/// Throws InvalidInput with the parameter's name.
ParameterSpace space_of(const std::vector<ParameterSpec>& specs, const Eigen::MatrixXd& correlation);

/// "f1" and "lambda2" are what studies call so; every other name is the user's own.
Quantity quantity_of(const OutputSpec& spec);

/// Leaves out specimens without any value, of which methods expect one; the others keep their numbers, those of their
/// rows from 1. What a reader must know of it.
///
/// Throws InvalidInput: no specimen has a value.
std::vector<std::string> leave_out_empty(TestData& tests);

}  // namespace mottle::python
