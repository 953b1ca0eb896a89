// A deck with its study, updated without the command:   deck ../02-airframe/study.toml
#include <cmath>
#include <cstdio>
#include <exception>
#include <mottle/mottle.hpp>
#include <string>
#include <vector>

int main(int count, char** arguments) {
  if (count != 2) return std::fprintf(stderr, "usage: deck STUDY.toml\n"), 2;
  try {
    const mottle::Study study = mottle::read_study(arguments[1]);
    const mottle::UpdateOutcome outcome = mottle::update(study, {.threads = mottle::available_threads()});
    const mottle::UpdatingResult& result = outcome.result;
    const std::vector<std::string> names = outcome.problem().space.names();
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      std::printf("%-12s mean %12.6g   standard deviation %12.6g\n", names[i].c_str(), result.mean(k),
                  std::sqrt(result.covariance(k, k)));
    }
    std::printf("verdict: %s\n", mottle::conclusion_text(outcome.verdict.conclusion).c_str());
    // mottle::write_results(outcome, "folder") leaves the files of `mottle update`; `mottle report folder` draws them.
  } catch (const std::exception& error) {
    return std::fprintf(stderr, "%s\n", error.what()), 2;
  }
}
