#include "fit/row_stack.hpp"

#include "goingrate/base/random.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <gtest/gtest.h>

namespace goingrate::timing_model {
namespace {

Eigen::MatrixXd noise(Eigen::Index rows, Eigen::Index columns) {
  RandomStream random(1, StreamPurpose::jitter);
  Eigen::MatrixXd x(rows, columns);
  for (double& value : x.reshaped())
    value = random.normal();
  x.col(0) *= 1e-6; // parameters differ in scale
  return x;
}

void add_rows(const Eigen::MatrixXd& x, RowStack& stack) {
  const Eigen::Index last = x.cols() - 1;
  for (Eigen::Index i = 0; i < x.rows(); ++i)
    stack.add(x(i, last), [&](Eigen::Index k) { return x(i, k); });
}

// |R'R - J'J| and |R'Q'r - J'r| do not depend on the signs of R's rows.
void expect_factor_of(const Eigen::MatrixXd& x, RowStack& stack) {
  const Eigen::MatrixXd j = x.leftCols(x.cols() - 1);
  const Eigen::VectorXd scale = j.colwise().norm().transpose().cwiseMax(1e-300);
  const Eigen::MatrixXd r = stack.triangle();
  EXPECT_TRUE(r.isUpperTriangular(0.0));
  const Eigen::MatrixXd off = scale.asDiagonal().inverse() *
                              (r.transpose() * r - j.transpose() * j) *
                              scale.asDiagonal().inverse();
  EXPECT_LT(off.cwiseAbs().maxCoeff(), 1e-13); // some roundings of a thousand rows
  const Eigen::VectorXd right = r.transpose() * stack.projected() - j.transpose() * x.col(j.cols());
  EXPECT_LE((right.array() / scale.array()).abs().maxCoeff(), 1e-13 * x.col(j.cols()).norm());
}

TEST(RowStackTest, EqualsTheFactorOfAllRowsAtOnce) {
  for (const Eigen::Index rows : {0, 3, 8, 9, 255, 256, 257, 1000})
    for (const Eigen::Index unknowns : {1, 5, 13}) {
      const Eigen::MatrixXd x = noise(rows, unknowns + 1);
      RowStack stack(unknowns);
      add_rows(x, stack);
      expect_factor_of(x, stack);
    }
}

TEST(RowStackTest, StacksJoin) {
  const Eigen::MatrixXd x = noise(600, 6);
  RowStack first(5), second(5);
  add_rows(x.topRows(250), first);
  add_rows(x.bottomRows(350), second);
  first.add(second);
  expect_factor_of(x, first);
}

TEST(RowStackTest, AColumnOfZerosIsKept) {
  Eigen::MatrixXd x = noise(300, 4);
  x.col(1).setZero();
  RowStack stack(3);
  add_rows(x, stack);
  expect_factor_of(x, stack);
}

} // namespace
} // namespace goingrate::timing_model
