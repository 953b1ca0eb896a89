// A study as plain data: what each key becomes, and what holds where it is not given.
#include <gtest/gtest.h>

#include "support/study_refusals.hpp"

namespace mottle::study {
namespace {

using test::three_masses;

Study read(const std::string& text) {
  return read_study_text(text, "folder/study.toml");
}

TEST(PlainData, HoldsTheHeadOfAStudy) {
  const Study study = read(three_masses());
  EXPECT_EQ(study.title, "A study for tests");
  EXPECT_EQ(study.units, "SI");
  EXPECT_EQ(study.seed, 7U);
  const Study bare = read(three_masses({{"title = \"A study for tests\"\nunits = \"SI\"\nseed = 7\n", ""}}));
  EXPECT_EQ(bare.title, "study");  // as its file
  EXPECT_EQ(bare.units, "SI");
  EXPECT_EQ(bare.seed, 1U);
}

TEST(PlainData, HoldsParametersWithTheirBoundsAndScales) {
  const Study study = read(three_masses(
      {{"target = \"spring:k2\"", "target = [\"spring:k2\", \"spring:k5\"]\nrelative = true\nscale = \"log\""}}));
  ASSERT_EQ(study.parameters.list.size(), 2U);
  const StudyParameter& first = study.parameters.list[0];
  EXPECT_EQ(first.name, "k1");
  EXPECT_EQ(first.targets, (std::vector<std::string>{"spring:k1"}));
  EXPECT_FALSE(first.is_factor);
  EXPECT_EQ(first.distribution.kind, DistributionKind::normal);
  EXPECT_EQ(first.distribution.mean, 2.0);
  EXPECT_EQ(first.distribution.std, 0.3);
  EXPECT_EQ(first.lower_bound, 0.5);
  EXPECT_EQ(first.upper_bound, 3.0);
  EXPECT_EQ(first.transform.kind, ParameterTransform::Kind::identity);
  const StudyParameter& second = study.parameters.list[1];
  EXPECT_EQ(second.targets, (std::vector<std::string>{"spring:k2", "spring:k5"}));
  EXPECT_TRUE(second.is_factor);
  EXPECT_EQ(second.lower_bound, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(second.transform.kind, ParameterTransform::Kind::log);
}

TEST(PlainData, TakesTheScaleThatGoesWithThePriorWhereNoneIsStated) {
  using Kind = ParameterTransform::Kind;
  const auto transform = [](const std::string& distribution, const std::string& more = "") {
    return read(three_masses({{"{ kind = \"normal\", mean = 2.0, std = 0.3 }\nbounds = [0.5, 3.0]",
                               "{ " + distribution + " }\nbounds = [0.5, 3.0]" + more}}))
        .parameters.list[0]
        .transform;
  };
  EXPECT_EQ(transform("kind = \"lognormal\", mean = 2.0, std = 0.3").kind, Kind::log);
  EXPECT_EQ(transform("kind = \"lognormal\", mean = 2.0, std = 0.3", "\nscale = \"identity\"").kind, Kind::identity);
  const ParameterTransform beta = transform("kind = \"beta\", mean = 2.0, std = 0.3, lower = 1.0, upper = 2.5");
  EXPECT_EQ(beta.kind, Kind::logit);
  EXPECT_EQ(beta.lower, 1.0);  // the prior's ends, not the parameter's bounds
  EXPECT_EQ(beta.upper, 2.5);
  EXPECT_EQ(transform("kind = \"uniform\", lower = 1.0, upper = 2.5").kind, Kind::identity);
}

TEST(PlainData, HoldsTheCorrelationOfParameters) {
  const auto correlation = [](const std::string& section) {
    return read(three_masses({{"[outputs]", section + "\n[outputs]"}})).parameters.correlation;
  };
  Eigen::Matrix2d expected;
  expected << 1.0, 0.25, 0.25, 1.0;
  EXPECT_EQ(correlation("[correlation]\npairs = [{ between = [\"k2\", \"k1\"], value = 0.25 }]"), expected);
  EXPECT_EQ(correlation("[correlation]\nmatrix = [[1, 0.25], [0.25, 1.0]]"), expected);
  EXPECT_TRUE(correlation("").isIdentity(0.0));
}

TEST(PlainData, HoldsOutputs) {
  const OutputSelection outputs =
      read(three_masses(
               {{"frequencies = [1, 2, 3]",
                 "frequencies = [1, 3]\ndamping = [2]\neigenvalues = [2]\ntracking = \"mac\"\nminimum_mac = 0.7\n"
                 "shapes = { modes = [1], dofs = [\"m1\", \"m3\"], size = \"free\" }\n"
                 "static = [{ forces = { m3 = 1.5 }, dofs = [\"m2\"] }]\n"
                 "shape_ratios = [{ mode = 2, dofs = [\"m1\", \"m3\"] }]"}}))
          .outputs;
  EXPECT_EQ(outputs.frequencies, (std::vector<int>{1, 3}));
  EXPECT_EQ(outputs.damping, (std::vector<int>{2}));
  EXPECT_EQ(outputs.eigenvalues, (std::vector<int>{2}));
  EXPECT_EQ(outputs.tracking, ModeTracking::mac);
  EXPECT_EQ(outputs.minimum_mac, 0.7);
  EXPECT_EQ(outputs.shape_modes, (std::vector<int>{1}));
  EXPECT_EQ(outputs.shape_degrees_of_freedom, (std::vector<std::string>{"m1", "m3"}));
  EXPECT_EQ(outputs.shape_size, ShapeSize::free);
  ASSERT_EQ(outputs.static_loads.size(), 1U);
  EXPECT_EQ(outputs.static_loads[0].forces, (std::map<std::string, double>{{"m3", 1.5}}));
  ASSERT_EQ(outputs.shape_ratios.size(), 1U);
  EXPECT_EQ(outputs.shape_ratios[0].mode, 2);
  EXPECT_EQ(read(three_masses()).outputs.tracking, ModeTracking::order);
}

TEST(PlainData, HoldsTheTestsBesideTheStudy) {
  const StudyTest test =
      *read(three_masses({{"file = \"tests.csv\"",
                           "file = [\"a.csv\", \"b/*.uff\"]\npairing = \"frequency\"\n"
                           "repeatability = { \"f*\" = \"2 %\", f2 = 0.5 }\nmodel_error = \"estimated\""}}))
           .test;
  EXPECT_EQ(test.files, (std::vector<std::filesystem::path>{"folder/a.csv", "folder/b/*.uff"}));
  EXPECT_EQ(test.pairing, TestPairing::frequency);
  ASSERT_EQ(test.repeatability.size(), 2U);
  EXPECT_EQ(test.repeatability[0].pattern, "f*");
  EXPECT_EQ(test.repeatability[0].value, 0.02);
  EXPECT_TRUE(test.repeatability[0].is_relative);
  EXPECT_EQ(test.repeatability[1].value, 0.5);
  EXPECT_FALSE(test.repeatability[1].is_relative);
  EXPECT_TRUE(test.is_model_error_estimated);
  const StudyTest plain = *read(three_masses()).test;
  EXPECT_FALSE(plain.pairing.has_value());
  EXPECT_FALSE(plain.is_model_error_estimated);
  EXPECT_TRUE(plain.repeatability.empty());
  EXPECT_EQ(read(three_masses({{"\"tests.csv\"", "\"tests.csv\"\nrepeatability = \"r.csv\""}})).test->repeats_file,
            std::filesystem::path("folder/r.csv"));
  EXPECT_FALSE(read(three_masses({{"[test]\nfile = \"tests.csv\"", ""}})).test.has_value());
}

TEST(PlainData, HoldsTheUpdate) {
  const StudyUpdate update =
      read(three_masses({{"samples = 200",
                          "samples = \"auto\"\nsampling = \"sobol\"\ntolerance = 0.01\nlevel = 0.1\nmax_failed = 0.5\n"
                          "covariance = [[\"k1\", \"k2\"]]"}}))
          .update;
  EXPECT_EQ(update.method, "mares");
  EXPECT_TRUE(update.has_automatic_samples);
  EXPECT_EQ(update.design, SamplingDesign::sobol);
  EXPECT_EQ(update.iterations, 30);
  EXPECT_EQ(update.tolerance, 0.01);
  EXPECT_EQ(update.level, 0.1);
  EXPECT_EQ(update.max_failed, 0.5);
  EXPECT_EQ(update.covariance_groups, (std::vector<std::vector<std::string>>{{"k1", "k2"}}));
  EXPECT_EQ(std::get<std::string>(update.method_options.at("mares").at("weighting")), "mahalanobis");
  const StudyUpdate usual = read(three_masses({{"[update]\nmethod = \"mares\"\nsamples = 200\niterations = 30\n\n"
                                                "[update.mares]\nweighting = \"mahalanobis\"\n",
                                                ""}}))
                                .update;
  EXPECT_EQ(usual.method, "maximum-likelihood");
  EXPECT_FALSE(usual.states_samples);
  EXPECT_TRUE(read(three_masses({{"samples = 200", "covariance = \"diagonal\""}})).update.is_diagonal);
}

TEST(PlainData, HoldsTruthPredictionSurrogateAndDiagnosis) {
  const Study study = read(three_masses() + R"(
[truth]
specimens = 12
noise = { f1 = 0.1 }
[[truth.parameter]]
name = "k1"
target = "spring:k1"
distribution = { kind = "uniform", lower = 1, upper = 2 }
[predict]
frequencies = [1]
model = { "mass:m1" = 1.5 }
repeatability = { f1 = 0.2 }
held_out = "more.csv"
draws = 500
[surrogate]
kind = "kriging"
runs = 77
spread = 2.5
rounds = 3
tolerance = 0.02
[diagnose]
candidates = ["spring:k3", { name = "k4", target = "spring:k4", distribution = { kind = "normal", mean = 1, std = 0.1 } }]
spread = 0.3
screened = 5
like_evidence = 2.0
evidence = 1
)");
  EXPECT_EQ(study.truth->specimens, 12);
  EXPECT_EQ(study.truth->noise.at(0).value, 0.1);
  EXPECT_EQ(study.truth->parameters.list.at(0).distribution.kind, DistributionKind::uniform);
  EXPECT_EQ(study.predict->outputs.frequencies, (std::vector<int>{1}));
  EXPECT_EQ(study.predict->overrides, (std::map<std::string, double>{{"mass:m1", 1.5}}));
  EXPECT_EQ(study.predict->repeatability, (std::map<std::string, double>{{"f1", 0.2}}));
  EXPECT_EQ(study.predict->held_out, std::filesystem::path("folder/more.csv"));
  EXPECT_EQ(study.predict->draws, 500);
  EXPECT_EQ(study.surrogate->kind, SurrogateKind::kriging);
  EXPECT_EQ(study.surrogate->runs, 77);
  EXPECT_EQ(study.surrogate->spread, 2.5);
  EXPECT_EQ(study.surrogate->rounds, 3);
  EXPECT_EQ(study.surrogate->tolerance, 0.02);
  ASSERT_EQ(study.diagnose.candidates.size(), 2U);
  EXPECT_EQ(study.diagnose.candidates[0].targets, (std::vector<std::string>{"spring:k3"}));
  EXPECT_EQ(study.diagnose.candidates[1].name, "k4");
  EXPECT_EQ(study.diagnose.spread, 0.3);
  EXPECT_EQ(study.diagnose.screened, 5);
  EXPECT_EQ(study.diagnose.like_evidence, 2.0);
  EXPECT_EQ(study.diagnose.evidence, 1);
}

TEST(PlainData, KnowsTheLineOfEachKey) {
  const std::string text = three_masses();
  const Study study = read(text);
  EXPECT_EQ(study.lines.at("outputs.frequencies"), test::line_of(text, "frequencies ="));
  EXPECT_EQ(study.lines.at("update.mares.weighting"), test::line_of(text, "weighting ="));
  EXPECT_EQ(study.lines.at("parameter 'k2'"), test::line_of(text, "target = \"spring:k2\"") - 2);
  EXPECT_EQ(located(study, "outputs.frequencies", "FAULT"),
            fmt::format("folder/study.toml:{}: outputs.frequencies: FAULT", test::line_of(text, "frequencies =")));
  // A key that is not there has the line of its table.
  EXPECT_EQ(located(study, "outputs.damping", "FAULT"),
            fmt::format("folder/study.toml:{}: outputs.damping: FAULT", test::line_of(text, "[outputs]")));
  EXPECT_EQ(located(study, "predict.draws", "FAULT"), "folder/study.toml: predict.draws: FAULT");
}

}  // namespace
}  // namespace mottle::study
