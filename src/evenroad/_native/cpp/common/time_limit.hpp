// The time of a query, for loops that may be long: they look at the clock now and then, and throw once it is over.
//
// Python limits the time of its thread (evenroad._time_limit); threads that are started here limit their own.
#pragma once

#include <algorithm>
#include <chrono>
#include <exception>

namespace evenroad {

using SteadyClock = std::chrono::steady_clock;

/// Thrown where the time is over; Python sees evenroad._time_limit.BudgetSpent.
struct TimeIsOver : std::exception {
  const char* what() const noexcept override { return "the time is over"; }
};

/// When the work of this thread has to end.
constinit inline thread_local SteadyClock::time_point end_of_time = SteadyClock::time_point::max();

inline void look_at_clock() {
  if (end_of_time != SteadyClock::time_point::max() && SteadyClock::now() >= end_of_time) throw TimeIsOver();
}

/// Looks at the clock once in a number of calls.
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

/// Return when that many seconds from now are over; any number that is too large, or none, is never over.
inline SteadyClock::time_point end_after(double seconds) {
  if (!(seconds < 1e9)) return SteadyClock::time_point::max();
  return SteadyClock::now() +
         std::chrono::duration_cast<SteadyClock::duration>(std::chrono::duration<double>(std::max(seconds, 0.0)));
}

/// Limits the work of this thread, besides earlier limits, as long as this lives.
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
