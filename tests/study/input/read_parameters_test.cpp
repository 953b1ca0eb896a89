// Parameters of a study that cannot be.
#include <gtest/gtest.h>

#include "support/study_refusals.hpp"

namespace mottle::study {
namespace {

using test::expect_refused;
using test::WrongStudy;

WrongStudy without_parameters() {
  const std::string& good = test::k_three_masses_study;
  const std::size_t begin = good.find("[[parameter]]");
  return {.what = "no parameter",
          .changes = {{good.substr(begin, good.find("[outputs]") - begin), ""}},
          .says = {"study.toml", "parameter", "[[parameter]]"}};
}

TEST(ReadParameters, RefusesWhatActsOnNothingOrTwice) {
  expect_refused({
      {"a model that is unstable",
       {{"[outputs]", "[outputs]"},
        {R"(target = "spring:k2"
distribution = { kind = "normal", mean = 2.0, std = 0.3 }

[outputs])",
         R"(target = "spring:k2"
distribution = { kind = "normal", mean = -9.0, std = 0.3 }

[outputs])"}},
       {"study.toml:23: ", "'k2'", "-9", "must be > 0"}},
      {"a parameter that acts on nothing",
       {{R"(target = "spring:k2")", R"(target = "spring:k9")"}},
       {"study.toml:23: ", "parameter 'k2'", "acts on nothing", "'spring:k9'", "did you mean 'spring:k"}},
      {"a parameter on an element of the wrong kind",
       {{R"(target = "spring:k2")", R"(target = "damper:k2")"}},
       {"study.toml:23: ", "parameter 'k2'", "acts on nothing", "'damper:k2'"}},
      {"a target without a kind",
       {{R"(target = "spring:k2")", R"(target = "k2")"}},
       {"study.toml:23: ", "parameter 'k2'", "target 'k2'", "spring:k2"}},
      {"a damper's parameter where no output sees damping",
       {{"springs = [", R"(dampers = [{ name = "c1", between = ["ground", "m1"], damping = 0.1 }]
springs = [)"},
        {R"(target = "spring:k2")", R"(target = "damper:c1")"}},
       {"parameter 'k2'", "acts on nothing", "damping"}},
      {"two parameters on one element",
       {{R"(target = "spring:k2")", R"(target = "spring:k1")"}},
       {"study.toml:23: ", "parameter 'k2'", "'spring:k1'", "already", "'k1'"}},
      {"a factor on a value of zero",
       {{R"(name = "k1", between = ["ground", "m1"], stiffness = 1.0)",
         R"(name = "k1", between = ["ground", "m1"], stiffness = 0.0)"},
        {R"(target = "spring:k1")", R"(target = "spring:k1"
relative = true)"}},
       {"parameter 'k1'", "nominal value is 0", "acts on nothing"}},
      {"two parameters of one name",
       {{R"(name = "k2"
target)",
         R"(name = "k1"
target)"}},
       {"parameter.2.name", "'k1'", "twice"}},
      {"a parameter called status",
       {{R"(name = "k2"
target)",
         R"(name = "status"
target)"}},
       {"parameter.2.name", "status", "allowed"},
       R"(name = "status")"},
      {"a parameter called like an output",
       {{R"(name = "k2"
target)",
         R"(name = "f2"
target)"}},
       {"study.toml:23: ", "parameter 'f2'", "output", "choose another"}},
      {"a parameter without a name",
       {{R"(name = "k2"
target)",
         "target"}},
       {"parameter.2.name", "missing"}},
      {"a parameter without a target",
       {{R"(target = "spring:k2"
)",
         ""}},
       {"parameter.2.target", "missing"}},
      {"an empty list of targets",
       {{R"(target = "spring:k2")", "target = []"}},
       {"parameter.2.target", "text"},
       "target = []"},
      {"a parameter without a distribution",
       {{R"(distribution = { kind = "normal", mean = 2.0, std = 0.3 }

[outputs])",
         "\n[outputs]"}},
       {"parameter.2.distribution", "missing"}},
      {"bounds crossed",
       {{"bounds = [0.5, 3.0]", "bounds = [3.0, 0.5]"}},
       {"parameter.1.bounds", "[3.0, 0.5]", "lower first"},
       "bounds = [3.0, 0.5]"},
      {"bounds of three numbers",
       {{"bounds = [0.5, 3.0]", "bounds = [0.5, 1, 3.0]"}},
       {"parameter.1.bounds", "two numbers"},
       "bounds"},
      {"bounds that are no numbers",
       {{"bounds = [0.5, 3.0]", R"(bounds = [0.5, "three"])"}},
       {"parameter.1.bounds", "three", "numbers"},
       "bounds"},
      {"bounds that are nan",
       {{"bounds = [0.5, 3.0]", "bounds = [0.5, nan]"}},
       {"parameter.1.bounds", "nan", "numbers"},
       "bounds"},
      {"the mean outside the bounds",
       {{"bounds = [0.5, 3.0]", "bounds = [0.5, 1.5]"}},
       {"parameter 'k1'", "mean 2", "[0.5, 1.5]"}},
      {"a factor that is no flag",
       {{R"(target = "spring:k1")", R"(target = "spring:k1"
relative = "yes")"}},
       {"parameter.1.relative", "yes", "true or false"},
       "relative"},
      {"a control character in a parameter's name",
       {{R"(name = "k1"
target)",
         R"(name = "k1\u001b[31m"
target)"}},
       {"parameter.1.name", "control characters"},
       "u001b"},
      {"a logarithm of a parameter that is not positive",
       {{R"({ kind = "normal", mean = 2.0, std = 0.3 }

[outputs])",
         R"({ kind = "normal", mean = -2.0, std = 0.3 }
scale = "log"

[outputs])"}},
       {"parameter.2.scale", R"("log")", "mean is -2", "identity"},
       R"(scale = "log")"},
      {"a logit without bounds",
       {{R"({ kind = "normal", mean = 2.0, std = 0.3 }

[outputs])",
         R"({ kind = "normal", mean = 2.0, std = 0.3 }
scale = "logit"

[outputs])"}},
       {"parameter.2.scale", R"("logit")", "bounds", "missing"},
       R"(scale = "logit")"},
      {"a scale that nobody knows",
       {{"bounds = [0.5, 3.0]", R"(bounds = [0.5, 3.0]
scale = "lg")"}},
       {"parameter.1.scale", "lg", R"("identity" | "log" | "logit")"},
       R"(scale = "lg")"},
      without_parameters(),
  });
}

}  // namespace
}  // namespace mottle::study
