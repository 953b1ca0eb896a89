// What is being done, how much of it is finished and how long it may still take, in one line. It states no time that
// was not measured: neither a share nor a time left is shown before something has been finished.
#pragma once

#include <cstdint>
#include <deque>
#include <string>

#include "mottle/core/run_context.hpp"

namespace mottle::app {

/// The line of progress as a function of what was reported and of the time, in seconds on any steady clock.
class ProgressLine {
 public:
  /// A phase begins. The time of finished ones of the same name says how long it may take.
  void begin(const Phase& phase, double now);
  /// `done` of `total` units of `work` are finished; `total` 0: their number is not known.
  void count(const std::string& work, std::int64_t done, std::int64_t total, double now);

  /// Stands behind the counts until the next phase: "12 tasks running, 30 waiting".
  void set_detail(const std::string& text) { detail_ = text; }

  /// "iteration 3 of at most 30: model runs 400 of 1000 (40 %), 4 s each, at most 2 min left".
  std::string text(double now) const;

 private:
  struct Count {
    double time = 0.0;
    std::int64_t done = 0;
  };

  double seconds_a_step() const;
  std::string work_text() const;
  std::string time_text(double now) const;

  Phase phase_;
  double phase_start_ = 0.0;
  std::deque<double> steps_;  // seconds of the last finished phases of this name
  std::string work_;
  std::string detail_;
  std::int64_t done_ = 0, total_ = 0;
  std::deque<Count> counts_;  // of late: the rate is theirs
};

}  // namespace mottle::app
