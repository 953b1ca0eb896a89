// Runs a solver at parameter vectors: looks for the run in the store, else writes the input, starts the solver, reads
// its modes, and retries failed runs.
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "mottle/core/ranks.hpp"
#include "mottle/core/run_context.hpp"
#include "mottle/drivers/command/input_files.hpp"
#include "mottle/drivers/command/run_folders.hpp"
#include "mottle/drivers/command/run_store.hpp"
#include "mottle/drivers/command/solver_command.hpp"
#include "mottle/drivers/command/template_file.hpp"
#include "mottle/layers.hpp"

namespace mottle::drivers {

/// Where results of runs are kept, and which of them are used again.
struct RunStorage {
  std::filesystem::path results = {};    ///< folder of results; empty: temporary, nothing is used again
  bool is_resumed = false;               ///< runs that failed before count as they did; else they are tried again
  Ranks* ranks = nullptr;                ///< that share the runs; null: this process is alone
  bool is_task = false;                  ///< whoever ends this process may end its solver at the same time
  ProgressObserver* observer = nullptr;  ///< hears of tasks of a scheduler that do the run at the means
};

class SolverRuns {
 public:
  /// @param names  of the parameters
  /// @throws InvalidInput, FormatError  a file that is missing, a fault of a template, a parameter without placeholder,
  /// a
  ///                                    program that is not there
  SolverRuns(SolverCommand command, const std::vector<std::string>& names, const RunStorage& storage);

  struct Run {
    RunRecord record = {};
    bool is_reused = false;
    int tries = 0;
    int losses = 0;  ///< tries whose guard was ended from outside: made again, and no word on the model
    std::filesystem::path folder = {};  ///< where a failed run is kept; empty: it is not
    std::string last_words = {};        ///< what a failed run printed last
  };

  /// Before a batch of runs: finds those that other ranks have kept.
  void begin_batch() const;
  /// One run; called by several threads at once.
  ///
  /// @param min_modes  smallest number of modes that it must give
  /// @throws FormatError    a value does not fit into its placeholder
  /// @throws NoRoom         the disk is full, or was while the run was at work: the run is not kept
  /// @throws SystemFailure, Stopped
  Run run(const Eigen::Ref<const Eigen::VectorXd>& values, int min_modes, const std::atomic<bool>* stop);

  /// What a run is kept under. Throws FormatError: a value does not fit into its placeholder.
  Digest key_at(const Eigen::Ref<const Eigen::VectorXd>& values, int min_modes) const;
  /// The run of that key, if it counts: a failure of an earlier job does where that is resumed.
  std::optional<RunRecord> find(const Digest& key) const;
  /// Keeps a run that was done elsewhere, and its folder where it has one: see RunFolders::keep. Throws SystemFailure.
  void keep(const Digest& key, const RunRecord& record);
  /// Before a batch is handed on, or what else holds its runs goes: they are on the disk. Throws SystemFailure.
  void flush();
  std::filesystem::path keep_folder(const std::filesystem::path& folder, bool has_failed, const std::string& name);
  /// Throws SystemFailure where nothing more can be written there.
  void require_room(const std::filesystem::path& folder) const { folders_->require_room(folder); }
  /// "1a2b3c4d5e6f", as messages and folders of failed runs name it.
  static std::string id_of(const Digest& key);

  /// Also keeps a run under another number of modes that it must give.
  void keep_as(const Eigen::Ref<const Eigen::VectorXd>& values, int min_modes, const RunRecord& record);

  const SolverCommand& command() const { return command_; }
  /// "ccx plate".
  std::string command_text() const;
  /// Of everything that is the same for all runs.
  Digest constants() const;
  /// The command with its templates' texts and absolute paths, for other processes to do the same runs.
  SolverCommand frozen_command() const;
  const std::vector<std::string>& parameter_names() const { return names_; }
  /// Placeholders in templates whose formats are too coarse for steps of the parameters.
  std::vector<std::string> coarse_placeholders(const Eigen::Ref<const Eigen::VectorXd>& values,
                                               const Eigen::Ref<const Eigen::VectorXd>& steps) const;

 private:
  static constexpr int k_max_losses = 3;  ///< tries of a run that others end: then somebody means it

  /// Everything of one run that parameters move.
  struct Input {
    std::vector<std::string> texts = {};  ///< by template
    std::vector<std::string> arguments = {};
    std::vector<std::string> retry_arguments = {};
  };
  void read_files();
  void read_templates();
  void require_program(const CommandLine& line) const;
  Input fill(const Eigen::Ref<const Eigen::VectorXd>& values) const;
  Digest key_of(const Input& input, int min_modes) const;
  void prepare(const std::filesystem::path& folder, const Input& input) const;
  bool try_once(const Input& input, const std::filesystem::path& folder, int number, int min_modes,
                const std::atomic<bool>* stop, Run& run) const;
  void require_own_failure(const std::atomic<bool>* stop) const;
  std::set<std::string> given_names() const;
  bool read_result(const std::filesystem::path& folder, int min_modes, RunRecord& record) const;
  bool try_until_done(const Input& input, int min_modes, const std::atomic<bool>* stop, std::filesystem::path& folder,
                      Run& run) const;
  void put_away(const std::filesystem::path& folder, const std::string& id, Run& run);

  SolverCommand command_;
  std::vector<std::string> names_;
  std::vector<Template> templates_;
  std::vector<Template> arguments_;
  std::vector<Template> retry_arguments_;
  std::string constants_;  ///< all that is the same for every run, for the digest
  std::unique_ptr<RunFolders> folders_;
  std::unique_ptr<InputFiles> files_;
  std::unique_ptr<RunStore> store_;
  bool is_resumed_ = false;
  bool is_task_ = false;
};

}  // namespace mottle::drivers
