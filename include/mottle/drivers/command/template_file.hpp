// Text with placeholders for parameters, {{name}}, {{name:%8.3e}} or {{name*2.1e11}}: a solver's input, or one argument
// of its command.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "mottle/layers.hpp"

namespace mottle::drivers {

/// A text with placeholders for parameters.
class Template {
 public:
  /// @param text   with {{name}}: the shortest number that reads back as the same; {{name:%W.Pe}} (or f, g): printf's
  ///               way, never wider than W; {{name:%Wd}}: a value that is a whole number; {{name*2.1e11}} with either:
  ///               times that number
  /// @param file   for messages
  /// @param names  of the parameters
  /// @throws FormatError  (file, line): a name that is no parameter, a format that is none of these, {{ without }}
  Template(std::string_view text, std::string file, const std::vector<std::string>& names);

  /// The text with `values` [parameter] in its placeholders.
  ///
  /// @throws FormatError  (file, line): a value that needs more characters than its placeholder has, or is not whole
  std::string fill(const Eigen::Ref<const Eigen::VectorXd>& values) const;

  /// By parameter, whether it has a placeholder.
  std::vector<bool> uses(std::size_t parameters) const;

  /// Placeholders whose formats resolve the steps from `values` to `values + steps` too coarsely: "plate.inp:7: E with
  /// %8.3e".
  std::vector<std::string> coarse_placeholders(const Eigen::Ref<const Eigen::VectorXd>& values,
                                               const Eigen::Ref<const Eigen::VectorXd>& steps) const;

 private:
  struct Placeholder {
    std::size_t parameter = 0;
    int line = 0;
    std::string name = {};
    double factor = 1.0;
    std::string format = {};  ///< printf's; empty: the shortest exact text
    std::size_t width = 0;    ///< most characters; 0: any number
    std::string text_after = {};
  };
  std::string text_of(const Placeholder& placeholder, double value) const;
  Placeholder read_placeholder(std::string_view inside, int line, const std::vector<std::string>& names) const;

  std::string file_;
  std::string head_;
  std::vector<Placeholder> placeholders_;
};

/// Names in the placeholders of a text, each once, in its order.
///
/// @param file  for messages
/// @throws FormatError  {{ without }} on the same line
std::vector<std::string> placeholder_names(std::string_view text, const std::string& file);

}  // namespace mottle::drivers
