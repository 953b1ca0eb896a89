// Runs of CalculiX for its matrices and its own modes, each kept in the cache.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <string>

#include "mottle/core/checksum.hpp"
#include "mottle/drivers/calculix/calculix.hpp"
#include "mottle/drivers/calculix/separable_fit.hpp"
#include "mottle/drivers/command/solver_process.hpp"
#include "mottle/layers.hpp"

namespace mottle::drivers {

/// More threads are slower on small models, and much slower beside other work.
std::map<std::string, std::string> one_thread();

class CalculixProgram {
 public:
  /// Throws InvalidInput: a program that is not there.
  CalculixProgram(const CalculixSettings& settings, const CalculixDeck& deck);

  /// The matrices of a text of the deck with SOLVER=MATRIXSTORAGE.
  ///
  /// @throws InvalidInput   cards that CalculiX does not know
  /// @throws SystemFailure  a run that fails or takes too long, with the end of what CalculiX printed
  MatrixRun matrices(const std::string& text);

  /// The lowest eigenvalues as the solver finds them from the matrices that it has in memory [mode]; empty where its
  /// run ends otherwise.
  Eigen::VectorXd eigenvalues(const std::string& text);

  /// Throws InvalidInput where the text has cards that CalculiX does not know: it goes past them with a warning.
  void require_known_cards(const std::string& text);

  int runs() const { return runs_; }
  int reused() const { return reused_; }

 private:
  Digest digest_of(const std::string& text) const;
  ProcessEnd run(const std::vector<std::string>& arguments, const std::filesystem::path& folder) const;
  ProcessEnd run_deck(const std::string& text, const std::filesystem::path& folder) const;
  MatrixRun read_stored(const std::filesystem::path& folder) const;
  std::string stored(const std::filesystem::path& folder, const char* name) const;
  [[noreturn]] void fail(const std::string& reason, const std::filesystem::path& folder) const;
  [[noreturn]] void fail_short(const std::string& reason, const std::filesystem::path& folder) const;

  CalculixSettings settings_;
  const CalculixDeck& deck_;
  std::filesystem::path program_;
  std::string version_;
  int runs_ = 0;
  int reused_ = 0;
};

}  // namespace mottle::drivers
