// The folder that a run fills: which file is called what, its log, and the journal that lets a killed run go on.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "mottle/core/error.hpp"
#include "mottle/core/run_context.hpp"
#include "mottle/layers.hpp"

namespace mottle::study {

inline constexpr const char* k_previous = "previous-results";
inline constexpr const char* k_journal = "resume.journal";  ///< of an update or a cloud
inline constexpr const char* k_log = "mottle.log";

// What stands for the results of a job; the last name says that they are complete. Not study.toml and tests.csv, which
// may be a study's input.
const std::vector<std::string>& result_names();    ///< of an update or a cloud
const std::vector<std::string>& specimen_names();  ///< of `simulate`
const std::vector<std::string>& modes_names();     ///< of `modes`

/// Where a run leaves its files.
class RunFolder {
 public:
  /// Makes the folder. Throws InvalidInput where nothing can be written there.
  explicit RunFolder(std::filesystem::path folder);

  const std::filesystem::path& path() const { return folder_; }
  std::filesystem::path file(const std::string& name) const { return folder_ / name; }

  /// Writes one file whole or not at all, and notes that it is Mottle's own.
  ///
  /// @throws InvalidInput  something else has that name, see may_be_own_result()
  void write(const std::string& name, const std::string& bytes) const;

  /// Takes results of an earlier run away, so that they do not stand as those of a run that fails: `names`, as far as
  /// they are there, go to the folder k_previous within this one, in place of what an earlier run left there. Without
  /// the last of the names they are what a run that did not come to its end had written: they stay, to be written over.
  ///
  /// @return  those that were moved
  /// @throws  InvalidInput: there is a folder of that name that this program did not make
  std::vector<std::string> set_aside(const std::vector<std::string>& names) const;
  /// Takes them back.
  void restore(const std::vector<std::string>& names) const;
  /// What `work` returns, with `names` set aside before. Where it finds the input wrong, they come back.
  template <typename Work>
  auto without_earlier(const std::vector<std::string>& names, const Work& work) const {
    const std::vector<std::string> aside = set_aside(names);
    try {
      return work();
    } catch (const InvalidInput&) {
      restore(aside);
      throw;
    }
  }
  /// New results are there: removes the earlier ones.
  void forget_previous(const std::vector<std::string>& names) const;

  /// The results of an update or a cloud are complete: the journal and earlier results are no longer needed.
  void finish() const;

  /// Takes away a file that does no harm where it stays.
  void remove(const std::string& name) const;

 private:
  std::filesystem::path folder_;
};

/// Writes what is reported into a log file, with the time since the start, and passes it on. Counts of work are written
/// every ten seconds at most; the last line says how the time was shared by the phases.
class LogObserver final : public ProgressObserver {
 public:
  /// @param next    may be null
  /// @param append  go on with the log of an interrupted run
  LogObserver(const std::filesystem::path& file, ProgressObserver* next, bool append);
  ~LogObserver() override;
  LogObserver(const LogObserver&) = delete;
  LogObserver& operator=(const LogObserver&) = delete;

  void phase(const Phase& next) override;
  void progress(const std::string& work, std::int64_t done, std::int64_t total) override;
  void detail(const std::string& text) override;
  void warning(const std::string& text) override;
  void note(const std::string& text) override;
  void finding(const std::string& text) override;

 private:
  /// Seconds of all phases of one name.
  struct Share {
    std::string name;
    double seconds = 0.0;
    int phases = 0;
  };

  void line(const char* kind, const std::string& text);
  void end_phase();
  bool is_due() const;

  std::FILE* stream_ = nullptr;
  ProgressObserver* next_;
  double start_;
  Phase phase_;
  double phase_start_ = 0.0;
  double last_count_ = 0.0;  // when progress was written last
  std::vector<Share> shares_;
};

}  // namespace mottle::study
