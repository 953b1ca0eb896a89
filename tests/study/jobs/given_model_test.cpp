// Updates of a model that a program gives.
#include "mottle/study/jobs/given_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/temporary_folder.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/study/results/run_folder.hpp"

namespace mottle::study {
namespace {

/// Two springs in a row: y = (x1, sqrt(x1 x2)); stops at a batch as it is told, and counts its batches of ten.
class Springs final : public Model {
 public:
  explicit Springs(int stops_at = -1) : stops_at_(stops_at) {}
  Eigen::Index parameter_count() const override { return 2; }
  const std::vector<Quantity>& outputs() const override { return outputs_; }
  Eigen::Index batch_size() const override { return 10; }
  Evaluation evaluate(const Eigen::Ref<const Eigen::MatrixXd>& samples, const RunContext&) const override {
    if (batches == stops_at_) throw Stopped("on purpose");
    ++batches;
    Evaluation result;
    result.outputs.resize(samples.rows(), 2);
    result.outputs << samples.col(0), samples.rowwise().prod().cwiseSqrt();
    return result;
  }
  mutable int batches = 0;

 private:
  int stops_at_;
  std::vector<Quantity> outputs_{named_quantity("a", "N/m"), named_quantity("b", "N/m")};
};

GivenStudy study_of(std::shared_ptr<const Springs> model) {
  const auto normal = [](double mean) {
    return Distribution({.kind = DistributionKind::normal, .mean = mean, .std = 0.1});
  };
  GivenStudy given{.model = std::move(model),
                   .space = ParameterSpace({{.name = "x1", .unit = "-"}, {.name = "x2", .unit = "-"}},
                                           JointDistribution({normal(1.0), normal(1.2)})),
                   .tests = {.values = Eigen::MatrixXd(6, 2), .repeatability_std = Eigen::Vector2d(0.01, 0.01)}};
  given.tests.values << 1.10, 1.21, 1.15, 1.18, 1.05, 1.16, 1.12, 1.25, 1.08, 1.20, 1.14, 1.22;
  given.update.samples = 100;
  given.title = "two springs";
  return given;
}

Eigen::MatrixXd found_in(const UpdateOutcome& outcome) {
  Eigen::MatrixXd found(2, 3);
  found << outcome.result.mean, outcome.result.covariance;
  return found;
}

TEST(GivenModel, IsUpdatedAndWrittenAsAStudyIs) {
  const test::TemporaryFolder folder;
  const UpdateOutcome outcome = update(study_of(std::make_shared<Springs>()), {.folder = folder / "results"});
  // a is x1 itself: its population is that of the tests but for the noise, (0.03777^2 - 0.01^2)^0.5 about 1.10667.
  EXPECT_NEAR(outcome.result.mean(0), 1.10667, 2e-4);
  EXPECT_NEAR(std::sqrt(outcome.result.covariance(0, 0)), 0.03642, 2e-4);  // b tells a little of x1, too
  write_results(outcome, folder / "results");
  const auto json = nlohmann::json::parse(read_file(folder / "results" / "result.json"));
  EXPECT_EQ(json["title"], "two springs");
  EXPECT_EQ(json["outputs"]["units"][1], "N/m");
  EXPECT_TRUE(json["verdict"]["next"][0]["command"].is_null());
  EXPECT_EQ(summarise(outcome, folder / "results").status, status_text(outcome.result.status));
}

TEST(GivenModel, GoesOnWhereItWasStopped) {
  const test::TemporaryFolder folder;
  const auto whole = std::make_shared<Springs>();
  const Eigen::MatrixXd wanted = found_in(update(study_of(whole), {}));
  for (const int at : {0, 3, 11, whole->batches - 1}) {
    const std::filesystem::path place = folder / std::to_string(at);
    EXPECT_THROW(update(study_of(std::make_shared<Springs>(at)), {.folder = place}), Stopped);
    const auto model = std::make_shared<Springs>();
    EXPECT_EQ(found_in(update(study_of(model), {.folder = place, .resume = true})), wanted) << at;
    EXPECT_EQ(model->batches, whole->batches - at);
    GivenStudy other = study_of(model);
    other.tests.values(0, 0) += 1e-9;
    EXPECT_THROW(update(std::move(other), {.folder = place, .resume = true}), InvalidInput);
  }
}

TEST(GivenModel, RefusesWhatDoesNotFit) {
  const auto refuse = [](const auto& change) {
    GivenStudy given = study_of(std::make_shared<Springs>());
    change(given);
    EXPECT_THROW(update(std::move(given), {}), InvalidInput);
  };
  refuse([](GivenStudy& given) { given.tests.values.conservativeResize(6, 1); });
  refuse([](GivenStudy& given) { given.tests.values.col(1).setConstant(std::nan("")); });
  refuse([](GivenStudy& given) { given.tests.values(2, 1) = std::numeric_limits<double>::infinity(); });
  refuse([](GivenStudy& given) { given.update.method = "maximum-likelyhood"; });
}

}  // namespace
}  // namespace mottle::study
