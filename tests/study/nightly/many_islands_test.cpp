// A posterior of as many chains as can be asked for: 25,600 draws take five seconds.
#include <gtest/gtest.h>

#include "support/study_folder.hpp"

namespace mottle::study {
namespace {

TEST(BayesOptions, GiveAPosteriorOfTheMostIslands) {
  test::StudyFolder folder;
  const nlohmann::json result =
      folder.update_changed({{"method = \"mares\"", "method = \"bayes\""},
                             {"samples = 200", "samples = 100"},
                             {"[update.mares]\nweighting = \"mahalanobis\"\n",
                              "[update.bayes]\nparticles = 100\nnoise = \"estimated\"\nislands = 256\n"},
                             {"file = \"tests.csv\"\n", "file = \"tests.csv\"\nrepeatability = { \"f*\" = 0.02 }\n"}});
  EXPECT_THAT(result["status"].get<std::string>(), testing::AnyOf("converged", "stalled"));
  EXPECT_EQ(result["posterior"]["chains"], 256);
}

}  // namespace
}  // namespace mottle::study
