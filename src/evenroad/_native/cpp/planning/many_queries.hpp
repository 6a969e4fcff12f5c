// Answers to many queries of arms, by several threads.  An answer depends neither on other queries nor on threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/matrix.hpp"
#include "planning/query.hpp"

namespace evenroad::planning {

/// The checks of a world, and of one with more clearance, in which paths keep away from obstacles.
struct QueryWorld {
  std::shared_ptr<const robot::Checker> checker, roomier;
};

class ManyQueries {
 public:
  /// Query i leads from row 2 i of `terminals` to the next one in world `of[i]`.  The arrays must outlive this.
  ManyQueries(std::vector<QueryWorld> worlds, std::span<const std::int64_t> of, Matrix<const double> terminals,
              const Drivers& drivers, QueryLimits limits, Smoothing smoothing);

  /// Answer more queries, in order, until all are answered or this time has passed; return the number answered.
  std::size_t go_on(std::size_t threads, double seconds);

  std::span<const Answer> answers() const { return answers_; }

 private:
  Answer answered(std::size_t query) const;

  std::vector<QueryWorld> worlds_;
  std::span<const std::int64_t> of_;
  Matrix<const double> terminals_;
  Drivers drivers_;
  QueryLimits limits_;
  Smoothing smoothing_;
  std::vector<Answer> answers_;
  std::size_t count_ = 0;
};

}  // namespace evenroad::planning
