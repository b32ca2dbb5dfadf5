// The "total" variances of runs: each is continued by reflection, so that long averages have more
// terms than the data alone would give. (TOTDEV is with the differences of single phases.)
#include "mean_squares.hpp"

#include <cmath>
#include <memory>
#include <vector>

namespace goingrate {
namespace {

// Mean over the 6m starts of squared second differences of means of m in a run of 3m values that is
// continued by its mirror images. `sums`: the 3m + 1 prefix sums of the run; `room`: 9m + 1 values
// to work in.
double mirrored_mean_square(const std::vector<double>& sums, std::size_t m,
                            std::vector<double>& room) {
  const std::size_t run = 3 * m;
  const double whole = sums[run];
  for (std::size_t k = 0; k <= run; ++k) {
    room[run + k] = whole + sums[k];
    room[run - k] = whole - sums[k];
  }
  // prefix sums of the second mirror image; those of the first are whole - sums already
  for (std::size_t k = 0; k <= run; ++k)
    room[3 * run - k] = 3.0 * whole - sums[k];
  const double* c = room.data();
  double even = 0.0, odd = 0.0; // two sums, so that one addition need not wait for the other
  for (std::size_t i = 0; i < 2 * run; i += 2) {
    const double a = (c[i + run] - c[i]) - 3.0 * (c[i + 2 * m] - c[i + m]);
    const double b = (c[i + 1 + run] - c[i + 1]) - 3.0 * (c[i + 1 + 2 * m] - c[i + 1 + m]);
    even += a * a;
    odd += b * b;
  }
  const double size = static_cast<double>(m);
  return (even + odd) / (static_cast<double>(2 * run) * size * size);
}

// The mean of mirrored_mean_square over all runs of 3m values, each less the line through the means
// of its halves (of an odd run the middle value is in neither half).
MeanSquare mean_over_runs(const double* values, std::size_t count, std::size_t m) {
  const std::size_t run = 3 * m, half = run / 2;
  if (m == 0 || run > count) return {};
  std::vector<double> sums(run + 1), room(9 * m + 1);
  const std::size_t runs = count - run + 1;
  double total = 0.0;
  for (std::size_t start = 0; start < runs; ++start) {
    const double* v = values + start;
    double sum = 0.0;
    for (std::size_t k = 0; k < run; ++k) {
      sums[k] = sum;
      sum += v[k] - v[0]; // a constant takes no part; without it the sums stay small
    }
    sums[run] = sum;
    const double first = sums[half], last = sums[run] - sums[run - half];
    const double slope = (last - first) / static_cast<double>(half * (run - half));
    for (std::size_t k = 0; k <= run; ++k) {
      const double index = static_cast<double>(k);
      sums[k] -= slope * 0.5 * index * (index - 1.0);
    }
    total += mirrored_mean_square(sums, m, room);
  }
  return {total / static_cast<double>(runs), runs};
}

} // namespace

MeanSquares modified_total(std::span<const double> x) {
  return one_by_one([x](std::size_t m) {
    MeanSquare mean = mean_over_runs(x.data(), x.size(), m);
    mean.value /= 2.0;
    return mean;
  });
}

MeanSquares hadamard_total(std::span<const double> x) {
  std::vector<double> steps;
  for (std::size_t i = 0; i + 1 < x.size(); ++i)
    steps.push_back(x[i + 1] - x[i]);
  return one_by_one(
      [x, steps = std::make_shared<const std::vector<double>>(std::move(steps))](std::size_t m) {
        if (m == 1) return at_one(phase_differences(x, true, 3, true), 1);
        MeanSquare mean = mean_over_runs(steps->data(), steps->size(), m);
        const double size = static_cast<double>(m); // the root is divided by tau, not by tau0
        mean.value *= size * size / 6.0;
        return mean;
      });
}

} // namespace goingrate
