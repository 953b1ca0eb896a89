#include "mottle/model/function_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <limits>
#include <stdexcept>

#include "core/message_of.hpp"
#include "mottle/core/error.hpp"

namespace mottle::model {
namespace {

using test::message_of;
using ::testing::HasSubstr;

const std::vector<Quantity> k_outputs = {named_quantity("sum", "-"), named_quantity("product", "-")};

Eigen::VectorXd sum_and_product(const Eigen::VectorXd& x) {
  if (x(0) < -1.0) throw std::runtime_error("x1 is below -1");
  if (x(0) < 0.0) return Eigen::Vector2d(std::numeric_limits<double>::infinity(), 0.0);
  if (x(0) == 0.0) return Eigen::VectorXd::Zero(1);
  return Eigen::Vector2d(x.sum(), x.prod());
}

TEST(FunctionModel, GivesTheFunctionsValuesSampleBySampleOnAnyThreads) {
  const FunctionModel model(2, k_outputs, sum_and_product);
  Eigen::MatrixXd samples(3, 2);
  samples << 1, 2, 3, 4, 5, 6;
  for (const int threads : {1, 3}) {
    const Evaluation found = model.evaluate(samples, {.threads = threads});
    EXPECT_TRUE(found.failures.empty());
    EXPECT_EQ(found.outputs, (Eigen::MatrixXd(3, 2) << 3, 2, 7, 12, 11, 30).finished());
  }
}

TEST(FunctionModel, AFunctionThatThrowsOrGivesNoNumberFailsThatSampleAlone) {
  const FunctionModel model(2, k_outputs, sum_and_product);
  Eigen::MatrixXd samples(4, 2);
  samples << -2, 1, 1, 1, -0.5, 1, 0, 1;
  const Evaluation found = model.evaluate(samples, {.threads = 2});
  ASSERT_EQ(found.failures.size(), 3U);
  EXPECT_EQ(found.failures[0].sample, 0);
  EXPECT_EQ(found.failures[0].reason, "x1 is below -1");
  EXPECT_EQ(found.failures[1].reason, "output 'sum' is inf");
  EXPECT_EQ(found.failures[2].reason, "the function gave 1 values for 2 outputs");
  EXPECT_TRUE(found.outputs.row(0).array().isNaN().all());
  EXPECT_EQ(found.outputs.row(1), Eigen::RowVector2d(2, 1));
}

TEST(FunctionModel, AStopRequestEndsABatch) {
  const FunctionModel model(2, k_outputs, sum_and_product);
  const std::atomic<bool> stop = true;
  EXPECT_THROW(model.evaluate(Eigen::MatrixXd::Ones(4, 2), {.threads = 1, .observer = nullptr, .stop = &stop}),
               Stopped);
}

TEST(FunctionModel, RefusesOutputsThatCannotBeToldApart) {
  EXPECT_THAT(message_of<InvalidInput>([] {
                FunctionModel(2, {named_quantity("f", "Hz"), named_quantity("f", "Hz")}, sum_and_product);
              }),
              HasSubstr("'f' is there twice"));
  EXPECT_THAT(message_of<InvalidInput>([] { FunctionModel(2, {}, sum_and_product); }), HasSubstr("needs an output"));
  EXPECT_THAT(message_of<InvalidInput>([] { FunctionModel(0, k_outputs, sum_and_product); }),
              HasSubstr("needs a parameter"));
  EXPECT_THAT(message_of<InvalidInput>([] { FunctionModel(2, k_outputs, nullptr); }), HasSubstr("needs a function"));
}

}  // namespace
}  // namespace mottle::model
