// A flood from one cell over the sides of free cells.
#include "infeasibility/flood.hpp"

#include "common/time_limit.hpp"

namespace evenroad::infeasibility {

namespace {

constexpr int FLOODED_A_LOOK = 4096;  // number of cells between two looks at the clock

}  // namespace

std::vector<std::uint8_t> flood(std::span<const bool> free, std::span<const std::int64_t> count,
                                std::span<const bool> wrap, std::size_t from) {
  std::vector<std::uint8_t> reached(free.size());
  std::vector<std::size_t> waiting{from};
  reached[from] = 1;
  ClockWatch clock(FLOODED_A_LOOK);
  const auto visit = [&](std::size_t cell) {
    if (!free[cell] || reached[cell] != 0) return;
    reached[cell] = 1;
    waiting.push_back(cell);
  };
  while (!waiting.empty()) {
    const std::size_t cell = waiting.back();
    waiting.pop_back();
    clock.look();
    std::size_t stride = 1;
    for (std::size_t k = count.size(); k-- > 0;) {
      const std::size_t many = static_cast<std::size_t>(count[k]), number = cell / stride % many;
      const std::size_t around = (many - 1) * stride;
      if (number > 0) visit(cell - stride);
      if (number + 1 < many) visit(cell + stride);
      if (wrap[k] && number == 0) visit(cell + around);
      if (wrap[k] && number + 1 == many) visit(cell - around);
      stride *= many;
    }
  }
  return reached;
}

}  // namespace evenroad::infeasibility
