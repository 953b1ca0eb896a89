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

/// A whole number counts too; nothing: it is none.
inline std::optional<double> option_number(const OptionValue& value) {
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return static_cast<double>(*integer);
  if (const auto* real = std::get_if<double>(&value)) return *real;
  return std::nullopt;
}

/// The fields of one options struct: how each is named, read, printed and explained.
template <typename Options>
class OptionTable {
 public:
  OptionTable& number(std::string name, double Options::*member, OptionRange range, std::string unit,
                      std::string meaning) {
    return add(
        {std::move(name), std::move(unit), range.text(), "", std::move(meaning)},
        [member, range](Options& options, const OptionValue& value) {
          const std::optional<double> number = option_number(value);
          if (!number || !range.contains(*number)) return false;
          options.*member = *number;
          return true;
        },
        [member](const Options& options) { return OptionValue(options.*member); });
  }

  OptionTable& integer(std::string name, int Options::*member, OptionRange range, std::string unit,
                       std::string meaning) {
    return add(
        {std::move(name), std::move(unit), "whole number, " + range.text(), "", std::move(meaning)},
        [member, range](Options& options, const OptionValue& value) {
          const auto* number = std::get_if<std::int64_t>(&value);
          if (number == nullptr || !std::in_range<int>(*number) || !range.contains(static_cast<double>(*number))) {
            return false;
          }
          options.*member = static_cast<int>(*number);
          return true;
        },
        [member](const Options& options) { return OptionValue(std::int64_t{options.*member}); });
  }

  /// A whole number, or a word that stands for one outside of the range.
  OptionTable& integer_or(std::string name, int Options::*member, OptionRange range, std::string word, int meant,
                          std::string meaning) {
    return add(
        {std::move(name), "-", fmt::format("\"{}\" | whole number, {}", word, range.text()), "", std::move(meaning)},
        [member, range, word, meant](Options& options, const OptionValue& value) {
          const auto* number = std::get_if<std::int64_t>(&value);
          const auto* text = std::get_if<std::string>(&value);
          const bool is_word = text != nullptr && *text == word;
          const bool is_number = number != nullptr && range.contains(static_cast<double>(*number));
          if (is_word || is_number) options.*member = is_word ? meant : static_cast<int>(*number);
          return is_word || is_number;
        },
        [member, word, meant](const Options& options) {
          return options.*member == meant ? OptionValue(word) : OptionValue(std::int64_t{options.*member});
        });
  }

  /// A number, or a word that stands for one outside of the range.
  OptionTable& number_or(std::string name, double Options::*member, OptionRange range, std::string word, double meant,
                         std::string meaning) {
    return add(
        {std::move(name), "-", fmt::format("\"{}\" | {}", word, range.text()), "", std::move(meaning)},
        [member, range, word, meant](Options& options, const OptionValue& value) {
          const auto* text = std::get_if<std::string>(&value);
          const std::optional<double> number = option_number(value);
          const bool is_word = text != nullptr && *text == word;
          const bool is_number = number && range.contains(*number);
          if (is_word || is_number) options.*member = is_word ? meant : *number;
          return is_word || is_number;
        },
        [member, word, meant](const Options& options) {
          return options.*member == meant ? OptionValue(word) : OptionValue(options.*member);
        });
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
      require(field.read(options, value), "{} {} = {}: allowed is {}", where, name, option_text(value),
              field.description.allowed);
    }
    return options;
  }

 private:
  struct Field {
    OptionDescription description;
    std::function<bool(Options&, const OptionValue&)> read;
    std::function<OptionValue(const Options&)> print;
  };

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
