#include <goingrate/dynamics/stationary.hpp>

#include <cstdio>

int main() {
  const goingrate::ClockParameters clock{2.0, 2.5e-4, 2e-5, 0.03};
  const auto cycle = goingrate::limit_cycle(clock);
  std::printf("%.6e\n", cycle->rate_excess);
  return 0;
}
