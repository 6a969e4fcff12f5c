// The time of a query, for long loops: they regularly look at the clock, and throw when the time is over.
//
// Python limits the time of its thread (evenroad._time_limit); threads that are started here set their own limits.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>

namespace evenroad {

using SteadyClock = std::chrono::steady_clock;

/// Thrown when the time is over; Python sees evenroad._time_limit.BudgetSpent.
struct TimeIsOver : std::exception {
  const char* what() const noexcept override { return "the time is over"; }
};

/// Lets another thread end the work of a query early.
struct Stop {
  std::atomic<bool> is_set = false;
};

/// The deadline of this thread.
constinit inline thread_local SteadyClock::time_point end_of_time = SteadyClock::time_point::max();
/// What ends the work of this thread before its deadline, or null.
constinit inline thread_local const Stop* early_stop = nullptr;

inline void look_at_clock() {
  if (early_stop != nullptr && early_stop->is_set.load(std::memory_order_relaxed)) throw TimeIsOver();
  if (end_of_time != SteadyClock::time_point::max() && SteadyClock::now() >= end_of_time) throw TimeIsOver();
}

/// Looks at the clock once per number of calls.
class ClockWatch {
 public:
  explicit ClockWatch(int every) : every_(every) {}

  void look() {
    if (++calls_ < every_) return;
    calls_ = 0;
    look_at_clock();
  }

 private:
  int every_, calls_ = 0;
};

/// Return the time this many seconds from now; a number that is too large, or NaN, never ends.
inline SteadyClock::time_point end_after(double seconds) {
  if (!(seconds < 1e9)) return SteadyClock::time_point::max();
  return SteadyClock::now() +
         std::chrono::duration_cast<SteadyClock::duration>(std::chrono::duration<double>(std::max(seconds, 0.0)));
}

/// Limits the time of this thread, in addition to earlier limits, during its lifetime.
class TimeLimit {
 public:
  explicit TimeLimit(double seconds) : outer_(end_of_time) { end_of_time = std::min(outer_, end_after(seconds)); }
  ~TimeLimit() { end_of_time = outer_; }
  TimeLimit(const TimeLimit&) = delete;
  TimeLimit& operator=(const TimeLimit&) = delete;

 private:
  SteadyClock::time_point outer_;
};

}  // namespace evenroad
