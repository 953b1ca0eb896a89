// A model behind our own server, asked by our own client in the same process: values, derivatives, faults, stop.
// Foreign servers and clients are in tests/apps/umbridge_test.py.
#include "mottle/drivers/umbridge/umbridge_solver.hpp"

#include <gmock/gmock.h>

#include <atomic>
#include <cmath>
#include <numbers>
#include <thread>

#include "core/temporary_folder.hpp"
#include "mottle/core/error.hpp"
#include "mottle/drivers/umbridge/model_server.hpp"
#include "mottle/model/structure_model.hpp"

namespace {

using mottle::InvalidInput;
using mottle::SystemFailure;
using mottle::drivers::FrequencyRule;
using mottle::drivers::ModelServer;
using mottle::drivers::ServedModel;
using mottle::drivers::UmbridgeServer;
using mottle::drivers::UmbridgeSolver;
using mottle::model::Evaluation;
using mottle::model::StructureModel;
using testing::HasSubstr;
using testing::ThrowsMessage;

const Eigen::Vector2d k_means(2.0, 3.0);

/// y = (a b, a + b^2, 5), as numbers of Hz; fails for a > 90.
ServedModel polynomial() {
  return {.inputs = 2,
          .outputs = 3,
          .evaluate =
              [](const Eigen::MatrixXd& x) {
                Evaluation found{.outputs = Eigen::MatrixXd(x.rows(), 3), .failures = {}};
                found.outputs.col(0) = x.col(0).cwiseProduct(x.col(1));
                found.outputs.col(1) = x.col(0) + x.col(1).cwiseAbs2();
                found.outputs.col(2).setConstant(5.0);
                for (Eigen::Index s = 0; s < x.rows(); ++s) {
                  if (x(s, 0) > 90.0) found.failures.push_back({s, "it buckles"});
                }
                return found;
              },
          .jacobian =
              [](const Eigen::VectorXd& x) {
                if (x(0) > 80.0) throw InvalidInput("no derivative there");
                return (Eigen::MatrixXd(3, 2) << x(1), x(0), 1.0, 2.0 * x(1), 0.0, 0.0).finished();
              },
          .batch = 8};
}

class Umbridge : public testing::Test {
 protected:
  ~Umbridge() override {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  void serve(ServedModel model = polynomial()) {
    server_ = std::make_unique<ModelServer>(std::move(model), 0);
    thread_ = std::thread([this] { server_->serve({.stop = &stop_}); });
    description_.urls = {mottle::drivers::parse_http_address(server_->address())};
    description_.timeout = std::chrono::seconds(20);
    description_.retries = 0;
    description_.max_failed_fraction = 1.0;
  }
  std::unique_ptr<UmbridgeSolver> make(const std::vector<std::string>& names = {"a", "b"}, bool is_resumed = false,
                                       const std::filesystem::path& results = {}) {
    return std::make_unique<UmbridgeSolver>(description_, names, k_means,
                                            mottle::drivers::RunStorage{results, is_resumed}, nullptr);
  }
  StructureModel model() { return {make(), {.frequencies = {1, 2}}, k_means}; }

  UmbridgeServer description_;
  std::atomic<bool> stop_{false};
  std::unique_ptr<ModelServer> server_;
  std::thread thread_;
};

TEST_F(Umbridge, OutputsAreFrequenciesByPosition) {
  serve();
  description_.parallel = 4;
  Eigen::MatrixXd samples = Eigen::MatrixXd::Random(200, 2).array() + 3.0;
  const Evaluation found = model().evaluate(samples, {});
  ASSERT_TRUE(found.failures.empty());
  for (Eigen::Index s = 0; s < samples.rows(); ++s) {
    // (2 pi f)^2 and its root round three times
    EXPECT_NEAR(found.outputs(s, 0), samples(s, 0) * samples(s, 1), 1e-14 * 16.0);
    EXPECT_NEAR(found.outputs(s, 1), samples(s, 0) + samples(s, 1) * samples(s, 1), 1e-14 * 20.0);
  }
}

TEST_F(Umbridge, DerivativesAreTheModels) {
  serve();
  const Eigen::Vector2d x(1.5, 2.5);
  const StructureModel made = model();
  ASSERT_NE(made.derivatives(), nullptr);
  const Eigen::MatrixXd wanted = (Eigen::MatrixXd(2, 2) << 2.5, 1.5, 1.0, 5.0).finished();
  EXPECT_TRUE(made.jacobian(x).isApprox(wanted, 1e-12));
  EXPECT_TRUE(made.has_cheap_jacobian());
  description_.uses_derivatives = false;
  EXPECT_EQ(model().derivatives(), nullptr);
}

TEST_F(Umbridge, AFailedDerivativeIsLeftToDifferences) {
  serve();
  EXPECT_TRUE(model().jacobian(Eigen::Vector2d(85.0, 1.0)).array().isNaN().all());
}

TEST_F(Umbridge, AParameterMayStandInSeveralPlaces) {
  serve();
  description_.inputs = {{{.parameter = "a"}, {.parameter = "a"}}};
  const UmbridgeSolver solver(description_, {"a"}, Eigen::VectorXd::Constant(1, 2.0), {}, nullptr);
  const Eigen::VectorXd x = Eigen::VectorXd::Constant(1, 3.0);
  const auto modes = solver.modes_at(x, 2);
  const double two_pi = 2.0 * std::numbers::pi;
  EXPECT_NEAR(std::sqrt(modes.eigenvalues(1)) / two_pi, 12.0, 1e-13);
  // d (a + a^2) = 1 + 2 a; d lambda = 8 pi^2 f df
  EXPECT_NEAR(solver.eigenvalue_derivatives(x, modes)(1, 0), 2.0 * two_pi * two_pi * 12.0 * 7.0, 1e-8);
}

TEST_F(Umbridge, OtherQuantities) {
  serve();
  description_.quantity = FrequencyRule::Quantity::eigenvalue;
  EXPECT_EQ(make()->modes_at(Eigen::Vector2d(1.0, 4.0), 1).eigenvalues(0), 4.0);
  description_.quantity = FrequencyRule::Quantity::radians;
  const auto solver = make();
  const auto modes = solver->modes_at(Eigen::Vector2d(1.0, 4.0), 1);
  EXPECT_EQ(modes.eigenvalues(0), 16.0);
  EXPECT_NEAR(solver->eigenvalue_derivatives(Eigen::Vector2d(1.0, 4.0), modes)(0, 0), 2.0 * 4.0 * 4.0, 1e-13);
}

TEST_F(Umbridge, DerivativesBeginWithTheValuesThatABatchHas) {
  ServedModel counting = polynomial();
  std::atomic<int> count{0};
  counting.evaluate = [&count, quick = counting.evaluate](const Eigen::MatrixXd& x) {
    count += static_cast<int>(x.rows());
    return quick(x);
  };
  serve(counting);
  const StructureModel made = model();
  const Eigen::Vector2d x(1.5, 2.5);
  ASSERT_TRUE(made.evaluate(x.transpose(), {}).failures.empty());
  EXPECT_EQ(count, 2) << "the means and x";
  EXPECT_TRUE(made.jacobian(x).allFinite());
  EXPECT_EQ(count, 2);
}

TEST_F(Umbridge, AFailedRunCostsItsSampleAlone) {
  serve();
  const Evaluation found = model().evaluate((Eigen::MatrixXd(3, 2) << 1, 1, 95, 1, 2, 2).finished(), {});
  ASSERT_EQ(found.failures.size(), 1U);
  EXPECT_EQ(found.failures[0].sample, 1);
  EXPECT_THAT(found.failures[0].reason, HasSubstr("HTTP 500: InvalidOutput: it buckles"));
  EXPECT_NEAR(found.outputs(2, 1), 6.0, 1e-13);
}

TEST_F(Umbridge, TooManyFailuresStopIt) {
  serve();
  description_.max_failed_fraction = 0.25;
  EXPECT_THAT([&] { model().evaluate(Eigen::MatrixXd::Constant(30, 2, 95.0), {}); },
              ThrowsMessage<SystemFailure>(HasSubstr("at most 25 % may")));
}

TEST_F(Umbridge, WhatDoesNotFitIsRefused) {
  serve();
  EXPECT_THAT([&] { make({"a"}); },
              ThrowsMessage<InvalidInput>(HasSubstr("2 numbers in all, and there are 1 parameters")));
  description_.output = 1;
  EXPECT_THAT([&] { make(); }, ThrowsMessage<InvalidInput>(HasSubstr("output: is 1")));
  description_.output.reset();
  description_.name = "backward";
  EXPECT_THAT([&] { make(); }, ThrowsMessage<InvalidInput>(HasSubstr("name: ")));
}

TEST_F(Umbridge, AServerThatIsGoneIsAFailure) {
  serve();
  const StructureModel made = model();
  stop_ = true;
  thread_.join();
  server_.reset();
  const Evaluation found = made.evaluate(Eigen::MatrixXd::Ones(2, 2), {});
  ASSERT_EQ(found.failures.size(), 2U);
  EXPECT_THAT(found.failures[0].reason, HasSubstr("no connection: Connection refused"));
  EXPECT_THAT([&] { make(); }, ThrowsMessage<SystemFailure>(HasSubstr("is the model's server running?")));
}

TEST_F(Umbridge, SlowEvaluationsAreKeptForAResumedJobAlone) {
  std::atomic<int> count{0};
  ServedModel slow = polynomial();
  slow.evaluate = [&count, quick = slow.evaluate](const Eigen::MatrixXd& x) {
    count += static_cast<int>(x.rows());
    std::this_thread::sleep_for(std::chrono::milliseconds(70));
    return quick(x);
  };
  serve(slow);
  const mottle::test::TemporaryFolder folder;
  const Eigen::MatrixXd samples = (Eigen::MatrixXd(2, 2) << 1, 1, 2, 2).finished();
  const auto evaluate = [&](bool is_resumed) {
    return StructureModel(make({"a", "b"}, is_resumed, folder / "results"), {.frequencies = {1}}, k_means)
        .evaluate(samples, {});
  };
  const Evaluation first = evaluate(false);
  EXPECT_EQ(count, 3);
  const Evaluation resumed = evaluate(true);
  EXPECT_EQ(count, 4) << "the means alone";
  EXPECT_EQ(resumed.outputs, first.outputs);
  EXPECT_EQ(resumed.use.repeated, 2);
  evaluate(false);
  EXPECT_EQ(count, 7) << "the model may be another one by now";
}

TEST_F(Umbridge, AStopRequestEndsARequest) {
  ServedModel slow = polynomial();
  std::atomic<bool> is_asked{false};
  std::atomic<bool> is_answered{false};
  slow.evaluate = [&, quick = slow.evaluate](const Eigen::MatrixXd& x) {
    if (x(0, 0) == 1.0) {
      is_asked = true;
      std::this_thread::sleep_for(std::chrono::seconds(3));
      is_answered = true;
    }
    return quick(x);
  };
  serve(slow);
  const StructureModel made = model();
  std::atomic<bool> stop{false};
  std::jthread asker([&] {
    while (!is_asked) std::this_thread::yield();
    stop = true;
  });
  EXPECT_THROW(made.evaluate(Eigen::MatrixXd::Ones(1, 2), {.stop = &stop}), mottle::Stopped);
  EXPECT_FALSE(is_answered) << "the request was waited for";
}

}  // namespace
