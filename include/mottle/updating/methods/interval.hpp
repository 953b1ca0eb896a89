// Bounds of the parameters whose image covers the bounds of the tests.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/model/eigenvalue_bounds.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::updating {

/// Which bounds are to be covered, and how the range of outputs over a box is found.
struct IntervalOptions {
  enum class Bounds { observed, normal_tolerance, distribution_free };

  Bounds bounds = Bounds::normal_tolerance;  // those that are observed are too narrow, whatever the population
  double content = 0.95;
  double confidence = 0.95;
  double range_tolerance = 1e-3;  // of an eigenvalue: a twentieth of a per cent of a frequency
  int max_solutions = 20000;
  int search_points = 200;
};

/// Name, range, default and meaning of each option.
const OptionTable<IntervalOptions>& interval_option_table();

/// Bounds of every output by the tests [output x 2].
struct SpecimenBounds {
  Eigen::MatrixXd observed;         ///< the smallest and the largest test
  Eigen::MatrixXd limits;           ///< those to be covered, never inside the observed ones
  Eigen::VectorXi count;            ///< measured values [output]
  Eigen::VectorXd factor;           ///< k of the limits mean -+ k s; nan: they are not of that kind [output]
  Eigen::VectorXd content;          ///< fraction of the population inside the limits, with ... [output]
  Eigen::VectorXd confidence;       ///< ... this confidence; nan: none is stated [output]
  Eigen::VectorXd expected_inside;  ///< mean fraction of a population between its observed bounds [output]
};

/// Range of an output over a box.
struct OutputRange {
  double lower = 0.0, upper = 0.0;     ///< attained
  Eigen::VectorXd at_lower, at_upper;  ///< where [parameter]
  double proven_lower = 0.0;           ///< no value in the box is below; nan: nothing is proven
  double proven_upper = 0.0;
  bool is_certified = false;  ///< proven, and attained within the tolerance
};

/// What `interval` finds beside the box, which is the estimate.
struct IntervalResult {
  ParameterBox box;
  SpecimenBounds tests;
  std::vector<OutputRange> image;  ///< of the box [output]
  Eigen::MatrixXd asked;           ///< bounds that the box was asked to cover: `tests.limits`, or what is possible
  ParameterBox allowed;            ///< in which the box was sought
  Eigen::MatrixXd reachable;  ///< range of the outputs over `allowed` [output x 2]; 0 x 0: the box covers, or it fails
  Eigen::MatrixXd excess;     ///< of the image over `tests.limits`, > 0 beyond, < 0 not covered [output x 2]
  double measure = 0.0;       ///< sum of widths in prior standard deviations
  std::vector<std::string> trends;        ///< "rising", "falling", "mixed", "searched" [parameter]
  std::string obstacle;                   ///< why no range is proven; empty: ranges of eigenvalues are
  ParameterBox hull;                      ///< of the specimens' own parameters, each solved for alone
  std::vector<int> outside;               ///< numbers of specimens whose own parameters lie outside the box
  std::vector<std::string> undetermined;  ///< sentences: ends of the box that other boxes of its measure do not have
};

/// The box of least measure sum_i (u_i - l_i) / s_i (s: prior standard deviations), within bounds and physical limits,
/// whose image covers the tests' bounds:
///
///   min over the box of f_k <= lower_k,   max over the box of f_k >= upper_k   for every output k
///
/// The theory: docs/theory/interval.md. Source: [Khodaparast2011]; [Moens2005].
class IntervalUpdater final : public Updater {
 public:
  explicit IntervalUpdater(const IntervalOptions& options) : options_(options) {}

  /// Throws InvalidInput: one specimen, an output with fewer than two tests, and what find_specimen_bounds() refuses;
  /// SystemFailure where the model fails at the start.
  UpdatingResult update(const UpdatingProblem& problem, const RunContext& context) const override;
  OptionValues options() const override { return interval_option_table().values(options_); }

 private:
  IntervalOptions options_;
};

}  // namespace mottle::updating
