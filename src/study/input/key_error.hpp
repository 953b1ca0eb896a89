// Error in one key of a study.
#pragma once

#include <string>
#include <utility>

#include "mottle/core/error.hpp"
#include "mottle/layers.hpp"

namespace mottle::study {

/// what() is "KEY: FAULT"; located() puts file and line in front.
class KeyError final : public InvalidInput {
 public:
  /// @param key  "predict.model"
  KeyError(std::string key, const std::string& fault)
      : InvalidInput(key + ": " + fault), key_(std::move(key)), fault_(fault) {}

  const std::string& key() const { return key_; }
  const std::string& fault() const { return fault_; }

 private:
  std::string key_;
  std::string fault_;
};

/// Throws KeyError with the formatted fault unless `claim` holds.
template <typename... Arguments>
void require_key(bool claim, const std::string& key, fmt::format_string<Arguments...> fault, Arguments&&... arguments) {
  if (!claim) throw KeyError(key, fmt::format(fault, std::forward<Arguments>(arguments)...));
}

}  // namespace mottle::study
