// The verdict of `abc`: of the model, not of the Monte-Carlo error of the estimate.
#include <gtest/gtest.h>

#include "mottle/model/function_model.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"
#include "mottle/updating/methods/abc.hpp"

namespace mottle::updating {
namespace {

/// Two parameters, four outputs with noise 0.02, the third curved over the population's width; `shift` is an error of
/// the model's fourth output.
UpdatingResult update_of_curved(std::uint64_t seed, double shift) {
  const auto function = [](const Eigen::VectorXd& x) {
    return Eigen::VectorXd(Eigen::Vector4d(x(0) + 0.3 * x(1), x(1) - 0.2 * x(0), 0.3 * x(0) * x(0), x(0) + x(1)));
  };
  std::vector<Quantity> outputs;
  for (const char* name : {"a", "b", "c", "d"}) outputs.push_back(named_quantity(name, "-"));
  const FunctionModel model(2, outputs, function);
  const Distribution prior({.kind = DistributionKind::normal, .mean = 3.5, .std = 1.0});
  const ParameterSpace space({{"a", "-"}, {"b", "-"}}, JointDistribution({prior, prior}));
  Eigen::MatrixXd tests(10, 4);
  for (Eigen::Index s = 0; s < 10; ++s) {
    RandomStream stream({.seed = 25, .purpose = StreamPurpose::truth}, static_cast<std::uint32_t>(s));
    const auto draw = [&] { return standard_normal_quantile(stream.uniform()); };
    const Eigen::Vector2d x(3.0 + 0.6 * draw(), 3.0 + 0.6 * draw());
    tests.row(s) = function(x).transpose();
    for (double& value : tests.row(s)) value += 0.02 * draw();
    tests(s, 3) += shift;
  }
  return AbcUpdater({.simulations = 4000})
      .update({.model = model,
               .space = space,
               .tests = {tests, Eigen::Vector4d::Constant(0.02)},
               .cloud = {.samples = 400}},
              {.seed = seed});
}

TEST(AbcVerdict, IsTheSameOfAllSeedsAndRefusesAnErrorOfTheModel) {
  std::vector<double> squares;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const UpdatingResult result = update_of_curved(seed, 0.0);
    ASSERT_GE(result.tests.size(), 2U);
    for (const VerdictTest& test : result.tests) EXPECT_TRUE(test.passed) << test.name << " of seed " << seed;
    squares.push_back(result.tests[1].statistic);
  }
  // Of chi-squared with 18 degrees of freedom, by fits of specimens that no seed has a part in.
  for (const double value : squares) EXPECT_NEAR(value, squares.front(), 1e-3 * squares.front());
  const UpdatingResult wrong = update_of_curved(1, 0.05);  // 8 standard errors of the mean
  EXPECT_FALSE(wrong.tests.front().passed);
}

}  // namespace
}  // namespace mottle::updating
