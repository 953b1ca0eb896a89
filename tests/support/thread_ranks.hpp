// Ranks that are threads of this process, for tests of what ranks share.
#pragma once

#include <atomic>
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
  /// rethrown. Where one has failed, the others fail as soon as they wait for it.
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
          } catch (const AnotherFailed&) {  // which has said why
            meeting_.arrive_and_drop();
          } catch (...) {
            errors[static_cast<std::size_t>(rank)] = std::current_exception();
            has_failed_ = true;
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
  struct AnotherFailed {};  // no std::exception: nobody is to take it for an error of the model

  void meet() {
    meeting_.arrive_and_wait();
    if (has_failed_) throw AnotherFailed();
  }

  class Member final : public Ranks {
   public:
    Member(ThreadJob& job, int rank) : job_(job), rank_(rank) {}
    int rank() const override { return rank_; }
    int count() const override { return job_.count_; }
    std::vector<std::string> gather(std::string_view bytes) override {
      job_.given_[static_cast<std::size_t>(rank_)] = bytes;
      job_.meet();
      std::vector<std::string> all = job_.given_;
      job_.meet();  // before anyone gives again
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
    void on_abort(OnAbort /*tell*/) override {}

   protected:
    Claim claim(const Digest& key, bool may_make, std::string& made) override {
      if (job_.has_failed_) throw AnotherFailed();
      const std::lock_guard lock(job_.mutex_);
      return job_.book_.claim(key, may_make, made);
    }
    void publish(const Digest& key, std::string_view made) override {
      const std::lock_guard lock(job_.mutex_);
      job_.book_.publish(key, made);
    }

   private:
    ThreadJob& job_;
    int rank_;
  };

  int count_;
  std::barrier<> meeting_;
  std::vector<std::string> given_;
  std::atomic<bool> has_failed_{false};
  std::mutex mutex_;  // of the next two
  OnceBook book_;
  std::map<std::uint64_t, std::int64_t> counters_;
};

}  // namespace mottle::test
