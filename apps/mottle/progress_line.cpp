#include "progress_line.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "mottle/core/clock.hpp"

namespace mottle::app {
namespace {

constexpr double k_shown_s = 1.0;  // shorter times are not worth words

}  // namespace

void ProgressLine::begin(const Phase& phase, double now) {
  constexpr std::size_t k_remembered = 5;
  if (phase.step > 0 && phase.name == phase_.name) {
    steps_.push_back(now - phase_start_);
    if (steps_.size() > k_remembered) steps_.pop_front();
  } else {
    steps_.clear();
  }
  phase_ = phase;
  phase_start_ = now;
  work_.clear();
  detail_.clear();
  done_ = total_ = 0;
  counts_.clear();
}

void ProgressLine::count(const std::string& work, std::int64_t done, std::int64_t total, double now) {
  constexpr double k_window_s = 20.0;
  constexpr double k_spacing_s = 0.5;
  if (work != work_ || total != total_ || done < done_) counts_.clear();
  work_ = work;
  done_ = done;
  total_ = total;
  if (counts_.empty() || now - counts_.back().time >= k_spacing_s) counts_.push_back({now, done});
  while (counts_.size() > 2 && now - counts_[1].time > k_window_s) counts_.pop_front();
}

double ProgressLine::seconds_a_step() const {
  return steps_.empty() ? 0.0 : std::accumulate(steps_.begin(), steps_.end(), 0.0) / static_cast<double>(steps_.size());
}

std::string ProgressLine::work_text() const {
  if (work_.empty()) return "";
  if (total_ == 0) return fmt::format(": {} {}", work_, done_);
  const double percent = 100.0 * static_cast<double>(done_) / static_cast<double>(total_);
  return fmt::format(": {} {} of {} ({:.0f} %)", work_, done_, total_, percent);
}

std::string ProgressLine::time_text(double now) const {
  const double elapsed = now - phase_start_;
  if (const double each = seconds_a_step(); each > 0.0) {
    const auto after = static_cast<double>(phase_.steps - phase_.step);
    const double left = each * after + std::max(each - elapsed, 0.0);
    if (left < k_shown_s) return "";
    if (!phase_.may_end_early) return fmt::format(", about {} left", duration_text(left));
    const std::string pace = each < k_shown_s ? "" : fmt::format(", about {} each", duration_text(each));
    return fmt::format("{}, at most {} left", pace, duration_text(left));
  }
  if (!counts_.empty() && done_ > counts_.front().done && now - counts_.front().time >= k_shown_s) {
    const double rate = static_cast<double>(done_ - counts_.front().done) / (now - counts_.front().time);
    const double left = static_cast<double>(total_ - done_) / rate;
    const std::string of = phase_.step > 0 ? " of it" : "";
    if (total_ > 0) return left < k_shown_s ? "" : fmt::format(", about {} left{}", duration_text(left), of);
  }
  return elapsed < 2.0 * k_shown_s ? "" : fmt::format(", {} so far", duration_text(elapsed));
}

std::string ProgressLine::text(double now) const {
  const std::string detail = detail_.empty() ? "" : fmt::format(", {}", detail_);
  return phase_.text() + work_text() + detail + time_text(now);
}

}  // namespace mottle::app
