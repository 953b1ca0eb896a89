// Options declared once: a method owns a struct and one table of its fields. Reading, `check`, `methods` and the
// reference pages all come from that table.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"

namespace mottle {

/// A value as a study file gives it.
using OptionValue = std::variant<bool, std::int64_t, double, std::string>;
using OptionValues = std::map<std::string, OptionValue>;

/// The value as it would stand in a study file.
std::string option_text(const OptionValue& value);
/// The same in the message that refuses it: with the point of 640.0 where a whole number is needed.
std::string refused_text(const OptionValue& value, const std::string& allowed);

/// One option as a reader of the documentation sees it.
struct OptionDescription {
  std::string name;
  std::string unit;           ///< "-" where dimensionless
  std::string allowed;        ///< range or list of choices, in words
  std::string default_value;  ///< as it would stand in a study file
  std::string meaning;        ///< one sentence
};

/// Closed interval of allowed numbers.
struct OptionRange {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool excludes_lower = false;  ///< the lower end itself is not allowed
  std::string text() const;
  bool contains(double value) const;
};

/// The fields of one options struct: how each is named, read, printed and explained.
template <typename Options>
class OptionTable {
 public:
  OptionTable& number(std::string name, double Options::*member, OptionRange range, std::string unit,
                      std::string meaning) {
    return add_number({std::move(name), std::move(unit), range.text(), "", std::move(meaning)}, member, range);
  }

  OptionTable& integer(std::string name, int Options::*member, OptionRange range, std::string unit,
                       std::string meaning) {
    return add_number({std::move(name), std::move(unit), "whole number, " + range.text(), "", std::move(meaning)},
                      member, range);
  }

  /// A number, or a word that stands for one outside of the range.
  OptionTable& number_or(std::string name, double Options::*member, OptionRange range, const std::string& word,
                         double meant, std::string meaning) {
    return add_number_or({std::move(name), "-", range.text(), "", std::move(meaning)}, member, range, word, meant);
  }

  /// A whole number, or a word that stands for one outside of the range.
  OptionTable& integer_or(std::string name, int Options::*member, OptionRange range, const std::string& word, int meant,
                          std::string meaning) {
    return add_number_or({std::move(name), "-", "whole number, " + range.text(), "", std::move(meaning)}, member, range,
                         word, meant);
  }

  OptionTable& flag(std::string name, bool Options::*member, std::string meaning) {
    return add(
        {std::move(name), "-", "true | false", "", std::move(meaning)},
        [member](Options& options, const OptionValue& value) {
          const auto* flag = std::get_if<bool>(&value);
          if (flag != nullptr) options.*member = *flag;
          return flag != nullptr;
        },
        [member](const Options& options) { return OptionValue(options.*member); });
  }

  template <typename Choice>
  OptionTable& choice(std::string name, Choice Options::*member, std::vector<std::pair<std::string, Choice>> choices,
                      std::string meaning) {
    std::vector<std::string> names;
    for (const auto& [text, value] : choices) names.push_back(fmt::format("\"{}\"", text));
    return add(
        {std::move(name), "-", join(names, " | "), "", std::move(meaning)},
        [member, choices](Options& options, const OptionValue& value) {
          const auto* text = std::get_if<std::string>(&value);
          for (const auto& [known, meant] : choices) {
            if (text != nullptr && *text == known) {
              options.*member = meant;
              return true;
            }
          }
          return false;
        },
        [member, choices](const Options& options) {
          for (const auto& [known, meant] : choices) {
            if (options.*member == meant) return OptionValue(known);
          }
          return OptionValue(std::string("?"));
        });
  }

  /// Every option with the default that a fresh `Options` holds.
  std::vector<OptionDescription> describe() const {
    std::vector<OptionDescription> descriptions;
    for (const Field& field : fields_) {
      descriptions.push_back(field.description);
      descriptions.back().default_value = option_text(field.print(Options{}));
    }
    return descriptions;
  }

  /// The values in force.
  OptionValues values(const Options& options) const {
    OptionValues values;
    for (const Field& field : fields_) values.emplace(field.description.name, field.print(options));
    return values;
  }

  /// Options from what a study gives. `where` starts each message ("study.toml: [update.mares]").
  /// Throws InvalidInput: unknown name, wrong type, value out of range.
  Options read(const OptionValues& values, const std::string& where) const {
    Options options;
    for (const auto& [name, value] : values) {
      const Field& field = find(name, where);
      const std::string& allowed = field.description.allowed;
      require(field.read(options, value), "{} {} = {}: allowed is {}", where, name, refused_text(value, allowed),
              allowed);
    }
    return options;
  }

 private:
  struct Field {
    OptionDescription description;
    std::function<bool(Options&, const OptionValue&)> read;
    std::function<OptionValue(const Options&)> print;
  };

  /// Nothing: it is no such number, or outside of the range. A whole number is a real one too.
  template <typename Number>
  static std::optional<Number> number_in(const OptionRange& range, const OptionValue& value) {
    std::optional<Number> number;
    if (const auto* whole = std::get_if<std::int64_t>(&value)) {
      if constexpr (std::is_integral_v<Number>) {
        if (!std::in_range<Number>(*whole)) return std::nullopt;
      }
      number = static_cast<Number>(*whole);
    } else if (const auto* real = std::get_if<double>(&value); real != nullptr && std::is_floating_point_v<Number>) {
      number = static_cast<Number>(*real);
    }
    return number && range.contains(static_cast<double>(*number)) ? number : std::nullopt;
  }

  template <typename Number>
  static OptionValue value_of(Number number) {
    if constexpr (std::is_integral_v<Number>)
      return OptionValue(std::int64_t{number});
    else
      return OptionValue(number);
  }

  template <typename Number>
  OptionTable& add_number(OptionDescription description, Number Options::*member, OptionRange range) {
    return add(
        std::move(description),
        [member, range](Options& options, const OptionValue& value) {
          const std::optional<Number> number = number_in<Number>(range, value);
          if (number) options.*member = *number;
          return number.has_value();
        },
        [member](const Options& options) { return value_of(options.*member); });
  }

  template <typename Number>
  OptionTable& add_number_or(OptionDescription description, Number Options::*member, OptionRange range,
                             const std::string& word, Number meant) {
    description.allowed = fmt::format("\"{}\" | {}", word, description.allowed);
    return add(
        std::move(description),
        [member, range, word, meant](Options& options, const OptionValue& value) {
          const auto* text = std::get_if<std::string>(&value);
          const bool is_word = text != nullptr && *text == word;
          const std::optional<Number> number = is_word ? std::optional(meant) : number_in<Number>(range, value);
          if (number) options.*member = *number;
          return number.has_value();
        },
        [member, word, meant](const Options& options) {
          return options.*member == meant ? OptionValue(word) : value_of(options.*member);
        });
  }

  OptionTable& add(OptionDescription description, std::function<bool(Options&, const OptionValue&)> read,
                   std::function<OptionValue(const Options&)> print) {
    fields_.push_back({std::move(description), std::move(read), std::move(print)});
    return *this;
  }

  const Field& find(const std::string& name, const std::string& where) const {
    std::vector<std::string> names;
    for (const Field& field : fields_) {
      if (field.description.name == name) return field;
      names.push_back(field.description.name);
    }
    throw InvalidInput(where + " " + unknown_name_message("key", name, names));
  }

  std::vector<Field> fields_;
};

}  // namespace mottle
