// How often tasks have died at a run: in a file, so that the count outlives the Mottle that keeps it.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "mottle/core/checksum.hpp"
#include "mottle/layers.hpp"

namespace mottle::drivers {

class DeathCharges {
 public:
  /// @param results     folder of results
  /// @param is_resumed  else what an earlier Mottle counted is forgotten
  DeathCharges(const std::filesystem::path& results, bool is_resumed);

  int of(const Digest& key) const;
  /// Keeps the count; 0: the run is charged no more. Throws SystemFailure: it cannot be written.
  void set(const Digest& key, int deaths);
  /// No run is charged any more.
  void clear();

 private:
  void write() const;

  std::filesystem::path file_;
  std::map<std::string, int> deaths_;  ///< by the key's digits
};

}  // namespace mottle::drivers
