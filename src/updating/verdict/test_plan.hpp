// The tests of one verdict: planned first and made together, so that the false-alarm rate of all is the level.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/updating/methods/updater.hpp"

namespace mottle::updating {

/// What a verdict must have tested. A test of no aspect can refuse a model, but its passing does not support one.
enum class Aspect { means, scatter, none };

inline constexpr double k_missed = 0.2;  // the power that is stated is 80 %

/// What a test would find with a probability of 80 %.
struct Power {
  std::string finds;      ///< "a mean that is off by 1.2 standard deviations of a test in ..."
  bool is_enough = true;  ///< what it would overlook is not so large that nothing was tested
};

/// A test whose statistic is known; its level waits until it is known how many tests share the verdict's.
struct PlannedTest {
  std::string name;
  double statistic = 0.0;
  double p_value = 1.0;
  std::function<double(double level)> critical = {};  ///< the test fails where the statistic is larger
  std::string meaning = {};                           ///< the question it answers, as a sentence
  Aspect aspect = Aspect::none;
  std::function<Power(double level)> power = {};  ///< of a test of an aspect
  double share = 1.0;                             ///< of the level, against the 1 of an ordinary test
  bool is_listed_where_it_passes = true;          ///< false: it can hardly fail, so that its passing says little
  /// Warning where the statistic is smaller than in one of a thousand cases of a right model; empty: there is none.
  std::string too_small = {};
};

/// What would let means and scatter be tested.
inline constexpr const char* k_more_outputs =
    "Measure more outputs than parameters: mode shapes in addition to the frequencies, or further frequencies.";

/// An error this many times the standard deviation that it is compared with is gross: a test that overlooks it is none.
constexpr double k_gross_error = 5.0;

/// "the 3 directions", "the one direction": of the outputs, for sentences.
std::string directions_text(double count);

/// The tests of one verdict. Each is made at the level
///
///   1 - (1 - level)^(share / sum of shares),
///
/// so that independent tests together refuse a right model with the probability `level` [Sidak1967].
class TestPlan {
 public:
  void add(PlannedTest test) { tests_.push_back(std::move(test)); }

  /// A sentence that says why an aspect is not tested and what would test it; used where no test of it has power.
  void leave_untested(Aspect aspect, const std::string& sentence) { untested_[aspect].push_back(sentence); }

  /// The same where parameters can match any outputs: UpdatingResult::lacks_outputs.
  void leave_untested_for_lack_of_outputs(Aspect aspect, const std::string& sentence) {
    leave_untested(aspect, sentence);
    lacking_.insert(aspect);
  }

  /// Puts the tests, and sentences on aspects that none of them tests, into the result.
  void make(double level, UpdatingResult& result) const;

 private:
  std::vector<PlannedTest> tests_;
  std::map<Aspect, std::vector<std::string>> untested_;
  std::set<Aspect> lacking_;  // of outputs
};

/// A planned test whose statistic is chi-squared where the model is right.
PlannedTest chi_squared_test(std::string name, double statistic, double degrees_of_freedom);

/// A planned test whose statistic is F-distributed where the model is right.
PlannedTest f_test(std::string name, double statistic, double numerator, double denominator);

/// Noncentrality at which a chi-squared test finds the error with 80 %.
double chi_squared_detectable(double degrees_of_freedom, double level);

/// The same of an F test, infinite where the denominator's degrees of freedom are too few to say.
double f_detectable(double numerator, double denominator, double level);

}  // namespace mottle::updating
