// Ranks that are threads of this process, for tests of what ranks share.
#pragma once

#include <barrier>
#include <exception>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "mottle/core/ranks.hpp"

namespace mottle::test {

/// What the ranks of one job have in common.
class ThreadJob {
 public:
  explicit ThreadJob(int count) : count_(count), meeting_(count), given_(static_cast<std::size_t>(count)) {}

  /// Calls body(ranks) by as many threads as there are ranks; the first exception of rank 0, else of another, is
  /// rethrown.
  template <typename Body>
  void run(const Body& body) {
    std::vector<std::exception_ptr> errors(static_cast<std::size_t>(count_));
    {
      std::vector<std::jthread> threads;
      for (int rank = 0; rank < count_; ++rank) {
        threads.emplace_back([&, rank] {
          Member ranks(*this, rank);
          try {
            body(ranks);
          } catch (...) {
            errors[static_cast<std::size_t>(rank)] = std::current_exception();
            meeting_.arrive_and_drop();
          }
        });
      }
    }
    for (const std::exception_ptr& error : errors) {
      if (error) std::rethrow_exception(error);
    }
  }

 private:
  class Member final : public Ranks {
   public:
    Member(ThreadJob& job, int rank) : job_(job), rank_(rank) {}
    int rank() const override { return rank_; }
    int count() const override { return job_.count_; }
    std::vector<std::string> gather(std::string_view bytes) override {
      job_.given_[static_cast<std::size_t>(rank_)] = bytes;
      job_.meeting_.arrive_and_wait();
      std::vector<std::string> all = job_.given_;
      job_.meeting_.arrive_and_wait();  // before anyone gives again
      return all;
    }
    std::int64_t add(std::uint64_t counter, std::int64_t amount) override {
      const std::lock_guard lock(job_.mutex_);
      std::int64_t& value = job_.counters_[counter];
      const std::int64_t before = value;
      value += amount;
      return before;
    }
    RankEnd leave(const RankEnd& own) override { return own; }
    void speak_by(Speaker /*speaker*/) override {}

   private:
    ThreadJob& job_;
    int rank_;
  };

  int count_;
  std::barrier<> meeting_;
  std::vector<std::string> given_;
  std::mutex mutex_;  // of the next
  std::map<std::uint64_t, std::int64_t> counters_;
};

}  // namespace mottle::test
