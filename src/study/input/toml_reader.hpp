// Reads a TOML table key by key: remembers which keys it was asked for, so that what is left over is unknown, and
// says file, line and key in every message.
#pragma once

#include <toml++/toml.h>

#include <map>
#include <string>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/core/options.hpp"
#include "mottle/layers.hpp"

namespace mottle::study {

class TomlReader {
 public:
  /// @param path  of the table within the file, "update.mares"; empty for the root
  TomlReader(const toml::table& table, std::string file, std::string path)
      : table_(table), file_(std::move(file)), path_(std::move(path)) {}

  bool has(const std::string& key) const { return table_.contains(key); }

  std::string text(const std::string& key);
  /// A text that stands in tables and messages: without control characters.
  std::string name(const std::string& key);
  std::string text_or(const std::string& key, const std::string& fallback);
  /// One text, or a list of texts.
  std::vector<std::string> texts(const std::string& key);
  double number(const std::string& key, const OptionRange& range);
  double number_or(const std::string& key, double fallback, const OptionRange& range);
  std::int64_t integer_or(const std::string& key, std::int64_t fallback, const OptionRange& range);
  bool flag_or(const std::string& key, bool fallback);
  std::vector<double> numbers(const std::string& key);
  /// Whole numbers, each >= 1: of modes or, by `what`, of something else.
  std::vector<int> mode_numbers(const std::string& key, std::string_view what = "mode");
  /// One of `choices`; returns its index.
  std::size_t choice(const std::string& key, const std::vector<std::string>& choices, std::size_t fallback);
  /// name -> number.
  std::map<std::string, double> number_map(const std::string& key, const OptionRange& range);
  /// All keys with simple values, for an option table to read.
  OptionValues option_values();

  TomlReader table(const std::string& key);
  std::vector<TomlReader> tables(const std::string& key);
  /// One entry, counted from 0, of a list that may also hold other things than tables.
  TomlReader table_in(const std::string& key, std::size_t entry) const;
  /// Sub-tables of this table, which may have any name.
  std::vector<std::string> sub_table_names() const;
  const toml::node* raw(const std::string& key);
  /// All keys of this table, which may have any name.
  std::vector<std::string> keys() const;

  /// Throws where a key is left that nobody asked for.
  void finish() const;

  /// "study.toml:12: update.samples" for messages.
  std::string where(const std::string& key) const;
  std::string where() const;
  /// "study.toml:12: [update]": the key's line, the table's name.
  std::string where_of(const std::string& key) const;
  /// `message` about `key`, with file, line and key in front.
  [[noreturn]] void fail(const std::string& key, const std::string& message) const;
  /// "found 3.5, allowed is ..."
  [[noreturn]] void fail_value(const std::string& key, const std::string& allowed) const;

 private:
  const toml::node* find(const std::string& key);
  const toml::node& need(const std::string& key);
  std::string dotted(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }

  const toml::table& table_;
  std::string file_;
  std::string path_;
  std::vector<std::string> asked_;
};

/// The value as it stands in the file, on one line and not too long.
std::string toml_text(const toml::node& node);

}  // namespace mottle::study
