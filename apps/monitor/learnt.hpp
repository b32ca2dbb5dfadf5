// What was learnt about a clock, as numbers that an index keeps.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace goingrate::apps {

/// Numbers that are written one after the other, or read back in the same order by the same calls.
/// If they come to an end, or are not of the form that is read, the reader says so, and what it was
/// to fill is of no use.
class Learnt {
public:
  Learnt() = default; ///< writes
  explicit Learnt(std::vector<double> numbers) : numbers_(std::move(numbers)), reads_(true) {}

  void operator()(double& number) { pass(number); }
  template <class Number> void operator()(Number& number) {
    auto passed = static_cast<double>(number);
    pass(passed);
    if (reads_) number = static_cast<Number>(passed);
  }
  void operator()(std::optional<double>& number) {
    bool is_known = number.has_value();
    (*this)(is_known);
    if (!is_known) return number.reset();
    if (!number) number = 0.0;
    pass(*number);
  }
  void operator()(std::deque<double>& many) {
    std::size_t size = many.size();
    (*this)(size);
    if (reads_) many.resize(size <= numbers_.size() ? size : 0);
    for (double& number : many)
      pass(number);
  }

  [[nodiscard]] const std::vector<double>& numbers() const { return numbers_; }
  /// Whether all numbers were read back, and no more were asked for.
  [[nodiscard]] bool is_read_whole() const {
    return reads_ && !has_failed_ && at_ == numbers_.size();
  }

private:
  void pass(double& number) {
    if (!reads_)
      numbers_.push_back(number);
    else if (at_ < numbers_.size())
      number = numbers_[at_++];
    else
      has_failed_ = true;
  }

  std::vector<double> numbers_;
  std::size_t at_ = 0;
  bool reads_ = false, has_failed_ = false;
};

} // namespace goingrate::apps
