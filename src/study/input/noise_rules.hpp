// Measurement noise and model error by output name or pattern: reading the rules, and what each output gets from them.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mottle/layers.hpp"
#include "mottle/study/input/study.hpp"
#include "study/input/toml_reader.hpp"

namespace mottle::study {

/// A table { f1 = 0.001, "phi*" = "1 %" } as rules in the order of the file; none where the key is missing.
///
/// Throws InvalidInput: a value that is neither a number >= 0 nor such a number with "%".
std::vector<NoiseRule> read_noise_rules(TomlReader& reader, const std::string& key);

/// The rule that holds for an output; null where none fits. See noise_standard_deviations.
const NoiseRule* rule_for(const std::vector<NoiseRule>& rules, const std::string& output);

/// Standard deviation of each output and the rule that gave it.
struct NoiseStandardDeviations {
  Eigen::VectorXd std;             ///< 0 where no rule fits
  std::vector<std::string> notes;  ///< one a rule: which outputs it holds for
};

/// An exact name goes before every pattern, a pattern with more letters before one with fewer, and of equals the later
/// one holds.
///
/// @param means  of the outputs, of which a relative rule takes its part
/// @param what   "Measurement noise", for notes
/// Throws InvalidInput: a rule that fits no output.
NoiseStandardDeviations noise_standard_deviations(const std::vector<NoiseRule>& rules,
                                                  const std::vector<std::string>& outputs,
                                                  const Eigen::Ref<const Eigen::VectorXd>& means,
                                                  const std::string& what = "Measurement noise");

}  // namespace mottle::study
