// Threads take queries one by one, so that every query taken is answered, and hard ones do not delay others.
#include "planning/many_queries.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <future>
#include <utility>

#include "common/time_limit.hpp"

namespace evenroad::planning {

ManyQueries::ManyQueries(std::vector<QueryWorld> worlds, std::span<const std::int64_t> of,
                         Matrix<const double> terminals, const Drivers& drivers, QueryLimits limits,
                         Smoothing smoothing)
    : worlds_(std::move(worlds)),
      of_(of),
      terminals_(terminals),
      drivers_(drivers),
      limits_(limits),
      smoothing_(smoothing),
      answers_(of.size()) {}

std::size_t ManyQueries::go_on(std::size_t threads, double seconds) {
  const auto began = SteadyClock::now();
  std::atomic<std::size_t> next = count_;
  const auto work = [&] {
    do {
      const std::size_t query = next.fetch_add(1);
      if (query >= answers_.size()) return;
      answers_[query] = answered(query);
    } while (std::chrono::duration<double>(SteadyClock::now() - began).count() < seconds);
  };
  std::vector<std::future<void>> others;
  for (std::size_t i = 1; i < std::min(threads, answers_.size() - count_); i++) {
    others.push_back(std::async(std::launch::async, work));
  }
  work();
  for (std::future<void>& other : others) other.get();
  count_ = std::min(next.load(), answers_.size());
  return count_;
}

Answer ManyQueries::answered(std::size_t query) const {
  const QueryWorld& world = worlds_[static_cast<std::size_t>(of_[query])];
  const Matrix<const double> terminals{terminals_[2 * query].data(), 2, terminals_.columns};
  const TimeLimit time(limits_.seconds);
  Answer found = answer(world.checker, terminals, drivers_, limits_, smoothing_);
  if (world.roomier && found.growth == Growth::SOLVED)
    smooth_with_clearance(found, world.checker, world.roomier, drivers_);
  found.raw = {};
  return found;
}

}  // namespace evenroad::planning
